//! A value with its warnings.

/// A value and the warnings about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Warned<T> {
    /// The value.
    pub value: T,
    /// Complete sentences without a full stop.
    pub warnings: Vec<String>,
}
