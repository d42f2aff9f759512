//! Light that is never scattered: its mirror images and its round trips, in closed form.

use std::sync::Arc;

use num_complex::Complex64;
use papilio_optics::Beta;
use papilio_optics::film::Polarisation;
use papilio_spectra::StateSpectra;

use crate::front::Flat;
use crate::layers::{Crossed, Incidence, LayerKind, fresnel_of};
use crate::light::images::{Mirror, image_points};
use crate::mueller::{Above, Factors, Orders, dot};
use crate::skeleton::{Ray, Skeleton};
use crate::{
    Base, Cone, Diffuser, Medium, Panel, PolarisedView, ReflectanceFactor, Reflector, Source, Stack, Top,
    WholeView,
};

/// Returns the specular reflectance of the whole display for light with these direction cosines,
/// `|beta| <= 1`: the luminance of its mirror image over its own.
pub fn specular_image(stack: &Stack, beta: Beta) -> ReflectanceFactor {
    let stack = stack.in_runs();
    if let Some([s, p]) = stack.polarised() {
        return specular_image(s, beta)
            .mixed_with(&specular_image(p, beta), stack.weights_of_polarisations());
    }
    stack.panel().map_or_else(|| layered_image(stack, beta), |panel| panel_image(panel, beta))
}

/// Returns [`specular_image`] for the light of a directed source, with its number among those of kernels: its
/// polarisation counts, and so does a polariser before the eye.
pub fn specular_image_of(stack: &Stack, number: usize, source: &Source) -> ReflectanceFactor {
    let beta = source.direction().unwrap_or_default();
    if stack.has_phase_matrix() {
        return image_of_stokes(stack, number, source, beta);
    }
    let whole = stack.in_runs();
    if let Some([s, p]) = whole.polarised() {
        let usual = whole.weights_of_polarisations();
        if let Some(seen) = stack.polarised_view().and_then(|view| view.rays()) {
            return image_of_ray([s, p], (seen, None), (number, source), beta);
        }
        let of_source = |view: &Arc<PolarisedView>| view.weights(None, (number, source), usual);
        let weights = stack.polarised_view().map_or(usual, of_source);
        return specular_image(s, beta).mixed_with(&specular_image(p, beta), weights);
    }
    if let Some(orders) = whole.panel().and_then(|panel| Orders::of(panel, beta)) {
        return orders.seen(None, number, Some(beta));
    }
    let image = specular_image(stack, beta);
    match stack.polarised_view() {
        Some(view) => view.image(number, source, image),
        None => image,
    }
}

/// Returns the mirror image of a ray with these direction cosines, in flat layers above a mirror, as a view sees it; without a view, through
/// a polariser in the frame of the ray itself.
fn image_of_ray(
    [s, p]: [&Stack; 2],
    (seen, view): (&WholeView, Option<&Cone>),
    (number, source): (usize, &Source),
    beta: Beta,
) -> ReflectanceFactor {
    let lit = (number, source.direction());
    let both = [s, p].map(|own| specular_image(own, beta));
    let Some(phases) = s.phases() else {
        return both[0].mixed_with(&both[1], seen.weights(view, lit, beta));
    };
    let [of_s, of_p, of_product] = seen.products(view, lit, beta);
    let mut image = both[0].mixed_with(&both[1], [of_s, of_p]);
    if of_product != 0.0 {
        image.add(&phases.image(beta), of_product);
    }
    image
}

