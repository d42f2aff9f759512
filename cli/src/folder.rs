//! Folder for results if `--out` is not given.
//!
//! The folder is `out/NAME`, unless it contains a result with another hash (other keys, or the file before an
//! edit). Then it is `out/NAME-` followed by the first digits of the new hash, so that a result only replaces
//! itself. Commands with a journal always use `out/NAME`; the journal identifies its scenario.

use std::cell::LazyCell;
use std::fs;
use std::path::{Path, PathBuf};

use papilio_formats::{write_file, write_json};
use papilio_scenario::Resolved;
use serde::{Deserialize, Serialize};

use crate::arguments::ScenarioArguments;
use crate::{Failure, RESULTS, output, print_message};

/// File that `pixel`, `brdf` and `study` write next to their tables, which do not contain the hash of the
/// scenario.
pub(crate) const ABOUT: &str = "about.json";

/// Files that do not contain the hash of their scenario.
const WITHOUT_HASH: [&str; 6] =
    ["pixel.csv", "absorption.csv", "display-bsdf.npz", "reflection.csv", "study.csv", "steps.csv"];

/// Digits of the hash in a folder's name, unless more are needed.
const DIGITS: usize = 6;

/// Content of `about.json`: the scenario of the files in a folder, and what was printed about it.
#[derive(Debug, Serialize)]
struct About<'a> {
    papilio: &'a str,
    title: &'a str,
    hash: &'a str,
    notes: &'a [String],
    warnings: &'a [String],
}

/// The hash in a file, among other fields.
#[derive(Debug, Deserialize)]
struct Hash {
    hash: String,
}

/// Content of a folder for results.
#[derive(Debug, PartialEq)]
enum Content {
    /// No result, or one with the same hash.
    Free,
    /// A result with another hash.
    Other(String),
    /// A result without a hash.
    Unknown,
}

/// A folder for a result.
#[derive(Debug)]
pub(crate) struct ResultFolder {
    path: PathBuf,
    /// Why it is not the folder of the scenario's name.
    note: Option<String>,
}

impl std::ops::Deref for ResultFolder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.path
    }
}

impl ResultFolder {
    /// Prints the names of the written files on standard error, and why they are in this folder.
    pub(crate) fn print_written(&self, names: &[String]) {
        self.note.iter().for_each(|note| print_message(note));
        output::print_written(self, names);
    }
}

/// What files a folder may have.
#[derive(Debug, Clone, Copy)]
enum Kind {
    /// Results of scenarios.
    Result,
    /// A fit, whose hash is that of its measured data, too.
    Fit,
}

/// The hashes of a scenario.
struct Hashes<'a> {
    own: &'a str,
    /// Its hash in other commands: it is found only if it is needed, because files are read for it.
    of_others: LazyCell<Option<String>, Box<dyn FnOnce() -> Option<String> + 'a>>,
}

impl<'a> Hashes<'a> {
    /// One hash in all commands.
    fn one(own: &'a str) -> Self {
        Self { own, of_others: LazyCell::new(Box::new(|| None)) }
    }

    fn has(&self, hash: &str) -> bool {
        self.own == hash || self.of_others.as_deref() == Some(hash)
    }
}

/// Returns the folder for a result of a scenario, after checking that it can be written.
pub(crate) fn choose(arguments: &ScenarioArguments, resolved: &Resolved) -> Result<ResultFolder, Failure> {
    let of_others = LazyCell::new(Box::new(|| resolved.hash_of_other_commands()) as Box<_>);
    choose_for(Kind::Result, arguments, &Hashes { own: &resolved.hash, of_others })
}

/// Returns the folder for a result of a surface with this hash, after checking that it can be written.
pub(crate) fn choose_for_surface(arguments: &ScenarioArguments, hash: &str) -> Result<ResultFolder, Failure> {
    choose_for(Kind::Result, arguments, &Hashes::one(hash))
}

/// Returns the folder for a fit with this hash, after checking that it can be written.
pub(crate) fn choose_for_fit(arguments: &ScenarioArguments, hash: &str) -> Result<ResultFolder, Failure> {
    choose_for(Kind::Fit, arguments, &Hashes::one(hash))
}

fn choose_for(kind: Kind, arguments: &ScenarioArguments, hash: &Hashes<'_>) -> Result<ResultFolder, Failure> {
    if let Some(folder) = &arguments.out {
        output::check(folder)?;
        return Ok(ResultFolder { path: folder.clone(), note: None });
    }
    let own = arguments.default_out();
    let content = content(kind, &own, hash);
    let folder = match &content {
        Content::Free => own.clone(),
        Content::Other(_) | Content::Unknown => hash_folder(kind, &own, hash),
    };
    output::check(&folder)?;
    let hash_of_other = match content {
        Content::Free => return Ok(ResultFolder { path: folder, note: None }),
        Content::Other(other) => format!(" (hash {})", other.chars().take(DIGITS).collect::<String>()),
        Content::Unknown => String::new(),
    };
    let note = format!(
        "note: {} contains {}{hash_of_other}, which is not replaced; this result is written to {}\n  = help: with --out DIR, the files in \
         DIR are replaced",
        own.display(),
        match kind {
            Kind::Result => "the result of another scenario or of other keys",
            Kind::Fit => "the fit of another scenario, of other keys, or to other data",
        },
        folder.display()
    );
    Ok(ResultFolder { path: folder, note: Some(note) })
}

