//! `cargo xtask licences`: release/THIRD-PARTY.md, the licences of everything that is distributed with
//! Papilio.
//!
//! The lists come from `cargo tree`, `cargo metadata` and the lock file of the page, the texts from the
//! packages themselves. Of a package that may be used under Apache 2.0, this licence is taken: its text is in
//! the repository. A test (`xtask/tests/xtask/project.rs`) compares the lists with both lock files.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::page;
use crate::shell::{Outcome, cargo, root};

/// Programs that are distributed; what they link to is listed with its licence.
const DISTRIBUTED: [&str; 2] = ["papilio", "papilio-python"];

const HEAD: &str = "# Third-party software

Papilio itself is licensed under either of [Apache 2.0](../LICENSE-APACHE) or [MIT](../LICENSE-MIT), at your option. This file lists what is
distributed with it, and is written by `cargo xtask licences`. A package that offers Apache 2.0 is used under Apache 2.0, whose
text is [LICENSE-APACHE](../LICENSE-APACHE); the [texts](#texts) of all others are below. The Python package uses the NumPy that the user installs.

";

const REPOSITORY: &str = "## In the repository itself

| what | licence |
|---|---|
| Roboto 2.138, subsets of Regular and Bold (`crates/imaging/fonts`), copyright 2011 Google Inc. | Apache-2.0 |
| Latin Modern Math 1.959 (`site/assets/latinmodern-math.woff2`), in the documentation site only | GUST Font License ([text](../site/assets/GUST-FONT-LICENSE.txt)) |
| coefficients of the Boost Math Toolkit (`crates/sampling/src/erf/pieces.rs`), copyright 2006 John Maddock | BSL-1.0 ([text](../crates/sampling/LICENSE-BOOST)) |
| tables of the CIE, by colour-science (`crates/spectra/data`, `crates/colour/data`) | CC BY-SA 4.0 and BSD-3-Clause ([attribution and text](../crates/spectra/data/README.md)) |
| n and k of the refractiveindex.info database (`crates/spectra/data/materials.txt`) | CC0-1.0 |
| photograph `scenarios/data/chelsea.png`, by Stefan van der Walt | CC0-1.0 |

[Provenance of data](../docs/provenance.md) lists every file.

";

/// A package of a registry.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Package {
    name: String,
    version: String,
}

/// What is said about a package.
struct About {
    licence: String,
    authors: String,
    folder: PathBuf,
}

type Packages = BTreeMap<Package, About>;

/// Runs the task.
pub(crate) fn licences() -> Outcome {
    let (linked, others) = crates()?;
    let scripts = scripts()?;
    let mut text = HEAD.to_owned();
    text += &table("In the program and the Python package", &linked);
    text += &table("In the page of the web app", &scripts);
    text += REPOSITORY;
    text += "## For tests, benchmarks and builds only\n\n";
    text += "Not distributed: no program of Papilio contains them.\n\n";
    others.iter().for_each(|Package { name, version }| text += &format!("- {name} {version}\n"));
    text += "\n## Texts\n";
    for (licence, packages) in texts(linked.iter().chain(&scripts))? {
        text += &format!("\n### {}\n\n{}\n", packages.join(", "), indented(&licence));
    }
    let path = root().join("release/THIRD-PARTY.md");
    fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    println!(
        "wrote release/THIRD-PARTY.md: {} crates and {} packages of the page",
        linked.len(),
        scripts.len()
    );
    Ok(())
}

/// The crates that programs link to, on any system, and all other crates of the lock file.
fn crates() -> Result<(Packages, BTreeSet<Package>), String> {
    let metadata = output(&["metadata", "--format-version", "1", "--all-features", "--locked"])?;
    let metadata: Value =
        serde_json::from_str(&metadata).map_err(|error| format!("cargo metadata: {error}"))?;
    let mut known: Packages =
        metadata["packages"].as_array().into_iter().flatten().filter_map(described).collect();
    let mut tree = vec!["tree", "--edges", "normal", "--target", "all", "--all-features", "--locked"];
    tree.extend(["--prefix", "none", "--format", "{p}"]);
    DISTRIBUTED.iter().for_each(|name| tree.extend(["--package", name]));
    let linked: BTreeSet<Package> = output(&tree)?.lines().filter_map(named).collect();
    let found = linked.into_iter().filter_map(|package| known.remove_entry(&package)).collect();
    Ok((found, known.into_keys().collect()))
}

