//! The TOML scenario: *describe* and *resolve*, with errors that say where.
//!
//! A scenario is one file: the display, the light on it, the viewer, and how to
//! compute. [`Scenario::load`] reads it (*describe*: every key known, of the right
//! type and in range) and [`Scenario::resolve`] turns it into a
//! [`Scene`](papilio_display::scene::Scene) (*resolve*: materials, lights and files
//! on the wavelength grid, everything checked against everything else).
//!
//! - The grammar is declared once, in `describe`: a table's struct, its reading,
//!   its defaults and its JSON [`schema`] come from the same lines.
//! - A mistake is a [`ScenarioError`]: file (or `--set`), line and column, what was
//!   expected, a hint; all independent mistakes are reported together.
//! - Later changes (`--set`) and presets act on the tree of the text before it is
//!   read, so that they obey the same grammar and point to their own text.
//! - A [`Sweep`] is a scenario at many points: values of its `[sweep]` are put into the same tree.
//! - An [`Optimisation`] is a scenario with what may vary and what is wanted of it.
//! - A [`Varied`] is a scenario whose keys take any values, one set after the other.
//! - A [`Tolerance`] is a [`Varied`] with the distributions of its keys, and limits.
//! - The [hash](Resolved::hash) names the computation: the scenario with all its
//!   defaults, and the bytes of its files.
//!
//! Limits: a text of at most 1 MiB, files of at most 64 MiB, 5000 views, ten million
//! numbers for each quantity of the result, eight million states x wavelengths x
//! (directed sources + 8), and 100 000 film gaps x wavelengths; nothing a file says makes the
//! program panic or take memory without bound. **Out of scope**:
//! any computation with light.
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

mod describe;
mod edit;
mod error;
mod grammar;
mod kinds;
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
mod sweep;
mod tolerance;
mod tree;
mod varied;

pub use edit::{Edit, edit};
pub use error::{ScenarioError, ScenarioErrors};
pub use library::{KeptFile, Library};
pub use memo::Memo;
pub use migrate::{Migrated, RenamedPlace, migrate};
pub use mistake::MistakeKind;
pub use optimise::{
    Optimisation, SearchAim, SearchCondition, SearchConstraint, SearchMethod, SearchObjective,
    SearchQuantity, SearchRange, SearchVariable,
};
pub use page::with_key_tables;
pub use papilio_diagnostics::{Diagnostic, nearest};
pub use path::KeyPath;
pub use preset::{new_scenario, preset_names};
pub use resolve::VirtualMeasurement;
pub use scenario::{Resolved, Scenario};
pub use schema::schema;
pub use sweep::{LightSweep, Sweep};
pub use tolerance::{AskedMetric, ScatteredKey, Tolerance, ToleranceLimit};
pub use varied::Varied;
