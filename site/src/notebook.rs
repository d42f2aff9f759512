//! Notebooks of Jupyter as pages: cells of text and code, with the output that the file holds.

use std::fmt::Write as _;

use serde_json::Value;

use crate::document::Document;
use crate::html::escape;
use crate::links::encoded;
use crate::{Problem, highlight};

/// Word after the fence of a block in whose place an output stands.
pub(crate) const OUTPUT: &str = "papilio-output";

/// Reads a notebook; `source` is its path in the repository. `None` if the file is none.
pub(crate) fn read(source: &str, json: &str) -> Option<(Document, Vec<Problem>)> {
    let notebook: Value = serde_json::from_str(json).ok()?;
    let mut text = String::new();
    let mut outputs = Vec::new();
    for cell in notebook["cells"].as_array()? {
        let code = joined(&cell["source"]);
        match cell["cell_type"].as_str()? {
            "markdown" => {
                let _ = write!(text, "{code}\n\n");
            }
            "code" => {
                let _ = write!(text, "{}python\n{code}\n{}\n\n", fence(&code), fence(&code));
                for html in cell["outputs"].as_array()?.iter().filter_map(output) {
                    let _ = write!(text, "```{OUTPUT}\n{}\n```\n\n", outputs.len());
                    outputs.push(html);
                }
            }
            _ => {}
        }
    }
    let (page, problems) = Document::read(source, text);
    Some((Document { outputs, ..page }, problems))
}

/// A fence that is longer than all in the code.
fn fence(code: &str) -> String {
    let longest = code.split(|c| c != '`').map(str::len).max().unwrap_or(0);
    "`".repeat(longest.max(2) + 1)
}

/// HTML of an output: its richest form.
fn output(output: &Value) -> Option<String> {
    let data = &output["data"];
    let form = |kind: &str| data.get(kind).map(joined).filter(|text| !text.is_empty());
    let alternative = escape(&form("text/plain").unwrap_or_default());
    let picture = |address: String| {
        format!("<figure class=\"result\"><img src=\"{address}\" alt=\"{alternative}\"></figure>\n")
    };
    if let Some(svg) = form("image/svg+xml") {
        return Some(picture(format!("data:image/svg+xml,{}", encoded(&svg))));
    }
    if let Some(png) = form("image/png") {
        return Some(picture(format!("data:image/png;base64,{}", png.replace('\n', ""))));
    }
    if let Some(html) = form("text/html") {
        // A heading of an output is none of the page.
        let html = html.replace("<h4>", "<p><strong>").replace("</h4>", "</strong></p>");
        return Some(format!("<div class=\"result table\">{html}</div>\n"));
    }
    let text = form("text/plain").unwrap_or_else(|| joined(&output["text"]));
    let shown = highlight::highlight(&text, "text");
    (!text.is_empty()).then(|| format!("<div class=\"code result\"><pre><code>{shown}</code></pre></div>\n"))
}

/// A text, which a notebook may split into lines.
fn joined(text: &Value) -> String {
    match text {
        Value::Array(lines) => lines.iter().filter_map(Value::as_str).collect(),
        other => other.as_str().unwrap_or_default().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notebook_becomes_a_page_with_its_outputs() {
        let json = r##"{"cells": [
            {"cell_type": "markdown", "source": ["# A title\n", "\n", "Text with a [link](x.md)."]},
            {"cell_type": "code", "source": "1 + 1", "outputs": [
                {"output_type": "execute_result", "data": {"text/plain": ["2"]}},
                {"output_type": "stream", "text": ["a <b>\n", "c"]},
                {"output_type": "execute_result", "data": {"image/svg+xml": "<svg/>", "text/plain": "a figure"}}
            ]}
        ]}"##;
        let (page, problems) = read("docs/a.ipynb", json).unwrap();
        assert!(problems.is_empty(), "{problems:?}");
        assert_eq!((page.title.as_str(), page.links.len(), page.outputs.len()), ("A title", 1, 3));
        assert!(page.outputs[1].contains("a &lt;b&gt;\nc"), "{}", page.outputs[1]);
        assert!(page.outputs[2].contains("src=\"data:image/svg+xml,%3Csvg/%3E\" alt=\"a figure\""));
        assert!(page.text.contains("```python\n1 + 1\n```\n\n```papilio-output\n0\n```"), "{}", page.text);
        assert!(read("docs/a.ipynb", "{}").is_none());
    }
}
