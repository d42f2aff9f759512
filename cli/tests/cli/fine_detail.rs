//! The numbers of docs/fine-detail.md are those of its commands.

use std::fs;

use serde_json::Value;

use crate::common::{papilio_command, scenario, stderr};

fn page() -> String {
    fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/fine-detail.md")).unwrap()
}

/// Result of a command as JSON.
fn json(command: &str, name: &str) -> Value {
    let output = papilio_command().arg(command).arg(scenario(name)).arg("--json").output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[track_caller]
fn assert_states(page: &str, text: &str) {
    let flowing = page.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(flowing.contains(text), "expected on the page: {text}");
}

#[test]
fn laminate_thickness() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = papilio_command();
    command.arg("sweep").arg(scenario("laminate-thickness")).arg("--out").arg(folder.path());
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let table = fs::read_to_string(folder.path().join("sweep.csv")).unwrap();
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let head = rows.next().unwrap();
    let column = |name: &str| head.iter().position(|column| *column == name).unwrap();
    let key = column("display.glass.thickness_mm");
    let rows: Vec<Vec<&str>> =
        rows.filter(|row| ["0.1", "0.2", "0.3", "0.5", "0.8"].contains(&row[key])).collect();
    let cells = |name: &str, text: &dyn Fn(f64) -> String| {
        let column = column(name);
        rows.iter().map(|row| text(row[column].parse().unwrap())).collect::<Vec<_>>().join(" | ")
    };
    let page = page();
    let mtf = cells("white.mtf_nyquist_x", &|value| format!("{value:.3}"));
    assert_states(&page, &format!("| MTF of white at Nyquist | {mtf} |"));
    let three_digits = |value: f64| if value < 10.0 { format!("{value:.2}") } else { format!("{value:.1}") };
    let f50 = cells("white.f50_x_per_mm", &three_digits);
    assert_states(&page, &format!("| half of the modulation at, cycles per mm | {f50} |"));
}

#[test]
fn double_image() {
    let white = &json("mtf", "double-image")["views"][0]["states"]["white"];
    let number = |name: &str| white[name].as_f64().unwrap();
    let text = format!(
        "Along x half of the modulation is lost at {:.1} cycles per mm, along y at {:.1}.",
        number("f50_x_per_mm"),
        number("f50_y_per_mm")
    );
    assert_states(&page(), &text);
}

#[test]
fn black_on_white() {
    let contrast = &json("mtf", "laminated-text")["views"][0]["line_contrast"];
    let number = |name: &str| contrast[name].as_f64().unwrap();
    let text = format!(
        "a contrast of {:.3} in white on black, and {:.3} in black on white",
        number("white_1_x"),
        number("black_1_x")
    );
    assert_states(&page(), &text);
}

#[test]
fn crosstalk_of_figures() {
    let view = &json("crosstalk", "matrix")["views"][0];
    let page = page();
    let own = 100.0 * view["own_share_out"].as_f64().unwrap();
    assert_states(&page, &format!("{own:.0} % left that sub-pixel"));
    let pattern = |name: &str, key: &str| {
        let patterns = view["patterns"].as_array().unwrap();
        patterns.iter().find(|pattern| pattern["name"] == name).unwrap()[key].as_f64().unwrap()
    };
    let text = format!(
        "A patch has {:.0} % of the area of sRGB and a contrast of {:.0}, a stripe of one pixel {:.0} % and {:.1}, black text of 1.6 mm \
         a contrast of {:.0}",
        pattern("patch", "gamut_percent_srgb"),
        pattern("patch", "contrast_ratio"),
        pattern("stripe_1", "gamut_percent_srgb"),
        pattern("stripe_1", "contrast_ratio"),
        pattern("text", "contrast_ratio"),
    );
    assert_states(&page, &text);
}

#[test]
fn printed_filter() {
    let view = &json("crosstalk", "printed-filter")["views"][0];
    let page = page();
    let gamut = view["patterns"][0]["gamut_percent_srgb"].as_f64().unwrap();
    assert_states(&page, &format!("| gamut of patches, % of sRGB | 5.95 | 5.49 | 4.95 | {gamut:.2} |"));
    let own = 100.0 * view["own_share_in"].as_f64().unwrap();
    assert_states(
        &page,
        &format!("| light that entered through the own stripe, % | 99.0 | 95.2 | 90.4 | {own:.1} |"),
    );
}
