//! Figures and pictures of Lambertian pixels below general layers: those of the same display as an ordinary
//! panel, which other methods compute, and those of paths.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::image::{Halftone, ImageResult, ImageSettings, Screen, Sharpness, SourceImage, image};
use papilio_display::scene::{Method, Stop};
use papilio_display::spatial::{CrosstalkResult, Picture, Precision, crosstalk, picture};
use papilio_display::{Control, DisplayError};
use papilio_scenario::{Resolved, Scenario};
use papilio_testing::everyday;

const PAPER: &str = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\n\
                     reflectance = { white = 0.6, grey = 0.25, black = 0.03 }\n";
const MATRIX: &str = "[display.matrix]\nppi = 120\n";
const LIGHT: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"E\"\ndiffuse = 0.6\n\
                     [[lighting.directed]]\ntheta_deg = -45\nshare = 0.4\n";
const NORMAL: &str = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
const OBLIQUE: &str = "[viewer]\ntheta_deg = 30\nphi_deg = 20\nfield_deg = 0\n";
const FACE: &str = "[[display.layers]]\nkind = \"fresnel\"\n";

fn medium(index: f64, thickness_mm: f64) -> String {
    format!("[[display.layers]]\nkind = \"medium\"\nindex = {index}\nthickness_mm = {thickness_mm}\n")
}

/// Glass in two layers: what is above it is then no ordinary panel.
fn glass() -> String {
    medium(1.5, 0.2) + &medium(1.5, 0.3)
}

fn lobe(width: f64) -> String {
    format!("model = \"k-correlation\"\nwidth = {width}\ntransmittance = 0.95\n")
}

fn diffuser(width: f64) -> String {
    format!("[[display.layers]]\nkind = \"diffuser\"\n{}", lobe(width))
}

/// The ordinary panel of half a millimetre of glass below a face or a lobe.
fn panel(top: &str, surface: &str) -> String {
    format!("{top}[display.glass]\nindex = 1.5\nthickness_mm = 0.5\n{surface}")
}

/// Displays as layers and as a panel.
fn pairs() -> [(String, String, &'static str); 3] {
    let of_lobe = panel(&format!("[display.diffuser]\n{}", lobe(0.3)), "");
    [
        (diffuser(0.3) + &glass(), of_lobe.clone(), OBLIQUE),
        (FACE.to_owned() + &glass(), panel("", "surface = \"fresnel\"\n"), NORMAL),
        (diffuser(0.3) + &glass(), of_lobe, NORMAL),
    ]
}

fn resolved(parts: &[&str]) -> Resolved {
    let text = format!("[spectrum]\nstep_nm = 40\n{}[solver]\nrelative_error = 0.003\n", parts.concat());
    Scenario::from_text(&text, "layers.toml", Path::new("."), &[]).unwrap().resolve().unwrap()
}

fn with_control<T>(of: impl FnOnce(&Control<'_>) -> Result<T, DisplayError>) -> T {
    of(&Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) }).unwrap()
}

/// Numbers of figures with their errors.
fn figures(result: &CrosstalkResult) -> Vec<(String, f64, f64)> {
    let patterns = result.views[0].patterns.iter();
    let of = |pattern: &papilio_display::spatial::PatternColours| {
        let (values, errors) = (pattern.values, pattern.error);
        let both = [
            (values.contrast_ratio, errors.contrast_ratio),
            (values.contrast_ratio_via_pixel, errors.contrast_ratio_via_pixel),
        ];
        both.map(|(value, error)| (format!("{:?}", pattern.name), value.unwrap(), error.unwrap()))
    };
    patterns.flat_map(of).collect()
}

fn assert_figures_agree(found: &CrosstalkResult, expected: &CrosstalkResult) {
    let (found, expected) = (figures(found), figures(expected));
    assert_eq!((found.len(), expected.len()), (8, 8));
    for ((figure, found, error), (_, expected, of_panel)) in found.iter().zip(&expected) {
        let allowed = 2.0 * (error + of_panel) + 3e-3 * expected;
        assert!((found - expected).abs() < allowed, "{figure}: {found} +- {error}, {expected} +- {of_panel}");
        assert!(*error < 0.02 * found, "{figure}: {found} +- {error}");
    }
}

/// Pixels of the width of the blur, which are cells of text that are not divided.
#[test]
fn figures_of_small_pixels_below_layers_are_those_of_panel() {
    let of = |display: &str| {
        let view = "[viewer]\ntheta_deg = 8\n[pattern]\ntext = \"i\"\n";
        let mut resolved = resolved(&[display, PAPER, "[display.matrix]\nppi = 330\n", LIGHT, view]);
        resolved.scene.solver.stop = Stop::RelativeError { target: 0.02, per_wavelength: false };
        with_control(|control| crosstalk(&resolved.scene, &resolved.patterns.text, control))
    };
    let panel = panel(&format!("[display.diffuser]\n{}", lobe(0.1)), "");
    assert_figures_agree(&of(&(diffuser(0.1) + &glass())), &of(&panel));
}

