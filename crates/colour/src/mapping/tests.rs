//! Tests of gamut mapping.

use papilio_testing::{Dice, laws};

use super::*;
use crate::{Surround, Viewing};

fn xyz([x, y, z]: [f64; 3]) -> Xyz {
    Xyz { x, y, z }
}

const ROOM: Viewing =
    Viewing { adapting_luminance_cd_m2: 30.0, background: 0.2, surround: Surround::Average };
const SPACES: [MapSpace; 2] = [MapSpace::Oklab, MapSpace::Cam16Ucs(ROOM)];
const INTENTS: [Intent; 5] =
    [Intent::Natural, Intent::Vivid, Intent::Relative, Intent::Absolute, Intent::Clip];
const PERFECT: Xyz = Xyz { x: 1.0, y: 1.0, z: 0.7 };

/// Mapping into these states, of which the first is black and the second white.
fn mapping(states: &[Xyz], intent: Intent, space: MapSpace) -> GamutMapping {
    let display = DisplayColours { white: states[1], black: states[0], perfect_white: PERFECT };
    GamutMapping::new(StateHull::new(states).unwrap(), display, SourceSpace::Srgb, intent, space).unwrap()
}

/// Black, white, yellow, red, blue and green; black and white are neutral in this light.
fn inks() -> Vec<Xyz> {
    [
        [0.03, 0.03, 0.021],
        [0.6, 0.6, 0.42],
        [0.45, 0.5, 0.06],
        [0.17, 0.12, 0.05],
        [0.08, 0.08, 0.2],
        [0.1, 0.17, 0.08],
    ]
    .map(xyz)
    .to_vec()
}

/// Random states below a white, with 1 to 3 dimensions; colours may be beyond the source space.
fn random_case(dice: &mut Dice) -> (Vec<Xyz>, Vec<[f64; 3]>) {
    let mut point = |low, high| xyz([0, 1, 2].map(|_| dice.between(low, high)));
    let (black, white) = (point(0.001, 0.1), point(0.4, 0.9));
    let two = point(0.02, 0.5);
    let states = match dice.below(4) {
        0 => vec![black, white, black * 0.25 + white * 0.75],
        1 => vec![black, white, two, (black + two) * 0.5],
        _ => {
            let others = dice.several(1..=8, |dice| xyz([0, 1, 2].map(|_| dice.between(0.01, 0.8))));
            [black, white].into_iter().chain(others).collect()
        }
    };
    let colour = |dice: &mut Dice| {
        let one_of_two = dice.one_in(2);
        [0, 1, 2].map(|_| if one_of_two { dice.throw() } else { dice.between(-0.3, 1.5) })
    };
    (states, dice.several(8..=8, colour))
}

#[test]
fn mapped_colours_are_in_the_hull_and_white_and_black_are_exact() {
    laws(60, random_case, |(states, colours)| {
        for (intent, space) in INTENTS.into_iter().flat_map(|intent| SPACES.map(|space| (intent, space))) {
            let mapping = mapping(states, intent, space);
            for rgb in colours.iter().copied().chain([[0.0; 3], [1.0; 3], [f64::NAN; 3], [1e9, 0.0, 0.0]]) {
                let mapped = mapping.map(rgb);
                assert!(mapping.hull().contains(mapped), "{intent:?} {space:?} {rgb:?}: {mapped:?}");
                let target = mapping.target(rgb);
                if !matches!(intent, Intent::Natural | Intent::Vivid) && mapping.hull().contains(target) {
                    assert_eq!(mapped, target);
                }
            }
            if intent != Intent::Absolute {
                assert!(mapping.map([1.0; 3]).distance(states[1]) < 1e-8, "{intent:?} {space:?}");
                assert!(mapping.map([0.0; 3]).distance(states[0]) < 1e-8, "{intent:?} {space:?}");
            }
        }
    });
}

