//! Exports of a display's BSDF, read back: RGL tensor files, tables of Radiant and Zemax, CSV and Klems
//! matrices.

use std::f64::consts::PI;

use papilio_display::{
    BrdfGrid, BrdfState, BrdfTable, HalfVectorGrid, HalfVectorTable, LobeWidths, RingGrid, RingTable,
    RowErrors, ViewerGrid,
};
use papilio_formats::{
    BsdfSource, DataFile, read_bsdf, scene_script, write_bsdf_csv, write_bsdf_radiant, write_indexed_png,
    write_mirror_csv, write_rgl,
};
use papilio_goniometry::{Direction, Fill, Geometry, MeasuredPart, ScatterMode, Shape};

const SOURCE: BsdfSource<'_> = BsdfSource { papilio: "0", title: "a \"panel\"", hash: "00" };

/// Table of a display with f(theta_i, theta_o, dphi), degrees, at two wavelengths; twice as much at the
/// second.
fn table(step_deg: f64, size: usize, f: impl Fn(f64, f64, f64) -> f64) -> HalfVectorTable {
    // The lobe has a half-width of 12.6 deg, and half vectors half of it.
    let grid = HalfVectorGrid::new(step_deg, size, &LobeWidths::constant(6.3));
    let mut brdf = Vec::new();
    for (light, theta_i) in grid.theta_i_deg.iter().enumerate() {
        for viewer in grid.viewers(light).0 {
            let value = f(*theta_i, viewer.theta_o_deg, viewer.dphi_deg) as f32;
            brdf.extend([value, 2.0 * value]);
        }
    }
    let beams = vec![0.0; 2 * grid.theta_i_deg.len()];
    let state = BrdfState {
        name: "white".to_owned(),
        brdf,
        specular: beams.clone(),
        directional_hemispherical: beams,
    };
    HalfVectorTable {
        grid,
        wavelength_nm: vec![500.0, 600.0],
        states: vec![state],
        nodes: 0,
        discretisation_error: 0.0,
        row_errors: RowErrors::default(),
    }
}

/// The bytes of the RGL file, and its only part as read back.
fn written(table: &HalfVectorTable) -> (Vec<u8>, MeasuredPart) {
    let mut bytes = Vec::new();
    write_rgl(&mut bytes, &SOURCE, table, 0).unwrap();
    let file = DataFile { name: "white.bsdf".to_owned(), bytes: bytes.clone() };
    let read = read_bsdf(&file).unwrap();
    assert!(read.value.provenance.sample.contains("state white"), "{:?}", read.value.provenance);
    (bytes, read.value.parts.into_iter().next().unwrap())
}

fn lambertian(_: f64, _: f64, _: f64) -> f64 {
    1.0 / PI
}

/// A lobe of 15 deg about the mirror direction in direction cosines, reciprocal.
fn lobe(theta_i: f64, theta_o: f64, dphi: f64) -> f64 {
    let [i, o] = [theta_i, theta_o].map(|theta| theta.to_radians().sin());
    let distance = i * i + o * o + 2.0 * i * o * dphi.to_radians().cos();
    0.1 + 2.0 * (-distance / 0.07).exp()
}

/// The integral of f cos(theta_o) over the hemisphere.
fn total(f: impl Fn(Direction) -> f64) -> f64 {
    let (rings, arcs) = (120, 72);
    let mut sum = 0.0;
    for ring in 0..rings {
        // Rings of equal sin^2 have equal projected solid angles.
        let theta_deg = ((f64::from(ring) + 0.5) / f64::from(rings)).sqrt().asin().to_degrees();
        for arc in 0..arcs {
            sum += f(Direction::new(theta_deg, (f64::from(arc) + 0.5) * 360.0 / f64::from(arcs)));
        }
    }
    sum * PI / f64::from(rings * arcs)
}

#[test]
fn rgl_file_of_a_perfect_white_has_its_cosine_at_all_nodes() {
    let table = table(30.0, 32, lambertian);
    let (_, part) = written(&table);
    let Geometry::Warped(grid) = &part.geometry else { panic!("a warped grid") };
    assert_eq!((grid.fields().shape, part.channels.len()), ([32, 32], 2));
    let mut above = 0;
    for (light, theta_i) in table.grid.theta_i_deg.iter().enumerate() {
        let nodes = table.grid.nodes(light);
        for (node, at) in nodes.iter().enumerate() {
            let viewer = HalfVectorGrid::viewer(*theta_i, *at);
            let value = part.channel(0)[light * 32 * 32 + node];
            let expected = viewer.map_or(0.0, |viewer| viewer.cos_theta_o / PI);
            assert!((value - expected).abs() < 1e-6, "{theta_i} deg, node {node}: {value} {expected}");
            above += usize::from(viewer.is_some());
        }
    }
    assert!(above > 1000);
}

