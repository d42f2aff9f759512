//! The grid of an imaging sphere: rings about the specular direction.
//!
//! Light comes from inclination `a` at azimuth 180 deg, so that its specular
//! direction is `s = (sin a, 0, cos a)`. A cell at radial distance `r` and azimuth `A` about it lies in
//! `d = cos r s + sin r (cos A e0 + sin A e1)` with `e0 = (-cos a, 0, sin a)`, which points from `s`
//! towards the normal, and `e1 = s x e0 = (0, -1, 0)`. Cells with `d.z < 0` are outside the hemisphere.
//!
//! A sample that was turned by `w` about its normal, counter-clockwise seen from the front, has seen all
//! of it turned by `-w`: light from azimuth `180 - w`.

use crate::Direction;

/// Rings about the specular direction. Cells in the order rotation, incidence, azimuth, radial
/// distance, the last fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct SpecularGrid {
    /// Turns of the sample about its normal, degrees, ascending.
    pub rotations_deg: Vec<f64>,
    /// Inclinations of the light, degrees, ascending.
    pub incidences_deg: Vec<f64>,
    /// Azimuths about the specular direction, degrees, ascending.
    pub azimuths_deg: Vec<f64>,
    /// Distances from the specular direction, degrees, ascending.
    pub radials_deg: Vec<f64>,
    /// What the azimuths stand for.
    pub symmetry: Symmetry,
}

/// What a grid's azimuths stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// 0 to 180 deg, mirrored in the plane of incidence.
    Plane,
    /// All around.
    None,
}

impl SpecularGrid {
    /// How many cells there are.
    pub fn cells(&self) -> usize {
        self.rotations_deg.len()
            * self.incidences_deg.len()
            * self.azimuths_deg.len()
            * self.radials_deg.len()
    }

    /// Directions of light and viewer of a cell, in the coordinates of the sample; `None` outside the
    /// hemisphere.
    pub(crate) fn directions(&self, cell: usize) -> Option<[Direction; 2]> {
        let (radials, azimuths) = (self.radials_deg.len(), self.azimuths_deg.len());
        let radial = self.radials_deg.get(cell.checked_rem(radials)?)?;
        let azimuth = self.azimuths_deg.get((cell / radials).checked_rem(azimuths)?)?;
        let incidence = cell / radials / azimuths;
        let incidences = self.incidences_deg.len();
        let incidence_deg = *self.incidences_deg.get(incidence.checked_rem(incidences)?)?;
        let rotation = self.rotations_deg.get(incidence / incidences)?;
        let viewer = Self::direction(incidence_deg, *azimuth, *radial)?;
        let light = Direction::new(incidence_deg, 180.0 - rotation);
        Some([light, Direction::new(viewer.theta_deg, viewer.phi_deg - rotation)])
    }

    /// Where a cell lies, for light from azimuth 180 deg; `None` outside the hemisphere.
    pub fn direction(incidence_deg: f64, azimuth_deg: f64, radial_deg: f64) -> Option<Direction> {
        let (sin_a, cos_a) = incidence_deg.to_radians().sin_cos();
        let (sin_r, cos_r) = radial_deg.to_radians().sin_cos();
        let (sin_azimuth, cos_azimuth) = azimuth_deg.to_radians().sin_cos();
        let towards = sin_r * cos_azimuth;
        let d = [cos_r * sin_a - towards * cos_a, -sin_r * sin_azimuth, cos_r * cos_a + towards * sin_a];
        // The horizon itself belongs to it, however it is rounded.
        (d[2] >= -1e-12).then(|| Direction::of_vector([d[0], d[1], d[2].max(0.0)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The worked directions of the format's description.
    #[test]
    fn cells_lie_where_the_format_says() {
        for (azimuth, theta, phi) in [(0.0, 10.0, 0.0), (90.0, 35.531, -36.052), (180.0, 50.0, 0.0)] {
            let d = SpecularGrid::direction(30.0, azimuth, 20.0).unwrap();
            assert!((d.theta_deg - theta).abs() < 1e-3 && (d.phi_deg - phi).abs() < 1e-3, "{azimuth}: {d:?}");
        }
        assert_eq!(SpecularGrid::direction(75.0, 180.0, 20.0), None);
    }
}
