//! Preparation of a scene for the transport: the stack, the sources and the views.
//!
//! **Versions.** A setup that is updated for another scene ([`Setup::renewed`]) counts its changes, so that
//! results of the transport can be reused as long as they are valid:
//!
//! | counter | incremented when | key of |
//! |---|---|---|
//! | `version` | layers, sources or views change, or everything is prepared again | kernels of general layers |
//! | `base_version` | the pixel changes | with `version`: estimates of what is seen of each source |
//!
//! Spectra and illuminances of the light have no counter: estimates do not depend on them.

mod lights;

use papilio_colour::{Observer, Standard};
use papilio_optics::Beta;
use papilio_optics::film::Coating;
use papilio_optics::rough::Rough;
use papilio_spectra::Spectrum;
use papilio_transport::adding::Kernel;
use papilio_transport::{
    Approximation, Base, Cone, Interface, Layer, Medium, MuellerByDirection, NotAPanel, ReflectanceFactor,
    Reflector, Scattering, Source, Stack,
};

pub(crate) use self::lights::{Light, LineWeights};
use self::lights::{between, lights};
use crate::DisplayError;
use crate::pixel::{self, Bases, FilmKey};
use crate::polarisation;
use crate::port::Kept;
use crate::run::Control;
use crate::scene::{self, AngleMedium, Scene};
use crate::spatial::Refused;

/// Largest thickness of the layers above the pixels, over the pitch, with which crosstalk is computed:
/// beyond, light of a sub-pixel spreads over tens of thousands of others.
const MOST_PITCHES: f64 = 100.0;

/// Angle by which a range of directions is widened, for rounding, degrees.
const ROUNDING_DEG: f64 = 1e-3;

/// Scene that is prepared for the transport.
#[derive(Debug, Clone)]
pub(crate) struct Setup {
    /// The scene of all other fields.
    pub(crate) scene: Scene,
    /// Incremented when layers, sources or views change. Kernels of general layers are valid for one version.
    pub(crate) version: u64,
    /// Incremented when the pixel changes. `(version, base_version)` is the key of all cached estimates.
    pub(crate) base_version: u64,
    /// Film to which the reflectances of the stack's base belong, if the pixel is a film pixel.
    film: Option<FilmKey>,
    pub(crate) stack: Stack,
    /// The diffuse light, the directed sources in the scene's order, the parts of each environment, and the
    /// front light.
    pub(crate) lights: Vec<Light>,
    pub(crate) sources: Vec<Source>,
    pub(crate) views: Vec<ViewPoint>,
    /// CIE 1931 observer, for illuminance and luminance.
    pub(crate) observer: Observer,
    /// Observer of the reported colours, if it is not that of 1931.
    other_observer: Option<Observer>,
    pub(crate) states: Vec<String>,
    /// What an instrument with a port sees of each source; `None` without one.
    pub(crate) kept: Option<Vec<Kept>>,
    /// Ranges of the cosine in the glass between which the pixel is known; `None`: all.
    cosines: Option<Vec<[f64; 2]>>,
}

/// Directions towards which a pixel is to be known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Towards {
    /// All of the glass, for light whose polarisation is that of its mean.
    All,
    /// All from which the display is seen: those of a map.
    Map,
    /// Those of the views, and of the lamps, whose mirror images are listed.
    Views,
}

impl Towards {
    /// Returns whether polarised light is followed to what is seen, as that of views.
    fn is_seen(self) -> bool {
        self != Self::All
    }

    /// Returns the ranges of the cosine in the glass of these directions; `None` if all are to be known, or the pixel is not one that takes long.
    fn cosines(self, scene: &Scene) -> Option<Vec<[f64; 2]>> {
        // What a bare panel shows of a direction, its pixel reflects in this direction.
        let display = &scene.display;
        let is_bare = display.is_flat();
        let is_crystal = matches!(display.pixel, scene::Pixel::Crystal(_));
        let is_plain = scene.solver.angle_medium == AngleMedium::Air
            && scene.viewer.numerical_aperture.is_none()
            && scene.lighting.environment.is_empty();
        if self != Self::Views || !(is_bare && is_crystal && is_plain) {
            return None;
        }
        let views = scene.viewer.directions().map(|(theta_deg, _)| (theta_deg, 0.5 * scene.viewer.field_deg));
        let lamps =
            scene.lighting.directed.iter().map(|lamp| (lamp.theta_deg, lamp.radius_deg.unwrap_or(0.0)));
        let index = display.index_above_pixel();
        let cosine = |theta_deg: f64, index: f64| {
            let sine = theta_deg.clamp(0.0, 90.0).to_radians().sin() / index;
            (1.0 - sine * sine).max(0.0).sqrt()
        };
        let range = |(theta_deg, half_deg): (f64, f64)| {
            let [nearest, farthest] =
                [-1.0, 1.0].map(|sign| theta_deg.abs() + sign * (half_deg + ROUNDING_DEG));
            [cosine(farthest, index.min()), cosine(nearest, index.max())]
        };
        Some(views.chain(lamps).map(range).collect())
    }
}

