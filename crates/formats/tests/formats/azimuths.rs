//! Pixel tables with azimuths: half a turn in equal steps, means, notes and refusals.

use papilio_formats::{DataFile, PixelTable, Warned, read_pixel_over_half_turn, read_pixel_table};

const HEAD: &str = "state,theta_deg,phi_deg,wavelength_nm,reflectance";

fn file(text: &str) -> DataFile {
    DataFile { name: "data.csv".to_owned(), bytes: text.as_bytes().to_vec() }
}

/// A table of one state at 0 and 60 deg, and 400 and 500 nm, with this reflectance at 60 deg; 0.3 along the normal at one azimuth.
fn table(phi_deg: &[f64], of: impl Fn(f64) -> f64) -> String {
    let mut text = format!("{HEAD}\nwhite,0,0,400,0.3\nwhite,0,0,500,0.3\n");
    for phi in phi_deg {
        for nm in [400, 500] {
            text += &format!("white,60,{phi},{nm},{:.5}\n", of(*phi));
        }
    }
    text
}

fn wave(phi_deg: f64) -> f64 {
    0.4 + 0.2 * (2.0 * (phi_deg - 20.0)).to_radians().cos()
}

fn steps(first: f64, step: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| first + step * k as f64).collect()
}

fn read(text: &str) -> Warned<PixelTable> {
    read_pixel_over_half_turn(&file(text)).unwrap()
}

fn wrong(text: &str) -> String {
    read_pixel_over_half_turn(&file(text)).unwrap_err().to_string()
}

#[test]
fn half_a_turn_is_that_of_a_whole_turn_in_any_order() {
    let half = read(&table(&steps(0.0, 30.0, 6), wave));
    assert!(half.warnings.is_empty(), "{:?}", half.warnings);
    let half = half.value;
    assert_eq!((&half.phi_deg[..], half.states[0].1.len()), (&steps(0.0, 30.0, 6)[..], 24));
    assert!(half.states[0].1[..12].iter().all(|r| *r == 0.3));
    for phi in [
        steps(0.0, 30.0, 12),
        // Both ends.
        steps(0.0, 30.0, 13),
        steps(-180.0, 30.0, 7),
        steps(-360.0, 30.0, 6),
        steps(330.0, -30.0, 12),
        // Half of them beyond 180 deg.
        vec![0.0, 210.0, 60.0, 270.0, 120.0, 330.0],
    ] {
        let read = read(&table(&phi, wave));
        assert!(read.warnings.is_empty(), "{phi:?}: {:?}", read.warnings);
        let (found, expected) = (&read.value.states[0].1, &half.states[0].1);
        let places = read.value.phi_deg.iter().map(|phi| phi.rem_euclid(180.0) / 30.0);
        for (k, place) in places.enumerate() {
            let at = place.round() as usize % 6;
            assert!((found[12 + 2 * k] - expected[12 + 2 * at]).abs() < 1e-12, "{phi:?}");
        }
    }
}

#[test]
fn names_and_units_of_azimuths_are_those_of_other_tables() {
    let degrees = table(&steps(0.0, 22.5, 8), wave);
    let expected = read(&degrees).value;
    for name in ["azimuth", "phi (deg)", "PHI / deg", "phi_o [deg]"] {
        let renamed = degrees.replace("phi_deg", name);
        assert_eq!(read(&renamed).value, expected, "{name}");
    }
    let radians = degrees.lines().skip(1).map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let phi: f64 = cells[2].parse().unwrap();
        format!("{:.3},{},{},{},{}", phi.to_radians(), cells[0], cells[1], cells[3], cells[4])
    });
    let radians: Vec<String> = radians.collect();
    let found =
        read(&format!("phi_rad,state,theta_deg,wavelength_nm,reflectance\n{}\n", radians.join("\n"))).value;
    assert_eq!(found.states, expected.states);
    assert!(found.phi_deg.iter().zip(&expected.phi_deg).all(|(a, b)| (a - b).abs() < 0.05), "{found:?}");
    let light = degrees.replace("phi_deg", "phi_i");
    assert!(wrong(&light).contains("the azimuth of the light"), "{}", wrong(&light));
}

/// A table with azimuths reads back, and one that is the same at all azimuths has none.
#[test]
fn tables_with_azimuths_read_back() {
    let whole = read_pixel_table(&file(&table(&steps(0.0, 30.0, 12), wave))).unwrap();
    assert_eq!((whole.phi_deg.len(), whole.states[0].1.len()), (12, 48));
    let mut bytes = Vec::new();
    whole.write(&mut bytes).unwrap();
    assert!(bytes.starts_with(HEAD.as_bytes()));
    assert_eq!(read_pixel_table(&DataFile { name: "again".to_owned(), bytes }).unwrap(), whole);
    let round = read(&table(&steps(0.0, 30.0, 12), |_| 0.4)).value;
    assert_eq!((round.phi_deg.len(), &round.states[0].1[..]), (0, &[0.3, 0.3, 0.4, 0.4][..]));
}

