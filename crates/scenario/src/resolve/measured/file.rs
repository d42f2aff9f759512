//! Files of measured scattering, and the kernels of a display from them.

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::ScatterKernel;
use papilio_formats::{BsdfFile, LARGEST_BSDF_FILE, read_bsdf_file};
use papilio_goniometry::{
    self as goniometry, Backing, Fill, GoniometryError, Preparation, ScatterMode, kernel,
};
use papilio_optics::scatter::Scatter;
use papilio_spectra::{Spectrum, illuminant};

use crate::describe::diffuser::{Extrapolate, Normalise, SpectralMean};
use crate::describe::display::ShareSpectrum;
use crate::describe::measure::Channels;
use crate::describe::numbers::Blur;
use crate::origin::Origin;
use crate::read::Spanned;
use crate::resolve::Resolver;

/// A file of measured scattering in a scenario, and the keys for its preparation.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    /// Key for notes and warnings.
    pub(super) path: &'a str,
    pub(super) name: &'a str,
    pub(super) file: Origin,
    /// The part that the values of the file are, if the scenario states it.
    pub(super) part: Option<ScatterMode>,
    pub(super) normalise: &'a Spanned<Normalise>,
    pub(super) extrapolate_tails: bool,
    /// `None` if the scenario does not specify it.
    pub(super) extrapolate: &'a Spanned<Option<Extrapolate>>,
    pub(super) spectral_mean: SpectralMean,
    pub(super) blur: Option<&'a Spanned<Blur>>,
    /// Total at the smallest incidence to which the values are scaled.
    pub(super) level: Option<f64>,
}

