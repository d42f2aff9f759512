//! Tracer of a panel with a diffuser.
//!
//! One pass: down through the diffuser, reflection by the base, up through the diffuser, out through the
//! front, which may reflect the path into a further pass. Let T be the transmittance of the diffuser and t
//! that of the front. Every contribution of the k-th pass then has the factor `t^2 T^2` and, for each
//! earlier pass, `T^2 r R`, with r the reflectance of the front from below and R that of the base. The
//! factor `t^2 T^2` is applied at the end.

mod blocks;
mod escape;
mod first_pass;
mod first_pass_simd;
mod ledger;
mod numbers;
mod sources;
mod steps;

use std::borrow::Cow;
use std::ops::Range;

use papilio_optics::{Beta, Scatterer};
use papilio_sampling::SampleStream;

use super::accumulator::Reflected;
use super::strategy::DirectionSampler;
use super::{PathNumbers, Strategy, scale_rows};
use crate::angular::Stencil;
use crate::{Cone, Panel, Source};
use crate::{Diffuser, Reflector};
use blocks::Blocks;
pub(in crate::walk) use escape::Escape;
use first_pass::{First, Guided, SPLITS};
pub(in crate::walk) use first_pass_simd::{Drawn, LANES, Lanes};
pub(super) use ledger::Accumulator;
use ledger::{Sums, Workspace};
use numbers::PassNumbers;
use steps::{Spread, multiply};

/// Largest probability with which a path continues.
const MOST_SURVIVAL: f64 = 0.999;

/// Smallest probability of a further pass, if there is one: if sources are faintly visible, a few bright
/// later passes would carry much of their light, and of the error.
const LEAST_SURVIVAL: f64 = 0.05;

/// Smallest probability of passing unscattered through a diffuser that has regular transmittance, and of
/// being scattered.
const LEAST_WAY: f64 = 0.05;

#[derive(Debug)]
pub(super) struct Diffused<'a> {
    stack: &'a Panel,
    diffuser: &'a Diffuser,
    view: Cone,
    sources: Cow<'a, [Source]>,
    /// Selects the paths that continue after the first pass.
    blocks: Blocks,
    /// Probability with which light beyond a first pass is scattered by the lobe instead of passing
    /// unscattered.
    by_lobe: f64,
    /// Probability of a further pass after later ones, for light whose weight has not grown.
    survival: f64,
    /// `T^2 r`, per wavelength.
    between_passes: Vec<f64>,
    /// `t^2 T^2`, per wavelength.
    through: Vec<f64>,
    /// Whether the base is a mirror.
    specular: bool,
    /// Whether light of discs can be reflected between base and front without being scattered.
    round_trips: bool,
    /// Whether there are beams or discs.
    directed: bool,
    discs: bool,
    /// How the first direction of light that reaches the lobe from the pixel's side is sampled.
    first: First,
    /// How all other directions are sampled.
    drawing: DirectionSampler,
    leaving: Escape,
    /// Whether the directions at the pixel are also sampled from the sources' side.
    backwards: bool,
}

/// Light between the diffuser and the base.
#[derive(Debug, Clone, Copy)]
struct LightBelow {
    beta: Beta,
    weight: f64,
    /// Density with which the path sampled `beta`, where sources may sample it as well; otherwise infinite.
    rival: f64,
}

/// Light reflected by the base, and how its weight is stored.
#[derive(Debug, Clone, Copy)]
struct ReflectedLight {
    up: LightBelow,
    look_up: Option<Stencil>,
}

