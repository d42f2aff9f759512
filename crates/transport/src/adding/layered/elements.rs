//! The stack's layers as parts, one azimuthal order after the other.

use papilio_optics::interface::fresnel_reflectance;
use papilio_optics::rough::Rough;
use papilio_spectra::Spectrum;

use super::algebra::Operator;
use super::grid::Grid;
use super::lobes::LobeOrders;
use super::part::{Part, Place};
use super::rough::RoughOrders;
use super::prepare::Precision;
use super::slab::{Model, Slab};
use crate::front::Flat;
use crate::{Diffuser, Interface, Layered, Medium};

/// One layer at one wavelength, as it is asked for order after order.
#[derive(Debug)]
pub(super) struct Element<'a> {
    kind: Kind<'a>,
    /// Indices of the media above and below.
    above: f64,
    below: f64,
}

#[derive(Debug)]
enum Kind<'a> {
    Interface(&'a Interface, usize),
    Diffuser { diffuser: &'a Diffuser, bin: usize, orders: LobeOrders, missing: Vec<f64> },
    Clear(f64),
    Slab { slab: Slab, absorbing_share: f64 },
    Rough { face: &'a Rough, orders: Option<RoughOrders> },
}

/// The layers above the base at wavelength number `bin`; azimuthal orders beyond the first are
/// not always asked for.
pub(super) fn elements<'a>(
    stack: &'a Layered,
    bin: usize,
    grid: &Grid,
    precision: &Precision,
    beyond_first: bool,
) -> Vec<Element<'a>> {
    let mut elements = Vec::new();
    let mut above = 1.0;
    for layer in &stack.layers {
        let below = layer.medium.index()[bin];
        let kind = match &layer.interface {
            Interface::Diffuser(diffuser) => Some(diffuser_kind(diffuser, bin, grid, above, below)),
            Interface::Rough(face) => {
                let orders = RoughOrders::new(face, grid, precision.digits, beyond_first);
                Some(Kind::Rough { face, orders: Some(orders) })
            }
            Interface::Open => None,
            other => Some(Kind::Interface(other, bin)),
        };
        elements.extend(kind.map(|kind| Element { kind, above, below }));
        let kind = medium_kind(&layer.medium, bin, grid, precision);
        elements.extend(kind.map(|kind| Element { kind, above: below, below }));
        above = below;
    }
    elements
}

fn medium_kind(medium: &Medium, bin: usize, grid: &Grid, precision: &Precision) -> Option<Kind<'static>> {
    let transmittance = medium.transmittance().map_or(1.0, |t| t[bin]);
    let Some(scattering) = medium.scattering() else {
        return (transmittance < 1.0).then_some(Kind::Clear(transmittance));
    };
    let absorbing = -transmittance.max(f64::MIN_POSITIVE).ln();
    let thickness = scattering.optical_thickness + absorbing;
    let scattered = scattering.optical_thickness * scattering.albedo[bin];
    let lost = thickness - scattered;
    let model = Model {
        thickness,
        albedo: scattered / thickness,
        anisotropy: scattering.anisotropy,
        index: medium.index()[bin],
    };
    let slab = Slab::new(model, precision.legendre_terms(scattering.anisotropy), grid);
    Some(Kind::Slab { slab, absorbing_share: if lost > 0.0 { absorbing / lost } else { 0.0 } })
}

fn diffuser_kind<'a>(diffuser: &'a Diffuser, bin: usize, grid: &Grid, above: f64, below: f64) -> Kind<'a> {
    let mut orders = LobeOrders::new(diffuser.lobe);
    let missing = orders.order(0, grid).map(|kernel| {
        // What the quadrature misses of the lobe's share within either disc: the mean, since
        // light goes both ways alike.
        let found = |j: usize, index: f64| -> f64 {
            let column = (0..grid.regular).filter(|&i| grid.beta[i] < index);
            column.map(|i| grid.scale[i] * kernel[(i, j)]).sum::<f64>() / grid.scale[j]
        };
        let misses = |j: usize, index| diffuser.lobe.share_in_disc(grid.beta[j], index) - found(j, index);
        (0..grid.len()).map(|j| 0.5 * (misses(j, above) + misses(j, below))).collect()
    });
    Kind::Diffuser { diffuser, bin, orders, missing: missing.unwrap_or_default() }
}

