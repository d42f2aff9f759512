//! Sharpness: known modulation transfers and patterns, laws, and what is refused.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use papilio_display::spatial::{LineContrast, MtfResult, MtfState, mtf, sparkle};
use papilio_display::{Control, DisplayError, Progress, ProgressFraction};
use papilio_scenario::{Resolved, Scenario};
use papilio_testing::everyday;

use crate::common;

const LOBE: &str = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.05667\ntransmittance = 1.0\n";
const MIRROR: &str =
    "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.9, black = 0.0 }\n";
const MATRIX: &str = "[display.matrix]\nppi = 300\n";
const DIFFUSE: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 1.0\n";

fn paper(white: f64, black: f64) -> String {
    format!(
        "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = {{ white = {white}, black = {black} }}\n"
    )
}

fn glass(surface: &str, thickness_mm: f64) -> String {
    format!("[display.glass]\nindex = 1.5\nsurface = \"{surface}\"\nthickness_mm = {thickness_mm}\n")
}

fn resolved(parts: &[&str]) -> Resolved {
    let text = format!("[spectrum]\nstep_nm = 20\n{}", parts.concat());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    Scenario::from_text(&text, "mtf.toml", &folder, &[]).unwrap().resolve().unwrap()
}

fn computed(parts: &[&str]) -> Result<MtfResult, DisplayError> {
    let resolved = resolved(&[&parts.concat(), "[solver]\nrelative_error = 1e-4\n"]);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    mtf(&resolved.scene, &resolved.patterns, &control)
}

fn white(result: &MtfResult) -> &MtfState {
    result.views[0].states.get("white").unwrap()
}

/// Modulation transfer along x and y at a frequency of the list.
fn at(result: &MtfResult, state: &MtfState, frequency: f64) -> [f64; 2] {
    let near = |f: &f64| (f - frequency).abs() < 1e-9 * frequency;
    let k = result.frequency_per_mm.iter().position(near).unwrap();
    [&state.otf.otf_x, &state.otf.otf_y].map(|otf| otf[k][0].hypot(otf[k][1]))
}

fn near(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{what}: {found} against {expected}");
}

/// H78 over 0.5 mm along the normal: an independent radial integral (numpy, 40-point panels).
#[test]
fn lobe_has_known_modulation_transfer() {
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    let result = computed(&[LOBE, &glass("coated", 0.5), MATRIX, MIRROR, DIFFUSE, view]).unwrap();
    let state = white(&result);
    for (f, expected) in [(1.0, 0.939_069), (2.0, 0.834_399), (5.0, 0.586_457), (10.0, 0.324_349)] {
        for found in at(&result, state, f) {
            near("MTF", found, expected, 2e-5);
        }
    }
    near("Nyquist", state.scalars.mtf_nyquist_x.unwrap(), 0.526_884, 2e-5);
    near("the same", state.scalars.mtf_nyquist_y.unwrap(), 0.526_884, 2e-5);
    // Where the curve is 0.5: between 5.9055 (0.5269) and 10.
    let f50 = state.scalars.f50_x_per_mm.unwrap();
    assert!((6.3..6.4).contains(&f50), "{f50}");
    near("kernel", state.kernel.outside + state.kernel.fractions.iter().sum::<f64>(), 1.0, 1e-9);
    assert!(result.error_reached < 1e-4, "{}", result.error_reached);
    // An edge is symmetric, and the widths along x and y agree.
    let edge = state.scalars;
    near("edges", edge.edge_10_90_x_um.unwrap(), edge.edge_10_90_y_um.unwrap(), 1e-2);
    // Without light black has no transfer.
    let black = result.views[0].states.get("black").unwrap();
    assert_eq!((black.scalars.f50_x_per_mm, black.scalars.r50_um), (None, None));
}

