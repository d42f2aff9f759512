//! `report.html`: a page about a run, as HTML that contains its figures and prints on A4.
//!
//! Tables and lines are those of the terminal ([`super::run`]). The page loads nothing: figures are part of
//! it, and fonts are those of the system.

use std::fmt::Write;

use papilio_display::result::View;
use serde_json::Value;

use super::{numbers, run as report};
use crate::ResultFile;

/// Beginnings of the names of figures that the page shows, in this order: the others repeat parts of these.
const FIGURES: [&str; 4] = ["overview", "chromaticity_xy", "light", "cone"];

const STYLE: &str = "@page{size:A4;margin:12mm}\
body{font:14px/1.4 system-ui,sans-serif;color:#222;max-width:48rem;margin:1.5rem auto;padding:0 1rem}\
h1{font-size:1.5rem;margin:0 0 .2rem}h2{font-size:1.05rem;margin:1.3rem 0 .3rem;border-bottom:1px solid #bbb}\
h3{font-size:.95rem;margin:.9rem 0 .2rem}p{margin:.3rem 0}.small{color:#555;font-size:.82rem;overflow-wrap:anywhere}\
table{border-collapse:collapse;font-size:.82rem;margin:.3rem 0}th,td{padding:.12rem .55rem .12rem 0;text-align:right;\
font-variant-numeric:tabular-nums;vertical-align:top}th{border-bottom:1px solid #888;font-weight:600}\
th:first-child,td:first-child{text-align:left}.keys td{text-align:left}.keys td:first-child{color:#555;white-space:nowrap}\
.wide{overflow-x:auto}ul{margin:.2rem 0;padding-left:1.1rem;font-size:.88rem}figure{margin:.6rem 0}figure svg{max-width:100%;height:auto}\
.columns{columns:19rem;column-gap:1.5rem}.group{break-inside:avoid}.columns h3{break-after:avoid}.columns h3:first-child{margin-top:0}\
@media print{html{font-size:11px}body{font-size:.95rem;line-height:1.2;margin:0;padding:0;max-width:none}h2{margin:.6rem 0 .2rem}h3{margin:.4rem 0 .1rem}\
th,td{padding-top:.03rem;padding-bottom:.03rem}.columns{columns:4;column-gap:1rem}figure,table,li{break-inside:avoid}h2,h3{break-after:avoid}\
figure{margin:.3rem 0}figure svg{max-height:70mm}}";

/// Content of `report.html`, the page about a run.
#[derive(Debug)]
pub struct RunReport<'a> {
    /// Title of the scenario.
    pub title: &'a str,
    /// The result.
    pub file: &'a ResultFile<'a>,
    /// Warnings of maps over all viewing directions.
    pub cone_warnings: &'a [String],
    /// Names and texts (SVG) of the figures of the run, of its light and of its maps.
    pub figures: &'a [(String, String)],
    /// True if angles are in glass.
    pub in_glass: bool,
}