/// Between the nodes, too: the total integrated scatter, at nodes of theta_i and between them.
#[test]
fn rgl_file_read_back_has_the_total_integrated_scatter() {
    let (_, part) = written(&table(10.0, 64, lambertian));
    for theta in [0.0, 14.0, 45.0, 80.0] {
        let light = Direction::new(theta, 0.0);
        let tis = total(|o| part.evaluate(0, light, o).unwrap());
        assert!((tis - 1.0).abs() < 5e-3, "{theta}: {tis}");
    }
    let (_, part) = written(&table(5.0, 64, lobe));
    for theta in [0.0, 12.0, 40.0, 65.0] {
        let light = Direction::new(theta, 0.0);
        let expected = total(|o| lobe(theta, o.theta_deg, o.phi_deg));
        let tis = total(|o| part.evaluate(0, light, o).unwrap());
        assert!((tis / expected - 1.0).abs() < 5e-3, "{theta}: {tis} {expected}");
        let second = part.evaluate(1, light, Direction::new(20.0, 180.0)).unwrap();
        let first = part.evaluate(0, light, Direction::new(20.0, 180.0)).unwrap();
        assert!((second / first - 2.0).abs() < 1e-5);
    }
}

#[test]
fn rgl_file_read_back_is_reciprocal() {
    let (_, part) = written(&table(5.0, 64, lobe));
    for (one, other, dphi) in
        [(10.0, 35.0, 180.0), (20.0, 50.0, 120.0), (0.0, 30.0, 0.0), (40.0, 60.0, 170.0)]
    {
        let f = |from: f64, to: f64| {
            part.evaluate(0, Direction::new(from, 0.0), Direction::new(to, dphi)).unwrap()
        };
        let (there, back, exact) = (f(one, other), f(other, one), lobe(one, other, dphi));
        assert!((there / back - 1.0).abs() < 0.02, "{one}, {other}: {there} {back}");
        assert!((there / exact - 1.0).abs() < 0.02, "{one}, {other}: {there} {exact}");
    }
}

/// Readers normalise the densities: there is one for each light, also where nothing is scattered (a bare
/// panel).
#[test]
fn rgl_file_has_a_density_of_directions_for_each_light() {
    for f in [lambertian as fn(f64, f64, f64) -> f64, lobe, |_, _, _| 0.0] {
        let table = table(45.0, 16, f);
        let (bytes, _) = written(&table);
        let nodes = 16 * 16;
        // The arrays are at the end, in this order: luminance, spectra, jacobian.
        let lights = table.grid.theta_i_deg.len();
        let spectra = 4 * lights * 2 * nodes;
        let jacobian = bytes.len() - 1;
        let start = jacobian - spectra - 4 * lights * nodes;
        let numbers: Vec<f32> = bytes[start..start + 4 * lights * nodes]
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect();
        for light in numbers.chunks_exact(nodes) {
            assert!(light.iter().all(|value| *value >= 0.0 && value.is_finite()));
            assert!(light.iter().sum::<f32>() > 0.0);
        }
    }
}

/// A table of a Lambertian display on a grid.
fn grid_table(step_deg: f64) -> BrdfTable {
    let grid = BrdfGrid::even(step_deg);
    let wavelength_nm: Vec<f64> = (0..9).map(|k| 380.0 + 50.0 * f64::from(k)).collect();
    let (bins, lights) = (wavelength_nm.len(), grid.theta_i_deg.len());
    let state = BrdfState {
        name: "dark, red".to_owned(),
        brdf: vec![0.25; grid.pairs() * bins],
        specular: vec![0.04; lights * bins],
        directional_hemispherical: vec![0.5; lights * bins],
    };
    let relative = vec![1e-4; grid.pairs()];
    BrdfTable {
        grid,
        wavelength_nm,
        states: vec![state],
        nodes: 0,
        discretisation_error: 1e-4,
        row_errors: RowErrors { relative, target: 1e-3, allowed: None },
    }
}

