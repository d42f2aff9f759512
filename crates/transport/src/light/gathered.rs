//! Light of pixels for sums with functions of the direction.
//!
//! # Model
//! Over a horizontal display, the rows of a picture are rows of inclination, and sums use the pixels
//! themselves. In any other orientation, the light is gathered once on a grid of directions: each pixel is
//! divided into parts of at most half a step of the grid, and the light of each part becomes weights of the
//! nearest 4 x 4 nodes, those of cubic interpolation at its middle. Sums with functions that change over
//! many steps keep their values, wherever a pixel lies between the nodes.
//!
//! Narrow peaks change over few steps. Around a peak, the light of pixels is removed from the nodes, and is
//! represented by points of its own, as dense as the peak is narrow ([`Gathered::split`]). The distance up to
//! which this is done grows with the digits: the difference of two levels contains the error of the grid.

use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, TAU};

use super::pixels::{Pixels, rotated};
use super::rings::Peaks;
use crate::Cone;
use crate::numerics::quadrature::{MULTIPLE_POLES, gauss, points_for};

/// Number of columns and rows of the grid, and the angle between its nodes.
pub(crate) const COLUMNS: usize = 2048;
pub(crate) const ROWS: usize = COLUMNS / 4;
pub(crate) const STEP: f64 = TAU / COLUMNS as f64;
/// Smallest number of parts of a picture per step of the grid, along each direction.
const PARTS: usize = 2;
/// Distance of points of their own from a peak, in steps of the grid: for no digits, and for each digit.
const RANGE: [f64; 2] = [6.0, 1.5];
/// Largest number of points of their own, about.
const MOST_POINTS: f64 = 2e6;

/// Light of pixels on the grid.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Gathered {
    /// Irradiance at each node, `[row][column]`; their sum is 1.
    nodes: Vec<f64>,
    /// Factor of radiances times areas of direction cosines.
    scale: f64,
}

/// Light as nodes of the grid, and points of its own.
pub(crate) struct Split<'a> {
    nodes: Cow<'a, [f64]>,
    /// By inclination.
    points: Vec<Spot>,
}

/// Light from one direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spot {
    /// Inclination and azimuth, radians.
    pub(crate) theta: f64,
    pub(crate) phi: f64,
    pub(crate) light: f64,
}

/// Light of a channel, gathered for sums, and approximate radiances in cells between the nodes, from which
/// directions can be sampled.
pub(crate) struct Channel {
    pub(crate) gathered: Gathered,
    pub(crate) cells: Vec<f64>,
}

/// Gathers pictures with the same frame and the same number of columns.
pub(crate) fn gather(pictures: &[Pixels]) -> Vec<Channel> {
    let Some(first) = pictures.first() else { return Vec::new() };
    let parts = Parts::new(first);
    let mut nodes = vec![vec![0.0; ROWS * COLUMNS]; pictures.len()];
    let mut cells = nodes.clone();
    let is_lit = |pixel: &usize| pictures.iter().any(|picture| picture.radiance[*pixel] > 0.0);
    for pixel in (0..first.radiance.len()).filter(is_lit) {
        parts.of(pixel, |place, area| {
            let (linear, cubic) = (linear(place), Cubic::new(place));
            for ((nodes, cells), picture) in nodes.iter_mut().zip(&mut cells).zip(pictures) {
                let light = f64::from(picture.radiance[pixel]) * area;
                linear.iter().for_each(|(cell, weight)| cells[*cell] += light * weight);
                cubic.add(nodes, light);
            }
        });
    }
    let channel = |(mut nodes, cells): (Vec<f64>, Vec<f64>)| {
        let sum: f64 = nodes.iter().sum();
        let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        nodes.iter_mut().for_each(|node| *node *= scale);
        Channel { gathered: Gathered { nodes, scale }, cells: radiances(cells) }
    };
    nodes.into_iter().zip(cells).map(channel).collect()
}

impl Gathered {
    /// Returns the inclinations between which there is light; `None` if it is dark.
    pub(crate) fn span(&self) -> Option<[f64; 2]> {
        let is_lit = |row: &[f64]| row.iter().any(|light| *light != 0.0);
        let first = self.nodes.chunks_exact(COLUMNS).position(is_lit)?;
        let last = self.nodes.chunks_exact(COLUMNS).rposition(is_lit)?;
        Some([STEP * first as f64, (STEP * (last + 1) as f64).min(FRAC_PI_2)])
    }

