//! The quantities of a scenario, each with its range.
//!
//! Upper limits keep the arithmetic finite; they are far beyond any display.

use crate::error::Errors;
use crate::grammar::number;
use crate::mistake;
use crate::range::Range;
use crate::read::Read;
use crate::tree::{Node, Value};

/// Hint for a negative k.
const SIGN_OF_K: &str = "Papilio uses n + ik, k positive in an absorber: change the sign of n - ik data";

number!(
    /// A fraction of a whole.
    Share, Range::from_to(0.0, 1.0)
);
number!(
    /// A fraction between 0 and 1, both excluded.
    InnerShare, Range::between(0.0, 1.0)
);
number!(
    /// A fraction above 0.
    PositiveShare, Range::above_0_to(1.0)
);
/// Width of the narrowest lobe, in direction cosines: 0.2 seconds of arc, with a haze of 2e-5.
pub(crate) const NARROWEST_LOBE: f64 = 1e-6;

number!(
    /// A width in direction cosines.
    Width, Range::from_to(NARROWEST_LOBE, 100.0).unit("direction cosines")
);
number!(
    /// A thickness of a film or a gap, nm.
    Nanometres, Range::from_to(0.0, 1e6).unit("nm")
);
number!(
    /// A standard error, in the unit of its quantity.
    Tolerance, Range::above_0_to(1e6)
);
number!(
    /// An exposure of a picture, stops.
    Stops, Range::from_to(-10.0, 10.0).unit("stops")
);
number!(
    /// A factor on the contrast or the chroma of a picture.
    Factor, Range::from_to(0.0, 5.0)
);
number!(
    /// A correlated colour temperature of the light of a photograph, K.
    ColourTemperature, Range::from_to(1700.0, 25_000.0).unit("K")
);
number!(
    /// A wavelength or a difference of wavelengths, nm.
    Wavelength, Range::above_0_to(1e6).unit("nm")
);
number!(
    /// A refractive index.
    Index, Range::above_0_to(1000.0).unit("refractive index")
);
number!(
    /// The refractive index of the medium below a face through which a measurement was made.
    FaceIndex, Range::from_to(1.01, 4.0).unit("refractive index")
);
number!(
    /// The refractive index of a medium at a surface that is measured by rays or waves.
    SurfaceIndex, Range::from_to(0.1, 10.0).unit("refractive index")
);
number!(
    /// An extinction coefficient.
    Extinction, Range::from_to(0.0, 1000.0).unit("extinction coefficient k").hint_below(SIGN_OF_K)
);
number!(
    /// An inclination from the display's normal, degrees.
    Inclination, Range::between(-90.0, 90.0).unit("degrees")
);
number!(
    /// The fraction of a light guide's light that it emits upwards.
    Leak, Range::from_to(0.0, 0.99)
);
number!(
    /// A distance, m.
    Metres, Range::above_0_to(1e6).unit("m")
);
number!(
    /// An elevation above the horizon, degrees.
    Elevation, Range::above_0_to(90.0).unit("degrees above the horizon")
);
number!(
    /// The outer edge of a cap, degrees from its axis.
    CapEnd, Range::above_0_to(180.0).unit("degrees")
);
number!(
    /// An elevation above or below a horizon, degrees.
    Latitude, Range::from_to(-90.0, 90.0).unit("degrees above the horizon")
);
number!(
    /// An azimuth, degrees.
    Azimuth, Range::from_to(-360.0, 360.0).unit("degrees")
);
number!(
    /// A step of azimuth, degrees.
    AzimuthStep, Range::from_to(1.0, 180.0).unit("degrees")
);
number!(
    /// The full angle of a field of view, degrees.
    FieldAngle, Range::from_to(0.0, 180.0).unit("degrees")
);
number!(
    /// The angular radius of a source, degrees.
    AngularRadius, Range::above_0_to(90.0).unit("degrees")
);
number!(
    /// A distance, mm.
    Millimetres, Range::above_0_to(1e9).unit("mm")
);
number!(
    /// The thickness of a medium, mm.
    Thickness, Range::above_0_to(1000.0).unit("mm")
);
number!(
    /// The air below a front component, mm.
    AirGap, Range::from_to(0.0, 1000.0).unit("mm")
);
number!(
    /// The period of the pixels, um.
    Pitch, Range::above_0_to(1e6).unit("um")
);
number!(
    /// A size of text, points of 1/72 inch.
    Points, Range::above_0_to(1e4).unit("points")
);
number!(
    /// Pixels per inch.
    PixelsPerInch, Range::from_to(0.1, 1e5)
);
number!(
    /// A length within the pixel, um.
    Micrometres, Range::from_to(0.0, 1e5).unit("um")
);
number!(
    /// A length, or another positive number, of a surface.
    SurfaceLength, Range::above_0_to(1e6)
);
number!(
    /// A root mean square height, nm.
    RmsHeight, Range::above_0_to(1e6).unit("nm")
);
number!(
    /// The slope of a face along one axis: its root mean square, or the mean of its absolute value.
    FaceSlope, Range::from_to(0.0001, 0.5).unit("slope")
);
number!(
    /// A factor of n or of k.
    IndexFactor, Range::from_to(0.0, 10.0)
);
number!(
    /// A coefficient of Cauchy's formula.
    Coefficient, Range::from_to(-1000.0, 1000.0)
);
number!(
    /// A permittivity far above all resonances.
    HighPermittivity, Range::from_to(0.0, 1000.0)
);
number!(
    /// A strength of an oscillator: negative ones would amplify light.
    OscillatorStrength, Range::from_to(0.0, 1e6)
);
number!(
    /// A photon energy, eV.
    PhotonEnergy, Range::from_to(0.0, 1000.0).unit("eV")
);
number!(
    /// A photon energy above 0, eV.
    PositiveEnergy, Range::above_0_to(1000.0).unit("eV")
);
number!(
    /// A damping, eV.
    Damping, Range::from_to(0.0, 1000.0).unit("eV")
);
number!(
    /// The tail of a distribution of slopes.
    Tail, Range::from_to(2.0, 100.0)
        .unit("larger: shorter tails")
        .hint_below("2 is the longest tail, that of distribution = \"ggx\"")
);
number!(
    /// The kurtosis of slopes along one axis: 3 if they are Gaussian.
    Kurtosis, Range::from_to(3.04, 1e4)
        .hint_below("slopes of kurtosis 3 are Gaussian: distribution = \"beckmann\", which is also next to a smaller one")
);
number!(
    /// The correlation length of a face, um.
    CorrelationLength, Range::from_to(0.1, 1e4).unit("um")
);
number!(
    /// The diameter of a pupil, mm; 0 for a pinhole.
    Pupil, Range::from_to(0.0, 100.0).unit("mm")
);
number!(
    /// A fraction of the pitch of the pixels.
    Fraction, Range::from_to(0.0, 1.0).unit("fractions of the pitch")
);
number!(
    /// The optical thickness of a slab: its extinction along the normal.
    OpticalThickness, Range::from_to(1e-6, 1e6).unit("optical thickness")
);
number!(
    /// The mean cosine of a scattering angle.
    Anisotropy, Range::from_to(-0.99, 0.99).unit("mean cosine")
);
number!(
    /// The depolarisation factor of molecules.
    DepolarisationFactor, Range::from_to(0.0, 0.5)
);
number!(
    /// The radius of particles by Mie's theory, um.
    ParticleRadius, Range::from_to(0.001, 5.0).unit("um")
);
number!(
    /// The refractive index of spheres.
    SphereIndex, Range::from_to(0.1, 10.0).unit("refractive index")
);
number!(
    /// The effective variance of the radii of particles.
    EffectiveVariance, Range::from_to(0.0, 0.3)
);
number!(
    /// The roughness of an interface.
    Roughness, Range::from_to(0.001, 1.0).unit("roughness")
);
number!(
    /// A root mean square slope.
    Slope, Range::from_to(0.005, 1.0).unit("root mean square slope")
);
number!(
    /// An illuminance, lx.
    Lux, Range::from_to(1e-6, 1e9).unit("lx")
);
number!(
    /// The illuminance by ambient light, lx; 0 in the dark.
    RoomLux, Range::from_to(1e-6, 1e9).unit("lx").or_0(" with a front light")
);
number!(
    /// The luminance to which an eye is adapted, cd/m2.
    AdaptingLuminance, Range::from_to(0.01, 1e6).unit("cd/m2")
);
number!(
    /// The luminance of a background over that of a perfect white.
    Background, Range::from_to(0.01, 1.0)
);
number!(
    /// The temperature of a black body, K.
    Kelvin, Range::from_to(500.0, 100000.0).unit("K")
);
number!(
    /// The correlated colour temperature of CIE daylight, K.
    DaylightKelvin, Range::from_to(4000.0, 25000.0).unit("K")
);
number!(
    /// The peak wavelength of an LED, nm.
    LedPeak, Range::from_to(100.0, 10_000.0).unit("nm")
);
number!(
    /// The width of an LED, nm.
    LedWidth, Range::from_to(0.1, 1000.0).unit("nm")
);
number!(
    /// A weight in a mixture.
    Weight, Range::above_0_to(1e6)
);
number!(
    /// A relative standard error.
    RelativeError, Range::from_to(1e-6, 1.0)
);
number!(
    /// An angle of a grid, degrees.
    GridAngle, Range::from_to(0.0, 180.0).unit("degrees")
);
number!(
    /// The width of an instrument's image of a collimated beam, in direction cosines; 0 for none.
    Blur, Range::from_to(0.0001, 1.0).unit("direction cosines").or_0("")
);
number!(
    /// Standard deviation of noise relative to the value.
    Noise, Range::from_to(0.0, 1.0)
);
number!(
    /// Standard deviation of noise of a BSDF, 1/sr.
    NoiseFloor, Range::from_to(0.0, 1000.0).unit("1/sr")
);
number!(
    /// An inclination within the hemisphere, degrees.
    Horizon, Range::above_0_to(90.0).unit("degrees")
);

