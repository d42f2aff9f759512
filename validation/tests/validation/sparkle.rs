//! Sparkle of lamps against rays at random places of faces of several millimetres
//! (`validation/sparkle/sparkle_oracle.py`).

use papilio_optics::{Beta, RandomFace};
use papilio_sparkle::{Deviation, Effort, Face, Matrix, Panel, Pixel, Plan, Pupil, Room, Source};
use papilio_testing::{everyday, sized};
use papilio_transport::spatial::Gap;

const TABLE: &str = include_str!("../../sparkle/sparkle.csv");

/// A row of the table: the panel, and the deviation of its uniform pixel plane.
struct Case {
    name: &'static str,
    panel: Panel,
    expected: Deviation,
}

fn case(name: &'static str) -> Case {
    let (pixel, numbers) = name.split_once(',').unwrap();
    let numbers: Vec<f64> = numbers.split(',').map(|number| number.parse().unwrap()).collect();
    let &[gap_mm, slope_rms, view_deg, phi_deg, lamp_deg, radius_deg, pupil_mm, distance_mm, ..] =
        &numbers[..]
    else {
        panic!("{name}")
    };
    let &[.., ppd, standard_error, mean, mean_error] = &numbers[..] else { panic!("{name}") };
    // The oracle states the lamp by the view from which its image is seen in a flat face.
    let beta = Beta::towards(lamp_deg, phi_deg, 1.0);
    let is_mirror = pixel == "mirror";
    let beta = if is_mirror { beta } else { Beta { x: -beta.x, y: -beta.y } };
    let panel = Panel {
        face: Face::Gaussian(RandomFace { slope_rms, correlation_mm: 0.015 }),
        media: vec![Gap { index: 1.5, thickness_mm: gap_mm }],
        matrix: Matrix::single(0.084, 0.084, 0.084),
        pixel: if is_mirror { Pixel::Mirror } else { Pixel::Lambertian },
        view: Beta::towards(view_deg, phi_deg, 1.0),
        pupil: Pupil { diameter_mm: pupil_mm, distance_mm },
        room: Room { diffuse: 0.7, sources: vec![Source { beta, radius_deg, illuminance: 0.3 }] },
    };
    Case { name, panel, expected: Deviation { ppd, standard_error, mean, mean_error } }
}

/// Faces of two pixels and of many, for every way between the places at which light enters and leaves: none,
/// a part of the period, the period and more. The number of replicates changes nothing but the period.
#[test]
fn sparkle_of_lamps_does_not_depend_on_the_period_of_the_face() {
    let rows: Vec<&str> = TABLE.lines().skip(1).collect();
    assert_eq!(rows.len(), 10);
    // Every day: a way of a period, paper, and a large lamp.
    for row in everyday(3, [2, 7, 9, 5, 6, 0, 1, 3, 4, 8]) {
        let Case { name, panel, expected } = case(rows[row]);
        for replicates in everyday(1, [128, 32, 1000, 8]) {
            let effort = Effort { replicates, pixels: sized(1024, 16384), ..Effort::default() };
            let plan = Plan::new(panel.clone(), effort).unwrap();
            let found = plan.run().source;
            let what = format!("{name}, {replicates} faces of {} pixels: {found:?}", plan.pixels());
            // Cells of an eighth of the correlation length lower the deviation by 0.3 %.
            let tolerance = 4.5 * found.standard_error.hypot(expected.standard_error) + 0.005 * expected.ppd;
            assert!(found.standard_error < 0.04 * found.ppd, "{what}");
            assert!((found.ppd - expected.ppd).abs() < tolerance, "{what}");
            let tolerance = 4.5 * found.mean_error.hypot(expected.mean_error) + 0.002 * expected.mean;
            assert!((found.mean - expected.mean).abs() < tolerance, "{what}");
            println!("{what}");
        }
    }
}
