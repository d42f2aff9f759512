//! Least-squares problem of a fit: weighted residuals of points of the unit cube, and their derivatives.

use papilio_scenario::{FitTarget, FitVariable};

use super::model::{Meter, Model, Unit};
use crate::{DesignError, Evaluator};

/// Standard deviations of numbers whose measurement does not state them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CommonDeviations {
    /// Of reflectance factors, X, Y, Z.
    pub(super) fraction: f64,
    /// Of L\*, a\*, b\*.
    pub(super) lab: f64,
}

/// Fit of one thread.
pub(super) struct Problem<'a, 'stop> {
    pub(super) model: &'a Model,
    pub(super) variables: &'a [FitVariable],
    pub(super) evaluator: Evaluator<'stop>,
    pub(super) common: CommonDeviations,
}

impl Problem<'_, '_> {
    /// Values of the variables at a point of the unit cube.
    pub(super) fn values(&self, point: &[f64]) -> Vec<f64> {
        values(self.variables, point)
    }

    /// Standard deviation of a measured number.
    pub(super) fn deviation(&self, observation: usize) -> f64 {
        let one = &self.model.observations[observation];
        one.standard_deviation.unwrap_or(match one.unit() {
            Unit::Fraction | Unit::Metric => self.common.fraction,
            Unit::Lab => self.common.lab,
        })
    }

    /// Values of the quantities at a point; `None` if the display is not valid there.
    fn quantities(&mut self, point: &[f64]) -> Result<Option<Vec<Option<f64>>>, DesignError> {
        let design = display_values(self.variables, &self.values(point));
        match self.evaluator.evaluate(&design) {
            Ok(values) => Ok(Some(values)),
            // Outside the range of a key.
            Err(DesignError::Scenario(_)) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Predictions at a point; `None` if they are not defined there.
    pub(super) fn predictions(&mut self, point: &[f64]) -> Result<Option<Vec<f64>>, DesignError> {
        let meter = meter(self.variables, &self.values(point));
        let quantities = self.quantities(point)?;
        Ok(quantities.and_then(|values| self.model.predict(&values, meter)))
    }

    /// Weighted residuals at a point; `None` if they are not defined there.
    pub(super) fn residuals(&mut self, point: &[f64]) -> Result<Option<Vec<f64>>, DesignError> {
        let predicted = self.predictions(point)?;
        Ok(predicted.map(|predicted| self.weighted(&predicted, point)))
    }

    fn weighted(&self, predicted: &[f64], point: &[f64]) -> Vec<f64> {
        let values = self.values(point);
        let of_data = self.model.observations.iter().zip(predicted).enumerate();
        let of_data =
            of_data.map(|(index, (one, predicted))| (predicted - one.value) / self.deviation(index));
        let of_priors = self.variables.iter().zip(values);
        let of_priors =
            of_priors.filter_map(|(one, value)| one.prior.map(|[mean, sigma]| (value - mean) / sigma));
        of_data.chain(of_priors).collect()
    }

    /// Derivatives of the residuals with respect to the coordinates of the point, column by column: central
    /// differences over a step, or one-sided ones at a bound; `None` if they are not defined.
    pub(super) fn jacobian(
        &mut self,
        point: &[f64],
        step: f64,
    ) -> Result<Option<Vec<Vec<f64>>>, DesignError> {
        let mut columns = Vec::with_capacity(point.len());
        let is_of_meter = |one: &FitVariable| !matches!(one.target, FitTarget::Keys(_));
        let own = match self.variables.iter().any(is_of_meter) {
            true => self.quantities(point)?,
            false => None,
        };
        for variable in 0..point.len() {
            let moved = |by: f64| {
                let mut moved = point.to_vec();
                moved[variable] = (moved[variable] + by).clamp(0.0, 1.0);
                moved
            };
            let ends = [moved(-step), moved(step)];
            let at = |problem: &mut Self, end: &[f64]| match is_of_meter(&self.variables[variable]) {
                true => {
                    let meter = meter(problem.variables, &problem.values(end));
                    let predicted = own.as_ref().and_then(|values| problem.model.predict(values, meter));
                    Ok(predicted.map(|predicted| problem.weighted(&predicted, end)))
                }
                false => problem.residuals(end),
            };
            let [below, above] = [at(self, &ends[0])?, at(self, &ends[1])?];
            let width = ends[1][variable] - ends[0][variable];
            let Some((below, above)) = below.zip(above) else { return Ok(None) };
            columns.push(below.iter().zip(&above).map(|(below, above)| (above - below) / width).collect());
        }
        Ok(Some(columns))
    }
}

/// Values of the variables at a point of the unit cube.
pub(super) fn values(variables: &[FitVariable], point: &[f64]) -> Vec<f64> {
    let value = |(one, u): (&FitVariable, &f64)| {
        let [from, to] = one.bounds;
        (from + u * (to - from)).clamp(from, to)
    };
    variables.iter().zip(point).map(value).collect()
}

/// Values of the variables of the display.
pub(super) fn display_values(variables: &[FitVariable], values: &[f64]) -> Vec<f64> {
    let of_display = variables.iter().zip(values).filter(|(one, _)| matches!(one.target, FitTarget::Keys(_)));
    of_display.map(|(_, value)| *value).collect()
}

/// Errors of the meter.
pub(super) fn meter(variables: &[FitVariable], values: &[f64]) -> Meter {
    variables.iter().zip(values).fold(Meter::default(), |meter, (one, value)| match one.target {
        FitTarget::Keys(_) => meter,
        FitTarget::WavelengthOffset => Meter { wavelength_offset_nm: *value, ..meter },
        FitTarget::Scale => Meter { scale: *value, ..meter },
    })
}