#[test]
fn colours_outside_keep_lightness_and_hue() {
    for space in SPACES {
        let states = inks();
        let mapping = mapping(&states, Intent::Relative, space);
        let prepared = Space::new(space, states[1]).unwrap();
        let mut kept = 0;
        for rgb in [[0.8, 0.1, 0.1], [0.1, 0.6, 0.2], [0.05, 0.05, 0.6], [0.1, 0.6, 0.6], [0.2, 0.02, 0.2]] {
            let [target, mapped] =
                [mapping.target(rgb), mapping.map(rgb)].map(|one| prepared.coordinates(one));
            let size = prepared.coordinates(states[1])[0];
            assert!((target[0] - mapped[0]).abs() < 1e-4 * size, "{rgb:?}: {target:?} {mapped:?}");
            let [chroma, before] = [mapped, target].map(|[_, a, b]| a.hypot(b));
            assert!(chroma < 0.99 * before, "{rgb:?} is inside");
            let across = (target[1] * mapped[2] - target[2] * mapped[1]) / before;
            assert!(across.abs() < 2e-4 * size, "{rgb:?}: {across}");
            kept += usize::from(chroma > 0.05 * size);
        }
        assert!(kept >= 3, "{kept}");
    }
}

/// No mixture of the states, of a fine grid of them, is closer: also of flat hulls, and of colours far
/// outside.
#[test]
fn closest_colours_are_those_of_all_mixtures() {
    let states = inks();
    let cases = [&states[..], &states[..3], &states[..2], &[states[0], states[1], states[3], states[5]]];
    for (states, space) in cases.into_iter().flat_map(|states| SPACES.map(|space| (states, space))) {
        let mapping = mapping(states, Intent::Natural, space);
        let prepared = Space::new(space, states[1]).unwrap();
        let unit = prepared.coordinates(states[1])[0];
        let mixtures = mixtures(states);
        // A difference across the hue counts three times, in a plane twice.
        let weight = if states.len() > 3 { 9.0 } else { 4.0 };
        let mut worst: f64 = 0.0;
        let rgb = [[1.0, 0.3, 0.02], [0.05, 0.05, 0.9], [0.0, 0.8, 0.8], [0.9, 0.0, 0.6], [0.02, 0.3, 0.01]];
        for rgb in rgb {
            let target = mapping.appearance(SourceSpace::Srgb.xyz(rgb));
            let chroma = target[1].hypot(target[2]);
            let square = |colour: Xyz| {
                let [l, a, b] = prepared.coordinates(colour).map(|one| one / unit);
                let along = (a * target[1] + b * target[2]) / chroma - chroma;
                let across = (b * target[1] - a * target[2]) / chroma;
                (l - target[0]).powi(2) + along * along + weight * across * across
            };
            let found = mapping.closest(target);
            assert!(mapping.hull().contains(found));
            let best = mixtures.iter().map(|one| square(*one)).fold(f64::INFINITY, f64::min);
            worst = worst.max(square(found).sqrt() - best.sqrt());
        }
        assert!(worst < 1e-4, "{} states {space:?}: {worst}", states.len());
    }
}

/// Mixtures of up to three states in steps of a 48th, which are the faces of a hull and some planes inside.
fn mixtures(states: &[Xyz]) -> Vec<Xyz> {
    let count = states.len();
    let mut all = Vec::new();
    for (i, j, k) in (0..count).flat_map(|i| (0..=i).flat_map(move |j| (0..=j).map(move |k| (i, j, k)))) {
        for (p, q) in (0..=48).flat_map(|p| (0..=48 - p).map(move |q| (p, q))) {
            let [p, q] = [p, q].map(|part| f64::from(part) / 48.0);
            all.push(states[i] * p + states[j] * q + states[k] * (1.0 - p - q));
        }
    }
    all
}