/// Direction and field of view of one view.
#[derive(Debug, Clone)]
pub(crate) struct ViewPoint {
    pub(crate) theta_deg: f64,
    pub(crate) phi_deg: f64,
    pub(crate) field: Cone,
}

impl Setup {
    /// Prepares a scene for a computation that does not know colour filters.
    pub(crate) fn new(scene: &Scene, control: &Control<'_>) -> Result<Self, DisplayError> {
        Self::has_no_filter(scene)?;
        Self::with_filter(scene, control)
    }

    /// Prepares a scene for what is seen from any direction, by a computation that does not know colour filters.
    pub(crate) fn of_map(scene: &Scene, control: &Control<'_>) -> Result<Self, DisplayError> {
        Self::has_no_filter(scene)?;
        Self::towards(scene, Towards::Map, control)
    }

    /// Checks that a display has no colour filter.
    pub(crate) fn has_no_filter(scene: &Scene) -> Result<(), DisplayError> {
        if scene.display.filter().is_some() { Err(DisplayError::FilterWithoutPlace) } else { Ok(()) }
    }

    /// Prepares a scene that may have a colour filter.
    pub(crate) fn with_filter(scene: &Scene, control: &Control<'_>) -> Result<Self, DisplayError> {
        Self::towards(scene, Towards::All, control)
    }

    /// Prepares a scene that may have a colour filter, whose pixel need only be known towards these directions.
    pub(crate) fn towards(
        scene: &Scene,
        towards: Towards,
        control: &Control<'_>,
    ) -> Result<Self, DisplayError> {
        polarisation::check_particles(scene, towards == Towards::Views)?;
        polarisation::check_phases(scene, towards.is_seen())?;
        let observer = Observer::new(&scene.grid)?;
        let angle_index = angle_index(scene)?;
        let mut film = None;
        let cosines = towards.cosines(scene);
        let kept_apart = polarisation::reaches_pixel(scene)?;
        let phases = polarisation::has_phases(scene, towards.is_seen());
        let light = pixel::Light { kept_apart, phases, cosines: cosines.as_deref() };
        let bases = pixel::bases(scene, &mut film, None, light, control)?;
        let (mut stack, sources) = (stack(scene, bases, None, control)?, sources(scene, angle_index)?);
        stack.set_polarised_view(polarisation::view(scene, &stack, &sources)?);
        let setup = Self {
            stack,
            film,
            lights: lights(scene, &observer)?,
            sources,
            views: views(scene, angle_index)?,
            other_observer: other_observer(scene)?,
            observer,
            states: scene.display.state_names(),
            version: 0,
            base_version: 0,
            kept: Kept::of(scene, control)?,
            scene: scene.clone(),
            cosines,
        };
        setup.checked()
    }

    /// Refuses polarised light if the pixel is known for unpolarised light alone.
    fn checked(self) -> Result<Self, DisplayError> {
        if polarisation::needs_whole(&self.scene) && self.stack.mueller().is_none() {
            return Err(DisplayError::CrystalFringes);
        }
        Ok(self)
    }

    /// Prepares a scene, which may have a colour filter, for light with its places: s and p are kept apart by flat layers alone.
    pub(crate) fn of_places(scene: &Scene, control: &Control<'_>) -> Result<Self, DisplayError> {
        let mut scene = polarisation::of_places(scene)?;
        scene.lighting.port = None;
        Self::with_filter(&scene, control)
    }

