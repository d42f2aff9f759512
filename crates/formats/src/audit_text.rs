//! Audits of measurements as text: the output of `papilio diffuser inspect`.

use std::fmt::Write;

use papilio_goniometry::{
    Audit, DeblurOptions, Geometry, ListedPairs, MeasuredPart, Measurement, PairError, ScatterMode,
    SpecularGrid, Symmetry, WavelengthLevels, deblurred, may_be_relative,
};

use crate::words::{channel, degrees, number, percent, span, table};

/// Largest haze in the scope of ASTM D1003.
const HAZE_SCOPE: f64 = 0.30;
/// A larger integral or TIS cannot be explained by rounding.
const ABOVE_ONE: f64 = 1.005;
/// Largest fraction of the light beyond the measured angles without a warning.
const MUCH_BEYOND: f64 = 0.005;
/// Largest relative difference between integral and TIS, and largest grid error, without a warning.
const TIS_TOLERANCE: f64 = 0.02;

/// Returns a description of a measurement with the audit of the luminous channel of each part (`None`: its
/// directions do not form a grid). `name` is the name of the file.
pub fn audit_text(name: &str, measurement: &Measurement, audits: &[Option<Audit>]) -> String {
    let provenance = &measurement.provenance;
    let mut text = format!("{name}: {}\n", provenance.format);
    for (label, value) in [("sample", &provenance.sample), ("source", &provenance.source)] {
        if !value.is_empty() {
            let _ = writeln!(text, "{label}: {value}");
        }
    }
    if measurement.media != [1.0, 1.0] {
        let [front, back] = measurement.media;
        let _ = writeln!(text, "media: refractive index {front} in front, {back} behind");
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
        // Details of the luminous channel only.
        match audit {
            Some(audit) => text.push_str(&audit_lines(part, audit)),
            None => text.push_str("  fewer than 12 different directions: values between them are unknown\n"),
        }
        if matches!(part.geometry, Geometry::Tree(_)) {
            text.push_str(
                "  integral: sum of value x projected solid angle over the cells, averaged over azimuths of the light; peak: value of the cell \
                 in the specular direction; the data do not resolve directions within a cell\n",
            );
        }
        text.push_str(&wavelengths(part));
        if matches!(part.geometry, Geometry::Patches { .. }) {
            text.push_str(
                "  integral: sum of value x projected solid angle over the patches, averaged over the patches of the incident \
                 ring; peak: value of the patch in the specular direction; the data do not resolve directions within a patch\n",
            );
        }
    }
    text + &sharp_haze(measurement)
}

/// Explains what displays use of several channels.
fn wavelengths(part: &MeasuredPart) -> String {
    let Some(used) = part.channels.get(part.luminous()).filter(|_| part.channels.len() > 1) else {
        return String::new();
    };
    match WavelengthLevels::of(part) {
        Some(levels) => {
            let [least, most] =
                [f64::min, f64::max].map(|of| levels.ratios.iter().copied().reduce(of).unwrap_or(f64::NAN));
            format!(
                "  this report and the lobe of displays are those of {used} nm; displays use the level of each wavelength: {least:.4} to \
                 {most:.4} of it; lobes differ by up to {} of the peak besides their level\n",
                percent(levels.shape_difference)
            )
        }
        None => format!("  this report and displays use the channel {used}; --json has all channels\n"),
    }
}

/// Haze of the transmissions without the instrument blur that the file states; empty if it states none.
fn sharp_haze(measurement: &Measurement) -> String {
    let remarks = measurement.provenance.remarks.iter();
    let stated = remarks.filter(|remark| remark.contains("in direction cosines"));
    let width = stated
        .filter_map(|remark| remark.strip_prefix("blur ")?.split(' ').next()?.parse::<f64>().ok())
        .next();
    let Some(width) = width.filter(|width| *width > 0.0) else { return String::new() };
    let hazes: Vec<String> = measurement
        .parts
        .iter()
        .filter_map(|part| {
            Some(format!("{} of the {}", percent(haze_without(part, width)?), part.way.name()))
        })
        .collect();
    match hazes.is_empty() {
        true => String::new(),
        false => format!(
            "\nhaze without the instrument blur of {width} (direction cosines) that the file states: {}\n  `instrument_blur = {width}` \
             removes it in a display\n",
            hazes.join(", ")
        ),
    }
}

