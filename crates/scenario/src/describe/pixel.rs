//! `[display.pixel]`: film, table, uniform or measured.

use std::borrow::Cow;

use papilio_diagnostics::Diagnostic;
use schemars::{JsonSchema, Schema, SchemaGenerator};

use super::diffuser::{Extrapolate, Normalise};
use super::display::{MaterialSpec, ShareSpectrum};
use super::numbers::{Nanometres, PositiveShare, Share};
use crate::error::Errors;
use crate::grammar::{choice, forms, kinds, table};
use crate::origin::Origin;
use crate::read::{At, Named, Read};
use crate::tree::{Node, Value};

kinds! {
    /// The pixel array; its keys depend on `model`.
    Pixel by "model" {
        /// Thin-film sub-pixels with a gap.
        Film(Box<FilmPixel>) = "film",
        /// States from an angle x wavelength table.
        Table(TablePixel) = "table",
        /// States that reflect the same at all angles.
        Uniform(UniformPixel) = "uniform",
        /// States with a BRDF that was measured with a goniometer or an imaging sphere.
        Measured(MeasuredPixel) = "measured",
    }
}

impl Pixel {
    /// Where its model stands.
    pub(crate) fn model(&self) -> Origin {
        match self {
            Self::Film(film) => film.origin,
            Self::Table(table) => table.origin,
            Self::Uniform(uniform) => uniform.origin,
            Self::Measured(measured) => measured.origin,
        }
    }
}

table! {
    /// Thin-film sub-pixels that share one stack with a gap-dependent layer.
    FilmPixel {
        /// Layers from the glass down; exactly one has `thickness_nm = "gap"`.
        film: Vec<At<FilmLayer>>,
        /// Material of the opaque, semi-infinite substrate.
        substrate: MaterialSpec,
        /// Fraction of the active area for each sub-pixel; they sum to 1 within 0.001. Names are free, except `dark`.
        area: Named<Share>,
        /// Gap of each sub-pixel at its own colour, and of `dark`.
        gap_nm: Named<Nanometres>,
        /// Active fraction of the panel.
        fill_factor: PositiveShare = PositiveShare(1.0),
        /// Reflectance of the inactive part.
        inactive_reflectance: ShareSpectrum = ShareSpectrum::Constant(Share(0.0)),
        /// Drive states of your own; one with the name of a default state replaces it. Default: none.
        states: Named<StateSpec> = Named(Vec::new()),
        /// Whether there are the states white, black, red, green, blue, cyan, magenta and yellow; they need sub-pixels red,
        /// green and blue.
        default_states: bool = true,
    }
}

table! {
    /// A layer of the film stack.
    FilmLayer {
        /// Refractive index of the layer.
        material: MaterialSpec,
        /// Thickness of the layer, or `"gap"` for the one that changes with the state.
        thickness_nm: LayerThickness,
    }
}

forms! {
    /// A thickness in nm, or "gap".
    LayerThickness, format!("{}, or \"gap\"", Nanometres::in_words()); {
        /// The same in every state.
        Fixed(Nanometres) if Value::Integer(_) | Value::Float(_),
        /// The state's gap.
        Gap(Gap) if Value::Text(_),
    }
}

/// The word "gap".
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap;

impl Read for Gap {
    fn in_words() -> String {
        "\"gap\"".to_owned()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        match &node.value {
            Value::Text(word) if word == "gap" => Some(Self),
            _ => node.wrong_type(LayerThickness::in_words(), errors),
        }
    }
}

impl serde::Serialize for Gap {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str("gap")
    }
}

impl JsonSchema for Gap {
    fn schema_name() -> Cow<'static, str> {
        "Gap".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({ "const": "gap" })
    }
    fn inline_schema() -> bool {
        true
    }
}

/// What each sub-pixel does in a state.
#[derive(Debug, Clone, serde::Serialize)]
#[serde(transparent)]
pub(crate) struct StateSpec(pub(crate) Named<DriveSpec>);

impl Read for StateSpec {
    fn in_words() -> String {
        Named::<DriveSpec>::in_words()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        // A sub-pixel may have this name; then it has a share, which is 1 at most.
        if node.get("gap_nm").and_then(Node::number).is_some_and(|value| value > 1.0) {
            let wrong = Diagnostic::new("`gap_nm` is given for a whole state");
            let hint = "a gap belongs under a sub-pixel: teal = { green = { gap_nm = 165.0 } }";
            errors.push(node.origin, wrong.hint(hint));
            return None;
        }
        Named::read(node, errors).map(Self)
    }
}

impl JsonSchema for StateSpec {
    fn schema_name() -> Cow<'static, str> {
        Named::<DriveSpec>::schema_name()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Named::<DriveSpec>::json_schema(generator)
    }
    fn inline_schema() -> bool {
        true
    }
}

forms! {
    /// How a sub-pixel is driven: the share of its area at its own colour, or an analogue gap.
    DriveSpec, format!("{}, or {{ gap_nm = ... }}", Share::in_words()); {
        /// Share of its area at its own colour, 0 to 1, the rest dark.
        Share(Share) if Value::Integer(_) | Value::Float(_),
        /// The whole of it at this gap.
        Gap(DriveGap) if Value::Table(_),
    }
}

table! {
    /// An analogue gap.
    DriveGap {
        /// The gap.
        gap_nm: Nanometres,
    }
}

table! {
    /// Complete states (areas and fill factor included) from a table.
    TablePixel {
        /// CSV file with the columns state, theta_deg, wavelength_nm, reflectance.
        file: String,
        /// The medium of the table's angles.
        angles: TableMedium,
    }
}

choice! {
    /// The medium of a pixel table's angles.
    TableMedium {
        /// In air, before Snell.
        Air = "air",
        /// In the glass above the pixel.
        Glass = "glass",
    }
}

table! {
    /// States that reflect the same at all angles.
    UniformPixel {
        /// How the pixel reflects.
        kind: ReflectionKind,
        /// Reflectance of each state, below the glass.
        reflectance: Named<ShareSpectrum>,
    }
}

choice! {
    /// How a uniform pixel reflects.
    ReflectionKind {
        /// Specularly.
        Mirror = "mirror",
        /// Diffusely: the same radiance in every direction of the glass.
        Lambertian = "lambertian",
    }
}

table! {
    /// A measured BRDF for each state; its directions are taken as those in the medium above the pixel.
    MeasuredPixel {
        /// A file of measured scattering for each state, of which the front reflection is used; its format is recognised by
        /// its content (docs/bsdf-files.md).
        file: Named<String>,
        /// Reflectance spectra of any of the states. Their shape colours the BRDF; the level is that of the file (see
        /// `normalise`). Default: the same at all wavelengths.
        spectrum: Named<ShareSpectrum> = Named(Vec::new()),
        /// What the totals of the measurement are set to.
        normalise: Normalise = Normalise::None,
        /// Whether cells without light are taken as not measured: the tail of a line is then extrapolated beyond the last
        /// cell with light. Otherwise they are dark.
        extrapolate_tails: bool = false,
        /// What becomes of light beyond the directions that were measured. Default: `"none"`; of a file with one incidence
        /// `"hold"`, with a note.
        extrapolate: Option<Extrapolate>,
    }
}
