//! The sums that the tracers keep.

use pulp::{Arch, Simd, WithSimd};

use super::add_scaled;
use crate::angular::Stencil;
use crate::{Base, CosinePanels, Reflector};

/// Light that has met the base, as a path carries it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Reflected<'a> {
    /// On a first pass: the look-up that gives the base's reflectance.
    LookUp(Stencil),
    /// Later: spectra that hold everything the path has met; shape `[state][wavelength]`.
    Spectra(&'a [f64]),
}

/// Look-ups that are added side by side, and how many registers' worth of them.
const SIDE_BY_SIDE: usize = 8;
const IN_TURN: usize = 4;

/// Sums of look-ups in a panel of a table, as [`CosinePanels::add_moments`] takes them: for each polynomial that of
/// each look-up's place among those side by side.
type Moments = [[f64; SIDE_BY_SIDE]; CosinePanels::NODES];

/// Look-ups in a panel of a table: they wait until there are enough of them to fill registers.
#[derive(Debug, Clone)]
struct InPanel {
    waiting: usize,
    /// Where in the panel, from -1 to 1, and the weight.
    places: [f64; SIDE_BY_SIDE * IN_TURN],
    weights: [f64; SIDE_BY_SIDE * IN_TURN],
    weighted: Moments,
    /// The same without weights.
    counted: Moments,
}

/// A sum of weighted [`Reflected`] light: weights on table nodes, and spectra.
#[derive(Debug, Clone)]
pub(super) struct Channel {
    nodes: Vec<f64>,
    /// Look-ups that are added by their moments, for each panel of the table.
    panels: Vec<InPanel>,
    spectra: Vec<f64>,
}

impl Channel {
    pub(super) fn new(base: &Base) -> Self {
        let nodes = match &base.reflector {
            Reflector::Specular(table) => table.nodes.count(),
            Reflector::Lambertian(_) | Reflector::Scattering(_) => 1,
        };
        // A look-up always touches `Stencil::LEN` consecutive slots.
        Self {
            nodes: vec![0.0; nodes + Stencil::LEN],
            panels: Vec::new(),
            spectra: vec![0.0; base.states() * base.bins()],
        }
    }

    #[inline]
    pub(super) fn add(&mut self, light: Reflected<'_>, weight: f64) {
        match light {
            Reflected::LookUp(stencil) => self.look_up(&stencil, weight),
            Reflected::Spectra(spectra) => add_scaled(&mut self.spectra, spectra, weight),
        }
    }

    /// Light on its first pass.
    #[inline(always)]
    pub(super) fn look_up(&mut self, stencil: &Stencil, weight: f64) {
        let slots = &mut self.nodes[stencil.first..][..Stencil::LEN];
        slots.iter_mut().zip(&stencil.weights).for_each(|(slot, w)| *slot += w * weight);
    }

    /// Light on its first pass, at these places of panels of so many.
    #[inline(always)]
    pub(super) fn look_up_in_panels(
        &mut self,
        places: impl Iterator<Item = ((usize, f64), f64)>,
        panels: usize,
    ) {
        if self.panels.is_empty() {
            self.panels.resize(panels, InPanel::EMPTY);
        }
        for ((panel, place), weight) in places {
            self.panels[panel].add(place, weight);
        }
    }

    /// The weights on the nodes of a table, and besides, what they were if all that was looked up in panels had
    /// weighed one.
    pub(super) fn node_weights(&self) -> [Vec<f64>; 2] {
        let mut weights = [self.nodes.clone(), vec![0.0; self.nodes.len()]];
        for (number, panel) in self.panels.iter().enumerate() {
            let Some(moments) = panel.moments() else { continue };
            for (weights, moments) in weights.iter_mut().zip(&moments) {
                let of_panel = &mut weights.as_chunks_mut().0[number];
                CosinePanels::add_moments(moments, of_panel);
            }
        }
        weights
    }

    /// The whole sums of several, each with its weights on nodes and times its scale; shape `[state][wavelength]`.
    pub(super) fn sums(channels: &[(&Self, Vec<f64>, f64)], base: &Base) -> Vec<Vec<f64>> {
        let mut sums: Vec<Vec<f64>> = match &base.reflector {
            Reflector::Specular(table) => {
                let count = table.nodes.count();
                let nodes: Vec<&[f64]> = channels.iter().map(|(_, nodes, _)| &nodes[..count]).collect();
                let len = (base.states() * base.bins()).max(1);
                table.weighted_sums(&nodes).chunks_exact(len).map(<[f64]>::to_vec).collect()
            }
            Reflector::Lambertian(reflectance) => {
                channels.iter().map(|(_, nodes, _)| scaled(reflectance, nodes[0])).collect()
            }
            // Any layers are over such a base, no panel.
            Reflector::Scattering(_) => {
                channels.iter().map(|(channel, ..)| scaled(&channel.spectra, 0.0)).collect()
            }
        };
        for (sum, (channel, _, scale)) in sums.iter_mut().zip(channels) {
            sum.iter_mut().zip(&channel.spectra).for_each(|(value, s)| *value = (*value + s) * scale);
        }
        sums
    }
}

