//! Sums over paths, and the reflectance factors and ledger that follow from them.

use papilio_spectra::StateSpectra;

use super::controls::Controls;
use super::generation::{Arrived, Generation, Roulette};
use super::light::{Light, Share};
use super::scatterers::ScatterEvent;
use super::sources::SourcesOfPaths;
use super::{Gathered, Layered, OutgoingRay};
use crate::estimate::Account;
use crate::skeleton::{Field, Propagation, Ray, Skeleton};
use crate::{Estimate, Ledger, ReflectanceFactor, Source};

/// Sums of a replicate, and its workspace.
#[derive(Debug, Clone)]
pub(in crate::walk) struct Accumulator {
    pub(super) sums: Sums,
    pub(super) workspace: Workspace,
}

#[derive(Debug, Clone)]
pub(super) struct Sums {
    /// Light that reaches sources.
    pub(super) received: Received,
    /// Absorbed light by account.
    pub(super) absorbed: Absorbed,
    /// Light that reaches the base, and light that it reflects.
    pub(super) arriving: Light,
    pub(super) reflected: Light,
    /// Light dropped by the choice of the next scatterer, less light added by it.
    pub(super) unaccounted: Light,
}

/// Light that reaches sources: the results of a path, or of many.
#[derive(Debug, Clone)]
pub(super) struct Received {
    /// Light that leaves into the air, where it meets diffuse light.
    pub(super) leaving: Light,
    /// Light of each directed source that reaches the path.
    pub(super) from_source: Vec<Light>,
}

impl Received {
    fn lights(&self) -> impl Iterator<Item = &Light> {
        std::iter::once(&self.leaving).chain(&self.from_source)
    }

    fn lights_mut(&mut self) -> impl Iterator<Item = &mut Light> {
        std::iter::once(&mut self.leaving).chain(&mut self.from_source)
    }

    /// All numbers.
    pub(super) fn values(&self) -> impl Iterator<Item = f64> {
        self.lights().flat_map(|light| light.fresh.iter().chain(&light.met).copied())
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.lights_mut().zip(other.lights()).for_each(|(sum, light)| sum.add(light, 1.0));
    }

    pub(super) fn clear(&mut self) {
        self.lights_mut().for_each(Light::clear);
    }
}

#[derive(Debug, Clone)]
pub(super) struct Absorbed {
    pub(super) front: Light,
    pub(super) diffuser: Light,
    pub(super) glass: Light,
}

#[derive(Debug, Clone)]
pub(super) struct Workspace {
    /// The light that takes part in an event.
    pub(super) light: Light,
    /// The light of each source that the event scatters into the path, upwards and downwards, and that is not
    /// in the sums yet.
    pub(super) gathered: Gathered,
    /// Number of the branch's meetings with a pixel that scatters, on its way to the event.
    pub(super) meetings: u32,
    /// The branches that are still to be followed.
    pub(super) next: Generation,
    /// Control variates, if there are events that they describe.
    pub(super) controls: Option<Controls>,
    pub(super) skeleton: Skeleton,
    /// The light of one branch between two scattering events.
    pub(super) field: Field,
    pub(super) share: Share,
    pub(super) lamps: SourcesOfPaths,
    /// For each scattering event, the largest fraction of light of any state and wavelength that takes part
    /// in it.
    pub(super) chances: Vec<f64>,
    /// Roulettes of this generation for the two sides of each event.
    pub(super) side_roulettes: Vec<Roulette>,
}

impl Absorbed {
    /// The sums of the accounts that layers have; what the base absorbs is known from what arrives there.
    pub(super) fn accounts(&mut self) -> [(Account, &mut Light); 3] {
        let Self { front, diffuser, glass } = self;
        [(Account::Front, front), (Account::Diffuser, diffuser), (Account::Glass, glass)]
    }
}

impl Sums {
    /// Subtracts the corrections of [`Controls`]; the energy balance remains complete.
    fn correct(&mut self, correction: &[f64]) {
        let values =
            self.received.lights_mut().flat_map(|light| light.fresh.iter_mut().chain(&mut light.met));
        values.zip(correction).for_each(|(value, correction)| *value -= correction);
        let unaccounted = self.unaccounted.fresh.iter_mut().chain(&mut self.unaccounted.met);
        unaccounted.zip(correction).for_each(|(value, correction)| *value += correction);
    }
}

impl Workspace {
    /// Changes between the sums of all paths and those of one.
    pub(super) fn exchange(&mut self, path: usize, sums: &mut Sums) {
        self.lamps.path = path;
        if let Some(controls) = &mut self.controls {
            controls.exchange(path, &mut sums.received);
        }
    }

    /// Adds a branch with this light.
    pub(super) fn branch(&mut self, sent: OutgoingRay) {
        self.next.depart((self.lamps.path, self.meetings), sent, &self.light);
    }

    /// Lets a branch with this light stay in its medium. The workspace takes over the memory of the branch's
    /// light.
    pub(super) fn stay(&mut self, branch: &mut Arrived) {
        std::mem::swap(&mut self.light, &mut branch.light);
        let light = std::mem::take(&mut branch.light);
        let gathered = std::mem::take(&mut self.gathered);
        self.next.arrived.push(Arrived { light, gathered, ..*branch });
    }

    /// Adds a branch with a part of this light, by wavelength; returns its light.
    pub(super) fn branch_part(&mut self, sent: OutgoingRay, part: impl Fn(usize) -> f64) -> &Light {
        let light = self.next.depart((self.lamps.path, self.meetings), sent, &self.light);
        light.multiply(part);
        light
    }

