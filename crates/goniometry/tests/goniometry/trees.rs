//! Tensor trees against the lobe that their cells sample.

use std::f64::consts::{FRAC_PI_4, PI};

use papilio_goniometry::{
    Audit, Channel, Direction, Geometry, MeasuredPart, Preparation, ScatterMode, TensorTree, TreeNode, kernel,
};
use papilio_optics::{Beta, Scatterer};

/// Cells of a side.
const SIDE: usize = 4;

/// Transmits half of the light.
fn lobe(from: Beta, to: Beta) -> f64 {
    let apart = (to.x - from.x).powi(2) + (to.y - from.y).powi(2);
    0.15 / (2.0 * PI * (0.09 + apart).powf(1.5))
}

/// Place in the disc of a place in the square (Shirley and Chiu, J. Graph. Tools 2, 45 (1997)).
fn disc_of([x, y]: [f64; 2]) -> Beta {
    let (a, b) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    let (radius, turn) = if a.abs() > b.abs() { (a, b / a) } else { (b, 2.0 - a / b) };
    Beta { x: radius * (FRAC_PI_4 * turn).cos(), y: radius * (FRAC_PI_4 * turn).sin() }
}

fn part(value: impl Fn(Beta, Beta) -> f64) -> MeasuredPart {
    let middle = |k: usize| (k as f64 + 0.5) / SIDE as f64;
    // The light is on the first side, whose upper half is empty.
    let of_cell = |k: usize| {
        let sin = 1.0 - 2.0 * middle(k / (SIDE * SIDE));
        let to = disc_of([middle(k / SIDE % SIDE), middle(k % SIDE)]);
        if sin > 0.0 { value(Beta { x: sin, y: 0.0 }, to) } else { 0.0 }
    };
    let tree = TensorTree::new(3, vec![TreeNode::Grid { log2: 2, cell: 0 }]).unwrap();
    MeasuredPart {
        way: ScatterMode::FrontTransmission,
        channels: vec![Channel::Monochrome],
        geometry: Geometry::Tree(tree),
        values: (0..SIDE * SIDE * SIDE).map(of_cell).collect(),
        tis: Vec::new(),
    }
}

/// A display spreads the cells of a tree over rings. The grid error is what this moves: next to nothing of an even tree, and
/// of a lobe the differences of the light, by an own sum over the disc.
#[test]
fn grid_error_of_a_tree_is_the_light_that_a_display_moves() {
    let even = Audit::of(&part(|_, _| 0.5 / PI), 0).unwrap();
    assert!(even.grid_error().unwrap() < 0.02, "{:?}", even.grid_error());
    let part = part(lobe);
    let (scatter, changes) = kernel(&part, 0, &Preparation::default(), &[]).unwrap();
    let audit = Audit::of(&part, 0).unwrap();
    for one in audit.incidences.iter().filter(|one| [0.0, 30.0].contains(&one.theta_deg)) {
        let light = Direction::new(one.theta_deg, 180.0);
        let (mut differences, mut light_of_cells) = (0.0, 0.0);
        let steps = 150;
        let at = |k: i32| f64::from(2 * k + 1) / f64::from(steps) - 1.0;
        for (x, y) in (0..steps).flat_map(|i| (0..steps).map(move |j| (at(i), at(j)))) {
            if x * x + y * y < 1.0 {
                let to = Direction::new(x.hypot(y).asin().to_degrees(), y.atan2(x).to_degrees());
                let cell = part.evaluate(0, light, to).unwrap();
                differences += (scatter.evaluate(light.arriving(), to.leaving()) - cell).abs();
                light_of_cells += cell;
            }
        }
        let (moved, stated) = (0.5 * differences / light_of_cells, one.grid_error.unwrap());
        assert!(moved > 0.01 && (stated / moved - 1.0).abs() < 0.25, "{}: {stated} {moved}", one.theta_deg);
        assert!(changes.grid_error.unwrap() >= stated - 1e-9, "{changes:?}");
    }
}
