//! Audits and kernels of files whose integrals are known in closed form.

use std::f64::consts::PI;

use papilio_formats::{AuditFile, BsdfFormat, WriteError, audit_text, write_measurement};
use papilio_goniometry::{
    Audit, Channel, Geometry, KLEMS_FULL, MeasuredPart, Measurement, Preparation, ScatterMode, SpecularGrid,
    calibrated, kernel,
};

use super::samples::{singles, tensors};
use super::{read, refused, written};

/// A table about the specular direction.
struct SpecularTable<'a> {
    rotations: &'a [f64],
    incidences: &'a [f64],
    azimuths: Vec<f64>,
    radials: Vec<f64>,
    symmetry: &'a str,
}

impl SpecularTable<'_> {
    fn text(&self, tis: impl Fn(f64, f64) -> f64, f: impl Fn([f64; 4]) -> f64) -> String {
        let axis = |name: &str, angles: &[f64]| {
            let all: Vec<String> = angles.iter().map(f64::to_string).collect();
            format!("{name}  {}\n{}\n", angles.len(), all.join("\t"))
        };
        let mut text = format!(
            "Source  Measured\nSymmetry  {}\nSpectralContent  Monochrome\nScatterType  BTDF\n{}{}{}{}\nMonochrome\nDataBegin\n",
            self.symmetry,
            axis("SampleRotation", self.rotations),
            axis("AngleOfIncidence", self.incidences),
            axis("ScatterAzimuth", &self.azimuths),
            axis("ScatterRadial", &self.radials)
        );
        for w in self.rotations {
            for i in self.incidences {
                text += &format!("TIS {}\n", tis(*w, *i));
                for a in &self.azimuths {
                    let row: Vec<String> = self
                        .radials
                        .iter()
                        .map(|r| match SpecularGrid::direction(*i, *a, *r) {
                            Some(_) => f([*w, *i, *a, *r]).to_string(),
                            None => "0".to_owned(),
                        })
                        .collect();
                    text += &(row.join("\t") + "\n");
                }
            }
        }
        text + "DataEnd\n"
    }
}

fn steps(to: u32, step: u32) -> Vec<f64> {
    (0..=to / step).map(|k| f64::from(k * step)).collect()
}

/// f = 0.3/pi, measured only up to 40 deg from the specular direction.
fn flat40() -> Measurement {
    let made = SpecularTable {
        rotations: &[0.0],
        incidences: &[0.0, 20.0, 40.0, 60.0, 80.0],
        azimuths: steps(180, 10),
        radials: steps(40, 2),
        symmetry: "PlaneSymmetrical",
    };
    read(made.text(|_, _| 0.3, |_| 0.3 / PI))
}

/// Integral of the cosine over the part of a cap of 40 deg that lies in the hemisphere, divided by pi: by
/// quadrature about the centre of the cap.
fn cap(incidence_deg: f64) -> f64 {
    let (sin, cos) = incidence_deg.to_radians().sin_cos();
    let (rings, around) = (800, 800);
    let (dr, da) = (40_f64.to_radians() / f64::from(rings), 2.0 * PI / f64::from(around));
    let mut sum = 0.0;
    for k in 0..rings {
        let (sin_r, cos_r) = ((f64::from(k) + 0.5) * dr).sin_cos();
        for j in 0..around {
            let z = cos_r * cos + sin_r * ((f64::from(j) + 0.5) * da).cos() * sin;
            sum += z.max(0.0) * sin_r * dr * da;
        }
    }
    sum / PI
}

