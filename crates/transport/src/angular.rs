//! Reflectance spectra tabulated against direction, for specular pixels.
//!
//! Interpolation is linear in the tabulated values, so a sum of weighted look-ups equals one product of the
//! table with the summed weights: the Monte Carlo solver adds weights to nodes and forms spectra once at the
//! end.
//!
//! The values are those of a few *basis* reflectances (one for each gap of a film pixel); a drive state is a
//! mixture of them plus a part that all states share.

use std::f64::consts::TAU;
use std::sync::Arc;

use papilio_optics::{Beta, with_widest_simd};

use crate::base::largest;
use crate::numerics::product::add_product;
use crate::{CosinePanels, Medium};

/// Positions of the nodes of a table.
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "there is one table, not many")]
pub enum Nodes {
    /// One value for all directions.
    Constant,
    /// Uniformly spaced in cos(theta) of the medium from 0 to 1, at least 8 of them. The reflectance of a
    /// film is analytic in that cosine; eight-point Lagrange interpolation.
    Cosines(usize),
    /// In panels of different widths; interpolation among all nodes of a panel.
    CosinePanels(CosinePanels),
    /// At these angles in the medium, radians, ascending from 0; linear between them, with the last value
    /// beyond the last angle.
    AnglesInMedium(Vec<f64>),
    /// At these angles in air, with the same interpolation.
    AnglesInAir(Vec<f64>),
    /// At any of the others, for a pixel that depends on azimuth: each state has this many harmonics of twice the azimuth, as basis
    /// reflectances in the order 1, cos 2 phi, sin 2 phi, cos 4 phi, ...; the mixtures hold the first of each state, the mean over azimuth.
    Azimuthal(Box<Nodes>, usize),
}

impl Nodes {
    /// Returns the number of nodes.
    pub fn count(&self) -> usize {
        match self {
            Self::Constant => 1,
            Self::Cosines(nodes) => *nodes,
            Self::CosinePanels(panels) => panels.count(),
            Self::AnglesInMedium(angles) | Self::AnglesInAir(angles) => angles.len(),
            Self::Azimuthal(nodes, _) => nodes.count(),
        }
    }

    /// Returns values of `|beta|` between which the table is smooth and changes no faster than a few points
    /// of a Gauss rule resolve: every kink of a linear table, every [`SMOOTH_STEPS`] of a finer one.
    pub(crate) fn breaks(&self, index: f64) -> Vec<f64> {
        let of_cosine = |cosine: f64| index * (1.0 - cosine * cosine).max(0.0).sqrt();
        match self {
            Self::Constant => Vec::new(),
            Self::Cosines(nodes) => {
                let step = 1.0 / (nodes - 1) as f64;
                (0..*nodes).step_by(SMOOTH_STEPS).map(|node| of_cosine(node as f64 * step)).collect()
            }
            Self::CosinePanels(panels) => panels.halves().map(of_cosine).collect(),
            Self::AnglesInMedium(angles) => angles.iter().map(|angle| index * angle.sin()).collect(),
            Self::AnglesInAir(angles) => angles.iter().map(|angle| angle.sin()).collect(),
            Self::Azimuthal(nodes, _) => nodes.breaks(index),
        }
    }

    /// Returns the number of nodes from one `|beta|` to a larger one, in a medium of this index.
    pub(crate) fn between(&self, [from, to]: [f64; 2], index: f64) -> f64 {
        let cosine = |beta: f64| (1.0 - (beta / index).powi(2)).max(0.0).sqrt();
        let inside = |angles: &[f64], index: f64| {
            angles.iter().filter(|angle| (from..to).contains(&(index * angle.sin()))).count() as f64
        };
        match self {
            Self::Constant => 0.0,
            Self::Cosines(nodes) => (cosine(from) - cosine(to)) * (nodes - 1) as f64,
            Self::CosinePanels(panels) => panels.nodes_from(cosine(to), cosine(from)),
            Self::AnglesInMedium(angles) => inside(angles, index),
            Self::AnglesInAir(angles) => inside(angles, 1.0),
            Self::Azimuthal(nodes, _) => nodes.between([from, to], index),
        }
    }

