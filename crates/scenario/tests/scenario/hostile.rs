//! Any bytes give a scenario or an error, without panics and without unlimited time or memory.

use std::path::Path;

use crate::common::{GOOD, LAYERED, resolve, shipped};
use papilio_scenario::Scenario;
use papilio_testing::{Dice, sized};

/// Values that have broken readers before.
const WORDS: &[&str] = &[
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e-308",
    "-0.0",
    "9223372036854775807",
    "99999999999999999999",
    "0xFFFFFFFFFFFFFFFFFFFF",
    "[]",
    "{}",
    "\"\"",
    "\"/\"",
    "\"\\u0000\"",
    "true",
    "1979-05-27",
    "\u{feff}",
    "\r",
    "\n",
    "[[",
    "]]",
    "=",
    ".",
    "\"",
    "'''",
    "\"\"\"",
    "#",
    "\u{1F98B}",
    "\0",
    "[display]",
    "[[display.front]]",
    "\"gap\"",
    "[1,2,3]",
    "{ from = -89, to = 89, step = 1e-300 }",
    "{ n = 1e300, k = 1e300 }",
];

fn survive(text: &[u8], folder: &Path) {
    let Ok(text) = std::str::from_utf8(text) else { return };
    match Scenario::from_text(text, "x.toml", folder, &[]) {
        Ok(scenario) => {
            if let Err(errors) = scenario.measurement() {
                assert!(!errors.to_string().is_empty());
            }
            match scenario.resolve() {
                Ok(resolved) => assert_eq!(resolved.hash.len(), 64),
                Err(errors) => assert!(errors.to_string().len() < 1 << 20),
            }
        }
        Err(errors) => assert!(!errors.to_string().is_empty()),
    }
}

/// A small measurement.
const SMALL: &str = "\
Symmetry PlaneSymmetrical
SpectralContent Monochrome
ScatterType BTDF
AngleOfIncidence 2
0 60
ScatterAzimuth 3
0 90 180
ScatterRadial 3
0 20 60
Monochrome
DataBegin
TIS 0.9
3 1 .01
3 1 .01
3 1 .01
TIS 0.7
4 1 .02
4 2 .01
4 1 0
DataEnd
";

/// A folder `scenarios` with the data of the shipped ones, but small measurements instead of theirs, beside
/// the shipped surfaces.
struct Folder(tempfile::TempDir);

impl Folder {
    fn path(&self) -> std::path::PathBuf {
        self.0.path().join("scenarios")
    }
}

fn folder() -> Folder {
    let folder = Folder(tempfile::tempdir().unwrap());
    let data = folder.path().join("data");
    std::fs::create_dir_all(&data).unwrap();
    let surfaces = folder.0.path().join("surfaces");
    std::fs::create_dir(&surfaces).unwrap();
    for entry in std::fs::read_dir(shipped().join("../surfaces")).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, surfaces.join(path.file_name().unwrap())).unwrap();
    }
    let entries = std::fs::read_dir(shipped().join("data")).unwrap();
    for path in entries.map(|entry| entry.unwrap().path()).filter(|path| path.is_file()) {
        let name = data.join(path.file_name().unwrap());
        if path.extension().is_some_and(|end| end == "bsdf") {
            let reflects = std::fs::read_to_string(&path).unwrap().contains("BRDF");
            std::fs::write(name, SMALL.replace("BTDF", if reflects { "BRDF" } else { "BTDF" })).unwrap();
        } else {
            std::fs::copy(path, name).unwrap();
        }
    }
    folder
}

/// The keys of measured diffusers.
const MEASURED: &str = r#"[display.diffuser]
model = "measured"
file = "data/H78-raw.bsdf"
flipped = true
transmission = "data/H78-transmission.csv"
normalise = "tis"
spectral_mean = "luminous"
instrument_blur = 0.05
extrapolate_tails = true
extrapolate = "hold"
mounting = "laminated"
[display.pixel]
model = "uniform"
kind = "mirror"
reflectance = { white = 0.6, black = 0.05 }
[measure]
sample = "film"
incidence_deg = [0, 45]
azimuth_deg = { from = 0, to = 180, step = 45 }
radial_deg = { from = 0, to = 180, step = 10 }
channels = "xyz"
light = "D65"
blur = 0.05
renormalise = true
noise = 0.01
noise_floor = 1e-4
seed = 3
dark_beyond_deg = 85
"#;

