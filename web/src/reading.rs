//! From a request's text and files to a scene, with nothing read from the disk.

use std::collections::BTreeMap;
use std::sync::Arc;

use axum::http::StatusCode;
use papilio_display::adding_seconds;
use papilio_display::pixel::state_names;
use papilio_scenario::{Edit, Library, Resolved, Scenario};
use schemars::JsonSchema;
use serde::Deserialize;

use crate::fault::Fault;
use crate::shipped;
use crate::site::Site;

/// The longest scenario, in bytes.
const LONGEST_SCENARIO: usize = 256 << 10;

/// Changes in one request.
const MOST_EDITS: usize = 200;

/// Files that one scenario may name.
const MOST_FILES: usize = 64;

/// Views x states x wavelengths of an answer: about 20 MB of it.
const MOST_NUMBERS: usize = 200_000;

/// What adding may take before it heeds a stop, roughly.
const MOST_SECONDS: f64 = 20.0;

/// A scenario and the files that it names.
#[derive(Debug, Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Given {
    /// The scenario: TOML.
    pub(crate) scenario: String,
    /// Ids of uploaded files by the names that the scenario gives them. Data that ships with the program needs none.
    #[serde(default)]
    pub(crate) files: BTreeMap<String, String>,
}

/// A scenario's text with changes.
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
    Err(Fault::new(StatusCode::PAYLOAD_TOO_LARGE, message, "spectra and tables belong into files"))
}

/// Which solver, whatever the scenario says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum By {
    Adding,
    Walk,
}

impl Given {
    /// The files by their names.
    pub(crate) fn library(&self, site: &Site) -> Result<Library, Fault> {
        check_length(&self.scenario)?;
        if self.files.len() > MOST_FILES {
            return Err(Fault::malformed(format!("a scenario has at most {MOST_FILES} files")));
        }
        let mut files = shipped::DATA.clone();
        let mut missing = Vec::new();
        for (name, id) in &self.files {
            match site.store().get(id) {
                Some(file) => drop(files.insert(name.clone(), file)),
                None => missing.push(id.clone()),
            }
        }
        if missing.is_empty() {
            return Ok(Library::Memory { files: Arc::new(files), memo: site.memo() });
        }
        let mut fault = Fault::new(StatusCode::GONE, "a file is no longer here", "send it again");
        fault.body.missing = Some(missing);
        Err(fault)
    }

    /// The scenario, and what it means to a solver.
    pub(crate) fn resolve(&self, site: &Site, by: By) -> Result<(Scenario, Resolved), Fault> {
        let library = self.library(site)?;
        let mut scenario = self.read(&library, &[])?;
        let set = set_for(&scenario, by);
        if !set.is_empty() {
            scenario = self.read(&library, &set)?;
        }
        let resolved = scenario.resolve()?;
        check_work(&resolved)?;
        Ok((scenario, resolved))
    }

    /// What has to be set for a solver to take the scenario, as of `--set`.
    pub(crate) fn overrides(&self, library: &Library, by: By) -> Result<Vec<String>, Fault> {
        Ok(set_for(&self.read(library, &[])?, by))
    }

    fn read(&self, library: &Library, set: &[String]) -> Result<Scenario, Fault> {
        Ok(Scenario::from_text(&self.scenario, "scenario", library.clone(), set)?)
    }
}

/// What has to be set for a solver to take a scenario that is meant for the other.
fn set_for(scenario: &Scenario, by: By) -> Vec<String> {
    let solver = scenario.filled_at("solver");
    let has = |key: &str| solver.get(key).is_some_and(|value| !value.is_null());
    let wanted = match by {
        By::Adding => "adding",
        By::Walk => "monte-carlo",
    };
    if solver.get("method").and_then(|method| method.as_str()) == Some(wanted) {
        return Vec::new();
    }
    let mut set = vec![format!("solver.method={wanted}")];
    if by == By::Adding && has("paths") {
        set.push("solver.relative_error=0.001".to_owned());
    }
    set
}

/// Refuses what would make an answer that no page can show, and what could not be stopped soon enough.
pub(crate) fn check_work(resolved: &Resolved) -> Result<(), Fault> {
    let scene = &resolved.scene;
    let views = scene.viewer.theta_deg.len() * scene.viewer.phi_deg.len();
    let states = state_names(&scene.display.pixel).len();
    let numbers = views * states * scene.grid.len();
    if numbers > MOST_NUMBERS {
        let bins = scene.grid.len();
        return Err(Fault::too_much(
            format!(
                "{views} views of {states} states at {bins} wavelengths are too much for a page: at most {MOST_NUMBERS} numbers"
            ),
            "fewer views or a larger spectrum.step_nm; `papilio run` takes all of it",
        ));
    }
    let seconds = adding_seconds(scene).map_err(|error| Fault::of(resolved, error))?;
    if seconds > MOST_SECONDS {
        return Err(Fault::too_much(
            format!("these layers would take adding about {seconds:.0} s, more than a page waits for"),
            "a wider diffuser, fewer wavelengths, or indices that are numbers; `papilio run` takes it",
        ));
    }
    Ok(())
}
