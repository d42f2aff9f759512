//! Light maps in any orientation, by both solvers, against the map's own pixels.
//!
//! No code of the library is used for the expected values: a direction is rotated into the picture by the
//! angles' definition, and the irradiance and a lobe's light are sums over the sphere.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use papilio_testing::everyday;

use super::run_in;
use super::third_road::{PIXEL, display, text_seen};

const ROWS: usize = 16;
const COLUMNS: usize = 32;
/// Mantissa of a pixel: neighbours differ by up to 15 times.
fn mantissa(row: usize, column: usize) -> u8 {
    if (row + column).is_multiple_of(2) { 16 } else { 120 + (37 * row + 53 * column) as u8 % 128 }
}

fn picture() -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {ROWS} +X {COLUMNS}\n").into_bytes();
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            bytes.extend([[mantissa(row, column); 3].as_slice(), &[129]].concat());
        }
    }
    bytes
}

/// Orientation of the map and the display.
#[derive(Debug, Clone, Copy)]
struct Orientation {
    rotate: f64,
    tilt: f64,
}

impl Orientation {
    /// Radiance from a direction of the display: its upper edge is turned up by the tilt about the x axis.
    fn radiance(self, [x, y, z]: [f64; 3]) -> f64 {
        let (sin, cos) = self.tilt.to_radians().sin_cos();
        let [x, y, up] = [x, cos * y - sin * z, sin * y + cos * z];
        let from_zenith = up.clamp(-1.0, 1.0).acos() / PI;
        // The middle of the picture is at azimuth -90 deg; to the right is clockwise.
        let to_the_left = (y.atan2(x).to_degrees() + 90.0 - self.rotate).rem_euclid(360.0) / 360.0;
        let column = ((0.5 - to_the_left).rem_euclid(1.0) * COLUMNS as f64) as usize;
        let row = (from_zenith * ROWS as f64) as usize;
        (f64::from(mantissa(row.min(ROWS - 1), column.min(COLUMNS - 1))) + 0.5) / 128.0
    }

    /// Sum over the hemisphere of radiance times a weight, by area of direction cosines.
    fn sum(self, weight: impl Fn([f64; 3]) -> f64) -> f64 {
        let (rings, turns) = (720, 1440);
        let mut sum = 0.0;
        for ring in 0..rings {
            let (sin, cos) = (FRAC_PI_2 * (f64::from(ring) + 0.5) / f64::from(rings)).sin_cos();
            let area = sin * cos * FRAC_PI_2 / f64::from(rings) * TAU / f64::from(turns);
            for turn in 0..turns {
                let (sin_turn, cos_turn) = (TAU * (f64::from(turn) + 0.5) / f64::from(turns)).sin_cos();
                let direction = [sin * cos_turn, sin * sin_turn, cos];
                sum += area * weight(direction) * self.radiance(direction);
            }
        }
        sum
    }
}

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    [sin * cos_phi, sin * sin_phi, cos]
}

/// Mean radiance in a round field about a direction, by a fine spiral.
fn mean(of: Orientation, theta: f64, phi: f64, half: f64) -> f64 {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    let (out, side) = ([cos * cos_phi, cos * sin_phi, -sin], [-sin_phi, cos_phi, 0.0]);
    let axis = direction(theta, phi);
    let count = 200_000;
    let sum: f64 = (0..count)
        .map(|k| {
            let along = (f64::from(k) + 0.5) / f64::from(count);
            let angle = 2.0 * (along.sqrt() * (0.5 * half.to_radians()).sin()).asin();
            let (s, c) = (TAU * (f64::from(k) * 0.618_033_988_749_894_9).fract()).sin_cos();
            of.radiance(std::array::from_fn(|i| {
                angle.cos() * axis[i] + angle.sin() * (c * out[i] + s * side[i])
            }))
        })
        .sum();
    sum / f64::from(count)
}

const HALF_A_COLUMN: f64 = 180.0 / COLUMNS as f64;
const ORIENTATIONS: [Orientation; 6] = [
    Orientation { rotate: 0.0, tilt: 0.0 },
    Orientation { rotate: HALF_A_COLUMN, tilt: 0.0 },
    Orientation { rotate: 123.4, tilt: 0.0 },
    Orientation { rotate: HALF_A_COLUMN, tilt: 25.0 },
    Orientation { rotate: -77.7, tilt: 90.0 },
    Orientation { rotate: 3.21, tilt: 140.0 },
];

