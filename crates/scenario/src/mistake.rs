//! Kinds of mistakes, and messages that are used in several places.
//!
//! A mistake is a [`Diagnostic`]. Messages that are used once are written where the mistake is found.

use std::collections::HashSet;

use papilio_diagnostics::{Diagnostic, Remedy, did_you_mean, nearest, number, quoted, suggestion};
use papilio_display::scene::Metric;
use papilio_formats::FormatError;
use papilio_goniometry::GoniometryError;
use papilio_spectra::{
    SpectraError, illuminant_names, illuminants_called, liquid_crystal_names, material_names,
    materials_called, named_daylight_k,
};

use crate::error::Errors;
use crate::origin::Origin;

/// Kind of a mistake, for programs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MistakeKind {
    /// The path of a key is wrong, whatever its value.
    Path,
    /// Required keys of a table are missing: at least one.
    MissingKeys(Vec<MissingKey>),
    /// A number is outside its range.
    OutOfRange,
    /// A file cannot be opened or read.
    Unreadable,
    /// Any other mistake.
    Other,
}

/// A mistake: a message with its kind.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mistake {
    pub(crate) kind: MistakeKind,
    pub(crate) diagnostic: Diagnostic,
}

/// A required key that a table lacks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingKey {
    /// The key as messages name it: its name, or its whole path.
    pub name: String,
    /// Its name below the table at the place of the mistake.
    pub below: String,
    /// What it may be.
    pub expected: String,
}

impl Mistake {
    /// Creates the mistake of missing keys, at least one: one message names all of them.
    fn missing(keys: Vec<MissingKey>) -> Self {
        let names: Vec<String> = keys.iter().map(|key| format!("`{}`", key.name)).collect();
        let diagnostic = match (&keys[..], names.split_last()) {
            ([key], _) => {
                Diagnostic::new(format!("the key `{}` is missing", key.name)).expected(&key.expected)
            }
            (_, Some((last, others))) => {
                let each: Vec<String> =
                    keys.iter().zip(&names).map(|(key, name)| format!("{name}: {}", key.expected)).collect();
                Diagnostic::new(format!("the keys {} and {last} are missing", others.join(", ")))
                    .expected(each.join("; "))
            }
            (_, None) => Diagnostic::new("a key is missing"),
        };
        Self { kind: MistakeKind::MissingKeys(keys), diagnostic }
    }

