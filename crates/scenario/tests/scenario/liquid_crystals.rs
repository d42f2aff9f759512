//! `model = "liquid-crystal"`: what it resolves to, and what is refused.

use std::path::Path;

use crate::common::resolve;
use papilio_display::scene::{CrystalPixel, CrystalSlice, Pixel};
use papilio_testing::Dice;

const GOOD: &str = r#"[spectrum]
range_nm = [400, 700]
step_nm = 50

[display.pixel]
model = "liquid-crystal"
substrate = "Al"
stack = [
  { kind = "polariser", axis_deg = 10, transmittance = 0.44, extinction = 1e-4 },
  { kind = "retarder", axis_deg = 75, retardance_nm = 275, dispersion = 1.1, nz = 0.5 },
  { kind = "retarder", plate = "C", retardance_nm = -100 },
  { kind = "retarder", plate = "O", axis_deg = 20, tilt_deg = 30, retardance_nm = 50 },
  { kind = "slab", material = 1.52 },
  { kind = "cholesteric", pitch_nm = 350, handedness = "left", n_o = 1.5, n_e = 1.65, thickness_um = 0.7 },
  { kind = "film", material = "ITO", thickness_nm = 30 },
  { kind = "cell", gap_um = 3.2, n_o = 1.50, n_e = 1.60, rub_deg = 5, twist_deg = 63.6, slices = 40, pretilt_deg = 2, states = { white = { tilt_deg = 80 }, black = { twist_deg = 60 } } },
]
"#;

fn pixel(text: &str) -> CrystalPixel {
    let resolved = resolve(text, Path::new(""), &[]).unwrap_or_else(|errors| panic!("{errors}"));
    let Pixel::Crystal(pixel) = resolved.scene.display.pixel else { panic!("another pixel") };
    pixel
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
}

#[test]
fn layers_have_the_indices_and_axes_of_the_scenario() {
    let CrystalPixel { parts, states, .. } = pixel(GOOD);
    assert_eq!(states, ["white", "black"]);
    assert_eq!(parts.len(), 8);
    // The polariser: half of unpolarised light with exp(-4 pi k d/lambda), the other with 1e-4 of it.
    let nm = 400.0;
    let transmitted =
        |axis: usize| (-4.0 * std::f64::consts::PI * parts[0].indices[axis][0].im * 20e3 / nm).exp();
    close(0.5 * (transmitted(0) + transmitted(1)), 0.44);
    close(transmitted(0) / transmitted(1), 1e-4);
    let absorbing = parts[0].slices[0][0].axes[0];
    close(absorbing[0], 100.0_f64.to_radians().cos());
    close(absorbing[1], 100.0_f64.to_radians().sin());
    // The retarder: 275 nm at 550 nm, 1.1 times that at 450 nm.
    let retardance = |bin: usize| (parts[1].indices[0][bin].re - parts[1].indices[1][bin].re) * 40e3;
    close(retardance(3), 275.0);
    close(retardance(1), 302.5);
    let [x, y, z] = parts[1].indices.each_ref().map(|n| n[3].re);
    close((x - z) / (x - y), 0.5);
    assert!(parts[2].slices[0][0].axes[0][2] == 1.0 && parts[2].indices[0][0].re < parts[2].indices[1][0].re);
    close(parts[3].slices[0][0].axes[0][2], 0.5);
    assert!(!parts[0].coherent && !parts[4].coherent && parts[5].coherent);
    // Left-handed: counter-clockwise downwards.
    let turned = &parts[5].slices[0];
    assert_eq!((turned.len(), parts[5].repeats), (32, 4));
    assert!(turned[0].axes[0][1] > 0.0);
    let (white, black) = (&parts[7].slices[0], &parts[7].slices[1]);
    assert_eq!((white.len(), black.len()), (40, 40));
    close(white[0].axes[0][2], 80.0_f64.to_radians().sin());
    close(black[39].axes[0][2], 2.0_f64.to_radians().sin());
    let azimuth = |axis: [f64; 3]| axis[1].atan2(axis[0]).to_degrees();
    close(azimuth(white[39].axes[0]), 5.0 + 63.6 * 39.5 / 40.0);
    close(azimuth(black[0].axes[0]), 5.0 + 60.0 * 0.5 / 40.0);
}

