//! `papilio compare`: measured panels next to simulated ones.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn papilio(arguments: &[&Path]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_papilio")).env("NO_COLOR", "1").args(arguments).output().unwrap()
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name)
}

/// Runs the overcast display, viewed at 8 and 20 deg, into `folder`.
fn run_into(folder: &Path) {
    let set = Path::new("viewer.theta_deg=[8, 20]");
    let scenario = shipped("overcast.toml");
    let output = papilio(&[Path::new("run"), &scenario, Path::new("--set"), set, Path::new("--out"), folder]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

fn compare(result: &Path, measured: &Path, more: &[&Path]) -> Output {
    papilio(&[&[Path::new("compare"), result, measured], more].concat())
}

/// The synthetic panel has the deviations that its header states: gaps off by a few nm, more haze, more front
/// reflection. Its differences from the simulation have the signs and sizes that follow from these.
#[test]
fn synthetic_panel_differs_by_its_stated_deviations() {
    let folder = tempfile::tempdir().unwrap();
    let (run, out) = (folder.path().join("run"), folder.path().join("compare"));
    run_into(&run);
    let panel = shipped("data/synthetic-panel.csv");
    let output = compare(&run, &panel, &[Path::new("--out"), &out]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let table = String::from_utf8(output.stdout).unwrap();
    for words in
        ["Under an overcast sky", "seen from 20 deg", "simulated / measured", "rms difference of the peaks"]
    {
        assert!(table.contains(words), "{words} is not in\n{table}");
    }
    assert!(
        String::from_utf8_lossy(&output.stderr)
            .contains("note: not measured: cyan, magenta, yellow at theta 8, 20 deg")
    );
    for name in ["comparison.csv", "comparison-spectra.csv", "compared-spectra_theta8_phi0.svg"] {
        assert!(out.join(name).exists(), "{name}");
    }
    let all: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("comparison.json")).unwrap()).unwrap();
    assert_eq!(all["states"].as_array().unwrap().len(), 10);
    let red = all["states"].as_array().unwrap().iter().find(|one| one["state"] == "red").unwrap();
    // A gap of 271.5 instead of 275.9 nm moves a peak near 690 nm in proportion, by 11 nm; noise adds a
    // little.
    let peaks = ["simulated", "measured"].map(|side| red[side]["peak_nm"].as_f64().unwrap());
    assert!((5.0..17.0).contains(&(peaks[0] - peaks[1])), "{peaks:?}");
    // 0.003 more front reflection in diffuse light adds 0.003 to all states, which matters most for black.
    let black = all["states"].as_array().unwrap().iter().find(|one| one["state"] == "black").unwrap();
    let brighter = -black["difference_Y"].as_f64().unwrap();
    assert!((0.0025..0.004).contains(&brighter), "{brighter}");
    let contrast = &all["views"][0]["contrast_ratio"];
    assert!(contrast[0].as_f64() > contrast[1].as_f64());
}

/// Measured spectra and metrics in two files, with standard deviations: z by row, by metric and of all.
#[test]
fn measurement_with_deviations_in_two_files_has_z() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let scenario = shipped("overcast.toml");
    let output = papilio(&[Path::new("run"), &scenario, Path::new("--out"), &run]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let result: serde_json::Value =
        serde_json::from_slice(&fs::read(run.join("result.json")).unwrap()).unwrap();
    let white = &result["views"][0]["states"]["white"];
    let rows = result["wavelength_nm"].as_array().unwrap().iter();
    let rows = rows.zip(white["reflectance_factor"].as_array().unwrap());
    let mut spectra = "state,wavelength_nm,reflectance_factor,standard_deviation\n".to_owned();
    for (nm, factor) in rows {
        spectra += &format!("white,{nm},{},0.01\n", factor.as_f64().unwrap() + 0.01);
    }
    let contrast = result["views"][0]["contrast_ratio"].as_f64().unwrap();
    let metrics = format!("metric,value,standard_deviation\ncontrast_ratio,{},2\n", contrast - 6.0);
    let files = [("spectra.csv", spectra), ("metrics.csv", metrics)];
    let [spectra, metrics] = files.map(|(name, text)| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    });
    let out = folder.path().join("compared");
    let output = compare(&run, &spectra, &[&metrics, Path::new("--out"), &out]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("rms z") && text.contains("within 2"), "{text}");
    let all: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("comparison.json")).unwrap()).unwrap();
    // The errors of the run are small beside those of the measurement.
    let z = all["states"][0]["z"].as_array().unwrap();
    assert!(z.iter().all(|z| (-1.0..-0.98).contains(&z.as_f64().unwrap())), "{z:?}");
    let of_contrast = all["metrics"][0]["z"].as_f64().unwrap();
    assert!((2.9..=3.0).contains(&of_contrast), "{of_contrast}");
    assert_eq!(all["agreement"]["count"].as_u64().unwrap() as usize, z.len() + 1);
    let svg = fs::read_to_string(out.join("compared-spectra.svg")).unwrap();
    assert!(svg.contains("<polygon"), "the bands of the deviations");
    assert!(out.join("comparison-metrics.csv").exists());
}