#[test]
fn mutated_scenarios_do_not_panic() {
    let mut numbers = Dice::new(2012, 0);
    let mut texts = vec![GOOD.to_owned(), LAYERED.to_owned(), MEASURED.to_owned()];
    for entry in std::fs::read_dir(shipped()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|end| end == "toml") {
            // Few rays: surfaces are measured whenever a scenario is resolved.
            texts.push(std::fs::read_to_string(path).unwrap().replace("rays = 20000", "rays = 64"));
        }
    }
    let folder = folder();
    // As they stand, all but the one that asks for the film's other side are resolved.
    let resolves = |text: &String| {
        let scenario = Scenario::from_text(text, "x.toml", &folder.path(), &[]).unwrap();
        scenario.resolve().is_ok() || scenario.measurement().is_ok()
    };
    assert_eq!(texts.iter().filter(|text| !resolves(text)).count(), 1);
    for text in &texts {
        // Even a small measurement, or map of light, takes a hundredth of a second. Where there is time to
        // mutate files of BSDFs for long, there is time for 25 times as many of these.
        let is_slow = [".bsdf\"", ".hdr\"", "surface = "].iter().any(|end| text.contains(end));
        let has_time = std::env::var_os("PAPILIO_FUZZ_SECONDS").is_some();
        let times = if is_slow { sized(2, 6) } else { sized(10, 60) } * if has_time { 25 } else { 1 };
        for _ in 0..times {
            let mut bytes = text.clone().into_bytes();
            for _ in 0..=numbers.below(3) {
                let at = numbers.below(bytes.len());
                let end = (at + numbers.below(12)).min(bytes.len());
                match numbers.below(4) {
                    0 => bytes[at] = numbers.below(128) as u8,
                    1 => drop(bytes.drain(at..end)),
                    2 => drop(bytes.splice(at..end, WORDS[numbers.below(WORDS.len())].bytes())),
                    _ => {
                        let copied = bytes[at..end].to_vec();
                        drop(bytes.splice(at..at, copied));
                    }
                }
            }
            survive(&bytes, &folder.path());
        }
    }
}

/// Each value of the scenarios is replaced by each hostile value.
#[test]
fn hostile_values_do_not_panic() {
    let folder = folder();
    for text in [GOOD, LAYERED, MEASURED] {
        hostile_values(text, &folder.path());
    }
}

fn hostile_values(text: &str, folder: &Path) {
    for line in text.lines().filter(|line| line.contains(" = ")) {
        for word in WORDS {
            for (at, _) in line.match_indices(" = ") {
                let rest = &line[at + 3..];
                let end = rest.find([',', '}']).unwrap_or(rest.len());
                let changed = format!("{} = {word}{}", &line[..at], &rest[end..]);
                survive(text.replacen(line, &changed, 1).as_bytes(), folder);
            }
        }
    }
}

#[test]
fn huge_and_malformed_texts_are_refused() {
    let refused = |text: &str| {
        let errors = resolve(text, Path::new(""), &[]).unwrap_err();
        assert!(errors.iter().count() <= 50);
        assert!(errors.to_string().len() < 1 << 20);
    };
    refused("");
    refused("\u{feff}");
    refused(&format!("{GOOD}\nx = {}1{}", "[".repeat(100_000), "]".repeat(100_000)));
    refused(&format!("{GOOD}\nx = {}", "{ a = ".repeat(50_000)));
    refused(&format!("{GOOD}\n{}x = 1", "a.".repeat(100_000)));
    refused(&format!("{GOOD}\n{}", (0..50_000).map(|i| format!("k{i} = 1\n")).collect::<String>()));
    refused(&format!("# {}", "x".repeat(2 << 20)));
    let layer = "  { material = 1.5, thickness_nm = 1 },\n".repeat(10_000);
    refused(&GOOD.replace("film = [\n", &format!("film = [\n{layer}")));
    let many = (0..20_000).map(|i| format!("s{i} = 0.1, ")).collect::<String>();
    refused(&GOOD.replace("area = { ", &format!("area = {{ {many}")));
    let states: String = (0..250).map(|i| format!("s{i} = {{}}\n")).collect();
    let layers = format!("layers = [{}]", "{ kind = \"ideal-ar\" }, ".repeat(65));
    refused(&LAYERED.replace("[display]", &format!("[display]\n{layers}")));
    let films = "{ material = 1.4, thickness_nm = 1 }, ".repeat(257);
    refused(&LAYERED.replace("film = [", &format!("film = [{films}")));
    let views = "theta_deg = { from = 0, to = 80, step = 0.02 }";
    let text = GOOD
        .replace("theta_deg = 8", views)
        .replace("[lighting]", &format!("[display.pixel.states]\n{states}[lighting]"));
    refused(&text);
}

#[test]
fn file_that_is_not_text_is_refused_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.toml");
    std::fs::write(&path, b"title = \"\xFF\"\n").unwrap();
    let errors = Scenario::load(&path, &[]).unwrap_err();
    assert_eq!(errors.iter().next().unwrap().place.line_column(), Some((1, 10)));
    assert!(Scenario::load(folder.path(), &[]).is_err());
    assert!(Scenario::load(&folder.path().join("none.toml"), &[]).is_err());
}
