//! Exports of displays that are read again as the pixel of another display: what its light is, at all angles.

use std::f64::consts::PI;

use papilio_display::{
    BrdfGrid, BrdfState, HalfVectorGrid, LobeWidths, RingGrid, RowErrors, ViewerGrid, ViewerTable,
};
use papilio_formats::{BsdfSource, DataFile, read_bsdf, write_bsdf, write_bsdf_radiant, write_rgl};
use papilio_goniometry::{Preparation, kernel};
use papilio_optics::interface::fresnel_reflectance;
use papilio_optics::{Beta, Scatterer};

const SOURCE: BsdfSource<'_> = BsdfSource { papilio: "0", title: "paper", hash: "00" };

/// f of a display at two inclinations and the azimuth between them, degrees.
type F = fn(f64, f64, f64) -> f64;

fn bare(_: f64, _: f64, _: f64) -> f64 {
    0.6 / PI
}

fn passed(theta_deg: f64) -> f64 {
    1.0 - fresnel_reflectance(1.0, 1.5, theta_deg.to_radians().sin())
}

/// White paper below a bare face of glass: the light enters and leaves by Fresnel's transmittance.
fn below_glass(theta_i: f64, theta_o: f64, _: f64) -> f64 {
    0.5 / PI * passed(theta_i) * passed(theta_o)
}

/// The same with a lobe of 15 deg.
fn glossy(theta_i: f64, theta_o: f64, dphi: f64) -> f64 {
    let [i, o] = [theta_i, theta_o].map(|theta| theta.to_radians().sin());
    let distance = i * i + o * o + 2.0 * i * o * dphi.to_radians().cos();
    (0.1 + 1.5 * (-distance / 0.07).exp()) * passed(theta_i) * passed(theta_o)
}

/// A table of f at viewers that move with the light.
fn table<G: ViewerGrid>(grid: G, f: F, viewers: impl Fn(&G, usize) -> Vec<[f64; 2]>) -> ViewerTable<G> {
    let mut brdf = Vec::new();
    for (light, theta_i) in grid.theta_i_deg().iter().enumerate() {
        brdf.extend(
            viewers(&grid, light).iter().flat_map(|[theta_o, dphi]| [f(*theta_i, *theta_o, *dphi) as f32; 2]),
        );
    }
    let beams = vec![0.0; 2 * grid.theta_i_deg().len()];
    let state = BrdfState {
        name: "white".to_owned(),
        brdf,
        specular: beams.clone(),
        directional_hemispherical: beams,
    };
    ViewerTable {
        grid,
        wavelength_nm: vec![500.0, 600.0],
        states: vec![state],
        nodes: 0,
        discretisation_error: 0.0,
        row_errors: RowErrors::default(),
    }
}

fn moving<G: ViewerGrid>(grid: &G, light: usize) -> Vec<[f64; 2]> {
    grid.viewers(light).0.iter().map(|viewer| [viewer.theta_o_deg, viewer.dphi_deg]).collect()
}

/// The file of a display in a format.
fn exported(format: &str, f: F, widths: &LobeWidths) -> DataFile {
    let mut bytes = Vec::new();
    let fixed = || {
        let grid = BrdfGrid::even(5.0);
        let theta_o = grid.theta_o_deg.clone();
        let all: Vec<[f64; 2]> =
            theta_o.iter().flat_map(|theta| grid.dphi_deg.iter().map(move |dphi| [*theta, *dphi])).collect();
        let lights = grid.theta_i_deg.clone();
        let brdf =
            lights.iter().flat_map(|i| all.iter().flat_map(move |[o, dphi]| [f(*i, *o, *dphi) as f32; 2]));
        let beams = vec![0.0; 2 * lights.len()];
        let state = BrdfState {
            name: "white".to_owned(),
            brdf: brdf.collect(),
            specular: beams.clone(),
            directional_hemispherical: beams,
        };
        let wavelength_nm = vec![500.0, 600.0];
        let row_errors = RowErrors::default();
        ViewerTable {
            grid,
            wavelength_nm,
            states: vec![state],
            nodes: 0,
            discretisation_error: 0.0,
            row_errors,
        }
    };
    let end = match format {
        "rgl" => {
            let of = table(HalfVectorGrid::new(5.0, 64, widths), f, moving);
            write_rgl(&mut bytes, &SOURCE, &of, 0).unwrap();
            "bsdf"
        }
        "radiant" => {
            let of = table(RingGrid::new(5.0, widths), f, moving);
            write_bsdf_radiant(&mut bytes, &SOURCE, &of, 0).unwrap();
            "bsdf"
        }
        _ => {
            write_bsdf(&mut bytes, &SOURCE, &fixed()).unwrap();
            "npz"
        }
    };
    DataFile { name: format!("display-white.{end}"), bytes }
}

