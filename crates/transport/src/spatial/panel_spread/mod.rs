//! What a view sees of the pixel plane through the layers of an ordinary panel: directions, places and their
//! light.
//!
//! **What.** A [`PanelSpread`] belongs to a view and a source. It is a list of [`Part`]s, each a list of
//! [`Sample`]s (direction, place, weight) with one factor for each wavelength. Light that has met the pixel
//! once adds up to `sum of through(wavelength) x weight x reflectance(beta, wavelength)`, the reflectance
//! factor of that light: the same number as that of colours, now with a place for each of its terms.
//!
//! **All orders.** The layers return light to a Lambertian pixel ([`LambertianReturn`]). A small modulation of
//! the pixel about a state of reflectance rho is then seen as `V(f) rho/(1 - rho A(f))`, with V the transform
//! of the samples; at f = 0 this is the reflectance factor of a uniform state in all orders. What is returned
//! to mirror-like pixels is not here.
//!
//! Places are relative to where the own ray of each direction of view meets the pixel, at each index of the
//! glass.

mod bare;
mod diffused;
mod error;
mod lambertian_return;
mod lobe_return;

pub use error::SpreadError;
pub use lambertian_return::LambertianReturn;
pub(in crate::spatial) use lambertian_return::Tabulated;

use std::borrow::Cow;
use std::sync::Arc;

use papilio_optics::Beta;

use super::spread::{Directions, Pair, SUMS};
use super::{Accuracy, FrontWays, Image, PointSpread, Sample};
use crate::light::cone_points::Point;
use crate::{Cone, Panel, Reflector, Source, Top};

/// Directions and places with a common factor for each wavelength.
///
/// Light that is reflected to and fro between components of a front is a part of its own for each of its ways.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Sharp images.
    images: Vec<Sample>,
    /// Factor of these samples, `[wavelength]`: the transmittance of the layers on both ways. It may be
    /// negative where results are interpolated between indices of the glass.
    pub through: Arc<[f64]>,
    /// Index of the glass.
    index: f64,
    /// The diffuser, of light at all places; otherwise each sample is a sharp image.
    pair: Option<Moved>,
}

impl Part {
    /// Index of the glass for which the samples were made.
    pub fn index(&self) -> f64 {
        self.index
    }

    /// Number of sums over other directions.
    pub const SUMS: usize = SUMS;

    /// Calls `each` with all that is seen, for a pixel that reflects everything and layers that transmit
    /// everything. Samples are not stored: of lobes much narrower than a source there are millions.
    pub fn each_sample(&self, each: impl FnMut(Sample)) {
        self.each_sample_of(None, each);
    }

    /// Calls `each` with the same light at the directions of a sum of this number, below [`SUMS`](Self::SUMS). Sums of a function with
    /// kinks, such as an area of a pixel at the place that is seen, scatter by their errors; together they have about as many
    /// directions as [`each_sample`](Self::each_sample), and their mean is the result. `None` stands for all directions.
    pub fn each_sample_of(&self, sum: Option<usize>, mut each: impl FnMut(Sample)) {
        let directions = sum.map_or(Directions::Whole, Directions::Sum);
        self.images.iter().copied().for_each(&mut each);
        if let Some(Moved { pair, by_mm, part, digits_less }) = &self.pair {
            let digits = (pair.accuracy.digits - digits_less).max(FEWEST_DIGITS.min(pair.accuracy.digits));
            let mut pair = Cow::Borrowed(&**pair);
            if *digits_less > 0.0 {
                pair.to_mut().accuracy.digits = digits;
            }
            pair.each_scattered(directions, &mut |sample: Sample| {
                let place_mm = [0, 1].map(|k| sample.place_mm[k] + by_mm[k]);
                each(Sample { place_mm, weight: part * sample.weight, ..sample });
            });
        }
    }

    /// How far away the view sees this part of scattered light, because it was reflected in the front, mm.
    pub fn moved_mm(&self) -> Option<[f64; 2]> {
        self.pair.as_ref().map(|pair| pair.by_mm)
    }