#[test]
fn csv_has_a_row_for_each_pair_of_directions_and_wavelength() {
    let table = grid_table(30.0);
    let mut text = Vec::new();
    write_bsdf_csv(&mut text, &table, 0).unwrap();
    let text = String::from_utf8(text).unwrap();
    let rows: Vec<&str> = text.lines().collect();
    assert_eq!(rows[0], "theta_i_deg,theta_o_deg,dphi_deg,wavelength_nm,brdf,error");
    assert_eq!(rows[1], "0,0,0,380,0.25,1.00e-4");
    assert_eq!(rows.len(), 1 + 3 * 3 * 7 * 9);
    assert!(write_bsdf_csv(Vec::new(), &table, 1).is_err());
    let file = DataFile { name: "grey.csv".to_owned(), bytes: text.as_bytes().to_vec() };
    let read = read_bsdf(&file).unwrap().value;
    let part = &read.parts[0];
    assert!(matches!(part.geometry, Geometry::Spherical(_)) && part.channels.len() == 9);
    assert_eq!(part.evaluate(3, Direction::new(10.0, 0.0), Direction::new(40.0, 170.0)), Some(0.25));
    let mut text = Vec::new();
    write_mirror_csv(&mut text, &table).unwrap();
    let text = String::from_utf8(text).unwrap();
    assert_eq!(text.lines().nth(1), Some("\"dark, red\",0,380,0.04,0.5"));
    assert_eq!(text.lines().count(), 1 + 3 * 9);
}

/// A lobe, read back: X, Y, Z of a grey display are equal, their integral is the TIS, and the mirror part is
/// in neither.
#[test]
fn radiant_file_read_back_has_the_values_and_the_total_integrated_scatter() {
    let lights: Vec<f64> = (0..6).map(|k| 15.0 * f64::from(k)).collect();
    let grid = RingGrid::about_lights(lights, &LobeWidths::constant(6.3));
    let wavelength_nm: Vec<f64> = (0..9).map(|k| 380.0 + 50.0 * f64::from(k)).collect();
    let (mut brdf, mut leaving) = (Vec::new(), Vec::new());
    for (light, theta_i) in grid.theta_i_deg.iter().enumerate() {
        for viewer in grid.viewers(light).0 {
            brdf.extend([lobe(*theta_i, viewer.theta_o_deg, viewer.dphi_deg) as f32; 9]);
        }
        leaving.extend([0.04 + total(|o| lobe(*theta_i, o.theta_deg, o.phi_deg)); 9]);
    }
    let specular = vec![0.04; leaving.len()];
    let name = "white".to_owned();
    let state = BrdfState { name, brdf, specular, directional_hemispherical: leaving };
    let table = RingTable {
        grid,
        wavelength_nm,
        states: vec![state],
        nodes: 0,
        discretisation_error: 0.0,
        row_errors: RowErrors::default(),
    };
    let mut bytes = Vec::new();
    write_bsdf_radiant(&mut bytes, &SOURCE, &table, 0).unwrap();
    let read = read_bsdf(&DataFile { name: "white.bsdf".to_owned(), bytes }).unwrap();
    assert_eq!(read.warnings, [""; 0]);
    assert_eq!(read.value.provenance.sample, "a \"panel\" (white)");
    let part = &read.value.parts[0];
    assert_eq!((part.way, part.channels.len()), (ScatterMode::FrontReflection, 3));
    for channel in 0..3 {
        let shape = Shape::of_part(part, channel, Fill::None).unwrap();
        for (k, theta) in table.grid.theta_i_deg.iter().enumerate() {
            let expected = total(|o| lobe(*theta, o.theta_deg, o.phi_deg));
            let tis = part.tis[channel * 6 + k];
            assert!((tis / expected - 1.0).abs() < 1e-6, "{theta}: {tis} {expected}");
            assert!((shape.total(k) / tis - 1.0).abs() < 5e-3, "{theta}: {} {tis}", shape.total(k));
            let light = Direction::new(*theta, 0.0);
            let ratio = |theta_o: f64, dphi: f64| {
                let value = part.evaluate(channel, light, Direction::new(theta_o, dphi)).unwrap();
                value / lobe(*theta, theta_o, dphi)
            };
            for (azimuth, radial) in [(0.0, 0.0), (0.0, 10.0), (50.0, 4.5), (120.0, 12.0), (30.0, 60.0)] {
                let Some(viewer) = RingGrid::viewer(*theta, azimuth, radial) else { continue };
                let at_node = ratio(viewer.theta_o_deg, viewer.dphi_deg);
                assert!((at_node - 1.0).abs() < 1e-5, "{theta}, {azimuth}, {radial}: {at_node}");
            }
            // Between nodes, `evaluate` is linear: least accurate on the flank of the lobe at 75 deg, by 0.9
            // %.
            for (theta_o, dphi) in [(20.0, 180.0), (40.0, 150.0), (10.0, 30.0)] {
                let between = ratio(theta_o, dphi);
                assert!(
                    (between - 1.0).abs() < if *theta < 75.0 { 5e-3 } else { 1e-2 },
                    "{theta}, {theta_o}, {dphi}: {between}"
                );
            }
        }
    }
    assert!(write_bsdf_radiant(Vec::new(), &SOURCE, &table, 1).is_err());
}

