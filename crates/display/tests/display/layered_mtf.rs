//! Sharpness below general layers by adding, from the scenario to the result: known values, and what is
//! refused.

use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use papilio_display::spatial::{MtfResult, mtf};
use papilio_display::{Control, DisplayError, Progress};
use papilio_scenario::{Resolved, Scenario};
use papilio_testing::everyday;

const MIRROR: &str =
    "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.9, black = 0.1 }\n";
const PAPER: &str = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.45, black = 0.03 }\n";
const MATRIX: &str = "[display.matrix]\nppi = 150\n";
const DIFFUSE: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"E\"\ndiffuse = 1.0\n";
const NORMAL: &str = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";

fn medium(index: f64, thickness_mm: f64) -> String {
    format!("[[display.layers]]\nkind = \"medium\"\nindex = {index}\nthickness_mm = {thickness_mm}\n")
}

/// Glass in two layers: what is above it is then no ordinary panel.
fn glass(thickness_mm: [f64; 2]) -> String {
    thickness_mm.map(|mm| medium(1.5, mm)).concat()
}

fn lobe(width: f64, regular_fraction: f64) -> String {
    format!(
        "[[display.layers]]\nkind = \"diffuser\"\nmodel = \"k-correlation\"\nwidth = {width}\ntransmittance = 0.95\n\
         regular_fraction = {regular_fraction}\n"
    )
}

fn interface(kind: &str) -> String {
    format!("[[display.layers]]\nkind = \"{kind}\"\n")
}

fn resolved(parts: &[&str]) -> Resolved {
    let text = format!("[spectrum]\nstep_nm = 40\n{}[solver]\nrelative_error = 0.003\n", parts.concat());
    Scenario::from_text(&text, "mtf.toml", Path::new("."), &[]).unwrap().resolve().unwrap()
}

fn computed(resolved: &Resolved) -> Result<MtfResult, DisplayError> {
    let levels = AtomicUsize::new(0);
    let progress = |now: Progress<'_>| {
        levels.fetch_add(usize::from(now.relative_error.is_some()), Ordering::Relaxed);
    };
    let control = Control { threads: Some(1), progress: &progress, stop: &AtomicBool::new(false) };
    let result = mtf(&resolved.scene, &resolved.patterns, &control);
    assert!(result.is_err() || levels.into_inner() > 0, "the error of each level is reported");
    result
}

/// Modulation transfer of white along x and y at the frequency of the list that is nearest, and that
/// frequency.
fn at(result: &MtfResult, frequency: f64) -> ([[f64; 2]; 2], f64) {
    let distance = |k: &usize| (result.frequency_per_mm[*k] - frequency).abs();
    let all = 0..result.frequency_per_mm.len();
    let k = all.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
    let white = result.views[0].states.get("white").unwrap();
    ([white.otf.otf_x[k], white.otf.otf_y[k]], result.frequency_per_mm[k])
}

/// A lobe over a mirror as layers: the numbers of an independent radial integral (numpy), as of the ordinary
/// panel.
#[test]
fn lobe_as_a_layer_has_known_modulation_transfer() {
    let lobe = lobe(0.05667, 0.0);
    let result = computed(&resolved(&[&lobe, &glass([0.2, 0.3]), MIRROR, MATRIX, DIFFUSE, NORMAL])).unwrap();
    for (f, expected) in [(1.0, 0.939_069), (4.0, 0.659_972)] {
        let (both, found) = at(&result, f);
        assert!((found - f).abs() < 1e-9, "{found}");
        for [re, im] in both {
            assert!((re - expected).abs() < result.error_reached + 1e-6 && im.abs() < 1e-6, "{f}: {re} {im}");
        }
    }
    // The target of the scene.
    assert!(result.error_reached < 3e-3, "{}", result.error_reached);
    let white = &result.views[0].states.get("white").unwrap().scalars;
    assert!(white.edge_10_90_x_um.is_none() && white.sqri_jnd_x.is_some(), "{white:?}");
}

/// The return of a flat face to paper, by mpmath for 0.7 mm: as of the ordinary panel.
#[test]
fn flat_layers_have_known_return() {
    let layers = [interface("fresnel"), glass([0.3, 0.4])].concat();
    let result = computed(&resolved(&[&layers, PAPER, DIFFUSE, NORMAL])).unwrap();
    for (f, returned) in [(0.1, 0.273_36), (0.25, -0.036_95), (1.0, -0.004_84)] {
        let expected = (1.0 - 0.45 * 0.596_35) / (1.0 - 0.45 * returned);
        let ([[re, _], _], found) = at(&result, f);
        assert!((found - f).abs() < 1e-9 && (re - expected).abs() < 1e-4, "{f}: {re} {expected}");
    }
}

