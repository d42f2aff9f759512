//! Report of a tolerance analysis.

use papilio_scenario::Tolerance;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use super::indices::{Indices, Samples, Sensitivities, Surrogate};
use super::production::Production;
use super::spread::MetricDistribution;
use super::verdict::{Limit, Verdict};

/// Number of worst displays in a report.
const WORST: usize = 10;

/// Results of a tolerance analysis.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "ToleranceReport")]
pub struct Report {
    /// Number of sampled displays.
    pub samples: usize,
    /// Number of rows from which sensitivities are computed.
    pub sensitivity_samples: usize,
    /// Warnings of the scenario.
    pub warnings: Vec<String>,
    /// Notes on how the scenario was interpreted.
    pub notes: Vec<String>,
    /// Varied keys, in groups of correlated ones.
    pub groups: Vec<Vec<String>>,
    /// Results of each metric.
    pub metrics: Vec<MetricReport>,
    /// Limits, in the order of `verdict.failing`.
    pub limits: Vec<LimitReport>,
    /// Yield, and how often each limit fails.
    pub verdict: Verdict,
    /// Displays that miss a limit most.
    pub worst: Vec<WorstDisplay>,
}

/// Distribution and sensitivities of a metric.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MetricReport {
    /// Name of the metric.
    pub name: String,
    /// Distribution; null if the metric is undefined everywhere.
    pub spread: Option<MetricDistribution>,
    /// Sobol indices of each group of keys; null if the metric does not vary or no sensitivities were
    /// requested.
    pub indices: Vec<Option<Indices>>,
    /// Polynomial fit that the indices are based on; null if there is none.
    pub surrogate: Option<Surrogate>,
}

/// A limit of the scenario.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LimitReport {
    /// Name of the metric.
    pub metric: String,
    /// Lower limit.
    pub at_least: Option<f64>,
    /// Upper limit.
    pub at_most: Option<f64>,
}

/// Display that misses a limit by a large distance.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct WorstDisplay {
    /// Row of the display.
    pub row: usize,
    /// Index of the limit that it misses most, from 0.
    pub limit: usize,
    /// Distance from this limit in standard deviations of the metric; null if the metric is undefined.
    pub missed_by_sigma: Option<f64>,
    /// Values of its keys.
    pub keys: Vec<Value>,
    /// Metrics; null where undefined.
    pub metrics: Vec<Option<f64>>,
}

impl Report {
    /// Computes the report from all rows in order, each as returned by [`Production::evaluate`].
    pub fn new(tolerance: &Tolerance, production: &Production, rows: &[&[f64]]) -> Self {
        let count = tolerance.metrics.len();
        let column = |draw: usize, metric: usize, rows: &[&[f64]]| -> Vec<f64> {
            let index = draw * count + metric;
            rows.iter().map(|row| row.get(index).copied().unwrap_or(f64::NAN)).collect()
        };
        let columns: Vec<Vec<f64>> = (0..count).map(|metric| column(0, metric, rows)).collect();
        let sensitivity_rows = &rows[..production.sensitivity_rows().min(rows.len())];
        let groups = production.plan().groups();
        let samples: Vec<Samples> = (0..count)
            .map(|metric| Samples {
                own: columns[metric].clone(),
                other: column(1, metric, sensitivity_rows),
                mixed: (0..groups.len()).map(|group| column(2 + group, metric, sensitivity_rows)).collect(),
            })
            .collect();
        let sensitivities = Sensitivities::of(production.plan(), &samples);
        let metrics: Vec<MetricReport> = (columns.iter().zip(sensitivities).zip(&tolerance.metrics))
            .map(|((column, sensitivities), metric)| MetricReport {
                name: metric.name.clone(),
                spread: MetricDistribution::of(column),
                indices: sensitivities.indices,
                surrogate: sensitivities.surrogate,
            })
            .collect();
        let limits = tolerance.limits.iter();
        let limits: Vec<Limit> = limits
            .map(|one| Limit { column: one.metric, at_least: one.at_least, at_most: one.at_most })
            .collect();
        let deviation =
            |one: &MetricReport| one.spread.as_ref().map_or(f64::NAN, |spread| spread.deviation.value);
        let deviations: Vec<f64> = metrics.iter().map(deviation).collect();
        let (verdict, misses) = Verdict::of(&columns, &limits, &deviations, WORST);
        let worst = misses.iter().map(|miss| WorstDisplay {
            row: miss.row,
            limit: miss.limit,
            missed_by_sigma: Some(miss.by).filter(|by| by.is_finite()),
            keys: production.values(miss.row),
            metrics: columns
                .iter()
                .map(|column| Some(column[miss.row]).filter(|one| !one.is_nan()))
                .collect(),
        });
        let name = |key: &usize| tolerance.keys[*key].name.clone();
        Self {
            samples: rows.len(),
            sensitivity_samples: sensitivity_rows.len(),
            warnings: tolerance.warnings.clone(),
            notes: tolerance.notes.clone(),
            groups: groups.iter().map(|group| group.iter().map(name).collect()).collect(),
            limits: tolerance
                .limits
                .iter()
                .map(|limit| LimitReport {
                    metric: tolerance.metrics[limit.metric].name.clone(),
                    at_least: limit.at_least,
                    at_most: limit.at_most,
                })
                .collect(),
            worst: worst.collect(),
            metrics,
            verdict,
        }
    }
}
