//! A medium that scatters in its volume, as operators.
//!
//! Radiative transfer in a plane layer (Chandrasekhar 1960), with the phase function of Henyey and
//! Greenstein (1941). With s and d the sum and the difference of the light propagating down and up,
//! `s' = -A d`, `d' = -C s` over optical depth, where `A, C = 1/mu - (P+ -+ P-)` contain extinction and
//! scattering forward and back. If equal (or opposite) light enters a layer of depth h from both sides,
//! `(1 - Z)/(1 + Z)` of it leaves, with `Z = C X^-1 tanh(X h/2)` (or `A` before it), `X^2 = A C`. Z of a
//! thin layer is a rational function. Doubling is `Z' = 2 Z (1 + Z_o Z_e)^-1`, which, unlike doubling of
//! reflectances (van de Hulst 1963), conserves energy to rounding however often it is done.
//!
//! The forward peak beyond the order that the nodes resolve counts as unscattered (delta-M: Wiscombe, J.
//! Atmos. Sci. 34, 1408 (1977)). Light scattered once between two extra nodes still uses the whole phase
//! function (TMS: Nakajima & Tanaka, J. Quant. Spectrosc. Radiat. Transfer 40, 51 (1988)). Scattered light
//! of a node that the quadrature misses is added to its forward direction, so that none is lost.
//!
//! Valid for optical thickness above 0 (1e6 and more), albedo 0 to 1, |anisotropy| < 1; the number of nodes
//! grows as 1/(1 - |anisotropy|).

use std::f64::consts::PI;

use super::algebra::Operator;
use super::grid::Grid;
use super::matrix::Matrix;

/// Optical properties of a layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Model {
    /// Extinction along the normal.
    pub(super) thickness: f64,
    /// Scattered fraction of the extinction.
    pub(super) albedo: f64,
    /// Mean cosine of the scattering angle.
    pub(super) anisotropy: f64,
    /// Index of the medium.
    pub(super) index: f64,
}

/// A layer on a grid.
#[derive(Debug, Clone)]
pub(super) struct Slab {
    model: Model,
    /// Fraction of the peak, and the number of retained Legendre terms.
    peak: f64,
    terms: usize,
    /// Nodes of the grid that the medium carries: numbers, cosines, scales.
    nodes: Vec<usize>,
    cosine: Vec<f64>,
    scale: Vec<f64>,
    regular: usize,
    /// Scattered light of each node that the quadrature misses.
    missing: Vec<f64>,
}

impl Slab {
    pub(super) fn new(model: Model, terms: usize, grid: &Grid) -> Self {
        let nodes = grid.carried(model.index);
        let n = model.index;
        let cosine = nodes.iter().map(|&i| ((n - grid.beta[i]) * (n + grid.beta[i])).sqrt() / n).collect();
        let scale = nodes.iter().map(|&i| grid.scale[i]).collect();
        let regular = nodes.iter().filter(|&&i| i < grid.regular).count();
        // A backward peak (negative anisotropy) is not unscattered light.
        let peak = if model.anisotropy > 0.0 { model.anisotropy.powi(terms as i32) } else { 0.0 };
        let mut slab = Self { model, peak, terms, nodes, cosine, scale, regular, missing: Vec::new() };
        let both = slab.phase(0)[0].clone();
        let found = |i: usize| -> f64 {
            (0..regular).map(|j| 2.0 * slab.scale[j] * both[(i, j)] * slab.cosine[i]).sum::<f64>()
                / slab.scale[i]
        };
        slab.missing = (0..slab.nodes.len()).map(|i| 1.0 - found(i)).collect();
        slab
    }

    pub(super) fn model(&self) -> Model {
        self.model
    }

    /// Returns the same layer for the extra nodes of its grid alone.
    pub(super) fn extras(self, grid: &Grid) -> Self {
        let regular = self.regular;
        Self {
            nodes: self.nodes[regular..].iter().map(|i| i - grid.regular).collect(),
            cosine: self.cosine[regular..].to_vec(),
            scale: self.scale[regular..].to_vec(),
            missing: self.missing[regular..].to_vec(),
            regular: 0,
            ..self
        }
    }

    /// Returns the azimuthal order beyond which nothing scatters among nodes with weight.
    pub(super) fn orders(&self) -> usize {
        self.terms
    }

    /// Returns the even and odd halves `(P+ + P-)/2`, `(P+ - P-)/2` of the phase function in an order, as
    /// kernels per optical depth at an albedo of one.
    fn phase(&self, order: usize) -> [Matrix; 2] {
        let len = self.nodes.len();
        let exact = self.exact_terms();
        let legendre: Vec<Vec<f64>> =
            self.cosine.iter().map(|mu| legendre(*mu, order, self.terms.max(exact))).collect();
        let per_area = |i: usize| self.scale[i] / (self.cosine[i] * self.model.index);
        let half = |parity: usize| -> Matrix {
            let moments = |from: usize, terms: usize, moment: &dyn Fn(i32) -> f64| {
                let rows = self.cosine.len() - from;
                let degrees: Vec<usize> = (order..terms).filter(|l| (l + order) % 2 == parity).collect();
                let left =
                    Matrix::from_fn(rows, degrees.len(), |i, k| legendre[from + i][degrees[k] - order]);
                let right = Matrix::from_fn(degrees.len(), rows, |k, j| {
                    let l = degrees[k];
                    (2 * l + 1) as f64 * moment(l as i32) * legendre[from + j][l - order]
                });
                let mut sum = Matrix::zeros(rows, rows);
                sum.add_product(&left, &right, degrees.len());
                sum.scaled(1.0 / (4.0 * PI))
            };
            let (g, f) = (self.model.anisotropy, self.peak);
            let mut sum = moments(0, self.terms, &|l| (g.powi(l) - f) / (1.0 - f));
            let extra = moments(self.regular, exact, &|l| g.powi(l) / (1.0 - f));
            for j in self.regular..len {
                sum.column_mut(j)[self.regular..].copy_from_slice(extra.column(j - self.regular));
            }
            Matrix::from_fn(len, len, |i, j| sum[(i, j)] * per_area(i) * per_area(j))
        };
        [half(0), half(1)]
    }