/// The standard output of cargo.
fn output(arguments: &[&str]) -> Result<String, String> {
    let shown = format!("cargo {}", arguments.join(" "));
    let output = cargo(arguments).output().map_err(|error| format!("{shown}: {error}"))?;
    if !output.status.success() {
        return Err(format!("{shown}: {}", String::from_utf8_lossy(&output.stderr).trim()));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// A package of `cargo metadata`; `None` for the crates of Papilio.
fn described(package: &Value) -> Option<(Package, About)> {
    package["source"].as_str()?;
    let text = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
    let authors = package["authors"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let about = About {
        licence: text("license").replace('/', " OR "),
        authors: authors.map(without_address).collect::<Vec<_>>().join(", "),
        folder: Path::new(package["manifest_path"].as_str()?).parent()?.to_owned(),
    };
    Some((Package { name: text("name"), version: text("version") }, about))
}

/// A name, without the address behind it.
fn without_address(author: &str) -> &str {
    author.split('<').next().unwrap_or(author).trim()
}

/// A package as a line of `cargo tree` names it: `NAME vVERSION`.
fn named(line: &str) -> Option<Package> {
    let mut words = line.split_whitespace();
    let name = words.next()?.to_owned();
    Some(Package { name, version: words.next()?.strip_prefix('v')?.to_owned() })
}

/// The packages that end in the page.
fn scripts() -> Result<Packages, String> {
    let folder = page::folder();
    let path = folder.join("package-lock.json");
    let fault = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let lock = fs::read_to_string(&path).map_err(|error| fault(&error))?;
    let lock: Value = serde_json::from_str(&lock).map_err(|error| fault(&error))?;
    let packages = lock["packages"].as_object().into_iter().flatten();
    let packages = packages.filter(|(place, about)| !place.is_empty() && about["dev"] != true);
    let described = packages.map(|(place, about)| {
        let text = |key: &str| about[key].as_str().unwrap_or_default().to_owned();
        let name = place.rsplit_once("node_modules/").map_or(&**place, |(_, name)| name).to_owned();
        let about = About { licence: text("license"), authors: String::new(), folder: folder.join(place) };
        (Package { name, version: text("version") }, about)
    });
    Ok(described.collect())
}

fn table(title: &str, packages: &Packages) -> String {
    let rows = packages
        .iter()
        .map(|(Package { name, version }, about)| format!("| {name} | {version} | {} |\n", about.licence));
    let rows: String = rows.collect();
    format!("## {title}\n\n| package | version | licence |\n|---|---|---|\n{rows}\n")
}

/// Each distinct text with the packages that it belongs to, in their order.
fn texts<'a>(
    packages: impl Iterator<Item = (&'a Package, &'a About)>,
) -> Result<Vec<(String, Vec<String>)>, String> {
    let mut found: Vec<(String, Vec<String>)> = Vec::new();
    for (package, about) in packages {
        let name = format!("{} {}", package.name, package.version);
        for text in texts_of(package, about)? {
            match found.iter_mut().find(|(known, _)| *known == text) {
                Some((_, packages)) => packages.push(name.clone()),
                None => found.push((text, vec![name.clone()])),
            }
        }
    }
    Ok(found)
}

/// The texts that must go with a package: those of its licence if it is not used under Apache 2.0, and its
/// notices.
fn texts_of(package: &Package, about: &About) -> Result<Vec<String>, String> {
    let name = &package.name;
    let offers_apache = about.licence.contains("Apache-2.0") && !about.licence.contains(" AND ");
    let is_text = |file: &str| {
        let file = file.to_uppercase();
        let is_licence = ["LICEN", "COPYING", "UNLICENSE"].iter().any(|begin| file.starts_with(begin));
        file.starts_with("NOTICE") || (is_licence && !offers_apache && !file.contains("APACHE"))
    };
    let entries = fs::read_dir(&about.folder).map_err(|error| {
        format!("{name}: {}: {error}; `cargo fetch` and `npm ci` install it", about.folder.display())
    })?;
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|path| {
        path.is_file() && path.file_name().is_some_and(|file| is_text(&file.to_string_lossy()))
    });
    files.sort();
    let read =
        |path: &PathBuf| fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()));
    let texts = files.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    if !texts.is_empty() || offers_apache {
        return Ok(texts.iter().map(|text| tidied(text)).collect());
    }
    // The package has no text: that of its licence, with its authors.
    let fault = || format!("{name} has no text of its licence {}", about.licence);
    let standard =
        (about.licence == "MIT").then(|| fs::read_to_string(root().join("LICENSE-MIT"))).ok_or_else(fault)?;
    let standard = standard.map_err(|error| format!("LICENSE-MIT: {error}"))?;
    let (_, terms) = standard.split_once("\n\nPermission").ok_or_else(fault)?;
    Ok(vec![tidied(&format!("MIT License\n\nCopyright (c) {}\n\nPermission{terms}", about.authors))])
}

/// A text as a block of Markdown.
fn indented(text: &str) -> String {
    let line = |line: &str| if line.is_empty() { String::new() } else { format!("    {line}") };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// A text without blank ends of lines, so that equal texts are equal.
fn tidied(text: &str) -> String {
    text.trim().lines().map(str::trim_end).collect::<Vec<_>>().join("\n")
}
