//! Light without a phase: actions of layers on the coherency matrix, at several wavelengths.
//!
//! A coherency matrix `<E_i E_k*>` of p and s is held as four real numbers: pp, ss, and the real and the imaginary part of ps. That basis makes
//! elimination without pivots stable: its leading elements are those of light whose coherence, or whose s, is lost, of which no more returns than was sent.

use super::lanes::{Blocks, Complex, Pair, Real};
use crate::with_widest_simd;

/// Light by its coherency matrix, and what a meter makes of it.
pub(super) type Light = [Real; 4];

/// Action on a coherency matrix, by rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct Action(pub(super) [[Real; 4]; 4]);

impl Action {
    #[inline(always)]
    fn of(jones: Pair) -> Self {
        let [[a, b], [c, d]] = jones.0;
        let [ab, cd, ac, bd, ad, bc] =
            [times(a, b), times(c, d), times(a, c), times(b, d), times(a, d), times(b, c)];
        let twice = |x: Real| x + x;
        Self([
            [a.norm_sqr(), b.norm_sqr(), twice(ab.re), -twice(ab.im)],
            [c.norm_sqr(), d.norm_sqr(), twice(cd.re), -twice(cd.im)],
            [ac.re, bd.re, ad.re + bc.re, bc.im - ad.im],
            [ac.im, bd.im, ad.im + bc.im, ad.re - bc.re],
        ])
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut out = [[Real::splat(0.0); 4]; 4];
        with_widest_simd(
            #[inline(always)]
            || {
                for (row, out) in self.0.iter().zip(&mut out) {
                    for (value, other) in row.iter().zip(&other.0) {
                        for k in 0..4 {
                            out[k] = out[k] + *value * other[k];
                        }
                    }
                }
            },
        );
        Self(out)
    }

    fn plus(mut self, other: &Self) -> Self {
        for (row, other) in self.0.iter_mut().zip(&other.0) {
            for k in 0..4 {
                row[k] = row[k] + other[k];
            }
        }
        self
    }

    #[inline(always)]
    pub(super) fn on(&self, light: Light) -> Light {
        let mut out = [Real::splat(0.0); 4];
        for (row, out) in self.0.iter().zip(&mut out) {
            *out = dot(*row, light);
        }
        out
    }
}

/// Returns what a meter of these weights sees of light.
#[inline(always)]
pub(super) fn dot([a, b, c, d]: Light, [x, y, z, u]: Light) -> Real {
    a * x + b * y + c * z + d * u
}

/// Returns `x y*`.
#[inline(always)]
fn times(x: Complex, y: Complex) -> Complex {
    Complex { re: x.re * y.re + x.im * y.im, im: x.im * y.re - x.re * y.im }
}

/// Coherent layers between two thick ones.
#[derive(Debug, Clone, Copy)]
pub(super) struct Between {
    r: Action,
    t: Action,
    r_below: Action,
    t_up: Action,
}

impl Between {
    pub(super) fn new(blocks: &Blocks) -> Self {
        let Blocks { r, t, r_below, t_up } = *blocks;
        let [r, t, r_below, t_up] = actions([r, t, r_below, t_up]);
        Self { r, t, r_below, t_up }
    }

    /// Returns the reflection of these layers over what is below.
    pub(super) fn over(&self, below: &Action) -> Action {
        let (mut trips, mut down) = (self.open(below), self.t);
        with_widest_simd(
            #[inline(always)]
            || eliminate(&mut trips, &mut down.0),
        );
        self.r.plus(&self.t_up.times(&below.times(&down)))
    }

    /// Returns what a meter above sees of this light.
    pub(super) fn seen(&self, below: &Action, light: Light, meter: Light) -> Real {
        let mut trips = self.open(below);
        with_widest_simd(
            #[inline(always)]
            || {
                let mut down = self.t.on(light).map(|value| [value]);
                eliminate(&mut trips, &mut down);
                let up = self.t_up.on(below.on([down[0][0], down[1][0], down[2][0], down[3][0]]));
                dot(meter, self.r.on(light)) + dot(meter, up)
            },
        )
    }

    /// Returns 1 less a round trip.
    fn open(&self, below: &Action) -> [[Real; 4]; 4] {
        let mut trips = self.r_below.times(below).0;
        for (row, values) in trips.iter_mut().enumerate() {
            for (column, value) in values.iter_mut().enumerate() {
                *value = if row == column { Real::splat(1.0) - *value } else { -*value };
            }
        }
        trips
    }
}

/// Returns the actions of amplitudes.
pub(super) fn actions<const N: usize>(jones: [Pair; N]) -> [Action; N] {
    let mut out = [Action([[Real::splat(0.0); 4]; 4]); N];
    with_widest_simd(
        #[inline(always)]
        || {
            for k in 0..N {
                out[k] = Action::of(jones[k]);
            }
        },
    );
    out
}

/// Replaces the columns `x` by those of `matrix^-1 x`.
#[inline(always)]
fn eliminate<const N: usize>(matrix: &mut [[Real; 4]; 4], x: &mut [[Real; N]; 4]) {
    use super::lanes::Element;
    for pivot in 0..4 {
        let over = matrix[pivot][pivot].inverse();
        for value in matrix[pivot].iter_mut().chain(&mut x[pivot]) {
            *value = *value * over;
        }
        let (own, of_x) = (matrix[pivot], x[pivot]);
        for (row, (values, x)) in matrix.iter_mut().zip(x.iter_mut()).enumerate() {
            if row == pivot {
                continue;
            }
            let factor = values[pivot];
            for (value, own) in values.iter_mut().zip(own).chain(x.iter_mut().zip(of_x)) {
                *value = *value - factor * own;
            }
        }
    }
}
