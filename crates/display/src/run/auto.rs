//! Choice between the two solvers (`method = "auto"`), and estimates of their work.
//!
//! The work of both is estimated **from counts, never from measured time**, so that a scenario is solved by
//! the same solver on every machine:
//!
//! - *adding*: the number of nodes and of sets of refractive indices ([`adding_seconds`]), at the level that
//!   the target is expected to need; for an ordinary panel the number of views and of environments, and
//!   whether its lobe is narrow.
//! - *Monte Carlo*: the number of paths that the target needs, from the standard errors after one round of
//!   paths of a few views (a pilot run with the seed of the scene), and the work of a path, from the number
//!   of scattering layers and of spectra.
//!
//! The counts are converted to seconds of one processor (EPYC with AVX-512, one core), correct to within a
//! factor of ten. If adding takes less work than the pilot run, it is taken without a pilot run. Of two
//! solvers that take about the same, adding is preferred, because its result has no noise. Where its finest level
//! misses the target, as far from a narrow lobe, Monte Carlo is run after it if it is expected to meet the target soon.

use std::fmt::Write;

use papilio_optics::scatter::Scatter;
use papilio_transport::adding::{Narrowness, error_over_difference, narrowest, nodes_needed};
use papilio_transport::{Interface, Reflector, Source, Stack};

use super::refine::{is_turned, width_of_panel};
use super::walk::{self, FIRST_PATHS};
use super::{Control, Run, adding_seconds};
use crate::DisplayError;
use crate::meter::Meter;
use crate::scene::{Method, Pixel, Sampler, Scene, Stop, Strategy};
use crate::setup::{Setup, Towards};

/// Largest optical thickness of a slab for the Monte Carlo solver: the number of scattering events of a path
/// increases with it, and beyond this value a run takes hours.
pub const THICKEST_FOR_MONTE_CARLO: f64 = 200.0;

/// Factor by which Monte Carlo must take less work than adding to be chosen.
const PREFERENCE: f64 = 2.0;

/// Work above which no pilot run is made for an estimate alone, s.
const LONGEST_PILOT_S: f64 = 1.0;

/// Work of Monte Carlo above which it is not run where adding misses the target, s.
const LONGEST_AFTER_ADDING_S: f64 = 60.0;

/// Work of an exact answer of adding that needs no first answer, s.
const QUICK_S: f64 = 0.02;

/// Work of Monte Carlo for the tables of rough interfaces, s.
const ROUGH_TABLES_S: f64 = 0.1;

/// Views of which a pilot run traces paths.
const PILOT_VIEWS: usize = 3;

/// Work that both solvers need for a scene, in seconds of one processor, estimated from counts to within a
/// factor of ten.
#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    /// Adding; `None` if it refuses the scene.
    pub adding_s: Option<f64>,
    /// Monte Carlo; `None` if it refuses the scene, or if a pilot run would take too long.
    pub monte_carlo_s: Option<f64>,
    /// The solver that takes less work.
    pub cheaper: Method,
    /// Why it is the cheaper one.
    pub reason: String,
}

/// Estimates the work of both solvers for a scene and its target; traces a few thousand paths unless these
/// alone take a second.
///
/// # Errors
/// If the scene is invalid, or the pilot run was stopped.
pub fn forecast(scene: &Scene, control: &Control<'_>) -> Result<Forecast, DisplayError> {
    let setup = setup_of(scene, control)?;
    let meter = Meter::new(&setup);
    estimated(&Run::new(&setup, control, &meter), |_| LONGEST_PILOT_S)
}

