//! Tests of error diffusion.

use papilio_testing::Dice;

use super::*;

/// Rows of a picture of two states as hexadecimal digits.
fn hexadecimal(states: &[u8], columns: usize) -> String {
    let digit =
        |four: &[u8]| char::from_digit(four.iter().fold(0, |digit, state| 2 * digit + u32::from(*state)), 16);
    let row = |row: &[u8]| row.chunks(4).filter_map(digit).collect::<String>();
    states.chunks(columns).map(row).collect::<Vec<_>>().join(" ")
}

const RASTER: ErrorDiffusion = ErrorDiffusion {
    kernel: DiffusionKernel::FloydSteinberg,
    scan: Scan::Raster,
    limit: 1.0,
    metric: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
};

/// Computed independently in floating point, raster scan, threshold 0.5.
#[test]
fn error_diffusion_of_a_quarter_and_of_a_ramp_has_the_known_pattern() {
    let flat = RASTER.levels(&[0.25; 64], 8, &[0.0, 1.0]).unwrap();
    assert_eq!(hexadecimal(&flat.states, 8), "00 55 00 55 00 54 02 50");
    assert_eq!(flat.states.iter().filter(|state| **state == 1).count(), 14);
    assert_eq!(flat.lost, [2.0]);
    let ramp: Vec<f32> = (0..128).map(|at| ((at % 16) as f32 + 0.5) / 16.0).collect();
    let ramp = RASTER.levels(&ramp, 16, &[0.0, 1.0]).unwrap();
    assert_eq!(hexadecimal(&ramp.states, 16), "057f 1157 056f 12bf 0957 257f 02ab 157f");
}

/// A palette of six inks: dark, far from a box, and with obtuse angles.
const INKS: [[f64; 3]; 6] = [
    [0.02, 0.02, 0.02],
    [0.33, 0.35, 0.37],
    [0.30, 0.33, 0.05],
    [0.16, 0.09, 0.05],
    [0.05, 0.06, 0.17],
    [0.07, 0.11, 0.07],
];

/// Colours of the hull that vary over the picture; multiples of 2^-20.
fn in_hull(pixels: usize, seed: u64) -> Vec<[f32; 3]> {
    let mut dice = Dice::new(seed, 0);
    let mut colour = || {
        let weights = [0; 6].map(|_| -dice.throw().ln());
        let sum: f64 = weights.iter().sum();
        std::array::from_fn(|k| {
            let value: f64 = weights.iter().zip(INKS).map(|(weight, ink)| weight / sum * ink[k]).sum();
            ((value * 2.0_f64.powi(20)).round() / 2.0_f64.powi(20)) as f32
        })
    };
    let patches: Vec<[f32; 3]> = (0..16).map(|_| colour()).collect();
    (0..pixels).map(|at| if at % 7 == 0 { colour() } else { patches[at / 97 % 16] }).collect()
}

/// The palette in the numbers that error diffusion computes with: 2^-25 for a largest coordinate of 0.37.
fn whole_units(palette: &[[f64; 3]]) -> Vec<[f64; 3]> {
    palette
        .iter()
        .map(|colour| colour.map(|value| (value * 2.0_f64.powi(25)).round() / 2.0_f64.powi(25)))
        .collect()
}

#[test]
fn error_diffusion_wanted_light_is_shown_or_lost_exactly() {
    let palette = whole_units(&INKS);
    let (columns, pixels) = (83, 83 * 61);
    let mut wanted = in_hull(pixels, 1);
    // A patch outside the hull: brighter than white, and negative.
    wanted[20 * columns..30 * columns].fill([0.5, 0.75, -0.25]);
    for (kernel, scan) in
        DiffusionKernel::ALL.into_iter().flat_map(|kernel| Scan::ALL.map(|scan| (kernel, scan)))
    {
        let settings = ErrorDiffusion { kernel, scan, ..RASTER };
        let shown = settings.colours(&wanted, columns, &palette).unwrap();
        assert!(shown.cut_pixels > 100, "{kernel:?}");
        for k in 0..3 {
            let wanted: f64 = wanted.iter().map(|colour| f64::from(colour[k])).sum();
            let seen: f64 = shown.states.iter().map(|state| palette[usize::from(*state)][k]).sum();
            // All numbers are multiples of 2^-25 below 2^12: the sums are exact.
            assert_eq!(wanted - seen - shown.lost[k], 0.0, "{kernel:?}, {scan:?}, {k}");
        }
    }
}

#[test]
fn error_diffusion_inside_the_hull_loses_nothing_but_at_the_borders() {
    let wanted = in_hull(150 * 150, 2);
    for kernel in DiffusionKernel::ALL {
        let shown = ErrorDiffusion { kernel, ..RASTER }.colours(&wanted, 150, &INKS).unwrap();
        assert_eq!((shown.cut_pixels, shown.cut), (0, [0.0; 3]), "{kernel:?}");
    }
}

