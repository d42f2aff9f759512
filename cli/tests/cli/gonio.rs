//! `papilio gonio`: its files, reproducible results, and answers to wrong input.

use std::fs;
use std::path::Path;
#[cfg(unix)]
use std::process::{Command, Stdio};
#[cfg(unix)]
use std::time::Duration;

use serde_json::Value;

use crate::common::{names, papilio_command as papilio, stderr};

/// The first files of each surface that has heights, by name.
const HEIGHTS: [&str; 3] = ["audit.json", "cutoff.csv", "cutoff.svg"];

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
        assert_eq!(
            names(&out),
            HEIGHTS
                .into_iter()
                .chain(["face.npz", "psd.csv", "psd.svg", "totals.csv", "totals.svg"])
                .collect::<Vec<_>>()
        );
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
    for (name, axis) in [("totals.svg", ">Light (%)<"), ("psd.svg", ">Frequency (cycles per μm)<")] {
        assert!(fs::read_to_string(one.join(name)).unwrap().contains(axis), "{name}");
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

/// With azimuths, a measurement writes the same files and two more; a display uses the mean over azimuths and
/// says so. Steps that are not possible are refused with their place.
#[test]
fn a_surface_is_measured_by_azimuth() {
    let surface = Path::new(env!("CARGO_MANIFEST_DIR")).join("../surfaces/prisms.toml");
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let measured = |out: &str, azimuth: &str| {
        let mut command = papilio();
        command.current_dir(here).arg("gonio").arg(&surface).args(["--set", "microgeometry.rays=640"]);
        command
            .args(["--set", "microgeometry.incidence_deg=[30]", "--set"])
            .arg(format!("microgeometry.azimuth_deg={azimuth}"));
        command.args(["--out", out]).output().unwrap()
    };
    let output = measured("face", "90");
    assert!(output.status.success(), "{}", stderr(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("by azimuth, steps of 90 deg: kernel of 368 x 368 patches"), "{text}");
    let own = ["audit.json", "azimuths.svg", "face.npz", "totals.csv", "totals.svg", "totals_by_azimuth.csv"];
    assert_eq!(names(&here.join("face")), own);
    let totals = fs::read_to_string(here.join("face/totals_by_azimuth.csv")).unwrap();
    let lines: Vec<Vec<&str>> = totals.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(
        lines[0][..6],
        ["from", "theta_deg", "phi_deg", "reflected", "reflected_beyond", "transmitted"]
    );
    assert_eq!(lines.len(), 1 + 2 * 4);
    for line in &lines[5..] {
        let is_along = ["90", "270"].contains(&line[2]);
        assert_eq!((line[0], line[5] == "0"), ("below", is_along), "{line:?}");
    }
    let audit: Value = serde_json::from_slice(&fs::read(here.join("face/audit.json")).unwrap()).unwrap();
    assert!(audit["by_azimuth"]["reciprocity_z"].as_f64().unwrap() < 1.3, "{audit}");

    // Without azimuths, what is in both is the same, but for the number of rays.
    let none = here.join("prisms.toml");
    let text = fs::read_to_string(&surface)
        .unwrap()
        .replace("azimuth_deg = 15\n", "rays = 640\nincidence_deg = [30]\n");
    fs::write(&none, text).unwrap();
    fs::copy(surface.with_extension("obj"), here.join("prisms.obj")).unwrap();
    let output =
        papilio().current_dir(here).args(["gonio", "prisms.toml", "--out", "turned"]).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(names(&here.join("turned")), ["audit.json", "face.npz", "totals.csv", "totals.svg"]);
    let [a, b] = ["face", "turned"].map(|name| fs::read(here.join(name).join("totals.csv")).unwrap());
    assert!(a == b);

    let display = "[[display.layers]]\nkind = \"diffuser\"\nmodel = \"microgeometry\"\nfile = \"face/face.npz\"\n[[display.layers]]\nkind = \
                   \"medium\"\nindex = 1.5\n[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 1, black = 0 }\n\
                   [lighting]\nilluminance_lx = 500\nspectrum = \"E\"\ndiffuse = 1\n";
    fs::write(here.join("d.toml"), display).unwrap();
    let run = |file: &str| {
        let set = format!("display.layers.0.file={file:?}");
        let output =
            papilio().current_dir(here).args(["run", "d.toml", "--json", "--set", &set]).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let result: Value = serde_json::from_slice(&output.stdout).unwrap();
        (result["views"].clone(), stderr(&output))
    };
    let ((views, notes), (same, none)) = (run("face/face.npz"), run("turned/face.npz"));
    assert_eq!(views, same);
    assert!(
        notes.contains("in steps of 90 deg; a layer of a display uses its mean over all azimuths"),
        "{notes}"
    );
    assert!(!none.contains("azimuth"), "{none}");

    for (azimuth, expected) in
        [("50", "not a whole number of steps of 50 deg"), ("5", "the finest whole step is 12 deg")]
    {
        let output = measured("refused", azimuth);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(expected) && message.contains("microgeometry.azimuth_deg"), "{message}");
        assert!(!here.join("refused").exists());
    }
}

/// A measurement that gets Ctrl-C keeps its finished parts, and ends in the same bytes as an uninterrupted
/// one. A preview does not use them.
#[cfg(unix)]
#[test]
fn an_interrupted_measurement_is_resumed() {
    let surface = Path::new(env!("CARGO_MANIFEST_DIR")).join("../surfaces/hemispheres.toml");
    let folder = tempfile::tempdir().unwrap();
    let [resumed, at_once, preview] = ["resumed", "at-once", "preview"].map(|name| folder.path().join(name));
    let command = |out: &Path, more: &[&str]| {
        let mut command = papilio();
        command.arg("gonio").arg(&surface).args(["--set", "microgeometry.rays=6400"]);
        command.args(["--set", "microgeometry.incidence_deg=[0]", "--threads", "1"]).args(more);
        command.arg("--out").arg(out).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    };
    let child = command(&resumed, &[]).spawn().unwrap();
    let journal = resumed.join("gonio.jsonl");
    while fs::read(&journal).unwrap_or_default().iter().filter(|byte| **byte == b'\n').count() < 3 {
        // A journal has a megabyte for each part: reading it often takes as long as the rays.
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("of 32 parts are finished and saved"), "{}", stderr(&output));
    assert_eq!(names(&resumed), ["gonio.jsonl"]);
    fs::create_dir(&preview).unwrap();
    fs::copy(&journal, preview.join("gonio.jsonl")).unwrap();

    let output = command(&resumed, &[]).output().unwrap();
    assert!(stderr(&output).contains("of 32 parts are known from the interrupted"), "{}", stderr(&output));
    assert!(command(&at_once, &[]).output().unwrap().status.success());
    assert_eq!(names(&resumed), names(&at_once));
    for name in ["totals.csv", "audit.json", "face.npz"] {
        assert!(fs::read(resumed.join(name)).unwrap() == fs::read(at_once.join(name)).unwrap(), "{name}");
    }
    let output = command(&preview, &["--preview"]).output().unwrap();
    assert!(!stderr(&output).contains("are known"), "{}", stderr(&output));
    let moved: Vec<String> =
        names(&preview).into_iter().filter(|name| name.starts_with("gonio.jsonl")).collect();
    assert_eq!(moved, ["gonio.jsonl.before"], "the journal of the longer measurement stays");
}

/// What cannot be measured leaves neither a journal nor a folder.
#[test]
fn a_measurement_that_fails_leaves_no_folder() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.toml");
    let text = "[microgeometry]\nsurface = \"height-map\"\nfile = \"heights.npy\"\n\
                pixel_um = [1.0]\nroad = \"waves\"\nindex_above = 1.0\nindex_below = 1.5\n";
    fs::write(&file, text).unwrap();
    // More heights than a phase screen may have.
    let head = "{'descr': '<f4', 'fortran_order': False, 'shape': (2100, 2100), }";
    let head = format!("{head:<117}\n");
    let heights = 0.1_f32.to_le_bytes().repeat(2100 * 2100);
    let file_of_heights = [b"\x93NUMPY\x01\0\x76\0", head.as_bytes(), &heights].concat();
    fs::write(folder.path().join("heights.npy"), file_of_heights).unwrap();
    let out = folder.path().join("out");
    let output = papilio().arg("gonio").arg(&file).arg("--out").arg(&out).output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(stderr(&output).contains("phase screen"), "{}", stderr(&output));
    assert!(!out.exists());
}

