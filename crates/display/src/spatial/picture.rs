//! Colours of a picture on Lambertian pixels under a flat face, which returns light to them, as does a front
//! of screen above it, or below general layers, which also blur what is seen of them.
//!
//! **General layers.** Light of the pixels through all orders is seen through the point spread of a view
//! ([`Layers`]), in the middle of each pixel. Light from farther away than [`REACH`] is that of the mean of
//! the picture. Pictures in several views have the point spread of the one in the middle.
//!
//! **A mask.** Light is solved on a picture that repeats. A black mask around it is a margin of pixels that reflect
//! nothing, so wide that hardly any light passes below it to the opposite border ([`MARGIN`]).

use num_complex::Complex64;
use papilio_fourier::{Plane, smooth};
use papilio_transport::spatial::{
    Accuracy, LambertianReturn, LitPage, Page, PageLight, Precision, air_below_front_mm,
};
use papilio_transport::{Panel, Reflector, Top};

use super::below_layers::Layers;
use super::response::face_reflectance;
use super::{Level, PictureSurround, Refused};
use crate::DisplayError;
use crate::lamp_images;
use crate::meter::Meter;
use crate::run::Control;
use crate::scene::Scene;
use crate::setup::{Setup, ViewPoint};

/// A picture: the state of each pixel, by its number in the scene; rows from the bottom, columns from the
/// left. It repeats beyond its borders.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Number of columns and rows.
    pub count: [usize; 2],
    /// State of each pixel.
    pub states: Vec<u8>,
}

/// Colours of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureColours {
    /// X, Y and Z of each pixel relative to a perfect white in the scene's light, for each view.
    pub views: Vec<Vec<[f32; 3]>>,
    /// Largest error: the difference from cells of half the size in a part of the picture, and what
    /// repetitions leave.
    pub error: f64,
}

/// Columns and rows of the part of which the error is computed.
const PART: usize = 128;

/// Largest number of cells, unless the picture has more pixels.
const MOST_CELLS: usize = 1 << 23;

/// Natural digits of light that a front returns.
const DIGITS: f64 = 12.0;

/// Width of a mask around a picture, in heights of the layers. Light that spreads from a straight border and is
/// reflected at the height `h` arrives beyond a distance `x` by the fraction `(1 - x/sqrt(x^2 + 4 h^2))/2`: 1e-3.
const MARGIN: f64 = 32.0;

/// Largest width of a mask, pixels.
const MOST_MARGIN: usize = 2048;

/// State of the pixels of a mask, which has no reflectance.
const MASK: u8 = u8::MAX;

/// Level of the colours of pages, and below general layers.
const LEVEL: u32 = 4;
const LEVEL_OF_LAYERS: u32 = 2;

/// Distance from the pixel that is seen, in heights of general layers, up to which light of each pixel is
/// known, and the same in pixels: at least, and at most.
const REACH: f64 = 8.0;
const PIXELS: [usize; 2] = [2, 128];

/// Computes what each view sees of each pixel of a picture, through all orders.
///
/// # Errors
/// If the scene is invalid, has no matrix, a length is missing, its kind of display or light is not covered,
/// a state does not exist, or the computation was stopped.
pub fn picture(
    scene: &Scene,
    picture: &Picture,
    precision: Precision,
    control: &Control<'_>,
) -> Result<PictureColours, DisplayError> {
    Setup::has_no_filter(scene)?;
    let setup = Setup::of_places(scene, control)?;
    let mut colours = PictureColours { views: Vec::new(), error: 0.0 };
    // Below general layers each view has a point spread of its own.
    let together = if setup.stack.panel().is_some() { setup.views.len().max(1) } else { 1 };
    for views in setup.views.chunks(together) {
        let lights = views.iter().map(|view| ViewLight::new(&setup, view, control));
        let lights = lights.collect::<Result<Vec<ViewLight>, _>>()?;
        let of = (&setup, views.first());
        let of_picture = (picture.clone(), PictureSurround::Repeat);
        let (lit, rows) = LitPicture::of(of, &lights, of_picture, precision, control)?;
        colours.views.extend(rows.iter().map(|row| lit.seen(row)));
        colours.error = colours.error.max(lit.error);
    }
    Ok(colours)
}

