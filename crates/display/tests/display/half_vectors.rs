//! Tests of the display's BSDF on half vectors against its table, and of its energy.

use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use papilio_display::scene::{Method, Scene, Stop};
use papilio_display::{BrdfGrid, Control, HalfVectorGrid, HalfVectorTable, brdf, brdf_at_viewers};

use crate::common::scenario;

fn scene(name: &str) -> Scene {
    let mut scene = scenario(name, &["spectrum.step_nm=50"]).unwrap().scene;
    scene.solver.method = Method::Adding;
    scene.solver.stop = Stop::RelativeError { target: 1e-3, per_wavelength: false };
    scene
}

fn on_half_vectors(scene: &Scene, theta_i_deg: &[f64], size: usize) -> HalfVectorTable {
    // The lobe of `indoor` has 1.6 deg; that of the others is broad.
    let width_deg = theta_i_deg.iter().map(|theta| 1.6 / theta.to_radians().cos()).collect();
    let grid = HalfVectorGrid { theta_i_deg: theta_i_deg.to_vec(), phi_i_deg: Vec::new(), size, width_deg };
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(2), progress: &|_| {}, stop: &stop };
    brdf_at_viewers(scene, grid, &control).unwrap()
}

/// Ordinary panels and general layers: each value is that of a table with this pair of directions.
#[test]
fn values_on_half_vectors_equal_those_of_a_table() {
    for name in ["indoor", "epaper", "slab"] {
        let scene = scene(name);
        let found = on_half_vectors(&scene, &[0.0, 40.0], 6);
        let bins = found.wavelength_nm.len();
        let first = found.grid.viewers(0).0.len();
        let viewers = found.grid.viewers(1).0;
        assert_eq!(found.states[0].brdf.len(), (first + viewers.len()) * bins, "{name}");
        assert_eq!(found.row_errors.relative.len(), found.states.len() * (first + viewers.len()), "{name}");
        for (number, viewer) in viewers.iter().enumerate().step_by(8) {
            let grid = BrdfGrid {
                theta_i_deg: vec![40.0],
                phi_i_deg: Vec::new(),
                theta_o_deg: vec![viewer.theta_o_deg],
                dphi_deg: vec![viewer.dphi_deg],
            };
            let stop = AtomicBool::new(false);
            let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
            let table = brdf(&scene, grid, &control).unwrap();
            let start = (first + number) * bins;
            // The target is that of the luminous BRDF, not that of each wavelength. Far from the lobe of a
            // panel, where its level is not tested, the error of `indoor` is 1 % of the value, or 1.5e-5 of
            // the peak.
            let mean = |values: &[f32]| values.iter().map(|f| f64::from(*f)).sum::<f64>() / bins as f64;
            let (a, b) = (mean(&found.states[0].brdf[start..start + bins]), mean(&table.states[0].brdf));
            let peak = f64::from(found.states[0].brdf.iter().copied().fold(0.0, f32::max));
            assert!((a - b).abs() <= 3e-3 * b + 2e-5 * peak, "{name}, {viewer:?}: {a} {b}");
        }
    }
}

/// The integral of f cos(theta_o) over the half vectors, with the mirror part, is the light that leaves.
#[test]
fn integral_over_half_vectors_is_the_scattered_light() {
    let found = on_half_vectors(&scene("indoor"), &[20.0], 48);
    let (grid, bins) = (&found.grid, found.wavelength_nm.len());
    let (viewers, numbers) = grid.viewers(0);
    let (places, density) = (grid.nodes(0), grid.density(0));
    for bin in [2, 5] {
        let mut sum = 0.0;
        for (node, number) in numbers.iter().enumerate() {
            let row = node / grid.size;
            // The first and the last row are the same half vectors.
            let weight = if row == 0 || row + 1 == grid.size { 0.5 } else { 1.0 };
            if let Some(number) = number.filter(|_| places[node][0] > 0.0) {
                let f = f64::from(found.states[0].brdf[number * bins + bin]);
                let jacobian =
                    HalfVectorGrid::jacobian(20.0, places[node]) / density.at(row, places[node][0]);
                sum += weight * f * viewers[number].cos_theta_o * 8.0 * PI * PI * jacobian;
            }
        }
        sum /= ((grid.size - 1) * (grid.size - 1)) as f64;
        let state = &found.states[0];
        let expected = state.directional_hemispherical[bin] - state.specular[bin];
        assert!((sum / expected - 1.0).abs() < 5e-3, "{sum} {expected}");
    }
}
