//! The quantities of a scenario, each with its range.
//!
//! Upper limits keep the arithmetic finite; they lie far beyond any display.

use crate::error::Errors;
use crate::grammar::number;
use crate::problem::Problem;
use crate::read::Read;
use crate::tree::{Node, Value};

number!(
    /// A share of a whole.
    Share, "a number from 0 to 1", |v| (0.0..=1.0).contains(&v),
    { "type": "number", "minimum": 0, "maximum": 1 }
);
number!(
    /// A share that is neither nothing nor all.
    InnerShare, "a number between 0 and 1", |v| v > 0.0 && v < 1.0,
    { "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1 }
);
number!(
    /// A share above 0.
    PositiveShare, "a number above 0, at most 1", |v| v > 0.0 && v <= 1.0,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1 }
);
/// The narrowest lobe, in direction cosines: a fifth of a second of arc, where haze is 2e-5.
pub(crate) const NARROWEST_LOBE: f64 = 1e-6;

number!(
    /// A width in direction cosines.
    Width, "a number from 1e-6 to 100 (direction cosines)", |v| (NARROWEST_LOBE..=100.0).contains(&v),
    { "type": "number", "minimum": 1e-6, "maximum": 100 }
);
number!(
    /// A length of films, nm.
    Nanometres, "a number from 0 to 1e6 (nm)", |v| (0.0..=1e6).contains(&v),
    { "type": "number", "minimum": 0, "maximum": 1e6 }
);
number!(
    /// A standard error, in the unit of what it is of.
    Tolerance, "a number above 0, at most 1e6", |v| v > 0.0 && v <= 1e6,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1e6 }
);
number!(
    /// A wavelength or a difference of wavelengths, nm.
    Wavelength, "a number above 0, at most 1e6 (nm)", |v| v > 0.0 && v <= 1e6,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1e6 }
);
number!(
    /// A refractive index.
    Index, "a number above 0, at most 1000 (refractive index)", |v| v > 0.0 && v <= 1e3,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1000 }
);
number!(
    /// An extinction coefficient.
    Extinction, "a number from 0 to 1000 (extinction coefficient k)", |v| (0.0..=1e3).contains(&v),
    { "type": "number", "minimum": 0, "maximum": 1000 }
);
number!(
    /// An inclination from the display's normal, degrees.
    Inclination, "a number between -90 and 90 (degrees)", |v| v.abs() < 90.0,
    { "type": "number", "exclusiveMinimum": -90, "exclusiveMaximum": 90 }
);
number!(
    /// The share of a light guide's light that goes up.
    Leak, "a number from 0 to .99", |v| (0.0..=0.99).contains(&v),
    { "type": "number", "minimum": 0, "maximum": 0.99 }
);
number!(
    /// A distance, m.
    Metres, "a number above 0, at most 1e6 (m)", |v| v > 0.0 && v <= 1e6,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1e6 }
);
number!(
    /// An elevation above the horizon, degrees.
    Elevation, "a number above 0, at most 90 (degrees above the horizon)", |v| v > 0.0 && v <= 90.0,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 90 }
);
number!(
    /// Where a cap ends, degrees from its axis.
    CapEnd, "a number above 0, at most 180 (degrees)", |v| v > 0.0 && v <= 180.0,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 180 }
);
number!(
    /// An elevation above or below a horizon, degrees.
    Latitude, "a number from -90 to 90 (degrees above the horizon)", |v| v.abs() <= 90.0,
    { "type": "number", "minimum": -90, "maximum": 90 }
);
number!(
    /// An azimuth, degrees.
    Azimuth, "a number from -360 to 360 (degrees)", |v| v.abs() <= 360.0,
    { "type": "number", "minimum": -360, "maximum": 360 }
);
number!(
    /// The full angle of a field of view, degrees.
    FieldAngle, "a number from 0 to 180 (degrees)", |v| (0.0..=180.0).contains(&v),
    { "type": "number", "minimum": 0, "maximum": 180 }
);
number!(
    /// The angular radius of a source, degrees.
    AngularRadius, "a number above 0, at most 90 (degrees)", |v| v > 0.0 && v <= 90.0,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 90 }
);
number!(
    /// A distance, mm.
    Millimetres, "a number above 0, at most 1e9 (mm)", |v| v > 0.0 && v <= 1e9,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1e9 }
);
number!(
    /// The thickness of a medium, mm.
    Thickness, "a number above 0, at most 1000 (mm)", |v| v > 0.0 && v <= 1e3,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1000 }
);
number!(
    /// Extinction along the normal.
    OpticalThickness, "a number from 1e-6 to 1e6 (optical thickness)", |v| (1e-6..=1e6).contains(&v),
    { "type": "number", "minimum": 1e-6, "maximum": 1e6 }
);
number!(
    /// The mean cosine of a scattering angle.
    Anisotropy, "a number from -.99 to .99 (mean cosine)", |v| v.abs() <= 0.99,
    { "type": "number", "minimum": -0.99, "maximum": 0.99 }
);
number!(
    /// The roughness of a face.
    Roughness, "a number from .01 to 1 (roughness)", |v| (0.01..=1.0).contains(&v),
    { "type": "number", "minimum": 0.01, "maximum": 1 }
);
number!(
    /// A root mean square slope.
    Slope, "a number from .005 to 1 (root mean square slope)", |v| (0.005..=1.0).contains(&v),
    { "type": "number", "minimum": 0.005, "maximum": 1 }
);
number!(
    /// An illuminance, lx.
    Lux, "a number from 1e-6 to 1e9 (lx)", |v| (1e-6..=1e9).contains(&v),
    { "type": "number", "minimum": 1e-6, "maximum": 1e9 }
);
number!(
    /// The illuminance of a room, which may be dark, lx.
    RoomLux, "a number from 1e-6 to 1e9 (lx), or 0 beside a front light", |v| v == 0.0 || (1e-6..=1e9).contains(&v),
    { "type": "number", "minimum": 0, "maximum": 1e9 }
);
number!(
    /// A luminance that an eye is adapted to, cd/m2.
    AdaptingLuminance, "a number from 0.01 to 1e6 (cd/m2)", |v| (0.01..=1e6).contains(&v),
    { "type": "number", "minimum": 0.01, "maximum": 1e6 }
);
number!(
    /// The luminance of a background over that of the white.
    Background, "a number from 0.01 to 1", |v| (0.01..=1.0).contains(&v),
    { "type": "number", "minimum": 0.01, "maximum": 1 }
);
number!(
    /// The temperature of a black body, K.
    Kelvin, "a number from 500 to 100000 (K)", |v| (500.0..=1e5).contains(&v),
    { "type": "number", "minimum": 500, "maximum": 1e5 }
);
number!(
    /// The correlated colour temperature of CIE daylight, K.
    DaylightKelvin, "a number from 4000 to 25000 (K)", |v| (4000.0..=25e3).contains(&v),
    { "type": "number", "minimum": 4000, "maximum": 25000 }
);
number!(
    /// A weight in a mixture.
    Weight, "a number above 0, at most 1e6", |v| v > 0.0 && v <= 1e6,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 1e6 }
);
number!(
    /// A relative standard error.
    RelativeError, "a number from 1e-6 to 1", |v| (1e-6..=1.0).contains(&v),
    { "type": "number", "minimum": 1e-6, "maximum": 1 }
);
number!(
    /// An angle of a grid, degrees.
    GridAngle, "a number from 0 to 180 (degrees)", |v| (0.0..=180.0).contains(&v),
    { "type": "number", "minimum": 0, "maximum": 180 }
);
number!(
    /// The width of an instrument's image of a straight beam, in direction cosines, or none.
    Blur, "0, or a number from .0001 to 1 (direction cosines)", |v| v == 0.0 || (1e-4..=1.0).contains(&v),
    { "type": "number", "minimum": 0, "maximum": 1 }
);
number!(
    /// Relative noise.
    Noise, "a number from 0 to 1", |v| (0.0..=1.0).contains(&v),
    { "type": "number", "minimum": 0, "maximum": 1 }
);
number!(
    /// Noise of a BSDF.
    NoiseFloor, "a number from 0 to 1000 (1/sr)", |v| (0.0..=1e3).contains(&v),
    { "type": "number", "minimum": 0, "maximum": 1000 }
);
number!(
    /// The last inclination that is seen, degrees.
    Horizon, "a number above 0, at most 90 (degrees)", |v| v > 0.0 && v <= 90.0,
    { "type": "number", "exclusiveMinimum": 0, "maximum": 90 }
);

