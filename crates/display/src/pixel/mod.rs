//! Reflectance of pixels: the base of a stack, and angle scans of the pixel alone.
//!
//! The reflectances of the states of a film pixel are mixtures of those at a few gaps, which are
//! tabulated over cos(theta) in the glass. The reflectance of a film is an analytic function of it, and the
//! table is as dense as an interpolation error of [`TABLE_ERROR`] requires.

mod absorption;
mod azimuth;
mod crystal;
pub(crate) mod film;
mod table;
mod weighted;

use std::sync::Arc;

use papilio_transport::{AngularTable, Base, Medium, Mueller, Nodes, Reflector, Stack};

pub use absorption::{PixelAbsorption, PixelLayer, SubPixelAbsorption, absorption};
pub(crate) use crystal::{AZIMUTH_BELOW_SCATTERER, TABLE_ERROR as CRYSTAL_TABLE_ERROR};
pub(crate) use film::FilmKey;
use film::{Beta, Film, Mixture};
pub use table::TABLE_ERROR;
pub(crate) use weighted::{SeenLight, WeightedNodes, WeightedTable};

use crate::run::Control;
use crate::scene::{
    AngleMedium, DirectedLight, Drive, FilmState, Method, Pixel, ScatteringPixel, Scene, Stop, TableAngles,
    TablePixel, UniformKind, UniformPixel,
};
use crate::{DisplayError, polarisation, setup};

/// Reflectance of all states of a pixel against angle, in the medium of the scene's angles.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelScan {
    /// Angles, degrees.
    pub theta_deg: Vec<f64>,
    /// Azimuths to which light leaves, degrees; empty if the reflectance is the same at all azimuths.
    pub phi_deg: Vec<f64>,
    /// Wavelengths, nm.
    pub wavelength_nm: Vec<f64>,
    /// Name and reflectance of each state, shape `[angle][wavelength]` or `[angle][azimuth][wavelength]`.
    pub states: Vec<(String, Vec<f64>)>,
}

/// Returns the names of a pixel's states, in order.
pub fn state_names(pixel: &Pixel) -> Vec<String> {
    match pixel {
        Pixel::Film(film) => film.states.iter().map(|state| state.name.clone()).collect(),
        Pixel::Table(table) => table.states.iter().map(|state| state.name.clone()).collect(),
        Pixel::Uniform(uniform) => uniform.states.iter().map(|(name, _)| name.clone()).collect(),
        Pixel::Scattering(pixel) => pixel.states.iter().map(|(name, _)| name.clone()).collect(),
        Pixel::Crystal(pixel) => pixel.states.clone(),
    }
}

/// States that mix sub-pixels, by their usual names.
const MIXTURES: [&str; 5] = ["white", "black", "cyan", "magenta", "yellow"];

/// Returns true for the usual names of states that mix sub-pixels: white, black, cyan, magenta and yellow.
pub fn is_mixture(state: &str) -> bool {
    MIXTURES.contains(&state)
}

/// Returns the names of the states that drive one sub-pixel, in order. Only their peak wavelength describes
/// the pixel: that of a mixture jumps between the peaks of its parts. Where the sub-pixels are not known
/// (tables, uniform pixels), these are all states except white, black, cyan, magenta and yellow.
pub fn primaries(pixel: &Pixel) -> Vec<String> {
    let Pixel::Film(film) = pixel else {
        let names = state_names(pixel).into_iter();
        return names.filter(|name| !is_mixture(name)).collect();
    };
    let is_driven = |drive: &Drive| match drive {
        Drive::Share(share) => *share > 0.0,
        Drive::Gap(gap) => Some(*gap) != film.dark_gap_nm,
    };
    let drives_one = |state: &&FilmState| state.drives.iter().filter(|drive| is_driven(drive)).count() == 1;
    film.states.iter().filter(drives_one).map(|state| state.name.clone()).collect()
}

/// Computes [`scan_at`] azimuth 0, which is any azimuth of all pixels but liquid crystals and tables with azimuths.
///
/// # Errors
/// If the film is invalid, or the pixel scatters.
pub fn scan(scene: &Scene, theta_deg: &[f64]) -> Result<PixelScan, DisplayError> {
    scan_at(scene, theta_deg, &[0.0])
}

