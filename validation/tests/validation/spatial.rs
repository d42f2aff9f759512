//! Comparison of the two solvers on a family of random displays with places: lobes, bare faces, mirror-like
//! and Lambertian pixels, all thicknesses, kinds of light and views. `papilio mtf` is compared with Monte
//! Carlo, and the z-scores must be distributed as Student's t.

use std::sync::atomic::AtomicBool;

use papilio_display::Control;
use papilio_display::spatial::walk::{Mean, pattern, transfer};
use papilio_display::spatial::{PatternKind, mtf};
use papilio_scenario::{Resolved, Scenario};
use papilio_testing::{Dice, assert_student};
use papilio_transport::walk::places::{Shape, TwoStates};
use rayon::prelude::*;

/// Seed of the family; it is never changed.
const FAMILY: u64 = 0x5ace_0001;

/// Error of tables and of the step between wavelengths, as a fraction of the light.
const TABLES: f64 = 1e-6;

/// A display, its light and its view, as text.
fn scenario(number: u64) -> String {
    let mut dice = Dice::new(FAMILY, number);
    let mirror = dice.one_in(2);
    let lobe = dice.one_in(2);
    let mut text = "[spectrum]\nstep_nm = 40\n".to_owned();
    if lobe {
        let (haze, transmittance) = (dice.between(0.3, 0.95), dice.between(0.7, 1.0));
        text += "[display.diffuser]\nmodel = \"k-correlation\"\n";
        text += &format!("haze = {haze:.3}\ntransmittance = {transmittance:.3}\n");
    }
    let (index, thickness) = (dice.between(1.3, 1.8), dice.log_between(0.05, 3.0));
    text += &format!("[display.glass]\nindex = {index:.3}\nthickness_mm = {thickness:.4}\n");
    if !lobe {
        text += "surface = \"fresnel\"\n";
    }
    let kind = if mirror { "mirror" } else { "lambertian" };
    let (white, black) = (dice.between(0.3, 0.9), dice.between(0.01, 0.2));
    text += &format!("[display.pixel]\nmodel = \"uniform\"\nkind = \"{kind}\"\n");
    text += &format!("reflectance = {{ white = {white:.3}, black = {black:.3} }}\n");
    let diffuse = if dice.one_in(3) { 1.0 } else { dice.between(0.0, 0.9) };
    text += &format!("[lighting]\nspectrum = \"D65\"\nilluminance_lx = 500\ndiffuse = {diffuse:.3}\n");
    if diffuse < 1.0 {
        let (theta, phi) = (dice.between(0.0, 60.0), dice.between(0.0, 360.0));
        text += &format!("[[lighting.directed]]\ntheta_deg = {theta:.2}\nphi_deg = {phi:.2}\n");
        text += &format!("share = {:.3}\n", 1.0 - diffuse);
        if dice.one_in(2) {
            text += &format!("radius_deg = {:.2}\n", dice.log_between(0.5, 12.0));
        }
    }
    let (theta, phi) = (dice.between(0.0, 60.0), dice.between(0.0, 360.0));
    text += &format!("[viewer]\ntheta_deg = {theta:.2}\nphi_deg = {phi:.2}\n");
    let periods = [0.3, 8.0].map(|times| thickness * dice.between(times, 3.0 * times));
    text += "[pattern]\nkind = [\"stripes\", \"checkerboard\"]\n";
    text += &format!("period_mm = [{:.4}, {:.4}]\n[solver]\nseed = {number}\n", periods[0], periods[1]);
    text
}

/// A number by Monte Carlo, and by the other solver with its error.
type Pair = (Mean, [f64; 2]);

/// A deviation in units of its error, if most of that is noise.
fn z((walk, [exact, error]): Pair) -> Option<f64> {
    let of_other = error.hypot(TABLES);
    (walk.standard_error > 3.0 * of_other).then(|| (walk.value - exact) / walk.standard_error.hypot(of_other))
}