fn keys(of: Orientation) -> String {
    format!(
        "[[lighting.environment]]\nmodel = \"map\"\nfile = \"map.hdr\"\nrotate_deg = {}\ntilt_deg = {}\nshare = 1\n",
        of.rotate, of.tilt
    )
}

/// A mirror shows the mean of the map's pixels over the field of view, whatever the map is turned by.
#[test]
fn mirror_shows_the_pixels_of_a_map_in_any_orientation() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.hdr"), picture()).unwrap();
    let mirror = display("mirror");
    for k in everyday(4, [0, 1, 3, 4, 2, 5]) {
        let of = ORIENTATIONS[k];
        let irradiance = of.sum(|_| 1.0);
        let views = [([8.0, 3.0], 0.0), ([8.0, 77.0], 0.2), ([41.3, -130.0], 3.0), ([2.0, 15.0], 12.0)];
        // Two views each, every day one: a tilted map takes a while.
        for (view, field) in everyday(1, [views[k % 4], views[(k + 1) % 4]]) {
            let seen = if field == 0.0 {
                of.radiance(direction(view[0], view[1] + 180.0))
            } else {
                mean(of, view[0], view[1] + 180.0, 0.5 * field)
            };
            let truth = PIXEL * PI * seen / irradiance;
            let white = |solver: &str| {
                let result = run_in(&text_seen(&mirror, &keys(of), solver, (view, field)), folder.path());
                let white = result.views[0].states.get("white").unwrap();
                (white.value.Y, white.standard_error.Y)
            };
            let adding = white("relative_error = 1e-4").0;
            // The sums of this test are accurate to about 3e-4.
            assert!((adding / truth - 1.0).abs() < 1e-3, "{of:?} {view:?} {field}: {adding} {truth}");
            let (walk, error) = white("method = \"monte-carlo\"\npaths = 8192");
            let off = (walk - truth).abs();
            assert!(off < 4.5 * error + 1e-3 * truth, "{of:?} {view:?} {field}: {walk}({error}) {truth}");
        }
    }
}

/// A lobe that is narrower than a pixel, or as wide, gathers the light of the pixels.
#[test]
fn lobe_gathers_the_light_of_a_map_in_any_orientation() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.hdr"), picture()).unwrap();
    let (through, view) = (0.9, [8.0, 77.0]);
    for (width, orientations) in [(0.02, [3, 1]), (0.06, [2, 4])] {
        let panel = format!(
            "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = {width}\ntransmittance = {through}\n[display.glass]\nindex = 4\n\
             [display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = {{ white = {PIXEL}, black = 0.05 }}\n"
        );
        let peak = direction(view[0], view[1] + 180.0);
        // Two passes of the lobe equal one of twice the width; the light outside the disc of the glass is
        // some 1e-4.
        let lobe = |[x, y, _]: [f64; 3]| {
            let wide = 2.0 * width;
            wide / (TAU * (wide * wide + (x - peak[0]).powi(2) + (y - peak[1]).powi(2)).powf(1.5))
        };
        for of in everyday(1, orientations).map(|k| ORIENTATIONS[k]) {
            let truth = PI * through * through * PIXEL * of.sum(lobe) / of.sum(|_| 1.0);
            let white = |solver: &str| {
                let result = run_in(&text_seen(&panel, &keys(of), solver, (view, 0.0)), folder.path());
                let white = result.views[0].states.get("white").unwrap();
                (white.value.Y, white.standard_error.Y)
            };
            let adding = white("relative_error = 1e-4").0;
            assert!((adding / truth - 1.0).abs() < 1e-3, "{of:?} {width}: {adding} {truth}");
            let (walk, error) = white("method = \"monte-carlo\"\npaths = 8192");
            assert!(
                (walk - truth).abs() < 4.5 * error + 1e-3 * truth,
                "{of:?} {width}: {walk}({error}) {truth}"
            );
        }
    }
}
