//! What a diffuser makes of a picture: each pixel is seen as a mixture of its neighbours.
//!
//! **What.** X, Y and Z at the middle of each pixel are sums over the pixels about it, each with the light of
//! its area in its own state (`lobe.rs`), and over all lights. Pixels are uniform: each has the mean colour
//! of its state.
//!
//! **All orders.** Light that layers return to the pixels makes each state brighter by the gain that it has
//! on a page of its own: uniform pictures and wide areas have the colours of pages. Fine detail has the gain
//! of a mixture of its states; the difference is a part of the error. Light from beyond the reach of the
//! kernels is that of the mean of the picture.

use std::sync::Arc;

use papilio_fourier::{KernelShapes, StatePicture};
use papilio_transport::spatial::{Peak, PixelSquare, Shapes};
use papilio_transport::{Panel, Reflector, Top};

use super::lobe::{self, LobeResponse};
use super::picture::ViewLight;
use super::response::Lit;
use super::{Level, Response};
use crate::DisplayError;
use crate::lamp_images;
use crate::meter::{Meter, PixelLight};
use crate::run::Control;
use crate::setup::Setup;
use crate::threads::each;

/// What lies beyond the borders of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PictureSurround {
    /// The picture again and again.
    Repeat,
    /// A mask that reflects no light.
    #[default]
    BlackMask,
}

/// Distance from the pixel that is seen, in thicknesses of the glass, beyond which light comes from the mean
/// of the picture.
const REACH: f64 = 8.0;

/// Light that shapes may miss of a kernel that is only a filter, relative to a perfect white.
const ROUGH: f64 = 1e-3;

/// Accuracy of the light of cells, natural digits: this many more than those that shapes may miss, within
/// limits.
const MORE_DIGITS: f64 = 1.0;
const DIGITS: [f64; 2] = [6.0, 12.0];

/// Kernels of a view: X, Y and Z of all states in one or several lights, `[light][X, Y, Z][state]`.
pub(crate) struct Blur {
    pub(super) squares: Vec<PixelSquare>,
    pub(super) shapes: Shapes,
    pub(super) states: usize,
    /// Light via the pixel over that which meets it once, on pages, `[light][X, Y, Z][state]`.
    pub(super) gains: Vec<f64>,
    /// For each state the state of the pixel of which it is a part; itself, if it is none.
    pub(super) wholes: Vec<usize>,
}

/// A picture below a diffuser.
pub(crate) struct BlurredPicture {
    picture: Arc<StatePicture>,
    shapes: KernelShapes,
    /// Number of threads.
    threads: usize,
}

