//! Description of a computation: the display, its lighting and its viewer, with all values resolved.
//!
//! Every spectrum is sampled on `Scene::grid`. Values must be within the documented ranges, which the
//! `scenario` crate checks; [`run`](crate::run()) itself returns errors only for scenes that
//! it cannot compute (a view below the horizon, a film with invalid parameters).

mod place;

use std::sync::Arc;

use num_complex::Complex64;
pub use papilio_colour::{Standard, Surround};
pub use papilio_optics::berreman::{Part as CrystalPart, Slice as CrystalSlice};
pub use papilio_optics::film::{SpectralLayer as FilmLayer, Thickness};
pub use papilio_optics::lobe::Lobe;
pub use papilio_optics::phase::Particles;
pub use papilio_optics::rough::Distribution;
pub use papilio_sampling::Sampler;
use papilio_spectra::{Grid, LightSpectrum, Spectrum};
pub use papilio_transport::spatial::{Rectangle, Window, rows, stripes};
pub use papilio_transport::walk::Strategy;
pub use papilio_transport::{
    Diffuser, Field, Interface as Ready, LobeReflection, PanelParts, ReflectedLobe, ReflectingDiffuser,
    RegularRings, ScatterFace, ScatterKernel, Scattering, Vibration, WaveFace, WaveLight,
};

pub(crate) use self::place::SPREAD_KEY;
pub use self::place::{Filter, FilterState, Length, Matrix, SubPixelWindow};
pub use crate::result::ReferenceWhite;
pub use crate::surface::{Correlation, Goniometer, Surface, SurfaceFace, SurfaceModel, face_by_rays};
pub use crate::target::{Metric, MetricSource, Target, Tolerance};
pub use crate::within_step::WithinStep;

/// Complete description of one computation.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Wavelength grid of all spectra.
    pub grid: Grid,
    /// The display, from the front of screen to the pixel.
    pub display: Display,
    /// Ambient and front light.
    pub lighting: Lighting,
    /// Directions and field of view of the viewer.
    pub viewer: Viewer,
    /// Colorimetric settings.
    pub metrics: Metrics,
    /// Solver and accuracy.
    pub solver: Solver,
    /// Errors of X, Y and Z of each state, relative to a perfect white, because films or liquid crystals change within a step of the
    /// grid, as below flat layers; empty: none.
    pub unresolved: Vec<[f64; 3]>,
    /// What tabulated spectra of the display change within a step of the grid; `None`: nothing.
    pub within_step: Option<Arc<WithinStep>>,
}

/// Colorimetric settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Metrics {
    /// Standard observer for X, Y, Z; luminances always use V(lambda) of CIE 1931.
    pub observer: Standard,
    /// White of L*, a*, b*, u*, v*, the colour differences and the gamut volume. If the front light is the
    /// only light, it is always the display's.
    pub white: ReferenceWhite,
    /// Name of the state with which the others are compared; without such a state there is no comparison.
    pub reference_state: String,
    /// Whether to report reflectance factors under each light alone.
    pub spectra_by_light: bool,
    /// Whether to report the gamut volume.
    pub gamut_volume: bool,
    /// Age of the reader in years, 20 to 75; `None`: not specified.
    pub reader_age_years: Option<f64>,
    /// Height of the lower-case x of text, mm; `None`: not specified.
    pub text_height_mm: Option<f64>,
    /// Viewing conditions; `None`: no colour appearance.
    pub appearance: Option<Appearance>,
}

/// Viewing conditions of CIECAM16.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Appearance {
    /// Adapting luminance, cd/m2; `None`: that of the background.
    pub adapting_luminance_cd_m2: Option<f64>,
    /// Luminance of the background relative to a perfect white in the scene's light, greater than 0 and at
    /// most 1.
    pub background: f64,
    /// Surround of the display.
    pub surround: Surround,
}

