//! The name that was probably meant.

/// No more names than this are proposed at once.
const MOST_PROPOSED: usize = 8;

/// What may have been meant by a wrong name, or else all names there are: "did you mean `haze`?", "the keys are haze, width".
pub fn suggestion<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>, what: &str) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    did_you_mean(wrong, known.iter().copied())
        .unwrap_or_else(|| format!("the {what} are {}", known.join(", ")))
}

/// A question that proposes those of `names` that are equally close to `wrong`, if any is close.
pub fn did_you_mean<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let names = all_nearest(wrong, names);
    let names: Vec<String> = names.iter().take(MOST_PROPOSED).map(|name| format!("`{name}`")).collect();
    let (last, others) = names.split_last()?;
    Some(match others {
        [] => format!("did you mean {last}?"),
        _ => format!("did you mean {} or {last}?", others.join(", ")),
    })
}

/// Words in double quotes: `"ward" or "duer"`.
pub fn quoted<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    words.into_iter().map(|word| format!("\"{word}\"")).collect::<Vec<_>>().join(" or ")
}

/// The one of `names` that is close to `wrong`, ignoring case, if there is one.
pub fn nearest<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    all_nearest(wrong, names).first().copied()
}

/// Those of `names` that are closest to `wrong`, ignoring case, if any is close.
fn all_nearest<'a>(wrong: &str, names: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    // A longer text is not a typing error, and would make the table of distances large.
    if wrong.chars().count() > 64 {
        return Vec::new();
    }
    let wrong = wrong.to_lowercase();
    let allowed = (wrong.chars().count() * 2 / 5).clamp(1, 4);
    let scored = names.into_iter().map(|name| (distance(&wrong, &name.to_lowercase()), name));
    // A name of which nothing is left is not a typing error.
    let close: Vec<_> =
        scored.filter(|(distance, _)| *distance <= allowed && *distance < wrong.chars().count()).collect();
    let least = close.iter().map(|(distance, _)| *distance).min();
    close.iter().filter(|(distance, _)| Some(*distance) == least).map(|(_, name)| *name).collect()
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
    fn nearest_of_a_mistyped_name_is_that_name() {
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
