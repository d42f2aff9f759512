//! Fits: synthetic measurements with known truth, pairs that cannot be told apart, priors, bounds, meters.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use papilio_colour::Xyz;
use papilio_design::DesignError;
use papilio_design::fit::{FitReport, FittedVariable, Fitting};
use papilio_display::Control;
use papilio_display::compare::{
    Measured, MeasuredMetric, Measurement, Quantity, Simulated, StandardDeviation,
};
use papilio_display::scene::Metric;
use papilio_sampling::{Distribution, SampleStream, Sampler};
use papilio_scenario::{Fit, Scenario};
use papilio_spectra::Tabulated;
use papilio_testing::sized;

/// A film pixel below a diffuser.
pub(crate) const DISPLAY: &str = r#"
[spectrum]
range_nm = [400, 700]
step_nm = 10
[[display.front]]
reflectance = 0.005
[display.diffuser]
model = "k-correlation"
haze = 0.78
total_transmittance = 0.9
[display.pixel]
model = "film"
substrate = "Al"
area = { one = 1.0 }
gap_nm = { one = 190.0, dark = 20.0 }
fill_factor = 0.9
film = [
  { material = "Cr:Johnson", thickness_nm = 12.0 },
  { material = "SiO2", thickness_nm = 38.0 },
  { material = "air", thickness_nm = "gap" },
]
default_states = false
[display.pixel.states]
one = { one = 1.0 }
black = { one = 0.0 }
[lighting]
preset = "overcast"
"#;

/// The pixel alone, with nothing above it.
pub(crate) const BARE: &str = r#"
[spectrum]
range_nm = [400, 700]
step_nm = 5
[display.glass]
index = 1.0
surface = "fresnel"
[display.pixel]
model = "film"
substrate = 3.5
area = { one = 1.0 }
gap_nm = { one = 0.0 }
default_states = false
film = [{ material = { n = 1.5 }, thickness_nm = 400 }, { material = "air", thickness_nm = "gap" }]
[display.pixel.states]
film = { one = { gap_nm = 0.0 } }
"#;

const CHROMIUM: &str = "[[fit.variables]]\nkey = \"display.pixel.film.0.thickness_nm\"\nbounds = [8, 16]\n";
pub(crate) const GAP: &str = "[[fit.variables]]\nkey = \"display.pixel.gap_nm.one\"\nbounds = [160, 220]\n";
const DARK: &str = "[[fit.variables]]\nkey = \"display.pixel.gap_nm.dark\"\nbounds = [5, 45]\n";
pub(crate) const FILM: &str =
    "[[fit.variables]]\nkey = \"display.pixel.film.0.thickness_nm\"\nbounds = [350, 450]\n";
pub(crate) const FILL: &str = "[[fit.variables]]\nkey = \"display.pixel.fill_factor\"\nbounds = [0.5, 1]\n";
pub(crate) const SCALE: &str = "[[fit.variables]]\nkey = \"meter.scale\"\nbounds = [0.8, 1.2]\n";
const OFFSET: &str = "[[fit.variables]]\nkey = \"meter.wavelength_offset_nm\"\nbounds = [-4, 4]\n";

pub(crate) fn simulated(text: &str, set: &[String]) -> Simulated {
    let resolved = Scenario::from_text(text, "display", Path::new(""), set).unwrap().resolve().unwrap();
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let result = papilio_display::run(&resolved.scene, &control).unwrap();
    Simulated::of(&result, &resolved.scene).unwrap()
}

/// Standard normal numbers.
fn normal(seed: u64, number: usize) -> f64 {
    let u = SampleStream::new(Sampler::Random, seed, 0).block(number as u64 / 4, 0)[number % 4];
    Distribution::Normal { mean: 0.0, sigma: 1.0, within: [f64::NEG_INFINITY, f64::INFINITY] }.quantile(u)
}

/// The spectra of a simulated display with noise of 0.5 % and 0.0005.
pub(crate) fn spectra(of: &Simulated, states: &[&str], seed: u64, is_stated: bool) -> Measurement {
    let nm = of.grid.wavelengths_nm();
    let mut number = 0;
    let one = |state: &&str| {
        let state = of.views[0].states.iter().find(|one| one.name == **state).unwrap();
        let deviation: Vec<f64> =
            state.reflectance_factor.iter().map(|value| (0.005 * value).hypot(5e-4)).collect();
        let values = state.reflectance_factor.iter().zip(&deviation).map(|(value, deviation)| {
            number += 1;
            value + deviation * normal(seed, number)
        });
        let values = values.collect();
        Measured {
            state: state.name.clone(),
            theta_deg: None,
            phi_deg: 0.0,
            quantity: Quantity::Spectrum(Tabulated::new(nm.clone(), values).unwrap()),
            standard_deviation: is_stated
                .then(|| StandardDeviation::Spectrum(Tabulated::new(nm.clone(), deviation).unwrap())),
        }
    };
    Measurement { states: states.iter().map(one).collect(), metrics: Vec::new() }
}

