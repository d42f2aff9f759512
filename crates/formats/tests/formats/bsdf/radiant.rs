//! The tabular BSDF of Radiant and Zemax.

use papilio_formats::{BsdfFormat, BsdfProblem, Problem, read_bsdf};
use papilio_goniometry::{Channel, Geometry, MeasuredPart, ScatterMode, SpecularGrid, Symmetry};

use super::samples::RADIANT as SMALL;
use super::{file, read, refused, refused_bsdf, written};

#[test]
fn radiant_file_is_read_in_its_order() {
    let measurement = read(SMALL);
    let part = &measurement.parts[0];
    assert_eq!(
        (part.way, part.channels.as_slice()),
        (ScatterMode::FrontTransmission, [Channel::Monochrome].as_slice())
    );
    assert_eq!(part.values, [3.0, 1.0, 3.0, 1.5, 3.0, 2.0, 4.0, 0.1, 4.0, 0.25, 4.0, 0.0]);
    assert_eq!(part.tis, [0.5, 0.4]);
    assert_eq!(measurement.provenance.source, "Measured");
    assert_eq!(measurement.provenance.remarks, ["an example", "between"]);
    let Geometry::Specular(grid) = &part.geometry else { panic!("{:?}", part.geometry) };
    assert_eq!(grid.symmetry, Symmetry::Plane);
    assert_eq!(read(SMALL.replace('\n', "\r\n")).parts, measurement.parts);
}

/// The worked direction in the description of the format: incidence 30, radial 20, azimuth 90.
#[test]
fn direction_of_a_cell_agrees_with_the_format() {
    let measurement = read(SMALL);
    let part = &measurement.parts[0];
    let cell = 6 + 2 + 1;
    assert_eq!(part.channel(0)[cell], 0.25);
    let [light, viewer] = part.geometry.directions(cell).unwrap();
    assert_eq!((light.theta_deg, light.phi_deg), (30.0, 180.0));
    assert!((viewer.theta_deg - 35.531).abs() < 1e-3 && (viewer.phi_deg + 36.052).abs() < 1e-3);
}

fn xyz() -> String {
    let (head, data) = SMALL.split_once("Monochrome\nDataBegin").unwrap();
    let head = head.replace("Monochrome", "XYZ").replace("PlaneSymmetrical", "asymmetrical");
    let blocks =
        ["TristimulusX", "TristimulusY", "TristimulusZ"].map(|name| format!("{name}\nDataBegin{data}"));
    format!("{head}{}", blocks.concat())
}

#[test]
fn tristimulus_file_has_three_channels() {
    let read = read_bsdf(&file(xyz())).unwrap();
    let part = &read.value.parts[0];
    assert_eq!(part.channels, [Channel::X, Channel::Y, Channel::Z]);
    assert_eq!((part.values.len(), part.tis.len()), (36, 6));
    assert!(read.warnings[0].contains("ScatterAzimuth"), "{:?}", read.warnings);
}

#[test]
fn radiant_file_reads_back_bit_for_bit() {
    for text in
        [SMALL.to_owned(), xyz(), SMALL.replace("BTDF", "BRDF").replace(".25", "3.3333333333333335e-7")]
    {
        let measurement = read(&text);
        let (bytes, lost) = written(BsdfFormat::Radiant, &measurement);
        assert_eq!((read(&bytes), lost), (measurement, Vec::new()));
    }
}

/// Listed pairs of a grid are written on this grid, with its angles as they are and a note that tells so.
#[test]
fn pairs_of_a_grid_are_written_on_it() {
    let steps = |count: u32, step: f64| -> Vec<f64> { (0..count).map(|k| step * f64::from(k)).collect() };
    let grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: vec![0.0, 30.0],
        azimuths_deg: steps(24, 15.0),
        radials_deg: steps(20, 3.0),
        symmetry: Symmetry::None,
    };
    let grid = Geometry::Specular(grid);
    let pairs: Vec<_> = (0..grid.cells()).filter_map(|cell| grid.directions(cell)).collect();
    let part = MeasuredPart {
        way: ScatterMode::FrontReflection,
        channels: vec![Channel::Monochrome],
        values: pairs.iter().map(|[_, to]| 0.1 + to.theta_deg / 900.0).collect(),
        geometry: Geometry::Pairs(pairs),
        tis: Vec::new(),
    };
    let (bytes, lost) =
        written(BsdfFormat::Radiant, &papilio_goniometry::Measurement { parts: vec![part], ..read(SMALL) });
    assert!(
        lost.iter().any(|note| note.contains("those of a grid about the specular direction")),
        "{lost:?}"
    );
    assert!(lost.iter().all(|note| !note.contains("interpolated")), "{lost:?}");
    let text = String::from_utf8(bytes).unwrap();
    assert!(text.contains("\n0\t15\t30\t45\t"), "{text}");
    assert!(text.contains("\n0\t3\t6\t9\t"), "{text}");
}

