//! Every numeric key and every numeric option of every command at the extremes of numbers and of its range: the
//! program ends or shows progress, soon and in limited memory, and never by a panic.
//!
//! **Keys.** The schema is followed along the tables of the command's files: every number that a table may have,
//! whether the file has it or not, the first elements of lists, and numbers by names. A key of the same
//! table in several files of a command is tried in the first one.
//!
//! **Values.** 0, 1e-300, 1e-6, 1e6, 1e300, both ends of the range, and the nearest numbers below and above them.
//!
//! **Parts.** The full run writes each case that passes into `target/extremes/`, and does not repeat it while the
//! program is the same: an interrupted run is resumed. `PAPILIO_EXTREMES=haze` tries all cases with a word;
//! `PAPILIO_PROGRESS_SECONDS=2` shows progress sooner, so that long cases end sooner.

mod estimates;
mod keys;
mod places;
mod record;
mod refusals;
mod watch;

use std::fs;
use std::path::{Path, PathBuf};

use papilio_scenario::{schema, surface_schema};
use papilio_testing::{Dice, sized};
use serde_json::Value;

use self::keys::Keys;
pub(crate) use self::places::picture_in;
use self::record::Record;
pub(crate) use self::watch::papilio;
use self::watch::{End, watch};

/// Of the runs of every day's test, one in so many: of `run` and `gonio`, and of the other commands.
const EVERYDAY: [u32; 2] = [400, 800];

/// A command, and the files whose keys are tried with it.
struct Tried {
    /// The command and its options, separated by spaces; `{picture}` is a picture.
    command: &'static str,
    files: &'static [&'static str],
    /// Changes that make it fast, unless their key is the one that is tried.
    sets: &'static [&'static str],
    /// Tables of these files that only other commands use.
    not: &'static [&'static str],
}

/// Tables that only single commands use.
const OF_COMMANDS: [&str; 9] =
    ["sweep", "optimize", "tolerance", "fit", "image", "pattern", "sparkle", "measure", "view"];

/// A coarse spectrum that divides the ranges of these files.
const COARSE: [&str; 1] = ["spectrum.step_nm=50"];

/// All commands with keys, but `run` and `gonio`, which are tried on all examples.
const COMMANDS: [Tried; 17] = [
    Tried { command: "pixel", files: &["indoor", "table-pixel", "mip-lcd"], sets: &[], not: &OF_COMMANDS },
    Tried {
        command: "brdf --step 30",
        files: &["epaper", "indoor", "etched-face"],
        sets: &COARSE,
        not: &OF_COMMANDS,
    },
    Tried {
        command: "brdf --format rgl --grid 32",
        files: &["epaper", "indoor"],
        sets: &COARSE,
        not: &OF_COMMANDS,
    },
    Tried { command: "run --cone", files: &["epaper", "indoor"], sets: &COARSE, not: &OF_COMMANDS },
    Tried {
        command: "run --solver monte-carlo",
        files: &["indoor", "rough-glass", "slab"],
        sets: &COARSE,
        not: &OF_COMMANDS,
    },
    Tried {
        command: "sparkle",
        files: &["antiglare"],
        sets: &["sparkle.replicates=4"],
        not: &["sweep", "image"],
    },
    Tried { command: "gloss", files: &["epaper", "etched-face"], sets: &COARSE, not: &OF_COMMANDS },
    Tried {
        command: "mtf",
        files: &["matrix", "halftone", "laminated-text"],
        sets: &COARSE,
        not: &["sweep", "optimize", "image"],
    },
    Tried {
        command: "mtf --solver monte-carlo",
        files: &["matrix"],
        sets: &COARSE,
        not: &["sweep", "optimize", "image"],
    },
    Tried {
        command: "crosstalk",
        files: &["matrix", "printed-filter"],
        sets: &COARSE,
        not: &["sweep", "image"],
    },
    Tried { command: "image {picture}", files: &["six-ink", "page", "reader"], sets: &[], not: &["sweep"] },
    Tried { command: "palette", files: &["six-ink"], sets: &[], not: &["sweep"] },
    Tried { command: "sweep", files: &["sweep", "front-light-sweep"], sets: &[], not: &["image"] },
    Tried {
        command: "optimize",
        files: &["optimize", "optimize-front"],
        sets: &["spectrum.step_nm=20", "optimize.evaluations=40"],
        not: &["image"],
    },
    Tried {
        command: "tolerance",
        files: &["tolerance"],
        sets: &["spectrum.step_nm=20", "tolerance.samples=64"],
        not: &["image"],
    },
    Tried { command: "fit {measured}", files: &["fit"], sets: &["spectrum.step_nm=20"], not: &["image"] },
    Tried { command: "study sampling --paths 2048", files: &["sampling"], sets: &[], not: &OF_COMMANDS },
];

/// Options whose values are no numbers of work: paths, keys, and what is tried by itself.
const NO_NUMBERS: [&str; 9] =
    ["out", "set", "beside", "merge", "transmission", "since", "columns", "metrics", "axis"];

/// Values of options.
const OPTION_VALUES: [&str; 8] =
    ["0", "1", "1000000", "1000000000000000000", "1e-300", "1e-6", "1e300", "nan"];

fn scenario_files(names: &[&str]) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    names.iter().map(|name| folder.join(name).with_extension("toml")).collect()
}

