//! Exports of a display's BSDF between their nodes, by readers that are written here from the descriptions of
//! the formats and share no code with the program: a tensor file whose density is integrated numerically, a
//! tabular BSDF, a CSV and Klems matrices. The display is a lobe with a formula, as narrow as that of a
//! diffuser of 5 % haze, and as wide as that of an ordinary one.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use papilio_display::{
    BrdfGrid, BrdfState, BrdfTable, HalfVectorGrid, LobeWidths, ProbeGrid, RingGrid, RowErrors, ViewerGrid,
    ViewerTable,
};
use papilio_formats::{
    BsdfSource, Exported, FAINT, between_error, klems_rings, write_bsdf_csv, write_bsdf_klems,
    write_bsdf_radiant, write_rgl,
};

const SOURCE: BsdfSource<'_> = BsdfSource { papilio: "0", title: "a lobe", hash: "00" };

const WAVELENGTHS: [f64; 3] = [450.0, 550.0, 650.0];

/// A lobe about the mirror direction in direction cosines, which falls as the third power: reciprocal.
#[derive(Clone, Copy)]
struct Lobe {
    b: f64,
}

impl Lobe {
    fn f(self, theta_i: f64, theta_o: f64, dphi: f64) -> f64 {
        let [i, o] = [theta_i, theta_o].map(|theta| theta.to_radians().sin());
        self.at((i * i + o * o + 2.0 * i * o * dphi.to_radians().cos()).max(0.0))
    }

    /// From the square of the distance to the mirror direction in direction cosines.
    fn at(self, squared: f64) -> f64 {
        0.8 * self.b / (TAU * (self.b * self.b + squared).powf(1.5))
    }

