//! A picture on the display: the content of the files of `papilio image`.

use std::sync::Arc;

use numpy::ndarray::{ArrayD, IxDyn};
use numpy::{Element, IntoPyArray, PyArrayDyn, PyReadonlyArray2, PyReadonlyArray3};
use papilio_colour::{Adaptation, Xyz};
use papilio_display::image::{ImageResult, Screen, ScreenSpace, ScreenWhite, SourceImage, image};
use papilio_display::palette::bytes;
use papilio_formats::panel::write_states_png;
use papilio_formats::{RgbSpace, TitledFile, Transfer, write_rgb_png, write_scene_exr};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;
use crate::result::written;
use crate::scenario::{Described, Resolved};
use crate::spatial::{Tables, text};
use crate::watch::{computed, detached};

exports! { classes Image; functions scene_exr; }

/// Name of a controller, and codes of the states.
type Codes = (Option<&'static str>, Vec<(String, u8)>);

/// A picture on a display.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Image {
    of: ImageResult,
    /// X, Y, Z of each pixel that are wanted.
    wanted: Vec<[f32; 3]>,
    /// Name of the controller, and codes of the states, of `display.pixel.codes`.
    codes: Option<Codes>,
    json: String,
    title: String,
    notes: Vec<String>,
}

#[pymethods]
impl Image {
    /// `picture`: red, green and blue of sRGB, 0 to 1, encoded or linear; `states`: the number of the state of each pixel.
    #[new]
    #[pyo3(signature = (described, name, picture, encoded, states, relative_to_display, display_p3, threads=None, progress=None))]
    #[allow(clippy::too_many_arguments, reason = "the arguments of one function in Python")]
    fn new(
        py: Python<'_>,
        described: &Described,
        name: &str,
        picture: Option<PyReadonlyArray3<'_, f64>>,
        encoded: bool,
        states: Option<PyReadonlyArray2<'_, u8>>,
        relative_to_display: bool,
        display_p3: bool,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let given = picture.map(|picture| source(&picture, encoded)).transpose()?;
        let resolved = detached(py, || match &given {
            Some(given) => described.scenario.resolve_with(given),
            None => described.scenario.resolve_with_picture(),
        })?;
        let scenario = Resolved { of: Arc::new(resolved.map_err(|errors| errors::scenario(py, &errors))?) };
        let resolved = Arc::clone(&scenario.of);
        let request = resolved.image.as_ref().ok_or_else(|| errors::internal("a picture that is missing"))?;
        let mut settings = request.settings.clone();
        if let Some(states) = states {
            let states = states.as_array();
            let columns = request.source.columns;
            let rows = request.source.pixels.len() / columns.max(1);
            if states.dim() != (rows, columns) {
                let wrong = format!(
                    "states: the shape is {:?} (expected ({rows}, {columns}), rows and columns)",
                    states.dim()
                );
                return Err(errors::argument(py, &wrong));
            }
            settings.given = Some(states.iter().copied().collect());
        }
        let white = if relative_to_display { ScreenWhite::Display } else { ScreenWhite::Perfect };
        let space = if display_p3 { ScreenSpace::DisplayP3 } else { ScreenSpace::Srgb };
        let screen = Screen { white, space };
        let mut of = computed(py, &scenario.of, threads, progress, |control| {
            image(&resolved.scene, &request.source, &settings, screen, control)
        })?;
        let title = resolved.title.clone().unwrap_or_else(|| name.to_owned());
        resolved.warn_before(&mut of.numbers.warnings);
        let notes = resolved.notes_of_places();
        let json = text(&TitledFile {
            papilio: env!("CARGO_PKG_VERSION"),
            title: &title,
            hash: &resolved.hash,
            notes: &notes,
            result: &of.numbers,
        })?;
        let codes = request.codes.as_ref();
        let codes = codes.map(|codes| (codes.controller.map(|one| one.name), codes.of_states.clone()));
        let wanted = of.wanted(&request.source);
        Ok(Self { of, wanted, codes, json, title, notes })
    }

    /// Name of the controller, and codes of the states; None: the scenario has none.
    fn codes(&self) -> Option<Codes> {
        self.codes.clone()
    }

    /// The text of `image.json`.
    fn json(&self) -> &str {
        &self.json
    }

