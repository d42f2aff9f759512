//! `papilio mtf`: modulation transfer, spread and the contrast of fine lines.
//!
//! Every number is computed at two levels of discretisation; the finer one is the result, the difference its
//! error. By Monte Carlo (`mtf_walk`), errors are standard errors.

use std::cell::OnceCell;

use num_complex::Complex64;

use super::below_layers;
use super::layered;
use super::measured::{Light, Measured};
use super::mtf_walk;
use super::patterns::too_large;
use super::response::responses;
use super::scalars::eye_limit;
use super::target::{missed_target, refined};
use super::walk::Placed;
use super::{Curves, Kernel, Level, MtfResult, MtfState, MtfView, Patterns, Refused, Sharpness};
use crate::DisplayError;
use crate::meter::Meter;
use crate::result::Named;
use crate::run::{Control, each_view, finest};
use crate::scene::{Method, Scene};
use crate::setup::{Setup, ViewPoint};

/// Natural digits of the first two levels, how many more each further level has, and the finest level.
const DIGITS: [f64; 2] = [9.0, 13.0];
const MORE_DIGITS: f64 = 4.0;
const MOST_LEVEL: usize = 3;

/// Lowest frequency, cycles per mm.
const LOWEST_PER_MM: f64 = 0.01;

/// Preferred numbers of a decade (ISO 3, R 20), and whole numbers.
const PREFERRED: [f64; 23] = [
    1.0, 1.12, 1.25, 1.4, 1.6, 1.8, 2.0, 2.24, 2.5, 2.8, 3.0, 3.15, 3.55, 4.0, 4.5, 5.0, 5.6, 6.0, 6.3, 7.0,
    7.1, 8.0, 9.0,
];

/// Number of uniform steps, besides the preferred numbers.
const UNIFORM: u32 = 24;

/// Without a matrix, frequencies end here, cycles per degree.
const EYE_CYCLES_PER_DEGREE: f64 = 60.0;

/// `f50` is searched up to this multiple of the highest frequency.
const SEARCHED: f64 = 8.0;

/// Cells of the kernel along each axis: an odd number, so that the view's own ray is in the middle of one.
const CELLS: usize = 65;

/// Computes how sharp the display is in each view.
///
/// # Errors
/// If the scene is invalid, a length is missing, its kind of display or light is not covered, or the
/// computation was stopped.
pub fn mtf(scene: &Scene, patterns: &Patterns, control: &Control<'_>) -> Result<MtfResult, DisplayError> {
    let paths = scene.solver.method == Method::MonteCarlo;
    if scene.display.filter().is_some() && !paths {
        return Err(Refused::SharpnessWithFilter.into());
    }
    let setup = Setup::of_places(scene, control)?;
    let frame = Frame::new(&setup, patterns, control)?;
    let placed = paths.then(|| Placed::new(&setup)).transpose()?;
    // Paths of one view run on all threads.
    let views = each_view(&setup, placed.is_some(), control, |number, control| match &placed {
        Some(placed) => mtf_walk::view(&frame, placed, number, control),
        None if setup.stack.panel().is_some() || below_layers::covers(&setup) => {
            frame.view(&setup.views[number], control)
        }
        None => frame.layered_view(&setup.views[number], control),
    })?;
    let error_reached =
        largest_error(views.iter().flat_map(|view| view.states.iter()).map(|(_, state)| state));
    if !error_reached.is_finite() {
        return Err(DisplayError::NotFinite);
    }
    Ok(MtfResult {
        cycles_per_degree: frame.frequencies.iter().map(|f| f * frame.mm_per_degree).collect(),
        frequency_per_mm: frame.frequencies,
        pitch_um: frame.pitch_mm.map(|pitch| pitch.map(|p| 1e3 * p)),
        nyquist_per_mm: frame.nyquist_per_mm,
        eye_limit_per_mm: frame.eye_limit_per_mm,
        error_reached,
        patterns: views.iter().flat_map(|view| view.patterns.iter().copied()).collect(),
        views,
        warnings: missed_target(scene, error_reached, "a modulation transfer")
            .into_iter()
            .chain(frame.pitch_mm.and_then(|pitch| too_large(scene, &patterns.text, pitch)))
            .collect(),
    })
}

/// Largest error of the modulation transfers of some states.
fn largest_error<'a>(states: impl Iterator<Item = &'a MtfState>) -> f64 {
    let errors = states.flat_map(|state| state.otf.error_x.iter().chain(&state.otf.error_y).copied());
    // Not a number stays one.
    errors.fold(0.0, crate::run::largest)
}

