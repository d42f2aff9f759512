//! Maps of heights: their files, distances and units, and what no instrument measures.

use std::collections::BTreeMap;

use papilio_diagnostics::Diagnostic;
use papilio_formats::{HeightFile, read_heights};
use papilio_microgeometry::{HeightMap, Surface};

use super::SurfaceScenario;
use crate::describe::microgeometry::{self as described, HeightDistance, MapPeriod};
use crate::describe::numbers::SurfaceLength;
use crate::error::Errors;
use crate::library::Library;
use crate::read::Spanned;

/// Most heights of a map in memory, which a server is given by anyone: their mirror images take 128 MiB.
const MOST_HEIGHTS_IN_MEMORY: usize = 1 << 22;

/// Root mean square slope from which a map is doubted: 63 deg. Prisms of 45 deg have 1, lenses up to their
/// rims somewhat more.
const DOUBTFUL_SLOPE: f64 = 2.0;

/// Relative difference from which a stated distance of heights contradicts that of the file: more than
/// rounding.
const OTHER_DISTANCE: f64 = 0.01;

impl SurfaceScenario {
    /// Reads a map of heights.
    pub(super) fn heights(
        &self,
        map: &described::HeightMap,
        errors: &mut Errors,
        inputs: &mut BTreeMap<String, String>,
        notes: &mut Vec<String>,
    ) -> Option<Surface> {
        let kept = self.open(&map.file, errors, inputs)?;
        let found = match read_heights(kept.file()) {
            Ok(found) => found,
            Err(error) => {
                errors.push_data(map.file.origin, error);
                return None;
            }
        };
        notes.extend(found.warnings.iter().map(|warning| format!("{}: {warning}", map.file.value)));
        if matches!(self.library, Library::Memory { .. }) && found.numbers.len() > MOST_HEIGHTS_IN_MEMORY {
            let wrong = Diagnostic::new(format!("this map has {} heights", found.numbers.len()))
                .expected(format!("at most {MOST_HEIGHTS_IN_MEMORY} here, such as 2048 x 2048"))
                .hint("cut out a part of it, or measure it with `papilio gonio`, which reads 4096 x 4096 heights");
            errors.push(map.file.origin, wrong);
            return None;
        }
        let heights = in_um(map, &found, errors, notes)?;
        if let Err(wrong) = heights.check_relief() {
            let wrong = Diagnostic::new(wrong.to_string())
                .hint("are `pixel_um`, `height_um_per_unit` and the units of the file right? Is a height wrong, such as a spike?");
            errors.push(map.file.origin, wrong);
            return None;
        }
        let heights = match (map.level.value, map.period.value) {
            (false, _) => heights,
            (true, MapPeriod::Mirror) => heights.levelled(),
            (true, MapPeriod::Repeat) => {
                let (level, rises_um) = heights.levelled_period();
                notes.extend(tilt(rises_um, &map.file.value));
                level
            }
        };
        notes.extend(doubt(&heights, &map.file.value));
        let heights = match map.period.value {
            MapPeriod::Mirror => heights.mirrored(),
            MapPeriod::Repeat => heights,
        };
        let [short, long] =
            [&map.cutoff_um, &map.longest_um].map(|length| length.value.map(|length| length.0));
        if let (Some(short), Some(long)) = (short, long)
            && short >= long
        {
            let wrong = Diagnostic::new(format!(
                "the filters leave nothing: {short} um is not shorter than {long} um"
            ))
            .expected("`cutoff_um` below `longest_um`");
            errors.push(map.cutoff_um.origin, wrong);
            return None;
        }
        Some(Surface::Heights(match (short, long) {
            (None, None) => heights,
            _ => heights.filtered(short, long),
        }))
    }
}

/// The heights of a file in um, with the distance and the unit of the scenario or of the file.
fn in_um(
    map: &described::HeightMap,
    found: &HeightFile,
    errors: &mut Errors,
    notes: &mut Vec<String>,
) -> Option<HeightMap> {
    let stated_um = match &map.pixel_um.value {
        None => None,
        Some(HeightDistance::Square(both)) => Some([both.0; 2]),
        Some(HeightDistance::Oblong(list)) => {
            match list.iter().map(|length: &Spanned<SurfaceLength>| length.0).collect::<Vec<_>>()[..] {
                [both] => Some([both; 2]),
                [x, y] => Some([x, y]),
                _ => {
                    let wrong = Diagnostic::new(format!("this list has {} numbers", list.len()))
                        .expected("one distance, or those along x and y");
                    errors.push(map.pixel_um.origin, wrong);
                    return None;
                }
            }
        }
    };
    if let (Some(stated), Some(own)) = (stated_um, found.pitch_um)
        && (0..2).any(|axis| (stated[axis] / own[axis] - 1.0).abs() > OTHER_DISTANCE)
    {
        notes.push(format!(
            "{}: the file states heights {} um and {} um apart; `pixel_um` is used instead",
            map.file.value, own[0], own[1]
        ));
    }
    let Some(pitch_um) = stated_um.or(found.pitch_um) else {
        let wrong = Diagnostic::new("this file does not state the distance of its heights")
            .expected("the key `pixel_um`")
            .hint("for example pixel_um = 0.5; files of profilometers and lists of points state it");
        errors.push(map.file.origin, wrong);
        return None;
    };
    let unit_um = map.height_um_per_unit.value.map(|unit| unit.0).or(found.unit_um);
    let Some(unit_um) = unit_um.or((!found.is_picture).then_some(1.0)) else {
        let wrong = Diagnostic::new("a picture does not state the height of its steps")
            .expected("the key `height_um_per_unit`, the height of the number 1 of 65535");
        errors.push(map.file.origin, wrong);
        return None;
    };
    let heights = found.numbers.iter().map(|number| number * unit_um).collect();
    match HeightMap::new(found.columns, pitch_um, heights) {
        Ok(heights) => Some(heights),
        Err(wrong) => {
            errors.push(map.file.origin, Diagnostic::new(wrong.to_string()));
            None
        }
    }
}

/// A note of the tilt that was subtracted from a period.
fn tilt(rises_um: [f64; 2], file: &str) -> Option<String> {
    let along = [("x", rises_um[0]), ("y", rises_um[1])];
    let along: Vec<String> = along
        .iter()
        .filter(|(_, rise)| *rise != 0.0)
        .map(|(axis, rise)| format!("{rise:.4} um along {axis}"))
        .collect();
    (!along.is_empty()).then(|| {
        format!(
            "{file}: where periods meet, the heights have the step of a tilted surface, {}: the tilt is subtracted; `level = false` keeps a \
             step that is the surface's own, as of a blazed grating",
            along.join(" and ")
        )
    })
}

/// A warning of slopes that no instrument measures. Differences across the edges, which a period has and a
/// map may not, do not count.
fn doubt(heights: &HeightMap, file: &str) -> Option<String> {
    let slopes = heights.inner_slopes();
    let (axis, slope) = if slopes[0] >= slopes[1] { ("x", slopes[0]) } else { ("y", slopes[1]) };
    (slope > DOUBTFUL_SLOPE).then(|| {
        format!(
            "{file}: the slopes along {axis} are {slope:.3} rms ({:.1} deg), steeper than instruments measure: are `pixel_um`, \
             `height_um_per_unit` and the units of the file right, and is no height a spike or a mark of a missing one?",
            slope.atan().to_degrees()
        )
    })
}
