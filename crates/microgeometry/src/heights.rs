//! Rays and height maps: each cell between four heights is two triangles.
//!
//! **Walk.** In units of cells, the edges of all triangles are the lines of integer x, integer y and integer
//! x + y. Between two of them the height of a ray above the surface is a linear function of the way. The
//! surface is met where this height changes its sign, so that no ray can slip through an edge.
//!
//! **Blocks.** Where a ray is above (or below) all heights of a block of cells, it crosses the block in one
//! step, or comes in one step to where it is not.

use crate::HeightMap;
use crate::ray::{Face, Met, Ray, Side, moved, normalised};

/// Edges that a ray may cross before it counts as lost.
const MOST_EDGES: usize = 10_000_000;

/// Heights that stay in the cache of a processor: half a megabyte.
const TILE: usize = 1 << 16;

/// Cells along a side of a block.
const BLOCK: usize = 8;

/// A height map as triangles.
#[derive(Debug)]
pub(crate) struct Triangles<'a> {
    map: &'a HeightMap,
    /// Cells per um along x and y.
    per_um: [f64; 2],
    lowest: f64,
    highest: f64,
    mean: f64,
    /// Largest slope: a ray that goes away more steeply never comes back to the surface.
    steepest: f64,
    /// Lowest and highest height of each block, by rows; none if the map is not a whole number of blocks.
    blocks: Vec<[f64; 2]>,
}

impl<'a> Triangles<'a> {
    pub(crate) fn new(map: &'a HeightMap) -> Self {
        let heights = map.heights_um();
        let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let per_um = map.pitch_um().map(f64::recip);
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        let mut all = Self { map, per_um, lowest, highest, mean, steepest: 0.0, blocks: blocks(map) };
        all.steepest = all.largest_slope();
        all
    }

    /// Largest slope of all triangles, and a little more against rounding.
    fn largest_slope(&self) -> f64 {
        let (columns, rows) = (self.map.columns() as i64, self.map.rows() as i64);
        let mut largest = 0.0_f64;
        for row in 0..rows {
            for column in 0..columns {
                let corners = self.corners([column, row]);
                for is_upper in [false, true] {
                    let [x, y] = [0, 1].map(|k| corners.plane(is_upper).slopes[k] * self.per_um[k]);
                    largest = largest.max(x * x + y * y);
                }
            }
        }
        largest.sqrt() * (1.0 + 1e-9)
    }

    /// With or without blocks.
    #[cfg(test)]
    pub(crate) fn with_blocks(map: &'a HeightMap, blocks: bool) -> Self {
        let all = Self::new(map);
        if blocks { all } else { Self { blocks: Vec::new(), ..all } }
    }

    /// Lowest and highest height of a block, if there are blocks.
    #[inline]
    fn block(&self, block: [i64; 2]) -> Option<[f64; 2]> {
        let count = [self.map.columns() / BLOCK, self.map.rows() / BLOCK];
        let at = [0, 1].map(|k| {
            let (number, count) = (block[k], count[k].max(1) as i64);
            (if (0..count).contains(&number) { number } else { number.rem_euclid(count) }) as usize
        });
        self.blocks.get(at[1] * count[0] + at[0]).copied()
    }

    /// Heights at the corners of a cell.
    #[inline(always)]
    fn corners(&self, cell: [i64; 2]) -> Corners {
        let (columns, rows) = (self.map.columns() as i64, self.map.rows() as i64);
        let column = |k: i64| if (0..columns).contains(&k) { k } else { k.rem_euclid(columns) } as usize;
        let row = |k: i64| if (0..rows).contains(&k) { k } else { k.rem_euclid(rows) } as usize;
        let ([left, right], [low, high]) =
            ([column(cell[0]), column(cell[0] + 1)], [row(cell[1]), row(cell[1] + 1)]);
        let heights = self.map.heights_um();
        let at = |x: usize, y: usize| heights[y * columns as usize + x];
        Corners([[at(left, low), at(right, low)], [at(left, high), at(right, high)]])
    }
}

/// Heights at the corners of a cell, `[low, high][left, right]`.
#[derive(Debug, Clone, Copy)]
struct Corners([[f64; 2]; 2]);

impl Corners {
    /// The triangle below or above the diagonal.
    #[inline]
    fn plane(&self, is_upper: bool) -> Plane {
        let [[corner, right], [left, opposite]] = self.0;
        if is_upper {
            let slopes = [opposite - left, opposite - right];
            Plane { height: opposite - slopes[0] - slopes[1], slopes }
        } else {
            Plane { height: corner, slopes: [right - corner, left - corner] }
        }
    }
}

/// Lowest and highest height of each block, its edges included.
fn blocks(map: &HeightMap) -> Vec<[f64; 2]> {
    let [columns, rows] = [map.columns(), map.rows()];
    if columns % BLOCK != 0 || rows % BLOCK != 0 {
        return Vec::new();
    }
    let of = |block: usize| {
        let (row, column) = (block / (columns / BLOCK) * BLOCK, block % (columns / BLOCK) * BLOCK);
        let heights = (0..=BLOCK).flat_map(|down| (0..=BLOCK).map(move |right| [row + down, column + right]));
        let heights = heights.map(|[y, x]| map.heights_um()[y % rows * columns + x % columns]);
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
            [low.min(height), high.max(height)]
        })
    };
    (0..columns / BLOCK * (rows / BLOCK)).map(of).collect()
}

