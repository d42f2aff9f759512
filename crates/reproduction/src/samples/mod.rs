//! Samples that others measured, predicted from their printed inputs without fitting.
//!
//! A list in TOML ([`SampleList`]) names for each sample its scenario, its measurement, the displays that were measured, the
//! tolerances of the printed inputs, and the inputs that were not printed, with their range. [`predict`] computes the
//! displays, and compares them with the measurement.
//!
//! **Verdict.** z is the difference, predicted minus measured, over the root of the sum of the squares of the measurement's
//! standard deviation and of that by the tolerances of the inputs. A sample agrees if the root mean square of z is at most
//! [`AGREES`], the band of 95 % of one normally distributed number, because the errors of a spectrum are rarely independent.
//! Inputs that were not printed are drawn from their range, too, which widens the band; a sample that agrees only with them
//! is within its unknowns. Without a standard deviation of the measurement there is no verdict.

mod brdf;
mod figures;
mod page;
mod predicted;
#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test says what it expects by unwrapping")]
mod tests;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use papilio_diagnostics::{Diagnostic, Place};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::ReproductionError;
use crate::displays::write_example;
pub use brdf::BrdfComparison;
pub use figures::{SampleFigure, figures};
pub use page::{in_numbers, in_words, report};
pub use predicted::{CasePrediction, Prediction, Verdict, predict};

/// Largest root mean square of z of a sample that agrees.
pub const AGREES: f64 = 2.0;

/// The shipped list, in the folder of the examples.
const SHIPPED: &str = "data/samples.toml";

/// A list of samples.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SampleList {
    /// The samples, in the order of the report.
    #[serde(rename = "sample")]
    pub samples: Vec<Sample>,
}

/// A sample: files, and what is known of it. Paths are relative to the list.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sample {
    /// Its name on the command line.
    pub name: String,
    /// What it is.
    pub title: String,
    /// Who measured it, and where the numbers are from.
    pub source: String,
    /// Licence of the numbers.
    pub licence: String,
    /// The inputs that were printed, and their uncertainty, in words.
    pub inputs: String,
    /// What explains the verdict, in words.
    #[serde(default)]
    pub remark: String,
    /// Its scenario.
    pub scenario: String,
    /// Further files that the scenario names.
    #[serde(default)]
    pub files: Vec<String>,
    /// Its measurement, as for `papilio compare`, or a list of pairs of directions.
    pub measured: String,
    /// What was measured.
    #[serde(default)]
    pub quantity: Quantity,
    /// Relative standard deviation of a measured BRDF, whose files state none.
    #[serde(default)]
    pub relative_standard_deviation: Option<f64>,
    /// The displays that were measured.
    pub cases: Vec<Case>,
    /// Tolerances of the printed inputs: tables as of `tolerance.keys` in a scenario.
    #[serde(default)]
    pub tolerances: Vec<toml::Table>,
    /// Inputs that were not printed.
    #[serde(default)]
    pub unknowns: Vec<Unknown>,
}

/// What was measured of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// What a display shows: spectra, colours, metrics.
    #[default]
    Display,
    /// The BRDF of the pixel at pairs of directions, without the layers over it.
    Brdf,
}

/// A display of a sample.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Its name.
    pub name: String,
    /// Values of keys that differ from the scenario.
    #[serde(default)]
    pub set: BTreeMap<String, toml::Value>,
}

/// An input that was not printed.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unknown {
    /// What it is, and its range, in words.
    pub what: String,
    /// Its distribution: a table as of `tolerance.keys` in a scenario.
    pub tolerance: toml::Table,
}

/// What `papilio validate --measured` reports.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SampleReport {
    /// Version of the program.
    pub papilio: String,
    /// The samples.
    pub samples: Vec<Prediction>,
}

impl SampleList {
    /// Reads a list; errors call it `name`.
    ///
    /// # Errors
    /// For a text that is no such list, with its place.
    pub fn parse(text: &str, name: &str) -> Result<Self, ReproductionError> {
        let refused = |place: Option<Range<usize>>, what: String, expected: &str| {
            let place = place.map_or_else(|| Place::whole(name), |at| Place::in_text(name, text, at));
            let diagnostic = Diagnostic::new(what);
            let diagnostic = if expected.is_empty() { diagnostic } else { diagnostic.expected(expected) };
            let placed = diagnostic.at(&place).to_string();
            ReproductionError::List(placed.strip_prefix("error: ").unwrap_or(&placed).to_owned())
        };
        let list: Self = toml::from_str(text)
            .map_err(|error| refused(error.span(), error.message().trim_end().to_owned(), ""))?;
        if list.samples.is_empty() {
            return Err(refused(None, "this list has no samples".to_owned(), "[[sample]], with its keys"));
        }
        for (number, sample) in list.samples.iter().enumerate() {
            let own = &sample.name;
            let at =
                text.match_indices("[[sample]]").nth(number).map(|(from, found)| from..from + found.len());
            let plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
            if own.is_empty() || own.starts_with('.') || !own.chars().all(plain) {
                let what = format!("the name \"{own}\" of this sample is not that of a file");
                return Err(refused(at, what, "letters, digits, `-`, `_`, such as \"panel-17\""));
            }
            if list.samples[..number].iter().any(|other| other.name == *own) {
                return Err(refused(at, format!("two samples are called `{own}`"), "a name for each"));
            }
            if sample.cases.is_empty() {
                let what = format!("the sample `{own}` has no `cases`");
                return Err(refused(at, what, "at least one, such as cases = [{ name = \"one\" }]"));
            }
        }
        Ok(list)
    }

    /// Writes the shipped list and its files to a folder, and reads it.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn shipped(folder: &Path) -> Result<Self, ReproductionError> {
        let data = folder.join("data");
        std::fs::create_dir_all(&data).map_err(|error| ReproductionError::Folder(data, error))?;
        write_example(&format!("scenarios/{SHIPPED}"), &folder.join(SHIPPED))?;
        let list = Self::of_program()?;
        for sample in &list.samples {
            for file in sample.files.iter().chain([&sample.scenario, &sample.measured]) {
                let path = file.strip_prefix("../").map_or_else(|| format!("data/{file}"), str::to_owned);
                write_example(&format!("scenarios/{path}"), &folder.join(path))?;
            }
        }
        Ok(list)
    }

    /// The shipped list.
    ///
    /// # Errors
    /// If the program was built without it.
    pub fn of_program() -> Result<Self, ReproductionError> {
        let missing = || ReproductionError::Example(SHIPPED.to_owned());
        let bytes = papilio_examples::file(&format!("scenarios/{SHIPPED}")).ok_or_else(missing)?;
        Self::parse(&String::from_utf8_lossy(&bytes), SHIPPED)
    }

    /// The folder of the shipped list in the folder of the examples.
    pub fn folder(examples: &Path) -> std::path::PathBuf {
        examples.join("data")
    }

    /// Keeps the sample of this name.
    ///
    /// # Errors
    /// If there is none, with the names that there are.
    pub fn only(mut self, name: &str) -> Result<Self, ReproductionError> {
        let known: Vec<String> = self.samples.iter().map(|sample| sample.name.clone()).collect();
        self.samples.retain(|sample| sample.name == name);
        if self.samples.is_empty() {
            let known = known.join(", ");
            return Err(ReproductionError::List(format!(
                "there is no sample `{name}`; expected {known}, or a list of samples (.toml)"
            )));
        }
        Ok(self)
    }
}
