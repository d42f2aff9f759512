//! Pixels: what each drive state reflects, as the base of a stack or as an angle scan.
//!
//! A film pixel's states are mixtures of the reflectances at a few gaps. They are
//! tabulated over cos(theta) in the glass, in which a film's reflectance is analytic, as
//! densely as interpolation to [`TABLE_ERROR`] needs.

use std::ops::Range;

use papilio_optics::film::GapFilm;
use papilio_spectra::{Grid, Spectrum};
use papilio_transport::{AngularTable, Base, Medium, Nodes, Reflector};

use crate::scene::{
    AngleMedium, Drive, FilmLayer, FilmPixel, Pixel, Scene, TableAngles, TablePixel, UniformKind,
    UniformPixel,
};
use crate::{DisplayError, prepare};

/// The interpolation error of a film pixel's table is below this reflectance, in
/// each gap, direction and wavelength (checked midway between nodes).
pub const TABLE_ERROR: f64 = 1e-7;

/// Node counts that are tried, fewest first. Only extremely thick films need more than the last.
const NODE_COUNTS: [usize; 6] = [33, 65, 129, 257, 513, 1025];

/// The reflectance of every state against angle, in the scene's angle medium.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelScan {
    /// Angles, degrees.
    pub theta_deg: Vec<f64>,
    /// Wavelengths, nm.
    pub wavelength_nm: Vec<f64>,
    /// Name and reflectance of each state, shape `[angle][wavelength]`.
    pub states: Vec<(String, Vec<f64>)>,
}

/// The names of a pixel's states, in order.
pub fn state_names(pixel: &Pixel) -> Vec<String> {
    match pixel {
        Pixel::Film(film) => film.states.iter().map(|state| state.name.clone()).collect(),
        Pixel::Table(table) => table.states.iter().map(|state| state.name.clone()).collect(),
        Pixel::Uniform(uniform) => uniform.states.iter().map(|(name, _)| name.clone()).collect(),
    }
}

/// The pixel alone, without front, surface or diffuser, at these angles (0 to 90 deg) in
/// the scene's angle medium.
///
/// # Errors
/// If the film cannot be.
pub fn scan(scene: &Scene, theta_deg: &[f64]) -> Result<PixelScan, DisplayError> {
    let pixel = &scene.display.pixel;
    let index = scene.display.index_above_pixel();
    let in_air = scene.solver.angle_medium == AngleMedium::Air;
    let sines: Vec<f64> = theta_deg.iter().map(|theta| theta.to_radians().sin()).collect();
    let bins = scene.grid.len();
    let mut states: Vec<(String, Vec<f64>)> =
        state_names(pixel).into_iter().map(|name| (name, Vec::new())).collect();
    let count = states.len();
    let mut keep = |at_angle: &[f64]| {
        states.iter_mut().zip(at_angle.chunks_exact(bins)).for_each(|((_, all), row)| all.extend(row));
    };
    if let Pixel::Film(film) = pixel {
        let mixture = Mixture::new(film)?;
        let beta = if in_air { Beta::Air } else { Beta::InGlass };
        let basis = film_basis(film, &scene.grid, index, &mixture.gaps_nm, &sines, beta)?;
        for one in basis.chunks_exact(mixture.gaps_nm.len() * bins) {
            let table = mixture.table(Nodes::Constant, one.to_vec(), film);
            let mut out = vec![0.0; count * bins];
            table.reflectance(0.0, &Medium::new(index.clone()), &mut out);
            keep(&out);
        }
    } else {
        let base = base(scene)?;
        let medium = prepare::medium(scene);
        let scale = prepare::angle_index(scene)?;
        for sine in sines {
            let mut out = vec![0.0; count * bins];
            base.reflectance((scale * sine).powi(2), &medium, &mut out);
            keep(&out);
        }
    }
    if states.iter().any(|(_, values)| values.iter().any(|value| !value.is_finite())) {
        return Err(DisplayError::NotFinite);
    }
    let wavelength_nm = scene.grid.wavelengths_nm();
    Ok(PixelScan { theta_deg: theta_deg.to_vec(), wavelength_nm, states })
}

/// The pixel as the base of a stack.
pub(crate) fn base(scene: &Scene) -> Result<Base, DisplayError> {
    match &scene.display.pixel {
        Pixel::Film(film) => film_base(film, &scene.grid, scene.display.index_above_pixel()),
        Pixel::Table(table) => Ok(table_base(table, scene.grid.len())),
        Pixel::Uniform(uniform) => Ok(uniform_base(uniform, scene.grid.len())),
    }
}