/// The flat face, half a minute, in full only: every day its pictures are compared below.
#[test]
fn figures_below_layers_are_those_of_panel() {
    for (layers, panel, view) in everyday(1, pairs()) {
        let of = |display: &str| {
            let resolved = resolved(&[display, PAPER, MATRIX, LIGHT, view, "[pattern]\ntext = \"it\"\n"]);
            with_control(|control| crosstalk(&resolved.scene, &resolved.patterns.text, control))
        };
        let (found, expected) = (of(&layers), of(&panel));
        assert_eq!(found.views[0].shares.out, [[1.0]]);
        assert_figures_agree(&found, &expected);
    }
}

/// Below a flat face by the solver of pictures itself.
#[test]
fn pictures_below_flat_layers_are_those_of_panel() {
    let [_, (layers, panel, view), _] = pairs();
    let mixed = Picture { count: [12, 10], states: (0..120).map(|k| (k * k % 3) as u8).collect() };
    let of = |display: &str| {
        let resolved = resolved(&[display, PAPER, MATRIX, LIGHT, view]);
        with_control(|control| picture(&resolved.scene, &mixed, Precision::FINE, control))
    };
    let (found, expected) = (of(&layers), of(&panel));
    let allowed = (2.0 * (found.error + expected.error) + 1e-3) as f32;
    for (found, expected) in found.views[0].iter().flatten().zip(expected.views[0].iter().flatten()) {
        assert!((found - expected).abs() < allowed, "{found} {expected} +- {allowed}");
    }
    assert!(found.error < 5e-3, "{}", found.error);
}

/// A picture without symmetry.
fn source() -> SourceImage {
    let pixel = |k: usize| {
        let (x, y) = (k % 16, k / 16);
        let grey = if x > 3 && y > 8 { 0.9 } else { 0.02 + 0.05 * ((x * 5 + y * 3) % 16) as f32 };
        [0.95 * grey, grey, 1.09 * grey]
    };
    SourceImage { columns: 16, pixels: (0..16 * 14).map(pixel).collect() }
}

/// By error diffusion: a search may end in another pattern where the blur differs by rounding.
fn seen(resolved: &Resolved) -> ImageResult {
    let settings = ImageSettings { halftone: Halftone::ErrorDiffusion, ..ImageSettings::default() };
    with_control(|control| image(&resolved.scene, &source(), &settings, Screen::default(), control))
}

fn assert_close(found: &ImageResult, expected: &ImageResult, least: f64) {
    assert_eq!(found.states, expected.states);
    let allowed = found.numbers.error + expected.numbers.error + least;
    let pairs = found.seen.iter().flatten().zip(expected.seen.iter().flatten());
    let off = pairs.map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max);
    assert!(off < allowed, "{off} of {allowed}: {} {}", found.numbers.error, expected.numbers.error);
    assert_sharpness_agrees(found, expected);
    assert!(found.numbers.neighbours_light && expected.numbers.neighbours_light);
}

/// Square-root integrals, which each display has.
fn assert_sharpness_agrees(found: &ImageResult, expected: &ImageResult) {
    let [found, expected] = [found, expected].map(|one| one.numbers.sharpness.unwrap());
    let pairs = |one: Sharpness| one.sqri_jnd.into_iter().chain(one.sqri_ideal_jnd);
    for (one, other) in pairs(found).zip(pairs(expected)) {
        assert!((one / other - 1.0).abs() < 3e-3, "{found:?} {expected:?}");
    }
    assert!(found.sqri_jnd[0] < 0.95 * found.sqri_ideal_jnd[0], "{found:?}");
}

/// Mirror-like pixels below layers, whose pictures are those of a few paths, and below the same panel.
#[test]
fn sharpness_of_mirrors_below_layers_is_that_of_panel() {
    let mirrors = PAPER.replace("lambertian", "mirror");
    let panel = panel(&format!("[display.diffuser]\n{}", lobe(0.3)), "");
    let of = |display: &str| {
        let mut resolved = resolved(&[display, &mirrors, MATRIX, LIGHT, NORMAL]);
        resolved.scene.solver.method = Method::MonteCarlo;
        resolved.scene.solver.stop = Stop::Paths(1 << 10);
        seen(&resolved)
    };
    assert_sharpness_agrees(&of(&(diffuser(0.3) + &glass())), &of(&panel));
}

/// A lobe blurs pictures as that of a panel does, which is known by place, and shifts them to the same side.
#[test]
fn pictures_below_a_lobe_are_those_of_panel() {
    let [(layers, panel, view), ..] = pairs();
    let of = |display: &str| seen(&resolved(&[display, PAPER, MATRIX, LIGHT, view]));
    let (found, expected) = (of(&layers), of(&panel));
    assert_close(&found, &expected, 2e-3);
    assert!(found.numbers.error < 0.01, "{}", found.numbers.error);
}

/// Two lobes between which light is reflected, against the kernels of paths.
#[test]
fn pictures_below_two_lobes_are_those_of_paths() {
    let layers = [diffuser(0.3), medium(1.5, 0.2), diffuser(0.25), medium(1.4, 0.3)].concat();
    let mut resolved = resolved(&[&layers, PAPER, MATRIX, LIGHT, OBLIQUE]);
    let found = seen(&resolved);
    resolved.scene.solver.method = Method::MonteCarlo;
    resolved.scene.solver.stop = Stop::Paths(1 << 15);
    assert_close(&found, &seen(&resolved), 2e-3);
}