/// Computes the reflectance of the pixel alone, without front, surface or diffuser, at these angles (0 to 90
/// deg) in the medium of the scene's angles, seen from each of the azimuths `phi_deg`, at least one.
///
/// # Errors
/// If the film is invalid, or the pixel scatters.
pub fn scan_at(scene: &Scene, theta_deg: &[f64], phi_deg: &[f64]) -> Result<PixelScan, DisplayError> {
    let pixel = &scene.display.pixel;
    if let Pixel::Scattering(_) = pixel {
        return Err(DisplayError::ScanOfScattering);
    }
    let index = scene.display.index_above_pixel();
    let in_air = scene.solver.angle_medium == AngleMedium::Air;
    let sines: Vec<f64> = theta_deg.iter().map(|theta| theta.to_radians().sin()).collect();
    let bins = scene.grid.len();
    let mut states: Vec<(String, Vec<f64>)> =
        state_names(pixel).into_iter().map(|name| (name, Vec::new())).collect();
    let count = states.len();
    let mut keep = |in_direction: &[f64]| {
        states.iter_mut().zip(in_direction.chunks_exact(bins)).for_each(|((_, all), row)| all.extend(row));
    };
    let is_azimuthal = if let Pixel::Film(film) = pixel {
        let mixture = Mixture::new(film)?;
        let beta = if in_air { Beta::Air } else { Beta::InGlass };
        let basis = Film::new(film, &scene.grid, index, &mixture.gaps_nm, beta)?.reflectance(&sines)?;
        for one in basis.chunks_exact(mixture.gaps_nm.len() * bins) {
            let table = mixture.table(Nodes::Constant, one.into(), film);
            let mut out = vec![0.0; count * bins];
            table.reflectance(0.0, &Medium::new(index.clone()), &mut out);
            keep(&out);
        }
        false
    } else if let Pixel::Crystal(pixel) = pixel {
        // Without reciprocity, and without the table: as a test of both.
        let crystal = crystal::Crystal::new(pixel, &scene.grid, index)?;
        let is_azimuthal = crystal.is_azimuthal(in_air)?;
        let phi_deg = if is_azimuthal { phi_deg } else { &[0.0] };
        for sine in sines {
            let mut out = crystal.reflectance(sine, in_air, phi_deg)?;
            let inactive = pixel.inactive_reflectance.iter().map(|r| (1.0 - pixel.fill_factor) * r);
            let inactive: Vec<f64> = inactive.collect();
            for row in out.chunks_exact_mut(bins) {
                row.iter_mut().zip(&inactive).for_each(|(r, more)| *r = *r * pixel.fill_factor + more);
            }
            out.chunks_exact(count * bins).for_each(&mut keep);
        }
        is_azimuthal
    } else {
        let base = base(scene, &mut None, None, (None, None))?;
        let medium = setup::medium(scene);
        let scale = setup::angle_index(scene)?;
        let mut out = vec![0.0; count * bins];
        for sine in sines {
            if !base.is_azimuthal() {
                base.reflectance((scale * sine).powi(2), &medium, &mut out);
                keep(&out);
                continue;
            }
            for phi_deg in phi_deg {
                let (sin, cos) = phi_deg.to_radians().sin_cos();
                let beta = papilio_optics::Beta { x: scale * sine * cos, y: scale * sine * sin };
                base.reflectance_towards(beta, &medium, &mut out);
                keep(&out);
            }
        }
        base.is_azimuthal()
    };
    if states.iter().any(|(_, values)| values.iter().any(|value| !value.is_finite())) {
        return Err(DisplayError::NotFinite);
    }
    let wavelength_nm = scene.grid.wavelengths_nm();
    let phi_deg = if is_azimuthal { phi_deg.to_vec() } else { Vec::new() };
    Ok(PixelScan { theta_deg: theta_deg.to_vec(), phi_deg, wavelength_nm, states })
}

