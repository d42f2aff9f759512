//! `papilio image`: a picture on the display, as the reader sees it, and what to send to the panel.

use std::path::Path;

use papilio_display::image::{ImageResult, PictureDifferences, ScreenWhite};
use papilio_display::palette::bytes;
use papilio_formats::{TitledFile, write_file, write_indexed_png, write_rgb_png, write_scene_exr};
use papilio_scenario::Resolved;
use serde::Serialize;

use crate::arguments::{ImageCommand, RelativeTo};
use crate::numbers::measured;
use crate::spatial::{SpatialOutput, show};
use crate::{Failure, report};

pub(crate) fn image(arguments: &ImageCommand) -> Result<(), Failure> {
    let resolved = arguments.command.scenario(arguments.picture_key())?.resolve_with_picture()?;
    let no_picture = || Failure::Input("the scenario names no picture".to_owned());
    let request = resolved.image.as_ref().ok_or_else(no_picture)?;
    let white = match arguments.relative_to {
        RelativeTo::White => ScreenWhite::Perfect,
        RelativeTo::Display => ScreenWhite::Display,
    };
    show(&arguments.command, &resolved, |control| {
        papilio_display::image::image(&resolved.scene, &request.source, &request.settings, white, control)
    })
}

impl SpatialOutput for ImageResult {
    const JSON: &'static str = "image.json";
    const FIGURES: &'static [&'static str] = &["seen", "states"];

    fn content<'a>(&'a self, resolved: &'a Resolved, title: &'a str) -> impl Serialize + 'a {
        TitledFile { papilio: env!("CARGO_PKG_VERSION"), title, hash: &resolved.hash, result: &self.numbers }
    }

    fn table(&self, title: &str) -> String {
        text(title, self)
    }

    fn write_tables(&self, folder: &Path) -> Result<Vec<String>, Failure> {
        let columns = self.size[0];
        write_file(&folder.join("seen.png"), |out| write_rgb_png(out, columns, &self.srgb, false))?;
        write_file(&folder.join("seen.exr"), |out| {
            write_scene_exr(out, columns, &self.seen, Some(self.white_cd_m2))
        })?;
        let mut names = vec!["seen.png".to_owned(), "seen.exr".to_owned()];
        if !self.states.is_empty() {
            let colours = self.palette.colours.iter();
            let palette: Vec<[u8; 3]> = colours.map(|one| one.srgb.map_or([0; 3], bytes)).collect();
            write_file(&folder.join("states.png"), |out| {
                write_indexed_png(out, columns, &self.states, &palette)
            })?;
            names.push("states.png".to_owned());
        }
        Ok(names)
    }

    fn figures(&self, _: &str) -> Vec<(String, String)> {
        Vec::new()
    }

    fn warnings(&self) -> &[String] {
        &self.numbers.warnings
    }
}

fn text(title: &str, result: &ImageResult) -> String {
    let numbers = &result.numbers;
    let percent = |fraction: f64| format!("{:.2} %", 100.0 * fraction);
    let mut rows = vec![["state", "pixels"].map(str::to_owned).to_vec()];
    for (state, fraction) in numbers.coverage.iter().flat_map(|coverage| coverage.iter()) {
        rows.push(vec![state.to_owned(), percent(*fraction)]);
    }
    let [columns, lines] = numbers.size;
    let temperature =
        numbers.light.colour_temperature_k.map_or(String::new(), |kelvin| format!(", {kelvin:.0} K"));
    let neighbours = if numbers.neighbours_light {
        "contains the light that the layers return from each pixel to others"
    } else {
        "each pixel has the colour of a page of its state: light of its neighbours is not contained"
    };
    let distance = match numbers.pixels_per_degree {
        Some(per_degree) => format!("at {per_degree:.1} pixels in a degree\n"),
        None => "S-CIELAB and FLIP need the size of the pixels: [display.matrix] with ppi or pitch_um\n"
            .to_owned(),
    };
    format!(
        "{}\n\n{columns} x {lines} pixels in light of {} lx{temperature}; {neighbours}\n{}\n{}{distance}\ncolours that no mixture of \
         the states has: {} of the pixels; clipped in seen.png: {}\n",
        report::plain(title),
        numbers.light.illuminance_lx,
        report::table(&rows),
        report::table(&differences(numbers.against_source, numbers.against_mapped)),
        percent(numbers.out_of_gamut_fraction),
        percent(numbers.clipped_fraction),
    )
}

/// What is seen, compared with the picture before and after gamut mapping.
fn differences(source: PictureDifferences, mapped: PictureDifferences) -> Vec<Vec<String>> {
    let head = ["seen against", "CIEDE2000: mean", "median", "95 %", "S-CIELAB: mean", "95 %", "FLIP: mean"];
    let row = |name: &str, one: PictureDifferences| {
        let number = |value: Option<f64>, digits| measured(value, None, digits);
        vec![
            name.to_owned(),
            number(Some(one.delta_e_2000_mean), 2),
            number(Some(one.delta_e_2000_p50), 2),
            number(Some(one.delta_e_2000_p95), 2),
            number(one.scielab_mean, 2),
            number(one.scielab_p95, 2),
            number(one.flip_mean, 4),
        ]
    };
    vec![head.map(str::to_owned).to_vec(), row("the picture", source), row("the picture in gamut", mapped)]
}
