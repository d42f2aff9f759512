//! The layers of the stack at one wavelength, as parts.

use std::borrow::Cow;
use std::sync::atomic::AtomicBool;

use papilio_optics::lobe::{BalancedLobe, Lobe};
use papilio_optics::rough::Rough;
use papilio_optics::scatter::Scatter;

use super::algebra::Operator;
use super::averages::averaged;
use super::azimuth::Sampling;
use super::grid::Grid;
use super::known::Known;
use super::part::{Absorbed, Part, nothing};
use super::precision::{Precision, rough_surface};
use super::rough::RoughOrders;
use super::scatter::ScatterOrders;
use super::scatterers::{Scattered, Scatterers};
use super::single::{Face, Single};
use super::slab::Model;
use crate::Stack;
use crate::estimate::Account;
use crate::front::Flat;
use crate::layers::{Action, Incidence, LayerKind, Preparation};

/// The scatterers of a layer at one wavelength, as it registers them.
struct Registry<'p, 'a> {
    /// Number of the wavelength.
    bin: usize,
    /// Indices of the media above and below.
    indices: [f64; 2],
    grid: &'p Grid,
    precision: &'p Precision,
    /// Azimuthal orders beyond the first are needed only where there are lights with an azimuth: the largest
    /// `|beta|` of views and of those.
    beyond_first: Option<[f64; 2]>,
    /// Whether no other layer scatters.
    alone: bool,
    /// Whether it is the rough surface of a display below which nothing scatters.
    surface: bool,
    /// Kernels of the preparation before.
    known: &'p Known,
    scatterers: &'p mut Scatterers<'a>,
    stop: &'p AtomicBool,
}

impl<'p> Registry<'p, '_> {
    /// Returns what kernels without a closed series are sampled for.
    fn sampling(&self) -> Sampling<'p> {
        Sampling { grid: self.grid, digits: self.precision.digits, stop: self.stop }
    }
}

impl<'a> Preparation<'a> for Registry<'_, 'a> {
    fn bin(&self) -> usize {
        self.bin
    }

    fn lobe(&mut self, lobe: Lobe) -> usize {
        self.scatterers.lobe(lobe, 1.0, self.indices, self.grid)
    }

    fn reflected_lobe(&mut self, lobe: Lobe, side: usize) -> usize {
        let index = self.indices[side];
        self.scatterers.lobe(lobe, index, [index; 2], self.grid)
    }

    fn balanced_lobe(&mut self, lobe: &'a BalancedLobe) -> usize {
        self.scatterers.balanced_lobe(lobe, self.grid)
    }

    fn index(&self, side: usize) -> f64 {
        self.indices[side]
    }

    fn rough(&mut self, face: &'a Rough) -> usize {
        let sampling = self.sampling();
        let Self { grid, beyond_first, alone, surface, known, .. } = self;
        let known = known.rough(face, &grid.beta[..grid.regular]);
        // Light scattered more than once is scattered both from the view's circle and from the light's; among
        // several scatterers it may be only one of them.
        let circles = |[a, b]: [f64; 2]| if *alone { a * b / (a + b).max(1e-9) } else { a.max(b) };
        let orders = || match surface {
            true => RoughOrders::of_surface(face, *beyond_first, sampling, known),
            false => RoughOrders::new(face, beyond_first.map(circles), sampling, known),
        };
        self.scatterers.rough(face, orders)
    }

    fn kernel(&mut self, scatter: &'a Scatter, disc: f64) -> usize {
        let (sampling, beyond_first) = (self.sampling(), self.beyond_first);
        let Self { grid, known, .. } = self;
        let known = known.scatter(scatter, disc, &grid.beta[..grid.regular]);
        let orders = || ScatterOrders::new((scatter, disc), beyond_first, sampling, known);
        self.scatterers.scatter(scatter, disc, orders)
    }

    fn slab(&mut self, thickness: f64, albedo: f64, anisotropy: f64) -> usize {
        let model = Model { thickness, albedo, anisotropy, index: self.indices[1] };
        self.scatterers.slab(model, self.precision.kept_terms(anisotropy), self.grid)
    }
}

/// One layer at one wavelength.
#[derive(Debug)]
pub(super) struct Element<'a> {
    kind: &'a dyn LayerKind,
    action: Action,
    bin: usize,
    /// Indices of the media above and below.
    above: f64,
    below: f64,
}

