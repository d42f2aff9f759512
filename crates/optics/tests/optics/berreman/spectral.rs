//! The fast implementation equals the reference, in every combination of layers, states and thick slabs.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_optics::berreman::{
    AnisotropicLayer, Dielectric, Mueller, Part, Slice, SpectralStack, SpectralWaves, Stack, Wave, axes,
    mueller,
};
use papilio_testing::{Dice, laws, sized};

#[derive(Debug)]
struct Case {
    wavelength_nm: Vec<f64>,
    front: Vec<f64>,
    beta: Vec<f64>,
    azimuths_deg: Vec<f64>,
    parts: Vec<Part>,
    back: Vec<Complex64>,
    states: usize,
}

fn slices(dice: &mut Dice, most: usize, thickest_nm: f64) -> Vec<Slice> {
    dice.several(1..=most, |dice| Slice {
        axes: axes(dice.between(0.0, 360.0), dice.between(-90.0, 90.0), dice.between(0.0, 360.0)),
        thickness_nm: dice.between(0.0, thickest_nm),
    })
}

/// `contrast` scales the differences between indices.
fn part(dice: &mut Dice, count: usize, states: usize, contrast: f64) -> Part {
    let spectrum = |dice: &mut Dice, k: f64| -> Vec<Complex64> {
        (0..count)
            .map(|_| Complex64::new(1.6 + contrast * dice.between(-0.5, 0.6), k * dice.between(0.0, 0.1)))
            .collect()
    };
    let k = dice.of([0.0, 0.0, 1.0]);
    let mut indices = [spectrum(dice, k), spectrum(dice, k), spectrum(dice, k)];
    let kind = dice.below(4);
    if kind == 0 {
        indices[2] = indices[1].clone();
    }
    if kind == 1 && contrast < 1.0 {
        indices = [spectrum(dice, 1e-6), vec![], vec![]];
        let birefringence = dice.of([0.0, 0.01]);
        let more = |share: f64| indices[0].iter().map(|n| n + share * birefringence).collect();
        indices = [more(1.0), more(0.0), more(0.3)];
        return Part { indices, slices: vec![slices(dice, 1, 1e5)], repeats: 1, rest: 0, coherent: false };
    }
    let lists = if dice.one_in(2) { states } else { 1 };
    let most = dice.of([1, 5]);
    let mut all: Vec<Vec<Slice>> = (0..lists).map(|_| slices(dice, most, 700.0)).collect();
    if dice.one_in(3) {
        let last = all.len() - 1;
        all[last] = all[0].clone();
    }
    if dice.one_in(4) {
        // A helix: half turns, of which the last one may be cut.
        let (start_deg, tilt_deg) = (dice.between(0.0, 360.0), 0.0);
        let count = 4 + dice.below(5);
        let (turn_deg, thickness_nm) = (dice.of([180.0, -180.0, 360.0]), dice.between(0.0, 100.0));
        let slice = |k: usize| Slice {
            axes: axes(start_deg + turn_deg * k as f64 / count as f64, tilt_deg, 0.0),
            thickness_nm,
        };
        all[0] = (0..count).map(slice).collect();
        let least = all.iter().map(Vec::len).min().unwrap_or(0);
        let rest = dice.below(least + 1);
        return Part { indices, slices: all, repeats: dice.of([1, 2, 5]), rest, coherent: true };
    }
    Part { indices, slices: all, repeats: dice.of([1, 1, 2, 5]), rest: 0, coherent: true }
}

fn case(dice: &mut Dice) -> Case {
    let count = 1 + dice.below(11);
    let states = 1 + dice.below(3);
    // Light that crosses a thick slab more than 15 times is left out: layers around it reflect little, as in displays.
    let contrast = dice.of([1.0, 0.2]);
    let mut parts = dice.several(0..=5, |dice| part(dice, count, states, contrast));
    let mut slabs = 0;
    parts.retain(|part| {
        slabs += usize::from(!part.coherent);
        part.coherent || slabs <= 2
    });
    let lowest = if slabs > 0 { 1.4 } else { 1.0 };
    let front: Vec<f64> = (0..count).map(|_| dice.between(lowest, 1.6)).collect();
    let steepest = if slabs > 0 { 0.8 } else { 0.99 };
    let metal = dice.between(0.0, 5.0);
    // Steps of a helix, or none of them.
    let first_deg = dice.between(0.0, 360.0);
    let step_deg = dice.of([22.5, 30.0, 36.0, 45.0, 77.0]);
    Case {
        wavelength_nm: (0..count).map(|_| dice.between(380.0, 780.0)).collect(),
        beta: front.iter().map(|n| n * dice.between(0.0, steepest)).collect(),
        azimuths_deg: (0..3).map(|k| first_deg + step_deg * f64::from(k)).collect(),
        states: parts.iter().map(|part| part.slices.len()).max().unwrap_or(1),
        back: (0..count).map(|_| Complex64::new(dice.between(0.5, 2.0), metal)).collect(),
        parts,
        front,
    }
}

