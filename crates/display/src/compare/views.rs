//! Metrics that combine the simulated and measured states of a view, and notes on missing measurements.

use papilio_colour::{GamutReference, UvPrime, coverage_percent, gamut_percent};

use super::left_out::LeftOut;
use super::pairs::Pair;
use super::{SIDES, Side, Simulated, StateComparison, ViewComparison};

/// Wavelength range that determines colours, nm; a narrower spectrum has colours of its own range only.
const LUMINOUS_NM: (f64, f64) = (400.0, 700.0);

/// Returns the range over which the colours of a state are computed, nm, if it is not the whole visible one.
fn part_of_light(one: &StateComparison) -> Option<(f64, f64)> {
    let nm = &one.spectrum.as_ref()?.wavelength_nm;
    let (from, to) = (*nm.first()?, *nm.last()?);
    (from > LUMINOUS_NM.0 || to < LUMINOUS_NM.1).then_some((from, to))
}

/// Computes the metrics that combine the states of a view, and sets the contrast of each state. States whose colours are those of different
/// ranges are not combined.
pub(super) fn together(mut pairs: Vec<&mut Pair>) -> ViewComparison {
    let named = |pairs: &[&mut Pair], name: &str| {
        pairs.iter().find(|pair| pair.comparison.state == name).map(|pair| pair.comparison.clone())
    };
    let black = named(&pairs, "black");
    let contrast = |one: &StateComparison, side: Side| {
        let black = black.as_ref().filter(|black| part_of_light(black) == part_of_light(one))?;
        (side(black).Y > 0.0).then(|| side(one).Y / side(black).Y)
    };
    for pair in &mut pairs {
        let one = &mut pair.comparison;
        let [simulated, measured] = SIDES.map(|side| contrast(one, side));
        (one.simulated.contrast, one.measured.contrast) = (simulated, measured);
    }
    let mut primaries = ["red", "green", "blue"].map(|name| named(&pairs, name));
    let parts = primaries.each_ref().map(|one| one.as_ref().map(part_of_light));
    if parts[0] != parts[1] || parts[1] != parts[2] {
        primaries = [None, None, None];
    }
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
        contrast_ratio: SIDES.map(|side| contrast(white.as_ref()?, side)),
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
        let (from, to) = part_of_light(one)?;
        Some(LeftOut {
            state: one.state.clone(),
            direction: Some([one.theta_deg, one.phi_deg]),
            why: format!("colours are computed over {from} to {to} nm only"),
        })
    });
    left_out.extend(short);
    let of_view = |pair: &Pair, name: &str| {
        let other = pairs.iter().find(|other| other.view == pair.view && other.comparison.state == name);
        other.map(|other| part_of_light(&other.comparison))
    };
    let unlike = pairs.iter().filter_map(|pair| {
        let one = &pair.comparison;
        let own = part_of_light(one);
        let primaries = ["red", "green", "blue"];
        let others: &[&str] = if primaries.contains(&one.state.as_str()) { &primaries } else { &[] };
        let lost = match of_view(pair, "black").is_some_and(|black| black != own) {
            true => "no contrast: black has another range of wavelengths",
            false if others.iter().any(|name| of_view(pair, name).is_some_and(|other| other != own)) => {
                "no gamut: the primaries have different ranges of wavelengths"
            }
            false => return None,
        };
        let direction = Some([one.theta_deg, one.phi_deg]);
        Some(LeftOut { state: one.state.clone(), direction, why: lost.to_owned() })
    });
    left_out.extend(unlike);
    left_out
}
