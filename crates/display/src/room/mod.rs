//! The room and the sky as fields of light over the display.
//!
//! - [`profile`]: alike at all azimuths, from a table over inclination;
//! - [`Panorama`]: a picture of the whole sphere;
//! - [`Sky`]: the CIE standard general skies;
//! - [`Pose`]: how the display stands below a sky or in a room.
//!
//! Everything here is relative: shares of illuminance and spectra are the scene's.

mod map;
mod pose;
mod sky;

use papilio_transport::Field;

pub use map::{Cells, Panorama};
pub use pose::Pose;
pub use sky::Sky;

/// Inclination steps in which a profile is taken, degrees.
const STEP_DEG: f64 = 0.5;

/// A field that is alike at all azimuths, its radiance linear between the points of a table: inclinations in
/// degrees, ascending from 0 or more to 90 or less, and relative radiances. It is dark before the first and beyond
/// the last; `None` if it is dark throughout.
pub fn profile(points: &[(f64, f64)]) -> Option<Field> {
    let mut edges = vec![points.first()?.0];
    let mut radiance = Vec::new();
    for pair in points.windows(2) {
        let [(from, at_start), (to, at_end)] = [pair[0], pair[1]];
        let steps = ((to - from) / STEP_DEG).ceil().max(1.0);
        for step in 0..steps as usize {
            let along = (step as f64 + 0.5) / steps;
            radiance.push(at_start + along * (at_end - at_start));
            edges.push(if step as f64 + 1.0 < steps {
                from + (to - from) * (step as f64 + 1.0) / steps
            } else {
                to
            });
        }
    }
    Some(Field::new(&edges, 1, radiance)?.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::Beta;

    #[test]
    fn a_profile_is_linear_between_its_points() {
        let field = profile(&[(10.0, 0.0), (20.0, 2.0), (60.0, 2.0)]).unwrap();
        let at = |theta| field.radiance(Beta::from_source(theta, 77.0, 1.0));
        assert_eq!((at(9.0), at(61.0)), (0.0, 0.0));
        assert!((at(15.2) / at(40.0) - 0.525).abs() < 1e-12);
        assert!(profile(&[(10.0, 0.0), (20.0, 0.0)]).is_none() && profile(&[]).is_none());
    }
}
