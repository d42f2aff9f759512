//! The phase between s and p in flat layers above a mirror.
//!
//! Light that vibrates between s and p is reflected by the product of both amplitudes, `r_p r_s*`, as s is by `|r_s|^2` and p by `|r_p|^2`. Between the
//! layers and the mirror the orders add up as powers do, since thick layers do not interfere: each product obeys the same formulas as a
//! reflectance, with complex numbers ([`Crossed`]).

use num_complex::Complex64;
use papilio_optics::Beta;
use papilio_spectra::StateSpectra;

use crate::layers::{Crossed, Incidence, LayerKind};
use crate::{Base, FlatRun, Medium, ReflectanceFactor};

/// What flat layers and a mirror do to the product of both amplitudes.
#[derive(Debug, Clone)]
pub struct Phases {
    run: FlatRun,
    /// Above the layers, and between them and the mirror.
    media: [Medium; 2],
    /// Real and imaginary part of the mirror's product, as its reflectance.
    mirror: [Base; 2],
}

impl Phases {
    /// Returns those of these layers in air, with the medium below them, and of a mirror, whose real and imaginary parts have the form of
    /// reflectances.
    pub fn new(run: FlatRun, below: Medium, mirror: [Base; 2]) -> Self {
        let air = Medium::new(vec![1.0; below.index().len()].into());
        Self { run, media: [air, below], mirror }
    }

    /// The mirror.
    pub(crate) fn mirror(&self) -> &[Base; 2] {
        &self.mirror
    }

    /// Replaces the mirror by one with as many states.
    pub(crate) fn set_mirror(&mut self, mirror: [Base; 2]) {
        self.mirror = mirror;
    }

    /// The real part of the product for the whole display, as [`specular_image`](crate::specular_image) for s or p.
    pub(crate) fn image(&self, beta: Beta) -> ReflectanceFactor {
        let [above, below] = &self.media;
        let (bins, squared) = (self.mirror[0].bins(), beta.squared());
        let of_mirror = |part: &Base| {
            let mut values = vec![0.0; part.states() * bins];
            part.reflectance_towards(beta, below, &mut values);
            values
        };
        let [re, im] = self.mirror.each_ref().map(of_mirror);
        let top = |bin: usize| {
            let passes = below.regular(&Incidence::between([below; 2], bin, squared));
            let run = self.run.crossed(&Incidence::between([above, below], bin, squared));
            run.over(Crossed::of_both(passes, 1.0))
        };
        let tops: Vec<Crossed> = (0..bins).map(top).collect();
        let via = |(k, (re, im)): (usize, (&f64, &f64))| {
            let (top, above) = (tops[k % bins], Complex64::new(*re, *im));
            let mirror = Crossed { t: Complex64::ZERO, above, below: Complex64::ZERO };
            (top.over(mirror).above - top.above).re
        };
        let via_pixel: Vec<f64> = re.iter().zip(&im).enumerate().map(via).collect();
        let front = tops.iter().map(|top| top.above.re).collect();
        ReflectanceFactor { via_pixel: StateSpectra::new(via_pixel, bins), front }
    }
}
