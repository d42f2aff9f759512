//! Sums of `exp(-2 pi i f.r)` over many places at many frequencies.
//!
//! Frequencies on a line through the origin depend on one coordinate of a place. Between the nodes of a grid
//! along it, `exp(-2 pi i f s)` is a polynomial of degree 7 with an error below 1e-7, so that light is added
//! to eight nodes and the transform is computed from the grid once, for all paths: a path costs the same at
//! any number of frequencies. (The type 1 transform of A. Dutt, V. Rokhlin, SIAM J. Sci. Comput. 14, 1368
//! (1993).) Lower octaves of frequencies have coarser grids, each with half of the nodes of the one before, to which
//! the light of that one is added. Few frequencies, and places beyond the grid, are summed directly.

use std::f64::consts::TAU;

use crate::angular::Stencil;
use crate::numerics::product::add_product;

/// Nodes in a period of the highest frequency.
const PER_PERIOD: f64 = 20.0;

/// Nodes that a place adds to.
const NODES: usize = 8;

/// Most nodes of a line's first grid, times the frequencies of the line; places beyond it are summed directly.
const MOST_PHASES: usize = 1 << 23;

/// A grid with fewer nodes serves all lower frequencies.
const FEWEST_NODES: usize = 64;

/// Weights of a node on the nodes of the next grid about it, between two of which it is.
const BETWEEN: [f64; NODES] = {
    const SIDE: [f64; 4] = [-5.0 / 2048.0, 49.0 / 2048.0, -245.0 / 2048.0, 1225.0 / 2048.0];
    [SIDE[0], SIDE[1], SIDE[2], SIDE[3], SIDE[3], SIDE[2], SIDE[1], SIDE[0]]
};

/// Frequencies of a line from which on it has a grid.
const FEWEST: usize = 3;

/// Frequencies of a transform, on lines through the origin.
#[derive(Debug, Clone, Default)]
pub(super) struct Waves {
    lines: Vec<Line>,
    /// Number of all frequencies.
    count: usize,
    /// Number of nodes of all grids.
    nodes: usize,
}

#[derive(Debug, Clone)]
struct Line {
    direction: [f64; 2],
    /// Numbers of the frequencies, and frequencies along the direction.
    members: Vec<(usize, f64)>,
    /// Number of nodes of the first grid, and that of the first node among those of all lines; no nodes for direct sums.
    nodes: usize,
    offset: usize,
    /// Distance of the first node, and one over the step, mm.
    first_mm: f64,
    per_mm: f64,
    /// The grids, from that of the highest frequencies on.
    grids: Vec<Grid>,
}

/// A grid along a line, and the frequencies whose transform it has.
#[derive(Debug, Clone)]
struct Grid {
    nodes: usize,
    /// Numbers of the frequencies.
    members: Vec<usize>,
    /// Real and imaginary part of `exp(-2 pi i f s)`; `[node][member]`.
    phases: [Vec<f64>; 2],
}

/// A place on a line.
#[derive(Debug, Clone, Copy)]
pub(super) enum Spot {
    /// First node, and weights on the nodes from there.
    OnGrid(usize, [f64; NODES]),
    /// Number of the line, and coordinate, mm.
    Beyond(usize, f64),
}

/// Sums of a row: one state in one channel.
#[derive(Debug, Clone, Default)]
pub(super) struct WaveSums {
    grid: Vec<f64>,
    /// Real and imaginary part of what is not on a grid.
    direct: [Vec<f64>; 2],
}

