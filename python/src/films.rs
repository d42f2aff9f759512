//! Coherent films, with one stack at each point of broadcast numpy arrays.

use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use numpy::{Complex64, PyArray1, PyReadonlyArray1};
use papilio_formats::{DataFile, read_index_within};
use papilio_optics::OpticsError;
use papilio_optics::film::{
    Along, FilmRow, GapFilm, IndexAlong, LayerAlong, Polarisation, SimdLevel, SpectralLayer, Thickness,
};
use papilio_spectra::{Dispersion, SpectraError, material};
use pyo3::exceptions::{PyKeyboardInterrupt, PyUserWarning};
use pyo3::prelude::*;

use crate::errors;
use crate::watch::watched;

exports! { functions film, film_grid, material_index, material_names, material_sheet; }

/// Approximate number of points that a thread takes at a time: some hundred microseconds.
const BLOCK: usize = 4096;

pub(crate) type Reals<'py> = PyReadonlyArray1<'py, f64>;
pub(crate) type Answer<'py> = Bound<'py, PyArray1<f64>>;

/// An array over the axes of a call. Axes along which it is constant have stride 0; the last axis has stride 0 or 1.
#[derive(Clone, Copy)]
pub(crate) struct Spread<'a> {
    values: &'a [f64],
    strides: &'a [usize],
}

impl<'a> Spread<'a> {
    /// Number at indices.
    pub(crate) fn at(&self, place: &[usize]) -> f64 {
        self.values[place.iter().zip(self.strides).map(|(index, stride)| index * stride).sum::<usize>()]
    }

    /// Numbers along a section of the last axis, in the row of the indices.
    fn along(&self, row: &[usize], start: usize, count: usize) -> Along<'a> {
        let but_last = row.len().saturating_sub(1);
        let at: usize = row[..but_last].iter().zip(self.strides).map(|(index, stride)| index * stride).sum();
        match self.strides.last() {
            Some(1) => Along::Each(&self.values[at + start..][..count]),
            _ => Along::Same(self.values[at]),
        }
    }

    /// Whether the number changes along the last axis.
    pub(crate) fn varies(&self) -> bool {
        self.strides.last() == Some(&1)
    }

    /// Whether every index of the shape is within the values.
    fn fits(&self, shape: &[usize]) -> bool {
        let last = shape
            .iter()
            .zip(self.strides)
            .map(|(length, stride)| length.saturating_sub(1) * stride)
            .sum::<usize>();
        self.strides.len() == shape.len()
            && last < self.values.len()
            && self.strides.last().is_none_or(|one| *one <= 1)
    }
}

