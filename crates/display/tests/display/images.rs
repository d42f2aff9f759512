//! Pictures on displays as the reader sees them: light by light, held while the light changes, blurred.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::image::{HeldPicture, ImageSettings, ScreenWhite, SourceImage, image};
use papilio_display::scene::Scene;
use papilio_display::{Control, DisplayError};
use papilio_scenario::Scenario;

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
