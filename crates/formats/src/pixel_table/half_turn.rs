//! Azimuths of a pixel table: a grid in equal steps over half a turn.
//!
//! Light travels the same way back: a mirror-like pixel reflects as much unpolarised light towards an azimuth as towards the opposite one. Rows
//! of opposite azimuths are therefore rows of the same value.

use papilio_diagnostics::{Diagnostic, Warned};

use super::PixelTable;

/// Largest distance from equal steps, degrees: that of azimuths with one decimal.
const ROUNDING_DEG: f64 = 0.06;

/// Largest number of azimuths over half a turn.
const MOST_AZIMUTHS: usize = 360;

/// Differences between opposite azimuths that give a note.
const NOTED: f64 = 1e-4;

/// Those that no mean describes: above this fraction of the mean, and above this reflectance.
const LARGEST_FRACTION: f64 = 0.1;
const LARGEST: f64 = 0.01;

/// Range over azimuth of a table that does not depend on it.
const CONSTANT: f64 = 1e-6;

/// The last harmonic of the azimuth gives a note above this fraction of the mean, and above this reflectance.
const COARSE_FRACTION: f64 = 0.02;
const COARSE: f64 = 1e-3;

/// A grid of azimuths over half a turn, and the place of each azimuth of the table there.
struct Grid {
    phi_deg: Vec<f64>,
    places: Vec<usize>,
}

impl Grid {
    fn of(phi_deg: &[f64]) -> Result<Self, Diagnostic> {
        let folded: Vec<f64> = phi_deg.iter().map(|phi| phi.rem_euclid(180.0)).collect();
        let mut sorted = folded.clone();
        sorted.sort_by(f64::total_cmp);
        let next = sorted.iter().skip(1).copied().chain([sorted[0] + 180.0]);
        let count = sorted.iter().zip(next).filter(|(here, next)| next - *here > ROUNDING_DEG).count();
        if count < 2 {
            let wrong = Diagnostic::new("this table has one azimuth only (opposite ones count as one)");
            return Err(wrong
                .expected("azimuths in equal steps over 180 deg, or no column of azimuth")
                .hint(
                    "without the column, the reflectance is the same at all azimuths; `papilio pixel --phi-step 5` writes several",
                ));
        }
        if count > MOST_AZIMUTHS {
            let wrong = format!("this table has {count} azimuths over half a turn");
            return Err(Diagnostic::new(wrong)
                .expected(format!(
                    "at most {MOST_AZIMUTHS}: steps of {} deg or more",
                    180.0 / MOST_AZIMUTHS as f64
                ))
                .hint("keep every second azimuth, or fewer: harmonics interpolate between them"));
        }
        let step = 180.0 / count as f64;
        let first = folded[0] % step;
        let steps: Vec<f64> = folded.iter().map(|folded| (folded - first) / step).collect();
        let places: Vec<usize> =
            steps.iter().map(|at| (at.round() as i64).rem_euclid(count as i64) as usize).collect();
        let mut is_known = vec![false; count];
        places.iter().for_each(|place| is_known[*place] = true);
        let are_equal = steps.iter().all(|at| (at - at.round()).abs() * step <= ROUNDING_DEG);
        if !are_equal || !is_known.iter().all(|known| *known) {
            let listed =
                sorted.iter().take(6).map(|phi| round(*phi, 2).to_string()).collect::<Vec<_>>().join(", ");
            let more = if sorted.len() > 6 { ", ..." } else { "" };
            let wrong = format!(
                "the azimuths of this table, {listed}{more} deg over half a turn, are not in equal steps"
            );
            return Err(Diagnostic::new(wrong).expected("equal steps over 180 deg, or over 360 deg").hint(
                "add the azimuths that are missing, or interpolate the table with the tool that made it",
            ));
        }
        Ok(Self { phi_deg: (0..count).map(|k| first + step * k as f64).collect(), places })
    }
}

impl PixelTable {
    /// Returns the table with azimuths in equal steps over half a turn, the means of opposite ones, and one value along the normal; without azimuths
    /// if it does not depend on them. The warnings are notes: what was averaged, and azimuths that are too coarse for the values.
    ///
    /// # Errors
    /// If there is one azimuth, or they are in unequal steps; if opposite ones, or those along the normal, differ by more than 10 % of their mean
    /// and 0.01.
    pub fn over_half_turn(self) -> Result<Warned<Self>, Diagnostic> {
        if self.phi_deg.is_empty() {
            return Ok(Warned { value: self, warnings: Vec::new() });
        }
        let grid = Grid::of(&self.phi_deg)?;
        let mut folding = Folding { table: &self, grid: &grid, apart: None, coarse: None, is_constant: true };
        let mut states = Vec::with_capacity(self.states.len());
        for (name, values) in &self.states {
            let bins = self.wavelength_nm.len();
            let rows = values.chunks(self.phi_deg.len() * bins).zip(&self.theta_deg);
            let folded = rows.map(|(row, theta)| folding.row(name, *theta, row));
            states.push((name.clone(), folded.collect::<Result<Vec<_>, _>>()?.concat()));
        }
        let warnings = folding.notes();
        let is_constant = folding.is_constant;
        let Self { theta_deg, wavelength_nm, .. } = self;
        let mut value = Self { theta_deg, phi_deg: grid.phi_deg, wavelength_nm, states };
        if is_constant {
            value.leave_out_azimuths();
        }
        Ok(Warned { value, warnings })
    }

