//! The reference pages that are made from the program: the command line and the metrics. `cargo xtask docs`
//! writes them; these tests fail if a page is not what the program says.

mod command_line;
mod metrics;

use std::path::Path;

/// Compares the text of a page between `<!-- NAME -->` and `<!-- end of NAME -->` with what is made from the
/// program, or writes it.
fn check(page: &str, parts: &[(&str, String)]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs").join(page);
    let found = std::fs::read_to_string(&path).unwrap();
    let made = parts.iter().fold(found.clone(), |page, (name, made)| with(&page, name, made));
    if std::env::var_os("PAPILIO_WRITE_DOCS").is_some() {
        return std::fs::write(&path, &made).unwrap();
    }
    let differs = made.lines().zip(found.lines()).find(|(made, found)| made != found);
    assert!(made == found, "docs/{page} is out of date, run `cargo xtask docs`: {differs:?}");
}

fn with(page: &str, name: &str, made: &str) -> String {
    let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- end of {name} -->"));
    let (before, rest) = page.split_once(&begin).unwrap_or_else(|| panic!("the page has no `{begin}`"));
    let (_, after) = rest.split_once(&end).unwrap_or_else(|| panic!("the page has no `{end}`"));
    format!("{before}{begin}\n{}\n\n{end}{after}", made.trim())
}

/// A cell of a table: on one line, without the bar that begins the next cell, and without stars (`L*`) that
/// begin an emphasis.
fn cell(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ").replace('|', "\\|");
    let parts = line.split('`').enumerate();
    let parts = parts.map(|(k, part)| if k % 2 == 0 { part.replace('*', "\\*") } else { part.to_owned() });
    parts.collect::<Vec<_>>().join("`")
}

#[test]
fn command_line_of_the_docs_is_that_of_the_program() {
    check("cli.md", &[("commands", command_line::reference(papilio_cli::command()))]);
}

#[test]
fn metrics_of_the_docs_are_those_of_the_program() {
    check("metric-names.md", &[("metrics", metrics::tables())]);
}
