//! Conoscopic maps.

use numpy::PyArray1;
use papilio_display::{ConeGrid, ConeResult, ConeState, ConeView};
use papilio_formats::{ConeFile, write_cone_csv, write_cone_npy, write_json};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::columns::array;
use crate::errors;
use crate::scenario::Resolved;
use crate::spatial::Figures;
use crate::watch::computed;

exports! { classes Cone; }

/// A name, and the function that returns the number.
type Of<T> = (&'static str, fn(&T) -> f64);

const OF_ALL_STATES: [Of<ConeView>; 3] = [
    ("contrast_ratio", |view| view.contrast_ratio.unwrap_or(f64::NAN)),
    ("gamut_percent_srgb", |view| view.gamut_percent_srgb.unwrap_or(f64::NAN)),
    ("gamut_percent_ebu", |view| view.gamut_percent_ebu.unwrap_or(f64::NAN)),
];

const OF_EACH_STATE: [Of<ConeState>; 10] = [
    ("Y", |state| state.reflectance_factor_y),
    ("luminance_cd_m2", |state| state.luminance_cd_m2),
    ("u_prime", |state| state.u_prime.unwrap_or(f64::NAN)),
    ("v_prime", |state| state.v_prime.unwrap_or(f64::NAN)),
    ("uv_shift", |state| state.uv_shift.unwrap_or(f64::NAN)),
    ("L_star", |state| state.lab.map_or(f64::NAN, |lab| lab.l)),
    ("a_star", |state| state.lab.map_or(f64::NAN, |lab| lab.a)),
    ("b_star", |state| state.lab.map_or(f64::NAN, |lab| lab.b)),
    ("delta_E_2000_with_angle", |state| state.delta_e_2000.unwrap_or(f64::NAN)),
    ("delta_E_1976_with_angle", |state| state.delta_e_1976.unwrap_or(f64::NAN)),
];

/// A conoscopic map.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Cone {
    of: ConeResult,
    /// Hash of the scenario.
    hash: String,
}

#[pymethods]
impl Cone {
    /// Computes the map over ascending directions, degrees; `None`: the default directions.
    #[new]
    #[pyo3(signature = (scenario, theta_deg=None, phi_deg=None, threads=None, progress=None, allow_error=None, reference_deg=None))]
    #[allow(clippy::too_many_arguments, reason = "the arguments of the Python function")]
    fn new(
        py: Python<'_>,
        scenario: &Resolved,
        theta_deg: Option<Vec<f64>>,
        phi_deg: Option<Vec<f64>>,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
        allow_error: Option<f64>,
        reference_deg: Option<[f64; 2]>,
    ) -> PyResult<Self> {
        let scene = &scenario.of.scene;
        let of = computed(py, &scenario.of, threads, progress, |control| {
            let within = ConeGrid::within(scene)?;
            let grid = ConeGrid {
                theta_deg: theta_deg.unwrap_or(within.theta_deg),
                phi_deg: phi_deg.unwrap_or(within.phi_deg),
                reference_deg: reference_deg.unwrap_or(within.reference_deg),
            };
            papilio_display::cone(scene, grid, control)?.allowing(allow_error)
        })?;
        Ok(Self { of, hash: scenario.of.hash.clone() })
    }

    fn theta_deg<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.of.theta_deg)
    }

    fn phi_deg<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.of.phi_deg)
    }

    fn states(&self) -> Vec<String> {
        self.of.states.clone()
    }

    fn warnings(&self) -> Vec<String> {
        self.of.warnings.clone()
    }

    /// Names and arrays: quantities of all states together (shape [phi, theta]) and of each state (shape [phi, theta, state]).
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let (together, alone) = (PyDict::new(py), PyDict::new(py));
        let shape = [self.of.phi_deg.len(), self.of.theta_deg.len(), self.of.states.len()];
        for (name, of) in OF_ALL_STATES {
            together.set_item(name, array(py, &shape[..2], self.of.views.iter().map(of).collect())?)?;
        }
        for (name, of) in OF_EACH_STATE {
            let states = self.of.views.iter().flat_map(|view| &view.states);
            alone.set_item(name, array(py, &shape, states.map(of).collect())?)?;
        }
        Ok((together, alone))
    }

    /// Names and contents of the files of `papilio run --cone` except figures, in the order in which it writes them.
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Vec<(&'static str, Bound<'py, PyBytes>)>> {
        let about = ConeFile::new(env!("CARGO_PKG_VERSION"), &self.hash, &self.of);
        let mut files = [Vec::new(), Vec::new(), Vec::new()];
        let [csv, npy, json] = &mut files;
        write_cone_csv(csv, &self.of)
            .and_then(|()| write_cone_npy(npy, &self.of))
            .and_then(|()| write_json(json, &about))
            .map_err(|error| errors::internal(&error.to_string()))?;
        let names = ["cone.csv", "cone.npy", "cone.json"];
        Ok(names.into_iter().zip(&files).map(|(name, bytes)| (name, PyBytes::new(py, bytes))).collect())
    }

    /// Names and SVG texts of the figures of `papilio run --cone`; none if the directions do not span an area.
    fn figures(&self, py: Python<'_>, title: &str) -> Figures {
        py.detach(|| {
            let maps = papilio_figures::cone(&self.of, title).map(|svg| ("cone".to_owned(), svg));
            let differences = papilio_figures::cone_differences(&self.of, title);
            maps.into_iter().chain(differences.map(|svg| ("cone_differences".to_owned(), svg))).collect()
        })
    }
}
