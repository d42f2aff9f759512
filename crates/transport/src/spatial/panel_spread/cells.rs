//! Kernels on a grid of square cells, with the exact light of each cell.
//!
//! A place r on the pixel is seen along one direction in the glass: `beta(r) = n r/sqrt(d^2 + r^2)`. Light of a cell is
//! therefore the integral of the density of directions over the cell, `n^2 d^2/(d^2 + r^2)^2 d^2r` for `d^2 beta`, without
//! samples. Cells are divided until they are small compared with the distance to the nearest peak.

use crate::adding::first_pass::Weights;
use crate::adding::quadrature::{gauss, points_for};
use crate::{Panel, Reflector};

use super::super::spread::Pair;
use super::super::{Gap, displacement};
use super::{PanelSpread, Part, Scattered};
use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

/// Square cells around the view's own ray: rows from the bottom, columns from the left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Number of columns and rows.
    pub count: [usize; 2],
    /// Side of a cell, mm.
    pub cell_mm: f64,
}

/// Light of each cell and outside of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Kernel {
    /// Reflectance factor of the light of each cell in the first order, `[row][column][state][wavelength]`.
    pub cells: Vec<f64>,
    /// Of all other light, `[state][wavelength]`.
    pub outside: Vec<f64>,
}

impl PanelSpread {
    /// Returns the kernel of each state: what is seen of light that meets the pixel once, by the place where it does so,
    /// relative to the view's own ray. Sharp images belong to the cell that contains them, at an edge to its neighbours in
    /// equal parts.
    pub fn kernel(&self, panel: &Panel, grid: Grid) -> Kernel {
        let len = panel.base.states() * panel.base.bins();
        let count = grid.count[0] * grid.count[1];
        let mut kernel = Kernel { cells: vec![0.0; count * len], outside: vec![0.0; len] };
        for part in &self.parts {
            let weights = match &self.scattered {
                Some(scattered) if part.is_scattered => self.of_density(scattered, part, panel, grid),
                _ => self.of_images(part, panel, grid),
            };
            self.add(part, panel, &weights, &mut kernel);
        }
        kernel
    }

    /// Adds rows of weights on the nodes of the pixel's table: the cells, and the whole light.
    fn add(&self, part: &Part, panel: &Panel, rows: &[Vec<f64>], kernel: &mut Kernel) {
        let (bins, len) = (part.through.len(), kernel.outside.len());
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let sums = match &panel.base.reflector {
            Reflector::Specular(table) => table.weighted_sums(&rows),
            Reflector::Lambertian(rho) => {
                rows.iter().flat_map(|row| rho.iter().map(|rho| rho * row[0])).collect()
            }
            Reflector::Scattering(_) => Vec::new(),
        };
        let mut sums = sums.chunks_exact(len.max(1));
        let all = sums.next_back().unwrap_or_default();
        for (out, all) in kernel.outside.chunks_exact_mut(bins).zip(all.chunks_exact(bins)) {
            out.iter_mut()
                .zip(all)
                .zip(&part.through)
                .for_each(|((out, all), through)| *out += all * through);
        }
        for (cell, sums) in kernel.cells.chunks_exact_mut(len.max(1)).zip(sums) {
            let rows = cell.chunks_exact_mut(bins).zip(kernel.outside.chunks_exact_mut(bins));
            for ((cell, outside), sums) in rows.zip(sums.chunks_exact(bins)) {
                for (((cell, outside), sum), through) in
                    cell.iter_mut().zip(outside).zip(sums).zip(&part.through)
                {
                    *cell += sum * through;
                    *outside -= sum * through;
                }
            }
        }
    }

    /// Returns the weights of sharp images in each cell, and of all.
    fn of_images(&self, part: &Part, panel: &Panel, grid: Grid) -> Vec<Vec<f64>> {
        let mut rows = Rows::new(panel, part.index, grid);
        for sample in &part.samples {
            let place = [0, 1].map(|k| sample.shift_mm[k] - self.own_mm[k]);
            for (cell, share) in grid.around(place) {
                rows.add(cell, sample.beta, share * sample.weight);
            }
            rows.add_to_all(sample.beta, sample.weight);
        }
        rows.finish()
    }

    /// Returns the weights of scattered light in each cell, and of all.
    fn of_density(&self, scattered: &Scattered, part: &Part, panel: &Panel, grid: Grid) -> Vec<Vec<f64>> {
        let mut rows = Rows::new(panel, part.index, grid);
        let gap = Gap { index: part.index, thickness_mm: self.glass_mm };
        let Scattered { diffuser, view, light } = scattered;
        let pair = Pair { diffuser, gap, view, light, accuracy: self.accuracy };
        let places = Places::new(&pair);
        for row in 0..grid.count[1] {
            for column in 0..grid.count[0] {
                let corner = grid.corner([column, row]);
                let from = [0, 1].map(|k| corner[k] + self.own_mm[k]);
                let cell = row * grid.count[0] + column;
                places.integrate(from, grid.cell_mm, 0, &mut |beta, weight| rows.add(cell, beta, weight));
            }
        }
        for sample in &part.samples {
            rows.add_to_all(sample.beta, sample.weight);
        }
        rows.finish()
    }
}

