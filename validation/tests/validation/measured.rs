//! Round trip of a measured diffuser: a simulated instrument measures a known diffuser, and writes a file. A
//! display with this file must have the same metrics as a display with the diffuser itself.
//!
//! A measurement in air ends at |beta| = 1. The lobe continues in the glass, 1 < |beta| < n, and some of this
//! light returns: 0.2 to 0.5 % of the darkest state. `extrapolate = "glass"` extrapolates the tail there.
//!
//! Samples: the synthetic diffusers of haze 65, 78 and 81 %, total transmittance 0.90, over the reference
//! film pixel (scenarios/indoor.toml: half of the light diffuse, half from -20 deg, viewer at 8 deg). The
//! instrument is that of the dissertation (Feng 2012, section 3.3), without blur and noise.
use std::fs::File;
use std::path::{Path, PathBuf};

use papilio_display::result::{RunResult, StateValues};
use papilio_formats::{BsdfFormat, DataFile, LARGEST_BSDF_FILE, read_bsdf, write_measurement};
use papilio_goniometry::{Audit, Channel, Instrument, SyntheticSample};
use papilio_scenario::Scenario;
use papilio_testing::everyday;
use papilio_validation::{run, scenario};

/// Returns hazes, each in air and in glass; every day this many of them. First the narrowest lobe, with a
/// tail in glass.
fn cases(count: usize) -> impl Iterator<Item = (f64, &'static str)> {
    everyday(count, [(0.65, GLASS), (0.81, AIR), (0.65, AIR), (0.81, GLASS), (0.78, AIR), (0.78, GLASS)])
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name)
}

/// A coarse wavelength grid suffices: the differences are the same at all wavelengths.
const COARSE: &str = "spectrum.step_nm=20";

/// Runs the reference display with the sample itself.
fn truth(haze: f64, glass: &str) -> RunResult {
    let haze = format!("display.diffuser.haze={haze}");
    run(&scenario("indoor", &[&haze, glass, ADDING, COARSE]).unwrap().scene).unwrap()
}

/// Runs the reference display with the file of a measurement.
fn under(path: &Path, sets: &[&str]) -> RunResult {
    let text = std::fs::read_to_string(shipped("indoor.toml")).unwrap();
    let (before, rest) = text.split_once("[display.diffuser]").unwrap();
    let (_, after) = rest.split_once("[display.glass]").unwrap();
    let file = path.file_name().unwrap().to_str().unwrap();
    let text = format!(
        "{before}[display.diffuser]\nmodel = \"measured\"\nfile = \"{file}\"\nextrapolate = \"glass\"\n\n\
         [display.glass]{after}"
    );
    let sets: Vec<String> = sets.iter().chain(&[COARSE]).map(|set| (*set).to_owned()).collect();
    let scenario = Scenario::from_text(&text, "measured.toml", path.parent().unwrap(), &sets).unwrap();
    run(&scenario.resolve().unwrap().scene).unwrap()
}

/// Measures a sample at radial distances of this step and writes a file. Returns the error that the audit
/// predicts.
fn measured(haze: f64, radial_deg: f64, path: &Path) -> f64 {
    let mut instrument = Instrument::imaging_sphere();
    instrument.channels = vec![Channel::Monochrome];
    instrument.grid.radials_deg =
        (0..=(180.0 / radial_deg) as u32).map(|k| f64::from(k) * radial_deg).collect();
    let measurement = SyntheticSample::new(haze).unwrap().measured(&instrument, &[1.0]).unwrap();
    let mut file = File::create(path).unwrap();
    assert_eq!(
        write_measurement(&mut file, BsdfFormat::Radiant, &measurement).unwrap(),
        Vec::<String>::new()
    );
    let name = path.file_name().unwrap().to_str().unwrap();
    let read = read_bsdf(&DataFile::open_within(path, name, LARGEST_BSDF_FILE).unwrap()).unwrap();
    Audit::of(&read.value.parts[0], 0).unwrap().grid_error().unwrap()
}

