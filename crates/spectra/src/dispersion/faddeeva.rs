//! The Faddeeva function `W(z) = exp(-z^2) erfc(-i z)` in the upper half plane.
//!
//! It equals the integral `i/pi int exp(-t^2)/(z - t) dt`, computed by the trapezoidal
//! or midpoint rule with step h, which converges geometrically. The contribution of a pole near
//! the axis is added explicitly. The rule whose nodes are farther
//! from z is used. 12 nodes give a relative error of about 3e-15.
//!
//! Valid for Im z >= 0. Source: M. Al Azah, S. N. Chandler-Wilde, "Computation of
//! the complex error function using modified trapezoidal rules", SIAM J. Numer.
//! Anal. 59, 2346-2367 (2021), eq. 1.8-1.11.

use std::f64::consts::PI;

use num_complex::Complex64;

const NODES: u32 = 11;

/// W(z) for Im z >= 0.
pub(super) fn faddeeva(z: Complex64) -> Complex64 {
    if z.re < 0.0 {
        return faddeeva(Complex64::new(-z.re, z.im)).conj();
    }
    let h = (PI / f64::from(NODES + 1)).sqrt();
    let far = z.im >= PI / h;
    let between_nodes = (0.25..=0.75).contains(&(z.re / h).fract());
    let trapezoid = z.im < z.re && between_nodes;

    let z2 = z * z;
    let node = |t: f64| (-t * t).exp() / (z2 - t * t);
    let scale = 2.0 * Complex64::I * h * z / PI;
    let sum: Complex64 = if trapezoid {
        0.5 * node(0.0) + (1..=NODES).map(|k| node(f64::from(k) * h)).sum::<Complex64>()
    } else {
        (0..=NODES).map(|k| node((f64::from(k) + 0.5) * h)).sum()
    };
    if far {
        return scale * sum;
    }
    let period = (-2.0 * PI * Complex64::I * z / h).exp();
    let pole = 2.0 * (-z2).exp() / if trapezoid { 1.0 - period } else { 1.0 + period };
    scale * sum + pole
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computed with mpmath's erfc, 30 digits; the first five agree with Abramowitz and
    /// Stegun, table 7.9. They cover both rules, both poles and the far region.
    #[test]
    fn faddeeva_equals_published_values() {
        let table = [
            ((0.0, 0.0), (1.0, 0.0)),
            ((0.0, 1.0), (0.427583576155807, 0.0)),
            ((1.0, 0.0), (0.36787944117144233, 0.6071577058413937)),
            ((1.0, 1.0), (0.3047442052569126, 0.20821893820283163)),
            ((2.0, 2.0), (0.1479527595120158, 0.13117971708421785)),
            ((0.1, 0.02), (0.9683130000541365, 0.10821598871900004)),
            ((3.3, 1e-8), (1.8644358478798773e-5, 0.18030210534595453)),
            ((0.258, 0.3), (0.7003515417752895, 0.17147809915161993)),
            ((6.5, 0.001), (1.3858354049175768e-5, 0.0878644225161668)),
            ((40.0, 12.0), (0.003885013055937595, 0.012942613049515387)),
            ((0.001, 7.0), (0.07980005277794404, 1.1178406274075466e-5)),
            ((5.0, 5.2), (0.05685747346705815, 0.05363276510906748)),
            ((-1.5, 0.4), (0.18698351840387575, -0.3638284949648296)),
            ((300.0, 0.01), (6.268877626019767e-8, 0.0018806423911989152)),
        ];
        for ((x, y), (re, im)) in table {
            let expected = Complex64::new(re, im);
            let found = faddeeva(Complex64::new(x, y));
            assert!(
                (found - expected).norm() < 1e-14 * expected.norm(),
                "W({x} + {y}i) = {found}, not {expected}"
            );
        }
    }
}
