//! Options of `papilio brdf`.

use clap::{Args, ValueEnum};
use papilio_display::HalfVectorGrid;

use super::{ScenarioArguments, Workers, angle_step, azimuth_step, relative_error};

#[derive(Debug, Args)]
pub(crate) struct Brdf {
    #[command(flatten)]
    pub(crate) scenario: ScenarioArguments,
    /// Format of the files
    #[arg(long, value_enum, default_value_t = BrdfFormat::Npz)]
    pub(crate) format: BrdfFormat,
    /// States to write, separated by commas, or all of them
    #[arg(long, value_name = "all|NAME,...", value_delimiter = ',', default_value = ALL_STATES)]
    pub(crate) states: Vec<String>,
    /// Step of inclination and azimuth in degrees, a divisor of 90; with --format rgl and radiant, of the
    /// inclination of the light to 30 deg, half of it to 70 deg and a quarter of it beyond; not with --format
    /// klems [default: 5]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = angle_step)]
    pub(crate) step: Option<f64>,
    /// Step of the azimuth of the light in degrees, a divisor of 180, where the display depends on it [default: 15]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = azimuth_step)]
    pub(crate) phi_step: Option<f64>,
    /// Number of half vectors along each axis, from 8 to 256, only with --format rgl [default: 64]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = grid_size)]
    pub(crate) grid: Option<usize>,
    /// Accept relative errors up to X, and write them in an array `error` [default: the scenario's target]
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = relative_error)]
    pub(crate) allow_error: Option<f64>,
    #[command(flatten)]
    pub(crate) workers: Workers,
}

impl Brdf {
    /// Step of the angles in degrees.
    pub(crate) fn step_deg(&self) -> f64 {
        self.step.unwrap_or(5.0)
    }
}

/// The word for all states.
pub(crate) const ALL_STATES: &str = "all";

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum BrdfFormat {
    /// NumPy arrays of all states (display-bsdf.npz)
    Npz,
    /// One row per pair of directions and wavelength, one file per state (display-STATE.csv)
    Csv,
    /// RGL tensor files for Mitsuba and pbrt, one per state (display-STATE.bsdf), and a scene (scene.py)
    Rgl,
    /// Tabular BSDFs of Radiant and Zemax for X, Y and Z, one per state (display-STATE.bsdf)
    Radiant,
    /// Luminous Klems matrices of WINDOW and Radiance, one file per state: 145 patches, coarse
    /// (display-STATE.xml)
    Klems,
}

/// Parses the number of half vectors along an axis.
fn grid_size(text: &str) -> Result<usize, String> {
    let (least, most) = (HalfVectorGrid::SMALLEST, HalfVectorGrid::LARGEST);
    match text.parse::<usize>() {
        Ok(size) if (least..=most).contains(&size) => Ok(size),
        _ => Err(format!(
            "expected a whole number from {least} to {most}; 64 suits most displays, 128 those with a lobe of a few degrees"
        )),
    }
}
