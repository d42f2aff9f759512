//! Bessel functions at the multiples of an argument, of which Hankel series are made.

use std::f64::consts::{FRAC_PI_4, PI};

/// Arguments from which Hankel's expansion with this number of terms has an error below 3e-12.
const FAR: f64 = 40.0;
const TERMS: usize = 8;

/// Number of multiples after which sine and cosine are computed directly, so that rounding errors of the recurrence do not accumulate.
const RENEWED: usize = 64;

/// Returns `J_n(k x)` of order n, 0 or 1, for k = 1 to `count`: by Hankel's expansion (Abramowitz and Stegun, 9.2.5) where
/// `k x` is large. Sine and cosine follow from those of the multiple before.
pub(super) fn multiples(order: u32, x: f64, count: usize) -> Vec<f64> {
    let near = if order == 0 { libm::j0 } else { libm::j1 };
    let mut a = [1.0; TERMS];
    for k in 1..TERMS {
        let odd = (2 * k - 1) as f64;
        a[k] = a[k - 1] * (f64::from(4 * order * order) - odd * odd) / (8 * k) as f64;
    }
    let phase = f64::from(2 * order + 1) * FRAC_PI_4;
    let (turn_sin, turn_cos) = x.sin_cos();
    let mut turned = None;
    let at = |k: usize| {
        let z = k as f64 * x;
        if z < FAR {
            return near(z);
        }
        let (sin, cos) = match turned {
            Some((sin, cos)) if !k.is_multiple_of(RENEWED) => {
                (sin * turn_cos + cos * turn_sin, cos * turn_cos - sin * turn_sin)
            }
            _ => (z - phase).sin_cos(),
        };
        turned = Some((sin, cos));
        let square = 1.0 / (z * z);
        let even = 1.0 - square * (a[2] - square * (a[4] - square * a[6]));
        let odd = (a[1] - square * (a[3] - square * (a[5] - square * a[7]))) / z;
        (2.0 / (PI * z)).sqrt() * (cos * even - sin * odd)
    };
    (1..=count).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The judge is a library, on both sides of the argument from which the expansion is used.
    #[test]
    fn multiples_have_the_values_of_each_alone() {
        for x in [1e-3, 0.37, 2.0 * PI, 39.9, 40.1, 1234.5] {
            for (order, alone) in [(0, libm::j0 as fn(f64) -> f64), (1, libm::j1)] {
                for (k, found) in multiples(order, x, 3000).into_iter().enumerate() {
                    let z = (k + 1) as f64 * x;
                    let error = (found - alone(z)).abs();
                    // The error of the expansion, and the rounding of the argument.
                    assert!(error < 3e-12 + 2e-16 * z, "J{order}({z}): {found}, {error:e}");
                }
            }
        }
    }
}