impl RunReport<'_> {
    /// Returns the page.
    pub fn html(&self) -> String {
        let (file, result) = (self.file, self.file.result);
        let title = escaped(&report::plain(self.title));
        let mut page = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
             <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
        );
        list(&mut page, "Warnings", result.warnings.iter().chain(self.cone_warnings).map(String::as_str));
        self.shown_figures(&mut page, &FIGURES[..1]);
        self.results(&mut page);
        page.push_str("<h2>Scenario</h2>\n<p class=\"small\">Keys of the scenario file, with their defaults; the layers from top to \
                       bottom.</p>\n<div class=\"columns\">\n");
        for (heading, key) in
            [("Display", "display"), ("Light", "lighting"), ("Viewer", "viewer"), ("Solver", "solver")]
        {
            if let Some(table) = file.scenario.get(key) {
                let _ = writeln!(page, "<h3>{heading}</h3>");
                keys(&mut page, "", table);
            }
        }
        page.push_str("</div>\n");
        inputs(&mut page, file.scenario);
        list(&mut page, "Notes", file.notes.iter().map(String::as_str));
        self.shown_figures(&mut page, &FIGURES[1..]);
        page.push_str("<h2>Computation</h2>\n");
        paragraph(&mut page, &report::effort(result));
        let _ = writeln!(
            page,
            "<p class=\"small\">Papilio {}, seed {}, hash {}</p>",
            escaped(file.papilio),
            file.seed,
            escaped(file.hash)
        );
        page.push_str("</body>\n</html>\n");
        page
    }

    /// Tables of the states, metrics and energy balances.
    fn results(&self, page: &mut String) {
        let (result, begin) = (self.file.result, page.len());
        page.push_str("<h2>Results</h2>\n");
        if result.views.len() > report::VIEWS_IN_FULL {
            table(page, &report::rows_of_views(result));
            return;
        }
        for view in &result.views {
            let _ = writeln!(page, "<h3>{}</h3>", capital(&escaped(&report::seen_from(view, self.in_glass))));
            table(page, &report::rows_of_states(result, view));
            let lines = report::lines_of_view(result, view);
            list(page, "", lines.lines().map(str::trim).filter(|line| !line.starts_with("energy balance")));
            energy_balance(page, view);
        }
        if result.solver.paths.is_some() && numbers::has_errors(&page[begin..]) {
            paragraph(page, "0.123(4) means 0.123 with a standard error of 0.004.");
        }
    }

    /// Figures whose names begin with one of these, and those over the viewing angle.
    fn shown_figures(&self, page: &mut String, kinds: &[&str]) {
        let last = kinds.contains(&"light");
        for (number, (name, svg)) in self.figures.iter().enumerate() {
            let is_shown =
                kinds.iter().any(|kind| name.starts_with(kind)) || last && name.ends_with("_against_angle");
            if is_shown {
                let _ = writeln!(page, "<figure>{}</figure>", own_ids(svg, number));
            }
        }
    }
}

/// An SVG whose identifiers differ from those of the other figures of the page.
fn own_ids(svg: &str, number: usize) -> String {
    svg.replace("id=\"", &format!("id=\"f{number}-")).replace("url(#", &format!("url(#f{number}-"))
}

/// Energy balances of the states.
fn energy_balance(page: &mut String, view: &View) {
    let all: Vec<_> = view.ledger.iter().map(|(name, ledger)| (name, ledger.values().named())).collect();
    let used: Vec<usize> =
        (0..7).filter(|k| *k == 0 || all.iter().any(|(_, parts)| parts[*k].1.abs() > 5e-4)).collect();
    let mut rows = vec![vec!["energy balance, %".to_owned()]];
    for (name, parts) in &all {
        rows[0].truncate(1);
        rows[0].extend(used.iter().map(|k| parts[*k].0.to_owned()));
        let cells = used.iter().map(|k| numbers::unsigned_zero(format!("{:.1}", 100.0 * parts[*k].1)));
        rows.push(std::iter::once((*name).to_owned()).chain(cells).collect());
    }
    table(page, &rows);
    paragraph(
        page,
        "Energy balance of a beam from the direction of the viewer: returned, or absorbed in these parts.",
    );
}

