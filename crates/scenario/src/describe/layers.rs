//! `[[display.layers]]`: media and what stands between them, in any order.

use super::diffuser::{Btdf, Slab};
use super::display::{FrontComponent, MaterialSpec, ShareSpectrum};
use super::numbers::{Index, Nanometres, Roughness, Thickness};
use crate::error::Errors;
use crate::grammar::{choice, kinds, table};
use crate::read::{At, Read, Table};
use crate::schema::of_table;
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
        /// A flat component in a medium, the same from both sides and at all angles.
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
        /// Real refractive index, from 1 to 10.
        index: MaterialSpec = MaterialSpec::Number(Index(1.5)),
        /// Internal transmittance along the normal; oblique light takes a longer path. Either this or `thickness_mm`.
        /// Default: clear.
        internal_transmittance: Option<ShareSpectrum>,
        /// Thickness: the index's k (at most 1e-3) absorbs along the path. Either this or `internal_transmittance`.
        thickness_mm: Option<Thickness>,
    }
}

table! {
    /// Coherent films between two media.
    Coating {
        /// The films from top to bottom, 1 to 256.
        film: Vec<At<CoatingFilm>>,
    }
}

table! {
    /// A film of a coating.
    CoatingFilm {
        /// Refractive index of the film.
        material: MaterialSpec,
        /// Thickness of the film.
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
        /// Roughness: the slopes of the face are about this.
        alpha: Roughness,
        /// How the slopes of the face are distributed.
        distribution: Slopes = Slopes::Ggx,
    }
}

/// A layer without other keys.
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
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        of_table(&[], "A layer without other keys.", generator)
    }
}
