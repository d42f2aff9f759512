//! Tests of halftones on displays with sub-pixels and with inks.

use std::sync::atomic::AtomicBool;

use papilio_colour::mapping::{Intent, MapSpace};
use papilio_colour::pictures::{Picture, scielab};
use papilio_colour::states::LeastVariance;
use papilio_colour::{CORNERS, D65_WHITE, Xyz};
use papilio_testing::Dice;

use super::halftone::{Panel, states};
use super::neutrals::Neutral;
use super::rendering::{Rendered, Rendering};
use super::*;
use crate::palette::{PaletteColour, PaletteErrors};

const PER_DEGREE: [f64; 2] = [44.0, 44.0];

fn palette(states: &[(&str, [f64; 3])]) -> Palette {
    let colour = |(name, xyz): &(&str, [f64; 3])| PaletteColour {
        state: (*name).to_owned(),
        X: xyz[0],
        Y: xyz[1],
        Z: xyz[2],
        L_star: None,
        a_star: None,
        b_star: None,
        oklab: None,
        srgb: None,
        srgb_relative: None,
        hex: None,
        error: PaletteErrors::default(),
        interpolation_error: None,
    };
    Palette { white_XYZ: D65_WHITE.to_array(), colours: states.iter().map(colour).collect() }
}

/// Eight states of sub-pixels whose light adds, in a mixed order; and six inks.
fn film() -> Palette {
    let [black, parts] = [[0.02, 0.02, 0.025], [0.0; 3]];
    let added = [[0.16, 0.09, 0.01], [0.12, 0.23, 0.04], [0.10, 0.06, 0.40]];
    let corner = |on: usize| {
        (0..3)
            .filter(|bit| on >> bit & 1 == 1)
            .fold(parts, |sum, bit| [0, 1, 2].map(|k| sum[k] + added[bit][k]))
    };
    let state = |on: usize| (CORNERS[on], [0, 1, 2].map(|k| black[k] + corner(on)[k]));
    palette(&[7, 0, 1, 2, 4, 6, 5, 3].map(state))
}

pub(super) fn inks() -> Palette {
    palette(&[
        ("black", [0.026, 0.027, 0.031]),
        ("white", [0.334, 0.352, 0.381]),
        ("yellow", [0.40, 0.43, 0.10]),
        ("red", [0.20, 0.12, 0.08]),
        ("blue", [0.05, 0.05, 0.12]),
        ("green", [0.06, 0.09, 0.07]),
    ])
}

fn rendering(palette: &Palette, intent: Intent, pixels: usize) -> Rendering {
    Rendering::new(palette, D65_WHITE, (intent, MapSpace::Oklab), pixels).unwrap()
}

fn rendered(rendering: &Rendering, pixels: &[[f32; 3]], columns: usize) -> Rendered {
    rendering.rendered((pixels, columns, None), &Adjustments::default(), false, 2).unwrap()
}

fn settings(halftone: Halftone) -> ImageSettings {
    ImageSettings { halftone, ..ImageSettings::default() }
}

/// States of a picture of 64 columns.
fn halftoned(palette: &Palette, settings: &ImageSettings, mapped: &[[f32; 3]]) -> Vec<u8> {
    halftoned_with(palette, settings, None, mapped)
}

/// The same, with pixels that are neutral.
pub(super) fn halftoned_with(
    palette: &Palette,
    settings: &ImageSettings,
    neutral: Option<Neutral>,
    mapped: &[[f32; 3]],
) -> Vec<u8> {
    let rendering = rendering(palette, Intent::Relative, 1);
    let panel = Panel {
        columns: 64,
        palette,
        rendering: &rendering,
        pixels_per_degree: Some(PER_DEGREE),
        spread: None,
        drawn: None,
        neutral,
    };
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    states(settings, mapped, &panel, &control).unwrap().0
}

fn fraction(states: &[u8], is_counted: impl Fn(u8) -> bool) -> f64 {
    states.iter().filter(|state| is_counted(**state)).count() as f64 / states.len() as f64
}

