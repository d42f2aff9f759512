//! Where light of s and of p is kept apart.
//!
//! All faces are parallel: s stays s, and p stays p, until something scatters the light, which then counts as
//! unpolarised. Therefore
//!
//! - above a mirror-like pixel, where nothing scatters, or only diffusers that keep polarisation do (`depolarisation = 0`), the whole display is computed for s
//!   and for p ([`weights`], [`Stack::with_polarisations`]), and a polariser before the eye chooses between them; where nothing scatters, also light with
//!   its places ([`of_places`]);
//! - elsewhere each run of flat layers that begins and ends with the air or a scatterer is one interface
//!   ([`FlatRun`]) of light without regard to places; the run between the last scatterer and a mirror is one together
//!   with the mirror. Polarised light and a polariser before the eye concern the run at the top alone ([`view`]).
//!
//! - above a liquid crystal, below flat layers alone, the whole coherency matrix of light is followed ([`is_whole`],
//!   [`Mueller`](papilio_transport::Mueller));
//! - in slabs of particles, the Stokes parameters of all light are followed by paths ([`check_particles`]).
//!
//! Where light meets one face only, the mean of s and p is exact, and nothing is done. That is so for ordinary panels
//! of paper below a face, unless a sheet above reflects light back to it: sheets, given by their reflectance, are the
//! same for both, but what they return to the face has its shares of s and p, which such a panel keeps
//! ([`Stack::with_layers_of_each`]).

use std::ops::Range;

use papilio_optics::film::{Coating, Polarisation};
use papilio_spectra::Spectrum;
use papilio_transport::{
    Base, FlatRun, Followed, Interface, Layer, Medium, Phases, PolarisedLight, PolarisedTop as Top,
    PolarisedView, Source, Stack, WholeView,
};

use crate::DisplayError;
use crate::scene::{
    self, AngleMedium, Approximation, Method, Pixel, Ready, Scene, UniformKind, UniformPixel, Vibration,
};

/// What polarised light needs where the display has a colour filter.
const NO_FILTER: &str = "a display without a colour filter, or mirrors below flat layers: other polarised light from outside is not followed through one";

/// What polarised light needs where the phase between s and p is not followed.
const NO_PHASE: &str = "viewer.polariser \"s\" or \"p\", or lamps of angle_deg 0 or 90 alone: between s and p, what is seen of polarised light depends on their \
                        phases, which `papilio run`, `cone` and `sweep` follow in flat layers without a colour filter";

/// What a polariser needs where a polarised sky is seen through a diffuser that keeps polarisation.
const ONE_PLANE: &str = "views in one plane (one viewer.phi_deg): through a diffuser that keeps polarisation, a polarised sky is seen for one azimuth at a time";

/// Field of view up to which the phase between s and p does not matter otherwise (3e-4 of a silver film in a polarised sky), degrees.
const NARROW_DEG: f64 = 5.0;

/// What particles need of a computation.
pub(crate) const PATHS: &str = "`papilio run` (or `sweep`, `optimize`) by method = \"monte-carlo\" (or \"auto\"): adding, and whatever computes places of light, maps, \
                                BSDFs or derivatives, takes scattered light as unpolarised";

/// Returns whether a slab of a display has particles whose polarised light is followed.
pub(crate) fn has_particles(scene: &Scene) -> bool {
    scene.display.layers.iter().any(|layer| layer.medium.particles.is_some())
}

/// Refuses slabs of particles where their polarised light is not followed. `is_run`: the colours of views are computed, by the scene's method.
pub(crate) fn check_particles(scene: &Scene, is_run: bool) -> Result<(), DisplayError> {
    let needs = if !has_particles(scene) {
        return Ok(());
    } else if !is_run || scene.solver.method == Method::Adding {
        PATHS
    } else if !is_followed(scene) {
        "solver.approximation = \"none\" and angles in air or glass: other light has no polarisation"
    } else if scene.display.filter().is_some() {
        "a display without a colour filter: polarised light is not followed through one"
    } else if matches!(scene.display.pixel, Pixel::Crystal(_)) {
        "another pixel than a liquid crystal, whose changes of polarisation are not followed below a scatterer"
    } else {
        return Ok(());
    };
    Err(DisplayError::Particles { needs })
}

