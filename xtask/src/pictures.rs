//! `cargo xtask picture`: the pictures of README.md and docs/, from the example scenarios.

use crate::shell::{self, Outcome, cargo};

/// A command of papilio, its file in scenarios/, the figures to copy, and the prefix of their names.
type Picture = (&'static [&'static str], &'static str, &'static [&'static str], &'static str);

const PICTURES: [Picture; 31] = [
    (
        &["run"],
        "indoor.toml",
        &["overview.svg", "chromaticity.svg", "chromaticity_xy.svg", "cone.svg", "cone_differences.svg"],
        "",
    ),
    (
        &["run"],
        "angle-scan.toml",
        &[
            "reflectance_against_angle.svg",
            "contrast_against_angle.svg",
            "gamut_against_angle.svg",
            "colour_shift_against_angle.svg",
            "peak_against_angle.svg",
        ],
        "",
    ),
    (&["pixel", "--absorption"], "indoor.toml", &["pixel.svg", "absorption.svg"], ""),
    (
        &["diffuser", "steps", "--beside=scenarios/measured-truth.toml"],
        "measured-diffused.toml",
        &["step-normalise.svg"],
        "measured-",
    ),
    (&["run"], "measured-h65.toml", &["reflectance_against_angle.svg"], "measured-"),
    (&["optimize", "--no-check"], "optimize.toml", &["trace.svg"], "optimize-"),
    (&["optimize", "--no-check"], "optimize-front.toml", &["front.svg"], "optimize-"),
    (
        &["tolerance", "--set=tolerance.metrics=[]"],
        "tolerance.toml",
        &["tolerance_gamut_percent_srgb.svg", "tolerance_sensitivities.svg"],
        "",
    ),
    (&["mtf"], "double-image.toml", &["kernel-white.svg"], "double-image-"),
    (&["mtf"], "laminated-text.toml", &["edges.svg"], "laminated-text-"),
    (&["crosstalk"], "matrix.toml", &["crosstalk.svg"], ""),
    (&["sweep"], "printed-filter.toml", &["sweep_patch_gamut_percent_srgb.svg"], "printed-filter-"),
    (&["sweep"], "lcd-sunglasses.toml", &["sweep_white.Y.svg"], "lcd-sunglasses-"),
    (&["gonio"], "../surfaces/prisms.toml", &["azimuths.svg"], "prisms-"),
    (&["sparkle"], "antiglare.toml", &["sparkle.svg"], "antiglare-"),
    (&["palette", "--rooms=D65,FL11"], "six-ink.toml", &["palette.svg"], "inks-"),
    (&["image", "--relative-to=display"], "six-ink.toml", &["seen.png"], "inks-"),
    (
        &["image", "--relative-to=display", "--set=image.intent=\"relative\""],
        "six-ink.toml",
        &["seen.png"],
        "inks-relative-",
    ),
    (&["image", "--rooms=FL11,D65", "--relative-to=display"], "page.toml", &["rooms.png"], "page-"),
    (&["image", "--relative-to=display"], "reader.toml", &["seen.png"], "reader-"),
    (
        &[
            "image",
            "--set=image.file=\"scenarios/data/chelsea.png\"",
            "--set=display.matrix.pixels=[64,44]",
            "--set=image.fit=\"cover\"",
            "--set=image.samples_per_pixel=6",
        ],
        "matrix.toml",
        &["seen.png"],
        "sub-pixels-",
    ),
    (&GALLERY, "data/chelsea.png", &["rooms.png"], "gallery-chelsea-"),
    (&GALLERY, "data/photographs/coffee.jpg", &["rooms.png"], "gallery-coffee-"),
    (&GALLERY, "data/photographs/astronaut.jpg", &["rooms.png"], "gallery-astronaut-"),
    (&GALLERY, "data/photographs/rocket.jpg", &["rooms.png"], "gallery-rocket-"),
    (&GALLERY, "data/photographs/deep-field.jpg", &["rooms.png"], "gallery-deep-field-"),
    (&GALLERY, "data/photographs/camera.jpg", &["rooms.png"], "gallery-camera-"),
    (&GALLERY, "data/photographs/raccoon.jpg", &["rooms.png"], "gallery-raccoon-"),
    (&GALLERY, "data/photographs/hopper.jpg", &["rooms.png"], "gallery-hopper-"),
    (&["image", "--on=six-ink"], "data/photographs/dashboard.png", &["seen.png"], "gallery-dashboard-"),
    (
        &["validate", "--measured"],
        "data/samples.toml",
        &[
            "sample-nanochannels.svg",
            "sample-clear-glass.svg",
            "sample-polished-metals.svg",
            "sample-etched-grades.svg",
            "sample-etched-grades-tails.svg",
            "sample-ptfe.svg",
            "sample-spectralon.svg",
            "sample-microspheres.svg",
        ],
        "",
    ),
];

/// A picture of the gallery: on six inks in daylight, and below a sodium lamp.
const GALLERY: [&str; 5] = [
    "image",
    "--on=six-ink",
    "--set=display.matrix.pixels=[320,240]",
    "--set=image.halftone=\"direct-binary-search\"",
    "--rooms=HP1",
];

/// Runs the task.
pub(crate) fn pictures() -> Outcome {
    let pictures = shell::root().join("docs/pictures");
    std::fs::create_dir_all(&pictures).map_err(|error| format!("docs/pictures: {error}"))?;
    for (arguments, file, figures, prefix) in PICTURES {
        let command = arguments.iter().filter(|word| !word.starts_with("--")).copied().collect::<Vec<_>>();
        let out = shell::target().join("pictures").join(command.join("-"));
        let file = format!("scenarios/{file}");
        let mut papilio = cargo(["run", "--release", "--quiet", "--package", "papilio", "--"]);
        papilio.args(arguments).arg(file).arg("--out").arg(&out);
        if figures.contains(&"cone.svg") {
            papilio.arg("--cone");
        }
        shell::run(papilio)?;
        for figure in figures {
            std::fs::copy(out.join(figure), pictures.join(format!("{prefix}{figure}")))
                .map_err(|error| format!("{figure}: {error}"))?;
        }
    }
    println!("\ncheck the pictures in docs/pictures before you commit them");
    Ok(())
}

/// Measures accuracy against time. The figure depends on the machine; no other program should run meanwhile.
pub(crate) fn accuracy() -> Outcome {
    let mut measure = cargo(["run", "--release", "--quiet", "--package", "papilio-validation"]);
    measure.args(["--example", "accuracy", "--", "docs/pictures/accuracy.svg"]);
    shell::run(measure)
}
