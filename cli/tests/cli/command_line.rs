//! The program as a process: exit codes, standard output and error, files.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use papilio_figures::HAS_PNG;

fn papilio() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_papilio"));
    command.env("NO_COLOR", "1");
    command
}

fn scenario(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name).with_extension("toml")
}

fn run(name: &str, more: &[&str]) -> Output {
    papilio().arg("run").arg(scenario(name)).args(more).output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn a_run_writes_its_results_and_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/folder");
    let output = run("indoor", &["--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
    let files = [
        "chromaticity.svg",
        "overview.svg",
        "patches.svg",
        "result.json",
        "spectra.csv",
        "spectra.svg",
        "states.csv",
    ];
    assert_eq!(names(&out), files);
    let table = String::from_utf8(output.stdout).unwrap();
    for word in ["Indoor reading", "white", "magenta", "contrast ratio", "% of sRGB", "energy balance"] {
        assert!(table.contains(word), "{word} is not in\n{table}");
    }
    let result: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("result.json")).unwrap()).unwrap();
    let white = &result["views"][0]["states"]["white"];
    let y = white["Y"].as_f64().unwrap();
    assert!(white["discretisation_error"]["Y"].as_f64().unwrap() < 0.001 * y);
    assert_eq!(result["wavelength_nm"].as_array().unwrap().len(), 81);
    assert_eq!(result["seed"], 0);
    assert_eq!(result["hash"].as_str().unwrap().len(), 64);
    let rows = fs::read_to_string(out.join("states.csv")).unwrap();
    assert_eq!(rows.lines().count(), 9);
}

/// What the README says that its first command prints.
#[test]
fn the_readme_shows_what_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let printed = run("indoor", &["--out", folder.path().to_str().unwrap()]).stdout;
    let printed = String::from_utf8(printed).unwrap();
    let readme = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../README.md")).unwrap();
    let (_, block) = readme.split_once("```\nIndoor reading\n").unwrap();
    let (block, _) = block.split_once("```").unwrap();
    let shown: Vec<&str> = block.lines().filter(|line| !line.is_empty() && line.trim() != "...").collect();
    assert!(shown.len() > 4);
    for line in shown {
        assert!(printed.contains(line), "{line}\nis not in\n{printed}");
    }
}

#[test]
fn several_views_have_figures_against_angle() {
    let folder = tempfile::tempdir().unwrap();
    let output = run("angle-scan", &["--out", folder.path().to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
    let names = names(folder.path());
    for name in ["contrast_against_angle.svg", "gamut_against_angle.svg", "reflectance_against_angle.svg"] {
        assert!(names.iter().any(|n| n == name), "{name} is not among {names:?}");
    }
}

#[test]
fn json_prints_json_and_nothing_else_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let output = papilio()
        .current_dir(folder.path())
        .arg("run")
        .arg(scenario("indoor"))
        .arg("--json")
        .output()
        .unwrap();
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(result["views"][0]["gamut_percent_srgb"].as_f64().unwrap() > 0.0);
    assert!(names(folder.path()).is_empty());
}

#[test]
fn any_number_of_threads_gives_the_same_bytes_and_a_seed_does_not() {
    let json = |more: &[&str]| run("indoor", &[&["--json", "--solver", "monte-carlo"], more].concat()).stdout;
    let one = json(&["--threads", "1"]);
    assert!(!one.is_empty());
    assert_eq!(one, json(&["--threads", "4"]));
    assert_eq!(one, json(&[]));
    assert_ne!(one, json(&["--seed", "1"]));
}

#[test]
fn a_pixel_scan_is_a_pixel_table() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let output = papilio().arg("pixel").arg(scenario("indoor")).args(["--out", out]).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(names(folder.path()), ["about.json", "pixel.csv", "pixel.svg"]);
    let csv = fs::read_to_string(folder.path().join("pixel.csv")).unwrap();
    assert_eq!(csv.lines().next().unwrap(), "state,theta_deg,wavelength_nm,reflectance");
    assert_eq!(csv.lines().count(), 1 + 8 * 91 * 81);
}

