//! Edits of the text of a scenario that preserve its comments, its order and its layout, for the forms of an editor.
//!
//! **Comments.** An edit loses no comment, except those of a table or an item that it removes. A comment of a key that is no longer there
//! becomes a line of its own.
//!
//! Paths are those of `--set` ([`KeyPath`](crate::KeyPath)). A key that is set replaces the key that it excludes (`haze`
//! and `width`). An array that only the preset of the scenario has is written into the text before one of its items changes.

mod arrays;
mod comments;
mod items;
mod layout;

use std::path::Path;

use papilio_diagnostics::Diagnostic;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml_edit::{DocumentMut, Item, Table, Value};

use self::arrays::{length, merge_items, put, take};
use self::comments::{comments_of, with_comments};
use self::items::ArrayItems;
use self::layout::{forget_positions, is_equal, item, number_positions};
use crate::error::{ScenarioError, ScenarioErrors};
use crate::here::relocate_json;
use crate::mistake;
use crate::path::{Grow, KeyPath, Position, Shape, Step, Tree, index, split_assignment, step};
use crate::preset;
use crate::renamed::old_key;
use crate::scenario::parse;
use crate::set::EXCLUSIVE_KEYS;
use crate::tree::Node;

/// One edit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "op", rename_all = "lowercase", deny_unknown_fields)]
pub enum Edit {
    /// Sets a key or an item of an array. Missing tables and arrays are created.
    Set {
        /// Path of the key: `display.pixel.film.1.thickness_nm`.
        path: String,
        /// The value; null is not allowed.
        value: serde_json::Value,
    },
    /// Removes a key or an item of an array, if it exists.
    Remove {
        /// Path of the key.
        path: String,
    },
    /// Inserts an item into an array, which is created if it does not exist.
    Insert {
        /// Path of the array.
        path: String,
        /// Index of the item before which it is inserted; none: after the last one.
        index: Option<usize>,
        /// The item.
        value: serde_json::Value,
    },
    /// Moves an item of an array.
    Move {
        /// Path of the array.
        path: String,
        /// Index of the item.
        from: usize,
        /// Index of the item afterwards.
        to: usize,
    },
    /// Moves a table into an array of tables, with its comments. The table above it loses it; one that the text does not have becomes an
    /// empty item.
    Transfer {
        /// Path of the table.
        path: String,
        /// Path of the array, which is created if it does not exist.
        to: String,
        /// Index of the item before which it is inserted; none: after the last one.
        index: Option<usize>,
    },
}

impl Edit {
    /// Returns the edit that corresponds to `--set PATH=VALUE`; `None` if the text has another form.
    pub fn of_set(text: &str) -> Option<Self> {
        let (path, value) = split_assignment(text)?;
        let value = Node::parse_value(value.trim_start(), 0, 0).0.to_json();
        Some(Self::Set { path: path.trim().to_owned(), value })
    }

    /// As [`of_set`](Self::of_set), for a scenario file in `folder`: paths of files in the current folder are replaced by those from
    /// `folder`.
    pub fn of_set_in(text: &str, folder: &Path) -> Option<Self> {
        let mut edit = Self::of_set(text)?;
        if let Self::Set { path, value } = &mut edit {
            relocate_json(value, KeyPath::new(path).keys().last().unwrap_or_default(), folder);
        }
        Some(edit)
    }

    fn path(&self) -> &str {
        match self {
            Self::Set { path, .. }
            | Self::Remove { path }
            | Self::Insert { path, .. }
            | Self::Move { path, .. }
            | Self::Transfer { path, .. } => path,
        }
    }
}

/// Applies edits to a text in order.
///
/// # Errors
/// If the text is not TOML, or a path cannot exist in it.
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
        ScenarioError::about_file("scenario", mistake::syntax(error.message()))
    })?;
    let mut now = text.to_owned();
    for (number, edit) in edits.iter().enumerate() {
        let refused = |why| {
            let wrong = mistake::of_path(Diagnostic::new(why));
            let error = ScenarioError::about_file(&format!("edit #{}", number + 1), wrong);
            ScenarioError { path: Some(edit.path().to_owned()), ..error }
        };
        let removed = apply(&mut document, edit).map_err(refused)?;
        let plain = document.to_string();
        let kept = with_comments(&now, plain.clone(), &removed);
        if kept != plain {
            // It is the same document with more comments.
            document = kept.parse().map_err(|_| refused("the text has another form".to_owned()))?;
        }
        now = kept;
    }
    parse(&now, "scenario", &[])?;
    Ok(now)
}

