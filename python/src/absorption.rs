//! Absorptance of each layer of a film pixel.

use papilio_display::pixel::{PixelAbsorption, absorption};
use papilio_display::scene::AngleMedium;
use papilio_formats::{write_absorption, write_sub_pixels};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::columns::array;
use crate::errors;
use crate::scenario::Resolved;
use crate::watch::detached;

exports! { classes Absorption; }

/// The absorptance of each layer of the film pixel of a scenario.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Absorption {
    of: PixelAbsorption,
    medium: &'static str,
}

#[pymethods]
impl Absorption {
    /// Computes it at these angles, 0 to 90 degrees, in the medium of the scenario's angles.
    #[new]
    fn new(py: Python<'_>, scenario: &Resolved, theta_deg: Vec<f64>) -> PyResult<Self> {
        let found = detached(py, || absorption(&scenario.of.scene, &theta_deg))?;
        let in_air = scenario.of.scene.solver.angle_medium == AngleMedium::Air;
        let medium = if in_air { "air" } else { "glass" };
        found.map(|of| Self { of, medium }).map_err(|error| errors::display_of(py, &scenario.of, &error))
    }

    /// The medium of the angles: `air` or `glass`.
    fn medium(&self) -> &'static str {
        self.medium
    }

    /// The layers, from the glass down: numbers in `display.pixel.film` (`substrate` for the last one) and materials.
    fn layers(&self) -> Vec<(String, String)> {
        let number = |number: Option<usize>| number.map_or("substrate".to_owned(), |one| one.to_string());
        self.of.layers.iter().map(|layer| (number(layer.number), layer.material.clone())).collect()
    }

    /// The states and the sub-pixels.
    fn names(&self) -> (Vec<String>, Vec<String>) {
        let distinct = |names: Vec<&String>| {
            let mut all: Vec<String> = Vec::new();
            names.into_iter().for_each(|name| {
                if !all.contains(name) {
                    all.push(name.clone());
                }
            });
            all
        };
        let parts = &self.of.sub_pixels;
        let states = distinct(parts.iter().map(|one| &one.state).collect());
        (states, distinct(parts.iter().map(|one| &one.sub_pixel).collect()))
    }

    /// Arrays by name: `theta_deg`, `wavelength_nm`, `area` (shape [state, sub_pixel]), `reflectance` (shape [state, sub_pixel,
    /// theta_deg, wavelength_nm]) and `absorptance` (shape [state, sub_pixel, layer, theta_deg, wavelength_nm]).
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (states, sub_pixels) = self.names();
        let of = &self.of;
        let (names, points) =
            ([states.len(), sub_pixels.len()], [of.theta_deg.len(), of.wavelength_nm.len()]);
        let parts = || of.sub_pixels.iter();
        let arrays = PyDict::new(py);
        let [angles, nm] = points;
        arrays.set_item("theta_deg", array(py, &[angles], of.theta_deg.clone())?)?;
        arrays.set_item("wavelength_nm", array(py, &[nm], of.wavelength_nm.clone())?)?;
        arrays.set_item("area", array(py, &names, parts().map(|one| one.area).collect())?)?;
        let reflectance = parts().flat_map(|one| one.reflectance.iter().copied()).collect();
        arrays.set_item("reflectance", array(py, &[names, points].concat(), reflectance)?)?;
        let absorptance = parts().flat_map(|one| one.absorptance.iter().copied()).collect();
        let shape = [&names[..], &[of.layers.len()], &points].concat();
        arrays.set_item("absorptance", array(py, &shape, absorptance)?)?;
        Ok(arrays)
    }

    /// Names and contents of the tables of `papilio pixel --absorption`.
    fn tables<'py>(&self, py: Python<'py>) -> PyResult<[(&'static str, Bound<'py, PyBytes>); 2]> {
        let [mut layers, mut sub_pixels] = [Vec::new(), Vec::new()];
        write_absorption(&mut layers, &self.of)
            .and_then(|()| write_sub_pixels(&mut sub_pixels, &self.of))
            .map_err(|error| errors::internal(&error.to_string()))?;
        Ok([("absorption.csv", PyBytes::new(py, &layers)), ("sub-pixels.csv", PyBytes::new(py, &sub_pixels))])
    }

    /// SVG text of the figure.
    fn figure(&self, py: Python<'_>, title: &str) -> String {
        py.detach(|| papilio_figures::absorption(&self.of, self.medium, title))
    }
}
