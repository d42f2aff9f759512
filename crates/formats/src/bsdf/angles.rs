//! Angles of a file of measured scattering, in degrees, without the rounding of their unit.

use std::collections::HashSet;
use std::ops::Range;

use super::text::Text;
use crate::error::FormatError;
use crate::table::Unit;
use crate::table::rounding::{self, Digits};

/// Angles that differ by less are the same, degrees: other programs round radians before they write degrees.
const SAME_DEG: f64 = 1e-5;

/// Radians.
pub(super) const RADIANS: Unit = Unit::Angle(180.0 / std::f64::consts::PI);
/// Degrees.
pub(super) const DEGREES: Unit = Unit::Angle(1.0);

/// Reader of the angles of a file, which knows the digits with which they are written.
#[derive(Default)]
pub(super) struct Angles {
    /// The digits of angles that are not in degrees, and their unit in degrees.
    digits: Option<(Digits, f64)>,
}

impl Angles {
    /// Reads an angle and returns it in degrees. A right angle is one within its rounding; the rounding of
    /// all others can be removed when all rows are known ([`Self::step`]).
    pub(super) fn degrees(
        &mut self,
        text: Text<'_>,
        cell: Range<usize>,
        unit: Unit,
    ) -> Result<f64, FormatError> {
        let value = text.number(cell.clone())?;
        let factor = if let Unit::Angle(factor) = unit { factor } else { 1.0 };
        let mut error = 0.0;
        if factor != 1.0 {
            let written = std::str::from_utf8(&text.bytes[cell]).unwrap_or_default();
            self.digits.get_or_insert((Digits::default(), factor)).0.note(written);
            error = Digits::of(written).error(value) * factor;
        }
        // Adding 0 turns -0 into 0.
        Ok(rounding::quarter(value * factor, error) + 0.0)
    }

    /// Returns the step of which angles, degrees, are multiples but for their rounding.
    pub(super) fn step(&self, degrees: impl Iterator<Item = f64>) -> Option<f64> {
        let different: HashSet<u64> = degrees.map(f64::to_bits).collect();
        let with_error = |bits: u64| {
            let deg = f64::from_bits(bits);
            // An inclination from the back was 180 deg minus this one in the file.
            let most = deg.abs().max(180.0);
            let error = self.digits.map_or(0.0, |(digits, factor)| digits.error(most / factor) * factor);
            (deg, error.max(SAME_DEG))
        };
        rounding::step(&different.into_iter().map(with_error).collect::<Vec<_>>())
    }
}
