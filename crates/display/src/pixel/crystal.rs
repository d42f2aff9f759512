//! Liquid-crystal pixels: reflection of unpolarised or of polarised light against inclination and azimuth.
//!
//! The table holds, at each inclination, harmonics of the azimuth: by reciprocity, the reflectance for unpolarised light is the
//! same at opposite azimuths, and so are sums of mirrored elements of the matrix for polarised light; their differences have opposite signs. Their number is chosen at a steep inclination, the nodes as for films. Nearer to the normal, fewer azimuths are
//! computed, as many as the last harmonics there require.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, PoisonError};

use papilio_optics::berreman::{SpectralStack, SpectralWaves};
use papilio_optics::{Beta, OpticsError};
use papilio_spectra::{Grid, Spectrum};
use papilio_transport::{AngularTable, Base, Mueller, MuellerAt, MuellerByDirection, Nodes, Reflector};
use rayon::prelude::*;

use super::table;
use crate::DisplayError;
use crate::run::{Control, Progress};
use crate::scene::CrystalPixel;

/// Largest harmonic of azimuth that is left out, as a reflectance.
const HARMONIC_ERROR: f64 = 5e-5;

/// Interpolation error of the table, as a reflectance. What the faces of a thick, almost matched retarder return to each other is below it.
pub(crate) const TABLE_ERROR: f64 = 1e-4;

/// The same where light is trapped by total reflection: only scatterers with wide lobes send light there, and towards grazing directions the waves that
/// the layers guide make narrow peaks.
const TRAPPED_ERROR: f64 = 5e-3;

/// Least and largest number of azimuths over half a turn, powers of two.
const FEWEST_AZIMUTHS: usize = 8;
const MOST_AZIMUTHS: usize = 64;

/// Part of the progress of a computation in which the table is made.
const PART: [f64; 2] = [0.0, 0.8];

/// Sine of the inclination in air at which they are; below scatterers, also one in glass, with a coarser limit.
const STEEP: f64 = 0.97;
const STEEP_IN_GLASS: f64 = 0.9;

/// Error: a scatterer above the pixel, by adding.
pub(crate) const AZIMUTH_BELOW_SCATTERER: DisplayError = DisplayError::Azimuth {
    what: "adding below these scatterers and in this light",
    key: "solver.method",
    hint: "\"monte-carlo\" does, by `papilio run` and `sweep`; adding knows one diffuser given by its lobe, which sends no image back, on clear glass of one index",
};

/// A pixel on the wavelengths of a scene.
#[derive(Debug)]
pub(super) struct Crystal {
    stack: SpectralStack,
    index: Vec<f64>,
    states: usize,
    /// Whether the table is one for polarised light.
    polarised: bool,
    /// Factor of elements with the phase of p and s while the table is made: below 1, it is coarser for them.
    of_phases: f64,
}

/// The same where nothing but the pixel and the face is polarised: what the face reflects of the phase, up to a fifth at 70 deg, meets the pixel twice.
const UNSEEN_PHASES: f64 = 0.1;

/// Returns whether an element has the phase of p and s.
fn has_phase(element: usize) -> bool {
    element / 4 >= 2 || element % 4 >= 2
}

impl Crystal {
    pub(super) fn new(pixel: &CrystalPixel, grid: &Grid, index: &Spectrum) -> Result<Self, OpticsError> {
        let stack = SpectralStack::new(&grid.wavelengths_nm(), index, &pixel.parts, &pixel.substrate)?;
        Ok(Self {
            stack,
            index: index.to_vec(),
            states: pixel.states.len(),
            polarised: false,
            of_phases: 1.0,
        })
    }

    /// Number of functions of each state.
    fn elements(&self) -> usize {
        if self.polarised { Mueller::ELEMENTS } else { 1 }
    }

    /// Returns whether a function, by its number, has odd multiples of the azimuth.
    fn is_odd(&self, function: usize) -> bool {
        self.polarised && Mueller::is_odd(function % Mueller::ELEMENTS)
    }

