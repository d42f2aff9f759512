//! `[[display.front]]`, `[display.diffuser]` and `[display.glass]` are a short form of `[[display.layers]]`:
//! every example, written in both forms by the rule of docs/layers.md, is one scene, and its results have the
//! same bits.

use std::fs;
use std::sync::atomic::AtomicBool;

use papilio_display::Control;
use papilio_display::image::{Screen, SourceImage, image};
use papilio_display::scene::{Length, Scene};
use papilio_display::spatial::{crosstalk, mtf};
use papilio_scenario::{Edit, Resolved, Scenario, edit};
use papilio_testing::{everyday, sized};
use serde_json::{Value, json};

use crate::common::shipped;
use crate::examples::LIKE_OTHERS;

/// The list of layers of a display in the short form, with all its defaults filled in.
fn list(display: &Value) -> Vec<Value> {
    let with = |kind: &str, mut keys: Value, without: &[&str]| {
        without.iter().for_each(|key| drop(keys.as_object_mut().unwrap().remove(*key)));
        keys["kind"] = json!(kind);
        keys
    };
    let mut layers = Vec::new();
    for one in display["front"].as_array().into_iter().flatten() {
        layers.push(with("component", one.clone(), &["gap_mm"]));
        match one.get("gap_mm") {
            // Nothing between two interfaces: they are at the same place.
            Some(gap) if *gap == json!(0.0) => {}
            Some(gap) => layers.push(json!({ "kind": "medium", "index": 1.0, "thickness_mm": gap })),
            None => layers.push(json!({ "kind": "medium", "index": 1.0 })),
        }
    }
    let glass = &display["glass"];
    match display.get("diffuser") {
        None => layers.push(json!({ "kind": glass["surface"] })),
        Some(slab) if slab["model"] == "slab" => {
            layers.extend([json!({ "kind": "fresnel" }), with("slab", slab.clone(), &["model"])]);
        }
        Some(diffuser) => layers.push(with("diffuser", diffuser.clone(), &[])),
    }
    layers.push(with("medium", glass.clone(), &["surface"]));
    layers
}

/// An example in both forms; `None` if it is a list already.
fn forms(name: &str, sets: &[&str]) -> Option<[Scenario; 2]> {
    let text = fs::read_to_string(shipped().join(name)).unwrap();
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    let read = |text: &str, sets: &[String]| {
        Scenario::from_text(text, name, &shipped(), sets).unwrap_or_else(|e| panic!("{e}"))
    };
    let short = read(&text, &sets);
    let display = short.filled_at("display");
    if display.get("layers").is_some() {
        return None;
    }
    let remove = |key: &str| Edit::Remove { path: format!("display.{key}") };
    let layers = Edit::Set { path: "display.layers".to_owned(), value: list(&display).into() };
    let text = edit(&text, &[remove("front"), remove("diffuser"), remove("glass"), layers]).unwrap();
    // What `--set` changes above the pixel is in the list.
    let above = ["display.front", "display.diffuser", "display.glass"];
    let sets: Vec<String> =
        sets.into_iter().filter(|set| !above.iter().any(|key| set.starts_with(key))).collect();
    Some([short, read(&text, &sets)])
}

fn resolved(forms: &[Scenario; 2]) -> [Resolved; 2] {
    forms.each_ref().map(|form| form.resolve().unwrap_or_else(|e| panic!("{e}")))
}

/// The scene without the keys of missing lengths and of depolarisation, which are those of its own form.
fn without_keys(mut scene: Scene) -> Scene {
    for layer in &mut scene.display.layers {
        if let Length::Missing { key } = &mut layer.thickness {
            key.clear();
        }
        layer.depolarisation.key.clear();
    }
    scene
}

/// Results in which equal bits are equal texts.
fn text<T: std::fmt::Debug, E: std::fmt::Display>(result: Result<T, E>) -> String {
    format!("{:?}", result.unwrap_or_else(|e| panic!("{e}")))
}

#[test]
fn examples_in_both_forms_are_one_scene() {
    let mut count = 0;
    for entry in fs::read_dir(shipped()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if !name.ends_with(".toml")
            || sized(LIKE_OTHERS.iter().any(|other| name == format!("{other}.toml")), false)
        {
            continue;
        }
        let Some(forms) = forms(&name, &["spectrum.step_nm=50"]) else { continue };
        let [short, list] = resolved(&forms);
        assert_eq!(short.scene.display.panel().is_some(), list.scene.display.panel().is_some(), "{name}");
        assert!(without_keys(short.scene) == without_keys(list.scene), "{name}");
        assert!(short.patterns == list.patterns && short.sparkle == list.sparkle, "{name}");
        count += 1;
    }
    assert!(count > sized(38, 40), "{count}");
}

