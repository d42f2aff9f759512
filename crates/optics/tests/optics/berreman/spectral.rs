//! The fast implementation equals the reference, in every combination of layers, states and thick slabs.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_optics::berreman::{
    AnisotropicLayer, Dielectric, Mueller, Part, Slice, SpectralStack, SpectralWaves, Stack, Wave, axes,
    jones, mueller,
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
        // A pane, a retarder, a polariser.
        let [birefringence, k] = dice.of([[0.0, 0.0], [0.01, 0.0], [0.2, 0.0], [0.01, 2e-2], [0.05, 0.4]]);
        let third = dice.of([0.0, 0.3]);
        let more = |share: f64| {
            indices[0].iter().map(|n| n + Complex64::new(share * birefringence, share * k)).collect()
        };
        indices = [more(1.0), more(0.0), more(third)];
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
            assert!((found - expected).abs() < 1e-10, "{state} {bin}: {found} {expected}");
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
                        assert!((found - expected).abs() < 1e-10, "{row} {column} {bin}: {found} {expected}");
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

/// Polarisers, from coated films to ideal thick ones, on a reflector, on a film, on a cell and on a pane: what their faces reflect of both of their waves is
/// averaged over the phase of the layer, by a sum in this test. Waves of the azimuth of their axis, or across it, are p and s in them.
#[test]
fn polarisers_equal_the_mean_over_the_phase_of_their_layer() {
    let nm = 550.0;
    let slice = |azimuth_deg: f64, thickness_nm| Slice { axes: axes(azimuth_deg, 0.0, 0.0), thickness_nm };
    let of = |indices: [Complex64; 3], slices: Vec<Slice>, coherent| {
        let indices = indices.map(|index| vec![index]);
        Part { indices, slices: vec![slices], repeats: 1, rest: 0, coherent }
    };
    let film = of([1.9.into(); 3], vec![slice(0.0, 120.0)], true);
    let turned = (0..30).map(|k| slice(f64::from(k) * 3.0 + 40.0, 100.0)).collect();
    let cell = of([1.6.into(), 1.5.into(), 1.5.into()], turned, true);
    let back = Complex64::new(0.06, 3.6);
    for (thickness_um, extraordinary) in [(1.0, false), (1.0, true), (20.0, false), (20.0, true)] {
        let k = [0.88_f64, 0.88e-4].map(|t| -t.ln() * nm / (4e3 * PI * thickness_um));
        let [along, across] = k.map(|k| Complex64::new(1.5, k));
        let [e, o] = if extraordinary { [along, across] } else { [across, along] };
        let polariser = of([e, o, o], vec![slice(20.0, 1e3 * thickness_um)], false);
        for below in [vec![], vec![film.clone()], vec![cell.clone()]] {
            for (front, sine, across) in
                [(1.5, 0.0, false), (1.5, 0.5, false), (1.5, 0.5, true), (1.0, 0.6, false)]
            {
                let azimuth_deg = if across { 110.0 } else { 20.0 };
                let beta: f64 = front * sine;
                let parts: Vec<Part> = [polariser.clone()].into_iter().chain(below.iter().cloned()).collect();
                let stack = SpectralStack::new(&[nm], &[front], &parts, &[back]).unwrap();
                let mut found = [f64::NAN];
                stack.reflectance(&[beta], &[azimuth_deg], &mut found).unwrap();
                let layers = below.iter().flat_map(|part| {
                    part.slices[0].iter().map(|slice| AnisotropicLayer {
                        dielectric: Dielectric::biaxial(part.indices.each_ref().map(|n| n[0]), slice.axes)
                            .unwrap(),
                        thickness_nm: slice.thickness_nm,
                        coherent: true,
                    })
                });
                let stack = Stack { front, layers: layers.collect(), back };
                let r = jones(&stack, Wave { wavelength_nm: nm, beta, azimuth_deg }).unwrap().r;
                // p and s in the polariser: the wave vector along the normal and the admittance, H/E of p and E/H of s, as in front of it.
                let (e, o, square) = (e * e, o * o, beta * beta);
                let waves = if across {
                    let [p, s] = [(o - square).sqrt(), (e - square).sqrt()];
                    [(p, o / p), (s, s.inv())]
                } else {
                    let [p, s] = [(e * (1.0 - square / o)).sqrt(), (o - square).sqrt()];
                    [(p, e / p), (s, s.inv())]
                };
                let q = (front * front - square).sqrt();
                let faces = [(waves[0].1, front * front / q), (waves[1].1, 1.0 / q)]
                    .map(|(own, front)| (own - front) / (own + front));
                let (count, mut sum) = (64, 0.0);
                for step in 0..count {
                    let phase = |q: Complex64| {
                        (Complex64::I
                            * (2.0 * PI / nm * 1e3 * thickness_um * q
                                + PI * f64::from(step) / f64::from(count)))
                        .exp()
                    };
                    let [p, s] = [0, 1].map(|k| {
                        let (f, e) = (faces[k], phase(waves[k].0));
                        let over = (1.0 - f * f * e * e).inv();
                        [f * (1.0 - e * e) * over, (1.0 - f * f) * e * over]
                    });
                    // r_slab + t r (1 - r_slab r)^-1 t.
                    let open =
                        [[1.0 - p[0] * r[0][0], -p[0] * r[0][1]], [-s[0] * r[1][0], 1.0 - s[0] * r[1][1]]];
                    let over = (open[0][0] * open[1][1] - open[0][1] * open[1][0]).inv();
                    let inverse =
                        [[open[1][1] * over, -open[0][1] * over], [-open[1][0] * over, open[0][0] * over]];
                    for (i, k) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                        let [row, column] = [i, k].map(|i| if i == 0 { p } else { s });
                        let inner: Complex64 = (0..2).map(|j| r[i][j] * inverse[j][k]).sum();
                        let own = if i == k { row[0] } else { Complex64::ZERO };
                        sum += (own + row[1] * inner * column[1]).norm_sqr();
                    }
                }
                let expected = 0.5 * sum / f64::from(count);
                assert!(
                    (found[0] - expected).abs() < 1e-10,
                    "{thickness_um} {extraordinary} {front} {sine} {across}: {} {expected}",
                    found[0]
                );
            }
        }
    }
}

/// Waves along a slab, which it does not cross: all light returns.
#[test]
fn waves_along_a_slab_of_air_are_reflected() {
    let of = |index: f64, thickness_nm, coherent| Part {
        indices: [vec![index.into(); 3], vec![index.into(); 3], vec![index.into(); 3]],
        slices: vec![vec![Slice { axes: axes(0.0, 0.0, 0.0), thickness_nm }]],
        repeats: 1,
        rest: 0,
        coherent,
    };
    let nm = [450.0, 550.0, 650.0];
    let metal = vec![Complex64::new(0.05, 3.6); 3];
    let air = vec![Complex64::new(1.0, 0.0); 3];
    let film = of(1.6, 2000.0, true);
    let slab = of(1.0, 8e5, false);
    for (parts, back) in [
        (vec![slab.clone(), film.clone()], &metal),
        (vec![film.clone(), slab.clone()], &metal),
        (vec![slab.clone()], &air),
        (vec![slab.clone(), slab], &metal),
        (vec![film], &air),
        (vec![], &air),
    ] {
        let stack = SpectralStack::new(&nm, &[1.5; 3], &parts, back).unwrap();
        let mut found = [f64::NAN; 3];
        stack.reflectance(&[1.0; 3], &[30.0], &mut found).unwrap();
        assert!(found.iter().all(|r| (r - 1.0).abs() < 1e-6), "{parts:?}: {found:?}");
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
