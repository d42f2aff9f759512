//! Error of an exported BSDF between its nodes, in every format: what a reader of the format interpolates,
//! against the display itself.

use std::io;

use papilio_display::{
    BrdfGrid, BrdfTable, HalfVectorTable, ProbeGrid, RingTable, Viewer, ViewerGrid, ViewerTable,
};
use papilio_goniometry::{Channel, Direction, Geometry, MeasuredPart, ScatterMode, SphericalGrid};

use super::display_klems::patches_part;
use super::display_radiant::{rings_part, unsound};
use super::rgl_write::luminous_part;
use super::tristimulus::luminous_weights;

/// An exported BSDF of a display, as the readers of its format understand it.
#[derive(Debug, Clone, Copy)]
pub enum Exported<'a> {
    /// A grid of inclinations and azimuths: CSV and NumPy. Readers interpolate linearly along each axis.
    Directions(&'a BrdfTable),
    /// Half vectors: RGL tensor files.
    HalfVectors(&'a HalfVectorTable),
    /// Rings about the mirror direction: the tabular BSDF of Radiant and Zemax.
    Rings(&'a RingTable),
    /// Patches, averaged over such rings: Klems matrices. Readers take the value of the patch.
    Patches(&'a RingTable),
}

/// Largest error of an exported BSDF between its nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct BetweenError {
    /// Difference of the luminous BRDF in D65, relative to that of the display, or to [`FAINT`] of the
    /// largest value in the light of the same direction if that is more.
    pub relative: f64,
    /// Name of the state.
    pub state: String,
    /// Inclination of the light, degrees.
    pub theta_i_deg: f64,
    /// Azimuth of the light, degrees, where the display depends on it.
    pub phi_i_deg: Option<f64>,
    /// Direction of the viewer.
    pub viewer: Viewer,
}

/// Fraction of the largest value below which errors are relative to it.
pub const FAINT: f64 = 0.01;

/// Returns the largest error of an export at the pairs of directions of `probes`, a table of the same states.
/// `None` if no pair is within the directions of the export, or the display scatters no light.
///
/// # Errors
/// If the lengths of a table's arrays do not match its grid.
pub fn between_error(
    exported: Exported<'_>,
    probes: &ViewerTable<ProbeGrid>,
) -> io::Result<Option<BetweenError>> {
    let weights = luminous_weights(&probes.wavelength_nm);
    let mut largest: Option<BetweenError> = None;
    for (number, state) in probes.states.iter().enumerate() {
        let reader = Reader::of(exported, number)?;
        let mut rest = state.brdf.chunks_exact(weights.len().max(1));
        for (light, [theta_i_deg, phi_i_deg]) in probes.grid.lights_deg().into_iter().enumerate() {
            let (viewers, _) = probes.grid.viewers(light);
            let exact: Vec<f64> = rest.by_ref().take(viewers.len()).map(|f| luminous(f, &weights)).collect();
            let most = exact.iter().copied().fold(0.0, f64::max);
            for (viewer, exact) in viewers.iter().zip(exact) {
                let Some(read) = reader.evaluate([theta_i_deg, phi_i_deg], viewer) else { continue };
                let relative = (read - exact).abs() / exact.max(FAINT * most);
                if relative.is_finite() && largest.as_ref().is_none_or(|found| relative > found.relative) {
                    let state = state.name.clone();
                    let phi_i_deg = (!probes.grid.phi_i_deg().is_empty()).then_some(phi_i_deg);
                    largest = Some(BetweenError { relative, state, theta_i_deg, phi_i_deg, viewer: *viewer });
                }
            }
        }
    }
    Ok(largest)
}

/// Luminous value of a spectrum.
fn luminous(spectrum: &[f32], weights: &[f64]) -> f64 {
    spectrum.iter().zip(weights).map(|(f, weight)| f64::from(f.max(0.0)) * weight).sum()
}

/// The luminous values of a state as the readers of the format understand them.
enum Reader<'a> {
    Part(MeasuredPart),
    /// A grid with azimuths of the light: linear along each axis, with the azimuth of the viewer relative to that of the light.
    Around(&'a BrdfGrid, Vec<f64>),
}

impl<'a> Reader<'a> {
    fn of(exported: Exported<'a>, state: usize) -> io::Result<Self> {
        let part = match exported {
            Exported::Directions(table) => {
                let part = grid_part(table, state)?;
                if !table.grid.phi_i_deg.is_empty() {
                    return Ok(Self::Around(&table.grid, part.values));
                }
                part
            }
            Exported::HalfVectors(table) => luminous_part(table, state)?,
            Exported::Rings(table) => rings_part(table, state)?.0,
            Exported::Patches(table) => patches_part(table, state)?,
        };
        Ok(Self::Part(part))
    }

    /// Returns the value for light from an inclination and azimuth; `None` beyond the directions of the file.
    fn evaluate(&self, [theta_i_deg, phi_i_deg]: [f64; 2], viewer: &Viewer) -> Option<f64> {
        match self {
            Self::Part(part) => {
                let from = Direction::new(theta_i_deg, phi_i_deg);
                let to = Direction::new(viewer.theta_o_deg, phi_i_deg + viewer.dphi_deg);
                part.evaluate(part.luminous(), from, to)
            }
            Self::Around(grid, values) => {
                let places = [
                    between(&grid.theta_i_deg, theta_i_deg)?,
                    around(&grid.phi_i_deg, phi_i_deg, 180.0),
                    between(&grid.theta_o_deg, viewer.theta_o_deg)?,
                    around(&grid.dphi_deg, viewer.dphi_deg, 360.0),
                ];
                let lengths = [&grid.theta_i_deg, &grid.phi_i_deg, &grid.theta_o_deg, &grid.dphi_deg];
                let corner = |corner: usize| {
                    let picked = places.iter().zip(lengths).enumerate().map(|(axis, (place, length))| {
                        let (node, weight) = place[corner >> axis & 1];
                        (node, weight, length.len())
                    });
                    let (cell, weight) = picked.fold((0, 1.0), |(cell, product), (node, weight, length)| {
                        (cell * length + node, product * weight)
                    });
                    weight * values.get(cell).copied().unwrap_or(0.0)
                };
                Some((0..16).map(corner).sum())
            }
        }
    }
}

/// The nodes of an axis next to an angle, with their weights; `None` beyond its ends.
fn between(axis: &[f64], angle: f64) -> Option<[(usize, f64); 2]> {
    let upper = axis.partition_point(|node| *node < angle);
    if upper == 0 {
        return (axis.first() == Some(&angle)).then_some([(0, 1.0), (0, 0.0)]);
    }
    let [low, high] = [axis[upper - 1], *axis.get(upper)?];
    let beyond = (angle - low) / (high - low);
    Some([(upper - 1, 1.0 - beyond), (upper, beyond)])
}

/// The same on an axis that begins again after a `period`.
fn around(axis: &[f64], angle: f64, period: f64) -> [(usize, f64); 2] {
    let (count, first) = (axis.len(), axis.first().copied().unwrap_or(0.0));
    let angle = first + (angle - first).rem_euclid(period);
    let upper = axis.partition_point(|node| *node <= angle).max(1);
    let (low, next) = (axis.get(upper - 1).copied().unwrap_or(0.0), upper % count.max(1));
    let gap = if next == 0 { first + period - low } else { axis[next] - low };
    let beyond = (angle - low) / gap;
    [(upper - 1, 1.0 - beyond), (next, beyond)]
}

/// The values on the directions of a table; with azimuths of the light, only the values.
fn grid_part(table: &BrdfTable, state: usize) -> io::Result<MeasuredPart> {
    let (grid, bins) = (&table.grid, table.wavelength_nm.len().max(1));
    let found = table.states.get(state).filter(|found| found.brdf.len() == grid.pairs() * bins);
    let found = found.ok_or_else(|| unsound("the BSDF does not match its directions"))?;
    let weights = luminous_weights(&table.wavelength_nm);
    Ok(MeasuredPart {
        way: ScatterMode::FrontReflection,
        channels: vec![Channel::Y],
        geometry: Geometry::Spherical(SphericalGrid {
            theta_i_deg: grid.theta_i_deg.clone(),
            phi_i_deg: vec![0.0],
            theta_o_deg: grid.theta_o_deg.clone(),
            phi_o_deg: grid.dphi_deg.clone(),
        }),
        values: found.brdf.chunks_exact(bins).map(|spectrum| luminous(spectrum, &weights)).collect(),
        tis: Vec::new(),
    })
}
