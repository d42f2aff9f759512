//! A page in Markdown: its title, headings with anchors, links, and texts for the search.

use std::ops::Range;

use papilio_diagnostics::Diagnostic;
use pulldown_cmark::{Event, HeadingLevel, LinkType, Options, Parser, Tag, TagEnd};

use crate::Problem;
use crate::anchors::Anchors;
use crate::math::mathml;

/// A page.
#[derive(Debug, Clone)]
pub(crate) struct Document {
    /// Path in the repository, for messages and links.
    pub(crate) source: String,
    pub(crate) text: String,
    /// Text of the first heading.
    pub(crate) title: String,
    pub(crate) headings: Vec<Heading>,
    pub(crate) links: Vec<Link>,
    pub(crate) sections: Vec<Section>,
    /// The first paragraph, shortened.
    pub(crate) description: String,
    /// HTML of the outputs of a notebook.
    pub(crate) outputs: Vec<String>,
}

/// A heading with its anchor.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Heading {
    /// 1 to 6.
    pub(crate) level: usize,
    pub(crate) anchor: String,
    pub(crate) text: String,
}

/// A link or picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Link {
    pub(crate) destination: String,
    pub(crate) range: Range<usize>,
}

/// The text between two headings, without markup.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Section {
    /// Number of the heading above it; `None` before the first.
    pub(crate) heading: Option<usize>,
    pub(crate) text: String,
    /// First cells of the rows of tables, and what begins the items of lists in code or bold, up to a colon: the terms
    /// and keys that the section explains.
    pub(crate) terms: String,
}

/// Markdown as GitHub reads it.
pub(crate) fn options() -> Options {
    Options::ENABLE_TABLES
        | Options::ENABLE_FOOTNOTES
        | Options::ENABLE_STRIKETHROUGH
        | Options::ENABLE_TASKLISTS
        | Options::ENABLE_MATH
        | Options::ENABLE_GFM
}

/// Length of the description, in characters: what search engines show.
const DESCRIPTION: usize = 160;

impl Document {
    /// Reads a page; `source` is its path in the repository.
    pub(crate) fn read(source: &str, text: String) -> (Self, Vec<Problem>) {
        let mut reader = Reader { source, text: &text, ..Reader::default() };
        for (event, range) in Parser::new_ext(&text, options()).into_offset_iter() {
            reader.event(&event, range);
        }
        let Reader { mut problems, headings, links, mut sections, description, .. } = reader;
        for section in &mut sections {
            section.text = one_line(&section.text);
            section.terms = one_line(&section.terms);
        }
        sections.retain(|section| !section.text.is_empty() || section.heading.is_some());
        let title = headings.iter().find(|heading| heading.level == 1).map(|heading| heading.text.clone());
        if title.is_none() && has_outline(source) {
            let missing = Diagnostic::new("the page has no title").hint("begin it with a line `# Title`");
            problems.push(Problem::whole(source, missing));
        }
        let title = title.unwrap_or_else(|| source.to_owned());
        let description = shortened(&one_line(&description), DESCRIPTION);
        let outputs = Vec::new();
        let source = source.to_owned();
        (Self { source, title, headings, links, sections, description, outputs, text }, problems)
    }

    /// True if the text begins with its title.
    pub(crate) fn has_title(&self) -> bool {
        self.headings.iter().any(|heading| heading.level == 1)
    }

    /// True if the page has a heading with this anchor.
    pub(crate) fn has_anchor(&self, anchor: &str) -> bool {
        self.headings.iter().any(|heading| heading.anchor == anchor)
    }
}

/// True for pages of the documentation, which need a title and sections below it; other texts of the
/// repository are shown as they are.
fn has_outline(source: &str) -> bool {
    source.starts_with("docs/")
}

