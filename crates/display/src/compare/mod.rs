//! Comparison of a simulated display with a measured one, for each state and view.
//!
//! **What.** Each measured spectrum (or X, Y, Z) is compared with the simulated state of the same name in the
//! nearest view, which must be within [`NEAREST_DEG`]. Spectra are compared over the common wavelength range,
//! on the simulation's grid, and both colours are computed over that range in the simulation's light. L\*, a\*, b\* are taken as
//! relative to the white of that light. Names of states are compared with the case of their letters, or else without.
//! States without a counterpart are skipped and reported.
//!
//! **Verdict.** A measured number with a standard deviation has `z`: the difference over the root of the sum of the
//! squares of this deviation and of the simulation's (its numerical errors, and the spread by the tolerances of its
//! inputs, if that is known).
//! **Source.** Feng 2012, figures 5.6 (spectra) and 5.7 (gamuts); differences are CIEDE2000 and u'v' distances.

mod deviation;
mod left_out;
mod metrics;
mod pairs;
mod simulated;
mod views;

use papilio_colour::{Lab, Standard, Xyz};
use papilio_spectra::{Grid, Tabulated};
use schemars::JsonSchema;
use serde::Serialize;

pub use deviation::{Agreement, StandardDeviation, StateDeviation};
use left_out::{LeftOut, gathered, with_states};
pub use metrics::{MeasuredMetric, MetricComparison, SimulatedMetric};
use pairs::{Pair, pair, view_at};
use views::{not_measured, together};

/// Largest angle between a measured direction and its simulated view, degrees.
pub const NEAREST_DEG: f64 = 1.0;

/// Simulated display: the part of a run's result that can be compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// Wavelength grid of all spectra.
    pub grid: Grid,
    /// Spectral radiance of the perfect white.
    pub radiance_of_white: Vec<f64>,
    /// Standard observer of X, Y, Z.
    pub observer: Standard,
    /// Simulated views, at least one.
    pub views: Vec<SimulatedView>,
}

/// Simulated states from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedView {
    /// Inclination, degrees; negative: towards phi + 180.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// Simulated states.
    pub states: Vec<SimulatedState>,
    /// Simulated metrics, those that were asked for.
    pub metrics: Vec<SimulatedMetric>,
}

/// Simulated state from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedState {
    /// Name of the state.
    pub name: String,
    /// Reflectance factors on the grid.
    pub reflectance_factor: Vec<f64>,
    /// Relative X, Y, Z.
    pub xyz: Xyz,
    /// Standard deviations of these.
    pub deviation: StateDeviation,
}

/// Measurement of a display.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Measurement {
    /// Spectra and colours of states.
    pub states: Vec<Measured>,
    /// Metrics by name.
    pub metrics: Vec<MeasuredMetric>,
}

impl Measurement {
    /// Adds what was measured in another file.
    pub fn append(&mut self, other: Self) {
        self.states.extend(other.states);
        self.metrics.extend(other.metrics);
    }
}

/// State measured from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Name of the state.
    pub state: String,
    /// Inclination, degrees; negative: towards phi + 180. `None` if the measurement does not state it: it is then that of the only
    /// simulated view.
    pub theta_deg: Option<f64>,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// Measured quantity.
    pub quantity: Quantity,
    /// Its standard deviation, if it is known.
    pub standard_deviation: Option<StandardDeviation>,
}

/// Measured quantity of a state.
#[derive(Debug, Clone, PartialEq)]
pub enum Quantity {
    /// Reflectance factor against wavelength.
    Spectrum(Tabulated),
    /// Relative X, Y, Z: Y = 1 for a perfect white.
    Xyz(Xyz),
    /// CIELAB relative to a perfect white in the light of the measurement.
    Lab(Lab),
}

/// Error of a comparison.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// No measured state has a counterpart.
    #[error("no measured state has a counterpart in the result:\n  {}", .reasons.join("\n  "))]
    Nothing {
        /// Reasons, with the states and directions.
        reasons: Vec<String>,
    },
}

/// Result of a comparison.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Comparison {
    /// One for each measured state that has a counterpart, in the order of the measurement.
    pub states: Vec<StateComparison>,
    /// One for each direction, in the order of the measurement: simulated and measured contrast and gamut.
    pub views: Vec<ViewComparison>,
    /// One for each measured metric that has a counterpart, in the order of the measurement.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub metrics: Vec<MetricComparison>,
    /// Agreement of all numbers whose standard deviation is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub agreement: Option<Agreement>,
    /// Notes on the states without a counterpart.
    pub left_out: Vec<String>,
}

