//! Tensor trees in displays and as matrices of patches: sums over their cells.
//!
//! The values of a tree are constant over cells that do not move with the light, and jump between them.
//! Interpolation about the specular direction would neither keep their light nor their peaks. A display
//! therefore uses light between rings of directions ([`RingKernel`]), and a matrix of patches the light
//! between patches: both are sums over the cells, and conserve the total of the tree for every direction of
//! the light. Light that a cell sends or receives is widened to the rings or patches that it touches.

use std::f64::consts::PI;

use papilio_optics::scatter::{RingKernel, Rings, Scatter};
use papilio_optics::{Beta, Scatterer};

use crate::geometry::direction_of_square;
use crate::{Direction, MeasuredPart, Ring, TensorTree, patch_count, projected_solid_angle};

/// Width of the rings, degrees.
pub(crate) const RING_DEG: u32 = 5;
/// Number of cells of the difference of azimuths.
const AZIMUTHS: usize = 36;
/// Number of points of a side of the light's square, and of the viewer's.
const FINENESS: usize = 64;
/// Rounds of balancing; the light of rings is then right to 1e-9.
const ROUNDS: usize = 200;

/// Returns the light between rings of a part on a tree. `factor` multiplies values, by `|beta|` of the
/// scattered light.
pub(crate) fn ring_kernel(
    part: &MeasuredPart,
    tree: &TensorTree,
    channel: usize,
    factor: impl Fn(f64) -> f64,
) -> RingKernel {
    let edges: Vec<f64> = (0..=90 / RING_DEG).map(|k| f64::from(k * RING_DEG).to_radians().sin()).collect();
    let rings = Rings::new(&edges, &[1.0]);
    let count = rings.count();
    let mut shift = Shift::default();
    let mut light = vec![0.0; count * count * AZIMUTHS];
    let points = lights(tree, (8 * tree.finest_side()).clamp(FINENESS / 2, FINENESS));
    let weight = PI / points.len() as f64;
    for arriving in &points {
        let ([low, high], share) = rings.of(arriving.leaving().length());
        let came = [(low, weight * (1.0 - share)), (high, weight * share)];
        // Azimuth of unscattered light.
        let along = arriving.phi_deg + 180.0;
        tree.each_lit(part.channel(channel), *arriving, &mut |square| {
            let value = square.value;
            let (parts, side) = square.parts(1.0 / FINENESS as f64);
            for middle in parts {
                let to_direction = direction_of_square(shift.within(middle, side));
                let turn = if tree.rank() == 3 { 0.0 } else { along };
                let (beta, phi_deg) =
                    (to_direction.theta_deg.to_radians().sin(), to_direction.phi_deg - turn);
                let ([low, high], share) = rings.of(beta);
                let sent = PI * side * side * value;
                for (i, came) in came {
                    for (j, share) in [(low, 1.0 - share), (high, share)] {
                        let cells = &mut light[(i * count + j) * AZIMUTHS..][..AZIMUTHS];
                        for (cell, azimuth) in azimuths(phi_deg) {
                            cells[cell] += came * sent * share * azimuth;
                        }
                    }
                }
            }
        });
    }
    let values = part.channel(channel);
    let (mut from, mut to) = (
        ring_means(&rings, |beta| tree.mean_total(values, beta.asin().to_degrees())),
        ring_means(&rings, |beta| tree.mean_arriving(part, channel, beta)),
    );
    if !part.way.is_transmission() {
        // A reflection is the mean of both senses.
        let mean: Vec<f64> = from.iter().zip(&to).map(|(a, b)| 0.5 * (a + b)).collect();
        symmetric(&mut light, count);
        (from, to) = (mean.clone(), mean);
    }
    balance(&mut light, &from, &to);
    let factors: Vec<f64> = rings.middles().map(factor).collect();
    for (row, weight) in light.chunks_exact_mut(count * AZIMUTHS).zip(rings.weights()) {
        for (cells, factor) in row.chunks_exact_mut(AZIMUTHS).zip(&factors) {
            cells.iter_mut().for_each(|light| *light *= factor / weight);
        }
    }
    RingKernel::new(rings.clone(), rings, AZIMUTHS, light)
}

