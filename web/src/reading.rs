//! Converts the text and files of a request to a scene, without reading the disk.

use std::collections::BTreeMap;
use std::sync::Arc;

use axum::http::StatusCode;
use papilio_display::adding_seconds;
use papilio_display::pixel::state_names;
use papilio_scenario::{Edit, Library, MemoryFile, Resolved, Scenario};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::fault::Fault;
use crate::shipped;
use crate::site::Site;

/// Maximum length of a scenario in bytes.
const LONGEST_SCENARIO: usize = 256 << 10;

/// Maximum number of edits in one request.
const MOST_EDITS: usize = 200;

/// Maximum number of files of a scenario.
const MOST_FILES: usize = 64;

/// Maximum of views x states x wavelengths of a response: about 20 MB.
const MOST_NUMBERS: usize = 200_000;

/// Maximum of the estimated time, in seconds, for which adding cannot be stopped.
const MOST_SECONDS: f64 = 20.0;

/// A scenario and its files.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Given {
    /// The scenario: TOML.
    pub(crate) scenario: String,
    /// Ids of uploaded files by their names in the scenario. The data of the program itself need no ids.
    #[serde(default)]
    pub(crate) files: BTreeMap<String, String>,
}

/// Applies edits to the text of a scenario.
pub(crate) fn edited(scenario: String, edits: &[Edit]) -> Result<String, Fault> {
    check_length(&scenario)?;
    if edits.len() > MOST_EDITS {
        return Err(Fault::malformed(format!("a request has at most {MOST_EDITS} edits")));
    }
    Ok(if edits.is_empty() { scenario } else { papilio_scenario::edit(&scenario, edits)? })
}

fn check_length(scenario: &str) -> Result<(), Fault> {
    if scenario.len() <= LONGEST_SCENARIO {
        return Ok(());
    }
    let message = format!("the scenario is longer than {} KiB", LONGEST_SCENARIO >> 10);
    Err(Fault::new(StatusCode::PAYLOAD_TOO_LARGE, message, "put spectra and tables into files"))
}

/// The solver of a computation, which replaces the solver of the scenario.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Solver {
    Adding,
    MonteCarlo,
}

impl Given {
    /// Returns the files by their names, with those of the program, or an error with the ids of the files that are not stored.
    pub(crate) fn library(&self, site: &Site) -> Result<Library, Fault> {
        let mut files = shipped::DATA.clone();
        files.extend(self.own_files(site)?);
        Ok(Library::Memory { files: Arc::new(files), memo: site.memo() })
    }

    /// Returns the uploaded files by their names, or an error with the ids of the files that are not stored.
    pub(crate) fn own_files(&self, site: &Site) -> Result<BTreeMap<String, MemoryFile>, Fault> {
        check_length(&self.scenario)?;
        if self.files.len() > MOST_FILES {
            return Err(Fault::malformed(format!("a scenario has at most {MOST_FILES} files")));
        }
        let mut files = BTreeMap::new();
        let mut missing = Vec::new();
        for (name, id) in &self.files {
            match site.store().get(id) {
                Some(file) => drop(files.insert(name.clone(), file)),
                None => missing.push(id.clone()),
            }
        }
        if missing.is_empty() {
            return Ok(files);
        }
        let mut fault = Fault::new(StatusCode::GONE, "a file is no longer stored", "send it again");
        fault.body.missing = Some(missing);
        Err(fault)
    }

    /// Reads the scenario and resolves it for a solver.
    pub(crate) fn resolve(&self, site: &Site, solver: Solver) -> Result<(Scenario, Resolved), Fault> {
        let scenario = self.scenario(site, solver)?;
        let resolved = scenario.resolve()?;
        check_work(&resolved, solver)?;
        Ok((scenario, resolved))
    }

    /// Reads the scenario and resolves it for adding, with the picture of `[image]`.
    pub(crate) fn resolve_with_picture(&self, site: &Site) -> Result<Resolved, Fault> {
        let resolved = self.scenario(site, Solver::Adding)?.resolve_with_picture()?;
        check_work(&resolved, Solver::Adding)?;
        Ok(resolved)
    }

    /// Reads the scenario for a solver.
    pub(crate) fn scenario(&self, site: &Site, solver: Solver) -> Result<Scenario, Fault> {
        let library = self.library(site)?;
        let scenario = self.read(&library, &[])?;
        let set = set_for(&scenario, solver);
        if set.is_empty() { Ok(scenario) } else { self.read(&library, &set) }
    }

    /// Returns the overrides, as with `--set`, with which a solver accepts the scenario.
    pub(crate) fn overrides(&self, library: &Library, solver: Solver) -> Result<Vec<String>, Fault> {
        Ok(set_for(&self.read(library, &[])?, solver))
    }

    fn read(&self, library: &Library, set: &[String]) -> Result<Scenario, Fault> {
        Ok(Scenario::from_text(&self.scenario, "scenario", library.clone(), set)?)
    }
}

/// Returns the overrides with which a solver accepts a scenario that was written for the other one.
fn set_for(scenario: &Scenario, solver: Solver) -> Vec<String> {
    let table = scenario.filled_at("solver");
    let has = |key: &str| table.get(key).is_some_and(|value| !value.is_null());
    let wanted = match solver {
        Solver::Adding => "adding",
        Solver::MonteCarlo => "monte-carlo",
    };
    if table.get("method").and_then(|method| method.as_str()) == Some(wanted) {
        return Vec::new();
    }
    let mut set = vec![format!("solver.method={wanted}")];
    if solver == Solver::Adding && has("paths") {
        set.push("solver.relative_error=0.001".to_owned());
    }
    set
}

/// Refuses scenarios whose result is too large for a page, or whose computation could not be stopped soon
/// enough.
pub(crate) fn check_work(resolved: &Resolved, solver: Solver) -> Result<(), Fault> {
    let scene = &resolved.scene;
    let views = scene.viewer.theta_deg.len() * scene.viewer.phi_deg.len();
    let states = state_names(&scene.display.pixel).len();
    let numbers = views * states * scene.grid.len();
    if numbers > MOST_NUMBERS {
        let bins = scene.grid.len();
        return Err(Fault::too_much(
            format!(
                "{views} views of {states} states at {bins} wavelengths are too many for the page: at most {MOST_NUMBERS} numbers"
            ),
            "choose fewer views or a larger spectrum.step_nm, or use `papilio run`, which has no such limit",
        ));
    }
    if solver == Solver::MonteCarlo {
        return Ok(());
    }
    let seconds = adding_seconds(scene).map_err(|error| Fault::of(resolved, error))?;
    if seconds > MOST_SECONDS {
        return Err(Fault::too_much(
            format!(
                "adding would take about {seconds:.0} s to prepare these layers; the page allows {MOST_SECONDS:.0} s"
            ),
            "choose a wider diffuser, fewer wavelengths or constant refractive indices, or use the Monte Carlo \
             solver, or `papilio run`, which has no such limit",
        )
        .for_monte_carlo());
    }
    Ok(())
}
