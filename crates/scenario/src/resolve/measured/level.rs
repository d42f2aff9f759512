//! Level and spectral shape of a measurement.

use papilio_diagnostics::Diagnostic;
use papilio_goniometry::{MeasuredPart, WavelengthLevels};
use papilio_spectra::Spectrum;

use super::file::Source;
use crate::describe::diffuser::{Measured, Normalise, SpectralMean};
use crate::mistake;
use crate::read::Spanned;
use crate::resolve::Resolver;

/// Difference of the lobes of the wavelengths of a file, relative to the peak, that gives a warning.
const OTHER_SHAPE: f64 = 0.02;

impl Resolver<'_> {
    /// Returns the spectral shape that a foil's keys state, and the level of its transmission.
    pub(super) fn level(
        &mut self,
        diffuser: &Spanned<Measured>,
        mean: SpectralMean,
    ) -> Option<(Option<Spectrum>, Option<f64>)> {
        let shape = match &diffuser.transmission.value {
            Some(share) => Some(self.colour(share, diffuser.transmission.origin)?),
            None => None,
        };
        // 1 is no spectrum.
        if shape.as_ref().is_some_and(|shape| shape.is_constant() && shape.max() < 1.0) {
            let wrong = "`transmission` gives the spectral shape, but it is the same at all wavelengths";
            let wrong = Diagnostic::new(wrong).expected("a file of a spectrum").hint(
                "`total_transmittance` sets the level of the values (normalise = \"tis\": the TIS of the file); the two can be combined",
            );
            self.err(&diffuser.transmission, wrong);
            return None;
        }
        let key = &diffuser.total_transmittance;
        if shape.is_none() && key.is_none() && diffuser.spectral_mean.value == SpectralMean::Luminous {
            let why = "it is for the spectrum of `transmission` or `total_transmittance`";
            self.without_effect(diffuser.spectral_mean.origin, "spectral_mean", why);
        }
        let Some(share) = &key.value else { return Some((shape, None)) };
        if diffuser.normalise.value == Normalise::Tis {
            self.err(key, mistake::not_with("total_transmittance", "normalise = \"tis\""));
            return None;
        }
        let total = self.colour(share, key.origin)?;
        if total.is_constant() {
            return Some((shape, Some(total.max())));
        }
        if shape.is_some() {
            self.err(key, mistake::not_with("a spectrum of `total_transmittance`", "`transmission`"));
            return None;
        }
        let level = self.mean(&total, mean, key.origin)?;
        Some((Some(total), Some(level)))
    }

    /// Returns the level of each wavelength of the grid relative to the luminous channel of a part, whose
    /// lobe is used, and notes it.
    pub(super) fn levels(&mut self, source: &Source<'_>, part: &MeasuredPart) -> Spectrum {
        let ones = Spectrum::constant(&self.grid, 1.0);
        let (path, way) = (source.path, part.way.name());
        let Some(channel) = part.channels.get(part.luminous()).filter(|_| part.channels.len() > 1) else {
            return ones;
        };
        let Some(levels) = WavelengthLevels::of(part) else {
            self.notes.push(format!(
                "{path}: {way}: the file has {} channels: {channel} is used at all wavelengths{}",
                part.channels.len(),
                if part.way.is_transmission() { "; `transmission` gives a spectral shape" } else { "" }
            ));
            return ones;
        };
        let waves = &levels.wavelengths_nm;
        let [first, last] = [waves[0], waves[waves.len() - 1]];
        let beyond = match self.grid.start_nm() < first || self.grid.stop_nm() > last {
            true => format!("; below {first} and above {last} nm it is that of the nearest one"),
            false => String::new(),
        };
        self.notes.push(format!(
            "{path}: {way}: the lobe of {channel} nm is used at all wavelengths, with the level of each of the {} wavelengths of the \
             file at its smallest incidence, interpolated between them{beyond}",
            waves.len()
        ));
        if levels.shape_difference > OTHER_SHAPE {
            self.warnings.push(format!(
                "{path}: {way}: the lobes of other wavelengths differ from that of {channel} nm by up to {:.1} % of its peak, besides \
                 their level: displays have one lobe for all wavelengths",
                100.0 * levels.shape_difference
            ));
        }
        let values = self.grid.wavelengths_nm().into_iter().map(|nm| levels.at(nm)).collect();
        Spectrum::from_values(values)
    }
}
