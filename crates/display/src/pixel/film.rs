//! Reflectances of film pixels at the gaps of their states, against angle.

use std::sync::Arc;

use num_complex::Complex64;
use papilio_optics::film::{
    self as optics, GapFilm, Layer, LayerFringes, Polarisation, Thickness, Variable, coherent, most_fringes,
};
use papilio_spectra::{Grid, Spectrum};
use papilio_transport::{AngularTable, Base, CosinePanels, Nodes, Reflector, Stack};

use super::{Bases, WeightedNodes, WeightedTable, table};
use crate::DisplayError;
use crate::scene::{Drive, FilmLayer, FilmPixel};

/// Computes a film pixel as the base of a stack. Reflectances of the previous base, `before`, whose film is
/// described by `kept`, are reused if they are still valid.
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
    *kept = match has_own_areas(film) {
        true => None,
        false => Some(key.unwrap_or_else(|| FilmKey::new(film, grid, index, &mixture.gaps_nm))),
    };
    let inactive = film.inactive_reflectance.map(|r| (1.0 - film.fill_factor) * (1.0 - r));
    let table = mixture.table(nodes, reflectance, film);
    Ok(Base { reflector: Reflector::Specular(table), inactive_absorptance: inactive })
}

/// Computes a film pixel as [`base`] does, and for light of s and of p.
pub(super) fn polarised_bases(
    film: &FilmPixel,
    grid: &Grid,
    index: &Spectrum,
    kept: &mut Option<FilmKey>,
    before: Option<&Stack>,
) -> Result<Bases, DisplayError> {
    let mixture = Mixture::new(film)?;
    let key = kept.take().filter(|key| key.serves(film, grid, index, &mixture.gaps_nm));
    let last = before.and_then(|stack| {
        let [s, p] = stack.polarised_bases()?;
        Some([mirror(stack.base())?, mirror(s)?, mirror(p)?])
    });
    let (nodes, of_each) = match last {
        Some(tables) if key.is_some() => {
            (tables[0].nodes.clone(), tables.map(|table| Arc::clone(&table.basis)))
        }
        _ => {
            let nodes = before.and_then(|stack| mirror(stack.base())).map(|table| &table.nodes);
            polarised_tables(film, grid, index, &mixture.gaps_nm, nodes)?
        }
    };
    *kept = match has_own_areas(film) {
        true => None,
        false => Some(key.unwrap_or_else(|| FilmKey::new(film, grid, index, &mixture.gaps_nm))),
    };
    let inactive = film.inactive_reflectance.map(|r| (1.0 - film.fill_factor) * (1.0 - r));
    let [mean, s, p] = of_each.map(|basis| Base {
        reflector: Reflector::Specular(mixture.table(nodes.clone(), basis, film)),
        inactive_absorptance: inactive.clone(),
    });
    Ok(Bases { mean, polarised: Some([s, p]), products: None, mueller: None })
}

/// Computes the product of both amplitudes of a film pixel, p times s*, as [`base`] computes its reflectance: real and imaginary part. The inactive
/// area reflects as metal does along the normal, with opposite signs.
pub(super) fn products(film: &FilmPixel, grid: &Grid, index: &Spectrum) -> Result<[Base; 2], DisplayError> {
    let mixture = Mixture::new(film)?;
    let (gaps_nm, all) = (&mixture.gaps_nm[..], (0..grid.len()).collect::<Vec<usize>>());
    let few = few_bins(grid);
    let size = [2 * gaps_nm.len(), grid.len()];
    let at = |bins: &[usize], cosines: &[f64]| products_at(film, (grid, index, bins), gaps_nm, cosines);
    let panels = table::panels(size, None, |cosines| at(&few, cosines), |cosines| at(&all, cosines))?;
    let (panels, values) =
        panels.ok_or_else(|| too_many_fringes(film, grid, gaps_nm, table::most_panels(size)))?;
    let width = gaps_nm.len() * grid.len();
    let part = |first: usize, inactive: f64| {
        let basis =
            values.chunks_exact(2 * width).flat_map(|row| &row[first..first + width]).copied().collect();
        let inactive_reflectance = film.inactive_reflectance.map(|r| inactive * r);
        let film = FilmPixel { inactive_reflectance, ..film.clone() };
        let table = mixture.table(Nodes::CosinePanels(panels.clone()), basis, &film);
        let inactive_absorptance = Spectrum::constant(grid, 0.0);
        Base { reflector: Reflector::Specular(table), inactive_absorptance }
    };
    Ok([part(0, -1.0), part(width, 0.0)])
}

