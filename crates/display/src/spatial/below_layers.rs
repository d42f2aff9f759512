//! Lambertian pixels below general layers: `paper.rs` with what the layers return and show, tabulated over
//! the frequency ([`LayeredPaper`]).
//!
//! **By place.** Strips are sums of a cumulative function at [`ALONG`] places of a period of [`PERIOD`]
//! heights of the layers, cells those of a picture of twice their extent, both by fast Fourier transforms of
//! the light between the ends of each bin; rings are a Hankel series of its mean over the azimuth. A sharp
//! image is apart.

use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

use num_complex::Complex64;
use papilio_fourier::Plane;
use papilio_transport::adding::LayeredSpread;
use papilio_transport::spatial::{Cells, LambertianReturn, LayeredPaper, Peak};
use papilio_transport::{Reflector, Stack};

use super::paper::{HIGHEST, Paper, Shade};
use super::patterns::{Pattern, Text};
use super::profile::interpolated;
use super::response::{Response, name_of_light};
use super::series::Series;
use super::{Level, Refused, Seen};
use crate::DisplayError;
use crate::meter::{Meter, PixelLight};
use crate::run::Control;
use crate::setup::{Setup, ViewPoint};

/// Period of tables of places, in heights, and the number of places along an axis, at the coarser and the
/// finer level.
const PERIOD: f64 = 256.0;
const ALONG: [usize; 2] = [1 << 16, 1 << 17];

/// Parts of a cell along each axis at both levels: odd numbers.
const PARTS: [usize; 2] = [3, 5];

/// Most further frequencies of a wave of cells to either side, at both levels, and weights that do not count.
const MOST_WAVES: [f64; 2] = [3.0, 5.0];
const NEGLIGIBLE: f64 = 1e-9;

/// Period of rings, in heights.
const PERIOD_OF_RINGS: f64 = 128.0;

/// Width of the sharpest feature in periods of the frequency at which half of the light is left.
const HALF: f64 = 0.15;

/// Layers that have no height are taken as so high, mm.
const LEAST_HEIGHT_MM: f64 = 1e-9;

/// Sharp images fainter than this do not count.
const FAINTEST: f64 = 1e-6;

/// Whether the layers above the pixels, and the pixels, are those of this module.
pub(super) fn covers(setup: &Setup) -> bool {
    let is_paper = matches!(setup.stack.base().reflector, Reflector::Lambertian(_));
    setup.stack.panel().is_none() && is_paper && setup.scene.display.pixel_spread().is_none()
}

/// Lambertian pixels below general layers, in one view.
pub(super) struct Layers {
    table: Arc<LayeredPaper>,
    pub(super) height_mm: f64,
    /// Number of wavelengths.
    pub(super) bins: usize,
    pub(super) level: Level,
}

impl Layers {
    /// Prepares a level.
    ///
    /// # Errors
    /// If pixels or layers are not covered, a thickness is missing, or the computation was stopped.
    pub(super) fn new(
        setup: &Setup,
        view: &ViewPoint,
        level: Level,
        control: &Control<'_>,
    ) -> Result<Self, DisplayError> {
        if !covers(setup) {
            return Err(Refused::Layers.into());
        }
        let (stack, number) = (setup.placed()?, level.of_layers());
        let height_mm = stack.thickness_mm().max(LEAST_HEIGHT_MM);
        let spread = LayeredSpread::new(stack, view.field, &setup.sources, number, control.stop)
            .map_err(Refused::Layered)?;
        let is_round = view.theta_deg == 0.0;
        let table = LayeredPaper::new(&spread, is_round, height_mm, number).map_err(Refused::Layered)?;
        Ok(Self { table: Arc::new(table), height_mm, bins: stack.base().bins(), level })
    }

    /// What returns to the pixels, by group of wavelengths.
    pub(super) fn returns(&self) -> Vec<LambertianReturn> {
        self.table.returns()
    }

    /// Thickness of a layer that returns light from as far. Return that ends at a higher frequency is that of
    /// a thinner one.
    pub(super) fn thickness_mm(&self) -> f64 {
        self.height_mm.min(HIGHEST / self.table.end_per_mm())
    }

