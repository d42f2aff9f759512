//! Whatever the data, a figure is a well-formed page that says what it shows.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test says what it expects by unwrapping")]

use papilio_display::result::{Named, RunResult, StateValues};
use papilio_figures::{
    AngleMetric, PixelScan, against_angle, chromaticity, overview, patches, pixel_scan, spectra,
};

mod made_up;

/// Every figure of a run.
fn all(run: &RunResult) -> Vec<String> {
    let mut figures: Vec<String> = AngleMetric::ALL.map(|metric| against_angle(run, metric)).to_vec();
    for view in &run.views {
        figures.extend([
            spectra(run, view),
            chromaticity(run, view),
            patches(run, view),
            overview(run, view),
        ]);
    }
    figures
}

/// The texts of a figure, which must be XML without a number that is none.
fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).expect("well-formed XML");
    assert_eq!(document.root_element().tag_name().name(), "svg");
    for node in document.descendants().filter(|node| node.is_element()) {
        for attribute in node.attributes() {
            let value = attribute.value().to_lowercase();
            assert!(!value.contains("nan") && !value.contains("inf"), "{}=\"{value}\"", attribute.name());
        }
    }
    assert!(!svg.contains("NaN") && !svg.contains(" inf"), "a number that is none");
    document
        .descendants()
        .filter(|n| n.has_tag_name("text"))
        .filter_map(|n| n.text())
        .map(str::to_owned)
        .collect()
}

fn says(svg: &str, wanted: &[&str]) {
    let texts = texts(svg);
    for wanted in wanted {
        assert!(texts.iter().any(|text| text.contains(wanted)), "{wanted} is not among {texts:?}");
    }
}

const STATES: [&str; 8] = ["white", "black", "red", "green", "blue", "cyan", "magenta", "yellow"];

#[test]
fn every_figure_names_its_states_and_axes() {
    let run = made_up::result(&[8.0, 0.0, 30.0], 0.05);
    let view = &run.views[0];
    for svg in [spectra(&run, view), chromaticity(&run, view), patches(&run, view), overview(&run, view)] {
        says(&svg, &STATES);
    }
    says(&spectra(&run, view), &["Wavelength (nm)", "Reflectance factor", "one standard error"]);
    says(
        &chromaticity(&run, view),
        &["u\u{2032}", "v\u{2032}", "% of sRGB", "% of EBU", "light", "520", "display"],
    );
    says(&overview(&run, view), &["Viewed at 8\u{b0}", "contrast", "gamut"]);
    for metric in AngleMetric::ALL {
        says(&against_angle(&run, metric), &["Viewing angle (deg)", "one standard error"]);
    }
    says(&against_angle(&run, AngleMetric::Reflectance), &STATES);
    says(&against_angle(&run, AngleMetric::Peak), &["red", "green", "blue", "Peak wavelength (nm)"]);
}

/// Errors are drawn only where they can be seen.
#[test]
fn small_errors_leave_no_mark() {
    let run = made_up::result(&[8.0], 1e-6);
    let view = &run.views[0];
    for svg in [spectra(&run, view), against_angle(&run, AngleMetric::Reflectance)] {
        assert!(!svg.contains("standard error") && !svg.contains("fill-opacity"));
    }
    assert!(spectra(&made_up::result(&[8.0], 0.05), view).len() < 1_000_000);
}

#[test]
fn a_name_is_text_whatever_it_holds() {
    let mut run = made_up::result(&[0.0, 8.0], 0.01);
    let hostile = "<b>&\"' ]]>\u{0}\u{1f}\n\u{ffff} \u{1f98b}";
    for view in &mut run.views {
        view.states.0[0].0 = hostile.to_owned();
    }
    for svg in all(&run) {
        texts(&svg);
    }
    says(&spectra(&run, &run.views[0]), &["<b>&\"' ]]>"]);
}

/// Replaces every number of a run's states.
fn with_values(run: &RunResult, change: fn(&mut StateValues)) -> RunResult {
    let mut run = run.clone();
    for state in run.views.iter_mut().flat_map(|view| view.states.0.iter_mut().map(|(_, state)| state)) {
        change(&mut state.value);
        change(&mut state.standard_error);
    }
    run
}

