//! `model = "measured"`: a diffuser or a pixel as a goniometer or an imaging sphere saw it.

mod told;

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{Medium, Ready, ScatterFace, ScatterKernel, ScatteringPixel};
use papilio_formats::{LARGEST_BSDF_FILE, read_bsdf};
use papilio_goniometry::{
    self as goniometry, Fill, GoniometryError, Lamination, Measurement, Preparation, Unblur, Unblurred, Way,
    deblurred, kernel,
};
use papilio_optics::scatter::Scatter;
use papilio_spectra::{Spectrum, illuminant};
use serde_json::json;

use super::Resolver;
use super::diffuser::scattering;
use super::layers::Part;
use crate::describe::diffuser::{Extrapolate, Measured, Mounting, Normalise, SpectralMean};
use crate::describe::display::ShareSpectrum;
use crate::describe::measure::Channels;
use crate::describe::numbers::Blur;
use crate::describe::pixel::MeasuredPixel;
use crate::mistake;
use crate::origin::Origin;
use crate::read::At;

/// A lobe that, blurred again, differs more than this from the file's is not what the instrument saw.
const MISFIT: f64 = 0.03;
/// And beyond this it is nothing like it.
const FAR_MISFIT: f64 = 0.3;

/// A file of measured scattering in a scenario, and what is to be done to it.
struct Source<'a> {
    /// The key that remarks are about.
    path: &'a str,
    name: &'a str,
    file: Origin,
    normalise: &'a At<Normalise>,
    extrapolate_tails: bool,
    /// `None`: not written.
    extrapolate: &'a At<Option<Extrapolate>>,
    spectral_mean: SpectralMean,
    blur: Option<&'a At<Blur>>,
}

/// What a film does with light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// From above, through it.
    Through,
    /// From above, back.
    Above,
    /// From below, back.
    Below,
}

/// What is behind a film, and how: glass of an index, or air.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Behind {
    Air,
    /// The table as it stands: it holds the film's back face.
    Glass(f64),
    /// The film touches it.
    Laminated(f64),
}

/// Why a blur cannot be taken out of a measurement.
fn unblurred(error: &GoniometryError) -> Diagnostic {
    let of_width = matches!(error, GoniometryError::Blur { .. });
    let hint = "the width is that of the image of a straight beam, measured without a sample";
    Diagnostic::new(error.to_string()).hint_if(of_width.then_some(hint))
}

impl Behind {
    fn lamination(self) -> Option<Lamination> {
        match self {
            Self::Laminated(index) => Some(Lamination { index }),
            Self::Air | Self::Glass(_) => None,
        }
    }

    /// How far in `|beta|` lobes go on, if they do.
    fn reach(self, extrapolate: Extrapolate) -> Option<f64> {
        match (extrapolate, self) {
            (Extrapolate::None, _) => None,
            (Extrapolate::Glass, Self::Glass(index)) => Some(index),
            (Extrapolate::Glass | Extrapolate::Hold, _) => Some(1.0),
        }
    }
}

