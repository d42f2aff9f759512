//! A run of the program, watched: how it ends, its memory and its time.

use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use papilio_testing::sized;

/// Memory that the program may take, bytes.
const MOST_MEMORY: u64 = 1_000_000_000;

/// Address space of the program, kB: an allocation beyond it fails, and the machine is never short of memory.
const MOST_SPACE_KB: u64 = 4_000_000;

/// Time of a processor within which the program ends or shows progress, on each of [`THREADS`] threads, s:
/// time on the clock depends on what else the machine does. It has its first line of progress after 20 s on
/// the clock, or after [`PROGRESS_SECONDS`].
const MOST_SECONDS: f64 = 20.0;
const THREADS: u32 = 2;

/// Every day, the first line of progress comes after this time, s: long cases end sooner.
const PROGRESS_SECONDS: (&str, &str) = ("PAPILIO_PROGRESS_SECONDS", "2");

/// The program, or another one: `PAPILIO_TESTED_PROGRAM`, such as a released one.
pub(crate) fn papilio() -> String {
    std::env::var("PAPILIO_TESTED_PROGRAM").unwrap_or_else(|_| env!("CARGO_BIN_EXE_papilio").to_owned())
}

/// Commands without threads.
const WITHOUT_THREADS: [&str; 2] = ["pixel", "study"];

/// How a run of the program ended, or why it was ended.
#[derive(Debug, PartialEq)]
pub(super) enum End {
    /// With this exit code.
    Ended(i32),
    Progress,
    Wrong(String),
}

/// A program that waits for nothing, and so uses no time of a processor, ends after this: far beyond any
/// other bound.
const LONGEST_WAIT: Duration = Duration::from_secs(900);

/// How long a run is watched that shows progress, s of a processor on each thread.
const MOST_SECONDS_IN_ALL: f64 = 60.0;

/// Runs the program until it ends, shows progress, or takes too much. Memory is also watched further on, if
/// asked.
pub(super) fn watch(arguments: &[&str], folder: &Path, is_whole: bool) -> End {
    let [out, errors] = ["stdout", "stderr"].map(|name| folder.join(name));
    let into = |path: &Path| Stdio::from(fs::File::create(path).unwrap());
    // The shell limits the address space, and becomes the program.
    let mut program = Command::new("sh");
    program.args(["-c", &format!("ulimit -v {MOST_SPACE_KB}; exec \"$0\" \"$@\""), &papilio()]);
    program.args(arguments).env("NO_COLOR", "1");
    if !arguments.iter().any(|argument| WITHOUT_THREADS.contains(argument) || *argument == "--threads") {
        program.args(["--threads", &THREADS.to_string()]);
    }
    if sized(std::env::var_os(PROGRESS_SECONDS.0).is_none(), false) {
        program.env(PROGRESS_SECONDS.0, PROGRESS_SECONDS.1);
    }
    let mut child = program
        .arg("--out")
        .arg(folder.join("results"))
        .stdout(into(&out))
        .stderr(into(&errors))
        .spawn()
        .unwrap();
    let begin = Instant::now();
    let end = loop {
        std::thread::sleep(Duration::from_millis(10));
        let status = child.try_wait().unwrap();
        if begin.elapsed() > LONGEST_WAIT {
            break End::Wrong(format!("it neither ended nor used its time in {} s", LONGEST_WAIT.as_secs()));
        }
        let said = fs::read_to_string(&errors).unwrap_or_default();
        if let Some(status) = status {
            break match status.code() {
                _ if said.contains("panicked") => End::Wrong(format!("a panic: {said}")),
                _ if has_long_number(&(said.clone() + &fs::read_to_string(&out).unwrap_or_default())) => {
                    End::Wrong(format!("a number of hundreds of digits: {said}"))
                }
                Some(code @ (0 | 2 | 3)) => End::Ended(code),
                code => End::Wrong(format!("ended with {code:?}: {said}")),
            };
        }
        match usage(&child) {
            Some((memory, _)) if memory > MOST_MEMORY => break End::Wrong(format!("took {memory} bytes")),
            Some((_, seconds)) if seconds > MOST_SECONDS_IN_ALL * f64::from(THREADS) => break End::Progress,
            Some((_, seconds))
                if seconds > 1.2 * MOST_SECONDS * f64::from(THREADS) && !has_progress(&said) =>
            {
                break End::Wrong(format!("no sign of progress after {seconds:.0} s of a processor"));
            }
            _ => {}
        }
        if has_progress(&said) && !is_whole {
            break End::Progress;
        }
    };
    let _ = child.kill();
    let _ = child.wait();
    end
}

/// Returns whether a text has a number of more than 40 digits, which should have an exponent.
pub(super) fn has_long_number(text: &str) -> bool {
    text.split(|c: char| !c.is_ascii_digit() && c != '.').any(|word| word.len() > 40)
}

fn has_progress(said: &str) -> bool {
    said.lines().any(|line| line.starts_with(|first: char| first.is_ascii_digit()))
}

/// Largest memory so far, bytes, and time of processors, s.
fn usage(child: &Child) -> Option<(u64, f64)> {
    let read = |name: &str| {
        let mut text = String::new();
        fs::File::open(format!("/proc/{}/{name}", child.id())).ok()?.read_to_string(&mut text).ok()?;
        Some(text)
    };
    let status = read("status")?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    let kib: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    let stat = read("stat")?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: f64 = [11, 12].iter().filter_map(|at| fields.get(*at)?.parse::<f64>().ok()).sum();
    Some((1024 * kib, 0.01 * ticks))
}
