//! Errors as HTTP responses: a status, and messages with their locations in the scenario.

use axum::body::Body;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use papilio_display::DisplayError;
use papilio_formats::{Diagnostic, FormatError};
use papilio_scenario::{Interface, Resolved, ScenarioError, ScenarioErrors, text_of};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

/// The error response to a request.
#[derive(Debug, Clone)]
pub(crate) struct Fault {
    pub(crate) status: StatusCode,
    pub(crate) body: FaultBody,
}

/// The body of every error response.
#[derive(Debug, Clone, Default, Serialize, JsonSchema)]
pub(crate) struct FaultBody {
    /// The errors; at least one.
    pub(crate) errors: Vec<OneError>,
    /// The scenario after the edits, if the error concerns the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) scenario: Option<String>,
    /// Ids of the files that the server no longer stores and that must be sent again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) missing: Option<Vec<String>>,
}

/// An error, with the text of the command line.
#[derive(Debug, Clone, Default, Serialize, JsonSchema)]
pub(crate) struct OneError {
    /// What is wrong, in a sentence.
    pub(crate) message: String,
    /// The key that it concerns: `display.pixel.film.1.thickness_nm`.
    pub(crate) path: Option<String>,
    /// Line of the scenario, from 1.
    pub(crate) line: Option<usize>,
    /// Column in characters, from 1.
    pub(crate) column: Option<usize>,
    /// The expected value.
    pub(crate) expected: Option<String>,
    /// What to do.
    pub(crate) hint: Option<String>,
    /// A value of the key that is accepted, for example the nearest one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) accepted: Option<Value>,
    /// True if only adding refuses this: the Monte Carlo solver can compute it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) monte_carlo: Option<bool>,
}

impl Fault {
    /// Creates a response with one message and a hint; an empty hint is left out.
    pub(crate) fn new(status: StatusCode, message: impl Into<String>, hint: &str) -> Self {
        let hint = (!hint.is_empty()).then(|| hint.to_owned());
        let error = OneError { message: message.into(), hint, ..OneError::default() };
        Self { status, body: FaultBody { errors: vec![error], ..FaultBody::default() } }
    }

    /// Creates the response to a malformed request.
    pub(crate) fn malformed(message: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, message, "")
    }

    /// Creates the response to a valid request that cannot be processed: too large, too slow, or refused by a
    /// reader.
    pub(crate) fn too_much(message: impl Into<String>, hint: &str) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, message, hint)
    }

    /// Creates the response to an unknown name.
    pub(crate) fn unknown(what: &str, name: &str) -> Self {
        Self::new(StatusCode::NOT_FOUND, format!("there is no {what} `{}`", shortened(name)), "")
    }

    /// Creates the response to an internal error of the program.
    pub(crate) fn internal(message: &str) -> Self {
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, message, "")
    }

    /// Creates the response to a request whose computation has panicked.
    pub(crate) fn panicked() -> Self {
        Self::internal("the computation failed; this is an error in Papilio")
    }

    /// Adds the scenario that the error concerns.
    pub(crate) fn about(mut self, scenario: &str) -> Self {
        self.body.scenario = Some(scenario.to_owned());
        self
    }
}

/// Returns at most 80 characters of a text from a client, without control characters.
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
        // The location in a data file is put into the message; line and column always refer to the scenario.
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
            hint: error.help(Interface::Page),
            // The value of a data file cannot be changed in the scenario.
            accepted: error
                .diagnostic
                .accepted
                .as_deref()
                .filter(|_| error.asked_for_at.is_none())
                .and_then(as_json),
            monte_carlo: None,
        }
    }
}

/// Reads an accepted value.
fn as_json(text: &str) -> Option<Value> {
    serde_json::from_str(text).ok()
}

impl Fault {
    /// Marks the errors as those of adding alone.
    pub(crate) fn for_monte_carlo(mut self) -> Self {
        self.body.errors.iter_mut().for_each(|error| error.monte_carlo = Some(true));
        self
    }

    /// True if the Monte Carlo solver can compute what this error refuses.
    pub(crate) fn is_for_monte_carlo(&self) -> bool {
        self.body.errors.iter().all(|error| error.monte_carlo == Some(true))
    }

    /// Converts an error of a computation, with its location in the scenario if it has one.
    pub(crate) fn of(resolved: &Resolved, error: DisplayError) -> Self {
        // Adding alone refuses it.
        let for_monte_carlo = matches!(error, DisplayError::Azimuth { key: "solver.method", .. });
        if matches!(error, DisplayError::TooNarrow { .. } | DisplayError::TooNarrowInField { .. }) {
            // A limit of the page.
            return error.into();
        }
        let fault: Self = resolved.located(&error).map_or_else(|| error.into(), Self::from);
        if for_monte_carlo { fault.for_monte_carlo() } else { fault }
    }
}

impl From<DisplayError> for Fault {
    fn from(error: DisplayError) -> Self {
        match error {
            DisplayError::Interrupted => Self::too_much("the computation was stopped", ""),
            // The message of the command line names options that the page does not have.
            DisplayError::TooNarrow { what, number, nodes, most } => Self::too_much(
                format!(
                    "{what} (scatterer {number} from the top) is too narrow for adding within these layers: it would \
                     need {nodes} directions, and more than {most} would take hours"
                ),
                "use a wider one, or the Monte Carlo solver",
            )
            .for_monte_carlo(),
            DisplayError::TooNarrowInField { width, least, light } => Self::too_much(
                format!(
                    "the diffuser of width {width:.1e} is too narrow for adding in light that {light} (expected at least {least}): it \
                     would take hours"
                ),
                "use a wider one, or the Monte Carlo solver",
            )
            .for_monte_carlo(),
            other => Self::too_much(text_of(&other, Interface::Page), ""),
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
