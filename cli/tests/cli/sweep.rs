//! `papilio sweep`: results, interrupted and resumed sweeps, shards, changed sweeps, wrong input.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use papilio_formats::HAS_PARQUET;

use crate::common::{files, papilio, place, same, stderr, stdout};

/// A bare film pixel: fast, but slow enough that a sweep of it can be killed.
pub(crate) const SCENARIO: &str = r#"
title = "Bare"
[display.pixel]
model = "film"
substrate = "Al"
area = { red = 0.4, green = 0.4, blue = 0.2 }
gap_nm = { red = 275.9, green = 192.3, blue = 137.8, dark = 20.0 }
film = [
  { material = "Si3N4", thickness_nm = 55.9 },
  { material = "Cr:Johnson", thickness_nm = 12.15 },
  { material = "air", thickness_nm = "gap" },
]
[display.diffuser]
model = "k-correlation"
haze = 0.78
transmittance = 0.9
[solver]
relative_error = 0.01
[sweep]
figures = ["contrast_ratio", "white.L_star"]
[[sweep.axes]]
"display.pixel.film.1.thickness_nm" = { from = 6, to = 14, count = 5 }
[[sweep.axes]]
viewer.theta_deg = [0, 10, 20]
lighting.directed = [[], [], []]
"#;

/// Files of an uninterrupted sweep.
fn undisturbed() -> BTreeMap<String, Vec<u8>> {
    uninterrupted_with(&[])
}

