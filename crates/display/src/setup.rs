//! From a scene to what transport needs: the stack, the sources and the views.

use papilio_colour::{Observer, Standard};
use papilio_optics::Beta;
use papilio_optics::film::Coating;
use papilio_optics::rough::Rough;
use papilio_spectra::Spectrum;
use papilio_transport::{
    Base, Cone, Front, Interface, Layer, Layered, Medium, Panel, Reflector, Source, Stack, Top,
};

use crate::DisplayError;
use crate::pixel::{self, FilmKey};
use crate::scene::{self, AngleMedium, Approximation, Layers, Pixel, Scene, Surface};

/// A scene, ready for light.
#[derive(Debug)]
pub(crate) struct Setup {
    /// What everything else here was made for.
    pub(crate) scene: Scene,
    /// Another whenever layers, sources or views are others: what kernels of any layers depend on.
    pub(crate) version: u64,
    /// Another whenever the pixel is: together with `version`, what is seen of each source depends on no more.
    pub(crate) base_version: u64,
    /// What the reflectances in the stack's base belong to, if they are a film's.
    film: Option<FilmKey>,
    pub(crate) stack: Stack,
    /// The diffuse light first, then the directed ones in the scene's order, then the parts of each environment,
    /// then the front light.
    pub(crate) lights: Vec<Light>,
    pub(crate) sources: Vec<Source>,
    pub(crate) views: Vec<ViewPoint>,
    /// Of 1931: light and luminance.
    pub(crate) observer: Observer,
    /// Whose colours are reported, if not those of 1931.
    other_observer: Option<Observer>,
    pub(crate) states: Vec<String>,
}

/// A source's light in the display plane.
#[derive(Debug)]
pub(crate) struct Light {
    /// Spectral irradiance, W/(m2 nm).
    pub(crate) irradiance: Spectrum,
    /// Illuminance, lx.
    pub(crate) illuminance_lx: f64,
    /// What it is a part of: lights are told apart in results by these numbers, from 0.
    pub(crate) term: usize,
}

/// One view.
#[derive(Debug)]
pub(crate) struct ViewPoint {
    pub(crate) theta_deg: f64,
    pub(crate) phi_deg: f64,
    pub(crate) field: Cone,
}

impl Setup {
    pub(crate) fn new(scene: &Scene) -> Result<Self, DisplayError> {
        check(scene)?;
        let observer = Observer::new(&scene.grid)?;
        let angle_index = angle_index(scene)?;
        let mut film = None;
        let base = pixel::base(scene, &mut film, None)?;
        Ok(Self {
            stack: stack(scene, base)?,
            film,
            lights: lights(scene, &observer)?,
            sources: sources(scene, angle_index)?,
            views: views(scene, angle_index)?,
            other_observer: match scene.metrics.observer {
                Standard::Cie1931 => None,
                other => Some(Observer::of(other, &scene.grid)?),
            },
            observer,
            states: pixel::state_names(&scene.display.pixel),
            version: 0,
            base_version: 0,
            scene: scene.clone(),
        })
    }

    /// The same as `new(scene)`, of parts of this one as far as they still serve.
    pub(crate) fn renewed(mut self, scene: &Scene) -> Result<Self, DisplayError> {
        check(scene)?;
        let last = std::mem::replace(&mut self.scene, scene.clone());
        let solver_changed = (scene.solver.angle_medium, scene.solver.approximation)
            != (last.solver.angle_medium, last.solver.approximation);
        let other_observer = scene.metrics.observer != last.metrics.observer;
        if scene.grid != last.grid || solver_changed || other_observer {
            return Ok(Self { version: self.version + 1, ..Self::new(scene)? });
        }
        let index_changed = scene.display.index_above_pixel() != last.display.index_above_pixel();
        if index_changed || scene.display.pixel != last.display.pixel {
            let base = base_of(&mut self.stack);
            *base = pixel::base(scene, &mut self.film, Some(base))?;
            self.states = pixel::state_names(&scene.display.pixel);
            self.base_version += 1;
        }
        if scene.display.layers != last.display.layers {
            let nothing = Base {
                reflector: Reflector::Lambertian(Vec::new()),
                inactive_absorptance: Vec::new().into(),
            };
            let base = std::mem::replace(base_of(&mut self.stack), nothing);
            self.stack = stack(scene, base)?;
            self.version += 1;
        }
        let angle_index = angle_index(scene)?;
        if scene.lighting != last.lighting || index_changed {
            self.lights = lights(scene, &self.observer)?;
            let sources = sources(scene, angle_index)?;
            self.version += u64::from(sources != self.sources);
            self.sources = sources;
        }
        if scene.viewer != last.viewer || index_changed {
            self.views = views(scene, angle_index)?;
            self.version += 1;
        }
        Ok(self)
    }
}

