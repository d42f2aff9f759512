//! Estimated time against time of a processor, in the full run only: it takes a few minutes, and depends on the machine.
//!
//! The estimate is that of a refusal, which is proportional to the number of paths, rays, samples or designs.

use std::path::Path;
use std::process::Command;

use papilio_testing::sized;

use super::watch::papilio;

/// Factor within which an estimate is correct.
const FACTOR: f64 = 10.0;

/// A command, its file and other changes, the option or key of the number, and a number that is refused and one that is computed.
type Case = (&'static str, &'static str, &'static [&'static str], &'static str, [f64; 2]);

const CASES: [Case; 9] = [
    ("run --solver monte-carlo", "scenarios/indoor.toml", &[], "--set solver.paths=", [1e12, 4e6]),
    ("run --solver monte-carlo", "scenarios/rough-glass.toml", &[], "--set solver.paths=", [1e12, 262_144.0]),
    ("run --solver monte-carlo", "scenarios/slab.toml", &[], "--set solver.paths=", [1e12, 131_072.0]),
    ("mtf --solver monte-carlo", "scenarios/matrix.toml", &[], "--set solver.paths=", [1e12, 1e6]),
    ("tolerance", "scenarios/tolerance.toml", &[], "--set tolerance.samples=", [1e7, 16_384.0]),
    (
        "optimize --no-check",
        "scenarios/optimize.toml",
        &["--set", "optimize.method=global"],
        "--set optimize.evaluations=",
        [1e8, 4000.0],
    ),
    ("gonio", "surfaces/etched.toml", &[], "--set microgeometry.rays=", [1e9, 20_000.0]),
    ("gonio", "surfaces/prisms.toml", &[], "--set microgeometry.rays=", [1e9, 20_000.0]),
    ("gonio", "surfaces/spheres.toml", &[], "--set microgeometry.rays=", [1e9, 20_000.0]),
];

/// The arguments of a case with a number.
fn arguments((command, file, more, key, _): &Case, number: f64) -> Vec<String> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    let number = format!("{key}{number}");
    let mut words: Vec<String> = command.split(' ').map(str::to_owned).collect();
    words.insert(1, file.to_str().unwrap().to_owned());
    words.extend(more.iter().map(|word| (*word).to_owned()));
    words.extend(number.split(' ').map(str::to_owned));
    words.extend(["--threads", "1", "--out"].map(str::to_owned));
    words
}

/// The estimate of a refusal, s.
fn estimated(case: &Case, folder: &Path) -> f64 {
    let output =
        Command::new(papilio()).args(arguments(case, case.4[0])).arg(folder.join("a")).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    let (_, time) = said.split_once("would take about ").unwrap();
    let words: Vec<&str> = time.split(' ').collect();
    let unit = match words[1] {
        "h" => 3600.0,
        "days" => 24.0 * 3600.0,
        _ => 365.25 * 24.0 * 3600.0,
    };
    words[0].parse::<f64>().unwrap() * unit * case.4[1] / case.4[0]
}

/// Time of a processor, s: the shell prints it of its child.
fn measured(case: &Case, folder: &Path) -> f64 {
    let mut shell = Command::new("sh");
    shell.args(["-c", "\"$0\" \"$@\" >/dev/null 2>&1 || exit 1; times", &papilio()]);
    let output = shell.args(arguments(case, case.4[1])).arg(folder.join("b")).output().unwrap();
    assert!(output.status.success(), "{case:?}");
    let said = String::from_utf8(output.stdout).unwrap();
    let of_child = said.lines().nth(1).unwrap().split(' ').next().unwrap();
    let (minutes, seconds) = of_child.trim_end_matches('s').split_once('m').unwrap();
    60.0 * minutes.parse::<f64>().unwrap() + seconds.parse::<f64>().unwrap()
}

#[test]
fn estimated_times_are_correct_within_a_factor_of_ten() {
    if sized(true, false) {
        return;
    }
    let mut wrong = Vec::new();
    for case in &CASES {
        let folder = tempfile::tempdir().unwrap();
        let [estimated, measured] = [estimated(case, folder.path()), measured(case, folder.path())];
        let line = format!("{} {}: estimated {estimated:.2} s, took {measured:.2} s", case.0, case.1);
        println!("{line}");
        if estimated / measured > FACTOR || measured / estimated > FACTOR {
            wrong.push(line);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
