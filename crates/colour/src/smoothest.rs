//! The smoothest reflectance spectrum of a colour.
//!
//! **What.** Many spectra have the same colour. Among those with reflectances between 0 and 1, this is the
//! one for which the sum of squared differences of z between neighbouring wavelengths is smallest, with the
//! reflectance (tanh z + 1)/2: "least hyperbolic tangent slope squared" of S. A. Burns, Color Res. Appl. 45,
//! 8 (2020). Newton's method solves for z and three Lagrange multipliers.
//!
//! **Use.** A display of which only L\*, a\*, b\* under one light are known is given such spectra, so that
//! its colours in other lights can be estimated. **Validity.** The colour is exact in the light of the
//! measurement. In another light it is an estimate, good for pigments with broad bands, and poor where the
//! measured surface is metameric to them.

use papilio_spectra::Spectrum;

use crate::{Observer, Xyz};

/// Most steps of Newton's method; usually ten suffice.
const MOST_STEPS: usize = 60;

/// Largest error of X, Y and Z.
const TOLERANCE: f64 = 1e-12;

/// Largest change of z in a step.
const LONGEST_STEP: f64 = 2.0;

/// Tristimulus values below this are black.
const BLACK: f64 = 1e-9;

impl Observer {
    /// Computes the smoothest reflectance spectrum, between 0 and 1, that has tristimulus values `xyz` (Y = 1
    /// of a perfect white) in `light`.
    ///
    /// `None` if no surface has this colour in this light, or it is so close to the limits of surface colours
    /// that no spectrum is found.
    ///
    /// ```
    /// use papilio_colour::{Observer, Xyz};
    /// use papilio_spectra::{Grid, illuminant};
    /// let grid = Grid::new(380.0, 780.0, 5.0)?;
    /// let (observer, light) = (Observer::new(&grid)?, illuminant("D65", &grid)?);
    /// let white = observer.xyz(&light);
    /// let grey = observer.smoothest(&light, white * (0.184 / white.y)).unwrap();
    /// assert!(grey.iter().all(|value| (value - 0.184).abs() < 1e-9));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn smoothest(&self, light: &Spectrum, xyz: Xyz) -> Option<Spectrum> {
        let weights =
            self.weights().map(|one| one.iter().zip(light.iter()).map(|(a, b)| a * b).collect::<Vec<f64>>());
        let sum = weights[1].iter().sum::<f64>();
        let weights = weights.map(|one| one.into_iter().map(|weight| weight / sum).collect::<Vec<f64>>());
        if xyz.to_array().into_iter().all(|value| value.abs() < BLACK) {
            return Some(light.map(|_| 0.0));
        }
        solved(&weights, xyz.to_array()).map(Spectrum::from_values)
    }
}

/// Solves for the reflectances; `None` without convergence.
fn solved(weights: &[Vec<f64>; 3], wanted: [f64; 3]) -> Option<Vec<f64>> {
    let count = weights[0].len();
    let start = (2.0 * wanted[1] - 1.0).clamp(-0.999, 0.999).atanh();
    let (mut z, mut multipliers) = (vec![start; count], [0.0; 3]);
    for _ in 0..MOST_STEPS {
        let (mut matrix, mut right) = system(weights, wanted, &z, multipliers);
        let missed = right[count..].iter().fold(0.0, |most: f64, one| most.max(one.abs()));
        let slope = right[..count].iter().fold(0.0, |most: f64, one| most.max(one.abs()));
        if missed < TOLERANCE && slope < 1e-9 {
            return Some(z.iter().map(|z| 0.5 * (z.tanh() + 1.0)).collect());
        }
        solve(&mut matrix, &mut right)?;
        let longest = right[..count].iter().fold(0.0, |most: f64, one| most.max(one.abs()));
        let scale = (LONGEST_STEP / longest).min(1.0);
        z.iter_mut().zip(&right).for_each(|(z, step)| *z += scale * step);
        multipliers.iter_mut().zip(&right[count..]).for_each(|(one, step)| *one += scale * step);
    }
    None
}

/// Newton's equations: the rows of the matrix, and the right-hand side, which is minus the residual.
fn system(
    weights: &[Vec<f64>; 3],
    wanted: [f64; 3],
    z: &[f64],
    multipliers: [f64; 3],
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let count = z.len();
    let mut matrix = vec![vec![0.0; count + 3]; count + 3];
    let mut right = vec![0.0; count + 3];
    (0..3).for_each(|k| right[count + k] = wanted[k]);
    for i in 0..count {
        let neighbours = [i.checked_sub(1), (i + 1 < count).then_some(i + 1)];
        for j in neighbours.into_iter().flatten() {
            matrix[i][j] -= 2.0;
            matrix[i][i] += 2.0;
            right[i] -= 2.0 * (z[i] - z[j]);
        }
        let tanh = z[i].tanh();
        let slope = 0.5 * (1.0 - tanh * tanh);
        let pull: f64 = (0..3).map(|k| multipliers[k] * weights[k][i]).sum();
        matrix[i][i] -= 2.0 * tanh * slope * pull;
        right[i] -= slope * pull;
        for k in 0..3 {
            matrix[i][count + k] = slope * weights[k][i];
            matrix[count + k][i] = slope * weights[k][i];
            right[count + k] -= 0.5 * (tanh + 1.0) * weights[k][i];
        }
    }
    (matrix, right)
}