/// Each row of absorption.csv is a fraction of the light on its sub-pixel; with sub-pixels.csv they sum to 1.
#[test]
fn absorption_of_the_layers_and_reflectance_sum_to_one() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let scan = |name: &str, more: &[&str]| {
        let arguments = ["--absorption", "--set", "spectrum.step_nm=50", "--out", out];
        papilio().arg("pixel").arg(scenario(name)).args(arguments).args(more).output().unwrap()
    };
    let output = scan("indoor", &["--step", "45"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("red (black)") && printed.contains("1 Cr:Johnson"), "{printed}");
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let absorbed = read("absorption.csv");
    let header = "state,sub_pixel,layer,material,theta_deg,wavelength_nm,absorptance";
    assert_eq!(absorbed.lines().next(), Some(header));
    // 8 states, 3 sub-pixels, 6 layers, 3 angles, 9 wavelengths.
    assert_eq!(absorbed.lines().count(), 1 + 8 * 3 * 6 * 3 * 9);
    assert!(
        absorbed.contains("white,red,1,Cr:Johnson,45,480,")
            && absorbed.contains("black,blue,substrate,Al,90,780,")
    );
    let mut sums = std::collections::BTreeMap::<String, f64>::new();
    for line in absorbed.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let place = [cells[0], cells[1], cells[4], cells[5]].join(",");
        *sums.entry(place).or_default() += cells[6].parse::<f64>().unwrap();
    }
    for line in read("sub-pixels.csv").lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let place = [cells[0], cells[1], cells[3], cells[4]].join(",");
        let reflectance: f64 = cells[5].parse().unwrap();
        assert!((sums[&place] + reflectance - 1.0).abs() < 1e-12, "{line}");
    }
    assert!(read("absorption.svg").contains("substrate: Al"));
    let refused = scan("epaper", &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("no film whose layers absorb"), "{}", stderr(&refused));
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

/// The way in and out for other pixel tools: the scan of a film pixel, read back as a table,
/// shows the same display. Angles in glass, so that the table reaches all light.
#[test]
fn a_scan_read_back_shows_the_same_display() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let bare = scenario("reference-pixel");
    let output = papilio().arg("pixel").arg(&bare).arg("--out").arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let film = fs::read_to_string(&bare).unwrap();
    let (before, rest) = film.split_once("[display.pixel]").unwrap();
    let after = &rest[rest.find("[lighting]").unwrap()..];
    let table = "[display.pixel]\nmodel = \"table\"\nfile = \"pixel.csv\"\nangles = \"glass\"\n\n";
    fs::write(path("table.toml"), format!("{before}{table}{after}")).unwrap();
    let white = |file: &Path| {
        let output = papilio()
            .arg("run")
            .arg(file)
            .args(["--json", "--set", "viewer.theta_deg=8.5"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        result["views"][0]["states"]["white"]["Y"].as_f64().unwrap()
    };
    let (from_film, from_table) = (white(&bare), white(&path("table.toml")));
    // Midway between the table's angles linear interpolation is at its worst.
    assert!((from_film - from_table).abs() < 2e-4 * from_film, "{from_film} {from_table}");
}

#[test]
fn a_scan_may_have_angles_in_glass_whatever_stands_above_the_pixel() {
    let folder = tempfile::tempdir().unwrap();
    let scan = |angles: &str| {
        let arguments = ["--angles", angles, "--step", "45", "--out", folder.path().to_str().unwrap()];
        let output = papilio().arg("pixel").arg(scenario("indoor")).args(arguments).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let csv = fs::read_to_string(folder.path().join("pixel.csv")).unwrap();
        assert_eq!(csv.lines().count(), 1 + 8 * 3 * 81);
        let white = csv.lines().find(|line| line.starts_with("white,45,550,")).unwrap();
        white.rsplit(',').next().unwrap().parse::<f64>().unwrap()
    };
    // At 45 deg in glass light is reflected at the air gap, at 45 deg in air it is not.
    assert!((scan("glass") - scan("air")).abs() > 0.05);
}

#[test]
fn figures_of_an_earlier_run_do_not_stay() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    fs::write(folder.path().join("mine.svg"), "").unwrap();
    assert!(run("indoor", &["--out", out, "--set", "viewer.theta_deg=[0,20]"]).status.success());
    assert!(names(folder.path()).contains(&"overview_theta20_phi0.svg".to_owned()));
    assert!(run("indoor", &["--out", out]).status.success());
    let left = names(folder.path());
    assert!(!left.iter().any(|name| name.contains("theta") || name.contains("against")), "{left:?}");
    assert!(left.contains(&"mine.svg".to_owned()) && left.contains(&"overview.svg".to_owned()));
}