    /// Returns the nodes over the inclination alone.
    pub fn of_inclination(&self) -> &Self {
        match self {
            Self::Azimuthal(nodes, _) => nodes,
            nodes => nodes,
        }
    }

    /// Returns whether the table is linear between angles, with kinks there.
    pub(crate) fn has_kinks(&self) -> bool {
        matches!(self.of_inclination(), Self::AnglesInMedium(_) | Self::AnglesInAir(_))
    }

    /// Returns the weights on the nodes of a look-up at `|beta|^2` in a medium of this index.
    #[inline(always)]
    pub(crate) fn stencil(&self, beta_squared: f64, index: f64) -> Stencil {
        match self.of_inclination() {
            Self::Constant | Self::Azimuthal(..) => Stencil::ONLY_NODE,
            Self::Cosines(nodes) => {
                let cosine = (1.0 - beta_squared / (index * index)).max(0.0).sqrt();
                Stencil::lagrange(cosine * (nodes - 1) as f64, *nodes)
            }
            Self::CosinePanels(panels) => {
                panels.stencil((1.0 - beta_squared / (index * index)).max(0.0).sqrt())
            }
            Self::AnglesInMedium(angles) => {
                Stencil::linear((beta_squared.sqrt() / index).min(1.0).asin(), angles)
            }
            Self::AnglesInAir(angles) => Stencil::linear(beta_squared.sqrt().min(1.0).asin(), angles),
        }
    }
}

/// Number of steps between nodes over which the function is smooth: where eight-point interpolation is
/// accurate, singularities are several nodes away.
const SMOOTH_STEPS: usize = 8;

/// Interpolation weights for consecutive nodes from `first` on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stencil {
    pub(crate) first: usize,
    pub(crate) weights: [f64; Stencil::LEN],
}

impl Stencil {
    pub(crate) const LEN: usize = 16;

    /// Number of nodes of the interpolation between uniformly spaced ones.
    const EVEN: usize = 8;

    /// Look-up of a table with one node.
    pub(crate) const ONLY_NODE: Self = {
        let mut weights = [0.0; Self::LEN];
        weights[0] = 1.0;
        Self { first: 0, weights }
    };

    /// Eight-point Lagrange interpolation at position `x` among nodes 0, 1, ... `nodes - 1`.
    #[inline]
    pub(crate) fn lagrange(x: f64, nodes: usize) -> Self {
        // 1 over the product of k - j over all other j.
        const SCALE: [f64; Stencil::EVEN] = [
            -1.0 / 5040.0,
            1.0 / 720.0,
            -1.0 / 240.0,
            1.0 / 144.0,
            -1.0 / 144.0,
            1.0 / 240.0,
            -1.0 / 720.0,
            1.0 / 5040.0,
        ];
        let first = (x as usize).saturating_sub(Self::EVEN / 2 - 1).min(nodes - Self::EVEN);
        let mut weights = [0.0; Self::LEN];
        weights[..Self::EVEN].copy_from_slice(&SCALE);
        let (mut left, mut right) = (1.0, 1.0);
        for k in 0..Self::EVEN {
            weights[k] *= left;
            left *= x - (first + k) as f64;
            let mirrored = Self::EVEN - 1 - k;
            weights[mirrored] *= right;
            right *= x - (first + mirrored) as f64;
        }
        Self { first, weights }
    }

    /// Linear interpolation of `x` among ascending `nodes`.
    fn linear(x: f64, nodes: &[f64]) -> Self {
        let mut weights = [0.0; Self::LEN];
        if nodes.len() < 2 {
            weights[0] = 1.0;
            return Self { first: 0, weights };
        }
        let right = nodes.partition_point(|&node| node < x).clamp(1, nodes.len() - 1);
        let t = ((x - nodes[right - 1]) / (nodes[right] - nodes[right - 1])).clamp(0.0, 1.0);
        weights[0] = 1.0 - t;
        weights[1] = t;
        Self { first: right - 1, weights }
    }
}

