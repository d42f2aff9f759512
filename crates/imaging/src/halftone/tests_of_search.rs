//! Tests of direct binary search: against sums over all pixels.

use std::ops::ControlFlow;

use papilio_testing::Dice;

use super::*;

/// A bell of this width, pixels.
fn bell(reach: isize, width: f64) -> Filter {
    let side = (2 * reach + 1) as usize;
    let value = |at: usize| {
        let (x, y) = ((at % side) as isize - reach, (at / side) as isize - reach);
        (-((x * x + y * y) as f64) / (2.0 * width * width)).exp()
    };
    let values: Vec<f64> = (0..side * side).map(value).collect();
    let sum: f64 = values.iter().sum();
    Filter::new(side, values.iter().map(|value| value / sum).collect()).unwrap()
}

/// The error by its definition: filtered differences, squared, over the plane.
fn error(
    wanted: &[[f32; 2]],
    columns: usize,
    palette: &[[f64; 2]],
    sides: [isize; 2],
    filters: &[Vec<f64>; 2],
    states: &[u8],
) -> f64 {
    let rows = (wanted.len() / columns) as isize;
    let mut sum = 0.0;
    for k in 0..2 {
        let reach = sides[k] / 2;
        for y in -reach..rows + reach {
            for x in -reach..columns as isize + reach {
                let mut seen = 0.0;
                for (at, value) in filters[k].iter().enumerate() {
                    let (u, v) = (x - (at as isize % sides[k] - reach), y - (at as isize / sides[k] - reach));
                    if (0..columns as isize).contains(&u) && (0..rows).contains(&v) {
                        let at = v as usize * columns + u as usize;
                        seen += value * (palette[usize::from(states[at])][k] - f64::from(wanted[at][k]));
                    }
                }
                sum += seen * seen;
            }
        }
    }
    sum
}

const PALETTE: [[f64; 2]; 3] = [[0.0, 0.1], [1.0, 0.3], [0.4, 0.9]];
const COLUMNS: usize = 11;

/// Coordinates are the values themselves.
const AS_IS: [[f64; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

/// Rounding of the error, relative to that of the start: correlated errors are numbers of 32 bits.
const SINGLE: f64 = 1e-6;

struct Case {
    wanted: Vec<[f32; 2]>,
    values: [Vec<f64>; 2],
    start: Vec<u8>,
}

impl Case {
    fn new() -> Self {
        let mut dice = Dice::new(11, 0);
        // Without any symmetry: the search needs none.
        let mut numbers = |count: usize| (0..count).map(|_| dice.throw()).collect::<Vec<f64>>();
        let values = [numbers(15), numbers(9)];
        let wanted = (0..COLUMNS * 9).map(|at| [0.3 + 0.03 * (at % 11) as f32, 0.5]).collect();
        let start = (0..COLUMNS * 9).map(|_| dice.below(3) as u8).collect();
        Self { wanted, values, start }
    }

    fn error(&self, states: &[u8]) -> f64 {
        error(&self.wanted, COLUMNS, &PALETTE, [5, 3], &self.values, states)
    }

    fn search(&self, watch: &mut dyn FnMut(SearchPass) -> ControlFlow<()>) -> Searched {
        let filters = [
            Filter::new(5, self.values[0].clone()).unwrap(),
            Filter::new(3, self.values[1].clone()).unwrap(),
        ];
        let control =
            SearchControl { fixed: &[], few: &[], allowed: &[], threads: 1, stop: &|| false, watch };
        direct_binary_search(&self.wanted, COLUMNS, (&PALETTE, AS_IS), &filters, &self.start, control)
            .unwrap()
    }
}

#[test]
fn direct_binary_search_lowers_its_error_until_no_change_of_a_pixel_or_a_pair_does() {
    let case = Case::new();
    let mut errors = Vec::new();
    let found = case.search(&mut |pass| {
        errors.push(pass.error);
        ControlFlow::Continue(())
    });
    assert!(found.is_complete && found.passes == errors.len() && errors.len() > 2);
    assert!(errors.windows(2).all(|pair| pair[1] <= pair[0]) && errors[0] < found.error_at_start);
    let at_end = case.error(&found.states);
    assert!((case.error(&case.start) - found.error_at_start).abs() < SINGLE * found.error_at_start);
    assert!((at_end - found.error).abs() < SINGLE * found.error_at_start, "{at_end} {}", found.error);
    // Changes count from 1e-5 of what the largest change of one pixel may gain, which is 7 here.
    let improves = |states: &[u8]| case.error(states) < at_end - 1e-4;
    for at in 0..found.states.len() {
        let mut changed = found.states.clone();
        for state in 0..3 {
            changed[at] = state;
            assert!(!improves(&changed), "{at}: {state}");
        }
        let (x, y) = (at % COLUMNS, at / COLUMNS);
        for (right, down) in [(1, 0), (-1, 1), (0, 1), (1, 1)] {
            let (u, v) = (x.wrapping_add_signed(right), y + down);
            if u < COLUMNS && v < 9 {
                for (one, other) in (0..9).map(|k| (k % 3, k / 3)) {
                    let mut changed = found.states.clone();
                    (changed[at], changed[v * COLUMNS + u]) = (one, other);
                    assert!(!improves(&changed), "{at}: {right} {down}");
                }
            }
        }
    }
}

#[test]
fn direct_binary_search_stops_when_asked() {
    let case = Case::new();
    let stopped = case
        .search(&mut |pass| if pass.pass == 1 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) });
    assert!(!stopped.is_complete && stopped.passes == 1);
    assert!((case.error(&stopped.states) - stopped.error).abs() < SINGLE * stopped.error_at_start);
    let filters = [bell(1, 1.0), bell(1, 1.0)];
    let watch = &mut |_| ControlFlow::Continue(());
    let control = SearchControl { fixed: &[], few: &[], allowed: &[], threads: 2, stop: &|| true, watch };
    let none = direct_binary_search(&case.wanted, COLUMNS, (&PALETTE, AS_IS), &filters, &case.start, control)
        .unwrap();
    assert_eq!((none.states, none.passes, none.is_complete), (case.start, 0, false));
}

