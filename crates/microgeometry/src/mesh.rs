//! Meshes of triangles that repeat along x and y, overhangs and undercuts included.
//!
//! **Geometry.** The triangles form one closed surface between the media above and below: each edge belongs
//! to two triangles that run along it in opposite directions, modulo the period. Corners nearer to each other
//! than a millionth of the period are one corner. Normals point into the medium above.
//!
//! **Rays.** A ray meets only triangles that it sees from its own side, so that it cannot meet the one on
//! which it starts. Whether a line passes an edge on its left or on its right is computed from the same
//! numbers for both triangles of the edge: no ray slips through. Triangles that penetrate each other are not
//! found; rays that they mislead arrive on the wrong side, and count as lost.

use std::collections::HashMap;
use std::ops::RangeInclusive;

use crate::MicrogeometryError;
use crate::grid::{Bounds, Entry, Grid, Walked};
use crate::ray::{Face, Met, Ray, Side, dot, moved, normalised};

/// Distance, relative to the larger period, within which corners are one: numbers of STL files have 24 bits.
const SAME: f64 = 1e-6;

/// Range of periods, um, whose squares and smallest parts are normal numbers.
const PERIODS_UM: RangeInclusive<f64> = 1e-60..=1e60;

/// Largest ratio of the periods along x and y: corners within [`SAME`] of the larger one are the same place.
const MOST_ASPECT: f64 = 1e5;

/// Largest extent of a mesh, in periods: a ray may cross as many cells.
const MOST_PERIODS: f64 = 100.0;

/// Largest distance of a corner from the origin, in periods.
const MOST_OFFSET: f64 = 1e6;

/// Way, relative to the larger period, by which a ray on a triangle may be off by rounding.
const ROUNDING: f64 = 1e-10;

/// Area of a triangle, relative to the square of its longest edge, below which it has no normal.
const NO_AREA: f64 = 1e-12;

/// A corner of a triangle: the number of its vertex, and the period in which it stands.
type Corner = (u32, [i64; 2]);

/// A mesh that repeats along x and y.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    period_um: [f64; 2],
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[Corner; 3]>,
    /// Triangles that were dropped because two of their corners are one.
    dropped: usize,
    /// Whether all normals pointed down and were turned.
    turned: bool,
}

