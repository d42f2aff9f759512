//! `[optimize]`: what it takes, and what it answers to mistakes.

use std::path::Path;

use papilio_scenario::{Optimisation, Scenario, SearchAim, SearchMethod, SearchRange};

use crate::common::{GOOD, changed_in};

const SEARCH: &str = r#"
[optimize]
starts = 3
[[optimize.variables]]
key = "display.pixel.film.0.thickness_nm"
bounds = [5, 20]
[[optimize.variables]]
key = "display.pixel.film.0.material"
choices = ["Cr", "Cr:Johnson", { n = 3.0, k = 3.0 }]
[[optimize.variables]]
key = "display.pixel.area.red"
compensated_by = "display.pixel.area.green"
bounds = [0.3, 0.6]
[[optimize.conditions]]
name = "room"
[[optimize.conditions]]
name = "steep"
set = { "viewer.theta_deg" = [0, 20], lighting.directed.0.theta_deg = -30 }
weight = 3
[[optimize.objectives]]
metric = "gamut_percent_srgb"
aim = "maximise"
condition = "room"
[[optimize.objectives]]
state = "red"
spectrum = [[400, 0.0], [600, 0.1], [700, 0.5]]
[[optimize.constraints]]
metric = "white.Y"
at_least = 0.1
"#;

fn read(text: &str) -> Result<Optimisation, String> {
    Optimisation::from_text(text, "test.toml", Path::new(""), &[]).map_err(|errors| errors.to_string())
}

fn whole() -> String {
    format!("{GOOD}{SEARCH}")
}

#[test]
fn all_keys_of_optimize_are_read() {
    let search = read(&whole()).unwrap();
    assert_eq!((search.method, search.starts, search.seed), (SearchMethod::Gradient, 3, 0));
    let [thickness, material, area] = &search.variables[..] else { panic!("three variables") };
    assert_eq!((&thickness.range, thickness.own), (&SearchRange::Bounds(5.0, 20.0), Some(12.0)));
    assert_eq!(material.own, Some(1.0));
    assert_eq!(
        area.values(0.35),
        [
            ("display.pixel.area.red".to_owned(), 0.35.into()),
            ("display.pixel.area.green".to_owned(), (0.8 - 0.35).into()),
        ]
    );
    let [gamut, red] = &search.objectives[..] else { panic!("two objectives") };
    assert_eq!((gamut.parts.len(), gamut.aim), (1, SearchAim::Maximise));
    // One view in the room, two from steep, which count three times as much each.
    let weights: Vec<f64> = red.parts.iter().map(|(weight, _)| *weight).collect();
    assert_eq!(weights, [1.0 / 7.0, 3.0 / 7.0, 3.0 / 7.0]);
    assert_eq!(search.constraints.len(), 3);
    let names: Vec<&str> = search.constraints.iter().map(|one| one.quantity.name.as_str()).collect();
    assert_eq!(names, ["white.Y (room)", "white.Y (steep, view 0)", "white.Y (steep, view 1)"]);
    assert_eq!(search.quantities().len(), 7);
}

/// The hash tells searches apart, and scenarios of conditions.
#[test]
fn hash_changes_only_with_the_search() {
    let hash = |text: &str| read(text).unwrap().hash;
    let own = hash(&whole());
    assert_eq!(own, hash(&(whole() + "\n# a remark\n")));
    for (from, to) in
        [("bounds = [5, 20]", "bounds = [5, 21]"), ("haze = 0.78", "haze = 0.7"), ("= -30", "= -31")]
    {
        assert_ne!(own, hash(&changed_in(&whole(), &[(from, to)])), "{to}");
    }
}

/// A display with two states that shows a picture, and a search for the white that shows it best.
const PICTURED: &str = r#"
[display.pixel]
model = "uniform"
kind = "lambertian"
reflectance = { white = 0.6, black = 0.03 }
[display.matrix]
ppi = 100
pixels = [2, 1]
[lighting]
illuminance_lx = 500
spectrum = "D65"
[viewer]
theta_deg = 0
[image]
file = "picture.png"
[optimize]
[[optimize.variables]]
key = "display.pixel.reflectance.white"
bounds = [0.5, 0.8]
[[optimize.objectives]]
metric = "METRIC"
aim = "minimise"
"#;

