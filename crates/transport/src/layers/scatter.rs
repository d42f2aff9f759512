//! An interface given by its BSDF, and the kernels that it consists of.

use papilio_optics::Scatterer;
use papilio_optics::scatter::{Rings, Scatter};
use papilio_spectra::Spectrum;

use super::{Action, Narrowness, Preparation};
use super::{Arrival, Channel, Departure, Incidence, LayerKind, Medium, Scattered, ScatteringInterface};
use crate::estimate::Account;
use crate::front::Flat;
use crate::skeleton::{Part, Propagation};

/// A scattering kernel and its factor at each wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterKernel {
    /// The kernel.
    pub scatter: Scatter,
    /// Its factor, per wavelength.
    pub factor: Spectrum,
}

/// An interface given by its BSDF, which includes the surfaces of the sample. Light of the disc of air
/// `|beta| <= 1` is scattered into the disc of air, keeps its direction, or is absorbed. Transmitted light
/// may extend beyond the disc of air below the interface; light from there is transmitted back.
///
/// It is reciprocal: light that goes up is transmitted by the reverse of the kernel for light that goes
/// down, and a reflection is the mean of its kernel and the reverse.
///
/// The face of a surface ([`Self::of_surface`]) has kernels over the whole discs of the media on both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterFace {
    straight: Spectrum,
    /// `[down, up]`.
    transmission: Option<[ScatterKernel; 2]>,
    reflection: [Option<ScatterKernel>; 2],
    /// Radius of the disc of its kernels, if that is not the disc of air: the kernel of a pixel.
    disc: Option<Spectrum>,
    /// Light that leaves as from a flat face, if it depends on direction: the kernel of a surface.
    regular: Option<RegularRings>,
}

/// Light that leaves a surface as from a flat face, by rings of directions above and below.
#[derive(Debug, Clone, PartialEq)]
pub struct RegularRings {
    /// Rings above and below.
    pub rings: [Rings; 2],
    /// Reflectance of each ring, from above and from below.
    pub reflected: [Vec<f64>; 2],
    /// Transmittance of each ring of the side with fewer directions, the same both ways.
    pub transmitted: Vec<f64>,
}

impl RegularRings {
    fn at(&self, Incidence { indices, beta, .. }: &Incidence) -> Flat {
        let [above, below] = &self.rings;
        let rarer = usize::from(above.radius() > below.radius());
        let within = |side: usize| *beta <= indices[side].min(self.rings[side].radius());
        let of = |side: usize, values: &[f64]| {
            if within(side) { self.rings[side].at(values, *beta) } else { 0.0 }
        };
        Flat {
            t: if within(1 - rarer) { of(rarer, &self.transmitted) } else { 0.0 },
            above: of(0, &self.reflected[0]),
            below: of(1, &self.reflected[1]),
        }
    }
}

impl ScatterFace {
    /// An interface that transmits this fraction of light, per wavelength, without changing its direction,
    /// and absorbs the rest.
    pub fn new(straight: Spectrum) -> Self {
        Self { straight, transmission: None, reflection: [None, None], disc: None, regular: None }
    }

    /// The face of a surface between two media: kernels of light from above that is transmitted, of light
    /// that is reflected above and below, and its regular light. All are the same at all `bins` wavelengths.
    pub fn of_surface(
        through: Scatter,
        reflection: [Scatter; 2],
        regular: RegularRings,
        bins: usize,
    ) -> Self {
        let ones = Spectrum::from_values(vec![1.0; bins]);
        let kernel = |scatter: Scatter| ScatterKernel { scatter, factor: ones.clone() };
        let [above, below] = reflection.map(kernel);
        let face = Self::new(ones.map(|_| 0.0))
            .with_transmission(kernel(through))
            .with_reflection_above(above)
            .with_reflection_below(below);
        Self { regular: Some(regular), ..face }
    }

    /// Adds scattered transmission of light from above.
    pub fn with_transmission(mut self, ScatterKernel { scatter, factor }: ScatterKernel) -> Self {
        let up = ScatterKernel { scatter: scatter.reversed(), factor: factor.clone() };
        self.transmission = Some([ScatterKernel { scatter, factor }, up]);
        self
    }

    /// Adds scattered reflection of light from above.
    pub fn with_reflection_above(mut self, kernel: ScatterKernel) -> Self {
        self.reflection[0] = Some(kernel.reciprocal());
        self
    }

    /// Adds scattered reflection of light from below.
    pub fn with_reflection_below(mut self, kernel: ScatterKernel) -> Self {
        self.reflection[1] = Some(kernel.reciprocal());
        self
    }