/// Estimates the work of a run before it begins, in seconds of one processor, from counts alone: by which solver, and
/// its work. Of Monte Carlo with a target, it is that of the fewest paths.
///
/// # Errors
/// If the scene is invalid, or its preparation was stopped.
pub fn expected_seconds(scene: &Scene, control: &Control<'_>) -> Result<(Method, f64), DisplayError> {
    let setup = setup_of(scene, control)?;
    let by_paths = |paths: u64| {
        let views = setup.views.len() as f64;
        (Method::MonteCarlo, views * paths as f64 * path_seconds(&setup))
    };
    match (scene.solver.method, &scene.solver.stop) {
        (_, Stop::Paths(paths)) => Ok(by_paths(*paths)),
        (Method::Adding | Method::Auto, Stop::RelativeError { target, .. }) => {
            match adding(&setup, *target) {
                Ok(seconds) => Ok((Method::Adding, seconds)),
                // The run says so itself, or is by Monte Carlo.
                Err(error) if is_for_monte_carlo(&error) => Ok(by_paths(FIRST_PATHS)),
                Err(other) => Err(other),
            }
        }
        _ => Ok(by_paths(FIRST_PATHS)),
    }
}

/// Prepares a scene, of which a run prepares no more: all directions of a crystal take longer than the run.
fn setup_of(scene: &Scene, control: &Control<'_>) -> Result<Setup, DisplayError> {
    Setup::has_no_filter(scene)?;
    Setup::towards(scene, Towards::Views, control)
}

/// Returns whether an error of adding is none of Monte Carlo.
fn is_for_monte_carlo(error: &DisplayError) -> bool {
    use DisplayError::{Azimuth, Particles, TooNarrow, TooNarrowInField};
    matches!(error, Azimuth { .. } | Particles { .. } | TooNarrow { .. } | TooNarrowInField { .. })
}

/// Returns whether adding takes so little work that its exact answer needs no first answer.
pub(crate) fn is_quick(setup: &Setup) -> bool {
    let solver = &setup.scene.solver;
    let Stop::RelativeError { target, .. } = solver.stop else { return false };
    solver.method != Method::MonteCarlo && adding(setup, target).is_ok_and(|seconds| seconds <= QUICK_S)
}

/// Chooses the solver of a run; there is no pilot run if adding takes less work.
pub(super) fn choose(run: &Run<'_>) -> Result<Forecast, DisplayError> {
    estimated(run, |adding_s| adding_s.map_or(f64::INFINITY, |seconds| seconds / PREFERENCE))
}

/// Returns why Monte Carlo is to be run after adding, which has reached this relative error at its finest level;
/// `None` if that meets the target, or if Monte Carlo is expected to take too long for it.
pub(super) fn instead_of_adding(run: &Run<'_>, reached: f64) -> Result<Option<String>, DisplayError> {
    let Stop::RelativeError { target, .. } = run.scene.solver.stop else { return Ok(None) };
    if reached <= target || reached.is_nan() || is_too_thick(run.scene) {
        return Ok(None);
    }
    let seconds = paths_needed(run, target)? * path_seconds(run.setup);
    Ok((seconds <= LONGEST_AFTER_ADDING_S).then(|| {
        format!(
            "adding reaches only a relative error of {reached:.1e} at its finest level, Monte Carlo meets the target in about {} s of one \
             processor",
            plain(seconds)
        )
    }))
}