#[test]
fn malformed_radiant_file_is_an_error_with_its_place() {
    let with = |from: &str, to: &str| SMALL.replacen(from, to, 1);
    let at = |from, to| refused(with(from, to)).0;
    let bsdf = |from, to| refused_bsdf(with(from, to));
    let (place, problem) = refused(with(".25", "-0.25"));
    assert_eq!(place, Some((24, 3)));
    assert!(matches!(problem, Problem::OutOfRange { value: -0.25, .. }));
    assert_eq!(refused(with(".25", "nan")), (Some((24, 3)), Problem::NotFinite { found: "nan".to_owned() }));
    assert_eq!(refused(with(".25", "x")).1, Problem::NotANumber { found: "x".to_owned() });
    assert_eq!(
        bsdf("0\t90\t180", "0\t180\t90"),
        (Some((11, 7)), BsdfProblem::Order { what: "ScatterAzimuth", value: 90.0, before: 180.0 })
    );
    assert_eq!(
        bsdf("0\t90\t180", "0\t90"),
        (Some((11, 1)), BsdfProblem::Count { what: "angles", found: 2, count: 3 })
    );
    assert_eq!(
        bsdf("3 1.5", "3 1.5 2"),
        (Some((19, 1)), BsdfProblem::Count { what: "values in this row", found: 3, count: 2 })
    );
    assert_eq!(at("3 1.5\n", ""), Some((21, 1)), "one row is missing: TIS comes too early");
    assert_eq!(at("3 1.5\n", "3 1.5\n3 1.5\n"), Some((21, 1)), "one additional row");
    assert_eq!(at("TIS 0.4", "TIS -4"), Some((22, 5)));
    assert_eq!(at("0 30", "0 95"), Some((9, 3)));
    assert_eq!(at("BTDF", "BSSRDF"), Some((5, 14)));
    assert_eq!(at("ScatterRadial  2", "ScatterRadial  1e300"), Some((12, 16)));
    assert_eq!(bsdf("Symmetry  PlaneSymmetrical\n", "").1, BsdfProblem::Missing { what: "line `Symmetry`" });
    assert_eq!(refused_bsdf(format!("{SMALL}1 2\n")).0, Some((27, 1)));
    let cut = &SMALL[..SMALL.find("4 .25").unwrap()];
    assert_eq!(refused_bsdf(cut), (Some((23, 7)), BsdfProblem::Ends { what: "the last row of data" }));
}

#[test]
fn tis_above_one_is_a_warning() {
    for (tis, says) in [("TIS 1.2", "above 1"), ("TIS 40", "is in per cent"), ("TIS 400", "above 1")] {
        let read = read_bsdf(&file(SMALL.replace("TIS 0.4", tis))).unwrap();
        assert!(read.warnings[0].contains(says), "{:?}", read.warnings);
    }
}

/// A sample brighter than the reference has a TIS above 1, which is the integral of its values; that of a constant
/// value is pi times it.
#[test]
fn tis_of_a_bright_sample_is_no_percentage() {
    let radials: Vec<String> = (0..=18).map(|k| (5 * k).to_string()).collect();
    for (value, says) in [(0.54, "above 1"), (0.0054, "is in per cent")] {
        let row = format!("{value} ").repeat(19);
        let text = format!(
            "Symmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\nSampleRotation 1\n0\nAngleOfIncidence 1\n0\n\
             ScatterAzimuth 3\n0 90 180\nScatterRadial 19\n{}\nMonochrome\nDataBegin\nTIS {}\n{row}\n{row}\n{row}\nDataEnd\n",
            radials.join(" "),
            0.54 * std::f64::consts::PI
        );
        let read = read_bsdf(&file(text)).unwrap();
        assert!(read.warnings[0].contains(says), "{value}: {:?}", read.warnings);
    }
}

#[test]
fn file_with_huge_axes_or_a_huge_line_is_refused() {
    let angles = |count: usize, step: f64| {
        (0..count).map(|k| (k as f64 * step).to_string()).collect::<Vec<_>>().join(" ")
    };
    let axes = format!(
        "Symmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\nAngleOfIncidence 1000\n{}\n\
         ScatterAzimuth 1000\n{}\nScatterRadial 1000\n{}\nMonochrome\nDataBegin\n",
        angles(1000, 0.09),
        angles(1000, 0.18),
        angles(1000, 0.18)
    );
    assert!(matches!(refused_bsdf(axes).1, BsdfProblem::TooManyCells { .. }));
    let long = SMALL.replace("0 30", &"0 ".repeat(2 << 20));
    assert!(matches!(refused_bsdf(long), (Some((9, 1)), BsdfProblem::LongLine { .. })));
}
