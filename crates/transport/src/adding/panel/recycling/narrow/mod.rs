//! Light that the front of screen sends back into the panel through a narrow lobe.
//!
//! A lobe much narrower than the disc of air would need a large grid. But the light that it scatters is
//! simple, for two reasons. First, of the lobes on its way (two for each reflection by the base) at most one
//! deflects light far: the k-correlation lobe falls off with the third power of the distance, so that two
//! large deflections are rarer by another factor b. Second, the lobe is a Poisson kernel: n lobes make one
//! of n times the width.
//!
//! **Diffuse light** depends on the radius alone, and is smooth except around the rim of the disc of air. A
//! few nodes represent it, with the true lobe ([`basis`]).
//!
//! **Between a view v and a source l**, order j of the series has 2j lobes. If lobe number i deflects the
//! light from v to l, light has met the base and the disc of air i - 1 lobes long around v and then around
//! l. With `s_a = (A R D)^a 1` and `r_a = (A R D)^a A R 1` (A: average over the disc of the glass, D: over
//! that of air, R: reflectance of the base), on which diffuse light depends too, and P the lobe of 2j times
//! the width,
//!
//! `P(v - l) / (2j) times the sum over a < j of s_a(v) r_(j-1-a)(l) + r_a(v) s_(j-1-a)(l)`.
//!
//! This is exact for b = 0 and, of a uniform base without rims, for any b. Its error is of the order of b.
//! From the second level on, a grid for a wider lobe W shows this error there, and b/W of it is added (both
//! are analytic in the width): an error of the order of b (W - b) remains. The finer the level, the narrower
//! W, down to b.

mod basis;

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};

use super::grid::Columns;
use super::product;
use crate::adding::panel::first_pass::Pass;
use crate::adding::quadrature::Point;
use crate::product::add_product;
use basis::{Basis, Disc, for_table};

/// One width of the lobe: averages between the nodes in air and in the glass.
#[derive(Debug, Clone)]
pub(in super::super) struct Narrow {
    width: f64,
    straight: f64,
    air: Basis,
    glass: Basis,
    /// Over the disc of the glass `[air][glass]`, over that of air `[glass][air]` and, if the diffuser has
    /// regular transmittance, `[air][air]`.
    up: Vec<f64>,
    down: Vec<f64>,
    within: Vec<f64>,
    /// Fraction of light at the underside of the diffuser that leaves, in directions of the glass and of air.
    leaving: Vec<f64>,
    leaving_straight: Vec<f64>,
    /// For each order 2, 3, ... the fractions of light that meets 0, 1, ... lobes.
    shares: Vec<Vec<f64>>,
}

/// Light at the nodes of air over a base, `[node][column]`; columns are `[state][wavelength]`.
#[derive(Debug, Clone)]
pub(in super::super) struct Light {
    /// `s_a` and `r_a`, a = 0, 1, ... (see above).
    sent: Vec<Vec<f64>>,
    back: Vec<Vec<f64>>,
    /// For each power of g, 1, 2, ...: diffuse light that a direction sees, and the distribution of its own
    /// light. Empty for the wider lobe.
    own: Vec<Own<Vec<f64>>>,
}

/// Diffuse light that leaves, is reflected by the base, and arrives there.
#[derive(Debug, Clone)]
pub(in super::super) struct Own<T> {
    pub(in super::super) leaving: T,
    pub(in super::super) reflected: T,
    pub(in super::super) arriving: T,
}

/// A view's weights on the nodes of air.
#[derive(Debug, Clone)]
pub(in super::super) struct Seen(Vec<f64>);

/// A source as seen by a view: for each order 2, 3, ... weights on the nodes of air that contain the lobe.
#[derive(Debug, Clone)]
pub(in super::super) struct Towards(Vec<Vec<f64>>);

impl Towards {
    /// Returns the lobe of order 2 between view and source.
    pub(in super::super) fn lobe(&self) -> f64 {
        self.0.first().map_or(0.0, |weights| weights.iter().sum())
    }
}

