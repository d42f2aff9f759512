//! Ranking of fitted lobes.

use super::{Data, Fit, FitOptions};
use crate::double_pass::double_pass_error;
use crate::error::GoniometryError;
use crate::kernel::{Preparation, kernel};
use crate::measurement::MeasuredPart;
use crate::models::Kind;
use papilio_optics::Scatterer;

/// Fit with its score.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedFit {
    /// The fit.
    pub fit: Fit,
    /// Score from the caller, smaller is better; `None` if there is none.
    pub score: Option<f64>,
}

/// Ranks fits by a score from the caller, the smallest first; for instance, the change of a display's metrics
/// when the lobe replaces the measurement. Equal scores, and fits without one (at the end), are ordered
/// by their residual.
pub fn ranked(fits: Vec<Fit>, mut score: impl FnMut(&Fit) -> Option<f64>) -> Vec<RankedFit> {
    let score = |fit: Fit| RankedFit { score: score(&fit).filter(|score| !score.is_nan()), fit };
    let mut all: Vec<RankedFit> = fits.into_iter().map(score).collect();
    let key = |ranked: &RankedFit| ranked.score.unwrap_or(f64::INFINITY);
    all.sort_by(|a, b| key(a).total_cmp(&key(b)).then(a.fit.rms.total_cmp(&b.fit.rms)));
    all
}

/// Fits one kind of lobe, or all kinds, to a channel of a part. The fits are ranked by their
/// [`double_pass_error`] relative to the kernel of a display from the data themselves, over measured
/// directions: extrapolated values contain no information about a lobe. A measurement with one incidence has
/// no such error, because no light passes twice.
///
/// # Errors
/// If the data are too few or too dark for a fit.
pub fn fitted(
    part: &MeasuredPart,
    channel: usize,
    kind: Option<Kind>,
    options: &FitOptions,
) -> Result<Vec<RankedFit>, GoniometryError> {
    let data = Data::of_part(part, channel);
    let fits = match kind {
        None => Fit::all(&data, options)?,
        Some(kind) => vec![Fit::new(&data, kind, options)?],
    };
    let kernel_with = |extrapolate| {
        let preparation = Preparation { extrapolate, ..Preparation::default() };
        kernel(part, channel, &preparation, &[]).ok().map(|(scatter, _)| scatter)
    };
    let (truth, extrapolated) = (kernel_with(None), kernel_with(Some(1.0)));
    Ok(ranked(fits, |fit| {
        let (truth, extrapolated) = (truth.as_ref()?, extrapolated.as_ref()?);
        // A direction was not measured if extrapolation makes it brighter. This includes the edge of the
        // data, where the kernel falls to zero within one step.
        let known = |from, to| truth.evaluate(from, to) >= 0.99 * extrapolated.evaluate(from, to);
        double_pass_error(|from, to| fit.value(from, to), |from, to| truth.evaluate(from, to), known)
    }))
}
