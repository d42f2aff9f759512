//! The way of light through a surface: from facet to facet, until it leaves.
//!
//! At the first facet both ways are followed, with their weights; at all later ones the light is reflected or
//! transmitted by chance. What a facet absorbs is taken from the weight, so that no order is cut off; light
//! of little weight is absorbed by chance.

use papilio_sampling::SampleStream;

use crate::Coating;
use crate::ray::{Face, Met, Ray, Side, dot, moved, renormalised};

/// Facets after which light counts as lost: far beyond any order that matters.
const MOST_FACETS: u32 = 100_000;

/// Weight, relative to that after the first facet, below which light is absorbed by chance.
const LITTLE: f64 = 1e-3;

/// What all facets have in common.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facets<'a> {
    /// Indices of the media above and below.
    pub(crate) index: [f64; 2],
    pub(crate) coating: &'a Coating,
}

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

/// Light that does not leave a surface, as fractions of the light that entered.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Stays {
    /// Lost by the tracer.
    pub(crate) lost: f64,
    /// Absorbed by facets.
    pub(crate) absorbed: f64,
    /// The absorbed fractions, each times the number of facets that this light met.
    pub(crate) absorbed_facets: f64,
}

/// Follows light that comes in at a place from a side.
pub(crate) fn follow(
    face: &dyn Face,
    facets: Facets<'_>,
    ray: &Ray,
    side: Side,
    numbers: (&SampleStream, u64),
    leaves: &mut dyn FnMut(Leaves),
) -> Stays {
    // In a volume, the media are the matrix and the particles, and both ways begin in the matrix.
    let (facets, side) = match face.particle_index() {
        Some(index) => (Facets { index: [facets.index[0], index], ..facets }, Side::Above),
        None => (facets, side),
    };
    let (at, normal) = match face.next(ray, side) {
        Met::Facet { at, normal } => (at, normal),
        Met::Nothing if face.particle_index().is_some() => {
            let side = towards(ray.along);
            leaves(Leaves { side, along: ray.along, weight: 1.0, regular: true, facets: 0 });
            return Stays::default();
        }
        Met::Nothing | Met::Unknown => return Stays { lost: 1.0, ..Stays::default() },
    };
    let split = Facet::new(facets, ray.along, side, normal);
    let is_flat = normal[2] == 1.0;
    let absorbed = split.absorptance();
    let mut stays = Stays { absorbed, absorbed_facets: absorbed, lost: 0.0 };
    for (branch, (weight, along, side)) in
        [(split.reflectance, split.reflected, side), (split.transmittance, split.refracted, side.other())]
            .into_iter()
            .enumerate()
    {
        if weight > 0.0 {
            let mut walk =
                Walk { ray: Ray { at, along }, side, regular: is_flat, weight, least: LITTLE * weight };
            match walk.run(face, facets, (numbers.0, branch as u64, numbers.1), &mut stays) {
                End::Left { facets } => {
                    let Walk { ray, weight, regular, .. } = walk;
                    let side = towards(ray.along);
                    leaves(Leaves { side, along: ray.along, weight, regular, facets });
                }
                End::Absorbed => {}
                End::Lost => stays.lost += walk.weight,
            }
        }
    }
    stays
}

/// Side on which light leaves.
fn towards(along: [f64; 3]) -> Side {
    if along[2] > 0.0 { Side::Above } else { Side::Below }
}

/// Light after its first facet.
struct Walk {
    ray: Ray,
    side: Side,
    regular: bool,
    weight: f64,
    /// Weight below which it is absorbed by chance.
    least: f64,
}

/// How the way of light ends.
enum End {
    Left { facets: u32 },
    Absorbed,
    Lost,
}

impl Walk {
    fn run(
        &mut self,
        face: &dyn Face,
        media: Facets<'_>,
        (numbers, branch, path): (&SampleStream, u64, u64),
        stays: &mut Stays,
    ) -> End {
        let mut uniform = [0.0; 4];
        // Most light meets one facet, and needs no numbers.
        let mut own = None;
        for facets in 0..MOST_FACETS {
            let (at, normal) = match face.next(&self.ray, self.side) {
                Met::Nothing => return End::Left { facets: facets + 1 },
                Met::Unknown => return End::Lost,
                Met::Facet { at, normal } => (at, normal),
            };
            if facets % 4 == 0 {
                let own = own.get_or_insert_with(|| numbers.part(branch));
                uniform = own.block(path, 2 + facets / 4);
            }
            let facet = Facet::new(media, self.ray.along, self.side, normal);
            let mut chance = uniform[(facets % 4) as usize];
            let absorptance = facet.absorptance();
            if absorptance > 0.0 {
                let is_little = self.weight < self.least;
                let absorbed = match is_little {
                    true if chance < 1.0 - absorptance => 0.0,
                    true => self.weight,
                    false => self.weight * absorptance,
                };
                stays.absorbed += absorbed;
                stays.absorbed_facets += absorbed * f64::from(facets + 2);
                self.weight -= absorbed;
                if self.weight <= 0.0 {
                    return End::Absorbed;
                }
                if !is_little {
                    chance *= 1.0 - absorptance;
                }
            }
            let along = if chance < facet.reflectance {
                facet.reflected
            } else {
                self.side = self.side.other();
                facet.refracted
            };
            self.regular &= normal[2] == 1.0;
            self.ray = Ray { at, along };
        }
        End::Lost
    }
}

/// Light at a facet.
struct Facet {
    reflectance: f64,
    transmittance: f64,
    reflected: [f64; 3],
    /// Direction behind the facet; that of the reflected light where nothing is transmitted.
    refracted: [f64; 3],
}

impl Facet {
    fn new(media: Facets<'_>, along: [f64; 3], side: Side, normal: [f64; 3]) -> Self {
        let [from, to] = match side {
            Side::Above => media.index,
            Side::Below => [media.index[1], media.index[0]],
        };
        // Along the normal, towards the side of the light.
        let towards = if side == Side::Above { normal } else { normal.map(|part| -part) };
        // Rounding may put a grazing ray behind its facet.
        let cosine = (-dot(along, towards)).max(0.0);
        let reflected = renormalised(moved(along, 2.0 * cosine, towards));
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let split = media.coating.split([from, to], side, from * sine);
        let ratio = from / to;
        let behind = 1.0 - (ratio * sine).powi(2);
        if behind > 0.0 && split.transmittance > 0.0 {
            let refracted =
                renormalised(moved(along.map(|part| ratio * part), ratio * cosine - behind.sqrt(), towards));
            return Self {
                reflectance: split.reflectance,
                transmittance: split.transmittance,
                reflected,
                refracted,
            };
        }
        // Rounding at the critical angle: what would be transmitted is reflected.
        let reflectance = if media.coating.absorbs() { split.reflectance + split.transmittance } else { 1.0 };
        Self { reflectance, transmittance: 0.0, reflected, refracted: reflected }
    }

    fn absorptance(&self) -> f64 {
        (1.0 - self.reflectance - self.transmittance).max(0.0)
    }
}
