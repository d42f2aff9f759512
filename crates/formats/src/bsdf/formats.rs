//! List of the formats of measured scattering, for help, messages and documentation.

/// Description of a format.
#[derive(Debug, Clone, Copy)]
struct Format {
    /// Short name for lists: `MERL`.
    short: &'static str,
    name: &'static str,
    read: &'static str,
    written: &'static str,
    ways: &'static str,
    channels: &'static str,
    geometry: &'static str,
}

/// All formats.
#[rustfmt::skip]
const FORMATS: [Format; 11] = [
    Format { short: "Radiant/Zemax", name: "Radiant/Zemax tabular BSDF", read: "yes", written: "yes, and by `papilio brdf`", ways: "one: BRDF or BTDF from the front", channels: "monochrome or XYZ", geometry: "about the specular direction" },
    Format { short: "CSV", name: "CSV", read: "yes", written: "yes", ways: "all four", channels: "any", geometry: "grid, or pairs of directions" },
    Format { short: "scan", name: "Scan at normal incidence, two columns", read: "yes", written: "", ways: "one", channels: "monochrome", geometry: "rotationally symmetric lobe" },
    Format { short: "Klems XML", name: "Klems matrix XML (WINDOW, Radiance)", read: "yes", written: "yes", ways: "all four", channels: "visible, CIE-X, CIE-Z, solar", geometry: "patches" },
    Format { short: "tensor-tree XML", name: "tensor-tree XML (Radiance)", read: "yes", written: "", ways: "all four", channels: "the same", geometry: "tree of squares" },
    Format { short: "ASTM E1392", name: "ASTM E1392, E2387", read: "yes", written: "", ways: "all four", channels: "R, G, B, X, Y, Z, wavelengths", geometry: "grid, or pairs of directions" },
    Format { short: "FRED", name: "FRED scatter data (`type bsdf_data`)", read: "yes", written: "", ways: "front, one or both", channels: "monochrome", geometry: "grid, or pairs of directions" },
    Format { short: "RGL", name: "RGL / Mitsuba tensor file", read: "yes", written: "by `papilio brdf`", ways: "front reflection", channels: "wavelengths, or RGB", geometry: "warped grid" },
    Format { short: "MERL", name: "MERL", read: "yes", written: "", ways: "front reflection", channels: "R, G, B", geometry: "half angles" },
    Format { short: "Papilio", name: "Papilio's own, `papilio-measurement`", read: "yes", written: "yes", ways: "all four", channels: "any", geometry: "all of these" },
    Format { short: "display-bsdf.npz", name: "`display-bsdf.npz` ([brdf.md](brdf.md))", read: "first state", written: "by `papilio brdf`", ways: "front reflection", channels: "wavelengths", geometry: "grid" },
];

/// Returns the input formats for use in a sentence: "Radiant/Zemax, CSV, ... and Papilio".
pub fn bsdf_formats() -> String {
    // The last format, the output of `papilio brdf`, is rarely the input of a user.
    let names: Vec<&str> = FORMATS[..FORMATS.len() - 1].iter().map(|format| format.short).collect();
    match names.split_last() {
        Some((last, others)) => format!("{} and {last}", others.join(", ")),
        None => String::new(),
    }
}

/// Returns a list of the formats in Markdown, for `docs/bsdf-files.md`.
pub fn bsdf_format_table() -> String {
    let line = |format: &Format| {
        let Format { name, read, written, ways, channels, geometry, .. } = format;
        let part = if *read == "yes" { String::new() } else { format!(" ({read})") };
        let is_written = match *written {
            "" => String::new(),
            "yes" => ", written".to_owned(),
            how => format!(", written {}", how.replace("yes, and", "also")),
        };
        format!("- **{name}**{part}{is_written}: {ways}; {channels}; {geometry}\n")
    };
    FORMATS.iter().map(line).collect()
}