/// What of a scene is polarised.
struct Asked {
    /// The first key that says so.
    key: String,
    /// A polariser before the eye.
    polariser_deg: Option<f64>,
    /// By the number of the source.
    vibrations: Vec<Option<Vibration>>,
}

impl Asked {
    /// `None` if nothing is polarised.
    fn of(scene: &Scene) -> Option<Self> {
        let polariser_deg = scene.viewer.polariser_deg;
        let mut key = polariser_deg.map(|_| "viewer.polariser".to_owned());
        // The first source is the diffuse light.
        let mut vibrations = vec![None];
        for (place, vibration) in scene.lighting.vibrations() {
            if vibration.is_some() {
                key.get_or_insert(place);
            }
            vibrations.push(vibration);
        }
        Some(Self { key: key?, polariser_deg, vibrations })
    }

    /// Refuses what is not followed.
    fn check(self, scene: &Scene) -> Result<Self, DisplayError> {
        let why = if !is_followed(scene) {
            "solver.approximation = \"none\" and angles in air or glass: other light does not keep s and p apart"
        } else if scene.display.filter().is_some() && !is_flat_mirror(scene) {
            NO_FILTER
        } else {
            return Ok(self);
        };
        Err(DisplayError::Polarised { key: self.key, needs: why })
    }

    /// Returns whether light between s and p is seen through a polariser between them.
    fn mixes(&self) -> bool {
        self.polariser_deg.is_some_and(is_oblique) && self.vibrations.iter().flatten().any(is_between_s_and_p)
    }

    /// Vibrations of the sources of a scene. Along the normal, the plane of incidence is that of the azimuth of a lamp.
    fn vibrations_of(&self, scene: &Scene) -> Vec<Option<Vibration>> {
        let mut all = self.vibrations.clone();
        for (vibration, lamp) in all[1..].iter_mut().zip(&scene.lighting.directed) {
            if let (Some(Vibration::Fixed { angle, .. }), 0.0) = (vibration, lamp.theta_deg) {
                *angle += lamp.phi_deg.to_radians();
            }
        }
        all
    }

    /// Weights of s and p in what is seen of unpolarised light.
    fn weights(&self) -> [f64; 2] {
        self.polariser_deg.map_or([0.5; 2], |angle_deg| {
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            [sin * sin, cos * cos]
        })
    }
}

/// Returns whether this angle from the plane of incidence is that of neither p nor s.
pub(crate) fn is_oblique(angle_deg: f64) -> bool {
    (2.0 * angle_deg.to_radians()).sin().abs() > 1e-9
}

/// Returns whether light vibrates between s and p.
pub(crate) fn is_between_s_and_p(vibration: &Vibration) -> bool {
    match vibration {
        Vibration::Fixed { angle, .. } => is_oblique(angle.to_degrees()),
        Vibration::Rayleigh { .. } => true,
    }
}

/// Refuses scatterers that keep s and p where they are not followed.
fn check_scatterers(scene: &Scene) -> Result<(), DisplayError> {
    let layers = &scene.display.layers;
    let Some(keeper) =
        layers.iter().find(|layer| !is_flat(&layer.interface) && layer.depolarisation.fraction < 1.0)
    else {
        return Ok(());
    };
    let depolarises = |layer: &scene::Layer| {
        layer.medium.scattering.is_some()
            || !is_flat(&layer.interface) && layer.depolarisation.fraction != keeper.depolarisation.fraction
    };
    let needs = if scene.solver.approximation == Approximation::Unpolarised {
        return Ok(());
    } else if !is_followed(scene) {
        "solver.approximation = \"none\" (or \"unpolarised\") and angles in air or glass: other light does not keep s and p apart"
    } else if keeper.depolarisation.fraction > 0.0 && !is_met_twice(layers) {
        "a value of 0 or 1, or one diffuser with a lobe (model \"k-correlation\" or \"lambertian\", regular_fraction = 0, no reflection) below \
         nothing that reflects: light that returns to it again and again, polarised in part, is not followed"
    } else if layers.iter().any(depolarises) {
        "no other scatterer than those of `depolarisation` = 0: s and p are kept to the end or to the first scatterer"
    } else if scene.display.filter().is_some() {
        NO_FILTER
    } else if Meetings::with_mirror(scene, 0..0).is_none() {
        "a pixel that is a mirror: what others scatter is unpolarised"
    } else {
        return Ok(());
    };
    Err(DisplayError::Polarised { key: keeper.depolarisation.key.clone(), needs })
}

