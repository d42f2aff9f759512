//! Where light leaves, by Monte Carlo: patterns and transfer functions of any layers, through all orders.
//!
//! The [walk with places](papilio_transport::walk::places) is unbiased for all displays and lights; it is the
//! reference for the deterministic results. Standard errors are those of [`REPLICATES`] independent
//! replicates, which run on the threads of the control.
//!
//! Luminous quantities are Y relative to a perfect white in the scene's light, as in
//! [`result`](crate::result).

mod below_filter;

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use papilio_optics::Beta;
use papilio_sampling::SampleStream;
use papilio_transport::spatial::displacement;
use papilio_transport::walk::places::{
    Entry, Estimate, FilterPlane, KernelTally, Pattern, PlacedWalk, Uniform, What,
};
use papilio_transport::{Base, Cone, Layer, Reflector, Source, Stack};

use self::below_filter::BelowFilter;
use super::Refused;
use crate::DisplayError;
use crate::meter::{Meter, PixelLight};
use crate::result::Named;
pub use crate::run::REPLICATES;
use crate::run::{Control, Progress, Workers, each};
use crate::scene::{Approximation, Scene};
use crate::setup::{Setup, ViewPoint};

/// A mean and its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// The mean over the replicates.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// What a view sees of a pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct PatternView {
    /// Inclination, degrees.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// Y of each image via the pixel.
    pub via_pixel: Vec<Mean>,
    /// Y of the images of the room in flat faces, and of other light that has not met the pixel.
    pub front: Mean,
}

/// Transfer functions of one view.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferView {
    /// Inclination, degrees.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// Each state of the pixel.
    pub states: Named<TransferState>,
}

/// Transfer functions of a state.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferState {
    /// Light that met the pixel once, in all light of the scene.
    pub once: Transfer,
    /// Response of all orders to a small change, in all light of the scene.
    pub response: Transfer,
}

/// Transfer function at the requested frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    /// Y at frequency 0.
    pub luminous: Mean,
    /// Real and imaginary part over Y at frequency 0.
    pub otf: Vec<[Mean; 2]>,
}

/// Computes what each view of the scene sees of a pattern of the pixel's states. `paths` is the number of
/// paths of a view.
///
/// # Errors
/// If the scene is invalid, a length is missing, its light or approximation has no place, or the computation
/// was stopped.
pub fn pattern(
    scene: &Scene,
    pattern: &dyn Pattern,
    paths: u64,
    control: &Control<'_>,
) -> Result<Vec<PatternView>, DisplayError> {
    Setup::has_no_filter(scene)?;
    let setup = Setup::of_places(scene, control)?;
    let panel = Placed::new(&setup)?;
    let of_view = |view: &ViewPoint| {
        let estimates = panel.trace(view, What::Pattern(pattern), paths, control)?;
        Ok(panel.seen(view, &estimates, pattern.images()))
    };
    panel.setup.views.iter().map(of_view).collect()
}

/// Computes Y of the states of a display with a colour filter in each view, as means over a period. `paths`
/// is the number of paths of a view.
///
/// # Errors
/// As [`pattern`]; if there is no filter.
pub fn filtered(scene: &Scene, paths: u64, control: &Control<'_>) -> Result<Vec<PatternView>, DisplayError> {
    let setup = Setup::of_places(scene, control)?;
    let panel = Placed::new(&setup)?;
    let of_view = |view: &ViewPoint| {
        let estimates = panel.filtered(view, paths, control)?;
        Ok(panel.seen(view, &estimates, setup.states.len()))
    };
    setup.views.iter().map(of_view).collect()
}

/// Computes the transfer functions of the states in each view of the scene. `paths` is the number of paths of
/// a view.
///
/// Frequencies are in the plane of the panel, cycles per mm; places relative to the view's own ray.
///
/// # Errors
/// As [`pattern`].
pub fn transfer(
    scene: &Scene,
    frequencies_per_mm: &[[f64; 2]],
    paths: u64,
    control: &Control<'_>,
) -> Result<Vec<TransferView>, DisplayError> {
    Setup::has_no_filter(scene)?;
    let setup = Setup::of_places(scene, control)?;
    let panel = Placed::new(&setup)?;
    let mut frequencies = vec![[0.0; 2]];
    frequencies.extend(frequencies_per_mm);
    let channels = panel.channels();
    let of_view = |view: &ViewPoint| {
        let tally = KernelTally {
            frequencies_per_mm: frequencies.clone(),
            channels: channels.clone(),
            ..KernelTally::default()
        };
        let estimates = panel.trace(view, What::Kernel(tally), paths, control)?;
        let states = panel.setup.states.iter().enumerate().map(|(state, name)| {
            let of_order = |response: bool| {
                let sums = estimates.iter().map(|estimate| {
                    let at = |k: usize| {
                        let all = estimate.spreads.iter().map(|spreads| {
                            let kernel = if response { &spreads.response } else { &spreads.once };
                            kernel.transfer[state * frequencies.len() + k]
                        });
                        all.fold([0.0; 2], |[re, im], value| [re + value.re, im + value.im])
                    };
                    (0..frequencies.len()).map(at).collect::<Vec<_>>()
                });
                transfer_of(&sums.collect::<Vec<_>>())
            };
            (name.clone(), TransferState { once: of_order(false), response: of_order(true) })
        });
        let states = Named(states.collect());
        Ok(TransferView { theta_deg: view.theta_deg, phi_deg: view.phi_deg, states })
    };
    panel.setup.views.iter().map(of_view).collect()
}

