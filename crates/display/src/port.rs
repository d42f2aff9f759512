//! The port of an integrating sphere: light that leaves the sample beside it is lost.
//!
//! # Model
//! The sphere lights the sample through a round port, and the meter sees a round spot in the middle of it. In a sample inside which
//! light travels sideways (a slab of particles, glass below a rough face), light that the meter could see would have entered
//! beside the port, where there is none. With the distribution P(r) of the distance between entry and exit, the meter reads the
//! fraction `integral of P(r) w(r)` of what an infinite port gives; w(r) is the fraction of the spot that is inside the port if it is
//! shifted by r: the overlap of two discs over the area of the spot. All paths are reciprocal: P is that of light that enters at
//! the direction of the meter, followed to where it leaves ([`PlacedWalk::exits`]).
//!
//! A sample of a given diameter is a disc in the middle of the port, whose edge absorbs. Paths enter at random places of the spot,
//! and count if they leave inside the port and were never beside the sample.
//!
//! # Validity
//! Without a diameter, the sample is larger than the port by what light travels inside it. What lies beside the port or the sample
//! returns no light (the port lies on the sample, which lies on nothing or in a black holder). The wall of the sphere around the port is lit as without a sample. The random numbers are the same for
//! all displays: their noise cancels in differences.

use std::f64::consts::PI;

use papilio_sampling::{SampleStream, Sampler};
use papilio_spectra::StateSpectra;
use papilio_transport::walk::places::{Exit, PlacedWalk, RoundSample, Uniform, What};
use papilio_transport::{ReflectanceFactor, Source};

use crate::polarisation::check_unpolarised;
use crate::scene::{Port, Scene};
use crate::setup::Setup;
use crate::{Control, DisplayError};

/// Replicates, and paths of each.
const REPLICATES: u64 = 16;
const PATHS: u64 = 2048;

/// Fraction of the light of a source that an instrument with a port sees, of the light that it would see with a wide one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Kept {
    /// Of light that has not met the pixel, by wavelength.
    front: Vec<f64>,
    /// Of light that has.
    via_pixel: StateSpectra,
    /// Of both together.
    total: StateSpectra,
}

/// Light of a source that leaves: all, and what the instrument sees.
#[derive(Clone)]
struct Sums {
    front: [Vec<f64>; 2],
    via_pixel: [Vec<f64>; 2],
}

impl Kept {
    /// Computes the fractions of each source of a scene; `None` if its light has no port.
    pub(crate) fn of(scene: &Scene, control: &Control<'_>) -> Result<Option<Vec<Self>>, DisplayError> {
        let Some(port) = scene.lighting.port else { return Ok(None) };
        check_unpolarised(scene)?;
        let setup = Setup::of_places(scene, control)?;
        let stack = setup.placed_by_direction()?;
        let (states, bins) = (stack.base().states(), stack.base().bins());
        let Some(view) = setup.views.first() else { return Ok(None) };
        let pattern = Uniform { states };
        let walk =
            PlacedWalk::new(stack, view.field, &[], What::Pattern(&pattern)).map_err(DisplayError::Places)?;
        let walk = walk.with_spread(scene.display.pixel_spread()).in_sample(port.sample());
        let nothing = |values: usize| [vec![0.0; values], vec![0.0; values]];
        let empty = Sums { front: nothing(bins), via_pixel: nothing(states * bins) };
        let mut all = vec![empty; setup.sources.len()];
        for replicate in 0..REPLICATES {
            control.check()?;
            let numbers = SampleStream::new(Sampler::Sobol, scene.solver.seed, replicate);
            walk.exits(&numbers, 0..PATHS, |exit| {
                if exit.below {
                    return;
                }
                let seen = port.sees(&exit);
                for (sums, source) in all.iter_mut().zip(&setup.sources) {
                    let strength = match source {
                        Source::Diffuse => 1.0,
                        Source::Field(field) => PI * field.radiance(exit.beta),
                        Source::Beam(_) | Source::Disc(_) => 0.0,
                    };
                    let onto = if exit.light.len() == bins { &mut sums.front } else { &mut sums.via_pixel };
                    for (sum, weight) in onto.iter_mut().zip([strength, strength * seen]) {
                        sum.iter_mut().zip(exit.light).for_each(|(sum, light)| *sum += weight * light);
                    }
                }
            });
        }
        let kept = |[whole, seen]: &[Vec<f64>; 2]| -> Vec<f64> {
            whole
                .iter()
                .zip(seen)
                .map(|(whole, seen)| if *whole > 0.0 { seen / whole } else { 1.0 })
                .collect()
        };
        let one = |sums: &Sums| {
            let both = [0, 1].map(|k| {
                let via_pixel = sums.via_pixel[k].iter().enumerate();
                via_pixel.map(|(at, light)| light + sums.front[k][at % bins]).collect()
            });
            let total = StateSpectra::new(kept(&both), bins);
            // Light of a single state does not tell whether it has met the pixel.
            let via_pixel =
                if states == 1 { total.clone() } else { StateSpectra::new(kept(&sums.via_pixel), bins) };
            let front = if states == 1 { total.state(0).to_vec() } else { kept(&sums.front) };
            Self { front, via_pixel, total }
        };
        Ok(Some(all.iter().map(one).collect()))
    }