/// Returns whether light meets the one scatterer of these layers twice, on its way in and on its way out, and nothing above it: what it does to
/// polarisation is then the same as if the light were less polarised, and the polariser weaker.
fn is_met_twice(layers: &[scene::Layer]) -> bool {
    let is_nothing = |layer: &scene::Layer| match &layer.interface {
        scene::Interface::Ready(Ready::Open) => true,
        scene::Interface::Ready(Ready::Component(sheet)) => sheet.reflectance.max() == 0.0,
        _ => false,
    };
    let mut rest = layers.iter().skip_while(|layer| is_nothing(layer));
    let is_lobe = |layer: &scene::Layer| match &layer.interface {
        scene::Interface::Ready(Ready::Diffuser(lobe)) => lobe.regular_fraction == 0.0,
        _ => false,
    };
    rest.next().is_some_and(is_lobe) && rest.all(|layer| is_flat(&layer.interface))
}

/// Returns the fraction of polarisation that the scatterers of a display leave, once on its way in or out.
fn left(scene: &Scene) -> f64 {
    let scatterer = scene.display.layers.iter().find(|layer| !is_flat(&layer.interface));
    scatterer.map_or(1.0, |layer| match layer.depolarisation.fraction {
        // They leave it to the light, whose polarisation is followed.
        0.0 => 1.0,
        fraction => 1.0 - fraction,
    })
}

/// Returns the weights of s and of p in what is seen of unpolarised light, if they are kept apart to the end.
///
/// # Errors
/// If anything is polarised, and that cannot be followed.
pub(crate) fn weights(scene: &Scene) -> Result<Option<[f64; 2]>, DisplayError> {
    check_scatterers(scene)?;
    let meetings = Meetings::of(scene).filter(|_| is_followed(scene));
    let Some(asked) = Asked::of(scene) else {
        return Ok(meetings.is_some_and(Meetings::mix).then_some([0.5; 2]));
    };
    let asked = asked.check(scene)?;
    let left = left(scene);
    let weights = asked.weights().map(|weight| 0.5 + left * (weight - 0.5));
    Ok(meetings.map(|_| weights))
}

/// Returns the polarised light of a scene and what it meets first, for its stack and its sources; `None` if nothing is
/// polarised.
///
/// # Errors
/// As [`weights`].
pub(crate) fn view(
    scene: &Scene,
    stack: &Stack,
    sources: &[Source],
) -> Result<Option<PolarisedView>, DisplayError> {
    let Some(asked) = Asked::of(scene) else { return Ok(None) };
    let asked = asked.check(scene)?;
    let polariser = asked.polariser_deg.map(f64::to_radians);
    let seen = WholeView { polariser, vibrations: asked.vibrations_of(scene) };
    if is_whole(scene) || has_particles(scene) {
        return Ok(Some(PolarisedView { seen, followed: Followed::Whole }));
    }
    let is_kept = weights(scene)?.is_some();
    if is_kept && scene.display.is_flat() {
        return Ok(Some(PolarisedView { seen, followed: Followed::Rays }));
    }
    let top = if is_kept { None } else { top(scene, stack, asked.weights())? };
    let analyser = match polariser {
        Some(angle) if is_kept => Some([plane_of_views(scene, &asked)?.to_radians(), angle]),
        _ => None,
    };
    let of = |(source, vibration): (&Source, &Option<Vibration>)| {
        let vibration = (*vibration)?;
        match is_kept {
            true => PolarisedLight::kept(source, vibration, left(scene), analyser),
            false => PolarisedLight::above(source, vibration, top.as_ref(), scene.grid.len()),
        }
    };
    let lights = sources.iter().zip(&seen.vibrations).map(of).collect();
    Ok(Some(PolarisedView { seen, followed: Followed::Lights(lights, top.map(Box::new)) }))
}

/// Returns the azimuth of the plane of all views, degrees; that of the first, if no light from many directions is polarised.
fn plane_of_views(scene: &Scene, asked: &Asked) -> Result<f64, DisplayError> {
    let mut azimuths = scene.viewer.phi_deg.iter();
    let first = azimuths.next().copied().unwrap_or_default();
    let is_other = |phi_deg: &f64| (phi_deg - first).to_radians().sin().abs() > 1e-9;
    let is_sky = |vibration: &Vibration| matches!(vibration, Vibration::Rayleigh { .. });
    if azimuths.any(is_other) && asked.vibrations.iter().flatten().any(is_sky) {
        return Err(DisplayError::Polarised { key: asked.key.clone(), needs: ONE_PLANE });
    }
    Ok(first)
}

