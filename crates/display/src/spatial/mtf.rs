//! `papilio mtf`: modulation transfer, spread and the contrast of fine lines.
//!
//! Every number is computed at two levels of discretisation; the finer one is the result, the difference its error.

use std::sync::atomic::{AtomicUsize, Ordering};

use num_complex::Complex64;
use papilio_colour::reader::{contrast_sensitivity, square_root_integral};

use super::patterns::{self, Pattern};
use super::profile::{crossing, cumulative, density, interpolated, places};
use super::response::responses;
use super::{
    Curves, Kernel, Level, MtfResult, MtfState, MtfView, PatternKind, PatternMean, Patterns, Seen,
    SpatialScalars, SpreadTable,
};
use crate::DisplayError;
use crate::meter::Meter;
use crate::metrics::LineContrast;
use crate::result::Named;
use crate::run::{Control, Progress, Workers, each};
use crate::scene::Scene;
use crate::setup::{Setup, ViewPoint};

/// Natural digits of the two levels.
const DIGITS: [f64; 2] = [8.0, 11.0];

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

/// Extent of tables of places, in thicknesses.
const EXTENT: f64 = 20.0;

/// Cells of the kernel along each axis: an odd number, so that the view's own ray is in the middle of one.
const CELLS: usize = 65;

/// Distance from a sharp image, in thicknesses, within which a table has all of its light.
const SHARP: f64 = 1e-6;

/// Field of view of the square-root integral, degrees.
const FIELD_DEG: f64 = 10.0;

/// Widths of lines, pixels.
const LINES: [f64; 3] = [1.0, 2.0, 4.0];

/// Computes how sharp the display is in each view.
///
/// # Errors
/// If the scene is invalid, a length is missing, its kind of display or light is not covered, or the computation was stopped.
pub fn mtf(scene: &Scene, patterns: &Patterns, control: &Control<'_>) -> Result<MtfResult, DisplayError> {
    let setup = Setup::new(scene)?;
    let frame = Frame::new(&setup, patterns)?;
    let mut workers = None;
    let pool =
        if setup.views.len() == 1 { None } else { Workers::unless_one(&mut workers, control.threads)? };
    let done = AtomicUsize::new(0);
    let mut numbers: Vec<usize> = (0..setup.views.len()).collect();
    let views = each(pool, &mut numbers, |(_, number)| {
        if control.stopped() {
            return Err(DisplayError::Interrupted);
        }
        let view = frame.view(&setup.views[*number])?;
        (control.progress)(Progress::of_views(done.fetch_add(1, Ordering::Relaxed) + 1, setup.views.len()));
        Ok(view)
    });
    let views = views.into_iter().collect::<Result<Vec<MtfView>, _>>()?;
    let errors = views
        .iter()
        .flat_map(|view| view.states.iter())
        .flat_map(|(_, state)| state.otf.error_x.iter().chain(&state.otf.error_y).copied());
    let error_reached = errors.fold(0.0, f64::max);
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
        warnings: Vec::new(),
    })
}

/// What all views have in common.
struct Frame<'a> {
    setup: &'a Setup,
    patterns: &'a Patterns,
    thickness_mm: f64,
    pitch_mm: Option<[f64; 2]>,
    nyquist_per_mm: Option<[f64; 2]>,
    mm_per_degree: f64,
    luminance_of_white: f64,
    eye_limit_per_mm: Option<f64>,
    frequencies: Vec<f64>,
}

/// Light of one state by frequency and place, from one light or all.
struct Light {
    /// `[axis][frequency]`; those beyond the frame's frequencies serve `f50`.
    transfer: [Vec<Complex64>; 2],
    /// `[axis][bin]`.
    strips: [Vec<f64>; 2],
    rings: Vec<f64>,
}

/// Everything that is computed at one level.
struct Measured {
    names: Vec<String>,
    frequencies: Vec<f64>,
    /// Borders of strips, mm, `[axis]`, and of rings.
    places: [Vec<f64>; 2],
    radii: Vec<f64>,
    /// `[state][light]`, the last light being all.
    lights: Vec<Vec<Light>>,
    line_contrast: [LineContrast; 2],
    /// Smallest and median contrast of text.
    text_contrast: [Option<[f64; 2]>; 2],
    /// Mean of each pattern via the pixel.
    patterns: Vec<f64>,
    from_faces: f64,
    seen: Vec<Seen>,
}

