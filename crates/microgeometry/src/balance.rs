//! Balancing: one factor for each band makes the symmetric light between bands add up to what each band is to
//! have.
//!
//! With A the light between two bands and w the light that each is to have, the factors exp(u) solve sum_j
//! A_ij exp(u_i + u_j) = w_i. That is the minimum of the convex function sum_ij A_ij exp(u_i + u_j) / 2 -
//! sum_i w_i u_i (Marshall and Olkin 1968), which Newton's method finds in a few steps. Scaling by turns
//! (Sinkhorn and Knopp 1967) has the same limit, but hardly moves where two groups of bands exchange almost
//! all of their light, as the two sides of a face between similar media do.

use crate::bands::AZIMUTHS;

/// Steps of Newton's method.
const STEPS: usize = 100;

/// Relative error of the light of a band at which a balance counts as found.
const PRECISION: f64 = 1e-13;

/// The same for light by azimuth, which is kept with seven digits.
const PRECISION_OF_FACTORS: f64 = 1e-9;

/// Missing light, relative to that at the start of a step, up to which conjugate gradients solve it, and the
/// most of their own steps.
const PRECISION_OF_STEP: f64 = 1e-3;
const STEPS_OF_GRADIENTS: usize = 400;

/// Steps that bring no gain, after which there are no such factors.
const STEPS_WITHOUT_GAIN: u32 = 8;

/// The largest change of the logarithm of a factor in one step.
const LONGEST_STEP: f64 = 1.0;

/// Scales symmetric light between bands, `[from][to][azimuth]`, by a factor for each band, until that of each
/// band is what is wanted. A band without light stays as it is; one that is to have none loses its light.
pub(crate) fn balance(light: &mut [f64], wanted: &[f64]) {
    let count = wanted.len();
    let mut between: Vec<f64> = light.chunks_exact(AZIMUTHS).map(|cells| cells.iter().sum()).collect();
    let mut factors: Vec<f64> = wanted.iter().map(|wanted| if *wanted > 0.0 { 1.0 } else { 0.0 }).collect();
    scale(&mut between, &factors, 1);
    let lit: Vec<usize> = (0..count)
        .filter(|&band| between[band * count..][..count].iter().any(|light| *light > 0.0))
        .collect();
    for _ in 0..STEPS {
        let sums: Vec<f64> = lit.iter().map(|&band| between[band * count..][..count].iter().sum()).collect();
        let missing: Vec<f64> = lit.iter().zip(&sums).map(|(&band, sum)| wanted[band] - sum).collect();
        if lit.iter().zip(&missing).all(|(&band, missing)| missing.abs() <= PRECISION * wanted[band]) {
            break;
        }
        let mut hessian: Vec<f64> = lit
            .iter()
            .flat_map(|&from| lit.iter().map(move |&to| from * count + to))
            .map(|cell| between[cell])
            .collect();
        for (number, sum) in sums.iter().enumerate() {
            hessian[number * lit.len() + number] += sum;
        }
        let mut step = missing;
        solve(&mut hessian, &mut step);
        let longest = step.iter().fold(0.0, |longest: f64, step| longest.max(step.abs()));
        let damping = if longest > LONGEST_STEP { LONGEST_STEP / longest } else { 1.0 };
        let mut change = vec![1.0; count];
        lit.iter().zip(&step).for_each(|(&band, step)| change[band] = (damping * step).exp());
        scale(&mut between, &change, 1);
        factors.iter_mut().zip(&change).for_each(|(factor, change)| *factor *= change);
    }
    scale(light, &factors, AZIMUTHS);
}

