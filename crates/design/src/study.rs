//! What is varied and what is asked of every design.

use papilio_display::Quantity;
use papilio_scenario::{Optimisation, SearchQuantity, SearchRange, Varied};
use serde_json::Value as Json;

use crate::DesignError;

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
    /// What a search compares.
    pub fn of(search: &Optimisation) -> Self {
        let conditions = search.conditions.iter();
        let variable = |one: &papilio_scenario::SearchVariable| Variable {
            name: one.name.clone(),
            keys: one
                .keys
                .iter()
                .map(|(path, slope, offset)| Key { path: path.clone(), slope: *slope, offset: *offset })
                .collect(),
            values: match &one.range {
                SearchRange::Bounds(..) => Values::Number,
                SearchRange::Choices(choices) => Values::Choices(choices.clone()),
            },
        };
        let named = |one: &SearchQuantity| Named {
            name: one.name.clone(),
            condition: one.condition,
            quantity: one.quantity.clone(),
        };
        Self {
            conditions: conditions
                .map(|one| Condition { name: one.name.clone(), varied: one.varied.clone() })
                .collect(),
            variables: search.variables.iter().map(variable).collect(),
            quantities: search.quantities().into_iter().map(named).collect(),
        }
    }

    /// Every path with its value at a design, in order.
    ///
    /// # Errors
    /// As of [`values`](Self::values).
    pub fn settings(&self, design: &[f64]) -> Result<Vec<(&str, Json)>, DesignError> {
        let paths =
            self.variables.iter().flat_map(|variable| variable.keys.iter().map(|key| key.path.as_str()));
        Ok(paths.zip(self.values(design)?).collect())
    }

    /// Refuses what is no design.
    ///
    /// # Errors
    /// If it has the wrong length, or a number that its variable does not have.
    pub fn check(&self, design: &[f64]) -> Result<(), DesignError> {
        if design.len() != self.variables.len() {
            return Err(DesignError::Length { expected: self.variables.len(), found: design.len() });
        }
        match self.variables.iter().zip(design).find(|(variable, x)| !variable.takes(**x)) {
            Some((variable, &value)) => Err(DesignError::Value { variable: variable.name.clone(), value }),
            None => Ok(()),
        }
    }

    /// The values of the paths of every condition at a design.
    ///
    /// # Errors
    /// If it has the wrong length, or a number that its variable does not have.
    pub fn values(&self, design: &[f64]) -> Result<Vec<Json>, DesignError> {
        self.check(design)?;
        let each = self.variables.iter().zip(design);
        Ok(each.flat_map(|(variable, x)| variable.keys.iter().map(|key| variable.value(key, *x))).collect())
    }
}

impl Variable {
    /// True if it is no choice.
    pub fn is_number(&self) -> bool {
        self.values == Values::Number
    }

    fn takes(&self, x: f64) -> bool {
        match &self.values {
            Values::Number => x.is_finite(),
            Values::Choices(choices) => x >= 0.0 && x.fract() == 0.0 && (x as usize) < choices.len(),
        }
    }

    /// The value of one of its keys; null for a choice that there is not.
    pub(crate) fn value(&self, key: &Key, x: f64) -> Json {
        match &self.values {
            Values::Number => (key.slope * x + key.offset).into(),
            Values::Choices(choices) => choices.get(x as usize).cloned().unwrap_or_default(),
        }
    }
}
