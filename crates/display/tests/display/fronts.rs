//! Sharpness with light that a front of screen returns, and in a front light: against paths, closed forms,
//! and colours.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::Control;
use papilio_display::spatial::walk::{self, Mean};
use papilio_display::spatial::{MtfResult, SpatialScalars, crosstalk, mtf};
use papilio_scenario::{Resolved, Scenario};
use papilio_testing::{everyday, seeds, sized};
use papilio_transport::walk::places::{Shape, TwoStates};

use crate::common;

const LOBE: &str = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.05667\ntransmittance = 1.0\n";
const MIRROR: &str =
    "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.8, black = 0.1 }\n";
const PAPER: &str = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.6, black = 0.03 }\n";
const BARE: &str = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\nthickness_mm = 0.4\n";
const COATED: &str = "[display.glass]\nindex = 1.5\nsurface = \"coated\"\nthickness_mm = 0.4\n";
const FRONT: &str = "[[display.front]]\nreflectance = 0.3\ngap_mm = 0.2\n";
const OBLIQUE: &str = "[viewer]\ntheta_deg = 40\nphi_deg = 30\nfield_deg = 0\n";
const LIGHT: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 1.0\n";
const MATRIX: &str = "[display.matrix]\nppi = 300\n";

fn resolved(parts: &[&str]) -> Resolved {
    let text = format!("[spectrum]\nstep_nm = 40\n{}", parts.concat());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    Scenario::from_text(&text, "fronts.toml", &folder, &[]).unwrap().resolve().unwrap()
}

fn control(stop: &AtomicBool) -> Control<'_> {
    Control { threads: Some(2), progress: &|_| {}, stop }
}

fn computed(scenario: &Resolved) -> MtfResult {
    mtf(&scenario.scene, &scenario.patterns, &control(&AtomicBool::new(false))).unwrap()
}

