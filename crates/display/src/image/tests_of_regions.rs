//! Tests of drawings and photographs in one picture.

use std::sync::atomic::AtomicBool;

use papilio_colour::mapping::{Intent, MapSpace, SourceSpace};
use papilio_colour::{D65_WHITE, encoded_byte};
use papilio_imaging::text::{Font, Setting};
use papilio_testing::Dice;

use super::halftone::{Panel, states};
use super::rendering::Rendering;
use super::tests::inks;
use super::{Adjustments, Halftone, ImageSettings, Regions, SourceImage};
use crate::run::Control;

const COLUMNS: usize = 128;
const ROWS: usize = 112;
/// Numbers of states of the six inks.
const BLACK: u8 = 0;
const WHITE: u8 = 1;
const RED: u8 = 3;

fn source(colours: &[[u8; 3]]) -> SourceImage {
    let linear =
        |byte: u8| ((f64::from(byte) / 255.0 + 0.055) / 1.055).powf(2.4).max(f64::from(byte) / 3294.6);
    let xyz = |colour: &[u8; 3]| SourceSpace::Srgb.xyz(colour.map(linear)).to_array().map(|one| one as f32);
    SourceImage { columns: COLUMNS, pixels: colours.iter().map(xyz).collect() }
}

/// The states on six inks.
fn shown(colours: &[[u8; 3]], regions: Regions, halftone: Halftone, threads: usize) -> Vec<u8> {
    let source = source(colours);
    let palette = inks();
    let mapping = (Intent::Natural, MapSpace::Oklab);
    let rendering = Rendering::new(&palette, D65_WHITE, mapping, source.pixels.len()).unwrap();
    let drawing = regions.drawing(&source, true, threads).unwrap();
    let is_drawn = drawing.as_ref().map(|drawing| &drawing.is_drawn[..]);
    let picture = (&source.pixels[..], COLUMNS, is_drawn);
    let mut rendered = rendering.rendered(picture, &Adjustments::default(), false, threads).unwrap();
    let mut panel = Panel {
        columns: COLUMNS,
        palette: &palette,
        rendering: &rendering,
        pixels_per_degree: Some([44.0; 2]),
        spread: None,
        drawn: None,
        neutral: None,
    };
    let control = Control { threads: Some(threads), progress: &|_| {}, stop: &AtomicBool::new(false) };
    panel.drawn = drawing.map(|drawing| drawing.drawn(&mut rendered.mapped, &panel, &control).unwrap());
    let settings = ImageSettings { halftone, ..ImageSettings::default() };
    states(&settings, &rendered.mapped, &panel, &control).unwrap().0
}

const PATCH: [[usize; 2]; 2] = [[64, 128], [64, 112]];
const TILE: [[usize; 2]; 2] = [[0, 64], [40, 112]];

fn is_in(at: usize, [across, down]: [[usize; 2]; 2]) -> bool {
    let (x, y) = (at % COLUMNS, at / COLUMNS);
    (across[0]..across[1]).contains(&x) && (down[0]..down[1]).contains(&y)
}

/// Black text on white, and on a red tile; a photograph, which is noise.
fn dashboard() -> Vec<[u8; 3]> {
    let mut dice = Dice::new(7, 0);
    let mut colours: Vec<[u8; 3]> = (0..COLUMNS * ROWS)
        .map(|at| match at {
            _ if is_in(at, PATCH) => [0; 3].map(|_| dice.between(40.0, 200.0) as u8),
            _ if is_in(at, TILE) => [255, 0, 0],
            _ => [255; 3],
        })
        .collect();
    for (size_pt, left, top) in [(12.0, 4, 4), (24.0, 4, 60)] {
        let setting = Setting { size_pt, per_inch: [72.0; 2], margin: 0 };
        let ([across, down], covered) = Font::bundled().coverage("Rages", setting).unwrap();
        for (at, covered) in covered.iter().enumerate() {
            // Coverage begins with the lowest row.
            let (x, y) = (left + at % across, top + down - 1 - at / across);
            if x < PATCH[0][0] && y < ROWS {
                let colour = &mut colours[y * COLUMNS + x];
                *colour = colour.map(|one| (f64::from(one) * (1.0 - covered)).round() as u8);
            }
        }
    }
    colours
}

