//! Polarised light, and a polariser before the eye.
//!
//! # Method
//! Where all layers are flat and the pixel is a mirror, s and p are followed apart to the end
//! ([`Stack::with_polarisations`](crate::Stack::with_polarisations)). Each ray that is seen has weights of s and of p
//! ([`WholeView::weights`]), from the vibration of its light and the direction that the polariser passes. Those are fixed
//! to the lamp, the sky and the view, whereas near the normal the directions of s and p change from ray to ray.
//!
//! Where in addition diffusers keep polarisation, each of s and p has a weight in what is seen: for a lamp from its vibration in the mirror image, turned with
//! the light on the shortest way to the view ([`WholeView::kept_weights`]). A field has
//! the share of s or p of every direction instead, turned to the azimuth of the views.
//!
//! Elsewhere all that is polarised happens in the flat layers above the first scatterer, the *top*. With the shares f of
//! s and p, unpolarised light of g times the radiance, `g = (f_s T_s + f_p T_p)/T` with the mean T of the transmittances
//! of the top, has the same effect below it. What leaves is seen through a polariser as its share of T_s and T_p over
//! their mean. What the top mirrors, `f_s R_s + f_p R_p`, replaces what the unpolarised light would show: it
//! alone needs the direction of both, and is summed over the mirror images in the view.
//!
//! For a directed source g is the mean of its rays, at each wavelength; what leaves is seen as the mean of the rays of the view. For light from many directions it is that of each
//! direction, `1 + (f_s - f_p) D` with `D = (T_s - T_p)/(T_s + T_p)`, which changes with wavelength where the top is a
//! coating: sources with the D of few wavelengths, [`anchors`], are combined to that of each other one.

use std::borrow::Cow;
use std::f64::consts::SQRT_2;
use std::sync::Arc;

use papilio_optics::Beta;

use crate::front::Flat;
use crate::layers::{FlatRun, Incidence};
use crate::light::cone_points::{Nodes, Point, cone_points_of, smooth_at};
use crate::light::images::{Mirror, image_points};
use crate::light::polarised::light_of;
use crate::mueller::WholeView;
use crate::{Cone, Field, Medium, ReflectanceFactor, Source, Vibration};

/// Accuracy of mirror images in a top and of means over its rays, and the angle over which interfaces and pixels change, radians.
const FINE: (f64, Nodes) = (12.0, Nodes { rings: 0, across: 0.0 });
const SMOOTH: f64 = 0.3;

/// Number of steps of cos(theta) at which the top is tabulated for light from many directions.
const STEPS: usize = 2048;

/// Largest difference of (T_s - T_p)/(T_s + T_p) from the combination of those of other wavelengths.
const LARGEST_REST: f64 = 1e-6;

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

    /// What the layers mirror from above of s, of p, and of the product of both amplitudes.
    fn mirrors(&self, beta_squared: f64, bin: usize) -> [f64; 3] {
        let [above, below] = &self.media;
        let at = Incidence::between([above, below], bin, beta_squared);
        let [s, p] = self.run.of_each(&at);
        [s.above, p.above, self.run.crossed(&at).above.re]
    }

    /// Light of these rays that it transmits, over unpolarised light.
    fn transmits(&self, rays: &[Ray], bin: usize) -> f64 {
        let [mut light, mut unpolarised] = [0.0; 2];
        for Ray { beta_squared, weight, shares } in rays {
            let [s, p] = self.of_each(*beta_squared, bin).map(|flat| flat.t);
            light += weight * 2.0 * (shares[0] * s + shares[1] * p);
            unpolarised += weight * (s + p);
        }
        if unpolarised > 0.0 { light / unpolarised } else { 1.0 }
    }

    /// The transmittance of s less that of p, over their sum, at uniform steps of cos(theta).
    fn differences(&self, bin: usize) -> Vec<f64> {
        let at = |step: usize| {
            // At the horizon both vanish.
            let cosine = (step as f64).max(1e-3) / STEPS as f64;
            self.transmits(
                &[Ray { beta_squared: 1.0 - cosine * cosine, weight: 1.0, shares: [1.0, 0.0] }],
                bin,
            ) - 1.0
        };
        (0..=STEPS).map(at).collect()
    }
}

/// A ray of a lamp or a view in air.
struct Ray {
    beta_squared: f64,
    weight: f64,
    /// Of s and of p; their sum is 1 for light of unit intensity, also for unpolarised light behind a polariser.
    shares: [f64; 2],
}

