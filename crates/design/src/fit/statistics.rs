//! Statistics of residuals.

use super::model::{Model, Unit};
use super::report::Runs;

/// Quantile of Student's t whose two-sided probability is that of the normal quantile `z`: expansion about it
/// (Abramowitz and Stegun 26.7.5), for 3 or more degrees of freedom.
pub(super) fn student(z: f64, freedom: f64) -> f64 {
    let z2 = z * z;
    let terms = [
        z * (z2 + 1.0) / 4.0,
        z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0,
        z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0,
    ];
    z + (terms[0] + (terms[1] + terms[2] / freedom) / freedom) / freedom
}

/// Runs of residuals of one sign, within each series, against the number that independent errors have
/// (Wald and Wolfowitz 1940); `None` without two residuals of each sign.
pub(super) fn runs(model: &Model, residuals: &[f64]) -> Option<Runs> {
    let (mut count, mut expected, mut variance) = (0, 0.0, 0.0);
    let all: Vec<(usize, bool)> = model
        .observations
        .iter()
        .zip(residuals)
        .map(|(one, residual)| (one.series, *residual > 0.0))
        .collect();
    for series in all.chunk_by(|a, b| a.0 == b.0) {
        let above = series.iter().filter(|(_, is_above)| *is_above).count() as f64;
        let below = series.len() as f64 - above;
        if above < 2.0 || below < 2.0 {
            continue;
        }
        let (product, sum) = (2.0 * above * below, above + below);
        count += 1 + series.windows(2).filter(|pair| pair[0].1 != pair[1].1).count();
        expected += 1.0 + product / sum;
        variance += product * (product - sum) / (sum * sum * (sum - 1.0));
    }
    (variance > 0.0).then(|| Runs { count, expected, z: (count as f64 - expected) / variance.sqrt() })
}

/// Root mean square of the differences of the numbers of a unit; `None` if there is none.
pub(super) fn rms(model: &Model, differences: &[f64], unit: Unit) -> Option<f64> {
    let of_unit: Vec<f64> = model
        .observations
        .iter()
        .zip(differences)
        .filter(|(one, _)| one.unit() == unit)
        .map(|(_, difference)| difference * difference)
        .collect();
    (!of_unit.is_empty()).then(|| (of_unit.iter().sum::<f64>() / of_unit.len() as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_quantiles_equal_published_values() {
        for (z, freedom, quantile) in
            [(1.959_964, 5.0, 2.5706), (1.959_964, 30.0, 2.0423), (1.0, 10.0, 1.0526), (1.0, 30.0, 1.0171)]
        {
            assert!((student(z, freedom) - quantile).abs() < 4e-3, "{z} {freedom}: {}", student(z, freedom));
        }
    }
}
