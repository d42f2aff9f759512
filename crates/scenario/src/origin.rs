//! Where in the texts of a scenario something stands.

/// A stretch of one of the scenario's [`Sources`](crate::source::Sources), in bytes; an empty one means all of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Origin {
    pub(crate) source: usize,
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl Origin {
    /// The scenario file as a whole.
    pub(crate) const FILE: Self = Self { source: 0, start: 0, end: 0 };

    /// This place, or that of the last `--set` among the other values that have a part in
    /// an error: a file that was right before is not what is wrong.
    pub(crate) fn or_set(self, others: impl IntoIterator<Item = Self>) -> Self {
        others.into_iter().fold(self, |at, other| if other.source > at.source { other } else { at })
    }
}