/// Computes the products at these cosines of the angle in the glass and some wavelengths of the grid: `[cosine][real, imaginary][gap][wavelength]`.
fn products_at(
    film: &FilmPixel,
    (grid, index, bins): (&Grid, &Spectrum, &[usize]),
    gaps_nm: &[f64],
    cosines: &[f64],
) -> Result<Vec<f64>, DisplayError> {
    let nm = grid.wavelengths_nm();
    let width = gaps_nm.len() * bins.len();
    let mut values = Vec::with_capacity(cosines.len() * 2 * width);
    for sine in sines(cosines) {
        let mut products = Vec::with_capacity(width);
        for gap_nm in gaps_nm {
            for &bin in bins {
                let layers = film.layers.iter().map(|layer| Layer {
                    index: layer.index[bin],
                    thickness_nm: match layer.thickness {
                        Thickness::Fixed(nm) => nm,
                        Thickness::Gap => *gap_nm,
                    },
                });
                let (incidence, substrate) = (index[bin], film.substrate[bin]);
                let stack = optics::Film { incidence, layers: layers.collect(), substrate };
                let beta = incidence * sine;
                let of = |polarisation| coherent(&stack, nm[bin], beta, polarisation).map(|found| found.r);
                products.push(match beta < incidence {
                    true => of(Polarisation::P)? * of(Polarisation::S)?.conj(),
                    // Along the layers, both are reflected completely.
                    false => Complex64::ONE,
                });
            }
        }
        values.extend(products.iter().map(|product| product.re));
        values.extend(products.iter().map(|product| product.im));
    }
    Ok(values)
}

/// The table of a mirror.
fn mirror(base: &Base) -> Option<&AngularTable> {
    match &base.reflector {
        Reflector::Specular(table) => Some(table),
        _ => None,
    }
}

/// Reflectances of the mean of s and p, of s, and of p.
type OfEachLight = [Arc<[f64]>; 3];

/// Tabulates the reflectances at the gaps, `[node][gap][wavelength]`, of each light on common nodes.
pub(crate) fn polarised_tables(
    film: &FilmPixel,
    grid: &Grid,
    index: &Spectrum,
    gaps_nm: &[f64],
    last: Option<&Nodes>,
) -> Result<(Nodes, OfEachLight), DisplayError> {
    let few = few_bins(grid);
    let polarisations = [Polarisation::S, Polarisation::P].map(Some);
    let whole = polarisations.map(|one| Ok(Film::new(film, grid, index, gaps_nm, Beta::InGlass)?.of(one)));
    let sample =
        polarisations.map(|one| Ok(Film::at_bins(film, grid, index, gaps_nm, Beta::InGlass, &few)?.of(one)));
    let ([s, p], [s_few, p_few]) = (both(whole)?, both(sample)?);
    let width = gaps_nm.len() * grid.len();
    let sampled = |at: &[f64]| side_by_side([&s_few, &p_few], at);
    let size = [2 * gaps_nm.len(), grid.len()];
    let panels = table::panels(size, known(last), sampled, |at| side_by_side([&s, &p], at))?;
    let (panels, values) =
        panels.ok_or_else(|| too_many_fringes(film, grid, gaps_nm, table::most_panels(size)))?;
    let rows = values.chunks_exact(2 * width);
    let of = |first: usize| rows.clone().flat_map(move |row| &row[first..first + width]).copied();
    let mean = of(0).zip(of(width)).map(|(s, p)| 0.5 * (s + p));
    Ok((Nodes::CosinePanels(panels), [mean.collect(), of(0).collect(), of(width).collect()]))
}

