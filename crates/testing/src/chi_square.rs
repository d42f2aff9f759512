//! Chi-square test of counts in cells.

/// Chi-square statistic of counts against their expectations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChiSquare {
    /// Sum of squared deviations, each divided by its variance.
    pub statistic: f64,
    /// Degrees of freedom.
    pub freedom: f64,
}

impl ChiSquare {
    /// Statistic of cells (count, expectation) with equal sums of counts and expectations. The smallest cells
    /// are merged until each expects at least `fewest` counts. A count in a cell of expectation 0 gives an
    /// infinite statistic.
    pub fn of(cells: impl IntoIterator<Item = (f64, f64)>, fewest: f64) -> Self {
        let mut cells: Vec<(f64, f64)> = cells.into_iter().collect();
        cells.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (mut statistic, mut count, mut small) = (0.0, 0.0, (0.0, 0.0));
        for (found, expected) in cells {
            if expected <= 0.0 && found > 0.0 {
                return Self { statistic: f64::INFINITY, freedom: 1.0 };
            }
            small = (small.0 + found, small.1 + expected);
            if small.1 >= fewest && small.1 > 0.0 {
                statistic += (small.0 - small.1).powi(2) / small.1;
                count += 1.0;
                small = (0.0, 0.0);
            }
        }
        Self { statistic, freedom: count - 1.0 }
    }

    /// Statistic of cells with equal expectations.
    pub fn uniform(counts: &[f64]) -> Self {
        let expected = counts.iter().sum::<f64>() / counts.len() as f64;
        Self::of(counts.iter().map(|found| (*found, expected)), 0.0)
    }

    /// The statistic converted to a standard normal variable (Wilson and Hilferty, PNAS 17, 684 (1931)).
    pub fn z(&self) -> f64 {
        let spread = 2.0 / (9.0 * self.freedom);
        ((self.statistic / self.freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
    }

    /// Returns false if deviations as large as these, or larger, have a probability of 1e-4 or less.
    pub fn is_likely(&self) -> bool {
        self.z() < 3.719
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Upper quantiles at 1e-4, from the inverse of the incomplete gamma function.
    #[test]
    fn z_of_published_quantiles_is_3_719() {
        for (freedom, quantile) in [(8.0, 31.8276), (15.0, 44.2632), (31.0, 69.1057), (255.0, 347.6542)] {
            let z = ChiSquare { statistic: quantile, freedom }.z();
            assert!((z - 3.719).abs() < 0.05, "{freedom}: {z}");
        }
    }

    #[test]
    fn small_cells_are_merged_and_impossible_counts_are_unlikely() {
        let cells = [(3.0, 4.0), (2.0, 3.0), (12.0, 10.0), (4.0, 4.0), (0.0, 0.0)];
        // 3 + 4 + 4 expect 11, of which 9 are found.
        let found = ChiSquare::of(cells, 10.0);
        assert_eq!(found.freedom, 1.0);
        assert!((found.statistic - (4.0 / 11.0 + 4.0 / 10.0)).abs() < 1e-12, "{found:?}");
        assert!(found.is_likely());
        assert!(!ChiSquare::of([(10.0, 11.0), (1.0, 0.0)], 5.0).is_likely());
        assert_eq!(ChiSquare::uniform(&[9.0, 11.0]), ChiSquare { statistic: 0.2, freedom: 1.0 });
    }
}