/// The irradiance of a picture's pixels. It does not depend on light and view: what is seen in them is linear
/// in the numbers of a row, light via the pixel in `[X, Y, Z][state and wavelength]` and that of faces in X,
/// Y, Z.
pub(crate) struct LitPicture {
    /// With the mask around it on the right and at the top.
    picture: Picture,
    /// Number of columns and rows without the mask.
    inside: [usize; 2],
    pitch_mm: [f64; 2],
    /// Number of states and of wavelengths.
    states: usize,
    bins: usize,
    groups: Vec<Group>,
    /// Largest error: the difference from cells of half the size in a part of the picture.
    pub(crate) error: f64,
}

/// Wavelengths with the same face.
struct Group {
    bins: Vec<usize>,
    /// Reflectance, `[state][wavelength]`.
    reflectance: Vec<Vec<f64>>,
    lit: LitPage,
    /// What is seen of the pixels around each, if they are blurred.
    blur: Option<PixelBlur>,
}

/// Point spread of the pixels of a picture that repeats.
struct PixelBlur {
    plane: Plane,
    spectrum: Vec<Complex64>,
}

impl LitPicture {
    /// Prepares a picture, rows from the top, for the only view of each scene, and returns its row. The
    /// scenes have the same display, and differ in light and view. The images of round lamps in the face can
    /// be left out.
    ///
    /// # Errors
    /// Those of [`picture`].
    pub(crate) fn new(
        setups: &[&Setup],
        (size, states, surround): ([usize; 2], &[u8], PictureSurround),
        precision: Precision,
        without_lamps: bool,
        control: &Control<'_>,
    ) -> Result<(Self, Vec<Vec<f64>>), DisplayError> {
        let flipped = states.chunks_exact(size[0]).rev().flatten();
        let picture = Picture { count: size, states: flipped.copied().collect() };
        let of_view = |setup: &&Setup| {
            let Some(view) = setup.views.first() else { return Ok(None) };
            let mut light = ViewLight::new(setup, view, control)?;
            for image in lamp_images::in_view(setup).iter().filter(|_| without_lamps) {
                (0..3).for_each(|k| light.front[k] -= image.front[k]);
            }
            Ok(Some(light))
        };
        let lights = setups.iter().map(of_view).filter_map(Result::transpose);
        let lights = lights.collect::<Result<Vec<ViewLight>, DisplayError>>()?;
        let middle = setups[setups.len() / 2];
        Self::of((middle, middle.views.first()), &lights, (picture, surround), precision, control)
    }

