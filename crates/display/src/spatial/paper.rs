//! Lambertian pixels under a flat face or a diffuser: what a view sees of them to first order, sharp or
//! through the lobe, and around it light that the face, and a front of screen above it, return to them.
//!
//! **What.** A small signal about a state of reflectance rho, of the same relative size at all wavelengths,
//! has the transfer `(1 - rho A(0))/(1 - rho A(f))` with the return A of the layers above
//! ([`LambertianReturn`]). The constant `1 - rho A(0)` is the sharp image; the rest is spread over many
//! thicknesses of the glass. Wavelengths count by their response to the signal, `Y/(1 - rho A(0))`. Direction
//! and kind of the light do not matter: it arrives uniformly. A diffuser spreads what is seen of both
//! (`lobe.rs`).
//!
//! In an oblique view, light that has been reflected between face and front is seen from another place: a
//! second image, with its own surroundings, shifted by twice the way through the air.
//!
//! Light that spreads inside the pixels ([`PixelSpread`]), with the transform P, has the transfer
//! `(1 + P)/2 (1 - rho A(0))/(1 - rho P A(f))`: half of the light is sharp, the other half has the point
//! spread of the pixel.
//!
//! Places come from frequencies by Fourier and Hankel series with a period of [`PERIOD`] thicknesses.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_transport::spatial::{
    Cells, FrontWay, LambertianReturn, Peak, PixelSpread, Recycling, displacement,
};
use papilio_transport::{Panel, Source, Top};

use super::bounds::{cells_across, cells_along, parts_of_pixels};
use super::irradiance::{PlacedImage, images, images_of_field};
use super::lobe;
use super::patterns::{Pattern, PatternKind, Text};
use super::response::Lit;
use super::series::{Series, add};
use super::{Level, Response};
use crate::DisplayError;

/// Period of the series, in reaches: light beyond half of it is below 3e-5 of all.
const PERIOD: f64 = 400.0;

/// Highest frequency of the series times the thickness. |A| decreases to 1e-5 there.
pub(super) const HIGHEST: f64 = 16.0;

/// Below this fraction, what a lobe leaves of the series is neglected.
const FAINTEST: f64 = 1e-5;

/// Images that are fainter than this fraction of the pixels at their own place are not resolved by tables of places.
const FAINT_IMAGE: f64 = 1e-3;

/// Most frequencies of the series: glass much thinner than the air below a front returns light to the same
/// place.
const MOST_FREQUENCIES: f64 = 131_072.0;

/// Period of lines, in reaches.
const LINE_PERIOD: f64 = 64.0;

/// Most pixels of a text that are divided into cells even if they are smaller than cells need to be.
const MANY_PIXELS: usize = 1 << 15;

/// Tolerance of the irradiance of patterns.
const TOLERANCE: f64 = 1e-9;

pub(super) struct Paper {
    /// Layers above the pixels that scatter.
    pub(super) lobe: Option<Lobe>,
    pub(super) thickness_mm: f64,
    /// How far light spreads that is returned: the thickness, or a part of a large distance to the front.
    pub(super) reach_mm: f64,
    pub(super) faces: Vec<LambertianReturn>,
    /// Spread inside the pixels; not below layers that scatter.
    pub(super) spread: Option<PixelSpread>,
    /// Reflectance of the paper, `[state][wavelength]`.
    reflectance: Vec<f64>,
    /// Light of a page by wavelength, and as the wavelengths count in the transfer of a small signal, with the same sum;
    /// `[state][wavelength]`.
    light: Vec<f64>,
    responding: Vec<f64>,
    bins: usize,
    images: Vec<Image>,
}

/// What a view sees through layers that scatter of light that meets the pixels once.
pub(super) struct Lobe {
    once: Box<dyn Response>,
    /// Y, `[state]`.
    y: Vec<f64>,
    /// What goes its own way through the front, and the images of all ways; `None` without further ways.
    by_ways: Option<(Box<Self>, Vec<PlacedImage>)>,
}

/// Image of the pixels, with the light that is returned to them.
struct Image {
    at_mm: [f64; 2],
    /// Fraction of the light at each wavelength.
    fraction: Vec<f64>,
    /// Light of equal reflectances, `[state]`.
    shades: Vec<Vec<Shade>>,
    /// Light of the sharp image that a diffuser spreads, `[state]`; otherwise it belongs to the series.
    sharp: Vec<f64>,
    /// All other light, of each way through the front: by places along x, along y, and in the plane, where these differ.
    series: Vec<Vec<Series>>,
}