#[test]
fn many_wavelengths_and_states_equal_one_by_one() {
    laws(sized(120, 500), case, |case| {
        let stack = SpectralStack::new(&case.wavelength_nm, &case.front, &case.parts, &case.back).unwrap();
        assert_eq!(stack.states(), case.states);
        let count = case.wavelength_nm.len();
        let row = case.states * count;
        let mut found = vec![f64::NAN; 3 * row];
        stack.reflectance(&case.beta, &case.azimuths_deg, &mut found).unwrap();
        for (at, found) in found.iter().enumerate() {
            let (azimuth_deg, state, bin) = (case.azimuths_deg[at / row], at % row / count, at % count);
            let expected = one(case, azimuth_deg, state, bin);
            // The faces of a thick retarder are those of its mean index here: an error of first order in its birefringence, 0.01, which
            // grows with the inclination (1.3e-3 of a single retarder at a sine of 0.77).
            let is_retarder =
                case.parts.iter().any(|part| !part.coherent && part.indices[0] != part.indices[1]);
            let is_steep = case.beta[bin] > 0.7 * case.front[bin];
            let tolerance = match (is_retarder, is_steep) {
                (false, _) => 1e-10,
                (true, false) => 1e-3,
                (true, true) => 2e-3,
            };
            assert!((found - expected).abs() < tolerance, "{state} {bin}: {found} {expected}");
        }
    });
}

/// The whole reflection of polarised light, from Mueller's matrix.
#[test]
fn matrices_of_many_wavelengths_and_states_equal_one_by_one() {
    laws(sized(60, 300), case, |case| {
        let stack = SpectralStack::new(&case.wavelength_nm, &case.front, &case.parts, &case.back).unwrap();
        let count = case.wavelength_nm.len();
        let matrix = SpectralWaves::ELEMENTS * count;
        let mut found = vec![f64::NAN; 3 * case.states * matrix];
        stack.at(&case.beta).unwrap().actions(&case.azimuths_deg, &mut found).unwrap();
        let is_retarder = case.parts.iter().any(|part| !part.coherent && part.indices[0] != part.indices[1]);
        // Of retarders as above. Without a polariser above them it concerns amplitudes, which are larger than the reflectance that they change: 4.6e-3
        // was found.
        let tolerance = if is_retarder { 1e-2 } else { 1e-10 };
        for (number, found) in found.chunks_exact(matrix).enumerate() {
            for bin in 0..count {
                let expected =
                    whole(case, case.azimuths_deg[number / case.states], number % case.states, bin);
                // From I, Q, U, V to |p|^2 and |s|^2, and root 2 of Re and Im of p s*.
                let root = 0.5_f64.sqrt();
                let basis: [[f64; 4]; 4] = [
                    [root, root, 0.0, 0.0],
                    [root, -root, 0.0, 0.0],
                    [0.0, 0.0, 1.0, 0.0],
                    [0.0, 0.0, 0.0, 1.0],
                ];
                for row in 0..4 {
                    for column in 0..4 {
                        let sum =
                            |i: usize| -> f64 { (0..4).map(|k| expected[i][k] * basis[column][k]).sum() };
                        let expected: f64 = (0..4).map(|i| basis[row][i] * sum(i)).sum();
                        let found = found[(4 * row + column) * count + bin];
                        assert!(
                            (found - expected).abs() < tolerance,
                            "{row} {column} {bin}: {found} {expected}"
                        );
                    }
                }
            }
        }
    });
}

fn one(case: &Case, azimuth_deg: f64, state: usize, bin: usize) -> f64 {
    whole(case, azimuth_deg, state, bin)[0][0]
}

fn whole(case: &Case, azimuth_deg: f64, state: usize, bin: usize) -> Mueller {
    let layers = case.parts.iter().flat_map(|part| {
        let slices = &part.slices[if part.slices.len() == 1 { 0 } else { state }];
        let turns = std::iter::repeat_n(slices, part.repeats).flatten().chain(&slices[..part.rest]);
        turns.map(|slice| AnisotropicLayer {
            dielectric: Dielectric::biaxial(part.indices.each_ref().map(|n| n[bin]), slice.axes).unwrap(),
            thickness_nm: slice.thickness_nm,
            coherent: part.coherent,
        })
    });
    let stack = Stack { front: case.front[bin], layers: layers.collect(), back: case.back[bin] };
    let wave = Wave { wavelength_nm: case.wavelength_nm[bin], beta: case.beta[bin], azimuth_deg };
    mueller(&stack, wave).unwrap().r
}

