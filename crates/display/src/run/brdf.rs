//! BSDF of the display by adding: a beam from each inclination of the light, viewed from all directions.
//!
//! The scene's lights and views are not used. Under a single beam the reflectance factor is
//! pi dL/dE, so that the BRDF is the reflectance factor over pi. By reciprocity, the
//! directional-hemispherical reflectance of a beam is the reflectance factor viewed from the beam's direction
//! in diffuse light.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

use papilio_optics::Beta;
use papilio_transport::adding::{Kernel, error_over_difference};
use papilio_transport::{Cone, Estimate, ReflectanceFactor, Source, specular_image};
use rayon::ThreadPool;

use super::cone::target;
use super::progress::{Progress, SAMPLE, part_of_pass};
use super::refine::{Refined, finest, largest, largest_of_states, of_levels, refine, row_errors, slowness};
use super::saved::{Kind, row_number};
use super::{Control, SavedRows, Unsaved, Workers, each};
use crate::brdf::{BrdfGrid, BrdfTable, SameViewers};
use crate::scene::{Pixel, Scene};
use crate::setup::Setup;
use crate::viewers::BrdfState;
use crate::{DisplayError, RowErrors};

/// Computes the BSDF of the scene's display for unpolarised light, by adding independently of the scene's method.
///
/// The scene's `relative_error` applies to the luminous BRDF (in an equal-energy light) of each state
/// in a sample of directions; all directions are computed at the level of the sample.
///
/// # Errors
/// If the scene is invalid, or the computation was stopped.
pub fn brdf(scene: &Scene, grid: BrdfGrid, control: &Control<'_>) -> Result<BrdfTable, DisplayError> {
    brdf_resumed(scene, grid, control, &Unsaved)
}

/// Computes the same as [`brdf`]; rows that `saved` has are not computed, and others are saved there.
///
/// # Errors
/// Those of [`brdf`].
pub fn brdf_resumed(
    scene: &Scene,
    grid: BrdfGrid,
    control: &Control<'_>,
    saved: &dyn SavedRows,
) -> Result<BrdfTable, DisplayError> {
    if !grid.phi_i_deg.is_empty() {
        return Ok(
            super::viewers::brdf_at_viewers_resumed(scene, SameViewers(grid), control, saved)?.of_grid()
        );
    }
    let setup = Setup::new(&scene.clone().unpolarised(), control)?;
    setup.check_isotropic()?;
    let mut workers = None;
    let pool = Workers::unless_one(&mut workers, control.threads)?;
    let survey = Survey::new((&setup, control, saved), &grid, finest(&setup)?);
    survey.run(pool).ok_or(DisplayError::Interrupted)?.finite()
}

/// Returns whether the BSDF of the scene's display depends on the azimuth of the light: its grid needs azimuths of the light then.
///
/// # Errors
/// If the scene is invalid, or the computation was stopped.
pub fn depends_on_azimuth(scene: &Scene, control: &Control<'_>) -> Result<bool, DisplayError> {
    let pixel = &scene.display.pixel;
    if !matches!(pixel, Pixel::Crystal(_)) && !pixel.is_azimuthal_table() {
        return Ok(false);
    }
    let silent = Control { progress: &|_| {}, ..*control };
    Ok(Setup::new(&scene.clone().unpolarised(), &silent)?.stack.base().is_azimuthal())
}

pub(super) struct Survey<'a> {
    pub(super) setup: &'a Setup,
    pub(super) control: &'a Control<'a>,
    /// Rows of an earlier computation, and where rows are saved.
    pub(super) saved: &'a dyn SavedRows,
    grid: &'a BrdfGrid,
    /// One beam for each direction of the light.
    pub(super) beams: Vec<Source>,
    /// Finest level that can be computed for the layers.
    pub(super) finest: usize,
}

/// Y of each state under each source and from each view.
pub(super) type Luminous = Vec<f64>;