    fn of(
        (setup, view): (&Setup, Option<&ViewPoint>),
        lights: &[ViewLight],
        (picture, surround): (Picture, PictureSurround),
        precision: Precision,
        control: &Control<'_>,
    ) -> Result<(Self, Vec<Vec<f64>>), DisplayError> {
        let missing = DisplayError::NoMatrix { command: "picture" };
        let pitch_mm = setup.scene.display.matrix.as_ref().ok_or(missing)?.pitch_mm;
        let stack = setup.spreads_over_few_pixels()?;
        let (panel, rho) = covered(setup)?;
        let at = |is_fine: bool| {
            let digits = Level::digits_of_layers(usize::from(is_fine));
            let level = Level { digits, most_per_mm: 0.0, is_fine, is_other: false, finer: 0 };
            let view = view.filter(|_| panel.is_none());
            view.map(|view| Layers::new(setup, view, level, control)).transpose()
        };
        let layers = [at(false)?, at(true)?];
        let thickness_mm = match &layers[1] {
            Some(layers) => layers.thickness_mm(),
            None => stack.layers().last().map_or(0.0, |glass| glass.thickness_mm),
        };
        let spread = setup.scene.display.pixel_spread();
        let highest = picture.states.iter().copied().map(usize::from).max().unwrap_or(0);
        if highest >= setup.states.len() || picture.states.len() != picture.count[0] * picture.count[1] {
            return Err(DisplayError::NoSuchQuantity {
                what: format!("state {highest}"),
                quantity: "picture",
            });
        }
        let (states, count) = (setup.states.len(), setup.scene.grid.len());
        let inside = picture.count;
        let reach = reach_of_layers(stack.thickness_mm(), pitch_mm);
        let mut picture = picture;
        let mut passes = 0.0;
        if surround == PictureSurround::BlackMask {
            let air_mm = panel.map_or(Ok(0.0), air_below_front_mm).map_err(Refused::Fronts)?;
            let inside_mm = setup.scene.display.pixel_spread().map_or(0.0, |spread| spread.radius_mm());
            let height_mm = stack.thickness_mm() + air_mm + inside_mm;
            let wanted = |k: usize| (MARGIN * height_mm / pitch_mm[k]).ceil().max(reach as f64);
            let margin = [0, 1].map(|k| (wanted(k) as usize).min(MOST_MARGIN));
            let way_mm = (0..2).map(|k| margin[k] as f64 * pitch_mm[k]).fold(f64::INFINITY, f64::min);
            passes = 0.5
                * (1.0 - way_mm / way_mm.hypot(2.0 * height_mm))
                * rho.iter().copied().fold(0.0, f64::max);
            picture = picture.in_mask(margin);
            if states > usize::from(MASK) {
                let what = format!("a black mask around a picture of {states} states");
                return Err(DisplayError::PlacesNotComputed { what, key: "image.surround".to_owned() });
            }
        }
        // A large picture has few cells in a pixel, at least one.
        let fit = (MOST_CELLS as f64 / picture.states.len() as f64).sqrt().max(1.0) as usize;
        let precision = Precision { most_per_pixel: precision.most_per_pixel.min(fit), ..precision };
        let finer = Precision {
            cell: 0.5 * precision.cell,
            most_per_pixel: 2 * precision.most_per_pixel,
            change: 0.1 * precision.change,
            missed: 0.1 * precision.missed,
        };
        let mut rows: Vec<Vec<f64>> = lights.iter().map(ViewLight::row).collect();
        let empty = |picture: Picture| Self {
            inside: picture.count,
            picture,
            pitch_mm,
            states,
            bins: count,
            groups: Vec::new(),
            error: 0.0,
        };
        let part = picture.part(inside);
        let mut parts = [empty(part.clone()), empty(part)];
        let mut whole = Self { inside, error: passes, ..empty(picture) };
        // Cells of half the size, and their diagonal.
        let most_per_mm = 2.0 / (finer.cell * thickness_mm);
        // Where light spreads inside the pixels, each is a cell.
        let of_pixels = if spread.is_some() { 0.75 / pitch_mm[0].min(pitch_mm[1]) } else { 0.0 };
        let accuracy = Accuracy { digits: DIGITS, most_per_mm: most_per_mm.max(of_pixels) };
        // At the coarser and the finer level.
        let faces = match (panel, &layers) {
            (Some(panel), _) => {
                whole.error += shifted(panel, &setup.views);
                let all = LambertianReturn::all(panel, accuracy).map_err(Refused::Fronts)?;
                [all.clone(), all]
            }
            (None, [Some(coarse), Some(fine)]) => [coarse.returns(), fine.returns()],
            (None, _) => [Vec::new(), Vec::new()],
        };
        let spreads = layers.each_ref().map(|layers| {
            layers.as_ref().map(|layers| layers.of_pixels(pitch_mm, reach)).unwrap_or_default()
        });
        let [coarse_faces, faces] = faces;
        for (number, (coarse_face, face)) in coarse_faces.into_iter().zip(faces).enumerate() {
            let blurred = |is_fine: bool, count: [usize; 2]| {
                let spread = spreads[usize::from(is_fine)].get(number)?;
                Some(PixelBlur::new(spread, reach, count))
            };
            let bins = face.bins.clone();
            control.check()?;
            let reflectance: Vec<Vec<f64>> =
                (0..states).map(|state| bins.iter().map(|bin| rho[state * count + bin]).collect()).collect();
            // A page of one state has 1/(1 - rho A(0)) times the light of an irradiance of 1.
            for row in &mut rows {
                for (state, rho) in reflectance.iter().enumerate() {
                    for (bin, rho) in bins.iter().zip(rho) {
                        let alone = 1.0 - rho * face.at(0.0);
                        (0..3).for_each(|k| row[(k * states + state) * count + bin] *= alone);
                    }
                }
            }
            let Some(first) = rows.first() else { continue };
            let seen = of_states(first, states, count, &bins);
            let light = PageLight { reflectance: &reflectance, seen: &seen };
            let solve = |into: &mut Self, precision: Precision, is_fine: bool| {
                let returned = |f: f64| if is_fine { face.at(f) } else { coarse_face.at(f) };
                let lit =
                    LitPage::with_spread(spread, &into.page(), (&returned, thickness_mm), light, precision);
                let blur = blurred(is_fine, into.picture.count);
                into.groups.push(Group { bins: bins.clone(), reflectance: reflectance.clone(), lit, blur });
            };
            solve(&mut whole, precision, true);
            solve(&mut parts[0], precision, false);
            solve(&mut parts[1], finer, true);
        }
        // The change of the repetitions belongs to the difference below, unless they ended before they
        // reached it. The light of a page of the largest reflectance is at most that of a perfect white.
        let left = whole.groups.iter().map(|group| group.lit.left()).fold(0.0, f64::max);
        whole.error += if left > precision.change { left } else { 0.0 };
        let mut change = 0.0;
        for row in &rows {
            let [coarse, fine] = parts.each_ref().map(|part| part.seen(row));
            let pairs = coarse.iter().flatten().zip(fine.iter().flatten());
            change = pairs.map(|(coarse, fine)| f64::from((coarse - fine).abs())).fold(change, f64::max);
        }
        whole.error += change;
        Ok((whole, rows))
    }

