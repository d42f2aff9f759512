//! Remedies of a mistake, which each interface of the program states in its own words.

use std::borrow::Cow;

/// Interface by which the program is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interface {
    /// The command line.
    CommandLine,
    /// The Python package.
    Python,
    /// The web app.
    Page,
}

/// What mends a mistake.
///
/// ```
/// use papilio_diagnostics::{Diagnostic, Interface, Remedy};
/// let wrong = Diagnostic::new("too narrow").hint("use the other solver").remedy(Remedy::key("solver.method", "\"adding\""));
/// let help = |interface| wrong.help(interface).unwrap();
/// assert_eq!(help(Interface::CommandLine), "use the other solver: --set solver.method=adding");
/// assert_eq!(help(Interface::Python), "use the other solver: set={\"solver.method\": \"adding\"}");
/// assert_eq!(help(Interface::Page), "use the other solver: solver.method = \"adding\"");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Remedy {
    /// A value of a key of the scenario.
    Key {
        /// Path of the key.
        path: String,
        /// Its value as JSON: a number, or a string without quotes and control characters in it.
        json: String,
    },
    /// An option of the command, which is an argument of the Python function.
    Option {
        /// Name on the command line, without hyphens before it.
        name: &'static str,
        /// Value, a number.
        value: String,
    },
    /// What the command line alone has, in words.
    OnCommandLine(String),
}

impl Remedy {
    /// Creates the remedy of a key; `json` is its value.
    pub fn key(path: impl Into<String>, json: impl Into<String>) -> Self {
        Self::Key { path: path.into(), json: json.into() }
    }

    /// States remedies in the words of an interface; `None` if it has none of them.
    pub fn words(all: &[Self], interface: Interface) -> Option<String> {
        let each: Vec<String> = all.iter().filter_map(|one| one.in_words_of(interface)).collect();
        let keys = all.iter().all(|one| matches!(one, Self::Key { .. }));
        let words = match interface {
            Interface::Python if keys => format!("set={{{}}}", each.join(", ")),
            Interface::CommandLine => each.join(" "),
            Interface::Python | Interface::Page => each.join(", "),
        };
        (!each.is_empty()).then_some(words)
    }

    fn in_words_of(&self, interface: Interface) -> Option<String> {
        match (self, interface) {
            (Self::Key { path, json }, Interface::CommandLine) => {
                Some(format!("--set {}", for_shell(path, json)))
            }
            (Self::Key { path, json }, Interface::Python) => Some(format!("\"{path}\": {json}")),
            (Self::Key { path, json }, Interface::Page) => Some(format!("{path} = {json}")),
            (Self::Option { name, value }, Interface::CommandLine) => Some(format!("--{name} {value}")),
            (Self::Option { name, value }, Interface::Python) => {
                Some(format!("{}={value}", name.replace('-', "_")))
            }
            (Self::Option { name, value }, Interface::Page) => {
                Some(format!("{} = {value}", name.replace('-', " ")))
            }
            (Self::OnCommandLine(words), Interface::CommandLine) => Some(words.clone()),
            (Self::OnCommandLine(_), Interface::Python | Interface::Page) => None,
        }
    }
}

/// `PATH=VALUE` as a word of a shell: a plain string needs no quotes.
fn for_shell(path: &str, json: &str) -> String {
    let is_plain = |text: &str| text.chars().all(|c| c.is_ascii_alphanumeric() || "._-".contains(c));
    let bare = json.strip_prefix('"').and_then(|text| text.strip_suffix('"')).filter(|text| is_plain(text));
    let word = format!("{path}={}", bare.map_or(Cow::Borrowed(json), Cow::Borrowed));
    if word.chars().all(|c| c == '=' || is_plain(&c.to_string())) { word } else { format!("'{word}'") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Several keys are one argument in Python; what one interface lacks leaves the hint alone.
    #[test]
    fn remedies_are_in_the_words_of_each_interface() {
        let views = [Remedy::key("viewer.theta_deg", "0"), Remedy::key("states.\"a b\".Y", "0.5")];
        let words = |all: &[Remedy]| {
            [Interface::CommandLine, Interface::Python, Interface::Page].map(|one| Remedy::words(all, one))
        };
        assert_eq!(
            words(&views[..1]).map(Option::unwrap),
            ["--set viewer.theta_deg=0", "set={\"viewer.theta_deg\": 0}", "viewer.theta_deg = 0"]
        );
        let [shell, ..] = words(&views).map(Option::unwrap);
        assert_eq!(shell, "--set viewer.theta_deg=0 --set 'states.\"a b\".Y=0.5'");
        let option = [Remedy::Option { name: "allow-error", value: "0.03".to_owned() }];
        assert_eq!(
            words(&option).map(Option::unwrap),
            ["--allow-error 0.03", "allow_error=0.03", "allow error = 0.03"]
        );
        let alone = [Remedy::OnCommandLine("--axis KEY=VALUES".to_owned())];
        assert_eq!(words(&alone), [Some("--axis KEY=VALUES".to_owned()), None, None]);
    }
}
