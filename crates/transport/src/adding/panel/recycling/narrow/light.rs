//! Light of every column over a base: diffuse light at the nodes, and the sum of the series between a view
//! and a source.

use papilio_optics::with_widest_simd;

use super::super::forms::Products;
use super::super::grid::Columns;
use super::super::plan::Extrapolation;
use super::super::spectra::add_times;
use super::diffuse::{Diffuse, Own};
use super::weights::{Towards, Weights};
use super::{Narrow, Seen};
use crate::angular::add_rows;
use crate::numerics::product::add_product;

/// Light at the nodes of air over a base, `[node][column]`; columns are `[state][wavelength]`.
#[derive(Debug, Clone)]
pub(in super::super::super) struct Light {
    /// Regular transmittance of two passes through the diffuser.
    unscattered: f64,
    /// Reflectance of the base.
    reflectance: Vec<f64>,
    columns: usize,
    /// Number of orders of the series.
    orders: usize,
    diffuse: Diffuse,
    /// Products of terms of the reflectance, for each order that is exact.
    products: Vec<Products>,
    extrapolation: Extrapolation,
}

impl Narrow {
    /// Computes the light over a base; `terms` are its reflectances at [`Self::squares`]. Light under a front
    /// that sends back the fraction `g` of each column takes the least time.
    pub(in super::super) fn light(&self, r: Columns<'_>, terms: Vec<Vec<f64>>, g: &[f64]) -> Light {
        let products = terms.into_iter().zip(2..).map(|(terms, order)| Products::new(terms, r.count, order));
        Light {
            unscattered: self.straight * self.straight,
            columns: r.count,
            orders: self.shares.len(),
            reflectance: r.air.to_vec(),
            diffuse: Diffuse::new(self, r, g),
            products: products.collect(),
            extrapolation: self.extrapolation,
        }
    }
}

