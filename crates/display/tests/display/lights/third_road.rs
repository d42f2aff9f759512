//! A third method for all kinds of light: quadrature of their formulas, implemented independently, against
//! both solvers.
//!
//! No code of the library is used: radiances are the formulas of the standards, and directions are summed by
//! the double-exponential rule in spherical coordinates about a *horizontal* axis (so that the limits of
//! display and horizon are azimuths), divided at the sun.
//!
//! Three displays: a mirror, which shows the radiance itself; Lambertian paper under glass, which weights
//! directions by Fresnel's formulas; and a mirror under a k-correlation diffuser, whose two passes equal one
//! of twice the width.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use papilio_testing::everyday;

use super::formulas::*;
use super::run_in;

pub(super) const INDEX: f64 = 1.5;
pub(super) const PIXEL: f64 = 0.6;
const WIDTH: f64 = 0.06;
const THROUGH: f64 = 0.9;

pub(super) fn display(name: &str) -> String {
    let pixel = |kind: &str| {
        format!(
            "[display.pixel]\nmodel = \"uniform\"\nkind = \"{kind}\"\nreflectance = {{ white = {PIXEL}, black = 0.05 }}\n"
        )
    };
    match name {
        "mirror" => format!("[display.glass]\nindex = 1\n{}", pixel("mirror")),
        "glass" => {
            format!("[display.glass]\nindex = {INDEX}\nsurface = \"fresnel\"\n{}", pixel("lambertian"))
        }
        "layers" => format!(
            "[display]\nlayers = [{{ kind = \"fresnel\" }}, {{ kind = \"medium\", index = {INDEX} }}]\n{}",
            pixel("lambertian")
        ),
        _ => format!(
            "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = {WIDTH}\ntransmittance = {THROUGH}\n\
             [display.glass]\nindex = 4\n{}",
            pixel("mirror")
        ),
    }
}

/// Computes the Fresnel transmittance into the glass at a cosine of incidence.
pub(super) fn entering(cosine: f64) -> f64 {
    let inside = (1.0 - (1.0 - cosine * cosine) / (INDEX * INDEX)).sqrt();
    let s = (cosine - INDEX * inside) / (cosine + INDEX * inside);
    let p = (INDEX * cosine - inside) / (INDEX * cosine + inside);
    1.0 - 0.5 * (s * s + p * p)
}

/// Computes the reflectance factor of a display under a light.
pub(super) fn truth(name: &str, light: &Light) -> f64 {
    let in_mirror = || {
        let whole = light.mean(|_| 0.0).1;
        if light.has_image { PI * (light.radiance)(image()) / whole } else { 0.0 }
    };
    let cosine = VIEW[0].to_radians().cos();
    match name {
        "mirror" => PIXEL * in_mirror(),
        "glass" | "layers" => {
            // The transmitted fraction of the light of a Lambertian surface, by reciprocity.
            let out: f64 =
                rule(0.0, FRAC_PI_2).iter().map(|(x, w)| w * (2.0 * x).sin() * entering(x.cos())).sum();
            let back = 1.0 - out / (INDEX * INDEX);
            let by_base = entering(cosine) * PIXEL / (1.0 - PIXEL * back) / (INDEX * INDEX);
            by_base * light.mean(|towards| entering(towards[2])).0 + (1.0 - entering(cosine)) * in_mirror()
        }
        _ => {
            // Two passes of the lobe equal one of twice the width, minus the light outside the disc of the
            // glass.
            let peak = image();
            let beyond = |towards: Direction| {
                let sum = (towards[0] + peak[0]).powi(2) + (towards[1] + peak[1]).powi(2);
                let next = 2.25 * sum - 3.0 * WIDTH * WIDTH;
                WIDTH * WIDTH / TAU * (0.25 / 4.0_f64.powi(4) + next / 6.0 / 4.0_f64.powi(6))
            };
            let lobe = |towards: Direction| {
                let square = (towards[0] - peak[0]).powi(2) + (towards[1] - peak[1]).powi(2);
                let width = 2.0 * WIDTH;
                width / (TAU * (width * width + square).powf(1.5)) - beyond(towards)
            };
            PI * THROUGH * THROUGH * PIXEL * light.mean(lobe).0
        }
    }
}

