//! Small repositories: what is refused, and with which message.

use std::fs;
use std::path::Path;

use papilio_site::{Site, Sources, build};

/// Builds the site of a repository with these files; `docs/README.md` and its entry are always there.
fn built(summary: &str, files: &[(&str, &str)]) -> Result<Site, Vec<String>> {
    let summary = format!("[Start](README.md)\n\n# Part\n\n{summary}");
    let start = "# Start\n\nThe first page.\n\n## A section\n";
    let first = [("docs/SUMMARY.md", summary.as_str()), ("docs/README.md", start)];
    site_of(repository(&[&first, files].concat()).path())
}

fn site_of(root: &Path) -> Result<Site, Vec<String>> {
    build(&Sources { root: root.to_owned(), python: None, rust: None })
        .map_err(|problems| problems.iter().map(ToString::to_string).collect())
}

/// The one mistake of a page that is in the summary.
fn mistake(page: &str) -> String {
    let problems = built("- [Page](how-to/page.md)\n", &[("docs/how-to/page.md", page)]).unwrap_err();
    assert_eq!(problems.len(), 1, "{problems:?}");
    problems[0].clone()
}

#[test]
fn page_in_a_folder_is_linked_from_and_to_others() {
    let files = [
        (
            "docs/how-to/page.md",
            "# Page\n\nSee [start](../README.md#a-section), [data](../../data/x.toml), [it](#part).\n\n## Part\n",
        ),
        ("data/x.toml", "a = 1\n"),
    ];
    let site = built("- [Page](how-to/page.md)\n", &files).unwrap();
    let page = &site.texts()["how-to/page.html"];
    for link in ["../index.html#a-section", "../repository/data/x.toml.html", "#part", "../assets/style.css"]
    {
        assert!(page.contains(&format!("href=\"{link}\"")), "{link}");
    }
    assert!(site.texts()["index.html"].contains("<a class=\"next\" rel=\"next\" href=\"how-to/page.html\">"));
}

#[test]
fn page_without_entry_and_entry_without_page_are_refused() {
    let problems = built("", &[("docs/theory/films.md", "# Films\n")]).unwrap_err();
    assert_eq!(
        problems,
        [
            "error: this page has no entry in docs/SUMMARY.md\n --> docs/theory/films.md\n  = help: add a line \
          `- [Title](theory/films.md)` to the part to which it belongs"
        ]
    );
    let problems = built("- [Films](flims.md)\n- [Start](README.md)\n", &[]).unwrap_err();
    assert_eq!(problems.len(), 2);
    assert!(
        problems[0]
            .starts_with("error: the repository has no file `docs/flims.md`\n --> docs/SUMMARY.md:5:1\n")
    );
    assert!(problems[1].starts_with("error: this page has two entries\n --> docs/SUMMARY.md:6:1\n"));
}

#[test]
fn broken_link_is_reported_with_file_line_and_hint() {
    let shown = mistake("# Page\n\nA [link](../RAEDME.md).\n");
    assert_eq!(
        shown,
        "error: the repository has no file `docs/RAEDME.md`\n --> docs/how-to/page.md:3:3\n  |\n\
         3 | A [link](../RAEDME.md).\n  |   ^^^^^^^^^^^^^^^^^^^^\n  = help: did you mean `README.md`?"
    );
    for (page, message) in [
        ("![picture](x.png)", "the repository has no file `docs/how-to/x.png`"),
        ("[out](../../../x)", "this path leaves the repository"),
        ("[built](../../target/x)", "the repository has no file `target/x`"),
        ("[root](/docs/README.md)", "this is no path relative to the page"),
        ("[section](../README.md#a-setcion)", "docs/README.md has no heading with the anchor `a-setcion`"),
        ("[here](#nowhere)", "docs/how-to/page.md has no heading with the anchor `nowhere`"),
        ("[list](../../docs#x)", "only pages have anchors"),
        ("<a href=\"x\">link</a>", "HTML that refers to something else"),
        ("$\\nosuch$", "this equation cannot be read"),
    ] {
        let shown = mistake(&format!("# Page\n\n{page}\n"));
        assert!(shown.starts_with(&format!("error: {message}")), "{page}: {shown}");
        assert!(shown.contains("--> docs/how-to/page.md:3:1"), "{page}: {shown}");
    }
}

#[test]
fn anchor_that_was_misspelled_gets_a_suggestion() {
    let shown = mistake("# Page\n\n[section](../README.md#a-setcion)\n");
    assert!(shown.ends_with("= help: did you mean `a-section`?"), "{shown}");
}

