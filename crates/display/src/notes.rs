//! Notes that explain numbers of a result which may surprise.

use crate::result::{ReferenceWhite, State, View};

/// Y above which a state is noted as brighter than a perfect white; numerical errors stay below it.
const BRIGHTER: f64 = 1.001;

/// Standard errors by which Y must exceed [`BRIGHTER`].
const SIGMAS: f64 = 5.0;

/// Returns the notes on the views of a result.
pub(crate) fn notes(views: &[View], white: ReferenceWhite) -> Vec<String> {
    brighter_than_white(views, white).into_iter().collect()
}

/// Explains Y above 1 and L* above 100.
fn brighter_than_white(views: &[View], white: ReferenceWhite) -> Option<String> {
    let is_bright = |state: &State| state.value.Y > BRIGHTER + SIGMAS * state.standard_error.Y;
    let all =
        || views.iter().flat_map(|view| view.states.iter().map(move |(name, state)| (view, name, state)));
    let bright = || all().filter(|(.., state)| is_bright(state));
    let (view, name, state) = bright().max_by(|a, b| a.2.value.Y.total_cmp(&b.2.value.Y))?;
    let count = views.iter().filter(|view| view.states.iter().any(|(_, state)| is_bright(state))).count();
    let of_views =
        if views.len() > 1 { format!(" in {count} of {} views", views.len()) } else { String::new() };
    let azimuth = if view.phi_deg == 0.0 { String::new() } else { format!(", azimuth {} deg", view.phi_deg) };
    let cause = match state.value.terms.front_light {
        Some(front) if state.value.Y - front <= 1.0 => {
            "the front light adds to the ambient light, in which the perfect white is seen"
        }
        _ => "the display concentrates the light, as near the mirror image of a source",
    };
    let mut note = format!(
        "Y is above 1{of_views} (at most {:.4}: {name} at {} deg{azimuth}): the display is brighter there than a perfect white \
         diffuser in the same light, because {cause}",
        state.value.Y, view.theta_deg
    );
    if let (ReferenceWhite::Perfect, Some(lightness)) = (white, state.value.L_star) {
        note.push_str(&format!(
            ". L*, a* and b* are relative to that diffuser: L* exceeds 100 (at most {lightness:.1}), for which CIELAB is not \
             meant; metrics.white = \"display\" makes them relative to the white state"
        ));
    }
    Some(note)
}