/// Returns the layers above the base at wavelength number `bin`. Scatterers are added to `scatterers`;
/// azimuthal orders beyond the first only if there are lights with an azimuth, given the largest `|beta|` of
/// views and of those. Incomplete if `stop` is set during the computation.
pub(super) fn elements<'a>(
    stack: &'a Stack,
    bin: usize,
    (grid, precision): (&Grid, &Precision),
    beyond_first: Option<[f64; 2]>,
    known: &Known,
    scatterers: &mut Scatterers<'a>,
    stop: &AtomicBool,
) -> Vec<Element<'a>> {
    let surface = rough_surface(stack).is_some();
    let actions = actions(stack, bin, (grid, precision), (beyond_first, surface), known, scatterers, stop);
    let element = |((kind, media), action): ((&'a dyn LayerKind, _), Option<Action>)| {
        let [above, below] = indices(media, bin);
        action.map(|action| Element { kind, action, bin, above, below })
    };
    stack.elements().zip(actions).filter_map(element).collect()
}

/// Returns the effect of each element of the stack in the same way; `surface`: a rough surface scatters light
/// once only.
pub(super) fn actions<'a>(
    stack: &'a Stack,
    bin: usize,
    (grid, precision): (&Grid, &Precision),
    (beyond_first, surface): (Option<[f64; 2]>, bool),
    known: &Known,
    scatterers: &mut Scatterers<'a>,
    stop: &AtomicBool,
) -> Vec<Option<Action>> {
    let alone = stack.elements().filter(|(kind, _)| kind.scatters()).count() == 1;
    let mut action = |(kind, media): (&'a dyn LayerKind, _)| {
        let indices = indices(media, bin);
        let scatterers = &mut *scatterers;
        kind.action(&mut Registry {
            bin,
            indices,
            grid,
            precision,
            beyond_first,
            alone,
            surface,
            known,
            scatterers,
            stop,
        })
    };
    stack.elements().map(&mut action).collect()
}

/// Returns the indices of the media above and below an element.
pub(super) fn indices(media: [Option<&crate::Medium>; 2], bin: usize) -> [f64; 2] {
    media.map(|medium| medium.map_or(1.0, |medium| medium.index()[bin]))
}

/// Returns whether light can meet the scatterers of the stack more than once at wavelength number `bin`:
/// there are several of them, one scatters in its volume, or flat layers reflect.
pub(super) fn scatters_again(stack: &Stack, bin: usize, grid: &Grid) -> bool {
    let mut faces = 0;
    let mut again = |(kind, media): (&dyn LayerKind, [Option<&crate::Medium>; 2])| {
        if kind.scatters() {
            faces += 1;
            return faces > 1 || kind.scattering_interface().is_none();
        }
        let [above, below] = indices(media, bin);
        let layer = Element { kind, action: Action::Regular, bin, above, below };
        grid.beta.iter().map(|beta| layer.regular(*beta)).any(|flat| flat.above != 0.0 || flat.below != 0.0)
    };
    stack.elements().any(&mut again)
}

/// The layers at one wavelength: those above the last scatterer, the last scatterer, and the flat ones below
/// it. Without a scatterer all of them are below.
#[derive(Debug)]
pub(super) struct Elements<'a> {
    upper: Vec<Element<'a>>,
    last: Option<Element<'a>>,
    lower: Vec<Element<'a>>,
    /// Whether the base below them keeps the direction of light.
    specular: bool,
}

impl<'a> Elements<'a> {
    pub(super) fn new(mut all: Vec<Element<'a>>, specular: bool) -> Self {
        let upper = all.iter().rposition(|element| !element.is_flat()).unwrap_or(0);
        let mut rest = all.split_off(upper);
        let lower = rest.split_off(rest.iter().take(1).filter(|element| !element.is_flat()).count());
        Self { upper: all, last: rest.pop(), lower, specular }
    }

    /// Returns the index of the medium below the last scatterer: that of air if there is none.
    pub(super) fn index(&self) -> f64 {
        self.last.as_ref().map_or(1.0, |last| last.below)
    }

    /// Returns whether nothing scatters above the last scatterer.
    pub(super) fn flat_above(&self) -> bool {
        self.upper.iter().all(Element::is_flat)
    }

    /// Returns the layers above the last scatterer, as one part of this order.
    pub(super) fn upper(&self, scattered: &[Scattered], order: usize, grid: &Grid) -> Part {
        let air = |beta: f64| Flat { t: if beta < 1.0 { 1.0 } else { 0.0 }, above: 0.0, below: 0.0 };
        compose(Part::flat(grid, air), (&self.upper, true), scattered, order, grid)
    }

