//! Heights that were not measured: one rule for all formats.
//!
//! A height is missing
//!
//! - where the format says so: a mask, the word of a text (`BAD`, `No Data`, `NaN`, an empty cell), or the
//!   number that the format or the file declares for it; readers return NaN there;
//! - if it is infinite, or beyond 1e30 in size;
//! - if it is one of the usual [`MARKERS`], and farther from all other heights than these are from each
//!   other. In a picture of integers only those below 0 are: pictures are stretched to the full range of
//!   their numbers, so that the largest one, 65535 of 16 bits, is the highest place of any map, and a picture
//!   without signs has no number that is no height. What stands apart there is noted.
//!
//! A map with missing heights is refused with their number. Heights are missing where a surface is steep, so
//! that those of the neighbours would not stand for them: a map that was filled without a word would scatter
//! less than the surface.

use papilio_diagnostics::Diagnostic;

use super::HeightFile;

/// Numbers that programs write for a height that was not measured: round ones, the ends of integer types, and
/// that of Zygo.
const MARKERS: [f64; 17] = [
    -9999.0,
    9999.0,
    -99999.0,
    99999.0,
    -999.0,
    999.0,
    -99.0,
    -999_999.0,
    999_999.0,
    -1e10,
    1e10,
    i16::MIN as f64,
    i16::MAX as f64,
    u16::MAX as f64,
    i32::MIN as f64,
    i32::MAX as f64,
    2_147_483_640.0,
];

/// Size from which a number is no height, in any unit.
const NO_HEIGHT: f64 = 1e30;

/// Fails if heights are missing.
pub(super) fn check(map: &HeightFile) -> Result<(), Diagnostic> {
    let Some((holes, marker)) = holes(map) else { return Ok(()) };
    let marked = marker.map_or(String::new(), |marker| {
        format!(": they are {marker}, a usual mark of missing heights far from all others")
    });
    Err(Diagnostic::new(format!("{holes} of {} heights are missing{marked}", map.numbers.len()))
        .expected("a map without holes")
        .hint("fill them in the program of the instrument, which knows why they are missing, or cut out a part without holes"))
}

/// The number of missing heights, if there are any, and the number that marks them, if it is a usual one that
/// the file does not declare.
fn holes(map: &HeightFile) -> Option<(usize, Option<f64>)> {
    let numbers = &map.numbers;
    let is_mark = |marker: &f64| !map.is_picture || *marker < 0.0;
    let marker = MARKERS.into_iter().find(|marker| is_mark(marker) && stands_apart(numbers, *marker));
    let is_missing = |number: &&f64| is_no_height(**number) || Some(**number) == marker;
    let holes = numbers.iter().filter(is_missing).count();
    (holes > 0).then_some((holes, marker))
}

/// A note on the numbers of a picture that would be marks of missing heights in another file.
pub(super) fn doubt(map: &HeightFile) -> Option<String> {
    let apart = |marker: &f64| *marker > 0.0 && stands_apart(&map.numbers, *marker);
    let marker = MARKERS.into_iter().find(apart).filter(|_| map.is_picture)?;
    let (count, all) = (map.numbers.iter().filter(|number| **number == marker).count(), map.numbers.len());
    Some(format!(
        "{count} of {all} heights are {marker}, far above all others: they are taken as heights, but some programs mark missing ones so"
    ))
}

fn is_no_height(number: f64) -> bool {
    !number.is_finite() || number.abs() >= NO_HEIGHT
}

/// Whether a number occurs, and is farther from all others than they are from each other.
fn stands_apart(numbers: &[f64], marker: f64) -> bool {
    if !numbers.contains(&marker) {
        return false;
    }
    let others = numbers.iter().copied().filter(|number| !is_no_height(*number) && !MARKERS.contains(number));
    let [low, high] = others
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], other| [low.min(other), high.max(other)]);
    let distance = if marker > high { marker - high } else { low - marker };
    low <= high && distance > high - low
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holes(numbers: &[f64]) -> Option<(usize, Option<f64>)> {
        super::holes(&HeightFile::plain(2, numbers.to_vec()))
    }

    #[test]
    fn usual_mark_is_missing_only_far_from_all_other_heights() {
        assert_eq!(holes(&[0.0, 1.0, 2.0, -9999.0]), Some((1, Some(-9999.0))));
        assert_eq!(holes(&[0.0, 1.0, 32767.0, 32767.0]), Some((2, Some(32767.0))));
        assert_eq!(holes(&[f64::NAN, 1.0, -9999.0, 0.5]), Some((2, Some(-9999.0))));
        assert_eq!(holes(&[1.0, 2.0, 3.4e38, f64::INFINITY]), Some((2, None)));
        // Heights of a map in nm.
        assert_eq!(holes(&[-12_000.0, -9999.0, 3000.0, 0.0]), None);
        assert_eq!(holes(&[-9999.0, 0.0, -4000.0, -8000.0]), None);
        assert_eq!(holes(&[0.0, 1.0, 2.0, -8888.0]), None);
    }

    /// The largest number of a picture is a height, and noted; the smallest one of numbers with signs is a
    /// mark.
    #[test]
    fn full_scale_of_a_picture_is_a_height() {
        let picture =
            |numbers: &[f64]| HeightFile { is_picture: true, ..HeightFile::plain(2, numbers.to_vec()) };
        let apart = picture(&[0.0, 100.0, 20_000.0, 65_535.0]);
        assert_eq!(check(&apart), Ok(()));
        assert!(doubt(&apart).unwrap().starts_with("1 of 4 heights are 65535, far above"));
        let stretched = picture(&[0.0, 30_000.0, 50_000.0, 65_535.0]);
        assert_eq!((check(&stretched), doubt(&stretched)), (Ok(()), None));
        assert!(check(&picture(&[0.0, 1.0, 2.0, -32_768.0])).is_err());
    }
}
