//! CSV: a row for each pair of directions and channel.

use papilio_formats::{BsdfFormat, BsdfProblem, Problem};
use papilio_goniometry::{Channel, Geometry, Way};

use super::samples::{RADIANT, TABLE as GRID};
use super::{read, refused, refused_bsdf, written};

#[test]
fn rows_that_are_all_pairs_of_axes_are_a_grid() {
    let measurement = read(GRID);
    let part = &measurement.parts[0];
    assert_eq!(measurement.provenance.sample, "film");
    assert_eq!(part.channels, [Channel::Wavelength(450.0), Channel::Wavelength(500.0)]);
    let Geometry::Spherical(grid) = &part.geometry else { panic!("{:?}", part.geometry) };
    assert_eq!(grid.theta_o_deg, [0.0, 10.0]);
    assert_eq!((part.values[0], part.values[2..].to_vec()), (3.0, vec![1.0, 2.0]));
    assert!(part.values[1].is_nan(), "a cell without a value was not measured");
}

/// Above 90 deg light is on the other side, its azimuth unchanged: straight through is phi + 180.
#[test]
fn inclinations_go_to_the_back() {
    let measurement =
        read("30,0,150,180,1\n30,0,30,180,2\n150,0,30,180,3\n150;0;150;180;4\n".replace(';', ","));
    let ways: Vec<Way> = measurement.parts.iter().map(|part| part.way).collect();
    assert_eq!(
        ways,
        [Way::FrontReflection, Way::FrontTransmission, Way::BackTransmission, Way::BackReflection]
    );
    for (part, value) in measurement.parts.iter().zip([2.0, 1.0, 3.0, 4.0]) {
        let [light, viewer] = part.geometry.directions(0).unwrap();
        assert_eq!((light.theta_deg, viewer), (30.0, light.specular()));
        assert_eq!(part.values, [value]);
    }
}

#[test]
fn what_is_written_reads_back() {
    for text in [GRID, "0,0,0,0,1\n0,0,91,5,2\n10,20,30,40,1e-9\n"] {
        let measurement = read(text);
        let (bytes, lost) = written(BsdfFormat::Csv, &measurement);
        let again = read(&bytes);
        assert_eq!(lost, Vec::<String>::new());
        for (part, other) in measurement.parts.iter().zip(&again.parts) {
            assert_eq!(
                (part.way, &part.channels, &part.geometry),
                (other.way, &other.channels, &other.geometry)
            );
            let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&part.values), bits(&other.values));
        }
        assert_eq!(measurement.provenance, again.provenance);
    }
}

#[test]
fn a_specular_grid_becomes_pairs() {
    let measurement = read(RADIANT);
    let (bytes, lost) = written(BsdfFormat::Csv, &measurement);
    assert_eq!(lost.len(), 2, "{lost:?}");
    let pairs = read(&bytes);
    // The centre once, azimuths 0 and 180 once, 90 with its mirror image: 1 + 2 + 2, at two incidences.
    assert_eq!(pairs.parts[0].values.len(), 10);
}

#[test]
fn what_is_wrong_has_its_line() {
    let with = |from: &str, to: &str| GRID.replacen(from, to, 1);
    assert_eq!(refused(with("0,0,10,0,500,2", "0,0,10,0,500,nan")).0, Some((4, 14)));
    assert_eq!(refused(with("0,0,10,0,500,2", "0,0,10,0,500,-2")).0, Some((4, 14)));
    assert_eq!(refused(with("0,0,10,0,500,2", "0,0,190,0,500,2")).0, Some((4, 5)));
    assert!(matches!(refused(with("0,0,10,0,500,2", "0,0,10,0,2")), (Some((4, 1)), Problem::Columns { .. })));
    assert!(matches!(
        refused_bsdf(with("0,0,10,0,500,2", "0,0,0,0,500,2")),
        (Some((4, 1)), BsdfProblem::Twice { .. })
    ));
    assert_eq!(refused(GRID.replace("500", "0.5")), (Some((3, 9)), Problem::Micrometres));
    assert_eq!(refused_bsdf("0,0,0\n").1, BsdfProblem::Unknown);
    assert!(matches!(refused_bsdf("theta_i,phi_i,theta_o,phi_o,value\n").1, BsdfProblem::Ends { .. }));
}

/// Each pair in a channel of its own: a matrix of all of them would be huge.
#[test]
fn pairs_and_channels_that_hardly_meet_are_refused() {
    let rows: String = (0..3000).map(|k| format!("0,0,{},0,{},1\n", k as f64 / 100.0, 400 + k)).collect();
    assert!(matches!(refused_bsdf(rows).1, BsdfProblem::Missing { .. }));
}

/// docs/bsdf-files.md lists the formats as the program does. `cargo xtask docs` writes the list.
#[test]
fn table_of_formats_in_the_docs_is_that_of_the_readers() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/bsdf-files.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once("<!-- formats -->\n").unwrap();
    let (_, after) = rest.split_once("<!-- end of formats -->").unwrap();
    let table = papilio_formats::bsdf_format_table();
    let made = format!("{before}<!-- formats -->\n\n{table}\n<!-- end of formats -->{after}");
    if std::env::var_os("PAPILIO_WRITE_DOCS").is_some() {
        return std::fs::write(&path, &made).unwrap();
    }
    assert!(made == page, "docs/bsdf-files.md is out of date, run `cargo xtask docs`");
}