    /// Separates light near peaks from the nodes of the grid; `scale` is the factor of the radiances.
    pub(crate) fn split(&self, pixels: &Pixels, scale: f64, peaks: Peaks<'_>, digits: f64) -> Split<'_> {
        let range = STEP * (RANGE[0] + RANGE[1] * digits);
        if peaks.width >= range || peaks.views.is_empty() {
            return Split { nodes: Cow::Borrowed(&self.nodes), points: Vec::new() };
        }
        let range = (range * range - peaks.width * peaks.width).sqrt();
        let close = pixels_near(pixels, peaks.views, range);
        let most = (MOST_POINTS / close.len().max(1) as f64).sqrt().max(1.0) as usize;
        let parts = Parts::new(pixels);
        let mut nodes = self.nodes.clone();
        let mut points = Vec::new();
        for Close { pixel, distance } in close {
            let radiance = f64::from(pixels.radiance[pixel]);
            parts.of(pixel, |place, area| Cubic::new(place).add(&mut nodes, -radiance * area * self.scale));
            let smooth = distance.hypot(peaks.width);
            let count = |size: f64| {
                points_for(digits + MULTIPLE_POLES, 2.0 * (2.0 * smooth / size).asinh()).min(most)
            };
            points.extend(
                points_of(pixels, pixel, count)
                    .map(|spot| Spot { light: scale * radiance * spot.light, ..spot }),
            );
        }
        points.sort_unstable_by(|one, other| one.theta.total_cmp(&other.theta));
        Split { nodes: Cow::Owned(nodes), points }
    }
}

impl Split<'_> {
    /// Returns the rows of the grid from one inclination to another: where they lie, and their light by
    /// column.
    pub(crate) fn rows(&self, from: f64, to: f64) -> impl Iterator<Item = (f64, &[f64])> {
        let rows = self.nodes.chunks_exact(COLUMNS).enumerate();
        rows.map(|(row, light)| (STEP * (row as f64 + 0.5), light))
            .filter(move |(at, _)| (from..to).contains(at))
    }

    /// Returns the points of their own from one inclination to another.
    pub(crate) fn points(&self, from: f64, to: f64) -> &[Spot] {
        let [first, end] = [from, to].map(|edge| self.points.partition_point(|spot| spot.theta < edge));
        &self.points[first..end]
    }
}

/// A pixel, and the distance of its nearest point from the nearest peak, radians.
struct Close {
    pixel: usize,
    distance: f64,
}

/// Returns the lit pixels within this distance from the mirror directions of views.
fn pixels_near(pixels: &Pixels, views: &[Cone], range: f64) -> Vec<Close> {
    struct Peak {
        direction: [f64; 3],
        inclination: f64,
        half_angle: f64,
    }
    let peak = |view: &Cone| {
        let towards = view.axis_towards();
        let length = towards.length().max(1.0);
        let (x, y) = (-towards.x / length, -towards.y / length);
        let direction = rotated(&pixels.frame, [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]);
        let [x, y, z] = direction;
        Peak { direction, inclination: x.hypot(y).atan2(z), half_angle: view.index() * view.half_angle() }
    };
    let peaks: Vec<Peak> = views.iter().map(peak).collect();
    let [high, wide] = pixels.steps();
    // No point of a pixel is farther from its middle.
    let reach = 0.5 * high.hypot(wide);
    let mut found = Vec::new();
    let turns: Vec<(f64, f64)> =
        (0..pixels.columns).map(|column| (wide * (column as f64 + 0.5)).sin_cos()).collect();
    for (row, radiances) in pixels.radiance.chunks_exact(pixels.columns).enumerate() {
        let theta = high * (row as f64 + 0.5);
        let within = |peak: &&Peak| (theta - peak.inclination).abs() < peak.half_angle + range + reach;
        let peaks: Vec<&Peak> = peaks.iter().filter(within).collect();
        let (sin, cos) = theta.sin_cos();
        for (column, _) in radiances.iter().enumerate().filter(|(_, radiance)| **radiance > 0.0) {
            let (sin_turn, cos_turn) = turns[column];
            let distance = |peak: &&Peak| {
                let [x, y, z] = peak.direction;
                let cosine = sin * (cos_turn * x + sin_turn * y) + cos * z;
                cosine.clamp(-1.0, 1.0).acos() - peak.half_angle - reach
            };
            let distance = peaks.iter().map(distance).fold(f64::INFINITY, f64::min);
            if distance < range {
                found.push(Close { pixel: row * pixels.columns + column, distance: distance.max(0.0) });
            }
        }
    }
    found
}