impl Narrow {
    /// Prepares this width for `orders` orders of the series, with errors of `exp(-digits)`.
    pub(super) fn new(pass: &Pass<'_>, width: f64, orders: usize, digits: f64) -> Self {
        let (lobe, straight) = (Lobe::KCorrelation { width }, pass.straight());
        let basis = |disc| Basis::new(disc, width, digits, for_table(pass, disc));
        let (air, glass) = (basis(Disc::Air), basis(Disc::Glass(pass.index)));
        let averages = |of: &Basis, at: &Basis| of.averages(lobe, width, &at.radii, digits + MORE_DIGITS);
        let leaving = |basis: &Basis| {
            let of = |radius: &f64| {
                let seen = if *radius <= 1.0 { straight } else { 0.0 };
                seen + (1.0 - straight) * lobe.fraction_in_disc(*radius, 1.0)
            };
            basis.radii.iter().map(of).collect()
        };
        Self {
            width,
            straight,
            up: averages(&glass, &air),
            down: averages(&air, &glass),
            within: if straight > 0.0 { averages(&air, &air) } else { Vec::new() },
            leaving: leaving(&glass),
            leaving_straight: leaving(&air),
            shares: shares(straight, orders),
            air,
            glass,
        }
    }

    pub(super) fn width(&self) -> f64 {
        self.width
    }

    pub(super) fn nodes(&self) -> usize {
        self.air.len() + self.glass.len()
    }

    /// Returns the radii at which the reflectance of the base is needed: in the glass, and in air.
    pub(super) fn radii(&self) -> [&[f64]; 2] {
        let in_air: &[f64] = if self.straight > 0.0 { &self.air.radii } else { &[] };
        [&self.glass.radii, in_air]
    }

    /// Computes the light over a base, and that of diffuse light if requested.
    pub(super) fn light(&self, r: Columns<'_>, with_own: bool) -> Light {
        let (n, s, nodes) = (r.count, self.straight, self.air.len());
        let ones = vec![1.0; nodes * n];
        let back = self.reflected(r, &vec![1.0; self.glass.len()], &vec![1.0; nodes]);
        let mut blocks = vec![ones, back];
        if with_own {
            blocks.push(self.reflected(r, &self.leaving, &self.leaving_straight));
            let reaching = |row: &[f64]| s + (1.0 - s) * row.iter().sum::<f64>();
            let arriving = self.up.chunks_exact(self.glass.len()).map(reaching);
            blocks.push(arriving.flat_map(|share| std::iter::repeat_n(share, n)).collect());
        }
        let mut light = Light { sent: Vec::new(), back: Vec::new(), own: Vec::new() };
        for _ in &self.shares {
            let scattered: Vec<Vec<f64>> = blocks.iter().map(|block| self.scattered(block, r)).collect();
            if let [_, reflected, leaving, arriving] = &scattered[..] {
                let [leaving, reflected, arriving] = [leaving, reflected, arriving].map(Clone::clone);
                light.own.push(Own { leaving, reflected, arriving });
            }
            let last = std::mem::replace(&mut blocks, scattered);
            if s > 0.0 {
                for (block, last) in blocks.iter_mut().zip(&last) {
                    block.iter_mut().zip(last).zip(r.air).for_each(|((b, l), r)| *b += s * s * r * l);
                }
            }
            let mut last = last.into_iter();
            light.sent.extend(last.next());
            light.back.extend(last.next());
        }
        let mut last = blocks.into_iter();
        light.sent.extend(last.next());
        light.back.extend(last.next());
        light
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

    /// Returns a view's weights.
    pub(in super::super) fn seen(&self, view: &[Point]) -> Seen {
        let mut sum = vec![0.0; self.air.len()];
        for point in view {
            self.air.add_values(point.beta.length(), point.weight, &mut sum);
        }
        Seen(sum)
    }

    /// Returns a source as seen by a view.
    pub(in super::super) fn towards(&self, view: &[Point], source: &[Point]) -> Towards {
        let mut all = vec![vec![0.0; self.air.len()]; self.shares.len()];
        // Points of a ring follow each other.
        let same = |a: &Point, b: &Point| (a.beta.length() - b.beta.length()).abs() < SAME_RING;
        for ring in source.chunk_by(same) {
            for (shares, sum) in self.shares.iter().zip(&mut all) {
                let lobe = |away: Beta| -> f64 {
                    let met = shares.iter().enumerate().skip(1).filter(|(_, share)| **share > 0.0);
                    let one = |(n, share): (usize, &f64)| {
                        let lobe = Lobe::KCorrelation { width: n as f64 * self.width };
                        share * lobe.density(Beta::default(), away)
                    };
                    met.map(one).sum()
                };
                let of = |v: &Point, l: &Point| v.weight * l.weight * lobe(l.beta - v.beta);
                let weight: f64 = view.iter().flat_map(|v| ring.iter().map(move |l| of(v, l))).sum();
                self.air.add_values(ring[0].beta.length(), PI * weight, sum);
            }
        }
        Towards(all)
    }
}

/// Natural digits of averages beyond those of the basis.
const MORE_DIGITS: f64 = 2.0;

/// Difference below which two radii belong to one ring.
const SAME_RING: f64 = 1e-12;

/// Returns for each order 2, 3, ... the fractions of light that meets 0, 1, ... lobes: both ends of a path
/// are scattered at least once in their pass (see [`super`]), unscattered passes are possible between them.
fn shares(straight: f64, orders: usize) -> Vec<Vec<f64>> {
    let (s, t) = (straight, 1.0 - straight);
    let scattered = [0.0, 2.0 * s * t, t * t];
    let first = product(&scattered, &scattered);
    std::iter::successors(Some(first), |last| Some(product(last, &[s * s, 2.0 * s * t, t * t])))
        .take(orders)
        .collect()
}

/// Values of a light's functions in a view, `[order][column]`.
pub(in super::super) struct AtView {
    sent: Vec<Vec<f64>>,
    back: Vec<Vec<f64>>,
}

impl Light {
    /// Returns the values at these weights of a function at the nodes.
    fn at(function: &[f64], weights: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; function.len() / weights.len().max(1)];
        add_product(weights, function, weights.len(), &mut sum);
        sum
    }

