//! A simulated display against a measured one, state by state and view by view.
//!
//! **What.** Each measured spectrum (or X, Y, Z) is held to the simulated state of the same name in the
//! view nearest to it, no more than [`NEAREST_DEG`] away. Spectra are compared where both have
//! wavelengths, on the simulation's grid, and both colours are taken over that range in the simulation's light.
//! What has no counterpart is left out, and said so.
//! **Source.** Feng 2012, figures 5.6 (spectra) and 5.7 (gamuts); differences are CIEDE2000 and u'v' distances.

mod left_out;
mod pairs;
mod views;

use papilio_colour::{Standard, Xyz};
use papilio_spectra::{Grid, Tabulated};
use serde::Serialize;

use left_out::{LeftOut, gathered};
use pairs::{Pair, pair};
use views::{not_measured, together};

/// Views further away from a measured direction are not those that were measured, degrees.
pub const NEAREST_DEG: f64 = 1.0;

/// What a run reported, as far as it can be compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// The wavelengths of all spectra, evenly spaced.
    pub grid: Grid,
    /// Spectral radiance of the perfect white.
    pub radiance_of_white: Vec<f64>,
    /// Whose X, Y, Z.
    pub observer: Standard,
    /// At least one.
    pub views: Vec<SimulatedView>,
}

/// What was simulated from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedView {
    /// Inclination, degrees; negative: towards phi + 180.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// Names, reflectance factors and relative X, Y, Z.
    pub states: Vec<(String, Vec<f64>, Xyz)>,
}

/// A state as it was measured from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Its name.
    pub state: String,
    /// Inclination, degrees; negative: towards phi + 180.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// What was measured.
    pub quantity: Quantity,
}

/// What a meter says of a state.
#[derive(Debug, Clone, PartialEq)]
pub enum Quantity {
    /// The reflectance factor against wavelength.
    Spectrum(Tabulated),
    /// Relative X, Y, Z: Y = 1 for a perfect white.
    Xyz(Xyz),
}

/// Why nothing can be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// No measured state has a counterpart.
    #[error("nothing that was measured has a counterpart in the result:\n  {}", .reasons.join("\n  "))]
    Nothing {
        /// Why, and for which states and directions.
        reasons: Vec<String>,
    },
}

/// Everything that was compared.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// One for each measured state that has a counterpart, in the order measured.
    pub states: Vec<StateComparison>,
    /// One for each direction, in the order measured: contrast and gamuts of both.
    pub views: Vec<ViewComparison>,
    /// What has no counterpart, in words.
    pub left_out: Vec<String>,
}

/// A state, simulated and measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[allow(non_snake_case, reason = "named as in result.json")]
pub struct StateComparison {
    /// Its name.
    pub state: String,
    /// Inclination of the simulated view, degrees.
    pub theta_deg: f64,
    /// Azimuth of the simulated view, degrees.
    pub phi_deg: f64,
    /// What the simulation says.
    pub simulated: Colour,
    /// What was measured.
    pub measured: Colour,
    /// CIEDE2000 difference, in the simulation's light.
    pub delta_E_2000: Option<f64>,
    /// u'v' distance.
    pub distance_uv: Option<f64>,
    /// Y simulated less Y measured.
    pub difference_Y: f64,
    /// Both spectra, if one was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spectrum: Option<SpectrumComparison>,
}

/// A colour, relative to a perfect white in the simulation's light.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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
    /// Where the spectrum peaks, nm.
    pub peak_nm: Option<f64>,
}

/// One side of a comparison.
pub type Side = fn(&StateComparison) -> &Colour;

/// What was simulated, and what was measured.
pub const SIDES: [Side; 2] = [|one| &one.simulated, |one| &one.measured];

