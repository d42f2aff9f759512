//! Luminaires in IES LM-63 files of all editions, by the list of fields of the standard.

use papilio_formats::{DataFile, FormatError, Luminaire, OpeningShape, is_luminaire, read_luminaire};

pub(crate) fn read(text: &str) -> Result<Luminaire, FormatError> {
    read_luminaire(&DataFile { name: "lamp.ies".into(), bytes: text.as_bytes().to_vec() })
}

pub(crate) const LUMINAIRE: &str = "IESNA:LM-63-2002\n[TEST] synthetic\nTILT=NONE\n1 1000 2 3 2 1 2 0.6 0.6 0\n0.5 1 30\n\
    0 45 90\n0 90\n100 80 0\n100 40 0\n";

/// What is done with a field.
pub(crate) enum Use {
    /// The intensity at 0, 0 is this, without a note.
    Intensity(f64),
    /// The same with a note.
    Note(f64, &'static str),
    /// The file is refused with this reason.
    Refused(&'static str),
}
use Use::{Intensity, Note, Refused};

/// Every field of LM-63 (1986, 1991, 1995, 2002, 2019): the text of the file is changed in one place. The
/// unchanged file has 100 cd at 0, 0: 100 times the multiplier 2 and the ballast factor 0.5.
#[test]
fn each_field_of_lm_63_is_used_or_named() {
    let edition = |name: &'static str| ("IESNA:LM-63-2002", name);
    let not_one = ("0.5 1 30", "0.5 0.9 30");
    for (field, changes, wanted) in [
        ("edition 2002", vec![], Intensity(100.0)),
        ("edition 2019", vec![edition("IES:LM-63-2019"), ("0.5 1 30", "0.5 1.1 30")], Intensity(100.0)),
        ("edition unknown", vec![edition("IES:LM-63-2031")], Note(100.0, "IES:LM-63-2031, is not known")),
        ("keyword NEARFIELD", vec![("[TEST]", "[NEARFIELD]")], Note(100.0, "meant for near distances")),
        ("keyword MORE", vec![("synthetic\n", "synthetic\n[MORE] and more\n")], Intensity(100.0)),
        ("keywords of the user", vec![("[TEST]", "[_MINE]")], Intensity(100.0)),
        (
            "TILT=INCLUDE",
            vec![("TILT=NONE", "TILT=INCLUDE\n1\n3\n0 45 90\n0.9 0.8 0.7")],
            Note(90.0, "factor of its light is 0.9"),
        ),
        (
            "TILT of a lamp that turns",
            vec![("TILT=NONE", "TILT=INCLUDE\n3 2 0 90 1 0.7")],
            Note(100.0, "is 1;"),
        ),
        ("TILT geometry", vec![("TILT=NONE", "TILT=INCLUDE\n4 2 0 90 1 0.7")], Refused("expected 1, 2 or 3")),
        ("TILT=file", vec![("TILT=NONE", "TILT=mh400.tlt")], Note(100.0, "TILT=mh400.tlt is not read")),
        ("number of lamps", vec![("\n1 1000", "\n2 1000")], Intensity(100.0)),
        ("lumens per lamp, absolute", vec![("\n1 1000", "\n1 -1")], Intensity(100.0)),
        ("multiplier", vec![("1000 2 3", "1000 4 3")], Intensity(200.0)),
        ("multiplier of nothing", vec![("1000 2 3", "1000 0 3")], Refused("expected a number from 1e-9")),
        ("vertical angles", vec![("2 3 2 1 2", "2 4 2 1 2")], Refused("ascending angles")),
        (
            "horizontal angles",
            vec![("2 3 2 1 2", "2 3 1 1 2")],
            Refused("a number follows the last intensity"),
        ),
        (
            "photometric type",
            vec![("2 3 2 1 2", "2 3 2 4 2")],
            Refused("expected 1 (type C), 2 (type B) or 3 (type A)"),
        ),
        ("units", vec![("2 3 2 1 2", "2 3 2 1 3")], Refused("expected 1 (feet) or 2 (metres)")),
        ("opening", vec![("0.6 0.6 0", "0 -0.6 0")], Refused("signs that no edition of LM-63 defines")),
        ("ballast factor", vec![("0.5 1 30", "0.25 1 30")], Intensity(50.0)),
        ("ballast-lamp factor, 1986", vec![("IESNA:LM-63-2002\n", ""), not_one], Intensity(90.0)),
        ("ballast-lamp factor, 1991", vec![edition("IESNA91"), not_one], Intensity(90.0)),
        ("ballast-lamp factor, 1995", vec![edition("IESNA:LM-63-1995"), not_one], Intensity(90.0)),
        ("reserved, 2002", vec![not_one], Note(100.0, "0.9, is not used")),
        (
            "generation, 2019, simulated",
            vec![edition("IES:LM-63-2019"), ("0.5 1 30", "0.5 1.00010 30")],
            Note(100.0, "simulated"),
        ),
        (
            "generation, 2019, scaled",
            vec![edition("IES:LM-63-2019"), ("0.5 1 30", "0.5 1.11100 30")],
            Note(100.0, "interpolated, scaled in flux"),
        ),
        (
            "generation, 2019, unknown",
            vec![edition("IES:LM-63-2019"), ("0.5 1 30", "0.5 3 30")],
            Note(100.0, "is not one of LM-63-2019"),
        ),
        ("input power", vec![("0.5 1 30", "0.5 1 60")], Intensity(100.0)),
        ("candela values", vec![("100 40 0", "100 -40 0")], Refused("expected an intensity from 0 to 1e12")),
        ("fewer values", vec![("100 40 0\n", "100")], Refused("ends before its last number")),
        ("more values", vec![("100 40 0\n", "100 40 0 7\n")], Refused("a number follows the last intensity")),
        ("commas between values", vec![("100 40 0", "100, 40,0")], Intensity(100.0)),
        ("line ends of DOS", vec![("\n", "\r\n")], Intensity(100.0)),
        ("no TILT", vec![("TILT=NONE\n", "")], Refused("there is no line `TILT=NONE`")),
        ("words among values", vec![("100 40 0", "100 forty 0")], Refused("`forty` is not a number")),
    ] {
        let text = changes.iter().fold(LUMINAIRE.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{field}: {from}");
            text.replace(from, to)
        });
        match (read(&text), wanted) {
            (Ok(found), Intensity(wanted)) => {
                assert!((found.intensity(0.0, 0.0) - wanted).abs() < 1e-12, "{field}: {found:?}");
                assert!(found.notes.is_empty(), "{field}: {:?}", found.notes);
            }
            (Ok(found), Note(wanted, note)) => {
                assert!((found.intensity(0.0, 0.0) - wanted).abs() < 1e-12, "{field}: {found:?}");
                assert!(
                    found.notes.len() == 1 && found.notes[0].contains(note),
                    "{field}: {:?}",
                    found.notes
                );
            }
            (Err(error), Refused(wanted)) => assert!(error.to_string().contains(wanted), "{field}: {error}"),
            (found, _) => panic!("{field}: {found:?}"),
        }
    }
}

#[test]
fn intensity_between_angles_is_linear_and_symmetric() {
    let luminaire = read(LUMINAIRE).unwrap();
    assert_eq!(luminaire.intensity(0.0, 12.0), 100.0);
    assert_eq!(luminaire.intensity(45.0, 0.0), 80.0);
    // The file holds one quadrant, which is mirrored into the others.
    for turn in [45.0, 135.0, 225.0, 315.0, -45.0] {
        assert!((luminaire.intensity(22.5, turn) - 80.0).abs() < 1e-12, "{turn}");
    }
    assert_eq!(luminaire.intensity(91.0, 0.0), 0.0);
}

/// Area that a convex body covers, seen from a direction, by rays on a fine grid.
fn shadow(inside: impl Fn([f64; 3]) -> bool, [vertical, horizontal]: [f64; 2], reach: f64) -> f64 {
    let ((sin, cos), (s, c)) = (f64::to_radians(vertical).sin_cos(), f64::to_radians(horizontal).sin_cos());
    let towards = [sin * c, sin * s, cos];
    let (right, up) = ([-s, c, 0.0], [cos * c, cos * s, -sin]);
    let steps = 60;
    let at = |k: f64, n: i32| reach * (2.0 * k / f64::from(n) - 1.0);
    // A grid whose rays are shifted by row and column, so that straight edges do not fall between them.
    let shifted = |k: i32, by: i32| f64::from(k) + (f64::from(by) * 0.618_033_988_749_894_9).fract();
    let mut hits = 0;
    for i in 0..steps {
        for j in 0..steps {
            let (a, b) = (at(shifted(i, j), steps), at(shifted(j, 3 * i + 1), steps));
            let on_ray = |d: f64| std::array::from_fn(|k| a * right[k] + b * up[k] + d * towards[k]);
            hits += i32::from((0..200).any(|k| inside(on_ray(at(f64::from(k) + 0.5, 200)))));
        }
    }
    f64::from(hits) * (2.0 * reach / f64::from(steps)).powi(2)
}

/// Every shape of the editions (LM-63, table of luminous openings; its signs as also read by other programs),
/// and the area under which it appears, against rays through the body.
#[test]
fn each_shape_of_the_opening_appears_as_the_body_it_is() {
    use OpeningShape::{Box, CylinderAcross, CylinderAlong, Ellipsoid, Point, VerticalCylinder};
    let ball = |x: f64, y: f64| x * x + y * y <= 0.25;
    // Width, length, height; sides along C = 0, across, up. Flat shapes are bodies of nearly no height.
    for (editions, sides, shape, size) in [
        ("86 91 95 02 19", "0 0 0", Point, [0.0; 3]),
        ("86 91 95 02 19", "0.6 1.2 0", Box, [1.2, 0.6, 0.0]),
        ("86 91 95 02 19", "0.6 1.2 0.3", Box, [1.2, 0.6, 0.3]),
        ("86 91 95 02 19", "-0.8 0 0", VerticalCylinder, [0.8, 0.8, 0.0]),
        ("02 19", "-0.8 -0.8 0", VerticalCylinder, [0.8, 0.8, 0.0]),
        ("02 19", "-0.6 -1.2 0", VerticalCylinder, [1.2, 0.6, 0.0]),
        ("86 91", "-0.6 1.2 0", VerticalCylinder, [1.2, 0.6, 0.0]),
        ("86 91 95", "-0.8 0 0.3", VerticalCylinder, [0.8, 0.8, 0.3]),
        ("02 19", "-0.6 -1.2 0.3", VerticalCylinder, [1.2, 0.6, 0.3]),
        ("95", "-0.6 1.2 0.3", VerticalCylinder, [1.2, 0.6, 0.3]),
        ("02 19", "-0.8 -0.8 -0.8", Ellipsoid, [0.8, 0.8, 0.8]),
        ("95", "-0.8 0 -0.8", Ellipsoid, [0.8, 0.8, 0.8]),
        ("02 19", "-0.6 -1.2 -0.9", Ellipsoid, [1.2, 0.6, 0.9]),
        ("86 91", "-0.6 1.2 0.9", Ellipsoid, [1.2, 0.6, 0.9]),
        ("95", "-0.6 1.2 -0.9", Ellipsoid, [1.2, 0.6, 0.9]),
        ("95", "0 1.2 -0.4", CylinderAlong, [1.2, 0.4, 0.4]),
        ("02 19", "-0.6 1.2 -0.4", CylinderAlong, [1.2, 0.6, 0.4]),
        ("95", "1.2 0 -0.4", CylinderAcross, [0.4, 1.2, 0.4]),
        ("02 19", "1.2 -0.6 -0.4", CylinderAcross, [0.6, 1.2, 0.4]),
        ("02 19", "-0.8 0 -0.8", CylinderAlong, [0.0, 0.8, 0.8]),
        ("02 19", "-0.8 0 -0.5", CylinderAlong, [0.0, 0.8, 0.5]),
    ] {
        for edition in editions.split(' ') {
            let first = match edition {
                "86" => "",
                "91" => "IESNA91\n",
                "95" => "IESNA:LM-63-1995\n",
                "02" => "IESNA:LM-63-2002\n",
                _ => "IES:LM-63-2019\n",
            };
            let text = LUMINAIRE.replace("IESNA:LM-63-2002\n", first).replace("0.6 0.6 0", sides);
            let opening = read(&text).unwrap().opening;
            assert_eq!(opening.shape, shape, "{edition}: {sides}");
            let found = [opening.along_m, opening.across_m, opening.height_m[0]];
            assert_eq!(found, size, "{edition}: {sides}");
            // Feet.
            let feet = read(&text.replace("2 3 2 1 2", "2 3 2 1 1")).unwrap().opening;
            assert!((feet.along_m - 0.3048 * size[0]).abs() < 1e-12, "{edition}: {sides}");
        }
        let text = LUMINAIRE.replace("0.6 0.6 0", sides);
        let first = if editions.contains("02") {
            "IESNA:LM-63-2002"
        } else if editions.contains("95") {
            "IESNA:LM-63-1995"
        } else {
            "IESNA91"
        };
        let opening = read(&text.replace("IESNA:LM-63-2002", first)).unwrap().opening;
        let inside = |p: [f64; 3]| {
            let [x, y, z]: [f64; 3] = std::array::from_fn(|k| p[k] / size[k].max(0.009));
            let within = |x: f64| x.abs() <= 0.5;
            match shape {
                Point => false,
                Box => within(x) && within(y) && within(z),
                VerticalCylinder => ball(x, y) && within(z),
                CylinderAlong => ball(y, z) && within(x),
                CylinderAcross => ball(x, z) && within(y),
                Ellipsoid => x * x + y * y + z * z <= 0.25,
            }
        };
        for direction in [[0.0, 0.0], [50.0, 20.0], [80.0, 100.0]] {
            let (found, wanted) =
                (opening.seen_m2(direction[0], direction[1]), shadow(inside, direction, 0.8));
            assert!((found - wanted).abs() < 0.03, "{sides} {direction:?}: {found} {wanted}");
        }
    }
}

/// Intensities at 45 deg from the nadir by plane, and those of the planes that symmetry adds.
#[test]
fn each_symmetry_of_the_horizontal_angles_is_completed() {
    for (angles, wanted) in [
        ("0", [10.0, 10.0, 10.0, 10.0]),
        ("0 90", [10.0, 20.0, 10.0, 20.0]),
        ("0 90 180", [10.0, 20.0, 30.0, 20.0]),
        ("90 180 270", [20.0, 10.0, 20.0, 30.0]),
        ("0 90 180 270 360", [10.0, 20.0, 30.0, 40.0]),
        ("0 90 180 270", [10.0, 20.0, 30.0, 40.0]),
        ("0 45 180 315", [10.0, 20.0 + 10.0 / 3.0, 30.0, 30.0 + 20.0 / 3.0]),
    ] {
        let count = angles.split(' ').count();
        let levels = [10.0, 20.0, 30.0, 40.0, 10.0];
        let rows: String = levels[..count].iter().map(|level| format!("{level} {level}\n")).collect();
        let text = format!("TILT=NONE\n1 -1 1 2 {count} 1 2 0 0 0\n1 1 30\n0 90\n{angles}\n{rows}");
        let luminaire = read(&text).unwrap();
        for (turn, wanted) in [0.0, 90.0, 180.0, 270.0].into_iter().zip(wanted) {
            assert!((luminaire.intensity(45.0, turn) - wanted).abs() < 1e-12, "{angles}: {turn}");
        }
    }
    // Directions beyond the last angle would be guessed.
    for angles in ["0 60", "10 90", "90 180", "0 270", "0 90 200", "0 90 300"] {
        let count = angles.split(' ').count();
        let rows = "1 1 ".repeat(count);
        let text = format!("TILT=NONE\n1 -1 1 2 {count} 1 2 0 0 0\n1 1 30\n0 90\n{angles}\n{rows}\n");
        assert!(read(&text).unwrap_err().to_string().contains("none of the symmetries of type C"));
    }
}

/// A beam about a direction, written in types A, B and C at their own angles, has the same intensities
/// everywhere; the angles of each type are those of CIE 121 and LM-63, written out here as unit vectors.
#[test]
fn types_a_and_b_have_the_intensities_of_type_c() {
    let unit = |[x, y, z]: [f64; 3]| [x, y, z].map(|part| part / (x * x + y * y + z * z).sqrt());
    // Along C = 0, along C = 90, down: to the right (C = 270) and below the horizon.
    let aim = unit([0.7, -0.45, 0.55]);
    let of = |d: [f64; 3]| 1000.0 * (d[0] * aim[0] + d[1] * aim[1] + d[2] * aim[2]).max(0.0).powi(8);
    let radians = |angle: f64| angle.to_radians().sin_cos();
    let type_a = |v: f64, h: f64| {
        let ((sv, cv), (sh, ch)) = (radians(v), radians(h));
        [cv * ch, -cv * sh, -sv]
    };
    let type_b = |v: f64, h: f64| {
        let ((sv, cv), (sh, ch)) = (radians(v), radians(h));
        [ch * sv, -sh, ch * cv]
    };
    let type_c = |v: f64, h: f64| {
        let ((sv, cv), (sh, ch)) = (radians(v), radians(h));
        [sv * ch, sv * sh, cv]
    };
    let file = |number: u8, verticals: Vec<f64>, horizontals: Vec<f64>, at: &dyn Fn(f64, f64) -> [f64; 3]| {
        let join = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
        let rows: String = horizontals
            .iter()
            .map(|h| join(&verticals.iter().map(|v| of(at(*v, *h))).collect::<Vec<_>>()) + "\n")
            .collect();
        let text = format!(
            "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {} {} {number} 2 0 0 0\n1 1 30\n{}\n{}\n{rows}",
            verticals.len(),
            horizontals.len(),
            join(&verticals),
            join(&horizontals)
        );
        read(&text).unwrap()
    };
    let half = || (-90..=90).step_by(2).map(f64::from).collect::<Vec<_>>();
    let a = file(3, half(), half(), &type_a);
    let b = file(2, half(), half(), &type_b);
    let c = file(
        1,
        (0..=180).step_by(2).map(f64::from).collect(),
        (0..=360).step_by(2).map(f64::from).collect(),
        &type_c,
    );
    let right_half = file(2, half(), (0..=90).step_by(2).map(f64::from).collect(), &type_b);
    for vertical in [20.0, 47.0, 63.0, 88.0, 110.0] {
        for horizontal in [0.0, 33.0, 271.0, 300.0, 328.0, 350.0] {
            let wanted = of(type_c(vertical, horizontal));
            for (name, luminaire, covers) in [("A", &a, true), ("B", &b, vertical < 90.0), ("C", &c, true)] {
                let found = luminaire.intensity(vertical, horizontal);
                let is_covered = covers && !(90.0..270.0).contains(&horizontal);
                assert!(
                    !is_covered || (found - wanted).abs() < 3.0,
                    "{name} {vertical} {horizontal}: {found} {wanted}"
                );
            }
            // Angles from 0 to 90 deg are symmetric about the plane C = 0.
            let mirrored = right_half.intensity(vertical, 360.0 - horizontal);
            assert!((right_half.intensity(vertical, horizontal) - mirrored).abs() < 1e-9);
        }
    }
    let text = "TILT=NONE\n1 -1 1 2 2 3 2 0 0 0\n1 1 30\n-90 90\n0 60\n1 1 1 1\n";
    assert!(read(text).unwrap_err().to_string().contains("none of the symmetries of types A and B"));
}

#[test]
fn header_in_latin_1_is_read() {
    let mut bytes = LUMINAIRE.as_bytes().to_vec();
    let at = LUMINAIRE.find("synthetic").unwrap();
    bytes[at] = 0xe9;
    let file = DataFile { name: "lamp.ies".into(), bytes };
    assert!(is_luminaire(&file));
    assert_eq!(read_luminaire(&file).unwrap(), read(LUMINAIRE).unwrap());
}
