//! Luminaires in EULUMDAT files, by the lines of the format.

use std::f64::consts::PI;

use papilio_formats::{DataFile, read_luminaire};

use crate::luminaires::Use::{Intensity, Note, Refused};
use crate::luminaires::{LUMINAIRE, read};

/// Planes C of a full circle in steps of 30 deg, and the intensity of a luminaire in each, at 0, 45 and 90
/// deg.
const STEP: usize = 30;

fn of_plane(symmetry: u8, plane: f64) -> f64 {
    let plane = plane.rem_euclid(360.0);
    let folded = match symmetry {
        0 => plane,
        1 => 0.0,
        2 => plane.min(360.0 - plane),
        3 => (plane - 90.0).rem_euclid(360.0).min(360.0 - (plane - 90.0).rem_euclid(360.0)),
        _ => {
            let half = plane.min(360.0 - plane);
            half.min(180.0 - half)
        }
    };
    100.0 + folded
}

/// A EULUMDAT file by the lines of the format (Stockmar 1990), one value each, in its order.
fn eulumdat(symmetry: u8) -> Vec<String> {
    let planes = 360 / STEP;
    let mut lines: Vec<String> = [
        "Maker",
        "2",
        &symmetry.to_string(),
        &planes.to_string(),
        "30",
        "3",
        "45",
        "report",
        "name",
        "number",
        "file",
        "date",
        // Luminaire, mm; luminous area: length, width, heights at C 0, 90, 180, 270.
        "1300",
        "320",
        "90",
        "1200",
        "300",
        "10",
        "20",
        "30",
        "40",
        // Downward fraction, output ratio, conversion factor, tilt, sets of lamps.
        "0",
        "0",
        "1",
        "0",
        "1",
        // The set: number, kind, lumens, colour, rendering, watts.
        "2",
        "T16",
        "5000",
        "840",
        "1B",
        "70",
    ]
    .map(str::to_owned)
    .to_vec();
    lines.extend((0..10).map(|k| format!("0.{k}")));
    lines.extend((0..planes).map(|k| (k * STEP).to_string()));
    lines.extend(["0", "45", "90"].map(str::to_owned));
    let stored: Vec<usize> = match symmetry {
        0 => (0..planes).collect(),
        1 => vec![0],
        2 => (0..=planes / 2).collect(),
        // From C = 270 deg over 0 to 90 deg.
        3 => (0..=planes / 2).map(|k| k + 3 * planes / 4).collect(),
        _ => (0..=planes / 4).collect(),
    };
    for plane in stored {
        let level = of_plane(symmetry, (plane * STEP) as f64);
        lines.extend([format!("{level}"), format!("{}", 0.5 * level), "0".to_owned()]);
    }
    lines
}

fn text(lines: &[String]) -> String {
    lines.join("\r\n") + "\r\n"
}

#[test]
fn each_symmetry_of_eulumdat_is_completed() {
    for symmetry in 0..=4 {
        let luminaire = read(&text(&eulumdat(symmetry))).unwrap();
        for plane in (0..360).step_by(STEP) {
            // cd/klm at 45 deg is half of the level; the lamps have 5000 lm.
            let wanted = 0.5 * of_plane(symmetry, f64::from(plane)) * 5.0;
            let found = luminaire.intensity(45.0, f64::from(plane));
            assert!((found - wanted).abs() < 1e-9, "{symmetry} {plane}: {found} {wanted}");
        }
        // Between the last plane and the first.
        let wanted = 2.5 * 0.5 * (of_plane(symmetry, 330.0) + of_plane(symmetry, 0.0));
        assert!((luminaire.intensity(45.0, 345.0) - wanted).abs() < 1e-9, "{symmetry}");
        assert!(luminaire.notes.is_empty(), "{:?}", luminaire.notes);
    }
}