/// Compares the transfer functions of both solvers in two numbers of each frequency: deviations over their
/// common error, which is that of paths and the stated one.
fn deviations(scenario: &Resolved, exact: &MtfResult, paths: u64) -> Vec<f64> {
    let wanted = [0.1, 0.5, 1.0, 2.0, 5.0].map(|f| {
        let distance = |k: &usize| (exact.frequency_per_mm[*k] - f).abs();
        (0..exact.frequency_per_mm.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
    });
    let mut all = Vec::new();
    for axis in [0, 1] {
        let along = |f: f64| if axis == 0 { [f, 0.0] } else { [0.0, f] };
        let frequencies = wanted.map(|k| along(exact.frequency_per_mm[k]));
        let stop = AtomicBool::new(false);
        let found = walk::transfer(&scenario.scene, &frequencies, paths, &control(&stop)).unwrap();
        for (state, exact) in exact.views[0].states.iter() {
            let found = found[0].states.get(state).unwrap();
            let (otf, stated) = match axis {
                0 => (&exact.otf.otf_x, &exact.otf.error_x),
                _ => (&exact.otf.otf_y, &exact.otf.error_y),
            };
            for (k, found) in wanted.iter().zip(&found.response.otf) {
                for (part, Mean { value, standard_error }) in found.iter().enumerate() {
                    let off = (otf[*k][part] - value).abs();
                    let z = (off - stated[*k]).max(0.0) / (standard_error + 1e-5);
                    all.push(z);
                }
            }
        }
    }
    all
}

/// Paper and mirrors below a bare face and a front above a gap, seen obliquely, through all orders: as seen
/// by paths.
#[test]
fn what_flat_fronts_return_is_seen_by_paths() {
    for pixel in [PAPER, MIRROR] {
        for seed in 0..seeds().div_ceil(8) {
            let solver = format!("[solver]\nseed = {seed}\nrelative_error = 1e-4\n");
            let scenario = resolved(&[FRONT, BARE, pixel, LIGHT, OBLIQUE, &solver]);
            let exact = computed(&scenario);
            let all = deviations(&scenario, &exact, 1 << 15);
            let worst = all.iter().copied().fold(0.0, f64::max);
            // Where flat faces alone return light, a few random numbers move all transfers of a seed
            // together: how many of them are beyond two errors says nothing, but their mean square is that of
            // these few.
            let mean_square = all.iter().map(|z| z * z).sum::<f64>() / all.len() as f64;
            assert!(worst < 4.5 && mean_square < 9.0, "{pixel} {seed}: {worst}, mean square {mean_square}");
            // What is stated is a bound of the discretisation, not of the noise of paths.
            assert!(exact.error_reached < 1e-4);
        }
    }
}

/// Below a lobe what the front returns later is estimated, with a stated error that covers the difference
/// from paths; the error is about the product of the reflectances.
#[test]
fn what_fronts_return_through_a_lobe_is_within_its_stated_error() {
    let front = "[[display.front]]\nreflectance = 0.05\ngap_mm = 0.2\n";
    for pixel in [PAPER, MIRROR] {
        let scenario = resolved(&[front, LOBE, COATED, pixel, LIGHT, OBLIQUE]);
        let exact = computed(&scenario);
        let worst = deviations(&scenario, &exact, 1 << 15).into_iter().fold(0.0, f64::max);
        assert!(worst < 4.5, "{pixel}: {worst}");
        // At most as if all that returns had the opposite phase.
        let error = exact.error_reached;
        assert!(error < 2.0 * 0.05 * 0.8, "{pixel}: {error}");
    }
}

/// Components of a front that are apart reflect light between each other: images of all orders in transfers, lines and text, seen
/// obliquely by paths, of a narrow and a wide field (which takes minutes where more light goes to and fro, as below a reflectance of 0.3).
#[test]
fn fronts_that_are_apart_above_a_lobe_show_images() {
    let front =
        |part: f64, gap_mm: f64| format!("[[display.front]]\nreflectance = {part}\ngap_mm = {gap_mm}\n");
    let lamp = "[lighting]\ndiffuse = 0.6\n[[lighting.directed]]\ntheta_deg = -25\nshare = 0.4\n";
    let glass = "[display.glass]\nindex = 1.5\nthickness_mm = 0.3\n";
    let cases = [(PAPER, 0.0, 0.3, 4.0), (MIRROR, 0.0, 0.3, 4.0), (PAPER, 4.0, 0.15, 1.0)];
    for (pixel, field_deg, part, gap_mm) in everyday(1, cases) {
        let view = format!("[viewer]\ntheta_deg = 15\nfield_deg = {field_deg}\n");
        let matrix = "[display.matrix]\nppi = 200\n";
        let parts = [&front(part, gap_mm), &front(part, 0.1), LOBE, glass, pixel, lamp, &view, matrix];
        let scenario = resolved(&parts);
        let exact = computed(&scenario);
        let worst = deviations(&scenario, &exact, 1 << 15).into_iter().fold(0.0, f64::max);
        assert!(worst < 4.5, "{pixel} {field_deg}: {worst}");
        let solver = "[solver]\nmethod = \"monte-carlo\"\npaths = 32768\n";
        let paths = computed(&resolved(&[&parts[..], &[solver]].concat()));
        let all = |result: &MtfResult| {
            let view = &result.views[0];
            let errors = view.line_contrast_via_pixel_error.named();
            let lines = view.line_contrast_via_pixel.named().zip(errors);
            let mut all: Vec<_> =
                lines.map(|((_, line), (_, error))| (line.unwrap(), error.unwrap())).collect();
            let error = view.text_contrast_via_pixel_error.unwrap();
            all.push((view.text_contrast_median_via_pixel.unwrap(), error[1]));
            all
        };
        for ((value, stated), (path, error)) in all(&exact).into_iter().zip(all(&paths)) {
            let z = ((value - path).abs() - stated) / error;
            assert!(z < 4.5, "{pixel} {field_deg}: {value} +- {stated}, {path} +- {error}");
        }
    }
}

/// The metrics, too: where the estimate crosses the shape of the first order, the broader one still differs from it.
#[test]
fn sharpness_below_fronts_and_lobes_is_within_its_stated_errors() {
    let front = "[[display.front]]\nreflectance = 0.15\ngap_mm = 0.2\n";
    let lamp = "[lighting]\ndiffuse = 0.5\n[[lighting.directed]]\ntheta_deg = -35\nshare = 0.5\n";
    let view = "[viewer]\ntheta_deg = 0\n";
    let film = "[display.pixel]\nmodel = \"film\"\nsubstrate = \"Al\"\narea = { red = 0.4, green = 0.35, blue = 0.25 }\n\
        gap_nm = { red = 275, green = 192, blue = 138, dark = 20 }\nfilm = [ { material = 2.0, thickness_nm = 56 }, \
        { material = \"SiO2\", thickness_nm = 38 }, { material = \"air\", thickness_nm = \"gap\" } ]\n";
    for pixel in everyday(1, [MIRROR, film]) {
        let parts = [front, LOBE, COATED, pixel, lamp, view, MATRIX];
        let of = |solver: &str| computed(&resolved(&[&parts[..], &[solver]].concat()));
        let exact = of("");
        let count = sized(32_768, 65_536);
        let paths = of(&format!("[solver]\nmethod = \"monte-carlo\"\npaths = {count}\n"));
        for ((name, exact), (_, paths)) in exact.views[0].states.iter().zip(paths.views[0].states.iter()) {
            for metric in ["edge_10_90_x_um", "mtf_nyquist_x", "mtf_nyquist_y", "f50_x_per_mm"] {
                let named = |values: &SpatialScalars| {
                    let found = values.named().find(|(name, _)| *name == metric);
                    found.and_then(|(_, value)| value).unwrap()
                };
                let off = (named(&exact.scalars) - named(&paths.scalars)).abs();
                let [stated, standard] = [named(&exact.error), named(&paths.error)];
                assert!(off < stated + 4.0 * standard, "{name} {metric}: {off} {stated} {standard}");
            }
        }
    }
}

/// The mean of fine stripes of paper has the mean reflectance in the place of that of a page, and pages tell
/// what returns (Clapper, Yule); stripes as long as the light spreads are seen by paths.
#[test]
fn patterns_below_fronts_have_their_limits() {
    let pattern = "[pattern]\nkind = [\"stripes\"]\nperiod_mm = [0.002, 0.9]\n";
    for pixel in [PAPER, MIRROR] {
        let scenario = resolved(&[FRONT, BARE, pixel, LIGHT, OBLIQUE, pattern]);
        let result = computed(&scenario);
        let y = |state| result.views[0].states.get(state).unwrap().Y_via_pixel;
        let stop = AtomicBool::new(false);
        for found in &result.patterns {
            let stripes = TwoStates { shape: Shape::Stripes, period_mm: found.period_mm, states: [0, 1] };
            if pixel == PAPER && found.period_mm < 0.01 {
                // Y = g rho/(1 - rho A)
                let [white, black] = [0.6 / y("white"), 0.03 / y("black")];
                let [slope, one] = [(white - black) / 0.57, black - 0.03 * (white - black) / 0.57];
                let expected = 0.315 / (one + 0.315 * slope);
                assert!((found.mean_Y_via_pixel - expected).abs() < 1e-4 * expected, "{found:?} {expected}");
            }
            let seen = &walk::pattern(&scenario.scene, &stripes, 1 << 15, &control(&stop)).unwrap()[0];
            let Mean { value, standard_error } = seen.via_pixel[0];
            let off = (found.mean_Y_via_pixel - value).abs();
            assert!(off < 4.0 * standard_error + found.error + 1e-5, "{pixel} {found:?}: {seen:?}");
            assert!(found.error < 1e-3, "{found:?}");
        }
    }
}

/// A line below a front: darker than its page by what returns, to the solution of [`crosstalk`] with cells of
/// its own.
#[test]
fn crosstalk_below_fronts_has_the_contrast_of_lines() {
    let scenario = resolved(&[FRONT, BARE, PAPER, MATRIX, LIGHT]);
    let result = computed(&scenario);
    let crosstalk = crosstalk(&scenario.scene, " ", &control(&AtomicBool::new(false))).unwrap();
    let [patch, .., line] =
        [0, 1, 2].map(|k| crosstalk.views[0].patterns[k].values.contrast_ratio_via_pixel.unwrap());
    let michelson = result.views[0].line_contrast_via_pixel.black_1_x.unwrap();
    let ratio = (1.0 + michelson) / (1.0 - michelson);
    assert!((line / ratio - 1.0).abs() < 2e-3, "{line} {ratio}");
    assert!(line < 0.8 * patch, "{line} {patch}");
}

/// A guide below a front that reflects and absorbs: by light, colours and both solvers agree; so does the
/// light that leaks upwards.
#[test]
fn front_lights_have_the_colours_of_a_run() {
    let front = "[[display.front]]\nreflectance = 0.04\nabsorptance = 0.1\ngap_mm = 0.2\n";
    let guide = "[lighting.front_light]\nilluminance_lx = 300\nspectrum = \"D65\"\nupward_leak = 0.1\n";
    for (above, pixel) in [(LOBE, MIRROR), ("", PAPER), ("", MIRROR)] {
        let glass = if above.is_empty() { BARE } else { COATED };
        let scenario = resolved(&[
            front,
            above,
            glass,
            pixel,
            LIGHT,
            guide,
            MATRIX,
            "[solver]\nrelative_error = 1e-5\n",
        ]);
        let colours = common::run(&scenario.scene).unwrap();
        let result = computed(&scenario);
        for (name, state) in result.views[0].states.iter() {
            let terms = &colours.views[0].states.get(name).unwrap().value.terms;
            let y = state.Y_via_pixel;
            let fraction = state.by_light.get("front_light").unwrap().fraction;
            // The guide's own term has the veil of what leaks and the image of the guide in the face, the
            // same in all states.
            let black = result.views[0].states.get("black").unwrap();
            let black_terms = &colours.views[0].states.get("black").unwrap().value.terms;
            let [own, of_black] =
                [(y, fraction), (black.Y_via_pixel, black.by_light.get("front_light").unwrap().fraction)]
                    .map(|(y, fraction)| y * fraction);
            let expected = terms.front_light.unwrap() - black_terms.front_light.unwrap();
            assert!(
                (own - of_black - expected).abs() < 1e-4 * expected.abs() + 1e-9,
                "{name}: {own} {expected}"
            );
        }
        let stop = AtomicBool::new(false);
        let walked = walk::transfer(&scenario.scene, &[[1.0, 0.0]], 1 << 14, &control(&stop)).unwrap();
        let (state, walked) =
            (result.views[0].states.get("white").unwrap(), walked[0].states.get("white").unwrap());
        let k = result.frequency_per_mm.iter().position(|f| (f - 1.0).abs() < 1e-9).unwrap();
        let [re, _] = &walked.response.otf[0];
        let off = (state.otf.otf_x[k][0] - re.value).abs();
        assert!(off < 4.5 * re.standard_error + state.otf.error_x[k] + 1e-4, "{pixel}: {off} {re:?}");
    }
}

/// Mirrors below an ideal face and a front: one ghost, at the sum of the ways through glass and air, with the
/// product of the reflectances.
#[test]
fn front_above_a_clear_face_has_one_ghost_at_a_known_place() {
    let scenario = resolved(&[FRONT, COATED, MIRROR, LIGHT, "[viewer]\ntheta_deg = 40\nfield_deg = 0\n"]);
    let result = computed(&scenario);
    let state = result.views[0].states.get("white").unwrap();
    let beta = 40.0_f64.to_radians().sin();
    let way = 2.0 * (0.4 * beta / (2.25 - beta * beta).sqrt() + 0.2 * beta / (1.0 - beta * beta).sqrt());
    for (f, otf) in result.frequency_per_mm.iter().zip(&state.otf.otf_x) {
        // Of all orders, (1 - q)/(1 - q exp(-2 pi i f way)).
        let (sin, cos) = (2.0 * PI * f * way).sin_cos();
        let q = 0.8 * 0.3;
        let (re, im) = (1.0 - q * cos, q * sin);
        let square = re * re + im * im;
        let expected = [(1.0 - q) * re / square, -(1.0 - q) * im / square];
        let off = (otf[0] - expected[0]).hypot(otf[1] - expected[1]);
        assert!(off < 1e-7, "{f}: {otf:?} {expected:?}");
    }
}
