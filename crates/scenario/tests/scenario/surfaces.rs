//! Files of surfaces: the shipped ones resolve, maps of heights are read, and mistakes are named with their
//! places.

use std::path::Path;

use papilio_display::DisplayError;
use papilio_display::scene::{Interface, SurfaceModel};
use papilio_microgeometry::{Coating, MicrogeometryError, Surface};
use papilio_scenario::{ScenarioErrors, SurfaceScenario};

const CAPS: &str =
    "[microgeometry]\nsurface = \"caps\"\npitch_um = 4.5\nradius_um = 2.25\naperture_radius_um = 2.25\n";

fn resolved(text: &str, folder: &Path) -> Result<Surface, ScenarioErrors> {
    Ok(SurfaceScenario::from_text(text, "s.toml", folder, &[])?.resolve()?.measurement.surface)
}

fn wrong(text: &str, folder: &Path) -> String {
    resolved(text, folder).unwrap_err().to_string()
}

#[test]
fn shipped_surfaces_resolve() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../surfaces");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let found = SurfaceScenario::load(&path, &[]).and_then(|surface| surface.resolve());
            let found = found.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            assert!(found.title.is_some() && found.measurement.goniometer.incidence_deg.len() == 18);
            count += 1;
        }
    }
    assert!(count >= 5);
}

#[test]
fn mistakes_have_their_places() {
    let here = Path::new("");
    for (text, expected) in [
        (CAPS.replace("pitch_um = 4.5", "pitch_um = 4"), "s.toml:3:12"),
        (CAPS.replace("aperture_radius_um = 2.25", "aperture_radius_um = 2.5"), "s.toml:5:22"),
        (CAPS.replace("pitch_um = 4.5", "pitch_um = -1"), "-1 is out of range"),
        (CAPS.replace("pitch_um", "pitch"), "pitch_um"),
        (CAPS.replace("\"caps\"", "\"cap\""), "`caps`"),
        ("[microgeometry]\nsurface = \"exponential\"\nrms_nm = 100\ncorrelation_um = 5\n".to_owned(), "cutoff_um"),
        (
            "[microgeometry]\nsurface = \"exponential\"\nrms_nm = 100\ncorrelation_um = 5\ncutoff_um = 0.01\n".to_owned(),
            "expected at most 4096 along a side",
        ),
        ("[microgeometry]\nsurface = \"psd\"\nabc = [1, 2]\ncutoff_um = 1\n".to_owned(), "three numbers: A (um^4)"),
        (format!("{CAPS}incidence_deg = [10, -20]\n"), "s.toml:6:22"),
        (format!("{CAPS}azimuth_deg = 50\n"), "s.toml:6:15"),
        (format!("{CAPS}azimuth_deg = 50\n"), "not a whole number of steps of 50 deg"),
        (format!("{CAPS}azimuth_deg = 5\n"), "the finest whole step is 12 deg"),
        (format!("{CAPS}azimuth_deg = 15\nroad = \"waves\"\n"), "waves do not tell azimuths"),
        ("[display.pixel]\nmodel = \"film\"\n".to_owned(), "the scenario of a display"),
        ("title = \"nothing\"\n".to_owned(), "microgeometry"),
    ] {
        let message = wrong(&text, here);
        assert!(message.contains(expected), "{text}\n{message}");
    }
}

