//! Half circles of azimuths on any side of the plane of incidence, and angles that were rounded in radians.

use std::f64::consts::PI;
use std::fmt::Write;

use papilio_formats::{BsdfProblem, read_bsdf_file};
use papilio_goniometry::{Audit, ScatterMode};
use papilio_testing::everyday;

use super::{file, refused_bsdf};

/// Width of the lobe, direction cosines.
const WIDTH: f64 = 0.1;

fn direction(theta: f64, phi: f64) -> [f64; 2] {
    let (theta, phi) = (theta.to_radians(), phi.to_radians());
    [theta.sin() * phi.cos(), theta.sin() * phi.sin()]
}

/// The lobe for light from `phi_i`.
fn lobe(theta_i: f64, phi_i: f64, theta_o: f64, phi_o: f64) -> f64 {
    let ([x, y], [x0, y0]) = (direction(theta_o, phi_o), direction(theta_i, phi_i + 180.0));
    let squared = (x - x0).powi(2) + (y - y0).powi(2);
    (WIDTH * WIDTH / (WIDTH * WIDTH + squared)).powf(1.5)
}

/// The integral of the lobe over the hemisphere: in closed form along each ray from its peak to the edge of the
/// disc of direction cosines, and by the midpoint rule over the azimuths of the rays.
fn integral(theta_i: f64) -> f64 {
    const STEPS: i32 = 400;
    let peak = theta_i.to_radians().sin();
    let along = |k: i32| {
        let (sin, cos) = (2.0 * PI * (f64::from(k) + 0.5) / f64::from(STEPS)).sin_cos();
        let length = (1.0 - (peak * sin).powi(2)).sqrt() - peak * cos;
        1.0 - WIDTH / WIDTH.hypot(length)
    };
    2.0 * PI * WIDTH * WIDTH * (0..STEPS).map(along).sum::<f64>() / f64::from(STEPS)
}

/// The rows of a grid, each as four angles and the value.
fn rows(phi_i: f64, phis: &[f64]) -> Vec<([f64; 4], f64)> {
    let mut rows = Vec::new();
    for theta_i in [0.0, 20.0, 40.0, 60.0] {
        for theta_o in (0..=90).step_by(3).map(f64::from) {
            for phi_o in phis {
                rows.push(([theta_i, phi_i, theta_o, *phi_o], lobe(theta_i, phi_i, theta_o, *phi_o)));
            }
        }
    }
    rows
}

fn csv(phi_i: f64, phis: &[f64]) -> String {
    let mut text = "theta_i,phi_i,theta_o,phi_o,btdf\n".to_owned();
    for ([theta_i, phi_i, theta_o, phi_o], value) in rows(phi_i, phis) {
        let _ = writeln!(text, "{theta_i},{phi_i},{theta_o},{phi_o},{value:.7}");
    }
    text
}

fn steps(from: i32, to: i32) -> Vec<f64> {
    (from..=to).step_by(5).map(f64::from).collect()
}

/// Returns the totals of a file at each incidence.
fn totals(text: &str) -> Vec<(f64, f64)> {
    let read = read_bsdf_file(&file(text), Some(ScatterMode::FrontTransmission)).unwrap();
    let audit = Audit::of(&read.measurement.parts[0], 0).unwrap();
    audit.incidences.iter().map(|incidence| (incidence.theta_deg, incidence.integral)).collect()
}

#[track_caller]
fn assert_totals(text: &str, what: &str) {
    let found = totals(text);
    let incidences: Vec<f64> = found.iter().map(|(theta, _)| *theta).collect();
    assert_eq!(incidences, [0.0, 20.0, 40.0, 60.0], "{what}");
    for (theta, total) in found {
        // Interpolation between azimuths that are 5 deg apart: 0.076 at 60 deg, where the lobe is 0.1 wide.
        let expected = integral(theta);
        assert!((total / expected - 1.0).abs() < 0.02, "{what}, {theta} deg: {total} {expected}");
    }
}

/// The same lobe on either half circle, on a whole one and turned, and with any count of the azimuths.
#[test]
fn half_circle_on_any_side_has_the_light_of_the_whole_one() {
    for (phi_i, from, to) in [
        (0.0, 0, 180),
        (180.0, 0, 180),
        (0.0, 180, 360),
        (0.0, -180, 0),
        (180.0, -180, 0),
        (180.0, 180, 360),
        (-180.0, 0, 180),
        (90.0, -90, 90),
        (90.0, 90, 270),
        (45.0, 45, 225),
        (180.0, 0, 355),
        (30.0, 0, 360),
        (180.0, -180, 180),
        (0.0, 0, 210),
    ] {
        assert_totals(&csv(phi_i, &steps(from, to)), &format!("phi_i {phi_i}, phi_o {from} to {to}"));
    }
}

#[test]
fn relative_azimuths_of_lists_may_be_negative() {
    let mut relative = "theta_i,theta_o,dphi,value\n".to_owned();
    for ([theta_i, _, theta_o, phi_o], value) in rows(0.0, &steps(-180, 0)) {
        let _ = writeln!(relative, "{theta_i},{theta_o},{phi_o},{value:.7}");
    }
    assert_totals(&relative, "dphi");
    let mut fred = "type bsdf_data\nformat angles=deg bsdf=value scale=1\n".to_owned();
    let mut last = f64::NAN;
    for ([theta_i, phi_i, theta_o, phi_o], value) in rows(180.0, &steps(0, 180)) {
        if theta_i != last {
            let _ = writeln!(fred, "{theta_i} {phi_i}");
            last = theta_i;
        }
        let _ = writeln!(fred, "{theta_o} {phi_o} {value:.7}");
    }
    assert_totals(&fred, "FRED");
}

