//! Luminaires: intensity by direction, from a photometric file.

use std::borrow::Cow;

use super::opening::Opening;
use super::{eulumdat, ies};
use crate::error::FormatError;
use crate::file::DataFile;

/// Far field of a luminaire.
#[derive(Debug, Clone, PartialEq)]
pub struct Luminaire {
    pub(super) photometry: Photometry,
    /// Angles of the photometry, degrees, ascending.
    pub(super) vertical_deg: Vec<f64>,
    pub(super) horizontal_deg: Vec<f64>,
    /// Intensity, cd, `[horizontal][vertical]`, all factors included.
    pub(super) candela: Vec<f64>,
    /// The luminous opening.
    pub opening: Opening,
    /// What of the file is not used, or remarkable, in words.
    pub notes: Vec<String>,
}

/// Coordinates of the angles (CIE 121-1996; LM-63).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Photometry {
    /// Vertical planes about the vertical axis: elevation from the horizontal, -90 to 90 deg, and azimuth,
    /// clockwise from C = 0.
    A,
    /// Planes about the horizontal axis across C = 0: angle from the nadir towards C = 0, -90 to 90 deg, and
    /// angle out of the plane C = 0, clockwise.
    B,
    /// Vertical planes: angle from the nadir, 0 to 180 deg, and azimuth, counterclockwise seen from above.
    C,
}

/// A circle of directions on which an intensity is not smooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntensityEdge {
    /// Its centre: a unit vector along C = 0, along C = 90 deg, and down.
    pub centre: [f64; 3],
    /// Its angular radius, degrees.
    pub radius_deg: f64,
}

impl Luminaire {
    /// Returns the intensity, cd, in a direction given by the angles from the nadir and around it (C),
    /// degrees. It is interpolated linearly between the angles of the file, and is 0 beyond them.
    pub fn intensity(&self, vertical_deg: f64, horizontal_deg: f64) -> f64 {
        let (vertical, horizontal) = self.angles_of(vertical_deg, horizontal_deg);
        let (Some((v, along)), Some((h, around))) = (
            between(&self.vertical_deg, vertical),
            self.by_symmetry(horizontal).and_then(|horizontal| between(&self.horizontal_deg, horizontal)),
        ) else {
            return 0.0;
        };
        let rows = self.vertical_deg.len();
        let at =
            |h: usize, v: usize| self.candela[h.min(self.horizontal_deg.len() - 1) * rows + v.min(rows - 1)];
        let on = |h: usize| (1.0 - along) * at(h, v) + along * at(h, v + 1);
        (1.0 - around) * on(h) + around * on(h + 1)
    }

    /// Converts angles of type C to those of the photometry.
    fn angles_of(&self, vertical_deg: f64, horizontal_deg: f64) -> (f64, f64) {
        if self.photometry == Photometry::C {
            return (vertical_deg, horizontal_deg.rem_euclid(360.0));
        }
        let (sin, down) = vertical_deg.to_radians().sin_cos();
        let (sin_turn, cos_turn) = horizontal_deg.to_radians().sin_cos();
        // Counterclockwise from C = 0 is to the left.
        let (along, right) = (sin * cos_turn, -sin * sin_turn);
        let (vertical, horizontal) = match self.photometry {
            Photometry::A => ((-down).clamp(-1.0, 1.0).asin(), right.atan2(along)),
            _ => (along.atan2(down), right.clamp(-1.0, 1.0).asin()),
        };
        (vertical.to_degrees(), horizontal.to_degrees())
    }

    /// Returns the angle of the file that has the intensity of this horizontal angle; `None` if the file has
    /// none.
    fn by_symmetry(&self, horizontal: f64) -> Option<f64> {
        let first = self.horizontal_deg.first().copied()?;
        let last = self.horizontal_deg.last().copied()?;
        if self.photometry != Photometry::C {
            return Some(if first == 0.0 { horizontal.abs() } else { horizontal });
        }
        // Files from 90 to 270 deg are symmetric about the plane through these angles.
        let turn = if first > 0.0 && !(90.0..=270.0).contains(&horizontal) {
            (180.0 - horizontal).rem_euclid(360.0)
        } else {
            horizontal
        };
        let half = if turn > 180.0 { 360.0 - turn } else { turn };
        Some(match last {
            last if last <= 0.0 => 0.0,
            last if last <= 90.0 => half.min(180.0 - half),
            last if last <= 180.0 => half,
            _ if first > 0.0 => turn.clamp(first, last),
            _ => turn,
        })
    }

