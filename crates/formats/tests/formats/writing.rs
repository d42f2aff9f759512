//! Writers of results.

use papilio_display::result::{
    Absorbed, Illuminant, Ledger, LedgerError, Named, Reader, ReferenceWhite, RunResult, SolverReport, State,
    StateMetrics, StateValues, Terms, View, ViewMetrics,
};
use papilio_formats::{ResultFile, write_json, write_spectra, write_states};

fn values(start: f64) -> StateValues {
    StateValues {
        radiance: vec![start, start / 3.0],
        reflectance_factor: Some(vec![start / 7.0, f64::NAN]),
        X: start,
        Y: start + 1.0,
        Z: start + 2.0,
        x: Some(0.3),
        y: Some(0.4),
        z: Some(0.3),
        u_prime: Some(0.2),
        v_prime: Some(0.5),
        L_star: Some(50.0),
        a_star: Some(-1.0),
        b_star: None,
        luminance_cd_m2: 100.0 * start,
        contrast: None,
        peak_nm: None,
        distance_from_white_uv: Some(0.0),
        distance_from_d65_uv: Some(0.01),
        hue_rgb: Some([10.0, 20.0, 30.0]),
        metrics: StateMetrics { u_star: Some(start), ..StateMetrics::default() },
        cam16: None,
        by_light: None,
        R_hemi: None,
        R_dir: vec![None, Some(start)],
        R_environment: vec![],
        terms: Terms {
            diffuse: start,
            directed: vec![1.0, start],
            environment: vec![],
            front_light: None,
            front_reflection: 0.0,
        },
        specular: vec![0.04, 0.0],
    }
}

fn result() -> RunResult {
    let absorbed = || Absorbed { front: 0.1, diffuser: 0.2, glass: 0.0, pixel: 0.3, inactive: 0.1 };
    let standard_error = LedgerError { returned: 0.01, absorbed: absorbed(), unaccounted: 0.0 };
    let ledger = Ledger {
        returned: 0.3,
        absorbed: absorbed(),
        unaccounted: 0.0,
        standard_error,
        discretisation_error: None,
    };
    let state = |start| State {
        value: values(start),
        standard_error: values(0.001),
        discretisation_error: None,
        interpolation_error: None,
    };
    let view = View {
        theta_deg: -8.5,
        phi_deg: 0.0,
        states: Named(vec![
            ("white, bright".to_owned(), state(0.1 + 0.2)),
            ("black".to_owned(), state(0.01)),
        ]),
        metrics: ViewMetrics { contrast_ratio: Some(1.0 / 3.0), ..ViewMetrics::default() },
        visibility_level_in_range: None,
        contrast_margin_in_range: None,
        standard_error: ViewMetrics { contrast_ratio: Some(0.1), ..ViewMetrics::default() },
        discretisation_error: None,
        ledger: Named(vec![("white, bright".to_owned(), ledger.clone()), ("black".to_owned(), ledger)]),
    };
    RunResult {
        solver: SolverReport {
            chosen_because: None,
            method: "monte-carlo".to_owned(),
            paths: Some(1024),
            nodes: None,
            level: None,
            degrees_of_freedom: 15,
            target: None,
            relative_error_reached: 1e-3,
            is_final: true,
            interrupted: false,
        },
        wavelength_nm: vec![400.0, 400.0 + 1.0 / 3.0],
        illuminant: Illuminant {
            radiance_of_white: vec![1.0, 2.0],
            x: 0.3,
            y: 0.3,
            u_prime: 0.2,
            v_prime: 0.4,
        },
        views: vec![view],
        reader: Reader {
            age_years: 25.0,
            text_height_mm: 1.6,
            distance_mm: 500.0,
            detail_arcmin: 2.2,
            cycles_per_degree: 13.6,
            is_described: false,
        },
        reference_white: ReferenceWhite::Perfect,
        primaries: vec![],
        notes: vec![],
        warnings: vec!["a \"remark\"".to_owned()],
    }
}

fn table(text: &[u8]) -> (Vec<String>, Vec<Vec<String>>) {
    let mut reader = csv::Reader::from_reader(text);
    let header = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let rows = reader.records().map(|row| row.unwrap().iter().map(str::to_owned).collect());
    (header, rows.collect())
}