/// Returns the rays of a polarised lamp.
fn rays_of(lamp: &Source, vibration: &Vibration) -> Option<Vec<Ray>> {
    let centre = lamp.direction()?;
    let ray = |beta: Beta, weight: f64| {
        let [p, s, ..] = light_of(vibration, Some(centre), beta);
        Ray { beta_squared: beta.squared(), weight, shares: [s, p] }
    };
    let cosine = |beta: Beta| (1.0 - beta.squared()).max(0.0).sqrt();
    Some(match lamp {
        Source::Disc(cone) => {
            let directions = cone.directions(0.0, FINE.0).into_iter();
            directions.map(|(beta, weight)| ray(-beta, weight * cosine(beta))).collect()
        }
        _ => vec![ray(centre, 1.0)],
    })
}

/// Returns few of these rows, and the weights with which they add up to each of the rows. The sum of the weights is 1.
fn anchors(rows: Vec<Vec<f64>>) -> Vec<(Vec<f64>, Vec<f64>)> {
    let Some(first) = rows.get(rows.len() / 2).cloned() else { return Vec::new() };
    let mut rest: Vec<Vec<f64>> =
        rows.iter().map(|row| row.iter().zip(&first).map(|(value, first)| value - first).collect()).collect();
    let mut chosen = vec![rows.len() / 2];
    // What is left of each chosen row but the first, as a sum of chosen rows; and how often it is in each row.
    let (mut left, mut times): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    let most = |row: &Vec<f64>| row.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    while let Some((next, off)) = rest.iter().map(most).enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))
        && off > LARGEST_REST
    {
        let direction = rest[next].clone();
        let square: f64 = direction.iter().map(|value| value * value).sum();
        let mut own = vec![0.0; chosen.len() + 1];
        (own[0], own[chosen.len()]) = (-1.0, 1.0);
        for (left, times) in left.iter().zip(&times) {
            own.iter_mut().zip(left).for_each(|(own, left)| *own -= times[next] * left);
        }
        let project = |row: &mut Vec<f64>| {
            let often = row.iter().zip(&direction).map(|(a, b)| a * b).sum::<f64>() / square;
            row.iter_mut().zip(&direction).for_each(|(value, direction)| *value -= often * direction);
            often
        };
        times.push(rest.iter_mut().map(project).collect());
        left.push(own);
        chosen.push(next);
    }
    let weights = |number: usize| {
        let of_row = |row: usize| {
            let sums =
                left.iter().zip(&times).filter_map(|(left, times)| Some(times[row] * left.get(number)?));
            sums.sum::<f64>() + if number == 0 { 1.0 } else { 0.0 }
        };
        (0..rows.len()).map(of_row).collect()
    };
    chosen.iter().enumerate().map(|(number, row)| (rows[*row].clone(), weights(number))).collect()
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
    /// Those of a field for s and for p, each with its irradiance over half of that of the field.
    OfEach(Box<[(Source, f64); 2]>),
    /// A lamp, of whose polarisation scatterers leave this fraction, once on its way in and once on its way out.
    Kept(f64),
    /// Those that together have the same effect below the top, each with a factor of each wavelength.
    BelowTop(Vec<(Source, Vec<f64>)>),
}

impl PolarisedLight {
    /// Returns a source for layers that keep s and p apart to the end, whose scatterers leave this fraction of polarisation, once on its way in or out.
    /// `analyser`: azimuth of the views, and the angle that a polariser before the eye passes, radians. `None` for light that is known by cells or pixels only.
    pub fn kept(whole: &Source, vibration: Vibration, left: f64, analyser: Option<[f64; 2]>) -> Option<Self> {
        let instead = match whole {
            Source::Field(field) => {
                let of = |number: usize| {
                    times(field, move |direction| kept_share(vibration, left, analyser, direction)[number])
                };
                Instead::OfEach(Box::new([of(0)?, of(1)?]))
            }
            Source::Diffuse => return None,
            Source::Beam(_) | Source::Disc(_) => Instead::Kept(left),
        };
        Some(Self { whole: whole.clone(), instead })
    }

    /// Returns a source above layers that scatter, at this number of wavelengths. `None` as of [`kept`](Self::kept).
    pub fn above(whole: &Source, vibration: Vibration, top: Option<&Top>, bins: usize) -> Option<Self> {
        let instead = match (whole, top) {
            (Source::Diffuse, _) => return None,
            (_, None) => vec![(whole.clone(), vec![1.0; bins])],
            (Source::Field(field), Some(top)) => {
                let source = |(table, weights): (Vec<f64>, Vec<f64>)| {
                    let factor = move |direction: [f64; 3]| {
                        let [s, p] = vibration.shares(direction);
                        let at = direction[2].clamp(0.0, 1.0) * STEPS as f64;
                        let first = (at as usize).min(STEPS - 1);
                        let share = at - first as f64;
                        1.0 + (s - p) * ((1.0 - share) * table[first] + share * table[first + 1])
                    };
                    let (source, irradiance) = times(field, factor)?;
                    Some((source, weights.into_iter().map(|weight| irradiance * weight).collect()))
                };
                let rows = (0..bins).map(|bin| top.differences(bin)).collect();
                anchors(rows).into_iter().map(source).collect::<Option<_>>()?
            }
            (Source::Beam(_) | Source::Disc(_), Some(top)) => {
                let rays = rays_of(whole, &vibration)?;
                let factor = |bin| top.transmits(&rays, bin);
                vec![(whole.clone(), (0..bins).map(factor).collect())]
            }
        };
        Some(Self { whole: whole.clone(), instead: Instead::BelowTop(instead) })
    }

