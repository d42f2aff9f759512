//! Tests of optional metrics: the observer of 1964, gamut volume, colour appearance, reference state, reading performance.

use crate::common::{run, scenario};
use papilio_colour::{CORNERS, Corners, Surround, Viewing, Xy, Xyz};
use papilio_display::readability::Reader;
use papilio_display::result::{RunResult, State};

fn indoor(overrides: &[&str]) -> RunResult {
    run(&scenario("indoor", overrides).unwrap().scene).unwrap()
}

fn state<'a>(result: &'a RunResult, name: &str) -> &'a State {
    result.views[0].states.get(name).unwrap()
}

fn xyz(state: &State) -> Xyz {
    Xyz { x: state.value.X, y: state.value.Y, z: state.value.Z }
}

/// Luminance does not depend on the observer, a perfect white has Y = 1 for both, and chromaticities differ.
#[test]
fn observer_of_1964_changes_colours_but_not_luminance() {
    let [two, ten] = ["1931", "1964"].map(|year| indoor(&[&format!("metrics.observer=\"{year}\"")]));
    for (name, seen) in two.views[0].states.iter() {
        let other = state(&ten, name);
        let (a, b) = (seen.value.luminance_cd_m2, other.value.luminance_cd_m2);
        assert!((a - b).abs() < 1e-9 * a, "{name}: {a} {b}");
        assert_eq!(seen.value.reflectance_factor, other.value.reflectance_factor);
    }
    let (green, other) = (state(&two, "green"), state(&ten, "green"));
    assert!((green.value.u_prime.unwrap() - other.value.u_prime.unwrap()).abs() > 1e-3);
    // D65 of each observer, in steps of 5 nm.
    for (result, x, y) in [(&two, 0.31272, 0.32903), (&ten, 0.31381, 0.33098)] {
        assert!((result.illuminant.x - x).abs() < 2e-4 && (result.illuminant.y - y).abs() < 2e-4);
    }
    let metrics = &ten.views[0].metrics;
    assert_eq!((metrics.gamut_percent_srgb, metrics.coverage_percent_ebu), (None, None));
    assert!(metrics.contrast_ratio.is_some() && other.value.hue_rgb.is_none());
    assert!(other.value.distance_from_d65_uv.is_some());
    let terms = &other.value.terms;
    assert!((terms.diffuse + terms.directed[0] + terms.front_reflection - other.value.Y).abs() < 1e-12);
}

#[test]
fn gamut_volume_is_that_of_the_states_if_requested() {
    assert_eq!(indoor(&[]).views[0].metrics.gamut_volume_cielab, None);
    let result = indoor(&["metrics.gamut_volume=true"]);
    let white = Xy { x: result.illuminant.x, y: result.illuminant.y }.with_luminance(1.0).unwrap();
    let corners = Corners { xyz: CORNERS.map(|name| xyz(state(&result, name))) };
    let (view, volume) = (&result.views[0], corners.solid(white).unwrap().volume());
    let found = view.metrics.gamut_volume_cielab.unwrap();
    assert!((found / volume - 1.0).abs() < 1e-9, "{found} {volume}");
    let error = view.discretisation_error.unwrap().gamut_volume_cielab.unwrap();
    assert!(error > 0.0 && error < 1e-2 * found, "{error}");
    // Without cyan the solid is not defined.
    let fewer = [
        "display.pixel.default_states=false",
        "display.pixel.states={ white = { red = 1, green = 1, blue = 1 } }",
    ];
    let result = indoor(&[&["metrics.gamut_volume=true"], &fewer[..]].concat());
    assert_eq!(result.views[0].metrics.gamut_volume_cielab, None);
}

#[test]
fn appearance_follows_the_viewing_conditions() {
    assert!(state(&indoor(&[]), "red").value.cam16.is_none());
    let result = indoor(&["metrics.appearance={ surround = \"dim\", background = 0.3 }"]);
    let white = Xy { x: result.illuminant.x, y: result.illuminant.y }.with_luminance(1.0).unwrap();
    // 500 lx on the background.
    let adapting_luminance_cd_m2 = 0.3 * 500.0 / std::f64::consts::PI;
    let viewing = Viewing { adapting_luminance_cd_m2, background: 0.3, surround: Surround::Dim };
    for (name, state) in result.views[0].states.iter() {
        let looks = xyz(state).appearance(white, &viewing).unwrap();
        let found = state.value.cam16.unwrap();
        assert!((found.J.unwrap() - looks.lightness).abs() < 1e-6, "{name}");
        assert!((found.b_prime.unwrap() - looks.uniform[2]).abs() < 1e-6, "{name}");
    }
}

