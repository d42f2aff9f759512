//! A BSDF as a file holds it.

use std::fmt;

use crate::Geometry;

/// A measured, simulated or computed BSDF.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Where it comes from.
    pub provenance: Provenance,
    /// Index of the medium on the front and on the back, 1 in air.
    pub media: [f64; 2],
    /// At most one for each [`Way`].
    pub parts: Vec<Part>,
}

/// Where a measurement comes from, in the file's own words.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Provenance {
    /// The file format, as users call it: `Radiant/Zemax tabular BSDF`.
    pub format: String,
    /// Name of the sample, as far as the file gives it.
    pub sample: String,
    /// Where the numbers come from, as far as the file says: `Measured`, `synthetic`, the instrument.
    pub source: String,
    /// Comments and header lines worth keeping, in order.
    pub remarks: Vec<String>,
}

/// The way that light takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Way {
    /// From the front, reflected.
    FrontReflection,
    /// From the front, transmitted to the back.
    FrontTransmission,
    /// From the back, transmitted to the front.
    BackTransmission,
    /// From the back, reflected.
    BackReflection,
}

impl Way {
    /// True if light leaves on the other side.
    pub fn is_transmission(self) -> bool {
        matches!(self, Self::FrontTransmission | Self::BackTransmission)
    }

    /// What it is called: `front transmission`.
    pub fn name(self) -> &'static str {
        match self {
            Self::FrontReflection => "front reflection",
            Self::FrontTransmission => "front transmission",
            Self::BackTransmission => "back transmission",
            Self::BackReflection => "back reflection",
        }
    }
}

/// What a value was weighted with over wavelength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Channel {
    /// The luminous one, or of a file that does not say.
    Monochrome,
    /// CIE tristimulus X.
    X,
    /// CIE tristimulus Y.
    Y,
    /// CIE tristimulus Z.
    Z,
    /// Red of a camera.
    Red,
    /// Green of a camera.
    Green,
    /// Blue of a camera.
    Blue,
    /// The solar spectrum, 300 to 2500 nm.
    Solar,
    /// One wavelength, nm.
    Wavelength(f64),
}

impl fmt::Display for Channel {
    /// A name, or the wavelength's number in nm.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self {
            Self::Monochrome => "monochrome",
            Self::X => "X",
            Self::Y => "Y",
            Self::Z => "Z",
            Self::Red => "red",
            Self::Green => "green",
            Self::Blue => "blue",
            Self::Solar => "solar",
            Self::Wavelength(nm) => return write!(f, "{nm}"),
        };
        f.write_str(name)
    }
}

/// One way of light through, or off, a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// From where to where.
    pub way: Way,
    /// At least one; alike in all cells.
    pub channels: Vec<Channel>,
    /// Where the values were taken.
    pub geometry: Geometry,
    /// f, 1/sr, without the cosine; NaN where nothing was measured. Shape `[channel][cell]`,
    /// cells in the geometry's order.
    pub values: Vec<f64>,
    /// Total integrated scatter as the file gives it, 0 to 1: shape `[channel][rotation][incidence]`
    /// of a specular-centred grid; empty if the file gives none.
    pub tis: Vec<f64>,
}

impl Part {
    /// The values of a channel, by its number.
    pub fn channel(&self, channel: usize) -> &[f64] {
        let cells = self.geometry.cells();
        &self.values[channel * cells..][..cells]
    }

    /// The number of the luminous channel: monochrome, else Y, else green, else the wavelength closest to 555 nm.
    pub fn luminous(&self) -> usize {
        let off = |channel: &Channel| match channel {
            Channel::Monochrome => 0.0,
            Channel::Y => 1.0,
            Channel::Green => 2.0,
            Channel::Wavelength(nm) => 3.0 + (nm - 555.0).abs(),
            _ => f64::INFINITY,
        };
        let channels = 0..self.channels.len();
        channels.min_by(|a, b| off(&self.channels[*a]).total_cmp(&off(&self.channels[*b]))).unwrap_or(0)
    }

    /// Total integrated scatter as the file gives it, by number of channel, rotation and incidence; a TIS of 0 was not
    /// measured.
    pub fn tis(&self, channel: usize, rotation: usize, incidence: usize) -> Option<f64> {
        let Geometry::Specular(grid) = &self.geometry else { return None };
        let turn = channel * grid.rotations_deg.len() + rotation;
        self.tis.get(turn * grid.incidences_deg.len() + incidence).copied().filter(|tis| *tis > 0.0)
    }

    /// The mean over rotations of the total integrated scatter of an incidence: what belongs to a lobe that is their mean.
    /// `None` unless the file gives it for each rotation.
    pub fn mean_tis(&self, channel: usize, incidence: usize) -> Option<f64> {
        let Geometry::Specular(grid) = &self.geometry else { return None };
        let turns = || (0..grid.rotations_deg.len()).map(|turn| (turn, grid.rotation_weight(turn)));
        let sum: Option<f64> =
            turns().map(|(turn, weight)| Some(weight * self.tis(channel, turn, incidence)?)).sum();
        sum.map(|sum| sum / turns().map(|(_, weight)| weight).sum::<f64>())
    }
}