/// Light of the wavelengths at which a state has the same reflectance under the same face, as they count in
/// the transfer.
pub(super) struct Shade {
    pub(super) face: usize,
    pub(super) reflectance: f64,
    pub(super) light: f64,
}

pub(super) fn response(
    lit: Lit<'_>,
    source: &Source,
    (weights, via_pixel): (&[f64], &[f64]),
    known: &mut Option<Vec<LambertianReturn>>,
) -> Result<Paper, DisplayError> {
    let Lit { panel, level, .. } = lit;
    let (states, bins) = (panel.base.states(), weights.len());
    let mut reflectance = vec![0.0; states * bins];
    panel.base.reflectance(0.0, &panel.medium, &mut reflectance);
    let light: Vec<f64> = (0..states * bins).map(|at| weights[at % bins] * via_pixel[at]).collect();
    let is_diffused = matches!(panel.top, Top::Diffuser(_));
    let lobe = is_diffused.then(|| Lobe::above(lit, source, weights)).transpose()?;
    let (thickness_mm, reach_mm) = (lit.thickness_mm(), lit.reach_mm()?);
    let most_per_mm = level.most_per_mm.max(HIGHEST / thickness_mm);
    let faces = match known {
        Some(known) => known.clone(),
        None => lit.lambertian_return(most_per_mm)?,
    };
    *known = Some(faces.clone());
    let spread = lit.spread;
    let paper = Paper::new(faces, [thickness_mm, reach_mm], [reflectance, light], bins);
    let paper = Paper { lobe, spread, ..paper };
    let along_axis = images(lit)?;
    // Below a lobe, light is seen from places around anyway.
    if is_diffused {
        return Ok(paper.with_images(along_axis));
    }
    let in_field = images_of_field(lit)?;
    match in_field.len() > along_axis.len() {
        true => Ok(paper.in_field(&in_field, along_axis.get(1).map_or([0.0; 2], |(at_mm, _)| *at_mm))),
        false => Ok(paper.with_images(along_axis)),
    }
}

impl Paper {
    /// The same pixels, seen at some places with some fractions of the light at each wavelength.
    pub(super) fn with_images(mut self, images: Vec<PlacedImage>) -> Self {
        let Self { thickness_mm, reach_mm, spread, .. } = self;
        let states = self.reflectance.len() / self.bins;
        let step_per_mm = 1.0 / (PERIOD * reach_mm);
        // A(0) and A(f) of each face.
        let count = (HIGHEST / thickness_mm / step_per_mm).min(MOST_FREQUENCIES) as usize;
        let returned: Vec<Vec<[f64; 2]>> =
            (0..count).map(|k| self.returned(k as f64 * step_per_mm)).collect();
        // The light of an image: its shades, what is sharp, and the rest.
        let light_of = |(at_mm, fraction): &PlacedImage| {
            let at_mm = *at_mm;
            let shades: Vec<_> = (0..states).map(|state| self.shades_of(state, fraction)).collect();
            // What does not change beyond the highest frequency is sharp.
            let alone = match (count as f64) < MOST_FREQUENCIES {
                true => sum(&shades, &self.returned(0.0), |rho, zero, _| 1.0 - rho * zero),
                false => sum(&shades, &self.returned(count as f64 * step_per_mm), |rho, zero, returned| {
                    (1.0 - rho * zero) / (1.0 - rho * returned)
                }),
            };
            let all = |(k, returned): (usize, &Vec<[f64; 2]>)| {
                sum(&shades, returned, orders(spread, k as f64 * step_per_mm))
            };
            let all: Vec<Vec<f64>> = returned.iter().enumerate().map(all).collect();
            // What returns to the pixel; the rest of the light is known by place.
            let direct = |k: usize| spread.map_or(1.0, |spread| spread.of_state(k as f64 * step_per_mm));
            let rest = |state: usize| {
                all.iter().enumerate().map(|(k, one)| one[state] - direct(k) * alone[state]).collect()
            };
            let rest = (0..states).map(rest).collect();
            let half = || alone.iter().map(|light| 0.5 * light).collect::<Vec<f64>>();
            let (sharp, inside) = match spread {
                None => (alone, None),
                Some(spread) => (half(), Some((spread, half()))),
            };
            let rest = Series { step_per_mm, sharp: sharp.clone(), rest, at_mm, inside };
            (shades, sharp, rest)
        };
        let all_of = |(at_mm, fraction): PlacedImage| {
            let image = (at_mm, fraction);
            let (shades, sharp, rest) = light_of(&image);
            let series = match &self.lobe {
                Some(Lobe { by_ways: Some((own, ways)), .. }) => {
                    ways.iter().map(|way| own.spread(&light_of(way).2).to_vec()).collect()
                }
                Some(lobe) => vec![lobe.spread(&rest).to_vec()],
                None => vec![vec![rest]],
            };
            Image { at_mm, fraction: image.1, shades, sharp, series }
        };
        let found: Vec<Image> = images.into_iter().map(all_of).collect();
        self.images.extend(found);
        self
    }

