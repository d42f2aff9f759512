//! The pixel array.

use papilio_testing::Dice;

use super::{between, key, number};

/// Draws a pixel, and returns its name. `is_constant`: the medium above has the same index at all
/// wavelengths, as a BRDF needs.
pub(super) fn pixel(dice: &mut Dice, is_constant: bool) -> (&'static str, String) {
    let mut text = String::from("[display.pixel]\n");
    let name = match dice.below(9) {
        0..=2 => uniform(dice, &mut text, "mirror"),
        3 | 4 => uniform(dice, &mut text, "lambertian"),
        5 | 6 => film(dice, &mut text),
        7 if is_constant => paper(dice, &mut text),
        _ => table(&mut text),
    };
    (name, text)
}

fn uniform(dice: &mut Dice, text: &mut String, kind: &'static str) -> &'static str {
    *text += "model = \"uniform\"\n";
    key(text, "kind", format_args!("\"{kind}\""));
    let black = dice.between(0.0, 0.1);
    let white = if dice.one_in(4) {
        "\"data/synthetic-paper-white.csv\"".to_owned()
    } else {
        format!("{:.4}", dice.between(0.3, 1.0))
    };
    key(text, "reflectance", format_args!("{{ white = {white}, black = {black:.4} }}"));
    kind
}

fn film(dice: &mut Dice, text: &mut String) -> &'static str {
    *text += "model = \"film\"\nsubstrate = \"Al\"\ndefault_states = false\n";
    let red = dice.between(0.2, 0.5);
    let green = dice.between(0.2, 0.4);
    // With four decimals, so that the three sum to 1.
    let [red, green] = [red, green].map(|area| (area * 1e4).round() / 1e4);
    let blue = 1.0 - red - green;
    key(text, "area", format_args!("{{ red = {red:.4}, green = {green:.4}, blue = {blue:.4} }}"));
    between(dice, text, "fill_factor", [0.7, 1.0]);
    between(dice, text, "inactive_reflectance", [0.0, 0.1]);
    let [red, green, blue, dark] =
        [[240.0, 300.0], [170.0, 230.0], [120.0, 160.0], [5.0, 40.0]].map(|[a, b]| dice.between(a, b));
    let gaps = format_args!("{{ red = {red:.1}, green = {green:.1}, blue = {blue:.1}, dark = {dark:.1} }}");
    key(text, "gap_nm", gaps);
    let [nitride, metal, oxide] = [[30.0, 80.0], [5.0, 15.0], [20.0, 60.0]].map(|[a, b]| dice.between(a, b));
    let films = format_args!(
        "[{{ material = \"Si3N4\", thickness_nm = {nitride:.1} }}, {{ material = \"Cr:Johnson\", thickness_nm = \
         {metal:.1} }}, {{ material = \"SiO2\", thickness_nm = {oxide:.1} }}, {{ material = \"air\", thickness_nm = \
         \"gap\" }}]"
    );
    key(text, "film", films);
    *text += "[display.pixel.states]\nwhite = { red = 1.0, green = 1.0, blue = 1.0 }\n";
    key(text, "teal", format_args!("{{ green = {{ gap_nm = {:.1} }} }}", dice.between(140.0, 200.0)));
    "film"
}

fn paper(dice: &mut Dice, text: &mut String) -> &'static str {
    *text += "model = \"measured\"\n";
    *text += "file = { white = \"data/synthetic-paper-white.bsdf\", black = \"data/synthetic-paper-black.bsdf\" }\n";
    key(text, "normalise", dice.of(["\"none\"", "\"tis\""]));
    key(text, "extrapolate", dice.of(["\"none\"", "\"hold\""]));
    if dice.one_in(2) {
        *text += "spectrum = { white = \"data/synthetic-paper-white.csv\" }\n";
    }
    "paper"
}

fn table(text: &mut String) -> &'static str {
    *text += "model = \"table\"\nfile = \"data/synthetic-pixel.csv\"\nangles = \"glass\"\n";
    "table"
}

/// Draws a spectrum of light.
pub(super) fn spectrum(dice: &mut Dice, text: &mut String) {
    let light = dice.of([
        "\"D65\"",
        "\"A\"",
        "\"E\"",
        "{ daylight_K = 5500 }",
        "{ planck_K = 3000 }",
        "{ led_nm = 550, width_nm = 90 }",
    ]);
    key(text, "spectrum", light);
}

/// Draws an azimuth.
pub(super) fn azimuth(dice: &mut Dice, text: &mut String, name: &str) {
    number(text, name, dice.between(-180.0, 360.0));
}
