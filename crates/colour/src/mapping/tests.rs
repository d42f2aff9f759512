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
const INTENTS: [Intent; 4] = [Intent::Relative, Intent::Perceptual, Intent::Absolute, Intent::Clip];
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
                if intent != Intent::Perceptual && mapping.hull().contains(target) {
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

/// A ramp of one lightness and hue beyond the hull: relative mapping has one colour there, perceptual mapping
/// still a gradient.
#[test]
fn perceptual_mapping_keeps_differences_between_saturated_colours() {
    let states = inks();
    let prepared = Space::new(MapSpace::Oklab, states[1]).unwrap();
    let chromas = |intent| -> Vec<f64> {
        let mapping = mapping(&states, intent, MapSpace::Oklab);
        let colour = |k: i32| crate::Oklab { l: 0.6, a: 0.006 * f64::from(k), b: 0.002 * f64::from(k) };
        let mapped = (0..=40).map(|k| prepared.coordinates(mapping.map_xyz(colour(k).xyz())));
        mapped.map(|[_, a, b]| a.hypot(b)).collect()
    };
    let [relative, perceptual] = [Intent::Relative, Intent::Perceptual].map(chromas);
    assert!((relative[40] - relative[36]).abs() < 1e-3, "the hull is not reached: {relative:?}");
    let steps = || perceptual.windows(2).take(35).map(|pair| pair[1] - pair[0]);
    assert!(steps().all(|step| step > 1e-4), "{perceptual:?}");
    assert!((perceptual[5] / (5.0 * 0.002 * 10.0_f64.sqrt()) - 1.0).abs() < 0.01, "{perceptual:?}");
}

/// A hull in a plane keeps the hue of its ink and reduces others to the part towards it.
#[test]
fn black_white_and_red_show_red_and_grey() {
    let states = [[0.03, 0.03, 0.021], [0.6, 0.6, 0.42], [0.22, 0.12, 0.03]].map(xyz);
    for intent in [Intent::Relative, Intent::Perceptual] {
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
    for (intent, mean, largest) in
        [(Intent::Relative, 0.2, 4.0), (Intent::Perceptual, 0.2, 4.0), (Intent::Clip, 0.2, 4.0)]
    {
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
            let exact = intent != Intent::Perceptual;
            assert!(!exact || table.map([grey; 3]).distance(expected) < 1e-12, "{intent:?} {grey}");
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
