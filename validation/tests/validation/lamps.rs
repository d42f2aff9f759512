//! Steps of the grid against 1 nm, on the same display: lights with lines narrower than the step, smooth lights.

use papilio_display::result::{RunResult, State, XyzError};
use papilio_validation::{run, scenario};

fn with(light: &str, more: &[&str]) -> RunResult {
    let light = format!("lighting.spectrum={light}");
    run(&scenario("lamps", &[&[&*light], more].concat()).unwrap().scene).unwrap()
}

fn states(result: &RunResult) -> impl Iterator<Item = (&str, &State)> {
    result.views[0].states.iter()
}

/// X, Y and Z at 5 nm are those at 1 nm within the errors that the result states. The white of the light
/// itself is the same to rounding, because it needs no interpolation.
#[test]
fn lines_at_5_nm_have_the_colours_of_a_grid_of_1_nm() {
    let lights =
        ["data/synthetic-lines.csv", "{ led_nm = 532, width_nm = 2 }", "{ led_nm = 633.3, width_nm = 1 }"];
    for light in lights {
        let (coarse, fine) = (with(light, &[]), with(light, &["spectrum.step_nm=1"]));
        let uv = |result: &RunResult| (result.illuminant.u_prime, result.illuminant.v_prime);
        let ((u, v), (u_fine, v_fine)) = (uv(&coarse), uv(&fine));
        // A line of 1 nm between two integer wavelengths is sampled on the fine grid, which is off by 2e-4 in u'; the means are
        // right (`narrow_leds_have_the_colours_of_their_integrals`).
        let of_samples = if light.contains("633.3") { 2e-4 } else { 0.0 };
        assert!((u - u_fine).hypot(v - v_fine) < 1e-4 + of_samples, "{light}: {u} {v}, {u_fine} {v_fine}");
        for ((name, a), (_, b)) in states(&coarse).zip(states(&fine)) {
            let stated = a.interpolation_error.unwrap();
            let pairs = [
                (a.value.X, b.value.X, stated.X),
                (a.value.Y, b.value.Y, stated.Y),
                (a.value.Z, b.value.Z, stated.Z),
            ];
            for (coarse, fine, stated) in pairs {
                // Twice the estimate, the error target of the solver, and the samples of the fine grid, on the slope of X.
                let allowed = 2.0 * stated + (1e-3 + 5.0 * of_samples) * fine.max(0.01);
                assert!((coarse - fine).abs() < allowed, "{light} {name}: {coarse} {fine} {stated:.1e}");
            }
            let luminance = a.value.luminance_cd_m2 / b.value.luminance_cd_m2 - 1.0;
            assert!(luminance.abs() < 0.02, "{light} {name}: {luminance}");
        }
    }
}

/// An LED of 1 nm between two integer wavelengths, at 5 nm, against sums in steps of 0.02 nm with an observer that is linear between 1 nm.
#[test]
fn narrow_leds_have_the_colours_of_their_integrals() {
    let found = with("{ led_nm = 633.3, width_nm = 1 }", &[]).illuminant;
    let own = papilio_spectra::Grid::new(620.0, 645.0, 1.0).unwrap();
    let observer = papilio_colour::Observer::new(&own).unwrap();
    let bars = observer.weights();
    let mut sums = [0.0; 3];
    for part in 0..1250_u32 {
        let at = 0.02 * f64::from(part);
        let (k, along) = (at as usize, at % 1.0);
        let g = (-(620.0 + at - 633.3).powi(2)).exp();
        let light = (g + 2.0 * g.powi(5)) / 3.0;
        for (sum, bar) in sums.iter_mut().zip(bars) {
            *sum += light * ((1.0 - along) * bar[k] + along * bar[k + 1]);
        }
    }
    let [x, y, z] = sums;
    let all = x + 15.0 * y + 3.0 * z;
    assert!((found.u_prime - 4.0 * x / all).hypot(found.v_prime - 9.0 * y / all) < 1e-5, "{found:?}");
}

