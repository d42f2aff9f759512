//! Sums that the tracers accumulate.

use pulp::{Arch, Simd, WithSimd};

use super::add_scaled;
use crate::angular::Stencil;
use crate::{Base, CosinePanels, Reflector};

/// Light reflected by the base, as a path carries it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Reflected<'a> {
    /// On a first pass: the look-up that gives the reflectance of the base.
    LookUp(Stencil),
    /// Later: spectra that contain all reflections of the path; shape `[state][wavelength]`.
    Spectra(&'a [f64]),
}

/// Number of look-ups that are added side by side, and the number of registers that they fill.
const SIDE_BY_SIDE: usize = 8;
const IN_TURN: usize = 4;

/// Numbers of the look-ups that wait.
type Waiting = [f64; WAITING];
const WAITING: usize = SIDE_BY_SIDE * IN_TURN;

/// Sums of look-ups in a panel of a table, as [`CosinePanels::add_moments`] takes them: for each polynomial,
/// one for each position of a look-up among those side by side.
type Moments = [[f64; SIDE_BY_SIDE]; CosinePanels::NODES];

/// Look-ups in a panel of a table: they wait until there are enough of them to fill the registers.
#[derive(Debug, Clone)]
struct InPanel {
    /// Borders of the panel: the first of its cosines, and one over half their width.
    borders: [f64; 2],
    waiting: usize,
    cosines: Waiting,
    weights: Waiting,
    /// Once there were enough look-ups: sums with weights, and without (zero if not requested).
    moments: Option<Box<[Moments; 2]>>,
}

/// A sum of weighted [`Reflected`] light: weights on table nodes, and spectra.
#[derive(Debug, Clone)]
pub(super) struct Channel {
    nodes: Vec<f64>,
    /// Look-ups that are added by their moments, for each panel of the table.
    panels: Vec<InPanel>,
    /// Whether look-ups are also added without their weights.
    counted: bool,
    spectra: Vec<f64>,
}

impl Channel {
    pub(super) fn new(base: &Base) -> Self {
        let nodes = match &base.reflector {
            Reflector::Specular(table) => table.nodes.count(),
            Reflector::Lambertian(_) | Reflector::Scattering(_) => 1,
        };
        // A look-up always covers `Stencil::LEN` consecutive nodes.
        Self {
            nodes: vec![0.0; nodes + Stencil::LEN],
            panels: Vec::new(),
            counted: false,
            spectra: vec![0.0; base.states() * base.bins()],
        }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, light: Reflected<'_>, weight: f64) {
        match light {
            Reflected::LookUp(stencil) => self.look_up(&stencil, weight),
            Reflected::Spectra(spectra) => add_scaled(&mut self.spectra, spectra, weight),
        }
    }

    /// Adds light on its first pass.
    #[inline(always)]
    pub(super) fn look_up(&mut self, stencil: &Stencil, weight: f64) {
        let slots = &mut self.nodes[stencil.first..][..Stencil::LEN];
        slots.iter_mut().zip(&stencil.weights).for_each(|(slot, w)| *slot += w * weight);
    }

    /// Allocates workspace for look-ups in panels, to be added also without their weights or not.
    pub(super) fn prepare(&mut self, panels: &CosinePanels, counted: bool) {
        if self.panels.is_empty() {
            self.panels = panels.borders().map(InPanel::new).collect();
            self.counted = counted;
        }
    }

    /// Adds light on its first pass, in the panel of this number.
    #[inline(always)]
    pub(super) fn look_up_in_panel(&mut self, number: usize, cosine: f64, weight: f64) {
        let panel = &mut self.panels[number];
        // The remainder tells the compiler that the index is within bounds.
        let at = panel.waiting % panel.cosines.len();
        panel.cosines[at] = cosine;
        panel.weights[at] = weight;
        panel.waiting = at + 1;
        if panel.waiting == panel.cosines.len() {
            panel.add_waiting(self.counted);
        }
    }

