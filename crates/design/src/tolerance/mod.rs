//! What production makes of a design: how its metrics scatter, how many pieces meet their limits, and which key is
//! to blame.
//!
//! - [`Plan`]: which pieces are made: scrambled Sobol points in sixteen independent replicates, by number, so that
//!   parts may be computed apart and a plan of more pieces begins with the same ones.
//! - [`Spread`]: mean, standard deviation and percentiles of a metric.
//! - [`Verdict`]: yield against limits, which limit fails how often, and the pieces that miss most.
//! - [`Sensitivities`]: first-order and total Sobol [`Indices`], from polynomials and what they leave over.
//! - [`Production`]: all of it for a scenario's `[tolerance]`; [`Report`]: what is said of it.
//!
//! Every number has its standard error: the jackknife over the replicates. Undefined metrics are NaN here: they are
//! counted, meet no limit, and are left out of all else.
//!
//! **Out of scope**: files, threads.

mod consistent;
mod estimate;
mod indices;
mod plan;
mod polynomials;
mod production;
mod report;
mod spread;
mod surrogate;
mod verdict;

pub use estimate::Estimate;
pub use indices::{Indices, Samples, Sensitivities, Surrogate};
pub use plan::{Draw, Plan, REPLICATES};
pub use production::Production;
pub use report::{LimitReport, MetricReport, Report, WorstDisplay};
pub use spread::{PERCENTILES, Spread};
pub use verdict::{Failing, Limit, Miss, Verdict};