fn single(xyz: [f64; 3]) -> [f32; 3] {
    xyz.map(|value| value as f32)
}

/// A uniform picture has as many red, green and blue sub-pixels that are on as its colour needs, to the
/// levels of the mask; one with inks has their coverages of least variance.
#[test]
fn masks_show_wanted_coverages() {
    let film = film();
    let at = |name: &str| {
        film.colours.iter().find(|one| one.state == name).map(|one| [one.X, one.Y, one.Z]).unwrap()
    };
    let wanted = [0.3, 0.56, 0.11];
    let black = at("black");
    let colour = ["red", "green", "blue"]
        .into_iter()
        .zip(wanted)
        .fold(black, |sum, (name, part)| [0, 1, 2].map(|k| sum[k] + part * (at(name)[k] - black[k])));
    let inks = inks();
    let points: Vec<Xyz> = inks.colours.iter().map(|one| Xyz { x: one.X, y: one.Y, z: one.Z }).collect();
    let grey = points[0] * 0.7 + points[1] * 0.3;
    let coverages = LeastVariance::new(&points).unwrap().coverages(grey).unwrap();
    for (halftone, levels) in [(Halftone::Ordered, 256.0), (Halftone::VoidAndCluster, 4096.0)] {
        let settings = settings(halftone);
        let found = halftoned(&film, &settings, &[single(colour); 64 * 64]);
        for (bit, wanted) in wanted.into_iter().enumerate() {
            let is_on = |state: u8| {
                let corner = CORNERS.iter().position(|name| *name == film.colours[usize::from(state)].state);
                corner.unwrap() >> bit & 1 == 1
            };
            let shown = fraction(&found, is_on);
            assert!((shown - wanted).abs() <= 0.51 / levels, "{halftone:?} {bit}: {shown} {wanted}");
        }
        let found = halftoned(&inks, &settings, &[single(grey.to_array()); 64 * 64]);
        for state in 0..6 {
            let (shown, wanted) = (fraction(&found, |one| one == state), coverages.of(state.into()));
            assert!((shown - wanted).abs() <= 1.01 / levels, "{halftone:?} {state}: {shown} {wanted}");
        }
    }
}

/// A grey of sub-pixels is not a mixture of black and white pixels: sub-pixels switch apart.
#[test]
fn masks_of_sub_pixels_are_apart() {
    let film = film();
    let [black, white] = [1, 0].map(|at| [film.colours[at].X, film.colours[at].Y, film.colours[at].Z]);
    let dark = [0, 1, 2].map(|k| 0.8 * black[k] + 0.2 * white[k]);
    for halftone in [Halftone::Ordered, Halftone::VoidAndCluster] {
        let found = halftoned(&film, &settings(halftone), &[single(dark); 64 * 64]);
        let white = fraction(&found, |state| state == 0);
        assert!(white < 0.05, "{halftone:?}: {white}");
    }
}

/// A gradient of colours inside the hull.
fn gradient(palette: &Palette) -> Vec<[f32; 3]> {
    let rendering = rendering(palette, Intent::Relative, 1);
    let source = |at: usize| {
        let (x, y) = ((at % 64) as f32 / 63.0, (at / 64) as f32 / 31.0);
        [0.2 + 0.6 * x, 0.25 + 0.5 * x + 0.1 * y, 0.8 - 0.5 * y]
    };
    let source: Vec<[f32; 3]> = (0..64 * 32).map(source).collect();
    rendered(&rendering, &source, 64).mapped
}

#[test]
fn another_seed_gives_another_void_and_cluster_mask_only() {
    let inks = inks();
    let picture = gradient(&inks);
    for halftone in [Halftone::Ordered, Halftone::VoidAndCluster, Halftone::ErrorDiffusion] {
        let of = |seed| halftoned(&inks, &ImageSettings { seed, ..settings(halftone) }, &picture);
        assert_eq!(of(3), of(3));
        assert_eq!(of(3) == of(4), halftone != Halftone::VoidAndCluster, "{halftone:?}");
    }
}

