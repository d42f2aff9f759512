//! The fast road: designs that differ in their film pixel alone go through kernels that are kept.

use std::sync::Arc;

use papilio_display::scene::{FilmPixel, Pixel, Scene};
use papilio_display::{Control, Designs, Parameter, Quantity};

use crate::parameter::{is_whole, parameter, set};
use crate::study::{Study, Values, Variable};
use crate::{Condition, DesignError, Slopes};

/// Displays that are kept, of different layers, lights or views: choices may change them.
const MOST_DISPLAYS: usize = 8;
/// Pixels that are kept, of different choices.
const MOST_PIXELS: usize = 256;

/// The film pixels of one condition. A clone shares all that is large.
#[derive(Debug, Clone)]
pub(crate) struct Road {
    /// What is asked under this condition.
    quantities: Vec<Quantity>,
    pixels: Vec<Arc<Base>>,
    displays: Vec<(Arc<Scene>, Designs)>,
}

/// What a combination of choices makes.
#[derive(Debug)]
struct Base {
    /// Of each variable that is a choice.
    choices: Vec<usize>,
    scene: Arc<Scene>,
    film: FilmPixel,
    /// The variables that are numbers: each key of each.
    numbers: Vec<Number>,
}

/// A key of a variable.
#[derive(Debug)]
struct Number {
    variable: usize,
    slope: f64,
    offset: f64,
    parameter: Parameter,
}

impl Road {
    pub(crate) fn new(quantities: Vec<Quantity>) -> Self {
        Self { quantities, pixels: Vec::new(), displays: Vec::new() }
    }

    /// The quantities of a design; `None` if it is not on this road.
    ///
    /// # Errors
    /// If its choices cannot be, or it cannot be computed.
    pub(crate) fn evaluate(
        &mut self,
        study: &Study,
        condition: &Condition,
        design: &[f64],
        control: &Control<'_>,
    ) -> Result<Option<Vec<Option<f64>>>, DesignError> {
        let Some(base) = self.base(study, condition, design)? else { return Ok(None) };
        let Some(film) = base.film(design) else { return Ok(None) };
        Ok(Some(self.display(&base, control)?.evaluate(&film)?))
    }

    /// Values and exact slopes of a design; `None` if it is not on this road.
    ///
    /// # Errors
    /// As of [`evaluate`](Self::evaluate).
    pub(crate) fn derivatives(
        &mut self,
        study: &Study,
        condition: &Condition,
        design: &[f64],
        control: &Control<'_>,
    ) -> Result<Option<Slopes>, DesignError> {
        let Some(base) = self.base(study, condition, design)? else { return Ok(None) };
        let Some(film) = base.film(design) else { return Ok(None) };
        let parameters: Vec<Parameter> = base.numbers.iter().map(|number| number.parameter).collect();
        let (display, variables) = (self.display(&base, control)?, design.len());
        if parameters.is_empty() {
            let values = display.evaluate(&film)?;
            return Ok(Some(Slopes { slopes: vec![0.0; values.len() * variables], values }));
        }
        let found = display.derivatives(&film, &parameters)?;
        let mut slopes = vec![0.0; found.values.len() * variables];
        for (quantity, row) in slopes.chunks_mut(variables).enumerate() {
            for (at, number) in base.numbers.iter().enumerate() {
                row[number.variable] += number.slope * found.gradients[quantity * parameters.len() + at];
            }
        }
        Ok(Some(Slopes { values: found.values, slopes }))
    }

    fn base(
        &mut self,
        study: &Study,
        condition: &Condition,
        design: &[f64],
    ) -> Result<Option<Arc<Base>>, DesignError> {
        let of_film = |variable: &&Variable| {
            variable.keys.iter().all(|key| key.path.trim().starts_with("display.pixel."))
        };
        if !study.variables.iter().filter(|variable| variable.is_number()).all(|one| of_film(&one)) {
            return Ok(None);
        }
        let of_choices = study.variables.iter().zip(design);
        let choices: Vec<usize> = of_choices
            .filter(|(variable, _)| matches!(variable.values, Values::Choices(_)))
            .map(|(_, x)| *x as usize)
            .collect();
        if let Some(known) = self.pixels.iter().find(|base| base.choices == choices) {
            return Ok(Some(known.clone()));
        }
        // Numbers as they stand, whatever design comes first: the level that serves must not depend on it.
        let mut values = study.values(design)?;
        let keys = study.variables.iter().flat_map(|variable| variable.keys.iter().map(move |_| variable));
        let numbers_of = values.iter_mut().zip(keys).filter(|(_, variable)| variable.is_number());
        numbers_of.for_each(|(value, _)| *value = serde_json::Value::Null);
        let scene = condition.varied.scenario(&values)?.resolve()?.scene;
        let Pixel::Film(film) = scene.display.pixel.clone() else { return Ok(None) };
        let Some(numbers) = numbers(study, &film) else { return Ok(None) };
        let base = Arc::new(Base { choices, scene: Arc::new(scene), film, numbers });
        if self.pixels.len() == MOST_PIXELS {
            self.pixels.remove(0);
        }
        self.pixels.push(base.clone());
        Ok(Some(base))
    }

    /// The display of a pixel, the last used last.
    fn display(&mut self, base: &Base, control: &Control<'_>) -> Result<&mut Designs, DesignError> {
        let at = match self.displays.iter().position(|(scene, _)| alike(scene, base)) {
            Some(at) => at,
            None => {
                if self.displays.len() == MOST_DISPLAYS {
                    self.displays.remove(0);
                }
                let designs = Designs::new(&base.scene, &self.quantities, control)?;
                self.displays.push((base.scene.clone(), designs));
                self.displays.len() - 1
            }
        };
        Ok(&mut self.displays[at].1)
    }
}

/// The keys of all variables that are numbers, if all are numbers of the film.
fn numbers(study: &Study, film: &FilmPixel) -> Option<Vec<Number>> {
    let mut numbers = Vec::new();
    for (variable, one) in study.variables.iter().enumerate().filter(|(_, one)| one.values == Values::Number)
    {
        for key in &one.keys {
            let parameter = parameter(&key.path, film)?;
            numbers.push(Number { variable, slope: key.slope, offset: key.offset, parameter });
        }
    }
    Some(numbers)
}

impl Base {
    /// The pixel of a design; `None` if a scenario could not say it.
    fn film(&self, design: &[f64]) -> Option<FilmPixel> {
        let mut film = self.film.clone();
        for Number { variable, slope, offset, parameter } in &self.numbers {
            if !set(&mut film, *parameter, slope * design[*variable] + offset) {
                return None;
            }
        }
        is_whole(&film).then_some(film)
    }
}

/// True if nothing but the pixel differs, and its states are the same.
fn alike(scene: &Scene, base: &Base) -> bool {
    let other = &base.scene;
    let Pixel::Film(film) = &scene.display.pixel else { return false };
    let names = |film: &FilmPixel| film.states.iter().map(|state| state.name.clone()).collect::<Vec<_>>();
    std::ptr::eq(scene, Arc::as_ptr(other))
        || scene.display.layers == other.display.layers
            && scene.grid == other.grid
            && scene.lighting == other.lighting
            && scene.viewer == other.viewer
            && scene.metrics == other.metrics
            && scene.solver == other.solver
            && names(film) == names(&base.film)
}
