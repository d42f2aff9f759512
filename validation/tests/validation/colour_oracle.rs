//! Comparison of colours and colour differences with colour-science 0.4.7, and of pictures with
//! flip-evaluator 1.7 (`validation/colour/colour_oracle.py`, `tables_oracle.py` and `pictures_oracle.py` make
//! the tables).

use papilio_colour::pictures::{FlipPicture, Picture, scielab};
use papilio_colour::{
    Cam16Ucs, Corners, D65_WHITE, GamutReference, Lab, Observer, Oklab, Standard, Surround, Viewing, Xyz,
    coverage_percent, gamut_percent,
};
use papilio_spectra::{Grid, Spectrum, illuminant, illuminant_names};

/// Returns the rows of a table, as texts.
fn rows(table: &str) -> impl Iterator<Item = Vec<&str>> {
    table.lines().skip(1).map(|line| line.split(',').collect())
}

fn numbers(cells: &[&str]) -> Vec<f64> {
    cells.iter().map(|cell| cell.parse().unwrap()).collect()
}

/// Returns the tolerance in X, Y, Z and u'v'. Equal energy needs no table. For the LEDs, colour-science
/// interpolates tables at 5 nm with two decimals; ours are those of the CIE at 1 nm.
fn tolerance(light: &str) -> f64 {
    match light {
        "E" => 1e-9,
        "D65" | "D50" | "A" => 2e-6,
        _ => 2e-4,
    }
}

#[test]
fn colours_of_surfaces_agree_with_colour_science() {
    let grid = Grid::new(380.0, 780.0, 1.0).unwrap();
    let observer = Observer::new(&grid).unwrap();
    let large_field = Observer::of(Standard::Cie1964, &grid).unwrap();
    let mut count = 0;
    for row in rows(include_str!("../../colour/surfaces.csv")) {
        let light = illuminant(row[0], &grid).unwrap();
        let v = numbers(&row[1..]);
        let reflected = Spectrum::from_fn(&grid, |nm| v[0] + v[1] * (-((nm - v[2]) / v[3]).powi(2)).exp())
            .zip_map(&light, |reflectance, light| reflectance * light);
        let white_10 = large_field.xyz(&light);
        let seen_10 = large_field.xyz(&reflected) * (1.0 / white_10.y);
        let white = observer.xyz(&light);
        let (seen, white) = (observer.xyz(&reflected) * (1.0 / white.y), white * (1.0 / white.y));
        let (uv, lab) = (seen.uv_prime().unwrap(), seen.lab(white).unwrap());
        let luv = lab.luv(uv, white.uv_prime().unwrap());
        let ours = [seen.x, seen.y, seen.z, uv.u, uv.v, lab.l, lab.a, lab.b, luv.u, luv.v];
        let ours: Vec<f64> = ours.into_iter().chain(seen_10.to_array()).collect();
        assert_eq!(ours.len(), v.len() - 4);
        for (column, (ours, theirs)) in ours.iter().zip(&v[4..]).enumerate() {
            // L*, a*, b*, u* and v* reach 100 and more, the others 1.
            let tolerance = tolerance(row[0]) * if (5..10).contains(&column) { 100.0 } else { 1.0 };
            assert!((ours - theirs).abs() < tolerance, "{row:?}, column {column}: {ours}");
        }
        count += 1;
    }
    assert_eq!(count, 48);
}

/// x and y of every illuminant agree with colour-science, with linear interpolation of the table, and to 3e-4
/// with the published values, which are sums over bands of 5 nm.
#[test]
fn chromaticities_of_illuminants_agree_with_colour_science() {
    let grid = Grid::new(380.0, 780.0, 1.0).unwrap();
    let observer = Observer::new(&grid).unwrap();
    let all: Vec<_> = rows(include_str!("../../colour/lamps.csv")).collect();
    // Illuminant E has no table.
    assert_eq!(all.len() + 1, illuminant_names().len());
    for row in all {
        let seen = observer.xyz(&illuminant(row[0], &grid).unwrap()).chromaticity().unwrap();
        let theirs = numbers(&row[1..3]);
        assert!((seen.x - theirs[0]).hypot(seen.y - theirs[1]) < 1e-9, "{row:?}: {seen:?}");
        if !row[3].is_empty() {
            let published = numbers(&row[3..]);
            assert!((seen.x - published[0]).hypot(seen.y - published[1]) < 3e-4, "{row:?}: {seen:?}");
        }
    }
}

