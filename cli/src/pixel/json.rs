//! `papilio pixel --json`: the scan, and the absorptance of each layer, as one JSON object.

use std::collections::BTreeMap;

use papilio_display::pixel::{PixelAbsorption, PixelScan, SubPixelAbsorption};
use serde::Serialize;

/// Rows of angles, each with one number for each wavelength.
type Table<'a> = Vec<&'a [f64]>;

/// Reflectances of a state.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Reflectance<'a> {
    /// `[angle][wavelength]`.
    ByAngle(Table<'a>),
    /// `[angle][azimuth][wavelength]`.
    ByAzimuth(Vec<Table<'a>>),
}

/// What `papilio pixel --json` prints.
#[derive(Debug, Serialize)]
pub(super) struct PixelJson<'a> {
    papilio: &'static str,
    title: &'a str,
    hash: &'a str,
    warnings: &'a [String],
    notes: &'a [String],
    /// Medium of the angles: `air` or `glass`.
    angles: &'a str,
    theta_deg: &'a [f64],
    /// Azimuths; none if the reflectance is the same at all of them.
    #[serde(skip_serializing_if = "<[f64]>::is_empty")]
    phi_deg: &'a [f64],
    wavelength_nm: &'a [f64],
    /// Reflectance of each state.
    reflectance: BTreeMap<&'a str, Reflectance<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    absorption: Option<AbsorptionJson<'a>>,
}

/// The absorptance of each layer of the film, at angles of its own.
#[derive(Debug, Serialize)]
struct AbsorptionJson<'a> {
    theta_deg: &'a [f64],
    /// The layers, downwards from the glass, and the substrate.
    materials: Vec<&'a str>,
    sub_pixels: Vec<SubPixelJson<'a>>,
}

/// One sub-pixel in one state: fractions of the light that falls on this sub-pixel.
#[derive(Debug, Serialize)]
struct SubPixelJson<'a> {
    state: &'a str,
    sub_pixel: &'a str,
    /// Fraction of the panel's area.
    area: f64,
    /// `[angle][wavelength]`.
    reflectance: Table<'a>,
    /// `[layer][angle][wavelength]`.
    absorptance: Vec<Table<'a>>,
}

impl<'a> PixelJson<'a> {
    pub(super) fn new(
        [title, hash]: [&'a str; 2],
        [notes, warnings]: [&'a [String]; 2],
        angles: &'a str,
        scan: &'a PixelScan,
        absorption: Option<&'a PixelAbsorption>,
    ) -> Self {
        let (bins, azimuths) = (scan.wavelength_nm.len(), scan.phi_deg.len());
        let of = |values: &'a Vec<f64>| match azimuths {
            0 => Reflectance::ByAngle(rows(values, bins)),
            _ => Reflectance::ByAzimuth(values.chunks(azimuths * bins).map(|row| rows(row, bins)).collect()),
        };
        Self {
            papilio: env!("CARGO_PKG_VERSION"),
            title,
            hash,
            warnings,
            notes,
            angles,
            theta_deg: &scan.theta_deg,
            phi_deg: &scan.phi_deg,
            wavelength_nm: &scan.wavelength_nm,
            reflectance: scan.states.iter().map(|(name, values)| (name.as_str(), of(values))).collect(),
            absorption: absorption.map(AbsorptionJson::new),
        }
    }
}

impl<'a> AbsorptionJson<'a> {
    fn new(all: &'a PixelAbsorption) -> Self {
        let (angles, bins) = (all.theta_deg.len(), all.wavelength_nm.len());
        let of = |one: &'a SubPixelAbsorption| SubPixelJson {
            state: &one.state,
            sub_pixel: &one.sub_pixel,
            area: one.area,
            reflectance: rows(&one.reflectance, bins),
            absorptance: one.absorptance.chunks(angles * bins).map(|layer| rows(layer, bins)).collect(),
        };
        Self {
            theta_deg: &all.theta_deg,
            materials: all.layers.iter().map(|layer| layer.material.as_str()).collect(),
            sub_pixels: all.sub_pixels.iter().map(of).collect(),
        }
    }
}

/// Rows of `bins` numbers.
fn rows(values: &[f64], bins: usize) -> Table<'_> {
    values.chunks(bins).collect()
}
