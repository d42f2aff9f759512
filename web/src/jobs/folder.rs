//! The folder of a job: `designs` with the scenario and its files, `out` with the results, and `job.json`.
//!
//! The program that runs the job opens the files that the scenario names. Before it starts, every text of the scenario and of surfaces
//! is checked: none may be a path out of the folder, so that the page reads no file of the machine.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Component, Path};

use papilio_formats::DataFile;
use papilio_scenario::MemoryFile;
use schemars::JsonSchema;
use serde::Serialize;
use toml::Value;

use crate::fault::Fault;
use crate::shipped;

/// The folder in which a command runs, and that of its results.
pub(super) const DESIGNS: &str = "designs";
pub(super) const OUT: &str = "out";

/// Keys whose texts are never paths.
const WORDS: [&str; 4] = ["title", "text", "summary", "name"];

/// Writes a scenario and its files into a new folder of a job.
pub(super) fn write(
    folder: &Path,
    scenario: Option<(&str, &str)>,
    files: &BTreeMap<String, MemoryFile>,
) -> Result<(), Fault> {
    let designs = folder.join(DESIGNS);
    let mut texts: Vec<&str> = scenario.iter().map(|(_, text)| *text).collect();
    for (name, file) in files {
        if name.ends_with(".toml") {
            texts.push(std::str::from_utf8(&file.file().bytes).unwrap_or_default());
        }
    }
    texts.iter().try_for_each(|text| check_paths(text))?;
    let own = shipped::DATA.iter().filter(|(name, _)| {
        let is_named = |text: &&str| names(text, name);
        // A surface of the program has its meshes beside it.
        let is_beside = name.starts_with(SURFACES) && texts.iter().any(|text| text.contains(SURFACES));
        is_beside || texts.iter().any(is_named)
    });
    let write_all = || -> io::Result<()> {
        fs::create_dir_all(&designs)?;
        fs::create_dir_all(folder.join(OUT))?;
        for (name, file) in own.chain(files) {
            let path = designs.join(name);
            if let Some(parent) = path.parent() {
                fs::create_dir_all(parent)?;
            }
            fs::write(path, &file.file().bytes)?;
        }
        // The files of a surface are beside it.
        for (surface, text) in files.iter().filter(|(name, _)| name.ends_with(".toml")) {
            let Some((beside, _)) = surface.rsplit_once('/') else { continue };
            let text = std::str::from_utf8(&text.file().bytes).unwrap_or_default();
            for (name, file) in files.iter().filter(|(name, _)| !name.contains('/') && names(text, name)) {
                fs::write(designs.join(beside).join(name), &file.file().bytes)?;
            }
        }
        scenario.map_or(Ok(()), |(name, text)| fs::write(designs.join(name), text))
    };
    write_all().map_err(|error| Fault::internal(&format!("the files of the job cannot be written: {error}")))
}

/// Whether a text has this name as a string.
fn names(text: &str, name: &str) -> bool {
    text.contains(&format!("\"{name}\"")) || text.contains(&format!("'{name}'"))
}

/// The folder of the program's surfaces, from that of a scenario.
const SURFACES: &str = "../surfaces/";

/// Whether a name is a path that stays in its folder.
pub(super) fn is_inside(name: &str) -> bool {
    let is_plain = |part| matches!(part, Component::Normal(_) | Component::CurDir);
    !name.contains(['\\', '\0']) && Path::new(name).components().all(is_plain)
}

/// Refuses a text that names files outside of the folder.
fn check_paths(text: &str) -> Result<(), Fault> {
    let table: toml::Table = text.parse().map_err(|error: toml::de::Error| {
        Fault::too_much(format!("the scenario is not TOML: {}", error.message()), "")
    })?;
    check_value(&Value::Table(table))
}

fn check_value(value: &Value) -> Result<(), Fault> {
    match value {
        Value::String(text) if !is_inside(text) && !shipped::DATA.contains_key(text) => Err(Fault::too_much(
            format!("a job reads only files of this page, and `{}` is a path", crate::fault::shortened(text)),
            "drop the file on the page, and use its name",
        )),
        Value::Array(all) => all.iter().try_for_each(check_value),
        Value::Table(table) => {
            let mut all = table.iter().filter(|(key, _)| !WORDS.contains(&key.as_str()));
            all.try_for_each(|(_, value)| check_value(value))
        }
        _ => Ok(()),
    }
}

