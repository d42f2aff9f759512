//! Formulas of all kinds of light, implemented independently, with quadratures over their directions.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Inclination and azimuth of the view.
pub(super) const VIEW: [f64; 2] = [20.0, 10.0];

/// Returns the direction that a mirror shows in this view.
pub(super) fn image() -> Direction {
    direction(-VIEW[0], VIEW[1])
}

/// Unit vector away from the display, with z along the normal.
pub(super) type Direction = [f64; 3];

pub(super) fn dot(a: Direction, b: Direction) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns the direction of an inclination and azimuth, degrees.
pub(super) fn direction(theta: f64, phi: f64) -> Direction {
    let ((s, c), (sp, cp)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    [s * cp, s * sp, c]
}

/// Double-exponential rule on an interval, which tolerates singularities at the ends.
pub(super) fn rule(from: f64, to: f64) -> Vec<(f64, f64)> {
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

/// Kind of light.
pub(super) struct Light {
    pub(super) name: &'static str,
    /// Keys of the scenario.
    pub(super) keys: String,
    pub(super) radiance: Box<dyn Fn(Direction) -> f64>,
    /// Lit directions, with their solid angles.
    pub(super) points: Vec<(Direction, f64)>,
    /// False for beams, whose mirror image has no luminance.
    pub(super) has_image: bool,
}

impl Light {
    /// Returns the mean of a function of direction, weighted by irradiance on the display, and the
    /// irradiance.
    pub(super) fn mean(&self, seen: impl Fn(Direction) -> f64) -> (f64, f64) {
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

/// Directions above the display in a box of angles from an axis and azimuths about it, degrees; boxes also
/// end at the mirror image of the view, where lobes have their peak.
pub(super) fn boxes(frame: [Direction; 3], angles: &[f64], turns: &[f64]) -> Vec<(Direction, f64)> {
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

pub(super) fn place(frame: [Direction; 3], angle: f64, turn: f64) -> Direction {
    let parts = [angle.sin() * turn.cos(), angle.sin() * turn.sin(), angle.cos()];
    std::array::from_fn(|i| (0..3).map(|k| parts[k] * frame[k][i]).sum())
}

pub(super) const ABOUT_NORMAL: [Direction; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Frame about the x axis: azimuth 0 is in the display along y, and the normal is at 90 deg.
pub(super) const ABOUT_X: [Direction; 3] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];

/// Returns a frame about this direction.
pub(super) fn about(axis: Direction) -> [Direction; 3] {
    let flat = axis[0].hypot(axis[1]);
    let side = [-axis[1] / flat, axis[0] / flat, 0.0];
    let out = [axis[2] * axis[0] / flat, axis[2] * axis[1] / flat, -flat];
    [out, side, axis]
}

/// CIE general sky by its groups of gradation and indicatrix (ISO 15469, table 1), above the horizon.
pub(super) fn cie_sky(number: usize, chi: f64, up: f64) -> f64 {
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

pub(super) fn apart(a: Direction, b: Direction) -> f64 {
    let chord = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    2.0 * (0.5 * chord).min(1.0).asin()
}

/// Converts a direction of the world, such as that of a sun, to the frame of a display that is tilted about
/// the x axis.
pub(super) fn tilted(world: Direction, tilt: f64) -> Direction {
    let (s, c) = tilt.to_radians().sin_cos();
    [world[0], c * world[1] + s * world[2], c * world[2] - s * world[1]]
}

pub(super) fn sky(
    name: &'static str,
    number: usize,
    (elevation, azimuth): (f64, f64),
    tilt: f64,
    ground: f64,
) -> Light {
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
    // Planes through the x axis are azimuths about it: display, sun and horizon.
    let mut turns = vec![0.0, sun[2].atan2(sun[1]).to_degrees(), 180.0 - tilt, 180.0];
    turns.sort_by(f64::total_cmp);
    turns.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let points = boxes(ABOUT_X, &[0.0, sun[0].acos().to_degrees(), 180.0], &turns);
    Light { name, keys, radiance: Box::new(radiance), points, has_image: true }
}

pub(super) fn directed(name: &'static str, theta: f64, radius: Option<f64>) -> Light {
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

pub(super) fn environment(keys: &str) -> String {
    format!("[[lighting.environment]]\nshare = 1\n{keys}")
}

/// Uniform light between two angles from an axis, down to the horizon.
pub(super) fn cap(name: &'static str, (theta, phi): (f64, f64), [from, to]: [f64; 2]) -> Light {
    let keys = environment(&format!(
        "model = \"cap\"\ntheta_deg = {theta}\nphi_deg = {phi}\nfrom_deg = {from}\nto_deg = {to}\n"
    ));
    let axis = direction(theta, phi);
    let mut points = Vec::new();
    if to == 180.0 {
        // The whole hemisphere minus the dark part.
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
    // Azimuth 0 about the axis is away from the normal; the display's plane removes arcs on that side.
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

pub(super) const ROWS: [(f64, f64); 4] = [(0.0, 1.0), (17.0, 4.0), (40.0, 3.0), (75.0, 0.5)];

pub(super) fn table(theta: f64) -> f64 {
    let of = |ends: &[(f64, f64)]| {
        let along = (theta - ends[0].0) / (ends[1].0 - ends[0].0);
        (0.0..=1.0).contains(&along).then_some(ends[0].1 + along * (ends[1].1 - ends[0].1))
    };
    ROWS.windows(2).find_map(of).unwrap_or(0.0)
}

pub(super) fn inclination(towards: Direction) -> f64 {
    towards[0].hypot(towards[1]).atan2(towards[2]).to_degrees()
}

/// Value of a pixel of the map, 16 by 8 pixels.
pub(super) fn pixel(row: usize, column: usize) -> u8 {
    [12, 200, 40, 90, 3, 131, 77][(row * row + 3 * column + row * column) % 7]
}

pub(super) fn lights() -> Vec<Light> {
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

/// Luminaire of 0.6 m by 0.6 m, viewed from 3 m at 25 deg from its nadir: a disc of the same solid angle.
pub(super) fn luminaire() -> Light {
    let axis = direction(25.0, 170.0);
    let radius = (0.36 * 25.0_f64.to_radians().cos() / PI).sqrt().atan2(3.0).to_degrees();
    let points = boxes(about(axis), &[0.0, radius], &[0.0, 360.0]);
    let radiance = move |towards| if apart(towards, axis).to_degrees() <= radius { 1.0 } else { 0.0 };
    Light { name: "", keys: String::new(), radiance: Box::new(radiance), points, has_image: true }
}