impl Waves {
    /// `extent_mm` is the distance from the origin within which most places are.
    pub(super) fn new(frequencies_per_mm: &[[f64; 2]], extent_mm: f64) -> Self {
        let mut waves = Self { count: frequencies_per_mm.len(), ..Self::default() };
        for (number, [x, y]) in frequencies_per_mm.iter().copied().enumerate() {
            let length = x.hypot(y);
            let along = |line: &Line| x * line.direction[0] + y * line.direction[1];
            let on_line = |line: &&mut Line| (along(line).abs() - length).abs() <= 1e-12 * length;
            match waves.lines.iter_mut().find(on_line) {
                Some(line) => line.members.push((number, along(line))),
                None => {
                    let direction = if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] };
                    waves.lines.push(Line {
                        direction,
                        members: vec![(number, length)],
                        nodes: 0,
                        offset: 0,
                        first_mm: 0.0,
                        per_mm: 0.0,
                        grids: Vec::new(),
                    });
                }
            }
        }
        for line in &mut waves.lines {
            let most = line.members.iter().fold(0.0_f64, |most, (_, f)| most.max(f.abs()));
            if line.members.len() >= FEWEST && most > 0.0 && extent_mm > 0.0 {
                line.per_mm = PER_PERIOD * most;
                let fit = (MOST_PHASES / line.members.len()) as f64;
                line.nodes = (2.0 * extent_mm * line.per_mm).ceil().min(fit) as usize + NODES;
                line.first_mm = -0.5 * (line.nodes - 1) as f64 / line.per_mm;
                line.offset = waves.nodes;
                waves.nodes += line.nodes;
                line.grids = line.grids_of_octaves(most);
            }
        }
        waves
    }

    /// Empty sums of a row.
    pub(super) fn sums(&self) -> WaveSums {
        let direct = vec![0.0; self.count];
        WaveSums { grid: vec![0.0; self.nodes], direct: [direct.clone(), direct] }
    }

    /// Number of lines: that of the spots of a place.
    pub(super) fn lines(&self) -> usize {
        self.lines.len()
    }

    /// Adds the spots of a place, one for each line.
    pub(super) fn locate(&self, [x, y]: [f64; 2], spots: &mut Vec<Spot>) {
        spots.extend(self.lines.iter().enumerate().map(|(number, line)| {
            let along = x * line.direction[0] + y * line.direction[1];
            let at = (along - line.first_mm) * line.per_mm;
            if line.nodes > 0 && at >= 0.0 && at <= (line.nodes - 1) as f64 {
                let Stencil { first, weights } = Stencil::lagrange(at, line.nodes);
                let mut own = [0.0; NODES];
                own.copy_from_slice(&weights[..NODES]);
                Spot::OnGrid(line.offset + first, own)
            } else {
                Spot::Beyond(number, along)
            }
        }));
    }

    /// Adds light at these spots to a row.
    #[inline(always)]
    pub(super) fn add(&self, row: &mut WaveSums, spots: &[Spot], light: f64) {
        for spot in spots {
            match spot {
                Spot::OnGrid(first, weights) => {
                    let nodes = &mut row.grid[*first..][..NODES];
                    nodes.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += light * weight);
                }
                Spot::Beyond(number, along) => {
                    for (frequency, f) in &self.lines[*number].members {
                        let (sin, cos) = (TAU * f * along).sin_cos();
                        row.direct[0][*frequency] += light * cos;
                        row.direct[1][*frequency] -= light * sin;
                    }
                }
            }
        }
    }

    /// Sums of rows at all frequencies: real and imaginary part; `[row][frequency]`.
    pub(super) fn transform(&self, rows: &[WaveSums]) -> [Vec<f64>; 2] {
        let mut transfer = [0, 1]
            .map(|part| rows.iter().flat_map(|row| row.direct[part].iter().copied()).collect::<Vec<f64>>());
        if rows.iter().all(|row| row.grid.iter().all(|light| *light == 0.0)) {
            return transfer;
        }
        for line in self.lines.iter().filter(|line| line.nodes > 0) {
            let own = |row: &WaveSums| row.grid[line.offset..][..line.nodes].to_vec();
            let mut light: Vec<Vec<f64>> = rows.iter().map(own).collect();
            for (number, grid) in line.grids.iter().enumerate() {
                if number > 0 {
                    light.iter_mut().for_each(|row| *row = coarser(row));
                }
                let light = light.concat();
                for (part, transfer) in transfer.iter_mut().enumerate() {
                    let mut sums = vec![0.0; rows.len() * grid.members.len()];
                    add_product(&light, &grid.phases[part], grid.nodes, &mut sums);
                    for (row, sums) in sums.chunks_exact(grid.members.len().max(1)).enumerate() {
                        for (frequency, sum) in grid.members.iter().zip(sums) {
                            transfer[row * self.count + frequency] += sum;
                        }
                    }
                }
            }
        }
        transfer
    }
}