fn uninterrupted_with(more: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let (_folder, file, out) = place(SCENARIO);
    let output = papilio(&[&["sweep", &file, "--out", &out], more].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    files(Path::new(&out))
}

#[test]
fn sweep_writes_its_table_and_figures() {
    let files = undisturbed();
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    let expected = [
        "sweep.csv",
        "sweep.jsonl",
        "sweep_contrast_ratio.svg",
        "sweep_contrast_ratio_map.svg",
        "sweep_white.L_star.svg",
        "sweep_white.L_star_map.svg",
    ];
    assert_eq!(names, expected);
    let table = String::from_utf8(files["sweep.csv"].clone()).unwrap();
    let mut lines = table.lines();
    let keys = "point,display.pixel.film.1.thickness_nm,viewer.theta_deg,lighting.directed,theta_deg";
    assert!(lines.next().unwrap().starts_with(keys), "{table}");
    // 15 points with eight states each.
    let states = lines.clone().filter(|line| line.starts_with("14,14,20,[],20,0,")).count();
    assert_eq!((states, lines.count()), (8, 15 * 8));
}

/// The numbers of a point equal those of `papilio run`, to the last digit.
#[test]
fn point_of_a_sweep_equals_a_run() {
    let (folder, file, out) = place(SCENARIO);
    assert!(papilio(&["sweep", &file, "--out", &out]).status.success());
    let table = fs::read_to_string(Path::new(&out).join("sweep.csv")).unwrap();
    let alone = folder.path().join("run");
    let set = ["display.pixel.film.1.thickness_nm=10", "viewer.theta_deg=20"];
    let output = papilio(&["run", &file, "--out", alone.to_str().unwrap(), "--set", set[0], "--set", set[1]]);
    assert!(output.status.success(), "{}", stderr(&output));
    let states = fs::read_to_string(alone.join("states.csv")).unwrap();
    let swept: Vec<&str> = table.lines().filter_map(|line| line.strip_prefix("8,10,20,[],")).collect();
    assert_eq!(swept, states.lines().skip(1).collect::<Vec<_>>());
}

/// The printed JSON equals the table; figures can be requested on the command line.
#[test]
fn printed_json_equals_the_table() {
    let (_folder, file, out) = place(SCENARIO);
    let figures = r#"sweep.figures=["black.Y"]"#;
    let output = papilio(&["sweep", &file, "--out", &out, "--json", "--set", figures]);
    assert!(output.status.success(), "{}", stderr(&output));
    let all: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let table = fs::read_to_string(Path::new(&out).join("sweep.csv")).unwrap();
    let mut lines = table.lines();
    let titles: Vec<&str> = lines.next().unwrap().split(',').collect();
    let y = titles.iter().position(|title| *title == "Y").unwrap();
    let expected: Vec<f64> = lines.map(|line| line.split(',').nth(y).unwrap().parse().unwrap()).collect();
    let points = all["points"].as_array().unwrap();
    let rows = points.iter().flat_map(|point| point["rows"].as_array().unwrap());
    let printed: Vec<f64> = rows.map(|row| row["Y"].as_f64().unwrap()).collect();
    assert_eq!(printed.len(), expected.len());
    assert_eq!(printed, expected);
    assert_eq!(points[4]["swept"]["viewer.theta_deg"], 10);
    assert!(Path::new(&out).join("sweep_black.Y.svg").exists());
}

/// Every view is printed, and views are an axis of the figures.
#[test]
fn views_are_an_axis_of_the_figures() {
    let swept = "viewer.theta_deg = [0, 10, 20]\nlighting.directed = [[], [], []]\n";
    let text = SCENARIO.replace(&format!("[[sweep.axes]]\n{swept}"), "[viewer]\ntheta_deg = [8, 20]\n");
    for light in
        ["sweep.figures=[\"contrast_ratio\"]", "sweep.metrics=[\"contrast_ratio\", \"white.L_star\"]"]
    {
        let (_folder, file, out) = place(&text);
        let output = papilio(&["sweep", &file, "--out", &out, "--set", light]);
        assert!(output.status.success(), "{}", stderr(&output));
        let printed = stdout(&output);
        // The headings have three lines: quantities with their units.
        assert_eq!(printed.lines().count(), 3 + 5 * 2, "{printed}");
        let map = String::from_utf8(files(Path::new(&out))["sweep_contrast_ratio.svg"].clone()).unwrap();
        // The heading "Viewing angle (deg)" has several lines.
        for (drawn, listed) in [("viewing angle (deg)", "Viewing"), (">8<", "8"), (">20<", "20")] {
            assert!(map.contains(drawn) && printed.contains(listed), "{drawn}: {printed}");
        }
    }
}

/// Steps that do not reach the end of a range are noted, and the values end before it.
#[test]
fn range_that_its_steps_do_not_reach_is_noted() {
    let (_folder, file, out) = place(SCENARIO);
    let swept = |values: &str| {
        let axis = format!("display.diffuser.haze={values}");
        let output = papilio(&["sweep", &file, "--out", &out, "--axis", &axis, "--columns", "white.Y"]);
        assert!(output.status.success(), "{}", stderr(&output));
        let table = fs::read_to_string(Path::new(&out).join("sweep.csv")).unwrap();
        (table.lines().count() - 1, stderr(&output))
    };
    let (points, said) = swept("0.3:0.8:0.2");
    let note = "note: display.diffuser.haze: steps of 0.2 from 0.3 end at 0.7, before 0.8";
    assert!(points == 3 && said.contains(note), "{points}: {said}");
    let (points, said) = swept("0.3:0.8:0.1");
    assert!(points == 6 && !said.contains("before"), "{points}: {said}");
}

/// `--columns` chooses the columns of the table, and rows of views where no column is of a state. The journal
/// has all results.
#[test]
fn columns_of_the_table_can_be_chosen() {
    let (_folder, file, out) = place(SCENARIO);
    let table = |columns: &str| {
        let output = papilio(&["sweep", &file, "--out", &out, "--columns", columns]);
        assert!(output.status.success(), "{}", stderr(&output));
        fs::read_to_string(Path::new(&out).join("sweep.csv")).unwrap()
    };
    let by_view = table("contrast_ratio,white.Y,white.Y_de");
    let first = by_view.lines().next().unwrap();
    assert!(
        first.ends_with("lighting.directed,theta_deg,phi_deg,contrast_ratio,white.Y,white.Y_de"),
        "{first}"
    );
    assert_eq!(by_view.lines().count(), 1 + 15);
    let by_state = table("Y,L_star");
    assert!(by_state.lines().next().unwrap().ends_with("theta_deg,phi_deg,state,Y,L_star"), "{by_state}");
    assert_eq!(by_state.lines().count(), 1 + 15 * 8);
    let white = by_state.lines().nth(1).unwrap().rsplit(',').nth(1).unwrap();
    assert_eq!(by_view.lines().nth(1).unwrap().rsplit(',').nth(1), Some(white));
    for (columns, advice) in
        [("Lstar", "did you mean `L_star`?"), ("withe.Y", "no column `withe.Y`; did you mean `white.Y` or")]
    {
        let output = papilio(&["sweep", &file, "--out", &out, "--columns", columns]);
        assert_eq!(output.status.code(), Some(2), "{columns}");
        assert!(stderr(&output).contains(advice), "{}", stderr(&output));
    }
    // Without the option, the table is complete again.
    assert!(papilio(&["sweep", &file, "--out", &out]).status.success());
    assert_eq!(files(Path::new(&out))["sweep.csv"], undisturbed()["sweep.csv"]);
}

#[test]
fn impossible_merges_and_sweeps_are_refused() {
    let (folder, file, _) = place(&SCENARIO[..SCENARIO.find("[sweep]").unwrap()]);
    let none = folder.path().join("none");
    let merged = papilio(&["sweep", "merge", none.to_str().unwrap()]);
    assert_eq!(merged.status.code(), Some(2));
    assert!(stderr(&merged).contains("does not exist\n  = help: expected a folder"), "{}", stderr(&merged));
    for more in [&[][..], &["--set", "sweep.figures=[\"white.Y\"]"]] {
        let swept = papilio(&[&["sweep", &file][..], more].concat());
        assert_eq!(swept.status.code(), Some(2));
        assert!(stderr(&swept).contains("has no `[[sweep.axes]]`"), "{}", stderr(&swept));
    }
}

/// A sweep that is killed at many moments and resumed ends in the same bytes, and no point is computed twice.
#[test]
fn killed_sweep_is_resumed() {
    // Slow points: a busy machine polls rarely, and must still find an unfinished sweep.
    let slow = ["--set", "solver.method=monte-carlo", "--set", "solver.relative_error=0.0005"];
    let expected = uninterrupted_with(&slow);
    let mut dice = papilio_testing::Dice::new(1, 0);
    let mut patience = std::iter::repeat_with(|| dice.below(8) as u64);
    let mut amid = 0;
    // If the machine polled too rarely, the test starts again.
    for _ in 0..20 {
        let (_folder, file, out) = place(SCENARIO);
        let arguments = [&["sweep", &file, "--out", &out], &slow[..]].concat();
        amid += kills_until_done(&arguments, &Path::new(&out).join("sweep.jsonl"), &mut patience);
        same(&files(Path::new(&out)), &expected);
        // When all points are there, nothing is computed.
        let output = papilio(&arguments);
        assert!(stderr(&output).contains("15 points, 0 computed"), "{}", stderr(&output));
        same(&files(Path::new(&out)), &expected);
        if amid >= 3 {
            return;
        }
    }
    panic!("it was killed amid its work {amid} times only");
}

/// Starts a sweep repeatedly and kills it some milliseconds after its first progress, until it is complete.
/// Returns how often it was killed with some, but not all, points done.
fn kills_until_done(arguments: &[&str], journal: &Path, patience: &mut impl Iterator<Item = u64>) -> usize {
    let lines = || {
        let bytes = fs::read(journal).unwrap_or_default();
        bytes.iter().filter(|byte| **byte == b'\n').count().saturating_sub(1)
    };
    let (mut amid, mut before) = (0, 0);
    for _ in 0..100 {
        let mut child = Command::new(env!("CARGO_BIN_EXE_papilio"))
            .args(arguments)
            .args(["--threads", "1"])
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        // The progress of the sweep decides, and some chance, not a clock.
        while lines() <= before && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(patience.next().unwrap()));
        let over = child.try_wait().unwrap().is_some();
        let _ = child.kill();
        let output = child.wait_with_output().unwrap();
        if over {
            assert!(output.status.success(), "{}", stderr(&output));
            return amid;
        }
        before = lines();
        assert!(before <= 15, "{before} lines for 15 points");
        amid += usize::from((1..15).contains(&before));
    }
    panic!("it was killed a hundred times and is not done");
}

