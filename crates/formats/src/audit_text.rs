//! What was found in a measurement, as lines to be read: what `papilio diffuser inspect` prints.

use std::fmt::Write;

use papilio_goniometry::{Audit, Geometry, Measurement, Symmetry, Way};

use crate::words::{channel, percent, span, table};

/// Haze above this is outside the scope of ASTM D1003.
const HAZE_SCOPE: f64 = 0.30;
/// A total this much above 1 is no rounding.
const ABOVE_ONE: f64 = 1.005;
/// Light beyond what was measured that is more than this share is worth a warning.
const MUCH_BEYOND: f64 = 0.005;
/// A ratio of integral and TIS further from 1 than this is worth a word.
const TIS_TOLERANCE: f64 = 0.02;

/// A measurement, and for each of its parts the audit of its luminous channel (`None`: its directions are on no grid);
/// `name` is that of the file.
pub fn audit_text(name: &str, measurement: &Measurement, audits: &[Option<Audit>]) -> String {
    let provenance = &measurement.provenance;
    let mut text = format!("{name}: {}\n", provenance.format);
    for (what, said) in [("sample", &provenance.sample), ("source", &provenance.source)] {
        if !said.is_empty() {
            let _ = writeln!(text, "{what}: {said}");
        }
    }
    if measurement.media != [1.0, 1.0] {
        let [front, back] = measurement.media;
        let _ = writeln!(text, "media: index {front} in front, {back} behind");
    }
    for (part, audit) in measurement.parts.iter().zip(audits) {
        let channels: Vec<String> = part.channels.iter().map(channel).collect();
        let _ = write!(
            text,
            "\n{} from the {}; {}",
            capital(kind(part.way)),
            side(part.way),
            channels.join(", ")
        );
        let _ = writeln!(text, "\n  {}", geometry(&part.geometry));
        // One channel in full: the luminous one.
        match audit {
            Some(audit) => text.push_str(&findings(audit)),
            None => text.push_str("  directions on no grid: nothing is known of what is between them\n"),
        }
        if matches!(part.geometry, Geometry::Patches { .. }) {
            text.push_str(
                "  integral: sum of value x projected solid angle over the patches, the mean over the ring that light comes \
                 from; peak: of the patch straight on or in the mirror direction; nothing finer than a patch is known\n",
            );
        }
    }
    text
}

/// The side of the light.
fn side(way: Way) -> &'static str {
    match way {
        Way::FrontReflection | Way::FrontTransmission => "front",
        Way::BackTransmission | Way::BackReflection => "back",
    }
}

/// Reflection or transmission.
fn kind(way: Way) -> &'static str {
    if way.is_transmission() { "transmission" } else { "reflection" }
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn geometry(geometry: &Geometry) -> String {
    match geometry {
        Geometry::Specular(grid) => {
            let symmetry = match grid.symmetry {
                Symmetry::Plane => "mirrored in the plane of incidence",
                Symmetry::None => "all around",
            };
            let turns = match grid.rotations_deg.len() {
                0 | 1 => String::new(),
                _ => format!("rotations: {}; ", span(&grid.rotations_deg)),
            };
            format!(
                "about the specular direction, degrees: {turns}incidences: {}; azimuths: {}, {symmetry}; radial: {}",
                span(&grid.incidences_deg),
                span(&grid.azimuths_deg),
                span(&grid.radials_deg),
            )
        }
        Geometry::Spherical(grid) => format!(
            "inclinations and azimuths, degrees: light {} and {}; viewer {} and {}",
            span(&grid.theta_i_deg),
            span(&grid.phi_i_deg),
            span(&grid.theta_o_deg),
            span(&grid.phi_o_deg),
        ),
        other => format!("{} cells", other.cells()),
    }
}

fn findings(audit: &Audit) -> String {
    let header = [
        "incidence",
        "TIS",
        "integral",
        "ratio",
        "beyond",
        "tails filled",
        "grid error",
        "peak 1/sr",
        "half-widths deg",
    ];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for incidence in &audit.incidences {
        let width = |k: usize| incidence.half_widths_deg[k].map_or("-".to_owned(), |deg| format!("{deg:.2}"));
        rows.push(vec![
            format!("{} deg", incidence.theta_deg),
            incidence.tis.map_or("-".to_owned(), |tis| format!("{tis:.4}")),
            format!("{:.4}", incidence.integral),
            incidence.tis.map_or("-".to_owned(), |tis| format!("{:.3}", incidence.integral / tis)),
            incidence.measured_to_deg.map_or("-".to_owned(), |_| percent(incidence.beyond_share())),
            format!("{:.4}", incidence.integral_filled),
            percent(incidence.grid_error),
            format!("{:.4}", incidence.peak),
            format!("{} {} {}", width(0), width(1), width(2)),
        ]);
    }
    let mut text = table(&rows);
    text.push_str(
        "  integral: of what was measured; beyond: share of the light that tails beyond the last measured angle would hold, not in \
         the integral; half-widths: towards the normal, across, away from it; grid error: what the grid leaves unknown\n",
    );
    text.push_str(&rotations(audit));
    let mut line = |said: String| {
        let _ = writeln!(text, "  {said}");
    };
    if let Some(haze) = audit.haze {
        let scope =
            if haze > HAZE_SCOPE { " (above 30 %: outside ASTM D1003's scope, see ASTM E2387)" } else { "" };
        let clarity =
            audit.clarity.map_or(String::new(), |clarity| format!(", clarity {}", percent(clarity)));
        line(format!("haze {}{clarity}{scope}", percent(haze)));
    }
    if let Some([rms, worst]) = audit.reciprocity {
        line(format!(
            "reciprocity: f(i,o) and f(o,i) differ by {} rms, {} at worst",
            percent(rms),
            percent(worst)
        ));
    }
    let lit = format!("{} of {} cells in the hemisphere hold light", audit.lit, audit.cells);
    line(format!("{lit}, up to {:.1} deg; holes below that: {}", audit.dark_beyond_deg, audit.holes));
    line(format!(
        "values {:.3e} to {:.3e} 1/sr, noise {:.1e} 1/sr among the faint ones",
        audit.range[0], audit.range[1], audit.noise
    ));
    if audit.asymmetry > 1e-9 {
        line(format!(
            "mirrored and turned cells differ by {} rms; the display takes their mean",
            percent(audit.asymmetry)
        ));
    }
    for warning in warnings(audit) {
        line(format!("warning: {warning}"));
    }
    text
}