/// The factors that [`balance`] finds, for light `[from][to]` between thousands of patches: the equations of
/// each step are solved by conjugate gradients, which only multiply by the light.
///
/// # Errors
/// The largest relative error of the light of a patch that remains, if no factors make it what is wanted.
pub(crate) fn factors(light: &[f64], wanted: &[f64]) -> Result<Vec<f64>, f64> {
    let mut factors: Vec<f64> = wanted.iter().map(|wanted| if *wanted > 0.0 { 1.0 } else { 0.0 }).collect();
    let (mut largest, mut best, mut idle) = (0.0, f64::INFINITY, 0);
    for _ in 0..STEPS {
        let sums = times(light, &factors, &vec![1.0; wanted.len()]);
        // A dark patch stays as it is.
        let missing: Vec<f64> = sums
            .iter()
            .zip(wanted)
            .map(|(sum, wanted)| if *sum > 0.0 { wanted - sum } else { 0.0 })
            .collect();
        largest = missing
            .iter()
            .zip(wanted)
            .filter(|(missing, _)| **missing != 0.0)
            .map(|(m, w)| m.abs() / w)
            .fold(0.0, f64::max);
        if largest <= PRECISION_OF_FACTORS {
            return Ok(factors);
        }
        idle = if largest < 0.9 * best { 0 } else { idle + 1 };
        if idle > STEPS_WITHOUT_GAIN {
            break;
        }
        best = largest.min(best);
        let step = conjugate_gradients(light, &factors, &sums, missing);
        let longest = step.iter().fold(0.0, |longest: f64, step| longest.max(step.abs()));
        let damping = if longest > LONGEST_STEP { LONGEST_STEP / longest } else { 1.0 };
        factors.iter_mut().zip(&step).for_each(|(factor, step)| *factor *= (damping * step).exp());
    }
    Err(largest)
}

/// Multiplies a list by the light between patches, scaled by the factors of both.
fn times(light: &[f64], factors: &[f64], list: &[f64]) -> Vec<f64> {
    let scaled: Vec<f64> = list.iter().zip(factors).map(|(value, factor)| value * factor).collect();
    let rows = light.chunks_exact(factors.len()).zip(factors);
    rows.map(|(row, factor)| factor * row.iter().zip(&scaled).map(|(a, b)| a * b).sum::<f64>()).collect()
}

/// Solves (sums + light) step = missing, with the light scaled by factors and `sums` on the diagonal, which
/// is also the preconditioner.
fn conjugate_gradients(light: &[f64], factors: &[f64], sums: &[f64], mut missing: Vec<f64>) -> Vec<f64> {
    let scaled = |missing: &[f64]| -> Vec<f64> {
        missing.iter().zip(sums).map(|(missing, sum)| if *sum > 0.0 { missing / sum } else { 0.0 }).collect()
    };
    let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut step = vec![0.0; sums.len()];
    let mut along = scaled(&missing);
    let mut size = product(&missing, &along);
    let enough = PRECISION_OF_STEP * PRECISION_OF_STEP * size;
    for _ in 0..STEPS_OF_GRADIENTS {
        if size <= enough {
            break;
        }
        let mut turned = times(light, factors, &along);
        turned.iter_mut().zip(sums).zip(&along).for_each(|((turned, sum), along)| *turned += sum * along);
        let bend = product(&along, &turned);
        // Two groups that exchange light only with each other can both be scaled, one up and one down,
        // without any change.
        if bend <= f64::EPSILON * size {
            break;
        }
        let length = size / bend;
        step.iter_mut().zip(&along).for_each(|(step, along)| *step += length * along);
        missing.iter_mut().zip(&turned).for_each(|(missing, turned)| *missing -= length * turned);
        let next = scaled(&missing);
        let before = std::mem::replace(&mut size, product(&missing, &next));
        along.iter_mut().zip(&next).for_each(|(along, next)| *along = next + size / before * *along);
    }
    step
}

/// Multiplies the `cells` of each pair of bands by the factors of both.
pub(crate) fn scale(light: &mut [f64], factors: &[f64], cells: usize) {
    for (row, from) in light.chunks_exact_mut(factors.len() * cells).zip(factors) {
        for (cells, to) in row.chunks_exact_mut(cells).zip(factors) {
            cells.iter_mut().for_each(|light| *light *= from * to);
        }
    }
}