impl Resolver<'_> {
    /// Resolves a spectrum that gives the spectral shape of a measurement.
    pub(super) fn colour(&mut self, share: &ShareSpectrum, origin: Origin) -> Option<Spectrum> {
        let spectrum = self.share(share, origin)?;
        if spectrum.max() <= 0.0 {
            let wrong = Diagnostic::new("this spectrum is 0 at all wavelengths, and gives no spectral shape");
            self.errors.push(
                origin,
                wrong.hint("only the shape of this spectrum is used: it must be above 0 at some wavelength"),
            );
            return None;
        }
        Some(spectrum)
    }

    /// Returns the part of a file for this direction of the light.
    pub(super) fn way<'a>(
        &mut self,
        source: &Source<'_>,
        file: &'a BsdfFile,
        way: ScatterMode,
    ) -> Option<&'a goniometry::MeasuredPart> {
        let parts = &file.measurement.parts;
        let part = parts.iter().find(|part| part.way == way);
        if part.is_none() {
            let found = parts.iter().map(|part| part.way.name()).collect::<Vec<_>>().join(", ");
            let hint = if way == ScatterMode::FrontTransmission
                && found.contains(ScatterMode::BackTransmission.name())
            {
                Some("`flipped = true` takes the light from the other side of the sample")
            } else if way == ScatterMode::BackTransmission
                && found.contains(ScatterMode::FrontTransmission.name())
            {
                Some("without `flipped` the light comes from the front of the sample")
            } else if way.is_transmission() && !file.states_part {
                Some(
                    "the file does not state whether its values are a reflection or a transmission: if they are a BTDF, add \
                     part = \"front-transmission\" to this table",
                )
            } else {
                None
            };
            let wrong = Diagnostic::new(format!("this file has no {}", way.name()))
                .expected(format!("it among the parts of the file: {found}"))
                .hint_if(hint);
            self.errors.push(source.file, wrong);
        }
        let is_lit = |part: &&goniometry::MeasuredPart| part.values.iter().any(|value| *value > 0.0);
        if part.is_some() && part.filter(is_lit).is_none() {
            let wrong =
                Diagnostic::new(format!("all values of the {} of this file are 0: it is black", way.name()))
                    .expected("values in 1/sr, some of them above 0")
                    .hint("was the lamp off, or were the values rounded when they were written?");
            self.errors.push(source.file, wrong);
            return None;
        }
        part
    }

    /// Reads a file of measured scattering.
    pub(super) fn measurement(&mut self, source: &Source<'_>) -> Option<BsdfFile> {
        let kept = self.open_within(source.name, source.file, LARGEST_BSDF_FILE)?;
        match read_bsdf_file(kept.file(), source.part) {
            Ok(mut read) => {
                let name = source.name;
                if let Some(way) = source.part {
                    self.select(source, &mut read, way)?;
                }
                self.warnings.extend(read.warnings.iter().map(|warning| format!("{name}: {warning}")));
                self.notes.extend(read.notes.iter().map(|note| format!("{name}: {note}")));
                Some(read)
            }
            Err(error) => {
                self.errors.push_data(source.file, error);
                None
            }
        }
    }

    /// Selects the transmission that the scenario names: the other one of the file is not used.
    fn select(&mut self, source: &Source<'_>, file: &mut BsdfFile, way: ScatterMode) -> Option<()> {
        let parts = &mut file.measurement.parts;
        if parts.iter().all(|part| part.way != way) {
            let found = parts.iter().map(|part| part.way.name()).collect::<Vec<_>>().join(", ");
            let wrong = Diagnostic::new(format!("this file has no {}, which `part` names", way.name()))
                .expected(format!("one of its parts: {found}"));
            self.errors.push(source.file, wrong);
            return None;
        }
        parts.retain(|part| part.way == way || !part.way.is_transmission());
        Some(())
    }

    /// Returns the kernel of a part with the spectral shape of a spectrum, and reports all changes.
    pub(super) fn scattered(
        &mut self,
        source: &Source<'_>,
        part: &goniometry::MeasuredPart,
        spectrum: Option<Spectrum>,
        backing: Backing,
    ) -> Option<ScatterKernel> {
        let level = match &spectrum {
            Some(spectrum) => self.mean(spectrum, source.spectral_mean, source.file)?,
            None => 1.0,
        };
        let factor = match spectrum {
            Some(spectrum) => spectrum,
            None => self.levels(source, part),
        };
        let scatter = self.kernel(source, part, [level, factor.max() / level], backing)?;
        Some(ScatterKernel { scatter, factor })
    }

    /// Returns the mean of a spectrum that corresponds to the level of a file.
    pub(super) fn mean(&mut self, spectrum: &Spectrum, mean: SpectralMean, at: Origin) -> Option<f64> {
        match mean {
            SpectralMean::Uniform => Some(spectrum.iter().sum::<f64>() / spectrum.len() as f64),
            SpectralMean::Luminous => self.luminous_mean(spectrum, at),
        }
    }

    /// Returns the mean of a spectrum weighted with D65 and V(lambda).
    fn luminous_mean(&mut self, spectrum: &Spectrum, at: Origin) -> Option<f64> {
        let d65 = illuminant("D65", &self.grid);
        let d65 = self.sampled("D65", at, d65)?;
        self.factors(spectrum, &d65, Channels::Monochrome)?.first().copied()
    }

    /// Returns the kernel of a part, and reports all changes; `level` is the mean of the spectrum that
    /// multiplies it, `largest` the maximum of the spectrum over this mean.
    fn kernel(
        &mut self,
        source: &Source<'_>,
        part: &goniometry::MeasuredPart,
        [level, largest]: [f64; 2],
        backing: Backing,
    ) -> Option<Scatter> {
        let preparation = Preparation {
            fill: if source.extrapolate_tails { Fill::Tail } else { Fill::None },
            to_tis: source.normalise.value == Normalise::Tis,
            level: source.level,
            extrapolate: reach(source.extrapolate.value.unwrap_or(Extrapolate::Hold), backing),
            lamination: backing.lamination(),
        };
        let sharp = self.without_blur(source, part)?;
        let part = sharp.as_ref().unwrap_or(part);
        match kernel(part, part.luminous(), &preparation, &[level]) {
            Ok((scatter, changes)) => {
                self.report(source, part.way, &changes, largest)?;
                Some(scatter)
            }
            Err(error) => {
                match error {
                    GoniometryError::NoTis => {
                        let wrong = Diagnostic::new(error.to_string()).hint("use normalise = \"none\"");
                        self.errors.push(source.normalise.origin, wrong);
                    }
                    GoniometryError::TisInPercent => {
                        let largest = part.tis.iter().copied().fold(0.0, f64::max);
                        let wrong = Diagnostic::new(error.to_string())
                            .expected(format!("fractions from 0 to 1, but the largest is {largest}"))
                            .hint(
                                "divide the lines `TIS` of the file by 100; normalise = \"none\" does not use them, and \
                                 total_transmittance sets the level of a transmission",
                            );
                        self.errors.push(source.normalise.origin, wrong);
                    }
                    _ => self.errors.push(source.file, error),
                }
                None
            }
        }
    }
}

/// Largest `|beta|` of extrapolated lobes; `None` without extrapolation.
fn reach(extrapolate: Extrapolate, backing: Backing) -> Option<f64> {
    match extrapolate {
        Extrapolate::None => None,
        Extrapolate::Hold => Some(1.0),
        Extrapolate::Glass => Some(backing.reach()),
    }
}
