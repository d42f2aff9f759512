//! The materials of the program: what each is, its source and its range; those of the refractiveindex.info
//! database.
//!
//! `data/materials.txt` has a block for each material: lines that begin with `=` (name), `what`, `page` and
//! `source`, then its data as in the page, with wavelengths in um: `formula NUMBER FIRST LAST` and a line of
//! coefficients, or `nk`, `n` or `k` and rows of a table. `validation/films/materials_oracle.py` makes the
//! file from the database.

use std::sync::LazyLock;

use crate::{Dispersion, SpectraError, Tabulated};

/// Range in which every named material may be used, nm, if its data end within this range: a formula is
/// continued, and a table keeps its last value. The part of V(lambda) beyond the data of any material is
/// below 1e-3.
const VISIBLE_NM: (f64, f64) = (380.0, 780.0);

/// A named material, without its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialInfo {
    /// Name in scenarios.
    pub name: &'static str,
    /// The substance and the sample: "titanium dioxide, film of 350 nm".
    pub what: &'static str,
    /// Authors and publication.
    pub source: &'static str,
    /// Page of the refractiveindex.info database (shelf/book/page; several are separated by "; "), which is
    /// in the public domain (CC0 1.0); `None` for constants and models from publications.
    pub page: Option<&'static str>,
    /// First and last wavelength of the data, nm; (0, infinity) for a constant.
    pub measured_nm: (f64, f64),
    /// First and last wavelength that may be used, nm: those of the data, or of the visible range if the data
    /// end within it.
    pub range_nm: (f64, f64),
}

impl MaterialInfo {
    /// Returns the part of a range in which there are no data, in words; `None` if the data cover it.
    pub fn beyond_data(&self, (first, last): (f64, f64)) -> Option<String> {
        let (from, to) = self.measured_nm;
        let below = (first < from).then(|| format!("below {from} nm"));
        let above = (last > to).then(|| format!("above {to} nm"));
        let parts: Vec<String> = below.into_iter().chain(above).collect();
        (!parts.is_empty()).then(|| parts.join(" and "))
    }
}

/// A material of the file.
struct Block {
    name: &'static str,
    what: &'static str,
    page: &'static str,
    source: &'static str,
    data: Vec<&'static str>,
}

static BLOCKS: LazyLock<Vec<Block>> = LazyLock::new(|| {
    let blocks = include_str!("../data/materials.txt").split("= ").skip(1);
    blocks.map(block).collect()
});

fn block(text: &'static str) -> Block {
    let mut lines = text.lines();
    let mut next = |key: &str| {
        let line = lines.next().unwrap_or_default();
        line.strip_prefix(key).unwrap_or(line).trim()
    };
    let (name, what, page, source) = (next(""), next("what "), next("page "), next("source "));
    Block { name, what, page, source, data: lines.collect() }
}

/// Names of the materials of the database, in the order of the file.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    BLOCKS.iter().map(|block| block.name)
}

/// Returns a material of the database; `None` if it has no such name.
pub(crate) fn material(name: &str) -> Option<Result<Dispersion, SpectraError>> {
    let block = BLOCKS.iter().find(|block| block.name == name)?;
    Some(block.dispersion().map(|dispersion| dispersion.continued(VISIBLE_NM)))
}

/// Describes a material of the database; `None` if it has no such name.
pub(crate) fn info(name: &str) -> Option<MaterialInfo> {
    let block = BLOCKS.iter().find(|block| block.name == name)?;
    let dispersion = block.dispersion().ok()?;
    let measured_nm = dispersion.range_nm();
    Some(MaterialInfo {
        name: block.name,
        what: block.what,
        source: block.source,
        page: Some(block.page),
        measured_nm,
        range_nm: dispersion.continued(VISIBLE_NM).range_nm(),
    })
}

/// Rows of numbers after a line that names them.
struct Section {
    kind: &'static str,
    rows: Vec<Vec<f64>>,
}

