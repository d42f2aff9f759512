//! `model = "measured"`: a diffuser or a pixel measured with a goniometer or an imaging sphere.

mod blur;
mod file;
mod level;
mod report;

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{Length, Medium, Ready, ScatterFace, ScatterKernel, ScatteringPixel};
use papilio_goniometry::{Backing, ScatterMode};
use papilio_spectra::Spectrum;
use serde_json::json;

use self::file::Source;
use super::Resolver;
use super::diffuser::scattering;
use super::layers::Part;
use crate::describe::diffuser::{Extrapolate, Measured, Mounting, SpectralMean, TransmissionPart};
use crate::describe::display::ShareSpectrum;
use crate::describe::pixel::MeasuredPixel;
use crate::mistake;
use crate::origin::Origin;
use crate::read::Spanned;

/// A transmission or reflection of a foil.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// Transmission of light from above.
    Through,
    /// Reflection of light from above.
    Above,
    /// Reflection of light from below.
    Below,
}

impl Resolver<'_> {
    /// Resolves a foil: its interface, and what is between it and the medium of this index below it. `None`:
    /// the next layer below is no medium.
    pub(super) fn foil(
        &mut self,
        path: &str,
        diffuser: &Spanned<Measured>,
        below: Option<&Spectrum>,
    ) -> Option<Vec<Part>> {
        let backing = match (diffuser.mounting.value, below) {
            (Mounting::AsMeasured, None) | (Mounting::Air, Some(_)) => Backing::Air,
            (Mounting::AsMeasured, Some(medium)) => Backing::Glass { index: medium.min() },
            (Mounting::Laminated, Some(medium)) => {
                Backing::Laminated { index: medium.iter().sum::<f64>() / medium.len() as f64 }
            }
            (Mounting::Laminated | Mounting::Air, None) => {
                let wrong = Diagnostic::new("no medium follows this foil, on which it could be mounted")
                    .hint("add a { kind = \"medium\", index = 1.5 } below it, or remove `mounting`");
                self.err(&diffuser.mounting, wrong);
                return None;
            }
        };
        if !matches!(backing, Backing::Glass { .. }) {
            let beside = if below.is_some() { "this mounting" } else { "a foil without a medium below it" };
            self.refuse_glass_tails(&diffuser.extrapolate, beside)?;
        }
        let interface = self.foil_interface(path, diffuser, backing)?;
        let interface = self.with_reflection(path, scattering(interface), &diffuser.reflection)?;
        let gap = self.gap_below(path, diffuser)?;
        let mut parts = vec![Part::Interface(interface)];
        let below = match diffuser.mounting.value {
            Mounting::AsMeasured => return Some(parts),
            // Light beyond the disc of air stays in the glass.
            Mounting::Laminated => Ready::IdealAr,
            Mounting::Air => Ready::Fresnel,
        };
        let air = Medium::clear(Spectrum::constant(&self.grid, 1.0));
        parts.extend([Part::Medium(air, gap, Origin::FILE), Part::Interface(below.into())]);
        Some(parts)
    }

    /// Returns the air between a foil and the glass: none unless it is mounted so.
    fn gap_below(&mut self, path: &str, diffuser: &Spanned<Measured>) -> Option<Length> {
        match (diffuser.mounting.value, diffuser.gap_mm.value) {
            (Mounting::Air, Some(gap)) => Some(Length::Mm(gap.0)),
            (Mounting::Air, None) => Some(Length::Missing { key: format!("{path}.gap_mm") }),
            (_, None) => Some(Length::Mm(0.0)),
            (_, Some(_)) => {
                let wrong =
                    "`gap_mm` is the air between the foil and the glass, but the foil is on the glass";
                let wrong = Diagnostic::new(wrong).hint("add mounting = \"air\", or remove `gap_mm`");
                self.errors.push(diffuser.gap_mm.origin.or_override([diffuser.mounting.origin]), wrong);
                None
            }
        }
    }

    /// Refuses tails in the glass if the foil is not known to be on glass.
    fn refuse_glass_tails(
        &mut self,
        extrapolate: &Spanned<Option<Extrapolate>>,
        beside: &'static str,
    ) -> Option<()> {
        if extrapolate.value == Some(Extrapolate::Glass) {
            let wrong = mistake::not_with("extrapolate = \"glass\"", beside);
            let hint = "\"hold\" keeps the last lobe within the horizon of the air";
            self.err(extrapolate, wrong.hint(hint));
            return None;
        }
        Some(())
    }

    fn foil_interface(
        &mut self,
        path: &str,
        diffuser: &Spanned<Measured>,
        backing: Backing,
    ) -> Option<ScatterFace> {
        let mut interface = ScatterFace::new(Spectrum::constant(&self.grid, 0.0));
        let sides = self.foil_sides(path, diffuser, backing)?;
        if diffuser.reflection.is_some() && sides.iter().any(|(side, _)| *side != Side::Through) {
            let wrong = "the file contains the reflection of the foil";
            let wrong = Diagnostic::new(wrong).hint("remove `reflection`: that of the file is used");
            self.err(&diffuser.reflection, wrong);
            return None;
        }
        for (side, kernel) in sides {
            interface = match side {
                Side::Through => interface.with_transmission(kernel),
                Side::Above => interface.with_reflection_above(kernel),
                Side::Below => interface.with_reflection_below(kernel),
            };
        }
        Some(interface)
    }

    /// Resolves a foil in air, with either side up: its transmission and reflection of light from above, and
    /// its reflection of light from below.
    pub(super) fn foil_in_air(
        &mut self,
        path: &str,
        diffuser: &Spanned<Measured>,
    ) -> Option<Vec<(ScatterMode, ScatterKernel)>> {
        let way = |side: Side| match side {
            Side::Through => ScatterMode::FrontTransmission,
            Side::Above => ScatterMode::FrontReflection,
            Side::Below => ScatterMode::BackReflection,
        };
        let foil = self.foil_sides(path, diffuser, Backing::Air)?;
        Some(foil.into_iter().map(|(side, kernel)| (way(side), kernel)).collect())
    }

    fn foil_sides(
        &mut self,
        path: &str,
        diffuser: &Spanned<Measured>,
        backing: Backing,
    ) -> Option<Vec<(Side, ScatterKernel)>> {
        let key = || format!("foil {path} {} {backing:?}", json!(diffuser));
        self.cached(key, |this| this.foil_sides_uncached(path, diffuser, backing))
    }

    fn foil_sides_uncached(
        &mut self,
        path: &str,
        diffuser: &Spanned<Measured>,
        backing: Backing,
    ) -> Option<Vec<(Side, ScatterKernel)>> {
        let source = Source {
            path,
            name: &diffuser.file.value,
            file: diffuser.file.origin,
            part: diffuser.part.value.map(|part| match part {
                TransmissionPart::FrontTransmission => ScatterMode::FrontTransmission,
                TransmissionPart::BackTransmission => ScatterMode::BackTransmission,
            }),
            normalise: &diffuser.normalise,
            extrapolate_tails: diffuser.extrapolate_tails.value,
            extrapolate: &diffuser.extrapolate,
            spectral_mean: diffuser.spectral_mean.value,
            blur: Some(&diffuser.instrument_blur),
            level: None,
        };
        let file = self.measurement(&source)?;
        let (into, back, front) = if diffuser.flipped.value {
            (ScatterMode::BackTransmission, ScatterMode::FrontReflection, ScatterMode::BackReflection)
        } else {
            (ScatterMode::FrontTransmission, ScatterMode::BackReflection, ScatterMode::FrontReflection)
        };
        let through = self.way(&source, &file, into)?;
        let part = |way: ScatterMode| file.measurement.parts.iter().find(|part| part.way == way);
        let (spectrum, level) = self.level(diffuser, source.spectral_mean)?;
        let with_level = Source { level, ..source };
        let mut foil = vec![(Side::Through, self.scattered(&with_level, through, spectrum, backing)?)];
        if let Some(part) = part(front) {
            foil.push((Side::Above, self.scattered(&source, part, None, Backing::Air)?));
        }
        // A laminated foil has no back surface in air, and without it little back reflection.
        if let Some(part) = part(back).filter(|_| backing.lamination().is_none()) {
            foil.push((Side::Below, self.scattered(&source, part, None, Backing::Air)?));
        }
        Some(foil)
    }

    /// Resolves a measured pixel: the BRDF of its states, with angles in air used as angles in the medium
    /// above.
    pub(super) fn measured_pixel(&mut self, pixel: &MeasuredPixel) -> Option<ScatteringPixel> {
        self.cached(|| format!("pixel {}", json!(pixel)), |this| this.measured_pixel_uncached(pixel))
    }

    fn measured_pixel_uncached(&mut self, pixel: &MeasuredPixel) -> Option<ScatteringPixel> {
        self.refuse_glass_tails(&pixel.extrapolate, "a pixel")?;
        let states = &pixel.file.0;
        self.limit(&pixel.file, "states", states.len(), 256)?;
        if states.is_empty() {
            let remedy = "name a state with its file: file = { white = \"white.bsdf\" }";
            self.err(&pixel.file, mistake::no_states(remedy));
        }
        for item in pixel.spectrum.0.iter().filter(|item| pixel.file.get(&item.name).is_none()) {
            self.errors.push(item.name_origin, mistake::no_such_state(&item.name, &pixel.file.names()));
        }
        let mut kernels = Vec::with_capacity(states.len());
        for state in states {
            let source = Source {
                path: &format!("display.pixel.file.{}", state.name),
                name: &state.value.value,
                file: state.value.origin,
                part: None,
                normalise: &pixel.normalise,
                extrapolate_tails: pixel.extrapolate_tails.value,
                extrapolate: &pixel.extrapolate,
                spectral_mean: SpectralMean::Uniform,
                blur: None,
                level: None,
            };
            kernels.push((state.name.clone(), self.measured_state(&source, pixel.spectrum.get(&state.name))));
        }
        let kernels = kernels.into_iter().map(|(name, kernel)| Some((name, kernel?)));
        Some(ScatteringPixel { states: kernels.collect::<Option<_>>()? })
    }

    fn measured_state(
        &mut self,
        source: &Source<'_>,
        spectrum: Option<&Spanned<ShareSpectrum>>,
    ) -> Option<ScatterKernel> {
        let file = self.measurement(source)?;
        let reflection = self.way(source, &file, ScatterMode::FrontReflection)?;
        let spectrum = match spectrum {
            Some(share) => Some(self.colour(share, share.origin)?),
            None => None,
        };
        self.scattered(source, reflection, spectrum, Backing::Air)
    }
}