/// Nothing is extrapolated without a key for it. Where the cap lies in the hemisphere, its integral is sin^2
/// 40 cos(i).
#[test]
fn light_beyond_the_last_measured_angle_is_reported_but_not_included() {
    let measurement = flat40();
    let audit = Audit::of(&measurement.parts[0], 0).unwrap();
    for found in &audit.incidences {
        let known = 0.3 * cap(found.theta_deg);
        if found.theta_deg <= 50.0 {
            let closed = 0.3 * 40_f64.to_radians().sin().powi(2) * found.theta_deg.to_radians().cos();
            assert!((known - closed).abs() < 1e-6, "{known} {closed}");
        }
        assert!((found.integral - known).abs() < 1e-3 * known, "{found:?} {known}");
        assert!((found.integral_beyond - 0.3).abs() < 3e-4, "{found:?}");
        assert!((found.beyond_share() - (1.0 - known / 0.3)).abs() < 2e-3, "{found:?}");
        assert_eq!(found.measured_to_deg, Some(40.0));
    }
    let text = audit_text("flat40.bsdf", &measurement, &[Some(audit)]);
    for words in
        ["0.1240", "58.7 %", "ends 40 deg from the specular direction", "unless `extrapolate = \"none\"`"]
    {
        assert!(text.contains(words), "{words}\n{text}");
    }
}

/// A display omits this light or, on request, includes it and reports its fraction.
#[test]
fn kernel_extrapolates_only_on_request() {
    let part = &flat40().parts[0];
    let [none, hold] = [None, Some(1.0)].map(|extrapolate| {
        kernel(part, 0, &Preparation { extrapolate, ..Preparation::default() }, &[]).unwrap()
    });
    for (k, theta) in [0.0_f64, 20.0, 40.0, 60.0, 80.0].into_iter().enumerate() {
        let beta = theta.to_radians().sin();
        let known = 0.3 * cap(theta);
        // The end of the lobe is between nodes, so that its totals are smooth in the incidence only to some
        // thousandths.
        let total = none.0.albedo_at(beta);
        assert!((total - known).abs() < 5e-3 * known, "{theta}: {total} {known}");
        assert!((hold.0.albedo_at(beta) - 0.3).abs() < 1e-3, "{theta}: {}", hold.0.albedo_at(beta));
        for changes in [&none.1, &hold.1] {
            let [at, fraction] = changes.beyond[k];
            assert!(at == theta && (fraction - (1.0 - known / 0.3)).abs() < 2e-3, "{changes:?}");
        }
    }
    assert_eq!((none.1.tails, hold.1.tails, none.1.measured_to_deg), (false, true, Some(40.0)));
}

/// A file that extends to the horizon in all directions has no light beyond it.
#[test]
fn complete_hemisphere_has_no_light_beyond() {
    let made = SpecularTable {
        rotations: &[0.0],
        incidences: &[0.0, 50.0],
        azimuths: steps(180, 30),
        radials: steps(180, 10),
        symmetry: "PlaneSymmetrical",
    };
    let measurement = read(made.text(|_, _| 0.3, |_| 0.3 / PI));
    let audit = Audit::of(&measurement.parts[0], 0).unwrap();
    assert!(audit.incidences.iter().all(|i| i.measured_to_deg.is_none() && i.beyond_share() == 0.0));
    assert!(
        !audit_text("x", &measurement, &[Some(audit)]).contains("from the specular direction, at incidence")
    );
}

/// Lambertian lobes whose reflectance varies with the rotation of the sample, with the mean 0.3 over a full
/// turn, whose first and last rotation are the same; the instrument reports twice the integral as TIS.
fn rotated() -> Measurement {
    let made = SpecularTable {
        rotations: &[0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0, 360.0],
        incidences: &[0.0, 30.0, 60.0],
        azimuths: (0..12).map(|k| f64::from(30 * k)).collect(),
        radials: steps(180, 6),
        symmetry: "Asymmetrical4D",
    };
    read(made.text(|w, _| 2.0 * level(w), |[w, ..]| level(w) / PI))
}

fn level(rotation_deg: f64) -> f64 {
    0.3 - 0.2 * (2.0 * rotation_deg.to_radians()).cos()
}

