//! What tests share: statistics whose bounds are known, and random choices. For development only.
//!
//! Statistical tests draw the same numbers every time: they either pass always or fail always, until the code or the bound
//! changes. Bounds are set so that a correct program fails one test of this repository in some thousand changes.

mod chi_square;
mod dice;
mod laws;
mod scores;
mod seeds;

pub use chi_square::ChiSquare;
pub use dice::Dice;
pub use laws::laws;
pub use scores::{Bounds, assert_student, mean_and_error, mean_square_bounds};
pub use seeds::{assert_unbiased, seeds};