impl Block {
    fn sections(&self) -> Vec<Section> {
        let mut sections: Vec<Section> = Vec::new();
        for &line in &self.data {
            match sections.last_mut() {
                Some(section) if !line.starts_with(char::is_alphabetic) => {
                    // A number that cannot be read becomes NaN, which all models refuse; a test reads every
                    // one.
                    section.rows.push(line.split(' ').map(|n| n.parse().unwrap_or(f64::NAN)).collect());
                }
                _ => sections.push(Section { kind: line, rows: Vec::new() }),
            }
        }
        sections
    }

    fn dispersion(&self) -> Result<Dispersion, SpectraError> {
        let sections = self.sections();
        let table = |kind: &str, column: usize| {
            let section = sections.iter().find(|section| section.kind == kind)?;
            let nm = section.rows.iter().map(|row| 1e3 * row[0]).collect();
            let value = section.rows.iter().map(|row| row.get(column).copied().unwrap_or(f64::NAN)).collect();
            Some(Tabulated::new(nm, value))
        };
        let k = table("k", 1).or_else(|| table("nk", 2)).transpose()?;
        if let Some(n) = table("n", 1).or_else(|| table("nk", 1)) {
            return Dispersion::tabulated(n?, k);
        }
        let formula = sections.first().filter(|section| section.kind.starts_with("formula"));
        let mut words = formula.map_or("", |section| section.kind).split(' ').skip(1);
        let mut number = || words.next().and_then(|word| word.parse::<f64>().ok()).unwrap_or(f64::NAN);
        let (kind, first, last) = (number() as u8, 1e3 * number(), 1e3 * number());
        let coefficients = formula.and_then(|section| section.rows.first()).map_or(&[][..], |row| &row[..]);
        Dispersion::formula(kind, coefficients, (first, last), k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_material_of_the_database_can_be_read_and_has_a_source() {
        assert_eq!(BLOCKS.len(), 35);
        for block in BLOCKS.iter() {
            let info = info(block.name).unwrap_or_else(|| panic!("{}", block.name));
            assert!(!info.what.is_empty() && info.source.ends_with(')'), "{info:?}");
            assert!(info.page.is_some_and(|page| page.contains('/')), "{info:?}");
            let numbers = block.sections().iter().map(|section| section.rows.len()).sum::<usize>();
            assert!(
                numbers >= 1
                    && block.sections().iter().all(|s| s.rows.iter().flatten().all(|n| n.is_finite()))
            );
        }
    }

    #[test]
    fn data_that_end_in_the_visible_range_are_continued() {
        let pmma = info("PMMA").unwrap();
        assert_eq!((pmma.measured_nm, pmma.range_nm), ((436.8, 1052.0), (380.0, 1052.0)));
        assert_eq!(pmma.beyond_data((380.0, 780.0)).as_deref(), Some("below 436.8 nm"));
        assert_eq!(pmma.beyond_data((440.0, 780.0)), None);
        // Exactly the data, and a little more at either end.
        let (from, to) = pmma.measured_nm;
        assert_eq!(pmma.beyond_data((from, to)), None);
        assert_eq!(pmma.beyond_data((from, to + 1.0)), Some(format!("above {to} nm")));
        let both = pmma.beyond_data((from - 1.0, to + 1.0));
        assert_eq!(both, Some(format!("below {from} nm and above {to} nm")));
        let n = |name: &str, nm: f64| material(name).unwrap().unwrap().index(nm);
        // The formula goes on; a table keeps its value.
        assert!(n("PMMA", 380.0).unwrap().re > n("PMMA", 437.0).unwrap().re);
        assert_eq!(n("PET", 380.0), n("PET", 400.0));
        assert!(n("PMMA", 379.0).is_err() && n("PMMA", 1053.0).is_err());
        assert_eq!(info("TiO2").unwrap().beyond_data((380.0, 780.0)), None);
    }
}
