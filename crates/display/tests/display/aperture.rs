//! The numerical aperture of an objective: the mean over its pupil.

use std::path::Path;

use papilio_display::DisplayError;
use papilio_display::result::RunResult;
use papilio_scenario::{Resolved, Scenario};

use crate::common::run;

/// A film over a gap on glass in air: its colours change strongly with angle.
const FILM: &str = r#"
[spectrum]
range_nm = [400, 700]
step_nm = 50
[display.glass]
index = 1.0
surface = "fresnel"
[display.pixel]
model = "film"
substrate = 1.53
area = { one = 1.0 }
gap_nm = { one = 80.0 }
default_states = false
film = [{ material = { n = 2.35 }, thickness_nm = 290 }, { material = "air", thickness_nm = "gap" }]
[display.pixel.states]
film = { one = { gap_nm = 80.0 } }
[solver]
relative_error = 1e-5
"#;

fn resolved(set: &[&str]) -> Resolved {
    let set: Vec<String> = set.iter().map(|one| (*one).to_owned()).collect();
    Scenario::from_text(FILM, "film", Path::new(""), &set).unwrap().resolve().unwrap()
}

fn spectrum(result: &RunResult, view: usize) -> &[f64] {
    result.views[view].states.0[0].1.value.reflectance_factor.as_deref().unwrap()
}

/// The pupil is uniform in the square of the sine: the midpoint rule over views of small fields at these angles.
#[test]
fn pupil_of_an_objective_is_averaged_uniformly_in_direction_cosines() {
    let aperture: f64 = 0.8;
    let count = 60;
    let angles: Vec<String> = (0..count)
        .map(|k| aperture * ((f64::from(k) + 0.5) / f64::from(count)).sqrt())
        .map(|sine| sine.asin().to_degrees().to_string())
        .collect();
    let views = format!("viewer.theta_deg=[{}]", angles.join(","));
    let views = run(&resolved(&[&views, "viewer.field_deg=0"]).scene).unwrap();
    let mean = |bin: usize| {
        (0..angles.len()).map(|view| spectrum(&views, view)[bin]).sum::<f64>() / f64::from(count)
    };
    let at = format!("viewer.numerical_aperture={aperture}");
    let found = run(&resolved(&[&at]).scene).unwrap();
    let by_paths = resolved(&[&at, "solver.method=monte-carlo", "solver.paths=65536"]);
    let by_paths = run(&by_paths.scene).unwrap();
    let in_solid_angle = run(&resolved(&["viewer.field_deg=106.2602"]).scene).unwrap();
    let mut largest: f64 = 0.0;
    for bin in 0..7 {
        let expected = mean(bin);
        let adding = spectrum(&found, 0)[bin];
        assert!((adding - expected).abs() < 3e-5, "{bin}: {adding} {expected}");
        let state = &by_paths.views[0].states.0[0].1;
        let [value, error] =
            [&state.value, &state.standard_error].map(|all| all.reflectance_factor.as_ref().unwrap()[bin]);
        assert!((value - expected).abs() < 4.5 * error + 3e-5, "{bin}: {value} +- {error} {expected}");
        assert!(error < 1e-3, "{error}");
        largest = largest.max((spectrum(&in_solid_angle, 0)[bin] - expected).abs());
    }
    // A cone that is uniform in solid angle has other spectra.
    assert!(largest > 3e-3, "{largest}");
}

/// Light with directions is refused, at the key; so is a field of view beside it.
#[test]
fn aperture_in_directed_light_is_refused() {
    let lit = resolved(&["viewer.numerical_aperture=0.5", "lighting.preset=indoor"]);
    let error = run(&lit.scene).unwrap_err();
    assert_eq!(error, DisplayError::ApertureInDirectedLight);
    let located = lit.located(&error).unwrap().to_string();
    assert!(located.contains("viewer.numerical_aperture=0.5"), "{located}");
    let both = ["viewer.numerical_aperture=0.5".to_owned()];
    let text = format!("{FILM}[viewer]\nfield_deg = 20\nnumerical_aperture = 0.5\n");
    let errors = Scenario::from_text(&text, "film", Path::new(""), &[]).unwrap().resolve().unwrap_err();
    assert!(errors.to_string().contains("film:21:22"), "{errors}");
    let text = format!("{FILM}[viewer]\nfield_deg = 20\n");
    assert!(Scenario::from_text(&text, "film", Path::new(""), &both).unwrap().resolve().is_ok());
}
