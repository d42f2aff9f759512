//! Colours of a view without its spectra, as stored in a viewing cone.

use papilio_colour::{LUMENS_PER_WATT, UvPrime, Xyz};
use papilio_transport::Estimate;

use super::Meter;
use crate::cone::{ConeState, ConeView};

impl Meter<'_> {
    /// Computes the relative X, Y and Z of each state.
    pub(crate) fn colours(&self, estimate: &Estimate) -> Vec<Xyz> {
        let mut colours = vec![Xyz { x: 0.0, y: 0.0, z: 0.0 }; self.layout.states];
        for (light, rho) in self.lights.iter().zip(self.seen_of(&estimate.rho)) {
            let sum = |rho: &[f64], bar: &[f64]| rho.iter().zip(bar).map(|(r, w)| r * w).sum::<f64>();
            let seen = |rho: &[f64]| {
                let [x, y, z] = light.xyz.each_ref().map(|bar| sum(rho, bar));
                Xyz { x, y, z }
            };
            let front = seen(&rho.front);
            for (colour, base) in colours.iter_mut().zip(rho.via_pixel.chunks_exact(self.layout.bins)) {
                *colour = *colour + seen(base) + front;
            }
        }
        colours
    }

    /// Computes the entry of a viewing cone from these colours and those of the view along the normal, `normal`.
    pub(crate) fn cone_view(&self, colours: &[Xyz], normal: &[Xyz]) -> ConeView {
        let state = |(xyz, normal): (&Xyz, &Xyz)| {
            let (uv, from) = (xyz.uv_prime(), normal.uv_prime());
            ConeState {
                reflectance_factor_y: xyz.y,
                luminance_cd_m2: xyz.y * LUMENS_PER_WATT * self.white_xyz.y,
                u_prime: uv.map(|uv| uv.u),
                v_prime: uv.map(|uv| uv.v),
                uv_shift: uv.zip(from).map(|(uv, from)| UvPrime::distance(uv, from)),
            }
        };
        let together = self.reference(&[]).together(colours);
        ConeView {
            contrast_ratio: together.contrast_ratio,
            gamut_percent_srgb: together.gamut_percent_srgb,
            gamut_percent_ebu: together.gamut_percent_ebu,
            states: colours.iter().zip(normal).map(state).collect(),
        }
    }
}