/// A mean over a square is kept to the light that its border passes in and out.
#[test]
fn error_diffusion_of_a_uniform_colour_has_it_as_its_mean_everywhere() {
    let wanted = [0.15_f32, 0.16, 0.11];
    for (kernel, scan) in
        DiffusionKernel::ALL.into_iter().flat_map(|kernel| Scan::ALL.map(|scan| (kernel, scan)))
    {
        if !kernel.keeps_the_mean() {
            continue;
        }
        let settings = ErrorDiffusion { kernel, scan, ..RASTER };
        let shown = settings.colours(&[wanted; 96 * 96], 96, &INKS).unwrap();
        for corner in [24 * 96 + 24, 24 * 96 + 48, 50 * 96 + 30] {
            for k in 0..3 {
                let rows = (0..24).flat_map(|row| &shown.states[corner + row * 96..][..24]);
                let mean = rows.map(|state| INKS[usize::from(*state)][k]).sum::<f64>() / 576.0;
                // About 100 pixels at the border, each with an error of about 0.1, and half of them outside:
                // 0.01 if all had one sign.
                assert!((mean - f64::from(wanted[k])).abs() < 0.01, "{kernel:?}, {scan:?}: {mean}");
            }
        }
    }
}

#[test]
fn error_diffusion_outside_the_hull_shows_the_nearest_states_and_recovers() {
    // Brighter than white above, a middle grey below: the error of the upper half ends within a few rows.
    let mut wanted = vec![2.0_f32; 32 * 32];
    wanted.extend(vec![0.5_f32; 32 * 32]);
    let shown = ErrorDiffusion::default().levels(&wanted, 32, &[0.0, 1.0]).unwrap();
    assert!(shown.states[..32 * 32].iter().all(|state| *state == 1));
    let below = shown.states[36 * 32..].iter().map(|state| f64::from(*state)).sum::<f64>() / (28.0 * 32.0);
    assert!((below - 0.5).abs() < 0.02, "{below}");
    assert!(shown.cut[0] > 900.0 && shown.lost[0] >= shown.cut[0]);
}

#[test]
fn error_diffusion_in_another_metric_keeps_the_mean() {
    let metric = [
        [0.2787336, 0.7218031, -0.1065520],
        [-0.4487736, 0.2898056, 0.0771569],
        [0.0859513, -0.5899859, 0.5011089],
    ];
    let wanted = [[0.15_f32, 0.16, 0.11]; 64 * 64];
    let plain = RASTER.colours(&wanted, 64, &INKS).unwrap();
    let other = ErrorDiffusion { metric, ..RASTER }.colours(&wanted, 64, &INKS).unwrap();
    assert_ne!(plain.states, other.states);
    assert_eq!(other.cut_pixels, 0);
    for k in 0..3 {
        let mean = other.states.iter().map(|state| INKS[usize::from(*state)][k]).sum::<f64>() / 4096.0;
        assert!((mean - f64::from(wanted[0][k])).abs() < 0.01, "{k}: {mean}");
    }
    // Ten times the metric, or ten times the light, is the same choice.
    let scaled = ErrorDiffusion { metric: metric.map(|row| row.map(|m| 1024.0 * m)), ..RASTER };
    assert_eq!(other, scaled.colours(&wanted, 64, &INKS).unwrap());
    let bright = ErrorDiffusion { metric, ..RASTER }
        .colours(&wanted.map(|c| c.map(|v| 1024.0 * v)), 64, &INKS.map(|c| c.map(|v| 1024.0 * v)))
        .unwrap();
    assert_eq!(other.states, bright.states);
}

#[test]
fn error_diffusion_of_numbers_that_are_not_finite_or_huge_does_not_overflow() {
    let mut dice = Dice::new(3, 0);
    for kernel in DiffusionKernel::ALL {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -1e30, 0.0, 0.2];
        let wanted: Vec<[f32; 3]> = (0..2000).map(|_| [0; 3].map(|_| dice.of(odd))).collect();
        let settings = ErrorDiffusion { kernel, limit: f64::INFINITY, ..RASTER };
        let shown = settings.colours(&wanted, 40, &INKS).unwrap();
        assert!(shown.lost.iter().all(|lost| lost.is_finite()));
        assert_eq!(settings.colours(&wanted, 40, &[[0.0; 3]]).unwrap().states, [0; 2000]);
    }
}