/// Solves a system of linear equations by elimination with pivots; the solution replaces `right`. `None` if
/// it is singular.
fn solve(matrix: &mut [Vec<f64>], right: &mut [f64]) -> Option<()> {
    let count = right.len();
    for column in 0..count {
        let size = |row: &usize| matrix[*row][column].abs();
        let pivot = (column..count).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        matrix.swap(column, pivot);
        right.swap(column, pivot);
        let (above, below) = matrix.split_at_mut(column + 1);
        let (lead, first) = (&above[column], right[column]);
        if lead[column].abs() < f64::MIN_POSITIVE || !lead[column].is_finite() {
            return None;
        }
        for (row, value) in below.iter_mut().zip(&mut right[column + 1..]) {
            let factor = row[column] / lead[column];
            if factor != 0.0 {
                row[column..].iter_mut().zip(&lead[column..]).for_each(|(a, b)| *a -= factor * b);
                *value -= factor * first;
            }
        }
    }
    for column in (0..count).rev() {
        let known: f64 = (column + 1..count).map(|other| matrix[column][other] * right[other]).sum();
        right[column] = (right[column] - known) / matrix[column][column];
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use papilio_spectra::{Grid, illuminant};

    use super::*;
    use crate::Lab;

    fn found(lab: [f64; 3]) -> Option<(Spectrum, Xyz, Xyz)> {
        let grid = Grid::new(380.0, 780.0, 5.0).unwrap();
        let (observer, light) = (Observer::new(&grid).unwrap(), illuminant("D50", &grid).unwrap());
        let white = observer.xyz(&light);
        let white = white * (1.0 / white.y);
        let wanted = Lab { l: lab[0], a: lab[1], b: lab[2] }.xyz(white);
        let spectrum = observer.smoothest(&light, wanted)?;
        let seen = observer.xyz(&light.zip_map(&spectrum, |light, factor| light * factor));
        let scale = 1.0 / observer.xyz(&light).y;
        Some((spectrum, seen * scale, wanted))
    }

    /// Inks of six-colour electronic paper: the colour is exact, and reflectances are those of a surface.
    #[test]
    fn spectra_of_inks_have_their_colours() {
        for lab in [
            [66.0, -4.0, -2.0],
            [12.0, 3.0, -5.0],
            [60.0, -6.0, 62.0],
            [28.0, 38.0, 22.0],
            [30.0, 5.0, -36.0],
        ] {
            let (spectrum, seen, wanted) = found(lab).unwrap();
            assert!(spectrum.min() >= 0.0 && spectrum.max() <= 1.0, "{lab:?}");
            let pairs = seen.to_array().into_iter().zip(wanted.to_array());
            assert!(
                pairs.into_iter().all(|(seen, wanted)| (seen - wanted).abs() < 1e-9),
                "{lab:?}: {seen:?}"
            );
        }
    }

    /// The spectrum is the smoothest: any small change that keeps X, Y and Z has a larger sum of squares.
    #[test]
    fn no_neighbouring_spectrum_is_smoother() {
        let (spectrum, ..) = found([60.0, -6.0, 62.0]).unwrap();
        let grid = Grid::new(380.0, 780.0, 5.0).unwrap();
        let (observer, light) = (Observer::new(&grid).unwrap(), illuminant("D50", &grid).unwrap());
        let z: Vec<f64> = spectrum.iter().map(|value| (2.0 * value - 1.0).atanh()).collect();
        let sum = |z: &[f64]| z.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>();
        let weights = observer
            .weights()
            .map(|one| one.iter().zip(light.iter()).map(|(a, b)| a * b).collect::<Vec<_>>());
        // A bump at four wavelengths that leaves X, Y and Z as they are, to first order.
        for at in [10, 25, 40] {
            let places = [at, at + 4, at + 9, at + 13];
            let slope = |i: usize| 0.5 * (1.0 - (2.0 * spectrum[i] - 1.0).powi(2));
            let mut matrix = vec![vec![0.0; 3]; 3];
            let mut right = vec![0.0; 3];
            for k in 0..3 {
                (0..3).for_each(|j| matrix[k][j] = weights[k][places[j]] * slope(places[j]));
                right[k] = -weights[k][places[3]] * slope(places[3]);
            }
            solve(&mut matrix, &mut right).unwrap();
            let size = right.iter().fold(1.0, |most: f64, one| most.max(one.abs()));
            let [less, more] = [-1.0, 1.0].map(|sign| {
                let mut changed = z.clone();
                (0..3).for_each(|j| changed[places[j]] += sign * 1e-5 * right[j] / size);
                changed[places[3]] += sign * 1e-5 / size;
                sum(&changed)
            });
            assert!(
                (less - more).abs() < 1e-9 && less + more > 2.0 * sum(&z),
                "{at}: {less} {more} {}",
                sum(&z)
            );
        }
    }

    /// A yellow of L* 95 and b* 200 is brighter than any surface of this hue.
    #[test]
    fn impossible_colours_have_no_spectrum() {
        assert!(found([95.0, -10.0, 200.0]).is_none());
    }
}
