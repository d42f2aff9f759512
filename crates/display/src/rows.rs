//! The errors of a table's rows, and whether the table may be handed on with them.

use crate::DisplayError;

/// How good the rows of a table are.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RowErrors {
    /// The relative discretisation error of each row's Y, of its own value.
    pub relative: Vec<f64>,
    /// The scenario's target, which no row may miss unless that is allowed.
    pub target: f64,
    /// What was allowed instead, if it was: the table is then written with its errors.
    pub allowed: Option<f64>,
}

/// So many rows are named in a refusal.
const NAMED: usize = 3;

impl RowErrors {
    /// The same with this error allowed.
    ///
    /// # Errors
    /// If a row's error is larger than what is allowed, or than the target if nothing is; `name` says which row
    /// a number is.
    pub fn allow(
        self,
        allowed: Option<f64>,
        table: &'static str,
        name: impl Fn(usize) -> String,
    ) -> Result<Self, DisplayError> {
        let most = allowed.unwrap_or(self.target);
        // What is not a number is not within.
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

/// Two digits that are no less.
fn rounded_up(error: f64) -> f64 {
    if !(error.is_finite() && error > 0.0) {
        return error;
    }
    let unit = 10.0_f64.powi(error.log10().floor() as i32 - 1);
    // Printed with its own digits alone.
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
    fn rows_beyond_the_target_are_named_the_worst_first() {
        let refused = errors().allow(None, "cone", |row| format!("row {row}")).unwrap_err().to_string();
        assert!(refused.contains("2 of 4 rows of the cone"), "{refused}");
        assert!(refused.contains("row 1 (3.12e-2); row 2 (2.00e-3)"), "{refused}");
        assert!(refused.contains("--allow-error 0.032"), "{refused}");
    }

    #[test]
    fn what_is_allowed_is_what_the_message_says() {
        let allowed = errors().allow(Some(0.032), "cone", |_| String::new()).unwrap();
        assert_eq!(allowed.allowed, Some(0.032));
        assert!(errors().allow(Some(0.03), "cone", |_| String::new()).is_err());
        let unknown = RowErrors { relative: vec![f64::NAN], ..errors() };
        assert!(unknown.allow(Some(1.0), "cone", |_| String::new()).is_err());
    }
}
