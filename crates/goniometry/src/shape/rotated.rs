//! Means over rotations of a sample: over the azimuths of the light, with azimuths of the viewer relative to it.
//!
//! A grid about the normal with several azimuths of the light becomes one with the first of them. Its values are the means of
//! those of the file where azimuths of the viewer from the light coincide, and are interpolated elsewhere. Other geometries have
//! a value for any azimuth of the light ([`lights_deg`]). Rotations of a grid about the specular direction are averaged by
//! [`Shape`](crate::Shape).

use super::cells::DifferenceSums;
use super::resample::STRETCH;
use super::spherical::Smooth;
use crate::geometry::turn_weights;
use crate::{Direction, Geometry, MeasuredPart, SpecularGrid, SphericalGrid};

/// Number of azimuths of the light of geometries without azimuths of their own.
const LIGHTS: u32 = 24;

/// Azimuths of the light over which a part without azimuths of the light on a grid is averaged, degrees, and their weights.
pub(super) fn lights_deg(geometry: &Geometry) -> Vec<(f64, f64)> {
    match geometry {
        _ if geometry.is_isotropic() => vec![(180.0, 1.0)],
        Geometry::Warped(grid) => grid.lights_deg(),
        // None of them on an edge of cells or patches that lies on an axis.
        _ => (0..LIGHTS).map(|k| (360.0 * (f64::from(k) + 0.5) / f64::from(LIGHTS), 1.0)).collect(),
    }
}

/// Means of a grid about the normal over the azimuths of the light.
pub(super) struct MeanOverLights {
    /// The channels, with one azimuth of the light.
    pub(super) part: MeasuredPart,
    /// Relative root mean square difference from the mean.
    pub(super) asymmetry: f64,
    /// Indices of the azimuths of the light whose values were interpolated between azimuths of the viewer.
    pub(super) between: Vec<usize>,
}

impl MeanOverLights {
    /// Means of channels of a part, given by their indices; `None` for other geometries and for a single azimuth.
    pub(super) fn new(part: &MeasuredPart, channels: &[usize]) -> Option<Self> {
        let Geometry::Spherical(grid) = &part.geometry else { return None };
        let [first, _, ..] = grid.phi_i_deg[..] else { return None };
        let weights = turn_weights(&grid.phi_i_deg);
        let mean = SphericalGrid { phi_i_deg: vec![first], ..grid.clone() };
        let places: Vec<Option<Vec<usize>>> = (0..weights.len()).map(|light| places(grid, light)).collect();
        let mut values = Vec::with_capacity(mean.cells() * channels.len());
        let mut differences = DifferenceSums::default();
        for channel in channels {
            let lights: Vec<Vec<f64>> = (0..weights.len())
                .map(|light| {
                    let (own, cells) = of_light(grid, part.channel(*channel), light);
                    match &places[light] {
                        Some(places) => taken(&cells, places),
                        None => interpolated(&own, cells, first),
                    }
                })
                .collect();
            for cell in 0..mean.cells() {
                let all = lights.iter().zip(&weights).map(|(values, weight)| (values[cell], *weight));
                let known: Vec<(f64, f64)> = all.filter(|(value, _)| value.is_finite()).collect();
                values.push(differences.mean(&known).unwrap_or(f64::NAN));
            }
        }
        let channels = channels.iter().map(|channel| part.channels[*channel]).collect();
        let geometry = Geometry::Spherical(mean);
        let part = MeasuredPart { way: part.way, channels, geometry, values, tis: Vec::new() };
        let between = (0..places.len()).filter(|light| places[*light].is_none()).collect();
        Some(Self { part, asymmetry: differences.relative(), between })
    }
}

/// The grid with one azimuth of the light, given by its index, and its values.
pub(super) fn of_light(grid: &SphericalGrid, values: &[f64], light: usize) -> (SphericalGrid, Vec<f64>) {
    let lobes = values.chunks_exact(grid.theta_o_deg.len() * grid.phi_o_deg.len());
    let cells = lobes.skip(light).step_by(grid.phi_i_deg.len()).flatten().copied().collect();
    (SphericalGrid { phi_i_deg: vec![grid.phi_i_deg[light]], ..grid.clone() }, cells)
}

/// Places on the axis of the viewer of the azimuths that are from one light, given by its index, what those of the axis are from the first
/// one; `None` unless the axis has all of them.
fn places(grid: &SphericalGrid, light: usize) -> Option<Vec<usize>> {
    let turn = grid.phi_i_deg[light] - grid.phi_i_deg[0];
    grid.phi_o_deg.iter().map(|phi| grid.viewer_place(phi + turn)).collect()
}

fn taken(cells: &[f64], places: &[usize]) -> Vec<f64> {
    cells.chunks_exact(places.len()).flat_map(|ring| places.iter().map(|k| ring[*k])).collect()
}

/// Values of a grid with one azimuth of the light at azimuths of the viewer that are from it what those of the axis are from `first`.
fn interpolated(own: &SphericalGrid, cells: Vec<f64>, first: f64) -> Vec<f64> {
    let light = own.phi_i_deg[0];
    let smooth = Smooth::new(own, &cells, STRETCH, None);
    let geometry = Geometry::Spherical(own.clone());
    let mut found = Vec::with_capacity(cells.len());
    for (k, theta_i) in own.theta_i_deg.iter().enumerate() {
        for theta_o in &own.theta_o_deg {
            found.extend(own.phi_o_deg.iter().map(|phi| {
                let to = Direction::new(*theta_o, phi + light - first);
                let is_known = geometry.evaluate(&cells, Direction::new(*theta_i, light), to).is_some();
                if is_known { smooth.value(k, to) } else { f64::NAN }
            }));
        }
    }
    found
}

/// Relative root mean square difference of rotations of the sample from their mean, of a channel of a part on neither a grid about
/// the normal nor one about the specular direction; 0 for an isotropic sample.
pub(super) fn asymmetry(part: &MeasuredPart, channel: usize) -> f64 {
    let lights = lights_deg(&part.geometry);
    let mut differences = DifferenceSums::default();
    if lights.len() < 2 {
        return 0.0;
    }
    for theta in [20.0, 40.0, 60.0] {
        for azimuth in (0..360).step_by(20).map(f64::from) {
            let radials = (0..180).step_by(5).map(f64::from);
            for to in radials.map_while(|radial| SpecularGrid::direction(theta, azimuth, radial)) {
                let of_light = |(phi, weight): &(f64, f64)| {
                    let to = Direction::new(to.theta_deg, to.phi_deg + phi - 180.0);
                    Some((part.evaluate(channel, Direction::new(theta, *phi), to)?, *weight))
                };
                differences.mean(&lights.iter().filter_map(of_light).collect::<Vec<_>>());
            }
        }
    }
    differences.relative()
}