#[test]
fn colour_differences_agree_with_colour_science() {
    for row in rows(include_str!("../../colour/differences.csv")) {
        let v = numbers(&row);
        let (one, two) = (Lab { l: v[0], a: v[1], b: v[2] }, Lab { l: v[3], a: v[4], b: v[5] });
        assert!((one.delta_e_2000(two) - v[6]).abs() < 1e-9, "{row:?}: {}", one.delta_e_2000(two));
    }
}

#[test]
fn appearance_agrees_with_colour_science() {
    for row in rows(include_str!("../../colour/appearance.csv")) {
        let (before, after) = (numbers(&row[..8]), numbers(&row[9..]));
        let xyz = |k: usize| Xyz { x: before[k], y: before[k + 1], z: before[k + 2] };
        let surround = match row[8] {
            "average" => Surround::Average,
            "dim" => Surround::Dim,
            _ => Surround::Dark,
        };
        let viewing = Viewing { adapting_luminance_cd_m2: before[6], background: before[7], surround };
        let seen = xyz(0).appearance(xyz(3), &viewing).unwrap();
        let ours = [seen.lightness, seen.chroma].into_iter().chain(seen.uniform);
        for (ours, theirs) in ours.zip(&after) {
            assert!((ours - theirs).abs() < 1e-6, "{row:?}: {seen:?}");
        }
        let back = Cam16Ucs::new(xyz(3), &viewing).unwrap().xyz([after[2], after[3], after[4]]).unwrap();
        assert!(back.distance(xyz(0)) < 1e-7 * xyz(0).y.max(1.0), "{row:?}: {back:?}");
    }
}

#[test]
fn adapted_colours_and_oklab_agree_with_colour_science() {
    let all: Vec<_> = rows(include_str!("../../colour/adapted.csv")).collect();
    assert_eq!(all.len(), 40);
    for row in all {
        let v = numbers(&row);
        let xyz = |k: usize| Xyz { x: v[k], y: v[k + 1], z: v[k + 2] };
        let seen = xyz(0).adapted_to_d65(xyz(3)).unwrap();
        assert!(seen.distance(xyz(6)) < 1e-9, "{row:?}: {seen:?}");
        let ours = seen.oklab();
        assert!(ours.distance(Oklab { l: v[9], a: v[10], b: v[11] }) < 1e-8, "{row:?}: {ours:?}");
    }
}