/// Numbers of inclinations and of azimuths of means over rings.
const MEANS: [usize; 2] = [180, 24];

/// Returns the étendue of each ring times the mean of a function of `|beta|` over its hat.
fn ring_means(rings: &Rings, of: impl Fn(f64) -> f64) -> Vec<f64> {
    let (mut sums, mut hats) = (vec![0.0; rings.count()], vec![0.0; rings.count()]);
    for k in 0..MEANS[0] {
        // Even steps of the angle: every ring has as many.
        let (sin, cos) = (0.5 * PI * (k as f64 + 0.5) / MEANS[0] as f64).sin_cos();
        let (value, etendue) = (of(sin), sin * cos);
        let ([low, high], share) = rings.of(sin);
        for (ring, share) in [(low, 1.0 - share), (high, share)] {
            sums[ring] += share * etendue * value;
            hats[ring] += share * etendue;
        }
    }
    sums.iter().zip(&hats).zip(rings.weights()).map(|((sum, hat), weight)| weight * sum / hat).collect()
}

impl TensorTree {
    /// Integral of f cos over the hemisphere for light of this inclination, degrees: exactly the sum over the
    /// cells, and the mean over azimuths of an anisotropic sample.
    pub fn mean_total(&self, values: &[f64], theta_deg: f64) -> f64 {
        let lights = self.lights(theta_deg);
        lights.iter().map(|light| self.total(values, *light)).sum::<f64>() / lights.len() as f64
    }

    /// Mean over azimuths of the integral over the light, for scattered light of this `|beta|`.
    fn mean_arriving(&self, part: &MeasuredPart, channel: usize, beta: f64) -> f64 {
        let theta_deg = beta.asin().to_degrees();
        let azimuths = (0..MEANS[1]).map(|k| 360.0 * (k as f64 + 0.5) / MEANS[1] as f64);
        let towards = azimuths.map(|phi_deg| Direction::new(theta_deg, phi_deg));
        let sum: f64 = match self.rank() {
            4 => towards.map(|to| self.arriving(part.channel(channel), to)).sum(),
            _ => {
                let lights = || (0..MEANS[0]).map(|k| ((k as f64 + 0.5) / MEANS[0] as f64).sqrt());
                let light = |sin: f64| Direction::new(sin.asin().to_degrees(), 180.0);
                let f = |sin: f64, to: Direction| part.evaluate(channel, light(sin), to).unwrap_or(0.0);
                towards.map(|to| PI * lights().map(|sin| f(sin, to)).sum::<f64>() / MEANS[0] as f64).sum()
            }
        };
        sum / MEANS[1] as f64
    }
}

/// Directions of the light, `side` x `side`, each with the same projected solid angle.
fn lights(tree: &TensorTree, side: usize) -> Vec<Direction> {
    let count = side * side;
    let middle = |k: usize, count: usize| (k as f64 + 0.5) / count as f64;
    if tree.rank() == 3 {
        let light = |k: usize| Direction::new(middle(k, count).sqrt().asin().to_degrees(), 180.0);
        return (0..count).map(light).collect();
    }
    let mut shift = Shift::default();
    let place = |k: usize| shift.within([middle(k / side, side), middle(k % side, side)], 1.0 / side as f64);
    (0..count).map(place).map(|place| direction_of_square(place).specular()).collect()
}

/// Places within squares that cover all of them evenly (Roberts's sequence R2): the middles of squares would
/// leave the horizon dark.
#[derive(Default)]
struct Shift {
    number: f64,
}

