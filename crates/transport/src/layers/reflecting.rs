//! A diffuser with a reflection that is described by lobes, besides its transmission.
//!
//! **Model.** Light that arrives in a direction `beta_i` (of propagation) is reflected with the density
//! `R (1 - m) L(beta_o - beta_i)` over direction cosines, and `R m` of it keeps its direction: the mirror
//! image. R is the reflectance of the whole lobe, m its regular fraction. Light that the lobe sends beyond
//! the disc `|beta| < n` of the medium it came from is absorbed.
//!
//! **Lobes in a medium of index n.** The k-correlation lobe is the same function of `beta_o - beta_i` in
//! every medium. The Lambertian lobe has the same basic radiance in every direction of the medium:
//! `1/(pi n^2)` within its disc. Ward's lobe connects direction cosines over n, as the same slopes do; the
//! index must be constant.

use papilio_optics::lobe::Lobe;
use papilio_optics::scatter::Scatter;
use papilio_optics::{Beta, Scatterer};
use papilio_sampling::warp;
use papilio_spectra::Spectrum;
use std::f64::consts::PI;

use super::{Action, Narrowness, Preparation};
use super::{
    Arrival, Channel, Departure, Incidence, Interface, LayerKind, Medium, Scattered, ScatteringInterface,
};
use crate::estimate::Account;
use crate::front::Flat;
use crate::skeleton::{Part, Propagation};

/// Shape of a described reflection.
#[derive(Debug, Clone, PartialEq)]
pub enum ReflectedLobe {
    /// K-correlation or Lambertian.
    Lobe(Lobe),
    /// A reciprocal kernel on the disc of air, which is scaled to the disc of the medium: Ward's lobe.
    Kernel(Scatter),
}

/// Reflection of light from one side.
#[derive(Debug, Clone, PartialEq)]
pub struct LobeReflection {
    lobe: ReflectedLobe,
    /// R (1 - m), per wavelength.
    scattered: Spectrum,
    /// R m, per wavelength.
    mirrored: Spectrum,
    mirror: f64,
}

impl LobeReflection {
    /// Builds a reflection of this reflectance, 0 to 1, for the whole lobe including its regular part;
    /// `mirror` is the regular fraction of it.
    pub fn new(lobe: ReflectedLobe, reflectance: &Spectrum, mirror: f64) -> Self {
        Self {
            lobe,
            scattered: reflectance.map(|r| r * (1.0 - mirror)),
            mirrored: reflectance.map(|r| r * mirror),
            mirror,
        }
    }

    /// Returns the shape of the scattered part.
    pub fn lobe(&self) -> &ReflectedLobe {
        &self.lobe
    }

    /// Returns the scattered and the regular fraction of the whole lobe, 1 - m and m.
    pub fn shares(&self) -> [f64; 2] {
        [1.0 - self.mirror, self.mirror]
    }

    /// Returns the scattered fraction R (1 - m) of the whole lobe, per wavelength.
    pub fn scattered(&self) -> &Spectrum {
        &self.scattered
    }

    /// Returns the regular fraction R m of the light, per wavelength.
    pub fn mirrored(&self) -> &Spectrum {
        &self.mirrored
    }

    /// Returns the fraction of the scattered part that the whole lobe has, for light with this `|beta|` in a
    /// medium of index `n`.
    fn whole(&self, length: f64, n: f64) -> f64 {
        match &self.lobe {
            ReflectedLobe::Lobe(_) => 1.0,
            ReflectedLobe::Kernel(scatter) if length <= n => scatter.albedo_at(length / n),
            ReflectedLobe::Kernel(_) => 0.0,
        }
    }

    /// Returns the fraction of light with this `|beta|` that returns into the medium of index `n`.
    pub(crate) fn returned(&self, bin: usize, length: f64, n: f64) -> f64 {
        let within = match &self.lobe {
            ReflectedLobe::Lobe(lobe @ Lobe::KCorrelation { .. }) => lobe.fraction_in_disc(length, n),
            ReflectedLobe::Lobe(Lobe::Lambertian) => 1.0,
            ReflectedLobe::Kernel(_) => self.whole(length, n),
        };
        self.mirrored[bin] + self.scattered[bin] * within
    }

