//! The page of each public crate, README.md: the tour of its library, from the first lines of its lib.rs.
//! `cargo xtask docs` writes it.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::manifests::{Manifest, public};

#[test]
fn readme_of_each_crate_is_the_tour_of_its_library() {
    for package in public() {
        let path = package.folder.join(package.about["readme"].as_str().unwrap());
        let page = page(&package);
        if std::env::var_os("PAPILIO_WRITE_DOCS").is_some() {
            fs::write(&path, &page).unwrap();
        }
        let written = fs::read_to_string(&path).unwrap_or_default();
        assert!(written == page, "{}: cargo xtask docs writes it again", path.display());
    }
}

#[test]
fn tour_for_readers_has_no_links_of_rustdoc_and_no_hidden_lines() {
    let tour = "\
//! Layers. See [`Beta`](crate::Beta), [the lobes](lobe) and [`film::coherent`]; `[sweep]` is a table.
//!
//! ```
//! # use hidden::thing;
//! let a = [1][0]; // [`a`]
//! ```
//! [`end`]
mod more;
//! not a part of it";
    let expected = "\
Layers. See `Beta`, the lobes and `film::coherent`; `[sweep]` is a table.

```rust
let a = [1][0]; // [`a`]
```
`end`
";
    assert_eq!(for_readers(tour), expected);
}

/// The page of a crate.
fn page(package: &Manifest) -> String {
    let targets = package.about["targets"].as_array().unwrap();
    let library = targets.iter().find(|target| target["kind"][0] == "lib").unwrap();
    let source = fs::read_to_string(library["src_path"].as_str().unwrap()).unwrap();
    let mut page = format!("# {}\n\n{}", package.name, for_readers(&source));
    page.push_str(
        "\n## Papilio\n\nThis crate belongs to Papilio, which simulates the appearance of reflective displays. All its crates have the same version; \
         `RELEASING.md` of the project states what versions promise.\n",
    );
    page.push_str(
        "\nLicensed under either of Apache 2.0 (`LICENSE-APACHE`) or MIT (`LICENSE-MIT`), at your option.",
    );
    for (file, sentence) in [
        (
            "page/package.json",
            "The page, if the package carries it, contains Roboto (Apache 2.0), and Preact and uPlot (MIT).",
        ),
        ("fonts/LICENSE", "The fonts in `fonts` are under Apache 2.0 (`fonts/LICENSE`)."),
        ("LICENSE-BOOST", "The coefficients of `erfc` are under the licence of Boost (`LICENSE-BOOST`)."),
        ("data/README.md", "The tables in `data` have sources and licences of their own (`data/README.md`)."),
    ] {
        if package.folder.join(Path::new(file)).is_file() {
            write!(page, " {sentence}").unwrap();
        }
    }
    page.push('\n');
    page
}

/// The documentation at the head of a file, for readers who have no rustdoc.
fn for_readers(source: &str) -> String {
    let mut page = String::new();
    let mut code = false;
    for line in source.lines().map_while(|line| line.strip_prefix("//!")) {
        let line = line.strip_prefix(' ').unwrap_or(line);
        if line.starts_with("```") {
            code = !code;
            page.push_str(if code && line == "```" { "```rust" } else { line });
        } else if !code {
            page.push_str(&without_links(line));
        } else if line == "#" || line.starts_with("# ") {
            continue;
        } else {
            page.push_str(line);
        }
        page.push('\n');
    }
    page
}

/// A line whose links to items are only their texts.
fn without_links(line: &str) -> String {
    let mut text = String::new();
    let mut rest = line;
    while let Some(start) = rest.find(['[', '`']) {
        let (before, from) = rest.split_at(start);
        text.push_str(before);
        // Code that is no link is copied.
        let is_code = from.starts_with('`');
        let end =
            if is_code { from[1..].find('`').map(|end| end + 2) } else { from.find(']').map(|end| end + 1) };
        let (whole, after) = from.split_at(end.unwrap_or(from.len()));
        rest = after;
        let target = after.strip_prefix('(').and_then(|after| after.split_once(')'));
        if is_code || !(whole.starts_with("[`") || target.is_some()) {
            text.push_str(whole);
            continue;
        }
        text.push_str(whole.trim_matches(['[', ']']));
        if let Some((_, after)) = target {
            rest = after;
        }
    }
    text.push_str(rest);
    text
}