/// An angle in radians with this many decimals, or (negative) significant digits.
fn radians(deg: f64, digits: i32) -> String {
    let rad = deg.to_radians();
    let count = digits.unsigned_abs() as usize;
    if digits > 0 { format!("{rad:.count$}") } else { format!("{rad:.*e}", count - 1) }
}

#[test]
fn rounded_radians_are_the_degrees_that_were_meant() {
    for (phi_i, from) in [(0.0, 0), (180.0, 0), (0.0, -180)] {
        for digits in everyday(3, [4, -5, 7, 3, 5, 6, 9, 12, -7]) {
            let mut astm = "ASTM E1392\nVARS theta_i,phi_i,theta_s,phi_s,BSDF\n".to_owned();
            let mut table = "theta_i (rad),phi_i (rad),theta_o (rad),phi_o (rad),btdf\n".to_owned();
            let mut fred = "type bsdf_data\nformat angles=rad bsdf=value scale=1\n".to_owned();
            let mut last = f64::NAN;
            for (angles, value) in rows(phi_i, &steps(from, from + 180)) {
                let [theta_i, phi_i, theta_o, phi_o] = angles.map(|deg| radians(deg, digits));
                let _ = writeln!(astm, "{theta_i},{phi_i},{theta_o},{phi_o},{value:.7}");
                let _ = writeln!(table, "{theta_i},{phi_i},{theta_o},{phi_o},{value:.7}");
                if angles[0] != last {
                    let _ = writeln!(fred, "{theta_i} {phi_i}");
                    last = angles[0];
                }
                let _ = writeln!(fred, "{theta_o} {phi_o} {value:.7}");
            }
            for (text, name) in [(astm, "ASTM"), (table, "CSV"), (fred, "FRED")] {
                assert_totals(&text, &format!("{name}, phi_i {phi_i}, from {from}, {digits} digits"));
            }
        }
    }
    // Radians that another program has converted to degrees.
    let degrees = csv(180.0, &steps(0, 180)).replace(",180,", ",180.0000015,").replace("20,", "20.0000028,");
    assert_totals(&degrees, "degrees");
}

/// A scan in radians with few decimals.
#[test]
fn rounded_radians_of_a_scan_are_degrees() {
    let mut text = "theta (rad),btdf\n".to_owned();
    for theta in (0..=90).step_by(3).map(f64::from) {
        let _ = writeln!(text, "{},{:.6}", radians(theta, 3), lobe(0.0, 0.0, theta, 0.0));
    }
    let total = totals(&text)[0].1;
    assert!((total / integral(0.0) - 1.0).abs() < 0.02, "{total}");
    let shape = 2.0 * PI * WIDTH * WIDTH;
    // An infinite plane would have all of it.
    assert!(total < shape && total > 0.8 * shape);
}

/// More than half a circle, and no whole one: both sides were measured at some azimuths. Their means are
/// taken with a note; sides that differ are refused.
#[test]
fn azimuths_on_both_sides_are_averaged_with_a_note() {
    let table = |tilt: f64| {
        let mut text = "theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,bsdf\n".to_owned();
        for theta in (0..=90).step_by(15) {
            for phi in (0..=210).step_by(15) {
                let value = if phi > 180 { 1.0 + tilt } else { 1.0 };
                let _ = writeln!(text, "20,0,{theta},{phi},{value}");
            }
        }
        text
    };
    for (tilt, percent) in [(0.0, "0.0 %"), (0.1, "9.5 %")] {
        let read = read_bsdf_file(&file(table(tilt)), Some(ScatterMode::FrontReflection)).unwrap();
        let notes = read.notes.iter().filter(|note| note.contains("on both sides")).collect::<Vec<_>>();
        assert!(
            notes.len() == 1 && notes[0].contains("150 to 165 deg") && notes[0].contains(percent),
            "{notes:?}"
        );
        let part = &read.measurement.parts[0];
        assert!((part.values[10] - (1.0 + 0.5 * tilt)).abs() < 1e-12 && part.values[9] == 1.0);
    }
    let (_, problem) = refused_bsdf(table(0.5));
    let BsdfProblem::SidesDisagree(overlap) = problem else { panic!("{problem:?}") };
    assert!((overlap.difference - 0.4).abs() < 1e-12 && overlap.from_deg == 150.0, "{overlap:?}");
}

#[test]
fn part_of_a_circle_is_refused_with_its_azimuths() {
    for (phi_i, from, to) in [(90.0, 0, 180), (0.0, 0, 90), (180.0, -30, 30)] {
        let (_, problem) = refused_bsdf(csv(phi_i, &steps(from, to)));
        let [from_deg, to_deg] = [from, to].map(|phi| f64::from(phi) - phi_i);
        assert_eq!(problem, BsdfProblem::PartOfCircle { from_deg, to_deg, in_one_plane: true });
    }
    // Half a circle, with light from two planes: the half circle is that of one of them only.
    let two =
        |phis: &[f64]| [csv(0.0, phis), csv(45.0, phis).split_once('\n').unwrap().1.to_owned()].concat();
    let (_, problem) = refused_bsdf(two(&steps(0, 180)));
    assert_eq!(problem, BsdfProblem::PartOfCircle { from_deg: 0.0, to_deg: 180.0, in_one_plane: false });
    let whole = read_bsdf_file(&file(two(&steps(0, 355))), Some(ScatterMode::FrontTransmission));
    assert!(whole.is_ok(), "{:?}", whole.err());
}
