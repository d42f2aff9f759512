//! Scattering matrix of a homogeneous layer, by doubling a thin slice.

use num_complex::Complex64;

use super::matrix::{Matrix, Scattering};
use super::modes::{Modes, berreman};

/// Largest norm of the generator of a slice, and the terms of its series: 0.5^14/14! is 7e-16 of the first power.
const THIN: f64 = 0.5;
const TERMS: usize = 14;

/// Returns the scattering matrix of a layer of k0 d = `depth` between waves of [`Modes::reference`], from its
/// tensor in the frame of the wave.
pub(super) fn slab(tensor: &[[Complex64; 3]; 3], beta: f64, depth: f64) -> Scattering<2> {
    if depth == 0.0 {
        return Scattering::nothing();
    }
    let waves = Modes::reference(beta).columns();
    let generator = waves.solve(berreman(tensor, beta) * waves).times(Complex64::I * depth);
    let doublings = (generator.norm() / THIN).log2().ceil().max(0.0) as i32;
    let mut layer = thin(generator.times(0.5_f64.powi(doublings).into()));
    for _ in 0..doublings {
        layer = layer.over(&layer);
    }
    layer
}

/// Returns the scattering matrix of a thin slice: its transfer matrix, solved for what leaves it.
fn thin(generator: Matrix<4>) -> Scattering<2> {
    let mut transfer = Matrix::identity();
    for term in (1..=TERMS).rev() {
        transfer = Matrix::identity() + (generator * transfer).times((1.0 / term as f64).into());
    }
    let [down, from_up, from_down, up] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, k)| transfer.block(i, k));
    let t_up = up.inverse();
    let r = (t_up * from_down).times(-Complex64::ONE);
    Scattering { r, t: down + from_up * r, r_below: from_up * t_up, t_up }
}