impl<'a> Diffused<'a> {
    pub(super) fn new(
        stack: &'a Panel,
        diffuser: &'a Diffuser,
        view: Cone,
        sources: Cow<'a, [Source]>,
        (strategy, shares): (Strategy, &[f64]),
    ) -> Self {
        let sent_back = diffuser.transmittance.zip_map(&stack.front.reflectance_below, |t, r| t * t * r);
        let goes_on = !stack.single_pass && stack.front.transmittance.max() > 0.0;
        let left = if goes_on { sent_back.max() * stack.base.largest_reflectance() } else { 0.0 };
        let directed = sources.iter().any(|source| *source != Source::Diffuse);
        let least = if directed && left > 0.0 { LEAST_SURVIVAL } else { left.min(MOST_SURVIVAL) };
        // A guided first pass costs so much, and leaves so little noise, that later passes may cost more.
        let wanted =
            if strategy == Strategy::Guided && left > 0.0 { (2.0 * left.sqrt()).max(0.25) } else { left };
        let survival = wanted.clamp(least, MOST_SURVIVAL);
        let blocks = Blocks::new(if survival > 0.0 { (1.0 / survival) as u64 } else { 0 });
        let by_lobe = chance_of_lobe(diffuser.regular_fraction, left);
        let through =
            stack.front.transmittance.zip_map(&diffuser.transmittance, |t, diffuser| (t * diffuser).powi(2));
        let specular = matches!(stack.base.reflector, Reflector::Specular(_));
        let discs = sources.iter().any(Source::has_radiance);
        let drawing = DirectionSampler::new(strategy, diffuser.lobe, stack.medium.largest_index(), &sources);
        let first = First::new(strategy, (stack, diffuser), view, (&sources, shares));
        let backwards = strategy == Strategy::Kernel;
        Self {
            stack,
            diffuser,
            view,
            sources,
            blocks,
            by_lobe,
            survival,
            between_passes: sent_back.to_vec(),
            through: through.to_vec(),
            specular,
            round_trips: specular && discs && left > 0.0 && diffuser.regular_fraction > 0.0,
            directed,
            discs,
            first,
            drawing,
            leaving: Escape::new(diffuser.lobe, stack.medium.largest_index()),
            backwards,
        }
    }

    /// As [`Walk::rarest`](crate::walk::Walk::rarest).
    pub(super) fn rarest(&self) -> f64 {
        self.blocks.rarest()
    }

    /// Traces these paths.
    pub(super) fn paths(&self, numbers: &SampleStream, paths: Range<u64>, tally: &mut Accumulator) {
        if self.first_passes_can_be_grouped() {
            self.grouped_first_passes(numbers, paths.clone(), &mut tally.sums);
        } else {
            for path in paths.clone() {
                self.first_pass(&PathNumbers::new(numbers, path), tally);
            }
        }
        self.later_passes(numbers, paths, tally);
    }

    /// Traces a first pass. Light that passes the diffuser unscattered on its way down and light that is
    /// scattered are both followed: no path has to find the less probable of the two.
    fn first_pass(&self, numbers: &PathNumbers<'_>, tally: &mut Accumulator) {
        let beta = self.view.sample_towards(numbers.field());
        // In a dispersive medium the disc of directions depends on wavelength: paths carry spectra from the
        // start.
        let carries = self.stack.medium.constant_index().is_none();
        let light = LightAbove { beta, weight: 1.0, carries, growth: 1.0 };
        let numbers = &PassNumbers::new(numbers, 0, self);
        let Accumulator { sums, workspace, .. } = tally;
        if carries {
            workspace.carried.fill(1.0);
        }
        sums.entering.add(carries.then_some(&workspace.carried), 1.0);
        if self.specular {
            self.connect_before_base(light, numbers, sums, workspace);
            if self.backwards {
                let chosen = |to: Beta| self.diffuser.lobe.density(beta, to);
                let by_lobe = LightAbove { weight: 1.0 - self.straight(), ..light };
                self.sample_backwards(chosen, by_lobe, numbers, sums, workspace);
            }
        }
        match &self.first {
            First::Guided(guided) if self.specular => self.guided(guided, light, numbers, sums, workspace),
            _ => {
                for by_lobe in [0.0, 1.0] {
                    if carries {
                        workspace.carried.fill(1.0);
                    }
                    if let Some(down) = self.down(light, by_lobe, numbers) {
                        self.meet(light, down, numbers, sums, workspace);
                    }
                }
            }
        }
    }

    /// Adds the sources that are visible to light that has come down through the diffuser.
    fn meet(
        &self,
        light: LightAbove,
        down: LightBelow,
        numbers: &PassNumbers<'_>,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        let met = self.below(down, 1.0, (light.carries, numbers), sums, workspace);
        if let (Some(met), true) = (met, self.discs) {
            self.add_discs_met_by_chance(met, numbers.up, sums, workspace);
        }
    }

