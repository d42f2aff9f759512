//! What is refused before work, the numbers of messages, and what an interrupted report leaves.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use papilio_testing::sized;

use super::watch::has_long_number;
use crate::common::papilio_command;

/// Numbers of the user's at the ends of those of a computer, in messages and in the table of a report.
#[test]
fn numbers_of_messages_and_reports_have_exponents() {
    let film = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/indoor.toml");
    for (arguments, says) in [
        (&["tolerance", "--set", "tolerance.samples=1e300"][..], "1e300"),
        (&["optimize", "--set", "optimize.evaluations=1e300"], "1e300"),
        (&["run", "--set", "spectrum.step_nm=1e-300"], "1e-300"),
        (&["run", "--set", "spectrum.range_nm=[1e-300,780]"], "1e-300"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let output = papilio_command()
            .arg(arguments[0])
            .arg(&film)
            .args(&arguments[1..])
            .arg("--out")
            .arg(folder.path().join("results"))
            .output()
            .unwrap();
        let said =
            format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(said.contains(says) && !has_long_number(&said), "{arguments:?}: {said}");
    }
}

/// The table of a liquid crystal for maps of all directions, whose memory is known from its states and wavelengths.
#[test]
fn map_of_a_liquid_crystal_beyond_a_gigabyte_is_refused_with_its_key() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/mip-lcd.toml");
    let folder = tempfile::tempdir().unwrap();
    let mut program = papilio_command();
    program.arg("run").arg(file).args(["--cone", "--set", "spectrum.step_nm=1", "--out"]);
    let output = program.arg(folder.path().join("out")).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    for word in ["2 states at 401 wavelengths", "spectrum.step_nm", "--allow-long"] {
        assert!(!output.status.success() && said.contains(word), "{said}");
    }
}

/// Numbers in range that would take hours, or names of files that are too long.
#[test]
fn what_would_take_hours_is_refused_with_its_key() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let run = |command: &str, file: &str, sets: &[&str]| {
        let folder = tempfile::tempdir().unwrap();
        let mut program = papilio_command();
        program.arg(command).arg(root.join(file)).arg("--out").arg(folder.path().join("out"));
        sets.iter().for_each(|set| _ = program.args(["--set", set]));
        program.output().unwrap()
    };
    for (command, file, sets, words) in [
        (
            "run",
            "scenarios/map.toml",
            &["display.diffuser.haze=1e-4"][..],
            &["--set #1:1:23", "at least 0.0002 (`width` or `haze`)", "depends on azimuth", "monte-carlo"][..],
        ),
        (
            "gonio",
            "surfaces/prisms.toml",
            &["microgeometry.index_below=1e-6"],
            &["is out of range", "index_below"],
        ),
        ("gonio", "surfaces/etched.toml", &["microgeometry.rms_nm=1e6"], &["are spikes", "correlation_um"]),
        (
            "gonio",
            "surfaces/hemispheres.toml",
            &["microgeometry.radius_um=1e6"],
            &["are flat at a radius of 1000000 um", "`radius_um`"],
        ),
        (
            "run",
            "scenarios/etched-face.toml",
            &["display.layers.0.rms_nm=1e6"],
            &["are spikes", "correlation_um"],
        ),
        (
            "run",
            "scenarios/hazy-face.toml",
            &["display.layers.0.rms_nm=7e4", "display.layers.0.correlation_um=16"],
            &["too many wavelengths", "`rms_nm` of at most"],
        ),
    ] {
        let output = run(command, file, sets);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{command} {file} {sets:?}: {said}");
        for words in words {
            assert!(said.contains(words), "{command} {file} {sets:?}: {said}");
        }
    }
    let output = run("run", "scenarios/auto.toml", &["viewer.theta_deg.0=1e-300", "spectrum.step_nm=20"]);
    assert!(output.status.success(), "{}", String::from_utf8(output.stderr).unwrap());
    assert!(String::from_utf8(output.stdout).unwrap().contains("seen from 1e-300 deg"));
}