    /// The light that it scatters: the mean of a fraction within the unit disc, over equal parts of the lobe.
    fn total(self, theta_i: f64) -> f64 {
        let (n, sin) = (120, theta_i.to_radians().sin());
        let is_inside = |k: &i32| {
            let [q, turn] = [k / n, k % n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
            // The fraction of the lobe within r is 1 - b / sqrt(b^2 + r^2).
            let r = self.b * ((1.0 - q).powi(-2) - 1.0).sqrt();
            let (y, x) = (TAU * turn).sin_cos();
            (sin + r * x).hypot(r * y) < 1.0
        };
        0.8 * (0..n * n).filter(is_inside).count() as f64 / f64::from(n * n)
    }

    /// Half of it is lost at sqrt(2^(2/3) - 1) = 0.766 b; a half vector is half as far away.
    fn widths(self) -> LobeWidths {
        LobeWidths::constant((0.383 * self.b).to_degrees())
    }

    fn table<G: ViewerGrid>(self, grid: G) -> ViewerTable<G> {
        let (mut brdf, mut leaving) = (Vec::new(), Vec::new());
        for (light, theta_i) in grid.theta_i_deg().iter().enumerate() {
            for viewer in grid.viewers(light).0 {
                brdf.extend([self.f(*theta_i, viewer.theta_o_deg, viewer.dphi_deg) as f32; 3]);
            }
            leaving.extend([self.total(*theta_i); 3]);
        }
        let state = BrdfState {
            name: "white".to_owned(),
            brdf,
            specular: vec![0.0; leaving.len()],
            directional_hemispherical: leaving,
        };
        ViewerTable {
            grid,
            wavelength_nm: WAVELENGTHS.to_vec(),
            states: vec![state],
            nodes: 0,
            discretisation_error: 0.0,
            row_errors: RowErrors::default(),
        }
    }
}

/// The same lobe above a pixel that depends on azimuth: reciprocal, and the same after half a turn of light and viewer.
fn turned_f(lobe: Lobe, [theta_i, phi_i]: [f64; 2], theta_o: f64, dphi: f64) -> f64 {
    let strength = theta_i.to_radians().sin() * theta_o.to_radians().sin();
    lobe.f(theta_i, theta_o, dphi) * (1.0 + 0.8 * strength * (2.0 * phi_i + dphi - 40.0).to_radians().cos())
}

fn turned_table<G: ViewerGrid>(lobe: Lobe, grid: G) -> ViewerTable<G> {
    let lights = grid.lights_deg();
    let of_light = |(number, light): (usize, &[f64; 2])| {
        let viewers = grid.viewers(number).0;
        viewers.iter().map(|to| turned_f(lobe, *light, to.theta_o_deg, to.dphi_deg)).collect::<Vec<_>>()
    };
    let brdf = lights.iter().enumerate().flat_map(of_light).flat_map(|f| [f as f32; 3]).collect();
    // That of a narrow lobe.
    let leaving = |[theta_i, phi_i]: &[f64; 2]| {
        [lobe.total(*theta_i) * (1.0 - 0.3 * (2.0 * phi_i - 40.0).to_radians().cos()); 3]
    };
    let directional_hemispherical: Vec<f64> = lights.iter().flat_map(leaving).collect();
    let state = BrdfState {
        name: "white".to_owned(),
        brdf,
        specular: vec![0.0; directional_hemispherical.len()],
        directional_hemispherical,
    };
    ViewerTable {
        grid,
        wavelength_nm: WAVELENGTHS.to_vec(),
        states: vec![state],
        nodes: 0,
        discretisation_error: 0.0,
        row_errors: RowErrors::default(),
    }
}

/// With azimuths of the light, what readers of each format find between its directions is the BSDF, by the azimuths of light and viewer; files
/// that are read again have it at their directions.
#[test]
fn files_with_azimuths_have_the_bsdf_of_both_azimuths() {
    let read = |name: &str, bytes: &[u8]| {
        let file = papilio_formats::DataFile { name: name.to_owned(), bytes: bytes.to_vec() };
        papilio_formats::read_bsdf(&file).unwrap().value.parts.remove(0)
    };
    let check = |part: &papilio_goniometry::MeasuredPart, most: f64| {
        for (light, [theta_o, phi_o]) in
            [([45.0, 30.0], [45.0, 210.0]), ([45.0, 75.0], [60.0, 265.0]), ([45.0, 300.0], [30.0, 100.0])]
        {
            let expected = turned_f(WIDE, light, theta_o, phi_o - light[1]);
            let [from, to] =
                [light, [theta_o, phi_o]].map(|[theta, phi]| papilio_goniometry::Direction::new(theta, phi));
            let found = part.evaluate(part.luminous(), from, to).unwrap();
            assert!((found / expected - 1.0).abs() < most, "{light:?} {theta_o} {phi_o}: {found} {expected}");
        }
    };
    let (widths, mut bytes) = (WIDE.widths(), Vec::new());
    let probes = |lights: &[f64]| turned_table(WIDE, ProbeGrid::around(lights, 15.0, &widths));
    let error =
        |exported: Exported<'_>, lights: &[f64]| between_error(exported, &probes(lights)).unwrap().unwrap();

    let half = turned_table(WIDE, HalfVectorGrid::around(15.0, 15.0, 48, &widths));
    write_rgl(&mut bytes, &SOURCE, &half, 0).unwrap();
    check(&read("a.bsdf", &bytes), 0.1);
    let found = error(Exported::HalfVectors(&half), &half.grid.theta_i_deg);
    assert!(found.relative < 0.3 && found.phi_i_deg.is_some(), "{found:?}");

    let rings = turned_table(WIDE, RingGrid::new(15.0, &widths).around(15.0));
    bytes.clear();
    write_bsdf_radiant(&mut bytes, &SOURCE, &rings, 0).unwrap();
    assert!(String::from_utf8_lossy(&bytes).contains("Asymmetrical4D"));
    check(&read("b.bsdf", &bytes), 0.1);
    let found = error(Exported::Rings(&rings), &rings.grid.theta_i_deg);
    assert!(found.relative < 0.3, "{found:?}");

    let grid = BrdfGrid::around(7.5, 15.0);
    let mut all = Vec::new();
    for light in grid.lights_deg() {
        for theta_o in &grid.theta_o_deg {
            all.extend(
                grid.dphi_deg.iter().flat_map(|dphi| [turned_f(WIDE, light, *theta_o, *dphi) as f32; 3]),
            );
        }
    }
    let beams = vec![0.5; 3 * grid.lights()];
    let state = BrdfState {
        name: "white".to_owned(),
        brdf: all,
        specular: beams.clone(),
        directional_hemispherical: beams,
    };
    let table = BrdfTable {
        row_errors: RowErrors { relative: vec![0.0; grid.pairs()], target: 1e-3, allowed: None },
        grid,
        wavelength_nm: WAVELENGTHS.to_vec(),
        states: vec![state],
        nodes: 0,
        discretisation_error: 0.0,
    };
    bytes.clear();
    papilio_formats::write_bsdf(&mut bytes, &SOURCE, &table).unwrap();
    check(&read("c.npz", &bytes), 0.1);
    let found = error(Exported::Directions(&table), &table.grid.theta_i_deg);
    assert!(found.relative < 0.6, "{found:?}");
}

const NARROW: Lobe = Lobe { b: 0.0044 };
const WIDE: Lobe = Lobe { b: 0.1134 };

/// A reader of a format: the luminous BRDF at inclinations and the azimuth between them, degrees.
type Reader = Box<dyn Fn(f64, f64, f64) -> f64>;

/// The largest error at the probes as the program states it, which is the one that a reader has.
fn stated_error(exported: Exported<'_>, lobe: Lobe, lights: &[f64], read: &Reader) -> f64 {
    let probes = lobe.table(ProbeGrid::between(lights, &lobe.widths()));
    let stated = between_error(exported, &probes).unwrap().unwrap().relative;
    let mut largest = 0.0_f64;
    for (light, theta_i) in probes.grid.theta_i_deg().iter().enumerate() {
        let viewers = probes.grid.viewers(light).0;
        let f = |viewer: &papilio_display::Viewer| lobe.f(*theta_i, viewer.theta_o_deg, viewer.dphi_deg);
        let most = viewers.iter().map(f).fold(0.0, f64::max);
        for viewer in &viewers {
            let found = read(*theta_i, viewer.theta_o_deg, viewer.dphi_deg);
            largest = largest.max((found - f(viewer)).abs() / f(viewer).max(FAINT * most));
        }
    }
    assert!((stated - largest).abs() < 0.02 * largest + 2e-4, "stated {stated}, found {largest}");
    stated
}

/// The sum over viewers, relative to the light that leaves, by equal parts of the lobe: the fraction within r
/// is 1 - b / sqrt(b^2 + r^2).
fn furnace(lobe: Lobe, theta_i: f64, read: &Reader) -> f64 {
    let (n, sin) = (40, theta_i.to_radians().sin());
    let (mut sum, mut exact) = (0.0, 0.0);
    for k in 0..n * n {
        let [q, turn] = [k / n, k % n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
        let r = lobe.b * ((1.0 - q).powi(-2) - 1.0).sqrt();
        let (y, x) = (TAU * turn).sin_cos();
        let (x, y) = (-sin + r * x, r * y);
        let across = x.hypot(y);
        // Readers differ in the last degree.
        if across < 89_f64.to_radians().sin() {
            let (theta_o, dphi) = (across.asin().to_degrees(), y.atan2(x).to_degrees());
            exact += 1.0;
            sum += read(theta_i, theta_o, dphi) / lobe.f(theta_i, theta_o, dphi);
        }
    }
    sum / exact
}

/// Cell of an ascending axis and the position in it.
fn cell(axis: &[f64], at: f64) -> (usize, f64) {
    let k = axis.partition_point(|node| *node <= at).clamp(1, axis.len() - 1) - 1;
    (k, (at - axis[k]) / (axis[k + 1] - axis[k]))
}

fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a + t * (b - a)
}

/// Arrays of a tensor file: name, shape and numbers (singles), from its header.
fn tensors(bytes: &[u8]) -> Vec<(String, Vec<usize>, Vec<f64>)> {
    let number =
        |at: usize, size: usize| bytes[at..at + size].iter().rev().fold(0, |n, b| n << 8 | usize::from(*b));
    assert_eq!(&bytes[..14], b"tensor_file\0\x01\0");
    let mut at = 18;
    let mut found = Vec::new();
    for _ in 0..number(14, 4) {
        let length = number(at, 2);
        let name = String::from_utf8(bytes[at + 2..at + 2 + length].to_vec()).unwrap();
        at += 2 + length;
        let (dimensions, kind, offset) = (number(at, 2), bytes[at + 2], number(at + 3, 8));
        let shape: Vec<usize> = (0..dimensions).map(|k| number(at + 11 + 8 * k, 8)).collect();
        at += 11 + 8 * dimensions;
        let count: usize = shape.iter().product();
        let numbers = match kind {
            10 => bytes[offset..][..4 * count]
                .chunks_exact(4)
                .map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])))
                .collect(),
            _ => Vec::new(),
        };
        found.push((name, shape, numbers));
    }
    found
}