/// Every line of EULUMDAT with another value: the intensity at 0, 0 of symmetry 0, 500 cd (100 cd/klm times
/// 5000 lm), with a note or none; or the reason of the refusal.
#[test]
fn each_line_of_eulumdat_is_used_or_named() {
    for (line, field, value, wanted) in [
        (1, "company", "", Intensity(500.0)),
        (2, "type of luminaire", "1", Intensity(500.0)),
        (3, "symmetry", "2", Refused("a number follows the last intensity")),
        (4, "number of planes", "13", Refused("expected ascending angles")),
        (5, "distance of planes", "0", Intensity(500.0)),
        (6, "angles of a plane", "4", Refused("ends before its last number")),
        (7, "distance of angles", "0", Intensity(500.0)),
        (8, "report", "", Intensity(500.0)),
        (9, "name", "Leuchte", Intensity(500.0)),
        (10, "number", "", Intensity(500.0)),
        (11, "file", "", Intensity(500.0)),
        (12, "date", "", Intensity(500.0)),
        (13, "length", "10", Intensity(500.0)),
        (14, "width", "10", Intensity(500.0)),
        (15, "height", "10", Intensity(500.0)),
        (16, "luminous length", "-10", Refused("expected a length from 0 to 1e6 mm")),
        (17, "luminous width", "", Intensity(500.0)),
        (18, "height at C 0", "1", Intensity(500.0)),
        (19, "height at C 90", "1", Intensity(500.0)),
        (20, "height at C 180", "1", Intensity(500.0)),
        (21, "height at C 270", "x", Refused("`x` is not a number")),
        (22, "downward fraction", "60", Note(500.0, "the file states 60 %, which is not used")),
        (23, "output ratio", "90", Note(500.0, "states a light output ratio of 90 %")),
        (24, "conversion factor", "1,1", Intensity(550.0)),
        (24, "conversion factor", "0", Refused("expected a number from 1e-9")),
        (25, "tilt", "15", Note(500.0, "tilted by 15 deg")),
        (26, "sets of lamps", "0", Refused("expected an integer from 1 to 20")),
        (27, "number of lamps, absolute", "-1", Intensity(500.0)),
        (28, "lamps", "LED", Intensity(500.0)),
        (29, "lumens", "4000", Intensity(400.0)),
        (29, "lumens", "0", Refused("expected a flux from 1e-9")),
        (30, "colour", "", Intensity(500.0)),
        (31, "rendering", "", Intensity(500.0)),
        (32, "power", "", Intensity(500.0)),
        (33, "direct ratio", "", Intensity(500.0)),
        (43, "first plane", "5", Refused("needs planes C that the file does not list")),
        (55, "first angle", "50", Refused("expected ascending angles")),
        (58, "intensity", "120,5", Intensity(602.5)),
        (58, "intensity", "-1", Refused("expected an intensity from 0 to 1e12")),
        (93, "last intensity", "0 7", Refused("a number follows the last intensity")),
        (93, "last intensity", "", Refused("ends before its last number")),
    ] {
        let mut lines = eulumdat(0);
        assert_eq!(lines.len(), 93);
        value.clone_into(&mut lines[line - 1]);
        match (read(&text(&lines)), wanted) {
            (Ok(found), Intensity(wanted)) => {
                assert!((found.intensity(0.0, 0.0) - wanted).abs() < 1e-9, "{line} {field}: {found:?}");
                assert!(found.notes.is_empty(), "{line} {field}: {:?}", found.notes);
            }
            (Ok(found), Note(wanted, note)) => {
                assert!((found.intensity(0.0, 0.0) - wanted).abs() < 1e-9, "{line} {field}: {found:?}");
                assert!(
                    found.notes.len() == 1 && found.notes[0].contains(note),
                    "{field}: {:?}",
                    found.notes
                );
            }
            (Err(error), Refused(wanted)) => {
                assert!(error.to_string().contains(wanted), "{line} {field}: {error}");
            }
            (found, _) => panic!("{line} {field}: {found:?}"),
        }
    }
}

