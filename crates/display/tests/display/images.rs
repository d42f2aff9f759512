//! Pictures on displays as the reader sees them: light by light, held while the light changes, blurred.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_colour::mapping::Intent;
use papilio_display::image::{
    Halftone, HeldPicture, ImageSettings, KnownLights, PictureSurround, Screen, SourceImage, exact, image,
};
use papilio_display::scene::Scene;
use papilio_display::spatial::walk::pattern;
use papilio_display::spatial::{Patterns, mtf};
use papilio_display::{Control, DisplayError};
use papilio_scenario::Scenario;
use papilio_testing::{Dice, everyday};
use papilio_transport::walk::places::{Pattern, SeenFrom};

use crate::common::{prepared_for, scenario};

const GLASS: &str = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\nthickness_mm = 0.5\n";
const MATRIX: &str = "[display.matrix]\nppi = 150\n";
const PAPER: &str = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.6, grey = 0.3, black = 0.03 }\n";
const LIGHT: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"A\"\ndiffuse = 0.6\n[[lighting.directed]]\ntheta_deg = -45\nshare = 0.4\nspectrum = \"D65\"\n";
const VIEW: &str = "[viewer]\ntheta_deg = 8\nfield_deg = 0\n";

fn scene(parts: &[&str]) -> Scene {
    let text = format!("[spectrum]\nstep_nm = 40\n{}[solver]\nrelative_error = 1e-5\n", parts.concat());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    Scenario::from_text(&text, "images.toml", &folder, &[]).unwrap().resolve().unwrap().scene
}

/// A ramp of greys with coloured rows.
fn ramp() -> SourceImage {
    let pixel = |k: usize| {
        let grey = (k % 12) as f32 / 11.0;
        [0.95 * grey, grey, 1.09 * grey * (1.0 - 0.05 * (k / 12) as f32)]
    };
    SourceImage { columns: 12, pixels: (0..96).map(pixel).collect() }
}

fn control<T>(of: impl FnOnce(&Control<'_>) -> Result<T, DisplayError>) -> T {
    of(&Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) }).unwrap()
}

/// Lights add: what is seen is the sum over them, with any factors; a perfect white, too.
#[test]
fn a_picture_is_the_sum_of_those_in_each_light() {
    let both = scene(&[GLASS, MATRIX, PAPER, LIGHT, VIEW]);
    let settings = ImageSettings::default();
    let held = control(|control| HeldPicture::new(&both, &ramp(), &settings, control));
    let whole = control(|control| image(&both, &ramp(), &settings, Screen::default(), control));
    assert_eq!(held.states, whole.states);
    // The linear picture is the one on the screen, before it is encoded: adapted to the light, which is not
    // D65.
    let encoded = |linear: f32| match linear.clamp(0.0, 1.0) {
        dark if dark <= 0.003_130_8 => 12.92 * dark,
        light => 1.055 * light.powf(1.0 / 2.4) - 0.055,
    };
    for (sample, bytes) in whole.on_screen.iter().enumerate() {
        let linear = whole.linear()(sample);
        let close = |(linear, byte): (&f32, &u8)| (255.0 * encoded(*linear) - f32::from(*byte)).abs() < 0.51;
        assert!(linear.iter().zip(bytes).all(close), "{linear:?} {bytes:?}");
    }
    let factors = control(|control| held.factors(&both, control));
    let names: Vec<&str> = factors.lights.iter().map(|one| one.light.as_str()).collect();
    assert_eq!(names, ["diffuse", "directed.0"]);
    let white = (0..3).map(|k| factors.lights.iter().map(|one| one.white[k]).sum::<f64>());
    let expected = whole.palette.white_XYZ;
    white
        .zip(expected)
        .for_each(|(sum, expected)| assert!((sum - expected).abs() < 1e-12, "{sum} {expected}"));
    let allowed = 1e-6 + factors.error + whole.numbers.error;
    for (at, seen) in whole.seen.iter().enumerate() {
        for (k, seen) in seen.iter().enumerate() {
            let sum: f32 = factors.lights.iter().map(|one| one.pixels[at][k]).sum();
            assert!(f64::from((sum - seen).abs()) < allowed, "pixel {at}: {sum} {seen}");
        }
    }
    // The lamp twice as bright.
    let [diffuse, directed] = [300.0, 400.0].map(|lx| format!("= {}", lx / 700.0));
    let brighter = LIGHT.replace("500", "700").replace("= 0.4", &directed).replace("= 0.6", &diffuse);
    let brighter = scene(&[GLASS, MATRIX, PAPER, &brighter, VIEW]);
    let found = control(|control| held.factors(&brighter, control));
    for (one, other) in factors.lights.iter().zip(&found.lights) {
        let factor = if one.light == "diffuse" { 5.0 / 7.0 } else { 10.0 / 7.0 };
        let pairs = one.pixels.iter().flatten().zip(other.pixels.iter().flatten());
        pairs.for_each(|(one, other)| assert!((one * factor - other).abs() < 2e-5, "{one} {other}"));
    }
}