    fn page(&self) -> Page<'_> {
        Page { count: self.picture.count, pitch_mm: self.pitch_mm, states: &self.picture.states }
    }

    /// X, Y and Z of each pixel for a row; rows from the bottom.
    pub(crate) fn seen(&self, row: &[f64]) -> Vec<[f32; 3]> {
        let (_, front) = row.split_at(row.len() - 3);
        let mut sum = vec![[0, 1, 2].map(|k| front[k] as f32); self.picture.states.len()];
        for Group { bins, reflectance, lit, blur } in &self.groups {
            let seen = of_states(row, self.states, self.bins, bins);
            let mut more = lit.seen(&self.page(), PageLight { reflectance, seen: &seen });
            if let Some(blur) = blur {
                blur.apply(&mut more);
            }
            sum.iter_mut().zip(more).for_each(|(sum, more)| (0..3).for_each(|k| sum[k] += more[k]));
        }
        if self.inside == self.picture.count {
            return sum;
        }
        let rows = sum.chunks_exact(self.picture.count[0]).take(self.inside[1]);
        rows.flat_map(|row| row[..self.inside[0]].iter().copied()).collect()
    }
}

impl PixelBlur {
    /// `spread`: light of each pixel up to `reach` pixels around, by rows from the bottom.
    fn new(spread: &[f64], reach: usize, count: [usize; 2]) -> Self {
        let side = 2 * reach + 1;
        let pixels = (count[0] * count[1]) as f64;
        let far = (1.0 - spread.iter().sum::<f64>()) / pixels;
        let mut cells = vec![Complex64::from(far); count[0] * count[1]];
        for (cell, light) in spread.iter().enumerate() {
            let at = |k: usize, count: usize| (k as i64 - reach as i64).rem_euclid(count as i64) as usize;
            cells[at(cell / side, count[1]) * count[0] + at(cell % side, count[0])] += light;
        }
        let plane = Plane::new(count);
        let spectrum = plane.forward(cells).into_iter().map(|value| value / pixels).collect();
        Self { plane, spectrum }
    }

    /// Replaces the light of pixels by what is seen of it. Two quantities are real and imaginary part.
    fn apply(&self, pixels: &mut [[f32; 3]]) {
        for (re, im) in [(0, 1), (2, 2)] {
            let value = |pixel: &[f32; 3]| Complex64::new(f64::from(pixel[re]), f64::from(pixel[im]));
            let mut spectrum = self.plane.forward(pixels.iter().map(value).collect());
            spectrum.iter_mut().zip(&self.spectrum).for_each(|(value, factor)| *value *= factor);
            for (pixel, light) in pixels.iter_mut().zip(self.plane.inverse(spectrum)) {
                (pixel[re], pixel[im]) = (light.re as f32, light.im as f32);
            }
        }
    }
}

/// Number of pixels around a pixel whose light is known below general layers.
fn reach_of_layers(thickness_mm: f64, pitch_mm: [f64; 2]) -> usize {
    let pixels = REACH * thickness_mm / pitch_mm[0].min(pitch_mm[1]);
    (pixels.ceil() as usize).clamp(PIXELS[0], PIXELS[1])
}

