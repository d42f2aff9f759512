//! The index of the search: title, heading, address and text of every section of the pages.
//!
//! The page's script ranks them (`assets/search.js`). The index is a script, too: browsers do not let a page
//! that was opened from a disk read files.

use serde_json::json;

use crate::book::Book;
use crate::document::Document;

/// Returns the script that holds the index.
pub(crate) fn index(book: &Book) -> String {
    let mut sections = Vec::new();
    for (part, entries) in book.parts() {
        for (_, path) in entries {
            let Some((page, node)) = book.page(path).zip(book.nodes.get(path)) else { continue };
            add(page, part, &node.url(path), &mut sections);
        }
    }
    format!("window.papilioIndex = {};\n", serde_json::Value::from(sections))
}

/// Adds the sections of a page: address, title of the page, heading, part of the site, text, terms.
fn add(page: &Document, part: &str, url: &str, sections: &mut Vec<serde_json::Value>) {
    for section in &page.sections {
        let heading = section.heading.and_then(|number| page.headings.get(number));
        let below_title = heading.filter(|heading| heading.level > 1);
        let address =
            below_title.map_or_else(|| url.to_owned(), |heading| format!("{url}#{}", heading.anchor));
        let heading = below_title.map_or("", |heading| heading.text.as_str());
        sections.push(json!([address, page.title, heading, part, section.text, section.terms]));
    }
}
