//! Mirror-like pixels below flat layers: light with its places keeps s and p apart to the end, as that of `papilio run` does. Closed forms of each
//! polarisation, and both solvers.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use num_complex::Complex64;
use papilio_display::image::{ImageSettings, PictureSurround, Screen, SourceImage, image};
use papilio_display::spatial::{MtfResult, mtf, walk};
use papilio_display::{Control, note_of_places};
use papilio_scenario::{Resolved, Scenario};
use papilio_testing::everyday;
use papilio_transport::walk::places::Uniform;

use crate::common::run_on;
use crate::crosstalk_by_paths::assert_agree;
use crate::filter::{LIGHT, assert_colours_are_those_of_paths, filter, near};

const MIRROR: &str =
    "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.9, black = 0.1 }\n";
const FILM: &str = "[display.pixel]\nmodel = \"film\"\nsubstrate = \"Al\"\n\
    area = { red = 0.5, green = 0.3, blue = 0.2 }\ngap_nm = { red = 276, green = 192, blue = 138, dark = 20 }\n\
    film = [{ material = \"Cr:Johnson\", thickness_nm = 12 }, { material = \"air\", thickness_nm = \"gap\" }]\n";
const GLASS: &str = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\nthickness_mm = 0.3\n";
const FRONT: &str = "[[display.front]]\nreflectance = 0.15\ngap_mm = 0.2\n";
const MATRIX: &str = "[display.matrix]\nppi = 200\n";
const SKY: &str = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.3\n[[lighting.environment]]\nshare = 0.7\n\
    model = \"sky\"\nnumber = 12\nsun_elevation_deg = 40\npolarisation = 0.75\n";

/// A plate above an air gap above glass.
fn plate() -> String {
    let medium = |[index, mm]: [f64; 2]| {
        format!("[[display.layers]]\nkind = \"medium\"\nindex = {index}\nthickness_mm = {mm}\n")
    };
    [[1.5, 0.5], [1.0, 0.2], [1.5, 0.3]].map(medium).concat()
}

fn view(theta_deg: f64) -> String {
    format!("[viewer]\ntheta_deg = {theta_deg}\nfield_deg = 0\n")
}

fn resolved(parts: &[&str], more: &[&str]) -> Resolved {
    let text = format!(
        "[spectrum]\nstep_nm = 80\n{}[solver]\nmethod = \"adding\"\nrelative_error = 1e-3\n",
        parts.concat()
    );
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let more: Vec<String> = more.iter().map(|text| (*text).to_owned()).collect();
    Scenario::from_text(&text, "mirrors.toml", &folder, &more).unwrap().resolve().unwrap()
}

fn control(stop: &AtomicBool) -> Control<'_> {
    Control { threads: Some(1), progress: &|_| {}, stop }
}

fn sharpness(scenario: &Resolved) -> MtfResult {
    mtf(&scenario.scene, &scenario.patterns, &control(&AtomicBool::new(false))).unwrap()
}

/// A flat interface, and the medium below it: its reflectance, if it is a sheet, index and thickness, mm.
type Flat = (Option<f64>, f64, f64);

/// Light of s or of p that a view at this sine in air sees of a mirror below flat layers, in the geometric series of all orders: without regard to places,
/// and its response to a small change without and of this frequency along the plane of incidence.
fn series(layers: &[Flat], rho: f64, (sine, is_p): (f64, bool), frequency: f64) -> [Complex64; 3] {
    let at = |frequency: f64| {
        let (mut passes, mut returns, mut above, mut own) = (Complex64::ONE, Complex64::ZERO, 1.0_f64, 0.0);
        for (sheet, index, mm) in layers {
            let [upper, lower] = [above, *index].map(|n| (n * n - sine * sine).sqrt());
            let [a, b] = if is_p { [index * index, above * above] } else { [1.0; 2] };
            let face = sheet.unwrap_or_else(|| ((a * upper - b * lower) / (a * upper + b * lower)).powi(2));
            let open = 1.0 - face * returns;
            (passes, returns) = (passes * (1.0 - face) / open, face + (1.0 - face).powi(2) * returns / open);
            let way = mm * sine / lower;
            let phase = Complex64::cis(-2.0 * PI * frequency * way);
            (passes, returns, above, own) = (passes * phase, returns * phase * phase, *index, own + way);
        }
        // The own ray of the view meets the mirror at the place 0.
        (passes * Complex64::cis(2.0 * PI * frequency * own), returns)
    };
    let (all, back) = at(0.0);
    let (seen, response) = at(frequency);
    let once = rho * all / (1.0 - rho * back);
    [once * all, once * all / (1.0 - rho * back), once * seen / (1.0 - rho * response)]
}