/// The mean integral is compared with the mean TIS, and each rotation with its own.
#[test]
fn each_rotation_is_compared_with_its_own_tis() {
    let measurement = rotated();
    let audit = Audit::of(&measurement.parts[0], 0).unwrap();
    for found in &audit.incidences {
        assert!((found.tis.unwrap() - 0.6).abs() < 1e-12, "{found:?}");
        assert!((found.integral - 0.3).abs() < 3e-4, "{found:?}");
    }
    assert_eq!(audit.rotations.len(), 9 * 3);
    for found in &audit.rotations {
        assert!((found.tis.unwrap() - 2.0 * level(found.rotation_deg)).abs() < 1e-12, "{found:?}");
        assert!((found.integral / level(found.rotation_deg) - 1.0).abs() < 1e-3, "{found:?}");
    }
    let text = audit_text("x", &measurement, &[Some(audit)]);
    assert!(text.contains("means over the rotations") && text.contains("30 deg: 0.500"), "{text}");
    let to_tis = Preparation { to_tis: true, ..Preparation::default() };
    let (scatter, _) = kernel(&measurement.parts[0], 0, &to_tis, &[]).unwrap();
    for theta in [0.0_f64, 30.0, 60.0] {
        let total = scatter.albedo_at(theta.to_radians().sin());
        assert!((total - 0.6).abs() < 1e-3, "{theta}: {total}");
    }
}

#[test]
fn rotated_table_written_as_csv_reads_back() {
    let measurement = rotated();
    let (bytes, _) = written(BsdfFormat::Csv, &measurement);
    let again = read(bytes);
    let [before, after] = [&measurement, &again].map(|read| Audit::of(&read.parts[0], 0).unwrap());
    // 360 deg equals 0 deg and is listed once.
    assert_eq!(before.rotations.len(), after.rotations.len() + 3);
    for (before, after) in before.rotations.iter().zip(&after.rotations) {
        assert!((before.rotation_deg - after.rotation_deg).abs() < 1e-6);
        assert!((before.integral - after.integral).abs() < 1e-6, "{before:?} {after:?}");
    }
    for (before, after) in before.incidences.iter().zip(&after.incidences) {
        assert!((before.integral - after.integral).abs() < 1e-6, "{before:?} {after:?}");
    }
}

/// The integral is the sum of value x projected solid angle, pi (cos^2 t0 - cos^2 t1)/n, computed
/// independently.
#[test]
fn integral_of_patches_is_their_weighted_sum() {
    let bounds = [0.0, 5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 90.0];
    let counts = [1, 8, 16, 20, 24, 24, 24, 16, 12];
    let omega: Vec<f64> = (0..9)
        .flat_map(|k| {
            let [c0, c1] = [bounds[k], bounds[k + 1]].map(|deg: f64| deg.to_radians().cos().powi(2));
            vec![PI * (c0 - c1) / f64::from(counts[k]); counts[k] as usize]
        })
        .collect();
    // A glass that transmits most light regularly and scatters the rest.
    let value =
        |i: usize, o: usize| if i == o { 0.8 / omega[o] } else { 0.01 + 0.02 * ((i * 7 + o) % 5) as f64 };
    let values: Vec<f64> = (0..145).flat_map(|i| (0..145).map(move |o| value(i, o))).collect();
    let rings = KLEMS_FULL.to_vec();
    let part = MeasuredPart {
        way: ScatterMode::FrontTransmission,
        channels: vec![Channel::Monochrome],
        geometry: Geometry::Patches { incoming: rings.clone(), outgoing: rings },
        values: values.clone(),
        tis: Vec::new(),
    };
    let mut measurement = rotated();
    measurement.parts = vec![part];
    let audit = Audit::of(&read(written(BsdfFormat::Klems, &measurement).0).parts[0], 0).unwrap();
    let mut first = 0;
    for (found, count) in audit.incidences.iter().zip(counts) {
        let count = count as usize;
        let sum = |i: usize| (0..145).map(|o| values[i * 145 + o] * omega[o]).sum::<f64>();
        let mean = (first..first + count).map(sum).sum::<f64>() / count as f64;
        assert!((found.integral / mean - 1.0).abs() < 1e-12, "{found:?} {mean}");
        assert_eq!((found.integral_filled, found.grid_error), (found.integral, Some(0.0)));
        let regular = 0.8 / omega[first];
        assert!((found.peak.unwrap() / regular - 1.0).abs() < 1e-12, "{found:?}");
        first += count;
    }
    assert_eq!(audit.incidences.len(), 9);
}

