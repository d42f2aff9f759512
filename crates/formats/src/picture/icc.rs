//! ICC profiles of displays and cameras: three primaries with their transfer functions, or grey (ICC.1:2022, 8.3 and 8.4).
//!
//! Profiles that consist of tables alone (printers, CMYK) are not read.

use super::colour_space::{adaptation, d65, product, transposed};
use super::source::ColourEncoding;
use super::transfer::Transfer;

/// White of the profile connection space, D50.
const D50: [f64; 3] = [0.9642, 1.0, 0.8249];

/// Why a profile is not used.
pub(super) const NOT_USED: &str = "its ICC profile has no primaries with transfer functions";

/// Reads a profile for a picture of three colours, or of grey.
pub(super) fn read(profile: &[u8], is_coloured: bool) -> Option<ColourEncoding> {
    let profile = Profile { bytes: profile };
    if profile.at(36, 4)? != b"acsp" || profile.at(20, 4)? != b"XYZ " && is_coloured {
        return None;
    }
    let name = profile.name().unwrap_or_else(|| "ICC profile".to_owned());
    if !is_coloured {
        let grey = profile.curve(b"kTRC")?;
        let xyz_from_rgb = [[0.0; 3]; 3];
        return Some(ColourEncoding { name, transfers: [0; 3].map(|_| grey.clone()), xyz_from_rgb });
    }
    let transfers = [profile.curve(b"rTRC")?, profile.curve(b"gTRC")?, profile.curve(b"bTRC")?];
    let columns = [profile.colour(b"rXYZ")?, profile.colour(b"gXYZ")?, profile.colour(b"bXYZ")?];
    let xyz_from_rgb = product(adaptation(D50, d65())?, transposed(columns));
    Some(ColourEncoding { name, transfers, xyz_from_rgb })
}

struct Profile<'a> {
    bytes: &'a [u8],
}

impl Profile<'_> {
    fn at(&self, start: usize, length: usize) -> Option<&[u8]> {
        self.bytes.get(start..start.checked_add(length)?)
    }

    /// The content of a tag.
    fn tag(&self, name: &[u8; 4]) -> Option<&[u8]> {
        let count = number(self.at(128, 4)?)? as usize;
        let entries = self.bytes.get(132..)?.chunks_exact(12).take(count);
        let entry = entries.into_iter().find(|entry| entry.starts_with(name))?;
        self.at(number(&entry[4..8])? as usize, number(&entry[8..12])? as usize)
    }

    fn colour(&self, name: &[u8; 4]) -> Option<[f64; 3]> {
        let tag = self.tag(name)?;
        let value = |k: usize| fixed(tag.get(8 + 4 * k..12 + 4 * k)?);
        tag.starts_with(b"XYZ ").then_some([value(0)?, value(1)?, value(2)?])
    }

    fn curve(&self, name: &[u8; 4]) -> Option<Transfer> {
        let tag = self.tag(name)?;
        match tag.get(..4)? {
            b"curv" => {
                let count = number(tag.get(8..12)?)? as usize;
                let steps = tag.get(12..)?.get(..count.checked_mul(2)?)?;
                let steps: Vec<u16> =
                    steps.as_chunks().0.iter().map(|two| u16::from_be_bytes(*two)).collect();
                Some(match steps[..] {
                    [] => Transfer::Linear,
                    [gamma] => Transfer::Gamma(f64::from(gamma) / 256.0),
                    _ => Transfer::Table(steps),
                })
            }
            b"para" => {
                let value = |k: usize| fixed(tag.get(12 + 4 * k..16 + 4 * k)?);
                let g = value(0)?;
                Some(match tag.get(8..10)? {
                    [0, 0] => Transfer::Gamma(g),
                    [0, 1] => {
                        let (a, b) = (value(1)?, value(2)?);
                        Transfer::Parametric([g, a, b, 0.0, -b / a, 0.0, 0.0])
                    }
                    [0, 2] => {
                        let (a, b, c) = (value(1)?, value(2)?, value(3)?);
                        Transfer::Parametric([g, a, b, 0.0, -b / a, c, c])
                    }
                    [0, 3] => Transfer::Parametric([g, value(1)?, value(2)?, value(3)?, value(4)?, 0.0, 0.0]),
                    [0, 4] => Transfer::Parametric([
                        g,
                        value(1)?,
                        value(2)?,
                        value(3)?,
                        value(4)?,
                        value(5)?,
                        value(6)?,
                    ]),
                    _ => return None,
                })
            }
            _ => None,
        }
    }

    /// The description: its printable characters, 80 at most.
    fn name(&self) -> Option<String> {
        let tag = self.tag(b"desc")?;
        let text = match tag.get(..4)? {
            b"desc" => {
                String::from_utf8_lossy(tag.get(12..)?.get(..number(tag.get(8..12)?)? as usize)?).into_owned()
            }
            b"mluc" => {
                let (length, start) =
                    (number(tag.get(20..24)?)? as usize, number(tag.get(24..28)?)? as usize);
                let text = tag.get(start..start.checked_add(length)?)?;
                let units: Vec<u16> = text.as_chunks().0.iter().map(|two| u16::from_be_bytes(*two)).collect();
                String::from_utf16_lossy(&units)
            }
            _ => return None,
        };
        let text: String = text.chars().filter(|letter| !letter.is_control()).take(80).collect();
        (!text.trim().is_empty()).then(|| text.trim().to_owned())
    }
}

fn number(bytes: &[u8]) -> Option<u32> {
    Some(u32::from_be_bytes(bytes.try_into().ok()?))
}

/// A number in units of 1/65536.
fn fixed(bytes: &[u8]) -> Option<f64> {
    Some(f64::from(i32::from_be_bytes(bytes.try_into().ok()?)) / 65536.0)
}