/// Below a face, a face and a sheet, and a plate: the mean of both series, where the series of the means is up to 3 % off.
#[test]
fn mirrors_have_the_series_of_each_polarisation() {
    let glass = (None, 1.5, 0.3);
    let cases: [(String, &[Flat]); 3] = [
        (GLASS.to_owned(), &[glass]),
        ([FRONT, GLASS].concat(), &[(Some(0.15), 1.0, 0.2), glass]),
        (plate(), &[(None, 1.5, 0.5), (None, 1.0, 0.2), glass]),
    ];
    for (layers, flat) in cases {
        for theta_deg in [0.0, 45.0, 60.0, 75.0_f64] {
            let scenario = resolved(&[&layers, MIRROR, LIGHT, &view(theta_deg)], &[]);
            assert_eq!(note_of_places(&scenario.scene), None);
            let found = sharpness(&scenario);
            let sine = theta_deg.to_radians().sin();
            for (name, rho) in [("white", 0.9), ("black", 0.1)] {
                let state = found.views[0].states.get(name).unwrap();
                for (f, otf) in found.frequency_per_mm.iter().zip(&state.otf.otf_x).step_by(7) {
                    let [s, p] = [false, true].map(|is_p| series(flat, rho, (sine, is_p), *f));
                    let [y, zero, seen] = [0, 1, 2].map(|k| 0.5 * (s[k] + p[k]));
                    let what = format!("{name} at {theta_deg} deg, {f}");
                    near(&what, state.Y_via_pixel / y.re, 1.0, 2e-6);
                    let off = (Complex64::new(otf[0], otf[1]) - seen / zero).norm();
                    assert!(off < found.error_reached + 2e-6, "{what}: {otf:?}, {}", seen / zero);
                }
            }
        }
    }
}

/// Films in a polarised sky: Y of a run, and the mean of what is seen through two polarisers. Both, and the modulation transfer, by paths, too.
#[test]
fn films_have_the_light_of_both_polarisers() {
    for layers in everyday(1, [[FRONT, GLASS].concat(), plate()]) {
        let of = |more: &[&str]| resolved(&[&layers, FILM, MATRIX, SKY, &view(60.0)], more);
        let all = [&[][..], &["viewer.polariser=s"], &["viewer.polariser=p"]].map(of);
        let [both, s, p] = all.each_ref().map(sharpness);
        for (name, state) in both.views[0].states.iter() {
            let [s, p] = [&s, &p].map(|one| one.views[0].states.get(name).unwrap());
            near(name, 0.5 * (s.Y_via_pixel + p.Y_via_pixel) / state.Y_via_pixel, 1.0, 1e-6);
        }
        for (scenario, found) in all.iter().zip([&both, &s, &p]) {
            let run = run_on(&scenario.scene, Some(1)).unwrap();
            let stop = AtomicBool::new(false);
            let uniform = Uniform { states: run.views[0].states.iter().count() };
            let paths = walk::pattern(&scenario.scene, &uniform, 1 << 10, &control(&stop)).unwrap();
            let frequency = found.frequency_per_mm[found.frequency_per_mm.len() / 3];
            let transfer =
                walk::transfer(&scenario.scene, &[[frequency, 0.0]], 1 << 10, &control(&stop)).unwrap();
            let (walked, transfer) = (&paths[0].via_pixel, &transfer[0].states);
            for ((name, state), walked) in run.views[0].states.iter().zip(walked) {
                let y = state.value.Y - state.value.terms.front_reflection;
                let sharp = found.views[0].states.get(name).unwrap();
                near(name, sharp.Y_via_pixel / y, 1.0, 2e-4);
                near(name, walked.value / y, 1.0, 4.5 * walked.standard_error / y + 2e-4);
                let walked = transfer.get(name).unwrap().response.otf[0][0];
                let k = found.frequency_per_mm.len() / 3;
                near(name, walked.value, sharp.otf.otf_x[k][0], 4.5 * walked.standard_error + 1e-4);
            }
        }
    }
}