/// Comparison of a simulated and a measured state.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "named as in result.json")]
pub struct StateComparison {
    /// Name of the state.
    pub state: String,
    /// Inclination of the simulated view, degrees.
    pub theta_deg: f64,
    /// Azimuth of the simulated view, degrees.
    pub phi_deg: f64,
    /// Simulated colour.
    pub simulated: Colour,
    /// Measured colour.
    pub measured: Colour,
    /// CIEDE2000 difference, in the simulation's light.
    pub delta_E_2000: Option<f64>,
    /// u'v' distance.
    pub distance_uv: Option<f64>,
    /// Difference of Y, simulated minus measured.
    pub difference_Y: f64,
    /// Both spectra, if a spectrum was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spectrum: Option<SpectrumComparison>,
    /// z of the measured numbers, if their standard deviation is known: of X, Y, Z or L\*, a\*, b\*, or of the
    /// reflectance factors at `spectrum.wavelength_nm`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub z: Vec<f64>,
    /// Agreement of these numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub agreement: Option<Agreement>,
}

/// Colour relative to a perfect white in the simulation's light.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "named as in result.json")]
pub struct Colour {
    /// Relative tristimulus value.
    pub X: f64,
    /// Relative tristimulus value.
    pub Y: f64,
    /// Relative tristimulus value.
    pub Z: f64,
    /// CIE 1976 u'.
    pub u_prime: Option<f64>,
    /// CIE 1976 v'.
    pub v_prime: Option<f64>,
    /// CIELAB.
    pub L_star: Option<f64>,
    /// CIELAB.
    pub a_star: Option<f64>,
    /// CIELAB.
    pub b_star: Option<f64>,
    /// Y over that of black, where black was measured (or simulated) in this view.
    pub contrast: Option<f64>,
    /// Peak wavelength, nm.
    pub peak_nm: Option<f64>,
}

/// Accessor to one side of a comparison.
pub type Side = fn(&StateComparison) -> &Colour;

/// The simulated and the measured side.
pub const SIDES: [Side; 2] = [|one| &one.simulated, |one| &one.measured];

/// Reflectance factors, simulated and measured, over the wavelengths that both have.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SpectrumComparison {
    /// Wavelengths, nm.
    pub wavelength_nm: Vec<f64>,
    /// Simulated reflectance factors.
    pub simulated: Vec<f64>,
    /// Measured reflectance factors.
    pub measured: Vec<f64>,
    /// Mean difference, simulated minus measured.
    pub mean_difference: f64,
    /// Root mean square difference.
    pub rms_difference: f64,
    /// The largest difference, with its sign.
    pub largest_difference: f64,
    /// Wavelength of the largest difference, nm.
    pub largest_at_nm: f64,
    /// Standard deviations of the measured reflectance factors, if they are known.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub measured_deviation: Vec<f64>,
    /// Standard deviations of the simulated reflectance factors, if they are known.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub simulated_deviation: Vec<f64>,
}

/// Comparison of metrics that combine the states of a view; the first value of each pair is simulated, the second measured.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ViewComparison {
    /// Inclination of the simulated view, degrees.
    pub theta_deg: f64,
    /// Azimuth of the simulated view, degrees.
    pub phi_deg: f64,
    /// Y of white over Y of black.
    pub contrast_ratio: [Option<f64>; 2],
    /// Gamut area of red, green and blue in u'v', % of sRGB.
    pub gamut_percent_srgb: [Option<f64>; 2],
    /// The same, % of EBU.
    pub gamut_percent_ebu: [Option<f64>; 2],
    /// Coverage of the sRGB triangle, %.
    pub coverage_percent_srgb: [Option<f64>; 2],
    /// Mean over red, green and blue of the simulated minus the measured peak wavelength, nm, with its sign: differences of opposite
    /// signs cancel.
    pub average_peak_difference_nm: Option<f64>,
    /// Root mean square over red, green and blue of the difference of the peak wavelengths, nm.
    pub rms_peak_difference_nm: Option<f64>,
}

/// Warning for a measurement whose numbers look like per cent.
pub const IN_PERCENT: &str = "the measured Y is about a hundred times the simulated Y; expected reflectance factors and Y as fractions of 1, \
     not in per cent";

impl Comparison {
    /// True if the measured Y of every state is 20 to 500 times the simulated Y, as for numbers in per cent.
    pub fn looks_like_percent(&self) -> bool {
        let ratios = self.states.iter().map(|one| one.measured.Y / one.simulated.Y);
        !self.states.is_empty() && ratios.into_iter().all(|ratio| (20.0..500.0).contains(&ratio))
    }
}