/// A sine of whole periods has no tilt: the light straight through it is J0^2 of its phase amplitude, at any
/// inclination, also if the sample was tilted. The plane of the least squares left 0.7685 instead of 0.4892 along
/// the normal.
#[test]
fn level_sines_that_repeat_keep_their_straight_light() {
    let folder = tempfile::tempdir().unwrap();
    let (columns, amplitude_um) = (64, 0.2);
    for (name, tilt_um) in [("level", 0.0), ("tilted", 3.0)] {
        let height = |column: i32| {
            let x = f64::from(column) / f64::from(columns);
            amplitude_um * (std::f64::consts::TAU * x).sin() + tilt_um * x
        };
        let row: Vec<String> = (0..columns).map(|column| height(column).to_string()).collect();
        fs::write(folder.path().join(format!("{name}.csv")), format!("{}\n", row.join(" ")).repeat(4))
            .unwrap();
        let text = format!(
            "[microgeometry]\nsurface = \"height-map\"\nfile = \"{name}.csv\"\npixel_um = 0.1875\nperiod = \"repeat\"\n\
             road = \"waves\"\nindex_below = 1.5\nwavelength_nm = [550]\nincidence_deg = [0, 60]\n"
        );
        let file = folder.path().join(format!("{name}.toml"));
        fs::write(&file, text).unwrap();
        let out = folder.path().join(name);
        let output = papilio().arg("gonio").arg(&file).arg("--out").arg(&out).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(stderr(&output).contains("um along x: the tilt is subtracted"), tilt_um > 0.0);
        let table = fs::read_to_string(out.join("waves.csv")).unwrap();
        let straight = |row: usize| -> f64 {
            let cells: Vec<&str> = table.lines().nth(row).unwrap().split(',').collect();
            cells[2].parse().unwrap()
        };
        for (row, path) in [(1, 0.5), (2, 1.5_f64.sqrt() - 0.5)] {
            let quarter = (std::f64::consts::PI * path * amplitude_um / 0.55).powi(2);
            // J0, by its series.
            let (mut term, mut bessel) = (1.0, 1.0);
            for k in 1..30 {
                term *= -quarter / f64::from(k * k);
                bessel += term;
            }
            // Beside its seam, a tilted sine is not quite straight.
            assert!((straight(row) - bessel * bessel).abs() < 1e-3, "{name}: {table}");
        }
        assert!((straight(1) - 0.4892).abs() < 1e-3, "{name}: {table}");
    }
}