/// Numbers of a view with their errors: of white, and of figures.
fn numbers(result: &MtfResult) -> Vec<(String, f64, f64)> {
    let view = &result.views[0];
    let white = view.states.get("white").unwrap();
    let scalars = white.scalars.named().zip(white.error.named());
    let lines = view.line_contrast.named().zip(view.line_contrast_error.named());
    let known = scalars.chain(lines).filter_map(|((name, value), (_, error))| {
        value.map(|value| (name.to_owned(), value, error.unwrap_or(0.0)))
    });
    let text = view.text_contrast_median.zip(view.text_contrast_error);
    let text = text.map(|(median, [_, error])| ("text".to_owned(), median, error));
    let patterns = result.patterns.iter().enumerate();
    let patterns = patterns.map(|(k, mean)| (format!("pattern {k}"), mean.mean_Y, mean.error));
    let n = view.yule_nielsen_n.map(|n| ("n".to_owned(), n, 1e-4));
    known.chain(text).chain(patterns).chain(n).collect()
}

/// Places, lines, text and patterns of paper below layers are those of the ordinary panel, which another
/// method computes.
#[test]
fn paper_below_layers_has_numbers_of_panel() {
    let pattern = "[pattern]\ntext = \"it\"\nkind = [\"stripes\", \"checkerboard\"]\non = \"white\"\noff = \"black\"\nperiod_mm = [0.5, 4.0]\n";
    let oblique = "[viewer]\ntheta_deg = 30\nphi_deg = 20\nfield_deg = 0\n";
    let of_lobe = "model = \"k-correlation\"\nwidth = 0.3\ntransmittance = 0.95\n";
    let panel =
        |top: &str, face: &str| format!("{top}[display.glass]\nindex = 1.5\nthickness_mm = 0.5\n{face}");
    let flat = [interface("fresnel"), glass([0.2, 0.3])].concat();
    let lobe = [lobe(0.3, 0.0), glass([0.2, 0.3])].concat();
    let of_lobe = panel(&format!("[display.diffuser]\n{of_lobe}"), "");
    let cases = [
        (flat, panel("", "surface = \"fresnel\"\n"), NORMAL),
        (lobe.clone(), of_lobe.clone(), NORMAL),
        (lobe, of_lobe, oblique),
    ];
    for (layers, panel, view) in everyday(2, cases) {
        let rest = [PAPER, MATRIX, DIFFUSE, view, pattern];
        let of = |display: &str| {
            let parts: Vec<&str> = [display].into_iter().chain(rest).collect();
            numbers(&computed(&resolved(&parts)).unwrap())
        };
        let (found, expected) = (of(&layers), of(&panel));
        assert!(found.len() == expected.len() && found.len() > 25, "{found:?} {expected:?}");
        for ((name, found, error), (_, expected, of_panel)) in found.iter().zip(&expected) {
            let allowed = 2.0 * (error + of_panel) + 3e-3 * expected.abs();
            assert!(
                (found - expected).abs() <= allowed,
                "{name}: {found} +- {error}, {expected} +- {of_panel}"
            );
        }
    }
}

/// What is not covered is refused with its key and the solver that computes it.
#[test]
fn layers_without_frequencies_are_refused() {
    let slab = "[[display.layers]]\nkind = \"fresnel\"\n[[display.layers]]\nkind = \"slab\"\nindex = 1.5\noptical_thickness = 1.0\nalbedo = 1.0\nanisotropy = 0.5\nthickness_mm = 0.1\n";
    let pattern = "[pattern]\nkind = [\"stripes\"]\non = \"white\"\noff = \"black\"\nperiod_mm = [1.0]\n";
    let one = [lobe(0.2, 0.0), glass([0.1, 0.1])].concat();
    let cases: [(&[&str], &str); 2] =
        [(&[slab, PAPER, DIFFUSE], "display.layers"), (&[&one, MIRROR, pattern, DIFFUSE], "pattern")];
    for (parts, expected) in cases {
        let error = computed(&resolved(parts)).unwrap_err();
        assert!(error.to_string().contains("monte-carlo"), "{error}");
        match error {
            DisplayError::PlacesByPaths { key, .. } => assert_eq!(key, expected),
            other => panic!("{other}"),
        }
    }
}
