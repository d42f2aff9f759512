//! Scans at normal incidence, lists of FRED, and listed pairs of directions.

use papilio_formats::{BsdfFormat, BsdfProblem, Problem, read_bsdf_file};
use papilio_goniometry::{Audit, Direction, Geometry, ScatterMode};

use super::samples::{FRED, SCAN};
use super::{file, read, refused, refused_bsdf, written};

/// A scan, read as `part`.
fn read_part(text: &str, part: Option<ScatterMode>) -> papilio_formats::BsdfFile {
    read_bsdf_file(&file(text), part).unwrap()
}

#[test]
fn scan_is_a_rotationally_symmetric_lobe_of_the_part_that_its_column_names() {
    let scan = read_part(SCAN, None);
    assert!(scan.states_part && scan.warnings.is_empty(), "{:?}", scan.warnings);
    assert!(scan.notes[0].contains("shift-invariant in direction cosines"), "{:?}", scan.notes);
    let part = &scan.measurement.parts[0];
    assert_eq!(
        (part.way, scan.measurement.provenance.sample.as_str()),
        (ScatterMode::FrontTransmission, "film")
    );
    let normal = Direction::new(0.0, 0.0);
    for phi in [0.0, 77.0, 180.0] {
        assert_eq!(part.evaluate(0, normal, Direction::new(10.0, phi)), Some(2.0), "{phi}");
    }
    let rows = "0,4\n5,3\n10,2\n90,0\n";
    let semicolons = format!("\"Theta (deg)\";\"BTDF (1/sr)\"\n{}", rows.replace(',', ";"));
    assert_eq!(read(semicolons).parts[0].way, ScatterMode::FrontTransmission);
    assert_eq!(read(format!("theta,brdf\n{rows}")).parts[0].way, ScatterMode::FrontReflection);
}

/// Without a name that states it, the caller does; a table of two columns of anything else is not a scan.
#[test]
fn part_of_a_scan_can_be_stated() {
    let bare = "0,4\n5,3\n10,2\n90,0\n";
    assert_eq!(refused_bsdf(bare).1, BsdfProblem::Unknown);
    let named = "theta_deg,bsdf\n0,4\n5,3\n10,2\n90,0\n";
    let unstated = read_part(named, None);
    assert_eq!(
        (unstated.states_part, unstated.measurement.parts[0].way),
        (false, ScatterMode::FrontReflection)
    );
    for text in [bare, named, "angle,f\n0,4\n5,3\n10,2\n90,0\n"] {
        let stated = read_part(text, Some(ScatterMode::BackTransmission));
        assert_eq!(
            (stated.states_part, stated.measurement.parts[0].way),
            (true, ScatterMode::BackTransmission)
        );
    }
    assert_eq!(refused_bsdf("wavelength_nm,T\n400,1\n500,1\n600,1\n").1, BsdfProblem::Unknown);
    assert_eq!(refused_bsdf("theta_deg,luminance\n0,1\n45,1\n90,1\n").1, BsdfProblem::Unknown);
}

#[test]
fn two_sides_of_a_scan_are_averaged_and_180_deg_is_straight_through() {
    let scan = read_part("theta_deg,btdf\n-90,0\n-10,1\n0,4\n10,3\n90,0\n", None);
    let part = &scan.measurement.parts[0];
    assert_eq!(part.evaluate(0, Direction::new(0.0, 0.0), Direction::new(10.0, 0.0)), Some(2.0));
    assert!(scan.warnings[0].contains("differ from their mean by"), "{:?}", scan.warnings);
    let both = read("theta_deg,bsdf\n0,1\n45,1\n90,1\n100,0\n150,2\n180,8\n");
    let ways: Vec<ScatterMode> = both.parts.iter().map(|part| part.way).collect();
    assert_eq!(ways, [ScatterMode::FrontReflection, ScatterMode::FrontTransmission]);
    assert_eq!(both.parts[1].evaluate(0, Direction::new(0.0, 0.0), Direction::new(0.0, 0.0)), Some(8.0));
    // A row at 90 deg is of the side that has other rows.
    let behind = read("theta_deg,bsdf\n90,0\n100,0\n150,2\n180,8\n");
    assert_eq!(behind.parts, read("theta_deg,btdf\n0,8\n30,2\n80,0\n90,0\n").parts);
    let (_, problem) = refused_bsdf("theta_deg,bsdf\n0,1\n30,1\n60,1\n100,0\n");
    assert!(problem.diagnostic().to_string().contains("1 angle of the front transmission"));
}

