//! All pages as one, to print or to search with the browser: each page is a section, and its links lead to
//! other sections.

use std::fmt::Write as _;

use crate::Sources;
use crate::book::Book;
use crate::document::{Document, Heading};
use crate::html::{Surroundings, escape, render};
use crate::layout::{self, Content};
use crate::links::relative;
use crate::site::picture_of;

/// URL of the page.
pub(crate) const URL: &str = "all.html";

/// Returns the page: all pages of `docs/` that the summary lists, in its order.
pub(crate) fn page(sources: &Sources, book: &Book) -> String {
    let mut list = String::new();
    let mut sections = String::new();
    for (part, entries) in book.parts() {
        let pages: Vec<_> =
            entries.iter().filter_map(|(_, path)| book.page(path)).filter(|page| is_part(page)).collect();
        if pages.is_empty() {
            continue;
        }
        if !part.is_empty() {
            let _ = write!(list, "<h2>{}</h2>", escape(part));
        }
        list += "<ul>";
        for page in pages {
            let name = name(page);
            let _ = write!(list, "<li><a href=\"#{name}\">{}</a></li>", escape(&page.title));
            let body = render(page, &Within { sources, book, page });
            let _ = write!(sections, "<section id=\"{name}\" class=\"whole\">\n{body}</section>\n");
        }
        list += "</ul>\n";
    }
    let body = format!("<h1>Papilio, all pages</h1>\n<div class=\"list\">{list}</div>\n{sections}");
    let description = "All pages of Papilio's documentation as one, to print or to read without a network.";
    layout::page(
        book,
        &Content { url: URL, title: "All pages", description, body: &body, ..Content::default() },
    )
}

/// Pages of the code's own files are left out.
fn is_part(page: &Document) -> bool {
    page.source.starts_with("docs/")
}

/// Anchor of a page: its path, without folder `docs` and extension.
fn name(page: &Document) -> String {
    let path = page.source.trim_start_matches("docs/");
    path.rsplit_once('.').map_or(path, |(stem, _)| stem).replace('/', "-").to_lowercase()
}

/// A page among the others.
struct Within<'a> {
    sources: &'a Sources,
    book: &'a Book,
    page: &'a Document,
}

impl Surroundings for Within<'_> {
    fn link(&self, link: &str) -> String {
        let Some((path, anchor)) = self.book.target(&self.page.source, link) else { return link.to_owned() };
        let listed = self.book.order.contains(&path);
        match (self.book.page(&path).filter(|page| listed && is_part(page)), anchor) {
            (Some(page), Some(anchor)) => format!("#{}--{anchor}", name(page)),
            (Some(page), None) => format!("#{}", name(page)),
            (None, anchor) => {
                relative(URL, &self.book.url(&path))
                    + &anchor.map(|anchor| format!("#{anchor}")).unwrap_or_default()
            }
        }
    }

    fn picture(&self, link: &str) -> String {
        picture_of(self.sources, self.book, self.page, link, URL)
    }

    fn anchor(&self, heading: &Heading) -> String {
        format!("{}--{}", name(self.page), heading.anchor)
    }
}