    /// Returns the last scatterer in this order.
    pub(super) fn last(&self, scattered: &[Scattered], order: usize, grid: &Grid) -> Part {
        let nothing = || {
            compose(
                Part::flat(grid, |_| Flat { t: 1.0, above: 0.0, below: 0.0 }),
                (&[], true),
                &[],
                order,
                grid,
            )
        };
        self.last.as_ref().map_or_else(nothing, |last| last.in_order(scattered, order, grid, true))
    }

    /// Returns the layers down to the last scatterer below the flat part `upper`, if their round trips keep
    /// the direction of light; `regular` is the regular part of the last scatterer.
    pub(super) fn single<'u>(
        &self,
        upper: &'u Part,
        scattered: &[Scattered],
        regular: &[Flat],
    ) -> Option<Single<'u>> {
        let last = self.last.as_ref().filter(|_| self.flat_above())?;
        Single::new(upper, last.faces(scattered, regular)?)
    }

    /// Returns the regular part of the last scatterer, which is the same in all orders.
    pub(super) fn regular_of_last(&self, grid: &Grid) -> Vec<Flat> {
        let of = |last: &Element<'_>| grid.beta.iter().map(|beta| last.regular(*beta)).collect();
        self.last.as_ref().map(of).unwrap_or_default()
    }

    /// Returns the fractions that the last scatterer absorbs, given the light that it loses.
    pub(super) fn absorbed_by_last(&self, lost: [Vec<f64>; 2]) -> [Absorbed; 2] {
        let nodes = lost[0].len();
        self.last.as_ref().map_or_else(|| [nothing(nodes), nothing(nodes)], |last| last.absorbed(lost))
    }

    /// Returns the indices of the media above and below the last scatterer.
    pub(super) fn indices(&self) -> [f64; 2] {
        self.last.as_ref().map_or([1.0; 2], |last| [last.above, last.below])
    }

    /// Returns the flat layers below it, with their absorption.
    pub(super) fn lower(&self, grid: &Grid) -> Part {
        let carried = |beta: f64| if beta < self.index() { 1.0 } else { 0.0 };
        let medium = Part::flat(grid, |beta| Flat { t: carried(beta), above: 0.0, below: 0.0 });
        compose(medium, (&self.lower, !self.specular), &[], 0, grid)
    }
}

/// Returns the regular part of an element between media of these indices, for light with this `|beta|`. On a
/// side that does not carry such light there is nothing to reflect.
pub(super) fn regular(kind: &dyn LayerKind, bin: usize, indices: [f64; 2], beta: f64) -> Flat {
    let Flat { t, above, below } = kind.regular(&Incidence { bin, indices, beta, beta_squared: beta * beta });
    let carried = |index: f64, share: f64| if beta < index { share } else { 0.0 };
    Flat {
        t: carried(indices[0].min(indices[1]), t),
        above: carried(indices[0], above),
        below: carried(indices[1], below),
    }
}