#[test]
fn numbers_that_overflow_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let output = run("indoor", &["--set", "display.diffuser.width=1e-150", "--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(!out.exists());
}

#[test]
fn schemas_are_printed() {
    for more in [&[][..], &["--result"]] {
        let output = papilio().arg("schema").args(more).output().unwrap();
        let schema: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(schema["properties"].is_object());
    }
}

#[test]
fn wrong_input_exits_2_says_where_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let base = fs::read_to_string(scenario("indoor")).unwrap();
    let wrong = folder.path().join("wrong.toml");
    for (from, to, column, words) in [
        ("theta_deg = 8", "theta_degg = 8", 1, "did you mean `theta_deg`?"),
        ("thickness_nm = 38.6", "thickness_nm = -38.6", 39, "expected"),
        ("material = \"SiO2\"", "material = \"SiO3\"", 16, "SiO2"),
        ("red = 0.493", "red = 0.793", 8, "sum"),
        ("index = 1.5", "index = true", 9, "expected"),
    ] {
        assert!(base.contains(from), "{from}");
        let text = base.replacen(from, to, 1);
        let line = 1 + text.lines().position(|line| line.contains(to)).unwrap();
        fs::write(&wrong, text).unwrap();
        let out = folder.path().join("out");
        let output = papilio().arg("run").arg(&wrong).arg("--out").arg(&out).output().unwrap();
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(output.stdout.is_empty());
        let place = format!("wrong.toml:{line}:{column}\n");
        assert!(text.contains("error: ") && text.contains(&place) && text.contains(words), "{to}:\n{text}");
        assert!(!out.exists());
    }
}

#[test]
fn impossible_overrides_are_named() {
    for set in ["display.pixel.film.9.thickness_nm=12", "viewer.theta=8", "display.glass.index.n=2", "seed"] {
        let output = run("indoor", &["--json", "--set", "viewer.theta_deg=20", "--set", set]);
        assert_eq!(output.status.code(), Some(2), "{set}");
        assert!(stderr(&output).contains("--set #2:1:"), "{set}:\n{}", stderr(&output));
    }
}

#[test]
fn what_is_not_there_is_the_users_mistake() {
    assert_eq!(run("indoor", &["--solver", "magic"]).status.code(), Some(2));
    assert_eq!(papilio().args(["run", "no-such-file.toml"]).output().unwrap().status.code(), Some(2));
    assert_eq!(papilio().arg("fly").output().unwrap().status.code(), Some(2));
}

#[test]
fn a_folder_that_cannot_be_made_is_the_users_mistake() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "in the way").unwrap();
    let output = run("indoor", &["--out", file.join("below").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("is not a folder"), "{}", stderr(&output));
}

/// The result and the messages of a long walk of the indoor scenario that gets Ctrl-C.
#[cfg(unix)]
fn interrupted(set: &str) -> (serde_json::Value, String) {
    let folder = tempfile::tempdir().unwrap();
    let child = papilio()
        .arg("run")
        .arg(scenario("indoor"))
        .args(["--solver", "monte-carlo", "--set", set, "--out"])
        .arg(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    let stopped = Instant::now();
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert!(stopped.elapsed() < Duration::from_secs(10), "it went on for {:?}", stopped.elapsed());
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    let result = serde_json::from_slice(&fs::read(folder.path().join("result.json")).unwrap()).unwrap();
    (result, stderr(&output))
}

/// Ctrl-C ends a run that would take for ever, with what is there.
#[cfg(unix)]
#[test]
fn an_interrupted_run_saves_what_is_done() {
    let (result, _) = interrupted("solver.paths=1000000000");
    assert_eq!(result["solver"]["interrupted"], true);
    assert!(result["solver"]["paths"].as_u64().unwrap() > 8192);
}

/// Of a scan, the views that are done.
#[cfg(unix)]
#[test]
fn an_interrupted_scan_saves_the_views_that_are_done() {
    let (result, messages) = interrupted("viewer.theta_deg={ from = -80, to = 80, step = 0.05 }");
    let views = result["views"].as_array().unwrap().len();
    assert!((1..3201).contains(&views), "{views} views");
    assert!(messages.contains(" of 3201 views"), "{messages}");
}

/// A coarse spectrum makes the cone quick; what is written does not depend on it.
const COARSE: [&str; 2] = ["--set", "spectrum.step_nm=20"];

#[test]
fn a_cone_is_written_beside_the_rest_and_figures_as_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let out = ["--out", folder.path().to_str().unwrap()];
    let png: &[&str] = if HAS_PNG { &["--png"] } else { &[] };
    let output = run("indoor", &[&out[..], &COARSE, &["--cone"], png].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("cone: 90 x 72 directions"), "{printed}");
    let cone = ["cone.csv", "cone.json", "cone.npy", "cone.png", "cone.svg"];
    let there = names(folder.path());
    for name in cone.iter().chain(&["overview.png", "overview.svg"]) {
        let expected = HAS_PNG || !name.ends_with(".png");
        assert_eq!(there.iter().any(|n| n == name), expected, "{name} among {there:?}");
    }
    let rows = fs::read_to_string(folder.path().join("cone.csv")).unwrap();
    assert_eq!(rows.lines().count(), 1 + 90 * 72 * 8);
    // The next run has none: the old one's would be mistaken for its own.
    assert!(run("indoor", &[&out[..], &COARSE].concat()).status.success());
    assert!(names(folder.path()).iter().all(|name| !name.starts_with("cone") && !name.ends_with(".png")));
}

