//! Film pixels: the reflectances at the gaps that the states need, against angle.

use std::sync::Arc;

use num_complex::Complex64;
use papilio_optics::film::GapFilm;
use papilio_spectra::{Grid, Spectrum};
use papilio_transport::{AngularTable, Base, Nodes, Reflector};

use super::table;
use crate::DisplayError;
use crate::scene::{Drive, FilmLayer, FilmPixel};

/// A film pixel as the base of a stack; of `before`, the base of a stack whose film is described
/// by `kept`, what still serves is taken.
pub(super) fn base(
    film: &FilmPixel,
    grid: &Grid,
    index: &Spectrum,
    kept: &mut Option<FilmKey>,
    before: Option<&Base>,
) -> Result<Base, DisplayError> {
    let mixture = Mixture::new(film)?;
    let key = kept.take().filter(|key| key.serves(film, grid, index, &mixture.gaps_nm));
    let table = match before.map(|base| &base.reflector) {
        Some(Reflector::Specular(table)) => Some(table),
        _ => None,
    };
    let (nodes, reflectance) = match table {
        Some(table) if key.is_some() => (table.nodes.clone(), Arc::clone(&table.basis)),
        _ => tabulated(film, grid, index, &mixture.gaps_nm, table.map(|table| &table.nodes))?,
    };
    *kept = Some(key.unwrap_or_else(|| FilmKey::new(film, grid, index, &mixture.gaps_nm)));
    let inactive = film.inactive_reflectance.map(|r| (1.0 - film.fill_factor) * (1.0 - r));
    let table = mixture.table(nodes, reflectance, film);
    Ok(Base { reflector: Reflector::Specular(table), inactive_absorptance: inactive })
}

/// What a film's reflectances depend on.
#[derive(Debug)]
pub(crate) struct FilmKey {
    layers: Vec<FilmLayer>,
    substrate: Vec<Complex64>,
    grid: Grid,
    index: Spectrum,
    gaps_nm: Vec<f64>,
}

impl FilmKey {
    fn new(film: &FilmPixel, grid: &Grid, index: &Spectrum, gaps_nm: &[f64]) -> Self {
        Self {
            layers: film.layers.clone(),
            substrate: film.substrate.clone(),
            grid: *grid,
            index: index.clone(),
            gaps_nm: gaps_nm.to_vec(),
        }
    }

    /// True if the reflectances are those of this film at these gaps.
    fn serves(&self, film: &FilmPixel, grid: &Grid, index: &Spectrum, gaps_nm: &[f64]) -> bool {
        self.grid == *grid
            && self.gaps_nm == gaps_nm
            && self.index == *index
            && self.layers == film.layers
            && self.substrate == film.substrate
    }
}

/// Most panels that are too wide for a film are so at any of these many wavelengths (which fill a
/// wide register).
const BINS_OF_SAMPLE: usize = 8;

/// The reflectances at the gaps, shape `[node][gap][wavelength]`. The nodes of the last film's table,
/// if it was much like this one, save time.
pub(crate) fn tabulated(
    film: &FilmPixel,
    grid: &Grid,
    index: &Spectrum,
    gaps_nm: &[f64],
    last: Option<&Nodes>,
) -> Result<(Nodes, Arc<[f64]>), DisplayError> {
    let known = match last {
        Some(Nodes::CosinePanels(panels)) => Some(panels),
        _ => None,
    };
    let whole = Film::new(film, grid, index, gaps_nm, Beta::InGlass)?;
    let few: Vec<usize> = (0..grid.len()).step_by(grid.len().div_ceil(BINS_OF_SAMPLE).max(1)).collect();
    let sample = Film::at_bins(film, grid, index, gaps_nm, Beta::InGlass, &few)?;
    let (panels, values) =
        table::panels(known, |cosines| sample.at_cosines(cosines), |cosines| whole.at_cosines(cosines))?;
    Ok((Nodes::CosinePanels(panels), values))
}

/// Which gaps the states need, and how much of each they hold.
pub(crate) struct Mixture {
    pub(crate) gaps_nm: Vec<f64>,
    /// Shape `[state][gap]`, fill factor included.
    shares: Vec<f64>,
}

