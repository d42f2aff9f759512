//! Fits of measured values to lobes with a formula.
//!
//! **Objective** (Feng 2012, eq. 4-17 and 4-18; Ngan, Durand & Matusik, EGSR 2005): the sum over all cells of `w g^2` with the residual
//! `g = (d - f) cos(theta_i)`, theta_i the inclination of the light. [`Weights::Even`] has w = 1, as there, so that
//! the densest cells count most; [`Weights::SolidAngle`] has the cells' solid angles.
//!
//! **Minimum** by a bounded trust-region method (Branch, Coleman & Li 1999: the reflective one, as in MATLAB's lsqnonlin
//! and SciPy's `least_squares`), with analytic derivatives, in logarithms of totals, widths and exponents, from
//! several starts about the width that the data show. The best end is taken, and [`Fit::agreeing`] tells how
//! many starts ended there.
//!
//! **Intervals** are the linear ones at the minimum: covariance `s^2 (J^T W J)^-1` with the residual variance `s^2` and Student's
//! quantiles. They are what they say if g is independent noise of equal variance about the right formula. Misfit of a real
//! lobe is neither: then they understate, and the spread between formulas says more. They mean
//! little where a parameter is [at the end of its range](Parameter::at_bound).
//!
//! **Straight-through light** may be sought besides: unscattered light as the instrument blurs it, a
//! k-correlation lobe of a stated width. Its share is as good as that width: if all of it lies in
//! the cell at the specular direction, the share follows the excess of that one cell times the width squared. Without a
//! known width, half the grid's radial step is the smallest that makes sense.

mod data;
mod linear;
mod ranking;
mod search;

use papilio_optics::Beta;

use crate::GoniometryError;
use crate::models::{Kind, Meaning, Model, Pair};
pub use data::Data;
pub use ranking::{Ranked, ranked};

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

/// The least-squares problem of one kind of lobe.
struct Problem<'a> {
    data: &'a Data,
    kind: Kind,
    straight_width: Option<f64>,
    meanings: Vec<Meaning>,
    /// Root of each cell's weight times its cosine, over `scale`.
    factors: Vec<f64>,
    /// Root of the weighted sum of squares of the data.
    scale: f64,
    /// Sum of the weights.
    weight: f64,
}

const STRAIGHT: Meaning =
    Meaning { name: "straight_through", unit: "1", range: [0.0, 10.0], logarithmic: false };

/// Widths of starts over the width that the data show.
const START_WIDTHS: [f64; 3] = [1.0, 0.4, 2.5];
/// Costs this close, relative, are the same minimum; and so are all below the square of the precision of numbers.
const SAME: f64 = 1e-6;
const EXACT: f64 = 1e-25;
/// Distance from an end of a range that counts as being there, relative.
const AT_BOUND: f64 = 1e-6;
/// Where a search stands still the residuals are this orthogonal to all derivatives (but at ends of ranges).
const ORTHOGONAL: f64 = 1e-6;

impl<'a> Problem<'a> {
    fn new(data: &'a Data, kind: Kind, options: &FitOptions) -> Result<Self, GoniometryError> {
        if let Some(width) = options.straight_width
            && !(width > 0.0 && width.is_finite())
        {
            let what = "the width of straight-through light";
            return Err(GoniometryError::OutOfRange { what, value: width, expected: "a number above 0" });
        }
        let mut meanings = kind.parameters().to_vec();
        meanings.extend(options.straight_width.map(|_| STRAIGHT));
        if data.len() < meanings.len() + SPARE_CELLS {
            return Err(GoniometryError::TooFewCells { cells: data.len(), parameters: meanings.len() });
        }
        let weight = |cell: &data::Cell| match options.weights {
            Weights::Even => 1.0,
            Weights::SolidAngle => cell.solid_angle,
        };
        let factors: Vec<f64> =
            data.cells.iter().map(|cell| weight(cell).sqrt() * cell.pair.cos_in).collect();
        let squares = data.cells.iter().zip(&factors).map(|(cell, factor)| (factor * cell.value).powi(2));
        let scale = squares.sum::<f64>().sqrt();
        Ok(Self {
            data,
            kind,
            straight_width: options.straight_width,
            meanings,
            factors: factors.into_iter().map(|factor| factor / scale).collect(),
            scale,
            weight: data.cells.iter().map(weight).sum(),
        })
    }

    /// Values of the parameters to start from.
    fn starts(&self) -> Vec<Vec<f64>> {
        let thirds: &[f64] = match self.kind {
            Kind::KCorrelation => &[3.0, 8.0],
            Kind::PseudoVoigt => &[0.5],
            Kind::Ward(_) | Kind::Ggx => &[],
        };
        let width = self.data.width();
        let mut starts = Vec::new();
        for factor in START_WIDTHS {
            // Half vectors turn half as far as what they mirror.
            let scale = if matches!(self.kind, Kind::Ward(_) | Kind::Ggx) { 0.5 } else { 1.0 };
            for third in thirds.iter().map(Some).chain(thirds.is_empty().then_some(None)) {
                let mut start = vec![1.0, width * factor * scale];
                start.extend(third);
                start[0] = self.data.amplitude(&self.kind.model(&start));
                start.extend(self.straight_width.map(|_| 0.01));
                starts.push(start);
            }
        }
        starts
    }

