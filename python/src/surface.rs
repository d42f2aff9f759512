//! A surface measured by its geometry: the contents of the files of `papilio gonio`.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use papilio_figures::of_surface;
use papilio_formats::{SurfaceAuditFile, write_face, write_totals};
use papilio_microgeometry::{Coating, Kernel, MicrogeometryError, Total, Waves};
use papilio_scenario::{ResolvedSurface, SurfaceScenario};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;
use crate::spatial::{Figures, text};
use crate::watch::watched;

/// A measured surface.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Surface {
    title: String,
    notes: Vec<String>,
    json: String,
    /// The contents of `totals.csv` and `face.npz`, of a surface that was measured by rays.
    rays: Option<[Vec<u8>; 2]>,
    figures: Figures,
}

#[pymethods]
impl Surface {
    /// Measures the surface of a file; `overrides` are texts `PATH=VALUE`, and `name` its title if it has none.
    #[new]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        overrides: Vec<String>,
        preview: bool,
        name: &str,
    ) -> PyResult<Self> {
        let resolved = py.detach(|| SurfaceScenario::load(&path, &overrides)?.resolve());
        let resolved = resolved.map_err(|errors| errors::scenario(py, &errors))?;
        let resolved = if preview { resolved.preview() } else { resolved };
        let title = resolved.title.clone().unwrap_or_else(|| name.to_owned());
        let stop = AtomicBool::new(false);
        let found = watched(py, &stop, None, |_| Self::measured(&resolved, title, &stop))?;
        found.map_err(|error| match error {
            MicrogeometryError::Interrupted => PyKeyboardInterrupt::new_err(()),
            error => errors::argument(py, &format!("surface: {error}")),
        })?
    }

    /// The text of `audit.json`.
    fn json(&self) -> &str {
        &self.json
    }

    /// The content of `totals.csv`; `None` without rays.
    fn totals<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyBytes>> {
        self.rays.as_ref().map(|[totals, _]| PyBytes::new(py, totals))
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

impl Surface {
    fn measured(
        resolved: &ResolvedSurface,
        title: String,
        stop: &AtomicBool,
    ) -> Result<PyResult<Self>, MicrogeometryError> {
        let ResolvedSurface { surface, goniometer, waves_nm, .. } = resolved;
        let index = [goniometer.index_above, goniometer.index_below];
        let stop = || stop.load(Ordering::Relaxed);
        let statistics = surface.statistics()?;
        let waves = Waves { index, wavelengths_nm: waves_nm.clone() };
        let screen = |number| waves.screen(surface, number, &stop);
        let screens = (0..Waves::screens(surface)).map(screen);
        let waves = match waves_nm.is_empty() {
            true => None,
            false => Some(waves.combined(surface, &screens.collect::<Result<Vec<_>, _>>()?)),
        };
        let by_rays = || {
            let replicates = goniometer.replicates(surface, &stop)?;
            Ok::<_, MicrogeometryError>((goniometer.totals(&replicates)?, goniometer.kernel(&replicates)?))
        };
        let rays = resolved.by_rays.then(by_rays).transpose()?;
        let totals = rays.as_ref().map(|(totals, _)| &totals[..]);
        let audit = SurfaceAuditFile::new(
            [env!("CARGO_PKG_VERSION"), &title, &resolved.hash],
            goniometer,
            rays.as_ref().map(|(totals, kernel)| (&kernel.audit, &totals[..])),
            waves.as_ref(),
            statistics.as_ref(),
        );
        let json = text(&audit);
        let figures = of_surface(totals, statistics.as_ref(), waves.as_ref(), &title);
        let files = rays.as_ref().map(|rays| files(resolved, index, rays)).transpose();
        Ok(json.and_then(|json| {
            let rays = files.map_err(|error| errors::internal(&error.to_string()))?;
            Ok(Self { title, notes: resolved.notes.clone(), json, rays, figures })
        }))
    }
}

/// The contents of `totals.csv` and `face.npz`.
fn files(
    resolved: &ResolvedSurface,
    index: [f64; 2],
    (totals, kernel): &(Vec<Total>, Kernel),
) -> std::io::Result<[Vec<u8>; 2]> {
    let coated = resolved.goniometer.coating != Coating::None;
    let mut files = [Vec::new(), Vec::new()];
    write_totals(&mut files[0], totals)?;
    write_face(&mut files[1], &resolved.hash, index, kernel, coated)?;
    Ok(files)
}