impl Mixture {
    pub(crate) fn new(film: &FilmPixel) -> Result<Self, DisplayError> {
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

    pub(crate) fn table(&self, nodes: Nodes, basis: Arc<[f64]>, film: &FilmPixel) -> AngularTable {
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

/// A film over the grid or some bins of it, condensed for its gaps.
pub(super) struct Film<'a> {
    /// Of the medium above, at each bin.
    index: Vec<f64>,
    gaps_nm: &'a [f64],
    kind: Beta,
    /// One over all wavelengths, or one for each: the same angle in a dispersive glass has
    /// another beta at each.
    parts: Vec<GapFilm>,
}

impl<'a> Film<'a> {
    pub(super) fn new(
        film: &FilmPixel,
        grid: &Grid,
        index: &Spectrum,
        gaps_nm: &'a [f64],
        kind: Beta,
    ) -> Result<Self, DisplayError> {
        Self::at_bins(film, grid, index, gaps_nm, kind, &(0..grid.len()).collect::<Vec<usize>>())
    }

    /// The same at these bins of the grid alone.
    fn at_bins(
        film: &FilmPixel,
        grid: &Grid,
        index: &Spectrum,
        gaps_nm: &'a [f64],
        kind: Beta,
        bins: &[usize],
    ) -> Result<Self, DisplayError> {
        let wavelengths_nm = grid.wavelengths_nm();
        let part = |bins: &[usize]| {
            let layers: Vec<_> = film.layers.iter().map(|layer| layer_at(layer, bins)).collect();
            GapFilm::new(&at(&wavelengths_nm, bins), &at(index, bins), &layers, &at(&film.substrate, bins))
        };
        let alike = kind == Beta::Air || index.is_constant();
        let together = if alike { bins.len().max(1) } else { 1 };
        let parts: Result<Vec<GapFilm>, _> = bins.chunks(together).map(part).collect();
        Ok(Self { index: at(index, bins), gaps_nm, kind, parts: parts? })
    }

    /// Mean reflectance of s and p; shape `[angle][gap][wavelength]`. A grazing ray in the glass
    /// is reflected whole.
    pub(super) fn reflectance(&self, sines: &[f64]) -> Result<Vec<f64>, DisplayError> {
        let (bins, gaps) = (self.index.len(), self.gaps_nm.len());
        let mut reflectance = vec![0.0; sines.len() * gaps * bins];
        let scale = |bin: usize| if self.kind == Beta::Air { 1.0 } else { self.index[bin] };
        let beta_at = |bin: usize| -> Vec<f64> { sines.iter().map(|sine| scale(bin) * sine).collect() };
        if let [all] = &self.parts[..] {
            all.reflectance(&beta_at(0), self.gaps_nm, &mut reflectance)?;
        } else {
            let mut one = vec![0.0; sines.len() * gaps];
            for (bin, part) in self.parts.iter().enumerate() {
                part.reflectance(&beta_at(bin), self.gaps_nm, &mut one)?;
                one.iter().enumerate().for_each(|(k, value)| reflectance[k * bins + bin] = *value);
            }
        }
        for (row, sine) in reflectance.chunks_exact_mut(gaps * bins).zip(sines) {
            let grazing = (0..bins).filter(|bin| scale(*bin) * sine >= self.index[*bin]);
            grazing.for_each(|bin| row.iter_mut().skip(bin).step_by(bins).for_each(|value| *value = 1.0));
        }
        Ok(reflectance)
    }

    /// The same at these cosines of the angle in the glass.
    fn at_cosines(&self, cosines: &[f64]) -> Result<Vec<f64>, DisplayError> {
        self.reflectance(&cosines.iter().map(|cosine| (1.0 - cosine * cosine).sqrt()).collect::<Vec<f64>>())
    }
}

fn layer_at(layer: &FilmLayer, bins: &[usize]) -> FilmLayer {
    FilmLayer { index: at(&layer.index, bins), thickness: layer.thickness }
}

fn at<T: Copy>(values: &[T], bins: &[usize]) -> Vec<T> {
    bins.iter().map(|bin| values[*bin]).collect()
}
