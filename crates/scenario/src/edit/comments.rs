//! Comments that an edit would lose: they stay in the text, as lines of their own where they were.

use std::collections::HashMap;

use toml_edit::{Decor, Item, RawString, Table, Value};

/// The comments of a text with the numbers of their lines.
pub(super) fn comments(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let (mut at, mut line) = (0, 0);
    while let Some(rest) = text.get(at..).filter(|rest| !rest.is_empty()) {
        let length = match rest.as_bytes()[0] {
            b'#' => {
                let length = rest.find('\n').unwrap_or(rest.len());
                found.push((line, rest[..length].trim_end()));
                length
            }
            b'"' | b'\'' => string_length(rest),
            _ => rest.chars().next().map_or(1, char::len_utf8),
        };
        line += rest[..length].matches('\n').count();
        at += length;
    }
    found
}

/// Length of the string at the beginning of a text, with its quotation marks.
fn string_length(text: &str) -> usize {
    let quote = &text[..1];
    let triple = quote.repeat(3);
    let end = if text.starts_with(&triple) { triple.as_str() } else { quote };
    let mut at = end.len();
    while let Some(rest) = text.get(at..).filter(|rest| !rest.is_empty()) {
        if let Some(after) = rest.strip_prefix(end) {
            // Two quotation marks more may belong to the string.
            let more = after.chars().take_while(|sign| end.len() == 3 && quote.starts_with(*sign));
            return at + end.len() + more.take(2).count();
        }
        let escaped = quote == "\"" && rest.starts_with('\\');
        at += rest.chars().take(if escaped { 2 } else { 1 }).map(char::len_utf8).sum::<usize>();
    }
    text.len()
}

/// The comments of an item, which leave the text with it.
pub(super) fn comments_of(item: &Item) -> Vec<String> {
    let mut found = Vec::new();
    collect(item, &mut found);
    found
}

fn collect(item: &Item, found: &mut Vec<String>) {
    match item {
        Item::None => {}
        Item::Value(value) => collect_value(value, found),
        Item::Table(table) => collect_table(table, found),
        Item::ArrayOfTables(tables) => tables.iter().for_each(|table| collect_table(table, found)),
    }
}

fn collect_table(table: &Table, found: &mut Vec<String>) {
    collect_decor(table.decor(), found);
    for (name, item) in table {
        if let Some(key) = table.key(name) {
            collect_decor(key.leaf_decor(), found);
            collect_decor(key.dotted_decor(), found);
        }
        collect(item, found);
    }
}

pub(super) fn collect_value(value: &Value, found: &mut Vec<String>) {
    collect_decor(value.decor(), found);
    match value {
        Value::Array(array) => {
            array.iter().for_each(|value| collect_value(value, found));
            collect_raw(Some(array.trailing()), found);
        }
        Value::InlineTable(table) => {
            for (name, value) in table {
                if let Some(key) = table.key(name) {
                    collect_decor(key.leaf_decor(), found);
                }
                collect_value(value, found);
            }
            collect_raw(Some(table.trailing()), found);
        }
        _ => {}
    }
}

fn collect_decor(decor: &Decor, found: &mut Vec<String>) {
    collect_raw(decor.prefix(), found);
    collect_raw(decor.suffix(), found);
}

fn collect_raw(text: Option<&RawString>, found: &mut Vec<String>) {
    let text = text.and_then(RawString::as_str).unwrap_or_default();
    found.extend(comments(text).into_iter().map(|(_, comment)| comment.to_owned()));
}

/// Returns the text after an edit with the comments of the text before it that it lacks, except those of
/// removed items.
pub(super) fn with_comments(before: &str, after: String, removed: &[String]) -> String {
    let lost = lost(before, &after, removed);
    if lost.is_empty() {
        return after;
    }
    let old: Vec<&str> = before.lines().collect();
    let mut now = after;
    // From the last to the first, so that the places of those before stay the same.
    let blocks = blocks(&old, &now, lost);
    for (place, block) in blocks.into_iter().rev() {
        now = inserted(&now, place, &block);
    }
    now
}

/// The comments that are in the text before, but not in the text after.
fn lost(before: &str, after: &str, removed: &[String]) -> Vec<(usize, String)> {
    let mut left: HashMap<String, usize> = HashMap::new();
    let there = comments(after).into_iter().map(|(_, comment)| comment.to_owned());
    for comment in there.chain(removed.iter().cloned()) {
        *left.entry(comment).or_default() += 1;
    }
    let mut lost = Vec::new();
    for (line, comment) in comments(before) {
        match left.get_mut(comment).filter(|count| **count > 0) {
            Some(count) => *count -= 1,
            None => lost.push((line, comment.to_owned())),
        }
    }
    lost
}

/// The lines of the text after at which comments are inserted, in ascending order: before the next line of
/// the text before that is there, and at the end of the table above.
fn blocks(old: &[&str], after: &str, lost: Vec<(usize, String)>) -> Vec<(usize, Vec<String>)> {
    let new: Vec<&str> = after.lines().collect();
    let same = old.iter().zip(&new).take_while(|(old, new)| old == new).count();
    let mut blocks: Vec<(usize, Vec<String>)> = Vec::new();
    for (line, comment) in lost {
        let next = old[line..].iter().skip(1).filter(|text| !text.trim().is_empty()).find_map(|text| {
            new.iter().skip(same).position(|other| other == text).map(|number| number + same)
        });
        let mut place = next.unwrap_or(new.len());
        while place > same && new[place - 1].trim().is_empty() {
            place -= 1;
        }
        let indent: String = old[line].chars().take_while(|sign| *sign == ' ' || *sign == '\t').collect();
        let text = format!("{indent}{comment}");
        // Comments stay in their order.
        let place = blocks.last().map_or(place, |(before, _)| place.max(*before));
        match blocks.last_mut().filter(|(before, _)| *before == place) {
            Some((_, block)) => block.push(text),
            None => blocks.push((place, vec![text])),
        }
    }
    blocks
}

/// Inserts lines before a line, or before the next one where they are comments and change nothing; at the
/// top, nothing can change.
fn inserted(text: &str, place: usize, block: &[String]) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let meaning = toml::from_str::<toml::Table>(text).ok();
    let block = block.join("\n");
    for place in (place..=lines.len()).chain([0]) {
        let (above, below) = lines.split_at(place);
        let parts = [above.join("\n"), block.clone(), below.join("\n")];
        let parts: Vec<&str> = parts.iter().map(String::as_str).filter(|part| !part.is_empty()).collect();
        let candidate = parts.join("\n") + "\n";
        let is_same = toml::from_str::<toml::Table>(&candidate).ok() == meaning;
        let has_all = comments(&candidate).len() == comments(text).len() + block.lines().count();
        if is_same && has_all {
            return candidate;
        }
    }
    text.to_owned()
}
