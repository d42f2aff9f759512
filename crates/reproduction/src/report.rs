//! The report: sections of text, tables and figures, and its conversion to a self-contained HTML page.

use std::fmt::Write;

/// A report.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Title.
    pub title: String,
    /// Introductory paragraphs.
    pub about: Vec<String>,
    /// Sections, in the order of the dissertation.
    pub sections: Vec<Section>,
}

/// A section about a table or figure of the dissertation and its reproduction, or about a measured sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Identifier within the page: `table-5-1`.
    pub id: String,
    /// Number and title in the dissertation, or what was measured.
    pub title: String,
    /// Contents.
    pub parts: Vec<Part>,
}

/// A part of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// A paragraph.
    Words(String),
    /// A table.
    Table(Table),
    /// A figure as SVG, and its caption.
    Figure(String, String),
}

/// A table of texts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Titles of the columns.
    pub head: Vec<String>,
    /// Rows, with a cell for each column.
    pub rows: Vec<Vec<String>>,
}

impl Section {
    /// Creates a section without parts.
    pub fn new(id: impl Into<String>, title: impl Into<String>) -> Self {
        Self { id: id.into(), title: title.into(), parts: Vec::new() }
    }

    /// Adds a paragraph.
    #[must_use]
    pub fn say(mut self, text: impl Into<String>) -> Self {
        self.parts.push(Part::Words(text.into()));
        self
    }

    /// Adds a table.
    #[must_use]
    pub fn table(mut self, table: Table) -> Self {
        self.parts.push(Part::Table(table));
        self
    }

    /// Adds a figure.
    #[must_use]
    pub fn figure(mut self, svg: String, caption: impl Into<String>) -> Self {
        self.parts.push(Part::Figure(svg, caption.into()));
        self
    }
}

impl Table {
    /// Creates a table with these columns.
    pub fn new(head: &[&str]) -> Self {
        Self { head: head.iter().map(|&name| name.to_owned()).collect(), rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row<C: Into<String>>(&mut self, cells: impl IntoIterator<Item = C>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }
}

/// Formats a number with so many significant digits, with an exponent only if the number would be long
/// without it.
pub(crate) fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let decade = value.abs().log10().floor() as i32;
    if !(-5..7).contains(&decade) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    let decimals = (digits as i32 - 1 - decade).max(0) as usize;
    format!("{value:.decimals$}")
}

/// Formats a number with so many decimals, without the sign of a zero.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if text.chars().any(|c| ('1'..='9').contains(&c)) { text } else { text.replace('-', "") }
}

/// Formats a difference with its sign and so many decimals.
pub(crate) fn difference(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if value > 0.0 && text.chars().any(|c| ('1'..='9').contains(&c)) { format!("+{text}") } else { text }
}

