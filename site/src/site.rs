//! The files of the site.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::book::{Book, names_in};
use crate::document::{Document, Heading};
use crate::html::{Surroundings, code_block, escape, render};
use crate::layout::{self, Content};
use crate::links::relative;
use crate::node::{Node, RUST, extension, place};
use crate::{Problem, Sources, picture, search, whole};

/// Style sheets, scripts and fonts of the site itself, and the template of its pages.
const ASSETS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets");

/// List of all links into the web, each with a page that has it.
const WEB: &str = "web-links.txt";

/// The site, before it is written.
#[derive(Debug, Default)]
pub struct Site {
    texts: BTreeMap<String, String>,
    copies: BTreeMap<String, PathBuf>,
    /// The documentation of the crates.
    rust: Option<PathBuf>,
    web: Vec<(String, String)>,
}

/// Reads the pages and all that they refer to.
///
/// # Errors
/// All mistakes in the pages, by file and line.
pub fn build(sources: &Sources) -> Result<Site, Vec<Problem>> {
    let book = Book::read(sources)?;
    let mut site = Site { rust: sources.rust.clone(), ..Site::default() };
    for (path, node) in &book.nodes {
        site.add(sources, &book, path, node);
    }
    site.texts.insert(whole::URL.to_owned(), whole::page(sources, &book));
    site.texts.insert("assets/index.js".to_owned(), search::index(&book));
    let assets = Path::new(ASSETS);
    for name in names_in(assets).into_iter().filter(|name| name != layout::TEMPLATE_NAME) {
        site.copies.insert(format!("assets/{name}"), assets.join(name));
    }
    for (link, pages) in &book.web {
        site.web.extend(pages.iter().map(|page| (link.clone(), page.clone())));
    }
    let web = site.web.iter().map(|(link, page)| format!("{link}\t{page}\n"));
    site.texts.insert(WEB.to_owned(), web.collect());
    Ok(site)
}

impl Site {
    /// Files whose content has been generated, by their path in the site.
    pub fn texts(&self) -> &BTreeMap<String, String> {
        &self.texts
    }

    /// Files that are copied, by their path in the site.
    pub fn copies(&self) -> &BTreeMap<String, PathBuf> {
        &self.copies
    }

    /// Links into the web, each with a page that has it. Nothing checks that they exist.
    pub fn web_links(&self) -> &[(String, String)] {
        &self.web
    }

    /// Writes the site, and removes what the folder contained before.
    ///
    /// # Errors
    /// If a file cannot be written or copied.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        match fs::remove_dir_all(folder) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        for (path, text) in &self.texts {
            fs::write(with_folder(folder, path)?, text)?;
        }
        for (path, from) in &self.copies {
            fs::copy(from, with_folder(folder, path)?)?;
        }
        self.rust.as_ref().map_or(Ok(()), |rust| copy_folder(rust, &folder.join(RUST)))
    }

    fn add(&mut self, sources: &Sources, book: &Book, path: &str, node: &Node) {
        let url = node.url(path);
        let content = Content { url: &url, source: path, title: path, ..Content::default() };
        let text = match node {
            Node::Page(page) => {
                if extension(path) == "ipynb" {
                    self.copies.insert(place(path), sources.root.join(path));
                }
                page_of(sources, book, page, content)
            }
            Node::Folder(names) => folder_of(book, path, names, content),
            Node::Text(text) => {
                self.copies.insert(place(path), sources.root.join(path));
                text_of(book, path, text, content)
            }
            Node::Crate(_) => return,
            Node::File => {
                self.copies.insert(place(path), sources.root.join(path));
                return;
            }
        };
        self.texts.insert(url.clone(), text);
    }
}

/// Path of a file, whose folder is created.
fn with_folder(folder: &Path, path: &str) -> io::Result<PathBuf> {
    let full = folder.join(path);
    full.parent().map_or(Ok(()), fs::create_dir_all)?;
    Ok(full)
}

fn copy_folder(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_folder(&entry.path(), &target)?
        } else {
            fs::copy(entry.path(), target).map(drop)?
        }
    }
    Ok(())
}

fn page_of(sources: &Sources, book: &Book, page: &Document, content: Content<'_>) -> String {
    let mut body = render(page, &OnItsOwn { sources, book, page, url: content.url });
    if !page.has_title() {
        body = format!("<h1>{}</h1>\n{body}", escape(&page.title));
    }
    if extension(&page.source) == "ipynb" {
        let file = relative(content.url, &place(&page.source));
        body += &format!("<p><a href=\"{file}\" download>Download this notebook</a></p>\n");
    }
    let contents =
        page.headings.iter().map(|heading| (heading.level, heading.anchor.clone(), heading.text.clone()));
    let contents = contents.collect();
    layout::page(
        book,
        &Content { title: &page.title, description: &page.description, body: &body, contents, ..content },
    )
}

/// A list of the files; those that the site has are links.
fn folder_of(book: &Book, path: &str, names: &[String], content: Content<'_>) -> String {
    let shown = if path.is_empty() { "The repository" } else { path };
    let mut body = format!("<h1>{}</h1>\n<ul class=\"files\">", escape(shown));
    for name in names {
        let inner = format!("{path}/{name}");
        let inner = inner.trim_matches('/');
        let text = escape(name);
        body += &match book.nodes.get(inner) {
            Some(node) => {
                format!("<li><a href=\"{}\">{text}</a></li>", relative(content.url, &node.url(inner)))
            }
            None => format!("<li>{text}</li>"),
        };
    }
    body += "</ul>";
    let description = format!("Files of the folder {shown} of Papilio's repository.");
    layout::page(book, &Content { title: shown, description: &description, body: &body, ..content })
}

fn text_of(book: &Book, path: &str, text: &str, content: Content<'_>) -> String {
    let file = relative(content.url, &place(path));
    let code = code_block(text, extension(path));
    let name = escape(path);
    let body = format!("<h1>{name}</h1>\n<p><a href=\"{file}\" download>Download this file</a></p>\n{code}");
    let description = format!("The file {path} of Papilio's repository.");
    layout::page(book, &Content { description: &description, body: &body, ..content })
}

/// A page in a file of its own.
struct OnItsOwn<'a> {
    sources: &'a Sources,
    book: &'a Book,
    page: &'a Document,
    url: &'a str,
}

impl Surroundings for OnItsOwn<'_> {
    fn link(&self, link: &str) -> String {
        let Some((path, anchor)) = self.book.target(&self.page.source, link) else { return link.to_owned() };
        let anchor = anchor.map(|anchor| format!("#{anchor}")).unwrap_or_default();
        if path == self.page.source && !anchor.is_empty() {
            return anchor;
        }
        relative(self.url, &self.book.url(&path)) + &anchor
    }

    fn picture(&self, link: &str) -> String {
        picture_of(self.sources, self.book, self.page, link, self.url) + " loading=\"lazy\""
    }

    fn anchor(&self, heading: &Heading) -> String {
        heading.anchor.clone()
    }
}

/// Attributes of a picture: its address, and its size in pixels.
pub(crate) fn picture_of(sources: &Sources, book: &Book, page: &Document, link: &str, url: &str) -> String {
    let Some((path, _)) = book.target(&page.source, link) else { return String::new() };
    let file = fs::read(sources.root.join(&path)).unwrap_or_default();
    let size = picture::size(&file);
    let size =
        size.map(|(width, height)| format!(" width=\"{width}\" height=\"{height}\"")).unwrap_or_default();
    format!("src=\"{}\"{size}", escape(&relative(url, &book.url(&path))))
}