/// A picture of one state has the colour of a run.
#[test]
fn pictures_have_the_colours_of_a_run() {
    let paths = ["solver={ method = \"monte-carlo\", paths = 2048 }"];
    for (layers, more) in [([FRONT, GLASS].concat(), &[][..]), (plate(), &paths)] {
        let scene = resolved(&[&layers, MIRROR, MATRIX, LIGHT, &view(70.0)], more).scene;
        let states = vec!["white".to_owned(), "black".to_owned()];
        let settings = ImageSettings {
            given: Some(vec![0; 16]),
            surround: PictureSurround::Repeat,
            states,
            ..ImageSettings::default()
        };
        let source = SourceImage { columns: 4, pixels: vec![[0.5; 3]; 16] };
        let stop = AtomicBool::new(false);
        let found = image(&scene, &source, &settings, Screen::default(), &control(&stop)).unwrap();
        let white = run_on(&scene, Some(1)).unwrap().views[0].states.get("white").unwrap().value.Y;
        let shown = f64::from(found.seen[5][1]);
        near("white", shown, white, 1e-4 * white + found.numbers.error);
    }
}

/// Crosstalk of figures below a front and a face, and colours of films below a filter, against paths.
#[test]
fn figures_and_filters_agree_with_paths() {
    for theta_deg in everyday(1, [60.0, 75.0]) {
        let view = view(theta_deg);
        assert_agree("mirror", &[FRONT, GLASS, MIRROR, MATRIX, LIGHT, &view], 1 << 10);
        let single = FILM.replace("red = 276, green = 192, blue = 138", "red = 120, green = 120, blue = 120");
        let third = single
            .replace("red = 0.5, green = 0.3, blue = 0.2", "red = 0.3334, green = 0.3333, blue = 0.3333");
        let filter = filter(30.0, "red = 0.8, green = 0.5, blue = 0.2");
        assert_colours_are_those_of_paths(
            &resolved(&[FRONT, GLASS, &third, &filter, LIGHT, &view], &[]).scene,
        );
    }
}

/// Below a filter, as without it: the mean of what is seen through two polarisers, with the front, and an s-polarised lamp that is mirrored like light of s.
#[test]
fn polarised_light_passes_filters() {
    let of = |more: &[&str]| {
        let lamp = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.4\n[[lighting.directed]]\n\
            theta_deg = -60\nshare = 0.6\nradius_deg = 5\npolarisation = { degree = 1.0, angle_deg = 90 }\n";
        let filter = filter(30.0, "red = 0.8, green = 0.5, blue = 0.2");
        let scene = resolved(&[FRONT, GLASS, MIRROR, &filter, lamp, &view(60.0)], more).scene;
        run_on(&scene, Some(1)).unwrap().views.remove(0)
    };
    let [both, s, p] = [&[][..], &["viewer.polariser=s"], &["viewer.polariser=p"]].map(of);
    for (name, state) in both.states.iter() {
        let [s, p] = [&s, &p].map(|one| &one.states.get(name).unwrap().value);
        near(name, 0.5 * (s.Y + p.Y) / state.value.Y, 1.0, 1e-6);
        near(name, 0.5 * s.terms.directed[0] / state.value.terms.directed[0], 1.0, 1e-6);
        near(name, p.terms.directed[0], 0.0, 1e-9);
    }
    let walked = of(&["solver={ method = \"monte-carlo\", paths = 8192 }", "viewer.polariser=s"]);
    for (name, state) in walked.states.iter() {
        let error = state.standard_error.Y;
        let exact = s.states.get(name).unwrap().value.Y;
        near(name, state.value.Y / exact, 1.0, 4.5 * error / exact + 1e-3);
    }
}

/// Flat layers below a diffuser: the note says that their places are those of unpolarised light.
#[test]
fn note_names_what_is_left() {
    let lobe = "[[display.layers]]\nkind = \"diffuser\"\nmodel = \"k-correlation\"\nwidth = 0.1\ntransmittance = 0.95\n";
    let note = |parts: &[&str]| note_of_places(&resolved(parts, &[]).scene);
    assert!(
        note(&[lobe, &plate(), FILM, LIGHT, &view(60.0)]).is_some_and(|note| note.contains("unpolarised"))
    );
    let filter = filter(30.0, "red = 0.8, green = 0.5, blue = 0.2");
    assert_eq!(
        note(&[
            GLASS,
            &FILM.replace("red = 276, green = 192, blue = 138", "red = 120, green = 120, blue = 120"),
            &filter,
            LIGHT
        ]),
        None
    );
}
