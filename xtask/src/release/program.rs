//! The archive of the program.
//!
//! On Linux the program is static, so that it runs on every distribution and in an empty container: with
//! musl, if rustup has installed that target; otherwise with the C library of this machine (`crt-static`).

use std::fs;
use std::path::{Path, PathBuf};

use super::sandbox::tar;
use super::{check, copy, folder, replace, version};
use crate::page;
use crate::shell::{self, Outcome, cargo, command};

/// What the archive contains besides the program, its manual pages and completions.
const FILES: [&str; 8] = [
    "README.md",
    "CHANGELOG.md",
    "LICENSE-APACHE",
    "LICENSE-MIT",
    "release/THIRD-PARTY.md",
    "release/Containerfile",
    "scenarios",
    "surfaces",
];

/// Names of the completion scripts, as the shells look for them.
const COMPLETIONS: [(&str, &str); 5] = [
    ("bash", "papilio.bash"),
    ("zsh", "_papilio"),
    ("fish", "papilio.fish"),
    ("powershell", "_papilio.ps1"),
    ("elvish", "papilio.elv"),
];

/// Builds the program for a system, makes the archive, and checks it.
pub(super) fn make(target: Option<&str>) -> Outcome {
    page::build()?;
    let host = host()?;
    let target = match target {
        Some(target) => target.to_owned(),
        None => musl(&host).unwrap_or_else(|| host.clone()),
    };
    let program = build(&target, &host)?;
    let name = format!("papilio-{}-{target}", version());
    let staged = shell::target().join("staged").join(&name);
    stage(&program, &staged)?;
    let archive = archive(&staged, &name, target.contains("windows"))?;
    check::archive(&archive, &name)
}

/// The triple of this machine.
pub(super) fn host() -> Result<String, String> {
    let host = shell::run_apart(command("rustc", ["--print", "host-tuple"]));
    host.outcome.map(|()| host.texts[0].trim().to_owned())
}

/// The system with the same processor and musl, if its library is installed.
fn musl(host: &str) -> Option<String> {
    let musl = host.strip_suffix("-linux-gnu").map(|start| format!("{start}-linux-musl"))?;
    let library = shell::run_apart(command("rustc", ["--print", "target-libdir", "--target", &musl]));
    if Path::new(library.texts[0].trim()).is_dir() {
        return Some(musl);
    }
    println!(
        "The library of {musl} is not installed: the program is linked statically with the C library of this machine."
    );
    None
}

fn build(target: &str, host: &str) -> Result<PathBuf, String> {
    let mut build =
        cargo(["rustc", "--profile", "dist", "--package", "papilio", "--all-features", "--bin", "papilio"]);
    let mut out = shell::target();
    if target != host {
        build.args(["--target", target]);
        out.push(target);
    }
    // Only for the program itself: the libraries are the same. musl is always static, macOS never.
    if target.ends_with("-linux-gnu") || target.contains("windows") {
        build.args(["--", "-C", "target-feature=+crt-static"]);
    }
    shell::run(build)?;
    let name = if target.contains("windows") { "papilio.exe" } else { "papilio" };
    Ok(out.join("dist").join(name))
}

/// Puts all files of the archive into a folder.
fn stage(program: &Path, staged: &Path) -> Outcome {
    let failure = |error: std::io::Error| format!("{}: {error}", staged.display());
    if staged.exists() {
        fs::remove_dir_all(staged).map_err(failure)?;
    }
    let completions = staged.join("completions");
    fs::create_dir_all(&completions).map_err(failure)?;
    for name in FILES {
        let file = shell::root().join(name);
        copy(&file, &staged.join(Path::new(name).file_name().unwrap_or_default()))?;
    }
    // Its links start from `release/` in the repository, and from the root here.
    let licences = staged.join("THIRD-PARTY.md");
    let text = fs::read_to_string(&licences).map_err(failure)?;
    fs::write(&licences, text.replace("](../", "](")).map_err(failure)?;
    // Of the package with the examples, not of the examples.
    for name in ["lib.rs", "README.md"] {
        fs::remove_file(staged.join("scenarios").join(name)).map_err(failure)?;
    }
    copy(program, &staged.join(program.file_name().unwrap_or_default()))?;
    let mut man = command(program, ["man", "--out"]);
    man.arg(staged.join("man"));
    shell::run(man)?;
    for (shell, name) in COMPLETIONS {
        let script = shell::run_apart(command(program, ["completions", shell]));
        script.outcome?;
        fs::write(completions.join(name), &script.texts[0]).map_err(failure)?;
    }
    Ok(())
}

fn archive(staged: &Path, name: &str, zip: bool) -> Result<PathBuf, String> {
    let path = folder().join(format!("{name}.{}", if zip { "zip" } else { "tar.gz" }));
    replace(|file| file == path.file_name().unwrap_or_default().to_string_lossy())?;
    // The tar of Windows is that of BSD, which writes zip files too.
    let mut tar = command(tar(), [if zip { "-acf" } else { "-czf" }]);
    tar.arg(&path).arg("-C").arg(staged.parent().unwrap_or(staged)).arg(name);
    shell::run(tar)?;
    Ok(path)
}