/// Reflectance by node, basis and wavelength, and the mixtures of the basis that make the states.
#[derive(Debug, Clone, PartialEq)]
pub struct AngularTable {
    /// Positions of the nodes.
    pub nodes: Nodes,
    /// Basis reflectances, shape `[node][basis][wavelength]`; shared, because they are large.
    pub basis: Arc<[f64]>,
    /// The fraction of each basis in each state, shape `[state][basis]`.
    pub mixture: Vec<f64>,
    /// Additional reflectance common to all states, shape `[wavelength]`.
    pub common: Vec<f64>,
}

impl AngularTable {
    /// Returns the number of basis reflectances.
    pub fn basis_count(&self) -> usize {
        self.basis.len() / (self.nodes.count() * self.common.len())
    }

    /// Returns the number of states.
    pub fn state_count(&self) -> usize {
        self.mixture.len() / self.basis_count()
    }

    /// Returns whether the reflectances depend on azimuth.
    pub fn is_azimuthal(&self) -> bool {
        matches!(self.nodes, Nodes::Azimuthal(..))
    }

    /// Computes the reflectance of every state at `|beta|^2`: `out` has shape `[state][wavelength]`. Of a pixel that depends on
    /// azimuth, this is the mean over azimuth.
    pub fn reflectance(&self, beta_squared: f64, medium: &Medium, out: &mut [f64]) {
        self.reflectance_mixed(&self.mixture, beta_squared, medium, out);
    }

    /// Computes the same for light that leaves towards `beta`, with its azimuth.
    pub fn reflectance_towards(&self, beta: Beta, medium: &Medium, out: &mut [f64]) {
        let Nodes::Azimuthal(_, harmonics) = self.nodes else {
            return self.reflectance(beta.squared(), medium, out);
        };
        let (turn, squared) = (2.0 * beta.y.atan2(beta.x), beta.squared());
        let waves: Vec<f64> = (0..harmonics).map(|k| harmonic(k, turn)).collect();
        let (bins, width) = (self.common.len(), self.basis_count() * self.common.len());
        let (mut basis, mut weights) = (vec![0.0; width], vec![0.0; harmonics]);
        let index = medium.constant_index();
        with_widest_simd(
            #[inline(always)]
            || {
                for bin in 0..if index.is_some() { 1 } else { bins } {
                    let stencil = self.nodes.stencil(squared, index.unwrap_or_else(|| medium.index()[bin]));
                    let range = if index.is_some() { 0..bins } else { bin..bin + 1 };
                    let nodes = (stencil.first..self.nodes.count()).zip(stencil.weights);
                    for (node, of_node) in nodes.filter(|(_, weight)| *weight != 0.0) {
                        weights.iter_mut().zip(&waves).for_each(|(weight, wave)| *weight = of_node * wave);
                        self.add_harmonics(node, &weights, range.clone(), &mut basis);
                    }
                }
                mix((&self.mixture, &self.common), &basis, 1.0, out);
            },
        );
    }

    /// Adds the harmonics of each reflectance at a node, with these weights, to its mean, at some of the wavelengths.
    #[inline(always)]
    fn add_harmonics(&self, node: usize, weights: &[f64], range: std::ops::Range<usize>, basis: &mut [f64]) {
        let (bins, width) = (self.common.len(), basis.len());
        let row = &self.basis[node * width..][..width];
        let of_each = weights.len() * bins;
        for (values, sums) in row.chunks_exact(of_each).zip(basis.chunks_exact_mut(of_each)) {
            if range.len() == bins {
                add_rows(&mut sums[..bins], values, weights);
                continue;
            }
            for bin in range.clone() {
                let terms = weights.iter().enumerate();
                sums[bin] += terms.map(|(k, weight)| weight * values[k * bins + bin]).sum::<f64>();
            }
        }
    }