/// Lights of earlier scenes give what a computation without them gives, whichever light, illuminance, lamp or
/// view has changed.
#[test]
fn known_lights_give_the_same_pictures() {
    let front = "[lighting.front_light]\nilluminance_lx = 40\nspectrum = \"LED-B3\"\n";
    let lit = |light: &str, view: &str| scene(&[GLASS, MATRIX, PAPER, light, front, view]);
    let first = lit(LIGHT, VIEW);
    let settings = ImageSettings::default();
    let held = control(|control| HeldPicture::new(&first, &ramp(), &settings, control));
    let scenes = [
        first,
        lit(&LIGHT.replace("500", "900").replace("0.4", "0.7").replace("0.6", "0.3"), VIEW),
        lit(&LIGHT.replace("-45", "-30"), VIEW),
        lit(&LIGHT.replace("\"A\"", "\"D50\""), VIEW),
        lit(LIGHT, &VIEW.replace('8', "25")),
        lit(LIGHT, VIEW),
    ];
    let series = control(|control| {
        let (mut prepared, mut known) = (prepared_for(&scenes[0])?, KnownLights::default());
        let each = scenes.iter().map(|scene| held.factors_with(scene, &mut prepared, &mut known, control));
        each.collect::<Result<Vec<_>, _>>()
    });
    for (scene, found) in scenes.iter().zip(&series) {
        let fresh = control(|control| held.factors(scene, control));
        assert_eq!(fresh.pages.len(), found.pages.len());
        for (one, other) in fresh.lights.iter().zip(&found.lights) {
            assert_eq!(one.light, other.light);
            let whites = one.white.iter().zip(&other.white);
            whites.for_each(|(one, other)| assert!((one - other).abs() < 1e-12, "{one} {other}"));
            let pairs = one.pixels.iter().flatten().zip(other.pixels.iter().flatten());
            pairs.for_each(|(one, other)| assert!((one - other).abs() < 2e-5, "{one} {other}"));
        }
    }
    // A light that has not changed is not computed again, and one that has is.
    assert!(series[0].lights[0].pixels == series[2].lights[0].pixels, "diffuse light is computed again");
    assert_ne!(series[0].lights[1].pixels, series[2].lights[1].pixels);
}

/// Below a diffuser the transform of a picture is kept: other lights, views, lobes and margins give what a
/// computation without it gives, and another picture of the same size is not taken for the first.
#[test]
fn known_transforms_give_the_same_pictures() {
    let lit = |light: &str, view: &str, diffuser: &str| scene(&[diffuser, MATRIX, MIRROR, light, view]);
    let of_glass = |mm: &str| DIFFUSED.replace("thickness_mm = 0.5", &format!("thickness_mm = {mm}"));
    // The margin of the thick glass does not fit into that of the thin one.
    let [thin, thick] = ["0.1", "5"].map(of_glass);
    let first = lit(LIGHT, VIEW, &thin);
    let scenes = [
        first.clone(),
        lit(&LIGHT.replace("-45", "-30"), VIEW, &thin),
        lit(&LIGHT.replace("\"A\"", "\"D50\""), VIEW, &thin),
        lit(LIGHT, &VIEW.replace('8', "25"), &thin),
        lit(LIGHT, VIEW, &thick.replace("haze = 0.5", "haze = 0.9")),
    ];
    let held = control(|control| HeldPicture::new(&first, &ramp(), &ImageSettings::default(), control));
    let masked = HeldPicture { surround: PictureSurround::BlackMask, ..held.clone() };
    let reversed = HeldPicture { states: held.states.iter().rev().copied().collect(), ..masked.clone() };
    assert_ne!(reversed.states, held.states);
    let (mut prepared, mut known) = (prepared_for(&first).unwrap(), KnownLights::default());
    for picture in [held, masked, reversed] {
        for scene in &scenes {
            let found = control(|control| picture.factors_with(scene, &mut prepared, &mut known, control));
            let fresh = control(|control| picture.factors(scene, control));
            assert!(fresh.error < 0.2, "{}", fresh.error);
            for (one, other) in fresh.lights.iter().zip(&found.lights) {
                let pairs = one.pixels.iter().flatten().zip(other.pixels.iter().flatten());
                // Lights that are computed together share their shapes, which may miss 1e-4.
                pairs.for_each(|(one, other)| assert!((one - other).abs() < 2e-4, "{one} {other}"));
            }
        }
    }
}

