//! XML files of WINDOW and Radiance: Klems matrices and tensor trees.

use papilio_formats::{BsdfFormat, BsdfProblem, Problem, read_bsdf};
use papilio_goniometry::{
    Channel, Direction, Geometry, KLEMS_FULL, ScatterMode, SpecularGrid, Symmetry, projected_solid_angle,
};

use super::samples::{MATRIX, TREE_3, klems};
use super::{file, read, refused, refused_bsdf, written};

/// With `Columns`, the rows of the file are outgoing directions. Light from azimuth 0 (67 deg) belongs to the
/// second patch of its ring, because incident patches are rotated by 180 deg; the patch of its specular
/// direction has the same number.
#[test]
fn klems_matrix_is_read_by_columns_or_rows() {
    let block = [("Visible", "Transmission Front", MATRIX)];
    let columns = read(klems("Columns", &block));
    let rows = read(klems("Rows", &block));
    assert_eq!(columns.parts[0].values, [1.0, 4.0, 7.0, 2.0, 5.0, 8.0, 3.0, 6.0, 9.0]);
    assert_eq!(rows.parts[0].values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
    let light = Direction::new(60.0, 0.0);
    let f = |o| columns.parts[0].evaluate(0, light, o);
    assert_eq!(f(light.specular()), Some(9.0));
    assert_eq!(f(Direction::new(50.0, 10.0)), Some(6.0));
    assert_eq!(f(Direction::new(10.0, 10.0)), Some(3.0));
    assert_eq!(columns.parts[0].way, ScatterMode::FrontTransmission);
    assert_eq!(columns.provenance.sample, "blind");
}

#[test]
fn klems_spectra_become_channels_and_directions_become_parts() {
    let blocks = [
        ("Solar", "Reflection Back", MATRIX),
        ("Visible", "Reflection Back", MATRIX),
        ("CIE-Z", "Reflection Back", MATRIX),
        ("Visible", "Transmission Back", MATRIX),
        ("NIR", "Reflection Back", MATRIX),
    ];
    let read = read_bsdf(&file(klems("Columns", &blocks))).unwrap();
    let parts: Vec<_> = read.value.parts.iter().map(|part| (part.way, part.channels.clone())).collect();
    assert_eq!(
        parts,
        [
            (ScatterMode::BackTransmission, vec![Channel::Monochrome]),
            (ScatterMode::BackReflection, vec![Channel::Y, Channel::Z, Channel::Solar]),
        ]
    );
    assert_eq!(read.warnings.len(), 2, "BTDF for reflection; NIR: {:?}", read.warnings);
}

#[test]
fn klems_file_reads_back_bit_for_bit() {
    let blocks =
        [("CIE-X", "Reflection Front", "1 2 3 4 5 6 7 8 9e-7"), ("Visible", "Transmission Back", MATRIX)];
    let measurement = read(klems("Columns", &blocks));
    let (bytes, lost) = written(BsdfFormat::Klems, &measurement);
    assert_eq!((read(&bytes), lost), (measurement, Vec::new()));
}

/// A constant grid has its value in every patch within 75 deg, and its integral.
#[test]
fn constant_grid_averaged_over_patches_has_its_integral() {
    let mut measurement = read(super::samples::RADIANT);
    let grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: (0..=9).map(|k| 10.0 * f64::from(k)).collect(),
        azimuths_deg: vec![0.0, 180.0],
        radials_deg: vec![0.0, 60.0, 120.0, 180.0],
        symmetry: Symmetry::Plane,
    };
    let part = &mut measurement.parts[0];
    part.values = vec![0.25; grid.cells()];
    part.geometry = Geometry::Specular(grid);
    part.tis.clear();
    let patches = read(written(BsdfFormat::Klems, &measurement).0);
    let values = &patches.parts[0].values;
    assert_eq!(values.len(), 145 * 145);
    let omega = projected_solid_angle(&KLEMS_FULL);
    let sum: f64 = values[..145].iter().zip(omega).map(|(f, omega)| f * omega).sum();
    assert!((sum / (0.25 * std::f64::consts::PI) - 1.0).abs() < 1e-8, "{sum}");
}