/// Work whose counts say that it takes too long, or too much memory: nothing is computed or written.
#[test]
fn work_that_is_known_to_take_too_long_is_refused_before_it_begins() {
    /// What was measured for a fit.
    const MEASURED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/data/synthetic-film.csv");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let paths = ["--set", "solver.method=monte-carlo", "--set", "solver.paths=100000000000"];
    let slab = "display.diffuser={ model = \"slab\", optical_thickness = 1, anisotropy = 0.99, albedo = 1, index = 1.5 }";
    let thickness = "fit.variables=[{ key = \"display.diffuser.optical_thickness\", bounds = [0.5, 2] }]";
    let long_fit = [MEASURED, "--set", slab, "--set", thickness, "--set", "fit.starts=1000"];
    for (command, file, more, key) in [
        ("run", "scenarios/indoor.toml", &paths[..], "solver.paths"),
        ("mtf", "scenarios/matrix.toml", &paths, "solver.paths"),
        ("sweep", "scenarios/sweep.toml", &paths, "sweep.axes"),
        ("gonio", "surfaces/etched.toml", &["--set", "microgeometry.rays=1000000000"], "microgeometry.rays"),
        (
            "tolerance",
            "scenarios/tolerance.toml",
            &["--set", "tolerance.samples=10000000"],
            "tolerance.samples",
        ),
        (
            "optimize",
            "scenarios/optimize.toml",
            &["--set", "optimize.evaluations=100000000"],
            "optimize.evaluations",
        ),
        ("tolerance", "scenarios/tolerance.toml", &["--set", "spectrum.step_nm=0.02"], "spectrum.step_nm"),
        ("fit", "scenarios/fit.toml", &[MEASURED, "--set", "spectrum.step_nm=0.05"], "spectrum.step_nm"),
        ("fit", "scenarios/fit.toml", &long_fit, "fit.starts"),
        (
            "image",
            "scenarios/reader.toml",
            &["--set", "image.samples_per_pixel=8"],
            "image.samples_per_pixel",
        ),
        (
            "run",
            "scenarios/map.toml",
            &["--cone", "--threads", "1", "--set", "display.diffuser.regular_fraction=0.1"],
            "viewer.theta_deg",
        ),
        (
            "run",
            "scenarios/map.toml",
            &[
                "--cone",
                "--solver",
                "monte-carlo",
                "--threads",
                "1",
                "--set",
                "display.diffuser.regular_fraction=0.1",
            ],
            "viewer.theta_deg",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let mut program = papilio_command();
        program.arg(command).arg(root.join(file)).args(more).arg("--out").arg(&out);
        if !more.contains(&"--threads") {
            program.args(["--threads", "1"]);
        }
        let output = program.output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{command}: {said}");
        for words in [key, "--allow-long", "nothing was computed", "expected at most"] {
            assert!(said.contains(words), "{command}: {words}: {said}");
        }
        assert!(!out.exists(), "{command}");
    }
}

/// Paths, rays and samples that would take years: the command ends soon, with a hint, unless `--allow-long` is given.
#[test]
fn work_of_years_is_refused_as_soon_as_its_time_is_known() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let started = |arguments: &[&str], file: &str, out: &Path| {
        let mut program = papilio_command();
        program.env("PAPILIO_PROGRESS_SECONDS", "0.2").args([arguments[0]]).arg(root.join(file));
        program.args(&arguments[1..]).arg("--out").arg(out).stdout(Stdio::null()).stderr(Stdio::piped());
        program.spawn().unwrap()
    };
    let paths = ["run", "--solver", "monte-carlo", "--set", "solver.paths=1000000000000"];
    for (arguments, file) in [
        (&paths[..], "scenarios/indoor.toml"),
        (&["gonio", "--set", "microgeometry.rays=1000000000"], "surfaces/etched.toml"),
        (&["tolerance", "--set", "tolerance.samples=1000000000"], "scenarios/tolerance.toml"),
    ]
    .into_iter()
    .take(sized(1, 3))
    {
        let folder = tempfile::tempdir().unwrap();
        let output = started(arguments, file, folder.path()).wait_with_output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains("--allow-long") || said.contains("at most"), "{arguments:?}: {said}");
    }
    // With `--allow-long`, it is computed.
    let folder = tempfile::tempdir().unwrap();
    let mut child =
        started(&[&paths[..], &["--allow-long"]].concat(), "scenarios/indoor.toml", folder.path());
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    assert!(lines.by_ref().take(8).filter(|line| line.contains("% done")).count() >= 3);
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Ctrl-C while a report is computed, surfaces or displays: exit code 130, and nothing is left in its folder.
#[cfg(unix)]
#[test]
fn an_interrupted_report_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let scenarios = folder.path().join("scenarios");
    let mut program = papilio_command();
    program.args(["validate", "--threads", "1", "--out"]).arg(folder.path());
    let child = program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while !scenarios.join("data/H81-transmission.csv").exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(!scenarios.exists(), "{said}");
}
