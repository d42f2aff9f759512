//! CSV files: one row per pair of directions and channel.

use papilio_formats::{BsdfFormat, BsdfProblem, Problem};
use papilio_goniometry::{Channel, Geometry, ScatterMode};

use super::samples::{RADIANT, TABLE as GRID};
use super::{read, refused, refused_bsdf, written};

#[test]
fn csv_with_all_combinations_of_axes_is_a_grid() {
    let measurement = read(GRID);
    let part = &measurement.parts[0];
    assert_eq!(measurement.provenance.sample, "film");
    assert_eq!(part.channels, [Channel::Wavelength(450.0), Channel::Wavelength(500.0)]);
    let Geometry::Spherical(grid) = &part.geometry else { panic!("{:?}", part.geometry) };
    assert_eq!(grid.theta_o_deg, [0.0, 10.0]);
    assert_eq!((part.values[0], part.values[2..].to_vec()), (3.0, vec![1.0, 2.0]));
    assert!(part.values[1].is_nan(), "an empty cell was not measured");
}

/// Above 90 deg, light is on the other side with the same azimuth: unscattered light leaves at phi + 180.
#[test]
fn csv_inclinations_beyond_90_deg_are_on_the_back() {
    let measurement =
        read("30,0,150,180,1\n30,0,30,180,2\n150,0,30,180,3\n150;0;150;180;4\n".replace(';', ","));
    let ways: Vec<ScatterMode> = measurement.parts.iter().map(|part| part.way).collect();
    assert_eq!(
        ways,
        [
            ScatterMode::FrontReflection,
            ScatterMode::FrontTransmission,
            ScatterMode::BackTransmission,
            ScatterMode::BackReflection
        ]
    );
    for (part, value) in measurement.parts.iter().zip([2.0, 1.0, 3.0, 4.0]) {
        let [light, viewer] = part.geometry.directions(0).unwrap();
        assert_eq!((light.theta_deg, viewer), (30.0, light.specular()));
        assert_eq!(part.values, [value]);
    }
}

/// The sides of a sample meet at 90 deg: rows there are of the part that the other rows have, as if a column stated it.
#[test]
fn rows_at_90_deg_are_of_the_side_that_has_other_rows() {
    let turned = |is_behind: bool, theta: u32| if is_behind { 180 - theta } else { theta };
    let names = ["front reflection", "front transmission", "back transmission", "back reflection"];
    for (name, [from_back, to_back]) in
        names.into_iter().zip([[false, false], [false, true], [true, false], [true, true]])
    {
        let (mut stated, mut unfolded) = ("way,theta_i,phi_i,theta_o,phi_o,bsdf\n".to_owned(), String::new());
        for theta_i in [0, 45, 90] {
            for theta_o in [0, 30, 60, 90] {
                for phi in [0, 120, 240] {
                    let value = 1000 * theta_i + 10 * theta_o + phi;
                    stated += &format!("{name},{theta_i},0,{theta_o},{phi},{value}\n");
                    let [i, o] = [turned(from_back, theta_i), turned(to_back, theta_o)];
                    unfolded += &format!("{i},0,{o},{phi},{value}\n");
                }
            }
        }
        assert_eq!(read(&unfolded).parts, read(&stated).parts, "{name}");
        // In radians, as the files of ASTM.
        let rows: Vec<String> = unfolded
            .lines()
            .map(|line| {
                let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
                let radians: Vec<String> =
                    cells[..4].iter().map(|deg| format!("{:.4}", deg.to_radians())).collect();
                format!("{},{}\n", radians.join(","), cells[4])
            })
            .collect();
        let vars = "VARS theta_i,phi_i,theta_s,phi_s,BSDF";
        let astm = format!("ASTM E 1392-96(2002)\nNUM_POINTS {}\n{vars}\n{}", rows.len(), rows.concat());
        assert_eq!(read(astm).parts, read(&stated).parts, "{name}");
    }
    // Where both sides have other rows, 90 deg is the end of the front.
    let both = |theta: u32| format!("0,0,{theta},0,{theta}\n0,0,{theta},90,1\n0,0,{theta},180,1\n");
    let ends: Vec<Vec<f64>> = read([0, 45, 90, 135, 180].map(both).concat())
        .parts
        .iter()
        .map(|part| match &part.geometry {
            Geometry::Spherical(grid) => grid.theta_o_deg.clone(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(ends, [vec![0.0, 45.0, 90.0], vec![0.0, 45.0]]);
}

/// A ring of directions behind the sample is no transmission: with other rows in front it is refused, unless it is stated.
#[test]
fn ring_of_one_inclination_beside_another_part_is_refused() {
    let rows = |thetas: &[u32], head: &str| -> String {
        let pairs = thetas.iter().flat_map(|theta| [0, 90, 180].map(|phi| (theta, phi)));
        pairs.map(|(theta, phi)| format!("{head}0,0,{theta},{phi},0.3\n")).collect()
    };
    let (place, problem) = refused_bsdf(rows(&[0, 30, 60, 100], ""));
    let words = problem.diagnostic().to_string();
    assert!(place.is_none() && words.contains("front transmission with a single inclination"), "{words}");
    assert!(words.contains("100 deg"), "{words}");
    let stated = format!(
        "way,theta_i,phi_i,theta_o,phi_o,bsdf\n{}{}",
        rows(&[0, 30, 60], "front reflection,"),
        rows(&[80], "front transmission,")
    );
    assert_eq!(read(stated).parts.len(), 2);
    assert_eq!(read(rows(&[0, 30, 60, 180], "")).parts.len(), 2, "straight through");
}

#[test]
fn csv_file_reads_back() {
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
fn specular_grid_written_as_csv_becomes_pairs() {
    let measurement = read(RADIANT);
    let (bytes, lost) = written(BsdfFormat::Csv, &measurement);
    assert_eq!(lost.len(), 2, "{lost:?}");
    let pairs = read(&bytes);
    // Centre once, azimuths 0 and 180 once each, azimuth 90 with its mirror image: 1 + 2 + 2, at two
    // incidences.
    assert_eq!(pairs.parts[0].values.len(), 10);
}

#[test]
fn malformed_csv_file_is_an_error_with_its_place() {
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

/// If each pair has a different channel, a matrix of all of them would be huge.
#[test]
fn csv_with_few_values_for_many_pairs_and_channels_is_refused() {
    let rows: String = (0..3000).map(|k| format!("0,0,{},0,{},1\n", k as f64 / 100.0, 400 + k)).collect();
    assert!(matches!(refused_bsdf(rows).1, BsdfProblem::Missing { .. }));
}

/// docs/bsdf-files.md has the same list of formats as the program. `cargo xtask docs` writes it.
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