/// A scenario instead of a result: it is computed with the measured metrics, and the spread by its `[tolerance]`
/// is a part of z. A bare Lambertian pixel has the reflectance that varies, so that its deviation is that of the key.
#[test]
fn scenario_is_computed_and_its_tolerance_enters_z() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("paper.toml");
    let text = r#"
[display.glass]
index = 1.0
surface = "fresnel"
[display.pixel]
model = "uniform"
kind = "lambertian"
reflectance = { white = 0.45, black = 0.05 }
[tolerance]
[[tolerance.keys]]
key = "display.pixel.reflectance.white"
normal = { sigma = 0.01 }
"#;
    fs::write(&scenario, text).unwrap();
    let data = [
        ("xyz.csv", "state,X,Y,Z,standard_deviation\nwhite,0.4277,0.47,0.49,0.01\n"),
        ("spectrum.csv", "wavelength_nm,white,standard_deviation\n400,0.48,0.0001\n700,0.48,0.0001\n"),
        ("metrics.csv", "metric,value,standard_deviation\nwhite.Y,0.45,0.02\nblack.Y,0.04,0.01\n"),
    ];
    let data = data.map(|(name, text)| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    });
    let output = compare(&scenario, &data[0], &[&data[1], &data[2], Path::new("--json")]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    // 256 displays know a deviation to 5 %.
    let close = |value: &serde_json::Value, expected: f64| {
        let value = value.as_f64().unwrap();
        assert!((value - expected).abs() <= 0.1 * expected.abs() + 1e-6, "{value} {expected}: {all:#}");
    };
    close(&all["states"][0]["z"][1], -0.02 / 0.01_f64.hypot(0.01));
    let spectrum = &all["states"][1];
    spectrum["z"].as_array().unwrap().iter().for_each(|z| close(z, -3.0));
    close(&spectrum["spectrum"]["simulated_deviation"][5], 0.01);
    close(&all["metrics"][0]["simulated_deviation"], 0.01);
    close(&all["metrics"][1]["z"], 1.0);
    // Without the tolerance, the errors of the measurement remain; --set changes the scenario.
    let set = Path::new("display.pixel.reflectance.white=0.48");
    fs::write(&scenario, text.split("[tolerance]").next().unwrap()).unwrap();
    let output = compare(&scenario, &data[0], &[Path::new("--json"), Path::new("--set"), set]);
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let z = all["states"][0]["z"][1].as_f64().unwrap();
    assert!((z - 1.0).abs() < 0.01, "{z}");
}

/// A metric of another command whose table the scenario lacks: the error has the metric's name and line.
#[test]
fn metrics_that_the_scenario_cannot_have_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let measured = folder.path().join("metrics.csv");
    fs::write(&measured, "metric,value\ncontrast_ratio,10\nflip_mean,0.1\n").unwrap();
    let output = compare(&shipped("overcast.toml"), &measured, &[Path::new("--json")]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    let named = "note: the measured metric `flip_mean` (of `papilio image`) needs it: ";
    assert!(said.contains(named) && said.contains("metrics.csv:3:1"), "{said}");
}