#[test]
fn further_sets_of_lamps_are_named_and_the_first_counts() {
    let mut lines = eulumdat(4);
    "2".clone_into(&mut lines[25]);
    drop(lines.splice(32..32, ["1", "T16 HO", "8000", "830", "1B", "110"].map(str::to_owned)));
    let found = read(&text(&lines)).unwrap();
    assert!((found.intensity(0.0, 0.0) - 500.0).abs() < 1e-9);
    assert!(found.notes[0].contains("set 2 of lamps, of 8000 lm, is not used"), "{:?}", found.notes);
}

/// The length is across C = 0; sides count on the side from which they are seen; a width of 0 is a circle.
#[test]
fn luminous_area_of_eulumdat_is_the_opening() {
    let mut lines = eulumdat(4);
    let opening = read(&text(&lines)).unwrap().opening;
    assert_eq!((opening.along_m, opening.across_m, opening.height_m), (0.3, 1.2, [0.01, 0.02, 0.03, 0.04]));
    assert!((opening.seen_m2(0.0, 0.0) - 0.36).abs() < 1e-12);
    for (plane, wanted) in [(0.0, 1.2 * 0.01), (90.0, 0.3 * 0.02), (180.0, 1.2 * 0.03), (270.0, 0.3 * 0.04)] {
        assert!((opening.seen_m2(90.0, plane) - wanted).abs() < 1e-12, "{plane}");
    }
    "0".clone_into(&mut lines[16]);
    let round = read(&text(&lines)).unwrap().opening;
    assert!((round.seen_m2(0.0, 0.0) - PI * 0.36).abs() < 1e-12);
}

/// The flux of Lambertian light of 1 cd/klm at the nadir is pi lm/klm.
#[test]
fn flux_that_agrees_with_the_output_ratio_gives_no_note() {
    let mut lines = eulumdat(1);
    lines.truncate(42 + 12);
    "91".clone_into(&mut lines[5]);
    "1".clone_into(&mut lines[6]);
    "100".clone_into(&mut lines[21]);
    lines[22] = format!("{:.1}", 100.0 * 250.0 * PI / 1000.0);
    lines.extend((0..=90).map(|angle| angle.to_string()));
    lines.extend((0..=90).map(|angle| format!("{:.4}", 250.0 * f64::from(angle).to_radians().cos())));
    let found = read(&text(&lines)).unwrap();
    assert!(found.notes.is_empty(), "{:?}", found.notes);
    assert!((found.flux_lm()[0] / (1250.0 * PI) - 1.0).abs() < 1e-4);
}

/// What is missing from a file that ends in its first lines is said of EULUMDAT, not of the other format.
#[test]
fn file_that_is_cut_in_its_head_is_known_by_its_name() {
    let bytes = text(&eulumdat(1)[..5]).into_bytes();
    let error = read_luminaire(&DataFile { name: "data/lamp.LDT".into(), bytes }).unwrap_err().to_string();
    assert!(error.contains("EULUMDAT") && error.contains("cut off"), "{error}");
}

/// Files with arbitrary changes are read or refused.
#[test]
fn luminaire_with_changed_bytes_never_panics() {
    let mut dice = papilio_testing::Dice::new(5, 0);
    for good in [LUMINAIRE.to_owned(), text(&eulumdat(3)), text(&eulumdat(0))] {
        for _ in 0..papilio_testing::sized(300, 1500) {
            let mut bytes = good.clone().into_bytes();
            for _ in 0..1 + dice.below(4) {
                let at = dice.below(bytes.len());
                bytes[at] = b"0123456789-.,e \n\xe9"[dice.below(17)];
            }
            bytes.truncate(bytes.len() - dice.below(2) * dice.below(bytes.len()));
            let _ = read_luminaire(&DataFile { name: "lamp".into(), bytes });
        }
    }
}
