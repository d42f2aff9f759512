//! The example scenarios of Papilio, their data and surfaces, as files in memory.
//!
//! The web app offers them, and the reproduction of Feng 2012 runs some of them. They are the folders
//! `scenarios` and `surfaces` at the top of the repository, so that users find them there; this crate is
//! therefore the package at the top.
//!
//! - [`paths`]: the path of each file, from the top of the repository;
//! - [`file()`]: the content of a file.
//!
//! ```
//! let indoor = papilio_examples::file("scenarios/indoor.toml").expect("the first example of the README");
//! assert!(String::from_utf8_lossy(&indoor).contains("[display.pixel]"));
//! ```
//!
//! **Out of scope.** Reading scenarios (`papilio-scenario`).

use std::borrow::Cow;

use rust_embed::RustEmbed;

#[derive(RustEmbed)]
#[folder = "scenarios"]
#[prefix = "scenarios/"]
struct Scenarios;

#[derive(RustEmbed)]
#[folder = "surfaces"]
#[prefix = "surfaces/"]
struct Surfaces;

/// Returns the path of each file, for example `scenarios/indoor.toml` or `scenarios/data/H65.bsdf`.
pub fn paths() -> impl Iterator<Item = Cow<'static, str>> {
    Scenarios::iter().chain(Surfaces::iter()).filter(|path| is_example(path))
}

/// Returns the content of the file at a path; `None` if there is no such example.
pub fn file(path: &str) -> Option<Cow<'static, [u8]>> {
    let found = is_example(path).then(|| Scenarios::get(path).or_else(|| Surfaces::get(path)))??;
    Some(found.data)
}

/// False for this crate's own files, and for the programs that made the data.
fn is_example(path: &str) -> bool {
    ![".rs", ".md", ".py"].iter().any(|end| path.ends_with(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_by_their_path_and_others_are_not() {
        assert!(file("surfaces/hemispheres.toml").is_some() && file("scenarios/data/H65.bsdf").is_some());
        for other in ["scenarios/lib.rs", "scenarios/README.md", "scenarios/../Cargo.toml", "indoor.toml", ""]
        {
            assert!(file(other).is_none(), "{other}");
        }
        assert!(paths().all(|path| file(&path).is_some()));
        assert!(paths().filter(|path| path.ends_with(".toml")).count() > 50);
    }
}