/// Seen through the filter, the result is nearer to a grey than error diffusion, from either start.
#[test]
fn direct_binary_search_beats_error_diffusion_from_any_start() {
    let side = 48;
    let wanted: Vec<f32> = (0..side * side).map(|at| 0.1 + 0.8 * (at % side) as f32 / side as f32).collect();
    let diffused = ErrorDiffusion::default().levels(&wanted, side, &[0.0, 1.0]).unwrap().states;
    let mut dice = Dice::new(4, 0);
    let noise: Vec<u8> = wanted.iter().map(|value| u8::from(dice.throw() < f64::from(*value))).collect();
    let search = |start: &[u8]| {
        let watch = &mut |_| ControlFlow::Continue(());
        let palette = [[0.0], [1.0]];
        let control =
            SearchControl { fixed: &[], few: &[], allowed: &[], threads: 1, stop: &|| false, watch };
        direct_binary_search(wanted.as_chunks().0, side, (&palette, [[1.0]]), &[bell(5, 1.5)], start, control)
            .unwrap()
    };
    let (from_diffused, from_noise) = (search(&diffused), search(&noise));
    assert!(from_diffused.error < 0.5 * from_diffused.error_at_start, "{from_diffused:?}");
    let ratio = from_noise.error / from_diffused.error;
    assert!((0.7..1.4).contains(&ratio), "{ratio}");
}

#[test]
fn direct_binary_search_of_unusable_input_is_refused() {
    let case = Case::new();
    let search = |start: &[u8], palette: &[[f64; 2]]| {
        let filters = [bell(1, 1.0), bell(1, 1.0)];
        let watch = &mut |_| ControlFlow::Continue(());
        let control =
            SearchControl { fixed: &[], few: &[], allowed: &[], threads: 1, stop: &|| false, watch };
        direct_binary_search(&case.wanted, COLUMNS, (palette, AS_IS), &filters, start, control)
            .unwrap_err()
            .to_string()
    };
    assert!(search(&case.start, &PALETTE[..2]).contains("state 2 is out of place"));
    assert!(search(&case.start[1..], &PALETTE).contains("98 pixels (expected 99"));
    assert!(search(&case.start, &[]).contains("0 states"));
    for (columns, values) in [(2, vec![1.0; 2]), (3, vec![1.0; 6]), (1, vec![f64::NAN]), (1, vec![0.0])] {
        assert!(Filter::new(columns, values).unwrap_err().to_string().contains("odd"));
    }
}

/// Bands of rows at the same time: the same bits as one after the other, and a complete search, whose end no
/// change improves, also at the borders of bands. With ten states, too, of which not all pairs are tried.
#[test]
fn direct_binary_search_has_the_same_bits_with_any_number_of_threads() {
    let (columns, rows) = (24, 140);
    let mut dice = Dice::new(6, 0);
    for states in [3, 10] {
        let more = (3..states).map(|_| [dice.throw(), dice.throw()]);
        let palette: Vec<[f64; 2]> = PALETTE.into_iter().chain(more).collect();
        let wanted: Vec<[f32; 2]> =
            (0..columns * rows).map(|at| [0.3 + 0.4 * (at % 24) as f32 / 24.0, 0.5]).collect();
        let start: Vec<u8> = wanted.iter().map(|_| dice.below(states) as u8).collect();
        let filters = [bell(4, 1.3), bell(5, 1.6)];
        let search = |start: &[u8], threads| {
            let watch = &mut |_| ControlFlow::Continue(());
            let control =
                SearchControl { fixed: &[], few: &[], allowed: &[], threads, stop: &|| false, watch };
            direct_binary_search(&wanted, columns, (&palette, AS_IS), &filters, start, control).unwrap()
        };
        let alone = search(&start, 1);
        assert!(
            alone.is_complete && alone.error < 0.2 * alone.error_at_start,
            "{states}: {} {}",
            alone.error,
            alone.error_at_start
        );
        for threads in [2, 5] {
            assert_eq!(search(&start, threads), alone, "{states} states, {threads} threads");
        }
        // A search from its end finds nothing, and computes the error by itself.
        let again = search(&alone.states, 3);
        assert_eq!((again.passes, &again.states), (1, &alone.states));
        let moved = (again.error_at_start - alone.error).abs();
        assert!(moved < SINGLE * alone.error_at_start, "{} {}", again.error_at_start, alone.error);
    }
}

