//! Colours of many spectra in one call, as flat rows.

use numpy::{PyArray1, PyReadonlyArray1};
use papilio_colour::{
    GamutReference, Lab, Observer, Standard, UvPrime, Xyz, coverage_percent, gamut_percent,
};
use papilio_diagnostics::did_you_mean;
use papilio_spectra::{Grid, SpectraError, illuminant};
use pyo3::prelude::*;

use crate::errors;

exports! { functions delta_e_2000, gamut, illuminant_names, illuminant_sheet, illuminant_spectrum, lab, uv_prime, xyz; }

type Reals<'py> = PyReadonlyArray1<'py, f64>;
type Answer<'py> = PyResult<Bound<'py, PyArray1<f64>>>;

/// Computes X, Y, Z of spectra (rows of as many values as the grid), in the spectra's unit times nm.
#[pyfunction]
pub(crate) fn xyz<'py>(
    py: Python<'py>,
    grid: (f64, f64, f64),
    observer: &str,
    spectra: Reals<'py>,
) -> Answer<'py> {
    let standard = if observer == "1964" { Standard::Cie1964 } else { Standard::Cie1931 };
    let grid = wavelength_grid(py, grid)?;
    let observer = Observer::of(standard, &grid);
    let observer = observer.map_err(|error| errors::argument(py, &format!("wavelength_nm: {error}")))?;
    rows::<3>(py, spectra, grid.len(), |spectrum| observer.xyz(spectrum).to_array())
}

/// Spectrum of an illuminant; `argument` is that of its name in errors.
#[pyfunction]
pub(crate) fn illuminant_spectrum<'py>(
    py: Python<'py>,
    argument: &str,
    name: &str,
    grid: (f64, f64, f64),
) -> Answer<'py> {
    let light = illuminant(name, &wavelength_grid(py, grid)?).map_err(|error| {
        let SpectraError::UnknownName { .. } = error else {
            return errors::argument(py, &format!("wavelength_nm: illuminant {name}: {error}"));
        };
        let hint = did_you_mean(name, papilio_spectra::illuminant_names().iter().copied());
        let hint = hint.map_or_else(String::new, |hint| format!("; {hint}"));
        errors::argument(py, &format!("{argument}: {error}{hint}"))
    })?;
    Ok(PyArray1::from_slice(py, &light))
}

/// An illuminant with its colour and spectrum, as JSON.
#[pyfunction]
pub(crate) fn illuminant_sheet(py: Python<'_>, name: &str) -> PyResult<String> {
    let sheet = papilio_scenario::illuminant_sheet(name);
    let sheet = sheet.map_err(|wrong| {
        let wrong = crate::films::with_hint(&wrong);
        errors::argument(py, &format!("name: {wrong}"))
    })?;
    serde_json::to_string(&sheet).map_err(|error| errors::internal(&error.to_string()))
}

/// Names of illuminants.
#[pyfunction]
pub(crate) fn illuminant_names() -> Vec<&'static str> {
    papilio_spectra::illuminant_names().to_vec()
}

/// Computes L*, a*, b* of rows of X, Y, Z followed by those of their white; NaN where undefined.
#[pyfunction]
pub(crate) fn lab<'py>(py: Python<'py>, colours: Reals<'py>) -> Answer<'py> {
    rows::<3>(py, colours, 6, |row| {
        let [colour, white] = [0, 3].map(|at| Xyz { x: row[at], y: row[at + 1], z: row[at + 2] });
        colour.lab(white).map_or([f64::NAN; 3], |lab| [lab.l, lab.a, lab.b])
    })
}

/// Computes u', v' of rows of X, Y, Z; NaN for black.
#[pyfunction]
pub(crate) fn uv_prime<'py>(py: Python<'py>, colours: Reals<'py>) -> Answer<'py> {
    rows::<2>(py, colours, 3, |row| {
        let colour = Xyz { x: row[0], y: row[1], z: row[2] };
        colour.uv_prime().map_or([f64::NAN; 2], |uv| [uv.u, uv.v])
    })
}

/// Computes the area of triangles (rows of three u', v') in % of that of a reference; with `covered`, the covered part of the
/// reference.
#[pyfunction]
pub(crate) fn gamut<'py>(py: Python<'py>, corners: Reals<'py>, of: &str, covered: bool) -> Answer<'py> {
    let reference = match of {
        "srgb" => GamutReference::Srgb,
        "ebu" => GamutReference::Ebu,
        "ntsc" => GamutReference::Ntsc,
        "dci-p3" => GamutReference::DciP3,
        _ => return Err(errors::internal("unknown gamut")),
    };
    let percent = if covered { coverage_percent } else { gamut_percent };
    rows::<1>(py, corners, 6, |row| {
        [percent([0, 2, 4].map(|at| UvPrime { u: row[at], v: row[at + 1] }), reference)]
    })
}

/// Computes CIEDE2000 of rows of two L*, a*, b*.
#[pyfunction]
pub(crate) fn delta_e_2000<'py>(py: Python<'py>, pairs: Reals<'py>) -> Answer<'py> {
    rows::<1>(py, pairs, 6, |row| {
        let [one, other] = [0, 3].map(|at| Lab { l: row[at], a: row[at + 1], b: row[at + 2] });
        [one.delta_e_2000(other)]
    })
}

/// Applies `of` to every row of `length` numbers, without holding the interpreter.
fn rows<'py, const N: usize>(
    py: Python<'py>,
    all: Reals<'py>,
    length: usize,
    of: impl Fn(&[f64]) -> [f64; N] + Send + Sync,
) -> Answer<'py> {
    let all = all.as_slice().map_err(|error| errors::internal(&error.to_string()))?;
    if all.len() % length != 0 {
        return Err(errors::internal("the number of values is not a multiple of the length of a row"));
    }
    let answers: Vec<f64> = py.detach(|| all.chunks_exact(length).flat_map(of).collect());
    Ok(PyArray1::from_vec(py, answers))
}

fn wavelength_grid(py: Python<'_>, (first, last, step): (f64, f64, f64)) -> PyResult<Grid> {
    let grid = Grid::new(first, last, step);
    grid.map_err(|error| errors::argument(py, &format!("wavelength_nm: {error}")))
}
