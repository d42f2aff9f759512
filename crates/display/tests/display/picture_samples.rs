//! Pictures with several samples in each pixel: sub-pixels at their places, with their colours, and as
//! crosstalk has them.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::image::{ImageResult, ImageSettings, PictureSurround, Screen, SourceImage, image};
use papilio_display::scene::Scene;
use papilio_display::spatial::crosstalk;
use papilio_display::{Control, DisplayError};
use papilio_scenario::Scenario;

use crate::common;

const FILM: &str = "[display.pixel]\nmodel = \"film\"\nsubstrate = \"Al\"\n\
    gap_nm = { red = 275.9, green = 192.3, blue = 137.8, dark = 20.0 }\n\
    film = [{ material = \"Si3N4\", thickness_nm = 55.9 }, { material = \"Cr:Johnson\", thickness_nm = 12.15 },\n\
    { material = \"SiO2\", thickness_nm = 38.6 }, { material = \"AlOx\", thickness_nm = 9.0 }, { material = \"air\", thickness_nm = \"gap\" }]\n";
const DIFFUSED: &str = "[display.glass]\nindex = 1.5\nthickness_mm = 0.3\n[display.diffuser]\nmodel = \"k-correlation\"\nhaze = 0.5\ntransmittance = 0.9\n";
const BARE: &str = "[display.glass]\nindex = 1.5\nthickness_mm = 0.3\n";
const LIGHT: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.6\n[[lighting.directed]]\ntheta_deg = -45\nshare = 0.4\n";
const VIEW: &str = "[viewer]\ntheta_deg = 20\nphi_deg = 30\nfield_deg = 0\n";

fn scene(parts: &[&str]) -> Scene {
    let text = format!("[spectrum]\nstep_nm = 40\n{}[solver]\nrelative_error = 1e-5\n", parts.concat());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    Scenario::from_text(&text, "samples.toml", &folder, &[]).unwrap().resolve().unwrap().scene
}

/// A picture of given states, with several samples in each pixel.
fn sampled(display: &Scene, columns: usize, states: &[u8], samples_per_pixel: usize) -> ImageResult {
    let (given, surround) = (Some(states.to_vec()), PictureSurround::Repeat);
    let settings = ImageSettings { given, surround, samples_per_pixel, ..Default::default() };
    tried(display, columns, &settings, states.len()).unwrap()
}

fn tried(
    display: &Scene,
    columns: usize,
    settings: &ImageSettings,
    pixels: usize,
) -> Result<ImageResult, DisplayError> {
    let source = SourceImage { columns, pixels: vec![[0.5; 3]; pixels] };
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    image(display, &source, settings, Screen::default(), &control)
}

fn number(display: &Scene, state: &str) -> u8 {
    display.display.state_names().iter().position(|name| name == state).unwrap() as u8
}

/// Mean of the samples of a rectangle, Y.
fn mean(found: &ImageResult, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) -> f64 {
    let width = found.seen_size()[0];
    let count = (columns.len() * rows.len()) as f64;
    let samples = rows.flat_map(|row| columns.clone().map(move |column| row * width + column));
    samples.map(|at| f64::from(found.seen[at][1])).sum::<f64>() / count
}

/// Without a diffuser, each sample has the colour of a display with that sub-pixel alone, and the pixel is
/// the right way up.
#[test]
fn samples_of_bare_panels_are_sub_pixels() {
    let matrix = "[display.matrix]\nppi = 150\nsubpixel = { red = [[0, 0, 0.5, 0.5]], green = [[0.5, 0, 1, 1]], blue = [[0, 0.5, 0.5, 1]] }\n";
    let areas = "area = { red = 0.25, green = 0.5, blue = 0.25 }\nfill_factor = 1.0\n";
    let display = scene(&[BARE, matrix, FILM, areas, LIGHT, VIEW]);
    let white = number(&display, "white");
    let found = sampled(&display, 3, &[white; 6], 2);
    assert_eq!((found.size, found.seen_size(), found.seen.len()), ([3, 2], [6, 4], 24));
    assert_eq!(found.on_screen.len(), 24);
    let alone = |name: &str| {
        let mut alone = display.clone();
        let papilio_display::scene::Pixel::Film(film) = &mut alone.display.pixel else { unreachable!() };
        film.sub_pixels.iter_mut().for_each(|one| one.area = f64::from(u8::from(one.name == name)));
        let run = common::run(&alone).unwrap();
        let page = &run.views[0].states.get("white").unwrap().value;
        [page.X, page.Y, page.Z]
    };
    // Rows from the top: blue above red on the left, green on the right.
    for (at, name) in [(0, "blue"), (1, "green"), (6, "red"), (7, "green"), (4, "blue"), (22, "red")] {
        for (seen, expected) in found.seen[at].iter().zip(alone(name)) {
            assert!((f64::from(*seen) - expected).abs() < 2e-6, "{at} {name}: {seen} {expected}");
        }
    }
}

