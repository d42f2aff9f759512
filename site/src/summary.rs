//! `docs/SUMMARY.md`: the order of the pages and their parts, in the form of mdBook.
//!
//! `# Part` begins a part, `- [Title](file)` is a page of it; an indented entry belongs to the entry above
//! it. A link before the first part stands alone, above all parts.

use std::ops::Range;

use papilio_diagnostics::Diagnostic;

use crate::Problem;

/// Pages in their order, by parts.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Summary {
    pub(crate) parts: Vec<Part>,
}

/// Pages of one kind; the pages before the first part have the title "".
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Part {
    pub(crate) title: String,
    pub(crate) entries: Vec<Entry>,
}

/// A page in the navigation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Entry {
    pub(crate) title: String,
    /// As written, relative to the folder of the summary.
    pub(crate) link: String,
    /// 0, or 1 for a page that belongs to the entry above it.
    pub(crate) depth: usize,
    /// Place of the link in the summary.
    pub(crate) range: Range<usize>,
}

impl Summary {
    /// Reads a summary. `name` is its path, for messages.
    pub(crate) fn read(name: &str, text: &str) -> Result<Self, Vec<Problem>> {
        let (mut summary, mut problems) = (Self::default(), Vec::new());
        let mut at = 0;
        for line in text.split_inclusive('\n') {
            let range = at..at + line.trim_end().len();
            at += line.len();
            match Line::read(line.trim_end()) {
                Some(Line::Nothing) => {}
                Some(Line::Part(title)) => {
                    summary.parts.push(Part { title: title.to_owned(), entries: Vec::new() });
                }
                Some(Line::Entry { title, link, depth }) => {
                    if summary.parts.is_empty() {
                        summary.parts.push(Part::default());
                    }
                    let (title, link) = (title.to_owned(), link.to_owned());
                    let entry = Entry { title, link, depth, range: range.clone() };
                    summary.parts.last_mut().into_iter().for_each(|part| part.entries.push(entry.clone()));
                }
                None => problems.push(Problem::in_text(
                    name,
                    text,
                    range,
                    Diagnostic::new("this line is no part of a summary")
                        .expected("`# Part`, or `- [Title](file.md)`, at most once indented"),
                )),
            }
        }
        if problems.is_empty() { Ok(summary) } else { Err(problems) }
    }

    /// All pages, in order.
    pub(crate) fn entries(&self) -> impl Iterator<Item = &Entry> {
        self.parts.iter().flat_map(|part| &part.entries)
    }
}

enum Line<'a> {
    Nothing,
    Part(&'a str),
    Entry { title: &'a str, link: &'a str, depth: usize },
}

impl<'a> Line<'a> {
    fn read(line: &'a str) -> Option<Self> {
        let inner = line.trim_start();
        let depth = match line.len() - inner.len() {
            0 => 0,
            2 | 4 => 1,
            _ => return None,
        };
        // mdBook's own summaries begin with this title.
        if inner.is_empty() || inner == "# Summary" {
            return Some(Self::Nothing);
        }
        if let Some(title) = inner.strip_prefix("# ") {
            return (depth == 0).then_some(Self::Part(title.trim()));
        }
        let item = inner.strip_prefix("- ").unwrap_or(inner);
        let (title, link) = item.strip_prefix('[')?.strip_suffix(')')?.split_once("](")?;
        (!title.is_empty() && !link.is_empty()).then_some(Self::Entry { title, link, depth })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summary_has_parts_and_nested_pages() {
        let text = "# Summary\n\n[Papilio](README.md)\n\n# How-to\n\n- [Films](films.md)\n  - [Speed](how-to/speed.md)\n";
        let summary = Summary::read("SUMMARY.md", text).unwrap();
        let titles: Vec<_> = summary.parts.iter().map(|part| part.title.as_str()).collect();
        assert_eq!(titles, ["", "How-to"]);
        let entries: Vec<_> =
            summary.entries().map(|entry| (&*entry.title, &*entry.link, entry.depth)).collect();
        assert_eq!(
            entries,
            [("Papilio", "README.md", 0), ("Films", "films.md", 0), ("Speed", "how-to/speed.md", 1)]
        );
    }

    #[test]
    fn other_lines_are_reported_with_their_place() {
        let problems = Summary::read("SUMMARY.md", "# A\n\nSome text.\n- [](x.md)\n").unwrap_err();
        let places: Vec<_> = problems.iter().map(|problem| problem.place.line_column()).collect();
        assert_eq!(places, [Some((3, 1)), Some((4, 1))]);
    }
}
