//! Discretisation errors of the rows of a table, and the check that they are within the limit.

use crate::DisplayError;
use crate::run::largest;

/// Relative errors of the rows of a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RowErrors {
    /// Discretisation error of the Y of each row, relative to this Y.
    pub relative: Vec<f64>,
    /// Target of the scenario: the limit of all rows unless a larger error is allowed.
    pub target: f64,
    /// Allowed error, if it was set: the table is then written with its errors.
    pub allowed: Option<f64>,
}

/// Number of rows that an error message names.
const NAMED: usize = 3;

impl RowErrors {
    /// Keeps the rows of some of `states` states, which have equal numbers of consecutive rows; returns the
    /// largest error that is left.
    pub(crate) fn keep_states(&mut self, numbers: &[usize], states: usize) -> f64 {
        let rows = (self.relative.len() / states.max(1)).max(1);
        let of_states = self.relative.chunks(rows).enumerate().filter(|(k, _)| numbers.contains(k));
        self.relative = of_states.flat_map(|(_, rows)| rows.iter().copied()).collect();
        self.relative.iter().copied().fold(0.0, largest)
    }

    /// Checks all rows against the allowed error, or the target if none is given; `name` describes a row.
    ///
    /// # Errors
    /// If the error of a row is larger than the limit.
    pub fn allow(
        self,
        allowed: Option<f64>,
        table: &'static str,
        name: impl Fn(usize) -> String,
    ) -> Result<Self, DisplayError> {
        let most = allowed.unwrap_or(self.target);
        // NaN is never within the limit.
        let beyond = |error: &f64| error.is_nan() || *error > most;
        let mut rows: Vec<usize> =
            (0..self.relative.len()).filter(|row| beyond(&self.relative[*row])).collect();
        if rows.is_empty() {
            return Ok(Self { allowed, ..self });
        }
        let count = rows.len();
        rows.sort_by(|a, b| self.relative[*b].total_cmp(&self.relative[*a]));
        let worst = self.relative[rows[0]];
        let named: Vec<String> = rows
            .iter()
            .take(NAMED)
            .map(|row| format!("{} ({:.2e})", name(*row), self.relative[*row]))
            .collect();
        Err(DisplayError::RowsTooUncertain {
            table,
            count,
            of: self.relative.len(),
            most,
            named: named.join("; "),
            more: if count > NAMED { "; ..." } else { "" },
            enough: rounded_up(worst),
        })
    }
}

/// Rounds up to two significant digits.
fn rounded_up(error: f64) -> f64 {
    if !(error.is_finite() && error > 0.0) {
        return error;
    }
    let unit = 10.0_f64.powi(error.log10().floor() as i32 - 1);
    // Formatting and parsing removes digits that come from rounding.
    format!("{:.1e}", (error / unit).ceil() * unit).parse().unwrap_or(error)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test")]

    use super::*;

    fn errors() -> RowErrors {
        RowErrors { relative: vec![1e-4, 0.0312, 2e-3, 5e-4], target: 1e-3, allowed: None }
    }

    #[test]
    fn rows_above_the_target_are_named_in_order_of_their_error() {
        let refused = errors().allow(None, "cone", |row| format!("row {row}")).unwrap_err().to_string();
        assert!(refused.contains("2 of 4 rows of the cone"), "{refused}");
        assert!(refused.contains("row 1 (3.12e-2); row 2 (2.00e-3)"), "{refused}");
        assert!(refused.contains("an allowed error of 0.032"), "{refused}");
    }

    #[test]
    fn error_proposed_by_the_message_is_accepted() {
        let allowed = errors().allow(Some(0.032), "cone", |_| String::new()).unwrap();
        assert_eq!(allowed.allowed, Some(0.032));
        assert!(errors().allow(Some(0.03), "cone", |_| String::new()).is_err());
        let unknown = RowErrors { relative: vec![f64::NAN], ..errors() };
        assert!(unknown.allow(Some(1.0), "cone", |_| String::new()).is_err());
    }
}
