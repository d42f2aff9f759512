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
        (true, _) => format!("the metrics are {}", others.join(", ")),
        (false, true) => format!("the metrics are {}", own.join(", ")),
        (false, false) => format!("the metrics are {}; for a state {}", own.join(", "), others.join(", ")),
    };
    let proposed = || format!("did you mean {}?", begin_so.join(" or "));
    // A metric of a state without its state, if nothing else begins as it is written.
    let as_written = own.iter().any(|one| state_and_metric(one).1.starts_with(name));
    if let Some(one) = others.iter().find(|one| !as_written && state_and_metric(one).1 == name) {
        return format!("did you mean `{one}`?");
    }
    match begin_so.len() {
        0 => near(&own).or_else(|| near(&others)).unwrap_or_else(list),
        1 => proposed(),
        // Several longer names: the one that differs least, if it differs little.
        _ => near(&own).unwrap_or_else(proposed),
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
