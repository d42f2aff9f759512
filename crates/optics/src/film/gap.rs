//! Fast implementation: reflectance of many wavelengths, directions and gaps at once.

use num_complex::Complex64;

use super::coherent::Polarisation;
use super::derivative::{Derivatives, Variable};
use super::kernel::Sweep;
use super::media::Media;
use super::{SimdLevel, checked_incidence, checked_index, checked_thickness, checked_wavelength};
use crate::OpticsError;

/// A layer at every wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralLayer {
    /// n + ik per wavelength, k >= 0.
    pub index: Vec<Complex64>,
    /// Its thickness.
    pub thickness: Thickness,
}

/// The thickness of a layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Thickness {
    /// A constant, nm.
    Fixed(f64),
    /// That of the gap.
    Gap,
}

/// A stack with at most one layer of variable thickness, ready for many evaluations.
///
/// The layers above the gap and those below it are condensed once for each wavelength, beta and
/// polarisation. A further gap then costs one sine and cosine, which s and p share, and two small quotients.
///
/// ```
/// use papilio_optics::film::{GapFilm, SpectralLayer, Thickness};
/// // Half a wave of air between two glasses has no effect: 4 % + 4 % cancel.
/// let gap = SpectralLayer { index: vec![1.0.into(); 2], thickness: Thickness::Gap };
/// let film = GapFilm::new(&[500.0, 1000.0], &[1.5; 2], &[gap], &[1.5.into(); 2])?;
/// let mut reflectance = [0.0; 2];
/// film.reflectance(&[0.0], &[250.0], &mut reflectance)?;
/// assert!(reflectance[0] < 1e-30);
/// assert!((reflectance[1] - (1.25_f64 / 3.25).powi(2)).abs() < 1e-15); // a quarter wave
/// # Ok::<(), papilio_optics::OpticsError>(())
/// ```
#[derive(Debug, Clone)]
pub struct GapFilm {
    media: Media,
    level: SimdLevel,
}

impl GapFilm {
    /// A film over a list of wavelengths (nm), in any order.
    ///
    /// `incidence` and `substrate` contain an index per wavelength, as does each of the `layers`, in the
    /// order in which the light meets them.
    ///
    /// # Errors
    /// If lengths differ from that of `wavelengths_nm`, a wavelength or an index
    /// of incidence is not positive, an index has n or k below 0 (or both 0), a
    /// thickness is negative, or several layers are the gap.
    pub fn new(
        wavelengths_nm: &[f64],
        incidence: &[f64],
        layers: &[SpectralLayer],
        substrate: &[Complex64],
    ) -> Result<Self, OpticsError> {
        let count = wavelengths_nm.len();
        check_length("indices of the incidence medium", count, incidence.len())?;
        check_length("indices of the substrate", count, substrate.len())?;
        wavelengths_nm.iter().try_for_each(|&nm| checked_wavelength(nm).map(drop))?;
        incidence.iter().try_for_each(|&n| checked_incidence(n).map(drop))?;
        for layer in layers {
            check_length("indices of a layer", count, layer.index.len())?;
            if let Thickness::Fixed(nm) = layer.thickness {
                checked_thickness(nm)?;
            }
        }
        let indices = layers.iter().flat_map(|layer| &layer.index).chain(substrate);
        indices.copied().try_for_each(|index| checked_index(index).map(drop))?;
        let found = layers.iter().filter(|layer| layer.thickness == Thickness::Gap).count();
        if found > 1 {
            return Err(OpticsError::Gaps { found });
        }
        let media = Media::new(wavelengths_nm, incidence, layers, substrate);
        Ok(Self { media, level: SimdLevel::best() })
    }

    /// Returns the same film for a given instruction set; [`new`](Self::new) selects the best.
    #[must_use]
    pub fn with_simd_level(self, level: SimdLevel) -> Self {
        Self { level, ..self }
    }

    /// Returns the number of wavelengths.
    pub fn wavelengths(&self) -> usize {
        self.media.wavelengths()
    }