#[test]
fn missing_and_broken_numbers_are_left_out() {
    let run = made_up::result(&[0.0, 8.0], 0.01);
    let none =
        with_values(&run, |v| (v.x, v.y, v.u_prime, v.v_prime, v.peak_nm) = (None, None, None, None, None));
    let nan = with_values(&run, |v| {
        v.reflectance_factor.fill(f64::NAN);
        (v.X, v.Y, v.Z, v.L_star) = (f64::NAN, f64::INFINITY, f64::NAN, Some(f64::NAN));
        (v.u_prime, v.v_prime, v.peak_nm) = (Some(f64::NAN), Some(f64::INFINITY), Some(f64::NEG_INFINITY));
    });
    let zero = with_values(&run, |v| {
        v.reflectance_factor.fill(0.0);
        (v.X, v.Y, v.Z) = (0.0, 0.0, 0.0);
    });
    let noise = with_values(&run, |v| {
        v.reflectance_factor
            .iter_mut()
            .enumerate()
            .for_each(|(i, r)| *r = if i % 2 == 0 { -1e-4 } else { 1e-4 });
        (v.X, v.Y, v.Z, v.u_prime) = (-1e-5, -1e-5, 1e-5, Some(-4.0));
    });
    let huge = with_values(&run, |v| v.reflectance_factor.fill(1e300));
    let short = with_values(&run, |v| v.reflectance_factor.truncate(3));
    for run in [none, nan, zero, noise, huge, short] {
        for svg in all(&run) {
            texts(&svg);
        }
    }
}

#[test]
fn few_states_and_few_views_are_enough() {
    let full = made_up::result(&[8.0], 0.01);
    for keep in [&["red"][..], &["black"], &["red", "green"], &[]] {
        let mut run = full.clone();
        run.views[0].states = Named(
            full.views[0].states.0.iter().filter(|(n, _)| keep.contains(&n.as_str())).cloned().collect(),
        );
        run.views[0].contrast_ratio = None;
        run.views[0].gamut_percent_srgb = None;
        run.views[0].gamut_percent_ebu = None;
        for svg in all(&run) {
            texts(&svg);
        }
        says(&patches(&run, &run.views[0]), keep);
    }
    let mut many = full.clone();
    let states = &full.views[0].states.0;
    let renamed = (0..5)
        .flat_map(|k| states.iter().map(move |(n, s)| (format!("{n} {k} with a long name"), s.clone())));
    many.views[0].states = Named(renamed.collect());
    let mut nothing = full.clone();
    nothing.views.clear();
    let mut dark = full;
    (dark.illuminant.x, dark.illuminant.y, dark.wavelength_nm) = (f64::NAN, 0.0, vec![]);
    for run in [many, nothing, dark] {
        for svg in all(&run) {
            texts(&svg);
        }
    }
}

#[test]
fn a_pixel_scan_has_a_panel_for_each_state() {
    let states = ["red", "a & b", "blue", "dark"].map(str::to_owned);
    let (theta_deg, wavelength_nm) = ([0.0, 30.0, 60.0], [400.0, 550.0, 700.0]);
    let reflectance: Vec<f64> = (0..36).map(|i| f64::from(i) / 36.0).collect();
    let scan = PixelScan {
        states: &states,
        theta_deg: &theta_deg,
        wavelength_nm: &wavelength_nm,
        reflectance: &reflectance,
    };
    let svg = pixel_scan(&scan);
    says(
        &svg,
        &[
            "red",
            "a & b",
            "blue",
            "dark",
            "0\u{b0}",
            "30\u{b0}",
            "60\u{b0}",
            "Wavelength (nm)",
            "Reflectance",
        ],
    );
    // Three angles in four panels, besides axes and legend.
    assert_eq!(svg.matches(r#"stroke-width="1.8""#).count(), 12);
    for broken in [
        PixelScan { reflectance: &reflectance[..20], ..scan },
        PixelScan { reflectance: &[f64::NAN; 36], ..scan },
        PixelScan { states: &[], ..scan },
        PixelScan { theta_deg: &[], ..scan },
        PixelScan { wavelength_nm: &[], ..scan },
    ] {
        texts(&pixel_scan(&broken));
    }
}
