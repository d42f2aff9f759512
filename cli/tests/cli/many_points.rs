//! A compact sweep of many points, in two shards that are killed repeatedly, ends in the same bytes as an
//! uninterrupted one.
//!
//! `PAPILIO_SWEEP_POINTS`: number of points, a multiple of 100 (default 300; 100 000 in `cargo xtask full`).

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use papilio_formats::HAS_PARQUET;

/// Number of times that a shard is killed before it may end.
const KILLS: u64 = 3;

fn papilio(arguments: &[&str]) -> Command {
    let mut papilio = Command::new(env!("CARGO_BIN_EXE_papilio"));
    papilio.args(arguments).env("NO_COLOR", "1").stdout(Stdio::null()).stderr(Stdio::null());
    papilio
}

fn length(path: &Path) -> u64 {
    fs::metadata(path).map_or(0, |journal| journal.len())
}

#[test]
fn killed_and_merged_shards_equal_the_whole() {
    let points: usize = std::env::var("PAPILIO_SWEEP_POINTS").map_or(300, |points| points.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let scenario = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/indoor.toml");
    let sweep = format!(
        "{}\n[sweep]\nmetrics = [\"gamut_percent_srgb\", \"white.Y\"]\n[[sweep.axes]]\n\
         display.pixel.film.0.thickness_nm = {{ from = 30, to = 80, count = 100 }}\n[[sweep.axes]]\n\
         display.pixel.film.1.thickness_nm = {{ from = 8, to = 16, count = {} }}\n",
        fs::read_to_string(scenario).unwrap(),
        points / 100
    );
    let file = at("s.toml");
    fs::write(&file, sweep).unwrap();
    let parquet: &[&str] = if HAS_PARQUET { &["--parquet"] } else { &[] };
    let whole = at("whole");
    let arguments = [&["sweep", &file, "--out", &whole], parquet].concat();
    assert!(papilio(&arguments).status().unwrap().success());
    let whole = length(&Path::new(&at("whole")).join("sweep-light.jsonl"));

    for k in 1..=2 {
        let (out, shard) = (at(&format!("part{k}")), format!("{k}/2"));
        let journal = Path::new(&out).join(format!("sweep-light.{k}-of-2.jsonl"));
        let arguments = ["sweep", &file, "--out", &out, "--shard", &shard, "--threads", "1"];
        for kill in 1..=KILLS {
            let mut child = papilio(&arguments).spawn().unwrap();
            // Progress decides, not a clock. (The journal of a shard is about half of the whole's.)
            while length(&journal) < kill * whole / (2 * (KILLS + 1)) {
                assert!(child.try_wait().unwrap().is_none(), "it ended before it was killed");
                std::thread::sleep(Duration::from_millis(1));
            }
            child.kill().unwrap();
            child.wait().unwrap();
        }
        assert!(papilio(&arguments).status().unwrap().success());
    }
    let [one, two, merged] = ["part1", "part2", "merged"].map(at);
    let merge = [&["sweep", "merge", &one, &two, "--out", &merged], parquet].concat();
    assert!(papilio(&merge).status().unwrap().success());
    for name in ["sweep.csv", "sweep.parquet"].into_iter().take(if HAS_PARQUET { 2 } else { 1 }) {
        let [merged, whole] =
            ["merged", "whole"].map(|folder| fs::read(Path::new(&at(folder)).join(name)).unwrap());
        assert!(merged == whole, "{name} of the parts is not that of the whole");
    }
}