/// The point of an incomplete line is computed again.
#[test]
fn point_of_an_incomplete_line_is_computed_again() {
    let expected = undisturbed();
    let (_folder, file, out) = place(SCENARIO);
    fs::create_dir(&out).unwrap();
    let journal = &expected["sweep.jsonl"];
    fs::write(Path::new(&out).join("sweep.jsonl"), &journal[..journal.len() - 100]).unwrap();
    let output = papilio(&["sweep", &file, "--out", &out]);
    assert!(stderr(&output).contains("15 points, 1 computed"), "{}", stderr(&output));
    same(&files(Path::new(&out)), &expected);
}

/// A changed digit in a line that is still JSON is detected, in full and in compact sweeps; nothing is
/// written then.
#[test]
fn damaged_line_is_detected() {
    let light = SCENARIO.replace("[sweep]\n", "[sweep]\nmetrics = [\"contrast_ratio\", \"white.L_star\"]\n");
    for (text, name, before) in
        [(SCENARIO, "sweep.jsonl", "\"rows\":[[\""), (light.as_str(), "sweep-light.jsonl", "\"values\":[")]
    {
        let (_folder, file, out) = place(text);
        let arguments = ["sweep", &file, "--out", &out];
        assert!(papilio(&arguments).status.success());
        let journal = Path::new(&out).join(name);
        let whole = fs::read_to_string(&journal).unwrap();
        let line = whole.lines().nth(2).unwrap();
        fs::write(&journal, whole.replace(line, &line.replacen(before, &format!("{before}1"), 1))).unwrap();
        fs::remove_file(Path::new(&out).join("sweep.csv")).unwrap();
        let output = papilio(&arguments);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        for words in [
            &format!("{name}:3:1"),
            "this line of a journal is damaged",
            "= help: delete the line from the file",
        ] {
            assert!(stderr(&output).contains(words), "{words}: {}", stderr(&output));
        }
        assert!(!Path::new(&out).join("sweep.csv").exists());
    }
}

