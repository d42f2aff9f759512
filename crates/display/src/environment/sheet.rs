//! Luminous plane over the display, given by its intensity distribution.
//!
//! The apparent area of the plane is proportional to the cosine of the angle: its radiance is the intensity
//! over the cosine.

use std::fmt::Debug;
use std::sync::Arc;

use papilio_transport::{Edge, Field, Radiance};

use super::pose::by_inclination;

/// Intensity distribution of a luminous plane.
pub trait Sheet: Debug + Send + Sync + 'static {
    /// Returns the intensity at an angle from the normal and the azimuth *towards* which the light travels,
    /// degrees.
    fn intensity(&self, theta_deg: f64, phi_deg: f64) -> f64;

    /// Returns the circles of directions between which the intensity is smooth: the centre, a unit vector
    /// (azimuth 0, azimuth 90 deg, normal) *towards* which light travels, and the angular radius, degrees.
    fn edges(&self) -> Vec<([f64; 3], f64)>;
}

/// Number of rows and columns of the cells from which the Monte Carlo solver draws directions.
const CELLS: [usize; 2] = [180, 180];

/// Returns the light of a luminous plane over the display; `None` if the intensity is 0 everywhere.
pub fn luminous_sheet(sheet: impl Sheet) -> Option<Field> {
    let [rows, columns] = CELLS;
    let towards = sheet.edges().into_iter();
    // Light that travels towards an azimuth comes from the opposite one.
    let edge = |([x, y, z], radius_deg): ([f64; 3], f64)| Edge {
        centre: [-x, -y, z],
        radius: radius_deg.to_radians(),
        scale: f64::INFINITY,
    };
    let mut down = Down { edges: towards.map(edge).collect(), sheet };
    let edges: Vec<f64> = (0..=rows).map(|row| 90.0 * row as f64 / rows as f64).collect();
    let turn = |column: usize| 360.0 * (column as f64 + 0.5) / columns as f64;
    let about: Vec<f64> = edges
        .windows(2)
        .flat_map(|edge| (0..columns).map(move |column| (0.5 * (edge[0] + edge[1]), turn(column))))
        .map(|(theta, phi)| down.at(by_inclination(theta.to_radians(), phi.to_radians())))
        .collect();
    let is_uniform = |row: &[f64]| row.iter().all(|value| (value - row[0]).abs() <= 1e-12 * row[0]);
    if about.chunks_exact(columns).all(is_uniform) {
        down.edges.retain(|edge| edge.centre[2].abs() > 1.0 - 1e-12);
        let about = about.into_iter().step_by(columns).collect();
        return Some(Field::of(Arc::new(down), &edges, 1, about)?.0);
    }
    Some(Field::of(Arc::new(down), &edges, columns, about)?.0)
}

#[derive(Debug)]
struct Down<S> {
    sheet: S,
    edges: Vec<Edge>,
}

impl<S: Sheet> Radiance for Down<S> {
    fn at(&self, [x, y, z]: [f64; 3]) -> f64 {
        // Light that travels towards an azimuth comes from the opposite one.
        let towards = (-y).atan2(-x).to_degrees();
        self.sheet.intensity(x.hypot(y).atan2(z).to_degrees(), towards) / z.max(1e-9)
    }

    fn edges(&self) -> Vec<Edge> {
        self.edges.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::Beta;

    struct Of<F>(F);

    impl<F> std::fmt::Debug for Of<F> {
        fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str("Of")
        }
    }

    impl<F: Fn(f64, f64) -> f64 + Send + Sync + 'static> Sheet for Of<F> {
        fn intensity(&self, theta_deg: f64, phi_deg: f64) -> f64 {
            self.0(theta_deg, phi_deg)
        }

        fn edges(&self) -> Vec<([f64; 3], f64)> {
            vec![([0.0, 0.0, 1.0], 90.0), ([1.0, 0.0, 0.0], 90.0)]
        }
    }

    fn sheet(of: impl Fn(f64, f64) -> f64 + Send + Sync + 'static) -> Option<Field> {
        luminous_sheet(Of(of))
    }

    /// An intensity by Lambert's cosine law is uniform radiance; light that travels towards +x comes from -x.
    #[test]
    fn plane_of_cosine_intensity_has_uniform_radiance() {
        let uniform = sheet(|theta, _| theta.to_radians().cos()).unwrap();
        assert!(uniform.is_ring());
        for theta in [1.0, 30.0, 60.0, 85.0] {
            let radiance = std::f64::consts::PI * uniform.radiance(Beta::from_source(theta, 10.0, 1.0));
            assert!((radiance - 1.0).abs() < 1e-4, "{theta}: {radiance}");
        }
        let to_the_right = sheet(|_, phi| phi.to_radians().cos().max(0.0)).unwrap();
        assert!(to_the_right.radiance(Beta::from_source(30.0, 180.0, 1.0)) > 0.1);
        assert_eq!(to_the_right.radiance(Beta::from_source(30.0, 0.0, 1.0)), 0.0);
        assert!(sheet(|_, _| 0.0).is_none());
    }
}
