//! Liquid-crystal pixels: reflection of unpolarised or of polarised light against inclination and azimuth.
//!
//! The table holds, at each inclination, harmonics of the azimuth: by reciprocity, the reflectance for unpolarised light is the
//! same at opposite azimuths, and so are sums of mirrored elements of the matrix for polarised light; their differences have opposite signs. Their number is
//! chosen at a few inclinations, and enlarged if it leaves anything out at a node; the nodes are chosen as for films. Nearer to the normal, fewer azimuths
//! are computed, as many as the last harmonics there require.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use papilio_optics::berreman::{SpectralStack, SpectralWaves};
use papilio_optics::{Beta, OpticsError};
use papilio_spectra::{Grid, Spectrum};
use papilio_transport::{
    AngularTable, Base, CosinePanels, Mueller, MuellerAt, MuellerByDirection, Nodes, Reflector,
};
use rayon::prelude::*;

use super::table;
use crate::DisplayError;
use crate::run::{Control, Progress};
use crate::scene::CrystalPixel;

/// Largest harmonic of azimuth that is left out, as a reflectance, where their number is chosen; elsewhere it may be twice as large.
const HARMONIC_ERROR: f64 = 5e-5;

/// Number of harmonics above which the error of each is smaller, because their errors add up.
const MANY_HARMONICS: f64 = 32.0;

/// Interpolation error of the table, as a reflectance. What the faces of a thick, almost matched retarder return to each other is below it.
pub(crate) const TABLE_ERROR: f64 = 1e-4;

/// The same where light is trapped by total reflection: only scatterers with wide lobes send light there, and towards grazing directions the waves that
/// the layers guide make narrow peaks, over azimuth too, whose last harmonics are left out.
const TRAPPED_ERROR: f64 = 5e-3;

/// Least and largest number of azimuths over half a turn: a retardance of 10 um needs 250.
const FEWEST_AZIMUTHS: usize = 8;
const MOST_AZIMUTHS: usize = 1024;

/// Harmonics that are computed beyond those that are kept, at least: others have nearly the same size.
const SPARE: usize = 4;

/// Largest number of values of a table: 0.5 GB, and as much again while its panels are joined.
const MOST_VALUES: usize = 60_000_000;

/// Part of the progress of a computation in which the table is made.
const PART: [f64; 2] = [0.0, 0.8];

