//! `papilio mtf` by Monte Carlo: all layers and lights of the [walk with places](super::walk), with standard
//! errors.
//!
//! The kernel of a state is the response of all orders to a small change at a place: for mirror-like pixels
//! below a lobe it is the light of the state itself. Each source has its Y. Errors are those of a jackknife:
//! each number is computed with each of the replicates left out in turn.

mod fixed;
mod sums;

use num_complex::Complex64;
use papilio_optics::Beta;
use papilio_transport::Source;
use papilio_transport::spatial::Peak;
use papilio_transport::walk::places::{CellGrid, Estimate, KernelTally, Shape, TwoStates};

use super::measured::Measured;
use super::mtf::Frame;
use super::patterns::Pattern;
use super::profile::{cumulative, places, radii};
use super::response::name_of_light;
use super::walk::{Placed, States, mean};
use super::{Curves, Kernel, LineContrast, MtfState, MtfView, PatternKind, PatternMean, SpatialScalars};
use crate::DisplayError;
use crate::meter::jackknife;
use crate::result::Named;
use crate::run::{Control, PILOT, Round, missed, paths_from_round, until};
use crate::scene::Stop;
use crate::setup::ViewPoint;
use fixed::Fixed;
use sums::Sums;

/// Most paths of a view.
const MOST_PATHS: u64 = 1 << 24;

/// `f50` is searched up to this multiple of the highest frequency.
const SEARCHED: f64 = 8.0;

/// Extent of tables of places, in thicknesses of all layers.
const EXTENT: f64 = 20.0;

/// Width about the view's own ray and the mirror rays of lamps in which tables are dense, in heights above the pixels of
/// each interface: what is below it spreads light by some of its height. At most this part of the smallest radius
/// that has half of the light of a state, which the round before found.
const DENSE: f64 = 0.03;
const OF_RADIUS: f64 = 0.3;

/// Places on each side of such a width.
const PER_SIDE: usize = 80;

/// Distance from the view's own ray, in thicknesses, within which a table has all light of a sharp image.
const SHARP: f64 = 1e-6;

/// Cells of the kernel along each axis: an odd number, so that the view's own ray is in the middle of one.
const CELLS: usize = 65;

/// What is tallied in a view.
struct Grid {
    /// Sources with light: their numbers and names.
    lights: Vec<(usize, String)>,
    frequencies: Vec<f64>,
    places: [Vec<f64>; 2],
    radii: Vec<f64>,
    cells: CellGrid,
}

/// What is computed of a view, from all replicates or all but one.
struct Found {
    measured: Measured,
    /// Light of the cells, as fractions; `[state][cell]`.
    cells: Vec<Vec<f64>>,
    scalars: Vec<SpatialScalars>,
    line_contrast: [LineContrast; 2],
    text_contrast: [Option<[f64; 2]>; 2],
    yule_nielsen_n: Option<f64>,
}

