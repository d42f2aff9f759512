//! The spread of a panel: without places it is what colours are computed from (the mean law); with places,
//! published and closed forms, and one of its forms against another.

use std::f64::consts::PI;
use std::sync::Arc;

use num_complex::Complex64;

use super::common::{everyday, mirror, panel as one_bin, sized, thick, view};
use crate::common::{Front, Panel};
use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_transport::adding::Kernel;
use papilio_transport::spatial::{Accuracy, LambertianReturn, LineSpread, PanelSpread, closed, displacement};
use papilio_transport::{AngularTable, Base, Cone, Diffuser, Field, Medium, Nodes, Reflector, Source, Top};

/// Two states, three wavelengths.
const BINS: usize = 3;

fn film() -> Base {
    let nodes = 33;
    let value = |node: usize, k: usize| {
        let cosine = node as f64 / (nodes - 1) as f64;
        0.5 + 0.4 * (7.0 * cosine + k as f64).sin()
    };
    let basis: Vec<f64> = (0..nodes).flat_map(|node| (0..2 * BINS).map(move |k| value(node, k))).collect();
    let table = AngularTable {
        nodes: Nodes::Cosines(nodes),
        basis: basis.into(),
        mixture: vec![1.0, 0.0, 0.3, 0.6],
        common: vec![0.01; BINS],
    };
    Base { reflector: Reflector::Specular(table), inactive_absorptance: vec![0.0; BINS].into() }
}

fn paper() -> Base {
    let reflectance = vec![0.7, 0.6, 0.5, 0.02, 0.03, 0.05];
    Base { reflector: Reflector::lambertian(reflectance, BINS), inactive_absorptance: vec![0.0; BINS].into() }
}

fn diffuser(lobe: Lobe, regular_fraction: f64) -> Top {
    Top::Diffuser(Diffuser { lobe, transmittance: vec![0.95, 0.9, 0.85].into(), regular_fraction })
}

fn sources() -> Vec<Source> {
    let map: Vec<f64> = (0..8 * 12).map(|k| f64::from(k * k % 17) + 1.0).collect();
    let edges: Vec<f64> = (0..=8).map(|k| 11.25 * f64::from(k)).collect();
    vec![
        Source::Diffuse,
        Source::Beam(Beta { x: -0.3, y: 0.25 }),
        Source::Disc(Cone::new(-12.0, 10.0, 1.0, 1.0)),
        Source::Field(Arc::new(Field::ring(20.0, 30.0).unwrap())),
        Source::Field(Arc::new(Field::new(&edges, 12, map).unwrap().0)),
    ]
}

/// Largest relative error of each source.
fn worst(panel: &Panel, view: Cone, lengths: &[f64], accuracy: Accuracy) -> Vec<f64> {
    worst_of(panel, (view, &sources()), lengths, accuracy)
}

fn worst_of(
    panel: &Panel,
    (view, sources): (Cone, &[Source]),
    lengths: &[f64],
    accuracy: Accuracy,
) -> Vec<f64> {
    let stack = thick(&panel.stack(), lengths);
    let mut kernel = Kernel::new(sized(2, 3));
    kernel.prepare(&stack, &[view], sources);
    let rho = kernel.seen(&stack, 0);
    let error = |(source, rho): (&Source, &papilio_transport::ReflectanceFactor)| {
        let panel = stack.panel().unwrap();
        let spread = PanelSpread::new(panel, &view, source, accuracy).unwrap();
        let found = transfer(&spread, panel, &[[0.0, 0.0]]);
        let most = rho.via_pixel.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        let errors = found.iter().zip(&rho.via_pixel).map(|(found, rho)| (found - rho).norm());
        errors.fold(0.0, f64::max) / most.max(1e-12)
    };
    sources.iter().zip(&rho).map(error).collect()
}

