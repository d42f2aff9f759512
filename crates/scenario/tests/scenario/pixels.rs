//! Pixels from measured BRDFs: the shipped files, what they become, and what is refused.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use papilio_display::scene::{Pixel, Scene};
use papilio_formats::{BsdfFormat, write_measurement};
use papilio_goniometry::{Channel, Instrument, Measurement, ScatterMode, SpecularGrid, Symmetry, View};
use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};
use papilio_scenario::Scenario;

use crate::common::{resolve, shipped};

/// The shipped synthetic paper: matte, with some gloss.
const WHITE: [f64; 3] = [0.42, 0.06, 0.3];
const BLACK: [f64; 3] = [0.015, 0.025, 0.2];

/// f of paper: a matte share, and a lobe of a share and a width about the mirror direction.
fn paper([matte, gloss, width]: [f64; 3]) -> impl Fn(Beta, Beta) -> f64 {
    let lobe = Lobe::KCorrelation { width };
    move |from, to| matte / PI + gloss * lobe.density(from, to)
}

fn measured(
    name: &str,
    paper: &dyn Fn(Beta, Beta) -> f64,
    way: ScatterMode,
    beyond_75_deg: &[f64],
) -> Measurement {
    let steps = |from: u32, to: u32, step: u32| (from..=to).step_by(step as usize).map(f64::from);
    let mut instrument = Instrument::imaging_sphere();
    instrument.grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: steps(0, 75, 15).chain(beyond_75_deg.iter().copied()).collect(),
        azimuths_deg: steps(0, 180, 30).collect(),
        radials_deg: steps(0, 28, 4).chain(steps(30, 180, 10)).collect(),
        symmetry: Symmetry::Plane,
    };
    instrument.channels = vec![Channel::Monochrome];
    let mut measurement =
        instrument.measure(name, &[View { way, f: paper, straight: 0.0, factors: &[1.0] }]).unwrap();
    let rounded = |value: &mut f64| *value = format!("{value:.4e}").parse().unwrap();
    measurement.parts[0].values.iter_mut().for_each(rounded);
    measurement.parts[0].tis.iter_mut().for_each(rounded);
    measurement
}

fn file(measurement: &Measurement) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_measurement(&mut bytes, BsdfFormat::Radiant, measurement).unwrap();
    bytes
}

/// The shipped files equal those of this program. Files that differ are written to the temporary folder of
/// the tests.
#[test]
fn shipped_papers_equal_those_of_the_virtual_instrument() {
    let mut other = Vec::new();
    for (name, parameters) in [("white", WHITE), ("black", BLACK)] {
        let sample = format!("synthetic paper, {name}");
        let made = file(&measured(&sample, &paper(parameters), ScatterMode::FrontReflection, &[85.0]));
        let name = format!("synthetic-paper-{name}.bsdf");
        if fs::read(shipped().join("data").join(&name)).ok().as_ref() != Some(&made) {
            let beside = Path::new(env!("CARGO_TARGET_TMPDIR")).join(&name);
            fs::write(&beside, made).unwrap();
            other.push(beside);
        }
    }
    assert!(other.is_empty(), "these are not what is shipped: {other:?}");
}

fn scene(path: &str) -> Scene {
    Scenario::load(&shipped().join(path), &[]).unwrap().resolve().unwrap().scene
}

/// What the example makes of the files is the paper that they were made from.
#[test]
fn kernel_of_pixel_equals_that_of_its_paper() {
    let scene = scene("epaper-measured.toml");
    assert!(scene.display.panel().is_none());
    let Pixel::Scattering(pixel) = &scene.display.pixel else { panic!("not a scattering pixel") };
    assert_eq!(pixel.states.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["white", "black"]);
    for ((_, kernel), parameters) in pixel.states.iter().zip([WHITE, BLACK]) {
        let truth = paper(parameters);
        let mean = kernel.factor.iter().sum::<f64>() / kernel.factor.len() as f64;
        for (from, to) in [(0.0, 0.3), (0.34, 0.1), (0.5, -0.5), (0.7, 0.7), (0.2, 0.9), (0.9, -0.6)] {
            let [from, to] = [Beta { x: from, y: 0.0 }, Beta { x: to, y: 0.1 }];
            let error = mean * kernel.scatter.evaluate(from, to) / truth(from, to) - 1.0;
            assert!(error.abs() < 0.01, "{from:?} {to:?}: {error}");
        }
    }
}

