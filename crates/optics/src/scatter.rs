//! Scattering interfaces given by tables or formulas: densities over direction cosines.
//!
//! **Model.** An interface that scatters light from one hemisphere of air into one hemisphere of air, on the
//! same side (reflection) or through (transmission), given by its BSDF f in 1/sr without the cosine,
//! referred to air. Since `cos(theta) d omega = d^2 beta`, f is the density of the scattered light per area
//! of direction cosines, for a unit of incident light. Unlike a [`Lobe`](crate::lobe::Lobe) it includes the
//! total: [`evaluate`](Scatterer::evaluate) integrates to the fraction that is scattered, and the rest,
//! except for regular light, is absorbed.
//!
//! **Kinds.** [`Ward`]: a formula, for surfaces and (flipped) for foils. [`Table`]: measured values,
//! interpolated smoothly. [`RingKernel`]: the kernel of a surface, between rings of directions of either
//! side.
//!
//! **Validity.** Isotropic samples: rotation about the normal changes nothing, and scattering is symmetric
//! about the plane of incidence. Only light of the disc of air `|beta| <= 1` is scattered, and only into it;
//! a table of a transmission may extend farther on the side of the glass ([`Table::reaching`]).
//!
//! **Reciprocity.** `f(from, to) = f(to, from)` in cosines of propagation holds for a reflection; a table
//! need not fulfil it. [`Scatter::reciprocal`] is the mean of both readings. [`Scatter::reversed`] describes
//! light that goes up through a diffuser measured downwards.

mod albedos;
mod axis;
mod proposal;
mod rings;
mod smooth;
mod table;
mod ward;

use std::sync::Arc;

pub use rings::{RingKernel, Rings};
pub use table::Table;
pub use ward::{GaussianFacets, HalfVector, Normalisation, Ward, ward};

use crate::Beta;
use crate::scatterer::{Sample, Scatterer};

/// A scattering kernel.
#[derive(Debug, Clone)]
pub enum Scatter {
    /// Given by a formula.
    Ward(Arc<Ward>),
    /// Given by a table, read in this sense.
    Table(Arc<Table>, Sense),
    /// Between rings of directions.
    Rings(Arc<RingKernel>),
}

/// Sense in which a table is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    /// As given: from the incidence to the scattered direction.
    Forward,
    /// For light in the opposite direction.
    Reversed,
    /// The mean of both: reciprocal.
    Mean,
}

impl From<Table> for Scatter {
    fn from(table: Table) -> Self {
        Self::Table(Arc::new(table), Sense::Forward)
    }
}

impl From<Ward> for Scatter {
    fn from(ward: Ward) -> Self {
        Self::Ward(Arc::new(ward))
    }
}

impl From<RingKernel> for Scatter {
    fn from(kernel: RingKernel) -> Self {
        Self::Rings(Arc::new(kernel))
    }
}

/// Kernels are equal if their values are.
impl PartialEq for Scatter {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Ward(a), Self::Ward(b)) => Arc::ptr_eq(a, b) || a == b,
            (Self::Table(a, sense), Self::Table(b, other)) => sense == other && (Arc::ptr_eq(a, b) || a == b),
            (Self::Rings(a), Self::Rings(b)) => Arc::ptr_eq(a, b) || a == b,
            _ => false,
        }
    }
}

impl Scatterer for Scatter {
    type Direction = Beta;

    #[inline]
    fn evaluate(&self, from: Beta, to: Beta) -> f64 {
        if self.misses(from, to) {
            return 0.0;
        }
        match self {
            Self::Ward(ward) => ward.evaluate(from, to),
            Self::Table(table, Sense::Forward) => table.value(from, to),
            Self::Table(table, Sense::Reversed) => table.value(to, from),
            Self::Table(table, Sense::Mean) => 0.5 * (table.value(from, to) + table.value(to, from)),
            Self::Rings(kernel) => kernel.evaluate(from, to),
        }
    }

    #[inline]
    fn sample(&self, from: Beta, u: [f64; 4]) -> Option<Sample<Beta>> {
        let [u, v, choice, last] = u;
        let to = match self {
            Self::Ward(ward) => ward.facets().sample(from, [u, v])?,
            Self::Table(table, Sense::Forward) => table.sample(from, [u, v, choice], false),
            Self::Table(table, Sense::Reversed) => table.sample(from, [u, v, choice], true),
            Self::Table(table, Sense::Mean) if choice < 0.5 => {
                table.sample(from, [u, v, 2.0 * choice], false)
            }
            Self::Table(table, Sense::Mean) => table.sample(from, [u, v, 2.0 * choice - 1.0], true),
            Self::Rings(kernel) => kernel.sample(from, [u, v, choice, last])?,
        };
        Sample::new(self, from, to)
    }

    #[inline]
    fn density(&self, from: Beta, to: Beta) -> f64 {
        if self.misses(from, to) {
            return 0.0;
        }
        match self {
            Self::Ward(ward) => ward.density(from, to),
            Self::Table(table, Sense::Forward) => table.density(from, to, false),
            Self::Table(table, Sense::Reversed) => table.density(from, to, true),
            Self::Table(table, Sense::Mean) => {
                0.5 * (table.density(from, to, false) + table.density(from, to, true))
            }
            Self::Rings(kernel) => kernel.density(from, to),
        }
    }

    fn albedo(&self, from: Beta) -> f64 {
        self.albedo_at(from.length())
    }
}

