//! Each row of the table, wherever a name can be written.

use std::path::Path;

use super::*;
use crate::{Edit, ParameterisedScenario, Scenario, edit, migrate};

const PIXEL: &str =
    "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.5, black = 0.1 }\n";

/// A scenario with this line in the table at a pattern of [`RENAMED`]; it need not resolve.
fn scenario(table: &str, line: &str) -> String {
    let of_file = ["fill", "extrapolate_tails", "spectral_mean"].iter().any(|key| line.contains(key));
    let model = match of_file {
        true => "model = \"measured\"\nfile = \"a.bsdf\"",
        false => "model = \"k-correlation\"\nhaze = 0.5\ntotal_transmittance = 0.9",
    };
    match table {
        "solver" | "display.glass" => format!("{PIXEL}[{table}]\n{line}\n"),
        "display.diffuser" => format!("{PIXEL}[{table}]\n{model}\n{line}\n"),
        "display.layers.*" if line.starts_with("kind") => format!("{PIXEL}[[display.layers]]\n{line}\n"),
        "display.layers.*" => format!("{PIXEL}[[display.layers]]\nkind = \"diffuser\"\n{model}\n{line}\n"),
        "display.pixel" => {
            format!("[display.pixel]\nmodel = \"measured\"\nfile = {{ white = \"a.bsdf\" }}\n{line}\n")
        }
        "lighting" => format!("{PIXEL}[lighting]\n{line}\n"),
        "lighting.environment.*" => format!(
            "{PIXEL}[[lighting.environment]]\nmodel = \"luminaire\"\nshare = 1\nfile = \"a.ies\"\nelevation_deg = 40\n\
             distance_m = 2\n{line}\n"
        ),
        "optimize.variables.*" => format!(
            "{PIXEL}[[optimize.variables]]\nkey = \"display.pixel.reflectance.white\"\nbounds = [0, 1]\n{line}\n\
             [[optimize.objectives]]\nmetric = \"white.Y\"\naim = \"maximise\"\n"
        ),
        other => panic!("no scenario has a table {other}: add one"),
    }
}

/// Every place of every row: the table, the old line and the new one.
fn places() -> Vec<(String, String, String)> {
    let mut places = Vec::new();
    for row in RENAMED {
        match row {
            Key { tables, old, new } => {
                let value = match *new {
                    "per_wavelength" | "extrapolate_tails" => "true",
                    "regular_fraction" => "0.1",
                    "rotation_deg" => "10",
                    "compensated_by" => "\"display.pixel.reflectance.black\"",
                    other => panic!("no value for {other}: add one"),
                };
                let line = |key: &str| format!("{key} = {value}");
                places.extend(tables.iter().map(|table| ((*table).to_owned(), line(old), line(new))));
            }
            Choice { keys, old, new } => {
                for key in *keys {
                    let (table, key) = key.rsplit_once('.').unwrap();
                    let lines = [format!("{key} = \"{old}\""), format!("{key} = {}", new.written())];
                    let [old, new] = lines;
                    places.push((table.to_owned(), old, new));
                }
            }
        }
    }
    places
}

fn read(text: &str, overrides: &[String]) -> Scenario {
    Scenario::from_text(text, "test.toml", Path::new(""), overrides)
        .unwrap_or_else(|errors| panic!("{text}\n{errors}"))
}

fn filled(scenario: &Scenario) -> serde_json::Value {
    serde_json::to_value(scenario.filled()).unwrap()
}

#[test]
fn old_name_in_file_reads_as_new_name_with_one_note() {
    for (table, old, new) in places() {
        let (old, new) = (read(&scenario(&table, &old), &[]), read(&scenario(&table, &new), &[]));
        assert_eq!(filled(&old), filled(&new), "{table}");
        assert_eq!((old.notes.len(), new.notes.len()), (1, 0), "{table}: {:?} {:?}", old.notes, new.notes);
        assert!(old.notes[0].contains("old name"), "{:?}", old.notes);
    }
}

#[test]
fn old_name_in_set_replaces_either_name_of_the_file() {
    for (table, old, new) in places() {
        let path = |line: &str| {
            let (key, value) = line.split_once(" = ").unwrap();
            format!("{}.{key}={value}", table.replace('*', "0"))
        };
        let given = |text: &str, line: &str| read(text, &[path(line)]);
        let expected = filled(&read(&scenario(&table, &new), &[]));
        for text in [scenario(&table, &old), scenario(&table, &new)] {
            for set in [&old, &new] {
                assert_eq!(filled(&given(&text, set)), expected, "{table}: {set} over\n{text}");
            }
        }
        let keys = [&old, &new].map(|line| line.split(" = ").next().unwrap().to_owned());
        if keys[0] != keys[1] {
            let both = [path(&old), path(&new)];
            let errors =
                Scenario::from_text(&scenario(&table, &new), "test.toml", Path::new(""), &both).unwrap_err();
            assert!(errors.to_string().contains("two names of one key"), "{errors}");
        }
    }
}

#[test]
fn both_names_in_one_table_are_refused() {
    for (table, old, new) in places() {
        let key = |line: &str| line.split(" = ").next().unwrap().to_owned();
        if key(&old) != key(&new) {
            let text = scenario(&table, &format!("{old}\n{new}"));
            let errors = Scenario::from_text(&text, "test.toml", Path::new(""), &[]).unwrap_err().to_string();
            assert!(errors.contains(&format!("`{}` and `{}`", key(&old), key(&new))), "{errors}");
        }
    }
}