    /// A note on what is lost, given the bin of a wavelength in nm and the names of the states.
    pub(crate) fn note(&self, port: Port, (bin, nm): (usize, f64), states: &[String]) -> String {
        let lost = states.iter().enumerate().map(|(k, name)| {
            let lost = self.total.state(k).get(bin).map_or(0.0, |kept| 100.0 * (1.0 - kept));
            format!("{name} {lost:.1} %")
        });
        let edge =
            port.sample_mm.map_or(String::new(), |mm| format!(" and at the edge of the sample of {mm} mm"));
        format!(
            "beside the port of {} mm{edge} (spot of {} mm) the meter loses, at {nm} nm: {}",
            port.port_mm,
            port.spot_mm,
            lost.collect::<Vec<_>>().join(", ")
        )
    }

    /// What the instrument sees of a reflectance factor.
    pub(crate) fn of_light(&self, rho: &ReflectanceFactor) -> ReflectanceFactor {
        let mut seen = rho.clone();
        seen.front.iter_mut().zip(&self.front).for_each(|(rho, kept)| *rho *= kept);
        seen.via_pixel.iter_mut().zip(self.via_pixel.iter()).for_each(|(rho, kept)| *rho *= kept);
        seen
    }
}

impl Port {
    fn sample(self) -> Option<RoundSample> {
        let sample = |mm: f64| RoundSample { radius_mm: 0.5 * mm, spot_mm: 0.5 * self.spot_mm };
        self.sample_mm.map(sample)
    }

    /// Fraction of light that leaves here which the meter sees.
    fn sees(self, exit: &Exit<'_>) -> f64 {
        if self.sample_mm.is_none() {
            let [x, y] = exit.place_mm;
            return self.overlap(x.hypot(y));
        }
        let [x, y] = exit.from_middle_mm;
        f64::from(u8::from(!exit.left_sample && x.hypot(y) <= 0.5 * self.port_mm))
    }

    /// Fraction of the spot that is inside the port if it is shifted by this distance, mm.
    pub fn overlap(&self, shift_mm: f64) -> f64 {
        let [port, spot] = [0.5 * self.port_mm, 0.5 * self.spot_mm];
        let d = shift_mm;
        if d <= port - spot {
            return 1.0;
        }
        if d >= port + spot {
            return 0.0;
        }
        // Two circular segments (a lens); half-angles at both centres.
        let half = |own: f64, other: f64| {
            ((d * d + own * own - other * other) / (2.0 * d * own)).clamp(-1.0, 1.0).acos()
        };
        let [a, b] = [half(port, spot), half(spot, port)];
        let segment = |radius: f64, half: f64| radius * radius * (half - half.sin() * half.cos());
        (segment(port, a) + segment(spot, b)) / (PI * spot * spot)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counted on a grid of points of the spot.
    #[test]
    fn overlap_is_that_of_two_discs() {
        for (port_mm, spot_mm) in [(10.0, 10.0), (10.0, 6.0), (8.0, 0.5)] {
            let port = Port { port_mm, spot_mm, sample_mm: None };
            for shift in [0.0, 0.5, 1.9, 2.1, 4.0, 7.9, 8.3, 12.0] {
                let (mut inside, mut all) = (0.0_f64, 0.0_f64);
                for i in 0..800 {
                    for j in 0..800 {
                        let [x, y] =
                            [i, j].map(|k| (f64::from(k) + 0.5) / 400.0 - 1.0).map(|t| t * 0.5 * spot_mm);
                        if x.hypot(y) <= 0.5 * spot_mm {
                            all += 1.0;
                            inside += f64::from(u8::from((x + shift).hypot(y) <= 0.5 * port_mm));
                        }
                    }
                }
                assert!((port.overlap(shift) - inside / all).abs() < 2e-3, "{port_mm} {spot_mm} {shift}");
            }
        }
    }
}