/// With fewer states than the eight of sub-pixels, and with sub-pixels whose light does not add, any states
/// are mixed: mean colours are kept.
#[test]
fn states_that_are_left_out_are_not_used() {
    let film = film();
    let names = ["white", "black", "red", "green", "blue"].map(str::to_owned);
    let five = film.clone().with_states(&names).unwrap();
    let mut brighter = film;
    brighter.colours[0].Y *= 1.1;
    for palette in [five, brighter] {
        let points: Vec<Xyz> =
            palette.colours.iter().map(|one| Xyz { x: one.X, y: one.Y, z: one.Z }).collect();
        let centre = points
            .iter()
            .fold(Xyz { x: 0.0, y: 0.0, z: 0.0 }, |sum, one| sum + *one * (1.0 / points.len() as f64));
        for halftone in [Halftone::Ordered, Halftone::VoidAndCluster] {
            let found = halftoned(&palette, &settings(halftone), &[single(centre.to_array()); 64 * 64]);
            let mean = found.iter().fold(Xyz { x: 0.0, y: 0.0, z: 0.0 }, |sum, state| {
                sum + points[usize::from(*state)] * (1.0 / found.len() as f64)
            });
            assert!(mean.distance(centre) < 4.0 / 256.0 * points[0].y, "{halftone:?}: {mean:?} {centre:?}");
        }
    }
}

/// A colour that is a state is that state, one between two the nearer one.
#[test]
fn nearest_states_have_no_pattern() {
    let inks = inks();
    let settings = settings(Halftone::Nearest);
    for (k, ink) in inks.colours.iter().enumerate() {
        let white = &inks.colours[1];
        let pairs = [(ink.X, white.X), (ink.Y, white.Y), (ink.Z, white.Z)];
        let near = pairs.map(|(ink, white)| 0.95 * ink + 0.05 * white);
        let found = halftoned(&inks, &settings, &[single([ink.X, ink.Y, ink.Z]), single(near)].repeat(32));
        assert!(found.iter().all(|state| usize::from(*state) == k), "{}: {found:?}", ink.state);
    }
}

#[test]
fn given_states_are_shown_or_refused() {
    let inks = inks();
    let rendering = rendering(&inks, Intent::Relative, 1);
    let panel = Panel {
        columns: 2,
        palette: &inks,
        rendering: &rendering,
        pixels_per_degree: None,
        spread: None,
        drawn: None,
        neutral: None,
    };
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let picture = [[0.1_f32; 3]; 4];
    let of = |given: &[u8]| {
        let given = Some(given.to_vec());
        states(&ImageSettings { given, ..ImageSettings::default() }, &picture, &panel, &control)
    };
    assert_eq!(of(&[5, 0, 1, 2]), Ok((vec![5, 0, 1, 2], 0)));
    let refused =
        |pixels, highest| Err(DisplayError::GivenStates { pixels, expected: 4, highest, states: 6 });
    assert_eq!((of(&[5, 0, 1]), of(&[0, 6, 0, 0])), (refused(3, 5), refused(4, 6)));
}

/// No intent leaves a colour outside the hull, with and without a table.
#[test]
fn no_colour_outside_the_hull_reaches_a_halftone() {
    let mut dice = Dice::new(5, 0);
    let random: Vec<[f32; 3]> = (0..400).map(|_| [0, 1, 2].map(|_| dice.between(-0.1, 1.3) as f32)).collect();
    for palette in [film(), inks()] {
        for intent in [Intent::Natural, Intent::Vivid, Intent::Relative, Intent::Absolute, Intent::Clip] {
            for pixels in [1, 50_000] {
                let rendering = rendering(&palette, intent, pixels);
                let rendered = rendered(&rendering, &random, 20);
                for pixel in &rendered.mapped {
                    assert!(rendering.excess(colour(*pixel)) < 1e-6, "{intent:?} {pixels}: {pixel:?}");
                }
                assert!(rendered.inside < 400, "{intent:?}: some colours of the source are outside");
            }
        }
    }
}

