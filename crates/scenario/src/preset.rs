//! Ready-made light and viewer, after Feng 2012 (from Kubota et al. 2006).
//!
//! | preset | diffuse | directed | viewer | illuminance |
//! |---|---|---|---|---|
//! | `indoor` | 50 % | 50 % at -20 deg | 8 deg | 500 lx |
//! | `sunny` | 20 % | 80 % at -35 deg | 20 deg | 100 000 lx |
//! | `overcast` | 100 % | none | 8 deg | 10 000 lx |
//!
//! The shares lie in the display plane. The source gives no lux: these are the
//! usual levels of an office, full sun and an overcast sky. All are D65.

use crate::error::Errors;
use crate::problem::Problem;
use crate::set::PRESET_PATH;
use crate::tree::{Node, Value};

/// Names and contents.
const PRESETS: [(&str, &str); 3] = [
    (
        "indoor",
        "lighting = { illuminance_lx = 500, spectrum = \"D65\", diffuse = 0.5, \
         directed = [{ theta_deg = -20, share = 0.5 }] }\nviewer.theta_deg = 8",
    ),
    (
        "sunny",
        "lighting = { illuminance_lx = 1e5, spectrum = \"D65\", diffuse = 0.2, \
         directed = [{ theta_deg = -35, share = 0.8 }] }\nviewer.theta_deg = 20",
    ),
    (
        "overcast",
        "lighting = { illuminance_lx = 1e4, spectrum = \"D65\", diffuse = 1.0 }\nviewer.theta_deg = 8",
    ),
];

/// The names of the presets.
pub fn preset_names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|(name, _)| *name)
}

/// Fills in what the preset gives and the scenario does not, if it names one.
pub(crate) fn expand(root: &mut Node, errors: &mut Errors) {
    let mut named = Some(&*root);
    for key in PRESET_PATH.split('.') {
        named = named.and_then(|node| node.get(key));
    }
    let Some(Node { origin, value: Value::Text(name) }) = named else { return };
    match PRESETS.iter().find(|(known, _)| known == name) {
        Some((_, text)) => {
            let preset = Node::parse_document(text, &mut Errors::default()).moved_to(*origin);
            root.fill_from(preset);
        }
        None => {
            let choices = preset_names().map(str::to_owned).collect();
            errors.push(*origin, Problem::UnknownChoice { found: name.clone(), choices });
        }
    }
}
