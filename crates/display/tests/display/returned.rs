//! Mirror-like pixels below a lobe and a front that reflects: light that meets them more than once.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::Control;
use papilio_display::spatial::{MtfState, MtfView, mtf};
use papilio_scenario::Scenario;

/// A front at a distance, a lobe, glass, and light from everywhere and from a lamp.
struct Case {
    front: [f64; 2],
    width: f64,
    view_deg: f64,
    diffuse: f64,
}

impl Case {
    fn view(&self, solver: &str) -> (Vec<f64>, MtfView) {
        self.view_of([0.8, 0.05], "", solver)
    }

    /// With these reflectances of white and black, and more tables.
    fn view_of(&self, [white, black]: [f64; 2], tables: &str, solver: &str) -> (Vec<f64>, MtfView) {
        let grey = 0.5 * (white + black);
        let pixel = format!(
            "model = \"uniform\"\nkind = \"mirror\"\nreflectance = {{ white = {white}, black = {black}, grey = {grey} }}"
        );
        self.view_with(&pixel, tables, solver)
    }

    /// With this pixel.
    fn view_with(&self, pixel: &str, tables: &str, solver: &str) -> (Vec<f64>, MtfView) {
        let Self { front: [reflectance, gap_mm], width, view_deg, diffuse } = self;
        let lamp = match diffuse {
            1.0 => String::new(),
            _ => format!("[[lighting.directed]]\ntheta_deg = -50\nshare = {}\n", 1.0 - diffuse),
        };
        let text = format!(
            "[[display.front]]\nreflectance = {reflectance}\ngap_mm = {gap_mm}\n[display.diffuser]\nmodel = \"k-correlation\"\n\
             width = {width}\ntransmittance = 0.95\n[display.glass]\nindex = 1.5\nthickness_mm = 0.3\n\
             [display.pixel]\n{pixel}\n{tables}[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\n\
             diffuse = {diffuse}\n{lamp}[viewer]\ntheta_deg = {view_deg}\nfield_deg = 0\n[spectrum]\nrange_nm = [540, 560]\n\
             step_nm = 20\n[solver]\n{solver}\n"
        );
        let resolved =
            Scenario::from_text(&text, "returned.toml", Path::new("."), &[]).unwrap().resolve().unwrap();
        let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
        let mut found = mtf(&resolved.scene, &resolved.patterns, &control).unwrap();
        (found.frequency_per_mm, found.views.remove(0))
    }
}

fn white(view: &MtfView) -> &MtfState {
    view.states.get("white").unwrap()
}

/// Seen along the normal in diffuse light, for small angles: of light that meets the pixel twice each pass of a lobe adds its
/// width over all that follows, 5 lengths of the glass and 4 of the air. What is neglected, light beyond the hemisphere, is of the order of the
/// width of the lobe, and all there is where a period is longer than the glass is thick.
#[test]
fn returned_light_of_a_narrow_lobe_has_its_closed_form() {
    let case = Case { front: [0.1, 0.2], width: 0.01, view_deg: 0.0, diffuse: 1.0 };
    let (frequencies, view) = case.view("relative_error = 1e-3");
    let (otf, q) = (&white(&view).otf, 0.8 * 0.1 * 0.95 * 0.95);
    let mut without = 0.0_f64;
    for (k, f) in frequencies.iter().enumerate().filter(|(_, f)| **f >= 2.0) {
        let z = |length_mm: f64| (-2.0 * PI * f * 0.01 * length_mm).exp();
        let (glass, air) = (0.3 / 1.5, 0.2);
        let expected = (1.0 - q) * z(glass)
            + (1.0 - q) * q * z(5.0 * glass + 4.0 * air)
            + q * q * z(13.0 * glass + 12.0 * air);
        for (otf, error) in [(&otf.otf_x, &otf.error_x), (&otf.otf_y, &otf.error_y)] {
            let off = (otf[k][0] - expected).hypot(otf[k][1]);
            assert!(off < error[k] + 0.012, "{f}: {:?} +- {} against {expected}", otf[k], error[k]);
        }
        without = without.max(z(glass) - expected);
    }
    assert!(without > 0.025, "{without}");
}