const DIFFUSED: &str = "[display.glass]\nindex = 1.5\nthickness_mm = 0.5\n[display.diffuser]\nmodel = \"k-correlation\"\nhaze = 0.5\ntransmittance = 0.9\n";
const MIRROR: &str = "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.6, grey = 0.3, black = 0.03 }\n";

/// Any kind of display: a uniform picture has the colour of its page.
#[test]
fn uniform_pictures_have_the_colours_of_pages() {
    for (pixel, layers) in [(MIRROR, DIFFUSED), (PAPER, DIFFUSED), (MIRROR, GLASS), (PAPER, GLASS)] {
        let display = scene(&[layers, MATRIX, pixel, LIGHT, VIEW]);
        let run = crate::common::run(&display).unwrap();
        for (number, (_, page)) in run.views[0].states.iter().enumerate() {
            let held = HeldPicture {
                size: [5, 4],
                states: vec![number as u8; 20],
                names: ["white", "grey", "black"].map(str::to_owned).to_vec(),
                surround: PictureSurround::Repeat,
            };
            let factors = control(|control| held.factors(&display, control));
            let expected = [page.value.X, page.value.Y, page.value.Z];
            for (k, expected) in expected.iter().enumerate() {
                let sum: f32 = factors.lights.iter().map(|one| one.pixels[7][k]).sum();
                let off = (f64::from(sum) - expected).abs();
                assert!(off < 1e-6 + factors.error, "{layers}{pixel}{number}: {off}");
            }
        }
    }
}

/// Stripes below a lobe, seen at the middle of their pixels: sums of the edge spread of `mtf`, which has no
/// cells. A black mask takes what the first column would see beyond its border.
#[test]
fn stripes_below_a_diffuser_are_sums_of_the_edge_spread() {
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    let light = "[lighting]\nilluminance_lx = 500\nspectrum = \"A\"\ndiffuse = 1\n";
    let display = scene(&[DIFFUSED, MATRIX, MIRROR, light, view]);
    // Four white columns, four black ones.
    let states: Vec<u8> = (0..16 * 16).map(|k| if k % 8 < 4 { 0 } else { 2 }).collect();
    let names = ["white", "grey", "black"].map(str::to_owned).to_vec();
    let mut held = HeldPicture { size: [16, 16], states, names, surround: PictureSurround::Repeat };
    let seen =
        |held: &HeldPicture| control(|control| held.factors(&display, control)).lights.remove(0).pixels;
    let run = crate::common::run(&display).unwrap();
    let page = |state: &str| run.views[0].states.get(state).unwrap().value.Y;
    let pitch_um = 25_400.0 / 150.0;
    let mtf = control(|control| mtf(&display, &Patterns::default(), control));
    let below = |state: &str, at_um: f64| {
        let tables = &mtf.views[0].states.get(state).unwrap().spread;
        let table = tables.iter().find(|table| table.axis == 0 && table.light == "all").unwrap();
        let (place, share) = (&table.position_um, &table.edge_spread);
        let k = place.partition_point(|place| *place < at_um).clamp(1, place.len() - 1);
        let step = (at_um - place[k - 1]) / (place[k] - place[k - 1]);
        (share[k - 1] + (share[k] - share[k - 1]) * step).clamp(0.0, 1.0)
    };
    let found = seen(&held);
    for column in 0..8 {
        let of_stripes = |state: &str, first: i32| {
            let stripe = |k: i32| {
                let from = (f64::from(8 * k + first - column) - 0.5) * pitch_um;
                below(state, from + 4.0 * pitch_um) - below(state, from)
            };
            page(state) * (-20..20).map(stripe).sum::<f64>()
        };
        let expected = of_stripes("white", 0) + of_stripes("black", 4);
        let value = f64::from(found[8 * 16 + column as usize][1]);
        assert!((value - expected).abs() < 2e-3 * page("white"), "{column}: {value} {expected}");
    }
    held.states.fill(0);
    held.surround = PictureSurround::BlackMask;
    let masked = seen(&held);
    // The first column is half a pixel from the mask, one in the middle 8.5 pixels.
    let (middle, edge) = (f64::from(masked[8 * 16 + 8][1]), f64::from(masked[8 * 16][1]));
    let lost = below("white", -0.5 * pitch_um) - below("white", -8.5 * pitch_um);
    let off = middle - edge - page("white") * lost;
    assert!(lost > 0.01 && off.abs() < 2e-3 * page("white"), "{middle} {edge} {lost}");
}

