//! Places where nothing can be written, for every command that writes: exit code 2 where another place would do, and 1 where the
//! system fails, as with a full disk.
//!
//! A process whose files may have no bytes stands for a full disk: the system refuses to write, wherever that is. A file in the place of a
//! folder stands for a folder without permission, which the superuser has.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use papilio_testing::sized;

use crate::common::{papilio_command as papilio, scenario, stderr};

/// What a command takes until it writes.
#[derive(Clone, Copy, PartialEq)]
enum Takes {
    /// Less than a second.
    Little,
    /// Seconds: it is computed in the full test alone.
    Seconds,
    /// Seconds before it refuses a place, too: it writes a file of a name, and no folder.
    SecondsToRefuse,
}
use Takes::{Little, Seconds, SecondsToRefuse};

/// Commands, with `{s}` for the folder of scenarios and `{out}` for that of the results.
const COMMANDS: [(&str, Takes); 31] = [
    ("run {s}/indoor.toml --out {out}", Little),
    ("run {s}/indoor.toml --cone --report --out {out}", Little),
    ("pixel {s}/indoor.toml --out {out}", Little),
    ("brdf {s}/indoor.toml --step 30 --out {out}", Little),
    ("sparkle {s}/antiglare.toml --set sparkle.correlation_um=20 --out {out}", Seconds),
    ("gloss {s}/etched-face.toml --out {out}", Seconds),
    ("mtf {s}/matrix.toml --out {out}", Little),
    ("crosstalk {s}/matrix.toml --out {out}", Seconds),
    ("image {s}/six-ink.toml {s}/data/page.png --set display.matrix.pixels=[60,40] --out {out}", Little),
    ("image {s}/six-ink.toml {pictures} --set display.matrix.pixels=[60,40] --out {out}", Little),
    ("palette {s}/six-ink.toml --out {out}", Little),
    ("gonio {s}/../surfaces/hemispheres.toml --preview --out {out}", Little),
    ("compare {s}/indoor.toml {s}/data/synthetic-panel.csv --out {out}", Little),
    ("new office {out}/x.toml", Little),
    ("materials SiO2 --out {out}", Little),
    ("illuminants FL11 --out {out}", Little),
    ("migrate {s}/indoor.toml --out {out}/x.toml", Little),
    ("diffuser inspect {s}/data/H65.bsdf --out {out}", Seconds),
    ("diffuser convert {s}/data/H65.bsdf {out}/x.npz", Little),
    ("diffuser fit {s}/data/H65.bsdf --model ward --out {out}", Seconds),
    ("diffuser calibrate {s}/data/H65.bsdf {s}/data/H65.bsdf {out}/x.npz", SecondsToRefuse),
    ("diffuser steps {s}/measured-diffused.toml --out {out}", Seconds),
    ("diffuser measure {s}/virtual-instrument.toml {out}/x.bsdf", SecondsToRefuse),
    ("sweep {s}/indoor.toml --axis viewer.theta_deg=0,8 --out {out}", Little),
    ("sweep {s}/indoor.toml --axis viewer.theta_deg=0,8 --metrics contrast_ratio --out {out}", Little),
    (
        "optimize {s}/optimize.toml --set optimize.evaluations=10 --set optimize.starts=1 --no-check --out {out}",
        Little,
    ),
    ("tolerance {s}/tolerance.toml --set tolerance.samples=64 --out {out}", Little),
    ("fit {s}/fit.toml {s}/data/synthetic-film.csv --set fit.starts=1 --out {out}", Seconds),
    ("study sampling {s}/sampling.toml --paths 512 --out {out}", Little),
    ("validate --measured clear-glass --out {out}", Little),
    ("man --out {out}", Little),
];

/// Commands without files.
const WITHOUT_FILES: [&str; 3] = ["completions", "schema", "serve"];

/// The arguments of a command that writes to `out`.
fn arguments(command: &str, pictures: &Path, out: &Path) -> Vec<String> {
    let scenarios = scenario("indoor").parent().unwrap().to_owned();
    let [s, pictures, out] = [&scenarios, pictures, out].map(|path| path.to_str().unwrap());
    let words = command.split(' ');
    words.map(|word| word.replace("{s}", s).replace("{pictures}", pictures).replace("{out}", out)).collect()
}

/// Runs a command that may write no byte to a file.
fn without_space(arguments: &[String]) -> Output {
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' XFSZ; ulimit -f 0; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_papilio")]);
    shell.env("NO_COLOR", "1").args(arguments).output().unwrap()
}

#[test]
fn exit_code_says_whether_another_place_would_do() {
    let folder = tempfile::tempdir().unwrap();
    let [file, pictures] = ["file", "pictures"].map(|name| folder.path().join(name));
    fs::write(&file, "in the way").unwrap();
    fs::create_dir(&pictures).unwrap();
    for name in ["a.png", "b.png"] {
        fs::copy(scenario("data").with_extension("").join("page.png"), pictures.join(name)).unwrap();
    }
    let mut wrong = Vec::new();
    for (number, (command, takes)) in COMMANDS.into_iter().enumerate() {
        let mut check = |place: &str, output: &Output, expected: i32, words: &str| {
            let said = stderr(output);
            if output.status.code() != Some(expected) || !said.contains(words) {
                wrong.push(format!(
                    "{command}\n{place}: {:?}, expected {expected}: {said}",
                    output.status.code()
                ));
            }
        };
        if takes != SecondsToRefuse || sized(0, 1) == 1 {
            let below = papilio().args(arguments(command, &pictures, &file.join("below"))).output().unwrap();
            check("below a file", &below, 2, "below");
        }
        if takes == Little || sized(0, 1) == 1 {
            let out = folder.path().join(format!("out-{number}"));
            fs::create_dir(&out).unwrap();
            let full = without_space(&arguments(command, &pictures, &out));
            check("without space", &full, 1, "larger than the system permits");
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Every command is in the table, or writes no files.
#[test]
fn commands_that_write_are_all_tried() {
    let command = papilio_cli::command();
    let all: BTreeSet<&str> = command.get_subcommands().map(|one| one.get_name()).collect();
    let tried = COMMANDS.iter().filter_map(|(command, _)| command.split(' ').next());
    assert_eq!(all, tried.chain(WITHOUT_FILES).collect());
}

/// A folder in the place of a result, or of a journal, is a mistake of the place.
#[test]
fn folder_in_the_place_of_a_file_exits_with_2() {
    for (command, name) in [
        (COMMANDS[0].0, "result.json"),
        (COMMANDS[0].0, "overview.svg"),
        (COMMANDS[13].0, "x.toml"),
        (COMMANDS[23].0, "sweep.jsonl"),
        (COMMANDS[23].0, "sweep.csv"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join(name).join("within")).unwrap();
        let output = papilio().args(arguments(command, folder.path(), folder.path())).output().unwrap();
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{command}, {name}: {said}");
        assert!(said.contains(name), "{command}, {name}: {said}");
    }
}

/// The first picture of a folder that cannot be written for want of space ends the command: no other one is computed in vain.
#[test]
fn folder_of_pictures_without_space_is_not_computed_to_its_end() {
    let folder = tempfile::tempdir().unwrap();
    let pictures = folder.path().join("pictures");
    fs::create_dir(&pictures).unwrap();
    for name in ["a.png", "b.png"] {
        fs::copy(scenario("data").with_extension("").join("page.png"), pictures.join(name)).unwrap();
    }
    let output = without_space(&arguments(COMMANDS[9].0, &pictures, &folder.path().join("out")));
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert_eq!(said.matches("larger than the system permits").count(), 1, "{said}");
}