/// A narrow lobe has the closed forms of small angles, but for the light beyond the hemisphere, a fraction of
/// about its width: exp(-2 pi f c), a Cauchy line, half of the light within sqrt(3) c.
#[test]
fn narrow_lobe_has_closed_forms() {
    let b = 0.02;
    let lobe = LOBE.replace("0.05667", "0.02");
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    let result = computed(&[&lobe, &glass("coated", 0.5), MATRIX, MIRROR, DIFFUSE, view]).unwrap();
    let state = white(&result);
    let c = b * 0.5 / 1.5;
    for f in [1.0, 2.0, 5.0] {
        let expected = (-2.0 * std::f64::consts::PI * f * c).exp();
        near("MTF", at(&result, state, f)[0], expected, 1.2 * b);
    }
    let scalars = state.scalars;
    let f50 = 2.0_f64.ln() / (2.0 * std::f64::consts::PI * c);
    near("f50", scalars.f50_x_per_mm.unwrap() / f50, 1.0, 2.0 * b);
    near("r50", scalars.r50_um.unwrap() / (3.0_f64.sqrt() * c * 1e3), 1.0, 2.0 * b);
    near("edge", scalars.edge_10_90_x_um.unwrap() / (2.0 * 3.077_683_5 * c * 1e3), 1.0, 8.0 * b);
    // The middle of a dark line of a pixel has the light of an edge on both sides.
    let line = 2.0 / std::f64::consts::PI * (25.4 / 300.0 / (2.0 * c)).atan();
    near("line", result.views[0].line_contrast.black_1_x.unwrap(), line / (2.0 - line), 2.0 * b);
}

/// Radii, widths of edges and the frequency of half the modulation are read between places and frequencies: the closed forms of a narrow
/// lobe, of which a part is not scattered, are within the errors (and light beyond the hemisphere, a fraction of its width).
#[test]
fn numbers_between_places_of_tables_are_within_their_errors() {
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    for (b, regular) in [(1e-4, 0.0), (1e-3, 0.0), (1e-3, 0.2), (1e-3, 0.6)] {
        let lobe = LOBE.replace("0.05667", &format!("{b}\nregular_fraction = {regular}"));
        let result = computed(&[&lobe, &glass("coated", 0.5), MATRIX, MIRROR, DIFFUSE, view]).unwrap();
        let (value, error) = (white(&result).scalars, white(&result).error);
        let c_um = 1e3 * b * 0.5 / 1.5;
        // Shares of the light that is scattered.
        let of_edge = 0.1 / (1.0 - regular);
        let edge = 2.0 * c_um * (std::f64::consts::PI * (0.5 - of_edge)).tan();
        let radius = |share: f64| {
            let left = (1.0 - share) / (1.0 - regular);
            if left > 1.0 { 0.0 } else { c_um * (left.powi(-2) - 1.0).sqrt() }
        };
        let pairs = [
            ("edge along x", value.edge_10_90_x_um, error.edge_10_90_x_um, edge),
            ("edge along y", value.edge_10_90_y_um, error.edge_10_90_y_um, edge),
            ("r50", value.r50_um, error.r50_um, radius(0.5)),
            ("r90", value.r90_um, error.r90_um, radius(0.9)),
        ];
        for (what, value, error, expected) in pairs {
            let (value, error) = (value.unwrap(), error.unwrap());
            near(&format!("{what} of {b}"), value, expected, error + 5.0 * b * expected + 1e-12);
            assert!(error <= 0.03 * expected, "{what}: {value} +- {error}");
        }
    }
}

/// Dark paper below a front that reflects nearly all: steep views see the pixels again and again, each time twice the way through the
/// air farther away. The second image beside them completes 90 % of the light.
#[test]
fn radius_of_a_sharp_image_is_its_distance() {
    let front = "[[display.front]]\nreflectance = 0.9\ngap_mm = 0.05\n";
    let view = "[viewer]\ntheta_deg = 80\nfield_deg = 0\n";
    let result =
        computed(&[front, &glass("fresnel", 0.5), MATRIX, &paper(1e-4, 0.0), DIFFUSE, view]).unwrap();
    let (value, error) = (white(&result).scalars, white(&result).error);
    assert_eq!(value.r50_um, Some(0.0));
    let expected = 2.0 * 2.0 * 50.0 * 80.0_f64.to_radians().tan();
    near("r90", value.r90_um.unwrap(), expected, 2e-3);
    assert!(error.r90_um.unwrap() < 1e-3 * expected, "{error:?}");
}

/// A lobe much narrower than a pixel: sharp, and no frequency of half the modulation.
#[test]
fn lobe_much_narrower_than_a_pixel_is_sharp() {
    let lobe = LOBE.replace("0.05667", "0.0002");
    // A field of view of 0.1 deg would blur more than this lobe.
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    let result = computed(&[&lobe, &glass("coated", 0.5), MATRIX, MIRROR, DIFFUSE, view]).unwrap();
    let scalars = white(&result).scalars;
    near("Nyquist", scalars.mtf_nyquist_x.unwrap(), 1.0, 4e-3);
    assert_eq!(scalars.f50_x_per_mm, None);
    assert!(scalars.r50_um.unwrap() < 0.2);
}