/// The lobe of an isotropic sample is averaged as a smooth lobe. A second, equal rotation hides that it is isotropic, and
/// gives nearly the same means by points of both patches.
#[test]
fn lobe_has_the_means_of_points_and_is_the_same_at_all_azimuths() {
    let mut measurement = read(super::samples::RADIANT);
    let mut grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: (0..=9).map(|k| 10.0 * f64::from(k)).collect(),
        azimuths_deg: (0..=12).map(|k| 15.0 * f64::from(k)).collect(),
        radials_deg: (0..=60).map(|k| 3.0 * f64::from(k)).collect(),
        symmetry: Symmetry::Plane,
    };
    let mut values = Vec::new();
    for theta in &grid.incidences_deg {
        for azimuth in &grid.azimuths_deg {
            values.extend(grid.radials_deg.iter().map(|radial| {
                let to =
                    SpecularGrid::direction(*theta, *azimuth, *radial).map_or([2.0; 3], Direction::vector);
                let square = (to[0] - theta.to_radians().sin()).powi(2) + to[1] * to[1];
                1.0 / (1.0 + square / 0.25).powi(2)
            }));
        }
    }
    let mut patches = |rotations: &[f64]| {
        grid.rotations_deg = rotations.to_vec();
        let part = &mut measurement.parts[0];
        part.values = values.repeat(rotations.len());
        part.geometry = Geometry::Specular(grid.clone());
        part.tis.clear();
        read(written(BsdfFormat::Klems, &measurement).0).parts.remove(0).values
    };
    let (once, each) = (patches(&[0.0]), patches(&[0.0, 180.0]));
    assert_eq!((once.len(), each.len()), (145 * 145, 145 * 145));
    let off = once.iter().zip(&each).map(|(once, each)| (once / each - 1.0).abs());
    assert!(off.clone().sum::<f64>() / (145.0 * 145.0) < 0.01, "{}", off.sum::<f64>() / (145.0 * 145.0));
    // A quarter of a turn: 2 of 8 patches in the ring that begins with patch 1, and 5 of 20 in that of patch
    // 25.
    for k in 0..6 {
        let [one, turned] = [(1 + k % 6) * 145 + 25 + k, (3 + k % 6) * 145 + 30 + k].map(|pair| once[pair]);
        assert!((one / turned - 1.0).abs() < 1e-6, "{k}: {one} {turned}");
    }
    // The patch about the normal has all azimuths.
    assert!((25..45).all(|patch| (once[patch] / once[25] - 1.0).abs() < 1e-6));
}

/// For f proportional to the viewer's inclination, the mean over a ring, weighted with the cosine, is known
/// in closed form. Two azimuths of light: what is not isotropic is averaged over points.
#[test]
fn average_over_a_patch_is_weighted_with_the_cosine() {
    let table: String = (0..4 * 91)
        .map(|k| format!("{},{},{},0,{}\n", k / 182 * 90, k / 91 % 2 * 180, k % 91, k % 91))
        .collect();
    let patches = read(written(BsdfFormat::Klems, &read(table)).0);
    let integral = |deg: f64| {
        let theta = deg.to_radians();
        (-theta * (2.0 * theta).cos() / 4.0 + (2.0 * theta).sin() / 8.0).to_degrees()
    };
    for (patch, from, to) in [(0, 0.0, 5.0), (20, 15.0, 25.0), (80, 45.0, 55.0), (144, 75.0, 90.0)] {
        let area = |deg: f64| deg.to_radians().sin().powi(2) / 2.0;
        let mean = (integral(to) - integral(from)) / (area(to) - area(from));
        for incident in [0, 77] {
            let f = patches.parts[0].values[incident * 145 + patch];
            assert!((f - mean).abs() < 0.02 * (to - from), "{patch}: {f} {mean}");
        }
    }
}

/// Trees of Radiance: for rank 3, light along the normal is at 1/2 of the first side.
#[test]
fn tree_is_read_in_the_order_of_its_braces() {
    let measurement = read(klems("TensorTree3", &[("Visible", "Transmission Front", TREE_3)]));
    let part = &measurement.parts[0];
    assert_eq!(part.values.len(), 15);
    // Bit 0 of a child's number is the half of the first side, (1 - sin theta_i)/2; bits 1 and 2 are the
    // halves of the square: towards the specular direction (azimuth 180 from the light), and to its left.
    let light = Direction::new(30.0, 20.0);
    let f = |azimuth| part.evaluate(0, light, Direction::new(40.0, 20.0 + azimuth));
    assert_eq!((f(170.0), f(190.0)), (Some(3.0), Some(7.0)));
    assert_eq!((f(-10.0), f(10.0)), (Some(5.0), Some(1.0)));
    // Its cells are far wider than the rings of a display.
    let text = papilio_formats::audit_text("x", &measurement, &[papilio_goniometry::Audit::of(part, 0)]);
    assert!(text.contains("spreads the cells of a tensor tree") && !text.contains("radial grid"), "{text}");
}

/// Trees of different depths are joined into one that is as fine as each of them.
#[test]
fn trees_of_several_spectra_are_joined_without_change_of_values() {
    let blocks = [
        ("Visible", "Transmission Front", TREE_3),
        ("CIE-X", "Transmission Front", "{9 8 7 6 5 4 3 2}"),
        ("CIE-Z", "Transmission Front", "{ {1} {1} {1} {1} {1} {1} {1} {2} }"),
    ];
    let joint = read(klems("TensorTree3", &blocks)).parts.remove(0);
    assert_eq!(joint.channels, [Channel::X, Channel::Y, Channel::Z]);
    for (channel, block) in [(1, blocks[0]), (0, blocks[1]), (2, blocks[2])] {
        let alone = read(klems("TensorTree3", &[block])).parts.remove(0);
        for k in 0..2000 {
            let turn = f64::from(k) * 137.5;
            let (i, o) = (Direction::new(turn % 90.0, 3.0), Direction::new(f64::from(k) % 89.0, turn));
            assert_eq!(joint.evaluate(channel, i, o), alone.evaluate(0, i, o), "{channel} {i:?} {o:?}");
        }
    }
}

