//! Palettes for other programs: sRGB bytes of each state with its name.
//!
//! | file | read by | specification |
//! |---|---|---|
//! | `palette.gpl` | GIMP, Inkscape, Krita | GIMP developer documentation, "GIMP palette file format" |
//! | `palette.css` | browsers | CSS custom properties, `--state-NAME` |
//! | `palette.ase` | Adobe programs | Adobe Swatch Exchange: big endian, names in UTF-16, RGB as 32-bit floats |
//! | `palette.act` | Adobe Photoshop | 256 RGB triples, then the number of colours and the transparent one (none) |
//! | `palette-epdoptimize.json` | epdoptimize | a list of `name`, `color` (as seen) and `deviceColor` (what the panel is sent) |
//! | `palette.py` | epaper-dithering, Inky | `COLORS`: names and bytes, for `ColorPalette(colors=COLORS, accent="red")`; `PALETTE`: a list |

use std::fmt::Write;

use papilio_display::LightSummary;
use papilio_display::image::ScreenWhite;
use papilio_display::palette::{PaletteResult, bytes, device_colour};
use serde_json::json;

/// Colours of an `.act` file.
const ACT_COLOURS: usize = 256;

/// Returns names and contents of all files with the colours of a display; their title has that of the scenario, the view, the light and what is
/// white.
pub fn files_of_palette(
    title: &str,
    result: &PaletteResult,
    white: ScreenWhite,
) -> Vec<(&'static str, Vec<u8>)> {
    let (of, colours) = (light_and_view(result), &result.palette.colours);
    let (title, srgb): (String, Vec<_>) = match white {
        ScreenWhite::Perfect => (
            format!("{title}, {of}, relative to a perfect white"),
            colours.iter().map(|one| one.srgb).collect(),
        ),
        ScreenWhite::Display => (
            format!("{title}, {of}, relative to the white of the display"),
            colours.iter().map(|one| one.srgb_relative).collect(),
        ),
    };
    let shown = colours.iter().zip(srgb).filter_map(|(one, srgb)| Some((one.state.as_str(), bytes(srgb?))));
    palette_files(&title, &shown.collect::<Vec<_>>())
}

/// Returns such as `seen from 0 deg, in light of 150 lx, 2734 K`.
pub fn light_and_view(result: &PaletteResult) -> String {
    let LightSummary { illuminance_lx, colour_temperature_k, .. } = result.light;
    let temperature = colour_temperature_k.map_or(String::new(), |kelvin| format!(", {kelvin:.0} K"));
    let (theta, phi) = (result.view.theta_deg, result.view.phi_deg);
    let azimuth = if phi == 0.0 { String::new() } else { format!(", azimuth {phi} deg") };
    format!("seen from {theta} deg{azimuth}, in light of {illuminance_lx} lx{temperature}")
}

/// Returns names and contents of all files with the colours `(state, bytes)`.
pub fn palette_files(title: &str, colours: &[(&str, [u8; 3])]) -> Vec<(&'static str, Vec<u8>)> {
    // In the files, it is one line.
    let title = &title.split_whitespace().collect::<Vec<_>>().join(" ");
    vec![
        ("palette.gpl", gpl(title, colours).into_bytes()),
        ("palette.css", css(title, colours).into_bytes()),
        ("palette.ase", ase(colours)),
        ("palette.act", act(colours)),
        ("palette-epdoptimize.json", epdoptimize(colours).into_bytes()),
        ("palette.py", python(title, colours).into_bytes()),
    ]
}

fn gpl(title: &str, colours: &[(&str, [u8; 3])]) -> String {
    let head = format!("GIMP Palette\nName: {title}\nColumns: {}\n#\n", colours.len());
    colours.iter().fold(head, |mut text, (state, [r, g, b])| {
        let _ = writeln!(text, "{r:3} {g:3} {b:3}\t{state}");
        text
    })
}

fn css(title: &str, colours: &[(&str, [u8; 3])]) -> String {
    let head = format!("/* {} */\n:root {{\n", title.replace("*/", "* /"));
    let mut text = colours.iter().fold(head, |mut text, (state, colour)| {
        let _ = writeln!(text, "  --state-{}: {};", identifier(state), hex(*colour));
        text
    });
    text.push_str("}\n");
    text
}

/// Letters, digits, `-` and `_` of a name as they are, everything else as `_`.
fn identifier(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || c == '-' || c == '_' { c } else { '_' }).collect()
}