impl Default for Metrics {
    fn default() -> Self {
        Self {
            observer: Standard::Cie1931,
            white: ReferenceWhite::Perfect,
            reference_state: "white".to_owned(),
            spectra_by_light: false,
            gamut_volume: false,
            reader_age_years: None,
            text_height_mm: None,
            appearance: None,
        }
    }
}

/// Display: the layers and the pixel below them.
#[derive(Debug, Clone, PartialEq)]
pub struct Display {
    /// The layers above the pixel, top to bottom, from the air to the pixel; at least one.
    pub layers: Vec<Layer>,
    /// The pixel array below the last layer.
    pub pixel: Pixel,
    /// The sub-pixels in the plane of the pixel; `None`: not described.
    pub matrix: Option<Matrix>,
}

impl Display {
    /// Returns the parts of the ordinary panel, if the layers are one.
    pub fn panel(&self) -> Option<PanelParts<'_>> {
        let described = self.layers.iter().map(|layer| {
            let ready = match &layer.interface {
                Interface::Ready(ready) => Some(ready),
                Interface::Coating(_) | Interface::Rough { .. } | Interface::OfSurface(_) => None,
            };
            (ready, &layer.medium.index, layer.medium.is_clear())
        });
        PanelParts::recognised(described).filter(|_| !matches!(self.pixel, Pixel::Scattering(_)))
    }

    /// Returns whether it is an ordinary panel without a diffuser: all layers above the pixel are flat.
    pub fn is_bare(&self) -> bool {
        self.panel().is_some_and(|panel| !matches!(panel.face, Ready::Diffuser(_)))
    }

    /// Returns whether nothing scatters above the pixel.
    pub fn is_flat(&self) -> bool {
        self.layers.iter().all(|layer| layer.interface.is_flat() && layer.medium.scattering.is_none())
    }

    /// Returns whether the last interface or medium above the pixel scatters: what a flat one above that returns to it counts as unpolarised.
    pub fn scatters_above_pixel(&self) -> bool {
        let scatters = |layer: &Layer| !layer.interface.is_flat() || layer.medium.scattering.is_some();
        self.layers.last().is_some_and(scatters)
    }

    /// Returns the refractive index of the medium above the pixel.
    pub fn index_above_pixel(&self) -> &Spectrum {
        // Layers are never empty.
        &self.layers[self.layers.len() - 1].medium.index
    }

    /// Returns the number of the uppermost layer that is no component in air: the surface of the display.
    pub fn surface(&self) -> usize {
        let is_component = |layer: &Layer| matches!(layer.interface, Interface::Ready(Ready::Component(_)));
        self.layers.iter().position(|layer| !is_component(layer)).unwrap_or(0)
    }

    /// True if both displays have the same layers, apart from their thickness: it does not change colours.
    pub fn has_layers_of(&self, other: &Self) -> bool {
        self.layers.len() == other.layers.len()
            && self.layers.iter().zip(&other.layers).all(|(one, other)| one.acts_as(other))
    }
}

/// Layer: an interface and the medium below it.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Interface between the medium above (air for the first layer) and `medium`.
    pub interface: Interface,
    /// Medium below the interface.
    pub medium: Medium,
    /// Thickness of the medium. Colours do not depend on it, only the places of light.
    pub thickness: Length,
    /// What the interface does to the polarisation of light that it scatters.
    pub depolarisation: Depolarisation,
}

impl Layer {
    /// True if both layers are the same, apart from their thickness.
    pub fn acts_as(&self, other: &Self) -> bool {
        self.interface == other.interface
            && self.medium == other.medium
            && self.depolarisation.fraction == other.depolarisation.fraction
    }
}

/// Depolarisation of scattered light. The default is that all of it is unpolarised.
#[derive(Debug, Clone, PartialEq)]
pub struct Depolarisation {
    /// Fraction of the scattered light that leaves unpolarised; the rest keeps the shares of s and p with which it arrived.
    pub fraction: f64,
    /// Key of the fraction in the scenario, for error messages.
    pub key: String,
}

impl Default for Depolarisation {
    fn default() -> Self {
        Self { fraction: 1.0, key: String::new() }
    }
}

