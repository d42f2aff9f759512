//! `[[lighting.environment]]`: resolved fields, and refused input.

use std::path::Path;

use papilio_optics::Beta;

use crate::common::{GOOD, changed, resolve, shipped};

const LAMP: &str = "[[lighting.directed]]\ntheta_deg = -20\nshare = 0.5\n";

/// The valid scenario with this text instead of its directed source.
fn with(environment: &str) -> String {
    changed(&[(LAMP, &format!("[[lighting.environment]]\n{environment}\n"))])
}

#[test]
fn rings_caps_and_profiles_have_their_edges() {
    for (environment, dark, lit) in [
        ("model = \"ring\"\ntheta_deg = 35\nwidth_deg = 10\nshare = 0.5", [29.9, 40.1], [30.1, 39.9]),
        ("model = \"cap\"\nto_deg = 20\nshare = 0.5", [20.1, 89.0], [0.0, 19.9]),
        ("model = \"cap\"\nfrom_deg = 60\nshare = 0.5", [0.0, 59.9], [60.1, 89.9]),
        ("model = \"profile\"\nfile = \"data/synthetic-room.csv\"\nshare = 0.5", [90.1, 91.0], [0.0, 89.0]),
    ] {
        let scene = resolve(&with(environment), &shipped(), &[]).unwrap().scene;
        let part = &scene.lighting.environment[0].parts[0];
        assert_eq!(part.share, 0.5);
        let at = |theta: f64| part.field.radiance(Beta::from_source(theta, 123.0, 1.0));
        assert!(dark.iter().filter(|theta| **theta < 90.0).all(|theta| at(*theta) == 0.0), "{environment}");
        assert!(lit.iter().all(|theta| at(*theta) > 0.0), "{environment}");
    }
}

#[test]
fn profile_by_elevation_equals_that_by_inclination() {
    let text =
        with("model = \"profile\"\nfile = \"data/synthetic-room.csv\"\nangles = \"elevation\"\nshare = 0.5");
    let scene = resolve(&text, &shipped(), &[]).unwrap().scene;
    let at =
        |theta| scene.lighting.environment[0].parts[0].field.radiance(Beta::from_source(theta, 0.0, 1.0));
    assert!(at(80.0) > 4.0 * at(10.0));
}

#[test]
fn sky_with_sun_adds_a_directed_source() {
    let text = with(
        "model = \"sky\"\nnumber = 12\nsun_elevation_deg = 30\nsun_azimuth_deg = -90\nsun_share = 0.4\nshare = 0.1\n\
         tilt_deg = 40",
    );
    let resolved = resolve(&text, Path::new(""), &[]).unwrap();
    // It faces azimuth -90 deg, its normal 50 deg above the horizon: the sun is 20 deg lower.
    let sun = &resolved.scene.lighting.directed[0];
    assert!((sun.theta_deg - 20.0).abs() < 1e-9 && (sun.phi_deg + 90.0).abs() < 1e-9, "{sun:?}");
    assert_eq!((sun.radius_deg, sun.share), (Some(0.27), 0.4));
    assert!(resolved.notes.iter().any(|note| note.contains("tilted by 40 deg")), "{:?}", resolved.notes);
}

#[test]
fn wrong_environments_are_refused() {
    let sky = |rest: &str| format!("model = \"sky\"\nshare = 0.5\n{rest}");
    for (environment, wanted) in [
        ("model = \"ring\"\ntheta_deg = 88\nwidth_deg = 10\nshare = 0.5".into(), "reaches from 83 to 93 deg"),
        (
            "model = \"cap\"\nfrom_deg = 30\nto_deg = 20\nshare = 0.5".into(),
            "this cap reaches from 30 to 20 deg",
        ),
        (
            "model = \"cap\"\ntheta_deg = 10\nfrom_deg = 120\nshare = 0.5".into(),
            "none of this light falls on the display",
        ),
        ("model = \"ring\"\ntheta_deg = 35\nwidth_deg = 10\nshare = 0.6".into(), "sum to 1.1"),
        (sky("number = 12"), "`sun_elevation_deg` is missing"),
        (sky("number = 12\nsun_elevation_deg = -3"), "expected a number above 0, at most 90"),
        (sky("number = 17"), "17 is out of range\n"),
        (sky("number = 17"), "expected a whole number from 1 to 16"),
        (sky("number = 1.5"), "1.5 is not a whole number"),
        (sky("number = 1\ntilt_deg = 180"), "none of this light falls on the display"),
        (sky("number = 1\nwidth_deg = 3"), "`width_deg` cannot be combined with model = \"sky\""),
        ("model = \"ring\"\nshare = 0.5".into(), "the keys `theta_deg` and `width_deg` are missing"),
        ("model = \"lava\"\nshare = 0.5".into(), "`lava` is not one of the choices"),
        ("model = \"profile\"\nfile = \"none.csv\"\nshare = 0.5".into(), "there is no such file"),
    ] {
        let error = resolve(&with(&environment), Path::new(""), &[]).unwrap_err().to_string();
        assert!(error.contains(wanted) && error.contains("test.toml:"), "{environment}: {error}");
    }
    let behind =
        sky("number = 12\nsun_elevation_deg = 10\nsun_azimuth_deg = 90\ntilt_deg = 40\nsun_share = 0.1")
            .replace("share = 0.5", "share = 0.4");
    let error = resolve(&with(&behind), Path::new(""), &[]).unwrap_err().to_string();
    assert!(error.contains("the sun is 120.00 deg from the display's normal"), "{error}");
}