/// Creates a folder for the files of a scenario that `about.json` identifies. Those of another scenario,
/// which is written there with `--out`, are removed: they would be mistaken for files of this one.
pub(crate) fn make(folder: &Path, hash: &str) -> Result<(), Failure> {
    output::make_folder(folder)?;
    let about = fs::read(folder.join(ABOUT)).ok();
    match about.map(|bytes| serde_json::from_slice::<Hash>(&bytes)) {
        None | Some(Err(_)) => Ok(()),
        Some(Ok(found)) if found.hash == hash => Ok(()),
        Some(Ok(_)) => output::remove(folder, is_identified_by_about),
    }
}

/// True for names of the files of `pixel`, `brdf`, `study` and `diffuser steps`.
fn is_identified_by_about(name: &str) -> bool {
    let tables = [
        "pixel.csv",
        "absorption.csv",
        "sub-pixels.csv",
        "reflection.csv",
        "study.csv",
        "steps.csv",
        "scene.py",
        ABOUT,
    ];
    let of_display = [".npz", ".csv", ".bsdf", ".xml", ".json"];
    tables.contains(&name)
        || output::is_figure_of(&["pixel", "absorption", "study_", "point_sets", "step-"], name)
        || (name.starts_with("display-") && of_display.iter().any(|end| name.ends_with(end)))
}

/// Writes `about.json`, which identifies the scenario of the files in a folder, with its notes and warnings.
pub(crate) fn write_about(
    folder: &Path,
    [title, hash]: [&str; 2],
    [notes, warnings]: [&[String]; 2],
) -> Result<(), Failure> {
    let about = About { papilio: env!("CARGO_PKG_VERSION"), title, hash, notes, warnings };
    Ok(write_file(&folder.join(ABOUT), |out| write_json(out, &about))?)
}

/// A folder named by the hash, with as many digits as are needed to avoid the folders of other results.
fn hash_folder(kind: Kind, own: &Path, hash: &Hashes<'_>) -> PathBuf {
    let digits_of = hash.own;
    let named = |digits: usize| {
        let mut name = own.file_name().unwrap_or_default().to_owned();
        name.push(format!("-{}", digits_of.get(..digits).unwrap_or(digits_of)));
        own.with_file_name(name)
    };
    let is_free = |folder: &PathBuf| content(kind, folder, hash) == Content::Free;
    (DIGITS..digits_of.len()).map(named).find(is_free).unwrap_or_else(|| named(digits_of.len()))
}

/// Returns whether a folder contains a result with another hash.
fn content(kind: Kind, folder: &Path, hash: &Hashes<'_>) -> Content {
    let (files, without_hash): (Vec<&str>, &[&str]) = match kind {
        Kind::Result => (RESULTS.iter().map(|file| file.name).chain([ABOUT]).collect(), &WITHOUT_HASH),
        Kind::Fit => (vec!["fit.json"], &[]),
    };
    let mut is_ours = false;
    for name in files {
        let Ok(bytes) = fs::read(folder.join(name)) else { continue };
        match serde_json::from_slice::<Hash>(&bytes) {
            Ok(found) if hash.has(&found.hash) => is_ours = true,
            Ok(found) => return Content::Other(found.hash),
            Err(_) => return Content::Unknown,
        }
    }
    if !is_ours && without_hash.iter().any(|name| folder.join(name).exists()) {
        Content::Unknown
    } else {
        Content::Free
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folder_with_another_result_is_replaced_by_one_named_by_the_hash() {
        let base = tempfile::tempdir().unwrap();
        let own = base.path().join("s");
        let [ours, other] = ["a".repeat(64), "b".repeat(64)];
        let [of_ours, of_other] = [&ours, &other].map(|hash| Hashes::one(hash));
        assert_eq!(content(Kind::Result, &own, &of_ours), Content::Free);
        fs::create_dir(&own).unwrap();
        write_about(&own, ["t", &ours], [&[], &[]]).unwrap();
        assert_eq!(
            (content(Kind::Result, &own, &of_ours), content(Kind::Result, &own, &of_other)),
            (Content::Free, Content::Other(ours.clone()))
        );
        // The same scenario in another command.
        let same = ours.clone();
        let both = Hashes { own: &other, of_others: LazyCell::new(Box::new(|| Some(same))) };
        assert_eq!(content(Kind::Result, &own, &both), Content::Free);
        assert_eq!(hash_folder(Kind::Result, &own, &of_other), base.path().join("s-bbbbbb"));
        // Another hash with the same first digits.
        let close = format!("bbbbbb{}", "c".repeat(58));
        fs::create_dir(base.path().join("s-bbbbbb")).unwrap();
        write_about(&base.path().join("s-bbbbbb"), ["t", &close], [&[], &[]]).unwrap();
        assert_eq!(hash_folder(Kind::Result, &own, &of_other), base.path().join("s-bbbbbbb"));
        // Files of a scenario that another one replaces; those of other programs stay.
        for name in ["pixel.csv", "display-white.bsdf", "step-normalise.svg", "notes.csv"] {
            fs::write(own.join(name), "").unwrap();
        }
        make(&own, &ours).unwrap();
        assert!(own.join("display-white.bsdf").exists());
        make(&own, &other).unwrap();
        let left: Vec<_> = fs::read_dir(&own).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(left, ["notes.csv"]);
        // A table of an earlier version, without a hash.
        let old = base.path().join("old");
        fs::create_dir(&old).unwrap();
        fs::write(old.join("pixel.csv"), "").unwrap();
        assert_eq!(content(Kind::Result, &old, &of_ours), Content::Unknown);
    }
}
