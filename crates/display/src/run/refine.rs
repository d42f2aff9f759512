//! Refinement of the discretisation until two successive levels agree, and the errors of levels.

use std::collections::HashSet;

use papilio_optics::lobe::Lobe;
use papilio_transport::adding::{
    FINEST, MOST_NODES, MOST_NODES_OF_FURTHER, Narrowness, azimuthal_seconds, is_azimuthal, narrowest,
    nodes_needed,
};
use papilio_transport::{Cone, Diffuser, Panel, Reflector, Source, Stack, Top};

use crate::DisplayError;
use crate::meter::relative;
use crate::pixel::{AZIMUTH_BELOW_SCATTERER, state_names};
use crate::polarisation;
use crate::scene::{Pixel, Scene};
use crate::setup::{Setup, layers_alone};

/// Width of the narrowest lobe of an ordinary panel below which adding does not compute light that depends on
/// azimuth, such as that of a map: its orders and their radii increase as 1/width each. This one takes half a
/// minute and half a gigabyte.
const NARROWEST_IN_FIELDS: f64 = 2e-4;

/// Finest level of light by direction: its errors decrease by a factor of twenty with each.
const FINEST_OF_DIRECTIONS: u32 = 3;

/// The same for the light that a front sends back over a mirror or films: its points increase as 1/width. Two levels
/// of this one take 10 s, without progress.
const NARROWEST_BELOW_FRONTS: f64 = 2e-6;

/// Error: light from too many directions on a diffuser above a pixel that depends on azimuth, by adding.
const MANY_DIRECTIONS: DisplayError = DisplayError::Azimuth {
    what: "adding below this diffuser in light from so many directions",
    key: "solver.method",
    hint: "\"monte-carlo\" does, by `papilio run` and `sweep`; adding does below a diffuser without `regular_fraction`, with a wider lobe, or in beams alone",
};

/// Returns the finest level that can be computed for the layers of a display.
///
/// # Errors
/// If even the second level has too many nodes; if the lobe of an ordinary panel is too narrow for its light; if a scatterer is above a pixel that
/// depends on azimuth, and it is not one diffuser that is given by its lobe.
pub(crate) fn finest(setup: &Setup) -> Result<usize, DisplayError> {
    let stack = &setup.stack;
    if stack.has_phase_matrix() {
        return Err(DisplayError::Particles { needs: polarisation::PATHS });
    }
    if !stack.adding_knows_azimuth() {
        let views: Vec<Cone> = setup.views.iter().map(|view| view.field).collect();
        return finest_by_direction(stack, &views, &setup.sources);
    }
    if let Some(width) = width_of_panel(stack)
        && width < NARROWEST_IN_FIELDS
        && setup.sources.iter().any(is_turned)
    {
        let light = "depends on azimuth, such as that of a map";
        return Err(DisplayError::TooNarrowInField { width, least: NARROWEST_IN_FIELDS, light });
    }
    if let Some(width) = width_of_panel(stack)
        && width < NARROWEST_BELOW_FRONTS
        && stack.panel().is_some_and(sends_back)
    {
        let light = "a front of screen sends back";
        return Err(DisplayError::TooNarrowInField { width, least: NARROWEST_BELOW_FRONTS, light });
    }
    let fits = |level: &u32| {
        // Two levels are needed; further ones are computed where they take little time.
        let most = if *level <= 1 { MOST_NODES } else { MOST_NODES_OF_FURTHER };
        nodes_needed(stack, *level) <= most
    };
    match (0..=FINEST).take_while(fits).last() {
        Some(level) if level > 0 => Ok(level as usize),
        _ => Err(too_narrow(stack)),
    }
}

/// Returns the finest level of light by direction, where adding does not know the azimuth at the pixel otherwise.
///
/// # Errors
/// If it does not compute these layers, or these views and sources.
pub(crate) fn finest_by_direction(
    stack: &Stack,
    views: &[Cone],
    sources: &[Source],
) -> Result<usize, DisplayError> {
    // Two levels are needed; further ones are computed where they fit.
    let fits = |level: &u32| azimuthal_seconds(stack, views, sources, *level).is_some();
    let last = (1..=FINEST_OF_DIRECTIONS).take_while(fits).last();
    let refused = if is_azimuthal(stack) { MANY_DIRECTIONS } else { AZIMUTH_BELOW_SCATTERER };
    last.map(|level| level as usize).ok_or(refused)
}