const PAPER: &str = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\n\n[display.pixel]\nmodel = \"measured\"\n\
                     file = { white = \"w.bsdf\", black = \"b.bsdf\" }\n";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: Vec<u8>| fs::write(folder.path().join(name), bytes).unwrap();
    write("w.bsdf", file(&measured("white", &paper(WHITE), ScatterMode::FrontReflection, &[])));
    write("b.bsdf", file(&measured("black", &paper(BLACK), ScatterMode::FrontReflection, &[])));
    write(
        "bright.bsdf",
        file(&measured("bright", &paper([1.4, 0.0, 0.1]), ScatterMode::FrontReflection, &[])),
    );
    write("through.bsdf", file(&measured("film", &paper(WHITE), ScatterMode::FrontTransmission, &[])));
    write(
        "cut.bsdf",
        file(&measured("white", &paper(WHITE), ScatterMode::FrontReflection, &[]))[..4000].to_vec(),
    );
    write("blue.csv", b"380,0.9\n780,0.1\n".to_vec());
    folder
}

/// Its spectrum colours a state; its level stays that of the file.
#[test]
fn spectra_set_the_shape_and_keep_the_level() {
    let folder = folder();
    let kernels = |text: &str| {
        let scene = resolve(text, folder.path(), &[]).unwrap().scene;
        let Pixel::Scattering(pixel) = scene.display.pixel else { panic!("not a scattering pixel") };
        pixel.states
    };
    let plain = kernels(PAPER);
    let blue = kernels(&format!("{PAPER}spectrum = {{ white = \"blue.csv\" }}\n"));
    let [from, to] = [Beta { x: 0.2, y: 0.0 }, Beta { x: 0.1, y: 0.3 }];
    let at = |kernel: &papilio_display::scene::ScatterKernel, bin: usize| {
        kernel.factor[bin] * kernel.scatter.evaluate(from, to)
    };
    let bins = plain[0].1.factor.len();
    let mean = (0..bins).map(|bin| at(&blue[0].1, bin)).sum::<f64>() / bins as f64;
    assert!((mean / at(&plain[0].1, 0) - 1.0).abs() < 1e-9);
    assert!((at(&blue[0].1, 0) / at(&blue[0].1, bins - 1) - 9.0).abs() < 1e-9);
    assert_eq!(at(&blue[1].1, 0), at(&plain[1].1, 0));
}

/// What is over it, and what the light from beyond the last incidence becomes, is said.
#[test]
fn lost_light_is_reported() {
    let folder = folder();
    let warned = |text: &str| resolve(text, folder.path(), &[]).unwrap().warnings;
    let lost = warned(&format!("{PAPER}extrapolate = \"none\"\n"));
    assert_eq!(lost.len(), 2, "{lost:?}");
    assert!(
        lost[0].contains("display.pixel.file.white: front reflection: nothing was measured beyond 75"),
        "{lost:?}"
    );
    assert_eq!(warned(PAPER), Vec::<String>::new());
    let notes = resolve(PAPER, folder.path(), &[]).unwrap().notes;
    assert!(notes.iter().any(|note| note.contains("the last incidence below 90 deg is 75 deg")), "{notes:?}");
}