/// Coloured paper: fine details change only the light of their own place, and whole pages all of it, so that the
/// ratio of both responses is what is left of the modulation. The page's is a difference of two runs. (With the weights of
/// Y it would be 0.510 instead of 0.480.)
#[test]
fn wavelengths_of_coloured_paper_count_by_their_response() {
    let folder = tempfile::tempdir().unwrap();
    let page = |scale: f64| {
        let file = folder.path().join(format!("{scale}.csv"));
        let rows = [(380.0, 0.05), (560.0, 0.05), (600.0, 0.95), (780.0, 0.95)];
        let rows = rows.map(|(nm, value)| format!("{nm},{}\n", scale * value));
        std::fs::write(&file, rows.concat()).unwrap();
        let pixel = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"";
        format!("{pixel}\nreflectance = {{ white = '{}', black = 0.5 }}\n", file.display())
    };
    let y = |scale: f64| {
        let scene = resolved(&[&glass("fresnel", 20.0), &page(scale), DIFFUSE]).scene;
        common::run(&scene).unwrap().views[0].states.get("white").unwrap().value.Y
    };
    let [dark, bare, plain, bright] = [0.0, 0.999, 1.0, 1.001].map(y);
    let expected = (plain - dark) / ((bright - bare) / 0.002);
    let result = computed(&[&glass("fresnel", 20.0), MATRIX, &page(1.0), DIFFUSE]).unwrap();
    near("details", white(&result).scalars.mtf_nyquist_x.unwrap(), expected, 1e-4);
    let black = result.views[0].states.get("black").unwrap();
    near("grey", black.scalars.mtf_nyquist_x.unwrap(), 1.0 - 0.5 * 0.596_345_759_7, 1e-4);
}

/// Halation under 0.7 mm of glass: the return P(f) by mpmath, from the transfer of a state of 0.45.
#[test]
fn halation_has_known_return() {
    let result = computed(&[&glass("fresnel", 0.7), MATRIX, &paper(0.45, 0.03), DIFFUSE]).unwrap();
    let state = white(&result);
    let zero = 0.596_345_759_7;
    for (f, expected) in [
        (0.05, 0.458_053_10),
        (0.1, 0.273_358_73),
        (0.25, -0.036_948_01),
        (0.5, -0.022_824_85),
        (1.0, -0.004_842_36),
        (3.0, 0.000_773_07),
    ] {
        let found = at(&result, state, f)[0];
        near("return", (1.0 - (1.0 - 0.45 * zero) / found) / 0.45, expected, 1e-6);
    }
    // All fine details have 0.7316 of a page; a line of white keeps nearly that of its own page.
    near("limit", state.scalars.mtf_nyquist_x.unwrap(), 0.7316, 1e-3);
    assert_eq!(state.scalars.r50_um, Some(0.0));
    // Within a radius: the sharp image, and the return to all orders.
    assert!((2000.0..6000.0).contains(&state.scalars.r90_um.unwrap()), "{:?}", state.scalars.r90_um);
}

/// Stripes of 0.6 and 0.03 under glass of 1 mm: a dense Fourier solution of a separate program.
#[test]
fn stripes_have_known_means() {
    let pattern = "[pattern]\nkind = [\"stripes\"]\nperiod_mm = [0.1, 1, 2, 3, 5, 10, 20, 50]\n";
    let view = "[viewer]\ntheta_deg = 0\n";
    let result = computed(&[&glass("fresnel", 1.0), &paper(0.6, 0.03), DIFFUSE, view, pattern]).unwrap();
    let known = [0.150_30, 0.150_47, 0.151_27, 0.149_10, 0.148_12, 0.155_94, 0.167_10, 0.177_87];
    assert_eq!(result.patterns.len(), known.len());
    for (pattern, expected) in result.patterns.iter().zip(known) {
        near("mean", pattern.mean_Y_via_pixel, expected, 2e-5);
        // The room in the face: 0.04 along the normal.
        near("face", pattern.mean_Y - pattern.mean_Y_via_pixel, 0.04, 1e-6);
        assert!(pattern.error < 1e-3);
    }
    near("n", result.views[0].yule_nielsen_n.unwrap(), 1.463, 1e-3);
    near("page", white(&result).Y_via_pixel, 0.362_048, 2e-6);
    // Without a matrix there are no pixels.
    assert_eq!((result.pitch_um, white(&result).scalars.mtf_nyquist_x), (None, None));
    assert_eq!(result.views[0].line_contrast.white_1_x, None);
}

