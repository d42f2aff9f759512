//! Every numeric key of `run` and `gonio` at the extremes of numbers and of its range: the program ends or
//! shows progress, soon and in limited memory, and never by a panic.
//!
//! **Keys.** The schema is followed along the tables of the examples: every number that a table may have,
//! whether the example has it or not, the first elements of lists, and numbers by names. A key of the same
//! table in several examples of `run` is tried in the first one.
//!
//! **Values.** 0, 1e-300, 1e300, both ends of the range, and the nearest numbers below and above them.

use std::collections::BTreeSet;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use papilio_scenario::{schema, surface_schema};
use papilio_testing::{Dice, sized};
use serde_json::{Map, Value};

use crate::common::papilio_command;

/// Memory that the program may take, bytes.
const MOST_MEMORY: u64 = 1_000_000_000;

/// Time of a processor within which the program ends or shows progress, on each of [`THREADS`] threads, s:
/// time on the clock depends on what else the machine does. It has its first line of progress after 20 s on
/// the clock.
const MOST_SECONDS: f64 = 20.0;
const THREADS: u32 = 2;

/// Of the runs of every day's test, one in so many.
const EVERYDAY: u32 = 60;

/// Few rays, so that most measurements end within a second: other keys than `rays` are tried with them.
const FEW_RAYS: [&str; 2] = ["--set", "microgeometry.rays=64"];

/// Tables that `papilio run` does not use.
const OF_OTHER_COMMANDS: [&str; 8] =
    ["sweep", "optimize", "tolerance", "fit", "image", "pattern", "sparkle", "measure"];

/// A number that a file may have.
struct Key {
    path: String,
    /// True for a list of numbers that the file does not have.
    is_list: bool,
    schema: Value,
}

/// Finds the keys of files.
struct Keys {
    schema: Value,
    /// Names of all keys of a table, and of one of them.
    known: BTreeSet<(String, String)>,
}

impl Keys {
    fn new(schema: Value) -> Self {
        Self { schema, known: BTreeSet::new() }
    }

    /// The forms that a value may have, without references.
    fn forms<'a>(&'a self, schema: &'a Value) -> Vec<&'a Value> {
        let mut schema = schema;
        while let Some(name) = schema["$ref"].as_str() {
            schema = &self.schema["$defs"][name.rsplit('/').next().unwrap()];
        }
        let several = ["anyOf", "oneOf"].iter().filter_map(|name| schema[name].as_array()).flatten();
        let mut forms: Vec<&Value> = several.flat_map(|one| self.forms(one)).collect();
        if forms.is_empty() || schema["type"].is_string() {
            forms.push(schema);
        }
        forms
    }

    fn tables<'a>(&'a self, schema: &'a Value) -> Vec<&'a Map<String, Value>> {
        self.forms(schema)
            .into_iter()
            .filter(|form| form["properties"].is_object())
            .map(|form| form.as_object().unwrap())
            .collect()
    }

    fn numbers(&self, schema: &Value) -> Vec<Value> {
        let is_number = |form: &&Value| matches!(form["type"].as_str(), Some("number" | "integer"));
        self.forms(schema).into_iter().filter(is_number).cloned().collect()
    }

    /// True if a table has the keys of a form, and its words.
    fn fits(&self, form: &Map<String, Value>, table: &toml::Table) -> bool {
        let others = form.get("additionalProperties").is_some_and(Value::is_object);
        table.iter().all(|(key, value)| match form["properties"].get(key) {
            None => others,
            Some(schema) => {
                self.forms(schema).iter().any(|form| match (value.as_str(), &form["const"], &form["enum"]) {
                    (Some(word), Value::String(only), _) => word == only,
                    (Some(word), _, Value::Array(words)) => words.iter().any(|one| one == word),
                    _ => true,
                })
            }
        })
    }

    /// The keys of a file that are not known yet.
    fn of(&mut self, file: &toml::Table) -> Vec<Key> {
        let mut found = Vec::new();
        let root = self.schema.clone();
        self.follow(&root, file, "", &mut found);
        found
    }