/// Estimates the work of a level of adding for a diffuser above a pixel that depends on azimuth, in seconds; `None` if it does not
/// compute it.
pub(crate) fn azimuthal_work(setup: &Setup, level: u32) -> Option<f64> {
    let views: Vec<Cone> = setup.views.iter().map(|view| view.field).collect();
    azimuthal_seconds(&setup.stack, &views, &setup.sources, level)
}

/// Returns whether a source is an environment that depends on azimuth.
pub(crate) fn is_turned(source: &Source) -> bool {
    matches!(source, Source::Field(field) if !field.is_ring())
}

/// Returns whether a front sends light back to the diffuser over a base that scatters nothing.
fn sends_back(panel: &Panel) -> bool {
    let is_mirror = matches!(panel.base.reflector, Reflector::Specular(_));
    is_mirror && !panel.single_pass && panel.front.reflectance_below.iter().any(|r| *r > 0.0)
}

/// Width of the lobe of an ordinary panel.
pub(crate) fn width_of_panel(stack: &Stack) -> Option<f64> {
    match &stack.panel()?.top {
        Top::Diffuser(Diffuser { lobe: Lobe::KCorrelation { width }, .. }) => Some(*width),
        _ => None,
    }
}

/// Estimates the time that adding needs to prepare the layers of a scene for one beam, in seconds of one
/// processor; correct to within a factor of ten. Each state of a scattering pixel counts as a further layer.
/// 0 for an ordinary panel, whose preparation takes milliseconds.
///
/// # Errors
/// If the layers are invalid.
pub fn adding_seconds(scene: &Scene) -> Result<f64, DisplayError> {
    /// Per node cubed and set of indices: two narrow diffusers in glass take 0.16 s with 167 nodes.
    const SECONDS: f64 = 4e-8;
    if scene.display.panel().is_some() {
        return Ok(0.0);
    }
    let layers = &scene.display.layers;
    let nodes = nodes_needed(&layers_alone(scene)?, 1) as f64;
    // Wavelengths with different indices do not share operators.
    let indices = |bin: usize| layers.iter().map(|layer| layer.medium.index[bin].to_bits()).collect();
    let sets: HashSet<Vec<u64>> = (0..scene.grid.len()).map(indices).collect();
    let stacks = match &scene.display.pixel {
        Pixel::Scattering(_) => 1 + state_names(&scene.display.pixel).len(),
        Pixel::Film(_) | Pixel::Table(_) | Pixel::Uniform(_) | Pixel::Crystal(_) => 1,
    };
    Ok(SECONDS * nodes.powi(3) * (sets.len() * stacks) as f64)
}

/// Returns the error, which names the narrowest scatterer.
fn too_narrow(stack: &Stack) -> DisplayError {
    let (what, number) = match narrowest(stack) {
        None => ("an interface".to_owned(), 1),
        Some(found) => {
            let what = match found.scatterer {
                Narrowness::Lobe { width } => format!("the diffuser of width {width:.5}"),
                Narrowness::Face { width } => format!("the diffuser of width {width:.5}"),
                Narrowness::Rough { alpha, .. } => {
                    format!("the rough interface with a roughness alpha of {alpha:.4}")
                }
                Narrowness::Slab { anisotropy } => format!("the slab of anisotropy {anisotropy}"),
            };
            (what, found.number)
        }
    };
    DisplayError::TooNarrow { what, number, nodes: nodes_needed(stack, 1), most: MOST_NODES }
}

/// Values at two or three successive levels: those of the level with the smallest error.
pub(crate) struct Refined<T> {
    pub(crate) finer: T,
    pub(crate) coarser: T,
    /// The level before `coarser`, if there is one.
    pub(crate) before: Option<T>,
    /// Number of the finer level.
    pub(crate) level: usize,
    /// Relative error of the finer level.
    pub(crate) error: f64,
    /// Ratio of this error to that from these levels alone: above 1 if a still finer level differs by more.
    pub(crate) raised: f64,
    /// False if the run was stopped before the target or the finest level was reached.
    pub(crate) finished: bool,
}

