//! A picture in memory with the samples of its file.

use papilio_diagnostics::Diagnostic;

use super::colour_space::{RgbSpace, d65};
use super::icc_table::IccTable;
use super::transfer::Transfer;

/// A picture as in its file. The first row is at the top.
#[derive(Debug, Clone, PartialEq)]
pub struct SourcePicture {
    columns: usize,
    rows: usize,
    /// Values of a pixel: grey, grey and opacity, three colours, three colours and opacity, CMYK.
    channels: usize,
    /// Those of its colour: all, or all but the opacity.
    inputs: usize,
    samples: Samples,
    encoding: Encoding,
    /// Name of its colour space.
    space: String,
}

/// Encoded numbers, pixel by pixel.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Samples {
    Eight(Vec<u8>),
    Sixteen(Vec<u16>),
    /// Linear light of red, green and blue, or X, Y and Z: 1 is white.
    Linear(Vec<[f32; 3]>),
}

impl Samples {
    fn len(&self) -> usize {
        match self {
            Self::Eight(values) => values.len(),
            Self::Sixteen(values) => values.len(),
            Self::Linear(values) => 3 * values.len(),
        }
    }

    fn largest(&self) -> u16 {
        match self {
            Self::Eight(_) => 255,
            Self::Sixteen(_) | Self::Linear(_) => u16::MAX,
        }
    }
}

/// What a colour space does to the numbers of a picture.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ColourEncoding {
    /// Name for messages.
    pub(super) name: String,
    pub(super) light: Light,
}

/// From the numbers of a picture to X, Y, Z under D65.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Light {
    /// Red, green and blue by transfer functions and a matrix; grey by the first of them.
    Matrix {
        /// Of red, green and blue.
        transfers: [Transfer; 3],
        /// From linear red, green and blue to X, Y, Z under D65.
        xyz_from_rgb: [[f64; 3]; 3],
    },
    /// The table of a profile.
    Table {
        table: Box<IccTable>,
        /// From X, Y, Z under D50 to those under D65.
        to_d65: [[f64; 3]; 3],
    },
}

impl ColourEncoding {
    /// That of a colour space.
    pub(super) fn of(space: &RgbSpace) -> Option<Self> {
        let transfers = [0; 3].map(|_| space.transfer.clone());
        let light = Light::Matrix { transfers, xyz_from_rgb: space.xyz_from_rgb()? };
        Some(Self { name: space.name.clone(), light })
    }

    /// The same.
    ///
    /// # Errors
    /// Primaries on a line.
    pub(super) fn needed(space: &RgbSpace) -> Result<Self, Diagnostic> {
        let wrong = || format!("the colour space {}", space.name);
        let expected = "primaries that are not on a line, and a white";
        Self::of(space).ok_or_else(|| super::unsupported(&wrong(), expected))
    }
}

/// From each encoded number to X, Y, Z.
#[derive(Debug, Clone, PartialEq)]
enum Encoding {
    /// Linear light of each number by colour, and the matrix to X, Y, Z.
    Matrix { light: [Vec<f32>; 3], xyz_from_rgb: [[f32; 3]; 3] },
    /// The table of a profile, and the matrix to D65.
    Table { table: Box<IccTable>, to_d65: [[f64; 3]; 3] },
}

impl SourcePicture {
    /// A picture of 1 to 4 channels.
    pub(super) fn new(
        [columns, rows]: [usize; 2],
        channels: usize,
        samples: Samples,
        encoding: &ColourEncoding,
    ) -> Result<Self, Diagnostic> {
        if samples.len() != columns * rows * channels {
            return Err(super::damaged("picture", "values are missing"));
        }
        let largest = samples.largest();
        let (inputs, encoded) = match &encoding.light {
            Light::Matrix { transfers: [red, green, blue], xyz_from_rgb } => {
                let first = red.table(largest);
                let others = [green, blue]
                    .map(|other| if other == red { first.clone() } else { other.table(largest) });
                let [second, third] = others;
                let xyz_from_rgb = xyz_from_rgb.map(|row| row.map(|value| value as f32));
                let light = [first, second, third];
                (if channels > 2 { 3 } else { 1 }, Encoding::Matrix { light, xyz_from_rgb })
            }
            Light::Table { table, to_d65 } => {
                (table.inputs(), Encoding::Table { table: table.clone(), to_d65: *to_d65 })
            }
        };
        let space = encoding.name.clone();
        Ok(Self { columns, rows, channels, inputs, samples, encoding: encoded, space })
    }

    /// A picture of linear light; the matrix leads to X, Y and Z under D65.
    pub(super) fn linear(
        [columns, rows]: [usize; 2],
        pixels: Vec<[f32; 3]>,
        xyz_from_pixel: [[f64; 3]; 3],
        space: &str,
    ) -> Self {
        let xyz_from_rgb = xyz_from_pixel.map(|row| row.map(|value| value as f32));
        let encoding = Encoding::Matrix { light: Default::default(), xyz_from_rgb };
        let (samples, space) = (Samples::Linear(pixels), space.to_owned());
        Self { columns, rows, channels: 3, inputs: 3, samples, encoding, space }
    }

    /// Pixels in a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Name of its colour space, for messages.
    pub fn space(&self) -> &str {
        &self.space
    }