/// How integral and TIS compare by rotation; nothing for a single one.
fn rotations(audit: &Audit) -> String {
    if audit.rotations.is_empty() {
        return String::new();
    }
    let mut text =
        "  TIS and integral are means over the rotations, as a display takes them; ratio of each rotation's own:\n".to_owned();
    for incidence in &audit.incidences {
        let of_theta = audit.rotations.iter().filter(|one| one.theta_deg == incidence.theta_deg);
        let ratios = of_theta.clone().filter_map(|one| Some((one.integral / one.tis?, one.rotation_deg)));
        let least = ratios.clone().min_by(|a, b| a.0.total_cmp(&b.0));
        let most = ratios.max_by(|a, b| a.0.total_cmp(&b.0));
        let _ = match least.zip(most) {
            Some(((least, at_least), (most, at_most))) => writeln!(
                text,
                "    {} deg: {least:.3} (rotation {at_least} deg) to {most:.3} (rotation {at_most} deg)",
                incidence.theta_deg
            ),
            None => writeln!(text, "    {} deg: the file gives no TIS", incidence.theta_deg),
        };
    }
    text
}

/// What its user should not overlook.
fn warnings(audit: &Audit) -> Vec<String> {
    let mut warnings = Vec::new();
    let at = |bad: &dyn Fn(&papilio_goniometry::Incidence) -> bool| -> Option<String> {
        let bad: Vec<String> =
            audit.incidences.iter().filter(|i| bad(i)).map(|i| format!("{}", i.theta_deg)).collect();
        (!bad.is_empty()).then(|| bad.join(", "))
    };
    if let Some(at) = at(&|i| i.integral > ABOVE_ONE || i.tis.is_some_and(|tis| tis > ABOVE_ONE)) {
        warnings.push(format!("more light leaves than came, at {at} deg"));
    }
    if let Some(at) = at(&|i| i.tis.is_some_and(|tis| (i.integral / tis - 1.0).abs() > TIS_TOLERANCE)) {
        let all: Vec<f64> = audit.incidences.iter().filter_map(|i| i.tis).collect();
        let one = all.len() > 1 && all.iter().all(|tis| *tis == all[0]);
        warnings.push(format!(
            "integral and TIS differ by more than 2 % at {at} deg{}",
            match one {
                true => "; TIS is the same at all incidences, as if it had been measured at one",
                false => "; `normalise = \"tis\"` takes the file's TIS",
            }
        ));
    }
    warnings.extend(beyond(audit));
    if let Some([first, last]) = audit.held_azimuths_deg {
        warnings.push(if first == last {
            "values are of one azimuth: the lobe is taken to be the same all around the specular direction".to_owned()
        } else {
            format!(
                "azimuths are {first:.0} to {last:.0} deg from the plane of incidence: beyond them the nearest one's values are \
                 taken, up to 0 and 180 deg"
            )
        });
    }
    if let Some(at) = at(&|i| i.grid_error - i.azimuth_error > TIS_TOLERANCE) {
        warnings
            .push(format!("the grid is too coarse for the lobe at {at} deg: a finer radial grid is needed"));
    }
    if let Some(at) = at(&|i| i.azimuth_error > TIS_TOLERANCE) {
        warnings.push(format!(
            "the azimuth grid is too coarse for the lobe at {at} deg: how values are interpolated between azimuths changes \
             the integral by up to {}; more azimuths are needed",
            percent(audit.incidences.iter().map(|i| i.azimuth_error).fold(0.0, f64::max))
        ));
    }
    if audit.beam_holes > 0 {
        warnings.push(format!(
            "{} cells are dark where the light comes from: the source hides them",
            audit.beam_holes
        ));
    }
    if audit.unmeasured > 0 {
        warnings.push(format!("{} cells were not measured; they count as dark", audit.unmeasured));
    }
    if audit.negative > 0 {
        warnings.push(format!("{} values are negative; they count as dark", audit.negative));
    }
    warnings
}

/// Where measured cells end before the horizon, and what may be beyond.
fn beyond(audit: &Audit) -> Option<String> {
    let open = || audit.incidences.iter().filter(|i| i.measured_to_deg.is_some());
    let worst = open().max_by(|a, b| a.beyond_share().total_cmp(&b.beyond_share()))?;
    if worst.beyond_share() <= MUCH_BEYOND {
        return None;
    }
    let at: Vec<String> = open().map(|i| i.theta_deg.to_string()).collect();
    let to_deg = open().filter_map(|i| i.measured_to_deg).fold(f64::INFINITY, f64::min);
    Some(format!(
        "nothing was measured farther than {to_deg} deg from the specular direction, at {} deg of incidence; tails that go on \
         there would hold up to {} of the light (at {} deg): a display takes them only with `extrapolate = \"hold\"` or \
         `extrapolate_tails = true`",
        at.join(", "),
        percent(worst.beyond_share()),
        worst.theta_deg
    ))
}