    /// Pictures by name, shape [row, column, 3]; `states`, shape [row, column], only with a halftone.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let [columns, rows] = self.of.size;
        let dict = PyDict::new(py);
        for (name, pixels) in [("wanted", &self.wanted), ("mapped", &self.of.mapped)] {
            dict.set_item(name, array(py, &[rows, columns, 3], pixels.as_flattened().to_vec())?)?;
        }
        let [across, down] = self.of.seen_size();
        dict.set_item("seen", array(py, &[down, across, 3], self.of.seen.as_flattened().to_vec())?)?;
        dict.set_item("srgb", array(py, &[down, across, 3], self.of.on_screen.as_flattened().to_vec())?)?;
        if !self.of.states.is_empty() {
            dict.set_item("states", array(py, &[rows, columns], self.of.states.clone())?)?;
        }
        Ok(dict)
    }

    /// The contents of `seen.png` and, with a halftone, of `states.png`.
    fn pictures<'py>(&self, py: Python<'py>) -> PyResult<Tables<'py>> {
        let ImageResult { size: [columns, _], states, numbers, .. } = &self.of;
        let is_display_p3 = self.of.space == ScreenSpace::DisplayP3;
        let across = self.of.seen_size()[0];
        let seen = written(py, |out| write_rgb_png(out, across, &self.of.on_screen, is_display_p3))?;
        let mut pictures = vec![("seen.png".to_owned(), seen)];
        if !states.is_empty() {
            let shown = self.shown();
            let content =
                written(py, |out| write_states_png(out, *columns, states, &shown, &numbers.states))?;
            pictures.push(("states.png".to_owned(), content));
        }
        Ok(pictures)
    }

    /// Encoded red, green and blue of each state, as in `states.png`.
    fn colours(&self) -> Vec<(u8, u8, u8)> {
        self.shown().into_iter().map(<(u8, u8, u8)>::from).collect()
    }

    /// The matrix that adapts X, Y and Z to D65, and the luminance of a perfect white, for `scene_exr`.
    fn light(&self) -> ([[f64; 3]; 3], f32) {
        (*self.of.to_d65().matrix(), self.of.white_cd_m2)
    }

    #[getter]
    fn title(&self) -> &str {
        &self.title
    }

    /// Warnings of the scenario and of the computation.
    fn warnings(&self) -> Vec<String> {
        self.of.numbers.warnings.clone()
    }

    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}

impl Image {
    /// Encoded red, green and blue of each state.
    fn shown(&self) -> Vec<[u8; 3]> {
        self.of.palette.colours.iter().map(|colour| colour.srgb.map_or([0; 3], bytes)).collect()
    }
}

/// The content of `seen.exr`: X, Y and Z of each sample, and the `light` of an [`Image`].
#[pyfunction]
pub(crate) fn scene_exr(
    py: Python<'_>,
    seen: PyReadonlyArray3<'_, f32>,
    to_d65: [[f64; 3]; 3],
    white_cd_m2: f32,
) -> PyResult<Vec<u8>> {
    let (to_d65, seen) = (Adaptation::of_matrix(to_d65), seen.as_array());
    let columns = seen.dim().1;
    let flat: Vec<f32> = seen.iter().copied().collect();
    let samples: &[[f32; 3]] = flat.as_chunks().0;
    let linear = |sample: usize| {
        let [x, y, z] = samples[sample].map(f64::from);
        to_d65.apply(Xyz { x, y, z }).linear_srgb().map(|value| value as f32)
    };
    let write = |out: &mut Vec<u8>| write_scene_exr(out, columns, samples.len(), linear, Some(white_cd_m2));
    let mut content = Vec::new();
    py.detach(|| write(&mut content)).map_err(|error| errors::internal(&error.to_string()))?;
    Ok(content)
}

/// A picture in linear light.
fn source(picture: &PyReadonlyArray3<'_, f64>, encoded: bool) -> PyResult<SourceImage> {
    let values = picture.as_array();
    let space = RgbSpace::srgb();
    let matrix = space.xyz_from_rgb().ok_or_else(|| errors::internal("sRGB without a matrix"))?;
    let transfer = if encoded { space.transfer } else { Transfer::Linear };
    let pixel = |rgb: &[f64]| {
        let light = [rgb[0], rgb[1], rgb[2]].map(|value| transfer.decode(value));
        matrix.map(|row| (row[0] * light[0] + row[1] * light[1] + row[2] * light[2]) as f32)
    };
    let flat: Vec<f64> = values.iter().copied().collect();
    Ok(SourceImage { columns: values.dim().1, pixels: flat.chunks_exact(3).map(pixel).collect() })
}

fn array<'py, T: Element>(
    py: Python<'py>,
    shape: &[usize],
    values: Vec<T>,
) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let array = ArrayD::from_shape_vec(IxDyn(shape), values);
    Ok(array.map_err(|error| errors::internal(&error.to_string()))?.into_pyarray(py))
}
