//! Guided filter: a smooth base of a picture that follows its edges.
//!
//! **What.** In each window of the picture, its values are fitted by a line of themselves with a penalty on
//! the slope, `slope = variance / (variance + epsilon)`; the base is the mean of the lines of all windows that
//! contain a pixel. Where the values vary by much less than the root of epsilon, the base is their mean;
//! edges that are larger stay sharp, without halos.
//!
//! **Parameters.** Radius of the square windows in pixels; epsilon, the square of a difference. Windows end at
//! the borders.
//!
//! **Source.** K. He, J. Sun, X. Tang, IEEE Trans. Pattern Anal. Mach. Intell. 35, 1397 (2013), the picture
//! being its own guide.

use pulp::NullaryFnOnce;

use crate::ImagingError;
use crate::halftone::check_rows;

/// The base of a picture of single numbers; not finite ones count as 0. The result does not depend on the number of threads, of
/// which two are used.
///
/// # Errors
/// If the number of pixels is not a multiple of `columns`.
pub fn guided(
    values: &[f32],
    columns: usize,
    (radius, epsilon): (usize, f64),
    threads: usize,
) -> Result<Vec<f32>, ImagingError> {
    check_rows(values.len(), columns)?;
    let finite = |value: &f32| if value.is_finite() { *value } else { 0.0 };
    // Sums have double precision, planes single.
    let means = |values: Vec<f32>| means_of(values, columns, radius, |mean| mean as f32);
    let (mut offset, mut slope) = both(
        threads,
        || means(values.iter().map(finite).collect()),
        || means(values.iter().map(|value| finite(value) * finite(value)).collect()),
    );
    for (slope, mean) in slope.iter_mut().zip(&mut offset) {
        let variance = (f64::from(*slope) - f64::from(*mean) * f64::from(*mean)).max(0.0);
        *slope = if variance > 0.0 { (variance / (variance + epsilon)) as f32 } else { 0.0 };
        *mean *= 1.0 - *slope;
    }
    let (mut base, slope) = both(threads, || means(offset), || means(slope));
    for ((base, slope), value) in base.iter_mut().zip(slope).zip(values) {
        *base += slope * finite(value);
    }
    Ok(base)
}