    /// Returns a note if a liquid crystal is interpolated between directions.
    pub(crate) fn note_of_table(&self) -> Option<String> {
        let is_exact = self
            .stack
            .mueller()
            .is_some_and(|mueller| matches!(mueller.by_direction, MuellerByDirection::Exact(_)));
        let is_table = matches!(self.scene.display.pixel, scene::Pixel::Crystal(_)) && !is_exact;
        is_table.then(|| {
            format!(
                "the liquid crystal is interpolated between directions within {} as a reflectance, besides the stated errors",
                pixel::CRYSTAL_TABLE_ERROR
            )
        })
    }

    /// Refuses a BSDF without azimuths of the light of a display whose pixel depends on azimuth.
    pub(crate) fn check_isotropic(&self) -> Result<(), DisplayError> {
        if !self.stack.base().is_azimuthal() {
            return Ok(());
        }
        Err(DisplayError::Azimuth {
            what: "a BSDF of the display without azimuths of the light",
            key: "display.pixel",
            hint: "with azimuths of the light, it is a function of both azimuths",
        })
    }

    /// Updates the setup for another scene, of whose pixel these directions need be known. The result equals `towards(scene)`, but parts that are still valid
    /// are reused, and the version counters are incremented for the parts that changed.
    ///
    /// Another grid, angle medium or approximation invalidates everything. Otherwise the base depends on the
    /// pixel and the index above it, the stack on the layers, the sources on the lighting, the observer and
    /// that index, and the views on the viewer and that index. `version` is not incremented if new lighting
    /// has the same sources, that is, differs only in spectra and illuminances.
    pub(crate) fn renewed_towards(
        mut self,
        scene: &Scene,
        towards: Towards,
        control: &Control<'_>,
    ) -> Result<Self, DisplayError> {
        polarisation::check_particles(scene, towards == Towards::Views)?;
        polarisation::check_phases(scene, towards.is_seen())?;
        let phases = polarisation::has_phases(scene, towards.is_seen());
        let last = std::mem::replace(&mut self.scene, scene.clone());
        let solver_changed = (scene.solver.angle_medium, scene.solver.approximation)
            != (last.solver.angle_medium, last.solver.approximation);
        let weights = polarisation::weights(scene)?;
        let apart = polarisation::reaches_pixel(scene)?;
        let is_whole = polarisation::is_whole(scene);
        let weights_changed = is_whole != polarisation::is_whole(&last)
            || is_whole && pixel::has_few_directions(scene) != pixel::has_few_directions(&last)
            || polarisation::needs_whole(scene) != polarisation::needs_whole(&last)
            || apart && self.stack.polarised_bases().is_none() && self.stack.mueller().is_none()
            || !apart && self.stack.polarised_bases().is_some()
            || polarisation::has_particles(scene) != polarisation::has_particles(&last)
            || phases != self.stack.products().is_some()
            || weights != self.stack.polarised().map(|_| self.stack.weights_of_polarisations());
        // Adding has a form of its own for flat layers above a pixel that depends on azimuth.
        let azimuth_changed =
            scene.display.pixel.is_azimuthal_table() != last.display.pixel.is_azimuthal_table();
        if scene.grid != last.grid || solver_changed || weights_changed || azimuth_changed {
            return Ok(Self { version: self.version + 1, ..Self::towards(scene, towards, control)? });
        }
        let index_changed = scene.display.index_above_pixel() != last.display.index_above_pixel();
        let cosines = towards.cosines(scene);
        // Below flat layers, the pixel is known in fewer directions.
        let is_crystal = matches!(scene.display.pixel, scene::Pixel::Crystal(_));
        let directions_changed = is_crystal && scene.display.is_flat() != last.display.is_flat();
        if index_changed
            || directions_changed
            || scene.display.pixel != last.display.pixel
            || cosines != self.cosines
        {
            let light = pixel::Light { kept_apart: apart, phases, cosines: cosines.as_deref() };
            let bases = pixel::bases(scene, &mut self.film, Some(&self.stack), light, control)?;
            if bases.mean.is_azimuthal() != self.stack.base().is_azimuthal() {
                // Layers above a pixel that depends on azimuth have forms of their own.
                return Ok(Self { version: self.version + 1, ..Self::towards(scene, towards, control)? });
            }
            self.cosines = cosines;
            replace_bases(&mut self.stack, bases);
            self.base_version += 1;
        }
        self.states = scene.display.state_names();
        let was_panel = self.stack.panel().is_some();
        // s and p are kept apart above paper.
        let paper_changed = polarisation::is_flat_paper(scene) != polarisation::is_flat_paper(&last);
        if !scene.display.has_layers_of(&last.display)
            || was_panel != scene.display.panel().is_some()
            || paper_changed
        {
            let bases = Bases {
                mean: self.stack.base().clone(),
                polarised: self.stack.polarised_bases().map(|both| both.map(Base::clone)),
                products: self.stack.products().cloned(),
                mueller: self.stack.mueller().cloned(),
            };
            let made = Some((&last.display.layers[..], self.stack.layers()));
            self.stack = stack(scene, bases, made, control)?;
            self.version += 1;
        }
        self.stack.set_thickness_mm(&thickness_mm(scene));
        let angle_index = angle_index(scene)?;
        let observer_changed = scene.metrics.observer != last.metrics.observer;
        if observer_changed {
            self.other_observer = other_observer(scene)?;
        }
        let curves_changed = between(scene) != between(&last);
        if scene.lighting != last.lighting || index_changed || observer_changed || curves_changed {
            self.lights = lights(scene, &self.observer)?;
            let sources = sources(scene, angle_index)?;
            self.version += u64::from(sources != self.sources);
            self.sources = sources;
        }
        if scene.viewer != last.viewer || index_changed {
            self.views = views(scene, angle_index)?;
            self.version += 1;
        }
        let same_kept = scene.lighting.port.is_none() && last.lighting.port.is_none();
        if !(same_kept || *scene == last) {
            self.kept = Kept::of(scene, control)?;
        }
        let vibrations = |scene: &Scene| scene.lighting.vibrations().map(|one| one.1).collect::<Vec<_>>();
        self.version += u64::from(vibrations(scene) != vibrations(&last));
        self.stack.set_polarised_view(polarisation::view(scene, &self.stack, &self.sources)?);
        self.checked()
    }
}

