//! Film pixels: the reflectances at the gaps that the states need, against angle.

use std::ops::Range;

use num_complex::Complex64;
use papilio_optics::film::GapFilm;
use papilio_spectra::{Grid, Spectrum};
use papilio_transport::{AngularTable, Base, Medium, Nodes, Reflector};

use crate::DisplayError;
use crate::scene::{Drive, FilmLayer, FilmPixel};

/// The interpolation error of a film pixel's table is below this reflectance, in
/// each gap, direction and wavelength (checked midway between nodes).
pub const TABLE_ERROR: f64 = 1e-7;

/// Node counts that are tried, fewest first: each has the nodes of the one before and those
/// midway between them. Only extremely thick films need more than the last.
const NODE_COUNTS: [usize; 6] = [33, 65, 129, 257, 513, 1025];

/// A film pixel as the base of a stack.
pub(super) fn base(
    film: &FilmPixel,
    grid: &Grid,
    index: &Spectrum,
    kept: &mut Option<FilmBasis>,
) -> Result<Base, DisplayError> {
    let mixture = Mixture::new(film)?;
    let basis = match kept.take() {
        Some(basis) if basis.serves(film, grid, index, &mixture.gaps_nm) => basis,
        _ => FilmBasis::new(film, grid, index, &mixture.gaps_nm)?,
    };
    let table = mixture.table(Nodes::Cosines(basis.nodes), basis.reflectance.clone(), film);
    *kept = Some(basis);
    let inactive = film.inactive_reflectance.map(|r| (1.0 - film.fill_factor) * (1.0 - r));
    Ok(Base { reflector: Reflector::Specular(table), inactive_absorptance: inactive })
}

/// The reflectances of a film at its gaps, tabulated against direction; what they belong to.
#[derive(Debug)]
pub(crate) struct FilmBasis {
    layers: Vec<FilmLayer>,
    substrate: Vec<Complex64>,
    grid: Grid,
    index: Spectrum,
    gaps_nm: Vec<f64>,
    /// Evenly spaced in cos(theta).
    nodes: usize,
    /// Shape `[node][gap][wavelength]`.
    reflectance: Vec<f64>,
}

impl FilmBasis {
    /// As many nodes as an interpolation error of [`TABLE_ERROR`] needs.
    fn new(film: &FilmPixel, grid: &Grid, index: &Spectrum, gaps_nm: &[f64]) -> Result<Self, DisplayError> {
        let at = |cosines: Vec<f64>| basis_at(film, grid, index, gaps_nm, &cosines);
        let cosine = |node: usize, nodes: usize| node as f64 / (nodes - 1) as f64;
        let mut nodes = NODE_COUNTS[0];
        let mut reflectance = at((0..nodes).map(|node| cosine(node, nodes)).collect())?;
        let width = gaps_nm.len() * grid.len();
        for next in &NODE_COUNTS[1..] {
            let midway: Vec<f64> = (1..*next).step_by(2).map(|node| cosine(node, *next)).collect();
            let exact = at(midway.clone())?;
            let coarse = AngularTable {
                nodes: Nodes::Cosines(nodes),
                basis: reflectance,
                mixture: vec![1.0],
                common: vec![0.0; width],
            };
            let error = interpolation_error(&coarse, &midway, &exact);
            reflectance = interleaved(&coarse.basis, &exact, width);
            nodes = *next;
            if error < TABLE_ERROR {
                break;
            }
        }
        Ok(Self {
            layers: film.layers.clone(),
            substrate: film.substrate.clone(),
            grid: *grid,
            index: index.clone(),
            gaps_nm: gaps_nm.to_vec(),
            nodes,
            reflectance,
        })
    }

    /// True if these are the reflectances of this film at these gaps.
    fn serves(&self, film: &FilmPixel, grid: &Grid, index: &Spectrum, gaps_nm: &[f64]) -> bool {
        self.grid == *grid
            && self.gaps_nm == gaps_nm
            && self.index == *index
            && self.layers == film.layers
            && self.substrate == film.substrate
    }
}

/// The largest difference of `coarse` from the exact values at these cosines. Gaps and
/// wavelengths are alike here: one basis of so many "wavelengths".
fn interpolation_error(coarse: &AngularTable, cosines: &[f64], exact: &[f64]) -> f64 {
    let width = coarse.common.len();
    let medium = Medium::new(vec![1.0; width].into());
    let mut out = vec![0.0; width];
    let mut worst = 0.0_f64;
    for (cosine, exact) in cosines.iter().zip(exact.chunks_exact(width)) {
        coarse.reflectance(1.0 - cosine * cosine, &medium, &mut out);
        worst = out.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(worst, f64::max);
    }
    worst
}

/// Rows of `even` and `odd` in turn; `even` has one more.
fn interleaved(even: &[f64], odd: &[f64], width: usize) -> Vec<f64> {
    let mut rows = Vec::with_capacity(even.len() + odd.len());
    let mut odd = odd.chunks_exact(width);
    for row in even.chunks_exact(width) {
        rows.extend_from_slice(row);
        rows.extend_from_slice(odd.next().unwrap_or_default());
    }
    rows
}

/// Which gaps the states need, and how much of each they hold.
pub(super) struct Mixture {
    pub(super) gaps_nm: Vec<f64>,
    /// Shape `[state][gap]`, fill factor included.
    shares: Vec<f64>,
}

impl Mixture {
    pub(super) fn new(film: &FilmPixel) -> Result<Self, DisplayError> {
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

    pub(super) fn table(&self, nodes: Nodes, basis: Vec<f64>, film: &FilmPixel) -> AngularTable {
        let common = film.inactive_reflectance.iter().map(|r| (1.0 - film.fill_factor) * r).collect();
        AngularTable { nodes, basis, mixture: self.shares.clone(), common }
    }
}

/// What a sine is the sine of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Beta {
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
    cosines: &[f64],
) -> Result<Vec<f64>, DisplayError> {
    let sines: Vec<f64> = cosines.iter().map(|cosine| (1.0 - cosine * cosine).sqrt()).collect();
    film_basis(film, grid, index, gaps_nm, &sines, Beta::InGlass)
}

/// Mean reflectance of s and p; shape `[angle][gap][wavelength]`. A grazing ray in the glass
/// is reflected whole.
pub(super) fn film_basis(
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
