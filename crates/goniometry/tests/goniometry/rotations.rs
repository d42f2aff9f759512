//! Samples that depend on rotation about their normal: every geometry gives the mean over rotations, which closed forms and
//! sums know.

use std::f64::consts::PI;

use papilio_goniometry::{
    Audit, Channel, Direction, Fill, Geometry, KLEMS_FULL, MeasuredPart, Preparation, ScatterMode, Shape,
    SpecularGrid, SphericalGrid, Symmetry, TensorTree, TreeNode, WarpFields, WarpedGrid, kernel,
};

fn steps(to: u32, step: usize) -> Vec<f64> {
    (0..=to).step_by(step).map(f64::from).collect()
}

fn part(geometry: Geometry, value: impl Fn([Direction; 2]) -> f64) -> MeasuredPart {
    let values = (0..geometry.cells()).map(|cell| geometry.directions(cell).map_or(0.0, &value)).collect();
    let (way, channels) = (ScatterMode::FrontReflection, vec![Channel::Monochrome]);
    MeasuredPart { way, channels, geometry, values, tis: Vec::new() }
}

/// A Lambertian reflection of 0.3 in the mean that depends on the azimuth of the light.
fn turned([light, _]: [Direction; 2]) -> f64 {
    0.3 / PI * (1.0 + 0.9 * (2.0 * (light.phi_deg - 70.0)).to_radians().cos())
}

/// Relative root mean square of 0.9 cos.
const ASYMMETRY: f64 = 0.9 * std::f64::consts::FRAC_1_SQRT_2;

fn spherical(phi_i_deg: Vec<f64>, phi_o_deg: Vec<f64>) -> Geometry {
    let (theta_i_deg, theta_o_deg) = (steps(50, 50), steps(90, 10));
    Geometry::Spherical(SphericalGrid { theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg })
}

/// Azimuths that coincide from each light, that do not, whose first and last are the same, and the rotations of an imaging
/// sphere.
#[test]
fn grids_are_averaged_over_the_azimuths_of_the_light() {
    let sphere = SpecularGrid {
        rotations_deg: steps(330, 30),
        incidences_deg: steps(50, 50),
        azimuths_deg: steps(180, 30),
        radials_deg: steps(180, 10),
        symmetry: Symmetry::Plane,
    };
    let geometries = [
        ("coincident", spherical(steps(330, 30), steps(330, 30))),
        ("between", spherical(steps(340, 20), steps(330, 30))),
        ("full turn", spherical(steps(360, 45), steps(360, 30))),
        ("single azimuth of the viewer", spherical(steps(315, 45), vec![0.0])),
        ("sphere", Geometry::Specular(sphere)),
    ];
    for (name, geometry) in geometries {
        let part = part(geometry, turned);
        let audit = Audit::of(&part, 0).unwrap();
        for incidence in &audit.incidences {
            assert!((incidence.integral - 0.3).abs() < 1e-6, "{name}: {incidence:?}");
        }
        assert!((audit.asymmetry - ASYMMETRY).abs() < 1e-6, "{name}: {}", audit.asymmetry);
        let (scatter, changes) = kernel(&part, 0, &Preparation::default(), &[]).unwrap();
        assert!((scatter.albedo_at(0.5) - 0.3).abs() < 1e-4, "{name}: {}", scatter.albedo_at(0.5));
        assert!((changes.asymmetry - ASYMMETRY).abs() < 1e-6, "{name}: {}", changes.asymmetry);
    }
}

/// Values of one light that were not measured do not take part.
#[test]
fn cells_that_were_not_measured_do_not_take_part_in_the_mean() {
    let mut part = part(spherical(steps(270, 90), steps(330, 30)), |_| 0.1);
    let lobe = 10 * 12;
    part.values[lobe..2 * lobe].fill(f64::NAN);
    let shape = Shape::of_part(&part, 0, Fill::None).unwrap();
    let (ratio, asymmetry) = (shape.total(0) / (0.1 * PI), shape.asymmetry());
    assert!((ratio - 1.0).abs() < 1e-5 && asymmetry < 1e-12, "{ratio} {asymmetry}");
}

/// An elliptical Gaussian about a direction beside the specular one, as of a brushed and tilted surface.
fn brushed([light, to]: [Direction; 2]) -> f64 {
    let delta = to.leaving() - light.arriving();
    let [x, y] = [delta.x - 0.136, delta.y - 0.063];
    let [u, v] = [0.5 * x + 0.866 * y, 0.5 * y - 0.866 * x];
    2.48 * (-0.5 * (u * u / 0.0225 + v * v / 0.09)).exp()
}

/// Against sums over the hemisphere and all rotations.
#[test]
fn mean_of_a_brushed_surface_equals_quadrature() {
    let incidences = [0.0, 60.0];
    let expected = incidences.map(|theta| {
        let mut sum = 0.0;
        for k in 0..60 * 72 * 24 {
            let middle = |k: usize, count: usize| (k % count) as f64 + 0.5;
            let (sin2, phi) = (middle(k, 60) / 60.0, middle(k / 60, 72) * 5.0);
            let to = Direction::new(sin2.sqrt().asin().to_degrees(), phi);
            sum += brushed([Direction::new(theta, middle(k / 60 / 72, 24) * 15.0), to]);
        }
        PI * sum / (60.0 * 72.0 * 24.0)
    });
    // Of azimuths in steps of 15 deg, every other one is interpolated: in steps of 10 deg, those of the viewer are as far apart
    // as this lobe is wide.
    for (azimuths, most) in [(10, 0.01), (15, 0.04)] {
        let part = part(
            Geometry::Spherical(SphericalGrid {
                theta_i_deg: incidences.to_vec(),
                phi_i_deg: steps(359, azimuths),
                theta_o_deg: steps(90, 3),
                phi_o_deg: steps(350, 10),
            }),
            brushed,
        );
        let audit = Audit::of(&part, 0).unwrap();
        for (found, expected) in audit.incidences.iter().zip(expected) {
            let error = found.integral / expected - 1.0;
            let claimed = found.grid_error.unwrap();
            assert!(
                error.abs() < claimed + 1e-3 && claimed < most,
                "{azimuths}: {error} {claimed} {expected}"
            );
        }
        assert!(audit.asymmetry > 0.5, "{}", audit.asymmetry);
    }
}