impl InPanel {
    const EMPTY: Self = Self {
        waiting: 0,
        places: [0.0; SIDE_BY_SIDE * IN_TURN],
        weights: [0.0; SIDE_BY_SIDE * IN_TURN],
        weighted: [[0.0; SIDE_BY_SIDE]; CosinePanels::NODES],
        counted: [[0.0; SIDE_BY_SIDE]; CosinePanels::NODES],
    };

    #[inline(always)]
    fn add(&mut self, place: f64, weight: f64) {
        // So there is no doubt about the borders.
        let at = self.waiting % self.places.len();
        self.places[at] = place;
        self.weights[at] = weight;
        self.waiting = at + 1;
        if self.waiting == self.places.len() {
            self.add_waiting();
        }
    }

    #[inline(never)]
    fn add_waiting(&mut self) {
        Arch::new().dispatch(AddPolynomials(self, &ONES));
        self.waiting = 0;
    }

    /// With weights and without, those that wait among them; `None` if there is nothing.
    fn moments(&self) -> Option<[[f64; CosinePanels::NODES]; 2]> {
        // A polynomial of degree 0 is one.
        if self.waiting == 0 && self.counted[0] == [0.0; SIDE_BY_SIDE] {
            return None;
        }
        let (mut whole, mut counts) = (self.clone(), ONES);
        whole.weights[self.waiting..].fill(0.0);
        counts[self.waiting..].fill(0.0);
        Arch::new().dispatch(AddPolynomials(&mut whole, &counts));
        Some(
            [whole.weighted, whole.counted]
                .map(|moments| moments.map(|side_by_side| side_by_side.iter().sum())),
        )
    }
}

/// What each of those that wait counts.
const ONES: [f64; SIDE_BY_SIDE * IN_TURN] = [1.0; SIDE_BY_SIDE * IN_TURN];

/// Adds Chebyshev's polynomials of degrees 0, 1, ... at the places, times weights and times counts.
struct AddPolynomials<'a>(&'a mut InPanel, &'a [f64; SIDE_BY_SIDE * IN_TURN]);

impl WithSimd for AddPolynomials<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self(InPanel { places, weights, weighted, counted, .. }, counts) = self;
        let lanes = S::F64_LANES.min(SIDE_BY_SIDE);
        for first in (0..SIDE_BY_SIDE).step_by(lanes) {
            let at = |row: usize| first + row * SIDE_BY_SIDE..first + row * SIDE_BY_SIDE + lanes;
            let load = |of: &[f64], row: usize| S::as_simd_f64s(&of[at(row)]).0[0];
            let [mut twice, mut before, mut now, mut weight, mut count] =
                [[simd.splat_f64s(1.0); IN_TURN]; 5];
            for row in 0..IN_TURN {
                before[row] = load(places, row);
                twice[row] = simd.add_f64s(before[row], before[row]);
                weight[row] = load(weights, row);
                count[row] = load(counts, row);
            }
            for (weighted, counted) in weighted.iter_mut().zip(counted.iter_mut()) {
                let weighted = &mut S::as_mut_simd_f64s(&mut weighted[first..first + lanes]).0[0];
                let counted = &mut S::as_mut_simd_f64s(&mut counted[first..first + lanes]).0[0];
                for row in 0..IN_TURN {
                    *weighted = simd.mul_add_e_f64s(weight[row], now[row], *weighted);
                    *counted = simd.mul_add_e_f64s(count[row], now[row], *counted);
                    let next = simd.mul_add_e_f64s(twice[row], now[row], simd.neg_f64s(before[row]));
                    (before[row], now[row]) = (now[row], next);
                }
            }
        }
    }
}

fn scaled(values: &[f64], scale: f64) -> Vec<f64> {
    values.iter().map(|value| value * scale).collect()
}

/// A sum of light that has yet to meet the base: plain weights on first passes, spectra later.
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

    /// The whole sum times `scale`; shape `[state][wavelength]`.
    pub(super) fn sum(&self, scale: f64) -> Vec<f64> {
        self.spectra.iter().map(|s| (s + self.weight) * scale).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AngularTable, Nodes};

    /// Look-ups that wait for company are the look-ups that each is by itself, however many wait at the end; and a sum is the
    /// same whether or not someone looked at it on the way.
    #[test]
    fn look_ups_in_panels_are_look_ups() {
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
        for step in 0..1000 {
            let (cosine, weight) = (f64::from(step * 617 % 1000) / 999.0, f64::from(step % 7) - 2.5);
            let stencil = panels.stencil(cosine);
            one_by_one.look_up(&stencil, weight);
            counted.look_up(&stencil, 1.0);
            let look_up = (panels.place(cosine), weight);
            in_panels.look_up_in_panels(std::iter::once(look_up), panels.panel_count());
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
