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
    /// How keys scatter in production, for `papilio tolerance` alone.
    Tolerance {
        /// How many displays are made, 64 to 10 000 000. Default 4096.
        samples: Count<64, MOST_SAMPLES> = Count(4096),
        /// For how many of them the sensitivities are sought, which takes two more displays each and one for each key: 0
        /// (none) or more. Default: a quarter of `samples`.
        sensitivity_samples: Option<Count<0, MOST_SAMPLES>>,
        /// Which displays are made, 0 or more. Default 0.
        seed: Seed = Count(0),
        /// The keys that scatter.
        keys: Vec<At<Scattered>>,
        /// Keys that scatter together. Default: none.
        correlations: Vec<At<Correlated>> = Vec::new(),
        /// What a good display has to meet. Default: none, and every display is good.
        limits: Vec<At<Limit>> = Vec::new(),
        /// Metrics that are reported besides those that have limits. Default: contrast_ratio, gamut_percent_srgb, white.Y,
        /// black.Y and the white's L_star, a_star and b_star, as far as the display has them.
        metrics: Option<Vec<At<MetricName>>>,
    }
}

/// More displays are not made.
pub(crate) const MOST_SAMPLES: u64 = 10_000_000;

table! {
    /// A key that scatters, or several that do so alike; with exactly one distribution. Its numbers are those of the key; of
    /// several keys, deviations from what each of them is.
    Scattered {
        /// A path as of --set.
        key: Option<String>,
        /// Several that deviate alike; or give `key`.
        keys: Option<Vec<At<String>>>,
        /// What tables and figures call it, one line. Default: its path.
        name: Option<Label>,
        /// True: the distribution's numbers are multiples of what the key is. Default false.
        relative: bool = false,
        /// Bell-shaped.
        normal: Option<Normal>,
        /// Bell-shaped on a logarithmic scale: never below 0.
        lognormal: Option<LogNormal>,
        /// Alike between two ends.
        uniform: Option<Uniform>,
        /// Rising to the likeliest, and falling.
        triangular: Option<Triangular>,
        /// One of a list: bins, lots, suppliers.
        choices: Option<Bins>,
    }
}

table! {
    /// A normal distribution, which may be cut off at both ends: what lies beyond is sorted out.
    Normal {
        /// Default: what the key is.
        mean: Option<Any>,
        /// Standard deviation, before it is cut off, above 0.
        sigma: Deviation,
        /// Nothing is less. Default: not cut off.
        from: Option<Any>,
        /// Nothing is more. Default: not cut off.
        to: Option<Any>,
    }
}

table! {
    /// A log-normal distribution, which may be cut off at both ends.
    LogNormal {
        /// Half is less. Default: what the key is.
        median: Option<Any>,
        /// Standard deviation of the natural logarithm, about that of the number over the number, above 0.
        sigma: Deviation,
        /// Nothing is less. Default: not cut off.
        from: Option<Any>,
        /// Nothing is more. Default: not cut off.
        to: Option<Any>,
    }
}

table! {
    /// A uniform distribution: `from` and `to`, or `plus_minus`.
    Uniform {
        /// The least.
        from: Option<Any>,
        /// The largest.
        to: Option<Any>,
        /// As far to both sides of what the key is, above 0.
        plus_minus: Option<Deviation>,
    }
}

table! {
    /// A triangular distribution: `from` and `to`, or `plus_minus`.
    Triangular {
        /// The least.
        from: Option<Any>,
        /// The likeliest. Default: what the key is.
        mode: Option<Any>,
        /// The largest.
        to: Option<Any>,
        /// As far to both sides of the likeliest, above 0.
        plus_minus: Option<Deviation>,
    }
}

table! {
    /// Anything that the key may be, one of a list.
    Bins {
        /// The list.
        values: Vec<At<Anything>>,
        /// How often each is met, 0 or more. Default: all alike.
        weights: Option<Vec<At<Frequency>>>,
    }
}

table! {
    /// Keys that rise and fall together.
    Correlated {
        /// Two or more of them, by their names (a path where no name is given); every pair has the coefficient.
        keys: Vec<At<String>>,
        /// Correlation of the normal numbers that stand for them, between -1 and 1.
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
