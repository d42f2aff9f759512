//! Pictures on displays as the reader sees them: light by light, held while the light changes, blurred.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::image::{HeldPicture, ImageSettings, PictureSurround, ScreenWhite, SourceImage, image};
use papilio_display::scene::Scene;
use papilio_display::spatial::walk::pattern;
use papilio_display::spatial::{Patterns, mtf};
use papilio_display::{Control, DisplayError};
use papilio_scenario::Scenario;
use papilio_testing::{Dice, everyday};
use papilio_transport::walk::places::{Pattern, SeenFrom};

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

fn control<T>(of: impl Fn(&Control<'_>) -> Result<T, DisplayError>) -> T {
    of(&Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) }).unwrap()
}

/// Lights add: what is seen is the sum over them, with any factors; a perfect white, too.
#[test]
fn a_picture_is_the_sum_of_those_in_each_light() {
    let both = scene(&[GLASS, MATRIX, PAPER, LIGHT, VIEW]);
    let settings = ImageSettings::default();
    let held = control(|control| HeldPicture::new(&both, &ramp(), &settings, control));
    let whole = control(|control| image(&both, &ramp(), &settings, ScreenWhite::Perfect, control));
    assert_eq!(held.states, whole.states);
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

/// Stripes below a lobe, seen at the middle of their pixels: sums of the edge spread of `mtf`, which has no cells. A black mask takes what
/// the first column would see beyond its border.
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

/// A uniform page before an eye at a distance: its corners and its middle have the colours of `run` in their own directions, and so has, within
/// the stated error, a place between them.
#[test]
fn each_part_of_a_panel_is_seen_in_its_own_direction() {
    let matrix = "[display.matrix]\npitch_um = 10000\npixels = [9, 13]\n";
    let viewer = "[viewer]\ntheta_deg = 20\nfield_deg = 2\ndistance_mm = 400\n";
    let display = scene(&[DIFFUSED, matrix, MIRROR, LIGHT, viewer]);
    let source = SourceImage { columns: 9, pixels: vec![[0.95047, 1.0, 1.08883]; 9 * 13] };
    let settings = ImageSettings { perspective: true, ..ImageSettings::default() };
    let found = control(|control| image(&display, &source, &settings, ScreenWhite::Perfect, control));
    assert_eq!(found.numbers.coverage.as_ref().unwrap().get("white"), Some(&1.0));
    let eye = [400.0 * 20_f64.to_radians().sin(), 0.0, 400.0 * 20_f64.to_radians().cos()];
    for [column, row] in [[4, 6], [0, 0], [8, 0], [8, 12], [2, 3]] {
        let (x, y) = (10.0 * (column as f64 - 4.0), 10.0 * (6.0 - row as f64));
        let (dx, dy) = (eye[0] - x, eye[1] - y);
        let mut there = display.clone();
        there.viewer.theta_deg = vec![dx.hypot(dy).atan2(eye[2]).to_degrees()];
        there.viewer.phi_deg = vec![dy.atan2(dx).to_degrees()];
        let page = crate::common::run(&there).unwrap().views[0].states.get("white").unwrap().value.Y;
        let seen = f64::from(found.seen[row * 9 + column][1]);
        let allowed = if [column, row] == [2, 3] { 2.0 * found.numbers.error } else { 1e-4 };
        assert!((seen - page).abs() < allowed, "{column}, {row}: {seen} {page}");
    }
    let one = ImageSettings::default();
    let flat = control(|control| image(&display, &source, &one, ScreenWhite::Perfect, control));
    assert!(flat.seen.iter().all(|pixel| (pixel[1] - found.seen[6 * 9 + 4][1]).abs() < 1e-4));
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
        let column = right.rem_euclid(self.held.size[0] as i64) as usize;
        let row = (-up).rem_euclid(self.held.size[1] as i64) as usize;
        covered(0, usize::from(self.held.states[row * self.held.size[0] + column]), 1.0);
    }
}

/// Two methods: each pixel of a random picture of three states as a sum over kernels, or through all orders below a flat face, and by
/// paths over the actual pattern. In `cargo xtask full` with 64 x 64 pixels.
#[test]
fn pictures_are_those_of_paths() {
    everyday(1, [12, 64]).for_each(assert_picture_is_that_of_paths);
}

fn assert_picture_is_that_of_paths(side: usize) {
    let mut dice = Dice::new(20, 7);
    let states: Vec<u8> = (0..side * side).map(|_| dice.below(3) as u8).collect();
    let names = ["white", "grey", "black"].map(str::to_owned).to_vec();
    let held = HeldPicture { size: [side; 2], states, names, surround: PictureSurround::Repeat };
    let pitch_mm = 25.4 / 150.0;
    for (pixel, layers) in [(MIRROR, DIFFUSED), (PAPER, DIFFUSED), (PAPER, GLASS)] {
        let display = scene(&[layers, MATRIX, pixel, LIGHT, VIEW]);
        let factors = control(|control| held.factors(&display, control));
        let place = |at: usize| [(at % side) as f64 * pitch_mm, -((at / side) as f64) * pitch_mm];
        let places_mm: Vec<[f64; 2]> = (0..side * side).map(place).collect();
        let repeated = Repeated { held: &held, pitch_mm };
        let seen_from = SeenFrom { pattern: &repeated, places_mm: &places_mm };
        let paths = control(|control| pattern(&display, &seen_from, 1 << 15, control)).remove(0);
        let mut errors = 0.0;
        for (at, by_paths) in paths.via_pixel.iter().enumerate() {
            let found: f32 = factors.lights.iter().map(|one| one.pixels[at][1]).sum();
            let expected = by_paths.value + paths.front.value;
            let error = by_paths.standard_error.hypot(paths.front.standard_error);
            // Student's t of 31 degrees of freedom exceeds 6.5 in 3e-7 of all cases.
            let allowed = 6.5 * error + factors.error + 1e-4;
            let off = (f64::from(found) - expected).abs();
            assert!(off < allowed, "{layers}{pixel} pixel {at}: {found}, {expected} +- {error}");
            errors += error / places_mm.len() as f64;
        }
        let white = crate::common::run(&display).unwrap().views[0].states.get("white").unwrap().value.Y;
        assert!(errors < 0.02 * white, "{layers}{pixel}: the errors of paths, {errors}, hide everything");
    }
}
