//! Files of a laboratory as they are: scans, lists, downloads; where paths in `--set` begin.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Runs the program in a folder.
fn papilio_in(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_papilio"))
        .env("NO_COLOR", "1")
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

/// Standard output and standard error of what went well.
fn done(folder: &Path, arguments: &[&str]) -> (String, String) {
    let output = papilio_in(folder, arguments);
    let text = |bytes| String::from_utf8(bytes).unwrap();
    let (out, err) = (text(output.stdout), text(output.stderr));
    assert!(output.status.success(), "{arguments:?}\n{err}");
    (out, err)
}

/// What is said of the user's mistake.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = papilio_in(folder, arguments);
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}\n{err}");
    err
}

/// Paper below a diffuser, in a lamp and diffuse light.
const SCENE: &str = "[display.diffuser]\nDIFFUSER\n[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\n\
                     reflectance = { white = 0.6, black = 0.05 }\n[lighting]\npreset = \"indoor\"\n";

/// A k-correlation lobe with T = 0.9 of the whole lobe, 1/sr.
fn lobe(theta_deg: f64, width: f64) -> f64 {
    let beta = theta_deg.to_radians().sin();
    0.9 * width / (2.0 * std::f64::consts::PI * (width * width + beta * beta).powf(1.5))
}

/// A folder with a scan of the lobe, every 0.5 deg.
fn with_scan(header: &str, width: f64) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let rows: String =
        (0..=180).map(|k| 0.5 * f64::from(k)).map(|deg| format!("{deg},{:.8}\n", lobe(deg, width))).collect();
    fs::write(folder.path().join("scan.csv"), format!("{header}{rows}")).unwrap();
    folder
}

fn luminance_factors(folder: &Path, diffuser: &str, solver: &str) -> [f64; 2] {
    fs::write(folder.join("s.toml"), SCENE.replace("DIFFUSER", diffuser)).unwrap();
    // Monte Carlo: five standard errors are the tolerance of the test.
    let error = if solver == "adding" { "0.001" } else { "0.002" };
    let error = format!("solver.relative_error={error}");
    let (out, _) = done(folder, &["run", "s.toml", "--json", "--solver", solver, "--set", &error]);
    let result: serde_json::Value = serde_json::from_str(&out).unwrap();
    ["white", "black"].map(|state| result["views"][0]["states"][state]["Y"].as_f64().unwrap())
}

/// A scan of a lobe that is shift-invariant gives the display of that lobe, in both solvers: two independent
/// ways to the same numbers.
#[test]
fn scan_of_a_lobe_is_the_diffuser_of_that_lobe() {
    let folder = with_scan("theta_deg,btdf\n", 0.1);
    let here = folder.path();
    let scan = "model = \"measured\"\nfile = \"scan.csv\"\nextrapolate = \"glass\"";
    let exact =
        luminance_factors(here, "model = \"k-correlation\"\nwidth = 0.1\ntransmittance = 0.9", "adding");
    for (solver, tolerance) in [("adding", 1e-3), ("monte-carlo", 1e-2)] {
        let found = luminance_factors(here, scan, solver);
        for (found, exact) in found.iter().zip(exact) {
            assert!((found / exact - 1.0).abs() < tolerance, "{solver}: {found} {exact}");
        }
    }
    let (_, err) = done(here, &["run", "s.toml"]);
    assert!(
        err.contains("note: scan.csv: a scan at normal incidence") && err.contains("shift-invariant"),
        "{err}"
    );
    assert!(!err.contains("warning"), "{err}");
}

/// Columns that do not state the part: the diffuser asks for `part`, and the command line for `--part`.
#[test]
fn part_of_a_scan_is_stated_in_the_scenario_and_on_the_command_line() {
    let folder = with_scan("theta_deg,bsdf\n", 0.1);
    let here = folder.path();
    let measured = "model = \"measured\"\nfile = \"scan.csv\"\n";
    fs::write(here.join("s.toml"), SCENE.replace("DIFFUSER", measured)).unwrap();
    let says = refused(here, &["run", "s.toml"]);
    assert!(
        says.contains("no front transmission") && says.contains("part = \"front-transmission\""),
        "{says}"
    );
    let stated = luminance_factors(here, &format!("{measured}part = \"front-transmission\""), "adding");
    assert!(stated[0] > 0.1);
    done(
        here,
        &[
            "run",
            "s.toml",
            "--set",
            "display.diffuser={ model = \"measured\", file = \"scan.csv\", part = \"front-transmission\" }",
        ],
    );
    let (out, err) = done(here, &["diffuser", "inspect", "scan.csv"]);
    assert!(
        out.contains("Reflection from the front") && err.contains("--part front-transmission"),
        "{out}{err}"
    );
    for arguments in [
        &["inspect", "scan.csv"][..],
        &["convert", "scan.csv", "film.csv"],
        &["fit", "scan.csv", "--model", "k-correlation-3"],
    ] {
        let all = [&["diffuser"], arguments, &["--part", "front-transmission"]].concat();
        let (out, err) = done(here, &all);
        assert!(err.contains("normal incidence"), "{err}");
        match arguments[0] {
            "inspect" => {
                assert!(out.contains("Transmission from the front") && out.contains("haze"), "{out}")
            }
            "fit" => assert!(out.contains("width = 0.100"), "{out}"),
            _ => {}
        }
    }
    let (out, _) = done(here, &["diffuser", "inspect", "film.csv"]);
    assert!(out.contains("Transmission from the front"), "{out}");
    let says = refused(here, &["diffuser", "inspect", "film.csv", "--part", "back-reflection"]);
    assert!(says.contains("one of its parts: front transmission"), "{says}");
}

