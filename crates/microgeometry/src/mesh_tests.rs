//! Meshes against height maps, exact caps and corner cubes, and what they refuse.

use papilio_sampling::{SampleStream, Sampler};
use papilio_testing::{Dice, assert_student, mean_and_error, sized};

use crate::bands::Bands;
use crate::goniometer::start;
use crate::laws_tests::diffuse;
use crate::path::{Facets, follow};
use crate::*;

const INDEX: [f64; 2] = [1.0, 1.5];

type Triangle = [[f64; 3]; 3];

fn goniometer(coating: Coating, incidence_deg: &[f64], rays: u64) -> Goniometer {
    let [index_above, index_below] = INDEX;
    Goniometer {
        index_above,
        index_below,
        coating,
        incidence_deg: incidence_deg.to_vec(),
        azimuths: None,
        rays,
        seed: 4,
    }
}

fn replicates(of: &Goniometer, surface: &Surface) -> Vec<Replicate> {
    (0..REPLICATES).map(|number| of.replicate(surface, number, &|| false).unwrap()).collect()
}

/// The triangles of a height map, as its rays meet them.
fn of_map(map: &HeightMap) -> Vec<Triangle> {
    let (columns, rows, pitch) = (map.columns(), map.rows(), map.pitch_um());
    let place = |x: usize, y: usize| {
        let height = map.heights_um()[y % rows * columns + x % columns];
        [x as f64 * pitch[0], y as f64 * pitch[1], height]
    };
    let cells = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let triangles = cells.flat_map(|(x, y)| {
        let [a, b, c, d] = [place(x, y), place(x + 1, y), place(x, y + 1), place(x + 1, y + 1)];
        [[a, b, c], [d, c, b]]
    });
    triangles.collect()
}

fn rough_map() -> HeightMap {
    let mut dice = Dice::new(8, 1);
    HeightMap::new(10, [1.0, 0.8], (0..100).map(|_| 2.0 * dice.throw()).collect()).unwrap()
}

/// A mesh of the triangles of a height map has its rays: the same light to rounding.
#[test]
fn meshes_of_height_maps_are_the_height_maps() {
    let map = rough_map();
    let mesh = Mesh::new(&of_map(&map), None).unwrap();
    assert_eq!((mesh.triangles(), mesh.notes().len()), (200, 0));
    assert!((mesh.period_um()[0] - 10.0).abs() < 1e-12 && (mesh.period_um()[1] - 8.0).abs() < 1e-12);
    let of = goniometer(Coating::None, &[0.0, 50.0, 80.0], 64);
    let [one, other] = [Surface::Mesh(mesh), Surface::Heights(map)].map(|surface| of.totals_alone(&surface));
    for (one, other) in one.iter().zip(&other) {
        for (a, b) in [(one.reflected, other.reflected), (one.mean_facets, other.mean_facets)] {
            assert!((a.value - b.value).abs() < 1e-9, "{one:?} {other:?}");
        }
    }
}

/// Sheared heights overhang: diffuse light goes down as it comes up, and no ray is lost.
#[test]
fn overhangs_obey_reciprocity() {
    let map = rough_map();
    let bands = Bands::new(INDEX);
    let mut scores = Vec::new();
    for (seed, shear) in [0.7, 1.5, -2.5].into_iter().enumerate() {
        let sheared =
            of_map(&map).into_iter().map(|one| one.map(|[x, y, z]| [x + shear * z, y + 0.3 * z, z]));
        let mesh = Mesh::new(&sheared.collect::<Vec<_>>(), Some([10.0, 8.0])).unwrap();
        let of = Goniometer { seed: seed as u64, ..goniometer(Coating::None, &[], 8) };
        let found = replicates(&of, &Surface::Mesh(mesh));
        assert_eq!(found.iter().map(|one| one.lost).sum::<f64>(), 0.0, "{shear}");
        let differences = found.iter().map(|one| diffuse(&bands, one)).map(|[down, up]| down - up);
        let (mean, error) = mean_and_error(differences);
        scores.push(mean / error);
    }
    assert_student("diffuse transmittance of overhangs", &scores, scores.len() as f64);
}

/// From the axes of a cube to x, y and z, the last along its diagonal.
fn along_diagonal([i, j, k]: [f64; 3]) -> [f64; 3] {
    [(i - j) / 2_f64.sqrt(), (i + j - 2.0 * k) / 6_f64.sqrt(), (i + j + k) / 3_f64.sqrt()]
}

