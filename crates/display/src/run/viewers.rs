//! BSDF of the display by adding at viewers that move with the light: each direction of the light has viewers
//! of its own.
//!
//! The level is that which a sample of directions needs, as for a table ([`super::brdf`]). Under general
//! layers, each row is compared with that of the previous level, and if one misses the target, all are
//! computed at the next level.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

use papilio_transport::adding::{Kernel, error_over_difference};
use papilio_transport::{Cone, Source};
use rayon::ThreadPool;

use super::brdf::{OfViewers, Survey, beams, view};
use super::cone::target;
use super::refine::{finest, finest_by_direction, largest, largest_of_states, row_errors, slowness};
use super::saved::{Kind, row_number};
use super::{Control, Progress, SavedRows, Unsaved, Workers, each};
use crate::brdf::{BrdfGrid, half_turn};
use crate::scene::Scene;
use crate::setup::Setup;
use crate::viewers::{BrdfState, Viewer, ViewerGrid, ViewerTable};
use crate::{DisplayError, RowErrors};

/// Number of viewers of a panel that are prepared together.
const TOGETHER: usize = 64;

/// The same below general layers. Each preparation computes the kernels between about 200 nodes and all
/// viewers again: with fewer viewers there are more preparations, and with more viewers, the kernels between
/// them take longer.
const TOGETHER_BELOW_LAYERS: usize = 128;

/// Azimuths of the sample of directions that determines the level.
const SAMPLED_DPHI_DEG: [f64; 3] = [0.0, 90.0, 180.0];

/// Step of the azimuths of the light in that sample, where there are any, and the most inclinations then.
const SAMPLED_PHI_DEG: f64 = 60.0;
const SAMPLED_INCLINATIONS: usize = 4;

/// Computes the BSDF of the scene's display at the viewers of a grid, by adding independently of the scene's
/// method.
///
/// The errors are those of [`super::brdf`].
///
/// # Errors
/// If the scene is invalid, or the computation was stopped.
pub fn brdf_at_viewers<G: ViewerGrid>(
    scene: &Scene,
    grid: G,
    control: &Control<'_>,
) -> Result<ViewerTable<G>, DisplayError> {
    brdf_at_viewers_resumed(scene, grid, control, &Unsaved)
}

/// Computes the same as [`brdf_at_viewers`]; rows that `saved` has are not computed, and others are saved there.
///
/// # Errors
/// Those of [`brdf_at_viewers`].
pub fn brdf_at_viewers_resumed<G: ViewerGrid>(
    scene: &Scene,
    grid: G,
    control: &Control<'_>,
    saved: &dyn SavedRows,
) -> Result<ViewerTable<G>, DisplayError> {
    let setup = Setup::new(&scene.clone().unpolarised(), control)?;
    if grid.phi_i_deg().is_empty() {
        setup.check_isotropic()?;
    }
    let mut workers = None;
    let pool = Workers::unless_one(&mut workers, control.threads)?;
    let (theta_i_deg, lights) = (grid.theta_i_deg().to_vec(), grid.lights_deg());
    let mut sampled = BrdfGrid {
        theta_i_deg: theta_i_deg.clone(),
        phi_i_deg: Vec::new(),
        theta_o_deg: theta_i_deg,
        dphi_deg: SAMPLED_DPHI_DEG.to_vec(),
    };
    if !grid.phi_i_deg().is_empty() {
        let every = sampled.theta_i_deg.len().div_ceil(SAMPLED_INCLINATIONS).max(1);
        sampled.theta_i_deg = sampled.theta_i_deg.into_iter().rev().step_by(every).rev().collect();
        sampled.phi_i_deg = half_turn(SAMPLED_PHI_DEG);
    }
    let viewers: Vec<Vec<Viewer>> = (0..lights.len()).map(|light| grid.viewers(light).0).collect();
    let beams = beams(&lights);
    let of_first = beams.first().zip(viewers.first()).filter(|_| !setup.stack.adding_knows_azimuth());
    let finest = match of_first {
        Some((beam, viewers)) => {
            let views: Vec<Cone> = viewers.iter().map(|viewer| cone(viewer, lights[0][1])).collect();
            finest_by_direction(&setup.stack, &views, std::slice::from_ref(beam))?
        }
        None => finest(&setup)?,
    };
    let survey = Survey::new((&setup, control, saved), &sampled, finest);
    let tables = ByLight { survey, lights, beams, viewers };
    tables.run(grid, pool).ok_or(DisplayError::Interrupted)?.finite()
}