    /// How much the light of each cell of a period counts in the mean of what the view sees at some cells, at
    /// a group of wavelengths.
    pub(super) fn seen_from(&self, group: usize, cells: Cells, seen: &[usize]) -> Vec<f64> {
        let rows = cells.count[1];
        let each = 1.0 / seen.len() as f64;
        let mut mean = vec![Complex64::ZERO; cells.len()];
        seen.iter().for_each(|cell| mean[*cell] = each.into());
        let plane = Plane::new(cells.count);
        let mut spectrum = plane.forward(mean.clone());
        let [along_x, along_y] = [0, 1].map(|axis| self.waves(axis, cells));
        for (column, x) in along_x.iter().enumerate() {
            for (row, y) in along_y.iter().enumerate() {
                let both = x.iter().flat_map(|x| y.iter().map(move |y| (x, y)));
                let sum: Complex64 =
                    both.map(|(x, y)| x.1 * y.1 * self.table.others(group, [x.0, y.0])).sum();
                // From the place that is seen back to where light comes from.
                spectrum[column * rows + row] *= sum.conj() / cells.len() as f64;
            }
        }
        let sharp = self.table.sharp(group);
        let others = plane.inverse(spectrum).into_iter().zip(mean);
        others.map(|(light, mean)| light.re + sharp * mean.re).collect()
    }

    /// Frequencies that each wave of the cells along an axis has, and how much each counts: light of cells, and
    /// means over cells, have further ones than those of the transform.
    fn waves(&self, axis: usize, cells: Cells) -> Vec<Vec<(f64, f64)>> {
        let (count, period_mm) = (cells.count[axis], cells.period_mm[axis]);
        let per_mm = count as f64 / period_mm;
        let most = MOST_WAVES[usize::from(self.level.is_fine)];
        let further = (self.table.reach_per_mm() / per_mm + 0.5).ceil().clamp(1.0, most) as i32;
        let of_wave = |k: usize| {
            let wave = if 2 * k < count { k as f64 } else { k as f64 - count as f64 };
            let part = |m: i32| wave / count as f64 + f64::from(m);
            let mut waves: Vec<(f64, f64)> =
                (-further..=further).map(|m| (part(m) * per_mm, sinc(part(m)).powi(2))).collect();
            // All beyond are like the last ones.
            let rest = 1.0 - waves.iter().map(|(_, weight)| weight).sum::<f64>();
            for end in [0, 2 * further as usize] {
                waves[end].1 += 0.5 * rest;
            }
            waves.retain(|(_, weight)| weight.abs() > NEGLIGIBLE);
            waves
        };
        (0..count).map(of_wave).collect()
    }

    /// Point spread between pixels at each group of wavelengths: light of a pixel that is seen in the middle
    /// of each pixel around it, up to `reach` pixels away, by rows from the bottom.
    pub(super) fn of_pixels(&self, pitch_mm: [f64; 2], reach: usize) -> Vec<Vec<f64>> {
        let edges = |axis: usize| -> Vec<f64> {
            (0..2 * reach + 2).map(|k| (k as f64 - reach as f64 - 0.5) * pitch_mm[axis]).collect()
        };
        let groups = self.table.groups();
        let own = |group: usize| (0..groups).map(|other| f64::from(u8::from(other == group))).collect();
        self.once((0..groups).map(own).collect()).cells(&edges(0), &edges(1))
    }

    /// Light that meets the pixels once, `[state][group]`.
    fn once(&self, light: Vec<Vec<f64>>) -> Once {
        let Self { table, height_mm, level, .. } = self;
        Once {
            light,
            table: Arc::clone(table),
            height_mm: *height_mm,
            is_fine: level.is_fine,
            lines: Default::default(),
        }
    }
}