/// The total of a Lambertian scan is pi f, and its haze is cos^2 of 2.5 deg.
#[test]
fn audit_of_a_lambertian_scan_equals_the_closed_form() {
    let rows: String = (0..=90).map(|theta| format!("{theta},0.25\n")).collect();
    let scan = read(format!("theta_deg,btdf\n{rows}"));
    let audit = Audit::of(&scan.parts[0], 0).unwrap();
    assert!((audit.incidences[0].integral - 0.25 * std::f64::consts::PI).abs() < 1e-4);
    assert!((audit.haze.unwrap() - 2.5_f64.to_radians().cos().powi(2)).abs() < 1e-4);
    assert_eq!(audit.held_azimuths_deg, None, "all azimuths are known by symmetry");
}

#[test]
fn malformed_scan_is_an_error_with_its_place() {
    let with = |from: &str, to: &str| SCAN.replacen(from, to, 1);
    assert!(matches!(refused(with("5,3", "5,-3")), (Some((4, 3)), Problem::OutOfRange { .. })));
    assert!(matches!(refused(with("5,3", "5,x")), (Some((4, 3)), Problem::NotANumber { .. })));
    assert!(matches!(refused(with("5,3", "500,3")), (Some((4, 1)), Problem::OutOfRange { .. })));
    assert!(matches!(refused(with("5,3", "5,3,1")), (Some((4, 1)), Problem::Columns { .. })));
    assert!(matches!(refused_bsdf(with("5,3", "0,3")), (Some((4, 1)), BsdfProblem::Twice { .. })));
    assert!(matches!(refused_bsdf("theta_deg,btdf\n0,1\n90,0\n"), (None, BsdfProblem::Unsupported { .. })));
    assert!(matches!(refused_bsdf("theta_deg,btdf\n").1, BsdfProblem::Ends { .. }));
}

#[test]
fn scan_is_written_in_the_other_formats() {
    let scan = read(SCAN);
    for format in [BsdfFormat::Radiant, BsdfFormat::Csv, BsdfFormat::Papilio] {
        let again = read(&written(format, &scan).0);
        let integral = |measurement: &papilio_goniometry::Measurement| {
            Audit::of(&measurement.parts[0], 0).unwrap().incidences[0].integral
        };
        assert!((integral(&again) / integral(&scan) - 1.0).abs() < 1e-9, "{format:?}");
        assert_eq!(again.parts[0].way, ScatterMode::FrontTransmission);
    }
}