    /// The best of what the starts lead to.
    fn fit(&self, starts: &[Vec<f64>]) -> Fit {
        let mut ends: Vec<search::End> = starts.iter().map(|start| search::search(self, start)).collect();
        ends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let agreeing = ends.iter().filter(|end| end.cost <= ends[0].cost * (1.0 + SAME) + EXACT).count();
        self.described(&ends[0], starts.len(), agreeing)
    }

    fn described(&self, end: &search::End, starts: usize, agreeing: usize) -> Fit {
        let (cells, count) = (self.data.len(), self.meanings.len());
        let freedom = (cells - count) as f64;
        // Squares of the residuals were divided by those of the data.
        let variance = 2.0 * end.cost / freedom;
        let covariance = match linear::inverse(&self.normal_matrix(&end.values), count) {
            Some(inverse) => inverse.into_iter().map(|entry| entry * variance).collect(),
            None => vec![f64::INFINITY; count * count],
        };
        let student = linear::student_975(freedom);
        let parameter = |(k, meaning): (usize, &Meaning)| {
            let value = end.values[k];
            let half = student * covariance[k * count + k].sqrt();
            let [low, high] = meaning.range;
            let near = |bound: f64| {
                (value - bound).abs() <= AT_BOUND * if meaning.logarithmic { value } else { high - low }
            };
            Parameter {
                name: meaning.name,
                unit: meaning.unit,
                value,
                interval: [value - half, value + half],
                at_bound: near(low) || near(high),
            }
        };
        let parameters: Vec<Parameter> = self.meanings.iter().enumerate().map(parameter).collect();
        let free = self.slants(&end.values).into_iter().zip(&parameters).filter(|(_, p)| !p.at_bound);
        let still = free.map(|(slant, _)| slant).fold(0.0, f64::max) < ORTHOGONAL;
        let mut fit = Fit {
            model: self.kind.model(&end.values),
            straight: self.straight_width.map(|width| Straight { share: end.values[count - 1], width }),
            parameters,
            covariance,
            rms: (2.0 * end.cost / self.weight).sqrt() * self.scale,
            relative_rms: (2.0 * end.cost).sqrt(),
            total_error: 0.0,
            cells,
            starts,
            agreeing,
            iterations: end.iterations,
            converged: still || end.cost < EXACT,
        };
        fit.total_error = self.data.total_error(|pair| fit.at(pair));
        fit
    }

    /// `f - d` of each cell, times its factor.
    fn residuals(&self, values: &[f64]) -> Vec<f64> {
        let cells = self.data.cells.iter().zip(&self.factors);
        cells.map(|(cell, factor)| factor * (self.modelled(values, &cell.pair)[0] - cell.value)).collect()
    }

    /// Derivatives of the residuals by the parameters, row by row.
    fn slopes(&self, values: &[f64]) -> Vec<f64> {
        let count = self.meanings.len();
        let cells = self.data.cells.iter().zip(&self.factors);
        cells
            .flat_map(|(cell, factor)| {
                let slopes = self.modelled(values, &cell.pair);
                (0..count).map(move |k| factor * slopes[k + 1])
            })
            .collect()
    }

    /// f and its derivatives by all parameters.
    fn modelled(&self, values: &[f64], pair: &Pair) -> [f64; 5] {
        let [f, a, b, c] = self.kind.model(values).value_and_slopes(pair);
        let mut all = [f, a, b, c, 0.0];
        if let Some(width) = self.straight_width {
            let unit = Straight::lobe(width).value_and_slopes(pair)[0];
            let last = self.meanings.len();
            all[0] += values[last - 1] * unit;
            all[last] = unit;
        }
        all
    }

    /// Cosines between the residuals and their derivatives by each parameter.
    fn slants(&self, values: &[f64]) -> Vec<f64> {
        let (residuals, slopes) = (self.residuals(values), self.slopes(values));
        let count = self.meanings.len();
        let length = residuals.iter().map(|r| r * r).sum::<f64>().sqrt();
        let slant = |k: usize| {
            let column = slopes.iter().skip(k).step_by(count);
            let [product, square] = column.zip(&residuals).fold([0.0; 2], |[product, square], (slope, r)| {
                [product + slope * r, square + slope * slope]
            });
            if square > 0.0 { product.abs() / (square.sqrt() * length) } else { 0.0 }
        };
        (0..count).map(slant).collect()
    }

    fn normal_matrix(&self, values: &[f64]) -> Vec<f64> {
        let count = self.meanings.len();
        let mut normal = vec![0.0; count * count];
        for row in self.slopes(values).chunks_exact(count) {
            for i in 0..count {
                for k in 0..count {
                    normal[i * count + k] += row[i] * row[k];
                }
            }
        }
        normal
    }
}

#[cfg(test)]
mod tests;
