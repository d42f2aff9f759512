//! Changes to the text of a scenario that keep its comments, its order and its layout: what a form behind the text does.
//!
//! Paths are those of `--set`: dotted, arrays by index from 0. What is set replaces its rival (`haze` and `width`), and
//! an array that only the scenario's preset gives is written into the text before one of its items changes.

mod layout;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml_edit::{DocumentMut, Item, Table, Value};

use self::layout::{forget_positions, item, like_neighbour, number_positions};
use crate::error::{Errors, ScenarioError, ScenarioErrors};
use crate::preset;
use crate::problem::Problem;
use crate::renamed;
use crate::scenario::parse;
use crate::set::{MOST_SEGMENTS, RIVALS};
use crate::tree::Node;

/// One change.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "op", rename_all = "lowercase", deny_unknown_fields)]
pub enum Edit {
    /// Sets a key or an item of an array; what is not there is made.
    Set {
        /// Where: `display.pixel.film.1.thickness_nm`.
        path: String,
        /// What; a null is no value.
        value: serde_json::Value,
    },
    /// Takes a key or an item of an array away. What is not there stays away.
    Remove {
        /// Where.
        path: String,
    },
    /// Puts an item into an array, which is made if it is not there.
    Insert {
        /// Where the array is.
        path: String,
        /// Before which item; none: behind the last one.
        index: Option<usize>,
        /// What.
        value: serde_json::Value,
    },
    /// Moves an item of an array.
    Move {
        /// Where the array is.
        path: String,
        /// Its index.
        from: usize,
        /// Its index afterwards.
        to: usize,
    },
}

impl Edit {
    /// What `--set PATH=VALUE` does; `None` of a text that is not that.
    pub fn of_set(text: &str) -> Option<Self> {
        let (path, value) = text.split_once('=')?;
        let value = Node::parse_value(value.trim_start(), 0, 0, &mut Errors::default()).to_json();
        Some(Self::Set { path: path.trim().to_owned(), value })
    }

    fn path(&self) -> &str {
        match self {
            Self::Set { path, .. }
            | Self::Remove { path }
            | Self::Insert { path, .. }
            | Self::Move { path, .. } => path,
        }
    }
}

/// The text with the changes, one after the other.
///
/// # Errors
/// If the text is not TOML, or a path leads nowhere.
///
/// ```
/// use papilio_scenario::{Edit, edit};
/// let text = "[display.diffuser]\nmodel = \"k-correlation\"\nhaze = 0.78 # as bought\n";
/// let set = Edit::Set { path: "display.diffuser.haze".into(), value: 0.5.into() };
/// assert!(edit(text, &[set])?.ends_with("haze = 0.5 # as bought\n"));
/// # Ok::<(), papilio_scenario::ScenarioErrors>(())
/// ```
pub fn edit(text: &str, edits: &[Edit]) -> Result<String, ScenarioErrors> {
    parse(text, "scenario", &[])?;
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        let problem = Problem::Syntax { message: error.message().to_owned() };
        ScenarioError::about_file("scenario", problem)
    })?;
    for (number, edit) in edits.iter().enumerate() {
        apply(&mut document, edit).map_err(|why| {
            let problem = Problem::SetPath { why };
            let error = ScenarioError::about_file(&format!("edit #{}", number + 1), problem);
            ScenarioError { path: Some(edit.path().to_owned()), ..error }
        })?;
    }
    let edited = document.to_string();
    parse(&edited, "scenario", &[])?;
    Ok(edited)
}

/// Why a change cannot be made, in words.
type Why = String;

fn apply(document: &mut DocumentMut, edit: &Edit) -> Result<(), Why> {
    let path: Vec<&str> = edit.path().split('.').map(str::trim).collect();
    if path.iter().any(|key| key.is_empty()) {
        return Err("a key of this path is empty".to_owned());
    }
    if path.len() > MOST_SEGMENTS {
        return Err("this path is too long".to_owned());
    }
    let preset = preset_of(document);
    let path = as_written(document.as_item(), &path);
    let root = document.as_item_mut();
    match edit {
        Edit::Set { value, .. } => set(root, preset.as_ref(), &path, value),
        Edit::Remove { .. } => remove(root, preset.as_ref(), &path),
        Edit::Insert { index, value, .. } => insert(root, preset.as_ref(), &path, *index, value),
        Edit::Move { from, to, .. } => rearrange(root, preset.as_ref(), &path, *from, *to),
    }
}