/// Stripes that are fine against the glass: E = 1 + A * (rho E) solved on 1024 and 8192 cells (the same to 1e-9), with A by a
/// quadrature of its own (numpy). What differs from it is within the stated error.
#[test]
fn fine_stripes_have_honest_errors() {
    for (thickness_mm, period_mm, expected) in
        [(0.5, 0.2, 0.220_468_16), (2.0, 0.5, 0.220_619_48), (2.0, 1.0, 0.220_464_62)]
    {
        let pattern = format!("[pattern]\nperiod_mm = [{period_mm}]\nkind = [\"stripes\"]\n");
        let view = "[viewer]\ntheta_deg = 0\n";
        let parts = [&glass("fresnel", thickness_mm), &paper(0.8, 0.05), MATRIX, DIFFUSE, view, &pattern];
        let result = computed(&parts).unwrap();
        let found = result.patterns[0];
        // The expected values are rounded to 5e-9; what comes back of frequencies above 16 in a thickness is neglected.
        near("mean", found.mean_Y_via_pixel, expected, found.error + 2e-8);
        assert!(found.error < 1e-5, "{found:?}");
    }
}

/// Fine checkerboards and stripes agree; coarse ones show pages.
#[test]
fn checkerboards_have_the_limits_of_stripes() {
    let pattern = "[pattern]\nperiod_mm = [0.05, 60]\n";
    let result = computed(&[&glass("fresnel", 1.0), &paper(0.6, 0.03), DIFFUSE, pattern]).unwrap();
    let means: Vec<f64> = result.patterns.iter().map(|pattern| pattern.mean_Y_via_pixel).collect();
    near("fine", means[0], means[2], 1e-5);
    assert!(means[3] < means[1] && means[3] > means[2], "{means:?}");
}

/// Lines and text: white lines on black lose more than black ones on white; text has the contrast of black
/// lines.
#[test]
fn lines_and_text_have_the_contrast_of_their_surround() {
    let result = computed(&[&glass("fresnel", 0.7), MATRIX, &paper(0.45, 0.03), DIFFUSE]).unwrap();
    let view = &result.views[0];
    let via = view.line_contrast_via_pixel;
    // Far from all else white has 0.7316 of its page, black 1.0 of its own page, which returns nearly
    // nothing.
    let page = |rho: f64| rho / (1.0 - rho * 0.596_346);
    let line =
        (0.45 / (1.0 - 0.03 * 0.596_346) - page(0.03)) / (0.45 / (1.0 - 0.03 * 0.596_346) + page(0.03));
    near("white line", via.white_1_x.unwrap(), line, 2e-3);
    let dark = 0.03 / (1.0 - 0.45 * 0.596_346);
    near("black line", via.black_1_x.unwrap(), (page(0.45) - dark) / (page(0.45) + dark), 2e-3);
    let (least, median) = (view.text_contrast_min.unwrap(), view.text_contrast_median.unwrap());
    assert!(least <= median && least > 0.5, "{least} {median}");
    near("text", view.text_contrast_median_via_pixel.unwrap(), via.black_1_x.unwrap(), 0.02);
}

/// Air in the place of the glass: the same forms with an index of 1. Angles that are not refracted have no
/// places.
#[test]
fn lobe_above_air_has_closed_forms() {
    let b = 0.02;
    let lobe = LOBE.replace("0.05667", "0.02");
    let air = "[display.glass]\nindex = 1\nthickness_mm = 0.5\n";
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    let result = computed(&[&lobe, air, MATRIX, MIRROR, DIFFUSE, view]).unwrap();
    for f in [1.0, 2.0, 5.0] {
        let expected = (-2.0 * std::f64::consts::PI * f * b * 0.5).exp();
        near("MTF", at(&result, white(&result), f)[0], expected, 1.2 * b);
    }
    let unrefracted =
        resolved(&[&lobe, air, MATRIX, MIRROR, DIFFUSE, "[solver]\napproximation = \"unrefracted\"\n"]);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let error = mtf(&unrefracted.scene, &unrefracted.patterns, &control).unwrap_err();
    assert!(matches!(error, DisplayError::NoRefraction), "{error}");
}