/// A mesh of corner cubes with a grey mirror: rho^3 of the light along the normal returns, and all else is
/// absorbed. Its kernel is no layer.
#[test]
fn coated_corner_cubes_return_the_cube_of_their_reflectance() {
    let surface = Path::new(env!("CARGO_MANIFEST_DIR")).join("../surfaces/corner-cubes.toml");
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let mut command = papilio();
    command.current_dir(here).arg("gonio").arg(surface).args(["--out", "face"]);
    command.args(["--set", "microgeometry.rays=640", "--set", "microgeometry.incidence_deg=[0]"]);
    command.args(["--set", "microgeometry.coating={ kind = \"mirror\", reflectance = 0.8 }"]);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(String::from_utf8(output.stdout).unwrap().contains("absorbed, %"));
    assert_eq!(names(&here.join("face")), ["audit.json", "face.npz", "totals.csv", "totals.svg"]);
    let totals = fs::read_to_string(here.join("face/totals.csv")).unwrap();
    let lines: Vec<Vec<&str>> = totals.lines().map(|line| line.split(',').collect()).collect();
    let value = |name: &str| -> f64 {
        lines[1][lines[0].iter().position(|head| *head == name).unwrap()].parse().unwrap()
    };
    assert!(
        (value("reflected") - 0.512).abs() < 1e-9 && (value("absorbed") - 0.488).abs() < 1e-9,
        "{totals}"
    );
    let display = "[[display.layers]]\nkind = \"diffuser\"\nmodel = \"microgeometry\"\nfile = \
                   \"face/face.npz\"\n[[display.layers]]\nkind = \"medium\"\nindex = 1.5\n[display.pixel]\nmodel = \"uniform\"\nkind = \
                   \"lambertian\"\nreflectance = { white = 1, black = 0 }\n[lighting]\nilluminance_lx = 500\nspectrum = \"E\"\ndiffuse = 1\n";
    fs::write(here.join("d.toml"), display).unwrap();
    let output = papilio().current_dir(here).args(["run", "d.toml"]).output().unwrap();
    assert!(stderr(&output).contains("the kernel of a coated surface"), "{}", stderr(&output));
}

/// Surfaces that would take endless memory or time are refused at their key, before it is spent.
#[test]
fn endless_surfaces_are_refused() {
    for (name, sets, says) in [
        ("spheres", &["microgeometry.volume_fraction=1e-300"][..], "too far for rays to meet them"),
        ("etched-waves", &["microgeometry.rms_nm=1e6"], "are spikes"),
        (
            "etched-waves",
            &["microgeometry.rms_nm=7e4", "microgeometry.correlation_um=15"],
            "too many wavelengths for waves",
        ),
    ] {
        let surface = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../surfaces/{name}.toml"));
        let sets = sets.iter().flat_map(|set| ["--set", set]);
        let output = papilio().arg("gonio").arg(surface).arg("--json").args(sets).output().unwrap();
        let answer = stderr(&output);
        assert!(output.status.code() == Some(2) && answer.contains(says), "{name}: {answer}");
    }
}

