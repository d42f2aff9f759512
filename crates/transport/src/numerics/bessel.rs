//! Bessel functions of spatial spectra.

/// Bessel function J0.
pub(crate) fn j0(x: f64) -> f64 {
    libm::j0(x)
}

/// `x K_1(x)` for x >= 0: 1 at 0.
pub(crate) fn x_k1(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x * modified(x, |_, cosh| cosh) }
}

/// `x^2 K_2(x)/2` for x >= 0: 1 at 0.
pub(crate) fn x2_k2_half(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { 0.5 * x * x * modified(x, |_, cosh| 2.0 * cosh * cosh - 1.0) }
}

/// `K_0(x)` for x > 0; exact to 1e-10 up to 200.
pub(crate) fn k0(x: f64) -> f64 {
    modified(x, |_, _| 1.0)
}

/// `I_0(x)` and `I_1(x)` for x from 0 to 200: the mean over angles, by the trapezoidal rule.
pub(crate) fn i0_i1(x: f64) -> [f64; 2] {
    let count = 32 + x.ceil() as u32;
    let mut sums = [0.0; 2];
    for step in 0..count {
        let cos = (std::f64::consts::TAU * f64::from(step) / f64::from(count)).cos();
        let value = (x * cos).exp();
        sums[0] += value;
        sums[1] += value * cos;
    }
    sums.map(|sum| sum / f64::from(count))
}

/// Spherical Bessel functions `j_l(x)` of the orders l = 0, 1, ..., for x >= 0: upwards from j_0 and j_1
/// where that is stable, else downwards (Miller).
pub(crate) fn spherical(x: f64, out: &mut [f64]) {
    let count = out.len();
    if x < SMALL {
        // x^l/(2l + 1)!! (1 - y/(2l + 3) + y^2/(2 (2l + 3)(2l + 5)), y = x^2/2
        let (mut first, y) = (1.0, 0.5 * x * x);
        for (order, j) in out.iter_mut().enumerate() {
            let odd = (2 * order + 3) as f64;
            *j = first * (1.0 - y / odd * (1.0 - 0.5 * y / (odd + 2.0)));
            first *= x / odd;
        }
        return;
    }
    let (sin, cos) = x.sin_cos();
    let first = [sin / x, (sin / x - cos) / x];
    if x > count as f64 {
        out.iter_mut().zip(first).for_each(|(j, first)| *j = first);
        for order in 2..count {
            out[order] = (2 * order - 1) as f64 / x * out[order - 1] - out[order - 2];
        }
        return;
    }
    let start = count + 12 + (40.0 * count as f64).sqrt() as usize;
    let (mut above, mut here) = (0.0, 1e-250);
    // The two lowest orders, up to the common factor.
    let mut lowest = [0.0; 2];
    for order in (0..start).rev() {
        (above, here) = (here, (2 * order + 3) as f64 / x * here - above);
        if let Some(j) = out.get_mut(order) {
            *j = here;
        }
        if order < 2 {
            lowest[order] = here;
        }
    }
    let larger = usize::from(first[1].abs() > first[0].abs());
    let factor = first[larger] / lowest[larger];
    out.iter_mut().for_each(|j| *j *= factor);
}

/// Arguments below which three terms of the power series are used.
const SMALL: f64 = 0.02;

/// The modified Bessel function `K_v(x) = integral of exp(-x cosh t) cosh(v t) dt` over t > 0, with the last
/// factor given as a function of t and cosh(t). The trapezoidal rule converges exponentially (DLMF 10.32.9).
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

    /// Abramowitz and Stegun, table 10.1, and the closed forms of the lowest orders; every way of computing
    /// them.
    #[test]
    fn spherical_bessel_functions_have_tabulated_values() {
        let at = |x: f64, count: usize| {
            let mut out = vec![0.0; count];
            spherical(x, &mut out);
            out
        };
        assert!((at(1.0, 3)[2] - 0.062_035_052_0).abs() < 1e-10);
        assert!((at(5.0, 9)[8] - 0.005_741_434_7).abs() < 1e-9);
        for x in [0.01_f64, 0.019, 0.021, 0.5, 3.0, 3.15, 19.0, 21.0, 300.0] {
            let [few, many] = [at(x, 2), at(x, 20)];
            assert!((few[0] - x.sin() / x).abs() < 1e-14, "{x}");
            assert!((many[1] - (x.sin() / x - x.cos()) / x).abs() < 1e-11, "{x}");
            let squares: f64 = at(x, 40).iter().enumerate().map(|(l, j)| (2 * l + 1) as f64 * j * j).sum();
            assert!(x > 21.0 || (squares - 1.0).abs() < 1e-11, "{x}: {squares}");
        }
        assert_eq!(at(0.0, 3), [1.0, 0.0, 0.0]);
    }

    /// Abramowitz and Stegun, tables 9.8 and 9.9: K1(1) = 0.6019072302, K2(1) = 1.6248388986; and small and
    /// large arguments.
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
        assert!((k0(1.0) - 0.421_024_438_2).abs() < 1e-10 && (k0(0.1) - 2.427_069_024_7).abs() < 1e-10);
        for (x, expected) in [(0.0, [1.0, 0.0]), (1.0, [1.266_065_877_8, 0.565_159_104_0])] {
            let found = i0_i1(x);
            assert!((found[0] - expected[0]).abs() < 1e-10 && (found[1] - expected[1]).abs() < 1e-10);
        }
        // The Wronskian I_0 K_1 + I_1 K_0 = 1/x.
        for x in [0.3, 5.0, 100.0, 200.0] {
            let [i0, i1] = i0_i1(x);
            assert!((i0 * x_k1(x) + i1 * x * k0(x) - 1.0).abs() < 1e-9, "{x}");
        }
    }
}
