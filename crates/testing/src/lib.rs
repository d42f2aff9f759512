//! What tests share: statistics whose bounds are known, and random choices. For development only.
//!
//! Statistical tests draw the same numbers every time: they either pass always or fail always, until the code or the bound
//! changes. Bounds are set so that a correct program fails one test of this repository in some thousand changes.

mod dice;
mod laws;

pub use dice::Dice;
pub use laws::laws;