/// Both films, or the error of one.
fn both<'a>(films: [Result<Film<'a>, DisplayError>; 2]) -> Result<[Film<'a>; 2], DisplayError> {
    let [s, p] = films;
    Ok([s?, p?])
}

/// Computes the reflectances of two films at these cosines, `[cosine][film][gap][wavelength]`.
fn side_by_side(films: [&Film<'_>; 2], cosines: &[f64]) -> Result<Vec<f64>, DisplayError> {
    let [one, other] = films.map(|film| film.at_cosines(cosines));
    let (one, other) = (one?, other?);
    let width = (one.len() / cosines.len().max(1)).max(1);
    Ok(one
        .chunks(width)
        .zip(other.chunks(width))
        .flat_map(|(one, other)| one.iter().chain(other))
        .copied()
        .collect())
}

/// Key of a film's reflectances: all that they depend on.
#[derive(Debug, Clone)]
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

    /// Returns true if the reflectances are those of this film at these gaps.
    fn serves(&self, film: &FilmPixel, grid: &Grid, index: &Spectrum, gaps_nm: &[f64]) -> bool {
        self.grid == *grid
            && self.gaps_nm == gaps_nm
            && self.index == *index
            && self.layers == film.layers
            && self.substrate == film.substrate
    }
}

/// Number of wavelengths at which panels are tested first. Most panels that are too wide are so at any
/// wavelength, and this number fills a wide register.
const BINS_OF_SAMPLE: usize = 8;

/// Nodes of a table, and its reflectances, `[node][gap][wavelength]`.
type Tabulated = (Nodes, Arc<[f64]>);

/// Tabulates the reflectances at the gaps, `[node][gap][wavelength]`. The nodes of the previous table,
/// `last`, save time if its film was similar.
pub(crate) fn tabulated(
    film: &FilmPixel,
    grid: &Grid,
    index: &Spectrum,
    gaps_nm: &[f64],
    last: Option<&Nodes>,
) -> Result<Tabulated, DisplayError> {
    let whole = Film::new(film, grid, index, gaps_nm, Beta::InGlass)?;
    let few = few_bins(grid);
    let sample = Film::at_bins(film, grid, index, gaps_nm, Beta::InGlass, &few)?;
    let size = [gaps_nm.len(), grid.len()];
    let panels = table::panels(
        size,
        known(last),
        |cosines| sample.at_cosines(cosines),
        |cosines| whole.at_cosines(cosines),
    )?;
    let (panels, values) =
        panels.ok_or_else(|| too_many_fringes(film, grid, gaps_nm, table::most_panels(size)))?;
    Ok((Nodes::CosinePanels(panels), values))
}

/// The panels of a table of a similar film.
fn known(last: Option<&Nodes>) -> Option<&CosinePanels> {
    match last {
        Some(Nodes::CosinePanels(panels)) => Some(panels),
        _ => None,
    }
}

/// Wavelengths at which panels are tested first.
fn few_bins(grid: &Grid) -> Vec<usize> {
    (0..grid.len()).step_by(grid.len().div_ceil(BINS_OF_SAMPLE).max(1)).collect()
}

/// Tabulates the reflectances on the nodes that known light needs; `None` if those of all light are needed.
pub(crate) fn tabulated_for(
    light: &mut WeightedNodes,
    film: &FilmPixel,
    (grid, index): (&Grid, &Spectrum),
    mixture: &Mixture,
) -> Result<Option<WeightedTable>, DisplayError> {
    let whole = Film::new(film, grid, index, &mixture.gaps_nm, Beta::InGlass)?;
    light.table((&mixture.fractions, mixture.gaps_nm.len()), |cosines| whole.at_cosines(cosines))
}

/// Chooses the nodes for known light so that they suffice for this film.
pub(crate) fn fit_nodes(
    light: &mut WeightedNodes,
    film: &FilmPixel,
    (grid, index): (&Grid, &Spectrum),
) -> Result<(), DisplayError> {
    let mixture = Mixture::new(film)?;
    let whole = Film::new(film, grid, index, &mixture.gaps_nm, Beta::InGlass)?;
    let critical = critical_cosine(film, index);
    light.fit((&mixture.fractions, mixture.gaps_nm.len()), critical, |cosines| whole.at_cosines(cosines))
}

