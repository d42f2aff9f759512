//! A thick layer without fringes, as the waves of one azimuth meet it.
//!
//! Waves down and waves up are two invariant subspaces of Berreman's matrix D. Its characteristic polynomial is the product of those of D in both; by the
//! theorem of Cayley and Hamilton, the polynomial of the waves up, of D, turns any field into waves down, and the reverse. No eigenvector is needed, so
//! that light along an optic axis is an ordinary case. The waves of the reference that are turned so give what a half-space of the medium reflects.

use super::super::generator::Generator;
use super::super::lanes::{Complex, Element, LANES, Pair, Real};
use super::faces::Faces;
use super::root;

/// Square of a wave vector along the normal, over k0, that is not taken for 0: waves along a layer do not cross it, and the sum over their round trips would be 0/0.
const LEAST_SQUARE: f64 = 1e-14;

/// Square of a phase below which its tangent is a series, with an error of 5e-14.
const SMALL: f64 = 1e-4;

/// Most steps to the roots of a polynomial of fourth degree: double roots need the most.
const MOST_STEPS: usize = 60;

/// Transmission of thick layers whose faces to each other reflect nothing, without their outer faces.
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    pub(super) down: Pair,
    pub(super) up: Pair,
}

/// Thick layer: its faces to the reference, and its transmission in waves whose components down (or up) in the reference are 1.
#[derive(Clone, Copy)]
pub(super) struct Thick {
    pub(super) faces: Faces,
    pub(super) crossing: Crossing,
}

/// Returns the wave vector along the normal whose square this is: down, or decaying downwards.
#[inline(always)]
pub(super) fn wave_down(mut square: Complex) -> Complex {
    for k in 0..LANES {
        if square.re.0[k].abs() + square.im.0[k].abs() < LEAST_SQUARE {
            (square.re.0[k], square.im.0[k]) = (LEAST_SQUARE, 0.0);
        }
    }
    root(square)
}

/// Returns an anisotropic layer of k0 d = `depth`. `ordinary` is the square of the wave vector along the normal of the ordinary wave in a uniaxial medium.
#[inline(always)]
pub(super) fn anisotropic<T: Element>(
    generator: &Generator<T>,
    ordinary: Option<Complex>,
    depth: Real,
) -> Thick {
    let [down, up] = waves(generator, ordinary);
    let (zero, half) = (Complex::zero(), Complex::splat(0.5));
    // Waves of the reference: p and s down, p and s up.
    let reference = [
        [half, half, zero, zero],
        [zero, zero, half, half],
        [-half, half, zero, zero],
        [zero, zero, half, -half],
    ];
    let mut matrix = [[zero; 4]; 4];
    let mut turned = [[zero; 4]; 4];
    for (k, field) in reference.into_iter().enumerate() {
        let [a, b] = if k < 2 { up } else { down };
        let (sum, product) = (a + b, a * b);
        let once = generator.times(field, [zero; 4]);
        let twice = generator.times(once, [zero; 4]);
        let mut all = twice;
        for i in 0..4 {
            all[i] = all[i] - sum * once[i] + product * field[i];
        }
        matrix[k] = in_waves(once);
        turned[k] = in_waves(all);
    }
    let block = |columns: &[[Complex; 4]; 4], row: usize, column: usize| {
        let [a, b] = [columns[2 * column], columns[2 * column + 1]];
        Pair([[a[2 * row], b[2 * row]], [a[2 * row + 1], b[2 * row + 1]]])
    };
    let r = block(&turned, 1, 0) * block(&turned, 0, 0).inverse();
    let r_below = block(&turned, 0, 1) * block(&turned, 1, 1).inverse();
    let inside = block(&matrix, 0, 0) + block(&matrix, 0, 1) * r;
    let inside_up = block(&matrix, 1, 1) + block(&matrix, 1, 0) * r_below;
    let crossing =
        Crossing { down: exponential(inside, down, depth), up: exponential(inside_up, up, -depth) };
    Thick { faces: Faces { r, r_below }, crossing }
}