/// Reads the wavelength of 550 nm as Dupuy & Jakob 2018 describe it. The uniform number of a half vector on
/// its row is the part of the density below it: here, an integral of the interpolated density in steps, not a
/// table of cumulative sums.
fn rgl_reader(bytes: &[u8]) -> Reader {
    let tensors = tensors(bytes);
    let get = |name: &str| tensors.iter().find(|(own, ..)| own == name).unwrap().clone();
    let (theta, (_, density_shape, density), (_, shape, spectra)) =
        (get("theta_i").2, get("vndf"), get("spectra"));
    let [rows, columns] = [density_shape[2], density_shape[3]];
    let [bins, height, width] = [shape[2], shape[3], shape[4]];
    Box::new(move |theta_i, theta_o, dphi| {
        let (light, t) = cell(&theta, theta_i.to_radians());
        let [i, o] = [(theta_i, 0.0), (theta_o, dphi)].map(|(theta, phi): (f64, f64)| {
            let [(sin, cos), (y, x)] = [theta, phi].map(|angle| angle.to_radians().sin_cos());
            [sin * x, sin * y, cos]
        });
        let m: Vec<f64> = i.iter().zip(o).map(|(i, o)| i + o).collect();
        let u = ((m[0].hypot(m[1])).atan2(m[2]) / FRAC_PI_2).sqrt();
        let v = (m[1].atan2(m[0]) + PI) / TAU;
        // The density on the row of v, interpolated between the lights and the rows.
        let (row, y) = cell(&(0..rows).map(|k| k as f64 / (rows - 1) as f64).collect::<Vec<_>>(), v);
        let along: Vec<f64> = (0..columns)
            .map(|column| {
                let at = |light: usize, row: usize| density[(light * rows + row) * columns + column];
                lerp(
                    lerp(at(light, row), at(light, row + 1), y),
                    lerp(at(light + 1, row), at(light + 1, row + 1), y),
                    t,
                )
            })
            .collect();
        let integral = |end: f64| {
            let steps = 4 * (columns - 1);
            let step = |k: usize| {
                let [from, to] = [k, k + 1].map(|k| (k as f64 / steps as f64).min(end));
                let place = 0.5 * (from + to) * (columns - 1) as f64;
                let column = (place as usize).min(columns - 2);
                (to - from) * lerp(along[column], along[column + 1], place - column as f64)
            };
            (0..steps).map(step).sum::<f64>()
        };
        let x = (integral(u) / integral(1.0)).min(1.0) * (width - 1) as f64;
        let y = v * (height - 1) as f64;
        let (column, row) = ((x as usize).min(width - 2), (y as usize).min(height - 2));
        let (x, y) = (x - column as f64, y - row as f64);
        let of_light = |light: usize| {
            let at =
                |row: usize, column: usize| spectra[((light * bins + 1) * height + row) * width + column];
            let of_row = |row: usize| lerp(at(row, column), at(row, column + 1), x);
            lerp(of_row(row), of_row(row + 1), y)
        };
        lerp(of_light(light), of_light(light + 1), t) / o[2]
    })
}

