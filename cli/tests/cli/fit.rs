//! `papilio fit`: results, the fitted scenario, wrong input.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{files, papilio, papilio_command, place, same, scenario, stderr, stdout};

/// True values of the synthetic measurement, as its header states them.
const TRUTH: [(&str, f64); 8] = [
    ("display.pixel.gap_nm.red", 271.5),
    ("display.pixel.gap_nm.green", 194.5),
    ("display.pixel.gap_nm.blue", 139.5),
    ("display.pixel.gap_nm.dark", 18.2),
    ("display.pixel.film.1.thickness_nm", 11.6),
    ("display.pixel.film.2.thickness_nm", 40.1),
    ("display.pixel.fill_factor", 0.861),
    ("meter.scale", 1.004),
];

fn measured() -> String {
    scenario("fit").with_file_name("data/synthetic-film.csv").display().to_string()
}

/// The shipped example finds the true values of eight variables through the diffuser; its files have them, and
/// the fitted scenario keeps its comments, runs, and is the best start of another fit.
#[test]
fn example_finds_the_true_values() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("fit").display().to_string();
    let file = scenario("fit").display().to_string();
    let output = papilio(&["fit", &file, &measured(), "--out", &out, "--json", "--set", "fit.starts=2"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let written: Value =
        serde_json::from_slice(&fs::read(Path::new(&out).join("fit.json")).unwrap()).unwrap();
    assert_eq!(found, written);
    for (one, (key, truth)) in found["variables"].as_array().unwrap().iter().zip(TRUTH) {
        assert_eq!(one["key"], key);
        let [value, error] = ["value", "standard_error"].map(|name| one[name].as_f64().unwrap());
        assert!((value - truth).abs() < 4.0 * error, "{one:#}");
        let [inner, outer] =
            ["interval_68", "interval_95"].map(|name| [0, 1].map(|end| one[name][end].as_f64().unwrap()));
        assert!(
            outer[0] < inner[0] && inner[0] < value && value < inner[1] && inner[1] < outer[1],
            "{one:#}"
        );
        assert_eq!(one["at_bound"], false);
    }
    let freedom = found["degrees_of_freedom"].as_f64().unwrap();
    let chi_square = found["chi_square"].as_f64().unwrap();
    assert!((chi_square - freedom).abs() < 4.5 * (2.0 * freedom).sqrt(), "{chi_square} {freedom}");
    assert_eq!(found["undetermined"], Value::Array(Vec::new()));
    assert_eq!(found["correlations"][2][2].as_f64().map(|one| (one - 1.0).abs() < 1e-9), Some(true));
    let all = files(Path::new(&out));
    for name in ["fit.csv", "fit-spectra.svg", "fit-residuals.svg"] {
        assert!(all.contains_key(name), "{name}");
    }
    let text = fs::read_to_string(Path::new(&out).join("fitted.toml")).unwrap();
    assert!(text.starts_with("# Fitted to measured data") && text.contains("# as designed"), "{text}");
    assert!(text.contains("# display.pixel.gap_nm.red = 271"), "{text}");
    let fitted = Path::new(&out).join("fitted.toml").display().to_string();
    let run = papilio(&["run", &fitted, "--json"]);
    assert!(run.status.success(), "{}", stderr(&run));
    let again = papilio(&["fit", &fitted, &measured(), "--out", &out, "--json", "--set", "fit.starts=1"]);
    assert!(again.status.success(), "{}", stderr(&again));
    let again: Value = serde_json::from_slice(&again.stdout).unwrap();
    let text = fs::read_to_string(&fitted).unwrap();
    assert_eq!(text.matches("# display.pixel.gap_nm.red = 271").count(), 1, "{text}");
    assert!((again["chi_square"].as_f64().unwrap() - chi_square).abs() < 1e-2);
}

/// The same files on one thread and on two; the report of the terminal.
#[test]
fn files_do_not_depend_on_threads() {
    let (folder, file, _) = place(SMALL);
    let data = folder.path().join("data.csv");
    fs::write(&data, DATA).unwrap();
    let results = ["1", "2"].map(|threads| {
        let out = folder.path().join(threads).display().to_string();
        let output =
            papilio(&["fit", &file, &data.display().to_string(), "--out", &out, "--threads", threads]);
        assert!(output.status.success(), "{}", stderr(&output));
        (stdout(&output), files(Path::new(&out)))
    });
    same(&results[0].1, &results[1].1);
    assert_eq!(results[0].0, results[1].0);
    let text = &results[0].0;
    for words in ["Thickness of film layer 0 (nm)", "chi-square", "standard deviation of reflectances", "BIC"]
    {
        assert!(text.contains(words), "{words}: {text}");
    }
    // Without light between the pixels, the fill factor and the level of the meter have the same effect.
    let both = format!("{SMALL}{}", PAIR);
    fs::write(&file, both).unwrap();
    let out = folder.path().join("pair").display().to_string();
    let output = papilio(&["fit", &file, &data.display().to_string(), "--out", &out]);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(text.contains("the data cannot tell apart: display.pixel.fill_factor, meter.scale"), "{text}");
    assert!(text.contains("not determined"), "{text}");
    let fitted = fs::read_to_string(folder.path().join("pair/fitted.toml")).unwrap();
    assert!(fitted.contains("which the data cannot tell apart from meter.scale"), "{fitted}");
}

/// A fit to other data is written beside an earlier one, the same fit to its own folder.
#[test]
fn fit_to_other_data_does_not_replace_an_earlier_one() {
    let (folder, _, _) = place(SMALL);
    let fit = |data: &str| {
        fs::write(folder.path().join("data.csv"), data).unwrap();
        let output = papilio_command()
            .current_dir(folder.path())
            .args(["fit", "s.toml", "data.csv", "--set", "fit.starts=1"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        stderr(&output)
    };
    let own = Path::new("out").join("s").display().to_string();
    assert!(fit(DATA).contains(&format!("wrote {own}:")));
    let first = files(&folder.path().join(&own));
    let beside = fit(&DATA.replace("0.225", "0.226"));
    assert!(
        beside.contains("contains the fit of another scenario, of other keys, or to other data")
            && beside.contains(&format!("wrote {own}-")),
        "{beside}"
    );
    same(&first, &files(&folder.path().join(&own)));
    assert!(fit(DATA).contains(&format!("wrote {own}:")));
}

const SMALL: &str = r#"
title = "A film"
[spectrum]
range_nm = [400, 700]
step_nm = 10
[display.glass]
index = 1.0
surface = "fresnel"
[display.pixel]
model = "film"
substrate = 3.5
area = { one = 1.0 }
gap_nm = { one = 0.0 }
default_states = false
film = [{ material = { n = 1.5 }, thickness_nm = 230 }, { material = "air", thickness_nm = "gap" }]
[display.pixel.states]
film = { one = { gap_nm = 0.0 } }
[fit]
starts = 2
[[fit.variables]]
key = "display.pixel.film.0.thickness_nm"
bounds = [150, 300]
"#;

const PAIR: &str = r#"
[[fit.variables]]
key = "display.pixel.fill_factor"
bounds = [0.5, 1]
[[fit.variables]]
key = "meter.scale"
bounds = [0.8, 1.2]
"#;

/// About 220 nm of index 1.5 on 3.5, rounded.
const DATA: &str = "wavelength_nm,film\n400,0.14\n430,0.075\n460,0.055\n490,0.065\n520,0.088\n550,0.115\n580,0.145\n610,0.17\n640,0.19\n670,0.21\n700,0.225\n";

#[test]
fn wrong_fits_are_refused_at_their_places() {
    let (folder, file, _) = place("");
    let data = folder.path().join("data.csv").display().to_string();
    fs::write(&data, DATA).unwrap();
    let variable = "key = \"display.pixel.film.0.thickness_nm\"\nbounds = [150, 300]";
    for (wrong, words) in [
        ("", "there is nothing to fit: the scenario has no `[fit]`"),
        (
            "key = \"display.pixel.film.0.thicknes_nm\"\nbounds = [150, 300]",
            "there is no key `thicknes_nm` here",
        ),
        ("key = \"meter.offset\"\nbounds = [150, 300]", "there is no `meter.offset`"),
        ("key = \"meter.scale\"\nbounds = [2, 1]", "2 to 1 are no bounds of `meter.scale`"),
        (
            "keys = [\"meter.scale\", \"display.pixel.fill_factor\"]\nbounds = [0.5, 1]",
            "is a number of the measurement",
        ),
        ("key = \"display.pixel.film.0.thickness_nm\"\nbounds = [300, 150]", "is above the second"),
        ("key = \"display.pixel.film.0.thickness_nm\"\nbounds = [-5, 150]", "-5 is out of range"),
        ("key = \"display.pixel.film.0.thickness_nm\"", "the key `bounds` is missing"),
        ("key = \"fit.starts\"\nbounds = [1, 5]", "cannot be variables"),
        (
            "key = \"display.pixel.film.0.thickness_nm\"\nbounds = [150, 300]\nprior = { mean = 200, sigma = 0 }",
            "0 is out of range",
        ),
        (
            "key = \"display.pixel.film.0.thickness_nm\"\nbounds = [150, 300]\nprior = { mean = 400, sigma = 5 }",
            "the mean of the prior, 400, is outside the bounds",
        ),
        ("key = \"title\"\nbounds = [150, 300]", "`title` is not a number"),
        (
            "key = \"display.pixel.film.0.thickness_nm\"\nbounds = [150, 300]\nprior = { mean = 200, sigma = 1e-9 }",
            "the prior holds the value",
        ),
        ("key = \"display.pixel.film\"\nbounds = [150, 300]", "is a list in this scenario"),
        ("key = \"spectrum.range_nm\"\nbounds = [150, 300]", "is a setting, and no quantity"),
        (
            "key = \"display.pixel.film.2.thickness_nm\"\nbounds = [150, 300]",
            "`display.pixel.film` has no item 2: its items are 0 to 1",
        ),
        (
            "key = \"display.front.0.reflectance\"\nbounds = [0, 0.1]",
            "`display.front` has no item 0: it has none",
        ),
        ("key = \"display.frnt.0.reflectance\"\nbounds = [0, 0.1]", "there is no key `frnt` here"),
        (
            "key = \"display.pixel.film.1.material.k_scale\"\nbounds = [0.5, 2]",
            "write material = { material = \"air\", k_scale = 1 }",
        ),
    ] {
        let text = match wrong {
            "" => SMALL.split("[fit]").next().unwrap().to_owned(),
            wrong => SMALL.replace(variable, wrong),
        };
        fs::write(&file, text).unwrap();
        let output = papilio(&["fit", &file, &data]);
        assert_eq!(output.status.code(), Some(2), "{wrong}: {}", stdout(&output));
        assert!(stderr(&output).contains(words), "{wrong}: {}", stderr(&output));
        assert!(wrong.is_empty() || stderr(&output).contains("s.toml:2"), "{wrong}: {}", stderr(&output));
        // Other commands check the form of `[fit]`, too, and otherwise ignore it.
        if wrong.contains("sigma = 0") || wrong == "key = \"display.pixel.film.0.thickness_nm\"" {
            assert_eq!(papilio(&["run", &file, "--json"]).status.code(), Some(2), "{wrong}");
        }
    }
    fs::write(&file, SMALL).unwrap();
    assert!(papilio(&["run", &file, "--json"]).status.success());
    fs::write(&data, "wavelength_nm,other\n400,0.1\n700,0.2\n").unwrap();
    let output = papilio(&["fit", &file, &data]);
    assert!(
        output.status.code() == Some(2)
            && stderr(&output).contains(&format!("{data}: no measured state has a counterpart"))
            && stderr(&output).contains("no such state: other (its states are film)")
            && stderr(&output).contains("the names of states must equal"),
        "{}",
        stderr(&output)
    );
    let output = papilio(&["fit", &file, &data, &data]);
    assert!(
        output.status.code() == Some(2)
            && stderr(&output).contains("data.csv: this measurement is given twice")
    );
}

/// The row of a variable names all its keys; the scenario's own value is shown, also outside the bounds, and what is suspicious
/// is noted.
#[test]
fn rows_and_notes_state_what_the_user_must_know() {
    let (folder, file, _) = place(&SMALL.replace("thickness_nm = 230", "thickness_nm = 145"));
    let data = folder.path().join("data.csv").display().to_string();
    let out = folder.path().join("out").display().to_string();
    fs::write(&data, DATA).unwrap();
    let output = papilio(&["fit", &file, &data, "--out", &out]);
    assert!(output.status.success(), "{}", stderr(&output));
    let row = stdout(&output).lines().find(|line| line.contains("film layer 0")).unwrap().to_owned();
    assert!(row.contains("145.00"), "{row}");
    assert!(
        stderr(&output).contains("the scenario's own value, 145, is outside the bounds"),
        "{}",
        stderr(&output)
    );
    assert!(!stderr(&output).contains("about a hundred times"), "{}", stderr(&output));
    // In per cent, and with deviations that are far too small.
    let lines = DATA.lines().skip(1).map(|line| line.split_once(',').unwrap());
    let percent: String = lines
        .map(|(nm, value)| format!("film,{nm},{},0.1\n", 100.0 * value.parse::<f64>().unwrap()))
        .collect();
    fs::write(&data, format!("state,wavelength_nm,reflectance_factor,standard_deviation\n{percent}"))
        .unwrap();
    let two =
        "keys = [\"display.pixel.film.0.thickness_nm\", \"display.pixel.substrate\"]\nbounds = [1.2, 3.9]";
    let text = SMALL.replace("key = \"display.pixel.film.0.thickness_nm\"\nbounds = [150, 300]", two);
    fs::write(&file, text).unwrap();
    let output = papilio(&["fit", &file, &data, "--out", &out]);
    assert!(output.status.success(), "{}", stderr(&output));
    for words in ["and are read as per cent", "does not describe the data within the stated"] {
        assert!(stderr(&output).contains(words), "{words}: {}", stderr(&output));
    }
    assert!(!stderr(&output).contains("about a hundred times"), "{}", stderr(&output));
    let row = stdout(&output).lines().find(|line| line.contains("film layer 0")).unwrap().to_owned();
    assert!(row.to_lowercase().contains("substrate"), "{row}");
}

/// Numbers that the program itself has computed, without errors: the fit finds what they were computed with. With errors far above
/// its residuals, it does not call the intervals too narrow.
#[test]
fn exact_numbers_are_fitted() {
    let (folder, file, _) = place(SMALL);
    let path = |name: &str| folder.path().join(name).display().to_string();
    let truth = ["--set", "display.pixel.film.0.thickness_nm=231.7", "--out", &path("truth")];
    let output = papilio(&[&["run", &file], &truth[..]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let exact = path("truth/spectra.csv");
    let stated = path("stated.csv");
    let rows = fs::read_to_string(&exact).unwrap();
    let rows: Vec<String> = rows
        .lines()
        .enumerate()
        .map(|(row, line)| format!("{line},{}\n", if row == 0 { "standard_deviation" } else { "0.002" }))
        .collect();
    fs::write(&stated, rows.concat()).unwrap();
    for data in [exact, stated] {
        let output = papilio(&["fit", &file, &data, "--out", &path("fit"), "--json"]);
        assert!(output.status.success(), "{}", stderr(&output));
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        let value = found["variables"][0]["value"].as_f64().unwrap();
        assert!((value - 231.7).abs() < 1e-3, "{value}");
        assert!(!stderr(&output).contains("too narrow"), "{}", stderr(&output));
    }
}

/// The report counts the numbers of BIC; what was measured beside the view, and what the fitted scenario cannot have, is noted.
#[test]
fn report_counts_its_numbers_and_notes_their_direction() {
    let scale = "[[fit.variables]]\nkey = \"meter.scale\"\nbounds = [0.9, 1.1]\n";
    let (folder, file, out) = place(&format!("{SMALL}{scale}"));
    let data = folder.path().join("data.csv").display().to_string();
    let rows = DATA.lines().skip(1).map(|line| format!("film,8.6,{line}\n")).collect::<String>();
    fs::write(&data, format!("state,theta_deg,wavelength_nm,reflectance_factor\n{rows}")).unwrap();
    let output = papilio(&["fit", &file, &data, "--out", &out, "--set", "viewer.theta_deg=8"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(text.contains("(11 numbers)") && text.contains("9 degrees of freedom"), "{text}");
    for words in [
        "measured beside the view of 8 deg",
        "film at theta 8.6 deg",
        "meter.scale is in fitted.toml only as comments",
    ] {
        assert!(stderr(&output).contains(words), "{words}: {}", stderr(&output));
    }
    // One number for one variable.
    fs::write(&file, SMALL).unwrap();
    fs::write(&data, "metric,value,standard_deviation\nfilm.Y,0.12,0.001\n").unwrap();
    let output = papilio(&["fit", &file, &data, "--out", &out]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("1 number fitted in"), "{}", stderr(&output));
    assert!(stdout(&output).contains("0 degrees of freedom"), "{}", stdout(&output));
}

/// Warnings of the scenario are printed once, and are in the report.
#[test]
fn warnings_are_printed_once_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("fit").display().to_string();
    let file = scenario("fit").display().to_string();
    let narrow = ["--set", "spectrum.range_nm=[450,650]", "--set", "fit.starts=1"];
    let output = papilio(&[&["fit", &file, &measured(), "--out", &out, "--json"][..], &narrow[..]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let words = "colours are computed from 450 to 650 nm only";
    assert_eq!(stderr(&output).matches(words).count(), 1, "{}", stderr(&output));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let warnings: Vec<&str> =
        found["warnings"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert_eq!(warnings.iter().filter(|one| one.contains(words)).count(), 1, "{warnings:?}");
}