/// Computes how sharp the display is in a view, given by its number.
///
/// # Errors
/// If paths cannot be traced, the stopping rule is that of a metric, or the computation was stopped.
pub(super) fn view(
    frame: &Frame<'_>,
    panel: &Placed<'_>,
    number: usize,
    control: &Control<'_>,
) -> Result<MtfView, DisplayError> {
    let (view, stop) = (&frame.setup.views[number], &frame.setup.scene.solver.stop);
    let fixed = Fixed::new(frame);
    let passes = 1 + u64::from(fixed.is_some()) + frame.patterns().len() as u64;
    let before = panel.traced();
    // The round before finds the size of the picture of kernels, and where most light is.
    let (mut half_mm, mut half_of_light_mm) = (0.0, f64::INFINITY);
    let mut round = |paths: u64| {
        let grid = Grid::new(frame, panel, view, [half_mm, half_of_light_mm]);
        let left = paths_from_round(stop, paths, passes);
        let estimates =
            panel.with_share(before, left, control, |control| grid.kernels(panel, view, paths, control))?;
        let found = left_out(&grid, frame, panel, &estimates, &[], None);
        let r90 = found[0].scalars.iter().filter_map(|state| state.r90_um);
        half_mm = r90.map(|r90| 1.2e-3 * r90).fold(0.0, f64::max);
        let r50 = found[0].scalars.iter().filter_map(|state| state.r50_um).filter(|r50| *r50 > 0.0);
        half_of_light_mm = r50.map(|r50| 1e-3 * r50).fold(f64::INFINITY, f64::min);
        let (missed, means) = (missed(stop, largest_error(frame, &found))?, luminous_means(frame, &found));
        Ok(Round { found: (grid, estimates), missed, means })
    };
    if let Stop::Paths(_) = stop {
        round(PILOT)?;
    }
    let ((grid, estimates), paths) = until(stop, MOST_PATHS, round)?;
    let left = (passes - 1) * paths;
    let (images, patterns) = panel.with_share(before, Some(left), control, |control| {
        let images = match &fixed {
            Some(fixed) => panel.trace_states(view, States::Pattern(fixed), paths, control)?,
            None => Vec::new(),
        };
        Ok::<_, DisplayError>((images, pattern_means(frame, panel, view, paths, control)?))
    })?;
    let found = left_out(&grid, frame, panel, &estimates, &images, fixed.as_ref());
    Ok(result(frame, &grid, &found, patterns, view))
}

/// Largest error of a modulation transfer.
fn largest_error(frame: &Frame<'_>, found: &[Found]) -> f64 {
    let all = found[0].measured.names.len() - 1;
    let of_state = |state: usize| {
        [0, 1].into_iter().flat_map(move |axis| errors(found, |one| transfer(one, state, all, axis)))
    };
    (0..frame.setup.states.len()).flat_map(of_state).fold(0.0, f64::max)
}

/// Y of each state and its standard error.
fn luminous_means(frame: &Frame<'_>, found: &[Found]) -> Vec<(f64, f64)> {
    let of = |state: usize| {
        let y = |one: &Found| Some(one.measured.y(state));
        (found[0].measured.y(state), error(found, y).unwrap_or(0.0))
    };
    (0..frame.setup.states.len()).map(of).collect()
}

/// The numbers of all replicates, and then those with each left out.
fn left_out(
    grid: &Grid,
    frame: &Frame<'_>,
    panel: &Placed<'_>,
    kernels: &[Estimate],
    images: &[Estimate],
    fixed: Option<&Fixed>,
) -> Vec<Found> {
    let parts: Vec<Sums> = kernels.iter().map(|one| grid.sums(panel, one)).collect();
    let seen: Vec<Vec<f64>> = images
        .iter()
        .map(|one| {
            (0..one.rho[0].via_pixel.len() / panel.bins()).map(|k| panel.luminous(one, Some(k))).collect()
        })
        .collect();
    let faces: Vec<f64> = kernels.iter().map(|one| panel.luminous(one, None)).collect();
    let of = |left: Option<usize>| {
        let kept = |k: &usize| Some(*k) != left;
        let all = || (0..parts.len()).filter(kept);
        let weight = 1.0 / all().count() as f64;
        let mut sums = parts[0].zeros();
        all().for_each(|k| sums.add(&parts[k], weight));
        let faces = all().map(|k| weight * faces[k]).sum();
        let mut images = vec![0.0; seen.first().map_or(0, Vec::len)];
        for k in all().filter(|_| !seen.is_empty()) {
            images.iter_mut().zip(&seen[k]).for_each(|(sum, y)| *sum += weight * y);
        }
        grid.found(frame, &sums, faces, fixed.map(|fixed| (fixed, &images[..])))
    };
    std::iter::once(None).chain((0..parts.len()).map(Some)).map(of).collect()
}

