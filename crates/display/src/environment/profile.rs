//! Rotationally symmetric light, from a table over inclination.

use std::sync::Arc;

use papilio_transport::{Edge, Field, Radiance};

/// Largest height of the rows of cells from which the Monte Carlo solver draws directions, degrees.
const ROW_DEG: f64 = 5.0;

/// Returns rotationally symmetric light whose radiance is linear between the points of a table: inclinations
/// in degrees, ascending from at least 0 to at most 90, and relative radiances. The radiance is 0 before the
/// first and after the last point. `None` if all radiances are 0.
pub fn profile(points: &[(f64, f64)]) -> Option<Field> {
    let table = Table { points: points.to_vec() };
    let mut edges = vec![points.first()?.0];
    let mut about = Vec::new();
    for pair in points.windows(2) {
        let [(from, at_start), (to, at_end)] = [pair[0], pair[1]];
        let steps = ((to - from) / ROW_DEG).ceil().max(1.0);
        for step in 0..steps as usize {
            let along = (step as f64 + 0.5) / steps;
            about.push(at_start + along * (at_end - at_start));
            let end = from + (to - from) * (step as f64 + 1.0) / steps;
            edges.push(if step as f64 + 1.0 < steps { end } else { to });
        }
    }
    Some(Field::of(Arc::new(table), &edges, 1, about)?.0)
}

/// Inclinations, degrees, and radiances.
#[derive(Debug)]
struct Table {
    points: Vec<(f64, f64)>,
}

impl Radiance for Table {
    fn at(&self, [x, y, z]: [f64; 3]) -> f64 {
        let theta = x.hypot(y).atan2(z).to_degrees();
        let next = self.points.partition_point(|point| point.0 <= theta);
        match (next.checked_sub(1).map(|last| self.points[last]), self.points.get(next)) {
            (Some((from, at_start)), Some((to, at_end))) => {
                at_start + (theta - from) / (to - from) * (at_end - at_start)
            }
            // At the last point, within rounding errors.
            (Some((last, at_end)), None) if theta - last < 1e-9 => at_end,
            _ => 0.0,
        }
    }

    fn edges(&self) -> Vec<Edge> {
        let edge = |point: &(f64, f64)| Edge {
            centre: [0.0, 0.0, 1.0],
            radius: point.0.to_radians(),
            scale: f64::INFINITY,
        };
        self.points.iter().map(edge).collect()
    }

    fn span(&self) -> [f64; 2] {
        let at = |point: Option<&(f64, f64)>| point.map_or(0.0, |point| point.0.to_radians());
        [at(self.points.first()), at(self.points.last()).min(std::f64::consts::FRAC_PI_2)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::Beta;

    #[test]
    fn profile_is_linear_between_its_points() {
        let field = profile(&[(10.0, 0.0), (20.0, 2.0), (60.0, 2.0)]).unwrap();
        let at = |theta| field.radiance(Beta::from_source(theta, 77.0, 1.0));
        assert_eq!((at(9.0), at(61.0)), (0.0, 0.0));
        // The lookup is linear, not constant within the cells.
        assert!((at(15.2) / at(40.0) - 0.52).abs() < 1e-12);
        assert!(profile(&[(10.0, 0.0), (20.0, 0.0)]).is_none() && profile(&[]).is_none());
    }
}