    /// The same pixels, seen from all directions of a field of view: `images` are those of all, the first one
    /// being that of the pixels at their own place. What returns to the pixels, and is seen in an image beside it,
    /// is wide: all of it is where the axis of the view sees the first image, `at_mm`.
    fn in_field(self, images: &[PlacedImage], at_mm: [f64; 2]) -> Self {
        let Some((own, beside)) = images.split_first() else { return self };
        let all_beside = |bin: usize| beside.iter().map(|(_, fraction)| fraction[bin]).sum();
        let wide = (at_mm, (0..self.bins).map(all_beside).collect());
        let mut paper = self.with_images(vec![own.clone(), wide]);
        let states = paper.reflectance.len() / paper.bins;
        let no_light = vec![0.0; paper.bins];
        let no_shades = (0..states).map(|state| paper.shades_of(state, &no_light)).collect();
        let own_light: f64 = own.1.iter().sum();
        let (step_per_mm, sharp_of_own) =
            (paper.images[0].series[0][0].step_per_mm, paper.images[0].series[0][0].sharp.clone());
        let wide = &mut paper.images[1];
        (wide.fraction, wide.shades) = (no_light, no_shades);
        for series in wide.series.iter_mut().flatten() {
            series.sharp.fill(0.0);
            series.inside = None;
        }
        for (at_mm, fraction) in beside {
            let shades = (0..states).map(|state| paper.shades_of(state, fraction)).collect();
            let part = fraction.iter().sum::<f64>() / own_light;
            let sharp: Vec<f64> = sharp_of_own.iter().map(|light| part * light).collect();
            let inside = paper.spread.map(|spread| (spread, sharp.clone()));
            // A single frequency, without light.
            let rest = vec![vec![0.0]; states];
            let series =
                vec![vec![Series { step_per_mm, sharp: sharp.clone(), rest, at_mm: *at_mm, inside }]];
            paper.images.push(Image { at_mm: *at_mm, fraction: fraction.clone(), shades, sharp, series });
        }
        paper
    }

    /// The same pixels below layers through which they are seen like this.
    pub(super) fn below(self, once: Box<dyn Response>) -> Self {
        Self { lobe: Some(Lobe::new(once)), ..self }
    }

    /// Lambertian pixels, of which nothing is seen yet.
    pub(super) fn new(
        faces: Vec<LambertianReturn>,
        [thickness_mm, reach_mm]: [f64; 2],
        [reflectance, light]: [Vec<f64>; 2],
        bins: usize,
    ) -> Self {
        let (lobe, spread, images) = (None, None, Vec::new());
        let mut responding = light.clone();
        for face in &faces {
            let zero = face.at(0.0);
            for at in face.bins.iter().flat_map(|bin| (*bin..reflectance.len()).step_by(bins)) {
                responding[at] /= 1.0 - reflectance[at] * zero;
            }
        }
        for (responding, light) in responding.chunks_exact_mut(bins).zip(light.chunks_exact(bins)) {
            let [all, scaled] = [light.iter().sum::<f64>(), responding.iter().sum()];
            let scale = if scaled > 0.0 { all / scaled } else { 0.0 };
            responding.iter_mut().for_each(|light| *light *= scale);
        }
        Self { lobe, thickness_mm, reach_mm, faces, spread, reflectance, light, responding, bins, images }
    }
}

impl Lobe {
    fn new(once: Box<dyn Response>) -> Self {
        let y = once.transfer(0, 0.0).iter().map(|y| y.re).collect();
        Self { once, y, by_ways: None }
    }