/// Mirrors, metals of the catalogue and of numbers, and films; what cannot be a coating is named with its
/// place.
#[test]
fn coatings_are_resolved() {
    let coating = |keys: &str| {
        let text = format!("{CAPS}coating = {{ {keys} }}\n");
        let scenario = SurfaceScenario::from_text(&text, "s.toml", Path::new(""), &[]);
        scenario.and_then(|scenario| scenario.resolve()).map(|found| found.measurement.goniometer.coating)
    };
    assert_eq!(coating("kind = \"mirror\"").unwrap(), Coating::Mirror { reflectance: 1.0 });
    let Coating::Metal { index } =
        coating("kind = \"metal\", material = \"Al\", wavelength_nm = 550").unwrap()
    else {
        panic!("no metal")
    };
    assert!((0.5..1.5).contains(&index.re) && (5.0..8.0).contains(&index.im), "{index}");
    let film = "kind = \"film\", film = [{ material = 1.38, thickness_nm = 99.6 }]";
    assert!(matches!(coating(film).unwrap(), Coating::Films(_)));
    for (keys, expected) in [
        ("kind = \"metal\", material = 1.5", "is not that of a metal"),
        ("kind = \"metal\", material = \"Unobtainium\"", "Unobtainium"),
        ("kind = \"metal\", material = \"Al\", wavelength_nm = 1", "s.toml:6"),
        ("kind = \"film\", film = []", "0 films"),
        ("kind = \"mirror\", reflectance = 1.5", "out of range"),
        ("kind = \"paint\"", "expected \"mirror\" or \"metal\" or \"film\""),
    ] {
        let message = coating(keys).unwrap_err().to_string();
        assert!(message.contains(expected), "{keys}\n{message}");
    }
    let waves = format!("{CAPS}road = \"both\"\ncoating = {{ kind = \"mirror\" }}\n");
    assert!(wrong(&waves, Path::new("")).contains("waves do not know what lies on the facets"));
}

/// A density by a file, as `psd.csv` of `papilio gonio`; mistakes in it have their lines.
#[test]
fn densities_of_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("psd.csv", "frequency_per_um,psd_um4\n0.01,2\n0.1,1.5\n1,0.01\n");
    write("order.csv", "0.1,2\n0.1,1\n");
    write("negative.csv", "0.1,2\n0.2,-1\n");
    write("dark.csv", "0.1,0\n");
    let text = |keys: &str| format!("[microgeometry]\nsurface = \"psd\"\n{keys}\ncutoff_um = 2\n");
    let Surface::Random(face) = resolved(&text("file = \"psd.csv\""), folder.path()).unwrap() else {
        panic!()
    };
    assert!((face.density_um4(0.005) - 2.0).abs() < 1e-12 && face.density_um4(0.6) == 0.0);
    // Halfway between two points on logarithmic axes.
    assert!((face.density_um4(0.1 * 10_f64.sqrt()) - (1.5_f64 * 0.01).sqrt()).abs() < 1e-12);
    for (keys, expected) in [
        ("file = \"order.csv\"", "order.csv:2:1"),
        ("file = \"negative.csv\"", "negative.csv:2:5"),
        ("file = \"dark.csv\"", "no density above 0"),
        ("file = \"psd.csv\"\nabc = [1, 2, 3]", "both `abc` and `file` are given"),
        ("", "neither `abc` nor `file` is given"),
    ] {
        let message = wrong(&text(keys), folder.path());
        assert!(message.contains(expected), "{keys}\n{message}");
    }
}

#[test]
fn meshes_and_volumes_are_resolved() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("flat.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 4 3 2\n");
    write("open.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3\n");
    write("wrong.obj", "v 0 0 0\nf 1 2 3\n");
    let mesh =
        |file: &str, more: &str| format!("[microgeometry]\nsurface = \"mesh\"\nfile = \"{file}\"\n{more}");
    let scenario =
        SurfaceScenario::from_text(&mesh("flat.obj", "um_per_unit = 1000\n"), "s.toml", folder.path(), &[]);
    let found = scenario.and_then(|scenario| scenario.resolve()).unwrap();
    let Surface::Mesh(flat) = &found.measurement.surface else { panic!("no mesh") };
    assert_eq!((flat.triangles(), flat.period_um()), (2, [2000.0, 1000.0]));
    assert!(found.notes.iter().any(|note| note.contains("were turned")), "{:?}", found.notes);
    assert!(found.canonical["inputs"]["flat.obj"].is_string());
    let volume = |radius: f64, more: &str| {
        format!(
            "[microgeometry]\nsurface = \"volume\"\nradius_um = {radius}\nvolume_fraction = 0.1\nthickness_um = 60\n{more}"
        )
    };
    let Surface::Volume(voids) = resolved(&volume(5.0, "index = 1\n"), folder.path()).unwrap() else {
        panic!()
    };
    assert_eq!((voids.index, voids.length_um), (1.0, 0.0));
    for (text, expected) in [
        (mesh("open.obj", ""), "is open: it belongs to one triangle"),
        (mesh("flat.obj", "period_um = [3, 1]\n"), "is open"),
        (mesh("flat.obj", "period_um = [3]\n"), "two lengths, along x and y"),
        (mesh("flat.obj", "road = \"waves\"\n"), "s.toml:4:8"),
        (mesh("wrong.obj", ""), "wrong.obj:2:1"),
        (mesh("none.obj", ""), "s.toml:3:8"),
        (volume(1.0, "index = 1\n"), "docs/scattering.md"),
        (volume(5.0, "index = 1.5\n"), "have the index of the matrix"),
        (volume(31.0, "index = 1\n"), "do not fit into a slab of 60 um"),
        (volume(5.0, "index = 1\n").replace("0.1", "0.5"), "cannot be placed one by one"),
    ] {
        let message = wrong(&text, folder.path());
        assert!(message.contains(expected), "{text}\n{message}");
    }
}

