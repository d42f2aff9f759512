//! Flat layers between the last scatterer and a mirror: s and p are kept apart through all of them, back and forth
//! between the mirror and each face, and the light that rises to the scatterer counts as unpolarised.
//!
//! A mirror that changes polarisation, such as a liquid crystal, has a matrix for both together and their phase ([`Mueller`]).
//!
//! Both solvers follow mean light through the layers, as through any [`FlatRun`], to a mirror of the reflectance with
//! which the sum of all orders is that of s and p: with the means T, R' (from below) of the layers, and V, the mean over
//! s and p of all light via the mirror, `V = T^2 r/(1 - R' r)`. What is seen, and all that is absorbed below the
//! scatterer, is exact; the absorbed light is divided among layers, pixel and inactive area as that of the mean.

use std::sync::Arc;

use papilio_optics::Beta;

use crate::front::Flat;
use crate::layers::{FlatRun, Incidence, LayerKind};
use crate::mueller::{Above, returned_via};
use crate::{Base, Interface, Layer, Medium, Mueller};

/// Flat layers and the mirror below them.
#[derive(Debug, Clone)]
pub(crate) struct MirrorRun {
    run: FlatRun,
    /// Above the run, and between it and the mirror.
    media: [Medium; 2],
    pub(crate) mirror: Mirror,
}

/// A mirror for polarised light.
#[derive(Debug, Clone)]
pub(crate) enum Mirror {
    /// For s and for p.
    OfEach(Box<[Base; 2]>),
    /// It changes polarisation.
    Changing(Arc<Mueller>),
}

impl MirrorRun {
    /// Returns the last of these layers with its mirror; `None` if it is no run below others.
    pub(crate) fn new(layers: &[Layer], mirror: Mirror) -> Option<Self> {
        let [.., above, Layer { interface: Interface::Run(run), medium, .. }] = layers else { return None };
        debug_assert!(medium.scattering().is_none());
        Some(Self { run: (**run).clone(), media: [above.medium.clone(), medium.clone()], mirror })
    }

    /// Computes the reflectance of the mirror for mean light, `[state][wavelength]`.
    pub(crate) fn reflectance(&self, beta: Beta, out: &mut [f64]) {
        let ([above, below], beta_squared) = (&self.media, beta.squared());
        let mirrors = match &self.mirror {
            Mirror::OfEach(mirrors) => mirrors,
            Mirror::Changing(pixel) => return self.reflectance_of_changing(pixel, beta, out),
        };
        let of_each = mirrors.each_ref().map(|mirror| {
            let mut reflectance = vec![0.0; out.len()];
            mirror.reflectance_towards(beta, below, &mut reflectance);
            reflectance
        });
        let bins = mirrors[0].bins();
        let flats = |bin| self.run.of_each(&Incidence::between([above, below], bin, beta_squared));
        let is_constant = |medium: &Medium| medium.constant_index().is_some();
        let always = (self.run.is_colourless() && self.media.iter().all(is_constant)).then(|| flats(0));
        for bin in 0..bins {
            let both = always.unwrap_or_else(|| flats(bin));
            let mean = Flat::mean(both);
            let passes = below.regular(&Incidence::between([below; 2], bin, beta_squared)).t.powi(2);
            for place in (bin..out.len()).step_by(bins) {
                let via = |(flat, mirror): (Flat, &Vec<f64>)| {
                    let open = 1.0 - flat.below * passes * mirror[place];
                    if open > 0.0 { flat.t * flat.t * passes * mirror[place] / open } else { 0.0 }
                };
                let via: f64 = 0.5 * both.into_iter().zip(&of_each).map(via).sum::<f64>();
                let open = passes * (mean.t * mean.t + mean.below * via);
                out[place] = if open > 0.0 { via / open } else { 0.0 };
            }
        }
    }

    fn reflectance_of_changing(&self, pixel: &Mueller, beta: Beta, out: &mut [f64]) {
        let [above, below] = &self.media;
        let squared = beta.squared();
        let at = |bin| Above::of_run(&self.run, above.index()[bin], below, squared, bin);
        let over: Vec<Above> = (0..below.index().len()).map(at).collect();
        for (k, via) in returned_via(pixel, (beta, below), &over).into_iter().enumerate() {
            let bin = k % over.len();
            let Flat { t, below: back, .. } =
                self.run.regular(&Incidence::between([above, below], bin, squared));
            let passes = below.regular(&Incidence::between([below; 2], bin, squared)).t.powi(2);
            let open = passes * (t * t + back * via);
            out[k] = if open > 0.0 { via / open } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use papilio_optics::film::Polarisation;

    use super::*;
    use crate::{AngularTable, Nodes, Reflector};

    /// An air gap between glass and a mirror in glass, at 41 deg in the glass: the whole sum of each polarisation.
    #[test]
    fn sum_of_all_orders_is_the_mean_of_both() {
        let mirror = |r: f64| {
            let (basis, common) = (vec![r].into(), vec![0.0]);
            let table = AngularTable { nodes: Nodes::Constant, basis, mixture: vec![1.0], common };
            Base { reflector: Reflector::Specular(table), inactive_absorptance: vec![0.0].into() }
        };
        let medium = |index: f64| Medium::new(vec![index].into());
        let glass = medium(1.5).with_transmittance(vec![0.9].into());
        let both = [Polarisation::S, Polarisation::P].map(|one| vec![Interface::FresnelOf(one); 2]);
        let run = FlatRun::new(both, vec![medium(1.0)]);
        let interface = Interface::Run(Box::new(run.clone()));
        let layers = [Layer::new(Interface::Open, medium(1.5)), Layer::new(interface, glass.clone())];
        let of = MirrorRun::new(&layers, Mirror::OfEach(Box::new([mirror(0.3), mirror(0.7)]))).unwrap();
        let beta = 1.5 * 41.0_f64.to_radians().sin();
        let mut r = [0.0];
        of.reflectance(Beta { x: beta, y: 0.0 }, &mut r);
        // Fresnel from the angles of incidence and refraction, summed by hand.
        let (i, t) = (41.0_f64.to_radians(), beta.asin());
        let faces = [((i - t).sin() / (i + t).sin()).powi(2), ((i - t).tan() / (i + t).tan()).powi(2)];
        let passes = 0.9_f64.powf(2.0 / 41.0_f64.to_radians().cos());
        let whole = |face: f64, mirror: f64| {
            let (t, back) = ((1.0 - face) / (1.0 + face), 2.0 * face / (1.0 + face));
            (back, t * t * passes * mirror / (1.0 - back * passes * mirror))
        };
        let [s, p] = [whole(faces[0], 0.3), whole(faces[1], 0.7)];
        let (back, t) = (0.5 * (s.0 + p.0), 1.0 - 0.5 * (s.0 + p.0));
        let found = t * t * passes * r[0] / (1.0 - back * passes * r[0]);
        assert!((found - 0.5 * (s.1 + p.1)).abs() < 1e-12, "{found} {s:?} {p:?}");
        // Beyond the critical angle nothing reaches the mirror.
        of.reflectance(Beta { x: 1.005, y: 0.0 }, &mut r);
        assert_eq!(r, [0.0]);
    }
}
