//! Comparison of the named materials with other measurements and samples of the same materials, from second pages of the
//! refractiveindex.info database (`validation/films/materials_oracle.py` makes the table).

use papilio_spectra::{material, material_names};

/// Differences are those between samples and measurements: 0.003 in n for polymers and bulk glasses, 0.01 to 0.1 for
/// deposited oxides, more for metals and semiconductors.
#[test]
fn materials_agree_with_a_second_source() {
    let table = include_str!("../../films/materials.csv");
    let mut names = std::collections::BTreeSet::new();
    for row in table.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let [name, _, nm, n, k, difference_n, difference_k] = cells[..] else { panic!("{row}") };
        let number = |cell: &str| cell.parse::<f64>().unwrap();
        let index = material(name).and_then(|material| material.index(number(nm))).unwrap();
        assert!((index.re - number(n)).abs() <= number(difference_n), "{row}: {index}");
        if !k.is_empty() && !difference_k.is_empty() {
            assert!((index.im - number(k)).abs() <= number(difference_k), "{row}: {index}");
        }
        names.insert(name);
    }
    assert_eq!(names.len(), 24);
    assert!(names.iter().all(|name| material_names().contains(name)));
}

/// Handbook values at the sodium line, 589.3 nm: fused silica 1.4585, water 1.3330 (20 C), PMMA 1.491, polycarbonate 1.585,
/// soda-lime glass 1.52, poly(ethylene terephthalate), amorphous, 1.575 (CRC Handbook of Chemistry and Physics; Polymer Handbook).
#[test]
fn transparent_materials_have_their_handbook_index() {
    for (name, n, tolerance) in [
        ("SiO2", 1.4585, 2e-4),
        ("H2O", 1.3330, 5e-4),
        ("PMMA", 1.491, 2e-3),
        ("PC", 1.585, 2e-3),
        ("soda-lime", 1.52, 5e-3),
        ("PET", 1.575, 1e-2),
        ("OCA", 1.47, 1e-12),
    ] {
        let found = material(name).and_then(|material| material.index(589.3)).unwrap();
        assert!((found.re - n).abs() < tolerance, "{name}: {found}");
    }
}
