//! `papilio pixel`: scans as tables that `model = "table"` reads.

use std::fs;
use std::path::Path;

use crate::common::{names, papilio_command as papilio, scenario, stderr};

#[test]
fn pixel_scan_is_written_as_a_pixel_table() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let output = papilio().arg("pixel").arg(scenario("indoor")).args(["--out", out]).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(names(folder.path()), ["about.json", "pixel.csv", "pixel.svg"]);
    let csv = fs::read_to_string(folder.path().join("pixel.csv")).unwrap();
    assert_eq!(csv.lines().next().unwrap(), "state,theta_deg,wavelength_nm,reflectance");
    assert_eq!(csv.lines().count(), 1 + 8 * 91 * 81);
}

/// The way in and out for other pixel tools: the scan of a film pixel, read back as a table,
/// shows the same display. Angles in glass, so that the table reaches all light.
#[test]
fn pixel_scan_read_back_gives_the_same_display() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let bare = scenario("reference-pixel");
    let output = papilio().arg("pixel").arg(&bare).arg("--out").arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let film = fs::read_to_string(&bare).unwrap();
    let (before, rest) = film.split_once("[display.pixel]").unwrap();
    let after = &rest[rest.find("[lighting]").unwrap()..];
    let table = "[display.pixel]\nmodel = \"table\"\nfile = \"pixel.csv\"\nangles = \"glass\"\n\n";
    fs::write(path("table.toml"), format!("{before}{table}{after}")).unwrap();
    let white = |file: &Path| {
        let output = papilio()
            .arg("run")
            .arg(file)
            .args(["--json", "--set", "viewer.theta_deg=8.5"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        result["views"][0]["states"]["white"]["Y"].as_f64().unwrap()
    };
    let (from_film, from_table) = (white(&bare), white(&path("table.toml")));
    // Midway between the table's angles linear interpolation is at its worst.
    assert!((from_film - from_table).abs() < 2e-4 * from_film, "{from_film} {from_table}");
}

/// A liquid crystal, written by azimuth, read back as a table: the same reflectance at azimuths of the table and between them. One azimuth
/// alone is no table of such a pixel, and a film has none.
#[test]
fn scan_by_azimuth_read_back_gives_the_same_display() {
    let folder = tempfile::tempdir().unwrap();
    let coarse = ["--set", "spectrum.range_nm=[400,700]", "--set", "spectrum.step_nm=100", "--step", "3"];
    let scan = |name: &str, out: &str, more: &[&str]| {
        let out = folder.path().join(out);
        let output = papilio()
            .arg("pixel")
            .arg(scenario(name))
            .args(coarse)
            .args(more)
            .arg("--out")
            .arg(&out)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        (fs::read_to_string(out.join("pixel.csv")).unwrap(), stderr(&output))
    };
    let json = |file: &Path, more: &[&str]| -> serde_json::Value {
        let output = papilio().arg("pixel").arg(file).args(coarse).arg("--json").args(more).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let (csv, _) = scan("mip-lcd", "all", &["--angles", "glass", "--phi-step", "5"]);
    assert_eq!(csv.lines().next(), Some("state,theta_deg,phi_deg,wavelength_nm,reflectance"));
    // 2 states, 31 angles, 36 azimuths, 4 wavelengths.
    assert_eq!(csv.lines().count(), 1 + 2 * 31 * 36 * 4);
    let table = "[spectrum]\nrange_nm = [400, 700]\nstep_nm = 100\n[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\n\
                 [display.pixel]\nmodel = \"table\"\nfile = \"FILE/pixel.csv\"\nangles = \"glass\"\n";
    let file = folder.path().join("table.toml");
    fs::write(&file, table.replace("FILE", "all")).unwrap();
    let azimuths = ["--angles", "glass", "--phi", "-45,30,37"];
    let (of_crystal, of_table) = (json(&scenario("mip-lcd"), &azimuths), json(&file, &azimuths));
    assert_eq!(of_crystal["phi_deg"], serde_json::json!([-45.0, 30.0, 37.0]));
    let mut swing = 0.0_f64;
    for state in ["white", "black"] {
        let number = |json: &serde_json::Value, theta: usize, phi: usize, bin: usize| {
            json["reflectance"][state][theta][phi][bin].as_f64().unwrap()
        };
        // To 42 deg in glass: beyond, light is trapped, and changes quickly over angle and azimuth.
        for (theta, phi, bin) in
            (0..=14).flat_map(|t| (0..3).flat_map(move |p| (0..4).map(move |b| (t, p, b))))
        {
            let (a, b) = (number(&of_crystal, theta, phi, bin), number(&of_table, theta, phi, bin));
            // Also at 37 deg, between its azimuths: the harmonics that are missing are smaller.
            assert!((a - b).abs() < 1e-9, "{state} {theta} {phi} {bin}: {a} {b}");
            swing = swing.max((a - number(&of_crystal, theta, 0, bin)).abs());
        }
    }
    assert!(swing > 0.02, "{swing}");
    let (csv, _) = scan("mip-lcd", "one", &["--phi", "45"]);
    assert!(csv.lines().nth(1).unwrap().starts_with("white,0,45,400,"), "{csv}");
    fs::write(&file, table.replace("FILE", "one")).unwrap();
    let refused = papilio().arg("run").arg(&file).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("--phi-step"), "{}", stderr(&refused));
    let (csv, said) = scan("reference-pixel", "film", &["--phi", "45"]);
    assert_eq!(csv.lines().next(), Some("state,theta_deg,wavelength_nm,reflectance"));
    assert!(said.contains("same at all azimuths"), "{said}");
}

#[test]
fn pixel_scan_in_glass_is_accepted_below_any_front() {
    let folder = tempfile::tempdir().unwrap();
    let scan = |angles: &str| {
        let arguments = ["--angles", angles, "--step", "45", "--out", folder.path().to_str().unwrap()];
        let output = papilio().arg("pixel").arg(scenario("indoor")).args(arguments).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let csv = fs::read_to_string(folder.path().join("pixel.csv")).unwrap();
        assert_eq!(csv.lines().count(), 1 + 8 * 3 * 81);
        let white = csv.lines().find(|line| line.starts_with("white,45,550,")).unwrap();
        white.rsplit(',').next().unwrap().parse::<f64>().unwrap()
    };
    // At 45 deg in glass light is reflected at the air gap, at 45 deg in air it is not.
    assert!((scan("glass") - scan("air")).abs() > 0.05);
}

/// Each row of absorption.csv is a fraction of the light on its sub-pixel; with sub-pixels.csv they sum to 1.
#[test]
fn absorption_of_the_layers_and_reflectance_sum_to_one() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let scan = |name: &str, more: &[&str]| {
        let arguments = ["--absorption", "--set", "spectrum.step_nm=50", "--out", out];
        papilio().arg("pixel").arg(scenario(name)).args(arguments).args(more).output().unwrap()
    };
    let output = scan("indoor", &["--step", "45"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("red (black)") && printed.contains("1 Cr:Johnson"), "{printed}");
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let absorbed = read("absorption.csv");
    let header = "state,sub_pixel,layer,material,theta_deg,wavelength_nm,absorptance";
    assert_eq!(absorbed.lines().next(), Some(header));
    // 8 states, 3 sub-pixels, 6 layers, 3 angles, 9 wavelengths.
    assert_eq!(absorbed.lines().count(), 1 + 8 * 3 * 6 * 3 * 9);
    assert!(
        absorbed.contains("white,red,1,Cr:Johnson,45,480,")
            && absorbed.contains("black,blue,substrate,Al,90,780,")
    );
    let mut sums = std::collections::BTreeMap::<String, f64>::new();
    for line in absorbed.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let place = [cells[0], cells[1], cells[4], cells[5]].join(",");
        *sums.entry(place).or_default() += cells[6].parse::<f64>().unwrap();
    }
    for line in read("sub-pixels.csv").lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let place = [cells[0], cells[1], cells[3], cells[4]].join(",");
        let reflectance: f64 = cells[5].parse().unwrap();
        assert!((sums[&place] + reflectance - 1.0).abs() < 1e-12, "{line}");
    }
    assert!(read("absorption.svg").contains("substrate: Al"));
    let refused = scan("epaper", &[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("no film whose layers absorb"), "{}", stderr(&refused));
}