/// Returns the mirror image of a source in layers whose polarised light is followed by its Stokes parameters: all orders of what
/// passes and mirrors regularly, for s, p and their product.
fn image_of_stokes(lit: &Stack, number: usize, source: &Source, beta: Beta) -> ReflectanceFactor {
    let (stack, base) = (lit.in_runs(), lit.base());
    let (bins, air) = (base.bins(), Medium::new(vec![1.0; base.bins()].into()));
    let whole = lit.polarised_view().and_then(|view| view.whole().cloned()).unwrap_or_default();
    let (meter, light) = (whole.meter(None, beta), whole.light(number, source.direction(), beta));
    let medium = stack.layers().last().map_or(&air, |layer| &layer.medium);
    let of = |base: &Base| {
        let mut all = vec![0.0; base.states() * bins];
        if base.is_specular() {
            base.reflectance_towards(beta, medium, &mut all);
        }
        all
    };
    let mirrors = lit.mirrors_of_each();
    let [s, p] = mirrors.map_or_else(|| [of(base), of(base)], |mirrors| mirrors.both.each_ref().map(of));
    let products = mirrors.and_then(|mirrors| Some(mirrors.products.as_ref()?.each_ref().map(of)));
    let product = |k: usize| match &products {
        Some([re, im]) => Complex64::new(re[k], im[k]),
        // As a mirror of metal.
        None => Complex64::new(-(s[k] * p[k]).max(0.0).sqrt(), 0.0),
    };
    let seen = |bin: usize, [s, p]: [f64; 2], product: Complex64| {
        let mirror = |r: f64| Flat { t: 0.0, above: r, below: r };
        let crossed = Crossed { t: Complex64::ZERO, above: product, below: product };
        let mut below = ([mirror(s), mirror(p)], crossed);
        for (number, layer) in stack.layers().iter().enumerate().rev() {
            let above = number.checked_sub(1).map_or(&air, |above| &stack.layers()[above].medium);
            let passes = layer.medium.regular(&Incidence::between([&layer.medium; 2], bin, beta.squared()));
            let ([s, p], crossed) =
                layer.interface.of_each(&Incidence::between([above, &layer.medium], bin, beta.squared()));
            let ([below_s, below_p], below_crossed) = below;
            let all = |own: Flat, below: Flat| own.over(passes).over(below);
            let crossed = crossed.over(Crossed::of_both(passes, 1.0)).over(below_crossed);
            below = ([all(s, below_s), all(p, below_p)], crossed);
        }
        let ([s, p], crossed) = below;
        dot(meter, Factors { p: p.above, s: s.above, crossed: crossed.above }.of(light))
    };
    let front: Vec<f64> = (0..bins).map(|bin| seen(bin, [0.0; 2], Complex64::ZERO)).collect();
    let via = |k: usize| seen(k % bins, [s[k], p[k]], product(k)) - front[k % bins];
    ReflectanceFactor { via_pixel: StateSpectra::new((0..s.len()).map(via).collect(), bins), front }
}

/// Returns [`specular_image`] in a view for light of the source of this number, whose centre has these direction cosines.
pub(crate) fn image_in(
    stack: &Stack,
    view: &Cone,
    (number, centre): (usize, Option<Beta>),
    beta: Beta,
) -> ReflectanceFactor {
    match stack.panel().and_then(|panel| Orders::of(panel, beta)) {
        Some(orders) => orders.seen(Some(view), number, centre),
        None => specular_image(stack, beta),
    }
}

/// Returns the mirror image of a round source, with its number among those of kernels, in a field of view, as a reflectance factor:
/// [`specular_image`] times the light of the source in the view. 0 where the view does not look into the image.
pub fn disc_image(stack: &Stack, view: &Cone, (number, disc): (usize, &Cone)) -> ReflectanceFactor {
    let (bins, states) = (stack.base().bins(), stack.base().states());
    let source = Source::Disc(*disc);
    let mut sum = ReflectanceFactor::zeros(states, bins);
    for image in
        image_points(view, std::slice::from_ref(&source), DIGITS, Mirror::Across(across(stack, view)))
    {
        for point in &image.points {
            let seen = stack.polarised_view().and_then(|view| view.rays());
            let image = match (stack.in_runs().polarised(), seen) {
                (Some([s, p]), Some(seen)) => {
                    image_of_ray([s, p], (seen, Some(view)), (number, &source), point.beta)
                }
                _ => specular_image(stack, point.beta),
            };
            sum.add(&image, point.weight);
        }
    }
    sum
}

/// Accuracy of the image of a disc.
const DIGITS: f64 = 12.0;

/// Number of nodes of the base's table across a view.
fn across(stack: &Stack, view: &Cone) -> f64 {
    stack.panel().map_or(0.0, |panel| panel.base.nodes_across(view, &panel.medium))
}

/// [`specular_image`] of general layers: the reflection of their specular skeleton.
pub(crate) fn layered_image(stack: &Stack, beta: Beta) -> ReflectanceFactor {
    let mut skeleton = Skeleton::new(stack, stack.base());
    skeleton.set(stack, stack.base(), beta);
    let mut field = skeleton.field();
    skeleton.emit(Ray::ENTERING, &mut field);
    let (front, risen) = field.at(Ray::LEAVING);
    let base = field.rising.iter().enumerate().map(|(k, rising)| rising * risen[k % risen.len()]);
    let bins = stack.base().bins();
    let front = front.iter().copied().cycle().take(bins).collect();
    ReflectanceFactor { via_pixel: StateSpectra::new(base.collect(), bins), front }
}

/// [`specular_image`] of a panel.
pub(crate) fn panel_image(stack: &Panel, beta: Beta) -> ReflectanceFactor {
    if let Some(orders) = Orders::of(stack, beta) {
        // Of no source in particular: unpolarised light.
        return orders.seen(None, usize::MAX, None);
    }
    let base = &stack.base;
    let mut flat_top = FlatTop::new(base.bins());
    flat_top.set(stack, beta.squared());
    let mut r = StateSpectra::zeros(base.states(), base.bins());
    match &base.reflector {
        Reflector::Specular(_) => base.reflectance_towards(beta, &stack.medium, &mut r),
        Reflector::Lambertian(_) | Reflector::Scattering(_) => {}
    }
    let flat = |bin: usize| match &stack.top {
        Top::Diffuser(_) => stack.front.at(bin),
        Top::IdealAr | Top::Fresnel(_) => flat_top.at(bin),
    };
    for (k, value) in r.iter_mut().enumerate() {
        let flat = flat(k % base.bins());
        let below = match &stack.top {
            Top::Diffuser(d) => (d.regular_fraction * d.transmittance[k % base.bins()]).powi(2) * *value,
            Top::IdealAr | Top::Fresnel(_) => *value,
        };
        *value = flat.t * flat.t * below * round_trip(stack, flat.below * below);
    }
    ReflectanceFactor { via_pixel: r, front: (0..base.bins()).map(|bin| flat(bin).above).collect() }
}