    /// How far away, mm, and which part of another part's light this one is, if it has the same directions and, but for a common
    /// factor, the same spectrum.
    pub fn moved_from(&self, other: &Self) -> Option<([f64; 2], f64)> {
        let (own, before) = self.pair.as_ref().zip(other.pair.as_ref())?;
        if self.index != other.index || !Arc::ptr_eq(&own.pair, &before.pair) || before.part == 0.0 {
            return None;
        }
        let pairs = || self.through.iter().zip(&*other.through);
        let factor = match Arc::ptr_eq(&self.through, &other.through) {
            true => 1.0,
            false => pairs().find(|(_, other)| **other != 0.0).map_or(0.0, |(own, other)| own / other),
        };
        let is_same = pairs().all(|(own, other)| (own - factor * other).abs() <= 1e-12 * own.abs());
        let by_mm = [0, 1].map(|k| own.by_mm[k] - before.by_mm[k]);
        is_same.then_some((by_mm, factor * own.part / before.part))
    }

    /// Returns whether another part has the same index and the same factors.
    pub fn is_weighted_like(&self, other: &Self) -> bool {
        self.index == other.index && Arc::ptr_eq(&self.through, &other.through)
    }
}

/// Scattered light, of which a part is seen farther away.
#[derive(Debug, Clone, PartialEq)]
struct Moved {
    pair: Arc<Pair>,
    by_mm: [f64; 2],
    part: f64,
    /// How many natural digits fewer its samples have, because it is faint.
    digits_less: f64,
}

/// What a view sees of the pixel plane in the light of one source.
#[derive(Debug, Clone)]
pub struct PanelSpread {
    parts: Vec<Part>,
}

/// Heights of a panel.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Heights {
    /// Air between the front of screen and what is below it, mm.
    front_mm: f64,
    /// Glass, mm.
    glass_mm: f64,
}

/// Lowest index of the glass; a lower one is taken as this.
const LEAST_INDEX: f64 = 1.0 + 1e-7;

/// Fewest natural digits of faint light.
const FEWEST_DIGITS: f64 = 5.0;

/// Angle over which the reflectances of interfaces and pixels change, radians.
const SMOOTH: f64 = 0.3;

impl Heights {
    /// Reads the gaps of the components of the front, outermost first, and the thickness of the glass.
    fn new(panel: &Panel) -> Result<Self, SpreadError> {
        let (glass_mm, fronts) =
            panel.gaps_mm.split_last().map_or((0.0, &[][..]), |(glass, fronts)| (*glass, fronts));
        let returns = !panel.single_pass && panel.front.reflectance_below.max() > 0.0;
        // A component above the highest one that reflects has no length.
        let apart = fronts.iter().skip_while(|gap| **gap == 0.0).count() > 1;
        // Above a diffuser each has its own ways ([`FrontWays`](super::FrontWays)).
        if returns && apart && !matches!(panel.top, Top::Diffuser(_)) {
            return Err(SpreadError::SeveralFronts);
        }
        Ok(Self { front_mm: if returns { fronts.iter().sum() } else { 0.0 }, glass_mm })
    }
}

/// Returns the length of the air between the front of screen and what is below it, mm; 0 if the front returns
/// no light. Above a diffuser it is that of all air.
///
/// # Errors
/// If several components of the front reflect at different heights above a flat face.
pub fn air_below_front_mm(panel: &Panel) -> Result<f64, SpreadError> {
    Ok(Heights::new(panel)?.front_mm)
}

impl PanelSpread {
    /// Prepares the spread in directions `view` in air.
    ///
    /// # Errors
    /// If this panel is not covered.
    pub fn new(panel: &Panel, view: &Cone, source: &Source, accuracy: Accuracy) -> Result<Self, SpreadError> {
        Self::build(panel, view, source, accuracy, false)
    }

