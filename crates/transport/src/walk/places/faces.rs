//! Scattering at interfaces: one channel of one side.

use papilio_optics::Beta;

use crate::layers::{Arrival, Channel, Colours, Departure, Scattered};
use crate::skeleton::Propagation;
use crate::walk::horizon::{Horizons, SampledInterface};
use crate::{Medium, Stack};

/// Light that arrives at an interface in this sense and is scattered on a channel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face<'a> {
    interface: SampledInterface<'a>,
    channel: Channel,
    going: Propagation,
    /// Media above (air, if there is none) and below.
    media: [Option<&'a Medium>; 2],
}

impl<'a> Face<'a> {
    /// The channels of each interface of a stack, for light that goes down and up.
    pub(super) fn of(stack: &'a Stack, horizons: Option<Horizons>) -> Vec<[Vec<Self>; 2]> {
        let interfaces = stack.elements().step_by(2);
        let of_interface = |(kind, media): (&'a dyn crate::layers::LayerKind, [Option<&'a Medium>; 2])| {
            [Propagation::Down, Propagation::Up].map(|going| {
                let Some(interface) = kind.scattering_interface() else { return Vec::new() };
                let channels = interface.channels(going).into_iter();
                let interface = SampledInterface::new(interface, horizons);
                channels.map(|channel| Self { interface, channel, going, media }).collect()
            })
        };
        interfaces.map(of_interface).collect()
    }

    /// Senses in which light leaves.
    pub(super) fn leaves(&self) -> &'static [Propagation] {
        self.channel.leaves(self.going)
    }

    /// True if all light passes to the other side.
    pub(super) fn passes(&self) -> bool {
        self.channel == Channel::Through
    }

    /// Fraction of light of this `|beta|` that takes the channel at a wavelength; `all` is the scattered
    /// fraction of the interface.
    pub(super) fn fraction(&self, length: f64, out: &mut [f64], all: impl Fn(usize) -> f64) {
        match self.interface.fraction(self.channel, self.going, length, self.disc()) {
            Some((total, factor)) => {
                out.iter_mut().enumerate().for_each(|(bin, out)| *out = total * factor[bin]);
            }
            None => out.iter_mut().enumerate().for_each(|(bin, out)| *out = all(bin)),
        }
    }

    /// Density of scattering from one direction to another.
    pub(super) fn scatter(&self, from: Beta, to: Departure) -> Scattered {
        self.interface.scatter(self.arrival(from), to)
    }

    /// A sampled direction; `None` if the light is absorbed.
    pub(super) fn sample(&self, from: Beta, u: [f64; 4]) -> Option<(Departure, Scattered)> {
        self.interface.sample(self.arrival(from), u)
    }

    /// Density at a wavelength over that of [`scatter`](Self::scatter), in a direction that the medium has.
    pub(super) fn spread(&self, going: Propagation, bin: usize) -> f64 {
        let largest = self.medium(going).map_or(1.0, Medium::largest_index);
        self.interface.spread(self.channel, self.going, [largest, self.index(going, bin)])
    }

    /// Density at each wavelength over that of [`scatter`](Self::scatter); `None` if they are the same.
    pub(super) fn colours(&self, from: Beta, to: Beta) -> Colours {
        self.interface.colours(self.arrival(from), to)
    }

    /// Factor on sampled light at a wavelength: 0 if the medium that the light is scattered into has no such
    /// direction.
    pub(super) fn carried(&self, to: Departure, bin: usize) -> f64 {
        if !self.interface.scatters_beyond_media() {
            return 1.0;
        }
        let carried = to.beta.squared() < self.index(to.going, bin).powi(2);
        if carried { self.spread(to.going, bin) } else { 0.0 }
    }

    fn index(&self, going: Propagation, bin: usize) -> f64 {
        self.medium(going).map_or(1.0, |medium| medium.index()[bin])
    }

    /// The medium into which light leaves.
    fn medium(&self, going: Propagation) -> Option<&'a Medium> {
        if going == Propagation::Up { self.media[0] } else { self.media[1] }
    }

    /// Largest index of the medium that the light comes from.
    fn disc(&self) -> f64 {
        self.media[self.going as usize].map_or(1.0, Medium::largest_index)
    }

    fn arrival(&self, beta: Beta) -> Arrival {
        Arrival { beta, going: self.going, channel: self.channel, disc: self.disc() }
    }
}
