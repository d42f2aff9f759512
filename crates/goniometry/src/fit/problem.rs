//! Least-squares problem of one kind of lobe, and the statistics of its solution.

use super::data::{Cell, Data};
use super::{Fit, FitOptions, Parameter, RegularLight, SPARE_CELLS, Weights, search, statistics};
use crate::GoniometryError;
use crate::models::{Kind, Meaning, Pair};

/// Least-squares problem of one kind of lobe.
pub(super) struct Problem<'a> {
    pub(super) data: &'a Data,
    kind: Kind,
    straight_width: Option<f64>,
    pub(super) meanings: Vec<Meaning>,
    /// Square root of each cell's weight times its cosine, divided by `scale`.
    factors: Vec<f64>,
    /// Square root of the weighted sum of squares of the data.
    scale: f64,
    /// Sum of the weights.
    weight: f64,
}

const STRAIGHT: Meaning =
    Meaning { name: "straight_through", unit: "1", range: [0.0, 10.0], logarithmic: false };

/// Widths of starts, relative to the width of the data.
const START_WIDTHS: [f64; 3] = [1.0, 0.4, 2.5];
/// Costs that differ by less than this, relatively, belong to the same minimum; so do all costs of a residual below 1e-8,
/// which is the rounding of values in a file: the search ends at gradients of 1e-15, and at a smaller residual the
/// cosine of [`ORTHOGONAL`] is beyond the numerical precision.
const SAME: f64 = 1e-6;
const EXACT: f64 = 0.5e-16;
/// Relative distance from an end of a range that counts as being at the end.
const AT_BOUND: f64 = 1e-6;
/// At a minimum, the cosine between residuals and each derivative is below this, except at ends of ranges.
const ORTHOGONAL: f64 = 1e-6;

impl<'a> Problem<'a> {
    pub(super) fn new(data: &'a Data, kind: Kind, options: &FitOptions) -> Result<Self, GoniometryError> {
        if let Some(width) = options.straight_width
            && !(1e-4..=10.0).contains(&width)
        {
            let what = "the width of the blur of regular transmission";
            return Err(GoniometryError::OutOfRange { what, value: width, expected: "0.0001 to 10" });
        }
        let mut meanings = kind.parameters().to_vec();
        meanings.extend(options.straight_width.map(|_| STRAIGHT));
        if data.len() < meanings.len() + SPARE_CELLS {
            return Err(GoniometryError::TooFewCells { cells: data.len(), parameters: meanings.len() });
        }
        let weight = |cell: &Cell| match options.weights {
            Weights::Even => 1.0,
            Weights::SolidAngle => cell.solid_angle,
        };
        let factors: Vec<f64> =
            data.cells.iter().map(|cell| weight(cell).sqrt() * cell.pair.cos_in).collect();
        let squares = data.cells.iter().zip(&factors).map(|(cell, factor)| (factor * cell.value).powi(2));
        let scale = squares.sum::<f64>().sqrt();
        if !(scale > 0.0 && scale.is_finite()) {
            let what = "the root of the sum of squared values";
            return Err(GoniometryError::OutOfRange { what, value: scale, expected: "above 0 and finite" });
        }
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

    /// Start values of the parameters.
    pub(super) fn starts(&self) -> Vec<Vec<f64>> {
        let thirds: &[f64] = match self.kind {
            Kind::KCorrelation => &[3.0, 8.0],
            Kind::PseudoVoigt => &[0.5],
            Kind::Ward(_) | Kind::KCorrelation3 | Kind::Ggx => &[],
        };
        let width = self.data.width();
        let mut starts = Vec::new();
        for factor in START_WIDTHS {
            // Half vectors turn by half the angle of the reflected direction.
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

    /// Best result of all starts.
    pub(super) fn fit(&self, starts: &[Vec<f64>]) -> Fit {
        let mut ends: Vec<search::End> = starts.iter().map(|start| search::search(self, start)).collect();
        ends.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let agreeing = ends.iter().filter(|end| end.cost <= ends[0].cost * (1.0 + SAME) + EXACT).count();
        self.described(&ends[0], starts.len(), agreeing)
    }

    fn described(&self, end: &search::End, starts: usize, agreeing: usize) -> Fit {
        let (cells, count) = (self.data.len(), self.meanings.len());
        let columns = self.columns(&end.values);
        // Relative to the data, as the squares of the residuals.
        let (slopes, residuals) = (&columns[..count], &columns[count]);
        let (readings, independent) = self.data.readings();
        let spread = statistics::Spread::new(slopes, residuals, (&readings, independent));
        let parameters = self.parameters(&end.values, &spread);
        let lengths = |slope: &[f64]| (dot(slope, slope) * dot(residuals, residuals)).sqrt();
        let mut free = slopes.iter().zip(&parameters).filter(|(_, parameter)| !parameter.at_bound);
        let still = free.all(|(slope, _)| dot(slope, residuals).abs() <= ORTHOGONAL * lengths(slope));
        let mut fit = Fit {
            model: self.kind.model(&end.values),
            straight: self.straight_width.map(|width| RegularLight { share: end.values[count - 1], width }),
            parameters,
            covariance: spread.covariance,
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

    fn parameters(&self, values: &[f64], spread: &statistics::Spread) -> Vec<Parameter> {
        let parameter = |(k, meaning): (usize, &Meaning)| {
            let value = values[k];
            let [low, high] = meaning.range;
            let near = |bound: f64| {
                (value - bound).abs() <= AT_BOUND * if meaning.logarithmic { value } else { high - low }
            };
            Parameter {
                name: meaning.name,
                unit: meaning.unit,
                value,
                interval: spread.interval(k, value, meaning),
                at_bound: near(low) || near(high),
            }
        };
        self.meanings.iter().enumerate().map(parameter).collect()
    }

    /// `f - d` of each cell, times its factor.
    pub(super) fn residuals(&self, values: &[f64]) -> Vec<f64> {
        let cells = self.data.cells.iter().zip(&self.factors);
        cells.map(|(cell, factor)| factor * (self.modelled(values, &cell.pair)[0] - cell.value)).collect()
    }

    /// Derivatives of the residuals with respect to each parameter, then the residuals.
    pub(super) fn columns(&self, values: &[f64]) -> Vec<Vec<f64>> {
        let count = self.meanings.len();
        let mut columns = vec![Vec::with_capacity(self.data.len()); count + 1];
        for (cell, factor) in self.data.cells.iter().zip(&self.factors) {
            let modelled = self.modelled(values, &cell.pair);
            columns[count].push(factor * (modelled[0] - cell.value));
            for (column, slope) in columns.iter_mut().zip(&modelled[1..=count]) {
                column.push(factor * slope);
            }
        }
        columns
    }

    /// f and its derivatives with respect to all parameters.
    fn modelled(&self, values: &[f64], pair: &Pair) -> [f64; 5] {
        let [f, a, b, c] = self.kind.model(values).value_and_slopes(pair);
        let mut all = [f, a, b, c, 0.0];
        if let Some(width) = self.straight_width {
            let unit = RegularLight::lobe(width).value_and_slopes(pair)[0];
            let last = self.meanings.len();
            all[0] += values[last - 1] * unit;
            all[last] = unit;
        }
        all
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