fn ase(colours: &[(&str, [u8; 3])]) -> Vec<u8> {
    let mut bytes = b"ASEF\x00\x01\x00\x00".to_vec();
    bytes.extend((colours.len() as u32).to_be_bytes());
    for (state, colour) in colours {
        let name: Vec<u16> = state.encode_utf16().chain([0]).collect();
        let mut block = (name.len() as u16).to_be_bytes().to_vec();
        block.extend(name.iter().flat_map(|unit| unit.to_be_bytes()));
        block.extend(b"RGB ");
        block.extend(colour.iter().flat_map(|byte| (f32::from(*byte) / 255.0).to_be_bytes()));
        // A normal colour, neither global nor spot.
        block.extend(2_u16.to_be_bytes());
        bytes.extend(1_u16.to_be_bytes());
        bytes.extend((block.len() as u32).to_be_bytes());
        bytes.extend(block);
    }
    bytes
}

fn act(colours: &[(&str, [u8; 3])]) -> Vec<u8> {
    let count = colours.len().min(ACT_COLOURS);
    let mut bytes: Vec<u8> = colours[..count].iter().flat_map(|(_, colour)| *colour).collect();
    bytes.resize(3 * ACT_COLOURS, 0);
    bytes.extend((count as u16).to_be_bytes());
    bytes.extend(u16::MAX.to_be_bytes());
    bytes
}

fn epdoptimize(colours: &[(&str, [u8; 3])]) -> String {
    let list: Vec<_> = colours
        .iter()
        .map(|(state, colour)| {
            let device = device_colour(state).unwrap_or(*colour);
            json!({ "name": state, "color": hex(*colour), "deviceColor": hex(device) })
        })
        .collect();
    format!("{:#}\n", serde_json::Value::Array(list))
}

fn python(title: &str, colours: &[(&str, [u8; 3])]) -> String {
    let mut text = format!("# {title}: sRGB of the states\nCOLORS = {{\n");
    for (state, [r, g, b]) in colours {
        // JSON's escapes of a string are Python's.
        let _ = writeln!(text, "    {}: ({r}, {g}, {b}),", json!(state));
    }
    text.push_str("}\nPALETTE = [list(rgb) for rgb in COLORS.values()]\n");
    text
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLOURS: [(&str, [u8; 3]); 2] = [("black", [12, 0, 255]), ("dark \"teal\"", [1, 2, 3])];

    fn file(name: &str) -> Vec<u8> {
        palette_files("a */ title", &COLOURS).into_iter().find(|(known, _)| *known == name).unwrap().1
    }

    #[test]
    fn text_palettes_have_all_states() {
        let text = |name: &str| String::from_utf8(file(name)).unwrap();
        assert!(text("palette.gpl").ends_with("#\n 12   0 255\tblack\n  1   2   3\tdark \"teal\"\n"));
        assert!(
            text("palette.css").contains("--state-dark__teal_: #010203;")
                && text("palette.css").contains("* / title")
        );
        assert!(text("palette.py").contains("\"dark \\\"teal\\\"\": (1, 2, 3),"));
        let list: serde_json::Value = serde_json::from_slice(&file("palette-epdoptimize.json")).unwrap();
        assert_eq!((&list[0]["color"], &list[0]["deviceColor"]), (&json!("#0c00ff"), &json!("#000000")));
        assert_eq!(list[1]["deviceColor"], "#010203");
    }

    /// Lengths and numbers at their places in the two binary formats.
    #[test]
    fn binary_palettes_have_their_layout() {
        let act = file("palette.act");
        assert_eq!(
            (act.len(), &act[..6], &act[768..]),
            (772, &[12, 0, 255, 1, 2, 3][..], &[0, 2, 255, 255][..])
        );
        let ase = file("palette.ase");
        assert_eq!(&ase[..12], b"ASEF\x00\x01\x00\x00\x00\x00\x00\x02");
        // A block: its type, its length, 6 characters of "black" and its end, the model, three floats, the
        // kind.
        assert_eq!(&ase[12..20], &[0, 1, 0, 0, 0, 32, 0, 6]);
        assert_eq!(&ase[32..36], b"RGB ");
        assert_eq!(f32::from_be_bytes(ase[44..48].try_into().unwrap()), 1.0);
        assert_eq!(ase.len(), 12 + 38 + 38 + 2 * 6);
    }
}
