//! Light that spreads inside Lambertian pixels: closed forms, both solvers, halftones; inks that were
//! measured through a face.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::spatial::{
    CrosstalkResult, Figure, MtfResult, Picture, Precision, crosstalk, mtf, picture,
};
use papilio_display::{Control, DisplayError};
use papilio_scenario::{Resolved, Scenario};

use crate::common;

const AIR: &str = "[display.glass]\nindex = 1.0\nsurface = \"ideal-ar\"\n";
const GLASS: &str = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\nthickness_mm = 0.5\n";
const MATRIX: &str = "[display.matrix]\npitch_um = 200\n";
const DIFFUSE: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 1.0\n";
const VIEW: &str = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";

/// The Monte Carlo solver with fewer paths every day.
fn paths() -> String {
    format!("[solver]\nmethod = \"monte-carlo\"\npaths = {}\n", papilio_testing::sized(32_768, 1 << 20))
}

fn paper(spread_um: f64) -> String {
    format!(
        "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = {{ white = 0.6, black = 0.03 }}\nspread_um = {spread_um}\n"
    )
}

fn resolved(parts: &[&str]) -> Resolved {
    let text = format!("[spectrum]\nstep_nm = 80\n{}", parts.concat());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    Scenario::from_text(&text, "spread.toml", &folder, &[]).unwrap().resolve().unwrap()
}

fn sharpness(parts: &[&str]) -> Result<MtfResult, DisplayError> {
    let resolved = resolved(parts);
    let control = Control { threads: Some(2), progress: &|_| {}, stop: &AtomicBool::new(false) };
    mtf(&resolved.scene, &resolved.patterns, &control)
}

/// Modulation transfer of white along x at a frequency of the list, and its error.
fn at(result: &MtfResult, frequency: f64) -> (f64, f64) {
    let near = |f: &f64| (f - frequency).abs() < 1e-9 * frequency;
    let k = result.frequency_per_mm.iter().position(near).unwrap();
    let otf = &result.views[0].states.get("white").unwrap().otf;
    (otf.otf_x[k][0], otf.error_x[k])
}

fn near(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() < tolerance, "{what}: {found} against {expected}");
}

/// Transform of the exponential line spread of s mm.
fn inside(frequency: f64, s: f64) -> f64 {
    1.0 / (1.0 + (2.0 * std::f64::consts::PI * frequency * s).powi(2))
}

/// Without any glass a small change of the state has (1 + P)/2: half of the light has met it on its way out.
/// Under glass the light that the face returns (known values of A) passes the pixel in the same way.
#[test]
fn small_changes_of_the_state_have_known_transfer() {
    let bare = sharpness(&[AIR, MATRIX, &paper(30.0), DIFFUSE, VIEW]).unwrap();
    for f in [0.1, 1.0, 2.0, 5.0] {
        near("bare", at(&bare, f).0, 0.5 + 0.5 * inside(f, 0.03), 1e-9);
    }
    let glass = sharpness(&[GLASS, MATRIX, &paper(200.0), DIFFUSE, VIEW]).unwrap();
    for (f, returned) in [(0.1, 0.3768), (0.2, 0.1428), (1.0, 0.0249), (2.0, 0.0045)] {
        let p = inside(f, 0.2);
        let expected = 0.5 * (1.0 + p) * (1.0 - 0.6 * 0.596_346) / (1.0 - 0.6 * p * returned);
        near("under glass", at(&glass, f).0, expected, 1e-4);
    }
    // An edge: of the half that is sharp, and the half with the exponential line spread.
    let edge = bare.views[0].states.get("white").unwrap().scalars.edge_10_90_x_um.unwrap();
    near("edge", edge, 2.0 * 30.0 * 2.5_f64.ln(), 2.0);
}

/// Nothing changes without spread, and little with little.
#[test]
fn vanishing_spread_changes_nothing() {
    let without =
        sharpness(&[GLASS, MATRIX, &paper(0.0).replace("spread_um = 0\n", ""), DIFFUSE, VIEW]).unwrap();
    let none = sharpness(&[GLASS, MATRIX, &paper(0.0), DIFFUSE, VIEW]).unwrap();
    assert_eq!(without, none);
    let little = sharpness(&[GLASS, MATRIX, &paper(0.01), DIFFUSE, VIEW]).unwrap();
    for f in [0.1, 1.0, 5.0] {
        near("little", at(&little, f).0, at(&none, f).0, 1e-3);
    }
    let contrast = |result: &MtfResult| result.views[0].line_contrast.white_1_x.unwrap();
    near("line", contrast(&little), contrast(&none), 2e-3);
}