    /// X, Y, Z of the pixels of a row under D65, Y = 1 for white, composited over white. Colours outside the
    /// visible ones have negative values. Nothing for a row that the picture does not have.
    pub fn row(&self, row: usize) -> Vec<[f32; 3]> {
        let width = self.columns * self.channels;
        let range = row.saturating_mul(width)..row.saturating_add(1).saturating_mul(width);
        match &self.samples {
            Samples::Eight(values) => self.converted(values.get(range).unwrap_or_default()),
            Samples::Sixteen(values) => self.converted(values.get(range).unwrap_or_default()),
            Samples::Linear(values) => {
                let Encoding::Matrix { xyz_from_rgb, .. } = &self.encoding else { return Vec::new() };
                let rows = values.get(range.start / 3..range.end / 3).unwrap_or_default();
                rows.iter().map(|rgb| times(xyz_from_rgb, *rgb)).collect()
            }
        }
    }

    /// All rows after each other.
    pub fn xyz(&self) -> Vec<[f32; 3]> {
        let mut pixels = Vec::with_capacity(self.columns * self.rows);
        (0..self.rows).for_each(|row| pixels.extend(self.row(row)));
        pixels
    }

    fn converted<T: Copy + Into<u16>>(&self, values: &[T]) -> Vec<[f32; 3]> {
        // Of most pictures: without branches.
        if let (Encoding::Matrix { light, xyz_from_rgb }, 3, 3) = (&self.encoding, self.inputs, self.channels)
        {
            let light = |k: usize, value: T| light[k].get(usize::from(value.into())).copied().unwrap_or(0.0);
            let of = |[red, green, blue]: &[T; 3]| {
                times(xyz_from_rgb, [light(0, *red), light(1, *green), light(2, *blue)])
            };
            return values.as_chunks().0.iter().map(of).collect();
        }
        let white = d65().map(|value| value as f32);
        let largest = f32::from(self.samples.largest());
        let colour = |pixel: &[T]| match &self.encoding {
            Encoding::Matrix { light, xyz_from_rgb } => {
                let light = |k: usize| light[k].get(usize::from(pixel[k].into())).copied().unwrap_or(0.0);
                match self.inputs {
                    1 => white.map(|value| value * light(0)),
                    _ => times(xyz_from_rgb, [light(0), light(1), light(2)]),
                }
            }
            Encoding::Table { table, to_d65 } => {
                let mut device = [0.0; 4];
                for (device, value) in device.iter_mut().zip(pixel) {
                    *device = f64::from((*value).into()) / f64::from(largest);
                }
                let xyz = table.xyz(&device[..self.inputs]);
                to_d65.map(|row| (row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2]) as f32)
            }
        };
        let pixel = |pixel: &[T]| {
            let xyz = colour(pixel);
            match pixel.get(self.inputs) {
                Some(opacity) => {
                    let opacity = f32::from((*opacity).into()) / largest;
                    std::array::from_fn(|k| white[k] + opacity * (xyz[k] - white[k]))
                }
                None => xyz,
            }
        };
        values.chunks_exact(self.channels).map(pixel).collect()
    }

    /// Whether a pixel is not opaque.
    pub(super) fn is_transparent(&self) -> bool {
        let has_opacity = self.channels > self.inputs;
        has_opacity
            && match &self.samples {
                Samples::Eight(values) => {
                    values.chunks_exact(self.channels).any(|pixel| pixel.last() < Some(&255))
                }
                Samples::Sixteen(values) => {
                    values.chunks_exact(self.channels).any(|pixel| pixel.last() < Some(&u16::MAX))
                }
                Samples::Linear(_) => false,
            }
    }

    /// The picture turned upright, for one of the eight orientations of EXIF.
    pub(super) fn upright(mut self, orientation: u8) -> Self {
        if !(2..=8).contains(&orientation) {
            return self;
        }
        let (columns, rows) = (self.columns, self.rows);
        let is_turned = orientation >= 5;
        if is_turned {
            (self.columns, self.rows) = (rows, columns);
        }
        // The pixel of the file that is at column x of row y of the upright picture.
        let from = |x: usize, y: usize| {
            let [left, top, right, bottom] = [x, y, columns.wrapping_sub(1 + x), rows.wrapping_sub(1 + y)];
            let [turned_right, turned_bottom] = [columns.wrapping_sub(1 + y), rows.wrapping_sub(1 + x)];
            let (column, row) = match orientation {
                2 => (right, top),
                3 => (right, bottom),
                4 => (left, bottom),
                5 => (y, x),
                6 => (y, turned_bottom),
                7 => (turned_right, turned_bottom),
                _ => (turned_right, x),
            };
            row * columns + column
        };
        self.samples = match &self.samples {
            Samples::Eight(values) => {
                Samples::Eight(moved(values, self.channels, [self.columns, self.rows], from))
            }
            Samples::Sixteen(values) => {
                Samples::Sixteen(moved(values, self.channels, [self.columns, self.rows], from))
            }
            // Files of linear light state their order of rows.
            Samples::Linear(values) => Samples::Linear(values.clone()),
        };
        self
    }
}

/// A matrix times a colour: a `map` of its rows is a call for each pixel.
#[inline(always)]
fn times(matrix: &[[f32; 3]; 3], [red, green, blue]: [f32; 3]) -> [f32; 3] {
    let row = |k: usize| matrix[k][0] * red + matrix[k][1] * green + matrix[k][2] * blue;
    [row(0), row(1), row(2)]
}

/// The pixels of a picture of `columns` and `rows`, each from its place.
fn moved<T: Copy>(
    values: &[T],
    channels: usize,
    [columns, rows]: [usize; 2],
    from: impl Fn(usize, usize) -> usize,
) -> Vec<T> {
    let mut moved = Vec::with_capacity(values.len());
    for y in 0..rows {
        for x in 0..columns {
            let at = from(x, y) * channels;
            moved.extend_from_slice(&values[at..at + channels]);
        }
    }
    moved
}
