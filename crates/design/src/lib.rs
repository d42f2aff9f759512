//! Design work: what a design is worth, and the search for better ones.
//!
//! A [`Study`] says what varies (keys of a scenario, each with a number or a choice), under which conditions
//! (lights, views, anything that a scenario can say) and what is asked of every design. An [`Evaluator`] answers:
//!
//! ```
//! use papilio_design::{Condition, Evaluator, Key, Named, Quantity, Study, Values, Variable};
//! use papilio_display::scene::Metric;
//! use papilio_scenario::{Varied, new_scenario};
//! use std::path::Path;
//! use std::sync::{Arc, atomic::AtomicBool};
//!
//! let text = new_scenario("indoor").unwrap();
//! let gap = "display.pixel.gap_nm.red".to_owned();
//! let varied = Varied::from_text(&text, "indoor.toml", Path::new(""), &[], &[gap.clone()])?;
//! let gamut = Quantity::Metric { view: 0, state: None, metric: Metric::gamut_percent_srgb };
//! let study = Study {
//!     conditions: vec![Condition { name: String::new(), varied }],
//!     variables: vec![Variable { name: "red".into(), keys: vec![Key::plain(gap)], values: Values::Number }],
//!     quantities: vec![Named { name: "gamut".into(), condition: 0, quantity: gamut }],
//! };
//! let stop = AtomicBool::new(false);
//! let mut evaluator = Evaluator::new(Arc::new(study), &stop);
//! let gamuts = [276.0, 250.0].map(|gap_nm| evaluator.evaluate(&[gap_nm]).unwrap()[0].unwrap());
//! assert!(gamuts[0] > gamuts[1]);
//! # Ok::<(), papilio_scenario::ScenarioErrors>(())
//! ```
//!
//! [`tolerance`] says how such quantities scatter in production.
//!
//! **Out of scope.** Files, printing, clocks.

mod error;
mod evaluator;
mod exact;
mod light;
mod parameter;
mod road;
pub mod search;
mod study;
pub mod tolerance;

pub use error::DesignError;
pub use evaluator::{Evaluator, Slopes};
pub use light::LightStudy;
pub use papilio_display::Quantity;
pub use study::{Condition, Key, Named, Study, Values, Variable};
