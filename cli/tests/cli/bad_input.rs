//! Wrong input: exit codes, messages with their place, nothing written.

use std::fs;

use papilio_figures::HAS_PNG;

use crate::common::{names, papilio_command as papilio, run_scenario as run, scenario, stderr};

#[test]
fn overflowing_numbers_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let output = run("indoor", &["--set", "display.diffuser.width=1e-150", "--out", out.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(!out.exists());
}

#[test]
fn wrong_input_exits_with_2_names_its_place_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let base = fs::read_to_string(scenario("indoor")).unwrap();
    let wrong = folder.path().join("wrong.toml");
    for (from, to, column, words) in [
        ("theta_deg = 8", "theta_degg = 8", 1, "did you mean `theta_deg`?"),
        ("thickness_nm = 38.6", "thickness_nm = -38.6", 39, "expected"),
        ("material = \"SiO2\"", "material = \"SiO3\"", 16, "SiO2"),
        ("red = 0.493", "red = 0.793", 8, "sum"),
        ("index = 1.5", "index = true", 9, "expected"),
    ] {
        assert!(base.contains(from), "{from}");
        let text = base.replacen(from, to, 1);
        let line = 1 + text.lines().position(|line| line.contains(to)).unwrap();
        fs::write(&wrong, text).unwrap();
        let out = folder.path().join("out");
        let output = papilio().arg("run").arg(&wrong).arg("--out").arg(&out).output().unwrap();
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(output.stdout.is_empty());
        let place = format!("wrong.toml:{line}:{column}\n");
        assert!(text.contains("error: ") && text.contains(&place) && text.contains(words), "{to}:\n{text}");
        assert!(!out.exists());
    }
}

#[test]
fn impossible_overrides_are_refused_by_name() {
    for set in ["display.pixel.film.9.thickness_nm=12", "viewer.theta=8", "display.glass.index.n=2", "seed"] {
        let output = run("indoor", &["--json", "--set", "viewer.theta_deg=20", "--set", set]);
        assert_eq!(output.status.code(), Some(2), "{set}");
        assert!(stderr(&output).contains("--set #2:1:"), "{set}:\n{}", stderr(&output));
    }
}

/// A lamp, a measurement and a picture whose names are those of results, in the folder for these, also by a link.
#[test]
fn results_are_not_written_over_their_inputs() {
    let data = scenario("data");
    let data = data.with_extension("");
    let coarse = ["--set", "spectrum.step_nm=20"];
    for (name, from, command, file, more) in [
        ("spectra.csv", "rgb-led.csv", "run", "indoor", &["--set", "lighting.spectrum=\"{input}\""][..]),
        ("fit.csv", "synthetic-film.csv", "fit", "fit", &["{input}"]),
        ("comparison.csv", "synthetic-panel.csv", "compare", "indoor", &["{input}"]),
        ("seen.png", "page.png", "image", "six-ink", &["{input}"]),
    ] {
        for is_linked in [false, true] {
            let folder = tempfile::tempdir().unwrap();
            let input = folder.path().join(name);
            let before = fs::read(data.join(from)).unwrap();
            fs::write(&input, &before).unwrap();
            let mut named = input.clone();
            if is_linked {
                named = folder.path().join("link").with_extension(input.extension().unwrap());
                #[cfg(unix)]
                std::os::unix::fs::symlink(&input, &named).unwrap();
                #[cfg(not(unix))]
                continue;
            }
            let named = named.to_str().unwrap();
            let mut program = papilio();
            program.arg(command).arg(scenario(file));
            program.args(more.iter().map(|word| word.replace("{input}", named)));
            let output = program.args(coarse).arg("--out").arg(folder.path()).output().unwrap();
            let said = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{command}: {said}");
            assert!(
                said.contains("is an input of the command") && said.contains("--out"),
                "{command}: {said}"
            );
            assert!(fs::read(&input).unwrap() == before, "{command}");
        }
    }
}

#[test]
fn missing_scenario_exits_with_2() {
    assert_eq!(run("indoor", &["--solver", "magic"]).status.code(), Some(2));
    assert_eq!(papilio().args(["run", "no-such-file.toml"]).output().unwrap().status.code(), Some(2));
    assert_eq!(papilio().arg("fly").output().unwrap().status.code(), Some(2));
}