/// Corner cubes with square faces: the faces of cubes of side 1 on their diagonals.
fn corner_cubes() -> Mesh {
    let mut triangles = Vec::new();
    // Two cubes in a rectangle of sqrt 2 by sqrt 6.
    for cube in [[0.0, 0.0, 0.0], [1.0, 0.0, -1.0]] {
        for axis in 0..3 {
            // Not as `to[along] += 1.0`, which rustc 1.95 compiles to two steps in an incremental build.
            let step = |along: usize, from: [f64; 3]| {
                [0, 1, 2].map(|k| from[k] + if k == along { 1.0 } else { 0.0 })
            };
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let square = [cube, step(u, cube), step(v, step(u, cube)), step(v, cube)].map(along_diagonal);
            triangles.push([square[0], square[1], square[2]]);
            triangles.push([square[0], square[2], square[3]]);
        }
    }
    Mesh::new(&triangles, Some([2_f64.sqrt(), 6_f64.sqrt()])).unwrap()
}

/// Corner cubes with triangular faces: a triangle with a rim of side sqrt 2 and its mirror image, and both
/// once more, half a period away.
fn triangular_corner_cubes() -> Mesh {
    let (side, height) = (2_f64.sqrt(), 6_f64.sqrt() / 2.0);
    let depth = -1.0 / 3_f64.sqrt();
    let mut triangles = Vec::new();
    for row in [0.0, 1.0] {
        let at = |x: f64, y: f64| [(x + 0.5 * row) * side, (y + row) * height, 0.0];
        for (rim, x, y) in [
            ([at(0.0, 0.0), at(1.0, 0.0), at(0.5, 1.0)], 0.5, 1.0 / 3.0),
            ([at(1.0, 0.0), at(1.5, 1.0), at(0.5, 1.0)], 1.0, 2.0 / 3.0),
        ] {
            let [x, y, _] = at(x, y);
            triangles.extend((0..3).map(|k| [rim[k], rim[(k + 1) % 3], [x, y, depth]]));
        }
    }
    Mesh::new(&triangles, Some([side, 2.0 * height])).unwrap()
}

/// Weight of the light that returns along the normal, over the rays of all replicates, and its standard
/// error.
fn returned(mesh: &Mesh, coating: &Coating, rays: u64) -> (f64, f64) {
    let surface = Surface::Mesh(mesh.clone());
    let shares = (0..REPLICATES).map(|number| {
        let numbers = SampleStream::new(Sampler::Sobol, 12, number);
        let mut share = 0.0;
        let trace = |face: &dyn crate::ray::Face| {
            for path in 0..rays {
                let [x, y, azimuth, _] = numbers.block(path, 0);
                let ray = start(face, Side::Above, [0.0, 1.0], [x, y], azimuth);
                let facets = Facets { index: INDEX, coating };
                let stays = follow(face, facets, &ray, Side::Above, (&numbers, path), &mut |leaves| {
                    let is_back = leaves.along[2] > 1.0 - 1e-12;
                    share += if is_back { leaves.weight } else { 0.0 };
                });
                assert_eq!(stays.lost, 0.0);
            }
        };
        surface.with_face(number, trace).unwrap();
        share / rays as f64
    });
    mean_and_error(shares)
}

/// Corner cubes of a metal return light along the normal: all of it after three facets (square faces), or two
/// thirds (triangular faces).
#[test]
fn corner_cubes_return_light() {
    let grey = Coating::Mirror { reflectance: 0.8 };
    let (share, error) = returned(&corner_cubes(), &grey, 16);
    assert!((share - 0.512).abs() < 1e-12 && error < 1e-12, "{share} {error}");
    let (share, error) = returned(&triangular_corner_cubes(), &grey, 128);
    let expected = 0.512 * 2.0 / 3.0;
    assert!(error < 2e-3 && (share - expected).abs() < 4.0 * error, "{share} {error} {expected}");
    // Facets at 54.7356 deg: light in glass is totally reflected, n > 1.2247.
    let of = Goniometer { index_above: 1.5, index_below: 1.0, ..goniometer(Coating::None, &[0.0], 16) };
    let totals = of.totals_alone(&Surface::Mesh(corner_cubes()));
    assert!((totals[0].reflected.value - 1.0).abs() < 1e-12 && totals[0].mean_facets.value == 3.0);
}

/// A hemisphere of `meridians` x `parallels` facets on a flat square, which the exact one is compared with.
fn hemisphere(pitch: f64, radius: f64, meridians: usize, parallels: usize) -> Vec<Triangle> {
    let turn = |k: usize| std::f64::consts::TAU * (k % meridians) as f64 / meridians as f64;
    // Ring 0 is the square, ring 1 the rim; the pole is the last.
    let place = |ring: usize, k: usize| {
        let (sin, cos) = turn(k).sin_cos();
        if ring == 0 {
            let scale = 0.5 * pitch / sin.abs().max(cos.abs());
            return [scale * cos, scale * sin, 0.0];
        }
        let up = std::f64::consts::FRAC_PI_2 * (ring - 1) as f64 / parallels as f64;
        [radius * up.cos() * cos, radius * up.cos() * sin, radius * up.sin()]
    };
    let cells = (0..=parallels).flat_map(|ring| (0..meridians).map(move |k| (ring, k)));
    let triangles = cells.flat_map(|(ring, k)| {
        let [a, b, c, d] = [place(ring, k), place(ring, k + 1), place(ring + 1, k), place(ring + 1, k + 1)];
        // At the pole, the second triangle is none.
        [[a, b, c], [d, c, b]]
    });
    triangles.collect()
}

