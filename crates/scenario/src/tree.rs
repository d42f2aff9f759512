//! A TOML document whose every key and value knows where it stands.

use std::ops::Range;

use toml::de::{DeTable, DeValue};
use toml::{Spanned, de::DeString};

use crate::error::Errors;
use crate::problem::Problem;
use crate::renamed::present;
use crate::source::Origin;

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
    /// In the order of the text.
    Table(Vec<Entry>),
}

/// A key of a table and what it holds.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) key: String,
    pub(crate) key_origin: Origin,
    pub(crate) node: Node,
}

/// No more syntax errors than this are worth reading at once: one often makes the next.
const MOST_SYNTAX_ERRORS: usize = 3;

impl Node {
    /// Parses a whole document; syntax errors go to `errors`.
    pub(crate) fn parse_document(text: &str, errors: &mut Errors) -> Self {
        let (table, found) = DeTable::parse_recoverable(text);
        let is_scenario = text.lines().any(is_toml);
        for error in found.iter().take(if is_scenario { MOST_SYNTAX_ERRORS } else { 1 }) {
            let span = error.span().unwrap_or(0..text.len());
            let origin = Origin { source: 0, start: span.start, end: span.end.max(span.start + 1) };
            let (origin, problem) = match is_scenario {
                true => syntax(text, origin, error.message()),
                false => (origin, Problem::NotAScenario),
            };
            let is_clear = !matches!(problem, Problem::Syntax { .. });
            errors.push(origin, problem);
            if is_clear {
                break;
            }
        }
        let value = Value::from_table(table.get_ref(), 0, 0);
        Self { origin: Origin::FILE, value }
    }

    /// A table without keys.
    pub(crate) fn empty_table() -> Self {
        Self { origin: Origin::FILE, value: Value::Table(Vec::new()) }
    }

    /// Parses `text[at..]` of a source as one value. Numbers may be spelt as in a shell
    /// (`.5`, `5.`). A text that is no value is a string, unless it begins as an array, a table or a quoted string does.
    pub(crate) fn parse_value(text: &str, at: usize, source: usize, errors: &mut Errors) -> Self {
        let rest = text.get(at..).unwrap_or_default();
        let value = match (DeValue::parse(rest), shell_number(rest)) {
            (Ok(value), _) => Value::from_value(value.get_ref(), source, at),
            (Err(_), Some(number)) => Value::Float(number),
            (Err(error), None) => {
                if rest.trim_start().starts_with(['{', '[', '"', '\'']) {
                    let span = error.span().unwrap_or(0..rest.len());
                    let problem = Problem::Syntax { message: error.message().to_owned() };
                    errors.push(origin(span, source, at), problem);
                }
                Value::Text(rest.to_owned())
            }
        };
        Self { origin: Origin { source, start: at, end: text.len() }, value }
    }

    /// The same values, all at one place.
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