impl Element<'_> {
    /// Orders of azimuth beyond which nothing is scattered among nodes with weight.
    pub(super) fn orders(&self) -> usize {
        match &self.kind {
            Kind::Interface(..) | Kind::Clear(_) => 0,
            Kind::Diffuser { diffuser, .. } => match diffuser.lobe {
                papilio_optics::lobe::Lobe::Lambertian => 1,
                papilio_optics::lobe::Lobe::KCorrelation { .. } => usize::MAX,
            },
            Kind::Slab { slab, .. } => slab.orders(),
            Kind::Rough { orders, .. } => orders.as_ref().map_or(0, RoughOrders::orders),
        }
    }

    /// The same layer for the extra nodes alone.
    pub(super) fn extras(self, grid: &Grid) -> Self {
        let kind = match self.kind {
            Kind::Slab { slab, absorbing_share } => Kind::Slab { slab: slab.extras(grid), absorbing_share },
            Kind::Diffuser { diffuser, bin, missing, .. } => {
                let missing = missing.get(grid.regular..).unwrap_or_default().to_vec();
                Kind::Diffuser { diffuser, bin, orders: LobeOrders::new(diffuser.lobe), missing }
            }
            Kind::Rough { face, .. } => Kind::Rough { face, orders: None },
            flat => flat,
        };
        Self { kind, ..self }
    }

    /// The part that it is in this order; absorption is booked in order 0.
    pub(super) fn part(&mut self, order: usize, grid: &Grid) -> Part {
        let (above, below) = (self.above, self.below);
        let (part, place) = match &mut self.kind {
            Kind::Interface(interface, bin) => {
                let place = if matches!(interface, Interface::Sheet { .. }) { Place::Front } else { Place::Glass };
                (Part::flat(grid, |beta| face(interface, *bin, above, below, beta)), place)
            }
            Kind::Clear(t) => {
                let through = |beta: f64| {
                    let cosine = (1.0 - (beta / above).powi(2)).max(0.0).sqrt();
                    Flat { t: if beta < above { t.powf(1.0 / cosine) } else { 0.0 }, above: 0.0, below: 0.0 }
                };
                (Part::flat(grid, through), Place::Glass)
            }
            Kind::Diffuser { diffuser, bin, orders, missing } => {
                let t = diffuser.transmittance[*bin];
                let part = lobe_part(diffuser.straight_through, t, orders, missing, order, grid, [above, below]);
                (part, Place::Diffuser)
            }
            Kind::Rough { face, orders } => {
                let part = match orders {
                    Some(orders) => orders.part(face, order, grid),
                    None => Part::flat(grid, |_| Flat { t: 0.0, above: 0.0, below: 0.0 }),
                };
                (part, Place::Diffuser)
            }
            Kind::Slab { slab, .. } => {
                let [reflected, down] = slab.operators(order).map(|operator| slab.spread(&operator, grid));
                (Part { above: reflected.clone(), below: reflected, down, absorbed: None }, Place::Diffuser)
            }
        };
        if order > 0 {
            return part;
        }
        let mut part = part.booked(grid, place, above, below);
        if let (Kind::Slab { absorbing_share, .. }, Some(books)) = (&self.kind, &mut part.absorbed) {
            for book in books {
                book[Place::Glass as usize] =
                    book[Place::Diffuser as usize].iter().map(|a| a * absorbing_share).collect();
                book[Place::Diffuser as usize].iter_mut().for_each(|a| *a *= 1.0 - absorbing_share);
            }
        }
        part
    }
}

fn lobe_part(
    straight_through: f64,
    transmittance: f64,
    orders: &mut LobeOrders,
    missing: &[f64],
    order: usize,
    grid: &Grid,
    [above, below]: [f64; 2],
) -> Part {
    let scattered = transmittance * (1.0 - straight_through);
    let straight = (0..grid.len())
        .map(|i| {
            let carried = grid.beta[i] < above.min(below);
            let missing = missing.get(i).copied().unwrap_or(0.0);
            if carried { transmittance * straight_through + scattered * missing } else { 0.0 }
        })
        .collect();
    let kernel = orders.order(order, grid).filter(|_| scattered > 0.0).map(|kernel| {
        faer::Mat::from_fn(grid.len(), grid.len(), |out, from| {
            let carried = grid.beta[from] < above && grid.beta[out] < below;
            if carried { scattered * kernel[(out, from)] } else { 0.0 }
        })
    });
    let dark = || Operator::diagonal(grid.regular, vec![0.0; grid.len()]);
    let down = Operator { regular: grid.regular, straight, kernel };
    Part { above: dark(), below: dark(), down, absorbed: None }
}

/// A flat interface for light with this `|beta|`. On a side that does not carry such light
/// there is nothing to reflect.
fn face(interface: &Interface, bin: usize, above: f64, below: f64, beta: f64) -> Flat {
    let carried = [beta < above, beta < below];
    let both = |r: f64, t: f64| {
        let [above, below] = carried.map(|carried| if carried { r } else { 0.0 });
        Flat { t, above, below }
    };
    let passes = carried == [true, true];
    match interface {
        Interface::Coated => both(if passes { 0.0 } else { 1.0 }, if passes { 1.0 } else { 0.0 }),
        Interface::Fresnel => {
            let r = if passes { fresnel_reflectance(above, below, beta) } else { 1.0 };
            both(r, if passes { 1.0 - r } else { 0.0 })
        }
        Interface::Sheet { reflectance, absorptance } => {
            let [r, a] = [reflectance, absorptance].map(|spectrum: &Spectrum| spectrum[bin]);
            both(r, if passes { 1.0 - r - a } else { 0.0 })
        }
        Interface::Coating(coating) => {
            let part = coating.part(beta * beta, bin);
            let [above, below] = [part.above, part.below];
            Flat {
                t: if passes { part.transmittance } else { 0.0 },
                above: if carried[0] { above } else { 0.0 },
                below: if carried[1] { below } else { 0.0 },
            }
        }
        Interface::Open | Interface::Diffuser(_) | Interface::Rough(_) => {
            Flat { t: if passes { 1.0 } else { 0.0 }, above: 0.0, below: 0.0 }
        }
    }
}
