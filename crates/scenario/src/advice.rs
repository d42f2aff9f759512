//! What should stand in the place of what is wrong, and what to do about it.

use crate::nearest::{did_you_mean, metric_advice, nearest};
use crate::problem::{ABSORBING_K, Problem, tidy};

impl Problem {
    /// What should stand there.
    pub fn expected(&self) -> Option<String> {
        Some(match self {
            Self::Plan(problem) => problem.expected()?,
            Self::MissingKey { expected, .. }
            | Self::WrongType { expected, .. }
            | Self::NoSuchCount { expected, .. } => {
                format!("expected {expected}")
            }
            Self::OutOfRange { expected, .. } | Self::Sum { expected, .. } => format!("expected {expected}"),
            Self::UnknownChoice { choices, .. } => format!("expected {}", listed(choices)),
            Self::LightShares { .. } => "expected 1".to_owned(),
            Self::ExactlyOne { keys, .. } => format!("expected exactly one of {keys}"),
            Self::TooMany { limit, .. } => format!("expected at most {limit}"),
            Self::NotAValue => "expected a number, true, false, or a string in double quotes".to_owned(),
            Self::NumberWithUnit(_) | Self::DecimalComma => "expected a number alone".to_owned(),
            Self::ControlCharacters => "expected one line of plain text".to_owned(),
            Self::NoSubPixels => "expected a share for each, such as { red = 0.5, green = 0.5 }".to_owned(),
            Self::EmptyList => "expected at least one item".to_owned(),
            Self::Range { .. } => "expected from <= to and a step above 0".to_owned(),
            Self::LobeAboveOne { .. } => "expected at most 1".to_owned(),
            Self::NoGlass { k, largest_k, .. } if k <= largest_k => "expected n from 1 to 10".to_owned(),
            Self::NoGlass { largest_k, .. } => format!("expected n from 1 to 10 and k below {largest_k:e}"),
            Self::NeedsPanel { .. } => {
                "expected front components, a face or a lobe by formula, clear glass, and a pixel that is not measured"
                    .to_owned()
            }
            Self::SlabIndex { .. } => {
                "expected one real index for all wavelengths: slabs have no other".to_owned()
            }
            Self::TooThickToWalk { limit, .. } => format!("expected at most {limit} with method = \"walk\""),
            Self::NoFace => "expected two media of different index".to_owned(),
            Self::DispersiveFace { .. } | Self::DispersivePixel { .. } => {
                "expected the same index at all wavelengths".to_owned()
            }
            Self::NoFilm { .. } => "expected n and k up to 1000, and |n + ik| of .001 or more".to_owned(),
            Self::Trapped { limit_deg, .. } => {
                format!("expected less than {limit_deg:.2} deg, field and radius included")
            }
            Self::RingEdges { what: "ring", .. } => {
                "expected a ring between 0 and 90 deg that ends beyond its beginning".to_owned()
            }
            Self::RingEdges { what, .. } => format!("expected a {what} that ends beyond its beginning"),
            Self::NotOneMap { .. } => "expected one [[lighting.environment]] with model = \"map\" and a share above 0".to_owned(),
            Self::SunBehindDisplay { .. } => "expected its disc above the display's own horizon, less than 89.73 deg".to_owned(),
            Self::BelowHorizon { .. } => "expected less than 90 deg".to_owned(),
            Self::GapLayers { .. } => "expected one layer with thickness_nm = \"gap\"".to_owned(),
            Self::NotCovered { needed_nm: (start, stop), .. } => format!("expected {start} to {stop} nm"),
            Self::TableTooShort { needed_deg, .. } => format!("expected {needed_deg:.2} deg or more"),
            Self::TableInAir => "expected angles = \"glass\"".to_owned(),
            Self::Invisible { .. } => "expected a part of 380 to 780 nm".to_owned(),
            Self::SetWithoutValue => "expected for example display.glass.index=1.52".to_owned(),
            Self::NoSuchWay { found, .. } => format!("expected it among: {found}"),
            Self::MoreThanAll { .. } => "expected at most 1".to_owned(),
            Self::Data(problem) => problem.expected()?.to_owned(),
            _ => return None,
        })
    }

