//! The displays of the report: shipped scenarios, which are written to a folder and run.

use std::path::{Path, PathBuf};

use papilio_display::result::{RunResult, StateValues, View};
use papilio_display::{Control, DisplayError};
use papilio_formats::{FormatError, write_file};
use papilio_scenario::{Resolved, Scenario, ScenarioErrors};

/// Error of the computation of a report.
#[derive(Debug, thiserror::Error)]
pub enum ReproductionError {
    /// A scenario of the report is invalid.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// A display could not be computed, or was interrupted.
    #[error(transparent)]
    Display(#[from] DisplayError),
    /// A file could not be read or written.
    #[error(transparent)]
    File(#[from] FormatError),
    /// A surface could not be measured.
    #[error("a surface of the report cannot be measured: {0}")]
    Surface(papilio_microgeometry::MicrogeometryError),
    /// A measurement could not be used.
    #[error("a measured sample of the report cannot be used: {0}")]
    Sample(String),
    /// A list of samples, or a sample, cannot be used.
    #[error("{0}")]
    List(String),
    /// An example that the report runs is not part of the program.
    #[error("the program was built without its example `{0}`")]
    Example(String),
    /// The spread by the tolerances of inputs, or a metric, could not be computed.
    #[error(transparent)]
    Design(#[from] papilio_design::DesignError),
    /// A folder could not be created.
    #[error("cannot create the folder {0}: {1}")]
    Folder(PathBuf, std::io::Error),
}

impl From<papilio_microgeometry::MicrogeometryError> for ReproductionError {
    fn from(error: papilio_microgeometry::MicrogeometryError) -> Self {
        match error {
            papilio_microgeometry::MicrogeometryError::Interrupted => {
                Self::Display(DisplayError::Interrupted)
            }
            other => Self::Surface(other),
        }
    }
}

/// The shipped files, in the folder of the examples.
const SHIPPED: &[&str] = &[
    "reference-pixel.toml",
    "indoor.toml",
    "sunny.toml",
    "overcast.toml",
    "sampling.toml",
    "measured-diffused.toml",
    "measured-truth.toml",
    "measured-h65.toml",
    "measured-h78.toml",
    "data/H65.bsdf",
    "data/H78.bsdf",
    "data/H78-raw.bsdf",
    "data/H65-transmission.csv",
    "data/H78-transmission.csv",
    "data/H81-transmission.csv",
];

/// Folder of the scenarios of a report, and control of their computation.
pub(crate) struct Bench<'a> {
    folder: PathBuf,
    control: &'a Control<'a>,
}

impl<'a> Bench<'a> {
    /// Writes the scenarios into a folder.
    pub(crate) fn new(folder: &Path, control: &'a Control<'a>) -> Result<Self, ReproductionError> {
        let data = folder.join("data");
        std::fs::create_dir_all(&data).map_err(|error| ReproductionError::Folder(data, error))?;
        for name in SHIPPED {
            write_example(&format!("scenarios/{name}"), &folder.join(name))?;
        }
        Ok(Self { folder: folder.to_owned(), control })
    }

    /// Writes a file of the report's own into the folder.
    pub(crate) fn write(&self, name: &str, text: &str) -> Result<(), ReproductionError> {
        Ok(write_file(&self.path(name), |out| out.write_all(text.as_bytes()))?)
    }

    /// Returns the path of one of the shipped files.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Returns the control of the computation.
    pub(crate) fn control(&self) -> &'a Control<'a> {
        self.control
    }

    /// Resolves a shipped scenario with changes as by `--set`.
    pub(crate) fn resolve(&self, name: &str, set: &[&str]) -> Result<Resolved, ReproductionError> {
        let set: Vec<String> = set.iter().map(|&text| text.to_owned()).collect();
        Ok(Scenario::load(&self.path(&format!("{name}.toml")), &set)?.resolve()?)
    }

    /// Runs a shipped scenario with changes as by `--set`.
    pub(crate) fn run(&self, name: &str, set: &[&str]) -> Result<RunResult, ReproductionError> {
        Ok(papilio_display::run(&self.resolve(name, set)?.scene, self.control)?)
    }

    /// Runs a shipped scenario at these viewing angles, degrees.
    pub(crate) fn at(
        &self,
        name: &str,
        theta_deg: &[f64],
        set: &[&str],
    ) -> Result<RunResult, ReproductionError> {
        let views = format!("viewer.theta_deg={theta_deg:?}");
        let all: Vec<&str> = std::iter::once(views.as_str()).chain(set.iter().copied()).collect();
        self.run(name, &all)
    }
}

/// Writes a shipped file.
pub(crate) fn write_example(example: &str, path: &Path) -> Result<(), ReproductionError> {
    let bytes = papilio_examples::file(example).ok_or(ReproductionError::Example(example.to_owned()))?;
    Ok(write_file(path, |out| out.write_all(&bytes))?)
}

/// Returns the values of a state in a view, if it has this state.
pub(crate) fn values<'a>(view: &'a View, state: &str) -> Option<&'a StateValues> {
    view.states.get(state).map(|state| &state.value)
}

/// Returns a number of a state; NaN where it is not defined.
pub(crate) fn of(view: &View, state: &str, number: fn(&StateValues) -> Option<f64>) -> f64 {
    values(view, state).and_then(number).unwrap_or(f64::NAN)
}

/// Returns the first view of a result; every scenario has one.
pub(crate) fn first(result: &RunResult) -> &View {
    &result.views[0]
}