#[test]
fn mistake_in_profile_has_line_and_column() {
    let folder = tempfile::tempdir().unwrap();
    let text = with("model = \"profile\"\nfile = \"p.csv\"\nshare = 0.5");
    for (rows, wanted, place) in [
        ("0,1\n10,-2\n", "the radiance is -2", "p.csv:2:4"),
        ("0,1\n10,nan\n", "not a finite number", "p.csv:2:4"),
        ("10,1\n5,1\n", "angles that increase", "p.csv:2:1"),
        ("0,1\n95,1\n", "expected an angle from 0 to 90 deg", "p.csv:2:1"),
        ("0,1\n", "expected at least two angles", "p.csv"),
        ("0,0\n90,0\n", "none of this light falls on the display", "test.toml:"),
    ] {
        std::fs::write(folder.path().join("p.csv"), rows).unwrap();
        let error = resolve(&text, folder.path(), &[]).unwrap_err().to_string();
        assert!(error.contains(wanted) && error.contains(place), "{rows}: {error}");
    }
    assert!(GOOD.contains(LAMP));
}

/// A picture of one colour.
fn one_colour(pixel: [u8; 4]) -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n".to_vec();
    bytes.extend(pixel.repeat(128));
    bytes
}

#[test]
fn white_map_equals_diffuse_light() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("white.hdr"), one_colour([128, 128, 128, 129])).unwrap();
    for tilt in ["0", "50"] {
        let text = with(&format!("model = \"map\"\nfile = \"white.hdr\"\ntilt_deg = {tilt}\nshare = 0.5"));
        let resolved = resolve(&text, folder.path(), &[]).unwrap();
        let parts = &resolved.scene.lighting.environment[0].parts;
        assert_eq!(parts.len(), 3);
        let share: f64 = parts.iter().map(|part| part.share).sum();
        assert!((share - 0.5).abs() < 1e-12);
        // The parts by their illuminance are the white: D65 itself.
        let white = &resolved.scene.lighting.diffuse_spectrum;
        let observer = papilio_colour::Observer::new(&resolved.scene.grid).unwrap();
        for bin in 0..white.len() {
            let scaled = |part: &papilio_display::scene::EnvironmentPart| {
                part.share * part.spectrum[bin] / observer.luminance(&part.spectrum)
            };
            let sum: f64 = parts.iter().map(scaled).sum::<f64>() / 0.5 * observer.luminance(white);
            assert!((sum / white[bin] - 1.0).abs() < 1e-9, "{tilt}: {sum} {}", white[bin]);
        }
        // 128.5/128 W/(m2 sr) from all over: pi 179 lm/W.
        let lux = std::f64::consts::PI * 179.0 * 128.5 / 128.0;
        let note =
            resolved.notes.iter().find(|note| note.contains("the absolute values of the map")).unwrap();
        let found: f64 =
            note.split("correspond to ").nth(1).unwrap().split(" lx").next().unwrap().parse().unwrap();
        assert!((found / lux - 1.0).abs() < 2e-4, "{note}");
        assert!(note.contains("50.0 % of the map's light comes from below"), "{note}");
    }
}

#[test]
fn wrong_maps_and_luminaires_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("dark.hdr"), one_colour([0, 0, 0, 0])).unwrap();
    std::fs::write(folder.path().join("short.hdr"), &one_colour([1, 2, 3, 128])[..90]).unwrap();
    std::fs::copy(shipped().join("data/synthetic-panel.ies"), folder.path().join("panel.ies")).unwrap();
    std::fs::write(
        folder.path().join("bad.ies"),
        "IESNA:LM-63-2002\nTILT=NONE\n1 1 1 2 1 1 2 0 0 0 1 1 1\n0 90\n0\n1 x\n",
    )
    .unwrap();
    let luminaire = |rest: &str| format!("model = \"luminaire\"\nshare = 0.5\n{rest}");
    for (environment, wanted) in [
        ("model = \"map\"\nfile = \"dark.hdr\"\nshare = 0.5".to_owned(), "none of this light falls"),
        ("model = \"map\"\nfile = \"short.hdr\"\nshare = 0.5".into(), "the file ends in row 1 of 8"),
        ("model = \"map\"\nfile = \"no.exr\"\nshare = 0.5".into(), "there is no such file"),
        (luminaire("file = \"bad.ies\"\nelevation_deg = 50\ndistance_m = 2"), "bad.ies:6:3"),
        (
            luminaire("file = \"panel.ies\"\nelevation_deg = 2\ndistance_m = 1"),
            "this luminaire reaches 91.62 deg from the normal",
        ),
        (luminaire("file = \"panel.ies\"\nelevation_deg = 50"), "`distance_m` is missing"),
    ] {
        let error = resolve(&with(&environment), folder.path(), &[]).unwrap_err().to_string();
        assert!(error.contains(wanted), "{environment}: {error}");
    }
}