    /// A pixel under a medium of this index: it absorbs what it does not reflect.
    pub(crate) fn pixel(kernel: ScatterKernel, index: &Spectrum) -> Self {
        let face = Self::new(index.map(|_| 0.0)).with_reflection_above(kernel);
        Self { disc: Some(index.clone()), ..face }
    }

    /// Radius of its disc, if it is a pixel.
    pub(crate) fn disc(&self, bin: usize) -> Option<f64> {
        self.disc.as_ref().map(|disc| disc[bin])
    }

    /// Returns true if it reflects light.
    pub fn reflects(&self) -> bool {
        self.reflection.iter().any(Option::is_some)
    }

    /// Regular transmittance, per wavelength.
    pub fn straight(&self) -> &Spectrum {
        &self.straight
    }

    /// Returns the kernel of scattered transmission of light from above, if there is one.
    pub fn transmission(&self) -> Option<&ScatterKernel> {
        self.transmission.as_ref().map(|[down, _]| down)
    }

    /// Kernel of transmission, of light going down or up.
    pub(crate) fn through(&self, going: Propagation) -> Option<&ScatterKernel> {
        self.transmission.as_ref().map(|ways| &ways[going as usize])
    }

    /// Kernel of reflection, of light going down or up.
    pub(crate) fn back(&self, going: Propagation) -> Option<&ScatterKernel> {
        self.reflection[going as usize].as_ref()
    }

    /// Smallest width of its kernels.
    pub(crate) fn width(&self) -> f64 {
        let disc = self.disc.as_ref().map_or(1.0, Spectrum::min);
        disc * self.kernels().map(|kernel| kernel.scatter.width()).fold(f64::INFINITY, f64::min)
    }

    /// `|beta|` at which its kernels jump, other than the rim of the disc of air. A kernel that ends at the
    /// normal itself, as a table of that incidence alone, leaves no interval before its end.
    fn kernel_edges(&self, bin: usize) -> impl Iterator<Item = f64> {
        let disc = self.disc(bin).unwrap_or(1.0);
        let edges = self.kernels().flat_map(|kernel| kernel.scatter.edges());
        edges.filter(|edge| *edge > 0.0).map(move |edge| edge * disc)
    }

    /// All kernels, for light from above.
    pub(crate) fn kernels(&self) -> impl Iterator<Item = &ScatterKernel> {
        self.through(Propagation::Down).into_iter().chain(self.reflection.iter().flatten())
    }
}

impl ScatterKernel {
    pub(crate) fn reciprocal(self) -> Self {
        Self { scatter: self.scatter.reciprocal(), ..self }
    }

    /// Albedo for light with this `|beta|`, before the factor; 0 beyond the disc.
    pub(crate) fn total(&self, beta_length: f64) -> f64 {
        if beta_length <= self.scatter.discs()[0] { self.scatter.albedo_at(beta_length) } else { 0.0 }
    }
}

/// The smallest `|beta|` within its disc at which one of these kernels ends.
pub(crate) fn least_edge<'a>(kernels: impl IntoIterator<Item = &'a ScatterKernel>) -> Option<f64> {
    let edges = kernels.into_iter().flat_map(|kernel| kernel.scatter.edges());
    edges.filter(|edge| *edge < 1.0).reduce(f64::min)
}

impl ScatterFace {
    /// Kernel of a channel, for light that propagates in this sense, and the kernel of the reverse path.
    fn channel(&self, channel: Channel, going: Propagation) -> Option<[&ScatterKernel; 2]> {
        match channel {
            Channel::Through => Some([self.through(going)?, self.through(going.reversed())?]),
            // Reflections are reciprocal.
            Channel::Back => self.back(going).map(|kernel| [kernel, kernel]),
            Channel::Both => None,
        }
    }
}

impl LayerKind for ScatterFace {
    fn passes_regularly(&self) -> bool {
        let regular = self.regular.iter().flat_map(|regular| &regular.transmitted);
        self.straight().max() > 0.0 || regular.into_iter().any(|t| *t > 0.0)
    }

    fn regular(&self, at: &Incidence) -> Flat {
        if let Some(regular) = &self.regular {
            return regular.at(at);
        }
        let straight = if at.beta_squared <= 1.0 { self.straight[at.bin] } else { 0.0 };
        Flat { t: straight, above: 0.0, below: 0.0 }
    }

