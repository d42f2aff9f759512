//! Displays whose pixel has a measured BRDF.
use std::sync::atomic::AtomicBool;

use papilio_display::pixel::scan;
use papilio_display::scene::{Pixel, Scene};
use papilio_display::{BrdfGrid, ConeGrid, Control, DisplayError, brdf, cone};
use papilio_validation::{monte_carlo_scenario, run, scenario, state};

fn paper() -> Scene {
    scenario("epaper-measured", &["spectrum.step_nm=20"]).unwrap().scene
}

fn quietly<T>(ask: impl Fn(&Control<'_>) -> T) -> T {
    ask(&Control { threads: None, progress: &|_| {}, stop: &AtomicBool::new(false) })
}

#[test]
fn both_solvers_agree_on_measured_pixel() {
    let adding = run(&paper()).unwrap();
    let sets = ["spectrum.step_nm=20", "solver.relative_error=0.002"];
    let monte_carlo = run(&monte_carlo_scenario("epaper-measured", &sets).unwrap().scene).unwrap();
    for name in ["white", "black"] {
        let [adding, monte_carlo] = [&adding, &monte_carlo].map(|result| state(result, name).unwrap());
        let z = (monte_carlo.value.Y - adding.value.Y)
            / monte_carlo.standard_error.Y.hypot(1e-3 * adding.value.Y);
        assert!(z.abs() < 4.0, "{name}: {} {} {z}", monte_carlo.value.Y, adding.value.Y);
    }
}

#[test]
fn conoscopic_map_agrees_with_run() {
    let scene = paper();
    let run = run(&scene).unwrap();
    let grid = ConeGrid { theta_deg: vec![0.0, 8.0, 40.0], phi_deg: vec![0.0, 180.0], ..ConeGrid::default() };
    let cone = quietly(|control| cone(&scene, grid.clone(), control)).unwrap();
    for (number, name) in ["white", "black"].into_iter().enumerate() {
        let once = state(&run, name).unwrap().value.Y;
        let seen = |theta, phi| cone.view(theta, phi).unwrap().states[number].reflectance_factor_y;
        assert!((seen(1, 0) / once - 1.0).abs() < 2e-3, "{name}: {} {once}", seen(1, 0));
        // The source is at -45 deg: its gloss is on the opposite side.
        assert!(seen(2, 0) > 1.02 * seen(2, 1), "{name}: {} {}", seen(2, 0), seen(2, 1));
    }
}

#[test]
fn brdf_of_display_is_reciprocal() {
    let scene = paper();
    let table = quietly(|control| brdf(&scene, BrdfGrid::even(15.0), control)).unwrap();
    let (grid, bins) = (&table.grid, table.wavelength_nm.len());
    let at = |i: usize, o: usize, phi: usize| {
        let cell = (i * grid.theta_o_deg.len() + o) * grid.dphi_deg.len() + phi;
        f64::from(table.states[0].brdf[cell * bins + bins / 2])
    };
    for (i, o, phi) in [(0, 2, 0), (1, 4, 3), (2, 3, 12), (3, 5, 6)] {
        let [there, back] = [at(i, o, phi), at(o, i, phi)];
        assert!(there > 0.05 && (there / back - 1.0).abs() < 2e-3, "{i} {o} {phi}: {there} {back}");
    }
}

#[test]
fn undefined_results_are_refused() {
    let scene = paper();
    assert_eq!(scan(&scene, &[0.0]), Err(DisplayError::ScanOfScattering));
    assert!(matches!(scene.display.pixel, Pixel::Scattering(_)));
}