impl Mesh {
    /// Joins triangles, um, to a surface with this period, or else that of their extent.
    ///
    /// # Errors
    /// Corners that are not finite; a mesh of no extent; triangles without area; open edges, the first of
    /// which is named; several surfaces, or one that does not separate above from below.
    pub fn new(triangles: &[[[f64; 3]; 3]], period_um: Option<[f64; 2]>) -> Result<Self, MicrogeometryError> {
        let corners = || triangles.iter().flatten();
        if let Some(value) = corners().flatten().find(|value| !value.is_finite()) {
            let what = "coordinate of a corner (um)";
            return Err(MicrogeometryError::NotANumber {
                of: "a mesh",
                what,
                value: *value,
                wanted: "finite",
            });
        }
        let extent = |k: usize| {
            let of = corners().map(|corner| corner[k]);
            of.clone().fold(f64::NEG_INFINITY, f64::max) - of.fold(f64::INFINITY, f64::min)
        };
        let period_um = period_um.unwrap_or([extent(0), extent(1)]);
        if let Some(value) = period_um.into_iter().find(|period| !(period.is_finite() && *period > 0.0)) {
            let what = "period (um)";
            return Err(MicrogeometryError::NotANumber { of: "a mesh", what, value, wanted: "positive" });
        }
        Self::check_proportions(period_um, [0, 1, 2].map(extent), corners())?;
        let (vertices, corners) = joined(corners(), period_um);
        let (triangles, _) = corners.as_chunks::<3>();
        let mut mesh = Self { period_um, vertices, triangles: Vec::new(), dropped: 0, turned: false };
        for corners in triangles {
            if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
                mesh.dropped += 1;
            } else {
                mesh.triangles.push(*corners);
            }
        }
        mesh.check_areas()?;
        mesh.check_edges()?;
        mesh.turn_up()?;
        Ok(mesh)
    }

    /// Fails for proportions whose rounding errors, or whose work for each ray, have no bound.
    fn check_proportions<'a>(
        period_um: [f64; 2],
        extent: [f64; 3],
        mut corners: impl Iterator<Item = &'a [f64; 3]>,
    ) -> Result<(), MicrogeometryError> {
        let [x, y] = period_um;
        if x.max(y) > MOST_ASPECT * x.min(y) {
            return Err(Self::wrong(format!(
                "a mesh with a period of {x:e} um x {y:e} um is too elongated (expected a ratio of at most {MOST_ASPECT:e}): a wrong corner, or a \
                 wrong `period_um`"
            )));
        }
        if !(PERIODS_UM.contains(&x) && PERIODS_UM.contains(&y)) {
            let [least, most] = [PERIODS_UM.start(), PERIODS_UM.end()];
            return Err(Self::wrong(format!(
                "a mesh cannot have a period of {x:e} um x {y:e} um (expected {least:e} to {most:e} um): a wrong unit, or a wrong `period_um`"
            )));
        }
        let ratios = [(extent[0], x), (extent[1], y), (extent[2], x.max(y))];
        if let Some((extent, period)) =
            ratios.into_iter().find(|(extent, period)| *extent > MOST_PERIODS * period)
        {
            return Err(Self::wrong(format!(
                "the mesh extends over {extent:e} um, with a period of {period:e} um (expected at most {MOST_PERIODS} periods): a wrong corner, or a \
                 wrong `period_um`"
            )));
        }
        let limits = [x, y, x.max(y)].map(|period| MOST_OFFSET * period);
        if let Some(far) = corners.find(|corner| (0..3).any(|k| corner[k].abs() > limits[k])) {
            return Err(Self::wrong(format!(
                "the corner {} is too far from the origin (expected at most {MOST_OFFSET:e} periods)",
                in_words(*far)
            )));
        }
        Ok(())
    }

    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.triangles.len()
    }

    /// Period along x and y, um.
    pub fn period_um(&self) -> [f64; 2] {
        self.period_um
    }

    /// What was changed to make a surface of the triangles.
    pub fn notes(&self) -> Vec<String> {
        let dropped = (self.dropped > 0)
            .then(|| format!("{} triangles with two corners at the same place were dropped", self.dropped));
        let turned = self.turned.then(|| "all normals of the mesh pointed down, and were turned".to_owned());
        dropped.into_iter().chain(turned).collect()
    }

    fn place(&self, (vertex, period): Corner) -> [f64; 3] {
        let [x, y, z] = self.vertices[vertex as usize];
        [x + period[0] as f64 * self.period_um[0], y + period[1] as f64 * self.period_um[1], z]
    }

    /// Twice the area of a triangle along its normal.
    fn area(&self, corners: &[Corner; 3]) -> [f64; 3] {
        let [a, b, c] = corners.map(|corner| self.place(corner));
        cross(minus(b, a), minus(c, a))
    }

    fn wrong(wrong: String) -> MicrogeometryError {
        MicrogeometryError::Mesh { wrong }
    }

    fn check_areas(&self) -> Result<(), MicrogeometryError> {
        for corners in &self.triangles {
            let area = self.area(corners);
            let places = corners.map(|corner| self.place(corner));
            let edge = |k: usize| {
                let edge = minus(places[(k + 1) % 3], places[k]);
                dot(edge, edge)
            };
            if dot(area, area).sqrt() <= NO_AREA * edge(0).max(edge(1)).max(edge(2)) {
                let [a, b, c] = places.map(in_words);
                return Err(Self::wrong(format!(
                    "the triangle with the corners {a}, {b} and {c} has no area (expected corners that are not on a line)"
                )));
            }
        }
        Ok(())
    }

    /// Each edge belongs to two triangles, in opposite directions, and all triangles hang together.
    fn check_edges(&self) -> Result<(), MicrogeometryError> {
        let mut owners: HashMap<[Corner; 2], usize> = HashMap::new();
        // From the period of its first corner, so that an edge is the same in all periods.
        let key =
            |from: Corner, to: Corner| [(from.0, [0; 2]), (to.0, [to.1[0] - from.1[0], to.1[1] - from.1[1]])];
        let edges = |corners: &[Corner; 3]| [0, 1, 2].map(|k| (corners[k], corners[(k + 1) % 3]));
        let named = |from: Corner, to: Corner| {
            format!("the edge from {} to {}", in_words(self.place(from)), in_words(self.place(to)))
        };
        for (number, corners) in self.triangles.iter().enumerate() {
            for (from, to) in edges(corners) {
                if owners.insert(key(from, to), number).is_some() {
                    return Err(Self::wrong(format!(
                        "{} belongs to two triangles with opposite normals, or to more than two (expected two triangles that run along it in opposite directions)",
                        named(from, to)
                    )));
                }
            }
        }
        let mut parts: Vec<usize> = (0..self.triangles.len()).collect();
        let root = |parts: &mut Vec<usize>, mut at: usize| {
            while parts[at] != at {
                parts[at] = parts[parts[at]];
                at = parts[at];
            }
            at
        };
        for (number, corners) in self.triangles.iter().enumerate() {
            for (from, to) in edges(corners) {
                let Some(other) = owners.get(&key(to, from)) else {
                    let [x, y] = self.period_um;
                    return Err(Self::wrong(format!(
                        "{} is open: it belongs to one triangle (expected two, in a surface that repeats every {x} um along x and {y} um along y)",
                        named(from, to)
                    )));
                };
                let [one, other] = [number, *other].map(|at| root(&mut parts, at));
                parts[one] = other;
            }
        }
        let count = (0..parts.len()).filter(|at| parts[*at] == *at).count();
        if count == 1 {
            return Ok(());
        }
        Err(Self::wrong(format!(
            "the mesh has {count} surfaces that do not hang together (expected one, between the media above and below)"
        )))
    }

    /// Turns a surface whose normals point down.
    fn turn_up(&mut self) -> Result<(), MicrogeometryError> {
        let up = 0.5 * self.triangles.iter().map(|corners| self.area(corners)[2]).sum::<f64>();
        let sheets = up / (self.period_um[0] * self.period_um[1]);
        if (sheets.abs() - 1.0).abs() > 1e-3 {
            return Err(Self::wrong(format!(
                "the mesh covers {sheets:.3} of its period from above (expected 1, a surface between the media above and below): a closed \
                 body, or a wrong `period_um`"
            )));
        }
        if sheets < 0.0 {
            self.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
            self.turned = true;
        }
        Ok(())
    }
}