/// Below glass that is much thinner than a pixel, recycled light returns to its own place: lines and strokes
/// have the contrast of pages, rho (1 - r)/(1 - rho r) each. Between, the contrast of text is that of cells
/// that follow the thickness, of a program without a bound of their number.
#[test]
fn lines_and_text_below_thin_glass_have_the_contrast_of_pages() {
    let contrast = |thickness_mm: f64| {
        let matrix = "[display.matrix]\nppi = 300\n";
        let result =
            computed(&[&glass("fresnel", thickness_mm), matrix, &paper(0.6, 0.03), DIFFUSE]).unwrap();
        let view = &result.views[0];
        let line = view.line_contrast_via_pixel;
        [
            view.text_contrast_min_via_pixel,
            view.text_contrast_median_via_pixel,
            line.white_1_x,
            line.black_4_x,
        ]
        .map(Option::unwrap)
    };
    let page = |rho: f64| rho / (1.0 - rho * 0.596_346);
    let expected = (page(0.6) - page(0.03)) / (page(0.6) + page(0.03));
    let thin = [(1e-9, 1e-6), (1e-3, 2e-3), (1e-12, 1e-6), (1e-6, 1e-6)];
    for (thickness_mm, tolerance) in everyday(2, thin) {
        contrast(thickness_mm).into_iter().for_each(|found| near("thin", found, expected, tolerance));
    }
    let [least, median, ..] = contrast(0.03);
    near("least", least, 0.924_846, 1e-3);
    near("median", median, 0.932_049, 1e-3);
}

/// The light of a kernel is that of colours: with a lobe and a film, in diffuse light and a beam.
#[test]
fn light_of_a_kernel_is_that_of_colours() {
    let resolved =
        common::scenario("matrix", &["spectrum.step_nm=20", "solver.relative_error=1e-6"]).unwrap();
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let result = mtf(&resolved.scene, &resolved.patterns, &control).unwrap();
    let colours = common::run(&resolved.scene).unwrap();
    for (name, state) in result.views[0].states.iter() {
        let y = colours.views[0].states.get(name).unwrap().value.Y;
        near(name, state.Y_via_pixel / y, 1.0, 1e-4);
        let fractions: f64 = state.by_light.iter().map(|(_, light)| light.fraction).sum();
        near(name, fractions, 1.0, 1e-12);
    }
    let again = mtf(&resolved.scene, &resolved.patterns, &Control { threads: Some(3), ..control }).unwrap();
    assert!(again == result);
}

/// What is not covered is refused by its key.
#[test]
fn displays_without_places_are_refused() {
    let refused = |parts: &[&str]| computed(parts).unwrap_err();
    let no_thickness = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\n";
    let error = refused(&[no_thickness, &paper(0.5, 0.1), DIFFUSE]);
    assert_eq!(
        error,
        DisplayError::MissingLength { key: "display.glass.thickness_mm".to_owned(), others: Vec::new() }
    );
    let fronts = "[[display.front]]\nreflectance = 0.02\ngap_mm = 1.0\n[[display.front]]\nreflectance = 0.02\ngap_mm = 1.0\n";
    let error = refused(&[fronts, &glass("coated", 0.5), MIRROR, DIFFUSE]);
    assert!(error.to_string().contains("monte-carlo"), "{error}");
    match error {
        DisplayError::PlacesByPaths { key, .. } => assert_eq!(key, "display.front"),
        other => panic!("{other}"),
    }
}

/// Light that spreads within the pixel is refused by what does not compute it, not ignored.
#[test]
fn pixels_that_spread_light_are_refused() {
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let spread = "display.pixel={ model = \"uniform\", kind = \"lambertian\", reflectance = { white = 0.5 }, spread_um = 10 }";
    let panel = common::scenario("matrix", &[spread]).unwrap();
    match mtf(&panel.scene, &panel.patterns, &control).unwrap_err() {
        DisplayError::PlacesByPaths { key, .. } => assert_eq!(key, "display.pixel.spread_um"),
        other => panic!("{other}"),
    }
    let face = common::scenario("antiglare", &[spread]).unwrap();
    match sparkle(&face.scene, face.sparkle.as_ref().unwrap(), &control).unwrap_err() {
        DisplayError::PlacesNotComputed { key, .. } => assert_eq!(key, "display.pixel.spread_um"),
        other => panic!("{other}"),
    }
}