    /// Returns the circles between which the intensity is smooth, at most this many of each angle. Angles
    /// that follow from the symmetry are included.
    pub fn edges(&self, most: usize) -> Vec<IntensityEdge> {
        let thinned = |angles: Vec<f64>| {
            let step = angles.len().div_ceil(most).max(1);
            angles.into_iter().step_by(step).collect::<Vec<f64>>()
        };
        let turned = |turn: f64| {
            let (sin, cos) = (turn + 90.0).to_radians().sin_cos();
            [cos, sin, 0.0]
        };
        let edge = |centre, radius_deg| IntensityEdge { centre, radius_deg };
        let (verticals, horizontals) = (thinned(self.vertical_deg.clone()), thinned(self.all_horizontal()));
        let mut edges: Vec<IntensityEdge> = match self.photometry {
            Photometry::A | Photometry::C => {
                let from = if self.photometry == Photometry::A { 90.0 } else { 0.0 };
                verticals.iter().map(|angle| edge([0.0, 0.0, 1.0], angle + from)).collect()
            }
            Photometry::B => verticals
                .iter()
                .map(|angle| {
                    // The plane through the horizontal axis: its normal is a quarter of a turn away.
                    let (sin, cos) = angle.to_radians().sin_cos();
                    edge([cos, 0.0, -sin], 90.0)
                })
                .collect(),
        };
        edges.extend(horizontals.iter().map(|angle| match self.photometry {
            Photometry::A => edge(turned(-angle), 90.0),
            Photometry::B => edge([0.0, -1.0, 0.0], 90.0 - angle),
            Photometry::C => edge(turned(*angle), 90.0),
        }));
        edges
    }

    /// Returns the horizontal angles, and those that the symmetry adds, of type C modulo 180 deg; none if the
    /// intensity does not depend on them.
    fn all_horizontal(&self) -> Vec<f64> {
        let of = &self.horizontal_deg;
        if of.len() < 2 {
            return Vec::new();
        }
        let is_c = self.photometry == Photometry::C;
        let symmetric = of[0] > 0.0 || of[0] == 0.0 && (!is_c || of[of.len() - 1] <= 180.0);
        let turns = of.iter().flat_map(|turn| [Some(*turn), symmetric.then_some(-turn)]).flatten();
        let mut turns: Vec<f64> =
            turns.map(|turn| if is_c { turn.rem_euclid(180.0) } else { turn }).collect();
        turns.sort_by(f64::total_cmp);
        turns.dedup_by(|a, b| *a - *b < 1e-9);
        turns
    }

    /// Returns the luminous flux, lm, by a sum over bands of 1 deg: of all directions, and of those below the
    /// horizontal.
    pub fn flux_lm(&self) -> [f64; 2] {
        let mut flux = [0.0; 2];
        let turns = if self.photometry == Photometry::C && self.horizontal_deg.len() == 1 { 1 } else { 180 };
        for band in 0..360 {
            let vertical = 0.5 * (f64::from(band) + 0.5);
            let half = 0.25_f64.to_radians();
            let area =
                2.0 * vertical.to_radians().sin() * half.sin() * std::f64::consts::TAU / f64::from(turns);
            let sum: f64 = (0..turns)
                .map(|turn| self.intensity(vertical, (f64::from(turn) + 0.5) * 360.0 / f64::from(turns)))
                .sum();
            flux[0] += area * sum;
            if vertical < 90.0 {
                flux[1] += area * sum;
            }
        }
        flux
    }
}

/// Returns the index of the last of the `angles` that is not larger than `angle`, and the relative position
/// between it and the next one; `None` outside the angles.
fn between(angles: &[f64], angle: f64) -> Option<(usize, f64)> {
    let (first, last) = (*angles.first()?, *angles.last()?);
    if !(first - 1e-9..=last + 1e-9).contains(&angle) {
        return None;
    }
    let k = angles.partition_point(|known| *known <= angle).max(1) - 1;
    let next = angles.get(k + 1).copied().unwrap_or(angles[k] + 1.0);
    Some((k, ((angle - angles[k]) / (next - angles[k])).clamp(0.0, 1.0)))
}

/// Reads a luminaire: an IES LM-63 file (.ies) or a EULUMDAT file (.ldt), detected from the content.
///
/// # Errors
/// With line and column: cells that are not numbers, angles out of order, negative intensities, too few or
/// too many numbers, horizontal angles of no symmetry of the format.
pub fn read_luminaire(file: &DataFile) -> Result<Luminaire, FormatError> {
    crate::guard::read(file, of_any_format)
}

fn of_any_format(file: &DataFile) -> Result<Luminaire, FormatError> {
    let text = decoded(file);
    // A EULUMDAT file that is cut off is known by its name alone.
    let is_named_ldt = file.name.to_ascii_lowercase().ends_with(".ldt");
    if ies::is_ies(&text) || !(eulumdat::is_eulumdat(&text) || is_named_ldt) {
        ies::read(&file.name, &text)
    } else {
        eulumdat::read(&file.name, &text)
    }
}

/// Returns true if this is the file of a luminaire.
pub fn is_luminaire(file: &DataFile) -> bool {
    let text = decoded(file);
    ies::is_ies(&text) || eulumdat::is_eulumdat(&text)
}

/// Returns the text of a file, in the encodings of all tables.
fn decoded(file: &DataFile) -> Cow<'_, str> {
    crate::table::decode(&file.bytes).unwrap_or_else(|| String::from_utf8_lossy(&file.bytes))
}
