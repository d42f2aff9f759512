//! Contours of a quantity on a polar grid: areas to fill, and the lines around them.
//!
//! The method is marching squares: in each cell of the grid, the contour is a straight line between points
//! interpolated on the sides of the cell. A frame of nodes on the border of the grid, with values below
//! any level, closes every area. All areas are therefore loops.

use crate::svg::Point;

/// The contour of a level, on the page.
#[derive(Debug, Default)]
pub(crate) struct Contour {
    /// Loops around the areas at or above the level, and around holes (to be filled by the even-odd rule).
    pub(crate) areas: Vec<Vec<Point>>,
    /// The same without the segments along the edge of the data; a closed line ends where it begins.
    pub(crate) lines: Vec<Vec<Point>>,
}

/// Values at the nodes of a polar grid, with a frame. If `periodic`, the last column is next to the first.
#[derive(Debug)]
pub(crate) struct PolarField {
    columns: usize,
    periodic: bool,
    points: Vec<Point>,
    /// Minus infinity where there are no data.
    values: Vec<f64>,
}

/// A point where a contour crosses a side of a cell.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    at: Point,
    /// Whether the side lies between a node with data and one without.
    at_edge: bool,
}

impl PolarField {
    /// Creates the field from the points and values of each column, innermost first. All columns have the
    /// same length.
    pub(crate) fn new(columns: &[Vec<(Point, f64)>], periodic: bool) -> Self {
        let rows = columns.first().map_or(0, Vec::len);
        // The frame has one column before and one after the data, unless the field is periodic.
        let side = usize::from(!periodic);
        let framed = columns.len() + 2 * side;
        let (mut points, mut values) = (Vec::new(), Vec::new());
        for i in 0..rows + 2 {
            for j in 0..framed {
                let column = &columns[j.saturating_sub(side).min(columns.len() - 1)];
                let (point, value) = column[i.saturating_sub(1).min(rows - 1)];
                let inside = (1..=rows).contains(&i) && (periodic || (1..=columns.len()).contains(&j));
                points.push(point);
                values.push(if inside && value.is_finite() { value } else { f64::NEG_INFINITY });
            }
        }
        Self { columns: framed, periodic, points, values }
    }

    /// Returns the contour of a level.
    pub(crate) fn contour(&self, level: f64) -> Contour {
        let next = self.links(level);
        let mut visited = vec![false; next.len()];
        let mut contour = Contour::default();
        for start in 0..next.len() {
            let (mut side, mut crossings) = (start, Vec::new());
            while let Some(following) = next[side].filter(|_| !visited[side]) {
                visited[side] = true;
                crossings.push(self.crossing(side, level));
                side = following;
            }
            if crossings.len() > 2 {
                contour.lines.extend(lines(&crossings));
                contour.areas.push(crossings.iter().map(|crossing| crossing.at).collect());
            }
        }
        contour
    }

    /// Returns, for each side of a cell that the contour crosses, the side that it crosses next.
    ///
    /// Side 2 k goes from node k outwards, side 2 k + 1 to the next column.
    fn links(&self, level: f64) -> Vec<Option<usize>> {
        let mut next = vec![None; 2 * self.values.len()];
        let inside: Vec<bool> = self.values.iter().map(|value| *value >= level).collect();
        let rows = self.values.len() / self.columns.max(1);
        let cell_columns = if self.periodic { self.columns } else { self.columns - 1 };
        for i in 0..rows.saturating_sub(1) {
            for j in 0..cell_columns {
                let right = (j + 1) % self.columns;
                let (a, b) = (i * self.columns + j, i * self.columns + right);
                // Most cells are not crossed.
                if [inside[b], inside[a + self.columns], inside[b + self.columns]] == [inside[a]; 3] {
                    continue;
                }
                let corners =
                    [(i, j), (i, right), (i + 1, right), (i + 1, j)].map(|(i, j)| i * self.columns + j);
                let sides = [2 * corners[0] + 1, 2 * corners[1], 2 * corners[3] + 1, 2 * corners[0]];
                let values = corners.map(|corner| self.values[corner]);
                for (from, to) in in_cell(values, level).into_iter().flatten() {
                    next[sides[from]] = Some(sides[to]);
                }
            }
        }
        next
    }

