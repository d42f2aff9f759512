//! Rays between the facets of a surface.

/// Ray: a place and a direction of length 1. Lengths are in um, z points up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ray {
    pub(crate) at: [f64; 3],
    pub(crate) along: [f64; 3],
}

/// Side of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Side {
    /// The medium above, usually air.
    Above,
    /// The medium below, usually glass.
    Below,
}

impl Side {
    /// Both sides.
    pub const ALL: [Self; 2] = [Self::Above, Self::Below];

    /// The other side.
    pub fn other(self) -> Self {
        match self {
            Self::Above => Self::Below,
            Self::Below => Self::Above,
        }
    }
}

/// What a ray meets next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Met {
    /// The surface, with its normal, of length 1 and pointing up.
    Facet { at: [f64; 3], normal: [f64; 3] },
    /// Nothing: it leaves.
    Nothing,
    /// It is not known what: too many steps.
    Unknown,
}

/// A periodic surface.
pub(crate) trait Face: Sync {
    /// Its period along x and y, um.
    fn period_um(&self) -> [f64; 2];

    /// Lowest and highest height, um.
    fn heights_um(&self) -> [f64; 2];

    /// Index of the particles, if it is a volume: its facets lie between the medium above, which is that
    /// below, and these.
    fn particle_index(&self) -> Option<f64> {
        None
    }

    /// Parts of its period along each side that are small enough for the cache.
    fn tiles_per_side(&self) -> u64 {
        1
    }

    /// Reads what a ray that comes from outside will probably meet, so that it is in the cache when the ray
    /// is followed. The number has no meaning.
    fn expect(&self, _ray: &Ray) -> f64 {
        0.0
    }

    /// What a ray on this side of the surface meets next.
    fn next(&self, ray: &Ray, side: Side) -> Met;
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a + t b`.
pub(crate) fn moved(a: [f64; 3], t: f64, b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] + t * b[k])
}

pub(crate) fn normalised(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    // Divided, because the normal of a horizontal facet must be exactly vertical.
    a.map(|value| value / length)
}

/// A vector whose length differs from 1 by rounding, with less of that.
pub(crate) fn renormalised(a: [f64; 3]) -> [f64; 3] {
    // The first terms of 1/length.
    let per_length = 1.5 - 0.5 * dot(a, a);
    a.map(|value| value * per_length)
}