/// Returns points of the part of a pixel above the horizon, with their areas of direction cosines; `count` is
/// the number of points along a side of this length, radians.
fn points_of(pixels: &Pixels, pixel: usize, count: impl Fn(f64) -> usize) -> impl Iterator<Item = Spot> {
    let [high, wide] = pixels.steps();
    let (row, column) = ((pixel / pixels.columns) as f64, (pixel % pixels.columns) as f64);
    let counts = [count(high), count(wide * (high * (row + 0.5)).sin())];
    gauss(high * row, high * (row + 1.0), counts[0])
        .flat_map(move |down| {
            gauss(wide * column, wide * (column + 1.0), counts[1]).map(move |turn| (down, turn))
        })
        .filter_map(|(down, turn)| {
            let [x, y, z] = pixels.direction(down.x.sin_cos(), turn.x.sin_cos());
            let light = down.weight * down.x.sin() * turn.weight * z;
            (z > 0.0).then(|| Spot { theta: x.hypot(y).atan2(z), phi: y.atan2(x), light })
        })
}

/// Parts of the pixels of a picture.
struct Parts<'a> {
    pixels: &'a Pixels,
    /// Number of parts of a side of a pixel.
    count: usize,
    /// Sines and cosines of the middles of parts: of their inclinations, and of their azimuths.
    rows: Vec<(f64, f64)>,
    columns: Vec<(f64, f64)>,
}

impl<'a> Parts<'a> {
    fn new(pixels: &'a Pixels) -> Self {
        let count = (PARTS * COLUMNS).div_ceil(pixels.columns);
        let middles = |step: f64, pixels: usize| {
            let middle = |part: usize| (step * (part as f64 + 0.5) / count as f64).sin_cos();
            (0..pixels * count).map(middle).collect()
        };
        let [high, wide] = pixels.steps();
        Self { pixels, count, rows: middles(high, pixels.rows()), columns: middles(wide, pixels.columns) }
    }

    /// Calls `each` with the place (in steps of the grid, down and along) and the area of direction cosines of
    /// each part above the horizon.
    #[inline]
    fn of(&self, pixel: usize, mut each: impl FnMut([f64; 2], f64)) {
        let (row, column) =
            (pixel / self.pixels.columns * self.count, pixel % self.pixels.columns * self.count);
        let [high, wide] = self.pixels.steps().map(|step| step / self.count as f64);
        // Integral of the sine over a part.
        let band = 2.0 * (0.5 * high).sin() * wide;
        for down in &self.rows[row..row + self.count] {
            for turn in &self.columns[column..column + self.count] {
                let [x, y, z] = self.pixels.direction(*down, *turn);
                if z > 0.0 {
                    let along = y.atan2(x);
                    let along = if along < 0.0 { along + TAU } else { along };
                    let place = [(x * x + y * y).sqrt().atan2(z), along].map(|angle| angle / STEP);
                    each(place, band * down.0 * z);
                }
            }
        }
    }
}

/// Weights of cubic interpolation of a place.
struct Cubic {
    row: isize,
    column: isize,
    down: [f64; 4],
    along: [f64; 4],
}

impl Cubic {
    #[inline]
    fn new([down, along]: [f64; 2]) -> Self {
        let (down, along) = (down - 0.5, along - 0.5);
        // Below the horizon there are no nodes.
        let row = (down.floor() - 1.0).min(ROWS as f64 - 4.0);
        let column = along.floor() - 1.0;
        let (of_down, of_along) = (cubic(down - row), cubic(along - column));
        Self { row: row as isize, column: column as isize, down: of_down, along: of_along }
    }

    #[inline]
    fn add(&self, nodes: &mut [f64], light: f64) {
        for (k, down) in self.down.iter().enumerate() {
            let row = self.row + k as isize;
            // Beyond the normal lie the first rows at the opposite azimuth.
            let (row, opposite) = if row < 0 { (-1 - row, COLUMNS / 2) } else { (row, 0) };
            let nodes = &mut nodes[row as usize * COLUMNS..][..COLUMNS];
            let first = (self.column + (opposite + COLUMNS) as isize) as usize % COLUMNS;
            let light = light * down;
            if let Some(nodes) = nodes.get_mut(first..first + 4) {
                nodes.iter_mut().zip(&self.along).for_each(|(node, along)| *node += light * along);
            } else {
                let around = |(k, along): (usize, &f64)| nodes[(first + k) % COLUMNS] += light * along;
                self.along.iter().enumerate().for_each(around);
            }
        }
    }
}