    fn crossing(&self, side: usize, level: f64) -> Crossing {
        let from = side / 2;
        let (i, j) = (from / self.columns, from % self.columns);
        let to = if side.is_multiple_of(2) {
            from + self.columns
        } else {
            i * self.columns + (j + 1) % self.columns
        };
        let (a, b) = (self.values[from], self.values[to]);
        let fraction = match (a.is_finite(), b.is_finite()) {
            (true, true) => (level - a) / (b - a),
            (true, false) => 0.0,
            _ => 1.0,
        };
        let (p, q) = (self.points[from], self.points[to]);
        Crossing {
            at: (p.0 + fraction * (q.0 - p.0), p.1 + fraction * (q.1 - p.1)),
            at_edge: !(a.is_finite() && b.is_finite()),
        }
    }
}

/// Returns the segments in a cell, as pairs of its sides. Side k lies between corners k and k + 1.
///
/// Each segment starts at a side where a circuit of the cell leaves the area. The circuit of the
/// neighbouring cell crosses this side in the opposite sense, so that the contour continues there.
fn in_cell(values: [f64; 4], level: f64) -> [Option<(usize, usize)>; 2] {
    let inside = values.map(|value| value >= level);
    let turns = |k: usize, from: bool| inside[k] == from && inside[(k + 1) % 4] != from;
    let leaving = |start: usize| (start..4).find(|k| turns(*k, true));
    let Some(first) = leaving(0) else { return [None, None] };
    match leaving(first + 1) {
        None => [(0..4).find(|k| turns(*k, false)).map(|entering| (first, entering)), None],
        // Two opposite corners are inside; they are joined if the mean of the corners is inside.
        Some(second) => {
            let joined = values.iter().sum::<f64>() / 4.0 >= level;
            let partner = |k: usize| if joined { (k + 1) % 4 } else { (k + 3) % 4 };
            [Some((first, partner(first))), Some((second, partner(second)))]
        }
    }
}

/// Returns the lines of a loop: the whole loop, or the parts of it that are not on the edge of the data.
fn lines(around: &[Crossing]) -> Vec<Vec<Point>> {
    let Some(start) = around.iter().position(|crossing| crossing.at_edge) else {
        return vec![around.iter().chain(around.first()).map(|crossing| crossing.at).collect()];
    };
    let turned: Vec<Crossing> = around[start..].iter().chain(&around[..start]).copied().collect();
    let inside = turned.split(|crossing| crossing.at_edge).filter(|run| run.len() > 1);
    inside.map(|run| run.iter().map(|crossing| crossing.at).collect()).collect()
}

/// Removes points from a line such that no removed point is further than `reach` from the new line.
pub(crate) fn thinned(line: &[Point], reach: f64) -> Vec<Point> {
    let Some(&first) = line.first() else { return vec![] };
    let (mut reduced, mut from) = (vec![first], 0);
    while from + 1 < line.len() {
        let fits =
            |to: &usize| line[from + 1..*to].iter().all(|p| distance(*p, line[from], line[*to]) <= reach);
        let to = (from + 2..line.len().min(from + 40)).take_while(fits).last().unwrap_or(from + 1);
        reduced.push(line[to]);
        from = to;
    }
    reduced
}