/// Spectra and their Y for each inclination of the viewer, and the number of nodes.
type Scattered = (Vec<Vec<f32>>, Vec<Luminous>, u64);

/// What is scattered towards some viewers.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct OfViewers {
    /// BRDF, the wavelength fastest.
    pub(super) spectra: Vec<f32>,
    /// Y, without the wavelength.
    pub(super) luminous: Luminous,
    /// Number of nodes.
    pub(super) nodes: u64,
}

impl OfViewers {
    /// All numbers, to be saved.
    pub(super) fn numbers(&self) -> Vec<f64> {
        let spectra = self.spectra.iter().copied().map(f64::from);
        std::iter::once(self.nodes as f64).chain(self.luminous.iter().copied()).chain(spectra).collect()
    }

    /// Reads [`numbers`](Self::numbers) of this many Y and wavelengths; `None` if there are others.
    pub(super) fn from_numbers(numbers: &[f64], luminous: usize, bins: usize) -> Option<Self> {
        let (nodes, rest) = numbers.split_first()?;
        let (y, spectra) =
            rest.split_at_checked(luminous).filter(|(_, rest)| rest.len() == luminous * bins)?;
        let spectra = spectra.iter().map(|value| *value as f32).collect();
        Some(Self { spectra, luminous: y.to_vec(), nodes: *nodes as u64 })
    }
}

/// Scattered spectra and number of nodes; relative errors of Y of each row.
type Rows = ((Vec<Vec<f32>>, u64), Vec<f64>);

impl<'a> Survey<'a> {
    pub(super) fn new(
        (setup, control, saved): (&'a Setup, &'a Control<'a>, &'a dyn SavedRows),
        grid: &'a BrdfGrid,
        finest: usize,
    ) -> Self {
        let beams = beams(&grid.lights_deg());
        Self { setup, control, saved, grid, beams, finest }
    }

    /// `None` if it was stopped.
    fn run(&self, pool: Option<&ThreadPool>) -> Option<BrdfTable> {
        let target = target(&self.setup.scene);
        let mut kernel = Kernel::new(0);
        let sample = self.sample(target, &mut kernel)?;
        let ((scattered, nodes), relative) = self.rows(&sample, &mut kernel, target, pool)?;
        let returned = self.returned(&kernel)?;
        let state = |(number, name): (usize, &String)| BrdfState {
            name: name.clone(),
            brdf: self.table(number, &scattered),
            specular: self.specular(number),
            directional_hemispherical: self
                .of_state(number, returned.iter().map(|estimate| &estimate.rho[0])),
        };
        Some(BrdfTable {
            wavelength_nm: self.setup.scene.grid.wavelengths_nm(),
            states: self.setup.states.iter().enumerate().map(state).collect(),
            nodes,
            discretisation_error: relative.iter().copied().fold(0.0, largest),
            row_errors: RowErrors { relative, target, allowed: None },
            grid: self.grid.clone(),
        })
    }