impl Light {
    /// Returns the values at these weights of a function at the nodes.
    fn at(function: &[f64], weights: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; function.len() / weights.len().max(1)];
        with_widest_simd(
            #[inline(always)]
            || add_rows(&mut sum, function, weights),
        );
        sum
    }

    /// Returns the recycled light of a view that does not depend on directed sources.
    pub(in super::super) fn own(&self, of: &Narrow, view: &Seen, g: &[f64]) -> Own<Vec<f64>> {
        self.diffuse.under(of, &self.reflectance, g, |light| Self::at(light, &view.weights))
    }

    /// Returns `pi` times the recycled kernel between a view and the groups of a source, each with its round
    /// trips.
    pub(in super::super) fn between(
        &self,
        view: &Seen,
        source: &[(&Towards, &[f64])],
        g: &[f64],
    ) -> Vec<f64> {
        let groups: Vec<&Weights> = source.iter().map(|(group, _)| &group.lobe).collect();
        let weights = Weights::sum(&groups, (self.orders, view.weights.len()));
        let mut orders = self.orders(view, &weights, &self.round_trips(g));
        self.correct(source, &mut orders);
        series(&orders, g, false)
    }

    /// Returns the round trips of unscattered light at the nodes; empty if there is none.
    fn round_trips(&self, g: &[f64]) -> Vec<f64> {
        if self.unscattered == 0.0 {
            return Vec::new();
        }
        let rows = self.reflectance.chunks_exact(g.len());
        rows.flat_map(|row| row.iter().zip(g).map(|(r, g)| 1.0 / (1.0 - g * self.unscattered * r))).collect()
    }

    /// Adds the difference of the exact orders from their closed form, and multiplies the later ones by a
    /// power of the ratio. It is that of all groups together.
    fn correct(&self, source: &[(&Towards, &[f64])], orders: &mut [Vec<f64>]) {
        let Some(last) = self.products.len().checked_sub(1) else { return };
        if source.iter().any(|(group, _)| group.exact.is_empty()) {
            return;
        }
        let closed = orders[last].clone();
        // A polynomial of few terms follows the reflectance roughly, which is enough for the difference.
        for (k, (products, order)) in self.products.iter().zip(&mut *orders).enumerate() {
            let forms: Vec<&[f64]> = source.iter().map(|(group, _)| &group.exact[k][..]).collect();
            let mut values = vec![0.0; forms.len() * order.len()];
            products.add((&forms.concat(), forms.len()), false, order.len(), &mut values);
            let columns = order.len();
            for (values, (_, round_trips)) in values.chunks_exact(columns).zip(source) {
                add_times(order, values, round_trips, 1.0);
            }
        }
        let ratio = |(exact, closed): (&f64, &f64)| {
            if *closed > 0.0 { (exact / closed).clamp(0.0, LARGEST_CORRECTION) } else { 1.0 }
        };
        let ratios: Vec<f64> = orders[last].iter().zip(&closed).map(ratio).collect();
        for (k, order) in orders.iter_mut().enumerate().skip(last + 1) {
            let factor = |ratio: f64| self.extrapolation.extrapolated(ratio, k + 2, last + 2);
            order.iter_mut().zip(&ratios).for_each(|(order, ratio)| *order *= factor(*ratio));
        }
    }

    /// Returns the same under the wider lobe; without orders that the grid does not have if `truncated`.
    pub(in super::super::super) fn under_wider(
        &self,
        view: &Seen,
        source: &Towards,
        g: &[f64],
        truncated: bool,
    ) -> Option<Vec<f64>> {
        Some(series(&self.orders(view, source.wider.as_ref()?, &[]), g, truncated))
    }

    /// Returns orders 2, 3, ... of the series, without the powers of g; light of the source makes these round
    /// trips (at the nodes; none if empty).
    fn orders(&self, view: &Seen, weights: &Weights, round_trips: &[f64]) -> Vec<Vec<f64>> {
        let count = weights.rows.len();
        let of_view = if view.is_one_ring {
            self.powers_on_ring(&view.weights, &[], count)
        } else {
            self.powers_of(&view.weights, &[], count)
        };
        let columns = of_view[0].len();
        // Weights of the lobe contain those of the view, of which powers are means.
        let weight: f64 = view.weights.iter().sum();
        // For each power, `[order][column]`.
        let of_source = match weights.rows.first() {
            Some(first) if weights.is_one_ring => {
                let (all, scales) = (self.powers_on_ring(first, round_trips, count), weights.scales());
                let each_order = |power: &Vec<f64>| -> Vec<f64> {
                    scales.iter().flat_map(|scale| power.iter().map(move |value| scale * value)).collect()
                };
                all.iter().map(each_order).collect()
            }
            _ => self.powers_of(&weights.rows.concat(), round_trips, count),
        };
        let order = |k: usize| {
            let passes = k + 2;
            let mut sum = vec![0.0; columns];
            for (met, of_view) in of_view.iter().enumerate().take(passes + 1) {
                // The first and the last lobe deflect from or to the end of the path.
                let times = if met == 0 || met == passes { 1.0 } else { 2.0 };
                let scale = times / ((2 * passes) as f64 * weight);
                let of_source = &of_source[passes - met][k * columns..][..columns];
                for ((sum, v), l) in sum.iter_mut().zip(of_view).zip(of_source) {
                    *sum += scale * v * l;
                }
            }
            sum
        };
        (0..count).map(order).collect()
    }

    /// Returns powers 0, 1, ... of the reflectance, and the round trips, at rows of weights on the nodes: for
    /// each power `[row][column]`, as many as this number of orders needs.
    fn powers_of(&self, rows: &[f64], round_trips: &[f64], orders: usize) -> Vec<Vec<f64>> {
        let columns = self.columns;
        let nodes = self.reflectance.len() / columns.max(1);
        let mut now = vec![1.0; self.reflectance.len()];
        if !round_trips.is_empty() {
            now.copy_from_slice(round_trips);
        }
        let mut all = Vec::with_capacity(orders + 2);
        for _ in 0..orders + 2 {
            let mut values = vec![0.0; rows.len() / nodes.max(1) * columns];
            add_product(rows, &now, nodes, &mut values);
            all.push(values);
            now.iter_mut().zip(&self.reflectance).for_each(|(power, r)| *power *= r);
        }
        all
    }

    /// Returns the same for a row that belongs to one |beta|, where powers are those of the reflectance
    /// there.
    fn powers_on_ring(&self, row: &[f64], round_trips: &[f64], orders: usize) -> Vec<Vec<f64>> {
        let weight: f64 = row.iter().sum();
        let mut reflectance = Self::at(&self.reflectance, row);
        reflectance.iter_mut().for_each(|r| *r /= weight);
        let mut now = vec![weight; reflectance.len()];
        if !round_trips.is_empty() {
            now = Self::at(round_trips, row);
        }
        let mut all = Vec::with_capacity(orders + 2);
        for _ in 0..orders + 2 {
            all.push(now.clone());
            now.iter_mut().zip(&reflectance).for_each(|(power, r)| *power *= r);
        }
        all
    }
}

/// Returns the sum of terms times g, g², ...; those that follow, unless it is truncated, are a geometric
/// series.
fn series(terms: &[impl AsRef<[f64]>], g: &[f64], truncated: bool) -> Vec<f64> {
    let mut sum = vec![0.0; g.len()];
    for (k, (sum, g)) in sum.iter_mut().zip(g).enumerate() {
        let (mut power, mut last, mut ratio) = (1.0, 0.0, 0.0);
        for term in terms {
            power *= g;
            let next = power * term.as_ref()[k];
            ratio = if last > 0.0 { next / last } else { 0.0 };
            last = next;
            *sum += next;
        }
        if !truncated && ratio > 0.0 && ratio < LARGEST_RATIO {
            *sum += last * ratio / (1.0 - ratio);
        }
    }
    sum
}

/// Largest ratio of exact passes to their closed form that is extrapolated to more.
const LARGEST_CORRECTION: f64 = 1.5;

/// Largest ratio of terms that is taken for that of a geometric series.
pub(super) const LARGEST_RATIO: f64 = 0.95;
