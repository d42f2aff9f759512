//! Tables of ICC profiles: from the numbers of a device (RGB, grey, CMYK) to colour, relative to its white
//! (ICC.1:2022, 10.10 to 10.12).
//!
//! Numbers pass curves, a grid with linear interpolation along all axes, curves and a matrix in their turn,
//! and curves again; `lut8Type` and `lut16Type` have no second curves and no matrix. The result is X, Y, Z or
//! L*, a*, b* under D50.

use super::icc::{D50, Profile, fixed, number};
use super::transfer::Transfer;

/// Most numbers of a device.
const MOST_INPUTS: usize = 4;

/// Most nodes of a grid.
const MOST_NODES: usize = 1 << 24;

/// A table of a profile.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct IccTable {
    before: Vec<Transfer>,
    /// Number of nodes along each axis; the last varies fastest. None: the grid is left out.
    nodes: Vec<usize>,
    values: Vec<[f32; 3]>,
    middle: Option<Middle>,
    after: [Transfer; 3],
    space: Space,
}

/// Curves, then a matrix with an offset.
#[derive(Debug, Clone, PartialEq)]
struct Middle {
    curves: [Transfer; 3],
    matrix: [[f64; 3]; 3],
    offset: [f64; 3],
}

/// What numbers from 0 to 1 of the result stand for.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Space {
    /// X, Y, Z: 1 stands for 65535/32768.
    Xyz,
    /// L* = 100 and a*, b* from -128 to 127.
    Lab,
    /// The same in 16 bits of version 2: L* = 100 is 0xff00.
    LabOfVersion2,
}

impl IccTable {
    /// The table of a profile for grey (1), RGB (3) or CMYK (4): for relative colorimetry, or the perceptual
    /// one. `None` if there is none, or it is damaged.
    pub(super) fn read(profile: &Profile<'_>, inputs: usize) -> Option<Self> {
        let is_lab = match profile.at(20, 4)? {
            b"Lab " => true,
            b"XYZ " => false,
            _ => return None,
        };
        let device: &[u8] = match inputs {
            1 => b"GRAY",
            3 => b"RGB ",
            _ => b"CMYK",
        };
        if profile.at(16, 4)? != device {
            return None;
        }
        let tag = profile.tag(b"A2B1").or_else(|| profile.tag(b"A2B0"))?;
        if usize::from(*tag.get(8)?) != inputs || *tag.get(9)? != 3 || inputs > MOST_INPUTS {
            return None;
        }
        match tag.get(..4)? {
            b"mft1" => Self::of_lut(tag, inputs, 1, if is_lab { Space::Lab } else { Space::Xyz }),
            b"mft2" => Self::of_lut(tag, inputs, 2, if is_lab { Space::LabOfVersion2 } else { Space::Xyz }),
            b"mAB " => Self::of_a_to_b(tag, inputs, if is_lab { Space::Lab } else { Space::Xyz }),
            _ => None,
        }
    }

    /// `lut8Type` and `lut16Type`, whose numbers have 1 or 2 bytes.
    fn of_lut(tag: &[u8], inputs: usize, bytes: usize, space: Space) -> Option<Self> {
        let side = usize::from(*tag.get(10)?);
        // The matrix before the tables is only for X, Y, Z as numbers of a device.
        let (counts, mut rest) = match bytes {
            1 => ([256, 256], tag.get(48..)?),
            _ => {
                let count =
                    |at: usize| Some(usize::from(u16::from_be_bytes([*tag.get(at)?, *tag.get(at + 1)?])));
                ([count(48)?, count(50)?], tag.get(52..)?)
            }
        };
        let mut take = |count: usize| {
            let (taken, left) = rest.split_at_checked(count.checked_mul(bytes)?)?;
            rest = left;
            Some(numbers(taken, bytes))
        };
        let before: Vec<Vec<u16>> = (0..inputs).map(|_| take(counts[0])).collect::<Option<_>>()?;
        let nodes = vec![side; inputs];
        let values = triples(take(3 * count_of(&nodes)?)?);
        let after = [take(counts[1])?, take(counts[1])?, take(counts[1])?];
        let curve = |steps: Vec<u16>| (steps.len() > 1).then_some(Transfer::Table(steps));
        let before = before.into_iter().map(curve).collect::<Option<_>>()?;
        let [x, y, z] = after.map(curve);
        let after = [x?, y?, z?];
        Some(Self { before, nodes, values, middle: None, after, space })
    }