    fn narrowness(&self) -> Option<Narrowness> {
        match &self.lobe {
            ReflectedLobe::Lobe(Lobe::KCorrelation { width }) => Some(Narrowness::Lobe { width: *width }),
            ReflectedLobe::Lobe(Lobe::Lambertian) => None,
            ReflectedLobe::Kernel(scatter) => Some(Narrowness::Face { width: scatter.width() }),
        }
    }

    /// Returns the density of light that is scattered between two directions in air.
    pub(crate) fn density(&self, from: Beta, to: Beta) -> f64 {
        self.scatter(from, to, 1.0).value
    }

    /// Returns the densities of light scattered between two directions of a medium of index `n`.
    fn scatter(&self, from: Beta, to: Beta, n: f64) -> Scattered {
        match &self.lobe {
            ReflectedLobe::Lobe(lobe @ Lobe::KCorrelation { .. }) => {
                Scattered::exactly(lobe.evaluate(from, to))
            }
            ReflectedLobe::Lobe(Lobe::Lambertian) => {
                let inside = from.squared() <= n * n && to.squared() <= n * n;
                Scattered::exactly(if inside { 1.0 / (PI * n * n) } else { 0.0 })
            }
            ReflectedLobe::Kernel(scatter) => {
                let total = self.whole(from.length(), n).max(f64::MIN_POSITIVE);
                let (from, to) = (over(from, n), over(to, n));
                Scattered {
                    value: scatter.evaluate(from, to) / (n * n * total),
                    density: scatter.density(from, to) / (n * n),
                    reverse: scatter.density(to, from) / (n * n),
                }
            }
        }
    }

    fn sample(&self, from: Beta, u: [f64; 4], n: f64) -> Option<Beta> {
        match &self.lobe {
            ReflectedLobe::Lobe(lobe @ Lobe::KCorrelation { .. }) => {
                Some(Scatterer::sample(lobe, from, u)?.direction)
            }
            ReflectedLobe::Lobe(Lobe::Lambertian) => {
                let (x, y) = warp::uniform_disc(n, [u[0], u[1]]);
                (from.squared() <= n * n).then_some(Beta { x, y })
            }
            ReflectedLobe::Kernel(scatter) => {
                let to = scatter.sample(over(from, n), u)?.direction;
                Some(Beta { x: to.x * n, y: to.y * n })
            }
        }
    }
}

/// Returns direction cosines of a medium of index `n` as those of a medium of index 1.
fn over(beta: Beta, n: f64) -> Beta {
    Beta { x: beta.x / n, y: beta.y / n }
}

/// A diffuser that reflects light from above and from below by described lobes, and transmits light as
/// another diffuser, which does not reflect.
#[derive(Debug, Clone, PartialEq)]
pub struct ReflectingDiffuser {
    /// The transmission.
    through: Interface,
    /// Transmitted and scattered fraction of a [`Diffuser`](super::Diffuser), per wavelength.
    scattered: Option<Spectrum>,
    /// Of light from above and from below.
    sides: [Option<LobeReflection>; 2],
}

impl ReflectingDiffuser {
    /// Builds a diffuser with this transmission, an [`Interface::Diffuser`] or [`Interface::Scatter`] without
    /// reflection of its own, and with these reflections of light from above and from below.
    pub fn new(through: Interface, sides: [Option<LobeReflection>; 2]) -> Self {
        let scattered = match &through {
            Interface::Diffuser(diffuser) => {
                Some(diffuser.transmittance.map(|t| t * (1.0 - diffuser.regular_fraction)))
            }
            _ => None,
        };
        Self { through, scattered, sides }
    }

    /// Returns the interface that describes its transmission.
    pub fn transmission(&self) -> &Interface {
        &self.through
    }

