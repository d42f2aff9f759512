//! Places in the texts of a scenario.

/// A range of one of the scenario's [`Sources`](crate::source::Sources), in bytes; an empty range means the
/// whole text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Origin {
    pub(crate) source: usize,
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl Origin {
    /// The scenario file as a whole.
    pub(crate) const FILE: Self = Self { source: 0, start: 0, end: 0 };

    /// Returns this place, or that of the last `--set` among the other values that are involved in
    /// an error: if the file alone is valid, the `--set` is the cause.
    pub(crate) fn or_override(self, others: impl IntoIterator<Item = Self>) -> Self {
        others.into_iter().fold(self, |at, other| if other.source > at.source { other } else { at })
    }
}