/// The arrays of a call.
pub(crate) struct Films<'a> {
    pub(crate) shape: &'a [usize],
    pub(crate) wavelength_nm: Spread<'a>,
    pub(crate) beta: Spread<'a>,
    pub(crate) incidence: Spread<'a>,
    /// n, k and thickness of each layer, from the side of the light to the substrate.
    pub(crate) layers: Vec<[Spread<'a>; 3]>,
    /// n and k.
    pub(crate) substrate: [Spread<'a>; 2],
    pub(crate) polarisation: Option<Polarisation>,
}

impl Films<'_> {
    /// Checks the ranges of all numbers, each only once.
    pub(crate) fn check(&self) -> Result<(), OpticsError> {
        self.row(|spread| Along::Each(spread.values), |row| row.check())
    }

    /// Computes the powers of points from index `start`, in C order.
    fn powers(
        &self,
        mut start: usize,
        mut reflectance: &mut [f64],
        mut transmittance: Option<&mut [f64]>,
    ) -> Result<(), OpticsError> {
        let length = self.shape.last().copied().unwrap_or(1);
        while !reflectance.is_empty() {
            let count = reflectance.len().min(length - start % length);
            let (of_row, rest) = reflectance.split_at_mut(count);
            let (of_row_too, rest_too) = transmittance.map(|all| all.split_at_mut(count)).unzip();
            self.in_row(start, of_row, of_row_too)?;
            (start, reflectance, transmittance) = (start + count, rest, rest_too);
        }
        Ok(())
    }

    /// Computes the powers of points within one row.
    fn in_row(
        &self,
        start: usize,
        reflectance: &mut [f64],
        transmittance: Option<&mut [f64]>,
    ) -> Result<(), OpticsError> {
        let (length, count) = (self.shape.last().copied().unwrap_or(1), reflectance.len());
        let row = self.place(start);
        self.row(
            |spread| spread.along(&row, start % length, count),
            |row| row.powers(SimdLevel::best(), self.polarisation, reflectance, transmittance),
        )
    }

    /// Indices of the point with flat index `start`, in C order.
    pub(crate) fn place(&self, start: usize) -> Vec<usize> {
        let mut place = vec![0; self.shape.len()];
        let mut left = start;
        for (index, length) in place.iter_mut().zip(self.shape).rev() {
            (*index, left) = (left % length, left / length);
        }
        place
    }

    /// Applies `of` to a row that consists of a part of each array.
    fn row<'s, T>(
        &'s self,
        part: impl Fn(&Spread<'s>) -> Along<'s>,
        of: impl FnOnce(&FilmRow<'_>) -> T,
    ) -> T {
        let index = |[n, k]: [&Spread<'s>; 2]| IndexAlong { n: part(n), k: part(k) };
        let layers: Vec<_> = (self.layers.iter())
            .map(|[n, k, nm]| LayerAlong { index: index([n, k]), nm: part(nm) })
            .collect();
        of(&FilmRow {
            wavelength_nm: part(&self.wavelength_nm),
            beta: part(&self.beta),
            incidence: part(&self.incidence),
            layers: &layers,
            substrate: index(self.substrate.each_ref()),
        })
    }
}

/// Numbers, and their strides.
pub(crate) type Given<'py> = (Reals<'py>, Vec<usize>);

/// Returns the arrays of a call, after checking that they fit its shape. The three arrays are wavelengths, beta and the index of the medium of incidence.
pub(crate) fn given<'a>(
    shape: &'a [usize],
    [wavelength_nm, beta, incidence]: [&'a Given<'_>; 3],
    layers: &'a [[Given<'_>; 3]],
    substrate: &'a [Given<'_>; 2],
    polarisation: &str,
) -> PyResult<Films<'a>> {
    Ok(Films {
        shape,
        wavelength_nm: spread(wavelength_nm, shape)?,
        beta: spread(beta, shape)?,
        incidence: spread(incidence, shape)?,
        layers: layers
            .iter()
            .map(|layer| all(layer.each_ref().map(|given| spread(given, shape))))
            .collect::<PyResult<_>>()?,
        substrate: all(substrate.each_ref().map(|given| spread(given, shape)))?,
        polarisation: match polarisation {
            "s" => Some(Polarisation::S),
            "p" => Some(Polarisation::P),
            _ => None,
        },
    })
}

