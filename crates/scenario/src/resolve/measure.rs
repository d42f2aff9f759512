//! `[measure]`: a virtual imaging sphere that measures the diffuser.

use papilio_colour::Observer;
use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{self, Lobe, LobeReflection, ReflectedLobe};
use papilio_goniometry::{
    Channel, GoniometryError, Instrument, Measurement, Noise, ScatterMode, SpecularGrid, Symmetry, View,
    tristimulus_factors,
};
use papilio_optics::scatter::Scatter;
use papilio_optics::{Beta, Scatterer};
use papilio_spectra::Spectrum;

use super::Resolver;
use crate::describe::File;
use crate::describe::diffuser::Diffuser;
use crate::describe::measure::{Channels, GridAngles, Measure};
use crate::error::ScenarioErrors;
use crate::library::Library;
use crate::mistake;
use crate::read::{Read, Spanned};
use crate::source::Sources;

/// Largest number of cells in one channel.
const MOST_CELLS: usize = 1_000_000;
/// Significant digits of measured values.
const DIGITS: usize = 5;

/// A virtual measurement of a diffuser.
#[derive(Debug, Clone)]
pub struct VirtualMeasurement {
    /// The instrument.
    pub instrument: Instrument,
    /// Name of the sample, if the scenario specifies it.
    pub sample: Option<String>,
    /// Warnings: what may be wrong with the scenario.
    pub warnings: Vec<String>,
    /// Notes: consequences of the scenario that are worth knowing, and not wrong.
    pub notes: Vec<String>,
    /// The table of the diffuser as JSON.
    truth: String,
    ways: Vec<MeasuredWay>,
}

/// The true scattering in one transmission or reflection.
#[derive(Debug, Clone)]
struct MeasuredWay {
    way: ScatterMode,
    lobe: TrueLobe,
    /// Scattered and regular fraction.
    shares: [f64; 2],
    /// Factor of each channel.
    factors: Vec<f64>,
}

#[derive(Debug, Clone)]
enum TrueLobe {
    Lobe(Lobe),
    Scatter(Scatter),
}

impl TrueLobe {
    fn value(&self, from: Beta, to: Beta) -> f64 {
        match self {
            Self::Lobe(lobe) => lobe.evaluate(from, to),
            Self::Scatter(scatter) => scatter.evaluate(from, to),
        }
    }
}

impl VirtualMeasurement {
    /// Computes the measurement: values with five digits, and the true parameters as a remark.
    ///
    /// # Errors
    /// If the instrument cannot measure the sample: unscattered light without blur.
    pub fn measure(&self, sample: &str) -> Result<Measurement, GoniometryError> {
        let lobes: Vec<_> = self
            .ways
            .iter()
            .map(|seen| move |from: Beta, to: Beta| seen.shares[0] * seen.lobe.value(from, to))
            .collect();
        let views: Vec<View<'_>> = self
            .ways
            .iter()
            .zip(&lobes)
            .map(|(seen, f)| View { way: seen.way, f, straight: seen.shares[1], factors: &seen.factors })
            .collect();
        let mut measurement = self.instrument.measure(sample, &views)?;
        measurement.provenance.remarks.push(format!("the diffuser in truth: {}", self.truth));
        for part in &mut measurement.parts {
            part.values.iter_mut().chain(&mut part.tis).for_each(|value| *value = rounded(*value));
        }
        Ok(measurement)
    }
}

/// Rounds a value to the digits of the instrument.
fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

/// Resolves the virtual measurement of a described scenario.
pub(crate) fn measurement(
    file: &File,
    library: &Library,
    sources: &Sources,
) -> Result<VirtualMeasurement, ScenarioErrors> {
    let mut resolver = Resolver::new(file, library, sources)?;
    let found = resolver.before_instrument(file);
    let Resolver { errors, warnings, notes, .. } = resolver;
    let found = errors.finish(found, sources)?;
    Ok(VirtualMeasurement { warnings, notes, ..found })
}

/// A transmission or reflection of the diffuser: its lobe, scattered and regular fraction, and the spectrum
/// of both.
type TrueWay = (ScatterMode, TrueLobe, [f64; 2], Spectrum);