/// Computes levels from 0 until the error is at most the target, or the finest level (1 or more) is reached;
/// `None` if stopped before two levels were computed. `at` computes a level, or returns `None` if it was
/// stopped; `error` computes the relative error of the last of two or three levels, at least `times` the difference
/// of the last two; `report` is called with each error and whether it is the last.
///
/// Where a target is not met, finer levels may fluctuate instead of converging. The result is then the level with the
/// smallest error: a stricter target states a larger one only if a finer level shows that it was too small.
pub(crate) fn refine<T>(
    target: f64,
    finest: usize,
    times: f64,
    mut at: impl FnMut(usize) -> Option<T>,
    error: impl Fn([&T; 2], Option<&T>) -> f64,
    report: impl Fn(f64, bool),
) -> Option<Refined<T>> {
    let mut levels = vec![at(0)?, at(1)?];
    let mut errors = Vec::new();
    loop {
        let last = levels.len() - 1;
        let own = error([&levels[last], &levels[last - 1]], (last > 1).then(|| &levels[last - 2]));
        errors.push(own);
        // NaN does not disappear at finer levels.
        let is_last = own <= target || own.is_nan() || last >= finest;
        let (best, error) = if own.is_nan() { (last, own) } else { best(&levels, &errors, times, &error) };
        report(error, is_last);
        let next = if is_last { None } else { at(last + 1) };
        let Some(next) = next else {
            let raised = if error > errors[best - 1] { error / errors[best - 1] } else { 1.0 };
            levels.truncate(best + 1);
            let [finer, coarser] = [levels.pop()?, levels.pop()?];
            let before = levels.pop();
            return Some(Refined { finer, coarser, before, level: best, error, raised, finished: is_last });
        };
        levels.push(next);
    }
}

/// Returns the number of the level with the smallest error, the finest of several, and this error: its own, or its
/// difference from a finer level if that is larger. `errors` are those of levels 1, 2, ...
fn best<T>(
    levels: &[T],
    errors: &[f64],
    times: f64,
    error: impl Fn([&T; 2], Option<&T>) -> f64,
) -> (usize, f64) {
    let of_level = |(number, own): (usize, &f64)| {
        let difference = |finer: &T| error([finer, &levels[number + 1]], None) / times;
        let later = levels[number + 2..].iter().map(difference);
        (number + 1, later.fold(*own, largest))
    };
    let all = errors.iter().enumerate().map(of_level);
    all.reduce(|best, next| if best.1 < next.1 { best } else { next }).unwrap_or((1, f64::NAN))
}

/// Refines as [`refine`] does, for levels that may fail. A level beyond the first two that adding does not
/// cover ends the refinement: the two before are the result.
///
/// # Errors
/// Those of a level; `Interrupted` if stopped before two levels were computed.
pub(crate) fn refine_or_fail<T>(
    target: f64,
    finest: usize,
    times: f64,
    mut at: impl FnMut(usize) -> Result<T, DisplayError>,
    error: impl Fn([&T; 2], Option<&T>) -> f64,
    report: impl Fn(f64, bool),
) -> Result<Refined<T>, DisplayError> {
    let (mut failure, mut is_last) = (None, false);
    let at = |level| match at(level) {
        Ok(found) => Some(found),
        Err(DisplayError::Interrupted) => None,
        Err(DisplayError::PlacesByPaths { .. }) if level > 1 => {
            is_last = true;
            None
        }
        Err(other) => {
            failure = Some(other);
            None
        }
    };
    let refined = refine(target, finest, times, at, error, report);
    if let Some(failure) = failure {
        return Err(failure);
    }
    let refined = refined.ok_or(DisplayError::Interrupted)?;
    Ok(Refined { finished: refined.finished || is_last, ..refined })
}

/// Computes the relative error of the finer of two levels that differ by `now`, if the previous two differed
/// by `before`; `times` is the smallest factor from differences to errors
/// ([`error_over_difference`](papilio_transport::adding::error_over_difference)).
///
/// If differences decrease by a factor r from level to level, the remaining error is `r/(1 - r)` times the
/// last. If they do not decrease and exceed rounding errors, the error is unknown and at least 1. Two levels may agree by
/// chance: no difference is taken to be less than a fiftieth of the one before, and first ones above a tenth tell nothing.
pub(crate) fn level_error(times: f64, now: f64, before: Option<f64>) -> f64 {
    /// Largest factor by which differences decrease, but by chance.
    const FASTEST: f64 = 50.0;
    /// Largest difference of two levels from which an error is concluded.
    const FIRST: f64 = 0.1;
    let error = extrapolated(times, now, before);
    match before {
        Some(before) if before.is_finite() => largest(error, before / FASTEST),
        None if now > FIRST => error.max(1.0),
        _ => error,
    }
}

