//! Line and edge spread as polynomials, and their exact transforms.
//!
//! **What.** The light of all places with the same x, `L(x)`, is smooth between the features of a spread. On
//! each panel of a graded rule it is the polynomial through the values at Gauss's nodes, a sum of Legendre
//! polynomials `P_l`. Everything about one axis follows from the coefficients:
//!
//! - the edge spread, from `integral of P_l = (P_(l+1) - P_(l-1))/(2l + 1)`;
//! - the transform at any frequency, from `integral of P_l(t) exp(-i k t) dt = 2 (-i)^l j_l(k)`, with
//!   spherical Bessel functions `j_l`.
//!
//! **Intuition.** A transform by summing phases over directions must resolve the phase of the highest
//! frequency, in two dimensions. Here no phase is resolved: panels follow the light alone, and a high
//! frequency costs as little as a low one.
//!
//! **Source.** Bakhvalov and Vasil'eva, USSR Comput. Math. Math. Phys. 8, 241 (1968): Legendre expansions of
//! oscillating integrals.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::PointSpread;
use crate::numerics::bessel::spherical;
use crate::numerics::quadrature::MOST_POINTS;

/// Light by place along an axis, for several states of a pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct LineSpread {
    states: usize,
    /// Panels, ascending and without gaps.
    pieces: Vec<Piece>,
    /// Places of sharp images, mm, and their light by state.
    images: Vec<(f64, Vec<f64>)>,
}

/// Light of a panel.
#[derive(Debug, Clone, PartialEq)]
struct Piece {
    middle: f64,
    half: f64,
    /// Coefficients of Legendre polynomials over -1 to 1, times the half width, `[order][state]`.
    orders: Vec<f64>,
    /// Light of all panels before this one, `[state]`.
    before: Vec<f64>,
}

impl LineSpread {
    /// Integrates a spread along the other axis (axis 0: light by x). `reflectance` writes the reflectance of
    /// each state at a `|beta|^2`.
    pub fn new(
        points: &PointSpread<'_>,
        axis: usize,
        states: usize,
        reflectance: impl Fn(f64, &mut [f64]),
    ) -> Self {
        let (mut light, mut rho) = (vec![0.0; states], vec![0.0; states]);
        let mut sums = vec![0.0; states];
        let mut pieces = Vec::new();
        points.panels_along(axis, |[from, to], nodes| {
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            let mut orders = vec![0.0; nodes.len() * states];
            for node in nodes {
                light.fill(0.0);
                points.line(axis, node.x, |beta_squared, weight| {
                    reflectance(beta_squared, &mut rho);
                    light.iter_mut().zip(&rho).for_each(|(light, rho)| *light += weight * rho);
                });
                let polynomials = Legendre::at((node.x - middle) / half);
                for (order, (row, p)) in orders.chunks_exact_mut(states).zip(polynomials).enumerate() {
                    let factor = (order as f64 + 0.5) * node.weight * p;
                    row.iter_mut().zip(&light).for_each(|(sum, light)| *sum += factor * light);
                }
            }
            let before = sums.clone();
            sums.iter_mut().zip(&orders).for_each(|(sum, mean)| *sum += 2.0 * mean);
            pieces.push(Piece { middle, half, orders, before });
        });
        let image = |image: &super::Image| {
            reflectance(image.beta_squared, &mut rho);
            (image.at_mm[axis], rho.iter().map(|rho| image.weight * rho).collect())
        };
        Self { states, pieces, images: points.images().iter().map(image).collect() }
    }

    /// The same light, of which this part is seen, farther away by a displacement along the axis, mm.
    #[must_use]
    pub fn moved(&self, by_mm: f64, part: f64) -> Self {
        let mut moved = self.clone();
        for piece in &mut moved.pieces {
            piece.middle += by_mm;
            piece.orders.iter_mut().chain(&mut piece.before).for_each(|light| *light *= part);
        }
        for (at_mm, light) in &mut moved.images {
            *at_mm += by_mm;
            light.iter_mut().for_each(|light| *light *= part);
        }
        moved
    }

    /// Adds the transform `integral of L(x) exp(-2 pi i f x) dx` of each state at a frequency in cycles per
    /// mm.
    pub fn add_transfer(&self, frequency_per_mm: f64, sums: &mut [Complex64]) {
        let wave = 2.0 * PI * frequency_per_mm;
        let mut bessel = [0.0; MOST_POINTS];
        // (-i)^l
        let turns = [Complex64::ONE, -Complex64::I, -Complex64::ONE, Complex64::I];
        for piece in &self.pieces {
            let orders = piece.orders.len() / self.states;
            let bessel = &mut bessel[..orders];
            spherical((wave * piece.half).abs(), bessel);
            let phase = 2.0 * Complex64::cis(-wave * piece.middle);
            let rows = piece.orders.chunks_exact(self.states).zip(bessel.iter()).enumerate();
            for (order, (row, j)) in rows {
                let sign = if wave < 0.0 && order % 2 == 1 { -1.0 } else { 1.0 };
                let factor = phase * turns[order % 4] * (sign * j);
                sums.iter_mut().zip(row).for_each(|(sum, light)| *sum += factor * light);
            }
        }
        for (at, light) in &self.images {
            let phase = Complex64::cis(-wave * at);
            sums.iter_mut().zip(light).for_each(|(sum, light)| *sum += phase * light);
        }
    }