    /// Prepares a spread whose samples have the true directions in the glass. Those of [`new`](Self::new) may
    /// stand for several directions of a field of view that see the same place; they have its place and
    /// `|beta|`. Light between a face and a front of screen above it, on its way to the viewer, has no places of
    /// its own.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn by_direction(
        panel: &Panel,
        view: &Cone,
        source: &Source,
        accuracy: Accuracy,
    ) -> Result<Self, SpreadError> {
        Self::build(panel, view, source, accuracy, true)
    }

    fn build(
        panel: &Panel,
        view: &Cone,
        source: &Source,
        accuracy: Accuracy,
        by_direction: bool,
    ) -> Result<Self, SpreadError> {
        let heights = Heights::new(panel)?;
        if matches!(panel.base.reflector, Reflector::Scattering(_)) {
            return Err(SpreadError::ScatteringPixel);
        }
        if matches!(&panel.top, Top::Fresnel(face) if face != panel.medium.index()) {
            return Err(SpreadError::Unrefracted);
        }
        // Air in the place of the glass: grazing light goes infinitely far.
        let refracting = (panel.medium.index().min() < LEAST_INDEX).then(|| {
            let medium = panel.medium.with_index_of_at_least(LEAST_INDEX);
            let top = match &panel.top {
                Top::Fresnel(_) => Top::Fresnel(medium.index().clone()),
                other => other.clone(),
            };
            Panel { medium, top, ..panel.clone() }
        });
        let panel = refracting.as_ref().unwrap_or(panel);
        let parts = match &panel.top {
            Top::Diffuser(diffuser) => {
                // Light by direction has its way through the front in its transmittance.
                let leaving = match by_direction {
                    true => None,
                    false => Some(FrontWays::new(panel, (-accuracy.digits).exp())?.leaving),
                };
                let leaving = leaving.as_deref().unwrap_or_default();
                diffused::parts((panel, diffuser), (heights, leaving), view, source, (accuracy, by_direction))
            }
            Top::IdealAr | Top::Fresnel(_) => {
                bare::parts(panel, heights, view, source, (accuracy, by_direction))
            }
        };
        Ok(Self { parts })
    }

    /// The same with a weight of each direction of view.
    #[must_use]
    pub fn times(mut self, weight: impl Fn(Beta) -> f64) -> Self {
        let samples = self.parts.iter_mut().flat_map(|part| &mut part.images);
        samples.for_each(|sample| sample.weight *= weight(sample.beta));
        self
    }

    /// The mirror image of a beam in mirror-like pixels, its light along `beta`: what is never scattered.
    ///
    /// # Errors
    /// If several components of the front reflect at different heights.
    pub fn image(panel: &Panel, beta: Beta) -> Result<Self, SpreadError> {
        let parts = match &panel.top {
            Top::Diffuser(diffuser) => diffused::image((panel, diffuser), beta),
            Top::IdealAr | Top::Fresnel(_) => {
                let heights = Heights::new(panel)?;
                bare::in_directions((panel, heights), &[Point { beta, weight: 1.0 }], None, 1.0)
            }
        };
        Ok(Self { parts })
    }

    /// The samples, by parts of a common factor.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Returns a part of the light by place.
    pub fn point_spread<'a>(&self, part: &'a Part) -> PointSpread<'a> {
        match &part.pair {
            Some(Moved { pair, by_mm, part, .. }) if *by_mm == [0.0; 2] && *part == 1.0 => {
                pair.point_spread()
            }
            Some(Moved { pair, by_mm, part, .. }) => pair.point_spread().moved(*by_mm, *part),
            None => PointSpread::of_images(part.images.iter().map(Image::from)),
        }
    }
}

/// Returns the indices of the glass, each with its wavelengths.
fn by_index(panel: &Panel) -> Vec<(f64, Vec<usize>)> {
    let mut all: Vec<(f64, Vec<usize>)> = Vec::new();
    for (bin, index) in panel.medium.index().iter().enumerate() {
        match all.iter_mut().find(|known| known.0 == *index) {
            Some(known) => known.1.push(bin),
            None => all.push((*index, vec![bin])),
        }
    }
    all
}
