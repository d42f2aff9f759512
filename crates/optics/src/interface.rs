//! A flat interface between two transparent media: Fresnel's reflectances.
//!
//! Parameters: the two indices (real, above 0) and `beta = n1 sin(theta1)`, the
//! direction cosine that the interface conserves. With `q = sqrt(n^2 - beta^2)`
//! (index times cosine) on either side, the amplitudes are
//! `r_s = (q1 - q2)/(q1 + q2)` and `r_p = (n2^2 q1 - n1^2 q2)/(n2^2 q1 + n1^2 q2)`.
//! Beyond the critical angle everything is reflected.
//!
//! Valid for 0 <= beta <= n1; for absorbing media see [`film`](crate::film).
//!
//! Intuition: 4 % at normal incidence on glass, none for p at Brewster's angle,
//! all at grazing incidence. The same from both sides for the same beta.
//!
//! Source: M. Born, E. Wolf, "Principles of Optics", 7th ed., section 1.5.2.

/// Returns the reflectance for s (field perpendicular to the plane of incidence), 0 to 1.
pub fn fresnel_reflectance_s(n1: f64, n2: f64, beta: f64) -> f64 {
    reflectance(n1, n2, beta, |_, _| 1.0)
}

/// Returns the reflectance for p (field in the plane of incidence), 0 to 1.
pub fn fresnel_reflectance_p(n1: f64, n2: f64, beta: f64) -> f64 {
    reflectance(n1, n2, beta, |n1, n2| (n2 / n1).powi(2))
}

/// Reflectance for unpolarised light: the mean of s and p, 0 to 1.
///
/// ```
/// use papilio_optics::interface::fresnel_reflectance;
/// assert!((fresnel_reflectance(1.0, 1.5, 0.0) - 0.04).abs() < 1e-15);
/// assert_eq!(fresnel_reflectance(1.5, 1.0, 1.01), 1.0);
/// ```
pub fn fresnel_reflectance(n1: f64, n2: f64, beta: f64) -> f64 {
    0.5 * (fresnel_reflectance_s(n1, n2, beta) + fresnel_reflectance_p(n1, n2, beta))
}

/// Returns the reflectance of one polarisation; `weight` are the factors of q1 and q2.
fn reflectance(n1: f64, n2: f64, beta: f64, weight: impl Fn(f64, f64) -> f64) -> f64 {
    let beta = beta.abs();
    if n1 == n2 {
        return 0.0;
    }
    if beta >= n1.min(n2) {
        return 1.0;
    }
    // As a product, the difference of squares stays exact towards grazing.
    let q = |n: f64| ((n - beta) * (n + beta)).sqrt();
    let (a, b) = (weight(n1, n2) * q(n1), q(n2));
    ((a - b) / (a + b)).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflectance_at_normal_incidence_equals_textbook() {
        for (n1, n2) in [(1.0, 1.5), (1.5, 1.0), (1.0, 1.33), (1.5, 2.4)] {
            let expected = ((n1 - n2) / (n1 + n2)) * ((n1 - n2) / (n1 + n2));
            assert!((fresnel_reflectance(n1, n2, 0.0) - expected).abs() < 1e-16);
        }
    }

    /// Born and Wolf, eq. 1.5.2 (21a): the laws of sines and tangents.
    #[test]
    fn reflectance_at_oblique_incidence_equals_form_by_angles() {
        for theta1 in [30.0_f64, 45.0, 60.0, 89.9] {
            let (n1, n2) = (1.0, 1.52);
            let t1 = theta1.to_radians();
            let t2 = (n1 * t1.sin() / n2).asin();
            let s = ((t1 - t2).sin() / (t1 + t2).sin()).powi(2);
            let p = ((t1 - t2).tan() / (t1 + t2).tan()).powi(2);
            assert!((fresnel_reflectance_s(n1, n2, t1.sin()) - s).abs() < 1e-12);
            assert!((fresnel_reflectance_p(n1, n2, t1.sin()) - p).abs() < 1e-12);
        }
    }

    #[test]
    fn p_reflectance_at_brewster_angle_is_zero() {
        let brewster = (1.5_f64).atan();
        assert!(fresnel_reflectance_p(1.0, 1.5, brewster.sin()) < 1e-30);
    }

    #[test]
    fn total_reflection_and_grazing_are_exactly_one() {
        assert_eq!(fresnel_reflectance(1.5, 1.0, 1.0), 1.0);
        assert_eq!(fresnel_reflectance(1.5, 1.0, 1.4999), 1.0);
        assert_eq!(fresnel_reflectance(1.0, 1.5, 1.0), 1.0);
        assert!(fresnel_reflectance(1.0, 1.5, 1.0 - 1e-16) > 0.9999);
    }

    #[test]
    fn reflectance_is_equal_from_both_sides_and_zero_between_equal_media() {
        for i in 0..100 {
            let beta = f64::from(i) * 0.01;
            let (down, up) = (fresnel_reflectance(1.0, 1.5, beta), fresnel_reflectance(1.5, 1.0, beta));
            assert!((down - up).abs() < 1e-15);
            assert_eq!(fresnel_reflectance(1.5, 1.5, beta), 0.0);
        }
    }
}