#[test]
fn old_name_as_varied_path_is_the_new_one() {
    for (table, old, new) in places().into_iter().filter(|(table, ..)| !table.starts_with("optimize")) {
        let varied = |line: &str| {
            let (key, value) = line.split_once(" = ").unwrap();
            let value: toml::Value = format!("x = {value}").parse::<toml::Table>().unwrap()["x"].clone();
            let path = format!("{}.{key}", table.replace('*', "0"));
            let text = scenario(&table, &new);
            let varied =
                ParameterisedScenario::from_text(&text, "test.toml", Path::new(""), &[], &[path]).unwrap();
            filled(&varied.scenario(&[serde_json::to_value(value).unwrap()]).unwrap())
        };
        assert_eq!(varied(&old), varied(&new), "{table}");
    }
}

#[test]
fn edit_changes_the_key_under_the_name_in_the_text() {
    for (table, old, new) in places() {
        for (there, set) in [(&old, &new), (&new, &old), (&old, &old)] {
            let (key, value) = set.split_once(" = ").unwrap();
            let value: toml::Value = format!("x = {value}").parse::<toml::Table>().unwrap()["x"].clone();
            let path = format!("{}.{key}", table.replace('*', "0"));
            let set = Edit::Set { path, value: serde_json::to_value(value).unwrap() };
            let text = edit(&scenario(&table, there), &[set]).unwrap();
            assert_eq!(filled(&read(&text, &[])), filled(&read(&scenario(&table, &new), &[])), "{text}");
        }
    }
}

#[test]
fn migrated_text_has_the_new_name_and_no_note() {
    for (table, old, new) in places() {
        let migrated = migrate(&scenario(&table, &old), "test.toml").unwrap();
        assert_eq!(migrated.text.replace("format = 2\n\n", ""), scenario(&table, &new));
        assert!(read(&migrated.text, &[]).notes.is_empty());
        assert!(!migrated.renamed.is_empty());
    }
}

#[test]
fn migrated_studies_have_the_new_names_in_their_paths_and_values() {
    let old = r#"[[sweep.axes]]
solver.method = ["adding", "walk"] # both
[[sweep.axes]]
"display.diffuser.straight_through" = [0, 0.1]
"display.glass.surface" = ["coated", "fresnel"]
[[optimize.conditions]]
name = "a"
set = { "display.diffuser.straight_through" = 0.1, solver.every_bin = true }
[[tolerance.keys]]
key = "display.layers.0.straight_through"
uniform = { plus_minus = 0.1 }
[[tolerance.keys]]
key = "display.glass.surface"
choices = { values = ["coated", "fresnel"] }
"#;
    let new = r#"format = 2

[[sweep.axes]]
solver.method = ["adding", "monte-carlo"] # both
[[sweep.axes]]
"display.diffuser.regular_fraction" = [0, 0.1]
"display.glass.surface" = ["ideal-ar", "fresnel"]
[[optimize.conditions]]
name = "a"
set = { "display.diffuser.regular_fraction" = 0.1, solver.per_wavelength = true }
[[tolerance.keys]]
key = "display.layers.0.regular_fraction"
uniform = { plus_minus = 0.1 }
[[tolerance.keys]]
key = "display.glass.surface"
choices = { values = ["ideal-ar", "fresnel"] }
"#;
    let migrated = migrate(old, "test.toml").unwrap();
    assert_eq!(migrated.text, new);
    assert_eq!(migrated.renamed.iter().map(|one| one.line).collect::<Vec<_>>(), [2, 4, 5, 8, 8, 10, 14]);
}

#[test]
fn both_names_of_a_key_in_a_study_are_refused() {
    let condition = "[[optimize.conditions]]\nname = \"a\"\nset = { \"solver.every_bin\" = true, \"solver.per_wavelength\" = false }\n";
    assert!(migrate(condition, "test.toml").is_err());
    let variables = "[[optimize.variables]]\nkey = \"display.pixel.reflectance.white\"\nbounds = [0, 1]\n\
                     [[optimize.objectives]]\nmetric = \"white.Y\"\naim = \"maximise\"\n";
    let text = format!("{PIXEL}{variables}{condition}");
    let errors = Scenario::from_text(&text, "test.toml", Path::new(""), &[]).unwrap_err().to_string();
    assert!(errors.contains("two names of one key"), "{errors}");
}

#[test]
fn new_names_are_not_old_names() {
    for (i, row) in RENAMED.iter().enumerate() {
        let Key { tables, new, .. } = row else { continue };
        for table in *tables {
            let table: Vec<&str> = table.split('.').collect();
            assert_eq!(new_key(&table, new), None, "row {i} is renamed once more: let it give the last name");
        }
    }
}

/// The matrix once had a key that had to be 0: files and `--set` that have it still read, with one note;
/// other values are an error.
#[test]
fn keys_that_exist_no_more_are_ignored_where_they_had_their_only_value() {
    let text = format!("{PIXEL}[display.matrix]\nppi = 100\n");
    let known = filled(&read(&text, &[]));
    for (text, set) in [
        (format!("{text}spread_um = 0\n"), vec![]),
        (format!("{text}spread_um = 0.0\n"), vec![]),
        (text.clone(), vec!["display.matrix.spread_um=0".to_owned()]),
        (text.clone(), vec!["display.matrix={ppi=100, spread_um=0.0}".to_owned()]),
    ] {
        let scenario = read(&text, &set);
        assert_eq!(filled(&scenario), known, "{text} {set:?}");
        let notes: Vec<_> = scenario.notes.iter().filter(|note| note.contains("spread_um")).collect();
        assert_eq!(notes.len(), 1, "{notes:?}");
        assert!(notes[0].contains("display.pixel.spread_um"), "{notes:?}");
    }
    let other = format!("{text}spread_um = 3\n");
    let refused = Scenario::from_text(&other, "test.toml", Path::new(""), &Vec::<String>::new());
    assert!(refused.is_err_and(|errors| errors.to_string().contains("spread_um")));
}
