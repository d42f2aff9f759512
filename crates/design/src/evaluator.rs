//! Evaluation of designs.
//!
//! Designs that differ only in parameters of their film pixel (thicknesses, gaps, areas, indices) are
//! evaluated by [`Designs`](papilio_display::Designs), which reuses everything else. All other designs are
//! resolved and run in full. The choice of method depends on the design alone, not on the designs before it.
//! Sharpness, crosstalk, sparkle and pictures are computed of the resolved display (`pixels.rs`).

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use papilio_display::result::RunResult;
use papilio_display::scene::MetricSource;
use papilio_display::{Control, DisplayError, Prepared, Quantity};

use crate::film_fast_path::FilmFastPath;
use crate::{DesignError, NamedQuantity, Study, pixels};

/// Step of finite differences, relative to the larger of the variable's magnitude and 1.
const STEP: f64 = 1e-4;

/// Evaluates designs one after the other. Each thread has its own.
#[derive(Debug)]
pub struct Evaluator<'a> {
    study: Arc<Study>,
    stop: &'a AtomicBool,
    conditions: Vec<ConditionState>,
    /// Number of designs evaluated so far, including those of all workers.
    evaluated: Arc<AtomicUsize>,
}

/// The quantities of a condition by what computes them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    /// Colours: a run, or the fast path of film pixels.
    Colours,
    /// Sharpness, crosstalk, sparkle and pictures.
    Pixels,
}

impl Part {
    const BOTH: [Self; 2] = [Self::Colours, Self::Pixels];
}

/// State of a condition that is reused for the next design.
#[derive(Debug)]
struct ConditionState {
    /// Indices of the quantities of colours that are requested under it.
    requested: Vec<usize>,
    /// Indices of those of sharpness, crosstalk, sparkle and pictures.
    of_pixels: Vec<usize>,
    /// Evaluates film pixels.
    fast_path: FilmFastPath,
    /// Evaluates all other designs.
    prepared: Option<Prepared>,
    /// Level of discretisation of all runs; `None`: each meets the scene's target at its own.
    level: Option<u32>,
}

/// Values and derivatives of the quantities of a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Slopes {
    /// Value of each quantity; `None` where it is undefined.
    pub values: Vec<Option<f64>>,
    /// Derivatives, `[quantity][variable]`: NaN where undefined, 0 for choices.
    pub slopes: Vec<f64>,
}

impl<'a> Evaluator<'a> {
    /// Creates the evaluator of a study. Setting `stop` ends an evaluation early, with
    /// [`Interrupted`](papilio_display::DisplayError::Interrupted).
    pub fn new(study: Arc<Study>, stop: &'a AtomicBool) -> Self {
        let condition = |condition: usize| {
            let requested =
                study.quantities.iter().enumerate().filter(|(_, named)| named.condition == condition);
            let (colours, of_pixels): (Vec<_>, Vec<_>) =
                requested.partition(|(_, named)| named.quantity.source() == MetricSource::Colours);
            let quantities = colours.iter().map(|(_, named)| named.quantity.clone()).collect();
            ConditionState {
                requested: colours.into_iter().map(|(index, _)| index).collect(),
                of_pixels: of_pixels.into_iter().map(|(index, _)| index).collect(),
                fast_path: FilmFastPath::new(quantities),
                prepared: None,
                level: None,
            }
        };
        let conditions = (0..study.conditions.len()).map(condition).collect();
        Self { study, stop, conditions, evaluated: Arc::default() }
    }

    /// Creates an evaluator of the same study for another thread. It shares the film pixels that are prepared
    /// so far.
    pub fn worker(&self) -> Self {
        let copy = |state: &ConditionState| ConditionState {
            requested: state.requested.clone(),
            of_pixels: state.of_pixels.clone(),
            fast_path: state.fast_path.clone(),
            prepared: None,
            level: state.level,
        };
        Self {
            study: self.study.clone(),
            stop: self.stop,
            conditions: self.conditions.iter().map(copy).collect(),
            evaluated: self.evaluated.clone(),
        }
    }

    /// Study that is evaluated.
    pub fn study(&self) -> &Study {
        &self.study
    }

    /// Running count of the designs evaluated by this evaluator and all its [`worker`](Self::worker)s.
    pub fn evaluated(&self) -> Arc<AtomicUsize> {
        self.evaluated.clone()
    }

    /// Quantities that [`evaluate`](Self::evaluate) computes, in order.
    pub fn quantities(&self) -> &[NamedQuantity] {
        &self.study.quantities
    }