/// Merged shards of many machines equal the whole sweep.
#[test]
fn merged_shards_equal_the_whole() {
    let expected = undisturbed();
    let (folder, file, _) = place(SCENARIO);
    let parts: Vec<String> = (1..=3)
        .map(|k| {
            let out = folder.path().join(format!("part{k}")).to_str().unwrap().to_owned();
            let output = papilio(&["sweep", &file, "--out", &out, "--shard", &format!("{k}/3")]);
            assert!(output.status.success() && stderr(&output).contains("5 points"), "{}", stderr(&output));
            out
        })
        .collect();
    let whole = folder.path().join("whole");
    let whole_name = whole.to_str().unwrap();
    let missing = papilio(&["sweep", "merge", &parts[0], &parts[2], "--out", whole_name]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(stderr(&missing).contains("5 of 15 points are missing: 1, 4, 7, 10, 13"), "{}", stderr(&missing));
    assert!(!whole.exists());
    let output = papilio(&["sweep", "merge", &parts[0], &parts[1], &parts[2], "--out", whole_name]);
    assert!(output.status.success(), "{}", stderr(&output));
    let mut expected = expected;
    expected.remove("sweep.jsonl");
    same(&files(&whole), &expected);
    // The points of a shard count as done for the whole sweep in the same folder.
    let output = papilio(&["sweep", &file, "--out", &parts[0]]);
    assert!(stderr(&output).contains("15 points, 10 computed"), "{}", stderr(&output));
}

/// Points of a sweep are reused when the sweep is changed.
#[test]
fn extended_sweep_computes_only_new_points() {
    let (_folder, file, out) = place(SCENARIO);
    assert!(papilio(&["sweep", &file, "--out", &out]).status.success());
    fs::write(&file, SCENARIO.replace("from = 6, to = 14, count = 5", "from = 4, to = 14, count = 6"))
        .unwrap();
    let output = papilio(&["sweep", &file, "--out", &out]);
    assert!(stderr(&output).contains("18 points, 3 computed"), "{}", stderr(&output));
}

#[test]
fn wrong_sweeps_are_refused_with_their_place_before_anything_is_computed() {
    for (from, to, spot, words) in [
        (
            "\"display.pixel.film.1.thickness_nm\"",
            "\"display.pixel.film.1.thicknes_nm\"",
            "s.toml:22:1",
            "thickness_nm",
        ),
        ("[0, 10, 20]", "[0, 10, 95]", "s.toml:24:28", "out of range"),
        ("[0, 10, 20]", "[0, 10]", "s.toml:25:10", "has 3 values"),
        ("[0, 10, 20]", "[]", "s.toml:24:20", "at least one item"),
        ("[0, 10, 20]", "5", "s.toml:24:20", "a list of values"),
        ("count = 5", "step = -1", "s.toml:22:67", "do not lead from 6 to 14"),
        ("count = 5", "count = 5, step = 2", "s.toml:22:39", "more than one"),
        ("count = 5", "step = 1e-9", "s.toml:22:39", "expected at most 100000"),
        ("viewer.theta_deg", "sweep.theta_deg", "s.toml:24:7", "cannot be swept"),
        ("white.L_star", "white.Lstar", "s.toml:20:30", "L_star"),
        ("[[sweep.axes]]", "[[sweep.axis]]", "s.toml:21:9", "axes"),
    ] {
        let (_folder, file, out) = place(&SCENARIO.replace(from, to));
        let output = papilio(&["sweep", &file, "--out", &out]);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{to}: {text}");
        assert!(text.contains(spot) && text.contains(words), "{to}: {text}");
        assert!(output.stdout.is_empty() && !Path::new(&out).join("sweep.csv").exists());
    }
    let (_folder, file, out) = place(SCENARIO.split("[sweep]").next().unwrap());
    let output = papilio(&["sweep", &file, "--out", &out, "--shard", "3/2"]);
    assert_eq!(output.status.code(), Some(2));
}

/// `run` ignores `[sweep]`: the result and the hash are those of the scenario without it.
#[test]
fn run_ignores_the_sweep() {
    let hash = |text: &str| {
        let (_folder, file, _) = place(text);
        let output = papilio(&["run", &file, "--json"]);
        assert!(output.status.success(), "{}", stderr(&output));
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        result["hash"].as_str().unwrap().to_owned()
    };
    assert_eq!(hash(SCENARIO), hash(SCENARIO.split("[sweep]").next().unwrap()));
}

/// The option `--parquet`, if the program was built with it.
fn parquet() -> &'static [&'static str] {
    if HAS_PARQUET { &["--parquet"] } else { &[] }
}

