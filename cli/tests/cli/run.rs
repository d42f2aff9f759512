//! `papilio run`: standard output and error, files, solvers, interruption.

use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::common::{
    COARSE, names, papilio_command as papilio, place, run_scenario as run, scenario, stderr,
};

#[test]
fn run_writes_results_and_prints_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/folder");
    let output = run("indoor", &["--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
    let files = [
        "chromaticity.svg",
        "chromaticity_xy.svg",
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

/// Temporary files of a killed run are deleted by the next one; files of other programs, and of one that
/// still writes, are not.
#[test]
fn what_a_killed_run_has_left_is_deleted_by_the_next_one() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    let left = [".result.json.99999-0.papilio.tmp", ".patches.svg.1-17.papilio.tmp"];
    left.iter().for_each(|name| fs::write(out.join(name), "cut off").unwrap());
    let writing = fs::File::create(out.join(".states.csv.2-3.papilio.tmp")).unwrap();
    writing.lock().unwrap();
    fs::write(out.join(".mine.tmp"), "").unwrap();
    let output = run("indoor", &[&["--out", out.to_str().unwrap()], &COARSE[..]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let hidden: Vec<String> = names(&out).into_iter().filter(|name| name.starts_with('.')).collect();
    assert_eq!(hidden, [".mine.tmp", ".states.csv.2-3.papilio.tmp"]);
}

/// Readability is printed for a reader whom the scenario describes, with the bound that is not met.
#[test]
fn readability_is_printed_for_a_described_reader() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let printed = |name: &str, more: &[&str]| {
        let output = run(name, &[&["--out", out.to_str().unwrap()], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    assert!(!printed("indoor", &[]).contains("black text"));
    let room = printed("epaper-reading", &[]);
    assert!(room.contains("reader of 60 years, lower-case x of 1.6 mm at 400 mm"), "{room}");
    assert!(room.contains("mean luminance 6.67 cd/m2 is below its range, 1000 to 5200 cd/m2"), "{room}");
    let dark = printed("epaper-reading", &["--set", "lighting.illuminance_lx=0.5"]);
    assert!(dark.contains("is below its range, 0.1 to 10000 cd/m2"), "{dark}");
    let views = printed("epaper-reading", &["--set", "viewer.theta_deg=[0, 10, 20, 30]"]);
    assert!(views.contains("visibility level") && !views.contains("reader of"), "{views}");
}

#[test]
fn run_of_several_views_draws_figures_against_angle() {
    let folder = tempfile::tempdir().unwrap();
    let output = run("angle-scan", &["--out", folder.path().to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
    let names = names(folder.path());
    for name in ["contrast_against_angle.svg", "gamut_against_angle.svg", "reflectance_against_angle.svg"] {
        assert!(names.iter().any(|n| n == name), "{name} is not among {names:?}");
    }
}

#[test]
fn json_option_prints_only_json_and_writes_no_file() {
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
fn results_depend_on_seed_but_not_on_threads() {
    let json = |more: &[&str]| run("indoor", &[&["--json", "--solver", "monte-carlo"], more].concat()).stdout;
    let one = json(&["--threads", "1"]);
    assert!(!one.is_empty());
    assert_eq!(one, json(&["--threads", "4"]));
    assert_eq!(one, json(&[]));
    assert_ne!(one, json(&["--seed", "1"]));
}

#[test]
fn figures_of_an_earlier_run_are_removed() {
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
fn schema_option_prints_schemas() {
    for more in [&[][..], &["--result"], &["--mtf"], &["--sparkle"], &["--gloss"]] {
        let output = papilio().arg("schema").args(more).output().unwrap();
        let schema: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(schema["properties"].is_object());
    }
}

/// Computing time of a process so far, s: on a busy machine more time passes. `None` where the system does
/// not list processes.
#[cfg(unix)]
fn cpu_seconds(process: u32) -> Option<f64> {
    let Ok(status) = fs::read_to_string(format!("/proc/{process}/stat")) else {
        std::thread::sleep(Duration::from_millis(1500));
        return None;
    };
    // proc(5): fields 14 and 15, in hundredths of a second, counted from the end of the name in brackets.
    let fields = status.rsplit_once(") ")?.1.split(' ').skip(11).take(2);
    Some(fields.filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0)
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
    while cpu_seconds(child.id()).is_some_and(|seconds| seconds < 1.0) {
        std::thread::sleep(Duration::from_millis(50));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    let result = serde_json::from_slice(&fs::read(folder.path().join("result.json")).unwrap()).unwrap();
    (result, stderr(&output))
}

/// Ctrl-C ends a run that would take for ever, with what is there.
#[cfg(unix)]
#[test]
fn interrupted_run_saves_the_paths_that_are_done() {
    let (result, _) = interrupted("solver.paths=1000000000");
    assert_eq!(result["solver"]["interrupted"], true);
    assert!(result["solver"]["paths"].as_u64().unwrap() > 8192);
}

/// Of a scan, the views that are done.
#[cfg(unix)]
#[test]
fn interrupted_run_of_many_views_saves_the_views_that_are_done() {
    let (result, messages) = interrupted("viewer.theta_deg={ from = -80, to = 80, step = 0.05 }");
    let views = result["views"].as_array().unwrap().len();
    assert!((1..3201).contains(&views), "{views} views");
    assert!(messages.contains(" of 3201 views"), "{messages}");
}

#[test]
fn solver_option_selects_the_solver() {
    let method = |solver: &str| {
        let output = run("indoor", &[&COARSE[..], &["--json", "--solver", solver]].concat());
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (result["solver"].clone(), result["scenario"]["solver"]["method"].clone())
    };
    let (walk, named) = method("monte-carlo");
    assert!(walk["paths"].as_u64().unwrap() > 0 && walk["nodes"].is_null() && named == "monte-carlo");
    let (adding, named) = method("adding");
    assert!(adding["nodes"].as_u64().unwrap() > 0 && adding["paths"].is_null() && named == "adding");
    let (chosen, named) = method("auto");
    assert!(chosen["method"] == "adding" && named == "auto", "{chosen}");
    assert!(chosen["chosen_because"].as_str().unwrap().contains("adding takes about"), "{chosen}");
    assert!(adding["chosen_because"].is_null());
}

/// Where light comes from many directions, a figure says from where.
#[test]
fn run_under_a_ring_draws_its_light() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    assert!(run("ring", &["--out", out]).status.success());
    assert!(names(folder.path()).contains(&"light.svg".to_owned()));
    // It goes with the other figures of an earlier run.
    assert!(run("indoor", &["--out", out]).status.success());
    assert!(!names(folder.path()).contains(&"light.svg".to_owned()));
}

/// Colours are means over many pixels: they do not depend on the places of sub-pixels, nor on lengths.
#[test]
fn matrix_changes_nothing_but_scenario_and_hash() {
    let text = fs::read_to_string(scenario("matrix")).unwrap();
    let keys = "ppi = 300                       # a pitch of 84.67 um\nlayout = \"stripe\" ";
    let plain = text.replace("[display.matrix]\n", "").replace(keys, "#").replace("thickness_mm = 0.5", "#");
    let results = |text: &str, solver: &str| {
        let (_folder, file, _) = place(text);
        let more = [
            "--json",
            "--solver",
            solver,
            "--set",
            "spectrum.step_nm=20",
            "--set",
            "solver.relative_error=0.02",
        ];
        let output = papilio().args(["run", &file]).args(more).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let mut result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let has_matrix = result["scenario"]["display"]["matrix"].is_object();
        let all = result.as_object_mut().unwrap();
        let hash = all.remove("hash").unwrap();
        all.remove("scenario").unwrap();
        (has_matrix, hash, result.to_string())
    };
    for solver in ["adding", "monte-carlo"] {
        let (placed, bare) = (results(&text, solver), results(&plain, solver));
        assert!(placed.0 && !bare.0);
        assert_ne!(placed.1, bare.1);
        assert!(placed.2 == bare.2, "{solver}");
    }
}

/// Light enters and leaves through different parts of a filter: its colours are not the mean over its area.
#[test]
fn filter_below_a_diffuser_and_a_front_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let sets = [
        "display.matrix={ ppi = 227, filter = { height_um = 30, transmittance = { red = 0.9, green = 0.9, blue = 0.9 } } }",
        "display.glass.surface=\"coated\"",
        "display.diffuser={ model = \"k-correlation\", width = 0.1, transmittance = 0.9 }",
        "display.front=[{ reflectance = 0.04, gap_mm = 1 }]",
        "solver.method=\"adding\"",
    ];
    let mut arguments = vec!["--out", out.to_str().unwrap()];
    sets.iter().for_each(|set| arguments.extend(["--set", set]));
    let output = run("laminated-text", &arguments);
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    assert!(message.contains("a colour filter below a diffuser and a front"), "{message}");
    assert!(!out.exists());
}

/// A film through an oblique polariser below a sky: by the default solver, by each, and as a map.
#[test]
fn oblique_polarisers_show_films_by_each_method() {
    let text = "[spectrum]\nstep_nm = 40\n[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\n[display.pixel]\nmodel = \"film\"\n\
        substrate = \"Al\"\narea = { x = 1.0 }\ngap_nm = { x = 120, dark = 20 }\ndefault_states = false\nstates = { white = { x = 1.0 } }\n\
        film = [{ material = \"Cr:Johnson\", thickness_nm = 12 }, { material = \"air\", thickness_nm = \"gap\" }]\n\
        [lighting]\nilluminance_lx = 500\ndiffuse = 0.0\n[[lighting.environment]]\nshare = 1.0\nmodel = \"sky\"\nnumber = 12\n\
        sun_elevation_deg = 20\npolarisation = 0.75\n[viewer]\ntheta_deg = 40\nphi_deg = 20\npolariser = 30\n";
    let (folder, file, _) = place(text);
    let y = |name: &str, more: &[&str]| {
        let out = folder.path().join(name);
        let output = papilio().args(["run", &file, "--out"]).arg(&out).args(more).output().unwrap();
        assert!(output.status.success(), "{name}: {}", stderr(&output));
        let text = fs::read_to_string(out.join("result.json")).unwrap();
        let result: serde_json::Value = serde_json::from_str(&text).unwrap();
        result["views"][0]["states"]["white"]["Y"].as_f64().unwrap()
    };
    let adding = y("adding", &["--solver", "adding"]);
    assert!((y("default", &[]) / adding - 1.0).abs() < 2e-3);
    assert!(
        (y("paths", &["--solver", "monte-carlo", "--set", "solver.paths=65536"]) / adding - 1.0).abs() < 5e-3
    );
    y("cone", &["--cone", "--set", "viewer.phi_deg=20"]);
    let map = fs::read_to_string(folder.path().join("cone/cone.csv")).unwrap();
    let row: Vec<&str> =
        map.lines().find(|row| row.starts_with("40,20,white,")).unwrap().split(',').collect();
    assert!((row[3].parse::<f64>().unwrap() / adding - 1.0).abs() < 2e-3, "{row:?} {adding}");
}