/// What the arguments probably meant: names of files and commands, options, and files of another kind.
#[test]
fn slips_in_the_arguments_have_a_suggestion() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let shipped = scenario("indoor");
    fs::copy(&shipped, here.join("indoor.toml")).unwrap();
    let surface = shipped.parent().unwrap().join("../surfaces/hemispheres.toml");
    fs::copy(surface, here.join("bumps.toml")).unwrap();
    fs::write(here.join("photo.jpg"), b"\xff\xd8\xff\xe0\0\x10JFIF\0\xfe").unwrap();
    fs::write(here.join("drawing.svg"), "<svg xmlns='http://www.w3.org/2000/svg'/>").unwrap();
    fs::write(here.join("archive.zip"), b"PK\x03\x04\xff").unwrap();
    fs::create_dir_all(here.join("results/indoor")).unwrap();
    fs::write(here.join("results/indoor/result.json"), "{}").unwrap();
    fs::write(here.join("measured.csv"), "state,theta_deg,X,Y,Z\nwhite,8,1,1,1\n").unwrap();
    for (arguments, words) in [
        (&["run", "indor.toml"][..], &["there is no such file", "did you mean `indoor.toml`?"][..]),
        (&["run", "indoor"], &["did you mean `indoor.toml`?"]),
        (&["sweep", "indor.toml"], &["did you mean `indoor.toml`?"]),
        (&["gonio", "nothing-like-it.toml"], &["a surface, for example surfaces/hemispheres.toml"]),
        (&["run", "."], &["it is a folder", "scenarios/indoor.toml"]),
        (&["run", "bumps.toml"], &["this is a surface", "papilio gonio"]),
        (
            &["image", "photo.jpg"],
            &["this is a picture, a JPEG file", "papilio image photo.jpg --on six-ink"],
        ),
        (&["run", "drawing.svg"], &["this is a picture, an SVG file", "--on six-ink"]),
        (&["run", "archive.zip"], &["this file is not text in UTF-8"]),
        (&["run", "indoor.toml", "--set", "viewer.theta=30"], &["did you mean `theta_deg`?"]),
        (&["rnu", "indoor.toml"], &["a similar subcommand exists: 'run'"]),
        (&["diffuser", "fti", "x"], &["a similar subcommand exists: 'fit'"]),
        (&["cone"], &["this is an option: `papilio run ... --cone`"]),
        (
            &["compare", "results", "measured.csv"],
            &["contains no result.json", "did you mean `results/indoor`?"],
        ),
        (&["tolerance", "indoor.toml"], &["scenarios/tolerance.toml is an example"]),
        (
            &["compare", "results/indoor", "mesured.csv"],
            &["there is no such file", "expected a file that exists", "did you mean `measured.csv`?"],
        ),
        (
            &["diffuser", "inspect", "nothing.bsdf"],
            &["expected a file that exists", "give the path of the file"],
        ),
        (&["run", "indoor.toml", "--seed", "-1"], &["expected a whole number from 0 to 9223372036854775807"]),
        (&["run", "indoor.toml", "--threads", "x"], &["expected a whole number from 1 to 1024"]),
        (&["study", "sampling", "indoor.toml", "--paths", "3"], &["a whole number from 512 to 1073741824"]),
        (&["serve", "--port", "99999"], &["expected a whole number from 0 to 65535"]),
        (&["serve", "--listen", "here"], &["expected an IP address"]),
        (&["pixel", "indoor.toml", "--step", "x"], &["expected a step from 0.01 to 90 deg that divides 90"]),
        (&["sweep", "indoor.toml", "--shard", "3/2"], &["shard K of N with 1 <= K <= N"]),
        (
            &["sweep", "indoor.toml", "--axis", "viewer.theta_deg=0,8", "--columns", "foo"],
            &["there is no column `foo`", "expected columns of states.csv", "docs/metrics.md"],
        ),
        (
            &["sweep", "indoor.toml", "--axis", "viewer.theta_deg=0,8", "--axis", "viewer.theta_deg=9,10"],
            &["swept twice", "expected a key that no other axis has", "in one list"],
        ),
    ] {
        let output = papilio().current_dir(here).args(arguments).output().unwrap();
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        for words in words {
            assert!(said.contains(words), "{arguments:?}: {said}");
        }
        assert!(!said.contains("JFIF") && !said.contains("PK"), "{arguments:?}: a line of bytes: {said}");
    }
}