impl Setup {
    /// Returns a view in this direction with the scene's field of view.
    pub(crate) fn view(&self, theta_deg: f64, phi_deg: f64) -> Result<ViewPoint, DisplayError> {
        view(&self.scene, angle_index(&self.scene)?, theta_deg, phi_deg)
    }
}

impl Setup {
    /// Computes by adding, at a level, what a view sees of each source.
    ///
    /// # Errors
    /// If the computation was stopped.
    pub(crate) fn seen(
        &self,
        view: &ViewPoint,
        level: u32,
        control: &Control<'_>,
    ) -> Result<Vec<ReflectanceFactor>, DisplayError> {
        self.seen_in_parts(view, level, control).map(all_of)
    }

    /// Computes the same as parts, each with the layers and the pixel that are those of its light: of s and of p, if they are
    /// kept apart to the end, or of all light.
    ///
    /// # Errors
    /// If the computation was stopped.
    pub(crate) fn seen_in_parts(
        &self,
        view: &ViewPoint,
        level: u32,
        control: &Control<'_>,
    ) -> Result<Vec<SeenPart<'_>>, DisplayError> {
        let (stack, stop) = (&self.stack, control.stop);
        let mut kernel = Kernel::new(level).without_ledger();
        if !kernel.prepare_unless(stack, &[view.field], &self.sources, stop) {
            return Err(DisplayError::Interrupted);
        }
        let of = |kernel: &Kernel, stack: &Stack| {
            kernel.seen_unless(stack, 0, stop).ok_or(DisplayError::Interrupted)
        };
        let (Some(both), Some(kernels)) = (stack.polarised(), kernel.polarised(stack)) else {
            return Ok(vec![SeenPart { stack, factors: of(&kernel, stack)? }]);
        };
        let weights = kernel.weights_by_source(stack, 0);
        let part = |(number, (stack, (kernel, _)))| {
            let mut factors = of(kernel, stack)?;
            for (ReflectanceFactor { via_pixel, front }, weights) in factors.iter_mut().zip(&weights) {
                let weight: f64 = weights[number];
                via_pixel.iter_mut().chain(front).for_each(|value| *value *= weight);
            }
            Ok(SeenPart { stack, factors })
        };
        both.iter().zip(kernels).enumerate().map(part).collect()
    }

    /// The stack, for light with its places by a method that does not know azimuths.
    ///
    /// # Errors
    /// If the pixel depends on azimuth; if a thickness is needed and missing.
    pub(crate) fn placed(&self) -> Result<&Stack, DisplayError> {
        if self.stack.base().is_azimuthal() {
            return Err(Refused::Azimuth.into());
        }
        self.scene.display.lengths_mm().map(|_| &self.stack)
    }

    /// The stack, for light with its places and directions: by paths, or by a method that knows them.
    ///
    /// # Errors
    /// If flat layers return light to a liquid crystal that depends on azimuth, and its polarisation is not followed; if a thickness is needed and missing.
    pub(crate) fn placed_by_direction(&self) -> Result<&Stack, DisplayError> {
        let display = &self.scene.display;
        let is_polarised =
            matches!(display.pixel, scene::Pixel::Crystal(_)) && !display.scatters_above_pixel();
        if is_polarised && self.stack.base().is_azimuthal() && !self.stack.follows_changes() {
            return Err(Refused::AzimuthOfUnpolarised.into());
        }
        self.scene.display.lengths_mm().map(|_| &self.stack)
    }

    /// The stack, for crosstalk between its pixels.
    ///
    /// # Errors
    /// If a thickness is needed and missing, or the layers are so thick that light spreads over too many
    /// pixels.
    pub(crate) fn spreads_over_few_pixels(&self) -> Result<&Stack, DisplayError> {
        let stack = self.placed()?;
        self.is_over_few_pixels().map(|()| stack)
    }

    /// Checks that light does not spread over too many pixels.
    pub(crate) fn is_over_few_pixels(&self) -> Result<(), DisplayError> {
        let Some(matrix) = &self.scene.display.matrix else { return Ok(()) };
        let pitch_mm = matrix.pitch_mm[0].min(matrix.pitch_mm[1]);
        let thickness_mm = self.stack.thickness_mm();
        if thickness_mm <= MOST_PITCHES * pitch_mm {
            return Ok(());
        }
        Err(DisplayError::TooThick { thickness_mm, pitch_mm, most: MOST_PITCHES })
    }

    /// Returns the observer of the reported colours.
    pub(crate) fn seen_by(&self) -> &Observer {
        self.other_observer.as_ref().unwrap_or(&self.observer)
    }

    /// Computes the reflectance of each state of the pixel alone in the direction of a view,
    /// `[state][wavelength]`; returns false if the pixel is not specular.
    pub(crate) fn pixel_alone(&self, base: &Base, at: &ViewPoint, out: &mut [f64]) -> bool {
        let beta = at.field.axis_towards();
        if let Some(mueller) = self.stack.mueller() {
            mueller.reflectance(beta, &medium(&self.scene), out);
        } else if base.is_specular() {
            base.reflectance_towards(beta, &medium(&self.scene), out);
        }
        base.is_specular()
    }
}