    /// Returns its reflections of light from above and from below.
    pub fn reflections(&self) -> &[Option<LobeReflection>; 2] {
        &self.sides
    }

    /// Returns the largest fraction of light that it transmits and reflects between media of these indices,
    /// over all wavelengths and incidences, with the incidence: its `|beta|`, and whether the light comes
    /// from below. Light that a lobe sends beyond the disc of a medium does not count: it is absorbed.
    pub fn largest_total(&self, above: &Spectrum, below: &Spectrum) -> (f64, f64, bool) {
        const STEPS: usize = 90;
        let mut largest = (0.0, 0.0, false);
        for bin in 0..above.len() {
            let indices = [above[bin], below[bin]];
            for (side, index) in indices.into_iter().enumerate() {
                for step in 0..STEPS {
                    // Uniform in angle, to 89 deg: at the horizon itself, formulas such as that of Ward
                    // (1992) diverge.
                    let beta = index * (0.5 * PI * step as f64 / STEPS as f64).sin();
                    let total = self.total(bin, indices, side, beta);
                    if total > largest.0 {
                        largest = (total, beta, side == 1);
                    }
                }
            }
        }
        largest
    }

    /// Returns the fraction of light from above (0) or below (1) that it transmits and reflects.
    fn total(&self, bin: usize, indices: [f64; 2], side: usize, beta: f64) -> f64 {
        let at = Incidence { bin, indices, beta, beta_squared: beta * beta };
        let scattered = match &self.through {
            Interface::Diffuser(diffuser) => {
                let whole = self.scattered.as_ref().map_or(0.0, |scattered| scattered[bin]);
                whole * diffuser.lobe.fraction_in_disc(beta, indices[1 - side])
            }
            other => other.kind().scattered(&at)[side],
        };
        let reflected = self.sides[side].as_ref().map_or(0.0, |one| one.returned(bin, beta, indices[side]));
        self.through.kind().regular(&at).t + scattered + reflected
    }

    fn side(&self, going: Propagation) -> Option<&LobeReflection> {
        self.sides[going as usize].as_ref()
    }

    fn inner(&self) -> Option<&dyn ScatteringInterface> {
        self.through.kind().scattering_interface()
    }
}

impl LayerKind for ReflectingDiffuser {
    fn passes_regularly(&self) -> bool {
        self.through.kind().passes_regularly()
    }

    fn regular(&self, at: &Incidence) -> Flat {
        let mirror = |side: usize| match &self.sides[side] {
            Some(one) if at.beta <= at.indices[side] => one.mirrored[at.bin],
            _ => 0.0,
        };
        Flat { t: self.through.kind().regular(at).t, above: mirror(0), below: mirror(1) }
    }

    fn horizons(&self, indices: [f64; 2]) -> Vec<f64> {
        let mut all = self.through.kind().horizons(indices);
        for (side, index) in self.sides.iter().zip(indices) {
            let of = side.as_ref().map(|one| &one.lobe);
            if matches!(of, Some(ReflectedLobe::Kernel(scatter)) if scatter.growth_at_horizon().is_some()) {
                all.push(index);
            }
        }
        all
    }

    fn scattered(&self, at: &Incidence) -> [f64; 2] {
        let through = self.through.kind().scattered(at);
        std::array::from_fn(|side| {
            let back = self.sides[side].as_ref();
            let index = at.indices[side];
            through[side] + back.map_or(0.0, |one| one.scattered[at.bin] * one.whole(at.beta, index))
        })
    }

    /// The integral of a kernel is computed once for all wavelengths.
    fn parts(&self, media: [&Medium; 2], beta_squared: f64, out: &mut [Part]) {
        self.through.kind().parts(media, beta_squared, out);
        let length = beta_squared.sqrt();
        for (side, one) in self.sides.iter().enumerate() {
            let Some(one) = one else { continue };
            let whole = one.whole(length, media[side].largest_index());
            for (bin, part) in out.iter_mut().enumerate() {
                part.scattered[side] += one.scattered[bin] * whole;
                part.flat = self.regular(&Incidence::between(media, bin, beta_squared));
            }
        }
    }

