//! Pages as HTML.

use pulldown_cmark::{CodeBlockKind, CowStr, Event, HeadingLevel, Parser, Tag, TagEnd};

use crate::document::{Document, Heading, options};
use crate::highlight::highlight;
use crate::math::mathml;
use crate::notebook::OUTPUT;

/// Longest word of code that is not broken; in characters.
const LONGEST_WORD: usize = 24;

/// Returns the text with the characters that HTML reserves replaced.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '&' => escaped += "&amp;",
            '"' => escaped += "&quot;",
            _ => escaped.push(c),
        }
    }
    escaped
}

/// What a page's links and anchors become.
pub(crate) trait Surroundings {
    /// URL for a link of the page, as `href`.
    fn link(&self, link: &str) -> String;
    /// URL, width and height of a picture, as attributes of `img`.
    fn picture(&self, link: &str) -> String;
    /// Anchor of a heading of the page.
    fn anchor(&self, heading: &Heading) -> String;
}

/// Returns the HTML of a page.
pub(crate) fn render(page: &Document, surroundings: &dyn Surroundings) -> String {
    let mut renderer = Renderer { page, surroundings, heading: 0, as_figure: false, out: Vec::new() };
    renderer.all(&mut Parser::new_ext(&page.text, options()));
    let mut html = String::new();
    pulldown_cmark::html::push_html(&mut html, renderer.out.into_iter());
    // An empty cell above a column is no heading of it.
    for aligned in
        ["", " style=\"text-align: left\"", " style=\"text-align: center\"", " style=\"text-align: right\""]
    {
        html = html.replace(&format!("<th{aligned}></th>"), "<td></td>");
    }
    html
}

struct Renderer<'a> {
    page: &'a Document,
    surroundings: &'a dyn Surroundings,
    /// Number of headings so far.
    heading: usize,
    /// True in a paragraph that is only a picture.
    as_figure: bool,
    out: Vec<Event<'a>>,
}

/// The events that follow.
type Rest<'r, 'a> = &'r mut dyn Iterator<Item = Event<'a>>;

impl<'a> Renderer<'a> {
    fn all(&mut self, events: Rest<'_, 'a>) {
        while let Some(event) = events.next() {
            self.event(event, events);
        }
    }

    fn event(&mut self, event: Event<'a>, rest: Rest<'_, 'a>) {
        match event {
            Event::Start(Tag::Heading { level, .. }) => self.heading(level, rest),
            Event::Start(Tag::CodeBlock(kind)) => self.code(&kind, rest),
            Event::Start(Tag::Paragraph) => self.paragraph(rest),
            Event::Start(Tag::Table(alignments)) => {
                self.html("<div class=\"table\">");
                self.out.push(Event::Start(Tag::Table(alignments)));
            }
            Event::End(TagEnd::Table) => {
                self.out.push(Event::End(TagEnd::Table));
                self.html("</div>\n");
            }
            Event::Start(Tag::Link { dest_url, .. }) => {
                let url = escape(&self.surroundings.link(&dest_url));
                self.inline(format!("<a href=\"{url}\">"));
            }
            Event::End(TagEnd::Link) => self.inline("</a>".to_owned()),
            Event::Start(Tag::Image { dest_url, title, .. }) => {
                let alternative = plain(&until(rest, |end| matches!(end, TagEnd::Image)));
                self.picture(&dest_url, &title, &alternative);
            }
            // The page has been checked: its equations can be written.
            Event::InlineMath(latex) => self.inline(mathml(&latex, false).unwrap_or_default()),
            Event::DisplayMath(latex) => self.inline(mathml(&latex, true).unwrap_or_default()),
            Event::Code(code) => self.inline(inline_code(&code)),
            // Without a label, a box to tick says nothing to a screen reader.
            Event::TaskListMarker(is_done) => self.inline(if is_done { "☑ " } else { "☐ " }.to_owned()),
            // Comments are for the tools that write the page.
            Event::Html(html) if html.trim_start().starts_with("<!--") => {}
            other => self.out.push(other),
        }
    }

