//! Colour filters above mirror-like pixels: closed forms, and paths.

use std::f64::consts::PI;

use papilio_display::result::StateValues;
use papilio_optics::interface::{fresnel_reflectance, fresnel_reflectance_p, fresnel_reflectance_s};
use papilio_testing::everyday;

use crate::common::run_on;
use crate::filter::{LIGHT, assert_colours_are_those_of_paths, filter, glass, near, resolved};

const MIRROR: &str =
    "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.9, black = 0.1 }\n";
const PARTS: &str = "red = 0.8, green = 0.5, blue = 0.2";
const FRONT: &str = "[[display.front]]\nreflectance = 0.15\ngap_mm = 0.07\n";
/// Transmittances of `PARTS`.
const T: [f64; 3] = [0.8, 0.5, 0.2];

/// Reflectances of the pixels below the parts of the filter in some states.
const STATES: [(&str, [f64; 3]); 4] =
    [("white", [0.9; 3]), ("black", [0.1; 3]), ("red", [0.9, 0.1, 0.1]), ("cyan", [0.1, 0.9, 0.9])];

fn of_pixel(state: &StateValues) -> f64 {
    state.Y - state.terms.front_reflection
}

/// Light along the normal passes the same part of the filter each time, at any height: `t^2 rho` in the
/// geometric series of the face. The image of a lamp is the same.
#[test]
fn light_along_the_normal_has_its_closed_form() {
    let light = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.6\n\
                 [[lighting.directed]]\ntheta_deg = 0\nshare = 0.4\n";
    let view = "[viewer]\ntheta_deg = 0\nfield_deg = 0\n";
    let face = fresnel_reflectance(1.5, 1.0, 0.0);
    for height_um in [0.0, 37.0] {
        let display = resolved(&[&glass("fresnel", 0.3), MIRROR, light, &filter(height_um, PARTS), view]);
        let run = run_on(&display.scene, Some(1)).unwrap();
        for (name, rho) in STATES {
            let of = |k: usize| T[k].powi(2) * rho[k] / (1.0 - face * T[k].powi(2) * rho[k]);
            let expected = (1.0 - face).powi(2) * (0..3).map(of).sum::<f64>() / 3.0;
            let state = &run.views[0].states.get(name).unwrap().value;
            near(name, of_pixel(state), 0.6 * expected, 1e-6);
            near("image", state.specular[0], face + expected, 1e-6);
        }
    }
}

/// Oblique light that passes the filter a third of a period before and after it meets the pixel, and returns to
/// the same place of another period, so that a part of another colour is on both sides. The face returns s and p as what they are.
#[test]
fn oblique_light_passes_other_parts_of_the_filter() {
    for theta_deg in [30.0, 60.0, 75.0_f64] {
        let (pitch_um, sine) = (84.67, theta_deg.to_radians().sin());
        let height_um = pitch_um / 3.0 / (sine / (2.25 - sine * sine).sqrt());
        let slant = 1.0 / (1.0 - sine * sine / 2.25).sqrt();
        let glass = glass("fresnel", 1.5e-3 * height_um);
        let view = format!("[viewer]\ntheta_deg = {theta_deg}\nfield_deg = 0\n");
        let display = resolved(&[&glass, MIRROR, LIGHT, &filter(height_um, PARTS), &view]);
        let run = run_on(&display.scene, Some(1)).unwrap();
        let faces = [fresnel_reflectance_s, fresnel_reflectance_p].map(|of| of(1.5, 1.0, sine));
        for (name, rho) in STATES {
            let of = |(k, face): (usize, f64)| {
                let once = (T[(k + 1) % 3] * T[(k + 2) % 3]).powf(slant) * rho[k];
                (1.0 - face).powi(2) * once / (1.0 - face * once)
            };
            let expected = (0..3).flat_map(|k| faces.map(|face| (k, face))).map(of).sum::<f64>() / 6.0;
            near(name, of_pixel(&run.views[0].states.get(name).unwrap().value), expected, 1e-5);
        }
    }
}