/// Corners that are nearer to each other than rounding become one vertex, modulo the period.
fn joined<'a>(
    corners: impl Iterator<Item = &'a [f64; 3]>,
    period_um: [f64; 2],
) -> (Vec<[f64; 3]>, Vec<Corner>) {
    let near = SAME * period_um[0].max(period_um[1]);
    let counts = period_um.map(|period| (period / near).round() as i64);
    let cell = |at: [f64; 3]| at.map(|value| (value / near).floor() as i64);
    let mut known: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    let mut found = Vec::new();
    for corner in corners {
        let period = [0, 1].map(|k| (corner[k] / period_um[k]).floor() as i64);
        let home = [
            corner[0] - period[0] as f64 * period_um[0],
            corner[1] - period[1] as f64 * period_um[1],
            corner[2],
        ];
        let own = cell(home);
        let around = |k: i64| [k / 9 % 3 - 1, k / 3 % 3 - 1, k % 3 - 1];
        let same = (0..27).find_map(|k| {
            let step = around(k);
            let beside = [0, 1, 2].map(|axis| own[axis] + step[axis]);
            let wrapped = [beside[0].rem_euclid(counts[0]), beside[1].rem_euclid(counts[1]), beside[2]];
            known.get(&wrapped)?.iter().copied().find_map(|vertex| {
                let there = vertices[vertex as usize];
                let turns = [0, 1].map(|axis| ((home[axis] - there[axis]) / period_um[axis]).round() as i64);
                let away = [
                    home[0] - there[0] - turns[0] as f64 * period_um[0],
                    home[1] - there[1] - turns[1] as f64 * period_um[1],
                    home[2] - there[2],
                ];
                let is_near = dot(away, away) <= near * near;
                is_near.then(|| (vertex, [period[0] + turns[0], period[1] + turns[1]]))
            })
        });
        found.push(same.unwrap_or_else(|| {
            let vertex = vertices.len() as u32;
            let wrapped = [own[0].rem_euclid(counts[0]), own[1].rem_euclid(counts[1]), own[2]];
            known.entry(wrapped).or_default().push(vertex);
            vertices.push(home);
            (vertex, period)
        }));
    }
    (vertices, found)
}