    /// Replaces all azimuths by their first.
    fn leave_out_azimuths(&mut self) {
        let (bins, azimuths) = (self.wavelength_nm.len(), self.phi_deg.len());
        for (_, values) in &mut self.states {
            *values = values.chunks(azimuths * bins).flat_map(|row| row[..bins].to_vec()).collect();
        }
        self.phi_deg.clear();
    }
}

/// Something at a place of the table.
struct Found {
    size: f64,
    place: String,
}

struct Folding<'a> {
    table: &'a PixelTable,
    grid: &'a Grid,
    /// Largest difference of what was averaged.
    apart: Option<Found>,
    /// Largest last harmonic, as a fraction of the mean.
    coarse: Option<(f64, Found)>,
    is_constant: bool,
}

impl Folding<'_> {
    /// Returns `[azimuth][wavelength]` on the grid of a row of the table's azimuths.
    fn row(&mut self, state: &str, theta_deg: f64, row: &[f64]) -> Result<Vec<f64>, Diagnostic> {
        let (bins, count) = (self.table.wavelength_nm.len(), self.grid.phi_deg.len());
        let mut out = vec![0.0; count * bins];
        for (bin, nm) in self.table.wavelength_nm.iter().enumerate() {
            let place = || format!("state `{state}` at {theta_deg} deg and {nm} nm");
            let values = row.iter().skip(bin).step_by(bins);
            let mut together: Vec<Vec<f64>> = vec![Vec::new(); if theta_deg == 0.0 { 1 } else { count }];
            for (value, at) in values.zip(&self.grid.places) {
                let at = at % together.len();
                together[at].push(*value);
            }
            for (at, same) in together.iter().enumerate() {
                let [least, most] = ends(same);
                let mean = mean(same);
                if most - least > LARGEST.max(LARGEST_FRACTION * mean) {
                    return Err(contradicts(theta_deg, [least, most], &place()));
                }
                if most - least > self.apart.as_ref().map_or(NOTED, |apart| apart.size) {
                    self.apart = Some(Found { size: most - least, place: place() });
                }
                // Along the normal, one value is that of all azimuths.
                (at..count).step_by(together.len()).for_each(|at| out[at * bins + bin] = mean);
            }
            let over_azimuth: Vec<f64> = (0..count).map(|at| out[at * bins + bin]).collect();
            let [least, most] = ends(&over_azimuth);
            self.is_constant &= most - least <= CONSTANT;
            let (mean, last) = (mean(&over_azimuth), last_harmonic(&over_azimuth));
            if last > COARSE && last > self.coarse.as_ref().map_or(COARSE_FRACTION, |coarse| coarse.0) * mean
            {
                self.coarse = Some((last / mean, Found { size: last, place: place() }));
            }
        }
        Ok(out)
    }

    fn notes(&self) -> Vec<String> {
        let count = self.grid.phi_deg.len();
        let apart = self.apart.as_ref().map(|Found { size, place }| {
            format!(
                "opposite azimuths, or those along the normal, differ by up to {} ({place}): their mean is used",
                round(*size, 5)
            )
        });
        let coarse = self.coarse.as_ref().map(|(_, Found { size, place })| {
            format!(
                "steps of {} deg in azimuth are coarse for these reflectances: the last harmonic that they determine, of {} times the azimuth, \
                 is {} ({place}); between the azimuths, they are uncertain by about as much",
                round(180.0 / count as f64, 2),
                2 * (count / 2),
                round(*size, 4)
            )
        });
        apart.into_iter().chain(coarse).collect()
    }
}

/// Returns the error about values that should be one.
fn contradicts(theta_deg: f64, [least, most]: [f64; 2], place: &str) -> Diagnostic {
    let (what, expected) = match theta_deg {
        0.0 => {
            ("different azimuths", "one value along the normal, where all azimuths are the same direction")
        }
        _ => (
            "opposite azimuths",
            "the same: unpolarised light takes each way in both directions (reciprocity)",
        ),
    };
    Diagnostic::new(format!("{place} has reflectances from {least} to {most} at {what}")).expected(expected).hint(
        "azimuths are those to which mirrored light travels, one for each pair of lamp and viewer; what depends on the side of the lamp \
         alone is no mirror: give it as a BSDF (model = \"measured\")",
    )
}

/// Amplitude of the last harmonic that values in equal steps over half a turn determine.
fn last_harmonic(values: &[f64]) -> f64 {
    let order = values.len() / 2;
    let turn = |k: usize| std::f64::consts::TAU * (order * k) as f64 / values.len() as f64;
    let of = |wave: fn(f64) -> f64| values.iter().enumerate().map(|(k, r)| r * wave(turn(k))).sum::<f64>();
    let scale = if 2 * order == values.len() { 1.0 } else { 2.0 };
    scale * of(f64::cos).hypot(of(f64::sin)) / values.len() as f64
}

fn ends(values: &[f64]) -> [f64; 2] {
    [values.iter().copied().fold(f64::INFINITY, f64::min), values.iter().copied().fold(0.0, f64::max)]
}

/// Returns the mean; of equal values, that value to the last bit.
fn mean(values: &[f64]) -> f64 {
    values[0] + values.iter().map(|value| value - values[0]).sum::<f64>() / values.len() as f64
}

fn round(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    (value * scale).round() / scale
}
