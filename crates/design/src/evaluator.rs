//! What a design is worth.
//!
//! Designs that differ in numbers of their film pixel alone (thicknesses, gaps, areas, indices) go through
//! [`Designs`](papilio_display::Designs), which keeps everything else; all others are resolved and run in full. Which road is taken
//! depends on the design alone, not on those before it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use papilio_display::result::RunResult;
use papilio_display::{Control, DisplayError, Prepared};

use crate::road::Road;
use crate::{DesignError, Named, Study};

/// Steps of differences, as a part of a variable's value or of 1.
const STEP: f64 = 1e-4;

/// Evaluates designs one after the other; one for each thread.
#[derive(Debug)]
pub struct Evaluator<'a> {
    study: Arc<Study>,
    stop: &'a AtomicBool,
    conditions: Vec<Kept>,
    /// Designs so far, those of all its workers together.
    evaluated: Arc<AtomicUsize>,
}

/// What a condition keeps for the next design.
#[derive(Debug)]
struct Kept {
    /// Which quantities are asked under it.
    asked: Vec<usize>,
    /// For film pixels.
    road: Road,
    /// For everything else.
    prepared: Option<Prepared>,
}

/// Values and slopes of the quantities of a design.
#[derive(Debug, Clone, PartialEq)]
pub struct Slopes {
    /// Of each quantity; `None` where it is not defined.
    pub values: Vec<Option<f64>>,
    /// `[quantity][variable]`: NaN where it is not defined, 0 of choices.
    pub slopes: Vec<f64>,
}

impl<'a> Evaluator<'a> {
    /// For a study; `stop` ends an evaluation early, with [`Interrupted`](papilio_display::DisplayError::Interrupted).
    pub fn new(study: Arc<Study>, stop: &'a AtomicBool) -> Self {
        let condition = |at: usize| {
            let asked = study.quantities.iter().enumerate().filter(|(_, one)| one.condition == at);
            let (asked, quantities) = asked.map(|(number, one)| (number, one.quantity.clone())).unzip();
            Kept { asked, road: Road::new(quantities), prepared: None }
        };
        let conditions = (0..study.conditions.len()).map(condition).collect();
        Self { study, stop, conditions, evaluated: Arc::default() }
    }

    /// Another one of the same study, for another thread; it shares what has been prepared so far.
    pub fn worker(&self) -> Self {
        let kept = |one: &Kept| Kept { asked: one.asked.clone(), road: one.road.clone(), prepared: None };
        Self {
            study: self.study.clone(),
            stop: self.stop,
            conditions: self.conditions.iter().map(kept).collect(),
            evaluated: self.evaluated.clone(),
        }
    }

    /// What is varied and asked.
    pub fn study(&self) -> &Study {
        &self.study
    }

    /// How many designs were evaluated, by this one and all [`worker`](Self::worker)s, as the work goes on.
    pub fn evaluated(&self) -> Arc<AtomicUsize> {
        self.evaluated.clone()
    }

    /// What [`evaluate`](Self::evaluate) gives, in order.
    pub fn quantities(&self) -> &[Named] {
        &self.study.quantities
    }

    /// The quantities of a design; `None` where one is not defined.
    ///
    /// # Errors
    /// If the design cannot be, or was stopped.
    pub fn evaluate(&mut self, design: &[f64]) -> Result<Vec<Option<f64>>, DesignError> {
        self.study.check(design)?;
        self.evaluated.fetch_add(1, Ordering::Relaxed);
        let mut values = vec![None; self.study.quantities.len()];
        for at in 0..self.conditions.len() {
            if self.conditions[at].asked.is_empty() {
                continue;
            }
            let found = self.under(design, at)?;
            self.conditions[at].asked.iter().zip(found).for_each(|(number, value)| values[*number] = value);
        }
        Ok(values)
    }