/// Returns a field as waves of the reference.
#[inline(always)]
fn in_waves([a, b, c, d]: [Complex; 4]) -> [Complex; 4] {
    [a + b, c + d, b - a, c - d]
}

/// Returns the eigenvalues of the matrix: of two waves down, and of two waves up.
#[inline(always)]
fn waves<T: Element>(generator: &Generator<T>, ordinary: Option<Complex>) -> [[Complex; 2]; 2] {
    let half = Real::splat(0.5);
    let mut power = [Complex::zero(); 4];
    for (power, own) in power.iter_mut().zip(generator.characteristic()) {
        *power = own.times(Complex::splat(1.0), Complex::zero());
    }
    let [zeroth, first, second, third] = power;
    if let Some(ordinary) = ordinary {
        // The rest of the polynomial is q^2 - third q + ordinary - second.
        let mean = third.scaled(half);
        let [own, other] = [wave_down(ordinary), wave_down(mean * mean + second - ordinary)];
        return [[own, mean + other], [-own, mean - other]];
    }
    let mean = second.scaled(half);
    let apart = root(mean * mean + zeroth);
    let [a, b] = [wave_down(mean + apart), wave_down(mean - apart)];
    let is_none = |value: Complex| value.size().max() < f64::EPSILON;
    if is_none(first) && is_none(third) {
        return [[a, b], [-a, -b]];
    }
    // All roots at once, by Weierstrass (Durand and Kerner): the mean of roots that are close to each other is exact.
    let spread = Complex::splat(1e-2);
    let mut roots = [a + spread, b - spread, -a - spread, spread - b];
    for _ in 0..MOST_STEPS {
        let mut change = Real::splat(0.0);
        for k in 0..4 {
            let q = roots[k];
            let value = (((q - third) * q - second) * q - first) * q - zeroth;
            let mut others = Complex::splat(1.0);
            for (other, root) in roots.iter().enumerate() {
                if other != k {
                    others = others * (q - *root);
                }
            }
            let step = value * others.inverse();
            for lane in 0..LANES {
                // Two roots that have become one.
                if others.re.0[lane] != 0.0 || others.im.0[lane] != 0.0 {
                    roots[k].re.0[lane] -= step.re.0[lane];
                    roots[k].im.0[lane] -= step.im.0[lane];
                    change.0[lane] = change.0[lane].max(step.re.0[lane].abs() + step.im.0[lane].abs());
                }
            }
        }
        if change.max() < 1e-15 {
            break;
        }
    }
    let [a, b, c, d] = roots;
    [[a, b], [c, d]]
}

/// Returns `exp(i depth matrix)` of a matrix with these eigenvalues.
#[inline(always)]
fn exponential(matrix: Pair, [a, b]: [Complex; 2], depth: Real) -> Pair {
    let half = Real::splat(0.5);
    let (mean, apart) = ((a + b).scaled(half), (a - b).scaled(half));
    let [plus, minus] = [a.scaled(depth).wave(), b.scaled(depth).wave()];
    let (cosine, phase) = ((plus + minus).scaled(half), apart.scaled(depth));
    let (square, size) = (phase * phase, phase.norm_sqr());
    // i times the sine over the phase, times depth.
    let mut sine = (plus - minus).scaled(half) * apart.inverse();
    let series = (square.scaled(Real::splat(2.0 / 15.0)) + Complex::splat(1.0 / 3.0)) * square;
    let small = (cosine * (series + Complex::splat(1.0))).scaled(depth);
    for k in 0..LANES {
        if size.0[k] < SMALL {
            (sine.re.0[k], sine.im.0[k]) = (-small.im.0[k], small.re.0[k]);
        }
    }
    let [[pp, ps], [sp, ss]] = matrix.0;
    Pair([[cosine + sine * (pp - mean), sine * ps], [sine * sp, cosine + sine * (ss - mean)]])
}
