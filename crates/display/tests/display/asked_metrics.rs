//! Tests of optional metrics: the observer of 1964, gamut volume, colour appearance, reference state, reading
//! performance.

use crate::common::{run, scenario};
use papilio_colour::{CORNERS, Corners, Lab, Surround, Viewing, Xy, Xyz};
use papilio_display::readability::Reader;
use papilio_display::result::{ReferenceWhite, RunResult, State};

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

/// The reader's age affects only the performance at that age, which is between those of the neighbouring
/// ages.
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

/// Without front light, the luminance of text is proportional to the illuminance and its contrast is
/// constant, as the maps over illuminance and age assume.
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

/// Electronic paper answers from a living room to full sun at 60 years, by both solvers, with errors, and the
/// numbers are those of its luminances.
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

/// The reader that a scenario does not describe has the documented defaults. Reader and text affect only
/// readability.
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

/// Area of a triangle, and of its common part with another by sampling: independent of the clipping of the
/// program.
fn area_and_coverage(own: [[f64; 2]; 3], of: [[f64; 2]; 3]) -> [f64; 2] {
    let turn = |[a, b, c]: [[f64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let inside = |corners: [[f64; 2]; 3], at: [f64; 2]| {
        let [a, b, c] = corners;
        let sides = [[a, b, at], [b, c, at], [c, a, at]].map(|side| turn(side) * turn(corners) >= 0.0);
        sides == [true; 3]
    };
    const STEPS: usize = 1000;
    let (mut both, mut all) = (0.0, 0.0);
    for k in 0..STEPS * STEPS {
        let at = [k % STEPS, k / STEPS].map(|k| 0.8 * (k as f64 + 0.5) / STEPS as f64);
        if inside(of, at) {
            all += 1.0;
            both += if inside(own, at) { 1.0 } else { 0.0 };
        }
    }
    [100.0 * (turn(own) / turn(of)).abs(), 100.0 * both / all]
}

/// NTSC as data sheets state it: area in CIE 1931 xy, from the reported chromaticities.
#[test]
fn gamut_in_xy_equals_that_of_the_reported_chromaticities() {
    let result = indoor(&[]);
    let own = ["red", "green", "blue"].map(|name| {
        let value = &state(&result, name).value;
        [value.x.unwrap(), value.y.unwrap()]
    });
    let (view, ntsc) = (&result.views[0], [[0.67, 0.33], [0.21, 0.71], [0.14, 0.08]]);
    let p3 = [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]];
    for (of, area, coverage) in [
        (ntsc, view.metrics.gamut_percent_ntsc_xy, view.metrics.coverage_percent_ntsc_xy),
        (p3, view.metrics.gamut_percent_dci_p3_xy, view.metrics.coverage_percent_dci_p3_xy),
    ] {
        let [expected, sampled] = area_and_coverage(own, of);
        assert!((area.unwrap() - expected).abs() < 1e-9, "{area:?} {expected}");
        assert!((coverage.unwrap() - sampled).abs() < 0.1, "{coverage:?} {sampled}");
    }
    // 24.5 % in u'v': a quarter more.
    assert!((view.metrics.gamut_percent_ntsc_xy.unwrap() - 19.44).abs() < 0.005);
    assert!((view.metrics.gamut_percent_ntsc.unwrap() - 24.51).abs() < 0.005);
    assert!(view.discretisation_error.unwrap().gamut_percent_ntsc_xy.unwrap() > 0.0);
    let ten = indoor(&["metrics.observer=\"1964\""]);
    assert_eq!(ten.views[0].metrics.gamut_percent_ntsc_xy, None);
}

/// L*, a*, b* relative to a white, written independently of the program (CIE 15:2018).
fn cielab(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    let f = |k: usize| {
        let ratio = xyz[k] / white[k];
        if ratio > 216.0 / 24389.0 { ratio.powf(1.0 / 3.0) } else { (24389.0 / 27.0 * ratio + 16.0) / 116.0 }
    };
    [116.0 * f(1) - 16.0, 500.0 * (f(0) - f(1)), 200.0 * (f(1) - f(2))]
}

/// `metrics.white = "display"` changes what is relative to a white, and nothing else.
#[test]
fn display_white_changes_cielab_and_colour_differences_only() {
    let view = "viewer.theta_deg=[20, 8]";
    let perfect = indoor(&[view, "metrics.gamut_volume=true"]);
    let own = indoor(&[view, "metrics.gamut_volume=true", "metrics.white=display"]);
    assert_eq!(
        (perfect.reference_white, own.reference_white),
        (ReferenceWhite::Perfect, ReferenceWhite::Display)
    );
    let least = own.solver.relative_error_reached;
    for (perfect, own) in perfect.views.iter().zip(&own.views) {
        let white = own.states.get("white").unwrap();
        for ((name, state), (_, before)) in own.states.iter().zip(perfect.states.iter()) {
            let (value, before) = (&state.value, &before.value);
            assert_eq!(
                (value.X, value.Y, value.Z, value.u_prime, value.v_prime, value.contrast),
                (before.X, before.Y, before.Z, before.u_prime, before.v_prime, before.contrast)
            );
            assert_eq!(value.distance_from_white_uv, before.distance_from_white_uv);
            let array = |of: &State| xyz(of).to_array();
            let expected = cielab(array(state), array(white));
            let found = [value.L_star, value.a_star, value.b_star].map(Option::unwrap);
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-9, "{name}: {found} {expected}");
            }
            let [lab, reference] = [array(state), array(white)].map(|xyz| {
                let [l, a, b] = cielab(xyz, array(white));
                Lab { l, a, b }
            });
            let difference = value.metrics.delta_E_2000_from_white.unwrap();
            assert!((difference - lab.delta_e_2000(reference)).abs() < 1e-6, "{name}");
            assert_ne!(value.L_star, before.L_star);
        }
        let error = white.discretisation_error.as_ref().unwrap();
        assert!((white.value.L_star.unwrap() - 100.0).abs() < 1e-9, "{:?}", white.value.L_star);
        // The two levels agree exactly; what is left is the smallest relative error that is reported, that of
        // Y.
        assert!(error.L_star.unwrap() <= 100.1 * least && error.Y > 0.0, "{:?} {least}", error.L_star);
        let corners = Corners { xyz: CORNERS.map(|name| xyz(own.states.get(name).unwrap())) };
        let volume = corners.solid(xyz(white)).unwrap().volume();
        assert!((own.metrics.gamut_volume_cielab.unwrap() / volume - 1.0).abs() < 1e-9);
        assert_eq!(own.metrics.gamut_percent_srgb, perfect.metrics.gamut_percent_srgb);
        assert_eq!(own.metrics.contrast_ratio, perfect.metrics.contrast_ratio);
    }
}

