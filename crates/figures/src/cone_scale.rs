//! The scale of colours of a conoscopic map. A narrow mirror image does not determine it.

use papilio_display::ConeResult;

use crate::axis::{Axis, power};
use crate::style::degrees;

/// Fraction of the directions whose values determine the scale.
const MOST: f64 = 0.995;
/// The scale covers all values unless the largest one exceeds those of most directions by this factor.
const FAR: f64 = 5.0;

/// A scale, and what lies far beyond its end.
#[derive(Debug, Clone)]
pub(crate) struct Scale {
    pub(crate) axis: Axis,
    pub(crate) beyond: Option<Beyond>,
}

/// The largest value, and its direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Beyond {
    value: f64,
    theta_deg: f64,
    phi_deg: f64,
}

impl Scale {
    /// Returns the scale of `values`, of which each direction has `each`, in the order of the views; `axis`
    /// makes an axis of those that it covers.
    pub(crate) fn of(
        result: &ConeResult,
        values: &[f64],
        each: usize,
        axis: impl Fn(&[f64]) -> Axis,
    ) -> Self {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().saturating_sub(1);
        let largest = sorted.last().copied().unwrap_or(0.0);
        let end = sorted.get((MOST * last as f64) as usize).copied().unwrap_or(0.0);
        if end <= 0.0 || largest <= FAR * end {
            return Self { axis: axis(values), beyond: None };
        }
        let clipped: Vec<f64> = values.iter().map(|value| if *value > end { end } else { *value }).collect();
        let at = values.iter().position(|value| *value == largest).unwrap_or(0) / each.max(1);
        let thetas = result.theta_deg.len().max(1);
        let direction = |angles: &[f64], at: usize| angles.get(at).copied().unwrap_or(0.0);
        let beyond = Beyond {
            value: largest,
            theta_deg: direction(&result.theta_deg, at % thetas),
            phi_deg: direction(&result.phi_deg, at / thetas),
        };
        Self { axis: axis(&clipped), beyond: Some(beyond) }
    }
}

impl Beyond {
    /// Returns the value in words: `up to 4.2×10⁷`.
    pub(crate) fn up_to(&self) -> String {
        let value = self.value;
        match value {
            1e4.. => format!("up to {}", power(value, 1)),
            100.0.. => format!("up to {value:.0}"),
            _ => format!("up to {value:.2}"),
        }
    }

    /// Returns the direction in words.
    pub(crate) fn place(&self) -> String {
        format!("at {}, azimuth {}", degrees(self.theta_deg), degrees(self.phi_deg))
    }
}
