//! Binary files: MERL, RGL, and Papilio's own format.

use papilio_formats::{BsdfFormat, BsdfProblem, Problem, read_bsdf};
use papilio_goniometry::{Channel, Direction, ScatterMode};

use super::samples::{self, MATRIX, TREE_3, klems, merl, papilio, rgl, singles, tensors};
use super::{file, read, refused, refused_bsdf, written};

/// Centres of cells: in the mirror direction, theta_h = 0 and theta_d is the incidence; back to the light, theta_d = 0 and theta_h is
/// the incidence. At the seam of phi_d, the value is the mean of the first and the last cell.
#[test]
fn merl_cell_is_found_by_its_index() {
    let measurement = read(merl());
    let part = &measurement.parts[0];
    assert_eq!(
        (part.way, part.channels.as_slice()),
        (ScatterMode::FrontReflection, [Channel::Red, Channel::Green, Channel::Blue].as_slice())
    );
    assert!(part.values[0].is_nan(), "negative: not measured");
    let light = Direction::new(30.5, 0.0);
    let number = |f: Option<f64>| f.unwrap() * 1500.0;
    let found = number(part.evaluate(0, light, light.specular()));
    assert!((found - (30.0 * 180.0 + 89.5)).abs() < 1e-3, "{found}");
    let both = Direction::new(90.0 * f64::powi(60.5 / 90.0, 2), 77.0);
    let found = number(part.evaluate(0, both, both));
    assert!((found - (60.0 * 90.0 * 180.0 + 89.5)).abs() < 1e-3, "{found}");
    let green = part.evaluate(1, both, both).unwrap() / part.evaluate(0, both, both).unwrap();
    let blue = part.evaluate(2, both, both).unwrap() / part.evaluate(0, both, both).unwrap();
    assert!((green - 1.15).abs() < 1e-12 && (blue - 1.66).abs() < 1e-12);
}

#[test]
fn merl_file_of_the_wrong_length_is_refused() {
    let whole = merl();
    assert!(matches!(refused_bsdf(&whole[..whole.len() - 1]).1, BsdfProblem::Ends { .. }));
    assert!(matches!(refused_bsdf([&whole[..], &[0]].concat()).1, BsdfProblem::Count { .. }));
    let mut nan = whole;
    let end = nan.len();
    nan[end - 8..].copy_from_slice(&f64::NAN.to_le_bytes());
    assert!(matches!(refused(nan).1, Problem::NotFinite { .. }));
}

/// The worked direction of the geometry's tests: 1/9 x 3/(4 x 0.5) / cos 50 deg; the value of the other
/// wavelength is 5.
#[test]
fn rgl_value_agrees_with_the_definition_of_its_authors() {
    let measurement = read(rgl());
    let part = &measurement.parts[0];
    assert_eq!(part.channels, [Channel::Wavelength(500.0), Channel::Wavelength(600.0)]);
    assert_eq!(measurement.provenance.sample, "film");
    let (i, o) = (Direction::new(30.0, 0.0), Direction::new(50.0, 180.0));
    let cos = 50_f64.to_radians().cos();
    for (channel, value) in [(0, 1.0 / 9.0), (1, 5.0)] {
        let f = part.evaluate(channel, i, o).unwrap();
        assert!((f / (value * 1.5 / cos) - 1.0).abs() < 1e-6, "{f}");
    }
}

#[test]
fn inconsistent_rgl_file_is_refused() {
    let whole = rgl();
    for length in [14, 17, 30, 200, whole.len() - 1] {
        assert!(matches!(refused_bsdf(&whole[..length]).1, BsdfProblem::Ends { .. }), "{length}");
    }
    let mut huge = whole.clone();
    // The shape of `phi_i`: after the header, the entry `description` (32 bytes), and its own name, type and
    // offset.
    let at = 18 + 32 + 2 + 5 + 2 + 1 + 8;
    huge[at..at + 8].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(matches!(refused_bsdf(&huge).1, BsdfProblem::Ends { .. }));
    let negative = tensors(&[
        ("spectra", 10, &[1, 1, 1, 2, 2], singles(&[-1.0; 4])),
        ("wavelengths", 10, &[1], singles(&[500.0])),
    ]);
    assert_eq!(refused_bsdf(negative).1, BsdfProblem::Missing { what: "phi_i" });
}

