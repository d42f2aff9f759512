//! Colours of a view without its spectra, as stored in a viewing cone.

use papilio_colour::{LUMENS_PER_WATT, Xyz};
use papilio_transport::ReflectanceFactor;

use super::metrics::Colour;
use super::{Meter, over};
use crate::cone::{ConeState, ConeView};

impl Meter<'_> {
    /// Computes the relative X, Y and Z of each state from the reflectance factors of an estimate.
    pub(crate) fn colours(&self, rho: &[ReflectanceFactor]) -> Vec<Xyz> {
        let mut colours = vec![Xyz { x: 0.0, y: 0.0, z: 0.0 }; self.layout.states];
        for (light, rho) in self.lights.iter().zip(self.seen_of(rho)) {
            let sum = |rho: &[f64], bar: &[f64]| rho.iter().zip(bar).map(|(r, w)| r * w).sum::<f64>();
            let seen = |rho: &[f64]| {
                let [x, y, z] = light.xyz.each_ref().map(|bar| sum(rho, bar));
                Xyz { x, y, z }
            };
            let front = seen(&rho.front);
            for (colour, base) in colours.iter_mut().zip(rho.via_pixel.rows()) {
                *colour = *colour + seen(base) + front;
            }
        }
        colours
    }

    /// Computes the entry of a viewing cone from these colours and those of the view from the reference
    /// direction. With the display's white, L*, a* and b* of each direction are relative to the white state
    /// in that direction.
    pub(crate) fn cone_view(&self, colours: &[Xyz], reference: &[Xyz]) -> ConeView {
        // Of colours that are not resolved nothing is defined.
        let defined = |value: Option<f64>| value.filter(|value| value.is_finite());
        let (white, white_there) = (self.lab_white(colours), self.lab_white(reference));
        let state = |(xyz, there): (&Xyz, &Xyz)| {
            let (here, there) = (Colour::new(*xyz, white), Colour::new(*there, white_there));
            let [uv_shift, delta_e_2000] = here.differences(&there);
            let Colour { uv, lab } = here;
            ConeState {
                reflectance_factor_y: xyz.y,
                luminance_cd_m2: xyz.y * LUMENS_PER_WATT * self.white_xyz.y,
                u_prime: defined(uv.map(|uv| uv.u)),
                v_prime: defined(uv.map(|uv| uv.v)),
                uv_shift: defined(uv_shift),
                lab: lab.filter(|lab| lab.l.is_finite()),
                delta_e_2000: defined(delta_e_2000),
                delta_e_1976: defined(lab.zip(there.lab).map(|(lab, there)| lab.delta_e_1976(there))),
            }
        };
        let together = self.reference(&[]).together(colours);
        ConeView {
            contrast_ratio: defined(together.contrast_ratio),
            gamut_percent_srgb: defined(together.gamut_percent_srgb),
            gamut_percent_ebu: defined(together.gamut_percent_ebu),
            states: colours.iter().zip(reference).map(state).collect(),
        }
    }

    /// Returns the white of L*, a* and b* in the direction of these colours of all states.
    fn lab_white(&self, colours: &[Xyz]) -> Option<Xyz> {
        let perfect = over(self.white_xyz, self.white_xyz.y);
        if self.has_own_white() { Some(colours[self.state_named("white")?]) } else { Some(perfect) }
    }
}
