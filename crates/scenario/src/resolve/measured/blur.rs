//! Removal of the instrument's blur from a measurement.

use papilio_diagnostics::Diagnostic;
use papilio_goniometry::{self as goniometry, DeblurOptions, DeblurStatistics, GoniometryError, deblurred};

use super::file::Source;
use crate::describe::numbers::Blur;
use crate::resolve::Resolver;

/// Largest difference between the file and the sharp lobe after blurring it again that gives no warning.
const MISFIT: f64 = 0.03;
/// Difference beyond which the blur cannot be removed.
const FAR_MISFIT: f64 = 0.3;

/// Error: the blur cannot be removed from the measurement.
fn unblurred(error: &GoniometryError) -> Diagnostic {
    let of_width = matches!(error, GoniometryError::Blur { .. });
    let hint = "the width is that of the image of a collimated beam, measured without a sample";
    Diagnostic::new(error.to_string()).hint_if(of_width.then_some(hint))
}

impl Resolver<'_> {
    /// Returns the part's luminous channel without the instrument's blur; `Some(None)` if there is no blur to
    /// remove.
    pub(super) fn without_blur(
        &mut self,
        source: &Source<'_>,
        part: &goniometry::MeasuredPart,
    ) -> Option<Option<goniometry::MeasuredPart>> {
        let Some(blur) = source.blur.filter(|blur| blur.value.0 > 0.0) else { return Some(None) };
        let Blur(width) = blur.value;
        let channel = part.luminous();
        let sharp = match deblurred(part, channel, &DeblurOptions::of_width(width)) {
            Ok(sharp) => sharp,
            Err(error) => {
                self.errors.push(blur.origin, unblurred(&error));
                return None;
            }
        };
        let (path, way, [spread, _]) = (source.path, part.way.name(), sharp.noise_amplification);
        let misfit = sharp.incidences.iter().map(|lobe| lobe.misfit).fold(0.0, f64::max);
        if misfit > FAR_MISFIT {
            self.errors.push(blur.origin, unblurred(&GoniometryError::Blur { width, misfit }));
            return None;
        }
        if let Some(DeblurStatistics { theta_deg, peak: [before, after], .. }) = sharp.incidences.first() {
            self.notes.push(format!(
                "{path}: {way}: without the instrument's blur of {width} the peak at {theta_deg} deg is {after:.1} instead of \
                 {before:.1} per sr; relative noise is {spread:.1} times as large; blurred again, values differ from the file's \
                 by {:.2} % (root mean square)",
                100.0 * misfit
            ));
        }
        if misfit > MISFIT {
            self.warnings.push(format!(
                "{path}: {way}: no lobe blurred by {width} reproduces the file's values: {:.0} % remain; `instrument_blur` may be \
                 too wide",
                100.0 * misfit
            ));
        }
        let totals = match &part.geometry {
            goniometry::Geometry::Specular(grid) => grid.rotations_deg.len() * grid.incidences_deg.len(),
            _ => 0,
        };
        let tis = part.tis.chunks_exact(totals.max(1)).nth(channel).unwrap_or_default();
        Some(Some(goniometry::MeasuredPart {
            way: part.way,
            channels: vec![part.channels[channel]],
            geometry: part.geometry.clone(),
            values: sharp.values,
            tis: tis.to_vec(),
        }))
    }
}