/// Interface between two media.
#[derive(Debug, Clone, PartialEq)]
pub enum Interface {
    /// An interface that needs no further preparation.
    Ready(Ready),
    /// Coherent thin films.
    Coating(Coating),
    /// Rough interface between media of constant index.
    Rough {
        /// Roughness alpha, about the largest slope.
        alpha: f64,
        /// Distribution of the slopes.
        distribution: Distribution,
    },
    /// A surface given by its geometry, which is measured when the scene is prepared.
    OfSurface(Arc<SurfaceFace>),
}

impl Interface {
    /// Returns whether it reflects and transmits light without scattering it.
    pub fn is_flat(&self) -> bool {
        use Ready::{Component, Fresnel, IdealAr, Open};
        match self {
            Self::Coating(_) => true,
            Self::Ready(ready) => matches!(ready, Open | IdealAr | Fresnel | Component(_)),
            Self::Rough { .. } | Self::OfSurface(_) => false,
        }
    }
}

impl From<Ready> for Interface {
    fn from(ready: Ready) -> Self {
        Self::Ready(ready)
    }
}

/// Coherent thin films between two media.
#[derive(Debug, Clone, PartialEq)]
pub struct Coating {
    /// Films of fixed thickness, top to bottom.
    pub films: Vec<FilmLayer>,
    /// Key of the coating in the scenario, such as `display.layers.1`, for error messages.
    pub key: String,
}

/// Homogeneous medium.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// Refractive index, at least 1.
    pub index: Spectrum,
    /// Internal transmittance along the normal, 0 to 1.
    pub transmittance: Spectrum,
    /// Scattering in its volume; the index must then be constant.
    pub scattering: Option<Scattering>,
    /// The particles that scatter, whose polarised light is followed; the anisotropy is then theirs.
    pub particles: Option<Particles>,
}

impl Medium {
    /// A medium of this index that neither absorbs nor scatters.
    pub fn clear(index: Spectrum) -> Self {
        let transmittance = index.map(|_| 1.0);
        Self { index, transmittance, scattering: None, particles: None }
    }

    /// True if the medium neither absorbs nor scatters.
    pub fn is_clear(&self) -> bool {
        self.scattering.is_none() && self.transmittance.min() == 1.0
    }
}

/// Pixel array: the reflectance of each drive state.
#[derive(Debug, Clone, PartialEq)]
pub enum Pixel {
    /// Interferometric sub-pixels: thin films with a gap of variable thickness.
    Film(FilmPixel),
    /// States tabulated over angle and wavelength.
    Table(TablePixel),
    /// States whose reflectance does not depend on angle.
    Uniform(UniformPixel),
    /// States given by their BRDFs.
    Scattering(ScatteringPixel),
    /// Liquid-crystal cells, polarisers, retarders and other anisotropic layers over a reflector.
    Crystal(CrystalPixel),
}

impl Pixel {
    /// Returns whether it is a table whose reflectances depend on azimuth.
    pub fn is_azimuthal_table(&self) -> bool {
        matches!(self, Self::Table(table) if !table.phi_deg.is_empty())
    }
}

/// Anisotropic layers over a substrate, whose reflectance depends on azimuth.
#[derive(Debug, Clone, PartialEq)]
pub struct CrystalPixel {
    /// Layers, downwards from the glass, with a list of slices for each state or one for all.
    pub parts: Vec<CrystalPart>,
    /// Complex index n + ik of the opaque, semi-infinite substrate.
    pub substrate: Vec<Complex64>,
    /// Names of the states.
    pub states: Vec<String>,
    /// Fill factor: active fraction of the panel's area, 0 to 1.
    pub fill_factor: f64,
    /// Reflectance of the inactive area.
    pub inactive_reflectance: Spectrum,
}

