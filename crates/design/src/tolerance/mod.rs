//! Tolerance analysis: distributions of metrics in production, yield, and sensitivities to keys.
//!
//! - [`Plan`]: the displays of a production, as scrambled Sobol points in sixteen independent replicates. A
//!   display is determined by its row number. Shards can therefore be computed separately, and a longer plan
//!   begins with the same displays.
//! - [`MetricDistribution`]: mean, standard deviation and percentiles of a metric.
//! - [`Verdict`]: yield, how often each limit fails, and the displays that miss a limit most.
//! - [`Sensitivities`]: first-order and total-order Sobol [`Indices`], from a polynomial fit and its
//!   residuals.
//! - [`Production`]: the plan and study of a scenario's `[tolerance]`; [`Report`]: its results.
//!
//! Every number has a standard error, from the jackknife over the replicates. Undefined metrics are NaN: they
//! are counted, meet no limit, and are excluded from everything else.
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
pub use spread::{MetricDistribution, PERCENTILES};
pub use verdict::{Failing, Limit, Miss, Verdict};
