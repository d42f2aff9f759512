//! What is simulated: the display, its light, its viewer, all resolved to numbers.
//!
//! Every spectrum lies on `Scene::grid`. Values are taken as checked against the ranges
//! given here, as the `scenario` crate does; [`run`](crate::run()) itself refuses only what
//! it cannot compute (a view below the horizon, a film that cannot be).

use std::sync::Arc;

use num_complex::Complex64;
pub use papilio_colour::{Standard, Surround};
pub use papilio_optics::film::{SpectralLayer as FilmLayer, Thickness};
pub use papilio_optics::lobe::Lobe;
pub use papilio_optics::rough::Distribution;
pub use papilio_sampling::Sampler;
use papilio_spectra::{Grid, Spectrum};
pub use papilio_transport::walk::Strategy;
pub use papilio_transport::{Diffuser, Field, Interface as Ready, ScatterFace, ScatterKernel, Scattering};

pub use crate::target::{Metric, Target, Tolerance};

/// One computation, complete.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The wavelengths of everything below.
    pub grid: Grid,
    /// The panel, from the front of screen to the pixel.
    pub display: Display,
    /// The room.
    pub lighting: Lighting,
    /// Where the reader looks from.
    pub viewer: Viewer,
    /// What is said of the colours.
    pub metrics: Metrics,
    /// How to compute, and how well.
    pub solver: Solver,
}

/// What is said of the colours.
#[derive(Debug, Clone, PartialEq)]
pub struct Metrics {
    /// Whose X, Y, Z; luminances are photometric (1931) whoever looks.
    pub observer: Standard,
    /// Name of the state that the others are compared with; nothing is if there is no such state.
    pub reference_state: String,
    /// Whether reflectance factors under each light alone are wanted.
    pub spectra_by_light: bool,
    /// Whether the gamut's volume is wanted.
    pub gamut_volume: bool,
    /// Years of the reader, 20 to 75, if reading performance at that age is wanted.
    pub reader_age_years: Option<f64>,
    /// Viewing conditions, if colour appearance is wanted.
    pub appearance: Option<Appearance>,
}

/// Viewing conditions of CIECAM16.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Appearance {
    /// Luminance that the eye is adapted to, cd/m2; `None`: that of the background.
    pub adapting_luminance_cd_m2: Option<f64>,
    /// Luminance of the background over that of a perfect white in the scene's light, above 0 to 1.
    pub background: f64,
    /// What is around the display.
    pub surround: Surround,
}

impl Default for Metrics {
    fn default() -> Self {
        Self {
            observer: Standard::Cie1931,
            reference_state: "white".to_owned(),
            spectra_by_light: false,
            gamut_volume: false,
            reader_age_years: None,
            appearance: None,
        }
    }
}

/// The layers and the pixel under them.
#[derive(Debug, Clone, PartialEq)]
pub struct Display {
    /// What light passes on its way to the pixel.
    pub layers: Layers,
    /// The pixel array under the last layer.
    pub pixel: Pixel,
}

/// The layers above the pixel, in either form.
#[derive(Debug, Clone, PartialEq)]
pub enum Layers {
    /// The ordinary panel, for which both solvers are fastest.
    Panel(Panel),
    /// Any layers, top to bottom, from the air to the pixel; at least one.
    General(Vec<Layer>),
}

impl Display {
    /// The ordinary panel, if it is one.
    pub fn panel(&self) -> Option<&Panel> {
        match &self.layers {
            Layers::Panel(panel) => Some(panel),
            Layers::General(_) => None,
        }
    }

    /// Index of the medium above the pixel.
    pub fn index_above_pixel(&self) -> &Spectrum {
        match &self.layers {
            Layers::Panel(panel) => &panel.glass.index,
            // A stack without layers has no pixel under it; its makers see to that.
            Layers::General(layers) => &layers[layers.len() - 1].medium.index,
        }
    }
}

/// An interface and the medium below it.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Between the medium above (air over the first layer) and `medium`.
    pub interface: Interface,
    /// Below the interface.
    pub medium: Medium,
}

/// What stands between two media.
#[derive(Debug, Clone, PartialEq)]
pub enum Interface {
    /// One of the kinds that need no more than what they hold.
    Ready(Ready),
    /// Coherent thin films.
    Coating(Coating),
    /// A rough face between media of constant index.
    Rough {
        /// Roughness: the largest slopes are about this.
        alpha: f64,
        /// How the slopes are spread.
        distribution: Distribution,
    },
}

impl From<Ready> for Interface {
    fn from(ready: Ready) -> Self {
        Self::Ready(ready)
    }
}

