//! Estimates of a panel with a diffuser from prepared kernels.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::super::first_pass::{SourceFreeView, Weights};
use super::super::ledger::{LedgerRequest, Sums};
use super::super::recycling::{Direction, Forms, Recycling, Reflectances};
use super::super::{Views, add_scaled};
use super::{Bundle, Kernel, Recycled, View, sent_back};
use crate::light::cone_points::Point;
use crate::light::images::ImagePoints;
use crate::specular::panel_image;
use crate::{AngularTable, Diffuser, Estimate, Medium, Panel, ReflectanceFactor, Reflector, Source};

impl Kernel {
    pub(in super::super) fn estimate(&self, stack: &Panel, diffuser: &Diffuser, view: usize) -> Estimate {
        let Some(seen) = self.views.get(view) else { return Estimate::default() };
        let sources: Vec<Source> = self.sources.iter().map(|light| light.source.clone()).collect();
        if self.recycling_serves(stack) {
            let sums = self.sums(stack, diffuser, seen, &sources, LedgerRequest::Requested);
            let mut estimate = sums.estimate(stack, diffuser, &sources);
            add_images(stack, &seen.images, &mut estimate.rho);
            return estimate;
        }
        // A front or a pixel that is much brighter, so that more orders of recycled light are needed.
        let mut other = self.clone();
        other.views = vec![seen.clone()];
        let views = Views { own: &[seen.cone], together: &[], common: None };
        other.prepare(stack, views, &sources, &AtomicBool::new(false));
        other.estimate(stack, diffuser, 0)
    }

    /// Returns the `rho` of an estimate.
    pub(in super::super) fn seen(
        &self,
        stack: &Panel,
        diffuser: &Diffuser,
        view: usize,
    ) -> Vec<ReflectanceFactor> {
        match self.views.get(view) {
            Some(seen) if self.recycling_serves(stack) => {
                let sources: Vec<Source> = self.sources.iter().map(|light| light.source.clone()).collect();
                let sums = self.sums(stack, diffuser, seen, &sources, LedgerRequest::Omitted);
                let mut rho = sums.rho(stack, diffuser, &sources);
                add_images(stack, &seen.images, &mut rho);
                rho
            }
            _ => self.estimate(stack, diffuser, view).rho,
        }
    }

    /// Returns whether enough orders of recycled light were prepared for this stack.
    pub(in super::super) fn recycling_serves(&self, stack: &Panel) -> bool {
        let prepared = self.recycling.as_ref().and_then(|all| all.first()).map(|one| &one.plan);
        self.plan(stack).as_ref() == prepared
    }

    fn sums(
        &self,
        stack: &Panel,
        diffuser: &Diffuser,
        view: &View,
        sources: &[Source],
        ledger: LedgerRequest,
    ) -> Sums {
        let len = stack.base.states() * stack.base.bins();
        let sent_back = sent_back(stack, &diffuser.transmittance);
        let at = |index: usize| match &stack.base.reflector {
            Reflector::Specular(table) => {
                self.over_mirror((stack, table), view, index, &sent_back, (sources, ledger))
            }
            Reflector::Lambertian(r) => self.over_lambertian(r, view, index, &sent_back, sources),
            // Such a base occurs only under general layers, never in a panel.
            Reflector::Scattering(_) => Sums::zeros(len, sources),
        };
        if self.indices.nodes.len() == 1 {
            return at(0);
        }
        let mut sum = Sums::zeros(len, sources);
        for index in 0..self.indices.nodes.len() {
            sum.zip(&at(index), |sum, values| self.indices.add(index, values, sum));
        }
        sum
    }