impl<'a> Frame<'a> {
    fn new(setup: &'a Setup, patterns: &'a Patterns) -> Result<Self, DisplayError> {
        let scene = &setup.scene;
        let lengths = scene.display.lengths_mm()?;
        let pitch_mm = scene.display.matrix.as_ref().map(|matrix| matrix.pitch_mm);
        let nyquist_per_mm = pitch_mm.map(|pitch| pitch.map(|p| 0.5 / p));
        let mm_per_degree = scene.viewer.distance_mm * 1.0_f64.to_radians().tan();
        let luminance_of_white = Meter::new(setup).luminance_of_white();
        let highest = nyquist_per_mm
            .map_or(EYE_CYCLES_PER_DEGREE / mm_per_degree, |nyquist| 2.0 * nyquist[0].max(nyquist[1]));
        let mut frequencies = vec![0.0, highest];
        frequencies.extend(nyquist_per_mm.into_iter().flatten());
        // Images of a lamp make the curve swing: as many points as a figure needs.
        frequencies.extend((1..UNIFORM).map(|k| highest * f64::from(k) / f64::from(UNIFORM)));
        let decades = LOWEST_PER_MM.log10() as i32..=highest.log10().ceil() as i32;
        let all = decades.flat_map(|decade| PREFERRED.map(|number| number * 10.0_f64.powi(decade)));
        frequencies.extend(all.filter(|f| *f < highest * (1.0 - 1e-9)));
        frequencies.sort_by(f64::total_cmp);
        frequencies.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * *b);
        Ok(Self {
            setup,
            patterns,
            thickness_mm: lengths.last().copied().unwrap_or_default(),
            pitch_mm,
            nyquist_per_mm,
            mm_per_degree,
            luminance_of_white,
            eye_limit_per_mm: eye_limit(luminance_of_white).map(|limit| limit / mm_per_degree),
            frequencies,
        })
    }

    fn highest(&self) -> f64 {
        self.frequencies.last().copied().unwrap_or_default()
    }

    fn view(&self, view: &ViewPoint) -> Result<MtfView, DisplayError> {
        // As far as the sharpest feature has contrast.
        let draft = Level { digits: 4.0, most_per_mm: LOWEST_PER_MM };
        let (seen, _) = responses(self.setup, view, draft)?;
        let widths = seen.iter().flat_map(|seen| seen.response.peaks()).map(|peak| peak.width_mm);
        let sharpest = widths.fold(f64::INFINITY, f64::min);
        // Half of the modulation is lost between 0.11 (diffuse light) and 0.4 cycles (the mirror image of a beam) in a width.
        let [first, last] = [0.1, 0.45].map(|cycles| cycles / sharpest);
        let searched = SEARCHED * self.highest();
        let most_per_mm =
            if first > searched { self.highest() } else { last.clamp(self.highest(), searched) };
        let at = |digits: f64| self.measure(view, Level { digits, most_per_mm });
        let (coarse, fine) = (at(DIGITS[0])?, at(DIGITS[1])?);
        let states = self.setup.states.iter().enumerate();
        let states = states.map(|(state, name)| (name.clone(), self.state(state, &coarse, &fine)));
        let states = states.collect::<Vec<_>>();
        let mut error = fine.line_contrast[0];
        let pairs = error.all_mut().zip(coarse.line_contrast[0].named());
        pairs.for_each(|(fine, (_, coarse))| *fine = difference(*fine, coarse));
        Ok(MtfView {
            theta_deg: view.theta_deg,
            phi_deg: view.phi_deg,
            states: Named(self.with_kernels(states, &fine)),
            line_contrast: fine.line_contrast[0],
            line_contrast_via_pixel: fine.line_contrast[1],
            line_contrast_error: error,
            text_contrast_min: fine.text_contrast[0].map(|[least, _]| least),
            text_contrast_median: fine.text_contrast[0].map(|[_, median]| median),
            text_contrast_min_via_pixel: fine.text_contrast[1].map(|[least, _]| least),
            text_contrast_median_via_pixel: fine.text_contrast[1].map(|[_, median]| median),
            text_contrast_error: fine.text_contrast[0]
                .zip(coarse.text_contrast[0])
                .map(|(fine, coarse)| [0, 1].map(|k| (fine[k] - coarse[k]).abs())),
            yule_nielsen_n: self.yule_nielsen(&fine, Level { digits: DIGITS[1], most_per_mm }),
            patterns: self.pattern_means(view, &coarse, &fine),
        })
    }

    fn measure(&self, view: &ViewPoint, level: Level) -> Result<Measured, DisplayError> {
        let (seen, from_faces) = responses(self.setup, view, level)?;
        let mut frequencies = self.frequencies.clone();
        while let Some(last) = frequencies.last().filter(|last| **last < level.most_per_mm) {
            frequencies.push(last * 1.12);
        }
        frequencies.truncate(frequencies.partition_point(|f| *f <= level.most_per_mm));
        let extent = EXTENT * self.thickness_mm;
        let peaks: Vec<_> = seen.iter().flat_map(|seen| seen.response.peaks()).collect();
        let images: Vec<[f64; 2]> = seen.iter().flat_map(|seen| seen.response.images()).collect();
        let borders = |axis: usize| {
            let halves = self.lines(axis).flat_map(|width| [-0.5 * width, 0.5 * width]);
            // A table resolves a sharp image by places close to it.
            let sharp =
                images.iter().flat_map(|at| [-SHARP, SHARP].map(|side| at[axis] + side * self.thickness_mm));
            places(&peaks, axis, extent, &halves.chain(sharp).collect::<Vec<_>>())
        };
        let places = [borders(0), borders(1)];
        let own: Vec<_> = peaks.iter().copied().take(1).collect();
        let mut radii = self::places(&own, 0, extent, &[SHARP * self.thickness_mm]);
        radii.retain(|radius| *radius > 0.0);
        let mut lights: Vec<Vec<Light>> = self.setup.states.iter().map(|_| Vec::new()).collect();
        for seen in &seen {
            let response = &seen.response;
            let transfers = [0, 1].map(|axis| -> Vec<Vec<Complex64>> {
                let along = |f: f64| if axis == 0 { [f, 0.0] } else { [0.0, f] };
                frequencies.iter().map(|f| response.transfer(along(*f))).collect()
            });
            let strips = [0, 1].map(|axis| response.strips(axis, &places[axis]));
            let rings = response.rings(&radii);
            for (state, lights) in lights.iter_mut().enumerate() {
                lights.push(Light {
                    transfer: [0, 1].map(|axis| transfers[axis].iter().map(|all| all[state]).collect()),
                    strips: [0, 1].map(|axis| strips[axis][state].clone()),
                    rings: rings[state].clone(),
                });
            }
        }
        for lights in &mut lights {
            let all = sum(lights);
            lights.extend(all);
        }
        let names = seen.iter().map(|seen| seen.light.clone()).chain(["all".to_owned()]).collect();
        let mut measured = Measured {
            names,
            frequencies,
            places,
            radii,
            lights,
            line_contrast: [LineContrast::default(); 2],
            text_contrast: [None; 2],
            patterns: Vec::new(),
            from_faces,
            seen,
        };
        measured.line_contrast = [from_faces, 0.0].map(|faces| self.line_contrast(&measured, level, faces));
        measured.text_contrast = self.text_contrast(&measured, level);
        measured.patterns =
            self.patterns().iter().map(|pattern| patterns::mean(&measured.seen, *pattern, level)).collect();
        Ok(measured)
    }

    /// Widths of lines across an axis, mm; none without a matrix.
    fn lines(&self, axis: usize) -> impl Iterator<Item = f64> + use<> {
        let pitch = self.pitch_mm.map(|pitch| pitch[axis]);
        pitch.into_iter().flat_map(|pitch| LINES.map(|pixels| pixels * pitch))
    }

    fn number(&self, state: &str) -> Option<usize> {
        self.setup.states.iter().position(|name| name == state)
    }

    /// The patterns of the scene; none if it has not their states.
    fn patterns(&self) -> Vec<Pattern> {
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

    /// Smallest and median contrast of the strokes of text, with the images of the room in flat faces and without.
    fn text_contrast(&self, measured: &Measured, level: Level) -> [Option<[f64; 2]>; 2] {
        let (Some(pitch), Some(white), Some(black)) =
            (self.pitch_mm, self.number("white"), self.number("black"))
        else {
            return [None; 2];
        };
        let text = &self.patterns.text;
        let bitmap = patterns::bitmap(&self.setup.scene, text, pitch, self.thickness_mm);
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

    fn pattern_means(&self, view: &ViewPoint, coarse: &Measured, fine: &Measured) -> Vec<PatternMean> {
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
    fn yule_nielsen(&self, fine: &Measured, level: Level) -> Option<f64> {
        let states = [self.number("white")?, self.number("black")?];
        let pattern = Pattern { kind: PatternKind::Stripes, period_mm: 0.0, states };
        patterns::yule_nielsen(states.map(|state| fine.y(state)), patterns::mean(&fine.seen, pattern, level))
    }

    fn line_contrast(&self, measured: &Measured, level: Level, from_faces: f64) -> LineContrast {
        let mut contrast = LineContrast::default();
        let (Some(white), Some(black)) = (self.number("white"), self.number("black")) else {
            return contrast;
        };
        let mut found = Vec::new();
        for axis in [0, 1] {
            for (line, surround) in [(white, black), (black, white)] {
                for width in self.lines(axis) {
                    let [middle, far] = measured.line(level, [line, surround], axis, width);
                    let [middle, far] = [middle, far].map(|y| y + from_faces);
                    found.push(((middle - far) / (middle + far)).abs());
                }
            }
        }
        contrast.all_mut().zip(found).for_each(|(slot, value)| *slot = Some(value));
        contrast
    }

    fn state(&self, state: usize, coarse: &Measured, fine: &Measured) -> MtfState {
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
            scalars,
            error,
            otf: curves(all),
            by_light: Named(by_light),
            spread: tables.collect(),
            kernel: Kernel { cell_um: 0.0, cells: CELLS, outside: 0.0, fractions: Vec::new() },
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

    fn scalars(&self, state: usize, measured: &Measured) -> SpatialScalars {
        let all = measured.lights[state].last().filter(|_| measured.y(state) > 0.0);
        let Some(all) = all else { return SpatialScalars::default() };
        let modulus = [0, 1].map(|axis| -> Vec<f64> {
            let zero = all.transfer[axis][0].norm();
            all.transfer[axis].iter().map(|value| value.norm() / zero).collect()
        });
        let f50 = |axis: usize| {
            let lost: Vec<f64> = modulus[axis].iter().map(|m| 1.0 - m).collect();
            crossing(&measured.frequencies, &lost, 0.5)
        };
        let nyquist = |axis: usize| {
            self.nyquist_per_mm
                .map(|nyquist| interpolated(&measured.frequencies, &modulus[axis], nyquist[axis]))
        };
        let edge = |axis: usize| {
            let edge = cumulative(&all.strips[axis]);
            let at = |share: f64| crossing(&measured.places[axis], &edge, share);
            Some(1e3 * (at(0.9)? - at(0.1)?))
        };
        let rings = cumulative(&all.rings);
        let radius = |share: f64| {
            if rings.first().is_some_and(|sharp| *sharp >= share) {
                return Some(0.0);
            }
            crossing(&measured.radii, &rings, share).map(|radius| 1e3 * radius)
        };
        let luminance = measured.y(state) * self.luminance_of_white;
        let sqri = |axis: usize| {
            let most = self.nyquist_per_mm.map(|nyquist| nyquist[axis]).or(self.eye_limit_per_mm)?;
            let transfer =
                |u: f64| interpolated(&measured.frequencies, &modulus[axis], u / self.mm_per_degree);
            square_root_integral(transfer, luminance, FIELD_DEG, most * self.mm_per_degree)
        };
        SpatialScalars {
            f50_x_per_mm: f50(0),
            f50_y_per_mm: f50(1),
            mtf_nyquist_x: nyquist(0),
            mtf_nyquist_y: nyquist(1),
            edge_10_90_x_um: edge(0),
            edge_10_90_y_um: edge(1),
            r50_um: radius(0.5),
            r90_um: radius(0.9),
            sqri_jnd_x: sqri(0),
            sqri_jnd_y: sqri(1),
        }
    }

    /// Adds the pictures of the kernels, all of the same size: as wide as 90 % of the light of any state, and at least four pixels.
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

impl Measured {
    /// Y of a state via the pixel.
    fn y(&self, state: usize) -> f64 {
        self.lights[state].last().map_or(0.0, |all| all.transfer[0][0].re)
    }

    /// Y of the middle of a line of one state on another, and far away, via the pixel.
    fn line(&self, level: Level, [line, surround]: [usize; 2], axis: usize, width_mm: f64) -> [f64; 2] {
        let far = self.y(surround);
        let all_orders: Option<Vec<f64>> =
            self.seen.iter().map(|seen| seen.response.line([line, surround], width_mm, level)).collect();
        if let Some(found) = all_orders {
            return [found.iter().sum(), far];
        }
        let inside = |state: usize| -> f64 {
            let Some(all) = self.lights[state].last() else { return 0.0 };
            let places = &self.places[axis];
            let bin = |at: f64| places.partition_point(|place| *place <= at);
            all.strips[axis][bin(-0.5 * width_mm)..bin(0.5 * width_mm - 1e-12) + 1].iter().sum()
        };
        [far - inside(surround) + inside(line), far]
    }

    fn table(&self, coarse: &Self, state: usize, light: usize, axis: usize) -> SpreadTable {
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
fn sum(lights: &[Light]) -> Option<Light> {
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

fn difference(fine: Option<f64>, coarse: Option<f64>) -> Option<f64> {
    Some((fine? - coarse?).abs())
}

/// Highest frequency at which the eye sees full contrast, cycles per degree.
fn eye_limit(luminance_cd_m2: f64) -> Option<f64> {
    let (mut low, mut high) = (5.0, 200.0);
    let sees = |u: f64| contrast_sensitivity(u, luminance_cd_m2, FIELD_DEG).map(|s| s >= 1.0);
    if !sees(low)? {
        return None;
    }
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if sees(middle)? { low = middle } else { high = middle }
    }
    Some(low)
}