    /// Computes the quantities of a design; `None` where one is undefined.
    ///
    /// # Errors
    /// If the design is invalid or cannot be computed, or the evaluation was interrupted.
    pub fn evaluate(&mut self, design: &[f64]) -> Result<Vec<Option<f64>>, DesignError> {
        Ok(first(self.evaluate_with_errors(design)?))
    }

    /// Computes value and error of each quantity of a design; `None` where one is undefined. Errors are those
    /// of sharpness, crosstalk and sparkle: what computes the values of colours without a run has no error of
    /// its own.
    ///
    /// # Errors
    /// Those of [`evaluate`](Self::evaluate).
    pub fn evaluate_with_errors(&mut self, design: &[f64]) -> Result<Vec<[Option<f64>; 2]>, DesignError> {
        self.study.check(design)?;
        self.evaluated.fetch_add(1, Ordering::Relaxed);
        self.computed_under_all(design, &Part::BOTH)
    }

    /// Computes sharpness, crosstalk, sparkle and pictures of a design, which no run computes: `None` for all
    /// other quantities.
    ///
    /// # Errors
    /// Those of [`evaluate`](Self::evaluate).
    pub(crate) fn of_pixels(&mut self, design: &[f64]) -> Result<Vec<Option<f64>>, DesignError> {
        Ok(first(self.computed_under_all(design, &[Part::Pixels])?))
    }

    /// Computes the quantities of some parts under every condition.
    fn computed_under_all(
        &mut self,
        design: &[f64],
        parts: &[Part],
    ) -> Result<Vec<[Option<f64>; 2]>, DesignError> {
        let mut values = vec![[None; 2]; self.study.quantities.len()];
        for condition in 0..self.conditions.len() {
            for part in parts {
                if self.requested(condition, *part).is_empty() {
                    continue;
                }
                let computed = self.computed(design, condition, *part)?;
                let requested = self.requested(condition, *part).iter();
                requested.zip(computed).for_each(|(index, value)| values[*index] = value);
            }
        }
        Ok(values)
    }

    fn requested(&self, condition: usize, part: Part) -> &[usize] {
        let condition = &self.conditions[condition];
        match part {
            Part::Colours => &condition.requested,
            Part::Pixels => &condition.of_pixels,
        }
    }