#[test]
fn papilio_file_reads_back_without_loss() {
    let tree = [("Visible", "Transmission Front", TREE_3), ("CIE-X", "Transmission Front", "{3}")];
    let two_ways = [("Solar", "Reflection Front", MATRIX), ("CIE-X", "Transmission Back", MATRIX)];
    let texts = [
        samples::RADIANT.to_owned(),
        samples::RADIANT.replace("PlaneSymmetrical", "Asymmetrical"),
        samples::ASTM.to_owned(),
        samples::TABLE.replace("450,\n", "450,4\n"),
        klems("TensorTree3", &tree),
        klems("Rows", &two_ways),
    ];
    for (bytes, index) in
        texts.into_iter().map(String::into_bytes).chain([rgl()]).zip([1.0, 1.5].into_iter().cycle())
    {
        let mut measurement = read(bytes);
        measurement.media[1] = index;
        let (bytes, lost) = written(BsdfFormat::Papilio, &measurement);
        assert_eq!((read(&bytes), lost), (measurement, Vec::new()));
    }
}

/// Compares bits, because NaN does not equal itself.
#[test]
fn papilio_file_preserves_missing_values() {
    let measurement = read(samples::TABLE);
    let again = read(written(BsdfFormat::Papilio, &measurement).0);
    let bits = |measurement: &papilio_goniometry::Measurement| {
        measurement.parts[0].values.iter().map(|v| v.to_bits()).collect::<Vec<_>>()
    };
    assert_eq!(bits(&measurement), bits(&again));
}

#[test]
fn damaged_papilio_file_is_refused() {
    let whole = papilio();
    for length in [4, 100, whole.len() / 2, whole.len() - 1] {
        assert!(matches!(refused_bsdf(&whole[..length]).1, BsdfProblem::Damaged { .. }), "{length}");
    }
}

#[test]
fn loss_of_information_is_reported() {
    let warped = read(rgl());
    let (bytes, lost) = written(BsdfFormat::Radiant, &warped);
    assert!(lost.iter().any(|line| line.contains("interpolated")), "{lost:?}");
    assert!(lost.iter().any(|line| line.contains("500")), "the other wavelength: {lost:?}");
    assert_eq!(read(&bytes).parts[0].channels, [Channel::Monochrome]);
    let csv = papilio_formats::write_measurement(Vec::new(), BsdfFormat::Csv, &warped);
    assert_eq!(csv.unwrap_err().to_string(), "CSV cannot hold a warped grid");
}

/// Cells of the file are [theta_i][theta_o][dphi][wavelength]. Light from 10 deg and a viewer at 20 deg, 180
/// deg of azimuth apart, are the last cell.
#[test]
fn bsdf_of_a_display_is_read_as_its_first_state() {
    let read = read_bsdf(&file(samples::display())).unwrap();
    let part = &read.value.parts[0];
    assert_eq!(part.channels, [Channel::Wavelength(500.0), Channel::Wavelength(600.0)]);
    let (light, viewer) = (Direction::new(10.0, 70.0), Direction::new(20.0, 250.0));
    assert_eq!((part.evaluate(0, light, viewer), part.evaluate(1, light, viewer)), (Some(22.0), Some(23.0)));
    assert_eq!(part.evaluate(0, Direction::new(10.0, 0.0), Direction::new(0.0, 0.0)), Some(12.0));
    assert_eq!(read.value.provenance.sample, "panel (white)");
    assert!(read.warnings.iter().any(|line| line.contains("`white`")), "{:?}", read.warnings);
}
