//! Sharpness at one level of discretisation.

use std::cell::OnceCell;

use num_complex::Complex64;

use super::mtf::Frame;
use super::patterns;
use super::profile::{PER_SIDE, cumulative, density, places, radii};
use super::response::responses;
use super::{Level, Seen, SpreadTable};
use crate::DisplayError;
use crate::metrics::LineContrast;
use crate::setup::ViewPoint;

/// Extent of tables of places, in thicknesses.
const EXTENT: f64 = 20.0;

/// Distance from a sharp image, in thicknesses, within which a table has all of its light.
const SHARP: f64 = 1e-6;

/// Borders between places, mm: of strips, `[axis]`, and of rings.
#[derive(Debug, Clone)]
pub(super) struct Borders {
    places: [Vec<f64>; 2],
    radii: Vec<f64>,
}

/// Light of one state by frequency and place, from one light or all.
pub(super) struct Light {
    /// `[axis][frequency]`; those beyond the frame's frequencies serve `f50`.
    pub(super) transfer: [Vec<Complex64>; 2],
    /// `[axis][bin]`.
    pub(super) strips: [Vec<f64>; 2],
    pub(super) rings: Vec<f64>,
}

impl Light {
    /// Modulation transfer along an axis.
    pub(super) fn modulus(&self, axis: usize) -> Vec<f64> {
        let zero = self.transfer[axis][0].norm();
        self.transfer[axis].iter().map(|value| value.norm() / zero).collect()
    }

    /// The same light times a factor.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        let scaled = |values: &Vec<f64>| values.iter().map(|value| factor * value).collect();
        Self {
            transfer: self.transfer.each_ref().map(|all| all.iter().map(|value| factor * value).collect()),
            strips: self.strips.each_ref().map(scaled),
            rings: scaled(&self.rings),
        }
    }
}

/// Everything that is computed at one level.
pub(super) struct Measured {
    pub(super) names: Vec<String>,
    pub(super) frequencies: Vec<f64>,
    /// Borders of strips, mm, `[axis]`, and of rings.
    pub(super) places: [Vec<f64>; 2],
    pub(super) radii: Vec<f64>,
    /// `[state][light]`, the last light being all.
    pub(super) lights: Vec<Vec<Light>>,
    pub(super) line_contrast: [LineContrast; 2],
    /// Smallest and median contrast of text.
    pub(super) text_contrast: [Option<[f64; 2]>; 2],
    /// Mean of each pattern via the pixel.
    pub(super) patterns: Vec<f64>,
    pub(super) from_faces: f64,
    pub(super) seen: Vec<Seen>,
}

impl Frame<'_> {
    /// Returns the borders between the places of tables.
    fn borders(&self, seen: &[Seen]) -> Borders {
        let extent = EXTENT * self.thickness_mm;
        let peaks: Vec<_> = seen.iter().flat_map(|seen| seen.response.peaks()).collect();
        let images: Vec<[f64; 2]> = seen.iter().flat_map(|seen| seen.response.images()).collect();
        let along = |axis: usize| {
            let halves = self.lines(axis).flat_map(|width| [-0.5 * width, 0.5 * width]);
            // A table resolves a sharp image by places close to it.
            let sharp =
                images.iter().flat_map(|at| [-SHARP, SHARP].map(|side| at[axis] + side * self.thickness_mm));
            places((&peaks, PER_SIDE), axis, extent, &halves.chain(sharp).collect::<Vec<_>>())
        };
        let radii = radii((&peaks, PER_SIDE), extent, &images, SHARP * self.thickness_mm);
        Borders { places: [along(0), along(1)], radii }
    }

    /// Computes all that a view sees at one level. The first level finds the borders for all of them.
    pub(super) fn measure(
        &self,
        view: &ViewPoint,
        level: Level,
        borders: &OnceCell<Borders>,
    ) -> Result<Measured, DisplayError> {
        let mut measured = self.by_frequency(view, level)?;
        let Borders { places, radii } = borders.get_or_init(|| self.borders(&measured.seen)).clone();
        for (number, Seen { response, .. }) in measured.seen.iter().enumerate() {
            self.control.check()?;
            let strips = [0, 1].map(|axis| response.strips(axis, &places[axis]));
            let rings = response.rings(&radii);
            for (state, lights) in measured.lights.iter_mut().enumerate() {
                lights[number].strips = [0, 1].map(|axis| strips[axis][state].clone());
                lights[number].rings.clone_from(&rings[state]);
            }
        }
        for lights in &mut measured.lights {
            lights.pop();
            let all = sum(lights);
            lights.extend(all);
        }
        (measured.places, measured.radii) = (places, radii);
        self.control.check()?;
        measured.line_contrast = self.line_contrast(&measured, level);
        self.control.check()?;
        measured.text_contrast = self.text_contrast(&measured, level);
        measured.patterns =
            self.patterns().iter().map(|pattern| patterns::mean(&measured.seen, *pattern, level)).collect();
        Ok(measured)
    }

    /// Computes what a view sees by frequency alone.
    pub(super) fn by_frequency(&self, view: &ViewPoint, level: Level) -> Result<Measured, DisplayError> {
        let (seen, from_faces) = responses(self.setup, view, level, self.control)?;
        let mut frequencies = self.frequencies.clone();
        while let Some(last) = frequencies.last().filter(|last| **last < level.most_per_mm) {
            frequencies.push(last * 1.12);
        }
        frequencies.truncate(frequencies.partition_point(|f| *f <= level.most_per_mm));
        let mut lights: Vec<Vec<Light>> = self.setup.states.iter().map(|_| Vec::new()).collect();
        for Seen { response, .. } in &seen {
            self.control.check()?;
            let transfers = [0, 1].map(|axis| -> Vec<Vec<Complex64>> {
                frequencies.iter().map(|f| response.transfer(axis, *f)).collect()
            });
            for (state, lights) in lights.iter_mut().enumerate() {
                lights.push(Light {
                    transfer: [0, 1].map(|axis| transfers[axis].iter().map(|all| all[state]).collect()),
                    strips: Default::default(),
                    rings: Vec::new(),
                });
            }
        }
        for lights in &mut lights {
            let all = sum(lights);
            lights.extend(all);
        }
        let names = seen.iter().map(|seen| seen.light.clone()).chain(["all".to_owned()]).collect();
        Ok(Measured {
            names,
            frequencies,
            places: Default::default(),
            radii: Vec::new(),
            lights,
            line_contrast: [LineContrast::default(); 2],
            text_contrast: [None; 2],
            patterns: Vec::new(),
            from_faces,
            seen,
        })
    }
}

