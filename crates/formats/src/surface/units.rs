//! Units of length, as instruments write them.

/// Micrometres of a unit of length; `None` if it is not one.
pub(super) fn um_of(unit: &str) -> Option<f64> {
    let unit = unit.trim().trim_matches(['[', ']', '(', ')', '.', '"']).trim();
    // The micro sign, the Greek letter, and both as an MS-DOS code page and Latin-1 show them.
    let unit = unit.replace(['\u{b5}', '\u{3bc}', '\u{e6}', '\u{e7}', '\u{fffd}'], "u");
    Some(match unit.as_str() {
        "m" | "meter" | "metre" | "meters" | "metres" => 1e6,
        "cm" => 1e4,
        "mm" | "millimeter" | "millimetre" | "millimeters" | "millimetres" => 1e3,
        "um" | "uM" | "micron" | "microns" | "micrometer" | "micrometre" | "micrometers" | "micrometres"
        | "Micrometer" => 1.0,
        "nm" | "nanometer" | "nanometre" | "nanometers" | "nanometres" => 1e-3,
        "A" | "\u{c5}" | "\u{212b}" | "Ang" | "ang" | "angstrom" | "Angstrom" => 1e-4,
        "pm" => 1e-6,
        "in" | "inch" | "inches" => 25_400.0,
        "mil" | "mils" => 25.4,
        _ => return None,
    })
}