    pub(in super::super) fn at_view(&self, view: &Seen) -> AtView {
        let all = |functions: &[Vec<f64>]| functions.iter().map(|f| Self::at(f, &view.0)).collect();
        AtView { sent: all(&self.sent), back: all(&self.back) }
    }

    /// Returns the recycled light of a view that does not depend on directed sources.
    pub(in super::super) fn own(&self, view: &Seen, g: &[f64]) -> Own<Vec<f64>> {
        let sum = |of: fn(&Own<Vec<f64>>) -> &Vec<f64>| {
            series(self.own.iter().map(|own| Self::at(of(own), &view.0)).collect(), g, false)
        };
        Own {
            leaving: sum(|own| &own.leaving),
            reflected: sum(|own| &own.reflected),
            arriving: sum(|own| &own.arriving),
        }
    }

    /// Returns `pi` times the recycled kernel between a view and a source; without orders that were not
    /// prepared if `truncated`.
    pub(in super::super) fn between(
        &self,
        view: &AtView,
        source: &Towards,
        g: &[f64],
        truncated: bool,
    ) -> Vec<f64> {
        let order = |(k, weights): (usize, &Vec<f64>)| {
            let last = k + 1;
            let mut sum = vec![0.0; g.len()];
            for a in 0..=last {
                let [back, sent] = [&self.back, &self.sent].map(|all| Self::at(&all[last - a], weights));
                let (of_sent, of_back) = (&view.sent[a], &view.back[a]);
                for (k, sum) in sum.iter_mut().enumerate() {
                    *sum += of_sent[k] * back[k] + of_back[k] * sent[k];
                }
            }
            let scale = 1.0 / (2 * (last + 1)) as f64;
            sum.iter_mut().for_each(|value| *value *= scale);
            sum
        };
        series(source.0.iter().enumerate().map(order).collect(), g, truncated)
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

/// Largest ratio of terms that is taken for that of a geometric series.
const LARGEST_RATIO: f64 = 0.95;
