//! Spectral BSDF of a whole display.
//!
//! A display of rotationally symmetric layers is isotropic: its BSDF is a function of two inclinations and
//! the azimuth between them. Above a pixel that depends on azimuth, it is also a function of the azimuth of the light. Such a pixel is
//! a mirror whose reflectance is the same at opposite azimuths (it is reciprocal), and so is the BSDF of the display when light and
//! viewer are both turned by 180 degrees. The display is opaque: there is no transmission.

use crate::DisplayError;
use crate::viewers::{Viewer, ViewerGrid, ViewerTable, azimuth_words, directions_of_light};

/// Directions of a [`BrdfTable`], in air; both point away from the display.
#[derive(Debug, Clone, PartialEq)]
pub struct BrdfGrid {
    /// Inclinations of the light, ascending, 0 to less than 90 degrees.
    pub theta_i_deg: Vec<f64>,
    /// Azimuths of the light, ascending, 0 to less than 180 degrees; none for a display that is isotropic in azimuth.
    pub phi_i_deg: Vec<f64>,
    /// Inclinations of the viewer, ascending, 0 to less than 90 degrees.
    pub theta_o_deg: Vec<f64>,
    /// Azimuth of the viewer relative to that of the light, ascending, 0 (towards the light) to 180
    /// (mirror direction) degrees, where the display is symmetric about the plane of incidence; with azimuths of the light,
    /// 0 to less than 360 degrees.
    pub dphi_deg: Vec<f64>,
}

impl BrdfGrid {
    /// Largest number of values of a table, which take 400 MB.
    pub const MOST_NUMBERS: usize = 100_000_000;

    /// Uniform grid with steps of `step_deg` degrees, a divisor of 180: inclinations from 0 to below 90,
    /// azimuths from 0 to 180.
    pub fn even(step_deg: f64) -> Self {
        let every = |end: f64| -> Vec<f64> {
            (0..=(end / step_deg).round() as u32).map(|k| step_deg * f64::from(k)).collect()
        };
        let mut theta_deg = every(90.0);
        theta_deg.retain(|theta| *theta < 90.0 - 1e-9);
        Self {
            theta_i_deg: theta_deg.clone(),
            phi_i_deg: Vec::new(),
            theta_o_deg: theta_deg,
            dphi_deg: every(180.0),
        }
    }

    /// The same grid for a display that depends on azimuth: azimuths of the light in steps of `phi_step_deg`, a divisor of 180, over half a
    /// turn, and viewers over a whole one.
    pub fn around(step_deg: f64, phi_step_deg: f64) -> Self {
        let one_side = Self::even(step_deg);
        let other = one_side.dphi_deg.iter().rev().skip(1).map(|dphi| 360.0 - dphi);
        let dphi_deg = one_side.dphi_deg.iter().copied().chain(other.filter(|dphi| *dphi < 360.0)).collect();
        Self { phi_i_deg: half_turn(phi_step_deg), dphi_deg, ..one_side }
    }

    /// Returns the directions of the light, inclination and azimuth, degrees: all azimuths of the first inclination first.
    pub fn lights_deg(&self) -> Vec<[f64; 2]> {
        directions_of_light(&self.theta_i_deg, &self.phi_i_deg)
    }

    /// Returns the number of directions of the light.
    pub fn lights(&self) -> usize {
        self.theta_i_deg.len() * self.phi_i_deg.len().max(1)
    }

    /// Returns the number of pairs of directions.
    pub fn pairs(&self) -> usize {
        self.lights() * self.theta_o_deg.len() * self.dphi_deg.len()
    }
}

/// Azimuths in steps of `step_deg`, a divisor of 180, from 0 to less than 180 degrees.
pub(crate) fn half_turn(step_deg: f64) -> Vec<f64> {
    (0..(180.0 / step_deg).round() as u32).map(|k| step_deg * f64::from(k)).collect()
}

