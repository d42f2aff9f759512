//! TOML documents in which every key and value has its place in the text.

use std::ops::Range;

use toml::de::{DeTable, DeValue};
use toml::{Spanned, de::DeString};

use papilio_diagnostics::Diagnostic;

use crate::mistake;
use crate::origin::Origin;
use crate::path::{KeyPath, Shape, Step, Tree, with_key};

/// A value and its place.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) origin: Origin,
    pub(crate) value: Value,
}

/// A TOML value.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    Bool(bool),
    Integer(i64),
    Float(f64),
    Text(String),
    DateTime,
    Array(Vec<Node>),
    /// Entries in the order of the text.
    Table(Vec<Entry>),
}

/// A key of a table and its value.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) key: String,
    pub(crate) key_origin: Origin,
    pub(crate) node: Node,
}

/// Largest number of syntax errors that are reported: one often causes the next.
const MOST_SYNTAX_ERRORS: usize = 3;

impl Node {
    /// Parses a whole document. Returns the part that can be read, and the syntax errors with their places.
    pub(crate) fn parse_document(text: &str) -> (Self, Vec<(Origin, Diagnostic)>) {
        let (table, found) = DeTable::parse_recoverable(text);
        let is_scenario = text.lines().any(is_toml);
        let mut wrong = Vec::new();
        for error in found.iter().take(if is_scenario { MOST_SYNTAX_ERRORS } else { 1 }) {
            let span = error.span().unwrap_or(0..text.len());
            let origin = Origin { source: 0, start: span.start, end: span.end.max(span.start + 1) };
            let known = if is_scenario {
                known_mistake(text, origin, error.message())
            } else {
                Some((origin, not_toml()))
            };
            let is_clear = known.is_some();
            wrong.push(known.unwrap_or_else(|| (origin, mistake::syntax(error.message()))));
            if is_clear {
                break;
            }
        }
        let value = Value::from_table(table.get_ref(), 0, 0);
        (Self { origin: Origin::FILE, value }, wrong)
    }

    /// A table without keys.
    pub(crate) fn empty_table() -> Self {
        Self { origin: Origin::FILE, value: Value::Table(Vec::new()) }
    }

    /// Parses `text[at..]` of a source as one value. Numbers may be written as in a shell
    /// (`.5`, `5.`). A text that is not a value is a string; if it begins like an array, a table or a quoted
    /// string, it is also a syntax error.
    pub(crate) fn parse_value(text: &str, at: usize, source: usize) -> (Self, Option<(Origin, Diagnostic)>) {
        let rest = text.get(at..).unwrap_or_default();
        let mut wrong = None;
        let value = match (DeValue::parse(rest), shell_number(rest)) {
            (Ok(value), _) => Value::from_value(value.get_ref(), source, at),
            (Err(_), Some(number)) => Value::Float(number),
            (Err(error), None) => {
                if rest.trim_start().starts_with(['{', '[', '"', '\'']) {
                    let span = error.span().unwrap_or(0..rest.len());
                    let syntax = match has_range(rest) {
                        true => Diagnostic::new("a range is not a value of TOML").hint(
                            "write { from = 190, to = 194, step = 1 }, or \"190:194:1\" in quotes without brackets, where the values of an axis are \
                             expected; `papilio sweep FILE --axis KEY=190:194:1` needs no quotes",
                        ),
                        false => mistake::syntax(error.message()),
                    };
                    wrong = Some((origin(span, source, at), syntax));
                }
                Value::Text(rest.to_owned())
            }
        };
        (Self { origin: Origin { source, start: at, end: text.len() }, value }, wrong)
    }

    /// Moves all values to one place.
    pub(crate) fn moved_to(mut self, origin: Origin) -> Self {
        self.origin = origin;
        match &mut self.value {
            Value::Array(items) => {
                *items = std::mem::take(items).into_iter().map(|item| item.moved_to(origin)).collect();
            }
            Value::Table(entries) => {
                for entry in entries {
                    entry.key_origin = origin;
                    let empty = Self { origin, value: Value::DateTime };
                    entry.node = std::mem::replace(&mut entry.node, empty).moved_to(origin);
                }
            }
            _ => {}
        }
        self
    }

