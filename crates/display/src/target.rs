//! A metric that a run is to know to within a tolerance.

use crate::result::{State, StateValues, View};

/// A tolerance of one metric, at every view: one standard error is to be at most this.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// What is to be known.
    pub metric: Metric,
    /// Of which state; `None`: of all that have it. Metrics of the states together know none.
    pub state: Option<String>,
    /// How well.
    pub tolerance: Tolerance,
}

/// How well a metric is to be known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// In the metric's own unit.
    Absolute(f64),
    /// As a part of its value.
    Relative(f64),
}

/// Metrics of a result, by their names there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, non_camel_case_types, reason = "named as the fields of a result, and explained there")]
pub enum Metric {
    contrast_ratio,
    gamut_percent_srgb,
    gamut_percent_ebu,
    X,
    Y,
    Z,
    x,
    y,
    u_prime,
    v_prime,
    L_star,
    a_star,
    b_star,
    luminance_cd_m2,
    contrast,
    peak_nm,
    distance_from_white_uv,
    distance_from_d65_uv,
}

impl Metric {
    /// True if it is of the states together.
    pub fn is_of_view(self) -> bool {
        matches!(self, Self::contrast_ratio | Self::gamut_percent_srgb | Self::gamut_percent_ebu)
    }

    fn of_view(self, view: &View) -> [Option<f64>; 2] {
        [&view.metrics, &view.standard_error].map(|metrics| match self {
            Self::contrast_ratio => metrics.contrast_ratio,
            Self::gamut_percent_srgb => metrics.gamut_percent_srgb,
            _ => metrics.gamut_percent_ebu,
        })
    }

    fn of_state(self, values: &StateValues) -> Option<f64> {
        match self {
            Self::X => Some(values.X),
            Self::Y => Some(values.Y),
            Self::Z => Some(values.Z),
            Self::x => values.x,
            Self::y => values.y,
            Self::u_prime => values.u_prime,
            Self::v_prime => values.v_prime,
            Self::L_star => values.L_star,
            Self::a_star => values.a_star,
            Self::b_star => values.b_star,
            Self::luminance_cd_m2 => Some(values.luminance_cd_m2),
            Self::contrast => values.contrast,
            Self::peak_nm => values.peak_nm,
            Self::distance_from_white_uv => values.distance_from_white_uv,
            Self::distance_from_d65_uv => values.distance_from_d65_uv,
            Self::contrast_ratio | Self::gamut_percent_srgb | Self::gamut_percent_ebu => None,
        }
    }
}

impl Target {
    /// The largest standard error over the tolerance: 1 and less is good. `None` where the metric is not
    /// defined at all.
    pub(crate) fn missed_by(&self, view: &View) -> Option<f64> {
        let over = |[value, error]: [Option<f64>; 2]| {
            let tolerance = match self.tolerance {
                Tolerance::Absolute(error) => error,
                Tolerance::Relative(error) => error * value?.abs(),
            };
            Some(if error? == 0.0 { 0.0 } else { error? / tolerance })
        };
        if self.metric.is_of_view() {
            return over(self.metric.of_view(view));
        }
        let of = |state: &State| {
            over([self.metric.of_state(&state.value), self.metric.of_state(&state.standard_error)])
        };
        let wanted = |name: &str| self.state.as_deref().is_none_or(|state| state == name);
        let states = view.states.iter().filter(|(name, _)| wanted(name));
        let all = states.filter_map(|(_, state)| of(state));
        all.reduce(f64::max)
    }
}