/// Writes the files of the lights to a temporary folder.
pub(super) fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = ROWS.iter().map(|(theta, radiance)| format!("{theta},{radiance}\n")).collect();
    std::fs::write(folder.path().join("profile.csv"), format!("theta_deg,radiance\n{rows}")).unwrap();
    let mut picture = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n".to_vec();
    for row in 0..8 {
        // Grey pixels: three mantissas and an exponent, in runs of one.
        picture.extend([2, 2, 0, 16]);
        for _ in 0..3 {
            picture.push(16);
            picture.extend((0..16).map(|column| pixel(row, column)));
        }
        picture.extend([128 + 16, 129]);
    }
    std::fs::write(folder.path().join("map.hdr"), picture).unwrap();
    let lamp = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0.6 0.6 0\n1 1 36\n0 90\n0\n100 0\n";
    std::fs::write(folder.path().join("lamp.ies"), lamp).unwrap();
    folder
}

pub(super) fn text(display: &str, light: &str, solver: &str) -> String {
    text_seen(display, light, solver, (VIEW, 0.0))
}

pub(super) fn text_seen(display: &str, light: &str, solver: &str, (view, field): ([f64; 2], f64)) -> String {
    let lighting = if light.starts_with('[') { format!("diffuse = 0\n{light}") } else { light.to_owned() };
    format!(
        "title = \"light\"\n[spectrum]\nrange_nm = [380, 780]\nstep_nm = 200\n{display}[lighting]\n\
         illuminance_lx = 100\nspectrum = \"E\"\n{lighting}[viewer]\ntheta_deg = {}\nphi_deg = {}\nfield_deg = {field}\n[solver]\n{solver}\n",
        view[0], view[1]
    )
}

/// All kinds of light over all displays, by both solvers. The error of the reference is that of its lobe:
/// 1e-7 at the peak, 1e-6 at grazing angles.
#[test]
fn reflectance_under_every_light_equals_the_quadrature_of_its_formula() {
    let folder = folder();
    let mut wrong = Vec::new();
    for (number, light) in lights().into_iter().enumerate() {
        // A mirror shows the light itself; every day only some lights are seen through all layers.
        let count = if number % 5 == 0 { 4 } else { 2 };
        for name in everyday(count, ["mirror", "glass", "layers", "lobe"]) {
            let truth = truth(name, &light);
            let own = truth * if name == "lobe" { 1e-6 } else { 1e-8 };
            let scenario = |solver: &str| text(&display(name), &light.keys, solver);
            let adding = run_in(&scenario("relative_error = 1e-4"), folder.path());
            let white = adding.views[0].states.get("white").unwrap();
            let claimed = white.discretisation_error.as_ref().unwrap().Y;
            let what = |by: &str, seen: f64| {
                format!(
                    "{} over {name} by {by}: {seen}, truth {truth} ({:.2e})",
                    light.name,
                    seen / truth - 1.0
                )
            };
            if (white.value.Y - truth).abs() > claimed + own {
                wrong.push(format!("{}, claimed {claimed:.2e}", what("adding", white.value.Y)));
            }
            let walk = run_in(&scenario("method = \"monte-carlo\"\npaths = 4096"), folder.path());
            let white = walk.views[0].states.get("white").unwrap();
            let (seen, error) = (white.value.Y, white.standard_error.Y);
            if (seen - truth).abs() > 4.5 * error + own || error > 0.05 * truth {
                wrong.push(format!("{} +- {error:.2e}", what("Monte Carlo", seen)));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