/// What is seen of a small modulation of the pixel about each of its states, `V(f) rho/(1 - rho A(f))`, as a
/// reflectance factor; at f = 0 that of the uniform state. Shape `[frequency][state][wavelength]`.
fn transfer(
    spread: &PanelSpread,
    panel: &papilio_transport::Panel,
    frequencies_per_mm: &[[f64; 2]],
) -> Vec<Complex64> {
    let (bins, len) = (panel.base.bins(), panel.base.states() * panel.base.bins());
    let mut out = vec![Complex64::ZERO; frequencies_per_mm.len() * len];
    let mut rho = vec![0.0; len];
    for part in spread.parts() {
        let medium = Medium::new(vec![part.index(); bins].into());
        part.each_sample(|sample| {
            panel.base.reflectance(sample.beta.squared(), &medium, &mut rho);
            for (f, out) in frequencies_per_mm.iter().zip(out.chunks_exact_mut(len)) {
                let turns = f[0] * sample.place_mm[0] + f[1] * sample.place_mm[1];
                let light = Complex64::from_polar(sample.weight, -2.0 * PI * turns);
                for (k, out) in out.iter_mut().enumerate() {
                    *out += light * (rho[k] * part.through[k % bins]);
                }
            }
        });
    }
    if let Reflector::Lambertian(rho) = &panel.base.reflector {
        for one in LambertianReturn::all(panel, ACCURACY).unwrap() {
            for (f, out) in frequencies_per_mm.iter().zip(out.chunks_exact_mut(len)) {
                let returned = one.at(f[0].hypot(f[1]));
                let of_one = (0..len).filter(|k| one.bins.contains(&(k % bins)));
                of_one.for_each(|k| out[k] /= 1.0 - returned * rho[k]);
            }
        }
    }
    out
}

fn shown(errors: &[f64]) -> String {
    errors.iter().map(|error| format!("{error:.1e} ")).collect()
}

const ACCURACY: Accuracy = Accuracy { digits: 15.0, most_per_mm: 4.0 };

#[test]
fn mean_of_bare_panels_is_todays_reflectance_in_all_orders() {
    let glass: Vec<f64> = vec![1.52, 1.5, 1.49];
    for top in [Top::IdealAr, Top::Fresnel(glass.clone().into())] {
        for base in [film(), paper()] {
            for front in [Front::none(), Front::of([(&[0.04, 0.05, 0.06][..], &[0.1; 3][..])])] {
                // What flat faces return to mirrors is not in the spread.
                if base.is_specular() && (!front.is_none() || matches!(top, Top::Fresnel(_))) {
                    continue;
                }
                for view in everyday(1, [Cone::new(12.0, 190.0, 2.0, 1.0), Cone::new(0.0, 0.0, 0.0, 1.0)]) {
                    let panel = Panel {
                        front: front.clone(),
                        top: top.clone(),
                        medium: Medium::new(glass.clone().into()),
                        base: base.clone(),
                        single_pass: false,
                    };
                    let errors = worst(&panel, view, &[0.3, 0.7], ACCURACY);
                    assert!(errors.iter().all(|error| *error < 1e-6), "{errors:?}");
                }
            }
        }
    }
}

#[test]
fn mean_under_a_diffuser_is_todays_first_order() {
    let lobes = [0.2, 0.05667].map(|width| Lobe::KCorrelation { width });
    for lobe in everyday(2, [lobes[0], Lobe::Lambertian, lobes[1]]) {
        for (regular, glass) in [(0.0, vec![1.5; 3]), (0.2, vec![1.52, 1.5, 1.49])] {
            for base in [film(), paper()] {
                let is_slow = regular > 0.0 && base.is_specular();
                for view in everyday(1, [Cone::new(30.0, 20.0, 1.5, 1.0), Cone::new(0.0, 0.0, 0.0, 1.0)]) {
                    let panel = Panel {
                        front: Front::none(),
                        top: diffuser(lobe, regular),
                        medium: Medium::new(glass.clone().into()),
                        base: base.clone(),
                        single_pass: false,
                    };
                    // Fields with unscattered light take *adding* long, and seconds under a narrow lobe.
                    let sources = if sized(is_slow, is_slow && lobe != lobes[0]) {
                        &sources()[..3]
                    } else {
                        &sources()[..]
                    };
                    let errors = worst_of(&panel, (view, sources), &[0.7], ACCURACY);
                    // Over a field, a mirror-like pixel has one reflectance for each bundle of directions; in a
                    // wide lobe each direction is one.
                    let has_bundles = base.is_specular() && view.half_angle() > 0.0;
                    let most = if has_bundles { sized(3e-7, 3e-5) } else { 3e-7 };
                    assert!(
                        errors.iter().all(|error| *error < most),
                        "{lobe:?} {regular}: {}",
                        shown(&errors)
                    );
                }
            }
        }
    }
}