/// Returns notes on what is polarised.
pub(crate) fn notes(scene: &Scene) -> Vec<String> {
    let Some(asked) = Asked::of(scene) else { return Vec::new() };
    let mut notes = Vec::new();
    if let Some(angle_deg) = asked.polariser_deg {
        let which = match angle_deg.rem_euclid(180.0) {
            0.0 => "p, in the plane of incidence".to_owned(),
            90.0 => "s, across the plane of incidence".to_owned(),
            _ => format!("at {angle_deg} deg from the plane of incidence"),
        };
        notes.push(format!(
            "seen through a polariser ({which}): luminances and X, Y, Z do not contain the half that it takes from \
             unpolarised light; the perfect white is seen through it, too"
        ));
    }
    if is_whole(scene) || has_particles(scene) {
        return notes;
    }
    notes.extend(note_of_phase(scene, &asked));
    let met = met_unscattered(scene);
    let is_seen = asked.polariser_deg.is_some() && asked.vibrations.iter().any(Option::is_some);
    if met.polarising == 0 && !(is_seen && met.reflecting > 0) {
        notes.push(format!(
            "`{}` has no effect: this display reflects s and p equally, or scatters light before it meets a face or film, \
             and scattered light is unpolarised",
            asked.key
        ));
    }
    notes
}

/// Returns whether light between s and p is followed with its phase to a mirror below flat layers or particles; `is_seen`: the computation is of what is
/// seen from directions.
pub(crate) fn has_phases(scene: &Scene, is_seen: bool) -> bool {
    let is_mixed =
        |asked: Asked| asked.polariser_deg.is_some() && asked.vibrations.iter().any(Option::is_some);
    if has_particles(scene) {
        return is_seen && matches!(scene.display.pixel, Pixel::Film(_));
    }
    is_seen
        && scene.display.is_flat()
        && scene.display.filter().is_none()
        && is_followed(scene)
        && Meetings::of(scene).is_some_and(|met| met.polarising > 0)
        && Asked::of(scene).is_some_and(is_mixed)
}

/// Refuses light between s and p that is seen through a polariser between them where its phase matters and is not followed.
pub(crate) fn check_phases(scene: &Scene, is_seen: bool) -> Result<(), DisplayError> {
    let Some(asked) = Asked::of(scene).filter(Asked::mixes) else { return Ok(()) };
    // Where s and p are not followed at all, polarised light is refused for this reason.
    let matters = is_followed(scene) && Meetings::of(scene).is_some_and(|met| met.polarising > 0);
    if matters && !has_phases(scene, is_seen) {
        return Err(DisplayError::Polarised { key: asked.key, needs: NO_PHASE });
    }
    Ok(())
}

/// Returns a note if rays of a wide view have light between s and p, whose phase in flat layers above a mirror is not followed.
fn note_of_phase(scene: &Scene, asked: &Asked) -> Option<String> {
    let field_deg = scene.viewer.field_deg;
    let is_mixed = asked.polariser_deg.is_some() && asked.vibrations.iter().any(Option::is_some);
    let is_polarising = Meetings::of(scene).is_some_and(|met| met.polarising > 0);
    (is_mixed && is_polarising && field_deg > NARROW_DEG && !has_phases(scene, true)).then(|| {
        format!(
            "the phase between s and p in faces and films is not followed below a filter or diffuser: in a field of {field_deg} deg, light that vibrates between the two \
             is up to some per cent wrong (of a silver film in a polarised sky, 0.5 % in 20 deg, 3 % in 60 deg), which the stated error does \
             not contain; narrower fields are exact"
        )
    })
}

/// What light meets before the first scatterer that does not keep s and p.
fn met_unscattered(scene: &Scene) -> Meetings {
    Meetings::of(scene).unwrap_or_else(|| Meetings::within(scene, top_layers(scene)))
}

/// The flat layers above the first scatterer, by their interfaces.
fn top_layers(scene: &Scene) -> Range<usize> {
    flat_from(scene, 0).0
}