/// Computes reflectance and, if `both`, transmittance at every point. `beta` is n0 sin(theta); `layers` have n, k and thickness,
/// from the side of the light; `substrate` has n and k. The results are flat, in C order.
#[pyfunction]
#[pyo3(signature = (shape, wavelength_nm, beta, incidence, layers, substrate, polarisation, both, threads))]
#[allow(clippy::too_many_arguments, reason = "the arrays of one call")]
pub(crate) fn film<'py>(
    py: Python<'py>,
    shape: Vec<usize>,
    wavelength_nm: Given<'py>,
    beta: Given<'py>,
    incidence: Given<'py>,
    layers: Vec<[Given<'py>; 3]>,
    substrate: [Given<'py>; 2],
    polarisation: &str,
    both: bool,
    threads: usize,
) -> PyResult<(Answer<'py>, Answer<'py>)> {
    let films = given(&shape, [&wavelength_nm, &beta, &incidence], &layers, &substrate, polarisation)?;
    films.check().map_err(|error| errors::argument(py, &error.to_string()))?;
    let size: usize = shape.iter().product();
    let mut found = (vec![0.0; size], vec![0.0; if both { size } else { 0 }]);
    stoppable(py, |stop| computed(&films, &mut found, threads, stop))?;
    Ok((PyArray1::from_vec(py, found.0), PyArray1::from_vec(py, found.1)))
}

/// Computes the mean reflectance of s and p on a grid. The last three axes are directions (along which only beta changes), gaps
/// (along which only the thickness of layer `gap` changes) and wavelengths. The other arguments are those of [`film`].
#[pyfunction]
#[pyo3(signature = (shape, wavelength_nm, beta, incidence, layers, substrate, gap, threads))]
#[allow(clippy::too_many_arguments, reason = "the arrays of one call")]
pub(crate) fn film_grid<'py>(
    py: Python<'py>,
    shape: Vec<usize>,
    wavelength_nm: Given<'py>,
    beta: Given<'py>,
    incidence: Given<'py>,
    layers: Vec<[Given<'py>; 3]>,
    substrate: [Given<'py>; 2],
    gap: Option<usize>,
    threads: usize,
) -> PyResult<Answer<'py>> {
    let films = given(&shape, [&wavelength_nm, &beta, &incidence], &layers, &substrate, "mean")?;
    let [.., directions, gaps, wavelengths] = shape[..] else {
        return Err(errors::internal("a grid of films requires at least three axes"));
    };
    let grid = FilmGrid { films, gap, directions, gaps, wavelengths };
    grid.films.check().map_err(|error| errors::argument(py, &error.to_string()))?;
    let mut found = vec![0.0; shape.iter().product()];
    stoppable(py, |stop| grid.computed(&mut found, threads, stop))?;
    Ok(PyArray1::from_vec(py, found))
}

/// Approximate number of directions times gaps of a film that a thread takes at a time.
const PAIRS: usize = 256;

/// Films on a grid of directions, gaps and wavelengths.
struct FilmGrid<'a> {
    films: Films<'a>,
    gap: Option<usize>,
    directions: usize,
    gaps: usize,
    wavelengths: usize,
}

/// Some directions and gaps of one film of a grid.
struct GridPart<'o> {
    /// Index of the film.
    film: usize,
    direction: usize,
    gap: usize,
    out: &'o mut [f64],
}