struct ByLight<'a> {
    /// Of the sampled directions.
    survey: Survey<'a>,
    /// Directions of the light, inclination and azimuth, degrees, and their beams.
    lights: Vec<[f64; 2]>,
    beams: Vec<Source>,
    /// Viewers of each direction of the light.
    viewers: Vec<Vec<Viewer>>,
}

impl ByLight<'_> {
    /// `None` if it was stopped.
    fn run<G: ViewerGrid>(&self, grid: G, pool: Option<&ThreadPool>) -> Option<ViewerTable<G>> {
        let setup = self.survey.setup;
        let target = target(&setup.scene);
        let mut kernel = Kernel::new(0);
        let sample = self.survey.sample(target, &mut kernel)?;
        let mut lights = self.scattered(&kernel, (sample.level, 0), pool)?;
        let states = setup.states.len();
        let mut relative = vec![sample.error; states * self.viewers.iter().map(Vec::len).sum::<usize>()];
        if setup.stack.panel().is_none() {
            let rest = slowness([&sample.finer, &sample.coarser], sample.before.as_deref());
            let times = error_over_difference(&setup.stack, &self.beams).max(rest);
            let mut level = sample.level;
            let mut coarser = self.scattered(&Kernel::new(level as u32 - 1), (level - 1, 1), pool)?;
            for pass in 2.. {
                relative = self.errors(&lights, &coarser, times);
                let misses = |error: &f64| error.is_finite() && *error > target;
                if level >= self.survey.finest || !relative.iter().any(misses) {
                    break;
                }
                level += 1;
                kernel = Kernel::new(level as u32);
                coarser = lights;
                lights = self.scattered(&kernel, (level, pass), pool)?;
            }
        }
        let returned = self.survey.returned_to(&self.lights, &kernel)?;
        let images = self.survey.images(&self.beams);
        let bins = setup.scene.grid.len();
        let state = |(number, name): (usize, &String)| BrdfState {
            name: name.clone(),
            brdf: lights
                .iter()
                .flat_map(|light| light.spectra.chunks_exact(states * bins))
                .flat_map(|viewer| viewer[number * bins..][..bins].iter().copied())
                .collect(),
            specular: self.survey.of_state(number, images.iter()),
            directional_hemispherical: self
                .survey
                .of_state(number, returned.iter().map(|estimate| &estimate.rho[0])),
        };
        Some(ViewerTable {
            wavelength_nm: setup.scene.grid.wavelengths_nm(),
            states: setup.states.iter().enumerate().map(state).collect(),
            nodes: lights.iter().map(|light| light.nodes).sum(),
            discretisation_error: relative.iter().copied().fold(0.0, largest),
            row_errors: RowErrors { relative, target, allowed: None },
            grid,
        })
    }

    /// Returns the relative errors of Y, `[state][theta_i][viewer]`.
    fn errors(&self, finer: &[OfViewers], coarser: &[OfViewers], times: f64) -> Vec<f64> {
        let states = self.survey.setup.states.len();
        let most = largest_of_states(finer.iter().map(|light| light.luminous.as_slice()), states);
        let by_light: Vec<Vec<f64>> = finer
            .iter()
            .zip(coarser)
            .map(|(finer, coarser)| row_errors(&finer.luminous, &coarser.luminous, &most, times))
            .collect();
        let of_state = |state: usize| by_light.iter().flatten().skip(state).step_by(states).copied();
        (0..states).flat_map(of_state).collect()
    }

    /// Computes what each direction of the light scatters: BRDF, [viewer][state][wavelength]; Y, [viewer][state].
    fn scattered(
        &self,
        kernel: &Kernel,
        (level, pass): (usize, u32),
        pool: Option<&ThreadPool>,
    ) -> Option<Vec<OfViewers>> {
        let survey = &self.survey;
        let stack = &survey.setup.stack;
        let stop = survey.control.stop;
        // Data of a panel that do not depend on the viewers.
        let mut common = kernel.unprepared().without_ledger();
        if stack.panel().is_some() {
            let all: Vec<Cone> =
                self.viewers.first()?.iter().take(1).map(|viewer| cone(viewer, 0.0)).collect();
            common.prepare_common(stack, &all, &self.beams, stop).then_some(())?;
        }
        // Kernels of general layers keep what does not depend on the viewers for their next ones; light by direction is prepared for all.
        let (at_once, together) = match stack.panel() {
            Some(_) => (TOGETHER, TOGETHER),
            None if stack.adding_knows_azimuth() => (usize::MAX, TOGETHER_BELOW_LAYERS),
            None => (usize::MAX, usize::MAX),
        };
        let mut parts: Vec<(usize, &[Viewer], OfViewers)> = self
            .viewers
            .iter()
            .enumerate()
            .flat_map(|(light, viewers)| viewers.chunks(at_once).map(move |some| (light, some)))
            .map(|(light, some)| (light, some, OfViewers::default()))
            .collect();
        let count = parts.len();
        let done = AtomicUsize::new(0);
        let (states, bins) = (survey.setup.states.len(), survey.setup.scene.grid.len());
        let part = |(number, (light, viewers, found)): (usize, &mut (usize, &[Viewer], OfViewers))| {
            if survey.control.stopped() {
                return None;
            }
            let report = || {
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                let parts = Progress { unit: "parts", ..Progress::of_views(done, count) };
                (survey.control.progress)(parts.within(survey.pass(pass)));
                Some(())
            };
            let number = row_number(Kind::Row, level, number);
            let known = survey.saved.find(number);
            if let Some(known) =
                known.and_then(|known| OfViewers::from_numbers(&known, viewers.len() * states, bins))
            {
                *found = known;
                return report();
            }
            let (beam, phi_i_deg) = (&self.beams[*light..=*light], self.lights[*light][1]);
            let mut own = kernel.unprepared().without_ledger();
            for some in viewers.chunks(together) {
                let fields: Vec<Cone> = some.iter().map(|viewer| cone(viewer, phi_i_deg)).collect();
                own.prepare_part(&common, stack, &fields, beam, stop).then_some(())?;
                for viewer in 0..fields.len() {
                    for rho in &own.estimate_unless(stack, viewer, stop)?.rho {
                        found.spectra.extend(rho.total().iter().map(|r| (r / PI) as f32));
                        survey.add_luminous(rho, &mut found.luminous);
                    }
                }
                found.nodes += own.nodes() as u64;
            }
            survey.saved.save(number, &found.numbers());
            report()
        };
        each(pool, &mut parts, part).into_iter().collect::<Option<Vec<()>>>()?;
        let mut lights = vec![OfViewers::default(); self.viewers.len()];
        for (light, _, found) in parts {
            lights[light].spectra.extend(found.spectra);
            lights[light].luminous.extend(found.luminous);
            lights[light].nodes += found.nodes;
        }
        Some(lights)
    }
}

/// Returns the direction of a viewer in air, for light from this azimuth.
fn cone(viewer: &Viewer, phi_i_deg: f64) -> Cone {
    view(viewer.theta_o_deg, phi_i_deg + viewer.dphi_deg)
}
