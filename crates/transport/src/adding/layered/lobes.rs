//! Azimuthal orders of diffusers' lobes on a grid.
//!
//! Order m of the k-correlation lobe `b/(2 pi) (b^2 + |beta_o - beta_i|^2)^(-3/2)` is
//! `b/(2 pi) (2 beta_i beta_o)^(-3/2) g_m(chi)`, with g_m the Fourier coefficients of
//! `(chi - cos phi)^(-3/2)` and `chi = (b^2 + beta_i^2 + beta_o^2)/(2 beta_i beta_o)`. They obey
//! `(k + 1/2) g_{k-1} - 2 chi k g_k + (k - 1/2) g_{k+1} = 0`, which is stable downwards (Miller): it gives
//! the ratios, and g_0 is a complete elliptic integral.

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;

use super::grid::Grid;
use super::matrix::Matrix;

/// Number of orders that are computed together.
const BATCH: usize = 16;

/// Orders of a lobe's kernel on a grid, scaled, for any two nodes; orders are requested in ascending
/// sequence.
#[derive(Debug, Clone)]
pub(super) struct LobeOrders {
    lobe: Lobe,
    /// Radius of the disc of a Lambertian lobe.
    disc: f64,
    /// First of the computed orders.
    first: usize,
    batch: Vec<Matrix>,
}

impl LobeOrders {
    /// Begins the orders of a lobe; `disc` is the radius of the disc of a Lambertian one, 1 for that of air.
    pub(super) fn new(lobe: Lobe, disc: f64) -> Self {
        Self { lobe, disc, first: 0, batch: Vec::new() }
    }

    /// Returns the kernel of this order.
    pub(super) fn order(&mut self, order: usize, grid: &Grid) -> Option<&Matrix> {
        if matches!(self.lobe, Lobe::Lambertian) && order > 0 {
            return None;
        }
        if !(self.first..self.first + self.batch.len()).contains(&order) {
            self.fill(order, grid);
        }
        self.batch.get(order - self.first)
    }

    fn fill(&mut self, first: usize, grid: &Grid) {
        let len = grid.len();
        self.first = first;
        match self.lobe {
            Lobe::Lambertian => {
                let area = PI * self.disc * self.disc;
                let inside = |i: usize| if grid.beta[i] <= self.disc { grid.scale[i] } else { 0.0 };
                self.batch = vec![Matrix::from_fn(len, len, |i, j| inside(i) * inside(j) / area)];
            }
            Lobe::KCorrelation { width } => {
                self.batch = vec![Matrix::zeros(len, len); BATCH];
                let mut orders = [0.0; BATCH];
                for j in 0..len {
                    for i in 0..=j {
                        k_correlation(width, grid.beta[i], grid.beta[j], first, &mut orders);
                        let scale = grid.scale[i] * grid.scale[j];
                        for (kernel, value) in self.batch.iter_mut().zip(orders) {
                            kernel[(i, j)] = scale * value;
                            kernel[(j, i)] = scale * value;
                        }
                    }
                }
            }
        }
    }
}

/// Computes orders from `first` on of the k-correlation lobe between two directions.
fn k_correlation(width: f64, beta_i: f64, beta_o: f64, first: usize, out: &mut [f64]) {
    // chi - 1, free of cancellation, and the limit of the ratio of successive orders.
    let near = width * width + (beta_i - beta_o) * (beta_i - beta_o);
    let both = 2.0 * beta_i * beta_o;
    out.fill(0.0);
    if both < 1e-12 * near {
        if first == 0 {
            out[0] = width / (2.0 * PI * near * near.sqrt());
        }
        return;
    }
    let excess = near / both;
    let chi = 1.0 + excess;
    let far_ratio = 1.0 / (chi + (excess * (excess + 2.0)).sqrt());
    let last = first + out.len();
    // An error in the first ratio decreases by far_ratio^2 with each step.
    let start = last + (20.0 / -far_ratio.ln()).ceil().min(4e5) as usize;
    let mut ratio = far_ratio;
    let mut product = zeroth(width, near, both);
    let mut log_scale = 0.0;
    for k in (1..=start).rev() {
        let k_float = k as f64;
        ratio = (k_float + 0.5) / (2.0 * chi * k_float - (k_float - 0.5) * ratio);
        if (first + 1..last).contains(&k) {
            out[k - first] = ratio;
        } else if k <= first {
            log_scale += ratio.ln();
        }
    }
    product *= log_scale.exp();
    out[0] = 1.0;
    for value in out.iter_mut() {
        product *= *value;
        *value = product;
    }
}

/// Returns order 0: `b/(2 pi) 4 E(k) / (2 pi (A - C) sqrt(A + C))`, `k^2 = 2 C/(A + C)`, with `near` = A - C
/// and `both` = C.
fn zeroth(width: f64, near: f64, both: f64) -> f64 {
    let far = near + 2.0 * both;
    width / (PI * PI) * elliptic_e((near / far).sqrt()) / (near * far.sqrt())
}

/// Returns the complete elliptic integral of the second kind by the arithmetic-geometric mean, from the
/// complementary modulus k'.
fn elliptic_e(k_prime: f64) -> f64 {
    let (mut a, mut b, mut power) = (1.0_f64, k_prime, 0.5);
    let mut sum = 0.5 * (1.0 - k_prime * k_prime);
    for _ in 0..12 {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        power *= 2.0;
        sum += power * c * c;
        if c < 1e-9 {
            break;
        }
    }
    PI / (2.0 * a) * (1.0 - sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::{Beta, Scatterer};

    /// Compared with the trapezoid rule, which converges exponentially for periodic functions.
    #[test]
    fn orders_equal_fourier_coefficients_of_lobe() {
        for (width, a, b) in [(0.06, 0.3, 0.35), (0.5, 0.9, 0.1), (0.02, 1e-9, 0.02), (0.1, 0.0, 0.3)] {
            let lobe = Lobe::KCorrelation { width };
            let steps = 4000;
            let mean = |m: usize| -> f64 {
                (0..steps)
                    .map(|step| {
                        let phi = 2.0 * PI * f64::from(step) / f64::from(steps);
                        let to = Beta { x: b * phi.cos(), y: b * phi.sin() };
                        lobe.density(Beta { x: a, y: 0.0 }, to) * (m as f64 * phi).cos()
                    })
                    .sum::<f64>()
                    / f64::from(steps)
            };
            let scale = mean(0);
            for first in [0, 7] {
                let mut orders = [0.0; BATCH];
                k_correlation(width, a, b, first, &mut orders);
                for (k, order) in orders.iter().enumerate() {
                    let expected = mean(first + k);
                    assert!((order - expected).abs() < 1e-11 * scale, "{width} {a} {b} {}", first + k);
                }
            }
        }
    }
}
