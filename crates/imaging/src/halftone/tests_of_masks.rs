//! Tests of masks, their spectra, and ordered dither.

use num_complex::Complex64;
use papilio_colour::reader::contrast_sensitivity;
use papilio_fourier::Plane;
use papilio_testing::Dice;

use super::*;

#[test]
fn bayer_mask_of_four_is_the_printed_one_and_each_rank_occurs_once() {
    assert_eq!(
        Mask::bayer(4).unwrap().ranks(),
        [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]].concat()
    );
    for mask in [2, 4, 8, 16].map(|side| Mask::bayer(side).unwrap()) {
        assert_all_ranks(&mask);
    }
}

fn assert_all_ranks(mask: &Mask) {
    let mut ranks = mask.ranks().to_vec();
    ranks.sort_unstable();
    assert!(ranks.iter().enumerate().all(|(k, rank)| k == *rank as usize), "{}", mask.columns());
}

/// A tenth in steps of 1/64 is 6/64.
#[test]
fn ordered_tenth_of_white_by_bayer_8_is_0_09375() {
    let mask = Mask::bayer(8).unwrap();
    let states = ordered_planes(&[(&[0.1; 64 * 64], &mask)], 64).unwrap();
    assert_eq!(states.iter().map(|state| f64::from(*state)).sum::<f64>() / 4096.0, 0.09375);
}

#[test]
fn void_and_cluster_mask_depends_on_the_seed_alone_and_has_each_rank_once() {
    let mask = Mask::void_and_cluster(24, 5).unwrap();
    assert_all_ranks(&mask);
    assert_eq!(mask, Mask::void_and_cluster(24, 5).unwrap());
    assert_ne!(mask, Mask::void_and_cluster(24, 6).unwrap());
    assert_all_ranks(&Mask::void_and_cluster(4, 5).unwrap());
}

/// Powers of a periodic pattern by frequency along x and y, cycles per pixel; that of white noise of this
/// variance is 1 on average.
fn spectrum(values: &[f64], columns: usize) -> Vec<([f64; 2], f64)> {
    let rows = values.len() / columns;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    let bins = Plane::new([columns, rows])
        .forward(values.iter().map(|value| Complex64::from(value - mean)).collect());
    let cycles = |k: usize, count: usize| k.min(count - k) as f64 / count as f64;
    let bin = |(k, bin): (usize, Complex64)| {
        ([cycles(k / rows, columns), cycles(k % rows, rows)], bin.norm_sqr() / variance)
    };
    bins.into_iter().enumerate().map(bin).skip(1).collect()
}

/// Mean power in a ring of frequencies.
fn power(spectrum: &[([f64; 2], f64)], ring: [f64; 2]) -> f64 {
    let inside = spectrum.iter().filter(|(f, _)| (ring[0]..ring[1]).contains(&f[0].hypot(f[1])));
    let (sum, count) = inside.fold((0.0, 0), |(sum, count), (_, power)| (sum + power, count + 1));
    sum / f64::from(count)
}

/// Blue noise: hardly any power below half of the principal frequency, sqrt(g) cycles per pixel of grey g (or
/// of 1 - g).
#[test]
fn void_and_cluster_patterns_have_hardly_any_low_frequencies() {
    let side = 64;
    let mask = Mask::void_and_cluster(side, 1).unwrap();
    for grey in [0.0625, 0.125, 0.25, 0.5, 0.75, 0.875] {
        let states = ordered_planes(&[(&vec![grey; side * side], &mask)], side).unwrap();
        let values: Vec<f64> = states.iter().map(|state| f64::from(*state)).collect();
        let spectrum = spectrum(&values, side);
        let principal = f64::from(grey.min(1.0 - grey)).sqrt().min(0.5);
        let (low, high) =
            (power(&spectrum, [0.0, 0.5 * principal]), power(&spectrum, [0.8 * principal, 0.75]));
        assert!(low < 0.1 && high > 0.9, "{grey}: {low} {high}");
    }
}