#[test]
fn text_of_the_repository_without_a_title_gets_its_path() {
    let files = [
        ("docs/README.md", "# Start\n\n[font](../font/README.md)\n"),
        ("font/README.md", "### Source\n\nText.\n"),
    ];
    let site = built("", &files).unwrap();
    assert!(
        site.texts()["repository/font/README.html"].contains("<h1>font/README.md</h1>\n<h3 id=\"source\">")
    );
}

#[test]
fn links_into_the_web_are_listed_and_not_changed() {
    let site = built("", &[("docs/README.md", "# Start\n\n[web](https://example.org/a?b=1&c=2)\n")]).unwrap();
    assert_eq!(site.web_links(), [("https://example.org/a?b=1&c=2".to_owned(), "docs/README.md".to_owned())]);
    assert!(site.texts()["index.html"].contains("href=\"https://example.org/a?b=1&amp;c=2\""));
    assert_eq!(site.texts()["web-links.txt"], "https://example.org/a?b=1&c=2\tdocs/README.md\n");
}

#[test]
fn equations_tables_pictures_and_code_become_html_without_scripts() {
    let page = "# Page\n\nAn $x^2$.\n\n$$\\frac{1}{2}$$\n\n![A bar](bar.svg \"Its caption\")\n\n| a |\n|---|\n| `--a` |\n\n- [x] done\n\n```toml\na = 1\n```\n";
    let picture = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"3\" height=\"4\"></svg>";
    let site = built("- [Page](page.md)\n", &[("docs/page.md", page), ("docs/bar.svg", picture)]).unwrap();
    let html = &site.texts()["page.html"];
    for part in [
        "<math display=\"inline\">",
        "<div class=\"equation\"><math display=\"block\">",
        "<figure><a href=\"bar.svg\"><img src=\"bar.svg\" width=\"3\" height=\"4\" loading=\"lazy\" alt=\"A bar\"></a><figcaption>Its caption</figcaption></figure>",
        "<div class=\"table\"><table>",
        "<td><code class=\"word\">--a</code></td>",
        "<li>☑ done</li>",
        "<code class=\"language-toml\"><span class=\"key\">a </span>=",
    ] {
        assert!(html.contains(part), "{part}\n{html}");
    }
    assert!(site.texts()["all.html"].contains("<img src=\"bar.svg\" width=\"3\" height=\"4\" alt"));
}

/// Writes the files of a repository into a new folder.
fn repository(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (path, text) in files {
        let full = folder.path().join(path);
        fs::create_dir_all(full.parent().unwrap()).unwrap();
        fs::write(full, text).unwrap();
    }
    folder
}

#[test]
fn reference_of_a_python_module_stands_in_the_place_of_its_source() {
    let folder = repository(&[
        ("docs/SUMMARY.md", "- [Start](README.md)\n- [Films](../python/papilio/films.py)\n"),
        ("docs/README.md", "# Start\n\nText.\n"),
        ("python/papilio/films.py", "\"\"\"Films.\"\"\"\n"),
        ("written/films.md", "# `papilio.films`\n\nCoherent films.\n"),
    ]);
    let site = site_of(folder.path()).unwrap();
    assert!(site.texts()["repository/python/papilio/films.py.html"].contains("Films."));
    let python = Some(folder.path().join("written"));
    let site = build(&Sources { root: folder.path().to_owned(), python, rust: None }).unwrap();
    assert!(site.texts()["api/python/films.html"].contains("Coherent films."));
}

#[test]
fn documentation_of_a_crate_stands_in_the_place_of_its_first_file() {
    let folder = repository(&[
        ("docs/SUMMARY.md", "- [Start](README.md)\n"),
        ("docs/README.md", "# Start\n\n[optics](../crates/optics/src/lib.rs)\n"),
        ("crates/optics/src/lib.rs", "//! Optics.\n"),
        ("doc/papilio_optics/index.html", "<p>Optics</p>"),
    ]);
    let site = site_of(folder.path()).unwrap();
    assert!(site.texts()["index.html"].contains("href=\"repository/crates/optics/src/lib.rs.html\""));
    let rust = Some(folder.path().join("doc"));
    let site = build(&Sources { root: folder.path().to_owned(), python: None, rust }).unwrap();
    assert!(site.texts()["index.html"].contains("href=\"api/rust/papilio_optics/index.html\""));
    site.write(&folder.path().join("site")).unwrap();
    assert!(folder.path().join("site/api/rust/papilio_optics/index.html").is_file());
}
