//! Report of the changes to a measurement before its use in a display.

use papilio_diagnostics::Diagnostic;
use papilio_goniometry::{Changes, ScatterMode, may_be_relative};

use super::file::Source;
use crate::resolve::Resolver;

/// Excess of a total above 1 that gives a warning.
const ABOVE_ONE: f64 = 1e-3;
/// Smallest relative change of a total that is reported; a table preserves totals to 1e-4.
const REPORTED_CHANGE: f64 = 1e-3;
/// Excess of a total above 1 that is an error.
const FAR_ABOVE_ONE: f64 = 0.2;
/// Uncertainty of a total due to the grid that gives a warning: more is too much for the default relative
/// error.
const COARSE: f64 = 0.005;
/// Extrapolated fraction of the light that gives a warning.
const MUCH_BEYOND: f64 = 0.05;

impl Resolver<'_> {
    /// Reports changes as notes, and doubts as warnings. `share` is the largest factor over wavelength.
    pub(super) fn report(
        &mut self,
        source: &Source<'_>,
        way: ScatterMode,
        changes: &Changes,
        share: f64,
    ) -> Option<()> {
        let is_through = way.is_transmission();
        let (path, way) = (source.path, way.name());
        let largest = share * changes.most;
        if largest > 1.0 + FAR_ABOVE_ONE {
            let wrong = Diagnostic::new(format!("{way}: {largest:.3} times as much light leaves as arrives"))
                .expected("at most 1")
                .hint(
                    "`papilio diffuser inspect` shows the totals at each incidence; `normalise`, `extrapolate_tails` and \
                     `mounting` change them",
                );
            self.errors.push(source.file, wrong);
            return None;
        }
        if largest > 1.0 + ABOVE_ONE {
            self.warnings.push(format!("{path}: {way}: {largest:.3} times as much light leaves as arrives"));
        }
        let factors = || changes.totals.iter().map(|[before, after]| after / before);
        let (least, most) = factors().fold((f64::INFINITY, 0.0_f64), |(a, b), f| (a.min(f), b.max(f)));
        if let Some(level) = changes.level {
            let percent = 100.0 * level;
            self.notes.push(format!(
                "{path}: {way}: values are multiplied by {:.4} at all incidences: the total at the smallest one is {percent:.4} %, as \
                 `total_transmittance` states",
                changes.totals.first().map_or(1.0, |[before, after]| after / before)
            ));
            return self.report_rest(path, way, changes);
        }
        let total = share * changes.totals.first().map_or(1.0, |[_, after]| *after);
        if total == 0.0 && largest > 0.0 {
            self.warnings.push(format!(
                "{path}: {way}: all values at the smallest incidence are 0, and those of other incidences are not: its light is not scattered"
            ));
        } else if is_through && !changes.to_tis && may_be_relative(total, changes.largest) {
            self.warnings.push(format!(
                "{path}: {way}: {:.2} % of the light passes at the smallest incidence, and the largest value is {}: if the values are in \
                 relative units, `total_transmittance` gives them their level",
                100.0 * total,
                changes.largest
            ));
        }
        let why = match (changes.to_tis, changes.laminated) {
            (true, true) => "to match the instrument's TIS, without the loss at the back surface",
            (true, false) => "to match the instrument's TIS",
            (false, true) => "the loss at the back surface in air is removed",
            (false, false) if !changes.tails && changes.measured_to_deg.is_some() => {
                "the smooth lobe changes the edge of the measured cells"
            }
            (false, false) if changes.filled > 0.0 => "the smooth lobe changes dark cells at the horizon",
            (false, false) => "the smooth lobe is interpolated between the cells, and at the horizon",
        };
        if most - 1.0 > REPORTED_CHANGE || 1.0 - least > REPORTED_CHANGE {
            self.notes
                .push(format!("{path}: {way}: totals are multiplied by {least:.4} to {most:.4}: {why}"));
        }
        self.report_rest(path, way, changes)
    }

    /// Reports what does not concern the level.
    fn report_rest(&mut self, path: &str, way: &str, changes: &Changes) -> Option<()> {
        if changes.filled > 0.0 {
            let percent = 100.0 * changes.filled;
            self.notes.push(format!(
                "{path}: {way}: {percent:.1} % of the cells were dark; tails are extrapolated through them"
            ));
        }
        if let Some(index) = changes.face {
            self.notes.push(format!(
                "{path}: {way}: light falls towards the horizon as through a smooth face of index {index}: between the measured directions it \
                 is interpolated below such a face"
            ));
        }
        if let Some(width) = changes.rings_deg {
            self.notes.push(format!(
                "{path}: {way}: the values are constant over cells: light of a cell is spread over the rings of {width} deg about the normal \
                 that it touches, and averaged over rotations of the sample"
            ));
        }
        if let Some(errors) = changes.pairs {
            let left_out = match errors.incidence_left_out {
                Some(error) => format!("; without an incidence, its pairs by {:.2} %", 100.0 * error.rms),
                None => String::new(),
            };
            self.notes.push(format!(
                "{path}: {way}: the file lists single pairs of directions: values between them are interpolated, for an isotropic sample; \
                 predicted from the others, a pair is missed by {:.2} % (root mean square, noise included){left_out}",
                100.0 * errors.one_left_out.rms
            ));
        }
        self.report_range(path, way, changes);
        self.warn_of_uncertainty(path, way, changes);
        Some(())
    }

    /// Reports the treatment of light from and to directions that were not measured.
    fn report_range(&mut self, path: &str, way: &str, changes: &Changes) {
        if changes.lost > 0.0 {
            self.warnings.push(format!(
                "{path}: {way}: nothing was measured beyond {} deg: light from there is lost ({:.1} % of diffuse light), and \
                 views from there are dark; `extrapolate = \"hold\"` uses the last lobe there",
                changes.last_deg,
                100.0 * changes.lost
            ));
        }
        if changes.held_single {
            self.notes.push(format!(
                "{path}: {way}: the file has one incidence, {} deg: its lobe is used at all others, about their own specular \
                 directions; with `extrapolate = \"none\"` their light is lost",
                changes.last_deg
            ));
        } else if changes.held > REPORTED_CHANGE {
            self.notes.push(format!(
                "{path}: {way}: the last incidence below 90 deg is {} deg: beyond it ({:.1} % of diffuse light) its lobe is used, \
                 about the specular direction of the light; with `extrapolate = \"none\"` this light is lost",
                changes.last_deg,
                100.0 * changes.held
            ));
        }
        self.report_beyond(path, way, changes);
        if let Some([first, last]) = changes.held_azimuths_deg {
            self.warnings.push(format!(
                "{path}: {way}: azimuths about the specular direction are {first:.0} to {last:.0} deg from the plane of incidence; \
                 beyond them the values of the nearest azimuth are used, up to 0 and 180 deg"
            ));
        }
    }

    /// Warns of uncertainty due to the grid and to asymmetry of the sample.
    fn warn_of_uncertainty(&mut self, path: &str, way: &str, changes: &Changes) {
        if let Some(grid_error) = changes.grid_error.filter(|error| *error > COARSE) {
            let percent = 100.0 * grid_error;
            let azimuths = match changes.azimuth_error > Some(0.5 * grid_error) {
                true => ", mostly because its azimuths are too far apart: measure them in smaller steps",
                false => "",
            };
            self.warnings.push(format!(
                "{path}: {way}: the file's grid leaves {percent:.1} % of the light uncertain{azimuths}"
            ));
        }
        if changes.asymmetry > 0.01 {
            let percent = 100.0 * changes.asymmetry;
            self.warnings.push(format!(
                "{path}: {way}: mirrored and rotated directions differ by {percent:.1} %; their mean is used"
            ));
        }
    }

    /// Reports the treatment and the amount of light beyond the last measured distance from the specular
    /// direction.
    fn report_beyond(&mut self, path: &str, way: &str, changes: &Changes) {
        if let Some([theta, share]) = changes.held_beyond.filter(|[_, share]| *share >= REPORTED_CHANGE) {
            let percent = 100.0 * share;
            self.notes.push(format!(
                "{path}: {way}: at {theta} deg of incidence, {percent:.1} % of the light is farther from the specular direction than anything \
                 that was measured: this part is extrapolated"
            ));
        }
        let by_share = |a: &&[f64; 2], b: &&[f64; 2]| a[1].total_cmp(&b[1]);
        let ends = changes.beyond.iter().min_by(by_share).zip(changes.beyond.iter().max_by(by_share));
        let Some((to_deg, ([at_least, least], [at_most, most]))) = changes.measured_to_deg.zip(ends) else {
            return;
        };
        if *most < REPORTED_CHANGE {
            return;
        }
        let at = |share: f64, theta: f64| format!("{:.1} % (at {theta} deg of incidence)", 100.0 * share);
        let shares = match changes.beyond.len() {
            1 => at(*most, *at_most),
            _ => format!("{} to {}", at(*least, *at_least), at(*most, *at_most)),
        };
        let unmeasured = match changes.inclined_to_deg {
            Some(theta) => {
                format!("{path}: {way}: nothing was measured at more than {theta} deg from the normal")
            }
            None => format!(
                "{path}: {way}: nothing was measured farther than {to_deg} deg from the specular direction"
            ),
        };
        if !changes.tails {
            self.warnings.push(format!(
                "{unmeasured}, and no light is scattered there; extrapolated tails would have {shares} of the light: `extrapolate = \"hold\"` \
                 or `extrapolate_tails = true` adds them"
            ));
        } else if *most < MUCH_BEYOND {
            self.notes.push(format!("{unmeasured}; extrapolated tails there have {shares} of the light"));
        } else {
            self.warnings.push(format!(
                "{unmeasured}; extrapolated tails there have {shares} of the light: this part is not measured"
            ));
        }
    }
}
