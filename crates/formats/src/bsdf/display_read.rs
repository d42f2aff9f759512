//! Reader of the display's BSDF, `display-bsdf.npz` ("papilio-bsdf 1"), as a measurement of its first state.

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
    if about.version != 1 {
        let what = format!("version {} of {FORMAT}", about.version);
        return Err(arrays.error(BsdfProblem::Unsupported { what, expected: "version 1" }));
    }
    let states = arrays.texts("state")?;
    let part = first_state(&mut arrays, states.len())?;
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

/// Reads the first of `states` states.
fn first_state(arrays: &mut Npz<'_>, states: usize) -> Result<MeasuredPart, FormatError> {
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
        phi_i_deg: vec![0.0],
        theta_o_deg: axis("theta_o_deg", 0.0, 90.0)?,
        phi_o_deg: axis("dphi_deg", 0.0, 180.0)?,
    };
    let wavelengths = axis("wavelength_nm", super::SHORTEST_NM, 1e6)?;
    let Array { shape, values } = arrays.numbers("brdf")?;
    let lengths = [&grid.theta_i_deg, &grid.theta_o_deg, &grid.phi_o_deg, &wavelengths].map(Vec::len);
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
    Ok(MeasuredPart {
        way: ScatterMode::FrontReflection,
        values: values.collect(),
        channels: wavelengths.into_iter().map(Channel::Wavelength).collect(),
        geometry: Geometry::Spherical(grid),
        tis: Vec::new(),
    })
}