impl Line {
    /// The grids of frequencies up to `most`: each has those above half of its highest.
    fn grids_of_octaves(&self, most: f64) -> Vec<Grid> {
        let (mut nodes, mut first_mm, mut per_mm, mut above) =
            (self.nodes, self.first_mm, self.per_mm, 0.5 * most);
        let mut grids = Vec::new();
        let mut left = self.members.clone();
        loop {
            let is_last = nodes <= FEWEST_NODES;
            let (members, lower) = left.into_iter().partition(|(_, f)| is_last || f.abs() > above);
            left = lower;
            grids.push(Grid::new(nodes, first_mm, per_mm, &members));
            if left.is_empty() {
                return grids;
            }
            (nodes, first_mm) = (coarser_nodes(nodes), first_mm - BEFORE as f64 * 2.0 / per_mm);
            (per_mm, above) = (0.5 * per_mm, 0.5 * above);
        }
    }
}

impl Grid {
    fn new(nodes: usize, first_mm: f64, per_mm: f64, members: &[(usize, f64)]) -> Self {
        let along = |node: usize| first_mm + node as f64 / per_mm;
        let each = (0..nodes).flat_map(|node| members.iter().map(move |(_, f)| TAU * f * along(node)));
        let (re, im) = each.map(|angle| (angle.cos(), -angle.sin())).unzip();
        Self { nodes, members: members.iter().map(|(number, _)| *number).collect(), phases: [re, im] }
    }
}

/// Nodes of the next grid before the first of this one.
const BEFORE: usize = NODES / 2 - 1;

/// Number of nodes of the next grid: every other node, and those about the ends that a node between two adds to.
fn coarser_nodes(nodes: usize) -> usize {
    nodes / 2 + NODES
}

/// The light of a grid on the nodes of the next one.
fn coarser(light: &[f64]) -> Vec<f64> {
    let mut sums = vec![0.0; coarser_nodes(light.len())];
    for (pair, light) in light.chunks(2).enumerate() {
        sums[pair + BEFORE] += light[0];
        if let [_, between] = light {
            let about = &mut sums[pair..][..NODES];
            about.iter_mut().zip(BETWEEN).for_each(|(sum, weight)| *sum += between * weight);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places on the grid and beyond it, frequencies along both axes and off them, and zero.
    #[test]
    fn transform_equals_direct_sums() {
        let along = [0.02, 0.15].into_iter().chain((0..20).map(|k| 0.7 * f64::from(k))).map(|f| [f, 0.0]);
        let others = (1..9).map(|k| [-0.3 * f64::from(k), 0.5 * f64::from(k)]);
        let frequencies: Vec<[f64; 2]> = along.chain(others).chain([[0.0, 2.0], [3.0, -1.0]]).collect();
        let waves = Waves::new(&frequencies, 1.5);
        let mut rows = [waves.sums(), waves.sums()];
        let mut spots = Vec::new();
        let mut expected = vec![[0.0; 2]; frequencies.len()];
        for k in 0..500 {
            let place =
                [2.0 * (f64::from(k) * 0.618).fract() - 1.0, 3.2 * (f64::from(k) * 0.414).fract() - 1.6];
            let light = 1.0 / f64::from(k + 1);
            spots.clear();
            waves.locate(place, &mut spots);
            waves.add(&mut rows[1], &spots, light);
            for ([re, im], [fx, fy]) in expected.iter_mut().zip(&frequencies) {
                let (sin, cos) = (-TAU * (fx * place[0] + fy * place[1])).sin_cos();
                (*re, *im) = (*re + light * cos, *im + light * sin);
            }
        }
        let [re, im] = waves.transform(&rows);
        assert!(re[..frequencies.len()].iter().all(|value| *value == 0.0));
        for (k, expected) in expected.iter().enumerate() {
            let at = frequencies.len() + k;
            let error = (re[at] - expected[0]).hypot(im[at] - expected[1]);
            assert!(error < 5e-7, "{:?}: {} {} {expected:?}", frequencies[k], re[at], im[at]);
        }
    }
}
