//! A rough interface as a [`Scatterer`] to both sides.

use super::{Rough, Side};
use crate::Beta;
use crate::scatterer::{Sample, Scatterer};

/// A direction on one side of an interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnSide {
    /// Side of the interface.
    pub side: Side,
    /// Direction of propagation.
    pub beta: Beta,
}

impl Side {
    /// Returns a direction on this side.
    pub fn at(self, beta: Beta) -> OnSide {
        OnSide { side: self, beta }
    }
}

/// Lossless: the albedo is 1. Symmetric: light in the opposite direction has the same density. 0 if `|beta|`
/// is not below the index of its side. `to = from` is the specular direction on the same side, and the
/// undeviated direction across the interface.
impl Scatterer for Rough {
    type Direction = OnSide;

    fn evaluate(&self, from: OnSide, to: OnSide) -> f64 {
        let (Some(i), Some(o)) = (self.cosine(from.side, from.beta), self.cosine(to.side, to.beta)) else {
            return 0.0;
        };
        self.facets.single(from.side, from.beta, to.side, to.beta)
            + self.deficits().density((from.side, i), (to.side, o))
    }

    /// Samples in proportion to `evaluate`, within 1e-5 of the whole.
    fn sample(&self, from: OnSide, u: [f64; 4]) -> Option<Sample<OnSide>> {
        let to = self.sample_direction(from, u);
        let density = self.evaluate(from, to);
        (density > 0.0).then(|| Sample::exact(to, density))
    }

    fn density(&self, from: OnSide, to: OnSide) -> f64 {
        self.evaluate(from, to)
    }

    fn albedo(&self, _: OnSide) -> f64 {
        1.0
    }
}

/// Number of microfacets of [`Rough::sample_sides`], and the step of their lattice (Fibonacci).
const LATTICE: usize = 8;
const STEP: f64 = 5.0 / 8.0;

impl Rough {
    /// Samples a direction on each side of the interface: that of incidence first. With each comes a
    /// probability, whose mean is the probability that [`sample`](Scatterer::sample) leaves to that side; it
    /// depends on the first two numbers alone. Directions that carry no light are `None`.
    ///
    /// The probability is that of eight microfacets, at the points of a lattice that the first two numbers
    /// shift. It varies far less than that of one, above all near the critical angle. The direction on each
    /// side is that of one of them, chosen in proportion.
    pub fn sample_sides(&self, from: OnSide, u: [f64; 4]) -> [(Option<OnSide>, f64); 2] {
        let cosine = self.cosine(from.side, from.beta).unwrap_or(0.0);
        let back = self.deficits().share_back(from.side, cosine);
        let of_several = [(0.0, back), (back, 1.0 - back)];
        let facets: [_; LATTICE] = std::array::from_fn(|k| {
            let u = [u[0] + k as f64 / LATTICE as f64, u[1] + k as f64 * STEP].map(f64::fract);
            let event = self.facets.meet(from.side, from.beta, u);
            [(true, event.reflectance), (false, 1.0 - event.reflectance)].map(|(reflected, part)| {
                let light = self.facets.leave(&event, reflected);
                (light, part * light.map_or(0.0, |light| light.unshadowed))
            })
        });
        std::array::from_fn(|side| {
            let (begin, share) = of_several[side];
            let parts = facets.map(|one| {
                let several = (1.0 - one[0].1 - one[1].1).max(0.0);
                (one[side].0, one[side].1, several * share)
            });
            let sum: f64 = parts.iter().map(|(_, one, several)| one + several).sum();
            let mut place = u[2] * sum;
            let chosen = parts.iter().find_map(|(light, one, several)| {
                if place < one + several {
                    return Some(match light {
                        Some(light) if place < *one => light.side.at(light.beta),
                        _ => {
                            let number = begin + share * ((place - one) / several).clamp(0.0, 1.0);
                            let of_side = (from.side, cosine);
                            let (side, beta) = self.deficits().sample(&self.facets, of_side, [number, u[3]]);
                            side.at(beta)
                        }
                    });
                }
                place -= one + several;
                None
            });
            let carries_light = |to: &OnSide| self.cosine(to.side, to.beta).is_some();
            (chosen.filter(carries_light), sum / LATTICE as f64)
        })
    }

    fn sample_direction(&self, OnSide { side: from, beta: beta_i }: OnSide, u: [f64; 4]) -> OnSide {
        let event = self.facets.meet(from, beta_i, [u[0], u[1]]);
        let reflectance = event.reflectance;
        let reflected = u[2] < reflectance;
        let mut again = u[3];
        if let Some(scattered) = self.facets.leave(&event, reflected) {
            if again < scattered.unshadowed {
                return scattered.side.at(scattered.beta);
            }
            again = (again - scattered.unshadowed) / (1.0 - scattered.unshadowed);
        }
        // Both choices leave a uniform number among those that led to them.
        let turn = if reflected { u[2] / reflectance } else { (u[2] - reflectance) / (1.0 - reflectance) };
        let cosine = self.cosine(from, beta_i).unwrap_or(0.0);
        let (side, beta) = self.deficits().sample(&self.facets, (from, cosine), [again, turn]);
        side.at(beta)
    }
}