/// A reflectance that is linear between the wavelengths has the same X, Y and Z whatever their step: those of its values at
/// every nanometre.
#[test]
fn tristimulus_values_are_sums_over_every_nanometre() {
    let at = |nm: f64| 0.05 + 0.75 * ((nm - 580.0) / 50.0).clamp(0.0, 1.0);
    let values = |step: u32| {
        let grid = RingGrid::about_lights(vec![0.0, 30.0], &LobeWidths::constant(20.0));
        let wavelength_nm: Vec<f64> = (0..=400 / step).map(|k| f64::from(380 + step * k)).collect();
        let spectrum: Vec<f64> = wavelength_nm.iter().map(|nm| at(*nm)).collect();
        let viewers: usize = (0..2).map(|light| grid.viewers(light).0.len()).sum();
        let brdf = (0..viewers).flat_map(|_| &spectrum).map(|value| *value as f32).collect();
        let leaving = spectrum.repeat(2);
        let specular = vec![0.0; leaving.len()];
        let state = BrdfState { name: "red".to_owned(), brdf, specular, directional_hemispherical: leaving };
        let row_errors = RowErrors::default();
        let table = RingTable {
            grid,
            wavelength_nm,
            states: vec![state],
            nodes: 0,
            discretisation_error: 0.0,
            row_errors,
        };
        let mut bytes = Vec::new();
        write_bsdf_radiant(&mut bytes, &SOURCE, &table, 0).unwrap();
        let read = read_bsdf(&DataFile { name: "red.bsdf".to_owned(), bytes }).unwrap();
        let tis = &read.value.parts[0].tis;
        [tis[0], tis[2], tis[4]]
    };
    let truth = values(1);
    for step in [5, 10, 25, 50] {
        let found = values(step);
        assert!(
            found.iter().zip(truth).all(|(a, b)| (a / b - 1.0).abs() < 1e-4),
            "{step}: {found:?} {truth:?}"
        );
    }
}

#[test]
fn scene_script_contains_the_title_as_a_string_of_python() {
    let script = scene_script(&SOURCE);
    assert!(script.contains("\nTITLE = \"a \\\"panel\\\"\"\n"));
    assert!(!script.contains("@TITLE@"));
}

/// The weights of the nested blends of `scene.py` multiply back to the coverages of the states, in pictures
/// of red, green and blue, in those of black and white, and in those of any states, which are read from the
/// files of `papilio image`.
#[test]
fn blends_of_the_scene_script_multiply_back_to_the_coverages() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("scene.py"), scene_script(&SOURCE)).unwrap();
    std::fs::write(path("check.py"), include_str!("scene_check.py")).unwrap();
    std::fs::write(
        path("image.json"),
        r#"{"coverage": {"white": 0.5, "black": 0.25, "red": 0.25, "blue": 0.0}}"#,
    )
    .unwrap();
    let mut png = Vec::new();
    let palette = [[250, 250, 250], [0, 0, 0], [200, 0, 0], [0, 0, 0]];
    write_indexed_png(&mut png, 4, &[0, 1, 2, 0, 1, 0, 0, 2], &palette).unwrap();
    std::fs::write(path("states.png"), png).unwrap();
    let output = std::process::Command::new("python3").arg("-B").arg(path("check.py")).output();
    // Without Python, there is nothing that could run the script.
    if let Ok(output) = output {
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}
