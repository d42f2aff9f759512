//! Items of an array on several lines, each with the comments that belong to it: those above it, and the one
//! at the end of its line.

use toml_edit::{Array, RawString, Value};

/// An item of an array with its layout.
pub(super) struct ArrayItem {
    pub(super) value: Value,
    /// Line breaks, comments and blanks before it, from the end of the line of the item before; `None`: as
    /// usual.
    pub(super) lead: Option<String>,
    /// The comment on its line, after the comma.
    pub(super) tail: String,
}

/// An array in parts, which are put together again in another order.
pub(super) struct ArrayItems {
    /// The comment on the line of the opening bracket.
    head: String,
    pub(super) items: Vec<ArrayItem>,
    /// What comes before the closing bracket.
    rest: String,
}

/// Splits what is between two items: the comment on the line of the first, and the rest.
fn split(between: &str) -> (String, String) {
    let line = between.find('\n').unwrap_or(between.len());
    let (tail, lead) = if between[..line].contains('#') { between.split_at(line) } else { ("", between) };
    (tail.to_owned(), lead.to_owned())
}

fn text(raw: &RawString) -> &str {
    raw.as_str().unwrap_or_default()
}

impl ArrayItems {
    pub(super) fn of(array: &Array) -> Self {
        let mut head = String::new();
        let mut items: Vec<ArrayItem> = Vec::new();
        for value in array {
            let between = value.decor().prefix().map(|prefix| split(text(prefix)));
            let (tail, lead) = between.map_or((String::new(), None), |(tail, lead)| (tail, Some(lead)));
            match items.last_mut() {
                Some(last) => last.tail = tail,
                None => head = tail,
            }
            items.push(ArrayItem { value: value.clone(), lead, tail: String::new() });
        }
        let (tail, rest) = split(text(array.trailing()));
        match items.last_mut() {
            Some(last) => last.tail = tail,
            None => head = tail,
        }
        Self { head, items, rest }
    }

    /// Line break and indentation of an item at an index, as those of its neighbour.
    pub(super) fn lead_at(&self, at: usize) -> String {
        let neighbour = self.items.get(at.saturating_sub(1)).or(self.items.first());
        let lead = neighbour.and_then(|item| item.lead.as_deref()).unwrap_or_default();
        match lead.rfind('\n') {
            Some(line) => lead[line..].to_owned(),
            None if at == 0 => String::new(),
            None => " ".to_owned(),
        }
    }

    pub(super) fn put_into(self, array: &mut Array) {
        let mut tail = self.head;
        let after = |tail: &str, next: &str| match tail.contains('#') && !next.starts_with('\n') {
            true => format!("{tail}\n{next}"),
            false => format!("{tail}{next}"),
        };
        array.clear();
        for (number, mut item) in self.items.into_iter().enumerate() {
            // The first item of a line has no blank before it.
            let lead =
                item.lead.map(|lead| if number == 0 && !lead.contains('\n') { String::new() } else { lead });
            let usual = || if number == 0 { String::new() } else { " ".to_owned() };
            item.value.decor_mut().set_prefix(after(&tail, &lead.unwrap_or_else(usual)));
            array.push_formatted(item.value);
            tail = item.tail;
        }
        array.set_trailing(after(&tail, &self.rest));
    }
}
