//! Which lobe serves best.

use super::Fit;

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
