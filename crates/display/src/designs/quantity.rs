//! Quantities of a display: numbers that an optimisation or a tolerance analysis evaluates.

use papilio_colour::{Lab, UvPrime};
use papilio_spectra::Spectrum;

use crate::DisplayError;
use crate::gloss::GlossResult;
use crate::image::ImageMetrics;
use crate::result::{RunResult, StateValues, View};
use crate::scene::{Metric, MetricSource};
use crate::spatial::{CrosstalkResult, MtfResult, SparkleRow};

/// Quantity of a display, a single number.
#[derive(Debug, Clone, PartialEq)]
pub enum Quantity {
    /// Metric of a state or of a view.
    Metric {
        /// Number of the view, from 0.
        view: usize,
        /// The state; `None` for metrics of a view.
        state: Option<String>,
        /// The metric.
        metric: Metric,
    },
    /// Reflectance factor of a state at one wavelength.
    ReflectanceFactor {
        /// Number of the view, from 0.
        view: usize,
        /// The state.
        state: String,
        /// Number of the wavelength in the grid, from 0.
        bin: usize,
    },
    /// Root mean square difference between a state's reflectance factor and a target spectrum, over the grid.
    SpectrumDistance {
        /// Number of the view, from 0.
        view: usize,
        /// The state.
        state: String,
        /// Target reflectance factor.
        wanted: Spectrum,
    },
    /// CIEDE2000 difference between a state and a target colour.
    ColourDistance {
        /// Number of the view, from 0.
        view: usize,
        /// The state.
        state: String,
        /// Target colour.
        wanted: Lab,
    },
    /// u'v' distance between a state and a target chromaticity.
    ChromaticityDistance {
        /// Number of the view, from 0.
        view: usize,
        /// The state.
        state: String,
        /// Target chromaticity.
        wanted: UvPrime,
    },
}

impl Quantity {
    /// Returns the value of the quantity in a result; `None` if it is not defined there.
    pub fn of(&self, result: &RunResult) -> Option<f64> {
        let view: &View = result.views.get(self.view())?;
        match self.state() {
            Some(name) => self.of_state(&view.states.get(name)?.value),
            None => self.metric()?.of_view(&view.metrics),
        }
    }

    /// Returns the standard error of a metric in a result; `None` if it is not known, and for distances.
    pub fn standard_error(&self, result: &RunResult) -> Option<f64> {
        let (view, metric) = (result.views.get(self.view())?, self.metric()?);
        match self.state() {
            Some(name) => metric.of_state(&view.states.get(name)?.standard_error),
            None => metric.of_view(&view.standard_error),
        }
    }

    /// Returns what computes the quantity.
    pub fn source(&self) -> MetricSource {
        self.metric().map_or(MetricSource::Colours, Metric::source)
    }

    /// Returns value and error of a metric of sharpness; `None` for other quantities, and where it is not
    /// defined.
    pub fn of_sharpness(&self, result: &MtfResult) -> [Option<f64>; 2] {
        let found = result.views.get(self.view()).zip(self.metric());
        let both = found.and_then(|(view, metric)| match self.state() {
            Some(name) => {
                let state = view.states.get(name)?;
                Some([&state.scalars, &state.error].map(|scalars| metric.of_spatial(scalars)))
            }
            None => Some([view.metrics(), view.errors()].map(|metrics| metric.of_sharpness(&metrics))),
        });
        both.unwrap_or_default()
    }

    /// Returns value and error of a metric of crosstalk; `None` for other quantities, and where it is not
    /// defined.
    pub fn of_crosstalk(&self, result: &CrosstalkResult) -> [Option<f64>; 2] {
        let found = result.views.get(self.view()).zip(self.metric());
        let both = found.map(|(view, metric)| {
            [view.metrics(), view.errors()].map(|metrics| metric.of_crosstalk(&metrics))
        });
        both.unwrap_or_default()
    }

    /// Returns value and standard error of a metric of sparkle in the first of the rows of each view; `None`
    /// for other quantities.
    pub fn of_sparkle(&self, rows: &[SparkleRow], views: usize) -> [Option<f64>; 2] {
        let row = rows.get(self.view() * (rows.len() / views.max(1))).zip(self.metric());
        let both =
            row.map(|(row, metric)| [row.metrics(), row.errors()].map(|metrics| metric.of_sparkle(&metrics)));
        both.unwrap_or_default()
    }

