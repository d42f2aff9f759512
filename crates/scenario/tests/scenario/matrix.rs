//! `[display.matrix]` and the lengths of a display: what they resolve to, and what is refused.

use std::fs;
use std::path::Path;

use crate::common::{GOOD, LAYERED, changed, resolve, shipped};
use papilio_display::DisplayError;
use papilio_display::scene::{Display, Length, Matrix, Rectangle};
use papilio_scenario::{Resolved, Scenario};

/// The valid scenario with this matrix.
fn with_matrix(keys: &str) -> String {
    changed(&[("[display.pixel]", &format!("[display.matrix]\n{keys}\n[display.pixel]"))])
}

fn resolved(text: &str, sets: &[&str]) -> Resolved {
    resolve(text, Path::new(""), sets).unwrap_or_else(|e| panic!("{e}"))
}

fn matrix(keys: &str, sets: &[&str]) -> Matrix {
    resolved(&with_matrix(keys), sets).scene.display.matrix.unwrap()
}

/// The errors of a matrix, and the place of the first.
fn refused(keys: &str, sets: &[&str]) -> (Option<(usize, usize)>, String) {
    let Err(errors) = resolve(&with_matrix(keys), Path::new(""), sets) else {
        panic!("no error: {keys} {sets:?}")
    };
    let first = errors.iter().next().unwrap();
    (first.place.line_column(), errors.to_string())
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12, "{found} {expected}");
}

/// Paper with a printed filter.
const PRINTED: &str = r#"[display.glass]
thickness_mm = 0.2
surface = "fresnel"

[display.matrix]
pitch_um = [120, 90]

[display.matrix.filter]
height_um = 30
transmittance = { red = 0.4, green = 0.6, blue = 0.3 }

[display.pixel]
model = "uniform"
kind = "lambertian"
reflectance = { white = 0.6, black = 0.03, grey = 0.2 }
"#;

#[test]
fn pitch_is_a_number_a_list_or_pixels_per_inch() {
    assert_eq!(matrix("pitch_um = 84.5", &[]).pitch_mm, [0.0845; 2]);
    assert_eq!(matrix("pitch_um = [100, 50]", &[]).pitch_mm, [0.1, 0.05]);
    let [x, y] = matrix("ppi = 300", &[]).pitch_mm;
    close(x, 25.4 / 300.0);
    assert_eq!(x, y);
    // One that is set replaces the other one of the file.
    assert_eq!(matrix("ppi = 300", &["display.matrix.pitch_um=50"]).pitch_mm, [0.05; 2]);
    let plain = matrix("ppi = 300", &["display.matrix.pixels=[600, 800]"]);
    assert_eq!((plain.pixels, plain.filter), (Some([600, 800]), None));
}

/// Stripes stand in the order of the areas, shrunk about their middles.
#[test]
fn layouts_have_the_areas_of_the_pixel() {
    let areas = [("red", 0.5), ("green", 0.3), ("blue", 0.2)];
    for layout in ["", "layout = \"stripe\"", "layout = \"quad\"", "layout = \"pentile\""] {
        let matrix = matrix(&format!("ppi = 300\n{layout}"), &["display.pixel.fill_factor=0.8"]);
        assert_eq!(matrix.sub_pixels.len(), 3);
        for (sub_pixel, (name, area)) in matrix.sub_pixels.iter().zip(areas) {
            assert_eq!(sub_pixel.name, name);
            close(sub_pixel.fraction, 0.8 * area);
            close(sub_pixel.window.area(), 0.8 * area);
        }
        close(matrix.inactive_fraction(), 0.2);
        if !layout.contains("quad") && !layout.contains("pentile") {
            let red = matrix.sub_pixels[0].window.rectangles[0];
            close(red.x[0], 0.05);
            close(red.x[1], 0.45);
            assert_eq!(red.y, [0.0, 1.0]);
        }
    }
    let one = "area = { red = 0.5, green = 0.3, blue = 0.2 }\ngap_nm = { red = 275.9, green = 192.3, blue = 137.8, dark = 20 }";
    let single = with_matrix("ppi = 300\nlayout = \"single\"").replace(
        one,
        "area = { red = 1 }\ngap_nm = { red = 275.9, dark = 20 }\nstates = { white = { red = 1 } }",
    );
    let sub_pixels = resolved(&single, &[]).scene.display.matrix.unwrap().sub_pixels;
    assert_eq!(sub_pixels[0].window.rectangles, [Rectangle::WHOLE]);
}

