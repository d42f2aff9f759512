//! The generator as a program: `papilio-site OUT [--python FOLDER] [--rust FOLDER]`, run at the top of the
//! repository by `cargo xtask site`.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for the terminal")]

use std::path::PathBuf;
use std::process::ExitCode;

use papilio_site::{Sources, build};

fn main() -> ExitCode {
    match run(std::env::args().skip(1)) {
        Ok(summary) => {
            println!("{summary}");
            ExitCode::SUCCESS
        }
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}

fn run(mut arguments: impl Iterator<Item = String>) -> Result<String, String> {
    let usage = "usage: papilio-site OUT [--python FOLDER] [--rust FOLDER]";
    let mut sources = Sources { root: PathBuf::from("."), python: None, rust: None };
    let out = PathBuf::from(arguments.next().ok_or(usage)?);
    while let Some(option) = arguments.next() {
        let folder = PathBuf::from(arguments.next().ok_or(usage)?);
        match option.as_str() {
            "--python" => sources.python = Some(folder),
            "--rust" => sources.rust = Some(folder),
            _ => return Err(usage.to_owned()),
        }
    }
    let site = build(&sources).map_err(|problems| {
        let all: Vec<String> = problems.iter().map(ToString::to_string).collect();
        format!("{}\n\n{} problems in the pages; no site was written", all.join("\n\n"), all.len())
    })?;
    site.write(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let pages = site.texts().keys().filter(|path| path.ends_with(".html")).count();
    Ok(format!(
        "{pages} pages, {} files and {} links into the web (listed in web-links.txt, not requested) in {}",
        site.copies().len(),
        site.web_links().len(),
        out.join("index.html").display()
    ))
}