#[test]
fn maps_of_heights_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    // A plane of slope 1/2 and -1/4 per um along x and y with one bump: rows of a text begin at the top,
    // profiles of ISO 25178-71 at the bottom.
    write("rows.csv", b"# um\n1.0 1.5 2.0\n0.75 4.25 1.75\n0.5 1.0 1.5\n");
    let sdf = "aISO-1.0\nManufacID = X\nNumPoints = 3\nNumProfiles = 3\nXscale = 1e-6\nYscale = 1e-6\nZscale = 1e-9\n*\n\
        500 1000 1500 750 4250 1750 1000 1500 2000\n*\n";
    write("map.sdf", sdf.as_bytes());
    let text = |file: &str, more: &str| {
        format!(
            "[microgeometry]\nsurface = \"height-map\"\nfile = \"{file}\"\nlevel = false\nperiod = \"repeat\"\n{more}"
        )
    };
    let heights = |file: &str, more: &str| match resolved(&text(file, more), folder.path()).unwrap() {
        Surface::Heights(map) => (map.columns(), map.pitch_um(), map.heights_um().to_vec()),
        other => panic!("{other:?}"),
    };
    let expected = vec![0.5, 1.0, 1.5, 0.75, 4.25, 1.75, 1.0, 1.5, 2.0];
    for one_number in ["pixel_um = [1]\n", "pixel_um = 1.0\n"] {
        assert_eq!(heights("rows.csv", one_number), (3, [1.0; 2], expected.clone()));
    }
    let (columns, pitch_um, found) = heights("map.sdf", "");
    assert_eq!((columns, pitch_um), (3, [1.0; 2]));
    found.iter().zip(&expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-12, "{a} {b}"));
    // Levelled, the corners of the plane differ by nothing; the bump of 3 um above the plane remains.
    let level = text("rows.csv", "pixel_um = [1]\n").replace("level = false", "level = true");
    let Surface::Heights(level) = resolved(&level, folder.path()).unwrap() else { panic!() };
    let corners = [0, 2, 6, 8].map(|at| level.heights_um()[at]);
    assert!(corners.iter().all(|corner| (corner - corners[0]).abs() < 1e-12), "{corners:?}");
    assert!((level.heights_um()[4] - corners[0] - 3.0).abs() < 1e-12);
    // Mirrored, the period is twice as long.
    let mirrored = text("rows.csv", "pixel_um = [1, 2]\n").replace("\"repeat\"", "\"mirror\"");
    let Surface::Heights(mirrored) = resolved(&mirrored, folder.path()).unwrap() else { panic!() };
    assert_eq!((mirrored.columns(), mirrored.rows(), mirrored.pitch_um()), (6, 6, [1.0, 2.0]));
    assert_eq!(&mirrored.heights_um()[..6], [0.5, 1.0, 1.5, 1.5, 1.0, 0.5]);

    write("holes.sdf", sdf.replace("4250", "BAD").as_bytes());
    write("short.sdf", sdf.replace("1500 2000\n*", "1500\n*").as_bytes());
    write("scale.sdf", sdf.replace("1e-9", "0").as_bytes());
    write("ragged.csv", b"1 2\n3\n");
    write("word.csv", b"1 2\n3 x\n");
    write("text.csv", b"hello world\n");
    write("one.csv", b"1\n2\n");
    write(
        "cube.npy",
        b"\x93NUMPY\x01\x00\x46\x00{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2, 2), }         \n",
    );
    write(
        "huge.npy",
        b"\x93NUMPY\x01\x00\x46\x00{'descr': '<f8', 'fortran_order': False, 'shape': (90000, 90000), }    \n",
    );
    for (file, more, message) in [
        ("rows.csv", "", "does not state the distance of its heights"),
        ("holes.sdf", "", "1 of 9 heights are missing"),
        ("short.sdf", "", "8 heights, and its header 9"),
        ("scale.sdf", "", "a scale is 0 m"),
        ("ragged.csv", "pixel_um = [1]\n", "as many numbers as the first row"),
        ("word.csv", "pixel_um = [1]\n", "word.csv:2:3"),
        ("text.csv", "pixel_um = [1]\n", "not a map of heights in a supported format"),
        ("one.csv", "pixel_um = [1]\n", "1 x 2 heights"),
        ("cube.npy", "pixel_um = [1]\n", "3 dimensions"),
        ("huge.npy", "pixel_um = [1]\n", "90000 x 90000 heights"),
        ("missing.npy", "pixel_um = [1]\n", "s.toml:3:8"),
        ("rows.csv", "pixel_um = [1, 2, 3]\n", "one distance, or those along x and y"),
    ] {
        let found = wrong(&text(file, more), folder.path());
        assert!(found.contains(message), "{file}: {found}");
    }
}

