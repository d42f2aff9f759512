//! Reader of FRED's lists of scatter data (`type bsdf_data`).
//!
//! A line `format` gives the units. Then follow blocks: a line with the direction of the light, and a row for
//! each direction of the scattered light. Out of plane, these are `theta_i phi_i` and `theta_s phi_s value`;
//! in the plane of incidence `theta_i` and `theta_s value`, where positive angles are on the specular side.
//! The file does not state whether it is a reflection or a transmission.
//!
//! Public descriptions do not settle whether `phi_s = phi_i` or `phi_s = phi_i + 180 deg` is the specular
//! direction. It is detected from the values, which are larger there.

use std::ops::Range;

use papilio_goniometry::{Channel, Direction, Measurement, Provenance};

use super::angles::{Angles, DEGREES, RADIANS};
use super::table_rows::Rows;
use super::text::{Lines, Text};
use super::{BsdfFile, BsdfProblem};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// Name of the format.
const NAME: &str = "FRED scatter data";

/// Smallest inclination of the light at which its azimuth is meaningful, degrees.
const OBLIQUE_DEG: f64 = 1.0;

/// Largest angle, degrees, between a direction of the list and the specular direction that it represents.
const NEAR_DEG: f64 = 10.0;

/// Returns whether a file begins with the keyword of this format.
pub(super) fn is_fred(file: &DataFile) -> bool {
    let text = Text::new(file);
    let Ok(Some(line)) = Lines::new(text).next() else { return false };
    let mut words = text.words(line);
    words.next().is_some_and(|word| text.is(&word, "type"))
        && words.next().is_some_and(|word| text.is(&word, "bsdf_data"))
}

/// Units of the numbers.
struct Units {
    radians: bool,
    scale: f64,
}

/// A block: the direction of the light, and the rows.
struct Block {
    theta_deg: f64,
    phi_deg: f64,
    /// Inclination and azimuth, degrees, value, place.
    rows: Vec<(f64, f64, f64, Range<usize>)>,
}

pub(super) fn read(file: &DataFile) -> Result<BsdfFile, FormatError> {
    let text = Text::new(file);
    let mut lines = Lines::new(text);
    lines.expect("the line `type`")?;
    let mut units = Units { radians: false, scale: 1.0 };
    let mut rows: Vec<(Range<usize>, Vec<Range<usize>>)> = Vec::new();
    while let Some(line) = lines.next()? {
        let words: Vec<Range<usize>> = text.words(line.clone()).take(4).collect();
        if rows.is_empty() && text.bytes[line.start].is_ascii_alphabetic() {
            units.read(text, line)?;
        } else {
            rows.push((line, words));
        }
    }
    let most = rows.iter().map(|(_, words)| words.len()).max().unwrap_or(0);
    if rows.is_empty() {
        return Err(text.ends("the first row of data"));
    }
    let columns = if most <= 2 { 2 } else { 3 };
    let (mut table, mut blocks) = (Rows::default(), Vec::<Block>::new());
    for (line, words) in rows {
        add(text, &units, (line, words), columns, (&mut table.angles, &mut blocks))?;
    }
    blocks.iter_mut().for_each(complete);
    fill_missing(&mut blocks);
    let (specular_deg, note) = if columns == 2 { (180.0, None) } else { specular(&blocks) };
    for block in &blocks {
        for (theta, phi, value, place) in &block.rows {
            // Light comes from the side opposite to the specular direction.
            let mut angles = [block.theta_deg, block.phi_deg + specular_deg, *theta, *phi];
            if angles[1] >= 360.0 {
                angles[1] -= 360.0;
            }
            table.add_unfolded(text, place.clone(), angles, (Channel::Monochrome, *value))?;
        }
    }
    let parts = table.parts(text)?;
    let states_part = blocks.iter().any(|block| block.rows.iter().any(|row| row.0 > 90.0));
    let provenance = Provenance { format: NAME.to_owned(), remarks: lines.comments, ..Provenance::default() };
    let measurement = Measurement { provenance, media: [1.0, 1.0], parts };
    Ok(BsdfFile {
        measurement,
        warnings: Vec::new(),
        notes: note.into_iter().collect(),
        states_part,
        states_side: states_part,
    })
}

