//! The stack's layers at one wavelength, as parts.

use std::sync::atomic::AtomicBool;

use papilio_optics::interface::fresnel_reflectance;

use super::algebra::Operator;
use super::grid::Grid;
use super::part::{Part, Place, nothing};
use super::precision::Precision;
use super::rough::RoughOrders;
use super::scatter::ScatterOrders;
use super::scatterers::{Scattered, Scatterers};
use super::slab::Model;
use crate::front::Flat;
use crate::skeleton::Going;
use crate::{Interface, Layered, Medium, ScatterKernel};

/// One layer at one wavelength.
#[derive(Debug)]
pub(super) struct Element<'a> {
    kind: Kind<'a>,
    /// Indices of the media above and below.
    above: f64,
    below: f64,
}

/// Scatterers by their number.
#[derive(Debug)]
enum Kind<'a> {
    Face {
        interface: &'a Interface,
        bin: usize,
    },
    Clear {
        transmittance: f64,
    },
    Slab {
        number: usize,
        absorbing_share: f64,
    },
    Diffuser {
        number: usize,
        transmittance: f64,
        straight_through: f64,
    },
    Rough {
        number: usize,
    },
    /// Numbers and factors of what goes through and of what is sent back, above and below.
    Scatter {
        straight: f64,
        ways: [Option<(usize, f64)>; 3],
        place: Place,
    },
}

/// The layers above the base at wavelength number `bin`. What scatters is added to `scatterers`,
/// for azimuthal orders beyond the first only where there are lights with an azimuth, given the largest `|beta|` of views
/// and of those. Not finished if `stop` is set before.
pub(super) fn elements<'a>(
    stack: &'a Layered,
    bin: usize,
    grid: &Grid,
    precision: &Precision,
    beyond_first: Option<[f64; 2]>,
    scatterers: &mut Scatterers<'a>,
    stop: &AtomicBool,
) -> Vec<Element<'a>> {
    let mut elements = Vec::new();
    let mut above = 1.0;
    for layer in &stack.layers {
        let below = layer.medium.index()[bin];
        let face = match &layer.interface {
            Interface::Open => None,
            Interface::Diffuser(diffuser) => Some(Kind::Diffuser {
                number: scatterers.lobe(diffuser.lobe, [above, below], grid),
                transmittance: diffuser.transmittance[bin],
                straight_through: diffuser.straight_through,
            }),
            Interface::Rough(face) => {
                let orders = || RoughOrders::new(face, grid, precision.digits, beyond_first.is_some(), stop);
                Some(Kind::Rough { number: scatterers.rough(face, orders) })
            }
            Interface::Scatter(face) => {
                let disc = face.disc(bin).unwrap_or(1.0);
                let place = if face.disc(bin).is_some() { Place::Pixel } else { Place::Diffuser };
                let mut way = |kernel: Option<&'a ScatterKernel>| {
                    kernel.map(|ScatterKernel { scatter, factor }| {
                        let orders =
                            || ScatterOrders::new(scatter, disc, grid, precision.digits, beyond_first, stop);
                        (scatterers.scatter(scatter, disc, orders), factor[bin])
                    })
                };
                let [back, back_below] = [Going::Down, Going::Up].map(|going| face.back(going));
                let ways = [way(face.through(Going::Down)), way(back), way(back_below)];
                Some(Kind::Scatter { straight: face.straight()[bin], ways, place })
            }
            interface => Some(Kind::Face { interface, bin }),
        };
        elements.extend(face.map(|kind| Element { kind, above, below }));
        let medium = medium(&layer.medium, bin, grid, precision, scatterers);
        elements.extend(medium.map(|kind| Element { kind, above: below, below }));
        above = below;
    }
    elements
}

fn medium<'a>(
    medium: &Medium,
    bin: usize,
    grid: &Grid,
    precision: &Precision,
    scatterers: &mut Scatterers<'a>,
) -> Option<Kind<'a>> {
    let transmittance = medium.transmittance().map_or(1.0, |t| t[bin]);
    let Some(scattering) = medium.scattering() else {
        return (transmittance < 1.0).then_some(Kind::Clear { transmittance });
    };
    // Absorption beside the scattering is more extinction that does not scatter.
    let absorbing = -transmittance.max(f64::MIN_POSITIVE).ln();
    let thickness = scattering.optical_thickness + absorbing;
    let scattered = scattering.optical_thickness * scattering.albedo[bin];
    let albedo = scattered / thickness;
    let model = Model { thickness, albedo, anisotropy: scattering.anisotropy, index: medium.index()[bin] };
    let number = scatterers.slab(model, precision.kept_terms(scattering.anisotropy), grid);
    let lost = thickness - scattered;
    Some(Kind::Slab { number, absorbing_share: if lost > 0.0 { absorbing / lost } else { 0.0 } })
}