impl Shift {
    /// The next place within a square about this middle.
    fn within(&mut self, [x, y]: [f64; 2], side: f64) -> [f64; 2] {
        self.number += 1.0;
        let at = |step: f64| side * ((0.5 + step * self.number).fract() - 0.5);
        [x + at(0.754_877_666_246_692_7), y + at(0.569_840_290_998_053_2)]
    }
}

/// Directions of the middles of a grid of the viewer's square.
struct Places {
    side: usize,
    directions: Vec<Direction>,
}

impl Places {
    fn new(side: usize) -> Self {
        let middle = |k: usize| (k as f64 + 0.5) / side as f64;
        let place = |k: usize| direction_of_square([middle(k / side), middle(k % side)]);
        Self { side, directions: (0..side * side).map(place).collect() }
    }

    /// Direction of the middle next to a place.
    fn at(&self, square: [f64; 2]) -> Direction {
        let [x, y] = square.map(|x| ((x * self.side as f64) as usize).min(self.side - 1));
        self.directions[x * self.side + y]
    }
}

/// The two cells of a difference of azimuths, and their shares.
fn azimuths(phi_deg: f64) -> [(usize, f64); 2] {
    let turned = phi_deg.rem_euclid(360.0);
    let place = turned.min(360.0 - turned) / 180.0 * AZIMUTHS as f64 - 0.5;
    let low = place.floor();
    let cell = |k: f64| k.clamp(0.0, AZIMUTHS as f64 - 1.0) as usize;
    [(cell(low), 1.0 - (place - low)), (cell(low + 1.0), place - low)]
}

/// Replaces light between rings by the mean of both senses.
fn symmetric(light: &mut [f64], count: usize) {
    for i in 0..count {
        for j in 0..i {
            for k in 0..AZIMUTHS {
                let [there, back] = [(i * count + j) * AZIMUTHS + k, (j * count + i) * AZIMUTHS + k];
                let mean = 0.5 * (light[there] + light[back]);
                (light[there], light[back]) = (mean, mean);
            }
        }
    }
}

/// Scales rows and columns of the light until each ring sends and receives what the tree says.
fn balance(light: &mut [f64], from: &[f64], to: &[f64]) {
    let count = from.len();
    let all: [f64; 2] = [from.iter().sum(), to.iter().sum()];
    for _ in 0..ROUNDS {
        let mut received = vec![0.0; count];
        for row in light.chunks_exact(count * AZIMUTHS) {
            for (received, cells) in received.iter_mut().zip(row.chunks_exact(AZIMUTHS)) {
                *received += cells.iter().sum::<f64>();
            }
        }
        for (row, from) in light.chunks_exact_mut(count * AZIMUTHS).zip(from) {
            for ((cells, to), received) in row.chunks_exact_mut(AZIMUTHS).zip(to).zip(&received) {
                let scale = if *received > 0.0 { to * all[0] / all[1] / received } else { 1.0 };
                cells.iter_mut().for_each(|light| *light *= scale);
            }
            let sent: f64 = row.iter().sum();
            let scale = if sent > 0.0 { from / sent } else { 1.0 };
            row.iter_mut().for_each(|light| *light *= scale);
        }
    }
}

/// Number of directions of the viewer along a side of the square, at which rings are compared with cells.
const COMPARED: usize = 64;