/// Example files of a folder, by name.
fn examples(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|end| end == "toml"));
    files.sort();
    files
}

/// Cases of one command: those of every day's test are a few at random, the same ones each day.
struct Cases {
    wanted: Option<String>,
    everyday: u32,
    dice: Dice,
    record: Record,
    picture: String,
    measured: String,
    wrong: Vec<String>,
    tried: usize,
    // The folder of the picture.
    _folder: tempfile::TempDir,
}

impl Cases {
    fn new(name: &str, everyday: u32) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/data/synthetic-film.csv");
        Self {
            wanted: std::env::var("PAPILIO_EXTREMES").ok(),
            everyday,
            dice: Dice::new(0x6578_7472, 0),
            record: Record::open(name),
            picture: picture_in(folder.path()),
            measured: data.to_str().unwrap().to_owned(),
            wrong: Vec::new(),
            tried: 0,
            _folder: folder,
        }
    }

    /// Tries a command with these words, its file, changes of keys and further options.
    fn case(&mut self, command: &str, file: &Path, sets: &[&str], options: &[&str]) {
        let set_arguments = sets.iter().flat_map(|set| ["--set", set]);
        let mut words: Vec<&str> = command.split(' ').collect();
        let after = words.iter().position(|word| word.starts_with(['{', '-'])).unwrap_or(words.len());
        words.insert(after, file.to_str().unwrap());
        for word in &mut words {
            match *word {
                "{picture}" => *word = &self.picture,
                "{measured}" => *word = &self.measured,
                _ => {}
            }
        }
        let arguments: Vec<&str> =
            words.into_iter().chain(set_arguments).chain(options.iter().copied()).collect();
        let stem = file.file_stem().unwrap().to_str().unwrap();
        let name = format!("{command} {stem} {} {}", sets.join(" "), options.join(" "));
        let is_tried = match &self.wanted {
            Some(wanted) => name.contains(wanted.as_str()),
            None => !sized(!self.dice.one_in(self.everyday), false),
        };
        if !is_tried || self.record.has(&name) {
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        self.tried += 1;
        match watch(&arguments, folder.path(), false) {
            End::Ended(_) | End::Progress => self.record.passed(&name),
            End::Wrong(what) => {
                println!("{name}: {what}");
                self.wrong.push(format!("{name}: {what}"));
            }
        }
    }

    /// All keys of files.
    fn keys(&mut self, tried: &Tried, files: &[PathBuf], schema: Value, every_file: bool) {
        let mut keys = Keys::new(schema);
        for file in files {
            if every_file {
                keys.known.clear();
            }
            let table: toml::Table = toml::from_str(&fs::read_to_string(file).unwrap()).unwrap();
            for key in keys.of(&table) {
                if tried.not.contains(&key.path.split('.').next().unwrap()) {
                    continue;
                }
                for value in key.values() {
                    let set = format!("{}={value}", key.path);
                    let mut sets: Vec<&str> = tried.sets.to_vec();
                    sets.retain(|other| !other.starts_with(&format!("{}=", key.path)));
                    sets.push(&set);
                    self.case(tried.command, file, &sets, &[]);
                }
            }
        }
    }

    /// All options of a command with a value.
    fn options(&mut self, tried: &Tried, file: &Path) {
        let command = papilio_cli::command();
        let words = tried.command.split(' ').take_while(|word| !word.starts_with(['{', '-']));
        let found = words.fold(&command, |command, word| command.find_subcommand(word).unwrap());
        for option in found.get_opts().filter(|option| option.get_action().takes_values()) {
            let name = option.get_long().unwrap_or_default();
            if NO_NUMBERS.contains(&name) || name.is_empty() || tried.command.contains(name) {
                continue;
            }
            for value in OPTION_VALUES {
                self.case(tried.command, file, tried.sets, &[&format!("--{name}"), value]);
            }
        }
    }

    fn conclude(self) {
        let Self { wrong, tried, .. } = self;
        println!("{} of {tried} wrong", wrong.len());
        assert!(wrong.is_empty(), "{} of {tried}:\n{}", wrong.len(), wrong.join("\n"));
    }
}

#[test]
fn run_survives_every_number() {
    let tried = Tried { command: "run", files: &[], sets: &[], not: &OF_COMMANDS };
    let mut cases = Cases::new("run", EVERYDAY[0]);
    cases.keys(&tried, &examples("scenarios"), schema(), false);
    cases.options(&tried, &scenario_files(&["indoor"])[0]);
    cases.conclude();
}

/// Few rays, so that most measurements end within a second: other keys than `rays` are tried with them.
#[test]
fn gonio_survives_every_number() {
    let tried = Tried { command: "gonio", files: &[], sets: &["microgeometry.rays=64"], not: &[] };
    let mut cases = Cases::new("gonio", EVERYDAY[0]);
    cases.keys(&tried, &examples("surfaces"), surface_schema(), true);
    cases.conclude();
}

#[test]
fn other_commands_survive_every_number() {
    let only = std::env::var("PAPILIO_EXTREMES_COMMAND").unwrap_or_default();
    let mut cases = Cases::new("others", EVERYDAY[1]);
    for tried in COMMANDS.iter().filter(|tried| tried.command.starts_with(&only)) {
        let files = scenario_files(tried.files);
        cases.keys(tried, &files, schema(), false);
        cases.options(tried, &files[0]);
    }
    cases.conclude();
}
