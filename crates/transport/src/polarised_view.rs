//! Polarised light, and a polariser before the eye.
//!
//! # Method
//! Where all layers are flat and the pixel is a mirror, s and p are followed apart to the end
//! ([`Stack::with_polarisations`](crate::Stack::with_polarisations)). Each ray that is seen has weights of s and of p
//! ([`WholeView::weights`]), from the vibration of its light and the direction that the polariser passes. Those are fixed
//! to the lamp, the sky and the view, whereas near the normal the directions of s and p change from ray to ray.
//!
//! Where in addition diffusers keep s and p, each has sources of its own, the share of s or p of every direction, and a
//! weight in what is seen.
//!
//! Elsewhere all that is polarised happens in the flat layers above the first scatterer, the *top*. With the shares f of
//! s and p, unpolarised light of g times the radiance, `g = (f_s T_s + f_p T_p)/T` with the mean T of the transmittances
//! of the top, has the same effect below it. What leaves is seen through a polariser as its share of T_s and T_p over
//! their mean. What the top mirrors, `f_s R_s + f_p R_p`, replaces what the unpolarised light would show: it
//! alone needs the direction of both, and is summed over the mirror images in the view.
//!
//! For a directed source g is that of its centre, at each wavelength; for light from many directions it is that of each
//! direction, with the mean over wavelengths of (T_s - T_p)/(T_s + T_p), weighted by V(lambda).

use std::borrow::Cow;
use std::sync::Arc;

use papilio_spectra::Spectrum;

use crate::front::Flat;
use crate::layers::{FlatRun, Incidence};
use crate::light::cone_points::{Nodes, Point, cone_points_of, smooth_at};
use crate::light::images::{Mirror, image_points};
use crate::mueller::WholeView;
use crate::{Cone, Field, Medium, ReflectanceFactor, Source, Vibration};

/// Accuracy of mirror images in a top, and the angle over which interfaces and pixels change, radians.
const FINE: (f64, Nodes) = (12.0, Nodes { rings: 0, across: 0.0 });
const SMOOTH: f64 = 0.3;

/// Number of steps of cos(theta) at which the top is tabulated for light from many directions.
const STEPS: usize = 2048;

/// Flat layers above the first scatterer, and what a polariser before the eye passes of s and of p.
#[derive(Debug, Clone)]
pub struct Top {
    run: FlatRun,
    /// Above and below.
    media: [Medium; 2],
    /// Weights of s and p in what is seen; their sum is 1.
    weights: [f64; 2],
}

impl Top {
    /// Returns the top of these flat layers, in air above this medium.
    pub fn new(run: FlatRun, below: Medium, weights: [f64; 2]) -> Self {
        let air = Medium::new(vec![1.0; below.index().len()].into());
        Self { run, media: [air, below], weights }
    }

    /// The layers for s and for p.
    fn of_each(&self, beta_squared: f64, bin: usize) -> [Flat; 2] {
        let [above, below] = &self.media;
        self.run.of_each(&Incidence::between([above, below], bin, beta_squared))
    }

    /// Light with these shares that it transmits, over unpolarised light.
    fn transmits(&self, beta_squared: f64, bin: usize, shares: [f64; 2]) -> f64 {
        let [s, p] = self.of_each(beta_squared, bin).map(|flat| flat.t);
        if s + p > 0.0 { 2.0 * (shares[0] * s + shares[1] * p) / (s + p) } else { 1.0 }
    }

    /// The transmittance of s less that of p, over their sum, at even steps of cos(theta): the mean over wavelengths.
    fn differences(&self, visible: &Spectrum) -> Vec<f64> {
        let whole: f64 = visible.iter().sum();
        let at = |step: usize| {
            // At the horizon both vanish.
            let cosine = (step as f64).max(1e-3) / STEPS as f64;
            let of = |bin: usize| self.transmits(1.0 - cosine * cosine, bin, [1.0, 0.0]) - 1.0;
            visible.iter().enumerate().filter(|(_, v)| **v > 0.0).map(|(bin, v)| v * of(bin)).sum::<f64>()
                / whole
        };
        (0..=STEPS).map(at).collect()
    }
}

/// A source whose light is polarised.
#[derive(Debug, Clone, PartialEq)]
pub struct PolarisedLight {
    /// The source without regard to that.
    whole: Source,
    instead: Instead,
}

/// Unpolarised light instead of a polarised source.
#[derive(Debug, Clone, PartialEq)]
enum Instead {
    /// For s and for p, each with its irradiance over half of that of the source.
    OfEach(Box<[(Source, f64); 2]>),
    /// That with the same effect below the top, with a factor of each wavelength.
    BelowTop(Box<(Source, Vec<f64>)>),
}