#[test]
fn differences_are_relative_to_the_chosen_reference_state() {
    let result = indoor(&["metrics.reference_state=\"green\""]);
    let green = state(&result, "green").value.metrics;
    assert_eq!((green.delta_E_2000_from_reference, green.distance_from_reference_uv), (Some(0.0), Some(0.0)));
    let red = &state(&result, "red").value;
    let uv = |name: &str| {
        (state(&result, name).value.u_prime.unwrap(), state(&result, name).value.v_prime.unwrap())
    };
    let ((u, v), (gu, gv)) = (uv("red"), uv("green"));
    assert!((red.metrics.distance_from_reference_uv.unwrap() - (u - gu).hypot(v - gv)).abs() < 1e-12);
    assert!(red.metrics.delta_E_2000_from_reference.unwrap() > 20.0);
}

/// Colour differences between views, and CIELUV, equal those computed from the reported colours.
#[test]
fn colour_shift_with_angle_equals_that_of_the_reported_colours() {
    let result = indoor(&["viewer.theta_deg=[30, 0, 8]"]);
    let normal = |name: &str| result.views[1].states.get(name).unwrap().value.clone();
    let white = Xy { x: result.illuminant.x, y: result.illuminant.y }.with_luminance(1.0).unwrap();
    let lab = |state: &State| xyz(state).lab(white).unwrap();
    for (view, least) in result.views.iter().zip([5.0, 0.0, 0.5]) {
        for (name, state) in view.states.iter() {
            let (here, there, metrics) = (&state.value, normal(name), &state.value.metrics);
            let [du, dv] = [(here.u_prime, there.u_prime), (here.v_prime, there.v_prime)]
                .map(|(here, there)| here.unwrap() - there.unwrap());
            assert!((metrics.shift_with_angle_uv.unwrap() - du.hypot(dv)).abs() < 1e-12, "{name}");
            let delta_e = lab(state).delta_e_2000(lab(result.views[1].states.get(name).unwrap()));
            let found = metrics.delta_E_2000_with_angle.unwrap();
            assert!((found - delta_e).abs() < 1e-6 && found >= least, "{name}: {found} {delta_e}");
            let thirteen = 13.0 * here.L_star.unwrap();
            let u_star = thirteen * (here.u_prime.unwrap() - result.illuminant.u_prime);
            let v_star = thirteen * (here.v_prime.unwrap() - result.illuminant.v_prime);
            assert!((metrics.u_star.unwrap() - u_star).abs() < 1e-9, "{name}");
            assert!((metrics.v_star.unwrap() - v_star).abs() < 1e-9, "{name}");
        }
    }
}

/// The reader's age affects only the performance at that age, which is between those of the neighbouring ages.
#[test]
fn reader_age_affects_only_its_own_metric() {
    let lit = ["lighting.illuminance_lx=12000", "display.front=[{ reflectance = 0.08, absorptance = 0.01 }]"];
    let plain = indoor(&lit);
    assert_eq!(plain.views[0].metrics.reading_surrogate, None);
    for (age, known) in [(20, 0), (50, 1), (75, 2)] {
        let asked = indoor(&[&lit[..], &[&format!("viewer.age_years={age}")]].concat());
        let view = &asked.views[0].metrics;
        let ages =
            [view.reading_surrogate_age_20, view.reading_surrogate_age_50, view.reading_surrogate_age_75];
        assert!(ages[known].is_some() && view.reading_surrogate == ages[known], "{age}: {view:?}");
        assert_eq!(view.text_contrast, plain.views[0].metrics.text_contrast);
    }
    let between = indoor(&[&lit[..], &["viewer.age_years=60"]].concat()).views[0].metrics;
    let read = between.reading_surrogate.unwrap();
    assert!(
        between.reading_surrogate_age_75.unwrap() < read && read < between.reading_surrogate_age_50.unwrap()
    );
}

/// Without front light, the luminance of text is proportional to the illuminance and its contrast is constant, as the
/// maps over illuminance and age assume.
#[test]
fn text_luminance_is_proportional_to_illuminance_at_constant_contrast() {
    let cover = "display.front=[{ reflectance = 0.04, absorptance = 0.01 }]";
    let [dim, lit] = [2e4, 8e4].map(|lux| {
        let light = format!("lighting.illuminance_lx={lux}");
        let scene = scenario("overcast", &[cover, &light, "viewer.age_years=62.5"]).unwrap().scene;
        run(&scene).unwrap().views[0].metrics
    });
    let (l, c) = (dim.text_luminance_cd_m2.unwrap(), dim.text_contrast.unwrap());
    assert!((lit.text_luminance_cd_m2.unwrap() / l - 4.0).abs() < 1e-9);
    assert!((lit.text_contrast.unwrap() - c).abs() < 1e-9);
    // Halfway between 50 and 75 years, by the formula of docs/metrics.md: p0 + p1 ln(C/0.35) + p2 ln(L/1000).
    let (p0, p1, p2) = (0.5 * (0.6619 + 0.2971), 0.5 * (0.1845 + 0.3141), 0.5 * (0.0481 + 0.0074));
    let expected = p0 + p1 * (c / 0.35).ln() + p2 * (4.0 * l / 1000.0).ln();
    assert!((lit.reading_surrogate.unwrap() - expected).abs() < 1e-9, "{lit:?}");
}