    /// Returns the waves of light at this inclination; `beta` at each wavelength is `sine` times the index, or the sine itself in air. Grazing light
    /// is reflected as that at 89.99 deg.
    fn waves(&self, sine: f64, in_air: bool) -> Result<SpectralWaves<'_>, OpticsError> {
        const GRAZING: f64 = 1.0 - 1e-8;
        let beta = |n: &f64| if in_air { sine.min(GRAZING * n) } else { sine.min(GRAZING) * n };
        self.stack.at(&self.index.iter().map(beta).collect::<Vec<f64>>())
    }

    /// Computes the reflectance, `[azimuth][state][wavelength]`, of light that leaves towards these azimuths.
    pub(super) fn reflectance(
        &self,
        sine: f64,
        in_air: bool,
        phi_deg: &[f64],
    ) -> Result<Vec<f64>, OpticsError> {
        self.reflectance_of(&mut self.waves(sine, in_air)?, phi_deg)
    }

    /// Computes all functions of the table, `[azimuth][state][element][wavelength]`.
    fn functions(&self, waves: &mut SpectralWaves<'_>, phi_deg: &[f64]) -> Result<Vec<f64>, OpticsError> {
        if !self.polarised {
            return self.reflectance_of(waves, phi_deg);
        }
        let bins = self.index.len();
        let mut all = self.matrices(waves, phi_deg)?;
        for matrix in all.chunks_exact_mut(Mueller::ELEMENTS * bins) {
            for bin in 0..bins {
                let of = |element: usize| matrix[element * bins + bin];
                let symmetric = Mueller::symmetric(std::array::from_fn(of));
                for (element, value) in symmetric.into_iter().enumerate() {
                    let factor = if has_phase(element) { self.of_phases } else { 1.0 };
                    matrix[element * bins + bin] = factor * value;
                }
            }
        }
        Ok(all)
    }

    /// Computes the matrices for polarised light, `[azimuth][state][element][wavelength]`.
    fn matrices(&self, waves: &mut SpectralWaves<'_>, phi_deg: &[f64]) -> Result<Vec<f64>, OpticsError> {
        let own = self.stack.states();
        let matrix = Mueller::ELEMENTS * self.index.len();
        let mut out = vec![0.0; phi_deg.len() * own * matrix];
        waves.actions(phi_deg, &mut out)?;
        Ok(match own == self.states {
            true => out,
            false => out.chunks_exact(own * matrix).flat_map(|row| row.repeat(self.states)).collect(),
        })
    }

    fn reflectance_of(
        &self,
        waves: &mut SpectralWaves<'_>,
        phi_deg: &[f64],
    ) -> Result<Vec<f64>, OpticsError> {
        // A stack whose parts are the same in all states is computed once.
        let (own, bins) = (self.stack.states(), self.index.len());
        let mut out = vec![0.0; phi_deg.len() * own * bins];
        waves.reflectance(phi_deg, &mut out)?;
        Ok(if own == self.states {
            out
        } else {
            out.chunks_exact(own * bins).flat_map(|row| row.repeat(self.states)).collect()
        })
    }

    /// Returns the first `count` harmonics of all functions, `[state][element][harmonic][wavelength]`, from at most this number of azimuths; those
    /// below `error` are left out.
    fn harmonics(
        &self,
        (sine, in_air): (f64, bool),
        (count, most): (usize, usize),
        error: f64,
    ) -> Result<Vec<f64>, OpticsError> {
        if count == 1 {
            // The same at all azimuths.
            return self.functions(&mut self.waves(sine, in_air)?, &[0.0]);
        }
        let step_deg = |azimuths: usize| 180.0 / azimuths as f64;
        let mut azimuths = FEWEST_AZIMUTHS.min(most);
        let first: Vec<f64> = (0..azimuths).map(|k| step_deg(azimuths) * k as f64).collect();
        let mut waves = self.waves(sine, in_air)?;
        let mut rows = self.functions(&mut waves, &first)?;
        loop {
            let own = count.min(azimuths - 1);
            let found = self.harmonics_of(&rows, azimuths, own);
            if azimuths >= most || self.are_last_small(&found, own, error) {
                return Ok(self.padded(found, own, count));
            }
            let between: Vec<f64> = (0..azimuths).map(|k| step_deg(azimuths) * (k as f64 + 0.5)).collect();
            let more = self.functions(&mut waves, &between)?;
            let of_azimuth = rows.len() / azimuths;
            let pairs = rows.chunks_exact(of_azimuth).zip(more.chunks_exact(of_azimuth));
            rows = pairs.flat_map(|(even, odd)| [even, odd].concat()).collect();
            azimuths *= 2;
        }
    }

    /// Returns harmonics, `[state][element][harmonic][wavelength]`, of functions `[azimuth][state][element][wavelength]`.
    fn harmonics_of(&self, rows: &[f64], azimuths: usize, count: usize) -> Vec<f64> {
        let (bins, functions) = (self.index.len(), self.states * self.elements());
        let mut out = vec![0.0; functions * count * bins];
        for (k, row) in rows.chunks_exact(functions * bins).enumerate() {
            let weights = [false, true]
                .map(|odd| (0..count).map(|harmonic| weight(harmonic, odd, k, azimuths)).collect::<Vec<_>>());
            for (function, values) in row.chunks_exact(bins).enumerate() {
                for (harmonic, weight) in weights[usize::from(self.is_odd(function))].iter().enumerate() {
                    let sums = &mut out[(function * count + harmonic) * bins..][..bins];
                    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
                }
            }
        }
        out
    }

    /// True if the harmonics of the upper half of the orders, of which at least two are known, are negligible.
    fn are_last_small(&self, harmonics: &[f64], count: usize, error: f64) -> bool {
        let bins = self.index.len();
        let rows = harmonics.chunks_exact(bins).enumerate();
        let mut upper = rows.filter(|(at, _)| (at % count).div_ceil(2) > count / 4);
        upper.all(|(_, row)| row.iter().all(|value| value.abs() < error))
    }

    /// Adds harmonics of 0.
    fn padded(&self, harmonics: Vec<f64>, own: usize, count: usize) -> Vec<f64> {
        if own == count {
            return harmonics;
        }
        let bins = self.index.len();
        let rows = harmonics.chunks_exact(own * bins);
        rows.flat_map(|row| row.iter().copied().chain(vec![0.0; (count - own) * bins])).collect()
    }

    /// Returns whether the reflectance depends on azimuth, at angles in air or also at all those in glass.
    pub(super) fn is_azimuthal(&self, in_air: bool) -> Result<bool, OpticsError> {
        Ok(self.count(!in_air)? > 1)
    }

    /// Returns the number of harmonics that suffice, an odd number.
    fn count(&self, in_glass: bool) -> Result<usize, OpticsError> {
        let in_air = self.count_at(STEEP, true, HARMONIC_ERROR)?;
        Ok(if in_glass { in_air.max(self.count_at(STEEP_IN_GLASS, false, TRAPPED_ERROR)?) } else { in_air })
    }

    fn count_at(&self, sine: f64, in_air: bool, error: f64) -> Result<usize, OpticsError> {
        let most = MOST_AZIMUTHS - 1;
        let all = self.harmonics((sine, in_air), (most, MOST_AZIMUTHS), error)?;
        let bins = self.index.len();
        let is_large = |row: &[f64]| row.iter().any(|value| value.abs() > error);
        let rows = all.chunks_exact(bins).enumerate().filter(|(_, row)| is_large(row));
        let order = |at: usize| match self.is_odd(at / most) {
            true => at % most / 2 + 1,
            false => (at % most).div_ceil(2),
        };
        let last = rows.map(|(at, _)| order(at)).max().unwrap_or(0);
        Ok((2 * last + 1).min(most))
    }
}

