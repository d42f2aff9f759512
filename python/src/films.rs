//! Coherent films, one stack at each point of arrays that numpy has broadcast together.

use std::ffi::CString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use numpy::{Complex64, PyArray1, PyReadonlyArray1, PyReadonlyArrayDyn};
use papilio_formats::{DataFile, read_index_within};
use papilio_optics::OpticsError;
use papilio_optics::film::{Film, Layer, Polarisation, coherent};
use papilio_spectra::{SpectraError, material};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;

use crate::errors;
use crate::watch::watched;

/// Films between two looks for Ctrl-C.
const BLOCK: usize = 1024;

type Reals<'py> = PyReadonlyArrayDyn<'py, f64>;
type Complexes<'py> = PyReadonlyArrayDyn<'py, Complex64>;

/// Reflectance and transmittance at every point: `beta` is n0 sin(theta), `layers` from the light's side down.
///
/// All arrays have one shape; the answers are flat, in its C order.
#[pyfunction]
#[allow(clippy::type_complexity, reason = "the arrays of one call")]
pub(crate) fn film<'py>(
    py: Python<'py>,
    wavelength_nm: Reals<'py>,
    beta: Reals<'py>,
    incidence: Reals<'py>,
    layers: Vec<(Complexes<'py>, Reals<'py>)>,
    substrate: Complexes<'py>,
    polarisation: &str,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
    let polarisations: &[Polarisation] = match polarisation {
        "s" => &[Polarisation::S],
        "p" => &[Polarisation::P],
        _ => &[Polarisation::S, Polarisation::P],
    };
    let (wavelength_nm, beta, incidence) = (wavelength_nm.as_array(), beta.as_array(), incidence.as_array());
    let substrate = substrate.as_array();
    let layers: Vec<_> = layers.iter().map(|(index, nm)| (index.as_array(), nm.as_array())).collect();
    let shape = wavelength_nm.shape();
    let alike = [beta.shape(), incidence.shape(), substrate.shape()].iter().all(|other| *other == shape);
    if !alike || !layers.iter().all(|(index, nm)| index.shape() == shape && nm.shape() == shape) {
        return Err(errors::internal("arrays of films are not alike"));
    }
    let all = watched(py, &AtomicBool::new(false), None, |watch| {
        let (mut reflectances, mut transmittances) = (Vec::new(), Vec::new());
        let mut inside: Vec<_> = layers.iter().map(|(index, nm)| index.iter().zip(nm.iter())).collect();
        let points = wavelength_nm.iter().zip(beta.iter()).zip(incidence.iter().zip(substrate.iter()));
        let mut film = Film { incidence: 1.0, layers: Vec::new(), substrate: Complex64::ONE };
        for (at, ((nm, beta), (incidence, substrate))) in points.enumerate() {
            if at % BLOCK == 0 && watch.stop.load(Ordering::Relaxed) {
                break;
            }
            film.layers.clear();
            let layer = |(index, nm): (&Complex64, &f64)| Layer { index: *index, thickness_nm: *nm };
            film.layers.extend(inside.iter_mut().filter_map(Iterator::next).map(layer));
            (film.incidence, film.substrate) = (*incidence, *substrate);
            let (reflectance, transmittance) = mean(&film, *nm, *beta, polarisations)?;
            reflectances.push(reflectance);
            transmittances.push(transmittance);
        }
        Ok((reflectances, transmittances))
    })?;
    let (reflectances, transmittances) =
        all.map_err(|error: OpticsError| errors::argument(py, &error.to_string()))?;
    Ok((PyArray1::from_vec(py, reflectances), PyArray1::from_vec(py, transmittances)))
}

fn mean(film: &Film, nm: f64, beta: f64, of: &[Polarisation]) -> Result<(f64, f64), OpticsError> {
    let (mut reflectance, mut transmittance) = (0.0, 0.0);
    for polarisation in of {
        let one = coherent(film, nm, beta, *polarisation)?;
        reflectance += one.reflectance / of.len() as f64;
        transmittance += one.transmittance / of.len() as f64;
    }
    Ok((reflectance, transmittance))
}

/// n + ik of a named material, or of a file.
#[pyfunction]
pub(crate) fn material_index<'py>(
    py: Python<'py>,
    name: Option<&str>,
    file: Option<PathBuf>,
    wavelength_nm: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
    let unknown = |error: SpectraError| errors::argument(py, &error.to_string());
    let dispersion = match (name, file) {
        (Some(name), _) => material(name).map_err(unknown)?,
        (None, path) => {
            let path = path.unwrap_or_default();
            let file = DataFile::open(&path, &path.display().to_string());
            // What the wanted wavelengths do not touch need not be sound.
            let wanted = wavelength_nm.as_array();
            let first = wanted.iter().copied().fold(f64::INFINITY, f64::min);
            let last = wanted.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let read = file.and_then(|file| read_index_within(&file, (first, last)));
            let read = read.map_err(|error| errors::format(py, &error))?;
            for note in &read.warnings {
                let text = CString::new(format!("{}: {note}", path.display()))?;
                PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 2)?;
            }
            read.value
        }
    };
    let index = wavelength_nm.as_array().into_iter().map(|nm| dispersion.index(*nm));
    let index: Vec<Complex64> = index.collect::<Result<_, _>>().map_err(unknown)?;
    Ok(PyArray1::from_vec(py, index))
}

/// The names of materials.
#[pyfunction]
pub(crate) fn material_names() -> Vec<&'static str> {
    papilio_spectra::material_names().to_vec()
}
