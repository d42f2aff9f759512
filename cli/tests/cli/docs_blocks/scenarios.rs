//! Blocks of TOML: scenarios, surfaces, and fragments of them.

use std::path::Path;

use papilio_scenario::{Fit, Optimisation, Scenario, ScenarioErrors, SurfaceScenario, Sweep, Tolerance};
use toml::{Table, Value};

/// Reads a scenario, or a fragment in place of the tables of its base, and resolves it.
pub(super) fn check(text: &str, base: Option<&str>, folder: &Path, is_resolved: bool) -> Result<(), String> {
    let text = match base {
        Some(base) => merged(base, text)?,
        None => text.to_owned(),
    };
    let keys = parse(&text)?;
    let has = |key: &str| keys.contains_key(key);
    let none: [String; 0] = [];
    let check = || -> Result<(), ScenarioErrors> {
        if has("microgeometry") {
            let surface = SurfaceScenario::from_text(&text, "block", folder, &none)?;
            return if is_resolved { surface.resolve().map(drop) } else { Ok(()) };
        }
        let scenario = Scenario::from_text(&text, "block", folder, &none)?;
        match (is_resolved, has("image")) {
            (true, true) => drop(scenario.resolve_with_picture()?),
            (true, false) => drop(scenario.resolve()?),
            (false, _) => {}
        }
        if has("sweep") {
            let sweep = Sweep::from_text(&text, "block", folder, &none)?;
            sweep.scenario(sweep.len() - 1)?.resolve()?;
        }
        if has("optimize") {
            Optimisation::from_text(&text, "block", folder, &none)?;
        }
        if has("tolerance") {
            Tolerance::from_text(&text, "block", folder, &none)?;
        }
        if has("fit") {
            Fit::from_text(&text, "block", folder, &none)?;
        }
        Ok(())
    };
    check().map_err(|errors| errors.to_string())
}

fn parse(text: &str) -> Result<Table, String> {
    text.parse::<Table>().map_err(|error| error.to_string())
}

/// The base, with the tables and top-level keys of the fragment in the place of its own.
fn merged(base: &str, fragment: &str) -> Result<String, String> {
    let (mut all, new) = (parse(base)?, parse(fragment)?);
    let mut done: Vec<Vec<&str>> = Vec::new();
    for path in paths(fragment) {
        if done.iter().any(|before| path.starts_with(before)) {
            continue;
        }
        let value = path
            .iter()
            .try_fold(&Value::Table(new.clone()), |value, key| value.get(key).ok_or(*key))
            .cloned();
        let value = value.map_err(|key| format!("the test does not find `{key}` of `{}`", path.join(".")))?;
        set(&mut all, &path, value)?;
        done.push(path);
    }
    toml::to_string(&all).map_err(|error| error.to_string())
}

/// Paths of the headers of a text, and of the keys above the first one.
fn paths(text: &str) -> Vec<Vec<&str>> {
    let (mut paths, mut in_table, mut depth) = (Vec::new(), false, 0_i32);
    for line in text.lines() {
        let line = line.split('#').next().unwrap_or_default().trim();
        let key = if depth > 0 {
            None // a list or a table that goes on
        } else if line.starts_with('[') {
            in_table = true;
            Some(line.trim_matches(['[', ']']))
        } else {
            line.split_once('=').map(|(key, _)| key).filter(|_| !in_table)
        };
        paths.extend(key.map(|key| key.split('.').map(str::trim).collect()));
        let step = |c| i32::from("[{".contains(c)) - i32::from("]}".contains(c));
        depth += line.chars().map(step).sum::<i32>();
    }
    paths
}

fn set(all: &mut Table, path: &[&str], value: Value) -> Result<(), String> {
    let (last, above) = path.split_last().ok_or("an empty path")?;
    let mut table = all;
    for key in above {
        let inner = table.entry(*key).or_insert_with(|| Value::Table(Table::new()));
        table = inner.as_table_mut().ok_or_else(|| format!("`{key}` of the base is not a table"))?;
    }
    table.insert((*last).to_owned(), value);
    Ok(())
}

#[test]
fn tables_of_a_fragment_take_the_place_of_those_of_its_base() {
    let base = "a = 1\nb = 2\n[c]\nx = 1\ny = 2\n[c.d]\nz = 3\n[[e]]\nk = 1\n[[e]]\nk = 2\n";
    for (fragment, expected) in [
        ("[c]\nx = 5\n", "a = 1\nb = 2\n[c]\nx = 5\n[[e]]\nk = 1\n[[e]]\nk = 2\n"),
        (
            "[c.d]\nw = [\n  1,\n]\n",
            "a = 1\nb = 2\n[c]\nx = 1\ny = 2\n[c.d]\nw = [1]\n[[e]]\nk = 1\n[[e]]\nk = 2\n",
        ),
        (
            "a = 7\nc.y = 3\n[[e]]\nk = 9\n[e.f]\ng = 1\n",
            "a = 7\nb = 2\n[c]\nx = 1\ny = 3\n[c.d]\nz = 3\n[[e]]\nk = 9\nf.g = 1\n",
        ),
    ] {
        assert_eq!(parse(&merged(base, fragment).unwrap()), parse(expected), "{fragment}");
    }
    assert!(merged(base, "[a.b]\nx = 1\n").unwrap_err().contains("`a` of the base is not a table"));
}
