//! Kernels on a grid of square cells, with the exact light of each cell, at all wavelengths.

use super::{PanelSpread, Part};
use crate::adding::first_pass::Weights;
use crate::{Nodes, Panel, Reflector};

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
    /// relative to the view's own ray. A sharp image at the border of cells belongs to the one above and to the right.
    pub fn kernel(&self, panel: &Panel, grid: Grid) -> Kernel {
        let len = panel.base.states() * panel.base.bins();
        let count = grid.count[0] * grid.count[1];
        let mut kernel = Kernel { cells: vec![0.0; count * len], outside: vec![0.0; len] };
        let [columns, rows] = [0, 1].map(|axis| grid.edges(axis));
        for part in &self.parts {
            let nodes = nodes(panel);
            let mut weights = vec![Weights::new(nodes); count + 1];
            let mut add = |row: usize, beta_squared: f64, weight: f64| {
                weights[row].add(&nodes.stencil(beta_squared, part.index), weight);
            };
            for part in &self.point_spread(part).cells(&columns, &rows).parts {
                add(part.bin as usize, part.beta_squared, part.weight);
            }
            for sample in &part.samples {
                add(count, sample.beta.squared(), sample.weight);
            }
            let weights: Vec<Vec<f64>> = weights.into_iter().map(|row| row.finish(nodes).0).collect();
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
}

impl Grid {
    /// Borders of columns (axis 0) or rows, mm.
    fn edges(&self, axis: usize) -> Vec<f64> {
        let count = self.count[axis];
        (0..=count).map(|k| (k as f64 - 0.5 * count as f64) * self.cell_mm).collect()
    }
}

/// Returns the nodes of the pixel's table; of a Lambertian pixel, one.
fn nodes(panel: &Panel) -> &Nodes {
    match &panel.base.reflector {
        Reflector::Specular(table) => &table.nodes,
        Reflector::Lambertian(_) | Reflector::Scattering(_) => &Nodes::Constant,
    }
}