    /// Computes a sample of inclinations and azimuths; leaves the kernel that met the target in `kernel`.
    pub(super) fn sample(&self, target: f64, kernel: &mut Kernel) -> Option<Refined<Luminous>> {
        let some = |values: &[f64], most: usize| -> Vec<f64> {
            values.iter().step_by(values.len().div_ceil(most).max(1)).chain(values.last()).copied().collect()
        };
        let azimuths = some(&self.grid.dphi_deg, 3);
        let fields: Vec<Cone> = some(&self.grid.theta_o_deg, 4)
            .iter()
            .flat_map(|theta| azimuths.iter().map(|phi| view(*theta, *phi)))
            .collect();
        let sources: Vec<Source> = std::iter::once(&Source::Diffuse).chain(&self.beams).cloned().collect();
        let mut last = 0;
        let at = |level: usize| {
            if self.control.stopped() {
                return None;
            }
            last = level;
            *kernel = Kernel::new(level as u32);
            // The preparation of a panel is reused, and takes milliseconds: its sample is not saved.
            let number = self.setup.stack.panel().is_none().then(|| row_number(Kind::Sample, level, 0));
            let count = fields.len() * sources.len() * self.setup.states.len();
            let known = number.and_then(|number| self.saved.find(number));
            if let Some(known) = known.filter(|known| known.len() == count) {
                return Some(known);
            }
            self.prepare(kernel, &fields, &sources)?;
            let mut all = Luminous::new();
            for view in 0..fields.len() {
                let estimate = kernel.estimate_unless(&self.setup.stack, view, self.control.stop)?;
                estimate.rho.iter().for_each(|rho| self.add_luminous(rho, &mut all));
            }
            number.into_iter().for_each(|number| self.saved.save(number, &all));
            Some(all)
        };
        let bound = error_over_difference(&self.setup.stack, &self.beams);
        let error = |levels: [&Luminous; 2], before: Option<&Luminous>| {
            of_levels(bound, levels.map(Clone::clone), before.map(Vec::as_slice))
        };
        let of_sample = Progress { unit: "directions", ..Progress::of_views(0, 1) }.within([0.0, SAMPLE]);
        let report = |error: f64, _: bool| (self.control.progress)(of_sample.with_error(error, target));
        let refined = refine(target, self.finest, bound, at, error, report)?;
        // A level that fluctuates more than one before is computed, but not used.
        if refined.level != last {
            *kernel = Kernel::new(refined.level as u32);
        }
        Some(refined)
    }

    /// Prepares a kernel; `None` if it was stopped.
    fn prepare(&self, kernel: &mut Kernel, views: &[Cone], sources: &[Source]) -> Option<()> {
        kernel.prepare_unless(&self.setup.stack, views, sources, self.control.stop).then_some(())
    }

    /// Appends the Y of each state.
    pub(super) fn add_luminous(&self, rho: &ReflectanceFactor, all: &mut Luminous) {
        let y_bar = self.setup.observer.weights()[1];
        let sum = |rho: &[f64]| rho.iter().zip(y_bar).map(|(r, y)| r * y).sum::<f64>();
        let front = sum(&rho.front);
        all.extend(rho.via_pixel.chunks_exact(y_bar.len()).map(|base| sum(base) + front));
    }

    /// Computes the scattered spectra as [`Self::scattered`] does, the number of nodes and the relative
    /// errors of Y. The kernels of a panel resolve its lobes in all directions: the error of the sample
    /// applies to all. Under general layers, each row is compared with that of the previous level, and if one
    /// misses the target, all are computed at the next level. Leaves the last kernel in `kernel`.
    fn rows(
        &self,
        sample: &Refined<Luminous>,
        kernel: &mut Kernel,
        target: f64,
        pool: Option<&ThreadPool>,
    ) -> Option<Rows> {
        let (mut spectra, mut luminous, mut nodes) = self.scattered(kernel, (sample.level, 0), pool)?;
        if self.setup.stack.panel().is_some() {
            let errors = vec![sample.error; self.setup.states.len() * self.grid.pairs()];
            return Some(((spectra, nodes), errors));
        }
        let rest = slowness([&sample.finer, &sample.coarser], sample.before.as_deref());
        let times = error_over_difference(&self.setup.stack, &self.beams).max(rest);
        let mut level = sample.level;
        let (_, mut coarser, _) = self.scattered(&Kernel::new(level as u32 - 1), (level - 1, 1), pool)?;
        for pass in 2.. {
            let errors = self.errors(&luminous, &coarser, times);
            let misses = |error: &f64| error.is_finite() && *error > target;
            if level >= self.finest || !errors.iter().any(misses) {
                return Some(((spectra, nodes), errors));
            }
            level += 1;
            *kernel = Kernel::new(level as u32);
            coarser = luminous;
            (spectra, luminous, nodes) = self.scattered(kernel, (level, pass), pool)?;
        }
        None
    }