impl Grid {
    /// `half_mm` is half of the side of the picture of kernels, at least that of four pixels; `half_of_light_mm` the smallest
    /// radius with half of the light of a state.
    fn new(
        frame: &Frame<'_>,
        panel: &Placed<'_>,
        view: &ViewPoint,
        [half_mm, half_of_light_mm]: [f64; 2],
    ) -> Self {
        let setup = frame.setup;
        let seen = panel.lights.iter().enumerate().filter(|(_, light)| light.is_seen());
        let lights = seen.map(|(number, light)| (number, name_of_light(setup, light)));
        let mut frequencies = frame.frequencies.clone();
        let highest = frequencies.last().copied().unwrap_or(1.0);
        while let Some(last) = frequencies.last().filter(|last| **last < SEARCHED * highest) {
            frequencies.push(last * 1.12);
        }
        let thickness = panel.stack.thickness_mm();
        let own = view.field.axis_towards();
        let beams = setup.sources.iter().filter_map(Source::direction);
        let from = panel.displacements(own);
        let narrow = OF_RADIUS * half_of_light_mm;
        let at = |beta: Beta| {
            let to = panel.displacements(beta);
            let peak = |k: usize| {
                let (height_mm, [x, y]) = to[k];
                let [own_x, own_y] = from[k].1;
                let width_mm = (DENSE * height_mm).min(narrow).max(1e-6);
                Peak { at_mm: [x - own_x, y - own_y], width_mm }
            };
            (0..to.len()).filter(|k| to[*k].0 > 0.0).map(peak).collect::<Vec<_>>()
        };
        let peaks: Vec<Peak> = std::iter::once(own).chain(beams).flat_map(at).collect();
        let extent = (EXTENT * thickness).max(1e-3);
        let sharp = [-SHARP, SHARP].map(|side| side * extent);
        let borders = |axis: usize| places((&peaks, PER_SIDE), axis, extent, &sharp);
        let radii = radii((&peaks, PER_SIDE), extent, &[], SHARP * extent);
        let pixels = frame.pitch_mm.map_or(0.0, |pitch| 2.0 * pitch[0].max(pitch[1]));
        let half = if half_mm.max(pixels) > 0.0 { half_mm.max(pixels) } else { thickness.max(1e-3) };
        Self {
            lights: lights.collect(),
            frequencies,
            places: [borders(0), borders(1)],
            radii,
            cells: CellGrid {
                count: [CELLS; 2],
                corner_mm: [-half; 2],
                cell_mm: [2.0 * half / CELLS as f64; 2],
            },
        }
    }

    fn kernels(
        &self,
        panel: &Placed<'_>,
        view: &ViewPoint,
        paths: u64,
        control: &Control<'_>,
    ) -> Result<Vec<Estimate>, DisplayError> {
        let along =
            |axis: usize| self.frequencies.iter().map(move |f| if axis == 0 { [*f, 0.0] } else { [0.0, *f] });
        let tally = KernelTally {
            frequencies_per_mm: along(0).chain(along(1)).collect(),
            cells: Some(self.cells),
            strips_mm: self.places.clone(),
            rings_mm: self.radii.clone(),
            channels: panel.channels(),
        };
        panel.trace_states(view, States::Kernel(tally), paths, control)
    }

    /// Sums of a replicate over the sources with light.
    fn sums(&self, panel: &Placed<'_>, estimate: &Estimate) -> Sums {
        let lights = self.lights.iter().map(|(number, _)| {
            let [_, weights, _] = &panel.lights[*number].weights;
            (&weights[..], &estimate.rho[*number], &estimate.spreads[*number].response)
        });
        Sums::new(lights, panel.setup.states.len(), self.frequencies.len())
    }