/// Returns those layers with a polariser of these weights before the eye; `None` if nothing is reflected by them.
fn top(scene: &Scene, stack: &Stack, weights: [f64; 2]) -> Result<Option<Top>, DisplayError> {
    let layers = top_layers(scene);
    if Meetings::within(scene, layers.clone()).reflecting == 0 {
        return Ok(None);
    }
    let own = |polarisation| -> Result<Vec<Interface>, DisplayError> {
        let made = of_polarisation(scene, stack.layers(), polarisation)?;
        Ok(interfaces_of(&made[layers.clone()]))
    };
    let mut media: Vec<_> = stack.layers()[layers.clone()].iter().map(|layer| layer.medium.clone()).collect();
    let Some(below) = media.pop() else { return Ok(None) };
    let run = FlatRun::new([own(Polarisation::S)?, own(Polarisation::P)?], media);
    Ok(Some(Top::new(run, below, weights)))
}

/// Returns whether s and p are kept apart where they meet the pixel.
///
/// # Errors
/// As [`weights`].
pub(crate) fn reaches_pixel(scene: &Scene) -> Result<bool, DisplayError> {
    let is_mirror_below_particles = has_particles(scene) && Meetings::with_mirror(scene, 0..0).is_some();
    Ok(weights(scene)?.is_some() || is_mirror_below_particles || has_mirror_run(scene))
}

/// Returns whether they are kept apart by flat layers between a scatterer and the mirror.
fn has_mirror_run(scene: &Scene) -> bool {
    is_followed(scene)
        && scene.display.panel().is_none()
        && !is_whole(scene)
        && !has_particles(scene)
        && runs(scene).iter().any(|run| run.meets_mirror)
}

/// Returns the stack with what it is for s and p; `pixel` is that of light of s and of p, if they are kept apart where
/// they meet it, and `products` are those of both amplitudes, if their phase is followed.
pub(crate) fn kept(
    scene: &Scene,
    stack: Stack,
    pixel: Option<[Base; 2]>,
    products: Option<[Base; 2]>,
) -> Result<Stack, DisplayError> {
    let weights = weights(scene)?;
    let for_adding = |stack: Stack| match scene.display.is_flat() {
        true => with_azimuth(stack),
        false => stack,
    };
    let is_panel = stack.panel().is_some();
    if has_particles(scene) {
        return of_particles(scene, stack, pixel, products);
    }
    if weights.is_none() && (!is_followed(scene) || is_panel && !is_flat_paper(scene)) {
        return Ok(for_adding(stack));
    }
    if is_whole(scene) {
        let both = [Polarisation::S, Polarisation::P]
            .map(|polarisation| of_polarisation(scene, stack.layers(), polarisation));
        let [s, p] = both;
        let interfaces = [s?, p?].map(|own| interfaces_of(&own));
        let media = media_between(&stack);
        return Ok(stack.with_flat_run(FlatRun::new(interfaces, media)));
    }
    let runs = if weights.is_none() { runs(scene) } else { Vec::new() };
    if weights.is_none() && runs.is_empty() {
        return Ok(for_adding(stack));
    }
    let of_s = of_polarisation(scene, stack.layers(), Polarisation::S)?;
    let of_p = of_polarisation(scene, stack.layers(), Polarisation::P)?;
    Ok(match (weights, pixel) {
        (Some(weights), Some([s, p])) => {
            let phases = products.and_then(|products| {
                let interfaces = [&of_s, &of_p].map(|own| interfaces_of(own));
                let below = of_s.last()?.medium.clone();
                Some(Phases::new(FlatRun::new(interfaces, media_between(&stack)), below, products))
            });
            let both = [Stack::new(of_s, s), Stack::new(of_p, p)].map(for_adding);
            stack.with_polarisations(both, weights).with_phases(phases)
        }
        (_, mirrors) => {
            let layers = in_runs(stack.layers(), [&of_s, &of_p], &runs);
            let stack = if is_panel { stack } else { stack.with_runs(layers, mirrors) };
            if is_flat_paper(scene) { stack.with_layers_of_each([of_s, of_p]) } else { stack }
        }
    })
}

