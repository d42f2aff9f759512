//! `papilio gonio`: its files, reproducible results, and answers to wrong input.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::common::{names, papilio_command as papilio, stderr};

#[test]
fn a_surface_is_measured() {
    let surface = Path::new(env!("CARGO_MANIFEST_DIR")).join("../surfaces/hemispheres.toml");
    let folder = tempfile::tempdir().unwrap();
    let measured = |threads: &str| {
        let out = folder.path().join(threads);
        let mut command = papilio();
        command.arg("gonio").arg(&surface).args(["--set", "microgeometry.rays=3200", "--seed", "5"]);
        command.args(["--set", "microgeometry.incidence_deg=[0,60]", "--threads", threads]);
        let output = command.arg("--out").arg(&out).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(names(&out), ["audit.json", "face.npz", "totals.csv", "totals.svg"]);
        let table = String::from_utf8(output.stdout).unwrap();
        assert!(table.contains("light from  inclination, deg  reflected, %"), "{table}");
        out
    };
    let [one, two] = ["1", "2"].map(measured);
    for name in ["totals.csv", "audit.json", "face.npz"] {
        assert!(
            fs::read(one.join(name)).unwrap() == fs::read(two.join(name)).unwrap(),
            "{name} depends on threads"
        );
    }
    let totals = fs::read_to_string(one.join("totals.csv")).unwrap();
    assert!(totals.starts_with(
        "from,theta_deg,reflected,reflected_beyond,transmitted,transmitted_beyond,regular_reflected,"
    ));
    let rows: Vec<Vec<&str>> = totals.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!(
        rows.iter().map(|row| [row[0], row[1]]).collect::<Vec<_>>(),
        [["above", "0"], ["above", "60"], ["below", "0"], ["below", "60"]]
    );
    let audit: Value = serde_json::from_slice(&fs::read(one.join("audit.json")).unwrap()).unwrap();
    assert_eq!((audit["seed"].as_u64(), audit["dropped_rays"].as_f64()), (Some(5), Some(0.0)));
    assert!(
        audit["reciprocity_z"].as_f64().unwrap() < 1.3 && audit["energy_z"].as_array().unwrap().len() == 92
    );
}

#[test]
fn displays_are_no_surfaces() {
    let display = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/six-ink.toml");
    let output = papilio().arg("gonio").arg(display).output().unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("not a surface") && message.contains("[microgeometry]"), "{message}");
}
