//! Flights in a scattering medium.

use papilio_optics::Beta;
use papilio_optics::phase::HenyeyGreenstein;
use papilio_sampling::warp;

use super::Plain;
use super::path::{Path, Run};
use crate::Scattering;
use crate::layers::Departure;
use crate::skeleton::Propagation::{Down, Up};

impl Plain<'_> {
    /// A scattering medium: exponential flights and deflections until light leaves. Depth is optical depth,
    /// with absorption.
    pub(super) fn cross_slab(&self, element: usize, slab: &Scattering, path: &mut Path, run: &mut Run<'_>) {
        let medium = &self.stack.layers[element / 2].medium;
        let (n, phase) = (medium.index()[self.bin], HenyeyGreenstein { anisotropy: slab.anisotropy });
        let thickness = slab.optical_thickness - medium.transmittance().map_or(0.0, |t| t[self.bin].ln());
        let vector = |Departure { beta, going }: Departure| {
            let (x, y) = (beta.x / n, beta.y / n);
            let z = (1.0 - x * x - y * y).max(f64::MIN_POSITIVE).sqrt();
            [x, y, if going == Down { z } else { -z }]
        };
        let mut depth = if path.going == Down { 0.0 } else { thickness };
        while path.survives(run) {
            let (now, [u, v, w, _]) = (Departure { beta: path.beta, going: path.going }, run.random());
            let before = vector(now);
            depth -= u.ln() * before[2];
            if depth <= 0.0 || depth >= thickness {
                return path.depart(element, now);
            }
            path.weight *= slab.albedo[self.bin] * slab.optical_thickness / thickness;
            let density = |to: Departure| {
                let (after, rest) = (vector(to), if to.going == Down { thickness - depth } else { depth });
                let cosine = before.iter().zip(after).map(|(a, b)| a * b).sum();
                phase.at_cosine(cosine) * (-rest / after[2].abs()).exp() / (n * n * after[2].abs())
            };
            let [x, y, z] = warp::deflected(before, 1.0 - phase.sample_cosine(v), w);
            let to = Departure { beta: Beta { x: n * x, y: n * y }, going: if z > 0.0 { Down } else { Up } };
            self.scatter((element, &[Up, Down]), path, run, density, Some((to, 1.0)));
        }
    }
}