pub(crate) fn try_fit(
    text: &str,
    measurement: &Measurement,
    threads: usize,
) -> Result<Option<FitReport>, DesignError> {
    let spec = Fit::from_text(text, "display", Path::new(""), &[]).unwrap();
    let stop = AtomicBool::new(false);
    Fitting::new(spec, measurement, &stop)?.run(threads, &|_, _| {})
}

pub(crate) fn fit(display: &str, variables: &[&str], measurement: &Measurement) -> FitReport {
    let text = format!("{display}[fit]\nstarts = 2\n{}", variables.concat());
    try_fit(&text, measurement, 1).unwrap().unwrap()
}

pub(crate) fn contains(interval: Option<[f64; 2]>, value: f64) -> bool {
    interval.is_some_and(|[from, to]| (from..=to).contains(&value))
}

/// Probability of at most `count` of `of` events of this probability.
fn binomial_below(count: usize, of: usize, probability: f64) -> f64 {
    let mut logarithm = of as f64 * (1.0 - probability).ln();
    let mut sum = logarithm.exp();
    for k in 0..count {
        logarithm += ((of - k) as f64 / (k + 1) as f64 * probability / (1.0 - probability)).ln();
        sum += logarithm.exp();
    }
    sum
}

/// Whether a count agrees with a probability; two-sided, Sidak over the six counts of a test.
fn agrees(count: usize, of: usize, probability: f64) -> bool {
    let below = binomial_below(count, of, probability);
    let above = 1.0 - if count == 0 { 0.0 } else { binomial_below(count - 1, of, probability) };
    below.min(above) > 1e-4
}

/// The intervals of panels with random gaps and thicknesses, measured through their diffuser with noise,
/// contain the true values as often as they should: 68.27 and 95 %. Chi-square is that of its degrees of freedom.
#[test]
fn intervals_contain_the_true_values_as_often_as_they_should() {
    let panels = sized(12, 2000);
    let (mut counts, mut chi_square, mut freedom) = ([[0_usize; 2]; 3], 0.0, 0.0);
    for panel in 0..panels {
        let numbers = SampleStream::new(Sampler::Random, 7, 1).block(panel as u64, 0);
        let truth = [10.0 + 4.0 * numbers[0], 175.0 + 30.0 * numbers[1], 12.0 + 20.0 * numbers[2]];
        let set = [
            format!("display.pixel.film.0.thickness_nm={}", truth[0]),
            format!("display.pixel.gap_nm.one={}", truth[1]),
            format!("display.pixel.gap_nm.dark={}", truth[2]),
        ];
        let measured = spectra(&simulated(DISPLAY, &set), &["one", "black"], panel as u64, true);
        let found = fit(DISPLAY, &[CHROMIUM, GAP, DARK], &measured);
        for ((one, truth), counts) in found.variables.iter().zip(truth).zip(&mut counts) {
            counts[0] += usize::from(contains(one.interval_68, truth));
            counts[1] += usize::from(contains(one.interval_95, truth));
        }
        chi_square += found.chi_square;
        freedom += found.degrees_of_freedom as f64;
    }
    for counts in counts {
        assert!(
            agrees(counts[0], panels, 0.6827) && agrees(counts[1], panels, 0.95),
            "{counts:?} of {panels}"
        );
    }
    let z = (chi_square - freedom) / (2.0 * freedom).sqrt();
    assert!(z.abs() < 4.5, "chi-square {chi_square} of {freedom}");
    // The test of 2000 panels rejects intervals that are a tenth too narrow, in which 63 % are.
    assert!(panels < 2000 || !agrees(1260, panels, 0.6827));
}