/// The path with each renamed key as the text has it: an edit changes the key that is there, whichever of its names it has.
/// A key that is not there gets its present name.
fn as_written<'a>(root: &Item, path: &[&'a str]) -> Vec<&'a str> {
    let present = renamed::present(path);
    let mut item = Some(root);
    let mut written = Vec::with_capacity(path.len());
    for (i, key) in present.iter().enumerate() {
        let has =
            |name: &str| item.and_then(Item::as_table_like).is_some_and(|table| table.contains_key(name));
        let old = renamed::old_key(&present[..i], key).filter(|old| has(old) && !has(key));
        let key = old.unwrap_or(key);
        written.push(key);
        item = item.and_then(|item| match key.parse::<usize>() {
            Ok(at) if length(item).is_some() => item.get(at),
            _ => item.get(key),
        });
    }
    written
}

/// What the scenario's preset gives.
fn preset_of(document: &DocumentMut) -> Option<DocumentMut> {
    let name = document.get("lighting")?.get("preset")?.as_str()?;
    let mut document: DocumentMut = preset::text(name)?.parse().ok()?;
    forget_positions(document.as_table_mut());
    Some(document)
}

fn set(
    root: &mut Item,
    preset: Option<&DocumentMut>,
    path: &[&str],
    value: &serde_json::Value,
) -> Result<(), Why> {
    let Some((last, above)) = path.split_last() else { return Err("this path is empty".to_owned()) };
    let parent = walk(root, preset, above, is_index(last))?;
    if let Some(count) = length(parent) {
        return match index(last, count)? {
            at if at == count => put(parent, at, value),
            at => match parent.get_mut(at) {
                Some(old) => replace(old, value, false),
                None => Err("there is no such item".to_owned()),
            },
        };
    }
    let in_table = parent.is_table();
    let table = parent.as_table_like_mut().ok_or("what stands above this has no keys")?;
    for [a, b] in RIVALS {
        for (one, rival) in [(a, b), (b, a)] {
            if *last == one {
                table.remove(rival);
            }
        }
    }
    replace(table.entry(last).or_insert(Item::None), value, in_table)
}

/// Puts a value in the place of another, in the same layout.
fn replace(old: &mut Item, value: &serde_json::Value, in_table: bool) -> Result<(), Why> {
    let as_table = if old.is_none() { in_table } else { old.is_table() || old.is_array_of_tables() };
    let mut new = item(value, as_table)?;
    match (&mut new, &*old) {
        (Item::Value(new), Item::Value(old)) => *new.decor_mut() = old.decor().clone(),
        (Item::Table(new), Item::Table(old)) => {
            *new.decor_mut() = old.decor().clone();
            new.set_position(old.position());
        }
        _ => {}
    }
    *old = new;
    Ok(())
}

fn remove(root: &mut Item, preset: Option<&DocumentMut>, path: &[&str]) -> Result<(), Why> {
    let Some((last, above)) = path.split_last() else { return Err("this path is empty".to_owned()) };
    if !is_index(last) && !exists(root, above) {
        return Ok(());
    }
    let parent = walk(root, preset, above, is_index(last))?;
    let Some(count) = length(parent) else {
        if let Some(table) = parent.as_table_like_mut() {
            table.remove(last);
        }
        return Ok(());
    };
    let at = index(last, count)?;
    if at == count {
        return Ok(());
    }
    take(parent, at);
    if count == 1 && parent.is_array_of_tables() {
        // An array of tables without tables cannot be written; without the key, a preset's array would come back.
        *parent = Item::Value(Value::Array(toml_edit::Array::new()));
        let named =
            above.split_last().and_then(|(key, above)| Some((key, walk(root, None, above, false).ok()?)));
        if let Some((key, table)) = named
            && let Some(mut key) = table.as_table_like_mut().and_then(|table| table.key_mut(key))
        {
            key.leaf_decor_mut().set_suffix(" ");
        }
    }
    Ok(())
}

fn insert(
    root: &mut Item,
    preset: Option<&DocumentMut>,
    path: &[&str],
    at: Option<usize>,
    value: &serde_json::Value,
) -> Result<(), Why> {
    let array = walk(root, preset, path, true)?;
    let count = length(array).ok_or("this is not an array")?;
    let at = at.unwrap_or(count);
    if at > count {
        return Err(format!("this array has {count} items"));
    }
    put(array, at, value)
}