impl Blur {
    /// Computes the kernels of the only view of each scene in all its light. The scenes have the same
    /// display, and differ in light or view. Shapes may miss a little of the light of a kernel, relative to a
    /// perfect white; the images of round lamps in mirror-like pixels can be left out. `None` if no diffuser
    /// spreads light, below a colour filter, or if places are not known.
    pub(crate) fn new(
        setups: &[&Setup],
        missed: f64,
        without_lamps: bool,
        control: &Control<'_>,
    ) -> Result<Option<Self>, DisplayError> {
        let Some(matrix) = setups.first().and_then(|setup| setup.scene.display.matrix.as_ref()) else {
            return Ok(None);
        };
        if matrix.filter.is_some() {
            return Ok(None);
        }
        if setups[0].stack.panel().is_some_and(is_covered) {
            setups[0].spreads_over_few_pixels()?;
        }
        let digits = (MORE_DIGITS - missed.ln()).clamp(DIGITS[0], DIGITS[1]);
        let threads = control.thread_count();
        let lit = each(setups, threads, |setup| {
            let found = responses(setup, matrix.pitch_mm, digits)?;
            Ok::<_, DisplayError>(found.map(|found| (*setup, found)))
        });
        let lit: Option<Vec<(&Setup, Vec<LobeResponse>)>> =
            lit.into_iter().collect::<Result<Vec<_>, DisplayError>>()?.into_iter().collect();
        let Some(lit) = lit else { return Ok(None) };
        let responses = lit.iter().flat_map(|(_, responses)| responses);
        let peaks: Vec<Peak> = responses.flat_map(LobeResponse::all_peaks).collect();
        let farthest = peaks.iter().map(|peak| peak.at_mm[0].hypot(peak.at_mm[1])).fold(0.0, f64::max);
        let thickness_mm = lit[0].0.placed()?.layers().last().map_or(0.0, |glass| glass.thickness_mm);
        let squares = PixelSquare::about(&peaks, matrix.pitch_mm, REACH * thickness_mm + farthest);
        let borders: Vec<_> = squares.iter().map(|square| square.borders_mm(matrix.pitch_mm)).collect();
        let states = lit[0].0.states.len();
        let own = squares.iter().position(|square| *square == PixelSquare::OWN);
        let (middle, of_middle) = {
            let (setup, responses) = &lit[lit.len() / 2];
            (&setup.scene.lighting, gains(setup, responses, control)?)
        };
        let found = each(&lit, threads, |(setup, responses)| {
            // Gains hardly depend on the view.
            let gains = match setup.scene.lighting == *middle {
                true => of_middle.clone(),
                false => gains(setup, responses, control)?,
            };
            let mut sums: Vec<Vec<f64>> = vec![vec![0.0; squares.len()]; 3 * states];
            for response in responses {
                for (sum, more) in sums.iter_mut().zip(response.rectangles(&borders)) {
                    sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
                }
            }
            for image in lamp_images::in_view(setup).iter().filter(|_| without_lamps) {
                for (kernel, sum) in sums.iter_mut().enumerate() {
                    let (quantity, state) = (kernel / states, kernel % states);
                    own.into_iter().for_each(|own| sum[own] -= image.pixel[state][quantity]);
                }
            }
            Ok((sums, gains))
        });
        let found = found.into_iter().collect::<Result<Vec<_>, DisplayError>>()?;
        let (kernels, gains): (Vec<Vec<Vec<f64>>>, Vec<Vec<f64>>) = found.into_iter().unzip();
        Ok(Some(Self {
            squares,
            shapes: Shapes::of(&kernels.concat(), missed),
            states,
            wholes: (0..states).collect(),
            gains: gains.concat(),
        }))
    }

    /// Spread of the brightest state of a scene in Y: the part of its light in each pixel up to `reach`
    /// pixels away, by rows. `None` as for [`new`](Self::new).
    pub(crate) fn spread_of_white(
        setup: &Setup,
        reach: i64,
        control: &Control<'_>,
    ) -> Result<Option<Vec<f64>>, DisplayError> {
        let Some(blur) = Self::new(&[setup], ROUGH, false, control)? else { return Ok(None) };
        let kernels = &blur.shapes.mixtures[blur.states..][..blur.states];
        let light = kernels.iter().map(|kernel| (kernel, blur.near(kernel)));
        let Some((kernel, all)) = light.max_by(|a, b| a.1.total_cmp(&b.1)) else { return Ok(None) };
        let side = 2 * reach + 1;
        let mut spread = vec![0.0; (side * side) as usize];
        for (shape, weight) in blur.shapes.shapes.iter().zip(kernel) {
            for (square, light) in blur.squares.iter().zip(shape) {
                let each = weight * light / (square.side * square.side) as f64;
                square.each_pixel(|[x, y]| {
                    if x.abs().max(y.abs()) <= reach {
                        spread[((y + reach) * side + x + reach) as usize] += each / all;
                    }
                });
            }
        }
        Ok(Some(spread))
    }

    /// States that are parts of pixels: they stand so close to each other that layers return to them the
    /// light of the whole.
    pub(crate) fn with_wholes(mut self, wholes: &[usize]) -> Self {
        if !wholes.is_empty() {
            self.wholes = wholes.to_vec();
            for gains in self.gains.chunks_exact_mut(self.states) {
                let own = gains.to_vec();
                gains.iter_mut().zip(wholes).for_each(|(gain, whole)| *gain = own[*whole]);
            }
        }
        self
    }

    /// Number of shapes of all kernels.
    pub(crate) fn shapes(&self) -> usize {
        self.shapes.shapes.len()
    }