#[test]
fn rectangles_come_from_the_scenario_or_a_file() {
    let rectangles = "subpixel = { red = [[0, 0, 0.5, 1]], blue = [[0.5, 0, 0.7, 0.5], [0.5, 0.5, 0.7, 1]], green = [[0.7, 0, 1, 1]] }";
    let found = matrix(&format!("ppi = 300\n{rectangles}"), &[]);
    let names: Vec<&str> = found.sub_pixels.iter().map(|one| one.name.as_str()).collect();
    assert_eq!(names, ["red", "green", "blue"], "the order of the pixel");
    assert_eq!(found.sub_pixels[2].window.rectangles.len(), 2);
    close(found.sub_pixels[1].window.area(), 0.3);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("windows.csv");
    let rows = "name,x0,y0,x1,y1\nred,0,0,0.5,1\nblue,0.5,0,0.7,0.5\nblue,0.5,0.5,0.7,1\ngreen,0.7,0,1,1\n";
    fs::write(&file, rows).unwrap();
    let text = with_matrix("ppi = 300\nsubpixel_file = \"windows.csv\"");
    let of_file = resolve(&text, folder.path(), &[]).unwrap();
    assert_eq!(of_file.scene.display.matrix.as_ref(), Some(&found));
    assert!(of_file.canonical["inputs"]["windows.csv"].is_string(), "a part of the hash");
    // Areas may be rounded.
    let rounded = rectangles.replace("0.5, 1]], blue", "0.4991, 1]], blue");
    let rounded = matrix(&format!("ppi = 300\n{rounded}"), &[]).sub_pixels;
    close(rounded[0].window.area(), 0.4991);
    assert_eq!(rounded[0].fraction, 0.5);
    for (rows, says) in [
        (rows.replace("blue,0.5,0,", "blu,0.5,0,"), "did you mean `blue`?"),
        (rows.replace("blue,0.5,0,", "blu,0.5,0,"), "windows.csv:3:1"),
        (rows.replace("0.7,0.5", "0.7,1.5"), "windows.csv:3"),
        (rows.replace("blue,0.5,0,0.7", "blue,0.4,0,0.7"), "overlap"),
        (rows.replace("blue,0.5,0,0.7", "blue,0.4,0,0.7"), "windows.csv:3:1"),
        (rows.replace("green,0.7,0,1", "green,0.7,0,0.9"), "windows.csv:5:1"),
        ("name,x0,y0,x1,y1\n".to_owned(), "no rows"),
    ] {
        fs::write(&file, rows).unwrap();
        let errors = resolve(&text, folder.path(), &[]).unwrap_err().to_string();
        assert!(errors.contains(says), "{errors}");
    }
    fs::remove_file(&file).unwrap();
    assert!(resolve(&text, folder.path(), &[]).is_err());
}

#[test]
fn filter_defines_sub_pixels_and_states_of_paper() {
    let scene = resolved(PRINTED, &[]).scene;
    let matrix = scene.display.matrix.unwrap();
    assert_eq!(matrix.pitch_mm, [0.12, 0.09]);
    for (i, sub_pixel) in matrix.sub_pixels.iter().enumerate() {
        close(sub_pixel.window.rectangles[0].x[0], i as f64 / 3.0);
        close(sub_pixel.fraction, 1.0 / 3.0);
    }
    let filter = matrix.filter.unwrap();
    assert_eq!((filter.height_mm, filter.transmittance[1][0]), (0.03, 0.6));
    let states: Vec<&str> = filter.states.iter().map(|state| state.name.as_str()).collect();
    assert_eq!(states, ["white", "black", "red", "green", "blue", "cyan", "magenta", "yellow"]);
    // In the states of the pixel, white and black.
    assert_eq!(filter.states[2].pixel_states, [0, 1, 1]);
    assert_eq!(filter.states[5].pixel_states, [1, 0, 0]);
    let sets = [
        "display.matrix.states.red={ red = \"grey\", green = \"black\", blue = \"black\" }",
        "display.matrix.states.dim={ red = \"grey\", green = \"grey\", blue = \"grey\" }",
    ];
    let states = resolved(PRINTED, &sets).scene.display.matrix.unwrap().filter.unwrap().states;
    assert_eq!((states.len(), &states[2].pixel_states[..]), (9, &[2, 1, 1][..]));
    assert_eq!((states[8].name.as_str(), &states[8].pixel_states[..]), ("dim", &[2, 2, 2][..]));
    // The windows of a filter may leave clear area.
    let windows = "display.matrix.subpixel={ red = [[0, 0, 0.3, 1]], green = [[0.3, 0, 0.6, 1]], blue = [[0.6, 0, 0.8, 1]] }";
    let matrix = resolved(PRINTED, &[windows]).scene.display.matrix.unwrap();
    close(matrix.inactive_fraction(), 0.2);
}

