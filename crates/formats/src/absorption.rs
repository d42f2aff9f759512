//! Output files of `papilio pixel --absorption`: `absorption.csv` and `sub-pixels.csv`.

use std::io::{self, Write};

use papilio_display::pixel::PixelAbsorption;

/// Name of the substrate in the column `layer`.
const SUBSTRATE: &str = "substrate";

/// Writes `absorption.csv`: the absorptance of each layer, a fraction of the light that falls on the
/// sub-pixel. A layer is named by its number in `display.pixel.film`, from 0, or `substrate`.
///
/// # Errors
/// Those of `out`.
pub fn write_absorption(out: impl Write, all: &PixelAbsorption) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record([
        "state",
        "sub_pixel",
        "layer",
        "material",
        "theta_deg",
        "wavelength_nm",
        "absorptance",
    ])?;
    let [theta_deg, wavelength_nm] =
        [&all.theta_deg, &all.wavelength_nm].map(|axis| axis.iter().map(f64::to_string).collect::<Vec<_>>());
    let points = theta_deg.len() * wavelength_nm.len();
    for one in &all.sub_pixels {
        for (layer, values) in all.layers.iter().zip(one.absorptance.chunks(points.max(1))) {
            let number = layer.number.map_or(SUBSTRATE.to_owned(), |number| number.to_string());
            let place = theta_deg.iter().flat_map(|theta| wavelength_nm.iter().map(move |nm| (theta, nm)));
            for ((theta, nm), value) in place.zip(values) {
                let value = value.to_string();
                csv.write_record([&one.state, &one.sub_pixel, &number, &layer.material, theta, nm, &value])?;
            }
        }
    }
    csv.flush()
}

/// Writes `sub-pixels.csv`: the reflectance of each sub-pixel in each state, and its fraction of the panel's
/// area.
///
/// # Errors
/// Those of `out`.
pub fn write_sub_pixels(out: impl Write, all: &PixelAbsorption) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(["state", "sub_pixel", "area", "theta_deg", "wavelength_nm", "reflectance"])?;
    for one in &all.sub_pixels {
        let area = one.area.to_string();
        let place =
            all.theta_deg.iter().flat_map(|theta| all.wavelength_nm.iter().map(move |nm| (theta, nm)));
        for ((theta, nm), value) in place.zip(&one.reflectance) {
            let [theta, nm, value] = [theta, nm, value].map(f64::to_string);
            csv.write_record([&one.state, &one.sub_pixel, &area, &theta, &nm, &value])?;
        }
    }
    csv.flush()
}
