//! All that the site shows: the pages of the summary, and everything that they link to, read from the
//! repository and checked.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::ops::Range;
use std::path::Path;

use papilio_diagnostics::{Diagnostic, did_you_mean, suggestion};

use crate::document::{Document, Link};
use crate::links::{Destination, folder};
use crate::node::Node;
use crate::summary::Summary;
use crate::{Problem, Sources};

/// Path of the summary in the repository.
const SUMMARY: &str = "docs/SUMMARY.md";

/// Folder of the paper about Papilio, which is no page of the site.
const PAPER: &str = "docs/paper";

/// Folder of the pages.
const PAGES: &str = "docs";

/// Folders of a working copy that a fresh clone does not have.
const NOT_IN_A_CLONE: [&str; 4] = ["target", "out", ".git", ".venv"];

/// The pages, and all files that they refer to.
#[derive(Debug, Default)]
pub(crate) struct Book {
    pub(crate) summary: Summary,
    /// Path in the repository of each entry of the summary, in order.
    pub(crate) order: Vec<String>,
    /// By path in the repository.
    pub(crate) nodes: BTreeMap<String, Node>,
    /// Links into the web, with the pages that have them.
    pub(crate) web: BTreeMap<String, BTreeSet<String>>,
}

impl Book {
    /// Reads everything. All mistakes are reported, not only the first.
    pub(crate) fn read(sources: &Sources) -> Result<Self, Vec<Problem>> {
        let text = fs::read_to_string(sources.root.join(SUMMARY)).map_err(|error| {
            let missing = Diagnostic::new(format!("the list of pages cannot be read: {error}"));
            vec![Problem::whole(SUMMARY, missing)]
        })?;
        let mut loader = Loader { sources, book: Self::default(), problems: Vec::new(), waiting: Vec::new() };
        loader.book.summary = Summary::read(SUMMARY, &text)?;
        loader.entries(&text);
        loader.unlisted();
        loader.follow();
        loader.anchors();
        let Loader { book, mut problems, .. } = loader;
        problems.sort_by_key(|problem| (problem.place.name.clone(), problem.place.line_column()));
        if problems.is_empty() { Ok(book) } else { Err(problems) }
    }

    /// The page of this path, if it is one.
    pub(crate) fn page(&self, path: &str) -> Option<&Document> {
        match self.nodes.get(path) {
            Some(Node::Page(page)) => Some(page),
            _ => None,
        }
    }

    /// Entries of the summary with their paths, by parts.
    pub(crate) fn parts(&self) -> impl Iterator<Item = (&str, Vec<(&crate::summary::Entry, &str)>)> {
        let mut paths = self.order.iter();
        self.summary.parts.iter().map(move |part| {
            let entries = part.entries.iter();
            (part.title.as_str(), entries.filter_map(|entry| Some((entry, paths.next()?.as_str()))).collect())
        })
    }

    /// Path and anchor to which a link of the page `source` leads; `None` for a link into the web.
    pub(crate) fn target(&self, source: &str, link: &str) -> Option<(String, Option<String>)> {
        match Destination::read(source, link).ok()? {
            Destination::Web => None,
            Destination::Local { path, anchor } => Some((path, anchor)),
        }
    }

    /// URL in the site of a path of the repository; "" if the site does not have it.
    pub(crate) fn url(&self, path: &str) -> String {
        self.nodes.get(path).map(|node| node.url(path)).unwrap_or_default()
    }
}

/// A book that is being read.
struct Loader<'a> {
    sources: &'a Sources,
    book: Book,
    problems: Vec<Problem>,
    /// Pages whose links have not been followed yet.
    waiting: Vec<String>,
}