    fn follow(&mut self, schema: &Value, table: &toml::Table, path: &str, found: &mut Vec<Key>) {
        let forms: Vec<Map<String, Value>> =
            self.tables(schema).into_iter().filter(|form| self.fits(form, table)).cloned().collect();
        for form in forms {
            let properties = form["properties"].as_object().unwrap();
            let id = properties.keys().cloned().collect::<Vec<_>>().join(",");
            for (key, schema) in properties {
                let here = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                self.add(&id, key, &here, false, self.numbers(schema), found);
                let items: Vec<Value> = self
                    .forms(schema)
                    .into_iter()
                    .filter(|form| form["type"] == "array")
                    .map(|form| form["items"].clone())
                    .collect();
                match table.get(key) {
                    Some(toml::Value::Table(inner)) => self.follow(schema, inner, &here, found),
                    Some(toml::Value::Array(list)) => {
                        for (item, (number, element)) in items
                            .iter()
                            .flat_map(|item| list.iter().take(3).enumerate().map(move |at| (item, at)))
                        {
                            let here = format!("{here}.{number}");
                            match element {
                                toml::Value::Table(inner) => self.follow(item, inner, &here, found),
                                _ => self.add(
                                    &id,
                                    &format!("{key}.{number}"),
                                    &here,
                                    false,
                                    self.numbers(item),
                                    found,
                                ),
                            }
                        }
                    }
                    Some(_) => {}
                    None => {
                        for item in &items {
                            self.add(&id, &format!("{key}[]"), &here, true, self.numbers(item), found);
                        }
                        // A table of one number that needs no other key.
                        let optional: Vec<Map<String, Value>> = self
                            .tables(schema)
                            .into_iter()
                            .filter(|form| form["required"].as_array().is_none_or(Vec::is_empty))
                            .cloned()
                            .collect();
                        if !optional.is_empty() && self.numbers(schema).is_empty() {
                            self.follow_optional(&optional, &here, found);
                        }
                    }
                }
            }
            if let Some(others) = form.get("additionalProperties").filter(|others| others.is_object()) {
                let name = table.keys().find(|key| !properties.contains_key(*key));
                if let Some(name) = name {
                    let last = path.rsplit('.').next().unwrap().to_owned();
                    self.add("names", &last, &format!("{path}.{name}"), false, self.numbers(others), found);
                }
            }
        }
    }

    fn follow_optional(&mut self, forms: &[Map<String, Value>], path: &str, found: &mut Vec<Key>) {
        for form in forms {
            let properties = form["properties"].as_object().unwrap();
            let id = properties.keys().cloned().collect::<Vec<_>>().join(",");
            for (key, schema) in properties {
                self.add(&id, key, &format!("{path}.{key}"), false, self.numbers(schema), found);
            }
        }
    }

    fn add(
        &mut self,
        id: &str,
        key: &str,
        path: &str,
        is_list: bool,
        numbers: Vec<Value>,
        found: &mut Vec<Key>,
    ) {
        let is_new = !numbers.is_empty() && self.known.insert((id.to_owned(), key.to_owned()));
        let all = numbers.into_iter().filter(|_| is_new);
        found.extend(all.map(|schema| Key { path: path.to_owned(), is_list, schema }));
    }
}

impl Key {
    /// Values at the extremes, as TOML.
    fn values(&self) -> Vec<String> {
        let is_integer = self.schema["type"] == "integer";
        let mut all: Vec<String> = match is_integer {
            true => vec!["0".to_owned(), "1".to_owned(), "1000000000000000000".to_owned()],
            false => vec!["0.0".to_owned(), "1e-300".to_owned(), "1e300".to_owned()],
        };
        for end in ["minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"] {
            let Some(end) = self.schema[end].as_f64() else { continue };
            match is_integer {
                true => all.extend([-1.0, 0.0, 1.0].map(|step| format!("{}", (end + step) as i64))),
                false => all.extend([end.next_down(), end, end.next_up()].map(|value| format!("{value:?}"))),
            }
        }
        all.dedup();
        match self.is_list {
            true => all.into_iter().map(|value| format!("[{value}]")).collect(),
            false => all,
        }
    }
}

