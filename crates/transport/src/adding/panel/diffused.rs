//! A panel with a diffuser: what is kept between estimates, and how it adds up.

use papilio_optics::lobe::Lobe;

use super::super::images::{ImagePoints, image_points};
use super::super::quadrature::{Point, cone_points, disc_points};
use super::add_scaled;
use super::books::Sums;
use super::first_pass::{Alone, Pass, Weights};
use super::indices::Indices;
use super::lambertian::Shares;
use super::recycling::{Direction, Forms, Group, OwnForms, Plan, Recycling, Reflectances};
use crate::specular::panel_image;
use crate::{AngularTable, Cone, Diffuser, Estimate, Medium, Nodes, Panel, Reflector, Source, Top};

/// Everything of a panel that does not depend on its spectra.
#[derive(Debug, Clone)]
pub(super) struct Kernel {
    digits: f64,
    diffuser: Diffuser,
    medium: Medium,
    /// Of the base's table; `None` over a Lambertian base.
    table: Option<Nodes>,
    indices: Indices,
    /// See [`reach`].
    reach: Option<f64>,
    sources: Vec<Light>,
    views: Vec<View>,
    /// For each index.
    shares: Vec<Shares>,
    recycling: Option<Vec<Recycling>>,
}

#[derive(Debug, Clone)]
struct Light {
    source: Source,
    groups: Vec<Bundle>,
    /// For each index and group.
    recycled: Vec<Vec<Group>>,
}

#[derive(Debug, Clone)]
struct View {
    cone: Cone,
    groups: Vec<Bundle>,
    images: Vec<ImagePoints>,
    /// For each index.
    at: Vec<AtIndex>,
}

/// Points that are looked at together: all of a cone, or, where light that goes straight through
/// counts by direction, each by itself.
#[derive(Debug, Clone, PartialEq)]
struct Bundle {
    axis: Point,
    points: Vec<Point>,
}

/// One view at one index; over a Lambertian base it holds nothing. For each of its groups:
#[derive(Debug, Clone, Default)]
struct AtIndex {
    alone: Vec<Alone>,
    /// By group, source and the source's group, and the nodes they took.
    pairs: Vec<Vec<Vec<(Weights, usize)>>>,
    recycled: Vec<Recycled>,
}

#[derive(Debug, Clone)]
struct Recycled {
    group: Group,
    alone: OwnForms,
    /// By source and the source's group, with what a narrow lobe's peak lacks.
    between: Vec<Vec<(Forms, f64)>>,
}

impl Kernel {
    pub(super) fn new(stack: &Panel, diffuser: &Diffuser, digits: f64) -> Self {
        Self {
            digits,
            diffuser: diffuser.clone(),
            medium: stack.medium.clone(),
            table: table_nodes(stack).cloned(),
            indices: Indices::new(&stack.medium, digits),
            reach: None,
            sources: Vec::new(),
            views: Vec::new(),
            shares: Vec::new(),
            recycling: None,
        }
    }

    /// Whether the layers are those that it was made for.
    pub(super) fn serves(&self, stack: &Panel, diffuser: &Diffuser) -> bool {
        self.diffuser.lobe == diffuser.lobe
            && self.diffuser.straight_through == diffuser.straight_through
            && self.medium == stack.medium
            && self.table.as_ref() == table_nodes(stack)
    }