/// Greys are mixtures of white and black, a grey ramp increases, light tones and hues stay.
#[test]
fn natural_pictures_keep_greys_light_tones_and_hues() {
    let mut states = inks();
    // A bluish black: the mixture is still that of white and black.
    states[0] = xyz([0.03, 0.028, 0.03]);
    for (intent, space) in
        [Intent::Natural, Intent::Vivid].into_iter().flat_map(|one| SPACES.map(|space| (one, space)))
    {
        let mapping = mapping(&states, intent, space);
        let grey = |k: i32| mapping.map([f64::from(k) / 100.0; 3]);
        for k in 0..100 {
            let (colour, next) = (grey(k), grey(k + 1));
            assert!(colour.y < next.y, "{intent:?} {space:?} {k}: {colour:?} {next:?}");
            let part = (colour.y - states[0].y) / (states[1].y - states[0].y);
            assert!(colour.distance(states[0] * (1.0 - part) + states[1] * part) < 1e-9, "{intent:?} {k}");
        }
        let coordinates = |rgb: [f64; 3]| {
            let shown = mapping.map(rgb);
            let prepared = Space::new(space, states[1]).unwrap();
            (mapping.appearance(SourceSpace::Srgb.xyz(rgb)), prepared.coordinates(shown))
        };
        for rgb in [[0.9, 0.5, 0.3], [0.6, 0.7, 0.3], [0.4, 0.45, 0.6], [0.7, 0.5, 0.5]] {
            let ([l, a, b], [shown, x, y]) = coordinates(rgb);
            let unit = prepared_unit(space, states[1]);
            assert!((shown / unit - l).abs() < 0.06, "{rgb:?}: {l} {shown}");
            let turn = (y.atan2(x) - b.atan2(a)).to_degrees();
            assert!(turn.abs() < 12.0, "{intent:?} {space:?} {rgb:?}: {turn}");
        }
    }
}

fn prepared_unit(space: MapSpace, white: Xyz) -> f64 {
    Space::new(space, white).unwrap().coordinates(white)[0]
}

/// Interpolation between nodes of the lattice is nearly exact, in the hull, and the order of the colours does not
/// matter.
#[test]
fn lattice_is_nearly_exact_and_without_memory() {
    let states = inks();
    let mapping = mapping(&states, Intent::Natural, MapSpace::Oklab);
    let mut dice = Dice::new(8, 0);
    let targets: Vec<[f64; 3]> = (0..400)
        .map(|_| {
            let rgb = [0, 1, 2].map(|_| dice.throw().powi(2));
            let [l, a, b] = mapping.appearance(SourceSpace::Srgb.xyz(rgb));
            [mapping.tone().lightness(l), a, b]
        })
        .collect();
    let closest = |lattice: &ClosestLattice<'_>, target: [f64; 3]| {
        mapping.contained(target).unwrap_or_else(|| lattice.closest(target))
    };
    let lattice = ClosestLattice::new(&mapping);
    let forwards: Vec<Xyz> = targets.iter().map(|target| closest(&lattice, *target)).collect();
    let again = ClosestLattice::new(&mapping);
    let mut backwards: Vec<Xyz> = targets.iter().rev().map(|target| closest(&again, *target)).collect();
    backwards.reverse();
    assert_eq!(forwards, backwards);
    let mut differences: Vec<f64> = targets
        .iter()
        .zip(&forwards)
        .map(|(target, found)| {
            assert!(mapping.hull().contains(*found));
            let labs = [*found, mapping.closest(*target)].map(|colour| colour.lab(states[1]).unwrap());
            labs[0].delta_e_2000(labs[1])
        })
        .collect();
    differences.sort_by(f64::total_cmp);
    assert!(differences[380] < 0.5 && differences[399] < 2.5, "{} {}", differences[380], differences[399]);
    assert!(lattice.closest([0.7, 0.9, 0.0]).distance(mapping.closest([0.7, 0.9, 0.0])) < 1e-15);
}

/// A hull in a plane keeps the hue of its ink and reduces others to the part towards it.
#[test]
fn black_white_and_red_show_red_and_grey() {
    let states = [[0.03, 0.03, 0.021], [0.6, 0.6, 0.42], [0.22, 0.12, 0.03]].map(xyz);
    for intent in [Intent::Relative, Intent::Natural] {
        let mapping = mapping(&states, intent, MapSpace::Oklab);
        let share = |rgb: [f64; 3]| {
            crate::states::LeastVariance::new(&states).unwrap().coverages(mapping.map(rgb)).unwrap().of(2)
        };
        assert!(share([0.5, 0.02, 0.02]) > 0.3, "{intent:?} {}", share([0.5, 0.02, 0.02]));
        assert!(share([0.5, 0.2, 0.02]) > 0.1, "{intent:?} {}", share([0.5, 0.2, 0.02]));
        assert!(share([0.02, 0.3, 0.4]) < 1e-6 && share([0.3; 3]) < 1e-3, "{intent:?}");
    }
}