impl Units {
    /// Reads a line of the header: `format angles=deg bsdf=value scale=1`.
    fn read(&mut self, text: Text<'_>, line: Range<usize>) -> Result<(), FormatError> {
        let mut words = text.words(line);
        let Some(key) = words.next() else { return Ok(()) };
        if !text.is(&key, "format") {
            let expected = "`format`, or a row of numbers";
            return Err(text.error(key.clone(), BsdfProblem::Unexpected { found: text.quote(key), expected }));
        }
        for word in words {
            let option = text.quote(word.clone()).to_ascii_lowercase();
            match option.split_once('=') {
                Some(("angles", "deg")) => self.radians = false,
                Some(("angles", "rad")) => self.radians = true,
                Some(("bsdf", "value")) => {}
                Some(("scale", _)) => {
                    let at = word.end - option.len() + "scale=".len();
                    self.scale = text.number(at..word.end)?;
                    if self.scale.is_nan() || self.scale <= 0.0 {
                        let expected = "a number above 0";
                        let problem = Problem::OutOfRange { what: "the scale", value: self.scale, expected };
                        return Err(text.error(word, problem));
                    }
                }
                _ => {
                    let expected = "`angles=deg`, `angles=rad`, `bsdf=value` or `scale=NUMBER`";
                    return Err(text.error(word, BsdfProblem::Unexpected { found: option, expected }));
                }
            }
        }
        Ok(())
    }

    /// Reads an angle, in degrees.
    fn angle(
        &self,
        text: Text<'_>,
        word: Range<usize>,
        (angles, range): (&mut Angles, [f64; 2]),
    ) -> Result<f64, FormatError> {
        let value = angles.degrees(text, word.clone(), if self.radians { RADIANS } else { DEGREES })?;
        if (range[0]..=range[1]).contains(&value) {
            return Ok(value);
        }
        let expected = "an angle in the units of the line `format`";
        Err(text.error(word, Problem::OutOfRange { what: "this angle", value, expected }))
    }
}

/// Adds a line to the blocks; rows have `columns` numbers, and the line before them has one less.
fn add(
    text: Text<'_>,
    units: &Units,
    (line, words): (Range<usize>, Vec<Range<usize>>),
    columns: usize,
    (angles, blocks): (&mut Angles, &mut Vec<Block>),
) -> Result<(), FormatError> {
    let in_plane = columns == 2;
    let head = words.len() + 1 == columns;
    if !head && (words.len() != columns || blocks.is_empty()) {
        let expected = match in_plane {
            true => "the angle of incidence, or below it two columns: theta_s, value",
            false => "the two angles of incidence, or below them three columns: theta_s, phi_s, value",
        };
        return Err(text.error(line, Problem::Columns { count: columns, expected, found: words.len() }));
    }
    let theta = units.angle(
        text,
        words[0].clone(),
        (&mut *angles, if head { [-90.0, 90.0] } else { [-180.0, 180.0] }),
    )?;
    let phi = match in_plane {
        true => 0.0,
        false => units.angle(text, words[1].clone(), (angles, [-360.0, 720.0]))?,
    };
    if head {
        blocks.push(Block {
            theta_deg: theta.abs(),
            phi_deg: if theta < 0.0 { phi + 180.0 } else { phi },
            rows: Vec::new(),
        });
        return Ok(());
    }
    let value = text.value(words[columns - 1].clone())? * units.scale;
    if let Some(block) = blocks.last_mut() {
        // In the plane, the sign of the angle is the side of the normal.
        let phi = if theta < 0.0 { phi + 180.0 } else { phi };
        block.rows.push((theta.abs(), if phi >= 360.0 { phi - 360.0 } else { phi }, value, line));
    }
    Ok(())
}