/// Returns the distance of a point from the segment between two others.
fn distance(point: Point, from: Point, to: Point) -> f64 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (px, py) = (point.0 - from.0, point.1 - from.1);
    let fraction = ((px * dx + py * dy) / (dx * dx + dy * dy).max(1e-12)).clamp(0.0, 1.0);
    (px - fraction * dx).hypot(py - fraction * dy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// A disc of radius 1: 40 rings of 72 nodes, with `value(x, y)`.
    fn disc(value: impl Fn(f64, f64) -> f64) -> PolarField {
        let column = |j: usize| {
            let (sin, cos) = (TAU * j as f64 / 72.0).sin_cos();
            let node = |i: usize| (i as f64 / 40.0 * cos, i as f64 / 40.0 * sin);
            (0..=40).map(|i| (node(i), value(node(i).0, node(i).1))).collect::<Vec<_>>()
        };
        PolarField::new(&(0..72).map(column).collect::<Vec<_>>(), true)
    }

    /// Even-odd area of loops that do not cross, from their orientations.
    fn area(contour: &Contour) -> f64 {
        let shoelace = |points: &Vec<Point>| {
            let next = points.iter().cycle().skip(1);
            points.iter().zip(next).map(|(p, q)| 0.5 * (p.0 * q.1 - q.0 * p.1)).sum::<f64>()
        };
        contour.areas.iter().map(shoelace).sum::<f64>().abs()
    }

    #[test]
    fn contours_enclose_areas_of_level_sets() {
        let cone = disc(|x, y| 1.0 - x.hypot(y));
        for (level, radius) in [(-1.0, 1.0_f64), (0.5, 0.5), (0.31, 0.69)] {
            let contour = cone.contour(level);
            assert!((area(&contour) / (PI * radius * radius) - 1.0).abs() < 2e-3, "{level}");
            assert_eq!(contour.lines.len(), usize::from(level > 0.0));
        }
        // A ring: the rim of a bowl, with a hole in it.
        let bowl = disc(f64::hypot).contour(0.5);
        assert!((area(&bowl) / (PI * 0.75) - 1.0).abs() < 2e-3);
        assert_eq!((bowl.areas.len(), bowl.lines.len()), (2, 1));
        // A half disc: the line ends at the rim and does not run along it.
        let slope = disc(|x, _| x).contour(1e-9);
        assert!((area(&slope) / (PI / 2.0) - 1.0).abs() < 3e-2);
        assert_eq!(slope.lines.len(), 1);
        assert!(slope.lines[0].iter().all(|p| p.0.abs() < 0.03), "{:?}", slope.lines);
        assert!(disc(|_, _| 1.0).contour(2.0).areas.is_empty());
    }

    #[test]
    fn holes_in_data_are_excluded() {
        let holed = disc(|x, y| if (x - 0.5).hypot(y) < 0.2 { f64::NAN } else { 1.0 });
        let contour = holed.contour(0.0);
        assert!((area(&contour) - PI * (1.0 - 0.04)).abs() < 0.08, "{}", area(&contour));
        assert!(contour.lines.is_empty());
        assert!(disc(|_, _| f64::NAN).contour(0.0).areas.is_empty());
    }

    #[test]
    fn contours_at_saddle_are_closed() {
        let saddle = disc(|x, y| x * y);
        for level in [-0.1, -1e-6, 0.0, 1e-6, 0.1] {
            assert_eq!(saddle.contour(level).areas.iter().filter(|loop_| loop_.len() > 40).count() % 2, 0);
        }
        let (above, below) = (area(&saddle.contour(0.1)), area(&disc(|x, y| -x * y).contour(-0.1)));
        assert!((above + below - PI).abs() < 1e-2, "{above} and {below} do not add up to the disc");
    }

    #[test]
    fn thinned_line_keeps_ends_and_shape() {
        let circle: Vec<Point> = (0..=360)
            .map(|k| f64::from(k).to_radians().sin_cos())
            .map(|(s, c)| (100.0 * c, 100.0 * s))
            .collect();
        let thin = thinned(&circle, 0.1);
        assert!(thin.len() < 90 && thin.first() == circle.first() && thin.last() == circle.last());
        assert!(thin.iter().all(|p| (p.0.hypot(p.1) - 100.0).abs() < 1e-9));
    }
}
