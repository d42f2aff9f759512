//! Bessel functions of spatial spectra.

/// Bessel function J0.
pub(super) fn j0(x: f64) -> f64 {
    libm::j0(x)
}

/// `x K_1(x)` for x >= 0: 1 at 0.
pub(super) fn x_k1(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x * modified(x, |_, cosh| cosh) }
}

/// `x^2 K_2(x)/2` for x >= 0: 1 at 0.
pub(super) fn x2_k2_half(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { 0.5 * x * x * modified(x, |_, cosh| 2.0 * cosh * cosh - 1.0) }
}

/// The modified Bessel function `K_v(x) = integral of exp(-x cosh t) cosh(v t) dt` over t > 0, with the last factor given as
/// a function of t and cosh(t). The trapezoidal rule converges exponentially (DLMF 10.32.9).
fn modified(x: f64, last: impl Fn(f64, f64) -> f64) -> f64 {
    const STEP: f64 = 1.0 / 16.0;
    let mut sum = 0.5 * (-x).exp() * last(0.0, 1.0);
    for step in 1.. {
        let t = STEP * f64::from(step);
        let cosh = t.cosh();
        let term = (-x * cosh).exp() * last(t, cosh);
        sum += term;
        if term <= 1e-18 * sum && x * cosh > 4.0 {
            break;
        }
    }
    STEP * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz and Stegun, tables 9.8 and 9.9: K1(1) = 0.6019072302, K2(1) = 1.6248388986; and small and large arguments.
    #[test]
    fn modified_bessel_functions_have_tabulated_values() {
        assert!((x_k1(1.0) - 0.601_907_230_2).abs() < 1e-10);
        assert!((x2_k2_half(1.0) - 0.5 * 1.624_838_898_6).abs() < 1e-10);
        assert!((x_k1(0.1) - 0.1 * 9.853_844_780_9).abs() < 1e-10);
        assert!((x2_k2_half(5.0) - 12.5 * 0.005_308_943_712).abs() < 1e-11);
        for tiny in [0.0, 1e-12, 1e-6] {
            assert!((x_k1(tiny) - 1.0).abs() < 1e-10 && (x2_k2_half(tiny) - 1.0).abs() < 1e-10);
        }
        assert!(x_k1(800.0) >= 0.0 && x_k1(800.0) < 1e-300);
    }
}
