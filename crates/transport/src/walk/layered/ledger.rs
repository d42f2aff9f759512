//! Sums over paths, and the reflectance factors and ledger that follow from them.

use super::Layered;
use super::light::{Light, Share};
use super::sources::SourceLights;
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
    /// Light that leaves into the air, where it meets diffuse light.
    pub(super) leaving: Light,
    /// Light of each directed source that reaches the path.
    pub(super) from_source: Vec<Light>,
    /// Absorbed light by account.
    pub(super) absorbed: Absorbed,
    /// Light that reaches the base, and light that it reflects.
    pub(super) arriving: Light,
    pub(super) reflected: Light,
    /// Light dropped by the choice of the next scatterer, less light added by it.
    pub(super) unaccounted: Light,
}

#[derive(Debug, Clone)]
pub(super) struct Absorbed {
    pub(super) front: Light,
    pub(super) diffuser: Light,
    pub(super) glass: Light,
}

#[derive(Debug, Clone)]
pub(super) struct Workspace {
    /// The path's light.
    pub(super) light: Light,
    pub(super) skeleton: Skeleton,
    /// The path's light between two scattering events.
    pub(super) field: Field,
    pub(super) share: Share,
    pub(super) lamps: SourceLights,
    /// For each scattering event, the largest fraction of light of any state and wavelength that takes part in it.
    pub(super) chances: Vec<f64>,
}

impl Absorbed {
    /// The sums of the accounts that layers have; what the base absorbs is known from what arrives there.
    fn accounts(&mut self) -> [(Account, &mut Light); 3] {
        let Self { front, diffuser, glass } = self;
        [(Account::Front, front), (Account::Diffuser, diffuser), (Account::Glass, glass)]
    }
}

impl Layered<'_> {
    pub(in crate::walk) fn tally(&self) -> Accumulator {
        let base = &self.stack.base;
        let (states, bins) = (base.states(), base.bins());
        let light = || Light::zeros(states, bins);
        let mut skeleton = Skeleton::new(self.stack);
        let field = skeleton.field();
        let lamps = SourceLights::new(self, &mut skeleton);
        Accumulator {
            sums: Sums {
                leaving: light(),
                from_source: self.sources.iter().map(|_| light()).collect(),
                absorbed: Absorbed { front: light(), diffuser: light(), glass: light() },
                arriving: light(),
                reflected: light(),
                unaccounted: light(),
            },
            workspace: Workspace {
                light: light(),
                skeleton,
                field,
                share: Share::zeros(bins),
                lamps,
                chances: vec![0.0; self.events.len()],
            },
        }
    }

    /// Adds the path's unscattered light to the accounts, except what leaves into the air.
    pub(super) fn record(&self, sums: &mut Sums, workspace: &mut Workspace) {
        let Workspace { light, skeleton, field, share, .. } = workspace;
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
        if self.base_scatters() {
            return;
        }
        let base = Ray { plane: skeleton.elements(), going: Propagation::Down };
        share.set(field, base, |_| 1.0);
        sums.arriving.add_share(light, share, &field.rising, 1.0);
        share.set_rising();
        sums.reflected.add_share(light, share, &field.rising, 1.0);
    }

    pub(in crate::walk) fn estimate(&self, tally: &Accumulator, scale: f64) -> Estimate {
        let sums = &tally.sums;
        let mean = |sum: &[f64]| sum.iter().map(|s| s * scale).collect::<Vec<f64>>();
        let rho = self.sources.iter().zip(&sums.from_source).map(|(source, from_source)| {
            let light = if *source == Source::Diffuse { &sums.leaving } else { from_source };
            ReflectanceFactor { via_pixel: mean(&light.met), front: mean(&light.fresh) }
        });
        Estimate { rho: rho.collect(), ledger: self.ledger(sums, scale) }
    }

    fn ledger(&self, sums: &Sums, scale: f64) -> Ledger {
        let inactive = &self.stack.base.inactive_absorptance;
        let bins = inactive.len();
        let all = |light: &Light| -> Vec<f64> {
            light.met.iter().enumerate().map(|(k, met)| scale * (met + light.fresh[k % bins])).collect()
        };
        let (arriving, reflected) = (all(&sums.arriving), all(&sums.reflected));
        let of_inactive: Vec<f64> =
            arriving.iter().enumerate().map(|(k, a)| a * inactive[k % bins]).collect();
        let pixel = (0..arriving.len()).map(|k| arriving[k] - reflected[k] - of_inactive[k]).collect();
        Ledger {
            returned: all(&sums.leaving),
            front: all(&sums.absorbed.front),
            diffuser: all(&sums.absorbed.diffuser),
            glass: all(&sums.absorbed.glass),
            pixel,
            inactive: of_inactive,
            unaccounted: all(&sums.unaccounted),
        }
    }
}
