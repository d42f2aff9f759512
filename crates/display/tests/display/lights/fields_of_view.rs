//! Tests of fields of view, rotations and the front light, by the quadrature of `third_road`.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

use super::formulas::*;
use super::run_in;
use super::third_road::{INDEX, PIXEL, display, entering, folder, text, text_seen, truth};

/// A mirror image over a field of view is the mean of the formula, with a sun or an edge in the field.
#[test]
fn mirror_image_is_the_mean_over_the_field_of_view() {
    let folder = folder();
    let mut lights = vec![
        sky("a sun in view", 13, (69.0, 186.0), 0.0, 0.0),
        sky("a horizon in view", 15, (30.0, 40.0), 86.0, 0.3),
    ];
    lights.push(cap("an edge in view", (30.0, 190.0), [0.0, 9.5]));
    for light in lights {
        let whole = light.mean(|_| 0.0).1;
        let half = 2.0_f64;
        // Coordinates about the sun, or about the view itself.
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
                // Azimuths of the horizon, from the upward direction in the frame of the image.
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
        let walk = run_in(&scenario("method = \"monte-carlo\"\npaths = 16384"), folder.path());
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

/// For paper under glass, the mean over a field of view near the horizon differs from the value at its
/// centre.
#[test]
fn field_of_view_near_the_horizon_is_the_mean_over_its_directions() {
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

/// The result does not change if the sky, its sun and the view rotate together.
#[test]
fn common_rotation_of_light_and_view_has_no_effect() {
    let display = "[[display.front]]\nreflectance = 0.02\nabsorptance = 0.01\n[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.08\n\
        transmittance = 0.9\nregular_fraction = 0.2\n[display.glass]\nindex = 1.5\n[display.pixel]\nmodel = \"uniform\"\n\
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

/// Front light alone over a lobe, by a profile (linear between angles) and by a luminaire's table (intensity
/// over the cosine).
#[test]
fn front_light_equals_the_quadrature_of_its_distribution() {
    let folder = folder();
    let lamp = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 3 1 2 0.6 0.6 0\n1 1 36\n0 30 90\n0 90 180\n\
        100 150 0\n100 40 0\n100 80 0\n";
    std::fs::write(folder.path().join("guide.ies"), lamp).unwrap();
    let table = [[100.0, 150.0, 0.0], [100.0, 40.0, 0.0], [100.0, 80.0, 0.0]];
    let intensity = move |towards: Direction| {
        // Light travels towards the opposite azimuth.
        let turn = (-towards[1]).atan2(-towards[0]).to_degrees().abs() / 90.0;
        let theta = inclination(towards);
        let up = if theta < 30.0 { theta / 30.0 } else { 1.0 + (theta - 30.0) / 60.0 };
        let (h, v) = ((turn as usize).min(1), (up as usize).min(1));
        let (around, along) = (turn - h as f64, up - v as f64);
        let on = |h: usize| table[h][v] * (1.0 - along) + table[h][v + 1] * along;
        (on(h) * (1.0 - around) + on(h + 1) * around) / towards[2]
    };
    let guide = Light {
        name: "guide.ies",
        keys: String::new(),
        radiance: Box::new(intensity),
        points: boxes(ABOUT_NORMAL, &[0.0, 30.0, 90.0], &[-180.0, -90.0, 0.0, 90.0, 180.0]),
        has_image: false,
    };
    let profile = lights().into_iter().find(|light| light.name == "profile").unwrap();
    for (light, file) in [(profile, "profile.csv"), (guide, "guide.ies")] {
        let truth = 0.5 * truth("lobe", &light);
        let keys =
            format!("diffuse = 1\n[lighting.front_light]\nilluminance_lx = 50\ndistribution = \"{file}\"\n");
        let adding = run_in(&text(&display("lobe"), &keys, ""), folder.path());
        let white = adding.views[0].states.get("white").unwrap();
        let (seen, claimed) =
            (white.value.terms.front_light.unwrap(), white.discretisation_error.as_ref().unwrap().Y);
        assert!((seen - truth).abs() <= claimed + 1e-6 * truth, "{file}: {seen} {truth} {claimed:.1e}");
        let walk =
            run_in(&text(&display("lobe"), &keys, "method = \"monte-carlo\"\npaths = 16384"), folder.path());
        let white = walk.views[0].states.get("white").unwrap();
        let seen = white.value.terms.front_light.unwrap();
        assert!((seen - truth).abs() <= 4.5 * white.standard_error.Y, "{file}: {seen} {truth}");
    }
}
