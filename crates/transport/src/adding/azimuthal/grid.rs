//! Directions below the diffuser, and what it sends back to them.

use std::f64::consts::TAU;

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, with_widest_simd};

use super::film::{Film, Light};
use crate::AngularTable;
use crate::adding::panel::lobes::orders_of_nodes;
use crate::angular::harmonic;
use crate::light::cone_points::Point;
use crate::numerics::product::add_product;
use crate::numerics::quadrature::Node;

/// Rings of directions, each with uniform azimuths.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    pub(super) rings: Vec<Node>,
    pub(super) azimuths: usize,
}

/// Light that the diffuser sends back down, per unit of its reflectance.
#[derive(Debug, Clone)]
pub(super) struct Back {
    pub(super) lobe: Lobe,
    pub(super) grid: Grid,
    /// By azimuthal order, `[order][to ring][from ring]`, with the weights of the rings.
    pub(super) orders: Vec<Vec<f64>>,
    /// Harmonics 1, cos, sin, cos 2, ... of a ring, `[harmonic][azimuth]`, and back.
    pub(super) analysis: Vec<f64>,
    pub(super) synthesis: Vec<f64>,
}

impl Grid {
    /// Number of directions.
    pub(super) fn len(&self) -> usize {
        self.rings.len() * self.azimuths
    }

    pub(super) fn turn(&self, azimuth: usize) -> f64 {
        TAU * azimuth as f64 / self.azimuths as f64
    }

    /// All directions with their weights, ring by ring.
    pub(super) fn points(&self) -> impl Iterator<Item = Point> {
        let turns: Vec<(f64, f64)> = (0..self.azimuths).map(|k| self.turn(k).sin_cos()).collect();
        (0..self.len()).map(move |at| {
            let (ring, (sin, cos)) = (&self.rings[at / self.azimuths], turns[at % self.azimuths]);
            let weight = ring.weight / self.azimuths as f64;
            Point { beta: Beta { x: ring.x * cos, y: ring.x * sin }, weight }
        })
    }

    /// Light of a view or a source below the diffuser, at all directions.
    pub(super) fn light(&self, film: &Film, light: &Light) -> Vec<f64> {
        match light {
            // The same at all azimuths.
            Light::Diffuse => {
                let of = |ring: &Node| film.arrives(light, Beta { x: ring.x, y: 0.0 });
                self.rings.iter().flat_map(|ring| std::iter::repeat_n(of(ring), self.azimuths)).collect()
            }
            Light::Points(_) => with_widest_simd(
                #[inline(always)]
                || self.points().map(|node| film.arrives(light, node.beta)).collect(),
            ),
        }
    }

    /// The same times the weights of the directions.
    pub(super) fn weighted(&self, film: &Film, light: &Light) -> Vec<f64> {
        let mut values = self.light(film, light);
        for (ring, values) in self.rings.iter().zip(values.chunks_exact_mut(self.azimuths)) {
            values.iter_mut().for_each(|value| *value *= ring.weight / self.azimuths as f64);
        }
        values
    }
}

impl Back {
    pub(super) fn new(film: &Film, table: &AngularTable, lobe: Lobe, radii: &[f64], digits: f64) -> Self {
        let (grid, count) = film.grid_back(table, lobe, radii, digits);
        let rings = grid.rings.len();
        let mut orders = vec![vec![0.0; rings * rings]; count];
        for (to, ring) in grid.rings.iter().enumerate() {
            match lobe {
                Lobe::KCorrelation { .. } => {
                    orders_of_nodes(lobe, ring.x, &grid.rings, count, |order, first, values| {
                        let row = &mut orders[order][to * rings + first..];
                        let pairs = row.iter_mut().zip(&grid.rings[first..]).zip(values);
                        pairs.for_each(|((out, from), value)| *out = from.weight * value);
                    });
                }
                Lobe::Lambertian => {
                    let value = film.sends_back(lobe, Beta::default(), Beta::default());
                    let row = orders[0][to * rings..].iter_mut().zip(&grid.rings);
                    row.for_each(|(out, from)| *out = from.weight * value);
                }
            }
        }
        let azimuths = grid.azimuths;
        let wave = |number: usize, azimuth: usize| harmonic(number, grid.turn(azimuth));
        let harmonics = 2 * count - 1;
        let norm = |harmonic: usize| if harmonic == 0 { 1.0 } else { 2.0 } / azimuths as f64;
        let analysis = (0..harmonics * azimuths).map(|at| (at / azimuths, at % azimuths));
        let analysis = analysis.map(|(harmonic, azimuth)| norm(harmonic) * wave(harmonic, azimuth)).collect();
        let synthesis = (0..harmonics * azimuths).map(|at| wave(at % harmonics, at / harmonics)).collect();
        Self { lobe, orders, analysis, synthesis, grid }
    }

    /// Returns the light that is sent back of light that rises, `[node][column]`.
    pub(super) fn apply(&self, rises: &[f64], columns: usize) -> Vec<f64> {
        let (rings, azimuths, harmonics) =
            (self.grid.rings.len(), self.grid.azimuths, 2 * self.orders.len() - 1);
        let (of_ring, row) = (azimuths * columns, rings * columns);
        let mut waves = vec![0.0; harmonics * row];
        let mut own = vec![0.0; harmonics * columns];
        for (ring, rises) in rises.chunks_exact(of_ring).enumerate() {
            own.fill(0.0);
            add_product(&self.analysis, rises, azimuths, &mut own);
            for (harmonic, values) in own.chunks_exact(columns).enumerate() {
                waves[harmonic * row + ring * columns..][..columns].copy_from_slice(values);
            }
        }
        let mut sent = vec![0.0; harmonics * row];
        for (harmonic, (waves, sent)) in waves.chunks_exact(row).zip(sent.chunks_exact_mut(row)).enumerate() {
            add_product(&self.orders[harmonic.div_ceil(2)], waves, rings, sent);
        }
        let mut out = vec![0.0; rings * of_ring];
        for (ring, out) in out.chunks_exact_mut(of_ring).enumerate() {
            for (harmonic, values) in own.chunks_exact_mut(columns).enumerate() {
                values.copy_from_slice(&sent[harmonic * row + ring * columns..][..columns]);
            }
            add_product(&self.synthesis, &own, harmonics, out);
        }
        out
    }
}