/// Returns the stack for the tracer of Stokes parameters: its coatings, and a mirror-like pixel, for light of s and of p.
fn of_particles(
    scene: &Scene,
    stack: Stack,
    pixel: Option<[Base; 2]>,
    products: Option<[Base; 2]>,
) -> Result<Stack, DisplayError> {
    let is_coating =
        |number: &usize| matches!(scene.display.layers[*number].interface, scene::Interface::Coating(_));
    let one = |number: usize| Run { layers: number..number + 1, meets_mirror: false };
    let coatings: Vec<Run> = (0..scene.display.layers.len()).filter(is_coating).map(one).collect();
    let of = |polarisation| of_polarisation(scene, stack.layers(), polarisation);
    let layers = in_runs(stack.layers(), [&of(Polarisation::S)?, &of(Polarisation::P)?], &coatings);
    let stack = if coatings.is_empty() { stack } else { stack.with_runs(layers, None) };
    Ok(match pixel {
        Some(both) if stack.base().is_specular() => stack.with_mirrors_of_each(both, products),
        _ => stack,
    })
}

/// Returns a stack of flat layers, of mean light or of light of one polarisation, as one run if its pixel depends on azimuth: adding knows azimuths only
/// in panels.
fn with_azimuth(stack: Stack) -> Stack {
    if stack.panel().is_some() || !stack.base().is_azimuthal() {
        return stack;
    }
    let interfaces = interfaces_of(stack.layers());
    let media = media_between(&stack);
    stack.with_flat_run(FlatRun::new([interfaces.clone(), interfaces], media))
}

fn interfaces_of(layers: &[Layer]) -> Vec<Interface> {
    layers.iter().map(|layer| layer.interface.clone()).collect()
}

/// Returns the media of a stack but the last.
fn media_between(stack: &Stack) -> Vec<Medium> {
    let between = stack.layers().split_last().map_or(&[][..], |(_, above)| above);
    between.iter().map(|layer| layer.medium.clone()).collect()
}

/// Returns the scene for light with its places: s and p are followed through flat layers above mirrors and paper, and the coherency matrix below flat
/// layers above liquid crystals by paths and below colour filters; nothing elsewhere.
///
/// # Errors
/// With a polariser or polarised light, except for mirrors below flat layers without a colour filter.
pub(crate) fn of_places(scene: &Scene) -> Result<Scene, DisplayError> {
    check_particles(scene, false)?;
    if !is_flat_mirror(scene) || scene.display.filter().is_some() {
        check_unpolarised(scene)?;
    }
    let mut scene = scene.clone();
    if scene.solver.approximation == Approximation::None && !is_kept_in_places(&scene) {
        scene.solver.approximation = Approximation::Unpolarised;
    }
    Ok(scene)
}

/// Refuses a polariser and polarised light.
pub(crate) fn check_unpolarised(scene: &Scene) -> Result<(), DisplayError> {
    let Some(Asked { key, .. }) = Asked::of(scene) else { return Ok(()) };
    let needs = "`papilio run`, `cone` or `sweep`, mirrors below flat layers without a colour filter, or a picture on a liquid crystal without scatterer in light without \
         lamps: other light with its places counts as unpolarised";
    Err(DisplayError::Polarised { key, needs })
}

/// Returns the scene for pictures whose pixels have the colours of pages: as [`of_places`], but bare liquid crystals without lamps, whose images
/// are drawn apart, are those of `papilio run`, through a polariser and in polarised light, too.
///
/// # Errors
/// With a polariser or polarised light, elsewhere.
pub(crate) fn of_pages(scene: &Scene) -> Result<Scene, DisplayError> {
    if is_whole_in_pages(scene) { Ok(scene.clone()) } else { of_places(scene) }
}

/// Returns whether light with its places is followed with its coherency matrix: below a filter or by paths, all of it has its own direction.
fn is_whole_in_places(scene: &Scene) -> bool {
    is_whole(scene) && (scene.display.filter().is_some() || scene.solver.method == Method::MonteCarlo)
}

fn is_whole_in_pages(scene: &Scene) -> bool {
    is_whole(scene) && scene.lighting.directed.is_empty()
}

/// Returns whether light with its places is followed as that of [`weights`] and [`kept`].
fn is_kept_in_places(scene: &Scene) -> bool {
    is_flat_mirror(scene) || is_flat_paper(scene) || is_whole_in_places(scene)
}