/// As [`lagrange`], for four nodes.
#[inline]
fn cubic(at: f64) -> [f64; 4] {
    let [a, b, c, d] = [at, at - 1.0, at - 2.0, at - 3.0];
    let (first, last) = (a * b, c * d);
    [b * last / -6.0, a * last / 2.0, first * d / -2.0, first * c / 6.0]
}

/// Returns the weights of polynomial interpolation at a place between the nodes 0, 1, ...
#[inline]
pub(crate) fn lagrange<const N: usize>(at: f64) -> [f64; N] {
    std::array::from_fn(|i| {
        let others = (0..N).filter(|j| *j != i);
        others.map(|j| (at - j as f64) / (i as f64 - j as f64)).product()
    })
}

/// Returns the four cells whose middles are nearest to a place, and the weights of linear interpolation
/// between them.
#[inline]
fn linear([down, along]: [f64; 2]) -> [(usize, f64); 4] {
    let (row, column) = ((down - 0.5).floor(), (along - 0.5).floor());
    let (below, right) = (down - 0.5 - row, along - 0.5 - column);
    let cell = |row: isize, column: isize| {
        let opposite = if row < 0 { COLUMNS / 2 } else { 0 };
        let column = (column + (opposite + COLUMNS) as isize) as usize % COLUMNS;
        (row.max(0) as usize).min(ROWS - 1) * COLUMNS + column
    };
    let (row, column) = (row as isize, column as isize);
    [
        (cell(row, column), (1.0 - below) * (1.0 - right)),
        (cell(row, column + 1), (1.0 - below) * right),
        (cell(row + 1, column), below * (1.0 - right)),
        (cell(row + 1, column + 1), below * right),
    ]
}

/// Returns about the radiances of cells that receive this light. Near the normal, where cells are narrow, they
/// are means over several cells.
fn radiances(mut light: Vec<f64>) -> Vec<f64> {
    for (row, cells) in light.chunks_exact_mut(COLUMNS).enumerate() {
        let squares = [row, row + 1].map(|edge| (STEP * edge as f64).sin().powi(2));
        let area = 0.5 * (squares[1] - squares[0]) * STEP;
        let middle = (STEP * (row as f64 + 0.5)).sin();
        let together = ((1.0 / middle) as usize).next_power_of_two().min(COLUMNS / 4);
        for cells in cells.chunks_mut(together) {
            let mean = cells.iter().sum::<f64>() / (area * cells.len() as f64);
            cells.fill(mean);
        }
    }
    light
}

/// Returns the inclinations between the rows of cells, degrees.
pub(crate) fn edges_deg(rows: usize) -> Vec<f64> {
    (0..=rows).map(|row| 90.0 * row as f64 / rows as f64).collect()
}

/// Largest number of columns of cells from which directions of a horizontal picture are sampled.
const MOST_LEVEL: usize = 1024;

/// Returns the number of rows and columns of means of a picture whose pole is the normal, and the means. The
/// numbers are halved until they are small enough, as long as they are even.
pub(crate) fn means(pixels: &Pixels) -> ([usize; 2], Vec<f64>) {
    let (rows, columns) = (pixels.rows() / 2, pixels.columns);
    let mut step = 1;
    while columns / step > MOST_LEVEL && rows.is_multiple_of(2 * step) && columns.is_multiple_of(2 * step) {
        step *= 2;
    }
    let angle = |row: usize| FRAC_PI_2 * row as f64 / rows as f64;
    let mut cells = Vec::with_capacity(rows * columns / (step * step));
    for first in (0..rows).step_by(step) {
        let mut sums = vec![0.0; columns / step];
        for row in first..first + step {
            let weight = (angle(row).cos() - angle(row + 1).cos())
                / (step as f64 * (angle(first).cos() - angle(first + step).cos()));
            let row = &pixels.radiance[row * columns..][..columns];
            for (sum, block) in sums.iter_mut().zip(row.chunks_exact(step)) {
                *sum += weight * block.iter().map(|value| f64::from(*value)).sum::<f64>();
            }
        }
        cells.extend(sums);
    }
    ([rows / step, columns / step], cells)
}
