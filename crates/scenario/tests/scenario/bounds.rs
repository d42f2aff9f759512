//! Limits of the size of a computation, and of quantities.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::common::{GOOD, changed, resolve};

fn problems(text: &str, folder: &Path, sets: &[&str]) -> Vec<String> {
    match resolve(text, folder, sets) {
        Ok(_) => Vec::new(),
        Err(errors) => errors.iter().map(|error| error.diagnostic.message.clone()).collect(),
    }
}

/// `GOOD` with `states` states, each with its own gap or with fractions only, and `sources` directed sources.
fn large(states: usize, own_gaps: bool, sources: usize) -> String {
    let (mut drives, mut lamps) = (String::new(), String::new());
    for i in 0..states {
        let drive = if own_gaps { format!("{{ gap_nm = {} }}", 100 + i) } else { "0.5".to_owned() };
        writeln!(drives, "s{i} = {{ red = {drive} }}").unwrap();
    }
    for _ in 1..sources {
        lamps += "[[lighting.directed]]\ntheta_deg = 5\nshare = 0\n";
    }
    let text = GOOD.replace("[lighting]", &format!("[display.pixel.states]\n{drives}[lighting]"));
    text.replace("[viewer]", &format!("{lamps}[viewer]"))
}

#[test]
fn computations_that_are_too_large_are_refused() {
    let step = |nm: f64| format!("spectrum.step_nm={nm}");
    // 258 states x 301 wavelengths x (250 + 2500 + 1000 (1 + 9)) bytes are 0.99 GB; one lamp more is 1.07 GB.
    let bare = Path::new("");
    assert!(problems(&large(250, false, 9), bare, &[&step(1.0)]).is_empty());
    for (lamps, sets, gigabytes) in [
        (
            10,
            vec![step(1.0)],
            "258 states x 301 wavelengths in 1 views and the light of 11 sources take about 1.1 GB",
        ),
        (
            9,
            vec!["viewer.theta_deg=[0, 10, 20]".to_owned(), step(1.0)],
            "in 3 views and the light of 10 sources take about 1.0 GB",
        ),
        (
            2,
            vec![step(1.0), "solver.method=monte-carlo".to_owned()],
            "in 1 views and the light of 3 sources take about 1.0 GB",
        ),
    ] {
        let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
        let refused = resolve(&large(250, false, lamps), bare, &sets).unwrap_err().to_string();
        for words in [gigabytes, "at most 1 GB", "a larger spectrum.step_nm", "--set #"] {
            assert!(refused.contains(words), "{words}: {refused}");
        }
    }
    // Red's, green's, blue's and dark's gap and 96 more, at 1001 wavelengths: 100 100.
    let text = large(96, true, 1);
    assert!(problems(&text, bare, &[&step(0.3125)]).is_empty());
    assert_eq!(problems(&text, bare, &[&step(0.3)]), ["these are 100100 film gaps x wavelengths"]);
}

#[test]
fn quantities_beyond_the_range_of_arithmetic_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    file("large.csv", "380,1001,0\n780,1001,0\n");
    file("opaque.csv", "380,1,1001\n780,1,1001\n");
    file("none.csv", "380,0.0009,0\n780,0.0009,0\n");
    file("bright.csv", "380,1\n780,1e31\n");
    file("faint.csv", "380,1e-31\n780,1e-31\n");
    file("elsewhere.csv", "380,1e-40\n720,1e-40\n780,1\n");
    let refused = |from: &str, to: &str| problems(&changed(&[(from, to)]), folder.path(), &[]);
    for material in ["\"large.csv\"", "\"opaque.csv\"", "\"none.csv\"", "{ n = 5e-4, k = 5e-4 }", "1e-4"] {
        let found = refused("\"Cr:Johnson\"", material);
        assert!(
            found.len() == 1 && found[0].starts_with("the refractive index is "),
            "{material}: {found:?}"
        );
    }
    assert!(refused("\"Cr:Johnson\"", "{ n = 1e-9, k = 1000 }").is_empty());
    assert_eq!(refused("\"Cr:Johnson\"", "1001"), ["1001 is out of range"]);
    for light in ["bright", "faint"] {
        let found = refused("\"D65\"", &format!("\"{light}.csv\""));
        assert!(
            found.len() == 1 && found[0].contains("largest value")
                || found[0].contains("the spectral value is"),
            "{light}: {found:?}"
        );
    }
    assert_eq!(refused("\"D65\"", "\"elsewhere.csv\""), ["this light is dark between 400 and 700 nm"]);
    for (from, to) in [
        ("illuminance_lx = 500", "illuminance_lx = 9e-7"),
        ("haze = 0.78", "width = 9e-7"),
        ("\"D65\"", "{ daylight_K = 3999 }"),
        ("\"D65\"", "{ daylight_K = 25001 }"),
    ] {
        let found = refused(from, to);
        assert!(found.len() == 1 && found[0].ends_with(" is out of range"), "{to}: {found:?}");
    }
    let said = "no k-correlation lobe has a haze of 0.000001 with regular_fraction = 0";
    assert_eq!(refused("haze = 0.78", "haze = 1e-6"), [said]);
    assert!(refused("haze = 0.78", "width = 1e-6").is_empty());
}
