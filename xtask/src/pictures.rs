//! `cargo xtask picture`: the pictures of README.md and docs/, from the example scenarios.

use crate::shell::{self, Outcome, cargo};

/// What is drawn: a command of papilio and its scenario, then each figure and its name in docs/pictures.
type Drawing = (&'static str, &'static str, &'static [(&'static str, &'static str)]);

const DRAWINGS: [Drawing; 3] = [
    (
        "run",
        "indoor",
        &[
            ("overview.svg", "overview.svg"),
            ("spectra.svg", "spectra.svg"),
            ("chromaticity.svg", "chromaticity.svg"),
            ("patches.svg", "patches.svg"),
        ],
    ),
    (
        "run",
        "angle-scan",
        &[
            ("luminance_against_angle.svg", "luminance_against_angle.svg"),
            ("contrast_ratio_against_angle.svg", "contrast_ratio_against_angle.svg"),
            ("gamut_against_angle.svg", "gamut_against_angle.svg"),
        ],
    ),
    ("pixel", "reference-pixel", &[("pixel.svg", "pixel.svg")]),
];

/// The chore.
pub(crate) fn pictures() -> Outcome {
    let pictures = shell::root().join("docs/pictures");
    std::fs::create_dir_all(&pictures).map_err(|error| format!("docs/pictures: {error}"))?;
    for (what, scenario, figures) in DRAWINGS {
        let out = shell::target().join("pictures").join(scenario);
        let file = format!("scenarios/{scenario}.toml");
        let mut papilio = cargo(["run", "--release", "--quiet", "--package", "papilio", "--", what, &file]);
        papilio.arg("--out").arg(&out);
        shell::run(papilio)?;
        for (from, to) in figures {
            std::fs::copy(out.join(from), pictures.join(to)).map_err(|error| format!("{from}: {error}"))?;
        }
    }
    println!("\nlook at docs/pictures before you commit them");
    Ok(())
}