    /// A diffuser, below a front of one or several components.
    fn above(lit: Lit<'_>, source: &Source, weights: &[f64]) -> Result<Self, DisplayError> {
        let lobe = Self::new(Box::new(lobe::response(lit, source, weights)?));
        let beta = lit.view.field.axis_towards();
        let image = |way: FrontWay| (displacement(beta, way.air_mm, 1.0), way.fraction.to_vec());
        let ways: Vec<PlacedImage> =
            lit.front_ways(lit.level.digits)?.leaving.into_iter().map(image).collect();
        if ways.iter().all(|(at_mm, _)| *at_mm == [0.0; 2]) {
            return Ok(lobe);
        }
        let alone = Panel { components: Vec::new(), ..lit.panel.clone() };
        let own = Self::new(Box::new(lobe::response(Lit { panel: &alone, ..lit }, source, weights)?));
        Ok(Self { by_ways: Some((Box::new(own), ways)), ..lobe })
    }

    /// What is left of a modulation along an axis, `[state]`.
    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        let light = self.once.transfer(axis, frequency_per_mm).into_iter().zip(&self.y);
        light.map(|(light, y)| if *y > 0.0 { light / y } else { Complex64::ZERO }).collect()
    }

    /// Broad light, seen through the lobe: by places along x, along y and in the plane.
    fn spread(&self, light: &Series) -> [Series; 3] {
        let states = light.sharp.len();
        let blank = || Series { sharp: vec![0.0; states], rest: vec![Vec::new(); states], ..light.clone() };
        let mut spread = [blank(), blank(), blank()];
        for k in 0..light.rest.first().map_or(0, Vec::len) {
            let along = [0, 1].map(|axis| self.transfer(axis, k as f64 * light.step_per_mm));
            let mut most = 0.0_f64;
            for (state, rest) in light.rest.iter().enumerate() {
                let [x, y] = along.each_ref().map(|along| along[state].norm());
                for (series, left) in spread.iter_mut().zip([x, y, 0.5 * (x + y)]) {
                    series.rest[state].push(rest[k] * left);
                }
                most = most.max(rest[k].abs() * x.max(y) / rest[0].abs().max(f64::MIN_POSITIVE));
            }
            if most < FAINTEST {
                break;
            }
        }
        spread
    }

    /// Fractions of the light in equal cells around the cell that is seen, in ascending order of place.
    fn along(&self, axis: usize, cell_mm: f64, count: usize) -> Vec<f64> {
        let edges: Vec<f64> = (1..count).map(|k| (k as f64 - 0.5 * count as f64) * cell_mm).collect();
        let brightest = self.brightest();
        let mut cells = self.once.strips(axis, &edges).swap_remove(brightest);
        // Light goes from a place to the opposite one about the place where it is seen.
        cells.reverse();
        cells.iter_mut().for_each(|light| *light /= self.y[brightest]);
        cells
    }

    fn brightest(&self) -> usize {
        (0..self.y.len()).max_by(|a, b| self.y[*a].total_cmp(&self.y[*b])).unwrap_or(0)
    }
}

/// Light at a frequency over that at 0, of reflectance rho with the returns at 0 and at the frequency.
fn orders(spread: Option<PixelSpread>, frequency_per_mm: f64) -> impl Fn(f64, f64, f64) -> f64 {
    let inside = spread.map(|spread| (spread.at(frequency_per_mm), spread.of_state(frequency_per_mm)));
    move |rho, zero, returned| match inside {
        None => (1.0 - rho * zero) / (1.0 - rho * returned),
        Some((spread, state)) => state * (1.0 - rho * zero) / (1.0 - rho * spread * returned),
    }
}

/// Sums the light of each state times a function of rho, A(0) and A(f).
fn sum(shades: &[Vec<Shade>], returned: &[[f64; 2]], of: impl Fn(f64, f64, f64) -> f64) -> Vec<f64> {
    let of_shade = |shade: &Shade| {
        let [zero, returned] = returned[shade.face];
        shade.light * of(shade.reflectance, zero, returned)
    };
    shades.iter().map(|shades| shades.iter().map(of_shade).sum()).collect()
}