/// The reason why an edit cannot be made.
type Message = String;

/// Makes an edit, and returns the comments of what it has removed.
fn apply(document: &mut DocumentMut, edit: &Edit) -> Result<Vec<String>, Message> {
    let path = KeyPath::new(edit.path());
    let mut text = Editor { preset: preset_of(document) };
    let root = document.as_item_mut();
    match edit {
        Edit::Set { value, .. } => text.set(root, &path, value)?,
        Edit::Remove { .. } => return text.remove(root, &path),
        Edit::Insert { index, value, .. } => text.insert(root, &path, *index, value)?,
        Edit::Move { from, to, .. } => text.rearrange(root, &path, *from, *to)?,
        Edit::Transfer { to, index, .. } => text.transfer(root, &path, &KeyPath::new(to), *index)?,
    }
    Ok(Vec::new())
}

/// Returns the name in a table of the key at the end of a path: the old name if the table has only that.
fn written_name<'a>(table: &Item, path: &KeyPath, key: &'a str) -> &'a str {
    let keys: Vec<&str> = path.keys().collect();
    let above = keys.split_last().map_or(&[][..], |(_, above)| above);
    let has = |name: &str| table.as_table_like().is_some_and(|table| table.contains_key(name));
    old_key(above, key).filter(|old| has(old) && !has(key)).unwrap_or(key)
}

/// Returns the keys of the scenario's preset.
fn preset_of(document: &DocumentMut) -> Option<DocumentMut> {
    let name = document.get("lighting")?.get("preset")?.as_str()?;
    let mut document: DocumentMut = preset::text(name)?.parse().ok()?;
    forget_positions(document.as_table_mut());
    Some(document)
}

/// Editor of a document, with the keys of the scenario's preset.
struct Editor {
    preset: Option<DocumentMut>,
}