    /// Returns the value of `key`, if this is a table that has it.
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        match &self.value {
            Value::Table(entries) => entries.iter().find(|entry| entry.key == key).map(|entry| &entry.node),
            _ => None,
        }
    }

    /// Returns the value at a path.
    pub(crate) fn at(&self, path: &str) -> Option<&Self> {
        KeyPath::new(path).get(self)
    }

    /// Returns whether it is this text.
    pub(crate) fn is_text(&self, text: &str) -> bool {
        matches!(&self.value, Value::Text(own) if own == text)
    }

    /// Returns the place of the value at a path, or of the nearest table or array above it.
    pub(crate) fn place_of(&self, path: &str) -> Origin {
        let there = KeyPath::new(path).prefixes().map_while(|path| path.get(self)).last();
        there.map_or(Origin::FILE, |node| node.origin)
    }

    /// Returns the number of the first keys of a path that exist.
    pub(crate) fn depth_of(&self, path: &str) -> usize {
        KeyPath::new(path).prefixes().map_while(|path| path.get(self)).count()
    }

    /// Removes a key, if this is a table that has it.
    pub(crate) fn remove(&mut self, key: &str) {
        if let Value::Table(entries) = &mut self.value {
            entries.retain(|entry| entry.key != key);
        }
    }

    /// Returns the path of the shortest range of the text that contains `origin`, as in `--set`.
    pub(crate) fn path_to(&self, origin: Origin) -> Option<String> {
        let mut best: Option<(usize, String)> = None;
        self.narrow(String::new(), origin, &mut best);
        best.map(|(_, path)| path)
    }

    /// Searches this node for a shorter range. All keys are searched, because the range of a table does not
    /// contain them.
    fn narrow(&self, path: String, origin: Origin, best: &mut Option<(usize, String)>) {
        let mut look = |at: &Origin, path: &str| {
            let length = at.end - at.start;
            let holds = at.start <= origin.start && origin.end <= at.end && length > 0;
            if holds && best.as_ref().is_none_or(|(shortest, _)| length <= *shortest) {
                *best = Some((length, path.to_owned()));
            }
        };
        look(&self.origin, &path);
        let below = |key: &str| with_key(&path, key);
        match &self.value {
            Value::Array(items) => {
                for (i, item) in items.iter().enumerate() {
                    item.narrow(below(&i.to_string()), origin, best);
                }
            }
            Value::Table(entries) => {
                for entry in entries {
                    look(&entry.key_origin, &below(&entry.key));
                }
                for entry in entries {
                    entry.node.narrow(below(&entry.key), origin, best);
                }
            }
            _ => {}
        }
    }

    /// Adds every key of `other` that is missing here, at all depths; arrays count as one value. Returns true
    /// if there was one.
    pub(crate) fn fill_from(&mut self, other: Self) -> bool {
        let (Value::Table(mine), Value::Table(theirs)) = (&mut self.value, other.value) else { return false };
        let mut any = false;
        for entry in theirs {
            match mine.iter_mut().find(|own| own.key == entry.key) {
                Some(own) => any |= own.node.fill_from(entry.node),
                None => {
                    any = true;
                    mine.push(entry);
                }
            }
        }
        any
    }

    /// Type of the value in words.
    pub(crate) fn kind(&self) -> &'static str {
        match &self.value {
            Value::Bool(_) => "true or false",
            Value::Integer(_) | Value::Float(_) => "a number",
            Value::Text(_) => "a string",
            Value::DateTime => "a date",
            Value::Array(_) => "an array",
            Value::Table(_) => "a table",
        }
    }
}

impl Tree for Node {
    fn shape(&self) -> Shape {
        match &self.value {
            Value::Table(_) => Shape::Table,
            Value::Array(items) => Shape::Array(items.len()),
            _ => Shape::Value(self.kind()),
        }
    }

    fn child(&self, step: Step<'_>) -> Option<&Self> {
        match (&self.value, step) {
            (Value::Array(items), Step::Index(index)) => items.get(index),
            (_, Step::Key(key)) => self.get(key),
            _ => None,
        }
    }
}

impl Value {
    fn from_table(table: &DeTable<'_>, source: usize, offset: usize) -> Self {
        let mut entries: Vec<Entry> =
            table.iter().map(|(key, value)| Entry::new(key, value, source, offset)).collect();
        entries.sort_by_key(|entry| entry.key_origin);
        Self::Table(entries)
    }

    fn from_value(value: &DeValue<'_>, source: usize, offset: usize) -> Self {
        match value {
            DeValue::String(text) => Self::Text(text.to_string()),
            DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
                Ok(value) => Self::Integer(value),
                Err(_) => Self::Float(digits.as_str().parse().unwrap_or(f64::INFINITY)),
            },
            DeValue::Float(digits) => Self::Float(digits.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(value) => Self::Bool(*value),
            DeValue::Datetime(_) => Self::DateTime,
            DeValue::Array(items) => {
                let node = |item: &Spanned<DeValue<'_>>| Node {
                    origin: origin(item.span(), source, offset),
                    value: Self::from_value(item.get_ref(), source, offset),
                };
                Self::Array(items.iter().map(node).collect())
            }
            DeValue::Table(table) => Self::from_table(table, source, offset),
        }
    }
}

