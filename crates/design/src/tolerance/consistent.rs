//! Correction of estimated indices to consistent ones.

use super::indices::Indices;

/// Moves the indices of a metric to the nearest consistent ones, in units of their standard errors.
///
/// Indices are consistent if some function of independent groups can have them: each is from 0 to 1, no
/// first-order index exceeds its total index, the first-order indices sum to at most 1, and the total indices
/// sum to at least 1.
///
/// Consistent indices do not change. The true indices are consistent, so that the sum of squared errors (in
/// units of the standard errors) cannot increase. Method: C. Hildreth, Nav. Res. Logist. Q. 4, 79 (1957), a
/// quadratic programme solved by successive projections onto half-spaces.
pub(super) fn consistent(mut all: Vec<Option<Indices>>) -> Vec<Option<Indices>> {
    let known: Vec<usize> = (0..all.len()).filter(|group| all[*group].is_some()).collect();
    let pairs = known.iter().filter_map(|group| all[*group]);
    let (mut x, mut variances): (Vec<f64>, Vec<f64>) = pairs
        .flat_map(|one| [one.first, one.total])
        .map(|one| (one.value, one.standard_error * one.standard_error))
        .unzip();
    if !x.iter().chain(&variances).all(|value| value.is_finite()) {
        return all;
    }
    // An index without error does not move.
    variances.iter_mut().for_each(|variance| *variance = variance.max(1e-24));
    let count = known.len();
    // Constraints `sum of factor * x <= limit`.
    let mut limits: Vec<(Vec<(usize, f64)>, f64)> = Vec::new();
    for k in 0..count {
        let (first, total) = (2 * k, 2 * k + 1);
        limits.push((vec![(first, -1.0)], 0.0));
        limits.push((vec![(total, 1.0)], 1.0));
        limits.push((vec![(first, 1.0), (total, -1.0)], 0.0));
    }
    // All groups have indices if one has, because the metric varies: the sums are over all groups.
    limits.push(((0..count).map(|k| (2 * k, 1.0)).collect(), 1.0));
    limits.push(((0..count).map(|k| (2 * k + 1, -1.0)).collect(), -1.0));
    let mut multipliers = vec![0.0; limits.len()];
    for _ in 0..2000 {
        let mut moved = 0.0_f64;
        for ((factors, limit), multiplier) in limits.iter().zip(&mut multipliers) {
            let excess = factors.iter().map(|(index, factor)| factor * x[*index]).sum::<f64>() - limit;
            let stiffness: f64 =
                factors.iter().map(|(index, factor)| factor * factor * variances[*index]).sum();
            let step = f64::max(excess / stiffness, -*multiplier);
            *multiplier += step;
            for (index, factor) in factors {
                let by = step * factor * variances[*index];
                x[*index] -= by;
                moved = moved.max(by.abs());
            }
        }
        if moved < 1e-13 {
            break;
        }
    }
    for (k, group) in known.into_iter().enumerate() {
        if let Some(one) = &mut all[group] {
            // Removes rounding errors.
            one.total.value = x[2 * k + 1].clamp(0.0, 1.0);
            one.first.value = x[2 * k].clamp(0.0, one.total.value);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tolerance::Estimate;

    fn estimate(value: f64, standard_error: f64) -> Estimate {
        Estimate { value, standard_error }
    }

    fn indices(pairs: &[[f64; 4]]) -> Vec<Option<Indices>> {
        let one = |[s, s_error, t, t_error]: &[f64; 4]| {
            Some(Indices { first: estimate(*s, *s_error), total: estimate(*t, *t_error) })
        };
        pairs.iter().map(one).collect()
    }

    #[test]
    fn consistent_indices_do_not_change() {
        let all = indices(&[[0.3, 0.01, 0.5, 0.01], [0.5, 0.02, 0.7, 0.01]]);
        assert_eq!(consistent(all.clone()), all);
    }

    /// Two indices move in the ratio of the squares of their standard errors.
    #[test]
    fn inconsistent_indices_move_in_proportion_to_their_variances() {
        let found = consistent(indices(&[[0.60, 0.01, 0.55, 0.02], [0.30, 0.01, 0.50, 0.01]]));
        let one = found[0].unwrap();
        assert!((one.first.value - 0.59).abs() < 1e-9 && (one.total.value - 0.59).abs() < 1e-9, "{one:?}");
        assert_eq!((one.first.standard_error, one.total.standard_error), (0.01, 0.02));
        // The sum 0.8 + 0.4 exceeds 1 by 0.2, of which each index loses half.
        let found = consistent(indices(&[[0.8, 0.01, 0.9, 0.01], [0.4, 0.01, 0.5, 0.01]]));
        let firsts: Vec<f64> = found.iter().flatten().map(|one| one.first.value).collect();
        assert!((firsts[0] - 0.7).abs() < 1e-9 && (firsts[1] - 0.3).abs() < 1e-9, "{firsts:?}");
    }
}
