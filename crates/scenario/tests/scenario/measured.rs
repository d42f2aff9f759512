//! Measured diffusers: refused input with its place, notes and warnings.

use std::path::Path;

use papilio_formats::{BsdfFormat, DataFile, LARGEST_BSDF_FILE, read_bsdf, write_measurement};
use papilio_scenario::Scenario;

use crate::common::{NO_REFLECTION, changed, resolve, shipped};
use crate::layers::{layers_of, outline};

const LOBE: &str = "model = \"k-correlation\"\nhaze = 0.78\ntotal_transmittance = 0.9";

/// The small scenario with a measured diffuser and further keys of it.
fn measured(file: &str, more: &str) -> String {
    changed(&[(LOBE, &format!("model = \"measured\"\nfile = \"{file}\"\nextrapolate = \"hold\"\n{more}"))])
}

fn refusal(text: &str) -> String {
    resolve(text, &shipped(), &[]).unwrap_err().to_string()
}

#[test]
fn wrong_keys_of_measured_diffusers_are_refused_at_their_places() {
    let h78 = "data/H78-raw.bsdf";
    for (text, says) in [
        (measured("data/none.bsdf", ""), &["test.toml:13:8", "data/none.bsdf"][..]),
        (measured("data/H78-transmission.csv", ""), &["data/H78-transmission.csv"]),
        (measured(h78, "flipped = true"), &["test.toml:13:8", "no back transmission", "front transmission"]),
        (measured(h78, "normalise = \"sum\""), &["test.toml:15:13", "`sum` is not one of the choices"]),
        (
            measured(h78, "spectral_mean = \"odd\""),
            &["`odd` is not one of the choices", "\"uniform\" or \"luminous\""],
        ),
        (measured(h78, "instrument_blur = 2"), &["test.toml:15:19", "from 0.0001 to 1"]),
        (measured(h78, "transmission = 90"), &["not per cent"]),
        (measured(h78, "transmission = 0"), &["test.toml:15:16", "gives no spectral shape"]),
        (
            measured(h78, "instrument_blur = 0.2"),
            &["test.toml:15:19", "no lobe blurred by 0.2", "a collimated beam"],
        ),
        (
            measured(h78, "mounting = \"air\"").replace("hold", "glass"),
            &[
                "test.toml:14:15",
                "`extrapolate = \"glass\"` cannot be combined with this mounting",
                "\"hold\"",
            ],
        ),
        (measured(h78, "haze = 0.5"), &["`haze` cannot be combined with model = \"measured\""]),
    ] {
        let shown = refusal(&text);
        assert!(says.iter().all(|words| shown.contains(words)), "{says:?}\n{shown}");
    }
}

/// In a list, a foil is mounted on the medium below it, as `[display.diffuser]` on the glass.
#[test]
fn mounting_in_layers_is_that_of_the_medium_below() {
    let pixel = "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.6, black = 0.05 }\n";
    let foil = |keys: &str| format!("model = \"measured\", file = \"data/H78-raw.bsdf\", {keys}");
    let list = |keys: &str, below: &str| {
        let foil = foil(keys);
        format!("[display]\nlayers = [{{ kind = \"diffuser\", {foil} }}{below}]\n{pixel}")
    };
    let medium = ", { kind = \"medium\", index = 1.6 }";
    let short = |keys: &str| {
        format!("[display]\ndiffuser = {{ {} }}\nglass = {{ index = 1.6 }}\n{pixel}", foil(keys))
    };
    let interfaces = |text: &str| {
        let layers = resolve(text, &shipped(), &[]).unwrap_or_else(|e| panic!("{e}")).scene.display.layers;
        layers.into_iter().map(|layer| (layer.interface, layer.medium)).collect::<Vec<_>>()
    };
    for keys in [
        "extrapolate = \"hold\"",
        "extrapolate = \"glass\"",
        "mounting = \"laminated\"",
        "mounting = \"air\", gap_mm = 0.2",
    ] {
        assert!(interfaces(&list(keys, medium)) == interfaces(&short(keys)), "{keys}");
    }
    for (keys, words) in [
        ("mounting = \"laminated\"", "no medium follows this foil"),
        ("extrapolate = \"glass\"", "cannot be combined with a foil without a medium below it"),
    ] {
        let shown = refusal(&list(keys, ""));
        assert!(shown.contains(words), "{shown}");
    }
}