/// The light of f by equal parts of the projected solid angle.
fn total(f: F, theta: f64) -> f64 {
    let (rings, arcs) = (200, 72);
    let of = |k: i32| {
        let [ring, arc] = [k / arcs, k % arcs].map(|k| f64::from(k) + 0.5);
        f(theta, (ring / f64::from(rings)).sqrt().asin().to_degrees(), 360.0 * arc / f64::from(arcs))
    };
    PI * (0..rings * arcs).map(of).sum::<f64>() / f64::from(rings * arcs)
}

/// Displays in every format, at all inclinations: the light that the pixel scatters, and f towards viewers up to
/// the horizon. Without the face of the glass, f at 70 deg beside the plane of incidence was 0 for light from 45
/// deg, and three times too large at 88 deg; tables of rings were a lobe of 0.3 deg, too narrow for adding.
#[test]
fn exports_of_displays_have_their_light_as_pixels() {
    let mut wrong = Vec::new();
    let displays = [("bare", bare as F, 45.0), ("below glass", below_glass, 45.0), ("glossy", glossy, 6.3)];
    for (name, f, width) in displays {
        // The largest relative errors of the light, of f up to 75 deg, at 80 deg and at 88 deg. Grids of 5 deg end
        // at 85 deg; half vectors are widely spaced near the horizon.
        for (format, errors) in [
            ("rgl", [0.003, 0.03, 0.03, 0.06]),
            ("npz", [0.003, 0.045, 0.045, 0.06]),
            ("radiant", [0.003, 0.003, 0.003, 0.003]),
        ] {
            let read = read_bsdf(&exported(format, f, &LobeWidths::constant(width))).unwrap();
            let part = &read.value.parts[0];
            let preparation = Preparation { extrapolate: Some(1.0), ..Preparation::default() };
            let (scatter, _) = kernel(part, part.luminous(), &preparation, &[]).unwrap();
            assert!(scatter.width() > 0.1, "{name}, {format}: {}", scatter.width());
            let mut found = [0.0_f64; 4];
            for theta in [0.0, 45.0, 70.0, 80.0_f64] {
                let from = Beta { x: theta.to_radians().sin(), y: 0.0 };
                let mut note = |kind: usize, ratio: f64| found[kind] = found[kind].max((ratio - 1.0).abs());
                note(0, scatter.albedo_at(from.x) / total(f, theta));
                for (kind, theta_o) in
                    [(1, 0.0), (1, 30.0), (1, 60.0), (1, 70.0), (1, 75.0), (2, 80.0), (3, 88.0_f64)]
                {
                    for dphi in [0.0, 90.0, 180.0_f64] {
                        let (sin, (y, x)) = (theta_o.to_radians().sin(), dphi.to_radians().sin_cos());
                        // The light travels along x.
                        let to = Beta { x: -sin * x, y: sin * y };
                        note(kind, scatter.evaluate(from, to) / f(theta, theta_o, dphi));
                    }
                }
            }
            println!("{name}, {format}: {found:?}");
            if found.iter().zip(errors).any(|(found, most)| *found > most) {
                wrong.push(format!("{name}, {format}: {found:?} instead of at most {errors:?}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