/// The layers at one wavelength: those above the last scatterer, that, and those below it,
/// which are flat. Without a scatterer all of them are below.
#[derive(Debug)]
pub(super) struct Elements<'a> {
    upper: Vec<Element<'a>>,
    last: Option<Element<'a>>,
    lower: Vec<Element<'a>>,
}

impl<'a> Elements<'a> {
    pub(super) fn new(mut all: Vec<Element<'a>>) -> Self {
        let upper = all.iter().rposition(|element| !element.is_flat()).unwrap_or(0);
        let mut rest = all.split_off(upper);
        let lower = rest.split_off(rest.iter().take(1).filter(|element| !element.is_flat()).count());
        Self { upper: all, last: rest.pop(), lower }
    }

    /// Index of the medium below the last scatterer: air, without one.
    pub(super) fn index(&self) -> f64 {
        self.last.as_ref().map_or(1.0, |last| last.below)
    }

    /// True if nothing scatters above the last scatterer.
    pub(super) fn flat_above(&self) -> bool {
        self.upper.iter().all(Element::is_flat)
    }

    /// The layers above the last scatterer, as one part of this order.
    pub(super) fn upper(&self, scattered: &[Scattered], order: usize, grid: &Grid) -> Part {
        let air = |beta: f64| Flat { t: if beta < 1.0 { 1.0 } else { 0.0 }, above: 0.0, below: 0.0 };
        compose(Part::flat(grid, air), &self.upper, scattered, order, grid)
    }

    /// The last scatterer in this order.
    pub(super) fn last(&self, scattered: &[Scattered], order: usize, grid: &Grid) -> Part {
        let nothing =
            || compose(Part::flat(grid, |_| Flat { t: 1.0, above: 0.0, below: 0.0 }), &[], &[], order, grid);
        self.last.as_ref().map_or_else(nothing, |last| last.in_order(scattered, order, grid))
    }

    /// The flat layers below it, with their absorption.
    pub(super) fn lower(&self, grid: &Grid) -> Part {
        let carried = |beta: f64| if beta < self.index() { 1.0 } else { 0.0 };
        let medium = Part::flat(grid, |beta| Flat { t: carried(beta), above: 0.0, below: 0.0 });
        compose(medium, &self.lower, &[], 0, grid)
    }
}

