//! Reader of the subset of XML that BSDF files use: elements and their text. Attributes and comments are
//! skipped; document types and CDATA are refused, and entities are not replaced.

use std::ops::Range;

use super::BsdfProblem;
use super::text::Text;
use crate::error::FormatError;

/// Largest number and depth of elements.
const MOST_ELEMENTS: usize = 200_000;
const DEEPEST: usize = 32;

/// A document: its elements in the order of their start tags, the root first.
pub(super) struct Document<'a> {
    pub(super) text: Text<'a>,
    elements: Vec<Element>,
}

struct Element {
    name: Range<usize>,
    parent: usize,
    /// Places of the text directly within the element.
    text: Vec<Range<usize>>,
}

/// An element of a document.
#[derive(Clone, Copy)]
pub(super) struct Node<'a> {
    document: &'a Document<'a>,
    number: usize,
}

/// Longest line before the declaration, bytes.
const LONGEST_LINE: usize = 1000;

/// Returns the place of one line of other text before the declaration `<?xml`, which some programs write;
/// empty if there is none.
pub(super) fn line_before(text: Text<'_>) -> Range<usize> {
    let start = text.bytes.len() - text.bytes.trim_ascii_start().len();
    let rest = &text.bytes[start..];
    let end = rest.iter().take(LONGEST_LINE).position(|&b| b == b'\n');
    let declared = end.filter(|&end| rest[0] != b'<' && rest[end..].trim_ascii_start().starts_with(b"<?xml"));
    declared.map_or(0..0, |end| start..start + end)
}

/// Returns whether a file begins as XML, perhaps after one line of other text.
pub(super) fn is_xml(text: Text<'_>) -> bool {
    let bytes = text.bytes[line_before(text).end..].trim_ascii_start();
    bytes.first() == Some(&b'<') && bytes.get(1).is_some_and(|b| b.is_ascii_alphabetic() || b"?!".contains(b))
}

impl<'a> Document<'a> {
    pub(super) fn new(text: Text<'a>) -> Result<Self, FormatError> {
        let mut document = Document { text, elements: Vec::new() };
        let mut open: Vec<usize> = Vec::new();
        let mut at = line_before(text).end;
        while at < text.bytes.len() {
            let tag = find(text.bytes, at, b"<").unwrap_or(text.bytes.len());
            match open.last() {
                Some(&inner) if tag > at => document.elements[inner].text.push(at..tag),
                _ => document.blank(at..tag)?,
            }
            at = if tag < text.bytes.len() { document.tag(&mut open, tag)? } else { tag };
        }
        if !open.is_empty() || document.elements.is_empty() {
            return Err(text.ends("all elements are closed"));
        }
        Ok(document)
    }

    /// Fails unless a range, outside of all elements, is blank.
    fn blank(&self, range: Range<usize>) -> Result<(), FormatError> {
        let stray = self.text.bytes[range.clone()].trim_ascii_start();
        if stray.is_empty() {
            return Ok(());
        }
        Err(self.damaged(range.end - stray.len(), "text outside of all elements"))
    }

    /// Reads a tag or comment that begins at `at`, and returns its end.
    fn tag(&mut self, open: &mut Vec<usize>, at: usize) -> Result<usize, FormatError> {
        let bytes = self.text.bytes;
        let rest = &bytes[at..];
        for (begins, ends) in [("<!--", "-->"), ("<?", "?>")] {
            if rest.starts_with(begins.as_bytes()) {
                let end = find(bytes, at + begins.len(), ends.as_bytes());
                return end.map(|end| end + ends.len()).ok_or_else(|| self.text.ends("the end of a comment"));
            }
        }
        if rest.starts_with(b"<!") {
            return Err(self.damaged(at, "document types and CDATA are not supported"));
        }
        let end = tag_end(bytes, at).ok_or_else(|| self.text.ends("the end of a tag"))?;
        let (closes, name_at) = if rest.starts_with(b"</") { (true, at + 2) } else { (false, at + 1) };
        let is_part = |b: &u8| b.is_ascii_alphanumeric() || b"_-.:".contains(b);
        let length = bytes[name_at..end].iter().take_while(|b| is_part(b)).count();
        let name = name_at..name_at + length;
        if length == 0 {
            return Err(self.damaged(at, "a tag without a name"));
        }
        if closes {
            let opened = open.pop().map(|number| &bytes[self.elements[number].name.clone()]);
            if opened != Some(&bytes[name]) {
                return Err(self.damaged(at, "this end tag does not match the open element"));
            }
            return Ok(end + 1);
        }
        if open.is_empty() && !self.elements.is_empty() {
            return Err(self.damaged(at, "there is more than one root element"));
        }
        self.open(open, name, bytes[end - 1] == b'/')?;
        Ok(end + 1)
    }

