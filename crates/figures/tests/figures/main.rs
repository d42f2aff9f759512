//! Tests of the figures: for any data, a figure is well-formed and has its labels.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test says what it expects by unwrapping")]

use papilio_display::pixel::{PixelAbsorption, PixelLayer, SubPixelAbsorption};
use papilio_display::result::{Named, RunResult, StateValues};
use papilio_display::{AmbientLight, AmbientSource, ConeGrid, ConeResult, ConeState};
use papilio_figures::{
    AngleMetric, Diagram, FittedSpectrum, PixelScan, Transmission, absorption, against_angle, chromaticity,
    compared_gamuts, compared_metrics, compared_panels, compared_spectra, cone, cone_differences,
    fitted_spectra, gamut_rings, light, overview, patches, pixel_scan, png, spectra, spectra_over,
    transmission,
};

mod cones;
#[path = "../synthetic/mod.rs"]
mod synthetic;

const TITLE: &str = "Indoor & <bright>";

fn metric_of(run: &RunResult, metric: AngleMetric) -> String {
    against_angle(run, metric, TITLE).expect("a metric that is defined")
}

/// Returns all figures of a run.
fn all_figures(run: &RunResult) -> Vec<String> {
    let against_angle = AngleMetric::ALL.map(|metric| against_angle(run, metric, TITLE));
    let mut figures: Vec<String> = against_angle.into_iter().flatten().collect();
    for view in &run.views {
        figures.extend([
            spectra(run, view, TITLE),
            chromaticity(run, view, Diagram::Uv, TITLE),
            chromaticity(run, view, Diagram::Xy, TITLE),
            patches(run, view, TITLE),
            overview(run, view, TITLE),
        ]);
    }
    figures.push(spectra_over(&[("as it is", run), ("x < y & z", run)], TITLE));
    figures
}

/// Returns the texts of a figure, after a check that it is well-formed XML without NaN and infinity.
fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).expect("well-formed XML");
    assert_eq!(document.root_element().tag_name().name(), "svg");
    for node in document.descendants().filter(|node| node.is_element()) {
        for attribute in node.attributes() {
            let value = attribute.value().to_lowercase();
            assert!(!value.contains("nan") && !value.contains("inf"), "{}=\"{value}\"", attribute.name());
        }
    }
    assert!(!svg.contains("NaN") && !svg.contains(" inf"), "NaN or infinity in the figure");
    document
        .descendants()
        .filter(|n| n.has_tag_name("text"))
        .filter_map(|n| n.text())
        .map(str::to_owned)
        .collect()
}

fn assert_texts(svg: &str, wanted: &[&str]) {
    let texts = texts(svg);
    for wanted in wanted {
        assert!(texts.iter().any(|text| text.contains(wanted)), "{wanted} is not among {texts:?}");
    }
}

const STATES: [&str; 8] = ["white", "black", "red", "green", "blue", "cyan", "magenta", "yellow"];

#[test]
fn transmittance_spectra_are_in_percent() {
    let one = |share: f64| Transmission {
        name: "film <".to_owned(),
        wavelength_nm: vec![360.0, 420.0, 830.0],
        share: vec![0.0, share, share],
    };
    let svg = transmission(&[one(0.9), one(f64::NAN)], TITLE);
    assert_texts(&svg, &["Transmittance (%)", "Wavelength (nm)", "100", "film <", TITLE]);
    assert_texts(&transmission(&[], TITLE), &[TITLE]);
}

#[test]
fn every_figure_names_its_states_and_axes() {
    let run = synthetic::result(&[8.0, 0.0, 30.0], 0.05);
    let view = &run.views[0];
    for svg in [
        spectra(&run, view, TITLE),
        chromaticity(&run, view, Diagram::Uv, TITLE),
        chromaticity(&run, view, Diagram::Xy, TITLE),
        patches(&run, view, TITLE),
        overview(&run, view, TITLE),
    ] {
        assert_texts(&svg, &STATES);
    }
    assert_texts(
        &spectra(&run, view, TITLE),
        &["Wavelength (nm)", "Reflectance factor", "one standard error"],
    );
    assert_texts(
        &chromaticity(&run, view, Diagram::Uv, TITLE),
        &[
            "u\u{2032}",
            "v\u{2032}",
            "Gamut area in u\u{2032}v\u{2032}",
            "sRGB (display: ",
            "DCI-P3",
            "light",
            "520",
            "display",
        ],
    );
    assert_texts(
        &chromaticity(&run, view, Diagram::Xy, TITLE),
        &["x", "y", "Gamut area in xy", "NTSC", "light", "520", "display"],
    );
    assert_texts(&overview(&run, view, TITLE), &["Viewed at 8\u{b0}", "contrast", "gamut"]);
    for metric in AngleMetric::ALL {
        assert_texts(&metric_of(&run, metric), &["Viewing angle (deg)", "one standard error"]);
    }
    assert_texts(&metric_of(&run, AngleMetric::Reflectance), &STATES);
    assert_texts(&metric_of(&run, AngleMetric::Peak), &["red", "green", "blue", "Peak wavelength (nm)"]);
}