/// How a run of the program ended, or why it was ended.
#[derive(Debug, PartialEq)]
enum End {
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
fn watch(arguments: &[&str], folder: &Path, is_whole: bool) -> End {
    let [out, errors] = ["stdout", "stderr"].map(|name| folder.join(name));
    let into = |path: &Path| Stdio::from(fs::File::create(path).unwrap());
    let mut child = papilio_command()
        .args(arguments)
        .args(["--threads", &THREADS.to_string(), "--out"])
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
                Some(code @ (0 | 2)) => End::Ended(code),
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
fn has_long_number(text: &str) -> bool {
    text.split(|c: char| !c.is_ascii_digit() && c != '.').any(|word| word.len() > 40)
}

/// Numbers of the user's at the ends of those of a computer, in messages and in the table of a report.
#[test]
fn numbers_of_messages_and_reports_have_exponents() {
    let film = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/indoor.toml");
    for (arguments, says) in [
        (&["tolerance", "--set", "tolerance.samples=1e300"][..], "1e300"),
        (&["optimize", "--set", "optimize.evaluations=1e300"], "1e300"),
        (&["run", "--set", "spectrum.step_nm=1e-300"], "1e-300"),
        (&["run", "--set", "spectrum.range_nm=[1e-300,780]"], "1e-300"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let output = papilio_command()
            .arg(arguments[0])
            .arg(&film)
            .args(&arguments[1..])
            .arg("--out")
            .arg(folder.path().join("results"))
            .output()
            .unwrap();
        let said =
            format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert!(said.contains(says) && !has_long_number(&said), "{arguments:?}: {said}");
    }
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

/// Example files of a folder, by name.
fn examples(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|end| end == "toml"));
    files.sort();
    files
}

/// Tries a command on all keys of its files: of every day's test a few at random, the same ones each day.
///
/// `PAPILIO_EXTREMES` is a part of the name of keys: those alone are tried, all of them.
fn try_all(command: &str, files: Vec<PathBuf>, schema: Value, every_file: bool) {
    let wanted = std::env::var("PAPILIO_EXTREMES").ok();
    let mut keys = Keys::new(schema);
    let mut dice = Dice::new(0x6578_7472, 0);
    let (mut wrong, mut tried) = (Vec::new(), 0);
    for file in files {
        if every_file {
            keys.known.clear();
        }
        let table: toml::Table = toml::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
        for key in keys.of(&table) {
            let first = key.path.split('.').next().unwrap();
            if OF_OTHER_COMMANDS.contains(&first)
                || wanted.as_ref().is_some_and(|wanted| !key.path.contains(wanted))
            {
                continue;
            }
            for value in key.values() {
                if wanted.is_none() && sized(!dice.one_in(EVERYDAY), false) {
                    continue;
                }
                let folder = tempfile::tempdir().unwrap();
                let set = format!("{}={value}", key.path);
                tried += 1;
                let mut arguments = vec![command, file.to_str().unwrap(), "--set", &set];
                if command == "gonio" && !key.path.ends_with(".rays") {
                    arguments.extend(FEW_RAYS);
                }
                match watch(&arguments, folder.path(), false) {
                    End::Ended(_) | End::Progress => {}
                    End::Wrong(what) => wrong.push(format!("{} --set {set}: {what}", file.display())),
                }
            }
        }
    }
    assert!(tried > 3 || wanted.is_some(), "{tried}");
    assert!(wrong.is_empty(), "{} of {tried}:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn run_survives_every_number() {
    try_all("run", examples("scenarios"), schema(), false);
}

#[test]
fn gonio_survives_every_number() {
    try_all("gonio", examples("surfaces"), surface_schema(), true);
}

/// Numbers in range that would take hours, or names of files that are too long.
#[test]
fn what_would_take_hours_is_refused_with_its_key() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let run = |command: &str, file: &str, sets: &[&str]| {
        let folder = tempfile::tempdir().unwrap();
        let mut program = papilio_command();
        program.arg(command).arg(root.join(file)).arg("--out").arg(folder.path().join("out"));
        sets.iter().for_each(|set| _ = program.args(["--set", set]));
        program.output().unwrap()
    };
    for (command, file, sets, words) in [
        (
            "run",
            "scenarios/map.toml",
            &["display.diffuser.haze=1e-4"][..],
            &["`width` or `haze` of display.diffuser", "depends on azimuth", "monte-carlo"][..],
        ),
        (
            "gonio",
            "surfaces/prisms.toml",
            &["microgeometry.index_below=1e-6"],
            &["is out of range", "index_below"],
        ),
        ("gonio", "surfaces/etched.toml", &["microgeometry.rms_nm=1e6"], &["are spikes", "correlation_um"]),
        (
            "gonio",
            "surfaces/hemispheres.toml",
            &["microgeometry.radius_um=1e6"],
            &["are flat at a radius of 1000000 um", "`radius_um`"],
        ),
        (
            "run",
            "scenarios/etched-face.toml",
            &["display.layers.0.rms_nm=1e6"],
            &["are spikes", "correlation_um"],
        ),
        (
            "run",
            "scenarios/hazy-face.toml",
            &["display.layers.0.rms_nm=7e4", "display.layers.0.correlation_um=16"],
            &["too many wavelengths", "`rms_nm` of at most"],
        ),
    ] {
        let output = run(command, file, sets);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{command} {file} {sets:?}: {said}");
        for words in words {
            assert!(said.contains(words), "{command} {file} {sets:?}: {said}");
        }
    }
    let output = run("run", "scenarios/auto.toml", &["viewer.theta_deg.0=1e-300", "spectrum.step_nm=20"]);
    assert!(output.status.success(), "{}", String::from_utf8(output.stderr).unwrap());
    assert!(String::from_utf8(output.stdout).unwrap().contains("seen from 1e-300 deg"));
}

/// Displays of Lambertian pixels below a face, and of mirrors below a diffuser.
const PAPER: &str = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\nthickness_mm = 0.5\n[display.pixel]\nmodel = \"uniform\"\n\
    kind = \"lambertian\"\nreflectance = { white = 0.6, black = 0.03 }\n[display.matrix]\nppi = 300\n";
const MIRRORS: &str = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.01\ntotal_transmittance = 0.9\n[display.glass]\nindex = 1.5\n\
    thickness_mm = 1\n[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.6, black = 0.03 }\n[display.matrix]\n\
    ppi = 300\n";

/// Lambertian pixels below a lobe and a front that returns light through it.
const FRONT: &str = "[[display.front]]\nreflectance = 0.05\ngap_mm = 0.2\n[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.06\n\
    total_transmittance = 0.9\n[display.glass]\nindex = 1.5\nthickness_mm = 0.5\n[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\n\
    reflectance = { white = 0.6, black = 0.03 }\n[display.matrix]\nppi = 300\n";

/// A picture of 160 x 120 pixels, its path.
fn picture_in(folder: &Path) -> String {
    let pixels: Vec<[u8; 3]> = (0..160 * 120).map(|at| [(at * 7 % 256) as u8; 3]).collect();
    let mut picture = Vec::new();
    papilio_formats::write_rgb_png(&mut picture, 160, &pixels, false).unwrap();
    let path = folder.join("picture.png");
    fs::write(&path, picture).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Ordinary values: air in the place of the glass, and nearly. Every command answers.
#[test]
fn places_above_air_are_computed() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture_in(folder.path());
    let mut wrong = Vec::new();
    let all = [("front", FRONT), ("paper", PAPER), ("mirrors", MIRRORS)];
    let everyday = [("front", "1.00001", "image"), ("paper", "1", "mtf")];
    for (name, text) in all {
        let file = folder.path().join(format!("{name}.toml"));
        fs::write(&file, text).unwrap();
        for index in ["1", "1.00001", "1.0006"] {
            for command in ["mtf", "crosstalk", "image"] {
                if sized(!everyday.contains(&(name, index, command)), false) {
                    continue;
                }
                let set = format!("display.glass.index={index}");
                let mut arguments = vec![command, file.to_str().unwrap()];
                if command == "image" {
                    arguments.push(&picture);
                }
                arguments.extend(["--set", &set]);
                let results = tempfile::tempdir().unwrap();
                match watch(&arguments, results.path(), true) {
                    End::Ended(0) => {}
                    other => wrong.push(format!("{name} {arguments:?}: {other:?}")),
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The narrowest lobe above the thinnest glass.
#[test]
fn narrow_lobes_above_thin_glass_survive() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture_in(folder.path());
    let mut wrong = Vec::new();
    for (name, text) in [("front", FRONT), ("mirrors", MIRRORS)] {
        let file = folder.path().join(format!("{name}.toml"));
        fs::write(&file, text).unwrap();
        for command in ["mtf", "image", "crosstalk"] {
            if sized(name != "front" || command == "image", false) {
                continue;
            }
            let mut arguments = vec![command, file.to_str().unwrap()];
            if command == "image" {
                arguments.push(&picture);
            }
            // Half a minute for a narrower lobe.
            let width = sized("display.diffuser.width=1e-3", "display.diffuser.width=1e-6");
            for set in [width, "display.glass.thickness_mm=1e-6"] {
                arguments.extend(["--set", set]);
            }
            let results = tempfile::tempdir().unwrap();
            if let End::Wrong(what) = watch(&arguments, results.path(), true) {
                wrong.push(format!("{name} {arguments:?}: {what}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Lengths and resolutions of commands with places: a few each day, all of them in full.
#[test]
fn places_survive_every_length() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str, bytes: &[u8]| -> String {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let files = [
        place("paper.toml", PAPER.as_bytes()),
        place("mirrors.toml", MIRRORS.as_bytes()),
        place("front.toml", FRONT.as_bytes()),
    ];
    let picture = picture_in(folder.path());
    let thickness =
        ["0.0", "1e-300", "1e-12", "1e-9", "1e-3", "0.005", "0.02", "0.1", "10", "100", "1e3", "1e300"]
            .map(|mm| format!("display.glass.thickness_mm={mm}"));
    let others = [
        "display.matrix.ppi=0.1",
        "display.matrix.ppi=1e5",
        "viewer.text_height_mm=100",
        "viewer.text_height_mm=1e-3",
    ]
    .map(str::to_owned);
    let everyday = ["thickness_mm=1e-300", "thickness_mm=1e-9", "thickness_mm=1e3"];
    let mut wrong = Vec::new();
    for set in thickness.iter().chain(&others) {
        for (number, file) in files.iter().enumerate() {
            for command in ["mtf", "crosstalk", "image", "mtf --solver monte-carlo"] {
                let is_everyday = number == 0 && command != "mtf --solver monte-carlo";
                if sized(!(is_everyday && everyday.iter().any(|end| set.ends_with(end))), false) {
                    continue;
                }
                let results = tempfile::tempdir().unwrap();
                let mut arguments: Vec<&str> = command.split(' ').collect();
                arguments.insert(1, file);
                if command == "image" {
                    arguments.insert(2, &picture);
                }
                arguments.extend(["--set", set]);
                if let End::Wrong(what) = watch(&arguments, results.path(), true) {
                    wrong.push(format!("{arguments:?}: {what}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Ctrl-C while a report is computed, surfaces or displays: exit code 130, and nothing is left in its folder.
#[cfg(unix)]
#[test]
fn an_interrupted_report_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let scenarios = folder.path().join("scenarios");
    let mut program = papilio_command();
    program.args(["validate", "--threads", "1", "--out"]).arg(folder.path());
    let child = program.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    while !scenarios.join("data/H81-transmission.csv").exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(!scenarios.exists(), "{said}");
}