/// Computes the pixel as the base of a stack. The reflectances of a film are taken from the previous base,
/// `before`, if they are still valid; `film` describes the film to which they belong. A liquid crystal need only be known between these `cosines`.
pub(crate) fn base(
    scene: &Scene,
    film: &mut Option<FilmKey>,
    before: Option<&Base>,
    (cosines, control): (Option<&[[f64; 2]]>, Option<&Control<'_>>),
) -> Result<Base, DisplayError> {
    let index = scene.display.index_above_pixel();
    if !matches!(scene.display.pixel, Pixel::Film(_)) {
        *film = None;
    }
    match &scene.display.pixel {
        Pixel::Film(pixel) => film::base(pixel, &scene.grid, index, film, before),
        Pixel::Table(table) => Ok(table_base(table, scene.grid.len())),
        Pixel::Uniform(uniform) => Ok(uniform_base(uniform, scene.grid.len())),
        Pixel::Scattering(pixel) => Ok(scattering_base(pixel, scene.grid.len())),
        Pixel::Crystal(pixel) => {
            // Between the pixel and general layers, all directions of the glass occur.
            let unrefracted = scene.solver.angle_medium == AngleMedium::Unrefracted;
            let has_filter = scene.display.filter().is_some();
            let is_bare = scene.display.is_flat();
            let by_adding =
                scene.solver.method == Method::Adding && !has_filter && scene.display.layers.len() > 1;
            let (polarised, phases) = (false, false);
            let seen = crystal::Seen { is_bare, by_adding, unrefracted, polarised, phases, cosines };
            Ok(crystal::base(pixel, &scene.grid, index, seen, control)?.0)
        }
    }
}

/// Pixel as the base of a stack.
#[derive(Debug)]
pub(crate) struct Bases {
    /// For unpolarised light.
    pub(crate) mean: Base,
    /// For light of s and of p, if the stack keeps them apart.
    pub(crate) polarised: Option<[Base; 2]>,
    /// Real and imaginary part of the product of both amplitudes, p times s*, if their phase is followed.
    pub(crate) products: Option<[Base; 2]>,
    /// For polarised light, if the pixel changes its polarisation and that is followed.
    pub(crate) mueller: Option<Arc<Mueller>>,
}

/// Light that a pixel is computed for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Light<'a> {
    /// s and p are kept apart.
    pub(crate) kept_apart: bool,
    /// The phase between them is followed, too.
    pub(crate) phases: bool,
    /// Ranges of the cosine in the glass; `None`: all.
    pub(crate) cosines: Option<&'a [[f64; 2]]>,
}

/// Computes the pixel as the base of a stack, as [`base`] does, for this light.
pub(crate) fn bases(
    scene: &Scene,
    film: &mut Option<FilmKey>,
    before: Option<&Stack>,
    Light { kept_apart, phases, cosines }: Light<'_>,
    control: &Control<'_>,
) -> Result<Bases, DisplayError> {
    match &scene.display.pixel {
        Pixel::Film(pixel) if kept_apart => {
            let index = scene.display.index_above_pixel();
            let bases = film::polarised_bases(pixel, &scene.grid, index, film, before)?;
            let products = match phases {
                true => Some(film::products(pixel, &scene.grid, index)?),
                false => None,
            };
            Ok(Bases { products, ..bases })
        }
        Pixel::Crystal(pixel) if kept_apart || polarisation::is_whole(scene) => {
            let phases = polarisation::needs_whole(scene);
            let seen = crystal::Seen {
                is_bare: !kept_apart,
                by_adding: scene.solver.method == Method::Adding,
                unrefracted: false,
                polarised: true,
                phases,
                cosines,
            };
            let index = scene.display.index_above_pixel();
            if cosines.is_some() && has_few_directions(scene) {
                let (mean, mueller) = crystal::exact(pixel, &scene.grid, index)?;
                return Ok(Bases { mean, polarised: None, products: None, mueller: Some(mueller) });
            }
            let made = crystal::base(pixel, &scene.grid, index, seen, Some(control));
            let (mean, mueller) = match made {
                // The reflectance for unpolarised light may have fewer fringes than the other elements.
                Err(DisplayError::CrystalFringes) => {
                    let seen = crystal::Seen { polarised: false, ..seen };
                    crystal::base(pixel, &scene.grid, index, seen, Some(control))?
                }
                made => made?,
            };
            Ok(Bases { mean, polarised: None, products: None, mueller })
        }
        // Tables and uniform pixels have one reflectance for both.
        _ => {
            let mean = base(scene, film, before.map(Stack::base), (cosines, Some(control)))?;
            let polarised = kept_apart.then(|| [mean.clone(), mean.clone()]);
            let products = phases.then(|| products_of_metal(&mean));
            Ok(Bases { mean, polarised, products, mueller: None })
        }
    }
}