/// A title of nothing is none: the name of the file stands in its place.
#[test]
fn empty_title_is_the_name_of_the_file() {
    let output = run("indoor", &["--json", "--set", "title="]);
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(output.status.success() && result["title"] != "", "{}", stderr(&output));
    let mut pixel = papilio();
    pixel.arg("pixel").arg(scenario("indoor")).args(["--set", "title= "]);
    let output = pixel.current_dir(tempfile::tempdir().unwrap().path()).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("indoor"), "{text}");
}

#[test]
fn output_folder_that_cannot_be_created_exits_with_2() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "in the way").unwrap();
    let output = run("indoor", &["--out", file.join("below").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("is not a folder"), "{}", stderr(&output));
}

/// What the program was built without is said before anything is computed.
#[test]
fn png_option_is_refused_without_the_png_feature() {
    if !HAS_PNG {
        let folder = tempfile::tempdir().unwrap();
        let output = run("indoor", &["--png", "--out", folder.path().to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("feature `png`") && names(folder.path()).is_empty());
    }
}

#[test]
fn json_with_files_requires_out() {
    for flag in ["--cone", "--png"].into_iter().take(if HAS_PNG { 2 } else { 1 }) {
        let output = run("indoor", &["--json", flag]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("--out") && output.stdout.is_empty());
    }
}

/// What names and cells hold is shown and not sent to the terminal, and a pipe has the whole message.
#[test]
fn control_characters_of_quoted_input_are_not_printed() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let obeyed = |c: char| {
        (c.is_control() && c != '\n') || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    let file = scenario("indoor");
    let indoor = fs::read_to_string(&file).unwrap();
    fs::write(at("e5.csv"), "300,0\n400,\u{1b}[2J\u{1b}[31mX\n900,0\n").unwrap();
    fs::write(at("e5.toml"), indoor.replacen("spectrum = \"D65\"", "spectrum = \"e5.csv\"", 1)).unwrap();
    // An operating system command without its end: a pipe swallowed all that came after.
    fs::write(at("e3.toml"), format!("\"\\u001b]0;x\\n\\u009bA\\u202e\" = 1\n{indoor}")).unwrap();
    fs::write(at("e\u{1b}]0;\u{9b}\u{202e}.toml"), "nonsense").unwrap();
    fs::write(
        at("state.toml"),
        indoor.replacen("[lighting]", "[display.pixel.states]\n\"a\u{202e}b\" = { red = 1 }\n[lighting]", 1),
    )
    .unwrap();
    let cases = [
        ("e5.toml", "`\\u001b[2J\\u001b[31mX` is not a number"),
        ("e3.toml", "\\u001b]0;x\\n\\u009bA\\u202e"),
        ("e\u{1b}]0;\u{9b}\u{202e}.toml", "e\\u001b]0;\\u009b\\u202e.toml:1"),
        ("state.toml", "this name is not permitted"),
        ("none\u{1b}[2J.toml", "none\\u001b[2J.toml"),
    ];
    for (name, said) in cases {
        let output = papilio().args(["run", &at(name), "--json"]).output().unwrap();
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{name:?}: {text}");
        assert!(text.contains(said) && text.contains("-->"), "{name:?}: {text}");
        assert!(!text.chars().any(obeyed), "{name:?}: {text:?}");
    }
}

/// A state that a spreadsheet would compute is refused where it is named.
#[test]
fn state_names_are_not_formulas_in_csv_files() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("s.toml");
    let indoor = fs::read_to_string(scenario("indoor")).unwrap();
    for (name, is_good) in [("=HYPERLINK(1)", false), ("@SUM(1)", false), ("-5 V", true)] {
        let states = format!("[display.pixel.states]\n\"{name}\" = {{ red = 1 }}\n[lighting]");
        fs::write(&file, indoor.replacen("[lighting]", &states, 1)).unwrap();
        let output = papilio().args(["run", file.to_str().unwrap(), "--json"]).output().unwrap();
        assert_eq!(output.status.success(), is_good, "{name}: {}", stderr(&output));
        assert!(is_good || stderr(&output).contains("formula"), "{name}: {}", stderr(&output));
    }
}

