//! Commands that are killed (SIGKILL) at random moments and started again: in the end the files have the same bytes as
//! without a kill, and no temporary file is left.
//!
//! Moments are uniform over the time that the command takes. `PAPILIO_KILLS=1000` sets their number over all commands.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use papilio_testing::{Dice, sized};

use super::extremes::{papilio, picture_in};
use crate::common::files;

/// Kills in every day's test, and in the full one.
const KILLS: [usize; 2] = [2, 1000];

/// A command that may be killed.
struct Killed {
    /// The command with its file and options; `{picture}` is a picture.
    command: &'static str,
    /// Changes of keys that make it fast.
    sets: &'static [&'static str],
    /// Whether it is resumed; others begin again.
    is_resumed: bool,
}

const SCENARIOS: &str = "../scenarios";

const COMMANDS: [Killed; 11] = [
    Killed { command: "sweep {s}/sweep.toml", sets: &["spectrum.step_nm=20"], is_resumed: true },
    Killed {
        command: "brdf {s}/rough-glass.toml --step 15",
        sets: &["spectrum.step_nm=50"],
        is_resumed: true,
    },
    Killed { command: "run {s}/rough-glass.toml --cone", sets: &["spectrum.step_nm=50"], is_resumed: true },
    Killed {
        command: "fit {s}/fit.toml {s}/data/synthetic-film.csv",
        sets: &["fit.starts=4"],
        is_resumed: true,
    },
    Killed {
        command: "gonio {s}/../surfaces/etched.toml",
        sets: &["microgeometry.rays=256"],
        is_resumed: true,
    },
    Killed {
        command: "optimize {s}/optimize.toml",
        sets: &["spectrum.step_nm=20", "optimize.evaluations=300"],
        is_resumed: true,
    },
    Killed {
        command: "tolerance {s}/tolerance.toml",
        sets: &["spectrum.step_nm=20", "tolerance.samples=128"],
        is_resumed: true,
    },
    Killed { command: "brdf {s}/epaper.toml --step 10", sets: &["spectrum.step_nm=50"], is_resumed: true },
    Killed {
        command: "brdf {s}/epaper.toml --format rgl --grid 32",
        sets: &["spectrum.step_nm=50"],
        is_resumed: true,
    },
    Killed { command: "image {s}/six-ink.toml {picture}", sets: &[], is_resumed: false },
    Killed { command: "palette {s}/six-ink.toml --rooms D65,FL11", sets: &[], is_resumed: false },
];

/// Names and contents of all files; journals have their lines in the order in which they were done.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = files(folder);
    for (name, content) in &mut all {
        if name.ends_with(".jsonl") {
            content.clear();
        }
    }
    all
}

impl Killed {
    fn started(&self, picture: &str, out: &Path) -> Command {
        let mut program = Command::new(papilio());
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(SCENARIOS);
        for word in self.command.split(' ') {
            program.arg(word.replace("{picture}", picture).replace("{s}", folder.to_str().unwrap()));
        }
        self.sets.iter().for_each(|set| _ = program.args(["--set", set]));
        program.args(["--threads", "2", "--out"]).arg(out).stdout(Stdio::null()).stderr(Stdio::null());
        program
    }

    /// Kills the command some times; returns how often it was killed amid its work.
    fn killed(&self, picture: &str, kills: usize, dice: &mut Dice) -> usize {
        let folder = tempfile::tempdir().unwrap();
        // Some files have the name of their folder.
        let whole = folder.path().join("whole").join("out");
        let begin = Instant::now();
        assert!(self.started(picture, &whole).status().unwrap().success(), "{}", self.command);
        let seconds = begin.elapsed().as_secs_f64();
        let expected = contents(&whole);
        let (mut done, mut amid, mut round) = (0, 0, 0);
        while done < kills {
            let out = folder.path().join(format!("{round}")).join("out");
            round += 1;
            let mut left = 1.05 * seconds;
            for _ in 0..1 + dice.below(6) {
                let mut child = self.started(picture, &out).spawn().unwrap();
                let moment = dice.between(0.0, left);
                std::thread::sleep(Duration::from_secs_f64(moment));
                let is_over = child.try_wait().unwrap().is_some();
                // Equivalent to kill -9.
                let _ = child.kill();
                let _ = child.wait();
                done += 1;
                amid += usize::from(!is_over);
                if self.is_resumed {
                    left = (left - moment).max(0.1 * seconds);
                }
            }
            let status = self.started(picture, &out).status().unwrap();
            assert!(status.success(), "{}: {status}", self.command);
            let found = contents(&out);
            let temporary: Vec<_> = found.keys().filter(|name| name.ends_with(".tmp")).collect();
            assert!(temporary.is_empty(), "{}: {temporary:?}", self.command);
            let names = |of: &BTreeMap<String, Vec<u8>>| of.keys().cloned().collect::<Vec<_>>();
            assert_eq!(names(&found), names(&expected), "{}", self.command);
            let other: Vec<_> = found.keys().filter(|name| found[*name] != expected[*name]).collect();
            assert!(other.is_empty(), "{}: {other:?} differ", self.command);
            fs::remove_dir_all(out).unwrap();
        }
        println!("{}: {done} kills, {amid} amid its work, of {seconds:.2} s", self.command);
        amid
    }
}

#[test]
fn killed_commands_end_in_the_same_bytes() {
    let kills = std::env::var("PAPILIO_KILLS").ok().and_then(|text| text.parse().ok());
    let kills: usize = kills.unwrap_or(sized(KILLS[0], KILLS[1]));
    let folder = tempfile::tempdir().unwrap();
    let picture = picture_in(folder.path());
    let mut dice = Dice::new(0x6b69_6c6c, 0);
    let commands = &COMMANDS[..kills.min(COMMANDS.len())];
    let each = kills.div_ceil(commands.len());
    let amid: usize = commands.iter().map(|command| command.killed(&picture, each, &mut dice)).sum();
    assert!(2 * amid > kills || kills < 100, "{amid} of {kills} amid the work");
}