#[test]
fn pixel_scan_as_json_has_the_numbers_of_the_table_and_writes_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--step", "45", "--absorption", "--json"];
    let output = papilio()
        .current_dir(folder.path())
        .arg("pixel")
        .arg(scenario("indoor"))
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(names(folder.path()), [""; 0]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["theta_deg"], serde_json::json!([0.0, 45.0, 90.0]));
    let reflectance = json["reflectance"]["white"].as_array().unwrap();
    assert_eq!((reflectance.len(), reflectance[0].as_array().unwrap().len()), (3, 81));
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    // Reflectance and absorptances of a sub-pixel sum to 1.
    let one = &json["absorption"]["sub_pixels"][0];
    let layers = one["absorptance"].as_array().unwrap();
    assert_eq!(layers.len(), json["absorption"]["materials"].as_array().unwrap().len());
    let absorbed: f64 = layers.iter().map(|layer| number(&layer[1][40])).sum();
    assert!((absorbed + number(&one["reflectance"][1][40]) - 1.0).abs() < 1e-9, "{absorbed}");
}

/// The pixel uses no light: its scan extends beyond the table of the scenario's lamp, and is the same there
/// as in a light that does. A run refuses the lamp, and takes equal energy, which has no end.
#[test]
fn wavelengths_beyond_the_lamp_are_scanned() {
    let wide = ["--set", "spectrum.range_nm=[370,850]", "--set", "spectrum.step_nm=20"];
    let scan = |name: &str, more: &[&str]| {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().to_str().unwrap();
        let file = scenario(name).display().to_string();
        let output = papilio()
            .args([&["pixel", &file, "--out", out, "--step", "30"], &wide[..], more].concat())
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        (fs::read_to_string(folder.path().join("pixel.csv")).unwrap(), stderr(&output))
    };
    let (found, said) = scan("reference-pixel", &[]);
    assert!(said.contains("reaches from 380 to 780 nm, not from 370 to 850 nm"), "{said}");
    assert!(found.contains(",0,370,") && found.contains(",0,850,"), "{found}");
    let equal = ["--set", "lighting.spectrum=E"];
    let (in_equal, said) = scan("reference-pixel", &equal);
    assert_eq!(found, in_equal);
    assert!(!said.contains("reaches"), "{said}");
    let file = scenario("reference-pixel").display().to_string();
    let run = |more: &[&str]| {
        papilio().args([&["run", &file, "--json"], &wide[..], more].concat()).output().unwrap()
    };
    assert_eq!(run(&[]).status.code(), Some(2));
    assert!(run(&equal).status.success(), "{}", stderr(&run(&equal)));
}