/// Returns the largest relative difference of any metric of any state, and the difference of the gamut in
/// points.
fn differences(found: &RunResult, truth: &RunResult) -> (f64, f64) {
    let [found, truth] = [found, truth].map(|result| &result.views[0]);
    let mut largest = 0.0_f64;
    let mut differ = |name: &str, what: &str, found: f64, truth: f64| {
        let difference = found / truth - 1.0;
        if difference.abs() > 1e-3 {
            println!("{name} {what}: {found:.5} of {truth:.5}, {:.3} %", 100.0 * difference);
        }
        largest = largest.max(difference.abs());
    };
    differ(
        "white/black",
        "contrast",
        found.metrics.contrast_ratio.unwrap(),
        truth.metrics.contrast_ratio.unwrap(),
    );
    for ((name, found), (_, truth)) in found.states.iter().zip(truth.states.iter()) {
        let numbers = |values: &StateValues| {
            [values.Y, values.L_star.unwrap(), values.u_prime.unwrap(), values.v_prime.unwrap()]
        };
        let pairs = numbers(&found.value).into_iter().zip(numbers(&truth.value));
        for (what, (found, truth)) in ["Y", "L*", "u'", "v'"].into_iter().zip(pairs) {
            differ(name, what, found, truth);
        }
    }
    let points = found.metrics.gamut_percent_srgb.unwrap() - truth.metrics.gamut_percent_srgb.unwrap();
    println!("largest {:.3} %, gamut {points:.3} points", 100.0 * largest);
    (largest, points.abs())
}

const AIR: &str = "display.glass.index=1.0";
const GLASS: &str = "display.glass.index=1.5";
const ADDING: &str = "solver.relative_error=1e-4";

#[test]
fn measurement_in_half_degree_steps_reproduces_diffuser() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sample.bsdf");
    for (haze, glass) in cases(1) {
        measured(haze, 0.5, &path);
        println!("haze {haze}, {glass}");
        let (relative, points) = differences(&under(&path, &[glass, ADDING]), &truth(haze, glass));
        assert!(relative < 0.001 && points < 0.02, "{haze}, {glass}: {relative} {points}");
    }
}

/// Light passes a diffuser twice, so that the error is twice that predicted by the audit.
#[test]
fn audit_predicts_error_of_real_grid() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sample.bsdf");
    for (haze, glass) in cases(2) {
        let predicted = measured(haze, 2.0, &path);
        println!("haze {haze}, {glass}, predicted {:.3} %", 100.0 * predicted);
        let (relative, points) = differences(&under(&path, &[glass, ADDING]), &truth(haze, glass));
        // In addition, both solutions have errors of their own.
        assert!(
            relative < 2.0 * predicted + 2e-4 && points < 0.2,
            "{haze}, {glass}: {relative} of {predicted}, {points}"
        );
    }
}

#[test]
fn both_solvers_agree_on_measured_diffuser() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sample.bsdf");
    measured(0.78, 2.0, &path);
    let adding = under(&path, &[ADDING]);
    let walk = under(&path, &["solver.method=monte-carlo", "solver.relative_error=0.003"]);
    for ((name, walk), (_, adding)) in walk.views[0].states.iter().zip(adding.views[0].states.iter()) {
        let numbers = |values: &StateValues| [values.X, values.Y, values.Z];
        let errors = numbers(&walk.standard_error).into_iter().zip(numbers(&adding.value).map(|y| 1e-4 * y));
        let pairs = numbers(&walk.value).into_iter().zip(numbers(&adding.value));
        for ((walk, adding), (standard_error, discretisation)) in pairs.zip(errors) {
            let z = (walk - adding) / standard_error.hypot(discretisation);
            println!("{name}: {walk:.5} {adding:.5} {z:.2}");
            // 24 correlated numbers: Student's t with 31 degrees of freedom exceeds 4.5 with a probability of
            // 1e-4.
            assert!(z.abs() < 4.5, "{name}: {walk} {adding} {z}");
        }
    }
}
