//! Comparison of the named materials with other measurements and samples of the same materials, from second pages of the
//! refractiveindex.info database, and with their own pages (`validation/films/materials_oracle.py` makes the tables).

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use papilio_scenario::Scenario;
use papilio_spectra::{material, material_names};
use papilio_validation::{run, state};

/// Rows of `pages.csv`: name, wavelength in nm, n and k of the page.
fn pages() -> impl Iterator<Item = (&'static str, f64, f64, f64)> {
    include_str!("../../films/pages.csv").lines().skip(1).map(|row| {
        let cells: Vec<&str> = row.split(',').collect();
        let [name, _, nm, n, k] = cells[..] else { panic!("{row}") };
        let number = |cell: &str| cell.parse::<f64>().unwrap();
        (name, number(nm), number(n), number(k))
    })
}

/// Pages print at least five digits of n and k. Each row is also compared by the transmittance of 1 um to 10 mm.
#[test]
fn materials_that_are_not_made_from_a_page_equal_their_page() {
    let mut names = std::collections::BTreeSet::new();
    for (name, nm, n, k) in pages() {
        let index = material(name).and_then(|material| material.index(nm)).unwrap();
        assert!((index.re - n).abs() <= 2e-4 * n.max(1.0), "{name} at {nm} nm: {index}, not {n} + {k}i");
        assert!((index.im - k).abs() <= 1e-6_f64.max(2e-4 * k), "{name} at {nm} nm: {index}, not {n} + {k}i");
        for micrometres in [1.0, 10.0, 1e3, 1e4] {
            let through = |k: f64| (-4.0 * PI * k * 1e3 * micrometres / nm).exp();
            assert!((through(index.im) - through(k)).abs() < 1e-3, "{micrometres} um of {name} at {nm} nm");
        }
        names.insert(name);
    }
    assert_eq!(names.len(), 17);
    // The others are constants, or are compared by `materials_oracle.py --check`.
    assert_eq!(material_names().len() - names.len(), 37 - 2 + 3);
}

/// Luminance factor along the normal of a Lambertian pixel of reflectance `rho` in contact with glass, in diffuse light: light that
/// enters, is absorbed along its way, and returns between pixel and face in all orders (F. C. Williams, F. R. Clapper, J. Opt. Soc. Am. 43,
/// 595 (1953), with absorption).
fn below_glass(rho: f64, n: f64, k: f64, thickness_nm: f64, nm: f64) -> f64 {
    let through = |theta: f64| (-4.0 * PI * k * thickness_nm / (nm * theta.cos())).exp();
    // Cosine-weighted mean over the directions in glass, in two parts: what total reflection returns has a kink.
    let mean = |f: &dyn Fn(f64) -> f64| {
        let critical = (1.0 / n).asin();
        let steps = 4000;
        let part = |from: f64, to: f64| {
            (0..steps)
                .map(|i| {
                    // Midpoints that are dense at the end, where Fresnel's formulas have a square root.
                    let u = 1.0 - (f64::from(i) + 0.5) / f64::from(steps);
                    let theta = to - (to - from) * u * u;
                    2.0 * (to - from) * u * f(theta) * (2.0 * theta).sin() / f64::from(steps)
                })
                .sum::<f64>()
        };
        part(0.0, critical) + part(critical, FRAC_PI_2)
    };
    let reflected = |theta: f64| fresnel(n, theta);
    let enters = mean(&|theta| (1.0 - reflected(theta)) * through(theta));
    let returns = mean(&|theta| reflected(theta) * through(theta).powi(2));
    reflected(0.0) + (1.0 - reflected(0.0)) * through(0.0) * rho * enters / (1.0 - rho * returns)
}

/// Reflectance of unpolarised light in glass at its face with air.
fn fresnel(n: f64, theta: f64) -> f64 {
    let beta = n * theta.sin();
    if beta >= 1.0 {
        return 1.0;
    }
    let (inside, outside) = (theta.cos(), (1.0 - beta * beta).sqrt());
    let s = (n * inside - outside) / (n * inside + outside);
    let p = (inside - n * outside) / (inside + n * outside);
    0.5 * (s * s + p * p)
}

/// Millimetres of window glass absorb what the pages say; 3 mm of soda-lime glass absorbed seven times as much.
#[test]
fn paper_below_millimetres_of_glass_equals_closed_form() {
    for (name, thickness_mm) in [("soda-lime", 3.0), ("soda-lime", 10.0), ("BK7", 10.0)] {
        let text = format!(
            "[display.glass]\nindex = \"{name}\"\nthickness_mm = {thickness_mm}\nsurface = \"fresnel\"\n\
             [display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = {{ white = 0.9 }}\n\
             [lighting]\ndiffuse = 1\nspectrum = \"E\"\n[spectrum]\nstep_nm = 10\n[viewer]\ntheta_deg = 0\n"
        );
        let resolved =
            Scenario::from_text(&text, "paper.toml", Path::new(""), &[]).unwrap().resolve().unwrap();
        let result = run(&resolved.scene).unwrap();
        let found = state(&result, "white").unwrap().value.reflectance_factor.as_ref().unwrap();
        let rows: Vec<_> = pages().filter(|row| row.0 == name).collect();
        assert_eq!(rows.len(), found.len());
        for ((_, nm, n, k), found) in rows.into_iter().zip(found) {
            let index = material(name).and_then(|material| material.index(nm)).unwrap();
            // The largest error that adding states here, relative.
            let own = below_glass(0.9, index.re, index.im, 1e6 * thickness_mm, nm);
            assert!(
                (found - own).abs() < 1e-4 * own,
                "{thickness_mm} mm of {name} at {nm} nm: {found}, not {own}"
            );
            // Thinning changes the transmittance of 10 mm by less than 0.001, and light passes the glass twice or more.
            let expected = below_glass(0.9, n, k, 1e6 * thickness_mm, nm);
            assert!(
                (found - expected).abs() < 5e-3,
                "{thickness_mm} mm of {name} at {nm} nm: {found}, not {expected}"
            );
        }
    }
}

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