impl PolarisedLight {
    /// Returns a source for layers that keep s and p apart to the end. `None` for light that is known by cells or
    /// pixels only.
    pub fn kept(whole: &Source, vibration: Vibration) -> Option<Self> {
        let of = |number: usize| match whole {
            Source::Field(field) => times(field, move |direction| 2.0 * vibration.shares(direction)[number]),
            Source::Diffuse => None,
            Source::Beam(_) | Source::Disc(_) => {
                let beta = whole.direction()?;
                Some((whole.clone(), 2.0 * vibration.shares_towards(beta)[number]))
            }
        };
        let instead = Instead::OfEach(Box::new([of(0)?, of(1)?]));
        Some(Self { whole: whole.clone(), instead })
    }

    /// Returns a source above layers that scatter; `visible` weights the wavelengths. `None` as of
    /// [`kept`](Self::kept).
    pub fn above(
        whole: &Source,
        vibration: Vibration,
        top: Option<&Top>,
        visible: &Spectrum,
    ) -> Option<Self> {
        let instead = match (whole, top) {
            (Source::Diffuse, _) => return None,
            (_, None) => (whole.clone(), vec![1.0; visible.len()]),
            (Source::Field(field), Some(top)) => {
                let table = top.differences(visible);
                let factor = move |direction: [f64; 3]| {
                    let [s, p] = vibration.shares(direction);
                    let at = direction[2].clamp(0.0, 1.0) * STEPS as f64;
                    let first = (at as usize).min(STEPS - 1);
                    let share = at - first as f64;
                    1.0 + (s - p) * ((1.0 - share) * table[first] + share * table[first + 1])
                };
                let (source, weight) = times(field, factor)?;
                (source, vec![weight; visible.len()])
            }
            (Source::Beam(_) | Source::Disc(_), Some(top)) => {
                let beta = whole.direction()?;
                let shares = vibration.shares_towards(beta);
                let factor = |bin| top.transmits(beta.squared(), bin, shares);
                (whole.clone(), (0..visible.len()).map(factor).collect())
            }
        };
        Some(Self { whole: whole.clone(), instead: Instead::BelowTop(Box::new(instead)) })
    }
}

/// Returns the light of a field times a factor, and its irradiance over that of the field.
fn times(field: &Field, factor: impl Fn([f64; 3]) -> f64 + Send + Sync + 'static) -> Option<(Source, f64)> {
    match field.times(Arc::new(factor))? {
        (Some(field), irradiance) => Some((Source::Field(Arc::new(field)), irradiance)),
        // No light is left of a polarisation that the field does not have.
        (None, _) => Some((Source::Diffuse, 0.0)),
    }
}

/// Sources that are polarised, a polariser before the eye, and what is followed of their light.
#[derive(Debug, Clone)]
pub struct PolarisedView {
    /// What is polarised.
    pub seen: WholeView,
    /// What is followed.
    pub followed: Followed,
}

/// What is followed of polarised light.
#[derive(Debug, Clone)]
pub enum Followed {
    /// All of it, through pixels that change polarisation, and among particles.
    Whole,
    /// The rays that are seen in flat layers above a mirror.
    Rays,
    /// The polarised sources, by their number: to the end, or through the flat layers above the first scatterer.
    Lights(Vec<Option<PolarisedLight>>, Option<Box<Top>>),
}

impl PolarisedView {
    /// What is polarised, if all of it is followed.
    pub(crate) fn whole(&self) -> Option<&WholeView> {
        matches!(self.followed, Followed::Whole).then_some(&self.seen)
    }

    /// What is polarised, if the rays in flat layers above a mirror are followed.
    pub(crate) fn rays(&self) -> Option<&WholeView> {
        matches!(self.followed, Followed::Rays).then_some(&self.seen)
    }

    fn lights(&self) -> &[Option<PolarisedLight>] {
        match &self.followed {
            Followed::Lights(lights, _) => lights,
            Followed::Whole | Followed::Rays => &[],
        }
    }

    fn top(&self) -> Option<&Top> {
        match &self.followed {
            Followed::Lights(_, top) => top.as_deref(),
            Followed::Whole | Followed::Rays => None,
        }
    }

    /// The polarised light of a source.
    fn of(&self, number: usize, source: &Source) -> Option<&PolarisedLight> {
        self.lights().get(number)?.as_ref().filter(|light| light.whole == *source)
    }