impl Measured {
    /// Y of a state via the pixel.
    pub(super) fn y(&self, state: usize) -> f64 {
        self.lights[state].last().map_or(0.0, |all| all.transfer[0][0].re)
    }

    /// Y of the middle of a line of one state on another, and far away, via the pixel.
    pub(super) fn line(
        &self,
        level: Level,
        [line, surround]: [usize; 2],
        axis: usize,
        width_mm: f64,
    ) -> [f64; 2] {
        let far = self.y(surround);
        let all_orders: Option<Vec<f64>> = self
            .seen
            .iter()
            .map(|seen| seen.response.line([line, surround], axis, width_mm, level))
            .collect();
        if let Some(found) = all_orders {
            return [found.iter().sum(), far];
        }
        let inside = |state: usize| -> f64 {
            let Some(all) = self.lights[state].last() else { return 0.0 };
            let places = &self.places[axis];
            let bin = |at: f64| places.partition_point(|place| *place <= at);
            // A line that is narrower than rounding covers nothing.
            let covered = bin(-0.5 * width_mm)..bin(0.5 * width_mm - 1e-12) + 1;
            all.strips[axis].get(covered).map_or(0.0, |strips| strips.iter().sum())
        };
        [far - inside(surround) + inside(line), far]
    }

    /// Line and edge spread of a state along an axis in one light.
    pub(super) fn table(&self, coarse: &Self, state: usize, light: usize, axis: usize) -> SpreadTable {
        let strips = |level: &Self| level.lights[state][light].strips[axis].clone();
        let places = &self.places[axis];
        let (edge, other) = (cumulative(&strips(self)), cumulative(&strips(coarse)));
        SpreadTable {
            light: self.names[light].clone(),
            axis,
            position_um: places.iter().map(|place| 1e3 * place).collect(),
            line_spread_per_mm: density(places, &strips(self)),
            error: edge.iter().zip(&other).map(|(a, b)| (a - b).abs()).collect(),
            edge_spread: edge,
        }
    }
}

/// Sum over lights; `None` without light.
pub(super) fn sum(lights: &[Light]) -> Option<Light> {
    let first = lights.first()?;
    let add = |sum: &mut [f64], more: &[f64]| sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
    let mut all =
        Light { transfer: first.transfer.clone(), strips: first.strips.clone(), rings: first.rings.clone() };
    for light in &lights[1..] {
        for axis in [0, 1] {
            let transfer = all.transfer[axis].iter_mut().zip(&light.transfer[axis]);
            transfer.for_each(|(sum, more)| *sum += more);
            add(&mut all.strips[axis], &light.strips[axis]);
        }
        add(&mut all.rings, &light.rings);
    }
    Some(all)
}