/// Ratios to the first frequency, 0, by replicate.
fn transfer_of(sums: &[Vec<[f64; 2]>]) -> Transfer {
    let luminous = mean(sums.iter().map(|sum| sum[0][0]));
    let count = sums.first().map_or(1, Vec::len);
    let ratio = |k: usize, part: usize| {
        let of_all = mean(sums.iter().map(|sum| sum[k][part])).value / luminous.value;
        // The error of a ratio is that of its numerator less the ratio times its denominator.
        let rest = mean(sums.iter().map(|sum| (sum[k][part] - of_all * sum[0][0]) / luminous.value));
        Mean { value: of_all, standard_error: rest.standard_error }
    };
    Transfer { luminous, otf: (1..count).map(|k| [ratio(k, 0), ratio(k, 1)]).collect() }
}

/// What is estimated of the states of a display.
pub(super) enum States<'a> {
    /// Patterns of them.
    Pattern(&'a dyn Pattern),
    /// The spread of each.
    Kernel(KernelTally),
}

/// A scene for paths with places.
pub(crate) struct Placed<'a> {
    pub(super) setup: &'a Setup,
    meter: Meter<'a>,
    /// Light that reaches the pixel from each source.
    pub(super) lights: Vec<PixelLight>,
    pub(super) sources: Vec<Source>,
    pub(super) stack: Stack,
    /// Filter above the pixels.
    filter: Option<FilterPlane>,
    /// Paths traced so far, for the progress.
    traced: AtomicU64,
}

impl<'a> Placed<'a> {
    pub(crate) fn new(setup: &'a Setup) -> Result<Self, DisplayError> {
        let scene = &setup.scene;
        if scene.solver.approximation == Approximation::SinglePass {
            return Err(DisplayError::NoPlaces {
                what: "a single pass of the panel",
                key: "solver.approximation",
            });
        }
        setup.refracts()?;
        let stack = setup.placed_by_direction()?.clone();
        let meter = Meter::new(setup);
        let lights = meter.pixel_lights();
        let sources = lights.iter().map(|light| setup.sources[light.source].clone()).collect();
        let filter = scene.display.matrix.as_ref().and_then(|matrix| {
            let filter = matrix.filter.as_ref()?;
            Some(FilterPlane {
                height_mm: filter.height_mm,
                period_mm: matrix.pitch_mm,
                windows: matrix.sub_pixels.iter().map(|one| one.window.clone()).collect(),
                transmittance: filter.transmittance.iter().map(|one| one.to_vec()).collect(),
            })
        });
        Ok(Self { setup, meter, lights, sources, stack, filter, traced: AtomicU64::new(0) })
    }

    /// The same layers above another base, whose states are those of patterns; `both`: for light of s and of p, if they are
    /// kept apart.
    ///
    /// # Errors
    /// If the pixel changes the polarisation of light: that of mixtures of its states is not known.
    pub(super) fn above(mut self, base: Base, both: Option<[Base; 2]>) -> Result<Self, DisplayError> {
        if self.stack.follows_changes() {
            return Err(Refused::AzimuthOfMixtures.into());
        }
        self.stack = self.stack.general_over(base, both);
        Ok(self)
    }

    /// What a view sees of this many images.
    fn seen(&self, view: &ViewPoint, estimates: &[Estimate], images: usize) -> PatternView {
        let of = |image: Option<usize>| mean(estimates.iter().map(|one| self.luminous(one, image)));
        PatternView {
            theta_deg: view.theta_deg,
            phi_deg: view.phi_deg,
            via_pixel: (0..images).map(|image| of(Some(image))).collect(),
            front: of(None),
        }
    }

