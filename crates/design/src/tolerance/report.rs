//! What is said of a production.

use papilio_scenario::Tolerance;
use serde::Serialize;
use serde_json::Value;

use super::indices::{Indices, Samples, Sensitivities, Surrogate};
use super::production::Production;
use super::spread::Spread;
use super::verdict::{Limit, Verdict};

/// So many of the worst displays are named.
const WORST: usize = 10;

/// What production makes of a design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Displays that stand for the production.
    pub samples: usize,
    /// Of how many sensitivities are found.
    pub sensitivity_samples: usize,
    /// The keys that scatter, in groups of those that do so together.
    pub groups: Vec<Vec<String>>,
    /// Each metric.
    pub metrics: Vec<MetricReport>,
    /// Each limit: which metric, and how often it fails.
    pub limits: Vec<LimitReport>,
    /// Yield, and what it is not met by.
    pub verdict: Verdict,
    /// The displays that miss most.
    pub worst: Vec<WorstDisplay>,
}

/// How a metric scatters, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MetricReport {
    /// Its name.
    pub name: String,
    /// How it scatters; null if it is nowhere defined.
    pub spread: Option<Spread>,
    /// For each group of keys how much of its variance comes from it; null where it does not scatter or none were sought.
    pub indices: Vec<Option<Indices>>,
    /// The polynomials that the indices rest on; null without any.
    pub surrogate: Option<Surrogate>,
}

/// A limit as it was given.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitReport {
    /// The metric.
    pub metric: String,
    /// No less.
    pub at_least: Option<f64>,
    /// No more.
    pub at_most: Option<f64>,
}

/// A display that misses a limit by far.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorstDisplay {
    /// Its row.
    pub row: usize,
    /// The limit that it misses most, from 0.
    pub limit: usize,
    /// How far, in standard deviations of the metric; null where the metric is undefined.
    pub missed_by_sigma: Option<f64>,
    /// What its keys are.
    pub keys: Vec<Value>,
    /// Its metrics; null where undefined.
    pub metrics: Vec<Option<f64>>,
}

impl Report {
    /// Of all rows, in order, each as [`Production::evaluate`] gives it.
    pub fn new(tolerance: &Tolerance, production: &Production, rows: &[&[f64]]) -> Self {
        let count = tolerance.metrics.len();
        let column = |draw: usize, metric: usize, rows: &[&[f64]]| -> Vec<f64> {
            let at = draw * count + metric;
            rows.iter().map(|row| row.get(at).copied().unwrap_or(f64::NAN)).collect()
        };
        let columns: Vec<Vec<f64>> = (0..count).map(|metric| column(0, metric, rows)).collect();
        let sought = &rows[..production.sensitivity_rows().min(rows.len())];
        let groups = production.plan().groups();
        let samples: Vec<Samples> = (0..count)
            .map(|metric| Samples {
                own: columns[metric].clone(),
                other: column(1, metric, sought),
                mixed: (0..groups.len()).map(|group| column(2 + group, metric, sought)).collect(),
            })
            .collect();
        let sensitivities = Sensitivities::of(production.plan(), &samples);
        let metrics: Vec<MetricReport> = (columns.iter().zip(sensitivities).zip(&tolerance.metrics))
            .map(|((column, found), metric)| MetricReport {
                name: metric.name.clone(),
                spread: Spread::of(column),
                indices: found.indices,
                surrogate: found.surrogate,
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
            sensitivity_samples: sought.len(),
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