/// A file that a job has written.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(crate) struct JobFile {
    /// Its path in the folder of the results.
    name: String,
    /// Its size in bytes.
    bytes: u64,
}

/// Maximum number of files that are listed.
const MOST_LISTED: usize = 500;

/// Largest file that is sent to the page, bytes.
const LARGEST_SENT: u64 = 256 << 20;

/// Lists the results of a job.
pub(super) fn results(folder: &Path) -> Vec<JobFile> {
    let mut found = Vec::new();
    list(&folder.join(OUT), "", &mut found);
    found.sort_by(|a, b| a.name.cmp(&b.name));
    found
}

fn list(folder: &Path, before: &str, found: &mut Vec<JobFile>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let (Ok(kind), Ok(name)) = (entry.file_type(), entry.file_name().into_string()) else { continue };
        if found.len() >= MOST_LISTED {
            return;
        }
        if kind.is_dir() {
            list(&entry.path(), &format!("{before}{name}/"), found);
        } else if kind.is_file() {
            let bytes = entry.metadata().map_or(0, |metadata| metadata.len());
            found.push(JobFile { name: format!("{before}{name}"), bytes });
        }
    }
}

/// Reads a result.
pub(super) fn read(folder: &Path, name: &str) -> Result<DataFile, Fault> {
    let file = results(folder).into_iter().find(|file| file.name == name);
    let file = file.ok_or_else(|| Fault::unknown("file", name))?;
    let path = folder.join(OUT).join(name);
    if file.bytes > LARGEST_SENT {
        return Err(Fault::too_much(
            format!("the file is larger than {} MiB", LARGEST_SENT >> 20),
            &format!("it is {}", path.display()),
        ));
    }
    let bytes =
        fs::read(&path).map_err(|error| Fault::internal(&format!("the file cannot be read: {error}")))?;
    Ok(DataFile { name: name.to_owned(), bytes })
}

/// Returns the size of all results in bytes.
pub(super) fn size(folder: &Path) -> u64 {
    results(folder).iter().map(|file| file.bytes).sum()
}

/// Returns the last part of a text file, without a first line that is cut.
pub(super) fn tail(path: &Path, most: usize) -> String {
    let bytes = fs::read(path).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes[bytes.len().saturating_sub(most)..]).into_owned();
    if bytes.len() <= most {
        return text;
    }
    text.split_once('\n').map_or(String::new(), |(_, rest)| rest.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_out_of_the_folder_are_refused_wherever_they_are() {
        for text in [
            "[display.diffuser]\nfile = \"/etc/passwd\"",
            "a = [1, { b = '../x.csv' }]",
            "[sweep]\n\"lighting.spectrum\" = [\"D65\", \"data/../../x.csv\"]",
            "a = \"C:\\\\x.csv\"",
            "a = \"\\u002e./x.csv\"",
            "a = \"\"\"\n/etc/passwd\"\"\"",
        ] {
            assert!(check_paths(text).is_err(), "{text}");
        }
        for text in [
            "title = \"A / B ..\"",
            "file = \"../surfaces/etched.toml\"",
            "file = \"data/H65.bsdf\"\nmaterial = \"Cr:Johnson\"",
        ] {
            assert!(check_paths(text).is_ok(), "{text}");
        }
    }

    #[test]
    fn folder_has_the_scenario_and_the_files_that_it_names() {
        let folder = tempfile::tempdir().unwrap();
        let mine = MemoryFile::new(DataFile { name: "mine.csv".to_owned(), bytes: b"1".to_vec() });
        let text = "a = \"data/H65.bsdf\"\nb = \"mine.csv\"\nc = \"../surfaces/etched.toml\"";
        let files = BTreeMap::from([("mine.csv".to_owned(), mine)]);
        write(folder.path(), Some(("s.toml", text)), &files).unwrap();
        for name in ["designs/s.toml", "designs/mine.csv", "designs/data/H65.bsdf", "surfaces/etched.toml"] {
            assert!(folder.path().join(name).is_file(), "{name}");
        }
        assert!(!folder.path().join("designs/data/H78.bsdf").exists());
        fs::write(folder.path().join("out/a.csv"), "1,2").unwrap();
        assert_eq!(read(folder.path(), "a.csv").unwrap().bytes, b"1,2");
        assert!(read(folder.path(), "../designs/s.toml").is_err());
    }
}