impl FilmGrid<'_> {
    /// Computes all parts on threads; returns false if stopped.
    fn computed(&self, found: &mut [f64], threads: usize, stop: &AtomicBool) -> Result<bool, OpticsError> {
        let row = self.gaps * self.wavelengths;
        // Several directions with all gaps, or one direction with some of the gaps.
        let directions = (PAIRS / self.gaps).max(1);
        let gaps = if directions == 1 { PAIRS } else { self.gaps };
        let films = found.chunks_mut(self.directions * row).enumerate();
        let rows = films.flat_map(|(film, of_film)| {
            let rows = of_film.chunks_mut(directions * row).enumerate();
            rows.map(move |(at, out)| (film, at * directions, out))
        });
        let parts = rows.flat_map(|(film, direction, rows)| {
            let cut = if directions == 1 { gaps * self.wavelengths } else { rows.len() };
            let parts = rows.chunks_mut(cut).enumerate();
            parts.map(move |(at, out)| GridPart { film, direction, gap: at * gaps, out })
        });
        on_threads(parts, threads, stop, |part| self.part(part))
    }

    fn part(&self, part: GridPart<'_>) -> Result<(), OpticsError> {
        let GridPart { film, direction, gap, out } = part;
        let gaps = (out.len() / self.wavelengths).min(self.gaps - gap);
        let directions = out.len() / self.wavelengths / gaps;
        let films = &self.films;
        let mut at = films.place(film * self.directions * self.gaps * self.wavelengths);
        let spectrum = |values: &Spread<'_>, at: &[usize]| -> Vec<f64> {
            match values.along(at, 0, self.wavelengths) {
                Along::Same(value) => vec![value; self.wavelengths],
                Along::Each(values) => values.to_vec(),
            }
        };
        let index = |[n, k]: [&Spread<'_>; 2], at: &[usize]| -> Vec<Complex64> {
            let (n, k) = (spectrum(n, at), spectrum(k, at));
            n.into_iter().zip(k).map(|(n, k)| Complex64::new(n, k)).collect()
        };
        let layers: Vec<SpectralLayer> = (films.layers.iter().enumerate())
            .map(|(number, [n, k, nm])| SpectralLayer {
                index: index([n, k], &at),
                thickness: match Some(number) == self.gap {
                    true => Thickness::Gap,
                    false => Thickness::Fixed(nm.at(&at)),
                },
            })
            .collect();
        let [wavelengths_nm, incidence] =
            [&films.wavelength_nm, &films.incidence].map(|one| spectrum(one, &at));
        let substrate = index(films.substrate.each_ref(), &at);
        let of = GapFilm::new(&wavelengths_nm, &incidence, &layers, &substrate)?;
        let axes = at.len();
        let mut along = |axis: usize, start: usize, count: usize, values: &Spread<'_>| -> Vec<f64> {
            let of_axis = (start..start + count).map(|index| {
                at[axes - axis] = index;
                values.at(&at)
            });
            let found = of_axis.collect();
            at[axes - axis] = 0;
            found
        };
        let betas = along(3, direction, directions, &films.beta);
        let gaps_nm = match self.gap.and_then(|number| films.layers.get(number)) {
            Some([_, _, nm]) => along(2, gap, gaps, nm),
            None => vec![0.0; gaps],
        };
        of.reflectance(&betas, &gaps_nm, out)
    }
}

/// Computes films with Ctrl-C; `work` returns false if it was stopped.
pub(crate) fn stoppable(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> Result<bool, OpticsError> + Send,
) -> PyResult<()> {
    match watched(py, &AtomicBool::new(false), None, |watch| work(watch.stop))? {
        Ok(true) => Ok(()),
        Ok(false) => Err(PyKeyboardInterrupt::new_err(())),
        Err(error) => Err(errors::argument(py, &error.to_string())),
    }
}

/// Computes parts on threads, each completely; returns false if stopped.
pub(crate) fn on_threads<T: Send>(
    parts: impl Iterator<Item = T> + Send,
    threads: usize,
    stop: &AtomicBool,
    compute: impl Fn(T) -> Result<(), OpticsError> + Sync,
) -> Result<bool, OpticsError> {
    let (parts, failed) = (Mutex::new(parts), Mutex::new(None));
    let work = || {
        while !stop.load(Ordering::Relaxed) {
            let Some(part) = parts.lock().ok().and_then(|mut parts| parts.next()) else { break };
            if let Err(error) = compute(part) {
                drop(failed.lock().map(|mut failed| _ = failed.get_or_insert(error)));
            }
        }
    };
    match threads {
        0 | 1 => work(),
        several => std::thread::scope(|scope| (0..several).for_each(|_| drop(scope.spawn(work)))),
    }
    match failed.into_inner().ok().flatten() {
        Some(error) => Err(error),
        None => Ok(!stop.load(Ordering::Relaxed)),
    }
}

/// Computes blocks of points on threads; returns false if stopped.
fn computed(
    films: &Films<'_>,
    (reflectance, transmittance): &mut (Vec<f64>, Vec<f64>),
    threads: usize,
    stop: &AtomicBool,
) -> Result<bool, OpticsError> {
    // Whole rows if a block has room for one.
    let length = films.shape.last().copied().unwrap_or(1).max(1);
    let block = (BLOCK / length * length).max(BLOCK.min(length));
    let blocks = reflectance.len().div_ceil(block);
    let mut others = transmittance.chunks_mut(block);
    let parts = reflectance.chunks_mut(block).map(|part| (part, others.next())).enumerate();
    on_threads(parts, threads.min(blocks), stop, |(number, (part, other))| {
        films.powers(number * block, part, other)
    })
}