/// Returns the ends of the panel with these Chebyshev nodes.
fn ends(nodes: &[f64]) -> [f64; 2] {
    let [low, high] = [f64::min, f64::max].map(|of| nodes.iter().copied().fold(nodes[0], of));
    let outside = 0.5 * (high - low) * ((PI / (2 * nodes.len()) as f64).cos().recip() - 1.0);
    [low - outside, high + outside]
}

/// Weight of azimuth number `k` in a harmonic: 1, cos 2 phi, sin 2 phi, ...; or, of odd multiples, cos phi, sin phi, cos 3 phi, ...
fn weight(harmonic: usize, odd: bool, k: usize, azimuths: usize) -> f64 {
    let multiple = if odd { harmonic / 2 * 2 + 1 } else { harmonic.div_ceil(2) * 2 };
    let turn = PI * (multiple * k) as f64 / azimuths as f64;
    let is_sine = if odd { !harmonic.is_multiple_of(2) } else { harmonic > 0 && harmonic.is_multiple_of(2) };
    let wave = if is_sine { turn.sin() } else { turn.cos() };
    (if multiple == 0 { 1.0 } else { 2.0 * wave }) / azimuths as f64
}

/// How a liquid-crystal pixel is seen.
#[derive(Clone, Copy)]
pub(super) struct Seen<'a> {
    /// Below flat layers, light has directions that exist in air: others are left at 0, unless it is unrefracted.
    pub(super) is_bare: bool,
    /// Light is computed by adding, without a filter and below more than one layer: it knows no azimuth there.
    pub(super) by_adding: bool,
    pub(super) unrefracted: bool,
    /// Whether the polarisation of light is followed, and whether anything but the pixel and the face is polarised.
    pub(super) polarised: bool,
    pub(super) phases: bool,
    /// Ranges of the cosine between which the pixel is to be known: panels of the table without any of them are left at 0. `None`: all.
    pub(super) cosines: Option<&'a [[f64; 2]]>,
}

