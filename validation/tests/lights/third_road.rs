//! A third road to every kind of light: quadrature of its formula, written here anew, against both solvers.
//!
//! Nothing of the engine's is used: radiances are the formulas of their standards, directions are summed by the double-exponential rule
//! in spherical coordinates about a *horizontal* axis (so that display and horizon are bounded by azimuths alone), cut at the sun.
//!
//! Three displays: a mirror, which shows the radiance itself; Lambertian paper under Fresnel's glass, which weighs
//! directions by his formulas; a mirror under a k-correlation diffuser, whose two passes are one of twice the width.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

use super::run_in;

/// Directions are unit vectors away from the display, z its normal.
type Direction = [f64; 3];

fn dot(a: Direction, b: Direction) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// By inclination and azimuth, degrees.
fn direction(theta: f64, phi: f64) -> Direction {
    let ((s, c), (sp, cp)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    [s * cp, s * sp, c]
}

/// The double-exponential rule on an interval: it does not mind what happens at the ends.
fn rule(from: f64, to: f64) -> Vec<(f64, f64)> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let step = 1.0 / 14.0;
    (-46..=46)
        .map(|k| {
            let t = f64::from(k) * step;
            let inner = FRAC_PI_2 * t.sinh();
            let weight = half * step * FRAC_PI_2 * t.cosh() / inner.cosh().powi(2);
            (middle + half * inner.tanh(), weight)
        })
        .collect()
}

/// A kind of light.
struct Light {
    name: &'static str,
    /// As in a scenario.
    keys: String,
    radiance: Box<dyn Fn(Direction) -> f64>,
    /// All directions that are lit, and the solid angles that they stand for.
    points: Vec<(Direction, f64)>,
    /// False for beams, which a mirror shows as nothing.
    has_image: bool,
}

impl Light {
    /// The mean, by what falls on the display, of what is seen of directions; and what falls on it.
    fn mean(&self, seen: impl Fn(Direction) -> f64) -> (f64, f64) {
        let (mut sum, mut whole) = (0.0, 0.0);
        for (towards, solid) in &self.points {
            let light = (self.radiance)(*towards) * towards[2] * solid;
            if light != 0.0 {
                whole += light;
                sum += light * seen(*towards);
            }
        }
        (sum / whole, whole)
    }
}

/// Directions above the display in a box of angles from an axis and turns about it, degrees; boxes end where the mirror image of the
/// view is, too, where lobes have their peak.
fn boxes(frame: [Direction; 3], angles: &[f64], turns: &[f64]) -> Vec<(Direction, f64)> {
    let [x, y, z] = frame.map(|axis| dot(axis, image()));
    let cut = |ends: &[f64], at: f64| {
        let known = ends;
        let mut ends = known.to_vec();
        ends.extend([at - 360.0, at, at + 360.0].into_iter().filter(|at| {
            known.iter().all(|end| (end - at).abs() > 1e-6) && known[0] < *at && *at < known[known.len() - 1]
        }));
        ends.sort_by(f64::total_cmp);
        ends
    };
    let (angles, turns) =
        (cut(angles, z.clamp(-1.0, 1.0).acos().to_degrees()), cut(turns, y.atan2(x).to_degrees()));
    let rules = |ends: &[f64]| -> Vec<(f64, f64)> {
        ends.windows(2).flat_map(|ends| rule(ends[0].to_radians(), ends[1].to_radians())).collect()
    };
    let turns = rules(&turns);
    let mut points = Vec::new();
    for (angle, dangle) in rules(&angles) {
        points.extend(
            turns.iter().map(|(turn, dturn)| (place(frame, angle, *turn), angle.sin() * dangle * dturn)),
        );
    }
    points.retain(|(towards, _)| towards[2] > 0.0);
    points
}

fn place(frame: [Direction; 3], angle: f64, turn: f64) -> Direction {
    let parts = [angle.sin() * turn.cos(), angle.sin() * turn.sin(), angle.cos()];
    std::array::from_fn(|i| (0..3).map(|k| parts[k] * frame[k][i]).sum())
}

