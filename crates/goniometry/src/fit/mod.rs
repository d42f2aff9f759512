//! Fits of analytic lobes to measured values.
//!
//! **Objective** (Feng 2012, eq. 4-17 and 4-18; after Ngan, Durand & Matusik, EGSR 2005): the sum over all
//! cells of `w g^2` with the residual `g = (d - f) cos(theta_i)`, theta_i the inclination of the light.
//! [`Weights::Even`] has w = 1, as in these papers, so that densely measured directions have most weight;
//! [`Weights::SolidAngle`] uses the solid angles of the cells.
//!
//! **Minimum** by a bounded trust-region method (Branch, Coleman & Li 1999: the reflective method, as in
//! MATLAB's lsqnonlin and SciPy's `least_squares`), with analytic derivatives. Totals, widths and exponents
//! are varied as logarithms. Searches start from several points about the width of the data. The best minimum
//! is returned; [`Fit::agreeing`] is the number of starts that reached it.
//!
//! **Intervals** are those of linear theory at the minimum, of logarithms as varied, for independent errors of any sizes: a covariance
//! from the residual of each reading (HC3, in `statistics.rs`), and Student's quantiles. They end at the range of the parameter, which
//! they span if the data do not determine it. They are correct if the formula is right. The misfit of a real lobe is no independent
//! error; then they are too small, and the differences between formulas are more informative. They mean little for a parameter
//! [at the end of its range](Parameter::at_bound).
//!
//! **Regular transmission** can be fitted in addition: unscattered light, blurred by the instrument to a
//! k-correlation lobe of given width. Its fraction is as uncertain as that width: if all of it lies in the
//! cell at the specular direction, the fraction is proportional to the excess of that cell times the width
//! squared. If the width is unknown, the smallest sensible value is half the radial step of the grid.
//!
//! **Limits**: isotropic lobes. A fit to a blurred measurement gives the blurred lobe.

mod data;
mod linear;
mod problem;
mod ranking;
mod search;
mod statistics;

use papilio_optics::Beta;

use crate::GoniometryError;
use crate::models::{Kind, Model, Pair};
use problem::Problem;

pub use data::Data;
pub use ranking::{RankedFit, fitted, ranked};

/// Number of cells that a fit needs in addition to the number of its parameters.
pub(crate) const SPARE_CELLS: usize = 5;

/// Weights of the squared residuals.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weights {
    /// Uniform weights.
    #[default]
    Even,
    /// Solid angle of the cell, if the geometry defines it.
    SolidAngle,
}

/// Options of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FitOptions {
    /// Weights of the residuals.
    pub weights: Weights,
    /// Width of the instrument's blur, direction cosines, above 0; if given, regular transmission is fitted
    /// too.
    pub straight_width: Option<f64>,
}

/// Unscattered light, blurred by an instrument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RegularLight {
    /// Fraction of the incident light that is regularly transmitted or reflected.
    pub share: f64,
    /// Width of the blur: a k-correlation lobe of exponent 3, direction cosines.
    pub width: f64,
}

impl RegularLight {
    fn lobe(width: f64) -> Model {
        Kind::KCorrelation.model(&[1.0, width, 3.0])
    }
}

/// Fitted parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name as in [`Kind::parameters`]; `straight_through` for the regular fraction.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// The best value.
    pub value: f64,
    /// 95 % confidence interval, within the range of the parameter; all of it if the data do not determine the parameter.
    pub interval: [f64; 2],
    /// True if the value is at the end of its range.
    pub at_bound: bool,
}

/// Best lobe of a kind for given data.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The lobe.
    pub model: Model,
    /// Regular transmission, if it was fitted.
    pub straight: Option<RegularLight>,
    /// Fitted parameters, in the order of [`Kind::parameters`], then the regular fraction.
    pub parameters: Vec<Parameter>,
    /// Covariance of the parameters, row by row; infinite if the data do not determine them.
    pub covariance: Vec<f64>,
    /// Root mean square residual g, 1/sr (weighted).
    pub rms: f64,
    /// `rms` divided by the root mean square of the data times the cosine.
    pub relative_rms: f64,
    /// Relative difference of the fit's total over the cells from that of the data.
    pub total_error: f64,
    /// Number of fitted cells.
    pub cells: usize,
    /// Number of starts.
    pub starts: usize,
    /// Number of starts that reached the best minimum.
    pub agreeing: usize,
    /// Number of iterations from the best start.
    pub iterations: usize,
    /// True if the search ended at a minimum.
    pub converged: bool,
}

impl Fit {
    /// Fits a lobe of this kind.
    pub fn new(data: &Data, kind: Kind, options: &FitOptions) -> Result<Self, GoniometryError> {
        let problem = Problem::new(data, kind, options)?;
        Ok(problem.fit(&problem.starts()))
    }

    /// Fits a lobe of each kind; the smallest residual comes first.
    pub fn all(data: &Data, options: &FitOptions) -> Result<Vec<Self>, GoniometryError> {
        let mut fits: Vec<Self> =
            Kind::ALL.into_iter().map(|kind| Self::new(data, kind, options)).collect::<Result<_, _>>()?;
        fits.sort_by(|a, b| a.rms.total_cmp(&b.rms));
        Ok(fits)
    }

    /// Returns f, 1/sr, including regular transmission, for direction cosines of propagation in air. This is
    /// the quantity to compare with the data in a figure.
    pub fn value(&self, from: Beta, to: Beta) -> f64 {
        Pair::new(from, to).map_or(0.0, |pair| self.at(&pair))
    }

    fn at(&self, pair: &Pair) -> f64 {
        let straight =
            self.straight.map_or(0.0, |s| s.share * RegularLight::lobe(s.width).value_and_slopes(pair)[0]);
        self.model.value_and_slopes(pair)[0] + straight
    }
}

#[cfg(test)]
mod tests;
