//! Running other programs.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};

use crate::page;

/// Result of a task; the error is one line.
pub(crate) type Outcome = Result<(), String>;

/// A tool, and the command that installs it.
pub(crate) struct Needs {
    pub(crate) tool: &'static [&'static str],
    pub(crate) install: &'static str,
}

/// Root folder of the repository.
pub(crate) fn root() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here)
}

/// Target folder, for builds and for files of the tasks.
pub(crate) fn target() -> PathBuf {
    let set = std::env::var_os("CARGO_TARGET_DIR");
    root().join(set.map_or_else(|| "target".into(), PathBuf::from))
}

/// Path of the program of the release profile.
pub(crate) fn papilio() -> PathBuf {
    program_in("release")
}

/// Path of the program of the development profile, which cargo builds with the tests.
pub(crate) fn papilio_for_tests() -> PathBuf {
    program_in("debug")
}

fn program_in(folder: &str) -> PathBuf {
    target().join(folder).join("papilio").with_extension(std::env::consts::EXE_EXTENSION)
}

/// A command that runs a program in the root folder of the repository.
pub(crate) fn command(
    program: impl AsRef<Path>,
    arguments: impl IntoIterator<Item = impl AsRef<str>>,
) -> Command {
    let mut command = Command::new(program.as_ref());
    command.current_dir(root());
    arguments.into_iter().for_each(|argument| {
        command.arg(argument.as_ref());
    });
    command
}

/// A command that runs cargo (the one that runs this task). Cargo includes the latest page of the web app in
/// the program, and compiles it again if the page has changed.
pub(crate) fn cargo(arguments: impl IntoIterator<Item = impl AsRef<str>>) -> Command {
    let cargo = std::env::var_os("CARGO").map_or_else(|| "cargo".into(), PathBuf::from);
    let mut cargo = command(cargo, arguments);
    if let Some(hash) = page::hash() {
        cargo.env("PAPILIO_PAGE", hash);
    }
    cargo
}

/// Fails if a tool does not print its version. The error contains the command that installs it.
pub(crate) fn need(needs: Needs) -> Outcome {
    let (program, arguments) = needs.tool.split_first().ok_or("no tool named")?;
    let mut version = command(program, arguments);
    let output = version.arg("--version").stdin(Stdio::null()).output();
    if output.is_ok_and(|output| output.status.success()) {
        Ok(())
    } else {
        Err(format!("{} is missing: {}", needs.tool.join(" "), needs.install))
    }
}

/// Prints a command, and runs it.
pub(crate) fn run(command: Command) -> Outcome {
    run_and_read(command, None)
}

/// Prints a command and runs it; `read` receives each line of its standard output, which is also printed.
pub(crate) fn run_and_read(mut command: Command, read: Option<&mut dyn FnMut(&str)>) -> Outcome {
    let shown = shown(&command);
    println!("\n> {shown}");
    command.stdin(Stdio::null());
    let failure = |error: std::io::Error| format!("{shown}: {error}");
    if read.is_some() {
        command.stdout(Stdio::piped());
    }
    let mut child = command.spawn().map_err(failure)?;
    if let (Some(read), Some(out)) = (read, child.stdout.take()) {
        for line in BufReader::new(out).lines() {
            let line = line.map_err(failure)?;
            println!("{line}");
            read(&line);
        }
    }
    ended(&shown, child.wait().map_err(failure)?)
}

/// Result of a command that ran in parallel with others.
pub(crate) struct Apart {
    /// What it wrote to its standard output and its standard error.
    pub(crate) texts: [String; 2],
    /// Its exit status.
    pub(crate) outcome: Outcome,
    shown: String,
}

impl Apart {
    /// Shows the command and what it wrote.
    pub(crate) fn show(&self) {
        println!("\n> {}", self.shown);
        print!("{}", self.texts[0]);
        eprint!("{}", self.texts[1]);
    }
}

/// Runs a command and keeps what it writes, for later.
pub(crate) fn run_apart(command: Command) -> Apart {
    let shown = shown(&command);
    run_named(command, shown)
}

/// The same, with a name that is shown instead of the command.
pub(crate) fn run_named(mut command: Command, shown: String) -> Apart {
    match command.stdin(Stdio::null()).output() {
        Ok(output) => Apart {
            texts: [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()),
            outcome: ended(&shown, output.status),
            shown,
        },
        Err(error) => Apart { texts: Default::default(), outcome: Err(format!("{shown}: {error}")), shown },
    }
}

fn ended(shown: &str, status: ExitStatus) -> Outcome {
    if status.success() { Ok(()) } else { Err(format!("{shown}: {status}")) }
}

/// A command as text for the terminal.
fn shown(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_stem().unwrap_or_default();
    let words = std::iter::once(program).chain(command.get_args());
    words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
}

/// Variables with which cargo takes the crates that `cargo clippy -- FLAGS` has checked for checked, where a
/// command needs them: without them, `cargo doc` checks all of them again.
///
/// They are those that `cargo clippy` sets itself. If another version sets others, the crates are checked
/// once more.
pub(crate) fn checked_by_clippy(flags: &str) -> Vec<(&'static str, String)> {
    let sysroot = command("rustc", ["--print", "sysroot"]).output().ok();
    let sysroot = sysroot.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    let driver = sysroot.map(|sysroot| Path::new(&sysroot).join("bin").join("clippy-driver"));
    let Some(driver) = driver.map(|driver| driver.with_extension(std::env::consts::EXE_EXTENSION)) else {
        return Vec::new();
    };
    if !driver.is_file() {
        return Vec::new();
    }
    let flags = flags.split(' ').map(|flag| format!("{flag}__CLIPPY_HACKERY__")).collect();
    vec![("CLIPPY_ARGS", flags), ("RUSTC_WORKSPACE_WRAPPER", driver.to_string_lossy().into_owned())]
}