/// Settings for a picture that repeats.
fn repeated() -> ImageSettings {
    ImageSettings { surround: PictureSurround::Repeat, ..ImageSettings::default() }
}

/// A uniform page before an eye at a distance: its corners and its middle have the colours of `run` in their
/// own directions, and so has, within the stated error, a place between them.
#[test]
fn each_part_of_a_panel_is_seen_in_its_own_direction() {
    let matrix = "[display.matrix]\npitch_um = 10000\npixels = [9, 13]\n";
    let viewer = "[viewer]\ntheta_deg = 20\nfield_deg = 2\ndistance_mm = 400\n";
    let display = scene(&[DIFFUSED, matrix, MIRROR, LIGHT, viewer]);
    let source = SourceImage { columns: 9, pixels: vec![[0.95047, 1.0, 1.08883]; 9 * 13] };
    let settings = ImageSettings { perspective: true, ..repeated() };
    let found = control(|control| image(&display, &source, &settings, Screen::default(), control));
    assert_eq!(found.numbers.coverage.as_ref().unwrap().get("white"), Some(&1.0));
    for [column, row] in [[4, 6], [0, 0], [8, 0], [8, 12], [2, 3]] {
        let there = from_pixel(&display, [9, 13], [column, row], 10.0);
        let page = crate::common::run(&there).unwrap().views[0].states.get("white").unwrap().value.Y;
        let seen = f64::from(found.seen[row * 9 + column][1]);
        let allowed = if [column, row] == [2, 3] { 2.0 * found.numbers.error } else { 1e-4 };
        assert!((seen - page).abs() < allowed, "{column}, {row}: {seen} {page}");
    }
    let one = repeated();
    let flat = control(|control| image(&display, &source, &one, Screen::default(), control));
    assert!(flat.seen.iter().all(|pixel| (pixel[1] - found.seen[6 * 9 + 4][1]).abs() < 1e-4));
}

/// The scene as an eye at its place sees a pixel of a panel of `size`, whose pixels are `pitch_mm` apart.
fn from_pixel(display: &Scene, size: [usize; 2], [column, row]: [usize; 2], pitch_mm: f64) -> Scene {
    let (theta, distance) = (display.viewer.theta_deg[0].to_radians(), display.viewer.distance_mm);
    let x = pitch_mm * (column as f64 - 0.5 * (size[0] - 1) as f64);
    let y = pitch_mm * (0.5 * (size[1] - 1) as f64 - row as f64);
    let (dx, dy) = (distance * theta.sin() - x, -y);
    let mut there = display.clone();
    there.viewer.theta_deg = vec![dx.hypot(dy).atan2(distance * theta.cos()).to_degrees()];
    there.viewer.phi_deg = vec![dy.atan2(dx).to_degrees()];
    there
}

