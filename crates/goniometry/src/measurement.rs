//! BSDF data as stored in a file.

use std::fmt;

use crate::{Fill, Geometry, Shape};

/// A measured, simulated or computed BSDF.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Origin of the data.
    pub provenance: Provenance,
    /// Refractive index of the medium on the front and on the back, 1 in air.
    pub media: [f64; 2],
    /// Parts, at most one for each [`ScatterMode`].
    pub parts: Vec<MeasuredPart>,
}

/// Origin of a measurement, as stated in the file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Provenance {
    /// Common name of the file format: `Radiant/Zemax tabular BSDF`.
    pub format: String,
    /// Name of the sample, if the file gives it.
    pub sample: String,
    /// Source of the numbers, if the file states it: `Measured`, `synthetic`, the instrument.
    pub source: String,
    /// Relevant comments and header lines, in order.
    pub remarks: Vec<String>,
}

/// Scatter mode: side of incidence, and reflection or transmission.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ScatterMode {
    /// Incident on the front, reflected.
    FrontReflection,
    /// Incident on the front, transmitted to the back.
    FrontTransmission,
    /// Incident on the back, transmitted to the front.
    BackTransmission,
    /// Incident on the back, reflected.
    BackReflection,
}

impl ScatterMode {
    /// Returns true for transmission.
    pub fn is_transmission(self) -> bool {
        matches!(self, Self::FrontTransmission | Self::BackTransmission)
    }

    /// Name in messages: `front transmission`.
    pub fn name(self) -> &'static str {
        match self {
            Self::FrontReflection => "front reflection",
            Self::FrontTransmission => "front transmission",
            Self::BackTransmission => "back transmission",
            Self::BackReflection => "back reflection",
        }
    }
}

/// Spectral weighting of a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Channel {
    /// Luminous weighting, or the only channel of a file that does not specify it.
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

impl fmt::Display for ScatterMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FrontReflection => "reflection at the front",
            Self::FrontTransmission => "transmission from the front",
            Self::BackTransmission => "transmission from the back",
            Self::BackReflection => "reflection at the back",
        })
    }
}

impl fmt::Display for Channel {
    /// Writes the name, or the wavelength in nm.
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

/// Values of one scatter mode of a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredPart {
    /// Scatter mode.
    pub way: ScatterMode,
    /// Channels, at least one, the same in all cells.
    pub channels: Vec<Channel>,
    /// Directions of the values.
    pub geometry: Geometry,
    /// f, 1/sr, without the cosine; NaN where nothing was measured. Shape `[channel][cell]`,
    /// with cells in the order of the geometry.
    pub values: Vec<f64>,
    /// Total integrated scatter stated in the file, 0 to 1: shape `[channel][rotation][incidence]`
    /// of a specular-centred grid; empty if the file has none.
    pub tis: Vec<f64>,
}

/// Total transmittance below which values may be in relative units: films for displays pass more.
const FAINT: f64 = 0.05;

/// Returns whether the values of a transmission, 1/sr, may be in relative units, given the total at the
/// smallest incidence, a fraction, and the largest value: hardly any light passes, or the values are
/// normalised to 1 or 100.
pub fn may_be_relative(total: f64, largest: f64) -> bool {
    total < FAINT || largest == 1.0 || largest == 100.0
}

impl MeasuredPart {
    /// Returns the values of a channel, given by its index.
    pub fn channel(&self, channel: usize) -> &[f64] {
        let cells = self.geometry.cells();
        &self.values[channel * cells..][..cells]
    }

    /// Index of the luminous channel: monochrome, else Y, else green, else the wavelength closest to 555 nm.
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

    /// Total integrated scatter stated in the file, by indices of channel, rotation and incidence. A TIS of 0
    /// means that it was not measured.
    pub fn tis(&self, channel: usize, rotation: usize, incidence: usize) -> Option<f64> {
        let Geometry::Specular(grid) = &self.geometry else { return None };
        let turn = channel * grid.rotations_deg.len() + rotation;
        self.tis.get(turn * grid.incidences_deg.len() + incidence).copied().filter(|tis| *tis > 0.0)
    }

    /// Returns whether the total integrated scatters (TIS) are in per cent: the largest is a percentage, and no
    /// fraction with any error of a measurement. The fraction of a sample that is brighter than the reference
    /// is the integral of its values.
    pub fn tis_in_percent(&self) -> bool {
        let (number, largest) = self
            .tis
            .iter()
            .copied()
            .enumerate()
            .fold((0, 0.0), |most, (number, tis)| if tis > most.1 { (number, tis) } else { most });
        if !(1.5..=101.0).contains(&largest) {
            return false;
        }
        let Geometry::Specular(grid) = &self.geometry else { return true };
        let incidences = grid.incidences_deg.len();
        let each = grid.rotations_deg.len() * incidences;
        let shape = Shape::of_part(self, number / each.max(1), Fill::None);
        let integral = shape.map_or(0.0, |shape| shape.total(number % incidences.max(1)));
        !(0.5..2.0).contains(&(largest / integral))
    }

    /// Mean over rotations of the total integrated scatter of an incidence, for the mean lobe.
    /// `None` unless the file gives it for each rotation.
    pub fn mean_tis(&self, channel: usize, incidence: usize) -> Option<f64> {
        let Geometry::Specular(grid) = &self.geometry else { return None };
        let weights = grid.rotation_weights();
        let of_turn = |(turn, weight): (usize, &f64)| Some(weight * self.tis(channel, turn, incidence)?);
        let sum: Option<f64> = weights.iter().enumerate().map(of_turn).sum();
        sum.map(|sum| sum / weights.iter().sum::<f64>())
    }
}
