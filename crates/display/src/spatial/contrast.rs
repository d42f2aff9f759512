//! Contrast of lines and text, and means of patterns.

use super::measured::Measured;
use super::mtf::Frame;
use super::patterns::{self, Pattern};
use super::{Level, PatternKind, PatternMean};
use crate::metrics::LineContrast;
use crate::setup::ViewPoint;

/// Widths of lines, pixels.
const LINES: [f64; 3] = [1.0, 2.0, 4.0];

impl Frame<'_> {
    /// Widths of lines across an axis, mm; none without a matrix.
    pub(super) fn lines(&self, axis: usize) -> impl Iterator<Item = f64> + use<> {
        let pitch = self.pitch_mm.map(|pitch| pitch[axis]);
        pitch.into_iter().flat_map(|pitch| LINES.map(|pixels| pixels * pitch))
    }

    /// The patterns of the scene; none if it has not their states.
    pub(super) fn patterns(&self) -> Vec<Pattern> {
        let states = [&self.patterns.on, &self.patterns.off].map(|state| self.number(state));
        let [Some(on), Some(off)] = states else { return Vec::new() };
        let all = self.patterns.kinds.iter().flat_map(|kind| {
            self.patterns.period_mm.iter().map(move |period| Pattern {
                kind: *kind,
                period_mm: *period,
                states: [on, off],
            })
        });
        all.collect()
    }

    /// Smallest and median contrast of the strokes of text, with the images of the room in flat faces and
    /// without.
    pub(super) fn text_contrast(&self, measured: &Measured, level: Level) -> [Option<[f64; 2]>; 2] {
        let (Some(pitch), Some(white), Some(black)) =
            (self.pitch_mm, self.number("white"), self.number("black"))
        else {
            return [None; 2];
        };
        let text = &self.patterns.text;
        let bitmap = patterns::bitmap(&self.setup.scene, text, pitch);
        let Some(bitmap) = bitmap else { return [None; 2] };
        let strokes = patterns::strokes(&measured.seen, &bitmap, pitch, [black, white], level);
        [measured.from_faces, 0.0].map(|faces| {
            let page = measured.y(white) + faces;
            let contrast = |stroke: &f64| (page - stroke - faces) / (page + stroke + faces);
            let mut all: Vec<f64> = strokes.iter().map(contrast).collect();
            all.sort_by(f64::total_cmp);
            Some([*all.first()?, all[all.len() / 2]])
        })
    }

    /// Means of the patterns of the scene in a view.
    pub(super) fn pattern_means(
        &self,
        view: &ViewPoint,
        coarse: &Measured,
        fine: &Measured,
    ) -> Vec<PatternMean> {
        let pairs = fine.patterns.iter().zip(&coarse.patterns);
        let all = self.patterns().into_iter().zip(pairs);
        let one = |(pattern, (fine_mean, coarse_mean)): (Pattern, (&f64, &f64))| PatternMean {
            theta_deg: view.theta_deg,
            phi_deg: view.phi_deg,
            kind: pattern.kind,
            period_mm: pattern.period_mm,
            mean_Y: fine_mean + fine.from_faces,
            mean_Y_via_pixel: *fine_mean,
            error: (fine_mean - coarse_mean).abs(),
        };
        all.map(one).collect()
    }

    /// Equivalent exponent of the limit of fine patterns.
    pub(super) fn yule_nielsen(&self, fine: &Measured, level: Level) -> Option<f64> {
        let states = [self.number("white")?, self.number("black")?];
        let pattern = Pattern { kind: PatternKind::Stripes, period_mm: 0.0, states };
        patterns::yule_nielsen(states.map(|state| fine.y(state)), patterns::mean(&fine.seen, pattern, level))
    }

    /// Contrast of lines, with the images of the room in flat faces and without.
    pub(super) fn line_contrast(&self, measured: &Measured, level: Level) -> [LineContrast; 2] {
        let mut contrast = [LineContrast::default(); 2];
        let (Some(white), Some(black)) = (self.number("white"), self.number("black")) else {
            return contrast;
        };
        let mut found = Vec::new();
        for axis in [0, 1] {
            for (line, surround) in [(white, black), (black, white)] {
                for width in self.lines(axis) {
                    found.push(measured.line(level, [line, surround], axis, width));
                }
            }
        }
        for (contrast, faces) in contrast.iter_mut().zip([measured.from_faces, 0.0]) {
            let of = |[middle, far]: &[f64; 2]| ((middle - far) / (middle + far + 2.0 * faces)).abs();
            contrast.all_mut().zip(&found).for_each(|(slot, pair)| *slot = Some(of(pair)));
        }
        contrast
    }
}