/// What is a panel, and what resembles one.
#[test]
fn panels_are_recognised_among_layers() {
    let pixel =
        "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.5, black = 0 }\n";
    let (sheet, air) = ("{ kind = \"component\", reflectance = 0.1 }", "{ kind = \"medium\", index = 1 }");
    let (glass, bare) = ("{ kind = \"medium\", index = 1.5 }", "{ kind = \"fresnel\" }");
    let lobe = "{ kind = \"diffuser\", model = \"lambertian\", transmittance = 0.9 }";
    let cases: [(&[&str], bool); 14] = [
        (&[glass], true),
        (&[bare, glass], true),
        (&["{ kind = \"ideal-ar\" }", glass], true),
        (&[lobe, glass], true),
        (&[lobe], true),
        (&[sheet, sheet, lobe, glass], true),
        (&[sheet, air, sheet, air, bare, glass], true),
        // A second sheet of air, glass in two sheets, a component in glass, a lobe on the pixel, a component
        // alone, an absorbing glass, a coating.
        (&[sheet, air, air, bare, glass], false),
        (&[lobe, glass, glass], false),
        (&[bare, glass, sheet], false),
        (&[bare, glass, lobe], false),
        (&[sheet], false),
        (&[lobe, "{ kind = \"medium\", internal_transmittance = 0.9 }"], false),
        (&["{ kind = \"coating\", film = [{ material = \"MgF2\", thickness_nm = 99 }] }", glass], false),
    ];
    for (layers, is_panel) in cases {
        let text = format!("[display]\nlayers = [{}]\n{pixel}", layers.join(", "));
        let list = Scenario::from_text(&text, "list.toml", &shipped(), &[]).unwrap().resolve();
        let list = list.unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(list.scene.display.panel().is_some(), is_panel, "{layers:?}");
    }
}

#[test]
fn results_of_both_forms_have_the_same_bits() {
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let both = |name: &str, sets: &[&str], compute: &dyn Fn(&Resolved) -> String| {
        let [short, list] = resolved(&forms(name, sets).unwrap()).map(|form| compute(&form));
        assert!(short == list, "{name} {sets:?}");
    };
    let run = |form: &Resolved| text(papilio_display::run(&form.scene, &control));
    let names =
        ["front-light", "single-pass", "indoor", "epaper", "slab", "reflecting-diffuser", "measured-h78"];
    for name in everyday(4, names) {
        let name = format!("{name}.toml");
        both(&name, &["spectrum.step_nm=40", "solver.method=adding"], &run);
        both(&name, &["spectrum.step_nm=40", "solver.method=monte-carlo", "solver.paths=64"], &run);
    }
    let adding = ["spectrum.step_nm=40", "solver.method=adding"];
    both("double-image.toml", &adding, &|form| text(mtf(&form.scene, &form.patterns, &control)));
    let coarse = [&adding[..], &["display.glass.thickness_mm=0.05", "solver.relative_error=0.01"]].concat();
    both("matrix.toml", &coarse, &|form| text(crosstalk(&form.scene, &form.patterns.text, &control)));
}

/// The approximation by its name, and by the medium of the angles.
#[test]
fn unrefracted_by_both_names_is_one_scene() {
    let resolved = |set: &str| {
        let file = shipped().join("indoor.toml");
        Scenario::load(&file, &[set.to_owned()]).and_then(|scenario| scenario.resolve())
    };
    let [one, other] = ["solver.approximation=unrefracted", "solver.angle_medium=unrefracted"].map(resolved);
    let [one, other] = [one.unwrap().scene, other.unwrap().scene];
    assert!(one == other && one != resolved("solver.seed=0").unwrap().scene);
    let set = "solver={ approximation = \"unrefracted\", angle_medium = \"glass\" }";
    let shown = resolved(set).unwrap_err().to_string();
    assert!(shown.contains("cannot be combined with angle_medium"), "{shown}");
}

#[test]
fn pictures_of_both_forms_have_the_same_bits() {
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let picture = SourceImage { columns: 8, pixels: (0..64).map(|k| [k as f32 / 64.0; 3]).collect() };
    let forms = forms("reader.toml", &["spectrum.step_nm=40", "display.matrix.pixels=[8, 8]"]).unwrap();
    let [short, list] = forms.map(|form| {
        let resolved = form.resolve_with(&picture).unwrap_or_else(|e| panic!("{e}"));
        let request = resolved.image.unwrap();
        text(image(&resolved.scene, &request.source, &request.settings, Screen::default(), &control))
    });
    assert!(short == list);
}