/// Interferometric sub-pixels that share one film stack.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmPixel {
    /// Layers, downwards from the glass.
    pub layers: Vec<FilmLayer>,
    /// Complex index n + ik of the opaque, semi-infinite substrate.
    pub substrate: Vec<Complex64>,
    /// Names of the materials for reports: of each layer and, last, of the substrate. A missing name is
    /// reported as empty.
    pub materials: Vec<String>,
    /// The sub-pixels, in the order of the scenario.
    pub sub_pixels: Vec<SubPixel>,
    /// Gap of a dark sub-pixel, nm; `None` if no state needs it.
    pub dark_gap_nm: Option<f64>,
    /// Fill factor: active fraction of the panel's area, 0 to 1.
    pub fill_factor: f64,
    /// Reflectance of the inactive area.
    pub inactive_reflectance: Spectrum,
    /// The drive states, in the order of the results.
    pub states: Vec<FilmState>,
}

/// Sub-pixel of an interferometric pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct SubPixel {
    /// Name: `red`, `green`, ...; any name except `dark`.
    pub name: String,
    /// Fraction of the active area; all sum to 1 (within 0.001).
    pub area: f64,
    /// Gap when the sub-pixel shows its colour, nm.
    pub gap_nm: f64,
}

/// Drive state of an interferometric pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmState {
    /// Name: `white`, `black`, ... or any other name.
    pub name: String,
    /// One drive for each sub-pixel, in the order of `sub_pixels`.
    pub drives: Vec<Drive>,
    /// Fractions of the whole area that the sub-pixels have in this state, in the same order; the rest is
    /// inactive. `None`: those of the pixel, by `area` and `fill_factor`. A part of a pixel has others.
    pub areas: Option<Vec<f64>>,
}

/// Drive of a sub-pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// This fraction (0 to 1) of its area shows its colour; the rest is dark.
    Share(f64),
    /// All of its area is at this gap, nm.
    Gap(f64),
}

/// Tabulated states, which include areas and fill factor.
#[derive(Debug, Clone, PartialEq)]
pub struct TablePixel {
    /// Medium of the angles.
    pub angles: TableAngles,
    /// Angles, degrees, ascending from 0.
    pub theta_deg: Vec<f64>,
    /// Azimuths to which light leaves, degrees, ascending in equal steps over half a turn; the reflectance is the same at opposite ones. Empty
    /// if it does not depend on azimuth.
    pub phi_deg: Vec<f64>,
    /// The states, in the order of the table.
    pub states: Vec<TableState>,
}

/// Medium of the angles of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableAngles {
    /// Air, before refraction.
    Air,
    /// The glass above the pixel.
    Glass,
}

/// Tabulated state.
#[derive(Debug, Clone, PartialEq)]
pub struct TableState {
    /// Name of the state.
    pub name: String,
    /// Reflectance spectrum at each angle, `[theta]` or `[theta][phi]`.
    pub reflectance: Vec<Spectrum>,
}

/// States whose reflectance does not depend on angle.
#[derive(Debug, Clone, PartialEq)]
pub struct UniformPixel {
    /// Kind of reflection.
    pub kind: UniformKind,
    /// Name and reflectance of each state.
    pub states: Vec<(String, Spectrum)>,
    /// How far light spreads sideways within Lambertian pixels, mm: where the line spread has decreased to
    /// 1/e; 0: not at all.
    pub spread_mm: f64,
}

/// States given by their BRDFs. Directions are those of the medium above, of constant index: its sines take
/// the place of the sines in air.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatteringPixel {
    /// Name and kernel of each state.
    pub states: Vec<(String, ScatterKernel)>,
}

/// Kind of reflection of a uniform pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UniformKind {
    /// Specular reflection.
    Mirror,
    /// Lambertian reflection: the same basic radiance in all directions of the glass.
    Lambertian,
}