/// A wide view of a filter far above small pixels sees the mean of each pass.
#[test]
fn far_filters_have_mean_transmittances() {
    let (view, far) = ("[viewer]\ntheta_deg = 40\nfield_deg = 30\n", filter(499.0, PARTS));
    let small = far.replace("84.67", "10");
    let display = resolved(&[&glass("coated", 0.5), MIRROR, LIGHT, &small, view]);
    let run = run_on(&display.scene, Some(1)).unwrap();
    let passed = |k: i32| {
        let (part, turn) = (f64::from(k / 40) + 0.5, (f64::from(k % 40) + 0.5) * PI / 40.0);
        let (angle, axis) = (15_f64.to_radians() * (part / 40.0).sqrt(), 40_f64.to_radians());
        let cosine = axis.cos() * angle.cos() + axis.sin() * angle.sin() * turn.cos();
        let slant = 1.0 / (1.0 - (1.0 - cosine * cosine) / 2.25).sqrt();
        (T.iter().map(|t| t.powf(slant)).sum::<f64>() / 3.0).powi(2)
    };
    let mean = (0..1600).map(passed).sum::<f64>() / 1600.0;
    for (name, rho) in STATES {
        let state = run.views[0].states.get(name).unwrap();
        let expected = mean * rho.iter().sum::<f64>() / 3.0;
        // The view contains some tens of periods.
        near(name, of_pixel(&state.value), expected, 0.03 * expected);
    }
}

const FILM: &str = "[display.pixel]\nmodel = \"film\"\nsubstrate = \"Al\"\n\
    area = { red = 0.3334, green = 0.3333, blue = 0.3333 }\ngap_nm = { red = 120, green = 120, blue = 120, dark = 20 }\n\
    film = [{ material = \"Cr:Johnson\", thickness_nm = 12 }, { material = \"air\", thickness_nm = \"gap\" }]\n";

/// Films and mirrors below lobes, faces and fronts, in diffuse light, beams, round lamps and a sky: paths.
#[test]
fn colours_are_those_of_paths() {
    let lobe = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.1\ntransmittance = 0.9\n";
    let lamp = "[[lighting.directed]]\ntheta_deg = -35\nphi_deg = 20\nshare = 0.4\n";
    let half = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.6\n";
    let sky = "[lighting]\nilluminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 0.2\n\
               [[lighting.environment]]\nshare = 0.8\nmodel = \"sky\"\nnumber = 12\nsun_elevation_deg = 30\n";
    let view = |theta: f64, field: f64| {
        format!("[viewer]\ntheta_deg = {theta}\nphi_deg = 20\nfield_deg = {field}\n")
    };
    let (beam, disc) = (format!("{half}{lamp}"), format!("{half}{lamp}radius_deg = 4\n"));
    let stripes = filter(30.0, PARTS);
    let tiles = "[display.matrix]\npitch_um = 90\n\
        subpixel = { red = [[0.05, 0.05, 0.45, 0.9]], green = [[0.5, 0.0, 0.9, 0.4]], blue = [[0.5, 0.5, 0.95, 0.95]] }\n\
        [display.matrix.filter]\nheight_um = 40\ntransmittance = { red = 0.8, green = 0.5, blue = 0.2 }\n";
    let fresnel = glass("fresnel", 0.2);
    let coated = glass("coated", 0.2);
    let absorbing = format!("{fresnel}internal_transmittance = 0.8\n");
    let cases = [
        [lobe, &coated, FILM, &beam, &stripes, &view(20.0, 0.0)],
        [FRONT, &absorbing, MIRROR, &disc, tiles, &view(35.0, 2.0)],
        [FRONT, &fresnel, FILM, sky, &stripes, &view(40.0, 0.0)],
        [lobe, &coated, MIRROR, sky, tiles, &view(30.0, 0.0)],
    ];
    for parts in everyday(1, cases) {
        assert_colours_are_those_of_paths(&resolved(&parts).scene);
    }
}
