//! Films equal PyPI `tmm` 0.2.0 (S. J. Byrnes, arXiv:1603.02720): the committed table of
//! `validation/films/tmm_oracle.py`, by both implementations.

use num_complex::Complex64;
use papilio_optics::film::{
    Coherent, Film, GapFilm, Layer, Polarisation, SimdLevel, SpectralLayer, Thickness, absorbed, coherent,
};

const TABLE: &str = include_str!("../../../../validation/films/tmm.csv");
const TOLERANCE: f64 = 1e-10;

/// One row of the table.
struct Row {
    wavelength_nm: f64,
    beta: f64,
    film: Film,
    /// s, then p.
    expected: [Expected; 2],
}

struct Expected {
    r: Complex64,
    t: Complex64,
    reflectance: f64,
    transmittance: f64,
    absorptance: Vec<f64>,
}

fn number(text: &str) -> f64 {
    text.parse().unwrap()
}

fn row(line: &str) -> Row {
    let cells: Vec<&str> = line.split(',').collect();
    let n = |i: usize| number(cells[i]);
    let layer = |text: &str| {
        let parts: Vec<f64> = text.split(':').map(number).collect();
        Layer { index: Complex64::new(parts[0], parts[1]), thickness_nm: parts[2] }
    };
    let expected = |i: usize| Expected {
        r: Complex64::new(n(8 + 2 * i), n(9 + 2 * i)),
        t: Complex64::new(n(12 + 2 * i), n(13 + 2 * i)),
        reflectance: n(16 + i),
        transmittance: n(18 + i),
        absorptance: cells[20 + i].split_whitespace().map(number).collect(),
    };
    Row {
        wavelength_nm: n(1),
        beta: n(3),
        film: Film {
            incidence: n(4),
            layers: cells[7].split_whitespace().map(layer).collect(),
            substrate: Complex64::new(n(5), n(6)),
        },
        expected: [expected(0), expected(1)],
    }
}

fn rows() -> impl Iterator<Item = Row> {
    TABLE.lines().skip(1).map(row)
}

fn differences(found: &Coherent, expected: &Expected) -> Vec<f64> {
    assert_eq!(found.absorptance.len(), expected.absorptance.len());
    let absorbed = found.absorptance.iter().zip(&expected.absorptance).map(|(a, b)| (a - b).abs());
    let mut all: Vec<f64> = absorbed.collect();
    all.push((found.r - expected.r).norm());
    all.push((found.t - expected.t).norm());
    all.push((found.reflectance - expected.reflectance).abs());
    all.push((found.transmittance - expected.transmittance).abs());
    all
}

#[test]
fn amplitudes_and_powers_equal_tmm() {
    let mut films = 0;
    for (i, row) in rows().enumerate() {
        for (polarisation, expected) in [Polarisation::S, Polarisation::P].into_iter().zip(&row.expected) {
            let found = coherent(&row.film, row.wavelength_nm, row.beta, polarisation).unwrap();
            let worst = differences(&found, expected).into_iter().fold(0.0, f64::max);
            assert!(worst < TOLERANCE, "row {}, {polarisation:?}: {worst:e}", i + 2);
        }
        films += 1;
    }
    assert_eq!(films, 500);
}

/// `absorp_in_each_layer` of tmm, mean of s and p; the substrate has what is transmitted into it.
#[test]
fn absorptance_of_each_layer_equals_tmm() {
    for (i, row) in rows().enumerate() {
        let found = absorbed(&row.film, row.wavelength_nm, row.beta).unwrap();
        let [s, p] = &row.expected;
        let layers = s.absorptance.iter().zip(&p.absorptance).map(|(s, p)| 0.5 * (s + p));
        let theirs = layers.chain([0.5 * (s.transmittance + p.transmittance)]);
        for (ours, theirs) in found.layers.iter().chain([&found.substrate]).zip(theirs) {
            assert!((ours - theirs).abs() < TOLERANCE, "row {}: {ours} {theirs}", i + 2);
        }
    }
}

#[test]
fn fast_implementation_equals_tmm_for_every_gap_layer() {
    for (i, row) in rows().enumerate() {
        let mean = 0.5 * (row.expected[0].reflectance + row.expected[1].reflectance);
        for gap in 0..row.film.layers.len().max(1) {
            let layer = |(j, layer): (usize, &Layer)| SpectralLayer {
                index: vec![layer.index],
                thickness: if j == gap { Thickness::Gap } else { Thickness::Fixed(layer.thickness_nm) },
            };
            let layers: Vec<SpectralLayer> = row.film.layers.iter().enumerate().map(layer).collect();
            let gap_nm = row.film.layers.get(gap).map_or(0.0, |layer| layer.thickness_nm);
            let (wavelength, incidence) = ([row.wavelength_nm], [row.film.incidence]);
            let film = GapFilm::new(&wavelength, &incidence, &layers, &[row.film.substrate]).unwrap();
            for level in SimdLevel::available() {
                let mut found = [f64::NAN];
                film.clone().with_simd_level(level).reflectance(&[row.beta], &[gap_nm], &mut found).unwrap();
                let error = (found[0] - mean).abs();
                assert!(error < TOLERANCE, "row {}, gap {gap}, {level:?}: {error:e}", i + 2);
            }
        }
    }
}