/// 1 on one side of the plane of incidence, 0.1 on the other: the mean is 0.9/ln 10 with logarithmic
/// interpolation, 0.55 with linear.
#[test]
fn coarse_azimuth_grid_is_a_warning() {
    let made = SpecularTable {
        rotations: &[0.0],
        incidences: &[0.0, 30.0],
        azimuths: vec![0.0, 180.0],
        radials: steps(180, 5),
        symmetry: "PlaneSymmetrical",
    };
    let measurement = read(made.text(|_, _| 0.1, |[_, _, a, _]| if a < 90.0 { 0.1 } else { 0.01 }));
    let audit = Audit::of(&measurement.parts[0], 0).unwrap();
    let off = 0.55 * 10_f64.ln() / 0.9 - 1.0;
    let found = audit.incidences[0];
    assert!(
        (found.azimuth_error.unwrap() - off).abs() < 2e-3 && found.grid_error >= found.azimuth_error,
        "{found:?} {off}"
    );
    let text = audit_text("x", &measurement, &[Some(audit.clone())]);
    assert!(text.contains("azimuth grid is too coarse"), "{text}");
    // JSON has the warnings of the text.
    let file = AuditFile::new(&measurement, &[(&measurement.parts[0], vec![audit])], [&[], &[]]);
    let json = serde_json::to_value(&file).unwrap();
    let of_json = json["parts"][0]["channels"][0]["warnings"].as_array().unwrap();
    let of_json: Vec<&str> = of_json.iter().filter_map(|warning| warning.as_str()).collect();
    let of_text: Vec<&str> = text.lines().filter_map(|line| line.trim().strip_prefix("warning: ")).collect();
    assert!(of_json == of_text && !of_text.is_empty(), "{of_json:?} {of_text:?}");
}

/// A ring at 40 deg with the integral 0.3 pi sin² 40 deg, if its value is that of all directions within.
#[test]
fn ring_of_a_single_inclination_is_warned_of() {
    let text = |thetas: &[u32]| {
        let pairs = thetas.iter().flat_map(|theta| [0, 90, 180].map(|phi| (theta, phi)));
        let rows: String = pairs.map(|(theta, phi)| format!("0,0,{theta},{phi},0.3\n")).collect();
        let measurement = read(format!("theta_i,phi_i,theta_o,phi_o,brdf\n{rows}"));
        audit_text("x", &measurement, &[Audit::of(&measurement.parts[0], 0)])
    };
    let warned = |thetas: &[u32]| text(thetas).contains("the smallest inclination of the viewer is");
    assert!(warned(&[40]) && warned(&[40, 50, 60]) && text(&[40]).contains("is 40 deg"));
    assert!(!warned(&[0, 20, 40]) && !warned(&[2, 5, 8]));
}

/// Azimuths may be signed or not; a warning reports azimuths that do not cover the full circle.
#[test]
fn azimuths_of_either_sign_give_the_same_audit() {
    let audit = |azimuths: &[f64]| {
        let made = SpecularTable {
            rotations: &[0.0],
            incidences: &[0.0, 30.0],
            azimuths: azimuths.to_vec(),
            radials: steps(180, 10),
            symmetry: "Asymmetrical",
        };
        let lopsided = |a: f64| 0.1 + 0.05 * a.to_radians().cos() + 0.02 * a.to_radians().sin();
        let measurement = read(made.text(|_, _| 0.3, |[_, _, a, _]| lopsided(a)));
        let audit = Audit::of(&measurement.parts[0], 0).unwrap();
        (audit.clone(), audit_text("x", &measurement, &[Some(audit)]))
    };
    let around: Vec<f64> = (0..12).map(|k| f64::from(30 * k)).collect();
    let signed: Vec<f64> = (-5..=6).map(|k| f64::from(30 * k)).collect();
    let [(around, text), (signed, _)] = [&around, &signed].map(|azimuths| audit(azimuths));
    for (a, b) in around.incidences.iter().zip(&signed.incidences) {
        assert!((a.integral - b.integral).abs() < 1e-12, "{a:?} {b:?}");
    }
    // The mean over the full circle is 0.1, regardless of the asymmetry.
    assert!((around.incidences[0].integral - 0.1 * PI).abs() < 0.01 * 0.1 * PI, "{:?}", around.incidences[0]);
    assert!(around.held_azimuths_deg.is_none() && !text.contains("azimuths are"), "{text}");
    let (one_side, text) = audit(&[200.0, 300.0]);
    assert_eq!(one_side.held_azimuths_deg.map(|ends| ends.map(f64::round)), Some([60.0, 160.0]));
    assert!(text.contains("azimuths are 60 to 160 deg"), "{text}");
}

