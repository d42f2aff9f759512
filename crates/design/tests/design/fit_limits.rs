//! Fits at the limits of the data: ends of spectra, variables that belong together, too few or useless numbers, priors.

use papilio_colour::Xyz;
use papilio_design::fit::FitReport;
use papilio_display::compare::{Measured, MeasuredMetric, Measurement, Quantity, StandardDeviation};
use papilio_display::scene::Metric;
use papilio_spectra::Tabulated;

use crate::fit::{BARE, DISPLAY, FILL, FILM, GAP, SCALE, contains, fit, named, simulated, spectra, try_fit};

fn offset(most: f64) -> String {
    format!("[[fit.variables]]\nkey = \"meter.wavelength_offset_nm\"\nbounds = [{}, {most}]\n", -most)
}

/// The meter reads 0.8 nm too little, up to the ends of the range. All fits use all numbers; the bounds of the offset change
/// nothing, and the fit with the offset is the better one. The tables of the light end where the range ends.
#[test]
fn fits_with_and_without_an_offset_use_the_same_numbers() {
    let wide = BARE.replace("[400, 700]", "[380, 780]");
    let shifted = wide.replace("[380, 780]", "[380.8, 779.8]").replace("step_nm = 5", "step_nm = 1");
    let truth = simulated(&shifted, &[]);
    let mut here = simulated(&wide, &[]);
    let count = truth.grid.len();
    let seen = |k: usize| truth.views[0].states[0].reflectance_factor[(5 * k).min(count - 1)];
    here.views[0].states[0].reflectance_factor = (0..here.grid.len()).map(seen).collect();
    let measured = spectra(&here, &["film"], 5, false);
    let [without, narrow, far] =
        [String::new(), offset(3.0), offset(12.0)].map(|one| fit(&wide, &[FILM, &one], &measured));
    assert_eq!([&without, &narrow, &far].map(|one| one.observations), [81; 3]);
    assert!(
        (narrow.bic - far.bic).abs() < 0.05 && narrow.bic < without.bic - 2.0,
        "{} {} {}",
        without.bic,
        narrow.bic,
        far.bic
    );
    let found = named(&narrow, "meter.wavelength_offset_nm");
    assert!((found.value.unwrap() - 0.8).abs() < 4.0 * found.standard_error.unwrap(), "{found:?}");
    // An offset that hardly varies gives the fit without it.
    let held = fit(&wide, &[FILM, &offset(1e-6)], &measured);
    let penalty = 81_f64.ln();
    assert!((held.bic - without.bic - penalty).abs() < 0.1, "{} {}", held.bic, without.bic);
    // Two lights with tables: the ratio of their spectra is not known outside, and numbers are not used. The fit says so.
    let mixed = format!(
        "{wide}[lighting]\ndiffuse = 0.5\n[[lighting.directed]]\ntheta_deg = 40\nshare = 0.5\nspectrum = \"A\"\n"
    );
    let dropped = fit(&mixed, &[FILM, &offset(3.0)], &measured);
    assert_eq!(dropped.observations, 79);
    assert!(
        dropped.notes.iter().any(|note| note
            .contains("2 numbers are not used because of the bounds of meter.wavelength_offset_nm")),
        "{:?}",
        dropped.notes
    );
}

/// Two layers of one material, of which the data know the sum, 411 nm.
fn halves() -> (String, Measurement) {
    let two =
        "{ material = { n = 1.5 }, thickness_nm = 200 }, { material = { n = 1.5 }, thickness_nm = 200 }";
    let display = BARE.replace("{ material = { n = 1.5 }, thickness_nm = 400 }", two);
    let measured = spectra(
        &simulated(&display, &["display.pixel.film.0.thickness_nm=211".to_owned()]),
        &["film"],
        3,
        true,
    );
    (display, measured)
}

const FIRST: &str = "display.pixel.film.0.thickness_nm";
const SECOND: &str = "display.pixel.film.1.thickness_nm";

fn layer(key: &str, bounds: &str, more: &str) -> String {
    format!("[[fit.variables]]\nkey = \"{key}\"\nbounds = {bounds}\n{more}\n")
}

