//! Faces by their geometry as layers: both solvers, white furnaces, flat faces and roughness.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use papilio_display::result::{RunResult, View};
use papilio_display::scene::{Method, Scene, Stop};
use papilio_display::{Control, DisplayError, Prepared, Progress, adding_seconds};
use papilio_scenario::Scenario;
use papilio_testing::{everyday, sized};

use crate::common::{prepared_for, run};

/// Luminance factors of white by view with their standard and discretisation errors, in a light and above a
/// paper of a reflectance.
fn factors(layers: &str, reflectance: f64, light: &str, method: &str) -> Vec<(f64, f64, f64)> {
    whites(&run(&scene(1e-3, layers, reflectance, light, method)).unwrap())
}

/// A display seen in three directions, whose result has this relative error.
fn scene(relative_error: f64, layers: &str, reflectance: f64, light: &str, method: &str) -> Scene {
    let text = format!(
        "{layers}\n[[display.layers]]\nkind = \"medium\"\nindex = 1.5\n[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = \
         {{ white = {reflectance}, black = 0 }}\n[lighting]\nilluminance_lx = 500\n{light}\n[viewer]\ntheta_deg = [0, 20, 60]\n[solver]\nmethod = \
         \"{method}\"\nrelative_error = {relative_error}\n"
    );
    let surfaces = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../surfaces");
    let resolved =
        Scenario::from_text(&text, "face.toml", &surfaces, &[]).and_then(|scenario| scenario.resolve());
    resolved.unwrap_or_else(|error| panic!("{error}\n{text}")).scene
}

fn whites(result: &RunResult) -> Vec<(f64, f64, f64)> {
    let white = |view: &View| {
        let state = view.states.get("white").unwrap();
        let grid = state.discretisation_error.as_ref().map_or(0.0, |error| error.Y);
        (state.value.Y, state.standard_error.Y, grid)
    };
    result.views.iter().map(white).collect()
}

fn face(keys: &str) -> String {
    format!("[[display.layers]]\nkind = \"diffuser\"\nmodel = \"microgeometry\"\n{keys}\n")
}

const DIFFUSE: &str = "spectrum = \"E\"\ndiffuse = 1";
const LAMP: &str = "spectrum = \"E\"\n[[lighting.directed]]\ntheta_deg = -40\nshare = 1";

/// Scenes in both lights: what takes long, the scattering of their face, is computed once, and kept by
/// `Prepared` for other lights and papers.
struct Faced {
    scene: Scene,
    prepared: Prepared,
}

impl Faced {
    fn new(relative_error: f64, layers: &str, reflectance: f64, light: &str) -> Self {
        let scene = scene(relative_error, layers, reflectance, light, "adding");
        Self { prepared: prepared_for(&scene).unwrap(), scene }
    }

    /// The whites by adding.
    fn whites(&mut self) -> Vec<(f64, f64, f64)> {
        let control = Control { threads: None, progress: &|_| {}, stop: &AtomicBool::new(false) };
        whites(&self.prepared.run(&self.scene, &control).unwrap())
    }

    /// A white paper that returns all light, in diffuse light, is as bright as without the layers.
    fn assert_furnace(&mut self, close: f64) {
        for (white, _, grid) in self.whites() {
            assert!((white - 1.0).abs() < close, "{white} {grid}");
        }
    }

    /// Paper of 0.6 in another light instead.
    fn change(&mut self, light: &str) {
        let other = scene(1e-3, "", 0.6, light, "adding");
        (self.scene.display.pixel, self.scene.lighting) = (other.display.pixel, other.lighting);
    }

    /// Compares adding with paths of this relative error.
    fn assert_solvers_agree(&mut self, error_of_paths: f64, rounding: f64) {
        let mut walked = self.scene.clone();
        walked.solver.method = Method::MonteCarlo;
        walked.solver.stop = Stop::RelativeError { target: error_of_paths, per_wavelength: false };
        let paths = whites(&run(&walked).unwrap());
        for ((a, _, grid), (b, error, _)) in self.whites().into_iter().zip(paths) {
            assert!((a - b).abs() < 4.5 * error + grid + rounding, "{a} +- {grid}, {b} +- {error}");
        }
    }
}

