//! Target of a Monte Carlo run: one metric, with the tolerance of its standard error.

use crate::result::{State, StateValues, View, ViewMetrics};

/// Tolerance of one metric in every view: the largest allowed standard error.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// The metric.
    pub metric: Metric,
    /// The state; `None`: all states for which the metric is defined. Metrics of a view have no state.
    pub state: Option<String>,
    /// The tolerance.
    pub tolerance: Tolerance,
}

/// Tolerance of a metric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Absolute, in the unit of the metric.
    Absolute(f64),
    /// Relative to the value of the metric.
    Relative(f64),
}

/// Declares the metrics by their names in a result: those of a view, and those of a state.
macro_rules! metrics {
    (together { $($together:ident),* $(,)? } state { $($state:ident),* $(,)? }) => {
        /// Metric of a result, named as there.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(missing_docs, non_camel_case_types, reason = "named and documented as the fields of a result")]
        pub enum Metric { $($together,)* $($state,)* }

        impl Metric {
            /// Returns true for metrics of a view, which combine its states.
            pub fn is_of_view(self) -> bool {
                matches!(self, $(Self::$together)|*)
            }

            /// Returns the name of the metric in a result.
            pub fn name(self) -> &'static str {
                match self { $(Self::$together => stringify!($together),)* $(Self::$state => stringify!($state),)* }
            }

            /// All metrics.
            pub const ALL: &[Self] = &[$(Self::$together,)* $(Self::$state,)*];

            /// Returns the metric of this name, if it can be a target.
            pub fn named(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|metric| metric.name() == name)
            }
        }
    };
}

metrics! {
    together {
        contrast_ratio,
        gamut_percent_srgb,
        gamut_percent_ebu,
        gamut_percent_ntsc,
        gamut_percent_dci_p3,
        coverage_percent_srgb,
        coverage_percent_ebu,
        coverage_percent_ntsc,
        coverage_percent_dci_p3,
        gamut_volume_cielab,
        average_peak_shift_nm,
        text_luminance_cd_m2,
        text_contrast,
        reading_surrogate_age_20,
        reading_surrogate_age_50,
        reading_surrogate_age_75,
        reading_surrogate,
    }
    state {
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
        R_hemi,
        u_star,
        v_star,
        delta_E_2000_from_white,
        delta_E_2000_from_reference,
        distance_from_reference_uv,
        peak_shift_nm,
    }
}

impl Metric {
    fn among(self, mut named: impl Iterator<Item = (&'static str, Option<f64>)>) -> Option<f64> {
        named.find(|(name, _)| *name == self.name())?.1
    }

    /// Returns the value of a metric of a view; `None` for metrics of a state.
    pub(crate) fn of_view(self, metrics: &ViewMetrics) -> Option<f64> {
        self.among(metrics.named())
    }

    /// Returns the value of a metric of a state; `None` for metrics of a view.
    pub(crate) fn of_state(self, values: &StateValues) -> Option<f64> {
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
            Self::R_hemi => values.R_hemi,
            other => other.among(values.metrics.named()),
        }
    }
}

impl Target {
    /// Returns the largest ratio of standard error to tolerance; the target is met at 1 or less. `None` if the
    /// metric is not defined.
    pub(crate) fn missed_by(&self, view: &View) -> Option<f64> {
        let over = |[value, error]: [Option<f64>; 2]| {
            let tolerance = match self.tolerance {
                Tolerance::Absolute(error) => error,
                Tolerance::Relative(error) => error * value?.abs(),
            };
            Some(if error? == 0.0 { 0.0 } else { error? / tolerance })
        };
        if self.metric.is_of_view() {
            return over([&view.metrics, &view.standard_error].map(|metrics| self.metric.of_view(metrics)));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::StateMetrics;

    /// Every field of `ViewMetrics` and `StateMetrics` can be a target, except for those that compare views.
    #[test]
    fn every_field_of_a_result_is_a_metric() {
        let together = ViewMetrics::default();
        for (name, _) in together.named() {
            assert!(Metric::named(name).is_some_and(Metric::is_of_view), "{name}");
        }
        let comparing_views = ["delta_E_2000_with_angle", "shift_with_angle_uv"];
        for (name, _) in StateMetrics::default().named() {
            assert_eq!(Metric::named(name).is_some(), !comparing_views.contains(&name), "{name}");
        }
    }
}
