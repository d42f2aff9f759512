//! Diffuse light at the nodes of air: the sum of its series.

use std::sync::{Arc, Mutex, PoisonError};

use super::super::grid::Columns;
use super::Narrow;
use super::light::LARGEST_RATIO;
use crate::numerics::product::add_product;

/// Diffuse light that a direction sees: that leaves, is reflected by the base, and the fraction of the
/// direction's own light that arrives there.
#[derive(Debug, Clone)]
pub(in super::super::super) struct Own<T> {
    pub(in super::super::super) leaving: T,
    pub(in super::super::super) reflected: T,
    pub(in super::super::super) arriving: T,
}

/// Diffuse light over a base, `[node][column]`, under the last front.
#[derive(Debug)]
pub(super) struct Diffuse {
    /// Reflectance of the base at the nodes in the glass.
    glass: Vec<f64>,
    last: Mutex<Arc<Summed>>,
}

/// Sum of the series, and the fraction of each column that the front sends back.
#[derive(Debug)]
struct Summed {
    g: Vec<f64>,
    light: Own<Vec<f64>>,
}

impl Clone for Diffuse {
    fn clone(&self) -> Self {
        Self { glass: self.glass.clone(), last: Mutex::new(self.last()) }
    }
}

impl Diffuse {
    pub(super) fn new(of: &Narrow, r: Columns<'_>, g: &[f64]) -> Self {
        let first = Summed { g: g.to_vec(), light: of.diffuse(r, g) };
        Self { glass: r.glass.to_vec(), last: Mutex::new(first.into()) }
    }

    /// Returns what `view` returns for the light under a front that sends back these fractions; `air` is the
    /// reflectance at the nodes in air. Under another front than before, the light is computed first.
    pub(super) fn under<T>(
        &self,
        of: &Narrow,
        air: &[f64],
        g: &[f64],
        view: impl Fn(&Vec<f64>) -> T,
    ) -> Own<T> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if last.g != g {
            let r = Columns { count: g.len(), glass: &self.glass, air };
            *last = Summed { g: g.to_vec(), light: of.diffuse(r, g) }.into();
        }
        let summed = Arc::clone(&last);
        drop(last);
        let Own { leaving, reflected, arriving } = &summed.light;
        Own { leaving: view(leaving), reflected: view(reflected), arriving: view(arriving) }
    }

    fn last(&self) -> Arc<Summed> {
        Arc::clone(&self.last.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Room for the light on its way through a pass.
struct Room {
    glass: Vec<f64>,
    air: Vec<f64>,
}

impl Narrow {
    /// Returns the sum of the series of diffuse light over a base, under a front that sends back the fraction
    /// `g` of each column.
    fn diffuse(&self, r: Columns<'_>, g: &[f64]) -> Own<Vec<f64>> {
        let s = self.straight;
        let reaching = |row: &[f64]| s + (1.0 - s) * row.iter().sum::<f64>();
        let arriving = self.up.chunks_exact(self.glass.len()).map(reaching);
        let leaving = self.reflected(r, &self.leaving, &self.leaving_straight);
        let reflected = self.reflected(r, &vec![1.0; self.glass.len()], &vec![1.0; self.air.len()]);
        Own {
            leaving: self.summed(leaving, r, g),
            reflected: self.summed(reflected, r, g),
            arriving: self.summed(
                arriving.flat_map(|share| std::iter::repeat_n(share, r.count)).collect(),
                r,
                g,
            ),
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

    /// Returns the sum of this light after 1, 2, ... passes, in the last of which it was scattered, times g,
    /// g², ...; the orders that are not computed are a geometric series.
    fn summed(&self, mut light: Vec<f64>, r: Columns<'_>, g: &[f64]) -> Vec<f64> {
        let (n, s) = (r.count, self.straight);
        let zeros = || vec![0.0; light.len()];
        let (mut sum, mut term, mut before) = (zeros(), zeros(), zeros());
        let mut room = Room { glass: vec![0.0; self.glass.len() * n], air: zeros() };
        for _ in &self.shares {
            std::mem::swap(&mut term, &mut before);
            self.scatter(&light, r, &mut room, &mut term);
            let rows = term.chunks_exact_mut(n).zip(sum.chunks_exact_mut(n));
            let own = light.chunks_exact_mut(n).zip(r.air.chunks_exact(n));
            for ((term, sum), (light, r)) in rows.zip(own) {
                for k in 0..n {
                    term[k] *= g[k];
                    sum[k] += term[k];
                    light[k] = term[k] + s * s * g[k] * r[k] * light[k];
                }
            }
        }
        for ((sum, last), before) in sum.iter_mut().zip(&term).zip(&before) {
            let ratio = if *before > 0.0 { last / before } else { 0.0 };
            if ratio > 0.0 && ratio < LARGEST_RATIO {
                *sum += last * ratio / (1.0 - ratio);
            }
        }
        sum
    }

    /// Computes light above the diffuser after one pass in which it was scattered.
    fn scatter(&self, light: &[f64], r: Columns<'_>, room: &mut Room, out: &mut [f64]) {
        let s = self.straight;
        room.glass.fill(0.0);
        add_product(&self.down, light, self.air.len(), &mut room.glass);
        room.glass.iter_mut().zip(r.glass).for_each(|(value, r)| *value *= (1.0 - s) * (1.0 - s) * r);
        out.fill(0.0);
        add_product(&self.up, &room.glass, self.glass.len(), out);
        if s > 0.0 {
            let once = s * (1.0 - s);
            room.air.fill(0.0);
            add_product(&self.within, light, self.air.len(), &mut room.air);
            out.iter_mut().zip(&room.air).zip(r.air).for_each(|((o, a), r)| *o += once * r * a);
            let before = room.air.iter_mut().zip(light).zip(r.air);
            before.for_each(|((before, light), r)| *before = once * r * light);
            add_product(&self.within, &room.air, self.air.len(), out);
        }
    }
}
