//! Light and viewer.

use papilio_testing::Dice;

use super::pixel::{azimuth, spectrum};
use super::{between, key, number};

/// Draws the sources and the viewer, and returns their name. `is_lobe`: over the lobe of a panel, a front
/// light may have a distribution.
pub(super) fn lighting(dice: &mut Dice, is_lobe: bool) -> (String, String) {
    let mut text = String::from("[lighting]\n");
    if dice.one_in(12) {
        let preset = dice.of(["indoor", "sunny", "daylight", "iec-ring", "d8-excluded", "45-0"]);
        key(&mut text, "preset", format_args!("\"{preset}\""));
        text += &viewer(dice);
        return (preset.to_owned(), text);
    }
    number(&mut text, "illuminance_lx", dice.log_between(10.0, 1e5));
    if dice.one_in(2) {
        spectrum(dice, &mut text);
    }
    // Fractions in thousandths, which sum to 1: diffuse light, a first source, a second source.
    let [diffuse, first, second] = match dice.below(5) {
        0 => [1000, 0, 0],
        1 => [0, 1000, 0],
        2 => [0, 400, 600],
        3 => [300, 700, 0],
        _ => [200, 500, 300],
    };
    key(&mut text, "diffuse", share(diffuse));
    let mut names = vec![];
    if diffuse > 0 {
        names.push("diffuse".to_owned());
    }
    let guide = (dice.one_in(8)).then(|| front_light(dice, is_lobe));
    for thousandths in [first, second].into_iter().filter(|share| *share > 0) {
        names.push(light(dice, &mut text, thousandths));
    }
    if let Some((name, guide)) = guide {
        names.push(name);
        text += &guide;
    }
    text += &viewer(dice);
    (names.join("+"), text)
}

fn share(thousandths: u32) -> String {
    format!("{:.3}", f64::from(thousandths) / 1000.0)
}

/// Draws a source with this fraction of the light, and returns its name.
fn light(dice: &mut Dice, text: &mut String, thousandths: u32) -> String {
    match dice.below(12) {
        0..=2 => beam(dice, text, thousandths),
        3 | 4 => disc(dice, text, thousandths),
        kind => {
            *text += "[[lighting.environment]]\n";
            key(text, "share", share(thousandths));
            environment(dice, text, kind, thousandths)
        }
    }
}

fn beam(dice: &mut Dice, text: &mut String, thousandths: u32) -> String {
    *text += "[[lighting.directed]]\n";
    key(text, "share", share(thousandths));
    let theta = match dice.below(8) {
        0 => 89.9,
        1 => dice.between(80.0, 89.0),
        _ => dice.between(-80.0, 80.0),
    };
    number(text, "theta_deg", theta);
    azimuth(dice, text, "phi_deg");
    if dice.one_in(4) {
        *text += "normal_to_beam = true\n";
    }
    own_spectrum(dice, text);
    format!("beam {theta:.0}")
}

fn disc(dice: &mut Dice, text: &mut String, thousandths: u32) -> String {
    *text += "[[lighting.directed]]\n";
    key(text, "share", share(thousandths));
    let radius = dice.log_between(0.25, 15.0);
    // At most up to the horizon, because no part of the disc may be below it.
    let most = 89.9 - radius;
    let theta = if dice.one_in(6) { most } else { dice.between(-80.0, 80.0).clamp(-most, most) };
    number(text, "theta_deg", theta);
    azimuth(dice, text, "phi_deg");
    number(text, "radius_deg", radius);
    own_spectrum(dice, text);
    format!("disc {theta:.0} {radius:.1}")
}

fn own_spectrum(dice: &mut Dice, text: &mut String) {
    if dice.one_in(3) {
        spectrum(dice, text);
    }
}