    /// Computes the mean reflectance of s and p, into `out[beta][gap][wavelength]`.
    ///
    /// Equal to the mean of [`coherent`](super::coherent)'s two reflectances within 1e-12, except in
    /// resonators whose finesse amplifies rounding. Where beta is not below the index of the incidence
    /// medium (which may depend on the wavelength) there is no such light, and `out` is 0. A film without a
    /// gap layer gives the same for every gap.
    ///
    /// # Errors
    /// If a beta is negative or not finite, a gap is negative or not finite, or
    /// `out` does not have beta x gaps x wavelengths values.
    pub fn reflectance(&self, beta: &[f64], gaps_nm: &[f64], out: &mut [f64]) -> Result<(), OpticsError> {
        self.reflectance_of(None, beta, gaps_nm, out)
    }

    /// Computes the same of one polarisation, or of the mean of both (`None`).
    ///
    /// # Errors
    /// As [`reflectance`](Self::reflectance).
    pub fn reflectance_of(
        &self,
        polarisation: Option<Polarisation>,
        beta: &[f64],
        gaps_nm: &[f64],
        out: &mut [f64],
    ) -> Result<(), OpticsError> {
        self.check(beta, gaps_nm, out.len())?;
        if !out.is_empty() {
            self.level.dispatch(Sweep { media: &self.media, beta, gaps_nm, polarisation, out });
        }
        Ok(())
    }

    /// Computes the mean reflectance, as [`reflectance`](Self::reflectance) does (within 1e-12), and its
    /// derivatives, into `out[variable][beta][gap][wavelength]`: by thicknesses per nm, by n and k per 1.
    /// Where there is no light they are 0. The method is described in `film/derivative.rs`.
    ///
    /// # Errors
    /// As [`reflectance`](Self::reflectance); if `out` does not have as many values for each variable; or if
    /// a variable belongs to a layer that does not exist.
    pub fn derivatives(
        &self,
        beta: &[f64],
        gaps_nm: &[f64],
        variables: &[Variable],
        reflectance: &mut [f64],
        out: &mut [f64],
    ) -> Result<(), OpticsError> {
        self.derivatives_of(None, beta, gaps_nm, variables, reflectance, out)
    }

    /// Computes the same of one polarisation, or of the mean of both (`None`).
    ///
    /// # Errors
    /// As [`derivatives`](Self::derivatives).
    pub fn derivatives_of(
        &self,
        polarisation: Option<Polarisation>,
        beta: &[f64],
        gaps_nm: &[f64],
        variables: &[Variable],
        reflectance: &mut [f64],
        out: &mut [f64],
    ) -> Result<(), OpticsError> {
        self.check(beta, gaps_nm, reflectance.len())?;
        check_length("derivatives", variables.len() * reflectance.len(), out.len())?;
        let layers = self.media.layers();
        let highest = variables.iter().filter_map(|variable| variable.layer()).max();
        if let Some(layer) = highest.filter(|layer| *layer >= layers) {
            return Err(OpticsError::NoLayer { layer, layers });
        }
        if !reflectance.is_empty() {
            let media = &self.media;
            self.level.dispatch(Derivatives {
                media,
                beta,
                gaps_nm,
                variables,
                polarisation,
                reflectance,
                out,
            });
        }
        Ok(())
    }

    fn check(&self, beta: &[f64], gaps_nm: &[f64], values: usize) -> Result<(), OpticsError> {
        check_length("reflectances", beta.len() * gaps_nm.len() * self.wavelengths(), values)?;
        gaps_nm.iter().try_for_each(|&nm| checked_thickness(nm).map(drop))?;
        match beta.iter().find(|beta| !(0.0..f64::INFINITY).contains(*beta)) {
            Some(&beta) => Err(OpticsError::Beta { beta, limit: f64::INFINITY }),
            None => Ok(()),
        }
    }
}

fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), OpticsError> {
    if expected == found { Ok(()) } else { Err(OpticsError::Length { what, expected, found }) }
}
