//! Tests of natural pictures: tone, contrast and chroma of whole pictures.

use papilio_colour::mapping::{Intent, MapSpace};
use papilio_colour::{Adaptation, D65_WHITE, Observer, Xyz};
use papilio_spectra::{Grid, planck};
use papilio_testing::Dice;

use super::natural::missing_stops;
use super::regions::Drawing;
use super::rendering::{Rendered, Rendering};
use super::tests::inks;
use super::{Adjustments, Regions, Rendition, SourceImage};

const COLUMNS: usize = 64;

/// A picture on six inks, without a halftone.
fn shown(pixels: &[[f32; 3]], adjustments: Adjustments) -> (Vec<[f64; 3]>, Rendition) {
    let rendering =
        Rendering::new(&inks(), D65_WHITE, (Intent::Natural, MapSpace::Oklab), pixels.len()).unwrap();
    let drawing = drawing(pixels);
    let is_drawn = drawing.as_ref().map(|drawing| &drawing.is_drawn[..]);
    let picture = (pixels, COLUMNS, is_drawn);
    let Rendered { mapped, rendition, .. } = rendering.rendered(picture, &adjustments, false, 1).unwrap();
    (mapped.into_iter().map(|pixel| pixel.map(f64::from)).collect(), rendition.unwrap())
}

fn drawing(pixels: &[[f32; 3]]) -> Option<Drawing> {
    let source = SourceImage { columns: COLUMNS, pixels: pixels.to_vec() };
    Regions::Auto.drawing(&source, true, 1).unwrap()
}

/// Fraction of the pixels that are a drawing.
fn drawn(pixels: &[[f32; 3]]) -> f64 {
    drawing(pixels).map_or(0.0, |drawing| drawing.fraction())
}

fn grey(light: f64) -> [f32; 3] {
    D65_WHITE.to_array().map(|one| (one * light) as f32)
}

/// The exposure is decided by the same pixel as if all were sorted, exactly.
#[test]
fn exposure_is_that_of_the_sorted_pixels() {
    let mut dice = Dice::new(6, 0);
    let pixels: Vec<[f32; 3]> = (0..3000).map(|_| grey(0.45 * dice.throw().powi(3))).collect();
    let is_drawn: Vec<bool> = (0..pixels.len()).map(|_| dice.throw() < 0.2).collect();
    for is_drawn in [None, Some(&is_drawn[..])] {
        let photograph = (0..pixels.len()).filter(|at| is_drawn.is_none_or(|is_drawn| !is_drawn[*at]));
        let largest = |at: usize| {
            let [x, y, z] = pixels[at].map(f64::from);
            Xyz { x, y, z }.linear_srgb().into_iter().fold(0.0, f64::max)
        };
        let mut lights: Vec<f64> = photograph.map(largest).collect();
        lights.sort_by(f64::total_cmp);
        let light = lights[(0.995 * (lights.len() - 1) as f64).round() as usize];
        for threads in [1, 3] {
            assert_eq!(missing_stops(&pixels, is_drawn, threads), (0.5 / light).log2());
        }
    }
    assert_eq!((missing_stops(&[], None, 2), missing_stops(&[[0.0; 3]; 9], None, 2)), (0.0, 0.0));
}

/// A photograph: noise about a dark and a light half, up to this light.
fn photograph(most: f64) -> Vec<[f32; 3]> {
    let mut dice = Dice::new(2, 0);
    (0..COLUMNS * 48)
        .map(|at| grey(most * if at % 64 < 40 { 0.05 } else { 0.9 } * dice.between(0.8, 1.0)))
        .collect()
}