/// Errors are drawn only where they are visible.
#[test]
fn invisible_errors_are_not_drawn() {
    let run = synthetic::result(&[8.0], 1e-6);
    let view = &run.views[0];
    for svg in [spectra(&run, view, TITLE), metric_of(&run, AngleMetric::Reflectance)] {
        assert!(!svg.contains("standard error") && !svg.contains("fill-opacity"));
    }
    assert!(spectra(&synthetic::result(&[8.0], 0.05), view, TITLE).len() < 1_000_000);
}

#[test]
fn special_characters_in_names_are_escaped() {
    let mut run = synthetic::result(&[0.0, 8.0], 0.01);
    let hostile = "<b>&\"' ]]>\u{0}\u{1f}\n\u{ffff} \u{1f98b}";
    for view in &mut run.views {
        view.states.0[0].0 = hostile.to_owned();
    }
    for svg in all_figures(&run) {
        texts(&svg);
    }
    assert_texts(&spectra(&run, &run.views[0], TITLE), &["<b>&\"' ]]>"]);
}

/// Returns a run with changed values in all states.
fn with_values(run: &RunResult, change: fn(&mut StateValues)) -> RunResult {
    let mut run = run.clone();
    for state in run.views.iter_mut().flat_map(|view| view.states.0.iter_mut().map(|(_, state)| state)) {
        change(&mut state.value);
        change(&mut state.standard_error);
    }
    run
}

#[test]
fn missing_and_invalid_numbers_are_omitted() {
    let run = synthetic::result(&[0.0, 8.0], 0.01);
    let none =
        with_values(&run, |v| (v.x, v.y, v.u_prime, v.v_prime, v.peak_nm) = (None, None, None, None, None));
    let nan = with_values(&run, |v| {
        v.reflectance_factor.iter_mut().flatten().for_each(|r| *r = f64::NAN);
        (v.X, v.Y, v.Z, v.L_star) = (f64::NAN, f64::INFINITY, f64::NAN, Some(f64::NAN));
        (v.u_prime, v.v_prime, v.peak_nm) = (Some(f64::NAN), Some(f64::INFINITY), Some(f64::NEG_INFINITY));
    });
    let zero = with_values(&run, |v| {
        v.reflectance_factor.iter_mut().flatten().for_each(|r| *r = 0.0);
        (v.X, v.Y, v.Z) = (0.0, 0.0, 0.0);
    });
    let noise = with_values(&run, |v| {
        v.reflectance_factor
            .iter_mut()
            .flatten()
            .enumerate()
            .for_each(|(i, r)| *r = if i % 2 == 0 { -1e-4 } else { 1e-4 });
        (v.X, v.Y, v.Z, v.u_prime) = (-1e-5, -1e-5, 1e-5, Some(-4.0));
    });
    let huge = with_values(&run, |v| v.reflectance_factor.iter_mut().flatten().for_each(|r| *r = 1e300));
    let short = with_values(&run, |v| v.reflectance_factor.iter_mut().for_each(|all| all.truncate(3)));
    let self_lit = with_values(&run, |v| v.reflectance_factor = None);
    for run in [none, nan, zero, noise, huge, short, self_lit] {
        for svg in all_figures(&run) {
            texts(&svg);
        }
    }
}

#[test]
fn figures_need_no_minimum_of_states_and_views() {
    let full = synthetic::result(&[8.0], 0.01);
    for keep in [&["red"][..], &["black"], &["red", "green"], &[]] {
        let mut run = full.clone();
        run.views[0].states = Named(
            full.views[0].states.0.iter().filter(|(n, _)| keep.contains(&n.as_str())).cloned().collect(),
        );
        run.views[0].metrics.contrast_ratio = None;
        run.views[0].metrics.gamut_percent_srgb = None;
        run.views[0].metrics.gamut_percent_ebu = None;
        for svg in all_figures(&run) {
            texts(&svg);
        }
        assert_texts(&patches(&run, &run.views[0], TITLE), keep);
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
        for svg in all_figures(&run) {
            texts(&svg);
        }
    }
}

