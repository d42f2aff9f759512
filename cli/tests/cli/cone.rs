//! `run --cone` and `brdf`: maps over all directions, and their files.

use std::fs;
use std::process::Stdio;

use papilio_figures::HAS_PNG;
use papilio_testing::sized;

use crate::common::{
    COARSE, files, names, papilio_command as papilio, run_scenario as run, same, scenario, stderr,
};

#[test]
fn cone_option_adds_cone_files_and_png_option_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let out = ["--out", folder.path().to_str().unwrap()];
    let png: &[&str] = if HAS_PNG { &["--png"] } else { &[] };
    let view = ["--set", "viewer.theta_deg=8", "--set", "viewer.phi_deg=0"];
    let output = run("indoor", &[&out[..], &COARSE, &view, &["--cone"], png].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("cone: 90 x 72 directions"), "{printed}");
    let cone = ["cone.csv", "cone.json", "cone.npy", "cone.png", "cone.svg"];
    let there = names(folder.path());
    for name in cone.iter().chain(&["overview.png", "overview.svg"]) {
        let expected = HAS_PNG || !name.ends_with(".png");
        assert_eq!(there.iter().any(|n| n == name), expected, "{name} among {there:?}");
    }
    // At the scenario's own view, the cone says what the run says.
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let rows = read("cone.csv");
    assert_eq!(rows.lines().count(), 1 + 90 * 72 * 8);
    let result: serde_json::Value = serde_json::from_str(&read("result.json")).unwrap();
    let white = &result["views"][0]["states"]["white"];
    let row: Vec<&str> = rows.lines().find(|row| row.starts_with("8,0,white,")).unwrap().split(',').collect();
    for (cell, key) in row[3..7].iter().zip(["Y", "luminance_cd_m2", "u_prime", "v_prime"]) {
        let (cell, value): (f64, f64) = (cell.parse().unwrap(), white[key].as_f64().unwrap());
        // Two levels of discretisation may differ by the target of either.
        assert!((cell - value).abs() < 2e-3 * value, "{key}: {cell} in the cone, {value} in the run");
    }
    // Without --png the cone has none, and the next run has no cone: the old one's would be mistaken for its own.
    assert!(run("indoor", &[&out[..], &COARSE, &["--cone"]].concat()).status.success());
    let vector = names(folder.path());
    assert!(vector.contains(&"cone.svg".to_owned()) && vector.iter().all(|name| !name.ends_with(".png")));
    assert!(run("indoor", &[&out[..], &COARSE].concat()).status.success());
    assert!(names(folder.path()).iter().all(|name| !name.starts_with("cone") && !name.ends_with(".png")));
}

#[test]
fn brdf_writes_a_bsdf_file_that_can_be_inspected() {
    let folder = tempfile::tempdir().unwrap();
    let brdf = |more: &[&str]| {
        let mut command = papilio();
        command.arg("brdf").arg(scenario("indoor")).arg("--out").arg(folder.path());
        command.args(COARSE).args(more).output().unwrap()
    };
    let output = brdf(&["--step", "10"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        String::from_utf8(output.stdout).unwrap().contains("directional-hemispherical reflectance / regular")
    );
    assert_eq!(names(folder.path()), ["about.json", "display-bsdf.npz", "reflection.csv"]);
    // 8 states, 9 x 9 x 19 directions, 21 wavelengths, 4 bytes each.
    let bytes = fs::metadata(folder.path().join("display-bsdf.npz")).unwrap().len();
    let table = 8 * 9 * 9 * 19 * 21 * 4;
    assert!((table..table + 50_000).contains(&bytes), "{bytes}");
    for (step, why) in [("0.5", "numbers"), ("7", "divides 90")] {
        let output = brdf(&["--step", step]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(why), "{}", stderr(&output));
    }
}

/// The direction with which colours are compared is checked before anything is computed.
#[test]
fn reference_direction_of_a_cone_is_checked() {
    for (wrong, expected) in
        [("90", "from 0 to below 90 deg"), ("8,x", "such as 8 or 30,90"), ("-3", "from 0")]
    {
        let output = run("epaper", &["--cone", "--cone-reference", wrong]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
    assert_eq!(run("epaper", &["--cone-reference", "8"]).status.code(), Some(2));
}

/// A table and a map of general layers that are killed once rows are saved: the same command says how many rows it
/// knows, writes the same bytes as without a kill, and leaves no journal.
#[test]
fn killed_tables_and_maps_are_resumed() {
    for (command, stem) in [
        (&["run", "--cone"][..], "cone"),
        (&["brdf", "--step", "15"], "brdf"),
        // Takes seconds.
        (&["brdf", "--format", "radiant", "--step", "30"], "brdf"),
    ]
    .into_iter()
    .take(sized(2, 3))
    {
        let folder = tempfile::tempdir().unwrap();
        let start = |out: &str| {
            let mut program = papilio();
            program.args(command).arg(scenario("rough-glass")).args(["--set", "spectrum.step_nm=50"]);
            // Files have the name of their folder in them.
            program.args(["--threads", "1", "--out"]).arg(folder.path().join(out).join("out"));
            program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
        };
        assert!(start("whole").wait().unwrap().success(), "{command:?}");
        let expected = files(&folder.path().join("whole/out"));
        assert!(!expected.contains_key(&format!("{stem}.jsonl")));
        let journal = folder.path().join("killed/out").join(stem).with_extension("jsonl");
        let mut child = start("killed");
        // The head, and rows.
        while fs::read_to_string(&journal).map_or(0, |text| text.lines().count()) < 4 {
            assert!(child.try_wait().unwrap().is_none(), "{command:?}: no row was saved");
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let output = start("killed").wait_with_output().unwrap();
        let said = stderr(&output);
        assert!(output.status.success() && said.contains(" rows are known from"), "{command:?}: {said}");
        same(&files(&folder.path().join("killed/out")), &expected);
    }
}