/// Responses of a view to all lights with an illuminance, and Y of the images of the lights in flat faces.
pub(super) fn responses(
    setup: &Setup,
    view: &ViewPoint,
    level: Level,
    control: &Control<'_>,
) -> Result<(Vec<Seen>, f64), DisplayError> {
    let layers = Layers::new(setup, view, level, control)?;
    let (meter, factors) = (Meter::new(setup), setup.seen(view, level.of_layers(), control)?);
    let mut all = Vec::new();
    for light in meter.pixel_lights().into_iter().filter(PixelLight::is_seen) {
        let (weights, via_pixel) = (&light.weights[1], &factors[light.source].via_pixel);
        let response = BelowLayers::new(&setup.stack, &layers, (weights, via_pixel));
        all.push(Seen { light: name_of_light(setup, &light), response: Box::new(response) });
    }
    Ok((all, meter.without_pixel(&factors)[1]))
}

/// What a view sees of the pixels in one light, through all orders.
struct BelowLayers {
    paper: Paper,
    table: Arc<LayeredPaper>,
    /// Light of equal reflectances, `[state]`; a group of wavelengths is a face of `paper`.
    shades: Vec<Vec<Shade>>,
}

impl BelowLayers {
    fn new(stack: &Stack, layers: &Layers, (weights, via_pixel): (&[f64], &[f64])) -> Self {
        let (states, bins) = (stack.base().states(), weights.len());
        let mut reflectance = vec![0.0; states * bins];
        if let Some(layer) = stack.layers().last() {
            stack.base().reflectance(0.0, &layer.medium, &mut reflectance);
        }
        let light: Vec<f64> = (0..states * bins).map(|at| weights[at % bins] * via_pixel[at]).collect();
        let table = &layers.table;
        let of_group = |state: usize, group: usize| -> f64 {
            table.bins(group).iter().map(|bin| light[state * bins + bin]).sum()
        };
        let groups = 0..table.groups();
        let of_state = |state: usize| groups.clone().map(|group| of_group(state, group)).collect();
        let once = layers.once((0..states).map(of_state).collect());
        let lengths_mm = [layers.thickness_mm(), layers.height_mm];
        let paper =
            Paper::new(layers.returns(), lengths_mm, [reflectance, light], bins).below(Box::new(once));
        let paper = paper.with_images(vec![([0.0; 2], vec![1.0; bins])]);
        let shades = (0..states).map(|state| paper.shades_of(state, &vec![1.0; bins])).collect();
        Self { paper, table: Arc::clone(table), shades }
    }
}

impl Response for BelowLayers {
    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        let of_face = |(face, returned): (usize, [f64; 2])| {
            (seen(&self.table, face, along(axis, frequency_per_mm)), returned)
        };
        let faces: Vec<_> =
            self.paper.returned(frequency_per_mm).into_iter().enumerate().map(of_face).collect();
        let of_shade = |shade: &Shade| {
            let (seen, [zero, returned]) = faces[shade.face];
            shade.light * (1.0 - shade.reflectance * zero) / (1.0 - shade.reflectance * returned) * seen
        };
        self.shades.iter().map(|shades| shades.iter().map(of_shade).sum()).collect()
    }

    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        self.paper.strips(axis, edges_mm)
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        self.paper.rings(radii_mm)
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        self.paper.cells(x_mm, y_mm)
    }

    fn line(&self, states: [usize; 2], axis: usize, width_mm: f64, level: Level) -> Option<f64> {
        self.paper.line(states, axis, width_mm, level)
    }

    fn pattern_mean(&self, pattern: Pattern, level: Level) -> Option<f64> {
        self.paper.pattern_mean(pattern, level)
    }

    fn text(&self, text: &Text<'_>, states: [usize; 2], level: Level) -> Option<Vec<f64>> {
        self.paper.text(text, states, level)
    }

    fn images(&self) -> Vec<[f64; 2]> {
        self.paper.images()
    }

    fn peaks(&self) -> Vec<Peak> {
        self.paper.peaks()
    }
}

/// A frequency along an axis.
fn along(axis: usize, frequency_per_mm: f64) -> [f64; 2] {
    if axis == 0 { [frequency_per_mm, 0.0] } else { [0.0, frequency_per_mm] }
}

/// Light of a group of wavelengths at a frequency over that at frequency 0.
fn seen(table: &LayeredPaper, group: usize, frequency_per_mm: [f64; 2]) -> Complex64 {
    table.others(group, frequency_per_mm) + table.sharp(group)
}