/// E = I cos(theta)/d^2: the file has 1200 cd cos^1.5, here at 40 deg from its nadir and at 2 m.
#[test]
fn luminaire_becomes_a_disc_and_notes_its_illuminance() {
    let text = with(
        "model = \"luminaire\"\nfile = \"data/synthetic-panel.ies\"\nelevation_deg = 50\nazimuth_deg = 20\ndistance_m = 2\nshare = 0.5",
    );
    let resolved = resolve(&text, &shipped(), &[]).unwrap();
    let lamp = &resolved.scene.lighting.directed[0];
    assert!((lamp.theta_deg - 40.0).abs() < 1e-9 && (lamp.phi_deg - 20.0).abs() < 1e-9);
    let area = 0.36 * 40.0_f64.to_radians().cos();
    let radius = (area / std::f64::consts::PI).sqrt().atan2(2.0).to_degrees();
    assert!((lamp.radius_deg.unwrap() - radius).abs() < 1e-9);
    assert!(resolved.scene.lighting.environment.is_empty());
    let lux = 804.6 * 40.0_f64.to_radians().cos() / 4.0;
    let said = format!("804.6 cd towards the display, which are {lux:.2} lx there");
    assert!(resolved.notes.iter().any(|note| note.contains(&said)), "{:?}", resolved.notes);
    // A panel of 0.6 m, 2 m away: nearer than five times its side.
    let near = |resolved: &papilio_scenario::Resolved| {
        resolved.warnings.iter().any(|warning| warning.contains("less than five times its opening of 0.60 m"))
    };
    assert!(near(&resolved));
    let far = resolve(&text.replace("distance_m = 2", "distance_m = 3"), &shipped(), &[]).unwrap();
    assert!(!near(&far), "{:?}", far.warnings);
}

/// A region over a whole map of one colour equals that map with the spectrum of the region.
#[test]
fn region_over_the_whole_map_has_its_spectrum() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("white.hdr"), one_colour([128, 128, 128, 129])).unwrap();
    let map = "model = \"map\"\nfile = \"white.hdr\"\nshare = 0.5\n";
    let region = with(&format!("{map}regions = [{{ spectrum = \"LED-B3\" }}]"));
    let scene = resolve(&region, folder.path(), &[]).unwrap().scene;
    let [part] = &scene.lighting.environment[0].parts[..] else { panic!("{:?}", scene.lighting) };
    let led = |grid: &papilio_spectra::Grid| papilio_spectra::illuminant("LED-B3", grid);
    assert_eq!(
        (&part.spectrum, part.share),
        (&papilio_spectra::LightSpectrum::sampled(&scene.grid, led).unwrap(), 0.5)
    );
    let even = |theta| std::f64::consts::PI * part.field.radiance(Beta::from_source(theta, 20.0, 1.0));
    assert!((even(5.0) - 1.0).abs() < 1e-6 && (even(80.0) - 1.0).abs() < 1e-6);
}

/// Regions conserve luminance, so that the illuminance does not change; a pixel in two regions belongs to the
/// first.
#[test]
fn regions_keep_the_luminance_and_have_their_edges() {
    let office = "model = \"map\"\nfile = \"data/synthetic-office.hdr\"\nshare = 0.5\n";
    let lux = |text: &str| {
        let resolved = resolve(&with(text), &shipped(), &[]).unwrap();
        let note = resolved
            .notes
            .iter()
            .find(|note| note.contains("the absolute values of the map"))
            .unwrap()
            .clone();
        (note, resolved.scene.lighting.environment[0].parts.clone())
    };
    let plain = lux(office);
    // The window of synthetic-office.py: 70 to 110 deg to the right of the middle, which is at -90 deg.
    let window = "regions = [{ spectrum = \"LED-B1\", elevation_deg = [5, 40], azimuth_deg = [160, 200] }, { spectrum = \"LED-B2\", elevation_deg = [0, 60] }]\n";
    let cut = lux(&format!("{office}{window}"));
    assert_eq!(plain.0, cut.0);
    assert_eq!((plain.1.len(), cut.1.len()), (3, 5));
    let seen = |part: usize, azimuth| cut.1[part].field.radiance(Beta::from_source(65.0, azimuth, 1.0));
    assert!(seen(3, 180.0) > 0.0 && seen(3, 150.0) == 0.0 && seen(3, -90.0) == 0.0);
    assert!(seen(4, 180.0) == 0.0 && seen(4, 150.0) > 0.0 && seen(0, 150.0) == 0.0);
    // It turns with the map.
    let turned =
        lux(&format!("{office}{window}rotate_deg = 90\n").replace("regions", "tilt_deg = 0\nregions"));
    let at = |azimuth| turned.1[3].field.radiance(Beta::from_source(65.0, azimuth, 1.0));
    assert!(at(270.0) > 0.0 && at(180.0) == 0.0);
}

