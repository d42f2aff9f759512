//! Tests of prepared displays: their results are bit-identical to those of single runs, independently of
//! earlier scenes and of the number of threads.
use std::sync::atomic::{AtomicBool, Ordering};

use crate::common::{prepared_for, run_on, scenario};
use papilio_display::result::RunResult;
use papilio_display::scene::{
    AngleMedium, Approximation, Interface, Layer, Length, Lobe, Method, Pixel, Ready, Scene, Standard, Stop,
    Thickness,
};
use papilio_display::{Control, DisplayError};
use papilio_spectra::Grid;

/// Reads the scene of a scenario for adding, with few wavelengths.
fn scene(name: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<&str> = ["spectrum.step_nm=40"].iter().chain(overrides).copied().collect();
    let mut scene = scenario(name, &overrides).unwrap().scene;
    scene.solver.method = Method::Adding;
    scene.solver.stop = Stop::RelativeError { target: 1e-3, per_wavelength: false };
    scene
}

fn with_stop<T>(threads: usize, run: impl FnOnce(&Control<'_>) -> T) -> T {
    run(&Control { threads: Some(threads), progress: &|_| {}, stop: &AtomicBool::new(false) })
}

/// Description of a change, and the change.
type Change = (&'static str, fn(&mut Scene));

/// Changes of all kinds of keys, each applied after the previous ones.
fn changes() -> Vec<Change> {
    vec![
        ("nothing", |_| {}),
        ("a light's direction", |s| s.lighting.directed[0].theta_deg = -31.0),
        ("a view", |s| s.viewer.theta_deg = vec![12.0]),
        ("a film's thickness", |s| film(s).layers[1].thickness = Thickness::Fixed(11.0)),
        ("the illuminance", |s| s.lighting.illuminance_lx = 321.0),
        ("areas", |s| film(s).sub_pixels[0].area = 0.4),
        ("a gap", |s| film(s).sub_pixels[1].gap_nm = 200.0),
        ("views", |s| s.viewer.theta_deg = vec![0.0, 12.0, -20.0]),
        ("a state less", |s| drop(film(s).states.pop())),
        ("shares of light", |s| s.lighting.diffuse = 0.9),
        ("a light's spectrum", |s| {
            s.lighting.directed[0].spectrum = s.lighting.directed[0].spectrum.map(|e| e * e).into();
        }),
        ("a lamp with a size", |s| s.lighting.directed[0].radius_deg = Some(3.0)),
        ("the field of view", |s| s.viewer.field_deg = 2.0),
        ("a front that mirrors", |s| front(s, 0.03)),
        ("another front", |s| front(s, 0.04)),
        ("the lobe", |s| lobe(s, 0.08)),
        ("the glass", |s| {
            let glass = &mut glass(s).medium;
            glass.index = glass.index.map(|_| 1.6);
        }),
        ("the method", |s| (s.solver.method, s.solver.stop) = (Method::MonteCarlo, Stop::Paths(64))),
        ("back to adding", |s| {
            s.solver.method = Method::Adding;
            s.solver.stop = Stop::RelativeError { target: 1e-3, per_wavelength: true };
        }),
        ("no diffuser", |s| glass(s).interface = Ready::IdealAr.into()),
        ("a filter of glass", |s| {
            let glass = &mut glass(s).medium;
            glass.transmittance = glass.index.map(|_| 0.8);
        }),
        ("any layers", |s| s.display.layers = scene("two-diffusers", &[]).display.layers),
        ("a light over any layers", |s| s.lighting.directed[0].theta_deg = 40.0),
        ("a film under any layers", |s| film(s).layers[2].thickness = Thickness::Fixed(40.0)),
        ("a view of any layers", |s| s.viewer.theta_deg = vec![3.0]),
        ("no directed light", |s| {
            s.lighting.directed.clear();
            s.lighting.diffuse = 1.0;
        }),
        ("the observer", |s| s.metrics.observer = Standard::Cie1964),
        ("a thickness", |s| glass(s).thickness = Length::Mm(0.3)),
        ("another pixel", |s| s.display.pixel = scene("epaper", &[]).display.pixel),
        ("the grid", |s| *s = scene("indoor", &["spectrum.step_nm=80"])),
        ("paper below a front and a face", |s| {
            s.display.pixel = scene("epaper", &["spectrum.step_nm=80"]).display.pixel;
            glass(s).interface = Ready::Fresnel.into();
        }),
        ("a front that reflects nothing", |s| front(s, 0.0)),
        ("a front that returns light to the face", |s| front(s, 0.2)),
        ("light that counts as unpolarised", |s| s.solver.approximation = Approximation::Unpolarised),
    ]
}

fn film(scene: &mut Scene) -> &mut papilio_display::scene::FilmPixel {
    match &mut scene.display.pixel {
        Pixel::Film(film) => film,
        other => panic!("{other:?} is no film"),
    }
}

fn front(scene: &mut Scene, reflectance: f64) {
    if let Interface::Ready(Ready::Component(front)) = &mut scene.display.layers[0].interface {
        front.reflectance = front.reflectance.map(|_| reflectance);
    }
}

/// The lowest layer.
fn glass(scene: &mut Scene) -> &mut Layer {
    scene.display.layers.last_mut().unwrap()
}

fn lobe(scene: &mut Scene, width: f64) {
    if let Interface::Ready(Ready::Diffuser(diffuser)) = &mut glass(scene).interface {
        diffuser.lobe = Lobe::KCorrelation { width };
    }
}

/// Formats a result: 17 digits distinguish all numbers, and NaN values are equal.
fn text(result: &RunResult) -> String {
    format!("{result:?}")
}

#[test]
fn prepared_display_equals_a_single_run_after_every_change() {
    with_stop(1, |control| {
        let mut scene = scene("indoor", &[]);
        let mut prepared = prepared_for(&scene).unwrap();
        for (what, change) in changes() {
            change(&mut scene);
            let kept = prepared.run(&scene, control).unwrap();
            let plain = papilio_display::run(&scene, control).unwrap();
            assert!(text(&kept) == text(&plain), "after a change of {what}");
        }
    });
}

/// Kernels between nodes are kept when only views and lights change.
#[test]
fn kernels_kept_for_other_directions_equal_new_ones() {
    let rough = scene("rough-glass", &["display.layers.0.alpha=0.3"]);
    let mut rough_film = rough.clone();
    rough_film.display.pixel = scene("two-diffusers", &[]).display.pixel;
    let measured = scene("measured-h65", &["viewer.theta_deg=0"]);
    with_stop(1, |control| {
        for (number, first) in [rough, rough_film, measured].into_iter().enumerate() {
            let mut prepared = prepared_for(&first).unwrap();
            let changes: [fn(&mut Scene); 4] = [
                |_| {},
                |s| s.lighting.directed[0].theta_deg = -31.0,
                |s| s.viewer.theta_deg = vec![12.0, 15.0],
                |s| s.viewer.theta_deg = vec![5.0],
            ];
            let mut scene = first;
            for (step, change) in changes.into_iter().enumerate() {
                change(&mut scene);
                let kept = prepared.run(&scene, control).unwrap();
                let plain = papilio_display::run(&scene, control).unwrap();
                assert!(text(&kept) == text(&plain), "scene {number}, step {step}");
            }
        }
    });
}

#[test]
fn alternating_scenes_do_not_affect_each_other() {
    with_stop(1, |control| {
        let scenes = ["indoor", "epaper", "two-diffusers", "table-pixel", "sunny", "reflecting-diffuser"]
            .map(|name| scene(name, &[]));
        let plain = scenes.each_ref().map(|scene| text(&papilio_display::run(scene, control).unwrap()));
        let mut prepared = prepared_for(&scenes[0]).unwrap();
        for k in [0, 1, 0, 2, 5, 3, 2, 4, 0, 5, 3, 1, 4, 4] {
            assert!(text(&prepared.run(&scenes[k], control).unwrap()) == plain[k], "{k}");
        }
    });
}

#[test]
fn invalid_scene_does_not_affect_the_next() {
    with_stop(1, |control| {
        let good = scene("indoor", &[]);
        let mut prepared = prepared_for(&good).unwrap();
        let before = prepared.run(&good, control).unwrap();
        let mut below = good.clone();
        below.viewer.theta_deg = vec![89.99];
        let error = prepared.run(&below, control).unwrap_err();
        assert!(matches!(error, DisplayError::BelowHorizon { what: "view", .. }), "{error}");
        assert_eq!(text(&prepared.run(&good, control).unwrap()), text(&before));
    });
}

#[test]
fn number_of_threads_has_no_effect_on_views() {
    for name in ["angle-scan", "two-diffusers"] {
        let mut scene = scene(name, &[]);
        scene.viewer.theta_deg = vec![-40.0, -3.0, 0.0, 8.0, 20.0, 33.0, 75.0];
        let results = [Some(1), Some(2), Some(3), None].map(|threads| run_on(&scene, threads).unwrap());
        results.iter().for_each(|result| assert!(text(result) == text(&results[0]), "{name}"));
        assert_eq!(results[0].views.len(), scene.viewer.theta_deg.len() * scene.viewer.phi_deg.len());
    }
}

/// Without noise, standard errors are 0, or null if a value is not defined. Discretisation errors
/// have the same shapes and are below the target.
#[test]
fn errors_of_adding_are_complete_and_below_the_target() {
    let scene = scene("indoor", &[]);
    let result = run_on(&scene, Some(1)).unwrap();
    let solver = &result.solver;
    assert_eq!((solver.method.as_str(), solver.paths, solver.degrees_of_freedom), ("adding", None, 0));
    assert!(solver.nodes.unwrap() > 10 && solver.relative_error_reached <= 1e-3 && !solver.interrupted);
    let view = &result.views[0];
    assert_eq!(view.standard_error.contrast_ratio, Some(0.0));
    assert!(view.discretisation_error.unwrap().contrast_ratio.unwrap() < 1e-2);
    let mut largest = 0.0_f64;
    for (name, state) in view.states.iter() {
        let (value, none) = (&state.value, &state.standard_error);
        let error = state.discretisation_error.as_ref().unwrap();
        assert_eq!((none.Y, none.u_prime, none.hue_rgb), (0.0, Some(0.0), Some([0.0; 3])), "{name}");
        assert_eq!(none.radiance, vec![0.0; result.wavelength_nm.len()]);
        assert_eq!(none.peak_nm.is_some(), value.peak_nm.is_some(), "{name}");
        assert_eq!(error.peak_nm.is_some(), value.peak_nm.is_some(), "{name}");
        assert_eq!(error.terms.directed.len(), value.terms.directed.len());
        assert_eq!(
            error.reflectance_factor.as_ref().map(Vec::len),
            value.reflectance_factor.as_ref().map(Vec::len)
        );
        assert_eq!(error.specular, vec![0.0; value.specular.len()]);
        largest = largest.max(error.Y / value.Y);
    }
    assert!((largest / solver.relative_error_reached - 1.0).abs() < 1e-6, "{largest:e} {solver:?}");
    let (_, ledger) = view.ledger.iter().next().unwrap();
    assert_eq!(ledger.standard_error.returned, 0.0);
    assert!(ledger.discretisation_error.as_ref().unwrap().returned < 1e-3);
}

#[test]
fn number_of_paths_is_refused_by_adding() {
    let mut scene = scene("indoor", &[]);
    scene.solver.stop = Stop::Paths(1000);
    assert_eq!(run_on(&scene, Some(1)), Err(DisplayError::NoPaths));
}

#[test]
fn target_that_no_level_reaches_causes_a_warning() {
    let mut scene = scene("overcast", &[]);
    scene.solver.stop = Stop::RelativeError { target: 0.0, per_wavelength: true };
    let result = run_on(&scene, Some(1)).unwrap();
    assert!(result.warnings.iter().any(|w| w.contains("finest level")), "{:?}", result.warnings);
    assert!(result.solver.relative_error_reached > 0.0, "{:?}", result.solver);
}

/// A run that is stopped at once fails; a run that is stopped after some views reports these.
#[test]
fn interrupted_run_reports_the_completed_views() {
    let mut scene = scene("indoor", &[]);
    scene.viewer.theta_deg = vec![0.0, 10.0, 20.0, 30.0];
    let stop = AtomicBool::new(true);
    let run = |progress: &(dyn Fn(papilio_display::Progress<'_>) + Sync)| {
        papilio_display::run(&scene, &Control { threads: Some(1), progress, stop: &stop })
    };
    assert_eq!(run(&|_| {}), Err(DisplayError::Interrupted));
    stop.store(false, Ordering::Relaxed);
    let result = run(&|progress| stop.store(progress.views_done.0 == 2, Ordering::Relaxed)).unwrap();
    assert!(result.solver.interrupted && result.views.len() == 2, "{:?}", result.solver);
    assert!(result.warnings.iter().any(|w| w.contains("interrupted: 2 of 4 views")), "{:?}", result.warnings);
}

/// A coarser grid gives the same result after a finer one as in a single run.
#[test]
fn change_of_the_grid_equals_a_single_run() {
    let (fine, coarse) = (scene("indoor", &[]), scene("indoor", &["spectrum.step_nm=80"]));
    assert_ne!(fine.grid, Grid::new(380.0, 780.0, 80.0).unwrap());
    with_stop(1, |control| {
        let mut prepared = prepared_for(&fine).unwrap();
        prepared.run(&fine, control).unwrap();
        let kept = prepared.run(&coarse, control).unwrap();
        assert_eq!(text(&kept), text(&papilio_display::run(&coarse, control).unwrap()));
    });
}

/// The scenario refuses them with their keys; a program that makes its own scenes gets an error, too.
#[test]
fn approximations_of_other_layers_than_a_panel_are_refused() {
    let mut scene = scene("two-diffusers", &[]);
    scene.solver.approximation = Approximation::SinglePass;
    let refused = with_stop(1, |control| papilio_display::run(&scene, control)).unwrap_err();
    assert_eq!(refused, DisplayError::ApproximatesNoPanel);
    (scene.solver.approximation, scene.solver.angle_medium) = (Approximation::None, AngleMedium::Unrefracted);
    let refused = with_stop(1, |control| papilio_display::run(&scene, control)).unwrap_err();
    assert_eq!(refused, DisplayError::ApproximatesNoPanel);
}

/// A palette has the errors of X, Y and Z by the step of the grid that a run states.
#[test]
fn palette_has_the_interpolation_errors_of_a_run() {
    let scene = scene("six-ink", &[]);
    let run = run_on(&scene, Some(1)).unwrap();
    let found = with_stop(1, |control| papilio_display::palette::palette(&scene, &[], control)).unwrap();
    for (colour, (name, state)) in found.palette.colours.iter().zip(run.views[0].states.iter()) {
        assert_eq!((colour.state.as_str(), colour.interpolation_error), (name, state.interpolation_error));
    }
    let red = found.palette.colours.iter().find(|colour| colour.state == "red").unwrap();
    assert!(red.interpolation_error.unwrap().X > 0.0);
}
