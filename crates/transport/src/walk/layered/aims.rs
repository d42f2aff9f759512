//! Directions that an event samples more often than its own kernel would.
//!
//! **Half way between the view and a source.** Between two lobes that fall as fast as Gaussians, light mostly
//! travels in directions half way between the view and the source: two lobes `exp(-r²/s²)` at a distance d
//! have a product that is largest there, `exp(-d²/(2 s²))`, whereas it is `exp(-d²/s²)` at the ends. A path,
//! which samples from the view's end, and a relay, which samples from the source's, rarely find these
//! directions, and the variance of both grows like `exp(d²/(4 s²))`. So relays sample a part of their
//! directions from their kernel for light that would arrive half way ([`HALF_WAY`]).
//!
//! **About a source.** Lobes with heavier tails have the largest product at the ends: light changes its
//! direction at one of its events, and hardly at the others. If it meets three lobes or more, and changes its
//! direction at the first one, counted from the view, the path must be near the source's direction already
//! before it can connect to the source or its relay. Its kernel rarely finds such directions, and the light is
//! bright there. So events of a path that is not near a source sample a second direction, from their kernel
//! for light of the source, in a fraction of the cases ([`ABOUT_SOURCES`]). Such a branch is faint, and as
//! likely to go on as a bright one until it leaves the neighbourhood of the source.
//!
//! The balance heuristic uses the sum of the densities of both ways to sample a direction.

use papilio_optics::Beta;

use super::scatterers::ScatterEvent;
use crate::light::GOLDEN_SECTION;
use crate::{Cone, Source};

/// Fraction of the directions of a relay that are sampled from half way instead.
pub(super) const HALF_WAY: f64 = 0.5;

/// Mean number of directions about sources that an event of a path samples in addition.
pub(super) const ABOUT_SOURCES: f64 = 0.25;

/// Ratio of the kernel to its maximum above which it samples directions often enough by itself.
pub(super) const FAR: f64 = 0.05;

/// Largest number of points of a source, and ratio of a kernel at its edge to the maximum above which its
/// centre is enough.
const MOST_POINTS: f64 = 32.0;
const SMALL: f64 = 0.3;

/// Directions of light whose kernel an event also samples; usually none.
#[derive(Debug, Clone, Default)]
pub(super) struct Aims {
    directions: Vec<Beta>,
    /// Mean density at one of them.
    peak: f64,
}

impl Aims {
    /// Returns the directions half way that an event needs which relays light.
    pub(super) fn half_way(event: &ScatterEvent<'_>, view: Cone, sources: &[Source]) -> Self {
        let needed = |source: &Source| {
            let between = Between::of(event, view, source)?;
            between.is_gaussian().then_some(between.middle)
        };
        Self::new(sources.iter().filter_map(needed).collect(), event)
    }

    /// Returns the directions about sources that an event of a path needs.
    pub(super) fn about_sources(event: &ScatterEvent<'_>, view: Cone, sources: &[Source]) -> Self {
        let needed = |source: &Source| {
            let between = Between::of(event, view, source)?;
            let is_far = between.whole < FAR * between.largest && !between.is_gaussian();
            is_far.then(|| points(event, source)).flatten()
        };
        Self::new(sources.iter().filter_map(needed).flatten().collect(), event)
    }

    fn new(directions: Vec<Beta>, event: &ScatterEvent<'_>) -> Self {
        let peaks = directions.iter().filter_map(|aim| event.density(*aim, *aim));
        let peak = peaks.fold(0.0, f64::max) / directions.len().max(1) as f64;
        Self { directions, peak }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.directions.is_empty()
    }

    /// Chooses one of the directions, and replaces the number by one that is uniform again.
    pub(super) fn choose(&self, u: &mut f64) -> Option<Beta> {
        let place = *u * self.directions.len() as f64;
        *u = place.fract();
        self.directions.get(place as usize).copied()
    }

    /// Returns the mean density from these directions, given that from one; `None` if there are no directions.
    pub(super) fn density(&self, from: impl Fn(Beta) -> Option<f64>) -> Option<f64> {
        let sum: f64 = self.directions.iter().filter_map(|aim| from(*aim)).sum();
        (!self.is_empty()).then(|| sum / self.directions.len() as f64)
    }

    /// Returns how close to one of the directions a place of this density is, 0 to 1.
    pub(super) fn closeness(&self, density: f64) -> f64 {
        if self.peak > 0.0 { (density / self.peak).min(1.0) } else { 0.0 }
    }
}

/// The kernel of an event between the view and a source.
struct Between {
    middle: Beta,
    /// Its maximum, and its values from the source to the middle and to the view.
    largest: f64,
    half: f64,
    whole: f64,
}

impl Between {
    /// `None` if the source has no direction, or light leaves the event to two sides.
    fn of(event: &ScatterEvent<'_>, view: Cone, source: &Source) -> Option<Self> {
        let (view, from) = (view.axis_towards(), source.direction()?);
        let middle = Beta { x: 0.5 * (from.x + view.x), y: 0.5 * (from.y + view.y) };
        let largest = event.density(middle, middle)?;
        let [half, whole] = [event.density(from, middle)?, event.density(from, view)?];
        Some(Self { middle, largest, half, whole })
    }

    /// True if the kernel falls so fast that its product from both ends is largest in the middle, and is
    /// small there.
    fn is_gaussian(&self) -> bool {
        self.half < FAR * self.largest && self.half * self.half > self.largest * self.whole
    }
}

/// Returns points of a source such that kernels about them cover it.
fn points(event: &ScatterEvent<'_>, source: &Source) -> Option<Vec<Beta>> {
    let centre = source.direction()?;
    let Source::Disc(cone) = source else { return Some(vec![centre]) };
    let ratio = event.density(centre, centre)? / event.density(centre, -cone.sample_towards([1.0, 0.0]))?;
    if ratio.is_nan() || ratio * SMALL <= 1.0 {
        return Some(vec![centre]);
    }
    // Of a k-correlation lobe, 1 + (r/w)².
    let count = ratio.powf(2.0 / 3.0).min(MOST_POINTS).ceil();
    let point =
        |k: usize| -cone.sample_towards([(k as f64 + 0.5) / count, (k as f64 * GOLDEN_SECTION).fract()]);
    Some((0..count as usize).map(point).collect())
}