    /// Traces the later passes of one path in each block, with random numbers of its own.
    fn later_passes(&self, numbers: &SampleStream, paths: Range<u64>, tally: &mut Accumulator) {
        let numbers = &numbers.independent();
        for (number, stands_for) in self.blocks.continuing_among(numbers, paths) {
            let numbers = PathNumbers::new(numbers, number);
            let beta = self.view.sample_towards(numbers.field());
            let light = LightAbove { beta, weight: stands_for, carries: false, growth: 1.0 };
            if let Some(light) = self.through_first_pass(light, &numbers, &mut tally.workspace) {
                self.passes(light, &numbers, tally);
            }
        }
    }

    /// Returns the light after a first pass, without contributions of sources.
    fn through_first_pass(
        &self,
        light: LightAbove,
        numbers: &PathNumbers<'_>,
        workspace: &mut Workspace,
    ) -> Option<LightAbove> {
        let n = self.stack.medium.largest_index();
        let numbers = PassNumbers::new(numbers, 0, self);
        let (beta, drawn, _) = self.through(&self.drawing, light.beta, n, self.by_lobe, numbers.down)?;
        let down = LightBelow { beta, weight: light.weight * drawn, rival: f64::INFINITY };
        self.to_next_pass(light, down, &numbers, workspace)
    }

    /// Traces all passes from the second on.
    fn passes(&self, mut light: LightAbove, numbers: &PathNumbers<'_>, tally: &mut Accumulator) {
        let Accumulator { sums, workspace, .. } = tally;
        for pass in 1.. {
            let numbers = PassNumbers::new(numbers, pass, self);
            let Some(further) = self.pass(light, &numbers, sums, workspace) else { return };
            light = further;
        }
    }

    /// Traces a later pass, from `beta` above the diffuser to above it again; `None` if the path ends.
    fn pass(
        &self,
        light: LightAbove,
        numbers: &PassNumbers<'_>,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) -> Option<LightAbove> {
        sums.entering.add(light.carries.then_some(&workspace.carried), light.weight);
        if self.specular {
            self.connect_before_base(light, numbers, sums, workspace);
        }
        let down = self.down(light, self.by_lobe, numbers);
        if let Some(down) = down {
            self.meet(light, down, numbers, sums, workspace);
        }
        let mut down = down?;
        // Directions that are sampled about sources make some weights grow with each pass: with the same
        // probability for all, a few paths of many passes would carry weights without a bound.
        let growth = light.growth * down.weight / light.weight;
        let survival = (self.survival * growth).clamp(self.survival, MOST_SURVIVAL);
        if numbers.survival >= survival {
            return None;
        }
        down.weight /= survival;
        let light = LightAbove { growth: light.growth * self.survival, ..light };
        self.to_next_pass(light, down, numbers, workspace)
    }

    /// Adds discs that the last scattering reaches by chance. (Light that passes unscattered from here is
    /// added elsewhere, or is a mirror image.)
    fn add_discs_met_by_chance(
        &self,
        met: ReflectedLight,
        u: [f64; 2],
        sums: &mut Sums,
        workspace: &Workspace,
    ) {
        let ReflectedLight { up, look_up } = met;
        let through = self.through(&self.drawing, up.beta, 1.0, self.by_lobe_upwards(), u);
        if let Some((out, _, false)) = through {
            self.meet_discs(up, out, reflected(look_up, &workspace.reflected), sums);
        }
    }

