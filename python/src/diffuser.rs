//! Files of measured scattering: audit, fits of lobes, conversion to other formats.

use std::path::{Path, PathBuf};

use numpy::{PyArray1, PyReadonlyArray1};
use papilio_formats::{
    AuditFile, BsdfFormat, DataFile, FitFile, FormatError, LARGEST_BSDF_FILE, Warned, audit_text, read_bsdf,
    write_file, write_json, write_measurement,
};
use papilio_goniometry::{Audit, Direction, FitOptions, Kind, MeasuredPart, Measurement, fitted};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;
use crate::watch::detached;

exports! { classes Diffuser; functions lobe_names; }

/// Names and SVG texts.
type Figures = Vec<(String, String)>;

/// The measurement in a file.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Diffuser {
    name: String,
    read: Warned<Measurement>,
}

#[pymethods]
impl Diffuser {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let name = path.display().to_string();
        let read = detached(py, || read(&path, &name))?.map_err(|error| errors::format(py, &error))?;
        Ok(Self { name, read })
    }

    /// Reads a file from its bytes; errors call it `name`.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: Vec<u8>, name: String) -> PyResult<Self> {
        let file = DataFile { name: name.clone(), bytes };
        let read = py.detach(|| read_bsdf(&file)).map_err(|error| errors::format(py, &error))?;
        Ok(Self { name, read })
    }

    /// f, 1/sr, of a channel of a part at directions of light and viewer, in rows of theta_i, phi_i, theta_o, phi_o (degrees); NaN where
    /// nothing was measured.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        part: usize,
        channel: usize,
        directions: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let part = self.read.value.parts.get(part).filter(|part| channel < part.channels.len());
        let part = part.ok_or_else(|| errors::internal("unknown part or channel"))?;
        let rows = directions.as_slice().map_err(|error| errors::internal(&error.to_string()))?;
        let found = py.detach(|| {
            let each = rows.chunks_exact(4).map(|row| {
                let (light, viewer) = (Direction::new(row[0], row[1]), Direction::new(row[2], row[3]));
                part.evaluate(channel, light, viewer).unwrap_or(f64::NAN)
            });
            each.collect::<Vec<f64>>()
        });
        Ok(PyArray1::from_vec(py, found))
    }

    /// The bytes of papilio's own format, which holds everything.
    fn npz<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let mut bytes = Vec::new();
        py.detach(|| write_measurement(&mut bytes, BsdfFormat::Papilio, &self.read.value))
            .map_err(|error| errors::internal(&error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.read.warnings.clone()
    }

    /// Side and mode of each part: "front transmission".
    fn parts(&self) -> Vec<&'static str> {
        self.read.value.parts.iter().map(|part| part.way.name()).collect()
    }

    /// The audit as JSON, as text, and as figures.
    fn audit(&self, py: Python<'_>) -> PyResult<(String, String, Figures)> {
        let measurement = &self.read.value;
        py.detach(|| {
            let audits: Vec<Option<Audit>> =
                measurement.parts.iter().map(|part| Audit::of(part, part.luminous())).collect();
            let every =
                |part: &MeasuredPart| (0..part.channels.len()).filter_map(|k| Audit::of(part, k)).collect();
            let all: Vec<(&MeasuredPart, Vec<Audit>)> =
                measurement.parts.iter().map(|part| (part, every(part))).collect();
            let text = audit_text(&self.name, measurement, &audits);
            let figures = papilio_figures::lobes(measurement, &audits);
            json(&AuditFile::new(measurement, &all, [&[], &self.read.warnings]))
                .map(|json| (json, text, figures))
        })
    }

    /// Fits lobes to a part; returns them as JSON, the best fit first.
    fn fit(&self, py: Python<'_>, part: usize, model: Option<&str>) -> PyResult<String> {
        let part = self.read.value.parts.get(part).ok_or_else(|| errors::internal("unknown part"))?;
        let kind = match model {
            None => None,
            Some(name) => Some(kind(name).ok_or_else(|| errors::internal("unknown model"))?),
        };
        let channel = part.luminous();
        let fits = py
            .detach(|| fitted(part, channel, kind, &FitOptions::default()))
            .map_err(|error| errors::argument(py, &error.to_string()))?;
        json(&FitFile::new(part, channel, &fits, [&[], &self.read.warnings]))
    }

    /// Writes the measurement in another format; returns descriptions of the data that this format cannot store.
    fn convert(&self, py: Python<'_>, output: PathBuf, format: &str) -> PyResult<Vec<String>> {
        let format = match format {
            "bsdf" => BsdfFormat::Radiant,
            "csv" => BsdfFormat::Csv,
            "xml" => BsdfFormat::Klems,
            "npz" => BsdfFormat::Papilio,
            _ => return Err(errors::internal("unknown format")),
        };
        let mut lost = Ok(Vec::new());
        let written = py.detach(|| {
            write_file(&output, |out| {
                lost = write_measurement(out, format, &self.read.value);
                lost.as_ref().map(|_| ()).map_err(|error| std::io::Error::other(error.to_string()))
            })
        });
        written.map_err(|error| errors::format(py, &error))?;
        Ok(lost.unwrap_or_default())
    }
}

/// Names of lobes.
#[pyfunction]
pub(crate) fn lobe_names() -> Vec<&'static str> {
    Kind::ALL.map(Kind::name).to_vec()
}

fn kind(name: &str) -> Option<Kind> {
    Kind::ALL.into_iter().find(|kind| kind.name() == name)
}

fn read(path: &Path, name: &str) -> Result<Warned<Measurement>, FormatError> {
    read_bsdf(&DataFile::open_within(path, name, LARGEST_BSDF_FILE)?)
}

fn json(file: &impl serde::Serialize) -> PyResult<String> {
    let mut bytes = Vec::new();
    write_json(&mut bytes, file).map_err(|error| errors::internal(&error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| errors::internal(&error.to_string()))
}