const ABOUT_NORMAL: [Direction; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// About the x axis: azimuth 0 lies in the display along y, the normal at 90 deg.
const ABOUT_X: [Direction; 3] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];

/// About this direction.
fn about(axis: Direction) -> [Direction; 3] {
    let flat = axis[0].hypot(axis[1]);
    let side = [-axis[1] / flat, axis[0] / flat, 0.0];
    let out = [axis[2] * axis[0] / flat, axis[2] * axis[1] / flat, -flat];
    [out, side, axis]
}

/// CIE's general sky by its groups of gradation and indicatrix (ISO 15469, table 1), over a horizon.
fn cie_sky(number: usize, chi: f64, up: f64) -> f64 {
    if number == 16 {
        return (1.0 + 2.0 * up) / 3.0;
    }
    let gradations = [(4.0, 0.7), (1.1, 0.8), (0.0, 1.0), (-1.0, 0.55), (-1.0, 0.32), (-1.0, 0.15)];
    let indicatrices = [
        (0.0, 1.0, 0.0),
        (2.0, 1.5, 0.15),
        (5.0, 2.5, 0.3),
        (10.0, 3.0, 0.45),
        (16.0, 3.0, 0.3),
        (24.0, 2.8, 0.15),
    ];
    let groups = [
        (1, 1),
        (1, 2),
        (2, 1),
        (2, 2),
        (3, 1),
        (3, 2),
        (3, 3),
        (3, 4),
        (4, 2),
        (4, 3),
        (4, 4),
        (5, 4),
        (5, 5),
        (6, 5),
        (6, 6),
    ];
    let (gradation, indicatrix) = groups[number - 1];
    let (a, b): (f64, f64) = gradations[gradation - 1];
    let (c, d, e): (f64, f64, f64) = indicatrices[indicatrix - 1];
    let f = 1.0 + c * ((-d * chi).exp() - (-d * FRAC_PI_2).exp()) + e * chi.cos().powi(2);
    (1.0 + a * (-b / up.max(1e-300)).exp()) * f
}

fn apart(a: Direction, b: Direction) -> f64 {
    let chord = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    2.0 * (0.5 * chord).min(1.0).asin()
}

/// The display's view of the world's up and of a sun, when it is tilted about the x axis.
fn tilted(world: Direction, tilt: f64) -> Direction {
    let (s, c) = tilt.to_radians().sin_cos();
    [world[0], c * world[1] + s * world[2], c * world[2] - s * world[1]]
}

fn sky(name: &'static str, number: usize, (elevation, azimuth): (f64, f64), tilt: f64, ground: f64) -> Light {
    let keys = format!(
        "[[lighting.environment]]\nmodel = \"sky\"\nnumber = {number}\nsun_elevation_deg = {elevation}\n\
         sun_azimuth_deg = {azimuth}\nshare = 1\ntilt_deg = {tilt}\nground_reflectance = {ground}\n"
    );
    let (sun, up) = (tilted(direction(90.0 - elevation, azimuth), tilt), tilted([0.0, 0.0, 1.0], tilt));
    let below = if tilt > 0.0 {
        ground / PI * sky(name, number, (elevation, azimuth), 0.0, 0.0).mean(|_| 0.0).1
    } else {
        0.0
    };
    let radiance = move |towards: Direction| {
        let height = dot(towards, up);
        if height > 0.0 { cie_sky(number, apart(towards, sun), height) } else { below }
    };
    // A plane through the x axis is an azimuth about it: display, sun and horizon.
    let mut turns = vec![0.0, sun[2].atan2(sun[1]).to_degrees(), 180.0 - tilt, 180.0];
    turns.sort_by(f64::total_cmp);
    turns.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let points = boxes(ABOUT_X, &[0.0, sun[0].acos().to_degrees(), 180.0], &turns);
    Light { name, keys, radiance: Box::new(radiance), points, has_image: true }
}