    fn scattered(&self, at: &Incidence) -> [f64; 2] {
        [Propagation::Down, Propagation::Up].map(|going| {
            let kernels = [self.through(going), self.back(going)].into_iter().flatten();
            kernels.map(|kernel| kernel.total(at.beta) * kernel.factor[at.bin]).sum()
        })
    }

    /// Albedos are computed once for all wavelengths.
    fn parts(&self, media: [&Medium; 2], beta_squared: f64, out: &mut [Part]) {
        let ways = [Propagation::Down, Propagation::Up].map(|going| {
            [self.through(going), self.back(going)]
                .map(|kernel| kernel.map(|kernel| (kernel.total(beta_squared.sqrt()), &kernel.factor)))
        });
        for (bin, part) in out.iter_mut().enumerate() {
            let share =
                |way: &Option<(f64, &Spectrum)>| way.map_or(0.0, |(total, factor)| total * factor[bin]);
            part.flat = self.regular(&Incidence::between(media, bin, beta_squared));
            part.scattered = ways.each_ref().map(|way| way.iter().map(share).sum());
        }
    }

    fn account(&self) -> Account {
        if self.disc.is_some() { Account::Pixel } else { Account::Diffuser }
    }

    fn known_within(&self) -> Option<f64> {
        least_edge([self.through(Propagation::Down), self.back(Propagation::Down)].into_iter().flatten())
    }

    fn narrowness(&self) -> Option<Narrowness> {
        Some(Narrowness::Face { width: self.width() })
    }

    fn edges(&self, bin: usize) -> Vec<f64> {
        self.kernel_edges(bin).collect()
    }

    fn horizons(&self, _: [f64; 2]) -> Vec<f64> {
        let disc = self.disc.as_ref().map_or(1.0, Spectrum::max);
        let unbounded = self.kernels().filter(|kernel| kernel.scatter.growth_at_horizon().is_some());
        unbounded.map(|_| disc).collect()
    }

    fn kinks(&self) -> Vec<f64> {
        self.regular.iter().flat_map(|regular| &regular.rings).flat_map(Rings::middles).collect()
    }

    fn spectral_key(&self, bin: usize, key: &mut Vec<u64>) {
        key.push(self.straight[bin].to_bits());
        key.extend(self.kernels().map(|kernel| kernel.factor[bin].to_bits()));
    }

    fn action<'a>(&'a self, prepare: &mut dyn Preparation<'a>) -> Option<Action> {
        let disc = self.disc(prepare.bin()).unwrap_or(1.0);
        let ways =
            [self.through(Propagation::Down), self.back(Propagation::Down), self.back(Propagation::Up)];
        let mut number = |ScatterKernel { scatter, factor }: &'a ScatterKernel| {
            (prepare.kernel(scatter, disc), factor[prepare.bin()])
        };
        Some(Action::Kernels(ways.map(|kernel| kernel.map(&mut number).into_iter().collect())))
    }

    fn scattering_interface(&self) -> Option<&dyn ScatteringInterface> {
        Some(self)
    }
}

impl ScatteringInterface for ScatterFace {
    fn channels(&self, going: Propagation) -> Vec<Channel> {
        let both = [Channel::Through, Channel::Back];
        both.into_iter().filter(|channel| self.channel(*channel, going).is_some()).collect()
    }

    fn fraction(
        &self,
        channel: Channel,
        going: Propagation,
        length: f64,
        _: f64,
    ) -> Option<(f64, &Spectrum)> {
        let [kernel, _] = self.channel(channel, going)?;
        Some((kernel.total(length), &kernel.factor))
    }

    fn scatter(&self, from: Arrival, to: Departure) -> Scattered {
        let Some([kernel, reverse]) = self.channel(from.channel, from.going) else {
            return Scattered::exactly(0.0);
        };
        let total = kernel.total(from.beta.length()).max(f64::MIN_POSITIVE);
        Scattered {
            value: kernel.scatter.evaluate(from.beta, to.beta) / total,
            density: kernel.scatter.density(from.beta, to.beta),
            reverse: reverse.scatter.density(to.beta, from.beta),
        }
    }

    fn sample(&self, from: Arrival, u: [f64; 4]) -> Option<(Departure, Scattered)> {
        let [kernel, reverse] = self.channel(from.channel, from.going)?;
        let sample = kernel.scatter.sample(from.beta, u)?;
        let total = kernel.total(from.beta.length()).max(f64::MIN_POSITIVE);
        let to = Departure { beta: sample.direction, going: from.channel.leaves(from.going)[0] };
        let reverse = reverse.scatter.density(to.beta, from.beta);
        Some((to, Scattered { value: sample.value / total, density: sample.density, reverse }))
    }
}