/// Of a ramp from black to white, ends are exact, each tone is a mixture of white and black, and none is darker
/// than the one before; in a photograph and in a drawing. The base of a curved ramp is not the ramp itself, which leaves
/// a step back of 0.8 in L* in the shadows of these 64 pixels, and of less than 0.3, which is not seen, in those of a panel
/// (the next test).
#[test]
fn natural_ramps_of_grey_increase_between_white_and_black_without_colour() {
    let inks = inks();
    let [black, white] = [0, 1].map(|k| [inks.colours[k].X, inks.colours[k].Y, inks.colours[k].Z]);
    for steps in [63, 7] {
        let tone = |at: usize| (at % COLUMNS * (steps + 1) / COLUMNS) as f64 / steps as f64;
        let ramp: Vec<[f32; 3]> = (0..COLUMNS * 32).map(|at| grey(tone(at).powf(2.2))).collect();
        let (found, rendition) = shown(&ramp, Adjustments::default());
        assert_eq!(drawn(&ramp), if steps == 7 { 1.0 } else { 0.0 }, "{rendition:?}");
        let row = &found[16 * COLUMNS..][..COLUMNS];
        for (k, pixel) in row.iter().enumerate() {
            let part = (pixel[1] - black[1]) / (white[1] - black[1]);
            let mixture = [0, 1, 2].map(|i| black[i] + part * (white[i] - black[i]));
            assert!(
                pixel.iter().zip(mixture).all(|(one, other)| (one - other).abs() < 1e-6),
                "{k}: {pixel:?}"
            );
            let light = |pixel: &[f64; 3]| 116.0 * (pixel[1] / white[1]).cbrt();
            let back = if steps == 7 { 1e-6 } else { 1.0 };
            assert!(row[..k].iter().all(|one| light(one) <= light(pixel) + back), "{steps} {k}: {row:?}");
        }
        let ends = [(row[0], black), (row[COLUMNS - 1], white)];
        assert!(ends.iter().all(|(one, other)| (0..3).all(|k| (one[k] - other[k]).abs() < 1e-6)), "{ends:?}");
    }
}

/// Of a ramp over the 800 pixels of a panel, no tone is visibly darker than one before.
#[test]
fn natural_ramps_of_a_panel_do_not_step_back() {
    let inks = inks();
    let columns = 800;
    let ramp: Vec<[f32; 3]> =
        (0..columns * 32).map(|at| grey(((at % columns) as f64 / (columns - 1) as f64).powf(2.2))).collect();
    let rendering = Rendering::new(&inks, D65_WHITE, (Intent::Natural, MapSpace::Oklab), ramp.len()).unwrap();
    let picture = (&ramp[..], columns, None);
    let Rendered { mapped, .. } = rendering.rendered(picture, &Adjustments::default(), false, 1).unwrap();
    let white = inks.colours[1].Y;
    let row = mapped[16 * columns..][..columns].iter();
    let light: Vec<f64> = row.map(|pixel| 116.0 * (f64::from(pixel[1]) / white).cbrt()).collect();
    let mut lightest = f64::NEG_INFINITY;
    for (k, light) in light.iter().enumerate() {
        assert!(*light > lightest - 0.3, "{k}: {light} {lightest}");
        lightest = lightest.max(*light);
    }
}

/// Fine detail far below the display's black keeps a part of its contrast, which a tone for each colour alone
/// would take.
#[test]
fn shadows_keep_detail() {
    // Four columns dark, four a little lighter; a light half beside them; with the noise of a photograph.
    let tone =
        |at: usize| if at % 64 < 40 { [0.004, 0.02][at / 4 % 2] } else { 0.6 + 0.01 * (at % 7) as f64 };
    let noise = |at: usize| 6e-4 * (at * 7 % 5) as f64;
    let picture: Vec<[f32; 3]> = (0..COLUMNS * 48).map(|at| grey(tone(at) + noise(at))).collect();
    let difference = |contrast| {
        let (found, _) = shown(&picture, Adjustments { contrast, ..Adjustments::default() });
        found[20 * COLUMNS + 14][1] / found[20 * COLUMNS + 10][1]
    };
    let [none, chosen] = [Some(0.0), None].map(difference);
    assert!(none < 1.1 && chosen > none + 0.15, "{none} {chosen}");
}