/// At grazing views numbers stay finite.
#[test]
fn grazing_view_is_finite() {
    let view = "[viewer]\ntheta_deg = 89\nfield_deg = 0.1\n";
    let result = computed(&[LOBE, &glass("coated", 0.5), MATRIX, MIRROR, DIFFUSE, view]).unwrap();
    let state = white(&result);
    assert!(state.otf.otf_x.iter().flatten().all(|value| value.is_finite() && value.abs() < 1.0 + 1e-6));
    assert!(result.error_reached < 0.05);
}

/// The mean of the spread is the colour of `run`, to the error of two quadratures. Without a diffuser only
/// the transmittance of the face for diffuse light is integrated, at two levels.
#[test]
fn mean_of_the_spread_is_the_colour() {
    let beam = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.4\n[[lighting.directed]]\ntheta_deg = -35\nphi_deg = 20\nshare = 0.6\n";
    for (above, pixel, within) in [
        ("", &paper(0.6, 0.03)[..], 1e-9),
        ("", MIRROR, 1e-9),
        (LOBE, &paper(0.6, 0.03)[..], 1e-6),
        (LOBE, MIRROR, 1e-6),
    ] {
        let parts = [above, &glass("coated", 0.5), MATRIX, pixel, beam, "[viewer]\ntheta_deg = 25\n"];
        let colours =
            common::run(&resolved(&[&parts.concat(), "[solver]\nrelative_error = 1e-6\n"]).scene).unwrap();
        let colour = colours.views[0].states.get("white").unwrap().value.Y;
        let found = white(&computed(&parts).unwrap()).Y_via_pixel;
        near("mean", found / colour, 1.0, within);
    }
}

/// A bare face over mirror-like stripes: <rho rho'> of the second order is 0.18045, 0.099225 and 0.018 at
/// shifts of 0, 1/4 and 1/2 of the period; and the mean is that of paths.
#[test]
fn stripes_of_mirrors_beat_with_their_images() {
    let [theta, index, thickness] = [50.0_f64, 1.5_f64, 0.3];
    let beta = theta.to_radians().sin();
    let shift = 2.0 * thickness * beta / (index * index - beta * beta).sqrt();
    let faces = {
        let (outside, inside) = (theta.to_radians().cos(), (1.0 - beta * beta / (index * index)).sqrt());
        let s = (outside - index * inside) / (outside + index * inside);
        let p = (index * outside - inside) / (index * outside + inside);
        [s * s, p * p]
    };
    for (part, second) in [(0.0, 0.180_45), (0.25, 0.099_225), (0.5, 0.018)] {
        let period = shift / (1.0 + part);
        let pattern = format!("[pattern]\nkind = [\"stripes\"]\nperiod_mm = [{period}]\n");
        let view = format!("[viewer]\ntheta_deg = {theta}\n");
        let mirror = "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.6, black = 0.03 }\n";
        let glass = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\nthickness_mm = 0.3\n";
        let diffuse = "[lighting]\nspectrum = \"D65\"\nilluminance_lx = 500\ndiffuse = 1.0\n";
        let result = computed(&[glass, mirror, diffuse, &view, &pattern]).unwrap();
        let found = result.views[0].patterns[0].mean_Y_via_pixel;
        let mean = |of: &dyn Fn(f64) -> f64| 0.5 * faces.map(of).iter().sum::<f64>();
        let first = mean(&|face| (1.0 - face).powi(2) * (0.315 + face * second));
        // Third and later orders.
        let rest = mean(&|face| (1.0 - face).powi(2) * face.powi(2) * 0.6_f64.powi(3) / (1.0 - 0.6 * face));
        assert!(found > first && found < first + rest, "{part}: {found}, {first} to {}", first + rest);
    }
}

