//! A path, and the sums of all paths.

use papilio_optics::Beta;
use papilio_sampling::SampleStream;
use papilio_spectra::StateSpectra;

use super::Stokes;
use super::row::{self, Row};
use crate::estimate::Account;
use crate::layers::Departure;
use crate::skeleton::Propagation::{self, Down};
use crate::{Estimate, Ledger, ReflectanceFactor};

/// Weight below which paths end by chance.
pub(super) const FAINT: f64 = 0.1;

/// Light that is followed backwards.
#[derive(Clone)]
pub(super) struct Path {
    /// Direction cosines of the light.
    pub(super) beta: Beta,
    /// The sense in which it is followed: the light propagates in the other.
    pub(super) going: Propagation,
    pub(super) plane: usize,
    /// What the meter makes of the light, in the light's own frame of p and s: by column, or by state and column once
    /// the path has met the pixel.
    pub(super) rows: Vec<Row>,
    pub(super) has_met_pixel: bool,
    pub(super) events: u32,
    /// The source that it goes to: then it must not be scattered.
    pub(super) towards: Option<usize>,
    /// The density with which its last scattering event sampled its direction.
    pub(super) density: Option<f64>,
}

impl Path {
    /// Leaves an element towards the plane above or below it.
    pub(super) fn depart(&mut self, element: usize, Departure { beta, going }: Departure) {
        (self.beta, self.going, self.plane) = (beta, going, element + usize::from(going == Down));
    }

    /// Ends it.
    pub(super) fn end(&mut self) {
        self.rows.fill([0.0; 4]);
    }

    /// Multiplies its rows by a factor for each column; returns the unpolarised light that is lost.
    pub(super) fn weaken(&mut self, factor: impl Fn(usize) -> f64) -> Vec<f64> {
        let one = |(k, row): (usize, &mut Row)| {
            let (before, factor) = (row[0], factor(k));
            *row = row.map(|value| value * factor);
            before - row[0]
        };
        self.rows.iter_mut().enumerate().map(one).collect()
    }

    /// Russian roulette, which changes no mean: faint light continues by chance, and all light after many events.
    pub(super) fn survives(&mut self, run: &mut Run<'_>) -> bool {
        self.events += 1;
        let weight = self.rows.iter().fold(0.0, |most: f64, row| most.max(row[0]));
        let survival = (weight / FAINT).min(if self.events > 1000 { 0.95 } else { 1.0 });
        if survival >= 1.0 {
            return true;
        }
        let factor = if run.random()[0] < survival { 1.0 / survival } else { 0.0 };
        let lost = self.weaken(|_| factor);
        run.unaccounted(self, &lost);
        factor > 0.0
    }
}

/// Sums of light before it has met the pixel, by column, and after, by state and column.
#[derive(Debug, Clone)]
struct Light {
    fresh: Vec<f64>,
    met: Vec<f64>,
}

impl Light {
    fn zeros([columns, states]: [usize; 2]) -> Self {
        Self { fresh: vec![0.0; columns], met: vec![0.0; states * columns] }
    }

    fn add(&mut self, has_met_pixel: bool, values: impl IntoIterator<Item = f64>) {
        let sum = if has_met_pixel { &mut self.met } else { &mut self.fresh };
        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
    }
}

/// Sums over the paths of a replicate.
#[derive(Debug, Clone)]
pub(in crate::walk) struct Sums {
    received: Vec<Light>,
    returned: Light,
    /// In front, diffuser and glass.
    absorbed: [Light; 3],
    /// At the pixel.
    arriving: Light,
    reflected: Light,
    unaccounted: Light,
}

/// The sums, and the random numbers of the current path.
pub(super) struct Run<'r> {
    pub(super) sums: &'r mut Sums,
    pub(super) numbers: &'r SampleStream,
    pub(super) path: u64,
    pub(super) blocks: u32,
}