#[test]
fn named_liquid_crystals_have_published_indices() {
    let named = GOOD.replace("n_o = 1.50, n_e = 1.60", "liquid_crystal = \"E7\"");
    let parts = pixel(&named).parts;
    // 550 nm.
    let [e, o, _] = parts[7].indices.each_ref().map(|n| n[3].re);
    close(o, 1.4990 + 0.0072 / 0.3025 + 0.0003 / 0.3025_f64.powi(2));
    close(e, 1.6933 + 0.0078 / 0.3025 + 0.0028 / 0.3025_f64.powi(2));
}

#[test]
fn directors_come_from_a_file_by_depth() {
    let name = format!("papilio-director-{}.csv", Dice::new(7, u64::from(std::process::id())).bits());
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, "depth,tilt_deg,twist_deg\n0,2,0\n0.5,60,30\n1,2,60\n").unwrap();
    let text = GOOD.replace("{ twist_deg = 60 }", &format!("{:?}", path.display().to_string()));
    let slices = pixel(&text).parts.pop().unwrap().slices;
    std::fs::remove_file(&path).unwrap();
    let axis = slices[1][9].axes[0];
    close(axis[2], (2.0 + 58.0 * 9.5 / 20.0_f64).to_radians().sin());
    close(axis[1].atan2(axis[0]).to_degrees(), 5.0 + 60.0 * 9.5 / 40.0);
}

/// Without `slices`, their number follows from the turn of the director and the retardance of each state; fewer of the user's are noted.
#[test]
fn slices_follow_from_the_turn_and_the_retardance() {
    let counts = |cell: &str| -> (Vec<usize>, Vec<String>) {
        let text = GOOD
            .replace("rub_deg = 5, ", "")
            .replace("slices = 40", cell)
            .replace("gap_um = 3.2", "gap_um = 5.5");
        let resolved = resolve(&text, Path::new(""), &[]).unwrap_or_else(|errors| panic!("{errors}"));
        let Pixel::Crystal(mut pixel) = resolved.scene.display.pixel else { panic!("another pixel") };
        (pixel.parts.pop().unwrap().slices.iter().map(Vec::len).collect(), resolved.notes)
    };
    // One wave at 550 nm: 1.4 a degree of turn of the director, whose end turns less where it is tilted; 100 nm at most.
    let (own, notes) = counts("rub_deg = 5");
    assert_eq!(own, [55, 84]);
    assert!(!notes.iter().any(|note| note.contains("slices")), "{notes:?}");
    let (own, notes) = counts("slices = 60");
    assert_eq!(own, [60, 60]);
    assert!(
        notes
            .iter()
            .any(|note| note.contains("`slices` = 60") && note.contains("84") && note.contains("by up to")),
        "{notes:?}"
    );
}

/// The director of each state is that of the relaxation, and the threshold shows: nothing moves at 1 V, the middle lies at 10 V.
#[test]
fn directors_follow_from_voltages() {
    let driven = GOOD.replace(
        "pretilt_deg = 2, states = { white = { tilt_deg = 80 }, black = { twist_deg = 60 } }",
        "pretilt_deg = 89, K11_pN = 16.7, K22_pN = 7, K33_pN = 18.1, epsilon_parallel = 3.6, epsilon_perpendicular = 7.8, \
         states = { white = { volts = 10 }, black = { volts = 1 }, flat = { tilt_deg = 3 } }",
    );
    let slices = pixel(&driven).parts.pop().unwrap().slices;
    let tilt_deg = |state: usize, slice: usize| slices[state][slice].axes[0][2].asin().to_degrees();
    assert!(tilt_deg(0, 20) < 5.0 && tilt_deg(0, 0) > 45.0, "{} {}", tilt_deg(0, 20), tilt_deg(0, 0));
    assert!((0..40).all(|slice| tilt_deg(1, slice) > 88.0));
    close(tilt_deg(2, 10), 3.0);
}