/// Repeats the value at the pole, which lists often give at one azimuth only, at all azimuths of the block.
fn complete(block: &mut Block) {
    let is_pole = |theta: f64| theta == 0.0 || theta == 180.0;
    let mut azimuths: Vec<f64> = block.rows.iter().filter(|row| !is_pole(row.0)).map(|row| row.1).collect();
    azimuths.sort_by(f64::total_cmp);
    azimuths.dedup();
    for pole in [0.0, 180.0] {
        let at_pole: Vec<_> = block.rows.iter().filter(|row| row.0 == pole).cloned().collect();
        if let [(theta, _, value, place)] = &at_pole[..] {
            block.rows.retain(|row| row.0 != pole);
            let copies = azimuths.iter().map(|phi| (*theta, *phi, *value, place.clone()));
            block.rows.extend(copies);
            if azimuths.is_empty() {
                block.rows.extend(at_pole);
            }
        }
    }
}

/// Adds directions that some blocks have and others lack, as not measured, if most are there: blocks with the
/// same directions form a grid.
fn fill_missing(blocks: &mut [Block]) {
    let mut all: Vec<[f64; 2]> =
        blocks.iter().flat_map(|block| block.rows.iter().map(|row| [row.0, row.1])).collect();
    let axis = |k: usize| {
        let mut axis: Vec<f64> = all.iter().map(|angles| angles[k]).collect();
        axis.sort_by(f64::total_cmp);
        axis.dedup();
        axis
    };
    let (thetas, phis) = (axis(0), axis(1));
    let cells = blocks.len().saturating_mul(thetas.len()).saturating_mul(phis.len());
    if cells > 2 * all.len() {
        return;
    }
    for block in blocks {
        all.clear();
        all.extend(block.rows.iter().map(|row| [row.0, row.1]));
        all.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let Some(place) = block.rows.first().map(|row| row.3.clone()) else { continue };
        let is_there = |theta: f64, phi: f64| {
            all.binary_search_by(|known| known[0].total_cmp(&theta).then(known[1].total_cmp(&phi))).is_ok()
        };
        for theta in &thetas {
            let missing = phis.iter().filter(|phi| !is_there(*theta, **phi));
            block.rows.extend(missing.map(|phi| (*theta, *phi, f64::NAN, place.clone())));
        }
    }
}

/// Returns the azimuth of the light relative to `phi_i`, and a note on it: the values about the specular
/// direction are larger than those about its mirror image in the normal.
fn specular(blocks: &[Block]) -> (f64, Option<String>) {
    let near = |block: &Block, phi: f64| {
        let target = Direction::new(block.theta_deg, phi).vector();
        let cosine = |row: &(f64, f64, f64, Range<usize>)| {
            let theta = if row.0 > 90.0 { 180.0 - row.0 } else { row.0 };
            let to = Direction::new(theta, row.1).vector();
            to.iter().zip(&target).map(|(a, b)| a * b).sum::<f64>()
        };
        let nearest = block.rows.iter().max_by(|a, b| cosine(a).total_cmp(&cosine(b)));
        nearest
            .filter(|row| cosine(row) > NEAR_DEG.to_radians().cos() && row.2.is_finite())
            .map_or(0.0, |row| row.2)
    };
    let oblique = || blocks.iter().filter(|block| block.theta_deg >= OBLIQUE_DEG);
    let [same, opposite] =
        [0.0, 180.0].map(|turn| oblique().map(|block| near(block, block.phi_deg + turn)).sum::<f64>());
    if oblique().next().is_none() {
        return (180.0, None);
    }
    let (light_deg, at) = if opposite > same { (0.0, "phi_i + 180 deg") } else { (180.0, "phi_i") };
    (
        light_deg,
        Some(format!("the specular direction is taken to be phi_s = {at}, where the values are the largest")),
    )
}