/// Haze of a transmission at its smallest incidence, with the blur removed.
fn haze_without(part: &MeasuredPart, width: f64) -> Option<f64> {
    let Geometry::Specular(grid) = &part.geometry else { return None };
    let cells = grid.azimuths_deg.len() * grid.radials_deg.len();
    let channel = part.luminous();
    // One rotation and incidence is enough.
    let first = SpecularGrid {
        rotations_deg: grid.rotations_deg.first().copied().into_iter().collect(),
        incidences_deg: grid.incidences_deg.first().copied().into_iter().collect(),
        ..grid.clone()
    };
    let mut part = MeasuredPart {
        way: part.way,
        channels: vec![part.channels[channel]],
        geometry: Geometry::Specular(first),
        values: part.channel(channel).get(..cells)?.to_vec(),
        tis: Vec::new(),
    };
    part.values = deblurred(&part, 0, &DeblurOptions::of_width(width)).ok()?.values;
    Audit::of(&part, 0)?.haze
}

/// Returns the side from which the light comes.
fn side(way: ScatterMode) -> &'static str {
    match way {
        ScatterMode::FrontReflection | ScatterMode::FrontTransmission => "front",
        ScatterMode::BackTransmission | ScatterMode::BackReflection => "back",
    }
}

/// Returns "transmission" or "reflection".
fn kind(way: ScatterMode) -> &'static str {
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
                Symmetry::None => "full circle",
            };
            let turns = match grid.rotations_deg.len() {
                0 | 1 => String::new(),
                _ => format!("rotations: {}; ", span(&grid.rotations_deg)),
            };
            format!(
                "about the specular direction, deg: {turns}incidences: {}; azimuths: {}, {symmetry}; radial: {}",
                span(&grid.incidences_deg),
                span(&grid.azimuths_deg),
                span(&grid.radials_deg),
            )
        }
        Geometry::Spherical(grid) => format!(
            "inclinations and azimuths, deg: light {} and {}; viewer {} and {}",
            span(&grid.theta_i_deg),
            span(&grid.phi_i_deg),
            span(&grid.theta_o_deg),
            span(&grid.phi_o_deg),
        ),
        Geometry::Pairs(pairs) => format!("{} pairs of directions", pairs.len()),
        other => format!("{} cells", other.cells()),
    }
}

