//! What is varied and what is asked of every design.

use papilio_scenario::Varied;
use serde_json::Value as Json;

use crate::{DesignError, Quantity};

/// A display whose designs are compared: the same variables under every condition.
#[derive(Debug, Clone)]
pub struct Study {
    /// At least one. The paths of each are those of all variables' keys, in order.
    pub conditions: Vec<Condition>,
    /// What a design is made of.
    pub variables: Vec<Variable>,
    /// What is asked of it.
    pub quantities: Vec<Named>,
}

/// A light, a view or anything else that every design has to do with.
#[derive(Debug, Clone)]
pub struct Condition {
    /// Its name; empty where there is one alone.
    pub name: String,
    /// The scenario in this condition.
    pub varied: Varied,
}

/// A number of every design: an axis of the space of designs.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// For tables and messages.
    pub name: String,
    /// The keys that it moves.
    pub keys: Vec<Key>,
    /// What its number means.
    pub values: Values,
}

/// A key of the scenario that a variable moves: `slope * x + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// As of `--set`.
    pub path: String,
    /// 1, mostly; -1 where the key takes what another gives.
    pub slope: f64,
    /// 0, mostly.
    pub offset: f64,
}

/// What the number of a variable means.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Itself.
    Number,
    /// Which of these, from 0.
    Choices(Vec<Json>),
}

/// A quantity under a condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    /// For tables and messages.
    pub name: String,
    /// Which condition, from 0.
    pub condition: usize,
    /// What is asked.
    pub quantity: Quantity,
}

impl Key {
    /// A key that takes the variable's number as it is.
    pub fn plain(path: impl Into<String>) -> Self {
        Self { path: path.into(), slope: 1.0, offset: 0.0 }
    }
}

impl Study {
    /// The values of the paths of every condition at a design.
    ///
    /// # Errors
    /// If it has the wrong length, or a number that its variable does not have.
    pub fn values(&self, design: &[f64]) -> Result<Vec<Json>, DesignError> {
        if design.len() != self.variables.len() {
            return Err(DesignError::Length { expected: self.variables.len(), found: design.len() });
        }
        let mut values = Vec::new();
        for (variable, &x) in self.variables.iter().zip(design) {
            for key in &variable.keys {
                let value = variable.value(key, x);
                let wrong = || DesignError::Value { variable: variable.name.clone(), value: x };
                values.push(value.ok_or_else(wrong)?);
            }
        }
        Ok(values)
    }
}

impl Variable {
    /// The value of one of its keys; `None` for a number that means nothing.
    pub fn value(&self, key: &Key, x: f64) -> Option<Json> {
        match &self.values {
            Values::Number => {
                let value = key.slope * x + key.offset;
                value.is_finite().then(|| value.into())
            }
            Values::Choices(choices) if x >= 0.0 && x.fract() == 0.0 => choices.get(x as usize).cloned(),
            Values::Choices(_) => None,
        }
    }
}