    /// Returns the value of a metric of a picture, whose error is not estimated; `None` for other quantities,
    /// and where it is not defined.
    pub fn of_image(&self, metrics: &ImageMetrics) -> [Option<f64>; 2] {
        [self.metric().and_then(|metric| metric.of_image(metrics)), None]
    }

    /// Returns value and error of a metric of gloss; `None` for other quantities, and where it is not defined.
    pub fn of_gloss(&self, result: &GlossResult) -> [Option<f64>; 2] {
        let state = self.state().and_then(|name| result.states.get(name)).zip(self.metric());
        let both =
            state.map(|(state, metric)| [state.values, state.error].map(|values| metric.of_gloss(&values)));
        both.unwrap_or_default()
    }

    /// Returns the number of the view, from 0.
    pub fn view(&self) -> usize {
        match self {
            Self::Metric { view, .. }
            | Self::ReflectanceFactor { view, .. }
            | Self::SpectrumDistance { view, .. }
            | Self::ColourDistance { view, .. }
            | Self::ChromaticityDistance { view, .. } => *view,
        }
    }

    /// Returns the state; `None` for metrics of a view.
    pub fn state(&self) -> Option<&str> {
        match self {
            Self::Metric { state, .. } => state.as_deref(),
            Self::ReflectanceFactor { state, .. }
            | Self::SpectrumDistance { state, .. }
            | Self::ColourDistance { state, .. }
            | Self::ChromaticityDistance { state, .. } => Some(state),
        }
    }

    pub(super) fn metric(&self) -> Option<Metric> {
        match self {
            Self::Metric { metric, .. } => Some(*metric),
            _ => None,
        }
    }

    /// Returns true if the quantity follows from X, Y, Z and the luminance of the states, under all lights
    /// together.
    pub(super) fn is_of_colours(&self) -> bool {
        match self {
            Self::Metric { metric, .. } => {
                let needs_spectra = matches!(
                    metric,
                    Metric::R_hemi | Metric::peak_nm | Metric::peak_shift_nm | Metric::average_peak_shift_nm
                );
                metric.source() == MetricSource::Colours && !needs_spectra
            }
            Self::ColourDistance { .. } | Self::ChromaticityDistance { .. } => true,
            Self::ReflectanceFactor { .. } | Self::SpectrumDistance { .. } => false,
        }
    }

    /// Name of the metric, or of the kind of distance.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Metric { metric, .. } => metric.name(),
            Self::ReflectanceFactor { .. } => "reflectance factor",
            Self::SpectrumDistance { .. } => "distance from a spectrum",
            Self::ColourDistance { .. } => "distance from a colour",
            Self::ChromaticityDistance { .. } => "distance from a chromaticity",
        }
    }

    /// Returns the value for a state; `None` for metrics of a view.
    pub(super) fn of_state(&self, values: &StateValues) -> Option<f64> {
        match self {
            Self::Metric { metric, .. } => metric.of_state(values),
            Self::ReflectanceFactor { bin, .. } => values.reflectance_factor.as_ref()?.get(*bin).copied(),
            Self::SpectrumDistance { wanted, .. } => {
                let factor = values.reflectance_factor.as_ref()?;
                let squares =
                    factor.iter().zip(wanted.iter()).map(|(found, wanted)| (found - wanted).powi(2));
                Some((squares.sum::<f64>() / factor.len() as f64).sqrt())
            }
            Self::ColourDistance { wanted, .. } => {
                let lab = Lab { l: values.L_star?, a: values.a_star?, b: values.b_star? };
                Some(lab.delta_e_2000(*wanted))
            }
            Self::ChromaticityDistance { wanted, .. } => {
                Some(UvPrime { u: values.u_prime?, v: values.v_prime? }.distance(*wanted))
            }
        }
    }

    /// Checks that the view and the state of the quantity exist.
    pub(super) fn check(&self, views: usize, states: &[String]) -> Result<(), DisplayError> {
        let missing = |what| Err(DisplayError::NoSuchQuantity { what, quantity: self.name() });
        if self.view() >= views {
            return missing(format!("view {}", self.view()));
        }
        match self.state() {
            Some(name) if !states.iter().any(|state| state == name) => missing(format!("state `{name}`")),
            None if !self.metric().is_some_and(Metric::is_of_view) => missing("state given".to_owned()),
            _ => Ok(()),
        }
    }
}