#[test]
fn wrong_filters_are_refused() {
    for (set, says) in [
        ("display.matrix.filter.height_um=201", "which is 200 um thick"),
        ("display.matrix.filter.height_um=-1", "-1 is out of range"),
        ("display.matrix.filter.transmittance.red=40", "not per cent"),
        ("display.matrix.filter.transmittance={ }", "no parts"),
        ("display.matrix.states.x={ red = \"white\" }", "the keys `green` and `blue` are missing"),
        (
            "display.matrix.states.x={ red = \"white\", green = \"whit\", blue = \"black\" }",
            "did you mean `white`?",
        ),
        (
            "display.matrix.states.x={ red = \"white\", green = \"white\", blue = \"black\", lime = \"black\" }",
            "no sub-pixel `lime`",
        ),
        ("display.pixel.reflectance={ bright = 0.6 }", "bright = { red = \"bright\""),
        ("display.matrix.layout=single", "needs a single sub-pixel"),
        ("display.matrix.layout=rgbw", "needs the sub-pixels red, green, blue and white"),
    ] {
        let errors = resolve(PRINTED, Path::new(""), &[set]).unwrap_err().to_string();
        assert!(errors.contains(says), "{set}: {errors}");
    }
    let (_, errors) = refused("ppi = 300\nstates = { red = { red = \"white\" } }", &[]);
    assert!(errors.contains("there is none") && errors.contains("[display.pixel.states]"), "{errors}");
    // The parts of a filter over a film are the film's sub-pixels.
    let film =
        "ppi = 300\nfilter = { height_um = 5, transmittance = { red = 0.5, green = 0.5, bleu = 0.5 } }";
    let (_, errors) = refused(film, &[]);
    assert!(errors.contains("did you mean `blue`?") && errors.contains("`blue` is missing"), "{errors}");
}