    fn over_lambertian(
        &self,
        r: &[f64],
        view: &View,
        index: usize,
        sent_back: &[f64],
        sources: &[Source],
    ) -> Sums {
        let mut sums = Sums::zeros(r.len(), sources);
        let shares = &self.shares[index];
        let a: f64 = view.groups.iter().map(|g| shares.arriving(&self.diffuser, &g.points)).sum();
        let towards: Vec<f64> = self
            .sources
            .iter()
            .map(|light| light.groups.iter().map(|g| shares.arriving(&self.diffuser, &g.points)).sum())
            .collect();
        for (k, r) in r.iter().enumerate() {
            let arriving = a / (1.0 - sent_back[k % sent_back.len()] * r * shares.back);
            sums.arriving[k] = arriving;
            sums.reflected[k] = arriving * r;
            sums.leaving[k] = arriving * r * shares.out;
            for (directed, towards) in sums.directed.iter_mut().zip(&towards).filter(|(d, _)| !d.is_empty()) {
                directed[k] = arriving * r * shares.density() * towards;
            }
        }
        sums
    }

    fn over_mirror(
        &self,
        (stack, table): (&Panel, &AngularTable),
        view: &View,
        index: usize,
        sent_back: &[f64],
        (sources, ledger): (&[Source], LedgerRequest),
    ) -> Sums {
        let len = stack.base.states() * stack.base.bins();
        let medium = self.medium_at(stack, index);
        let straight = Straight { stack, medium: &medium, share: self.diffuser.regular_fraction, sent_back };
        let g = sent_back.repeat(stack.base.states());
        let recycling = self.recycling.as_ref().and_then(|all| all.get(index));
        let seen =
            recycling.map(|recycling| (recycling, self.reflectances((stack, table), &medium, index, &g)));
        let of_sources = self.source_columns(&straight);
        let at = &view.at[index];
        let mut all = Sums::zeros(len, sources);
        for (g_number, group) in view.groups.iter().enumerate() {
            let mut sums = first_pass(table, &at.alone[g_number], &at.pairs[g_number], &of_sources, sources);
            let along = straight.along(group.axis);
            if let &Some((recycling, ref r)) = &seen {
                let recycled = &at.recycled[g_number];
                let mut orders = Sums::zeros(len, sources);
                let seen = (recycling, recycled, &along);
                self.recycle(seen, index, (r, &g), &of_sources, (&mut orders, ledger));
                if let Some(seen) = &recycled.seen {
                    let towards: Vec<Vec<_>> = recycled
                        .between
                        .iter()
                        .zip(&of_sources)
                        .map(|(all, of)| all.iter().map(|(_, towards)| towards.as_ref()).zip(of).collect())
                        .collect();
                    recycling.add_narrow(seen, &towards, r, &g, &mut orders);
                }
                sums.zip(&orders, |sums, orders| add_scaled(sums, orders, 1.0));
            }
            all.zip(&sums, |all, sums| add_times(all, sums, &along.round_trips));
        }
        all
    }

    /// Returns the reflectances of the base that recycling needs: as prepared, if the base is the same.
    pub(super) fn reflectances(
        &self,
        (stack, table): (&Panel, &AngularTable),
        medium: &Medium,
        index: usize,
        g: &[f64],
    ) -> Arc<Reflectances> {
        let prepared = self.seen.as_ref().filter(|seen| seen.table.is_same(table));
        match (prepared.and_then(|seen| seen.at.get(index)), &self.recycling) {
            (Some(at), _) => Arc::clone(at),
            (None, Some(all)) => Arc::new(all[index].reflectances(&stack.base, table, medium, g)),
            (None, None) => Arc::new(Reflectances::default()),
        }
    }

    /// Returns, for each source and its groups, the reflectance of the base and the unscattered round trips.
    fn source_columns(&self, straight: &Straight<'_>) -> Vec<Vec<Direction>> {
        let of = |b: &Bundle| straight.along(b.axis);
        self.sources.iter().map(|light| light.groups.iter().map(of).collect()).collect()
    }

