//! Pictures in another size, in linear light.
//!
//! Every pixel of the result is a mean of the source with the weights of a triangle, whose half width is a
//! pixel of the result or of the source, whichever is larger: no detail is skipped, and enlarged pictures are
//! interpolated linearly.

use std::collections::VecDeque;

/// How a picture is fitted to a panel with other proportions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Fit {
    /// The whole picture, with a margin at two sides.
    #[default]
    Contain,
    /// The whole panel; the picture is cut at two sides.
    Cover,
    /// The whole picture on the whole panel, distorted.
    Stretch,
    /// Pixel by pixel, cut or with margins; the middles coincide.
    None,
}

/// Fits a picture of `from` = columns and rows, which `row` returns from the top, to `to`; `margin` is the
/// colour beyond the picture.
///
/// Each row is requested once, in order, so that a large picture needs no more memory than the result and one
/// of its rows times the rows that a row of the result is the mean of. Empty if one of the sizes is 0, or a
/// row has another number of pixels.
pub fn fitted(
    from: [usize; 2],
    mut row: impl FnMut(usize) -> Vec<[f32; 3]>,
    to: [usize; 2],
    fit: Fit,
    margin: [f32; 3],
) -> Vec<[f32; 3]> {
    if from.contains(&0) || to.contains(&0) {
        return Vec::new();
    }
    if from == to {
        let mut whole = Vec::with_capacity(from[0] * from[1]);
        (0..from[1]).for_each(|y| whole.extend(row(y)));
        return if whole.len() == from[0] * from[1] { whole } else { Vec::new() };
    }
    let ratio = [0, 1].map(|k| to[k] as f64 / from[k] as f64);
    let scale = match fit {
        Fit::Contain => [ratio[0].min(ratio[1]); 2],
        Fit::Cover => [ratio[0].max(ratio[1]); 2],
        Fit::Stretch => ratio,
        Fit::None => [1.0; 2],
    };
    let weights =
        |k: usize| (0..to[k]).map(move |at| Weights::new(at, to[k], from[k], scale[k])).collect::<Vec<_>>();
    let [across, down] = [weights(0), weights(1)];
    // Rows of the source with the columns of the result; those above the first that is still needed are
    // dropped.
    let mut wide: VecDeque<Vec<[f32; 3]>> = VecDeque::new();
    let mut next = 0;
    let mut result = Vec::with_capacity(to[0] * to[1]);
    for rows in &down {
        while next < rows.first + rows.weights.len() {
            let line = row(next);
            if line.len() != from[0] {
                return Vec::new();
            }
            wide.push_back(across.iter().map(|weights| weights.mean(|at| line[at])).collect());
            next += 1;
        }
        let first = next - wide.len();
        wide.drain(..rows.first.saturating_sub(first).min(wide.len()));
        let start = result.len();
        if rows.is_outside {
            result.resize(start + to[0], margin);
            continue;
        }
        result.resize(start + to[0], [0.0; 3]);
        let into = &mut result[start..];
        let first = next - wide.len();
        for (line, weight) in wide.range(rows.first - first..).zip(&rows.weights) {
            let values = into.as_flattened_mut().iter_mut().zip(line.as_flattened());
            values.for_each(|(sum, value)| *sum += weight * value);
        }
        let outside = into.iter_mut().zip(&across).filter(|(_, columns)| columns.is_outside);
        outside.for_each(|(pixel, _)| *pixel = margin);
    }
    result
}

/// Weights of neighbouring pixels of the source for one pixel of the result.
struct Weights {
    first: usize,
    weights: Vec<f32>,
    /// Whether the pixel lies beyond the picture.
    is_outside: bool,
}