    fn open(&mut self, open: &mut Vec<usize>, name: Range<usize>, is_empty: bool) -> Result<(), FormatError> {
        if open.len() >= DEEPEST {
            return Err(self.text.error(name, BsdfProblem::TooDeep { limit: DEEPEST }));
        }
        if self.elements.len() >= MOST_ELEMENTS {
            return Err(self.damaged(name.start, "there are too many elements"));
        }
        let parent = open.last().copied().unwrap_or(usize::MAX);
        if !is_empty {
            open.push(self.elements.len());
        }
        self.elements.push(Element { name, parent, text: Vec::new() });
        Ok(())
    }

    fn damaged(&self, at: usize, message: &str) -> FormatError {
        let problem = BsdfProblem::Damaged { what: "XML", message: message.to_owned() };
        self.text.error(at..at + 1, problem)
    }

    /// Returns the root element.
    pub(super) fn root(&'a self) -> Node<'a> {
        Node { document: self, number: 0 }
    }
}

fn find(bytes: &[u8], from: usize, what: &[u8]) -> Option<usize> {
    let first = *what.first()?;
    let mut at = from;
    loop {
        at += bytes.get(at..)?.iter().position(|&b| b == first)?;
        if bytes[at..].starts_with(what) {
            return Some(at);
        }
        at += 1;
    }
}

/// Returns the place of the `>` of a tag, outside of quotes.
fn tag_end(bytes: &[u8], at: usize) -> Option<usize> {
    let mut quote = None;
    let end = bytes[at..].iter().position(|&b| match quote {
        Some(open) => {
            if b == open {
                quote = None;
            }
            false
        }
        None => {
            quote = (b == b'"' || b == b'\'').then_some(b);
            b == b'>'
        }
    });
    end.map(|length| at + length)
}

impl<'a> Node<'a> {
    fn element(self) -> &'a Element {
        &self.document.elements[self.number]
    }

    pub(super) fn is(self, name: &str) -> bool {
        self.document.text.bytes[self.element().name.clone()] == *name.as_bytes()
    }

    /// Returns the place of the element's name.
    pub(super) fn place(self) -> Range<usize> {
        self.element().name.clone()
    }

    /// Returns all descendants with this name.
    pub(super) fn all(self, name: &'static str) -> impl Iterator<Item = Node<'a>> {
        let (document, own) = (self.document, self.number);
        let within = move |mut number: usize| {
            while number != usize::MAX && number > own {
                number = document.elements[number].parent;
            }
            number == own
        };
        (own + 1..document.elements.len())
            .take_while(move |&number| within(number))
            .map(move |number| Node { document, number })
            .filter(move |node| node.is(name))
    }

    /// Returns the first descendant with this name.
    pub(super) fn first(self, name: &'static str) -> Option<Node<'a>> {
        self.all(name).next()
    }

    /// Returns the first descendant with this name; fails if there is none.
    pub(super) fn expect(self, name: &'static str) -> Result<Node<'a>, FormatError> {
        self.first(name)
            .ok_or_else(|| self.document.text.error(self.place(), BsdfProblem::Missing { what: name }))
    }

    /// Returns the places of the element's text.
    pub(super) fn text_ranges(self) -> &'a [Range<usize>] {
        &self.element().text
    }

    /// Returns the place of the element's text without blanks, for an element that holds a word or a number.
    pub(super) fn word(self) -> Range<usize> {
        let bytes = self.document.text.bytes;
        let filled = self.text_ranges().iter().find(|range| !bytes[(*range).clone()].trim_ascii().is_empty());
        let Some(range) = filled.cloned() else { return self.place().end..self.place().end };
        let start = range.end - bytes[range.clone()].trim_ascii_start().len();
        start..start + bytes[range].trim_ascii().len()
    }

    /// Returns the element's text, at most 200 bytes.
    pub(super) fn text(self) -> String {
        self.document.text.quote(self.word())
    }
}
