//! Crosstalk of mirror-like pixels below a lobe and a front that reflects, against properties that hold whatever the layers are.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::Control;
use papilio_display::spatial::{CrosstalkView, crosstalk};
use papilio_scenario::Scenario;

const LAYERS: &str = "[[display.front]]\nreflectance = 0.4\ngap_mm = 0.1\n[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.1\n\
    transmittance = 0.95\n[display.glass]\nindex = 1.5\nthickness_mm = 0.3\n[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\n\
    diffuse = 0.6\n[[lighting.directed]]\ntheta_deg = -25\nshare = 0.4\n[viewer]\ntheta_deg = 15\nfield_deg = 0\n[spectrum]\nstep_nm = 40\n";
const FILM: &str = "[display.pixel]\nmodel = \"film\"\nsubstrate = \"Al\"\n\
    film = [{ material = \"Cr:Johnson\", thickness_nm = 12 }, { material = \"air\", thickness_nm = \"gap\" }]\n";

fn view(pitch_um: f64, pixel: &str) -> CrosstalkView {
    view_by(pitch_um, pixel, "relative_error = 1e-2")
}

fn view_by(pitch_um: f64, pixel: &str, solver: &str) -> CrosstalkView {
    let text = format!("{LAYERS}[display.matrix]\npitch_um = {pitch_um}\n{pixel}[solver]\n{solver}\n");
    let resolved =
        Scenario::from_text(&text, "returned.toml", Path::new("."), &[]).unwrap().resolve().unwrap();
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    crosstalk(&resolved.scene, "ab", &control).unwrap().views.remove(0)
}

fn mirror([white, black]: [f64; 2]) -> String {
    format!(
        "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = {{ white = {white}, black = {black} }}\n"
    )
}

/// Contrast of each figure via the pixel, with its error.
fn contrasts(view: &CrosstalkView) -> Vec<(f64, f64)> {
    let of = |pattern: &papilio_display::spatial::PatternColours| {
        Some((pattern.values.contrast_ratio_via_pixel?, pattern.error.contrast_ratio_via_pixel?))
    };
    view.patterns.iter().filter_map(of).collect()
}

#[test]
fn figures_of_one_reflectance_are_pages() {
    let film = format!(
        "{FILM}area = {{ red = 0.5, green = 0.5 }}\ngap_nm = {{ red = 200, green = 200, dark = 200 }}\n\
        default_states = false\nstates = {{ white = {{ red = 1, green = 1 }}, black = {{ }} }}\n"
    );
    for pixel in [mirror([0.8, 0.8]), film] {
        let found = contrasts(&view(150.0, &pixel));
        assert_eq!(found.len(), 4, "{pixel}");
        for (contrast, _) in found {
            assert!((contrast - 1.0).abs() < 1e-9, "{pixel}: {contrast}");
        }
    }
}

/// Light returns to the same figure of pixels that are much larger than all lengths.
#[test]
fn figures_of_large_pixels_have_the_contrast_of_pages() {
    let found = contrasts(&view(1e6, &mirror([0.9, 0.2])));
    for (contrast, error) in &found[..3] {
        assert!((contrast / found[0].0 - 1.0).abs() < 2e-3, "{contrast} +- {error}, {found:?}");
    }
}

/// Light that meets figure and page in turn, by paths.
#[test]
fn figures_of_mirrors_are_those_of_paths() {
    let pixel = mirror([0.9, 0.1]);
    let [exact, paths] = ["relative_error = 2e-3", "method = \"monte-carlo\"\npaths = 65536"]
        .map(|solver| view_by(100.0, &pixel, solver));
    for ((value, stated), (found, error)) in contrasts(&exact).into_iter().zip(contrasts(&paths)) {
        assert!((value - found).abs() < 4.0 * stated.hypot(error), "{value} +- {stated}, {found} +- {error}");
        assert!(stated < 5e-3 * value && error < 2e-2 * value, "{value} +- {stated}, {found} +- {error}");
    }
}