/// A file of two numbers a row, without names, is a scan if the part is stated.
#[test]
fn scan_without_names_needs_the_part() {
    let folder = with_scan("", 0.1);
    let says = refused(folder.path(), &["diffuser", "inspect", "scan.csv"]);
    assert!(says.contains("theta_deg,btdf") && says.contains("--part front-transmission"), "{says}");
    let (out, _) = done(folder.path(), &["diffuser", "inspect", "scan.csv", "--part", "front-transmission"]);
    assert!(out.contains("scan at normal incidence"), "{out}");
}

/// A file of three wavelengths has the level of each: at these, the display is that of a file with this
/// wavelength alone.
#[test]
fn wavelengths_of_a_file_have_their_own_level() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let levels = [(450, 0.5), (550, 0.7), (650, 0.9)];
    let mut all = "theta_i,phi_i,theta_o,phi_o,wavelength,btdf\n".to_owned();
    let mut each = levels.map(|_| "theta_i,phi_i,theta_o,phi_o,btdf\n".to_owned());
    for (theta_i, theta_o, phi) in
        (0..7).flat_map(|i| (0..31).flat_map(move |o| (0..12).map(move |p| (i, o, p))))
    {
        let [from, to, azimuth] = [10 * theta_i, 3 * theta_o, 30 * phi];
        let [beta, sin] = [from, to].map(|deg| f64::from(deg).to_radians().sin());
        let (y, x) = f64::from(azimuth).to_radians().sin_cos();
        let squared = (sin * x + beta).powi(2) + (sin * y).powi(2);
        let f = 0.3 / (2.0 * std::f64::consts::PI * (0.09 + squared).powf(1.5));
        for ((nm, level), one) in levels.iter().zip(&mut each) {
            all += &format!("{from},0,{to},{azimuth},{nm},{:.8}\n", level * f);
            *one += &format!("{from},0,{to},{azimuth},{:.8}\n", level * f);
        }
    }
    let factors = |name: &str, file: &str| {
        fs::write(here.join(name), file).unwrap();
        let scene = SCENE.replace("DIFFUSER", &format!("model = \"measured\"\nfile = \"{name}\""));
        fs::write(here.join("s.toml"), scene + "[spectrum]\nrange_nm = [450, 650]\nstep_nm = 100\n").unwrap();
        let (out, _) = done(here, &["run", "s.toml", "--json"]);
        let result: serde_json::Value = serde_json::from_str(&out).unwrap();
        let white = &result["views"][0]["states"]["white"]["reflectance_factor"];
        [0, 1, 2].map(|k| {
            white[k].as_f64().unwrap_or_else(|| panic!("{:?}", result["views"][0]["states"]["white"]))
        })
    };
    let together = factors("three.csv", &all);
    for (k, one) in papilio_testing::everyday(2, each.iter().enumerate()) {
        let alone = factors("one.csv", one)[k];
        assert!((together[k] / alone - 1.0).abs() < 1e-6, "{k}: {} {alone}", together[k]);
    }
    let (_, err) = done(here, &["run", "s.toml", "--set", "display.diffuser.file=three.csv"]);
    assert!(err.contains("the level of each of the 3 wavelengths"), "{err}");
}

/// A constant BRDF of 0.3 per sr, measured to 80 deg in all directions, is reciprocal and reflects 0.3 pi at
/// every inclination. The last lobe is used beyond 80 deg, which is said.
#[test]
fn constant_brdf_that_ends_at_80_deg_is_reciprocal_and_whole() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let mut table = "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,brdf\n".to_owned();
    for (from, to) in (0..=8).flat_map(|from| (0..=8).map(move |to| (10 * from, 10 * to))) {
        (0..12).for_each(|k| table.push_str(&format!("{from},180,{to},{},0.3\n", 30 * k)));
    }
    fs::write(here.join("constant.csv"), table).unwrap();
    let (out, _) = done(here, &["diffuser", "inspect", "constant.csv", "--json"]);
    let audit: serde_json::Value = serde_json::from_str(&out).unwrap();
    let channel = &audit["parts"][0]["channels"][0];
    assert_eq!(channel["measured_to_theta_deg"], 80.0, "{channel}");
    let differences = ["reciprocity_rms", "reciprocity_worst"].map(|name| channel[name].as_f64().unwrap());
    assert!(differences.iter().all(|one| *one < 1e-9), "{differences:?}");
    let scene = "[display.glass]\nindex = 1.0\n[display.pixel]\nmodel = \"measured\"\nfile = { white = \"constant.csv\" }\n[lighting]\ndiffuse = 1.0\n\
                 [viewer]\ntheta_deg = [0, 60, 85]\n";
    fs::write(here.join("s.toml"), scene).unwrap();
    let (out, err) = done(here, &["run", "s.toml", "--json"]);
    assert!(err.contains("the last incidence below 90 deg is 80 deg"), "{err}");
    let result: serde_json::Value = serde_json::from_str(&out).unwrap();
    for view in result["views"].as_array().unwrap() {
        let y = view["states"]["white"]["Y"].as_f64().unwrap();
        assert!((y - 0.3 * std::f64::consts::PI).abs() < 1e-3, "{}: {y}", view["theta_deg"]);
    }
}