impl Editor {
    /// Returns the item at a path, which is created if it does not exist, as an array if `array`.
    fn at<'a>(&mut self, root: &'a mut Item, path: &KeyPath, array: bool) -> Result<&'a mut Item, Message> {
        path.put(root, array, self).map_err(|error| error.wrong.message)
    }

    /// Returns the table or array above the last key of a path, and the step that the key means there.
    fn above<'a, 'k>(
        &mut self,
        root: &'a mut Item,
        path: &'k KeyPath,
    ) -> Result<(&'a mut Item, Step<'k>), Message> {
        path.check().map_err(|error| error.wrong.message)?;
        let (above, last) = path.split_last();
        let parent = match above {
            Some(above) => self.at(root, &above, index(last).is_some())?,
            None => root,
        };
        let step = step(parent.shape(), last).map_err(|wrong| wrong.message)?;
        Ok((parent, step))
    }

    fn set(&mut self, root: &mut Item, path: &KeyPath, value: &serde_json::Value) -> Result<(), Message> {
        let (parent, step) = self.above(root, path)?;
        let in_table = parent.is_table();
        let key = match step {
            Step::Index(index) => {
                return match parent.get_mut(index) {
                    Some(old) => replace(old, value, false),
                    None => put(parent, index, value),
                };
            }
            Step::Key(key) => written_name(parent, path, key),
        };
        let table = parent.as_table_like_mut().ok_or("the value above this key has no keys")?;
        for [a, b] in EXCLUSIVE_KEYS {
            for (one, rival) in [(a, b), (b, a)] {
                if key == one {
                    table.remove(rival);
                }
            }
        }
        let is_new_kind = ["kind", "model"].contains(&key) && !table.contains_key(key);
        replace(table.entry(key).or_insert(Item::None), value, in_table)?;
        if let Some(table) = parent.as_table_mut().filter(|_| is_new_kind) {
            // What a table is comes before its other keys.
            table.sort_values_by(|one, _, other, _| (one.get() != key).cmp(&(other.get() != key)));
        }
        Ok(())
    }

    /// Removes a key or an item, and returns the comments of a table or an item; those of a plain value stay.
    fn remove(&mut self, root: &mut Item, path: &KeyPath) -> Result<Vec<String>, Message> {
        let (above, last) = path.split_last();
        let is_there = above.as_ref().is_none_or(|above| above.get(root).is_some());
        if index(last).is_none() && !is_there {
            return Ok(Vec::new());
        }
        let (parent, step) = self.above(root, path)?;
        let index = match step {
            Step::Index(index) => index,
            Step::Key(key) => {
                let key = written_name(parent, path, key);
                let gone = parent.as_table_like_mut().and_then(|table| table.remove(key));
                let gone = gone.filter(|gone| gone.is_table() || gone.is_array_of_tables());
                return Ok(gone.as_ref().map(comments_of).unwrap_or_default());
            }
        };
        let count = length(parent).unwrap_or_default();
        if index == count {
            return Ok(Vec::new());
        }
        let removed = take(parent, index);
        if count == 1 && parent.is_array_of_tables() {
            // An array of tables without tables cannot be written. Without the key, the array of the preset would apply.
            *parent = Item::Value(Value::Array(toml_edit::Array::new()));
            if let Some(above) = above {
                self.blank_before_value(root, &above);
            }
        }
        Ok(removed)
    }

    fn transfer(
        &mut self,
        root: &mut Item,
        path: &KeyPath,
        to: &KeyPath,
        before: Option<usize>,
    ) -> Result<(), Message> {
        path.check().map_err(|error| error.wrong.message)?;
        let mut table = taken(root, path)?.unwrap_or_default();
        table.set_dotted(false);
        table.set_implicit(false);
        let array = self.at(root, to, true)?;
        let count = length(array).ok_or("this is not an array")?;
        let before = before.unwrap_or(count);
        if before > count {
            return Err(format!("this array has {count} items"));
        }
        put(array, before, &serde_json::Value::Object(serde_json::Map::new()))?;
        match array {
            Item::ArrayOfTables(tables) => {
                if let Some(place) = tables.get_mut(before) {
                    *place = table;
                }
                number_positions(tables);
            }
            other => {
                if let Some(place) = other.get_mut(before).and_then(Item::as_value_mut) {
                    let decor = place.decor().clone();
                    *place = Value::InlineTable(table.into_inline_table());
                    *place.decor_mut() = decor;
                }
            }
        }
        Ok(())
    }

    /// Adds the blank before `=` to a key that was a header and now has a value.
    fn blank_before_value(&mut self, root: &mut Item, path: &KeyPath) {
        let (above, key) = path.split_last();
        let table = match above {
            Some(above) => self.at(root, &above, false).ok(),
            None => Some(root),
        };
        if let Some(mut key) = table.and_then(Item::as_table_like_mut).and_then(|table| table.key_mut(key)) {
            key.leaf_decor_mut().set_suffix(" ");
        }
    }

    fn insert(
        &mut self,
        root: &mut Item,
        path: &KeyPath,
        before: Option<usize>,
        value: &serde_json::Value,
    ) -> Result<(), Message> {
        let array = self.at(root, path, true)?;
        let count = length(array).ok_or("this is not an array")?;
        let before = before.unwrap_or(count);
        if before > count {
            return Err(format!("this array has {count} items"));
        }
        put(array, before, value)
    }

    fn rearrange(&mut self, root: &mut Item, path: &KeyPath, from: usize, to: usize) -> Result<(), Message> {
        let array = self.at(root, path, true)?;
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
                let mut all = ArrayItems::of(values);
                let item = all.items.remove(from);
                all.items.insert(to, item);
                all.put_into(values);
            }
            _ => {}
        }
        Ok(())
    }
}

/// Takes a table out of the document; `None` if it is not there. An array whose last table it was goes with it.
fn taken(root: &mut Item, path: &KeyPath) -> Result<Option<Table>, Message> {
    if path.get(root).is_none() {
        return Ok(None);
    }
    let (above, last) = path.split_last();
    let parent = match &above {
        Some(above) => found(root, above),
        None => Some(&mut *root),
    };
    let item = match parent {
        Some(Item::ArrayOfTables(tables)) => index(last).filter(|at| *at < tables.len()).map(|at| {
            let table = tables.remove(at);
            number_positions(tables);
            Item::Table(table)
        }),
        Some(Item::Value(Value::Array(values))) => {
            index(last).filter(|at| *at < values.len()).map(|at| Item::Value(values.remove(at)))
        }
        Some(parent) => parent.as_table_like_mut().and_then(|table| table.remove(last)),
        None => None,
    };
    if let Some(above) = above.filter(|above| above.get(root).and_then(length) == Some(0)) {
        let (higher, name) = above.split_last();
        let holder = match &higher {
            Some(higher) => found(root, higher),
            None => Some(&mut *root),
        };
        holder.and_then(Item::as_table_like_mut).and_then(|table| table.remove(name));
    }
    match item {
        Some(Item::Table(table)) => Ok(Some(table)),
        Some(Item::Value(Value::InlineTable(table))) => Ok(Some(table.into_table())),
        Some(_) => Err("this is not a table".to_owned()),
        None => Ok(None),
    }
}

