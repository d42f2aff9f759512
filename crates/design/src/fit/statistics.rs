//! Statistics of residuals.

use std::f64::consts::FRAC_PI_2;

use papilio_sampling::erfc;

use super::model::{Model, Unit};
use super::report::Runs;

/// Degrees of freedom below which the quantile of Student's t is that of its integral.
const FEW: f64 = 5.0;
/// Intervals of the integral, and bisections of its end.
const STEPS: usize = 256;
const BISECTIONS: usize = 60;

/// Quantile of Student's t whose two-sided probability is that of the normal quantile `z`, for 1 or more degrees of freedom:
/// expansion about it (Abramowitz and Stegun 26.7.5); for few, from the integral of its density.
pub(super) fn student(z: f64, freedom: f64) -> f64 {
    if freedom < FEW {
        return student_of_few(z, freedom);
    }
    let z2 = z * z;
    let terms = [
        z * (z2 + 1.0) / 4.0,
        z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0,
        z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0,
    ];
    z + (terms[0] + (terms[1] + terms[2] / freedom) / freedom) / freedom
}

/// The same for few degrees of freedom v: with `t = sqrt(v) tan a`, the density is proportional to `cos(a)^(v - 1)`.
fn student_of_few(z: f64, freedom: f64) -> f64 {
    let integral = |end: f64| {
        let step = end / STEPS as f64;
        let at = |k: usize| (k as f64 * step).cos().max(0.0).powf(freedom - 1.0);
        // Simpson's rule.
        (0..=STEPS)
            .map(|k| at(k) * if k == 0 || k == STEPS { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 })
            .sum::<f64>()
            * step
            / 3.0
    };
    let wanted = (1.0 - erfc(z / 2_f64.sqrt())) * integral(FRAC_PI_2);
    let (mut from, mut to) = (0.0, FRAC_PI_2);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (from + to);
        if integral(middle) < wanted { from = middle } else { to = middle }
    }
    freedom.sqrt() * from.tan()
}

/// Change of each variable with each residual, `[variable][residual]`: `C J^T`, from the Jacobian (column by
/// column) and the covariance of the variables (row by row).
fn influences(jacobian: &[Vec<f64>], covariance: &[f64]) -> Vec<Vec<f64>> {
    let residuals = jacobian.first().map_or(0, Vec::len);
    let of = |row: &[f64], residual: usize| {
        row.iter().zip(jacobian).map(|(c, column)| c * column[residual]).sum::<f64>()
    };
    let rows = covariance.chunks_exact(jacobian.len().max(1));
    rows.map(|row| (0..residuals).map(|residual| of(row, residual)).collect()).collect()
}

/// Leverage of each residual, the diagonal of `J C J^T`: the part of a degree of freedom that it loses to the
/// variables.
pub(super) fn leverages(jacobian: &[Vec<f64>], covariance: &[f64]) -> Vec<f64> {
    let influences = influences(jacobian, covariance);
    let residuals = jacobian.first().map_or(0, Vec::len);
    let of = |residual: usize| influences.iter().zip(jacobian).map(|(a, j)| a[residual] * j[residual]).sum();
    (0..residuals).map(of).collect()
}

/// How well the standard error of a variable is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Freedom {
    /// Degrees of freedom: infinite for a variable that only residuals of known standard deviation determine.
    pub(super) degrees: f64,
    /// Factor of the standard error, because the weights of both groups of residuals follow from an estimate.
    pub(super) widening: f64,
}

impl Freedom {
    /// Quantile whose two-sided probability is that of the normal quantile `z`, in standard errors.
    pub(super) fn quantile(self, z: f64) -> f64 {
        self.widening * student(z, self.degrees.max(1.0))
    }
}

