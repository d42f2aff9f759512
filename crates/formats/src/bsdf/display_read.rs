//! Reader of the display's BSDF, `display-bsdf.npz` ("papilio-bsdf 1" and, with azimuths of the light, 2), as a measurement of its first
//! state.

use papilio_goniometry::{
    Channel, Geometry, MeasuredPart, Measurement, Provenance, ScatterMode, SphericalGrid,
};
use serde::Deserialize;

use super::{BsdfProblem, LARGEST_VALUE, VALUE_RANGE, Warned};
use crate::error::{FormatError, Problem};
use crate::npz::{Array, Npz};

/// Name of the format in `about`.
pub(super) const FORMAT: &str = "papilio-bsdf";

#[derive(Deserialize)]
struct About {
    version: u32,
    #[serde(default)]
    title: String,
}

pub(super) fn read(mut arrays: Npz<'_>, about: &str) -> Result<Warned<Measurement>, FormatError> {
    let about: About = serde_json::from_str(about).map_err(|e| arrays.unsound("about", &e.to_string()))?;
    if !(1..=2).contains(&about.version) {
        let what = format!("version {} of {FORMAT}", about.version);
        return Err(arrays.error(BsdfProblem::Unsupported { what, expected: "version 1 or 2" }));
    }
    let states = arrays.texts("state")?;
    let part = first_state(&mut arrays, states.len(), about.version == 2)?;
    let mut warnings = vec![
        "the specular reflection of the display was not read: it has no finite value per steradian"
            .to_owned(),
    ];
    if states.len() > 1 {
        warnings.push(format!(
            "only the state `{}` was read; {} other states were ignored",
            states[0],
            states.len() - 1
        ));
    }
    let provenance = Provenance {
        format: "display-bsdf.npz".to_owned(),
        sample: format!("{} ({})", about.title, states[0]),
        source: "computed".to_owned(),
        remarks: Vec::new(),
    };
    Ok(Warned { value: Measurement { provenance, media: [1.0, 1.0], parts: vec![part] }, warnings })
}

/// Reads the first of `states` states, with azimuths of the light if it has them.
fn first_state(arrays: &mut Npz<'_>, states: usize, is_turned: bool) -> Result<MeasuredPart, FormatError> {
    let mut axis = |name: &str, least: f64, most: f64| {
        let values = arrays.numbers(name)?.values;
        let ascends = values.windows(2).all(|pair| pair[0] < pair[1]);
        if values.is_empty() || !ascends || !values.iter().all(|value| (least..=most).contains(value)) {
            return Err(arrays.unsound(name, &format!("expected ascending values from {least} to {most}")));
        }
        Ok(values)
    };
    let grid = SphericalGrid {
        theta_i_deg: axis("theta_i_deg", 0.0, 90.0)?,
        phi_i_deg: if is_turned { axis("phi_i_deg", 0.0, BELOW_HALF_TURN)? } else { vec![0.0] },
        theta_o_deg: axis("theta_o_deg", 0.0, 90.0)?,
        phi_o_deg: axis("dphi_deg", 0.0, if is_turned { BELOW_TURN } else { 180.0 })?,
    };
    let wavelengths = axis("wavelength_nm", super::SHORTEST_NM, 1e6)?;
    let Array { shape, values } = arrays.numbers("brdf")?;
    let axes = [&grid.theta_i_deg, &grid.phi_i_deg, &grid.theta_o_deg, &grid.phi_o_deg, &wavelengths];
    let lengths: Vec<usize> = axes
        .iter()
        .enumerate()
        .filter(|(axis, _)| is_turned || *axis != 1)
        .map(|(_, axis)| axis.len())
        .collect();
    if shape.get(1..) != Some(&lengths[..]) || shape[0] != states || states == 0 {
        return Err(arrays.unsound("brdf", "its shape does not match the axes"));
    }
    let (cells, channels) = (grid.cells(), wavelengths.len());
    let of_first = &values[..cells * channels];
    if let Some(&value) = of_first.iter().find(|value| !(0.0..=LARGEST_VALUE).contains(*value)) {
        let expected = VALUE_RANGE;
        return Err(arrays.error(Problem::OutOfRange { what: "a value of the BSDF", value, expected }));
    }
    // The wavelength is the last index in the file, and the first one in a part.
    let values = (0..channels).flat_map(|c| (0..cells).map(move |cell| of_first[cell * channels + c]));
    let (mut grid, mut values) = (grid, values.collect::<Vec<f64>>());
    if is_turned {
        let numbers = (channels * cells).saturating_mul(2);
        if numbers > super::MOST_CELLS {
            return Err(arrays.error(BsdfProblem::TooManyCells { limit: super::MOST_CELLS }));
        }
        (grid, values) = turned(&grid, &values).ok_or_else(|| {
            arrays.unsound(
                "dphi_deg",
                "expected equal steps over a whole turn, of which phi_i_deg are multiples",
            )
        })?;
    }
    Ok(MeasuredPart {
        way: ScatterMode::FrontReflection,
        values,
        channels: wavelengths.into_iter().map(Channel::Wavelength).collect(),
        geometry: Geometry::Spherical(grid),
        tis: Vec::new(),
    })
}

/// Largest azimuths of a file with azimuths of the light, degrees.
const BELOW_HALF_TURN: f64 = 180.0 - 1e-6;
const BELOW_TURN: f64 = 360.0 - 1e-6;

/// Returns values with the azimuth of the viewer relative to that of the light, over half a turn of the light, as those of a grid with both
/// azimuths over a whole turn. `None` if its nodes are not the same.
fn turned(grid: &SphericalGrid, values: &[f64]) -> Option<(SphericalGrid, Vec<f64>)> {
    let (phis, count, viewers) = (grid.phi_i_deg.len(), grid.phi_o_deg.len(), grid.theta_o_deg.len());
    let step = 360.0 / count as f64;
    let is_near = |angle: f64, k: usize| (angle - step * k as f64).abs() < 1e-6;
    if !grid.phi_o_deg.iter().enumerate().all(|(k, dphi)| is_near(*dphi, k)) || count % 2 > 0 {
        return None;
    }
    let steps: Vec<usize> = grid.phi_i_deg.iter().map(|phi| (phi / step).round() as usize).collect();
    if !grid.phi_i_deg.iter().zip(&steps).all(|(phi, k)| is_near(*phi, *k)) {
        return None;
    }
    let mut all = Vec::with_capacity(2 * values.len());
    for light in values.chunks_exact(phis * viewers * count) {
        for half in [0, count / 2] {
            for (own, phi) in light.chunks_exact(viewers * count).zip(&steps) {
                for row in own.chunks_exact(count) {
                    all.extend((0..count).map(|k| row[(k + 2 * count - phi - half) % count]));
                }
            }
        }
    }
    let ahead = grid.phi_i_deg.iter().map(|phi| phi + 180.0);
    let phi_i_deg = grid.phi_i_deg.iter().copied().chain(ahead).collect();
    Some((SphericalGrid { phi_i_deg, ..grid.clone() }, all))
}