    /// Follows light from the base out of the diffuser into a further pass, which carries spectra. A
    /// Lambertian base sends this light into a direction of its own, since the direction used for the
    /// sources may be guided.
    fn to_next_pass(
        &self,
        light: LightAbove,
        down: LightBelow,
        numbers: &PassNumbers<'_>,
        workspace: &mut Workspace,
    ) -> Option<LightAbove> {
        let n = self.stack.medium.largest_index();
        let [u, v, base @ ..] = numbers.going_on();
        let (up, weight) =
            if self.specular { (down.beta, down.weight) } else { self.off_base(down.weight, base) };
        let (beta, drawn, _) = self.through(&self.drawing, up, 1.0, self.by_lobe, [u, v])?;
        let weight = weight * drawn;
        if beta.squared() > 1.0 || down.beta.length() >= n || weight == 0.0 {
            return None;
        }
        let Workspace { carried, reflected, .. } = workspace;
        self.reflectance(down.beta, reflected);
        if light.carries {
            scale_rows(reflected, carried)
        }
        self.keep_within_disc(down.beta, Spread::No, reflected);
        if !self.specular {
            self.keep_within_disc(up, Spread::Lambertian, reflected);
        }
        scale_rows(reflected, &self.between_passes);
        std::mem::swap(carried, reflected);
        Some(LightAbove { beta, weight, carries: true, growth: light.growth * weight / light.weight })
    }

    /// Reflects light below the diffuser at the base and adds the sources that it then sees, as this
    /// fraction of a sample. `None` if the medium has no such direction.
    fn below(
        &self,
        down: LightBelow,
        counts: f64,
        (carries, numbers): (bool, &PassNumbers<'_>),
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) -> Option<ReflectedLight> {
        if down.beta.length() >= self.stack.medium.largest_index() {
            return None;
        }
        if carries {
            self.keep_within_disc(down.beta, Spread::No, &mut workspace.carried);
        }
        let mut up = LightBelow { weight: counts * down.weight, ..down };
        let weight = up.weight;
        sums.arriving.add(carries.then_some(&workspace.carried), weight);
        let look_up = self.meet_base(down.beta, carries, workspace);
        sums.reflected.add(reflected(look_up, &workspace.reflected), weight);
        if !self.specular {
            self.connect_straight_from_base((look_up, weight), numbers, sums, workspace);
            if self.backwards {
                self.sample_backwards_from_base((look_up, weight), numbers, sums, workspace);
            }
            up = self.leave_base(weight, numbers);
            if carries {
                self.keep_within_disc(up.beta, Spread::Lambertian, &mut workspace.reflected);
            }
        }
        let light = reflected(look_up, &workspace.reflected);
        self.connect(up, light, carries.then_some(&workspace.carried), numbers, sums);
        // All light that leaves sees diffuse light: no direction has to be sampled.
        sums.leaving.add(light, self.leaves(weight, up));
        Some(ReflectedLight { up, look_up })
    }

    /// Samples several directions of a first pass at once.
    fn guided(
        &self,
        guided: &Guided,
        light: LightAbove,
        numbers: &PassNumbers<'_>,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        for k in 0..SPLITS {
            let (beta, drawn) = guided.draw(self.diffuser, light.beta, k, numbers.down);
            let down = LightBelow { beta, weight: light.weight * drawn, rival: f64::INFINITY };
            if light.carries {
                workspace.carried.fill(1.0);
            }
            let share = 1.0 / SPLITS as f64;
            let Some(met) = self.below(down, share, (light.carries, numbers), sums, workspace) else {
                continue;
            };
            if self.discs {
                let up = [(numbers.up[0] + k as f64 * share).fract(), numbers.up[1]];
                self.add_discs_met_by_chance(met, up, sums, workspace);
            }
        }
    }
}

/// Returns the probability with which light beyond a first pass is scattered by the lobe: the fraction that
/// is scattered, but neither choice is so improbable that few paths take it. Weights grow by this from pass
/// to pass, but by less than the light decreases.
fn chance_of_lobe(straight: f64, left: f64) -> f64 {
    let least = LEAST_WAY.min(0.25 * (1.0 - left).max(0.0));
    if straight == 0.0 || straight == 1.0 {
        1.0 - straight
    } else {
        (1.0 - straight).clamp(least, 1.0 - least)
    }
}

/// Light above the diffuser, on its way down.
#[derive(Debug, Clone, Copy)]
struct LightAbove {
    beta: Beta,
    weight: f64,
    /// Whether it carries spectra; otherwise all of them are one.
    carries: bool,
    /// Factor by which sampling directions by other densities than the lobe's has increased the weight.
    growth: f64,
}

#[inline]
fn reflected(look_up: Option<Stencil>, spectra: &[f64]) -> Reflected<'_> {
    look_up.map_or(Reflected::Spectra(spectra), Reflected::LookUp)
}
