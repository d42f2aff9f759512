//! `[fit]`: keys that are fitted to measured data.

use super::numbers::{Count, Seed};
use super::sweep::Any;
use super::tolerance::Deviation;
use crate::fit::FitDeviations;
use crate::grammar::{choice, table};
use crate::read::Spanned;
use crate::word::Word;

table! {
    /// A fit of keys to measured data, for `papilio fit` only.
    Fit {
        /// Number of starting points: the scenario's own values, and points within the bounds.
        starts: Count<1, 1000> = Count(8),
        /// Standard deviations of the measured numbers.
        deviations: Word<FitDeviations> = Word(FitDeviations::Stated),
        /// Seed of the starting points.
        seed: Seed = Count(0),
        /// Variables: what the data are to determine.
        variables: Vec<Spanned<FitVariable>>,
    }
}

choice! {
    for FitDeviations {
        /// Those of the measurement; from the residuals where it states none.
        Stated = "stated",
        /// From the residuals, one for each kind of numbers: where the stated ones are too small.
        Residuals = "residuals",
    }
}

table! {
    /// A number that the data are to determine.
    FitVariable {
        /// A path as in `--set`, or `"meter.wavelength_offset_nm"` or `"meter.scale"` (docs/fit.md); or
        /// `keys`.
        key: Option<String>,
        /// Several paths that get the same value.
        keys: Option<Vec<Spanned<String>>>,
        /// A key that changes by the opposite amount, so that the sum is constant: for areas and shares of the light.
        compensated_by: Option<String>,
        /// The smallest and the largest value.
        bounds: Vec<Spanned<Any>>,
        /// What is known of the value from elsewhere. Default: nothing.
        prior: Option<Prior>,
    }
}

table! {
    /// A normal distribution of a value that is known from elsewhere.
    Prior {
        /// Mean.
        mean: Any,
        /// Standard deviation.
        sigma: Deviation,
    }
}
