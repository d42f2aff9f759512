//! Lengths of a display: the thickness of its media and the windows of its sub-pixels. They determine where
//! light leaves, not how much of it.

use papilio_spectra::Spectrum;
use papilio_transport::spatial::{PixelSpread, Window};

use super::{Display, Interface, Layer, Pixel, Ready, UniformKind};
use crate::DisplayError;

/// Key of the spread of light within the pixel.
pub(crate) const SPREAD_KEY: &str = "display.pixel.spread_um";

/// Length along the normal.
#[derive(Debug, Clone, PartialEq)]
pub enum Length {
    /// A length, mm; 0 between interfaces at the same place.
    Mm(f64),
    /// Not specified.
    Missing {
        /// Path of the key that would specify it, such as `display.glass.thickness_mm`.
        key: String,
    },
}

/// Sub-pixels in the plane of the pixel: one period of an array that repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// Period of a whole pixel along x (azimuth 0) and y (azimuth 90 deg), mm.
    pub pitch_mm: [f64; 2],
    /// Number of columns and rows of the display; `None`: that of a picture.
    pub pixels: Option<[usize; 2]>,
    /// The sub-pixels: those of a film pixel in its order; those of a filter; or a single one.
    pub sub_pixels: Vec<SubPixelWindow>,
    /// Second pattern plane above the pixels.
    pub filter: Option<Filter>,
}

/// Smallest length other than 0, mm, far below the size of an atom. Below it light leaves where it came, and
/// the results span more decades than a table shows.
const LEAST_MM: f64 = 1e-12;

impl Matrix {
    /// Inactive fraction of the area.
    pub fn inactive_fraction(&self) -> f64 {
        1.0 - self.sub_pixels.iter().map(|sub_pixel| sub_pixel.fraction).sum::<f64>()
    }
}

/// Place of a sub-pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct SubPixelWindow {
    /// Its name.
    pub name: String,
    /// Fraction of the whole area, by the area of the sub-pixel and the fill factor, as colours use it. The
    /// area of the window differs by at most 0.001.
    pub fraction: f64,
    /// Its rectangles in fractions of the pitch, from the lower left corner of the pixel.
    pub window: Window,
}

/// Colour filter above the pixels, with the same windows. Between its windows it is clear.
#[derive(Debug, Clone, PartialEq)]
pub struct Filter {
    /// Height above the pixels in the medium above them, mm.
    pub height_mm: f64,
    /// Transmittance of one pass along the normal for each sub-pixel of the matrix; an oblique pass has its
    /// power 1/cos(theta).
    pub transmittance: Vec<Spectrum>,
    /// States of the display.
    pub states: Vec<FilterState>,
}

/// State of a display with a colour filter.
#[derive(Debug, Clone, PartialEq)]
pub struct FilterState {
    /// Its name.
    pub name: String,
    /// Index, among the states of the pixel, of the state below each sub-pixel's filter.
    pub pixel_states: Vec<usize>,
}

impl Display {
    /// Returns the colour filter above the pixels.
    pub fn filter(&self) -> Option<&Filter> {
        self.matrix.as_ref()?.filter.as_ref()
    }

    /// Returns the names of the states, in order: those of the colour filter, or of the pixel.
    pub fn state_names(&self) -> Vec<String> {
        match self.filter() {
            Some(filter) => filter.states.iter().map(|state| state.name.clone()).collect(),
            None => crate::pixel::state_names(&self.pixel),
        }
    }

    /// Returns the thickness of the medium of each layer, mm; 0 above all layers that scatter or reflect
    /// light, where it has no effect on places.
    ///
    /// # Errors
    /// If lengths are needed and missing: all of them, the lowest first.
    pub fn lengths_mm(&self) -> Result<Vec<f64>, DisplayError> {
        let first = self.first_needed();
        let missing = |layer: &Layer| match &layer.thickness {
            Length::Missing { key } => Some(key.clone()),
            Length::Mm(_) => None,
        };
        if let (Some(spread), true) = (self.pixel_spread(), self.returns_nothing()) {
            // A medium like air moves no light: places are those of the spread inside the pixels, whose scale
            // is taken.
            let lengths =
                (0..self.layers.len()).map(|number| self.length_mm(number).unwrap_or(spread.radius_mm()));
            return Ok(lengths.collect());
        }
        // The lowest first: without the glass, the others are of no use.
        let mut missing = self.layers.iter().skip(first).rev().filter_map(missing);
        if let Some(key) = missing.next() {
            return Err(DisplayError::MissingLength { key, others: missing.collect() });
        }
        let needed = |number: usize| if number < first { Ok(0.0) } else { self.length_mm(number) };
        let lengths: Vec<f64> = (0..self.layers.len()).map(needed).collect::<Result<_, _>>()?;
        match lengths.iter().find(|length| (f64::MIN_POSITIVE..LEAST_MM).contains(*length)) {
            Some(&length_mm) => Err(DisplayError::TooThin { length_mm, least_mm: LEAST_MM }),
            None => Ok(lengths),
        }
    }

    /// Checks that light leaves the pixel where it met it.
    ///
    /// # Errors
    /// If it spreads sideways within the pixel, which is not computed.
    pub(crate) fn has_sharp_pixels(&self) -> Result<(), DisplayError> {
        match self.pixel_spread() {
            Some(_) => Err(DisplayError::PlacesNotComputed {
                what: "light that spreads sideways within the pixel".to_owned(),
                key: SPREAD_KEY.to_owned(),
            }),
            None => Ok(()),
        }
    }

    /// Returns how light spreads inside the pixels; `None` if it leaves them where it entered.
    pub fn pixel_spread(&self) -> Option<PixelSpread> {
        match &self.pixel {
            Pixel::Uniform(pixel) if pixel.kind == UniformKind::Lambertian => {
                PixelSpread::new(pixel.spread_mm)
            }
            _ => None,
        }
    }

    /// Returns the thickness of the medium of a layer, mm, by the number of the layer.
    ///
    /// # Errors
    /// If it is missing.
    pub fn length_mm(&self, number: usize) -> Result<f64, DisplayError> {
        match &self.layers[number].thickness {
            Length::Mm(length) => Ok(*length),
            Length::Missing { key } => {
                Err(DisplayError::MissingLength { key: key.clone(), others: Vec::new() })
            }
        }
    }

    /// True if nothing is above the pixels that could move light or return it to them.
    fn returns_nothing(&self) -> bool {
        let Some(panel) = self.panel() else { return false };
        let glass = self.layers.last().map(|layer| &layer.medium.index);
        glass.is_some_and(|index| index.min() == 1.0 && index.max() == 1.0)
            && panel.diffuser().is_none()
            && panel.front.iter().all(|component| component.reflectance.max() == 0.0)
    }

    /// Returns the number of the highest medium from which light can come back to the pixel at another place.
    fn first_needed(&self) -> usize {
        self.layers.iter().position(moves_light).unwrap_or(self.layers.len())
    }
}

/// True if a layer scatters or reflects light.
fn moves_light(layer: &Layer) -> bool {
    layer.medium.scattering.is_some()
        || match &layer.interface {
            Interface::Ready(Ready::Open) => false,
            Interface::Ready(Ready::Component(component)) => component.reflectance.iter().any(|r| *r > 0.0),
            _ => true,
        }
}
