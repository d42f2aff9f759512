//! Mistakes that are found in several places, and what code has to know of a mistake.
//!
//! A mistake is a [`Diagnostic`], written where it is found. What stands here is found in more than one place.

use papilio_diagnostics::{Diagnostic, nearest, quoted, suggestion};
use papilio_formats::FormatError;
use papilio_goniometry::GoniometryError;
use papilio_spectra::SpectraError;

/// What code has to know of a mistake, beside its words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MistakeKind {
    /// The path of a key is wrong, whatever its value.
    Path,
    /// A key that must be there is not: this one, below the table where the mistake stands.
    MissingKey(String),
    /// A number is outside its range.
    OutOfRange,
    /// A file cannot be opened or read.
    Unreadable,
    /// Anything else.
    Other,
}

/// A mistake as it is found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mistake {
    pub(crate) kind: MistakeKind,
    pub(crate) diagnostic: Diagnostic,
}

impl From<Diagnostic> for Mistake {
    fn from(diagnostic: Diagnostic) -> Self {
        Self { kind: MistakeKind::Other, diagnostic }
    }
}

impl From<SpectraError> for Mistake {
    fn from(error: SpectraError) -> Self {
        Diagnostic::new(error.to_string()).into()
    }
}

impl From<GoniometryError> for Mistake {
    fn from(error: GoniometryError) -> Self {
        Diagnostic::new(error.to_string()).into()
    }
}

impl From<papilio_formats::Problem> for Mistake {
    fn from(problem: papilio_formats::Problem) -> Self {
        let kind = match problem {
            papilio_formats::Problem::Unreadable { .. } => MistakeKind::Unreadable,
            _ => MistakeKind::Other,
        };
        Self { kind, diagnostic: problem.diagnostic() }
    }
}

impl From<FormatError> for Mistake {
    fn from(error: FormatError) -> Self {
        error.problem.into()
    }
}

/// A mistake in the path of a key.
pub(crate) fn of_path(diagnostic: Diagnostic) -> Mistake {
    Mistake { kind: MistakeKind::Path, diagnostic }
}

/// A key that the table does not have.
pub(crate) fn unknown_key(key: &str, known: &[&str]) -> Mistake {
    let hint = suggestion(key, known.iter().copied(), "keys");
    of_path(Diagnostic::new(format!("there is no key `{key}` here")).hint(hint))
}

/// A key or a word that a later version will have.
pub(crate) fn not_in_this_version(what: &str, choices: &[&str]) -> Mistake {
    let hint = match choices {
        [] => "remove it".to_owned(),
        _ => format!("this version has {}", quoted(choices.iter().copied())),
    };
    of_path(Diagnostic::new(format!("`{what}` is not in this version")).hint(hint))
}

/// A key that must be there.
pub(crate) fn missing_key(key: &str, expected: impl std::fmt::Display) -> Mistake {
    let diagnostic = Diagnostic::new(format!("the key `{key}` is missing")).expected(expected);
    Mistake { kind: MistakeKind::MissingKey(key.to_owned()), diagnostic }
}

/// A list with another number of items than it should have.
pub(crate) fn another_length(expected: impl std::fmt::Display) -> Diagnostic {
    Diagnostic::new("this is a list of another length").expected(expected)
}

/// A number outside its range.
pub(crate) fn out_of_range(value: f64, expected: impl std::fmt::Display) -> Mistake {
    let diagnostic = Diagnostic::new(format!("{} is out of range", written(value))).expected(expected);
    Mistake { kind: MistakeKind::OutOfRange, diagnostic }
}

/// A number that does not count what it should.
pub(crate) fn no_such_count(value: f64, expected: impl std::fmt::Display) -> Diagnostic {
    let wrong = if value.fract() == 0.0 { "out of range" } else { "not a whole number" };
    Diagnostic::new(format!("{value} is {wrong}")).expected(expected)
}

/// A word that is none of the choices.
pub(crate) fn unknown_choice(found: &str, choices: &[&str]) -> Diagnostic {
    let hint = match found {
        "slab" => Some("a slab is a layer of its own: kind = \"slab\"".to_owned()),
        _ => nearest(found, choices.iter().copied()).map(|near| format!("did you mean `{near}`?")),
    };
    let message = format!("`{found}` is not one of the choices");
    Diagnostic::new(message).expected(quoted(choices.iter().copied())).hint_if(hint)
}

/// A material or light that is neither a name nor a file.
pub(crate) fn unknown_name(kind: &str, name: &str, names: &[&str]) -> Diagnostic {
    Diagnostic::new(format!("there is no {kind} named `{name}`, and no such file")).hint(suggestion(
        name,
        names.iter().copied(),
        "names",
    ))
}

