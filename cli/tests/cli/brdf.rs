//! Formats of `papilio brdf`: CSV, RGL tensor files with their scene, Klems matrices; mistakes in its
//! options.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{names, papilio_command as papilio, scenario, stderr, stdout};

/// Few wavelengths, and directions where the format has a choice.
fn quick(more: &[&str]) -> &'static [&'static str] {
    let all = &["--set", "spectrum.step_nm=50", "--step", "45"];
    if more.contains(&"klems") { &all[..2] } else { all }
}

fn brdf(name: &str, folder: &Path, more: &[&str]) -> Output {
    let mut command = papilio();
    command.arg("brdf").arg(scenario(name)).arg("--out").arg(folder).args(quick(more));
    command.args(more).output().unwrap()
}

/// `papilio diffuser inspect` reads the file of white in a folder.
fn assert_inspected(folder: &Path) {
    let mut inspect = papilio();
    inspect.args(["diffuser", "inspect"]).arg(folder.join("display-white.bsdf"));
    let output = inspect.arg("--out").arg(folder.join("inspected")).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
}

#[test]
fn csv_has_a_file_for_each_chosen_state() {
    let folder = tempfile::tempdir().unwrap();
    let output = brdf("indoor", folder.path(), &["--format", "csv", "--states", "white,black"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let files =
        ["about.json", "display-black.csv", "display-mirror.csv", "display-white.csv", "reflection.csv"];
    assert_eq!(names(folder.path()), files);
    let text = fs::read_to_string(folder.path().join("display-white.csv")).unwrap();
    // 2 x 2 x 5 directions, 9 wavelengths.
    assert_eq!(text.lines().count(), 1 + 2 * 2 * 5 * 9);
    let mirror = fs::read_to_string(folder.path().join("display-mirror.csv")).unwrap();
    assert_eq!(mirror.lines().count(), 1 + 2 * 2 * 9);
    // The files of other states would be mistaken for those of this command.
    assert!(brdf("indoor", folder.path(), &["--format", "csv", "--states", "red"]).status.success());
    assert_eq!(
        names(folder.path()),
        ["about.json", "display-mirror.csv", "display-red.csv", "reflection.csv"]
    );
}

#[test]
fn rgl_has_a_file_for_each_state_a_mirror_part_and_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let output = brdf("indoor", folder.path(), &["--format", "rgl", "--states", "all", "--grid", "8"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let there = names(folder.path());
    assert_eq!(there.iter().filter(|name| name.ends_with(".bsdf")).count(), 8, "{there:?}");
    let mirror: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path().join("display-mirror.json")).unwrap()).unwrap();
    assert_eq!(mirror["states"]["white"]["file"], "display-white.bsdf");
    // What was printed is also in the files.
    let about: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path().join("about.json")).unwrap()).unwrap();
    for file in [&mirror, &about] {
        let notes = file["notes"].as_array().unwrap();
        assert!(notes.iter().any(|note| note.as_str().unwrap().contains("haze 0.78")), "{notes:?}");
        assert!(file["warnings"].is_array(), "{file}");
    }
    assert_eq!(mirror["states"]["white"]["specular"][0].as_array().map(Vec::len), Some(9));
    // Light from 0, 45, 67.5 and 89 deg; 9 wavelengths, the luminance, and 4 values of the density, for each
    // of 8 x 8 half vectors; 4 bytes each.
    let bytes = fs::metadata(folder.path().join("display-white.bsdf")).unwrap().len();
    assert!((4 * 14 * 64 * 4..4 * 14 * 64 * 4 + 1000).contains(&bytes), "{bytes}");
    assert_inspected(folder.path());
    let compiled =
        Command::new("python3").args(["-m", "py_compile"]).arg(folder.path().join("scene.py")).output();
    // Without Python, there is nothing that could run the script.
    if let Ok(compiled) = compiled {
        assert!(compiled.status.success(), "{}", stderr(&compiled));
    }
}

#[test]
fn klems_has_a_matrix_for_each_state() {
    let folder = tempfile::tempdir().unwrap();
    let output = brdf("epaper", folder.path(), &["--format", "klems", "--states", "white"]);
    let said = stdout(&output);
    let head = said.lines().skip_while(|line| !line.ends_with("by incidence")).nth(1);
    assert!(
        head.is_some_and(|head| head.trim_start().starts_with("state") && head.matches(" deg").count() == 4),
        "{said}"
    );
    assert!(output.status.success(), "{}", stderr(&output));
    let files = ["about.json", "display-mirror.csv", "display-white.xml", "reflection.csv"];
    assert_eq!(names(folder.path()), files);
}