/// Where no folder is named, the result of another hash stays, whatever command made it; the same result goes
/// to its own folder.
#[test]
fn result_of_another_hash_is_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let file = scenario("indoor").canonicalize().unwrap();
    let quick = ["--set", "spectrum.step_nm=20", "--set", "solver.relative_error=0.05"];
    let at = |command: &str, more: &[&str]| {
        let output = papilio()
            .current_dir(folder.path())
            .arg(command)
            .arg(&file)
            .args(quick)
            .args(more)
            .output()
            .unwrap();
        assert!(output.status.success(), "{command}: {}", stderr(&output));
        stderr(&output)
    };
    let folders = || names(&folder.path().join("out"));
    let read = |name: &str| fs::read(folder.path().join("out").join(name)).unwrap();
    let other = ["--set", "viewer.theta_deg=31"];
    assert!(!at("run", &[]).contains("note: out/indoor"));
    let first = read("indoor/result.json");
    let said = at("run", &other);
    assert!(said.contains("note: out/indoor contains the result of another scenario"), "{said}");
    assert_eq!(read("indoor/result.json"), first);
    let hash = |bytes: &[u8]| {
        let result: serde_json::Value = serde_json::from_slice(bytes).unwrap();
        result["hash"].as_str().unwrap()[..6].to_owned()
    };
    let beside = folders()[1].clone();
    assert_eq!(beside, format!("indoor-{}", hash(&read(&format!("{beside}/result.json")))));
    // The same again, and another command of the same scenario: the same folders.
    at("run", &other);
    at("pixel", &other);
    at("pixel", &[]);
    assert_eq!(folders(), ["indoor".to_owned(), beside.clone()]);
    assert!(read(&format!("{beside}/about.json")) != read("indoor/about.json"));
    // A folder that has but the table of another command.
    fs::remove_file(folder.path().join("out/indoor/result.json")).unwrap();
    let said = at("brdf", &["--step", "30", "--set", "viewer.theta_deg=32"]);
    assert!(said.contains("note: out/indoor contains"), "{said}");
    assert_eq!(folders().len(), 3);
    // compare says what it compares.
    let measured = "state,theta_deg,X,Y,Z\nwhite,31,1,1,1\n";
    fs::write(folder.path().join("m.csv"), measured).unwrap();
    let result = format!("out/{beside}");
    let compare = papilio().current_dir(folder.path()).args(["compare", &result, "m.csv"]).output().unwrap();
    let text = String::from_utf8(compare.stdout).unwrap();
    assert!(text.contains(&format!("simulated: {result}/result.json (hash {}", &beside[7..])), "{text}");
    assert!(text.contains("measured: m.csv"), "{text}");
    // A link to itself.
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("loop", folder.path().join("loop")).unwrap();
        let looped = papilio()
            .current_dir(folder.path())
            .arg("run")
            .arg(&file)
            .args(["--out", "loop"])
            .output()
            .unwrap();
        assert_eq!(looped.status.code(), Some(2));
        assert!(stderr(&looped).contains("is a link to a path that does not exist"), "{}", stderr(&looped));
    }
}

/// A name of nothing is called empty, and not the name of the folder.
#[test]
fn empty_name_of_a_file_is_called_empty() {
    for (file, command, key) in [
        ("six-ink", "image", "image.file"),
        ("page", "image", "image.regions"),
        ("measured-diffused", "run", "display.diffuser.file"),
        ("measured-diffused", "run", "display.diffuser.transmission"),
        ("front-light", "run", "lighting.front_light.spectrum"),
        ("../surfaces/prisms", "gonio", "microgeometry.file"),
        ("indoor", "run", "display.glass.index"),
    ] {
        let file = scenario(file);
        let set = format!("{key}=\"\"");
        let output = papilio().arg(command).arg(&file).args(["--set", &set]).output().unwrap();
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{key}: {said}");
        assert!(said.contains(" is empty\n") && said.contains(&format!("{key}=\"\"")), "{key}: {said}");
    }
    let output = papilio().arg("image").arg(scenario("six-ink")).arg("").output().unwrap();
    assert!(stderr(&output).contains("this file cannot be read: its name is empty"), "{}", stderr(&output));
}

