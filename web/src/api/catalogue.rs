//! The endpoints of named materials and illuminants, for the page's browser.

use papilio_scenario::{Diagnostic, IlluminantEntry, IlluminantSheet, MaterialEntry, MaterialSheet};

use crate::fault::{Fault, shortened};
use crate::site::Site;

pub(super) fn materials(_: &Site) -> Result<Vec<MaterialEntry>, Fault> {
    Ok(papilio_scenario::materials())
}

pub(super) fn material(name: &str) -> Result<MaterialSheet, Fault> {
    papilio_scenario::material_sheet(name).map_err(|wrong| unknown("material", name, &wrong))
}

pub(super) fn illuminants(_: &Site) -> Result<Vec<IlluminantEntry>, Fault> {
    Ok(papilio_scenario::illuminants())
}

pub(super) fn illuminant(name: &str) -> Result<IlluminantSheet, Fault> {
    papilio_scenario::illuminant_sheet(name).map_err(|wrong| unknown("illuminant", name, &wrong))
}

/// Response to an unknown name, with the names that were probably meant.
fn unknown(what: &str, name: &str, wrong: &Diagnostic) -> Fault {
    let message = format!("there is no {what} `{}`", shortened(name));
    Fault::new(axum::http::StatusCode::NOT_FOUND, message, wrong.hint.as_deref().unwrap_or_default())
}