impl Paper {
    pub(super) fn shades_of(&self, state: usize, fraction: &[f64]) -> Vec<Shade> {
        let mut shades: Vec<Shade> = Vec::new();
        for (face, LambertianReturn { bins, .. }) in self.faces.iter().enumerate() {
            for (bin, at) in bins.iter().map(|bin| (*bin, state * self.bins + bin)) {
                let (reflectance, light) = (self.reflectance[at], fraction[bin] * self.responding[at]);
                let same = |shade: &&mut Shade| shade.face == face && shade.reflectance == reflectance;
                match shades.iter_mut().find(same) {
                    Some(shade) => shade.light += light,
                    None => shades.push(Shade { face, reflectance, light }),
                }
            }
        }
        shades
    }

    /// A(0) and A(f) of each face.
    pub(super) fn returned(&self, frequency_per_mm: f64) -> Vec<[f64; 2]> {
        self.faces.iter().map(|face| [face.at(0.0), face.at(frequency_per_mm)]).collect()
    }

    /// Light of a pattern of two states through all orders, reduced to some numbers. `is_first`: cells in the
    /// first state.
    fn solved<N>(
        &self,
        cells: Cells,
        states: [usize; 2],
        is_first: &[bool],
        reduced: impl Fn(&[f64]) -> N,
    ) -> N
    where
        N: AsMut<[f64]>,
    {
        let mut sum: Option<N> = None;
        for face in &self.faces {
            let recycling = Recycling::new(cells, |f| face.at(f)).with_spread(self.spread);
            let zero = face.at(0.0);
            // Wavelengths with the same reflectances are solved once.
            let mut known: Vec<([f64; 2], Vec<usize>)> = Vec::new();
            for bin in &face.bins {
                let pair = states.map(|state| self.reflectance[state * self.bins + bin]);
                match known.iter_mut().find(|(other, _)| *other == pair) {
                    Some((_, bins)) => bins.push(*bin),
                    None => known.push((pair, vec![*bin])),
                }
            }
            for (pair, bins) in known {
                let rho: Vec<f64> = is_first.iter().map(|first| pair[usize::from(!first)]).collect();
                let irradiance = recycling.irradiance(&rho, TOLERANCE);
                for Image { at_mm, fraction, .. } in &self.images {
                    // Light of each state per its irradiance: that of a page of it has 1/(1 - rho A(0)).
                    let [first, second] = [0, 1].map(|k| {
                        let of_bin = |bin: &usize| fraction[*bin] * self.light[states[k] * self.bins + bin];
                        let page: f64 = bins.iter().map(of_bin).sum();
                        page * (1.0 - pair[k] * zero)
                    });
                    let shown = shown(cells, *at_mm);
                    let light = |cell: usize| irradiance[cell] * if is_first[cell] { first } else { second };
                    let lights: Vec<f64> = (0..cells.len()).map(|cell| light(shown(cell))).collect();
                    let mut found = reduced(&lights);
                    match &mut sum {
                        None => sum = Some(found),
                        Some(sum) => {
                            let pairs = sum.as_mut().iter_mut().zip(found.as_mut());
                            pairs.for_each(|(sum, more)| *sum += *more);
                        }
                    }
                }
            }
        }
        sum.unwrap_or_else(|| reduced(&vec![0.0; is_first.len()]))
    }

    /// Mean of two states in a pattern that is much finer than the thickness: its mean reflectance returns
    /// light (Clapper, Yule). Where light spreads inside the pixels, the square of the mean root takes the
    /// place of the mean reflectance.
    fn fine_mean(&self, states: [usize; 2]) -> f64 {
        let mut sum = 0.0;
        for face in &self.faces {
            let zero = face.at(0.0);
            for bin in &face.bins {
                let rho = states.map(|state| self.reflectance[state * self.bins + bin]);
                let root = 0.5 * (rho[0].sqrt() + rho[1].sqrt());
                let mean = if self.spread.is_some() { root * root } else { 0.5 * (rho[0] + rho[1]) };
                for (state, rho) in states.into_iter().zip(rho) {
                    let light = self.light[state * self.bins + bin];
                    let inside = if self.spread.is_some() && rho > 0.0 { root / rho.sqrt() } else { 1.0 };
                    sum += 0.5 * inside * light * (1.0 - rho * zero) / (1.0 - mean * zero);
                }
            }
        }
        sum
    }
}

