//! Fast evaluation of designs that differ only in their film pixel.
//!
//! The kernels of everything else are reused.

use std::sync::Arc;

use papilio_display::scene::{FilmPixel, Pixel, Scene};
use papilio_display::{Control, Designs, Parameter, Quantity};

use crate::parameter::{has_unit_area, is_of_material, parameter, set};
use crate::study::{Study, Values, Variable};
use crate::{Condition, DesignError, Slopes};

/// Largest number of stored displays. They differ in layers, lights or views, which choices may change.
const MOST_DISPLAYS: usize = 8;
/// Largest number of stored pixels. They differ in the choices of the design.
const MOST_PIXELS: usize = 256;

/// Film pixels of one condition. A clone shares the large data.
#[derive(Debug, Clone)]
pub(crate) struct FilmFastPath {
    /// Quantities that are requested under this condition.
    quantities: Vec<Quantity>,
    /// The scenario's own film, if it was read.
    own: Option<FilmPixel>,
    pixels: Vec<Arc<BasePixel>>,
    displays: Vec<(Arc<Scene>, Designs)>,
}

/// Pixel and scene of a combination of choices.
#[derive(Debug)]
struct BasePixel {
    /// Index of the choice, for each variable that is a choice.
    choices: Vec<usize>,
    /// The scene for which displays are prepared: with the scenario's own film if it has the same states, so
    /// that the level of adding and the angles of the film do not depend on which choices come first.
    scene: Arc<Scene>,
    film: FilmPixel,
    /// All keys of the variables that are numbers; `None` if one of them is of a material by a model or with factors, whose
    /// film the scenario computes.
    numbers: Option<Vec<NumericKey>>,
}

/// A key of a numeric variable, and the parameter of the pixel that it sets.
#[derive(Debug)]
struct NumericKey {
    variable: usize,
    slope: f64,
    offset: f64,
    parameter: Parameter,
}

impl FilmFastPath {
    pub(crate) fn new(quantities: Vec<Quantity>) -> Self {
        Self { quantities, own: None, pixels: Vec::new(), displays: Vec::new() }
    }

    /// Computes the quantities of a design; `None` if this method does not apply to it.
    ///
    /// # Errors
    /// If its choices are invalid, or it cannot be computed.
    pub(crate) fn evaluate(
        &mut self,
        study: &Study,
        condition: &Condition,
        design: &[f64],
        control: &Control<'_>,
    ) -> Result<Option<Vec<Option<f64>>>, DesignError> {
        let Some(base) = self.base(study, condition, design)? else { return Ok(None) };
        let film = match base.numbers {
            Some(_) => base.film(design),
            None => resolved_film(study, condition, design)?.filter(|film| names(film) == names(&base.film)),
        };
        let Some(film) = film else { return Ok(None) };
        Ok(Some(self.display(&base, control)?.evaluate(&film)?))
    }

    /// Computes values and exact derivatives of a design; `None` if this method does not apply to it.
    ///
    /// # Errors
    /// Those of [`evaluate`](Self::evaluate).
    pub(crate) fn derivatives(
        &mut self,
        study: &Study,
        condition: &Condition,
        design: &[f64],
        control: &Control<'_>,
    ) -> Result<Option<Slopes>, DesignError> {
        let Some(base) = self.base(study, condition, design)? else { return Ok(None) };
        let Some((film, numbers)) = base.film(design).zip(base.numbers.as_ref()) else { return Ok(None) };
        let parameters: Vec<Parameter> = numbers.iter().map(|number| number.parameter).collect();
        let (display, variables) = (self.display(&base, control)?, design.len());
        if parameters.is_empty() {
            let values = display.evaluate(&film)?;
            return Ok(Some(Slopes { slopes: vec![0.0; values.len() * variables], values }));
        }
        let exact = display.derivatives(&film, &parameters)?;
        let mut slopes = vec![0.0; exact.values.len() * variables];
        for (quantity, row) in slopes.chunks_mut(variables).enumerate() {
            for (index, key) in numbers.iter().enumerate() {
                row[key.variable] += key.slope * exact.gradients[quantity * parameters.len() + index];
            }
        }
        Ok(Some(Slopes { values: exact.values, slopes }))
    }