    fn found(&self, frame: &Frame<'_>, sums: &Sums, faces: f64, fixed: Option<(&Fixed, &[f64])>) -> Found {
        let names = self.lights.iter().map(|(_, name)| name.clone()).chain(["all".to_owned()]);
        let measured = Measured {
            names: names.collect(),
            frequencies: self.frequencies.clone(),
            places: self.places.clone(),
            radii: self.radii.clone(),
            lights: sums.lights(),
            line_contrast: [LineContrast::default(); 2],
            text_contrast: [None; 2],
            patterns: Vec::new(),
            from_faces: faces,
            seen: Vec::new(),
        };
        Found {
            scalars: (0..frame.setup.states.len()).map(|state| frame.scalars(state, &measured)).collect(),
            cells: sums.cells(),
            line_contrast: [faces, 0.0].map(|faces| {
                fixed.map_or_else(LineContrast::default, |(fixed, y)| fixed.line_contrast(y, faces))
            }),
            text_contrast: [faces, 0.0]
                .map(|faces| fixed.and_then(|(fixed, y)| fixed.text_contrast(y, faces))),
            yule_nielsen_n: fixed.and_then(|(fixed, y)| fixed.yule_nielsen(y)),
            measured,
        }
    }
}

/// Transfer of a state in a light relative to that at frequency 0, at the frequencies of results and beyond.
fn transfer(found: &Found, state: usize, light: usize, axis: usize) -> Vec<Complex64> {
    let transfer = &found.measured.lights[state][light].transfer[axis];
    let zero = transfer[0].re;
    transfer.iter().map(|value| if zero > 0.0 { value / zero } else { Complex64::ZERO }).collect()
}

/// Standard errors of complex numbers: of their distance from the mean.
fn errors(found: &[Found], of: impl Fn(&Found) -> Vec<Complex64>) -> Vec<f64> {
    let all: Vec<Vec<Complex64>> = found[1..].iter().map(of).collect();
    let part = |k: usize, part: fn(&Complex64) -> f64| {
        jackknife(&mut all.iter().map(|one| Some(part(&one[k])))).unwrap_or(0.0)
    };
    (0..all[0].len()).map(|k| part(k, |value| value.re).hypot(part(k, |value| value.im))).collect()
}

/// Standard error of a number that may be undefined.
fn error(found: &[Found], of: impl Fn(&Found) -> Option<f64>) -> Option<f64> {
    jackknife(&mut found[1..].iter().map(of))
}

/// Means of the patterns of the scene, each by a walk of its own.
fn pattern_means(
    frame: &Frame<'_>,
    panel: &Placed<'_>,
    view: &ViewPoint,
    paths: u64,
    control: &Control<'_>,
) -> Result<Vec<PatternMean>, DisplayError> {
    let of_pattern = |Pattern { kind, period_mm, states }: Pattern| {
        let shape = match kind {
            PatternKind::Stripes => Shape::Stripes,
            PatternKind::Checkerboard => Shape::Checkerboard,
        };
        let pattern = TwoStates { shape, period_mm, states };
        let estimates = panel.trace_states(view, States::Pattern(&pattern), paths, control)?;
        let y = mean(estimates.iter().map(|one| panel.luminous(one, Some(0))));
        let faces = mean(estimates.iter().map(|one| panel.luminous(one, None)));
        Ok(PatternMean {
            theta_deg: view.theta_deg,
            phi_deg: view.phi_deg,
            kind,
            period_mm,
            mean_Y: y.value + faces.value,
            mean_Y_via_pixel: y.value,
            error: y.standard_error.hypot(faces.standard_error),
        })
    };
    frame.patterns().into_iter().map(of_pattern).collect()
}