    fn reflectance_mixed(&self, mixture: &[f64], beta_squared: f64, medium: &Medium, out: &mut [f64]) {
        let (bins, width) = (self.common.len(), self.basis_count() * self.common.len());
        let mut basis = vec![0.0; width];
        if let Some(index) = medium.constant_index() {
            let stencil = self.nodes.stencil(beta_squared, index);
            with_widest_simd(
                #[inline(always)]
                || self.add_nodes(&stencil, &mut basis),
            );
        } else {
            for bin in 0..bins {
                let stencil = self.nodes.stencil(beta_squared, medium.index()[bin]);
                for at in (bin..width).step_by(bins) {
                    basis[at] = (stencil.first..self.nodes.count())
                        .zip(stencil.weights)
                        .map(|(node, weight)| weight * self.basis[node * width + at])
                        .sum();
                }
            }
        }
        with_widest_simd(
            #[inline(always)]
            || mix((mixture, &self.common), &basis, 1.0, out),
        );
    }

    /// Returns the number of harmonics of each state over the azimuth.
    pub(crate) fn harmonics(&self) -> usize {
        if let Nodes::Azimuthal(_, harmonics) = self.nodes { harmonics } else { 1 }
    }

    /// Returns weights of 0 on the nodes and harmonics, for a sum of look-ups of many directions; `[node][harmonic]`.
    pub(crate) fn no_weights(&self) -> Vec<f64> {
        vec![0.0; (self.nodes.count() + Stencil::LEN) * self.harmonics()]
    }

    /// Adds the look-up of light that leaves towards `beta` in a medium of this index.
    pub(crate) fn add_direction(&self, weights: &mut [f64], (beta, index): (Beta, f64), weight: f64) {
        let (turn, squared) = (2.0 * beta.y.atan2(beta.x), beta.squared());
        if squared < index * index && weight != 0.0 {
            let waves = (0..self.harmonics()).map(|k| weight * harmonic(k, turn)).collect::<Vec<_>>();
            self.add_waves(weights, (squared, index), &waves);
        }
    }

    /// Returns the harmonics of this many uniform azimuths from 0 on, `[azimuth][harmonic]`.
    pub(crate) fn waves(&self, azimuths: usize) -> Vec<f64> {
        let turn = |azimuth: usize| 2.0 * TAU * azimuth as f64 / azimuths as f64;
        (0..azimuths).flat_map(|at| (0..self.harmonics()).map(move |k| harmonic(k, turn(at)))).collect()
    }

    /// Adds the look-ups of a ring of these azimuths, with their weights and the [`waves`](Self::waves) of their number.
    /// Inlined, so that it is compiled for the instruction set of its caller.
    #[inline(always)]
    pub(crate) fn add_ring(
        &self,
        weights: &mut [f64],
        (squared, index): (f64, f64),
        (along, waves): (&[f64], &[f64]),
    ) {
        let mut sums = vec![0.0; self.harmonics()];
        add_rows(&mut sums, waves, along);
        self.add_waves(weights, (squared, index), &sums);
    }

    fn add_waves(&self, weights: &mut [f64], (squared, index): (f64, f64), waves: &[f64]) {
        let stencil = self.nodes.stencil(squared, index);
        let rows = weights.chunks_exact_mut(waves.len()).skip(stencil.first);
        for (row, of_node) in rows.zip(stencil.weights) {
            row.iter_mut().zip(waves).for_each(|(sum, wave)| *sum += of_node * wave);
        }
    }

    /// Returns the sum of these look-ups; `[state][wavelength]`.
    pub(crate) fn sum_of(&self, weights: &[f64]) -> Vec<f64> {
        let (harmonics, bins, count) = (self.harmonics(), self.common.len(), self.basis_count());
        let mut basis = vec![0.0; count * bins];
        with_widest_simd(
            #[inline(always)]
            || {
                let nodes = weights.chunks_exact(harmonics).take(self.nodes.count()).enumerate();
                for (node, weights) in
                    nodes.filter(|(_, weights)| weights.iter().any(|weight| *weight != 0.0))
                {
                    self.add_harmonics(node, weights, 0..bins, &mut basis);
                }
            },
        );
        let total: f64 = weights.iter().step_by(harmonics).sum();
        let mut out = vec![0.0; self.state_count() * bins];
        mix((&self.mixture, &self.common), &basis, total, &mut out);
        out
    }

