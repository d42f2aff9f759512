//! `cargo xtask release`: the packages that this machine can make, in target/packages, each installed without
//! Rust and run.
//!
//! | part | packages |
//! |---|---|
//! | `program` | an archive with the program, its page inside, manual pages, completions and the example scenarios |
//! | `wheel` | the Python package, compiled |
//! | `sdist` | the Python package as source |
//! | `crates` | the crates, as for the registry, in the order of their dependencies |
//! | `sums` | `SHA256SUMS` of all packages in the folder |
//!
//! Without a part, all of them are made. `--target TRIPLE` selects the system of program and wheel.

mod check;
mod crates;
mod program;
mod sandbox;
mod wheel;

use std::fs;
use std::path::{Path, PathBuf};

use crate::shell::{self, Outcome, command};

/// Arguments of the task.
struct Order {
    parts: Vec<Part>,
    /// The system for which program and wheel are built; `None`: this machine.
    target: Option<String>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    Program,
    Wheel,
    Sdist,
    Crates,
    Sums,
}

/// Names of the parts, in the order in which they are made.
const PARTS: [(&str, Part); 5] = [
    ("program", Part::Program),
    ("wheel", Part::Wheel),
    ("sdist", Part::Sdist),
    ("crates", Part::Crates),
    ("sums", Part::Sums),
];

/// Runs the task.
pub(crate) fn release(arguments: &[String]) -> Outcome {
    let Order { parts, target } = Order::read(arguments)?;
    fs::create_dir_all(folder()).map_err(|error| format!("{}: {error}", folder().display()))?;
    for part in parts {
        match part {
            Part::Program => program::make(target.as_deref())?,
            Part::Wheel => wheel::make(target.as_deref())?,
            Part::Sdist => wheel::make_source()?,
            Part::Crates => crates::make()?,
            Part::Sums => sums()?,
        }
    }
    print_sizes()
}

impl Order {
    fn read(arguments: &[String]) -> Result<Self, String> {
        let mut order = Self { parts: Vec::new(), target: None };
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            if argument == "--target" {
                order.target = Some(rest.next().ok_or("--target needs the triple of a system")?.clone());
                continue;
            }
            let known = PARTS.iter().find(|(name, _)| name == argument);
            let (_, part) = known.ok_or_else(|| {
                let names = PARTS.map(|(name, _)| name).join(", ");
                format!("unknown part `{argument}` of a release; expected {names}, or --target TRIPLE")
            })?;
            order.parts.push(*part);
        }
        if order.parts.is_empty() {
            order.parts = PARTS.map(|(_, part)| part).to_vec();
        }
        Ok(order)
    }
}

/// The folder of the packages.
fn folder() -> PathBuf {
    shell::target().join("packages")
}

/// The version of all crates: that of this one.
fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// Removes the packages that a test selects, and creates them again by `make`; what an earlier call has left
/// is not mistaken for it.
fn replace(is_old: impl Fn(&str) -> bool) -> Outcome {
    files()?.iter().filter(|(name, _)| is_old(name)).try_for_each(|(_, path)| {
        fs::remove_file(path).map_err(|error| format!("{}: {error}", path.display()))
    })
}

/// Names and paths of the files in the folder, in order.
fn files() -> Result<Vec<(String, PathBuf)>, String> {
    let entries = fs::read_dir(folder()).map_err(|error| format!("{}: {error}", folder().display()))?;
    let paths = entries.flatten().map(|entry| entry.path()).filter(|path| path.is_file());
    let mut found: Vec<_> =
        paths.filter_map(|path| Some((path.file_name()?.to_string_lossy().into_owned(), path))).collect();
    found.sort();
    Ok(found)
}

/// The only file that a test selects.
fn only(is_it: impl Fn(&str) -> bool, what: &str) -> Result<PathBuf, String> {
    let mut found = files()?.into_iter().filter(|(name, _)| is_it(name));
    match (found.next(), found.next()) {
        (Some((_, path)), None) => Ok(path),
        (None, _) => Err(format!("{what} was not made")),
        (Some(_), Some(_)) => Err(format!("{}: more than one {what}", folder().display())),
    }
}

/// Writes the checksums of all packages.
fn sums() -> Outcome {
    const SUMS: &str = "SHA256SUMS";
    let names: Vec<String> = files()?.into_iter().map(|(name, _)| name).filter(|name| name != SUMS).collect();
    let [program, option]: [&str; 2] =
        if cfg!(target_os = "macos") { ["shasum", "--algorithm=256"] } else { ["sha256sum", "--binary"] };
    let mut sums = command(program, [option]);
    sums.args(&names).current_dir(folder());
    let done = shell::run_apart(sums);
    done.outcome?;
    fs::write(folder().join(SUMS), &done.texts[0]).map_err(|error| format!("{SUMS}: {error}"))
}

fn print_sizes() -> Outcome {
    println!("\n{}", folder().display());
    for (name, path) in files()? {
        let bytes = fs::metadata(&path).map_err(|error| format!("{name}: {error}"))?.len();
        println!("{:>9.2} MB  {name}", bytes as f64 / 1e6);
    }
    Ok(())
}

/// Copies a file or a folder with all that is in it.
fn copy(from: &Path, to: &Path) -> Outcome {
    let failure = |error: std::io::Error| format!("{}: {error}", from.display());
    if !from.is_dir() {
        return fs::copy(from, to).map(|_| ()).map_err(failure);
    }
    fs::create_dir_all(to).map_err(failure)?;
    for entry in fs::read_dir(from).map_err(failure)? {
        let entry = entry.map_err(failure)?;
        copy(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(words: &str) -> Result<Order, String> {
        Order::read(&words.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn parts_are_made_as_asked_and_all_of_them_by_default() {
        let all = read("").unwrap();
        assert!(all.parts == PARTS.map(|(_, part)| part) && all.target.is_none());
        let some = read("wheel program --target x86_64-apple-darwin").unwrap();
        assert!(some.parts == [Part::Wheel, Part::Program]);
        assert_eq!(some.target.as_deref(), Some("x86_64-apple-darwin"));
    }

    #[test]
    fn unknown_part_or_missing_system_is_refused_with_the_known_ones() {
        let error = |words| read(words).err().unwrap();
        assert!(error("wheels").contains("`wheels`") && error("wheels").contains("program, wheel, sdist"));
        assert!(error("program --target").contains("triple"));
    }
}
