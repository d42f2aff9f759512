//! Design studies of displays: evaluation of designs, optimisation, and tolerance analysis.
//!
//! A [`Study`] defines the variables (keys of a scenario, each with a number or a choice), the conditions
//! (lights, views, or any other keys of a scenario) and the quantities that are computed for every design. An
//! [`Evaluator`] computes them:
//!
//! ```
//! use papilio_design::{Condition, Evaluator, Key, NamedQuantity, Quantity, Study, Values, Variable};
//! use papilio_display::scene::Metric;
//! use papilio_scenario::{ParameterisedScenario, new_scenario};
//! use std::path::Path;
//! use std::sync::{Arc, atomic::AtomicBool};
//!
//! let text = new_scenario("indoor").unwrap();
//! let gap = "display.pixel.gap_nm.red".to_owned();
//! let varied = ParameterisedScenario::from_text(&text, "indoor.toml", Path::new(""), &[], &[gap.clone()])?;
//! let gamut = Quantity::Metric { view: 0, state: None, metric: Metric::gamut_percent_srgb };
//! let study = Study {
//!     conditions: vec![Condition { name: String::new(), varied }],
//!     variables: vec![Variable { name: "red".into(), keys: vec![Key::plain(gap)], values: Values::Number }],
//!     quantities: vec![NamedQuantity { name: "gamut".into(), condition: 0, quantity: gamut }],
//! };
//! let stop = AtomicBool::new(false);
//! let mut evaluator = Evaluator::new(Arc::new(study), &stop);
//! let gamuts = [276.0, 250.0].map(|gap_nm| evaluator.evaluate(&[gap_nm]).unwrap()[0].unwrap());
//! assert!(gamuts[0] > gamuts[1]);
//! # Ok::<(), papilio_scenario::ScenarioErrors>(())
//! ```
//!
//! [`search`] improves designs, [`fit`] determines them from measured data, [`tolerance`] computes the
//! distribution of quantities in production, [`measured`] the simulated side of a comparison with a measurement,
//! and [`output`] writes the results as tables, figures and scenarios.
//!
//! **Out of scope.** Writing files, printing, clocks.

mod error;
mod evaluator;
mod exact;
mod film_fast_path;
pub mod fit;
mod light;
pub mod measured;
pub mod output;
mod parallel;
mod parameter;
mod pixels;
pub mod search;
mod study;
pub mod tolerance;

pub use error::DesignError;
pub use evaluator::{Evaluator, Slopes};
pub use light::LightStudy;
pub use papilio_display::Quantity;
pub use papilio_scenario::{Key, NamedQuantity};
pub use study::{Condition, Study, Values, Variable};