/// A place in messages, um.
fn in_words([x, y, z]: [f64; 3]) -> String {
    format!("({x:.6}, {y:.6}, {z:.6}) um")
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A mesh, ready for rays.
#[derive(Debug)]
pub(crate) struct MeshFace<'a> {
    mesh: &'a Mesh,
    normals: Vec<[f64; 3]>,
    heights: [f64; 2],
    grid: Grid,
}

impl<'a> MeshFace<'a> {
    pub(crate) fn new(mesh: &'a Mesh) -> Self {
        let bounds = |corners: &[Corner; 3]| -> Bounds {
            let places = corners.map(|corner| mesh.place(corner));
            let of = |pick: fn(f64, f64) -> f64| {
                [0, 1, 2].map(|k| pick(pick(places[0][k], places[1][k]), places[2][k]))
            };
            [of(f64::min), of(f64::max)]
        };
        let boxes: Vec<Bounds> = mesh.triangles.iter().map(bounds).collect();
        let lowest = boxes.iter().map(|[low, _]| low[2]).fold(f64::INFINITY, f64::min);
        let highest = boxes.iter().map(|[_, high]| high[2]).fold(f64::NEG_INFINITY, f64::max);
        let [x, y] = mesh.period_um;
        let side = 1.5 * (x * y / mesh.triangles.len() as f64).sqrt();
        Self {
            mesh,
            normals: mesh.triangles.iter().map(|corners| normalised(mesh.area(corners))).collect(),
            heights: [lowest, highest],
            grid: Grid::new(mesh.period_um, [lowest, highest], &boxes, side),
        }
    }

    /// The nearest facet of a cell that a ray sees from its side, before the end of the cell.
    fn nearest(&self, ray: &Ray, side: Side, entries: &[Entry], cell: [i64; 2], end: f64) -> Option<Met> {
        let [x, y] = self.mesh.period_um;
        let tiny = ROUNDING * x.max(y);
        let sign = if side == Side::Above { -1.0 } else { 1.0 };
        let mut first: Option<(f64, usize)> = None;
        for (number, period) in entries {
            let number = *number as usize;
            let normal = self.normals[number];
            let slope = dot(ray.along, normal);
            if sign * slope <= 0.0 {
                continue;
            }
            // From the start of the ray; the same numbers for a corner in all triangles that have it.
            let [a, b, c] = self.mesh.triangles[number].map(|(vertex, own)| {
                let turns = [0, 1].map(|k| (own[k] + period[k] + cell[k]) as f64);
                let place = self.mesh.vertices[vertex as usize];
                [
                    place[0] + turns[0] * x - ray.at[0],
                    place[1] + turns[1] * y - ray.at[1],
                    place[2] - ray.at[2],
                ]
            });
            let passes = [cross(a, b), cross(b, c), cross(c, a)].map(|edge| sign * dot(ray.along, edge));
            if passes.iter().any(|pass| *pass < 0.0) {
                continue;
            }
            let way = dot(a, normal) / slope;
            if way > -tiny && way <= end + tiny && first.is_none_or(|(known, _)| way < known) {
                first = Some((way, number));
            }
        }
        let (way, number) = first?;
        Some(Met::Facet { at: moved(ray.at, way.max(0.0), ray.along), normal: self.normals[number] })
    }
}

impl Face for MeshFace<'_> {
    fn period_um(&self) -> [f64; 2] {
        self.grid.period_um()
    }

    fn heights_um(&self) -> [f64; 2] {
        self.heights
    }

    fn next(&self, ray: &Ray, side: Side) -> Met {
        let [lowest, highest] = self.heights;
        let leaves = match side {
            Side::Above => ray.along[2] > 0.0,
            Side::Below => ray.along[2] < 0.0,
        };
        let is_beyond = match side {
            Side::Above => ray.at[2] >= highest,
            Side::Below => ray.at[2] <= lowest,
        };
        if leaves && is_beyond {
            return Met::Nothing;
        }
        match self.grid.walk(ray, |entries, cell, end| self.nearest(ray, side, entries, cell, end)) {
            Walked::Found(met) => met,
            Walked::Left if leaves => Met::Nothing,
            // It has passed the surface without meeting it.
            Walked::Left | Walked::Unknown => Met::Unknown,
        }
    }
}
