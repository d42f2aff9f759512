//! Light of every column over a base: diffuse light at the nodes, and the sum of the series between a view and a
//! source.

use super::super::forms::Products;
use super::super::grid::Columns;
use super::super::plan::Extrapolation;
use super::super::spectra::add_times;
use super::weights::{Towards, Weights};
use super::{Narrow, Seen};
use crate::product::add_product;

/// Light at the nodes of air over a base, `[node][column]`; columns are `[state][wavelength]`.
#[derive(Debug, Clone)]
pub(in super::super::super) struct Light {
    /// Powers 0, 1, ... of the reflectance of the base.
    powers: Vec<Vec<f64>>,
    /// For each power of g, 1, 2, ...: diffuse light that a direction sees, and the distribution of its own
    /// light.
    own: Vec<Own<Vec<f64>>>,
    /// Products of terms of the reflectance, for each order that is exact.
    products: Vec<Products>,
    extrapolation: Extrapolation,
}

/// Diffuse light that leaves, is reflected by the base, and arrives there.
#[derive(Debug, Clone)]
pub(in super::super::super) struct Own<T> {
    pub(in super::super::super) leaving: T,
    pub(in super::super::super) reflected: T,
    pub(in super::super::super) arriving: T,
}

impl Narrow {
    /// Computes the light over a base; `terms` are its reflectances at [`Self::squares`].
    pub(in super::super) fn light(&self, r: Columns<'_>, terms: Vec<Vec<f64>>) -> Light {
        let (n, s) = (r.count, self.straight);
        let ones = vec![1.0; self.air.len() * n];
        let times_r = |light: &Vec<f64>| Some(light.iter().zip(r.air).map(|(l, r)| l * r).collect());
        let powers = std::iter::successors(Some(ones), times_r).take(self.shares.len() + 2).collect();
        let reaching = |row: &[f64]| s + (1.0 - s) * row.iter().sum::<f64>();
        let arriving = self.up.chunks_exact(self.glass.len()).map(reaching);
        let mut now = Own {
            leaving: self.reflected(r, &self.leaving, &self.leaving_straight),
            reflected: self.reflected(r, &vec![1.0; self.glass.len()], &vec![1.0; self.air.len()]),
            arriving: arriving.flat_map(|share| std::iter::repeat_n(share, n)).collect(),
        };
        let mut own = Vec::with_capacity(self.shares.len());
        for _ in &self.shares {
            let scattered = now.each(|light| self.scattered(light, r));
            if s > 0.0 {
                now = now.with(&scattered, |light, scattered| {
                    let unscattered = light.iter().zip(r.air).map(|(light, r)| s * s * r * light);
                    unscattered.zip(scattered).map(|(a, b)| a + b).collect()
                });
            } else {
                now.clone_from(&scattered);
            }
            own.push(scattered);
        }
        Light {
            powers,
            own,
            products: terms
                .into_iter()
                .zip(2..)
                .map(|(terms, order)| Products::new(terms, n, order))
                .collect(),
            extrapolation: self.extrapolation,
        }
    }

    /// Returns light above the diffuser after one reflection by the base, of which these fractions are seen.
    fn reflected(&self, r: Columns<'_>, of_scattered: &[f64], of_straight: &[f64]) -> Vec<f64> {
        let (n, s) = (r.count, self.straight);
        let mut below = r.glass.to_vec();
        for (row, share) in below.chunks_exact_mut(n).zip(of_scattered) {
            row.iter_mut().for_each(|value| *value *= (1.0 - s) * share);
        }
        let mut light = vec![0.0; self.air.len() * n];
        add_product(&self.up, &below, self.glass.len(), &mut light);
        for ((row, r), share) in light.chunks_exact_mut(n).zip(r.air.chunks_exact(n)).zip(of_straight) {
            row.iter_mut().zip(r).for_each(|(value, r)| *value += s * share * r);
        }
        light
    }

    /// Returns light above the diffuser after one pass in which it was scattered.
    fn scattered(&self, light: &[f64], r: Columns<'_>) -> Vec<f64> {
        let s = self.straight;
        let mut below = vec![0.0; self.glass.len() * r.count];
        add_product(&self.down, light, self.air.len(), &mut below);
        below.iter_mut().zip(r.glass).for_each(|(value, r)| *value *= (1.0 - s) * (1.0 - s) * r);
        let mut out = vec![0.0; light.len()];
        add_product(&self.up, &below, self.glass.len(), &mut out);
        if s > 0.0 {
            let mut across = vec![0.0; light.len()];
            add_product(&self.within, light, self.air.len(), &mut across);
            let once = s * (1.0 - s);
            out.iter_mut().zip(&across).zip(r.air).for_each(|((o, a), r)| *o += once * r * a);
            let before: Vec<f64> = light.iter().zip(r.air).map(|(l, r)| once * l * r).collect();
            add_product(&self.within, &before, self.air.len(), &mut out);
        }
        out
    }
}

impl<T> Own<T> {
    fn each(&self, f: impl Fn(&T) -> T) -> Self {
        Self { leaving: f(&self.leaving), reflected: f(&self.reflected), arriving: f(&self.arriving) }
    }

