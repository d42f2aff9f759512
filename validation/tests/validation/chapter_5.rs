//! The qualitative truths of Feng 2012, chapter 5, on the reference pixel.
use papilio_display::result::RunResult;
use papilio_display::scene::Layers;
use papilio_validation::{run, state, walked};

fn overcast(overrides: &[&str]) -> RunResult {
    run(&walked("overcast", overrides).unwrap().scene).unwrap()
}

/// The same panel, bare: no diffuser, no front of screen.
fn bare(overrides: &[&str]) -> RunResult {
    let scenario = walked("overcast", overrides).unwrap();
    let mut scene = scenario.scene;
    let Layers::Panel(panel) = &mut scene.display.layers else { panic!("an ordinary panel") };
    panel.diffuser = None;
    panel.front.clear();
    run(&scene).unwrap()
}

fn gamut(result: &RunResult) -> f64 {
    result.views[0].metrics.gamut_percent_srgb.unwrap()
}

fn contrast(result: &RunResult) -> f64 {
    result.views[0].metrics.contrast_ratio.unwrap()
}

/// "Decreased reflectance, reduced color gamut, and shifted spectrum" (p. 65): near the
/// normal the diffuser mixes in steeper rays, whose spectra lie to the blue. (Y of red
/// rises all the same: its peak moves from the deep red to where the eye sees more.)
#[test]
fn a_diffuser_lowers_reflectance_and_gamut_and_shifts_to_the_blue() {
    let (with, without) = (overcast(&["viewer.theta_deg=2"]), bare(&["viewer.theta_deg=2"]));
    assert!(gamut(&with) < gamut(&without) - 5.0, "{} {}", gamut(&with), gamut(&without));
    for name in ["white", "red", "green", "blue"] {
        let (diffused, bare) = (&state(&with, name).unwrap().value, &state(&without, name).unwrap().value);
        let [diffused, bare] = [diffused, bare].map(|state| peak(state.reflectance_factor.as_ref().unwrap()));
        assert!(diffused.1 < 0.95 * bare.1, "{name}: {diffused:?} {bare:?}");
        assert!(diffused.0 < bare.0, "{name}: {diffused:?} {bare:?}");
    }
    let y = |result| state(result, "white").unwrap().value.Y;
    assert!(y(&with) < y(&without));
}

/// Wavelength and height of the largest value beyond 400 nm, on the default grid.
fn peak(factor: &[f64]) -> (usize, f64) {
    let beyond = factor.iter().enumerate().skip(4);
    let (bin, most) = beyond.fold((0, 0.0), |best, (bin, r)| if *r > best.1 { (bin, *r) } else { best });
    (380 + 5 * bin, most)
}

/// Front reflection adds the light's own white to every state.
#[test]
fn contrast_and_gamut_fall_with_front_reflection() {
    let results: Vec<RunResult> = ["0", "0.005", "0.01", "0.02", "0.04"]
        .iter()
        .map(|r| {
            overcast(&[format!("display.front.0.reflectance={r}").as_str(), "display.front.0.absorptance=0"])
        })
        .collect();
    for pair in results.windows(2) {
        assert!(contrast(&pair[1]) < contrast(&pair[0]) - 0.5);
        assert!(gamut(&pair[1]) < gamut(&pair[0]) - 0.5);
    }
}

/// Gamut falls with the viewing angle, faster on the bare panel (fig. 5.8). The figure's
/// bare panel can only have angles in glass; with angles in air the bare gamut falls by 3 %
/// from 8 to 20 deg, less than the diffused one.
#[test]
fn gamut_falls_with_the_viewing_angle() {
    let falls = |at: &dyn Fn(&[&str]) -> RunResult| {
        gamut(&at(&["viewer.theta_deg=8"])) / gamut(&at(&["viewer.theta_deg=20"]))
    };
    let in_glass = |overrides: &[&str]| run(&walked("reference-pixel", overrides).unwrap().scene).unwrap();
    let (diffused, bare_in_air, bare_in_glass) = (falls(&overcast), falls(&bare), falls(&in_glass));
    assert!(bare_in_air > 1.0 && diffused > bare_in_air, "{diffused} {bare_in_air}");
    assert!(bare_in_glass > diffused, "{bare_in_glass} {diffused}");
}

/// Each part of Y by light is there, and they sum to Y (eq. 3-1).
#[test]
fn parts_of_y_sum_to_y() {
    let result = run(&walked("indoor", &[]).unwrap().scene).unwrap();
    for (name, state) in result.views[0].states.iter() {
        let terms = &state.value.terms;
        let sum = terms.diffuse + terms.directed.iter().sum::<f64>() + terms.front_reflection;
        assert!((sum - state.value.Y).abs() < 1e-12, "{name}");
        // Half of the light is diffuse, and the front mirrors .5 % of that.
        assert!((terms.front_reflection - 0.0025).abs() < 1e-6, "{name}: {}", terms.front_reflection);
        assert!(terms.diffuse > 0.0 && terms.directed[0] > 0.0);
    }
}

/// The books of a view close for every state, and sum to one.
#[test]
fn ledgers_close() {
    for name in ["indoor", "overcast", "epaper", "table-pixel", "own-material"] {
        let result = run(&walked(name, &[]).unwrap().scene).unwrap();
        for view in &result.views {
            for (state, ledger) in view.ledger.iter() {
                let a = &ledger.absorbed;
                let absorbed = a.front + a.diffuser + a.glass + a.pixel + a.inactive;
                let sum = ledger.returned + absorbed + ledger.unaccounted;
                assert!((sum - 1.0).abs() < 1e-9, "{name}, {state}: {sum}");
                let error = ledger.standard_error.unaccounted;
                assert!(
                    ledger.unaccounted.abs() <= 5.0 * error + 1e-12,
                    "{name}, {state}: {}",
                    ledger.unaccounted
                );
            }
        }
    }
}