/// A lobe that is much narrower than the pixels are wide.
#[test]
fn mean_under_a_narrow_lobe_is_todays_first_order() {
    let panel = Panel {
        front: Front::none(),
        top: diffuser(Lobe::KCorrelation { width: 1e-3 }, 0.0),
        medium: Medium::new(vec![1.5; BINS].into()),
        base: film(),
        single_pass: false,
    };
    // A field of view that is wider than the lobe has many directions.
    let seen = Cone::new(30.0, 20.0, sized(0.02, 0.1), 1.0);
    let errors = worst_of(&panel, (seen, &sources()[..sized(2, 3)]), &[0.7], ACCURACY);
    assert!(errors.iter().all(|error| *error < 1e-6), "{}", shown(&errors));
}

/// All orders: a Lambertian pixel under a diffuser and a front, and mirror-like ones where the front reflects
/// nothing.
#[test]
fn mean_of_paper_under_a_diffuser_and_a_front_is_todays_reflectance_in_all_orders() {
    for regular in everyday(1, [0.3, 0.0]) {
        let panel = Panel {
            front: Front::of([(&[0.04, 0.05, 0.06][..], &[0.1; 3][..])]),
            top: diffuser(Lobe::KCorrelation { width: 0.05667 }, regular),
            medium: Medium::new(vec![1.5; BINS].into()),
            base: paper(),
            single_pass: false,
        };
        let errors = worst(&panel, Cone::new(20.0, 0.0, 0.0, 1.0), &[0.3, 0.7], ACCURACY);
        assert!(errors.iter().all(|error| *error < 2e-6), "{errors:?}");
    }
}

fn h78(width: f64) -> Top {
    let lobe = Lobe::KCorrelation { width };
    Top::Diffuser(Diffuser { lobe, transmittance: vec![1.0].into(), regular_fraction: 0.0 })
}

fn spread(panel: &Panel, view: Cone, source: &Source, glass_mm: f64, digits: f64) -> PanelSpread {
    let accuracy = Accuracy { digits, most_per_mm: 10.0 };
    let stack = thick(&panel.stack(), &[glass_mm]);
    PanelSpread::new(stack.panel().unwrap(), &view, source, accuracy).unwrap()
}

/// H78 (b = 0.05667) over 0.5 mm of glass of index 1.5: the integral by another program.
#[test]
fn modulation_of_a_lobe_is_known() {
    let panel = one_bin(h78(0.05667), mirror(1.0));
    let beam = Source::Beam(Beta { x: 0.0, y: 0.0 });
    for (source, expected) in [
        (Source::Diffuse, [1.0, 0.939_069_3, 0.834_398_8, 0.586_456_5, 0.526_884_3, 0.324_349_2]),
        (beam, [1.0, 0.996_48, 0.986_26, 0.922_89, 0.896_46, 0.754_55]),
    ] {
        let spread = spread(&panel, view(0.0), &source, 0.5, 12.0);
        for axis in 0..2 {
            let frequencies =
                [0.0, 1.0, 2.0, 5.0, 5.9055, 10.0].map(|f| if axis == 0 { [f, 0.0] } else { [0.0, f] });
            let found = transfer(&spread, panel.stack().panel().unwrap(), &frequencies);
            for (value, expected) in found.iter().zip(expected) {
                assert!((value / found[0] - expected).norm() < 1e-5, "{value} {expected}");
            }
        }
    }
}

#[test]
fn oblique_views_shift_the_image() {
    let panel = one_bin(h78(0.05667), mirror(1.0));
    for (theta, expected_um) in [(0.0, 0.0), (20.0, 117.09), (40.0, 237.14), (60.0, 353.55)] {
        let shift_mm = displacement(view(theta).axis_towards(), 0.5, 1.5);
        assert!((1e3 * shift_mm[0] - expected_um).abs() < 6e-3);
        // Places are relative to it: the lobe is about 0.
        let spread = spread(&panel, view(theta), &Source::Diffuse, 0.5, 6.0);
        let peaks = spread.point_spread(&spread.parts()[0]).peaks().to_vec();
        assert!(peaks.iter().all(|peak| peak.at_mm == [0.0; 2]), "{peaks:?}");
    }
}