/// Returns the cosine of the critical angle of the film's gap in the medium above, at the first wavelength; 0
/// if it has none.
fn critical_cosine(film: &FilmPixel, index: &Spectrum) -> f64 {
    let gap = film.layers.iter().find(|layer| layer.thickness == Thickness::Gap);
    let sine = gap.and_then(|gap| Some(gap.index.first()?.re / index.first()?));
    sine.map_or(0.0, |sine| (1.0 - sine * sine).max(0.0).sqrt())
}

/// Returns the error of a film with too many fringes, with the layer and the wavelength that have the most.
fn too_many_fringes(film: &FilmPixel, grid: &Grid, gaps_nm: &[f64], most_panels: usize) -> DisplayError {
    let gap_nm = gaps_nm.iter().copied().fold(0.0, f64::max);
    let thickness_nm = |layer: &FilmLayer| match layer.thickness {
        Thickness::Fixed(nm) => nm,
        Thickness::Gap => gap_nm,
    };
    let at = |(bin, nm): (usize, f64)| {
        let layers = film.layers.iter().map(|layer| (layer.index[bin], thickness_nm(layer)));
        (most_fringes(layers, nm), nm)
    };
    let (most, nm) = grid
        .wavelengths_nm()
        .into_iter()
        .enumerate()
        .map(at)
        .reduce(|most, one| if one.0.fringes > most.0.fringes { one } else { most })
        .unwrap_or((LayerFringes { layer: 0, fringes: 0.0 }, 0.0));
    let layer = film.layers.get(most.layer);
    let key = match layer.map(|layer| layer.thickness) {
        Some(Thickness::Fixed(_)) => format!("film.{}.thickness_nm", most.layer),
        _ => gap_key(film, gap_nm),
    };
    DisplayError::Fringes {
        key: format!("display.pixel.{key}"),
        thickness_nm: layer.map_or(gap_nm, thickness_nm),
        fringes: most.fringes.ceil(),
        nm,
        most_panels,
    }
}

/// Returns the key that specifies this gap: that of a sub-pixel, of dark sub-pixels, or of a state.
fn gap_key(film: &FilmPixel, gap_nm: f64) -> String {
    if let Some(sub_pixel) = film.sub_pixels.iter().find(|sub_pixel| sub_pixel.gap_nm == gap_nm) {
        return format!("gap_nm.{}", sub_pixel.name);
    }
    if film.dark_gap_nm == Some(gap_nm) {
        return "gap_nm.dark".to_owned();
    }
    let drives = film.states.iter().flat_map(|state| {
        state.drives.iter().zip(&film.sub_pixels).map(move |(drive, sub_pixel)| (state, drive, sub_pixel))
    });
    let own = drives.filter(|(_, drive, _)| matches!(drive, Drive::Gap(nm) if *nm == gap_nm));
    let mut own = own.map(|(state, _, sub_pixel)| format!("states.{}.{}.gap_nm", state.name, sub_pixel.name));
    own.next().unwrap_or_else(|| "gap_nm".to_owned())
}

/// Owner of a gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Owner {
    /// A sub-pixel that shows its colour.
    SubPixel(usize),
    /// All dark sub-pixels.
    Dark,
    /// A sub-pixel in a state that specifies its gap.
    State { state: usize, sub_pixel: usize },
}

/// Part of a state: the fraction `on` of a sub-pixel's area at a gap.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub(crate) state: usize,
    pub(crate) sub_pixel: usize,
    /// Index of the gap.
    pub(crate) gap: usize,
    pub(crate) on: f64,
}

/// Gaps of the states, and the area fraction of each gap in each state.
pub(crate) struct Mixture {
    pub(crate) gaps_nm: Vec<f64>,
    /// Owner of each gap; the first one if several owners have the same gap.
    pub(crate) owners: Vec<Owner>,
    pub(crate) parts: Vec<Part>,
    /// Area fractions, `[state][gap]`, including the fill factor.
    pub(crate) fractions: Vec<f64>,
}