fn audit_lines(part: &MeasuredPart, audit: &Audit) -> String {
    let header = [
        "incidence",
        "TIS",
        "integral",
        "ratio",
        "beyond",
        "tails filled",
        "grid error",
        "peak (1/sr)",
        "half-widths (deg)",
    ];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for incidence in &audit.incidences {
        let width = |k: usize| incidence.half_widths_deg[k].map_or("-".to_owned(), |deg| format!("{deg:.2}"));
        rows.push(vec![
            format!("{} deg", degrees(incidence.theta_deg)),
            incidence.tis.map_or("-".to_owned(), |tis| format!("{tis:.4}")),
            format!("{:.4}", incidence.integral),
            incidence.tis.map_or("-".to_owned(), |tis| format!("{:.3}", incidence.integral / tis)),
            incidence.measured_to_deg.map_or("-".to_owned(), |_| percent(incidence.beyond_share())),
            format!("{:.4}", incidence.integral_filled),
            incidence.grid_error.map_or("not known".to_owned(), percent),
            incidence.peak.map_or("-".to_owned(), |peak| format!("{peak:.4}")),
            format!("{} {} {}", width(0), width(1), width(2)),
        ]);
    }
    let mut text = table(&rows);
    text.push_str(
        "  integral: over the measured directions; beyond: fraction of the light in tails beyond the last measured angle, not included \
         in the integral; tails filled: integral with those tails and with the dark cells filled; half-widths: towards the normal, across, away from the normal; grid error: uncertainty of the integral due \
         to the grid\n",
    );
    text.push_str(&rotations(audit));
    let mut line = |content: String| {
        let _ = writeln!(text, "  {content}");
    };
    if let Some(haze) = audit.haze {
        let scope = if haze > HAZE_SCOPE {
            " (above 30 %: outside the scope of ASTM D1003, see ASTM E2387)"
        } else {
            ""
        };
        line(format!("haze {} of the values as they are, instrument blur included{scope}", percent(haze)));
    }
    match audit.clarity {
        Some(clarity) if clarity >= 0.0 => line(format!(
            "clarity {}: (C - R)/(C + R), with C the light within 1 deg of the direct beam and R that from 1 to 2.5 deg",
            percent(clarity)
        )),
        Some(_) => line(
            "clarity: none, because more light is scattered by 1 to 2.5 deg than by less than 1 deg"
                .to_owned(),
        ),
        None if audit.haze.is_some() => line(
            "clarity: not measured, which needs light within 2.5 deg of the direct beam in steps of 0.5 deg"
                .to_owned(),
        ),
        None => {}
    }
    if let Some([rms, worst]) = audit.reciprocity {
        line(format!(
            "reciprocity: f(i,o) and f(o,i) differ by {} rms, at most by {}",
            percent(rms),
            percent(worst)
        ));
    }
    let range = format!("values {:.3e} to {:.3e} 1/sr", audit.range[0], audit.range[1]);
    match audit.pairs {
        Some(pairs) => {
            let of_pairs = pair_lines(part, audit, &pairs);
            of_pairs.into_iter().chain([range]).for_each(&mut line);
        }
        None => {
            let lit = format!("{} of {} cells in the hemisphere have values above 0", audit.lit, audit.cells);
            line(format!(
                "{lit}, up to {:.1} deg; dark cells below that angle: {}",
                audit.dark_beyond_deg, audit.holes
            ));
            line(format!("{range}; noise of the fainter half of the values {:.1e} 1/sr", audit.noise));
        }
    }
    if audit.asymmetry > 1e-9 {
        line(format!(
            "cells that symmetry makes equivalent (mirrored or rotated) differ by {} rms; displays use their mean",
            percent(audit.asymmetry)
        ));
    }
    for warning in warnings(part, audit) {
        line(format!("warning: {warning}"));
    }
    text
}

/// Returns what concerns listed pairs of directions.
fn pair_lines(part: &MeasuredPart, audit: &Audit, pairs: &ListedPairs) -> Vec<String> {
    let [light, viewer] = pairs.largest_deg.map(degrees);
    let error = |error: &PairError| {
        format!(
            "{} rms, {} in the mean, 95 % of them by at most {}",
            percent(error.rms),
            percent(error.mean),
            percent(error.within_95)
        )
    };
    let mut lines = vec![
        format!(
            "{} of {} pairs have values above 0; by symmetry of an isotropic sample {} are different; light up to {light} deg, viewer up \
             to {viewer} deg",
            audit.lit, audit.cells, pairs.points
        ),
        format!(
            "values between the pairs are interpolated, and so are whole incidences that were not measured{}: a polynomial of ln f \
             through the nearest ones",
            not_measured(part, audit)
        ),
        format!(
            "interpolation error: pairs predicted from all others are missed by {}",
            error(&pairs.errors.one_left_out)
        ),
    ];
    if let Some(left_out) = &pairs.errors.incidence_left_out {
        lines.push(format!(
            "between incidences: the pairs of one predicted from the others are missed by {}",
            error(left_out)
        ));
    }
    lines
}

/// Returns the incidences of an audit that no pair has, in brackets.
fn not_measured(part: &MeasuredPart, audit: &Audit) -> String {
    /// Directions of a goniometer are equal to within this, degrees.
    const EQUAL_DEG: f64 = 0.05;
    let Geometry::Pairs(pairs) = &part.geometry else { return String::new() };
    let has = |theta_deg: f64| pairs.iter().any(|[light, _]| (light.theta_deg - theta_deg).abs() < EQUAL_DEG);
    let all = audit.incidences.iter().map(|one| one.theta_deg);
    let missing: Vec<String> = all.filter(|theta| !has(*theta)).map(degrees).collect();
    if missing.is_empty() { String::new() } else { format!(" ({} deg)", missing.join(", ")) }
}