/// Coherent thin films between two media.
#[derive(Debug, Clone, PartialEq)]
pub struct Coating {
    /// Of fixed thickness, top to bottom.
    pub films: Vec<FilmLayer>,
    /// What errors call it: where the scenario describes it, such as `display.layers.1`.
    pub key: String,
}

/// A homogeneous medium.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// Refractive index, at least 1.
    pub index: Spectrum,
    /// Internal transmittance along the normal, 0 to 1.
    pub transmittance: Spectrum,
    /// Scattering in its bulk; the index must then be constant.
    pub scattering: Option<Scattering>,
}

/// The ordinary panel, top to bottom: front, surface or diffuser, clear glass.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Front-of-screen components in air, outermost first.
    pub front: Vec<FrontComponent>,
    /// The diffuser between air and glass, its faces included; `None`: a bare panel.
    pub diffuser: Option<Diffuser>,
    /// The glass.
    pub glass: Glass,
}

/// A front-of-screen component, alike from both sides and at all angles.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontComponent {
    /// Share of the light that it mirrors, 0 to 1.
    pub reflectance: Spectrum,
    /// Share of the light that it absorbs, 0 to 1; the two together at most 1.
    pub absorptance: Spectrum,
}

/// The glass between surface and pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Glass {
    /// Refractive index, at least 1.
    pub index: Spectrum,
    /// Its face towards the air where no diffuser's own faces stand.
    pub surface: Surface,
}

/// The face between air and glass of a bare panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// A perfect antireflection face: |beta| <= 1 passes whole, |beta| > 1 is reflected whole.
    Coated,
    /// A bare face, unpolarised Fresnel.
    Fresnel,
}

/// The pixel array: what each drive state reflects.
#[derive(Debug, Clone, PartialEq)]
pub enum Pixel {
    /// Thin-film sub-pixels with a gap-dependent layer.
    Film(FilmPixel),
    /// States tabulated against angle and wavelength.
    Table(TablePixel),
    /// States that reflect alike at all angles.
    Uniform(UniformPixel),
    /// States that scatter, each by its BRDF; under [`Layers::General`].
    Scattering(ScatteringPixel),
}

/// Interferometric sub-pixels that share one film stack.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmPixel {
    /// Layers from the glass down.
    pub layers: Vec<FilmLayer>,
    /// n + ik of the opaque, semi-infinite substrate.
    pub substrate: Vec<Complex64>,
    /// The sub-pixels, in the order of the scenario.
    pub sub_pixels: Vec<SubPixel>,
    /// Gap of a dark sub-pixel, nm; `None` where no state needs it.
    pub dark_gap_nm: Option<f64>,
    /// Active share of the panel, 0 to 1.
    pub fill_factor: f64,
    /// Reflectance of the inactive rest.
    pub inactive_reflectance: Spectrum,
    /// The drive states, in the order of the results.
    pub states: Vec<FilmState>,
}

/// One sub-pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct SubPixel {
    /// `red`, `green`, ...; free, except `dark`.
    pub name: String,
    /// Share of the active area; all sum to 1 (within .001).
    pub area: f64,
    /// Gap at its own colour, nm.
    pub gap_nm: f64,
}

/// A drive state: what each sub-pixel does, in the order of `sub_pixels`.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmState {
    /// `white`, `black`, ... or the user's own.
    pub name: String,
    /// One drive for each sub-pixel.
    pub drives: Vec<Drive>,
}

/// How a sub-pixel is driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// This share (0 to 1) of its area at its own colour, the rest dark.
    Share(f64),
    /// The whole of it at this gap, nm.
    Gap(f64),
}

/// Complete states from a table (areas and fill factor included).
#[derive(Debug, Clone, PartialEq)]
pub struct TablePixel {
    /// The medium that the angles are in.
    pub angles: TableAngles,
    /// Angles from 0, ascending, in degrees.
    pub theta_deg: Vec<f64>,
    /// The states, in the order of the table.
    pub states: Vec<TableState>,
}

/// The medium of a table's angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TableAngles {
    /// In air, before Snell.
    Air,
    /// In the glass above the pixel.
    Glass,
}

/// One state of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct TableState {
    /// Its name.
    pub name: String,
    /// A reflectance spectrum for each angle.
    pub reflectance: Vec<Spectrum>,
}

/// Angle-independent states.
#[derive(Debug, Clone, PartialEq)]
pub struct UniformPixel {
    /// How it reflects.
    pub kind: UniformKind,
    /// Name and reflectance of each state.
    pub states: Vec<(String, Spectrum)>,
}

