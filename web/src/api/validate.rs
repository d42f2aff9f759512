//! The endpoints `/samples` and `/validate`: samples that others measured, predicted from their printed inputs, as by
//! `papilio validate --measured`.

use papilio_display::Control;
use papilio_reproduction::ReproductionError;
use papilio_reproduction::samples::{Prediction, SampleList, SampleReport, figures, predict, report};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::drawn::Figure;
use super::events::{self, EventSender, Events};
use crate::fault::{Fault, FaultBody};
use crate::site::Site;

/// A sample that others measured.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct SampleEntry {
    /// Its name.
    name: String,
    /// What it is.
    title: String,
    /// Who measured it.
    source: String,
}

/// Returns the shipped samples.
pub(super) fn samples(_: &Site) -> Result<Vec<SampleEntry>, Fault> {
    let list = SampleList::of_program().map_err(|error| fault_of(&error))?;
    let entry = |one: &papilio_reproduction::samples::Sample| SampleEntry {
        name: one.name.clone(),
        title: one.title.clone(),
        source: one.source.clone(),
    };
    Ok(list.samples.iter().map(entry).collect())
}

/// A request for predictions.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ValidateOf {
    /// The name of a sample; null: all samples.
    sample: Option<String>,
}

/// An event of a validation.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "event", content = "data", rename_all = "lowercase")]
pub(super) enum ValidateEvent {
    /// What is done so far.
    Progress(ValidateProgress),
    /// A sample is predicted.
    Sample(Box<Prediction>),
    /// All samples are predicted.
    Done(ValidateDone),
    /// The validation has failed; this event replaces `done`.
    Failed(FaultBody),
}

/// The progress of a validation.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ValidateProgress {
    /// Fraction of the work that is done, 0 to 1.
    fraction: f64,
    /// The sample in progress.
    words: String,
}

/// The end of a validation.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ValidateDone {
    /// The text of report.html.
    html: String,
    /// The contents of samples.json.
    report: SampleReport,
    /// What was predicted and measured of each sample: `sample-NAME`, with a number if it is not the first of a sample.
    figures: Vec<Figure>,
}

pub(super) async fn validate(site: Site, request: ValidateOf) -> Result<Events, Fault> {
    let list = SampleList::of_program().map_err(|error| fault_of(&error))?;
    let list = match &request.sample {
        Some(name) => list.only(name).map_err(|error| fault_of(&error))?,
        None => list,
    };
    events::start(site.streamed(), move |events| {
        computed(&list, events).map_or_else(|fault| ValidateEvent::Failed(fault.body), ValidateEvent::Done)
    })
    .await
}

fn computed(list: &SampleList, events: &EventSender) -> Result<ValidateDone, Fault> {
    let folder = tempfile::tempdir().map_err(|_| Fault::internal("there is no temporary folder"))?;
    SampleList::shipped(folder.path()).map_err(|error| fault_of(&error))?;
    let files = SampleList::folder(folder.path());
    let mut samples = Vec::new();
    for (number, sample) in list.samples.iter().enumerate() {
        let whole = list.samples.len() as f64;
        let tell = |fraction: f64| {
            events.stop_if_late();
            let fraction = (number as f64 + 0.9 * fraction) / whole;
            events.send(&ValidateEvent::Progress(ValidateProgress { fraction, words: sample.name.clone() }));
        };
        tell(0.0);
        let control = Control {
            threads: Some(super::fit::threads()),
            progress: &|now| tell(now.fraction()),
            stop: events.stop(),
        };
        let found = predict(sample, &files, &control).map_err(|error| {
            if events.stop_if_late() { crate::work::too_long(events.deadline()) } else { fault_of(&error) }
        })?;
        events.send_reliably(&ValidateEvent::Sample(Box::new(found.clone())));
        samples.push(found);
    }
    let figure = |one: papilio_reproduction::samples::SampleFigure| Figure { name: one.name, svg: one.svg };
    Ok(ValidateDone {
        html: report(&samples).html(),
        figures: samples.iter().flat_map(figures).map(figure).collect(),
        report: SampleReport { papilio: env!("CARGO_PKG_VERSION").to_owned(), samples },
    })
}

fn fault_of(error: &ReproductionError) -> Fault {
    Fault::too_much(error.to_string(), "")
}
