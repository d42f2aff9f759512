//! A sphere with a port: light that leaves beside it is lost.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::{Control, run};
use papilio_scenario::Scenario;

/// Y of the states of a display of these layers with these keys of the lighting, by a solver.
fn read(layers: &str, pixel: &str, lighting: &str, solver: &str) -> Vec<f64> {
    let text = format!(
        "[spectrum]\nrange_nm = [400, 700]\nstep_nm = 100\n[display]\nlayers = [{layers}]\n[display.pixel]\nmodel = \"uniform\"\n{pixel}\n\
         [lighting]\n{lighting}\n[solver]\nmethod = \"{solver}\"\nrelative_error = 0.002\n"
    );
    let scene = Scenario::from_text(&text, "port.toml", Path::new(""), &[])
        .unwrap_or_else(|errors| panic!("{errors}"))
        .resolve()
        .unwrap_or_else(|errors| panic!("{errors}"))
        .scene;
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    let result = run(&scene, &control).unwrap();
    result.views[0].states.iter().map(|(_, state)| state.value.Y).collect()
}

const BLACK: &str = "kind = \"lambertian\"\nreflectance = { dark = 0.0 }";

/// A half-space of isotropic scatterers, 1 mm of free path: of the light of a beam along the normal, half and 0.9 leave within
/// radii that a separate program gives; a small spot in a port of twice these radii sees as much.
#[test]
fn small_spot_sees_the_light_within_the_radius_of_the_port() {
    for (albedo, known) in [(0.9, [(0.836, 0.5), (3.19, 0.9)]), (0.99, [(1.49, 0.5), (6.27, 0.9)])] {
        let slab = format!(
            "{{ kind = \"slab\", faces = false, optical_thickness = 100, thickness_mm = 100, anisotropy = 0, albedo = {albedo} }}"
        );
        let of = |port: &str| read(&slab, BLACK, &format!("diffuse = 1\n{port}"), "adding")[0];
        let whole = of("");
        for (radius, expected) in known {
            let found = of(&format!("port_mm = {}\nspot_mm = 0.001", 2.0 * radius)) / whole;
            assert!((found - expected).abs() < 0.01, "{albedo} {radius}: {found} {expected}");
        }
        let wide = of("port_mm = 100000\nspot_mm = 1") / whole;
        assert!((wide - 1.0).abs() < 1e-12, "{albedo}: {wide}");
    }
}

/// A half-space of isotropic scatterers in a black cylinder, 1 mm of free path, followed by a program of its own: one photon after the
/// other, from a random place of the spot along the normal. Returns the fraction of the light of a wide half-space that leaves inside
/// the port and was never beside the cylinder.
fn followed(albedo: f64, [port, spot, sample]: [f64; 3]) -> f64 {
    let mut state = 20_u64;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    let [mut all, mut seen] = [0.0_f64; 2];
    for _ in 0..120_000 {
        let (radius, turn) = (0.5 * spot * next().sqrt(), std::f64::consts::TAU * next());
        let mut place = [radius * turn.cos(), radius * turn.sin(), 0.0];
        let (mut along, mut light, mut inside) = ([0.0, 0.0, 1.0], 1.0_f64, true);
        while light > 1e-4 {
            let length = -next().ln();
            let step = if along[2] < 0.0 { length.min(place[2] / -along[2]) } else { length };
            (0..3).for_each(|k| place[k] += step * along[k]);
            inside &= place[0].hypot(place[1]) <= 0.5 * sample;
            if step < length {
                all += light;
                let met = inside && place[0].hypot(place[1]) <= 0.5 * port;
                seen += if met { light } else { 0.0 };
                break;
            }
            light *= albedo;
            let (z, turn) = (2.0 * next() - 1.0, std::f64::consts::TAU * next());
            let across = (1.0 - z * z).sqrt();
            along = [across * turn.cos(), across * turn.sin(), z];
        }
    }
    seen / all
}

/// A sample that is smaller than the port, or not much larger, loses light at its edge, whatever the size of the spot.
#[test]
fn round_sample_loses_light_at_its_edge() {
    let slab = "{ kind = \"slab\", faces = false, optical_thickness = 100, thickness_mm = 100, anisotropy = 0, albedo = 0.9 }";
    let of = |keys: &str| read(slab, BLACK, &format!("diffuse = 1\n{keys}"), "adding")[0];
    let whole = of("");
    for lengths in [[1000.0, 0.001, 2.0], [4.0, 0.001, 5.0], [6.0, 3.0, 4.0], [3.0, 3.0, 8.0]] {
        let [port, spot, sample] = lengths;
        let found = of(&format!("port_mm = {port}\nspot_mm = {spot}\nsample_mm = {sample}")) / whole;
        let expected = followed(0.9, lengths);
        // Four standard errors of either method: 120,000 photons, and 32,768 paths.
        assert!((found - expected).abs() < 0.013, "{lengths:?}: {found} {expected}");
    }
    let wide = of("port_mm = 6\nspot_mm = 0.001\nsample_mm = 1000") / of("port_mm = 6\nspot_mm = 0.001");
    assert!((wide - 1.0).abs() < 2e-3, "{wide}");
}

/// Light in clear glass over white paper moves sideways to a multiple of its thickness: the loss is that of the ratio of the
/// thickness to the port, and the same for both solvers; a mirror image of the room and a thin sample lose nothing.
#[test]
fn loss_depends_on_the_ratio_of_the_lengths() {
    let glass = |mm: f64| {
        format!("{{ kind = \"fresnel\" }}, {{ kind = \"medium\", index = 1.5, thickness_mm = {mm} }}")
    };
    let pixel = "kind = \"lambertian\"\nreflectance = { dark = 0.0, white = 0.9 }";
    let of = |mm: f64, port: &str, solver: &str| {
        read(&glass(mm), pixel, &format!("preset = \"d8-included\"\n{port}"), solver)
    };
    let whole = of(1.0, "", "adding");
    let small = of(1.0, "port_mm = 8\nspot_mm = 4", "adding");
    let twice = of(2.0, "port_mm = 16\nspot_mm = 8", "adding");
    let paths = of(1.0, "port_mm = 8\nspot_mm = 4", "monte-carlo");
    let thin = of(0.001, "port_mm = 8\nspot_mm = 4", "adding");
    assert!((small[0] - whole[0]).abs() < 1e-9, "{small:?} {whole:?}");
    assert!(small[1] < 0.99 * whole[1] && small[1] > 0.7 * whole[1], "{small:?} {whole:?}");
    assert!((small[1] - twice[1]).abs() < 1e-9, "{small:?} {twice:?}");
    assert!((small[1] / paths[1] - 1.0).abs() < 0.01, "{small:?} {paths:?}");
    assert!((thin[1] / whole[1] - 1.0).abs() < 2e-3, "{thin:?} {whole:?}");
}
