//! What is wrong with a text of the user's, where, and what to do.
//!
//! - [`Place`]: a file (or an option of the command line), and in it line, column and the text of the line.
//! - [`Diagnostic`]: message, what was expected, a note, a hint. It is written where the mistake is found;
//!   `diagnostic.at(&place)` prints it as compilers do.
//! - [`nearest`] and [`suggestion`]: the name that was probably meant.
//! - [`visible`]: a text without characters that a terminal would obey.
//! - [`Warned`]: a value with the warnings that came with it.
//!
//! **Out of scope**: which mistakes there are. A crate that finds mistakes says which of them code has to tell apart.

mod diagnostic;
mod nearest;
mod place;
mod text;
mod warned;

pub use diagnostic::{Diagnostic, Placed};
pub use nearest::{nearest, quoted, suggestion};
pub use place::{Place, Spot};
pub use text::{in_one_line, is_override, visible};
pub use warned::Warned;
