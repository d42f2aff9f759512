//! What a design is worth.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use papilio_display::result::RunResult;
use papilio_display::{Control, Prepared};

use crate::{DesignError, Named, Study};

/// Evaluates designs one after the other; one for each thread.
#[derive(Debug)]
pub struct Evaluator<'a> {
    study: Arc<Study>,
    stop: &'a AtomicBool,
    /// For each condition what serves the next design.
    prepared: Vec<Option<Prepared>>,
}

impl<'a> Evaluator<'a> {
    /// For a study; `stop` ends an evaluation early, with [`Interrupted`](papilio_display::DisplayError::Interrupted).
    pub fn new(study: Arc<Study>, stop: &'a AtomicBool) -> Self {
        let prepared = study.conditions.iter().map(|_| None).collect();
        Self { study, stop, prepared }
    }

    /// Another one of the same study, for another thread.
    pub fn worker(&self) -> Self {
        Self::new(self.study.clone(), self.stop)
    }

    /// What is varied and asked.
    pub fn study(&self) -> &Study {
        &self.study
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
        let asked: Vec<bool> = (0..self.prepared.len())
            .map(|at| self.quantities().iter().any(|one| one.condition == at))
            .collect();
        let results = (0..self.prepared.len()).map(|at| match asked[at] {
            true => self.run(design, at).map(Some),
            false => Ok(None),
        });
        let results: Vec<Option<RunResult>> = results.collect::<Result<_, _>>()?;
        let of = |named: &Named| named.quantity.of(results.get(named.condition)?.as_ref()?);
        Ok(self.quantities().iter().map(of).collect())
    }

    /// All that is known of a design under a condition, with its errors.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn run(&mut self, design: &[f64], condition: usize) -> Result<RunResult, DesignError> {
        let values = self.study.values(design)?;
        let scene = self.study.conditions[condition].varied.scenario(&values)?.resolve()?.scene;
        let control = Control { threads: Some(1), progress: &|_| {}, stop: self.stop };
        let kept = match self.prepared[condition].take() {
            Some(prepared) => prepared,
            None => Prepared::new(&scene)?,
        };
        Ok(self.prepared[condition].insert(kept).run(&scene, &control)?)
    }
}
