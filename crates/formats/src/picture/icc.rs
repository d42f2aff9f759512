//! ICC profiles: a table, or three primaries with their transfer functions, or grey (ICC.1:2022, 8.2 to 8.4).
//!
//! A table comes first, as in other programs: its author has put into it what primaries cannot describe.

use super::colour_space::{adaptation, d65, product, transposed};
use super::icc_table::IccTable;
use super::source::{ColourEncoding, Light};
use super::transfer::Transfer;

/// White of the profile connection space, D50.
pub(super) const D50: [f64; 3] = [0.9642, 1.0, 0.8249];

/// Why a profile is not used.
pub(super) const NOT_USED: &str = "its ICC profile is not one for its colours, or is damaged";

/// Reads a profile for a picture of grey (1), three colours (3) or CMYK (4).
pub(super) fn read(profile: &[u8], inputs: usize) -> Option<ColourEncoding> {
    let profile = Profile { bytes: profile };
    let is_of_inks = profile.at(16, 4)? == b"CMYK";
    if profile.at(36, 4)? != b"acsp" || is_of_inks != (inputs == 4) {
        return None;
    }
    let name = profile.name().unwrap_or_else(|| "ICC profile".to_owned());
    if let Some(table) = IccTable::read(&profile, inputs) {
        let to_d65 = adaptation(D50, d65())?;
        return Some(ColourEncoding { name, light: Light::Table { table: Box::new(table), to_d65 } });
    }
    if inputs == 1 {
        let grey = profile.curve(b"kTRC")?;
        let light = Light::Matrix { transfers: [0; 3].map(|_| grey.clone()), xyz_from_rgb: [[0.0; 3]; 3] };
        return Some(ColourEncoding { name, light });
    }
    if inputs != 3 || profile.at(20, 4)? != b"XYZ " {
        return None;
    }
    let transfers = [profile.curve(b"rTRC")?, profile.curve(b"gTRC")?, profile.curve(b"bTRC")?];
    let columns = [profile.colour(b"rXYZ")?, profile.colour(b"gXYZ")?, profile.colour(b"bXYZ")?];
    let xyz_from_rgb = product(adaptation(D50, d65())?, transposed(columns));
    Some(ColourEncoding { name, light: Light::Matrix { transfers, xyz_from_rgb } })
}

pub(super) struct Profile<'a> {
    bytes: &'a [u8],
}

impl Profile<'_> {
    pub(super) fn at(&self, start: usize, length: usize) -> Option<&[u8]> {
        self.bytes.get(start..start.checked_add(length)?)
    }

    /// The content of a tag.
    pub(super) fn tag(&self, name: &[u8; 4]) -> Option<&[u8]> {
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
        Transfer::of_icc(self.tag(name)?).map(|(curve, _)| curve)
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

pub(super) fn number(bytes: &[u8]) -> Option<u32> {
    Some(u32::from_be_bytes(bytes.try_into().ok()?))
}

/// A number in units of 1/65536.
pub(super) fn fixed(bytes: &[u8]) -> Option<f64> {
    Some(f64::from(i32::from_be_bytes(bytes.try_into().ok()?)) / 65536.0)
}
