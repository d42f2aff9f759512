//! Film pixels: the reflectances at the gaps that the states need, against angle.

use std::ops::Range;

use num_complex::Complex64;
use papilio_optics::film::GapFilm;
use papilio_spectra::{Grid, Spectrum};
use papilio_transport::{AngularTable, Base, CosinePanels, Medium, Nodes, Reflector};

use crate::DisplayError;
use crate::scene::{Drive, FilmLayer, FilmPixel};

/// The interpolation error of a film pixel's table is below this reflectance, in
/// each gap, direction and wavelength (checked midway between nodes).
pub const TABLE_ERROR: f64 = 1e-7;

/// Halvings of the panel from 0 to 1 to begin with, and at most: only extremely thick films need more.
const HALVINGS: (u32, u32) = (1, 6);

/// A film pixel as the base of a stack; of `before`, the base of a stack whose film is described
/// by `kept`, what still serves is taken.
pub(super) fn base(
    film: &FilmPixel,
    grid: &Grid,
    index: &Spectrum,
    kept: &mut Option<FilmKey>,
    before: Option<&mut Base>,
) -> Result<Base, DisplayError> {
    let mixture = Mixture::new(film)?;
    let key = kept.take().filter(|key| key.serves(film, grid, index, &mixture.gaps_nm));
    let (nodes, reflectance) = match (key.is_some(), before.map(|base| &mut base.reflector)) {
        (true, Some(Reflector::Specular(table))) => {
            (std::mem::replace(&mut table.nodes, Nodes::Constant), std::mem::take(&mut table.basis))
        }
        _ => tabulated(film, grid, index, &mixture.gaps_nm)?,
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

/// A panel of the table in the making.
struct Panel {
    start: f64,
    halvings: u32,
    /// Shape `[node][gap][wavelength]`.
    values: Vec<f64>,
}

impl Panel {
    fn cosine(&self, position: f64) -> f64 {
        self.start + 0.5_f64.powi(self.halvings as i32) * position / CosinePanels::INTERVALS as f64
    }

    /// Midway between nodes.
    fn midway(&self) -> impl Iterator<Item = f64> {
        (0..CosinePanels::INTERVALS).map(|node| self.cosine(node as f64 + 0.5))
    }

    /// Its two halves, from what is known midway between the nodes.
    fn halves(&self, midway: &[f64], width: usize) -> [Self; 2] {
        let values = interleaved(&self.values, midway, width);
        let half = CosinePanels::INTERVALS;
        [0, half].map(|first| Self {
            start: self.cosine(0.5 * first as f64),
            halvings: self.halvings + 1,
            values: values[first * width..][..CosinePanels::NODES * width].to_vec(),
        })
    }
}

/// The reflectances at the gaps, shape `[node][gap][wavelength]`: panels are halved until
/// interpolation is good to [`TABLE_ERROR`].
fn tabulated(
    film: &FilmPixel,
    grid: &Grid,
    index: &Spectrum,
    gaps_nm: &[f64],
) -> Result<(Nodes, Vec<f64>), DisplayError> {
    let width = gaps_nm.len() * grid.len();
    let film = Film::new(film, grid, index, gaps_nm, Beta::InGlass)?;
    let first = CosinePanels::new(&vec![HALVINGS.0; 1 << HALVINGS.0]);
    let known = film.at_cosines(first.nodes())?;
    let panel = |(number, values): (usize, &[f64])| Panel {
        start: number as f64 * 0.5_f64.powi(HALVINGS.0 as i32),
        halvings: HALVINGS.0,
        values: values.to_vec(),
    };
    let mut open: Vec<Panel> =
        known.chunks_exact(CosinePanels::NODES * width).enumerate().map(panel).collect();
    let mut done: Vec<Panel> = Vec::new();
    while let Some(mut panel) = open.pop() {
        if panel.halvings == HALVINGS.1 {
            done.push(panel);
            continue;
        }
        let exact = film.at_cosines(panel.midway())?;
        if interpolation_error(&mut panel, &exact, width) < TABLE_ERROR {
            done.push(panel);
        } else {
            open.extend(panel.halves(&exact, width));
        }
    }
    done.sort_by(|a, b| a.start.total_cmp(&b.start));
    let nodes = CosinePanels::new(&done.iter().map(|panel| panel.halvings).collect::<Vec<u32>>());
    let mut reflectance = Vec::with_capacity(nodes.count() * width);
    done.iter().for_each(|panel| reflectance.extend_from_slice(&panel.values));
    Ok((Nodes::CosinePanels(nodes), reflectance))
}

/// The largest difference of interpolated values midway between a panel's nodes from the exact
/// ones. Gaps and wavelengths are alike here: one basis of so many "wavelengths".
fn interpolation_error(panel: &mut Panel, exact: &[f64], width: usize) -> f64 {
    let table = AngularTable {
        nodes: Nodes::CosinePanels(CosinePanels::new(&[0])),
        basis: std::mem::take(&mut panel.values),
        mixture: vec![1.0],
        common: vec![0.0; width],
    };
    let medium = Medium::new(vec![1.0; width].into());
    let mut out = vec![0.0; width];
    let mut worst = 0.0_f64;
    for (node, exact) in exact.chunks_exact(width).enumerate() {
        let position = (node as f64 + 0.5) / CosinePanels::INTERVALS as f64;
        table.reflectance(1.0 - position * position, &medium, &mut out);
        worst = out.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(worst, f64::max);
    }
    panel.values = table.basis;
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

/// A film over the grid, condensed for its gaps.
pub(super) struct Film<'a> {
    index: &'a Spectrum,
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
        index: &'a Spectrum,
        gaps_nm: &'a [f64],
        kind: Beta,
    ) -> Result<Self, DisplayError> {
        let wavelengths_nm = grid.wavelengths_nm();
        let part = |bins: Range<usize>| {
            let layers: Vec<_> = film.layers.iter().map(|layer| layer_at(layer, &bins)).collect();
            let (nm, index) = (&wavelengths_nm[bins.clone()], &index[bins.clone()]);
            GapFilm::new(nm, index, &layers, &film.substrate[bins])
        };
        let alike = kind == Beta::Air || index.is_constant();
        let parts: Result<Vec<GapFilm>, _> = if alike {
            [part(0..grid.len())].into_iter().collect()
        } else {
            (0..grid.len()).map(|bin| part(bin..bin + 1)).collect()
        };
        Ok(Self { index, gaps_nm, kind, parts: parts? })
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
    fn at_cosines(&self, cosines: impl Iterator<Item = f64>) -> Result<Vec<f64>, DisplayError> {
        self.reflectance(&cosines.map(|cosine| (1.0 - cosine * cosine).sqrt()).collect::<Vec<f64>>())
    }
}

fn layer_at(layer: &FilmLayer, bins: &Range<usize>) -> FilmLayer {
    FilmLayer { index: layer.index[bins.clone()].to_vec(), thickness: layer.thickness }
}