    fn with(&self, other: &Self, f: impl Fn(&T, &T) -> T) -> Self {
        Self {
            leaving: f(&self.leaving, &other.leaving),
            reflected: f(&self.reflected, &other.reflected),
            arriving: f(&self.arriving, &other.arriving),
        }
    }
}

impl Light {
    /// Returns the values at these weights of a function at the nodes.
    fn at(function: &[f64], weights: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; function.len() / weights.len().max(1)];
        add_product(weights, function, weights.len(), &mut sum);
        sum
    }

    /// Returns the recycled light of a view that does not depend on directed sources.
    pub(in super::super::super) fn own(&self, view: &Seen, g: &[f64]) -> Own<Vec<f64>> {
        let sum = |of: fn(&Own<Vec<f64>>) -> &Vec<f64>| {
            series(self.own.iter().map(|own| Self::at(of(own), &view.0)).collect(), g, false)
        };
        Own {
            leaving: sum(|own| &own.leaving),
            reflected: sum(|own| &own.reflected),
            arriving: sum(|own| &own.arriving),
        }
    }

    /// Returns `pi` times the recycled kernel between a view and the groups of a source, each with its round trips.
    pub(in super::super) fn between(
        &self,
        view: &Seen,
        source: &[(&Towards, &[f64])],
        g: &[f64],
    ) -> Vec<f64> {
        let mut orders = vec![vec![0.0; g.len()]; self.own.len()];
        for (group, round_trips) in source {
            for (sum, order) in orders.iter_mut().zip(self.orders(view, &group.lobe)) {
                add_times(sum, &order, round_trips, 1.0);
            }
        }
        self.correct(source, &mut orders);
        series(orders, g, false)
    }

    /// Replaces the closed form of the orders that are exact, and multiplies the later ones by a power of the
    /// ratio. It is that of all groups together.
    fn correct(&self, source: &[(&Towards, &[f64])], orders: &mut [Vec<f64>]) {
        let Some(last) = self.products.len().checked_sub(1) else { return };
        if source.iter().any(|(group, _)| group.exact.is_empty()) {
            return;
        }
        let closed = orders[last].clone();
        for (k, (products, order)) in self.products.iter().zip(&mut *orders).enumerate() {
            let forms: Vec<&[f64]> = source.iter().map(|(group, _)| &group.exact[k][..]).collect();
            let mut values = vec![0.0; forms.len() * order.len()];
            products.add((&forms.concat(), forms.len()), false, order.len(), &mut values);
            let columns = order.len();
            order.fill(0.0);
            for (values, (_, round_trips)) in values.chunks_exact(columns).zip(source) {
                add_times(order, values, round_trips, 1.0);
            }
        }
        let ratio = |(exact, closed): (&f64, &f64)| {
            if *closed > 0.0 { (exact / closed).clamp(0.0, LARGEST_CORRECTION) } else { 1.0 }
        };
        let ratios: Vec<f64> = orders[last].iter().zip(&closed).map(ratio).collect();
        for (k, order) in orders.iter_mut().enumerate().skip(last + 1) {
            let exponent = self.extrapolation.exponent(k + 2, last + 2);
            order.iter_mut().zip(&ratios).for_each(|(order, ratio)| *order *= ratio.powf(exponent));
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
        Some(series(self.orders(view, source.wider.as_ref()?), g, truncated))
    }

    /// Returns orders 2, 3, ... of the series, without the powers of g.
    fn orders(&self, view: &Seen, weights: &Weights) -> Vec<Vec<f64>> {
        let of_view: Vec<Vec<f64>> =
            self.powers.iter().take(weights.len() + 2).map(|power| Self::at(power, &view.0)).collect();
        let order = |(k, weights): (usize, &Vec<f64>)| {
            let passes = k + 2;
            let mut sum = vec![0.0; of_view[0].len()];
            for (met, of_view) in of_view.iter().enumerate().take(passes + 1) {
                // The first and the last lobe deflect from or to the end of the path.
                let times = if met == 0 || met == passes { 1.0 } else { 2.0 };
                let scale = times / (2 * passes) as f64;
                let of_source = Self::at(&self.powers[passes - met], weights);
                for ((sum, v), l) in sum.iter_mut().zip(of_view).zip(of_source) {
                    *sum += scale * v * l;
                }
            }
            sum
        };
        weights.iter().enumerate().map(order).collect()
    }
}

/// Returns the sum of terms times g, g², ...; those that follow, unless it is truncated, are a geometric
/// series.
fn series(terms: Vec<Vec<f64>>, g: &[f64], truncated: bool) -> Vec<f64> {
    let mut sum = vec![0.0; g.len()];
    for (k, (sum, g)) in sum.iter_mut().zip(g).enumerate() {
        let (mut power, mut last, mut ratio) = (1.0, 0.0, 0.0);
        for term in &terms {
            power *= g;
            let next = power * term[k];
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
const LARGEST_RATIO: f64 = 0.95;
