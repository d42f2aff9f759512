//! Colours of code blocks: comments, strings, numbers, keys, commands and keywords as spans with a class.
//!
//! The few languages of the pages need no grammar: what a token is depends on its first characters, and on
//! where the line begins. Text of an unknown language is only escaped.

use crate::html::escape;

/// Rules of a language.
struct Rules {
    comment: &'static str,
    /// Quotes that begin a string, the longest first.
    quotes: &'static [&'static str],
    keywords: &'static [&'static str],
}

const PYTHON: Rules = Rules {
    comment: "#",
    quotes: &["\"\"\"", "'''", "\"", "'"],
    keywords: &[
        "and", "as", "assert", "async", "await", "break", "class", "continue", "def", "del", "elif", "else",
        "except", "False", "finally", "for", "from", "global", "if", "import", "in", "is", "lambda", "None",
        "nonlocal", "not", "or", "pass", "raise", "return", "True", "try", "while", "with", "yield",
    ],
};

const TOML: Rules =
    Rules { comment: "#", quotes: &["\"\"\"", "'''", "\"", "'"], keywords: &["true", "false", "inf", "nan"] };

const SHELL: Rules = Rules {
    comment: "#",
    quotes: &["\"", "'"],
    keywords: &["if", "then", "else", "fi", "for", "do", "done", "in", "while", "case", "esac", "export"],
};

const RUST: Rules = Rules {
    comment: "//",
    quotes: &["\""],
    keywords: &[
        "as", "async", "await", "break", "const", "continue", "crate", "else", "enum", "false", "fn", "for",
        "if", "impl", "in", "let", "loop", "match", "mod", "move", "mut", "pub", "ref", "return", "self",
        "Self", "static", "struct", "super", "trait", "true", "type", "unsafe", "use", "where", "while",
    ],
};

const JSON: Rules = Rules { comment: "//", quotes: &["\""], keywords: &["true", "false", "null"] };

/// Returns the HTML of a code block. `language` is the word after the fence, or the extension of a file.
pub(crate) fn highlight(code: &str, language: &str) -> String {
    match language {
        "python" | "py" | "pycon" if code.starts_with(">>> ") => session(code),
        "python" | "py" => tokens(code, &PYTHON, |_, _| None),
        "toml" => code.split_inclusive('\n').map(toml_line).collect(),
        "sh" | "bash" | "console" => tokens(code, &SHELL, command),
        "rust" | "rs" => tokens(code, &RUST, |_, _| None),
        "json" | "ipynb" => tokens(code, &JSON, |_, _| None),
        _ => escape(code),
    }
}

/// A Python session: lines after a prompt are code, the others what Python prints.
fn session(code: &str) -> String {
    let mut written = String::new();
    for line in code.split_inclusive('\n') {
        let prompt = [">>> ", "... "].into_iter().find(|prompt| line.starts_with(prompt));
        match prompt {
            Some(prompt) => {
                span("prompt", prompt, &mut written);
                written += &tokens(&line[prompt.len()..], &PYTHON, |_, _| None);
            }
            None if line.trim().is_empty() || line.trim_end() == "..." => written += &escape(line),
            None => span("output", line, &mut written),
        }
    }
    written
}

/// A line of TOML: the header of a table, or a key and its value.
fn toml_line(line: &str) -> String {
    let mut written = String::new();
    let start = line.trim_start();
    if start.starts_with('[') && !start.contains('=') && !start.trim_end().ends_with(',') {
        let end = line.find('#').unwrap_or(line.len());
        let end = line[..end].trim_end().len();
        span("table", &line[..end], &mut written);
        return written + &tokens(&line[end..], &TOML, |_, _| None);
    }
    let is_key = |c: char| c.is_ascii_alphanumeric() || "_-.\"' ".contains(c);
    let mut value = line;
    if let Some((key, _)) = line.split_once('=').filter(|(key, _)| !key.is_empty() && key.chars().all(is_key))
    {
        span("key", key, &mut written);
        value = &line[key.len()..];
    }
    // Keys of inline tables.
    let inner = |rest: &str, before: &str| {
        let word = word_at(rest);
        let follows = rest[word.len()..].trim_start().starts_with('=');
        (follows && before.trim_end().ends_with(['{', ','])).then_some("key")
    };
    written + &tokens(value, &TOML, inner)
}

/// Classes of a shell's words: the first of a command, and options.
fn command(rest: &str, before: &str) -> Option<&'static str> {
    let line = before.rsplit('\n').next().unwrap_or_default().trim_end();
    let is_first = line.is_empty() || line.ends_with(['|', ';', '&', '(']);
    match rest.starts_with('-') && before.ends_with([' ', '\n']) {
        true => Some("option"),
        false if is_first && !before.trim_end_matches([' ', '\n']).ends_with('\\') => Some("command"),
        false => None,
    }
}

