//! Pareto front.

use super::{Aims, FEASIBLE, SearchResult};

/// Merits that differ by at most this count as equal. Optimisers satisfy limits to about a hundredth of it.
pub(super) const EQUAL: f64 = 1e-4;

/// Returns the indices of the feasible designs that are not dominated: no other one is as good in every
/// objective and better in one.
///
/// They are sorted by the first objective, the best first. Of equal designs, only the first one is included.
pub fn front(aims: &Aims, results: &[SearchResult]) -> Vec<usize> {
    let merits = |one: &SearchResult| -> Option<Vec<f64>> {
        let feasible = !one.design.is_empty() && aims.missed(&one.values) <= FEASIBLE;
        (0..aims.objectives())
            .map(|objective| aims.merit(objective, &one.values).filter(|_| feasible))
            .collect()
    };
    let all: Vec<(usize, Vec<f64>)> = results
        .iter()
        .enumerate()
        .filter_map(|(index, one)| merits(one).map(|merits| (index, merits)))
        .collect();
    let mut front: Vec<&(usize, Vec<f64>)> =
        all.iter().filter(|one| !all.iter().any(|other| dominates(other, one))).collect();
    front.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    front.into_iter().map(|(index, _)| *index).collect()
}

/// Returns true if the first design dominates the second, or equals it and has a smaller index. With a single
/// objective, the comparison is exact, so that there is one best design.
fn dominates((number, one): &(usize, Vec<f64>), (other_number, other): &(usize, Vec<f64>)) -> bool {
    let margin = if one.len() == 1 { 0.0 } else { EQUAL };
    let as_good = one.iter().zip(other).all(|(a, b)| *a <= b + margin);
    let better = one.iter().zip(other).any(|(a, b)| *a < b - margin);
    as_good && (better || number < other_number)
}

#[cfg(test)]
mod tests {
    use super::dominates;

    #[test]
    fn dominates_compares_all_objectives_and_prefers_the_first_of_equals() {
        let design = |number: usize, a: f64, b: f64| (number, vec![a, b]);
        assert!(dominates(&design(1, -2.0, -1.0), &design(0, -1.0, -1.0)));
        assert!(!dominates(&design(1, -2.0, 1.0), &design(0, -1.0, -1.0)));
        // Equal within the margin in the second objective, better in the first.
        assert!(dominates(&design(1, -2.0, -1.0), &design(0, -1.0, -1.00001)));
        // Equal: the first one.
        assert!(dominates(&design(0, 1.0, 1.0), &design(1, 1.0, 1.0)));
        assert!(!dominates(&design(1, 1.0, 1.0), &design(0, 1.0, 1.0)));
    }
}