impl Run<'_> {
    pub(super) fn random(&mut self) -> [f64; 4] {
        self.blocks += 1;
        self.numbers.block(self.path, self.blocks - 1)
    }

    /// Light of a source, by row.
    pub(super) fn receive(&mut self, source: usize, path: &Path, seen: impl Fn(Row) -> f64) {
        self.sums.received[source].add(path.has_met_pixel, path.rows.iter().map(|row| seen(*row)));
    }

    /// Light that leaves into the air.
    pub(super) fn leave(&mut self, path: &Path) {
        self.sums.returned.add(path.has_met_pixel, path.rows.iter().map(|row| row[0]));
    }

    /// Light that a layer absorbs. Paths to sources are no part of the energy balance.
    pub(super) fn absorb(&mut self, account: Account, path: &Path, values: &[f64]) {
        if path.towards.is_some() {
            return;
        }
        let sum = match account {
            Account::Front => &mut self.sums.absorbed[0],
            Account::Diffuser => &mut self.sums.absorbed[1],
            Account::Glass => &mut self.sums.absorbed[2],
            Account::Pixel => return,
        };
        sum.add(path.has_met_pixel, values.iter().copied());
    }

    /// Light that arrives at the pixel, and light that this reflects.
    pub(super) fn meet(&mut self, arriving: &[f64], reflected: &[f64]) {
        self.sums.arriving.add(true, arriving.iter().copied());
        self.sums.reflected.add(true, reflected.iter().copied());
    }

    /// Light that chance has taken from the balance, zero on average.
    pub(super) fn unaccounted(&mut self, path: &Path, values: &[f64]) {
        if path.towards.is_none() {
            self.sums.unaccounted.add(path.has_met_pixel, values.iter().copied());
        }
    }
}

impl Stokes<'_> {
    /// Empty sums.
    pub(in crate::walk) fn sums(&self) -> Sums {
        let light = || Light::zeros([self.bins.len(), self.stack.base().states()]);
        Sums {
            received: self.sources.iter().map(|_| light()).collect(),
            returned: light(),
            absorbed: [light(), light(), light()],
            arriving: light(),
            reflected: light(),
            unaccounted: light(),
        }
    }

    /// Returns the means, given the factor that turns sums into them.
    pub(in crate::walk) fn estimate(&self, sums: &Sums, scale: f64) -> Estimate {
        let columns = self.bins.len();
        let of = |values: &[f64]| -> Vec<f64> {
            let rows = values.chunks_exact(columns);
            rows.flat_map(|row| self.column_of.iter().map(move |column| row[*column] * scale)).collect()
        };
        let bins = self.column_of.len();
        let rho = sums.received.iter().map(|light| ReflectanceFactor {
            via_pixel: StateSpectra::new(of(&light.met), bins),
            front: of(&light.fresh),
        });
        let all = |light: &Light| {
            let (mut met, fresh) = (of(&light.met), of(&light.fresh));
            met.iter_mut().enumerate().for_each(|(k, value)| *value += fresh[k % bins]);
            StateSpectra::new(met, bins)
        };
        let inactive = &self.stack.base().inactive_absorptance;
        let (arriving, reflected) = (all(&sums.arriving), all(&sums.reflected));
        let spectra =
            |value: &dyn Fn(usize) -> f64| StateSpectra::new((0..arriving.len()).map(value).collect(), bins);
        let [front, diffuser, glass] = sums.absorbed.each_ref().map(all);
        let ledger = Ledger {
            returned: all(&sums.returned),
            front,
            diffuser,
            glass,
            pixel: spectra(&|k| arriving[k] - reflected[k] - arriving[k] * inactive[k % bins]),
            inactive: spectra(&|k| arriving[k] * inactive[k % bins]),
            unaccounted: all(&sums.unaccounted),
        };
        Estimate { rho: rho.collect(), ledger }
    }
}

/// Returns the unpolarised light in rows.
pub(super) fn intensities(rows: &[Row]) -> Vec<f64> {
    rows.iter().map(|row| row[0]).collect()
}

/// Returns rows of a meter without polarisation.
pub(super) fn unpolarised(weights: impl IntoIterator<Item = f64>) -> Vec<Row> {
    weights.into_iter().map(row::unpolarised).collect()
}