impl Grid {
    /// Lower left corner of a cell.
    fn corner(&self, at: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|k| (at[k] as f64 - 0.5 * self.count[k] as f64) * self.cell_mm)
    }

    /// Returns the cells that contain a place, with their parts of it; none outside of the grid.
    fn around(&self, place: [f64; 2]) -> Vec<(usize, f64)> {
        let along = |k: usize| -> Vec<(isize, f64)> {
            let at = place[k] / self.cell_mm + 0.5 * self.count[k] as f64;
            let edge = at.round();
            if (at - edge).abs() < 1e-9 * self.count[k] as f64 {
                return vec![(edge as isize - 1, 0.5), (edge as isize, 0.5)];
            }
            vec![(at.floor() as isize, 1.0)]
        };
        let inside = |(k, at): (usize, isize)| (0..self.count[k] as isize).contains(&at);
        let (columns, rows) = (along(0), along(1));
        let pairs = rows.iter().flat_map(|row| columns.iter().map(move |column| (column, row)));
        pairs
            .filter(|(column, row)| inside((0, column.0)) && inside((1, row.0)))
            .map(|(column, row)| (row.0 as usize * self.count[0] + column.0 as usize, row.1 * column.1))
            .collect()
    }
}

/// Weights of cells on the nodes of the pixel's table; of a Lambertian pixel, on one.
struct Rows<'a> {
    table: Option<&'a crate::Nodes>,
    index: f64,
    rows: Vec<Weights>,
}

impl<'a> Rows<'a> {
    fn new(panel: &'a Panel, index: f64, grid: Grid) -> Self {
        let table = match &panel.base.reflector {
            Reflector::Specular(table) => Some(&table.nodes),
            Reflector::Lambertian(_) | Reflector::Scattering(_) => None,
        };
        let row = Weights::new(table.unwrap_or(&crate::Nodes::Constant));
        Self { table, index, rows: vec![row; grid.count[0] * grid.count[1] + 1] }
    }

    #[inline]
    fn add(&mut self, cell: usize, beta: Beta, weight: f64) {
        let nodes = self.table.unwrap_or(&crate::Nodes::Constant);
        self.rows[cell].add(&nodes.stencil(beta.squared(), self.index), weight);
    }

    fn add_to_all(&mut self, beta: Beta, weight: f64) {
        self.add(self.rows.len() - 1, beta, weight);
    }

    fn finish(self) -> Vec<Vec<f64>> {
        let nodes = self.table.unwrap_or(&crate::Nodes::Constant);
        self.rows.into_iter().map(|row| row.finish(nodes).0).collect()
    }
}

/// Places where the density of light changes quickly.
struct Places<'a> {
    pair: &'a Pair<'a>,
    /// Places of peaks, and over which distance they change, mm.
    peaks: Vec<([f64; 2], f64)>,
    /// Distance of the rim of the disc of air, and over which distance it is soft, mm.
    rim: Option<(f64, f64)>,
}

/// Cells are divided at most so many times.
const MOST_DIVISIONS: u32 = 24;
/// A cell is divided if it is wider than this many distances from the peak.
const WIDEST: f64 = 1.1;
/// The rim is weak: there is little light.
const WIDEST_AT_RIM: f64 = 3.0;

impl<'a> Places<'a> {
    fn new(pair: &'a Pair<'a>) -> Self {
        let Gap { index, thickness_mm } = pair.gap;
        // Change of place with direction.
        let slope = |beta: f64| thickness_mm / (index * index - beta * beta).sqrt();
        let width = match pair.diffuser.lobe {
            Lobe::KCorrelation { width } => width,
            Lobe::Lambertian => 1.0,
        };
        let peak =
            |(beta, _): (Beta, f64)| (displacement(beta, thickness_mm, index), width * slope(beta.length()));
        let at_rim = slope(1.0) * index * index / (index * index - 1.0);
        let has_rim = pair.has_rim();
        Self {
            pair,
            peaks: pair.centres().into_iter().map(peak).collect(),
            rim: has_rim.then(|| (slope(1.0), width.min(0.3) * at_rim)),
        }
    }

    /// Integrates the density over a square: `each` receives directions and weights.
    fn integrate(&self, from: [f64; 2], side: f64, divisions: u32, each: &mut impl FnMut(Beta, f64)) {
        let middle = from.map(|from| from + 0.5 * side);
        let mut ratio = f64::INFINITY;
        for (place, width) in &self.peaks {
            // Distance of the peak from the square, not from its middle.
            let aside = [0, 1].map(|k| ((place[k] - middle[k]).abs() - 0.5 * side).max(0.0));
            ratio =
                ratio.min((aside[0] * aside[0] + aside[1] * aside[1] + width * width).sqrt() / side * WIDEST);
        }
        if let Some((radius, width)) = self.rim {
            let aside = ((middle[0].hypot(middle[1]) - radius).abs() - 0.7 * side).max(0.0);
            ratio = ratio.min(aside.hypot(width) / side * WIDEST_AT_RIM);
        }
        if ratio < 1.0 && divisions < MOST_DIVISIONS {
            let half = 0.5 * side;
            for k in 0..4_u32 {
                let corner = [from[0] + half * f64::from(k % 2), from[1] + half * f64::from(k / 2)];
                self.integrate(corner, half, divisions + 1, each);
            }
            return;
        }
        // A pole beside the middle of the square, at this many half sides.
        let ellipse = 2.0 * ratio + (4.0 * ratio * ratio + 1.0).sqrt();
        let points = points_for(self.pair.accuracy.digits, 2.0 * ellipse.min(20.0).ln()).max(2);
        let Gap { index, thickness_mm } = self.pair.gap;
        let d2 = thickness_mm * thickness_mm;
        for y in gauss(from[1], from[1] + side, points) {
            for x in gauss(from[0], from[0] + side, points) {
                let slant = d2 + x.x * x.x + y.x * y.x;
                let scale = index / slant.sqrt();
                let beta = Beta { x: x.x * scale, y: y.x * scale };
                let area = index * index * d2 / (slant * slant);
                each(beta, x.weight * y.weight * area * self.pair.density(beta));
            }
        }
    }
}
