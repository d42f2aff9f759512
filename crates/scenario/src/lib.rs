//! The TOML scenario: describe and resolve, with errors that say where.
mod describe;
mod error;
mod nearest;
mod preset;
mod read;
mod resolve;
mod scenario;
mod schema;
mod set;
mod source;
mod tree;

pub use error::{Problem, ScenarioError, ScenarioErrors};
pub use preset::preset_names;
pub use scenario::{Resolved, Scenario};
pub use schema::schema;