/// Freedom of each variable's standard error, if the standard
/// deviation of the residuals that `is_estimated` names follows from themselves, and those of the others are
/// known.
///
/// With the share u of the estimated residuals in the variance C of a variable, and v degrees of freedom of their standard deviation,
/// the variance has `v / u^2` (Welch 1947, Satterthwaite 1946). Weights that differ from the true ones increase the true variance by
/// `2 u (1 - u) C / v`, and C is too small by as much: M. G. Kenward and J. H. Roger, Biometrics 53, 983 (1997).
pub(super) fn freedom(
    jacobian: &[Vec<f64>],
    covariance: &[f64],
    is_estimated: impl Fn(usize) -> bool,
) -> Vec<Freedom> {
    let leverages = leverages(jacobian, covariance);
    let estimated = leverages.iter().enumerate().filter(|(residual, _)| is_estimated(*residual));
    let all: f64 = estimated.map(|(_, leverage)| 1.0 - leverage).sum();
    let of = |influences: &Vec<f64>| {
        let squares = || influences.iter().enumerate().map(|(residual, a)| (residual, a * a));
        let own: f64 = squares().filter(|(residual, _)| is_estimated(*residual)).map(|(_, a)| a).sum();
        let share = own / squares().map(|(_, a)| a).sum::<f64>();
        let degrees = if share > 0.0 { all / (share * share) } else { f64::INFINITY };
        Freedom { degrees, widening: (1.0 + 4.0 * share * (1.0 - share) / all.max(1.0)).sqrt() }
    };
    influences(jacobian, covariance).iter().map(of).collect()
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
    use papilio_testing::Dice;

    use super::*;

    /// Four numbers of a mean, and a prior of another variable; the second prior shares in the mean.
    #[test]
    fn priors_leave_the_freedom_of_the_data() {
        let jacobian = [vec![1.0, 1.0, 1.0, 1.0, 0.0], vec![0.0, 0.0, 0.0, 0.0, 1.0]];
        let covariance = [0.25, 0.0, 0.0, 1.0];
        assert_eq!(leverages(&jacobian, &covariance), [0.25, 0.25, 0.25, 0.25, 1.0]);
        let is_estimated = |residual: usize| residual < 4;
        let of = |degrees: f64, widening: f64| Freedom { degrees, widening };
        assert_eq!(freedom(&jacobian, &covariance, is_estimated), [of(3.0, 1.0), of(f64::INFINITY, 1.0)]);
        // A prior as strong as the mean: half of the variance is from the data, which lose half a degree.
        let shared = [vec![1.0, 1.0, 1.0, 1.0, 2.0]];
        assert_eq!(freedom(&shared, &[0.125], is_estimated), [of(3.5 / 0.25, (1.0 + 1.0 / 3.5_f64).sqrt())]);
        assert_eq!(student(2.0, f64::INFINITY), 2.0);
    }

    /// A mean of few numbers without a stated deviation, and a prior: 95 % intervals contain 93 to 97 % of the means that are
    /// drawn from the prior, whether it or the numbers are stronger. Those of Satterthwaite alone contain 90.5 % in the worst case.
    #[test]
    fn intervals_of_few_numbers_and_a_prior_cover_their_probability() {
        // With 4000, the standard error of a fraction is 0.5 % at most: 90.5 % is still five of them below the bound.
        let draws = papilio_testing::sized(4000, 20_000);
        let mut dice = Dice::new(5, 0);
        let mut normal = || (-2.0 * dice.throw().ln()).sqrt() * (std::f64::consts::TAU * dice.throw()).cos();
        for (count, of_mean) in
            [(2, 0.3), (2, 0.5), (2, 1.0), (3, 0.5), (3, 1.0), (4, 0.5), (4, 1.0), (4, 3.0)]
        {
            let prior = of_mean / f64::sqrt(count as f64);
            let mut inside = 0;
            for _ in 0..draws {
                let truth = prior * normal();
                let data: Vec<f64> = (0..count).map(|_| truth + normal()).collect();
                let mean = data.iter().sum::<f64>() / count as f64;
                let (mut deviation, mut found, mut precision) = (1.0, mean, 1.0);
                for _ in 0..60 {
                    let of_data = count as f64 / f64::powi(deviation, 2);
                    precision = of_data + prior.powi(-2);
                    found = mean * of_data / precision;
                    let squares = data.iter().map(|one| (one - found).powi(2)).sum::<f64>();
                    let free = f64::max(count as f64 - of_data / precision, 1.0);
                    deviation = (0.5 * (deviation * deviation + squares / free)).sqrt().max(1e-6);
                }
                let mut row = vec![1.0 / deviation; count];
                row.push(1.0 / prior);
                let of = freedom(&[row], &[1.0 / precision], |residual| residual < count)[0];
                inside += u32::from((found - truth).abs() < of.quantile(1.959_964) / precision.sqrt());
            }
            let covered = f64::from(inside) / f64::from(draws);
            assert!((0.93..0.97).contains(&covered), "{count} numbers, prior {of_mean}: {covered}");
        }
    }

    #[test]
    fn student_quantiles_equal_published_values() {
        for (z, freedom, quantile) in
            [(1.959_964, 5.0, 2.5706), (1.959_964, 30.0, 2.0423), (1.0, 10.0, 1.0526), (1.0, 30.0, 1.0171)]
        {
            assert!((student(z, freedom) - quantile).abs() < 4e-3, "{z} {freedom}: {}", student(z, freedom));
        }
        for (freedom, quantile) in [(1.0, 12.706), (2.0, 4.3027), (3.0, 3.1824), (4.0, 2.7764)] {
            let found = student(1.959_963_985, freedom);
            assert!((found / quantile - 1.0).abs() < 2e-3, "{freedom}: {found}");
        }
    }
}
