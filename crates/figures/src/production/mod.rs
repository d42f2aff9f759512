//! Figures of a tolerance analysis: distribution of metrics, sensitivities to keys, displays that pass and
//! fail.

mod histogram;
mod keys;
mod sensitivities;

pub use histogram::histogram;
pub use keys::pass_fail_scatter;
pub use sensitivities::{SensitivityBar, sensitivities};

use crate::svg::Point;

/// Colours of displays that meet the limits, and of those that do not.
const GOOD: &str = "#4c78a8";
const BAD: &str = "#c8321f";
/// The panel, px.
const PANEL: (Point, Point) = ((96.0, 24.0), (540.0, 330.0));

/// Limits of a metric.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ends {
    /// Lower limit.
    pub at_least: Option<f64>,
    /// Upper limit.
    pub at_most: Option<f64>,
}

impl Ends {
    /// Returns whether a value meets both limits; an undefined value does not.
    pub fn meets(&self, value: f64) -> bool {
        self.at_least.is_none_or(|least| value >= least) && self.at_most.is_none_or(|most| value <= most)
    }

    fn all(&self) -> impl Iterator<Item = f64> {
        self.at_least.into_iter().chain(self.at_most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_well_formed(svg: &str) {
        assert!(svg.ends_with("</svg>\n") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn unusual_data_give_well_formed_figures() {
        let ends = Ends { at_least: Some(1.0), at_most: None };
        for values in
            [vec![1.0], vec![1.0; 50], vec![f64::NAN, 2.0, 1e300], (0..500).map(f64::from).collect()]
        {
            assert_well_formed(&histogram("<Y>", &values, ends, "<t>").unwrap());
        }
        assert!(histogram("Y", &[f64::NAN], ends, "t").is_none());
        let blame = SensitivityBar { first: [-0.1, 0.3], total: [1.4, f64::NAN] };
        let groups = ["a".to_owned(), "b".to_owned()];
        assert_well_formed(
            &sensitivities(&["Y".to_owned()], &groups, &[vec![Some(blame), None]], "t").unwrap(),
        );
        assert!(sensitivities(&["Y".to_owned()], &groups, &[vec![None, None]], "t").is_none());
        // Names of keys without a group of their own are long, and whole.
        let long = "Thickness of film layer 2 (nm), thickness of film layer 4 (nm)";
        let drawn = sensitivities(&["Y".to_owned()], &[long.to_owned()], &[vec![Some(blame)]], "t").unwrap();
        assert!(drawn.contains(&format!(">{long}</text>")), "{drawn}");
        assert_well_formed(&pass_fail_scatter(
            ["a", "b"],
            &[([1.0, f64::NAN], true), ([1.0, 2.0], false)],
            "t",
        ));
    }
}
