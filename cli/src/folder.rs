//! Folder for results if `--out` is not given.
//!
//! The folder is `out/NAME`, unless it contains a result with another hash (other keys, or the file before an
//! edit), or another program is writing it. Then it is `out/NAME-` followed by the first digits of the new hash, so that a
//! result only replaces itself, when it is finished. Commands with a journal always use `out/NAME`; the journal identifies its
//! scenario.

use std::cell::LazyCell;
use std::fs;
use std::path::{Path, PathBuf};

use papilio_formats::{write_file, write_json};
use papilio_scenario::Resolved;
use serde::{Deserialize, Serialize};

use crate::arguments::ScenarioArguments;
use crate::claim::Claim;
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

impl Content {
    /// Why a folder with this content is not used for another result.
    fn reason(&self, kind: Kind) -> Option<String> {
        let hash = match self {
            Self::Free => return None,
            Self::Other(other) => format!(" (hash {})", other.chars().take(DIGITS).collect::<String>()),
            Self::Unknown => String::new(),
        };
        let result = match kind {
            Kind::Result => "the result of another scenario or of other keys",
            Kind::Fit => "the fit of another scenario, of other keys, or to other data",
        };
        Some(format!("contains {result}{hash}, which is not replaced"))
    }
}

/// A folder for a result.
#[derive(Debug)]
pub(crate) struct ResultFolder {
    path: PathBuf,
    /// Why it is not the folder of the scenario's name.
    note: Option<String>,
    /// Keeps other programs from it, unless it was stated with `--out`.
    _claim: Option<Claim>,
}

impl std::ops::Deref for ResultFolder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.path
    }
}

impl ResultFolder {
    /// The folder of `--out`, after checking that it can be written.
    pub(crate) fn stated(folder: &Path) -> Result<Self, Failure> {
        output::check(folder)?;
        Ok(Self { path: folder.to_owned(), note: None, _claim: None })
    }

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
        return ResultFolder::stated(folder);
    }
    let own = arguments.default_out();
    let mut reason = None;
    for path in paths(&own, hash.own) {
        match claim(kind, &path, hash)? {
            Ok(claim) => {
                let note = reason.map(|reason: String| note(&own, &reason, &path));
                return Ok(ResultFolder { path, note, _claim: Some(claim) });
            }
            // That of the first folder is printed.
            Err(why_not) => _ = reason.get_or_insert(why_not),
        }
    }
    Err(Failure::Input(format!(
        "{} and all folders with digits of the hash behind this name are used for other results\n  = help: choose another folder with \
         --out DIR",
        own.display()
    )))
}

/// Claims a folder for a result with this hash, or returns why it cannot be used.
fn claim(kind: Kind, folder: &Path, hash: &Hashes<'_>) -> Result<Result<Claim, String>, Failure> {
    if let Some(reason) = content(kind, folder, hash).reason(kind) {
        return Ok(Err(reason));
    }
    let Some(claim) = Claim::of(folder)? else { return Ok(Err(BEING_WRITTEN.to_owned())) };
    // Another program may have finished a result before the folder was claimed.
    Ok(content(kind, folder, hash).reason(kind).map_or(Ok(claim), Err))
}

/// Claims the first free one of the folders `NAME`, `NAME-2` and so on, for a result that replaces earlier ones.
pub(crate) fn choose_numbered(own: &Path) -> Result<ResultFolder, Failure> {
    let mut path = own.to_owned();
    let mut number = 1;
    loop {
        if let Some(claim) = Claim::of(&path)? {
            let note = (number > 1).then(|| note(own, BEING_WRITTEN, &path));
            return Ok(ResultFolder { path, note, _claim: Some(claim) });
        }
        number += 1;
        path = suffixed(own, &number.to_string());
    }
}

/// Why a claimed folder is not used.
const BEING_WRITTEN: &str = "is being written by another program";

/// A note on why a result is not in the folder of its name.
fn note(own: &Path, reason: &str, path: &Path) -> String {
    let (own, path) = (own.display(), path.display());
    format!(
        "note: {own} {reason}; this result is written to {path}\n  = help: with --out DIR, the files in DIR are replaced"
    )
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

/// Folders for a result: with its name alone, and with digits of its hash, as few as are needed to avoid those of other results.
fn paths<'a>(own: &'a Path, hash: &'a str) -> impl Iterator<Item = PathBuf> + 'a {
    let of_hash = (DIGITS..=hash.len()).filter_map(|digits| hash.get(..digits));
    std::iter::once(own.to_owned()).chain(of_hash.map(|digits| suffixed(own, digits)))
}

/// A path with a hyphen and an addition at its end.
fn suffixed(path: &Path, end: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!("-{end}"));
    path.with_file_name(name)
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
        let is_free = |path: &PathBuf| claim(Kind::Result, path, &of_other).is_ok_and(|claim| claim.is_ok());
        let chosen = || paths(&own, &other).find(is_free);
        assert_eq!(chosen(), Some(base.path().join("s-bbbbbb")));
        // Another hash with the same first digits.
        let close = format!("bbbbbb{}", "c".repeat(58));
        fs::create_dir(base.path().join("s-bbbbbb")).unwrap();
        write_about(&base.path().join("s-bbbbbb"), ["t", &close], [&[], &[]]).unwrap();
        assert_eq!(chosen(), Some(base.path().join("s-bbbbbbb")));
        // Another program writes that one, too. It has no result at the end, and the folder is removed.
        let claim = Claim::of(&base.path().join("s-bbbbbbb")).unwrap();
        assert_eq!(chosen(), Some(base.path().join("s-bbbbbbbb")));
        drop(claim);
        assert!(!base.path().join("s-bbbbbbb").exists());
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