/// In a panel, the mounting defines the layers below the foil.
#[test]
fn mounting_sets_the_layers_below_the_foil() {
    for (mounting, below) in [
        ("as-measured", &[("scatter", 1.5)][..]),
        ("laminated", &[("scatter", 1.0), ("coated", 1.5)]),
        ("air", &[("scatter", 1.0), ("fresnel", 1.5)]),
    ] {
        let resolved =
            resolve(&measured("data/H78-raw.bsdf", &format!("mounting = \"{mounting}\"")), &shipped(), &[]);
        let resolved = resolved.unwrap();
        let layers = outline(layers_of(&resolved));
        assert_eq!(layers[layers.len() - below.len()..], *below, "{mounting}");
    }
}

/// A file without transmission, and one without TIS.
#[test]
fn file_without_transmission_or_tis_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut rows = "theta_i,phi_i,theta_o,phi_o,value\n".to_owned();
    for theta_i in [0, 30, 60] {
        for theta_o in 0..9 {
            for phi_o in [0, 90, 180] {
                rows += &format!("{theta_i},180,{},{phi_o},0.3\n", 10 * theta_o);
            }
        }
    }
    std::fs::write(folder.path().join("brdf.csv"), &rows).unwrap();
    let shown = resolve(&measured("brdf.csv", ""), folder.path(), &[]).unwrap_err().to_string();
    assert!(shown.contains("no front transmission") && shown.contains("front reflection"), "{shown}");
    // The shipped file without its TIS.
    let name = shipped().join("data/H78-raw.bsdf");
    let file = DataFile::open_within(&name, "H78", LARGEST_BSDF_FILE).unwrap();
    let mut measurement = read_bsdf(&file).unwrap().value;
    measurement.parts[0].tis.clear();
    let mut bytes = Vec::new();
    write_measurement(&mut bytes, BsdfFormat::Papilio, &measurement).unwrap();
    std::fs::write(folder.path().join("btdf.npz"), bytes).unwrap();
    let text = |normalise: &str| measured("btdf.npz", &format!("normalise = \"{normalise}\""));
    assert!(resolve(&text("none"), folder.path(), &[]).is_ok());
    let shown = resolve(&text("tis"), folder.path(), &[]).unwrap_err().to_string();
    assert!(shown.contains("no total integrated scatter (TIS)") && shown.contains("\"none\""), "{shown}");
}

/// All changes are reported.
#[test]
fn changes_of_the_data_are_noted() {
    let told = |more: &str| {
        let resolved = resolve(&measured("data/H78-raw.bsdf", more), &shipped(), &[]).unwrap();
        assert!(resolved.warnings.is_empty(), "{:?}", resolved.warnings);
        resolved.notes.join("\n")
    };
    let held = told("");
    let lines: Vec<&str> = held.lines().collect();
    assert!(lines.len() == 2 && lines[0].contains("beyond it (6.7 % of diffuse light)"), "{held}");
    assert_eq!(lines[1], NO_REFLECTION, "the file has no reflection");
    assert!(told("normalise = \"tis\"").contains("totals are multiplied by 1.05"), "{}", told(""));
    let sharp = told("instrument_blur = 0.0483");
    assert!(sharp.contains("instead of 13.8 per sr") && sharp.contains("relative noise"), "{sharp}");
    let text = measured("data/H78-raw.bsdf", "").replace("extrapolate = \"hold\"", "extrapolate = \"none\"");
    let resolved = resolve(&text, &shipped(), &[]).unwrap();
    assert!(resolved.warnings[0].contains("beyond 75 deg"), "{:?}", resolved.warnings);
}

