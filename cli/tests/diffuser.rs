//! `papilio diffuser`: files of measured scattering, in and out.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says what it expects by unwrapping")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn papilio(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_papilio"));
    command.env("NO_COLOR", "1").arg("diffuser").args(arguments).output().unwrap()
}

/// Standard output and standard error of what went well.
fn done(arguments: &[&str]) -> (String, String) {
    let output = papilio(arguments);
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (out, err) = (text(output.stdout), text(output.stderr));
    assert!(output.status.success(), "{arguments:?}\n{err}");
    (out, err)
}

/// What is said of the user's mistake.
fn refused(arguments: &[&str]) -> String {
    let output = papilio(arguments);
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}\n{err}");
    assert!(output.stdout.is_empty());
    err
}

fn shipped(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name);
    path.to_str().unwrap().to_owned()
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }
    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
    fn name(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }
}

/// The files that ship are what the program makes of the scenario that ships.
#[test]
fn shipped_samples_come_again() {
    let folder = Folder::new();
    let scenario = shipped("virtual-instrument.toml");
    for haze in [65, 78, 81] {
        let name = format!("H{haze}.bsdf");
        let sets = [
            format!("display.diffuser.haze=0.{haze}"),
            format!("display.diffuser.total_transmittance=\"data/H{haze}-transmission.csv\""),
            format!("measure.sample=\"H{haze} (synthetic)\""),
        ];
        let out = folder.name(&name);
        let mut arguments = vec!["measure", &scenario, &out];
        sets.iter().for_each(|set| arguments.extend(["--set", set]));
        done(&arguments);
        assert!(same(&folder.path(&name), &shipped(&format!("data/{name}"))), "{name}");
    }
    let raw = folder.name("H78-raw.bsdf");
    let sets = ["--set", "measure.renormalise=false", "--set", "measure.channels=\"monochrome\""];
    done(&[&["measure", scenario.as_str(), raw.as_str()], &sets[..]].concat());
    assert!(same(Path::new(&raw), &shipped("data/H78-raw.bsdf")));
}

/// The same words, and numbers up to the last of their five digits: libraries of mathematics differ.
fn same(ours: &Path, shipped: &str) -> bool {
    let (ours, shipped) = (fs::read_to_string(ours).unwrap(), fs::read_to_string(shipped).unwrap());
    let (mut a, mut b) = (ours.split_whitespace(), shipped.split_whitespace());
    loop {
        match (a.next(), b.next()) {
            (None, None) => return true,
            (Some(a), Some(b)) if a == b => {}
            (Some(a), Some(b)) => match (a.parse::<f64>(), b.parse::<f64>()) {
                (Ok(a), Ok(b)) if (a - b).abs() <= 1.01e-4 * b.abs() => {}
                _ => return false,
            },
            _ => return false,
        }
    }
}

#[test]
fn inspect_says_what_a_file_is_worth() {
    let folder = Folder::new();
    let (text, _) = done(&["inspect", &shipped("data/H78.bsdf"), "--out", &folder.name("figures")]);
    for word in ["Radiant/Zemax", "H78 (synthetic)", "synthetic: a virtual", "0.9000", "ASTM D1003"] {
        assert!(text.contains(word), "{word} is not in\n{text}");
    }
    assert!(folder.path("figures/front-transmission.svg").is_file());
    assert!(folder.path("figures/front-transmission.png").is_file());
    let (json, _) = done(&["inspect", &shipped("data/H78.bsdf"), "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(json.to_string().contains("H78 (synthetic)"));
    assert!(refused(&["inspect", &folder.name("none.bsdf")]).contains("none.bsdf"));
    let cut = fs::read_to_string(shipped("data/H78-raw.bsdf")).unwrap();
    fs::write(folder.path("cut.bsdf"), &cut[..cut.len() / 2]).unwrap();
    assert!(refused(&["inspect", &folder.name("cut.bsdf")]).contains("cut.bsdf:"));
}

#[test]
fn convert_goes_there_and_back() {
    let folder = Folder::new();
    let (npz, back) = (folder.name("raw.npz"), folder.name("raw.bsdf"));
    done(&["convert", &shipped("data/H78-raw.bsdf"), &npz]);
    done(&["convert", &npz, &back]);
    assert!(same(Path::new(&back), &shipped("data/H78-raw.bsdf")));
    let unknown = refused(&["convert", &npz, &folder.name("raw.dat")]);
    assert!(unknown.contains("--format"), "{unknown}");
    assert!(refused(&["convert", &shipped("indoor.toml"), &back]).contains("indoor.toml"));
}

#[test]
fn fit_finds_the_lobe_of_the_file() {
    let file = shipped("data/H78-raw.bsdf");
    let (json, _) = done(&["fit", &file, "--model", "k-correlation", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    // The instrument saw the sum of the sample's width and its own.
    let parameters = json["fits"][0]["parameters"].as_array().unwrap();
    let width = parameters.iter().find(|p| p["name"].as_str().unwrap().contains("width")).unwrap();
    let width = width["value"].as_f64().unwrap();
    assert!((width - 0.105).abs() < 2e-4, "{json}");
    assert!(refused(&["fit", &file, "--part", "back-reflection"]).contains("front transmission"));
}

#[test]
fn calibrate_takes_the_instrument_out() {
    let folder = Folder::new();
    let file = shipped("data/H78-raw.bsdf");
    let out = folder.name("out.bsdf");
    // A sample against itself is a perfect white of the given reflectance.
    let (_, said) = done(&["calibrate", &file, &file, &out, "--reflectance", "0.99"]);
    assert!(said.contains("wrote"), "{said}");
    let (json, _) = done(&["inspect", &out, "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let peak = json["parts"][0]["channels"][0]["incidences"][0]["peak"].as_f64().unwrap();
    assert!((peak - 0.99 / std::f64::consts::PI).abs() < 1e-6, "{peak}");
    let other = folder.name("other.bsdf");
    let scenario = shipped("virtual-instrument.toml");
    let set = "measure.radial_deg={ from = 0, to = 180, step = 5 }";
    done(&["measure", &scenario, &other, "--set", set, "--set", "measure.channels=\"monochrome\""]);
    assert!(refused(&["calibrate", &file, &other, &out]).contains("one grid"));
}

#[test]
fn measure_refuses_what_it_cannot_see() {
    let folder = Folder::new();
    let out = folder.name("out.bsdf");
    let shown = refused(&["measure", &shipped("slab.toml"), &out]);
    assert!(shown.contains("slab"), "{shown}");
    let set = "display.diffuser.straight_through=0.1";
    let shown = refused(&[
        "measure",
        &shipped("virtual-instrument.toml"),
        &out,
        "--set",
        set,
        "--set",
        "measure.blur=0",
    ]);
    assert!(shown.contains("measure.blur"), "{shown}");
    assert!(!folder.path("out.bsdf").exists());
}
