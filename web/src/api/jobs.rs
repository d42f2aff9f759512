//! The endpoints of jobs: commands of the program that go on when the page is closed.

use std::collections::BTreeMap;

use axum::http::StatusCode;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::export::Exported;
use crate::fault::Fault;
use crate::jobs::{COMMANDS, JobCommand, JobSeen, Jobs, Wanted};
use crate::reading::Given;
use crate::site::Site;

pub(super) fn commands(_: &Site) -> Result<Vec<JobCommand>, Fault> {
    Ok(COMMANDS.to_vec())
}

/// A request without contents.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Nothing {}

/// The jobs of the server.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct JobList {
    /// Whether the server runs jobs.
    is_available: bool,
    /// The newest first.
    jobs: Vec<JobSeen>,
}

/// A command to run.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct JobOf {
    /// Its words after `papilio`: `diffuser fit`.
    command: String,
    /// Its options by name without dashes; "" for flags.
    #[serde(default)]
    options: BTreeMap<String, String>,
    /// The scenario or the surface, if the command has one: TOML.
    #[serde(default)]
    scenario: String,
    /// The name of its file, without extension.
    #[serde(default)]
    name: String,
    /// The title of the design.
    #[serde(default)]
    title: String,
    /// Ids of uploaded files by their names.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Names of the further files of the command.
    #[serde(default)]
    inputs: Vec<String>,
}

/// A job.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct JobId {
    id: String,
}

/// A file that a job has written.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct JobFileOf {
    id: String,
    name: String,
}

fn jobs(site: &Site) -> Result<&Jobs, Fault> {
    site.jobs().ok_or_else(|| {
        Fault::new(StatusCode::CONFLICT, "this server runs no jobs", "start it with `papilio serve`")
    })
}

/// Work on files, on a thread of its own.
async fn on_disk<T: Send + 'static>(
    site: Site,
    work: impl FnOnce(&Site, &Jobs) -> Result<T, Fault> + Send + 'static,
) -> Result<T, Fault> {
    let server = site.clone();
    site.files().work(move |_| work(&server, jobs(&server)?)).await
}

pub(super) async fn list(site: Site, _: Nothing) -> Result<JobList, Fault> {
    if site.jobs().is_none() {
        return Ok(JobList { is_available: false, jobs: Vec::new() });
    }
    on_disk(site, |_, jobs| Ok(JobList { is_available: true, jobs: jobs.list() })).await
}

pub(super) async fn start(site: Site, request: JobOf) -> Result<JobSeen, Fault> {
    on_disk(site, move |site, jobs| {
        let JobOf { command, options, scenario, name, title, files, inputs } = request;
        let given = Given { scenario, files };
        let files = given.own_files(site)?;
        let wanted = Wanted {
            command: &command,
            options: &options,
            scenario: &given.scenario,
            name: &name,
            title: &title,
            inputs: &inputs,
            files: &files,
        };
        jobs.start(&wanted)
    })
    .await
}

pub(super) async fn cancel(site: Site, JobId { id }: JobId) -> Result<(), Fault> {
    on_disk(site, move |_, jobs| jobs.cancel(&id)).await
}

pub(super) async fn remove(site: Site, JobId { id }: JobId) -> Result<(), Fault> {
    on_disk(site, move |_, jobs| jobs.remove(&id)).await
}

pub(super) async fn file(site: Site, JobFileOf { id, name }: JobFileOf) -> Result<Exported, Fault> {
    on_disk(site, move |_, jobs| {
        let file = jobs.file(&id, &name)?;
        Ok(Exported { kind: "application/octet-stream", bytes: file.bytes })
    })
    .await
}