/// Paths in `--set` begin at the current folder, or else at the folder of the scenario; paths in the file at
/// its folder.
#[test]
fn path_in_set_is_relative_to_the_current_folder() {
    let folder = tempfile::tempdir().unwrap();
    let [designs, mine] = ["designs", "mine"].map(|name| folder.path().join(name));
    [&designs, &mine].iter().for_each(|path| fs::create_dir(path).unwrap());
    fs::write(mine.join("Cr.csv"), "wl,n\n0.38,2\n0.78,3\n\nwl,k\n0.38,3\n0.78,3.3\n").unwrap();
    fs::write(designs.join("Cr-there.csv"), "nm,n,k\n380,2,3\n780,3,3.3\n").unwrap();
    let new = papilio_in(folder.path(), &["new", "office", "designs/s.toml"]);
    assert!(new.status.success());
    let y = |arguments: &[&str]| {
        let (out, err) =
            done(folder.path(), &[&["run", "designs/s.toml", "--json", "--set"], arguments].concat());
        let result: serde_json::Value = serde_json::from_str(&out).unwrap();
        (result["views"][0]["states"]["white"]["Y"].as_f64().unwrap(), err)
    };
    let key = "display.pixel.film.1.material";
    let (here, err) = y(&[&format!("{key}=mine/Cr.csv")]);
    assert!(!err.contains("current folder"), "{err}");
    // The same numbers in a file of the scenario's folder, with a note.
    let (there, err) = y(&[&format!("{key}=Cr-there.csv")]);
    assert!(
        err.contains("there is no Cr-there.csv in the current folder")
            && err.contains("designs/Cr-there.csv"),
        "{err}"
    );
    assert!((here - there).abs() < 1e-12, "{here} {there}");
    // The current folder may be the scenario's, however its path is written.
    let scenario = designs.join("s.toml");
    let set = format!("{key}=Cr-there.csv");
    let (_, err) = done(&designs, &["run", scenario.to_str().unwrap(), "--json", "--set", &set]);
    assert!(!err.contains("current folder"), "{err}");
    let says = refused(folder.path(), &["run", "designs/s.toml", "--set", &format!("{key}=mine/none.csv")]);
    assert!(says.contains("tried mine/none.csv and designs/mine/none.csv"), "{says}");
    // In the file, the path begins at its folder; the message states the path that was tried, and the right
    // one.
    let text = fs::read_to_string(designs.join("s.toml")).unwrap();
    fs::write(designs.join("s.toml"), text.replace("Cr:Johnson", "mine/Cr.csv")).unwrap();
    let says = refused(folder.path(), &["run", "designs/s.toml"]);
    assert!(says.contains("tried designs/mine/Cr.csv") && says.contains("write ../mine/Cr.csv"), "{says}");
}

/// The best design of a search with a file in `--set` can be computed from its own folder.
#[test]
fn file_in_set_is_found_from_the_best_design() {
    let folder = tempfile::tempdir().unwrap();
    let designs = folder.path().join("designs");
    fs::create_dir(&designs).unwrap();
    fs::write(folder.path().join("front.csv"), "380,0.01\n780,0.02\n").unwrap();
    let search = "\n[optimize]\nstarts = 1\nevaluations = 12\n[[optimize.variables]]\nkey = \"display.pixel.film.1.thickness_nm\"\n\
                  bounds = [10, 14]\n[[optimize.objectives]]\nmetric = \"white.Y\"\naim = \"maximise\"\n";
    assert!(papilio_in(folder.path(), &["new", "d8-included", "designs/s.toml"]).status.success());
    let text = fs::read_to_string(designs.join("s.toml")).unwrap();
    fs::write(designs.join("s.toml"), text + search).unwrap();
    let set = "display.front.0.reflectance=front.csv";
    let (out, _) =
        done(folder.path(), &["optimize", "designs/s.toml", "--no-check", "--out", "out/best", "--set", set]);
    assert!(out.contains("10 to 14 (at its end)"), "less chromium is brighter: {out}");
    let best = fs::read_to_string(folder.path().join("out/best/best.toml")).unwrap();
    assert!(best.contains("front.csv\""), "{best}");
    done(folder.path(), &["run", "out/best/best.toml", "--json"]);
}
