//! Tests of edits of a scenario's text.

use serde_json::json;

use super::*;

const TEXT: &str = "# A display.\ntitle = \"A\"\n\n[display.glass]\nindex = 1.5 # BK7\n\n[display.pixel]\nmodel = \"film\"\nfilm = [\n  { material = \"SiO2\", thickness_nm = 38.6 }, # spacer\n  { material = \"air\", thickness_nm = \"gap\" },\n]\n\n[lighting]\npreset = \"indoor\"\n";

fn edited(text: &str, edits: serde_json::Value) -> String {
    let edits: Vec<Edit> = serde_json::from_value(edits).unwrap();
    edit(text, &edits).unwrap()
}

#[test]
fn text_without_edits_is_unchanged() {
    assert_eq!(edited(TEXT, json!([])), TEXT);
}

#[test]
fn number_is_set_and_keeps_its_comment() {
    let text = edited(
        TEXT,
        json!([
            { "op": "set", "path": "display.glass.index", "value": 1.52 },
            { "op": "set", "path": "display.pixel.film.0.thickness_nm", "value": 40 },
        ]),
    );
    assert_eq!(text, TEXT.replace("1.5 #", "1.52 #").replace("38.6", "40"));
}

#[test]
fn films_are_inserted_moved_and_removed() {
    let layer = json!({ "material": "AlOx", "thickness_nm": 9.5 });
    let more =
        edited(TEXT, json!([{ "op": "insert", "path": "display.pixel.film", "index": 1, "value": layer }]));
    // The comment stays at its item.
    assert!(more.contains("}, # spacer\n  { material = \"AlOx\", thickness_nm = 9.5 },"), "{more}");
    let moved = edited(&more, json!([{ "op": "move", "path": "display.pixel.film", "from": 1, "to": 0 }]));
    assert!(moved.find("AlOx") < moved.find("SiO2"), "{moved}");
    let less = edited(&moved, json!([{ "op": "remove", "path": "display.pixel.film.0" }]));
    assert_eq!(less.matches("material").count(), 2);
}

#[test]
fn array_of_the_preset_is_written_before_its_item_changes() {
    let text = edited(TEXT, json!([{ "op": "set", "path": "lighting.directed.0.theta_deg", "value": -35 }]));
    assert!(text.contains("[[lighting.directed]]\ntheta_deg = -35"), "{text}");
    assert!(text.contains("share = 0.5") && text.contains("preset = \"indoor\""), "{text}");
}

#[test]
fn missing_tables_are_created_and_arrays_of_tables_keep_their_order() {
    let front = |reflectance: f64| json!({ "reflectance": reflectance, "absorptance": 0.01 });
    let text = edited(
        TEXT,
        json!([
            { "op": "set", "path": "display.diffuser", "value": { "model": "k-correlation", "haze": 0.5 } },
            { "op": "insert", "path": "display.front", "value": front(0.1) },
            { "op": "insert", "path": "display.front", "index": 0, "value": front(0.2) },
            { "op": "move", "path": "display.front", "from": 0, "to": 1 },
            { "op": "set", "path": "display.diffuser.width", "value": 0.05 },
        ]),
    );
    assert!(text.contains("[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.05\n"), "{text}");
    assert!(text.find("0.1\n") < text.find("0.2\n"), "{text}");
    let none = edited(
        &text,
        json!([
            { "op": "remove", "path": "display.front.0" },
            { "op": "remove", "path": "display.front.0" },
            { "op": "remove", "path": "display.diffuser" },
            { "op": "remove", "path": "viewer.theta_deg" },
        ]),
    );
    assert!(none.contains("front = []") && !none.contains("haze") && !none.contains("viewer"), "{none}");
}

#[test]
fn impossible_paths_are_refused() {
    for edits in [
        json!([{ "op": "set", "path": "", "value": 1 }]),
        json!([{ "op": "set", "path": "title.x", "value": 1 }]),
        json!([{ "op": "set", "path": "display.pixel.film.7.n", "value": 1 }]),
        json!([{ "op": "set", "path": "title", "value": null }]),
        json!([{ "op": "move", "path": "display.pixel.film", "from": 0, "to": 2 }]),
        json!([{ "op": "insert", "path": "title", "value": 1 }]),
    ] {
        let edits: Vec<Edit> = serde_json::from_value(edits).unwrap();
        let errors = edit(TEXT, &edits).unwrap_err();
        assert_eq!(errors.iter().next().unwrap().path.as_deref(), Some(edits[0].path()));
    }
    assert!(edit("a = ", &[]).is_err());
}