    /// Sets the light to what takes part in an event, of a branch with this light, times a factor.
    pub(super) fn carry(&mut self, light: &Light, event: &ScatterEvent<'_>, scale: f64) {
        event.share(&self.skeleton, &self.field, &mut self.share);
        self.light.clone_from(light);
        self.light.carry(&self.share, &self.field.rising, scale);
    }
}

impl Layered<'_> {
    pub(in crate::walk) fn tally(&self) -> Accumulator {
        let base = self.base();
        let (states, bins) = (base.states(), base.bins());
        let light = || Light::zeros(states, bins);
        let skeleton = Skeleton::new(self.stack, base);
        let field = skeleton.field();
        let lamps = SourcesOfPaths::new(self);
        let sums = Sums {
            received: Received {
                leaving: light(),
                from_source: self.sources.iter().map(|_| light()).collect(),
            },
            absorbed: Absorbed { front: light(), diffuser: light(), glass: light() },
            arriving: light(),
            reflected: light(),
            unaccounted: light(),
        };
        let controls = self.has_controls().then(|| Controls::new(&sums.received));
        Accumulator {
            sums,
            workspace: Workspace {
                light: light(),
                gathered: Vec::new(),
                meetings: 0,
                controls,
                next: Generation::default(),
                skeleton,
                field,
                share: Share::zeros(bins),
                lamps,
                chances: vec![0.0; self.events.len()],
                side_roulettes: Vec::new(),
            },
        }
    }

    /// Adds a branch's unscattered light to the accounts, except what leaves into the air.
    pub(super) fn record(&self, light: &Light, sums: &mut Sums, workspace: &mut Workspace) {
        let Workspace { skeleton, field, share, .. } = workspace;
        for (account, sum) in sums.absorbed.accounts() {
            share.clear();
            for (element, _) in self.accounts.iter().enumerate().filter(|(_, of)| **of == account) {
                let parts = skeleton.element(element);
                for going in [Propagation::Down, Propagation::Up] {
                    share.add(field, Ray::arriving_at(element, going), |bin| parts[bin].absorbed(going));
                }
            }
            sum.add_share(light, share, &field.rising, 1.0);
        }
        if !self.stack.base().is_specular() {
            return;
        }
        let base = Ray { plane: skeleton.elements(), going: Propagation::Down };
        share.set(field, base, |_| 1.0);
        sums.arriving.add_share(light, share, &field.rising, 1.0);
        share.set_rising();
        sums.reflected.add_share(light, share, &field.rising, 1.0);
    }

    /// Estimates of replicates, given with the factors that turn their sums into means.
    pub(in crate::walk) fn estimates(&self, tallies: &[(&Accumulator, f64)]) -> Vec<Estimate> {
        let controls = tallies.iter().filter_map(|(tally, _)| {
            let Accumulator { sums, workspace } = *tally;
            workspace.controls.as_ref().map(|controls| (controls, &sums.received))
        });
        let controls: Vec<_> = controls.collect();
        let corrections = Controls::corrections(&controls);
        let estimate = |(k, (tally, scale)): (usize, &(&Accumulator, f64))| match corrections.get(k) {
            Some(correction) => {
                let mut sums = tally.sums.clone();
                sums.correct(correction);
                self.estimate(&sums, *scale)
            }
            None => self.estimate(&tally.sums, *scale),
        };
        tallies.iter().enumerate().map(estimate).collect()
    }

    fn estimate(&self, sums: &Sums, scale: f64) -> Estimate {
        let rho = self.sources.iter().zip(&sums.received.from_source).map(|(source, from_source)| {
            let light = if *source == Source::Diffuse { &sums.received.leaving } else { from_source };
            let Light { fresh, met } = self.mean(light, scale);
            ReflectanceFactor { via_pixel: StateSpectra::new(met, fresh.len()), front: fresh }
        });
        Estimate { rho: rho.collect(), ledger: self.ledger(sums, scale) }
    }

    /// The mean of all states and wavelengths.
    fn mean(&self, sum: &Light, scale: f64) -> Light {
        let mut light = self.columns.as_ref().map_or_else(|| sum.clone(), |columns| columns.expand(sum));
        light.scale(scale);
        light
    }

    fn ledger(&self, sums: &Sums, scale: f64) -> Ledger {
        let inactive = &self.stack.base().inactive_absorptance;
        let bins = inactive.len();
        let spectra = |value: &dyn Fn(usize) -> f64, count: usize| {
            StateSpectra::new((0..count).map(value).collect(), bins)
        };
        let all = |light: &Light| {
            let Light { fresh, met } = self.mean(light, scale);
            spectra(&|k| met[k] + fresh[k % bins], met.len())
        };
        let (arriving, reflected) = (all(&sums.arriving), all(&sums.reflected));
        let of_inactive = spectra(&|k| arriving[k] * inactive[k % bins], arriving.len());
        let pixel = spectra(&|k| arriving[k] - reflected[k] - of_inactive[k], arriving.len());
        Ledger {
            returned: all(&sums.received.leaving),
            front: all(&sums.absorbed.front),
            diffuser: all(&sums.absorbed.diffuser),
            glass: all(&sums.absorbed.glass),
            pixel,
            inactive: of_inactive,
            unaccounted: all(&sums.unaccounted),
        }
    }
}