/// A spike that would cost hours is refused before, and slopes that no instrument measures are doubted; so is
/// a distance that contradicts the file.
#[test]
fn implausible_heights_are_refused_or_doubted() {
    let folder = tempfile::tempdir().unwrap();
    let text = |file: &str, more: &str| {
        format!("[microgeometry]\nsurface = \"height-map\"\nfile = \"{file}\"\nperiod = \"repeat\"\n{more}")
    };
    let write = |name: &str, spike: &str| {
        let row = "0.01 0.02 0.01 0 0.01 0.02 0.01 0\n";
        let spiked = row.replacen("0.01", spike, 1);
        std::fs::write(folder.path().join(name), format!("{}{spiked}{}", row.repeat(4), row.repeat(3)))
            .unwrap();
    };
    let notes = |file: &str, more: &str| {
        let found = SurfaceScenario::from_text(&text(file, more), "s.toml", folder.path(), &[]);
        found.and_then(|surface| surface.resolve()).unwrap().notes
    };
    write("flat.csv", "0.01");
    write("spike.csv", "1e6");
    write("steep.csv", "40");
    assert_eq!(notes("flat.csv", "pixel_um = 1\n"), Vec::<String>::new());
    let refused = wrong(&text("spike.csv", "pixel_um = 1\n"), folder.path());
    assert!(refused.contains("s.toml:3:8") && refused.contains("1000000 times the distance"), "{refused}");
    assert!(refused.contains("a spike?"), "{refused}");
    // 39.99 um up and down again along y, on a grid of 1 um: two of 56 slopes. A spike is no tilt.
    let doubted = notes("steep.csv", "pixel_um = 1\n");
    let slope = (2.0_f64 * 39.99 * 39.99 / 56.0).sqrt();
    let wanted = format!("steep.csv: the slopes along y are {slope:.3} rms");
    assert!(doubted.len() == 1 && doubted[0].contains(&wanted), "{wanted}: {doubted:?}");
    std::fs::write(folder.path().join("points.csv"), "0 0 1\n2 0 1\n0 2 1\n2 2 1.1\n").unwrap();
    let contradicted = notes("points.csv", "pixel_um = 1\n");
    assert!(contradicted.iter().any(|note| note.contains("`pixel_um` is used instead")), "{contradicted:?}");
}