/// Returns the ratios of integral and TIS by rotation; empty for a single rotation.
fn rotations(audit: &Audit) -> String {
    if audit.rotations.is_empty() {
        return String::new();
    }
    let mut text =
        "  TIS and integral are means over the rotations, as displays use them; ratio of integral and TIS by rotation:\n".to_owned();
    for incidence in &audit.incidences {
        let of_theta = audit.rotations.iter().filter(|one| one.theta_deg == incidence.theta_deg);
        let ratios = of_theta.clone().filter_map(|one| Some((one.integral / one.tis?, one.rotation_deg)));
        let least = ratios.clone().min_by(|a, b| a.0.total_cmp(&b.0));
        let most = ratios.max_by(|a, b| a.0.total_cmp(&b.0));
        let _ = match least.zip(most) {
            Some(((least, at_least), (most, at_most))) => writeln!(
                text,
                "    {} deg: {least:.3} (rotation {at_least} deg) to {most:.3} (rotation {at_most} deg)",
                degrees(incidence.theta_deg)
            ),
            None => writeln!(text, "    {} deg: the file has no TIS", degrees(incidence.theta_deg)),
        };
    }
    text
}

/// Returns the warnings of an audit.
pub(crate) fn warnings(part: &MeasuredPart, audit: &Audit) -> Vec<String> {
    let mut warnings = Vec::new();
    // The reader warns of a TIS in per cent.
    let in_percent = part.tis_in_percent();
    warnings.extend(relative(part, audit));
    let at = |bad: &dyn Fn(&papilio_goniometry::Incidence) -> bool| -> Option<String> {
        let bad: Vec<String> =
            audit.incidences.iter().filter(|i| bad(i)).map(|i| degrees(i.theta_deg)).collect();
        (!bad.is_empty()).then(|| bad.join(", "))
    };
    if let Some(at) =
        at(&|i| i.integral > ABOVE_ONE || i.tis.is_some_and(|tis| tis > ABOVE_ONE && !in_percent))
    {
        warnings.push(format!("more light leaves than arrives (integral or TIS above 1) at {at} deg"));
    }
    if let Some(at) =
        at(&|i| i.tis.is_some_and(|tis| !in_percent && (i.integral / tis - 1.0).abs() > TIS_TOLERANCE))
    {
        let all: Vec<f64> = audit.incidences.iter().filter_map(|i| i.tis).collect();
        let one = all.len() > 1 && all.iter().all(|tis| *tis == all[0]);
        warnings.push(format!(
            "integral and TIS differ by more than 2 % at {at} deg{}",
            match one {
                true => "; TIS is the same at all incidences: it may have been measured at only one",
                false => "; use `normalise = \"tis\"` to scale the values to the TIS of the file",
            }
        ));
    }
    warnings.extend(beyond(audit));
    warnings.extend(below(&part.geometry));
    if let Some([first, last]) = audit.held_azimuths_deg {
        warnings.push(if first == last {
            "the file has a single azimuth: the lobe is assumed to be rotationally symmetric about the specular direction".to_owned()
        } else {
            format!(
                "azimuths are {first:.0} to {last:.0} deg from the plane of incidence: outside this range, down to 0 and up to 180 deg, \
                 the values of the nearest azimuth are used"
            )
        });
    }
    // Half the widest step of a grid about the normal.
    let finer =
        |axis: &[f64]| number(0.5 * axis.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max));
    let errors = |i: &papilio_goniometry::Incidence| {
        let [all, azimuths] = [i.grid_error, i.azimuth_error].map(|error| error.unwrap_or_default());
        [all - azimuths, azimuths]
    };
    if let Some(at) = at(&|i| errors(i)[0] > TIS_TOLERANCE) {
        warnings.push(match &part.geometry {
            Geometry::Spherical(grid) => format!(
                "the inclinations of the viewer are too far apart for the lobe at {at} deg: measure them in steps of {} deg",
                finer(&grid.theta_o_deg)
            ),
            Geometry::Tree(_) => format!(
                "a display spreads the cells of a tensor tree over rings about the normal, which moves up to {} of the light: a grid about the \
                 specular direction keeps it in place",
                percent(audit.incidences.iter().map(|i| errors(i)[0]).fold(0.0, f64::max))
            ),
            _ => format!("the radial grid is too coarse for the lobe at {at} deg: measure with a finer radial grid"),
        });
    }
    if let Some(at) = at(&|i| errors(i)[1] > TIS_TOLERANCE) {
        let most = percent(audit.incidences.iter().map(|i| errors(i)[1]).fold(0.0, f64::max));
        warnings.push(match &part.geometry {
            Geometry::Spherical(grid) => format!(
                "the azimuths are too far apart for the lobe at {at} deg: up to {most} of the integral is uncertain; measure \
                 azimuths in steps of {} deg, or about the specular direction",
                finer(&grid.phi_o_deg)
            ),
            _ => format!(
                "the azimuth grid is too coarse for the lobe at {at} deg: the method of interpolation between azimuths changes \
                 the integral by up to {most}; measure more azimuths"
            ),
        });
    }
    if audit.beam_holes > 0 {
        warnings.push(format!(
            "{} cells around the direction of the source are dark: the source obstructs the detector there",
            audit.beam_holes
        ));
    }
    if audit.unmeasured > 0 && audit.pairs.is_some() {
        warnings.push(format!("{} pairs have no value; they are not used", audit.unmeasured));
    } else if audit.unmeasured > 0 {
        warnings.push(format!(
            "{} cells were not measured; those between measured ones are interpolated, and the integral does not include the others",
            audit.unmeasured
        ));
    }
    if audit.negative > 0 {
        warnings.push(format!("{} values are negative; they are treated as dark", audit.negative));
    }
    warnings
}