    pub(super) fn prepare(&mut self, stack: &Panel, views: &[Cone], sources: &[Source]) {
        let old_views = std::mem::take(&mut self.views);
        let old_sources = std::mem::take(&mut self.sources);
        if self.table.is_none() && self.shares.is_empty() {
            let at = |index: &f64| Shares::new(&self.diffuser, *index, self.digits);
            self.shares = self.indices.nodes.iter().map(at).collect();
        }
        self.reach = reach(views, sources);
        let same_recycling = self.prepare_recycling(stack);
        let kept: Vec<Option<usize>> =
            sources.iter().map(|source| old_sources.iter().position(|old| old.source == *source)).collect();
        let light = |(source, kept): (&Source, &Option<usize>)| match kept {
            Some(kept) if same_recycling => old_sources[*kept].clone(),
            _ => self.light(*source),
        };
        self.sources = sources.iter().zip(&kept).map(light).collect();
        let old_view = |k: usize, cone: &Cone| {
            let same = old_views.get(k).filter(|old| old.cone == *cone);
            same.or_else(|| old_views.iter().find(|old| old.cone == *cone))
        };
        let mut made: Vec<View> = Vec::with_capacity(views.len());
        for (k, cone) in views.iter().enumerate() {
            let turned = made.iter().rev().find(|view| view.cone.is_turned(cone));
            let view = self.view(cone, sources, (old_view(k, cone), turned), &kept, same_recycling);
            made.push(view);
        }
        self.views = made;
    }

    /// Makes the grid for recycled light; true if it is the one there was.
    fn prepare_recycling(&mut self, stack: &Panel) -> bool {
        let plan = self.plan(stack);
        let old = self.recycling.as_ref().and_then(|all| all.first()).map(|one| one.plan.clone());
        if plan == old {
            return true;
        }
        self.recycling = plan.map(|plan| {
            let nodes = self.indices.nodes.clone();
            let at = |j: usize| self.pass(j).map(|pass| Recycling::new(&pass, plan.clone()));
            (0..nodes.len()).filter_map(at).collect()
        });
        false
    }

    fn plan(&self, stack: &Panel) -> Option<Plan> {
        let pass = self.pass(0)?;
        let Top::Diffuser(diffuser) = &stack.top else { return None };
        let g = sent_back(stack, &diffuser.transmittance).into_iter().fold(0.0, f64::max);
        let strength = if g > 0.0 { g * stack.base.largest_reflectance() } else { 0.0 };
        Plan::new(&pass, strength, self.reach)
    }