/// No file of heights makes the reader panic: cut off and changed SDF files and arrays.
#[test]
fn damaged_maps_are_errors() {
    let binary = {
        let mut bytes = b"bISO-1.0".to_vec();
        bytes.extend([b' '; 34]);
        bytes.extend(2_u16.to_le_bytes().repeat(2));
        bytes.extend([1e-6_f64, 1e-6, 1e-9, 1e-9].into_iter().flat_map(f64::to_le_bytes));
        bytes.extend([0, 7, 0]);
        bytes.extend([1.0_f64, 2.0, 3.0, 4.0].into_iter().flat_map(f64::to_le_bytes));
        bytes
    };
    let read = |bytes: Vec<u8>| {
        papilio_formats::read_heights(&papilio_formats::DataFile { name: "map".to_owned(), bytes })
    };
    let map = read(binary.clone()).unwrap();
    assert_eq!((map.columns, map.numbers), (2, vec![1.0, 2.0, 3.0, 4.0]));
    assert!((map.pitch_um.unwrap()[0] - 1.0).abs() < 1e-12 && (map.unit_um.unwrap() - 1e-3).abs() < 1e-15);
    for length in 0..binary.len() {
        assert!(read(binary[..length].to_vec()).is_err(), "{length} bytes");
    }
    let mut dice = papilio_testing::Dice::new(0x5d1, 0);
    for _ in 0..2000 {
        let mut bytes = binary.clone();
        for _ in 0..1 + dice.below(4) {
            let at = dice.below(bytes.len());
            bytes[at] = dice.bits() as u8;
        }
        if let Ok(map) = read(bytes) {
            assert!(map.numbers.iter().all(|number| number.is_finite()));
        }
    }
}

/// A face as a layer: its neighbours decide its indices, and wrong combinations are named with their places.
#[test]
fn faces_are_layers_between_known_media() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../surfaces");
    let pixel = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.5, black = 0.1 }\n[lighting]\nilluminance_lx \
                 = 500\nspectrum = \"D65\"\ndiffuse = 1\n";
    let text = |keys: &str, index: &str| {
        format!(
            "[[display.layers]]\nkind = \"diffuser\"\nmodel = \"microgeometry\"\n{keys}\n[[display.layers]]\nkind = \"medium\"\nindex = \
             {index}\n{pixel}"
        )
    };
    let resolved = |keys: &str, index: &str| {
        let scenario = papilio_scenario::Scenario::from_text(&text(keys, index), "d.toml", &folder, &[]);
        scenario.and_then(|scenario| scenario.resolve())
    };
    let hemispheres = "surface = \"hemispheres.toml\"\nrays = 64";
    let found = resolved(hemispheres, "1.6").unwrap_or_else(|error| panic!("{error}"));
    let Interface::OfSurface(face) = &found.scene.display.layers[0].interface else { panic!("no face") };
    let SurfaceModel::Rays { goniometer, .. } = &face.model else { panic!("not by rays") };
    assert_eq!([goniometer.index_above, goniometer.index_below], [1.0, 1.6]);
    // What only the measurement can find names the key, too.
    let error = MicrogeometryError::LostRays { lost: 3, rays: 64 };
    let wrong = found.located(&DisplayError::Surface { key: face.key.clone(), error }).unwrap().to_string();
    assert!(wrong.contains("d.toml:4:11") && wrong.contains("3 of 64 rays were lost"), "{wrong}");
    let smaller = resolved(&format!("{hemispheres}\npitch_um = 6"), "1.6").unwrap();
    assert!(smaller.scene.display.layers != found.scene.display.layers && smaller.hash != found.hash);
    for (keys, index, expected) in [
        ("rays = 64", "1.5", "neither `file` nor `surface` is given"),
        ("file = \"a.npz\"\nsurface = \"hemispheres.toml\"", "1.5", "both `file` and `surface` are given"),
        ("surface = \"none.toml\"", "1.5", "d.toml:4:11"),
        ("surface = \"spheres.toml\"", "1.6", "a volume is no face"),
        (hemispheres, "\"BK7\"", "depends on wavelength"),
        (hemispheres, "1", "have the same index"),
        ("surface = \"hemispheres.toml\"\nrms_nm = 5", "1.5", "rms_nm"),
        ("surface = \"hemispheres.toml\"\npitch_um = 1", "1.5", "overlap"),
        ("file = \"hemispheres.toml\"", "1.5", "this is not the kernel of a face"),
        ("file = \"a.npz\"\npitch_um = 5", "1.5", "`pitch_um` cannot change a kernel"),
    ] {
        let message = resolved(keys, index).unwrap_err().to_string();
        assert!(message.contains(expected), "{keys}\n{message}");
    }
}