fn directed(name: &'static str, theta: f64, radius: Option<f64>) -> Light {
    let of_disc = radius.map_or(String::new(), |radius| format!("radius_deg = {radius}\n"));
    let keys = format!("[[lighting.directed]]\ntheta_deg = {theta}\nphi_deg = 15\nshare = 1\n{of_disc}");
    let axis = direction(theta, 15.0);
    let points = match radius {
        Some(radius) => boxes(about(axis), &[0.0, radius], &[0.0, 360.0]),
        None => vec![(axis, 1.0)],
    };
    let within = radius.map_or(0.0, f64::to_radians) + 1e-12;
    let radiance = move |towards| if apart(towards, axis) <= within { 1.0 } else { 0.0 };
    Light { name, keys, radiance: Box::new(radiance), points, has_image: radius.is_some() }
}

fn environment(keys: &str) -> String {
    format!("[[lighting.environment]]\nshare = 1\n{keys}")
}

/// Even light between two angles from an axis, down to the horizon.
fn cap(name: &'static str, (theta, phi): (f64, f64), [from, to]: [f64; 2]) -> Light {
    let keys = environment(&format!(
        "model = \"cap\"\ntheta_deg = {theta}\nphi_deg = {phi}\nfrom_deg = {from}\nto_deg = {to}\n"
    ));
    let axis = direction(theta, phi);
    let mut points = Vec::new();
    if to == 180.0 {
        // The whole hemisphere less what is dark.
        points = boxes(ABOUT_NORMAL, &[0.0, 90.0], &[-180.0, 180.0]);
        let dark = boxes(about(axis), &[0.0, from], &[0.0, 360.0]);
        points.extend(dark.into_iter().map(|(towards, solid)| (towards, -solid)));
        let radiance = move |_| 1.0;
        return Light { name, keys, radiance: Box::new(radiance), points, has_image: true };
    }
    if theta.abs() + to < 90.0 {
        let radiance = move |towards| f64::from((from..=to).contains(&apart(towards, axis).to_degrees()));
        let points = boxes(about(axis), &[from, to], &[0.0, 360.0]);
        return Light { name, keys, radiance: Box::new(radiance), points, has_image: true };
    }
    // Azimuth 0 about the axis is away from the normal; the display's plane cuts arcs off on that side.
    let horizon = 90.0 - theta;
    let mut angles = vec![from, to];
    if (from..to).contains(&horizon) {
        angles.insert(1, horizon);
    }
    for ends in angles.windows(2) {
        for (angle, dangle) in rule(ends[0].to_radians(), ends[1].to_radians()) {
            let cosine = 1.0 / (angle.tan() * theta.to_radians().tan());
            let below = if angle < horizon.to_radians() { 0.0 } else { cosine.min(1.0).acos() };
            let lit = rule(below, TAU - below).into_iter();
            points.extend(
                lit.map(|(turn, dturn)| (place(about(axis), angle, turn), angle.sin() * dangle * dturn)),
            );
        }
    }
    let radiance = move |towards| {
        if (from..=to).contains(&apart(towards, axis).to_degrees()) { 1.0 } else { 0.0 }
    };
    Light { name, keys, radiance: Box::new(radiance), points, has_image: true }
}

const ROWS: [(f64, f64); 4] = [(0.0, 1.0), (17.0, 4.0), (40.0, 3.0), (75.0, 0.5)];

fn table(theta: f64) -> f64 {
    let of = |ends: &[(f64, f64)]| {
        let along = (theta - ends[0].0) / (ends[1].0 - ends[0].0);
        (0.0..=1.0).contains(&along).then_some(ends[0].1 + along * (ends[1].1 - ends[0].1))
    };
    ROWS.windows(2).find_map(of).unwrap_or(0.0)
}

