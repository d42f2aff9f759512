//! The endpoint `/directors`: the director of a liquid-crystal cell by depth in each state, for the drawing of the page.

use std::collections::BTreeMap;

use papilio_display::scene::{CrystalSlice, Pixel};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::fault::Fault;
use crate::reading::{Given, Solver};
use crate::site::Site;

/// Largest number of depths.
const MOST_DEPTHS: usize = 25;

/// A request for the director of a cell.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DirectorsOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// The number of the layer in `display.pixel.stack`, from 0.
    layer: usize,
}

/// The director in a state.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct StateDirectors {
    /// The state.
    state: String,
    /// Unit vectors from the top down at equal steps of depth: x, y in the panel, z towards the viewer.
    directors: Vec<[f64; 3]>,
}

pub(super) async fn directors(site: Site, request: DirectorsOf) -> Result<Vec<StateDirectors>, Fault> {
    let server = site.clone();
    site.quick()
        .work(move |_| {
            let DirectorsOf { scenario, files, layer } = request;
            // The stack of this layer alone has no other parts.
            let mut text: toml_edit::DocumentMut =
                scenario.parse().map_err(|_| Fault::malformed("the scenario is not TOML"))?;
            let none = || Fault::unknown("layer of a liquid-crystal pixel", &layer.to_string());
            let stack = text
                .get_mut("display")
                .and_then(|display| display.get_mut("pixel"))
                .and_then(|pixel| pixel.get_mut("stack"))
                .ok_or_else(none)?;
            keep_only(stack, layer).ok_or_else(none)?;
            let given = Given { scenario: text.to_string(), files };
            let resolved = given.scenario(&server, Solver::Adding)?.resolve_without_light()?;
            let Pixel::Crystal(pixel) = &resolved.scene.display.pixel else { return Err(none()) };
            let part = pixel.parts.first().ok_or_else(none)?;
            let of = |(k, state): (usize, &String)| {
                let slices = part.slices.get(k).or(part.slices.first());
                let directors = slices.map_or(Vec::new(), |slices| thinned(slices));
                StateDirectors { state: state.clone(), directors }
            };
            Ok(pixel.states.iter().enumerate().map(of).collect())
        })
        .await
}

/// Removes all other tables of a list.
fn keep_only(list: &mut toml_edit::Item, index: usize) -> Option<()> {
    if let Some(array) = list.as_array_mut() {
        let one = array.get(index)?.clone();
        array.clear();
        array.push(one);
        return Some(());
    }
    let tables = list.as_array_of_tables_mut()?;
    let one = tables.get(index)?.clone();
    tables.clear();
    tables.push(one);
    Some(())
}

/// The directors of a part of the slices.
fn thinned(slices: &[CrystalSlice]) -> Vec<[f64; 3]> {
    let count = slices.len().min(MOST_DEPTHS);
    (0..count).map(|k| slices[(2 * k + 1) * slices.len() / (2 * count)].axes[0]).collect()
}