    /// What is under `key`, if this is a table that has it.
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        match &self.value {
            Value::Table(entries) => entries.iter().find(|entry| entry.key == key).map(|entry| &entry.node),
            _ => None,
        }
    }

    /// What is at a dotted path, arrays by index from 0; this tree has the present names, the path may have old ones.
    pub(crate) fn at(&self, path: &str) -> Option<&Self> {
        let path: Vec<&str> = path.split('.').map(str::trim).collect();
        present(&path).into_iter().try_fold(self, |node, key| match &node.value {
            Value::Array(items) => items.get(key.parse::<usize>().ok()?),
            _ => node.get(key),
        })
    }

    /// Where what is at a dotted path stands, or the nearest that holds it.
    pub(crate) fn place_of(&self, path: &str) -> Origin {
        let ends = path.match_indices('.').map(|(at, _)| at).chain([path.len()]);
        let there = ends.map_while(|end| self.at(&path[..end])).last();
        there.map_or(Origin::FILE, |node| node.origin)
    }

    /// Takes a key out of a table, if this is one that has it.
    pub(crate) fn remove(&mut self, key: &str) {
        if let Value::Table(entries) = &mut self.value {
            entries.retain(|entry| entry.key != key);
        }
    }

    /// The path of the shortest stretch of the text that holds `origin`, as of `--set`.
    pub(crate) fn path_to(&self, origin: Origin) -> Option<String> {
        let mut best: Option<(usize, String)> = None;
        self.narrow(String::new(), origin, &mut best);
        best.map(|(_, path)| path)
    }

    /// Looks for a shorter stretch in here. A table's header does not hold its keys, so all are looked at.
    fn narrow(&self, path: String, origin: Origin, best: &mut Option<(usize, String)>) {
        let mut look = |at: &Origin, path: &str| {
            let length = at.end - at.start;
            let holds = at.start <= origin.start && origin.end <= at.end && length > 0;
            if holds && best.as_ref().is_none_or(|(shortest, _)| length <= *shortest) {
                *best = Some((length, path.to_owned()));
            }
        };
        look(&self.origin, &path);
        let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
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

    /// Takes every key of `other` that is missing here, all the way down; arrays count as one value. True if there
    /// was one.
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

    /// What kind of value it is, in words.
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

/// What a syntax error means and where it is, where the parser's words mislead.
fn syntax(text: &str, origin: Origin, message: &str) -> (Origin, Problem) {
    let start = text.get(..origin.start).and_then(|before| before.rfind('\n')).map_or(0, |i| i + 1);
    let before = text.get(start..origin.start).unwrap_or_default();
    let line = text.get(start..).and_then(|rest| rest.lines().next()).unwrap_or_default();
    // The parser points at the unit alone, or at the number too.
    let found = text.get(origin.start..origin.end).unwrap_or_default();
    let begun = before.rsplit(['=', '[', '{', ',']).next().unwrap_or_default();
    if let Some(unit) = unit_of(format!("{begun}{found}").trim()) {
        return (origin, Problem::NumberWithUnit(unit.to_owned()));
    }
    if let Some(number) = decimal_comma(line) {
        let number = Origin { start: start + number.start, end: start + number.end, ..origin };
        return (number, Problem::DecimalComma);
    }
    if message.contains("boolean") || message.contains("quoted") {
        return (origin, Problem::NotAValue);
    }
    (origin, Problem::Syntax { message: message.to_owned() })
}

/// The letters or percent sign behind a number, if there is nothing else.
fn unit_of(text: &str) -> Option<&str> {
    let number_ends = text.find(|c: char| !c.is_ascii_digit() && !"+-._".contains(c))?;
    let (number, unit) = (text[..number_ends].replace('_', ""), text[number_ends..].trim());
    let is_unit = unit.chars().count() <= 12
        && unit.starts_with(|c: char| c.is_alphabetic() || "%°".contains(c))
        && unit.chars().all(|c| c.is_alphanumeric() || "%°/".contains(c));
    (number.parse::<f64>().is_ok() && is_unit).then_some(unit)
}

/// Where a value such as `0,493` stands in a line.
fn decimal_comma(line: &str) -> Option<Range<usize>> {
    let mut values = line.match_indices('=').filter_map(|(i, _)| line.get(i + 1..));
    values.find_map(|rest| {
        let value = rest.trim_start();
        let (whole, behind) = value.split_once(',')?;
        let digits = behind.len() - behind.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let start = line.len() - value.len();
        (digits > 0 && whole.parse::<f64>().is_ok()).then_some(start..start + whole.len() + 1 + digits)
    })
}

/// True if a line is a key with its value, or the head of a table.
fn is_toml(line: &str) -> bool {
    let is_key = |key: &str| {
        let key = key.trim();
        !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || "_-. \"'".contains(c))
    };
    line.trim_start().starts_with('[') || line.split_once('=').is_some_and(|(key, _)| is_key(key))
}

/// A number as other languages spell it: `.5`, `5.`, `+.5`.
fn shell_number(text: &str) -> Option<f64> {
    let text = text.trim();
    // Words such as "inf" have no point, and remain words.
    if text.contains('.') { text.parse().ok() } else { None }
}