/// A picture of one state seen through sunglasses: the middle of the panel and the middles of its sides have the colours of `run` in their own
/// directions. The axis of the sunglasses is that of x: in the plane of incidence of what is to the side, and across that of what is above.
#[test]
fn pictures_through_sunglasses_have_the_colours_of_pages() {
    let panel = ["display.matrix.pitch_um=10000", "display.matrix.pixels=[9,9]", "viewer.distance_mm=100"];
    let page = |view: [f64; 2], angle_deg: f64| {
        let [theta, phi] = view;
        let sets = [
            format!("viewer.theta_deg={theta}"),
            format!("viewer.phi_deg={phi}"),
            format!("viewer.polariser={angle_deg}"),
        ];
        let sets: Vec<&str> = panel.into_iter().chain(sets.iter().map(String::as_str)).collect();
        scenario("lcd-sunglasses", &sets).unwrap().scene
    };
    let y = |view, angle_deg| {
        crate::common::run(&page(view, angle_deg)).unwrap().views[0].states.get("white").unwrap().value.Y
    };
    let source = SourceImage { columns: 9, pixels: vec![[0.95047, 1.0, 1.08883]; 81] };
    let settings = ImageSettings { perspective: true, ..ImageSettings::default() };
    let front = page([0.0, 0.0], 0.0);
    let found = control(|control| image(&front, &source, &settings, Screen::default(), control));
    assert_eq!(found.numbers.coverage.as_ref().unwrap().get("white"), Some(&1.0));
    assert!(found.numbers.error < 2e-3, "{}", found.numbers.error);
    let oblique = 40_f64.atan2(100.0).to_degrees();
    for (place, view, angle_deg) in [
        ([4, 4], [0.0, 0.0], 0.0),
        ([0, 4], [oblique, 0.0], 0.0),
        ([8, 4], [oblique, 180.0], 0.0),
        ([4, 0], [oblique, -90.0], 90.0),
        ([4, 8], [oblique, 90.0], -90.0),
    ] {
        let [seen, expected] = [f64::from(found.seen[9 * place[1] + place[0]][1]), y(view, angle_deg)];
        // Directions of the panel are interpolated between places, and those of the pixel in its table.
        assert!(
            (seen - expected).abs() < found.numbers.error,
            "{place:?}: {seen} {expected} {}",
            found.numbers.error
        );
    }
    // A polariser that turned with the view would be closed there.
    assert!(y([oblique, -90.0], 90.0) > y([oblique, -90.0], 0.0) + 0.2);
}

/// A lamp with a radius has its image in the face and in mirrors at the places where a page seen in that
/// direction has it, and nowhere else.
#[test]
fn lamps_have_their_images_at_their_places() {
    let matrix = "[display.matrix]\npitch_um = 10000\npixels = [9, 13]\n";
    let viewer = "[viewer]\ntheta_deg = 20\nfield_deg = 0\ndistance_mm = 400\n";
    let lamp = "[lighting]\nilluminance_lx = 500\nspectrum = \"A\"\ndiffuse = 0.6\n[[lighting.directed]]\ntheta_deg = -23\nradius_deg = 4\nshare = 0.4\n";
    for pixel in [PAPER, MIRROR] {
        let display = scene(&[GLASS, matrix, pixel, lamp, viewer]);
        let source = SourceImage { columns: 9, pixels: vec![[0.95047, 1.0, 1.08883]; 9 * 13] };
        let settings = ImageSettings { perspective: true, ..repeated() };
        let found = control(|control| image(&display, &source, &settings, Screen::default(), control));
        let (mut bright, mut dark) = (0, 0);
        for (column, row) in (0..13).flat_map(|row| (0..9).map(move |column| (column, row))) {
            let there = from_pixel(&display, [9, 13], [column, row], 10.0);
            let [theta, phi] = [there.viewer.theta_deg[0], there.viewer.phi_deg[0]].map(f64::to_radians);
            let (sin, cos) = 23_f64.to_radians().sin_cos();
            let away_deg = (theta.sin() * phi.cos() * sin + theta.cos() * cos).acos().to_degrees();
            // A pixel is 1.4 deg wide.
            if (away_deg - 4.0).abs() < 1.0 {
                continue;
            }
            let page = crate::common::run(&there).unwrap().views[0].states.get("white").unwrap().value.Y;
            let seen = f64::from(found.seen[row * 9 + column][1]);
            // The image has the reflectance in the direction of its middle, 23 deg: that of glass at 27 deg
            // is larger by 1 %, its light by 0.6 %.
            *(if away_deg < 4.0 { &mut bright } else { &mut dark }) += 1;
            assert!(
                (seen - page).abs() < 1e-2 * page + found.numbers.error,
                "{column}, {row}: {seen} {page}"
            );
        }
        assert!(bright >= 4 && dark > 60, "{bright} {dark}");
        // The picture that the panel holds has the images apart.
        let held = control(|control| HeldPicture::new(&display, &source, &settings, control));
        let factors = control(|control| held.factors(&display, control));
        let middle = factors.lights.iter().map(|light| f64::from(light.pixels[6 * 9 + 4][1])).sum::<f64>();
        let white = held.names.iter().position(|name| name == "white").unwrap();
        let [lamp] = factors.lamps.as_slice() else { panic!("{:?}", factors.lamps) };
        let seen = f64::from(found.seen[6 * 9 + 4][1]);
        assert_eq!(lamp.radius_deg, 4.0);
        assert!((middle + lamp.XYZ[white][1] - seen).abs() < 1e-2 * seen, "{middle} {lamp:?} {seen}");
    }
}