/// A triangle: the height at the lower left corner of its cell, and the slopes per cell.
#[derive(Debug, Clone, Copy)]
struct Plane {
    height: f64,
    slopes: [f64; 2],
}

impl Face for Triangles<'_> {
    fn period_um(&self) -> [f64; 2] {
        self.map.period_um()
    }

    fn heights_um(&self) -> [f64; 2] {
        [self.lowest, self.highest]
    }

    fn tiles_per_side(&self) -> u64 {
        let tiles = self.map.heights_um().len().div_ceil(TILE) as u64;
        if tiles > 1 { tiles.isqrt().max(2) } else { 1 }
    }

    fn expect(&self, ray: &Ray) -> f64 {
        // Where the ray crosses the mean height.
        let way = (self.mean - ray.at[2]) / ray.along[2];
        let count = [self.map.columns() as i64, self.map.rows() as i64];
        let [x, y] = [0, 1].map(|k| {
            let cell = floor((ray.at[k] + way * ray.along[k]) * self.per_um[k]);
            if (0..count[k]).contains(&cell) { cell } else { cell.rem_euclid(count[k]) }
        });
        let above = if y + 1 < count[1] { y + 1 } else { 0 };
        let at = |row: i64| self.map.heights_um()[(row * count[0] + x) as usize];
        at(y) + at(above)
    }

    fn next(&self, ray: &Ray, side: Side) -> Met {
        let leaves = match side {
            Side::Above => ray.along[2] > 0.0,
            Side::Below => ray.along[2] < 0.0,
        };
        let across_squared = ray.along[0] * ray.along[0] + ray.along[1] * ray.along[1];
        if leaves && ray.along[2] * ray.along[2] > self.steepest * self.steepest * across_squared {
            return Met::Nothing;
        }
        // The way after which the ray is beyond all heights of its side.
        let last = if side == Side::Above { self.highest } else { self.lowest };
        let end = if leaves { (last - ray.at[2]) / ray.along[2] } else { f64::INFINITY };
        if end <= 0.0 {
            return Met::Nothing;
        }
        // In cells along x and y; z stays in um, and so does the way.
        let from = [ray.at[0] * self.per_um[0], ray.at[1] * self.per_um[1]];
        let along = [ray.along[0] * self.per_um[0], ray.along[1] * self.per_um[1]];
        let sign = if side == Side::Above { 1.0 } else { -1.0 };
        let mut edges = Edges::of_triangles(from, along);
        let mut way = 0.0_f64;
        let mut height = None;
        let mut known = None;
        let mut corners: Option<([i64; 2], Corners)> = None;
        for _ in 0..MOST_EDGES {
            let cell = [edges[0].number, edges[1].number];
            let block = cell.map(|number| number >> BLOCK.trailing_zeros());
            if known != Some(block) {
                known = Some(block);
                match self.clearance(ray, side, block, &edges, way) {
                    Clearance::Leaves(exit) if leaves && exit >= end => return Met::Nothing,
                    Clearance::Leaves(exit) => {
                        // The block is left through one side; the places along the other are those of the
                        // ray.
                        let exits = [0, 1].map(|k| edges[k].block_exit(block[k]));
                        let axis = usize::from(exits[1] < exits[0]);
                        let mut next = within(block, from, along, exit);
                        next[axis] = if along[axis] > 0.0 {
                            BLOCK as i64 * (block[axis] + 1)
                        } else {
                            BLOCK as i64 * block[axis] - 1
                        };
                        Edges::move_to(&mut edges, next, exit);
                        (way, height) = (exit, None);
                        continue;
                    }
                    Clearance::Until(reach) => {
                        Edges::move_to(&mut edges, within(block, from, along, reach), reach);
                        (way, height) = (reach, None);
                        continue;
                    }
                    Clearance::None => {}
                }
            }
            let until = edges[0].way.min(edges[1].way).min(edges[2].way);
            if until > way {
                let here = match corners {
                    Some((known, here)) if known == cell => here,
                    _ => corners.insert((cell, self.corners(cell))).1,
                };
                let plane = here.plane(edges[2].number > cell[0] + cell[1]);
                let slope = sign * (ray.along[2] - plane.slopes[0] * along[0] - plane.slopes[1] * along[1]);
                // Rounding may put a ray that starts on the surface behind it.
                let before = height.unwrap_or_else(|| {
                    let [x, y] = [0, 1].map(|k| from[k] + way * along[k] - cell[k] as f64);
                    let surface = plane.height + plane.slopes[0] * x + plane.slopes[1] * y;
                    (sign * (ray.at[2] + way * ray.along[2] - surface)).max(0.0)
                });
                // A ray of infinite way runs along z, and meets the surface or leaves.
                let after = before + slope * (until - way);
                if after < 0.0 {
                    let hit = way + before / -slope;
                    let [x, y] = [0, 1].map(|k| -plane.slopes[k] * self.per_um[k]);
                    let normal = normalised([x, y, 1.0]);
                    return Met::Facet { at: moved(ray.at, hit, ray.along), normal };
                }
                if leaves && until >= end {
                    return Met::Nothing;
                }
                height = Some(after);
                way = until;
            }
            edges.iter_mut().for_each(|edge| edge.step_at(until));
        }
        Met::Unknown
    }
}

