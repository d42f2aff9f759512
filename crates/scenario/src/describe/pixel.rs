//! `[display.pixel]`: a film, a table, a uniform or a measured pixel.

use std::borrow::Cow;

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{TableAngles, UniformKind};
use schemars::{JsonSchema, Schema, SchemaGenerator};

use super::codes::Codes;
use super::crystal::CrystalPixel;
use super::diffuser::{Extrapolate, Normalise};
use super::display::{MaterialSpec, ShareSpectrum};
use super::numbers::{FaceIndex, Micrometres, Nanometres, PositiveShare, Share};
use crate::error::Errors;
use crate::grammar::{choice, forms, kinds, table};
use crate::origin::Origin;
use crate::read::{Named, Read, Spanned};
use crate::tree::{Node, Value};
use crate::word::Word;

kinds! {
    /// The pixel array; its keys depend on `model`.
    Pixel by "model" {
        /// Thin-film sub-pixels that share one stack with a gap.
        Film(Box<FilmPixel>) = "film",
        /// States from a table over angle and wavelength.
        Table(TablePixel) = "table",
        /// States with the same reflectance at all angles.
        Uniform(UniformPixel) = "uniform",
        /// States with a BRDF measured with a goniometer or an imaging sphere.
        Measured(MeasuredPixel) = "measured",
        /// Colours of the states of a whole panel, measured through its own surface.
        Palette(PalettePixel) = "palette",
        /// Liquid-crystal cells, polarisers and retarders over a reflector.
        Crystal(CrystalPixel) = "liquid-crystal",
    }
}

impl Pixel {
    /// Place of its `model` in the text.
    pub(crate) fn model(&self) -> Origin {
        match self {
            Self::Film(film) => film.origin,
            Self::Table(table) => table.origin,
            Self::Uniform(uniform) => uniform.origin,
            Self::Measured(measured) => measured.origin,
            Self::Palette(palette) => palette.origin,
            Self::Crystal(crystal) => crystal.origin,
        }
    }

    /// Codes of its states.
    pub(crate) fn codes(&self) -> &Spanned<Option<Codes>> {
        match self {
            Self::Film(film) => &film.value.codes,
            Self::Table(table) => &table.value.codes,
            Self::Uniform(uniform) => &uniform.value.codes,
            Self::Measured(measured) => &measured.value.codes,
            Self::Palette(palette) => &palette.value.codes,
            Self::Crystal(crystal) => &crystal.value.codes,
        }
    }
}

table! {
    /// Thin-film sub-pixels that share one stack, in which one layer is the gap.
    FilmPixel {
        /// Layers from the glass down, `{ material, thickness_nm }` each; exactly one has `thickness_nm = "gap"`.
        film as "Film": Vec<Spanned<FilmLayer>>,
        /// Material of the opaque, semi-infinite substrate.
        substrate: MaterialSpec,
        /// Fraction of the active area of each sub-pixel; the sum is 1 within 0.001. Any names except `dark`.
        area as "Area fraction": Named<Share>,
        /// Gap at which each sub-pixel shows its own colour; also `dark`, that of a dark sub-pixel, if a
        /// state needs it.
        gap_nm as "Gap": Named<Nanometres>,
        /// Active fraction of the panel.
        fill_factor: PositiveShare = PositiveShare(1.0),
        /// Reflectance of the inactive area.
        inactive_reflectance: ShareSpectrum = ShareSpectrum::Constant(Share(0.0)),
        /// Further states; the name of a default state replaces it. Default: none.
        states: Named<StateSpec> = Named(Vec::new()),
        /// Whether to define white, black, red, green, blue, cyan, magenta and yellow, if there are
        /// sub-pixels red, green and blue.
        default_states: bool = true,
        /// Codes of the states for the controller of the panel. Default: the numbers of
        /// the states.
        codes as "Codes of the states": Option<Codes>,
    }
}

