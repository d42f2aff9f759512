//! The tracer of a bare panel: front and face are flat, only the base may scatter.
//!
//! Front and face are one flat part whose inter-reflections are summed in closed form
//! at each angle. A path enters through it, meets the base, and comes back up to it as
//! often as roulette grants; light trapped by total internal reflection is light that
//! comes back up. The path carries spectra all the way: [state][wavelength].

use papilio_optics::Beta;
use papilio_sampling::warp;

use super::specular::flat_top;
use super::tally::{Estimate, Ledger, Rho};
use super::{PathNumbers, Target, add_rows_times, add_scaled, scale_rows};
use crate::stack::Reflector;
use crate::{Cone, Source, Stack};

#[derive(Debug)]
pub(super) struct Bare<'a> {
    stack: &'a Stack,
    view: Cone,
    sources: &'a [Source],
    specular: bool,
}

/// The sums of a replicate, and room to work in.
#[derive(Debug, Clone)]
pub(super) struct Tally {
    rho: Vec<Rho>,
    /// Reflected and absorbed on entering; shape [wavelength].
    mirrored: Vec<f64>,
    absorbed_entering: Vec<f64>,
    /// Reaches the base, is reflected by it, leaves, ends in the front, goes on.
    arriving: Vec<f64>,
    reflected: Vec<f64>,
    leaving: Vec<f64>,
    absorbed: Vec<f64>,
    going_on: Vec<f64>,
    /// The spectra of the path at hand, and room for a reflectance.
    carried: Vec<f64>,
    reflectance: Vec<f64>,
}

/// The flat part at one angle; shape [wavelength].
struct FlatSpectra {
    t: Vec<f64>,
    above: Vec<f64>,
    below: Vec<f64>,
}

impl FlatSpectra {
    fn absorbed_from_above(&self) -> Vec<f64> {
        self.t.iter().zip(&self.above).map(|(t, r)| 1.0 - t - r).collect()
    }
}

impl<'a> Bare<'a> {
    pub(super) fn new(stack: &'a Stack, view: Cone, sources: &'a [Source]) -> Self {
        let specular = matches!(stack.base.reflector, Reflector::Specular(_));
        Self { stack, view, sources, specular }
    }

    pub(super) fn tally(&self) -> Tally {
        let bins = self.stack.base.bins();
        let all = || vec![0.0; self.stack.base.states() * bins];
        Tally {
            rho: self.sources.iter().map(|_| Rho { base: all(), front: vec![0.0; bins] }).collect(),
            mirrored: vec![0.0; bins],
            absorbed_entering: vec![0.0; bins],
            arriving: all(),
            reflected: all(),
            leaving: all(),
            absorbed: all(),
            going_on: all(),
            carried: all(),
            reflectance: all(),
        }
    }

    pub(super) fn path(&self, numbers: &PathNumbers<'_>, tally: &mut Tally) {
        let mut beta = self.view.sample_towards(numbers.field());
        let flat = self.flat(beta);
        self.enter(beta, &flat, tally);
        for pass in 0.. {
            self.meet_base(beta, tally);
            let scattered = (!self.specular).then(|| numbers.event(pass, 0));
            if let Some(u) = scattered {
                self.connect(numbers.event(pass, 1), tally);
                let n = self.stack.medium.largest_index();
                let (x, y) = warp::uniform_disc(n, [u[0], u[1]]);
                beta = Beta { x, y };
                self.spread(beta, tally);
            }
            let flat = self.flat(beta);
            self.leave(beta, &flat, tally);
            if self.stack.single_pass || !self.goes_on(&flat, numbers.event(pass, 2)[0], tally) {
                return;
            }
        }
    }

    fn flat(&self, beta: Beta) -> FlatSpectra {
        let bins = self.stack.base.bins();
        let mut flat = FlatSpectra { t: vec![0.0; bins], above: vec![0.0; bins], below: vec![0.0; bins] };
        for bin in 0..bins {
            let one = flat_top(self.stack, beta.squared(), bin);
            (flat.t[bin], flat.above[bin], flat.below[bin]) = (one.t, one.above, one.below);
        }
        flat
    }

    /// What the viewer sees mirrored, and what goes on to the base.
    fn enter(&self, beta: Beta, flat: &FlatSpectra, tally: &mut Tally) {
        add_scaled(&mut tally.mirrored, &flat.above, 1.0);
        add_scaled(&mut tally.absorbed_entering, &flat.absorbed_from_above(), 1.0);
        for (source, rho) in self.sources.iter().zip(&mut tally.rho) {
            add_scaled(&mut rho.front, &flat.above, source.image_strength(beta));
        }
        tally.carried.fill(1.0);
        scale_rows(&mut tally.carried, &flat.t);
    }

