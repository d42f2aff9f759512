//! Coherent films beyond their powers: amplitudes, absorption by layer, derivatives; one stack at each point of broadcast arrays.

use numpy::{Complex64, PyArray1};
use papilio_optics::OpticsError;
use papilio_optics::film::{
    Coherent, Film, GapFilm, Layer, Polarisation, SpectralLayer, Thickness, Variable, coherent,
};
use pyo3::prelude::*;

use crate::errors;
use crate::films::{Answer, Films, Given, given, on_threads, stoppable};

exports! { functions film_absorptance, film_amplitudes, film_derivatives; }

/// Number of points that a thread takes at a time: some hundred microseconds.
const POINTS: usize = 256;

/// Computes r_s, r_p, t_s, t_p at every point, complex, the last axis; r_p and t_p as the optics crate defines them. The other
/// arguments are those of `film`.
#[pyfunction]
#[pyo3(signature = (shape, wavelength_nm, beta, incidence, layers, substrate, threads))]
#[allow(clippy::too_many_arguments, reason = "the arrays of one call")]
pub(crate) fn film_amplitudes<'py>(
    py: Python<'py>,
    shape: Vec<usize>,
    wavelength_nm: Given<'py>,
    beta: Given<'py>,
    incidence: Given<'py>,
    layers: Vec<[Given<'py>; 3]>,
    substrate: [Given<'py>; 2],
    threads: usize,
) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
    let films = given(&shape, [&wavelength_nm, &beta, &incidence], &layers, &substrate, "mean")?;
    let found = at_points(py, &films, 4, threads, |[s, p]: &[Coherent; 2], out| {
        out.copy_from_slice(&[s.r, p.r, s.t, p.t]);
    })?;
    Ok(PyArray1::from_vec(py, found))
}

/// Computes the fraction of the power that each layer absorbs at every point; layers are the last axis. The other arguments are
/// those of `film`.
#[pyfunction]
#[pyo3(signature = (shape, wavelength_nm, beta, incidence, layers, substrate, polarisation, threads))]
#[allow(clippy::too_many_arguments, reason = "the arrays of one call")]
pub(crate) fn film_absorptance<'py>(
    py: Python<'py>,
    shape: Vec<usize>,
    wavelength_nm: Given<'py>,
    beta: Given<'py>,
    incidence: Given<'py>,
    layers: Vec<[Given<'py>; 3]>,
    substrate: [Given<'py>; 2],
    polarisation: &str,
    threads: usize,
) -> PyResult<Answer<'py>> {
    let films = given(&shape, [&wavelength_nm, &beta, &incidence], &layers, &substrate, polarisation)?;
    let (of_s, of_p) = match films.polarisation {
        Some(Polarisation::S) => (1.0, 0.0),
        Some(Polarisation::P) => (0.0, 1.0),
        None => (0.5, 0.5),
    };
    let found = at_points(py, &films, layers.len(), threads, |[s, p]: &[Coherent; 2], out| {
        for (out, (s, p)) in out.iter_mut().zip(s.absorptance.iter().zip(&p.absorptance)) {
            *out = of_s * s + of_p * p;
        }
    })?;
    Ok(PyArray1::from_vec(py, found))
}

/// Computes `width` numbers at every point, from its response to s and p.
fn at_points<T: Send + Default + Clone>(
    py: Python<'_>,
    films: &Films<'_>,
    width: usize,
    threads: usize,
    of: impl Fn(&[Coherent; 2], &mut [T]) + Sync,
) -> PyResult<Vec<T>> {
    films.check().map_err(|error| errors::argument(py, &error.to_string()))?;
    let size: usize = films.shape.iter().product();
    let mut found = vec![T::default(); size * width];
    stoppable(py, |stop| {
        let blocks = found.chunks_mut((POINTS * width).max(1)).enumerate();
        on_threads(blocks, threads.min(size.div_ceil(POINTS)), stop, |(number, block)| {
            for (at, out) in block.chunks_mut(width).enumerate() {
                of(&response(films, &films.place(number * POINTS + at))?, out);
            }
            Ok(())
        })
    })?;
    Ok(found)
}

/// Response of the film at a point to both polarisations.
fn response(films: &Films<'_>, place: &[usize]) -> Result<[Coherent; 2], OpticsError> {
    let index = |n: f64, k: f64| Complex64::new(n, k);
    let film = Film {
        incidence: films.incidence.at(place),
        layers: (films.layers.iter())
            .map(|[n, k, nm]| Layer { index: index(n.at(place), k.at(place)), thickness_nm: nm.at(place) })
            .collect(),
        substrate: index(films.substrate[0].at(place), films.substrate[1].at(place)),
    };
    let (nm, beta) = (films.wavelength_nm.at(place), films.beta.at(place));
    Ok([coherent(&film, nm, beta, Polarisation::S)?, coherent(&film, nm, beta, Polarisation::P)?])
}

