//! Files of the repository as the site shows them.

use std::fs;
use std::io;
use std::path::Path;

use crate::book::names_in;
use crate::document::Document;
use crate::{Problem, Sources, notebook};

/// A file or folder to which a page refers.
#[derive(Debug, Clone)]
pub(crate) enum Node {
    /// A page.
    Page(Document),
    /// A folder, shown as the list of its files, folders with a `/`.
    Folder(Vec<String>),
    /// A text, shown as a page and offered as a file.
    Text(String),
    /// A crate whose documentation is part of the site, by its name in paths.
    Crate(String),
    /// Any other file, such as a picture.
    File,
}

/// Folder of the Python package.
const PYTHON: &str = "python/papilio/";

/// Folder of the documentation of the crates in the site.
pub(crate) const RUST: &str = "api/rust";

/// A longer text is only offered as a file; in bytes.
const LONGEST_TEXT: u64 = 200_000;

/// Texts that a browser shows as pictures.
const PICTURES: [&str; 1] = ["svg"];

impl Node {
    /// Reads a file or folder of the repository, and reports the mistakes of a page.
    pub(crate) fn read(sources: &Sources, path: &str) -> io::Result<(Self, Vec<Problem>)> {
        let full = sources.root.join(path);
        if full.is_dir() {
            return Ok((Self::Folder(listed(&full)), Vec::new()));
        }
        if let Some(name) = documented_crate(sources, path) {
            return Ok((Self::Crate(name), Vec::new()));
        }
        if let Some((page, problems)) = page(sources, path)? {
            return Ok((Self::Page(page), problems));
        }
        let is_short = fs::metadata(&full)?.len() <= LONGEST_TEXT;
        if PICTURES.contains(&extension(path)) || !is_short {
            return Ok((Self::File, Vec::new()));
        }
        let text = String::from_utf8(fs::read(full)?).ok().filter(|text| !text.contains('\0'));
        Ok((text.map_or(Self::File, Self::Text), Vec::new()))
    }

    /// The page, if it is one.
    pub(crate) fn page(&self) -> Option<&Document> {
        match self {
            Self::Page(page) => Some(page),
            _ => None,
        }
    }

    /// URL of what is shown for the file `path`, relative to the start of the site.
    pub(crate) fn url(&self, path: &str) -> String {
        let place = place(path);
        match self {
            Self::Page(_) => {
                let place = path.strip_prefix(PYTHON).map_or(place, |name| format!("api/python/{name}"));
                let stem = place.rsplit_once('.').map_or(&*place, |(stem, _)| stem);
                let of_folder = stem.strip_suffix("README").filter(|_| path.starts_with("docs/"));
                match of_folder.or_else(|| stem.strip_suffix("__init__")) {
                    Some(folder) => format!("{folder}index.html"),
                    None => format!("{stem}.html"),
                }
            }
            Self::Folder(_) => format!("{}/index.html", place.trim_end_matches('/')),
            Self::Text(_) => format!("{place}.html"),
            Self::Crate(name) => format!("{RUST}/{name}/index.html"),
            Self::File => place,
        }
    }
}

/// Reads a page: Markdown, a notebook, or the reference of a Python module; `None` for other files.
fn page(sources: &Sources, path: &str) -> io::Result<Option<(Document, Vec<Problem>)>> {
    let full = sources.root.join(path);
    match extension(path) {
        "md" => Ok(Some(Document::read(path, fs::read_to_string(full)?))),
        "ipynb" => Ok(notebook::read(path, &fs::read_to_string(full)?)),
        "py" => {
            let module = path.strip_prefix(PYTHON).and_then(|name| name.strip_suffix(".py"));
            let written = sources
                .python
                .as_ref()
                .zip(module)
                .map(|(folder, name)| folder.join(name).with_extension("md"));
            let Some(written) = written.filter(|written| written.is_file()) else { return Ok(None) };
            Ok(Some(Document::read(path, fs::read_to_string(written)?)))
        }
        _ => Ok(None),
    }
}

/// Name of the crate whose root this file is, if its documentation is part of the site.
fn documented_crate(sources: &Sources, path: &str) -> Option<String> {
    let documentation = sources.rust.as_ref()?;
    let name = path.strip_prefix("crates/")?.strip_suffix("/src/lib.rs")?;
    let name = format!("papilio_{}", name.replace('-', "_"));
    documentation.join(&name).join("index.html").is_file().then_some(name)
}

/// Path of a file's copy in the site: files of `docs` are at its top.
pub(crate) fn place(path: &str) -> String {
    path.strip_prefix("docs/").map_or_else(|| format!("repository/{path}"), str::to_owned)
}

/// The part of a file's name after the last point.
pub(crate) fn extension(path: &str) -> &str {
    let name = path.rsplit('/').next().unwrap_or(path);
    name.rsplit_once('.').map_or("", |(_, extension)| extension)
}

fn listed(folder: &Path) -> Vec<String> {
    let mut names = names_in(folder);
    names.retain(|name| !name.starts_with('.'));
    names
        .into_iter()
        .map(|name| if folder.join(&name).is_dir() { format!("{name}/") } else { name })
        .collect()
}
