//! A rough interface between two media of constant index.

use papilio_optics::Scatterer;
use papilio_optics::rough::{OnSide, Rough, Side};

use super::{Action, Narrowness, Preparation};
use super::{Arrival, Channel, Departure, Incidence, LayerKind, Scattered, ScatteringInterface, Sides};
use crate::estimate::Account;
use crate::front::Flat;
use crate::skeleton::Propagation;

impl LayerKind for Rough {
    fn passes_regularly(&self) -> bool {
        false
    }

    fn regular(&self, _: &Incidence) -> Flat {
        Flat::OPAQUE
    }

    fn scattered(&self, _: &Incidence) -> [f64; 2] {
        [1.0; 2]
    }

    fn is_colourless(&self) -> bool {
        true
    }

    fn account(&self) -> Account {
        Account::Diffuser
    }

    fn narrowness(&self) -> Option<Narrowness> {
        Some(Narrowness::Rough { alpha: self.alpha(), width: rough_width(self) })
    }

    /// Light that microfacets refract along the interface jumps to zero there: levels gain little.
    fn error_over_difference(&self) -> f64 {
        4.0
    }

    fn action<'a>(&'a self, prepare: &mut dyn Preparation<'a>) -> Option<Action> {
        Some(Action::Whole { number: prepare.rough(self) })
    }

    fn scattering_interface(&self) -> Option<&dyn ScatteringInterface> {
        Some(self)
    }
}

impl ScatteringInterface for Rough {
    fn channels(&self, _: Propagation) -> Vec<Channel> {
        vec![Channel::Both]
    }

    fn scatter(&self, from: Arrival, to: Departure) -> Scattered {
        let to = OnSide { side: side_after(to.going), beta: to.beta };
        Scattered::exactly(self.evaluate(arriving(from), to))
    }

    fn sample(&self, from: Arrival, u: [f64; 4]) -> Option<(Departure, Scattered)> {
        Scatterer::sample(self, arriving(from), u)
            .map(|sample| (departure(sample.direction), Scattered::exactly(sample.density)))
    }

    fn sample_sides(&self, from: Arrival, u: [f64; 4]) -> Option<Sides> {
        let sides = Rough::sample_sides(self, arriving(from), u);
        Some(sides.map(|(sample, probability)| (sample.map(departure), probability)))
    }
}

fn departure(OnSide { side, beta }: OnSide) -> Departure {
    let going = if side == Side::Above { Propagation::Up } else { Propagation::Down };
    Departure { beta, going }
}

fn arriving(Arrival { beta, going, .. }: Arrival) -> OnSide {
    OnSide { side: side_after(going).other(), beta }
}

/// Returns the side on which light is after it left the interface in this sense.
fn side_after(going: Propagation) -> Side {
    if going == Propagation::Down { Side::Below } else { Side::Above }
}

/// Returns the distance in direction cosines over which the kernel changes most: refracted light about the
/// normal, where the slope of a microfacet bends it by the difference of the indices.
pub(crate) fn rough_width(face: &Rough) -> f64 {
    face.alpha() * (face.index(Side::Above) - face.index(Side::Below)).abs().min(1.0)
}
