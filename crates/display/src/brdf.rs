//! The finished display as a spectral BSDF: what it makes of light from any direction.
//!
//! A display of layers alike in all azimuths is isotropic, so two inclinations and
//! the azimuth between them say everything. It is opaque: there is no transmission.

/// The directions of a [`BrdfTable`], in air, both pointing away from the display.
#[derive(Debug, Clone, PartialEq)]
pub struct BrdfGrid {
    /// Inclinations of the light, ascending, 0 to less than 90 degrees.
    pub theta_i_deg: Vec<f64>,
    /// Inclinations of the viewer, ascending, 0 to less than 90 degrees.
    pub theta_o_deg: Vec<f64>,
    /// Azimuth of the viewer from that of the light, ascending, 0 (back to the light) to 180
    /// (the mirror's side) degrees. The display is alike on the other side.
    pub dphi_deg: Vec<f64>,
}

impl BrdfGrid {
    /// Every `step_deg` degrees, a divisor of 180: inclinations from 0 to below 90, azimuths from 0 to 180.
    pub fn even(step_deg: f64) -> Self {
        let every = |end: f64| -> Vec<f64> {
            (0..=(end / step_deg).round() as u32).map(|k| step_deg * f64::from(k)).collect()
        };
        let mut theta_deg = every(90.0);
        theta_deg.retain(|theta| *theta < 90.0 - 1e-9);
        Self { theta_i_deg: theta_deg.clone(), theta_o_deg: theta_deg, dphi_deg: every(180.0) }
    }

    /// How many pairs of directions there are.
    pub fn pairs(&self) -> usize {
        self.theta_i_deg.len() * self.theta_o_deg.len() * self.dphi_deg.len()
    }
}

/// The display's spectral BSDF, for each state.
#[derive(Debug, Clone, PartialEq)]
pub struct BrdfTable {
    /// The directions.
    pub grid: BrdfGrid,
    /// Wavelengths, nm.
    pub wavelength_nm: Vec<f64>,
    /// The drive states, in the order of the scenario.
    pub states: Vec<BrdfState>,
    /// Nodes of the quadrature.
    pub nodes: u64,
    /// The largest relative discretisation error found.
    pub discretisation_error: f64,
}

/// The BSDF of one state.
#[derive(Debug, Clone, PartialEq)]
pub struct BrdfState {
    /// Name of the state.
    pub name: String,
    /// The scattering part, `dL_o/dE_i` in 1/sr, [theta_i][theta_o][dphi][wavelength] (the
    /// last fastest). Single precision: the table is large, and seven digits are more than
    /// any of them are worth.
    pub brdf: Vec<f32>,
    /// The mirror part: share of a beam that leaves in the mirror direction, [theta_i][wavelength].
    pub specular: Vec<f64>,
    /// Share of a beam that leaves at all (scattered and mirrored), [theta_i][wavelength].
    pub directional_hemispherical: Vec<f64>,
}