/// Reciprocal values of a sample that depends on rotation are those of the same azimuths, not of rotated ones.
#[test]
fn reciprocity_compares_the_same_azimuths() {
    let same = steps(330, 30);
    let worst = |value: &dyn Fn([Direction; 2]) -> f64| {
        let grid = SphericalGrid {
            theta_i_deg: steps(60, 20),
            phi_i_deg: same.clone(),
            theta_o_deg: steps(80, 20),
            phi_o_deg: same.clone(),
        };
        Audit::of(&part(Geometry::Spherical(grid), value), 0).unwrap().reciprocity.unwrap()[1]
    };
    let reciprocal = worst(&|[i, o]| {
        let [i, o] = [i.leaving(), o.leaving()];
        0.1 + 0.05 * i.x * o.x + 0.02 * (i.x * i.x + o.x * o.x)
    });
    assert!(reciprocal < 1e-9, "{reciprocal}");
    // The largest and the smallest value: 1.9 and 0.1 of the mean.
    assert!(worst(&|[i, o]| turned([Direction::new(0.0, i.phi_deg + 10.0), o])) > 1.7);
}

/// Warped grids with azimuths over the whole circle and over the quarter that symmetry repeats are like the isotropic one with
/// the mean of the values.
#[test]
fn warped_grids_are_averaged_over_rotations() {
    let of_lights = |phi_i: Vec<f64>| {
        let fields = WarpFields {
            theta_i: vec![0.0, 0.5 * PI],
            ndf: (vec![1.0; 4], [2, 2]),
            sigma: (vec![1.0; 4], [2, 2]),
            vndf: (vec![1.0; 8 * phi_i.len()], [2, 2]),
            shape: [2, 2],
            jacobian: false,
            phi_i: phi_i.clone(),
        };
        let value =
            |phi: &f64| vec![0.1 * (1.0 + if phi_i.len() > 1 { 0.9 * (2.0 * phi).cos() } else { 0.0 }); 8];
        let (way, channels) = (ScatterMode::FrontReflection, vec![Channel::Monochrome]);
        let values = phi_i.iter().flat_map(value).collect();
        let geometry = Geometry::Warped(Box::new(WarpedGrid::new(fields).unwrap()));
        Audit::of(&MeasuredPart { way, channels, geometry, values, tis: Vec::new() }, 0).unwrap()
    };
    let expected = of_lights(vec![0.0]);
    let circle = (-6..=6).map(|k| f64::from(k) * PI / 6.0).collect();
    let quarter = (0..=3).map(|k| -PI + f64::from(k) * PI / 6.0).collect();
    for phi_i in [circle, quarter] {
        let found = of_lights(phi_i);
        // Along the normal, light has no azimuth.
        for (found, expected) in found.incidences.iter().zip(&expected.incidences).skip(1) {
            assert!((found.integral / expected.integral - 1.0).abs() < 1e-6, "{found:?} {expected:?}");
        }
        assert!((found.asymmetry - ASYMMETRY).abs() < 1e-6, "{}", found.asymmetry);
    }
}

/// Cells and patches have a value for light of any azimuth: lit from one half of the disc only.
#[test]
fn trees_and_patches_are_averaged_over_rotations() {
    let tree = TensorTree::new(4, vec![TreeNode::Grid { log2: 2, cell: 0 }]).unwrap();
    // The first of the four sides is x of the light's direction.
    let values = (0..256).map(|cell| if cell / 64 >= 2 { 0.6 / PI } else { 0.0 }).collect();
    let (way, channels) = (ScatterMode::FrontReflection, vec![Channel::Monochrome]);
    let tree = MeasuredPart { way, channels, geometry: Geometry::Tree(tree), values, tis: Vec::new() };
    let (scatter, changes) = kernel(&tree, 0, &Preparation::default(), &[]).unwrap();
    assert!((scatter.albedo_at(0.8) - 0.3).abs() < 1e-3 && (changes.asymmetry - 1.0).abs() < 1e-9);
    let rings = KLEMS_FULL.to_vec();
    let patches = part(Geometry::Patches { incoming: rings.clone(), outgoing: rings }, turned);
    for (part, asymmetry) in [(tree, 1.0), (patches, ASYMMETRY)] {
        let shape = Shape::of_part(&part, 0, Fill::None).unwrap();
        for (k, theta) in shape.incidences_deg().enumerate().filter(|(_, theta)| *theta > 10.0) {
            assert!((shape.total(k) - 0.3).abs() < 1e-6, "{theta}: {}", shape.total(k));
        }
        assert!((shape.asymmetry() - asymmetry).abs() < 0.02, "{} {asymmetry}", shape.asymmetry());
    }
}