/// What has been read of a page so far.
#[derive(Debug, Default)]
struct Reader<'a> {
    source: &'a str,
    text: &'a str,
    anchors: Anchors,
    headings: Vec<Heading>,
    links: Vec<Link>,
    sections: Vec<Section>,
    description: String,
    problems: Vec<Problem>,
    /// Text of the heading that is being read.
    heading: Option<String>,
    /// True in the first paragraph after the title.
    describes: bool,
    described: bool,
    /// Number of the cell in its row of a table, from 1; from 2 in the row of column names.
    cell: usize,
    in_cell: bool,
    /// True at the beginning of an item of a list, and in the term that begins it.
    begins_item: bool,
    in_term: bool,
}

impl Reader<'_> {
    fn event(&mut self, event: &Event<'_>, range: Range<usize>) {
        match event {
            Event::Start(tag) => self.start(tag, range),
            Event::End(TagEnd::Heading(level)) => self.end_heading(*level, range),
            Event::End(TagEnd::Paragraph) => {
                self.described |= std::mem::take(&mut self.describes);
                self.push(" ");
            }
            Event::End(TagEnd::TableCell) => {
                self.push(" ");
                self.in_cell = false;
            }
            // Words of different blocks and cells stay apart.
            Event::End(TagEnd::Item | TagEnd::CodeBlock) | Event::SoftBreak | Event::HardBreak => {
                self.push(" ");
                self.in_term &= !matches!(event, Event::End(_));
            }
            Event::Text(text) => self.prose(text),
            Event::Code(text) => {
                self.in_term |= std::mem::take(&mut self.begins_item);
                self.push(text);
            }
            Event::InlineMath(latex) | Event::DisplayMath(latex) => {
                if let Err(wrong) = mathml(latex, false) {
                    self.report(range, wrong);
                }
                self.push(latex);
            }
            Event::Html(html) | Event::InlineHtml(html) => self.html(html, range),
            _ => {}
        }
    }

    fn start(&mut self, tag: &Tag<'_>, range: Range<usize>) {
        match tag {
            Tag::Heading { .. } => self.heading = Some(String::new()),
            Tag::Paragraph => self.describes = !self.described && !self.headings.is_empty(),
            Tag::Item => {
                self.begins_item = true;
                if let Some(section) = self.sections.last_mut() {
                    section.terms.push(' ');
                }
            }
            Tag::Strong => self.in_term |= std::mem::take(&mut self.begins_item),
            Tag::TableRow => self.cell = 0,
            Tag::TableHead => self.cell = 1,
            Tag::TableCell => {
                self.cell += 1;
                self.in_cell = true;
            }
            Tag::Link { link_type: LinkType::Email, .. } => {}
            Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. } => {
                self.links.push(Link { destination: dest_url.to_string(), range });
            }
            _ => {}
        }
    }

    fn end_heading(&mut self, level: HeadingLevel, range: Range<usize>) {
        let text = one_line(&self.heading.take().unwrap_or_default());
        let level = level as usize;
        self.check_outline(level, range);
        let anchor = self.anchors.next(&text);
        self.headings.push(Heading { level, anchor, text });
        self.sections.push(Section { heading: Some(self.headings.len() - 1), ..Section::default() });
    }

    /// Refuses a heading that does not fit those above it.
    fn check_outline(&mut self, level: usize, range: Range<usize>) {
        if !has_outline(self.source) {
            return;
        }
        let above = self.headings.last().map_or(0, |heading| heading.level);
        if level > above + 1 {
            let skipped = Diagnostic::new(format!("a heading of level {level} follows one of level {above}"))
                .hint("headings go down by one level at a time, the title has one `#`");
            self.report(range.clone(), skipped);
        }
        if level == 1 && above > 0 {
            let second = Diagnostic::new("the page has a second title").hint("a section begins with `##`");
            self.report(range, second);
        }
    }

    /// Adds text, in which a colon or a bracket ends the term of an item.
    fn prose(&mut self, text: &str) {
        self.begins_item = false;
        let (term, rest) = match text.find(['(', ':']) {
            Some(end) if self.in_term => text.split_at(end),
            _ => (text, ""),
        };
        self.push(term);
        if !rest.is_empty() {
            self.in_term = false;
            self.push(rest);
        }
    }

    fn push(&mut self, text: &str) {
        if let Some(heading) = &mut self.heading {
            *heading += text;
            return;
        }
        if self.describes {
            self.description += text;
        }
        if self.sections.is_empty() {
            self.sections.push(Section::default());
        }
        let is_term = self.in_term || (self.in_cell && self.cell == 1);
        if let Some(section) = self.sections.last_mut() {
            section.text += text;
            if is_term {
                section.terms += text;
            }
        }
    }

    /// HTML in a page is for `<br>`, `<kbd>` and the like. What links must be Markdown: only that is checked.
    fn html(&mut self, html: &str, range: Range<usize>) {
        let lower = html.to_lowercase();
        if ["href", "src=", "<script", "<style"].iter().any(|word| lower.contains(word))
            && !lower.starts_with("<!--")
        {
            let wrong = Diagnostic::new("HTML that refers to something else")
                .hint("write links and pictures in Markdown, where they are checked");
            self.report(range, wrong);
        }
    }

    fn report(&mut self, range: Range<usize>, diagnostic: Diagnostic) {
        self.problems.push(Problem::in_text(self.source, self.text, range, diagnostic));
    }
}

