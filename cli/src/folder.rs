//! Where results go that the user has named no folder for.
//!
//! `out/NAME`, unless that holds the result of another hash: of the same file with other keys, or before it was edited. Then
//! `out/NAME-` and the first digits of this one's hash: nothing is replaced but by itself. Commands with a journal, which
//! sets itself aside, stay in `out/NAME`.

use std::fs;
use std::path::{Path, PathBuf};

use papilio_formats::{write_file, write_json};
use serde::{Deserialize, Serialize};

use crate::arguments::ScenarioArguments;
use crate::{Failure, output, say};

/// What `pixel`, `brdf` and `study` write beside their tables, which do not name their scenario.
pub(crate) const ABOUT: &str = "about.json";

/// Files that name the scenario that they are of.
const NAMED: [&str; 3] = ["result.json", "cone.json", ABOUT];

/// Files that do not.
const UNNAMED: [&str; 4] = ["pixel.csv", "display-bsdf.npz", "reflection.csv", "study.csv"];

/// As many digits of the hash are in a folder's name, at first.
const DIGITS: usize = 6;

/// Which scenario the files of a folder are of.
#[derive(Debug, Serialize)]
struct About<'a> {
    papilio: &'a str,
    title: &'a str,
    hash: &'a str,
}

/// The hash in a file, whatever else is there.
#[derive(Debug, Deserialize)]
struct Hash {
    hash: String,
}

/// What a folder holds.
#[derive(Debug, PartialEq)]
enum Held {
    /// Nothing of another hash than this.
    Free,
    /// The result of another one.
    Other(String),
    /// One that does not say of which.
    Unknown,
}

/// The folder for a result of this hash, which can be written to.
pub(crate) fn choose(arguments: &ScenarioArguments, hash: &str) -> Result<PathBuf, Failure> {
    if let Some(folder) = &arguments.out {
        output::check(folder)?;
        return Ok(folder.clone());
    }
    let own = arguments.default_out();
    let held = held(&own, hash);
    let folder = match &held {
        Held::Free => own.clone(),
        Held::Other(_) | Held::Unknown => beside(&own, hash),
    };
    output::check(&folder)?;
    let of = match held {
        Held::Free => return Ok(folder),
        Held::Other(other) => format!(" (hash {})", other.chars().take(DIGITS).collect::<String>()),
        Held::Unknown => String::new(),
    };
    say(&format!(
        "note: {} holds the result of another scenario or of other keys{of}, which is not replaced: this one goes to {}\n  \
         = help: --out DIR names a folder, and replaces what is there",
        own.display(),
        folder.display()
    ));
    Ok(folder)
}

/// Says in a folder of which scenario its files are.
pub(crate) fn sign(folder: &Path, title: &str, hash: &str) -> Result<(), Failure> {
    let about = About { papilio: env!("CARGO_PKG_VERSION"), title, hash };
    Ok(write_file(&folder.join(ABOUT), |out| write_json(out, &about))?)
}

/// A folder named after the hash: with so many digits of it that it is no other's.
fn beside(own: &Path, hash: &str) -> PathBuf {
    let named = |digits: usize| {
        let mut name = own.file_name().unwrap_or_default().to_owned();
        name.push(format!("-{}", hash.get(..digits).unwrap_or(hash)));
        own.with_file_name(name)
    };
    let is_free = |folder: &PathBuf| held(folder, hash) == Held::Free;
    (DIGITS..hash.len()).map(named).find(is_free).unwrap_or_else(|| named(hash.len()))
}

/// What a folder holds beside what is of this hash.
fn held(folder: &Path, hash: &str) -> Held {
    let mut is_ours = false;
    for name in NAMED {
        let Ok(bytes) = fs::read(folder.join(name)) else { continue };
        match serde_json::from_slice::<Hash>(&bytes) {
            Ok(found) if found.hash == hash => is_ours = true,
            Ok(found) => return Held::Other(found.hash),
            Err(_) => return Held::Unknown,
        }
    }
    if !is_ours && UNNAMED.iter().any(|name| folder.join(name).exists()) { Held::Unknown } else { Held::Free }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_free_of_others_or_named_by_the_hash() {
        let base = tempfile::tempdir().unwrap();
        let own = base.path().join("s");
        let [ours, other] = ["a".repeat(64), "b".repeat(64)];
        assert_eq!(held(&own, &ours), Held::Free);
        fs::create_dir(&own).unwrap();
        sign(&own, "t", &ours).unwrap();
        assert_eq!((held(&own, &ours), held(&own, &other)), (Held::Free, Held::Other(ours.clone())));
        assert_eq!(beside(&own, &other), base.path().join("s-bbbbbb"));
        // Another hash that begins alike.
        let close = format!("bbbbbb{}", "c".repeat(58));
        fs::create_dir(base.path().join("s-bbbbbb")).unwrap();
        sign(&base.path().join("s-bbbbbb"), "t", &close).unwrap();
        assert_eq!(beside(&own, &other), base.path().join("s-bbbbbbb"));
        // A table of an earlier version, which does not say what it is of.
        let old = base.path().join("old");
        fs::create_dir(&old).unwrap();
        fs::write(old.join("pixel.csv"), "").unwrap();
        assert_eq!(held(&old, &ours), Held::Unknown);
    }
}