/// Paper of 0.6 under 1 mm of bare glass: patches, and the transfer of small signals.
#[test]
fn paper_under_glass_has_known_transfer() {
    for (rho, patch) in [(0.6, 0.362_048), (0.03, 0.011_837)] {
        let panel = one_bin(Top::Fresnel(vec![1.5].into()), super::common::lambertian(rho));
        let spread = spread(&panel, view(0.0), &Source::Diffuse, 1.0, 14.0);
        let found = found(&spread, &panel, 0.0);
        assert!((found.re - patch).abs() < 1e-6, "{found}");
        if rho == 0.6 {
            for (f, expected) in [
                (0.02, 0.9454),
                (0.05, 0.8298),
                (0.1, 0.7024),
                (0.2, 0.6202),
                (0.3, 0.6235),
                (0.5, 0.6519),
                (1.0, 0.6439),
                (2.0, 0.6415),
            ] {
                let modulation = self::found(&spread, &panel, f) / found;
                assert!((modulation - expected).norm() < 6e-5, "{f}: {modulation}");
            }
        }
    }
}

fn found(spread: &PanelSpread, panel: &Panel, f: f64) -> Complex64 {
    transfer(spread, thick(&panel.stack(), &[1.0]).panel().unwrap(), &[[f, 0.0]])[0]
}

/// A front at a distance adds halos; close to the face it is part of it.
#[test]
fn gap_of_the_front_moves_its_halo() {
    let panel = Panel {
        front: super::common::front(&[(0.1, 0.0)]),
        ..one_bin(Top::Fresnel(vec![1.5].into()), super::common::lambertian(0.6))
    };
    let accuracy = Accuracy { digits: 14.0, most_per_mm: 3.0 };
    let new = |gap| {
        let stack = thick(&panel.stack(), &[gap, 1.0]);
        LambertianReturn::all(stack.panel().unwrap(), accuracy).unwrap()
    };
    let (none, small, wide) = (new(0.0), new(1e-6), new(2.0));
    for f in [0.0, 0.05, 0.3, 1.0] {
        let [none, small, wide] = [&none, &small, &wide].map(|all| all[0].at(f));
        assert!((none - small).abs() < 1e-5, "{f}: {none} {small}");
        if f == 0.0 {
            assert!((none - wide).abs() < 1e-9, "{none} {wide}");
        }
        if f == 0.05 {
            assert!((none - wide).abs() > 1e-2, "{none} {wide}");
        }
    }
}

/// Light of each cell between these borders over all light, for a pixel of this reflectance as a function of
/// `|beta|^2`.
fn fractions_of_cells(spread: &PanelSpread, borders: [&[f64]; 2], rho: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut cells = vec![0.0; (borders[0].len() - 1) * (borders[1].len() - 1)];
    let mut all = 0.0;
    for part in spread.parts() {
        let sums = spread.point_spread(part).cells(borders[0], borders[1]).sums(&rho);
        cells.iter_mut().zip(sums).for_each(|(sum, more)| *sum += part.through[0] * more);
        part.each_sample(|sample| all += part.through[0] * sample.weight * rho(sample.beta.squared()));
    }
    cells.into_iter().map(|cell| cell / all).collect()
}

/// Borders of so many cells about the view's own ray.
fn borders(count: usize, cell_mm: f64) -> Vec<f64> {
    (0..=count).map(|k| (k as f64 - 0.5 * count as f64) * cell_mm).collect()
}

/// A narrow lobe has the closed forms of small angles.
#[test]
fn cells_of_a_narrow_lobe_have_closed_forms() {
    let b = 2e-3;
    let panel = one_bin(h78(b), mirror(1.0));
    let spread = spread(&panel, view(0.0), &Source::Diffuse, 0.5, 14.0);
    let c = b * 0.5 / 1.5;
    for cell_mm in [0.4 * c, 40.0 * c] {
        let [x, y] = [borders(6, cell_mm), borders(5, cell_mm)];
        for (k, found) in fractions_of_cells(&spread, [&x, &y], |_| 1.0).into_iter().enumerate() {
            let [column, row] = [k % 6, k / 6];
            let expected = closed::lobe_from_rectangle([x[column], x[column + 1]], [y[row], y[row + 1]], c);
            // The edge of the hemisphere and the tangent change tails by about b.
            assert!((found - expected).abs() < 2.0 * b * expected + 3e-6, "{k}: {found} {expected}");
        }
    }
}