/// What is seen of each state at some wavelengths, `[state][X, Y, Z][wavelength]`, of a row.
fn of_states(row: &[f64], states: usize, count: usize, bins: &[usize]) -> Vec<[Vec<f64>; 3]> {
    let of = |state: usize| {
        [0, 1, 2].map(|k| bins.iter().map(|bin| row[(k * states + state) * count + bin]).collect())
    };
    (0..states).map(of).collect()
}

impl Picture {
    /// The picture with a mask beyond its right and upper borders, which are also beyond the other ones because
    /// it repeats. The mask is at least `margin` pixels wide.
    fn in_mask(&self, margin: [usize; 2]) -> Self {
        let count = [0, 1].map(|k| smooth(self.count[k] + margin[k]));
        let beside = vec![MASK; count[0] - self.count[0]];
        let mut states: Vec<u8> = self
            .states
            .chunks_exact(self.count[0])
            .flat_map(|row| row.iter().chain(&beside))
            .copied()
            .collect();
        states.resize(count[0] * count[1], MASK);
        Self { count, states }
    }

    /// The middle of the picture, or its upper right corner if only what is `inside` is no mask.
    fn part(&self, inside: [usize; 2]) -> Self {
        let count = self.count.map(|count| count.min(PART));
        let middle = |k: usize| if inside[k] < self.count[k] { inside[k] } else { self.count[k] / 2 };
        let from = [0, 1].map(|k| middle(k).saturating_sub(count[k] / 2).min(self.count[k] - count[k]));
        let row = |row: usize| &self.states[(from[1] + row) * self.count[0] + from[0]..][..count[0]];
        Self { count, states: (0..count[1]).flat_map(row).copied().collect() }
    }
}

/// What a view sees of pages in all light.
pub(super) struct ViewLight {
    /// Light via the pixel in X, Y and Z, `[X, Y, Z][state and wavelength]`.
    pub(super) pages: [Vec<f64>; 3],
    /// Light of faces.
    front: [f64; 3],
}

impl ViewLight {
    pub(super) fn new(setup: &Setup, view: &ViewPoint, control: &Control<'_>) -> Result<Self, DisplayError> {
        let (meter, bins) = (Meter::new(setup), setup.scene.grid.len());
        let mut light =
            Self { pages: [0, 1, 2].map(|_| vec![0.0; setup.states.len() * bins]), front: [0.0; 3] };
        let level = if setup.stack.panel().is_some() { LEVEL } else { LEVEL_OF_LAYERS };
        let factors = setup.seen(view, level, control)?;
        light.front = meter.without_pixel(&factors);
        for one in meter.pixel_lights() {
            let via_pixel = &factors[one.source].via_pixel;
            for (pages, weights) in light.pages.iter_mut().zip(&one.weights) {
                let values = via_pixel.iter().enumerate().map(|(at, light)| weights[at % bins] * light);
                pages.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            }
        }
        Ok(light)
    }

    /// All numbers, one after another.
    fn row(&self) -> Vec<f64> {
        self.pages.iter().flatten().chain(&self.front).copied().collect()
    }
}

/// Largest part of the light that oblique views see of other pixels, because it was reflected between the
/// face and a front above it; relative to a perfect white.
fn shifted(panel: &Panel, views: &[ViewPoint]) -> f64 {
    let is_apart = air_below_front_mm(panel).is_ok_and(|air_mm| air_mm > 0.0);
    let of_view = |view: &ViewPoint| {
        let beta = view.field.axis_towards().length();
        let between = |bin: usize| face_reflectance(panel, bin, beta) * panel.front.reflectance_below[bin];
        (0..panel.base.bins()).filter(|_| beta > 0.0 && is_apart).map(between).fold(0.0, f64::max)
    };
    views.iter().map(of_view).fold(0.0, f64::max)
}

/// Returns panel and reflectances if pictures on them are computed.
fn covered(setup: &Setup) -> Result<(Option<&Panel>, &[f64]), DisplayError> {
    let not_yet = |what: &str, key: &str| {
        Err(DisplayError::PlacesNotComputed { what: what.to_owned(), key: key.to_owned() })
    };
    setup.refracts()?;
    let panel = setup.stack.panel();
    let Reflector::Lambertian(rho) = &setup.stack.base().reflector else {
        return not_yet("pictures on mirror-like pixels", "display.pixel");
    };
    if panel.is_some_and(|panel| matches!(panel.top, Top::Diffuser(_))) {
        return not_yet("pictures below a diffuser", "display.diffuser");
    }
    Ok((panel, rho))
}
