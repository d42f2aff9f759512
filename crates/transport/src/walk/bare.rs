//! Tracer of a bare panel: front and surface are flat, only the base may scatter.
//!
//! Front and surface are one flat part, whose inter-reflections are summed in closed form at each angle.
//! Over a mirror, light keeps its angle, and all round trips are a geometric series: the only random choice
//! is the point in the viewer's field. From a Lambertian base, light returns to the surface as often as
//! roulette grants. Only directions that can leave are sampled. The light trapped by total internal
//! reflection is known in closed form; however small either fraction is, no path has to find it. The path
//! always carries spectra: `[state][wavelength]`.

use std::borrow::Cow;

use papilio_optics::Beta;
use papilio_sampling::warp;
use papilio_spectra::StateSpectra;

use super::{PathNumbers, Target, add_rows_times, add_scaled, scale_rows};
use crate::mueller::Orders;
use crate::specular::FlatTop;
use crate::{Cone, Estimate, Ledger, Panel, ReflectanceFactor, Reflector, Source, WholeView};

#[derive(Debug)]
pub(super) struct Bare<'a> {
    stack: &'a Panel,
    view: Cone,
    sources: Cow<'a, [Source]>,
    specular: bool,
    /// Light that a Lambertian base sends up within a disc of this radius may leave; beyond it is trapped.
    leaving: f64,
}

/// Smallest probability with which a path continues, if it can: otherwise all replicates might miss light
/// that only a few paths carry.
const LEAST_SURVIVAL: f64 = 0.05;

/// Sums of a replicate, and a workspace.
#[derive(Debug, Clone)]
pub(super) struct Accumulator {
    sums: Sums,
    workspace: Workspace,
}

/// Sums by state and wavelength; where all states are equal, by wavelength.
#[derive(Debug, Clone)]
struct Sums {
    rho: Vec<ReflectanceFactor>,
    /// Mirrored and absorbed on entering, the same in all states.
    mirrored: Vec<f64>,
    absorbed_entering: Vec<f64>,
    /// Light that reaches the base, is reflected by it, leaves, is absorbed in the front, continues.
    arriving: StateSpectra,
    reflected: StateSpectra,
    leaving: StateSpectra,
    absorbed: StateSpectra,
    going_on: StateSpectra,
}

#[derive(Debug, Clone)]
struct Workspace {
    /// Spectra of the current path.
    carried: StateSpectra,
    /// Reflectance of the base.
    reflectance: StateSpectra,
    /// Front and surface at the angle of the path, and at that of a source.
    flat: FlatTop,
    towards: FlatTop,
    /// A factor for each wavelength.
    factor: Vec<f64>,
}

impl<'a> Bare<'a> {
    pub(super) fn new(stack: &'a Panel, view: Cone, sources: Cow<'a, [Source]>) -> Self {
        let specular = matches!(stack.base.reflector, Reflector::Specular(_));
        let leaving = stack.medium.largest_index().min(1.0);
        Self { stack, view, sources, specular, leaving }
    }

    /// As [`Walk::rarest`](super::Walk::rarest).
    pub(super) fn rarest(&self) -> f64 {
        if self.specular { 1.0 } else { LEAST_SURVIVAL }
    }

    pub(super) fn tally(&self) -> Accumulator {
        let bins = self.stack.base.bins();
        let states = self.stack.base.states();
        let (all, one) = (|| StateSpectra::zeros(states, bins), || vec![0.0; bins]);
        Accumulator {
            sums: Sums {
                rho: self.sources.iter().map(|_| ReflectanceFactor::zeros(states, bins)).collect(),
                mirrored: one(),
                absorbed_entering: one(),
                arriving: all(),
                reflected: all(),
                leaving: all(),
                absorbed: all(),
                going_on: all(),
            },
            workspace: Workspace {
                carried: all(),
                reflectance: all(),
                flat: FlatTop::new(bins),
                towards: FlatTop::new(bins),
                factor: one(),
            },
        }
    }