/// Estimates the work of both solvers; `longest_pilot` returns the work below which a pilot run is made, from
/// that of adding.
fn estimated(run: &Run<'_>, longest_pilot: impl Fn(Option<f64>) -> f64) -> Result<Forecast, DisplayError> {
    let scene = run.scene;
    let Stop::RelativeError { target, .. } = scene.solver.stop else {
        let paths = if let Stop::Paths(paths) = scene.solver.stop { Some(paths) } else { None };
        let views = run.setup.views.len() as f64;
        return Ok(Forecast {
            adding_s: None,
            monte_carlo_s: paths.map(|paths| views * paths as f64 * path_seconds(run.setup)),
            cheaper: Method::MonteCarlo,
            reason: "only the Monte Carlo solver stops at a number of paths or at the error of a metric"
                .to_owned(),
        });
    };
    let adding_s = match adding(run.setup, target) {
        Ok(seconds) => Some(seconds),
        Err(error) if is_for_monte_carlo(&error) => None,
        Err(error) => return Err(error),
    };
    if is_too_thick(scene) {
        let reason =
            format!("slabs of optical thickness above {THICKEST_FOR_MONTE_CARLO} are for adding alone");
        return Ok(Forecast { adding_s, monte_carlo_s: None, cheaper: Method::Adding, reason });
    }
    let views = run.setup.views.len();
    let pilot_s = FIRST_PATHS as f64 * views.min(PILOT_VIEWS) as f64 * path_seconds(run.setup);
    let mut reason = String::new();
    // Writing to a string cannot fail.
    let _ = match adding_s {
        Some(seconds) => write!(reason, "adding takes about {} s of one processor", plain(seconds)),
        None => write!(reason, "adding refuses this display"),
    };
    if pilot_s >= longest_pilot(adding_s) {
        let _ = write!(reason, ", Monte Carlo more than {} s", plain(pilot_s));
        let cheaper = if adding_s.is_some() { Method::Adding } else { Method::MonteCarlo };
        return Ok(Forecast { adding_s, monte_carlo_s: None, cheaper, reason });
    }
    let paths = paths_needed(run, target)?;
    let is_rough = interfaces(&run.setup.stack).any(|interface| matches!(interface, Interface::Rough(_)));
    let tables = if is_rough { ROUGH_TABLES_S } else { 0.0 };
    let seconds = paths * path_seconds(run.setup) + tables;
    let _ = write!(reason, ", Monte Carlo {} s ({} paths)", plain(seconds), plain(paths));
    if matches!(scene.display.pixel, Pixel::Crystal(_)) {
        reason += ", besides the table of the liquid crystal";
    }
    let cheaper = match adding_s {
        Some(adding) if adding <= PREFERENCE * seconds => Method::Adding,
        _ => Method::MonteCarlo,
    };
    Ok(Forecast { adding_s, monte_carlo_s: Some(seconds), cheaper, reason })
}

/// Estimates the work of adding, in seconds, at the level that the target is expected to need.
fn adding(setup: &Setup, target: f64) -> Result<f64, DisplayError> {
    super::refine::finest(setup)?;
    if !setup.stack.adding_knows_azimuth()
        && let Some(seconds) = super::refine::azimuthal_work(setup, 1)
    {
        return Ok(2.0 * seconds);
    }
    let nodes = |level: u32| nodes_needed(&setup.stack, level).max(1) as f64;
    let level = level_needed(target, error_over_difference(&setup.stack, &setup.sources));
    let more = (nodes(level) / nodes(1)).powi(3);
    if setup.stack.panel().is_some() {
        return Ok(panel_seconds(setup));
    }
    Ok(adding_seconds(&setup.scene)? * more + column_seconds(setup, nodes(level)) + kernel_seconds(setup))
}

/// Estimates the work of adding, in seconds, for the light between the layers and a pixel of this many states
/// and wavelengths.
fn column_seconds(setup: &Setup, nodes: f64) -> f64 {
    const COLUMN: f64 = 1e-8;
    let is_lambertian = matches!(setup.stack.base().reflector, Reflector::Lambertian(_));
    let columns = if is_lambertian { 1.0 } else { (setup.states.len() * setup.scene.grid.len()) as f64 };
    COLUMN * nodes * nodes * columns
}

/// Estimates the work of adding, in seconds, for the light that tables and rough interfaces scatter once to
/// the views, and for the totals of measured tables.
fn kernel_seconds(setup: &Setup) -> f64 {
    const VIEW: f64 = 3e-2;
    const TOTALS: f64 = 0.3;
    let is_kernel = narrowest(&setup.stack).is_some_and(|narrowest| {
        matches!(narrowest.scatterer, Narrowness::Face { .. } | Narrowness::Rough { .. })
    });
    let pixel = usize::from(matches!(setup.scene.display.pixel, Pixel::Scattering(_)));
    let tables = pixel + interfaces(&setup.stack).filter(|interface| is_measured(interface)).count();
    TOTALS * tables as f64 + if is_kernel { VIEW * setup.views.len() as f64 } else { 0.0 }
}

