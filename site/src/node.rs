//! Files of the repository as the site shows them.

use std::fs;
use std::io;
use std::path::Path;

use crate::book::names_in;
use crate::document::Document;
use crate::{Problem, Sources};

/// A file or folder to which a page refers.
#[derive(Debug, Clone)]
pub(crate) enum Node {
    /// A page.
    Page(Document),
    /// A folder, shown as the list of its files, folders with a `/`.
    Folder(Vec<String>),
    /// A text, shown as a page and offered as a file.
    Text(String),
    /// Any other file, such as a picture.
    File,
}

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
        if extension(path) == "md" {
            let (page, problems) = Document::read(path, fs::read_to_string(full)?);
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
                let stem = place.rsplit_once('.').map_or(&*place, |(stem, _)| stem);
                match stem.strip_suffix("README").filter(|_| path.starts_with("docs/")) {
                    Some(folder) => format!("{folder}index.html"),
                    None => format!("{stem}.html"),
                }
            }
            Self::Folder(_) => format!("{}/index.html", place.trim_end_matches('/')),
            Self::Text(_) => format!("{place}.html"),
            Self::File => place,
        }
    }
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
    names.into_iter().map(|name| if folder.join(&name).is_dir() { format!("{name}/") } else { name }).collect()
}