/// The images of lamps do not depend on the halftone. Collimated light is drawn as a disc with the
/// illuminance of the lamp: E/(pi sin^2 r cos theta) times what the display mirrors.
#[test]
fn lamps_are_those_of_a_halftone_without_one() {
    let viewer = "[viewer]\ntheta_deg = 20\nfield_deg = 0\n";
    for radius in ["radius_deg = 4\n", ""] {
        let lamp = format!(
            "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.6\n[[lighting.directed]]\ntheta_deg = -23\nshare = 0.4\n{radius}"
        );
        let display = scene(&[GLASS, MATRIX, MIRROR, &lamp, viewer]);
        let (intent, halftone) = (Intent::Relative, Halftone::ErrorDiffusion);
        let settings = ImageSettings { intent, halftone, ..ImageSettings::default() };
        let held = control(|control| HeldPicture::new(&display, &ramp(), &settings, control));
        let by_states = control(|control| held.factors(&display, control));
        let mut prepared = prepared_for(&display).unwrap();
        let (names, exactly) = control(|control| exact(&display, &ramp(), &settings, &mut prepared, control));
        assert_eq!(held.names, names);
        assert_eq!(by_states.lamps, exactly.lamps);
        let [lamp] = exactly.lamps.as_slice() else { panic!("{:?}", exactly.lamps) };
        assert_eq!(lamp.is_collimated, radius.is_empty());
        // The mean colour of the picture is that of its coverages.
        let mean = |pixels: &[[f32; 3]]| pixels.iter().map(|one| f64::from(one[1])).sum::<f64>() / 96.0;
        let covered: f64 =
            exactly.coverage.iter().zip(&exactly.pages).map(|(part, page)| part * page[1]).sum();
        assert!((exactly.coverage.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        assert!((covered - mean(&exactly.lights[0].pixels)).abs() < 1e-6, "{covered}");
        let halftoned = by_states.coverage.iter().zip(&by_states.pages).map(|(part, page)| part * page[1]);
        // Error diffusion of 96 pixels loses light at the borders.
        assert!((halftoned.sum::<f64>() - covered).abs() < 0.05);
        if lamp.is_collimated {
            let result = crate::common::run(&display).unwrap();
            let sine = lamp.radius_deg.to_radians().sin();
            let disc = 0.4 / (sine * sine * 23_f64.to_radians().cos());
            for (name, image) in names.iter().zip(&lamp.XYZ) {
                let wanted = disc * result.views[0].states.get(name).unwrap().value.specular[0];
                assert!((image[1] - wanted).abs() < 2e-3 * wanted, "{name}: {} {wanted}", image[1]);
            }
        }
    }
}

/// Each pixel of a picture below a narrow lobe is what a picture seen in one direction, its own, has there.
#[test]
fn pictures_in_perspective_are_those_of_single_directions() {
    let matrix = "[display.matrix]\npitch_um = 1000\npixels = [60, 80]\n";
    let viewer = "[viewer]\ntheta_deg = 8\nfield_deg = 0\ndistance_mm = 400\n";
    let thick = DIFFUSED.replace("thickness_mm = 0.5", "thickness_mm = 2");
    assert_ne!(thick, DIFFUSED);
    let mut dice = Dice::new(25, 0);
    let source = SourceImage {
        columns: 60,
        pixels: (0..60 * 80)
            .map(|_| if dice.one_in(2) { [0.0; 3] } else { [0.95047, 1.0, 1.08883] })
            .collect(),
    };
    for (pixel, thickness) in [(MIRROR, thick.as_str()), (PAPER, GLASS)] {
        let display = scene(&[thickness, matrix, pixel, LIGHT, viewer]);
        let settings = ImageSettings { perspective: true, ..repeated() };
        let found = control(|control| image(&display, &source, &settings, Screen::default(), control));
        assert!(found.numbers.neighbours_light && found.numbers.error < 5e-3, "{}", found.numbers.error);
        for [column, row] in [[7, 3], [41, 11], [52, 66]] {
            let there = from_pixel(&display, [60, 80], [column, row], 1.0);
            let one = ImageSettings { given: Some(found.states.clone()), ..repeated() };
            let flat = control(|control| image(&there, &source, &one, Screen::default(), control));
            let at = row * 60 + column;
            for (k, seen) in found.seen[at].iter().enumerate() {
                let off = f64::from((seen - flat.seen[at][k]).abs());
                assert!(
                    off < found.numbers.error + flat.numbers.error + 1e-5,
                    "{column}, {row}: {off} {}",
                    found.numbers.error
                );
            }
        }
    }
}

/// A picture that repeats, for paths: each pixel is all of its area.
struct Repeated<'a> {
    held: &'a HeldPicture,
    pitch_mm: f64,
}

impl Pattern for Repeated<'_> {
    fn images(&self) -> usize {
        1
    }

    fn period_mm(&self) -> [f64; 2] {
        [0.0; 2]
    }

    fn shows(&self, place_mm: [f64; 2], covered: &mut dyn FnMut(usize, usize, f64)) {
        // The middle of the first pixel is the origin; rows are counted from the top.
        let [right, up] = place_mm.map(|place| (place / self.pitch_mm + 0.5).floor() as i64);
        let [columns, rows] = self.held.size.map(|count| count as i64);
        let is_beyond = !(0..columns).contains(&right) || !(0..rows).contains(&-up);
        if is_beyond && self.held.surround == PictureSurround::BlackMask {
            return covered(0, BLACK, 1.0);
        }
        let [column, row] = [right.rem_euclid(columns), (-up).rem_euclid(rows)].map(|at| at as usize);
        covered(0, usize::from(self.held.states[row * self.held.size[0] + column]), 1.0);
    }
}