impl Scatter {
    /// Returns the [albedo](Scatterer::albedo) for light that arrives with this `|beta|`, within its disc,
    /// interpolated: accurate to about 1e-4.
    #[inline]
    pub fn albedo_at(&self, from_length: f64) -> f64 {
        match self {
            Self::Ward(ward) => ward.albedo_at(from_length),
            Self::Table(table, Sense::Forward) => table.albedo(from_length, false),
            Self::Table(table, Sense::Reversed) => table.albedo(from_length, true),
            Self::Table(table, Sense::Mean) => {
                0.5 * (table.albedo(from_length, false) + table.albedo(from_length, true))
            }
            Self::Rings(kernel) => kernel.albedo(from_length),
        }
    }

    /// Returns [`Self::albedo_at`] by quadrature, for callers that need more digits than the interpolation
    /// has. `fineness` is 2, 3, ...; each step gains a digit or more.
    pub fn albedo_by(&self, from_length: f64, fineness: usize) -> f64 {
        let table = |table: &Table, reversed| table.albedo_by(from_length, reversed, fineness);
        match self {
            Self::Ward(ward) => ward.albedo_by(from_length, fineness),
            Self::Table(of, Sense::Forward) => table(of, false),
            Self::Table(of, Sense::Reversed) => table(of, true),
            Self::Table(of, Sense::Mean) => 0.5 * (table(of, false) + table(of, true)),
            Self::Rings(kernel) => kernel.albedo(from_length),
        }
    }

    /// Returns the distance in direction cosines over which the kernel changes, about its peak: the width of
    /// the corresponding k-correlation lobe.
    pub fn width(&self) -> f64 {
        match self {
            Self::Ward(ward) => ward.width(),
            Self::Table(table, _) => table.width(),
            Self::Rings(kernel) => kernel.width(),
        }
    }

    /// Returns the difference of azimuths, radians, over which the kernel changes between directions of
    /// these `|beta|`: the distance to 1/e for a Gaussian ([`Self::is_gaussian`]), otherwise that of its
    /// nearest pole. Near the horizon half vectors about the normal connect directions that are ever closer
    /// in azimuth.
    pub fn azimuth_width(&self, from: f64, to: f64) -> f64 {
        let product = (from * to).max(1e-12);
        match self {
            Self::Ward(ward) => ward.azimuth_width(from, to) / product.sqrt(),
            Self::Table(..) | Self::Rings(_) => {
                let width = self.width();
                let excess = (width * width + (from - to) * (from - to)) / (2.0 * product);
                (excess + (excess * (excess + 2.0)).sqrt()).ln_1p()
            }
        }
    }

    /// Returns K if the [albedo](Self::albedo_at) grows towards the horizon as K/c, with c the cosine of the
    /// light: without a bound, and so fast that the variance of light near the horizon is infinite if
    /// directions are sampled by the cosine. `None` for all kernels but Ward's with Duer's normalisation.
    pub fn growth_at_horizon(&self) -> Option<f64> {
        match self {
            Self::Ward(ward) => ward.growth_at_horizon(),
            Self::Table(..) | Self::Rings(_) => None,
        }
    }

    /// Returns true if the kernel is a Gaussian of half vectors.
    pub fn is_gaussian(&self) -> bool {
        matches!(self, Self::Ward(_))
    }

    /// Returns the radii, in direction cosines, of the discs of incident and of scattered light: 1, that of
    /// air, except for a table that [extends](Table::reaching) beyond and for rings.
    #[inline]
    pub fn discs(&self) -> [f64; 2] {
        match self {
            Self::Table(table, Sense::Forward) => [1.0, table.ends()[1].max(1.0)],
            Self::Table(table, Sense::Reversed) => [table.ends()[1].max(1.0), 1.0],
            Self::Ward(_) | Self::Table(_, Sense::Mean) => [1.0, 1.0],
            Self::Rings(kernel) => kernel.rings().map(Rings::radius),
        }
    }

    /// Returns true if either direction lies beyond its disc.
    #[inline]
    fn misses(&self, from: Beta, to: Beta) -> bool {
        let [of_from, of_to] = self.discs();
        from.squared() > of_from * of_from || to.squared() > of_to * of_to
    }

    /// Returns the values of `|beta|` other than 1 at which the kernel jumps: where its incidences end
    /// ([`Table::dark_beyond`]), and where the scattered light ends.
    pub fn edges(&self) -> impl Iterator<Item = f64> {
        let ends = match self {
            Self::Ward(_) | Self::Rings(_) => [1.0; 2],
            Self::Table(table, _) => table.ends(),
        };
        ends.into_iter().filter(|end| *end != 1.0)
    }

    /// Returns the kernel of light in the opposite direction: `reversed.evaluate(a, b) = evaluate(b, a)`.
    pub fn reversed(&self) -> Self {
        match self {
            Self::Ward(ward) => Self::Ward(Arc::clone(ward)),
            Self::Table(table, sense) => {
                let sense = match sense {
                    Sense::Forward => Sense::Reversed,
                    Sense::Reversed => Sense::Forward,
                    Sense::Mean => Sense::Mean,
                };
                Self::Table(Arc::clone(table), sense)
            }
            Self::Rings(kernel) => Self::Rings(Arc::new(kernel.reversed())),
        }
    }

    /// Returns the mean of this kernel and its reverse; rings, which are made reciprocal before, as they are.
    pub fn reciprocal(&self) -> Self {
        match self {
            Self::Ward(ward) => Self::Ward(Arc::clone(ward)),
            Self::Table(table, _) => Self::Table(Arc::clone(table), Sense::Mean),
            Self::Rings(kernel) => Self::Rings(Arc::clone(kernel)),
        }
    }

    /// Returns true if light has the same density in both directions, for all directions.
    pub fn is_reciprocal(&self) -> bool {
        match self {
            Self::Ward(_) | Self::Table(_, Sense::Mean) => true,
            Self::Table(..) => false,
            Self::Rings(kernel) => kernel.is_reciprocal(),
        }
    }
}