/// Lines of mirrors below a bare face, seen obliquely: light that the face returned has met the pixel elsewhere.
/// Where that is beside the line, it multiplies line and surround alike; in a line that is as wide as one way of
/// this light, but not two, `rho (1 + F rho/(1 - F rho'))`; along the other axis, pages. Text is like lines.
#[test]
fn lines_of_mirrors_multiply_with_their_images() {
    let [theta, index] = [50.0_f64, 1.5_f64];
    let [outside, inside] =
        [theta.to_radians().cos(), (1.0 - (theta.to_radians().sin() / index).powi(2)).sqrt()];
    let [s, p] = [
        (outside - index * inside) / (outside + index * inside),
        (index * outside - inside) / (index * outside + inside),
    ];
    let faces = [s * s, p * p];
    // Of what enters and leaves.
    let seen =
        |of: &dyn Fn(f64) -> f64| faces.map(|face| (1.0 - face).powi(2) * of(face)).iter().sum::<f64>();
    let mirror = "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.9, black = 0.3 }\n";
    let view = format!("[viewer]\ntheta_deg = {theta}\nfield_deg = 0\n");
    let lines = |thickness_mm: f64| {
        let glass = glass("fresnel", thickness_mm);
        computed(&[&glass, MATRIX, mirror, DIFFUSE, &view]).unwrap().views.remove(0)
    };
    let page = |rho: f64| seen(&|face| rho / (1.0 - face * rho));
    let contrast = |a: f64, b: f64| (a - b).abs() / (a + b);
    // The first image is 356 um away, farther than half of 4 pixels of 84.67 um.
    let far = lines(0.3);
    let via = far.line_contrast_via_pixel;
    let beside = contrast(0.9, 0.3);
    for found in [via.white_1_x, via.white_4_x, via.black_1_x, via.black_4_x] {
        near("beside", found.unwrap(), beside, 1e-9);
    }
    for found in [via.white_1_y, via.black_4_y] {
        near("along", found.unwrap(), contrast(page(0.9), page(0.3)), 1e-9);
    }
    // Some strokes have an image on other strokes, which return less; in the middle, the second one.
    let text = [far.text_contrast_min_via_pixel, far.text_contrast_median_via_pixel].map(Option::unwrap);
    near("text", text[1], beside, 0.5 * seen(&|face| face * face));
    assert!(text[0] >= beside - 1e-9 && text[0] < beside + faces[0], "{text:?}");
    // It is 119 um away, and the second 238.
    let near_by = lines(0.1).line_contrast_via_pixel;
    let wide = |line: f64, surround: f64| {
        let middle = seen(&|face| line * (1.0 + face * line / (1.0 - face * surround)));
        contrast(middle, page(surround))
    };
    near("white, wide", near_by.white_4_x.unwrap(), wide(0.9, 0.3), 1e-9);
    near("black, wide", near_by.black_4_x.unwrap(), wide(0.3, 0.9), 1e-9);
    near("white, narrow", near_by.white_1_x.unwrap(), beside, 1e-9);
}

/// Contrasts with and without the images of the room have errors of their own. That of white lines on black, whose page is exact, is
/// that of the light of the line, times the derivative of the contrast.
#[test]
fn contrasts_via_the_pixel_have_their_own_errors() {
    let parts = [&glass("fresnel", 0.5), MATRIX, &paper(0.8, 0.05), DIFFUSE, "[pattern]\ntext = \"it\"\n"];
    let resolved = resolved(&[&parts.concat(), "[solver]\nrelative_error = 1e-1\n"]);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let view = mtf(&resolved.scene, &resolved.patterns, &control).unwrap().views.remove(0);
    let black = view.states.get("black").unwrap().Y_via_pixel;
    let of = |lines: LineContrast| lines.white_1_x.unwrap();
    let [all, via] = [view.line_contrast, view.line_contrast_via_pixel].map(of);
    let [of_all, of_via] = [view.line_contrast_error, view.line_contrast_via_pixel_error].map(of);
    let white = black * (1.0 + via) / (1.0 - via);
    let faces = 0.5 * ((white - black) / all - white - black);
    let slope = |faces: f64| 2.0 * (black + faces) / (white + black + 2.0 * faces).powi(2);
    let expected = of_all * slope(0.0) / slope(faces);
    assert!(of_all > 1e-7 && (of_via / expected - 1.0).abs() < 0.01, "{of_via} {expected} {of_all}");
    assert!((of_via / of_all - 1.0).abs() > 0.1, "{of_via} {of_all}");
    let text = [view.text_contrast_error, view.text_contrast_via_pixel_error].map(Option::unwrap);
    assert!(text[1].iter().zip(text[0]).all(|(via, all)| *via > 0.0 && *via != all), "{text:?}");
}