/// A supertwisted cell keeps its turn at any voltage with a chiral dopant of its natural pitch, and loses it without or with one of the wrong hand.
#[test]
fn a_chiral_dopant_holds_the_turn() {
    let azimuth_deg = |pitch: &str| {
        let cell = GOOD
            .replace("twist_deg = 63.6", "twist_deg = 240")
            .replace(
                "pretilt_deg = 2, states = { white = { tilt_deg = 80 }, black = { twist_deg = 60 } }",
                &format!(
                    "pretilt_deg = 5, K11_pN = 11, K22_pN = 6, K33_pN = 17, epsilon_parallel = 13, epsilon_perpendicular = 4, \
                     {pitch} states = {{ white = {{ volts = 2.5 }} }}"
                ),
            );
        let axis = pixel(&cell).parts.pop().unwrap().slices[0].last().unwrap().axes[0];
        axis[1].atan2(axis[0]).to_degrees()
    };
    // All have the same director at the bottom: the last slices are those before it, from either side.
    let [held, free, wrong] = ["pitch_um = 4.6,", "", "pitch_um = -4.6,"].map(azimuth_deg);
    let end = (5.0_f64 + 240.0).to_radians();
    let before = |azimuth_deg: f64| (end - azimuth_deg.to_radians()).sin();
    assert!(before(held) > 0.0 && before(free) < 0.0 && before(wrong) < 0.0, "{held} {free} {wrong}");
}

/// Turns of a helix are one list of slices that repeats; a focal conic state has none of it, but an isotropic layer of the same thickness.
#[test]
fn cholesteric_layers_have_textures() {
    let text = r#"[spectrum]
range_nm = [400, 700]
step_nm = 50

[display.pixel]
model = "liquid-crystal"
substrate = "Al"
stack = [
  { kind = "cholesteric", pitch_nm = 400, handedness = "right", n_o = 1.5, n_e = 1.7, thickness_um = 4.098, states = { white = "planar", black = "focal-conic" } },
]
"#;
    let CrystalPixel { parts, states, .. } = pixel(text);
    assert_eq!(states, ["white", "black"]);
    let thickness = |part: usize, state: usize| -> f64 {
        let slices = &parts[part].slices[state];
        let sum = |slices: &[CrystalSlice]| slices.iter().map(|slice| slice.thickness_nm).sum::<f64>();
        let rest = &slices[..parts[part].rest.min(slices.len())];
        parts[part].repeats as f64 * sum(slices) + sum(rest)
    };
    // 2622 slices of 1.5625 nm.
    let helix = &parts[0];
    assert_eq!((parts.len(), helix.repeats, helix.rest, helix.slices[0].len()), (3, 20, 62, 128));
    close(thickness(0, 0), 4096.875);
    close(thickness(1, 0), 1.125);
    for (part, state, expected) in [(2, 0, 0.0), (0, 1, 0.0), (1, 1, 0.0), (2, 1, 4098.0)] {
        close(thickness(part, state), expected);
    }
    close(parts[2].indices[0][0].re, ((2.0 * 1.5_f64 * 1.5 + 1.7 * 1.7) / 3.0).sqrt());
}

#[test]
fn polarisers_come_from_tables() {
    let name = format!("papilio-polariser-{}.csv", Dice::new(8, u64::from(std::process::id())).bits());
    let path = std::env::temp_dir().join(name);
    let table = |text: &str| {
        std::fs::write(&path, text).unwrap();
        let file = format!("file = {:?}", path.display().to_string());
        GOOD.replace("transmittance = 0.44, extinction = 1e-4", &file)
    };
    let of_k = pixel(&table("wavelength_nm,k_absorbed,k_transmitted\n400,0.03,1e-4\n700,0.02,2e-4\n")).parts;
    let ratios = table("wavelength_nm,transmittance,extinction\n400,0.44,1e-4\n700,0.44,1e-4\n");
    let (of_ratio, usual) = (pixel(&ratios).parts, pixel(GOOD).parts);
    let short = table("wavelength_nm,transmittance,extinction\n400,0.44,1e-4\n650,0.44,1e-4\n");
    let message = resolve(&short, Path::new(""), &[]).err().unwrap().to_string();
    std::fs::remove_file(&path).unwrap();
    close(of_k[0].indices[0][0].im, 0.03);
    close(of_k[0].indices[1][6].im, 2e-4);
    for axis in [0, 1, 2] {
        close(of_ratio[0].indices[axis][3].im, usual[0].indices[axis][3].im);
    }
    assert!(message.contains("650"), "{message}");
}

