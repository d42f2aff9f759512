//! Errors of a mean of a few sums, each over other directions.
//!
//! Below a diffuser, areas of sub-pixels and windows are summed over directions. They have kinks, for which a difference of levels may be
//! small by chance. Several sums over other directions have errors of their own: their scatter is that of their mean, the result.

use super::Meter;
use super::sample::Sample;

/// The error of a mean of few sums in standard errors: their scatter has three degrees of freedom, and a standard error is
/// exceeded by chance.
pub(crate) const STANDARD_ERRORS: f64 = 3.0;

/// Sample of a view at a level: the mean of sums.
#[derive(Debug, Clone)]
pub(crate) struct SampleOfSums {
    pub(crate) mean: Sample,
    sums: Vec<Sample>,
}

impl SampleOfSums {
    /// The mean of these sums, one or more.
    pub(crate) fn new(sums: Vec<Sample>) -> Self {
        Self { mean: Sample::mean(&sums, None), sums }
    }
}

impl Meter<'_> {
    /// Returns the largest relative error of Y over the states and, with `per_wavelength`, of the radiance at each wavelength, that
    /// the scatter of sums shows; 0 of a single sum.
    pub(crate) fn error_of_sums(&self, sample: &SampleOfSums, per_wavelength: bool) -> f64 {
        match &sample.sums[..] {
            [_] | [] => 0.0,
            sums => STANDARD_ERRORS * self.standard_error(sums, per_wavelength),
        }
    }
}