impl Resolver<'_> {
    /// A film over glass of this index: from the air down, without the glass.
    pub(super) fn measured_over(
        &mut self,
        path: &str,
        diffuser: &At<Measured>,
        glass: &Spectrum,
    ) -> Option<Vec<Part>> {
        let behind = match diffuser.mounting.value {
            Mounting::AsMeasured => Behind::Glass(glass.min()),
            Mounting::Laminated => Behind::Laminated(glass.iter().sum::<f64>() / glass.len() as f64),
            Mounting::Air => Behind::Air,
        };
        if !matches!(behind, Behind::Glass(_)) {
            self.in_air(&diffuser.extrapolate, "this mounting")?;
        }
        let face = self.face(path, diffuser, behind)?;
        let mut parts = vec![Part::Interface(scattering(face))];
        let below = match diffuser.mounting.value {
            Mounting::AsMeasured => return Some(parts),
            // What the air disc does not hold stays in the glass.
            Mounting::Laminated => Ready::Coated,
            Mounting::Air => Ready::Fresnel,
        };
        let ones = Spectrum::constant(&self.grid, 1.0);
        let air = Medium { index: ones.clone(), transmittance: ones, scattering: None };
        parts.extend([Part::Medium(air, Origin::FILE), Part::Interface(below.into())]);
        Some(parts)
    }

    /// A film among layers in any order, where what is below it is a layer of its own.
    pub(super) fn measured_alone(&mut self, path: &str, diffuser: &At<Measured>) -> Option<ScatterFace> {
        if diffuser.mounting.value != Mounting::AsMeasured {
            self.err(&diffuser.mounting, mistake::not_with("mounting", "`[[display.layers]]`"));
            return None;
        }
        self.in_air(&diffuser.extrapolate, "`[[display.layers]]`")?;
        self.face(path, diffuser, Behind::Air)
    }

    /// Refuses tails in the glass where none is known to be.
    fn in_air(&mut self, extrapolate: &At<Option<Extrapolate>>, beside: &'static str) -> Option<()> {
        if extrapolate.value == Some(Extrapolate::Glass) {
            let wrong = mistake::not_with("extrapolate = \"glass\"", beside);
            let hint = "\"hold\" keeps the last lobe within the horizon of the air";
            self.err(extrapolate, wrong.hint(hint));
            return None;
        }
        Some(())
    }

    fn face(&mut self, path: &str, diffuser: &At<Measured>, behind: Behind) -> Option<ScatterFace> {
        let mut face = ScatterFace::new(Spectrum::constant(&self.grid, 0.0));
        for (side, kernel) in self.film_sides(path, diffuser, behind)? {
            face = match side {
                Side::Through => face.with_transmission(kernel),
                Side::Above => face.with_reflection_above(kernel),
                Side::Below => face.with_reflection_below(kernel),
            };
        }
        Some(face)
    }

    /// The film in air, whichever side is up: what it does with light from above, and with light from below that it reflects.
    pub(super) fn film_in_air(
        &mut self,
        path: &str,
        diffuser: &At<Measured>,
    ) -> Option<Vec<(Way, ScatterKernel)>> {
        let way = |side: Side| match side {
            Side::Through => Way::FrontTransmission,
            Side::Above => Way::FrontReflection,
            Side::Below => Way::BackReflection,
        };
        let film = self.film_sides(path, diffuser, Behind::Air)?;
        Some(film.into_iter().map(|(side, kernel)| (way(side), kernel)).collect())
    }

    fn film_sides(
        &mut self,
        path: &str,
        diffuser: &At<Measured>,
        behind: Behind,
    ) -> Option<Vec<(Side, ScatterKernel)>> {
        let key = || format!("film {path} {} {behind:?}", json!(diffuser));
        self.once(key, |this| this.film_sides_anew(path, diffuser, behind))
    }

    fn film_sides_anew(
        &mut self,
        path: &str,
        diffuser: &At<Measured>,
        behind: Behind,
    ) -> Option<Vec<(Side, ScatterKernel)>> {
        let source = Source {
            path,
            name: &diffuser.file.value,
            file: diffuser.file.origin,
            normalise: &diffuser.normalise,
            extrapolate_tails: diffuser.extrapolate_tails.value,
            extrapolate: &diffuser.extrapolate,
            spectral_mean: diffuser.spectral_mean.value,
            blur: Some(&diffuser.instrument_blur),
        };
        let measurement = self.measurement(&source)?;
        let (into, back, front) = if diffuser.flipped.value {
            (Way::BackTransmission, Way::FrontReflection, Way::BackReflection)
        } else {
            (Way::FrontTransmission, Way::BackReflection, Way::FrontReflection)
        };
        let through = self.way(&source, &measurement, into)?;
        let part = |way: Way| measurement.parts.iter().find(|part| part.way == way);
        let spectrum = match &diffuser.transmission.value {
            Some(share) => Some(self.colour(share, diffuser.transmission.origin)?),
            None => None,
        };
        if spectrum.as_ref().is_some_and(Spectrum::is_constant) {
            self.notes.push(format!(
                "{}.transmission is the same at all wavelengths, and does nothing: only its shape counts, the level is the \
                 file's or, with normalise = \"tis\", the instrument's",
                source.path
            ));
        }
        let mut film = vec![(Side::Through, self.scattered(&source, through, spectrum, behind)?)];
        if let Some(part) = part(front) {
            film.push((Side::Above, self.scattered(&source, part, None, Behind::Air)?));
        }
        // A laminated film's back face in air is gone, and with it most of what it reflected.
        if let Some(part) = part(back).filter(|_| behind.lamination().is_none()) {
            film.push((Side::Below, self.scattered(&source, part, None, Behind::Air)?));
        }
        Some(film)
    }

    /// A pixel under a medium of this index: the BRDF of its states, angles in air taken as angles in the medium.
    pub(super) fn measured_pixel(&mut self, pixel: &MeasuredPixel) -> Option<ScatteringPixel> {
        self.once(|| format!("pixel {}", json!(pixel)), |this| this.measured_pixel_anew(pixel))
    }

    fn measured_pixel_anew(&mut self, pixel: &MeasuredPixel) -> Option<ScatteringPixel> {
        self.in_air(&pixel.extrapolate, "a pixel")?;
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
                normalise: &pixel.normalise,
                extrapolate_tails: pixel.extrapolate_tails.value,
                extrapolate: &pixel.extrapolate,
                spectral_mean: SpectralMean::Uniform,
                blur: None,
            };
            kernels.push((state.name.clone(), self.measured_state(&source, pixel.spectrum.get(&state.name))));
        }
        let kernels = kernels.into_iter().map(|(name, kernel)| Some((name, kernel?)));
        Some(ScatteringPixel { states: kernels.collect::<Option<_>>()? })
    }

    fn measured_state(
        &mut self,
        source: &Source<'_>,
        spectrum: Option<&At<ShareSpectrum>>,
    ) -> Option<ScatterKernel> {
        let measurement = self.measurement(source)?;
        let reflection = self.way(source, &measurement, Way::FrontReflection)?;
        let spectrum = match spectrum {
            Some(share) => Some(self.colour(share, share.origin)?),
            None => None,
        };
        self.scattered(source, reflection, spectrum, Behind::Air)
    }

    /// A spectrum whose shape colours a measurement.
    fn colour(&mut self, share: &ShareSpectrum, origin: Origin) -> Option<Spectrum> {
        let spectrum = self.share(share, origin)?;
        if spectrum.max() <= 0.0 {
            let wrong =
                Diagnostic::new("this spectrum is 0 at all wavelengths, and cannot colour the measurement");
            self.errors.push(origin, wrong.hint("its shape is what counts: somewhere it must be above 0"));
            return None;
        }
        Some(spectrum)
    }

    fn way<'a>(
        &mut self,
        source: &Source<'_>,
        measurement: &'a Measurement,
        way: Way,
    ) -> Option<&'a goniometry::Part> {
        let part = measurement.parts.iter().find(|part| part.way == way);
        if part.is_none() {
            let found = measurement.parts.iter().map(|part| part.way.name()).collect::<Vec<_>>().join(", ");
            let flip = way == Way::FrontTransmission && found.contains(Way::BackTransmission.name());
            let wrong = Diagnostic::new(format!("this file has no {}", way.name()))
                .expected(format!("it among what the file has: {found}"))
                .hint_if(
                    flip.then_some("`flipped = true` takes the light from the other side of the sample"),
                );
            self.errors.push(source.file, wrong);
        }
        part
    }

    /// A file of measured scattering.
    fn measurement(&mut self, source: &Source<'_>) -> Option<Measurement> {
        let kept = self.open_within(source.name, source.file, LARGEST_BSDF_FILE)?;
        match read_bsdf(kept.file()) {
            Ok(read) => {
                let name = source.name;
                self.warnings.extend(read.warnings.iter().map(|warning| format!("{name}: {warning}")));
                Some(read.value)
            }
            Err(error) => {
                self.errors.push_data(source.file, error);
                None
            }
        }
    }

    /// The kernel of a part, coloured by the shape of a spectrum, and a report of what became of it.
    fn scattered(
        &mut self,
        source: &Source<'_>,
        part: &goniometry::Part,
        spectrum: Option<Spectrum>,
        behind: Behind,
    ) -> Option<ScatterKernel> {
        let level = match (&spectrum, source.spectral_mean) {
            (Some(spectrum), SpectralMean::Uniform) => spectrum.iter().sum::<f64>() / spectrum.len() as f64,
            (Some(spectrum), SpectralMean::Luminous) => self.luminous_mean(spectrum, source.file)?,
            (None, _) => 1.0,
        };
        let largest = spectrum.as_ref().map_or(1.0, |spectrum| spectrum.max()) / level;
        let scatter = self.kernel(source, part, [level, largest], behind)?;
        let factor = spectrum.unwrap_or_else(|| Spectrum::constant(&self.grid, 1.0));
        Some(ScatterKernel { scatter, factor })
    }

    /// The mean of a spectrum as the eye weights it in D65.
    fn luminous_mean(&mut self, spectrum: &Spectrum, at: Origin) -> Option<f64> {
        let d65 = illuminant("D65", &self.grid);
        let d65 = self.sampled("D65", at, d65)?;
        self.factors(spectrum, &d65, Channels::Monochrome)?.first().copied()
    }

    /// The kernel of a part, and a report of what became of it; `level`: the mean of the spectrum that it will be multiplied
    /// with, and the spectrum's maximum over its mean.
    fn kernel(
        &mut self,
        source: &Source<'_>,
        part: &goniometry::Part,
        [level, largest]: [f64; 2],
        behind: Behind,
    ) -> Option<Scatter> {
        let preparation = Preparation {
            fill: if source.extrapolate_tails { Fill::Tail } else { Fill::None },
            to_tis: source.normalise.value == Normalise::Tis,
            extrapolate: source.extrapolate.value.and_then(|extrapolate| behind.reach(extrapolate)),
            hold_single: source.extrapolate.value.is_none(),
            lamination: behind.lamination(),
        };
        let sharp = self.without_blur(source, part)?;
        let part = sharp.as_ref().unwrap_or(part);
        match kernel(part, part.luminous(), &preparation, &[level]) {
            Ok((scatter, changes)) => {
                self.tell(source, part.way, &changes, largest)?;
                Some(scatter)
            }
            Err(error) => {
                match error {
                    GoniometryError::NoTis => {
                        let wrong = Diagnostic::new(error.to_string()).hint("use normalise = \"none\"");
                        self.errors.push(source.normalise.origin, wrong);
                    }
                    _ => self.errors.push(source.file, error),
                }
                None
            }
        }
    }

    /// The part's luminous channel without the instrument's blur; `Some(None)` if that stays.
    fn without_blur(
        &mut self,
        source: &Source<'_>,
        part: &goniometry::Part,
    ) -> Option<Option<goniometry::Part>> {
        let Some(blur) = source.blur.filter(|blur| blur.value.0 > 0.0) else { return Some(None) };
        let Blur(width) = blur.value;
        let channel = part.luminous();
        let sharp = match deblurred(part, channel, &Unblur::of_width(width)) {
            Ok(sharp) => sharp,
            Err(error) => {
                self.errors.push(blur.origin, unblurred(&error));
                return None;
            }
        };
        let (path, way, [spread, _]) = (source.path, part.way.name(), sharp.noise_amplification);
        let misfit = sharp.incidences.iter().map(|lobe| lobe.misfit).fold(0.0, f64::max);
        if misfit > FAR_MISFIT {
            self.errors.push(blur.origin, unblurred(&GoniometryError::Blur { width, misfit }));
            return None;
        }
        if let Some(Unblurred { theta_deg, peak: [before, after], .. }) = sharp.incidences.first() {
            self.notes.push(format!(
                "{path}: {way}: without the instrument's blur of {width} the peak at {theta_deg} deg is {after:.1} instead of \
                 {before:.1} per sr; relative noise is {spread:.1} times as large; blurred again, values differ from the file's \
                 by {:.2} % (root mean square)",
                100.0 * misfit
            ));
        }
        if misfit > MISFIT {
            self.warnings.push(format!(
                "{path}: {way}: no lobe blurred by {width} gives the file's values: {:.0} % remain; `instrument_blur` may be \
                 too wide",
                100.0 * misfit
            ));
        }
        let totals = match &part.geometry {
            goniometry::Geometry::Specular(grid) => grid.rotations_deg.len() * grid.incidences_deg.len(),
            _ => 0,
        };
        let tis = part.tis.chunks_exact(totals.max(1)).nth(channel).unwrap_or_default();
        Some(Some(goniometry::Part {
            way: part.way,
            channels: vec![part.channels[channel]],
            geometry: part.geometry.clone(),
            values: sharp.values,
            tis: tis.to_vec(),
        }))
    }
}
