//! The palette of a display: the content of the files of `papilio palette`.

use papilio_display::image::ScreenWhite;
use papilio_display::palette::{PaletteResult, palette};
use papilio_formats::{TitledFile, files_of_palette};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::scenario::Resolved;
use crate::spatial::{Tables, text};
use crate::watch::computed;

exports! { classes Palette; }

/// Palette of a display.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Palette {
    of: PaletteResult,
    json: String,
}

#[pymethods]
impl Palette {
    #[new]
    #[pyo3(signature = (scenario, rooms, title, threads=None, progress=None))]
    fn new(
        py: Python<'_>,
        scenario: &Resolved,
        rooms: Vec<(String, Bound<'_, Resolved>)>,
        title: &str,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let resolved = &scenario.of;
        let scenes: Vec<_> = rooms.iter().map(|(name, room)| (name.clone(), &room.get().of.scene)).collect();
        let mut of =
            computed(py, resolved, threads, progress, |control| palette(&resolved.scene, &scenes, control))?;
        resolved.warn_of_rooms(
            rooms.iter().map(|(name, room)| (name.as_str(), &*room.get().of)),
            &mut of.warnings,
        );
        resolved.warn_before(&mut of.warnings);
        let json = text(&TitledFile {
            papilio: env!("CARGO_PKG_VERSION"),
            title,
            hash: &resolved.hash,
            notes: &resolved.notes,
            result: &of,
        })?;
        Ok(Self { of, json })
    }

    /// The text of `palette.json`.
    fn json(&self) -> &str {
        &self.json
    }

    fn figures(&self, py: Python<'_>, title: &str) -> Vec<(String, String)> {
        py.detach(|| papilio_figures::of_palette(&self.of, title))
    }

    /// The files for other programs.
    fn tables<'py>(&self, py: Python<'py>, title: &str, relative_to_display: bool) -> Tables<'py> {
        let white = if relative_to_display { ScreenWhite::Display } else { ScreenWhite::Perfect };
        let files = files_of_palette(title, &self.of, white).into_iter();
        files.map(|(name, content)| (name.to_owned(), PyBytes::new(py, &content))).collect()
    }

    fn warnings(&self) -> Vec<String> {
        self.of.warnings.clone()
    }
}