fn inclination(towards: Direction) -> f64 {
    towards[0].hypot(towards[1]).atan2(towards[2]).to_degrees()
}

/// A picture, 16 pixels by 8, by pixel.
fn pixel(row: usize, column: usize) -> u8 {
    [12, 200, 40, 90, 3, 131, 77][(row * row + 3 * column + row * column) % 7]
}

fn lights() -> Vec<Light> {
    let even = || boxes(ABOUT_NORMAL, &[0.0, 90.0], &[-180.0, 180.0]);
    let rows = ROWS.map(|row| row.0);
    let cells: Vec<f64> = (0..=16).map(|k| -180.0 + 22.5 * f64::from(k)).collect();
    let mut lights = vec![
        Light {
            name: "diffuse",
            keys: "diffuse = 1\n".to_owned(),
            radiance: Box::new(|_| 1.0),
            points: even(),
            has_image: true,
        },
        Light {
            name: "ring",
            keys: environment("model = \"ring\"\ntheta_deg = 19\nwidth_deg = 10\n"),
            radiance: Box::new(|towards| f64::from((14.0..24.0).contains(&inclination(towards)))),
            points: boxes(ABOUT_NORMAL, &[14.0, 24.0], &[-180.0, 180.0]),
            has_image: true,
        },
        Light {
            name: "profile",
            keys: environment("model = \"profile\"\nfile = \"profile.csv\"\n"),
            radiance: Box::new(|towards| table(inclination(towards))),
            points: boxes(ABOUT_NORMAL, &rows, &[-180.0, 180.0]),
            has_image: true,
        },
        Light {
            name: "map",
            keys: environment("model = \"map\"\nfile = \"map.hdr\"\n"),
            radiance: Box::new(|towards| {
                let right = (90.0 - towards[1].atan2(towards[0]).to_degrees()).rem_euclid(360.0);
                0.5 + f64::from(pixel((inclination(towards) / 22.5) as usize, (right / 22.5) as usize))
            }),
            points: boxes(ABOUT_NORMAL, &[0.0, 22.5, 45.0, 67.5, 90.0], &cells),
            has_image: true,
        },
        directed("beam", -35.0, None),
        directed("disc", -18.0, Some(6.0)),
        directed("the sun", -50.0, Some(0.27)),
        directed("a low sun", 89.5, Some(0.27)),
        directed("a low disc", 88.0, Some(1.9)),
        cap("cap", (-24.0 + 0.0, 10.0), [0.0, 12.0]),
        cap("cap between two angles", (30.0, 200.0), [8.0, 17.0]),
        cap("low cap", (70.0, 100.0), [10.0, 45.0]),
        cap("trap", (8.0, 30.0), [5.0, 180.0]),
        Light {
            name: "luminaire",
            keys: environment(
                "model = \"luminaire\"\nfile = \"lamp.ies\"\nelevation_deg = 65\nazimuth_deg = 170\ndistance_m = 3\n",
            ),
            ..luminaire()
        },
    ];
    for number in [1, 3, 5, 16] {
        lights.push(sky(
            ["overcast", "gradual", "uniform", "traditional"][number % 4],
            number,
            (40.0, 0.0),
            0.0,
            0.0,
        ));
    }
    for number in [2, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15] {
        let sun = (15.0 + 4.0 * number as f64, 10.0 * number as f64);
        lights.push(sky("with a sun", number, sun, 0.0, 0.0));
    }
    lights.push(sky("sun beside the image", 12, (67.0, 184.0), 0.0, 0.0));
    lights.push(sky("low sun", 14, (2.0, 120.0), 0.0, 0.0));
    lights.push(sky("upright", 13, (30.0, -60.0), 90.0, 0.2));
    lights.push(sky("tilted", 12, (50.0, -100.0), 35.0, 0.5));
    lights
}

