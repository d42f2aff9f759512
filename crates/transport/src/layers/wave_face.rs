//! A face with small heights, by waves: light that keeps its direction, and lobes whose widths depend on the
//! wavelength.
//!
//! **Model.** The face transmits and reflects what a flat one does (Fresnel, unpolarised). Of each of the
//! three kinds of light (transmitted, reflected above, reflected below) a fraction of its own for each
//! wavelength keeps its direction, and the rest is scattered by a mixture of [balanced lobes](BalancedLobe):
//! the same lobes at all wavelengths, in proportions that depend on the wavelength. No light is lost, and
//! both ways are the same.
//!
//! **Limits.** The fractions are those along the normal. Transmission is scattered among the directions that
//! both media have: light beyond the limit of total reflection leaves only after the face has reflected it
//! within the limit.

use papilio_optics::Beta;
use papilio_optics::lobe::BalancedLobe;
use papilio_spectra::Spectrum;

use super::{Action, Narrowness, Preparation};
use super::{Arrival, Channel, Colours, Departure, Incidence, LayerKind, Scattered, ScatteringInterface};
use crate::estimate::Account;
use crate::front::Flat;
use crate::skeleton::Propagation;

/// Light of one kind: transmitted, or reflected on one side.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveLight {
    /// Lobes of the scattered part.
    lobes: Vec<BalancedLobe>,
    /// Fraction of each lobe, per wavelength.
    fractions: Vec<Spectrum>,
    /// Fraction that keeps its direction, per wavelength.
    regular: Spectrum,
    /// The rest, per wavelength.
    scattered: Spectrum,
    /// Probabilities of the lobes with which directions are sampled.
    chances: Vec<f64>,
}

impl WaveLight {
    /// Light with these lobes, each with its fraction per wavelength; what they leave keeps its direction.
    /// All lobes scatter the same light.
    pub fn new(lobes: Vec<(BalancedLobe, Spectrum)>, bins: usize) -> Self {
        let (lobes, fractions): (Vec<_>, Vec<Spectrum>) = lobes.into_iter().unzip();
        let scattered: Vec<f64> = (0..bins).map(|bin| fractions.iter().map(|one| one[bin]).sum()).collect();
        let means: Vec<f64> = fractions.iter().map(|one| (0..bins).map(|bin| one[bin]).sum()).collect();
        let all: f64 = means.iter().sum();
        let chances = means.iter().map(|mean| if all > 0.0 { mean / all } else { 0.0 }).collect();
        let scattered = Spectrum::from_values(scattered);
        Self { lobes, fractions, regular: scattered.map(|scattered| 1.0 - scattered), scattered, chances }
    }

    /// Fraction of the light of a `|beta|` that is of this kind.
    fn of_face(&self, length: f64) -> f64 {
        self.lobes.first().map_or(0.0, |lobe| lobe.light().at(length))
    }

    fn narrowest(&self) -> Option<f64> {
        self.lobes.iter().map(|lobe| lobe.lobe().width()).reduce(f64::min)
    }

    /// Density of each lobe from one direction to another.
    fn densities(&self, from: Beta, to: Beta) -> impl Iterator<Item = f64> {
        self.lobes.iter().map(move |lobe| lobe.evaluate(from, to))
    }

    /// Density with which a direction is sampled: of each lobe, within the distance to the far end of the
    /// disc.
    fn chance(&self, from: Beta, to: Beta) -> f64 {
        let squared = (to - from).squared();
        let lobes = self.lobes.iter().zip(&self.chances);
        let one = |(lobe, chance): (&BalancedLobe, &f64)| {
            chance * lobe.lobe().at_squared_distance(squared) / within(lobe, from)
        };
        lobes.map(one).sum()
    }

    fn scatter(&self, from: Beta, to: Beta) -> Scattered {
        let whole = self.of_face(from.length());
        let value: f64 = self.densities(from, to).zip(&self.chances).map(|(one, chance)| one * chance).sum();
        let value = if whole > 0.0 { value / whole } else { 0.0 };
        Scattered { value, density: self.chance(from, to), reverse: self.chance(to, from) }
    }

    /// Density at each wavelength over that of [`scatter`](Self::scatter).
    fn colours(&self, from: Beta, to: Beta) -> Vec<f64> {
        let densities: Vec<f64> = self.densities(from, to).collect();
        let mean: f64 = densities.iter().zip(&self.chances).map(|(one, chance)| one * chance).sum();
        let mut colours = vec![0.0; self.scattered.len()];
        if mean > 0.0 {
            for (density, fraction) in densities.iter().zip(&self.fractions) {
                colours
                    .iter_mut()
                    .enumerate()
                    .for_each(|(bin, colour)| *colour += density / mean * fraction[bin]);
            }
            for (bin, colour) in colours.iter_mut().enumerate() {
                *colour = if self.scattered[bin] > 0.0 { *colour / self.scattered[bin] } else { 0.0 };
            }
        }
        colours
    }