/// Computes the square-root integrals of the white of a display with a matrix in its only view. `None` where
/// the deterministic solver does not know them: without thickness, below a colour filter, or of a pixel that depends on azimuth.
///
/// # Errors
/// If the computation was stopped.
pub(crate) fn sharpness(setup: &Setup, control: &Control<'_>) -> Result<Option<Sharpness>, DisplayError> {
    let (scene, patterns) = (&setup.scene, Patterns::default());
    if scene.display.matrix.is_none() || scene.display.filter().is_some() {
        return Ok(None);
    }
    let Some(view) = setup.views.first() else { return Ok(None) };
    let measured = Frame::new(setup, &patterns, control).and_then(|frame| {
        let level = Level {
            digits: DIGITS[0],
            most_per_mm: frame.highest(),
            is_fine: false,
            is_other: false,
            finer: 0,
        };
        let has_response = setup.stack.panel().is_some() || below_layers::covers(setup);
        let measured =
            if has_response { frame.by_frequency(view, level) } else { frame.layered_by_frequency(view) };
        Ok(frame.sharpness(&measured?))
    });
    match measured {
        Err(
            DisplayError::MissingLength { .. }
            | DisplayError::Azimuth { .. }
            | DisplayError::PlacesNotComputed { .. }
            | DisplayError::PlacesByPaths { .. },
        ) => Ok(None),
        other => other,
    }
}

/// A level, with the coarser one that belongs to it.
struct Levelled {
    /// `None` if that is the level before.
    coarse: Option<Measured>,
    fine: Measured,
}

impl Levelled {
    fn coarse<'a>(&'a self, before: &'a Self) -> &'a Measured {
        self.coarse.as_ref().unwrap_or(&before.fine)
    }
}

/// What all views have in common.
pub(super) struct Frame<'a> {
    pub(super) setup: &'a Setup,
    pub(super) control: &'a Control<'a>,
    pub(super) patterns: &'a Patterns,
    pub(super) thickness_mm: f64,
    pub(super) pitch_mm: Option<[f64; 2]>,
    pub(super) nyquist_per_mm: Option<[f64; 2]>,
    pub(super) mm_per_degree: f64,
    pub(super) luminance_of_white: f64,
    pub(super) eye_limit_per_mm: Option<f64>,
    pub(super) frequencies: Vec<f64>,
}