/// Splits code into tokens. `special` may give a word its class, from the text at and before it.
fn tokens(code: &str, rules: &Rules, special: impl Fn(&str, &str) -> Option<&'static str>) -> String {
    let mut written = String::new();
    let mut at = 0;
    while let Some(first) = code[at..].chars().next() {
        let (rest, before) = (&code[at..], &code[..at]);
        let begins_word = !before.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let word = word_at(rest);
        let (length, class) =
            if rest.starts_with(rules.comment) && before.chars().last().is_none_or(char::is_whitespace) {
                (rest.find('\n').unwrap_or(rest.len()), Some("comment"))
            } else if let Some(quote) = rules.quotes.iter().find(|quote| rest.starts_with(**quote)) {
                (string_length(rest, quote), Some("string"))
            } else if begins_word && !word.is_empty() {
                let keyword = rules.keywords.contains(&word).then_some("keyword");
                let number = first.is_ascii_digit().then_some("number");
                (word.len(), special(rest, before).or(keyword).or(number))
            } else {
                (first.len_utf8(), None)
            };
        match class {
            Some(class) => span(class, &rest[..length], &mut written),
            None => written += &escape(&rest[..length]),
        }
        at += length;
    }
    written
}

/// The word or number at the start of a text; may be empty.
fn word_at(rest: &str) -> &str {
    let is_number = rest.starts_with(|c: char| c.is_ascii_digit());
    let inside = |c: char| c.is_alphanumeric() || c == '_' || (is_number && c == '.');
    let dashes = rest.len() - rest.trim_start_matches('-').len();
    let is_option =
        (1..=2).contains(&dashes) && rest[dashes..].starts_with(|c: char| c.is_ascii_alphabetic());
    let start = if is_option { dashes } else { 0 };
    let inside = |c: char| inside(c) || (is_option && c == '-');
    let end = rest[start..].find(|c| !inside(c)).map_or(rest.len(), |end| start + end);
    if end == start { "" } else { &rest[..end] }
}

/// Length of a string, with its quotes. A string that does not end ends with its line.
fn string_length(rest: &str, quote: &str) -> usize {
    let mut at = quote.len();
    while let Some(next) = rest[at..].chars().next() {
        if rest[at..].starts_with(quote) {
            return at + quote.len();
        }
        if next == '\n' && quote.len() == 1 {
            return at;
        }
        at += next.len_utf8();
        if next == '\\' {
            at += rest[at..].chars().next().map_or(0, char::len_utf8);
        }
    }
    at
}

fn span(class: &str, text: &str, written: &mut String) {
    // The line's end stays outside: a span should not cross lines.
    let inner = text.trim_end_matches('\n');
    if !inner.is_empty() {
        *written += &format!("<span class=\"{class}\">{}</span>", escape(inner));
    }
    *written += &text[inner.len()..];
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The text without its spans.
    fn plain(html: &str) -> String {
        let mut text = String::new();
        for part in html.split('<') {
            text += part.split_once('>').map_or(part, |(_, after)| after);
        }
        text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&")
    }

    #[test]
    fn toml_shows_tables_keys_strings_and_comments() {
        let shown =
            highlight("[display.pixel]  # the pixel\nmodel = \"film\"\narea = { red = 0.5 }\n", "toml");
        assert!(shown.contains(r#"<span class="table">[display.pixel]</span>"#), "{shown}");
        assert!(shown.contains(r#"<span class="comment"># the pixel</span>"#), "{shown}");
        assert!(shown.contains(r#"<span class="string">&quot;film&quot;</span>"#), "{shown}");
        assert!(
            shown.contains(r#"<span class="key">red</span> = <span class="number">0.5</span>"#),
            "{shown}"
        );
    }

    #[test]
    fn shell_shows_commands_options_and_comments() {
        let shown = highlight("papilio run x.toml --set a.b='c d' | jq '.x'  # all\n", "sh");
        assert!(shown.contains(r#"<span class="command">papilio</span> run"#), "{shown}");
        assert!(shown.contains(r#"<span class="command">jq</span>"#), "{shown}");
        assert!(shown.contains(r#"<span class="option">--set</span>"#), "{shown}");
        assert!(shown.contains(r#"<span class="comment"># all</span>"#), "{shown}");
    }

    #[test]
    fn python_session_separates_code_and_output() {
        let shown = highlight(">>> for x in a:\n...     x\n'text'\n", "python");
        assert!(
            shown.contains(r#"<span class="prompt">&gt;&gt;&gt; </span><span class="keyword">for</span>"#),
            "{shown}"
        );
        assert!(shown.contains(r#"<span class="output">'text'</span>"#), "{shown}");
    }

    #[test]
    fn text_of_code_is_unchanged_by_its_colours() {
        let code = "a = \"unended\nb = 'x\\'y' # c\n--x -1 1e-3 \u{3b8} <&>\n\"\"\"long\nstring";
        for language in ["toml", "sh", "python", "rust", "json", "text", "unknown"] {
            assert_eq!(plain(&highlight(code, language)), code, "{language}");
        }
    }
}