/// Sums all orders of a round trip that preserves this fraction of the light.
fn round_trip(stack: &Panel, share: f64) -> f64 {
    if stack.single_pass { 1.0 } else { 1.0 / (1.0 - share) }
}

/// Sums all orders of the round trip front from below, unscattered down, base, unscattered up, as a factor
/// on a beam that arrives at the diffuser; `r` is the reflectance of the base for the beam.
pub(crate) fn round_trips(stack: &Panel, diffuser: &Diffuser, r: &[f64]) -> Vec<f64> {
    let bins = diffuser.transmittance.len();
    let one = |(k, r): (usize, &f64)| {
        let bin = k % bins;
        let there_and_back = (diffuser.regular_fraction * diffuser.transmittance[bin]).powi(2) * r;
        round_trip(stack, there_and_back * stack.front.reflectance_below[bin])
    };
    r.iter().enumerate().map(one).collect()
}

/// Front and surface of a bare panel as one flat part, at one angle.
#[derive(Debug, Clone)]
pub(crate) struct FlatTop {
    /// Shape `[wavelength]`, as in [`Flat`].
    pub(crate) t: Vec<f64>,
    pub(crate) above: Vec<f64>,
    pub(crate) below: Vec<f64>,
}

impl FlatTop {
    pub(crate) fn new(bins: usize) -> Self {
        Self { t: vec![0.0; bins], above: vec![0.0; bins], below: vec![0.0; bins] }
    }

    fn at(&self, bin: usize) -> Flat {
        Flat { t: self.t[bin], above: self.above[bin], below: self.below[bin] }
    }

    /// Sets the values for the surface alone.
    pub(crate) fn set_surface(&mut self, stack: &Panel, beta_squared: f64) {
        for bin in 0..self.t.len() {
            let face = face(stack, stack.polarisation, beta_squared, bin);
            (self.t[bin], self.above[bin], self.below[bin]) = (face.t, face.above, face.below);
        }
    }

    /// Sets the values for the stack's front and surface at this angle.
    ///
    /// Of a pixel that changes polarisation, see [`Orders::set`].
    pub(crate) fn set(&mut self, stack: &Panel, beta_squared: f64) {
        if let Some(run) = &stack.run {
            let of = |bin| Above::mean_of_run(run, &stack.medium, beta_squared, bin);
            let is_clear = stack.medium.transmittance().is_none() && stack.medium.constant_index().is_some();
            let always = (is_clear && run.is_colourless()).then(|| of(0));
            for bin in 0..self.t.len() {
                let both = always.unwrap_or_else(|| of(bin));
                (self.t[bin], self.above[bin], self.below[bin]) = (both.t, both.above, both.below);
            }
            return;
        }
        let is_constant = !matches!(&stack.top, Top::Fresnel(index) if !index.is_constant());
        let polarisations = stack.polarisations();
        let faces = |bin: usize| {
            let of = |number: usize| face(stack, polarisations[number], beta_squared, bin);
            let first = of(0);
            [first, if polarisations.len() > 1 { of(1) } else { first }]
        };
        let first = faces(0);
        for bin in 0..self.t.len() {
            let faces = if is_constant { first } else { faces(bin) };
            let front = stack.front.at(bin);
            let below = |face: Flat| if stack.single_pass { front.once_over(face) } else { front.over(face) };
            let both = if polarisations.len() > 1 { Flat::mean(faces.map(below)) } else { below(faces[0]) };
            (self.t[bin], self.above[bin], self.below[bin]) = (both.t, both.above, both.below);
        }
    }
}

/// Returns the surface of a bare panel for light of a polarisation, at one angle and wavelength.
#[inline]
fn face(stack: &Panel, polarisation: Option<Polarisation>, beta_squared: f64, bin: usize) -> Flat {
    match &stack.top {
        Top::Fresnel(index) if beta_squared <= 1.0 => {
            let r = fresnel_of(polarisation, [1.0, index[bin]], beta_squared.sqrt());
            Flat { t: 1.0 - r, above: r, below: r }
        }
        _ if beta_squared <= 1.0 => Flat { t: 1.0, above: 0.0, below: 0.0 },
        _ => Flat { t: 0.0, above: 1.0, below: 1.0 },
    }
}
