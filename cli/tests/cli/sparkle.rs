//! `papilio sparkle`: files, the two methods, and answers to incomplete scenarios.

use std::fs;

use serde_json::Value;

use crate::common::{names, papilio_command as papilio, scenario, stderr};

fn sparkle(sets: &[&str]) -> std::process::Output {
    let mut command = papilio();
    command.arg("sparkle").arg(scenario("antiglare")).arg("--json");
    sets.iter().for_each(|set| _ = command.args(["--set", set]));
    command.output().unwrap()
}

fn rows(sets: &[&str]) -> Vec<Value> {
    let output = sparkle(sets);
    assert!(output.status.success(), "{}", stderr(&output));
    let file: Value = serde_json::from_slice(&output.stdout).unwrap();
    file["rows"].as_array().unwrap().clone()
}

#[test]
fn files_and_figures_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let output = papilio()
        .arg("sparkle")
        .arg(scenario("antiglare"))
        .args(["--set", "sparkle.replicates=2", "--set", "sparkle.correlation_um=[60,80]"])
        .args(["--set", "solver.relative_error=0.001"])
        .args(["--out", folder.path().to_str().unwrap()])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(names(folder.path()), ["ppd.svg", "sparkle.csv", "sparkle.json", "sparkle.svg"]);
    let figure = fs::read_to_string(folder.path().join("ppd.svg")).unwrap();
    // Two rows as circles, and one in the legend.
    assert_eq!(figure.matches("<circle").count(), 3, "{figure}");
    let csv = fs::read_to_string(folder.path().join("sparkle.csv")).unwrap();
    assert!(csv.starts_with("theta_deg,phi_deg,gap_mm,correlation_um,slope_rms,ppd,"), "{csv}");
    assert_eq!(csv.lines().count(), 3);
    // Two faces do not give a deviation to the target of the scenario, which is not that of sparkle.
    let said = stderr(&output);
    assert!(
        said.contains("is not the target of sparkle") && said.contains("sparkle.replicates = 2 "),
        "{said}"
    );
    let json: Value = serde_json::from_slice(&fs::read(folder.path().join("sparkle.json")).unwrap()).unwrap();
    let warnings = json["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 2);
    // A standard deviation of two normal numbers is uncertain by 1/sqrt 2.
    assert!(
        warnings[1].as_str().unwrap().contains("2 random faces, and are themselves uncertain by 71 %"),
        "{warnings:?}"
    );
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("by the matrix, %"), "{table}");
}

/// One window in each pixel.
const ONE_WINDOW: [&str; 6] = [
    "display.pixel.area={ green = 1 }",
    "display.pixel.states={ white = { green = 1 }, black = { green = 0 } }",
    "display.pixel.gap_nm={ green = 192.3, dark = 20.0 }",
    "display.pixel.fill_factor=0.28005",
    "display.pixel.inactive_reflectance=0",
    "display.matrix={ pitch_um = 84, subpixel = { green = [[0.3452, 0.0476, 0.6548, 0.9524]] } }",
];

/// A window of 26 x 76 um in pixels of 84 um below 0.2 mm of glass, seen through a pinhole in diffuse light:
/// both methods, and the formula for small deflections, which gives 0.0181.
#[test]
fn rays_and_closed_form_agree() {
    let others = [
        "display.glass.thickness_mm=0.2",
        "sparkle={ slope_rms = 0.01, correlation_um = 8, pupil_mm = 0 }",
        "lighting.directed=[]",
        "lighting.diffuse=1",
        "viewer.theta_deg=0",
    ];
    let rows = rows(&[&ONE_WINDOW[..], &others].concat());
    let number = |name: &str| rows[0][name].as_f64().unwrap();
    let (rays, closed, error) = (number("ppd"), number("ppd_closed_form"), number("standard_error"));
    assert!((closed - 0.0181).abs() < 1e-4, "{closed}");
    // Cells of an eighth of the correlation length lower the deviation by 0.3 %.
    assert!(
        error < 0.03 * rays && (rays - closed).abs() < 4.0 * error + 0.005 * closed,
        "{rays} {error} {closed}"
    );
    assert!((number("mean_over_duty") - 1.0).abs() < 4.0 * number("mean_over_duty_error"));
    assert_eq!(number("ppd_lamp"), 0.0);
}