/// The words of a text, each separated by one blank.
pub(crate) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The beginning of a text: whole words, with an ellipsis.
pub(crate) fn shortened(text: &str, length: usize) -> String {
    if text.chars().count() <= length {
        return text.to_owned();
    }
    let start: String = text.chars().take(length).collect();
    let words = start.rsplit_once(' ').map_or(&*start, |(words, _)| words);
    format!("{} …", words.trim_end_matches([',', ';', ':', '.']))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Document, Vec<Problem>) {
        Document::read("docs/x.md", text.to_owned())
    }

    #[test]
    fn page_has_title_headings_links_sections_and_description() {
        let (page, problems) = read(
            "# A `film`\n\nFirst [page](b.md#c).\n\n## More\n\nText $x^2$\n\n| a | b |\n|---|---|\n| 1 | 2 |\n",
        );
        assert!(problems.is_empty(), "{problems:?}");
        assert_eq!((page.title.as_str(), page.description.as_str()), ("A film", "First page."));
        assert_eq!(page.headings[1], Heading { level: 2, anchor: "more".into(), text: "More".into() });
        assert_eq!(page.links[0].destination, "b.md#c");
        assert_eq!(
            page.sections[1],
            Section { heading: Some(1), text: "Text x^2 a b 1 2".into(), terms: "1".into() }
        );
        assert!(page.has_anchor("a-film") && !page.has_anchor("film"));
    }

    #[test]
    fn term_of_an_item_ends_at_a_colon_or_bracket() {
        let (page, _) = read("# A\n\n- `a:b`, `c` (0 to 1): one `d`\n- **e** (m): two\n- three: `f`\n");
        assert_eq!(page.sections[0].terms, "a:b, c e");
    }

    #[test]
    fn mistakes_of_a_page_are_reported_with_their_line() {
        for (text, message, line) in [
            ("text\n", "the page has no title", None),
            ("# A\n\n### B\n", "a heading of level 3 follows one of level 1", Some(3)),
            ("# A\n\n# B\n", "the page has a second title", Some(3)),
            ("# A\n\n$\\nosuch$\n", "this equation cannot be read", Some(3)),
            ("# A\n\n<img src=\"x.png\">\n", "HTML that refers to something else", Some(3)),
        ] {
            let (_, problems) = read(text);
            assert_eq!(problems.len(), 1, "{text}: {problems:?}");
            assert!(problems[0].diagnostic.message.starts_with(message), "{problems:?}");
            assert_eq!(problems[0].place.line_column().map(|(line, _)| line), line);
        }
    }

    #[test]
    fn shortened_text_ends_with_a_word() {
        assert_eq!(shortened("one, two three", 8), "one …");
        assert_eq!(shortened("one two", 7), "one two");
    }
}