#[test]
fn parquet_option_writes_the_table_or_is_refused() {
    let (_folder, file, out) = place(SCENARIO);
    let output = papilio(&["sweep", &file, "--out", &out, "--parquet"]);
    if !HAS_PARQUET {
        // A missing feature is reported before anything is computed.
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("feature `parquet`") && !Path::new(&out).exists());
        return;
    }
    assert!(output.status.success(), "{}", stderr(&output));
    let bytes = fs::read(Path::new(&out).join("sweep.parquet")).unwrap();
    assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
}

/// A compact sweep of a few metrics has the numbers of a full one, to the last digit, also in shards and
/// after kills.
#[test]
fn compact_sweep_has_the_numbers_of_a_full_one() {
    let text = SCENARIO.replace("[sweep]\n", "[sweep]\nmetrics = [\"contrast_ratio\", \"white.L_star\"]\n");
    let (folder, file, out) = place(&text);
    let output = papilio(&[&["sweep", &file, "--out", &out, "--json"], parquet()].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let light = files(Path::new(&out));
    let whole = String::from_utf8(undisturbed()["sweep.csv"].clone()).unwrap();
    let columns: Vec<&str> = whole.lines().next().unwrap().split(',').collect();
    let at = |name: &str| columns.iter().position(|column| *column == name).unwrap();
    let cells = |line: &str| -> Vec<String> { line.split(',').map(str::to_owned).collect() };
    let white = whole.lines().map(cells).filter(|row| row[at("state")] == "white");
    let expected: Vec<String> = white
        .map(|row| {
            [&row[..4], &[row[at("contrast_ratio")].clone(), row[at("L_star")].clone()]].concat().join(",")
        })
        .collect();
    let table = String::from_utf8(light["sweep.csv"].clone()).unwrap();
    assert_eq!(table.lines().skip(1).collect::<Vec<_>>(), expected);
    assert_eq!(light.keys().any(|name| name == "sweep.parquet"), HAS_PARQUET);
    assert!(light.contains_key("sweep_white.L_star_map.svg"));
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(printed["points"][14]["values"].as_array().unwrap().len(), 2);
    // Without requested figures, all stored metrics are drawn and listed.
    let bare = text.replace("figures = [\"contrast_ratio\", \"white.L_star\"]\n", "");
    let (_folder, file, out) = place(&bare);
    let output = papilio(&["sweep", &file, "--out", &out]);
    let listed = String::from_utf8(output.stdout).unwrap();
    assert!(
        bare != text && listed.contains("Lightness L* of") && listed.contains("Contrast ratio"),
        "{listed}"
    );
    assert!(files(Path::new(&out)).contains_key("sweep_white.L_star_map.svg"));

    let parts: Vec<String> = (1..=2)
        .map(|k| {
            let part = folder.path().join(format!("part{k}")).to_str().unwrap().to_owned();
            let shard = format!("{k}/2");
            let arguments = ["sweep", &file, "--out", &part, "--shard", &shard];
            assert!(papilio(&arguments).status.success());
            // As after a kill: one line is complete, the next is not.
            let journal = Path::new(&part).join(format!("sweep-light.{k}-of-2.jsonl"));
            let text = fs::read_to_string(&journal).unwrap();
            let two: usize = text.lines().take(2).map(|line| line.len() + 1).sum();
            fs::write(&journal, &text[..two + 9]).unwrap();
            let again = papilio(&arguments);
            assert!(!stderr(&again).contains(" 0 computed"), "{}", stderr(&again));
            assert_eq!(fs::read_to_string(&journal).unwrap(), text);
            part
        })
        .collect();
    let merged = folder.path().join("merged");
    let output = papilio(
        &[&["sweep", "merge", &parts[0], &parts[1], "--out", merged.to_str().unwrap()], parquet()].concat(),
    );
    assert!(output.status.success(), "{}", stderr(&output));
    let mut expected = light;
    expected.remove("sweep-light.jsonl");
    same(&files(&merged), &expected);
    let half = papilio(&["sweep", "merge", &parts[0], "--out", merged.to_str().unwrap()]);
    assert!(stderr(&half).contains("7 of 15 points are missing: 1, 3, 5"), "{}", stderr(&half));

    let wrong = text.replace("metrics = [\"contrast_ratio\"", "metrics = [\"contrast\"");
    fs::write(&file, &wrong).unwrap();
    let output = papilio(&["sweep", &file, "--out", &out]);
    for words in ["s.toml:20:12", "there is no metric `contrast`", "did you mean `contrast_ratio`"] {
        assert!(stderr(&output).contains(words), "{}", stderr(&output));
    }
    for (metrics, words) in [
        ("[]", "at least one item"),
        ("[\"white.Y\", \"contrast_ratio\", \"white.Y\"]", "`white.Y` is in this list twice"),
        ("[\"white.L_star\"]", "does not compute `contrast_ratio`, only white.L_star"),
    ] {
        let set = format!("sweep.metrics={metrics}");
        let output = papilio(&["sweep", &file, "--out", &out, "--set", &set]);
        assert!(stderr(&output).contains(words), "{metrics}: {}", stderr(&output));
    }
}

/// `--axis` replaces the axes of the file, or makes a sweep of any scenario: the table is that of the same
/// axes as TOML, byte for byte. A range may also be a text.
#[test]
fn axes_of_the_command_line_are_those_of_a_file() {
    let key = "display.pixel.film.1.thickness_nm";
    let axes = |first: &str| {
        format!("[[sweep.axes]]\n\"{key}\" = {first}\n[[sweep.axes]]\nviewer.theta_deg = [0, 12.5]\n")
    };
    let without = SCENARIO.split("[[sweep.axes]]").next().unwrap().to_owned();
    let table = |text: &str, more: &[&str]| {
        let (_folder, file, out) = place(text);
        let output = papilio(&[&["sweep", &file, "--out", &out, "--columns", "white.Y"], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        fs::read_to_string(Path::new(&out).join("sweep.csv")).unwrap()
    };
    let expected = table(&format!("{without}{}", axes("{ from = 10, to = 12, step = 0.5 }")), &[]);
    assert_eq!(expected.lines().count(), 1 + 5 * 2);
    assert_eq!(table(&format!("{without}{}", axes("\"10:12:0.5\"")), &[]), expected);
    let range = format!("{key}=10:12:0.5");
    for text in [&without, SCENARIO, without.split("[sweep]").next().unwrap()] {
        assert_eq!(table(text, &["--axis", &range, "--axis", "viewer.theta_deg=0,12.5"]), expected);
    }
    let listed = table(
        &without,
        &["--axis", &format!("{key}=10, 11.0"), "--axis", "display.pixel.film.0.material=SiO2,Cr:Johnson"],
    );
    assert!(listed.contains("\n1,10,Cr:Johnson,") && listed.contains("\n2,11,SiO2,"), "{listed}");
    let plain = without.split("[sweep]").next().unwrap();
    let compact = table(plain, &["--axis", &range, "--metrics", "white.Y,contrast_ratio"]);
    assert!(compact.starts_with(&format!("point,{key},")) && compact.lines().count() == 6, "{compact}");
    // Figures that the file names are of metrics that such a sweep does not compute.
    let drawn = format!("{plain}[sweep]\nfigures = [\"gamut_percent_srgb\"]\n");
    assert_eq!(table(&drawn, &["--axis", &range, "--metrics", "white.Y,contrast_ratio"]), compact);
}

/// What is not an axis is named with its place on the command line and what was expected.
#[test]
fn wrong_axes_of_the_command_line_are_named() {
    let (_folder, file, out) = place(SCENARIO);
    let raw = "sweep.axes=[{viewer.theta_deg=[0:20:10]}]";
    let steps = "sweep.axes=[{viewer.theta_deg={from=0,to=20,steps=3}}]";
    for (option, text, place, says) in [
        ("--axis", "viewer.theta_deg", "--axis #1:1:1", "this is not KEY=VALUES"),
        ("--axis", "viewer.theta_deg=", "--axis #1:1:1", "this is not KEY=VALUES"),
        ("--axis", "viewer.theta_deg=0:20", "--axis #1:1:18", "expected FROM:TO:STEP"),
        ("--axis", "viewer.theta_deg=0:20:-1", "--axis #1:1:18", "do not lead from 0 to 20"),
        ("--axis", "viewer.theta_deg=0,,20", "--axis #1", "a value is missing here"),
        ("--axis", "viewer.theta_dg=0,20", "--axis #1:1:1", "theta_deg"),
        ("--axis", "viewer.theta_deg=0,95", "--axis #1:1:20", "95"),
        ("--metrics", "white.Q", "--metrics:1:16", "white.Q"),
        ("--set", raw, "--set #1:1", "--axis KEY=190:194:1"),
        ("--set", steps, "--set #1:1", "`count` is the number of values"),
    ] {
        let output = papilio(&["sweep", &file, "--out", &out, option, text]);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{text}: {said}");
        assert!(said.contains(place) && said.contains(says), "{text}: {said}");
        assert!(!said.contains("hour"), "{text}: {said}");
    }
}

/// Table and figures of another sweep in the same folder are replaced, also by a compact one; other files
/// stay.
#[test]
fn files_of_an_earlier_sweep_are_removed() {
    let (_folder, file, out) = place(SCENARIO);
    assert!(papilio(&["sweep", &file, "--out", &out]).status.success());
    fs::write(Path::new(&out).join("notes.svg"), "").unwrap();
    for more in [&[][..], &["--metrics", "white.Y"][..]] {
        let axis = ["--axis", "viewer.theta_deg=0,5", "--set", "sweep.figures=[\"white.Y\"]"];
        let output = papilio(&[&["sweep", &file, "--out", &out], &axis[..], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        let figures: Vec<String> =
            files(Path::new(&out)).into_keys().filter(|name| !name.contains(".jsonl")).collect();
        assert_eq!(figures, ["notes.svg", "sweep.csv", "sweep_white.Y.svg"]);
    }
}