/// Formats the deviation of our number from the printed one: in %, or as a difference.
pub(crate) fn off(theirs: f64, ours: f64) -> String {
    let difference = ours - theirs;
    if theirs == 0.0 || !difference.is_finite() {
        return number(difference, 2);
    }
    format!("{} %", self::difference(100.0 * difference / theirs.abs(), 1))
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;color:#222;max-width:74rem;margin:2rem auto;padding:0 1rem}p,ul{max-width:46rem}\
h1{font-size:1.7rem}h2{font-size:1.25rem;margin-top:2.5rem;border-top:1px solid #ddd;padding-top:1.2rem}\
table{border-collapse:collapse;margin:1rem 0;font-size:.9rem;display:block;overflow-x:auto}\
th,td{padding:.25rem .7rem;border-bottom:1px solid #e4e4e4;text-align:right;font-variant-numeric:tabular-nums;vertical-align:top}\
th:first-child,td:first-child{text-align:left}th{border-bottom:1px solid #888;font-weight:600}.words{text-align:left;max-width:26rem}\
pre{overflow-x:auto;font-size:.85rem}figure{margin:1.2rem 0}figure img{max-width:100%;min-width:min(100%,52rem);height:auto}figcaption{font-size:.9rem;color:#555}\
nav{columns:16rem;font-size:.9rem}nav a{display:block;color:#1f4e9c;text-decoration:none}nav a:hover{text-decoration:underline}section{scroll-margin-top:1rem}\
@media(min-width:94rem){body{margin-left:19rem}nav{position:fixed;left:1rem;top:1rem;bottom:1rem;width:16rem;overflow:auto;columns:auto}}";

impl Report {
    /// Returns an HTML page that contains the figures.
    pub fn html(&self) -> String {
        let title = escaped(&self.title);
        let mut page = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n<style>{STYLE}</style>\n\
             </head>\n<body>\n<h1>{title}</h1>\n"
        );
        self.about.iter().for_each(|text| paragraph(&mut page, text));
        page.push_str("<nav>\n");
        for section in &self.sections {
            let _ = writeln!(page, "<a href=\"#{}\">{}</a>", section.id, escaped(&section.title));
        }
        page.push_str("</nav>\n");
        for section in &self.sections {
            let _ = writeln!(page, "<section id=\"{}\">\n<h2>{}</h2>", section.id, escaped(&section.title));
            section.parts.iter().for_each(|part| part.html(&mut page, &section.title));
            page.push_str("</section>\n");
        }
        page.push_str("</body>\n</html>\n");
        page
    }
}

impl Part {
    fn html(&self, page: &mut String, name: &str) {
        match self {
            Self::Words(text) => paragraph(page, text),
            Self::Figure(svg, caption) => {
                let (uri, name, caption) = (data_uri(svg), escaped(name), escaped(caption));
                let below = if caption.is_empty() {
                    String::new()
                } else {
                    format!("<figcaption>{caption}</figcaption>")
                };
                let _ = writeln!(page, "<figure><img alt=\"{name}\" src=\"{uri}\">{below}</figure>");
            }
            Self::Table(table) => {
                table.html(page);
            }
        }
    }
}

impl Table {
    fn html(&self, page: &mut String) {
        let class = |column: usize| if self.is_of_words(column) { " class=\"words\"" } else { "" };
        page.push_str("<table>\n<tr>");
        for (column, name) in self.head.iter().enumerate() {
            let _ = write!(page, "<th{}>{}</th>", class(column), escaped(name));
        }
        page.push_str("</tr>\n");
        for row in &self.rows {
            page.push_str("<tr>");
            for (column, cell) in row.iter().enumerate() {
                let _ = write!(page, "<td{}>{}</td>", class(column), escaped(cell));
            }
            page.push_str("</tr>\n");
        }
        page.push_str("</table>\n");
    }

    /// Returns whether every cell of a column begins with a letter.
    fn is_of_words(&self, column: usize) -> bool {
        let mut cells = self.rows.iter().filter_map(|row| row.get(column)?.chars().next()).peekable();
        cells.peek().is_some() && cells.all(char::is_alphabetic)
    }
}

fn paragraph(page: &mut String, text: &str) {
    let _ = writeln!(page, "<p>{}</p>", escaped(text));
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Returns an SVG text as a data URI. The identifiers within each figure are then independent of the others.
fn data_uri(svg: &str) -> String {
    let mut uri = String::with_capacity(svg.len() * 2);
    uri.push_str("data:image/svg+xml,");
    for byte in svg.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' => uri.push(char::from(byte)),
            b' ' | b'-' | b'.' | b'_' | b'/' | b':' | b'=' | b',' | b';' | b'(' | b')' | b'!' | b'*' => {
                uri.push(char::from(byte));
            }
            other => {
                let _ = write!(uri, "%{other:02X}");
            }
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_given_significant_digits() {
        let written = [0.242_04, 24.0, 1234.5, -0.013_3, 0.0, 1e-9, f64::NAN].map(|v| number(v, 3));
        assert_eq!(written, ["0.242", "24.0", "1234", "-0.0133", "0", "1.00e-9", "-"]);
    }

    #[test]
    fn rounded_zero_has_no_sign() {
        assert_eq!([-1e-9, 0.04, -0.06].map(|v| difference(v, 1)), ["0.0", "0.0", "-0.1"]);
        assert_eq!((off(2.0, 2.0), off(2.0, 2.2)), ("0.0 %".to_owned(), "+10.0 %".to_owned()));
    }

    #[test]
    fn page_escapes_text_and_figures() {
        let mut table = Table::new(&["<a>", "b"]);
        table.row(["1 < 2", "&"]);
        table.row(["3", "words"]);
        let report = Report {
            title: "A \"title\"".to_owned(),
            about: vec!["x > y".to_owned()],
            sections: vec![Section::new("s", "S").table(table).figure("<svg a=\"#%\"/>".to_owned(), "c")],
        };
        let html = report.html();
        assert!(html.contains("<td>1 &lt; 2</td><td>&amp;</td>") && html.contains("A &quot;title&quot;"));
        assert!(html.contains("src=\"data:image/svg+xml,%3Csvg a=%22%23%25%22/%3E\""));
    }
}