/// Computes a liquid-crystal pixel as the base of a stack, and for polarised light, if it is followed.
///
/// # Errors
/// If the pixel depends on azimuth, by adding below a scatterer; if the computation was stopped.
pub(super) fn base(
    pixel: &CrystalPixel,
    grid: &Grid,
    index: &Spectrum,
    seen: Seen<'_>,
    control: Option<&Control<'_>>,
) -> Result<(Base, Option<Arc<Mueller>>), DisplayError> {
    let mut crystal = Crystal::new(pixel, grid, index)?;
    crystal.polarised = seen.polarised;
    crystal.of_phases = if seen.phases { 1.0 } else { UNSEEN_PHASES };
    let count = crystal.count(!seen.is_bare)?;
    if count > 1 && seen.by_adding && !seen.is_bare {
        return Err(AZIMUTH_BELOW_SCATTERER);
    }
    let most = (count + 1).next_power_of_two().max(FEWEST_AZIMUTHS);
    let (bins, states, elements) = (grid.len(), pixel.states.len(), crystal.elements());
    let trapped = match seen.unrefracted {
        true => 0.0,
        false => (1.0 - index.min().powi(-2)).max(0.0).sqrt(),
    };
    let lowest = if seen.is_bare { trapped } else { 0.0 };
    let error = |end: f64| if end <= trapped { TRAPPED_ERROR } else { TABLE_ERROR };
    let is_needed = |[from, to]: [f64; 2]| {
        let is_seen = |[low, high]: &[f64; 2]| *high >= from && *low <= to;
        to >= lowest && seen.cosines.is_none_or(|all| all.iter().any(is_seen))
    };
    let all = |cosines: &[f64]| -> Result<Vec<f64>, DisplayError> {
        if !is_needed(ends(cosines)) {
            return Ok(vec![0.0; cosines.len() * states * elements * count * bins]);
        }
        control.map_or(Ok(()), Control::check)?;
        // Ends of panels are known to rounding.
        let is_trapped = ends(cosines)[1] <= trapped * (1.0 + 1e-9);
        let harmonic_error = if is_trapped { TRAPPED_ERROR } else { HARMONIC_ERROR };
        let rows = cosines.par_iter().map(|cosine| {
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            crystal.harmonics((sine, false), (count, most), harmonic_error)
        });
        let rows = rows.collect::<Result<Vec<_>, _>>()?.concat();
        // Panels come in ascending order of the cosine.
        let done = cosines.iter().copied().fold(lowest, f64::max);
        let share_of_view = Some((done - lowest) / (1.0 - lowest));
        let now = Progress { share_of_view, unit: "tables of the pixel", ..Progress::of_views(0, 1) };
        if let Some(control) = control {
            (control.progress)(now.within(PART));
        }
        Ok(rows)
    };
    // A sample as good as the whole would take as long: the whole decides.
    let panels = table::panels_within(error, None, |cosines| Ok(vec![0.0; cosines.len()]), all)?;
    let (panels, mut values) = panels.ok_or(DisplayError::CrystalFringes)?;
    if seen.polarised && !seen.phases {
        let of_element = count * bins;
        let own: &mut [f64] = Arc::make_mut(&mut values);
        let elements = own.chunks_exact_mut(of_element).enumerate();
        let phases = elements.filter(|(number, _)| has_phase(number % Mueller::ELEMENTS));
        phases.for_each(|(_, element)| element.iter_mut().for_each(|value| *value /= UNSEEN_PHASES));
    }
    let inactive_reflectance = pixel.inactive_reflectance.map(|r| (1.0 - pixel.fill_factor) * r);
    let mueller = seen.polarised.then(|| Mueller {
        by_direction: MuellerByDirection::Table {
            panels: panels.clone(),
            harmonics: count,
            values: Arc::clone(&values),
        },
        states,
        active: pixel.fill_factor,
        inactive: inactive_reflectance.to_vec(),
    });
    let basis = if seen.polarised { means(&values, count * bins) } else { values };
    let nodes = Nodes::CosinePanels(panels);
    let nodes = if count == 1 { nodes } else { Nodes::Azimuthal(Box::new(nodes), count) };
    let own = |state: usize, basis: usize| if basis == state * count { pixel.fill_factor } else { 0.0 };
    let mixture = (0..states).flat_map(|state| (0..states * count).map(move |basis| own(state, basis)));
    let common = inactive_reflectance.to_vec();
    let table = AngularTable { nodes, basis, mixture: mixture.collect(), common };
    let inactive_absorptance = pixel.inactive_reflectance.map(|r| (1.0 - pixel.fill_factor) * (1.0 - r));
    Ok((Base { reflector: Reflector::Specular(table), inactive_absorptance }, mueller.map(Arc::new)))
}