    fn sample(&self, from: Beta, [u, v, choice, _]: [f64; 4]) -> Option<Beta> {
        let mut rest = choice;
        let chosen = self.chances.iter().position(|chance| {
            rest -= chance;
            rest < 0.0
        });
        let lobe = self.lobes.get(chosen.unwrap_or(self.lobes.len().saturating_sub(1)))?;
        let to = lobe.lobe().direction_at(from, u * within(lobe, from), v);
        (to.length() < lobe.light().radius()).then_some(to)
    }
}

/// Fraction of a lobe within the distance to the far end of its disc: wider lobes would mostly miss it.
fn within(lobe: &BalancedLobe, from: Beta) -> f64 {
    lobe.lobe().fraction_within(from.length() + lobe.light().radius())
}

/// A face by waves.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveFace {
    /// Transmitted light, light reflected above, and light reflected below.
    lights: [WaveLight; 3],
}

/// Numbers of the lights.
const THROUGH: usize = 0;
const BACK: [usize; 2] = [1, 2];

impl WaveFace {
    /// A face of this transmitted light, this light reflected above, and this light reflected below.
    pub fn new(lights: [WaveLight; 3]) -> Self {
        Self { lights }
    }

    fn of(&self, channel: Channel, going: Propagation) -> &WaveLight {
        &self.lights[if channel == Channel::Through { THROUGH } else { BACK[going as usize] }]
    }
}

impl LayerKind for WaveFace {
    fn regular(&self, at: &Incidence) -> Flat {
        let [through, above, below] = &self.lights;
        let of = |light: &WaveLight| light.regular[at.bin] * light.of_face(at.beta);
        Flat { t: of(through), above: of(above), below: of(below) }
    }

    fn scattered(&self, at: &Incidence) -> [f64; 2] {
        BACK.map(|back| {
            let of = |light: &WaveLight| light.scattered[at.bin] * light.of_face(at.beta);
            of(&self.lights[THROUGH]) + of(&self.lights[back])
        })
    }

    fn account(&self) -> Account {
        Account::Diffuser
    }

    fn narrowness(&self) -> Option<Narrowness> {
        let width = self.lights.iter().filter_map(WaveLight::narrowest).reduce(f64::min)?;
        Some(Narrowness::Lobe { width })
    }

    fn spectral_key(&self, bin: usize, key: &mut Vec<u64>) {
        key.extend(self.lights.iter().flat_map(|light| &light.fractions).map(|one| one[bin].to_bits()));
    }

    fn action<'a>(&'a self, prepare: &mut dyn Preparation<'a>) -> Option<Action> {
        let bin = prepare.bin();
        let mut of = |light: &'a WaveLight| {
            let lobes = light.lobes.iter().zip(&light.fractions).filter(|(_, one)| one[bin] > 0.0);
            lobes.map(|(lobe, one)| (prepare.balanced_lobe(lobe), one[bin])).collect()
        };
        Some(Action::Kernels(self.lights.each_ref().map(&mut of)))
    }

    fn scattering_interface(&self) -> Option<&dyn ScatteringInterface> {
        Some(self)
    }
}

impl ScatteringInterface for WaveFace {
    fn channels(&self, going: Propagation) -> Vec<Channel> {
        let both = [Channel::Through, Channel::Back].into_iter();
        both.filter(|channel| !self.of(*channel, going).lobes.is_empty()).collect()
    }

    fn fraction(
        &self,
        channel: Channel,
        going: Propagation,
        length: f64,
        _: f64,
    ) -> Option<(f64, &Spectrum)> {
        let light = self.of(channel, going);
        Some((light.of_face(length), &light.scattered))
    }

    fn scatter(&self, from: Arrival, to: Departure) -> Scattered {
        self.of(from.channel, from.going).scatter(from.beta, to.beta)
    }

    fn sample(&self, from: Arrival, u: [f64; 4]) -> Option<(Departure, Scattered)> {
        let light = self.of(from.channel, from.going);
        let beta = light.sample(from.beta, u)?;
        let to = Departure { beta, going: from.channel.leaves(from.going)[0] };
        Some((to, light.scatter(from.beta, beta)))
    }

    fn colours(&self, from: Arrival, to: Beta) -> Colours {
        Colours::new(self.of(from.channel, from.going).colours(from.beta, to))
    }
}
