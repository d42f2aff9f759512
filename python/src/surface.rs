//! A surface measured by its geometry: the contents of the files of `papilio gonio`.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use papilio_figures::of_surface;
use papilio_formats::{SurfaceAuditFile, write_face, write_totals};
use papilio_microgeometry::{ByAzimuth, ByRays, Coating, Findings, MicrogeometryError};
use papilio_scenario::{ResolvedSurface, SurfaceScenario};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;
use crate::spatial::{Figures, text};
use crate::watch::{ProgressState, detached, watched};

exports! { classes Surface; }

/// A measured surface.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Surface {
    title: String,
    notes: Vec<String>,
    json: String,
    /// The contents of `totals.csv` and `face.npz`, of a surface that was measured by rays.
    rays: Option<[Vec<u8>; 2]>,
    /// The content of `totals_by_azimuth.csv`, if there is one.
    by_azimuth: Option<Vec<u8>>,
    figures: Figures,
}

#[pymethods]
impl Surface {
    /// Measures the surface of a file; `overrides` are texts `PATH=VALUE`, and `name` its title if it has none.
    #[new]
    #[pyo3(signature = (path, overrides, preview, name, threads=None, progress=None))]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        overrides: Vec<String>,
        preview: bool,
        name: &str,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let resolved = detached(py, || SurfaceScenario::load(&path, &overrides)?.resolve())?;
        let resolved = resolved.map_err(|errors| errors::scenario(py, &errors))?;
        let resolved = if preview { resolved.preview() } else { resolved };
        let title = resolved.title.clone().unwrap_or_else(|| name.to_owned());
        let stop = AtomicBool::new(false);
        let found = watched(py, &stop, progress.as_ref(), |watch| {
            let (finished, all) = (AtomicUsize::new(0), resolved.measurement.parts());
            let tell = || watch.tell(ProgressState::Done(finished.fetch_add(1, Ordering::Relaxed) + 1, all));
            resolved.measurement.measured(threads.map(usize::from), &|| stop.load(Ordering::Relaxed), &tell)
        })?;
        let found = found.map_err(|error| match error {
            MicrogeometryError::Interrupted => PyKeyboardInterrupt::new_err(()),
            error => errors::argument(py, &format!("surface: {error}")),
        })?;
        files_of(&resolved, title, &found)
    }

    /// The text of `audit.json`.
    fn json(&self) -> &str {
        &self.json
    }

    /// The content of `totals.csv`; `None` without rays.
    fn totals<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyBytes>> {
        self.rays.as_ref().map(|[totals, _]| PyBytes::new(py, totals))
    }

    /// The content of `totals_by_azimuth.csv`; `None` without azimuths.
    fn totals_by_azimuth<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyBytes>> {
        self.by_azimuth.as_ref().map(|totals| PyBytes::new(py, totals))
    }

    /// The content of `face.npz`; `None` without rays.
    fn face<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyBytes>> {
        self.rays.as_ref().map(|[_, face]| PyBytes::new(py, face))
    }

    fn figures(&self) -> Figures {
        self.figures.clone()
    }

    #[getter]
    fn title(&self) -> &str {
        &self.title
    }

    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}

/// The contents of all files of a measurement.
fn files_of(resolved: &ResolvedSurface, title: String, found: &Findings) -> PyResult<Surface> {
    let head = [env!("CARGO_PKG_VERSION"), &title, &resolved.hash];
    let json = text(&SurfaceAuditFile::new(head, &resolved.notes, &resolved.measurement.goniometer, found))?;
    let figures = of_surface(found, &title);
    let failed = |error: std::io::Error| errors::internal(&error.to_string());
    let rays = found.rays.as_ref().map(|rays| tables(resolved, rays)).transpose().map_err(failed)?;
    let by_azimuth = found.rays.as_ref().and_then(|rays| rays.by_azimuth.as_ref());
    let totals = |found: &ByAzimuth| {
        let mut file = Vec::new();
        write_totals(&mut file, &found.totals).map(|()| file)
    };
    let by_azimuth = by_azimuth.map(totals).transpose().map_err(failed)?;
    Ok(Surface { title, notes: resolved.notes.clone(), json, rays, by_azimuth, figures })
}

/// The contents of `totals.csv` and `face.npz`.
fn tables(resolved: &ResolvedSurface, rays: &ByRays) -> std::io::Result<[Vec<u8>; 2]> {
    let goniometer = &resolved.measurement.goniometer;
    let index = [goniometer.index_above, goniometer.index_below];
    let coated = goniometer.coating != Coating::None;
    let mut files = [Vec::new(), Vec::new()];
    write_totals(&mut files[0], &rays.totals)?;
    write_face(&mut files[1], &resolved.hash, index, rays, coated)?;
    Ok(files)
}