/// Ambient and front light. The fractions of all ambient sources sum to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// Illuminance to which the fractions refer, lx.
    pub illuminance_lx: f64,
    /// Fraction that is uniform over the hemisphere.
    pub diffuse: f64,
    /// Relative spectrum of the diffuse part.
    pub diffuse_spectrum: LightSpectrum,
    /// The directed sources.
    pub directed: Vec<DirectedLight>,
    /// Environments: light from all directions.
    pub environment: Vec<Environment>,
    /// Light of a light guide below the front of screen.
    pub front_light: Option<FrontLight>,
    /// Port of an integrating sphere; `None`: the light is the same everywhere.
    pub port: Option<Port>,
}

/// Round port of an integrating sphere, through which it lights the sample, and the spot that the meter sees in its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Port {
    /// Diameter of the port, mm.
    pub port_mm: f64,
    /// Diameter of the spot, mm; at most that of the port and of the sample.
    pub spot_mm: f64,
    /// Diameter of a round sample, mm; `None`: it is larger than any distance that light moves sideways.
    pub sample_mm: Option<f64>,
}

impl Lighting {
    /// Returns the number of ambient sources: the diffuse light, directed sources and the parts of environments.
    pub fn source_count(&self) -> usize {
        let parts: usize = self.environment.iter().map(|one| one.parts.len()).sum();
        1 + self.directed.len() + parts
    }

    /// The polarisation of each ambient source, directed ones first, with its place in `[lighting]`.
    pub(crate) fn vibrations(&self) -> impl Iterator<Item = (String, Option<Vibration>)> {
        let directed = self.directed.iter().enumerate();
        let directed =
            directed.map(|(i, light)| (format!("lighting.directed.{i}.polarisation"), light.vibration));
        let environment = self.environment.iter().enumerate().flat_map(|(i, one)| {
            let of = move |part: &EnvironmentPart| {
                (format!("lighting.environment.{i}.polarisation"), part.vibration)
            };
            one.parts.iter().map(of)
        });
        directed.chain(environment)
    }
}

impl Scene {
    /// The same scene in unpolarised light, seen without a polariser.
    #[must_use]
    pub fn unpolarised(mut self) -> Self {
        self.viewer.polariser_deg = None;
        self.lighting.directed.iter_mut().for_each(|light| light.vibration = None);
        let parts = self.lighting.environment.iter_mut().flat_map(|one| &mut one.parts);
        parts.for_each(|part| part.vibration = None);
        self
    }

    /// Returns a note if a computation that does so ignores a polariser.
    pub fn ignores_polariser(&self) -> Option<String> {
        self.viewer.polariser_deg.map(|_| {
            "`viewer.polariser` is not used here: this computation has unpolarised light of its own, seen without a polariser"
                .to_owned()
        })
    }
}

/// Front light: a clear light guide below the front of screen and above all other layers.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontLight {
    /// Downward illuminance on the layer below the front of screen, lx, in addition to the ambient
    /// illuminance.
    pub illuminance_lx: f64,
    /// Relative spectrum.
    pub spectrum: LightSpectrum,
    /// Angular distribution of the downward light, as that of a sky; `None`: diffuse. Any other distribution
    /// needs an ordinary panel with a diffuser.
    pub field: Option<Arc<Field>>,
    /// Ratio of the upward light, which is diffuse, to the downward light.
    pub upward_over_downward: f64,
}

/// Environment: light from all directions, such as a sky or a room.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// Parts whose light is added.
    pub parts: Vec<EnvironmentPart>,
}

/// Part of an environment with one spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentPart {
    /// Angular distribution, always in air, independently of the medium of the scene's angles.
    pub field: Arc<Field>,
    /// Fraction of the illuminance in the display plane.
    pub share: f64,
    /// Relative spectrum.
    pub spectrum: LightSpectrum,
    /// Polarisation, of light that is given by a formula; `None`: unpolarised.
    pub vibration: Option<Vibration>,
}