    pub(super) fn path(&self, numbers: &PathNumbers<'_>, tally: &mut Accumulator) {
        let Accumulator { sums, workspace } = tally;
        let beta = self.view.sample_towards(numbers.field());
        workspace.flat.set(self.stack, beta.squared());
        let orders = Orders::of(self.stack, beta);
        if let Some(orders) = &orders {
            orders.set(&mut workspace.flat);
        }
        self.enter(sums, workspace);
        if self.specular {
            match &orders {
                Some(orders) => orders.equivalent(&workspace.flat, &mut workspace.reflectance),
                None => {
                    let Workspace { reflectance, .. } = workspace;
                    self.stack.base.reflectance_towards(beta, &self.stack.medium, reflectance);
                }
            }
            self.sum_round_trips(sums, workspace);
            self.add_diffuse(orders.filter(|_| self.is_polarised()).as_ref(), sums, workspace);
            return;
        }
        self.add_diffuse(None, sums, workspace);
        let mut u = numbers.beside_field();
        for pass in 0.. {
            self.meet_base(beta, sums, workspace);
            // Points of sources and directions from the base are two techniques, so the same numbers serve
            // both.
            self.connect(u, sums, workspace);
            let (x, y) = warp::uniform_disc(self.leaving, u);
            self.leave(Beta { x, y }, sums, workspace);
            let [survival, way @ .., _] = numbers.block(1 + pass);
            if self.stack.single_pass || !Self::continues(survival, sums, workspace) {
                return;
            }
            u = way;
        }
    }

    /// Sums all round trips between a mirror and the surface, at the angle at which light entered.
    fn sum_round_trips(&self, sums: &mut Sums, workspace: &mut Workspace) {
        let Workspace { carried, reflectance, flat, .. } = workspace;
        for row in 0..carried.len() / flat.t.len() {
            for (bin, (t, below)) in flat.t.iter().zip(&flat.below).enumerate() {
                let k = row * flat.t.len() + bin;
                let returned = if self.stack.single_pass { 0.0 } else { reflectance[k] * below };
                // No light enters a cavity of two perfect mirrors.
                let arriving = if returned >= 1.0 { 0.0 } else { carried[k] / (1.0 - returned) };
                let reflected = arriving * reflectance[k];
                sums.arriving[k] += arriving;
                sums.reflected[k] += reflected;
                sums.leaving[k] += reflected * t;
                sums.absorbed[k] += reflected * (1.0 - t - below);
                sums.going_on[k] += arriving * returned;
                carried[k] = reflected;
            }
        }
    }

    /// Returns whether anything above a pixel that changes polarisation is polarised.
    fn is_polarised(&self) -> bool {
        self.stack.whole.as_ref().is_some_and(WholeView::is_polarised)
    }

    /// Adds what is seen of diffuse light: mirrored by the front, and over a mirror via the pixel, from the light that it has reflected.
    fn add_diffuse(&self, polarised: Option<&Orders<'_>>, sums: &mut Sums, workspace: &Workspace) {
        let Workspace { carried, flat, .. } = workspace;
        let diffuse = self.sources.iter().zip(&mut sums.rho).enumerate();
        for (number, (_, rho)) in diffuse.filter(|(_, (source, _))| **source == Source::Diffuse) {
            if let Some(orders) = polarised {
                rho.add(&orders.seen(Some(&self.view), number, None), 1.0);
                continue;
            }
            add_scaled(&mut rho.front, &flat.above, 1.0);
            if self.specular {
                add_rows_times(&mut rho.via_pixel, carried, &flat.t, 1.0);
            }
        }
    }

    /// Mirrors a part of the light, and transmits the rest to the base.
    fn enter(&self, sums: &mut Sums, workspace: &mut Workspace) {
        let Workspace { flat, factor, carried, .. } = workspace;
        add_scaled(&mut sums.mirrored, &flat.above, 1.0);
        fill(factor, flat.t.iter().zip(&flat.above).map(|(t, r)| 1.0 - t - r));
        add_scaled(&mut sums.absorbed_entering, factor, 1.0);
        carried.fill(1.0);
        scale_rows(carried, &flat.t);
    }

    fn meet_base(&self, beta: Beta, sums: &mut Sums, workspace: &mut Workspace) {
        add_scaled(&mut sums.arriving, &workspace.carried, 1.0);
        self.stack.base.reflectance_towards(beta, &self.stack.medium, &mut workspace.reflectance);
        workspace.carried.iter_mut().zip(&workspace.reflectance).for_each(|(c, r)| *c *= r);
        add_scaled(&mut sums.reflected, &workspace.carried, 1.0);
    }

    /// Connects a Lambertian base to directed sources.
    fn connect(&self, u: [f64; 2], sums: &mut Sums, workspace: &mut Workspace) {
        let Workspace { carried, towards, factor, .. } = workspace;
        for (source, rho) in self.sources.iter().zip(&mut sums.rho) {
            let Some(target) = Target::sample(source, u) else { continue };
            towards.set(self.stack, target.beta.squared());
            fill(factor, towards.t.iter().zip(self.spread_factors(target.beta)).map(|(t, f)| t * f));
            add_rows_times(&mut rho.via_pixel, carried, factor, self.balanced(&target));
        }
    }