/// Keys of the matrix, line and column of the error, and parts of its text. The table begins in line 19.
const WRONG: &[(&str, (usize, usize), &[&str])] = &[
    ("pitch_um = 0", (20, 12), &["0 is out of range", "above 0, at most 1e6 (um)"]),
    ("pitch_um = -84", (20, 12), &["-84 is out of range"]),
    ("pitch_um = [84]", (20, 12), &["a list of two, [x, y]"]),
    ("pitch_um = [84, 0]", (20, 17), &["0 is out of range"]),
    ("pitch_um = \"84\"", (20, 12), &["this is a string"]),
    ("ppi = 0", (20, 7), &["0 is out of range"]),
    ("ppi = 300\npitch_um = 84", (19, 1), &["more than one of `pitch_um` and `ppi`"]),
    ("layout = \"stripe\"", (19, 1), &["none of `pitch_um` and `ppi`"]),
    ("ppi = 300\nlayout = \"strip\"", (21, 10), &["did you mean `stripe`?"]),
    (
        "ppi = 300\nlayout = \"rgbw\"",
        (21, 10),
        &["needs the sub-pixels red, green, blue and white", "red, green, blue: those of"],
    ),
    ("ppi = 300\nlayout = \"single\"", (21, 10), &["needs a single sub-pixel"]),
    ("ppi = 300\npixels = [600]", (21, 10), &["[columns, rows]"]),
    ("ppi = 300\npixels = [600, 0]", (21, 16), &["0 is out of range"]),
    ("ppi = 300\nsubpixels = 3", (21, 1), &["did you mean `subpixel`?"]),
    (
        "ppi = 300\nlayout = \"stripe\"\nsubpixel_file = \"x.csv\"",
        (21, 10),
        &["more than one of `layout`, `subpixel` and `subpixel_file`"],
    ),
    ("ppi = 300\nsubpixel = { red = [[0, 0, 0.5]] }", (21, 21), &["[x0, y0, x1, y1]"]),
    ("ppi = 300\nsubpixel = { red = [[0.5, 0, 0, 1]] }", (21, 21), &["no area", "x0 below x1"]),
    ("ppi = 300\nsubpixel = { red = [[0, 0, 1.5, 1]] }", (21, 28), &["1.5 is out of range", "from 0 to 1"]),
    ("ppi = 300\nsubpixel = { red = [[-0.1, 0, 0.5, 1]] }", (21, 22), &["-0.1 is out of range"]),
    (
        "ppi = 300\nsubpixel = { rde = [[0, 0, 0.5, 1]] }",
        (21, 14),
        &["no sub-pixel `rde`", "did you mean `red`?"],
    ),
    (
        "ppi = 300\nsubpixel = { red = [[0, 0, 0.5, 1]], green = [[0.4, 0, 0.7, 1]], blue = [[0.7, 0, 0.9, 1]] }",
        (21, 47),
        &["[0, 0, 0.5, 1] and [0.4, 0, 0.7, 1] overlap"],
    ),
    (
        "ppi = 300\nsubpixel = { red = [[0, 0, 0.502, 1]], green = [[0.502, 0, 0.802, 1]], blue = [[0.802, 0, 1, 1]] }",
        (21, 12),
        &["the rectangles of `red` cover 0.502 of the pixel", "0.5 within 0.001", "`blue` cover 0.198"],
    ),
    (
        "ppi = 300\nsubpixel = { red = [[0, 0, 0.5, 1]], green = [[0.5, 0, 0.8, 1]] }",
        (21, 12),
        &["the rectangles of `blue` cover 0 of the pixel"],
    ),
];