table! {
    /// A layer of the film stack.
    FilmLayer {
        /// Refractive index of the layer.
        material: MaterialSpec,
        /// Thickness of the layer, or `"gap"` for the layer that changes with the state.
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

/// The drive of each sub-pixel in a state.
#[derive(Debug, Clone, serde::Serialize)]
#[serde(transparent)]
pub(crate) struct StateSpec(pub(crate) Named<DriveSpec>);

impl Read for StateSpec {
    fn in_words() -> String {
        Named::<DriveSpec>::in_words()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        // A sub-pixel may have the name `gap_nm`; its value is then a fraction, at most 1.
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
    /// The drive of a sub-pixel: the fraction of its area in its own colour, or an analogue gap.
    DriveSpec, format!("{}, or {{ gap_nm = ... }}", Share::in_words()); {
        /// Fraction of its area in its own colour, 0 to 1; the rest is dark.
        Share(Share) if Value::Integer(_) | Value::Float(_),
        /// The whole sub-pixel at this gap.
        Gap(DriveGap) if Value::Table(_),
    }
}

table! {
    /// An analogue gap.
    DriveGap {
        /// The gap.
        gap_nm as "Gap": Nanometres,
    }
}

table! {
    /// Complete states (including areas and fill factor) from a table.
    TablePixel {
        /// A CSV file with the columns state, theta_deg, wavelength_nm, reflectance, and phi_deg if the reflectance depends on
        /// azimuth.
        file: String,
        /// Medium of the angles of the file.
        angles: Word<TableAngles>,
        /// Codes of the states for the controller of the panel. Default: the numbers of
        /// the states.
        codes as "Codes of the states": Option<Codes>,
    }
}

choice! {
    for TableAngles {
        /// Angles are in air, before refraction.
        Air = "air",
        /// Angles are in the glass above the pixel.
        Glass = "glass",
    }
}

table! {
    /// States with the same reflectance at all angles.
    UniformPixel {
        /// Kind of the reflection.
        kind: Word<UniformKind>,
        /// Reflectance of each state *below* the glass, not that of a datasheet.
        reflectance: Named<ShareSpectrum>,
        /// The flat face through which the reflectances were measured; those of the pixel are recovered. For
        /// `kind = "lambertian"`. Default: they are the pixel's own.
        measured_through as "Measured through": Option<MeasuredThrough>,
        /// Spread of light within Lambertian pixels: the distance at which the line spread has decreased to
        /// 1/e. Default: 0.
        spread_um as "Spread within the pixel": Option<SpreadWithin>,
        /// Codes of the states for the controller of the panel. Default: the numbers of
        /// the states.
        codes as "Codes of the states": Option<Codes>,
    }
}

table! {
    /// A flat face through which reflectances were measured, in diffuse light at 8 deg (d/8).
    MeasuredThrough {
        /// Refractive index of the medium below the face.
        index: FaceIndex,
        /// Whether the values include the reflection of the face.
        specular as "Specular component": SpecularComponent = SpecularComponent::Included,
    }
}

choice! {
    /// The light that a face reflects like a mirror.
    SpecularComponent {
        /// They do.
        Included = "included",
        /// The instrument has removed it.
        Excluded = "excluded",
    }
}

forms! {
    /// How far light spreads within a pixel: a length, or "slab".
    SpreadWithin, format!("{}, or \"slab\"", Micrometres::in_words()); {
        /// The distance at which the line spread has decreased to 1/e.
        Radius(Micrometres) if Value::Integer(_) | Value::Float(_),
        /// The spread of a slab.
        Slab(SlabWord) if Value::Text(_),
    }
}

/// The word "slab".
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlabWord;

impl Read for SlabWord {
    fn in_words() -> String {
        "\"slab\"".to_owned()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        match &node.value {
            Value::Text(word) if word == "slab" => Some(Self),
            _ => node.wrong_type(SpreadWithin::in_words(), errors),
        }
    }
}

impl serde::Serialize for SlabWord {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str("slab")
    }
}

impl JsonSchema for SlabWord {
    fn schema_name() -> Cow<'static, str> {
        "SlabWord".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({ "const": "slab" })
    }
    fn inline_schema() -> bool {
        true
    }
}

choice! {
    for UniformKind {
        /// Specular.
        Mirror = "mirror",
        /// Diffuse: the same radiance in every direction of the glass.
        Lambertian = "lambertian",
    }
}

table! {
    /// Colours of the states of a whole panel, the same in all directions.
    PalettePixel {
        /// A CSV file with the columns state, wavelength_nm, reflectance_factor, or state, L, a, b.
        file: String,
        /// The CIE illuminant of L\*, a\*, b\*; spectra need none. Default: the one that the file states, or D50.
        illuminant as "Illuminant of L*, a*, b*": Option<String>,
        /// The flat face through which the values were measured; those of the inks are recovered. Default:
        /// the colours are used as they are.
        measured_through as "Measured through": Option<MeasuredThrough>,
        /// Spread of light within Lambertian pixels: the distance at which the line spread has decreased to
        /// 1/e. Default: 0.
        spread_um as "Spread within the pixel": Option<SpreadWithin>,
        /// Codes of the states for the controller of the panel. Default: the numbers of
        /// the states.
        codes as "Codes of the states": Option<Codes>,
    }
}

table! {
    /// A measured BRDF for each state. Its directions are used as directions in the medium above the pixel.
    MeasuredPixel {
        /// A file of measured scattering for each state (docs/bsdf-files.md), of which the reflection from
        /// the front is used.
        file: Named<String>,
        /// Reflectance spectra of any states: the spectral shape of the BRDF, not its level. Default: the
        /// same at all wavelengths.
        spectrum: Named<ShareSpectrum> = Named(Vec::new()),
        /// The totals to which the measurement is normalised.
        normalise: Normalise = Normalise::None,
        /// `true`: cells without light are not measured, and tails are extrapolated; `false`: they are dark.
        extrapolate_tails: bool = false,
        /// Treatment of light beyond the measured directions. Default: `"hold"`, with a note where a file ends.
        extrapolate: Option<Extrapolate>,
        /// Codes of the states for the controller of the panel. Default: the numbers of
        /// the states.
        codes as "Codes of the states": Option<Codes>,
    }
}
