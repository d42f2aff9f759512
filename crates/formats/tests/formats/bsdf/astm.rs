//! ASTM E1392.

use papilio_formats::{BsdfProblem, Problem};
use papilio_goniometry::{Channel, Direction, ScatterMode};

use super::samples::ASTM;
use super::{read, refused, refused_bsdf};

/// Angles are in radians, and inclinations beyond 90 deg are on the back: unscattered light from 30 deg at
/// azimuth 180 leaves at 150 deg, azimuth 0.
#[test]
fn astm_angles_are_radians_from_the_normal_of_the_front() {
    let measurement = read(ASTM);
    assert_eq!(
        (measurement.provenance.sample.as_str(), measurement.provenance.source.as_str()),
        ("film 7", "goniometer")
    );
    let [reflected, transmitted] = &measurement.parts[..] else { panic!("{measurement:?}") };
    assert_eq!(
        (reflected.way, transmitted.way),
        (ScatterMode::FrontReflection, ScatterMode::FrontTransmission)
    );
    assert_eq!(reflected.channels, [Channel::Red, Channel::Wavelength(550.0)]);
    let light = Direction::new(30.0, 180.0);
    assert_eq!(reflected.evaluate(0, light, light.specular()), Some(1.5));
    assert_eq!(transmitted.evaluate(1, light, light.specular()), Some(1e-3));
    let [i, o] = transmitted.geometry.directions(0).unwrap();
    assert!((i.theta_deg - 30.0).abs() < 1e-9 && (o.theta_deg - 30.0).abs() < 1e-9 && o.phi_deg == 0.0);
}

/// The order of keywords is free, up to the first row.
#[test]
fn astm_keywords_may_follow_the_line_vars() {
    let (head, rows) = ASTM.split_at(ASTM.find("0.52").unwrap());
    let mut lines: Vec<&str> = head.lines().collect();
    lines.rotate_right(1);
    let turned = format!("{}\n{rows}", lines.join("\n"));
    assert!(turned.starts_with("VARS"));
    assert_eq!(read(&turned[..]).parts, read(ASTM).parts);
    let wrong = turned.replace("NUM_POINTS 3", "NUM_POINTS 4");
    assert_eq!(
        refused_bsdf(&wrong[..]),
        (Some((4, 12)), BsdfProblem::Count { what: "rows", found: 3, count: 4 })
    );
    let twice = turned.replace("SAMPLE film 7", lines[0]);
    assert!(matches!(refused_bsdf(&twice[..]), (Some((2, 1)), BsdfProblem::Twice { .. })));
    // A number with a typing error is no keyword.
    assert!(matches!(
        refused(ASTM.replacen("0.5235987755982988", "O.5", 1)),
        (Some((5, 1)), Problem::NotANumber { .. })
    ));
}

#[test]
fn malformed_astm_file_is_an_error_with_its_place() {
    let with = |from: &str, to: &str| ASTM.replacen(from, to, 1);
    assert_eq!(refused(with("1.5,2", "1.5,-2")).0, Some((5, 63)));
    assert_eq!(refused(with("1.5,2", "1.5,nan")).0, Some((5, 63)));
    assert!(matches!(refused(with("1.5,2", "1.5")), (Some((5, 1)), Problem::Columns { found: 5, .. })));
    assert!(matches!(
        refused(with("0,0,0,0,7,8", "0,0,30,0,7,8")),
        (Some((7, 5)), Problem::OutOfRange { .. })
    ));
    assert!(matches!(refused_bsdf(with("R,550nm", "R,R")), (Some((4, 36)), BsdfProblem::Twice { .. })));
    assert!(matches!(
        refused_bsdf(with("R,550nm", "R,watts")),
        (Some((4, 36)), BsdfProblem::Unexpected { .. })
    ));
    let cut = &ASTM[..ASTM.find("0,0,0,0").unwrap()];
    assert_eq!(refused_bsdf(cut), (Some((3, 12)), BsdfProblem::Count { what: "rows", found: 2, count: 3 }));
}