/// A prior that its bounds cut: both have numbers, and both say whose bounds end their intervals.
#[test]
fn intervals_that_bounds_cut_say_so() {
    let (display, measured) = halves();
    let prior = "prior = { mean = 200, sigma = 2 }";
    let second = layer(SECOND, "[150, 250]", "");
    let found = fit(&display, &[&layer(FIRST, "[197, 203]", prior), &second], &measured);
    assert!(found.undetermined.is_empty(), "{:?}", found.undetermined);
    let [first, other] = [FIRST, SECOND].map(|key| named(&found, key));
    assert_eq!(
        (first.interval_95, first.cut_by.as_slice()),
        (Some([197.0, 203.0]), [FIRST.to_owned()].as_slice())
    );
    assert_eq!(other.cut_by, [FIRST.to_owned()]);
    // 411 nm less the bounds, with the error of the sum.
    let [from, to] = other.interval_95.unwrap();
    assert!((from - 208.0).abs() < 0.5 && (to - 214.0).abs() < 0.5, "{other:?}");
    assert!(found.correlations[0][1].unwrap() < -0.99, "{:?}", found.correlations);
    assert!(
        found.notes.iter().any(|note| note.contains("within its prior") && note.contains(SECOND)),
        "{:?}",
        found.notes
    );
    // Wide bounds: the prior alone ends the intervals.
    let found = fit(&display, &[&layer(FIRST, "[150, 250]", prior), &second], &measured);
    assert!(found.variables.iter().all(|one| one.cut_by.is_empty()), "{:?}", found.variables);
}

/// Without the prior neither has a number, whatever the bounds; the scenario's own values stay where they fit as well.
#[test]
fn values_that_the_data_do_not_determine_stay_those_of_the_scenario() {
    let (display, measured) = halves();
    for bounds in ["[150, 250]", "[197, 203]"] {
        let found = fit(&display, &[&layer(FIRST, bounds, ""), &layer(SECOND, "[150, 250]", "")], &measured);
        assert_eq!(found.undetermined, [[FIRST, SECOND]]);
        let [first, second] = [FIRST, SECOND].map(|key| named(&found, key).best);
        assert!(first == 200.0 && (second - 211.0).abs() < 0.5, "{first} {second}");
        assert!(found.correlations[0][1].is_none());
    }
}

/// The level of the meter, within narrow bounds all of which fit, and the fill factor, whose interval only these bounds limit.
#[test]
fn partner_of_an_undetermined_variable_is_named_with_it() {
    let display = DISPLAY.replace("reflectance = 0.005", "reflectance = 0.01");
    let measured = spectra(&simulated(&display, &[]), &["one", "black"], 1, true);
    let level = SCALE.replace("[0.8, 1.2]", "[0.98, 1.02]");
    let found = fit(&display, &[FILL, &level, GAP], &measured);
    assert_eq!(found.undetermined, [["display.pixel.fill_factor", "meter.scale"]]);
    assert!(found.correlations[0][1].unwrap().abs() > 0.9, "{:?}", found.correlations);
    assert!(contains(named(&found, "display.pixel.gap_nm.one").interval_95, 190.0), "{found:?}");
}

/// Fill factor, level, and reflectance of the front, from the true values: a curved flat valley. Every start arrives.
#[test]
fn start_in_a_curved_flat_valley_arrives() {
    let truth = simulated(DISPLAY, &[]);
    let front = "[[fit.variables]]\nkey = \"display.front.0.reflectance\"\nbounds = [0, 0.05]\n";
    let text = format!("{DISPLAY}[fit]\nstarts = 1\n{FILL}{SCALE}{GAP}{front}");
    for seed in 0..8 {
        let found = try_fit(&text, &spectra(&truth, &["one", "black"], seed, true), 1).unwrap();
        let found = found.unwrap_or_else(|| panic!("seed {seed}: no minimum"));
        assert!(found.chi_square < 110.0, "seed {seed}: {}", found.chi_square);
        // 95 % of the intervals contain the true gap: five standard errors never miss it.
        let gap = named(&found, "display.pixel.gap_nm.one");
        assert!(
            (gap.value.unwrap() - 190.0).abs() < 5.0 * gap.standard_error.unwrap(),
            "seed {seed}: {gap:?}"
        );
    }
}

fn metric(state: &str, metric: Metric, value: f64, deviation: f64) -> MeasuredMetric {
    MeasuredMetric {
        state: Some(state.to_owned()),
        metric,
        theta_deg: None,
        phi_deg: 0.0,
        value,
        standard_deviation: Some(deviation),
        place: "metrics.csv:2:1".to_owned(),
    }
}