impl Setup {
    /// A view of the scene's field.
    pub(crate) fn view(&self, theta_deg: f64, phi_deg: f64) -> Result<ViewPoint, DisplayError> {
        view(&self.scene, angle_index(&self.scene)?, theta_deg, phi_deg)
    }
}

impl Setup {
    /// Whose colours are reported.
    pub(crate) fn seen_by(&self) -> &Observer {
        self.other_observer.as_ref().unwrap_or(&self.observer)
    }

    /// What each state of the pixel alone reflects in the direction of a view, shape `[state][wavelength]`; false
    /// if it is no mirror.
    pub(crate) fn pixel_alone(&self, base: &Base, at: &ViewPoint, out: &mut [f64]) -> bool {
        if base.is_specular() {
            let beta = at.field.axis_towards();
            base.reflectance(beta.x * beta.x + beta.y * beta.y, &medium(&self.scene), out);
        }
        base.is_specular()
    }
}

/// What lies under the layers.
pub(crate) fn base_under(stack: &Stack) -> &Base {
    match stack {
        Stack::Panel(panel) => &panel.base,
        Stack::Layered(layered) => &layered.base,
    }
}

pub(crate) fn base_of(stack: &mut Stack) -> &mut Base {
    match stack {
        Stack::Panel(panel) => &mut panel.base,
        Stack::Layered(layered) => &mut layered.base,
    }
}

/// The index of the medium that the scene's angles are in.
pub(crate) fn angle_index(scene: &Scene) -> Result<f64, DisplayError> {
    let index = scene.display.index_above_pixel();
    match scene.solver.angle_medium {
        AngleMedium::Air | AngleMedium::Unrefracted => Ok(1.0),
        AngleMedium::Glass if index.is_constant() => Ok(index[0]),
        AngleMedium::Glass => Err(DisplayError::DispersiveGlassAngles),
    }
}

/// What no stack is made for.
fn check(scene: &Scene) -> Result<(), DisplayError> {
    match (&scene.display.layers, &scene.display.pixel) {
        (Layers::Panel(_), Pixel::Scattering(_)) => Err(DisplayError::ScatteringUnderPanel),
        _ => Ok(()),
    }
}

fn stack(scene: &Scene, base: Base) -> Result<Stack, DisplayError> {
    match &scene.display.layers {
        Layers::Panel(panel) => Ok(Stack::Panel(self::panel(scene, panel, base))),
        Layers::General(layers) => Ok(Stack::Layered(Layered { layers: general(scene, layers)?, base })),
    }
}

/// The layers over a base that is none: enough to know what they take.
pub(crate) fn layers_alone(scene: &Scene) -> Result<Stack, DisplayError> {
    let inactive_absorptance = vec![0.0; scene.grid.len()].into();
    stack(scene, Base { reflector: Reflector::Lambertian(Vec::new()), inactive_absorptance })
}

fn panel(scene: &Scene, panel: &scene::Panel, base: Base) -> Panel {
    let single_pass = scene.solver.approximation == Approximation::SinglePass;
    let components = panel.front.iter().map(|c| (&*c.reflectance, &*c.absorptance));
    let bins = scene.grid.len();
    let front =
        if single_pass { Front::first_order(bins, components) } else { Front::exact(bins, components) };
    Panel { front, top: top(panel), medium: medium(scene), base, single_pass }
}

