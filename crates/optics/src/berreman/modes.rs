//! Waves that travel down and up in a medium.
//!
//! Fields are `(Ex, Hy, Ey, -Hx)` in the frame of the wave: x along its travel, z down. H is in units in which
//! that of a plane wave in vacuum has the size of E.

use std::f64::consts::FRAC_PI_4;

use num_complex::Complex64;

use super::Dielectric;
use super::matrix::{Matrix, Scattering};

/// Fields of two waves.
type Pair = [[Complex64; 4]; 2];

/// Two waves down and two waves up; in an isotropic medium p and s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Modes {
    pub(super) down: Pair,
    pub(super) up: Pair,
}

impl Modes {
    /// Waves of an isotropic medium: E has length 1. The wave decays where it travels: Im q >= 0.
    pub(super) fn isotropic(index: Complex64, beta: f64) -> Self {
        Self::with(index, vertical(index, beta))
    }

    /// Waves of unit power in an artificial medium in which `q = 1`.
    pub(super) fn reference(beta: f64) -> Self {
        Self::with((1.0 + beta * beta).sqrt().into(), Complex64::ONE)
    }

    fn with(index: Complex64, q: Complex64) -> Self {
        let (zero, one) = (Complex64::ZERO, Complex64::ONE);
        Self {
            down: [[q / index, index, zero, zero], [zero, zero, one, q]],
            up: [[-q / index, index, zero, zero], [zero, zero, one, -q]],
        }
    }

    /// Waves of any medium, as those of its mean index projected onto its invariant subspaces; and the
    /// propagation of both pairs over k0 d = `depth`, each in its own direction.
    ///
    /// The matrix sign function separates the modes by the sign of Re(q exp(-i pi/4)): those that travel down have q > 0,
    /// or, where they decay, Im q > 0.
    pub(super) fn anisotropic(
        dielectric: &Dielectric,
        azimuth_deg: f64,
        beta: f64,
        depth: f64,
    ) -> (Self, [Matrix<2>; 2]) {
        let berreman = berreman(&dielectric.for_wave(azimuth_deg), beta);
        let sign = sign(berreman.times(Complex64::from_polar(1.0, -FRAC_PI_4)));
        let near = Self::isotropic(dielectric.mean_index(), beta);
        let project = |pair: Pair, side: f64| {
            pair.map(|wave| {
                let row = |k: usize| -> Complex64 { (0..4).map(|j| sign.0[k][j] * wave[j]).sum() };
                std::array::from_fn(|k| 0.5 * (wave[k] + side * row(k)))
            })
        };
        let modes = Self { down: project(near.down, 1.0), up: project(near.up, -1.0) };
        let all = modes.columns();
        let inside = all.solve(berreman * all);
        let (down, up) = (inside.block(0, 0), inside.block(1, 1).times(-Complex64::ONE));
        (modes, [down, up].map(|q| exponential(q.times(Complex64::I * depth))))
    }

    /// Returns the fields as columns: down, down, up, up.
    pub(super) fn columns(&self) -> Matrix<4> {
        Matrix::of_columns([self.down[0], self.down[1], self.up[0], self.up[1]])
    }

    /// Returns the scattering matrix of the face between this medium and the one below.
    pub(super) fn face(&self, below: &Self) -> Scattering<2> {
        // Continuous fields: what leaves the face, from what arrives.
        let negative = |wave: [Complex64; 4]| wave.map(|value| -value);
        let leaving =
            Matrix::of_columns([self.up[0], self.up[1], negative(below.down[0]), negative(below.down[1])]);
        let arriving =
            Matrix::of_columns([negative(self.down[0]), negative(self.down[1]), below.up[0], below.up[1]]);
        let all = leaving.solve(arriving);
        Scattering { r: all.block(0, 0), t: all.block(1, 0), r_below: all.block(1, 1), t_up: all.block(0, 1) }
    }
}

/// Returns q = sqrt(n^2 - beta^2), Im q >= 0.
pub(super) fn vertical(index: Complex64, beta: f64) -> Complex64 {
    let q = ((index - beta) * (index + beta)).sqrt();
    if q.im < 0.0 { -q } else { q }
}

/// Returns Berreman's matrix of a tensor in the frame of the wave.
pub(super) fn berreman(e: &[[Complex64; 3]; 3], beta: f64) -> Matrix<4> {
    let (zero, one) = (Complex64::ZERO, Complex64::ONE);
    let up = e[2][2].inv();
    let reduced = |i: usize, k: usize| e[i][k] - e[i][2] * e[2][k] * up;
    Matrix([
        [-beta * e[2][0] * up, one - beta * beta * up, -beta * e[2][1] * up, zero],
        [reduced(0, 0), -beta * e[0][2] * up, reduced(0, 1), zero],
        [zero, zero, zero, one],
        [reduced(1, 0), -beta * e[1][2] * up, reduced(1, 1) - beta * beta, zero],
    ])
}

/// Returns the sign function of a matrix without imaginary eigenvalues, by Newton's iteration, which
/// converges quadratically.
fn sign(matrix: Matrix<4>) -> Matrix<4> {
    const MOST: usize = 100;
    let mut x = matrix;
    for _ in 0..MOST {
        let next = (x + x.inverse()).times(0.5.into());
        let change = (next - x).norm();
        x = next;
        // The square of a change is the next one.
        if change <= 1e-9 * x.norm() {
            break;
        }
    }
    x
}

/// Returns the exponential of a 2x2 matrix, in closed form.
fn exponential(matrix: Matrix<2>) -> Matrix<2> {
    let mean = 0.5 * (matrix.0[0][0] + matrix.0[1][1]);
    let rest = matrix - Matrix::diagonal([mean; 2]);
    // Its square is this times one.
    let square = rest.0[0][0] * rest.0[0][0] + rest.0[0][1] * rest.0[1][0];
    let root = square.sqrt();
    // exp(mean) sinh(root) and exp(mean) cosh(root) without large factors: the mean decays.
    let (plus, minus) = ((mean + root).exp(), (mean - root).exp());
    let sinh_over_root = if root.norm() < 1e-4 {
        mean.exp() * (1.0 + square / 6.0 + square * square / 120.0)
    } else {
        (plus - minus) / (2.0 * root)
    };
    Matrix::diagonal([0.5 * (plus + minus); 2]) + rest.times(sinh_over_root)
}