/// Computes the same, if differences are those of levels that converge.
fn extrapolated(times: f64, now: f64, before: Option<f64>) -> f64 {
    /// Largest factor by which slow convergence is extrapolated.
    const MOST: f64 = 10.0;
    /// Differences above this are larger than the errors of tables.
    const LARGE: f64 = 1e-2;
    let Some(before) = before.filter(|before| *before > 0.0) else { return times * now };
    let ratio = now / before;
    if ratio >= 1.0 && now > LARGE {
        return (times * now).max(1.0);
    }
    // Known slow convergence is already part of `times`; single ratios are too uncertain.
    let rest = if times > 1.0 {
        times
    } else if ratio < 1.0 {
        (ratio / (1.0 - ratio)).clamp(1.0, MOST)
    } else {
        MOST
    };
    rest * now
}

/// Computes the largest relative error of amounts of light at the finer of two levels, each relative to
/// itself; `before` are those of the previous level, if there is one. It is at least 1 if an amount is
/// negative, which is unphysical.
pub(crate) fn of_levels(times: f64, [finer, coarser]: [Vec<f64>; 2], before: Option<&[f64]>) -> f64 {
    let now = difference(&finer, &coarser);
    let error = level_error(times, now, before.map(|before| difference(&coarser, before)));
    if finer.iter().any(|y| is_negative(*y, &finer)) { largest(error, 1.0) } else { error }
}

fn difference(finer: &[f64], coarser: &[f64]) -> f64 {
    finer.iter().zip(coarser).map(|(a, b)| relative((*a, (a - b).abs()))).fold(0.0, largest)
}

/// Returns the ratio of error to difference between the last levels of a sample of numbers.
pub(crate) fn slowness([finer, coarser]: [&[f64]; 2], before: Option<&[f64]>) -> f64 {
    let now = difference(finer, coarser);
    let before = before.map(|before| difference(coarser, before));
    if now > 0.0 { extrapolated(1.0, now, before) / now } else { 1.0 }
}

/// Floor of the reference of relative errors, relative to the brightest row of a state: far from a lobe there
/// is hardly any light.
const FAINT: f64 = 1e-4;

/// Computes the relative error of each state's Y in a row, at the finer of two levels; `most` is the largest
/// Y of each state in the table. The error of a negative Y is at least its magnitude.
pub(crate) fn row_errors(finer: &[f64], coarser: &[f64], most: &[f64], times: f64) -> Vec<f64> {
    let error = |((a, b), most): ((&f64, &f64), &f64)| {
        let difference = (times * (a - b).abs()).max(-a);
        relative((a.abs().max(FAINT * most), difference))
    };
    finer.iter().zip(coarser).zip(most.iter().cycle()).map(error).collect()
}

/// Returns which values of the rows, `[row][state]`, adding does not resolve: negative ones, and faint ones whose
/// error is above a tenth. `errors` are those of [`row_errors`], `most` is the largest value of each state. Far from
/// the light of a lobe, levels differ by what remains of a sum that cancels: a difference that is small by chance is
/// replaced by three times their root mean square.
pub(crate) fn unresolved(rows: &[Vec<f64>], errors: &[Vec<f64>], most: &[f64]) -> Vec<Vec<bool>> {
    /// Relative error above which a faint value is not resolved.
    const MOST: f64 = 0.1;
    const TIMES: f64 = 3.0;
    let size = |y: f64, most: f64| y.abs().max(FAINT * most);
    let floor = |state: usize| {
        let most = most[state];
        let of_row =
            |(row, errors): (&Vec<f64>, &Vec<f64>)| (row[state], errors[state] * size(row[state], most));
        let faint = rows.iter().zip(errors).map(of_row).filter(|(y, _)| y.abs() < FAINT * FAINT * most);
        let (sum, count) =
            faint.fold((0.0_f64, 0.0), |(sum, count), (_, error)| (sum + error * error, count + 1.0));
        if count > 0.0 { TIMES * (sum / count).sqrt() } else { 0.0_f64 }
    };
    let floors: Vec<f64> = (0..most.len()).map(floor).collect();
    let of_state = |((y, error), (most, floor)): ((&f64, &f64), (&f64, &f64))| {
        let faint = y.abs() < FAINT * most && (error * size(*y, *most)).max(*floor) > MOST * y.abs();
        *y < 0.0 || faint
    };
    let of_row = |(row, errors): (&Vec<f64>, &Vec<f64>)| {
        row.iter().zip(errors).zip(most.iter().zip(&floors)).map(of_state).collect()
    };
    rows.iter().zip(errors).map(of_row).collect()
}