/// The content of a picture belongs to a search that looks at it, and to its designs: a changed file is read
/// again.
#[test]
fn a_changed_picture_is_another_search() {
    let folder = tempfile::tempdir().unwrap();
    let write = |pixels: &[[u8; 3]]| {
        let mut bytes = Vec::new();
        papilio_formats::write_rgb_png(&mut bytes, 2, pixels, false).unwrap();
        std::fs::write(folder.path().join("picture.png"), bytes).unwrap();
    };
    let hashes = || {
        ["flip_mean", "white.Y"].map(|metric| {
            let text = PICTURED.replace("METRIC", metric);
            Optimisation::from_text(&text, "test.toml", folder.path(), &[]).unwrap().hash
        })
    };
    let picture = |set: &[&str]| {
        let set: Vec<String> = set.iter().map(|one| (*one).to_owned()).collect();
        let text = PICTURED.split("[optimize]").next().unwrap();
        let scenario = Scenario::from_text(text, "test.toml", folder.path(), &set).unwrap();
        scenario.resolve_with_picture().unwrap().image.unwrap().source.pixels
    };
    write(&[[255; 3], [0; 3]]);
    let (first, shown) = (hashes(), picture(&[]));
    assert_eq!(first, hashes());
    assert_eq!(shown, picture(&[]));
    assert!(shown[0][1] > 0.99 && shown[1][1] < 0.01, "{shown:?}");
    // It is kept, but not on another number of pixels or with other contents.
    assert_eq!(picture(&["display.matrix.pixels=[4,2]"]).len(), 8);
    assert_eq!(picture(&[]), shown);
    write(&[[255, 0, 0], [0; 3]]);
    assert_ne!(picture(&[]), shown);
    let second = hashes();
    assert_ne!(first[0], second[0]);
    assert_eq!(first[1], second[1], "a search that does not look at the picture");
}

#[test]
fn mistakes_are_reported_at_their_places() {
    for (from, to, said, line) in [
        ("[5, 20]", "[20, 5]", "the first bound, 20, is above the second, 5", "bounds = "),
        ("[5, 20]", "[5, 5]", "both bounds are 5", "bounds = "),
        ("[5, 20]", "[5]", "this list has the wrong length", "bounds = "),
        ("[5, 20]", "[-5, 20]", "-5 is out of range", "bounds = "),
        ("\"Cr\", ", "\"Xy\", ", "there is no material named `Xy`", "choices = "),
        (
            "key = \"display.pixel.film.0.thickness_nm\"",
            "key = \"display.pixel.film.0.thicknes_nm\"",
            "there is no key `thicknes_nm`",
            "key = ",
        ),
        (
            "key = \"display.pixel.film.0.thickness_nm\"",
            "key = \"optimize.starts\"",
            "cannot be variables",
            "key = ",
        ),
        ("bounds = [5, 20]", "", "none of `bounds` and `choices` is given", "[[optimize.variables]]"),
        (
            "key = \"display.pixel.film.0.material\"",
            "key = \"display.pixel.film.0.thickness_nm\"",
            "more than one variable sets",
            "key = ",
        ),
        (
            "key = \"display.pixel.film.0.material\"",
            "key = \"display.pixel.film.0\"",
            "`display.pixel.film.0` and `display.pixel.film.0.thickness_nm` set the same value",
            "key = ",
        ),
        ("compensated_by = \"display.pixel.area.green\"", "", "the areas sum to", "bounds = "),
        ("area.green\"\nbounds", "area.grey\"\nbounds", "no sub-pixel `grey`", "compensated_by = "),
        ("area.green\"\nbounds", "area\"\nbounds", "have no constant sum", "compensated_by = "),
        ("[0.3, 0.6]", "[0.3, 0.95]", "at this bound `display.pixel.area.green` is -0.15", "bounds = "),
        ("gamut_percent_srgb", "gamut_percent_srg", "did you mean `gamut_percent_srgb`?", "metric = "),
        ("\"white.Y\"", "\"wite.Y\"", "there is no state `wite`", "metric = "),
        ("condition = \"room\"", "condition = \"rom\"", "did you mean `room`?", "condition = "),
        ("condition = \"room\"", "view = 1", "there is no view 1", "view = "),
        ("name = \"steep\"", "name = \"room\"", "there are two conditions named `room`", "name = "),
        ("aim = \"maximise\"", "", "the key `aim` is missing", "[[optimize.objectives]]"),
        ("at_least = 0.1", "", "the key `at_least` is missing", "[[optimize.constraints]]"),
        ("[700, 0.5]", "[650, 0.5]", "`a list` reaches from 400 to 650 nm", "spectrum = "),
        ("state = \"red\"", "", "the key `state` is missing", "[[optimize.objectives]]"),
        ("theta_deg\" = [0, 20]", "theta\" = [0, 20]", "there is no key `theta` here", "set = "),
    ] {
        let text = changed_in(&whole(), &[(from, to)]);
        let Err(error) = read(&text) else { panic!("{to} is taken") };
        assert!(error.contains(said), "{to}: {error}");
        assert!(error.contains(line), "{to}: {error}");
    }
    let states = "model = \"film\"\ndefault_states = false\nstates = { white = { red = 1, green = 1 }, red = { red = 1 } }";
    for metric in ["contrast_ratio", "white.contrast"] {
        let limit = [
            ("model = \"film\"", states),
            ("gamut_percent_srgb", "red.Y"),
            ("\"white.Y\"", &format!("\"{metric}\"")),
        ];
        let error = read(&changed_in(&whole(), &limit)).unwrap_err();
        let said = format!("`{metric}` is not defined: there is no state `black`");
        assert!(error.contains(&said) && error.contains("the states of this pixel are"), "{error}");
    }
    assert!(read(GOOD).unwrap_err().contains("the scenario has no `[optimize]`"));
    let walk = changed_in(&whole(), &[("[optimize]", "[solver]\nmethod = \"monte-carlo\"\n[optimize]")]);
    assert!(read(&walk).unwrap_err().contains("follow the noise of the Monte Carlo solver"));
}
