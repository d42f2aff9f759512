//! Notes on skipped states; states with the same reason are reported in one note.

use super::Simulated;

/// State in a direction, and the reason why it is skipped or limited.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LeftOut {
    pub(super) state: String,
    /// Inclination and azimuth, degrees, if they are stated.
    pub(super) direction: Option<[f64; 2]>,
    pub(super) why: String,
}

/// Returns a note for each reason: `not measured: cyan, magenta at theta 8, 20 deg`.
pub(super) fn gathered(all: &[LeftOut]) -> Vec<String> {
    let mut reasons: Vec<&str> = Vec::new();
    for one in all {
        if !reasons.contains(&one.why.as_str()) {
            reasons.push(&one.why);
        }
    }
    let note = |why: &str| {
        let similar: Vec<&LeftOut> = all.iter().filter(|one| one.why == why).collect();
        format!("{why}: {}", places(&similar))
    };
    reasons.into_iter().map(note).collect()
}

/// Reason for a state whose name the result does not have.
pub(super) const NO_SUCH_STATE: &str = "the result has no such state";

/// Adds the states that there are to the note on states that the result does not have.
pub(super) fn with_states(mut notes: Vec<String>, simulated: &Simulated) -> Vec<String> {
    let mut known: Vec<&str> = Vec::new();
    for state in simulated.views.iter().flat_map(|view| &view.states) {
        if !known.contains(&state.name.as_str()) {
            known.push(&state.name);
        }
    }
    for note in notes.iter_mut().filter(|note| note.starts_with(NO_SUCH_STATE)) {
        note.push_str(&format!(" (its states are {})", known.join(", ")));
    }
    notes
}

/// Lists the states with their directions; states with the same directions are combined.
fn places(similar: &[&LeftOut]) -> String {
    let mut groups: Vec<(Vec<[f64; 2]>, Vec<&str>)> = Vec::new();
    let mut seen: Vec<&str> = Vec::new();
    for one in similar {
        if seen.contains(&one.state.as_str()) {
            continue;
        }
        seen.push(&one.state);
        let same = similar.iter().filter(|other| other.state == one.state);
        let directions: Vec<[f64; 2]> = same.filter_map(|other| other.direction).collect();
        match groups.iter_mut().find(|(known, _)| *known == directions) {
            Some((_, states)) => states.push(&one.state),
            None => groups.push((directions, vec![&one.state])),
        }
    }
    let place = |(directions, states): &(Vec<[f64; 2]>, Vec<&str>)| {
        let states = states.join(", ");
        if directions.is_empty() { states } else { format!("{states} at {}", in_words(directions)) }
    };
    groups.iter().map(place).collect::<Vec<_>>().join("; ")
}

/// Formats directions as `theta 8, 20 deg`, with azimuths if one is not 0.
fn in_words(directions: &[[f64; 2]]) -> String {
    let join =
        |text: &dyn Fn(&[f64; 2]) -> String| directions.iter().map(text).collect::<Vec<_>>().join(", ");
    if directions.iter().all(|[_, phi]| *phi == 0.0) {
        return format!("theta {} deg", join(&|[theta, _]| theta.to_string()));
    }
    format!("theta / phi {} deg", join(&|[theta, phi]| format!("{theta} / {phi}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_with_the_same_reason_are_combined() {
        let one = |state: &str, theta: f64, phi: f64, why: &str| LeftOut {
            state: state.to_owned(),
            direction: Some([theta, phi]),
            why: why.to_owned(),
        };
        let mut all = Vec::new();
        for theta in [8.0, 20.0] {
            all.extend(["cyan", "magenta"].map(|state| one(state, theta, 0.0, "not measured")));
        }
        all.push(one("white", 20.0, 0.0, "not measured"));
        all.push(one("white", 30.0, 90.0, "no view"));
        let expected = [
            "not measured: cyan, magenta at theta 8, 20 deg; white at theta 20 deg",
            "no view: white at theta / phi 30 / 90 deg",
        ];
        assert_eq!(gathered(&all), expected);
        assert_eq!(gathered(&[]), [""; 0]);
    }
}