/// Returns the reflection of a sample in air.
fn reflected_way(way: ScatterMode, side: &LobeReflection) -> TrueWay {
    let lobe = match side.lobe() {
        ReflectedLobe::Lobe(lobe) => TrueLobe::Lobe(*lobe),
        ReflectedLobe::Kernel(scatter) => TrueLobe::Scatter(scatter.clone()),
    };
    let [scattered, mirror] = side.shares();
    let reflectance = side.scattered().zip_map(side.mirrored(), |scattered, mirrored| scattered + mirrored);
    (way, lobe, [scattered, mirror], reflectance)
}

impl Resolver<'_> {
    fn before_instrument(&mut self, file: &File) -> Option<VirtualMeasurement> {
        let default = Measure::absent().map(Spanned::without_span);
        let measure = file.measure.value.as_ref().or(default.as_deref())?;
        let instrument = self.instrument(measure);
        let light = self.light("measure.light", &measure.light);
        let ways = self.ways(file);
        let (instrument, light, ways) = (instrument?, light?, ways?);
        let ways = ways.into_iter().map(|(way, lobe, shares, spectrum)| {
            let factors = self.factors(&spectrum, &light, measure.channels.value)?;
            Some(MeasuredWay { way, lobe, shares, factors })
        });
        let ways = ways.collect::<Option<_>>()?;
        Some(VirtualMeasurement {
            instrument,
            sample: measure.sample.as_ref().map(|title| title.0.clone()),
            warnings: Vec::new(),
            notes: Vec::new(),
            truth: serde_json::to_string(&file.display.diffuser).unwrap_or_default(),
            ways,
        })
    }

    fn instrument(&mut self, measure: &Measure) -> Option<Instrument> {
        let incidences = self.grid_angles("measure.incidence_deg", &measure.incidence_deg);
        let azimuths = self.grid_angles("measure.azimuth_deg", &measure.azimuth_deg);
        let radials = self.grid_angles("measure.radial_deg", &measure.radial_deg);
        let (incidences_deg, azimuths_deg, radials_deg) = (incidences?, azimuths?, radials?);
        let ends = [
            (
                &measure.incidence_deg,
                incidences_deg.last().filter(|last| **last >= 90.0),
                "angles below 90 deg",
            ),
            (
                &measure.azimuth_deg,
                azimuths_deg.first().filter(|first| **first != 0.0),
                "0 as the first angle",
            ),
            (
                &measure.azimuth_deg,
                azimuths_deg.last().filter(|last| **last != 180.0),
                "180 as the last angle",
            ),
            (&measure.radial_deg, radials_deg.first().filter(|first| **first != 0.0), "0 as the first angle"),
        ];
        for (at, wrong, expected) in ends {
            if let Some(value) = wrong {
                self.err(at, mistake::out_of_range(*value, expected));
                return None;
            }
        }
        let cells = incidences_deg.len() * azimuths_deg.len() * radials_deg.len();
        self.limit(&measure.radial_deg, "cells", cells, MOST_CELLS)?;
        Some(Instrument {
            grid: SpecularGrid {
                rotations_deg: vec![0.0],
                incidences_deg,
                azimuths_deg,
                radials_deg,
                symmetry: Symmetry::Plane,
            },
            channels: match measure.channels.value {
                Channels::Xyz => vec![Channel::X, Channel::Y, Channel::Z],
                Channels::Monochrome => vec![Channel::Monochrome],
            },
            blur: measure.blur.0,
            renormalise: measure.renormalise.value,
            noise: Noise { relative: measure.noise.0, floor: measure.noise_floor.0, seed: measure.seed.0 },
            dark_beyond_deg: measure.dark_beyond_deg.0,
        })
    }

    /// Resolves the angles of an axis: from 0 to 180 deg, increasing.
    fn grid_angles(&mut self, key: &str, angles: &Spanned<GridAngles>) -> Option<Vec<f64>> {
        let values = match &angles.value {
            GridAngles::List(list) => self.listed(list, |angle| angle.0, angles.origin)?,
            GridAngles::Range(range) => self.spaced(key, range, angles.origin)?,
        };
        let beyond = values.iter().find(|value| !(0.0..=180.0).contains(*value));
        if let Some(value) = beyond {
            self.err(angles, mistake::out_of_range(*value, "angles from 0 to 180 deg"));
            return None;
        }
        if let Some(pair) = values.windows(2).find(|pair| pair[1] <= pair[0]) {
            self.err(angles, mistake::out_of_range(pair[1], "increasing angles"));
            return None;
        }
        Some(values)
    }

    /// Resolves the transmission and reflection of the diffuser.
    fn ways(&mut self, file: &File) -> Option<Vec<TrueWay>> {
        let at = &file.display.diffuser;
        let through = |truth: TrueLobe, spectrum: Spectrum, straight: f64| {
            vec![(ScatterMode::FrontTransmission, truth, [1.0 - straight, straight], spectrum)]
        };
        let of_lobe = |lobe: scene::Diffuser| {
            through(TrueLobe::Lobe(lobe.lobe), lobe.transmittance, lobe.regular_fraction)
        };
        let (transmission, reflection) = match &at.value {
            Some(Diffuser::KCorrelation(lobe)) => (self.k_correlation(lobe).map(of_lobe), &lobe.reflection),
            Some(Diffuser::Lambertian(lobe)) => (self.lambertian(lobe).map(of_lobe), &lobe.reflection),
            Some(Diffuser::Ward(ward)) => {
                let lobe = self.ward_lobe(ward).map(|(scatter, transmittance)| {
                    through(TrueLobe::Scatter(scatter), transmittance, ward.regular_fraction.0)
                });
                (lobe, &ward.reflection)
            }
            Some(Diffuser::Measured(measured)) => {
                let film = self.foil_in_air("display.diffuser", measured)?;
                let whole = |(way, kernel): (ScatterMode, papilio_display::scene::ScatterKernel)| {
                    (way, TrueLobe::Scatter(kernel.scatter), [1.0, 0.0], kernel.factor)
                };
                (Some(film.into_iter().map(whole).collect()), &measured.reflection)
            }
            Some(Diffuser::Microgeometry(face)) => {
                let wrong = Diagnostic::new(
                    "`papilio diffuser measure` does not measure a face by its geometry",
                )
                .hint("`papilio gonio` measures it: the file of the geometry, with a table [microgeometry]");
                self.errors.push(face.origin, wrong);
                return None;
            }
            Some(Diffuser::Slab(slab)) => {
                let wrong = Diagnostic::new(
                    "an instrument cannot measure a slab, because it has no BTDF of its own",
                )
                .hint(
                    "use model = \"k-correlation\", \"lambertian\", \"ward\" or \"measured\"; `papilio brdf` \
                     computes the BRDF of a whole display with a slab",
                );
                self.errors.push(slab.origin, wrong);
                return None;
            }
            None => {
                let wrong = mistake::missing_key("diffuser", Diffuser::in_words());
                self.errors.push(file.display.origin.or_override([file.display.layers.origin]), wrong);
                return None;
            }
        };
        let (transmission, sides) = (transmission, self.reflections(reflection));
        let mut ways: Vec<TrueWay> = transmission?;
        let reflected = [ScatterMode::FrontReflection, ScatterMode::BackReflection].into_iter().zip(sides?);
        ways.extend(reflected.filter_map(|(way, side)| side.map(|side| reflected_way(way, &side))));
        Some(ways)
    }

    /// Computes the factor of a transmission spectrum for each channel, relative to the light.
    pub(super) fn factors(
        &mut self,
        spectrum: &Spectrum,
        light: &Spectrum,
        channels: Channels,
    ) -> Option<Vec<f64>> {
        let observer = match Observer::new(&self.grid) {
            Ok(observer) => observer,
            Err(_) => {
                let range_nm = (self.grid.start_nm(), self.grid.stop_nm());
                self.errors.push(self.range, mistake::invisible(range_nm));
                return None;
            }
        };
        let factors = tristimulus_factors(spectrum, light, observer.weights());
        Some(match channels {
            Channels::Xyz => factors.to_vec(),
            Channels::Monochrome => vec![factors[1]],
        })
    }
}