    fn pass(&self, index: usize) -> Option<Pass<'_>> {
        let index = *self.indices.nodes.get(index)?;
        let table = self.table.as_ref()?;
        Some(Pass { diffuser: &self.diffuser, table, index, digits: self.digits })
    }

    /// Points for the lobes' width, together or each by itself.
    fn bundles(&self, points: Vec<Point>, axis: Point) -> Vec<Bundle> {
        if self.diffuser.straight_through == 0.0 || self.table.is_none() {
            return vec![Bundle { axis, points }];
        }
        points.into_iter().map(|point| Bundle { axis: point, points: vec![point] }).collect()
    }

    fn scale(&self) -> f64 {
        match self.diffuser.lobe {
            Lobe::KCorrelation { width } => width.min(SMOOTH),
            Lobe::Lambertian => SMOOTH,
        }
    }

    fn light(&self, source: Source) -> Light {
        let groups = match &source {
            Source::Diffuse => Vec::new(),
            Source::Beam(beta) => {
                let point = Point { beta: *beta, weight: 1.0 };
                vec![Bundle { axis: point, points: vec![point] }]
            }
            Source::Disc(cone) => {
                let axis = Point { beta: cone.mirrored().axis_towards(), weight: 1.0 };
                self.bundles(disc_points(cone, self.scale(), self.digits), axis)
            }
        };
        let recycled = self.groups(&groups, false);
        Light { source, groups, recycled }
    }

    fn groups(&self, bundles: &[Bundle], is_view: bool) -> Vec<Vec<Group>> {
        let at = |(recycling, index): (&Recycling, &f64)| {
            let group = |b: &Bundle| recycling.group(&b.points, b.axis, *index, is_view);
            bundles.iter().map(group).collect()
        };
        self.recycling.iter().flatten().zip(&self.indices.nodes).map(at).collect()
    }

    fn view(
        &self,
        cone: &Cone,
        sources: &[Source],
        (old, turned): (Option<&View>, Option<&View>),
        kept: &[Option<usize>],
        same_recycling: bool,
    ) -> View {
        let groups = match old {
            Some(old) => old.groups.clone(),
            None => {
                let axis = Point { beta: cone.axis_towards(), weight: 1.0 };
                self.bundles(cone_points(cone, self.scale(), self.digits), axis)
            }
        };
        let images = image_points(cone, sources, self.digits);
        let at = (0..self.indices.nodes.len())
            .map(|j| {
                let old = old.and_then(|old| old.at.get(j));
                let turned = turned.and_then(|turned| turned.at.get(j));
                self.view_at(j, &groups, (old, turned), kept, same_recycling)
            })
            .collect();
        View { cone: *cone, groups, images, at }
    }

    fn view_at(
        &self,
        index: usize,
        groups: &[Bundle],
        (old, turned): (Option<&AtIndex>, Option<&AtIndex>),
        kept: &[Option<usize>],
        same_recycling: bool,
    ) -> AtIndex {
        let Some(pass) = self.pass(index) else { return AtIndex::default() };
        let alone = match old {
            Some(old) => old.alone.clone(),
            None => match turned {
                Some(turned) => turned.alone.clone(),
                None => groups.iter().map(|group| pass.alone(&group.points)).collect(),
            },
        };
        let pairs = groups.iter().enumerate().map(|(g, group)| {
            let towards = |(light, kept): (&Light, &Option<usize>)| match (old, kept) {
                (Some(old), Some(kept)) => old.pairs[g][*kept].clone(),
                _ => light.groups.iter().map(|b| pass.between(&group.points, &b.points)).collect(),
            };
            self.sources.iter().zip(kept).map(towards).collect()
        });
        let pairs = pairs.collect();
        let Some(recycling) = self.recycling.as_ref().and_then(|all| all.get(index)) else {
            return AtIndex { alone, pairs, recycled: Vec::new() };
        };
        let recycled = groups.iter().enumerate().map(|(g, bundle)| {
            let old = old.filter(|_| same_recycling).and_then(|old| old.recycled.get(g));
            let turned = turned.and_then(|turned| turned.recycled.get(g));
            let (group, alone) = match (old, turned) {
                (Some(old), _) => (old.group.clone(), old.alone.clone()),
                (None, Some(turned)) => (turned.group.turned_to(bundle.axis), turned.alone.clone()),
                (None, None) => {
                    let group = recycling.group(&bundle.points, bundle.axis, pass.index, true);
                    let alone = recycling.alone(&group);
                    (group, alone)
                }
            };
            let towards = |(light, kept): (&Light, &Option<usize>)| match (old, kept) {
                (Some(old), Some(kept)) => old.between[*kept].clone(),
                _ => {
                    let both = |(other, b): (&Group, &Bundle)| {
                        let peak = recycling.peak(self.diffuser.lobe, &bundle.points, &b.points);
                        (recycling.between(&group, other), peak)
                    };
                    light.recycled[index].iter().zip(&light.groups).map(both).collect()
                }
            };
            let between = self.sources.iter().zip(kept).map(towards).collect();
            Recycled { group, alone, between }
        });
        AtIndex { alone, pairs, recycled: recycled.collect() }
    }

    pub(super) fn nodes(&self) -> usize {
        let pair = |pairs: &Vec<Vec<Vec<(Weights, usize)>>>| -> usize {
            pairs.iter().flatten().flatten().map(|pair| pair.1).sum()
        };
        let views: usize = self
            .views
            .iter()
            .flat_map(|view| &view.at)
            .map(|at| at.alone.iter().map(|alone| alone.nodes).sum::<usize>() + pair(&at.pairs))
            .sum();
        let shares: usize = self.shares.iter().map(|shares| shares.nodes).sum();
        views + shares + self.recycling.iter().flatten().map(Recycling::nodes).sum::<usize>()
    }

    pub(super) fn estimate(&self, stack: &Panel, diffuser: &Diffuser, view: usize) -> Estimate {
        let Some(seen) = self.views.get(view) else { return Estimate::default() };
        let sources: Vec<Source> = self.sources.iter().map(|light| light.source).collect();
        if self.recycling_serves(stack) {
            let mut estimate = self.sums(stack, diffuser, seen, &sources).estimate(stack, diffuser, &sources);
            add_images(stack, &seen.images, &mut estimate);
            return estimate;
        }
        // A front or a pixel so much brighter that recycled light has to be followed further.
        let mut other = self.clone();
        other.views = vec![seen.clone()];
        other.prepare(stack, &[seen.cone], &sources);
        other.estimate(stack, diffuser, 0)
    }

    /// Whether recycled light was prepared for as much of it as this stack has.
    fn recycling_serves(&self, stack: &Panel) -> bool {
        let prepared = self.recycling.as_ref().and_then(|all| all.first()).map(|one| &one.plan);
        self.plan(stack).as_ref() == prepared
    }

    fn sums(&self, stack: &Panel, diffuser: &Diffuser, view: &View, sources: &[Source]) -> Sums {
        let len = stack.base.states() * stack.base.bins();
        let sent_back = sent_back(stack, &diffuser.transmittance);
        let at = |index: usize| match &stack.base.reflector {
            Reflector::Specular(table) => self.over_mirror(stack, table, view, index, &sent_back, sources),
            Reflector::Lambertian(r) => self.over_lambertian(r, view, index, &sent_back, sources),
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
        stack: &Panel,
        table: &AngularTable,
        view: &View,
        index: usize,
        sent_back: &[f64],
        sources: &[Source],
    ) -> Sums {
        let len = stack.base.states() * stack.base.bins();
        let medium = match stack.medium.constant_index() {
            Some(_) => stack.medium.clone(),
            None => Medium::new(vec![self.indices.nodes[index]; stack.base.bins()].into()),
        };
        let straight = Straight { stack, medium: &medium, share: self.diffuser.straight_through, sent_back };
        let recycling = self.recycling.as_ref().and_then(|all| all.get(index));
        let reflectances = recycling.map(|r| r.reflectances(&stack.base, table, &medium, sent_back));
        let of_sources = self.source_columns(&straight);
        let at = &view.at[index];
        let mut all = Sums::zeros(len, sources);
        let mut room = vec![0.0; len];
        for (g, group) in view.groups.iter().enumerate() {
            let mut sums = Sums::zeros(len, sources);
            let alone = &at.alone[g];
            table.weighted_sum(&alone.reflected.0, &mut sums.reflected);
            table.weighted_sum(&alone.leaving.0, &mut sums.leaving);
            sums.arriving.fill(alone.reflected.0.iter().sum());
            for ((sum, pairs), of_source) in sums.directed.iter_mut().zip(&at.pairs[g]).zip(&of_sources) {
                for ((weights, _), along) in pairs.iter().zip(of_source) {
                    table.weighted_sum(&weights.0, &mut room);
                    add_times(sum, &room, &along.round_trips);
                }
            }
            if let (Some(recycling), Some(r)) = (recycling, &reflectances) {
                let own = straight.along(group.axis);
                self.recycle(recycling, (&at.recycled[g], &own), index, r, &of_sources, &mut sums);
                self.add_peaks(&straight, group.axis, &at.recycled[g], &of_sources, &mut sums);
            }
            let along = straight.along(group.axis);
            all.zip(&sums, |all, sums| add_times(all, sums, &along.round_trips));
        }
        all
    }

    /// For each source and its groups: the base's reflectance, and its straight round trips.
    fn source_columns(&self, straight: &Straight<'_>) -> Vec<Vec<Direction>> {
        let of = |b: &Bundle| straight.along(b.axis);
        self.sources.iter().map(|light| light.groups.iter().map(of).collect()).collect()
    }

    /// Adds what narrow lobes' peaks lack on a grid for wider ones.
    fn add_peaks(
        &self,
        straight: &Straight<'_>,
        view: Point,
        recycled: &Recycled,
        of_sources: &[Vec<Direction>],
        sums: &mut Sums,
    ) {
        for (i, (peaks, of_source)) in recycled.between.iter().zip(of_sources).enumerate() {
            for (j, ((_, peak), along)) in peaks.iter().zip(of_source).enumerate() {
                if *peak == 0.0 {
                    continue;
                }
                let [mut value, other] =
                    [view, self.sources[i].groups[j].axis].map(|point| straight.reflectance_at(point));
                for (k, (value, other)) in value.iter_mut().zip(other).enumerate() {
                    *value *= peak * straight.sent_back[k % straight.sent_back.len()] * other;
                }
                add_times(&mut sums.directed[i], &value, &along.round_trips);
            }
        }
    }

    fn recycle(
        &self,
        recycling: &Recycling,
        view: (&Recycled, &Direction),
        index: usize,
        r: &Reflectances,
        of_sources: &[Vec<Direction>],
        sums: &mut Sums,
    ) {
        let (recycled, own) = view;
        if recycling.sums_columns() {
            let sources: Vec<Vec<_>> = self
                .sources
                .iter()
                .zip(of_sources)
                .map(|(light, of)| light.recycled[index].iter().zip(of).collect())
                .collect();
            return recycling.add_by_columns((&recycled.group, own), &sources, r, sums);
        }
        recycling.add_alone(&recycled.alone, r, sums);
        for ((sum, forms), of_source) in sums.directed.iter_mut().zip(&recycled.between).zip(of_sources) {
            for ((forms, _), along) in forms.iter().zip(of_source) {
                if along.round_trips.is_empty() {
                    recycling.add(forms, r, false, sum);
                } else {
                    let mut room = vec![0.0; sum.len()];
                    recycling.add(forms, r, false, &mut room);
                    add_times(sum, &room, &along.round_trips);
                }
            }
        }
    }
}