/// Returns a liquid-crystal pixel that is computed for each direction, below flat layers in air, and a base without a table.
pub(super) fn exact(
    pixel: &CrystalPixel,
    grid: &Grid,
    index: &Spectrum,
) -> Result<(Base, Arc<Mueller>), DisplayError> {
    let crystal = Crystal { polarised: true, ..Crystal::new(pixel, grid, index)? };
    let (bins, states) = (grid.len(), pixel.states.len());
    let inactive = pixel.inactive_reflectance.map(|r| (1.0 - pixel.fill_factor) * r).to_vec();
    let table = AngularTable {
        nodes: Nodes::Constant,
        basis: vec![0.0; states * bins].into(),
        mixture: vec![0.0; states * states],
        common: inactive.clone(),
    };
    let inactive_absorptance = pixel.inactive_reflectance.map(|r| (1.0 - pixel.fill_factor) * (1.0 - r));
    let base = Base { reflector: Reflector::Specular(table), inactive_absorptance };
    let by_direction = MuellerByDirection::Exact(Arc::new(Exact { crystal, known: Mutex::default() }));
    Ok((base, Arc::new(Mueller { by_direction, states, active: pixel.fill_factor, inactive })))
}

/// A pixel that is computed for each direction, and those that are known.
#[derive(Debug)]
struct Exact {
    crystal: Crystal,
    known: Mutex<HashMap<[i64; 2], Arc<[f64]>>>,
}

/// Largest number of directions that are kept.
const MOST_DIRECTIONS: usize = 4096;

impl MuellerAt for Exact {
    fn at(&self, beta: Beta) -> Arc<[f64]> {
        // Directions that differ by rounding are the same.
        let key = [beta.x, beta.y].map(|x| (x * 1e13).round() as i64);
        let known =
            |key: &[i64; 2]| self.known.lock().unwrap_or_else(PoisonError::into_inner).get(key).cloned();
        if let Some(known) = known(&key) {
            return known;
        }
        let bins = self.crystal.index.len();
        let found: Arc<[f64]> = match known(&key.map(|x| -x)) {
            Some(opposite) => reversed(&opposite, bins).into(),
            None => {
                let phi_deg = beta.y.atan2(beta.x).to_degrees();
                let found = self.crystal.waves(beta.length(), true);
                let found = found.and_then(|mut waves| self.crystal.matrices(&mut waves, &[phi_deg]));
                // A display that cannot be computed is no number.
                let none = || vec![f64::NAN; self.crystal.states * Mueller::ELEMENTS * bins];
                found.unwrap_or_else(|_| none()).into()
            }
        };
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() < MOST_DIRECTIONS {
            known.insert(key, Arc::clone(&found));
        }
        found
    }
}

/// Returns the matrices of a direction from those of the opposite azimuth.
fn reversed(matrices: &[f64], bins: usize) -> Vec<f64> {
    let mut out = matrices.to_vec();
    for matrix in out.chunks_exact_mut(Mueller::ELEMENTS * bins) {
        for bin in 0..bins {
            let elements = Mueller::reversed(std::array::from_fn(|element| matrix[element * bins + bin]));
            elements.into_iter().enumerate().for_each(|(at, value)| matrix[at * bins + bin] = value);
        }
    }
    out
}

/// Returns the reflectance for unpolarised light from symmetric elements, each with this number of values: half of p from p and s from s, and the sum of
/// both others.
fn means(values: &[f64], of_element: usize) -> Arc<[f64]> {
    let of = |elements: &[f64]| -> Vec<f64> {
        let [pp, ps, ss] = [0, 1, 5].map(|element| &elements[element * of_element..][..of_element]);
        (0..of_element).map(|k| 0.5 * (pp[k] + ss[k]) + ps[k]).collect()
    };
    values.chunks_exact(Mueller::ELEMENTS * of_element).flat_map(of).collect()
}
