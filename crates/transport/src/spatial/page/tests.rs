//! Pictures against the plain solution at every wavelength, and against closed forms.

use papilio_optics::interface::fresnel_reflectance;

use super::super::{FaceReturn, PixelSpread, Recycling};
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

/// A black stroke on bright paper under dense glass: what is seen of white, at most 1, and of black.
const BRIGHT: [f64; 2] = [0.95, 0.03];
const THICKNESS_MM: f64 = 0.5;

fn dense_face() -> FaceReturn {
    FaceReturn::new(1.7, THICKNESS_MM, 200.0, |beta| 1.0 - fresnel_reflectance(1.7, 1.0, beta)).tabulated()
}

/// What is seen of a page of these two states.
fn seen_of_bright(page: &Page<'_>, spread: Option<PixelSpread>, precision: Precision) -> (LitPage, Vec<f64>) {
    let face = dense_face();
    let reflectance = BRIGHT.map(|rho| vec![rho]).to_vec();
    let seen = BRIGHT.map(|rho| [(); 3].map(|()| vec![unit(&face) * rho])).to_vec();
    let light = PageLight { reflectance: &reflectance, seen: &seen };
    let lit = LitPage::with_spread(spread, page, (&|f| face.at(f), THICKNESS_MM), light, precision);
    let colours = lit.seen(page, light).iter().map(|colour| f64::from(colour[1])).collect();
    (lit, colours)
}

/// What is seen of a white page becomes 1.
fn unit(face: &FaceReturn) -> f64 {
    (1.0 - BRIGHT[0] * face.at(0.0)) / BRIGHT[0]
}

/// Light that leaves each of a row of cells, by elimination: `(1 - K A) B = K`, A from its transform by sums
/// of cosines, K the reflectances or `sqrt(rho) P sqrt(rho)`.
fn dense(rho: &[f64], period_mm: f64, inside: Option<&dyn Fn(f64) -> f64>) -> Vec<f64> {
    let (count, face) = (rho.len(), dense_face());
    let between = |transform: &dyn Fn(f64) -> f64| -> Vec<f64> {
        let bins: Vec<f64> = (0..count).map(|k| transform(k.min(count - k) as f64 / period_mm)).collect();
        let angle =
            |k: usize, step: usize| std::f64::consts::TAU * ((k * step) % count) as f64 / count as f64;
        let at = |step: usize| bins.iter().enumerate().map(|(k, a)| a * angle(k, step).cos()).sum::<f64>();
        (0..count).map(|step| at(step) / count as f64).collect()
    };
    let returned = between(&|f| face.at(f));
    let within = inside.map(between);
    let pattern = |i: usize, k: usize| match &within {
        Some(within) => (rho[i] * rho[k]).sqrt() * within[i.abs_diff(k)],
        None => f64::from(u8::from(i == k)) * rho[i],
    };
    let mut rows: Vec<Vec<f64>> = (0..count)
        .map(|i| {
            let pattern: Vec<f64> = (0..count).map(|k| pattern(i, k)).collect();
            let of = |j: usize| {
                let passed: f64 =
                    pattern.iter().enumerate().map(|(k, k_i)| k_i * returned[k.abs_diff(j)]).sum();
                f64::from(u8::from(i == j)) - passed
            };
            (0..count).map(of).chain([pattern.iter().sum()]).collect()
        })
        .collect();
    for k in 0..count {
        let (done, rest) = rows.split_at_mut(k + 1);
        for row in rest {
            let factor = row[k] / done[k][k];
            row.iter_mut().zip(&done[k]).skip(k).for_each(|(a, b)| *a -= factor * b);
        }
    }
    let mut light = vec![0.0; count];
    for k in (0..count).rev() {
        let known: f64 = (k + 1..count).map(|j| rows[k][j] * light[j]).sum();
        light[k] = (rows[k][count] - known) / rows[k][k];
    }
    light
}

fn stroke(pixel: usize) -> usize {
    usize::from((12..17).contains(&pixel))
}

