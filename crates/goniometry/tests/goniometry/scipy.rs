//! Comparison of fits with SciPy 1.17.1: `least_squares(method="trf")` with bounds
//! (`validation/fits/fit_oracle.py` makes the tables).

use papilio_goniometry::{Data, Fit, FitOptions, Kind};
use papilio_optics::Beta;

fn rows(table: &str) -> impl Iterator<Item = Vec<&str>> {
    table.lines().skip(1).map(|line| line.split(',').collect())
}

fn numbers(cells: &str) -> Vec<f64> {
    cells.split(';').map(|cell| cell.parse().unwrap()).collect()
}

#[test]
fn fits_equal_those_of_scipy() {
    let cells = rows(include_str!("../../../../validation/fits/cells.csv")).map(|row| {
        let v: Vec<f64> = row.iter().map(|cell| cell.parse().unwrap()).collect();
        ([Beta { x: v[0], y: v[1] }, Beta { x: v[2], y: v[3] }], v[4])
    });
    let data = Data::new(cells);
    let mut count = 0;
    for row in rows(include_str!("../../../../validation/fits/fits.csv")) {
        let kind = Kind::ALL.into_iter().find(|kind| kind.name() == row[0]).unwrap();
        let straight_width = (row[1] == "1").then_some(0.02);
        let fit = Fit::new(&data, kind, &FitOptions { straight_width, ..FitOptions::default() }).unwrap();
        let rms: f64 = row[2].parse().unwrap();
        assert!(fit.converged && (fit.rms / rms - 1.0).abs() < 1e-10, "{row:?}: {}", fit.rms);
        let [parameters, errors, quantiles] = [3, 4, 5].map(|column| numbers(row[column]));
        assert_eq!(fit.parameters.len(), parameters.len());
        let n = parameters.len();
        for (k, ours) in fit.parameters.iter().enumerate() {
            let error = fit.covariance[k * n + k].sqrt();
            // Both searches stop where the sum of squares no longer decreases. Its rounding error, 6e-15 of
            // 700 terms, hides steps of sqrt(350 * 6e-15) = 1.4e-6 standard errors.
            assert!((ours.value - parameters[k]).abs() < 2e-6 * errors[k], "{row:?} {ours:?}");
            assert!((error / errors[k] - 1.0).abs() < 1e-5, "{row:?} {k}: {error}");
            // The interval is of the value or of its logarithm; one of its ends may be that of the range.
            let [low, high] = ours.interval;
            let sides = match ours.name {
                "straight_through" | "mix" => [ours.value - low, high - ours.value],
                _ => [ours.value / low, high / ours.value].map(|ratio| ours.value * ratio.ln()),
            };
            let half = sides[0].max(sides[1]);
            let quantile = half / error;
            assert!((quantile / quantiles[k] - 1.0).abs() < 2e-3, "{row:?} {k}: {quantile}");
        }
        count += 1;
    }
    assert_eq!(count, 14);
}