#[test]
fn mistakes_are_reported_at_their_places() {
    let folder = folder();
    type Case<'a> = (&'a str, &'a str, (usize, usize), &'a [&'a str]);
    let cases: &[Case<'_>] = &[
        ("\"w.bsdf\"", "\"none.bsdf\"", (7, 18), &["none.bsdf"]),
        ("\"w.bsdf\"", "\"cut.bsdf\"", (7, 18), &["cut.bsdf"]),
        ("\"w.bsdf\"", "\"through.bsdf\"", (7, 18), &["no front reflection", "front transmission"]),
        ("\"w.bsdf\"", "\"bright.bsdf\"", (7, 18), &["1.400 times as much light", "expected at most 1"]),
        (
            "{ white = \"w.bsdf\", black = \"b.bsdf\" }",
            "\"w.bsdf\"",
            (7, 8),
            &["a string", "a table of names"],
        ),
        ("{ white = \"w.bsdf\", black = \"b.bsdf\" }", "{}", (7, 8), &["no states", "white.bsdf"]),
        (
            "file = ",
            "spectrum = { whit = 0.5 }\nfile = ",
            (7, 14),
            &["no state `whit`", "did you mean `white`"],
        ),
        ("file = ", "mounting = \"air\"\nfile = ", (7, 1), &["no key `mounting`"]),
        ("file = ", "angles = \"air\"\nfile = ", (7, 1), &["model = \"measured\"", "model = \"table\""]),
        ("file = ", "normalise = \"white\"\nfile = ", (7, 13), &["\"none\" or \"tis\""]),
        ("index = 1.5", "index = \"BK7\"", (6, 9), &["index of 1.5", "same index at all wavelengths"]),
        (
            "[display.pixel]",
            "[solver]\napproximation = \"single-pass\"\n[display.pixel]",
            (6, 17),
            &["ordinary panel"],
        ),
        (
            "[display.pixel]",
            "[solver]\nangle_medium = \"unrefracted\"\n[display.pixel]",
            (6, 16),
            &["ordinary panel"],
        ),
    ];
    let mut wrong = Vec::new();
    for (from, to, (line, column), said) in cases {
        assert!(PAPER.contains(from));
        let errors = resolve(&PAPER.replacen(from, to, 1), folder.path(), &[]).expect_err(to);
        let shown: Vec<String> = errors.iter().map(ToString::to_string).collect();
        let place = format!("test.toml:{line}:{column}");
        let all = said.iter().copied().chain([&place[..]]);
        if shown.len() != 1 || !all.clone().all(|words| shown[0].contains(words)) {
            wrong.push(format!("{:?}\n{}", all.collect::<Vec<_>>(), shown.join("\n")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// What polarises the light of a table is noted: a face at 40 deg or more, and a polariser before the eye.
#[test]
fn tables_below_faces_have_a_note_of_polarisation() {
    let folder = tempfile::tempdir().unwrap();
    let rows = "state,theta_deg,wavelength_nm,reflectance\nwhite,0,380,0.5\nwhite,0,780,0.5\nwhite,90,380,0.5\nwhite,90,780,0.5\n";
    fs::write(folder.path().join("pixel.csv"), rows).unwrap();
    let is_noted = |surface: &str, viewer: &str| {
        let text = format!(
            "[display.glass]\nindex = 1.5\nsurface = \"{surface}\"\n[display.pixel]\nmodel = \"table\"\nfile = \"pixel.csv\"\nangles = \"air\"\n\
             [lighting]\ndiffuse = 1\nspectrum = \"E\"\n[viewer]\n{viewer}\n"
        );
        let notes = resolve(&text, folder.path(), &[]).unwrap_or_else(|e| panic!("{e}")).notes;
        notes.iter().any(|note| note.contains("a table has no polarisation"))
    };
    assert!(is_noted("fresnel", "theta_deg = 60") && is_noted("ideal-ar", "theta_deg = 0\npolariser = 0"));
    assert!(!is_noted("fresnel", "theta_deg = 8") && !is_noted("ideal-ar", "theta_deg = 60"));
}

/// A pixel whose reflectance is 0.5 + 0.4 cos(10 theta): the error of lines is 5 h^2 for steps h in radians, 0.038
/// over 5 deg and 0.0015 over 1 deg.
#[test]
fn table_with_coarse_angles_has_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let noted = |step: u32| -> Vec<String> {
        let row = |theta: u32, nm: u32| {
            let value = 0.5 + 0.4 * (10.0 * f64::from(theta)).to_radians().cos();
            format!("white,{theta},{nm},{value}\n")
        };
        let angles = (0..=90 / step).map(|k| k * step);
        let rows = angles.flat_map(|theta| [row(theta, 380), row(theta, 780)]);
        let text = format!("state,theta_deg,wavelength_nm,reflectance\n{}", rows.collect::<String>());
        fs::write(folder.path().join("pixel.csv"), text).unwrap();
        let scenario = "[display]\npixel = { model = \"table\", file = \"pixel.csv\", angles = \"air\" }\n\
                        [lighting]\ndiffuse = 1\nspectrum = \"E\"\n[viewer]\ntheta_deg = 8\n";
        let notes = resolve(scenario, folder.path(), &[]).unwrap_or_else(|e| panic!("{e}")).notes;
        notes.into_iter().filter(|note| note.contains("angles of the table")).collect()
    };
    let coarse = noted(5);
    assert!(
        coarse.len() == 1 && coarse[0].contains("pixel.csv: the reflectances change too fast"),
        "{coarse:?}"
    );
    assert_eq!(noted(1), Vec::<String>::new());
}
