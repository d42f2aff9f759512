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

impl Rough {
    /// Samples a direction on each side from the same microfacet: on the side of incidence, and across. With each comes the
    /// probability that [`sample`](Scatterer::sample), which meets this microfacet, leaves to that side; it depends on the
    /// first two numbers alone. A direction without light is `None`.
    pub fn sample_sides(&self, from: OnSide, u: [f64; 4]) -> [(Option<Sample<OnSide>>, f64); 2] {
        let event = self.facets.meet(from.side, from.beta, [u[0], u[1]]);
        let cosine = self.cosine(from.side, from.beta).unwrap_or(0.0);
        let back = self.deficits().share_back(from.side, cosine);
        let single =
            [(true, event.reflectance), (false, 1.0 - event.reflectance)].map(|(reflected, part)| {
                let light = self.facets.leave(&event, reflected);
                (light, part * light.map_or(0.0, |light| light.unshadowed))
            });
        let several = (1.0 - single[0].1 - single[1].1).max(0.0);
        let ranges = [(0.0, back), (back, 1.0 - back)];
        std::array::from_fn(|side| {
            let ((light, of_one), (begin, share)) = (single[side], ranges[side]);
            let probability = of_one + several * share;
            let place = u[2] * probability;
            let to = match light {
                Some(light) if place < of_one => light.side.at(light.beta),
                _ if several * share > 0.0 => {
                    let number = begin + (place - of_one).max(0.0) / several;
                    let (side, beta) =
                        self.deficits().sample(&self.facets, (from.side, cosine), [number, u[3]]);
                    side.at(beta)
                }
                _ => return (None, probability),
            };
            let density = self.evaluate(from, to);
            ((density > 0.0).then(|| Sample::exact(to, density)), probability)
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