    /// Returns the relative errors of Y, `[state][theta_i][theta_o][dphi]`.
    fn errors(&self, luminous: &[Luminous], coarser: &[Luminous], times: f64) -> Vec<f64> {
        let (states, lights) = (self.setup.states.len(), self.beams.len());
        let most = largest_of_states(luminous.iter().map(Vec::as_slice), states);
        let by_viewer: Vec<Vec<f64>> = luminous
            .iter()
            .zip(coarser)
            .map(|(finer, coarser)| row_errors(finer, coarser, &most, times))
            .collect();
        let mut errors = Vec::with_capacity(states * self.grid.pairs());
        for state in 0..states {
            for light in 0..lights {
                for viewer in &by_viewer {
                    let row = |dphi: usize| viewer[(dphi * lights + light) * states + state];
                    errors.extend((0..self.grid.dphi_deg.len()).map(row));
                }
            }
        }
        errors
    }

    /// The part of the progress that is a pass through all directions, from 0. A panel has one.
    pub(super) fn pass(&self, pass: u32) -> [f64; 2] {
        match self.setup.stack.panel() {
            Some(_) => [SAMPLE, 1.0],
            None => part_of_pass(pass).map(|passes| SAMPLE + (1.0 - SAMPLE) * passes),
        }
    }

    /// Computes the spectra scattered towards each inclination of the viewer,
    /// [dphi][theta_i][state][wavelength], their Y, and the number of nodes.
    fn scattered(
        &self,
        kernel: &Kernel,
        (level, pass): (usize, u32),
        pool: Option<&ThreadPool>,
    ) -> Option<Scattered> {
        let stack = &self.setup.stack;
        let fields = |theta: f64| self.grid.dphi_deg.iter().map(move |phi| view(theta, *phi));
        let azimuths = self.grid.dphi_deg.len();
        let mut shared = kernel.unprepared().without_ledger();
        let (pairs, bins) = (azimuths * self.beams.len(), self.setup.scene.grid.len());
        let known = |theta: usize| {
            let numbers = self.saved.find(row_number(Kind::Row, level, theta))?;
            OfViewers::from_numbers(&numbers, pairs * self.setup.states.len(), bins)
        };
        let mut rows: Vec<Option<OfViewers>> = (0..self.grid.theta_o_deg.len()).map(known).collect();
        if stack.panel().is_none() && rows.iter().any(Option::is_none) {
            let fields: Vec<Cone> = self.grid.theta_o_deg.iter().flat_map(|theta| fields(*theta)).collect();
            self.prepare(&mut shared, &fields, &self.beams)?;
        }
        let done = AtomicUsize::new(0);
        let row = |(theta, row): (usize, &mut Option<OfViewers>)| {
            if self.control.stopped() {
                return None;
            }
            let report = || {
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                let rows = Progress { unit: "rows", ..Progress::of_views(done, self.grid.theta_o_deg.len()) };
                (self.control.progress)(rows.within(self.pass(pass)));
                Some(())
            };
            if row.is_some() {
                return report();
            }
            let mut found = OfViewers::default();
            let mut own = None;
            let (kernel, first) = if stack.panel().is_none() {
                (&shared, theta * azimuths)
            } else {
                let kernel = own.insert(kernel.clone());
                let fields: Vec<Cone> = fields(self.grid.theta_o_deg[theta]).collect();
                self.prepare(kernel, &fields, &self.beams)?;
                (&*kernel, 0)
            };
            for view in first..first + azimuths {
                for rho in &kernel.estimate_unless(stack, view, self.control.stop)?.rho {
                    found.spectra.extend(rho.total().iter().map(|r| (r / PI) as f32));
                    self.add_luminous(rho, &mut found.luminous);
                }
            }
            // Those of general layers are the same for all rows.
            found.nodes = kernel.nodes() as u64;
            self.saved.save(row_number(Kind::Row, level, theta), &found.numbers());
            *row = Some(found);
            report()
        };
        each(pool, &mut rows, row).into_iter().collect::<Option<Vec<()>>>()?;
        let (mut spectra, mut luminous, mut nodes) = (Vec::new(), Vec::new(), 0);
        for row in rows.into_iter().flatten() {
            spectra.push(row.spectra);
            luminous.push(row.luminous);
            nodes = if stack.panel().is_none() { row.nodes } else { nodes + row.nodes };
        }
        Some((spectra, luminous, nodes))
    }