#[test]
fn wrong_matrices_are_refused_at_their_places() {
    let mut wrong = Vec::new();
    for (keys, place, says) in WRONG {
        let (at, shown) = refused(keys, &[]);
        if at != Some(*place) || !says.iter().all(|words| shown.contains(words)) {
            wrong.push(format!("{keys}: expected at {place:?}, {says:?}\n{shown}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
    let (_, missing) = refused("ppi = 300\nsubpixel_file = \"missing.csv\"", &[]);
    assert!(missing.contains("requested at test.toml:21:17"), "{missing}");
    // The file alone is valid.
    for (keys, set, says) in [
        ("ppi = 300\nlayout = \"pentile\"", "display.pixel.gap_nm.blue=1", ""),
        (
            "ppi = 300\nlayout = \"stripe\"",
            "display.matrix.subpixel={ red = [[0, 0, 1, 1]] }",
            "cover 1 of the pixel",
        ),
        (
            "ppi = 300\nsubpixel = { red = [[0, 0, 0.5, 1]], green = [[0.5, 0, 0.8, 1]], blue = [[0.8, 0, 1, 1]] }",
            "display.pixel.fill_factor=0.9",
            "0.45 within 0.001",
        ),
    ] {
        match resolve(&with_matrix(keys), Path::new(""), &[set]) {
            Ok(_) => assert!(says.is_empty(), "{set}"),
            Err(errors) => {
                assert!(!says.is_empty() && errors.to_string().contains(says), "{errors}");
                assert!(errors.iter().all(|error| error.place.name == "--set #1"), "{errors}");
            }
        }
    }
}

/// Lengths of a display, or the missing key.
fn lengths(text: &str, sets: &[&str]) -> Result<Vec<f64>, String> {
    let display = resolved(text, sets).scene.display;
    match display.lengths_mm() {
        Ok(lengths) => Ok(lengths),
        Err(DisplayError::MissingLength { key, .. }) => Err(key),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn lengths_of_a_panel_are_its_gaps_and_its_glass() {
    assert_eq!(lengths(GOOD, &[]), Err("display.glass.thickness_mm".to_owned()));
    let glass = "display.glass.thickness_mm=0.5";
    assert_eq!(lengths(GOOD, &[glass]), Err("display.front.0.gap_mm".to_owned()));
    assert_eq!(lengths(GOOD, &[glass, "display.front.0.gap_mm=0.2"]), Ok(vec![0.2, 0.5]));
    assert_eq!(lengths(GOOD, &[glass, "display.front.0.gap_mm=0"]), Ok(vec![0.0, 0.5]));
    // A component that only absorbs returns no light.
    assert_eq!(lengths(GOOD, &[glass, "display.front.0.reflectance=0"]), Ok(vec![0.0, 0.5]));
    // The gap below an absorbing component matters under one that reflects.
    let two = "display.front=[{ reflectance = 0.1, gap_mm = 1 }, { absorptance = 0.1 }]";
    assert_eq!(lengths(GOOD, &[glass, two]), Err("display.front.1.gap_mm".to_owned()));
    // The same panel as general layers.
    let absorbing = "display.glass.internal_transmittance=0.9";
    assert_eq!(lengths(GOOD, &[glass, absorbing, "display.front.0.gap_mm=0.2"]), Ok(vec![0.2, 0.5]));
    assert_eq!(lengths(GOOD, &[glass, absorbing]), Err("display.front.0.gap_mm".to_owned()));
    let slab = changed(&[(
        "model = \"k-correlation\"\nhaze = 0.78\ntotal_transmittance = 0.9",
        "model = \"slab\"\noptical_thickness = 1\nanisotropy = 0.9",
    )]);
    let sets = [glass, "display.front=[]"];
    assert_eq!(lengths(&slab, &sets), Err("display.diffuser.thickness_mm".to_owned()));
    assert_eq!(
        lengths(&slab, &[&sets[..], &["display.diffuser.thickness_mm=0.1"]].concat()),
        Ok(vec![0.1, 0.5])
    );
}

/// The lowest missing length is reported first; interfaces without a medium between them are at the same
/// place.
#[test]
fn lengths_of_general_layers_are_those_of_their_media() {
    let mut sets: Vec<String> = Vec::new();
    for (key, mm) in [("10", 0.4), ("7", 0.3), ("6", 0.2), ("4", 0.1)] {
        let sets_so_far: Vec<&str> = sets.iter().map(String::as_str).collect();
        assert_eq!(lengths(LAYERED, &sets_so_far), Err(format!("display.layers.{key}.thickness_mm")));
        sets.push(format!("display.layers.{key}.thickness_mm={mm}"));
    }
    let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
    assert_eq!(lengths(LAYERED, &sets), Ok(vec![0.0, 0.7, 0.1, 0.2, 0.3, 0.0, 0.4, 0.0]));
    // Media above all interfaces that scatter or reflect have no effect on places.
    let air = "{ kind = \"medium\", index = 1 }";
    let text = format!(
        "display.layers = [{air}, {{ kind = \"component\", absorptance = 0.1 }}, {air}, {{ kind = \"medium\", thickness_mm = 2 }}]\n{}",
        &LAYERED[LAYERED.find("[display.pixel]").unwrap()..]
    );
    assert_eq!(lengths(&text, &[]), Ok(vec![0.0, 0.0, 2.0]));
}

#[test]
fn foil_over_an_air_gap_needs_the_gap() {
    let text = fs::read_to_string(shipped().join("measured-h78.toml")).unwrap();
    let resolved = |sets: &[&str]| {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        Scenario::from_text(&text, "h78.toml", &shipped(), &sets).unwrap().resolve().unwrap()
    };
    let last = |display: &Display| display.layers[display.layers.len() - 2].thickness.clone();
    let sets = ["display.glass.thickness_mm=1", "display.diffuser.mounting=air"];
    let display = resolved(&sets).scene.display;
    assert_eq!(last(&display), Length::Missing { key: "display.diffuser.gap_mm".to_owned() });
    let display = resolved(&[sets[0], sets[1], "display.diffuser.gap_mm=0.3"]).scene.display;
    assert_eq!(last(&display), Length::Mm(0.3));
    let laminated = resolved(&[sets[0], "display.diffuser.mounting=laminated"]).scene.display;
    assert_eq!(last(&laminated), Length::Mm(0.0));
    let wrong = ["display.diffuser.gap_mm=0.3".to_owned()];
    let errors = Scenario::from_text(&text, "h78.toml", &shipped(), &wrong).unwrap().resolve().unwrap_err();
    assert!(errors.to_string().contains("add mounting = \"air\""), "{errors}");
}

/// A layout of `--set` replaces rectangles of the file, and says so; a bare face directly above a diffuser is
/// noted, too.
#[test]
fn what_has_no_effect_is_noted() {
    let rectangles =
        "subpixel = { red = [[0, 0, 0.5, 1]], green = [[0.5, 0, 0.8, 1]], blue = [[0.8, 0, 1, 1]] }";
    let text = with_matrix(&format!("ppi = 300\n{rectangles}"));
    let notes = |sets: &[&str]| resolved(&text, sets).notes.join("\n");
    assert!(notes(&["display.matrix.layout=stripe"]).contains("replaces display.matrix.subpixel"));
    assert!(!notes(&["display.matrix.ppi=200"]).contains("replaces"));
    let layers = |face: &str| {
        format!(
            "[[display.layers]]\nkind = \"fresnel\"\n{face}[[display.layers]]\nkind = \"diffuser\"\nmodel = \"k-correlation\"\n\
             width = 0.05\ntransmittance = 0.9\n[[display.layers]]\nkind = \"medium\"\nindex = 1.5\n[display.pixel]\nmodel = \"uniform\"\n\
             kind = \"mirror\"\nreflectance = {{ white = 0.5 }}\n[lighting]\npreset = \"office\"\n"
        )
    };
    let film = "[[display.layers]]\nkind = \"medium\"\nindex = 1.5\n";
    for (text, noted) in [(layers(""), true), (layers(film), false)] {
        let notes = resolved(&text, &[]).notes.join("\n");
        assert_eq!(notes.contains("this face has no effect"), noted, "{notes}");
    }
}

/// Errors that name a key are shown at its place, with what is missing.
#[test]
fn missing_length_is_located() {
    let resolved = resolved(GOOD, &[]);
    let error = resolved.scene.display.lengths_mm().unwrap_err();
    assert!(error.to_string().contains("`display.glass.thickness_mm` is missing"), "{error}");
    let located = resolved.located(&error).unwrap();
    // All at once, in the order of the text.
    let places: Vec<_> = located.iter().map(|one| one.place.line_column()).collect();
    assert_eq!(places, [Some((7, 1)), Some((16, 1))], "{located}");
    for (key, one) in ["display.front.0.gap_mm", "display.glass.thickness_mm"].into_iter().zip(located.iter())
    {
        assert_eq!(one.path.as_deref(), Some(key));
        assert!(one.to_string().contains(&format!("the key `{key}` is missing")), "{located}");
    }
}

/// Lengths and matrix change neither the layers nor the pixel, so that colours stay the same to the last bit.
#[test]
fn matrix_and_lengths_change_no_layer() {
    let plain = resolved(GOOD, &[]);
    let placed = resolved(
        &with_matrix("ppi = 300\nlayout = \"pentile\""),
        &["display.glass.thickness_mm=0.5", "display.front.0.gap_mm=0.1"],
    );
    assert_ne!(plain.hash, placed.hash);
    assert_eq!(plain.notes, placed.notes, "no note that the thickness has no effect");
    let [mut one, mut other] = [plain.scene, placed.scene];
    assert_ne!(one, other);
    for scene in [&mut one, &mut other] {
        for layer in &mut scene.display.layers {
            layer.thickness = Length::Mm(0.0);
        }
        scene.display.matrix = None;
    }
    assert_eq!(one, other);
}

/// The canonical form is a scenario with the same hash.
#[test]
fn canonical_form_of_a_matrix_reads_back_with_the_same_hash() {
    let rectangles = "pitch_um = [80, 90]\npixels = [6, 8]\nsubpixel = { red = [[0, 0, 0.5, 1]], green = [[0.5, 0, 0.8, 1]], blue = [[0.8, 0, 1, 1]] }";
    for text in [with_matrix(rectangles), with_matrix("ppi = 300"), PRINTED.to_owned()] {
        let first = resolved(&text, &[]);
        let mut canonical = first.canonical.clone();
        canonical.as_object_mut().unwrap().remove("inputs");
        assert_eq!(resolved(&toml::to_string(&canonical).unwrap(), &[]).hash, first.hash);
    }
}
