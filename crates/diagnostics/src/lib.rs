//! Diagnostics about the user's input: what is wrong, where, and what to do.
//!
//! - [`Place`]: a file or an option of the command line, with line, column and the text of the line.
//! - [`Diagnostic`]: a message, what was expected, a note and a hint. The code that finds a mistake creates
//!   it; `diagnostic.at(&place)` prints it as a compiler's message.
//! - [`Remedy`]: a key or an option that mends a mistake, which each [`Interface`] states in its own words.
//! - [`nearest`] and [`suggestion`]: the known name that a misspelled one probably means.
//! - [`number`]: a number as all messages and reports write it, with an exponent if it is very large or
//!   small.
//! - [`visible`]: a text in which the characters that control a terminal are escaped.
//! - [`Warned`]: a value with its warnings.
//!
//! **Out of scope**: the list of possible mistakes. Each crate that finds mistakes defines the cases that
//! code has to distinguish.

mod diagnostic;
mod nearest;
mod number;
mod place;
mod remedy;
mod text;
mod warned;

pub use diagnostic::{Diagnostic, Placed};
pub use nearest::{did_you_mean, nearest, quoted, suggestion};
pub use number::{number, short_numbers};
pub use place::{Place, Spot};
pub use remedy::{Interface, Remedy};
pub use text::{in_one_line, is_override, visible};
pub use warned::Warned;