impl Loader<'_> {
    /// Reads the pages of the summary.
    fn entries(&mut self, text: &str) {
        let mut seen = BTreeSet::new();
        for entry in self.book.summary.clone().entries() {
            let problem = match Destination::read(SUMMARY, &entry.link) {
                Ok(Destination::Local { path, anchor: None }) => {
                    self.book.order.push(path.clone());
                    match seen.insert(path.clone()) {
                        true => self.node(&path).err(),
                        false => Some(Diagnostic::new("this page has two entries")),
                    }
                }
                Ok(_) => {
                    Some(Diagnostic::new("this is no page of the site").expected("a file of the repository"))
                }
                Err(wrong) => Some(wrong),
            };
            if let Some(problem) = problem {
                self.problems.push(Problem::in_text(SUMMARY, text, entry.range.clone(), problem));
            }
        }
    }

    /// Refuses pages without an entry.
    fn unlisted(&mut self) {
        let mut found = Vec::new();
        pages_below(&self.sources.root, PAGES, &mut found);
        for path in found {
            if path != SUMMARY && !self.book.order.contains(&path) {
                let entry = path.strip_prefix(PAGES).unwrap_or(&path).trim_start_matches('/');
                let unlisted = Diagnostic::new("this page has no entry in docs/SUMMARY.md")
                    .hint(format!("add a line `- [Title]({entry})` to the part to which it belongs"));
                self.problems.push(Problem::whole(&path, unlisted));
            }
        }
    }

    /// Follows the links of all pages, and of the pages to which they lead.
    fn follow(&mut self) {
        while let Some(source) = self.waiting.pop() {
            let Some(page) = self.book.page(&source).cloned() else { continue };
            for Link { destination, range } in &page.links {
                let outcome = match Destination::read(&source, destination) {
                    Ok(Destination::Web) => {
                        self.book.web.entry(destination.clone()).or_default().insert(source.clone());
                        Ok(())
                    }
                    Ok(Destination::Local { path, .. }) => self.node(&path),
                    Err(wrong) => Err(wrong),
                };
                if let Err(wrong) = outcome {
                    self.report(&page, range, wrong);
                }
            }
        }
    }

    /// Checks the anchors of all links.
    fn anchors(&mut self) {
        let pages: Vec<&Document> = self.book.nodes.values().filter_map(Node::page).collect();
        let mut problems = Vec::new();
        for page in pages {
            for Link { destination, range } in &page.links {
                let Ok(Destination::Local { path, anchor: Some(anchor) }) =
                    Destination::read(&page.source, destination)
                else {
                    continue;
                };
                let wrong = match self.book.nodes.get(&path) {
                    Some(Node::Page(target)) if !target.has_anchor(&anchor) => {
                        let known = target.headings.iter().map(|heading| heading.anchor.as_str());
                        Diagnostic::new(format!("{path} has no heading with the anchor `{anchor}`"))
                            .hint(suggestion(&anchor, known, "anchors"))
                    }
                    // The documentation of the crates has anchors of its own.
                    Some(Node::Page(_) | Node::Crate(_)) | None => continue,
                    Some(_) => Diagnostic::new("only pages have anchors"),
                };
                problems.push(Problem::in_text(&page.source, &page.text, range.clone(), wrong));
            }
        }
        self.problems.extend(problems);
    }

    /// Reads the file or folder of this path, unless it has been read already.
    fn node(&mut self, path: &str) -> Result<(), Diagnostic> {
        if self.book.nodes.contains_key(path) {
            return Ok(());
        }
        let top = path.split('/').next().unwrap_or_default();
        let full = self.sources.root.join(path);
        if NOT_IN_A_CLONE.contains(&top) || !full.exists() {
            let beside = names_in(&self.sources.root.join(folder(path)));
            let name = path.rsplit('/').next().unwrap_or(path);
            return Err(Diagnostic::new(format!("the repository has no file `{path}`"))
                .hint_if(did_you_mean(name, beside.iter().map(String::as_str))));
        }
        let (node, problems) = Node::read(self.sources, path)
            .map_err(|error| Diagnostic::new(format!("`{path}` cannot be read: {error}")))?;
        self.problems.extend(problems);
        if matches!(node, Node::Page(_)) {
            self.waiting.push(path.to_owned());
        }
        self.book.nodes.insert(path.to_owned(), node);
        Ok(())
    }

    fn report(&mut self, page: &Document, range: &Range<usize>, wrong: Diagnostic) {
        self.problems.push(Problem::in_text(&page.source, &page.text, range.clone(), wrong));
    }
}

/// Adds all Markdown files below a folder.
fn pages_below(root: &Path, path: &str, found: &mut Vec<String>) {
    for name in names_in(&root.join(path)) {
        let inner = format!("{path}/{name}");
        if inner == PAPER {
            continue;
        }
        if root.join(&inner).is_dir() {
            pages_below(root, &inner, found);
        } else if name.ends_with(".md") {
            found.push(inner);
        }
    }
}

/// Names in a folder, in order; none if it cannot be read.
pub(crate) fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
