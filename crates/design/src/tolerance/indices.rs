//! Which keys are to blame: Sobol indices of variance.
//!
//! The *first-order* index of a key is the share of a metric's variance that would be gone if the key did not
//! scatter and nothing else changed, on average; the *total* index is the share that would be left if nothing but the key
//! scattered, interactions with other keys included. Of independent keys, the first-order indices sum to 1 at most,
//! and to 1 where keys act one by one; a total index of 0 means that the key makes no difference.
//!
//! Correlated keys have no indices of their own: what each of them does cannot be told apart. Their group has.
//!
//! The first-order index is the mean, weighted by their errors, of two estimators: one is exact for a key that does
//! nothing, the other for a key that does all.
//!
//! Sources: first order A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010), eq. 16, centred, and eq. 17 (M. J. W.
//! Jansen); total index M. J. W. Jansen, Comput. Phys. Commun. 117, 35 (1999).

use serde::Serialize;

use super::estimate::{Estimate, Sums};
use super::plan::replicate;

/// How much of a metric's variance comes from a group of keys.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Indices {
    /// By itself.
    pub first: Estimate,
    /// With all that it does together with others.
    pub total: Estimate,
}

/// The indices of a group from a metric of the rows' own pieces, their other pieces, and those mixed of both. `None`
/// if it does not scatter.
pub fn indices(own: &[f64], other: &[f64], mixed: &[f64]) -> Option<Indices> {
    let rows = own.iter().zip(other).zip(mixed).map(|((a, b), m)| [*a, *b, *m]).enumerate();
    let known: Vec<(usize, [f64; 3])> =
        rows.filter(|(_, row)| row.iter().all(|value| !value.is_nan())).collect();
    let centre = known.iter().map(|(_, [a, b, _])| 0.5 * (a + b)).sum::<f64>() / known.len() as f64;
    let sums = Sums::of(known.iter().map(|(row, values)| {
        let [a, b, m] = values.map(|value| value - centre);
        let halved = |difference: f64| 0.5 * difference * difference;
        (
            replicate(*row),
            [0.5 * (a + b), 0.5 * (a * a + b * b), b * (m - a), m - a, halved(b - m), halved(m - a), 1.0],
        )
    }));
    let variance = |left_out| {
        let [sum, squares, .., count] = sums.without(left_out);
        squares / count - (sum / count).powi(2)
    };
    // What rounding leaves of metrics that do not change is no variance.
    let least = 1e-20 * (centre * centre + variance(None));
    if known.is_empty() || variance(None) <= least {
        return None;
    }
    let of_little = |left_out| {
        let [sum, _, product, change, .., count] = sums.without(left_out);
        (product - sum * change / count) / count / variance(left_out)
    };
    let of_much = |left_out| {
        let [.., halved, _, count] = sums.without(left_out);
        1.0 - halved / count / variance(left_out)
    };
    let total = Estimate::jackknife(|left_out| {
        let [.., halved, count] = sums.without(left_out);
        halved / count / variance(left_out)
    });
    let [of_little_varies, of_much_varies] =
        [Estimate::jackknife(of_little), Estimate::jackknife(of_much)].map(|one| one.standard_error.powi(2));
    // The whole of the weight to one that has no error.
    let weight = of_much_varies / (of_little_varies + of_much_varies).max(f64::MIN_POSITIVE);
    let first =
        Estimate::jackknife(|left_out| weight * of_little(left_out) + (1.0 - weight) * of_much(left_out));
    Some(Indices { first, total })
}