#[test]
fn states_csv_has_a_row_for_each_state_and_reads_back_bit_for_bit() {
    let mut text = Vec::new();
    write_states(&mut text, &result()).unwrap();
    let (header, rows) = table(&text);
    let cell = |row: usize, title: &str| rows[row][header.iter().position(|t| t == title).unwrap()].as_str();
    assert_eq!(rows.len(), 2);
    assert_eq!((cell(0, "theta_deg"), cell(0, "state")), ("-8.5", "white, bright"));
    assert_eq!(cell(0, "X").parse::<f64>().unwrap(), 0.1 + 0.2);
    assert_eq!((cell(1, "Y"), cell(1, "Y_se")), ("1.01", "1.001"));
    assert_eq!((cell(0, "peak_nm"), cell(0, "peak_nm_se"), cell(0, "b_star")), ("", "", ""));
    assert_eq!(cell(1, "contrast_ratio").parse::<f64>().unwrap(), 1.0 / 3.0);
    assert_eq!(
        (cell(0, "Y_directed_1"), cell(0, "specular_0"), cell(0, "ledger_pixel")),
        ("0.30000000000000004", "0.04", "0.3")
    );
    // Every metric is followed by its standard error.
    for title in header[3..].iter().filter(|title| !title.ends_with("_se")) {
        assert!(header.contains(&format!("{title}_se")), "{title}");
    }
}

#[test]
fn spectra_csv_has_a_row_for_each_wavelength_of_each_state() {
    let mut text = Vec::new();
    write_spectra(&mut text, &result()).unwrap();
    let (header, rows) = table(&text);
    assert_eq!(header[3..5], ["wavelength_nm", "radiance"]);
    assert_eq!(rows.len(), 4);
    assert_eq!(rows[1][3].parse::<f64>().unwrap(), 400.0 + 1.0 / 3.0);
    assert_eq!((rows[1][2].as_str(), rows[1][6].as_str()), ("white, bright", ""));
}

/// Discretisation errors, if there are any, have separate columns.
#[test]
fn result_with_discretisation_errors_has_columns_for_them() {
    let mut result = result();
    let view = &mut result.views[0];
    view.discretisation_error = Some(ViewMetrics { contrast_ratio: Some(0.25), ..view.standard_error });
    view.states.0.iter_mut().for_each(|(_, state)| state.discretisation_error = Some(values(0.002)));
    for (_, ledger) in &mut view.ledger.0 {
        ledger.discretisation_error = Some(LedgerError { returned: 0.125, ..ledger.standard_error.clone() });
    }
    let (mut states, mut spectra) = (Vec::new(), Vec::new());
    write_states(&mut states, &result).unwrap();
    write_spectra(&mut spectra, &result).unwrap();
    let (header, rows) = table(&states);
    let cell = |title: &str| rows[1][header.iter().position(|t| t == title).unwrap()].as_str();
    assert_eq!((cell("Y"), cell("Y_se"), cell("Y_de")), ("1.01", "1.001", "1.002"));
    assert_eq!((cell("contrast_ratio_de"), cell("ledger_returned_de")), ("0.25", "0.125"));
    assert_eq!((cell("peak_nm_de"), cell("gamut_percent_ebu_de")), ("", ""));
    let (header, rows) = table(&spectra);
    assert_eq!(header[4..7], ["radiance", "radiance_se", "radiance_de"]);
    assert_eq!((header.len(), rows[0].len()), (10, 10));
}

/// The file holds the scenario, its hash and seed, and the result; equal results give equal bytes.
#[test]
fn result_file_holds_the_scenario_and_its_result() {
    let scenario = serde_json::json!({"title": "Test"});
    let result = result();
    let notes = ["haze 0.78 means a lobe".to_owned()];
    let (hash, seed) = ("abc", u64::MAX);
    let file =
        ResultFile { papilio: "0.1.0", scenario: &scenario, hash, seed, notes: &notes, result: &result };
    let (mut once, mut twice) = (Vec::new(), Vec::new());
    write_json(&mut once, &file).unwrap();
    write_json(&mut twice, &file).unwrap();
    assert_eq!(once, twice);
    let json: serde_json::Value = serde_json::from_slice(&once).unwrap();
    assert_eq!(
        (&json["papilio"], &json["hash"], &json["seed"]),
        (&"0.1.0".into(), &"abc".into(), &u64::MAX.into())
    );
    assert_eq!(json["notes"][0], notes[0].as_str());
    let white = &json["views"][0]["states"]["white, bright"];
    assert_eq!(white["X"].as_f64(), Some(0.1 + 0.2));
    assert_eq!((&white["standard_error"]["Y"], &white["peak_nm"]), (&1.001.into(), &serde_json::Value::Null));
    assert_eq!(white["reflectance_factor"][1], serde_json::Value::Null);
    assert_eq!(json["views"][0]["ledger"]["black"]["absorbed"]["diffuser"], 0.2);
}
