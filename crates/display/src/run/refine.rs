//! Finer and finer levels of discretisation, until two successive ones agree.

use std::collections::HashSet;

use papilio_transport::Stack;
use papilio_transport::adding::{FINEST, MOST_NODES, Narrowness, narrowest, nodes_needed};

use crate::DisplayError;
use crate::meter::relative;
use crate::pixel::state_names;
use crate::scene::{Layers, Pixel, Scene};
use crate::setup::layers_alone;

/// The finest level that the layers can be taken to.
///
/// # Errors
/// If not even two levels are within what can be computed.
pub(crate) fn finest(stack: &Stack) -> Result<usize, DisplayError> {
    let fits = |level: &u32| nodes_needed(stack, *level) <= MOST_NODES;
    match (0..=FINEST).take_while(fits).last() {
        Some(level) if level > 0 => Ok(level as usize),
        _ => Err(too_narrow(stack)),
    }
}

/// Roughly how long adding prepares the layers of a scene for one beam, in seconds of one processor; right to within a factor of
/// ten. A pixel that scatters is a layer more for each of its states. 0 for an ordinary panel, whose preparation takes milliseconds.
///
/// # Errors
/// If there is no such stack.
pub fn adding_seconds(scene: &Scene) -> Result<f64, DisplayError> {
    /// Of a node cubed, at each set of indices: two narrow diffusers in glass take 1.5 s with 213 nodes.
    const SECONDS: f64 = 1.5e-7;
    let Layers::General(layers) = &scene.display.layers else { return Ok(0.0) };
    let nodes = nodes_needed(&layers_alone(scene)?, 1) as f64;
    // Where indices differ, nothing is shared between wavelengths.
    let indices = |bin: usize| layers.iter().map(|layer| layer.medium.index[bin].to_bits()).collect();
    let sets: HashSet<Vec<u64>> = (0..scene.grid.len()).map(indices).collect();
    let stacks = match &scene.display.pixel {
        Pixel::Scattering(_) => 1 + state_names(&scene.display.pixel).len(),
        Pixel::Film(_) | Pixel::Table(_) | Pixel::Uniform(_) => 1,
    };
    Ok(SECONDS * nodes.powi(3) * (sets.len() * stacks) as f64)
}

/// The refusal, with what is to blame.
fn too_narrow(stack: &Stack) -> DisplayError {
    let (what, number) = match narrowest(stack) {
        None => ("a face".to_owned(), 1),
        Some(found) => {
            let what = match found.scatterer {
                Narrowness::Lobe { width } => format!("the diffuser of width {width:.5}"),
                Narrowness::Face { width } => format!("the diffuser of width {width:.5}"),
                Narrowness::Rough { alpha, .. } => format!("the rough face of alpha {alpha}"),
                Narrowness::Slab { anisotropy } => format!("the slab of anisotropy {anisotropy}"),
            };
            (what, found.number)
        }
    };
    DisplayError::TooNarrow { what, number, nodes: nodes_needed(stack, 1), most: MOST_NODES }
}

/// What two successive levels gave.
pub(crate) struct Refined<T> {
    pub(crate) finer: T,
    pub(crate) coarser: T,
    /// The level before that, if there is one.
    pub(crate) before: Option<T>,
    /// The finer level.
    pub(crate) level: usize,
    /// The relative difference of the two.
    pub(crate) error: f64,
    /// Not stopped before the target or the finest level was reached.
    pub(crate) finished: bool,
}

