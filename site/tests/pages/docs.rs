//! The site of this repository: all pages build, and what they refer to is there.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::LazyLock;

use papilio_site::{Site, Sources, build};

/// The site, without the references that other tools write.
static SITE: LazyLock<Site> = LazyLock::new(|| {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    build(&Sources { root, python: None, rust: None }).unwrap_or_else(|problems| {
        let all: Vec<String> = problems.iter().map(ToString::to_string).collect();
        panic!("{}", all.join("\n\n"))
    })
});

fn pages() -> impl Iterator<Item = (&'static String, &'static String)> {
    SITE.texts().iter().filter(|(path, _)| path.ends_with(".html"))
}

/// Values of an attribute in a page.
fn attributes<'a>(html: &'a str, name: &str) -> impl Iterator<Item = &'a str> {
    let start = format!(" {name}=\"");
    let ends: Vec<&str> = html.split(&*start).skip(1).filter_map(|rest| rest.split('"').next()).collect();
    ends.into_iter()
}

/// Text between the first `start` and the next `end`.
fn between<'a>(html: &'a str, start: &str, end: &str) -> &'a str {
    html.split_once(start).and_then(|(_, rest)| rest.split_once(end)).map_or("", |(inner, _)| inner)
}

#[test]
fn every_link_of_the_site_leads_to_a_file_and_an_anchor_of_it() {
    let anchors: BTreeMap<&str, BTreeSet<&str>> =
        pages().map(|(path, html)| (path.as_str(), attributes(html, "id").collect())).collect();
    let mut checked = 0;
    for (path, html) in pages() {
        for link in attributes(html, "href").chain(attributes(html, "src")) {
            if link.contains(':') {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { path.clone() } else { resolved(path, file) };
            let is_there = SITE.texts().contains_key(&target) || SITE.copies().contains_key(&target);
            assert!(is_there, "{path}: {link}");
            let is_known = anchors.get(target.as_str()).is_some_and(|all| all.contains(anchor));
            assert!(anchor.is_empty() || is_known, "{path}: {link}");
            checked += 1;
        }
    }
    assert!(checked > 1000, "{checked}");
    assert!(SITE.copies().values().all(|file| file.is_file()));
}

/// Path of a relative URL, without `%20`s (no file of the site needs them).
fn resolved(from: &str, url: &str) -> String {
    let mut all: Vec<&str> = from.split('/').collect();
    all.pop();
    for name in url.split('/') {
        if name == ".." { all.pop().map(drop).unwrap() } else { all.push(name) }
    }
    all.join("/")
}

#[test]
fn no_page_requests_anything_from_the_web() {
    for (path, text) in SITE.texts() {
        let sources = attributes(text, "src").chain(attributes(text, "srcset"));
        for source in sources.filter(|source| !source.starts_with("data:")) {
            assert!(!source.contains(':') && !source.contains("//"), "{path}: {source}");
        }
        for tag in text.split("<link ").skip(1).filter_map(|rest| rest.split('>').next()) {
            assert!(!tag.contains("://"), "{path}: {tag}");
        }
    }
    for (path, file) in SITE.copies().iter().filter(|(path, _)| path.starts_with("assets/")) {
        let Ok(text) = std::fs::read_to_string(file) else { continue };
        let is_plain = ["@import", "//fonts", "fetch(", "XMLHttpRequest", "url(http", "url(//"]
            .iter()
            .all(|way| !text.contains(way));
        assert!(is_plain, "{path}");
    }
}

#[test]
fn every_page_has_a_title_a_description_a_language_and_one_first_heading() {
    let mut titles = BTreeSet::new();
    for (path, html) in pages() {
        assert!(
            html.contains("<html lang=\"en\"") && !html.contains("<th></th>") && !html.contains("\"></th>"),
            "{path}"
        );
        let title = between(html, "<title>", "</title>");
        assert!(title.len() > 3 && titles.insert(title), "{path}: {title}");
        let description = between(html, "<meta name=\"description\" content=\"", "\"");
        assert!(!description.is_empty() && description.chars().count() <= 180, "{path}: {description}");
        let first = html.matches("<h1").count();
        assert!(first == 1 || path == "all.html", "{path}: {first} first headings");
    }
}

#[test]
fn navigation_has_all_parts_and_marks_the_current_page() {
    let films = &SITE.texts()["films.html"];
    for part in ["Tutorial", "How-to", "Reference", "Theory", "Validation"] {
        assert!(films.contains(&format!("<summary>{part}</summary>")), "{part}");
    }
    assert!(films.contains("<a href=\"films.html\" aria-current=\"page\">Films</a>"));
    assert_eq!(films.matches("aria-current").count(), 1);
    assert!(films.contains("rel=\"prev\"") && films.contains("rel=\"next\""));
    assert!(
        films.contains("<h2 id=\"materials\"><a class=\"anchor\" href=\"#materials\">Materials</a></h2>")
    );
}

#[test]
fn files_of_the_repository_are_pages_and_files() {
    let page = &SITE.texts()["repository/scenarios/matrix.toml.html"];
    assert!(page.contains("<a href=\"matrix.toml\" download>") && page.contains("<span class=\"table\">"));
    assert!(SITE.copies().contains_key("repository/scenarios/matrix.toml"));
    assert!(SITE.texts()["repository/scenarios/index.html"].contains("<a href=\"matrix.toml.html\">"));
    assert!(
        SITE.texts()["notebooks/1-first-display.html"]
            .contains("<figure class=\"result\"><img src=\"data:image/svg")
    );
    assert!(SITE.copies().contains_key("notebooks/1-first-display.ipynb"));
    assert!(SITE.texts()["repository/ARCHITECTURE.html"].contains("<a href=\"../glossary.html\">"));
}

#[test]
fn index_of_the_search_has_every_section_of_every_page() {
    let script = &SITE.texts()["assets/index.js"];
    let json = script.strip_prefix("window.papilioIndex = ").unwrap().trim_end().trim_end_matches(';');
    let sections: Vec<[String; 6]> = serde_json::from_str(json).unwrap();
    let addresses: BTreeSet<&str> = sections.iter().map(|section| section[0].as_str()).collect();
    assert_eq!(addresses.len(), sections.len(), "an address is twice in the index");
    for address in [
        "index.html",
        "films.html",
        "films.html#materials",
        "scenario.html#displayglass",
        "repository/README.html",
    ] {
        assert!(addresses.contains(address), "{address}");
    }
    let [_, page, heading, part, text, _] =
        sections.iter().find(|section| section[0] == "films.html#thick-films").unwrap();
    assert_eq!([page, heading, part], ["Films", "Thick films", "How-to"]);
    let explained =
        |term: &str| sections.iter().filter(|section| section[5].split(' ').any(|word| word == term)).count();
    assert!(explained("contrast_ratio") > 0 && explained("conoscopic") > 0);
    assert!(text.len() > 100 && !text.contains("  ") && !text.contains('\n'));
}

#[test]
fn all_pages_as_one_have_every_page_and_unique_anchors() {
    let whole = &SITE.texts()["all.html"];
    let ids: Vec<&str> = attributes(whole, "id").filter(|id| id.contains("--")).collect();
    let unique: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(ids.len(), unique.len());
    assert!(unique.contains("films--materials") && unique.contains("notebooks-readme--notebooks"));
    let sections = whole.matches("class=\"whole\"").count();
    let of_docs = pages().filter(|(_, html)| html.contains("Source of this page: <code>docs/")).count();
    assert_eq!(sections, of_docs);
}

#[test]
fn site_is_written_with_all_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("site");
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("old.html"), "old").unwrap();
    SITE.write(&out).unwrap();
    assert!(!out.join("old.html").exists());
    for path in SITE.texts().keys().chain(SITE.copies().keys()) {
        assert!(out.join(path).is_file(), "{path}");
    }
}