/// What breaks reciprocity by little is averaged, with a note of its size and place; by more than 10 % it is refused. So is it along the normal.
#[test]
fn opposite_azimuths_are_averaged_or_refused() {
    let apart =
        |more: f64| table(&steps(0.0, 30.0, 12), |phi| wave(phi) + if phi == 210.0 { more } else { 0.0 });
    let averaged = read(&apart(0.02));
    assert_eq!(averaged.warnings.len(), 1);
    let note = &averaged.warnings[0];
    assert!(
        note.contains("differ by up to 0.02 (state `white` at 60 deg and 400 nm): their mean is used"),
        "{note}"
    );
    assert!((averaged.value.states[0].1[14] - wave(30.0) - 0.01).abs() < 1e-5);
    let said = wrong(&apart(0.08));
    let part =
        "state `white` at 60 deg and 400 nm has reflectances from 0.58794 to 0.66794 at opposite azimuths";
    assert!(said.contains(part), "{said}");
    let normal = |r: f64| {
        table(&[0.0, 60.0, 120.0, 150.0, 30.0, 90.0], wave).replacen(
            "white,0,0,400,0.3\nwhite,0,0,500,0.3\n",
            &(0..6)
                .map(|k| {
                    format!("white,0,{},400,{}\nwhite,0,{0},500,0.3\n", 30 * k, if k == 2 { r } else { 0.3 })
                })
                .collect::<String>(),
            1,
        )
    };
    assert!(read(&normal(0.3)).warnings.is_empty());
    assert!(read(&normal(0.306)).warnings[0].contains("those along the normal, differ by up to 0.006"));
    let said = wrong(&normal(0.2));
    assert!(
        said.contains("at 0 deg and 400 nm has reflectances from 0.2 to 0.3 at different azimuths"),
        "{said}"
    );
}

/// The last harmonic that the steps determine should be small.
#[test]
fn coarse_azimuths_give_a_note() {
    let notes = |count: usize, of: fn(f64) -> f64| {
        read(&table(&steps(0.0, 180.0 / count as f64, count), of)).warnings
    };
    assert_eq!(notes(4, wave), Vec::<String>::new());
    for (count, multiple) in [(2, 2), (3, 2)] {
        let found = notes(count, wave);
        assert!(
            found.len() == 1 && found[0].contains(&format!("of {multiple} times the azimuth")),
            "{found:?}"
        );
    }
    let sharp: fn(f64) -> f64 = |phi| 0.4 + 0.1 * (8.0 * phi).to_radians().cos();
    let found = notes(8, sharp);
    assert!(
        found[0].contains("steps of 22.5 deg") && found[0].contains("of 8 times the azimuth, is 0.1 "),
        "{found:?}"
    );
    assert_eq!(notes(12, sharp), Vec::<String>::new());
}

#[test]
fn malformed_azimuths_are_errors_with_their_place() {
    let good = table(&steps(0.0, 30.0, 6), wave);
    let hole = good.replace("white,60,90,500,0.24679\n", "");
    assert_ne!(hole, good);
    let said = wrong(&hole);
    assert!(said.contains("state `white` has no row for 60 deg, azimuth 90 deg and 500 nm"), "{said}");
    // Along the normal: one azimuth, or all.
    let two = good.replace(HEAD, &format!("{HEAD}\nwhite,0,30,400,0.3\nwhite,0,30,500,0.3"));
    assert!(wrong(&two).contains("no row for 0 deg, azimuth 60 deg and 400 nm"), "{}", wrong(&two));
    let twice = format!("{good}white,60,30,500,0.4\n");
    assert!(wrong(&twice).contains("state `white` at 60 deg, azimuth 30 deg and 500 nm has two rows"));
    let far = good.replace("white,60,150,", "white,60,1500,");
    assert!(wrong(&far).contains("an azimuth") && wrong(&far).contains("-360 to 360 deg"), "{}", wrong(&far));
    for phi in [
        vec![0.0, 30.0, 60.0, 90.0],
        vec![0.0, 45.0, 90.0, 120.0],
        vec![0.0, 30.0, 40.0, 60.0, 90.0, 120.0, 150.0],
    ] {
        let said = wrong(&table(&phi, wave));
        assert!(
            said.contains("are not in equal steps") && said.contains(&format!("{}, {}", phi[0], phi[1])),
            "{said}"
        );
    }
    for phi in [vec![30.0], vec![30.0, 210.0]] {
        assert!(wrong(&table(&phi, wave)).contains("one azimuth only"), "{phi:?}");
    }
    let said = wrong(&table(&steps(0.0, 0.25, 720), wave));
    assert!(said.contains("720 azimuths over half a turn") && said.contains("at most 360"), "{said}");
    // Many azimuths that few rows have, and many wavelengths along the normal.
    let sparse: String =
        (0..3000).map(|k| format!("white,0,0,{},0.3\nwhite,60,0.{k:04},400,0.3\n", 400 + k)).collect();
    let said = wrong(&format!("{HEAD}\n{sparse}"));
    assert!(said.contains("state `white` has no row for 0 deg, azimuth 0.0001 deg and 400 nm"), "{said}");
    // A row that is too short.
    let short = good.replace("white,60,0,400,0.55321", "white,60,0,400");
    assert_ne!(short, good);
    assert!(wrong(&short).contains("five columns"), "{}", wrong(&short));
}