/// An opening of .6 m by .6 m, seen by the cosine at 3 m from 25 deg off its nadir, as a disc.
fn luminaire() -> Light {
    let axis = direction(25.0, 170.0);
    let radius = (0.36 * 25.0_f64.to_radians().cos() / PI).sqrt().atan2(3.0).to_degrees();
    let points = boxes(about(axis), &[0.0, radius], &[0.0, 360.0]);
    let radiance = move |towards| if apart(towards, axis).to_degrees() <= radius { 1.0 } else { 0.0 };
    Light { name: "", keys: String::new(), radiance: Box::new(radiance), points, has_image: true }
}

/// Inclination and azimuth of the view.
const VIEW: [f64; 2] = [20.0, 10.0];

/// What a mirror shows to it.
fn image() -> Direction {
    direction(-VIEW[0], VIEW[1])
}

const INDEX: f64 = 1.5;
const PIXEL: f64 = 0.6;
const WIDTH: f64 = 0.06;
const THROUGH: f64 = 0.9;

fn display(name: &str) -> String {
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

/// Fresnel's transmittance into the glass by the cosine of incidence.
fn entering(cosine: f64) -> f64 {
    let inside = (1.0 - (1.0 - cosine * cosine) / (INDEX * INDEX)).sqrt();
    let s = (cosine - INDEX * inside) / (cosine + INDEX * inside);
    let p = (INDEX * cosine - inside) / (INDEX * cosine + inside);
    1.0 - 0.5 * (s * s + p * p)
}

/// The reflectance factor of a display under a light.
fn truth(name: &str, light: &Light) -> f64 {
    let in_mirror = || {
        let whole = light.mean(|_| 0.0).1;
        if light.has_image { PI * (light.radiance)(image()) / whole } else { 0.0 }
    };
    let cosine = VIEW[0].to_radians().cos();
    match name {
        "mirror" => PIXEL * in_mirror(),
        "glass" | "layers" => {
            // What leaves of light that a Lambertian surface sends up, by reciprocity.
            let out: f64 =
                rule(0.0, FRAC_PI_2).iter().map(|(x, w)| w * (2.0 * x).sin() * entering(x.cos())).sum();
            let back = 1.0 - out / (INDEX * INDEX);
            let by_base = entering(cosine) * PIXEL / (1.0 - PIXEL * back) / (INDEX * INDEX);
            by_base * light.mean(|towards| entering(towards[2])).0 + (1.0 - entering(cosine)) * in_mirror()
        }
        _ => {
            // Two passes of the lobe are one of twice the width, less what is beyond the directions in the glass.
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

/// The files that lights name.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let rows: String = ROWS.iter().map(|(theta, radiance)| format!("{theta},{radiance}\n")).collect();
    std::fs::write(folder.path().join("profile.csv"), format!("theta_deg,radiance\n{rows}")).unwrap();
    let mut picture = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n".to_vec();
    for row in 0..8 {
        // Grey, mantissas and an exponent; runs of one.
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

fn text(display: &str, light: &str, solver: &str) -> String {
    text_seen(display, light, solver, (VIEW, 0.0))
}

fn text_seen(display: &str, light: &str, solver: &str, (view, field): ([f64; 2], f64)) -> String {
    let lighting = if light.starts_with('[') { format!("diffuse = 0\n{light}") } else { light.to_owned() };
    format!(
        "title = \"light\"\n[spectrum]\nrange_nm = [380, 780]\nstep_nm = 200\n{display}[lighting]\n\
         illuminance_lx = 100\nspectrum = \"E\"\n{lighting}[viewer]\ntheta_deg = {}\nphi_deg = {}\nfield_deg = {field}\n[solver]\n{solver}\n",
        view[0], view[1]
    )
}

/// Every kind of light over every display, by both solvers. The test's own error is that of its lobe: 1e-7 at the peak, 1e-6 at grazing
/// angles.
#[test]
fn lights_are_their_formulas() {
    let folder = folder();
    let mut wrong = Vec::new();
    for light in lights() {
        for name in ["mirror", "glass", "layers", "lobe"] {
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
            let walk = run_in(&scenario("method = \"walk\"\npaths = 4096"), folder.path());
            let white = walk.views[0].states.get("white").unwrap();
            let (seen, error) = (white.value.Y, white.standard_error.Y);
            if (seen - truth).abs() > 4.5 * error + own || error > 0.05 * truth {
                wrong.push(format!("{} +- {error:.2e}", what("walk", seen)));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Mirror images over a field of view: the mean of the formula, with a sun or an edge in the middle of it.
#[test]
fn images_are_means_over_the_field_of_view() {
    let folder = folder();
    let mut lights = vec![
        sky("a sun in view", 13, (69.0, 186.0), 0.0, 0.0),
        sky("a horizon in view", 15, (30.0, 40.0), 86.0, 0.3),
    ];
    lights.push(cap("an edge in view", (30.0, 190.0), [0.0, 9.5]));
    for light in lights {
        let whole = light.mean(|_| 0.0).1;
        let half = 2.0_f64;
        // About the sun, or about the view itself.
        let seen = match light.name {
            "an edge in view" => {
                let turns = |angle: f64| {
                    let (axis, view) = (30.0_f64.to_radians(), VIEW[0].to_radians());
                    let apart = axis - view;
                    let cosine = (9.5_f64.to_radians().cos() - angle.cos() * apart.cos())
                        / (angle.sin() * apart.sin());
                    cosine.clamp(-1.0, 1.0).acos() / PI
                };
                let rim = (0.5_f64.to_radians(), half.to_radians());
                rule(rim.0, rim.1)
                    .iter()
                    .map(|(angle, weight)| weight * angle.sin() * turns(*angle))
                    .sum::<f64>()
                    / (1.0 - half.to_radians().cos())
            }
            "a horizon in view" => {
                // Turns at which the horizon is met, by the upward direction in the frame of the image.
                let (frame, up) = (about(image()), tilted([0.0, 0.0, 1.0], 86.0));
                let [x, y, z] = frame.map(|axis| dot(axis, up));
                let mut sum = 0.0;
                let rim = (FRAC_PI_2 - z.acos()).abs().min(half.to_radians());
                for ends in [[0.0, rim], [rim, half.to_radians()]] {
                    for (angle, dangle) in rule(ends[0], ends[1]) {
                        let cosine = (-z * angle.cos() / (angle.sin() * x.hypot(y))).clamp(-1.0, 1.0);
                        let (middle, open) = (y.atan2(x), cosine.acos());
                        for turns in [[middle - open, middle + open], [middle + open, middle - open + TAU]] {
                            let around = rule(turns[0], turns[1]);
                            let light = around
                                .iter()
                                .map(|(turn, w)| w * (light.radiance)(place(frame, angle, *turn)));
                            sum += dangle * angle.sin() * light.sum::<f64>();
                        }
                    }
                }
                sum / (TAU * (1.0 - half.to_radians().cos()))
            }
            _ => {
                let (sun, mut sum) = (direction(21.0, 186.0), 0.0);
                let (frame, apart) = (about(sun), apart(sun, image()));
                let [x, y, _] = frame.map(|axis| dot(axis, image()));
                let half = half.to_radians();
                for ends in [[0.0, half - apart], [half - apart, half + apart]] {
                    for (angle, dangle) in rule(ends[0], ends[1]) {
                        let cosine = (half.cos() - angle.cos() * apart.cos()) / (angle.sin() * apart.sin());
                        let open = cosine.clamp(-1.0, 1.0).acos();
                        let around = rule(y.atan2(x) - open, y.atan2(x) + open);
                        let light =
                            around.iter().map(|(turn, w)| w * (light.radiance)(place(frame, angle, *turn)));
                        sum += dangle * angle.sin() * light.sum::<f64>();
                    }
                }
                sum / (TAU * (1.0 - half.cos()))
            }
        };
        let truth = PIXEL * PI * seen / whole;
        let scenario = |solver: &str| text_seen(&display("mirror"), &light.keys, solver, (VIEW, 2.0 * half));
        let adding = run_in(&scenario("relative_error = 1e-4"), folder.path());
        let white = adding.views[0].states.get("white").unwrap();
        let (off, claimed) = ((white.value.Y - truth).abs(), white.discretisation_error.as_ref().unwrap().Y);
        assert!(off <= claimed + 1e-7 * truth, "{}: {} {truth} {claimed:.1e}", light.name, white.value.Y);
        let walk = run_in(&scenario("method = \"walk\"\npaths = 16384"), folder.path());
        let white = walk.views[0].states.get("white").unwrap();
        let off = (white.value.Y - truth).abs();
        assert!(
            off <= 4.5 * white.standard_error.Y + 1e-7 * truth,
            "{}: {} {truth}",
            light.name,
            white.value.Y
        );
    }
}

/// Of paper under glass in layers a field of view next to the horizon is more than its middle.
#[test]
fn a_field_of_view_next_to_the_horizon() {
    let out: f64 = rule(0.0, FRAC_PI_2).iter().map(|(x, w)| w * (2.0 * x).sin() * entering(x.cos())).sum();
    let below = PIXEL / (1.0 - PIXEL * (1.0 - out / (INDEX * INDEX))) * out / (INDEX * INDEX);
    for (theta, field) in [(60.0, 10.0), (89.5, 0.9), (89.9, 0.19)] {
        let axis = direction(theta, 0.0);
        let (mut sum, mut whole) = (0.0, 0.0);
        for (angle, dangle) in rule(0.0, (0.5_f64 * field).to_radians()) {
            for (turn, dturn) in rule(0.0, PI) {
                let weight = angle.sin() * dangle * dturn;
                let enters = entering(place(about(axis), angle, turn)[2]);
                whole += weight;
                sum += weight * (1.0 - enters * (1.0 - below));
            }
        }
        let text = text_seen(&display("layers"), "diffuse = 1\n", "", ([theta, 0.0], field));
        let white = run_in(&text, Path::new(".")).views[0].states.get("white").unwrap().clone();
        let claimed = white.discretisation_error.as_ref().unwrap().Y;
        let off = (white.value.Y - sum / whole).abs();
        assert!(off <= claimed + 1e-9, "{theta} deg: {} {} {claimed:.1e}", white.value.Y, sum / whole);
    }
}

/// A sky, its sun, the display's view and what it mirrors turn together.
#[test]
fn light_and_view_turn_together() {
    let display = "[[display.front]]\nreflectance = 0.02\nabsorptance = 0.01\n[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.08\n\
        transmittance = 0.9\nstraight_through = 0.2\n[display.glass]\nindex = 1.5\n[display.pixel]\nmodel = \"uniform\"\n\
        kind = \"mirror\"\nreflectance = { white = 0.6, black = 0.05 }\n";
    let turned = |by: f64| {
        let keys = format!(
            "[[lighting.environment]]\nmodel = \"sky\"\nnumber = 12\nsun_elevation_deg = 50\nsun_azimuth_deg = {by}\nshare = 0.7\n\
             [[lighting.environment]]\nmodel = \"cap\"\ntheta_deg = 30\nphi_deg = {}\nto_deg = 12\nshare = 0.3\n",
            by + 5.0
        );
        let text = text_seen(display, &keys, "", ([36.0, 180.0 + by], 0.1));
        let white = run_in(&text, Path::new(".")).views[0].states.get("white").unwrap().clone();
        (white.value.Y, white.discretisation_error.as_ref().unwrap().Y)
    };
    let (truth, error) = turned(0.0);
    for by in [50.0, 123.4] {
        let (seen, claimed) = turned(by);
        assert!((seen - truth).abs() <= error + claimed, "{by}: {seen} {truth} {error:.1e} {claimed:.1e}");
    }
}