/// Returns the largest value of each state; the rows contain the values of all states in turn.
pub(crate) fn largest_of_states<'a>(rows: impl Iterator<Item = &'a [f64]>, states: usize) -> Vec<f64> {
    let mut most = vec![0.0; states];
    for row in rows.flat_map(|values| values.chunks_exact(states.max(1))) {
        most.iter_mut().zip(row).for_each(|(most, y): (&mut f64, &f64)| *most = most.max(y.abs()));
    }
    most
}

/// Returns true if a value is negative by more than rounding errors of the largest.
fn is_negative(y: f64, all: &[f64]) -> bool {
    /// Rounding error of sums, relative to the largest value.
    const ROUNDING: f64 = 1e-9;
    y < 0.0 && y < -ROUNDING * all.iter().fold(0.0, |most: f64, y| most.max(y.abs()))
}

/// Returns the larger of two errors; NaN if one of them is NaN.
pub(crate) fn largest(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_tenths(target: f64, stop_at: usize) -> Option<Refined<f64>> {
        let at = |level: usize| (level < stop_at).then(|| 0.1_f64.powi(level as i32));
        refine(target, 6, 1.0, at, |[finer, coarser], _| (finer - coarser).abs(), |_, _| {})
    }

    #[test]
    fn refinement_returns_the_finer_of_the_first_two_levels_that_agree() {
        let refined = by_tenths(0.01, 9).unwrap();
        assert_eq!((refined.level, refined.finished), (3, true));
        assert!((refined.error - 0.009).abs() < 1e-15 && (refined.finer - 0.001).abs() < 1e-15);
    }

    #[test]
    fn refinement_ends_at_the_finest_level() {
        let refined = by_tenths(0.0, 99).unwrap();
        assert_eq!((refined.level, refined.finished), (6, true));
    }

    /// Levels that fluctuate after the third: the result is that of the smallest error, but no smaller than the difference from
    /// a finer level, so that a level that agrees with the one before by chance is not taken.
    #[test]
    fn refinement_returns_the_level_with_the_smallest_error() {
        let of = |values: [f64; 5], target: f64| {
            let error = |[finer, coarser]: [&f64; 2], before: Option<&f64>| {
                level_error(1.0, (finer - coarser).abs(), before.map(|before| (coarser - before).abs()))
            };
            refine(target, 4, 1.0, |level| Some(values[level]), error, |_, _| {}).unwrap()
        };
        let fluctuating = [1.1, 1.0, 1.001, 1.0012, 1.0008];
        let found = of(fluctuating, 0.0);
        assert_eq!((found.level, found.finer, found.coarser, found.before), (3, 1.0012, 1.001, Some(1.0)));
        // Its own error is 2e-4; the fourth level differs by 4e-4, and has ten times that as its error.
        assert!((found.error - 4e-4).abs() < 1e-9 && (found.raised - 2.0).abs() < 1e-6 && found.finished);
        // The first two levels agree to 1e-5 by chance.
        let by_chance = of([1.0, 1.00001, 1.02, 1.021, 1.0211], 1e-6);
        assert_eq!((by_chance.level, by_chance.raised), (4, 1.0));
        let raised = of([1.0, 1.00001, 1.02, 1.0, 1.02], 1e-6);
        assert!(raised.error > 0.01, "{}", raised.error);
    }

    #[test]
    fn stopped_refinement_returns_the_last_two_levels_or_none() {
        let refined = by_tenths(0.0, 3).unwrap();
        assert_eq!((refined.level, refined.finished), (2, false));
        assert!(by_tenths(0.0, 1).is_none());
    }

    #[test]
    fn refinement_ends_where_adding_does_not_cover_a_further_level() {
        let covered = |levels: usize| {
            let at = |level: usize| match level < levels {
                true => Ok(0.1_f64.powi(level as i32)),
                false => Err(DisplayError::PlacesByPaths { what: String::new(), key: String::new() }),
            };
            refine_or_fail(0.0, 6, 1.0, at, |[finer, coarser], _| (finer - coarser).abs(), |_, _| {})
        };
        let refined = covered(2).unwrap();
        assert_eq!((refined.level, refined.finished), (1, true));
        assert!(matches!(covered(1), Err(DisplayError::PlacesByPaths { .. })));
    }

    #[test]
    fn error_of_differences_that_do_not_decrease_is_at_least_1() {
        assert_eq!(level_error(1.0, 0.01, None), 0.01);
        assert_eq!(level_error(1.0, 0.01, Some(0.1)), 0.01);
        // By chance.
        assert_eq!(level_error(1.0, 1e-5, Some(0.1)), 0.1 / 50.0);
        assert_eq!(level_error(1.0, 0.3, None), 1.0);
        assert!((level_error(1.0, 0.03, Some(0.04)) - 0.09).abs() < 1e-12);
        assert!((level_error(4.0, 0.03, Some(0.04)) - 0.12).abs() < 1e-12);
        assert_eq!(level_error(1.0, 0.03, Some(0.02)), 1.0);
        assert_eq!(level_error(1.0, 3.0, Some(0.02)), 3.0);
        // Rounding errors do not decrease either.
        assert!((level_error(1.0, 1e-9, Some(1e-9)) - 1e-8).abs() < 1e-20);
    }

    #[test]
    fn errors_of_faint_rows_are_relative_to_the_brightest_and_of_negative_rows_at_least_1() {
        let most = largest_of_states([&[1.0, 1e-3, -2.0, 5e-4][..]].into_iter(), 2);
        assert_eq!(most, [2.0, 1e-3]);
        let errors = row_errors(&[1.0, 1e-3, -0.5, 1e-9], &[0.99, 1e-3, -0.5, 2e-9], &most, 1.0);
        assert!((errors[0] - 0.01).abs() < 1e-12 && errors[1] == 0.0 && errors[2] == 1.0, "{errors:?}");
        assert!((errors[3] - 0.01).abs() < 1e-12, "{errors:?}");
    }

    /// Bright values are resolved whatever their error; faint ones if it is below a tenth, with the noise of their
    /// neighbours; negative ones never.
    #[test]
    fn faint_values_are_resolved_by_their_own_error_and_the_noise_of_the_dark() {
        let rows = [2.0, 1e-4, 1e-4, -0.5, 1e-9, 1e-9, 3e-8].map(|y| vec![y]);
        let differences = [1.0, 1e-6, 2e-5, 0.0, 4e-9, 0.0, 0.0];
        let most = largest_of_states(rows.iter().map(Vec::as_slice), 1);
        let errors: Vec<Vec<f64>> = rows
            .iter()
            .zip(differences)
            .map(|(row, difference)| row_errors(row, &[row[0] + difference], &most, 1.0))
            .collect();
        let found = unresolved(&rows, &errors, &most).concat();
        // The noise of the dark is 3 sqrt(16/2) 1e-9 = 8.5e-9.
        assert_eq!(found, [false, false, true, true, true, true, true]);
        let without_dark = unresolved(&rows[..3], &errors[..3], &most).concat();
        assert_eq!(without_dark, [false, false, true]);
        assert_eq!(unresolved(&[vec![0.0]], &[vec![0.0]], &[0.0]), [[false]]);
    }

    #[test]
    fn nan_ends_the_refinement() {
        let refined = refine(0.1, 6, 1.0, |_| Some(f64::NAN), |[a, b], _| a - b, |_, _| {}).unwrap();
        assert!(refined.error.is_nan() && refined.finished && refined.level == 1);
        assert!(
            largest(f64::NAN, 1.0).is_nan() && largest(1.0, f64::NAN).is_nan() && largest(1.0, 2.0) == 2.0
        );
    }
}