    fn account(&self) -> Account {
        Account::Diffuser
    }

    fn known_within(&self) -> Option<f64> {
        self.through.kind().known_within()
    }

    fn narrowness(&self) -> Option<Narrowness> {
        let sides = self.sides.iter().flatten().filter_map(LobeReflection::narrowness);
        let all = self.through.kind().narrowness().into_iter().chain(sides);
        all.reduce(|a, b| if b.smoothness() < a.smoothness() { b } else { a })
    }

    fn edges(&self, bin: usize) -> Vec<f64> {
        self.through.kind().edges(bin)
    }

    fn spectral_key(&self, bin: usize, key: &mut Vec<u64>) {
        self.through.kind().spectral_key(bin, key);
        let spectra = self.sides.iter().flatten().flat_map(|one| [&one.scattered, &one.mirrored]);
        key.extend(spectra.map(|spectrum| spectrum[bin].to_bits()));
    }

    fn action<'a>(&'a self, prepare: &mut dyn Preparation<'a>) -> Option<Action> {
        let mut kernels = match self.through.kind().action(prepare) {
            Some(Action::Kernels(kernels)) => kernels,
            _ => Default::default(),
        };
        for (side, one) in self.sides.iter().enumerate() {
            let Some(one) = one else { continue };
            let number = match &one.lobe {
                ReflectedLobe::Lobe(lobe) => prepare.reflected_lobe(*lobe, side),
                ReflectedLobe::Kernel(scatter) => prepare.kernel(scatter, prepare.index(side)),
            };
            kernels[1 + side] = vec![(number, one.scattered[prepare.bin()])];
        }
        Some(Action::Kernels(kernels))
    }

    fn scattering_interface(&self) -> Option<&dyn ScatteringInterface> {
        Some(self)
    }
}

impl ScatteringInterface for ReflectingDiffuser {
    fn channels(&self, going: Propagation) -> Vec<Channel> {
        let mut channels = self.inner().map_or_else(Vec::new, |inner| inner.channels(going));
        channels.extend(self.side(going).map(|_| Channel::Back));
        channels
    }

    fn fraction(
        &self,
        channel: Channel,
        going: Propagation,
        length: f64,
        disc: f64,
    ) -> Option<(f64, &Spectrum)> {
        match (channel, &self.scattered) {
            (Channel::Back, _) => self.side(going).map(|one| (one.whole(length, disc), &one.scattered)),
            (_, Some(scattered)) => Some((1.0, scattered)),
            (_, None) => self.inner()?.fraction(channel, going, length, disc),
        }
    }

    fn scatter(&self, from: Arrival, to: Departure) -> Scattered {
        if from.channel != Channel::Back {
            return self.inner().map_or(Scattered::exactly(0.0), |inner| inner.scatter(from, to));
        }
        let back = self.side(from.going);
        back.map_or(Scattered::exactly(0.0), |one| one.scatter(from.beta, to.beta, from.disc))
    }

    fn sample(&self, from: Arrival, u: [f64; 4]) -> Option<(Departure, Scattered)> {
        if from.channel != Channel::Back {
            return self.inner()?.sample(from, u);
        }
        let one = self.side(from.going)?;
        let beta = one.sample(from.beta, u, from.disc)?;
        let scattered = one.scatter(from.beta, beta, from.disc);
        (scattered.density > 0.0).then_some((Departure { beta, going: from.going.reversed() }, scattered))
    }

    /// A Lambertian lobe is sampled over the disc of the largest index.
    fn spread(&self, channel: Channel, going: Propagation, [largest, index]: [f64; 2]) -> f64 {
        match self.side(going) {
            Some(LobeReflection { lobe: ReflectedLobe::Lobe(Lobe::Lambertian), .. })
                if channel == Channel::Back =>
            {
                (largest / index).powi(2)
            }
            _ => 1.0,
        }
    }

    fn scatters_beyond_media(&self) -> bool {
        true
    }
}