/// A metric of a state that the display does not have, and one of a measurement beside the view, are named as such.
#[test]
fn other_states_and_directions_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let measured = folder.path().join("metrics.csv");
    fs::write(&measured, "metric,theta_deg,value\ncontrast_ratio,8.9,10\nWhite.Y,8,0.2\n").unwrap();
    let colours = folder.path().join("white.csv");
    fs::write(&colours, "state,theta_deg,X,Y,Z\nwhite,8.9,0.2,0.2,0.2\nblack,8,0.02,0.02,0.02\n").unwrap();
    let output = compare(&shipped("overcast.toml"), &measured, &[&colours, Path::new("--json")]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("the result has no such state: White.Y at theta 8 deg"), "{said}");
    let beside = "measured beside the view of 8 deg with which it is compared (viewer.theta_deg sets the view): contrast_ratio, white at \
                  theta 8.9 deg";
    assert!(said.contains(beside), "{said}");
}

/// Sparkle of several faces has no one value to compare.
#[test]
fn metric_of_several_faces_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let measured = folder.path().join("metrics.csv");
    fs::write(&measured, "metric,value\nppd,0.05\n").unwrap();
    let output = compare(&shipped("antiglare.toml"), &measured, &[Path::new("--json")]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("`ppd` is of one face and one gap, and [sparkle] has 3"), "{said}");
    assert!(said.contains("for example sparkle.correlation_um = 8"), "{said}");
}