/// The light of a square does not depend on how many cells it has, nor on the accuracy.
#[test]
fn squares_do_not_depend_on_their_cells() {
    let beam = Source::Beam(Beta { x: 0.2, y: -0.1 });
    let film = |beta_squared: f64| 0.5 + 0.3 * (5.0 * (1.0 - beta_squared / 2.25).sqrt()).sin();
    for (source, theta) in [(Source::Diffuse, 0.0), (Source::Diffuse, 50.0), (beam, 15.0)] {
        let panel = one_bin(h78(0.05667), mirror(1.0));
        let [coarse, fine] = [10.0, 15.0].map(|digits| spread(&panel, view(theta), &source, 0.5, digits));
        let [many, one] = [borders(16, 0.02), borders(1, 0.32)];
        let sum: f64 = fractions_of_cells(&coarse, [&many, &many], film).iter().sum();
        let [single] = fractions_of_cells(&fine, [&one, &one], film)[..] else { panic!() };
        assert!((sum - single).abs() < 1e-5, "{theta}: {sum} {single}");
    }
}

/// A view of 5 deg through a lobe that is much narrower takes bounded work.
#[test]
fn lobes_much_narrower_than_the_view_take_few_samples() {
    let panel = one_bin(h78(1e-6), super::common::lambertian(0.6));
    let spread = spread(&panel, Cone::new(0.0, 0.0, 5.0, 1.0), &Source::Diffuse, 0.5, 6.0);
    let mut count = 0;
    spread.parts().iter().for_each(|part| part.each_sample(|_| count += 1));
    assert!(count < 10_000_000, "{count}");
}

/// Fields of 10 and 15 deg through lobes: sums over 240 directions of view and 1e5 of the glass by numpy, in
/// which each direction has places relative to its own ray. (Relative to that of the middle, the first would
/// be 0.804, the second 0.922.)
#[test]
fn wide_views_through_lobes_have_known_transfers() {
    let normal = Cone::new(0.0, 0.0, 5.0, 1.0);
    let (oblique, widest) = (Cone::new(45.0, 0.0, 5.0, 1.0), Cone::new(30.0, 0.0, 7.5, 1.0));
    for (width, view, f, known) in [
        (0.02, normal, [3.937_008, 0.0], [0.858_667, 0.0]),
        (0.002, normal, [3.937_008, 0.0], [0.984_875, 0.0]),
        (0.002, normal, [2.0, 0.0], [0.992_859, 0.0]),
        (0.02, oblique, [4.0, 0.0], [0.795_582, -0.000_150]),
        (0.02, oblique, [3.0, 2.0], [0.826_192, -0.000_646]),
        (0.056_67, oblique, [4.0, 0.0], [0.523_934, 0.007_722]),
        (0.056_67, oblique, [0.0, 4.0], [0.609_467, 0.0]),
        (0.02, widest, [4.0, 0.0], [0.829_888, -0.000_589]),
        (0.056_67, widest, [4.0, 0.0], [0.590_091, 0.003_414]),
        (0.056_67, widest, [3.0, 2.0], [0.634_349, 0.002_146]),
    ] {
        let panel = one_bin(h78(width), super::common::lambertian(0.6));
        assert_known(&spread(&panel, view, &Source::Diffuse, 0.5, 13.0), &panel, f, known);
    }
    // A double image, one of which is at as many places as there are directions of view.
    let beam = Source::Beam(Beta { x: 0.1, y: 0.05 });
    for (f, known) in [
        ([4.0, 0.0], [0.872_260, 0.260_262]),
        ([0.0, 4.0], [0.900_754, -0.178_535]),
        ([2.0, -1.0], [0.949_839, 0.186_985]),
    ] {
        let panel = one_bin(h78(0.056_67), mirror(1.0));
        assert_known(&spread(&panel, Cone::new(10.0, 0.0, 2.5, 1.0), &beam, 0.5, 13.0), &panel, f, known);
    }
}

/// The transfer at a frequency relative to all light, by sums over directions and by places.
fn assert_known(spread: &PanelSpread, panel: &Panel, f: [f64; 2], [re, im]: [f64; 2]) {
    let known = Complex64::new(re, im);
    let all = transfer(spread, panel.stack().panel().unwrap(), &[[0.0; 2], f]);
    // Sums over directions do not resolve phases of grazing light, beyond two thicknesses.
    assert!((all[1] / all[0] - known).norm() < 1e-4, "{f:?}: {} {known}", all[1] / all[0]);
    let Some(axis) = (0..2).find(|axis| f[1 - axis] == 0.0) else { return };
    let mut sums = [[Complex64::ZERO]; 2];
    for part in spread.parts() {
        let line = LineSpread::new(&spread.point_spread(part), axis, 1, |_, rho| rho[0] = part.through[0]);
        line.add_transfer(0.0, &mut sums[0]);
        line.add_transfer(f[axis], &mut sums[1]);
    }
    let found = sums[1][0] / sums[0][0];
    assert!((found - known).norm() < 3e-5, "{f:?} by places: {found} {known}");
}