/// Returns a note if light with its places counts as unpolarised after each of several meetings with faces or films.
pub fn note_of_places(scene: &Scene) -> Option<String> {
    let meets_several = || match Meetings::of(scene) {
        Some(meetings) => meetings.mix(),
        None => scene.display.panel().is_none() && !runs(scene).is_empty(),
    };
    let is_apart = is_kept_in_places(scene) || is_whole_in_pages(scene);
    (is_followed(scene) && !is_apart && meets_several()).then(|| {
        "light with its places counts as unpolarised after each face and film here, where `papilio run` keeps s and p apart: \
         several meetings at more than 45 deg are some per cent wrong"
            .to_owned()
    })
}

/// Returns whether all layers are flat above a mirror-like pixel.
fn is_flat_mirror(scene: &Scene) -> bool {
    scene.display.is_flat() && Meetings::of(scene).is_some()
}

/// Returns whether all layers are flat above a Lambertian pixel.
pub(crate) fn is_flat_paper(scene: &Scene) -> bool {
    let is_paper =
        matches!(&scene.display.pixel, Pixel::Uniform(UniformPixel { kind: UniformKind::Lambertian, .. }));
    is_paper && scene.display.is_flat()
}

/// Returns whether the pixel is a liquid crystal below flat layers alone, so that polarised light is followed to the end.
pub(crate) fn is_whole(scene: &Scene) -> bool {
    let display = &scene.display;
    matches!(display.pixel, Pixel::Crystal(_)) && display.is_flat() && is_followed(scene)
}

/// Returns whether, in addition, anything else than the pixel is polarised.
pub(crate) fn needs_whole(scene: &Scene) -> bool {
    is_whole(scene) && Asked::of(scene).is_some()
}

/// True if the solver follows s and p.
fn is_followed(scene: &Scene) -> bool {
    scene.solver.approximation == Approximation::None && scene.solver.angle_medium != AngleMedium::Unrefracted
}

/// What light meets on its way.
#[derive(Debug, Clone, Copy, Default)]
struct Meetings {
    /// Faces and films, which reflect s and p differently.
    polarising: usize,
    /// All that reflects.
    reflecting: usize,
}

impl Meetings {
    /// Those of a whole display; `None` if anything scatters without keeping s and p.
    fn of(scene: &Scene) -> Option<Self> {
        let layers = &scene.display.layers;
        if layers.iter().all(keeps) { Self::with_mirror(scene, 0..layers.len()) } else { None }
    }

    /// Those of the interfaces of flat layers and the pixel; `None` if that is no mirror.
    fn with_mirror(scene: &Scene, layers: Range<usize>) -> Option<Self> {
        let is_film = match &scene.display.pixel {
            Pixel::Film(_) => true,
            Pixel::Table(_) | Pixel::Uniform(UniformPixel { kind: UniformKind::Mirror, .. }) => false,
            Pixel::Uniform(_) | Pixel::Scattering(_) | Pixel::Crystal(_) => return None,
        };
        let of_layers = Self::within(scene, layers);
        Some(Self {
            polarising: of_layers.polarising + usize::from(is_film),
            reflecting: of_layers.reflecting + 1,
        })
    }

    /// Those of the interfaces of flat layers.
    fn within(scene: &Scene, layers: Range<usize>) -> Self {
        let all = &scene.display.layers;
        let mut sum = Self::default();
        for number in layers {
            let below = &all[number].medium.index;
            let above = number.checked_sub(1).map(|above| &all[above].medium.index);
            let differs = || (0..below.len()).any(|bin| above.map_or(1.0, |above| above[bin]) != below[bin]);
            let (polarises, reflects) = match &all[number].interface {
                scene::Interface::Ready(Ready::Fresnel) => (differs(), differs()),
                scene::Interface::Coating(_) => (true, true),
                scene::Interface::Ready(Ready::Component(sheet)) => (false, sheet.reflectance.max() > 0.0),
                // Light that a diffuser sends elsewhere meets the same faces at another angle.
                interface => (false, !is_flat(interface)),
            };
            sum.polarising += usize::from(polarises);
            sum.reflecting += usize::from(reflects);
        }
        sum
    }

    /// True if the mean of s and p at each meeting is not that of all of them.
    fn mix(self) -> bool {
        self.polarising > 0 && self.reflecting > 1
    }
}

/// True if nothing of a layer changes the shares of s and p of light, but faces and films.
fn keeps(layer: &scene::Layer) -> bool {
    (is_flat(&layer.interface) || layer.depolarisation.fraction < 1.0) && layer.medium.scattering.is_none()
}