#[test]
fn tree_of_rank_four_has_the_squares_of_light_and_viewer() {
    let values: Vec<String> = (0..16).map(|k| k.to_string()).collect();
    let text = klems("TensorTree4", &[("Visible", "Reflection Front", &format!("{{{}}}", values.join(" ")))]);
    let part = read(text).parts.remove(0);
    // The square of the direction of the unscattered light: (0, 1) for light from azimuth -45, and
    // correspondingly for others; the viewer's square is the lower digit.
    let square = |azimuth| Direction::new(50.0, azimuth);
    assert_eq!(part.evaluate(0, square(-45.0), square(45.0)), Some(4.0 + 3.0));
    assert_eq!(part.evaluate(0, square(-135.0), square(-45.0)), Some(12.0 + 2.0));
}

#[test]
fn malformed_xml_file_is_an_error_with_its_place() {
    let matrix = |values: &str| klems("Columns", &[("Visible", "Transmission Front", values)]);
    let line = matrix("1").lines().position(|line| line == "1").unwrap() + 1;
    assert_eq!(refused(matrix("1 2 -3")).0, Some((line, 5)));
    assert_eq!(refused(matrix("1 2\n3 nan")).0, Some((line + 1, 3)));
    assert_eq!(
        refused_bsdf(matrix("1 2 3")),
        (Some((line, 5)), BsdfProblem::Count { what: "values", found: 3, count: 9 })
    );
    assert!(
        matches!(refused_bsdf(matrix("1 2 3 4 5 6 7 8 9 10")), (Some((at, 19)), BsdfProblem::Count { .. }) if at == line)
    );
    let tree = |values: &str| refused(klems("TensorTree3", &[("Visible", "Transmission Front", values)]));
    assert_eq!(tree("{1 2 3}").0, Some((line, 7)));
    assert_eq!(tree("{ {1} {1} }").0, Some((line, 11)));
    assert_eq!(tree("{1} 2").0, Some((line, 5)));
    assert_eq!(tree("{-1}").0, Some((line, 2)));
    assert!(matches!(tree(&"{".repeat(1000)).1, Problem::Bsdf(_)));
    let swapped = matrix(MATRIX).replace("<UpperTheta>45<", "<UpperTheta>95<");
    assert!(matches!(refused_bsdf(swapped).1, BsdfProblem::Order { .. }));
    assert!(matches!(
        refused_bsdf(matrix(MATRIX).replace("own</Row", "other</Row")).1,
        BsdfProblem::Unexpected { .. }
    ));
    assert!(matches!(refused_bsdf(matrix(MATRIX).replace("</Layer>", "")).1, BsdfProblem::Damaged { .. }));
    assert!(matches!(
        refused_bsdf(matrix(MATRIX).replace("</WindowElement>\n", "")).1,
        BsdfProblem::Ends { .. }
    ));
    assert!(matches!(
        refused_bsdf(matrix(MATRIX).replace("<?xml", "<!DOCTYPE x><?xml")).1,
        BsdfProblem::Damaged { .. }
    ));
    let twice = [("Visible", "Transmission Front", MATRIX), ("Visible", "Transmission Front", MATRIX)];
    assert!(matches!(refused_bsdf(klems("Columns", &twice)).1, BsdfProblem::Twice { .. }));
    let deep = format!("<WindowElement>{}", "<a>".repeat(100_000));
    assert!(matches!(refused_bsdf(deep).1, BsdfProblem::TooDeep { .. }));
    let huge = matrix(MATRIX).replace("<nPhis>2<", "<nPhis>1e9<");
    assert!(matches!(refused(huge).1, Problem::OutOfRange { what: "nPhis", .. }));
}

/// Some programs write a line of their own before the declaration: it is ignored, with a warning. Other text
/// is an error as before.
#[test]
fn one_line_before_the_declaration_is_ignored() {
    let text = klems("Columns", &[("Visible", "Transmission Front", MATRIX)]);
    let with_line = read_bsdf(&file(format!("Made by WINDOW 7\n{text}"))).unwrap();
    assert_eq!(with_line.value, read(&text));
    assert!(
        with_line.warnings.iter().any(|warning| warning.contains("`Made by WINDOW 7`")),
        "{:?}",
        with_line.warnings
    );
    assert_eq!(refused_bsdf(format!("one\ntwo\n{text}")).1, BsdfProblem::Unknown);
    let undeclared = text.split_once("?>\n").unwrap().1;
    assert_eq!(refused_bsdf(format!("one\n{undeclared}")).1, BsdfProblem::Unknown);
}
