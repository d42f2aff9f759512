//! Effect of a lobe in a display, where light passes through it twice, over a perfect mirror.
//!
//! The luminance of light from i that is scattered to beta, reflected, and scattered to o is
//! `L = integral of f(i, beta) f(beta, o) d^2 beta`. In diffuse light it is
//! `integral of f(o, beta) t(beta) d^2 beta`, with t the
//! total of the lobe. Two lobes with the same values of these give the same display, with any pixel.

use papilio_optics::Beta;

/// Inclinations of light and viewer, degrees: presets indoor and sunny, and the ring geometry of IEC
/// 62679-3-1.
const DIRECTED: [[f64; 2]; 3] = [[-20.0, 8.0], [-35.0, 20.0], [35.0, 20.0]];
/// Inclinations of the viewer in diffuse light, degrees.
const DIFFUSE: [f64; 2] = [8.0, 45.0];
/// Number of steps across the disc of direction cosines.
const STEPS: i32 = 160;

/// Relative difference of the luminances through two lobes, the largest over presets and viewing angles. Only
/// light between directions that are `known` counts, for both lobes; `None` if there is none in any preset.
pub fn double_pass_error(
    lobe: impl Fn(Beta, Beta) -> f64,
    truth: impl Fn(Beta, Beta) -> f64,
    known: impl Fn(Beta, Beta) -> bool,
) -> Option<f64> {
    let found = luminances(&|from, to| if known(from, to) { lobe(from, to) } else { 0.0 });
    let expected = luminances(&|from, to| if known(from, to) { truth(from, to) } else { 0.0 });
    let pairs = found.iter().zip(&expected).filter(|(_, truth)| **truth != 0.0);
    let errors = pairs.map(|(found, truth)| (found / truth - 1.0).abs());
    errors.reduce(|worst, error| if error > worst || error.is_nan() { error } else { worst })
}

/// Luminance factors in directed light, then in diffuse light.
fn luminances(f: &dyn Fn(Beta, Beta) -> f64) -> Vec<f64> {
    let disc = disc();
    let area = (2.0 / f64::from(STEPS)).powi(2);
    let ray = |theta: f64| Beta { x: theta.to_radians().sin(), y: 0.0 };
    let directed = DIRECTED.iter().map(|&[light, viewer]| {
        // Light from inclination `light` travels in the opposite direction.
        let (from, to) = (ray(-light), ray(viewer));
        disc.iter().map(|&beta| f(from, beta) * f(beta, to)).sum::<f64>() * area
    });
    let lengths = 32;
    let totals: Vec<f64> = (0..=lengths)
        .map(|k| {
            let from = Beta { x: f64::from(k) / f64::from(lengths), y: 0.0 };
            disc.iter().map(|&beta| f(from, beta)).sum::<f64>() * area
        })
        .collect();
    let total = |beta: Beta| {
        let position = beta.length() * f64::from(lengths);
        let k = (position as usize).min(totals.len() - 2);
        totals[k] + (position - k as f64) * (totals[k + 1] - totals[k])
    };
    let diffuse = DIFFUSE
        .iter()
        .map(|&viewer| disc.iter().map(|&beta| f(ray(viewer), beta) * total(beta)).sum::<f64>() * area);
    directed.chain(diffuse).collect()
}

/// Centres of the squares within the disc.
fn disc() -> Vec<Beta> {
    let centre = |k: i32| f64::from(2 * k + 1) / f64::from(STEPS) - 1.0;
    let square = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| Beta { x: centre(i), y: centre(j) }));
    square.filter(|beta| beta.squared() < 1.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lobe(width: f64) -> impl Fn(Beta, Beta) -> f64 {
        move |from: Beta, to: Beta| {
            let squared = (to - from).squared();
            width / (2.0 * std::f64::consts::PI * (width * width + squared).powf(1.5))
        }
    }

    /// Two passes through a k-correlation lobe equal one lobe of twice the width, except for light that
    /// leaves the disc.
    #[test]
    fn two_passes_convolve_the_lobe_with_itself() {
        let found = luminances(&lobe(0.05));
        let ray = |theta: f64| Beta { x: theta.to_radians().sin(), y: 0.0 };
        for (found, [light, viewer]) in found.iter().zip(DIRECTED) {
            let closed = lobe(0.1)(ray(-light), ray(viewer));
            assert!((found / closed - 1.0).abs() < 0.01, "{light} {viewer}: {found} {closed}");
        }
    }

    /// Differences outside the known directions do not count; without known directions there is no error.
    #[test]
    fn only_known_directions_count_in_double_pass_error() {
        let known = |from: Beta, to: Beta| from.length() < 0.7 && to.length() < 0.9;
        let wrong = move |from: Beta, to: Beta| if known(from, to) { lobe(0.05)(from, to) } else { 1e3 };
        assert_eq!(double_pass_error(wrong, lobe(0.05), known), Some(0.0));
        assert!(double_pass_error(wrong, lobe(0.05), |_, _| true).unwrap() > 1.0);
        assert_eq!(double_pass_error(wrong, lobe(0.05), |_, _| false), None);
    }

    #[test]
    fn double_pass_error_distinguishes_widths_one_percent_apart() {
        let all = |_: Beta, _: Beta| true;
        assert_eq!(double_pass_error(lobe(0.05), lobe(0.05), all), Some(0.0));
        let error = double_pass_error(lobe(0.0505), lobe(0.05), all).unwrap();
        assert!((0.001..0.02).contains(&error), "{error}");
    }
}
