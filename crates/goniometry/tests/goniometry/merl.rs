//! Half and difference angles (MERL), against the smooth lobe that the cells sample.

use std::f64::consts::{FRAC_PI_2, PI};

use papilio_goniometry::{
    Audit, Channel, Direction, Geometry, HalfAngleGrid, MeasuredPart, Preparation, ScatterMode, kernel,
};
use papilio_optics::Scatterer;

/// A diffuse part and a lobe of Beckmann facets, by the inclination of the half vector, radians.
fn lobe(theta_h: f64) -> f64 {
    let width = 0.15_f64;
    let (tan, cos) = (theta_h.tan(), theta_h.cos());
    0.3 / PI + 0.5 * (-(tan / width).powi(2)).exp() / (4.0 * PI * width * width * cos.powi(4))
}

/// f of the lobe for light from azimuth 180.
fn smooth(theta_i_deg: f64, to: Direction) -> f64 {
    let [i, o] = [Direction::new(theta_i_deg, 180.0).vector(), to.vector()];
    let half = [0, 1, 2].map(|k| i[k] + o[k]);
    lobe(half[0].hypot(half[1]).atan2(half[2]))
}

fn part() -> MeasuredPart {
    let [cells, others @ ..] = HalfAngleGrid::SHAPE;
    let of_row = |k: usize| lobe(((k as f64 + 0.5) / cells as f64).powi(2) * FRAC_PI_2);
    let values = (0..cells).flat_map(|k| vec![of_row(k); others.iter().product()]).collect();
    let (way, channels) = (ScatterMode::FrontReflection, vec![Channel::Green]);
    MeasuredPart { way, channels, geometry: Geometry::HalfAngle(HalfAngleGrid), values, tis: Vec::new() }
}

/// Values that are constant in cells are up to 8.5 % wrong at these directions. Nearer to the horizon, a display interpolates between
/// incidences.
#[test]
fn lobe_between_cells_is_smooth() {
    let part = part();
    let (scatter, changes) = kernel(&part, 0, &Preparation::default(), &[]).unwrap();
    let light = Direction::new(40.0, 180.0);
    for k in 0..26 {
        for azimuth in [0.0, 50.0] {
            let to = Direction::new(3.0 * f64::from(k), azimuth);
            let expected = smooth(40.0, to);
            let seen = scatter.evaluate(light.arriving(), to.leaving());
            for found in [seen, part.evaluate(0, light, to).unwrap()] {
                assert!((found / expected - 1.0).abs() < 0.01, "{to:?}: {found} {expected}");
            }
        }
    }
    assert!(changes.grid_error.unwrap() < 0.01, "{:?}", changes.grid_error);
}

/// Totals against a sum over the hemisphere, within the stated error.
#[test]
fn stated_error_of_totals_covers_the_true_one() {
    let audit = Audit::of(&part(), 0).unwrap();
    for found in audit.incidences.iter().filter(|found| found.theta_deg % 20.0 == 0.0) {
        const STEPS: [usize; 2] = [400, 200];
        let sum: f64 = (0..STEPS[0] * STEPS[1])
            .map(|k| {
                let sin2 = ((k / STEPS[1]) as f64 + 0.5) / STEPS[0] as f64;
                let phi = 180.0 * ((k % STEPS[1]) as f64 + 0.5) / STEPS[1] as f64;
                smooth(found.theta_deg, Direction::new(sin2.sqrt().asin().to_degrees(), phi))
            })
            .sum();
        let error = found.integral / (PI * sum / (STEPS[0] * STEPS[1]) as f64) - 1.0;
        let claimed = found.grid_error.unwrap();
        assert!(error.abs() < claimed + 2e-4 && claimed < 0.01, "{}: {error} {claimed}", found.theta_deg);
    }
}