/// By paths: light that the front returns moves by twice the way through the air, and spreads.
#[test]
fn returned_light_is_that_of_paths() {
    let case = Case { front: [0.3, 10.0], width: 0.08, view_deg: 20.0, diffuse: 0.5 };
    let (frequencies, exact) = case.view("relative_error = 5e-2");
    let (_, paths) = case.view("method = \"monte-carlo\"\npaths = 4096");
    for ((name, exact), (_, paths)) in exact.states.iter().zip(paths.states.iter()) {
        let axes = [
            (&exact.otf.otf_x, &exact.otf.error_x, &paths.otf.otf_x, &paths.otf.error_x),
            (&exact.otf.otf_y, &exact.otf.error_y, &paths.otf.otf_y, &paths.otf.error_y),
        ];
        for (axis, (otf, stated, found, error)) in axes.into_iter().enumerate() {
            for (k, f) in frequencies.iter().enumerate() {
                let off = (otf[k][0] - found[k][0]).hypot(otf[k][1] - found[k][1]);
                let allowed = 4.5 * stated[k].hypot(error[k]) + 1e-6;
                let pair = [(otf[k], stated[k]), (found[k], error[k])];
                assert!(off < allowed, "{name} {axis} {f}: {pair:?}");
                assert!(stated[k] < 0.05, "{name} {axis} {f}: {pair:?}");
            }
        }
        let off = (exact.Y_via_pixel - paths.Y_via_pixel).abs();
        assert!(off < 4.5 * exact.Y_via_pixel_error.hypot(paths.Y_via_pixel_error), "{name}: {off}");
    }
}

/// Paths through a long way to the front, which little light takes: most of it is within a part of the glass. What is read from tables of
/// places is that of adding.
#[test]
fn radii_and_edges_do_not_depend_on_how_far_light_goes() {
    let case = Case { front: [0.3, 10.0], width: 0.08, view_deg: 20.0, diffuse: 1.0 };
    let [(_, exact), (_, paths)] =
        ["relative_error = 5e-2", "method = \"monte-carlo\"\npaths = 4096"].map(|solver| case.view(solver));
    let [exact, paths] = [&exact, &paths].map(|view| view.states.get("black").unwrap());
    let read = |state: &MtfState| {
        let (value, error) = (state.scalars, state.error);
        [
            (value.r50_um, error.r50_um),
            (value.edge_10_90_x_um, error.edge_10_90_x_um),
            (value.edge_10_90_y_um, error.edge_10_90_y_um),
        ]
        .map(|(value, error)| (value.unwrap(), error.unwrap()))
    };
    for ((value, stated), (found, error)) in read(exact).into_iter().zip(read(paths)) {
        assert!((value - found).abs() < 4.5 * stated.hypot(error), "{value} +- {stated}, {found} +- {error}");
        assert!(error < 0.05 * found, "{found} +- {error}");
    }
}

/// A matrix, a narrow and a wide pattern of each kind.
const FIGURES: &str = "[display.matrix]\nppi = 300\n[pattern]\nperiod_mm = [0.15, 1.5]\ntext = \"ab\"\n";

/// Numbers of figures with their errors.
fn figures(view: &MtfView) -> Vec<(String, f64, f64)> {
    let lines = view.line_contrast.named().zip(view.line_contrast_error.named());
    let mut all: Vec<_> =
        lines.map(|((name, value), (_, error))| (name.to_owned(), value.unwrap(), error.unwrap())).collect();
    let text = [view.text_contrast_min, view.text_contrast_median];
    for (name, (value, error)) in
        ["least", "median"].into_iter().zip(text.into_iter().zip(view.text_contrast_error.unwrap()))
    {
        all.push((format!("text {name}"), value.unwrap(), error));
    }
    for pattern in &view.patterns {
        let name = format!("{:?} {}", pattern.kind, pattern.period_mm);
        all.push((name, pattern.mean_Y_via_pixel, pattern.error));
    }
    all
}

