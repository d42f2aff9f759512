//! `papilio optimize`: results, interrupted and resumed searches, wrong input.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use papilio_testing::everyday;

use crate::common::{files, papilio, place, stderr};

pub(crate) const SCENARIO: &str = r#"
title = "Bare"
[spectrum]
step_nm = 20
[display.pixel]
model = "film"
substrate = "Al"
area = { red = 0.4, green = 0.4, blue = 0.2 }
gap_nm = { red = 275.9, green = 192.3, blue = 137.8, dark = 20.0 }
film = [
  { material = "Si3N4", thickness_nm = 0 },              # the matching layer
  { material = "Cr:Johnson", thickness_nm = 12.15 },
  { material = "SiO2", thickness_nm = 38.6 },
  { material = "AlOx", thickness_nm = 9.0 },
  { material = "air", thickness_nm = "gap" },
]
[display.diffuser]
model = "k-correlation"
haze = 0.78
transmittance = 0.9
[solver]
relative_error = 0.01
[optimize]
starts = 3
evaluations = 200
points = 4
[[optimize.variables]]
key = "display.pixel.film.0.thickness_nm"
bounds = [0, 120]
[[optimize.variables]]
key = "display.pixel.film.0.material"
choices = ["Si3N4", "SiO2"]
[[optimize.variables]]
key = "display.pixel.film.1.thickness_nm"
bounds = [3, 25]
[[optimize.objectives]]
metric = "gamut_percent_srgb"
aim = "maximise"
[[optimize.constraints]]
metric = "contrast_ratio"
at_least = 4
"#;

pub(crate) const SECOND_AIM: &str = "[[optimize.objectives]]\nmetric = \"white.Y\"\naim = \"maximise\"\n";