fn environment(dice: &mut Dice, text: &mut String, kind: usize, thousandths: u32) -> String {
    match kind {
        5..=7 => sky(dice, text, thousandths),
        8 => {
            let rotate = dice.between(-180.0, 180.0);
            let file = dice.of(["synthetic-office.hdr", "synthetic-hall.exr"]);
            key(text, "model", "\"map\"");
            key(text, "file", format_args!("\"data/{file}\""));
            number(text, "rotate_deg", rotate);
            number(text, "tilt_deg", dice.of([0.0, 20.0, 70.0]));
            file.to_owned()
        }
        9 => {
            *text += "model = \"profile\"\nfile = \"data/synthetic-room.csv\"\n";
            key(text, "angles", dice.of(["\"inclination\"", "\"elevation\""]));
            own_spectrum(dice, text);
            "profile".to_owned()
        }
        10 => {
            *text += "model = \"luminaire\"\nfile = \"data/synthetic-panel.ies\"\n";
            between(dice, text, "elevation_deg", [20.0, 90.0]);
            azimuth(dice, text, "azimuth_deg");
            between(dice, text, "distance_m", [1.0, 5.0]);
            "luminaire".to_owned()
        }
        _ => ring_or_cap(dice, text),
    }
}

fn ring_or_cap(dice: &mut Dice, text: &mut String) -> String {
    if dice.one_in(2) {
        let theta = dice.between(10.0, 80.0);
        let width = dice.between(1.0, 2.0 * theta.min(90.0 - theta));
        *text += "model = \"ring\"\n";
        number(text, "theta_deg", theta);
        number(text, "width_deg", width);
        own_spectrum(dice, text);
        return "ring".to_owned();
    }
    *text += "model = \"cap\"\n";
    between(dice, text, "theta_deg", [0.0, 60.0]);
    azimuth(dice, text, "phi_deg");
    let from = if dice.one_in(2) { 0.0 } else { dice.between(1.0, 30.0) };
    number(text, "from_deg", from);
    number(text, "to_deg", from + dice.between(5.0, 120.0));
    own_spectrum(dice, text);
    "cap".to_owned()
}

fn sky(dice: &mut Dice, text: &mut String, thousandths: u32) -> String {
    let number_of = 1 + dice.below(16);
    let elevation = dice.between(5.0, 85.0);
    *text += "model = \"sky\"\n";
    key(text, "number", number_of);
    number(text, "sun_elevation_deg", elevation);
    azimuth(dice, text, "sun_azimuth_deg");
    // The sun is in front of the display for any orientation.
    if dice.one_in(3) {
        between(dice, text, "tilt_deg", [0.0, elevation - 2.0]);
        between(dice, text, "ground_reflectance", [0.0, 0.4]);
    }
    if dice.one_in(3) && thousandths > 400 {
        // The sun takes a part of the fraction of the sky.
        let line = format!("share = {}\n", share(thousandths));
        if let Some(at) = text.rfind(&line) {
            text.replace_range(at..at + line.len(), &format!("share = {}\n", share(thousandths - 300)));
        }
        key(text, "sun_share", share(300));
        return format!("sky {number_of} sun");
    }
    format!("sky {number_of}")
}

fn front_light(dice: &mut Dice, is_lobe: bool) -> (String, String) {
    let mut text = String::from("[lighting.front_light]\n");
    number(&mut text, "illuminance_lx", dice.log_between(100.0, 1000.0));
    between(dice, &mut text, "upward_leak", [0.0, 0.2]);
    if is_lobe && dice.one_in(2) {
        key(
            &mut text,
            "distribution",
            dice.of(["\"data/synthetic-room.csv\"", "\"data/synthetic-panel.ies\""]),
        );
        return ("guide by angle".to_owned(), text);
    }
    ("guide".to_owned(), text)
}

fn viewer(dice: &mut Dice) -> String {
    let mut text = String::from("[viewer]\n");
    let field = match dice.below(4) {
        0 | 1 => 0.1,
        2 => 2.0,
        _ => dice.log_between(0.1, 10.0),
    };
    let theta =
        if dice.one_in(6) { dice.between(70.0, 85.0 - field / 2.0) } else { dice.between(-70.0, 70.0) };
    number(&mut text, "theta_deg", theta);
    azimuth(dice, &mut text, "phi_deg");
    number(&mut text, "field_deg", field);
    text
}