/// What a view sees of light that meets the pixels once. It has all light, `light`, of each state and group
/// of wavelengths.
struct Once {
    light: Vec<Vec<f64>>,
    table: Arc<LayeredPaper>,
    height_mm: f64,
    is_fine: bool,
    /// Cumulative light at the ends of bins along each axis, `[state]`.
    lines: [OnceLock<Vec<Vec<f64>>>; 2],
}

impl Once {
    /// Light of each state, given that of each group.
    fn by_state(&self, of_group: impl Fn(usize) -> Complex64) -> Vec<Complex64> {
        let groups: Vec<Complex64> = (0..self.table.groups()).map(of_group).collect();
        let sum = |light: &Vec<f64>| light.iter().zip(&groups).map(|(light, value)| light * value).sum();
        self.light.iter().map(sum).collect()
    }

    /// All light but the sharp image at a frequency, `[state]`.
    fn others(&self, frequency_per_mm: [f64; 2]) -> Vec<Complex64> {
        self.by_state(|group| self.table.others(group, frequency_per_mm))
    }

    /// Sharp image of each state.
    fn sharp(&self) -> Vec<f64> {
        self.by_state(|group| self.table.sharp(group).into()).iter().map(|light| light.re).collect()
    }

    fn period_mm(&self) -> f64 {
        PERIOD * self.height_mm
    }

    /// Light below the ends of bins, without the sharp image, from half a period below the view's own ray on.
    fn lines(&self, axis: usize) -> &[Vec<f64>] {
        self.lines[axis].get_or_init(|| {
            let count = ALONG[usize::from(self.is_fine)];
            let at = |k: usize| {
                // The first bin begins at half a period below 0: its middle.
                let shift = PI * k as f64 * (1.0 / count as f64 - 1.0);
                let factor = sinc(k as f64 / count as f64) / count as f64;
                let factor = Complex64::from_polar(factor, shift);
                let values = self.others(along(axis, k as f64 / self.period_mm()));
                values.into_iter().map(|value| factor * value).collect()
            };
            let half: Vec<Vec<Complex64>> = (0..count / 2).map(at).collect();
            let plane = Plane::new([count, 1]);
            let of_state = |state: usize| {
                let mut spectrum = vec![Complex64::ZERO; count];
                for (k, values) in half.iter().enumerate() {
                    spectrum[k] = values[state];
                    if k > 0 {
                        spectrum[count - k] = values[state].conj();
                    }
                }
                let mut sum = 0.0;
                let bins = plane.inverse(spectrum).into_iter().map(|light| {
                    sum += light.re;
                    sum
                });
                std::iter::once(0.0).chain(bins).collect()
            };
            (0..self.light.len()).map(of_state).collect()
        })
    }

    /// Light of a state below a place.
    fn below(&self, axis: usize, state: usize, at_mm: f64) -> f64 {
        let table = &self.lines(axis)[state];
        let last = table.len() - 1;
        let place = (at_mm / self.period_mm() + 0.5) * last as f64;
        if place <= 0.0 {
            return 0.0;
        }
        let first = place.floor() as usize;
        if first + 1 > last {
            return table[last];
        }
        let (from, to) = (first.saturating_sub(1), (first + 3).min(last + 1));
        let places: Vec<f64> = (from..to).map(|k| k as f64).collect();
        interpolated(&places, &table[from..to], place)
    }
}