/// Reflectance factors, simulated and measured, over the wavelengths that both have.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpectrumComparison {
    /// Wavelengths, nm.
    pub wavelength_nm: Vec<f64>,
    /// Simulated reflectance factors.
    pub simulated: Vec<f64>,
    /// Measured ones.
    pub measured: Vec<f64>,
    /// Mean of simulated less measured.
    pub mean_difference: f64,
    /// Root of the mean squared difference.
    pub rms_difference: f64,
    /// The largest difference, with its sign.
    pub largest_difference: f64,
    /// Where that is, nm.
    pub largest_at_nm: f64,
}

/// The states together, simulated and measured; the first of each pair is simulated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ViewComparison {
    /// Inclination of the simulated view, degrees.
    pub theta_deg: f64,
    /// Azimuth of the simulated view, degrees.
    pub phi_deg: f64,
    /// Y of white over Y of black.
    pub contrast_ratio: [Option<f64>; 2],
    /// Area of red, green and blue in u'v', % of sRGB's.
    pub gamut_percent_srgb: [Option<f64>; 2],
    /// The same, % of EBU's.
    pub gamut_percent_ebu: [Option<f64>; 2],
    /// Part of sRGB's triangle that is covered, %.
    pub coverage_percent_srgb: [Option<f64>; 2],
    /// Mean over red, green and blue of the peak simulated less the peak measured, nm.
    pub average_peak_difference_nm: Option<f64>,
}
/// Compares what was measured with what was simulated.
///
/// # Errors
/// If nothing measured has a counterpart.
pub fn compare(simulated: &Simulated, measured: &[Measured]) -> Result<Comparison, CompareError> {
    let mut left_out: Vec<LeftOut> = Vec::new();
    let mut pairs = Vec::new();
    for one in measured {
        match pair(simulated, one) {
            Ok(pair) => pairs.push(pair),
            Err(reason) => left_out.push(reason),
        }
    }
    if pairs.is_empty() {
        return Err(CompareError::Nothing { reasons: gathered(&left_out) });
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
    let (views, left_out) = (views.collect(), gathered(&left_out));
    Ok(Comparison { views, left_out, states: pairs.into_iter().map(|pair| pair.comparison).collect() })
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
            (name.to_owned(), factor, xyz)
        };
        let view = |theta_deg, scale: f64| {
            let ramp = grid.wavelengths_nm().iter().map(|nm| scale * (nm - 300.0) / 500.0).collect();
            let states = vec![state("white", ramp), state("black", vec![0.02; grid.len()])];
            SimulatedView { theta_deg, phi_deg: 0.0, states }
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
        Measured { state: state.to_owned(), theta_deg, phi_deg, quantity }
    }

    /// A linear spectrum is measured as it was simulated, at other wavelengths: no difference is left.
    #[test]
    fn the_same_display_has_no_difference() {
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
        assert_eq!(all.left_out, ["not measured: black at theta -30 deg"]);
    }

    #[test]
    fn what_has_no_counterpart_is_left_out_with_its_reason() {
        let xyz = Quantity::Xyz(Xyz { x: 0.2, y: 0.2, z: 0.2 });
        let at = |state: &str, theta_deg| Measured {
            state: state.to_owned(),
            theta_deg,
            phi_deg: 0.0,
            quantity: xyz.clone(),
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
        for words in ["no such state: orange", "no view", "do not meet", "over 500 to 590 nm alone"] {
            assert!(all.left_out.iter().any(|reason| reason.contains(words)), "{words}: {:?}", all.left_out);
        }
        let none = compare(&simulated(), &measured[..2]).unwrap_err();
        assert!(none.to_string().contains("orange"), "{none}");
    }

    #[test]
    fn directions_are_apart_by_the_angle_between_them() {
        assert!(between([8.0, 0.0], [-8.0, 180.0]) < 1e-9);
        assert!((between([30.0, 0.0], [-30.0, 0.0]) - 60.0).abs() < 1e-9);
        assert!((between([90.0, 0.0], [90.0, 90.0]) - 90.0).abs() < 1e-9);
    }
}