/// The results of two functions, at the same time if there are several threads.
fn both<T: Send>(threads: usize, one: impl FnOnce() -> T, other: impl FnOnce() -> T + Send) -> (T, T) {
    if threads < 2 {
        return (one(), other());
    }
    std::thread::scope(|scope| {
        let other = scope.spawn(other);
        (one(), other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

/// Mean of the values in the square window about each pixel, which ends at the borders; of whole rows.
pub fn window_means(values: Vec<f64>, columns: usize, radius: usize) -> Vec<f64> {
    means_of(values, columns, radius, |mean| mean)
}

/// The same of numbers of any precision.
fn means_of<T: Copy + Into<f64>, R: Fn(f64) -> T>(
    values: Vec<T>,
    columns: usize,
    radius: usize,
    rounded: R,
) -> Vec<T> {
    pulp::Arch::new().dispatch(Means { values, columns, radius, rounded })
}

struct Means<T, R> {
    values: Vec<T>,
    columns: usize,
    radius: usize,
    rounded: R,
}

/// Rows whose sums are computed at once: those of one would wait for each other.
const AT_ONCE: usize = 4;

impl<T: Copy + Into<f64>, R: Fn(f64) -> T> NullaryFnOnce for Means<T, R> {
    type Output = Vec<T>;

    #[inline(always)]
    fn call(self) -> Vec<T> {
        let Self { mut values, columns, radius, rounded } = self;
        // A window beyond all borders is the whole picture.
        let radius = radius.min(values.len());
        let mut sums = [0; AT_ONCE].map(|_| vec![0.0; columns + 1]);
        for rows in values.chunks_mut(AT_ONCE * columns) {
            let count = rows.len() / columns;
            let mut totals = [0.0; AT_ONCE];
            for x in 0..columns {
                for (row, total) in totals.iter_mut().enumerate().take(count) {
                    *total += rows[row * columns + x].into();
                    sums[row][x + 1] = *total;
                }
            }
            for (row, sums) in rows.chunks_exact_mut(columns).zip(&sums) {
                let inside = radius.min(columns)..columns.saturating_sub(radius).max(radius.min(columns));
                let mean = |x: usize| {
                    let (first, end) = (x.saturating_sub(radius), (x + radius + 1).min(columns));
                    rounded((sums[end] - sums[first]) / (end - first) as f64)
                };
                (0..inside.start).chain(inside.end..columns).for_each(|x| row[x] = mean(x));
                let count = (2 * radius + 1) as f64;
                let ends = sums.get(2 * radius + 1..).unwrap_or(&[]).iter().zip(sums);
                for (value, (end, first)) in row[inside].iter_mut().zip(ends) {
                    *value = rounded((end - first) / count);
                }
            }
        }
        // Down the columns, the sum of the rows in the window: one row enters and one leaves, which is kept until then.
        let rows = values.len() / columns;
        let count_of_kept = (radius + 1).min(rows);
        let mut kept = values[..count_of_kept * columns].to_vec();
        let [sums, ..] = &mut sums;
        let sums = &mut sums[..columns];
        sums.fill(0.0);
        let mut entered = 0;
        for y in 0..rows {
            while entered < (y + radius + 1).min(rows) {
                let entering = &values[entered * columns..][..columns];
                sums.iter_mut().zip(entering).for_each(|(sum, value)| *sum += (*value).into());
                entered += 1;
            }
            let kept = &mut kept[y % count_of_kept * columns..][..columns];
            if y > radius {
                sums.iter_mut().zip(&*kept).for_each(|(sum, value)| *sum -= (*value).into());
            }
            let row = &mut values[y * columns..][..columns];
            kept.copy_from_slice(row);
            let count = (entered - y.saturating_sub(radius)) as f64;
            row.iter_mut().zip(&*sums).for_each(|(value, sum)| *value = rounded(sum / count));
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use papilio_testing::Dice;

    use super::*;

    /// The filter by its definition: sums over windows.
    fn defined(values: &[f32], columns: usize, radius: usize, epsilon: f64) -> Vec<f64> {
        let rows = values.len() / columns;
        let window = |at: usize| {
            let (x, y) = (at % columns, at / columns);
            let down = y.saturating_sub(radius)..(y + radius + 1).min(rows);
            let along = x.saturating_sub(radius)..(x + radius + 1).min(columns);
            down.flat_map(move |y| along.clone().map(move |x| y * columns + x)).collect::<Vec<_>>()
        };
        let mean = |of: &dyn Fn(usize) -> f64, at| {
            let window = window(at);
            window.iter().map(|at| of(*at)).sum::<f64>() / window.len() as f64
        };
        let value = |at: usize| f64::from(values[at]);
        let line = |at: usize| {
            let middle = mean(&value, at);
            let variance = mean(&|k| (value(k) - middle).powi(2), at);
            let slope = variance / (variance + epsilon);
            [slope, (1.0 - slope) * middle]
        };
        (0..values.len())
            .map(|at| mean(&|k| line(k)[0], at) * value(at) + mean(&|k| line(k)[1], at))
            .collect()
    }

    #[test]
    fn guided_filter_is_that_of_its_definition() {
        let mut dice = Dice::new(3, 0);
        for (columns, rows, radius) in [(11, 8, 2), (5, 7, 9), (1, 6, 1)] {
            let values: Vec<f32> = (0..columns * rows).map(|_| dice.throw() as f32).collect();
            let found = guided(&values, columns, (radius, 0.02), 1).unwrap();
            assert_eq!(guided(&values, columns, (radius, 0.02), 2).unwrap(), found);
            for (ours, theirs) in found.iter().zip(defined(&values, columns, radius, 0.02)) {
                assert!((f64::from(*ours) - theirs).abs() < 1e-6, "{columns} {radius}: {ours} {theirs}");
            }
        }
    }

    #[test]
    fn guided_filter_keeps_edges_and_smooths_what_is_small() {
        let step = |k: usize| if k % 64 < 32 { 0.1_f32 } else { 0.9 };
        let values: Vec<f32> = (0..64 * 64).map(|k| step(k) + 0.02 * ((k % 2) as f32 - 0.5)).collect();
        let found = guided(&values, 64, (4, 0.01), 2).unwrap();
        let (at, away) = (20 * 64 + 31, 20 * 64 + 8);
        assert!((found[at] - 0.1).abs() < 0.04 && (found[at + 1] - 0.9).abs() < 0.04, "{found:?}");
        assert!((found[away] - found[away + 1]).abs() < 1e-3);
        assert!(guided(&values, 0, (4, 0.01), 1).is_err());
    }
}