    /// What to do about it.
    pub fn hint(&self) -> Option<String> {
        Some(match self {
            Self::Plan(problem) => problem.hint()?,
            Self::NotAScenario => "a scenario has lines such as `title = \"Indoor\"` and `[display.pixel]`; \
                                   scenarios/ holds examples"
                .to_owned(),
            Self::Syntax { message }
                if ["mantissa", "fraction", "float", "leading zero"]
                    .iter()
                    .any(|word| message.contains(word)) =>
            {
                "write numbers with digits on both sides of the point and no more: 0.50, 5.0".to_owned()
            }
            Self::Syntax { message } if message.contains("basic string") => {
                "a string ends with the double quote that it begins with".to_owned()
            }
            Self::NotAValue => "a string stands in double quotes".to_owned(),
            Self::NumberWithUnit(unit) if unit == "%" => "shares are of 1: write 78 % as 0.78".to_owned(),
            Self::NumberWithUnit(_) => {
                "numbers stand without a unit: the unit is in the key's name".to_owned()
            }
            Self::DecimalComma => "write decimals with a point: 0.5; and lists in brackets: [8, 20]".to_owned(),
            Self::GapOfAState => {
                "a gap belongs under a sub-pixel: teal = { green = { gap_nm = 165.0 } }".to_owned()
            }
            Self::Twice { .. } => "leave one of them out".to_owned(),
            Self::UnknownKey { key, known } => suggestion(key, known.iter().copied(), "keys"),
            Self::UnknownChoice { found, .. } if found == "slab" => {
                "a slab is a layer of its own: kind = \"slab\"".to_owned()
            }
            Self::UnknownChoice { found, choices } => {
                format!("did you mean `{}`?", nearest(found, choices.iter().map(String::as_str))?)
            }
            Self::UnknownName { name, names, .. } => {
                let list = || format!("the names are {}", names.join(", "));
                did_you_mean(name, names.iter().copied()).unwrap_or_else(list)
            }
            Self::NoSubPixel { name, known, .. } => {
                suggestion(name, known.iter().map(String::as_str), "sub-pixels")
            }
            Self::StepLeadsAway { .. } => "give `count` instead, or turn the sign of the step".to_owned(),
            Self::NoSuchMetric { name, known } => metric_advice(name, known),
            Self::NoSuchFile { name, known } => suggestion(name, known.iter().map(String::as_str), "files"),
            Self::NoSuchState { name, known } => suggestion(name, known.iter().map(String::as_str), "states"),
            Self::NotInThisVersion { choices, .. } if !choices.is_empty() => {
                format!("there is {}", listed(choices))
            }
            Self::NotInThisVersion { .. } => "leave it out".to_owned(),
            Self::NoSuchWay { wanted: "front transmission", found } if found.contains("back transmission") => {
                "`flipped = true` takes the light from the other side of the sample".to_owned()
            }
            Self::MoreThanAll { .. } => {
                "`papilio diffuser inspect` shows the totals at each incidence; `normalise`, `fill` and `mounting` change them"
                    .to_owned()
            }
            Self::Measurement(papilio_goniometry::GoniometryError::Blur { .. }) => {
                "the width is that of the image of a straight beam, measured without a sample".to_owned()
            }
            Self::DarkShare => "its shape is what counts: somewhere it must be above 0".to_owned(),
            Self::Measurement(papilio_goniometry::GoniometryError::NoTis) => "use normalise = \"none\"".to_owned(),
            Self::NoBtdf => "use model = \"k-correlation\", \"lambertian\", \"ward\" or \"measured\"; `papilio brdf` tables a whole \
                             display with a slab"
                .to_owned(),
            Self::NoDarkGap { .. } => "add `dark = 20.0`, in nm, to `gap_nm`".to_owned(),
            Self::NoStates { remedy } => (*remedy).to_owned(),
            Self::LightShares { remedy, value, .. } if (0.0..=1.0).contains(value) => {
                format!("{remedy}={} would make it 1", tidy(*value))
            }
            Self::TooMany { what, .. } if what.contains("wavelengths") => {
                "take a larger spectrum.step_nm, or fewer of the others".to_owned()
            }
            Self::NotWith { key: "paths", .. } => "give `relative_error`, or method = \"walk\"".to_owned(),
            Self::NotWith { key: "extrapolate = \"glass\"", .. } => {
                "\"hold\" keeps the last lobe within the horizon of the air".to_owned()
            }
            Self::NotWith { key, .. } => format!("leave `{key}` out"),
            Self::OfAnotherKind { key, of, .. } => {
                format!("leave it out: `{key}` is a key of {}", of.join(" and "))
            }
            Self::BesideLayers { layer, .. } => format!("make it a layer, {layer}, or leave it out"),
            Self::NoLobeBelow => "leave `distribution` out: a diffuse front light lies over any layers".to_owned(),
            Self::NeedsPanel { instead, .. } => format!("use {instead}"),
            Self::SheetAtFace => "put what is below it in between: a face such as { kind = \"fresnel\" } leaves \
                                  the sheet in the medium above, a { kind = \"medium\" } of the same index around it"
                .to_owned(),
            Self::NoFace => "put a { kind = \"medium\" } of another index below the face; or leave the face out".to_owned(),
            Self::DispersiveFace { .. } | Self::DispersivePixel { .. } => {
                "give the index as a number, that at 550 nm for example".to_owned()
            }
            Self::SlabIndex { .. } => {
                "give the index at 550 nm, as a number; what the slab absorbs is 1 - `albedo`".to_owned()
            }
            Self::TooThickToWalk { .. } => {
                "use method = \"adding\", which takes thick slabs in its stride".to_owned()
            }
            Self::NoGlass { n, k, largest_k, .. }
                if (1.0..=10.0).contains(n) && *k > *largest_k && *k <= ABSORBING_K =>
            {
                "give `thickness_mm`, and k absorbs along the path".to_owned()
            }
            Self::LobeAboveOne { limit, .. } => {
                format!(
                    "a lobe so wide loses light beyond the hemisphere: total_transmittance can be {limit:.4} at most"
                )
            }
            Self::NoWidth { limit, .. } if *limit <= 0.0 => {
                "light that goes straight through is no haze".to_owned()
            }
            Self::NoWidth { haze, limit, .. } if haze < limit => {
                "so little haze is none: give more, or leave the diffuser out".to_owned()
            }
            Self::NoWidth { limit, .. } => {
                let limit = (limit * 1e4).floor() / 1e4;
                format!("haze can be {limit} at most: a wider lobe loses its light beyond the hemisphere")
            }
            Self::NoLight { .. } => {
                "lines narrower than the grid's step are lost: set spectrum.step_nm = 1; or change range_nm"
                    .to_owned()
            }
            Self::SurfaceUnderDiffuser(_) => "leave `surface` out, or the diffuser".to_owned(),
            Self::AnglesInGlass(_) => "use angle_medium = \"air\": Snell's law does the rest".to_owned(),
            Self::NotCovered { first, last, needed_nm, .. } => cover_hint((*first, *last), *needed_nm),
            Self::TableTooShort { .. } => {
                "never extrapolated: let the pixel tool compute larger angles".to_owned()
            }
            Self::TableInAir => "give the table in glass angles, to 90 deg; Papilio's own tool makes one by \
                                 `papilio pixel FILE --angles glass`"
                .to_owned(),
            Self::WrongType { found: "a string", expected } if expected.starts_with("a number") => {
                "numbers stand without quotes, units and percent signs: the unit is in the key's name, and shares are of 1"
                    .to_owned()
            }
            Self::WrongType { found: "a table", expected } if expected.starts_with("a list, each item a table") => {
                "write its header in double brackets, once for each item, as in [[display.layers]]".to_owned()
            }
            Self::OutOfRange { expected, value } if *value > 1.0 && SHARES.contains(expected) => {
                "this is a share of 1, not percent".to_owned()
            }
            Self::OutOfRange { expected, value } if expected.contains("coefficient k") && *value < 0.0 => {
                "Papilio uses n + ik, k positive in an absorber: change the sign of n - ik data".to_owned()
            }
            Self::Data(problem) => problem.hint()?.to_owned(),
            _ => return None,
        })
    }
}

/// Ranges in words that end at 1.
const SHARES: [&str; 3] = ["a number from 0 to 1", "a number between 0 and 1", "a number above 0, at most 1"];

pub(crate) fn suggestion<'a>(wrong: &str, known: impl Iterator<Item = &'a str>, what: &str) -> String {
    let known: Vec<&str> = known.collect();
    match nearest(wrong, known.iter().copied()) {
        Some(name) => format!("did you mean `{name}`?"),
        None => format!("the {what} are {}", known.join(", ")),
    }
}

fn cover_hint(have: (f64, f64), needed: (f64, f64)) -> String {
    let shared = (have.0.max(needed.0).ceil(), have.1.min(needed.1).floor());
    if shared.0 < shared.1 {
        return format!(
            "nothing is extrapolated: extend the data, or set spectrum.range_nm within [{}, {}]",
            shared.0, shared.1
        );
    }
    "nothing is extrapolated: extend the data, or change spectrum.range_nm".to_owned()
}

fn listed(words: &[String]) -> String {
    words.iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" or ")
}