/// Computes the mean reflectance of s and p at every point, and its derivatives, with the variables as the last axis. A variable is
/// "thickness", "n" or "k", and the number of its layer (`None`: the substrate). The other arguments are those of `film`.
#[pyfunction]
#[pyo3(signature = (shape, wavelength_nm, beta, incidence, layers, substrate, variables, threads))]
#[allow(clippy::too_many_arguments, reason = "the arrays of one call")]
pub(crate) fn film_derivatives<'py>(
    py: Python<'py>,
    shape: Vec<usize>,
    wavelength_nm: Given<'py>,
    beta: Given<'py>,
    incidence: Given<'py>,
    layers: Vec<[Given<'py>; 3]>,
    substrate: [Given<'py>; 2],
    variables: Vec<(String, Option<usize>)>,
    threads: usize,
) -> PyResult<(Answer<'py>, Answer<'py>)> {
    let films = given(&shape, [&wavelength_nm, &beta, &incidence], &layers, &substrate, "mean")?;
    films.check().map_err(|error| errors::argument(py, &error.to_string()))?;
    let variable = |(of, layer): &(String, Option<usize>)| match (of.as_str(), *layer) {
        ("thickness", Some(layer)) => Ok(Variable::Thickness(layer)),
        ("n", Some(layer)) => Ok(Variable::Index(layer)),
        ("k", Some(layer)) => Ok(Variable::Extinction(layer)),
        ("n", None) => Ok(Variable::SubstrateIndex),
        ("k", None) => Ok(Variable::SubstrateExtinction),
        _ => Err(errors::internal("unknown variable of a film")),
    };
    let variables: Vec<Variable> = variables.iter().map(variable).collect::<PyResult<_>>()?;
    let rows = Rows::new(&films, &variables);
    let points: usize = shape.iter().product();
    let (mut values, mut slopes) = (vec![0.0; points], vec![0.0; points * variables.len()]);
    stoppable(py, |stop| {
        let mut after = slopes.as_mut_slice();
        // Without variables, the slopes of every row are empty.
        let parts = values.chunks_mut(rows.length).map(|values| {
            let slopes;
            (slopes, after) = std::mem::take(&mut after).split_at_mut(values.len() * variables.len());
            (values, slopes)
        });
        let rows_of =
            parts.enumerate().map(|(number, (values, slopes))| (number * rows.length, values, slopes));
        on_threads(rows_of, threads, stop, |(start, values, slopes)| rows.compute(start, values, slopes))
    })?;
    Ok((PyArray1::from_vec(py, values), PyArray1::from_vec(py, slopes)))
}

/// Rows of points that are one film at several wavelengths; single points where angle or thickness change along the last axis.
struct Rows<'a> {
    films: &'a Films<'a>,
    variables: &'a [Variable],
    length: usize,
}

impl<'a> Rows<'a> {
    fn new(films: &'a Films<'a>, variables: &'a [Variable]) -> Self {
        let alone = films.beta.varies() || films.layers.iter().any(|[_, _, nm]| nm.varies());
        let length = if alone { 1 } else { films.shape.last().copied().unwrap_or(1).max(1) };
        Self { films, variables, length }
    }

    fn compute(&self, start: usize, values: &mut [f64], slopes: &mut [f64]) -> Result<(), OpticsError> {
        let films = self.films;
        let mut place = films.place(start);
        let first = place.last().copied().unwrap_or(0);
        let mut along = |of: &dyn Fn(&[usize]) -> Complex64| -> Vec<Complex64> {
            let each = (0..values.len()).map(|at| {
                if let Some(last) = place.last_mut() {
                    *last = first + at;
                }
                of(&place)
            });
            each.collect()
        };
        let mut reals = |of: &dyn Fn(&[usize]) -> f64| -> Vec<f64> {
            along(&|place| of(place).into()).into_iter().map(|number| number.re).collect()
        };
        let wavelengths = reals(&|place| films.wavelength_nm.at(place));
        let incidence = reals(&|place| films.incidence.at(place));
        let substrate =
            along(&|place| Complex64::new(films.substrate[0].at(place), films.substrate[1].at(place)));
        let layers: Vec<SpectralLayer> = (films.layers.iter())
            .map(|[n, k, _]| along(&|place| Complex64::new(n.at(place), k.at(place))))
            .zip(&films.layers)
            .map(|(index, [_, _, nm])| SpectralLayer {
                index,
                thickness: Thickness::Fixed(nm.at(&films.place(start))),
            })
            .collect();
        let film = GapFilm::new(&wavelengths, &incidence, &layers, &substrate)?;
        let beta = films.beta.at(&films.place(start));
        let mut by_variable = vec![0.0; slopes.len()];
        film.derivatives(&[beta], &[0.0], self.variables, values, &mut by_variable)?;
        for (variable, of_variable) in by_variable.chunks(values.len()).enumerate() {
            for (at, slope) in of_variable.iter().enumerate() {
                slopes[at * self.variables.len() + variable] = *slope;
            }
        }
        Ok(())
    }
}
