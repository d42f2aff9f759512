//! Pictures against the plain solution at every wavelength, and against closed forms.

use papilio_optics::interface::fresnel_reflectance;

use super::super::{FaceReturn, Recycling};
use super::*;

const BINS: usize = 13;
const PITCH_MM: [f64; 2] = [0.085, 0.1];

/// Six states with smooth spectra, from dark to white, and what is seen of them in three colours.
fn spectra() -> (Vec<Vec<f64>>, Vec<[Vec<f64>; 3]>) {
    let reflectance = |state: usize| -> Vec<f64> {
        let bell = |bin: usize, middle: f64| (-(bin as f64 - middle).powi(2) / 12.0).exp();
        let of = |bin: usize| match state {
            0 => 0.03,
            1 => 0.6,
            _ => 0.05 + 0.5 * bell(bin, 3.0 * (state - 1) as f64),
        };
        (0..BINS).map(of).collect()
    };
    let all: Vec<Vec<f64>> = (0..6).map(reflectance).collect();
    let weight = |colour: usize, bin: usize| {
        0.387_5 / 5.0 * (-(bin as f64 - 3.0 * (3 - colour) as f64).powi(2) / 10.0).exp()
    };
    let seen = all.iter().map(|rho| {
        [0, 1, 2].map(|colour| rho.iter().enumerate().map(|(bin, rho)| weight(colour, bin) * rho).collect())
    });
    let seen = seen.collect();
    (all, seen)
}

fn face(thickness_mm: f64, most_per_mm: f64) -> FaceReturn {
    FaceReturn::new(1.5, thickness_mm, most_per_mm, |beta| 1.0 - fresnel_reflectance(1.5, 1.0, beta))
        .tabulated()
}

fn colours(
    page: &Page<'_>,
    precision: Precision,
    (face, thickness_mm): (&FaceReturn, f64),
) -> (LitPage, Vec<[f32; 3]>) {
    let (reflectance, seen) = spectra();
    let light = PageLight { reflectance: &reflectance, seen: &seen };
    let lit = LitPage::new(page, &|f| face.at(f), light, precision, thickness_mm);
    let colours = lit.seen(page, light);
    (lit, colours)
}

/// A picture with states in blocks of different sizes.
fn states([columns, rows]: [usize; 2]) -> Vec<u8> {
    let state = |x: usize, y: usize| ((x / 3 * 7 + y / 2 * 5 + x * y / 11) % 6) as u8;
    (0..rows).flat_map(|y| (0..columns).map(move |x| state(x, y))).collect()
}

/// The means of pixels by the plain solution with many cells in a pixel, at every wavelength.
#[test]
fn picture_equals_the_plain_solution_at_every_wavelength() {
    let (count, parts) = ([24, 20], 5);
    let states = states(count);
    let page = Page { count, pitch_mm: PITCH_MM, states: &states };
    let (reflectance, seen) = spectra();
    for thickness_mm in [0.2, 0.5] {
        let period_mm = [0, 1].map(|k| count[k] as f64 * PITCH_MM[k]);
        let cells = Cells { count: count.map(|count| count * parts), period_mm };
        let face = face(thickness_mm, cells.most_per_mm());
        let recycling = Recycling::new(cells, |f| face.at(f));
        let mut expected = vec![[0.0; 3]; states.len()];
        for bin in 0..BINS {
            let pixel =
                |cell: usize| cell / cells.count[0] / parts * count[0] + cell % cells.count[0] / parts;
            let rho: Vec<f64> =
                (0..cells.len()).map(|cell| reflectance[usize::from(states[pixel(cell)])][bin]).collect();
            for (cell, e) in recycling.irradiance(&rho, 1e-9).into_iter().enumerate() {
                let at = pixel(cell);
                for (sum, seen) in expected[at].iter_mut().zip(&seen[usize::from(states[at])]) {
                    *sum += seen[bin] * e / (parts * parts) as f64;
                }
            }
        }
        let fine = self::face(thickness_mm, 100.0);
        for (precision, tolerance) in [(Precision::FAST, 1e-3), (Precision::FINE, 1e-4)] {
            let (lit, found) = colours(&page, precision, (&fine, thickness_mm));
            let pairs = found.iter().flatten().zip(expected.iter().flatten());
            let worst =
                pairs.map(|(found, expected)| (f64::from(*found) - expected).abs()).fold(0.0, f64::max);
            assert!(
                worst < tolerance,
                "{thickness_mm} mm, {precision:?}: {worst} with {} wavelengths",
                lit.wavelengths()
            );
            // Six smooth spectra need fewer wavelengths than there are.
            assert!(precision == Precision::FINE || lit.wavelengths() <= 7, "{}", lit.wavelengths());
        }
    }
}

/// A page of one state: 1/(1 - rho A(0)) at each wavelength.
#[test]
fn uniform_page_has_its_closed_form() {
    let (reflectance, seen) = spectra();
    let face = face(0.5, 100.0);
    for state in 0..6_u8 {
        let states = vec![state; 12];
        let page = Page { count: [4, 3], pitch_mm: PITCH_MM, states: &states };
        let (_, found) = colours(&page, Precision::FINE, (&face, 0.5));
        for (colour, seen) in seen[usize::from(state)].iter().enumerate() {
            let light = seen.iter().zip(&reflectance[usize::from(state)]);
            let expected: f64 = light.map(|(seen, rho)| seen / (1.0 - 0.596_346 * rho)).sum();
            assert!(
                found.iter().all(|one| (f64::from(one[colour]) - expected).abs() < 3e-6),
                "{expected} {found:?}"
            );
        }
    }
}

/// Stripes of 0.6 and 0.03: the mean over a period, by a dense Fourier solution of a separate program.
#[test]
fn stripes_have_the_mean_of_a_dense_solution() {
    let (thickness_mm, pixels) = (1.0, 200);
    let reflectance = vec![vec![0.6], vec![0.03]];
    let seen = [0.6, 0.03].map(|rho| [(); 3].map(|()| vec![0.387_508 * rho]));
    let light = PageLight { reflectance: &reflectance, seen: &seen };
    let face = face(thickness_mm, 100.0);
    for (period, expected) in [(5.0, 0.148_12), (10.0, 0.155_94), (20.0, 0.167_10)] {
        let states: Vec<u8> = (0..pixels).map(|k| u8::from(2 * k >= pixels)).collect();
        let pitch = period / pixels as f64;
        let page = Page { count: [pixels, 1], pitch_mm: [pitch; 2], states: &states };
        let precision = Precision { cell: 0.03, ..Precision::FINE };
        let lit = LitPage::new(&page, &|f| face.at(f), light, precision, thickness_mm);
        assert_eq!(lit.wavelengths(), 1);
        let found = lit.seen(&page, light);
        let mean = found.iter().map(|one| f64::from(one[1])).sum::<f64>() / pixels as f64;
        assert!((mean - expected).abs() < 5e-5, "{period}: {mean} {expected}");
    }
}
