//! The order of floors: no module of the crate uses one of a higher floor, and the solvers do not use each
//! other, by paths from `crate` or by `super`.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The modules of the crate from the lowest floor to the highest; a module may use those of its own floor and
/// of lower ones.
const FLOORS: [&[&str]; 5] = [
    &["numerics"],
    &["light"],
    &[
        "angular",
        "base",
        "cosines",
        "estimate",
        "front",
        "layers",
        "mirror_run",
        "mueller",
        "panel",
        "phases",
        "pixel_spread",
        "polarised_view",
        "skeleton",
        "specular",
        "stack",
        "window",
    ],
    &["adding", "walk"],
    &["spatial"],
];

/// Modules of one floor, or of neighbouring ones, that must not use each other: two roads to the same
/// numbers.
const APART: [[&str; 2]; 3] = [["adding", "walk"], ["walk", "adding"], ["spatial", "walk"]];

#[test]
fn no_module_uses_a_higher_floor() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let exported = exported(&source);
    let mut wrong = Vec::new();
    let mut uses = 0;
    for file in files(&source) {
        let name = file.strip_prefix(&source).unwrap().to_string_lossy().replace('\\', "/");
        let module = name.split('/').next().unwrap().trim_end_matches(".rs").to_owned();
        if module == "lib" {
            continue;
        }
        let own = floor(&module)
            .unwrap_or_else(|| panic!("{name}: give the module `{module}` a floor in this test"));
        for used in used(&code(&file), depth(&name)) {
            let used = exported.get(&used).cloned().unwrap_or(used);
            uses += 1;
            let Some(other) = floor(&used) else { continue };
            if other > own || APART.contains(&[&*module, &*used]) {
                wrong.push(format!("{name} uses `{used}`"));
            }
        }
    }
    assert!(uses > 500, "only {uses} uses were found: the test reads the sources wrongly");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn floor(module: &str) -> Option<usize> {
    FLOORS.iter().position(|modules| modules.contains(&module))
}

/// Returns the module that each name comes from which the crate exports at its root.
fn exported(source: &Path) -> BTreeMap<String, String> {
    let mut from = BTreeMap::new();
    let mut add = |code: &str, of: Option<&str>| {
        for statement in code.split("pub use ").skip(1) {
            let statement = statement.split(';').next().unwrap_or_default();
            let Some((module, names)) = statement.split_once("::") else { continue };
            for name in words(names) {
                from.insert(name, of.unwrap_or(module).to_owned());
            }
        }
    };
    add(&code(&source.join("lib.rs")), None);
    // `pub use layers::*` exports these.
    let layers = code(&source.join("layers/mod.rs"));
    add(&layers, Some("layers"));
    from.insert("Interface".to_owned(), "layers".to_owned());
    from
}

/// Returns how many times `super` leads from a file to the root of the crate.
fn depth(name: &str) -> usize {
    name.split('/').filter(|part| *part != "mod.rs").count()
}

/// Returns the first names of all paths that begin with `crate::`, or with as many times `super::` as lead to
/// the root.
fn used(code: &str, depth: usize) -> Vec<String> {
    let root = "super::".repeat(depth);
    let after = code.split("crate::").skip(1).chain(code.split(&root).skip(1));
    let names = after.flat_map(|rest| match rest.strip_prefix('{') {
        Some(list) => tops(list),
        None => words(rest).into_iter().take(1).collect(),
    });
    names.collect()
}

#[test]
fn paths_by_super_are_found() {
    assert_eq!([depth("panel.rs"), depth("adding/mod.rs"), depth("adding/panel/rings.rs")], [1, 1, 3]);
    let code =
        "use super::super::super::{walk, spatial::page};\nuse super::super::own;\nuse crate::layers::Flat;";
    assert_eq!(used(code, 3), ["layers", "walk", "spatial"]);
}

/// Returns the first name of each member of a list in braces, `a, b::{c, d}}`.
fn tops(list: &str) -> Vec<String> {
    let (mut depth, mut member, mut found) = (0, String::new(), Vec::new());
    for letter in list.chars() {
        match letter {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => found.extend(words(&std::mem::take(&mut member)).into_iter().next()),
            _ if depth == 0 => member.push(letter),
            _ => {}
        }
    }
    found.extend(words(&member).into_iter().next());
    found
}

fn words(text: &str) -> Vec<String> {
    let words = text.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
    words.filter(|word| !word.is_empty()).map(str::to_owned).collect()
}

/// Returns the code of a file without comments and without its tests.
fn code(file: &Path) -> String {
    let text = fs::read_to_string(file).unwrap();
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// Returns all source files but those of tests.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let nested = entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] });
    nested.filter(|path| !path.ends_with("tests.rs")).collect()
}