    /// Computes the estimates in diffuse light, viewed from each direction of the light.
    pub(super) fn returned(&self, kernel: &Kernel) -> Option<Vec<Estimate>> {
        self.returned_to(&self.grid.lights_deg(), kernel)
    }

    /// The same from these directions of the light.
    pub(super) fn returned_to(&self, lights: &[[f64; 2]], kernel: &Kernel) -> Option<Vec<Estimate>> {
        let fields: Vec<Cone> = lights.iter().map(|[theta, phi]| view(*theta, *phi)).collect();
        let mut kernel = kernel.unprepared();
        self.prepare(&mut kernel, &fields, &[Source::Diffuse])?;
        let seen = |view| kernel.estimate_unless(&self.setup.stack, view, self.control.stop);
        (0..fields.len()).map(seen).collect()
    }

    /// Reorders the rows of a state from [dphi][theta_i][state][wavelength] for each theta_o to
    /// [theta_i][theta_o][dphi][wavelength].
    fn table(&self, state: usize, scattered: &[Vec<f32>]) -> Vec<f32> {
        let (states, bins) = (self.setup.states.len(), self.setup.scene.grid.len());
        let lights = self.beams.len();
        let mut table = Vec::with_capacity(self.grid.pairs() * bins);
        for light in 0..lights {
            for row in scattered {
                for dphi in 0..self.grid.dphi_deg.len() {
                    table.extend(&row[((dphi * lights + light) * states + state) * bins..][..bins]);
                }
            }
        }
        table
    }

    fn specular(&self, state: usize) -> Vec<f64> {
        self.of_state(state, self.images(&self.beams).iter())
    }

    /// Mirror images of beams.
    pub(super) fn images(&self, beams: &[Source]) -> Vec<ReflectanceFactor> {
        let image = |beam: &Source| match beam {
            Source::Beam(beta) => Some(specular_image(&self.setup.stack, *beta)),
            _ => None,
        };
        beams.iter().filter_map(image).collect()
    }

    /// Concatenates the spectra of a state.
    pub(super) fn of_state<'r>(
        &self,
        state: usize,
        all: impl Iterator<Item = &'r ReflectanceFactor>,
    ) -> Vec<f64> {
        all.flat_map(|rho| rho.total().state(state).to_vec()).collect()
    }
}

/// Returns the beams from these inclinations and azimuths.
pub(super) fn beams(lights_deg: &[[f64; 2]]) -> Vec<Source> {
    lights_deg.iter().map(|[theta, phi]| Source::Beam(Beta::from_source(*theta, *phi, 1.0))).collect()
}

/// Returns the direction of a viewer in air.
pub(super) fn view(theta_deg: f64, phi_deg: f64) -> Cone {
    Cone::new(theta_deg, phi_deg, 0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saved_numbers_are_read_bit_by_bit_and_others_are_not() {
        let row = OfViewers {
            spectra: vec![0.1, 0.2, 0.3, f32::MIN_POSITIVE],
            luminous: vec![0.1, 1.0 / 3.0],
            nodes: 7,
        };
        let numbers = row.numbers();
        assert_eq!(OfViewers::from_numbers(&numbers, 2, 2), Some(row));
        assert_eq!(OfViewers::from_numbers(&numbers, 2, 3), None);
        assert_eq!(OfViewers::from_numbers(&numbers, 9, 1), None);
        assert_eq!(OfViewers::from_numbers(&[], 0, 0), None);
    }
}