#[test]
fn halftone_of_an_unusable_input_is_refused() {
    let settings = ErrorDiffusion::default();
    let refused = |error: ImagingError, text: &str| assert!(error.to_string().contains(text), "{error}");
    refused(settings.levels(&[0.0; 7], 3, &[0.0]).unwrap_err(), "7 values (expected a multiple of 3");
    refused(settings.levels(&[0.0; 7], 0, &[0.0]).unwrap_err(), "7 values (expected a multiple of 0");
    refused(settings.levels(&[0.0; 6], 3, &[]).unwrap_err(), "0 states (expected 1 to 256)");
    refused(settings.levels(&[0.0; 6], 3, &[0.0; 257]).unwrap_err(), "257 states");
    refused(settings.levels(&[0.0; 6], 3, &[0.0, f64::NAN]).unwrap_err(), "state 1 of the palette");
    refused(Mask::bayer(6).unwrap_err(), "sides of 6 pixels (expected 2, 4, 8 or 16)");
    refused(Mask::void_and_cluster(3, 0).unwrap_err(), "sides of 3 pixels (expected 4 to 256)");
    let mask = Mask::bayer(2).unwrap();
    refused(
        ordered(&[0.0; 6], 3, &[0, 0], &mask).unwrap_err(),
        "state 0 is out of place in the order of 2 states",
    );
    refused(ordered(&[0.0; 6], 3, &[0, 2], &mask).unwrap_err(), "state 2 is out of place");
    refused(ordered(&[0.0; 7], 3, &[0, 1], &mask).unwrap_err(), "7 values (expected a multiple of 2");
    refused(ordered(&[0.0; 8], 3, &[0, 1], &mask).unwrap_err(), "4 values (expected a multiple of 3");
    refused(ordered_planes(&[], 3).unwrap_err(), "states (expected 1 to 256)");
    refused(
        ordered_planes(&[(&[0.0; 6], &mask), (&[0.0; 3], &mask)], 3).unwrap_err(),
        "3 pixels (expected 6",
    );
}

/// Atkinson's kernel passes on three quarters: computed independently in floating point, raster scan, threshold
/// 0.5. A tone below an eighth becomes black.
#[test]
fn atkinson_loses_a_quarter_of_the_error() {
    let settings = ErrorDiffusion { kernel: DiffusionKernel::Atkinson, ..RASTER };
    let flat = settings.levels(&[0.375; 64], 8, &[0.0, 1.0]).unwrap();
    assert_eq!(hexadecimal(&flat.states, 8), "00 6d 09 92 64 09 92 52");
    let dark = settings.levels(&[0.05; 32 * 32], 32, &[0.0, 1.0]).unwrap();
    assert!(dark.states.iter().all(|state| *state == 0));
}

/// Pixels that take few states have no others, keep the mean luminance, and pass on only what lies along their line.
#[test]
fn few_states_keep_luminance_beside_colours() {
    let palette = [[0.05, 0.05, 0.05], [0.9, 1.0, 0.8], [0.4, 0.2, 0.05], [0.1, 0.15, 0.5]];
    let allowed = [true, true, false, false];
    let line = [0.85, 0.95, 0.75];
    let (columns, rows) = (96, 64);
    let mut dice = Dice::new(5, 0);
    let wanted: Vec<[f32; 3]> = (0..columns * rows)
        .map(|at| {
            let part = 0.2 + 0.6 * dice.throw();
            let colour = if at % columns < 48 { [0.28, 0.22, 0.15] } else { line };
            [0, 1, 2].map(|k| (0.05 + part * colour[k]) as f32)
        })
        .collect();
    let is_few = |x: usize| x >= 48;
    let row = |y: usize, row: &mut [[f32; 3]]| row.copy_from_slice(&wanted[y * columns..][..columns]);
    let mark =
        |_: usize, marks: &mut [bool]| marks.iter_mut().enumerate().for_each(|(x, mark)| *mark = is_few(x));
    let few = FewStates { row: &mark, allowed: &allowed, line };
    let metric = [[0.0, 1.0, 0.0], [1.7, -1.7, 0.0], [0.0, 0.6, -0.6]];
    let diffusion = ErrorDiffusion { metric, ..ErrorDiffusion::default() };
    let found = diffusion.colours_beside(&row, (None, Some(few)), [columns, rows], &palette).unwrap();
    let mut luminance = [0.0; 2];
    for (at, (state, wanted)) in found.states.iter().zip(&wanted).enumerate() {
        assert!(!is_few(at % columns) || allowed[usize::from(*state)], "{at}: {state}");
        let side = usize::from(is_few(at % columns));
        luminance[side] += palette[usize::from(*state)][1] - f64::from(wanted[1]);
    }
    assert!(found.states.contains(&2));
    // Each side has its mean, to the errors at the borders.
    luminance.iter().for_each(|more| assert!(more.abs() < 0.004 * wanted.len() as f64, "{luminance:?}"));
    // What is lost is exactly the difference.
    for k in 0..3 {
        let shown: f64 = found.states.iter().map(|state| palette[usize::from(*state)][k]).sum();
        let sum: f64 = wanted.iter().map(|one| f64::from(one[k])).sum();
        assert!((sum - shown - found.lost[k]).abs() < 1e-3, "{k}");
    }
}