/// A gap in nm, taken for um, is refused before anything is computed; fringes finer than the grid are noted.
#[test]
fn fringes_that_nothing_resolves_are_refused_or_noted() {
    let thick = GOOD.replace("gap_um = 3.2", "gap_um = 3200");
    let message = resolve(&thick, Path::new(""), &[]).err().unwrap().to_string();
    for part in [
        "`gap_um` = 3200 makes",
        "interference fringes between 400 and 700 nm",
        "did you mean 3.2 (from nm)?",
    ] {
        assert!(message.contains(part), "{part}: {message}");
    }
    let noted = resolve(&GOOD.replace("gap_um = 3.2", "gap_um = 60"), Path::new(""), &[]).unwrap();
    assert!(noted.notes.iter().any(|note| note.contains("fringes in a step of 50 nm")), "{:?}", noted.notes);
}

/// A line over 1/wavelength^2 through few values crosses 0: that at 380 nm is 275 nm (1 - 0.5 x 1.095/0.494), -30 nm.
#[test]
fn retardances_that_change_their_sign_are_noted() {
    let notes = |dispersion: &str| {
        let text = GOOD.replace("dispersion = 1.1", dispersion).replace("[400, 700]", "[380, 680]");
        resolve(&text, Path::new(""), &[]).unwrap_or_else(|errors| panic!("{errors}")).notes
    };
    let is_noted = |notes: &[String]| notes.iter().any(|note| note.contains("opposite sign at 380 nm, -29."));
    assert!(is_noted(&notes("dispersion = 0.5")) && !is_noted(&notes("dispersion = 0.9")));
}

/// A field acts only on a director that can lower its energy by turning.
#[test]
fn voltages_that_cannot_act_are_noted() {
    let notes = |pretilt_deg: f64, [along, across]: [f64; 2]| {
        let cell = format!(
            "pretilt_deg = {pretilt_deg}, K11_pN = 10, K22_pN = 7, K33_pN = 18, epsilon_parallel = {along}, epsilon_perpendicular = {across}, \
             states = {{ white = {{ volts = 3 }}, black = {{ volts = 0 }} }}"
        );
        let text = GOOD
            .replace(
                "pretilt_deg = 2, states = { white = { tilt_deg = 80 }, black = { twist_deg = 60 } }",
                &cell,
            )
            .replace("twist_deg = 63.6, ", "");
        let resolved = resolve(&text, Path::new(""), &[]).unwrap_or_else(|errors| panic!("{errors}"));
        resolved.notes.iter().filter(|note| note.contains("does not move the director")).count()
    };
    for (pretilt_deg, permittivity, count) in [
        (2.0, [10.0, 5.0], 0),
        (2.0, [5.0, 5.0], 1),
        (90.0, [10.0, 5.0], 1),
        (90.0, [5.0, 10.0], 0),
        (0.0, [5.0, 10.0], 1),
        (0.0, [10.0, 5.0], 0),
    ] {
        assert_eq!(notes(pretilt_deg, permittivity), count, "{pretilt_deg} {permittivity:?}");
    }
}

/// Keys that do not matter for their layer are named with their path; the layer is the same.
#[test]
fn keys_without_effect_have_a_warning() {
    for (from, to, warning) in [
        (
            "plate = \"C\", retardance_nm",
            "plate = \"C\", axis_deg = 30, retardance_nm",
            "display.pixel.stack.2.axis_deg has no effect: the axis of a C plate is the normal",
        ),
        (
            "pretilt_deg = 2",
            "pretilt_deg = 2, pretilt_bottom_deg = 4",
            "stack.7.pretilt_bottom_deg has no effect",
        ),
        ("pretilt_deg = 2", "pretilt_deg = 2, pitch_um = 5", "stack.7.pitch_um has no effect"),
    ] {
        let text = GOOD.replacen(from, to, 1);
        let resolved = resolve(&text, Path::new(""), &[]).unwrap_or_else(|errors| panic!("{errors}"));
        let warnings = &resolved.warnings;
        assert!(warnings.iter().any(|one| one.contains(warning)), "{warning}: {warnings:?}");
        let without = resolve(GOOD, Path::new(""), &[]).unwrap();
        assert!(!without.warnings.iter().any(|one| one.contains("no effect")), "{:?}", without.warnings);
    }
}