#[test]
fn rgl_files_have_the_radiances_of_the_display_between_nodes() {
    // The narrow lobe was 29 % off with nodes that did not follow it, and its sum 9 %.
    for (lobe, size, most, most_sum) in
        [(WIDE, 64, 0.02, 0.006), (NARROW, 64, 0.045, 0.018), (NARROW, 128, 0.02, 0.007)]
    {
        let table = lobe.table(HalfVectorGrid::new(5.0, size, &lobe.widths()));
        let mut bytes = Vec::new();
        write_rgl(&mut bytes, &SOURCE, &table, 0).unwrap();
        let read = rgl_reader(&bytes);
        let stated = stated_error(Exported::HalfVectors(&table), lobe, &table.grid.theta_i_deg, &read);
        assert!(stated < most, "{}, {size}: {stated}", lobe.b);
        if size == 64 {
            for theta_i in [0.0, 2.5, 61.0] {
                let sum = furnace(lobe, theta_i, &read);
                assert!((sum - 1.0).abs() < most_sum, "{}, {theta_i}: {sum}", lobe.b);
            }
        }
        for (one, other, dphi) in
            [(10.0, 12.0, 175.0), (33.0, 31.0, 179.0), (21.0, 52.0, 120.0), (62.0, 65.0, 178.0)]
        {
            let ratio = read(one, other, dphi) / read(other, one, dphi);
            assert!((ratio - 1.0).abs() < 2.0 * most, "{}, {one}, {other}: {ratio}", lobe.b);
        }
    }
}