    /// Returns the balanced weight of a point of a source, found by connection or by chance, in units of
    /// [`spread_factors`](Self::spread_factors).
    fn balanced(&self, target: &Target) -> f64 {
        let drawn = warp::uniform_disc_density(self.leaving);
        target.balanced(drawn, || drawn, 0.0)
    }

    /// Returns, per wavelength, the Lambertian density at `beta` over the density with which directions are
    /// sampled.
    fn spread_factors(&self, beta: Beta) -> impl Iterator<Item = f64> {
        let (medium, leaving) = (&self.stack.medium, self.leaving);
        medium.index().iter().map(move |&n| if beta.squared() < n * n { (leaving / n).powi(2) } else { 0.0 })
    }

    /// Transmits light through the surface: adds the light of the sources in that direction and the ledger,
    /// and retains the light that is sent back.
    fn leave(&self, beta: Beta, sums: &mut Sums, workspace: &mut Workspace) {
        let Workspace { flat, factor, carried, .. } = workspace;
        flat.set(self.stack, beta.squared());
        fill(factor, flat.t.iter().zip(self.spread_factors(beta)).map(|(t, f)| t * f));
        add_rows_times(&mut sums.leaving, carried, factor, 1.0);
        for (source, rho) in self.sources.iter().zip(&mut sums.rho) {
            let weight = match (source, Target::at(source, beta)) {
                (Source::Diffuse, _) => 1.0,
                (_, Some(target)) => self.balanced(&target),
                _ => continue,
            };
            add_rows_times(&mut rho.via_pixel, carried, factor, weight);
        }
        let lost = flat.t.iter().zip(&flat.below).map(|(t, r)| 1.0 - t - r);
        fill(factor, lost.zip(self.spread_factors(beta)).map(|(lost, f)| lost * f));
        add_rows_times(&mut sums.absorbed, carried, factor, 1.0);
        let trapped = self.stack.medium.index().iter().map(|n| (1.0 - 1.0 / (n * n)).max(0.0));
        let sent_back = flat.below.iter().zip(self.spread_factors(beta)).map(|(r, f)| r * f);
        fill(factor, sent_back.zip(trapped).map(|(sent_back, trapped)| sent_back + trapped));
        scale_rows(carried, factor);
    }

    /// Decides by Russian roulette whether the light that the surface sends back is followed.
    fn continues(u: f64, sums: &mut Sums, workspace: &mut Workspace) -> bool {
        let left = workspace.carried.iter().copied().fold(0.0, f64::max);
        let survival = left.clamp(LEAST_SURVIVAL, 1.0);
        if left == 0.0 || u >= survival {
            return false;
        }
        workspace.carried.iter_mut().for_each(|c| *c /= survival);
        add_scaled(&mut sums.going_on, &workspace.carried, 1.0);
        true
    }

    pub(super) fn estimate(&self, tally: &Accumulator, scale: f64) -> Estimate {
        let sums = &tally.sums;
        let mean = |rho: &ReflectanceFactor| ReflectanceFactor {
            via_pixel: rho.via_pixel.map(|sum| sum * scale),
            front: rho.front.iter().map(|sum| sum * scale).collect(),
        };
        Estimate { rho: sums.rho.iter().map(mean).collect(), ledger: self.ledger(sums, scale) }
    }

    fn ledger(&self, sums: &Sums, scale: f64) -> Ledger {
        let mut ledger = Ledger::zeros(sums.arriving.states(), self.stack.base.bins());
        let inactive = &self.stack.base.inactive_absorptance;
        for k in 0..sums.arriving.len() {
            let bin = k % inactive.len();
            ledger.inactive[k] = sums.arriving[k] * inactive[bin] * scale;
            ledger.pixel[k] = (sums.arriving[k] - sums.reflected[k]) * scale - ledger.inactive[k];
            ledger.returned[k] = (sums.mirrored[bin] + sums.leaving[k]) * scale;
            ledger.front[k] = (sums.absorbed_entering[bin] + sums.absorbed[k]) * scale;
            let sent_back = sums.reflected[k] - sums.leaving[k] - sums.absorbed[k];
            ledger.unaccounted[k] = (sent_back - sums.going_on[k]) * scale;
        }
        ledger
    }
}

fn fill(out: &mut [f64], values: impl Iterator<Item = f64>) {
    out.iter_mut().zip(values).for_each(|(o, v)| *o = v);
}