/// A Lambertian foil that transmits 0.3 of the light, measured at these incidences and up to this inclination
/// of the receiver.
fn film(incidences: &[u32], to_deg: u32) -> String {
    let mut rows = "way,theta_i,phi_i,theta_o,phi_o,value\n".to_owned();
    for theta_i in incidences {
        for theta_o in 0..=to_deg / 5 {
            for phi_o in [0, 60, 120, 180] {
                rows += &format!("front transmission,{theta_i},180,{},{phi_o},0.0955\n", 5 * theta_o);
            }
        }
    }
    rows
}

/// Returns notes and warnings for a foil with this `extrapolate`.
fn told(film: &str, extrapolate: &str) -> [String; 2] {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("film.csv"), film).unwrap();
    let text = measured("film.csv", "").replace("extrapolate = \"hold\"", extrapolate);
    let resolved = resolve(&text, folder.path(), &[]).unwrap();
    let of_film = |lines: &[String]| {
        lines.iter().filter(|line| line.contains("display.diffuser")).cloned().collect::<Vec<_>>().join("\n")
    };
    [of_film(&resolved.notes), of_film(&resolved.warnings)]
}

/// `hold` is the default, with a note; with `none`, light beyond the last incidence is lost. The note is also
/// there if the key is written.
#[test]
fn last_incidence_is_held_by_default() {
    let [single, two] = [&[0][..], &[0, 30]].map(|incidences| film(incidences, 90));
    let [notes, warnings] = told(&single, "");
    assert!(
        notes.contains("one incidence, 0 deg: its lobe is used") && warnings.is_empty(),
        "{notes}\n{warnings}"
    );
    // All of the disc but its part within the disc that was measured, shifted by sin 60 deg: 53.36 %.
    assert!(notes.contains("at 60 deg of incidence, 53.3 % of the light is farther"), "{notes}");
    assert_eq!(told(&single, "extrapolate = \"hold\""), [notes, String::new()]);
    let [notes, warnings] = told(&single, "extrapolate = \"none\"");
    assert!(notes.is_empty() && warnings.contains("beyond 0 deg: light from there is lost"), "{warnings}");
    for extrapolate in ["", "extrapolate = \"hold\"", "extrapolate = \"glass\""] {
        let [notes, warnings] = told(&two, extrapolate);
        let says = "the last incidence below 90 deg is 30 deg: beyond it (75.0 % of diffuse light)";
        assert!(notes.contains(says) && warnings.is_empty(), "{extrapolate}\n{notes}\n{warnings}");
    }
    let [notes, warnings] = told(&two, "extrapolate = \"none\"");
    assert!(notes.is_empty() && warnings.contains("beyond 30 deg"), "{notes}\n{warnings}");
}