/// Standard errors of the Monte Carlo solver with the display's white: none for L* of white, and that of the
/// ratio to white for the others; both solvers agree within them.
#[test]
fn errors_with_the_display_white_include_those_of_the_white() {
    let solver = ["solver.method=monte-carlo", "solver.paths=8192", "metrics.white=display"];
    let (walked, exact) = (indoor(&solver), indoor(&["metrics.white=display", "solver.relative_error=1e-5"]));
    let error = |name: &str| state(&walked, name).standard_error.L_star.unwrap();
    assert!(error("white") < 1e-9 && error("red") > 1e-4, "{} {}", error("white"), error("red"));
    for (name, walked) in walked.views[0].states.iter() {
        let (found, error) = (walked.value.L_star.unwrap(), walked.standard_error.L_star.unwrap());
        let truth = state(&exact, name).value.L_star.unwrap();
        assert!((found - truth).abs() < 5.0 * error + 1e-3, "{name}: {found} {truth} {error}");
    }
}

/// Two places where a stated error is known to be too small are named, and no others.
#[test]
fn errors_that_may_be_too_small_are_named() {
    let notes = |name: &str, method: [&str; 2], sets: &[&str]| {
        let sets = [sets, &method, &["spectrum.step_nm=100"]].concat();
        run(&scenario(name, &sets).unwrap().scene).unwrap().notes.join("; ")
    };
    let paths = ["solver.method=monte-carlo", "solver.paths=64"];
    let adding = ["solver.method=adding", "solver.relative_error=0.1"];
    for (thickness, method, is_named) in [(12, paths, true), (9, paths, false), (12, adding, false)] {
        let found = notes("slab", method, &[&format!("display.diffuser.optical_thickness={thickness}")]);
        assert_eq!(found.contains("few paths pass slabs of an optical thickness of 12"), is_named, "{found}");
    }
    // The last incidence of the file is 75 deg.
    let at = |theta_deg: f64, field_deg: f64, method: [&str; 2]| {
        let view = [format!("viewer.theta_deg={theta_deg}"), format!("viewer.field_deg={field_deg}")];
        notes("measured-h65", method, &["display.diffuser.extrapolate=none", &view[0], &view[1]])
    };
    let said = "goes across the end of the diffuser's measured directions";
    assert!(at(75.0, 4.0, adding).contains(said));
    assert!(!at(40.0, 4.0, adding).contains(said) && !at(75.0, 4.0, paths).contains(said));
}

/// Y above 1 is explained, with its cause and the white that L* is relative to.
#[test]
fn colour_brighter_than_a_perfect_white_is_explained() {
    assert_eq!(indoor(&[]).notes, Vec::<String>::new());
    let notes =
        |name: &str, overrides: &[&str]| run(&scenario(name, overrides).unwrap().scene).unwrap().notes;
    let [note] = &notes("indoor", &["viewer.theta_deg=[20, 40]"])[..] else { panic!("one note") };
    for part in [
        "in 1 of 2 views",
        "white at 20 deg",
        "mirror image",
        "L* exceeds 100",
        "metrics.white = \"display\"",
    ] {
        assert!(note.contains(part), "{note}");
    }
    let [note] = &notes("display-white", &["viewer.theta_deg=0"])[..] else { panic!("one note") };
    assert!(note.contains("the front light adds") && !note.contains("L*"), "{note}");
}