/// Layers below one another as one part of this order, with what the scatterers do in it.
fn compose(
    first: Part,
    elements: &[Element<'_>],
    scattered: &[Scattered],
    order: usize,
    grid: &Grid,
) -> Part {
    let mut whole = first;
    if order == 0 {
        whole.absorbed = Some([nothing(grid.len()), nothing(grid.len())]);
    }
    for element in elements {
        whole = whole.over(&element.in_order(scattered, order, grid), grid);
    }
    whole
}

impl Element<'_> {
    fn is_flat(&self) -> bool {
        matches!(self.kind, Kind::Face { .. } | Kind::Clear { .. })
    }

    fn in_order(&self, scattered: &[Scattered], order: usize, grid: &Grid) -> Part {
        let part = self.part(scattered, grid);
        if order == 0 { self.booked(part, grid) } else { part }
    }

    fn part(&self, scattered: &[Scattered], grid: &Grid) -> Part {
        let index = self.above;
        match &self.kind {
            Kind::Face { interface, bin } => {
                Part::flat(grid, |beta| face(interface, *bin, [self.above, self.below], beta))
            }
            Kind::Clear { transmittance } => Part::flat(grid, |beta| {
                let cosine = (1.0 - (beta / index).powi(2)).max(0.0).sqrt();
                let t = if beta < index { transmittance.powf(1.0 / cosine) } else { 0.0 };
                Flat { t, above: 0.0, below: 0.0 }
            }),
            Kind::Diffuser { number, .. } | Kind::Slab { number, .. } | Kind::Rough { number } => {
                match &scattered[*number] {
                    Scattered::Slab([reflected, transmitted]) => Part {
                        above: reflected.clone(),
                        below: reflected.clone(),
                        down: transmitted.clone(),
                        absorbed: None,
                    },
                    Scattered::Diffuser(lobe) => Part { down: self.dimmed(lobe, grid), ..Part::dark(grid) },
                    Scattered::Rough(part) => part.clone(),
                    Scattered::Scatter(_) => Part::dark(grid),
                }
            }
            Kind::Scatter { straight, ways, .. } => {
                let [mut down, above, below] = ways.map(|way| scatters(way, scattered, grid));
                for (sum, beta) in down.straight.iter_mut().zip(&grid.beta) {
                    *sum += if *beta < 1.0 { *straight } else { 0.0 };
                }
                Part { above, below, down, absorbed: None }
            }
        }
    }

    /// A lobe with the diffuser's transmittance and its straight-through light.
    fn dimmed(&self, lobe: &Operator, grid: &Grid) -> Operator {
        let Kind::Diffuser { transmittance, straight_through, .. } = &self.kind else {
            return lobe.clone();
        };
        let mut down = lobe.clone().scaled(transmittance * (1.0 - straight_through));
        for (straight, beta) in down.straight.iter_mut().zip(&grid.beta) {
            if *beta < self.above.min(self.below) {
                *straight += transmittance * straight_through;
            }
        }
        down
    }

    /// Books what the part absorbs.
    fn booked(&self, part: Part, grid: &Grid) -> Part {
        let place = match &self.kind {
            Kind::Face { interface: Interface::Sheet { .. }, .. } => Place::Front,
            Kind::Face { .. } | Kind::Clear { .. } => Place::Glass,
            Kind::Scatter { place, .. } => *place,
            Kind::Slab { .. } | Kind::Diffuser { .. } | Kind::Rough { .. } => Place::Diffuser,
        };
        let mut part = part.booked(grid, place, [self.above, self.below]);
        if let (Kind::Slab { absorbing_share, .. }, Some(books)) = (&self.kind, &mut part.absorbed) {
            for book in books {
                let all = std::mem::take(&mut book[Place::Diffuser as usize]);
                book[Place::Glass as usize] = all.iter().map(|a| a * absorbing_share).collect();
                book[Place::Diffuser as usize] = all.iter().map(|a| a * (1.0 - absorbing_share)).collect();
            }
        }
        part
    }
}

/// A kernel with its factor; nothing, if there is none.
fn scatters(way: Option<(usize, f64)>, scattered: &[Scattered], grid: &Grid) -> Operator {
    match way.map(|(number, factor)| (&scattered[number], factor)) {
        Some((Scattered::Scatter(operator), factor)) => operator.clone().scaled(factor),
        _ => Operator::diagonal(grid.regular, vec![0.0; grid.len()]),
    }
}

/// A flat interface for light with this `|beta|`, between media of these indices. On a side that
/// does not carry such light there is nothing to reflect.
fn face(interface: &Interface, bin: usize, [above, below]: [f64; 2], beta: f64) -> Flat {
    let carried = |index: f64, r: f64| if beta < index { r } else { 0.0 };
    let passes = beta < above.min(below);
    let both = |r: f64, t: f64| Flat {
        t: if passes { t } else { 0.0 },
        above: carried(above, r),
        below: carried(below, r),
    };
    match interface {
        Interface::Coated => both(if passes { 0.0 } else { 1.0 }, 1.0),
        Interface::Fresnel => {
            let r = if passes { fresnel_reflectance(above, below, beta) } else { 1.0 };
            both(r, 1.0 - r)
        }
        Interface::Sheet { reflectance, absorptance } => {
            both(reflectance[bin], 1.0 - reflectance[bin] - absorptance[bin])
        }
        Interface::Coating(coating) => {
            let part = coating.part(beta * beta, bin);
            Flat {
                t: if passes { part.transmittance } else { 0.0 },
                above: carried(above, part.above),
                below: carried(below, part.below),
            }
        }
        Interface::Open | Interface::Diffuser(_) | Interface::Rough(_) | Interface::Scatter(_) => {
            both(0.0, 1.0)
        }
    }
}