/// Levels from 0 on until the difference of two is at most the target, or to the finest (1 or more);
/// `None` if it was stopped before there were two. `at` computes a level, `None` if it was stopped; `error` tells the relative
/// error of the last of two or three levels; `tell` hears each difference, and whether it was the last.
pub(crate) fn refine<T>(
    target: f64,
    finest: usize,
    mut at: impl FnMut(usize) -> Option<T>,
    error: impl Fn([&T; 2], Option<&T>) -> f64,
    tell: impl Fn(f64, bool),
) -> Option<Refined<T>> {
    let (coarser, finer) = (at(0)?, at(1)?);
    let mut refined = Refined { finer, coarser, before: None, level: 1, error: 0.0, finished: false };
    loop {
        refined.error = error([&refined.finer, &refined.coarser], refined.before.as_ref());
        // An error that is not a number will not become one.
        let enough = refined.error <= target || refined.error.is_nan();
        refined.finished = enough || refined.level >= finest;
        tell(refined.error, refined.finished);
        if refined.finished {
            return Some(refined);
        }
        let Some(next) = at(refined.level + 1) else { return Some(refined) };
        refined.before =
            Some(std::mem::replace(&mut refined.coarser, std::mem::replace(&mut refined.finer, next)));
        refined.level += 1;
    }
}

/// The relative error of the finer of two levels that differ by `now`, where the two before differed by `before` and
/// `times` is the least that differences are multiplied by ([`error_over_difference`](papilio_transport::adding::error_over_difference)).
///
/// Differences that fall by a factor r from level to level leave `r/(1 - r)` times the last. Where they do not fall,
/// and are no mere rounding, nothing is known: the error is that of the whole number.
pub(crate) fn level_error(times: f64, now: f64, before: Option<f64>) -> f64 {
    /// The most that slow levels are extrapolated by.
    const MOST: f64 = 10.0;
    /// Differences that are more than what else is tabulated to.
    const LARGE: f64 = 1e-2;
    let Some(before) = before.filter(|before| *before > 0.0) else { return times * now };
    let ratio = now / before;
    if ratio >= 1.0 && now > LARGE {
        return (times * now).max(1.0);
    }
    // What is known to be slow has been multiplied for that: single ratios scatter.
    let rest = if times > 1.0 {
        times
    } else if ratio < 1.0 {
        (ratio / (1.0 - ratio)).clamp(1.0, MOST)
    } else {
        MOST
    };
    rest * now
}

/// The largest relative error of numbers of light at the finer of two levels, each relative to itself, with those of the level before
/// if there is one. That of a number below zero, which no light has, is one at least.
pub(crate) fn of_levels(times: f64, [finer, coarser]: [Vec<f64>; 2], before: Option<&[f64]>) -> f64 {
    let now = difference(&finer, &coarser);
    let error = level_error(times, now, before.map(|before| difference(&coarser, before)));
    if finer.iter().any(|y| is_negative(*y, &finer)) { largest(error, 1.0) } else { error }
}

fn difference(finer: &[f64], coarser: &[f64]) -> f64 {
    finer.iter().zip(coarser).map(|(a, b)| relative((*a, (a - b).abs()))).fold(0.0, largest)
}

/// By how much differences between the last levels of a sample had to be multiplied.
pub(crate) fn slowness<T>(sample: &Refined<T>, numbers: &impl Fn(&T) -> Vec<f64>) -> f64 {
    let [finer, coarser] = [&sample.finer, &sample.coarser].map(numbers);
    let now = difference(&finer, &coarser);
    let before = sample.before.as_ref().map(|before| difference(&coarser, &numbers(before)));
    if now > 0.0 { level_error(1.0, now, before) / now } else { 1.0 }
}

/// Rows fainter than this part of a state's brightest are held to that much light: far off a lobe there is next to none.
const FAINT: f64 = 1e-4;

/// The relative error of each state's Y in a row, at the finer of two levels; `most` is the largest of each state in the table. What is
/// below zero, as no light is, errs by as much at least.
pub(crate) fn row_errors(finer: &[f64], coarser: &[f64], most: &[f64], times: f64) -> Vec<f64> {
    let error = |((a, b), most): ((&f64, &f64), &f64)| {
        let difference = (times * (a - b).abs()).max(-a);
        relative((a.abs().max(FAINT * most), difference))
    };
    finer.iter().zip(coarser).zip(most.iter().cycle()).map(error).collect()
}