/// Electronic paper answers from a living room to full sun at 60 years, by both solvers, with errors, and the numbers are
/// those of its luminances.
#[test]
fn electronic_paper_has_a_readability_in_every_light() {
    let reader = Reader { age_years: 60.0, text_height_mm: 1.6, distance_mm: 400.0 };
    for preset in ["living-room", "office", "daylight"] {
        let light = format!("lighting.preset=\"{preset}\"");
        for (method, error) in [("adding", 1e-4), ("monte-carlo", 1e-3)] {
            let solver = [format!("solver.method=\"{method}\""), format!("solver.relative_error={error}")];
            let scene = scenario("epaper-reading", &[&light, &solver[0], &solver[1]]).unwrap().scene;
            let result = run(&scene).unwrap();
            let view = &result.views[0];
            let [white, black] = ["white", "black"].map(|name| state(&result, name).value.luminance_cd_m2);
            let numbers = [
                (view.metrics.visibility_level, reader.visibility_level(white, black)),
                (view.metrics.contrast_margin, reader.contrast_margin(white, black)),
            ];
            for (found, expected) in numbers {
                assert!((found.unwrap() / expected.unwrap() - 1.0).abs() < 1e-6, "{preset}: {found:?}");
                assert!(found.unwrap() > 1.0, "{preset}");
            }
            let errors = view.discretisation_error.as_ref().unwrap_or(&view.standard_error);
            for (error, (value, _)) in
                [errors.visibility_level, errors.contrast_margin].into_iter().zip(numbers)
            {
                let relative = error.unwrap() / value.unwrap();
                assert!(relative > 0.0 && relative < 0.01, "{preset}, {method}: {relative}");
            }
            assert_eq!(
                (view.visibility_level_in_range, view.contrast_margin_in_range),
                (Some(true), Some(true))
            );
            assert!(result.reader.is_described && result.reader.age_years == 60.0);
        }
    }
}

/// The reader that a scenario does not describe has the documented defaults. Reader and text affect only readability.
#[test]
fn reader_affects_only_readability() {
    let [plain, asked] =
        [&[][..], &["viewer.text_height_mm=3", "viewer.distance_mm=400", "viewer.age_years=70"]].map(indoor);
    let of = |result: &RunResult| {
        let reader = result.reader;
        (reader.age_years, reader.text_height_mm, reader.distance_mm, reader.is_described)
    };
    assert_eq!((of(&plain), of(&asked)), ((25.0, 1.6, 500.0, false), (70.0, 3.0, 400.0, true)));
    let other = indoor(&["viewer.text_height_mm=3", "viewer.distance_mm=400"]);
    assert_eq!(of(&other), (25.0, 3.0, 400.0, true));
    let (few, many) = (&plain.views[0], &asked.views[0]);
    assert!(many.metrics.visibility_level > few.metrics.visibility_level);
    assert!(other.views[0].metrics.visibility_level > many.metrics.visibility_level);
    assert_eq!(few.states, many.states);
    let mut same = many.metrics;
    same.visibility_level = few.metrics.visibility_level;
    same.contrast_margin = few.metrics.contrast_margin;
    same.reading_surrogate = few.metrics.reading_surrogate;
    assert_eq!(same, few.metrics);
}

#[test]
fn readability_outside_the_range_of_the_models_is_marked() {
    let marks = |overrides: &[&str]| {
        let view = indoor(overrides).views.remove(0);
        assert!(view.metrics.visibility_level.is_some() && view.metrics.contrast_margin.is_some());
        (view.visibility_level_in_range, view.contrast_margin_in_range)
    };
    assert_eq!(marks(&[]), (Some(true), Some(true)));
    assert_eq!(marks(&["lighting.illuminance_lx=0.5"]), (Some(false), Some(false)));
    assert_eq!(marks(&["lighting.illuminance_lx=90000"]), (Some(false), Some(false)));
    assert_eq!(marks(&["viewer.age_years=20"]), (Some(false), Some(false)));
    assert_eq!(marks(&["viewer.text_height_mm=50"]), (Some(false), Some(true)));
    let colours = ["display.pixel.default_states=false", "display.pixel.states={ red = { red = 1 } }"];
    let view = indoor(&colours).views.remove(0);
    assert_eq!((view.metrics.visibility_level, view.visibility_level_in_range), (None, None));
}

/// Optional metrics do not affect the others: they are bit-identical.
#[test]
fn optional_metrics_do_not_affect_other_metrics() {
    let (plain, all) = (indoor(&[]), indoor(&["metrics.gamut_volume=true", "metrics.appearance={}"]));
    let mut forgotten = all;
    for view in &mut forgotten.views {
        for metrics in
            [Some(&mut view.metrics), Some(&mut view.standard_error), view.discretisation_error.as_mut()]
        {
            metrics.unwrap().gamut_volume_cielab = None;
        }
        for (_, state) in &mut view.states.0 {
            let errors = [&mut state.standard_error, state.discretisation_error.as_mut().unwrap()];
            errors.into_iter().for_each(|values| values.cam16 = None);
            state.value.cam16 = None;
        }
    }
    assert_eq!(plain, forgotten);
}
