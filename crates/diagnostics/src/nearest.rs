//! Suggestions for misspelled names.

/// Largest number of names in one suggestion.
const MOST_PROPOSED: usize = 8;

/// Returns a suggestion for an unknown name, or else the list of all known names: "did you mean `haze`?",
/// "the keys are haze, width". `what` is the plural noun for the names: "keys".
pub fn suggestion<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>, what: &str) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    did_you_mean(wrong, known.iter().copied())
        .unwrap_or_else(|| format!("the {what} are {}", known.join(", ")))
}

/// Returns a question that suggests the `names` closest to `wrong`, all that are equally close, or `None` if
/// none is close. A few that continue it after an underscore come first: `theta` lacks the unit of `theta_deg`.
pub fn did_you_mean<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let names: Vec<&str> = names.into_iter().collect();
    let begins_so = |name: &&&str| name.strip_prefix(wrong).is_some_and(|rest| rest.starts_with('_'));
    let continued: Vec<&str> = names.iter().filter(begins_so).copied().collect();
    let names = match (1..=MOST_PROPOSED).contains(&continued.len()) && !wrong.is_empty() {
        true => continued,
        false => all_nearest(wrong, names),
    };
    let names: Vec<String> = names.iter().take(MOST_PROPOSED).map(|name| format!("`{name}`")).collect();
    let (last, others) = names.split_last()?;
    Some(match others {
        [] => format!("did you mean {last}?"),
        _ => format!("did you mean {} or {last}?", others.join(", ")),
    })
}

/// Returns the words in double quotes, joined with "or": `"ward" or "duer"`.
pub fn quoted<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    words.into_iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" or ")
}

/// Returns the first of the `names` closest to `wrong`, ignoring case, or `None` if none is close.
pub fn nearest<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    all_nearest(wrong, names).first().copied()
}

/// Returns all `names` that are closest to `wrong`, ignoring case; empty if none is close.
fn all_nearest<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    // A longer text is not a misspelled name, and would need a large table of distances.
    if wrong.chars().count() > 64 {
        return Vec::new();
    }
    let wrong = wrong.to_lowercase();
    let allowed = (wrong.chars().count() * 2 / 5).clamp(1, 4);
    let scored = names.into_iter().map(|name| (distance(&wrong, &name.to_lowercase()), name));
    // If every character differs, the name is not a misspelling.
    let close: Vec<_> =
        scored.filter(|(distance, _)| *distance <= allowed && *distance < wrong.chars().count()).collect();
    let least = close.iter().map(|(distance, _)| *distance).min();
    close.iter().filter(|(distance, _)| Some(*distance) == least).map(|(_, name)| *name).collect()
}

/// Least number of insertions, deletions, substitutions and swaps of neighbouring characters that turn `a`
/// into `b` (Damerau-Levenshtein distance).
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
    fn misspelled_name_has_the_intended_name_as_nearest() {
        let names = ["thickness_nm", "material", "theta_deg", "phi_deg"];
        assert_eq!(nearest("thicknes_nm", names), Some("thickness_nm"));
        assert_eq!(nearest("Materail", names), Some("material"));
        assert_eq!(nearest("tehta_deg", names), Some("theta_deg"));
        assert_eq!(nearest("withe", ["white", "black"]), Some("white"));
        assert_eq!(nearest("colour", names), None);
        assert_eq!(nearest("sio2", ["SiO2", "Si3N4"]), Some("SiO2"));
        assert_eq!(did_you_mean("fi_deg", names).as_deref(), Some("did you mean `phi_deg`?"));
        let illuminants = ["D65", "FL10", "FL11", "FL12"];
        assert_eq!(
            did_you_mean("FL13", illuminants).as_deref(),
            Some("did you mean `FL10`, `FL11` or `FL12`?")
        );
        assert_eq!(did_you_mean("theta", names).as_deref(), Some("did you mean `theta_deg`?"));
        assert_eq!(did_you_mean("thick", names), None, "no whole word");
        assert_eq!(did_you_mean("", ["_a"]), None);
        assert_eq!((nearest("", names), nearest("", ["A"]), nearest("B", ["A"])), (None, None, None));
    }
}
