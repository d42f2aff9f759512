//! Layout of new values, and order of tables.

use toml_edit::{Array, ArrayOfTables, InlineTable, Item, Table, Value};

/// Largest number of plain values of a table on one line.
const SHORT: usize = 4;

/// Converts a value to TOML; with `as_table`, a table or an array of tables gets a header.
pub(super) fn item(value: &serde_json::Value, as_table: bool) -> Result<Item, String> {
    use serde_json::Value as Json;
    match value {
        Json::Object(keys) if as_table => {
            let mut table = Table::new();
            for (key, value) in in_order(keys) {
                table.insert(key, item(value, !is_short(value))?);
            }
            Ok(Item::Table(table))
        }
        Json::Array(items) if as_table && !items.is_empty() && items.iter().all(Json::is_object) => {
            let mut tables = ArrayOfTables::new();
            for value in items {
                if let Item::Table(table) = item(value, true)? {
                    tables.push(table);
                }
            }
            Ok(Item::ArrayOfTables(tables))
        }
        _ => inline(value).map(Item::Value),
    }
}

/// Keys in the order in which a table is written: those first that determine which others it may have.
fn in_order(
    keys: &serde_json::Map<String, serde_json::Value>,
) -> impl Iterator<Item = (&String, &serde_json::Value)> {
    const FIRST: [&str; 2] = ["kind", "model"];
    let first = FIRST.iter().filter_map(|key| keys.get_key_value(*key));
    first.chain(keys.iter().filter(|(key, _)| !FIRST.contains(&key.as_str())))
}

/// True for a value that is short enough for one line.
pub(super) fn is_short(value: &serde_json::Value) -> bool {
    use serde_json::Value as Json;
    let plain = |value: &Json| !value.is_object() && !value.is_array();
    match value {
        Json::Object(keys) => keys.len() <= SHORT && keys.values().all(plain),
        Json::Array(items) => items.iter().all(is_short),
        _ => true,
    }
}

fn inline(value: &serde_json::Value) -> Result<Value, String> {
    use serde_json::Value as Json;
    Ok(match value {
        Json::Null => return Err("null is not a value; use `remove` to remove a key".to_owned()),
        Json::Bool(value) => (*value).into(),
        Json::String(text) => text.as_str().into(),
        Json::Number(number) => match (number.as_i64(), number.as_f64()) {
            (Some(whole), _) => whole.into(),
            (None, Some(value)) if value.is_finite() => value.into(),
            _ => return Err(format!("{number} is not a number that a scenario can have")),
        },
        Json::Array(items) => {
            let mut array = items.iter().map(inline).collect::<Result<Array, _>>()?;
            if items.len() > 1 && items.iter().any(Json::is_object) {
                array.iter_mut().for_each(|value| value.decor_mut().set_prefix("\n  "));
                array.set_trailing("\n");
                array.set_trailing_comma(true);
            }
            array.into()
        }
        Json::Object(keys) => {
            let pairs = in_order(keys).map(|(key, value)| Ok((key.as_str(), inline(value)?)));
            pairs.collect::<Result<InlineTable, String>>()?.into()
        }
    })
}

/// True if an item has a value.
pub(super) fn is_equal(item: &Item, value: &serde_json::Value) -> bool {
    use serde_json::Value as Json;
    match (item, value) {
        (Item::Value(own), _) => is_equal_value(own, value),
        (Item::Table(table), Json::Object(keys)) => {
            let same = |(key, item): (&str, &Item)| keys.get(key).is_some_and(|value| is_equal(item, value));
            table.len() == keys.len() && table.iter().all(same)
        }
        (Item::ArrayOfTables(tables), Json::Array(items)) => {
            let same = |(table, value): (&Table, &Json)| is_equal(&Item::Table(table.clone()), value);
            tables.len() == items.len() && tables.iter().zip(items).all(same)
        }
        _ => false,
    }
}

fn is_equal_value(own: &Value, value: &serde_json::Value) -> bool {
    use serde_json::Value as Json;
    match (own, value) {
        (Value::String(own), Json::String(text)) => own.value() == text,
        (Value::Integer(own), Json::Number(number)) => number.as_i64() == Some(*own.value()),
        (Value::Float(own), Json::Number(number)) => number.as_f64() == Some(*own.value()),
        (Value::Boolean(own), Json::Bool(value)) => own.value() == value,
        (Value::Array(own), Json::Array(items)) => {
            own.len() == items.len() && own.iter().zip(items).all(|(own, value)| is_equal_value(own, value))
        }
        (Value::InlineTable(own), Json::Object(keys)) => {
            let same =
                |(key, own): (&str, &Value)| keys.get(key).is_some_and(|value| is_equal_value(own, value));
            own.len() == keys.len() && own.iter().all(same)
        }
        _ => false,
    }
}

/// Assigns the positions of the tables in the text to the tables in their new order; new tables follow the
/// one before.
pub(super) fn number_positions(tables: &mut ArrayOfTables) {
    let mut places: Vec<isize> = tables.iter().filter_map(Table::position).collect();
    places.sort_unstable();
    let mut places = places.into_iter();
    for table in tables.iter_mut() {
        forget_positions(table);
        table.set_position(places.next());
    }
}

/// Removes the positions of a table and all tables in it, which then follow the table before.
pub(super) fn forget_positions(table: &mut Table) {
    table.set_position(None);
    for (_, item) in table.iter_mut() {
        match item {
            Item::Table(table) => forget_positions(table),
            Item::ArrayOfTables(tables) => tables.iter_mut().for_each(forget_positions),
            _ => {}
        }
    }
}