/// Sines of the inclinations in air at which the number of harmonics is chosen; below scatterers, also one in glass, with a coarser limit.
const INCLINATIONS: [f64; 3] = [0.7, 0.97, 0.999];
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
    /// below `error` are left out. With it, whether no larger ones are.
    fn harmonics(
        &self,
        (sine, in_air): (f64, bool),
        (count, azimuths): (usize, Azimuths),
        error: f64,
    ) -> Result<(Vec<f64>, bool), OpticsError> {
        if count == 1 {
            // The same at all azimuths.
            return Ok((self.functions(&mut self.waves(sine, in_air)?, &[0.0])?, true));
        }
        let found = self.all_harmonics((sine, in_air), azimuths, error)?;
        let is_whole = found.is_whole
            || count + SPARE <= found.count && self.are_small(&found, count.div_ceil(2), 2.0 * error);
        Ok((self.resized(found, count), is_whole))
    }

    /// Returns the harmonics of all functions, from as few azimuths as show that those left out are below `error`, or from the most.
    fn all_harmonics(
        &self,
        (sine, in_air): (f64, bool),
        Azimuths { fewest, most }: Azimuths,
        error: f64,
    ) -> Result<Harmonics, OpticsError> {
        let step_deg = |azimuths: usize| 180.0 / azimuths as f64;
        let mut azimuths = fewest;
        let first: Vec<f64> = (0..azimuths).map(|k| step_deg(azimuths) * k as f64).collect();
        let mut waves = self.waves(sine, in_air)?;
        let mut rows = self.functions(&mut waves, &first)?;
        loop {
            let mut found = self.harmonics_of(&rows, azimuths);
            // Those of the upper half of the orders, of which at least two are known.
            found.is_whole = self.are_small(&found, found.count / 4 + 1, error);
            if azimuths >= most || found.is_whole {
                return Ok(found);
            }
            let between: Vec<f64> = (0..azimuths).map(|k| step_deg(azimuths) * (k as f64 + 0.5)).collect();
            let more = self.functions(&mut waves, &between)?;
            let of_azimuth = rows.len() / azimuths;
            let pairs = rows.chunks_exact(of_azimuth).zip(more.chunks_exact(of_azimuth));
            rows = pairs.flat_map(|(even, odd)| [even, odd].concat()).collect();
            azimuths *= 2;
        }
    }

    /// Returns as many harmonics as functions `[azimuth][state][element][wavelength]` show.
    fn harmonics_of(&self, rows: &[f64], azimuths: usize) -> Harmonics {
        let (bins, functions, count) = (self.index.len(), self.states * self.elements(), azimuths - 1);
        let mut values = vec![0.0; functions * count * bins];
        for (k, row) in rows.chunks_exact(functions * bins).enumerate() {
            let weights = [false, true]
                .map(|odd| (0..count).map(|harmonic| weight(harmonic, odd, k, azimuths)).collect::<Vec<_>>());
            for (function, of_function) in row.chunks_exact(bins).enumerate() {
                for (harmonic, weight) in weights[usize::from(self.is_odd(function))].iter().enumerate() {
                    let sums = &mut values[(function * count + harmonic) * bins..][..bins];
                    sums.iter_mut().zip(of_function).for_each(|(sum, value)| *sum += weight * value);
                }
            }
        }
        Harmonics { values, count, is_whole: false }
    }

    /// True if the harmonics from this order on are below an error.
    fn are_small(&self, harmonics: &Harmonics, order: usize, error: f64) -> bool {
        let rows = harmonics.values.chunks_exact(self.index.len()).enumerate();
        let mut upper = rows.filter(|(at, _)| (at % harmonics.count).div_ceil(2) >= order);
        upper.all(|(_, row)| row.iter().all(|value| value.abs() < error))
    }

    /// Returns this number of harmonics; unknown ones are 0.
    fn resized(&self, harmonics: Harmonics, count: usize) -> Vec<f64> {
        let Harmonics { values, count: own, .. } = harmonics;
        let bins = self.index.len();
        let resized = |row: &[f64]| {
            let mut row = row.to_vec();
            row.resize(count * bins, 0.0);
            row
        };
        if own == count { values } else { values.chunks_exact(own * bins).flat_map(resized).collect() }
    }

    /// Returns whether the reflectance depends on azimuth, at angles in air or also at all those in glass.
    pub(super) fn is_azimuthal(&self, in_air: bool) -> Result<bool, OpticsError> {
        Ok(self.count(!in_air)?.is_none_or(|count| count > 1))
    }

    /// Returns the number of harmonics that suffice, an odd number; `None` if even the most do not.
    fn count(&self, in_glass: bool) -> Result<Option<usize>, OpticsError> {
        let in_air = INCLINATIONS.map(|sine| ((sine, true), HARMONIC_ERROR));
        let in_glass = in_glass.then_some(((STEEP_IN_GLASS, false), TRAPPED_ERROR));
        let mut count = 1;
        for (at, error) in in_air.into_iter().chain(in_glass) {
            let Some(own) = self.count_at(at, error)? else { return Ok(None) };
            count = own.max(count);
        }
        Ok(Some(count))
    }

    fn count_at(&self, at: (f64, bool), error: f64) -> Result<Option<usize>, OpticsError> {
        let azimuths = Azimuths { fewest: FEWEST_AZIMUTHS, most: MOST_AZIMUTHS };
        let all = self.all_harmonics(at, azimuths, error)?;
        let is_large = |row: &[f64]| row.iter().any(|value| value.abs() > error);
        let rows = all.values.chunks_exact(self.index.len()).enumerate().filter(|(_, row)| is_large(row));
        let order = |at: usize| match self.is_odd(at / all.count) {
            true => at % all.count / 2 + 1,
            false => (at % all.count).div_ceil(2),
        };
        let last = rows.map(|(at, _)| order(at)).max().unwrap_or(0);
        Ok(all.is_whole.then_some((2 * last + 1).min(MOST_AZIMUTHS - 1)))
    }
}

