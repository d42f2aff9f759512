//! `[[display.layers]]`: media and what stands between them, in any order.

use super::diffuser::{Btdf, Slab};
use super::display::{FrontComponent, MaterialSpec, ShareSpectrum};
use super::numbers::{Index, Nanometres, Roughness, Thickness};
use crate::error::Errors;
use crate::grammar::{choice, kinds, table};
use crate::read::{At, Read, Table};
use crate::schema::Keys;
use crate::tree::Node;

kinds! {
    /// A medium (`medium`, `slab`) or what stands between two media (the other kinds); its keys depend on `kind`.
    Layer by "kind" {
        /// Cover glass, adhesive, an air gap, a colour filter.
        Medium(Medium) = "medium",
        /// A medium that scatters in its bulk.
        Slab(Slab) = "slab",
        /// A diffuser given by its BTDF, its faces included.
        Diffuser(Btdf) = "diffuser",
        /// A flat component in a medium, alike from both sides and at all angles.
        Component(FrontComponent) = "component",
        /// Coherent thin films, an antireflection coating for example.
        Coating(Coating) = "coating",
        /// A perfect antireflection face: what both media can carry passes whole, the rest is reflected whole.
        IdealAr(NoKeys) = "ideal-ar",
        /// A bare face, unpolarised Fresnel: what stands between two media where no other face is given.
        Fresnel(NoKeys) = "fresnel",
        /// An etched or moulded face between two media.
        Rough(Rough) = "rough",
    }
}

table! {
    /// A homogeneous medium.
    Medium {
        /// Refractive index, real, 1 to 10: a number, a material or a file. Default 1.5.
        index: MaterialSpec = MaterialSpec::Number(Index(1.5)),
        /// Internal transmittance along the normal: 0 to 1, or a spectrum file; oblique light passes more
        /// of the medium. This or `thickness_mm`. Default: clear.
        internal_transmittance: Option<ShareSpectrum>,
        /// Thickness, mm, above 0, at most 1000: the index's k (up to 1e-3) absorbs along the path.
        thickness_mm: Option<Thickness>,
    }
}

table! {
    /// Coherent films between two media.
    Coating {
        /// The films from top to bottom.
        film: Vec<At<CoatingFilm>>,
    }
}

table! {
    /// A film of a coating.
    CoatingFilm {
        /// A refractive index, `{ n, k }`, the name of a material, or a file.
        material: MaterialSpec,
        /// Thickness in nm, 0 to 1e6.
        thickness_nm: Nanometres,
    }
}

choice! {
    /// How the slopes of a rough face are spread.
    Slopes {
        /// GGX (Trowbridge-Reitz): half of the face is steeper than atan(alpha), with a long tail.
        Ggx = "ggx",
        /// Gaussian slopes of variance alpha^2/2 along each axis.
        Beckmann = "beckmann",
    }
}

table! {
    /// A rough face between two media of different, constant index.
    Rough {
        /// Roughness, .01 to 1: the slopes of the face are about this.
        alpha: Roughness,
        /// How the slopes are spread: "ggx" (a long tail) or "beckmann" (Gaussian). Default "ggx".
        distribution: Slopes = Slopes::Ggx,
    }
}

/// A layer of which its kind says all.
#[derive(Debug, Clone, serde::Serialize)]
pub(crate) struct NoKeys {}

impl Table for NoKeys {
    fn keys() -> Vec<&'static str> {
        Vec::new()
    }
}

impl Read for NoKeys {
    fn in_words() -> String {
        "a table without other keys".to_owned()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        node.known_entries(&[], &[], errors).map(|()| Self {})
    }
}

impl schemars::JsonSchema for NoKeys {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "NoKeys".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        Keys::default().into_table("A layer of which its kind says all.")
    }
}