/// A tone of 3 % of white: alone, a white pixel is a larger error than the tone that is missing without it, and the search
/// takes all of them away. With a weight of means, the tone is within a part in 1 + w of it, and the error is that of its
/// definition, with areas of 32 x 32 pixels that end with the picture and without the fixed pixels.
#[test]
fn direct_binary_search_with_a_weight_of_means_keeps_tones() {
    let (columns, rows, weight) = (80, 48, 16.0);
    let wanted: Vec<[f32; 2]> = vec![[0.03, 0.5]; columns * rows];
    let palette = [[0.0, 0.5], [1.0, 0.5]];
    let mut dice = Dice::new(2, 0);
    let start: Vec<u8> = wanted.iter().map(|_| u8::from(dice.throw() < 0.03)).collect();
    // Lighter than their tone, which the others need not make good.
    let fixed: Vec<bool> = (0..start.len()).map(|at| at % columns < 4 && start[at] == 1).collect();
    let search = |weight: f64| {
        let filters = [0, 1].map(|_| bell(4, 1.0).keeping_means(weight));
        let watch = &mut |_| ControlFlow::Continue(());
        let control =
            SearchControl { fixed: &fixed, few: &[], allowed: &[], threads: 2, stop: &|| false, watch };
        direct_binary_search(&wanted, columns, (&palette, AS_IS), &filters, &start, control).unwrap()
    };
    let white = |states: &[u8]| {
        let free = states.iter().zip(&fixed).filter(|(_, fixed)| !**fixed);
        let (white, count) =
            free.fold((0, 0), |(white, count), (state, _)| (white + usize::from(*state), count + 1));
        white as f64 / f64::from(count)
    };
    let (without, with) = (search(0.0), search(weight));
    assert_eq!(white(&without.states), 0.0);
    assert!(0.03 - white(&with.states) < 0.03 / (1.0 + weight), "{}", white(&with.states));
    let values: Vec<f64> = bell(4, 1.0).values().to_vec();
    let mut expected = error(&wanted, columns, &palette, [9, 9], &[values.clone(), values], &with.states);
    for (left, top) in [(0, 0), (32, 0), (64, 0), (0, 32), (32, 32), (64, 32)] {
        let mut sum = 0.0;
        for at in (0..start.len()).filter(|at| !fixed[*at]) {
            if (left..left + 32).contains(&(at % columns)) && (top..top + 32).contains(&(at / columns)) {
                sum += f64::from(with.states[at]) - 0.03;
            }
        }
        expected += weight * sum * sum / 1024.0;
    }
    // The autocorrelation is cut at a hundredth of its middle.
    assert!((with.error - expected).abs() < 0.01 * expected, "{} {expected}", with.error);
    let filters = [0, 1].map(|_| bell(4, 1.0).keeping_means(weight));
    let watch = &mut |_| ControlFlow::Continue(());
    let control = SearchControl { fixed: &fixed, few: &[], allowed: &[], threads: 1, stop: &|| false, watch };
    let again =
        direct_binary_search(&wanted, columns, (&palette, AS_IS), &filters, &with.states, control).unwrap();
    assert_eq!((again.passes, &again.states), (1, &with.states));
    assert!((again.error_at_start - with.error).abs() < 1e-5 * with.error_at_start);
}

/// Pixels that take few states keep to them, also as one of a pair, with few and with many states; the others are free.
#[test]
fn direct_binary_search_keeps_few_states() {
    let mut dice = Dice::new(3, 0);
    for count in [4, 12] {
        let palette: Vec<[f64; 1]> = (0..count).map(|k| [f64::from(k) / f64::from(count - 1)]).collect();
        let allowed: Vec<bool> = (0..palette.len()).map(|state| state % 3 == 0).collect();
        let few: Vec<bool> = (0..COLUMNS * 9).map(|at| at % COLUMNS % 5 < 3).collect();
        let wanted: Vec<[f32; 1]> = (0..few.len()).map(|_| [0.9 * dice.throw() as f32]).collect();
        let start: Vec<u8> = few.iter().map(|is_few| if *is_few { 3 } else { 1 }).collect();
        let watch = &mut |_| ControlFlow::Continue(());
        let control =
            SearchControl { fixed: &[], few: &few, allowed: &allowed, threads: 1, stop: &|| false, watch };
        let found =
            direct_binary_search(&wanted, COLUMNS, (&palette, [[1.0]]), &[bell(1, 1.0)], &start, control)
                .unwrap();
        let states = || found.states.iter().zip(&few);
        assert!(states().all(|(state, is_few)| !is_few || allowed[usize::from(*state)]));
        assert!(states().any(|(state, is_few)| *is_few && *state == 0));
        assert!(states().any(|(state, is_few)| !is_few && !allowed[usize::from(*state)]));
        assert!(found.is_complete && found.error < found.error_at_start);
    }
}