/// The pictures of `pictures_oracle.py`, and in single precision those of `flip-evaluator`.
#[test]
fn differences_of_pictures_agree_with_oracle() {
    const COLUMNS: usize = 40;
    let wave = |k: usize, pixel: usize| {
        let (i, j, k) = ((pixel / COLUMNS) as f64, (pixel % COLUMNS) as f64, k as f64);
        0.5 + 0.5 * (0.37 * (k + 1.0) * i + 0.11 * (k + 2.0) * j * (1.0 + 0.05 * i)).sin()
    };
    let picture = |of: &dyn Fn(usize, usize) -> f64| {
        let plane = |k: usize| (0..24 * COLUMNS).map(|pixel| of(k, pixel)).collect();
        Picture::new(COLUMNS, [plane(0), plane(1), plane(2)]).unwrap()
    };
    let mut count = 0;
    for row in rows(include_str!("../../colour/pictures.csv")) {
        let v = numbers(&row[1..]);
        let (white, per_degree, expected) = ([v[0], v[1], v[2]], v[3], &v[4..]);
        let found: Vec<f64> = if row[0] == "flip" {
            let one = FlipPicture::new(&picture(&wave), per_degree);
            let other = FlipPicture::new(&picture(&|k, pixel| wave(k + 1, pixel).powi(2)), per_degree);
            one.differences(&other).unwrap().into_iter().map(f64::from).collect()
        } else {
            let one = picture(&|k, pixel| white[k] * wave(k, pixel));
            let other = picture(&|k, pixel| white[k] * wave(k + 1, pixel).powi(2));
            let [x, y, z] = white;
            let seen = scielab([one, other], Xyz { x, y, z }, per_degree).unwrap();
            let measure = if row[0] == "scielab-1976" { Lab::delta_e_1976 } else { Lab::delta_e_2000 };
            let lab = |[l, a, b]: [f64; 3]| Lab { l, a, b };
            seen[0].pixels().zip(seen[1].pixels()).map(|(one, other)| measure(lab(one), lab(other))).collect()
        };
        let mean = found.iter().sum::<f64>() / found.len() as f64;
        let tolerance = if row[0] == "flip" { 1e-4 } else { 1e-6 };
        for (found, expected) in
            [mean, found[0], found[3 * COLUMNS + 5], found[10 * COLUMNS + 20]].iter().zip(expected)
        {
            assert!((found - expected).abs() < tolerance, "{row:?}: {found}");
        }
        count += 1;
    }
    assert_eq!(count, 9);
}

#[test]
fn gamut_areas_coverages_and_volumes_agree_with_oracle() {
    for row in rows(include_str!("../../colour/gamuts.csv")) {
        let v = numbers(&row[1..]);
        let corner = |on: usize| Xyz { x: v[3 * on], y: v[3 * on + 1], z: v[3 * on + 2] };
        let corners = Corners { xyz: std::array::from_fn(corner) };
        let primaries = [1, 2, 4].map(|on| corner(on).uv_prime().unwrap());
        let references =
            [GamutReference::Srgb, GamutReference::Ebu, GamutReference::Ntsc, GamutReference::DciP3];
        for (reference, theirs) in references.into_iter().zip(v[24..32].chunks(2)) {
            let ours = [gamut_percent(primaries, reference), coverage_percent(primaries, reference)];
            for (ours, theirs) in ours.iter().zip(theirs) {
                // Error of half-planes shifted by 1e-12, relative to an area of 0.06, in %.
                assert!((ours - theirs).abs() < 1e-7, "{} {reference:?}: {ours} {theirs}", row[0]);
            }
        }
        let primaries = [1, 2, 4].map(|on| corner(on).chromaticity().unwrap());
        for (reference, theirs) in references.into_iter().zip(v[34..42].chunks(2)) {
            let ours = [gamut_percent(primaries, reference), coverage_percent(primaries, reference)];
            for (ours, theirs) in ours.iter().zip(theirs) {
                assert!((ours - theirs).abs() < 1e-7, "{} {reference:?} in xy: {ours} {theirs}", row[0]);
            }
        }
        let [volume, hull] = [v[32], v[33]];
        let ours = corners.solid(D65_WHITE).unwrap().volume();
        assert!((ours / volume - 1.0).abs() < 1e-6, "{}: {ours} {volume}", row[0]);
        assert!(ours < hull, "{}: {ours} {hull}", row[0]);
    }
}

/// Ours have five decimals, and blue is one minus red and green.
#[test]
fn primaries_agree_with_colour_science() {
    let [red, green, blue] = papilio_spectra::srgb_primaries(&Grid::new(380.0, 780.0, 5.0).unwrap()).unwrap();
    let all: Vec<_> = rows(include_str!("../../colour/primaries.csv")).collect();
    assert_eq!(all.len(), 81);
    for (k, row) in all.iter().enumerate() {
        let theirs = numbers(row);
        assert_eq!(theirs[0], 380.0 + 5.0 * k as f64);
        for (ours, theirs) in [red[k], green[k], blue[k]].into_iter().zip(&theirs[1..]) {
            assert!((ours - theirs).abs() < 2e-5, "{row:?}: {ours}");
        }
    }
}