/// State that has no reflectance where a mask is compared.
const BLACK: usize = 2;

/// Two methods: each pixel of a random picture of three states as a sum over kernels, or through all orders
/// below a flat face, and by paths over the actual pattern; that repeats, or lies in a mask. In `cargo xtask full` with
/// 64 x 64 pixels.
#[test]
fn pictures_are_those_of_paths() {
    everyday(1, [12, 64]).for_each(assert_picture_is_that_of_paths);
}

/// Glass, a diffuser and glass.
const LAYERED: &str = "[[display.layers]]\nkind = \"medium\"\nindex = 1.5\nthickness_mm = 0.4\n[[display.layers]]\nkind = \"diffuser\"\nmodel = \"k-correlation\"\nwidth = 0.05\ntransmittance = 0.9\n[[display.layers]]\nkind = \"medium\"\nindex = 1.5\nthickness_mm = 0.3\n";

/// Y of each pixel, and its error: by the sum over all lights, or of a picture in all light, whose kernels
/// may be those of paths.
fn seen_of(held: &HeldPicture, display: &Scene, in_all_light: bool) -> (Vec<f32>, f64) {
    if !in_all_light {
        let factors = control(|control| held.factors(display, control));
        let sum = |at: usize| factors.lights.iter().map(|one| one.pixels[at][1]).sum();
        return ((0..held.states.len()).map(sum).collect(), factors.error);
    }
    let (given, surround) = (Some(held.states.clone()), held.surround);
    let settings = ImageSettings { given, surround, ..ImageSettings::default() };
    let source = SourceImage { columns: held.size[0], pixels: vec![[0.5; 3]; held.states.len()] };
    let found = control(|control| image(display, &source, &settings, Screen::default(), control));
    assert!(found.numbers.neighbours_light);
    (found.seen.iter().map(|pixel| pixel[1]).collect(), found.numbers.error)
}