    /// What is asked under one condition.
    fn under(&mut self, design: &[f64], at: usize) -> Result<Vec<Option<f64>>, DesignError> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(DisplayError::Interrupted.into());
        }
        let control = Control { threads: Some(1), progress: &|_| {}, stop: self.stop };
        let condition = &self.study.conditions[at];
        if let Some(values) = self.conditions[at].road.evaluate(&self.study, condition, design, &control)? {
            return Ok(values);
        }
        let result = self.run(design, at)?;
        if result.solver.interrupted {
            return Err(DisplayError::Interrupted.into());
        }
        let asked = self.conditions[at].asked.iter();
        Ok(asked.map(|number| self.study.quantities[*number].quantity.of(&result)).collect())
    }

    /// Values and slopes of the quantities of a design: exact on the road of film pixels, by differences elsewhere.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn derivatives(&mut self, design: &[f64]) -> Result<Slopes, DesignError> {
        self.study.check(design)?;
        self.evaluated.fetch_add(1, Ordering::Relaxed);
        let (quantities, variables) = (self.study.quantities.len(), design.len());
        let mut all = Slopes { values: vec![None; quantities], slopes: vec![0.0; quantities * variables] };
        for at in 0..self.conditions.len() {
            if self.conditions[at].asked.is_empty() {
                continue;
            }
            let found = self.slopes_under(design, at)?;
            for (row, &number) in self.conditions[at].asked.iter().enumerate() {
                all.values[number] = found.values[row];
                let slopes = &found.slopes[row * variables..(row + 1) * variables];
                all.slopes[number * variables..(number + 1) * variables].copy_from_slice(slopes);
            }
        }
        Ok(all)
    }

    /// Values and slopes of what is asked under one condition.
    fn slopes_under(&mut self, design: &[f64], at: usize) -> Result<Slopes, DesignError> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(DisplayError::Interrupted.into());
        }
        let control = Control { threads: Some(1), progress: &|_| {}, stop: self.stop };
        let condition = &self.study.conditions[at];
        if let Some(exact) = self.conditions[at].road.derivatives(&self.study, condition, design, &control)? {
            return Ok(exact);
        }
        let values = self.under(design, at)?;
        let variables = design.len();
        let mut slopes = vec![0.0; values.len() * variables];
        for variable in 0..variables {
            if self.study.variables[variable].is_number() {
                let column = self.slope(design, variable, at, &values)?;
                column
                    .into_iter()
                    .enumerate()
                    .for_each(|(row, slope)| slopes[row * variables + variable] = slope);
            }
        }
        Ok(Slopes { values, slopes })
    }

    /// Slopes along a variable: central, or from the one side that can be.
    fn slope(
        &mut self,
        design: &[f64],
        variable: usize,
        at: usize,
        here: &[Option<f64>],
    ) -> Result<Vec<f64>, DesignError> {
        let step = STEP * design[variable].abs().max(1.0);
        let mut beside = |step: f64| {
            let mut moved = design.to_vec();
            moved[variable] += step;
            match self.under(&moved, at) {
                Ok(values) => Ok(Some((values, moved[variable]))),
                // Beyond what a scenario may say: the other side will do.
                Err(DesignError::Scenario(_)) => Ok(None),
                Err(error) => Err(error),
            }
        };
        let own = || (here.to_vec(), design[variable]);
        let (above, x_above) = beside(step)?.unwrap_or_else(own);
        let (below, x_below) = beside(-step)?.unwrap_or_else(own);
        let slope = |(above, below): (&Option<f64>, &Option<f64>)| match (above, below) {
            (Some(above), Some(below)) => (above - below) / (x_above - x_below),
            _ => f64::NAN,
        };
        Ok(above.iter().zip(&below).map(slope).collect())
    }

    /// All that is known of a design under a condition, with its errors.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn run(&mut self, design: &[f64], condition: usize) -> Result<RunResult, DesignError> {
        let values = self.study.values(design)?;
        let scene = self.study.conditions[condition].varied.scenario(&values)?.resolve()?.scene;
        let control = Control { threads: Some(1), progress: &|_| {}, stop: self.stop };
        let kept = match self.conditions[condition].prepared.take() {
            Some(prepared) => prepared,
            None => Prepared::new(&scene)?,
        };
        Ok(self.conditions[condition].prepared.insert(kept).run(&scene, &control)?)
    }
}