#[test]
fn table_is_in_the_hull_and_exact_where_the_mapping_changes_nothing() {
    let states = inks();
    for (intent, mean, largest) in [(Intent::Relative, 0.2, 4.0), (Intent::Clip, 0.2, 4.0)] {
        let mapping = mapping(&states, intent, MapSpace::Oklab);
        let table = GamutTable::new(&mapping, 17);
        let error = table.error(&mapping);
        assert!(error.mean < mean && error.largest < largest, "{intent:?}: {error:?}");
        laws(
            300,
            |dice| [0, 1, 2].map(|_| dice.between(-0.1, 1.1)),
            |rgb| {
                assert!(mapping.hull().contains(table.map(*rgb)));
            },
        );
        for grey in [0.0, 0.01, 0.3, 1.0] {
            let expected = mapping.target([grey; 3]);
            assert!(table.map([grey; 3]).distance(expected) < 1e-12, "{intent:?} {grey}");
        }
        assert_eq!(table.map([f64::NAN, 2.0, -1.0]), table.map([0.0, 1.0, 0.0]));
    }
}

#[test]
fn white_and_black_must_be_mixtures_of_the_states() {
    let states = inks();
    let hull = StateHull::new(&states).unwrap();
    for (white, black) in [(states[0], states[1]), (states[1] * 1.2, states[0]), (states[1], xyz([0.0; 3]))] {
        let display = DisplayColours { white, black, perfect_white: PERFECT };
        let refused =
            GamutMapping::new(hull.clone(), display, SourceSpace::Srgb, Intent::Relative, MapSpace::Oklab);
        assert!(matches!(refused, Err(ColourError::WhiteAndBlack { .. })));
    }
}

/// The luminances of the primaries: 0.2126 0.7152 0.0722 (sRGB), 0.2290 0.6917 0.0793 (P3), 0.2627 0.6780
/// 0.0593 (BT.2020).
#[test]
fn source_spaces_have_their_luminances_and_the_white_of_d65() {
    for (space, luminances) in [
        (SourceSpace::Srgb, [0.2126, 0.7152, 0.0722]),
        (SourceSpace::DisplayP3, [0.2290, 0.6917, 0.0793]),
        (SourceSpace::Rec2020, [0.2627, 0.6780, 0.0593]),
    ] {
        assert!(space.xyz([1.0; 3]).distance(D65_WHITE) < 1e-14);
        for (k, y) in luminances.into_iter().enumerate() {
            let primary = space.xyz([0, 1, 2].map(|i| f64::from(u8::from(i == k))));
            assert!((primary.y - y).abs() < 1.1e-4, "{space:?} {k}: {primary:?}");
        }
    }
}

/// On a display without colours, tones above its black stay where they are, a colour becomes the grey of its luminance,
/// and a black that is nearly white leaves a difference between dark tones.
#[test]
fn displays_without_colours_keep_tones_and_luminance() {
    let white = D65_WHITE * 0.4;
    for part in [0.075, 0.116] {
        let mapping = mapping(&[white * part, white], Intent::Natural, MapSpace::Oklab);
        let black = mapping.lightness_of_black();
        let tone = mapping.tone();
        let tones = (1..=100).map(|k| f64::from(k) / 100.0).filter(|lightness| *lightness > black + 0.08);
        tones.for_each(|lightness| assert!((tone.lightness(lightness) - lightness).abs() < 0.006));
        for rgb in [[1.0, 0.2, 0.1], [0.1, 0.3, 0.9], [0.9, 0.8, 0.0]] {
            let y = SourceSpace::Srgb.xyz(rgb).y;
            let [colour, grey] = [rgb, [y; 3]].map(|rgb| mapping.map(rgb).y);
            assert!((colour - grey).abs() < 1e-4, "{rgb:?}: {colour} {grey}");
        }
    }
    let tone = mapping(&[white * 0.5, white], Intent::Natural, MapSpace::Oklab).tone();
    assert!(tone.lightness(0.6) - tone.lightness(0.2) > 0.02);
}