/// Compares measured states with a simulated display.
///
/// # Errors
/// If no measured state has a counterpart.
pub fn compare(simulated: &Simulated, measured: &[Measured]) -> Result<Comparison, CompareError> {
    compare_measurement(simulated, &Measurement { states: measured.to_vec(), metrics: Vec::new() })
}

/// Compares measured states and metrics with a simulated display.
///
/// # Errors
/// If nothing that was measured has a counterpart.
pub fn compare_measurement(
    simulated: &Simulated,
    measurement: &Measurement,
) -> Result<Comparison, CompareError> {
    let mut left_out: Vec<LeftOut> = Vec::new();
    let mut pairs = Vec::new();
    let mut metrics = Vec::new();
    for one in &measurement.metrics {
        match one.compared(simulated) {
            Ok((found, note)) => {
                metrics.push(found);
                left_out.extend(note);
            }
            Err(reason) => left_out.push(reason),
        }
    }
    for one in &measurement.states {
        match pair(simulated, one) {
            Ok((pair, notes)) => {
                pairs.push(pair);
                left_out.extend(notes);
            }
            Err(reason) => left_out.push(reason),
        }
    }
    if pairs.is_empty() && metrics.is_empty() {
        return Err(CompareError::Nothing { reasons: with_states(gathered(&left_out), simulated) });
    }
    left_out.extend(not_measured(simulated, &pairs));
    let mut views: Vec<usize> = Vec::new();
    pairs.iter().for_each(|pair| {
        if !views.contains(&pair.view) {
            views.push(pair.view);
        }
    });
    let views = views.into_iter().map(|view| {
        let of_view: Vec<&mut Pair> = pairs.iter_mut().filter(|pair| pair.view == view).collect();
        together(of_view)
    });
    let (views, left_out) = (views.collect(), with_states(gathered(&left_out), simulated));
    let states: Vec<StateComparison> = pairs.into_iter().map(|pair| pair.comparison).collect();
    let of_metrics = Agreement::of(metrics.iter().filter_map(|one| one.z));
    let agreement = Agreement::together(states.iter().filter_map(|one| one.agreement).chain(of_metrics));
    Ok(Comparison { states, views, metrics, agreement, left_out })
}

#[cfg(test)]
mod tests {
    use papilio_colour::Observer;

    use super::pairs::between;
    use super::*;

    fn simulated() -> Simulated {
        let grid = Grid::new(380.0, 780.0, 10.0).unwrap();
        let observer = Observer::new(&grid).unwrap();
        let light = vec![1.0; grid.len()];
        let white = observer.xyz(&light).y;
        let state = |name: &str, factor: Vec<f64>| {
            let xyz = observer.xyz(&factor) * (1.0 / white);
            let (name, deviation) = (name.to_owned(), StateDeviation::default());
            SimulatedState { name, reflectance_factor: factor, xyz, deviation }
        };
        let view = |theta_deg, scale: f64| {
            let ramp = grid.wavelengths_nm().iter().map(|nm| scale * (nm - 300.0) / 500.0).collect();
            let states = vec![state("white", ramp), state("black", vec![0.02; grid.len()])];
            SimulatedView { theta_deg, phi_deg: 0.0, states, metrics: Vec::new() }
        };
        Simulated {
            grid,
            radiance_of_white: light,
            observer: Standard::Cie1931,
            views: vec![view(8.0, 0.5), view(-30.0, 0.3)],
        }
    }

    fn spectrum(
        state: &str,
        theta_deg: f64,
        phi_deg: f64,
        of: impl Fn(f64) -> f64,
        nm: [u16; 2],
    ) -> Measured {
        let nm: Vec<f64> = (nm[0]..=nm[1]).step_by(3).map(f64::from).collect();
        let values = nm.iter().map(|nm| of(*nm)).collect();
        let quantity = Quantity::Spectrum(Tabulated::new(nm, values).unwrap());
        Measured {
            state: state.to_owned(),
            theta_deg: Some(theta_deg),
            phi_deg,
            quantity,
            standard_deviation: None,
        }
    }