/// Returns the product of both amplitudes of a mirror that reflects s and p equally, as metal does along the normal: with opposite signs.
fn products_of_metal(mirror: &Base) -> [Base; 2] {
    let times = |factor: f64| {
        let mut base = mirror.clone();
        if let Reflector::Specular(table) = &mut base.reflector {
            table.basis = table.basis.iter().map(|value| factor * value).collect();
            table.common.iter_mut().for_each(|value| *value *= factor);
        }
        base
    };
    [times(-1.0), times(0.0)]
}

/// Returns whether adding sees a display from few directions: each is then computed, without a table.
pub(crate) fn has_few_directions(scene: &Scene) -> bool {
    const MOST_AZIMUTHS: usize = 8;
    const WIDEST_DEG: f64 = 4.0;
    let is_small = |lamp: &DirectedLight| lamp.radius_deg.is_none_or(|radius_deg| radius_deg <= WIDEST_DEG);
    // Below a colour filter, paths have many directions.
    let is_by_paths = || match scene.solver.method {
        Method::Auto => !matches!(scene.solver.stop, Stop::RelativeError { .. }) || !is_ordinary(scene),
        method => method == Method::MonteCarlo,
    };
    scene.solver.method != Method::MonteCarlo
        && (scene.display.filter().is_none() || !is_by_paths())
        && scene.viewer.phi_deg.len() <= MOST_AZIMUTHS
        && scene.viewer.field_deg <= WIDEST_DEG
        && scene.lighting.directed.iter().all(is_small)
}

/// Returns whether a display is an ordinary panel with one sheet before it at most: adding knows places in its front.
fn is_ordinary(scene: &Scene) -> bool {
    scene.display.panel().is_some_and(|panel| panel.front.len() < 2)
}

fn uniform_base(pixel: &UniformPixel, bins: usize) -> Base {
    let values: Vec<f64> = pixel.states.iter().flat_map(|(_, r)| r.iter().copied()).collect();
    let reflector = match pixel.kind {
        UniformKind::Lambertian => Reflector::lambertian(values, bins),
        UniformKind::Mirror => {
            Reflector::Specular(states_as_table(Nodes::Constant, values, pixel.states.len(), bins))
        }
    };
    Base { reflector, inactive_absorptance: vec![0.0; bins].into() }
}

fn scattering_base(pixel: &ScatteringPixel, bins: usize) -> Base {
    let kernels = pixel.states.iter().map(|(_, kernel)| kernel.clone());
    Base { reflector: Reflector::scattering(kernels), inactive_absorptance: vec![0.0; bins].into() }
}

fn table_base(pixel: &TablePixel, bins: usize) -> Base {
    let radians = pixel.theta_deg.iter().map(|theta| theta.to_radians()).collect();
    let nodes = match pixel.angles {
        TableAngles::Air => Nodes::AnglesInAir(radians),
        TableAngles::Glass => Nodes::AnglesInMedium(radians),
    };
    let table = if pixel.phi_deg.is_empty() {
        let rows = |angle: usize| {
            pixel.states.iter().flat_map(move |state| state.reflectance[angle].iter().copied())
        };
        let values = (0..pixel.theta_deg.len()).flat_map(rows).collect();
        states_as_table(nodes, values, pixel.states.len(), bins)
    } else {
        azimuth::table(pixel, nodes, bins)
    };
    Base { reflector: Reflector::Specular(table), inactive_absorptance: vec![0.0; bins].into() }
}

/// Returns a table whose basis reflectances are those of the states.
fn states_as_table(nodes: Nodes, basis: Vec<f64>, states: usize, bins: usize) -> AngularTable {
    let unit = |k: usize| if k / states == k % states { 1.0 } else { 0.0 };
    AngularTable {
        nodes,
        basis: basis.into(),
        mixture: (0..states * states).map(unit).collect(),
        common: vec![0.0; bins],
    }
}