/// Metrics of states that the display does not have are no data.
#[test]
fn metrics_that_the_display_does_not_have_do_not_count() {
    let metrics = |others: &[&str]| {
        let others = others.iter().map(|state| metric(state, Metric::Y, 0.2, 0.1));
        Measurement {
            states: Vec::new(),
            metrics: std::iter::once(metric("black", Metric::Y, 0.1, 0.01)).chain(others).collect(),
        }
    };
    let two = format!("{DISPLAY}[fit]\n{GAP}{FILL}");
    let error = try_fit(&two, &metrics(&["red", "blue"]), 1).unwrap_err().to_string();
    assert!(
        error.contains("1 measured number cannot determine 2 variables") && error.contains("red.Y, blue.Y"),
        "{error}"
    );
    let one = format!("{DISPLAY}[fit]\n{FILL}");
    let found = try_fit(&one, &metrics(&["red"]), 1).unwrap().unwrap();
    assert_eq!(found.observations, 1);
    assert!(
        found
            .notes
            .iter()
            .any(|note| note.contains("no states or keys that define them") && note.contains("red.Y"))
    );
    let none = Measurement { states: Vec::new(), metrics: vec![metric("red", Metric::Y, 0.2, 0.1)] };
    let error = try_fit(&one, &none, 1).unwrap_err().to_string();
    assert!(error.contains("nothing is left to fit") && error.contains("red.Y"), "{error}");
}

/// A chi-square that no degree of freedom explains; and deviations whose squares are not numbers.
#[test]
fn number_that_no_value_explains_is_noted_and_useless_weights_are_refused() {
    let measured = |deviation| Measurement {
        states: Vec::new(),
        metrics: vec![metric("black", Metric::Y, 0.9, deviation)],
    };
    let text = format!("{DISPLAY}[fit]\n{FILL}");
    let found = try_fit(&text, &measured(0.01), 1).unwrap().unwrap();
    assert_eq!(found.degrees_of_freedom, 0);
    assert!(
        found.notes.iter().any(|note| note.contains("far above 0 degrees of freedom")),
        "{:?}",
        found.notes
    );
    for deviation in [1e-300, 1e-13, 1e300] {
        let error = try_fit(&text, &measured(deviation), 1).unwrap_err().to_string();
        assert!(
            error.contains("the metric `black.Y`") && error.contains("no usable weight"),
            "{deviation}: {error}"
        );
    }
    let Xyz { x, y, z } = simulated(DISPLAY, &[]).views[0].states[0].xyz;
    let colour = Measured {
        state: "one".to_owned(),
        theta_deg: None,
        phi_deg: 0.0,
        quantity: Quantity::Xyz(Xyz { x, y, z }),
        standard_deviation: Some(StandardDeviation::Colour([0.01, 1e-200, 0.01])),
    };
    let measured = Measurement { states: vec![colour], metrics: Vec::new() };
    let error = try_fit(&text, &measured, 1).unwrap_err().to_string();
    assert!(error.contains("`Y` of `one`"), "{error}");
}

/// A prior that is far too narrow, at a wrong value: the note names it instead of blaming the model alone.
#[test]
fn prior_against_the_data_is_named() {
    let truth = simulated(BARE, &["display.pixel.film.0.thickness_nm=411".to_owned()]);
    let measured = spectra(&truth, &["film"], 3, true);
    let narrow = format!("{FILM}prior = {{ mean = 405, sigma = 0.01 }}\n");
    let found = fit(BARE, &[&narrow], &measured);
    let note = found.notes.iter().find(|note| note.contains("is far above")).unwrap();
    assert!(note.contains("without the prior of display.pixel.film.0.thickness_nm, 405 +- 0.01"), "{note}");
    let right = format!("{FILM}prior = {{ mean = 411, sigma = 1 }}\n");
    assert!(!fit(BARE, &[&right], &measured).notes.iter().any(|note| note.contains("prior")));
}

/// Spectra of a simulation, without error and without a stated deviation.
fn exact(display: &str, set: &[&str], states: &[&str]) -> Measurement {
    let set: Vec<String> = set.iter().map(|one| (*one).to_owned()).collect();
    let of = simulated(display, &set);
    let mut measured = spectra(&of, states, 0, false);
    for state in &mut measured.states {
        let exact = of.views[0].states.iter().find(|one| one.name == state.state).unwrap();
        let values = exact.reflectance_factor.clone();
        state.quantity = Quantity::Spectrum(Tabulated::new(of.grid.wavelengths_nm(), values).unwrap());
    }
    measured
}