/// A polariser on a reflector, on a film and on a cell, from air and from glass, at several inclinations and azimuths: what is below meets the
/// wave that it transmits, not one of its mean absorption, which would be 7e-3 of the light less. Oblique light is absorbed a little more in a
/// polariser of the extraordinary wave (2e-4).
#[test]
fn layers_below_a_polariser_see_the_wave_that_it_transmits() {
    let nm = 550.0;
    let same = |n: Complex64| [vec![n], vec![n], vec![n]];
    let of = |indices: [Vec<Complex64>; 3], slices: Vec<Slice>, coherent| Part {
        indices,
        slices: vec![slices],
        repeats: 1,
        rest: 0,
        coherent,
    };
    let slice = |azimuth_deg: f64, thickness_nm| Slice { axes: axes(azimuth_deg, 0.0, 0.0), thickness_nm };
    let film = of(same(1.9.into()), vec![slice(0.0, 120.0)], true);
    let liquid = [vec![1.6.into()], vec![1.5.into()], vec![1.5.into()]];
    let turned = (0..30).map(|k| slice(f64::from(k) * 3.0 + 40.0, 100.0)).collect();
    let cell = of(liquid, turned, true);
    let pane = of(same(Complex64::new(1.52, 1e-7)), vec![slice(0.0, 5e5)], false);
    for (thickness_um, extraordinary, tolerance) in
        [(20.0, false, 1.5e-4), (20.0, true, 2.5e-4), (100.0, true, 5e-5)]
    {
        let k = [0.98_f64, 0.98e-4].map(|t| -t.ln() * nm / (4e3 * PI * thickness_um));
        let [along, across] = k.map(|k| vec![Complex64::new(1.5, k)]);
        let indices = match extraordinary {
            true => [along, across.clone(), across],
            false => [across, along.clone(), along],
        };
        let polariser = of(indices, vec![slice(20.0, 1e3 * thickness_um)], false);
        for below in [vec![], vec![film.clone()], vec![cell.clone()], vec![pane.clone(), cell.clone()]] {
            for (front, sine) in [(1.0, 0.0), (1.5, 0.0), (1.5, 0.3), (1.0, 0.6)] {
                let mut parts = vec![polariser.clone()];
                parts.extend(below.iter().cloned());
                let case = Case {
                    wavelength_nm: vec![nm],
                    front: vec![front],
                    beta: vec![front * sine],
                    azimuths_deg: vec![0.0, 20.0, 75.0, 110.0],
                    parts,
                    back: vec![Complex64::new(0.06, 3.6)],
                    states: 1,
                };
                let stack =
                    SpectralStack::new(&case.wavelength_nm, &case.front, &case.parts, &case.back).unwrap();
                let mut found = [f64::NAN; 4];
                stack.reflectance(&case.beta, &case.azimuths_deg, &mut found).unwrap();
                for (azimuth_deg, found) in case.azimuths_deg.iter().zip(found) {
                    let expected = one(&case, *azimuth_deg, 0, 0);
                    assert!(
                        (found - expected).abs() < if sine == 0.0 { 1e-4 * expected } else { tolerance },
                        "{thickness_um} {extraordinary} {front} {sine} {azimuth_deg}: {found} {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn invalid_stacks_are_refused() {
    let index = vec![Complex64::new(1.5, 0.0)];
    let slice = Slice { axes: axes(0.0, 0.0, 0.0), thickness_nm: 100.0 };
    let part = |indices: [Vec<Complex64>; 3], slices, coherent| Part {
        indices,
        slices,
        repeats: 1,
        rest: 0,
        coherent,
    };
    let glass = [index.clone(), index.clone(), index.clone()];
    let new = |parts: &[Part]| SpectralStack::new(&[550.0], &[1.0], parts, &index).map(|_| ()).unwrap_err();
    assert!(new(&[part(glass.clone(), vec![vec![slice; 2]], false)]).to_string().contains("one slice"));
    let short = [index.clone(), index.clone(), vec![]];
    assert!(new(&[part(short, vec![vec![slice]], true)]).to_string().contains("indices"));
    let ok = SpectralStack::new(&[550.0], &[1.0], &[part(glass, vec![vec![slice]], true)], &index).unwrap();
    assert!(ok.reflectance(&[1.0], &[0.0], &mut [0.0]).is_err());
}