/// The illuminance of a map is computed in two independent ways: from cells, and from pixels and their
/// projected solid angles.
#[test]
fn spectral_map_sets_the_illuminance() {
    let map = "model = \"map\"\nfile = \"data/synthetic-hall.exr\"\nshare = 0.5";
    let text = with(map).replace("illuminance_lx = 500", "illuminance_lx = \"from-map\"");
    let scene = resolve(&text, &shipped(), &[]).unwrap().scene;
    let bytes = std::fs::read(shipped().join("data/synthetic-hall.exr")).unwrap();
    let file = papilio_formats::DataFile { name: "hall".into(), bytes };
    let picture = papilio_formats::read_light_map(&file).unwrap();
    let (nm, irradiance): (Vec<f64>, Vec<f64>) = picture
        .channels
        .iter()
        .map(|channel| {
            let papilio_formats::MapColour::Wavelength(nm) = channel.colour else {
                panic!("{:?}", channel.colour)
            };
            let square =
                |row: usize| (std::f64::consts::PI * row as f64 / picture.height as f64).sin().powi(2);
            let rows = (0..picture.height / 2).map(|row| {
                let pixels = &channel.radiance[row * picture.width..][..picture.width];
                let mean = pixels.iter().map(|value| f64::from(*value)).sum::<f64>() / picture.width as f64;
                std::f64::consts::PI * (square(row + 1) - square(row)) * mean
            });
            (nm, rows.sum::<f64>())
        })
        .unzip();
    let spectrum = papilio_spectra::Tabulated::new(nm, irradiance).unwrap().on(&scene.grid).unwrap();
    let lux = papilio_colour::Observer::new(&scene.grid).unwrap().luminance(&spectrum);
    // The map has half of the light.
    let found = 0.5 * scene.lighting.illuminance_lx;
    assert!((found / lux - 1.0).abs() < 1e-6, "{found} against {lux}");
}

#[test]
fn wrong_regions_and_illuminances_are_refused() {
    let office = "model = \"map\"\nfile = \"data/synthetic-office.hdr\"\nshare = 0.5\n";
    let hall = office.replace("office.hdr", "hall.exr");
    let from_map = |text: String| text.replace("illuminance_lx = 500", "illuminance_lx = \"from-map\"");
    for (text, wanted) in [
        (
            with(&format!("{hall}regions = [{{ spectrum = \"A\" }}]")),
            "`regions` cannot be combined with a map that has spectra",
        ),
        (
            with(&format!("{office}regions = [{{ spectrum = \"A\", elevation_deg = [30, 20] }}]")),
            "this region reaches from 30 to 20 deg",
        ),
        (
            with(&format!("{office}regions = [{{ spectrum = \"A\", azimuth_deg = [1, 2, 3] }}]")),
            "expected two angles",
        ),
        (with(&format!("{office}regions = [{{ elevation_deg = [0, 20] }}]")), "`spectrum` is missing"),
        (from_map(GOOD.to_owned()), "needs one map, and there are 0"),
        (GOOD.replace("illuminance_lx = 500", "illuminance_lx = \"map\""), "\"from-map\""),
    ] {
        let error = resolve(&text, &shipped(), &[]).unwrap_err().to_string();
        assert!(error.contains(wanted) && error.contains("test.toml:"), "{wanted}: {error}");
    }
    // A map that cannot be read is one error.
    let missing = from_map(with(&office.replace("synthetic", "missing")));
    let error = resolve(&missing, &shipped(), &[]).unwrap_err().to_string();
    assert!(error.matches("error: ").count() == 1 && error.contains("missing-office.hdr"), "{error}");
    let small = with(&format!("{office}regions = [{{ spectrum = \"A\", elevation_deg = [10, 10.1] }}]"));
    let resolved = resolve(&small, &shipped(), &[]).unwrap();
    assert!(
        resolved.warnings.iter().any(|warning| warning.contains("smaller than a pixel")),
        "{:?}",
        resolved.warnings
    );
}
