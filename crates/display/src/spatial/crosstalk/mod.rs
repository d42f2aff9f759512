//! `papilio crosstalk`: which sub-pixel lights which, and the colours and contrast of fine figures.
//!
//! By adding every number is computed at two levels of discretisation; the finer one is the result, the
//! difference its error, or the scatter of its sums if that is larger. By Monte Carlo (`paths`) errors are standard errors.

mod blurred;
mod filter;
mod flat;
mod found;
mod frame;
mod measure;
mod paths;
mod places;
mod result;
mod returned;
mod shares;
mod surfaces;
mod through_lobe;

use self::found::{Levelled, Measured, assembled};
use self::frame::Frame;
pub use self::result::{CrosstalkResult, CrosstalkView, Figure, PatternColours, PatternValues, Shares};
use super::target::{self, missed_target};
use crate::DisplayError;
use crate::filtered::Filtered;
use crate::run::{Control, each_view};
use crate::scene::{Matrix, Method, SPREAD_KEY, Scene};
use crate::setup::{Setup, ViewPoint};

/// X, Y and Z relative to a perfect white.
type Colour = [f64; 3];

/// Numbers whose errors are not relative.
const SHARES: &str = "shares";

/// State of pages, and that of figures whose contrast is measured.
const PAGE: &str = "white";
const BLACK: &str = "black";

/// Computes who lights whom in each view, and the colours of figures on a page. Text is `text`.
///
/// # Errors
/// If the scene is invalid, has no matrix, a length is missing, its kind of display or light is not covered,
/// or the computation was stopped.
pub fn crosstalk(scene: &Scene, text: &str, control: &Control<'_>) -> Result<CrosstalkResult, DisplayError> {
    let setup = Setup::of_places(scene, control)?;
    if scene.display.filter().is_some() && scene.display.pixel_spread().is_some() {
        return Err(DisplayError::PlacesNotComputed {
            what: "which part of a colour filter lights which, above pixels inside which light spreads"
                .to_owned(),
            key: SPREAD_KEY.to_owned(),
        });
    }
    if scene.solver.method == Method::MonteCarlo {
        let matrix = matrix(&setup)?;
        return result(&setup, matrix, paths::views(&setup, matrix, text, control)?);
    }
    if let Some(filtered) = Filtered::new(&setup, control)? {
        let matrix = matrix(&setup)?;
        return result(&setup, matrix, filter::views(&filtered, &setup, control)?);
    }
    let frame = Frame::new(&setup, text, control)?;
    let views =
        each_view(&setup, false, control, |number, control| frame.view(&setup.views[number], control))?;
    result(&setup, frame.matrix, views)
}

fn matrix(setup: &Setup) -> Result<&Matrix, DisplayError> {
    let missing = DisplayError::NoMatrix { command: "crosstalk" };
    setup.scene.display.matrix.as_ref().ok_or(missing)
}

/// State of the page: white, or the first one.
fn page(setup: &Setup) -> usize {
    state(setup, PAGE).unwrap_or(0)
}

fn state(setup: &Setup, name: &str) -> Option<usize> {
    setup.states.iter().position(|state| state == name)
}

fn result(
    setup: &Setup,
    matrix: &Matrix,
    views: Vec<CrosstalkView>,
) -> Result<CrosstalkResult, DisplayError> {
    let error_reached = views.iter().map(|view| view.shares.error).fold(0.0, f64::max);
    if !error_reached.is_finite() {
        return Err(DisplayError::NotFinite);
    }
    Ok(CrosstalkResult {
        subpixels: matrix.sub_pixels.iter().map(|one| one.name.clone()).collect(),
        pitch_um: matrix.pitch_mm.map(|pitch| 1e3 * pitch),
        page: setup.states.get(page(setup)).cloned().unwrap_or_default(),
        error_reached,
        warnings: missed(setup, &views).into_iter().collect(),
        views,
    })
}

/// Refines a view. `factor`: error of a level over its difference from the one before.
fn refined(
    setup: &Setup,
    view: &ViewPoint,
    (finest, factor): (usize, f64),
    at: impl FnMut(usize) -> Result<Levelled, DisplayError>,
    control: &Control<'_>,
) -> Result<CrosstalkView, DisplayError> {
    let of = |[fine, coarse]: [&Levelled; 2]| {
        let against = |others: &[&Measured]| assembled(setup, view, &fine.found, others);
        let mut seen = match factor {
            1.0 => against(&[&coarse.found]),
            factor => against(&[&coarse.found.away(&fine.found, factor)]),
        };
        if !fine.by_sum.is_empty() {
            seen.widen_errors(&against(&fine.by_sum.iter().collect::<Vec<_>>()));
        }
        if let Some(other) = &fine.by_other_chains {
            seen.widen_errors(&against(&[other]));
        }
        seen
    };
    let found = target::refined(setup, finest, at, |levels| largest_error(&of(levels)).1, control)?;
    Ok(of([&found.finer, &found.coarser]))
}

/// Returns the number with the largest error, and this error: of the shares, or a relative one of a contrast
/// ratio.
fn largest_error(view: &CrosstalkView) -> (&'static str, f64) {
    let of_pattern = |pattern: &PatternColours| {
        Some((pattern.name.name(), pattern.error.contrast_ratio? / pattern.values.contrast_ratio?))
    };
    let all = view.patterns.iter().filter_map(of_pattern);
    all.fold((SHARES, view.shares.error), |most, one| if one.1 > most.1 { one } else { most })
}

/// Warning of errors above the target of the scene.
fn missed(setup: &Setup, views: &[CrosstalkView]) -> Option<String> {
    let (what, most) = views.iter().map(largest_error).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let what = if what == SHARES { "the shares".to_owned() } else { format!("the contrast ratio of {what}") };
    missed_target(&setup.scene, most, &what)
}

fn add(sum: &mut Colour, more: Colour) {
    (0..3).for_each(|k| sum[k] += more[k]);
}