/// Both solvers agree below hemispheres, from which much light is trapped in the glass; a white paper returns
/// all light.
#[test]
fn both_solvers_agree_below_a_face() {
    let hemispheres = face("surface = \"hemispheres.toml\"\nrays = 640");
    let mut faced = Faced::new(1e-3, &hemispheres, 1.0, DIFFUSE);
    faced.assert_furnace(1e-6);
    for light in [DIFFUSE, LAMP] {
        faced.change(light);
        faced.assert_solvers_agree(sized(4e-3, 1e-3), 1e-5);
    }
    let medium = |index: f64| format!("[[display.layers]]\nkind = \"medium\"\nindex = {index}\n");
    // Between two dense media hardly any light is reflected: both sides exchange almost all of it.
    let etched = face("surface = \"etched.toml\"\nrays = 640");
    for dense in everyday(1, [&hemispheres, &etched]).map(|face| format!("{etched}{}{face}", medium(1.3))) {
        Faced::new(1e-3, &dense, 1.0, DIFFUSE).assert_furnace(1e-6);
    }
    // Dents of a glass above a gap of air; and bumps below such a gap, which turns back all light beyond
    // |beta| = 1.
    let upside_down = format!(
        "[[display.layers]]\nkind = \"fresnel\"\n{}{hemispheres}{}[[display.layers]]\nkind = \"fresnel\"\n",
        medium(1.5),
        medium(1.0)
    );
    let below_a_gap = format!(
        "[[display.layers]]\nkind = \"fresnel\"\n{}[[display.layers]]\nkind = \"fresnel\"\n{}{hemispheres}",
        medium(1.6),
        medium(1.0)
    );
    // Light between two faces needs many paths. Every day, errors of 2 % and 3 % are found.
    for layers in everyday(1, [&below_a_gap, &upside_down]) {
        Faced::new(4e-3, layers, 0.6, LAMP).assert_solvers_agree(sized(6e-3, 4e-3), 1e-5);
    }
}

/// The face of a flat surface is Fresnel's, averaged over the bands of its kernel.
#[test]
fn a_flat_face_is_that_of_fresnel() {
    let flat = tempfile::tempdir().unwrap();
    std::fs::write(flat.path().join("flat.toml"), "[microgeometry]\nsurface = \"flat\"\nrays = 3200\n")
        .unwrap();
    let measured = face(&format!("surface = {:?}", flat.path().join("flat.toml")));
    let fresnel = "[[display.layers]]\nkind = \"fresnel\"\n";
    for light in [DIFFUSE, LAMP] {
        let [measured, exact] =
            [measured.as_str(), fresnel].map(|layers| factors(layers, 0.6, light, "adding"));
        for ((a, ..), (b, ..)) in measured.into_iter().zip(exact) {
            assert!((a - b).abs() < 2e-3 * b, "{light}: {a} {b}");
        }
    }
}

/// An etched face of rms slope 0.05 sqrt(2) is roughness of alpha = 2 rms/correlation = 0.1, but for the
/// bands of 2.5 deg, by which its kernel widens lobes: in diffuse light within 1 % (its heights are
/// correlated, those of roughness are not), on the flank of the mirror image of a lamp within 8 % (5.6 % at
/// 60 deg; with bands half as wide, 1.2 %, by Monte Carlo within 0.2 %).
#[test]
fn an_etched_face_is_roughness() {
    let etched = face("surface = \"etched.toml\"\nrays = 6400");
    let rough = "[[display.layers]]\nkind = \"rough\"\nalpha = 0.1\ndistribution = \"beckmann\"\n";
    for (light, close) in [(DIFFUSE, 0.01), (LAMP, 0.08)] {
        let [measured, rough] = [etched.as_str(), rough].map(|layers| factors(layers, 0.6, light, "adding"));
        for ((a, ..), (b, ..)) in measured.into_iter().zip(rough) {
            assert!((a - b).abs() < close * b, "{light}: {a} {b}");
        }
    }
}

/// The same slopes at four times the height, by waves: the square of the rms phase is 130 and more, and the
/// lobes are those of the slopes. Waves have the phases of light along the normal: the lamp is at -10 deg,
/// and views on both flanks of its mirror image agree within 3 %. From -40 deg, whose mirror image is
/// narrower by its cosine, they differ by 9 %.
#[test]
fn a_high_gaussian_face_by_waves_is_roughness() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("etched.toml");
    let surface =
        "[microgeometry]\nsurface = \"gaussian\"\nroad = \"waves\"\nrms_nm = 2000\ncorrelation_um = 40\n";
    std::fs::write(&path, surface).unwrap();
    let etched = face(&format!("surface = {path:?}"));
    let rough = "[[display.layers]]\nkind = \"rough\"\nalpha = 0.1\ndistribution = \"beckmann\"\n";
    let few = |light: &str| format!("{light}\n[spectrum]\nstep_nm = 100");
    let near_normal = LAMP.replace("-40", "-10");
    for (light, close) in [(few(DIFFUSE), 0.01), (few(&near_normal), 0.03)] {
        let [waves, rough] = [etched.as_str(), rough].map(|layers| factors(layers, 0.6, &light, "adding"));
        for ((a, ..), (b, ..)) in waves.into_iter().zip(rough) {
            assert!((a - b).abs() < close * b, "{light}: {a} {b}");
        }
    }
}

