//! Indices that there can be.

use super::indices::Indices;

/// Moves the indices of a metric, as little as can be in units of their errors, so that they are those of some function of
/// independent groups: each from 0 to 1, none by itself above its total, by themselves 1 in sum at most, the totals 1 at least.
///
/// Indices that are such already stay as they are. The true ones are such, so that no index moves away from its true value in sum of
/// squares. (C. Hildreth, Nav. Res. Logist. Q. 4, 79 (1957): a quadratic programme by its half-spaces, one after the other.)
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
    // One that has no error gives way to none.
    variances.iter_mut().for_each(|variance| *variance = variance.max(1e-24));
    let count = known.len();
    // Each is `sum of factor * x <= limit`.
    let mut limits: Vec<(Vec<(usize, f64)>, f64)> = Vec::new();
    for k in 0..count {
        let (first, total) = (2 * k, 2 * k + 1);
        limits.push((vec![(first, -1.0)], 0.0));
        limits.push((vec![(total, 1.0)], 1.0));
        limits.push((vec![(first, 1.0), (total, -1.0)], 0.0));
    }
    // Where one does not scatter, none does: the sums are those of all groups.
    limits.push(((0..count).map(|k| (2 * k, 1.0)).collect(), 1.0));
    limits.push(((0..count).map(|k| (2 * k + 1, -1.0)).collect(), -1.0));
    let mut prices = vec![0.0; limits.len()];
    for _ in 0..2000 {
        let mut moved = 0.0_f64;
        for ((factors, limit), price) in limits.iter().zip(&mut prices) {
            let over = factors.iter().map(|(at, factor)| factor * x[*at]).sum::<f64>() - limit;
            let stiffness: f64 = factors.iter().map(|(at, factor)| factor * factor * variances[*at]).sum();
            let step = f64::max(over / stiffness, -*price);
            *price += step;
            for (at, factor) in factors {
                let by = step * factor * variances[*at];
                x[*at] -= by;
                moved = moved.max(by.abs());
            }
        }
        if moved < 1e-13 {
            break;
        }
    }
    for (k, group) in known.into_iter().enumerate() {
        if let Some(one) = &mut all[group] {
            // What is left is rounding.
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

    fn of(pairs: &[[f64; 4]]) -> Vec<Option<Indices>> {
        let one = |[s, s_error, t, t_error]: &[f64; 4]| {
            Some(Indices { first: estimate(*s, *s_error), total: estimate(*t, *t_error) })
        };
        pairs.iter().map(one).collect()
    }

    #[test]
    fn what_can_be_stays() {
        let all = of(&[[0.3, 0.01, 0.5, 0.01], [0.5, 0.02, 0.7, 0.01]]);
        assert_eq!(consistent(all.clone()), all);
    }

    /// The surer of two moves less: by the ratio of the squares of their errors.
    #[test]
    fn what_cannot_be_meets_where_its_errors_say() {
        let found = consistent(of(&[[0.60, 0.01, 0.55, 0.02], [0.30, 0.01, 0.50, 0.01]]));
        let one = found[0].unwrap();
        assert!((one.first.value - 0.59).abs() < 1e-9 && (one.total.value - 0.59).abs() < 1e-9, "{one:?}");
        assert_eq!((one.first.standard_error, one.total.standard_error), (0.01, 0.02));
        // Sums too: .8 + .4 is .2 too much, of which each loses a half.
        let found = consistent(of(&[[0.8, 0.01, 0.9, 0.01], [0.4, 0.01, 0.5, 0.01]]));
        let firsts: Vec<f64> = found.iter().flatten().map(|one| one.first.value).collect();
        assert!((firsts[0] - 0.7).abs() < 1e-9 && (firsts[1] - 0.3).abs() < 1e-9, "{firsts:?}");
    }
}
