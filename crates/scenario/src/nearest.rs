//! The name that was probably meant.

/// At most so many names are proposed at once.
const PROPOSED: usize = 8;

/// The one of `names` that is close to `wrong`, ignoring case, if there is one.
pub fn nearest<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    all_nearest(wrong, names).first().copied()
}

/// A question that proposes those of `names` that are equally close to `wrong`, if any is close.
pub fn did_you_mean<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let names: Vec<String> =
        all_nearest(wrong, names).iter().take(PROPOSED).map(|name| format!("`{name}`")).collect();
    let (last, others) = names.split_last()?;
    Some(match others {
        [] => format!("did you mean {last}?"),
        _ => format!("did you mean {} or {last}?", others.join(", ")),
    })
}

/// Those of `names` that are closest to `wrong`, ignoring case, if any is close.
fn all_nearest<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    // A longer text is no slip of the keys, and would make the table of distances large.
    if wrong.chars().count() > 64 {
        return vec![];
    }
    let wrong = wrong.to_lowercase();
    let allowed = (wrong.chars().count() * 2 / 5).clamp(1, 4);
    let scored = names.into_iter().map(|name| (distance(&wrong, &name.to_lowercase()), name));
    // A name of which nothing is left is no slip of the keys.
    let close: Vec<_> =
        scored.filter(|(distance, _)| *distance <= allowed && *distance < wrong.chars().count()).collect();
    let least = close.iter().map(|(distance, _)| *distance).min();
    close.iter().filter(|(distance, _)| Some(*distance) == least).map(|(_, name)| *name).collect()
}

/// What may have been meant by the name of a metric; those of a state have its name and a point before them.
pub(crate) fn metric_advice(wrong: &str, known: &[String]) -> String {
    let (state, name) = state_and_metric(wrong);
    let states = known.iter().map(|one| state_and_metric(one).0);
    let state = nearest(state, states).unwrap_or(state);
    let (own, others): (Vec<&str>, Vec<&str>) =
        known.iter().map(String::as_str).partition(|one| state_and_metric(one).0 == state);
    let near = |all: &[&str]| {
        let meant = nearest(name, all.iter().map(|one| state_and_metric(one).1))?;
        all.iter().find(|one| state_and_metric(one).1 == meant).map(|one| format!("did you mean `{one}`?"))
    };
    // Half a name is as clear, and so is one with the right letters.
    let bare = |text: &str| text.to_lowercase().replace(['_', '*'], "");
    let begin_so = own.iter().filter(|one| bare(state_and_metric(one).1).starts_with(&bare(name)));
    let begin_so: Vec<String> = begin_so.map(|one| format!("`{one}`")).collect();
    let list = || match (own.is_empty(), others.is_empty() || !state.is_empty()) {
        (true, _) => format!("the metrics are {}", others.join(", ")),
        (false, true) => format!("the metrics are {}", own.join(", ")),
        (false, false) => format!("the metrics are {}; of a state {}", own.join(", "), others.join(", ")),
    };
    match begin_so.len() {
        0 => near(&own).or_else(|| near(&others)).unwrap_or_else(list),
        _ => format!("did you mean {}?", begin_so.join(" or ")),
    }
}

/// The state, empty where there is none, and the metric.
fn state_and_metric(text: &str) -> (&str, &str) {
    text.rsplit_once('.').unwrap_or(("", text))
}

/// Insertions, deletions, replacements and swaps of neighbours that make `b` of `a`.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<_>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_in_metrics() {
        let known = [
            "contrast_ratio",
            "gamut_percent_srgb",
            "gamut_percent_ebu",
            "white.X",
            "white.Y",
            "white.L_star",
        ];
        let known = known.map(str::to_owned);
        for (wrong, advice) in [
            ("contrast_ration", "did you mean `contrast_ratio`?"),
            ("gamut", "did you mean `gamut_percent_srgb` or `gamut_percent_ebu`?"),
            ("withe.l_star", "did you mean `white.L_star`?"),
            ("white.L", "did you mean `white.L_star`?"),
            ("white.contrast_ratio", "did you mean `contrast_ratio`?"),
            ("L_star", "did you mean `white.L_star`?"),
            ("white.chroma", "the metrics are white.X, white.Y, white.L_star"),
            (
                "hue",
                "the metrics are contrast_ratio, gamut_percent_srgb, gamut_percent_ebu; of a state white.X, white.Y, white.L_star",
            ),
        ] {
            assert_eq!(metric_advice(wrong, &known), advice, "{wrong}");
        }
    }

    #[test]
    fn slips_of_the_keys() {
        let names = ["thickness_nm", "material", "theta_deg", "phi_deg"];
        assert_eq!(nearest("thicknes_nm", names), Some("thickness_nm"));
        assert_eq!(nearest("Materail", names), Some("material"));
        assert_eq!(nearest("tehta_deg", names), Some("theta_deg"));
        assert_eq!(nearest("withe", ["white", "black"]), Some("white"));
        assert_eq!(nearest("colour", names), None);
        assert_eq!(nearest("sio2", ["SiO2", "Si3N4"]), Some("SiO2"));
        assert_eq!(did_you_mean("fi_deg", names).as_deref(), Some("did you mean `phi_deg`?"));
        let lamps = ["D65", "FL10", "FL11", "FL12"];
        assert_eq!(did_you_mean("FL13", lamps).as_deref(), Some("did you mean `FL10`, `FL11` or `FL12`?"));
        assert_eq!((nearest("", names), nearest("", ["A"]), nearest("B", ["A"])), (None, None, None));
    }
}