    /// What has the same effect below the top.
    fn below_top(&self) -> &[(Source, Vec<f64>)] {
        match &self.instead {
            Instead::BelowTop(below) => below,
            Instead::OfEach(_) | Instead::Kept(_) => &[],
        }
    }
}

/// Returns the shares of s and of p in light that comes from this direction, twice, as a view sees it through scatterers that keep polarisation: as in the
/// mirror image, turned with the ray to the normal and on to the view. Between s and p both are the mean that the polariser passes. Without a polariser the
/// shares are those in the plane of incidence.
fn kept_share(vibration: Vibration, left: f64, analyser: Option<[f64; 2]>, direction: [f64; 3]) -> [f64; 2] {
    let Some([azimuth, angle]) = analyser else {
        return vibration.times(left).shares(direction).map(|share| 2.0 * share);
    };
    let beta = Beta { x: -direction[0], y: -direction[1] };
    let [p, s, crossed, _] = light_of(&vibration, None, beta);
    // Mirrors reflect s and p with opposite signs.
    let [aligned, oblique] = [p - s, -SQRT_2 * crossed].map(|one| left * one);
    let image = if beta.squared() > 0.0 { beta.y.atan2(beta.x) } else { 0.0 };
    let (sin, cos) = (2.0 * (image - azimuth)).sin_cos();
    let [aligned, oblique] = [aligned * cos - oblique * sin, aligned * sin + oblique * cos];
    let (sin, cos) = (2.0 * angle).sin_cos();
    if sin.abs() < 1e-9 {
        return [1.0 - aligned, 1.0 + aligned];
    }
    [1.0 + left * (aligned * cos + oblique * sin); 2]
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

    /// Returns the sources of unpolarised light instead of these: for s (0), for p (1), or below the top. There, more sources may follow,
    /// whose light [`Changes`] add.
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
                (Some(Instead::BelowTop(below)), None) => below[0].0.clone(),
                _ => source.clone(),
            }
        };
        let further = |(number, source): (usize, &Source)| {
            let below = self.of(number, source).map_or(&[][..], PolarisedLight::below_top);
            below.iter().skip(1).map(|(source, _)| source.clone()).collect::<Vec<_>>()
        };
        let all = sources.iter().enumerate();
        let further = all.clone().filter(|_| polarisation.is_none()).flat_map(further);
        Cow::Owned(all.map(one).chain(further).collect())
    }

    /// Returns the weights of s and of p in what a view sees of a source, given those of unpolarised light; without a view, in its mirror image.
    pub(crate) fn weights(
        &self,
        view: Option<&Cone>,
        (number, source): (usize, &Source),
        weights: [f64; 2],
    ) -> [f64; 2] {
        let instead = self.of(number, source).map(|light| &light.instead);
        match (instead, source.direction()) {
            (Some(Instead::OfEach(both)), _) => [weights[0] * both[0].1, weights[1] * both[1].1],
            (Some(Instead::Kept(left)), Some(centre)) => {
                self.seen.kept_weights(view, (number, centre), *left)
            }
            // They are those of each ray.
            _ if self.rays().is_some() => [1.0; 2],
            _ => weights,
        }
    }

    /// Returns what changes the light that a view sees of these sources below a top; `None` if nothing does.
    pub(crate) fn changes(&self, view: &Cone, sources: &[Source]) -> Option<Changes> {
        let bins = self.bins()?;
        let ray = |(beta, weight): (Beta, f64)| {
            let [p, s, ..] = self.seen.meter(Some(view), beta).map(|passed| 0.5 * passed);
            Ray { beta_squared: beta.squared(), weight, shares: [s, p] }
        };
        let rays: Vec<Ray> = view.directions(0.0, FINE.0).into_iter().map(ray).collect();
        let through = |bin: usize| self.top().map_or(1.0, |top| top.transmits(&rays, bin));
        let through: Vec<f64> = (0..bins).map(through).collect();
        let one = |(number, source): (usize, &Source)| {
            let of = self.of(number, source);
            if of.is_none() && self.seen.polariser.is_none() {
                return None;
            }
            let unpolarised = [(source.clone(), vec![1.0; bins])];
            let below = of.map(PolarisedLight::below_top).filter(|below| !below.is_empty());
            let below = below.unwrap_or(&unpolarised);
            let factor = |entering: &Vec<f64>| entering.iter().zip(&through).map(|(a, b)| a * b).collect();
            let factors: Vec<Vec<f64>> = below.iter().map(|(_, entering)| factor(entering)).collect();
            let mut mirrored = vec![0.0; bins];
            if let Some(top) = self.top() {
                let lit = (number, source.direction());
                for Point { beta, weight } in seen_in(view, source, FINE) {
                    let products = self.seen.products(Some(view), lit, beta);
                    for (bin, mirrored) in mirrored.iter_mut().enumerate() {
                        let mirrors = top.mirrors(beta.squared(), bin);
                        *mirrored += weight * products.iter().zip(mirrors).map(|(a, b)| a * b).sum::<f64>();
                    }
                }
                for ((source, _), factor) in below.iter().zip(&factors) {
                    for Point { beta, weight } in seen_in(view, source, FINE) {
                        for (bin, mirrored) in mirrored.iter_mut().enumerate() {
                            let mean = Flat::mean(top.of_each(beta.squared(), bin)).above;
                            *mirrored -= weight * factor[bin] * mean;
                        }
                    }
                }
            }
            Some(Change { factors, mirrored })
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
        // A directed source has one instead.
        let entering = self.of(number, source).and_then(|light| light.below_top().first());
        let seen = [Ray { beta_squared: beta.squared(), weight: 1.0, shares: top.weights }];
        let factor = |bin: usize| top.transmits(&seen, bin) * entering.map_or(1.0, |(_, factor)| factor[bin]);
        let products = self.seen.products(None, (number, Some(beta)), beta);
        for bin in 0..bins {
            let mirrors = top.mirrors(beta.squared(), bin);
            let rest = image.front[bin] - 0.5 * (mirrors[0] + mirrors[1]);
            let mirrored: f64 = products.iter().zip(mirrors).map(|(a, b)| a * b).sum();
            image.front[bin] = factor(bin) * rest + mirrored;
        }
        for (k, value) in image.via_pixel.iter_mut().enumerate() {
            *value *= factor(k % bins);
        }
        image
    }

    fn bins(&self) -> Option<usize> {
        let of_light = |light: &PolarisedLight| Some(light.below_top().first()?.1.len());
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

/// What changes the light that a view sees of each source.
#[derive(Debug)]
pub(crate) struct Changes(Vec<Option<Change>>);

#[derive(Debug)]
struct Change {
    /// Of the source and of each that follows for it, by wavelength.
    factors: Vec<Vec<f64>>,
    /// Light that the top mirrors in addition.
    mirrored: Vec<f64>,
}

impl Changes {
    /// Changes the light of all sources, which is then that of the polarised ones.
    pub(crate) fn apply(&self, rho: &mut Vec<ReflectanceFactor>) {
        let mut further = rho.split_off(self.0.len().min(rho.len())).into_iter();
        for (rho, change) in rho.iter_mut().zip(&self.0) {
            let Some(change) = change else { continue };
            let mut factors = change.factors.iter();
            if let Some(factor) = factors.next() {
                rho.scale(factor);
            }
            for (factor, mut other) in factors.zip(further.by_ref()) {
                other.scale(factor);
                rho.add(&other, 1.0);
            }
            rho.front.iter_mut().zip(&change.mirrored).for_each(|(value, more)| *value += more);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::anchors;

    /// Rows that are sums of three.
    #[test]
    fn few_rows_add_up_to_all() {
        let row = |k: usize| {
            let [a, b] = [(k as f64).sin(), (k as f64 * 0.7).cos()];
            (0..50).map(|x| f64::from(x) / 50.0).map(|x| 0.3 + a * x + b * x * x).collect::<Vec<f64>>()
        };
        let check = |rows: Vec<Vec<f64>>, count: usize| {
            let found = anchors(rows.clone());
            assert_eq!(found.len(), count);
            for (k, row) in rows.iter().enumerate() {
                assert!((found.iter().map(|(_, weights)| weights[k]).sum::<f64>() - 1.0).abs() < 1e-12);
                for (x, value) in row.iter().enumerate() {
                    let sum: f64 = found.iter().map(|(anchor, weights)| weights[k] * anchor[x]).sum();
                    assert!((sum - value).abs() < 1e-9, "row {k}, {x}: {sum} {value}");
                }
            }
        };
        check((0..31).map(row).collect(), 3);
        // Thirty independent rows.
        let wave = |k: usize| (0..400).map(|x| 0.5 * (0.1 * (k * x) as f64).sin()).collect::<Vec<f64>>();
        check((1..31).map(wave).collect(), 30);
        assert_eq!(anchors(vec![vec![0.5; 9]; 4]), [(vec![0.5; 9], vec![1.0; 4])]);
    }
}