    /// Computes the requested quantities of one part.
    fn computed(
        &mut self,
        design: &[f64],
        condition: usize,
        part: Part,
    ) -> Result<Vec<[Option<f64>; 2]>, DesignError> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(DisplayError::Interrupted.into());
        }
        match part {
            Part::Colours => {
                Ok(self.under(design, condition)?.into_iter().map(|value| [value, None]).collect())
            }
            Part::Pixels => {
                let values = self.study.values(design)?;
                let scenario = self.study.conditions[condition].varied.scenario(&values)?;
                let requested = self.conditions[condition].of_pixels.iter();
                let quantities: Vec<&Quantity> =
                    requested.map(|index| &self.study.quantities[*index].quantity).collect();
                let with_picture = quantities.iter().any(|quantity| quantity.source() == MetricSource::Image);
                let resolved =
                    if with_picture { scenario.resolve_with_picture() } else { scenario.resolve() }?;
                let control = Control { threads: Some(1), progress: &|_| {}, stop: self.stop };
                pixels::quantities(&resolved, &quantities, &control)
            }
        }
    }

    /// Computes the quantities of colours that are requested under one condition.
    fn under(&mut self, design: &[f64], index: usize) -> Result<Vec<Option<f64>>, DesignError> {
        let control = Control { threads: Some(1), progress: &|_| {}, stop: self.stop };
        let (condition, state) = (&self.study.conditions[index], &mut self.conditions[index]);
        if let Some(values) = state.fast_path.evaluate(&self.study, condition, design, &control)? {
            return Ok(values);
        }
        let result = self.run(design, index)?;
        if result.solver.interrupted {
            return Err(DisplayError::Interrupted.into());
        }
        let requested = self.conditions[index].requested.iter();
        Ok(requested.map(|quantity| self.study.quantities[*quantity].quantity.of(&result)).collect())
    }

    /// Computes values and derivatives of the quantities of a design: exact derivatives for film pixels,
    /// finite differences otherwise.
    ///
    /// # Errors
    /// Those of [`evaluate`](Self::evaluate).
    pub fn derivatives(&mut self, design: &[f64]) -> Result<Slopes, DesignError> {
        self.study.check(design)?;
        self.evaluated.fetch_add(1, Ordering::Relaxed);
        let (quantities, variables) = (self.study.quantities.len(), design.len());
        let mut all = Slopes { values: vec![None; quantities], slopes: vec![0.0; quantities * variables] };
        for condition in 0..self.conditions.len() {
            for part in Part::BOTH {
                if self.requested(condition, part).is_empty() {
                    continue;
                }
                let computed = self.slopes_under(design, condition, part)?;
                for (row, &quantity) in self.requested(condition, part).iter().enumerate() {
                    all.values[quantity] = computed.values[row];
                    let slopes = &computed.slopes[row * variables..(row + 1) * variables];
                    all.slopes[quantity * variables..(quantity + 1) * variables].copy_from_slice(slopes);
                }
            }
        }
        Ok(all)
    }

    /// Computes values and derivatives of the quantities of one part that are requested under one condition.
    fn slopes_under(&mut self, design: &[f64], index: usize, part: Part) -> Result<Slopes, DesignError> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(DisplayError::Interrupted.into());
        }
        let control = Control { threads: Some(1), progress: &|_| {}, stop: self.stop };
        let (condition, state) = (&self.study.conditions[index], &mut self.conditions[index]);
        if part == Part::Colours
            && let Some(exact) = state.fast_path.derivatives(&self.study, condition, design, &control)?
        {
            return Ok(exact);
        }
        let values = first(self.computed(design, index, part)?);
        let variables = design.len();
        let mut slopes = vec![0.0; values.len() * variables];
        for variable in 0..variables {
            if self.study.variables[variable].is_number() {
                let column = self.slope(design, variable, (index, part), &values)?;
                column
                    .into_iter()
                    .enumerate()
                    .for_each(|(row, slope)| slopes[row * variables + variable] = slope);
            }
        }
        Ok(Slopes { values, slopes })
    }

    /// Computes derivatives by a variable with central differences, or one-sided ones if one of the two sides
    /// is invalid.
    fn slope(
        &mut self,
        design: &[f64],
        variable: usize,
        (condition, part): (usize, Part),
        here: &[Option<f64>],
    ) -> Result<Vec<f64>, DesignError> {
        let step = STEP * design[variable].abs().max(1.0);
        let mut evaluate = |step: f64| {
            let mut moved = design.to_vec();
            moved[variable] += step;
            match self.computed(&moved, condition, part) {
                Ok(values) => Ok(Some((first(values), moved[variable]))),
                // Outside the range of a key.
                Err(DesignError::Scenario(_)) => Ok(None),
                Err(error) => Err(error),
            }
        };
        let own = || (here.to_vec(), design[variable]);
        let (above, x_above) = evaluate(step)?.unwrap_or_else(own);
        let (below, x_below) = evaluate(-step)?.unwrap_or_else(own);
        let slope = |(above, below): (&Option<f64>, &Option<f64>)| match (above, below) {
            (Some(above), Some(below)) => (above - below) / (x_above - x_below),
            _ => f64::NAN,
        };
        Ok(above.iter().zip(&below).map(slope).collect())
    }

    /// Computes all further designs at the level of discretisation that this one needs, so that differences
    /// between designs are not differences between levels. Returns the result of this one under the first
    /// condition.
    ///
    /// # Errors
    /// Those of [`evaluate`](Self::evaluate); [`NotByAdding`](DisplayError::NotByAdding) for a display that is
    /// computed by Monte Carlo.
    pub fn hold_level(&mut self, design: &[f64]) -> Result<RunResult, DesignError> {
        let mut first = None;
        for condition in 0..self.conditions.len() {
            self.conditions[condition].level = None;
            let result = self.run(design, condition)?;
            if result.solver.method != "adding" {
                return Err(DisplayError::NotByAdding.into());
            }
            self.conditions[condition].level = result.solver.level;
            first.get_or_insert(result);
        }
        first.ok_or_else(|| DisplayError::Interrupted.into())
    }

    /// Computes the full result of a design under a condition, with its standard errors.
    ///
    /// # Errors
    /// Those of [`evaluate`](Self::evaluate).
    pub fn run(&mut self, design: &[f64], condition: usize) -> Result<RunResult, DesignError> {
        let values = self.study.values(design)?;
        let resolved = self.study.conditions[condition].varied.scenario(&values)?.resolve()?;
        let control = Control { threads: Some(1), progress: &|_| {}, stop: self.stop };
        let ConditionState { prepared, level, .. } = &mut self.conditions[condition];
        let prepared = prepared.get_or_insert_with(Prepared::empty);
        let result = match *level {
            Some(level) => prepared.run_at_level(&resolved.scene, level, &control),
            None => prepared.run(&resolved.scene, &control),
        };
        result.map_err(|error| resolved.located(&error).map_or_else(|| error.into(), DesignError::from))
    }
}

/// Values without their errors.
fn first(values: Vec<[Option<f64>; 2]>) -> Vec<Option<f64>> {
    values.into_iter().map(|[value, _]| value).collect()
}