/// A count from `LEAST` to `MOST`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub(crate) struct Count<const LEAST: u64, const MOST: u64>(pub(crate) u64);

/// How many paths a run may trace for each view.
pub(crate) type Paths = Count<1, { 1 << 40 }>;

/// Seed of the random numbers: what a TOML integer holds.
pub(crate) type Seed = Count<0, { i64::MAX as u64 }>;

impl<const LEAST: u64, const MOST: u64> Read for Count<LEAST, MOST> {
    fn in_words() -> String {
        format!("a whole number from {LEAST} to {MOST}")
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        match node.value {
            Value::Integer(value) if u64::try_from(value).is_ok_and(|v| (LEAST..=MOST).contains(&v)) => {
                u64::try_from(value).ok().map(Self)
            }
            Value::Float(value)
                if value.fract() == 0.0 && (LEAST as f64..=MOST.min(1 << 53) as f64).contains(&value) =>
            {
                Some(Self(value as u64))
            }
            _ => match node.number() {
                Some(value) => {
                    errors.push(node.origin, Problem::NoSuchCount { value, expected: Self::in_words() });
                    None
                }
                None => node.wrong_type(Self::in_words(), errors),
            },
        }
    }
}

impl<const LEAST: u64, const MOST: u64> schemars::JsonSchema for Count<LEAST, MOST> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Count".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": "integer", "minimum": LEAST, "maximum": MOST })
    }
    fn inline_schema() -> bool {
        true
    }
}