/// Y of a tabular BSDF, interpolated along the axes of the format.
fn radiant_reader(text: &str) -> (Reader, Vec<f64>, Vec<f64>) {
    let lines: Vec<&str> = text.lines().collect();
    let numbers =
        |line: &str| -> Vec<f64> { line.split_whitespace().map(|word| word.parse().unwrap()).collect() };
    let below = |word: &str| lines.iter().position(|line| line.starts_with(word)).unwrap() + 1;
    let [lights, azimuths, radials] =
        ["AngleOfIncidence", "ScatterAzimuth", "ScatterRadial"].map(|word| numbers(lines[below(word)]));
    let start = below("TristimulusY") + 1;
    let (mut tis, mut rows) = (Vec::new(), Vec::new());
    for line in &lines[start..start + lights.len() * (azimuths.len() + 1)] {
        match line.strip_prefix("TIS") {
            Some(value) => tis.push(value.trim().parse().unwrap()),
            None => rows.push(numbers(line)),
        }
    }
    let (found, axis) = (tis, lights.clone());
    let reader = move |theta_i: f64, theta_o: f64, dphi: f64| {
        // Light comes from azimuth 180 deg in the format's coordinates, and so does a viewer at dphi = 0.
        let [(sin_a, cos_a), (sin_o, cos_o), (sin_p, cos_p)] =
            [theta_i, theta_o, dphi + 180.0].map(|angle| angle.to_radians().sin_cos());
        let d = [sin_o * cos_p, sin_o * sin_p, cos_o];
        let towards = d[2] * sin_a - d[0] * cos_a;
        let aside = towards.hypot(d[1]);
        let radial = aside.atan2(d[0] * sin_a + d[2] * cos_a).to_degrees();
        let azimuth = d[1].abs().atan2(towards).to_degrees();
        let ((light, t), (a, y), (r, x)) =
            (cell(&lights, theta_i), cell(&azimuths, azimuth), cell(&radials, radial));
        let of_light = |light: usize| {
            let row = |a: usize| &rows[light * azimuths.len() + a];
            lerp(lerp(row(a)[r], row(a)[r + 1], x), lerp(row(a + 1)[r], row(a + 1)[r + 1], x), y)
        };
        lerp(of_light(light), of_light(light + 1), t)
    };
    (Box::new(reader), axis, found)
}

#[test]
fn radiant_tables_have_the_radiances_of_the_display_between_nodes() {
    for (lobe, most) in [(WIDE, 0.03), (NARROW, 0.03)] {
        let table = lobe.table(RingGrid::new(5.0, &lobe.widths()));
        let mut bytes = Vec::new();
        write_bsdf_radiant(&mut bytes, &SOURCE, &table, 0).unwrap();
        let (read, lights, tis) = radiant_reader(std::str::from_utf8(&bytes).unwrap());
        let stated = stated_error(Exported::Rings(&table), lobe, &lights, &read);
        assert!(stated < most, "{}: {stated}", lobe.b);
        for (theta_i, tis) in lights.iter().zip(tis) {
            assert!((tis / lobe.total(*theta_i) - 1.0).abs() < 1e-5);
        }
        for theta_i in [0.0, 12.5, 47.0] {
            let sum = furnace(lobe, theta_i, &read);
            assert!((sum - 1.0).abs() < 0.01, "{}, {theta_i}: {sum}", lobe.b);
        }
    }
}

/// The rows of a CSV at 550 nm, interpolated linearly in the three angles.
fn csv_reader(text: &str) -> (Reader, Vec<f64>) {
    let rows: Vec<Vec<f64>> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|word| word.parse().unwrap()).collect())
        .collect();
    let rows: Vec<Vec<f64>> = rows.into_iter().filter(|row| row[3] == 550.0).collect();
    let axis = |column: usize| {
        let mut values: Vec<f64> = rows.iter().map(|row| row[column]).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    };
    let axes = [0, 1, 2].map(axis);
    let lights = axes[0].clone();
    let reader = move |theta_i: f64, theta_o: f64, dphi: f64| {
        let places = [(0, theta_i), (1, theta_o), (2, dphi)].map(|(k, at)| cell(&axes[k], at));
        let mut sum = 0.0;
        for corner in 0..8 {
            let (mut row, mut weight) = (0, 1.0);
            for (k, (node, t)) in places.iter().enumerate() {
                let upper = corner >> k & 1;
                row = row * axes[k].len() + node + upper;
                weight *= if upper == 1 { *t } else { 1.0 - t };
            }
            sum += weight * rows[row][4];
        }
        sum
    };
    (Box::new(reader), lights)
}