    /// A heading is a link to itself, unless it contains links.
    fn heading(&mut self, level: HeadingLevel, rest: Rest<'_, 'a>) {
        let inner = until(rest, |end| matches!(end, TagEnd::Heading(_)));
        let anchor = self.page.headings.get(self.heading).map(|heading| self.surroundings.anchor(heading));
        let anchor = escape(&anchor.unwrap_or_default());
        self.heading += 1;
        let has_links = inner.iter().any(|event| matches!(event, Event::Start(Tag::Link { .. })));
        let is_link = !has_links && level != HeadingLevel::H1;
        self.html(format!("<{level} id=\"{anchor}\">"));
        if is_link {
            self.html(format!("<a class=\"anchor\" href=\"#{anchor}\">"));
        }
        self.all(&mut inner.into_iter());
        self.html(format!("{}</{level}>\n", if is_link { "</a>" } else { "" }));
    }

    /// A paragraph that is only a picture becomes a figure, one that is only an equation becomes a block that
    /// scrolls.
    fn paragraph(&mut self, rest: Rest<'_, 'a>) {
        let inner = until(rest, |end| matches!(end, TagEnd::Paragraph));
        let pictures = inner.iter().filter(|event| matches!(event, Event::Start(Tag::Image { .. }))).count();
        let is_picture = pictures == 1
            && matches!(inner.first(), Some(Event::Start(Tag::Image { .. })))
            && matches!(inner.last(), Some(Event::End(TagEnd::Image)));
        let (start, end) = match *inner {
            [Event::DisplayMath(_)] => ("<div class=\"equation\">", "</div>\n"),
            _ if is_picture => ("<figure>", "</figure>\n"),
            _ => ("<p>", "</p>\n"),
        };
        self.html(start);
        self.as_figure = is_picture;
        self.all(&mut inner.into_iter());
        self.as_figure = false;
        self.html(end);
    }

    fn code(&mut self, kind: &CodeBlockKind<'_>, rest: Rest<'_, 'a>) {
        let code = plain(&until(rest, |end| matches!(end, TagEnd::CodeBlock)));
        let language = match kind {
            CodeBlockKind::Fenced(words) => words.split([' ', ',']).next().unwrap_or_default(),
            CodeBlockKind::Indented => "",
        };
        let block = match language {
            "math" => format!("<div class=\"equation\">{}</div>\n", mathml(&code, true).unwrap_or_default()),
            OUTPUT => code
                .trim()
                .parse()
                .ok()
                .and_then(|number: usize| self.page.outputs.get(number))
                .cloned()
                .unwrap_or_default(),
            _ => code_block(&code, language),
        };
        self.html(block);
    }

    fn picture(&mut self, link: &str, title: &str, alternative: &str) {
        let attributes = self.surroundings.picture(link);
        let image = format!("<img {attributes} alt=\"{}\">", escape(alternative));
        if !self.as_figure {
            return self.inline(image);
        }
        let full = escape(&self.surroundings.link(link));
        self.html(format!("<a href=\"{full}\">{image}</a>"));
        if !title.is_empty() {
            self.html(format!("<figcaption>{}</figcaption>", escape(title)));
        }
    }

    fn html(&mut self, html: impl Into<CowStr<'a>>) {
        self.out.push(Event::Html(html.into()));
    }

    fn inline(&mut self, html: String) {
        self.out.push(Event::InlineHtml(html.into()));
    }
}

/// A code block; the page's script adds a button that copies it.
pub(crate) fn code_block(code: &str, language: &str) -> String {
    let class = if language.is_empty() { "text" } else { language };
    let class = escape(class);
    let shown = highlight(code, language);
    format!("<div class=\"code\"><pre><code class=\"language-{class}\">{shown}</code></pre></div>\n")
}

/// Code in a sentence. A short word of it, such as an option, is not broken at its hyphens.
fn inline_code(code: &str) -> String {
    let is_word = code.chars().count() <= LONGEST_WORD && !code.contains(' ');
    let class = if is_word { " class=\"word\"" } else { "" };
    format!("<code{class}>{}</code>", escape(code))
}

/// The events before this end.
fn until<'a>(rest: Rest<'_, 'a>, is_end: impl Fn(&TagEnd) -> bool) -> Vec<Event<'a>> {
    rest.take_while(|event| !matches!(event, Event::End(end) if is_end(end))).collect()
}

/// Text of events, without markup.
fn plain(events: &[Event<'_>]) -> String {
    events
        .iter()
        .map(|event| match event {
            Event::Text(text) | Event::Code(text) => text.as_ref(),
            Event::SoftBreak | Event::HardBreak => " ",
            _ => "",
        })
        .collect()
}