/// A simulation without noise, whose errors follow from the residuals: the values are those of its scenario.
#[test]
fn exact_simulation_is_fitted() {
    let set =
        ["display.pixel.film.0.thickness_nm=11.5".to_owned(), "display.pixel.gap_nm.one=191".to_owned()];
    let of = simulated(DISPLAY, &set);
    let mut measured = spectra(&of, &["one", "black"], 0, false);
    for state in &mut measured.states {
        let exact = of.views[0].states.iter().find(|one| one.name == state.state).unwrap();
        let values = exact.reflectance_factor.clone();
        state.quantity = Quantity::Spectrum(Tabulated::new(of.grid.wavelengths_nm(), values).unwrap());
    }
    let found = fit(DISPLAY, &[CHROMIUM, GAP], &measured);
    for (one, truth) in found.variables.iter().zip([11.5, 191.0]) {
        assert!((one.value.unwrap() - truth).abs() < 1e-3, "{one:?}");
    }
}

pub(crate) fn named<'a>(found: &'a FitReport, key: &str) -> &'a FittedVariable {
    found.variables.iter().find(|one| one.key == key).unwrap()
}

/// The level of the meter and the fill factor of a pixel whose gaps between mirrors are black multiply the same
/// spectrum: no number for either, but one for the film. With a prior on the level both have one.
#[test]
fn pair_that_the_data_cannot_tell_apart_has_no_numbers() {
    let set =
        ["display.pixel.film.0.thickness_nm=411".to_owned(), "display.pixel.fill_factor=0.8".to_owned()];
    let measured = spectra(&simulated(BARE, &set), &["film"], 3, true);
    let found = fit(BARE, &[FILM, FILL, SCALE], &measured);
    assert_eq!(found.undetermined, [["display.pixel.fill_factor", "meter.scale"]]);
    for key in ["display.pixel.fill_factor", "meter.scale"] {
        let one = named(&found, key);
        assert!(one.value.is_none() && one.standard_error.is_none() && one.interval_95.is_none(), "{one:?}");
    }
    let film = named(&found, "display.pixel.film.0.thickness_nm");
    assert!(contains(film.interval_95, 411.0) && film.standard_error.unwrap() < 0.5, "{film:?}");
    assert!(
        (named(&found, "meter.scale").best * named(&found, "display.pixel.fill_factor").best - 0.8).abs()
            < 5e-3
    );
    // An index of the gap's mirror that the data hardly know: its interval spans narrow bounds.
    let narrow = "[[fit.variables]]\nkey = \"display.pixel.substrate.n\"\nbounds = [3.4999, 3.5001]\n";
    let bare = BARE.replace("substrate = 3.5", "substrate = { n = 3.5, k = 0 }");
    let found = fit(&bare, &[FILM, narrow], &measured);
    assert_eq!(found.undetermined, [["display.pixel.substrate.n"]]);
    let known = format!("{SCALE}prior = {{ mean = 1, sigma = 0.002 }}\n");
    let found = fit(BARE, &[FILM, FILL, &known], &measured);
    assert!(found.undetermined.is_empty(), "{:?}", found.undetermined);
    assert!(contains(named(&found, "display.pixel.fill_factor").interval_95, 0.8), "{found:?}");
}

/// The offset and the level of a meter are found together with the film that it measures; without them the film
/// is wrong by many standard errors.
#[test]
fn offset_and_level_of_the_meter_are_found() {
    let mut truth = simulated(BARE, &["display.pixel.film.0.thickness_nm=411".to_owned()]);
    let grid = truth.grid;
    // The meter reads 500 nm where the light has 501.5 nm, and 3 % too much.
    let factors = truth.views[0].states[0].reflectance_factor.clone();
    let nm = grid.wavelengths_nm();
    let exact = Tabulated::new(
        nm.iter().map(|nm| nm - 1.5).collect(),
        factors.iter().map(|one| 1.03 * one).collect(),
    );
    let exact = exact.unwrap();
    let seen = nm.iter().map(|nm| exact.at(nm.clamp(400.0, 698.5)).unwrap()).collect();
    truth.views[0].states[0].reflectance_factor = seen;
    let mut measured = spectra(&truth, &["film"], 5, true);
    let Quantity::Spectrum(spectrum) = &measured.states[0].quantity else { panic!("a spectrum") };
    let inside: Vec<usize> = (0..nm.len()).filter(|k| (410.0..=690.0).contains(&nm[*k])).collect();
    let of = |all: &[f64]| inside.iter().map(|k| all[*k]).collect::<Vec<f64>>();
    let cut = Tabulated::new(of(&nm), of(spectrum.values())).unwrap();
    let Some(StandardDeviation::Spectrum(deviation)) = &measured.states[0].standard_deviation else {
        panic!("known")
    };
    measured.states[0].standard_deviation =
        Some(StandardDeviation::Spectrum(Tabulated::new(of(&nm), of(deviation.values())).unwrap()));
    measured.states[0].quantity = Quantity::Spectrum(cut);
    let found = fit(BARE, &[FILM, OFFSET, SCALE], &measured);
    let [film, offset, scale] = [0, 1, 2].map(|k| found.variables[k].clone());
    assert!((offset.value.unwrap() - 1.5).abs() < 4.0 * offset.standard_error.unwrap(), "{offset:?}");
    assert!((scale.value.unwrap() - 1.03).abs() < 4.0 * scale.standard_error.unwrap(), "{scale:?}");
    assert!((film.value.unwrap() - 411.0).abs() < 4.0 * film.standard_error.unwrap(), "{film:?}");
    let without = fit(BARE, &[FILM], &measured).variables[0].clone();
    assert!((without.value.unwrap() - 411.0).abs() > 4.0 * without.standard_error.unwrap(), "{without:?}");
}