/// A table of four angles that names its values BTDF, with inclinations up to 90 deg, is a transmission (it
/// was read as a reflection).
#[test]
fn table_of_btdf_values_is_a_transmission() {
    let table =
        |name: &str| format!("theta_i,phi_i,theta_o,phi_o,{name}\n0,0,0,0,3\n0,0,30,0,2\n0,0,60,0,1\n");
    let btdf = read_part(&table("btdf"), None);
    assert_eq!((btdf.measurement.parts[0].way, btdf.notes.len()), (ScatterMode::FrontTransmission, 1));
    let unstated = read_part(&table("value"), None);
    assert_eq!(
        (unstated.measurement.parts[0].way, unstated.states_part),
        (ScatterMode::FrontReflection, false)
    );
    let stated = read_part(&table("value"), Some(ScatterMode::FrontTransmission));
    assert_eq!(stated.measurement.parts[0].way, ScatterMode::FrontTransmission);
    // `btdf` states a transmission, not the side of the light; it is no reflection.
    let back = read_part(&table("btdf"), Some(ScatterMode::BackTransmission));
    assert_eq!(back.measurement.parts[0].way, ScatterMode::BackTransmission);
    assert!(back.notes[0].contains("read as back transmission"), "{:?}", back.notes);
    let scan = read_part("theta_deg,btdf\n0,3\n30,2\n60,1\n", Some(ScatterMode::BackTransmission));
    assert_eq!(scan.measurement.parts[0].way, ScatterMode::BackTransmission);
    let reflected = read_part(&table("btdf"), Some(ScatterMode::FrontReflection));
    assert_eq!(reflected.measurement.parts[0].way, ScatterMode::FrontTransmission);
    // A column `way`, or inclinations above 90 deg, state the side.
    let behind =
        read_part("theta_i,phi_i,theta_o,phi_o,btdf\n30,0,150,180,1\n", Some(ScatterMode::BackTransmission));
    assert_eq!(behind.measurement.parts[0].way, ScatterMode::FrontTransmission);
    // A file that states its parts keeps them.
    let four = read_part("30,0,150,180,1\n", Some(ScatterMode::FrontReflection));
    assert_eq!(four.measurement.parts[0].way, ScatterMode::FrontTransmission);
    let refused = four.only(ScatterMode::FrontReflection, "four.csv").unwrap_err();
    assert!(
        matches!(&refused.problem, Problem::Bsdf(problem) if matches!(**problem, BsdfProblem::NoPart { .. }))
    );
    assert!(refused.to_string().contains("one of its parts: front transmission"), "{refused}");
}

/// A list of FRED: blocks of a direction of the light and rows; the pole is listed once; missing directions
/// were not measured.
#[test]
fn fred_list_is_a_grid_about_the_light() {
    let list = read_part(FRED, None);
    assert!(!list.states_part);
    assert!(list.notes[0].contains("phi_s = phi_i,"), "{:?}", list.notes);
    let part = &list.measurement.parts[0];
    let Geometry::Spherical(grid) = &part.geometry else { panic!("{:?}", part.geometry) };
    assert_eq!((&grid.theta_i_deg[..], &grid.phi_i_deg[..]), (&[0.0, 30.0][..], &[180.0][..]));
    // The half circle from 0 to 180 deg, mirrored to the side that begins at the light.
    assert_eq!((&grid.theta_o_deg[..], &grid.phi_o_deg[..]), (&[0.0, 30.0][..], &[180.0, 270.0, 360.0][..]));
    // Scaled by 2; light from (30, 180) has its specular direction at (30, 0).
    let light = Direction::new(30.0, 180.0);
    assert_eq!(part.evaluate(0, light, light.specular()), Some(18.0));
    assert_eq!(part.evaluate(0, light, Direction::new(0.0, 45.0)), Some(4.0));
    assert!(part.evaluate(0, light, Direction::new(30.0, 180.0)).is_none_or(f64::is_nan), "not measured");
}

/// In the plane of incidence, positive angles are on the specular side. The other sense of azimuths is
/// detected from the values.
#[test]
fn fred_list_in_the_plane_of_incidence_and_with_the_other_azimuth_is_read() {
    let plane = read(
        "type bsdf_data\nformat angles=rad bsdf=value scale=1\n0\n0 5\n0.5 1\n-0.5 1\n0.5\n0 2\n0.5 9\n-0.5 1\n",
    );
    let light = Direction::new(0.5_f64.to_degrees(), 180.0);
    assert_eq!(plane.parts[0].evaluate(0, light, light.specular()), Some(9.0));
    let other = FRED.replace("30 0 9", "30 180 9");
    let list = read_part(&other, None);
    assert!(list.notes[0].contains("phi_i + 180 deg"), "{:?}", list.notes);
    let light = Direction::new(30.0, 0.0);
    assert_eq!(list.measurement.parts[0].evaluate(0, light, light.specular()), Some(18.0));
}