/// The same below a front, in a wide field, with text: light also moves through the air, and each direction of the
/// field has images of its own. By paths over the actual lines and letters.
#[test]
fn lines_and_text_of_mirrors_below_a_front_are_those_of_paths() {
    let mirror = "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.9, black = 0.3 }\n";
    let front = "[[display.front]]\nreflectance = 0.3\ngap_mm = 0.1\n";
    let view = "[viewer]\ntheta_deg = 50\nphi_deg = 20\nfield_deg = 4\n";
    let parts = [front, &glass("fresnel", 0.15), MATRIX, mirror, DIFFUSE, view, "[pattern]\ntext = \"it\"\n"];
    let found = |solver: &str| {
        let resolved = resolved(&[&parts.concat(), "[solver]\n", solver]);
        let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
        let view = mtf(&resolved.scene, &resolved.patterns, &control).unwrap().views.remove(0);
        let (lines, errors) = (view.line_contrast_via_pixel, view.line_contrast_via_pixel_error);
        let errors_of_text = view.text_contrast_via_pixel_error;
        let median = (view.text_contrast_median_via_pixel, errors_of_text.map(|errors| errors[1]));
        [
            (lines.white_1_x, errors.white_1_x),
            (lines.white_4_x, errors.white_4_x),
            (lines.black_2_x, errors.black_2_x),
            (lines.black_4_x, errors.black_4_x),
            (lines.white_4_y, errors.white_4_y),
            (lines.black_4_y, errors.black_4_y),
            median,
        ]
        .map(|(value, error)| (value.unwrap(), error.unwrap()))
    };
    let exact = found("relative_error = 1e-4\n");
    for ((value, stated), (path, error)) in
        exact.into_iter().zip(found("method = \"monte-carlo\"\npaths = 16384\n"))
    {
        assert!((value - path).abs() < 4.5 * error + stated + 1e-6, "{value} +- {stated}, {path} +- {error}");
        assert!(error < 0.01 * value, "{path} +- {error}");
    }
}

/// Films below a face in a wide field: each direction of it has its own reflectance. The mean of fine stripes
/// is that of paths.
#[test]
fn stripes_of_films_in_a_wide_field_are_those_of_paths() {
    let film = "[display.pixel]\nmodel = \"film\"\nsubstrate = \"Al\"\narea = { red = 0.4, green = 0.35, blue = 0.25 }\n\
        gap_nm = { red = 276, green = 192, blue = 138, dark = 20 }\nfill_factor = 0.9\n\
        film = [{ material = \"Cr:Johnson\", thickness_nm = 12 }, { material = \"air\", thickness_nm = \"gap\" }]\n";
    let pattern = "[pattern]\nkind = [\"stripes\"]\nperiod_mm = [0.2, 0.7]\n";
    let view = "[viewer]\ntheta_deg = 50\nphi_deg = 20\nfield_deg = 16\n";
    let parts = [film, &glass("fresnel", 0.9), DIFFUSE, view, pattern];
    let means = |solver: &str| {
        let resolved = resolved(&[&parts.concat(), "[solver]\n", solver]);
        let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
        mtf(&resolved.scene, &resolved.patterns, &control).unwrap().views.remove(0).patterns
    };
    let paths = means("method = \"monte-carlo\"\npaths = 16384\n");
    for (exact, found) in means("relative_error = 1e-4\n").iter().zip(&paths) {
        let (off, allowed) = (exact.mean_Y - found.mean_Y, 4.5 * found.error + exact.error);
        assert!(off.abs() < allowed, "{exact:?} {found:?}");
        assert!(found.error < 3e-3 * found.mean_Y, "{found:?}");
    }
}

/// The progress of paths through several views is the part of all paths that is traced: the pilot of a view, whose target needs many
/// times its paths, is none of it.
#[test]
fn progress_of_views_by_paths_is_their_part_of_all_paths() {
    let views = "[viewer]\ntheta_deg = [-20, 20]\nfield_deg = 0\n";
    let solver = "[solver]\nmethod = \"monte-carlo\"\nrelative_error = 0.02\n";
    let resolved = resolved(&[LOBE, &glass("coated", 0.5), MIRROR, DIFFUSE, views, solver]);
    let (reports, shown) = (Mutex::new(Vec::new()), ProgressFraction::default());
    let progress = |now: Progress<'_>| {
        let fraction = shown.advance(now.fraction());
        now.paths.into_iter().for_each(|paths| reports.lock().unwrap().push((paths, fraction)));
    };
    let control = Control { threads: Some(1), progress: &progress, stop: &AtomicBool::new(false) };
    mtf(&resolved.scene, &resolved.patterns, &control).unwrap();
    let reports = reports.into_inner().unwrap();
    let all = reports.iter().map(|(paths, _)| *paths).max().unwrap() as f64;
    for (paths, fraction) in &reports {
        let traced = *paths as f64 / all;
        assert!((-0.15..0.02).contains(&(fraction - traced)), "{fraction} of {traced}");
    }
}