    fn recycle(
        &self,
        (recycling, recycled, own): (&Recycling, &Recycled, &Direction),
        index: usize,
        (r, g): (&Reflectances, &[f64]),
        of_sources: &[Vec<Direction>],
        (sums, ledger): (&mut Sums, LedgerRequest),
    ) {
        if recycling.sums_columns() {
            let sources: Vec<Vec<_>> = self
                .sources
                .iter()
                .zip(of_sources)
                .map(|(light, of)| light.recycled[index].iter().zip(of).collect())
                .collect();
            return recycling.add_by_columns((&recycled.group, own), &sources, r, g, sums);
        }
        let ledger = ledger == LedgerRequest::Requested;
        let alone = recycled.alone.as_ref();
        let own = alone
            .into_iter()
            .flat_map(|alone| std::iter::once(&alone.leaving).chain(ledger.then_some(&alone.reflected)));
        let between = recycled.between.iter().flatten().map(|(forms, _)| forms);
        let forms: Vec<&Forms> = own.chain(between).collect();
        let values = recycling.values(&forms, false, r, g);
        let mut values = values.chunks_exact(g.len());
        if let Some(alone) = alone {
            add_scaled(&mut sums.leaving, values.next().unwrap_or_default(), 1.0);
            if ledger {
                add_scaled(&mut sums.arriving, &recycling.values(&[&alone.arriving], true, r, g), 1.0);
                add_scaled(&mut sums.reflected, values.next().unwrap_or_default(), 1.0);
            }
        }
        for (sum, of_source) in sums.directed.iter_mut().zip(of_sources) {
            for (along, values) in of_source.iter().zip(&mut values) {
                add_times(sum, values, &along.round_trips);
            }
        }
    }
}

/// Returns the first pass of a group: light that is unscattered in at most one of its two passes through the
/// diffuser.
fn first_pass(
    table: &AngularTable,
    alone: &SourceFreeView,
    pairs: &[Vec<(Weights, usize)>],
    of_sources: &[Vec<Direction>],
    sources: &[Source],
) -> Sums {
    let between = pairs.iter().flatten().map(|(weights, _)| &weights.0[..]);
    let rows: Vec<&[f64]> =
        [&alone.reflected.0[..], &alone.leaving.0[..]].into_iter().chain(between).collect();
    let values = table.weighted_sums(&rows);
    let len = values.len() / rows.len();
    let mut values = values.chunks_exact(len);
    let mut sums = Sums::zeros(len, sources);
    sums.arriving.fill(alone.reflected.0.iter().sum());
    sums.reflected.copy_from_slice(values.next().unwrap_or_default());
    sums.leaving.copy_from_slice(values.next().unwrap_or_default());
    for (sum, of_source) in sums.directed.iter_mut().zip(of_sources) {
        for (along, values) in of_source.iter().zip(&mut values) {
            add_times(sum, values, &along.round_trips);
        }
    }
    sums
}

/// Light that passes the diffuser unscattered, is reflected by the base, and passes unscattered again.
struct Straight<'a> {
    stack: &'a Panel,
    medium: &'a Medium,
    share: f64,
    sent_back: &'a [f64],
}

impl Straight<'_> {
    /// Returns the reflectance of the base in this direction, and `1/(1 - g s^2 R)`.
    fn along(&self, point: Point) -> Direction {
        if self.share == 0.0 {
            return Direction { reflectance: Vec::new(), round_trips: Vec::new() };
        }
        let (reflectance, g) = (self.reflectance_at(point), self.sent_back);
        let trip = |(k, r): (usize, &f64)| 1.0 / (1.0 - g[k % g.len()] * self.share * self.share * r);
        let round_trips = reflectance.iter().enumerate().map(trip).collect();
        Direction { reflectance, round_trips }
    }

    fn reflectance_at(&self, point: Point) -> Vec<f64> {
        let base = &self.stack.base;
        let mut r = vec![0.0; base.states() * base.bins()];
        base.reflectance(point.beta.squared(), self.medium, &mut r);
        r
    }
}

/// `sum += values * factors`; an empty slice of factors means ones.
fn add_times(sum: &mut [f64], values: &[f64], factors: &[f64]) {
    if factors.is_empty() {
        return add_scaled(sum, values, 1.0);
    }
    for ((s, v), f) in sum.iter_mut().zip(values).zip(factors) {
        *s += v * f;
    }
}

fn add_images(stack: &Panel, images: &[ImagePoints], rho: &mut [ReflectanceFactor]) {
    for seen in images {
        let rho = &mut rho[seen.source];
        for point in &seen.points {
            rho.add(&panel_image(stack, point.beta), point.weight);
        }
    }
}