impl Mixture {
    /// Lists each gap once.
    pub(crate) fn new(film: &FilmPixel) -> Result<Self, DisplayError> {
        Self::of(film, |(_, gap), (_, other)| gap == other)
    }

    /// Lists the gap of each owner separately, even if others are equal.
    pub(crate) fn by_owner(film: &FilmPixel) -> Result<Self, DisplayError> {
        Self::of(film, |(owner, _), (other, _)| owner == other)
    }

    fn of(
        film: &FilmPixel,
        is_same: impl Fn((Owner, f64), (Owner, f64)) -> bool,
    ) -> Result<Self, DisplayError> {
        let mut gaps: Vec<(Owner, f64)> = Vec::new();
        let mut place = |owner: Owner, gap: f64| {
            gaps.iter().position(|known| is_same(*known, (owner, gap))).unwrap_or_else(|| {
                gaps.push((owner, gap));
                gaps.len() - 1
            })
        };
        let mut parts: Vec<Part> = Vec::new();
        for (s, state) in film.states.iter().enumerate() {
            for (k, (sub_pixel, drive)) in film.sub_pixels.iter().zip(&state.drives).enumerate() {
                let part = |gap: usize, on: f64| Part { state: s, sub_pixel: k, gap, on };
                match *drive {
                    Drive::Gap(gap) => {
                        parts.push(part(place(Owner::State { state: s, sub_pixel: k }, gap), 1.0));
                    }
                    Drive::Share(on) => {
                        if on > 0.0 {
                            parts.push(part(place(Owner::SubPixel(k), sub_pixel.gap_nm), on));
                        }
                        if on < 1.0 {
                            let missing = || DisplayError::NoDarkGap { state: state.name.clone() };
                            let dark = film.dark_gap_nm.ok_or_else(missing)?;
                            parts.push(part(place(Owner::Dark, dark), 1.0 - on));
                        }
                    }
                }
            }
        }
        let mut fractions = vec![0.0; film.states.len() * gaps.len()];
        for part in &parts {
            let of_pixel = || film.fill_factor * film.sub_pixels[part.sub_pixel].area;
            let own = film.states[part.state].areas.as_ref().map(|areas| areas[part.sub_pixel]);
            fractions[part.state * gaps.len() + part.gap] += own.unwrap_or_else(of_pixel) * part.on;
        }
        let (owners, gaps_nm) = gaps.into_iter().unzip();
        Ok(Self { gaps_nm, owners, parts, fractions })
    }

    /// Returns the table of the states on these nodes.
    pub(crate) fn table(&self, nodes: Nodes, basis: Arc<[f64]>, film: &FilmPixel) -> AngularTable {
        if !has_own_areas(film) {
            return AngularTable { nodes, basis, mixture: self.fractions.clone(), common: common(film) };
        }
        // The inactive area differs from state to state: one more part of the mixtures.
        let gaps = self.gaps_nm.len();
        let inactive = |state: &[f64]| 1.0 - state.iter().sum::<f64>();
        let states = self.fractions.chunks_exact(gaps);
        let mixture = states.flat_map(|state| state.iter().copied().chain([inactive(state)])).collect();
        let common = vec![0.0; film.inactive_reflectance.len()];
        AngularTable {
            nodes,
            basis: with_constant(&basis, gaps, &film.inactive_reflectance),
            mixture,
            common,
        }
    }
}

/// The basis of a table of this many gaps with one more, a reflectance that does not depend on angle.
pub(crate) fn with_constant(basis: &[f64], gaps: usize, constant: &Spectrum) -> Arc<[f64]> {
    let rows = basis.chunks_exact(gaps * constant.len());
    rows.flat_map(|row| row.iter().chain(constant.iter()).copied()).collect()
}

/// Whether the sub-pixels have areas of their own in a state.
fn has_own_areas(film: &FilmPixel) -> bool {
    film.states.iter().any(|state| state.areas.is_some())
}

/// Returns the reflectance that all states of a film have in common: that of the inactive area.
pub(crate) fn common(film: &FilmPixel) -> Vec<f64> {
    film.inactive_reflectance.iter().map(|r| (1.0 - film.fill_factor) * r).collect()
}