/// Each figure has the title, so that it can be understood without its context.
#[test]
fn every_figure_has_title() {
    let run = synthetic::result(&[8.0, 0.0], 0.01);
    for svg in all_figures(&run) {
        assert_texts(&svg, &[TITLE]);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let title = document.descendants().find(|node| node.has_tag_name("title")).expect("a title");
        assert!(title.text().unwrap().starts_with(TITLE));
    }
    assert_texts(&spectra(&run, &run.views[0], TITLE), &["viewed at 8\u{b0}"]);
    assert!(!against_angle(&run, AngleMetric::Contrast, "").unwrap().contains("<title>"));
}

#[test]
fn undefined_metric_gives_no_figure() {
    let mut run = synthetic::result(&[0.0, 30.0], 0.01);
    for view in &mut run.views {
        view.metrics.gamut_percent_srgb = None;
        view.metrics.gamut_percent_ebu = None;
    }
    assert_eq!(against_angle(&run, AngleMetric::Gamut, TITLE), None);
    assert!(against_angle(&run, AngleMetric::Contrast, TITLE).is_some());
    run.views.clear();
    assert!(AngleMetric::ALL.iter().all(|metric| against_angle(&run, *metric, TITLE).is_none()));
}

/// Returns the colours of the patches, in order.
fn fills(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let patches = document.descendants().filter(|node| node.attribute("rx") == Some("4"));
    patches.filter_map(|node| node.attribute("fill")).map(str::to_owned).collect()
}

/// The white of the screen represents Y = 100 %. At 430 %, all patches would be clipped to white.
#[test]
fn patches_brighter_than_page_are_dimmed_equally() {
    let run = synthetic::result(&[8.0], 0.001);
    let scaled = |factor: f64| {
        let mut run = run.clone();
        for (_, state) in &mut run.views[0].states.0 {
            for values in [&mut state.value, &mut state.standard_error] {
                (values.X, values.Y, values.Z) = (factor * values.X, factor * values.Y, factor * values.Z);
            }
        }
        patches(&run, &run.views[0], TITLE)
    };
    let plain = scaled(1.0);
    assert!(!plain.contains("shown at"));
    let white = 100.0 * run.views[0].states.get("white").unwrap().value.Y;
    assert_texts(&plain, &["perfect white in the same light", &format!("Y {white:.1} %")]);
    let (bright, brighter) = (scaled(40.0), scaled(80.0));
    assert_texts(&bright, &["shown at 1/", &format!("Y {:.0} %", 40.0 * white), "\u{b1} 1 %"]);
    assert_eq!(fills(&bright), fills(&brighter), "both are dimmed to the same colours");
    let mut distinct = fills(&bright);
    distinct.sort();
    distinct.dedup();
    assert_eq!(distinct.len(), STATES.len(), "no two states are clipped to one colour: {distinct:?}");
}

/// Values of 4 % and of 430 % are both legible.
#[test]
fn wide_range_of_y_has_logarithmic_axis() {
    let mut run = synthetic::result(&[0.0, 20.0, 40.0], 0.001);
    assert!(!metric_of(&run, AngleMetric::Reflectance).contains("logarithmic"));
    for (_, state) in &mut run.views[1].states.0 {
        state.value.Y *= 30.0;
    }
    assert_texts(&metric_of(&run, AngleMetric::Reflectance), &["0.05", "0.1"]);
    assert!(!metric_of(&run, AngleMetric::Reflectance).contains("logarithmic"), "the labels show it");
}

