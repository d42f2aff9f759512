//! Designs as scenarios: the text that was searched, with other numbers, its comments and its order kept.

use std::path::{Component, Path, PathBuf};

use papilio_design::DesignError;
use papilio_design::search::{Chosen, Search};
use papilio_scenario::{Edit, edit};

/// Names of files, and the scenario that was searched with each of these designs: `best.toml`, or `front-01.toml` and so on; of a
/// design that misses its limits `closest.toml`. The text is from one folder, and is to stand in another.
///
/// # Errors
/// If it is not the text that was searched.
pub fn design_texts(
    text: &str,
    [from, to]: [&Path; 2],
    search: &Search,
    chosen: &[Chosen],
) -> Result<Vec<(String, String)>, DesignError> {
    let one = |(at, one): (usize, &Chosen)| {
        let name = match chosen.len() {
            1 if one.meets_limits() => "best.toml".to_owned(),
            1 => "closest.toml".to_owned(),
            _ => format!("front-{:02}.toml", at + 1),
        };
        let set = |(path, value): (&str, serde_json::Value)| Edit::Set { path: path.to_owned(), value };
        let edits: Vec<Edit> = search.study().settings(&one.design)?.into_iter().map(set).collect();
        Ok((name, moved(&edit(text, &edits)?, from, to)))
    };
    chosen.iter().enumerate().map(one).collect()
}

/// A text from one folder as it is to stand in another: strings that name files beside it find them from there.
pub fn moved(text: &str, from: &Path, to: &Path) -> String {
    let Some(way) = way(to, from) else { return text.to_owned() };
    let line = |line: &str| {
        // Strings are the odd pieces between quotes; those of scenarios hold none.
        let piece = |(at, piece): (usize, &str)| {
            let is_file = at % 2 == 1 && !piece.is_empty() && from.join(piece).is_file();
            if is_file { way.join(piece).display().to_string() } else { piece.to_owned() }
        };
        line.split('"').enumerate().map(piece).collect::<Vec<_>>().join("\"")
    };
    text.split('\n').map(line).collect::<Vec<_>>().join("\n")
}

/// The relative path that leads from one folder to another.
fn way(from: &Path, to: &Path) -> Option<PathBuf> {
    let here =
        |path: &Path| std::path::absolute(if path.as_os_str().is_empty() { Path::new(".") } else { path });
    let (from, to) = (here(from).ok()?, here(to).ok()?);
    let (from, to): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (from.components().collect(), to.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = from[shared..].iter().map(|_| Component::ParentDir);
    Some(up.chain(to[shared..].iter().copied()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_from_the_new_folder() {
        let folder = tempfile::tempdir().unwrap();
        let (scenarios, out) = (folder.path().join("scenarios"), folder.path().join("out/s"));
        std::fs::create_dir_all(scenarios.join("data")).unwrap();
        std::fs::create_dir_all(&out).unwrap();
        std::fs::write(scenarios.join("data/a.csv"), "").unwrap();
        let text = "a = \"data/a.csv\" # \"data/b.csv\"\nb = \"Al\"\n";
        let moved = moved(text, &scenarios, &out);
        assert_eq!(moved, "a = \"../../scenarios/data/a.csv\" # \"data/b.csv\"\nb = \"Al\"\n");
        assert!(out.join("../../scenarios/data/a.csv").is_file());
    }
}
