//! `[tolerance]`: how production scatters the keys of a scenario, and which limits its displays have to meet.

use super::Label;
use super::limits::{Limit, MetricName};
use super::numbers::{Count, Seed};
use super::sweep::Any;
use crate::grammar::{number, table};
use crate::range::Range;
use crate::read::{At, Read};
use crate::tree::Node;

table! {
    /// How keys vary in production, for `papilio tolerance` only.
    Tolerance {
        /// Number of displays.
        samples: Count<64, MOST_SAMPLES> = Count(4096),
        /// Number of displays for which sensitivities are computed, which takes two more evaluations and one for each key;
        /// 0: none. Default: a quarter of `samples`.
        sensitivity_samples: Option<Count<0, MOST_SAMPLES>>,
        /// Seed of the displays.
        seed: Seed = Count(0),
        /// The keys that vary, each with a distribution.
        keys: Vec<At<Scattered>>,
        /// Keys whose deviations are correlated. Default: none.
        correlations: Vec<At<Correlated>> = Vec::new(),
        /// What a good display has to meet. Default: none, and every display is good.
        limits: Vec<At<Limit>> = Vec::new(),
        /// Metrics that are reported beside those that have limits. Default: contrast_ratio, gamut_percent_srgb, white.Y,
        /// black.Y and L_star, a_star, b_star of white, as far as the display has them.
        metrics: Option<Vec<At<MetricName>>>,
    }
}

/// More displays are not made.
pub(crate) const MOST_SAMPLES: u64 = 10_000_000;

table! {
    /// A key that scatters, or several that do so alike; with exactly one distribution. Its numbers are those of the key; of
    /// several keys, deviations from what each of them is.
    Scattered {
        /// A path as in `--set`. Either `key` or `keys`.
        key: Option<String>,
        /// Several paths with the same deviation; numbers are deviations from the value of each. Either `key` or `keys`.
        keys: Option<Vec<At<String>>>,
        /// Name for tables and figures, one line. Default: the path.
        name: Option<Label>,
        /// `true`: the numbers of the distribution are multiples of the key's value.
        relative: bool = false,
        /// Normal distribution.
        normal: Option<Normal>,
        /// Log-normal distribution: never below 0.
        lognormal: Option<LogNormal>,
        /// Uniform distribution between two ends.
        uniform: Option<Uniform>,
        /// Triangular distribution: rising to the mode, then falling.
        triangular: Option<Triangular>,
        /// One of a list of values: bins, lots, suppliers.
        choices: Option<Bins>,
    }
}

table! {
    /// A normal distribution, which may be cut off at both ends: what lies beyond is sorted out.
    Normal {
        /// Mean, before truncation. Default: the key's value.
        mean: Option<Any>,
        /// Standard deviation, before truncation.
        sigma: Deviation,
        /// Lower end of the truncated distribution. Default: not truncated.
        from: Option<Any>,
        /// Upper end of the truncated distribution. Default: not truncated.
        to: Option<Any>,
    }
}

table! {
    /// A log-normal distribution, which may be cut off at both ends.
    LogNormal {
        /// Median, before truncation. Default: the key's value.
        median: Option<Any>,
        /// Standard deviation of the natural logarithm: about the relative standard deviation of the number.
        sigma: Deviation,
        /// Lower end of the truncated distribution. Default: not truncated.
        from: Option<Any>,
        /// Upper end of the truncated distribution. Default: not truncated.
        to: Option<Any>,
    }
}

table! {
    /// A uniform distribution: `from` and `to`, or `plus_minus`.
    Uniform {
        /// Lower end. Either `from` and `to`, or `plus_minus`.
        from: Option<Any>,
        /// Upper end. Either `from` and `to`, or `plus_minus`.
        to: Option<Any>,
        /// Half width about the key's value. Either `from` and `to`, or `plus_minus`.
        plus_minus: Option<Deviation>,
    }
}

table! {
    /// A triangular distribution: `from` and `to`, or `plus_minus`.
    Triangular {
        /// Lower end. Either `from` and `to`, or `plus_minus`.
        from: Option<Any>,
        /// The most likely value. Default: the key's value.
        mode: Option<Any>,
        /// Upper end. Either `from` and `to`, or `plus_minus`.
        to: Option<Any>,
        /// Half width about the mode. Either `from` and `to`, or `plus_minus`.
        plus_minus: Option<Deviation>,
    }
}

table! {
    /// Anything that the key may be, one of a list.
    Bins {
        /// The values.
        values: Vec<At<Anything>>,
        /// How often each value occurs, relative to the others. Default: all equally often.
        weights: Option<Vec<At<Frequency>>>,
    }
}

table! {
    /// Keys whose deviations are correlated.
    Correlated {
        /// Two or more of the keys, by name (by path where no name is given); every pair has the coefficient.
        keys: Vec<At<String>>,
        /// Correlation of the normal numbers from which the values are drawn.
        coefficient: Correlation,
    }
}

number!(
    /// How far a number scatters, in its own unit.
    Deviation, Range::above_0_to(1e6)
);
number!(
    /// How often one of a list is met, relative to the others.
    Frequency, Range::from_to(0.0, 1e6)
);
number!(
    /// A coefficient of correlation.
    Correlation, Range::between(-1.0, 1.0)
);

/// A value of whatever kind its key takes.
#[derive(Debug, Clone)]
pub(crate) struct Anything(pub(crate) Node);

impl Read for Anything {
    fn in_words() -> String {
        "a value".to_owned()
    }

    fn read(node: &Node, _: &mut crate::error::Errors) -> Option<Self> {
        Some(Self(node.clone()))
    }
}

impl serde::Serialize for Anything {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.to_json().serialize(serializer)
    }
}

impl schemars::JsonSchema for Anything {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Anything".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!(true)
    }
    fn inline_schema() -> bool {
        true
    }
}