/// Returns the part of the light of an inclination that rings have elsewhere than the cells of the tree: half of the sum of
/// the differences, relative to the total. `kernel` is [`ring_kernel`]; its total may differ.
pub(crate) fn moved_by_rings(
    part: &MeasuredPart,
    tree: &TensorTree,
    channel: usize,
    kernel: &Scatter,
    theta_deg: f64,
) -> f64 {
    let lights = tree.lights(theta_deg);
    let from = Beta { x: theta_deg.to_radians().sin(), y: 0.0 };
    // Rings do not distinguish the two sides of the plane of incidence.
    let of_cells = |to: &Direction| -> f64 {
        let at = |light: &Direction, turn: f64| {
            let to = Direction::new(to.theta_deg, light.phi_deg + 180.0 + turn);
            part.evaluate(channel, *light, to).unwrap_or(0.0).max(0.0)
        };
        let of_light = |light: &Direction| 0.5 * (at(light, to.phi_deg) + at(light, -to.phi_deg));
        lights.iter().map(of_light).sum::<f64>() / lights.len() as f64
    };
    let of_rings = |to: &Direction| {
        let (length, (sin_phi, cos_phi)) =
            (to.theta_deg.to_radians().sin(), to.phi_deg.to_radians().sin_cos());
        kernel.evaluate(from, Beta { x: length * cos_phi, y: length * sin_phi })
    };
    let directions = Places::new(COMPARED).directions;
    let both: Vec<[f64; 2]> = directions.iter().map(|to| [of_cells(to), of_rings(to)]).collect();
    let [cells, rings] = [0, 1].map(|one| both.iter().map(|pair| pair[one]).sum::<f64>());
    if cells <= 0.0 || rings <= 0.0 {
        return 0.0;
    }
    0.5 * both.iter().map(|pair| (pair[0] / cells - pair[1] / rings).abs()).sum::<f64>()
}

/// Number of points of an incident patch, in inclination and in azimuth.
const POINTS: usize = 6;
/// Number of parts of a side of the square, of which each lights one patch.
const PARTS: usize = 128;