/// A part of what a view sees of each source.
pub(crate) struct SeenPart<'s> {
    /// Layers and pixel for its light.
    pub(crate) stack: &'s Stack,
    /// By source; those of all parts add up to what is seen.
    pub(crate) factors: Vec<ReflectanceFactor>,
}

/// Returns what is seen in all parts together.
pub(crate) fn all_of(parts: Vec<SeenPart<'_>>) -> Vec<ReflectanceFactor> {
    let sum = |mut sum: Vec<ReflectanceFactor>, part: Vec<ReflectanceFactor>| {
        for (sum, more) in sum.iter_mut().zip(part) {
            sum.via_pixel.iter_mut().zip(more.via_pixel.iter()).for_each(|(sum, more)| *sum += more);
            sum.front.iter_mut().zip(more.front).for_each(|(sum, more)| *sum += more);
        }
        sum
    };
    parts.into_iter().map(|part| part.factors).reduce(sum).unwrap_or_default()
}

/// Returns the observer of the reported colours, if it is not that of 1931.
fn other_observer(scene: &Scene) -> Result<Option<Observer>, DisplayError> {
    Ok(match scene.metrics.observer {
        Standard::Cie1931 => None,
        other => Some(Observer::of(other, &scene.grid)?),
    })
}

/// Returns the refractive index of the medium of the scene's angles.
pub(crate) fn angle_index(scene: &Scene) -> Result<f64, DisplayError> {
    let index = scene.display.index_above_pixel();
    match scene.solver.angle_medium {
        AngleMedium::Air | AngleMedium::Unrefracted => Ok(1.0),
        AngleMedium::Glass if index.is_constant() => Ok(index[0]),
        AngleMedium::Glass => Err(DisplayError::DispersiveGlassAngles),
    }
}

