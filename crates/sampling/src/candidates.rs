//! Well-separated points of the unit square: Mitchell's best-candidate algorithm.
//!
//! Of several random candidates, each new point is the one that is farthest from all previous points, on the
//! torus (D. Mitchell, *Spectrally Optimal Sampling for Distribution Ray Tracing*, SIGGRAPH 1991; Feng 2012,
//! ch. 4). The first n points, for any n, are such a set too.

use crate::numbers::{mix64, open_unit};

/// Number of points of the set: a power of two.
pub(crate) const LARGEST_SET: usize = 4096;

/// Number of candidates for each point.
const CANDIDATES: u64 = 32;

/// Number of cells of the search grid along each side.
const CELLS: usize = 48;

/// Returns the point set, which is the same for every call.
pub(crate) fn best_candidate_points() -> Vec<[f64; 2]> {
    let mut grid = Grid { cells: vec![Vec::new(); CELLS * CELLS] };
    let mut points: Vec<[f64; 2]> = Vec::with_capacity(LARGEST_SET);
    for n in 0..LARGEST_SET as u64 {
        let candidate = |k: u64| {
            let count = 2 * (n * CANDIDATES + k);
            [open_unit(mix64(count)), open_unit(mix64(count + 1))]
        };
        let mut best = ([0.5, 0.5], -1.0);
        for point in (0..CANDIDATES).map(candidate) {
            let distance = grid.nearest(point, best.1);
            if distance > best.1 {
                best = (point, distance);
            }
        }
        grid.cells[Grid::cell(best.0)].push(best.0);
        points.push(best.0);
    }
    points
}

/// The points so far, sorted into cells.
struct Grid {
    cells: Vec<Vec<[f64; 2]>>,
}

impl Grid {
    fn cell(point: [f64; 2]) -> usize {
        let [x, y] = point.map(|v| (v * CELLS as f64) as usize);
        y * CELLS + x
    }

    /// Squared distance to the nearest point. If it is below `threshold`, any value below `threshold` may be
    /// returned.
    fn nearest(&self, point: [f64; 2], threshold: f64) -> f64 {
        let [x, y] = point.map(|v| (v * CELLS as f64) as usize);
        let mut nearest = f64::INFINITY;
        for ring in 0..=CELLS / 2 {
            // Points outside the rings searched so far are at least this far away.
            let beyond = (ring as f64 - 1.0).max(0.0) / CELLS as f64;
            if nearest <= beyond * beyond || nearest < threshold {
                break;
            }
            for (dx, dy) in ring_cells(ring) {
                let wrap = |cell: usize, d: isize| (cell as isize + d).rem_euclid(CELLS as isize) as usize;
                for other in &self.cells[wrap(y, dy) * CELLS + wrap(x, dx)] {
                    nearest = nearest.min(distance_squared(point, *other));
                }
            }
        }
        nearest
    }
}

/// Offsets of the cells of a square ring.
fn ring_cells(ring: usize) -> impl Iterator<Item = (isize, isize)> {
    let r = ring as isize;
    (-r..=r).flat_map(move |dy| {
        let step = if dy.abs() == r { 1 } else { (2 * r).max(1) };
        (-r..=r).step_by(step as usize).map(move |dx| (dx, dy))
    })
}

/// Squared distance on the torus.
fn distance_squared(a: [f64; 2], b: [f64; 2]) -> f64 {
    let along = |k: usize| {
        let d = (a[k] - b[k]).abs();
        d.min(1.0 - d)
    };
    along(0).powi(2) + along(1).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The smallest distance of 4096 points cannot exceed that of a hexagonal lattice, 0.0168. Best
    /// candidates keep at least half of it; the closest two of random points are about 1e-4 apart.
    #[test]
    fn closest_points_are_half_a_lattice_spacing_apart() {
        let points = best_candidate_points();
        for count in [64, 4096] {
            let lattice = (2.0 / 3.0_f64.sqrt() / count as f64).sqrt();
            let pairs = (1..count).flat_map(|i| (0..i).map(move |j| (i, j)));
            let closest =
                pairs.map(|(i, j)| distance_squared(points[i], points[j])).fold(1.0, f64::min).sqrt();
            assert!(closest > 0.5 * lattice && closest < lattice, "{count}: {closest} of {lattice}");
        }
    }
}