/// Paths and frequencies agree: a small change, lines, halftones, below glass and a front that reflects
/// light.
#[test]
fn paths_agree_with_frequencies() {
    let pattern = "[pattern]\nperiod_mm = [0.1, 0.4]\nkind = [\"stripes\"]\n";
    let front = "[[display.front]]\nreflectance = 0.1\ngap_mm = 0.3\n";
    for parts in papilio_testing::everyday(1, [vec![GLASS], vec![front, GLASS], vec![AIR]]) {
        let pixel = paper(40.0);
        let all = [&parts[..], &[MATRIX, &pixel, DIFFUSE, VIEW, pattern]].concat();
        let adding = sharpness(&all).unwrap();
        let solver = paths();
        let walked = sharpness(&[&all[..], &[&solver[..]]].concat()).unwrap();
        for f in [0.5, 1.0, 2.0, 5.0] {
            let ((found, error), (expected, _)) = (at(&walked, f), at(&adding, f));
            assert!((found - expected).abs() < 5.0 * error + 1e-4, "{f}: {found} +- {error}, {expected}");
        }
        for (found, expected) in walked.patterns.iter().zip(&adding.patterns) {
            let error = found.error.max(expected.error);
            near("mean of stripes", found.mean_Y, expected.mean_Y, 5.0 * error + 1e-4);
        }
        let [found, expected] = [&walked, &adding].map(|result| &result.views[0]);
        let error = found.line_contrast_error.black_1_x.unwrap();
        let [a, b] = [found, expected].map(|view| view.line_contrast.black_1_x.unwrap());
        near("line", a, b, 5.0 * error + 2e-3);
    }
}

/// Fine halftones have the formulae of print: without a face Yule and Nielsen's of n = 2.
#[test]
fn fine_halftones_mix_by_their_roots() {
    let pattern = "[pattern]\nperiod_mm = [0.001, 0.01, 100]\nkind = [\"stripes\"]\n";
    let result = sharpness(&[AIR, MATRIX, &paper(1000.0), DIFFUSE, VIEW, pattern]).unwrap();
    let root = 0.5 * (0.6_f64.sqrt() + 0.03_f64.sqrt());
    let means: Vec<f64> = result.patterns.iter().map(|one| one.mean_Y).collect();
    near("fine", means[0], root * root, 1e-6);
    near("nearly fine", means[1], root * root, 1e-5);
    near("coarse", means[2], 0.315, 0.01);
}

