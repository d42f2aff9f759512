//! Metrics that combine the simulated and measured states of a view, and notes on missing measurements.

use papilio_colour::{GamutReference, UvPrime, coverage_percent, gamut_percent};

use super::left_out::LeftOut;
use super::pairs::Pair;
use super::{SIDES, Side, Simulated, ViewComparison};

/// Wavelength range that determines colours, nm; a narrower spectrum has colours of its own range only.
const LUMINOUS_NM: (f64, f64) = (400.0, 700.0);

/// Computes the metrics that combine the states of a view, and sets the contrast of each state.
pub(super) fn together(mut pairs: Vec<&mut Pair>) -> ViewComparison {
    let named = |pairs: &[&mut Pair], name: &str| {
        pairs.iter().find(|pair| pair.comparison.state == name).map(|pair| pair.comparison.clone())
    };
    let black = named(&pairs, "black");
    let contrast = |y: f64, side: Side| {
        black.as_ref().map(|black| side(black).Y).filter(|black| *black > 0.0).map(|black| y / black)
    };
    for pair in &mut pairs {
        let one = &mut pair.comparison;
        one.simulated.contrast = contrast(one.simulated.Y, SIDES[0]);
        one.measured.contrast = contrast(one.measured.Y, SIDES[1]);
    }
    let primaries = ["red", "green", "blue"].map(|name| named(&pairs, name));
    let triangle = |side: Side| -> Option<[UvPrime; 3]> {
        let [r, g, b] = primaries.each_ref().map(|one| {
            let colour = side(one.as_ref()?);
            Some(UvPrime { u: colour.u_prime?, v: colour.v_prime? })
        });
        Some([r?, g?, b?])
    };
    let area = |reference| SIDES.map(|side| triangle(side).map(|uv| gamut_percent(uv, reference)));
    let [r, g, b] = primaries.each_ref().map(|one| {
        let one = one.as_ref()?;
        Some(one.simulated.peak_nm? - one.measured.peak_nm?)
    });
    let peaks = r.zip(g).zip(b).map(|((r, g), b)| [r, g, b]);
    let white = named(&pairs, "white");
    ViewComparison {
        theta_deg: pairs[0].comparison.theta_deg,
        phi_deg: pairs[0].comparison.phi_deg,
        contrast_ratio: SIDES.map(|side| contrast(side(white.as_ref()?).Y, side)),
        gamut_percent_srgb: area(GamutReference::Srgb),
        gamut_percent_ebu: area(GamutReference::Ebu),
        coverage_percent_srgb: SIDES
            .map(|side| triangle(side).map(|uv| coverage_percent(uv, GamutReference::Srgb))),
        average_peak_difference_nm: peaks.map(|peaks| peaks.iter().sum::<f64>() / 3.0),
        rms_peak_difference_nm: peaks.map(|peaks| (peaks.iter().map(|d| d * d).sum::<f64>() / 3.0).sqrt()),
    }
}

/// Returns the simulated states that were not measured in a measured view, and spectra with a short range.
pub(super) fn not_measured(simulated: &Simulated, pairs: &[Pair]) -> Vec<LeftOut> {
    let mut left_out = Vec::new();
    for (v, view) in simulated.views.iter().enumerate() {
        let measured = |name: &str| pairs.iter().any(|pair| pair.view == v && pair.comparison.state == name);
        let missing: Vec<&String> =
            view.states.iter().map(|one| &one.name).filter(|name| !measured(name)).collect();
        if missing.len() < view.states.len() {
            left_out.extend(missing.into_iter().map(|state| LeftOut {
                state: state.clone(),
                direction: Some([view.theta_deg, view.phi_deg]),
                why: "not measured".to_owned(),
            }));
        }
    }
    let short = pairs.iter().filter_map(|pair| {
        let one = &pair.comparison;
        let spectrum = one.spectrum.as_ref()?;
        let (from, to) = (spectrum.wavelength_nm.first()?, spectrum.wavelength_nm.last()?);
        (*from > LUMINOUS_NM.0 || *to < LUMINOUS_NM.1).then(|| LeftOut {
            state: one.state.clone(),
            direction: Some([one.theta_deg, one.phi_deg]),
            why: format!("colours are computed over {from} to {to} nm only"),
        })
    });
    left_out.extend(short);
    left_out
}