    /// Transforms a picture of states, rows from the top, unless it is the one that is `known`; afterwards it
    /// is. `threads` is that of threads.
    pub(crate) fn picture(
        &self,
        states: &[u8],
        columns: usize,
        surround: PictureSurround,
        known: &mut Option<Arc<StatePicture>>,
        threads: usize,
    ) -> BlurredPicture {
        let reach = self.squares.iter().map(PixelSquare::reach).max().unwrap_or(0);
        let margin = match surround {
            PictureSurround::Repeat => [0; 2],
            PictureSurround::BlackMask => [reach; 2],
        };
        let is_same = |known: &Arc<StatePicture>| known.is_of(states, columns, self.states, margin);
        let picture = known.take().filter(is_same);
        let picture = picture
            .unwrap_or_else(|| Arc::new(StatePicture::new(states, columns, self.states, margin, threads)));
        *known = Some(Arc::clone(&picture));
        let shapes = picture.shapes(self.shapes(), threads, |shape, add| {
            for (square, light) in self.squares.iter().zip(&self.shapes.shapes[shape]) {
                let each = light / (square.side * square.side) as f64;
                // A point spread says where the light of a pixel goes: it comes from the opposite place.
                square.each_pixel(|[right, up]| add([-right, -up], each));
            }
        });
        BlurredPicture { picture, shapes, threads }
    }

    /// Numbers in which what is seen in each scene is linear: the mixture of shapes of each kernel,
    /// `[X, Y, Z][state][shape]`, times the light of the shape; and light that is the same everywhere, in X,
    /// Y, Z. `pages` has X, Y, Z of a page of each state, through all orders and with the image of the room
    /// in the faces, for each scene; `shown` is the fraction of the picture in each state.
    pub(crate) fn rows(&self, pages: &[Vec<[f64; 3]>], shown: &[f64]) -> Vec<Vec<f64>> {
        let light = self.light();
        let of_scene = |(scene, pages): (usize, &Vec<[f64; 3]>)| {
            let kernels = &self.shapes.mixtures[3 * self.states * scene..][..3 * self.states];
            let gains = &self.gains[3 * self.states * scene..][..3 * self.states];
            let mut row: Vec<f64> = Vec::with_capacity(kernels.len() * light.len() + 3);
            for (kernel, gain) in kernels.iter().zip(gains) {
                row.extend(kernel.iter().zip(&light).map(|(weight, light)| gain * weight * light));
            }
            row.extend((0..3).map(|k| {
                let of_state = |(shown, whole): (&f64, &usize)| {
                    let kernel = k * self.states + whole;
                    shown * (pages[*whole][k] - gains[kernel] * self.near(&kernels[kernel]))
                };
                shown.iter().zip(&self.wholes).map(of_state).sum::<f64>()
            }));
            row
        };
        pages.iter().enumerate().map(of_scene).collect()
    }

    /// Computes X, Y and Z of each pixel for each row of [`rows`](Self::rows), and calls `found` with its
    /// number and them.
    pub(crate) fn seen(
        &self,
        blurred: &BlurredPicture,
        rows: &[Vec<f64>],
        found: impl FnMut(usize, &mut Vec<[f32; 3]>),
    ) {
        let light = self.light();
        let weights = |row: &Vec<f64>| -> Vec<f64> {
            let own = row[..row.len() - 3].iter().zip(light.iter().cycle());
            own.map(|(value, light)| if *light > 0.0 { value / light } else { 0.0 }).collect()
        };
        let far = |row: &Vec<f64>| [3, 2, 1].map(|back| row[row.len() - back] as f32);
        let mixtures: Vec<Vec<f64>> = rows.iter().map(weights).collect();
        let far: Vec<[f32; 3]> = rows.iter().map(far).collect();
        blurred.picture.seen(&blurred.shapes, &mixtures, &far, blurred.threads, found);
    }

