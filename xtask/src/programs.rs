//! Test programs, as cargo compiles them: several run at the same time.
//!
//! `cargo test` runs one program after the other. At the end of each, one long test keeps one core busy and leaves
//! the others idle, and some tests wait for a server. Two programs at a time use that time.

use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::thread;

use serde_json::Value;

use crate::shell::{self, Apart};

/// Programs that run at the same time; each has as many threads as the machine has cores.
const AT_A_TIME: usize = 2;

/// The programs that take most time, longest first: they begin first.
const LONGEST: [&str; 5] = ["cli", "display", "transport", "site", "validation"];

/// A compiled test program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Program {
    /// Name of its target.
    name: String,
    executable: PathBuf,
    /// Folder of its package, in which cargo runs it.
    folder: PathBuf,
}

impl Program {
    /// Reads one of cargo's messages; `None` if it is not about a test program.
    fn read(line: &str) -> Option<Self> {
        let message: Value = serde_json::from_str(line).ok()?;
        let is_test = message["profile"]["test"].as_bool()?;
        let path = |key: &str| message[key].as_str().map(PathBuf::from);
        let (executable, manifest) = (path("executable")?, path("manifest_path")?);
        let name = message["target"]["name"].as_str()?.to_owned();
        is_test.then_some(Self { name, executable, folder: manifest.parent()?.to_owned() })
    }

    fn run(&self) -> Apart {
        let mut command = Command::new(&self.executable);
        command.current_dir(&self.folder).env("CARGO_MANIFEST_DIR", &self.folder).arg("--quiet");
        shell::run_named(command, format!("tests of {}", self.name))
    }

    /// Its place in the order of beginning.
    fn rank(&self) -> usize {
        LONGEST.iter().position(|name| *name == self.name).unwrap_or(LONGEST.len())
    }
}

/// The programs of `cargo test ARGUMENTS --no-run`, which has compiled them: cargo lists them. Those that take longest are first.
pub(crate) fn compiled(mut test: Command) -> Result<Vec<Program>, String> {
    test.args(["--no-run", "--message-format=json"]);
    let output = test.stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.map_err(|error| format!("cargo test --no-run: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    let mut programs: Vec<Program> = text.lines().filter_map(Program::read).collect();
    programs.sort_by_key(Program::rank);
    match programs.is_empty() || !output.status.success() {
        true => Err("cargo test --no-run: tests do not compile".to_owned()),
        false => Ok(programs),
    }
}

/// Runs programs, several at a time; `ended` receives what each wrote.
pub(crate) fn run_all(programs: Vec<Program>, ended: &mut (dyn FnMut(Apart) + Send)) {
    let (waiting, ended) = (Mutex::new(programs.into_iter()), Mutex::new(ended));
    let next = || waiting.lock().ok().and_then(|mut programs| programs.next());
    thread::scope(|scope| {
        for _ in 0..AT_A_TIME {
            scope.spawn(|| {
                while let Some(program) = next() {
                    let run = program.run();
                    if let Ok(mut ended) = ended.lock() {
                        ended(run);
                    }
                }
            });
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn test_programs_are_those_with_a_test_profile() {
        let line = |test: bool, executable: &str| {
            format!(
                r#"{{"reason":"compiler-artifact","manifest_path":"a/Cargo.toml","target":{{"name":"cli"}},"profile":{{"test":{test}}},"executable":{executable}}}"#
            )
        };
        let program = Program::read(&line(true, r#""b/cli-1""#)).unwrap();
        assert_eq!(program.rank(), 0);
        assert_eq!((program.name.as_str(), program.folder), ("cli", PathBuf::from("a")));
        assert_eq!(Program::read(&line(false, r#""b/papilio""#)), None);
        assert_eq!(Program::read(&line(true, "null")), None);
        assert_eq!(Program::read(r#"{"reason":"build-finished","success":true}"#), None);
    }
}
