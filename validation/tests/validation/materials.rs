//! Comparison of the named materials with the pages of their sources, and with other measurements and samples
//! of the same materials, from the refractiveindex.info database (`validation/films/materials_oracle.py`
//! makes the tables).

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_PI_4, PI};

use papilio_spectra::{Grid, illuminant, material, material_names};
use papilio_validation::{run, scenario};

/// n and k of each material in its source, by wavelength in nm.
fn source_pages() -> BTreeMap<&'static str, Vec<[f64; 3]>> {
    let mut found = BTreeMap::<&str, Vec<[f64; 3]>>::new();
    for row in include_str!("../../films/source-pages.csv").lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let [name, _, numbers @ ..] = &cells[..] else { panic!("{row}") };
        let numbers: Vec<f64> = numbers.iter().map(|cell| cell.parse().unwrap()).collect();
        found.entry(name).or_default().push(numbers.try_into().unwrap());
    }
    found
}

/// Transmittance of 1 um to 10 mm and reflectance at normal incidence of every named material, against the
/// page of its source: tables that are thinned or written here, formulas and models.
#[test]
fn all_materials_transmit_and_reflect_as_their_source() {
    let pages = source_pages();
    let mut found: BTreeSet<&str> = pages.keys().copied().collect();
    for (name, rows) in pages {
        let material = material(name).unwrap();
        for [nm, n, k] in rows {
            let index = material.index(nm).unwrap();
            let reflectance = |n: f64, k: f64| ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
            let off = reflectance(index.re, index.im) - reflectance(n, k);
            assert!(off.abs() < 1e-3, "{name}, {nm} nm: {index}, in the source {n} + {k}i");
            for thickness_nm in [1e3, 1e4, 1e6, 1e7] {
                let through = |k: f64| (-4.0 * PI * k * thickness_nm / nm).exp();
                let off = through(index.im) - through(k);
                assert!(off.abs() < 1e-3, "{name}, {nm} nm, {thickness_nm} nm: {index}, in the source {k}");
            }
        }
    }
    // Constants have no page.
    found.extend(["air", "AlOx", "OCA"]);
    assert_eq!(found, material_names().iter().copied().collect());
    assert_eq!(found.len(), 55);
}

/// Reflectance of an interface from index `n` in a beam at the sine `beta` / `n`, to index `other`;
/// unpolarised.
fn fresnel(n: f64, other: f64, beta: f64) -> f64 {
    if beta >= other {
        return 1.0;
    }
    let [a, b] = [n, other].map(|n| (n * n - beta * beta).sqrt());
    let s = (a - b) / (a + b);
    let p = (other * other * a - n * n * b) / (other * other * a + n * n * b);
    0.5 * (s * s + p * p)
}

/// A paper of reflectance 0.8 below 3 mm of window glass, in light from 45 deg, seen along the normal: the
/// light that enters, absorbed along its path, times the paper's reflectance with what the glass returns to
/// it (Saunderson), times what leaves. n and k are those of the source (Rubin 1985).
#[test]
fn paper_under_window_glass_has_the_luminance_of_its_source() {
    let rows = source_pages().remove("soda-lime").unwrap();
    let grid = Grid::new(380.0, 780.0, 20.0).unwrap();
    let (light, observer) =
        (illuminant("D65", &grid).unwrap(), papilio_colour::Observer::new(&grid).unwrap());
    let (mut expected, mut white) = (0.0, 0.0);
    for (bin, [nm, n, k]) in rows.into_iter().enumerate() {
        let through = |beta: f64| (-4.0 * PI * k * 3e6 / nm / (1.0 - (beta / n).powi(2)).sqrt()).exp();
        let steps = 4000;
        // The mean over the paper's light: equal parts of the squared sine.
        let returned = |step: i32| {
            let beta = n * ((f64::from(step) + 0.5) / f64::from(steps)).sqrt();
            fresnel(n, 1.0, beta) * through(beta).powi(2)
        };
        let inside = (0..steps).map(returned).sum::<f64>() / f64::from(steps);
        let beta = FRAC_PI_4.sin();
        let [enters, leaves] = [beta, 0.0].map(|beta| (1.0 - fresnel(1.0, n, beta)) * through(beta));
        let factor = enters * 0.8 / (1.0 - 0.8 * inside) * leaves / (n * n);
        let weight = light[bin] * observer.weights()[1][bin];
        expected += weight * factor;
        white += weight;
    }
    expected /= white;
    let scene = scenario(
        "epaper",
        &[
            "display.glass.index=soda-lime",
            "display.glass.thickness_mm=3",
            "display.pixel.reflectance.white=0.8",
            "lighting.diffuse=0",
            "lighting.directed=[{theta_deg=-45,share=1}]",
            "viewer.theta_deg=0",
            "spectrum.step_nm=20",
        ],
    );
    let result = run(&scene.unwrap().scene).unwrap();
    let found = result.views[0].states.get("white").unwrap().value.Y;
    assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
    // A table of k that was too coarse by 1e-6 gave 0.43.
    assert!(found > 0.53, "{found}");
}

/// Differences are those between samples and measurements: 0.003 in n for polymers and bulk glasses, 0.01 to
/// 0.1 for deposited oxides, more for metals and semiconductors.
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

/// Handbook values at the sodium line, 589.3 nm: fused silica 1.4585, water 1.3330 (20 C), PMMA 1.491,
/// polycarbonate 1.585, soda-lime glass 1.52, poly(ethylene terephthalate), amorphous, 1.575 (CRC Handbook of
/// Chemistry and Physics; Polymer Handbook).
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