/// Returns the interfaces of general layers.
fn interfaces(stack: &Stack) -> impl Iterator<Item = &Interface> {
    let layers = if stack.panel().is_none() { stack.layers() } else { &[] };
    layers.iter().map(|layer| &layer.interface)
}

/// Returns whether an interface transmits light as a measured table says.
fn is_measured(interface: &Interface) -> bool {
    let Interface::Scatter(face) = interface else { return false };
    matches!(face.transmission().map(|kernel| &kernel.scatter), Some(Scatter::Table(..)))
}

/// Estimates the work of adding for an ordinary panel, in seconds: for each view that of the light that
/// passes once, and more for environments, above all those that depend on azimuth, and for light that a front
/// sends back through a narrow lobe.
fn panel_seconds(setup: &Setup) -> f64 {
    const VIEW: f64 = 2e-3;
    /// Of an environment for each view: the same at all azimuths, or not; then also once.
    const RING: f64 = 5e-3;
    const FIELD: f64 = 1e-2;
    const FIELD_ONCE: f64 = 2e-2;
    const NARROW: f64 = 2e-2;
    /// Width of a lobe below which its azimuthal orders and their radii take most of the work of an
    /// environment.
    const FIELD_WIDTH: f64 = 5e-3;
    let (rings, fields): (Vec<_>, Vec<_>) = setup
        .sources
        .iter()
        .filter(|source| matches!(source, Source::Field(_)))
        .partition(|field| !is_turned(field));
    let (rings, fields) = (rings.len() as f64, fields.len() as f64);
    let widths = width_of_panel(&setup.stack).map_or(0.0, |width| (FIELD_WIDTH / width).powi(2));
    let narrow = if error_over_difference(&setup.stack, &setup.sources) > 1.0 { NARROW } else { 0.0 };
    setup.views.len() as f64 * (VIEW + RING * rings + FIELD * fields)
        + (1.0 + widths) * FIELD_ONCE * fields
        + narrow
}

/// Returns the level of adding at which two levels are expected to agree within the target.
fn level_needed(target: f64, error_over_difference: f64) -> u32 {
    /// Usual difference between levels 0 and 1, and the decrease of differences from level to level.
    const DIFFERENCE: f64 = 3e-4;
    const DECREASE: f64 = 7.0;
    let levels = (error_over_difference * DIFFERENCE / target).ln() / DECREASE.ln();
    (1 + levels.ceil().max(0.0) as u32).min(papilio_transport::adding::FINEST)
}

/// Estimates the number of paths of all views that Monte Carlo needs for a relative error, from a pilot run
/// of a few of them.
fn paths_needed(run: &Run<'_>, target: f64) -> Result<f64, DisplayError> {
    let views = run.setup.views.len();
    let of_pilot = views.min(PILOT_VIEWS);
    // The exponents p of errors that are proportional to paths^-p.
    let exponent = match run.scene.solver.sampler {
        Sampler::Random => 0.5,
        Sampler::Sobol | Sampler::Stratified | Sampler::BestCandidate => 0.67,
    };
    let mut paths = 0.0;
    for k in 0..of_pilot {
        let pilot = walk::pilot(run, k * (views - 1) / (of_pilot - 1).max(1))?;
        let more = (pilot.relative_error / target).max(1.0).powf(1.0 / exponent);
        // A second round confirms the first, and rounds double the number of paths.
        let rounds = more.max(2.0).log2().ceil();
        paths += (pilot.paths as f64 * rounds.exp2()).max(pilot.least as f64);
    }
    Ok(paths * views as f64 / of_pilot as f64)
}