    /// Estimates of the states of a display with a filter.
    pub(crate) fn filtered(
        &self,
        view: &ViewPoint,
        paths: u64,
        control: &Control<'_>,
    ) -> Result<Vec<Estimate>, DisplayError> {
        if self.filter.is_none() {
            return Err(DisplayError::NoMatrix { command: "run" });
        }
        let states = Uniform { states: self.setup.states.len() };
        self.trace_states(view, States::Pattern(&states), paths, control)
    }

    /// Estimates of patterns or kernels of the states of the display, which a filter may define.
    pub(super) fn trace_states(
        &self,
        view: &ViewPoint,
        what: States<'_>,
        paths: u64,
        control: &Control<'_>,
    ) -> Result<Vec<Estimate>, DisplayError> {
        let (Some(plane), Some(filter)) = (&self.filter, self.setup.scene.display.filter()) else {
            let what = match what {
                States::Pattern(pattern) => What::Pattern(pattern),
                States::Kernel(tally) => What::Kernel(tally),
            };
            return self.trace(view, what, paths, control);
        };
        let uniform = Uniform { states: self.setup.states.len() };
        match what {
            States::Pattern(pattern) => {
                let below = BelowFilter { plane, states: &filter.states, pattern };
                self.trace(view, What::Pattern(&below), paths, control)
            }
            States::Kernel(tally) => {
                let below = BelowFilter { plane, states: &filter.states, pattern: &uniform };
                self.trace(view, What::KernelOf(&below, tally), paths, control)
            }
        }
    }

    /// Weights in Y of the light of each source.
    pub(super) fn channels(&self) -> Vec<Vec<Vec<f64>>> {
        self.lights.iter().map(|light| vec![light.weights[1].clone()]).collect()
    }

    /// Number of wavelengths.
    pub(super) fn bins(&self) -> usize {
        self.stack.base().bins()
    }

    /// Calls `trace` with a control that reports the fraction of a view's paths that are traced: of those since `before`, and of
    /// `left`, the number from now on. None are reported while that is not known.
    pub(crate) fn with_share<T>(
        &self,
        before: u64,
        left: Option<u64>,
        control: &Control<'_>,
        trace: impl FnOnce(&Control<'_>) -> T,
    ) -> T {
        let all = left.map(|left| (self.traced() - before + left) as f64);
        let progress = |now: Progress<'_>| {
            let share = all.map_or(0.0, |all| (self.traced() - before) as f64 / all);
            (control.progress)(Progress { share_of_view: Some(share.min(1.0)), ..now });
        };
        trace(&Control { progress: &progress, ..*control })
    }

    /// Number of paths traced so far.
    pub(crate) fn traced(&self) -> u64 {
        self.traced.load(Ordering::Relaxed)
    }

    /// What all media move light of these direction cosines by, mm.
    pub(super) fn displacement(&self, beta: Beta) -> [f64; 2] {
        self.displacements(beta).last().map_or([0.0; 2], |(_, sum)| *sum)
    }

    /// Heights above the pixels of all interfaces, mm, each with what the media below it move light of these direction
    /// cosines by; the last wavelength stands for all.
    pub(super) fn displacements(&self, beta: Beta) -> Vec<(f64, [f64; 2])> {
        let (mut height_mm, mut sum) = (0.0, [0.0; 2]);
        let above = |layer: &Layer| {
            let index = layer.medium.index().iter().next_back().copied().unwrap_or(1.0);
            height_mm += layer.thickness_mm;
            if beta.squared() < index * index {
                let [x, y] = displacement(beta, layer.thickness_mm, index);
                sum = [sum[0] + x, sum[1] + y];
            }
            (height_mm, sum)
        };
        self.stack.layers().iter().rev().map(above).collect()
    }

    /// Estimates of all replicates for a view. The progress tells the paths of all calls.
    pub(super) fn trace(
        &self,
        view: &ViewPoint,
        what: What<'_>,
        paths: u64,
        control: &Control<'_>,
    ) -> Result<Vec<Estimate>, DisplayError> {
        let Scene { solver, .. } = &self.setup.scene;
        let walk = self.prepared(&self.stack, view.field, what)?;
        self.in_replicates(paths, control, |stream, steps| {
            let mut replicate = walk.replicate();
            let numbers = SampleStream::new(solver.sampler, solver.seed, stream);
            steps(&mut |paths| walk.trace(&mut replicate, &numbers, paths.end - paths.start))?;
            Ok(walk.estimate(&replicate))
        })
    }