/// A table whose first row is its head.
fn table(page: &mut String, rows: &[Vec<String>]) {
    page.push_str("<div class=\"wide\"><table>\n");
    for (number, row) in rows.iter().enumerate() {
        let tag = if number == 0 { "th" } else { "td" };
        page.push_str("<tr>");
        for cell in row {
            let _ = write!(page, "<{tag}>{}</{tag}>", escaped(cell));
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</table></div>\n");
}

/// Keys of a display in the order of its layers; other keys are in the order of the alphabet, as in
/// `result.json`.
const ORDER: [&str; 5] = ["layers", "front", "diffuser", "glass", "pixel"];

/// Keys and values of a table of the scenario; tables in it follow with their paths as headings. Empty ones
/// are left out.
fn keys(page: &mut String, path: &str, value: &Value) {
    let Value::Object(entries) = value else { return };
    let is_empty = |value: &Value| match value {
        Value::Object(entries) => entries.is_empty(),
        Value::Array(items) => items.is_empty(),
        value => value.is_null(),
    };
    let is_table = |value: &Value| match value {
        Value::Object(_) => true,
        Value::Array(items) => items.iter().any(Value::is_object),
        _ => false,
    };
    let place = |key: &str| ORDER.iter().position(|known| *known == key).unwrap_or(ORDER.len());
    let mut entries: Vec<(&String, &Value)> = entries.iter().filter(|(_, value)| !is_empty(value)).collect();
    entries.sort_by_key(|(key, _)| place(key));
    let (tables, plain): (Vec<_>, Vec<_>) = entries.into_iter().partition(|(_, value)| is_table(value));
    page.push_str("<div class=\"group\">");
    if !path.is_empty() && !plain.is_empty() {
        let _ = writeln!(page, "<p class=\"small\">{}</p>", escaped(path));
    }
    if !plain.is_empty() {
        page.push_str("<table class=\"keys\">\n");
        for (key, value) in plain {
            let _ = writeln!(page, "<tr><td>{}</td><td>{}</td></tr>", escaped(key), escaped(&short(value)));
        }
        page.push_str("</table>\n");
    }
    page.push_str("</div>\n");
    for (key, value) in tables {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        match value {
            Value::Array(items) => {
                let _ = writeln!(page, "<div class=\"group\"><p class=\"small\">{}</p>", escaped(&path));
                rows_of(page, items);
                page.push_str("</div>\n");
            }
            _ => keys(page, &path, value),
        }
    }
}

/// A list of tables as one table, with a column for each key.
fn rows_of(page: &mut String, items: &[Value]) {
    let mut names: Vec<&String> = Vec::new();
    for key in items.iter().filter_map(Value::as_object).flat_map(|entries| entries.keys()) {
        if !names.contains(&key) {
            names.push(key);
        }
    }
    let mut rows = vec![names.iter().map(|name| (*name).clone()).collect::<Vec<_>>()];
    rows.extend(
        items
            .iter()
            .map(|item| names.iter().map(|name| item.get(name).map_or(String::new(), short)).collect()),
    );
    table(page, &rows);
}

/// A value in one line.
fn short(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(items) => items.iter().map(short).collect::<Vec<_>>().join(", "),
        Value::Object(entries) => entries
            .iter()
            .map(|(key, value)| format!("{key} {}", short(value)))
            .collect::<Vec<_>>()
            .join(", "),
        other => other.to_string(),
    }
}

/// The files of the scenario.
fn inputs(page: &mut String, scenario: &Value) {
    let Some(files) = scenario.get("inputs").and_then(Value::as_object).filter(|files| !files.is_empty())
    else {
        return;
    };
    page.push_str("<h3>Files, with their SHA-256</h3>\n");
    for (name, sha) in files {
        let _ = writeln!(page, "<p class=\"small\">{}: {}</p>", escaped(name), escaped(&short(sha)));
    }
}

fn list<'a>(page: &mut String, heading: &str, items: impl Iterator<Item = &'a str>) {
    let mut items = items.filter(|item| !item.is_empty()).peekable();
    if items.peek().is_none() {
        return;
    }
    if !heading.is_empty() {
        let _ = writeln!(page, "<h2>{heading}</h2>");
    }
    page.push_str("<ul>\n");
    items.for_each(|item| _ = writeln!(page, "<li>{}</li>", escaped(item)));
    page.push_str("</ul>\n");
}

fn paragraph(page: &mut String, text: &str) {
    let _ = writeln!(page, "<p>{}</p>", escaped(text));
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn escaped(text: &str) -> String {
    let plain = crate::words::visible(text);
    plain.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
