//! The page around a page: head, navigation, table of contents, links to the pages before and after.

use std::fmt::Write as _;

use crate::book::Book;
use crate::html::escape;
use crate::links::relative;
use crate::whole;

/// Name of the template in the folder of the assets.
pub(crate) const TEMPLATE_NAME: &str = "page.html";

/// Template of all pages.
const TEMPLATE: &str = include_str!("../assets/page.html");

/// What is particular to a page.
#[derive(Debug, Clone, Default)]
pub(crate) struct Content<'a> {
    /// URL from the start of the site.
    pub(crate) url: &'a str,
    /// Path in the repository; "" for a page without one.
    pub(crate) source: &'a str,
    /// Title of the browser's window, without the names of its part and of the site.
    pub(crate) title: &'a str,
    pub(crate) description: &'a str,
    /// HTML of the page itself.
    pub(crate) body: &'a str,
    /// Level, anchor and text of the headings for the table of contents.
    pub(crate) contents: Vec<(usize, String, String)>,
}

/// Returns a complete page.
pub(crate) fn page(book: &Book, content: &Content<'_>) -> String {
    let root = "../".repeat(content.url.matches('/').count());
    let description = if content.description.is_empty() { content.title } else { content.description };
    // Pages of two parts may have the same title: that of a model and its use.
    let is_here = |entries: &[(_, &str)]| entries.iter().any(|(_, path)| *path == content.source);
    let part = book.parts().find(|(_, entries)| is_here(entries)).map_or("", |(part, _)| part);
    let mut names = vec![content.title, part, "Papilio"];
    names.retain(|name| !name.is_empty());
    names.dedup();
    let title = names.join(" · ");
    filled(TEMPLATE, &|name| match name {
        "root" => root.clone(),
        "title" => escape(&title),
        "description" => escape(description),
        "navigation" => navigation(book, content),
        "contents" => contents(content),
        "body" => content.body.to_owned(),
        "steps" => steps(book, content),
        "whole" => relative(content.url, whole::URL),
        "source" => source(content),
        _ => String::new(),
    })
}

/// Replaces each `{{name}}` of the template.
fn filled(template: &str, value: &dyn Fn(&str) -> String) -> String {
    let mut parts = template.split("{{");
    let mut page = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once("}}").unwrap_or(("", part));
        page += &value(name);
        page += rest;
    }
    page
}

/// All pages by parts; the part of the current page is open, and on the first page, all are.
fn navigation(book: &Book, content: &Content<'_>) -> String {
    let mut html = String::new();
    let is_start = book.order.first().is_some_and(|path| path == content.source);
    for (title, entries) in book.parts() {
        let is_open = is_start || entries.iter().any(|(_, path)| *path == content.source);
        if !title.is_empty() {
            let open = if is_open { " open" } else { "" };
            let _ = write!(html, "<details{open}><summary>{}</summary>", escape(title));
        }
        html += "<ul>";
        for (entry, path) in entries {
            let url = relative(content.url, &book.url(path));
            let current = if path == content.source { " aria-current=\"page\"" } else { "" };
            let nested = if entry.depth > 0 { " class=\"nested\"" } else { "" };
            let _ = write!(html, "<li{nested}><a href=\"{url}\"{current}>{}</a></li>", escape(&entry.title));
        }
        html += "</ul>";
        if !title.is_empty() {
            html += "</details>";
        }
        html.push('\n');
    }
    html
}

/// The table of contents; nothing for a page of one section.
fn contents(content: &Content<'_>) -> String {
    let inner: Vec<_> = content.contents.iter().filter(|(level, ..)| (2..=3).contains(level)).collect();
    if inner.len() < 2 {
        return String::new();
    }
    let mut html =
        "<nav class=\"contents\" aria-label=\"On this page\"><details><summary>On this page</summary><ul>"
            .to_owned();
    for (level, anchor, text) in inner {
        let nested = if *level == 3 { " class=\"nested\"" } else { "" };
        let _ = write!(html, "<li{nested}><a href=\"#{}\">{}</a></li>", escape(anchor), escape(text));
    }
    html + "</ul></details></nav>"
}

/// Links to the pages before and after.
fn steps(book: &Book, content: &Content<'_>) -> String {
    let Some(at) = book.order.iter().position(|path| path == content.source) else { return String::new() };
    let entries: Vec<_> = book.summary.entries().collect();
    let step = |at: Option<usize>, class: &str, words: &str| {
        let at = at.filter(|at| *at < book.order.len());
        let found = at.and_then(|at| Some((book.order.get(at)?, entries.get(at)?)));
        let Some((path, entry)) = found else { return String::new() };
        let url = relative(content.url, &book.url(path));
        let title = escape(&entry.title);
        format!("<a class=\"{class}\" rel=\"{class}\" href=\"{url}\"><small>{words}</small> {title}</a>")
    };
    let both = step(at.checked_sub(1), "prev", "Previous") + &step(Some(at + 1), "next", "Next");
    format!("<nav class=\"steps\" aria-label=\"Previous and next page\">{both}</nav>")
}

fn source(content: &Content<'_>) -> String {
    match content.source {
        "" => String::new(),
        source => format!("Source of this page: <code>{}</code>", escape(source)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_a_template_are_not_filled_again() {
        let page = filled("<p>{{a}} {{b}}</p>", &|name| {
            if name == "a" { "{{b}}".into() } else { name.to_uppercase() }
        });
        assert_eq!(page, "<p>{{b}} B</p>");
    }
}