/// Reflectances change over directions of this size, whatever the lobe.
const SMOOTH: f64 = 0.3;

/// Light that goes straight through the diffuser, off the base, and straight through again.
struct Straight<'a> {
    stack: &'a Panel,
    medium: &'a Medium,
    share: f64,
    sent_back: &'a [f64],
}

impl Straight<'_> {
    /// The base's reflectance of this direction, and `1/(1 - g s^2 R)`.
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

/// `sum += values * factors`; no factors are ones.
fn add_times(sum: &mut [f64], values: &[f64], factors: &[f64]) {
    if factors.is_empty() {
        return add_scaled(sum, values, 1.0);
    }
    for ((s, v), f) in sum.iter_mut().zip(values).zip(factors) {
        *s += v * f;
    }
}

/// The largest `sqrt(|beta_v| |beta_l|)` of a view and a directed source, if there is one.
fn reach(views: &[Cone], sources: &[Source]) -> Option<f64> {
    let radius = |cone: &Cone| (cone.axis_towards().length() + cone.half_angle()).min(1.0);
    let directed = sources.iter().filter_map(|source| match source {
        Source::Diffuse => None,
        Source::Beam(beta) => Some(beta.length()),
        Source::Disc(cone) => Some(radius(cone)),
    });
    let largest_view = views.iter().map(radius).fold(0.0, f64::max);
    directed.reduce(f64::max).map(|l| (l * largest_view).sqrt())
}

fn table_nodes(stack: &Panel) -> Option<&Nodes> {
    match &stack.base.reflector {
        Reflector::Specular(table) => Some(&table.nodes),
        Reflector::Lambertian(_) => None,
    }
}

/// `r T^2`: what comes down again of light that left the diffuser's underside, per wavelength.
fn sent_back(stack: &Panel, transmittance: &[f64]) -> Vec<f64> {
    let one = |(t, r): (&f64, &f64)| if stack.single_pass { 0.0 } else { t * t * r };
    transmittance.iter().zip(stack.front.reflectance_below.iter()).map(one).collect()
}

fn add_images(stack: &Panel, images: &[ImagePoints], estimate: &mut Estimate) {
    for seen in images {
        let rho = &mut estimate.rho[seen.source];
        for point in &seen.points {
            let image = panel_image(stack, point.beta);
            add_scaled(&mut rho.front, &image.front, point.weight);
            add_scaled(&mut rho.base, &image.base, point.weight);
        }
    }
}