/// Composes successive layers into one part of this order, with the operators of the scatterers in it; flat ones
/// by their averages, or at each node.
fn compose(
    first: Part,
    (elements, averages): (&[Element<'_>], bool),
    scattered: &[Scattered],
    order: usize,
    grid: &Grid,
) -> Part {
    let mut whole = first;
    if order == 0 {
        whole.absorbed = Some([nothing(grid.len()), nothing(grid.len())]);
    }
    for element in elements {
        whole = whole.over(&element.in_order(scattered, order, grid, averages), grid);
    }
    whole
}

impl Element<'_> {
    fn is_flat(&self) -> bool {
        matches!(self.action, Action::Regular | Action::Clear { .. })
    }

    fn in_order(&self, scattered: &[Scattered], order: usize, grid: &Grid, averages: bool) -> Part {
        let part = self.part(scattered, grid, averages);
        if order == 0 { self.with_absorption(part, grid) } else { part }
    }

    fn part(&self, scattered: &[Scattered], grid: &Grid, averages: bool) -> Part {
        let index = self.above;
        match &self.action {
            Action::Regular => {
                let flat = |beta: f64| self.regular(beta);
                // Round trips between flat layers and a mirror are those of single directions.
                let pieces = if averages { self.kind.pieces(self.bin) } else { Vec::new() };
                Part::of_flats(grid, &averaged(grid, &pieces, flat))
            }
            Action::Clear { transmittance } => Part::flat(grid, |beta| {
                let cosine = (1.0 - (beta / index).powi(2)).max(0.0).sqrt();
                let t = if beta < index { transmittance.powf(1.0 / cosine) } else { 0.0 };
                Flat { t, above: 0.0, below: 0.0 }
            }),
            Action::Whole { number } | Action::Slab { number, .. } => match &scattered[*number] {
                Scattered::Whole(part) => part.clone(),
                Scattered::Kernel(_) => Part::dark(grid),
            },
            Action::Kernels(kernels) => {
                let [mut down, mut above, mut below] =
                    kernels.each_ref().map(|kernels| scatters(kernels, scattered, grid));
                for (i, beta) in grid.beta.iter().enumerate() {
                    let regular = self.regular(*beta);
                    down.straight[i] += regular.t;
                    above.straight[i] += regular.above;
                    below.straight[i] += regular.below;
                }
                Part { above, below, down, absorbed: None }
            }
        }
    }

    /// Returns the regular part for light with this `|beta|`.
    fn regular(&self, beta: f64) -> Flat {
        regular(self.kind, self.bin, [self.above, self.below], beta)
    }

    /// Returns transmission from above, reflection from above and reflection from below; `None` of a flat
    /// layer.
    fn faces(&self, scattered: &[Scattered], regular: &[Flat]) -> Option<[Face; 3]> {
        match &self.action {
            Action::Regular | Action::Clear { .. } => None,
            Action::Whole { number } | Action::Slab { number, .. } => match &scattered[*number] {
                Scattered::Whole(part) => {
                    Some([&part.down, &part.above, &part.below].map(|operator| Face::of(operator, 1.0)))
                }
                Scattered::Kernel(_) => None,
            },
            Action::Kernels(kernels) => {
                let mut faces = kernels.each_ref().map(|kernels| match sum_of(kernels, scattered) {
                    Some((operator, factor)) => Face::of(&operator, factor),
                    None => Face { straight: vec![0.0; regular.len()], kernel: None },
                });
                for (i, regular) in regular.iter().enumerate() {
                    for (face, more) in faces.iter_mut().zip([regular.t, regular.above, regular.below]) {
                        face.straight[i] += more;
                    }
                }
                Some(faces)
            }
        }
    }

    /// Adds the absorption of the part to its account.
    fn with_absorption(&self, part: Part, grid: &Grid) -> Part {
        let lost = part.lost(grid, [self.above, self.below]);
        Part { absorbed: Some(self.absorbed(lost)), ..part }
    }

    /// Returns the absorbed fractions by account, given the light that is neither reflected nor transmitted.
    fn absorbed(&self, lost: [Vec<f64>; 2]) -> [Absorbed; 2] {
        let absorbing_share = match self.action {
            Action::Slab { absorbing_share, .. } => Some(absorbing_share),
            _ => None,
        };
        let book = |lost: Vec<f64>| {
            let mut book = nothing(lost.len());
            match absorbing_share {
                Some(share) => {
                    book[Account::Glass as usize] = lost.iter().map(|a| a * share).collect();
                    book[Account::Diffuser as usize] = lost.iter().map(|a| a * (1.0 - share)).collect();
                }
                None => book[self.kind.account() as usize] = lost,
            }
            book
        };
        lost.map(book)
    }
}

/// Returns the sum of kernels times their factors, as an operator and a factor: that of a single kernel is
/// shared; `None` if there is none.
pub(super) fn sum_of<'s>(
    kernels: &[(usize, f64)],
    scattered: &'s [Scattered],
) -> Option<(Cow<'s, Operator>, f64)> {
    let operator = |number: usize| match &scattered[number] {
        Scattered::Kernel(operator) => Some(operator),
        Scattered::Whole(_) => None,
    };
    let mut all = kernels.iter().filter_map(|(number, factor)| Some((operator(*number)?, *factor)));
    let (first, factor) = all.next()?;
    let Some((second, other)) = all.next() else { return Some((Cow::Borrowed(first), factor)) };
    let mut sum = first.combine(factor, second, other);
    all.for_each(|(operator, factor)| sum.add(operator, factor));
    Some((Cow::Owned(sum), 1.0))
}

/// Returns the sum of kernels times their factors; 0 if there is none.
fn scatters(kernels: &[(usize, f64)], scattered: &[Scattered], grid: &Grid) -> Operator {
    match sum_of(kernels, scattered) {
        Some((operator, factor)) => operator.into_owned().scaled(factor),
        None => Operator::diagonal(grid.regular, vec![0.0; grid.len()]),
    }
}
