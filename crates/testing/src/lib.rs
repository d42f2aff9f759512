//! Shared test tools: statistics with known bounds, and random cases. For development only.
//!
//! Statistical tests draw the same numbers every time: they pass always or fail always, until the code or the
//! bound changes. With these bounds, a correct program fails one test of this repository in some thousand
//! changes.

mod campaign;
mod chi_square;
mod dice;
mod laws;
mod scores;
mod seeds;

pub use campaign::{Campaign, CaseRow, each};
pub use chi_square::ChiSquare;
pub use dice::Dice;
pub use laws::laws;
pub use scores::{Bounds, assert_student, mean_and_error, mean_square_bounds};
pub use seeds::{assert_unbiased, assert_unbiased_over, everyday, seeds, sized};
