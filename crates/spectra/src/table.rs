//! The compiled-in tables of the CIE (`data/`).

use std::sync::LazyLock;

use crate::{SpectraError, Tabulated};

/// Columns of numbers with their wavelengths.
pub(crate) struct Table {
    nm: Vec<f64>,
    columns: Vec<(&'static str, Vec<f64>)>,
}

/// Tables at 1 nm: A, D50, D65 and the LED series.
static FINE: LazyLock<Table> = LazyLock::new(|| Table::read(include_str!("../data/illuminants-1nm.csv")));
/// Tables at 5 nm: all others except E, which has no table.
static COARSE: LazyLock<Table> = LazyLock::new(|| Table::read(include_str!("../data/illuminants-5nm.csv")));
/// S0, S1 and S2 of daylight, at 5 nm.
static DAYLIGHT: LazyLock<Table> = LazyLock::new(|| Table::read(include_str!("../data/daylight.csv")));

/// Returns the CIE illuminant of this name, or None if it is not tabulated.
pub(crate) fn illuminant(name: &str) -> Option<Result<Tabulated, SpectraError>> {
    [&FINE, &COARSE].into_iter().find_map(|table| {
        let values = table.column(name)?;
        Some(Tabulated::new(table.nm.clone(), values.to_vec()))
    })
}

/// S0, S1 and S2 every 5 nm from 380 to 780.
pub(crate) fn daylight_components() -> impl Iterator<Item = [f64; 3]> {
    let [s0, s1, s2] = ["S0", "S1", "S2"].map(|name| DAYLIGHT.column(name).unwrap_or_default());
    s0.iter().zip(s1).zip(s2).map(|((s0, s1), s2)| [*s0, *s1, *s2])
}

impl Table {
    /// Reads a header and rows of numbers. A cell that is not a number becomes NaN, which
    /// `Tabulated` refuses; a test reads every cell.
    fn read(csv: &'static str) -> Self {
        let mut lines = csv.lines();
        let names = lines.next().unwrap_or_default().split(',').skip(1);
        let mut table = Self { nm: vec![], columns: names.map(|name| (name, vec![])).collect() };
        for line in lines {
            let mut cells = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN));
            table.nm.extend(cells.next());
            for ((_, column), value) in table.columns.iter_mut().zip(cells) {
                column.push(value);
            }
        }
        table
    }

    fn column(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|(known, _)| *known == name).map(|(_, values)| &values[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_complete_and_have_only_known_names() {
        for (table, rows, step) in [(&FINE, 401, 1.0), (&COARSE, 81, 5.0), (&DAYLIGHT, 81, 5.0)] {
            assert_eq!(table.nm, (0..rows).map(|i| 380.0 + step * f64::from(i)).collect::<Vec<_>>());
            for (name, values) in &table.columns {
                assert_eq!(values.len(), rows as usize, "{name}");
                assert!(values.iter().all(|value| value.is_finite()), "{name}");
            }
        }
        let tabulated = FINE.columns.iter().chain(&COARSE.columns).map(|(name, _)| *name);
        assert!(tabulated.clone().all(|name| crate::illuminant_names().contains(&name)));
        // E is not tabulated.
        assert_eq!(tabulated.count() + 1, crate::illuminant_names().len());
    }
}