number!(
    /// An azimuth of an axis, degrees.
    AxisAngle, Range::from_to(-360.0, 360.0).unit("degrees")
);
number!(
    /// A twist of a liquid crystal, degrees.
    Twist, Range::from_to(-3600.0, 3600.0).unit("degrees")
);
number!(
    /// A tilt out of the panel, degrees.
    Tilt, Range::from_to(-90.0, 90.0).unit("degrees")
);
number!(
    /// A tilt at the bottom of a cell, degrees: above 90, the director turns through the normal.
    BottomTilt, Range::from_to(-180.0, 180.0).unit("degrees")
);
number!(
    /// An elastic constant of a liquid crystal, pN.
    ElasticConstant, Range::from_to(0.01, 1000.0).unit("pN")
);
number!(
    /// A relative permittivity.
    Permittivity, Range::from_to(1.0, 1000.0)
);
number!(
    /// A voltage, rms.
    Volts, Range::from_to(0.0, 100.0).unit("V")
);
number!(
    /// A retardance of one pass along the normal, nm.
    Retardance, Range::from_to(-1e4, 1e4).unit("nm")
);
number!(
    /// A ratio of retardances at two wavelengths.
    RetardanceRatio, Range::from_to(0.5, 2.0)
);
number!(
    /// The biaxiality of a retarder, Nz.
    Biaxiality, Range::from_to(-10.0, 10.0)
);
number!(
    /// A thickness of a cell, a polariser or a pane, um.
    CrystalThickness, Range::above_0_to(5000.0).unit("um")
);
number!(
    /// The natural pitch of a liquid crystal with a chiral dopant, um: above 0 counter-clockwise.
    NaturalPitch, Range::from_to(-1e4, 1e4).unit("um")
);
number!(
    /// The pitch of a helix, nm.
    HelixPitch, Range::from_to(50.0, 1e5).unit("nm")
);

/// An integer from `LEAST` to `MOST`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub(crate) struct Count<const LEAST: u64, const MOST: u64>(pub(crate) u64);

/// Number of paths for each view.
pub(crate) type Paths = Count<1, { 1 << 40 }>;

/// Seed of random numbers: any non-negative TOML integer.
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
                    errors.push(node.origin, mistake::no_such_count(value, Self::in_words()));
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
