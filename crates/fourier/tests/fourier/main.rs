//! Transforms of planes whose spectra are known.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_fourier::{Plane, Separable, StatePicture, filtered};

#[test]
fn spectrum_of_a_wave_is_its_bin() {
    let [columns, rows] = [6, 35];
    let wave = |cell: usize| {
        let (row, column) = (cell / columns, cell % columns);
        Complex64::cis(2.0 * PI * (2.0 * column as f64 / columns as f64 + 33.0 * row as f64 / rows as f64))
    };
    let cells: Vec<Complex64> = (0..columns * rows).map(wave).collect();
    let plane = Plane::new([columns, rows]);
    let spectrum = plane.forward(cells.clone());
    for (bin, value) in spectrum.iter().enumerate() {
        let expected = if bin == 2 * rows + 33 { (columns * rows) as f64 } else { 0.0 };
        assert!((value - expected).norm() < 1e-10, "{bin}: {value}");
    }
    let back = plane.inverse(spectrum);
    let count = (columns * rows) as f64;
    assert!(back.iter().zip(&cells).all(|(back, cell)| (back / count - cell).norm() < 1e-12));
}

/// Frequencies of the columns or rows, cycles per pixel.
fn frequencies(count: usize) -> Vec<f64> {
    (0..count).map(|k| k as f64 / (2 * count) as f64).collect()
}

#[test]
fn transfer_functions_multiply_gratings() {
    for (columns, rows) in [(30, 7), (15, 14)] {
        let [x, y] = [4.0 / 60.0, 3.0 / 14.0];
        let wave = |row: usize, column: usize| {
            (2.0 * PI * x * (column as f64 + 0.5)).cos() * (2.0 * PI * y * (row as f64 + 0.5)).cos()
        };
        let mut one: Vec<f64> = (0..rows * columns).map(|k| 0.5 + wave(k / columns, k % columns)).collect();
        let mut other: Vec<f64> = one.iter().map(|value| 3.0 * value).collect();
        let term = |along_x: Vec<f64>, along_y: Vec<f64>| Separable { along_x, along_y };
        // 1 - x - 2 y, and x y.
        let falling = [
            term(frequencies(columns).iter().map(|x| 1.0 - x).collect(), vec![1.0; rows]),
            term(vec![-2.0; columns], frequencies(rows)),
        ];
        let product = [term(frequencies(columns), frequencies(rows))];
        filtered([&mut one, &mut other], columns, [&falling, &product]);
        for (k, (one, other)) in one.iter().zip(&other).enumerate() {
            let wave = wave(k / columns, k % columns);
            let expected = [0.5 + (1.0 - x - 2.0 * y) * wave, 3.0 * x * y * wave];
            assert!(
                (one - expected[0]).abs() < 1e-12 && (other - expected[1]).abs() < 1e-12,
                "{k}: {one} {other}"
            );
        }
    }
}

#[test]
fn transfer_function_of_one_changes_nothing() {
    for (columns, rows) in [(1, 1), (1, 5), (40, 70), (33, 1)] {
        let plane: Vec<f64> = (0..columns * rows).map(|k| ((k * k) as f64).sin()).collect();
        let mut same = plane.clone();
        let one = [Separable { along_x: vec![1.0; columns], along_y: vec![1.0; rows] }];
        filtered([&mut same, &mut []], columns, [&one, &[]]);
        assert!(plane.iter().zip(&same).all(|(one, other)| (one - other).abs() < 1e-12));
    }
}

/// Light of each offset in each shape.
const SHAPES: [&[([i64; 2], f64)]; 3] =
    [&[([0, 0], 0.5), ([1, 0], 0.25)], &[([0, 1], 0.3), ([-9, 2], 0.1)], &[([2, -3], 0.7)]];

/// Three pictures of three quantities, three states, by sums over the pixels: with repetitions and with a
/// margin without light, for odd and even numbers of columns and rows, in one and in several blocks, on one
/// and several threads.
#[test]
fn pictures_of_states_are_convolved_with_the_kernels_of_their_states() {
    let sizes = [
        ([7, 5], [0, 0], 3),
        ([7, 5], [9, 3], 2),
        ([40, 70], [0, 0], 1),
        ([40, 70], [0, 0], 3),
        ([37, 66], [9, 3], 4),
        ([1, 2], [0, 0], 2),
    ];
    for (size, margin, threads) in sizes {
        let [columns, rows] = size;
        let picture: Vec<u8> = (0..columns * rows).map(|k| (k * k % 11 % 3) as u8).collect();
        let states = StatePicture::new(&picture, columns, 3, margin, threads);
        assert!(states.is_of(&picture, columns, 3, margin));
        let mut other = picture.clone();
        other[columns] = (other[columns] + 1) % 3;
        assert!(!states.is_of(&other, columns, 3, margin), "another picture");
        assert!(!states.is_of(&picture, rows, 3, margin), "another shape");
        assert!(!states.is_of(&picture, columns, 4, margin), "more states");
        assert!(!states.is_of(&picture, columns, 3, [9, 4]), "another margin");
        let shapes = states
            .shapes(3, threads, |shape, add| SHAPES[shape].iter().for_each(|(at, light)| add(*at, *light)));
        let everywhere = [[0.5, -1.0, 2.0], [0.0; 3], [1.0, 0.25, -0.5]];
        let mixtures: Vec<Vec<f64>> =
            [0.1, 0.07, 0.03].map(|slope| (0..27).map(|k| slope * f64::from(k) - 1.0).collect()).to_vec();
        let wanted = |number: usize, at: usize, quantity: usize| {
            let mut sum = f64::from(everywhere[number][quantity]);
            for (shape, lights) in SHAPES.iter().enumerate() {
                for ([x, y], light) in *lights {
                    // Upwards is towards earlier rows.
                    let there = [(at % columns) as i64 + x, (at / columns) as i64 - y];
                    let [column, row] = [0, 1].map(|k| there[k].rem_euclid(size[k] as i64));
                    if there == [column, row] || margin == [0, 0] {
                        let state = usize::from(picture[row as usize * columns + column as usize]);
                        sum += light * mixtures[number][(quantity * 3 + state) * 3 + shape];
                    }
                }
            }
            sum
        };
        let mut pictures = 0;
        states.seen(&shapes, &mixtures, &everywhere, threads, |number, pixels| {
            assert_eq!((number, pixels.len()), (pictures, picture.len()));
            pictures += 1;
            for (at, values) in pixels.iter().enumerate() {
                for (quantity, value) in values.iter().enumerate() {
                    let wanted = wanted(number, at, quantity);
                    let off = (f64::from(*value) - wanted).abs();
                    // Pictures have single precision.
                    let most = 1e-6 * wanted.abs().max(1.0);
                    assert!(off < most, "{size:?} {margin:?} {number} {quantity} {at}: {value} {wanted}");
                }
            }
        });
        assert_eq!(pictures, 3);
    }
}