    fn meet_base(&self, beta: Beta, tally: &mut Tally) {
        add_scaled(&mut tally.arriving, &tally.carried, 1.0);
        self.stack.base.reflectance(beta.squared(), &self.stack.medium, &mut tally.reflectance);
        tally.carried.iter_mut().zip(&tally.reflectance).for_each(|(c, r)| *c *= r);
        add_scaled(&mut tally.reflected, &tally.carried, 1.0);
    }

    /// Connections from a Lambertian base to directed sources.
    fn connect(&self, u: [f64; 4], tally: &mut Tally) {
        let scatter = warp::uniform_disc_density(self.stack.medium.largest_index());
        for (source, rho) in self.sources.iter().zip(&mut tally.rho) {
            let Some(target) = Target::sample(source, [u[0], u[1]]) else { continue };
            let mut through = self.flat(target.beta).t;
            through.iter_mut().zip(self.spread_factors(target.beta)).for_each(|(t, f)| *t *= f);
            add_rows_times(&mut rho.base, &tally.carried, &through, target.weight(scatter, 0.0, 1.0));
        }
    }

    /// Per wavelength: the Lambertian density at `beta` over that of the largest disc.
    fn spread_factors(&self, beta: Beta) -> impl Iterator<Item = f64> {
        let (medium, largest) = (&self.stack.medium, self.stack.medium.largest_index());
        medium.index().iter().map(move |&n| if beta.squared() < n * n { (largest / n).powi(2) } else { 0.0 })
    }

    fn spread(&self, beta: Beta, tally: &mut Tally) {
        if self.stack.medium.constant_index().is_none() {
            let factors: Vec<f64> = self.spread_factors(beta).collect();
            scale_rows(&mut tally.carried, &factors);
        }
    }

    /// Out through the face: what the sources there send in, and the books.
    fn leave(&self, beta: Beta, flat: &FlatSpectra, tally: &mut Tally) {
        let absorbed: Vec<f64> = flat.t.iter().zip(&flat.below).map(|(t, r)| 1.0 - t - r).collect();
        let absorbed = if self.stack.single_pass { vec![0.0; absorbed.len()] } else { absorbed };
        add_rows_times(&mut tally.leaving, &tally.carried, &flat.t, 1.0);
        add_rows_times(&mut tally.absorbed, &tally.carried, &absorbed, 1.0);
        if beta.squared() > 1.0 {
            return;
        }
        for (source, rho) in self.sources.iter().zip(&mut tally.rho) {
            let weight = match source {
                Source::Disc(cone) if !self.specular && cone.sends(beta) => {
                    let scatter = warp::uniform_disc_density(self.stack.medium.largest_index());
                    Target::on_disc(cone, beta).weight(scatter, 0.0, 1.0)
                }
                _ => source.image_strength(beta),
            };
            if weight != 0.0 {
                add_rows_times(&mut rho.base, &tally.carried, &flat.t, weight);
            }
        }
    }

    /// Russian roulette on what the face sends back.
    fn goes_on(&self, flat: &FlatSpectra, u: f64, tally: &mut Tally) -> bool {
        scale_rows(&mut tally.carried, &flat.below);
        let survival = tally.carried.iter().copied().fold(0.0, f64::max).min(1.0);
        if u >= survival {
            return false;
        }
        tally.carried.iter_mut().for_each(|c| *c /= survival);
        add_scaled(&mut tally.going_on, &tally.carried, 1.0);
        true
    }

    pub(super) fn estimate(&self, tally: &Tally, scale: f64) -> Estimate {
        let mean = |sum: &[f64]| sum.iter().map(|s| s * scale).collect::<Vec<f64>>();
        let rho =
            tally.rho.iter().map(|rho| Rho { base: mean(&rho.base), front: mean(&rho.front) }).collect();
        Estimate { rho, ledger: self.ledger(tally, scale) }
    }

    fn ledger(&self, tally: &Tally, scale: f64) -> Ledger {
        let mut ledger = Ledger::zeros(tally.arriving.len());
        let inactive = &self.stack.base.inactive_absorptance;
        for k in 0..tally.arriving.len() {
            let bin = k % inactive.len();
            ledger.inactive[k] = tally.arriving[k] * inactive[bin] * scale;
            ledger.pixel[k] = (tally.arriving[k] - tally.reflected[k]) * scale - ledger.inactive[k];
            ledger.returned[k] = (tally.mirrored[bin] + tally.leaving[k]) * scale;
            ledger.front[k] = (tally.absorbed_entering[bin] + tally.absorbed[k]) * scale;
            let sent_back = tally.reflected[k] - tally.leaving[k] - tally.absorbed[k];
            ledger.unaccounted[k] = (sent_back - tally.going_on[k]) * scale;
        }
        ledger
    }
}
