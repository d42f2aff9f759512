//! What a lobe does in a display: light crosses it twice, over a perfect mirror.
//!
//! The reader's luminance is that of light from i that is scattered to beta, mirrored, and scattered to o,
//! `L = integral of f(i, beta) f(beta, o) d^2 beta`, and in diffuse light the share `integral of f(o, beta) t(beta) d^2 beta` with t the
//! lobe's total. Lobes that agree in these give displays that agree, whatever the pixel under them.

use papilio_optics::Beta;

/// Light and viewer, degrees, as in the presets: indoor, sunny, and the light of the ring geometry of IEC 62679-3-1.
const DIRECTED: [[f64; 2]; 3] = [[-20.0, 8.0], [-35.0, 20.0], [35.0, 20.0]];
/// Viewer in diffuse light, degrees.
const DIFFUSE: [f64; 2] = [8.0, 45.0];
/// Steps across the disc of direction cosines.
const STEPS: i32 = 160;

/// By how much the luminances through one lobe differ from those through another, relative: the largest over presets and viewing angles.
/// Only light between directions that are `known` counts, of both; `None` if there is none in any preset.
pub fn double_pass_error(
    lobe: impl Fn(Beta, Beta) -> f64,
    truth: impl Fn(Beta, Beta) -> f64,
    known: impl Fn(Beta, Beta) -> bool,
) -> Option<f64> {
    let found = luminances(&|from, to| if known(from, to) { lobe(from, to) } else { 0.0 });
    let true_ = luminances(&|from, to| if known(from, to) { truth(from, to) } else { 0.0 });
    let there = found.iter().zip(&true_).filter(|(_, truth)| **truth != 0.0);
    let errors = there.map(|(found, truth)| (found / truth - 1.0).abs());
    errors.reduce(|worst, error| if error > worst || error.is_nan() { error } else { worst })
}

/// Luminance factors, directed then diffuse.
fn luminances(f: &dyn Fn(Beta, Beta) -> f64) -> Vec<f64> {
    let disc = disc();
    let area = (2.0 / f64::from(STEPS)).powi(2);
    let ray = |theta: f64| Beta { x: theta.to_radians().sin(), y: 0.0 };
    let directed = DIRECTED.iter().map(|&[light, viewer]| {
        // The light is at `light`: it travels the other way.
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
        let at = beta.length() * f64::from(lengths);
        let k = (at as usize).min(totals.len() - 2);
        totals[k] + (at - k as f64) * (totals[k + 1] - totals[k])
    };
    let diffuse = DIFFUSE
        .iter()
        .map(|&viewer| disc.iter().map(|&beta| f(ray(viewer), beta) * total(beta)).sum::<f64>() * area);
    directed.chain(diffuse).collect()
}

/// Midpoints of the squares within the disc.
fn disc() -> Vec<Beta> {
    let at = |k: i32| f64::from(2 * k + 1) / f64::from(STEPS) - 1.0;
    let square = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| Beta { x: at(i), y: at(j) }));
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

    /// Two passes of one k-correlation lobe are one of twice its width, but for what leaves the disc.
    #[test]
    fn two_passes_convolve() {
        let found = luminances(&lobe(0.05));
        let ray = |theta: f64| Beta { x: theta.to_radians().sin(), y: 0.0 };
        for (found, [light, viewer]) in found.iter().zip(DIRECTED) {
            let closed = lobe(0.1)(ray(-light), ray(viewer));
            assert!((found / closed - 1.0).abs() < 0.01, "{light} {viewer}: {found} {closed}");
        }
    }

    /// What is wrong beyond what is known is no error, and where nothing is known there is none.
    #[test]
    fn only_known_directions_count() {
        let known = |from: Beta, to: Beta| from.length() < 0.7 && to.length() < 0.9;
        let wrong = move |from: Beta, to: Beta| if known(from, to) { lobe(0.05)(from, to) } else { 1e3 };
        assert_eq!(double_pass_error(wrong, lobe(0.05), known), Some(0.0));
        assert!(double_pass_error(wrong, lobe(0.05), |_, _| true).unwrap() > 1.0);
        assert_eq!(double_pass_error(wrong, lobe(0.05), |_, _| false), None);
    }

    #[test]
    fn lobes_are_told_apart() {
        let all = |_: Beta, _: Beta| true;
        assert_eq!(double_pass_error(lobe(0.05), lobe(0.05), all), Some(0.0));
        let error = double_pass_error(lobe(0.0505), lobe(0.05), all).unwrap();
        assert!((0.001..0.02).contains(&error), "{error}");
    }
}