/// Rings about the ray of a view along the normal hold all of the light of a sky that is brighter on one
/// side: the density is taken around each of them, not in one direction.
#[test]
fn rings_hold_all_light_of_an_asymmetric_sky() {
    let lobe = Lobe::KCorrelation { width: 0.1 };
    let top = Top::Diffuser(Diffuser { lobe, transmittance: vec![1.0].into(), regular_fraction: 0.0 });
    let panel = one_bin(top, mirror(1.0));
    let stack = thick(&panel.stack(), &[0.5]);
    let panel = stack.panel().unwrap();
    let accuracy = Accuracy { digits: 9.0, ..ACCURACY };
    for source in &sources()[3..] {
        let spread = PanelSpread::new(panel, &view(0.0), source, accuracy).unwrap();
        let all = transfer(&spread, panel, &[[0.0, 0.0]])[0].re;
        let found: f64 = spread
            .parts()
            .iter()
            .map(|part| {
                let rings = spread.point_spread(part).rings(&[0.03, 0.1, 0.4]);
                let sums = rings.sums_of(1, |_, value| value[0] = 1.0);
                part.through[0] * sums[0].iter().sum::<f64>()
            })
            .sum();
        assert!((found / all - 1.0).abs() < 2e-3, "{found} {all}");
    }
}

/// Two and three partial mirrors above a lobe, seen obliquely: light that goes to and fro between them is displaced by twice the way
/// through the air each time. The sum of all orders multiplies the transfer: of two, `(1 - q)/(1 - q z)` with `q = R r` and
/// `z = exp(-2 pi i f 2 g tan(theta))`; of three, `r` and `t` of the lower two are such a sum themselves.
#[test]
fn fronts_that_are_apart_multiply_the_transfer_by_all_orders() {
    let (f, theta) = (1.7, 35.0_f64.to_radians());
    let z = |gap_mm: f64| Complex64::cis(-2.0 * PI * f * 2.0 * gap_mm * theta.tan());
    let [upper, middle, lower] = [0.4, 0.3, 0.2];
    // Of the light that leaves: all orders over their sum at f = 0.
    let two = |z: Complex64| (1.0 - middle * lower) / (1.0 - middle * lower * z);
    // Above the lowest two, `middle` seen from above has `lower` at twice its distance behind it.
    let three = |z1: Complex64, z2: Complex64| {
        let again = 1.0 / (1.0 - middle * lower * z2);
        let through = (1.0 - middle) * (1.0 - lower) * again;
        let from_above = middle + (1.0 - middle).powi(2) * lower * z2 * again;
        (1.0 - upper) * through / (1.0 - upper * from_above * z1)
    };
    // The component without a reflection absorbs a tenth each time that light passes.
    let of_three = three(0.81 * z(0.5), z(0.3)) / three(0.81 * Complex64::ONE, Complex64::ONE);
    let accuracy = Accuracy { digits: 11.0, most_per_mm: 2.0 };
    for base in [mirror(0.9), super::common::lambertian(0.6)] {
        for source in everyday(1, [Source::Beam(Beta { x: -0.3, y: 0.25 }), Source::Diffuse]) {
            let alone = one_bin(h78(0.05667), base.clone());
            let found = |components: &[(f64, f64)], lengths: &[f64]| {
                let panel = Panel { front: super::common::front(components), ..alone.clone() };
                let stack = thick(&panel.stack(), lengths);
                // What fronts return is not a part of the spread.
                let mut panel = stack.panel().unwrap().clone();
                panel.front.reflectance_below = vec![0.0].into();
                let spread = PanelSpread::new(&panel, &view(35.0), &source, accuracy).unwrap();
                let [zero, at_f] = [0.0, f].map(|f| transfer(&spread, &panel, &[[f, 0.0]])[0]);
                // Along the line of another axis nothing moves.
                let line = |axis: usize| {
                    let mut sums = [Complex64::ZERO];
                    for part in spread.parts() {
                        let points = spread.point_spread(part);
                        let line = LineSpread::new(&points, axis, 1, |_, rho| rho[0] = part.through[0]);
                        line.add_transfer(f, &mut sums);
                    }
                    sums[0]
                };
                [at_f / zero, line(0), line(1)]
            };
            let one = found(&[(upper, 0.0)], &[0.8, 0.4]);
            let [both, all] = [
                found(&[(middle, 0.0), (lower, 0.0)], &[0.5, 0.8, 0.4]),
                found(&[(upper, 0.0), (0.0, 0.1), (middle, 0.0), (lower, 0.0)], &[0.2, 0.3, 0.3, 0.8, 0.4]),
            ];
            for (found, expected) in [(both, two(z(0.5))), (all, of_three)] {
                assert!((found[0] / one[0] - expected).norm() < 5e-5, "{} {expected}", found[0] / one[0]);
                let ratio = (found[1] / found[2]) / (one[1] / one[2]);
                assert!((ratio - expected).norm() < 5e-5, "{ratio} {expected}");
            }
        }
    }
}