/// Replaces the pixel below the layers of a stack.
pub(crate) fn replace_bases(stack: &mut Stack, bases: Bases) {
    stack.set_base(bases.mean);
    stack.set_mueller(bases.mueller);
    if let Some(both) = bases.polarised {
        stack.set_polarised_bases(both);
    }
    if let Some(products) = bases.products {
        stack.set_products(products);
    }
}

fn stack(
    scene: &Scene,
    Bases { mean, polarised, products, mueller }: Bases,
    before: Option<Made<'_>>,
    control: &Control<'_>,
) -> Result<Stack, DisplayError> {
    let approximation = Approximation {
        single_pass: scene.solver.approximation == scene::Approximation::SinglePass,
        unrefracted: scene.solver.angle_medium == AngleMedium::Unrefracted,
    };
    let layers = layers(scene, before, Surfaces::Measured(control))?;
    let stack = Stack::approximated(layers, mean, approximation);
    let stack = stack.map_err(|NotAPanel| DisplayError::ApproximatesNoPanel)?;
    let mut stack = polarisation::kept(scene, stack, polarised, products)?;
    stack.set_mueller(mueller);
    stack.set_thickness_mm(&thickness_mm(scene));
    Ok(stack)
}

/// Returns the thickness of each layer, mm; 0 if one is missing: [`Setup::placed`] refuses it.
fn thickness_mm(scene: &Scene) -> Vec<f64> {
    let missing = |_| vec![0.0; scene.display.layers.len()];
    scene.display.lengths_mm().unwrap_or_else(missing)
}

/// Returns layers that are no panel over an empty base, which suffices to estimate their cost. Coatings are
/// bare interfaces, which do not scatter either, and surfaces are not measured: both take longer than a first
/// answer.
pub(crate) fn layers_alone(scene: &Scene) -> Result<Stack, DisplayError> {
    let inactive_absorptance = vec![0.0; scene.grid.len()].into();
    let base = Base { reflector: Reflector::lambertian(Vec::new(), 0), inactive_absorptance };
    Ok(Stack::general(layers(scene, None, Surfaces::Estimated)?, base))
}

/// What is prepared of layers.
#[derive(Clone, Copy)]
enum Surfaces<'a> {
    /// Everything.
    Measured(&'a Control<'a>),
    /// What decides on the work of a solver.
    Estimated,
}

/// Layers of a scene, and what was made of them.
type Made<'a> = (&'a [scene::Layer], &'a [Layer]);

/// Prepares layers. Interfaces between the same media as in `before` are taken from there, with their tables.
fn layers(
    scene: &Scene,
    before: Option<Made<'_>>,
    surfaces: Surfaces<'_>,
) -> Result<Vec<Layer>, DisplayError> {
    let layers = &scene.display.layers;
    let air = Spectrum::constant(&scene.grid, 1.0);
    let mut above = &air;
    let mut made = Vec::with_capacity(layers.len());
    for (number, layer) in layers.iter().enumerate() {
        let known = before.and_then(|(layers, made)| {
            let last = layers.get(number)?;
            let last_above = number.checked_sub(1).map_or(&air, |above| &layers[above].medium.index);
            let same = last.interface == layer.interface && last.medium.index == layer.medium.index;
            (same && last_above == above).then(|| made[number].interface.clone())
        });
        let interface = match known {
            Some(interface) => interface,
            None => interface(scene, &layer.interface, [above, &layer.medium.index], surfaces)?,
        };
        above = &layer.medium.index;
        let medium = Medium::new(above.clone()).with_transmittance(layer.medium.transmittance.clone());
        let medium = match (&layer.medium.scattering, layer.medium.particles) {
            (Some(slab), Some(particles)) => {
                let (thickness, albedo) = (slab.optical_thickness, slab.albedo.clone());
                medium.with_scattering(Scattering::polarised(thickness, particles.matrix(), albedo))
            }
            (Some(slab), None) => medium.with_scattering(slab.clone()),
            (None, _) => medium,
        };
        made.push(Layer::new(interface, medium));
    }
    Ok(made)
}