    /// Returns the weights on the nodes of a table, and the weights as they would be if every look-up in a
    /// panel had weight one (zero if not requested).
    pub(super) fn node_weights(&self) -> [Vec<f64>; 2] {
        let mut weights = [self.nodes.clone(), vec![0.0; self.nodes.len()]];
        for (number, panel) in self.panels.iter().enumerate() {
            let Some(moments) = panel.whole(self.counted) else { continue };
            for (weights, moments) in weights.iter_mut().zip(&moments) {
                let of_panel = &mut weights.as_chunks_mut().0[number];
                CosinePanels::add_moments(moments, of_panel);
            }
        }
        weights
    }

    /// Returns the total sums of several channels, each with its weights on nodes and times its scale; shape
    /// `[sum][state][wavelength]`.
    pub(super) fn sums(channels: &[(&Self, Vec<f64>, f64)], base: &Base) -> Vec<f64> {
        let mut sums: Vec<f64> = match &base.reflector {
            Reflector::Specular(table) => {
                let count = table.nodes.count();
                let nodes: Vec<&[f64]> = channels.iter().map(|(_, nodes, _)| &nodes[..count]).collect();
                table.weighted_sums(&nodes)
            }
            Reflector::Lambertian(reflectance) => {
                channels.iter().flat_map(|(_, nodes, _)| reflectance.iter().map(|r| r * nodes[0])).collect()
            }
            // Such a base occurs only under general layers, never in a panel.
            Reflector::Scattering(_) => {
                channels.iter().flat_map(|(channel, ..)| channel.spectra.iter().map(|_| 0.0)).collect()
            }
        };
        let len = (base.states() * base.bins()).max(1);
        for (sum, (channel, _, scale)) in sums.chunks_exact_mut(len).zip(channels) {
            sum.iter_mut().zip(&channel.spectra).for_each(|(value, s)| *value = (*value + s) * scale);
        }
        sums
    }
}

impl InPanel {
    const NO_MOMENTS: [Moments; 2] = [[[0.0; SIDE_BY_SIDE]; CosinePanels::NODES]; 2];

    fn new(borders: [f64; 2]) -> Self {
        Self { borders, waiting: 0, cosines: [0.0; WAITING], weights: [0.0; WAITING], moments: None }
    }

    #[inline(never)]
    fn add_waiting(&mut self, counted: bool) {
        let Self { borders, cosines, weights, moments, .. } = self;
        let (moments, counts) = (moments.get_or_insert_with(|| Box::new(Self::NO_MOMENTS)), &[1.0; WAITING]);
        Arch::new().dispatch(AddPolynomials {
            borders: *borders,
            cosines,
            weights,
            counts: counted.then_some(counts),
            moments,
        });
        self.waiting = 0;
    }

    /// Returns the moments, including look-ups that still wait; `None` if there are none.
    fn whole(&self, counted: bool) -> Option<[[f64; CosinePanels::NODES]; 2]> {
        let Self { borders, waiting, cosines, mut weights, ref moments } = *self;
        if waiting == 0 && moments.is_none() {
            return None;
        }
        let mut whole = moments.as_deref().copied().unwrap_or(Self::NO_MOMENTS);
        let mut counts = [1.0; WAITING];
        weights[waiting..].fill(0.0);
        counts[waiting..].fill(0.0);
        let (cosines, weights, counts, moments) =
            (&cosines, &weights, counted.then_some(&counts), &mut whole);
        Arch::new().dispatch(AddPolynomials { borders, cosines, weights, counts, moments });
        Some(whole.map(|moments| moments.map(|side_by_side| side_by_side.iter().sum())))
    }
}

/// Adds Chebyshev polynomials of degrees 0, 1, ... times weights and times counts.
struct AddPolynomials<'a> {
    borders: [f64; 2],
    cosines: &'a Waiting,
    weights: &'a Waiting,
    counts: Option<&'a Waiting>,
    moments: &'a mut [Moments; 2],
}

impl WithSimd for AddPolynomials<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { borders: [start, per_half_width], cosines, weights, counts, moments: [weighted, counted] } =
            self;
        // From -1 to 1.
        let mut places = *cosines;
        places.iter_mut().for_each(|place| *place = (*place - start) * per_half_width - 1.0);
        let places = &places;
        match counts {
            Some(counts) => add(simd, places, [weights, counts], [weighted, counted]),
            None => add(simd, places, [weights], [weighted]),
        }
    }
}