fn search(file: &str, out: &str, more: &[&str]) -> Output {
    let output = papilio(&[&["optimize", file, "--out", out, "--no-check"], more].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    output
}

/// The best design is better than the scenario's, meets its limit, keeps the comments, and runs without
/// changes.
#[test]
fn search_finds_and_writes_a_better_design() {
    let (_folder, file, out) = place(SCENARIO);
    let output = search(&file, &out, &["--json"]);
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let gamut = |of: &serde_json::Value| of["quantities"]["gamut_percent_srgb"].as_f64().unwrap();
    let best = &found["designs"][0];
    assert!(gamut(best) > gamut(&found["scenario"]) + 1.0, "{found:#}");
    assert!(best["quantities"]["contrast_ratio"].as_f64().unwrap() > 4.0 - 1e-4);
    assert_eq!(best["meets_limits"], true);
    let text = fs::read_to_string(Path::new(&out).join("best.toml")).unwrap();
    assert!(text.contains("# the matching layer"), "{text}");
    let best_file = Path::new(&out).join("best.toml");
    let run = papilio(&["run", best_file.to_str().unwrap(), "--json"]);
    assert!(run.status.success(), "{}", stderr(&run));
    let result: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
    assert_eq!(result["views"][0]["gamut_percent_srgb"], best["quantities"]["gamut_percent_srgb"]);
    let names: Vec<String> = files(Path::new(&out)).into_keys().collect();
    assert_eq!(names, ["best.toml", "optimize.csv", "optimize.jsonl", "trace.svg"]);
}

/// The report of a front marks variables at an end of their range, and both solvers compute every design of
/// it, to the target of the scenario: a tenth of the usual one would be met with a tenth of its error.
#[test]
fn front_marks_ends_of_ranges_and_is_checked_design_by_design() {
    // Both aims want less of the absorber than the range allows.
    let text = format!("{SCENARIO}{SECOND_AIM}").replace("bounds = [3, 25]", "bounds = [13, 15]");
    let (_folder, file, out) = place(&text);
    let output = papilio(&["optimize", &file, "--out", &out, "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let designs = found["designs"].as_array().unwrap();
    assert!(designs.len() > 1);
    for design in designs {
        let ends = design["at_end"].as_array().unwrap();
        assert!(ends.iter().any(|key| key == "display.pixel.film.1.thickness_nm"), "{design:#}");
    }
    let checked = found["checked_by_walk"].as_array().unwrap();
    assert_eq!(checked.len(), 3 * designs.len());
    let mut largest = 0.0_f64;
    for one in checked {
        let number = |key: &str| one[key].as_f64().unwrap();
        let design = &designs[one["design"].as_u64().unwrap() as usize - 1];
        assert_eq!(one["adding"], design["quantities"][one["name"].as_str().unwrap()]);
        let [adding, walk, error] = ["adding", "walk", "standard_error"].map(number);
        assert!((adding - walk).abs() < 5.0 * error + 0.01 * adding, "{one}");
        largest = largest.max(if one["name"] == "contrast_ratio" { error / walk } else { 0.0 });
    }
    // The contrast has the error of its darkest state, to which the target of 1 % applies.
    assert!((0.002..0.02).contains(&largest), "{largest}");
    let report = papilio(&["optimize", &file, "--out", &out]);
    let text = String::from_utf8(report.stdout).unwrap();
    assert_eq!(text.matches("13.000 (at its end)").count(), designs.len(), "{text}");
    assert!(text.contains(&format!("the {} designs of the front by both solvers", designs.len())), "{text}");
}

/// Wherever a journal is cut off, and however many threads resume the search, the results of descents, fronts
/// and populations are the same, byte for byte.
#[test]
fn resumed_search_ends_as_an_uninterrupted_one() {
    for (name, more) in [("descents", ""), ("front", SECOND_AIM), ("population", "")] {
        let text = format!("{SCENARIO}{more}");
        let text = if name == "population" {
            text.replace("[optimize]", "[optimize]\nmethod = \"both\"")
        } else {
            text
        };
        let (_folder, file, out) = place(&text);
        search(&file, &out, &["--threads", "1"]);
        let whole = files(Path::new(&out));
        let journal = Path::new(&out).join("optimize.jsonl");
        let bytes = fs::read(&journal).unwrap();
        let parts = [bytes.len() / 3, bytes.len() - 1, 2 * bytes.len() / 3, 0];
        for part in everyday(2, parts) {
            files(Path::new(&out))
                .keys()
                .for_each(|name| fs::remove_file(Path::new(&out).join(name)).unwrap());
            fs::write(&journal, &bytes[..part]).unwrap();
            search(&file, &out, &["--threads", "3"]);
            let gone_on = files(Path::new(&out));
            assert_eq!(gone_on.keys().collect::<Vec<_>>(), whole.keys().collect::<Vec<_>>(), "{name}");
            for (file, bytes) in &gone_on {
                assert!(*bytes == whole[file], "{name}: {file} differs after a kill at {part}");
            }
        }
    }
}

/// Shards in separate folders, then merged, give the same bytes as one run: descents, and a front whose
/// shards have the first round in common.
#[test]
fn merged_shards_equal_one_search() {
    for more in ["", SECOND_AIM] {
        let (folder, file, out) = place(&format!("{SCENARIO}{more}"));
        search(&file, &out, &[]);
        let whole = files(Path::new(&out));
        let parts = [1, 2].map(|k| folder.path().join(format!("part-{k}")).display().to_string());
        for (k, part) in parts.iter().enumerate() {
            let said = search(&file, part, &["--shard", &format!("{}/2", k + 1)]);
            assert!(stderr(&said).contains(&format!("shard {} of 2 is done", k + 1)), "{}", stderr(&said));
            let names: Vec<String> = files(Path::new(part)).into_keys().collect();
            assert_eq!(names, [format!("optimize.{}-of-2.jsonl", k + 1)]);
        }
        let merged = folder.path().join("merged").display().to_string();
        let [one, two] = parts.each_ref().map(String::as_str);
        let said = search(&file, &merged, &["--merge", one, "--merge", two]);
        if more.is_empty() {
            assert!(stderr(&said).contains(", 0 of them now,"), "{}", stderr(&said));
        }
        for (name, bytes) in files(Path::new(&merged)) {
            // best.toml names the scenario's files relative to its own folder; here there are none.
            assert!(bytes == whole[&name], "{name}");
        }
        // Shards of another search are refused, and existing files stay.
        let other = ["optimize", &file, "--out", &merged, "--merge", one, "--set", "optimize.seed=7"];
        let refused = papilio(&other);
        assert_eq!(refused.status.code(), Some(2));
        assert!(
            stderr(&refused).contains("this journal belongs to a different scenario"),
            "{}",
            stderr(&refused)
        );
        assert!(files(Path::new(&merged)).iter().all(|(name, bytes)| *bytes == whole[name]));
    }
    let (_folder, file, out) = place(&SCENARIO.replace("[optimize]", "[optimize]\nmethod = \"global\""));
    let refused = papilio(&["optimize", &file, "--out", &out, "--shard", "2/2"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("the first round of this search has 1 task\n"), "{}", stderr(&refused));
    assert!(!Path::new(&out).exists());
}

/// A changed scenario keeps the journal of the previous one; when the change is undone, nothing is computed.
#[test]
fn changed_search_sets_the_journal_aside() {
    let (_folder, file, out) = place(SCENARIO);
    let journal = |name: &str| fs::read(Path::new(&out).join(name)).ok();
    let said = |text: &str| {
        fs::write(&file, text).unwrap();
        stderr(&search(&file, &out, &[]))
    };
    assert!(!said(SCENARIO).contains("was moved to"));
    let first = journal("optimize.jsonl");
    let changed = SCENARIO.replace("at_least = 4", "at_least = 5");
    assert!(said(&changed).contains("optimize.jsonl.before"));
    let second = journal("optimize.jsonl");
    assert_ne!(first, second);
    assert_eq!(journal("optimize.jsonl.before"), first);
    let text = said(SCENARIO);
    assert!(text.contains(" 0 of them now"), "{text}");
    assert_eq!([journal("optimize.jsonl"), journal("optimize.jsonl.before")], [first.clone(), second]);
    // A third scenario: the journal of the second one is kept.
    said(&SCENARIO.replace("at_least = 4", "at_least = 3"));
    assert_eq!(journal("optimize.jsonl.before"), first);
}

/// Ctrl-C: completed evaluations are saved, nothing else is written, and the program says how to resume.
#[cfg(unix)]
#[test]
fn interrupted_search_is_saved() {
    let text = SCENARIO.replace("starts = 3\nevaluations = 200", "starts = 5000\nevaluations = 1000000");
    let (_folder, file, out) = place(&text);
    let child = Command::new(env!("CARGO_BIN_EXE_papilio"))
        .args(["optimize", &file, "--out", &out, "--threads", "1"])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let journal = Path::new(&out).join("optimize.jsonl");
    let lines = || fs::read(&journal).unwrap_or_default().iter().filter(|byte| **byte == b'\n').count();
    while lines() < 3 {
        std::thread::sleep(Duration::from_millis(1));
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("run the same command again to resume"), "{}", stderr(&output));
    assert_eq!(files(Path::new(&out)).into_keys().collect::<Vec<_>>(), ["optimize.jsonl"]);
}

/// No design of a Pareto front dominates another.
#[test]
fn designs_of_a_front_do_not_dominate_each_other() {
    let (_folder, file, out) = place(&format!("{SCENARIO}{SECOND_AIM}"));
    let output = search(&file, &out, &["--json"]);
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let designs = found["designs"].as_array().unwrap();
    assert!(designs.len() >= 3, "{found:#}");
    let of = |design: &serde_json::Value, name: &str| design["quantities"][name].as_f64().unwrap();
    for pair in designs.windows(2) {
        assert!(of(&pair[0], "gamut_percent_srgb") >= of(&pair[1], "gamut_percent_srgb") - 1e-4);
        assert!(of(&pair[0], "white.Y") <= of(&pair[1], "white.Y") + 1e-6);
    }
    assert!(files(Path::new(&out)).contains_key("front-01.toml"));
    assert!(files(Path::new(&out)).contains_key("front.svg"));
}

#[test]
fn wrong_input_is_refused_and_nothing_is_written() {
    for (from, to, said) in [
        ("[optimize]\nstarts = 3", "[optimise]\nstarts = 3", "did you mean `optimize`?"),
        ("bounds = [3, 25]", "bounds = [25, 3]", "the first bound, 25, is above the second, 3"),
        ("at_least = 4", "at_leest = 4", "did you mean `at_least`?"),
        ("contrast_ratio", "contrast_ration", "did you mean `contrast_ratio`?"),
    ] {
        let (_folder, file, out) = place(&SCENARIO.replace(from, to));
        let output = papilio(&["optimize", &file, "--out", &out]);
        assert_eq!(output.status.code(), Some(2), "{to}");
        assert!(stderr(&output).contains(said), "{to}: {}", stderr(&output));
        assert!(stderr(&output).contains("s.toml:"), "{to}: {}", stderr(&output));
        assert!(!Path::new(&out).exists());
    }
}

/// Descents evaluate no more than their part of the budget; a search that the budget ends says so.
#[test]
fn search_that_used_its_evaluations_says_so() {
    for (evaluations, said) in [("60", "6 of 6 gradient searches stopped"), ("60000", "")] {
        let (_folder, file, out) = place(SCENARIO);
        let output =
            search(&file, &out, &["--json", "--set", &format!("optimize.evaluations={evaluations}")]);
        assert!(stderr(&output).contains(said), "{}", stderr(&output));
        assert_eq!(stderr(&output).contains("used up"), !said.is_empty(), "{}", stderr(&output));
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(found["evaluations"].as_u64().unwrap() <= evaluations.parse().unwrap(), "{found:#}");
    }
}

/// If all variables are choices, each combination is tried, and no descent is ended early.
#[test]
fn search_over_choices_tries_each_combination() {
    let without = |text: &str, from: &str, to: &str| {
        let at = text.find(from).unwrap();
        let end = at + text[at..].find(to).unwrap();
        [&text[..at], &text[end..]].concat()
    };
    let one = "[[optimize.variables]]\nkey = \"display.pixel.film.0.thickness_nm\"";
    let other = "[[optimize.variables]]\nkey = \"display.pixel.film.1.thickness_nm\"";
    let text = without(SCENARIO, one, "[[optimize.variables]]\nkey = \"display.pixel.film.0.material\"");
    let text = without(&text, other, "[[optimize.objectives]]").replace("starts = 3", "starts = 100");
    let (_folder, file, out) = place(&text.replace("thickness_nm = 0 }", "thickness_nm = 50 }"));
    let output = search(&file, &out, &[]);
    assert!(!stderr(&output).contains("used up"), "{}", stderr(&output));
}

/// Limits that no design meets are reported.
#[test]
fn limits_that_no_design_meets_are_reported() {
    let (_folder, file, out) = place(SCENARIO);
    search(&file, &out, &[]);
    assert!(Path::new(&out).join("best.toml").is_file());
    // After exit code 0 a script would continue, with the best.toml of an earlier search.
    fs::write(&file, SCENARIO.replace("at_least = 4", "at_least = 400")).unwrap();
    let output = papilio(&["optimize", &file, "--out", &out, "--no-check", "--json"]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert!(stderr(&output).contains("no feasible design was found"), "{}", stderr(&output));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["designs"][0]["meets_limits"], false);
    let names: Vec<String> =
        files(Path::new(&out)).into_keys().filter(|name| name.ends_with(".toml")).collect();
    assert_eq!(names, ["closest.toml"]);
    // The change is undone.
    fs::write(&file, SCENARIO).unwrap();
    search(&file, &out, &[]);
    let names: Vec<String> =
        files(Path::new(&out)).into_keys().filter(|name| name.ends_with(".toml")).collect();
    assert_eq!(names, ["best.toml"]);
}

/// A changed digit in a line and a missing generation of a population are detected; the search is not
/// resumed.
#[test]
fn damaged_journal_is_refused() {
    let (_folder, file, out) = place(&SCENARIO.replace("[optimize]", "[optimize]\nmethod = \"both\""));
    search(&file, &out, &[]);
    let journal = Path::new(&out).join("optimize.jsonl");
    let whole = fs::read_to_string(&journal).unwrap();
    let refused = |text: &str, words: &[&str]| {
        fs::write(&journal, text).unwrap();
        let output = papilio(&["optimize", &file, "--out", &out, "--no-check"]);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        words.iter().for_each(|word| assert!(stderr(&output).contains(word), "{word}: {}", stderr(&output)));
        assert_eq!(fs::read_to_string(&journal).unwrap(), text, "what was kept stays");
    };
    let lines: Vec<&str> = whole.lines().collect();
    let digit = lines[2].rfind(",\"crc\"").unwrap() - 2;
    let other = if lines[2].as_bytes()[digit] == b'1' { "2" } else { "1" };
    let changed = [&lines[2][..digit], other, &lines[2][digit + 1..]].concat();
    let text = whole.replace(lines[2], &changed);
    refused(&text, &["optimize.jsonl:3:1", "checksum", "delete the line from the file"]);
    refused(&whole.replacen("papilio", "papilip", 1), &["optimize.jsonl:1:1", "the first line"]);
}