/// A collimated lamp at 45 deg with the spectrum of D65, seen at the distance of 20 deg from the mirror
/// direction, towards the normal: the file has X, Y and Z of `papilio run`, relative to those of a perfect
/// white, and over pi. `diffuser inspect` reads it.
#[test]
fn radiant_has_the_colours_of_a_run_in_a_collimated_lamp() {
    let folder = tempfile::tempdir().unwrap();
    // Files of the other format with this ending, and what belongs to them, are replaced.
    for old in ["display-red.bsdf", "display-mirror.json", "scene.py"] {
        fs::write(folder.path().join(old), "").unwrap();
    }
    let output = brdf(
        "indoor",
        folder.path(),
        &["--format", "radiant", "--states", "white", "--set", "spectrum.step_nm=5"],
    );
    assert!(output.status.success(), "{}", stderr(&output));
    let files = ["about.json", "display-mirror.csv", "display-white.bsdf", "reflection.csv"];
    assert_eq!(names(folder.path()), files);
    let text = fs::read_to_string(folder.path().join("display-white.bsdf")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let numbers = |line: &str| -> Vec<f64> { line.split('\t').map(|word| word.parse().unwrap()).collect() };
    let below = |word: &str| lines.iter().position(|line| line.starts_with(word)).unwrap() + 1;
    let column = numbers(lines[below("ScatterRadial")]).iter().position(|r| *r == 20.0).unwrap();
    // Incidences of 0, 45, 67.5 and 89 deg, of a line TIS and 37 azimuths each, of which the first is towards
    // the normal.
    let found = ["X", "Y", "Z"].map(|channel| {
        let second = below(&format!("Tristimulus{channel}")) + 1 + 38;
        assert!(lines[second].starts_with("TIS"), "{}", lines[second]);
        numbers(lines[second + 1])[column] * std::f64::consts::PI
    });
    let lamp = ["lighting.diffuse=0", "lighting.directed=[{theta_deg=-45,share=1}]", "viewer.theta_deg=25"];
    let mut run = papilio();
    run.arg("run").arg(scenario("indoor")).args(["--json", "--set", "spectrum.step_nm=5"]);
    run.args(lamp.iter().flat_map(|set| ["--set", set]));
    let output = run.output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let white = &result["views"][0]["states"]["white"];
    for ((name, of_white), found) in [("X", 0.95047), ("Y", 1.0), ("Z", 1.08883)].into_iter().zip(found) {
        let expected = white[name].as_f64().unwrap() / of_white;
        assert!((found / expected - 1.0).abs() < 1e-3, "{name}: {found} {expected}");
    }
    assert_inspected(folder.path());
}

#[test]
fn chosen_states_of_the_archive_have_the_values_of_all() {
    let [all, one] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    assert!(brdf("indoor", all.path(), &[]).status.success());
    assert!(brdf("indoor", one.path(), &["--states", "white"]).status.success());
    let bytes = [&all, &one].map(|folder| fs::read(folder.path().join("display-bsdf.npz")).unwrap());
    // The array of a single state is 2 x 2 x 5 x 9 numbers of 4 bytes after its header, which ends with a
    // line break.
    let find = |bytes: &[u8], what: &[u8]| bytes.windows(what.len()).position(|window| window == what);
    let header = find(&bytes[1], b"(1, 2, 2, 5, 9,)").unwrap();
    let start = header + find(&bytes[1][header..], b"\n").unwrap() + 1;
    let white = &bytes[1][start..start + 2 * 2 * 5 * 9 * 4];
    assert!(find(&bytes[0], white).is_some() && white.iter().any(|byte| *byte != 0));
}

#[test]
fn mistakes_in_options_are_reported_before_anything_is_computed() {
    let folder = tempfile::tempdir().unwrap();
    for (wrong, expected) in [
        (&["--states", "whit"][..], "did you mean `white`?"),
        (&["--states", "paper"], "the states of this display are white, black"),
        (&["--grid", "64"], "only with --format rgl"),
        (&["--format", "radiant", "--grid", "64"], "only with --format rgl"),
        (&["--format", "rgl", "--grid", "4"], "from 8 to 256"),
        (&["--format", "rgl", "--grid", "1000"], "from 8 to 256"),
        (&["--format", "rgl", "--grid", "256", "--set", "spectrum.step_nm=1"], "a smaller --grid"),
        (&["--format", "klems", "--step", "15"], "--step is the step of directions, but --format klems"),
        (&["--format", "exr"], "possible values: npz, csv, rgl, radiant, klems"),
    ] {
        let output = brdf("indoor", folder.path(), wrong);
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
        assert!(stderr(&output).contains(expected), "{wrong:?}: {}", stderr(&output));
    }
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let output = brdf("indoor", &file, &["--format", "rgl"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("is not a folder"), "{}", stderr(&output));
}

/// A display without scattering has no haze: rounding of its mirror component is neither a negative haze nor
/// a failure.
#[test]
fn a_display_without_scattering_has_no_haze() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = papilio();
    command.arg("brdf").arg(scenario("antiglare")).arg("--out").arg(folder.path());
    // With this grid of wavelengths, the sum of the light differs from the mirror component in the last
    // digit.
    let output = command.args(["--step", "15", "--set", "spectrum.step_nm=40"]).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(!fs::read_to_string(folder.path().join("reflection.csv")).unwrap().contains('-'));
}

/// A pixel that depends on azimuth below a haze film: files of all formats that `diffuser inspect` reads, with azimuths of the light, and the
/// parts of beams from four azimuths. Other displays have no azimuths of the light, and other scatterers are refused.
#[test]
fn brdf_of_a_pixel_that_depends_on_azimuth_has_azimuths_of_the_light() {
    let folder = tempfile::tempdir().unwrap();
    let film = "display.diffuser={model=\"k-correlation\",haze=0.78,total_transmittance=0.92}";
    let hazy = ["--set", film, "--set", "display.glass={index=1.5}", "--set", "spectrum.step_nm=200"];
    let of = |more: &[&str]| {
        let mut command = papilio();
        command.arg("brdf").arg(scenario("azimuth-pixel")).arg("--out").arg(folder.path());
        let azimuths: &[&str] = if more.contains(&"--phi-step") { &[] } else { &["--phi-step", "90"] };
        command.args(hazy).args(azimuths).args(["--allow-error", "0.1"]).args(more).output().unwrap()
    };
    let output = of(&["--format", "csv", "--step", "45"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = fs::read_to_string(folder.path().join("display-white.csv")).unwrap();
    assert!(
        text.starts_with("theta_i_deg,phi_i_deg,theta_o_deg,dphi_deg,wavelength_nm,brdf,error\n"),
        "{text}"
    );
    // 2 inclinations and 2 azimuths of the light, 2 x 8 viewers.
    let bins = text.lines().filter(|line| line.starts_with("45,90,0,0,")).count();
    assert_eq!(text.lines().count(), 1 + 2 * 2 * 2 * 8 * bins);
    let beams = fs::read_to_string(folder.path().join("reflection.csv")).unwrap();
    assert!(beams.lines().any(|line| line.starts_with("30,135,white,")), "{beams}");
    assert!(stdout(&output).contains("white, from azimuth 135 deg"));
    let mirror = fs::read_to_string(folder.path().join("display-mirror.csv")).unwrap();
    assert!(mirror.starts_with("state,theta_i_deg,phi_i_deg,wavelength_nm,"), "{mirror}");
    for format in [&["npz", "--step", "45"][..], &["rgl", "--step", "90", "--grid", "8"]] {
        let output = of(&[&["--format"][..], format].concat());
        assert!(output.status.success(), "{format:?}: {}", stderr(&output));
        let file = ["display-white.bsdf", "display-bsdf.npz"][usize::from(format[0] == "npz")];
        let mut inspect = papilio();
        inspect.args(["diffuser", "inspect"]).arg(folder.path().join(file));
        let output = inspect.arg("--out").arg(folder.path().join("inspected")).output().unwrap();
        assert!(output.status.success(), "{format:?}: {}", stderr(&output));
    }
    let front = ["--set", "display.front=[{reflectance=0.05,gap_mm=1}]"];
    let refused = [
        (
            &["--format", "klems", "--phi-step", "0.5"][..],
            "use a larger --phi-step, a larger spectrum.step_nm or",
        ),
        (&[&front[..], &["--step", "45"]].concat(), "depends on azimuth"),
    ];
    for (more, expected) in refused {
        let output = of(more);
        assert_eq!(output.status.code(), Some(2), "{more:?}");
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
    let output = brdf("indoor", &folder.path().join("round"), &["--phi-step", "30"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("the same at all azimuths"), "{}", stderr(&output));
}