/// A display may have several faces with Gaussian heights: none of them is the antiglare face then; a single
/// one is.
#[test]
fn several_gaussian_faces_are_no_antiglare_face() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../surfaces");
    let face = "[[display.layers]]\nkind = \"diffuser\"\nmodel = \"microgeometry\"\nsurface = \"etched.toml\"\nrays = 64\n";
    let medium = |index: f64| format!("[[display.layers]]\nkind = \"medium\"\nindex = {index}\n");
    let rest = "[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.5, black = 0.1 }\n[lighting]\n\
                illuminance_lx = 500\nspectrum = \"D65\"\ndiffuse = 1\n";
    let sparkle = |layers: String, more: &str| {
        let text = format!("{layers}{rest}{more}");
        let scenario = papilio_scenario::Scenario::from_text(&text, "d.toml", &folder, &[]);
        scenario.and_then(|scenario| scenario.resolve()).map(|found| found.sparkle)
    };
    let one = format!("{face}{}", medium(1.5));
    let two = format!("{one}{face}{}", medium(1.3));
    let correlation = |found: papilio_display::spatial::Antiglare| found.faces[0].correlation_mm();
    assert_eq!(correlation(sparkle(one, "").unwrap().unwrap()), 0.01);
    assert_eq!(sparkle(two.clone(), "").unwrap(), None);
    let own = sparkle(two.clone(), "[sparkle]\nslope_rms = 0.03\ncorrelation_um = 8\n").unwrap().unwrap();
    assert_eq!((own.faces[0].slope_rms(), own.layer), (0.03, 0));
    // A rough layer with `correlation_um` is asked for: it is preferred, and a second one is refused.
    let rough = "[[display.layers]]\nkind = \"rough\"\ndistribution = \"beckmann\"\nalpha = 0.03\ncorrelation_um = 8\n";
    let preferred = format!("{two}{rough}{}", medium(1.5));
    assert_eq!(correlation(sparkle(preferred.clone(), "").unwrap().unwrap()), 0.008);
    let message = sparkle(format!("{preferred}{rough}{}", medium(1.3)), "").unwrap_err().to_string();
    assert!(message.contains("more than one rough layer has a `correlation_um`"), "{message}");
    let message = sparkle(two, "[sparkle]\nreplicates = 4\n").unwrap_err().to_string();
    assert!(message.contains("the key `slope_rms` is missing"), "{message}");
}

/// The road, and the wavelengths of waves.
#[test]
fn surfaces_are_measured_by_rays_or_waves() {
    let road = |keys: &str| {
        let found = SurfaceScenario::from_text(&format!("{CAPS}{keys}"), "s.toml", Path::new(""), &[]);
        let found = found.and_then(|surface| surface.resolve()).unwrap();
        (found.measurement.by_rays, found.measurement.waves_nm)
    };
    assert_eq!(road(""), (true, vec![]));
    assert_eq!(road("road = \"waves\"\nwavelength_nm = [450, 650]\n"), (false, vec![450.0, 650.0]));
    let (rays, waves) = road("road = \"both\"\n");
    assert!(rays && waves.len() == 7);
}

/// The schema of a surface has the keys of every kind, with labels, units and ranges.
#[test]
fn schema_of_a_surface_describes_every_kind() {
    let schema = papilio_scenario::surface_schema();
    let kinds = schema.pointer("/$defs/Microgeometry/oneOf").unwrap().as_array().unwrap();
    assert_eq!(kinds.len(), 8);
    let caps = kinds.iter().find(|kind| kind["properties"]["surface"]["const"] == "caps").unwrap();
    let pitch = &caps["properties"]["pitch_um"];
    assert!(pitch["title"].is_string() && pitch["x-unit"].as_str().unwrap().ends_with('m'), "{pitch}");
}