/// Without stated deviations, the one from the residuals is that of the noise, and the intervals are about those
/// with stated ones.
#[test]
fn deviation_that_is_not_stated_follows_from_the_residuals() {
    let set = ["display.pixel.film.0.thickness_nm=411".to_owned()];
    let truth = simulated(BARE, &set);
    let mut measured = spectra(&truth, &["film"], 11, false);
    let nm = truth.grid.wavelengths_nm();
    let factors = &truth.views[0].states[0].reflectance_factor;
    let values = factors.iter().enumerate().map(|(k, factor)| factor + 0.002 * normal(12, k)).collect();
    measured.states[0].quantity = Quantity::Spectrum(Tabulated::new(nm.clone(), values).unwrap());
    let found = fit(BARE, &[FILM], &measured);
    let estimated = found.estimated_deviation.reflectance_factor.unwrap();
    // The relative standard error of a deviation from 60 numbers is 9 %.
    assert!((estimated / 0.002 - 1.0).abs() < 0.4, "{estimated}");
    assert!((found.chi_square - found.degrees_of_freedom as f64).abs() < 0.01, "{found:?}");
    let stated = Tabulated::new(nm.clone(), vec![estimated; nm.len()]).unwrap();
    measured.states[0].standard_deviation = Some(StandardDeviation::Spectrum(stated));
    let with = fit(BARE, &[FILM], &measured);
    let [a, b] = [&found, &with].map(|one| one.variables[0].interval_68.unwrap());
    // Student's quantile of 60 degrees of freedom is 1.0085 for 1.
    let widths = (a[1] - a[0]) / (b[1] - b[0]);
    assert!((widths - 1.0085).abs() < 0.01, "{widths}");
    assert!((found.variables[0].value.unwrap() - with.variables[0].value.unwrap()).abs() < 1e-3);
}

/// Colours and a metric determine a gap; a value beyond a bound ends there, and this is stated.
#[test]
fn colours_metrics_and_bounds_are_used() {
    let truth = simulated(DISPLAY, &["display.pixel.gap_nm.one=181".to_owned()]);
    let state = |name: &str| truth.views[0].states.iter().find(|one| one.name == name).unwrap();
    let colour = |name: &str, quantity| Measured {
        state: name.to_owned(),
        theta_deg: None,
        phi_deg: 0.0,
        quantity,
        standard_deviation: Some(StandardDeviation::Colour([0.002; 3])),
    };
    let Xyz { x, y, z } = state("one").xyz;
    let metric = |metric, value, standard_deviation| MeasuredMetric {
        state: Some("black".to_owned()),
        metric,
        theta_deg: None,
        phi_deg: 0.0,
        value,
        standard_deviation,
        place: "metrics.csv:2:1".to_owned(),
    };
    let black = state("black").xyz.y;
    let mut measured = Measurement {
        states: vec![colour("one", Quantity::Xyz(Xyz { x, y, z }))],
        metrics: vec![metric(Metric::Y, black, Some(0.002))],
    };
    let found = fit(DISPLAY, &[GAP, DARK], &measured);
    assert_eq!((found.observations, found.residual_rms.is_some()), (4, true));
    assert!((found.variables[0].value.unwrap() - 181.0).abs() < 0.05, "{found:?}");
    assert!((found.variables[1].value.unwrap() - 20.0).abs() < 0.05, "{found:?}");
    let narrow = GAP.replace("[160, 220]", "[185, 220]");
    let found = fit(DISPLAY, &[&narrow], &measured);
    let gap = &found.variables[0];
    assert!(gap.at_bound && gap.value == Some(185.0) && gap.interval_95.unwrap()[0] == 185.0, "{gap:?}");
    measured.metrics[0].standard_deviation = None;
    let text = format!("{DISPLAY}[fit]\n{GAP}");
    let error = try_fit(&text, &measured, 1).unwrap_err().to_string();
    assert!(error.contains("`black.Y` (metrics.csv:2:1) has no standard deviation"), "{error}");
}