#[test]
fn malformed_fred_list_is_an_error_with_its_place() {
    let with = |from: &str, to: &str| FRED.replacen(from, to, 1);
    assert!(matches!(
        refused_bsdf(with("bsdf=value", "bsdf=log")),
        (Some((2, 19)), BsdfProblem::Unexpected { .. })
    ));
    assert!(matches!(refused(with("scale=2", "scale=-2")), (Some((2, 30)), Problem::OutOfRange { .. })));
    assert!(matches!(refused(with("0\t0\n", "")), (Some((3, 1)), Problem::Columns { .. })));
    assert!(matches!(refused(with("30 90 3", "30 90 -3")), (Some((6, 7)), Problem::OutOfRange { .. })));
    assert!(matches!(refused_bsdf("type bsdf_data\n").1, BsdfProblem::Ends { .. }));
}

/// Scattered pairs of directions of a constant BRDF are written in every format that holds reflections, and are constant there.
#[test]
fn listed_pairs_in_any_order_are_written_in_the_other_formats() {
    let corput = |mut k: usize, base: usize| {
        let (mut value, mut digit) = (0.0, 1.0);
        while k > 0 {
            digit /= base as f64;
            value += digit * (k % base) as f64;
            k /= base;
        }
        value
    };
    let mut text = "theta_i,phi_i,theta_o,phi_o,brdf\n".to_owned();
    for k in 20..320 {
        let inclined = |base: usize| (0.97 * corput(k, base)).sqrt().asin().to_degrees();
        let turned = |base: usize| 360.0 * corput(k, base);
        text.push_str(&format!("{},{},{},{},0.3\n", inclined(2), turned(3), inclined(5), turned(7)));
    }
    let list = read(&text);
    for format in [BsdfFormat::Radiant, BsdfFormat::Klems, BsdfFormat::Csv, BsdfFormat::Papilio] {
        let again = read(&written(format, &list).0);
        let audit = papilio_goniometry::Audit::of(&again.parts[0], 0).unwrap();
        // Patches are means over the measured directions in them; a grid also ends where the list ends, at 80 deg.
        let total = audit.incidences[0].integral_beyond / (0.3 * std::f64::consts::PI);
        assert!((total - 1.0).abs() < 2e-3, "{format:?}: {total}");
    }
}

/// A perfect diffuser of one incidence: at 60 deg, the part of the unit disc outside the one that was measured, shifted by
/// sin 60 deg, is extrapolated.
#[test]
fn values_that_are_all_0_are_warned_of() {
    let dark = read_part("theta_deg,btdf\n0,0\n10,0\n20,0\n90,0\n", None);
    assert!(dark.warnings[0].starts_with("no value of the file is above 0"), "{:?}", dark.warnings);
    assert!(read_part("theta_deg,btdf\n0,1\n10,0\n90,0\n", None).warnings.is_empty());
}

/// Light at 90 deg alone gives no lobe of a display.
#[test]
fn klems_matrices_of_values_without_a_lobe_say_so() {
    let rows = |theta_i: f64| -> String {
        let outgoing = (0..=8).flat_map(|k| (0..12).map(move |j| (10 * k, 30 * j)));
        outgoing.map(|(theta, phi)| format!("{theta_i},0,{theta},{phi},0.3\n")).collect()
    };
    let lost = |theta_i: f64| {
        let table = format!("theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg,brdf\n{}", rows(theta_i));
        written(BsdfFormat::Klems, &read(table)).1
    };
    let says_so = |lost: Vec<String>| lost.iter().any(|line| line.contains("has no smooth lobe"));
    assert!(says_so(lost(90.0)), "{:?}", lost(90.0));
    assert!(!says_so(lost(30.0)), "{:?}", lost(30.0));
}

#[test]
fn extrapolated_light_of_a_scan_is_stated_by_klems_matrices() {
    let rows: String = (0..=90).map(|theta| format!("{theta},0.2\n")).collect();
    let lost = written(BsdfFormat::Klems, &read(format!("theta_deg,brdf\n{rows}"))).1;
    let half = 0.5 * 60_f64.to_radians().sin();
    let shared = 2.0 * half.acos() - 2.0 * half * (1.0 - half * half).sqrt();
    let expected = 100.0 * (1.0 - shared / std::f64::consts::PI);
    let line = lost.iter().find(|line| line.starts_with("beyond 0 deg of incidence")).unwrap();
    let stated: f64 = line.split(": at 60 deg, ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((stated - expected).abs() < 0.15, "{line}, expected {expected}");
}