/// Two mirrors of 0.3 whose images are a pixel apart: of the light of every second pixel, order k shows the pixels of its own kind
/// where k is even. The geometric series has `1/(1 + q)` of one kind and `q/(1 + q)` of the other, with `q = 0.09`.
#[test]
fn images_between_fronts_show_every_second_pixel_in_turn() {
    let (pixel_mm, theta) = (0.25, 40.0_f64.to_radians());
    let gap_mm = 0.5 * pixel_mm / theta.tan();
    let panel = Panel { front: super::common::front(&[(0.3, 0.0); 2]), ..one_bin(h78(1e-5), mirror(0.9)) };
    let stack = thick(&panel.stack(), &[gap_mm, 3.0, 0.05]);
    let accuracy = Accuracy { digits: 16.0, most_per_mm: 4.0 };
    let spread = PanelSpread::new(stack.panel().unwrap(), &view(40.0), &Source::Diffuse, accuracy).unwrap();
    let borders: Vec<f64> = (-3..40).map(|k| (f64::from(k) + 0.5) * pixel_mm).collect();
    let mut kinds = [0.0; 2];
    for part in spread.parts() {
        let strips = spread.point_spread(part).strips(0, &borders).sums(|_| part.through[0]);
        strips.iter().enumerate().for_each(|(k, light)| kinds[(k + 1) % 2] += light);
    }
    let odd = kinds[1] / (kinds[0] + kinds[1]);
    assert!((odd - 0.09 / 1.09).abs() < 1e-4, "{odd}");
}

/// What two fronts return is the sum over the numbers of trips between them, each from its own height as from a single mirror.
#[test]
fn fronts_that_are_apart_return_light_from_all_heights() {
    let [upper, lower] = [0.4, 0.25];
    let [upper_mm, lower_mm, glass_mm] = [1.5, 0.4, 0.3];
    let alone = one_bin(h78(0.05667), super::common::lambertian(0.6));
    let returned = |components: &[(f64, f64)], lengths: &[f64]| {
        let panel = Panel { front: super::common::front(components), ..alone.clone() };
        let stack = thick(&panel.stack(), lengths);
        let accuracy = Accuracy { digits: 8.0, most_per_mm: 1.0 };
        LambertianReturn::all(stack.panel().unwrap(), accuracy).unwrap().swap_remove(0)
    };
    let found = returned(&[(upper, 0.0), (lower, 0.0)], &[upper_mm, lower_mm, glass_mm]);
    let heights = (0..4).map(|trips| lower_mm + f64::from(trips) * upper_mm);
    let mirrors: Vec<_> = heights.map(|mm| returned(&[(1.0, 0.0)], &[mm, glass_mm])).collect();
    for f in [0.0, 0.05, 0.3] {
        let mut part = lower;
        let mut expected = 0.0;
        for (trips, mirror) in mirrors.iter().enumerate() {
            expected += part * mirror.at(f);
            part = (1.0 - lower).powi(2) * upper * (upper * lower).powi(trips as i32);
        }
        // The fifth order.
        assert!((found.at(f) - expected).abs() < 3e-4, "{f}: {} {expected}", found.at(f));
    }
    let bright = [(0.99, 0.0); 2];
    let stack = thick(&Panel { front: super::common::front(&bright), ..alone }.stack(), &[1.0, 1.0, 1.0]);
    assert_eq!(
        LambertianReturn::all(stack.panel().unwrap(), ACCURACY).unwrap_err(),
        papilio_transport::spatial::SpreadError::ManyWays
    );
}
