//! Tests of reflectance by light, and of colour against angle, for displays with known results.

use std::sync::atomic::AtomicBool;

use crate::common::{run, scenario};
use papilio_colour::Observer;
use papilio_display::{Control, reflection};
use papilio_scenario::preset_names;

/// White paint without glass: its reflectance and colour are the same in any light and from all directions.
const PAINT: [&str; 6] = [
    "display={ glass = { index = 1.0 }, pixel = { model = \"uniform\", kind = \"lambertian\", reflectance = { white = 0.6, black = 0.03 } } }",
    "viewer.theta_deg=[-40, 8, 35]",
    "lighting.illuminance_lx=400",
    "lighting.diffuse=0.4",
    "lighting.directed=[{ theta_deg = 30, share = 0.35, spectrum = \"A\" }, { theta_deg = 10, share = 0.25, radius_deg = 5 }]",
    "spectrum.step_nm=10",
];

#[test]
fn reflectance_of_paint_is_the_same_in_every_light_and_view() {
    for method in ["solver.method=adding", "solver.method=monte-carlo"] {
        let result = run(&scenario("overcast", &[&PAINT[..], &[method]].concat()).unwrap().scene).unwrap();
        for view in &result.views {
            for (name, reflectance) in [("white", 0.6), ("black", 0.03)] {
                let state = view.states.get(name).unwrap();
                for (value, error) in std::iter::once((state.value.R_hemi, state.standard_error.R_hemi))
                    .chain(state.value.R_dir.iter().copied().zip(state.standard_error.R_dir.iter().copied()))
                {
                    let (value, error) = (value.unwrap(), error.unwrap());
                    assert!((value - reflectance).abs() < 5.0 * error + 1e-9, "{method} {name}: {value}");
                }
                let [value, error] = [&state.value, &state.standard_error].map(|values| values.metrics);
                let shift = value.shift_with_angle_uv.unwrap();
                assert!(shift <= 5.0 * error.shift_with_angle_uv.unwrap() + 1e-9, "{method} {name}: {shift}");
            }
            let white = view.states.get("white").unwrap().value.metrics;
            assert_eq!(
                (white.delta_E_2000_from_reference, white.distance_from_reference_uv),
                (Some(0.0), Some(0.0))
            );
            // 400 lx on 0.6 and 0.03: 76.4 and 3.82 cd/m2, far below the range of the surrogate.
            let (white, black) = (0.6 * 400.0 / std::f64::consts::PI, 0.03 * 400.0 / std::f64::consts::PI);
            let luminance = view.metrics.text_luminance_cd_m2.unwrap();
            assert!((luminance / (0.75 * white + 0.25 * black) - 1.0).abs() < 0.01, "{luminance}");
            assert!((view.metrics.text_contrast.unwrap() - 0.57 / 0.61).abs() < 0.01);
            assert_eq!(view.metrics.reading_surrogate_age_50, None);
        }
    }
}

/// The same paint in the light and geometry of all presets; in the light of readability tests, the luminance
/// of its text is known.
#[test]
fn reflectance_of_paint_is_the_same_in_every_preset() {
    for name in preset_names() {
        let preset = format!("lighting.preset={name}");
        let result = run(&scenario("overcast", &[&preset, PAINT[0]]).unwrap().scene).unwrap();
        let view = &result.views[0];
        for (state, reflectance) in [("white", 0.6), ("black", 0.03)] {
            let y = view.states.get(state).unwrap().value.Y;
            assert!((y - reflectance).abs() < 1e-6, "{name}, {state}: {y}");
        }
        if name == "daylight-readability" {
            let lux = 1e4 + 1e5 * std::f64::consts::FRAC_1_SQRT_2;
            let expected = (0.75 * 0.6 + 0.25 * 0.03) * lux / std::f64::consts::PI;
            assert!((view.metrics.text_luminance_cd_m2.unwrap() / expected - 1.0).abs() < 1e-6);
        }
    }
}

/// The reflectance under an absent light is undefined, and a single view is not compared.
#[test]
fn metrics_of_absent_lights_and_views_are_null() {
    let result = run(&scenario("overcast", &[]).unwrap().scene).unwrap();
    let white = result.views[0].states.get("white").unwrap();
    assert!(white.value.R_hemi.is_some() && white.value.R_dir.is_empty());
    assert_eq!(white.value.metrics.shift_with_angle_uv, None);
    let directed = ["lighting.diffuse=0", "lighting.directed=[{ theta_deg = -20, share = 1 }]"];
    let result = run(&scenario("overcast", &directed).unwrap().scene).unwrap();
    let white = result.views[0].states.get("white").unwrap();
    assert_eq!((white.value.R_hemi, white.value.R_dir.len()), (None, 1));
    assert!((white.value.R_dir[0].unwrap() - white.value.Y).abs() < 1e-12);
}

/// Eq. 3-1: Y is the mean of the reflectances under each light, weighted by their fractions of the white's Y.
#[test]
fn y_is_the_weighted_mean_of_the_reflectances_by_light() {
    let result = run(&scenario("indoor", &[]).unwrap().scene).unwrap();
    for (name, state) in result.views[0].states.iter() {
        let v = &state.value;
        let together = 0.5 * v.R_hemi.unwrap() + 0.5 * v.R_dir[0].unwrap();
        assert!((v.Y - together).abs() < 1e-12, "{name}: {together}");
    }
}