    /// Follows light that reaches the pixel for the first time back to where it entered. `sums` adds an entry
    /// to the sums of a replicate, of which there are `count`; returns their means by replicate. Places are
    /// distributed over the period of the pattern.
    pub(super) fn entries(
        &self,
        pattern: &dyn Pattern,
        (paths, count): (u64, usize),
        control: &Control<'_>,
        add: impl Fn(&Entry<'_>, &mut [f64]) + Sync,
    ) -> Result<Vec<Vec<f64>>, DisplayError> {
        let Scene { solver, grid, .. } = &self.setup.scene;
        let white = Base {
            reflector: Reflector::lambertian(vec![1.0; grid.len()], grid.len()),
            inactive_absorptance: vec![0.0; grid.len()].into(),
        };
        let stack = self.stack.general_over(white, None);
        // Any view: paths begin at the pixel.
        let (what, view) = (What::Pattern(pattern), Cone::new(0.0, 0.0, 0.0, 1.0));
        let walk = self.prepared(&stack, view, what)?;
        self.in_replicates(paths, control, |stream, steps| {
            let numbers = SampleStream::new(solver.sampler, solver.seed, stream);
            let (mut sums, mut traced) = (vec![0.0; count], 0);
            steps(&mut |paths| {
                traced = paths.end;
                walk.entries(&numbers, paths, |entry| add(&entry, &mut sums));
            })?;
            sums.iter_mut().for_each(|sum| *sum /= traced as f64);
            Ok(sums)
        })
    }

    fn prepared<'w>(
        &'w self,
        stack: &'w Stack,
        view: Cone,
        what: What<'w>,
    ) -> Result<PlacedWalk<'w>, DisplayError> {
        let sources = &self.sources[..];
        let walk = match &self.filter {
            Some(filter) => PlacedWalk::filtered(filter.clone(), stack, (view, sources), what),
            None => PlacedWalk::new(stack, view, sources, what),
        };
        let spread = self.setup.scene.display.pixel_spread();
        walk.map(|walk| walk.with_spread(spread)).map_err(DisplayError::Places)
    }

    /// Computes all replicates. Each is given its number and a function that calls another with numbers of
    /// paths, until all are traced.
    fn in_replicates<R: Send>(
        &self,
        paths: u64,
        control: &Control<'_>,
        replicate: impl Fn(
            u64,
            &dyn Fn(&mut dyn FnMut(Range<u64>)) -> Result<(), DisplayError>,
        ) -> Result<R, DisplayError>
        + Sync,
    ) -> Result<Vec<R>, DisplayError> {
        /// Paths between looks at whether to stop.
        const AT_ONCE: u64 = 1 << 12;
        let (all, mut workers) = (paths.div_ceil(REPLICATES).max(1), None);
        let pool = Workers::unless_one(&mut workers, control.threads)?;
        let mut streams: Vec<u64> = (0..REPLICATES).collect();
        let steps = |trace: &mut dyn FnMut(Range<u64>)| {
            let mut next = 0;
            while next < all {
                control.check()?;
                let paths = next..all.min(next + AT_ONCE);
                next = paths.end;
                let count = paths.end - paths.start;
                trace(paths);
                let traced = self.traced.fetch_add(count, Ordering::Relaxed) + count;
                (control.progress)(Progress { paths: Some(traced), ..Progress::of_views(0, 1) });
            }
            Ok(())
        };
        let all = each(pool, &mut streams, |(_, stream)| replicate(*stream, &steps));
        all.into_iter().collect()
    }

    /// X, Y and Z of an image via the pixel in one light, by its number.
    pub(super) fn colour(&self, estimate: &Estimate, light: usize, image: usize) -> [f64; 3] {
        let (weights, rho) = (&self.lights[light].weights, &estimate.rho[light]);
        let seen = rho.via_pixel.state(image);
        weights.each_ref().map(|weights| weights.iter().zip(seen).map(|(weight, seen)| weight * seen).sum())
    }

    /// X, Y and Z of light that has not met the pixel.
    pub(super) fn without_pixel(&self, estimate: &Estimate) -> [f64; 3] {
        self.meter.without_pixel(&estimate.rho[..self.setup.sources.len()])
    }

    /// Y of an image via the pixel, or of light that has not met the pixel.
    pub(super) fn luminous(&self, estimate: &Estimate, image: Option<usize>) -> f64 {
        match image {
            Some(image) => (0..self.lights.len()).map(|light| self.colour(estimate, light, image)[1]).sum(),
            None => self.without_pixel(estimate)[1],
        }
    }
}

/// Mean and standard error of independent values.
pub(super) fn mean(values: impl Iterator<Item = f64>) -> Mean {
    let values: Vec<f64> = values.collect();
    let count = values.len() as f64;
    let value = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|one| (one - value).powi(2)).sum();
    Mean { value, standard_error: (square / (count * (count - 1.0))).sqrt() }
}