/// Numbers of a member: transfer of small changes, then means of patterns.
fn compare(number: u64, resolved: &Resolved) -> [Vec<Pair>; 2] {
    const PATHS: u64 = 1 << 14;
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let exact = mtf(&resolved.scene, &resolved.patterns, &control).unwrap();
    let view = &exact.views[0];
    let count = exact.frequency_per_mm.len();
    // From where the thickness is half a period. What is missing to 1 at lower frequencies is rare light from
    // far away: with these paths its mean and its error are both too small, and approach those of the other
    // solver only with a hundred times as many.
    let thickness = resolved.scene.display.lengths_mm().unwrap()[0];
    let first = exact.frequency_per_mm.partition_point(|f| f * thickness < 0.5).min(count - 1);
    let at: Vec<usize> = (0..3).map(|k| (first + 7 * k + number as usize % 5).min(count - 1)).collect();
    let axis = number as usize % 2;
    let along = |k: &usize| {
        let f = exact.frequency_per_mm[*k];
        if axis == 0 { [f, 0.0] } else { [0.0, f] }
    };
    let frequencies: Vec<[f64; 2]> = at.iter().map(along).collect();
    let found = transfer(&resolved.scene, &frequencies, PATHS, &control).unwrap();
    let mut transfers = Vec::new();
    for (name, state) in view.states.iter() {
        let found = &found[0].states.get(name).unwrap().response;
        for (k, otf) in at.iter().zip(&found.otf) {
            let curves = &state.otf;
            let (exact, error) = if axis == 0 {
                (curves.otf_x[*k], curves.error_x[*k])
            } else {
                (curves.otf_y[*k], curves.error_y[*k])
            };
            transfers.extend([0, 1].map(|part| (otf[part], [exact[part], error])));
        }
    }
    let mean = |exact: &papilio_display::spatial::PatternMean| {
        let shape = match exact.kind {
            PatternKind::Stripes => Shape::Stripes,
            PatternKind::Checkerboard => Shape::Checkerboard,
        };
        let shown = TwoStates { shape, period_mm: exact.period_mm, states: [0, 1] };
        let found = pattern(&resolved.scene, &shown, PATHS, &control).unwrap();
        (found[0].via_pixel[0], [exact.mean_Y_via_pixel, exact.error])
    };
    [transfers, view.patterns.iter().map(mean).collect()]
}

/// 6.5 of Student's 31 degrees of freedom happens to one number in 5 million.
#[test]
fn random_displays_with_places_have_student_distributed_deviations() {
    let members = if std::env::var_os("PAPILIO_STACKS").is_some() { 100 } else { 6 };
    let folder = tempfile::tempdir().unwrap();
    let scores = |number: u64| {
        let text = scenario(number);
        let file = folder.path().join(format!("{number}.toml"));
        std::fs::write(&file, &text).unwrap();
        let resolved = Scenario::load(&file, &[]).unwrap().resolve().unwrap();
        let [transfers, patterns] = compare(number, &resolved);
        for (k, pair) in transfers.iter().chain(&patterns).enumerate() {
            let off = z(*pair).unwrap_or_else(|| (pair.0.value - pair.1[0]) / (pair.0.standard_error + 1e-4));
            assert!(off.abs() < 6.5, "member {number}, number {k}: {pair:?}\n{text}");
        }
        // One number of each kind: those of a member are not independent.
        let one = |pairs: &[Pair]| {
            let turned = (0..pairs.len()).map(|k| pairs[(k + number as usize) % pairs.len()]);
            turned.filter_map(z).next()
        };
        [one(&transfers), one(&patterns)]
    };
    let all: Vec<[Option<f64>; 2]> = (0..members).into_par_iter().map(scores).collect();
    for (k, what) in ["transfer", "patterns"].into_iter().enumerate() {
        let scores: Vec<f64> = all.iter().filter_map(|pair| pair[k]).collect();
        println!("{what}: {} scores, {scores:.1?}", scores.len());
        if scores.len() > 1 {
            assert_student(what, &scores, scores.len() as f64);
        }
    }
}
