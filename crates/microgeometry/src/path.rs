//! The way of light through a surface: from facet to facet, until it leaves.
//!
//! At the first facet both ways are followed, with their weights; at all later ones the light is reflected or transmitted by chance. No order
//! is cut off.

use papilio_optics::interface::fresnel_reflectance;
use papilio_sampling::SampleStream;

use crate::ray::{Face, Met, Ray, Side, dot, moved, normalised};

/// Facets after which light counts as lost: far beyond any order that matters.
const MOST_FACETS: u32 = 100_000;

/// Light that leaves a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Leaves {
    pub(crate) side: Side,
    /// Direction of propagation.
    pub(crate) along: [f64; 3],
    /// Fraction of the light that entered.
    pub(crate) weight: f64,
    /// Whether all facets were horizontal: the light leaves in the direction of a flat face, exactly.
    pub(crate) regular: bool,
    /// Number of facets that it met.
    pub(crate) facets: u32,
}

/// Follows light that comes in at a place from a side.
///
/// Returns the fraction that was lost.
pub(crate) fn follow(
    face: &dyn Face,
    index: [f64; 2],
    ray: &Ray,
    side: Side,
    numbers: (&SampleStream, u64),
    leaves: &mut dyn FnMut(Leaves),
) -> f64 {
    let Met::Facet { at, normal } = face.next(ray, side) else { return 1.0 };
    let split = Facet::new(index, ray.along, side, normal);
    let is_flat = normal[2] == 1.0;
    let mut lost = 0.0;
    for (branch, (weight, along, side)) in
        [(split.reflectance, split.reflected, side), (1.0 - split.reflectance, split.refracted, side.other())]
            .into_iter()
            .enumerate()
    {
        if weight > 0.0 {
            let start = Walk { ray: Ray { at, along }, side, regular: is_flat };
            match walk(face, index, start, (numbers.0, branch as u64, numbers.1)) {
                Some((side, along, regular, facets)) => {
                    leaves(Leaves { side, along, weight, regular, facets })
                }
                None => lost += weight,
            }
        }
    }
    lost
}

struct Walk {
    ray: Ray,
    side: Side,
    regular: bool,
}

/// Follows light after its first facet; `None`: lost.
fn walk(
    face: &dyn Face,
    index: [f64; 2],
    Walk { mut ray, mut side, mut regular }: Walk,
    (numbers, branch, path): (&SampleStream, u64, u64),
) -> Option<(Side, [f64; 3], bool, u32)> {
    let mut uniform = [0.0; 4];
    // Most light meets one facet, and needs no numbers.
    let mut own = None;
    for facets in 0..MOST_FACETS {
        match face.next(&ray, side) {
            Met::Nothing => return Some((side, ray.along, regular, facets + 1)),
            Met::Unknown => return None,
            Met::Facet { at, normal } => {
                if facets % 4 == 0 {
                    let own = own.get_or_insert_with(|| numbers.part(branch));
                    uniform = own.block(path, 2 + facets / 4);
                }
                let facet = Facet::new(index, ray.along, side, normal);
                let along = if uniform[(facets % 4) as usize] < facet.reflectance {
                    facet.reflected
                } else {
                    side = side.other();
                    facet.refracted
                };
                regular &= normal[2] == 1.0;
                ray = Ray { at, along };
            }
        }
    }
    None
}

/// Light at a facet.
struct Facet {
    reflectance: f64,
    reflected: [f64; 3],
    /// Direction behind the facet; that of the reflected light where all is reflected.
    refracted: [f64; 3],
}

impl Facet {
    fn new(index: [f64; 2], along: [f64; 3], side: Side, normal: [f64; 3]) -> Self {
        let [from, to] = match side {
            Side::Above => index,
            Side::Below => [index[1], index[0]],
        };
        // Along the normal, towards the side of the light.
        let towards = if side == Side::Above { normal } else { normal.map(|part| -part) };
        // Rounding may put a grazing ray behind its facet.
        let cosine = (-dot(along, towards)).max(0.0);
        let reflected = normalised(moved(along, 2.0 * cosine, towards));
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let reflectance = fresnel_reflectance(from, to, from * sine);
        let ratio = from / to;
        let behind = 1.0 - (ratio * sine).powi(2);
        let refracted = match behind > 0.0 && reflectance < 1.0 {
            true => {
                normalised(moved(along.map(|part| ratio * part), ratio * cosine - behind.sqrt(), towards))
            }
            false => reflected,
        };
        let reflectance = if behind > 0.0 { reflectance } else { 1.0 };
        Self { reflectance, reflected, refracted }
    }
}
