//! `cargo xtask bench-pairs OLD NEW`: processor time of two programs, in turn.
//!
//! Each case is a scenario with changes, run on one thread by both programs, one after the other, several
//! times. The fastest times are compared: other programs on the machine make some runs slower, none faster.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::shell::{self, Outcome};

/// A case: its name, the command and its options after the files, the scenario and further files of `scenarios/`, and
/// the changes of its keys.
struct Case {
    name: &'static str,
    command: &'static [&'static str],
    scenario: &'static str,
    files: &'static [&'static str],
    changes: &'static [&'static str],
}

const RUN: &[&str] = &["run", "--quiet"];
const CONE: &[&str] = &["run", "--cone", "--quiet"];

const CASES: [Case; 20] = [
    Case {
        name: "haze 0.2 under a front of 0.02, one view",
        command: RUN,
        scenario: "indoor",
        files: &[],
        changes: &["display.diffuser.haze=0.2", "display.front.0.reflectance=0.02"],
    },
    Case {
        name: "the same, 25 views",
        command: RUN,
        scenario: "indoor",
        files: &[],
        changes: &[
            "display.diffuser.haze=0.2",
            "display.front.0.reflectance=0.02",
            "viewer.theta_deg=[0,2,4,6,8,10,12,14,16,18,20,22,24,26,28,30,32,34,36,38,40,42,44,46,48]",
        ],
    },
    Case { name: "measured film H65", command: RUN, scenario: "measured-h65", files: &[], changes: &[] },
    Case { name: "cover glass", command: RUN, scenario: "cover-glass", files: &[], changes: &[] },
    Case {
        name: "rough glass, alpha 0.02",
        command: RUN,
        scenario: "rough-glass",
        files: &[],
        changes: &["display.layers.0.alpha=0.02"],
    },
    Case {
        name: "rough glass, alpha 0.1",
        command: RUN,
        scenario: "rough-glass",
        files: &[],
        changes: &["display.layers.0.alpha=0.1"],
    },
    Case { name: "cone under a sky", command: CONE, scenario: "sky", files: &[], changes: &[] },
    Case { name: "cone under a map", command: CONE, scenario: "map", files: &[], changes: &[] },
    Case {
        name: "Monte Carlo, paper under rough glass",
        command: RUN,
        scenario: "rough-glass",
        files: &[],
        changes: &[
            "solver.method=monte-carlo",
            "display.layers.0.alpha=0.1",
            "lighting.diffuse=1",
            "lighting.directed.0.share=0",
        ],
    },
    Case {
        name: "Monte Carlo, slab of optical thickness 2",
        command: RUN,
        scenario: "slab",
        files: &[],
        changes: &["solver.method=monte-carlo", "display.diffuser.optical_thickness=2"],
    },
    Case {
        name: "2048 designs (tolerance analysis of indoor.toml)",
        command: &["tolerance", "--quiet"],
        scenario: "indoor",
        files: &[],
        changes: &[
            "tolerance={ samples = 2048, keys = [{ key = \"display.pixel.film.1.thickness_nm\", normal = { sigma = 0.3 } }, \
             { key = \"display.pixel.gap_nm.red\", normal = { sigma = 3 } }], limits = [{ metric = \"white.Y\", at_least = 0.5 }] }",
        ],
    },
    Case { name: "cholesteric paper", command: RUN, scenario: "cholesteric", files: &[], changes: &[] },
    Case {
        name: "mtf of sub-pixels",
        command: &["mtf", "--quiet"],
        scenario: "matrix",
        files: &[],
        changes: &[],
    },
    Case {
        name: "mtf of two diffusers, by paths",
        command: &["mtf", "--quiet", "--solver", "monte-carlo"],
        scenario: "laminated-text",
        files: &[],
        changes: &["spectrum.step_nm=20"],
    },
    Case {
        name: "crosstalk",
        command: &["crosstalk", "--quiet"],
        scenario: "matrix",
        files: &[],
        changes: &[],
    },
    Case {
        name: "a photograph on six inks",
        command: &["image", "--quiet"],
        scenario: "six-ink",
        files: &["data/photographs/coffee.jpg"],
        changes: &[],
    },
    Case {
        name: "sparkle",
        command: &["sparkle", "--quiet"],
        scenario: "antiglare",
        files: &[],
        changes: &[],
    },
    Case { name: "sweep", command: &["sweep", "--quiet"], scenario: "sweep", files: &[], changes: &[] },
    Case {
        name: "search by gradients",
        command: &["optimize", "--quiet", "--no-check"],
        scenario: "optimize",
        files: &[],
        changes: &[],
    },
    Case {
        name: "fit of a film",
        command: &["fit", "--quiet"],
        scenario: "fit",
        files: &["data/synthetic-film.csv"],
        changes: &[],
    },
];

/// Number of times that each case is run by each program ...
const ROUNDS: usize = 3;
/// ... unless it takes longer than this, s: then once.
const LONG: f64 = 10.0;

/// Runs the task with the paths of two programs.
pub(crate) fn pairs(programs: &[String]) -> Outcome {
    let [old, new] = programs else {
        return Err("two programs are needed: cargo xtask bench-pairs OLD NEW".to_owned());
    };
    println!("| case | old, CPU s | new, CPU s | ratio |\n|---|---|---|---|");
    for case in &CASES {
        let mut fastest = [f64::INFINITY; 2];
        let mut problem = None;
        for round in 0..ROUNDS {
            if round > 0 && fastest[0] > LONG {
                break;
            }
            for (fastest, program) in fastest.iter_mut().zip([old, new]) {
                match seconds(program, case) {
                    Ok(seconds) => *fastest = fastest.min(seconds),
                    Err(reason) => problem = Some(reason),
                }
            }
        }
        let [old, new] = fastest;
        match problem {
            None => println!("| {} | {old:.3} | {new:.3} | {:.2} |", case.name, old / new),
            Some(reason) => println!("| {} | {reason} | | |", case.name),
        }
    }
    Ok(())
}

/// Runs a case and returns the processor time of the program, which the shell measures.
fn seconds(program: &str, case: &Case) -> Result<f64, String> {
    let out = shell::target().join("bench-pairs");
    let mut command = Command::new("bash");
    command.current_dir(shell::root()).args(["-c", "TIMEFORMAT='%U %S'; time \"$@\" >/dev/null 2>\"$0\""]);
    let errors = out.with_extension("txt");
    command.arg(&errors).arg(Path::new(program)).args(case.command.iter().take(1));
    command.arg(format!("scenarios/{}.toml", case.scenario));
    command.args(case.files.iter().map(|file| format!("scenarios/{file}")));
    command.args(&case.command[1..]).args(["--threads", "1", "--out"]).arg(&out);
    case.changes.iter().for_each(|change| {
        command.args(["--set", change]);
    });
    // A journal of an earlier run would be continued.
    let _absent = std::fs::remove_dir_all(&out);
    let output = command.stdin(Stdio::null()).output().map_err(|error| format!("bash: {error}"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let times: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match (output.status.success(), &times[..]) {
        (true, [user, system]) => Ok(user + system),
        _ => Err(std::fs::read_to_string(&errors)
            .unwrap_or_default()
            .lines()
            .next()
            .unwrap_or("failed")
            .to_owned()),
    }
}