/// The viewers of a [`BrdfGrid`], the same for each direction of the light.
pub(crate) struct SameViewers(pub(crate) BrdfGrid);

impl ViewerGrid for SameViewers {
    fn theta_i_deg(&self) -> &[f64] {
        &self.0.theta_i_deg
    }

    fn phi_i_deg(&self) -> &[f64] {
        &self.0.phi_i_deg
    }

    fn viewers(&self, _light: usize) -> (Vec<Viewer>, Vec<Option<usize>>) {
        let viewer = |theta_o_deg: f64, dphi_deg: f64| Viewer {
            cos_theta_o: theta_o_deg.to_radians().cos(),
            theta_o_deg,
            dphi_deg,
        };
        let grid = &self.0;
        let viewers: Vec<Viewer> = grid
            .theta_o_deg
            .iter()
            .flat_map(|theta| grid.dphi_deg.iter().map(move |dphi| viewer(*theta, *dphi)))
            .collect();
        let numbers = (0..viewers.len()).map(Some).collect();
        (viewers, numbers)
    }
}

/// BSDF of a display at the directions of a [`BrdfGrid`]; rows of its states and errors are
/// `[theta_i][phi_i][theta_o][dphi]`.
pub type BrdfTable = ViewerTable<BrdfGrid>;

impl BrdfTable {
    /// Checks that the error of each row is at most the allowed error, or the scenario's target if none is
    /// given.
    ///
    /// # Errors
    /// If a row exceeds the limit; the message names the worst rows.
    pub fn allowing(mut self, error: Option<f64>) -> Result<Self, DisplayError> {
        let grid = &self.grid;
        let name = |row: usize| {
            let (pair, dphi) = (row / grid.dphi_deg.len(), row % grid.dphi_deg.len());
            let (light, viewer) = (pair / grid.theta_o_deg.len(), pair % grid.theta_o_deg.len());
            let (state, light) = (light / grid.lights(), light % grid.lights());
            let [theta_i, phi_i] = grid.lights_deg()[light];
            format!(
                "state {}, theta_i {theta_i} deg{}, theta_o {} deg, dphi {} deg",
                self.states[state].name,
                azimuth_words(&grid.phi_i_deg, phi_i),
                grid.theta_o_deg[viewer],
                grid.dphi_deg[dphi]
            )
        };
        self.row_errors = std::mem::take(&mut self.row_errors).allow(error, "BRDF", name)?;
        Ok(self)
    }

    /// Computes the difference between the sum over the table's directions and the directional-hemispherical
    /// reflectance: the largest over states and inclinations of the light, relative to the largest
    /// reflectance of the state; spectra are averaged. It shows whether the directions are dense enough to
    /// resolve the lobes of the display.
    pub fn missed(&self) -> f64 {
        let bins = self.wavelength_nm.len().max(1) as f64;
        let weights = self.weights();
        let states = self.states.iter().map(|state| {
            let of_light = |values: &[f64], i: usize| -> f64 {
                let row = values.chunks(self.wavelength_nm.len().max(1)).nth(i);
                row.map_or(0.0, |row| row.iter().sum::<f64>() / bins)
            };
            let scattered = state.brdf.chunks(weights.len().max(1) * self.wavelength_nm.len().max(1));
            let rows = scattered.enumerate().map(|(i, row)| {
                let cells = row.chunks(self.wavelength_nm.len().max(1)).zip(&weights);
                let sum: f64 =
                    cells.map(|(cell, w)| w * cell.iter().map(|f| f64::from(*f)).sum::<f64>() / bins).sum();
                let leaves = of_light(&state.directional_hemispherical, i);
                ((sum + of_light(&state.specular, i) - leaves).abs(), leaves)
            });
            let (missed, most) = rows.fold((0.0, 0.0), |(a, b): (f64, f64), (x, y)| (a.max(x), b.max(y)));
            if most > 0.0 { missed / most } else { 0.0 }
        });
        states.fold(0.0, f64::max)
    }