/// The tables of a run, read as a measurement, differ from the run by rounding only.
#[test]
fn tables_of_a_run_compare_as_equal() {
    let folder = tempfile::tempdir().unwrap();
    run_into(folder.path());
    let json = folder.path().join("result.json");
    for (table, most) in [("spectra.csv", 1e-9_f64), ("states.csv", 1e-9)] {
        let output = compare(&json, &folder.path().join(table), &[Path::new("--json")]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let states = all["states"].as_array().unwrap();
        assert_eq!((states.len(), all["left_out"].as_array().unwrap().len()), (16, 0));
        for one in states {
            assert!(one["delta_E_2000"].as_f64().unwrap() < most.sqrt(), "{table}: {one}");
            assert!(one["difference_Y"].as_f64().unwrap().abs() < most, "{table}: {one}");
        }
    }
}

/// CIELAB and wide tables of the result itself, with capital names and without angles, have no difference:
/// L\*, a\*, b\* of states.csv are relative to the same white, and a spectrum in per cent is the same
/// spectrum.
#[test]
fn measurement_in_the_forms_of_instruments_is_compared() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = shipped("overcast.toml");
    let output = papilio(&[Path::new("run"), &scenario, Path::new("--out"), folder.path()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let columns = |table: &str, wanted: &[&str]| -> Vec<Vec<String>> {
        let names: Vec<&str> = table.lines().next().unwrap().split(',').collect();
        let at: Vec<usize> =
            wanted.iter().map(|name| names.iter().position(|other| other == name).unwrap()).collect();
        let row = |line: &str| {
            let cells: Vec<&str> = line.split(',').collect();
            at.iter().map(|at| cells[*at].to_owned()).collect()
        };
        table.lines().skip(1).map(row).collect()
    };
    let mut lab = String::from("b*;Sample;L*;a*\n");
    for row in columns(&read("states.csv"), &["state", "L_star", "a_star", "b_star"]) {
        let [state, l, a, b] = &row[..] else { panic!("{row:?}") };
        lab += &format!("{b};{};{l};{a}\n", state.to_uppercase()).replace('.', ",");
    }
    let spectra = columns(&read("spectra.csv"), &["state", "wavelength_nm", "reflectance_factor"]);
    let of_white: Vec<&Vec<String>> = spectra.iter().filter(|row| row[0] == "white").collect();
    let head: Vec<String> = of_white.iter().map(|row| format!("{} nm", row[1])).collect();
    let cells = of_white.iter().map(|row| (100.0 * row[2].parse::<f64>().unwrap()).to_string());
    let wide = format!("Name,{}\nWhite,{}\n", head.join(","), cells.collect::<Vec<_>>().join(","));
    let columns = of_white.iter().map(|row| format!("{},{}\n", row[1], row[2])).collect::<String>();
    for (text, count, words) in [
        (lab, 8, "in capital letters only"),
        (wide, 1, "are read as per cent"),
        (format!("wavelength_nm,white\n{columns}"), 1, "not measured"),
    ] {
        let file = folder.path().join("measured.csv");
        fs::write(&file, &text).unwrap();
        let output = compare(folder.path(), &file, &[Path::new("--json")]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{text}: {said}");
        let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let states = all["states"].as_array().unwrap();
        assert_eq!(states.len(), count, "{text}");
        assert!(states.iter().all(|one| one["delta_E_2000"].as_f64().unwrap() < 1e-4), "{text}: {states:?}");
        assert!(said.contains(words), "{words}: {said}");
    }
}

#[test]
fn wrong_input_is_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    run_into(folder.path());
    let (run, out) = (folder.path().to_owned(), folder.path().join("out"));
    let measured = folder.path().join("measured.csv");
    for (text, words) in [
        ("state,theta,Y\nwhite,8,0.2\n", ":1:1"),
        ("state,theta_deg,X,Y,Z\nwhite,8,0.2,zero,0.2\n", ":2:13"),
        ("state,theta_deg,X,Y,Z\norange,8,0.2,0.2,0.2\nwhite,50,0.2,0.2,0.2\n", "no such state"),
        (
            "state,theta_deg,X,Y,Z\norange,8,0.2,0.2,0.2\n",
            "measured.csv: no measured state has a counterpart",
        ),
        ("state,theta_deg,X,Y,Z\nwhte,8,0.2,0.2,0.2\n", "did you mean `white` for `whte`?"),
        ("", "expected a first row with the names of the columns"),
    ] {
        fs::write(&measured, text).unwrap();
        let output = compare(&run, &measured, &[Path::new("--out"), &out]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(words), "{words} is not in {said}");
    }
    fs::write(&measured, "state,theta_deg,X,Y,Z\nwhite,8,0.2,0.2,0.2\n").unwrap();
    for result in [folder.path().join("none"), folder.path().join("states.csv")] {
        let output = compare(&result, &measured, &[Path::new("--out"), &out]);
        assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert!(!out.exists());
}

/// Percentages instead of fractions are the most frequent mistake, and neither contrast nor gamut shows it.
/// Figures of an earlier comparison are removed.
#[test]
fn percentages_are_detected_and_old_figures_removed() {
    let folder = tempfile::tempdir().unwrap();
    let (run, out) = (folder.path().join("run"), folder.path().join("compare"));
    run_into(&run);
    let states = fs::read_to_string(run.join("states.csv")).unwrap();
    let mut lines = states.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| names.iter().position(|other| *other == name).unwrap();
    let mut shares = String::from("theta_deg,phi_deg,state,X,Y,Z\n");
    let mut percent = shares.clone();
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let place = ["theta_deg", "phi_deg", "state"].map(|name| cells[at(name)]).join(",");
        let xyz = ["X", "Y", "Z"].map(|name| cells[at(name)].parse::<f64>().unwrap());
        for (text, factor) in [(&mut shares, 1.0), (&mut percent, 100.0)] {
            let [x, y, z] = xyz.map(|value| factor * value);
            text.push_str(&format!("{place},{x},{y},{z}\n"));
        }
    }
    let file = folder.path().join("measured.csv");
    fs::create_dir(&out).unwrap();
    fs::write(out.join("compared-gamuts_theta60_phi0.svg"), "old").unwrap();
    for (text, warns) in [(percent, true), (shares, false)] {
        fs::write(&file, text).unwrap();
        let output = compare(&run, &file, &[Path::new("--out"), &out]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{said}");
        assert_eq!(said.contains("per cent"), warns, "{said}");
    }
    assert!(!out.join("compared-gamuts_theta60_phi0.svg").exists());
}
