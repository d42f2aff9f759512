//! Generator of the documentation site: the pages of `docs/` and what they link to, as HTML that needs no
//! network.
//!
//! - [`Sources`]: the repository, and where the references of the programming interfaces are, if they have
//!   been made.
//! - [`build`] reads everything, checks every link, anchor and equation, and returns the [`Site`] or all
//!   [`Problem`]s.
//! - [`Site::write`] writes it.
//!
//! `docs/SUMMARY.md` lists the pages by parts; a page without an entry there is a problem, and so is an entry
//! without a page. Links to files elsewhere in the repository become pages or files of the site. Links into
//! the web are listed, not requested.
//!
//! The look is in `assets/`: a template, style sheets and scripts. Equations are MathML, and code has its
//! colours already: without scripts, everything but the search and the choice of colours works.
//!
//! **Out of scope**: other Markdown than GitHub's, more than one site.

mod anchors;
mod book;
mod document;
mod highlight;
mod html;
mod layout;
mod links;
mod math;
mod node;
mod notebook;
mod picture;
mod search;
mod site;
mod summary;
mod whole;

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

use papilio_diagnostics::{Diagnostic, Place};

pub use site::{Site, build};

/// Where the pages come from.
#[derive(Debug, Clone)]
pub struct Sources {
    /// The repository.
    pub root: PathBuf,
    /// Folder with a page in Markdown for each module of the Python package, if they have been written.
    pub python: Option<PathBuf>,
    /// Folder with the documentation of the crates, if `cargo doc` has written it.
    pub rust: Option<PathBuf>,
}

/// A mistake in the pages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// File, line and column.
    pub place: Place,
    /// What is wrong, and what to do.
    pub diagnostic: Diagnostic,
}

impl Problem {
    fn whole(file: &str, diagnostic: Diagnostic) -> Self {
        Self { place: Place::whole(file), diagnostic }
    }

    fn in_text(file: &str, text: &str, range: Range<usize>, diagnostic: Diagnostic) -> Self {
        Self { place: Place::in_text(file, text, range), diagnostic }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostic.at(&self.place).fmt(f)
    }
}