fn interface(
    scene: &Scene,
    interface: &scene::Interface,
    [above, below]: [&Spectrum; 2],
    surfaces: Surfaces<'_>,
) -> Result<Interface, DisplayError> {
    Ok(match interface {
        scene::Interface::Ready(ready) => ready.clone(),
        scene::Interface::OfSurface(surface) => match surfaces {
            Surfaces::Measured(control) => surface.interface(&scene.grid, control)?,
            Surfaces::Estimated => surface.estimated(&scene.grid)?,
        },
        scene::Interface::Coating(_) if matches!(surfaces, Surfaces::Estimated) => Interface::Fresnel,
        scene::Interface::Coating(coating) => {
            let made = Coating::new(&scene.grid.wavelengths_nm(), above, &coating.films, below);
            Interface::Coating(made.map_err(|error| DisplayError::of_coating(error, &coating.key))?)
        }
        scene::Interface::Rough { alpha, distribution } => {
            Interface::Rough(Rough::with(*distribution, *alpha, above[0], below[0]))
        }
    })
}

/// Returns the medium above the pixel. Without refraction its index is 1.
pub(crate) fn medium(scene: &Scene) -> Medium {
    let index = scene.display.index_above_pixel();
    let unrefracted = scene.solver.angle_medium == AngleMedium::Unrefracted;
    Medium::new(if unrefracted { index.map(|_| 1.0) } else { index.clone() })
}

fn sources(scene: &Scene, index: f64) -> Result<Vec<Source>, DisplayError> {
    let mut sources = vec![Source::Diffuse];
    for light in &scene.lighting.directed {
        let radius_deg = light.radius_deg.unwrap_or(0.0);
        check_above_horizon("light", light.theta_deg, radius_deg, index)?;
        sources.push(match light.radius_deg {
            None => Source::Beam(Beta::from_source(light.theta_deg, light.phi_deg, index)),
            Some(radius) => Source::Disc(Cone::new(light.theta_deg, light.phi_deg, radius, index)),
        });
    }
    let parts = scene.lighting.environment.iter().flat_map(|environment| &environment.parts);
    sources.extend(parts.map(|part| Source::Field(part.field.clone())));
    if let Some(guide) = &scene.lighting.front_light {
        sources.push(guide.field.clone().map_or(Source::Diffuse, Source::Field));
    }
    Ok(sources)
}

fn views(scene: &Scene, index: f64) -> Result<Vec<ViewPoint>, DisplayError> {
    let lighting = &scene.lighting;
    let is_diffuse = lighting.directed.is_empty()
        && lighting.environment.is_empty()
        && lighting.front_light.as_ref().is_none_or(|guide| guide.field.is_none());
    if scene.viewer.numerical_aperture.is_some() && !is_diffuse {
        return Err(DisplayError::ApertureInDirectedLight);
    }
    scene.viewer.directions().map(|(theta_deg, phi_deg)| view(scene, index, theta_deg, phi_deg)).collect()
}

fn view(scene: &Scene, index: f64, theta_deg: f64, phi_deg: f64) -> Result<ViewPoint, DisplayError> {
    let aperture = scene.viewer.numerical_aperture;
    // The numerical aperture is the sine in air, whatever the medium of the angles.
    let half_field = aperture.map_or(0.5 * scene.viewer.field_deg, |sine| (sine / index).asin().to_degrees());
    check_above_horizon("view", theta_deg, half_field, index)?;
    let field = Cone::new(theta_deg, phi_deg, half_field, index);
    Ok(ViewPoint { theta_deg, phi_deg, field: if aperture.is_some() { field.of_pupil() } else { field } })
}

impl Setup {
    /// Checks that light is refracted, so that it has places in the layers.
    ///
    /// # Errors
    /// With angles that are the same in all media.
    pub(crate) fn refracts(&self) -> Result<(), DisplayError> {
        match self.scene.solver.angle_medium {
            AngleMedium::Unrefracted => Err(DisplayError::NoRefraction),
            AngleMedium::Air | AngleMedium::Glass => Ok(()),
        }
    }
}

/// Checks that all of a cone is above the horizon in air.
fn check_above_horizon(
    what: &'static str,
    theta_deg: f64,
    half_deg: f64,
    index: f64,
) -> Result<(), DisplayError> {
    let edge_deg = theta_deg.abs() + half_deg;
    if edge_deg < 90.0 && index * edge_deg.to_radians().sin() <= 1.0 {
        Ok(())
    } else {
        Err(DisplayError::BelowHorizon { what, theta_deg, index })
    }
}