/// Estimates the work of a path, in seconds: that of each scattering event, and of light from an environment.
/// In general layers the weights of an event have all states and wavelengths, or a few reflectances under a
/// pixel of no angle; on the first pass through a panel, only directions.
fn path_seconds(setup: &Setup) -> f64 {
    /// Work of an event with directions alone; of one at a rough interface or a table.
    const EVENT: f64 = 5e-7;
    const KERNEL: f64 = 2e-6;
    /// Work of an event for each state and wavelength.
    const NUMBER: f64 = 5e-9;
    const FEW: f64 = 8.0;
    /// Work of a path for an environment that depends on azimuth.
    const FIELD: f64 = 1e-5;
    let fields = FIELD * setup.sources.iter().filter(|source| is_turned(source)).count() as f64;
    // All harmonics of a pixel that depends on azimuth are looked up.
    let looked_up = match setup.stack.base().harmonics() {
        1 => 1.0,
        harmonics => 2.0 * harmonics as f64,
    };
    let numbers = match &setup.scene.display.pixel {
        Pixel::Uniform(_) => FEW,
        _ => looked_up * (setup.states.len() * setup.scene.grid.len()) as f64,
    };
    let is_kernel = |interface: &Interface| {
        matches!(interface, Interface::Rough(_) | Interface::Scatter(_) | Interface::Wave(_))
    };
    let kernel = if interfaces(&setup.stack).any(is_kernel) { KERNEL } else { 0.0 };
    let events = match (setup.stack.panel(), setup.scene.solver.scattering) {
        (Some(_), Strategy::Guided) => 10.0 * EVENT,
        (Some(_), _) => EVENT,
        (None, _) => events(setup) * (EVENT + kernel + NUMBER * numbers),
    };
    fields + events
}

/// Estimates the number of events of a path through general layers: at each interface, at the pixel, and in
/// slabs.
fn events(setup: &Setup) -> f64 {
    /// Passes through the layers, on average.
    const PASSES: f64 = 4.0;
    let thickness: f64 = (setup.scene.display.layers)
        .iter()
        .filter_map(|layer| layer.medium.scattering.as_ref())
        .map(|slab| slab.optical_thickness)
        .sum();
    PASSES * (1.0 + interfaces(&setup.stack).count() as f64 + thickness)
}

/// Writes a positive number with two digits, without exponent: 0.056, 1.2, 17 000.
fn plain(value: f64) -> String {
    if value.is_nan() || value <= 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.log10().floor() as i32;
    let step = 10.0_f64.powi(magnitude - 1);
    let decimals = usize::try_from(1 - magnitude).unwrap_or(0);
    let rounded = if decimals > 0 { value } else { (value / step).round() * step };
    let digits = format!("{rounded:.decimals$}");
    if decimals > 0 {
        return digits;
    }
    let first = digits.len() % 3;
    let groups = digits.as_bytes()[first..].chunks(3).map(|group| String::from_utf8_lossy(group));
    let all = std::iter::once(digits[..first].into()).chain(groups).filter(|group| !group.is_empty());
    all.collect::<Vec<_>>().join(" ")
}

fn is_too_thick(scene: &Scene) -> bool {
    let mut slabs = scene.display.layers.iter().filter_map(|layer| layer.medium.scattering.as_ref());
    slabs.any(|slab| slab.optical_thickness > THICKEST_FOR_MONTE_CARLO)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn level_needed_grows_with_the_logarithm_of_the_target() {
        assert_eq!([1e-2, 1e-3, 1e-4, 1e-5, 1e-9].map(|target| level_needed(target, 1.0)), [1, 1, 2, 3, 6]);
        assert_eq!(level_needed(1e-3, 10.0), 2);
    }

    #[test]
    fn numbers_of_the_reason_have_two_digits_and_no_exponent() {
        let written = [0.0561, 1.23, 12.3, 123.0, 1234.0, 17_049.0, 1.26e6, 3.2e-4].map(plain);
        assert_eq!(written, ["0.056", "1.2", "12", "120", "1 200", "17 000", "1 300 000", "0.00032"]);
    }
}