impl Paper {
    /// Light in bins: that of the series with this number, and what a diffuser spreads.
    fn binned(
        &self,
        number: usize,
        of_series: impl Fn(&Series) -> Vec<Vec<f64>>,
        of_lobe: impl Fn(&dyn Response) -> Vec<Vec<f64>>,
    ) -> Vec<Vec<f64>> {
        let mut sums = Vec::new();
        for Image { series, sharp, .. } in &self.images {
            series.iter().for_each(|series| add(&mut sums, of_series(&series[number.min(series.len() - 1)])));
            let Some(lobe) = &self.lobe else { continue };
            let mut once = of_lobe(&*lobe.once);
            for ((bins, sharp), y) in once.iter_mut().zip(sharp).zip(&lobe.y) {
                let factor = if *y > 0.0 { sharp / y } else { 0.0 };
                bins.iter_mut().for_each(|light| *light *= factor);
            }
            add(&mut sums, once);
        }
        sums
    }
}

/// The cell that an image at a place shows in each cell: the nearest one.
fn shown(Cells { count, period_mm }: Cells, at_mm: [f64; 2]) -> impl Fn(usize) -> usize {
    let steps = [0, 1].map(|axis| (at_mm[axis] / period_mm[axis] * count[axis] as f64).round() as i64);
    move |cell| {
        let [column, row] = [(cell % count[0], 0), (cell / count[0], 1)]
            .map(|(k, axis)| (k as i64 - steps[axis]).rem_euclid(count[axis] as i64) as usize);
        row * count[0] + column
    }
}

