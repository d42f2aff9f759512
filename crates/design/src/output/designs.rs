//! Designs as scenario files.
//!
//! A file is the text of the optimised scenario with the values of a design. Comments and order are
//! preserved.

use std::path::Path;

use crate::DesignError;
use crate::search::{Search, SelectedDesign};
use papilio_scenario::{Edit, edit, relative_path};

/// Returns file names and texts of the optimised scenario, one for each selected design: `best.toml` for a
/// single design, or `closest.toml` if it does not meet the constraints; `front-01.toml` and so on for
/// several.
///
/// `text` is a file of the folder `from`; paths in it are rewritten for the folder `to`.
///
/// # Errors
/// If `text` is not the scenario of the search.
pub fn design_texts(
    text: &str,
    [from, to]: [&Path; 2],
    search: &Search,
    selected: &[SelectedDesign],
) -> Result<Vec<(String, String)>, DesignError> {
    let file = |(index, selected_design): (usize, &SelectedDesign)| {
        let name = match selected.len() {
            1 if selected_design.meets_limits() => "best.toml".to_owned(),
            1 => "closest.toml".to_owned(),
            _ => format!("front-{:02}.toml", index + 1),
        };
        let set = |(path, value): (&str, serde_json::Value)| Edit::Set { path: path.to_owned(), value };
        let edits: Vec<Edit> =
            search.study().settings(&selected_design.design)?.into_iter().map(set).collect();
        Ok((name, moved(&edit(text, &edits)?, from, to)))
    };
    selected.iter().enumerate().map(file).collect()
}

/// Rewrites a text of the folder `from` for the folder `to`: strings that are paths of existing files,
/// relative to `from`, become relative to `to`.
pub fn moved(text: &str, from: &Path, to: &Path) -> String {
    let Some(prefix) = relative_path(to, from) else { return text.to_owned() };
    let line = |line: &str| {
        // Strings are the segments with odd index between quotes; strings of scenarios contain no quotes.
        let segment = |(index, segment): (usize, &str)| {
            let is_file = index % 2 == 1 && !segment.is_empty() && from.join(segment).is_file();
            if is_file { prefix.join(segment).display().to_string() } else { segment.to_owned() }
        };
        line.split('"').enumerate().map(segment).collect::<Vec<_>>().join("\"")
    };
    text.split('\n').map(line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moved_text_names_files_relative_to_the_new_folder() {
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