/// Medium of the angle of a sine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Beta {
    /// Air: beta is the sine.
    Air,
    /// Glass: beta is the index times the sine.
    InGlass,
}

/// Film at all or some wavelengths of the grid, prepared for its gaps.
pub(crate) struct Film<'a> {
    /// Index of the medium above at each wavelength.
    index: Vec<f64>,
    gaps_nm: &'a [f64],
    kind: Beta,
    /// One polarisation, or the mean of both.
    polarisation: Option<Polarisation>,
    /// One for all wavelengths, or one for each: in a dispersive glass, the beta of an angle depends on
    /// wavelength.
    parts: Vec<GapFilm>,
}

impl<'a> Film<'a> {
    pub(crate) fn new(
        film: &FilmPixel,
        grid: &Grid,
        index: &Spectrum,
        gaps_nm: &'a [f64],
        kind: Beta,
    ) -> Result<Self, DisplayError> {
        Self::at_bins(film, grid, index, gaps_nm, kind, &(0..grid.len()).collect::<Vec<usize>>())
    }

    /// Prepares the film at these wavelengths of the grid only.
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
        let has_one_beta = kind == Beta::Air || index.is_constant();
        let together = if has_one_beta { bins.len().max(1) } else { 1 };
        let parts: Result<Vec<GapFilm>, _> = bins.chunks(together).map(part).collect();
        Ok(Self { index: at(index, bins), gaps_nm, kind, polarisation: None, parts: parts? })
    }

    /// The same film for light of one polarisation, or for the mean of both.
    pub(crate) fn of(self, polarisation: Option<Polarisation>) -> Self {
        Self { polarisation, ..self }
    }

    /// Computes the reflectance, `[angle][gap][wavelength]`. At grazing incidence in the
    /// glass it is 1.
    pub(super) fn reflectance(&self, sines: &[f64]) -> Result<Vec<f64>, DisplayError> {
        let (bins, gaps) = (self.index.len(), self.gaps_nm.len());
        let mut reflectance = vec![0.0; sines.len() * gaps * bins];
        let scale = |bin: usize| if self.kind == Beta::Air { 1.0 } else { self.index[bin] };
        let beta_at = |bin: usize| -> Vec<f64> { sines.iter().map(|sine| scale(bin) * sine).collect() };
        if let [all] = &self.parts[..] {
            all.reflectance_of(self.polarisation, &beta_at(0), self.gaps_nm, &mut reflectance)?;
        } else {
            let mut one = vec![0.0; sines.len() * gaps];
            for (bin, part) in self.parts.iter().enumerate() {
                part.reflectance_of(self.polarisation, &beta_at(bin), self.gaps_nm, &mut one)?;
                one.iter().enumerate().for_each(|(k, value)| reflectance[k * bins + bin] = *value);
            }
        }
        /// Sine of directions that may graze, in spite of rounding.
        const GRAZING: f64 = 1.0 - 1e-12;
        let may_graze = |sine: &f64| self.kind == Beta::Air || *sine > GRAZING;
        for (row, sine) in
            reflectance.chunks_exact_mut(gaps * bins).zip(sines).filter(|(_, sine)| may_graze(sine))
        {
            let grazing = (0..bins).filter(|bin| scale(*bin) * sine >= self.index[*bin]);
            grazing.for_each(|bin| row.iter_mut().skip(bin).step_by(bins).for_each(|value| *value = 1.0));
        }
        Ok(reflectance)
    }

    /// Computes the reflectance at these cosines of the angle in the glass.
    fn at_cosines(&self, cosines: &[f64]) -> Result<Vec<f64>, DisplayError> {
        self.reflectance(&sines(cosines))
    }

    /// Computes the derivatives of the reflectance, `[variable][angle][gap][wavelength]`.
    pub(crate) fn derivatives_at_cosines(
        &self,
        polarisation: Option<Polarisation>,
        cosines: &[f64],
        variables: &[Variable],
    ) -> Result<Vec<f64>, DisplayError> {
        let (sines, bins) = (sines(cosines), self.index.len());
        let values = sines.len() * self.gaps_nm.len();
        let mut derivatives = vec![0.0; variables.len() * values * bins];
        let together = bins / self.parts.len().max(1);
        let (mut reflectance, mut some) =
            (vec![0.0; values * together], vec![0.0; variables.len() * values * together]);
        for (number, part) in self.parts.iter().enumerate() {
            let scale = if self.kind == Beta::Air { 1.0 } else { self.index[number * together] };
            let beta: Vec<f64> = sines.iter().map(|sine| scale * sine).collect();
            let out = (&mut reflectance[..], &mut some[..]);
            part.derivatives_of(polarisation, &beta, self.gaps_nm, variables, out.0, out.1)?;
            for (row, some) in derivatives.chunks_exact_mut(bins).zip(some.chunks_exact(together)) {
                row[number * together..][..together].copy_from_slice(some);
            }
        }
        Ok(derivatives)
    }
}