/// States that scatter by their BRDF: directions are those of the medium above, of constant index, its sines in
/// the place of those in air.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatteringPixel {
    /// Name and kernel of each state.
    pub states: Vec<(String, ScatterKernel)>,
}

/// How a uniform pixel reflects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UniformKind {
    /// Specularly.
    Mirror,
    /// With the same basic radiance in every direction of the glass.
    Lambertian,
}

/// The room's light. All shares sum to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// Illuminance that the shares refer to, lx.
    pub illuminance_lx: f64,
    /// Share that comes alike from the whole hemisphere.
    pub diffuse: f64,
    /// Relative spectrum of the diffuse part.
    pub diffuse_spectrum: Spectrum,
    /// The directed sources.
    pub directed: Vec<DirectedLight>,
    /// Light from all over the sky or the room.
    pub environment: Vec<Environment>,
    /// Light from a guide below the front of screen.
    pub front_light: Option<FrontLight>,
}

/// A light guide below the front of screen and above all else, itself clear.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontLight {
    /// What it sends down, lx on the layer below the front of screen; beside the room's illuminance.
    pub illuminance_lx: f64,
    /// Relative spectrum.
    pub spectrum: Spectrum,
    /// Directions of what it sends down, as if they came from a sky; `None`: diffuse. Other than diffuse needs an
    /// ordinary panel with a diffuser.
    pub field: Option<Arc<Field>>,
    /// What it sends up, diffusely, over what it sends down.
    pub upward_over_downward: f64,
}

/// Light from all over the sky or the room.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// Its parts, which add up.
    pub parts: Vec<EnvironmentPart>,
}

/// The light of an environment that has one spectrum.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentPart {
    /// Where it comes from, in air whatever the medium of the scene's angles.
    pub field: Arc<Field>,
    /// Share of the illuminance, in the display plane.
    pub share: f64,
    /// Relative spectrum.
    pub spectrum: Spectrum,
}

/// A directed source.
#[derive(Debug, Clone, PartialEq)]
pub struct DirectedLight {
    /// Inclination, degrees in air (or glass, see `AngleMedium`); negative: towards phi + 180.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// Share of the illuminance.
    pub share: f64,
    /// Relative spectrum.
    pub spectrum: Spectrum,
    /// Angular radius of a round source of even radiance; `None`: collimated.
    pub radius_deg: Option<f64>,
    /// True: the share is measured across the beam, and cos(theta) of it falls on the display.
    pub normal_to_beam: bool,
}

/// The views: the product of all theta and phi, theta fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Viewer {
    /// Inclinations, degrees.
    pub theta_deg: Vec<f64>,
    /// Azimuths, degrees.
    pub phi_deg: Vec<f64>,
    /// Full angle of the round field, degrees.
    pub field_deg: f64,
    /// Distance, mm (matters only where the display is not uniform).
    pub distance_mm: f64,
}

/// How to compute.
#[derive(Debug, Clone, PartialEq)]
pub struct Solver {
    /// Which solver.
    pub method: Method,
    /// When to stop.
    pub stop: Stop,
    /// Where the walk's numbers come from.
    pub sampler: Sampler,
    /// How the walk draws directions where a diffuser scatters.
    pub scattering: Strategy,
    /// Exact, or as the dissertation.
    pub approximation: Approximation,
    /// The medium of the scene's angles.
    pub angle_medium: AngleMedium,
    /// Seed of the walk.
    pub seed: u64,
}

/// The solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Deterministic, without noise.
    Adding,
    /// Unbiased Monte Carlo.
    Walk,
}

/// When the solver stops.
#[derive(Debug, Clone, PartialEq)]
pub enum Stop {
    /// At this relative error of Y, largest over states and views: the walk's standard error,
    /// adding's discretisation error.
    RelativeError {
        /// For example 0.001.
        target: f64,
        /// Over every wavelength too, against the spectrum's maximum.
        every_bin: bool,
    },
    /// After this many paths for each view (the walk alone).
    Paths(u64),
    /// When a metric is known to within a tolerance (the walk alone).
    Target(Target),
}

/// How completely light is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Approximation {
    /// All orders.
    None,
    /// Feng 2012, eq. 3-2, 3-3 and 3-5: front of screen to first order, one pass through the panel.
    SinglePass,
}

/// The medium that angles of viewer and light are given in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleMedium {
    /// Angles in air, Snell does the rest.
    Air,
    /// Angles in glass (bare panels with a constant index only).
    Glass,
    /// Angles in air; the pixel is looked up at the air angle as if it were the angle in glass.
    Unrefracted,
}