impl<'a> Frame<'a> {
    fn new(setup: &'a Setup, patterns: &'a Patterns, control: &'a Control<'a>) -> Result<Self, DisplayError> {
        let scene = &setup.scene;
        let stack = match scene.solver.method {
            Method::MonteCarlo => setup.placed_by_direction()?,
            Method::Adding | Method::Auto => setup.placed()?,
        };
        let pitch_mm = scene.display.matrix.as_ref().map(|matrix| matrix.pitch_mm);
        let nyquist_per_mm = pitch_mm.map(|pitch| pitch.map(|p| 0.5 / p));
        let mm_per_degree = scene.viewer.distance_mm * 1.0_f64.to_radians().tan();
        let luminance_of_white = Meter::new(setup).luminance_of_white();
        let highest = nyquist_per_mm
            .map_or(EYE_CYCLES_PER_DEGREE / mm_per_degree, |nyquist| 2.0 * nyquist[0].max(nyquist[1]));
        let mut frequencies = vec![0.0, highest];
        frequencies.extend(nyquist_per_mm.into_iter().flatten());
        let general = setup.stack.panel().is_none() && scene.solver.method != Method::MonteCarlo;
        let below_layers = general.then(|| below_layers::covers(setup));
        frequencies.extend(if below_layers == Some(false) {
            layered::frequencies(highest)
        } else {
            uniform_and_preferred(highest)
        });
        frequencies.retain(|f| *f <= highest);
        frequencies.sort_by(f64::total_cmp);
        frequencies.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * *b);
        Ok(Self {
            setup,
            control,
            patterns,
            thickness_mm: match below_layers {
                Some(true) => stack.thickness_mm(),
                Some(false) | None => stack.layers().last().map_or(0.0, |glass| glass.thickness_mm),
            },
            pitch_mm,
            nyquist_per_mm,
            mm_per_degree,
            luminance_of_white,
            eye_limit_per_mm: eye_limit(luminance_of_white).map(|limit| limit / mm_per_degree),
            frequencies,
        })
    }

    pub(super) fn highest(&self) -> f64 {
        self.frequencies.last().copied().unwrap_or_default()
    }

    /// Highest frequency at which the sharpest feature of a view has contrast.
    fn reach(&self, view: &ViewPoint) -> Result<f64, DisplayError> {
        // As far as the sharpest feature has contrast.
        let draft =
            Level { digits: 4.0, most_per_mm: LOWEST_PER_MM, is_fine: false, is_other: false, finer: 0 };
        let (seen, _) = responses(self.setup, view, draft, self.control)?;
        let widths = seen.iter().flat_map(|seen| seen.response.peaks()).map(|peak| peak.width_mm);
        let sharpest = widths.fold(f64::INFINITY, f64::min);
        // Half of the modulation is lost between 0.11 (diffuse light) and 0.4 cycles (the mirror image of a
        // beam) in a width.
        let [first, last] = [0.1, 0.45].map(|cycles| cycles / sharpest);
        let searched = SEARCHED * self.highest();
        Ok(if first > searched { self.highest() } else { last.clamp(self.highest(), searched) })
    }

    fn view(&self, view: &ViewPoint, control: &Control<'_>) -> Result<MtfView, DisplayError> {
        // The tables of general layers serve all frequencies.
        let is_panel = self.setup.stack.panel().is_some();
        let most_per_mm = if is_panel { self.reach(view)? } else { SEARCHED * self.highest() };
        let digits = |level: usize| match level {
            0 => DIGITS[0],
            further => DIGITS[1] + MORE_DIGITS * (further - 1) as f64,
        };
        let borders = OnceCell::new();
        let at = |level: usize, is_fine: bool| {
            let level = Level { digits: digits(level), most_per_mm, is_fine, is_other: false, finer: 0 };
            self.measure(view, level, &borders)
        };
        // The coarse one of two levels uses simpler estimates: each further level has its own coarse one.
        let pair = |level: usize| {
            let coarse = (level > 1).then(|| at(level - 1, false)).transpose()?;
            Ok(Levelled { coarse, fine: at(level, level > 0)? })
        };
        let states = |coarse: &Measured, fine: &Measured| -> Vec<(String, MtfState)> {
            let states = self.setup.states.iter().enumerate();
            states.map(|(state, name)| (name.clone(), self.state(state, coarse, fine))).collect()
        };
        let (factor, finest) = match is_panel {
            true => (1.0, MOST_LEVEL),
            false => {
                let factor = layered::error_over_difference(self.setup);
                (factor, finest(self.setup)?.min(MOST_LEVEL))
            }
        };
        let error = |[finer, coarser]: [&Levelled; 2]| {
            let states = states(finer.coarse(coarser), &finer.fine);
            factor * largest_error(states.iter().map(|(_, state)| state))
        };
        let mut found = refined(self.setup, finest, pair, error, control)?;
        if factor != 1.0 {
            let coarse = found.finer.coarse.as_mut().unwrap_or(&mut found.coarser.fine);
            layered::widen(coarse, &found.finer.fine, factor);
        }
        let (digits, fine) = (digits(found.level), &found.finer.fine);
        let level = Level { digits, most_per_mm, is_fine: true, is_other: false, finer: 0 };
        let against = |coarse: &Measured| {
            let mut states = states(coarse, fine);
            for (number, (_, state)) in states.iter_mut().enumerate() {
                layered::widen_radii(&mut state.error, factor);
                self.add_between(&mut state.error, number, fine);
            }
            self.seen(view, states, coarse, fine)
        };
        let mut seen = against(found.finer.coarse(&found.coarser));
        if fine.seen.iter().any(|seen| seen.response.has_other_points()) {
            let other = self.measure(view, Level { is_other: true, ..level }, &borders)?;
            seen.widen_errors(&against(&other));
        }
        seen.states = Named(self.with_kernels(seen.states.0, fine));
        seen.yule_nielsen_n = self.yule_nielsen(fine, level);
        Ok(seen)
    }

    /// What is seen in a view at the finer of two levels, with the differences from the coarser one as errors; without pictures
    /// of kernels.
    fn seen(
        &self,
        view: &ViewPoint,
        states: Vec<(String, MtfState)>,
        coarse: &Measured,
        fine: &Measured,
    ) -> MtfView {
        let [line_contrast_error, line_contrast_via_pixel_error] = [0, 1].map(|k| {
            let mut error = fine.line_contrast[k];
            let pairs = error.all_mut().zip(coarse.line_contrast[k].named());
            pairs.for_each(|(fine, (_, coarse))| *fine = difference(*fine, coarse));
            error
        });
        let [text_contrast_error, text_contrast_via_pixel_error] = [0, 1].map(|k| {
            let both = fine.text_contrast[k].zip(coarse.text_contrast[k]);
            both.map(|(fine, coarse)| [0, 1].map(|k| (fine[k] - coarse[k]).abs()))
        });
        MtfView {
            theta_deg: view.theta_deg,
            phi_deg: view.phi_deg,
            states: Named(states),
            line_contrast: fine.line_contrast[0],
            line_contrast_via_pixel: fine.line_contrast[1],
            line_contrast_error,
            line_contrast_via_pixel_error,
            text_contrast_min: fine.text_contrast[0].map(|[least, _]| least),
            text_contrast_median: fine.text_contrast[0].map(|[_, median]| median),
            text_contrast_min_via_pixel: fine.text_contrast[1].map(|[least, _]| least),
            text_contrast_median_via_pixel: fine.text_contrast[1].map(|[_, median]| median),
            text_contrast_error,
            text_contrast_via_pixel_error,
            yule_nielsen_n: None,
            patterns: self.pattern_means(view, coarse, fine),
        }
    }

    pub(super) fn number(&self, state: &str) -> Option<usize> {
        self.setup.states.iter().position(|name| name == state)
    }

    pub(super) fn state(&self, state: usize, coarse: &Measured, fine: &Measured) -> MtfState {
        let scalars = self.scalars(state, fine);
        let mut error = scalars;
        let pairs = error.all_mut().zip(self.scalars(state, coarse).named());
        pairs.for_each(|(fine, (_, coarse))| *fine = difference(*fine, coarse));
        let all = fine.names.len() - 1;
        let curves = |light: usize| {
            self.curves([coarse, fine].map(|level| &level.lights[state][light]), fine.y(state))
        };
        let by_light = (0..all).map(|light| (fine.names[light].clone(), curves(light))).collect();
        let tables = (0..=all).flat_map(|light| [0, 1].map(|axis| fine.table(coarse, state, light, axis)));
        MtfState {
            Y_via_pixel: fine.y(state),
            Y_via_pixel_error: (fine.y(state) - coarse.y(state)).abs(),
            scalars,
            error,
            otf: curves(all),
            by_light: Named(by_light),
            spread: tables.collect(),
            kernel: Kernel { cell_um: 0.0, cells: 0, outside: 0.0, fractions: Vec::new() },
        }
    }

    fn curves(&self, [coarse, fine]: [&Light; 2], total: f64) -> Curves {
        let count = self.frequencies.len();
        let relative = |light: &Light, axis: usize| -> Vec<Complex64> {
            let zero = light.transfer[axis][0].re;
            light.transfer[axis][..count]
                .iter()
                .map(|value| if zero > 0.0 { value / zero } else { Complex64::ZERO })
                .collect()
        };
        let error = |axis: usize| {
            let pairs = relative(coarse, axis).into_iter().zip(relative(fine, axis));
            pairs.map(|(coarse, fine)| (coarse - fine).norm()).collect()
        };
        let parts = |axis: usize| relative(fine, axis).iter().map(|value| [value.re, value.im]).collect();
        Curves {
            fraction: if total > 0.0 { fine.transfer[0][0].re / total } else { 0.0 },
            otf_x: parts(0),
            otf_y: parts(1),
            error_x: error(0),
            error_y: error(1),
        }
    }

    /// Adds the pictures of the kernels, all of the same size: as wide as 90 % of the light of any state, and
    /// at least four pixels.
    fn with_kernels(&self, mut states: Vec<(String, MtfState)>, fine: &Measured) -> Vec<(String, MtfState)> {
        let pixels = self.pitch_mm.map_or(0.0, |pitch| 2.0 * pitch[0].max(pitch[1]));
        let r90 = states.iter().filter_map(|(_, state)| state.scalars.r90_um);
        let mut half = r90.map(|radius| 1.2e-3 * radius).fold(pixels, f64::max);
        if half <= 0.0 {
            half = self.thickness_mm;
        }
        let cell = 2.0 * half / CELLS as f64;
        let edges: Vec<f64> = (0..=CELLS).map(|k| k as f64 * cell - half).collect();
        let mut sums = vec![vec![0.0; CELLS * CELLS]; states.len()];
        for seen in &fine.seen {
            for (sum, cells) in sums.iter_mut().zip(seen.response.cells(&edges, &edges)) {
                sum.iter_mut().zip(cells).for_each(|(sum, cell)| *sum += cell);
            }
        }
        for ((_, state), mut sum) in states.iter_mut().zip(sums) {
            let total = if state.Y_via_pixel > 0.0 { state.Y_via_pixel } else { 1.0 };
            sum.iter_mut().for_each(|cell| *cell /= total);
            let outside = 1.0 - sum.iter().sum::<f64>();
            state.kernel = Kernel { cell_um: 1e3 * cell, cells: CELLS, outside, fractions: sum };
        }
        states
    }
}

/// Frequencies between 0 and the highest, cycles per mm. Images of a lamp make the curve swing: as many as a
/// figure needs.
fn uniform_and_preferred(highest: f64) -> Vec<f64> {
    let mut all: Vec<f64> = (1..UNIFORM).map(|k| highest * f64::from(k) / f64::from(UNIFORM)).collect();
    let decades = LOWEST_PER_MM.log10() as i32..=highest.log10().ceil() as i32;
    let preferred = decades.flat_map(|decade| PREFERRED.map(|number| number * 10.0_f64.powi(decade)));
    all.extend(preferred.filter(|f| *f < highest * (1.0 - 1e-9)));
    all
}

fn difference(fine: Option<f64>, coarse: Option<f64>) -> Option<f64> {
    Some((fine? - coarse?).abs())
}