/// The search ends where it cannot continue, and a reader sees it nearer to the picture than error diffusion
/// (S-CIELAB, with all Gaussians).
#[test]
fn direct_binary_search_lowers_what_is_seen_and_ends() {
    let inks = inks();
    let picture = gradient(&inks);
    let diffused = halftoned(&inks, &settings(Halftone::ErrorDiffusion), &picture);
    let found = halftoned(&inks, &settings(Halftone::DirectBinarySearch), &picture);
    let rendering = rendering(&inks, Intent::Relative, 1);
    let panel = Panel {
        columns: 64,
        palette: &inks,
        rendering: &rendering,
        pixels_per_degree: Some(PER_DEGREE),
        spread: None,
        drawn: None,
        neutral: None,
    };
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let last = (1.0, usize::MAX);
    assert_eq!(search::with_filters(&found, &picture, &panel, last, &control).unwrap(), found);
    let seen = |shown: &[u8]| seen_error(&rendering, shown, &picture);
    assert!(seen(&found) < 0.85 * seen(&diffused), "{} {}", seen(&found), seen(&diffused));
    // Below layers that spread a third of the light over the eight neighbours, other patterns are best, and
    // the search ends there, too.
    let side = 2 * search::REACH_OF_LAYERS as usize + 1;
    let mut spread = vec![0.0; side * side];
    let middle = side / 2;
    for (row, column) in (0..9).map(|k| (middle - 1 + k / 3, middle - 1 + k % 3)) {
        spread[row * side + column] = if [row, column] == [middle; 2] { 2.0 / 3.0 } else { 1.0 / 24.0 };
    }
    let below = Panel {
        columns: 64,
        palette: &inks,
        rendering: &rendering,
        pixels_per_degree: Some(PER_DEGREE),
        spread: Some(spread),
        drawn: None,
        neutral: None,
    };
    let blurred = search::searched(&diffused, &picture, &below, &search::TO_THE_END, &control).unwrap();
    assert_ne!(blurred, found);
    assert_eq!(search::with_filters(&blurred, &picture, &below, last, &control).unwrap(), blurred);
    let settings = settings(Halftone::DirectBinarySearch);
    let no_pitch = Panel { pixels_per_degree: None, spread: None, ..panel };
    assert_eq!(states(&settings, &picture, &no_pitch, &control), Err(DisplayError::NoPixelPitch));
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    assert_eq!(
        search::searched(&diffused, &picture, &no_pitch, &search::TO_THE_END, &control),
        Err(DisplayError::NoPixelPitch)
    );
    let pitch = Panel { pixels_per_degree: Some(PER_DEGREE), spread: None, ..no_pitch };
    assert_eq!(states(&settings, &picture, &pitch, &control), Err(DisplayError::Interrupted));
}

/// Power of the luminance of a pattern of 64 x 64 pixels below 0.12 cycles per pixel, which a reader sees.
fn visible_power(shown: &[f64]) -> f64 {
    let mean = shown.iter().sum::<f64>() / shown.len() as f64;
    let mut power = 0.0;
    for (u, v) in (0..8).flat_map(|u| (-7..8).map(move |v| (f64::from(u), f64::from(v)))) {
        if (1.0..60.0).contains(&(u * u + v * v)) {
            let [mut re, mut im] = [0.0; 2];
            for (at, value) in shown.iter().enumerate() {
                let turn = 2.0 * PI * (u * (at % 64) as f64 + v * (at / 64) as f64) / 64.0;
                re += (value - mean) * turn.cos();
                im += (value - mean) * turn.sin();
            }
            power += re * re + im * im;
        }
    }
    power
}

