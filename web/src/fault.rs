//! What goes wrong, as answers: a status, and errors with their places.

use axum::body::Body;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use papilio_display::DisplayError;
use papilio_formats::{Diagnostic, FormatError};
use papilio_scenario::{ScenarioError, ScenarioErrors};
use schemars::JsonSchema;
use serde::Serialize;

/// Why a request has no answer.
#[derive(Debug, Clone)]
pub(crate) struct Fault {
    pub(crate) status: StatusCode,
    pub(crate) body: FaultBody,
}

/// The body of every answer that is an error.
#[derive(Debug, Clone, Default, Serialize, JsonSchema)]
pub(crate) struct FaultBody {
    /// What is wrong; at least one.
    pub(crate) errors: Vec<OneError>,
    /// The scenario after the edits, if it is that which is wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) scenario: Option<String>,
    /// Files that are no longer here and have to be sent again, by their ids.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) missing: Option<Vec<String>>,
}

/// One thing that is wrong, in the words of the command line.
#[derive(Debug, Clone, Default, Serialize, JsonSchema)]
pub(crate) struct OneError {
    /// What is wrong.
    pub(crate) message: String,
    /// The key that it concerns: `display.pixel.film.1.thickness_nm`.
    pub(crate) path: Option<String>,
    /// Line of the scenario, from 1.
    pub(crate) line: Option<usize>,
    /// Column in characters, from 1.
    pub(crate) column: Option<usize>,
    /// What should stand there.
    pub(crate) expected: Option<String>,
    /// What to do.
    pub(crate) hint: Option<String>,
}

impl Fault {
    /// With a message and a hint.
    pub(crate) fn new(status: StatusCode, message: impl Into<String>, hint: &str) -> Self {
        let hint = (!hint.is_empty()).then(|| hint.to_owned());
        let error = OneError { message: message.into(), hint, ..OneError::default() };
        Self { status, body: FaultBody { errors: vec![error], ..FaultBody::default() } }
    }

    /// A request that is not what it should be.
    pub(crate) fn malformed(message: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, message, "")
    }

    /// What is right in itself but more than is computed here.
    pub(crate) fn too_much(message: impl Into<String>, hint: &str) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, message, hint)
    }

    /// Nothing goes by this name.
    pub(crate) fn unknown(what: &str, name: &str) -> Self {
        Self::new(StatusCode::NOT_FOUND, format!("there is no {what} `{}`", shortened(name)), "")
    }

    /// A fault of the program's own.
    pub(crate) fn internal(message: &str) -> Self {
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, message, "")
    }

    /// The same, with the scenario that is wrong.
    pub(crate) fn about(mut self, scenario: &str) -> Self {
        self.body.scenario = Some(scenario.to_owned());
        self
    }
}

/// The start of a text that someone else chose.
pub(crate) fn shortened(text: &str) -> String {
    const MOST: usize = 80;
    text.chars().take(MOST).map(|c| if c.is_control() { ' ' } else { c }).collect()
}

impl From<ScenarioErrors> for Fault {
    fn from(errors: ScenarioErrors) -> Self {
        let body = FaultBody { errors: errors.iter().map(OneError::from).collect(), ..FaultBody::default() };
        Self { status: StatusCode::UNPROCESSABLE_ENTITY, body }
    }
}

impl From<&ScenarioError> for OneError {
    fn from(error: &ScenarioError) -> Self {
        let message = error.diagnostic.message.clone();
        // The place in a data file goes into the words; line and column are always the scenario's.
        let (message, place) = match &error.asked_for_at {
            Some(place) => (format!("{}: {message}", error.place), place),
            None => (message, &error.place),
        };
        let (line, column) = place.line_column().unzip();
        Self {
            message,
            path: error.path.clone(),
            line,
            column,
            expected: error.diagnostic.expected.clone(),
            hint: error.hint().map(str::to_owned),
        }
    }
}

impl From<DisplayError> for Fault {
    fn from(error: DisplayError) -> Self {
        match error {
            DisplayError::Interrupted => Self::too_much("the computation was stopped", ""),
            other => Self::too_much(other.to_string(), ""),
        }
    }
}

impl From<FormatError> for Fault {
    fn from(error: FormatError) -> Self {
        let Diagnostic { message, expected, hint, .. } = error.problem.diagnostic();
        let mut fault = Self::too_much(format!("{}: {message}", error.place), "");
        fault.body.errors[0].expected = expected;
        fault.body.errors[0].hint = hint;
        fault
    }
}

impl IntoResponse for Fault {
    fn into_response(self) -> Response {
        let json = serde_json::to_vec(&self.body).unwrap_or_default();
        let mut response = Response::new(Body::from(json));
        *response.status_mut() = self.status;
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/json"));
        if self.status == StatusCode::SERVICE_UNAVAILABLE {
            headers.insert(header::RETRY_AFTER, HeaderValue::from_static("1"));
        }
        response
    }
}