/// The largest value of each state, of rows that hold one of each in turn.
pub(crate) fn largest_of_states<'a>(rows: impl Iterator<Item = &'a [f64]>, states: usize) -> Vec<f64> {
    let mut most = vec![0.0; states];
    for row in rows.flat_map(|values| values.chunks_exact(states.max(1))) {
        most.iter_mut().zip(row).for_each(|(most, y): (&mut f64, &f64)| *most = most.max(y.abs()));
    }
    most
}

/// Below zero by more than rounding of the largest.
fn is_negative(y: f64, all: &[f64]) -> bool {
    /// Of the largest, what is no more than rounding of sums.
    const ROUNDING: f64 = 1e-9;
    y < 0.0 && y < -ROUNDING * all.iter().fold(0.0, |most: f64, y| most.max(y.abs()))
}

/// The larger of two errors; not a number if one of them is not.
pub(crate) fn largest(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn by_tenths(target: f64, stop_at: usize) -> Option<Refined<f64>> {
        let at = |level: usize| (level < stop_at).then(|| 0.1_f64.powi(level as i32));
        refine(target, 6, at, |[finer, coarser], _| (finer - coarser).abs(), |_, _| {})
    }

    #[test]
    fn the_finer_of_the_first_two_that_agree() {
        let refined = by_tenths(0.01, 9).unwrap();
        assert_eq!((refined.level, refined.finished), (3, true));
        assert!((refined.error - 0.009).abs() < 1e-15 && (refined.finer - 0.001).abs() < 1e-15);
    }

    #[test]
    fn the_finest_is_the_last() {
        let refined = by_tenths(0.0, 99).unwrap();
        assert_eq!((refined.level, refined.finished), (6, true));
    }

    #[test]
    fn stopped_it_has_what_two_levels_gave_or_nothing() {
        let refined = by_tenths(0.0, 3).unwrap();
        assert_eq!((refined.level, refined.finished), (2, false));
        assert!(by_tenths(0.0, 1).is_none());
    }

    #[test]
    fn levels_that_do_not_fall_have_the_error_of_the_whole() {
        assert_eq!(level_error(1.0, 0.01, None), 0.01);
        assert_eq!(level_error(1.0, 0.01, Some(0.1)), 0.01);
        assert!((level_error(1.0, 0.03, Some(0.04)) - 0.09).abs() < 1e-12);
        assert!((level_error(4.0, 0.03, Some(0.04)) - 0.12).abs() < 1e-12);
        assert_eq!(level_error(1.0, 0.03, Some(0.02)), 1.0);
        assert_eq!(level_error(1.0, 3.0, Some(0.02)), 3.0);
        // Rounding does not fall either.
        assert!((level_error(1.0, 1e-9, Some(1e-9)) - 1e-8).abs() < 1e-20);
    }

    #[test]
    fn faint_rows_are_held_to_the_brightest_and_dark_light_errs_by_itself() {
        let most = largest_of_states([&[1.0, 1e-3, -2.0, 5e-4][..]].into_iter(), 2);
        assert_eq!(most, [2.0, 1e-3]);
        let errors = row_errors(&[1.0, 1e-3, -0.5, 1e-9], &[0.99, 1e-3, -0.5, 2e-9], &most, 1.0);
        assert!((errors[0] - 0.01).abs() < 1e-12 && errors[1] == 0.0 && errors[2] == 1.0, "{errors:?}");
        assert!((errors[3] - 0.01).abs() < 1e-12, "{errors:?}");
    }

    #[test]
    fn what_is_not_a_number_ends_it() {
        let refined = refine(0.1, 6, |_| Some(f64::NAN), |[a, b], _| a - b, |_, _| {}).unwrap();
        assert!(refined.error.is_nan() && refined.finished && refined.level == 1);
        assert!(
            largest(f64::NAN, 1.0).is_nan() && largest(1.0, f64::NAN).is_nan() && largest(1.0, 2.0) == 2.0
        );
    }
}
