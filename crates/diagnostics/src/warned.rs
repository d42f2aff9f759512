//! A value with its warnings.

/// A value, and what its user should know about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Warned<T> {
    /// The value.
    pub value: T,
    /// Whole sentences without a final stop.
    pub warnings: Vec<String>,
}