/// The cone at the scenario's own view says what the run says.
#[test]
fn the_cone_agrees_with_a_run_of_the_same_view() {
    let folder = tempfile::tempdir().unwrap();
    let out = ["--out", folder.path().to_str().unwrap(), "--cone"];
    let view = ["--set", "viewer.theta_deg=8", "--set", "viewer.phi_deg=0"];
    assert!(run("indoor", &[&out[..], &COARSE, &view].concat()).status.success());
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let result: serde_json::Value = serde_json::from_str(&read("result.json")).unwrap();
    let white = &result["views"][0]["states"]["white"];
    let csv = read("cone.csv");
    let row: Vec<&str> = csv.lines().find(|row| row.starts_with("8,0,white,")).unwrap().split(',').collect();
    for (cell, key) in row[3..7].iter().zip(["Y", "luminance_cd_m2", "u_prime", "v_prime"]) {
        let (cell, value): (f64, f64) = (cell.parse().unwrap(), white[key].as_f64().unwrap());
        // Two levels of discretisation may differ by the target of either.
        assert!((cell - value).abs() < 2e-3 * value, "{key}: {cell} in the cone, {value} in the run");
    }
}

/// What the program was built without is said before anything is computed.
#[test]
fn pictures_that_were_not_built_are_refused() {
    if !HAS_PNG {
        let folder = tempfile::tempdir().unwrap();
        let output = run("indoor", &["--png", "--out", folder.path().to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("feature `png`") && names(folder.path()).is_empty());
    }
}

#[test]
fn files_beside_json_need_a_folder() {
    for flag in ["--cone", "--png"].into_iter().take(if HAS_PNG { 2 } else { 1 }) {
        let output = run("indoor", &["--json", flag]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("--out") && output.stdout.is_empty());
    }
}

#[test]
fn the_solver_can_be_chosen() {
    let method = |solver: &str| {
        let output = run("indoor", &[&COARSE[..], &["--json", "--solver", solver]].concat());
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (result["solver"].clone(), result["scenario"]["solver"]["method"].clone())
    };
    let (walk, named) = method("monte-carlo");
    assert!(walk["paths"].as_u64().unwrap() > 0 && walk["nodes"].is_null() && named == "monte-carlo");
    let (adding, named) = method("adding");
    assert!(adding["nodes"].as_u64().unwrap() > 0 && adding["paths"].is_null() && named == "adding");
}

#[test]
fn a_display_has_a_bsdf_file() {
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

/// Where light comes from many directions, a figure says from where.
#[test]
fn a_run_under_a_ring_draws_its_light() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    assert!(run("ring", &["--out", out]).status.success());
    assert!(names(folder.path()).contains(&"light.svg".to_owned()));
    // It goes with the other figures of an earlier run.
    assert!(run("indoor", &["--out", out]).status.success());
    assert!(!names(folder.path()).contains(&"light.svg".to_owned()));
}

/// What names and cells hold is shown and not sent to the terminal, and a pipe has the whole message.
#[test]
fn what_is_quoted_never_reaches_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let obeyed = |c: char| {
        (c.is_control() && c != '\n') || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    let file = scenario("indoor");
    let indoor = fs::read_to_string(&file).unwrap();
    fs::write(at("e5.csv"), "300,0\n400,\u{1b}[2J\u{1b}[31mX\n900,0\n").unwrap();
    fs::write(at("e5.toml"), indoor.replacen("spectrum = \"D65\"", "spectrum = \"e5.csv\"", 1)).unwrap();
    // An operating system command without its end: a pipe swallowed all that came after.
    fs::write(at("e3.toml"), format!("\"\\u001b]0;x\\n\\u009bA\\u202e\" = 1\n{indoor}")).unwrap();
    fs::write(at("e\u{1b}]0;\u{9b}\u{202e}.toml"), "nonsense").unwrap();
    fs::write(
        at("state.toml"),
        indoor.replacen("[lighting]", "[display.pixel.states]\n\"a\u{202e}b\" = { red = 1 }\n[lighting]", 1),
    )
    .unwrap();
    let cases = [
        ("e5.toml", "`\\u001b[2J\\u001b[31mX` is not a number"),
        ("e3.toml", "\\u001b]0;x\\n\\u009bA\\u202e"),
        ("e\u{1b}]0;\u{9b}\u{202e}.toml", "e\\u001b]0;\\u009b\\u202e.toml:1"),
        ("state.toml", "this name is not permitted"),
        ("none\u{1b}[2J.toml", "none\\u001b[2J.toml"),
    ];
    for (name, said) in cases {
        let output = papilio().args(["run", &at(name), "--json"]).output().unwrap();
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{name:?}: {text}");
        assert!(text.contains(said) && text.contains("-->"), "{name:?}: {text}");
        assert!(!text.chars().any(obeyed), "{name:?}: {text:?}");
    }
}

/// A state that a spreadsheet would compute is refused where it is named.
#[test]
fn a_state_is_no_formula() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.toml");
    let indoor = fs::read_to_string(scenario("indoor")).unwrap();
    for (name, is_good) in [("=HYPERLINK(1)", false), ("@SUM(1)", false), ("-5 V", true)] {
        let states = format!("[display.pixel.states]\n\"{name}\" = {{ red = 1 }}\n[lighting]");
        fs::write(&file, indoor.replacen("[lighting]", &states, 1)).unwrap();
        let output = papilio().args(["run", file.to_str().unwrap(), "--json"]).output().unwrap();
        assert_eq!(output.status.success(), is_good, "{name}: {}", stderr(&output));
        assert!(is_good || stderr(&output).contains("formula"), "{name}: {}", stderr(&output));
    }
}