impl Response for Once {
    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        self.by_state(|group| seen(&self.table, group, along(axis, frequency_per_mm)))
    }

    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        let (sharp, total) = (self.sharp(), self.transfer(axis, 0.0));
        let of_state = |state: usize| {
            let step = |at: f64| if at == 0.0 { 0.5 } else { f64::from(u8::from(at > 0.0)) };
            let below = edges_mm.iter().map(|at| sharp[state] * step(*at) + self.below(axis, state, *at));
            let mut last = 0.0;
            let bin = |now: f64| now - std::mem::replace(&mut last, now);
            below.chain([total[state].re]).map(bin).collect()
        };
        (0..self.light.len()).map(of_state).collect()
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        let step_per_mm = 1.0 / (PERIOD_OF_RINGS * self.height_mm);
        let mut rest: Vec<Vec<f64>> = vec![Vec::new(); self.light.len()];
        let azimuths = 4;
        let zero = self.transfer(0, 0.0);
        for k in 0..ALONG[0] {
            let mut most = 0.0_f64;
            let mut mean = vec![0.0; self.light.len()];
            for turn in 0..azimuths {
                let (sin, cos) = (PI * f64::from(turn) / f64::from(azimuths)).sin_cos();
                let values = self.others([cos, sin].map(|part| k as f64 * step_per_mm * part));
                for ((mean, value), zero) in mean.iter_mut().zip(values).zip(&zero) {
                    *mean += value.re / f64::from(azimuths);
                    most = most.max(value.norm() / zero.re.max(f64::MIN_POSITIVE));
                }
            }
            rest.iter_mut().zip(mean).for_each(|(rest, mean)| rest.push(mean));
            if most < FAINTEST {
                break;
            }
        }
        Series { step_per_mm, sharp: self.sharp(), rest, at_mm: [0.0; 2], inside: None }.rings(radii_mm)
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        let edges = [x_mm, y_mm];
        let parts = PARTS[usize::from(self.is_fine)];
        let cells = edges.map(|edges| edges.len() - 1);
        let width = [0, 1].map(|k| (edges[k][cells[k]] - edges[k][0]) / cells[k] as f64 / parts as f64);
        let count = cells.map(|cells| 2 * parts * cells);
        let wave = |axis: usize, k: usize| {
            let half = count[axis] / 2;
            let k = if k < half { k as f64 } else { k as f64 - count[axis] as f64 };
            k / (count[axis] as f64 * width[axis])
        };
        let mut spectra = vec![vec![Complex64::ZERO; count[0] * count[1]]; self.light.len()];
        for column in 0..count[0] {
            for row in 0..count[1] {
                let f = [wave(0, column), wave(1, row)];
                // The middle of the first part of the first cell is the first cell of the plane.
                let turn: f64 = (0..2).map(|k| 2.0 * PI * f[k] * (edges[k][0] + 0.5 * width[k])).sum();
                let factor: f64 = (0..2).map(|k| sinc(f[k] * width[k]) / count[k] as f64).product();
                let factor = Complex64::from_polar(factor, turn);
                let values = self.others(f);
                for (spectrum, value) in spectra.iter_mut().zip(values) {
                    spectrum[column * count[1] + row] = factor * value;
                }
            }
        }
        let plane = Plane::new(count);
        let sharp = self.sharp();
        let of_state = |(spectrum, sharp): (Vec<Complex64>, f64)| {
            let light = plane.inverse(spectrum);
            let mut sums = vec![0.0; cells[0] * cells[1]];
            for (number, sum) in sums.iter_mut().enumerate() {
                let [column, row] = [number % cells[0], number / cells[0]];
                for (i, j) in (0..parts * parts).map(|k| (k % parts, k / parts)) {
                    *sum += light[(row * parts + j) * count[0] + column * parts + i].re;
                }
                let holds = |axis: usize, k: usize| (edges[axis][k]..edges[axis][k + 1]).contains(&0.0);
                if holds(0, column) && holds(1, row) {
                    *sum += sharp;
                }
            }
            sums
        };
        spectra.into_iter().zip(sharp).map(of_state).collect()
    }

    fn images(&self) -> Vec<[f64; 2]> {
        let brightest = self.sharp().into_iter().zip(self.transfer(0, 0.0));
        let is_sharp = brightest.into_iter().any(|(sharp, all)| sharp > FAINTEST * all.re);
        if is_sharp { vec![[0.0; 2]] } else { Vec::new() }
    }

    fn peaks(&self) -> Vec<Peak> {
        let half = self.table.half_of_scattered_per_mm();
        let width_mm = half.map_or(0.05 * self.height_mm, |half| HALF / half);
        vec![Peak { at_mm: [0.0; 2], width_mm: width_mm.clamp(1e-4 * self.height_mm, self.height_mm) }]
    }
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) }
}