    /// Adds another mistake at the same place, if both are missing keys.
    pub(crate) fn takes(&mut self, other: &Self) -> bool {
        let (MistakeKind::MissingKeys(own), MistakeKind::MissingKeys(others)) = (&self.kind, &other.kind)
        else {
            return false;
        };
        let Diagnostic { message, expected, .. } = {
            let all = Self::missing([&own[..], others].concat());
            self.kind = all.kind;
            all.diagnostic
        };
        let (own, other) = (&mut self.diagnostic, other.diagnostic.clone());
        (own.message, own.expected) = (message, expected);
        own.hint = own.hint.take().or(other.hint);
        own.remedies.extend(other.remedies);
        own.note = own.note.take().or(other.note);
        true
    }
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
    let hint = if key.contains(['"', '\'']) {
        "quotes belong about a single key with a point in its name, as in states.\"a.b\".file; other keys have none".to_owned()
    } else {
        suggestion(key, known.iter().copied(), "keys")
    };
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

/// A required key that is missing.
pub(crate) fn missing_key(key: &str, expected: impl std::fmt::Display) -> Mistake {
    missing_path(key, key, expected)
}

/// A required key that is missing, by its whole path; `below` is its name below the table at the place of the mistake.
pub(crate) fn missing_path(path: &str, below: &str, expected: impl std::fmt::Display) -> Mistake {
    let (name, below, expected) = (path.to_owned(), below.to_owned(), expected.to_string());
    Mistake::missing(vec![MissingKey { name, below, expected }])
}

/// A length that is missing, on which the places of light depend.
pub(crate) fn missing_length(path: &str, below: &str) -> Mistake {
    let mut wrong = missing_path(path, below, "a length in mm");
    let why = "where light leaves depends on the thickness of all layers that it crosses obliquely, from the pixel to the \
               highest layer that scatters or reflects it; a missing thickness is not guessed";
    wrong.diagnostic = wrong
        .diagnostic
        .note(why)
        .hint("measure it, or try half a millimetre")
        .remedy(Remedy::key(path, "0.5"));
    wrong
}

/// A list with the wrong number of items.
pub(crate) fn another_length(expected: impl std::fmt::Display) -> Diagnostic {
    Diagnostic::new("this list has the wrong length").expected(expected)
}

/// A number outside its range.
pub(crate) fn out_of_range(value: f64, expected: impl std::fmt::Display) -> Mistake {
    let diagnostic = Diagnostic::new(format!("{} is out of range", number(value))).expected(expected);
    Mistake { kind: MistakeKind::OutOfRange, diagnostic }
}

/// A number that is not an integer, or an integer outside its range.
pub(crate) fn no_such_count(value: f64, expected: impl std::fmt::Display) -> Diagnostic {
    let wrong = if value.fract() == 0.0 { "out of range" } else { "not a whole number" };
    Diagnostic::new(format!("{} is {wrong}", number(value))).expected(expected)
}

/// A word that is not one of the choices.
pub(crate) fn unknown_choice(found: &str, choices: &[&str]) -> Diagnostic {
    let hint = match found {
        "slab" => Some("a slab is a layer of its own: kind = \"slab\"".to_owned()),
        _ => nearest(found, choices.iter().copied()).map(|near| format!("did you mean `{near}`?")),
    };
    let message = format!("`{found}` is not one of the choices");
    let wrong = Diagnostic::new(message).expected(quoted(choices.iter().copied())).hint_if(hint);
    with_nearest(wrong, found, choices)
}

/// A text that is neither the name of a `what` nor a file.
fn no_name_or_file(what: &str, name: &str) -> Diagnostic {
    Diagnostic::new(match name.trim() {
        "" => format!("the name of the {what} is empty"),
        _ => format!("there is no {what} named `{name}`, and no such file"),
    })
}

/// A material that is neither a name nor a file.
pub(crate) fn unknown_material(name: &str) -> Diagnostic {
    let wrong = no_name_or_file("material", name);
    match &materials_called(name)[..] {
        [] => with_nearest(wrong.hint(material_hint(name)), name, material_names()),
        [first, ..] => wrong.hint(material_hint(name)).accepted(format_args!("\"{first}\"")),
    }
}

/// A name that is no material.
pub(crate) fn unknown_material_name(name: &str) -> Diagnostic {
    Diagnostic::new(format!("there is no material named `{name}`")).hint(material_hint(name))
}

fn material_hint(name: &str) -> String {
    let names = || material_names().iter().copied();
    let list = || {
        let names = material_names();
        let all = names.len() + liquid_crystal_names().count();
        format!("the {all} names are listed by `papilio materials`: {}, ...", names[..9].join(", "))
    };
    // Listed by the same command.
    let is_crystal = |near: &&str| liquid_crystal_names().any(|known| known == *near);
    let crystal = nearest(name, names().chain(liquid_crystal_names())).filter(is_crystal);
    let near =
        || did_you_mean(name, names()).map(|near| format!("{near} `papilio materials` lists all names"));
    let of_cell = |known| {
        format!(
            "`{known}` is a liquid crystal: it is the `liquid_crystal` of a cell, [display.pixel] with model = \"liquid-crystal\""
        )
    };
    match &materials_called(name)[..] {
        [] => crystal.map(of_cell).or_else(near).unwrap_or_else(list),
        called if name.to_lowercase().replace([' ', '-'], "") == "mocr" => {
            format!(
                "no table of this alloy is published; the nearest materials are {}; or give a file with n and k",
                either(called)
            )
        }
        called => format!("did you mean {}?", either(called)),
    }
}

/// A light that is neither a name nor a file.
pub(crate) fn unknown_light(name: &str) -> Diagnostic {
    let wrong = no_name_or_file("light", name);
    with_nearest(wrong.hint(light_hint(name)), name, illuminant_names())
}

/// A name that is no illuminant.
pub(crate) fn unknown_light_name(name: &str) -> Diagnostic {
    Diagnostic::new(format!("there is no illuminant named `{name}`")).hint(light_hint(name))
}

fn light_hint(name: &str) -> String {
    let names = || illuminant_names().iter().copied();
    let kelvin = name.trim().trim_end_matches(['K', 'k']).trim_end().trim_start_matches(['D', 'd']);
    let daylight = |kelvin: f64| format!("{{ daylight_K = {kelvin:.0} }}");
    let near = || did_you_mean(name, names());
    match (illuminants_called(name), kelvin.parse::<u32>(), named_daylight_k(name)) {
        (_, Ok(kelvin), _) if (4000..=25_000).contains(&kelvin) => {
            format!("did you mean {} or {{ planck_K = {kelvin} }}?", daylight(kelvin.into()))
        }
        (_, Ok(kelvin), _) if (500..=100_000).contains(&kelvin) => {
            format!("did you mean {{ planck_K = {kelvin} }}?")
        }
        (_, _, Some(cct_k)) => match near() {
            Some(near) => format!("{near} Daylight of this name is {}", daylight(cct_k)),
            None => format!("did you mean {}?", daylight(cct_k)),
        },
        ([], ..) => near().unwrap_or_else(|| {
            format!(
                "the {} names are listed by `papilio illuminants`: A, D65, FL2, FL11, LED-B3, ...",
                names().len()
            )
        }),
        (called, ..) => format!("did you mean {}?", either(called)),
    }
}

/// Names in backticks, joined with "or".
fn either(names: &[&str]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match names.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

/// Adds the known name that is nearest to a misspelled one as a value that is accepted.
fn with_nearest(wrong: Diagnostic, found: &str, known: &[&str]) -> Diagnostic {
    match nearest(found, known.iter().copied()) {
        Some(near) => wrong.accepted(format_args!("\"{near}\"")),
        None => wrong,
    }
}

/// A state that the pixel does not have.
pub(crate) fn no_such_state(name: &str, known: &[String]) -> Diagnostic {
    let hint = suggestion(name, known.iter().map(String::as_str), "states");
    Diagnostic::new(format!("there is no state `{name}`")).hint(hint)
}

/// A metric that needs states which the pixel does not have; `None` if it has them.
pub(crate) fn lacks_states(name: &str, metric: Metric, known: &[String]) -> Option<Diagnostic> {
    let needed = metric.needed_states();
    let missing: Vec<&str> =
        needed.iter().copied().filter(|state| known.iter().all(|one| one != state)).collect();
    let list = |names: &[&str]| names.iter().map(|one| format!("`{one}`")).collect::<Vec<_>>().join(", ");
    (!missing.is_empty()).then(|| {
        let states: Vec<&str> = known.iter().map(String::as_str).collect();
        Diagnostic::new(format!("`{name}` is not defined: there is no state {}", list(&missing)))
            .expected(format!("a pixel with {}", list(needed)))
            .hint(format!(
                "the states of this pixel are {}; display.pixel.states defines others",
                list(&states)
            ))
    })
}

/// A pixel without states; `remedy` is the hint.
pub(crate) fn no_states(remedy: &str) -> Diagnostic {
    Diagnostic::new("this pixel has no states").hint(remedy)
}

/// A key that cannot be combined with `beside`.
pub(crate) fn not_with(key: &str, beside: &str) -> Diagnostic {
    Diagnostic::new(format!("`{key}` cannot be combined with {beside}")).hint(format!("remove `{key}`"))
}

/// Several keys of which exactly one is required.
pub(crate) fn exactly_one(keys: &str, given: usize) -> Diagnostic {
    let number = if given == 0 { "none" } else { "more than one" };
    Diagnostic::new(format!("{number} of {keys} is given")).expected(format!("exactly one of {keys}"))
}

/// Two names of one key.
pub(crate) fn both_names(old: &str, new: &str) -> Diagnostic {
    Diagnostic::new(format!("`{old}` and `{new}` are two names of one key"))
        .expected("one of them")
        .hint("remove the old name; `papilio migrate` replaces it if it is the only one")
}

/// A scenario in the grammar of a later version of the program.
pub(crate) fn newer_format(found: i64, known: u64) -> Diagnostic {
    Diagnostic::new(format!("this scenario is of format {found}, which this version does not know"))
        .expected(format!("a format from 1 to {known}"))
        .hint("use a newer version of Papilio")
}

/// Too many of something for one computation.
pub(crate) fn too_many(what: &str, count: f64, limit: usize) -> Diagnostic {
    let hint = what
        .contains("wavelengths")
        .then_some("use a larger spectrum.step_nm, or fewer of the other factors");
    Diagnostic::new(format!("these are {} {what}", number(count)))
        .expected(format!("at most {limit}"))
        .hint_if(hint)
}

/// A list without items.
pub(crate) fn empty_list() -> Diagnostic {
    Diagnostic::new("this list is empty").expected("at least one item")
}

/// A key of which another one that varies is a part, or the other way round.
pub(crate) fn overlapping(path: &str, other: &str) -> Diagnostic {
    Diagnostic::new(format!("`{path}` and `{other}` set the same value: one contains the other"))
        .expected("keys of which none contains another")
        .hint("vary either the whole table or list, or values in it")
}

/// A text with characters that the bundled font lacks.
pub(crate) fn no_glyphs(missing: &[char]) -> Diagnostic {
    let named: Vec<String> = missing.iter().map(|one| format!("`{}`", one.escape_debug())).collect();
    Diagnostic::new(format!("the bundled font, Roboto, has no glyphs for {}", named.join(", ")))
        .expected("Latin, Greek and Cyrillic letters, digits and punctuation")
        .hint("remove these characters, or write the text as paths of an SVG file for `image.file`")
}

/// An item of a list that it has before.
pub(crate) fn listed_twice(item: &str) -> Diagnostic {
    Diagnostic::new(format!("{item} is in this list twice")).hint("remove one of them")
}

/// Adds an error for each name that a list contains again.
pub(crate) fn each_once(names: impl IntoIterator<Item = (String, Origin)>, errors: &mut Errors) {
    let mut seen = HashSet::new();
    for (name, origin) in names {
        if seen.contains(&name) {
            errors.push(origin, listed_twice(&format!("`{name}`")));
        }
        seen.insert(name);
    }
}

/// Numbers with a wrong sum.
pub(crate) fn sum(what: &str, sum: f64, expected: &str) -> Diagnostic {
    Diagnostic::new(format!("{what} sum to {}", tidy(sum))).expected(expected)
}

/// A range whose end is not above its start.
pub(crate) fn empty_range(from: f64, to: f64) -> Diagnostic {
    Diagnostic::new(format!("the range from {} to {} is empty", number(from), number(to)))
        .expected("an end that is larger than the start")
}

/// Wrong edges of a "ring", a "cap" or a "region".
pub(crate) fn edges(what: &str, from_deg: f64, to_deg: f64, expected: impl std::fmt::Display) -> Diagnostic {
    Diagnostic::new(format!("this {what} reaches from {} to {} deg", tidy(from_deg), tidy(to_deg)))
        .expected(expected)
}

/// A "cone" or a "luminaire" that reaches below the display's horizon, by the sum of two angles.
pub(crate) fn below_horizon(what: &str, theta_deg: f64, [middle, half]: [&str; 2]) -> Diagnostic {
    let reach = (theta_deg * 100.0).round() / 100.0;
    Diagnostic::new(format!("this {what} reaches {reach} deg from the normal"))
        .expected("less than 90 deg")
        .hint(format!("it reaches as far as {middle} plus {half}: reduce one of them"))
}

/// Light that does not reach the display.
pub(crate) fn dark_field() -> Diagnostic {
    Diagnostic::new("none of this light falls on the display")
}

/// Data that do not cover the wavelength grid, whose step is `step_nm`; 0 for a single wavelength.
pub(crate) fn not_covered(what: &str, have: (f64, f64), needed: (f64, f64), step_nm: f64) -> Diagnostic {
    // The first and the last wavelength of the grid that the data cover.
    let first = needed.0 + ((have.0 - needed.0) / step_nm - 1e-6).ceil().max(0.0) * step_nm;
    let last = needed.1 - ((needed.1 - have.1) / step_nm - 1e-6).ceil().max(0.0) * step_nm;
    let range = match first < last {
        true => format!("set spectrum.range_nm=[{}, {}]", number(first), number(last)),
        false => "change spectrum.range_nm".to_owned(),
    };
    Diagnostic::new(format!("`{what}` reaches from {} to {} nm", number(have.0), number(have.1)))
        .expected(format!("{} to {} nm", number(needed.0), number(needed.1)))
        .hint(format!("data are not extrapolated: extend them, or {range}"))
}

/// A wavelength grid outside the visible range.
pub(crate) fn invisible(range_nm: (f64, f64)) -> Diagnostic {
    Diagnostic::new(format!(
        "nothing between {} and {} nm is visible",
        number(range_nm.0),
        number(range_nm.1)
    ))
    .expected("a range that overlaps 380 to 780 nm")
}

/// A syntax error of the TOML parser, with a hint.
pub(crate) fn syntax(message: &str) -> Diagnostic {
    let of_number = ["mantissa", "fraction", "float", "leading zero"];
    let hint = if of_number.iter().any(|word| message.contains(word)) {
        Some("write numbers with digits on both sides of the point and no more: 0.50, 5.0")
    } else {
        message.contains("basic string").then_some("a string ends with the double quote that it begins with")
    };
    Diagnostic::new(message).hint_if(hint)
}

/// Writes a sum of decimal fractions, rounded to 1e-6 to remove rounding errors.
pub(crate) fn tidy(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    number(if rounded == 0.0 || !rounded.is_finite() { value } else { rounded })
}
