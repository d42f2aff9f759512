//! Fits of measured values to lobes with a formula.
//!
//! **Objective** (Feng 2012, eq. 4-17 and 4-18; after Ngan, Durand & Matusik, EGSR 2005): the sum over
//! all cells of `w g^2` with the residual `g = (d - f) cos(theta_i)`, theta_i the inclination of the
//! light. [`Weights::Even`] has w = 1, as there, so that densely measured directions count most;
//! [`Weights::SolidAngle`] has the cells' solid angles.
//!
//! **Minimum** by a bounded trust-region method (Branch, Coleman & Li 1999: the reflective one, as in
//! MATLAB's lsqnonlin and SciPy's `least_squares`), with analytic derivatives, in logarithms of
//! totals, widths and exponents, from several starts about the width that the data show. The best end is
//! taken; [`Fit::agreeing`] tells how many starts ended there.
//!
//! **Intervals** are the linear ones at the minimum: covariance `s^2 (J^T W J)^-1` with the residual
//! variance `s^2`, and Student's quantiles. They are what they say if g is independent noise of equal
//! variance about the right formula. The misfit of a real lobe is neither: then they understate, and
//! the spread between formulas says more. They mean little where a parameter is
//! [at the end of its range](Parameter::at_bound).
//!
//! **Straight-through light** may be sought besides: unscattered light as the instrument blurs it, a
//! k-correlation lobe of a stated width. Its share is as good as that width: if all of it lies in the
//! cell at the specular direction, the share follows the excess of that one cell times the width
//! squared. Without a known width, half the grid's radial step is the least that makes sense.
//!
//! **Limits**: isotropic lobes. A fit of a blurred measurement is one of the blurred lobe.

mod data;
mod linear;
mod problem;
mod ranking;
mod search;

use papilio_optics::Beta;

use crate::GoniometryError;
use crate::models::{Kind, Model, Pair};
use problem::Problem;

pub use data::Data;
pub use ranking::{Ranked, fitted, ranked};

/// Cells that a fit needs beyond the number of its parameters.
pub(crate) const SPARE_CELLS: usize = 5;

/// What each squared residual counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Weights {
    /// All the same.
    #[default]
    Even,
    /// Its cell's solid angle, where the geometry has one.
    SolidAngle,
}

/// How to fit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FitOptions {
    /// What residuals count.
    pub weights: Weights,
    /// Width of the instrument's blur, direction cosines, above 0, if straight-through light is sought.
    pub straight_width: Option<f64>,
}

/// Unscattered light as an instrument of some blur sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Straight {
    /// Transmitted (or mirrored) share of the incident light.
    pub share: f64,
    /// Width of the blur: a k-correlation lobe of exponent 3, direction cosines.
    pub width: f64,
}

impl Straight {
    fn lobe(width: f64) -> Model {
        Model::KCorrelation { transmittance: 1.0, width, exponent: 3.0 }
    }
}

/// A number that was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// As in [`Model`]; `straight_through` for that share.
    pub name: &'static str,
    /// What it is counted in.
    pub unit: &'static str,
    /// The best value.
    pub value: f64,
    /// Its 95 % confidence interval; infinite if the data do not tell.
    pub interval: [f64; 2],
    /// True if it lies at the end of its range.
    pub at_bound: bool,
}

/// The best lobe of a kind for some data.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The lobe.
    pub model: Model,
    /// Unscattered light besides, if it was sought.
    pub straight: Option<Straight>,
    /// What was found, in the order of [`Kind::parameters`], then the straight-through share.
    pub parameters: Vec<Parameter>,
    /// Covariance of the parameters, row by row.
    pub covariance: Vec<f64>,
    /// Root mean square residual g, 1/sr (weighted).
    pub rms: f64,
    /// The same over the root mean square of the data times the cosine.
    pub relative_rms: f64,
    /// Total over the cells, of the fit over that of the data, less 1.
    pub total_error: f64,
    /// Cells that the fit is about.
    pub cells: usize,
    /// Starts that were tried.
    pub starts: usize,
    /// Starts that ended at the best minimum.
    pub agreeing: usize,
    /// Iterations from the best start.
    pub iterations: usize,
    /// True if the search stood still where it ended: at a minimum.
    pub converged: bool,
}

impl Fit {
    /// The best lobe of this kind.
    pub fn new(data: &Data, kind: Kind, options: &FitOptions) -> Result<Self, GoniometryError> {
        let problem = Problem::new(data, kind, options)?;
        Ok(problem.fit(&problem.starts()))
    }

    /// The best lobe of each kind, the least residual first.
    pub fn all(data: &Data, options: &FitOptions) -> Result<Vec<Self>, GoniometryError> {
        let mut fits: Vec<Self> =
            Kind::ALL.into_iter().map(|kind| Self::new(data, kind, options)).collect::<Result<_, _>>()?;
        fits.sort_by(|a, b| a.rms.total_cmp(&b.rms));
        Ok(fits)
    }

    /// f, 1/sr, straight-through light included, from and to direction cosines of propagation in air: what
    /// stands beside the data in a figure.
    pub fn value(&self, from: Beta, to: Beta) -> f64 {
        Pair::new(from, to).map_or(0.0, |pair| self.at(&pair))
    }

    fn at(&self, pair: &Pair) -> f64 {
        let straight =
            self.straight.map_or(0.0, |s| s.share * Straight::lobe(s.width).value_and_slopes(pair)[0]);
        self.model.value_and_slopes(pair)[0] + straight
    }
}

#[cfg(test)]
mod tests;
