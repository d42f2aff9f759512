//! A diffuser over any pixel, to first order: the weights of the pixel's angular table with a place each.

use std::sync::{Arc, OnceLock};

use num_complex::Complex64;
use papilio_transport::Source;
use papilio_transport::spatial::{Accuracy, Binned, LineSpread, PanelSpread, Part, Peak, PointSpread};

use super::Response;
use super::curve::Curves;
use super::response::{Lit, not_computed};
use crate::DisplayError;

/// Response in Y.
pub(super) fn response(lit: Lit<'_>, source: &Source, weights: &[f64]) -> Result<LobeResponse, DisplayError> {
    of_quantities(lit, source, &[weights])
}

/// Response in several quantities, each with its weights over wavelength: `[quantity][state]`, as if they
/// were more states.
pub(super) fn of_quantities<W: AsRef<[f64]>>(
    lit: Lit<'_>,
    source: &Source,
    weights: &[W],
) -> Result<LobeResponse, DisplayError> {
    let Lit { panel, view, level, .. } = lit;
    let accuracy = Accuracy { digits: level.digits, most_per_mm: level.most_per_mm };
    // What the front returns is not a part of the spread; its transmittance is.
    let mut alone = panel.clone();
    alone.front.reflectance_below = vec![0.0; panel.base.bins()].into();
    let spread = PanelSpread::new(&alone, &view.field, source, accuracy).map_err(not_computed)?;
    let of_part = |part: &Part| {
        let passed = |weights: &W| -> Vec<f64> {
            weights.as_ref().iter().zip(&*part.through).map(|(weight, t)| weight * t).collect()
        };
        let passed: Vec<Vec<f64>> = weights.iter().map(passed).collect();
        Arc::new(Curves::of_quantities(&panel.base, &panel.medium, part.index(), &passed))
    };
    let parts = spread.parts();
    let mut curves: Vec<Arc<Curves>> = Vec::with_capacity(parts.len());
    for (number, part) in parts.iter().enumerate() {
        let known = number.checked_sub(1).filter(|before| parts[*before].is_weighted_like(part));
        curves.push(known.map_or_else(|| of_part(part), |before| Arc::clone(&curves[before])));
    }
    let total =
        |part: &Part| weights[0].as_ref().iter().zip(&*part.through).map(|(weight, t)| weight * t).sum();
    Ok(LobeResponse {
        light: parts.iter().map(total).collect(),
        spread,
        curves,
        states: panel.base.states() * weights.len(),
        lines: Default::default(),
    })
}

/// What a view sees of the light that meets the pixel once.
pub(super) struct LobeResponse {
    spread: PanelSpread,
    /// Y of the light of each part of the spread.
    curves: Vec<Arc<Curves>>,
    /// Light of each part from pixels that reflect everything, in the first quantity.
    light: Vec<f64>,
    states: usize,
    /// Light along each axis, by part.
    lines: [OnceLock<Vec<LineSpread>>; 2],
}

/// A part of the light.
pub(super) struct Brightest<'a> {
    /// Index of the glass.
    pub(super) index: f64,
    curves: &'a Curves,
    light: f64,
}

impl Brightest<'_> {
    /// Writes the mean reflectance of each state at `|beta|^2` in this light.
    pub(super) fn reflectance(&self, beta_squared: f64, y: &mut [f64]) {
        self.curves.at(beta_squared, y);
        y.iter_mut().for_each(|y| *y /= self.light);
    }
}

impl LobeResponse {
    /// Light along an axis, by part.
    fn lines(&self, axis: usize) -> &[LineSpread] {
        let parts = self.spread.parts();
        let all = || {
            let mut lines: Vec<LineSpread> = Vec::with_capacity(parts.len());
            for (number, (part, curves)) in parts.iter().zip(&self.curves).enumerate() {
                // The same light, farther away, is computed once.
                let known = (0..number).find_map(|other| Some((other, part.moved_from(&parts[other])?)));
                lines.push(match known {
                    Some((other, (by_mm, factor))) => lines[other].moved(by_mm[axis], factor),
                    None => {
                        let points = self.spread.point_spread(part);
                        LineSpread::new(&points, axis, self.states, |beta_squared, y| {
                            curves.at(beta_squared, y);
                        })
                    }
                });
            }
            lines
        };
        self.lines[axis].get_or_init(all)
    }

    /// The brightest part; `None` without light.
    pub(super) fn brightest(&self) -> Option<Brightest<'_>> {
        let (number, light) = self.light.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        let (index, curves) = (self.spread.parts()[number].index(), &*self.curves[number]);
        (*light > 0.0).then_some(Brightest { index, curves, light: *light })
    }

    /// Sums what each part has in bins, `[state][bin]`.
    fn by_state(&self, binned: impl Fn(&PointSpread<'_>) -> Binned) -> Vec<Vec<f64>> {
        let mut sums: Vec<Vec<f64>> = Vec::new();
        for (points, curves) in self.points().zip(&self.curves) {
            let bins = binned(&points).sums_of(self.states, |beta_squared, y| curves.at(beta_squared, y));
            if sums.is_empty() {
                sums = bins;
                continue;
            }
            for (sums, bins) in sums.iter_mut().zip(bins) {
                sums.iter_mut().zip(bins).for_each(|(sum, value)| *sum += value);
            }
        }
        sums
    }

    /// Light of rectangles (borders along x and y, mm), `[state][rectangle]`.
    pub(super) fn rectangles(&self, rectangles: &[[[f64; 2]; 2]]) -> Vec<Vec<f64>> {
        self.by_state(|points| points.rectangles(rectangles))
    }

    /// Peaks of the light, and sharp images.
    pub(super) fn all_peaks(&self) -> Vec<Peak> {
        let sharp = Response::images(self).into_iter().map(|at_mm| Peak { at_mm, width_mm: 0.0 });
        Response::peaks(self).into_iter().chain(sharp).collect()
    }

    fn points(&self) -> impl Iterator<Item = PointSpread<'_>> {
        self.spread.parts().iter().map(|part| self.spread.point_spread(part))
    }
}

impl Response for LobeResponse {
    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        let mut sums = vec![Complex64::ZERO; self.states];
        self.lines(axis).iter().for_each(|line| line.add_transfer(frequency_per_mm, &mut sums));
        sums
    }

    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        let mut bins: Vec<Vec<f64>> = vec![Vec::with_capacity(edges_mm.len() + 1); self.states];
        let mut last = vec![0.0; self.states];
        for edge in edges_mm.iter().copied().chain([f64::INFINITY]) {
            let mut below = vec![0.0; self.states];
            self.lines(axis).iter().for_each(|line| line.add_below(edge, &mut below));
            for (state, bins) in bins.iter_mut().enumerate() {
                bins.push(below[state] - last[state]);
            }
            last = below;
        }
        bins
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        self.by_state(|points| points.rings(radii_mm))
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        self.by_state(|points| points.cells(x_mm, y_mm))
    }

    fn images(&self) -> Vec<[f64; 2]> {
        self.points().flat_map(|points| points.images().to_vec()).map(|image| image.at_mm).collect()
    }

    fn peaks(&self) -> Vec<Peak> {
        self.points().flat_map(|points| points.peaks().to_vec()).collect()
    }
}