    /// Returns sums of look-ups whose weights were added to the nodes; shape `[sum][state][wavelength]`.
    pub(crate) fn weighted_sums(&self, node_weights: &[&[f64]]) -> Vec<f64> {
        let width = self.basis_count() * self.common.len();
        let mut basis = vec![0.0; node_weights.len() * width];
        add_product(&node_weights.concat(), &self.basis, self.nodes.count(), &mut basis);
        let mut sums = vec![0.0; node_weights.len() * self.state_count() * self.common.len()];
        let one_sum = (self.state_count() * self.common.len()).max(1);
        for ((out, basis), weights) in
            sums.chunks_exact_mut(one_sum).zip(basis.chunks_exact(width.max(1))).zip(node_weights)
        {
            with_widest_simd(
                #[inline(always)]
                || self.mix(basis, weights.iter().sum(), out),
            );
        }
        sums
    }

    /// Returns whether the basis is the same object, and the states are the same mixtures of it.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.basis, &other.basis)
            && self.mixture == other.mixture
            && self.common == other.common
            && self.nodes == other.nodes
    }

    /// Returns at each node the mean over states and wavelengths of the reflectance, relative to that of the
    /// same state at the node nearest to the normal.
    pub(crate) fn relative_reflectance(&self) -> Vec<f64> {
        let (bins, count, nodes) = (self.common.len(), self.basis_count(), self.nodes.count());
        let mean = |row: &[f64]| row.iter().sum::<f64>() / bins as f64;
        let of_basis: Vec<f64> = self.basis.chunks_exact(bins.max(1)).map(mean).collect();
        let common = mean(&self.common);
        let mut sum = vec![0.0; nodes];
        for shares in self.mixture.chunks_exact(count) {
            let at = |node: usize| {
                let basis = &of_basis[node * count..][..count];
                common + shares.iter().zip(basis).map(|(share, value)| share * value).sum::<f64>()
            };
            // Cosines ascend towards the normal, angles away from it.
            let normal = match self.nodes.of_inclination() {
                Nodes::Cosines(_) | Nodes::CosinePanels(_) => at(nodes - 1),
                _ => at(0),
            };
            for (node, sum) in sum.iter_mut().enumerate().filter(|_| normal > 0.0) {
                *sum += at(node) / (normal * self.state_count() as f64);
            }
        }
        sum
    }

    /// Returns an upper bound of the reflectance of every state at any angle, from that of the basis.
    pub(crate) fn largest_reflectance(&self, of_basis: f64) -> f64 {
        (of_basis + largest(&self.common)).min(1.0)
    }

    #[inline(always)]
    fn add_nodes(&self, stencil: &Stencil, basis: &mut [f64]) {
        let used = stencil.weights.iter().rposition(|weight| *weight != 0.0).map_or(0, |last| last + 1);
        add_rows(basis, &self.basis[stencil.first * basis.len()..], &stencil.weights[..used]);
    }

    /// Computes all states from sums of the basis.
    #[inline(always)]
    fn mix(&self, basis: &[f64], common_weight: f64, out: &mut [f64]) {
        mix((&self.mixture, &self.common), basis, common_weight, out);
    }
}

/// Harmonic number `k` of twice the azimuth, `turn`: 1, cos, sin, cos of twice that, ...
pub(crate) fn harmonic(k: usize, turn: f64) -> f64 {
    let (sin, cos) = (k.div_ceil(2) as f64 * turn).sin_cos();
    if k.is_multiple_of(2) && k > 0 { sin } else { cos }
}

/// Computes all states, `[state][wavelength]`, from sums of basis reflectances, `[basis][wavelength]`, and
/// the sum of the weights of the common reflectance. The mixtures are `[state][basis]`.
#[inline(always)]
pub(crate) fn mix(mixing: (&[f64], &[f64]), basis: &[f64], common_weight: f64, out: &mut [f64]) {
    match mixing.1.len() {
        32.. => mix_columns::<32>(mixing, basis, common_weight, out),
        8.. => mix_columns::<8>(mixing, basis, common_weight, out),
        _ => mix_columns::<1>(mixing, basis, common_weight, out),
    }
}