fn assert_picture_is_that_of_paths(side: usize) {
    let mut dice = Dice::new(20, 7);
    let states: Vec<u8> = (0..side * side).map(|_| dice.below(3) as u8).collect();
    let names = ["white", "grey", "black"].map(str::to_owned).to_vec();
    let repeated = HeldPicture { size: [side; 2], states, names, surround: PictureSurround::Repeat };
    let in_mask = HeldPicture { surround: PictureSurround::BlackMask, ..repeated.clone() };
    let pitch_mm = 25.4 / 150.0;
    let paper = PAPER.replace("black = 0.03", "black = 0");
    let fronted = format!("{DIFFUSED}[[display.front]]\nreflectance = 0.1\ngap_mm = 0.3\n");
    let cases = [
        (MIRROR, fronted.as_str(), &repeated),
        (MIRROR, LAYERED, &repeated),
        (&paper, GLASS, &in_mask),
        (&paper, DIFFUSED, &in_mask),
        // Below a flat face, a mask is compared every day.
        (PAPER, GLASS, &repeated),
        // Compared with paths every day below two lobes (`below_layers.rs`).
        (PAPER, LAYERED, &repeated),
        (PAPER, DIFFUSED, &repeated),
        (MIRROR, DIFFUSED, &repeated),
        (&paper, LAYERED, &in_mask),
    ];
    for (pixel, layers, held) in everyday(4, cases) {
        let display = scene(&[layers, MATRIX, pixel, LIGHT, VIEW]);
        let (seen, stated) = seen_of(held, &display, layers == LAYERED);
        let place = |at: usize| [(at % side) as f64 * pitch_mm, -((at / side) as f64) * pitch_mm];
        // Pixels that reflect nothing show light that few paths find: with 2^15 of them, one of 4096 such pixels was 8 of its
        // errors too dark, and at 2^22 within one. So fewer pixels, with more paths.
        let step = if held.surround == PictureSurround::BlackMask { (side / 12).max(1) } else { 1 };
        let shown: Vec<usize> = (0..side * side).step_by(step).collect();
        let places_mm: Vec<[f64; 2]> = shown.iter().copied().map(place).collect();
        let count = (1 << 15) * (step * step) as u64;
        let repeated = Repeated { held, pitch_mm };
        let seen_from = SeenFrom { pattern: &repeated, places_mm: &places_mm };
        let paths = control(|control| pattern(&display, &seen_from, count, control)).remove(0);
        let mut errors = 0.0;
        for (at, by_paths) in shown.into_iter().zip(&paths.via_pixel) {
            let found = seen[at];
            let expected = by_paths.value + paths.front.value;
            let error = by_paths.standard_error.hypot(paths.front.standard_error);
            // Student's t of 31 degrees of freedom exceeds 6.5 in 3e-7 of all cases.
            let allowed = 6.5 * error + stated + 1e-4;
            let off = (f64::from(found) - expected).abs();
            assert!(off < allowed, "{layers}{pixel} pixel {at}: {found}, {expected} +- {error}, {stated}");
            errors += error / places_mm.len() as f64;
        }
        let white = crate::common::run(&display).unwrap().views[0].states.get("white").unwrap().value.Y;
        assert!(errors < 0.02 * white, "{layers}{pixel}: the errors of paths, {errors}, hide everything");
    }
}

/// A circular polariser over a mirror has one state: no picture, but what `run` computes, with the polarisation of the light.
#[test]
fn a_display_of_one_state_shows_it_everywhere() {
    let crystal = "[display.pixel]\nmodel = \"liquid-crystal\"\nsubstrate = \"Ag\"\nstack = [\n  { kind = \"polariser\", axis_deg = 0, transmittance = 0.499, extinction = 1e-4 },\n  { kind = \"retarder\", axis_deg = 45, retardance_nm = 137.5 },\n]\n";
    let diffuse = "[lighting]\nilluminance_lx = 500\nspectrum = \"A\"\ndiffuse = 1.0\n";
    let one = scene(&[GLASS, crystal, diffuse, VIEW]);
    for halftone in [Halftone::default(), Halftone::None] {
        let settings = ImageSettings { halftone, ..ImageSettings::default() };
        let held = control(|control| HeldPicture::new(&one, &ramp(), &settings, control));
        assert!(held.names.len() == 1 && held.states == vec![0; ramp().pixels.len()]);
        for theta_deg in [8.0, 50.0] {
            let mut there = one.clone();
            there.viewer.theta_deg = vec![theta_deg];
            let seen = control(|control| held.factors(&there, control));
            let run = control(|control| papilio_display::run(&there, control));
            let page = run.views[0].states.get(&held.names[0]).unwrap().value.Y;
            for pixel in 0..held.states.len() {
                let sum: f64 = seen.lights.iter().map(|light| f64::from(light.pixels[pixel][1])).sum();
                assert!((sum - page).abs() < 1e-5 * page, "{theta_deg}: {sum}, a page {page}");
            }
        }
    }
}
