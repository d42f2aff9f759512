//! No light is computed while a scenario is read: what takes time is prepared with the scene, with progress
//! and Ctrl-C.

use std::fs;
use std::path::{Path, PathBuf};

/// Words of code that follows light: a solver and its control, rays of a surface, lobes that are balanced.
const LIGHT: [&str; 11] = [
    "Control<",
    "Control::",
    "Prepared",
    "papilio_display::run",
    "adding::",
    "walk::Walk",
    ".replicate(",
    ".replicates(",
    ".measured(",
    "wave_lobes",
    "BalancedLobe",
];

#[test]
fn reading_a_scenario_computes_no_light() {
    let mut wrong = Vec::new();
    let files = files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    for file in &files {
        let text = fs::read_to_string(file).unwrap();
        let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
        for (number, line) in code.enumerate() {
            let found = LIGHT.iter().filter(|word| line.contains(**word));
            wrong.extend(found.map(|word| format!("{}:{}: {word}", file.display(), number + 1)));
        }
    }
    assert!(files.len() > 50, "only {} files were found", files.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect()
}