/// Flat tones have less than three quarters of the visible power of error diffusion, whose worms it is; a gradient is nearer
/// to its picture for a reader; any number of threads gives the same bits; and without a pitch it is error
/// diffusion.
#[test]
fn refined_error_diffusion_has_less_visible_pattern_than_error_diffusion() {
    let inks = inks();
    let [plain, refined] = [Halftone::ErrorDiffusion, Halftone::RefinedErrorDiffusion].map(settings);
    assert_eq!(ImageSettings::default().halftone, refined.halftone);
    let [black, white] = [&inks.colours[0], &inks.colours[1]].map(|one| [one.X, one.Y, one.Z]);
    let power = |settings: &ImageSettings| {
        let of_tone = |part: f64| {
            let tone = single([0, 1, 2].map(|k| black[k] + part * (white[k] - black[k])));
            let states = halftoned(&inks, settings, &[tone; 64 * 64]);
            visible_power(&states.iter().map(|state| inks.colours[usize::from(*state)].Y).collect::<Vec<_>>())
        };
        [0.08, 0.2, 0.45, 0.7, 0.93].map(of_tone).iter().sum::<f64>()
    };
    let [with_worms, without] = [power(&plain), power(&refined)];
    assert!(without < 0.75 * with_worms, "{without} {with_worms}");
    let picture = gradient(&inks);
    let rendering = rendering(&inks, Intent::Relative, 1);
    let panel = |per_degree| Panel {
        columns: 64,
        palette: &inks,
        rendering: &rendering,
        pixels_per_degree: per_degree,
        spread: None,
        drawn: None,
        neutral: None,
    };
    let shown = |settings: &ImageSettings, per_degree, threads| {
        let control = Control { threads: Some(threads), progress: &|_| {}, stop: &AtomicBool::new(false) };
        states(settings, &picture, &panel(per_degree), &control).unwrap().0
    };
    let found = shown(&refined, Some(PER_DEGREE), 1);
    let diffused = shown(&plain, Some(PER_DEGREE), 1);
    assert_eq!(shown(&refined, Some(PER_DEGREE), 3), found);
    assert_eq!(shown(&refined, None, 1), diffused);
    let error = |states: &[u8]| seen_error(&rendering, states, &picture);
    assert!(error(&found) < 0.85 * error(&diffused), "{} {}", error(&found), error(&diffused));
}

/// The searches keep flat tones, which are off by up to 4 % without a weight of their means.
#[test]
fn searched_halftones_keep_flat_tones() {
    let inks = inks();
    let [black, white] = [&inks.colours[0], &inks.colours[1]].map(|one| [one.X, one.Y, one.Z]);
    for halftone in [Halftone::RefinedErrorDiffusion, Halftone::DirectBinarySearch] {
        for part in [0.03, 0.2, 0.3, 0.6, 0.97] {
            let tone = [0, 1, 2].map(|k| black[k] + part * (white[k] - black[k]));
            let states = halftoned(&inks, &settings(halftone), &[single(tone); 64 * 64]);
            let shown = states.iter().map(|state| inks.colours[usize::from(*state)].Y).sum::<f64>() / 4096.0;
            assert!((shown / tone[1] - 1.0).abs() < 0.005, "{halftone:?} {part}: {shown} {}", tone[1]);
        }
    }
}

/// Mean S-CIELAB difference of states of 64 columns from a picture.
fn seen_error(rendering: &Rendering, states: &[u8], wanted: &[[f32; 3]]) -> f64 {
    let xyz = |pixels: Vec<[f64; 3]>| {
        Picture::new(64, [0, 1, 2].map(|k| pixels.iter().map(|value| value[k]).collect())).unwrap()
    };
    let shown = xyz(states.iter().map(|state| rendering.states[usize::from(*state)]).collect());
    let wanted = xyz(wanted.iter().map(|pixel| pixel.map(f64::from)).collect());
    let [shown, wanted] = scielab([shown, wanted], rendering.white, PER_DEGREE[0]).unwrap();
    let found = shown.delta_e_2000(&wanted).unwrap();
    found.iter().sum::<f64>() / found.len() as f64
}
