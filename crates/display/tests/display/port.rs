//! A sphere with a port: light that leaves beside it is lost.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::{Control, run};
use papilio_scenario::Scenario;

/// Y of the states of a display of these layers with these keys of the lighting, by a solver.
fn read(layers: &str, pixel: &str, lighting: &str, solver: &str) -> Vec<f64> {
    read_over(layers, &format!("model = \"uniform\"\n{pixel}"), lighting, solver)
}

/// The same over any pixel.
fn read_over(layers: &str, pixel: &str, lighting: &str, solver: &str) -> Vec<f64> {
    let text = format!(
        "[spectrum]\nrange_nm = [400, 700]\nstep_nm = 100\n[display]\nlayers = [{layers}]\n[display.pixel]\n{pixel}\n\
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

/// A suspension in water between slides, which carry light sideways: a program in C that follows photons through the five faces
/// one after the other, 4 million of them, returns 0.1120, 0.0887 through a port of 10.2 mm, and 0.0865 as a sample of 8 mm.
#[test]
fn slides_carry_light_out_of_the_port() {
    let slide = "{ kind = \"fresnel\" }, { kind = \"medium\", index = 1.507, thickness_mm = 1 }";
    let slab = "{ kind = \"fresnel\" }, { kind = \"slab\", index = 1.33, thickness_mm = 1, optical_thickness = 0.466, anisotropy = 0.862, albedo = 1.0 }";
    let below = "model = \"film\"\nsubstrate = 1.0\nfilm = [{ material = \"air\", thickness_nm = \"gap\" }]\narea = { back = 1.0 }\n\
                 gap_nm = { back = 0, dark = 0 }\ndefault_states = false\n[display.pixel.states]\nspheres = { back = { gap_nm = 0 } }";
    let of = |port: &str| {
        read_over(
            &format!("{slide}, {slab}, {slide}"),
            below,
            &format!("preset = \"d8-included\"\n{port}"),
            "adding",
        )[0]
    };
    for (port, expected) in [
        ("", 0.1120),
        ("port_mm = 10.2\nspot_mm = 2\nsample_mm = 50.8", 0.0887),
        ("port_mm = 10.2\nspot_mm = 2\nsample_mm = 8", 0.0865),
    ] {
        let found = of(port);
        assert!((found - expected).abs() < 5e-4, "{port}: {found} {expected}");
    }
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

/// Paths of a program of its own: light from 75 deg below a sheet of 0.3, through 1 mm of air into thin glass above paper. Between sheet
/// and face it keeps its polarisation, and paper mixes s and p. Returns the fraction that returns from the paper, and that within a
/// radius.
fn followed_below_a_sheet(paper: f64, radius_mm: f64) -> [f64; 2] {
    const PATHS: usize = 400_000;
    let mut state = 7_u64;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    // From both sides.
    let face = |sine: f64, is_s: bool| {
        let [air, glass] = [(1.0 - sine * sine).sqrt(), (2.25 - sine * sine).sqrt()];
        let amplitude = match is_s {
            true => (air - glass) / (air + glass),
            false => (2.25 * air - glass) / (2.25 * air + glass),
        };
        amplitude * amplitude
    };
    let mut returned = [0.0; 2];
    for _ in 0..PATHS {
        let (mut sine, mut turn, mut is_s) = (75.0_f64.to_radians().sin(), 0.0_f64, next() < 0.5);
        let (mut light, mut at, mut has_met) = (0.7, [0.0; 2], false);
        loop {
            // Down to the face, and from there or from the paper up to the sheet.
            let way = sine / (1.0 - sine * sine).sqrt();
            let step = [way * turn.cos(), way * turn.sin()];
            at = [at[0] + step[0], at[1] + step[1]];
            let mut goes_up = next() < face(sine, is_s);
            while !goes_up && light > 1e-6 {
                has_met = true;
                light *= paper;
                sine = 1.5 * next().sqrt();
                (turn, is_s) = (2.0 * PI * next(), next() < 0.5);
                goes_up = sine < 1.0 && next() >= face(sine, is_s);
            }
            if light <= 1e-6 {
                break;
            }
            let way = sine / (1.0 - sine * sine).sqrt();
            at = [at[0] + way * turn.cos(), at[1] + way * turn.sin()];
            if next() >= 0.3 {
                if has_met {
                    returned[0] += light / PATHS as f64;
                    returned[1] +=
                        f64::from(u8::from(at[0].hypot(at[1]) <= radius_mm)) * light / PATHS as f64;
                }
                break;
            }
        }
    }
    returned
}

/// Light between a sheet and a bare face above paper leaves beside the port with its shares of s and p.
#[test]
fn port_above_a_sheet_and_a_face_keeps_s_and_p_apart() {
    let layers = "{ kind = \"component\", reflectance = 0.3 }, { kind = \"medium\", index = 1, thickness_mm = 1 }, \
        { kind = \"fresnel\" }, { kind = \"medium\", index = 1.5, thickness_mm = 1e-6 }";
    let view = "[viewer]\ntheta_deg = 75\nfield_deg = 0";
    let seen = |port: &str, solver: &str| {
        let pixel = "kind = \"lambertian\"\nreflectance = { white = 0.5, black = 0.02 }";
        let found = read(layers, pixel, &format!("diffuse = 1\n{port}\n{view}"), solver);
        // Light that has not met the paper is the same.
        found[0] - found[1]
    };
    let [white, black] = [0.5, 0.02].map(|paper| followed_below_a_sheet(paper, 7.0));
    let port = "port_mm = 14\nspot_mm = 0.001";
    let (whole, inside) = (seen("", "adding"), seen(port, "adding"));
    let [expected, expected_inside] = [0, 1].map(|k| white[k] - black[k]);
    assert!((whole / expected - 1.0).abs() < 0.004, "{whole} {expected}");
    let (found, expected) = (inside / whole, expected_inside / expected);
    assert!((found - expected).abs() < 0.004, "{found} {expected}");
    // The mean of both at each reflection is another number.
    let mean = "adding\"\napproximation = \"unpolarised";
    let as_mean = seen(port, mean) / seen("", mean);
    assert!((as_mean - expected).abs() > 0.006, "{as_mean} {expected}");
}