/// Visible contrast of a pattern of white on black at a distance of 400 mm and 100 cd/m2: rms contrast,
/// weighted with Barten's contrast sensitivity, which is 1 at its peak.
fn visible_contrast(values: &[f64], columns: usize, per_inch: f64) -> f64 {
    let sensitivity = |f: f64| contrast_sensitivity(f, 100.0, 60.0).unwrap() / 721.90;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|value| (value / mean - 1.0).powi(2)).sum::<f64>() / values.len() as f64;
    let per_degree = per_inch / 25.4 * 400.0 * 1.0_f64.to_radians().tan();
    let seen = spectrum(values, columns).into_iter();
    let seen = seen.map(|(f, power)| power * sensitivity(f[0].hypot(f[1]) * per_degree).powi(2)).sum::<f64>();
    (variance * seen / values.len() as f64).sqrt()
}

/// On a flat quarter of white, Bayer's mask is the least visible, then error diffusion, then void and
/// cluster, then white noise, at 150 and at 300 pixels per inch.
#[test]
fn visible_contrast_of_a_quarter_has_the_known_order_of_methods() {
    let side = 128;
    let mut dice = Dice::new(2, 0);
    let grey = vec![0.25_f32; side * side];
    let masked = |mask: Mask| ordered_planes(&[(&grey, &mask)], side).unwrap();
    let patterns: [Vec<u8>; 4] = [
        masked(Mask::bayer(8).unwrap()),
        ErrorDiffusion::default().levels(&grey, side, &[0.0, 1.0]).unwrap().states,
        masked(Mask::void_and_cluster(32, 1).unwrap()),
        (0..side * side).map(|_| u8::from(dice.throw() < 0.25)).collect(),
    ];
    for per_inch in [150.0, 300.0] {
        let values = |states: &Vec<u8>| states.iter().map(|state| f64::from(*state)).collect::<Vec<_>>();
        let seen = patterns.each_ref().map(|states| visible_contrast(&values(states), side, per_inch));
        assert!(seen.windows(2).all(|pair| 1.1 * pair[0] < pair[1]), "{per_inch}: {seen:?}");
    }
}

/// A uniform picture has each state in its coverage.
#[test]
fn ordered_uniform_picture_has_the_coverages_of_its_states() {
    let palette = [[0.1, 0.1, 0.1], [0.9, 0.9, 0.9], [0.5, 0.3, 0.1], [0.2, 0.4, 0.1], [0.1, 0.1, 0.5]];
    let order = light_to_dark(&palette);
    assert_eq!(order, [1, 3, 2, 0, 4]);
    let mut dice = Dice::new(1, 0);
    for mask in [Mask::bayer(16).unwrap(), Mask::void_and_cluster(16, 1).unwrap()] {
        for _ in 0..20 {
            // Whole counts of 256 pixels, one state absent.
            let mut counts = [0_u16; 5];
            (0..256).for_each(|_| counts[dice.of([0, 1, 3, 4, 4])] += 1);
            let coverages = counts.map(|count| f32::from(count) / 256.0).repeat(32 * 48);
            let states = ordered(&coverages, 32, &order, &mask).unwrap();
            for (state, count) in counts.into_iter().enumerate() {
                let found = states.iter().filter(|found| usize::from(**found) == state).count();
                assert_eq!(found, 6 * usize::from(count), "{state}");
            }
        }
    }
}

#[test]
fn ordered_planes_set_one_bit_each_and_follow_shifted_masks() {
    let mask = Mask::bayer(4).unwrap();
    let moved = mask.shifted(1, 6);
    assert_eq!((moved.ranks()[2 * 4 + 1], moved.columns(), moved.rows()), (0, 4, 4));
    // A quarter of red, nothing of green, all of blue.
    let planes: [(&[f32], &Mask); 3] = [(&[0.25; 64], &mask), (&[0.0; 64], &mask), (&[1.0; 64], &moved)];
    let states = ordered_planes(&planes, 8).unwrap();
    let reds = states.iter().filter(|state| **state == 0b101).count();
    assert_eq!((reds, states.iter().filter(|state| **state == 0b100).count()), (16, 48));
    let moved_reds = ordered_planes(&[(&[0.25; 64], &moved)], 8).unwrap();
    assert!((0..64).all(|at| (at % 8 == 0 || at < 16) || moved_reds[at] == states[at - 1 - 16] & 1));
}
