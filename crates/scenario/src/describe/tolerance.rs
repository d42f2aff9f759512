//! `[tolerance]`: distributions of keys in production, and limits of good displays.

use super::Label;
use super::limits::{Limit, MetricName};
use super::numbers::{Count, Seed};
use super::sweep::Any;
use crate::grammar::{number, table};
use crate::range::Range;
use crate::read::{Read, Spanned};
use crate::tree::Node;

table! {
    /// Production tolerances, for `papilio tolerance` only.
    Tolerance {
        /// Number of displays.
        samples: Count<64, MOST_SAMPLES> = Count(4096),
        /// Displays for sensitivities, each with two more evaluations and one for each key; 0: none. Default:
        /// a quarter of `samples`.
        sensitivity_samples: Option<Count<0, MOST_SAMPLES>>,
        /// Seed of the samples.
        seed: Seed = Count(0),
        /// The keys that vary, each with a distribution.
        keys: Vec<Spanned<Scattered>>,
        /// Keys whose deviations are correlated. Default: none.
        correlations: Vec<Spanned<Correlated>> = Vec::new(),
        /// Limits of a good display. Default: none: every display is good.
        limits: Vec<Spanned<Limit>> = Vec::new(),
        /// Metrics to report in addition to those with limits. Default: contrast_ratio, gamut_percent_srgb,
        /// white.Y, black.Y and L_star, a_star, b_star of white, where they exist.
        metrics: Option<Vec<Spanned<MetricName>>>,
    }
}

/// Largest number of displays.
pub(crate) const MOST_SAMPLES: u64 = 10_000_000;

table! {
    /// A key with a distribution, or several with the same deviation. There is exactly one distribution. Its numbers are
    /// values of the key; for several keys, deviations from the value of each. `choices` are always values.
    Scattered {
        /// A path as in `--set`; or `keys`.
        key: Option<String>,
        /// Several paths with the same deviation from the value of each, or with the same choice.
        keys: Option<Vec<Spanned<String>>>,
        /// Name in tables and figures. Default: the path.
        name: Option<Label>,
        /// `true`: the numbers of the distribution are multiples of the scenario's value. Not with `choices`.
        relative: bool = false,
        /// Normal distribution.
        normal: Option<Normal>,
        /// Log-normal distribution, always above 0.
        lognormal: Option<LogNormal>,
        /// Uniform distribution.
        uniform: Option<Uniform>,
        /// Triangular distribution.
        triangular: Option<Triangular>,
        /// One of a list of values (bins, lots, suppliers).
        choices: Option<Bins>,
    }
}

table! {
    /// A normal distribution, which may be truncated at both ends: displays beyond are sorted out.
    Normal {
        /// Mean, before truncation. Default: the scenario's value.
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
    /// A log-normal distribution, which may be truncated at both ends.
    LogNormal {
        /// Median, before truncation. Default: the scenario's value.
        median: Option<Any>,
        /// Standard deviation of the natural logarithm, about the relative standard deviation of the number.
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
        /// Lower end; with `to`, or `plus_minus` instead.
        from: Option<Any>,
        /// Upper end.
        to: Option<Any>,
        /// Half width about the scenario's value.
        plus_minus: Option<Deviation>,
    }
}

table! {
    /// A triangular distribution: `from` and `to`, or `plus_minus`.
    Triangular {
        /// Lower end; with `to`, or `plus_minus` instead.
        from: Option<Any>,
        /// The most probable value. Default: the scenario's value.
        mode: Option<Any>,
        /// Upper end.
        to: Option<Any>,
        /// Half width about the mode.
        plus_minus: Option<Deviation>,
    }
}

table! {
    /// One of a list of values, with probabilities.
    Bins {
        /// The possible values, of any type that the key accepts; for several keys, values of each of them.
        values: Vec<Spanned<Anything>>,
        /// Relative frequencies of the values. Default: equal weights.
        weights: Option<Vec<Spanned<Frequency>>>,
    }
}

table! {
    /// Keys whose deviations are correlated.
    Correlated {
        /// Names of two or more keys (the path if there is no name), of which every pair has the coefficient.
        keys: Vec<Spanned<String>>,
        /// Correlation of the normal random numbers from which the values are drawn.
        coefficient: Correlation,
    }
}

number!(
    /// A standard deviation or a half width, in the unit of the key.
    Deviation, Range::above_0_to(1e6)
);
number!(
    /// A relative frequency.
    Frequency, Range::from_to(0.0, 1e6)
);
number!(
    /// A correlation coefficient.
    Correlation, Range::between(-1.0, 1.0)
);

/// A value of any type.
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
