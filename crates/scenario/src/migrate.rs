//! `papilio migrate`: the text of a scenario with the present names of its keys and values.

use crate::error::{Errors, ScenarioErrors};
use crate::mistake;
use crate::renamed::{FORMAT, changes};
use crate::scenario::parse;
use crate::tree::Value;

/// A text with present names, and the changes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Migrated {
    /// The new text, with the comments, order and layout of the old one.
    pub text: String,
    /// Each change, in the order of the text.
    pub renamed: Vec<RenamedPlace>,
    /// Whether the text describes a display or a surface.
    pub is_scenario: bool,
}

/// A replaced name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RenamedPlace {
    /// Line in the old text, from 1.
    pub line: usize,
    /// The old name, as it was written.
    pub old: String,
    /// The new name.
    pub new: String,
}

/// Converts the text of a scenario to present names, and sets its `format`.
///
/// Nothing else in the text changes. A text with present names and the present format does not change at all.
///
/// # Errors
/// If the text is not TOML, if one table has both names of a key, or if its format is newer than this
/// version.
///
/// ```
/// use papilio_scenario::migrate;
/// let old = "[solver]\nmethod = \"walk\" # the reference\n";
/// let new = migrate(old, "old.toml")?;
/// assert_eq!(new.text, "format = 2\n\n[solver]\nmethod = \"monte-carlo\" # the reference\n");
/// assert_eq!(new.renamed[0].line, 2);
/// # Ok::<(), papilio_scenario::ScenarioErrors>(())
/// ```
pub fn migrate(text: &str, name: &str) -> Result<Migrated, ScenarioErrors> {
    let sources = parse(text, name, &[])?;
    let root = sources.document();
    // Places do not count a byte order mark.
    let mut new = text.strip_prefix('\u{feff}').unwrap_or(text).to_owned();
    let mut errors = Errors::default();
    let found = changes(&new, root, &mut errors);
    let format = root.get("format");
    match format.map(|node| (&node.value, node.origin)) {
        Some((Value::Integer(number), origin)) if *number > FORMAT as i64 => {
            errors.push(origin, mistake::newer_format(*number, FORMAT));
        }
        _ => {}
    }
    errors.check(&sources)?;
    let line = |at: usize| new.get(..at).unwrap_or_default().matches('\n').count() + 1;
    let mut renamed: Vec<RenamedPlace> = found
        .iter()
        .map(|(range, name)| RenamedPlace {
            line: line(range.start),
            old: name.old.clone(),
            new: name.new.clone(),
        })
        .collect();
    renamed.reverse();
    // From the last to the first, so that the places of the remaining names stay valid.
    for (range, name) in found {
        new.replace_range(range, &name.new);
    }
    let text = stated(&new, format.is_some());
    // Both names of one key, where a table holds paths.
    parse(&text, name, &[])?;
    let is_scenario = ["display", "microgeometry"].iter().any(|table| root.get(table).is_some());
    Ok(Migrated { text, renamed, is_scenario })
}

/// The text with `format = 2`: in the place of another number, or above the first key, below the comment that
/// opens the file.
fn stated(text: &str, is_there: bool) -> String {
    let line = format!("format = {FORMAT}");
    if is_there {
        let mut root_lines = true;
        let lines = text.split_inclusive('\n').map(|old| {
            root_lines &= !old.trim_start().starts_with('[');
            let Some((key, value)) =
                old.split_once('=').filter(|(key, _)| root_lines && key.trim() == "format")
            else {
                return old.to_owned();
            };
            let lead = value.len() - value.trim_start().len();
            let end = value[lead..]
                .find(|c: char| !c.is_ascii_digit() && c != '_')
                .map_or(value.len(), |end| lead + end);
            format!("{key}={}{FORMAT}{}", &value[..lead], &value[end..])
        });
        return lines.collect();
    }
    let is_comment = |line: &str| line.starts_with('#');
    let mut at = 0;
    for line in text.split_inclusive('\n').take_while(|line| is_comment(line)) {
        at += line.len();
    }
    // A comment directly above a key belongs to the key, not to the file.
    let rest = &text[at..];
    let opens = rest.is_empty() || rest.starts_with(['\n', '\r']);
    let (head, rest) = if opens { text.split_at(at) } else { ("", text) };
    let begin = if head.is_empty() || head.ends_with('\n') { "" } else { "\n" };
    let (above, body) =
        if head.is_empty() { ("", rest) } else { ("\n", rest.trim_start_matches(['\n', '\r'])) };
    let is_key = body
        .lines()
        .next()
        .is_some_and(|line| !line.trim_start().starts_with(['[', '#']) && line.contains('='));
    let below = if is_key || body.is_empty() { "\n" } else { "\n\n" };
    format!("{head}{begin}{above}{line}{below}{body}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn format_is_stated_once_below_the_opening_comment() {
        for (old, new) in [
            ("", "format = 2\n"),
            ("title = \"a\"\n", "format = 2\ntitle = \"a\"\n"),
            ("# A display.\n\ntitle = \"a\"\n", "# A display.\n\nformat = 2\ntitle = \"a\"\n"),
            ("# A display.\n# More.\n\n[solver]\n", "# A display.\n# More.\n\nformat = 2\n\n[solver]\n"),
            ("# Of the solver.\n[solver]\n", "format = 2\n\n# Of the solver.\n[solver]\n"),
            ("title = \"a\"\nformat  = 1 # old\n", "title = \"a\"\nformat  = 2 # old\n"),
            ("format = 2\n", "format = 2\n"),
        ] {
            let migrated = migrate(old, "test.toml").unwrap();
            assert_eq!(migrated.text, new);
            assert!(migrated.renamed.is_empty());
            assert_eq!(migrate(new, "test.toml").unwrap().text, new, "a second time changes nothing");
        }
    }

    #[test]
    fn newer_format_and_both_names_are_refused() {
        for (text, message) in [
            ("format = 3\n", "format 3"),
            ("[solver]\nevery_bin = true\nper_wavelength = true\n", "two names of one key"),
            ("[solver\n", "error"),
        ] {
            let error = migrate(text, "test.toml").unwrap_err().to_string();
            assert!(error.contains(message) && error.contains("test.toml:"), "{error}");
        }
    }
}