/// Colours of a photograph that are darker than the display's black fade with their light: faster than in Oklab, where the
/// chroma of a colour falls as the cube root of its light, and slower than if black light were added to them.
#[test]
fn colours_darker_than_the_display_black_fade() {
    let lights = [0.08, 0.03, 0.01, 0.003];
    let noise = |at: usize| 1.0 + 0.02 * (at * 7 % 5) as f64;
    let shown_at = |colour: [f64; 3]| {
        let of = |at: usize| match at % COLUMNS / 8 {
            band @ 0..4 => colour.map(|one| (one * lights[band] * noise(at)) as f32),
            _ => grey(0.6 * noise(at)),
        };
        let picture: Vec<[f32; 3]> = (0..COLUMNS * 48).map(of).collect();
        assert_eq!(drawn(&picture), 0.0);
        let (found, _) = shown(&picture, Adjustments { exposure: Some(0.0), ..Adjustments::default() });
        [0, 1, 2, 3].map(|band| found[20 * COLUMNS + 8 * band + 4])
    };
    let [x, y, z] = D65_WHITE.to_array();
    let white = inks().colours[1].clone();
    let [coloured, neutral] = [shown_at([0.97 * x, y, 1.1 * z]), shown_at([x, y, z])];
    let opponents = |pixel: [f64; 3]| {
        let [x, y, z] = [pixel[0] / white.X, pixel[1] / white.Y, pixel[2] / white.Z].map(f64::cbrt);
        [500.0 * (x - y), 200.0 * (y - z)]
    };
    let chroma = |band: usize| {
        let [one, other] = [coloured[band], neutral[band]].map(opponents);
        (one[0] - other[0]).hypot(one[1] - other[1])
    };
    let first = chroma(0);
    for (band, light) in lights.iter().enumerate().skip(1) {
        let ratio = light / lights[0];
        let part = chroma(band) / first;
        assert!(part < 0.95 * ratio.cbrt() && part > ratio, "{light}: {part} of {first}");
    }
}

/// Photographs without light tones are exposed for them, drawings and pictures with margins of white are not
/// taken for each other, and given numbers are used.
#[test]
fn adjustments_are_chosen_for_the_picture() {
    let of = |pixels: &[[f32; 3]]| shown(pixels, Adjustments::default()).1;
    let bright = of(&photograph(1.0));
    assert!(bright.exposure == 0.0 && drawn(&photograph(1.0)) == 0.0 && bright.contrast > 1.15, "{bright:?}");
    assert_eq!(bright.saturation, 1.0);
    // The brightest tones have 0.9 of this light, less their noise: half of white by 0.15 stops, and one stop at most.
    let [dim, dark] = [0.5, 0.1].map(|most| of(&photograph(most)).exposure);
    assert!((0.14..=0.17).contains(&dim) && dark == 1.0, "{dim} {dark}");
    let mut margins = vec![grey(1.0); COLUMNS * 200];
    margins.extend(photograph(1.0));
    let framed = of(&margins);
    // The margin is a drawing beside the photograph.
    assert!((drawn(&margins) - 200.0 / 248.0).abs() < 1e-9);
    assert_eq!(framed.below_black_fraction, bright.below_black_fraction);
    let chart: Vec<[f32; 3]> = (0..COLUMNS * 48).map(|at| grey([0.1, 0.3][at / 32 % 2])).collect();
    assert_eq!(drawn(&chart), 1.0);
    let chart = of(&chart);
    assert_eq!((chart.exposure, chart.contrast, chart.saturation), (0.0, 1.0, 1.0));
    let given = Adjustments {
        exposure: Some(-1.0),
        contrast: Some(2.0),
        saturation: Some(0.5),
        white_balance_k: None,
    };
    let (_, found) = shown(&photograph(0.25), given);
    assert_eq!((found.exposure, found.contrast, found.saturation), (-1.0, 2.0, 0.5));
}

/// A white below a black body of 3000 K becomes white with that white balance.
#[test]
fn white_balance_makes_the_light_of_the_photograph_white() {
    let grid = Grid::new(380.0, 780.0, 5.0).unwrap();
    let Xyz { x, y, z } = Observer::new(&grid).unwrap().xyz(&planck(3000.0, &grid).unwrap());
    let warm = Adaptation::between(D65_WHITE, Xyz { x: x / y, y: 1.0, z: z / y }).unwrap();
    let through = |pixel: &[f32; 3]| warm.apply(super::colour(*pixel)).to_array().map(|one| one as f32);
    let picture = photograph(1.0);
    let tinted: Vec<[f32; 3]> = picture.iter().map(through).collect();
    let balanced = Adjustments { white_balance_k: Some(3000.0), ..Adjustments::default() };
    let [plain, corrected, left] =
        [(&picture, Adjustments::default()), (&tinted, balanced), (&tinted, Adjustments::default())]
            .map(|(pixels, adjustments)| shown(pixels, adjustments).0);
    let apart = |one: &[[f64; 3]], other: &[[f64; 3]]| {
        one.iter().flatten().zip(other.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(apart(&plain, &corrected) < 1e-3 && apart(&plain, &left) > 0.05);
}