#[test]
fn displays_are_no_surfaces() {
    let display = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/six-ink.toml");
    let output = papilio().arg("gonio").arg(display).output().unwrap();
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("not a surface") && message.contains("[microgeometry]"), "{message}");
}

/// Waves beside rays: their files, and the layer of a display from the kernel that was written.
#[test]
fn waves_and_layers_follow_from_a_surface() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let surface = "title = \"frosted\"\n[microgeometry]\nsurface = \"gaussian\"\nrms_nm = 50\ncorrelation_um = 4\nrays = 640\nincidence_deg = \
                   [0, 60]\nroad = \"both\"\nwavelength_nm = [450, 550]\n";
    fs::write(here.join("frosted.toml"), surface).unwrap();
    let output =
        papilio().current_dir(here).args(["gonio", "frosted.toml", "--out", "face"]).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(
        names(&here.join("face")),
        HEIGHTS
            .into_iter()
            .chain(["face.npz", "psd.csv", "psd.svg", "totals.csv", "totals.svg"])
            .chain(["waves-oblique.svg", "waves.csv", "waves.svg"])
            .collect::<Vec<_>>()
    );
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(
        table.contains("heights: rms")
            && table.contains("waves hold, rays do not")
            && table.contains("haze by rays")
            && table.contains("by waves of 550 nm at all inclinations"),
        "{table}"
    );
    let waves = fs::read_to_string(here.join("face/waves.csv")).unwrap();
    let head: Vec<&str> = waves.lines().next().unwrap().split(',').collect();
    let rows: Vec<Vec<&str>> = waves.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let text = |row: usize, name: &str| rows[row][head.iter().position(|column| *column == name).unwrap()];
    let value = |row: usize, name: &str| text(row, name).parse::<f64>().unwrap();
    assert!(
        waves.starts_with("wavelength_nm,g,straight,mirror,haze,haze_closed_form,straight_error,"),
        "{waves}"
    );
    // exp(-(2 pi 0.5 50/550)^2).
    let near = |row: usize, name: &str, expected: f64, error: &str| {
        assert!(
            (value(row, name) - expected).abs() < 4.5 * value(row, error) + 1e-3,
            "{row} {name}: {waves}"
        );
    };
    near(1, "straight", 0.92167, "straight_error");
    // The normal and 60 deg from above, then both from below, where 60 deg is beyond the critical angle; at
    // 450 and 550 nm each. From above at 60 deg exp(-(2 pi (sqrt(1.5) - 0.5) 50/550)^2) passes, and exp(-(4
    // pi 0.5 50/550)^2) is reflected; from below exp(-(4 pi 0.75 50/550)^2).
    assert_eq!(rows.len(), 8);
    near(3, "straight", 0.84251, "straight_error");
    near(3, "mirror", 0.72161, "mirror_error");
    near(7, "mirror", 0.47994, "mirror_error");
    assert_eq!((text(3, "from"), value(3, "theta_deg"), text(3, "holds")), ("above", 60.0, "waves"));
    assert_eq!([text(7, "from"), text(7, "straight"), text(7, "holds")], ["below", "", ""]);
    assert!(
        (value(3, "reflected") - 0.08918671).abs() < 1e-8 && value(3, "renormalisation") >= 1.0,
        "{waves}"
    );
    near(3, "haze", value(3, "haze_closed_form"), "haze_error");
    let display = "[[display.layers]]\nkind = \"diffuser\"\nmodel = \"microgeometry\"\nfile = \
                   \"face/face.npz\"\n[[display.layers]]\nkind = \"medium\"\nindex = 1.5\n[display.pixel]\nmodel = \"uniform\"\nkind = \
                   \"lambertian\"\nreflectance = { white = 1, black = 0 }\n[lighting]\nilluminance_lx = 500\nspectrum = \"E\"\ndiffuse = 1\n";
    fs::write(here.join("d.toml"), display).unwrap();
    let output = papilio().current_dir(here).args(["run", "d.toml", "--json"]).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    let white = result["views"][0]["states"]["white"]["Y"].as_f64().unwrap();
    assert!((white - 1.0).abs() < 1e-6, "a white paper returns all light: {white}");
    let wrong =
        papilio().current_dir(here).args(["run", "d.toml", "--set", "display.layers.1.index=1.6"]).output();
    let message = stderr(&wrong.unwrap());
    assert!(
        message.contains("between the indices 1 and 1.5, but here it lies between 1 and 1.6"),
        "{message}"
    );
}
