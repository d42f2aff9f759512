//! Rays through random faces compared with Fresnel waves through the same faces.
//!
//! By reciprocity, the light that an eye receives from the pixel plane through a spot of the face, of
//! amplitude A, is that which a wave from the eye sends there: `Q(u) = |Fresnel(A exp(i k (n - 1) h))|²` over
//! the reduced distance d/n; with rays it is `|A|²` at `u = x + K m(x)`.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_fourier::Plane;
use papilio_optics::RandomFace;
use papilio_sampling::{SampleStream, Sampler};
use papilio_sparkle::FaceSampler;
use papilio_transport::spatial::Cells;

const COUNT: usize = 256;
const PERIOD_MM: f64 = 0.512;
const CELL_MM: f64 = PERIOD_MM / COUNT as f64;
const INDEX: f64 = 1.5;
const THICKNESS_MM: f64 = 0.7;
const WAVELENGTH_MM: f64 = 550e-6;
const PITCH_MM: f64 = 0.084;
const WINDOW_MM: [f64; 2] = [0.026, 0.076];
/// Radius of the spot at 1/e² of its intensity.
const SPOT_MM: f64 = 0.04;

/// Coordinate of a cell, 0 in the middle of a window and of the spot.
fn coordinate(cell: usize) -> f64 {
    (cell as f64 + 0.5) * CELL_MM - 0.5 * PERIOD_MM
}

/// Fraction of the interval of a cell around a place that is in the windows along one axis.
fn lit(place: f64, width: f64) -> f64 {
    let up_to = |x: f64| {
        let from = x + 0.5 * width;
        let periods = (from / PITCH_MM).floor();
        periods * width + (from - periods * PITCH_MM).min(width)
    };
    (up_to(place + 0.5 * CELL_MM) - up_to(place - 0.5 * CELL_MM)) / CELL_MM
}

/// Light through the windows by rays and by waves, for one face.
fn light(sampler: &FaceSampler, replicate: u64) -> [f64; 2] {
    let numbers = SampleStream::new(Sampler::Random, 77, replicate);
    let (heights, slopes) = (sampler.heights(&numbers), sampler.slopes(&numbers));
    let spot = |cell: usize| {
        let radius = coordinate(cell % COUNT).hypot(coordinate(cell / COUNT));
        (-(radius / SPOT_MM).powi(2)).exp()
    };
    let window = |x: f64, y: f64| lit(x, WINDOW_MM[0]) * lit(y, WINDOW_MM[1]);
    let per_slope = THICKNESS_MM * (INDEX - 1.0) / INDEX;
    let ray = |cell: usize| {
        let (x, y) = (coordinate(cell % COUNT), coordinate(cell / COUNT));
        spot(cell).powi(2) * window(x + per_slope * slopes[cell].re, y + per_slope * slopes[cell].im)
    };
    let rays: f64 = (0..COUNT * COUNT).map(ray).sum();
    let phase = 2.0 * PI / WAVELENGTH_MM * (INDEX - 1.0);
    let wave: Vec<Complex64> =
        (0..COUNT * COUNT).map(|cell| Complex64::from_polar(spot(cell), phase * heights[cell])).collect();
    let plane = Plane::new([COUNT; 2]);
    let mut spectrum = plane.forward(wave);
    let frequency = |bin: usize| {
        let wave = if 2 * bin <= COUNT { bin as f64 } else { bin as f64 - COUNT as f64 };
        wave / PERIOD_MM
    };
    for (bin, value) in spectrum.iter_mut().enumerate() {
        let square = frequency(bin % COUNT).powi(2) + frequency(bin / COUNT).powi(2);
        *value *= Complex64::from_polar(1.0, -PI * WAVELENGTH_MM * THICKNESS_MM / INDEX * square);
    }
    let wave = plane.inverse(spectrum);
    let received =
        |cell: usize| wave[cell].norm_sqr() * window(coordinate(cell % COUNT), coordinate(cell / COUNT));
    let waves: f64 = (0..COUNT * COUNT).map(received).sum();
    [rays, waves / (COUNT as f64).powi(4)]
}

/// Correlation length; deviations of a separate program by rays and by waves, each of 60 faces (9 %); range
/// of the ratio of waves to rays on the same faces. Over 200 faces it is 0.983, 0.990, 0.983, 0.993: rays
/// hold within 2 % where the correlation length is at least sqrt(0.5 lambda d/n), 11 um here. Below, the
/// ratio scatters more from face to face; the separate program found 1.17.
#[test]
fn rays_hold_above_the_correlation_length_of_diffraction() {
    for (correlation_mm, known, ratio) in [
        (0.006, [0.0451, 0.0528], 0.88..1.14),
        (0.012, [0.1288, 0.1280], 0.94..1.06),
        (0.025, [0.2250, 0.2209], 0.94..1.06),
        (0.050, [0.2256, 0.2231], 0.94..1.06),
    ] {
        let face = RandomFace { slope_rms: 0.03, correlation_mm };
        let sampler = FaceSampler::new(face, Cells { count: [COUNT; 2], period_mm: [PERIOD_MM; 2] });
        let faces = 3 * papilio_testing::seeds().min(100);
        let all: Vec<[f64; 2]> = (0..faces).map(|replicate| light(&sampler, replicate)).collect();
        let found = [0, 1].map(|k| {
            let mean = all.iter().map(|light| light[k]).sum::<f64>() / faces as f64;
            let variance =
                all.iter().map(|light| (light[k] - mean).powi(2)).sum::<f64>() / (faces - 1) as f64;
            variance.sqrt() / mean
        });
        for (found, known) in found.iter().zip(known) {
            let error = (0.5 / faces as f64 + 0.5 / 60.0).sqrt();
            assert!((found / known - 1.0).abs() < 4.0 * error, "{correlation_mm} mm: {found}, {known}");
        }
        let quotient = found[1] / found[0];
        assert!(ratio.contains(&quotient), "{correlation_mm} mm: {found:?}, ratio {quotient}");
    }
}