    /// Returns the sources of unpolarised light instead of these: for s (0), for p (1), or below the top.
    pub(crate) fn sources<'a>(
        &self,
        sources: &'a [Source],
        polarisation: Option<usize>,
    ) -> Cow<'a, [Source]> {
        if self.lights().iter().all(Option::is_none) {
            return Cow::Borrowed(sources);
        }
        let one = |(number, source): (usize, &Source)| {
            let instead = self.of(number, source).map(|light| &light.instead);
            match (instead, polarisation) {
                (Some(Instead::OfEach(both)), Some(polarisation)) => both[polarisation].0.clone(),
                (Some(Instead::BelowTop(below)), None) => below.0.clone(),
                _ => source.clone(),
            }
        };
        Cow::Owned(sources.iter().enumerate().map(one).collect())
    }

    /// Returns the weights of s and of p in what is seen of a source, given those of unpolarised light.
    pub(crate) fn weights(&self, number: usize, source: &Source, weights: [f64; 2]) -> [f64; 2] {
        match self.of(number, source).map(|light| &light.instead) {
            Some(Instead::OfEach(both)) => [weights[0] * both[0].1, weights[1] * both[1].1],
            // They are those of each ray.
            _ if self.rays().is_some() => [1.0; 2],
            _ => weights,
        }
    }

    /// Returns what changes the light that a view sees of these sources below a top; `None` if nothing does.
    pub(crate) fn changes(&self, view: &Cone, sources: &[Source]) -> Option<Changes> {
        let bins = self.bins()?;
        let weights = self.top().map_or([0.5; 2], |top| top.weights);
        let one = |(number, source): (usize, &Source)| {
            let of = self.of(number, source);
            if of.is_none() && self.seen.polariser.is_none() {
                return None;
            }
            let axis = view.axis_towards();
            let through =
                |bin: usize| self.top().map_or(1.0, |top| top.transmits(axis.squared(), bin, weights));
            let (below, entering) = match of.map(|light| &light.instead) {
                Some(Instead::BelowTop(below)) => (&below.0, Some(&below.1)),
                _ => (source, None),
            };
            let factor: Vec<f64> =
                (0..bins).map(|bin| through(bin) * entering.map_or(1.0, |factor| factor[bin])).collect();
            let mut front = vec![0.0; bins];
            if let Some(top) = self.top() {
                let lit = (number, source.direction());
                for Point { beta, weight } in seen_in(view, source, FINE) {
                    let [s, p] = self.seen.weights(Some(view), lit, beta);
                    for (bin, front) in front.iter_mut().enumerate() {
                        let [of_s, of_p] = top.of_each(beta.squared(), bin);
                        *front += weight * (s * of_s.above + p * of_p.above);
                    }
                }
                for Point { beta, weight } in seen_in(view, below, FINE) {
                    for (bin, front) in front.iter_mut().enumerate() {
                        *front -= weight * factor[bin] * Flat::mean(top.of_each(beta.squared(), bin)).above;
                    }
                }
            }
            Some((factor, front))
        };
        Some(Changes(sources.iter().enumerate().map(one).collect()))
    }

    /// Returns the mirror image of a directed source, given that of unpolarised light.
    pub(crate) fn image(
        &self,
        number: usize,
        source: &Source,
        mut image: ReflectanceFactor,
    ) -> ReflectanceFactor {
        let (Some(top), Some(beta)) = (self.top(), source.direction()) else { return image };
        let bins = image.front.len();
        let entering = match self.of(number, source).map(|light| &light.instead) {
            Some(Instead::BelowTop(below)) => Some(&below.1),
            _ => None,
        };
        let factor = |bin: usize| {
            top.transmits(beta.squared(), bin, top.weights) * entering.map_or(1.0, |factor| factor[bin])
        };
        let [s, p] = self.seen.weights(None, (number, Some(beta)), beta);
        for bin in 0..bins {
            let both = top.of_each(beta.squared(), bin);
            let rest = image.front[bin] - Flat::mean(both).above;
            image.front[bin] = factor(bin) * rest + s * both[0].above + p * both[1].above;
        }
        for (k, value) in image.via_pixel.iter_mut().enumerate() {
            *value *= factor(k % bins);
        }
        image
    }

    fn bins(&self) -> Option<usize> {
        let of_light = |light: &PolarisedLight| match &light.instead {
            Instead::BelowTop(below) => Some(below.1.len()),
            Instead::OfEach(_) => None,
        };
        let top = self.top().map(|top| top.media[1].index().len());
        top.or_else(|| self.lights().iter().flatten().find_map(of_light))
    }
}

/// Returns the points of the mirror image of a source in a view: for these digits, and a mirror with this many nodes across the view.
pub(crate) fn seen_in(view: &Cone, source: &Source, (digits, nodes): (f64, Nodes)) -> Vec<Point> {
    match source {
        Source::Diffuse => cone_points_of(view, smooth_at(view, SMOOTH), digits, nodes),
        Source::Beam(_) | Source::Disc(_) | Source::Field(_) => {
            let images =
                image_points(view, std::slice::from_ref(source), digits, Mirror::Across(nodes.across));
            images.into_iter().flat_map(|image| image.points).collect()
        }
    }
}

/// What changes the light that a view sees: for each source a factor of each wavelength, and light that the top mirrors
/// in addition.
#[derive(Debug)]
pub(crate) struct Changes(Vec<Option<(Vec<f64>, Vec<f64>)>>);

impl Changes {
    /// Changes the light of all sources.
    pub(crate) fn apply(&self, rho: &mut [ReflectanceFactor]) {
        for (rho, change) in rho.iter_mut().zip(&self.0) {
            let Some((factor, front)) = change else { continue };
            let bins = factor.len();
            rho.via_pixel.iter_mut().enumerate().for_each(|(k, value)| *value *= factor[k % bins]);
            for ((value, factor), more) in rho.front.iter_mut().zip(factor).zip(front) {
                *value = *value * factor + more;
            }
        }
    }
}