/// The contrast of figures by both roads.
#[test]
fn crosstalk_agrees_with_paths() {
    let of = |solver: &str| -> CrosstalkResult {
        let resolved = resolved(&[GLASS, MATRIX, &paper(60.0), DIFFUSE, VIEW, solver]);
        let control = Control { threads: Some(2), progress: &|_| {}, stop: &AtomicBool::new(false) };
        crosstalk(&resolved.scene, "l", &control).unwrap()
    };
    let [adding, walked] = [of(""), of(&paths())];
    for figure in [Figure::Stripe, Figure::Line] {
        let found = |result: &CrosstalkResult| {
            let pattern = result.views[0].patterns.iter().find(|one| one.name == figure).unwrap();
            (pattern.values.contrast_ratio.unwrap(), pattern.error.contrast_ratio.unwrap())
        };
        let ((expected, _), (value, error)) = (found(&adding), found(&walked));
        near("contrast ratio", value, expected, 5.0 * error + 0.01 * expected);
    }
    // A picture of every second column black, by cells that are the pixels.
    let display = resolved(&[GLASS, MATRIX, &paper(60.0), DIFFUSE, VIEW]);
    let control = Control { threads: Some(2), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let page = Picture { count: [8, 6], states: (0..48).map(|k| k % 2).collect() };
    let seen = picture(&display.scene, &page, Precision::FINE, &control).unwrap();
    let ratio = f64::from(seen.views[0][8][1]) / f64::from(seen.views[0][9][1]);
    let stripe = walked.views[0].patterns.iter().find(|one| one.name == Figure::Stripe).unwrap();
    let (value, error) = (stripe.values.contrast_ratio.unwrap(), stripe.error.contrast_ratio.unwrap());
    near("contrast ratio of a picture", ratio, value, 5.0 * error + 0.01 * value);
}

/// A picture of columns has the mean of stripes, and uniform pictures the colours of pages.
#[test]
fn pictures_have_means_of_patterns() {
    let stripes = "[pattern]\nperiod_mm = [0.4]\nkind = [\"stripes\"]\n";
    for cover in [GLASS, AIR] {
        let pixel = paper(50.0);
        let parts = [cover, MATRIX, &pixel, DIFFUSE, VIEW];
        let display = resolved(&parts);
        let control = Control { threads: Some(2), progress: &|_| {}, stop: &AtomicBool::new(false) };
        let of = |states: Vec<u8>| {
            let page = Picture { count: [8, 6], states };
            picture(&display.scene, &page, Precision::FINE, &control).unwrap()
        };
        let run = common::run(&display.scene).unwrap();
        for state in 0..2_u8 {
            let value = &run.views[0].states.iter().nth(usize::from(state)).unwrap().1.value;
            near("page", f64::from(of(vec![state; 48]).views[0][9][1]), value.Y, 5e-5);
        }
        let columns = of((0..48).map(|k| k % 2).collect());
        let mean = columns.views[0].iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / 48.0;
        let expected = sharpness(&[&parts[..], &[stripes]].concat()).unwrap().patterns[0].mean_Y;
        near("columns", mean, expected, 3e-4);
    }
}

/// Inks that were measured through a face, below the same face, give the measured values back: by adding and
/// by paths.
#[test]
fn inks_below_the_face_give_the_measured_values_back() {
    let pixel = |specular: &str| {
        format!(
            "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = {{ white = 0.4, grey = 0.18, black = 0.06 }}\n\
             measured_through = {{ index = 1.5, specular = \"{specular}\" }}\n"
        )
    };
    let eight = "[viewer]\ntheta_deg = 8\nfield_deg = 0\n";
    for (specular, front) in [("included", 0.0), ("excluded", 0.040_002)] {
        for solver in ["", &paths()[..]] {
            let display = resolved(&[GLASS, &pixel(specular), DIFFUSE, eight, solver]);
            let run = common::run(&display.scene).unwrap();
            for (name, measured) in [("white", 0.4), ("grey", 0.18), ("black", 0.06)] {
                let state = run.views[0].states.get(name).unwrap();
                // An instrument that excludes the specular component does not see the image of the room in
                // the face.
                let tolerance = if solver.is_empty() { 2e-5 } else { 5.0 * state.standard_error.Y + 1e-5 };
                near(name, state.value.Y - front, measured, tolerance);
            }
        }
    }
}

/// The same with L*, a*, b* of a palette: the lightness and the colour that were measured are seen.
#[test]
fn palettes_below_the_face_give_the_measured_colours_back() {
    let folder = tempfile::tempdir().unwrap();
    let measured = [("white", [72.0, -2.0, 4.0]), ("red", [48.0, 30.0, 18.0]), ("black", [32.0, 1.0, -3.0])];
    let rows = measured.map(|(name, [l, a, b])| format!("{name},{l},{a},{b}\n"));
    std::fs::write(folder.path().join("palette.csv"), format!("state,L,a,b\n{}", rows.concat())).unwrap();
    for (specular, front) in [("included", 0.0), ("excluded", 0.040_002)] {
        let text = format!(
            "{GLASS}[display.pixel]\nmodel = \"palette\"\nfile = \"palette.csv\"\nilluminant = \"D50\"\n\
             measured_through = {{ index = 1.5, specular = \"{specular}\" }}\n\
             [lighting]\nilluminance_lx = 500\nspectrum = \"D50\"\ndiffuse = 1.0\n[viewer]\ntheta_deg = 8\nfield_deg = 0\n"
        );
        let display =
            Scenario::from_text(&text, "palette.toml", folder.path(), &[]).unwrap().resolve().unwrap();
        let run = common::run(&display.scene).unwrap();
        for (name, [l, a, b]) in measured {
            let value = &run.views[0].states.get(name).unwrap().value;
            // CIE 15: Y of L*.
            near(name, value.Y - front, ((l + 16.0) / 116.0_f64).powi(3), 2e-4);
            if front == 0.0 {
                for (found, expected) in
                    [(value.L_star.unwrap(), l), (value.a_star.unwrap(), a), (value.b_star.unwrap(), b)]
                {
                    near(name, found, expected, 0.1);
                }
            }
        }
    }
}