/// Returns the item at a path, if it exists.
fn found<'a>(root: &'a mut Item, path: &KeyPath) -> Option<&'a mut Item> {
    path.keys().try_fold(root, |item, key| match index(key).filter(|_| length(item).is_some()) {
        Some(at) => item.get_mut(at),
        None => item.get_mut(key),
    })
}

impl Tree for Item {
    fn shape(&self) -> Shape {
        match length(self) {
            Some(count) => Shape::Array(count),
            None if self.is_table_like() => Shape::Table,
            None => Shape::Value(match self.type_name() {
                "string" => "a string",
                "integer" | "float" => "a number",
                "boolean" => "true or false",
                "datetime" => "a date",
                other => other,
            }),
        }
    }

    fn child(&self, step: Step<'_>) -> Option<&Self> {
        match step {
            Step::Key(key) => self.get(key),
            Step::Index(index) => self.get(index),
        }
    }
}

impl Grow for Editor {
    type Tree = Item;

    fn child<'a>(&mut self, node: &'a mut Item, at: Position<'_>) -> Result<&'a mut Item, Message> {
        let in_table = node.is_table();
        let item = match at.step {
            Step::Index(index) => {
                if length(node) == Some(index) {
                    put(node, index, &serde_json::Value::Object(serde_json::Map::new()))?;
                }
                node.get_mut(index).ok_or("there is no such item")?
            }
            Step::Key(key) => {
                let table = node.as_table_like_mut().ok_or("the value above this key has no keys")?;
                table.entry(key).or_insert(Item::None)
            }
        };
        if item.is_none() {
            let given = self.preset.as_ref().and_then(|preset| at.path().get(preset.as_item()));
            *item = match given.filter(|_| at.array) {
                Some(given) => given.clone(),
                None if at.array => Item::Value(Value::Array(toml_edit::Array::new())),
                None if in_table => {
                    let mut table = Table::new();
                    // A header is written only if the table has keys.
                    table.set_implicit(true);
                    Item::Table(table)
                }
                None => Item::Value(Value::InlineTable(toml_edit::InlineTable::new())),
            };
        }
        Ok(item)
    }
}

/// Replaces a value by another in the same layout. Keys and items that stay keep their comments.
fn replace(old: &mut Item, value: &serde_json::Value, in_table: bool) -> Result<(), Message> {
    let count = length(old).unwrap_or_default();
    let is_inline = old.is_value();
    let fits = |items: &[serde_json::Value]| {
        count > 0 && !items.is_empty() && (is_inline || items.iter().all(serde_json::Value::is_object))
    };
    match (&mut *old, value) {
        (Item::Table(table), serde_json::Value::Object(keys)) => return merge(table, keys),
        (_, serde_json::Value::Array(items)) if fits(items) => return merge_items(old, items),
        _ => {}
    }
    let as_table = if old.is_none() { in_table } else { old.is_table() || old.is_array_of_tables() };
    let mut new = item(value, as_table)?;
    if let (Item::Value(new), Item::Value(old)) = (&mut new, &*old) {
        *new.decor_mut() = old.decor().clone()
    }
    *old = new;
    Ok(())
}

/// Makes the keys of a table those of a value.
fn merge(table: &mut Table, keys: &serde_json::Map<String, serde_json::Value>) -> Result<(), Message> {
    let gone: Vec<String> =
        table.iter().map(|(key, _)| key.to_owned()).filter(|key| !keys.contains_key(key)).collect();
    gone.iter().for_each(|key| drop(table.remove(key)));
    for (key, value) in keys {
        match table.get_mut(key) {
            Some(old) if is_equal(old, value) => {}
            Some(old) => replace(old, value, true)?,
            None => drop(table.insert(key, item(value, !layout::is_short(value))?)),
        }
    }
    table.set_implicit(false);
    Ok(())
}

#[cfg(test)]
mod tests;