/// Data without error outweigh a prior at a wrong value, however many standard deviations away, and their residuals, of the last
/// digits, are no systematic difference. The likelihood of errors as large as the prior would need is smaller: 61 numbers, `2 * 61 *
/// ln(0.015/1e-6)` = 1170, against the squares of 6, 20 and 30 standard deviations.
#[test]
fn data_without_error_outweigh_a_prior() {
    let measured = exact(BARE, &["display.pixel.film.0.thickness_nm=411"], &["film"]);
    for sigma in [1.0, 0.3, 0.2] {
        let found = fit(BARE, &[&format!("{FILM}prior = {{ mean = 405, sigma = {sigma} }}\n")], &measured);
        assert!((found.variables[0].value.unwrap() - 411.0).abs() < 1e-3, "{sigma}: {:?}", found.variables);
        let away = 6.0 / sigma;
        assert!((found.chi_square / (away * away) - 1.0).abs() < 1e-3, "{sigma}: {}", found.chi_square);
        let remark = format!("{:.1} standard deviations of its prior", away);
        assert!(found.notes.len() == 1 && found.notes[0].contains(&remark), "{:?}", found.notes);
    }
}

/// Two numbers whose standard deviation follows from their residuals leave one degree of freedom to one variable, whose interval is
/// that of Student's quantile, 12.706.
#[test]
fn two_numbers_have_one_degree_of_freedom() {
    let mut measured = exact(BARE, &["display.pixel.film.0.thickness_nm=411"], &["film"]);
    let Quantity::Spectrum(spectrum) = &measured.states[0].quantity else { panic!("a spectrum") };
    let values = vec![spectrum.at(450.0).unwrap() + 2e-4, spectrum.at(600.0).unwrap() + 2e-4];
    measured.states[0].quantity = Quantity::Spectrum(Tabulated::new(vec![450.0, 600.0], values).unwrap());
    let found = fit(BARE, &[FILM], &measured);
    let one = &found.variables[0];
    let [from, to] = one.interval_95.unwrap();
    let ratio = 0.5 * (to - from) / one.standard_error.unwrap();
    assert!((ratio / 12.706 - 1.0).abs() < 0.02, "{ratio} {one:?}");
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    // Two variables leave none.
    let found = fit(BARE, &[FILM, SCALE], &measured);
    let warning = "2 measured numbers without a standard deviation count as exact, because 2 variables leave no residuals";
    assert!(found.warnings.len() == 1 && found.warnings[0].starts_with(warning), "{:?}", found.warnings);
}

/// A table that is listed twice counts once, as does a part of it, with the deviation of the one that states it: the fit is that of
/// the table alone. A second measurement with other errors counts, and its intervals are shorter by the root of 2.
#[test]
fn copies_of_a_table_count_once() {
    let truth = simulated(DISPLAY, &["display.pixel.gap_nm.one=184".to_owned()]);
    let width = |found: &FitReport| {
        let [from, to] = found.variables[0].interval_95.unwrap();
        to - from
    };
    for is_stated in [true, false] {
        let once = spectra(&truth, &["one", "black"], 5, is_stated);
        let alone = fit(DISPLAY, &[GAP], &once);
        let mut twice = once.clone();
        twice.append(once.clone());
        let mut part = once.states[0].clone();
        let Quantity::Spectrum(spectrum) = &part.quantity else { panic!("a spectrum") };
        let of = |all: &[f64]| all[4..20].to_vec();
        let cut = Tabulated::new(of(spectrum.wavelengths_nm()), of(spectrum.values())).unwrap();
        (part.quantity, part.standard_deviation) = (Quantity::Spectrum(cut), None);
        twice.states.insert(0, part);
        let found = fit(DISPLAY, &[GAP], &twice);
        assert_eq!((&found.variables, found.bic), (&alone.variables, alone.bic));
        assert_eq!((found.observations, found.residuals.last().unwrap().series), (62, 1));
        let note = "with the same numbers, which count once: one at theta 8 deg, black at theta 8 deg";
        assert!(found.notes.iter().any(|one| one.contains(note)), "{:?}", found.notes);
        let mut independent = once.clone();
        independent.append(spectra(&truth, &["one", "black"], 6, is_stated));
        let found = fit(DISPLAY, &[GAP], &independent);
        assert_eq!(found.observations, 124);
        let ratio = width(&alone) / width(&found);
        // Deviations from the residuals of 61 numbers have an error of 9 %.
        assert!((ratio / 2_f64.sqrt() - 1.0).abs() < if is_stated { 0.02 } else { 0.25 }, "{ratio}");
    }
}