/// Tiles in the colour of an ink are that ink alone, white is white, and text has the two states of its sides only: with
/// every halftone that diffuses or searches, and with a mask.
#[test]
fn inks_are_pure_and_text_has_the_states_of_its_sides() {
    let colours = dashboard();
    for halftone in [
        Halftone::ErrorDiffusion,
        Halftone::RefinedErrorDiffusion,
        Halftone::DirectBinarySearch,
        Halftone::VoidAndCluster,
    ] {
        let found = shown(&colours, Regions::Auto, halftone, 2);
        let mut text = [0; 2];
        for (at, state) in found.iter().enumerate().filter(|(at, _)| !is_in(*at, PATCH)) {
            let is_tile = is_in(at, TILE);
            let ground = if is_tile { RED } else { WHITE };
            match colours[at] {
                [0, 0, 0] => assert_eq!(*state, BLACK),
                [255, 0, 0] | [255, 255, 255] => assert_eq!(*state, ground, "{halftone:?} {at}"),
                _ => {
                    text[usize::from(is_tile)] += 1;
                    assert!([BLACK, ground].contains(state), "{halftone:?} {at}: {state}");
                    let is_dark = colours[at][0] < 100;
                    assert!(!is_dark || *state == BLACK, "{halftone:?} {at}: {:?}", colours[at]);
                }
            }
        }
        assert!(text.iter().all(|count| *count > 50), "{text:?}");
        let mask = (0..colours.len()).map(|at| !is_in(at, PATCH)).collect();
        assert_eq!(found, shown(&colours, Regions::Given(mask), halftone, 1), "{halftone:?}");
    }
    // Without regions, error diffusion leaves stray dots.
    let stray = shown(&colours, Regions::Photograph, Halftone::ErrorDiffusion, 1);
    let dots = (0..colours.len()).filter(|at| colours[*at] == [255, 0, 0] && stray[*at] != RED);
    assert!(dots.count() > 100);
}

/// Strokes of text whose pixels are as dark as they are covered have as many black pixels as they have area.
#[test]
fn strokes_keep_their_width() {
    let setting = Setting { size_pt: 22.0, per_inch: [72.0; 2], margin: 0 };
    let ([across, down], covered) = Font::bundled().coverage("Hamburge", setting).unwrap();
    let mut colours = vec![[255; 3]; COLUMNS * ROWS];
    let mut area = 0.0;
    for (at, covered) in covered.iter().enumerate() {
        let (x, y) = (4 + at % across, 4 + down - 1 - at / across);
        if x < COLUMNS && y < ROWS {
            colours[y * COLUMNS + x] = [encoded_byte(1.0 - covered); 3];
            area += covered;
        }
    }
    let found = shown(&colours, Regions::Drawing, Halftone::default(), 1);
    let black = found.iter().filter(|state| **state == BLACK).count() as f64;
    assert!(area > 400.0 && (black / area - 1.0).abs() < 0.04, "{black} {area}");
}

/// A grey has the same pattern wherever it is, and whatever is beside it.
#[test]
fn patterns_of_flat_colours_are_the_same_everywhere() {
    let tile = |left: usize, other: u8| -> Vec<u8> {
        let colour = |at: usize| {
            let is_tile = is_in(at, [[left, left + 40], [16, 64]]);
            [if is_tile { 120 } else { other }; 3]
        };
        let colours: Vec<[u8; 3]> = (0..COLUMNS * ROWS).map(colour).collect();
        let found = shown(&colours, Regions::Auto, Halftone::default(), 1);
        let inside = (0..found.len()).filter(|at| is_in(*at, [[left, left + 40], [16, 64]]));
        inside.map(|at| found[at]).collect()
    };
    let first = tile(16, 255);
    assert_eq!(first, tile(64, 255));
    assert_eq!(first, tile(32, 60));
    assert!(first.iter().any(|state| *state != first[0]));
}

/// A photograph alone has no drawing, and its states are those without regions.
#[test]
fn photographs_are_shown_as_before() {
    let mut dice = Dice::new(9, 0);
    let colours: Vec<[u8; 3]> = (0..COLUMNS * ROWS)
        .map(|at| [0, 40, 90].map(|base| base + (at % COLUMNS) as u8 + dice.between(0.0, 20.0) as u8))
        .collect();
    assert!(Regions::Auto.drawing(&source(&colours), true, 1).unwrap().is_none());
    let of = |regions| shown(&colours, regions, Halftone::default(), 2);
    assert_eq!(of(Regions::Auto), of(Regions::Photograph));
    assert_ne!(of(Regions::Drawing), of(Regions::Photograph));
    assert!(Regions::Auto.drawing(&source(&[[90; 3]; COLUMNS]), false, 1).unwrap().is_none());
    assert!(Regions::Given(vec![true; 3]).drawing(&source(&colours), true, 1).is_err());
}
