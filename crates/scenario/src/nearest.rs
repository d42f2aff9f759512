//! Suggestions for misspelt names of metrics.

use papilio_diagnostics::{Diagnostic, nearest};

/// Error: no result has this metric.
pub(crate) fn no_such_metric(name: &str, known: &[String]) -> Diagnostic {
    Diagnostic::new(format!("there is no metric `{name}`")).hint(metric_advice(name, known))
}

/// Suggests a metric for a wrong name. Metrics of a state begin with its name and a point.
fn metric_advice(wrong: &str, known: &[String]) -> String {
    let (state, name) = state_and_metric(wrong);
    let states = known.iter().map(|one| state_and_metric(one).0);
    let state = nearest(state, states).unwrap_or(state);
    let (own, others): (Vec<&str>, Vec<&str>) =
        known.iter().map(String::as_str).partition(|one| state_and_metric(one).0 == state);
    let near = |all: &[&str]| {
        let meant = nearest(name, all.iter().map(|one| state_and_metric(one).1))?;
        all.iter().find(|one| state_and_metric(one).1 == meant).map(|one| format!("did you mean `{one}`?"))
    };
    // The beginning of a name is enough, whatever its case, underscores and asterisks.
    let bare = |text: &str| text.to_lowercase().replace(['_', '*'], "");
    let begin_so = own.iter().filter(|one| bare(state_and_metric(one).1).starts_with(&bare(name)));
    let begin_so: Vec<String> = begin_so.map(|one| format!("`{one}`")).collect();
    let list = || match (own.is_empty(), others.is_empty() || !state.is_empty()) {
        (true, _) => format!("the metrics are {}", in_groups(&others)),
        (false, true) => format!("the metrics are {}", in_groups(&own)),
        (false, false) => format!("the metrics are {}; for a state {}", in_groups(&own), in_groups(&others)),
    };
    // Or a part of it.
    let containing = || {
        let contains = |one: &&&str| bare(state_and_metric(one).1).contains(&bare(name));
        let all = own.iter().chain(&others).filter(contains).map(|one| format!("`{one}`"));
        let all: Vec<String> = all.take(if name.len() < SHORTEST_PART { 0 } else { LISTED }).collect();
        (!all.is_empty()).then(|| format!("did you mean {}?", all.join(" or ")))
    };
    let proposed = || format!("did you mean {}?", begin_so.join(" or "));
    // A metric of a state without its state, if nothing else begins as it is written.
    let as_written = own.iter().any(|one| state_and_metric(one).1.starts_with(name));
    if let Some(one) = others.iter().find(|one| !as_written && state_and_metric(one).1 == name) {
        return format!("did you mean `{one}`?");
    }
    match begin_so.len() {
        0 => near(&own).or_else(|| near(&others)).or_else(containing).unwrap_or_else(list),
        1 => proposed(),
        // Several longer names: the one that differs least, if it differs little.
        _ => near(&own).unwrap_or_else(proposed),
    }
}

/// Fewest letters of a part of a name that suggest it.
const SHORTEST_PART: usize = 4;

/// Most metrics that are listed by name.
const LISTED: usize = 12;

/// Groups of metrics by the beginning of their names, and the page that lists them.
const GROUPS: [(&str, &[&str]); 8] = [
    ("gamut", &["gamut_", "coverage_"]),
    (
        "figures on a page (docs/crosstalk.md)",
        &["patch_", "stripe_1_", "line_1_", "text_gamut_", "text_contrast_ratio"],
    ),
    ("lines, strokes and fine patterns (docs/mtf.md)", &["line_contrast_", "text_contrast_", "yule_nielsen"]),
    ("sharpness (docs/mtf.md)", &["f50_", "mtf_", "edge_", "r50_", "r90_", "sqri_"]),
    ("shares of light (docs/crosstalk.md)", &["own_share", "neighbours_share"]),
    ("sparkle (docs/sparkle.md)", &["ppd"]),
    ("readability (docs/readability.md)", &["reading_", "visibility_level", "contrast_margin"]),
    ("colour differences (docs/metrics.md)", &["delta_E_", "distance_from_", "shift_"]),
];

/// All names of a short list; of a long one the groups, each with its first name and their number.
fn in_groups(all: &[&str]) -> String {
    if all.len() <= LISTED {
        return all.join(", ");
    }
    let group = |name: &str| {
        let metric = state_and_metric(name).1;
        GROUPS.iter().position(|(_, begins)| begins.iter().any(|begin| metric.starts_with(begin)))
    };
    let rest: Vec<&str> = all.iter().copied().filter(|name| group(name).is_none()).collect();
    let mut listed: Vec<String> = (!rest.is_empty()).then(|| some_of(&rest, LISTED)).into_iter().collect();
    for (number, (title, _)) in GROUPS.iter().enumerate() {
        let own: Vec<&str> = all.iter().copied().filter(|name| group(name) == Some(number)).collect();
        if !own.is_empty() {
            listed.push(format!("{title}: {}", some_of(&own, 2)));
        }
    }
    listed.join("; ")
}

/// The first names, and how many more there are.
fn some_of(names: &[&str], count: usize) -> String {
    match names.len().checked_sub(count) {
        None | Some(0) => names.join(", "),
        Some(more) => format!("{}, and {more} more", names[..count].join(", ")),
    }
}

/// Splits a name into the state (empty if there is none) and the metric.
fn state_and_metric(text: &str) -> (&str, &str) {
    text.rsplit_once('.').unwrap_or(("", text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metric_advice_for_misspelt_name_suggests_the_metric() {
        let known = [
            "contrast_ratio",
            "gamut_percent_srgb",
            "gamut_percent_srgb_xy",
            "gamut_percent_ebu",
            "white.X",
            "white.Y",
            "white.L_star",
        ];
        let known = known.map(str::to_owned);
        for (wrong, advice) in [
            ("contrast_ration", "did you mean `contrast_ratio`?"),
            ("gamut", "did you mean `gamut_percent_srgb` or `gamut_percent_srgb_xy` or `gamut_percent_ebu`?"),
            ("gamut_percent_srg", "did you mean `gamut_percent_srgb`?"),
            ("withe.l_star", "did you mean `white.L_star`?"),
            ("white.L", "did you mean `white.L_star`?"),
            ("white.contrast_ratio", "did you mean `contrast_ratio`?"),
            ("L_star", "did you mean `white.L_star`?"),
            ("white.chroma", "the metrics are white.X, white.Y, white.L_star"),
            (
                "hue",
                "the metrics are contrast_ratio, gamut_percent_srgb, gamut_percent_srgb_xy, gamut_percent_ebu; for a state white.X, white.Y, white.L_star",
            ),
        ] {
            assert_eq!(metric_advice(wrong, &known), advice, "{wrong}");
        }
    }
}