fn uniform_base(pixel: &UniformPixel, bins: usize) -> Base {
    let values: Vec<f64> = pixel.states.iter().flat_map(|(_, r)| r.iter().copied()).collect();
    let reflector = match pixel.kind {
        UniformKind::Lambertian => Reflector::Lambertian(values),
        UniformKind::Mirror => {
            Reflector::Specular(states_as_table(Nodes::Constant, values, pixel.states.len(), bins))
        }
    };
    Base { reflector, inactive_absorptance: vec![0.0; bins].into() }
}

fn table_base(pixel: &TablePixel, bins: usize) -> Base {
    let radians = pixel.theta_deg.iter().map(|theta| theta.to_radians()).collect();
    let nodes = match pixel.angles {
        TableAngles::Air => Nodes::AnglesInAir(radians),
        TableAngles::Glass => Nodes::AnglesInMedium(radians),
    };
    let rows =
        |angle: usize| pixel.states.iter().flat_map(move |state| state.reflectance[angle].iter().copied());
    let values = (0..pixel.theta_deg.len()).flat_map(rows).collect();
    let table = states_as_table(nodes, values, pixel.states.len(), bins);
    Base { reflector: Reflector::Specular(table), inactive_absorptance: vec![0.0; bins].into() }
}

/// A table whose basis is the states themselves.
fn states_as_table(nodes: Nodes, basis: Vec<f64>, states: usize, bins: usize) -> AngularTable {
    let unit = |k: usize| if k / states == k % states { 1.0 } else { 0.0 };
    AngularTable { nodes, basis, mixture: (0..states * states).map(unit).collect(), common: vec![0.0; bins] }
}

fn film_base(film: &FilmPixel, grid: &Grid, index: &Spectrum) -> Result<Base, DisplayError> {
    let mixture = Mixture::new(film)?;
    let inactive = film.inactive_reflectance.map(|r| (1.0 - film.fill_factor) * (1.0 - r));
    let table = |nodes: usize| -> Result<AngularTable, DisplayError> {
        let cosines = (0..nodes).map(|node| node as f64 / (nodes - 1) as f64);
        let basis = basis_at(film, grid, index, &mixture.gaps_nm, cosines)?;
        Ok(mixture.table(Nodes::Cosines(nodes), basis, film))
    };
    let mut found = table(NODE_COUNTS[0])?;
    for nodes in &NODE_COUNTS[1..] {
        // The next table has the midpoints of this one among its nodes.
        let next = table(*nodes)?;
        let good = interpolation_error(&found, &next) < TABLE_ERROR;
        found = next;
        if good {
            break;
        }
    }
    Ok(Base { reflector: Reflector::Specular(found), inactive_absorptance: inactive })
}

/// The largest difference of `coarse` from the nodes of `fine` that it does not have.
fn interpolation_error(coarse: &AngularTable, fine: &AngularTable) -> f64 {
    let width = fine.basis_count() * fine.common.len();
    let identity = AngularTable {
        mixture: states_as_table(Nodes::Constant, Vec::new(), fine.basis_count(), 0).mixture,
        common: vec![0.0; fine.common.len()],
        ..coarse.clone()
    };
    let medium = Medium::new(vec![1.0; fine.common.len()].into());
    let mut out = vec![0.0; width];
    let nodes = fine.nodes.count();
    let mut worst = 0.0_f64;
    for node in (1..nodes).step_by(2) {
        let cosine = node as f64 / (nodes - 1) as f64;
        identity.reflectance(1.0 - cosine * cosine, &medium, &mut out);
        let exact = &fine.basis[node * width..][..width];
        worst = out.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(worst, f64::max);
    }
    worst
}

/// Which gaps the states need, and how much of each they hold.
struct Mixture {
    gaps_nm: Vec<f64>,
    /// Shape `[state][gap]`, fill factor included.
    shares: Vec<f64>,
}