/// A picture on the command line is looked for in the current folder alone, and named as it was written.
#[test]
fn missing_picture_is_named_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    fs::create_dir(here.join("scenarios")).unwrap();
    fs::copy(scenario("six-ink"), here.join("scenarios/six-ink.toml")).unwrap();
    fs::create_dir(here.join("scenarios/data")).unwrap();
    let inks = "data/synthetic-inks-6.csv";
    fs::copy(scenario("data").with_file_name(inks), here.join("scenarios").join(inks)).unwrap();
    let page = scenario("data").with_extension("").join("page.png");
    let image = |picture: &str| {
        let pixels = ["--set", "display.matrix.pixels=[20,30]", "--out", "out"];
        papilio()
            .current_dir(here)
            .args(["image", "scenarios/six-ink.toml", picture])
            .args(pixels)
            .output()
            .unwrap()
    };
    let said = stderr(&image("missing.jpg"));
    assert!(said.contains("--> missing.jpg\n") && !said.contains("scenarios/missing.jpg"), "{said}");
    // One beside the scenario is proposed, and not taken.
    fs::copy(&page, here.join("scenarios/photo.png")).unwrap();
    let beside = image("photo.png");
    let said = stderr(&beside);
    assert_eq!(beside.status.code(), Some(2), "{said}");
    assert!(
        said.contains("--> photo.png\n") && said.contains("did you mean `scenarios/photo.png`?"),
        "{said}"
    );
    // A name without an ending is a path, too.
    fs::copy(&page, here.join("photo")).unwrap();
    let plain = image("photo");
    assert!(plain.status.success(), "{}", stderr(&plain));
}

/// Settings of the computation are no quantities: a fit, a search and a tolerance analysis refuse them, a sweep does not.
#[test]
fn settings_of_the_computation_are_no_variables() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let indoor = fs::read_to_string(scenario("indoor")).unwrap();
    let measured = scenario("data").with_extension("").join("synthetic-film.csv");
    let studies = [
        ("fit", "[[fit.variables]]\nkey = \"{key}\"\nbounds = [1, 9]\n", "meter.scale"),
        (
            "optimize",
            "[[optimize.objectives]]\nmetric = \"white.Y\"\naim = \"maximise\"\n[[optimize.variables]]\nkey = \"{key}\"\nbounds = [1, 9]\n",
            "[display]",
        ),
        ("tolerance", "[[tolerance.keys]]\nkey = \"{key}\"\nuniform = { from = 1, to = 9 }\n", "[display]"),
    ];
    for (command, table, expected) in studies {
        for key in ["solver.seed", "solver.paths", "spectrum.step_nm", "measure.noise", "image.seed"] {
            let file = at("s.toml");
            fs::write(&file, format!("{indoor}\n{}", table.replace("{key}", key))).unwrap();
            let mut program = papilio();
            program.args([command, &file]);
            if command == "fit" {
                program.arg(&measured);
            }
            let output = program.args(["--out", &at("out")]).output().unwrap();
            let said = stderr(&output);
            assert_eq!(output.status.code(), Some(2), "{command} {key}: {said}");
            let words = format!("`{key}` is a setting, and no quantity");
            assert!(said.contains(&words) && said.contains(expected), "{command} {key}: {said}");
        }
    }
    let swept =
        ["--axis", "solver.seed=1,2", "--metrics", "white.Y", "--set", "spectrum.step_nm=50", "--json"];
    let output =
        papilio().arg("sweep").arg(scenario("indoor")).args(swept).args(["--out", &at("o")]).output();
    assert!(output.unwrap().status.success());
}

/// A measurement at other angles: the message has them as the key that computes them.
#[test]
fn angles_of_a_measurement_are_proposed() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(at("m.csv"), "state,theta_deg,X,Y,Z\nwhite,45,1,1,1\nblack,20,1,1,1\nwhite,20,1,1,1\n")
        .unwrap();
    let compare = |more: &[&str]| {
        let mut program = papilio();
        program.arg("compare").arg(scenario("indoor")).args([&at("m.csv"), "--out", &at("out")]);
        program.args(["--set", "spectrum.step_nm=50"]).args(more).output().unwrap()
    };
    let said = stderr(&compare(&[]));
    assert!(said.contains("those of the measurement are viewer.theta_deg = [20, 45]"), "{said}");
    assert!(compare(&["--set", "viewer.theta_deg = [20, 45]"]).status.success());
}