/// A white with a reflectance factor of 0.8, as an RGL table on a regular grid of half vectors that extends
/// beyond the horizon.
#[test]
fn rgl_table_of_a_white_has_its_reflectance() {
    let (size, lights) = (64, 19);
    let mut values = Vec::new();
    for k in 0..lights {
        let (sin, cos) = (f64::from(5 * k)).to_radians().sin_cos();
        for row in 0..size {
            let phi = (f64::from(row) / f64::from(size - 1) - 0.5) * 2.0 * PI;
            for column in 0..size {
                let theta = (f64::from(column) / f64::from(size - 1)).powi(2) * 0.5 * PI;
                // The viewer is the light from azimuth 0, mirrored at the half vector.
                let m = [theta.sin() * phi.cos(), theta.cos()];
                let z = 2.0 * (m[0] * sin + m[1] * cos) * m[1] - cos;
                values.push((0.8 / PI * z.max(0.0)) as f32);
            }
        }
    }
    let thetas: Vec<f32> = (0..lights).map(|k| (f64::from(5 * k)).to_radians() as f32).collect();
    let ones = |count: usize| singles(&vec![1.0; count]);
    let (n, lights) = (size as u64, lights as u64);
    let file = tensors(&[
        ("phi_i", 10, &[1], singles(&[0.0])),
        ("theta_i", 10, &[lights], singles(&thetas)),
        ("ndf", 10, &[2, 2], ones(4)),
        ("sigma", 10, &[2, 2], ones(4)),
        ("vndf", 10, &[1, lights, 2, 2], ones(4 * lights as usize)),
        ("wavelengths", 10, &[1], singles(&[550.0])),
        ("spectra", 10, &[1, lights, 1, n, n], singles(&values)),
        ("jacobian", 1, &[1], vec![0]),
    ]);
    let audit = Audit::of(&read(file).parts[0], 0).unwrap();
    for found in audit.incidences.iter().filter(|i| i.theta_deg <= 75.0) {
        assert!((found.integral / 0.8 - 1.0).abs() < 5e-3, "{found:?}");
    }
    // Between the nodes of this grid, the error of f cos is up to 1e-3 of its largest value: a third of f
    // where the cosine is 0.1.
    let [rms, worst] = audit.reciprocity.unwrap();
    assert!(rms < 0.05 && worst < 0.4, "{rms} {worst}");
}

/// Values whose sums would overflow are refused.
#[test]
fn value_above_the_limit_is_refused_with_its_place() {
    assert_eq!(refused("theta_i,phi_i,theta_o,phi_o,value\n0,0,0,0,0.3\n0,0,30,0,1e300\n").0, Some((3, 10)));
    let (place, problem) = refused(super::samples::RADIANT.replace(".25", "1e300"));
    assert_eq!(place, Some((24, 3)));
    assert!(problem.to_string().contains("a value of the BSDF"), "{problem}");
    assert_eq!(refused(super::samples::RADIANT.replace("TIS 0.4", "TIS 1e300")).0, Some((22, 5)));
}

/// A nearly dark reference leads to values that the readers would refuse: they are not written.
#[test]
fn value_that_readers_refuse_is_not_written() {
    let sample = rotated();
    let mut dark = sample.clone();
    dark.parts[0].values[5] = 1e-300;
    let calibrated = calibrated(&sample, &dark, 0.99).unwrap().measurement;
    for format in [BsdfFormat::Papilio, BsdfFormat::Radiant, BsdfFormat::Csv, BsdfFormat::Klems] {
        let mut bytes = Vec::new();
        let error = write_measurement(&mut bytes, format, &calibrated).unwrap_err();
        assert!(matches!(error, WriteError::Number { .. }), "{error}");
        assert!(bytes.is_empty() && error.to_string().contains("front transmission"), "{error}");
    }
}