/// A grid of fixed directions doubles the peak of a narrow lobe between its directions of the light: the
/// error is stated.
#[test]
fn csv_states_the_error_that_a_reader_has_between_nodes() {
    for (lobe, step, least) in [(WIDE, 5.0, 0.02), (Lobe { b: 1.0 }, 5.0, 0.0), (NARROW, 15.0, 1.0)] {
        let grid = BrdfGrid::even(step);
        let (mut brdf, lights) = (Vec::new(), grid.theta_i_deg.len());
        for theta_i in &grid.theta_i_deg {
            for theta_o in &grid.theta_o_deg {
                brdf.extend(
                    grid.dphi_deg.iter().flat_map(|dphi| [lobe.f(*theta_i, *theta_o, *dphi) as f32; 3]),
                );
            }
        }
        let state = BrdfState {
            name: "white".to_owned(),
            brdf,
            specular: vec![0.0; 3 * lights],
            directional_hemispherical: vec![1.0; 3 * lights],
        };
        let relative = vec![0.0; grid.pairs()];
        let table = BrdfTable {
            grid,
            wavelength_nm: WAVELENGTHS.to_vec(),
            states: vec![state],
            nodes: 0,
            discretisation_error: 0.0,
            row_errors: RowErrors { relative, target: 1e-3, allowed: None },
        };
        let mut bytes = Vec::new();
        write_bsdf_csv(&mut bytes, &table, 0).unwrap();
        let (read, lights) = csv_reader(std::str::from_utf8(&bytes).unwrap());
        let stated = stated_error(Exported::Directions(&table), lobe, &lights, &read);
        assert!(stated >= least && (least > 0.0 || stated < 0.02), "{}: {stated}", lobe.b);
    }
}

/// Edges of the rings of the full basis, degrees, and their numbers of patches (Klems 1994).
const RINGS: [(f64, usize); 9] =
    [(0.0, 1), (5.0, 8), (15.0, 16), (25.0, 20), (35.0, 24), (45.0, 24), (55.0, 24), (65.0, 16), (75.0, 12)];

/// The visible matrix of reflection, `[row][column]`: outgoing and incident patches.
fn klems_matrix(text: &str) -> Vec<Vec<f64>> {
    let visible = text.split("<WavelengthData>").find(|block| block.contains(">Visible<")).unwrap();
    let data = visible.split("<ScatteringData>").nth(1).unwrap().split("</ScatteringData>").next().unwrap();
    let numbers: Vec<f64> = data
        .split([',', '\n', ' '])
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().unwrap())
        .collect();
    assert_eq!(numbers.len(), 145 * 145);
    numbers.chunks_exact(145).map(<[f64]>::to_vec).collect()
}

fn klems_patches() -> Vec<(usize, usize, f64)> {
    let edge = |k: usize| RINGS.get(k).map_or(90.0, |(edge, _)| *edge).to_radians().cos().powi(2);
    let of_ring =
        |k: usize| (0..RINGS[k].1).map(move |n| (k, n, PI * (edge(k) - edge(k + 1)) / RINGS[k].1 as f64));
    (0..9).flat_map(of_ring).collect()
}

/// Mean of the lobe between two patches, whose mirror directions have the same number, by points of equal
/// projected solid angle.
fn patch_mean(lobe: Lobe, incoming: usize, outgoing: usize, points: usize) -> f64 {
    let patches = klems_patches();
    let point = |(ring, number, _): (usize, usize, f64), k: usize| {
        let [low, high] =
            [ring, ring + 1].map(|k| RINGS.get(k).map_or(90.0, |(edge, _)| *edge).to_radians().sin().powi(2));
        let [a, b] = [k / points, k % points].map(|k| (k as f64 + 0.5) / points as f64);
        let (y, x) = (TAU * (number as f64 - 0.5 + b) / RINGS[ring].1 as f64).sin_cos();
        let r = lerp(low, high, a).sqrt();
        [r * x, r * y]
    };
    let all: Vec<[f64; 2]> = (0..points * points).map(|k| point(patches[outgoing], k)).collect();
    let mut sum = 0.0;
    for k in 0..points * points {
        let [x, y] = point(patches[incoming], k);
        sum += all.iter().map(|to| lobe.at((to[0] - x).powi(2) + (to[1] - y).powi(2))).sum::<f64>();
    }
    sum / (points * points * points * points) as f64
}

