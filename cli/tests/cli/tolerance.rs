//! `papilio tolerance`: results, interrupted and resumed analyses, shards, more samples, wrong input.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use papilio_testing::sized;
use serde_json::Value;

use crate::common::{files, papilio, place, same, stderr, stdout};

/// A bare film pixel: fast, but slow enough that its analysis can be killed.
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
[tolerance]
samples = 96
sensitivity_samples = 32
[[tolerance.keys]]
name = "absorber"
key = "display.pixel.film.1.thickness_nm"
normal = { sigma = 0.3 }
[[tolerance.keys]]
name = "gaps"
keys = ["display.pixel.gap_nm.red", "display.pixel.gap_nm.green"]
uniform = { plus_minus = 4 }
[[tolerance.keys]]
name = "matching layer"
key = "display.pixel.film.0.material"
choices = { values = ["Si3N4", "AlOx"], weights = [3, 1] }
[[tolerance.correlations]]
keys = ["gaps", "absorber"]
coefficient = -0.5
[[tolerance.limits]]
metric = "contrast_ratio"
at_least = 1.1
[[tolerance.limits]]
metric = "white.Y"
at_least = 0.1
at_most = 0.185
"#;

fn undisturbed() -> BTreeMap<String, Vec<u8>> {
    let (_folder, file, out) = place(SCENARIO);
    let output = papilio(&["tolerance", &file, "--out", &out]);
    assert!(output.status.success(), "{}", stderr(&output));
    files(Path::new(&out))
}