/// White of 0.95 and n = 1.7: 0.72 of the light comes back, so that repetitions about the mean reflectance
/// would diverge in the stroke.
#[test]
fn stroke_on_bright_paper_equals_a_linear_solution() {
    let (count, pitch, parts) = (40, 0.1, 5);
    let states: Vec<u8> = (0..count).map(|k| stroke(k) as u8).collect();
    let page = Page { count: [count, 1], pitch_mm: [pitch; 2], states: &states };
    let rho: Vec<f64> = (0..count * parts).map(|k| BRIGHT[stroke(k / parts)]).collect();
    let light = dense(&rho, count as f64 * pitch, None);
    let unit = unit(&dense_face());
    // A fast picture's cells are a third of the thickness: in dense glass, near the edge, they miss a little
    // more than below glass of 1.5.
    for (precision, tolerance) in [(Precision::FAST, 1.5e-3), (Precision::FINE, 1e-4)] {
        let (lit, found) = seen_of_bright(&page, None, precision);
        assert!(lit.left() <= precision.change, "{}", lit.left());
        for (pixel, found) in found.iter().enumerate() {
            let expected = unit * light[pixel * parts..][..parts].iter().sum::<f64>() / parts as f64;
            assert!((found - expected).abs() < tolerance, "{precision:?} {pixel}: {found} {expected}");
        }
    }
    // Cells are the pixels.
    let (pitch, spread_mm) = (0.05, 0.06);
    let page = Page { count: [count, 1], pitch_mm: [pitch; 2], states: &states };
    let rho: Vec<f64> = (0..count).map(|k| BRIGHT[stroke(k)]).collect();
    let spread = PixelSpread::new(spread_mm).unwrap();
    let period_mm = count as f64 * pitch;
    let factors = spread.between([count, 1], [period_mm, pitch]);
    let light = dense(&rho, period_mm, Some(&|f| factors[(f * period_mm).round() as usize]));
    let (_, found) = seen_of_bright(&page, Some(spread), Precision::FINE);
    for (pixel, found) in found.iter().enumerate() {
        let expected = unit * light[pixel];
        assert!((found - expected).abs() < 3e-5, "spread, {pixel}: {found} {expected}");
    }
}

/// The same in a plane, against plain repetitions, from none to all black.
#[test]
fn strokes_on_bright_paper_equal_plain_repetitions() {
    let (count, pitch) = ([24, 20], 0.1);
    let unit = unit(&dense_face());
    for black in papilio_testing::everyday(1, [6, 1, 23]) {
        let states: Vec<u8> =
            (0..count[0] * count[1]).map(|k| u8::from(k % count[0] < black && k / count[0] > 3)).collect();
        let page = Page { count, pitch_mm: [pitch; 2], states: &states };
        for (spread, parts) in [(None, 5), (PixelSpread::new(0.04), 1)] {
            let cells = Cells {
                count: count.map(|count| count * parts),
                period_mm: count.map(|count| count as f64 * pitch),
            };
            let pixel =
                |cell: usize| cell / cells.count[0] / parts * count[0] + cell % cells.count[0] / parts;
            let rho: Vec<f64> =
                (0..cells.len()).map(|cell| BRIGHT[usize::from(states[pixel(cell)])]).collect();
            let face = dense_face();
            let irradiance = Recycling::new(cells, |f| face.at(f)).with_spread(spread).irradiance(&rho, 1e-8);
            let mut expected = vec![0.0; states.len()];
            for (cell, (rho, e)) in rho.iter().zip(irradiance).enumerate() {
                expected[pixel(cell)] += unit * rho * e / (parts * parts) as f64;
            }
            let precision = if spread.is_some() { Precision::FAST } else { Precision::FINE };
            let (lit, found) = seen_of_bright(&page, spread, precision);
            assert!(lit.left() <= precision.change, "{}", lit.left());
            let worst = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < if spread.is_some() { 1e-3 } else { 2e-4 }, "{black} {spread:?}: {worst}");
        }
    }
}