    /// Returns the number of Legendre terms of the whole phase function, to rounding.
    fn exact_terms(&self) -> usize {
        let g = self.model.anisotropy.abs();
        if g < 1e-12 { 1 } else { ((1e-13_f64).ln() / g.ln()).ceil() as usize + 1 }.max(1)
    }

    /// Returns reflected (from either side) and transmitted light of an azimuthal order.
    pub(super) fn operators(&self, order: usize) -> [Operator; 2] {
        let Model { thickness, albedo, .. } = self.model;
        let tau = thickness * (1.0 - albedo * self.peak);
        let albedo = albedo * (1.0 - self.peak) / (1.0 - albedo * self.peak);
        let straight: Vec<f64> = self
            .cosine
            .iter()
            .zip(&self.missing)
            .map(|(mu, missing)| (1.0 - albedo * missing) / mu)
            .collect();
        let [even, odd] = self.phase(order).map(|half| Operator {
            regular: self.regular,
            straight: straight.clone(),
            kernel: Some(half.scaled(-2.0 * albedo).into()),
        });
        let steepest = straight.iter().copied().fold(0.0, f64::max);
        let doublings = (2.0 * tau * steepest).log2().ceil().max(0.0) as i32;
        let [mut z_even, mut z_odd] = thin(&even, &odd, 0.5 * tau * 0.5_f64.powi(doublings));
        for _ in 0..doublings {
            // Z_e (1 + Z_o Z_e)^-1 is its own transpose.
            let both = z_odd.after(&z_even).one_plus(1.0);
            [z_odd, z_even] = both.solve_both(&z_odd, &z_even).map(|z| z.scaled(2.0));
        }
        let [sum, difference] = [z_even, z_odd].map(|z| z.one_plus(1.0).solve(&z.one_plus(-1.0)));
        let mut reflected = sum.combine(0.5, &difference, -0.5);
        let mut transmitted = sum.combine(0.5, &difference, 0.5);
        reflected.straight.fill(0.0);
        transmitted.straight = straight.iter().map(|a| (-a * tau).exp()).collect();
        if order == 0 && albedo == 1.0 {
            self.conserve(&mut reflected, &transmitted);
        }
        [reflected, transmitted]
    }

    /// Removes rounding errors from the energy that a layer without absorption returns: between mirrors
    /// light meets it so often that they would matter.
    fn conserve(&self, reflected: &mut Operator, transmitted: &Operator) {
        let ones = vec![1.0; self.nodes.len()];
        let through = transmitted.pull_back(&ones, &self.scale);
        // The deficit of extra nodes is halved each time.
        for _ in 0..12 {
            let back = reflected.pull_back(&ones, &self.scale);
            let factor: Vec<f64> = back
                .iter()
                .zip(&through)
                .map(|(r, t)| if *r > 0.0 { 0.5 * (1.0 - t - r) / r } else { 0.0 })
                .collect();
            if let Some(kernel) = &mut reflected.kernel {
                *kernel = Matrix::from_fn(ones.len(), ones.len(), |i, j| {
                    kernel[(i, j)] * (1.0 + factor[i] + factor[j])
                })
                .into();
            }
        }
    }

    /// Extends an operator to the whole grid; nodes that the medium does not carry are zero.
    pub(super) fn spread(&self, operator: &Operator, grid: &Grid) -> Operator {
        let mut straight = vec![0.0; grid.len()];
        let mut kernel = Matrix::zeros(grid.len(), grid.len());
        for (a, &i) in self.nodes.iter().enumerate() {
            straight[i] = operator.straight[a];
            for (b, &j) in self.nodes.iter().enumerate() {
                kernel[(i, j)] = operator.at(a, b);
            }
        }
        Operator { regular: grid.regular, straight, kernel: Some(kernel.into()) }
    }
}

/// Returns Z of a thin layer for equal and opposite light from both sides: with `y = (X h/2)^2`,
/// `tanh(sqrt y)/sqrt y = (15 + y)/(15 + 6 y)`, error 6e-4 y^3; `half` is h/2.
fn thin(even: &Operator, odd: &Operator, half: f64) -> [Operator; 2] {
    let y = odd.after(even).scaled(half * half / 15.0);
    let ratio = y.one_plus(6.0).solve(&y.one_plus(1.0)).scaled(half);
    [even.after(&ratio), ratio.after(odd)]
}

/// Returns `sqrt((l - m)!/(l + m)!) P_l^m(mu)` for l from m up to `terms - 1`.
fn legendre(mu: f64, order: usize, terms: usize) -> Vec<f64> {
    let sine = ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt();
    let first = (1..=order).map(|k| (1.0 - 0.5 / k as f64).sqrt() * sine).product();
    let mut values: Vec<f64> = Vec::with_capacity(terms.saturating_sub(order));
    let m = order as f64;
    let (mut now, mut before) = (first, 0.0);
    for l in order..terms {
        values.push(now);
        let l = l as f64;
        let next = ((2.0 * l + 1.0) * mu * now - (l * l - m * m).max(0.0).sqrt() * before)
            / ((l + 1.0) * (l + 1.0) - m * m).sqrt();
        (now, before) = (next, now);
    }
    values
}