/// Figures of one reflectance are pages: light of all orders, as a run has it.
#[test]
fn figures_of_equal_states_are_pages() {
    let case = Case { front: [0.5, 0.2], width: 0.08, view_deg: 20.0, diffuse: 0.5 };
    let (_, view) = case.view_of([0.8, 0.8], FIGURES, "relative_error = 1e-1");
    let page = white(&view).Y_via_pixel;
    for (name, value, _) in figures(&view) {
        let expected = if name.starts_with("Stripes") || name.starts_with("Checker") { page } else { 0.0 };
        assert!((value - expected).abs() < 1e-9, "{name}: {value} {expected}");
    }
}

/// At each meeting with a pattern that is much finer than all ways, light meets both halves equally often, whatever it met before: the page
/// of the mean reflectance.
#[test]
fn fine_patterns_are_pages_of_their_mean_reflectance() {
    let case = Case { front: [0.6, 0.2], width: 0.08, view_deg: 20.0, diffuse: 0.5 };
    let tables = "[display.matrix]\nppi = 300\n[pattern]\nperiod_mm = [1e-4]\n";
    let (_, view) = case.view_of([0.9, 0.1], tables, "relative_error = 1e-1");
    let page = view.states.get("grey").unwrap().Y_via_pixel;
    let halves = 0.5 * (white(&view).Y_via_pixel + view.states.get("black").unwrap().Y_via_pixel);
    for pattern in &view.patterns {
        let off = (pattern.mean_Y_via_pixel - page).abs();
        assert!(off < pattern.error + 2e-4 && off < 0.1 * (halves - page), "{pattern:?} {page} {halves}");
    }
    // The exponent of Yule and Nielsen has the same mean.
    let n = view.yule_nielsen_n.unwrap();
    let [white, black] =
        ["white", "black"].map(|name| view.states.get(name).unwrap().Y_via_pixel.powf(1.0 / n));
    assert!(((0.5 * (white + black)).powf(n) - page).abs() < 5e-4, "{n}");
}

/// A film whose two states depend on the direction in opposite ways: one brightens away from the normal, the other darkens.
const FILM: &str = "model = \"film\"\nsubstrate = \"Al\"\narea = { red = 0.5, green = 0.5 }\nfill_factor = 1\n\
                    default_states = false\n\
                    states = { white = { red = 1 }, black = { green = 1 } }\ngap_nm = { red = 275.9, green = 192.3, dark = 20.0 }\nfilm = [{ material = \"Cr:Johnson\", thickness_nm = 8 }, \
                    { material = \"air\", thickness_nm = \"gap\" }]";

/// Lines, text and patterns by paths: light that meets the figure and its page in turn.
#[test]
fn figures_in_returned_light_are_those_of_paths() {
    let case = Case { front: [0.6, 0.05], width: 0.12, view_deg: 10.0, diffuse: 0.5 };
    compare_with_paths("uniform", |solver| case.view_of([0.9, 0.05], FIGURES, solver).1);
}

/// The same where each meeting has the reflectance of its own direction.
#[test]
fn figures_of_films_in_returned_light_are_those_of_paths() {
    let case = Case { front: [0.3, 0.05], width: 0.2, view_deg: 25.0, diffuse: 0.5 };
    compare_with_paths("film", |solver| case.view_with(FILM, FIGURES, solver).1);
}

fn compare_with_paths(pixel: &str, view: impl Fn(&str) -> MtfView) {
    let [exact, paths] = [view("relative_error = 2e-2"), view("method = \"monte-carlo\"\npaths = 4096")]
        .map(|view| figures(&view));
    for ((name, value, stated), (_, found, error)) in exact.into_iter().zip(paths) {
        // The least contrast by paths is low by about its error.
        let of_least = if name == "text least" { error } else { 0.0 };
        assert!(
            (value - found).abs() < 3.0 * stated.hypot(error) + of_least,
            "{pixel}, {name}: {value} +- {stated}, {found} +- {error}"
        );
        assert!(stated < 5e-3, "{pixel}, {name}: {value} +- {stated}");
    }
}