/// Multiplies the polynomials by each of several factors.
#[allow(clippy::needless_range_loop, reason = "a degree of several sums at a time")]
#[inline(always)]
fn add<S: Simd, const N: usize>(simd: S, places: &Waiting, factors: [&Waiting; N], sums: [&mut Moments; N]) {
    let lanes = S::F64_LANES.min(SIDE_BY_SIDE);
    for first in (0..SIDE_BY_SIDE).step_by(lanes) {
        let load = |of: &Waiting, row: usize| {
            let at = first + row * SIDE_BY_SIDE;
            S::as_simd_f64s(&of[at..at + lanes]).0[0]
        };
        let [mut twice, mut before, mut now] = [[simd.splat_f64s(1.0); IN_TURN]; 3];
        for row in 0..IN_TURN {
            before[row] = load(places, row);
            twice[row] = simd.add_f64s(before[row], before[row]);
        }
        let factors = factors.map(|factor| {
            let mut rows = [simd.splat_f64s(0.0); IN_TURN];
            rows.iter_mut().enumerate().for_each(|(row, of)| *of = load(factor, row));
            rows
        });
        for degree in 0..CosinePanels::NODES {
            for n in 0..N {
                let sum = &mut S::as_mut_simd_f64s(&mut sums[n][degree][first..first + lanes]).0[0];
                for row in 0..IN_TURN {
                    *sum = simd.mul_add_e_f64s(factors[n][row], now[row], *sum);
                }
            }
            for row in 0..IN_TURN {
                let next = simd.mul_add_e_f64s(twice[row], now[row], simd.neg_f64s(before[row]));
                (before[row], now[row]) = (now[row], next);
            }
        }
    }
}

/// A sum of light that has not yet reached the base: scalar weights on first passes, spectra later.
#[derive(Debug, Clone)]
pub(super) struct Incident {
    weight: f64,
    spectra: Vec<f64>,
}

impl Incident {
    pub(super) fn new(len: usize) -> Self {
        Self { weight: 0.0, spectra: vec![0.0; len] }
    }

    #[inline]
    pub(super) fn add(&mut self, carried: Option<&[f64]>, weight: f64) {
        match carried {
            None => self.weight += weight,
            Some(spectra) => add_scaled(&mut self.spectra, spectra, weight),
        }
    }

    /// Returns the total sum times `scale`; shape `[state][wavelength]`.
    pub(super) fn sum(&self, scale: f64) -> Vec<f64> {
        self.spectra.iter().map(|s| (s + self.weight) * scale).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AngularTable, Nodes};

    /// Batched look-ups equal single look-ups, whatever the remainder. A sum does not change if it is read
    /// before it is complete.
    #[test]
    fn batched_look_ups_equal_single_look_ups() {
        let panels = CosinePanels::new(&[2, 3, 3, 1]);
        let nodes = panels.count();
        let table = AngularTable {
            nodes: Nodes::CosinePanels(panels.clone()),
            basis: vec![0.5; nodes].into(),
            mixture: vec![1.0],
            common: vec![0.0],
        };
        let base = Base { reflector: Reflector::Specular(table), inactive_absorptance: vec![0.0].into() };
        let [mut one_by_one, mut counted, mut in_panels] = [0; 3].map(|_| Channel::new(&base));
        in_panels.prepare(&panels, true);
        for step in 0..1000 {
            let (cosine, weight) = (f64::from(step * 617 % 1000) / 999.0, f64::from(step % 7) - 2.5);
            let stencil = panels.stencil(cosine);
            one_by_one.look_up(&stencil, weight);
            counted.look_up(&stencil, 1.0);
            let number = panels.panel_of(CosinePanels::part(cosine, panels.part_count()));
            in_panels.look_up_in_panel(number, cosine, weight);
            if step % 100 < 3 {
                let expected = [&one_by_one, &counted].map(|channel| channel.node_weights()[0].clone());
                for (found, expected) in in_panels.node_weights().iter().zip(&expected) {
                    let pairs = found.iter().zip(expected);
                    let error = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    assert!(error < 1e-9, "after {step}: {error}");
                }
            }
        }
    }
}