fn spread<'a>((values, strides): &'a Given<'_>, shape: &[usize]) -> PyResult<Spread<'a>> {
    let values = values.as_slice().map_err(|error| errors::internal(&error.to_string()))?;
    let spread = Spread { values, strides };
    if spread.fits(shape) {
        Ok(spread)
    } else {
        Err(errors::internal("the arrays of films do not fit the shape"))
    }
}

fn all<T, const N: usize>(results: [PyResult<T>; N]) -> PyResult<[T; N]> {
    let found: Vec<T> = results.into_iter().collect::<PyResult<_>>()?;
    found.try_into().map_err(|_| errors::internal("an array lost some of its items"))
}

/// n + ik of a material: a name, or else the path of a file, as in scenarios.
#[pyfunction]
pub(crate) fn material_index<'py>(
    py: Python<'py>,
    name: Option<&str>,
    file: Option<PathBuf>,
    wavelength_nm: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
    let unknown = |error: SpectraError| errors::argument(py, &error.to_string());
    let named = name.map(|name| (name, material(name)));
    let dispersion = match (named, file) {
        (Some((_, Ok(dispersion))), _) => dispersion,
        (Some((name, Err(error))), _) if !papilio_scenario::looks_like_path(name) => {
            let wrong = match papilio_scenario::material_sheet(name) {
                Err(wrong) => with_hint(&wrong),
                Ok(sheet) => format!("{error}; did you mean `{}`?", sheet.entry.name),
            };
            return Err(errors::argument(py, &wrong));
        }
        (Some((path, Err(_))), _) => of_file(py, path.as_ref(), &wavelength_nm)?,
        (None, path) => of_file(py, &path.unwrap_or_default(), &wavelength_nm)?,
    };
    let index = wavelength_nm.as_array().into_iter().map(|nm| dispersion.index(*nm));
    let index: Vec<Complex64> = index.collect::<Result<_, _>>().map_err(unknown)?;
    Ok(PyArray1::from_vec(py, index))
}

/// The index of an n-k file; errors outside the requested wavelengths are ignored.
fn of_file(py: Python<'_>, path: &Path, wavelength_nm: &PyReadonlyArray1<'_, f64>) -> PyResult<Dispersion> {
    let file = DataFile::open(path, &path.display().to_string());
    let wanted = wavelength_nm.as_array();
    let first = wanted.iter().copied().fold(f64::INFINITY, f64::min);
    let last = wanted.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let read = file.and_then(|file| read_index_within(&file, (first, last)));
    let read = read.map_err(|error| errors::format(py, &error))?;
    for note in &read.warnings {
        let text = CString::new(format!("{}: {note}", path.display()))?;
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 2)?;
    }
    Ok(read.value)
}

/// A material with its source, n and k, as JSON.
#[pyfunction]
pub(crate) fn material_sheet(py: Python<'_>, name: &str) -> PyResult<String> {
    let sheet = papilio_scenario::material_sheet(name);
    let sheet = sheet.map_err(|wrong| errors::argument(py, &format!("name: {}", with_hint(&wrong))))?;
    serde_json::to_string(&sheet).map_err(|error| errors::internal(&error.to_string()))
}

/// The message of a diagnostic, with its hint.
pub(crate) fn with_hint(wrong: &papilio_scenario::Diagnostic) -> String {
    let hint = wrong.hint.as_ref().map_or_else(String::new, |hint| format!("; {hint}"));
    format!("{}{hint}", wrong.message)
}

/// Names of materials.
#[pyfunction]
pub(crate) fn material_names() -> Vec<&'static str> {
    papilio_spectra::material_names().to_vec()
}