    /// Pixel and scene of a design's choices; `None` if this method does not apply to the study.
    fn base(
        &mut self,
        study: &Study,
        condition: &Condition,
        design: &[f64],
    ) -> Result<Option<Arc<BasePixel>>, DesignError> {
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
        // The scenario's own numbers, not those of this design: the level of adding must not depend on which
        // design comes first.
        let mut values = study.values(design)?;
        let keys = study.variables.iter().flat_map(|variable| variable.keys.iter().map(move |_| variable));
        let numbers_of = values.iter_mut().zip(keys).filter(|(_, variable)| variable.is_number());
        numbers_of.for_each(|(value, _)| *value = serde_json::Value::Null);
        let mut scene = condition.varied.scenario(&values)?.resolve()?.scene;
        let Pixel::Film(film) = scene.display.pixel.clone() else { return Ok(None) };
        let numbers = numbers(study, &film);
        if numbers.is_none() && !study.variables.iter().all(|one| is_of_film(one, &film)) {
            return Ok(None);
        }
        if let Some(own) = self.own_film(condition, values.len()).filter(|own| names(own) == names(&film)) {
            scene.display.pixel = Pixel::Film(own);
        }
        let base = Arc::new(BasePixel { choices, scene: Arc::new(scene), film, numbers });
        if self.pixels.len() == MOST_PIXELS {
            self.pixels.remove(0);
        }
        self.pixels.push(base.clone());
        Ok(Some(base))
    }

    /// The film of the scenario as it stands; `None` if it has none, or cannot be read without the choices.
    fn own_film(&mut self, condition: &Condition, keys: usize) -> Option<FilmPixel> {
        if self.own.is_none() {
            let scenario = condition.varied.scenario(&vec![serde_json::Value::Null; keys]).ok()?;
            let Pixel::Film(film) = scenario.resolve().ok()?.scene.display.pixel else { return None };
            self.own = Some(film);
        }
        self.own.clone()
    }

    /// Prepared display of a pixel. The most recently added display is the last one.
    fn display(&mut self, base: &BasePixel, control: &Control<'_>) -> Result<&mut Designs, DesignError> {
        let index = match self.displays.iter().position(|(scene, _)| differs_only_in_pixel(scene, base)) {
            Some(index) => index,
            None => {
                if self.displays.len() == MOST_DISPLAYS {
                    self.displays.remove(0);
                }
                let designs = Designs::new(&base.scene, &self.quantities, control)?;
                self.displays.push((base.scene.clone(), designs));
                self.displays.len() - 1
            }
        };
        Ok(&mut self.displays[index].1)
    }
}

/// Names of the states.
fn names(film: &FilmPixel) -> Vec<&str> {
    film.states.iter().map(|state| state.name.as_str()).collect()
}

/// All keys of the numeric variables; `None` if one of them is not a parameter of the film.
fn numbers(study: &Study, film: &FilmPixel) -> Option<Vec<NumericKey>> {
    let mut numbers = Vec::new();
    for (variable, one) in study.variables.iter().enumerate().filter(|(_, one)| one.values == Values::Number)
    {
        for key in &one.keys {
            let parameter = parameter(&key.path, film)?;
            numbers.push(NumericKey { variable, slope: key.slope, offset: key.offset, parameter });
        }
    }
    Some(numbers)
}

/// Returns true if all keys of a numeric variable are parameters of the film, or of its materials.
fn is_of_film(variable: &Variable, film: &FilmPixel) -> bool {
    !variable.is_number()
        || variable.keys.iter().all(|key| parameter(&key.path, film).is_some() || is_of_material(&key.path))
}

/// The film of a design, as its scenario has it; `None` if it is no film.
fn resolved_film(
    study: &Study,
    condition: &Condition,
    design: &[f64],
) -> Result<Option<FilmPixel>, DesignError> {
    match condition.varied.scenario(&study.values(design)?)?.resolve()?.scene.display.pixel {
        Pixel::Film(film) => Ok(Some(film)),
        _ => Ok(None),
    }
}

impl BasePixel {
    /// Pixel of a design by its parameters; `None` if a scenario would reject its values, or there are other numbers.
    fn film(&self, design: &[f64]) -> Option<FilmPixel> {
        let mut film = self.film.clone();
        for NumericKey { variable, slope, offset, parameter } in self.numbers.as_ref()? {
            if !set(&mut film, *parameter, slope * design[*variable] + offset) {
                return None;
            }
        }
        has_unit_area(&film).then_some(film)
    }
}

/// Returns true if the scenes differ only in the pixel, and its states have the same names.
fn differs_only_in_pixel(scene: &Scene, base: &BasePixel) -> bool {
    let other = &base.scene;
    let Pixel::Film(film) = &scene.display.pixel else { return false };
    std::ptr::eq(scene, Arc::as_ptr(other))
        || scene.display.layers == other.display.layers
            && scene.display.matrix == other.display.matrix
            && scene.grid == other.grid
            && scene.lighting == other.lighting
            && scene.viewer == other.viewer
            && scene.metrics == other.metrics
            && scene.solver == other.solver
            && names(film) == names(&base.film)
}