/// Computes the same, `N` wavelengths at a time; the last block overlaps the one before instead of being
/// done one by one.
#[inline(always)]
fn mix_columns<const N: usize>(
    (mixture, common): (&[f64], &[f64]),
    basis: &[f64],
    common_weight: f64,
    out: &mut [f64],
) {
    let (bins, count) = (common.len(), basis.len() / common.len());
    for (row, shares) in out.chunks_exact_mut(bins).zip(mixture.chunks_exact(count)) {
        for first in (0..bins).step_by(N).map(|first| first.min(bins - N)) {
            let mut mixed = [0.0; N];
            let common = &common[first..][..N];
            mixed.iter_mut().zip(common).for_each(|(value, common)| *value = common * common_weight);
            for (of_basis, share) in basis.chunks_exact(bins).zip(shares).filter(|(_, share)| **share != 0.0)
            {
                let values = &of_basis[first..][..N];
                mixed.iter_mut().zip(values).for_each(|(value, of_basis)| *value += share * of_basis);
            }
            row[first..][..N].copy_from_slice(&mixed);
        }
    }
}

/// Adds weighted consecutive rows.
#[inline(always)]
pub(crate) fn add_rows(sum: &mut [f64], rows: &[f64], weights: &[f64]) {
    // As many columns as the registers hold over all rows, and then the rest.
    let done = add_columns::<32>(sum, rows, weights, 0);
    let done = add_columns::<8>(sum, rows, weights, done);
    add_columns::<1>(sum, rows, weights, done);
}

