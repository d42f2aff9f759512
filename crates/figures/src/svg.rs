//! A page of SVG, with the marks that the figures need.
//!
//! Coordinates are in px from the top left. Marks with a coordinate that is not
//! finite are omitted, lines are interrupted there, and text is escaped, so that the page
//! is well-formed for any data. Text asks for Roboto, the font of the PNG images, and otherwise for fonts of
//! similar width.

use std::fmt::Write as _;

/// A point of the page, px.
pub(crate) type Point = (f64, f64);

/// Line style.
#[derive(Debug, Clone)]
pub(crate) struct Stroke {
    /// Colour, as in SVG.
    pub(crate) colour: String,
    /// Width, px.
    pub(crate) width: f64,
    /// Dash pattern, as in SVG; empty: solid.
    pub(crate) dash: &'static str,
}

/// Part of a text that is placed at its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Text style.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Text<'a> {
    /// Font size, px.
    pub(crate) size: f64,
    /// Any SVG colour.
    pub(crate) colour: &'a str,
    /// Part of the text at the point.
    pub(crate) anchor: Anchor,
    /// Whether the text is semi-bold, for names.
    pub(crate) strong: bool,
    /// Whether the text runs upwards.
    pub(crate) upright: bool,
    /// Whether the text has a white outline, to be legible on lines.
    pub(crate) halo: bool,
}

/// A page that is being drawn.
#[derive(Debug)]
pub(crate) struct Svg {
    width: f64,
    height: f64,
    title: String,
    body: String,
    clips: usize,
}

/// Height of the title above a page, and of a second line of it, px.
const TITLE: f64 = 28.0;
const SUBTITLE: f64 = 18.0;

impl Stroke {
    /// Returns a solid line style.
    pub(crate) fn solid(colour: &str, width: f64) -> Self {
        Self { colour: colour.to_owned(), width, dash: "" }
    }

    /// Sets the dash pattern.
    pub(crate) fn dashed(self, dash: &'static str) -> Self {
        Self { dash, ..self }
    }