fn result(
    frame: &Frame<'_>,
    grid: &Grid,
    found: &[Found],
    patterns: Vec<PatternMean>,
    view: &ViewPoint,
) -> MtfView {
    let states = frame.setup.states.iter().enumerate();
    let all = &found[0];
    MtfView {
        theta_deg: view.theta_deg,
        phi_deg: view.phi_deg,
        states: Named(
            states.map(|(state, name)| (name.clone(), state_of(frame, grid, found, state))).collect(),
        ),
        line_contrast: all.line_contrast[0],
        line_contrast_via_pixel: all.line_contrast[1],
        line_contrast_error: line_errors(found, 0),
        line_contrast_via_pixel_error: line_errors(found, 1),
        text_contrast_min: all.text_contrast[0].map(|[least, _]| least),
        text_contrast_median: all.text_contrast[0].map(|[_, median]| median),
        text_contrast_min_via_pixel: all.text_contrast[1].map(|[least, _]| least),
        text_contrast_median_via_pixel: all.text_contrast[1].map(|[_, median]| median),
        text_contrast_error: text_errors(found, 0),
        text_contrast_via_pixel_error: text_errors(found, 1),
        yule_nielsen_n: all.yule_nielsen_n,
        patterns,
    }
}

/// Errors of contrasts, if `via` is 1 of those via the pixel.
fn line_errors(found: &[Found], via: usize) -> LineContrast {
    let mut errors = LineContrast::default();
    for (k, slot) in errors.all_mut().enumerate() {
        *slot = error(found, |one| one.line_contrast[via].named().nth(k).and_then(|(_, value)| value));
    }
    errors
}

fn text_errors(found: &[Found], via: usize) -> Option<[f64; 2]> {
    let [least, median] = [0, 1].map(|k| error(found, |one| one.text_contrast[via].map(|pair| pair[k])));
    least.zip(median).map(|(least, median)| [least, median])
}

fn state_of(frame: &Frame<'_>, grid: &Grid, found: &[Found], state: usize) -> MtfState {
    let all = &found[0];
    let lights = grid.lights.len();
    let count = frame.frequencies.len();
    let curves = |light: usize| {
        let y = all.measured.y(state);
        let parts = |axis: usize| {
            transfer(all, state, light, axis)[..count].iter().map(|value| [value.re, value.im]).collect()
        };
        let errors = |axis: usize| {
            let mut errors = errors(found, |one| transfer(one, state, light, axis));
            errors.truncate(count);
            errors
        };
        let fraction = all.measured.lights[state][light].transfer[0][0].re / y;
        Curves {
            fraction: if y > 0.0 { fraction } else { 0.0 },
            otf_x: parts(0),
            otf_y: parts(1),
            error_x: errors(0),
            error_y: errors(1),
        }
    };
    let mut scalar_errors = SpatialScalars::default();
    for (k, slot) in scalar_errors.all_mut().enumerate() {
        *slot = error(found, |one| one.scalars[state].named().nth(k).and_then(|(_, value)| value));
    }
    frame.add_between_of_paths(&mut scalar_errors, state, &all.measured);
    let tables = (0..=lights).flat_map(|light| [0, 1].map(|axis| (light, axis)));
    let tables = tables.map(|(light, axis)| {
        let mut table = all.measured.table(&all.measured, state, light, axis);
        let edge = |one: &Found| -> Vec<Complex64> {
            let edge = cumulative(&one.measured.lights[state][light].strips[axis]);
            edge.into_iter().map(Complex64::from).collect()
        };
        table.error = errors(found, edge);
        table
    });
    let cells = all.cells[state].clone();
    MtfState {
        Y_via_pixel: all.measured.y(state),
        Y_via_pixel_error: error(found, |one| Some(one.measured.y(state))).unwrap_or(0.0),
        scalars: all.scalars[state],
        error: scalar_errors,
        otf: curves(lights),
        by_light: Named(
            (0..lights).map(|light| (all.measured.names[light].clone(), curves(light))).collect(),
        ),
        spread: tables.collect(),
        kernel: Kernel {
            cell_um: 1e3 * grid.cells.cell_mm[0],
            cells: CELLS,
            outside: 1.0 - cells.iter().sum::<f64>(),
            fractions: cells,
        },
    }
}