    /// A linear spectrum that is measured at other wavelengths than simulated has no difference.
    #[test]
    fn equal_displays_have_no_difference() {
        let measured = [
            spectrum("white", 8.2, 0.0, |nm| 0.5 * (nm - 300.0) / 500.0, [350, 800]),
            spectrum("black", 8.0, 360.0, |_| 0.02, [350, 800]),
            spectrum("white", 30.0, 180.0, |nm| 0.3 * (nm - 300.0) / 500.0 + 0.01, [350, 800]),
        ];
        let all = compare(&simulated(), &measured).unwrap();
        assert_eq!((all.states.len(), all.views.len()), (3, 2));
        assert!(all.states[0].delta_E_2000.unwrap() < 1e-9 && all.states[0].difference_Y.abs() < 1e-12);
        let [ours, theirs] = all.views[0].contrast_ratio;
        assert!((ours.unwrap() - theirs.unwrap()).abs() < 1e-9 && ours.unwrap() > 5.0);
        let off = all.states[2].spectrum.as_ref().unwrap();
        assert!((off.mean_difference + 0.01).abs() < 1e-12 && (off.rms_difference - 0.01).abs() < 1e-12);
        assert!((all.states[2].difference_Y + 0.01).abs() < 1e-12);
        assert_eq!(all.views[1].contrast_ratio, [None, None]);
        assert!(all.left_out.iter().any(|note| note == "not measured: black at theta -30 deg"));
        assert!(all.left_out.iter().any(|note| {
            note.starts_with("measured beside the view of 8 deg") && note.ends_with("white at theta 8.2 deg")
        }));
        assert_eq!(all.left_out.len(), 2, "{:?}", all.left_out);
    }

    /// Y over 400 to 700 nm and over 500 to 520 nm have no contrast, and no triangle with others.
    #[test]
    fn states_of_different_ranges_are_not_combined() {
        let mut simulated = simulated();
        for name in ["red", "green", "blue"] {
            let mut state = simulated.views[0].states[0].clone();
            state.name = name.to_owned();
            simulated.views[0].states.push(state);
        }
        let measured = |black: [u16; 2], blue: [u16; 2]| {
            let one = |name: &str, range| spectrum(name, 8.0, 0.0, |nm| 0.2 + nm * 1e-5, range);
            let whole = [380, 750];
            [
                one("white", whole),
                one("black", black),
                one("red", whole),
                one("green", whole),
                one("blue", blue),
            ]
        };
        let all = compare(&simulated, &measured([350, 800], [380, 720])).unwrap();
        assert!(all.views[0].contrast_ratio[1].is_some() && all.views[0].gamut_percent_srgb[1].is_some());
        let all = compare(&simulated, &measured([500, 520], [420, 600])).unwrap();
        assert_eq!((all.views[0].contrast_ratio, all.views[0].gamut_percent_srgb), ([None; 2], [None; 2]));
        assert!(all.states.iter().all(|one| one.state == "black" || one.measured.contrast.is_none()));
        for note in ["no contrast: black has another range", "colours are computed over"] {
            assert!(all.left_out.iter().any(|one| one.starts_with(note)), "{note} {:?}", all.left_out);
        }
        let all = compare(&simulated, &measured([350, 800], [420, 600])).unwrap();
        assert_eq!(all.views[0].gamut_percent_srgb, [None; 2]);
        assert!(
            all.left_out.iter().any(|one| one.starts_with("no gamut:") && one.contains("red, green")),
            "{:?}",
            all.left_out
        );
    }

    #[test]
    fn state_without_counterpart_is_skipped_with_its_reason() {
        let xyz = Quantity::Xyz(Xyz { x: 0.2, y: 0.2, z: 0.2 });
        let at = |state: &str, theta_deg| Measured {
            state: state.to_owned(),
            theta_deg: Some(theta_deg),
            phi_deg: 0.0,
            quantity: xyz.clone(),
            standard_deviation: None,
        };
        let measured = [
            at("orange", 8.0),
            at("white", 20.0),
            at("black", 8.0),
            spectrum("white", 8.0, 0.0, |_| 0.2, [900, 960]),
            spectrum("white", 8.0, 0.0, |_| 0.2, [500, 600]),
        ];
        let all = compare(&simulated(), &measured).unwrap();
        assert_eq!(all.states.len(), 2);
        assert!(all.states[0].spectrum.is_none() && all.states[0].simulated.peak_nm.is_none());
        for words in ["no such state: orange", "no view", "do not overlap", "over 500 to 590 nm only"] {
            assert!(all.left_out.iter().any(|reason| reason.contains(words)), "{words}: {:?}", all.left_out);
        }
        let none = compare(&simulated(), &measured[..2]).unwrap_err();
        assert!(none.to_string().contains("orange"), "{none}");
    }

