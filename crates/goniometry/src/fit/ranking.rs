//! Which lobe serves best.

use super::{Data, Fit, FitOptions};
use crate::double_pass::double_pass_error;
use crate::error::GoniometryError;
use crate::kernel::{Preparation, kernel};
use crate::measurement::Part;
use crate::models::Kind;
use papilio_optics::Scatterer;

/// A fit, and what it is worth to the caller.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranked {
    /// The fit.
    pub fit: Fit,
    /// The caller's score, the smaller the better; `None` if there is none.
    pub score: Option<f64>,
}

/// Fits by a score of the caller's, the smallest first: for instance by how far a display's metrics
/// move when the lobe takes the measurement's place. Equal scores, and fits without one (at the end), go
/// by their residual.
pub fn ranked(fits: Vec<Fit>, mut score: impl FnMut(&Fit) -> Option<f64>) -> Vec<Ranked> {
    let score = |fit: Fit| Ranked { score: score(&fit).filter(|score| !score.is_nan()), fit };
    let mut all: Vec<Ranked> = fits.into_iter().map(score).collect();
    let key = |ranked: &Ranked| ranked.score.unwrap_or(f64::INFINITY);
    all.sort_by(|a, b| key(a).total_cmp(&key(b)).then(a.fit.rms.total_cmp(&b.fit.rms)));
    all
}

/// Fits of a part's channel by one kind of lobe, or by all of them, ranked by their [`double_pass_error`] against the
/// kernel that a display would take of the data itself, from and to directions that were measured: what a display would
/// extrapolate says nothing of a lobe. Of a measurement with one incidence there is no such error, for no light crosses twice.
///
/// # Errors
/// If the data are too few or too dark for a fit.
pub fn fitted(
    part: &Part,
    channel: usize,
    kind: Option<Kind>,
    options: &FitOptions,
) -> Result<Vec<Ranked>, GoniometryError> {
    let data = Data::of_part(part, channel);
    let fits = match kind {
        None => Fit::all(&data, options)?,
        Some(kind) => vec![Fit::new(&data, kind, options)?],
    };
    let made = |extrapolate| {
        let preparation = Preparation { extrapolate, ..Preparation::default() };
        kernel(part, channel, &preparation, &[]).ok().map(|(scatter, _)| scatter)
    };
    let (truth, going_on) = (made(None), made(Some(1.0)));
    Ok(ranked(fits, |fit| {
        let (truth, going_on) = (truth.as_ref()?, going_on.as_ref()?);
        // Dark because it was not measured is what would not be dark if the lobe went on.
        let known = |from, to| truth.evaluate(from, to) > 0.0 || going_on.evaluate(from, to) <= 0.0;
        double_pass_error(|from, to| fit.value(from, to), |from, to| truth.evaluate(from, to), known)
    }))
}
