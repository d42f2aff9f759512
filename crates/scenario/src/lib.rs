//! The TOML scenario: it is read (*describe*) and evaluated (*resolve*), with errors that state the line.
//!
//! A scenario is one file. It describes the display, the light, the viewer, and the
//! computation. [`Scenario::load`] reads it: every key must be known, of the right type
//! and in range. [`Scenario::resolve`] turns it into a
//! [`Scene`](papilio_display::scene::Scene): it evaluates materials, lights and files
//! on the wavelength grid, and checks that all keys fit together.
//!
//! - The grammar is declared once, in `describe`: the struct of a table, its reading,
//!   its defaults, its JSON [`schema`] and its documentation come from the same lines.
//! - A mistake is a [`ScenarioError`] with the file (or `--set`), line and column, the
//!   expectation and a hint. All independent mistakes are reported together.
//! - Changes by `--set` and presets act on the parsed tree before it is read. They
//!   satisfy the same grammar, and their errors point to their own text.
//! - A [`Sweep`] is a scenario at many points: the values of its `[sweep]` are set in the same tree.
//! - An [`Optimisation`] is a scenario with variables, objectives and constraints.
//! - A [`ParameterisedScenario`] is a scenario some of whose keys get values one set after the other.
//! - A [`Tolerance`] is a [`ParameterisedScenario`] with distributions of its keys, and limits.
//! - A [`Fit`] is a [`ParameterisedScenario`] with variables that measured data are to determine.
//! - A [`SurfaceScenario`] is not a scenario of a display, but the geometry of a surface, for
//!   `papilio gonio`.
//! - The [hash](Resolved::hash) identifies the computation: the scenario with all its
//!   defaults, and the bytes of its files.
//!
//! Limits: a text of at most 1 MiB, files of at most 64 MiB, 5000 views, ten million
//! numbers for each quantity of the result, eight million states x wavelengths x
//! (directed sources + 8), and 100 000 film gaps x wavelengths. No content of a file makes the
//! program panic or use memory without bound. **Out of scope**: any computation with light. A surface by its
//! geometry is described in the scene, and measured when that is prepared.
//!
//! ```
//! use papilio_scenario::Scenario;
//! use std::path::Path;
//!
//! let text = r#"
//!     [display.pixel]
//!     model = "uniform"
//!     kind = "lambertian"
//!     reflectance = { white = 0.45, black = 0.03 }
//!     [lighting]
//!     preset = "indoor"
//! "#;
//! let set = ["display.glass.surface=fresnel".to_owned()];
//! let resolved = Scenario::from_text(text, "paper.toml", Path::new(""), &set)?.resolve()?;
//! assert_eq!(resolved.scene.grid.len(), 81);
//! assert_eq!(resolved.scene.lighting.directed[0].theta_deg, -20.0);
//!
//! let wrong = text.replace("0.45", "45");
//! let errors = Scenario::from_text(&wrong, "paper.toml", Path::new(""), &[]).unwrap_err();
//! assert!(errors.to_string().starts_with("error: 45 is out of range\n --> paper.toml:5:29"));
//! # Ok::<(), papilio_scenario::ScenarioErrors>(())
//! ```

mod browse;
mod describe;
mod edit;
mod error;
mod fit;
mod grammar;
mod here;
mod kinds;
mod labels;
mod library;
mod memo;
mod migrate;
mod mistake;
mod nearest;
mod optimise;
mod origin;
mod page;
mod path;
mod preset;
mod range;
mod read;
mod renamed;
mod resolve;
mod scattered;
mod scenario;
mod schema;
mod set;
mod source;
mod surface;
mod sweep;
mod tolerance;
mod tree;
mod varied;
mod word;

pub use browse::{
    IlluminantEntry, IlluminantSheet, LiquidCrystalEntry, MaterialEntry, MaterialSheet, illuminant_sheet,
    illuminants, liquid_crystals, material_sheet, materials, materials_like, with_catalogue_tables,
};
pub use edit::{Edit, edit};
pub use error::{ScenarioError, ScenarioErrors, near_file};
pub use fit::{Fit, FitDeviations, FitTarget, FitVariable};
pub use here::{looks_like_path, relative_path};
pub use labels::{label, variable_label};
pub use library::{Library, MemoryFile};
pub use memo::ResolveCache;
pub use migrate::{Migrated, RenamedPlace, migrate};
pub use mistake::{MissingKey, MistakeKind};
pub use optimise::{
    Key, NamedQuantity, Optimisation, SearchAim, SearchCondition, SearchConstraint, SearchMethod,
    SearchObjective, SearchRange, SearchVariable,
};
pub use page::with_key_tables;
pub use papilio_diagnostics::{Diagnostic, Interface, Remedy, nearest};
pub use papilio_display::{Label, labelled_names};
pub use papilio_spectra::materials_called;
pub use path::KeyPath;
pub use preset::{
    ExampleDisplay, PICTURE_LIGHT, UsedPreset, new_scenario, new_scenario_of, picture_scenario, preset_names,
};
pub use resolve::LayerSurface;
pub use resolve::PanelCodes;
pub use resolve::VirtualMeasurement;
pub use resolve::{ImageRequest, picture_size};
pub use scenario::{Resolved, Scenario, text_of};
pub use schema::{schema, surface_schema};
pub use surface::{ResolvedSurface, SurfaceScenario};
pub use sweep::{LightSweep, Sweep};
pub use tolerance::{ReportedMetric, ScatteredKey, Tolerance, ToleranceLimit};
pub use varied::ParameterisedScenario;
