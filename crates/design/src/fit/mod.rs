//! Fits of a scenario to measured data: least squares.
//!
//! **What.** The variables of a `[fit]` minimise chi-square: the sum of the squares of (predicted - measured) /
//! standard deviation of all measured numbers, and of (value - mean) / sigma of all priors. Predicted are
//! reflectance factors (interpolated at the measured wavelengths), X, Y, Z, L\*, a\*, b\*, and metrics. Where a
//! measurement states no standard deviation, one common to all numbers of its kind follows from the residuals.
//!
//! **How.** A Levenberg-Marquardt method within bounds (`levenberg_marquardt`), from several starting points;
//! derivatives are central differences at one level of discretisation, whose error cancels. Intervals are those
//! of the profile likelihood (`profile`): a variable is held while all others minimise chi-square again. Where the
//! data do not determine a direction in the space of the variables (`undetermined`), its variables get no numbers.
//!
//! **Sources.** J. Nocedal and S. J. Wright, *Numerical Optimization* (2006), ch. 10; H. B. Nielsen, report
//! IMM-REP-1999-05 (damping); D. J. Venzon and S. H. Moolgavkar, Appl. Statist. 37, 87 (1988) (profiles);
//! G. Schwarz, Ann. Statist. 6, 461 (1978) (BIC); A. Wald and J. Wolfowitz, Ann. Math. Statist. 11, 147 (1940)
//! (runs).
//!
//! **Out of scope.** Reading files, and errors that several numbers of a measurement have in common, except for
//! `meter.scale` and `meter.wavelength_offset_nm`.

mod bounded;
mod interpolation;
mod kept;
mod levenberg_marquardt;
mod matrix;
mod model;
mod problem;
mod profile;
mod remarks;
mod report;
mod run;
mod statistics;
mod undetermined;
mod wavelengths;

pub use model::{Model, Observation};
pub use report::{Estimated, FitReport, FittedVariable, Residual, Runs, Starts};
pub use run::{FitProgress, Fitting};