#[test]
fn mistakes_are_explained() {
    for (from, to, expected) in [
        ("gap_um = 3.2, ", "", "gap_um"),
        ("rub_deg = 5", "rub_deg = 0.7854", "looks like pi/4 radians"),
        ("twist_deg = 63.6", "twist_deg = 1.5708", "write 90 for that angle"),
        ("n_o = 1.50, n_e = 1.60", "n_o = 1.50", "this cell has no liquid crystal"),
        ("n_o = 1.50, n_e = 1.60", "liquid_crystal = \"E8\"", "there is no liquid crystal `E8`"),
        ("n_o = 1.50, ", "n_o = 1.50, liquid_crystal = \"E7\", ", "cannot be combined"),
        ("black = { twist_deg = 60 }", "black = {}", "the state `black` has no director"),
        ("pretilt_deg = 2", "pretilt_deg = 2, pitch_um = 0", "a helix has no pitch of 0"),
        ("material = 1.52 }", "material = 1.52, thickness_nm = 500 }", "write `thickness_um`, in this unit"),
        (
            "[display.pixel]",
            "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\n[display.diffuser]\nmodel = \"lambertian\"\ntransmittance = 0.9\n[display.pixel]",
            "a diffuser given by its BTDF includes its surfaces",
        ),
        ("black = { twist_deg = 60 }", "black = { volts = 5 }", "needs the constants of the liquid crystal"),
        ("black = { twist_deg = 60 }", "black = { volts = 5, twist_deg = 60 }", "cannot be combined"),
        ("black = { twist_deg = 60 }", "black = { volts = -5 }", "-5"),
        ("gap_um = 3.2,", "gap_um = 3.2, K11_pN = 10,", "this cell has no `K22_pN`"),
        (
            "axis_deg = 10, transmittance",
            "axis_deg = 10, file = \"a.csv\", transmittance",
            "cannot be combined",
        ),
        (
            "axis_deg = 10, transmittance",
            "axis_deg = 10, index = { n = 1.5, k = 0.01 }, transmittance",
            "the index of this polariser has an extinction coefficient k",
        ),
        ("transmittance = 0.44", "transmittance = 0.55", "this polariser would transmit 1.09989"),
        ("extinction = 1e-4", "extinction = 0", "extinction above 0"),
        ("plate = \"C\", retardance_nm = -100", "retardance_nm = -100", "this retarder has no axis"),
        (
            "plate = \"O\", axis_deg = 20, tilt_deg = 30",
            "plate = \"O\", axis_deg = 20",
            "this O plate has no tilt",
        ),
        ("axis_deg = 75,", "axis_deg = 75, tilt_deg = 3,", "`tilt_deg` is for O plates only"),
        ("handedness = \"left\"", "handedness = \"l\"", "\"right\""),
        ("substrate = \"Al\"\n", "", "substrate"),
        (
            "retardance_nm = 275",
            "retardance_nm = -9000, thickness_um = 1",
            "has an index of -9.123 along an axis",
        ),
        (
            "twist_deg = 63.6, slices = 40, pretilt_deg = 2, states",
            "states = { a = { tilt_deg = 1 } } }, { kind = \"cell\", gap_um = 1, n_o = 1.5, n_e = 1.6, states",
            "two layers have different states",
        ),
    ] {
        assert!(GOOD.contains(from), "{from}");
        let text = GOOD.replacen(from, to, 1);
        let errors = resolve(&text, Path::new(""), &[]).err().unwrap_or_else(|| panic!("no error: {to}"));
        let message = errors.to_string();
        assert!(message.contains(expected), "{to}: {message}");
        assert!(errors.iter().next().unwrap().place.line_column().is_some(), "{to}: {message}");
    }
}