    fn attributes(&self) -> String {
        let dash = if self.dash.is_empty() {
            String::new()
        } else {
            format!(r#" stroke-dasharray="{}""#, self.dash)
        };
        format!(r#"fill="none" stroke="{}" stroke-width="{}"{dash}"#, self.colour, number(self.width))
    }
}

impl<'a> Text<'a> {
    /// Returns the style of plain text that starts at its point.
    pub(crate) fn new(size: f64, colour: &'a str) -> Self {
        Self { size, colour, anchor: Anchor::Start, strong: false, upright: false, halo: false }
    }

    pub(crate) fn anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub(crate) fn strong(self) -> Self {
        Self { strong: true, ..self }
    }

    pub(crate) fn upright(self) -> Self {
        Self { upright: true, ..self }
    }

    pub(crate) fn halo(self) -> Self {
        Self { halo: true, ..self }
    }
}

impl Svg {
    /// Creates an empty white page.
    pub(crate) fn new(width: f64, height: f64) -> Self {
        Self { width, height, title: String::new(), body: String::new(), clips: 0 }
    }

    /// Adds a title above the page (unless it is empty), which is also the title of the document.
    pub(crate) fn titled(self, title: &str) -> Self {
        Self { title: title.trim().to_owned(), ..self }
    }

    /// Returns the finished document.
    pub(crate) fn finish(mut self) -> String {
        let (mut top, mut title) = (0.0, String::new());
        if !self.title.is_empty() {
            // The title is above the origin of the page, so that no coordinate depends on it.
            let lines = title_lines(&self.title, self.width - 40.0);
            top = -TITLE - SUBTITLE * (lines.len() - 1) as f64;
            for (k, line) in lines.iter().enumerate() {
                let style =
                    if k == 0 { Text::new(14.0, "#222222").strong() } else { Text::new(12.0, "#555555") };
                self.text((20.0, top + 22.0 + SUBTITLE * k as f64), line, style);
            }
            title = format!("<title>{}</title>\n", escaped(&self.title));
        }
        let (w, h, top) = (number(self.width), number(self.height - top), number(top));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 {top} {w} {h}\" \
             font-family=\"Roboto, Helvetica, Arial, sans-serif\" stroke-linejoin=\"round\">\n{title}\
             <rect y=\"{top}\" width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body
        )
    }

    /// Draws a straight line.
    pub(crate) fn line(&mut self, from: Point, to: Point, stroke: &Stroke) {
        self.polyline(&[from, to], stroke);
    }

    /// Draws a line through points, interrupted where one is not finite.
    pub(crate) fn polyline(&mut self, points: &[Point], stroke: &Stroke) {
        for run in points.split(|p| !finite(*p)).filter(|run| run.len() > 1) {
            self.element(&format!(r#"<polyline points="{}" {}/>"#, joined(run), stroke.attributes()));
        }
    }

    /// Draws a filled area. Points that are not finite are omitted.
    pub(crate) fn polygon(&mut self, points: &[Point], fill: &str, opacity: f64) {
        let points: Vec<Point> = points.iter().copied().filter(|p| finite(*p)).collect();
        if points.len() > 2 {
            let (points, opacity) = (joined(&points), number(opacity));
            self.element(&format!(r#"<polygon points="{points}" fill="{fill}" fill-opacity="{opacity}"/>"#));
        }
    }

    /// Fills the area within an odd number of these loops. Points that are not finite are omitted.
    pub(crate) fn area(&mut self, loops: &[Vec<Point>], fill: &str) {
        let path: String = loops.iter().map(|points| format!("{}z", path(points))).collect();
        if path.len() > loops.len() {
            self.element(&format!(r#"<path d="{path}" fill="{fill}" fill-rule="evenodd"/>"#));
        }
    }

    /// Draws several lines in one style.
    pub(crate) fn lines(&mut self, lines: &[Vec<Point>], stroke: &Stroke, opacity: f64) {
        let path: String = lines.iter().map(|points| path(points)).collect();
        if !path.is_empty() {
            let (stroke, opacity) = (stroke.attributes(), number(opacity));
            self.element(&format!(r#"<path d="{path}" {stroke} stroke-opacity="{opacity}"/>"#));
        }
    }

    /// Draws a closed outline.
    pub(crate) fn outline(&mut self, points: &[Point], stroke: &Stroke) {
        if points.iter().all(|p| finite(*p)) {
            self.element(&format!(r#"<polygon points="{}" {}/>"#, joined(points), stroke.attributes()));
        }
    }

    /// Draws a filled rectangle with rounded corners and a thin border (empty colour: no border).
    pub(crate) fn rect(&mut self, (x, y): Point, (w, h): Point, radius: f64, fill: &str, border: &str) {
        if [x, y, w, h].iter().all(|v| v.is_finite()) {
            let round = if radius > 0.0 { format!(r#" rx="{}""#, number(radius)) } else { String::new() };
            let border = if border.is_empty() { String::new() } else { format!(r#" stroke="{border}""#) };
            self.element(&format!(
                r#"<rect x="{}" y="{}" width="{}" height="{}"{round} fill="{fill}"{border}/>"#,
                number(x),
                number(y),
                number(w.max(0.0)),
                number(h.max(0.0)),
            ));
        }
    }

    /// Draws a filled disc with a border.
    pub(crate) fn circle(&mut self, (x, y): Point, radius: f64, fill: &str, border: &Stroke) {
        if finite((x, y)) {
            self.element(&format!(
                r#"<circle cx="{}" cy="{}" r="{}" fill="{fill}" stroke="{}" stroke-width="{}"/>"#,
                number(x),
                number(y),
                number(radius),
                border.colour,
                number(border.width)
            ));
        }
    }

    /// Writes a line of text with its baseline at the point.
    pub(crate) fn text(&mut self, (x, y): Point, content: &str, style: Text<'_>) {
        if !finite((x, y)) || content.is_empty() {
            return;
        }
        let anchor = match style.anchor {
            Anchor::Start => "",
            Anchor::Middle => r#" text-anchor="middle""#,
            Anchor::End => r#" text-anchor="end""#,
        };
        let weight = if style.strong { r#" font-weight="600""# } else { "" };
        let halo = if style.halo {
            r##" stroke="#ffffff" stroke-opacity="0.85" stroke-width="3" paint-order="stroke""##
        } else {
            ""
        };
        let (x, y) = (number(x), number(y));
        let turn = if style.upright { format!(r#" transform="rotate(-90 {x} {y})""#) } else { String::new() };
        self.element(&format!(
            r#"<text x="{x}" y="{y}" font-size="{}" fill="{}"{anchor}{weight}{halo}{turn}>{}</text>"#,
            number(style.size),
            style.colour,
            escaped(content)
        ));
    }

    /// Clips what `draw` draws to a polygon, and blurs it by `blur` px.
    pub(crate) fn clipped(&mut self, outline: &[Point], blur: f64, draw: impl FnOnce(&mut Self)) {
        self.clips += 1;
        let (id, points, blur) = (self.clips, joined(outline), number(blur));
        self.element(&format!(
            r#"<defs><clipPath id="clip{id}"><polygon points="{points}"/></clipPath><filter id="blur{id}"><feGaussianBlur stdDeviation="{blur}"/></filter></defs>"#
        ));
        self.element(&format!(r##"<g clip-path="url(#clip{id})"><g filter="url(#blur{id})">"##));
        draw(self);
        self.element("</g></g>");
    }

    fn element(&mut self, element: &str) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.body, "{element}");
    }
}

/// Estimates the width of a text, px; there is no font to measure it.
pub(crate) fn text_width(content: &str, size: f64) -> f64 {
    let is_raised = |c: &char| matches!(c, '\u{b2}' | '\u{b3}' | '\u{b9}' | '\u{2070}'..='\u{207f}');
    let raised = content.chars().filter(is_raised).count() as f64;
    size * (0.56 * (content.chars().count() as f64 - raised) + 0.38 * raised)
}

/// Divides a title of several parts (separated by middle dots) into two lines if it is too long for one.
fn title_lines(title: &str, width: f64) -> Vec<String> {
    const SIZE: f64 = 14.0;
    match title.split_once(" \u{b7} ") {
        Some((first, rest)) if text_width(title, SIZE) > width => {
            vec![shortened(first.trim(), width, SIZE), shortened(rest.trim(), width, 12.0)]
        }
        _ => vec![shortened(title, width, SIZE)],
    }
}

/// Shortens a text to a width of about `max_width` px.
pub(crate) fn shortened(content: &str, max_width: f64, size: f64) -> String {
    if text_width(content, size) <= max_width {
        return content.to_owned();
    }
    let mut cut = String::new();
    for next in content.chars() {
        cut.push(next);
        if text_width(&format!("{cut}\u{2026}"), size) > max_width {
            cut.pop();
            break;
        }
    }
    format!("{}\u{2026}", cut.trim_end())
}

/// Formats a colour as `#rrggbb`.
pub(crate) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Returns whether both coordinates of a point are finite.
pub(crate) fn finite((x, y): Point) -> bool {
    x.is_finite() && y.is_finite()
}

fn joined(points: &[Point]) -> String {
    let points: Vec<String> = points.iter().map(|(x, y)| format!("{},{}", number(*x), number(*y))).collect();
    points.join(" ")
}

/// Returns path data through points, in relative coordinates to a tenth of a px, because maps have many
/// points.
fn path(points: &[Point]) -> String {
    let tenths = |(x, y): Point| ((x.clamp(-1e5, 1e5) * 10.0).round(), (y.clamp(-1e5, 1e5) * 10.0).round());
    let mut path = String::new();
    let mut last = (0.0, 0.0);
    for (x, y) in points.iter().filter(|point| finite(**point)).map(|point| tenths(*point)) {
        let (command, dx, dy) = if path.is_empty() { ('M', x, y) } else { ('l', x - last.0, y - last.1) };
        let (dx, dy) = (number(dx / 10.0), number(dy / 10.0));
        // A minus sign separates two numbers as a comma does.
        let comma = if dy.starts_with('-') { "" } else { "," };
        // Writing to a String cannot fail.
        let _ = write!(path, "{command}{dx}{comma}{dy}");
        last = (x, y);
    }
    path
}

/// Formats a coordinate to a hundredth of a px, without trailing zeros.
fn number(value: f64) -> String {
    // Renderers fail for coordinates far outside the page.
    let text = format!("{:.2}", value.clamp(-1e5, 1e5));
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Escapes text for XML; characters that XML 1.0 forbids become a question mark.
fn escaped(content: &str) -> String {
    let mut safe = String::with_capacity(content.len());
    for c in content.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\t' | '\n' | '\r' => safe.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => safe.push('?'),
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A shortened text is as wide as allowed, but for one character.
    #[test]
    fn shortened_text_uses_its_width() {
        for text in
            ["iiiiiiiiiiiiiiiiiiiiiiiiiiiiiiiiiiiiiii", "MMMMMMMMMMMMMMM", "Thickness of film layer 2 (nm)"]
        {
            let short = shortened(text, 90.0, 12.0);
            let width = text_width(&short, 12.0);
            assert!(short.ends_with('\u{2026}') && width <= 90.0 && width > 72.0, "{short}: {width}");
            assert_eq!(shortened(text, 1e3, 12.0), text);
        }
    }
}
