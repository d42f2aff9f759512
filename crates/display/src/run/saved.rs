//! Rows of a long computation that are saved as soon as they are computed, so that it can be resumed.
//!
//! A row is identified by its number and by its level of discretisation. A saved row has the bits of a
//! computed one.

/// Rows of one computation, in the memory of its caller.
pub trait SavedRows: Sync {
    /// Returns a row that an earlier computation of the same scene has saved. Each row is asked for once.
    fn find(&self, row: usize) -> Option<Vec<f64>>;

    /// Saves a row, or not: what is not saved is computed again.
    fn save(&self, row: usize, numbers: &[f64]);
}

/// Saves nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unsaved;

impl SavedRows for Unsaved {
    fn find(&self, _row: usize) -> Option<Vec<f64>> {
        None
    }

    fn save(&self, _row: usize, _numbers: &[f64]) {}
}

/// Kinds of rows, which have numbers of their own.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    /// The sample that determines the level.
    Sample,
    /// A part of the table or map.
    Row,
}

/// The number under which a row is saved.
pub(super) fn row_number(kind: Kind, level: usize, row: usize) -> usize {
    const LEVELS: usize = papilio_transport::adding::FINEST as usize + 1;
    2 * (row * LEVELS + level) + matches!(kind, Kind::Row) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_all_levels_and_kinds_have_different_numbers() {
        let levels = 0..=papilio_transport::adding::FINEST as usize;
        let of =
            |level: usize| (0..9).flat_map(move |row| [(Kind::Sample, level, row), (Kind::Row, level, row)]);
        let mut all: Vec<usize> =
            levels.flat_map(of).map(|(kind, level, row)| row_number(kind, level, row)).collect();
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}