/// A state that the pixel does not have.
pub(crate) fn no_such_state(name: &str, known: &[String]) -> Diagnostic {
    let hint = suggestion(name, known.iter().map(String::as_str), "states");
    Diagnostic::new(format!("there is no state `{name}`")).hint(hint)
}

/// The pixel has no states; `remedy`: how to give it one.
pub(crate) fn no_states(remedy: &str) -> Diagnostic {
    Diagnostic::new("this pixel has no states").hint(remedy)
}

/// A key without which another makes no sense, or beside which it makes none.
pub(crate) fn not_with(key: &str, beside: &str) -> Diagnostic {
    Diagnostic::new(format!("`{key}` cannot be combined with {beside}")).hint(format!("remove `{key}`"))
}

/// Of several keys exactly one must be there.
pub(crate) fn exactly_one(keys: &str, given: usize) -> Diagnostic {
    let number = if given == 0 { "none" } else { "more than one" };
    Diagnostic::new(format!("{number} of {keys} is given")).expected(format!("exactly one of {keys}"))
}

/// Too many of something for one computation.
pub(crate) fn too_many(what: &str, count: f64, limit: usize) -> Diagnostic {
    let hint = what
        .contains("wavelengths")
        .then_some("use a larger spectrum.step_nm, or fewer of the other factors");
    Diagnostic::new(format!("these are {count} {what}")).expected(format!("at most {limit}")).hint_if(hint)
}

/// A list without items.
pub(crate) fn empty_list() -> Diagnostic {
    Diagnostic::new("this list is empty").expected("at least one item")
}

/// Numbers that should make a whole.
pub(crate) fn sum(what: &str, sum: f64, expected: &str) -> Diagnostic {
    Diagnostic::new(format!("{what} sum to {}", tidy(sum))).expected(expected)
}

/// A range whose end is not above its beginning.
pub(crate) fn empty_range(from: f64, to: f64) -> Diagnostic {
    Diagnostic::new(format!("nothing lies between {from} and {to}"))
        .expected("an end that is larger than the beginning")
}

/// A part of the hemisphere that is not one: a "ring", a "cap" or a "region".
pub(crate) fn edges(what: &str, from_deg: f64, to_deg: f64, expected: impl std::fmt::Display) -> Diagnostic {
    Diagnostic::new(format!("this {what} reaches from {} to {} deg", tidy(from_deg), tidy(to_deg)))
        .expected(expected)
}

/// Something that dips below the display's horizon: a "cone" or a "luminaire".
pub(crate) fn below_horizon(what: &str, theta_deg: f64) -> Diagnostic {
    let reach = (theta_deg * 100.0).round() / 100.0;
    Diagnostic::new(format!("this {what} reaches {reach} deg from the normal")).expected("less than 90 deg")
}

/// Light that does not reach the display.
pub(crate) fn dark_field() -> Diagnostic {
    Diagnostic::new("none of this light falls on the display")
}

/// Data that do not cover the wavelengths that are needed.
pub(crate) fn not_covered(what: &str, have: (f64, f64), needed: (f64, f64)) -> Diagnostic {
    let shared = (have.0.max(needed.0).ceil(), have.1.min(needed.1).floor());
    let range = match shared.0 < shared.1 {
        true => format!("set spectrum.range_nm within [{}, {}]", shared.0, shared.1),
        false => "change spectrum.range_nm".to_owned(),
    };
    Diagnostic::new(format!("`{what}` reaches from {} to {} nm", have.0, have.1))
        .expected(format!("{} to {} nm", needed.0, needed.1))
        .hint(format!("data are not extrapolated: extend them, or {range}"))
}

/// Wavelengths that no eye sees.
pub(crate) fn invisible(range_nm: (f64, f64)) -> Diagnostic {
    Diagnostic::new(format!("nothing between {} and {} nm is visible", range_nm.0, range_nm.1))
        .expected("a range with a part of 380 to 780 nm")
}

/// What the parser says of a text that is not TOML.
pub(crate) fn syntax(message: &str) -> Diagnostic {
    let of_number = ["mantissa", "fraction", "float", "leading zero"];
    let hint = if of_number.iter().any(|word| message.contains(word)) {
        Some("write numbers with digits on both sides of the point and no more: 0.50, 5.0")
    } else {
        message.contains("basic string").then_some("a string ends with the double quote that it begins with")
    };
    Diagnostic::new(message).hint_if(hint)
}

/// A number as a reader writes it: without the digits that are rounding, and with an exponent where it is very large or small.
fn written(value: f64) -> String {
    let short: f64 = format!("{value:.9e}").parse().unwrap_or(value);
    if short == 0.0 || (1e-6..1e16).contains(&short.abs()) || !short.is_finite() {
        short.to_string()
    } else {
        format!("{short:e}")
    }
}

/// A sum of decimal fractions as a reader writes it: to a millionth.
pub(crate) fn tidy(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}