/// Returns a warning if measured cells end before the horizon and extrapolated tails would hold a significant
/// fraction of the light.
fn beyond(audit: &Audit) -> Option<String> {
    let open = || audit.incidences.iter().filter(|i| i.measured_to_deg.is_some());
    let worst = open().max_by(|a, b| a.beyond_share().total_cmp(&b.beyond_share()))?;
    if worst.beyond_share() <= MUCH_BEYOND {
        return None;
    }
    let at: Vec<String> = open().map(|i| degrees(i.theta_deg)).collect();
    let to_deg = open().filter_map(|i| i.measured_to_deg).fold(f64::INFINITY, f64::min);
    let end = match audit.inclined_to_deg {
        Some(theta) => format!("the measurement ends {} deg from the normal", degrees(theta)),
        None => format!(
            "the measurement ends {} deg from the specular direction, at incidence {} deg",
            degrees(to_deg),
            at.join(", ")
        ),
    };
    Some(format!(
        "{end}; tails extrapolated beyond that angle would hold up to {} of the light (at {} deg); displays include them, unless \
         `extrapolate = \"none\"`",
        percent(worst.beyond_share()),
        degrees(worst.theta_deg)
    ))
}

/// Returns a warning if a grid of inclinations of the viewer begins more than a step from the normal.
fn below(geometry: &Geometry) -> Option<String> {
    let Geometry::Spherical(grid) = geometry else { return None };
    let first = grid.theta_o_deg.first().copied()?;
    let step = grid.theta_o_deg.get(1).map_or(0.0, |second| second - first);
    (first > step).then(|| {
        format!(
            "the smallest inclination of the viewer is {} deg: its values are used for smaller ones, down to the normal",
            degrees(first)
        )
    })
}

/// Returns a warning if the smallest incidence has no light, or the values of a transmission may be in relative units.
fn relative(part: &MeasuredPart, audit: &Audit) -> Option<String> {
    let largest = audit.range[1];
    let first = audit.incidences.first();
    let total = first.map_or(1.0, |incidence| incidence.integral);
    if let (Some(dark), Some(lit)) =
        (first.filter(|one| one.integral == 0.0), audit.incidences.iter().find(|one| one.integral > 0.0))
    {
        return Some(format!(
            "all values at {} deg of incidence are 0, and the first incidence with light is {} deg: displays scatter no light of the \
             smaller ones",
            degrees(dark.theta_deg),
            degrees(lit.theta_deg)
        ));
    }
    (part.way.is_transmission() && may_be_relative(total, largest) && audit.lit > 0).then(|| {
        format!(
            "{} of the light passes at the smallest incidence, and the largest value is {}: if the values are in relative units, \
             `total_transmittance` gives them their level in a display",
            percent(total),
            number(largest)
        )
    })
}