/// Directed source.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectedLight {
    /// Inclination, degrees in air (or glass, see `AngleMedium`); negative: towards phi + 180.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// Fraction of the illuminance.
    pub share: f64,
    /// Relative spectrum.
    pub spectrum: LightSpectrum,
    /// Angular radius of a circular source of uniform radiance, degrees; `None`: collimated.
    pub radius_deg: Option<f64>,
    /// True: the fraction is that across the beam, and cos(theta) times it falls on the display.
    pub normal_to_beam: bool,
    /// Polarisation; `None`: unpolarised.
    pub vibration: Option<Vibration>,
}

/// Viewer. The views are all combinations of theta and phi, with theta varying fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Viewer {
    /// Inclinations, degrees.
    pub theta_deg: Vec<f64>,
    /// Azimuths, degrees.
    pub phi_deg: Vec<f64>,
    /// Full angle of the circular field of view, degrees.
    pub field_deg: f64,
    /// Numerical aperture of an objective, instead of the field of view: its pupil is averaged uniformly. Only in
    /// diffuse light.
    pub numerical_aperture: Option<f64>,
    /// Polariser before the eye: the angle of the light that it passes from the plane of incidence, degrees (p: 0,
    /// s: 90).
    pub polariser_deg: Option<f64>,
    /// Distance of the eye, mm; it determines the angle of text (readability).
    pub distance_mm: f64,
}

impl Viewer {
    /// Returns inclination and azimuth of each view, degrees, in the order of the views of a result.
    pub fn directions(&self) -> impl Iterator<Item = (f64, f64)> {
        self.phi_deg.iter().flat_map(|phi| self.theta_deg.iter().map(move |theta| (*theta, *phi)))
    }

    /// Returns the same viewer with a single view; with the last one if there are not so many.
    pub fn with_view(&self, number: usize) -> Self {
        let (theta_deg, phi_deg) = match self.directions().nth(number).or_else(|| self.directions().last()) {
            Some((theta, phi)) => (vec![theta], vec![phi]),
            None => Default::default(),
        };
        Self { theta_deg, phi_deg, ..*self }
    }
}

/// Solver and accuracy.
#[derive(Debug, Clone, PartialEq)]
pub struct Solver {
    /// The solver.
    pub method: Method,
    /// Stopping criterion.
    pub stop: Stop,
    /// Sample generator of the Monte Carlo solver.
    pub sampler: Sampler,
    /// Strategy of the Monte Carlo solver to draw directions at a diffuser.
    pub scattering: Strategy,
    /// Exact, or with the approximation of Feng 2012.
    pub approximation: Approximation,
    /// Medium of the scene's angles.
    pub angle_medium: AngleMedium,
    /// Seed of the Monte Carlo solver.
    pub seed: u64,
}

/// Solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Adding: deterministic, without noise.
    Adding,
    /// Monte Carlo: unbiased, with standard errors.
    MonteCarlo,
    /// The one that meets the target with less work, estimated from counts.
    Auto,
}

/// Stopping criterion of a solver.
#[derive(Debug, Clone, PartialEq)]
pub enum Stop {
    /// Relative error of Y, the largest over states and views: the standard error of the Monte Carlo solver
    /// or the discretisation error of adding.
    RelativeError {
        /// The relative error, for example 0.001.
        target: f64,
        /// Whether it applies to every wavelength, too, relative to the maximum of the spectrum.
        per_wavelength: bool,
    },
    /// Number of paths for each view (Monte Carlo only).
    Paths(u64),
    /// Tolerance of the standard error of a metric (Monte Carlo only).
    Target(Target),
}

/// Approximation of the light transport.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Approximation {
    /// None: all orders of reflection.
    None,
    /// Single pass (Feng 2012, eq. 3-2, 3-3 and 3-5): front of screen to first order, one reflection by the
    /// pixel.
    SinglePass,
    /// The mean of s and p at each meeting with a face, instead of both through all orders.
    Unpolarised,
}

/// Medium of the angles of viewer and light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleMedium {
    /// Angles in air, refracted by Snell's law.
    Air,
    /// Angles in glass (bare panels with a constant index only).
    Glass,
    /// Angles in air without refraction: the pixel is evaluated as if the angle in air were that in glass.
    Unrefracted,
}