fn is_flat(interface: &scene::Interface) -> bool {
    interface.is_flat()
}

/// Flat layers within which light meets several faces.
struct Run {
    /// By their interfaces; the last medium may scatter.
    layers: Range<usize>,
    /// True if the last of what light meets is a mirror-like pixel.
    meets_mirror: bool,
}

/// Returns the runs of flat layers within which light meets several faces.
fn runs(scene: &Scene) -> Vec<Run> {
    let layers = &scene.display.layers;
    let mut found = Vec::new();
    let mut first = 0;
    while first < layers.len() {
        let (run, is_clear) = flat_from(scene, first);
        first = run.end.max(first + 1);
        let is_last = run.end == layers.len() && is_clear;
        // All layers together, without a scatterer, have a way of their own.
        let with_mirror = match is_last && !run.is_empty() {
            true => Meetings::with_mirror(scene, run.clone()),
            false => None,
        };
        // Also a single face: a liquid crystal changes what returns to it.
        let meets_crystal = is_last && run.start > 0 && matches!(scene.display.pixel, Pixel::Crystal(_));
        let own = Meetings::within(scene, run.clone());
        let meets_mirror = with_mirror.is_some() || meets_crystal && own.reflecting > 0;
        let meetings = with_mirror.unwrap_or(own);
        if meets_crystal && own.reflecting > 0 || meetings.mix() && !(meets_mirror && run.start == 0) {
            found.push(Run { layers: run, meets_mirror });
        }
    }
    found
}

/// Returns the flat layers from this one on, by their interfaces, down to one whose medium scatters; and whether that of
/// none does.
fn flat_from(scene: &Scene, first: usize) -> (Range<usize>, bool) {
    let rest = &scene.display.layers[first..];
    let flat = rest.iter().take_while(|layer| is_flat(&layer.interface)).count();
    let murky = rest.iter().take(flat).position(|layer| layer.medium.scattering.is_some());
    (first..first + murky.map_or(flat, |last| last + 1), murky.is_none())
}

/// Layers for light of one polarisation; coatings of s have the products of both amplitudes where light between s and p is followed.
fn of_polarisation(
    scene: &Scene,
    layers: &[Layer],
    polarisation: Polarisation,
) -> Result<Vec<Layer>, DisplayError> {
    let nm = scene.grid.wavelengths_nm();
    let air = Spectrum::constant(&scene.grid, 1.0);
    let has_products = polarisation == Polarisation::S
        && (matches!(scene.display.pixel, Pixel::Crystal(_))
            || has_particles(scene)
            || Asked::of(scene).is_some());
    let mut above = &air;
    let mut made = Vec::with_capacity(layers.len());
    for (described, layer) in scene.display.layers.iter().zip(layers) {
        let below = &described.medium.index;
        let interface = match &described.interface {
            scene::Interface::Coating(coating) => {
                let made = Coating::of(polarisation, &nm, above, &coating.films, below);
                let made = match has_products {
                    true => made.and_then(|made| made.with_products(&nm, above, &coating.films, below)),
                    false => made,
                };
                Interface::Coating(made.map_err(|error| DisplayError::of_coating(error, &coating.key))?)
            }
            scene::Interface::Ready(Ready::Fresnel) => Interface::FresnelOf(polarisation),
            _ => layer.interface.clone(),
        };
        made.push(Layer { interface, ..layer.clone() });
        above = below;
    }
    Ok(made)
}

/// Returns the layers with each of these runs as one interface; `both` are the layers for light of s and of p.
fn in_runs(layers: &[Layer], both: [&[Layer]; 2], runs: &[Run]) -> Vec<Layer> {
    let mut made = Vec::with_capacity(layers.len());
    let mut next = 0;
    for Run { layers: run, .. } in runs {
        made.extend_from_slice(&layers[next..run.start]);
        let interfaces =
            both.map(|own| own[run.clone()].iter().map(|layer| layer.interface.clone()).collect());
        let (last, inner) = (&layers[run.end - 1], &layers[run.start..run.end - 1]);
        let media = inner.iter().map(|layer| layer.medium.clone()).collect();
        let interface = Interface::Run(Box::new(FlatRun::new(interfaces, media)));
        made.push(Layer { interface, ..last.clone() });
        next = run.end;
    }
    made.extend_from_slice(&layers[next..]);
    made
}