/// A scan at normal incidence of f(theta), in steps of 0.25 deg to 10 deg and of 1 deg beyond; "null" in JSON
/// is `None`.
fn clarity_of(f: impl Fn(f64) -> f64) -> (Option<f64>, String) {
    let angles = (0..40).map(|k| 0.25 * f64::from(k)).chain((10..=90).map(f64::from));
    let rows: Vec<String> = angles.map(|theta| format!("{theta},{}", f(theta))).collect();
    let measurement = read(format!("theta_deg,btdf\n{}\n", rows.join("\n")));
    let audit = Audit::of(&measurement.parts[0], 0).unwrap();
    let text = audit_text("x", &measurement, &[Some(audit.clone())]);
    let file = AuditFile::new(&measurement, &[(&measurement.parts[0], vec![audit])], [&[], &[]]);
    let json = serde_json::to_value(&file).unwrap();
    let channel = json["parts"][0]["channels"][0].as_object().unwrap();
    assert!(channel.contains_key("clarity") && channel["grid_error"].is_number());
    (channel["clarity"].as_f64(), text)
}

/// Gaussian lobes of beta: the light within a radius b is 1 - exp(-b²/w²). Where the ring has more light than
/// the disc, and where neither has any, there is no clarity: null in JSON, and its reason in the text.
#[test]
fn clarity_is_a_number_or_null() {
    let beta = |degrees: f64| degrees.to_radians().sin();
    for width_deg in [0.9, 1.6] {
        let lobe = |theta: f64| (-(beta(theta) / beta(width_deg)).powi(2)).exp();
        let [disc, both] = [1.0, 2.5].map(|edge| 1.0 - lobe(edge));
        let expected = (2.0 * disc - both) / both;
        let (found, text) = clarity_of(lobe);
        if expected < 0.0 {
            assert!(
                found.is_none() && text.contains("clarity: none, because more light"),
                "{found:?} {text}"
            );
        } else {
            let found = found.unwrap();
            assert!((found - expected).abs() < 5e-3 && text.contains("clarity "), "{found} {expected}");
        }
    }
    let (found, text) = clarity_of(|theta| if theta < 5.0 { 0.0 } else { 0.3 });
    assert!(found.is_none() && text.contains("clarity: not measured"), "{found:?} {text}");
}

/// What the grid of listed pairs leaves uncertain is not known, and no number is stated for it.
#[test]
fn grid_error_of_listed_pairs_is_not_known() {
    let mut dice = papilio_testing::Dice::new(0x9a15, 0);
    let row = |_| {
        let [i, o] = [0, 1].map(|_| dice.between(0.0, 75.0));
        format!("{i:.3},0,{o:.3},{:.3},0.25", dice.between(0.0, 180.0))
    };
    let rows: Vec<String> = (0..200).map(row).collect();
    let measurement = read(format!("theta_i,phi_i,theta_o,phi_o,brdf\n{}\n", rows.join("\n")));
    let part = &measurement.parts[0];
    assert!(matches!(part.geometry, Geometry::Pairs(_)));
    let audit = Audit::of(part, 0).unwrap();
    assert_eq!(audit.grid_error(), None);
    let text = audit_text("x", &measurement, &[Some(audit.clone())]);
    assert!(text.contains("not known") && text.contains("half-widths (deg)"), "{text}");
    let file = AuditFile::new(&measurement, &[(part, vec![audit])], [&[], &[]]);
    let json = serde_json::to_value(&file).unwrap();
    let channel = &json["parts"][0]["channels"][0];
    assert!(channel["grid_error"].is_null() && channel["pairs"]["one_left_out"]["rms"].is_number());
    for one in channel["incidences"].as_array().unwrap() {
        assert!(one["grid_error"].is_null() && one["azimuth_error"].is_null(), "{one}");
    }
    let (_, changes) = kernel(part, 0, &Preparation::default(), &[]).unwrap();
    assert_eq!((changes.grid_error, changes.azimuth_error), (None, None));
}