    /// Projected solid angle of each direction of the viewer, for both sides of the plane of incidence,
    /// [theta_o][dphi].
    fn weights(&self) -> Vec<f64> {
        let theta: Vec<f64> = self.grid.theta_o_deg.iter().map(|theta| theta.to_radians()).collect();
        let phi: Vec<f64> = self.grid.dphi_deg.iter().map(|phi| phi.to_radians()).collect();
        let rings = trapezoids(&theta, std::f64::consts::FRAC_PI_2);
        let (arcs, sides) = match self.grid.phi_i_deg[..] {
            [] => (trapezoids(&phi, std::f64::consts::PI), 2.0),
            _ => (arcs(&phi), 1.0),
        };
        let ring = |(theta, width): (&f64, &f64)| theta.sin() * theta.cos() * width;
        let rings = theta.iter().zip(&rings).map(ring);
        rings.flat_map(|ring| arcs.iter().map(move |arc| sides * ring * arc)).collect()
    }
}

/// Weights of the trapezoidal rule at these positions and at `end`, where the integrand is assumed to be zero
/// unless it is one of the positions.
fn trapezoids(positions: &[f64], end: f64) -> Vec<f64> {
    let step = |from: usize, to: usize| match (positions.get(from), positions.get(to)) {
        (Some(from), Some(to)) => 0.5 * (to - from),
        (Some(from), None) => 0.5 * (end - from).max(0.0),
        _ => 0.0,
    };
    (0..positions.len()).map(|k| step(k, k + 1) + if k > 0 { step(k - 1, k) } else { 0.0 }).collect()
}

/// Weights of the trapezoidal rule at these positions on a circle.
fn arcs(positions: &[f64]) -> Vec<f64> {
    let count = positions.len();
    let gap =
        |from: usize| (positions[(from + 1) % count] - positions[from]).rem_euclid(std::f64::consts::TAU);
    let step = |from: usize| if count == 1 { std::f64::consts::TAU } else { gap(from) };
    (0..count).map(|k| 0.5 * (step(k) + step((k + count - 1) % count))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RowErrors;
    use crate::viewers::BrdfState;

    /// White paint: f = rho/pi in all directions, with a directional-hemispherical reflectance of rho.
    fn paint(step_deg: f64, specular: f64) -> BrdfTable {
        painted(BrdfGrid::even(step_deg), specular)
    }

    fn painted(grid: BrdfGrid, specular: f64) -> BrdfTable {
        let lights = grid.lights();
        let state = BrdfState {
            name: "white".to_owned(),
            brdf: vec![(0.8 / std::f64::consts::PI) as f32; grid.pairs() * 2],
            specular: vec![specular; lights * 2],
            directional_hemispherical: vec![0.8 + specular; lights * 2],
        };
        let wavelength_nm = vec![500.0, 600.0];
        BrdfTable {
            grid,
            wavelength_nm,
            states: vec![state],
            nodes: 0,
            discretisation_error: 0.0,
            row_errors: RowErrors::default(),
        }
    }

    #[test]
    fn sum_over_directions_of_white_paint_equals_its_reflectance() {
        // The trapezoidal rule's own error for sin cos: h^2/3 with h in radians.
        assert!(paint(5.0, 0.1).missed() < 3e-3);
        assert!(paint(1.0, 0.0).missed() < 1.1e-4);
        let mut table = paint(1.0, 0.0);
        table.states[0].directional_hemispherical.fill(0.9);
        assert!((table.missed() - 1.0 / 9.0).abs() < 1e-3);
        let around = painted(BrdfGrid::around(5.0, 60.0), 0.1);
        assert_eq!((around.grid.lights(), around.grid.dphi_deg.len()), (3 * 18, 72));
        assert!(around.missed() < 3e-3);
    }
}