/// No line connects the peaks of two orders of interference.
#[test]
fn jump_of_peak_interrupts_curve() {
    let mut run = synthetic::result(&[0.0, 10.0, 20.0, 30.0, 40.0], 0.0);
    for view in &mut run.views {
        view.states.0.retain(|(name, _)| name == "red");
    }
    for (view, nm) in run.views.iter_mut().zip([650.0, 640.0, 600.0, 430.0, 420.0]) {
        view.states.0[0].1.value.peak_nm = Some(nm);
    }
    let svg = metric_of(&run, AngleMetric::Peak);
    let points: Vec<usize> = svg
        .lines()
        .filter(|line| line.contains(r##"stroke="#c8321f" stroke-width="2""##))
        .map(|line| line.split("points=\"").nth(1).unwrap().split('"').next().unwrap().split(' ').count())
        .collect();
    assert_eq!(points, [3, 2]);
    assert_texts(&svg, &["red"]);
}

/// Grey states coincide with each other and with the light.
#[test]
fn crowded_states_have_enlarged_inset() {
    let run = synthetic::result(&[8.0], 0.001);
    let light = (run.illuminant.u_prime, run.illuminant.v_prime);
    let mut grey = run.clone();
    for (i, (_, state)) in grey.views[0].states.0.iter_mut().enumerate() {
        let off = 0.004 * i as f64;
        (state.value.u_prime, state.value.v_prime) = (Some(light.0 + off), Some(light.1));
    }
    let discs = |run: &RunResult| {
        let svg = chromaticity(run, &run.views[0], Diagram::Uv, TITLE);
        assert_texts(&svg, &STATES);
        assert_texts(&svg, &["light"]);
        svg.matches("<circle").count()
    };
    assert_eq!(discs(&grey), 2 * discs(&run));
}

#[test]
fn pixel_scan_has_panel_for_each_state() {
    let states = ["red", "a & b", "blue", "dark"].map(str::to_owned);
    let (theta_deg, wavelength_nm) = ([0.0, 30.0, 60.0], [400.0, 550.0, 700.0]);
    let reflectance: Vec<f64> = (0..36).map(|i| f64::from(i) / 36.0).collect();
    let scan = PixelScan {
        medium: "glass",
        states: &states,
        theta_deg: &theta_deg,
        wavelength_nm: &wavelength_nm,
        reflectance: &reflectance,
    };
    let svg = pixel_scan(&scan, TITLE);
    assert_texts(
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
            "Angle in glass",
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
        texts(&pixel_scan(&broken, TITLE));
    }
}

/// The error names the feature.
#[cfg(not(feature = "png"))]
#[test]
fn png_without_feature_is_refused() {
    let error = png("<svg/>", 1.0).unwrap_err().to_string();
    assert!(error.contains("feature `png`"), "{error}");
}

/// Returns width and height of a PNG (ISO/IEC 15948, 11.2.2).
#[cfg(feature = "png")]
fn pixels(png: &[u8]) -> (u32, u32) {
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

#[cfg(feature = "png")]
#[test]
fn png_of_figure_has_its_size_and_text() {
    let run = synthetic::result(&[8.0], 0.01);
    let svg = patches(&run, &run.views[0], TITLE);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let [width, height] = ["width", "height"]
        .map(|name| document.root_element().attribute(name).unwrap().parse::<f64>().unwrap().ceil() as u32);
    let picture = png(&svg, 1.0).unwrap();
    assert!(picture.warnings.is_empty(), "{:?}", picture.warnings);
    assert_eq!(pixels(&picture.value), (width, height));
    assert_eq!(picture, png(&svg, 1.0).unwrap(), "the same pixels each time");
    let doubled = pixels(&png(&svg, 2.0).unwrap().value);
    assert!(doubled.0.abs_diff(2 * width) <= 2 && doubled.1.abs_diff(2 * height) <= 2);
    // Without its texts the image differs: letters are drawn, whatever fonts the machine has.
    let silent: String = svg.lines().filter(|line| !line.starts_with("<text")).collect();
    assert_ne!(png(&silent, 1.0).unwrap().value, picture.value);
    assert!(pixels(&png(&svg, 1e6).unwrap().value).0 <= 16_384);
    // A state whose name is not in Roboto: the image is that without the letters, and the warning names them.
    let named = svg.replacen(">white<", ">\u{767d}white\u{8272}<", 1);
    assert_ne!(named, svg);
    let named = png(&named, 1.0).unwrap();
    assert_eq!(named.value, picture.value);
    assert_eq!(named.warnings.len(), 1);
    assert!(named.warnings[0].contains(": \u{767d} \u{8272};"), "{:?}", named.warnings);
    assert!(png("no figure", 1.0).is_err());
}

/// Gamut rings of the synthetic display exist only if its volume was requested.
#[test]
fn gamut_rings_need_requested_volume() {
    let mut run = synthetic::result(&[8.0], 0.01);
    assert_eq!(gamut_rings(&run, &run.views[0], TITLE), None);
    run.views[0].metrics.gamut_volume_cielab = Some(51_234.0);
    let svg = gamut_rings(&run, &run.views[0], TITLE);
    assert_texts(&svg.unwrap(), &[TITLE, "L* 10", " to 100", "volume 51234"]);
    // Without one of the eight corners there is no volume.
    run.views[0].states.0.retain(|(name, _)| name != "cyan");
    assert_eq!(gamut_rings(&run, &run.views[0], TITLE), None);
}

/// Comparisons with and without spectra, and with undefined values.
#[test]
fn comparison_shows_simulated_and_measured() {
    use papilio_display::compare::{
        Colour, Comparison, MetricComparison, SpectrumComparison, StateComparison, ViewComparison,
    };
    let colour = |uv: Option<f64>| Colour {
        X: 0.2,
        Y: 0.2,
        Z: 0.2,
        u_prime: uv,
        v_prime: uv.map(|u| 2.0 * u),
        L_star: None,
        a_star: None,
        b_star: None,
        contrast: None,
        peak_nm: None,
    };
    let state = |name: &str, spectrum: Option<SpectrumComparison>| StateComparison {
        state: name.to_owned(),
        theta_deg: 8.0,
        phi_deg: 0.0,
        simulated: colour(Some(0.2)),
        measured: colour((name != "odd <name>").then_some(0.21)),
        delta_E_2000: None,
        distance_uv: None,
        difference_Y: f64::NAN,
        spectrum,
        z: Vec::new(),
        agreement: None,
    };
    let spectrum = SpectrumComparison {
        wavelength_nm: vec![400.0, 550.0, 700.0],
        simulated: vec![0.1, f64::NAN, 0.2],
        measured: vec![0.1, 0.15, 0.25],
        mean_difference: 0.0,
        rms_difference: 0.0,
        largest_difference: 0.0,
        largest_at_nm: 400.0,
        measured_deviation: vec![0.01, f64::NAN, 0.02],
        simulated_deviation: vec![0.0, 0.01, 0.01],
    };
    let view = ViewComparison {
        theta_deg: 8.0,
        phi_deg: 0.0,
        contrast_ratio: [None, None],
        gamut_percent_srgb: [Some(20.0), None],
        gamut_percent_ebu: [Some(20.0), None],
        coverage_percent_srgb: [None, None],
        average_peak_difference_nm: None,
        rms_peak_difference_nm: None,
    };
    let states = ["white", "red", "green", "blue", "odd <name>"];
    let mut all = Comparison {
        states: states.map(|name| state(name, Some(spectrum.clone()))).to_vec(),
        views: vec![view.clone()],
        metrics: vec![],
        agreement: None,
        left_out: vec![],
    };
    assert_texts(
        &compared_spectra(&all, &view, TITLE).unwrap(),
        &[TITLE, "simulated", "measured", "odd <name>"],
    );
    assert_texts(
        &compared_panels(&all, &view, TITLE).unwrap(),
        &[TITLE, "simulated", "measured", "odd <name>"],
    );
    assert_texts(&compared_gamuts(&all, &view, TITLE), &[TITLE, "measured", "20.0 % of EBU simulated, "]);
    let metric = |metric: &str, simulated: f64, measured_deviation| MetricComparison {
        metric: metric.to_owned(),
        theta_deg: 0.0,
        phi_deg: 0.0,
        simulated,
        measured: 2.0,
        simulated_deviation: 0.1,
        measured_deviation,
        z: None,
    };
    let metrics = [
        metric("odd <name>.gloss_60", 1.0, Some(0.5)),
        metric("white.gloss_60", f64::NAN, None),
        metric("white.Y", 0.5, None),
        metric("contrast_ratio", 20.0, Some(f64::INFINITY)),
    ];
    assert_texts(
        &compared_metrics(&metrics, TITLE).unwrap(),
        &[TITLE, "odd <name>", "Gloss at 60", "Contrast ratio", "two standard deviations"],
    );
    assert_eq!(compared_metrics(&[], TITLE), None);
    all.states.iter_mut().for_each(|one| one.spectrum = None);
    assert_eq!(compared_spectra(&all, &view, TITLE), None);
    assert_eq!(compared_panels(&all, &view, TITLE), None);
}

#[test]
fn figure_of_light_lists_sources_and_directions() {
    let lamp = AmbientSource { theta_deg: -30.0, phi_deg: 10.0, radius_deg: 0.0, illuminance_lx: 120.0 };
    let room = |value: f64, lamps: usize| AmbientLight {
        theta_deg: (0..=9).map(|k| 10.0 * f64::from(k)).collect(),
        phi_deg: (0..36).map(|k| 10.0 * f64::from(k)).collect(),
        luminance_cd_m2: (0..360).map(|k| if k % 7 == 0 { value } else { 1.0 }).collect(),
        diffuse_lx: 250.0,
        environment_lx: vec![33.3],
        directed: vec![lamp; lamps],
        views_deg: vec![[8.0, 0.0]],
    };
    assert_texts(
        &light(&room(400.0, 1), TITLE),
        &[
            "Light from each direction",
            "250 lx",
            "33.3 lx",
            "directed, -30\u{b0}, azimuth 10\u{b0}",
            "403 lx",
            "mirror direction of a view",
        ],
    );
    assert_texts(&light(&room(2.0, 20), TITLE), &["15 more"]);
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
        texts(&light(&room(value, 2), TITLE));
    }
    let dark = AmbientLight { luminance_cd_m2: vec![0.0; 360], ..room(1.0, 1) };
    assert_texts(&light(&dark, TITLE), &["Directed sources only"]);
    let none = AmbientLight { theta_deg: vec![], phi_deg: vec![], luminance_cd_m2: vec![], ..dark };
    texts(&light(&none, TITLE));
}

/// Stacked absorptances of two sub-pixels, of which one is driven in the same way in two states and drawn
/// once.
#[test]
fn absorptances_are_stacked_by_layer() {
    let layer = |number, material: &str| PixelLayer { number, material: material.to_owned() };
    let part = |state: &str, sub_pixel: &str, absorbed: f64| SubPixelAbsorption {
        state: state.to_owned(),
        sub_pixel: sub_pixel.to_owned(),
        area: 0.5,
        reflectance: vec![1.0 - absorbed - 0.1; 4],
        absorptance: [vec![absorbed; 4], vec![0.0; 4], vec![0.1; 4]].concat(),
    };
    let mut all = PixelAbsorption {
        theta_deg: vec![0.0, 30.0],
        wavelength_nm: vec![400.0, 700.0],
        layers: vec![layer(Some(0), "Cr & <b>"), layer(Some(1), "clear"), layer(None, "Al")],
        sub_pixels: vec![part("white", "red", 0.3), part("white", "blue", 0.6), part("red", "red", 0.3)],
    };
    let svg = absorption(&all, "air", TITLE);
    assert_texts(
        &svg,
        &[TITLE, "at 0\u{b0} in air", "0: Cr & <b>", "substrate: Al", "Absorptance", "1 - reflectance"],
    );
    assert_texts(&svg, &["red sub-pixel, state white", "blue sub-pixel, state white"]);
    assert!(!texts(&svg).iter().any(|text| text.contains("clear") || text.contains("state red")));
    all.sub_pixels[0].absorptance = vec![f64::NAN];
    texts(&absorption(&all, "air", TITLE));
    (all.sub_pixels, all.layers, all.theta_deg) = (vec![], vec![], vec![]);
    texts(&absorption(&all, "air", TITLE));
}

/// Bands of measured values near 0 end at the axis, and the axis contains the bands of the largest ones.
#[test]
fn bands_of_a_fit_are_within_its_axes() {
    let spectrum = FittedSpectrum {
        name: "white".to_owned(),
        wavelength_nm: vec![500.0, 550.0, 600.0],
        measured: vec![0.001, 0.5, 0.99],
        deviation: vec![0.02, 0.02, 0.2],
        predicted: vec![0.002, 0.5, 0.95],
    };
    let svg = fitted_spectra(&[spectrum], "A fit");
    let points = svg.split("<polygon").nth(1).unwrap().split("points=\"").nth(1).unwrap().split('"').next();
    let y = points.unwrap().split(' ').map(|point| point.split(',').nth(1).unwrap().parse::<f64>().unwrap());
    let y: Vec<f64> = y.collect();
    // The panel is from 44 to 394 px: three points of the upper edge, then three of the lower one.
    assert_eq!(y.len(), 6, "{y:?}");
    assert!(y.iter().all(|y| (44.0..=394.0).contains(y)), "{y:?}");
    assert_eq!(y[5], 394.0, "{y:?}");
}