/// Hemispheres as a fine mesh are the exact ones. The polygon of 96 sides is smaller by 0.07 %, and its
/// slopes are off by up to 0.03 rad.
#[test]
fn fine_meshes_of_hemispheres_are_caps() {
    let (pitch, radius) = (4.5, 2.0);
    let mesh = Mesh::new(&hemisphere(pitch, radius, 96, 24), None).unwrap();
    assert!(
        mesh.notes()[0].starts_with("96 triangles with two corners at the same place"),
        "{:?}",
        mesh.notes()
    );
    let exact = Caps { pitch_um: pitch, radius_um: radius, aperture_um: radius, lattice: Lattice::Square };
    let of = goniometer(Coating::None, &[0.0, 60.0], sized(700, 1500));
    let [mesh, exact] = [Surface::Mesh(mesh), Surface::Caps(exact)].map(|surface| of.totals_alone(&surface));
    for (mesh, exact) in mesh.iter().zip(&exact) {
        for (a, b) in [
            (mesh.reflected, exact.reflected),
            (mesh.transmitted_beyond, exact.transmitted_beyond),
            (mesh.regular_transmitted, exact.regular_transmitted),
        ] {
            let allowed = 4.0 * a.error.hypot(b.error) + 2e-3;
            assert!((a.value - b.value).abs() < allowed, "{mesh:?}\n{exact:?}");
        }
    }
}

/// Surfaces that are open, turned, many, or none.
#[test]
fn meshes_that_are_no_surface_are_refused() {
    let whole = of_map(&rough_map());
    let message = |triangles: &[Triangle], period| Mesh::new(triangles, period).unwrap_err().to_string();
    let period = Some([10.0, 8.0]);
    let mut open = whole.clone();
    let gone = open.remove(37);
    let found = message(&open, period);
    assert!(
        found.contains("is open: it belongs to one triangle") && found.contains("every 10 um"),
        "{found}"
    );
    let [x, y, _] = gone[0];
    assert!(
        (0..3).any(|k| found.contains(&format!("({:.6}, {:.6}", gone[k][0], gone[k][1]))),
        "{x} {y} {found}"
    );
    let mut turned = whole.clone();
    turned[5].swap(0, 1);
    assert!(message(&turned, period).contains("opposite normals"));
    let down: Vec<Triangle> = whole.iter().map(|[a, b, c]| [*b, *a, *c]).collect();
    let up = Mesh::new(&down, period).unwrap();
    assert!(up.notes()[0].contains("were turned"));
    let mut twice = whole.clone();
    twice.extend(whole.iter().map(|one| one.map(|[x, y, z]| [x, y, z + 9.0])));
    assert!(message(&twice, period).contains("2 surfaces that do not hang together"));
    let tetrahedron = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let body: Vec<Triangle> =
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].iter().map(|one| one.map(|k| tetrahedron[k])).collect();
    assert!(message(&body, Some([3.0; 2])).contains("covers 0.000 of its period"));
    let mut flat = whole.clone();
    flat.push([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    assert!(message(&flat, period).contains("has no area"));
    assert!(message(&whole, Some([9.0, 8.0])).contains("um"));
    assert!(message(&[], None).contains("period"));
    let mut infinite = whole;
    infinite[3][1][2] = f64::NAN;
    assert!(message(&infinite, period).contains("NaN"));
}

#[test]
fn mesh_of_extreme_proportions_is_refused() {
    let square = |x: f64, y: f64| {
        let [a, b, c, d] = [[0.0, 0.0, 0.0], [x, 0.0, 0.0], [x, y, 0.0], [0.0, y, 0.0]];
        [[a, b, c], [a, c, d]]
    };
    for (x, y) in [(1e9, 50.0), (1e-4, 244.9), (1e300, 1.0), (1.0, 1e-300)] {
        let refused = Mesh::new(&square(x, y), None).unwrap_err().to_string();
        assert!(refused.contains("elongated"), "{x} {y}: {refused}");
    }
    for side in [5e-324, 1e-300, 1e300] {
        let refused = Mesh::new(&square(side, side), None).unwrap_err().to_string();
        assert!(refused.contains("cannot have a period"), "{side}: {refused}");
    }
    assert!(Mesh::new(&square(1e-50, 1e-50), None).is_ok());
    let refused = Mesh::new(&square(50.0, 50.0), Some([1e-4, 1e-4])).unwrap_err().to_string();
    assert!(refused.contains("extends"), "{refused}");
    assert!(Mesh::new(&square(100.0, 1.0), None).is_ok());
}