/// Returns the mean of f between patches of a basis, `[in][out]`: light of a patch is the mean over its
/// directions, and all of it arrives in some patch. The sum of value x projected solid angle of a column is
/// thus the mean total of the tree over the incident patch.
pub fn patch_means(tree: &TensorTree, values: &[f64], rings: &[Ring]) -> Vec<f64> {
    let omega = projected_solid_angle(rings);
    let places = Places::new(PARTS);
    let mut means = vec![0.0; patch_count(rings) * omega.len()];
    let incoming = rings.iter().enumerate().flat_map(|(k, ring)| (0..ring.patches).map(move |n| (k, n)));
    for (column, (k, number)) in means.chunks_exact_mut(omega.len()).zip(incoming) {
        let to_deg = rings.get(k + 1).map_or(90.0, |next| next.from_deg);
        let [low, high] = [rings[k].from_deg, to_deg].map(|theta| theta.to_radians().sin().powi(2));
        for point in 0..POINTS * POINTS {
            let middle = |k: usize| (k as f64 + 0.5) / POINTS as f64;
            let sin = (low + (high - low) * middle(point / POINTS)).sqrt();
            let turn = number as f64 - 0.5 + middle(point % POINTS);
            let through = Direction::new(sin.asin().to_degrees(), 360.0 * turn / rings[k].patches as f64);
            tree.each_lit(values, through.specular(), &mut |square| {
                let value = square.value;
                let (parts, side) = square.parts(1.0 / PARTS as f64);
                for part in parts {
                    let mut to = places.at(part);
                    if tree.rank() == 3 {
                        to.phi_deg += through.phi_deg;
                    }
                    if let Some(patch) = crate::patch_of(rings, to) {
                        column[patch] += PI * side * side * value / (omega[patch] * (POINTS * POINTS) as f64);
                    }
                }
            });
        }
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Audit, Channel, Geometry, KLEMS_FULL, ScatterMode, TreeNode};

    /// A clear pane of rank 4 with 4 cells a side: all light of a cell leaves into the cell of the
    /// unscattered direction.
    fn clear() -> MeasuredPart {
        let cells = 16;
        let values = (0..cells * cells).map(|k| if k / cells == k % cells { 16.0 / PI } else { 0.0 });
        part(4, values.collect())
    }

    fn part(rank: usize, values: Vec<f64>) -> MeasuredPart {
        let tree = TensorTree::new(rank, vec![TreeNode::Grid { log2: 2, cell: 0 }]).unwrap();
        MeasuredPart {
            way: ScatterMode::FrontTransmission,
            channels: vec![Channel::Monochrome],
            geometry: Geometry::Tree(tree),
            values,
            tis: Vec::new(),
        }
    }

    /// An isotropic tree whose light always leaves evenly into the quarter of the disc away from the light.
    fn isotropic() -> MeasuredPart {
        // Sides: the light, then x and y of the viewer; 0.5 of the square in x is a half of the disc, and of
        // that half y.
        let value = |k: usize| if (k / 4) % 4 >= 2 && (k % 4).is_multiple_of(3) { 3.0 / PI } else { 0.0 };
        part(3, (0..64).map(value).collect())
    }

    fn tree(part: &MeasuredPart) -> &TensorTree {
        let Geometry::Tree(tree) = &part.geometry else { panic!("{:?}", part.geometry) };
        tree
    }

    /// Cells of Shirley and Chiu have equal projected solid angles: the total is exactly 1, the unscattered
    /// value 16/pi, at any incidence.
    #[test]
    fn clear_pane_has_total_one_and_its_peak_at_all_incidences() {
        let audit = Audit::of(&clear(), 0).unwrap();
        for incidence in &audit.incidences {
            let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
            assert!(
                close(incidence.integral, 1.0) && close(incidence.peak.unwrap_or(0.0), 16.0 / PI),
                "{incidence:?}"
            );
        }
        assert!(audit.reciprocity.unwrap()[1] < 1e-12, "{:?}", audit.reciprocity);
        // 2 of 4 columns by 2 of 4 rows: a quarter of the disc, with 3/pi.
        let audit = Audit::of(&isotropic(), 0).unwrap();
        assert!(audit.incidences.iter().all(|incidence| (incidence.integral - 0.75).abs() < 1e-9));
    }

    /// Light between rings has the totals of the tree, in both senses.
    #[test]
    fn rings_conserve_the_light_of_a_tree() {
        for (part, total) in [(clear(), 1.0), (isotropic(), 0.75)] {
            let scatter = Scatter::from(ring_kernel(&part, tree(&part), 0, |_| 1.0));
            for beta in [0.0, 0.3, 0.7, 0.99] {
                assert!(
                    (scatter.albedo_at(beta) - total).abs() < 1e-6,
                    "{beta}: {}",
                    scatter.albedo_at(beta)
                );
                if total == 1.0 {
                    assert!((scatter.reversed().albedo_at(beta) - 1.0).abs() < 1e-6, "{beta}");
                }
            }
            // By a sum over the disc, too.
            let (from, steps) = (Beta { x: 0.6, y: 0.0 }, 400);
            let middle = |k: i32| f64::from(2 * k + 1) / f64::from(steps) - 1.0;
            let all = (0..steps).flat_map(|i| (0..steps).map(move |j| Beta { x: middle(i), y: middle(j) }));
            let sum: f64 = all.filter(|to| to.squared() < 1.0).map(|to| scatter.evaluate(from, to)).sum();
            let sum = sum * (2.0 / f64::from(steps)).powi(2);
            assert!((sum / total - 1.0).abs() < 5e-3, "{sum}");
        }
    }

    /// Columns of Klems patches have the light of the tree.
    #[test]
    fn columns_of_patches_have_the_light_of_a_tree() {
        let omega = projected_solid_angle(&KLEMS_FULL);
        for (part, total) in [(clear(), 1.0), (isotropic(), 0.75)] {
            let means = patch_means(tree(&part), &part.values, &KLEMS_FULL);
            for (patch, column) in means.chunks_exact(omega.len()).enumerate() {
                let sum: f64 = column.iter().zip(&omega).map(|(f, omega)| f * omega).sum();
                assert!((sum - total).abs() < 1e-9, "{patch}: {sum}");
            }
        }
    }
}