#[test]
fn klems_matrices_are_means_over_both_patches_and_reciprocal() {
    for lobe in [WIDE, NARROW] {
        let table = lobe.table(klems_rings(&lobe.widths(), None));
        let mut bytes = Vec::new();
        write_bsdf_klems(&mut bytes, &SOURCE, &table, 0).unwrap();
        let text = std::str::from_utf8(&bytes).unwrap();
        let (matrix, patches) = (klems_matrix(text), klems_patches());
        for (column, (ring, ..)) in patches.iter().enumerate() {
            // The hemispherical reflectance of the incident patch.
            let sum: f64 = patches.iter().zip(&matrix).map(|((.., omega), row)| omega * row[column]).sum();
            let low = RINGS[*ring].0.to_radians().sin().powi(2);
            let high = RINGS.get(ring + 1).map_or(90.0, |(edge, _)| *edge).to_radians().sin().powi(2);
            let total =
                |k: i32| lobe.total(lerp(low, high, (f64::from(k) + 0.5) / 12.0).sqrt().asin().to_degrees());
            if patches[..column].iter().all(|(other, ..)| other != ring) {
                let expected = (0..12).map(total).sum::<f64>() / 12.0;
                assert!((sum / expected - 1.0).abs() < 3e-3, "{}, column {column}: {sum} {expected}", lobe.b);
            }
            for (row, values) in matrix.iter().enumerate() {
                let (there, back) = (values[column], matrix[column][row]);
                assert!((there - back).abs() <= 1e-5 * there.max(back), "{row}, {column}: {there} {back}");
            }
        }
        // The column of normal incidence is the same at all azimuths.
        for (first, (_, count)) in [1, 9, 25, 45, 69, 93, 117, 133].into_iter().zip(&RINGS[1..]) {
            let off = |row: usize| (matrix[row][0] / matrix[first][0] - 1.0).abs();
            // The factors of rings with other numbers of patches differ by so much.
            assert!((first..first + count).all(|row| off(row) < 1e-4));
        }
        // Means of the wide lobe; those of the narrow one between patches that do not touch, which points
        // resolve.
        let apart = [(0, 12), (30, 12), (50, 75), (100, 125), (3, 60)];
        let touching = [(0, 0), (0, 3), (10, 10), (10, 11)];
        for (incoming, outgoing) in apart.into_iter().chain(touching.into_iter().filter(|_| lobe.b > 0.1)) {
            // The error of equal parts falls as the square of their number along an axis: 14 leave 3.5 % of
            // the narrow lobe between rings that are neighbours, and 0.2 % remain of both together.
            let [few, many] = [14, 28].map(|points| patch_mean(lobe, incoming, outgoing, points));
            let ratio = matrix[outgoing][incoming] / ((4.0 * many - few) / 3.0);
            assert!((ratio - 1.0).abs() < 0.006, "{}, {incoming} to {outgoing}: {ratio}", lobe.b);
        }
        // The fraction of light from the patch about the normal that arrives in the next ring, by equal parts
        // of patch and lobe.
        if lobe.b < 0.1 {
            let [near, far] = [5.0_f64, 15.0].map(|theta| theta.to_radians().sin());
            let (n, mut count) = (160_u32, 0);
            for k in 0..n * n * n {
                let [a, q, turn] = [k % n, k / n % n, k / n / n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
                let r = lobe.b * ((1.0 - q).powi(-2) - 1.0).sqrt();
                let (y, x) = (TAU * turn).sin_cos();
                let at = (near * a.sqrt() + r * x).hypot(r * y);
                count += u32::from(at > near && at < far);
            }
            let expected = 0.8 * f64::from(count) / f64::from(n * n * n) / (8.0 * patches[1].2);
            assert!((matrix[1][0] / expected - 1.0).abs() < 0.02, "{} {expected}", matrix[1][0]);
        }
        let probes =
            lobe.table(ProbeGrid::between(&[0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0], &lobe.widths()));
        let stated = between_error(Exported::Patches(&table), &probes).unwrap().unwrap().relative;
        assert!(stated > 0.3, "{stated}");
    }
}