/// A face by waves loses nothing at any wavelength, both solvers agree on the light beside the mirror image
/// of a lamp.
#[test]
fn a_face_by_waves_colours_the_light() {
    let hazy = face("surface = \"hazy.toml\"\nrms_nm = 900");
    // Each wavelength has a lobe of its own.
    let range = sized("range_nm = [450, 650]\n", "");
    let few = |light: &str| format!("{light}\n[spectrum]\n{range}step_nm = 100");
    let mut faced = Faced::new(4e-3, &hazy, 1.0, &few(DIFFUSE));
    faced.assert_furnace(1e-3);
    faced.change(&few(LAMP));
    // Every day, errors of 3 % are found.
    faced.assert_solvers_agree(sized(7e-3, 4e-3), 1e-4);
}

/// Mirror images of light along the normal, in closed form: by waves, the squares of the rms phases are (4 pi
/// n s/lambda)^2 in reflection, n being the index of the side of the light, and (2 pi (n2 - n1) s/lambda)^2
/// in transmission. No lobe of this face is narrow enough to count as straight.
#[test]
fn mirror_images_behind_a_face_by_waves_are_those_of_screens() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rough.toml");
    let surface = "[microgeometry]\nsurface = \"exponential\"\nroad = \"waves\"\nrms_nm = 50\ncorrelation_um = 1\ncutoff_um = 0.5\n";
    std::fs::write(&path, surface).unwrap();
    let rough = face(&format!("surface = {path:?}"));
    let phase = |path: f64| 2.0 * PI * path * 50.0 / 550.0;
    let straight = |path: f64| (-phase(path).powi(2)).exp();
    let (from_above, from_below) = (0.04 * straight(2.0), 0.04 * straight(3.0));
    let once = 0.96 * straight(0.5);
    assert!((from_above - 0.04 * 0.27115).abs() < 1e-6);
    for reflectance in [0.0, 0.3, 0.8] {
        let text = format!(
            "{rough}[[display.layers]]\nkind = \"medium\"\nindex = 1.5\n[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = \
             {{ white = {reflectance}, black = 0 }}\n[lighting]\nilluminance_lx = 500\nspectrum = \"E\"\n[[lighting.directed]]\ntheta_deg = 0\nshare = \
             1\n[spectrum]\nrange_nm = [549, 551]\nstep_nm = 1\n[viewer]\ntheta_deg = 30\n"
        );
        let scenario = Scenario::from_text(&text, "face.toml", folder.path(), &[]);
        let resolved = scenario.and_then(|scenario| scenario.resolve());
        let resolved = resolved.unwrap_or_else(|error| panic!("{error}\n{text}"));
        let found = run(&resolved.scene).unwrap().views[0].states.get("white").unwrap().value.specular[0];
        let via_pixel = once * once * reflectance / (1.0 - reflectance * from_below);
        let expected = from_above + via_pixel;
        // Over 2 nm, the mean differs from the value in the middle by less than 1e-5 of it.
        assert!((found / expected - 1.0).abs() < 2e-5, "{reflectance}: {found} {expected}");
    }
}

/// A surface is measured when a scene is prepared, not when it is read: with progress, once for all scenes
/// that have it, and until it is stopped.
#[test]
fn surfaces_are_measured_once_in_preparation_with_progress_and_stop() {
    // A pitch of its own: other tests measure this surface, too.
    let layers = face("surface = \"hemispheres.toml\"\nrays = 65\npitch_um = 4.75");
    let one = scene(1e-2, &layers, 0.6, DIFFUSE, "adding");
    let reports = Mutex::new(Vec::new());
    let prepare = |scene: &Scene, stop: &AtomicBool| {
        reports.lock().unwrap().clear();
        let progress = |now: Progress<'_>| reports.lock().unwrap().push((now.views_done, now.unit));
        let result = Prepared::new(scene, &Control { threads: Some(2), progress: &progress, stop });
        (result.map(drop), reports.lock().unwrap().len())
    };
    let (stopped, _) = prepare(&one, &AtomicBool::new(true));
    assert_eq!(stopped, Err(DisplayError::Interrupted));
    assert_eq!(prepare(&one, &AtomicBool::new(false)), (Ok(()), 32));
    assert_eq!(prepare(&one, &AtomicBool::new(false)), (Ok(()), 0));
    // Another scene with the same surface, whose text was read again, and one with another surface.
    let same = scene(1e-3, &layers, 0.3, LAMP, "monte-carlo");
    assert_eq!(prepare(&same, &AtomicBool::new(false)), (Ok(()), 0));
    let other = scene(1e-2, &layers.replace("4.75", "4.8"), 0.6, DIFFUSE, "adding");
    assert_eq!(prepare(&other, &AtomicBool::new(false)).1, 32);
    // The work of adding is estimated without a measurement, from the same directions as with it.
    assert_eq!(
        adding_seconds(&scene(1e-2, &layers.replace("4.75", "4.9"), 0.6, DIFFUSE, "adding")),
        adding_seconds(&one)
    );
}
