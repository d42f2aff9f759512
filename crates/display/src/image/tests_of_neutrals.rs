//! Tests of neutral colours by black and white only.

use papilio_colour::mapping::{Intent, MapSpace};
use papilio_colour::{D65_WHITE, Xyz};
use papilio_testing::Dice;

use super::neutrals::Neutral;
use super::rendering::Rendering;
use super::tests::{halftoned_with, inks};
use super::{Halftone, ImageSettings, Neutrals};
use crate::DisplayError;

const COLUMNS: usize = 64;

fn rendering(palette: &crate::palette::Palette) -> Rendering {
    Rendering::new(palette, D65_WHITE, (Intent::Natural, MapSpace::Oklab), 1).unwrap()
}

fn neutral(mapped: &mut [[f32; 3]]) -> Neutral {
    let inks = inks();
    Neutrals::BlackAndWhite.of(mapped, &rendering(&inks), &inks, 2).unwrap().unwrap()
}

/// Greys of all tones with the noise of a photograph on the left, red to yellow on the right.
fn picture() -> Vec<[f32; 3]> {
    let [black, white, red, yellow] = [0, 1, 3, 2].map(|k| {
        let one = &inks().colours[k];
        [one.X, one.Y, one.Z]
    });
    let mut dice = Dice::new(4, 0);
    let mut mixture = |at: usize| {
        let part = (at / COLUMNS) as f64 / 80.0 + 0.1 * dice.throw();
        let (low, high) = if at % COLUMNS < 32 { (black, white) } else { (red, yellow) };
        [0, 1, 2].map(|k| (low[k] + part * (high[k] - low[k])) as f32)
    };
    (0..COLUMNS * 64).map(&mut mixture).collect()
}

/// Neutral pixels have black and white only, with the mean luminance of the target, in each halftone; the colours beside
/// them keep their inks.
#[test]
fn neutral_pixels_take_black_and_white_only() {
    let wanted = picture();
    let inks = inks();
    for halftone in [
        Halftone::Nearest,
        Halftone::Ordered,
        Halftone::VoidAndCluster,
        Halftone::ErrorDiffusion,
        Halftone::RefinedErrorDiffusion,
        Halftone::DirectBinarySearch,
    ] {
        let mut mapped = wanted.clone();
        let marked = neutral(&mut mapped);
        let settings = ImageSettings { halftone, ..ImageSettings::default() };
        let states = halftoned_with(&inks, &settings, Some(marked), &mapped);
        let left = || states.iter().enumerate().filter(|(at, _)| at % COLUMNS < 32);
        assert!(left().all(|(_, state)| *state < 2), "{halftone:?}");
        let right = || states.iter().enumerate().filter(|(at, _)| at % COLUMNS >= 32);
        assert!(
            right().any(|(_, state)| *state == 3) && right().any(|(_, state)| *state == 2),
            "{halftone:?}"
        );
        if halftone != Halftone::Nearest {
            let y = |at: usize| inks.colours[usize::from(states[at])].Y - f64::from(wanted[at][1]);
            let more: f64 = left().map(|(at, _)| y(at)).sum::<f64>() / left().count() as f64;
            assert!(more.abs() < 0.004, "{halftone:?}: {more}");
        }
    }
}

/// A grey with less than the least chroma becomes neutral; a coloured one, and a palette without black, do not.
#[test]
fn what_is_neutral_is_told_from_colours() {
    let inks = inks();
    let rendering = rendering(&inks);
    let grey = |a: f64, b: f64| {
        let [black, white] = rendering.black_and_white();
        let mixture = black + (white - black) * 0.4;
        let mut lab = mixture.lab(white).unwrap();
        (lab.a, lab.b) = (lab.a + a, lab.b + b);
        lab.xyz(white).to_array().map(|value| value as f32)
    };
    let mut targets = [grey(0.0, 0.0), grey(2.0, 2.0), grey(0.0, 4.0), grey(-3.5, 0.0)];
    let before = targets;
    let Neutral { pixels, allowed, .. } = neutral(&mut targets);
    assert_eq!(pixels, [true, true, false, false]);
    assert_eq!(allowed, [true, true, false, false, false, false]);
    assert_eq!(targets[2..], before[2..]);
    assert!((targets[1][1] - before[1][1]).abs() < 1e-6 && targets[1][2] > before[1][2]);
    let [x, y, z] = targets[1].map(f64::from);
    let [black, white] = rendering.black_and_white();
    let part = (y - black.y) / (white.y - black.y);
    assert!(Xyz { x, y, z }.distance(black + (white - black) * part) < 1e-6);
    let mut colours = inks.clone();
    colours.colours.retain(|one| !["black", "blue", "green"].contains(&&*one.state));
    let refused = Neutrals::BlackAndWhite.of(&mut targets, &self::rendering(&colours), &colours, 1);
    assert_eq!(refused.err(), Some(DisplayError::NoNeutral { state: "red".to_owned() }));
}
