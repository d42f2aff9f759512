//! Items of arrays, and tables of arrays of tables, put in, taken out and compared one by one.

use toml_edit::{Item, Value};

use super::comments::{self, comments_of};
use super::items::{ArrayItem, ArrayItems};
use super::layout::{is_equal, item, number_positions};
use super::{Message, replace};

/// Makes the items of an array those of a value: items at both ends that are equal stay, those between are replaced in order.
pub(super) fn merge_items(array: &mut Item, items: &[serde_json::Value]) -> Result<(), Message> {
    let is_equal_at = |array: &Item, at: usize, value| array.get(at).is_some_and(|old| is_equal(old, value));
    let count = length(array).unwrap_or_default();
    let shorter = count.min(items.len());
    let first = (0..shorter).take_while(|at| is_equal_at(array, *at, &items[*at])).count();
    let from_end = |back: &usize| is_equal_at(array, count - 1 - back, &items[items.len() - 1 - back]);
    let last = (0..shorter - first).take_while(from_end).count();
    let (old, new) = (count - first - last, items.len() - first - last);
    let (replaced, added) = items[first..first + new].split_at(old.min(new));
    for (at, item) in (first..).zip(replaced) {
        if let Some(place) = array.get_mut(at) {
            replace(place, item, false)?;
        }
    }
    for _ in new..old {
        take(array, first + new);
    }
    for (at, item) in (first + replaced.len()..).zip(added) {
        put(array, at, item)?;
    }
    Ok(())
}

/// Inserts an item into an array, at an index from 0 to its length.
pub(super) fn put(array: &mut Item, at: usize, value: &serde_json::Value) -> Result<(), Message> {
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
            let Item::Value(value) = item(value, false)? else {
                return Err("a table is not allowed here".to_owned());
            };
            let mut all = ArrayItems::of(values);
            let lead = Some(all.lead_at(at));
            all.items.insert(at, ArrayItem { value, lead, tail: String::new() });
            all.put_into(values);
        }
        _ => return Err("this is not an array".to_owned()),
    }
    Ok(())
}

/// Removes an item of an array, and returns its comments.
pub(super) fn take(array: &mut Item, at: usize) -> Vec<String> {
    match array {
        Item::ArrayOfTables(tables) => {
            let table = tables.remove(at);
            number_positions(tables);
            comments_of(&Item::Table(table))
        }
        Item::Value(Value::Array(values)) => {
            let mut all = ArrayItems::of(values);
            let item = all.items.remove(at);
            all.put_into(values);
            let around = [item.lead.unwrap_or_default(), item.tail];
            let around =
                around.iter().flat_map(|text| comments::comments(text)).map(|(_, one)| one.to_owned());
            let mut removed: Vec<String> = around.collect();
            comments::collect_value(&item.value, &mut removed);
            removed
        }
        _ => Vec::new(),
    }
}

/// Returns the number of items of an array; `None` for other items.
pub(super) fn length(item: &Item) -> Option<usize> {
    match item {
        Item::ArrayOfTables(tables) => Some(tables.len()),
        Item::Value(Value::Array(values)) => Some(values.len()),
        _ => None,
    }
}