/// Without its own spectrum, the lamp would lose three of its lines: the display would have another colour.
#[test]
fn lines_between_wavelengths_of_the_grid_are_not_lost() {
    let file = with("data/synthetic-lines.csv", &[]);
    let (u, v) = (file.illuminant.u_prime, file.illuminant.v_prime);
    // u', v' of the file: sums over 1 nm with the observer of 1931, as spectrum.step_nm = 1 computes them.
    let fine = with("data/synthetic-lines.csv", &["spectrum.step_nm=1"]).illuminant;
    assert!((u - fine.u_prime).hypot(v - fine.v_prime) < 1e-12);
    // The wavelengths of the grid alone.
    let grid = papilio_spectra::Grid::new(380.0, 780.0, 5.0).unwrap();
    let text = std::fs::read_to_string("../scenarios/data/synthetic-lines.csv").unwrap();
    let rows = text.lines().skip(2).map(|row| row.split_once(',').unwrap());
    let values: Vec<f64> = rows.map(|(_, value)| value.parse().unwrap()).step_by(5).collect();
    let sampled = papilio_colour::Observer::new(&grid).unwrap().xyz(&values).uv_prime().unwrap();
    assert!((u - sampled.u).hypot(v - sampled.v) > 0.01, "{sampled:?}, {u} {v}");
}

/// FL11 against an LED on the same display: u'v' of white and the gamut, at 5 nm and 1 nm. These tables need
/// no representation by means at 5 nm; the differences are those of reflectances between wavelengths.
#[test]
fn fluorescent_lamp_and_led_have_the_same_colours_at_5_and_1_nm() {
    for light in ["FL11", "TL84", "FL2", "LED-B3"] {
        let (coarse, fine) = (with(light, &[]), with(light, &["spectrum.step_nm=1"]));
        for ((name, a), (_, b)) in states(&coarse).zip(states(&fine)) {
            assert_eq!(b.interpolation_error, None);
            let (a, b) = (&a.value, &b.value);
            let apart =
                (a.u_prime.unwrap() - b.u_prime.unwrap()).hypot(a.v_prime.unwrap() - b.v_prime.unwrap());
            assert!(apart < 5e-4 && (a.Y - b.Y).abs() < 5e-4, "{light} {name}: {apart:.1e} {} {}", a.Y, b.Y);
        }
    }
}

/// A film in smooth light: X, Y and Z in coarse steps against those in steps of 1 nm. The stated error is the difference; it has a
/// warning above 0.001, and the suggested step is the coarsest that is fine enough.
#[test]
fn coarse_steps_have_their_error_and_a_warning_in_every_light() {
    for light in ["A", "E", "D65"] {
        let at = |step: f64| {
            let sets = [format!("lighting.spectrum={light}"), format!("spectrum.step_nm={step}")];
            run(&scenario("indoor", &sets.each_ref().map(String::as_str)).unwrap().scene).unwrap()
        };
        let fine = at(1.0);
        assert!(fine.warnings.is_empty(), "{light}: {:?}", fine.warnings);
        let true_error = |coarse: &RunResult| {
            let errors = states(coarse).zip(states(&fine)).map(|((_, a), (_, b))| {
                let (a, b) = (&a.value, &b.value);
                [a.X - b.X, a.Y - b.Y, a.Z - b.Z].into_iter().map(f64::abs).fold(0.0, f64::max)
            });
            errors.fold(0.0, f64::max)
        };
        for step in [20.0, 10.0, 5.0] {
            let coarse = at(step);
            let error = true_error(&coarse);
            let stated = states(&coarse).map(|(_, state)| {
                let stated = state.interpolation_error.unwrap();
                stated.X.max(stated.Y).max(stated.Z)
            });
            let stated = stated.fold(0.0, f64::max);
            assert!((stated / error - 1.0).abs() < 0.12, "{light} {step}: {stated} {error}");
            let said = coarse.warnings.iter().find(|warning| warning.contains("has an error of about"));
            assert_eq!(said.is_some(), error > 1e-3, "{light} {step}: {error} {:?}", coarse.warnings);
            let Some(said) = said else { continue };
            let finer: f64 = said.split("set spectrum.step_nm = ").nth(1).unwrap().parse().unwrap();
            assert!(true_error(&at(finer)) < 1e-3 && true_error(&at(2.0 * finer)) > 1e-3, "{light}: {said}");
        }
    }
}

/// Inks given every 10 nm are linear there: a grid of 10 nm has no error in light of equal energy, and no warning.
#[test]
#[allow(non_snake_case, reason = "the field's own letters")]
fn tables_with_all_points_on_the_grid_have_no_error() {
    let sets = ["lighting.spectrum=E", "spectrum.step_nm=10"];
    let result = run(&scenario("six-ink", &sets).unwrap().scene).unwrap();
    for (name, state) in states(&result) {
        let XyzError { X, Y, Z } = state.interpolation_error.unwrap();
        assert!(X.max(Y).max(Z) < 1e-6, "{name}: {X} {Y} {Z}");
    }
    assert!(result.warnings.is_empty(), "{:?}", result.warnings);
}