    /// Adds the light of each state from below a place, mm; an image at the place counts half.
    pub fn add_below(&self, at_mm: f64, sums: &mut [f64]) {
        let next = self.pieces.partition_point(|piece| piece.middle - piece.half < at_mm);
        if let Some(piece) = next.checked_sub(1).and_then(|last| self.pieces.get(last)) {
            let t = ((at_mm - piece.middle) / piece.half).min(1.0);
            sums.iter_mut().zip(&piece.before).for_each(|(sum, before)| *sum += before);
            // P_(l-1), P_l and P_(l+1)
            let mut before = -1.0;
            let mut values = Legendre::at(t).peekable();
            for (order, row) in piece.orders.chunks_exact(self.states).enumerate() {
                let (Some(here), Some(&after)) = (values.next(), values.peek()) else { break };
                let integral = (after - before) / (2 * order + 1) as f64;
                before = here;
                sums.iter_mut().zip(row).for_each(|(sum, light)| *sum += integral * light);
            }
        }
        for (at, light) in self.images.iter().filter(|(at, _)| *at <= at_mm) {
            let step = if *at == at_mm { 0.5 } else { 1.0 };
            sums.iter_mut().zip(light).for_each(|(sum, light)| *sum += step * light);
        }
    }
}

/// Legendre polynomials of ascending order at a place.
struct Legendre {
    t: f64,
    order: f64,
    before: f64,
    value: f64,
}

impl Legendre {
    fn at(t: f64) -> Self {
        Self { t, order: 0.0, before: 0.0, value: 1.0 }
    }
}

impl Iterator for Legendre {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        let value = self.value;
        let next =
            ((2.0 * self.order + 1.0) * self.t * value - self.order * self.before) / (self.order + 1.0);
        (self.before, self.value, self.order) = (value, next, self.order + 1.0);
        Some(value)
    }
}

#[cfg(test)]
mod tests {
    use papilio_optics::Beta;
    use papilio_optics::lobe::Lobe;

    use super::super::{Accuracy, Gap, Light, Spread};
    use super::*;
    use crate::Diffuser;

    fn spread(width: f64, view: Beta, light: Light, digits: f64) -> Spread {
        let diffuser = Diffuser {
            lobe: Lobe::KCorrelation { width },
            transmittance: vec![1.0].into(),
            regular_fraction: 0.1,
        };
        let accuracy = Accuracy { digits, most_per_mm: 6.0 };
        Spread::new(&diffuser, Gap { index: 1.5, thickness_mm: 0.5 }, view, light, accuracy)
    }

    fn line(spread: &Spread, axis: usize) -> LineSpread {
        LineSpread::new(&spread.point_spread(), axis, 1, |beta_squared, rho| {
            rho[0] = 1.0 - 0.3 * beta_squared
        })
    }

    fn transfer(line: &LineSpread, f: f64) -> Complex64 {
        let mut sums = [Complex64::ZERO];
        line.add_transfer(f, &mut sums);
        sums[0]
    }

    /// The transform of the line is that of the directions, which resolves phases.
    #[test]
    fn transfer_is_that_of_all_directions() {
        let [view, beam] = [Beta { x: 0.5, y: 0.2 }, Beta { x: -0.2, y: 0.3 }];
        for width in [0.01, 0.05667, 0.3] {
            for light in [Light::Diffuse, Light::Beam(beam)] {
                let spread = spread(width, view, light, 11.0);
                for axis in [0, 1] {
                    let line = line(&spread, axis);
                    let total = transfer(&line, 0.0).re;
                    for f in [0.0, 0.7, -2.0, 6.0] {
                        let mut frequency = [0.0; 2];
                        frequency[axis] = f;
                        let expected = spread.transfer(frequency, |beta_squared| 1.0 - 0.3 * beta_squared);
                        let found = transfer(&line, f);
                        assert!(
                            (found - expected).norm() < 1e-4 * total,
                            "{width} {light:?} {axis} {f}: {found} {expected}"
                        );
                    }
                }
            }
        }
    }

    /// Light below a place is that of strips, and ends with the total; a finer rule changes little.
    #[test]
    fn edge_is_the_sum_of_strips() {
        let view = Beta { x: 0.5, y: 0.2 };
        let places = [-0.7, -0.02, 0.0, 0.011, 0.4];
        for width in [1e-4, 0.05667] {
            let spread = spread(width, view, Light::Diffuse, 10.0);
            for axis in [0, 1] {
                let line = line(&spread, axis);
                let strips = spread.point_spread().strips(axis, &places).sums(|b| 1.0 - 0.3 * b);
                let mut sum = 0.0;
                let total = transfer(&line, 0.0).re;
                for (place, strip) in places.iter().zip(&strips) {
                    sum += strip;
                    let mut found = [0.0];
                    line.add_below(*place, &mut found);
                    assert!((found[0] - sum).abs() < 2e-5 * total, "{width} {place}: {found:?} {sum}");
                }
                let mut found = [0.0];
                line.add_below(1e9, &mut found);
                assert!((found[0] - total).abs() < 1e-12 * total, "{found:?} {total}");
            }
        }
    }
}