/// Adds columns from the first on, `N` at a time; returns the next one.
#[inline(always)]
fn add_columns<const N: usize>(sum: &mut [f64], rows: &[f64], weights: &[f64], first: usize) -> usize {
    let len = sum.len().max(1);
    let (chunks, _) = sum[first..].as_chunks_mut::<N>();
    for (number, chunk) in chunks.iter_mut().enumerate() {
        let mut sums = *chunk;
        for (row, weight) in rows.chunks_exact(len).zip(weights) {
            let row = &row[first + number * N..][..N];
            sums.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
        }
        *chunk = sums;
    }
    first + chunks.len() * N
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_points_reproduce_a_septic() {
        let septic = |x: f64| 1.0 - 2.0 * x + 3.0 * x.powi(3) - 0.5 * x.powi(7);
        let nodes = Nodes::Cosines(9);
        for step in 0..=100 {
            let theta = f64::from(step) * std::f64::consts::FRAC_PI_2 / 100.0;
            let index = 1.5;
            let stencil = nodes.stencil((index * theta.sin()).powi(2), index);
            let found: f64 = stencil
                .weights
                .iter()
                .enumerate()
                .map(|(k, weight)| weight * septic((stencil.first + k) as f64 / 8.0))
                .sum();
            assert!((found - septic(theta.cos())).abs() < 1e-12, "{step}");
        }
    }

    #[test]
    fn angles_interpolate_linearly_and_hold_the_last_value() {
        let nodes = Nodes::AnglesInAir(vec![0.0, 0.2, 0.6]);
        let stencil = nodes.stencil(0.3_f64.sin().powi(2), 1.5);
        assert_eq!(stencil.first, 1);
        assert!((stencil.weights[1] - 0.25).abs() < 1e-12);
        let beyond = nodes.stencil(1.0, 1.5);
        assert_eq!((beyond.first, beyond.weights[0], beyond.weights[1]), (1, 0.0, 1.0));
    }

    /// Two states over angles in air, with harmonics up to 4 phi: linear between the angles.
    #[test]
    fn harmonics_of_the_azimuth_are_interpolated_over_angles() {
        let of = |state: usize, node: usize| [0.5 - 0.3 * state as f64, 0.2 * node as f64, 0.1, 0.0, 0.3];
        let basis: Vec<f64> = (0..2).flat_map(|node| (0..2).flat_map(move |state| of(state, node))).collect();
        let own = |k: usize| f64::from(k == 0 || k == 15);
        let nodes = Nodes::Azimuthal(Box::new(Nodes::AnglesInAir(vec![0.0, 1.0])), 5);
        let table = AngularTable {
            nodes,
            basis: basis.into(),
            mixture: (0..20).map(own).collect(),
            common: vec![0.0],
        };
        assert!(table.is_azimuthal() && table.state_count() == 2);
        let medium = Medium::new(vec![1.5].into());
        for (theta, phi) in [(0.1, 0.3), (0.25, 1.0), (0.8, -2.0), (1.4, 0.7)] {
            let beta = Beta { x: f64::sin(theta) * f64::cos(phi), y: f64::sin(theta) * f64::sin(phi) };
            let mut found = [0.0; 2];
            table.reflectance_towards(beta, &medium, &mut found);
            for (state, found) in found.iter().enumerate() {
                let swing = 0.2 * theta.min(1.0) * (2.0 * phi).cos()
                    + 0.1 * (2.0 * phi).sin()
                    + 0.3 * (4.0 * phi).sin();
                let expected = 0.5 - 0.3 * state as f64 + swing;
                assert!((found - expected).abs() < 1e-12, "{theta} {phi}: {found} {expected}");
            }
            let mut mean = [0.0; 2];
            table.reflectance(beta.squared(), &medium, &mut mean);
            assert!((mean[0] - 0.5).abs() < 1e-12 && (mean[1] - 0.2).abs() < 1e-12);
        }
    }

    /// For numbers of wavelengths below and above the number mixed at a time, with and without a remainder.
    #[test]
    fn states_are_mixtures_of_the_basis() {
        for bins in [1, 3, 8, 9, 31, 32, 33, 64, 81] {
            let value = |at: usize| (at * at % 23) as f64 / 23.0;
            let table = AngularTable {
                nodes: Nodes::Constant,
                basis: (0..2 * bins).map(value).collect(),
                mixture: vec![1.0, 0.0, 0.25, 0.5, -0.5, 2.0],
                common: (0..bins).map(|bin| value(bin + 7)).collect(),
            };
            let mut found = vec![f64::NAN; 3 * bins];
            table.mix(&table.basis, 0.5, &mut found);
            for (state, shares) in table.mixture.chunks_exact(2).enumerate() {
                for bin in 0..bins {
                    let of_basis = shares[0] * value(bin) + shares[1] * value(bins + bin);
                    let expected = 0.5 * value(bin + 7) + of_basis;
                    assert!((found[state * bins + bin] - expected).abs() < 1e-14, "{bins}: {state} {bin}");
                }
            }
        }
    }

    #[test]
    fn summed_weights_give_the_sum_of_look_ups() {
        let nodes = Nodes::Cosines(8);
        let basis: Vec<f64> = (0..8 * 2 * 3).map(|i| f64::from(i * i % 17) / 17.0).collect();
        let (mixture, common) = (vec![1.0, 0.0, 0.25, 0.5], vec![0.1, 0.2, 0.3]);
        let table = AngularTable { nodes, basis: basis.into(), mixture, common };
        let medium = Medium::new(vec![1.5; 3].into());
        let mut weights = vec![0.0; 8];
        let (mut sum, mut one) = (vec![0.0; 6], vec![0.0; 6]);
        for (beta_squared, weight) in [(0.0, 1.0), (0.3, 0.5), (2.2, 2.0)] {
            table.reflectance(beta_squared, &medium, &mut one);
            sum.iter_mut().zip(&one).for_each(|(sum, value)| *sum += weight * value);
            let stencil = table.nodes.stencil(beta_squared, 1.5);
            for (k, w) in stencil.weights.iter().enumerate().filter(|(_, w)| **w != 0.0) {
                weights[stencil.first + k] += w * weight;
            }
        }
        let both = table.weighted_sums(&[&[1.0; 8], &weights]);
        assert!(both[6..].iter().zip(&sum).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