/// The samples of a uniform picture have the mean of the page, also where layers return light.
#[test]
fn means_of_samples_are_those_of_pages() {
    let front = "[[display.front]]\nreflectance = 0.08\nabsorptance = 0.02\ngap_mm = 0\n";
    let areas = "area = { red = 0.493, green = 0.381, blue = 0.126 }\nfill_factor = 0.873\n";
    for (front, samples, states) in [("", 3, ["cyan"]), (front, 2, ["white"])] {
        let display = scene(&[DIFFUSED, front, "[display.matrix]\nppi = 150\n", FILM, areas, LIGHT, VIEW]);
        for state in states {
            let found = sampled(&display, 2, &[number(&display, state); 4], samples);
            let page = common::run(&display).unwrap().views[0].states.get(state).unwrap().value.Y;
            let seen = mean(&found, 0..2 * samples, 0..2 * samples);
            assert!((seen - page).abs() < 1e-5, "{state}: {seen} {page}");
            let largest = found.seen.iter().map(|sample| f64::from(sample[1])).fold(0.0, f64::max);
            assert!(state == "black" || largest > 1.02 * seen, "{state}: no sub-pixels: {largest} {seen}");
        }
    }
}

/// The sample in the middle of a pixel without sub-pixels is the pixel's only sample, in any picture.
#[test]
fn middle_samples_are_those_of_pixels() {
    let mirror = "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.6, grey = 0.3, black = 0.03 }\n";
    let display = scene(&[DIFFUSED, "[display.matrix]\npitch_um = [120, 90]\n", mirror, LIGHT, VIEW]);
    let states: Vec<u8> = (0..80_u32).map(|k| ((k * k + 7 * k / 5) % 3) as u8).collect();
    let [one, nine] = [1, 3].map(|samples| sampled(&display, 10, &states, samples));
    assert_eq!(one.numbers.against_mapped, nine.numbers.against_mapped);
    for (at, pixel) in one.seen.iter().enumerate() {
        let [column, row] = [at % 10, at / 10];
        let middle = nine.seen[(3 * row + 1) * 30 + 3 * column + 1];
        for (one, middle) in pixel.iter().zip(middle) {
            assert!((one - middle).abs() < 2e-4, "{column}, {row}: {one} {middle}");
        }
    }
}

/// What is seen through the window of a sub-pixel comes from the sub-pixels that crosstalk names.
#[test]
fn windows_show_the_shares_of_crosstalk() {
    let areas = "area = { red = 0.3333, green = 0.3334, blue = 0.3333 }\nfill_factor = 1.0\n";
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    let display = scene(&[DIFFUSED, "[display.matrix]\nppi = 100\n", FILM, areas, LIGHT, view]);
    let page = |state: &str| sampled(&display, 4, &[number(&display, state); 16], 9);
    let (white, black) = (page("white"), page("black"));
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let expected = crosstalk(&display, "text", &control).unwrap();
    for (source, state) in ["red", "green", "blue"].into_iter().enumerate() {
        let driven = page(state);
        for window in 0..3 {
            let seen = |found: &ImageResult| mean(found, 9 + 3 * window..12 + 3 * window, 9..18);
            // The sub-pixel shows its colour beside dark ones, whose light is that of a black page at most.
            let share = (seen(&driven) - seen(&black)) / seen(&white);
            let expected = expected.views[0].shares.out[window][source];
            let allowed = seen(&black) / seen(&white) + 2e-3;
            assert!((share - expected).abs() < allowed, "{state} in {window}: {share} {expected}");
            assert!(window != source || expected > 0.5, "{state}: {expected}");
        }
    }
}

/// Too many samples, and too many different cells, are refused before anything is computed with them.
#[test]
fn too_many_samples_are_refused() {
    // Steps whose edges lie differently in each cell.
    let steps: Vec<String> = (0..20)
        .map(|k| {
            format!("[{}, 0, {}, {}]", 0.05 * f64::from(k), 0.05 * f64::from(k + 1), 0.031 * f64::from(k + 1))
        })
        .collect();
    let matrix = format!(
        "[display.matrix]\nppi = 150\nsubpixel = {{ red = [{}], green = [[0, 0.7, 1, 0.8]], blue = [[0, 0.85, 1, 0.95]] }}\n",
        steps.join(", ")
    );
    let areas = "area = { red = 0.61942, green = 0.19029, blue = 0.19029 }\nfill_factor = 0.5255\n";
    let display = scene(&[DIFFUSED, &matrix, FILM, areas, LIGHT, VIEW]);
    let refused = |samples_per_pixel, columns: usize| {
        let given = Some(vec![0; columns * 10]);
        let settings = ImageSettings { given, samples_per_pixel, ..Default::default() };
        tried(&display, columns, &settings, columns * 10).err().unwrap().to_string()
    };
    let many = refused(32, 6400);
    assert!(many.contains("65536000 samples") && many.contains("samples_per_pixel"), "{many}");
    let cells = refused(32, 10);
    assert!(cells.contains("different cells (expected at most 256"), "{cells}");
}