impl Weights {
    fn new(at: usize, to: usize, from: usize, scale: f64) -> Self {
        // The place in the source, in pixels from its first edge.
        let place = (at as f64 + 0.5 - 0.5 * to as f64) / scale + 0.5 * from as f64;
        let half = (1.0 / scale).max(1.0);
        let last = from as f64 - 1.0;
        let [first, end] =
            [place - half, place + half].map(|edge| (edge - 0.5).round().clamp(0.0, last) as usize);
        let weight = |pixel: usize| (1.0 - (pixel as f64 + 0.5 - place).abs() / half).max(0.0);
        let mut weights: Vec<f64> = (first..=end).map(weight).collect();
        let mut sum: f64 = weights.iter().sum();
        if sum <= 0.0 {
            // At the outermost half pixel.
            weights.fill(1.0);
            sum = weights.len() as f64;
        }
        let weights = weights.into_iter().map(|weight| (weight / sum) as f32).collect();
        Self { first, weights, is_outside: !(0.0..=from as f64).contains(&place) }
    }

    fn mean(&self, pixel: impl Fn(usize) -> [f32; 3]) -> [f32; 3] {
        self.weights.iter().enumerate().fold([0.0; 3], |sum, (i, weight)| {
            let [a, b, c] = pixel(self.first + i);
            [sum[0] + weight * a, sum[1] + weight * b, sum[2] + weight * c]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Vec<[f32; 3]> {
        values.iter().map(|value| [*value; 3]).collect()
    }

    /// Fits rows of `columns`.
    fn fit_all(
        pixels: &[[f32; 3]],
        columns: usize,
        to: [usize; 2],
        fit: Fit,
        margin: [f32; 3],
    ) -> Vec<[f32; 3]> {
        let from = [columns, pixels.len() / columns];
        fitted(from, |row| pixels[row * columns..][..columns].to_vec(), to, fit, margin)
    }

    #[test]
    fn uniform_pictures_stay_uniform_in_all_sizes() {
        for to in [[1, 1], [3, 2], [7, 31], [40, 9]] {
            for fit in [Fit::Contain, Fit::Cover, Fit::Stretch, Fit::None] {
                let found = fit_all(&grey(&[0.3; 60]), 10, to, fit, [0.3; 3]);
                assert_eq!(found.len(), to[0] * to[1]);
                assert!(found.iter().flatten().all(|value| (value - 0.3).abs() < 1e-6), "{to:?} {fit:?}");
            }
        }
    }

    /// A wide picture on a square panel: margins above and below, or cut left and right.
    #[test]
    fn proportions_are_kept_by_margins_or_cuts() {
        let source = grey(&[0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0]);
        let contained = fit_all(&source, 4, [4, 4], Fit::Contain, [0.5; 3]);
        assert_eq!(
            (contained[0], contained[4], contained[7], contained[15]),
            ([0.5; 3], [0.0; 3], [1.0; 3], [0.5; 3])
        );
        let covered = fit_all(&source, 4, [4, 4], Fit::Cover, [0.5; 3]);
        assert!(covered.iter().all(|pixel| (pixel[0] - 0.5).abs() > 0.1), "{covered:?}");
        assert!(covered[0][0] < 0.3 && covered[3][0] > 0.7, "{covered:?}");
    }

    /// Halving a checkerboard gives its mean, in linear light, apart from the borders.
    #[test]
    fn smaller_pictures_are_means() {
        let board: Vec<f32> = (0..256).map(|at| ((at % 16 + at / 16) % 2) as f32).collect();
        let small = fit_all(&grey(&board), 16, [8, 8], Fit::Stretch, [0.0; 3]);
        assert!(small.iter().flatten().all(|value| (value - 0.5).abs() < 0.1), "{small:?}");
        assert!((small[27][0] - 0.5).abs() < 1e-6);
    }

    #[test]
    fn impossible_sizes_are_empty() {
        let row = |_| grey(&[0.1; 2]);
        assert!(fitted([0, 2], row, [2, 2], Fit::Contain, [0.0; 3]).is_empty());
        assert!(fitted([3, 2], row, [4, 2], Fit::Contain, [0.0; 3]).is_empty());
        assert!(fitted([3, 2], row, [3, 2], Fit::Contain, [0.0; 3]).is_empty());
        assert!(fitted([2, 2], row, [0, 2], Fit::Contain, [0.0; 3]).is_empty());
    }
}
