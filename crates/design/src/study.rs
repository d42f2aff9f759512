//! Definition of a study: variables, conditions and quantities.

use papilio_scenario::{Key, NamedQuantity, Optimisation, ParameterisedScenario, SearchRange};
use serde_json::Value as Json;

use crate::DesignError;

/// Designs of a display to be compared. Every design is evaluated under every condition.
#[derive(Debug, Clone)]
pub struct Study {
    /// Conditions, at least one. The paths of each are those of the keys of all variables, in order.
    pub conditions: Vec<Condition>,
    /// Variables; a design is one number for each.
    pub variables: Vec<Variable>,
    /// Quantities that are computed for each design.
    pub quantities: Vec<NamedQuantity>,
}

/// A scenario under which every design is evaluated: a light, a view or any other keys.
#[derive(Debug, Clone)]
pub struct Condition {
    /// Name; empty if there is only one condition.
    pub name: String,
    /// Scenario of this condition, parameterised by the keys of all variables.
    pub varied: ParameterisedScenario,
}

/// One dimension of the design space.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name in tables and messages.
    pub name: String,
    /// Keys that the variable sets.
    pub keys: Vec<Key>,
    /// Meaning of its number.
    pub values: Values,
}

/// Meaning of the number of a variable.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// The number is the value.
    Number,
    /// The number is the index of one of these values, from 0.
    Choices(Vec<Json>),
}

impl Study {
    /// Study of an optimisation.
    pub fn of(optimisation: &Optimisation) -> Self {
        let conditions = optimisation.conditions.iter();
        let variable = |read: &papilio_scenario::SearchVariable| Variable {
            name: read.name.clone(),
            keys: read.keys.clone(),
            values: match &read.range {
                SearchRange::Bounds(..) => Values::Number,
                SearchRange::Choices(choices) => Values::Choices(choices.clone()),
            },
        };
        Self {
            conditions: conditions
                .map(|read| Condition { name: read.name.clone(), varied: read.varied.clone() })
                .collect(),
            variables: optimisation.variables.iter().map(variable).collect(),
            quantities: optimisation.quantities().into_iter().cloned().collect(),
        }
    }

    /// Returns every path with its value in a design, in order.
    ///
    /// # Errors
    /// Those of [`values`](Self::values).
    pub fn settings(&self, design: &[f64]) -> Result<Vec<(&str, Json)>, DesignError> {
        let paths =
            self.variables.iter().flat_map(|variable| variable.keys.iter().map(|key| key.path.as_str()));
        Ok(paths.zip(self.values(design)?).collect())
    }

    /// Checks a design.
    ///
    /// # Errors
    /// If it has the wrong length, or a number that is not a value of its variable.
    pub fn check(&self, design: &[f64]) -> Result<(), DesignError> {
        if design.len() != self.variables.len() {
            return Err(DesignError::Length { expected: self.variables.len(), found: design.len() });
        }
        match self.variables.iter().zip(design).find(|(variable, x)| !variable.accepts(**x)) {
            Some((variable, &value)) => Err(DesignError::Value { variable: variable.name.clone(), value }),
            None => Ok(()),
        }
    }

    /// Returns the values of all paths in a design, in order; they are the same under every condition.
    ///
    /// # Errors
    /// Those of [`check`](Self::check).
    pub fn values(&self, design: &[f64]) -> Result<Vec<Json>, DesignError> {
        self.check(design)?;
        let each = self.variables.iter().zip(design);
        Ok(each.flat_map(|(variable, x)| variable.keys.iter().map(|key| variable.value(key, *x))).collect())
    }
}

impl Variable {
    /// Returns true if the variable is a number, not a choice.
    pub fn is_number(&self) -> bool {
        self.values == Values::Number
    }

    fn accepts(&self, x: f64) -> bool {
        match &self.values {
            Values::Number => x.is_finite(),
            Values::Choices(choices) => x >= 0.0 && x.fract() == 0.0 && (x as usize) < choices.len(),
        }
    }

    /// Value of one of its keys; null for a choice that does not exist.
    pub(crate) fn value(&self, key: &Key, x: f64) -> Json {
        match &self.values {
            Values::Number => (key.slope * x + key.offset).into(),
            Values::Choices(choices) => choices.get(x as usize).cloned().unwrap_or_default(),
        }
    }
}