fn sines(cosines: &[f64]) -> Vec<f64> {
    cosines.iter().map(|cosine| (1.0 - cosine * cosine).sqrt()).collect()
}

fn layer_at(layer: &FilmLayer, bins: &[usize]) -> FilmLayer {
    FilmLayer { index: at(&layer.index, bins), thickness: layer.thickness }
}

fn at<T: Copy>(values: &[T], bins: &[usize]) -> Vec<T> {
    bins.iter().map(|bin| values[*bin]).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests express expectations by unwrapping")]
mod tests {
    use papilio_transport::Medium;

    use super::*;
    use crate::scene::{FilmState, SubPixel};

    /// Film of a thin metal layer, a gap and a mirror.
    fn film(gap_nm: f64, bins: usize) -> FilmPixel {
        let layer = |index: Complex64, thickness| FilmLayer { index: vec![index; bins], thickness };
        let sub_pixels = vec![SubPixel { name: "red".to_owned(), area: 1.0, gap_nm }];
        FilmPixel {
            layers: vec![
                layer(Complex64::new(3.0, 3.3), Thickness::Fixed(12.0)),
                layer(1.0.into(), Thickness::Gap),
            ],
            substrate: vec![Complex64::new(1.0, 6.5); bins],
            materials: Vec::new(),
            sub_pixels,
            dark_gap_nm: None,
            fill_factor: 1.0,
            inactive_reflectance: Spectrum::from_values(vec![0.0; bins]),
            states: vec![FilmState { name: "on".to_owned(), drives: vec![Drive::Share(1.0)], areas: None }],
        }
    }

    /// Compares the table with [`optics::coherent`], an independent implementation, between fringes and at
    /// the critical angle.
    #[test]
    fn table_of_thick_gaps_resolves_their_fringes() {
        let grid = Grid::new(500.0, 600.0, 50.0).unwrap();
        let index = Spectrum::from_values(vec![1.5; grid.len()]);
        for gap_nm in [300.0, 4000.0, 12_000.0] {
            let film = film(gap_nm, grid.len());
            let base = base(&film, &grid, &index, &mut None, None).unwrap();
            let medium = Medium::new(index.clone());
            let mut out = vec![0.0; grid.len()];
            let (mut sum, count) = (0.0, 4000);
            for step in 0..count {
                let cosine = (f64::from(step) + 0.37) / f64::from(count);
                let beta = 1.5 * (1.0 - cosine * cosine).sqrt();
                base.reflectance(beta * beta, &medium, &mut out);
                for (nm, found) in grid.wavelengths_nm().into_iter().zip(&out) {
                    let layers = film.layers.iter().map(|layer| optics::Layer {
                        index: layer.index[0],
                        thickness_nm: match layer.thickness {
                            Thickness::Fixed(nm) => nm,
                            Thickness::Gap => gap_nm,
                        },
                    });
                    let plain = optics::Film {
                        incidence: 1.5,
                        layers: layers.collect(),
                        substrate: film.substrate[0],
                    };
                    let one = |p| optics::coherent(&plain, nm, beta, p).unwrap().reflectance;
                    let truth = 0.5 * (one(optics::Polarisation::S) + one(optics::Polarisation::P));
                    let error = (found - truth).abs();
                    assert!(error < 2e-3, "{gap_nm} nm, {nm} nm, cosine {cosine}: {found}, {truth}");
                    sum += error;
                }
            }
            assert!(sum / f64::from(3 * count) < 1e-6, "{gap_nm}: mean error {}", sum / f64::from(3 * count));
        }
    }

    /// Between mirrors that absorb 2 %, the resonances of a gap are 1e-4 wide or less. The exact film is compared at its
    /// minima over direction, which are searched for in the film itself, and on their slopes.
    #[test]
    fn table_is_exact_at_the_sharpest_resonances() {
        let grid = Grid::new(540.0, 560.0, 10.0).unwrap();
        let index = Spectrum::from_values(vec![1.5; grid.len()]);
        let silver = Complex64::new(0.05, 3.5);
        let mut film = film(5000.0, grid.len());
        film.layers[0].thickness = Thickness::Fixed(45.0);
        film.layers[0].index.fill(silver);
        film.substrate.fill(silver);
        let base = base(&film, &grid, &index, &mut None, None).unwrap();
        let medium = Medium::new(index.clone());
        let mut out = vec![0.0; grid.len()];
        let (mut minima, mut deepest) = (0, 1.0_f64);
        for (bin, nm) in grid.wavelengths_nm().into_iter().enumerate() {
            let layers = [(silver, 45.0), (1.0.into(), 5000.0)];
            let layers = layers.map(|(index, thickness_nm)| optics::Layer { index, thickness_nm }).to_vec();
            let plain = optics::Film { incidence: 1.5, layers, substrate: silver };
            let exact = |cosine: f64| {
                let beta = 1.5 * (1.0 - cosine * cosine).sqrt();
                let one = |p| optics::coherent(&plain, nm, beta, p).unwrap().reflectance;
                0.5 * (one(optics::Polarisation::S) + one(optics::Polarisation::P))
            };
            let cosines: Vec<f64> =
                (0..4000).map(|step| 0.7455 + 0.2544 * f64::from(step) / 4000.0).collect();
            let values: Vec<f64> = cosines.iter().map(|cosine| exact(*cosine)).collect();
            for k in 1..cosines.len() - 1 {
                if values[k] > values[k - 1].min(values[k + 1]) {
                    continue;
                }
                let [mut from, mut to] = [cosines[k - 1], cosines[k + 1]];
                for _ in 0..40 {
                    let [a, b] = [from + 0.382 * (to - from), from + 0.618 * (to - from)];
                    if exact(a) < exact(b) { to = b } else { from = a }
                }
                (minima, deepest) = (minima + 1, deepest.min(exact(from)));
                for away in [0.0, 1e-6, -3e-6, 1e-5, -3e-5, 1e-4, -3e-4] {
                    let beta = 1.5 * (1.0 - (from + away) * (from + away)).sqrt();
                    base.reflectance(beta * beta, &medium, &mut out);
                    let error = (out[bin] - exact(from + away)).abs();
                    // Beside the critical angle of the gap, 0.7454, minima less than 1e-6 deep are narrower than any panel.
                    let most = if from < 0.748 { 1e-6 } else { table::TABLE_ERROR };
                    assert!(error < most, "{nm} nm, cosine {from} + {away}: {error}");
                }
            }
        }
        assert!(minima > 50 && deepest < 0.7, "{minima} {deepest}");
    }

    #[test]
    fn gap_of_a_tenth_of_a_millimetre_is_refused_with_its_key() {
        let grid = Grid::new(500.0, 600.0, 50.0).unwrap();
        let index = Spectrum::from_values(vec![1.5; grid.len()]);
        let error = base(&film(1e5, grid.len()), &grid, &index, &mut None, None).unwrap_err();
        let DisplayError::Fringes { key, thickness_nm, fringes, nm, .. } = error else {
            unreachable!("{error}");
        };
        assert_eq!(
            (key.as_str(), thickness_nm, fringes, nm),
            ("display.pixel.gap_nm.red", 1e5, 400.0, 500.0)
        );
    }
}