fn general(scene: &Scene, layers: &[scene::Layer]) -> Result<Vec<Layer>, DisplayError> {
    let air = Spectrum::constant(&scene.grid, 1.0);
    let mut above = &air;
    let mut made = Vec::with_capacity(layers.len());
    for layer in layers {
        let interface = interface(scene, &layer.interface, above, &layer.medium.index)?;
        above = &layer.medium.index;
        let medium = Medium::new(above.clone()).with_transmittance(layer.medium.transmittance.clone());
        let medium = match &layer.medium.scattering {
            Some(scattering) => medium.with_scattering(scattering.clone()),
            None => medium,
        };
        made.push(Layer { interface, medium });
    }
    Ok(made)
}

fn interface(
    scene: &Scene,
    interface: &scene::Interface,
    above: &Spectrum,
    below: &Spectrum,
) -> Result<Interface, DisplayError> {
    Ok(match interface {
        scene::Interface::Ready(ready) => ready.clone(),
        scene::Interface::Coating(coating) => {
            let made = Coating::new(&scene.grid.wavelengths_nm(), above, &coating.films, below);
            Interface::Coating(made.map_err(|error| DisplayError::of_coating(error, &coating.key))?)
        }
        scene::Interface::Rough { alpha, distribution } => {
            Interface::Rough(Rough::with(*distribution, *alpha, above[0], below[0]))
        }
    })
}

/// The medium above the pixel; without refraction, the glass is as wide as the air.
pub(crate) fn medium(scene: &Scene) -> Medium {
    let index = scene.display.index_above_pixel();
    let unrefracted = scene.solver.angle_medium == AngleMedium::Unrefracted;
    Medium::new(if unrefracted { index.map(|_| 1.0) } else { index.clone() })
}

fn top(panel: &scene::Panel) -> Top {
    match (&panel.diffuser, panel.glass.surface) {
        (Some(diffuser), _) => Top::Diffuser(diffuser.clone()),
        (None, Surface::Coated) => Top::Coated,
        (None, Surface::Fresnel) => Top::Fresnel(panel.glass.index.clone()),
    }
}

fn lights(scene: &Scene, observer: &Observer) -> Result<Vec<Light>, DisplayError> {
    let lighting = &scene.lighting;
    let light = |term: usize, share: f64, spectrum: &Spectrum| -> Result<Light, DisplayError> {
        let illuminance_lx = share * lighting.illuminance_lx;
        let irradiance = observer.scale_to_illuminance(spectrum, illuminance_lx)?;
        Ok(Light { irradiance, illuminance_lx, term })
    };
    let mut lights = vec![light(0, lighting.diffuse, &lighting.diffuse_spectrum)?];
    for (i, directed) in lighting.directed.iter().enumerate() {
        let cosine = if directed.normal_to_beam { directed.theta_deg.to_radians().cos() } else { 1.0 };
        lights.push(light(1 + i, directed.share * cosine, &directed.spectrum)?);
    }
    for (i, environment) in lighting.environment.iter().enumerate() {
        for part in &environment.parts {
            lights.push(light(1 + lighting.directed.len() + i, part.share, &part.spectrum)?);
        }
    }
    if let Some(guide) = &lighting.front_light {
        let irradiance = observer.scale_to_illuminance(&guide.spectrum, guide.illuminance_lx)?;
        let term = 1 + lighting.directed.len() + lighting.environment.len();
        lights.push(Light { irradiance, illuminance_lx: guide.illuminance_lx, term });
    }
    Ok(lights)
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
    let viewer = &scene.viewer;
    let angles = viewer.phi_deg.iter().flat_map(|phi| viewer.theta_deg.iter().map(|theta| (*theta, *phi)));
    angles.map(|(theta_deg, phi_deg)| view(scene, index, theta_deg, phi_deg)).collect()
}

fn view(scene: &Scene, index: f64, theta_deg: f64, phi_deg: f64) -> Result<ViewPoint, DisplayError> {
    let half_field = 0.5 * scene.viewer.field_deg;
    check_above_horizon("view", theta_deg, half_field, index)?;
    Ok(ViewPoint { theta_deg, phi_deg, field: Cone::new(theta_deg, phi_deg, half_field, index) })
}

/// All of a cone must lie above the horizon of the air.
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