/// The same bits on one thread and on three.
#[test]
fn result_does_not_depend_on_threads() {
    let measured = spectra(&simulated(DISPLAY, &[]), &["one", "black"], 1, true);
    let text = format!("{DISPLAY}[fit]\nstarts = 3\n{CHROMIUM}{GAP}");
    let [one, three] = [1, 3].map(|threads| try_fit(&text, &measured, threads).unwrap().unwrap());
    assert_eq!(one, three);
    assert!(one.starts.best >= 2, "{:?}", one.starts);
}

/// A variable is at its bound. At the ends of the intervals of two other variables, chi-square is larger than that of the
/// fit by 1 and by 3.84: each end is checked by a fit in which this variable has this value.
#[test]
fn intervals_beside_a_variable_at_its_bound_are_those_of_fits_with_the_value_held() {
    let truth = simulated(DISPLAY, &["display.pixel.gap_nm.one=184".to_owned()]);
    let measured = spectra(&truth, &["one", "black"], 5, true);
    let beyond = "[[fit.variables]]\nkey = \"display.pixel.gap_nm.one\"\nbounds = [185, 220]\n";
    let held = |key: &str, at: f64| {
        format!("[[fit.variables]]\nkey = \"{key}\"\nbounds = [{}, {}]\n", at - 1e-7, at + 1e-7)
    };
    let found = fit(DISPLAY, &[CHROMIUM, beyond, DARK], &measured);
    assert!(named(&found, "display.pixel.gap_nm.one").at_bound, "{found:?}");
    for (variable, other) in [(0, DARK), (2, CHROMIUM)] {
        let one = &found.variables[variable];
        let [near, far] = [one.interval_68.unwrap(), one.interval_95.unwrap()];
        assert!(far[0] <= near[0] && near[1] <= far[1], "{one:?}");
        for (ends, increase) in [(near, 1.0), (far, 3.8415)] {
            for end in ends {
                let fixed = fit(DISPLAY, &[&held(&one.key, end), beyond, other], &measured);
                let found = fixed.chi_square - found.chi_square;
                assert!((found / increase - 1.0).abs() < 0.03, "{}: {end}: {found}", one.key);
            }
        }
    }
}

/// Three keys of which the data know hardly more than a product: a minimum, whose keys have no numbers.
#[test]
fn descent_along_a_flat_valley_ends_at_a_minimum() {
    let truth = simulated(DISPLAY, &["display.pixel.fill_factor=0.8".to_owned()]);
    let measured = spectra(&truth, &["one"], 8, true);
    let absorptance = "[[fit.variables]]\nkey = \"display.front.0.absorptance\"\nbounds = [0, 0.2]\n";
    let found = fit(DISPLAY, &[absorptance, SCALE, FILL], &measured);
    assert!(found.undetermined.iter().any(|group| group.len() > 1), "{found:?}");
    assert!(found.chi_square < 80.0, "{}", found.chi_square);
}

/// The whole is done when the fit has returned: no report of the progress says so before.
#[test]
fn progress_is_whole_only_at_the_end() {
    let truth = simulated(BARE, &["display.pixel.film.0.thickness_nm=411".to_owned()]);
    let measured = spectra(&truth, &["film"], 3, true);
    let spec = Fit::from_text(&format!("{BARE}[fit]\n{FILM}"), "display", Path::new(""), &[]).unwrap();
    let (stop, most) = (AtomicBool::new(false), Mutex::new(Vec::new()));
    let fitting = Fitting::new(spec, &measured, &stop).unwrap();
    fitting.run(1, &|fraction, _| most.lock().unwrap().push(fraction)).unwrap().unwrap();
    let reports = most.into_inner().unwrap();
    assert!(
        reports.is_sorted() && reports.last().is_some_and(|last| (0.9..1.0).contains(last)),
        "{reports:?}"
    );
}
