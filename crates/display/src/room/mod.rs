//! The room and the sky as fields of light over the display.
//!
//! - [`cap`]: an even part of the hemisphere around any direction;
//! - [`profile`]: alike at all azimuths, from a table over inclination;
//! - [`luminous_sheet`]: what a sheet of light sends into each direction;
//! - [`Panorama`]: a picture of the whole sphere;
//! - [`Sky`]: the CIE standard general skies;
//! - [`Pose`]: how the display stands below a sky or in a room.
//!
//! Everything here is relative: shares of illuminance and spectra are the scene's.

mod cap;
mod map;
mod pose;
mod profile;
mod sky;

use papilio_transport::Field;

pub use cap::cap;
pub use map::{Cells, Panorama};
pub use pose::Pose;
pub use profile::profile;
pub use sky::Sky;

/// Rows and columns in which a sheet's light is taken.
const SHEET: [usize; 2] = [180, 180];

/// What a luminous sheet over the display sends down: `intensity` by the angle from the normal and the azimuth *towards* which
/// light goes, degrees. `None` if it is dark.
///
/// A sheet looks smaller from aslant: its radiance is its intensity over the cosine. Each cell has the mean over
/// its projected solid angle of light that is as intense throughout it as in its middle.
pub fn luminous_sheet(intensity: impl Fn(f64, f64) -> f64) -> Option<Field> {
    let [rows, columns] = SHEET;
    let edges: Vec<f64> = (0..=rows).map(|row| 90.0 * row as f64 / rows as f64).collect();
    let radiance = edges.windows(2).flat_map(|edge| {
        let [from, to] = [edge[0], edge[1]].map(f64::to_radians);
        let solid_over_projected = 2.0 * (from.cos() - to.cos()) / (to.sin().powi(2) - from.sin().powi(2));
        let middle = 0.5 * (edge[0] + edge[1]);
        // Light that goes towards an azimuth comes from the opposite one.
        let towards = move |column: usize| 360.0 * (column as f64 + 0.5) / columns as f64 + 180.0;
        (0..columns).map(move |column| (middle, towards(column), solid_over_projected))
    });
    let radiance: Vec<f64> = radiance.map(|(theta, phi, ratio)| intensity(theta, phi) * ratio).collect();
    let is_round = radiance.chunks_exact(columns).all(|row| row.iter().all(|value| *value == row[0]));
    if is_round {
        let radiance = radiance.into_iter().step_by(columns).collect();
        return Some(Field::new(&edges, 1, radiance)?.0);
    }
    Some(Field::new(&edges, columns, radiance)?.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::Beta;

    /// Lambert's cosine law is even radiance; light towards +x comes from -x.
    #[test]
    fn a_sheet_of_cosine_intensity_is_even() {
        let even = luminous_sheet(|theta, _| theta.to_radians().cos()).unwrap();
        assert!(even.is_ring());
        for theta in [1.0, 30.0, 60.0, 85.0] {
            let radiance = std::f64::consts::PI * even.radiance(Beta::from_source(theta, 10.0, 1.0));
            assert!((radiance - 1.0).abs() < 1e-4, "{theta}: {radiance}");
        }
        let to_the_right = luminous_sheet(|_, phi| phi.to_radians().cos().max(0.0)).unwrap();
        assert!(to_the_right.radiance(Beta::from_source(30.0, 180.0, 1.0)) > 0.1);
        assert_eq!(to_the_right.radiance(Beta::from_source(30.0, 0.0, 1.0)), 0.0);
        assert!(luminous_sheet(|_, _| 0.0).is_none());
    }
}