/// Where no folder is named, the result of another hash stays, whatever command made it; the same result goes to its own folder.
#[test]
fn a_result_of_another_hash_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let file = scenario("indoor").canonicalize().unwrap();
    let quick = ["--set", "spectrum.step_nm=20", "--set", "solver.relative_error=0.05"];
    let at = |command: &str, more: &[&str]| {
        let output = papilio()
            .current_dir(folder.path())
            .arg(command)
            .arg(&file)
            .args(quick)
            .args(more)
            .output()
            .unwrap();
        assert!(output.status.success(), "{command}: {}", stderr(&output));
        stderr(&output)
    };
    let folders = || names(&folder.path().join("out"));
    let read = |name: &str| fs::read(folder.path().join("out").join(name)).unwrap();
    let other = ["--set", "viewer.theta_deg=31"];
    assert!(!at("run", &[]).contains("note: out/indoor"));
    let first = read("indoor/result.json");
    let said = at("run", &other);
    assert!(said.contains("note: out/indoor contains the result of another scenario"), "{said}");
    assert_eq!(read("indoor/result.json"), first);
    let hash = |bytes: &[u8]| {
        let result: serde_json::Value = serde_json::from_slice(bytes).unwrap();
        result["hash"].as_str().unwrap()[..6].to_owned()
    };
    let beside = folders()[1].clone();
    assert_eq!(beside, format!("indoor-{}", hash(&read(&format!("{beside}/result.json")))));
    // The same again, and another command of the same scenario: the same folders.
    at("run", &other);
    at("pixel", &other);
    at("pixel", &[]);
    assert_eq!(folders(), ["indoor".to_owned(), beside.clone()]);
    assert!(read(&format!("{beside}/about.json")) != read("indoor/about.json"));
    // A folder that has but the table of another command.
    fs::remove_file(folder.path().join("out/indoor/result.json")).unwrap();
    let said = at("brdf", &["--step", "30", "--set", "viewer.theta_deg=32"]);
    assert!(said.contains("note: out/indoor contains"), "{said}");
    assert_eq!(folders().len(), 3);
    // compare says what it compares.
    let measured = "state,theta_deg,X,Y,Z\nwhite,31,1,1,1\n";
    fs::write(folder.path().join("m.csv"), measured).unwrap();
    let result = format!("out/{beside}");
    let compare = papilio().current_dir(folder.path()).args(["compare", &result, "m.csv"]).output().unwrap();
    let text = String::from_utf8(compare.stdout).unwrap();
    assert!(text.contains(&format!("simulated: {result}/result.json (hash {}", &beside[7..])), "{text}");
    assert!(text.contains("measured: m.csv"), "{text}");
    // A link to itself.
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("loop", folder.path().join("loop")).unwrap();
        let looped = papilio()
            .current_dir(folder.path())
            .arg("run")
            .arg(&file)
            .args(["--out", "loop"])
            .output()
            .unwrap();
        assert_eq!(looped.status.code(), Some(2));
        assert!(stderr(&looped).contains("is a link to a path that does not exist"), "{}", stderr(&looped));
    }
}