impl Mixture {
    fn new(film: &FilmPixel) -> Result<Self, DisplayError> {
        let mut gaps_nm: Vec<f64> = Vec::new();
        let mut place = |gap: f64| {
            gaps_nm.iter().position(|&known| known == gap).unwrap_or_else(|| {
                gaps_nm.push(gap);
                gaps_nm.len() - 1
            })
        };
        let mut parts: Vec<(usize, usize, f64)> = Vec::new();
        for (s, state) in film.states.iter().enumerate() {
            for (sub_pixel, drive) in film.sub_pixels.iter().zip(&state.drives) {
                let share = film.fill_factor * sub_pixel.area;
                match *drive {
                    Drive::Gap(gap) => parts.push((s, place(gap), share)),
                    Drive::Share(on) => {
                        if on > 0.0 {
                            parts.push((s, place(sub_pixel.gap_nm), share * on));
                        }
                        if on < 1.0 {
                            let missing = || DisplayError::NoDarkGap { state: state.name.clone() };
                            let dark = film.dark_gap_nm.ok_or_else(missing)?;
                            parts.push((s, place(dark), share * (1.0 - on)));
                        }
                    }
                }
            }
        }
        let mut shares = vec![0.0; film.states.len() * gaps_nm.len()];
        for (state, gap, share) in parts {
            shares[state * gaps_nm.len() + gap] += share;
        }
        Ok(Self { gaps_nm, shares })
    }

    fn table(&self, nodes: Nodes, basis: Vec<f64>, film: &FilmPixel) -> AngularTable {
        let common = film.inactive_reflectance.iter().map(|r| (1.0 - film.fill_factor) * r).collect();
        AngularTable { nodes, basis, mixture: self.shares.clone(), common }
    }
}

/// What a sine is the sine of.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Beta {
    /// The angle in air: beta is the sine.
    Air,
    /// The angle in glass: beta is the index times the sine.
    InGlass,
}

fn basis_at(
    film: &FilmPixel,
    grid: &Grid,
    index: &Spectrum,
    gaps_nm: &[f64],
    cosines: impl Iterator<Item = f64>,
) -> Result<Vec<f64>, DisplayError> {
    let sines: Vec<f64> = cosines.map(|cosine| (1.0 - cosine * cosine).sqrt()).collect();
    film_basis(film, grid, index, gaps_nm, &sines, Beta::InGlass)
}

/// Mean reflectance of s and p; shape `[angle][gap][wavelength]`. A grazing ray in the glass
/// is reflected whole.
fn film_basis(
    film: &FilmPixel,
    grid: &Grid,
    index: &Spectrum,
    gaps_nm: &[f64],
    sines: &[f64],
    kind: Beta,
) -> Result<Vec<f64>, DisplayError> {
    let bins = grid.len();
    let mut basis = vec![0.0; sines.len() * gaps_nm.len() * bins];
    let wavelengths_nm = grid.wavelengths_nm();
    let part = |bins: Range<usize>, out: &mut [f64]| -> Result<(), DisplayError> {
        let layers: Vec<_> = film.layers.iter().map(|layer| layer_at(layer, &bins)).collect();
        let substrate = &film.substrate[bins.clone()];
        let gap_film = GapFilm::new(&wavelengths_nm[bins.clone()], &index[bins.clone()], &layers, substrate)?;
        let scale = if kind == Beta::Air { 1.0 } else { index[bins.start] };
        let beta: Vec<f64> = sines.iter().map(|sine| scale * sine).collect();
        Ok(gap_film.reflectance(&beta, gaps_nm, out)?)
    };
    if kind == Beta::Air || index.is_constant() {
        part(0..bins, &mut basis)?;
    } else {
        // The same angle in a dispersive glass has another beta at each wavelength.
        let mut one = vec![0.0; sines.len() * gaps_nm.len()];
        for bin in 0..bins {
            part(bin..bin + 1, &mut one)?;
            one.iter().enumerate().for_each(|(k, value)| basis[k * bins + bin] = *value);
        }
    }
    for (angle, sine) in sines.iter().enumerate() {
        let row = &mut basis[angle * gaps_nm.len() * bins..][..gaps_nm.len() * bins];
        for (k, value) in row.iter_mut().enumerate() {
            let beta = if kind == Beta::Air { *sine } else { sine * index[k % bins] };
            if beta >= index[k % bins] {
                *value = 1.0;
            }
        }
    }
    Ok(basis)
}

fn layer_at(layer: &FilmLayer, bins: &Range<usize>) -> FilmLayer {
    FilmLayer { index: layer.index[bins.clone()].to_vec(), thickness: layer.thickness }
}