    /// CIELAB of the simulated states themselves, with other letters in the names and without an angle, has no difference.
    #[test]
    fn lab_with_capital_names_and_without_angles_is_compared() {
        let mut simulated = simulated();
        let white = Observer::new(&simulated.grid).unwrap().xyz(&simulated.radiance_of_white);
        let white = white * (1.0 / white.y);
        let lab = |name: &str, xyz: Xyz| Measured {
            state: name.to_uppercase(),
            theta_deg: None,
            phi_deg: 0.0,
            quantity: Quantity::Lab(xyz.lab(white).unwrap()),
            standard_deviation: None,
        };
        let states = simulated.views[0].states.clone();
        let measured: Vec<Measured> = states.iter().map(|one| lab(&one.name, one.xyz)).collect();
        let several = compare(&simulated, &measured).unwrap_err().to_string();
        assert!(several.contains("several views") && several.contains("WHITE"), "{several}");
        simulated.views.truncate(1);
        let all = compare(&simulated, &measured).unwrap();
        assert_eq!((all.states.len(), all.states[0].state.as_str()), (2, "white"));
        assert!(all.states.iter().all(|one| one.delta_E_2000.unwrap() < 1e-9));
        assert!(
            all.left_out.iter().any(|note| note.ends_with("in capital letters only: WHITE, BLACK")),
            "{:?}",
            all.left_out
        );
    }

    /// A spectrum of a dark state whose noise is stronger than its signal has no colour.
    #[test]
    fn spectrum_with_negative_luminance_is_skipped_with_its_reason() {
        let measured = [
            spectrum("white", 8.0, 0.0, |_| 0.2, [400, 700]),
            spectrum("black", 8.0, 0.0, |_| -0.01, [400, 700]),
        ];
        let all = compare(&simulated(), &measured).unwrap();
        assert_eq!(all.states.len(), 1);
        assert!(all.left_out.iter().any(|reason| reason.contains("negative")), "{:?}", all.left_out);
    }

    /// A measurement that differs by k deviations has z = -k; deviations of both sides add in squares.
    #[test]
    fn z_is_the_difference_over_both_deviations() {
        let mut simulated = simulated();
        simulated.views.truncate(1);
        let bins = simulated.grid.len();
        simulated.views[0].states[1].deviation.reflectance_factor = vec![0.003; bins];
        simulated.views[0].metrics.push(SimulatedMetric {
            name: "contrast_ratio".to_owned(),
            value: 20.0,
            standard_deviation: 0.6,
        });
        let with = |mut one: Measured, deviation: f64| {
            if let Quantity::Spectrum(spectrum) = &one.quantity {
                let nm = spectrum.wavelengths_nm().to_vec();
                let values = vec![deviation; nm.len()];
                let values = Tabulated::new(nm, values).unwrap();
                one.standard_deviation = Some(StandardDeviation::Spectrum(values));
            }
            one
        };
        let ramp = |nm: f64| 0.5 * (nm - 300.0) / 500.0 + 0.03;
        let metric = |value: f64| MeasuredMetric {
            state: None,
            metric: crate::scene::Metric::contrast_ratio,
            theta_deg: None,
            phi_deg: 0.0,
            value,
            standard_deviation: Some(0.8),
            place: String::new(),
        };
        let states = vec![
            with(spectrum("white", 8.0, 0.0, ramp, [350, 800]), 0.02),
            with(spectrum("black", 8.0, 0.0, |_| 0.03, [350, 800]), 0.004),
        ];
        let measurement = Measurement { states, metrics: vec![metric(18.0)] };
        let all = compare_measurement(&simulated, &measurement).unwrap();
        assert!(all.states[0].z.iter().all(|z| (z + 1.5).abs() < 1e-9), "{:?}", all.states[0].z);
        assert!(all.states[1].z.iter().all(|z| (z + 2.0).abs() < 1e-9), "{:?}", all.states[1].z);
        assert!((all.metrics[0].z.unwrap() - 2.0).abs() < 1e-12);
        let agreement = all.states[0].agreement.unwrap();
        assert!((agreement.z_rms - 1.5).abs() < 1e-9 && agreement.within_2 == 1.0);
        assert_eq!(all.agreement.unwrap().count, 2 * bins + 1);
        // Without deviations there is no z.
        let plain = [spectrum("white", 8.0, 0.0, ramp, [350, 800])];
        let plain = compare(&simulated, &plain).unwrap();
        assert!(plain.agreement.is_none() && plain.states[0].z.is_empty());
    }

    #[test]
    fn angle_between_directions_accounts_for_azimuth() {
        assert!(between([8.0, 0.0], [-8.0, 180.0]) < 1e-9);
        assert!((between([30.0, 0.0], [-30.0, 0.0]) - 60.0).abs() < 1e-9);
        assert!((between([90.0, 0.0], [90.0, 90.0]) - 90.0).abs() < 1e-9);
    }
}