/// The report agrees with the table of all displays, and a display of the table with `papilio run`.
#[test]
fn report_agrees_with_its_displays() {
    let (folder, file, out) = place(SCENARIO);
    let output = papilio(&["tolerance", &file, "--out", &out, "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["groups"], serde_json::json!([["absorber", "gaps"], ["matching layer"]]));
    let table = fs::read_to_string(Path::new(&out).join("tolerance.csv")).unwrap();
    let mut lines = table.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let at = |name: &str| columns.iter().position(|column| *column == name).unwrap();
    assert_eq!(rows.len(), 96);
    let good = rows.iter().filter(|row| row[at("good")] == "1").count();
    assert_eq!(report["verdict"]["yield_share"]["value"], serde_json::json!(good as f64 / 96.0));
    assert!((1..96).contains(&good), "limits that decide nothing show nothing: {good}");
    // The worst display has the smallest contrast of all, or a white outside its limits.
    let least = report["metrics"][0]["spread"]["range"][0].as_f64().unwrap();
    let contrasts = rows.iter().map(|row| row[at("contrast_ratio")].parse::<f64>().unwrap());
    assert_eq!(contrasts.fold(f64::INFINITY, f64::min), least);

    let row = &rows[5];
    let deviation = row[at("gaps")].parse::<f64>().unwrap() - 275.9;
    let set = [
        format!("display.pixel.film.1.thickness_nm={}", row[at("absorber")]),
        format!("display.pixel.gap_nm.red={}", row[at("gaps")]),
        format!("display.pixel.gap_nm.green={}", 192.3 + deviation),
        format!("display.pixel.film.0.material={}", row[at("matching layer")]),
    ];
    let alone = folder.path().join("run");
    let mut arguments = vec!["run", &file, "--json", "--out", alone.to_str().unwrap()];
    set.iter().for_each(|set| arguments.extend(["--set", set]));
    let output = papilio(&arguments);
    assert!(output.status.success(), "{}", stderr(&output));
    let run: Value = serde_json::from_slice(&output.stdout).unwrap();
    let (run, row) = (run["views"][0]["contrast_ratio"].as_f64().unwrap(), row[at("contrast_ratio")]);
    // Designs of colours take as many angles of the film as an error of 1e-5 of Y needs (docs/designs.md);
    // here, 6e-8.
    assert!((run - row.parse::<f64>().unwrap()).abs() < 1e-6 * run, "{run} {row}");
}

#[test]
fn terminal_shows_yield_and_reasons() {
    let (_folder, file, out) = place(SCENARIO);
    let output = papilio(&["tolerance", &file, "--out", &out]);
    let text = stdout(&output);
    for words in [
        "Bare\n96 displays, and 96 more for sensitivities",
        "yield ",
        "fails alone",
        "first-order index / total-order index",
        "largest violation",
        // The unit of a key that has a name of its own.
        "  Absorber (nm)  ",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
    assert!(text.lines().all(|line| !line.ends_with(' ')), "{text}");
    let again = papilio(&["tolerance", &file, "--out", &out]);
    assert!(stderr(&again).contains("96 samples, 0 computed"), "{}", stderr(&again));
    assert_eq!(stdout(&again), text);
}

/// A grey has a* of 0 but for rounding, which no key causes: no indices, and a line that says so.
#[test]
fn metric_that_does_not_vary_has_no_indices() {
    let text = r#"
title = "Grey"
[display.pixel]
model = "uniform"
kind = "lambertian"
reflectance = { white = 0.8, black = 0.1 }
[lighting]
preset = "office"
[tolerance]
samples = 64
sensitivity_samples = 32
metrics = ["white.Y", "white.a_star", "black.Y"]
[[tolerance.keys]]
key = "display.pixel.reflectance.white"
normal = { sigma = 0.02 }
[[tolerance.keys]]
key = "lighting.illuminance_lx"
normal = { sigma = 20 }
"#;
    let (_folder, file, out) = place(text);
    let said = stdout(&papilio(&["tolerance", &file, "--out", &out]));
    let line = "do not vary, so no key has a part in them: CIELAB a* of white, Luminance factor Y of black";
    assert!(said.contains(line), "{said}");
    let output = papilio(&["tolerance", &file, "--out", &out, "--json"]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let metrics = &report["metrics"];
    assert!(metrics[0]["indices"][0]["first"]["value"].as_f64().unwrap() > 0.99, "{metrics}");
    for metric in [1, 2] {
        let of = &metrics[metric];
        assert_eq!((&of["indices"], &of["surrogate"]), (&serde_json::json!([null, null]), &Value::Null));
    }
}

/// An analysis that is killed and resumed, on one thread or on three, ends in the same bytes.
#[test]
fn resumed_analysis_equals_an_uninterrupted_one() {
    let expected = undisturbed();
    let (_folder, file, out) = place(SCENARIO);
    let journal = Path::new(&out).join("tolerance.jsonl");
    let lines = || fs::read(&journal).map_or(0, |text| text.iter().filter(|byte| **byte == b'\n').count());
    let mut child = Command::new(env!("CARGO_BIN_EXE_papilio"))
        .args(["tolerance", &file, "--out", &out, "--threads", "1"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while lines() < 10 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let done = lines();
    assert!((10..97).contains(&done), "killed too early or too late: {done}");
    // As after a kill in the middle of a line.
    let mut text = fs::read(&journal).unwrap();
    text.extend(b"{\"row\":");
    fs::write(&journal, text).unwrap();
    let output = papilio(&["tolerance", &file, "--out", &out, "--threads", "3"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(!stderr(&output).contains("96 computed"), "{}", stderr(&output));
    same(&files(Path::new(&out)), &expected);
}

/// Shards in separate folders are merged by the same command.
#[test]
fn merged_shards_equal_the_whole() {
    let expected = undisturbed();
    let (folder, file, out) = place(SCENARIO);
    let parts: Vec<String> =
        (1..=3).map(|k| folder.path().join(format!("part{k}")).to_str().unwrap().to_owned()).collect();
    for (k, part) in parts.iter().enumerate() {
        let shard = format!("{}/3", k + 1);
        let output = papilio(&["tolerance", &file, "--out", part, "--shard", &shard]);
        assert!(output.status.success(), "{}", stderr(&output));
    }
    let merge: Vec<&str> = parts.iter().flat_map(|part| ["--merge", part.as_str()]).collect();
    let output = papilio(&[&["tolerance", &file, "--out", &out][..], &merge].concat());
    assert!(stderr(&output).contains(" 0 computed"), "{}", stderr(&output));
    same(&files(Path::new(&out)), &expected);
    // Shards of another analysis are refused.
    let output =
        papilio(&[&["tolerance", &file, "--out", &out, "--set", "tolerance.seed=5"][..], &merge].concat());
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("this journal belongs to a different scenario"), "{}", stderr(&output));
}

/// More samples extend the known ones; other limits need no new ones; another seed needs all.
#[test]
fn known_samples_are_not_computed_again() {
    let (_folder, file, out) = place(SCENARIO);
    let computed = |set: &[&str]| {
        let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        let output = papilio(&[&["tolerance", &file, "--out", &out][..], &set].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        let text = stderr(&output);
        let line = text.lines().find(|line| line.contains(" computed in ")).unwrap().to_owned();
        line.split(" computed").next().unwrap().rsplit(' ').next().unwrap().parse::<usize>().unwrap()
    };
    assert_eq!(computed(&["tolerance.samples=64"]), 64);
    assert_eq!(computed(&[]), 32);
    assert_eq!(computed(&["tolerance.limits.0.at_least=1.2"]), 0);
    assert_eq!(computed(&["tolerance.sensitivity_samples=48"]), 16);
    assert_eq!(computed(&["tolerance.seed=1", "tolerance.samples=64"]), 64);
}

/// Another distribution keeps the journal of the previous one; when the change is undone, nothing is
/// computed.
#[test]
fn changed_distribution_sets_the_journal_aside() {
    let (_folder, file, out) = place(SCENARIO);
    let said = |text: &str| {
        fs::write(&file, text).unwrap();
        let output = papilio(&["tolerance", &file, "--out", &out]);
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output)
    };
    let first = said(SCENARIO);
    assert!(!first.contains("was moved to"), "{first}");
    let done = files(Path::new(&out));
    assert!(said(&SCENARIO.replace("sigma = 0.3", "sigma = 0.4")).contains("tolerance.jsonl.before"));
    assert_eq!(files(Path::new(&out))["tolerance.jsonl.before"], done["tolerance.jsonl"]);
    let again = said(SCENARIO);
    assert!(again.contains(", 0 computed"), "{again}");
    let mut now = files(Path::new(&out));
    assert!(now.remove("tolerance.jsonl.before").is_some());
    same(&now, &done);
}

#[test]
fn mistakes_are_reported_with_their_place() {
    // A change of the text, and words of the message that it causes.
    let cases: &[(&str, &str, &[&str])] = &[
        ("normal = { sigma = 0.3 }", "normal = { sigma = -1 }", &["s.toml:25:20", "-1 is out of range"]),
        (
            "uniform = { plus_minus = 4 }",
            "uniform = { plus_minus = 400 }",
            &["is out of range", "s.toml:29:26", "a display of this production has this value\n"],
        ),
        (
            "normal = { sigma = 0.3 }",
            "",
            &["none of `normal`, `lognormal`, `uniform`, `triangular` and `choices` is given"],
        ),
        (
            "normal = { sigma = 0.3 }",
            "normal = { sigma = 30 }",
            &[
                "is out of range",
                "s.toml:25:20",
                "expected a number from 0",
                "`from` and `to` exclude such displays",
            ],
        ),
        ("film.1.thickness_nm\"\nnormal", "film.1.thick\"\nnormal", &["s.toml:24:7", "no key `thick`"]),
        (
            "film.1.thickness_nm\"\nnormal = {",
            "film.1.thicknes_nm\"\nnormal = { mean = 3,",
            &["no key `thicknes_nm`", "did you mean `thickness_nm`?"],
        ),
        ("film.1.thickness_nm", "film.7.thickness_nm", &["s.toml:24:7", "this array has the indices 0 to 2"]),
        ("film.1.thickness_nm", "film.-1.thickness_nm", &["indices start at 0: this array has 0 to 2"]),
        (
            "gap_nm.green\"]",
            "gap_nm.gren\"]",
            &["s.toml:28:37", "no sub-pixel `gren`", "did you mean `green`?"],
        ),
        (
            "key = \"display.pixel.film.1",
            "key = \"display.pixle.film.1",
            &["no key `pixle`", "did you mean `pixel`?"],
        ),
        ("coefficient = -0.5", "coefficient = -1", &["-1 is out of range"]),
        ("\"gaps\", ", "\"gap\", ", &["no key with a distribution is named `gap`", "did you mean `gaps`?"]),
        ("weights = [3, 1]", "weights = [3]", &["1 weights for 2 values", "expected 2 weights"]),
        ("\"AlOx\"]", "\"Alox\"]", &["no material named `Alox`"]),
        ("metric = \"white.Y\"", "metric = \"whit.Y\"", &["no state `whit`", "did you mean `white`?"]),
        ("metric = \"white.Y\"", "metric = \"Y\"", &["no metric `Y`", "did you mean `white.Y`?"]),
        ("at_least = 1.1", "", &["neither `at_least` nor `at_most`"]),
        (
            "at_least = 1.1",
            "at_least = 1.1\nview = 3",
            &["3 is out of range", "the number of a view, 0 to 0"],
        ),
        (
            "name = \"gaps\"\nkeys",
            "name = \"gaps\"\nkey = \"a\"\nkeys",
            &["more than one of `key` and `keys` is given"],
        ),
        (
            "gap_nm.green\"]",
            "gap_nm.red\"]",
            &[
                "s.toml:28:37",
                "`display.pixel.gap_nm.red` has more than one distribution",
                "expected each key",
            ],
        ),
        (
            "film.0.material\"",
            "film\"",
            &[
                "s.toml:32:7",
                "`display.pixel.film` and `display.pixel.film.1.thickness_nm` set the same value",
            ],
        ),
        (
            "normal = { sigma = 0.3 }",
            "triangular = { from = 11, to = 12, mode = 13 }",
            &[
                "s.toml:25:43",
                "the mode, 13, is outside the range from 11 to 12",
                "expected a number from 11 to 12",
            ],
        ),
        (
            "normal = { sigma = 0.3 }",
            "triangular = { from = 11, to = 12 }",
            &["s.toml:25:14", "the mode, the scenario's value, 12.15, is outside", "without `mode`"],
        ),
        (
            "[\"gaps\", \"absorber\"]",
            "[\"gaps\", \"gaps\"]",
            &["s.toml:35:17", "`gaps` is in this list twice"],
        ),
        (
            "[tolerance]\n",
            "[tolerance]\nmetrics = [\"white.Y\", \"white.Y\"]\n",
            &["s.toml:20:23", "`white.Y` is in this list twice"],
        ),
        (
            "coefficient = -0.5\n",
            "coefficient = -0.5\n[[tolerance.correlations]]\nkeys = [\"absorber\", \"gaps\"]\ncoefficient = 0.4\n",
            &[
                "s.toml:39:15",
                "the correlation of `absorber` and `gaps` is -0.5 above, and 0.4 here",
                "expected one coefficient for each pair",
            ],
        ),
        (
            "coefficient = -0.5\n",
            "coefficient = -0.9\n[[tolerance.correlations]]\nkeys = [\"gaps\", \"matching layer\"]\ncoefficient = 0.9\n\
             [[tolerance.correlations]]\nkeys = [\"absorber\", \"matching layer\"]\ncoefficient = 0.9\n",
            &["s.toml:40:1", "is not positive definite", "expected coefficients that fit", "help: "],
        ),
        (
            "display.pixel]\nmodel",
            "display.pixel]\ndefault_states = false\nstates = { white = { red = 1, green = 1, blue = 1 } }\nmodel",
            &[
                "s.toml:40:10",
                "`contrast_ratio` is not defined: there is no state `black`",
                "with `white`, `black`",
            ],
        ),
    ];
    for (from, to, words) in cases {
        assert!(SCENARIO.contains(from), "{from}");
        let (_folder, file, out) = place(&SCENARIO.replacen(from, to, 1));
        let output = papilio(&["tolerance", &file, "--out", &out]);
        assert_eq!(output.status.code(), Some(2), "{from} -> {to}: {}", stdout(&output));
        words.iter().for_each(|words| assert!(stderr(&output).contains(words), "{to}: {}", stderr(&output)));
        assert!(!Path::new(&out).exists(), "wrong input writes nothing: {to}");
    }
    let (_folder, file, out) = place(&SCENARIO[..SCENARIO.find("[tolerance]").unwrap()]);
    let output = papilio(&["tolerance", &file, "--out", &out]);
    assert!(stderr(&output).contains("the scenario has no `[tolerance]`"), "{}", stderr(&output));
}

/// docs/tolerance.md states the results of the shipped example. Every day, a smaller production agrees with
/// it within errors: a yield that is wrong by 8 % is detected.
#[test]
fn numbers_in_docs_equal_those_of_the_example() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let (_folder, _, out) = place("");
    let file = root.join("scenarios/tolerance.toml");
    let without = ["--set", "tolerance.sensitivity_samples=0", "--json"];
    let few = sized(&["--set", "tolerance.samples=256"][..], &[]);
    let output =
        papilio(&[&["tolerance", file.to_str().unwrap(), "--out", &out], &without[..], few].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let share = &found["verdict"]["yield_share"];
    let [found, error] = ["value", "standard_error"].map(|key| 100.0 * share[key].as_f64().unwrap());
    let docs = fs::read_to_string(root.join("docs/tolerance.md")).unwrap();
    let (_, said) = docs.split_once("\nyield ").unwrap();
    let (said, _) = said.split_once(" %\n").unwrap();
    if few.is_empty() {
        assert_eq!(said, format!("{found:.2} +- {error:.2}"));
    } else {
        let said: f64 = said.split(' ').next().unwrap().parse().unwrap();
        assert!(error < 2.0 && (said - found).abs() < 4.0 * error, "{said}: {found} {error}");
    }
}

/// A changed digit in a line that is still JSON is detected; when the line is removed, its sample is computed
/// again.
#[test]
fn damaged_journal_is_refused() {
    let (_folder, file, out) = place(SCENARIO);
    let arguments = ["tolerance", &file, "--out", &out];
    assert!(papilio(&arguments).status.success());
    let done = files(Path::new(&out));
    let journal = Path::new(&out).join("tolerance.jsonl");
    let whole = fs::read_to_string(&journal).unwrap();
    let line = whole.lines().nth(4).unwrap();
    let changed = line.replacen("\"values\":[", "\"values\":[1", 1);
    fs::write(&journal, whole.replace(line, &changed)).unwrap();
    let output = papilio(&arguments);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    for words in
        ["tolerance.jsonl:5:1", "its checksum does not match its content", "delete the line from the file"]
    {
        assert!(stderr(&output).contains(words), "{words}: {}", stderr(&output));
    }
    assert!(!stderr(&output).contains("sweep"), "{}", stderr(&output));
    fs::write(&journal, whole.replace(&format!("{line}\n"), "")).unwrap();
    let output = papilio(&arguments);
    assert!(stderr(&output).contains(" 1 computed in "), "{}", stderr(&output));
    same(&files(Path::new(&out)), &done);
    // A journal of a version without checksums is continued, and gets them at its end.
    let old: String =
        whole.lines().map(|line| format!("{}}}\n", &line[..line.rfind(",\"crc\"").unwrap()])).collect();
    fs::write(&journal, old).unwrap();
    let output = papilio(&arguments);
    assert!(stderr(&output).contains(" 0 computed in "), "{}", stderr(&output));
    same(&files(Path::new(&out)), &done);
}

/// No first-order index exceeds its total index, each has its error, and both are computed from the displays
/// of the table.
#[test]
fn first_order_indices_do_not_exceed_total_indices() {
    let (_folder, file, out) = place(SCENARIO);
    let output = papilio(&["tolerance", &file, "--out", &out]);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = stdout(&output);
    let table = &text[text.find("fraction of the variance, %").unwrap()..];
    let number = |cell: &str| cell.split('(').next().unwrap().parse::<f64>().unwrap();
    let mut pairs = 0;
    for line in table.lines().skip(2).take_while(|line| !line.is_empty()) {
        let words: Vec<&str> = line.split_whitespace().collect();
        for at in (0..words.len()).filter(|at| words[*at] == "/") {
            assert!(words[at - 1].contains('(') && words[at + 1].contains('('), "{line}");
            assert!(number(words[at - 1]) <= number(words[at + 1]), "{line}");
            pairs += 1;
        }
    }
    assert!(pairs >= 2, "{table}");
    let found: Value =
        serde_json::from_slice(&fs::read(Path::new(&out).join("tolerance.json")).unwrap()).unwrap();
    let metric = &found["metrics"][0];
    assert!(metric["surrogate"]["terms"].as_u64().unwrap() > 1, "{metric:#}");
    assert!(metric["surrogate"]["unexplained"].as_f64().unwrap() < 0.01, "{metric:#}");
}
