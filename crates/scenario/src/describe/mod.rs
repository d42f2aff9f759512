//! Grammar of a scenario file: every key with its type, range and default.
//!
//! These tables do not depend on data files, materials or the wavelength grid; `resolve` reads those.

pub(crate) mod codes;
pub(crate) mod crystal;
pub(crate) mod diffuser;
pub(crate) mod dispersion;
pub(crate) mod display;
pub(crate) mod environment;
pub(crate) mod fit;
pub(crate) mod image;
pub(crate) mod layers;
pub(crate) mod lighting;
pub(crate) mod limits;
pub(crate) mod matrix;
pub(crate) mod measure;
pub(crate) mod metrics;
pub(crate) mod microgeometry;
pub(crate) mod numbers;
pub(crate) mod optimize;
pub(crate) mod pattern;
pub(crate) mod pixel;
pub(crate) mod solver;
pub(crate) mod sparkle;
pub(crate) mod sweep;
pub(crate) mod tolerance;
pub(crate) mod viewer;

use papilio_diagnostics::{Diagnostic, is_override};
use papilio_formats::words::is_formula;

use crate::error::Errors;
use crate::grammar::table;
use crate::mistake;
use crate::read::{Read, Spanned};
use crate::renamed::FORMAT;
use crate::tree::{Node, Value};
use numbers::Wavelength;

table! {
    /// A scenario: the display, the light, the viewer, and the computation.
    File later ["study"] {
        /// Version of the file format. Old names are accepted; `papilio migrate` replaces them.
        format: Format = Format(FORMAT),
        /// Title of tables and figures.
        title: Option<Title>,
        /// The wavelength grid. Default: the defaults of its keys.
        spectrum: Spectrum,
        /// The display: its layers and its pixel.
        display: display::Display,
        /// The light on the display. Default: 500 lx of diffuse D65.
        lighting: lighting::Lighting,
        /// The viewing directions, and the reader. Default: along the normal.
        viewer: viewer::Viewer,
        /// Colorimetric settings. Default: the defaults of its keys.
        metrics: metrics::Metrics,
        /// The solver, and its accuracy. Default: the defaults of its keys.
        solver: solver::Solver,
        /// A virtual imaging sphere that measures the diffuser, for `papilio diffuser measure` only.
        measure: Option<measure::Measure>,
        /// Patterns of two states, and text, for `papilio mtf` only.
        pattern: Option<pattern::Pattern>,
        /// An antiglare face, for `papilio sparkle` only.
        sparkle: Option<sparkle::Sparkle>,
        /// A picture, for `papilio image` only.
        image: Option<image::Image>,
        /// Keys that vary over given values, for `papilio sweep` only.
        sweep: Option<sweep::Sweep>,
        /// A search for better designs, for `papilio optimize` only.
        optimize: Option<optimize::Optimize>,
        /// Production tolerances of keys, and the limits of good displays, for `papilio tolerance` only.
        tolerance: Option<tolerance::Tolerance>,
        /// Keys that are fitted to measured data, for `papilio fit` only.
        fit: Option<fit::Fit>,
    }
}

table! {
    /// The wavelength grid: uniformly spaced, both ends included.
    Spectrum {
        /// First and last wavelength, both included. The range must overlap 380 to 780 nm.
        range_nm as "Wavelength range": Vec<Spanned<Wavelength>> = vec![Spanned::without_span(Wavelength(380.0)), Spanned::without_span(Wavelength(780.0))],
        /// Step of the grid. The range must be an integer number of steps.
        step_nm as "Wavelength step": Wavelength = Wavelength(5.0),
    }
}

/// Number of a grammar. A scenario that has been read is always in the present one.
#[derive(Debug, Clone, serde::Serialize)]
pub(crate) struct Format(pub(crate) u64);

impl Read for Format {
    fn in_words() -> String {
        format!("an integer from 1 to {FORMAT}")
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        match node.value {
            Value::Integer(number) if (1..=FORMAT as i64).contains(&number) => Some(Self(FORMAT)),
            Value::Integer(number) if number > FORMAT as i64 => {
                errors.push(node.origin, mistake::newer_format(number, FORMAT));
                None
            }
            _ => node.wrong_type(Self::in_words(), errors),
        }
    }
}

impl schemars::JsonSchema for Format {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Format".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": "integer", "minimum": 1, "maximum": FORMAT })
    }
    fn inline_schema() -> bool {
        true
    }
}

/// A line of text.
#[derive(Debug, Clone, serde::Serialize)]
pub(crate) struct Title(pub(crate) String);

impl Read for Title {
    fn in_words() -> String {
        "one line of text".to_owned()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        let text = String::read(node, errors)?;
        if text.chars().any(|c| c.is_control() || is_override(c)) {
            let wrong =
                Diagnostic::new("this text has control characters").expected("one line of plain text");
            errors.push(node.origin, wrong);
            return None;
        }
        Some(Self(text))
    }
}

/// A line of text for tables: a spreadsheet must not read it as a formula.
#[derive(Debug, Clone, serde::Serialize)]
pub(crate) struct Label(pub(crate) String);

impl Read for Label {
    fn in_words() -> String {
        Title::in_words()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        let Title(text) = Title::read(node, errors)?;
        if is_formula(&text) {
            errors.push(node.origin, papilio_formats::Problem::BadName);
            return None;
        }
        Some(Self(text))
    }
}

impl schemars::JsonSchema for Label {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Label".into()
    }
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        Title::json_schema(generator)
    }
    fn inline_schema() -> bool {
        true
    }
}

impl schemars::JsonSchema for Title {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Title".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": "string" })
    }
    fn inline_schema() -> bool {
        true
    }
}

impl File {
    /// Fills in the defaults that depend on other keys.
    pub(crate) fn complete(&mut self) {
        self.display.value.complete();
        self.lighting.value.complete();
        self.solver.value.complete();
    }
}