/// At each wavelength the reflectance factor is the mean of those by light, weighted by the light; the
/// luminous means of these are `R_hemi` and `R_dir`.
#[test]
fn reflectance_factor_is_the_weighted_mean_of_the_spectra_by_light() {
    let asked =
        ["metrics.spectra_by_light=true", "lighting.directed.0.spectrum=A", "lighting.directed.0.share=0.3"];
    let set = [&asked[..], &["lighting.diffuse=0.7"]].concat();
    let resolved = scenario("indoor", &set).unwrap();
    let result = run(&resolved.scene).unwrap();
    let white = &result.illuminant.radiance_of_white;
    let observer = Observer::new(&resolved.scene.grid).unwrap();
    let lamp = observer.scale_to_illuminance(&resolved.scene.lighting.directed[0].spectrum, 150.0).unwrap();
    for (name, state) in result.views[0].states.iter() {
        let by_light = state.value.by_light.as_ref().unwrap();
        let (hemi, dir) = (by_light.R_hemi.as_ref().unwrap(), by_light.R_dir[0].as_ref().unwrap());
        for (bin, white) in white.iter().enumerate() {
            let share = lamp[bin] / std::f64::consts::PI / white;
            let mean = share * dir[bin] + (1.0 - share) * hemi[bin];
            assert!(
                (mean - state.value.reflectance_factor.as_ref().unwrap()[bin]).abs() < 1e-12,
                "{name}, {bin}"
            );
        }
        let lit: Vec<f64> = dir.iter().zip(lamp.iter()).map(|(rho, light)| rho * light).collect();
        let luminous = observer.luminance(&lit) / 150.0;
        assert!((luminous - state.value.R_dir[0].unwrap()).abs() < 1e-12, "{name}: {luminous}");
        assert_eq!(state.discretisation_error.as_ref().unwrap().by_light.as_ref().unwrap().R_dir.len(), 1);
    }
}

/// The peak of a bare panel in diffuse light is that of its pixel; behind a diffuser, at 8 deg, it is shifted
/// towards the blue (Feng 2012, figure 5.13).
#[test]
fn diffuser_shifts_the_peaks_of_a_bare_panel() {
    let bare =
        run(&scenario("reference-pixel", &["solver.angle_medium=air", "viewer.theta_deg=8"]).unwrap().scene)
            .unwrap();
    let shift = bare.views[0].metrics.average_peak_shift_nm.unwrap();
    assert!(shift.abs() < 0.05, "{shift}");
    let diffused = run(&scenario("overcast", &[]).unwrap().scene).unwrap();
    let view = &diffused.views[0];
    let shift = view.metrics.average_peak_shift_nm.unwrap();
    assert!((-40.0..-2.0).contains(&shift), "{shift}");
    let mean = ["red", "green", "blue"]
        .map(|name| view.states.get(name).unwrap().value.metrics.peak_shift_nm.unwrap());
    assert!((shift - mean.iter().sum::<f64>() / 3.0).abs() < 1e-9);
}

/// Mirror, haze and Lambertian components of displays for which they are known, and their sum.
#[test]
fn components_of_known_reflections_are_recovered() {
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let at = [0.0, 8.0, 30.0];
    // Paint under a front that reflects 3 %: the paint is only Lambertian, the front only mirror.
    let set = [&PAINT[..], &["display.front=[{ reflectance = 0.03, absorptance = 0 }]"]].concat();
    let paint = reflection(&scenario("overcast", &set).unwrap().scene, &at, &control).unwrap();
    for one in &paint {
        let white = one.states.iter().find(|state| state.name == "white").unwrap();
        assert!((white.mirror - 0.03).abs() < 1e-9 && white.haze.abs() < 1e-3, "{one:?}");
        assert!((white.lambertian - 0.97 * 0.97 * 0.6 / (1.0 - 0.03 * 0.6)).abs() < 1e-3, "{one:?}");
        // Paint reflects a fraction sin^2(2.5 deg) cos(theta) of its light into the disc, the mirror all of
        // its light.
        let straight =
            0.03 + white.lambertian * one.theta_deg.to_radians().cos() * 2.5_f64.to_radians().sin().powi(2);
        assert!((white.beyond_straight.unwrap() - (1.0 - straight / white.returned)).abs() < 1e-4, "{one:?}");
    }
    // A lobe passed twice over a mirror, without front: no mirror image, and beyond 2.5 deg the fraction of
    // the double lobe, b' = 2 b: 1 - H with H of width 2b, over what leaves.
    let mirror = [
        "display.front=[]",
        "display.glass.index=1.0",
        "display.pixel={ model = \"uniform\", kind = \"mirror\", reflectance = { white = 1.0 } }",
        "display.diffuser={ model = \"k-correlation\", width = 0.02, transmittance = 1.0 }",
    ];
    let lobe = reflection(&scenario("overcast", &mirror).unwrap().scene, &[0.0], &control).unwrap();
    let white = &lobe[0].states[0];
    assert!(white.mirror == 0.0 && white.lambertian < 0.05, "{white:?}");
    let (b, s) = (0.04_f64, 2.5_f64.to_radians().sin());
    let straight = 1.0 - b / b.hypot(s);
    let beyond = 1.0 - straight / white.returned;
    assert!((white.beyond_straight.unwrap() - beyond).abs() < 5e-3, "{white:?} {beyond}");
    assert!((white.haze + white.lambertian - white.returned).abs() < 1e-12);
}
