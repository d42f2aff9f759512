//! The designs that no other beats in everything.

use super::{Aims, FEASIBLE, Found};

/// Merits that differ by no more than this are alike: optimisers keep a limit to about a hundredth of it.
const ALIKE: f64 = 1e-4;

/// The numbers of those designs that meet their limits and that no other one beats: as good in every objective and better in
/// one. In the order of the first objective, the best first; of designs that are alike the first found.
pub fn front(aims: &Aims, found: &[Found]) -> Vec<usize> {
    let merits = |one: &Found| -> Option<Vec<f64>> {
        let sound = !one.design.is_empty() && aims.missed(&one.values) <= FEASIBLE;
        (0..aims.objectives()).map(|at| aims.merit(at, &one.values).filter(|_| sound)).collect()
    };
    let all: Vec<(usize, Vec<f64>)> =
        found.iter().enumerate().filter_map(|(at, one)| merits(one).map(|merits| (at, merits))).collect();
    let mut front: Vec<&(usize, Vec<f64>)> =
        all.iter().filter(|one| !all.iter().any(|other| beats(other, one))).collect();
    front.sort_by(|a, b| a.1[0].total_cmp(&b.1[0]));
    front.into_iter().map(|(at, _)| *at).collect()
}

/// True if the first design beats the second. One objective is exact: there is a best.
fn beats((number, one): &(usize, Vec<f64>), (other_number, other): &(usize, Vec<f64>)) -> bool {
    let alike = if one.len() == 1 { 0.0 } else { ALIKE };
    let as_good = one.iter().zip(other).all(|(a, b)| *a <= b + alike);
    let better = one.iter().zip(other).any(|(a, b)| *a < b - alike);
    as_good && (better || number < other_number)
}

#[cfg(test)]
mod tests {
    use super::beats;

    #[test]
    fn what_beats_what() {
        let design = |number: usize, a: f64, b: f64| (number, vec![a, b]);
        assert!(beats(&design(1, -2.0, -1.0), &design(0, -1.0, -1.0)));
        assert!(!beats(&design(1, -2.0, 1.0), &design(0, -1.0, -1.0)));
        // As good as can be told in the one, better in the other.
        assert!(beats(&design(1, -2.0, -1.0), &design(0, -1.0, -1.00001)));
        // Alike: the first found.
        assert!(beats(&design(0, 1.0, 1.0), &design(1, 1.0, 1.0)));
        assert!(!beats(&design(1, 1.0, 1.0), &design(0, 1.0, 1.0)));
    }
}
