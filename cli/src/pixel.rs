//! `papilio pixel`.

use papilio_figures::{PixelScan as Figure, pixel_scan};
use papilio_formats::{PixelTable, write_file};
use papilio_scenario::Scenario;

use crate::arguments::Pixel;
use crate::{Failure, output};

pub(crate) fn pixel(arguments: &Pixel) -> Result<(), Failure> {
    let resolved = Scenario::load(&arguments.scenario.file, &arguments.scenario.set)?.resolve()?;
    let theta_deg: Vec<f64> = (0..=90).map(f64::from).collect();
    let scan = papilio_display::pixel::scan(&resolved.scene, &theta_deg)?;
    let folder = arguments.scenario.out.clone().unwrap_or_else(|| arguments.scenario.default_out());
    output::folder(&folder)?;
    let names: Vec<String> = scan.states.iter().map(|(name, _)| name.clone()).collect();
    let reflectance: Vec<f64> = scan.states.iter().flat_map(|(_, values)| values.iter().copied()).collect();
    let figure = Figure {
        states: &names,
        theta_deg: &scan.theta_deg,
        wavelength_nm: &scan.wavelength_nm,
        reflectance: &reflectance,
    };
    write_file(&folder.join("pixel.svg"), |out| out.write_all(pixel_scan(&figure).as_bytes()))?;
    let table =
        PixelTable { theta_deg: scan.theta_deg, wavelength_nm: scan.wavelength_nm, states: scan.states };
    write_file(&folder.join("pixel.csv"), |out| table.write(out))?;
    output::announce(&folder, &["pixel.csv".to_owned(), "pixel.svg".to_owned()]);
    Ok(())
}