    /// `lutAToBType`.
    fn of_a_to_b(tag: &[u8], inputs: usize, space: Space) -> Option<Self> {
        let offset = |at: usize| Some(number(tag.get(at..at + 4)?)? as usize);
        let [b, matrix, m, grid, a] = [offset(12)?, offset(16)?, offset(20)?, offset(24)?, offset(28)?];
        let curves = |at: usize, count: usize| {
            let mut rest = tag.get(at..).filter(|_| at > 0)?;
            let mut next = || {
                let (curve, length) = Transfer::of_icc(rest)?;
                rest = rest.get(length.next_multiple_of(4)..).unwrap_or_default();
                Some(curve)
            };
            (0..count).map(|_| next()).collect::<Option<Vec<_>>>()
        };
        let three = |at: usize| <[Transfer; 3]>::try_from(curves(at, 3)?).ok();
        let after = three(b)?;
        let middle = match m {
            0 => None,
            _ => {
                let value =
                    |k: usize| fixed(tag.get(matrix..).filter(|_| matrix > 0)?.get(4 * k..4 * k + 4)?);
                let values: Vec<f64> = (0..12).map(value).collect::<Option<_>>()?;
                let offset = [values[9], values[10], values[11]];
                let matrix = [0, 3, 6].map(|row| [values[row], values[row + 1], values[row + 2]]);
                Some(Middle { curves: three(m)?, matrix, offset })
            }
        };
        if grid == 0 {
            let before = vec![Transfer::Linear; inputs];
            return (inputs == 3).then_some(Self {
                before,
                nodes: Vec::new(),
                values: Vec::new(),
                middle,
                after,
                space,
            });
        }
        let nodes: Vec<usize> =
            tag.get(grid..grid + inputs)?.iter().map(|count| usize::from(*count)).collect();
        let bytes = usize::from(*tag.get(grid + 16)?);
        let length = (3 * count_of(&nodes)?).checked_mul(bytes).filter(|_| (1..=2).contains(&bytes))?;
        let values = triples(numbers(tag.get(grid + 20..)?.get(..length)?, bytes));
        Some(Self { before: curves(a, inputs)?, nodes, values, middle, after, space })
    }

    /// Number of inputs.
    pub(super) fn inputs(&self) -> usize {
        self.before.len()
    }

    /// X, Y, Z under D50, Y = 1 of white, of numbers from 0 to 1.
    pub(super) fn xyz(&self, device: &[f64]) -> [f64; 3] {
        let mut at = [0.0; MOST_INPUTS];
        for ((at, curve), value) in at.iter_mut().zip(&self.before).zip(device) {
            *at = curve.decode(*value);
        }
        let mut values = match self.nodes[..] {
            [] => [at[0], at[1], at[2]],
            _ => self.between(&at[..self.nodes.len()]),
        };
        if let Some(Middle { curves, matrix, offset }) = &self.middle {
            let decoded: [f64; 3] = std::array::from_fn(|k| curves[k].decode(values[k]));
            values = std::array::from_fn(|row| {
                offset[row] + (0..3).map(|k| matrix[row][k] * decoded[k]).sum::<f64>()
            });
        }
        let [x, y, z] = std::array::from_fn(|k| self.after[k].decode(values[k]));
        let lab = |scale: f64, zero: f64| xyz_of_lab([100.0 * scale * x, zero * y - 128.0, zero * z - 128.0]);
        match self.space {
            Space::Xyz => [x, y, z].map(|value| value * 65535.0 / 32768.0),
            Space::Lab => lab(1.0, 255.0),
            Space::LabOfVersion2 => lab(65535.0 / 65280.0, 65535.0 / 256.0),
        }
    }

    /// Linear interpolation in the grid.
    fn between(&self, at: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for corner in 0..1_usize << at.len() {
            let (mut index, mut weight) = (0, 1.0);
            for (axis, (at, count)) in at.iter().zip(&self.nodes).enumerate() {
                let place = at * (count - 1) as f64;
                let below = (place as usize).min(count.saturating_sub(2));
                let share = place - below as f64;
                let is_above = corner >> axis & 1 == 1;
                weight *= if is_above { share } else { 1.0 - share };
                index = index * count + (below + usize::from(is_above)).min(count - 1);
            }
            if weight > 0.0 {
                (0..3).for_each(|k| sum[k] += weight * f64::from(self.values[index][k]));
            }
        }
        sum
    }
}

/// Number of nodes of a grid.
fn count_of(nodes: &[usize]) -> Option<usize> {
    let all = nodes.iter().try_fold(1_usize, |all, count| all.checked_mul(*count))?;
    (nodes.iter().all(|count| *count > 1) && all <= MOST_NODES).then_some(all)
}

/// Numbers of 1 or 2 bytes, in units of 1/65535.
fn numbers(bytes: &[u8], width: usize) -> Vec<u16> {
    match width {
        1 => bytes.iter().map(|byte| 257 * u16::from(*byte)).collect(),
        _ => bytes.as_chunks().0.iter().map(|two| u16::from_be_bytes(*two)).collect(),
    }
}

fn triples(values: Vec<u16>) -> Vec<[f32; 3]> {
    values
        .as_chunks()
        .0
        .iter()
        .map(|three: &[u16; 3]| three.map(|value| f32::from(value) / 65535.0))
        .collect()
}

/// X, Y, Z under D50 of L*, a*, b* (CIE 15).
fn xyz_of_lab([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    let y = (lightness + 16.0) / 116.0;
    let light = |f: f64| if f > 6.0 / 29.0 { f.powi(3) } else { (f - 4.0 / 29.0) * 108.0 / 841.0 };
    let relative = [y + a / 500.0, y, y - b / 200.0].map(light);
    std::array::from_fn(|k| relative[k] * D50[k])
}