/// The deviation is proportional to the distance of the face, for small deflections, and a larger pupil
/// lowers it.
#[test]
fn closed_form_is_linear_in_distance() {
    let few = "sparkle.replicates=2";
    let face = "sparkle.slope_rms=0.005";
    let diffuse = ["lighting.directed=[]", "lighting.diffuse=1"];
    let sets = ["sparkle.correlation_um=40", "sparkle.gap_mm=[0.1, 0.2]", "sparkle.pupil_mm=0", few];
    // The face by its slope instead of its haze.
    let text = fs::read_to_string(scenario("antiglare")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("slope.toml");
    let line = text.lines().find(|line| line.starts_with("haze")).unwrap();
    fs::write(&file, text.replace(line, "slope_rms = 0.01")).unwrap();
    let run = |more: &[&str]| {
        let mut command = papilio();
        command.arg("sparkle").arg(&file).arg("--json").args(["--set", face]);
        sets.iter()
            .chain(&diffuse)
            .chain(&ONE_WINDOW)
            .chain(more)
            .for_each(|set| _ = command.args(["--set", set]));
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let file: Value = serde_json::from_slice(&output.stdout).unwrap();
        let rows = file["rows"].as_array().unwrap();
        rows.iter().map(|row| row["ppd_closed_form"].as_f64().unwrap()).collect::<Vec<_>>()
    };
    let pinhole = run(&[]);
    assert!((pinhole[1] / pinhole[0] - 2.0).abs() < 0.02, "{pinhole:?}");
    let pupil = run(&["sparkle.pupil_mm=80"]);
    assert!(pupil[1] < 0.9 * pinhole[1], "{pupil:?} {pinhole:?}");
}

/// Below a surface with Gaussian heights, the face is that of the surface: slope sqrt(2) rms/l along an axis;
/// as a table [sparkle] would describe it.
#[test]
fn the_face_of_a_surface_is_its_antiglare_face() {
    let run = |more: &[&str]| -> serde_json::Value {
        let sets = [
            "spectrum.step_nm=80",
            "display.layers.0.rays=640",
            "display.layers.0.correlation_um=40",
            "display.matrix.ppi=300",
            "lighting.directed.0.radius_deg=2",
            "viewer.theta_deg=0",
        ];
        let mut command = papilio();
        command.arg("sparkle").arg(scenario("etched-face")).arg("--json");
        command.args(sets.iter().chain(more).flat_map(|set| ["--set", set]));
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let file: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        file["rows"][0].clone()
    };
    let of_surface = run(&["sparkle.replicates=2"]);
    assert_eq!(of_surface["correlation_um"], 40.0);
    assert!((of_surface["slope_rms"].as_f64().unwrap() - 0.0125 * 2_f64.sqrt()).abs() < 1e-12);
    let of_table = run(&["sparkle={ replicates = 2, slope_rms = 0.0176776695296637, correlation_um = 40 }"]);
    let number = |row: &serde_json::Value, name: &str| row[name].as_f64().unwrap();
    for name in ["ppd", "ppd_matrix", "ppd_lamp", "gap_mm"] {
        let [a, b] = [&of_surface, &of_table].map(|row| number(row, name));
        assert!((a - b).abs() < 1e-9, "{name}: {a} {b}");
    }
    let rougher = run(&["sparkle.replicates=2", "display.layers.0.rms_nm=1000"]);
    assert!((number(&rougher, "slope_rms") / number(&of_surface, "slope_rms") - 2.0).abs() < 1e-9);
}

/// One window of 26 x 76 um in pixels of 84 um, below 0.2 mm of glass with a surface of a file.
const BELOW_A_SURFACE: &str = r#"
[[display.layers]]
kind = "diffuser"
model = "microgeometry"
surface = "face.toml"
rays = 640

[[display.layers]]
kind = "medium"
index = 1.5
thickness_mm = 0.2

[display.pixel]
model = "film"
substrate = "Al"
area = { green = 1 }
states = { white = { green = 1 }, black = { green = 0 } }
default_states = false
fill_factor = 0.28013
gap_nm = { green = 192.3, dark = 20.0 }
film = [{ material = "Cr:Johnson", thickness_nm = 12.15 }, { material = "air", thickness_nm = "gap" }]

[display.matrix]
pitch_um = 84
subpixel = { green = [[0.3452, 0.0476, 0.6548, 0.9524]] }

[lighting]
illuminance_lx = 500
spectrum = "D65"
diffuse = 1
"#;

/// A surface whose power spectral density is a table: that of Gaussian heights, S(f) = pi tau^2 s^2 exp(-(pi
/// tau f)^2). Its heights are made by the surface, not by the closed form, which knows nothing of the table.
#[test]
fn heights_of_any_surface_have_their_sparkle() {
    use std::f64::consts::PI;
    let (tau, slope): (f64, f64) = (15.0, 0.01);
    let rms = slope * tau / 2_f64.sqrt();
    let folder = tempfile::tempdir().unwrap();
    let density = |f: f64| PI * (tau * rms).powi(2) * (-(PI * tau * f).powi(2)).exp();
    let table: String =
        (0..=400).map(|k| f64::from(k) / 4000.0).map(|f| format!("{f},{:e}\n", density(f))).collect();
    fs::write(folder.path().join("psd.csv"), format!("frequency_per_um,density_um4\n{table}")).unwrap();
    fs::write(
        folder.path().join("face.toml"),
        "[microgeometry]\nsurface = \"psd\"\nfile = \"psd.csv\"\ncutoff_um = 12\n",
    )
    .unwrap();
    let display = folder.path().join("display.toml");
    fs::write(&display, BELOW_A_SURFACE).unwrap();
    let run = |sparkle: &str| {
        let mut command = papilio();
        command.arg("sparkle").arg(&display).args(["--json", "--set", sparkle]).output().unwrap()
    };
    let row = |output: std::process::Output| -> Value {
        assert!(output.status.success(), "{}", stderr(&output));
        let file: Value = serde_json::from_slice(&output.stdout).unwrap();
        file["rows"][0].clone()
    };
    let pinhole = "sparkle={ replicates = 16, pupil_mm = 0 }";
    let of_heights = row(run(pinhole));
    let own =
        format!("sparkle={{ replicates = 2, pupil_mm = 0, slope_rms = {slope}, correlation_um = {tau} }}");
    let closed = row(run(&own))["ppd_closed_form"].as_f64().unwrap();
    let number = |name: &str| of_heights[name].as_f64().unwrap();
    for (name, expected) in [("slope_rms", slope), ("correlation_um", tau), ("detail_um", tau)] {
        assert!((number(name) / expected - 1.0).abs() < 0.05, "{name}: {}", number(name));
    }
    assert!(of_heights["ppd_closed_form"].is_null());
    let (ppd, error) = (number("ppd_matrix"), number("ppd_matrix_error"));
    assert!(closed > 0.01 && error < 0.1 * closed, "{closed} {error}");
    // Cells of an eighth of the correlation length lower the deviation by 0.3 %.
    assert!((ppd - closed).abs() < 4.0 * error + 0.005 * closed, "{ppd} {error} {closed}");
    let refused = run("sparkle={ correlation_um = 20 }");
    assert_eq!(refused.status.code(), Some(2));
    let message = stderr(&refused);
    assert!(message.contains("`correlation_um` cannot change the heights of the surface"), "{message}");
}

#[test]
fn incomplete_scenarios_are_refused_with_their_place() {
    for (sets, expected) in [
        (&["lighting.directed=[{ theta_deg = -20, share = 0.3 }]"][..], "the key `radius_deg` is missing"),
        (&["sparkle={ slope_rms = 0.01 }"], "the key `correlation_um` is missing"),
        (&["sparkle={ correlation_um = 8 }"], "the key `slope_rms` is missing"),
        (
            &["sparkle={ haze = 0.1, slope_rms = 0.01, correlation_um = 8 }"],
            "more than one of `slope_rms` and `haze`",
        ),
        (&["sparkle.correlation_um=0"], "0 is out of range"),
        (&["sparkle.correlation_um=[8, 8]"], "8 is in this list twice"),
        (&["sparkle.gloss=120"], "there is no key `gloss` here"),
    ] {
        let output = sparkle(sets);
        assert_eq!(output.status.code(), Some(2), "{sets:?}");
        let message = stderr(&output);
        assert!(message.contains(expected), "{message}");
    }
    // Tables of the file, which --set cannot remove.
    let text = fs::read_to_string(scenario("antiglare")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (line, expected) in [
        ("thickness_mm = 0.5", "the key `display.glass.thickness_mm` is missing"),
        ("[display.matrix]\nppi = 300\nlayout = \"stripe\"", "the key `display.matrix` is missing"),
        (
            "[sparkle]\nhaze = 0.05                     # through a plate with this face; slope 0.036\ncorrelation_um = [8, 15, 30]\npupil_mm = 4",
            "the table [sparkle] is missing",
        ),
    ] {
        assert!(text.contains(line), "{line}");
        let file = folder.path().join("without.toml");
        fs::write(&file, text.replace(line, "")).unwrap();
        let output = papilio().arg("sparkle").arg(&file).arg("--json").output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{line}");
        assert!(stderr(&output).contains(expected), "{}", stderr(&output));
    }
}