impl Entry {
    fn new(key: &Spanned<DeString<'_>>, value: &Spanned<DeValue<'_>>, source: usize, offset: usize) -> Self {
        let node = Node {
            origin: origin(value.span(), source, offset),
            value: Value::from_value(value.get_ref(), source, offset),
        };
        Self { key: key.get_ref().to_string(), key_origin: origin(key.span(), source, offset), node }
    }
}

fn origin(span: Range<usize>, source: usize, offset: usize) -> Origin {
    Origin { source, start: span.start + offset, end: span.end + offset }
}

/// Error: the text has no line of TOML.
fn not_toml() -> Diagnostic {
    Diagnostic::new("this does not look like a scenario (TOML)").hint(
        "a scenario has lines such as `title = \"Indoor\"` and `[display.pixel]`; scenarios/ holds examples",
    )
}

/// Returns a better message and place for syntax errors whose message by the parser is misleading.
fn known_mistake(text: &str, origin: Origin, message: &str) -> Option<(Origin, Diagnostic)> {
    let start = text.get(..origin.start).and_then(|before| before.rfind('\n')).map_or(0, |i| i + 1);
    let before = text.get(start..origin.start).unwrap_or_default();
    let line = text.get(start..).and_then(|rest| rest.lines().next()).unwrap_or_default();
    // The parser marks either the unit alone, or the number too.
    let found = text.get(origin.start..origin.end).unwrap_or_default();
    let begun = before.rsplit(['=', '[', '{', ',']).next().unwrap_or_default();
    if let Some(unit) = unit_of(format!("{begun}{found}").trim()) {
        let hint = match unit {
            "%" => "fractions are relative to 1: write 78 % as 0.78",
            _ => "write the number without a unit: the unit is in the key's name",
        };
        let wrong = Diagnostic::new(format!("units are not allowed in values (found `{unit}`)"));
        return Some((origin, wrong.expected("a number without a unit").hint(hint)));
    }
    if let Some(number) = decimal_comma(line) {
        let number = Origin { start: start + number.start, end: start + number.end, ..origin };
        let wrong =
            Diagnostic::new("this number has a decimal comma").expected("a number with a decimal point");
        return Some((
            number,
            wrong.hint("write decimals with a point: 0.5; and lists in brackets: [8, 20]"),
        ));
    }
    if message.contains("boolean") || message.contains("quoted") {
        let wrong = Diagnostic::new("this is not a value")
            .expected("a number, true, false, or a string in double quotes")
            .hint("write strings in double quotes");
        return Some((origin, wrong));
    }
    None
}

/// Returns the letters or percent sign after a number, if there is nothing else.
fn unit_of(text: &str) -> Option<&str> {
    let number_ends = text.find(|c: char| !c.is_ascii_digit() && !"+-._".contains(c))?;
    let (number, unit) = (text[..number_ends].replace('_', ""), text[number_ends..].trim());
    let is_unit = unit.chars().count() <= 12
        && unit.starts_with(|c: char| c.is_alphabetic() || "%°".contains(c))
        && unit.chars().all(|c| c.is_alphanumeric() || "%°/".contains(c));
    (number.parse::<f64>().is_ok() && is_unit).then_some(unit)
}

/// Returns the range of a value such as `0,493` in a line.
fn decimal_comma(line: &str) -> Option<Range<usize>> {
    let mut values = line.match_indices('=').filter_map(|(i, _)| line.get(i + 1..));
    values.find_map(|rest| {
        let value = rest.trim_start();
        // A number ends within a few characters: a search for the comma would read the whole line for each
        // `=`.
        let end = value.find(|c: char| !(c.is_ascii_alphanumeric() || "+-.".contains(c)))?;
        let (whole, behind) = (&value[..end], value[end..].strip_prefix(',')?);
        let digits = behind.len() - behind.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let start = line.len() - value.len();
        (digits > 0 && whole.parse::<f64>().is_ok()).then_some(start..start + whole.len() + 1 + digits)
    })
}

/// True if a line is a key with its value, or the header of a table.
fn is_toml(line: &str) -> bool {
    let is_key = |key: &str| {
        let key = key.trim();
        !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || "_-. \"'".contains(c))
    };
    line.trim_start().starts_with('[') || line.split_once('=').is_some_and(|(key, _)| is_key(key))
}

/// Reads a number as other languages write it: `.5`, `5.`, `+.5`.
fn shell_number(text: &str) -> Option<f64> {
    let text = text.trim();
    // Words such as "inf" have no point and stay words.
    if text.contains('.') { text.parse().ok() } else { None }
}

/// Returns whether a text that is not TOML has a range such as `190:194:1`.
fn has_range(text: &str) -> bool {
    let is_outside = |c: char| !(c.is_ascii_digit() || ".:+-eE".contains(c));
    text.split(is_outside).any(|word| {
        word.matches(':').count() == 2 && word.split(':').all(|number| number.parse::<f64>().is_ok())
    })
}