impl Response for Paper {
    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        let returned = self.returned(frequency_per_mm);
        let mut sums = vec![Complex64::ZERO; self.reflectance.len() / self.bins];
        for Image { at_mm, shades, .. } in &self.images {
            let phase = Complex64::cis(-2.0 * PI * frequency_per_mm * at_mm[axis]);
            let light = sum(shades, &returned, orders(self.spread, frequency_per_mm));
            sums.iter_mut().zip(light).for_each(|(sum, light)| *sum += light * phase);
        }
        if let Some(lobe) = &self.lobe {
            let left = lobe.transfer(axis, frequency_per_mm);
            sums.iter_mut().zip(left).for_each(|(sum, left)| *sum *= left);
        }
        sums
    }

    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        self.binned(axis, |series| series.strips(axis, edges_mm), |lobe| lobe.strips(axis, edges_mm))
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        self.binned(2, |series| series.rings(radii_mm), |lobe| lobe.rings(radii_mm))
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        self.binned(2, |series| series.cells(x_mm, y_mm), |lobe| lobe.cells(x_mm, y_mm))
    }

    fn line(&self, states: [usize; 2], axis: usize, width_mm: f64, level: Level) -> Option<f64> {
        // Where edges are soft, the middle is seen with what is beside it.
        let parts = match (self.spread.is_some() || self.lobe.is_some(), level.is_fine) {
            (false, true) => 5,
            (false, false) => 3,
            (true, true) => 15,
            (true, false) => 9,
        };
        let cell = width_mm / parts as f64;
        let count = cells_along((LINE_PERIOD * self.reach_mm / cell).max(16.0 * parts as f64), level);
        let (mut cells, other) = (Cells { count: [1; 2], period_mm: [cell; 2] }, 1 - axis);
        (cells.count[axis], cells.period_mm[axis]) = (count, count as f64 * cell);
        cells.period_mm[other] = f64::INFINITY;
        let mut is_line = vec![false; count];
        is_line[..parts].fill(true);
        let kernel = self.lobe.as_ref().map(|lobe| lobe.along(axis, cell, count));
        // The cell that is seen is in the middle of the kernel.
        let first = parts / 2 + count - count / 2;
        let seen = |light: &[f64]| match &kernel {
            None => [light[parts / 2]],
            Some(kernel) => {
                let parts = kernel.iter().enumerate().map(|(k, part)| part * light[(first + k) % count]);
                [parts.sum()]
            }
        };
        let [middle] = self.solved(cells, states, &is_line, seen);
        Some(middle)
    }

    fn pattern_mean(&self, pattern: Pattern, level: Level) -> Option<f64> {
        let Pattern { kind, period_mm, states } = pattern;
        if period_mm == 0.0 {
            return Some(self.fine_mean(states));
        }
        // The least numbers also differ: the difference of both levels is the error of fine patterns, too.
        let (widest, least) = match (kind, level.is_fine) {
            (PatternKind::Stripes, true) => (0.05, 64),
            (PatternKind::Stripes, false) => (0.1, 32),
            (PatternKind::Checkerboard, true) => (0.15, 16),
            (PatternKind::Checkerboard, false) => (0.3, 8),
        };
        let widest_mm = widest * self.thickness_mm;
        let (half, rows) = match kind {
            PatternKind::Stripes => (((0.5 * period_mm / widest_mm).ceil() as usize).clamp(least, 4096), 1),
            PatternKind::Checkerboard => {
                let half = (cells_across(period_mm, widest_mm, level) / 2).max(least);
                (half, 2 * half)
            }
        };
        let cells = Cells { count: [2 * half, rows], period_mm: [period_mm; 2] };
        let is_on = (0..cells.len()).map(|cell| (cell % (2 * half) < half) == (cell / (2 * half) < half));
        let is_on: Vec<bool> = is_on.collect();
        let mean = |light: &[f64]| [light.iter().sum::<f64>() / light.len() as f64];
        Some(self.solved(cells, states, &is_on, mean)[0])
    }

    fn text(&self, text: &Text<'_>, states: [usize; 2], level: Level) -> Option<Vec<f64>> {
        let (bitmap, middles) = &text.on_page(self.reach_mm, level);
        let pitch_mm = &text.pitch_mm;
        let on_page = Text { bitmap, pitch_mm: *pitch_mm, middles };
        let widest_mm = if level.is_fine { 0.17 } else { 0.4 } * self.thickness_mm;
        // An odd number of cells: one is in the middle of each pixel. The least numbers also differ, as far as so
        // many cells fit, so that the difference of both levels is the error of small pixels, too.
        let least = match (self.spread, level.is_fine) {
            (None, true) if bitmap.black.len() <= MANY_PIXELS => 3,
            (None, _) => 1,
            (Some(_), true) => 5,
            (Some(_), false) => 3,
        };
        let parts = parts_of_pixels(bitmap, *pitch_mm, widest_mm, level).map(|parts| parts.max(least) | 1);
        let [columns, rows] = [0, 1].map(|axis| bitmap.count[axis] * parts[axis]);
        let period_mm = [0, 1].map(|axis| bitmap.count[axis] as f64 * pitch_mm[axis]);
        let pixel = |cell: usize| cell / columns / parts[1] * bitmap.count[0] + cell % columns / parts[0];
        let is_black: Vec<bool> = (0..columns * rows).map(|cell| bitmap.black[pixel(cell)]).collect();
        let cells = Cells { count: [columns, rows], period_mm };
        let middle = |pixel: usize| {
            let (column, row) = (pixel % bitmap.count[0], pixel / bitmap.count[0]);
            (row * parts[1] + parts[1] / 2) * columns + column * parts[0] + parts[0] / 2
        };
        let kernel = self.lobe.as_ref().map(|lobe| (on_page.kernel(&*lobe.once), lobe.brightest(), &lobe.y));
        let seen = |light: &[f64]| -> Vec<f64> {
            let Some((kernel, brightest, y)) = &kernel else {
                return middles.iter().map(|pixel| light[middle(*pixel)]).collect();
            };
            // Light from elsewhere is that of the page, as in the first pixel.
            let page = light[0];
            let mut more = vec![0.0; bitmap.black.len()];
            let part = 1.0 / (parts[0] * parts[1]) as f64;
            light.iter().enumerate().for_each(|(cell, light)| more[pixel(cell)] += part * (light - page));
            let seen = on_page.seen(kernel, *brightest, &more).into_iter();
            seen.map(|seen| page + seen / y[*brightest]).collect()
        };
        Some(self.solved(cells, states, &is_black, seen))
    }

    fn images(&self) -> Vec<[f64; 2]> {
        match &self.lobe {
            Some(lobe) => lobe.once.images(),
            None => {
                let light = |image: &Image| image.fraction.iter().copied().fold(0.0, f64::max);
                let least = FAINT_IMAGE * self.images.first().map_or(0.0, light);
                let bright = self.images.iter().filter(|image| light(image) > least);
                bright.map(|image| image.at_mm).collect()
            }
        }
    }

    fn peaks(&self) -> Vec<Peak> {
        let width_mm = self.spread.map_or(f64::INFINITY, |spread| spread.radius_mm());
        let peak = |at_mm| Peak { at_mm, width_mm: width_mm.min(0.05 * self.thickness_mm) };
        match &self.lobe {
            Some(lobe) => lobe.once.peaks(),
            None => self.images().into_iter().map(peak).collect(),
        }
    }
}