    /// Largest error of X, Y and Z: what shapes miss, and that of fine detail, where each state has the gain
    /// of a mixture of all, and that beside a mask, from which half of the light does not return.
    pub(crate) fn error(&self, shown: &[f64], surround: PictureSurround) -> f64 {
        let mut largest = 0.0_f64;
        // Fraction of a mask in what is around a pixel.
        let masked = match surround {
            PictureSurround::Repeat => 0.0,
            PictureSurround::BlackMask => 0.5,
        };
        let kernels = self.shapes.mixtures.chunks_exact(self.states);
        for (gains, kernels) in self.gains.chunks_exact(self.states).zip(kernels) {
            // A gain is 1/(1 - A rho): that of a mixture has its mean reflectance, and a mask has none.
            let mixed = gains.iter().zip(shown).map(|(gain, shown)| shown / gain).sum::<f64>();
            for ((gain, kernel), shown) in gains.iter().zip(kernels).zip(shown) {
                let beside_mask = masked + (1.0 - masked) / gain;
                if *shown > 0.0 {
                    let around = [mixed, beside_mask].map(|around| (gain - 1.0 / around).abs());
                    largest = largest.max(around[0].max(around[1]) * self.near(kernel));
                }
            }
        }
        largest + self.shapes.missed
    }

    /// Light of each shape, without its sign.
    fn light(&self) -> Vec<f64> {
        self.shapes.shapes.iter().map(|shape| shape.iter().map(|value| value.abs()).sum()).collect()
    }

    /// Light within the reach of a kernel.
    fn near(&self, kernel: &[f64]) -> f64 {
        let sums = self.shapes.shapes.iter().map(|shape| shape.iter().sum::<f64>());
        kernel.iter().zip(sums).map(|(weight, sum)| weight * sum).sum()
    }
}

/// Light via the pixel over that which meets it once, on pages in all light, `[X, Y, Z][state]`.
fn gains(setup: &Setup, lit_by: &[LobeResponse], control: &Control<'_>) -> Result<Vec<f64>, DisplayError> {
    let (states, bins) = (setup.states.len(), setup.scene.grid.len());
    let (Some(view), Some(panel)) = (setup.views.first(), setup.stack.panel()) else {
        return Ok(Vec::new());
    };
    if panel.front.reflectance_below.max() == 0.0 {
        return Ok(vec![1.0; 3 * states]);
    }
    let mut once = vec![0.0; 3 * states];
    for response in lit_by {
        once.iter_mut().zip(response.transfer(0, 0.0)).for_each(|(sum, light)| *sum += light.re);
    }
    let pages = ViewLight::new(setup, view, control)?.pages;
    let via_pixel =
        pages.iter().flat_map(|pages| pages.chunks_exact(bins).map(|page| page.iter().sum::<f64>()));
    let gain = |(once, all): (&f64, f64)| if *once > 0.0 { all / once } else { 1.0 };
    Ok(once.iter().zip(via_pixel).map(gain).collect())
}

/// What the view sees of each light by place, in X, Y and Z; `None` below other layers than a diffuser.
fn responses(
    setup: &Setup,
    pitch_mm: [f64; 2],
    digits: f64,
) -> Result<Option<Vec<LobeResponse>>, DisplayError> {
    let Some(panel) = setup.stack.panel().filter(|panel| is_covered(panel)) else { return Ok(None) };
    let Some(view) = setup.views.first() else { return Ok(Some(Vec::new())) };
    setup.refracts()?;
    setup.placed()?;
    let level = Level {
        digits,
        most_per_mm: 1.0 / pitch_mm[0].min(pitch_mm[1]),
        is_fine: digits > 10.0,
        is_other: false,
        finer: 0,
    };
    let lit = Lit { panel, view, level, spread: None };
    let lights = Meter::new(setup).pixel_lights().into_iter().filter(PixelLight::is_seen);
    lights
        .map(|light| lobe::of_quantities(lit, &setup.sources[light.source], &light.weights))
        .collect::<Result<_, _>>()
        .map(Some)
}

/// Whether a lobe spreads the light of pixels with a known reflectance.
fn is_covered(panel: &Panel) -> bool {
    matches!(panel.top, Top::Diffuser(_)) && !matches!(panel.base.reflector, Reflector::Scattering(_))
}