fn rearrange(
    root: &mut Item,
    preset: Option<&DocumentMut>,
    path: &[&str],
    from: usize,
    to: usize,
) -> Result<(), Why> {
    let array = walk(root, preset, path, true)?;
    let count = length(array).ok_or("this is not an array")?;
    if from.max(to) >= count {
        return Err(format!("this array has {count} items"));
    }
    match array {
        Item::ArrayOfTables(tables) => {
            let table = tables.remove(from);
            tables.insert(to, table);
            number_positions(tables);
        }
        Item::Value(Value::Array(values)) => {
            let value = values.remove(from);
            values.insert_formatted(to, value);
        }
        _ => {}
    }
    Ok(())
}

/// Puts an item into an array, 0 to its length.
fn put(array: &mut Item, at: usize, value: &serde_json::Value) -> Result<(), Why> {
    // An empty array has no layout yet.
    if array.as_array().is_some_and(toml_edit::Array::is_empty) && value.is_object() {
        *array = Item::ArrayOfTables(toml_edit::ArrayOfTables::new());
    }
    match array {
        Item::ArrayOfTables(tables) => {
            let Item::Table(table) = item(value, true)? else {
                return Err("a table belongs here".to_owned());
            };
            tables.insert(at, table);
            number_positions(tables);
        }
        Item::Value(Value::Array(values)) => {
            let Item::Value(mut value) = item(value, false)? else {
                return Err("a table cannot stand here".to_owned());
            };
            like_neighbour(values, at, &mut value);
            values.insert_formatted(at, value);
        }
        _ => return Err("this is not an array".to_owned()),
    }
    Ok(())
}

fn take(array: &mut Item, at: usize) {
    match array {
        Item::ArrayOfTables(tables) => {
            tables.remove(at);
            number_positions(tables);
        }
        Item::Value(Value::Array(values)) => {
            values.remove(at);
        }
        _ => {}
    }
}

fn is_index(key: &str) -> bool {
    key.parse::<usize>().is_ok()
}

/// An index of an array, or the one behind its last.
fn index(key: &str, count: usize) -> Result<usize, Why> {
    match key.parse::<usize>() {
        Ok(at) if at <= count => Ok(at),
        Ok(_) if count == 0 => Err("this array is empty, its first index is 0".to_owned()),
        Ok(_) => Err(format!("this array has the indices 0 to {}", count - 1)),
        Err(_) => Err("this is an array: an index is needed here".to_owned()),
    }
}

/// How many items an array has; `None` for what is none.
fn length(item: &Item) -> Option<usize> {
    match item {
        Item::ArrayOfTables(tables) => Some(tables.len()),
        Item::Value(Value::Array(values)) => Some(values.len()),
        _ => None,
    }
}

fn exists(root: &Item, path: &[&str]) -> bool {
    let found = path.iter().try_fold(root, |item, key| match key.parse::<usize>() {
        Ok(at) if length(item).is_some() => item.get(at),
        _ => item.get(key),
    });
    found.is_some()
}

/// What is at a path, made if it is not there; `array`: what it is to be then.
fn walk<'a>(
    root: &'a mut Item,
    preset: Option<&DocumentMut>,
    path: &[&str],
    array: bool,
) -> Result<&'a mut Item, Why> {
    let mut item = root;
    for (i, key) in path.iter().enumerate() {
        let next_is_index = path.get(i + 1).map_or(array, |next| is_index(next));
        let in_table = item.is_table();
        item = match length(item) {
            Some(count) => {
                let at = index(key, count)?;
                if at == count {
                    put(item, at, &serde_json::Value::Object(serde_json::Map::new()))?;
                }
                item.get_mut(at).ok_or("there is no such item")?
            }
            None => {
                let kind = item.type_name();
                let table = item.as_table_like_mut();
                let table = table.ok_or_else(|| {
                    format!("what stands above {key} is of the kind {kind}, it has no keys")
                })?;
                table.entry(key).or_insert(Item::None)
            }
        };
        if item.is_none() {
            *item = match given(preset, &path[..=i]).filter(|_| next_is_index) {
                Some(given) => given.clone(),
                None if next_is_index => Item::Value(Value::Array(toml_edit::Array::new())),
                None if in_table => {
                    let mut table = Table::new();
                    // No header of its own until it has keys of its own.
                    table.set_implicit(true);
                    Item::Table(table)
                }
                None => Item::Value(Value::InlineTable(toml_edit::InlineTable::new())),
            };
        }
    }
    Ok(item)
}

/// What the preset has at a path of keys.
fn given<'a>(preset: Option<&'a DocumentMut>, path: &[&str]) -> Option<&'a Item> {
    path.iter().try_fold(preset?.as_item(), |item, key| item.get(key))
}

#[cfg(test)]
mod tests;