/// Light beyond the last measured angle is lost, or extrapolated with a key; its fraction is reported in both
/// cases. For a Lambertian foil measured up to 60 deg it is cos^2 60, a quarter.
#[test]
fn light_beyond_the_last_measured_angle_is_reported() {
    let film = film(&[0, 30], 60);
    let [_, warnings] = told(&film, "extrapolate = \"none\"");
    assert!(warnings.contains("no light is scattered there"), "{warnings}");
    let [_, warnings] = told(&film, "extrapolate = \"hold\"");
    assert!(warnings.contains("this part is not measured"), "{warnings}");
    assert!(warnings.contains("nothing was measured at more than 60 deg from the normal"), "{warnings}");
    let share = warnings.split(" tails there have ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    let share: f64 = share.parse().unwrap();
    assert!((share - 25.0).abs() < 4.0, "{warnings}");
}

/// A BTDF that states no side of the light is of the side that `part` names: from the back it needs
/// `flipped`.
#[test]
fn part_of_a_btdf_is_the_side_of_the_light() {
    let folder = tempfile::tempdir().unwrap();
    let film = film(&[0, 30, 60], 90).replace("front transmission,", "").replace("way,", "");
    std::fs::write(folder.path().join("film.csv"), film.replace("value", "btdf")).unwrap();
    let told = |more: &str| resolve(&measured("film.csv", more), folder.path(), &[]);
    let back = told("part = \"back-transmission\"").unwrap_err().to_string();
    assert!(back.contains("no front transmission") && back.contains("`flipped = true`"), "{back}");
    let flipped = told("part = \"back-transmission\"\nflipped = true").unwrap();
    assert!(flipped.notes[0].contains("read as back transmission"), "{:?}", flipped.notes);
    assert!(told("part = \"front-transmission\"").is_ok());
    let front = told("part = \"front-transmission\"\nflipped = true").unwrap_err().to_string();
    assert!(front.contains("no back transmission") && front.contains("without `flipped`"), "{front}");
    // A reflection is no transmission, whatever `part` says.
    std::fs::write(folder.path().join("film.csv"), film.replace("value", "brdf")).unwrap();
    let brdf = told("part = \"front-transmission\"").unwrap_err().to_string();
    assert!(brdf.contains("no front transmission, which `part` names"), "{brdf}");
}

/// The level of a scan in relative units: the key that sets it, keys that do not, a faint film, and TIS in
/// per cent.
#[test]
fn level_of_relative_values_has_one_key() {
    let folder = tempfile::tempdir().unwrap();
    let [relative, per_cent] = ["scan.csv", "percent.bsdf"].map(|name| folder.path().join(name));
    let rows: String = (0..=90)
        .map(|deg| {
            let beta = f64::from(deg).to_radians().sin();
            format!("{deg},{}\n", (1.0 + (beta / 0.1).powi(2)).powf(-1.5))
        })
        .collect();
    std::fs::write(relative, format!("theta_deg,btdf\n{rows}")).unwrap();
    let told = |file: &str, more: &str| resolve(&measured(file, more), folder.path(), &[]);
    let faint = told("scan.csv", "").unwrap();
    assert!(
        faint.warnings[0].contains("`total_transmittance` gives them their level"),
        "{:?}",
        faint.warnings
    );
    let level = told("scan.csv", "total_transmittance = 0.905").unwrap();
    assert!(level.notes.iter().any(|note| note.contains("is 90.5000 %")) && level.warnings.is_empty());
    let constant = told("scan.csv", "transmission = 0.905").unwrap_err().to_string();
    assert!(constant.contains("the same at all wavelengths") && constant.contains("`total_transmittance`"));
    let both = told("scan.csv", "total_transmittance = 0.9\nnormalise = \"tis\"").unwrap_err().to_string();
    assert!(both.contains("`total_transmittance` cannot be combined with normalise"), "{both}");
    let h78 = std::fs::read_to_string(shipped().join("data/H78-raw.bsdf")).unwrap();
    let times_100 = |line: &str| match line.strip_prefix("TIS ") {
        Some(tis) => format!("TIS {}\n", 100.0 * tis.trim().parse::<f64>().unwrap()),
        None => format!("{line}\n"),
    };
    std::fs::write(per_cent, h78.lines().map(times_100).collect::<String>()).unwrap();
    let percent = told("percent.bsdf", "normalise = \"tis\"").unwrap_err().to_string();
    assert!(percent.contains("is in per cent") && percent.contains("by 100"), "{percent}");
}

fn measurement(text: &str, more: &str) -> Result<papilio_scenario::VirtualMeasurement, String> {
    let text = format!("{text}\n[measure]\n{more}");
    let scenario = Scenario::from_text(&text, "test.toml", Path::new(""), &[]).map_err(|e| e.to_string())?;
    scenario.measurement().map_err(|e| e.to_string())
}

#[test]
fn instrument_has_its_grid_and_channels() {
    let good = changed(&[]);
    let small =
        "incidence_deg = [0, 45]\nradial_deg = { from = 0, to = 180, step = 5 }\nchannels = \"monochrome\"";
    let found = measurement(&good, small).unwrap();
    let part = found.measure("film").unwrap().parts.remove(0);
    assert_eq!((part.values.len(), part.tis.len()), (2 * 19 * 37, 2));
    // The peak of a lobe of haze 0.78 and total transmittance 0.90, and its total.
    assert!((part.values[0] / 47.3 - 1.0).abs() < 2e-3 && (part.tis[0] - 0.9).abs() < 1e-4);
    // Five digits.
    assert!(part.values.iter().all(|value| format!("{value:.4e}").parse::<f64>() == Ok(*value)));
    // Light that passes straight is seen with a blur, or not at all.
    let straight = changed(&[("haze = 0.78", "haze = 0.5\nregular_fraction = 0.2")]);
    let found = measurement(&straight, small).unwrap();
    assert!(found.measure("film").unwrap_err().to_string().contains("the blur is 0"));
    let found = measurement(&straight, &format!("{small}\nblur = 0.01")).unwrap();
    let part = found.measure("film").unwrap().parts.remove(0);
    assert!((part.tis[0] - 0.9).abs() < 1e-4, "{:?}", part.tis);
}

#[test]
fn impossible_measurements_are_refused() {
    let good = changed(&[]);
    let slab = changed(&[(LOBE, "model = \"slab\"\noptical_thickness = 1\nanisotropy = 0.8")]);
    let bare = changed(&[(LOBE, ""), ("[display.diffuser]\n", "")]);
    for (text, more, says) in [
        (&slab, "", "an instrument cannot measure a slab, because it has no BTDF"),
        (&bare, "", "`diffuser` is missing"),
        (&good, "incidence_deg = [0, 90]", "expected angles below 90 deg"),
        (&good, "radial_deg = [0, 4, 2]", "expected increasing angles"),
        (&good, "radial_deg = [2, 4]", "expected 0 as the first angle"),
        (&good, "azimuth_deg = [0, 90]", "expected 180 as the last angle"),
        (&good, "radial_deg = { from = 0, to = 180, step = 0.001 }", "angles"),
        (&good, "blur = 0.00001", "expected a number from 0.0001 to 1"),
        (&good, "noise = -1", "expected a number from 0 to 1"),
        (&good, "channels = \"rgb\"", "\"xyz\" or \"monochrome\""),
        (&good, "light = \"D66\"", "no light named `D66`"),
    ] {
        let shown = measurement(text, more).unwrap_err();
        assert!(shown.contains(says), "{says}\n{shown}");
    }
}

/// Pairs of directions in any order are a foil, with a note on the interpolation; twelve different ones are needed.
#[test]
fn listed_pairs_are_a_foil_with_their_interpolation_error() {
    let list = |count: u32| {
        let mut rows = "way,theta_i,phi_i,theta_o,phi_o,value\n".to_owned();
        for k in 0..count {
            let [theta_i, phi, theta_o] = [k * 37 % 61, k * 101 % 360, k * 53 % 81];
            rows += &format!("front transmission,{theta_i},0,{theta_o}.5,{phi},0.2\n");
        }
        rows
    };
    let [notes, _] = told(&list(200), "");
    assert!(
        notes.contains("lists single pairs of directions") && notes.contains("missed by 0.00 %"),
        "{notes}"
    );
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("film.csv"), list(11)).unwrap();
    let wrong = resolve(&measured("film.csv", ""), folder.path(), &[]).unwrap_err().to_string();
    assert!(
        wrong.contains("fewer than 12 different listed pairs") && wrong.contains("test.toml:13:8"),
        "{wrong}"
    );
}