/// Numbers of azimuths over half a turn: the fewest, doubled some times, are the most.
#[derive(Clone, Copy)]
struct Azimuths {
    fewest: usize,
    most: usize,
}

impl Azimuths {
    /// Returns those for this number of harmonics and some more; powers of two for helices, whose slices are such parts of half a turn.
    fn of(count: usize, is_helix: bool) -> Self {
        let least = (count + SPARE).max(FEWEST_AZIMUTHS);
        let doublings = (least / FEWEST_AZIMUTHS).ilog2();
        match is_helix {
            true => Self { fewest: FEWEST_AZIMUTHS, most: least.next_power_of_two() },
            false => {
                let fewest = least.div_ceil(1 << doublings);
                Self { fewest, most: fewest << doublings }
            }
        }
    }
}

/// Harmonics of the azimuth at one inclination.
struct Harmonics {
    /// `[state][element][harmonic][wavelength]`.
    values: Vec<f64>,
    /// Their number.
    count: usize,
    /// Whether all others are negligible, as their last ones show.
    is_whole: bool,
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
    if count != Some(1) && seen.by_adding && !seen.is_bare {
        return Err(AZIMUTH_BELOW_SCATTERER);
    }
    let mut count = count.ok_or(DisplayError::CrystalFringes)?;
    let (bins, states, elements) = (grid.len(), pixel.states.len(), crystal.elements());
    let trapped = match seen.unrefracted {
        true => 0.0,
        false => (1.0 - index.min().powi(-2)).max(0.0).sqrt(),
    };
    let lowest = if seen.is_bare { trapped } else { 0.0 };
    let error = |end: f64| if end <= trapped { TRAPPED_ERROR } else { TABLE_ERROR };
    let is_helix = pixel.parts.iter().any(|part| part.repeats > 1);
    let is_needed = |[from, to]: [f64; 2]| {
        let is_seen = |[low, high]: &[f64; 2]| *high >= from && *low <= to;
        to >= lowest && seen.cosines.is_none_or(|all| all.iter().any(is_seen))
    };
    let (panels, mut values) = loop {
        let azimuths = Azimuths::of(count, is_helix);
        let of_each = (MANY_HARMONICS / count as f64).sqrt().min(1.0);
        let of_node = states * elements * count * bins;
        if azimuths.most > MOST_AZIMUTHS {
            return Err(DisplayError::CrystalFringes);
        }
        let misses = AtomicBool::new(false);
        let all = |cosines: &[f64]| -> Result<Vec<f64>, DisplayError> {
            if !is_needed(ends(cosines)) {
                return Ok(vec![0.0; cosines.len() * of_node]);
            }
            control.map_or(Ok(()), Control::check)?;
            // Ends of panels are known to rounding.
            let is_trapped = ends(cosines)[1] <= trapped * (1.0 + 1e-9);
            let harmonic_error = of_each * if is_trapped { TRAPPED_ERROR } else { HARMONIC_ERROR };
            let rows = cosines.par_iter().map(|cosine| {
                let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
                let (found, is_whole) =
                    crystal.harmonics((sine, false), (count, azimuths), harmonic_error)?;
                if is_whole || *cosine <= trapped {
                    return Ok(found);
                }
                misses.store(true, Ordering::Relaxed);
                Err(DisplayError::CrystalFringes)
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
        let most_panels = MOST_VALUES / (of_node * CosinePanels::NODES);
        let sample = |cosines: &[f64]| Ok(vec![0.0; cosines.len()]);
        let found = table::panels_within((|end| of_each * error(end), most_panels), None, sample, all);
        if !misses.into_inner() {
            break found?.ok_or(DisplayError::CrystalFringes)?;
        }
        count = 2 * count + 1;
    };
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
