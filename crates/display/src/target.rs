//! A metric that a run is to know to within a tolerance.

use crate::result::{State, StateValues, View, ViewMetrics};

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

/// Declares the metrics by their names in a result: those of the states together, and those of a state.
macro_rules! metrics {
    (together { $($together:ident),* $(,)? } state { $($state:ident),* $(,)? }) => {
        /// Metrics of a result, by their names there.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(missing_docs, non_camel_case_types, reason = "named as the fields of a result, and explained there")]
        pub enum Metric { $($together,)* $($state,)* }

        impl Metric {
            /// True if it is of the states together.
            pub fn is_of_view(self) -> bool {
                matches!(self, $(Self::$together)|*)
            }

            /// Its name in a result.
            pub fn name(self) -> &'static str {
                match self { $(Self::$together => stringify!($together),)* $(Self::$state => stringify!($state),)* }
            }

            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$together,)* $(Self::$state,)*];

            /// The metric of this name, if it can be a target.
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

    /// Of the states together; `None` if it is of a state.
    pub(crate) fn of_view(self, metrics: &ViewMetrics) -> Option<f64> {
        self.among(metrics.named())
    }

    /// Of a state; `None` if it is of the states together.
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

    /// Every metric is a number of a result: what the names find is there.
    #[test]
    fn every_name_is_a_number_of_a_result() {
        let together = ViewMetrics::default();
        for (name, _) in together.named() {
            assert!(Metric::named(name).is_some_and(Metric::is_of_view), "{name}");
        }
        let of_views = ["delta_E_2000_with_angle", "shift_with_angle_uv"];
        for (name, _) in StateMetrics::default().named() {
            assert_eq!(Metric::named(name).is_some(), !of_views.contains(&name), "{name}");
        }
    }
}
