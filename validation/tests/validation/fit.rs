//! Fits against SciPy's `least_squares` over the program `tmm`: `validation/films/fit_oracle.py`.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_design::fit::Fitting;
use papilio_formats::{DataFile, read_measurement};
use papilio_scenario::Fit;

/// Light at the wavelengths of the data, on a bare film.
const BARE: &str = r#"
[spectrum]
range_nm = [395, 705]
step_nm = 5
[display.glass]
index = 1.0
surface = "fresnel"
"#;

const OVER_GAP: &str = r#"
[display.pixel]
model = "film"
substrate = { n = 3.9, k = 0.05 }
area = { one = 1.0 }
gap_nm = { one = 40.0 }
default_states = false
film = [{ material = { n = 2.1, k = 0.02 }, thickness_nm = 190 }, { material = "air", thickness_nm = "gap" }]
[display.pixel.states]
film = { one = { gap_nm = 40.0 } }
[fit]
starts = 4
[[fit.variables]]
key = "display.pixel.film.0.thickness_nm"
bounds = [170, 210]
[[fit.variables]]
key = "display.pixel.states.film.one.gap_nm"
bounds = [20, 70]
[[fit.variables]]
key = "display.pixel.film.0.material.k"
bounds = [0, 0.1]
"#;

/// An amorphous semiconductor on glass.
const AMORPHOUS: &str = r#"
[display.pixel]
model = "film"
substrate = 1.52
area = { one = 1.0 }
gap_nm = { one = 0.0 }
default_states = false
film = [{ material = "air", thickness_nm = "gap" }, { material = { model = "oscillators", eps_inf = 1.2, terms = [
    { kind = "tauc-lorentz", amplitude_ev = 90, energy_ev = 3.6, damping_ev = 2.3, gap_ev = 1.7 },
] }, thickness_nm = 160 }]
[display.pixel.states]
film = { one = { gap_nm = 0.0 } }
[fit]
starts = 4
[[fit.variables]]
key = "display.pixel.film.1.thickness_nm"
bounds = [130, 170]
[[fit.variables]]
key = "display.pixel.film.1.material.terms.0.amplitude_ev"
bounds = [60, 140]
[[fit.variables]]
key = "display.pixel.film.1.material.terms.0.gap_ev"
bounds = [1.5, 2.1]
"#;

/// A film over an air gap, whose three numbers are correlated by 0.99.
#[test]
fn film_and_gap_are_those_of_scipy_over_tmm() {
    fit_is_that_of_scipy(OVER_GAP, "fit");
}

/// Thickness, amplitude and gap of a Tauc-Lorentz film, whose index another program computes.
#[test]
fn tauc_lorentz_film_is_that_of_scipy_over_tmm_and_elli() {
    fit_is_that_of_scipy(AMORPHOUS, "fit_tauc");
}

/// Values, standard errors, intervals, correlations and chi-square are those of another program with another optimiser.
fn fit_is_that_of_scipy(scenario: &str, name: &str) {
    let films = Path::new(env!("CARGO_MANIFEST_DIR")).join("films");
    let data = format!("{name}_data.csv");
    let data = DataFile::open(&films.join(&data), &data).unwrap();
    let measured = read_measurement(&data).unwrap().value;
    let spec = Fit::from_text(&format!("{BARE}{scenario}"), "film", Path::new(""), &[]).unwrap();
    let stop = AtomicBool::new(false);
    let fitting = Fitting::new(spec, &measured, &stop).unwrap();
    let found = fitting.run(2, &|_, _| {}).unwrap().unwrap();
    let table = std::fs::read_to_string(films.join(format!("{name}.csv"))).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let number = |row: usize, column: usize| rows[row][column].parse::<f64>().unwrap();
    for (k, one) in found.variables.iter().enumerate() {
        let error = number(k, 2);
        let close = |ours: f64, theirs: f64, most: f64| {
            assert!((ours - theirs).abs() < most * error, "{}: {ours} {theirs}", one.key);
        };
        close(one.value.unwrap(), number(k, 1), 0.01);
        close(one.standard_error.unwrap(), error, 0.01);
        let [from, to] = one.interval_95.unwrap();
        close(from, number(k, 3), 0.03);
        close(to, number(k, 4), 0.03);
        for other in 0..3 {
            assert!((found.correlations[k][other].unwrap() - number(k, 5 + other)).abs() < 1e-3);
        }
    }
    assert!((found.chi_square - number(3, 1)).abs() < 1e-3, "{}", found.chi_square);
    assert_eq!((found.degrees_of_freedom, found.undetermined.len()), (58, 0));
}
