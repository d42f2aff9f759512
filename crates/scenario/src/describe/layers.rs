//! `[[display.layers]]`: media and interfaces in any order.

use super::diffuser::{Btdf, Slab};
use super::display::{MaterialSpec, ShareSpectrum};
use super::numbers::{
    CorrelationLength, FaceSlope, Index, Kurtosis, Nanometres, Roughness, Share, Tail, Thickness,
};
use crate::error::Errors;
use crate::grammar::{choice, kinds, table};
use crate::read::{Read, Spanned, Table};
use crate::schema::of_table;
use crate::tree::Node;

kinds! {
    /// A medium (`medium`, `slab`) or an interface (the other kinds); its keys depend on `kind`.
    Layer by "kind" {
        /// Cover glass, adhesive, an air gap, a colour filter.
        Medium(Medium) = "medium",
        /// A medium with volume scattering.
        Slab(Slab) = "slab",
        /// A diffuser given by its BTDF, including its surfaces.
        Diffuser(Btdf) = "diffuser",
    /// A flat component in a medium, with the same properties from both sides and at all angles.
        Component(Component) = "component",
        /// Coherent thin films, for example an antireflection coating.
        Coating(Coating) = "coating",
        /// An ideal antireflection interface: transmits all light that exists in both media, and reflects the rest.
        IdealAr(NoKeys) = "ideal-ar",
        /// A bare interface (unpolarised Fresnel), which is also used between two media without another interface.
        Fresnel(NoKeys) = "fresnel",
        /// An etched or moulded surface between two media.
        Rough(Rough) = "rough",
    }
}

table! {
    /// A flat component in a medium, with the same properties from both sides and at all angles.
    Component {
        /// Fraction of the light that is reflected specularly.
        reflectance: ShareSpectrum = ShareSpectrum::Constant(Share(0.0)),
        /// Fraction of the light that is absorbed. Its sum with `reflectance` is at most 1.
        absorptance: ShareSpectrum = ShareSpectrum::Constant(Share(0.0)),
    }
}

table! {
    /// A homogeneous medium.
    Medium {
        /// Refractive index, with n from 1 to 10; its k absorbs only with `thickness_mm`.
        index as "Refractive index": MaterialSpec = MaterialSpec::Number(Index(1.5)),
        /// Transmittance along the normal without the surfaces. Default:
        /// clear.
        internal_transmittance: Option<ShareSpectrum>,
        /// Thickness, for places of light. Without `internal_transmittance`, k of the index (at most 1e-3)
        /// absorbs along the path.
        thickness_mm: Option<Thickness>,
    }
}

table! {
    /// Coherent films between two media.
    Coating {
        /// The films from top to bottom, 1 to 256.
        film: Vec<Spanned<CoatingFilm>>,
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
    /// Distribution of the slopes of a rough interface.
    Slopes {
        /// GGX (Trowbridge-Reitz): half of the surface is steeper than atan(alpha).
        Ggx = "ggx",
        /// Gaussian slopes of variance alpha^2/2 along each axis.
        Beckmann = "beckmann",
        /// A tail between those of the other two (Student's t-distribution), by `tail` or `slope_kurtosis`.
        StudentT = "student-t",
    }
}

table! {
    /// A rough interface between two media of different index, both independent of wavelength.
    Rough {
        /// Roughness: typical slope of the surface. Exactly one of `alpha`, `slope_mean` and `slope_rms`.
        alpha as "Roughness alpha": Option<Roughness>,
        /// Mean absolute slope along one axis, of a profilometer (Rda), or 2 pi Ra/RSm.
        slope_mean as "Mean slope": Option<FaceSlope>,
        /// Root mean square slope along one axis (Rdq); not for `"ggx"` or a `tail` of 2, which have none.
        slope_rms as "Rms slope": Option<FaceSlope>,
        /// Distribution of the slopes.
        distribution: Slopes = Slopes::Ggx,
        /// Tail gamma of `"student-t"`: 2 is `"ggx"`, and `"beckmann"` is its limit for large values.
        tail as "Tail of the slopes": Option<Tail>,
        /// Kurtosis of the slopes along one axis, from which `tail` follows as 3 + 3/(kurtosis - 3).
        slope_kurtosis as "Kurtosis of the slopes": Option<Kurtosis>,
        /// Distance at which the correlation of the heights is 1/e, for `papilio sparkle`; it requires
        /// `distribution = "beckmann"`. Default: not known.
        correlation_um as "Correlation length": Option<CorrelationLength>,
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