/// How far a ray is clear of all heights of a block.
enum Clearance {
    /// Until it leaves the block, after this way.
    Leaves(f64),
    /// Until this way.
    Until(f64),
    None,
}

impl Triangles<'_> {
    /// How far a ray in a block is clear of its heights, after this way.
    #[inline]
    fn clearance(&self, ray: &Ray, side: Side, block: [i64; 2], edges: &[Edges; 3], way: f64) -> Clearance {
        let Some([low, high]) = self.block(block) else { return Clearance::None };
        let (sign, extreme) = if side == Side::Above { (1.0, high) } else { (-1.0, low) };
        let gap = |way: f64| sign * (ray.at[2] + way * ray.along[2] - extreme);
        if gap(way) <= 0.0 {
            return Clearance::None;
        }
        let exit = edges[0].block_exit(block[0]).min(edges[1].block_exit(block[1]));
        if exit.is_finite() && gap(exit) > 0.0 {
            return if exit > way { Clearance::Leaves(exit) } else { Clearance::None };
        }
        // It comes down to the highest height of the block before it leaves it; a ray along z does so, too.
        let reach = (extreme - ray.at[2]) / ray.along[2];
        if reach > way && reach < exit { Clearance::Until(reach) } else { Clearance::None }
    }
}

/// The integer below a number: without the call that `f64::floor` is where the processor is not known to have
/// SSE 4.1.
#[inline]
fn floor(x: f64) -> i64 {
    let towards_zero = x as i64;
    towards_zero - i64::from(towards_zero as f64 > x)
}

/// The cell of a block in which a ray is after a way. Rounding must not put it into another block.
#[inline]
fn within(block: [i64; 2], from: [f64; 2], along: [f64; 2], way: f64) -> [i64; 2] {
    [0, 1].map(|k| {
        let first = BLOCK as i64 * block[k];
        floor(from[k] + way * along[k]).clamp(first, first + BLOCK as i64 - 1)
    })
}

/// Parallel lines of integer coordinate that a ray crosses.
#[derive(Debug, Clone, Copy)]
struct Edges {
    /// Integer below the ray's coordinate, between this crossing and the one before.
    number: i64,
    /// The way to the next crossing.
    way: f64,
    from: f64,
    /// The way per 1 of the coordinate, with its sign; infinite along the lines.
    per_unit: f64,
}

impl Edges {
    /// The three families of edges of triangles, at the start of a ray.
    fn of_triangles(from: [f64; 2], along: [f64; 2]) -> [Self; 3] {
        [
            Self::new(from[0], along[0]),
            Self::new(from[1], along[1]),
            Self::new(from[0] + from[1], along[0] + along[1]),
        ]
    }

    /// The same lines on the way through a cell, after a way.
    #[inline]
    fn move_to(all: &mut [Self; 3], cell: [i64; 2], way: f64) {
        let below = cell[0] + cell[1];
        let sum = all[2].from + if all[2].per_unit.is_infinite() { 0.0 } else { way / all[2].per_unit };
        let diagonal = floor(sum).clamp(below, below + 1);
        for (edges, number) in all.iter_mut().zip([cell[0], cell[1], diagonal]) {
            edges.number = number;
            edges.find_next();
        }
    }

    /// The way after which a block of cells is left across these lines.
    #[inline]
    fn block_exit(&self, block: i64) -> f64 {
        if self.per_unit.is_infinite() {
            return f64::INFINITY;
        }
        let edge = BLOCK as i64 * (block + i64::from(self.per_unit > 0.0));
        (edge as f64 - self.from) * self.per_unit
    }

    fn new(from: f64, along: f64) -> Self {
        let number = floor(from);
        // On a line, a ray that goes back begins in the cell below.
        let number = if along < 0.0 && from == number as f64 { number - 1 } else { number };
        let mut edges = Self { number, way: f64::INFINITY, from, per_unit: 1.0 / along };
        edges.find_next();
        edges
    }

    fn find_next(&mut self) {
        if self.per_unit.is_infinite() {
            return;
        }
        let next = self.number + i64::from(self.per_unit > 0.0);
        self.way = (next as f64 - self.from) * self.per_unit;
    }

    /// Crosses the next line, if it is at this way.
    fn step_at(&mut self, way: f64) {
        if self.way <= way {
            self.number += if self.per_unit > 0.0 { 1 } else { -1 };
            self.find_next();
        }
    }
}