/// Solves a symmetric positive definite system in place (Cholesky); a pivot that is only rounding moves
/// nothing.
fn solve(matrix: &mut [f64], right: &mut [f64]) {
    let size = right.len();
    for i in 0..size {
        for j in 0..=i {
            let (above, own) = matrix.split_at(i * size);
            let other = if j < i { &above[j * size..] } else { own };
            let sum = own[j] - own[..j].iter().zip(&other[..j]).map(|(a, b)| a * b).sum::<f64>();
            matrix[i * size + j] = if j < i {
                sum / matrix[j * size + j]
            } else if sum > f64::EPSILON * matrix[i * size + i] {
                sum.sqrt()
            } else {
                f64::INFINITY
            };
        }
        let row = &matrix[i * size..][..=i];
        let known: f64 = row[..i].iter().zip(&right[..i]).map(|(a, b)| a * b).sum();
        right[i] = (right[i] - known) / row[i];
    }
    for i in (0..size).rev() {
        right[i] /= matrix[i * size + i];
        for j in 0..i {
            right[j] -= matrix[i * size + j] * right[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Symmetric light of two groups of bands: `within` of each of them, and between them.
    fn two_groups(bands: usize, within: f64) -> Vec<f64> {
        let mut light = vec![0.0; bands * bands * AZIMUTHS];
        for from in 0..bands {
            for to in 0..bands {
                let is_same_group = (from < bands / 2) == (to < bands / 2);
                let share = if is_same_group { within } else { 1.0 + ((from * to) % 5) as f64 };
                for azimuth in 0..AZIMUTHS {
                    light[(from * bands + to) * AZIMUTHS + azimuth] = share * (1.0 + (azimuth % 3) as f64);
                }
            }
        }
        light
    }

    fn sums(light: &[f64], bands: usize) -> Vec<f64> {
        light.chunks_exact(bands * AZIMUTHS).map(|row| row.iter().sum()).collect()
    }

    /// Each band has what it is to have, also where both groups exchange almost all of their light, and the
    /// light stays symmetric.
    #[test]
    fn light_adds_up_even_where_bands_of_a_side_hardly_exchange_any() {
        let bands = 12;
        for within in [1.0, 1e-3, 1e-6] {
            let mut light = two_groups(bands, within);
            // Reflection can make up for a difference of the groups that is of its own size only.
            let wanted: Vec<f64> =
                (0..bands).map(|band| 1.0 + if band < bands / 2 { 0.05 * within } else { 0.0 }).collect();
            balance(&mut light, &wanted);
            for (sum, wanted) in sums(&light, bands).iter().zip(&wanted) {
                assert!((sum - wanted).abs() < 1e-12, "within {within}: {sum}, wanted {wanted}");
            }
            let cell = |from: usize, to: usize| light[(from * bands + to) * AZIMUTHS];
            assert!((cell(2, 9) - cell(9, 2)).abs() < 1e-15);
        }
    }

    /// Conjugate gradients find the factors of Cholesky's steps; light that no factors can balance is refused
    /// with what is missing.
    #[test]
    fn factors_of_many_patches_are_those_of_bands() {
        let bands = 12;
        for within in [1.0, 1e-3] {
            let mut light = two_groups(bands, within);
            let between: Vec<f64> = light.chunks_exact(AZIMUTHS).map(|cells| cells.iter().sum()).collect();
            let mut wanted = vec![1.0; bands];
            wanted[5] = 0.0;
            balance(&mut light, &wanted);
            let found = factors(&between, &wanted).unwrap();
            for (cell, balanced) in light.chunks_exact(AZIMUTHS).enumerate() {
                let expected: f64 = balanced.iter().sum();
                let scaled = found[cell / bands] * found[cell % bands] * between[cell];
                assert!((scaled - expected).abs() < 1e-8, "{within}: {scaled} {expected}");
            }
        }
        // The first patch exchanges light with the others only, which are to have less than it.
        let star = [0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        assert!(factors(&star, &[3.0, 1.0, 1.0]).is_err_and(|missing| missing > 0.1));
    }

    /// Dark bands stay dark, and a band that is to have nothing loses its light; the others are balanced all
    /// the same.
    #[test]
    fn bands_without_light() {
        let bands = 8;
        let mut light = two_groups(bands, 0.5);
        for other in 0..bands {
            for cell in [3 * bands + other, other * bands + 3] {
                light[cell * AZIMUTHS..][..AZIMUTHS].fill(0.0);
            }
        }
        let mut wanted = vec![1.0; bands];
        wanted[6] = 0.0;
        balance(&mut light, &wanted);
        for (band, sum) in sums(&light, bands).into_iter().enumerate() {
            let expected = if band == 3 || band == 6 { 0.0 } else { 1.0 };
            assert!((sum - expected).abs() < 1e-12, "{band}: {sum}");
        }
    }
}
