//! Directions of light below the layers above a filter: of sources, and of views.

use std::borrow::Cow;

use papilio_optics::interface::{fresnel_reflectance, fresnel_reflectance_p, fresnel_reflectance_s};
use papilio_spectra::Spectrum;
use papilio_transport::spatial::{
    Accuracy, Direction, PanelSpread, Part, SpreadError, diffuse_directions, diffused_directions,
    diffused_directions_of_field,
};
use papilio_transport::{Base, Cone, Field, Medium, Panel, Reflector, Source, Top};

use super::Filtered;
use crate::DisplayError;

/// The layers above the pixels at some of the wavelengths, above Lambertian pixels.
pub(super) struct Optics {
    pub(super) panel: Panel,
    pub(super) index: f64,
    /// Reflectance of the front for light from below.
    pub(super) front: f64,
    /// How much they count at each wavelength.
    pub(super) weights: Vec<f64>,
}

/// Digits of levels.
const DIGITS: [f64; 3] = [7.0, 9.0, 11.0];
/// The same above mirrors: first ones, and how many more at each further level.
const MIRRORED_DIGITS: [f64; 2] = [9.0, 3.0];

impl Filtered<'_> {
    /// The layers above the pixels at a level: one for each pair of values of index and front.
    pub(super) fn optics(&self, level: usize) -> Vec<Optics> {
        let index = values(self.panel.medium.index(), level);
        let front = values(&self.panel.front.reflectance_below, level);
        let bins = self.setup.scene.grid.len();
        let one = |(index, front): (&Value, &Value)| {
            let mut panel = self.panel.clone();
            let constant = panel.medium.index().map(|_| index.value);
            panel.front.reflectance_below = constant.map(|_| front.value);
            if let Top::Fresnel(face) = &mut panel.top {
                *face = constant.clone();
            }
            panel.medium = Medium::new(constant);
            panel.base = white(bins, 1.0);
            let weights = index.weights.iter().zip(&front.weights).map(|(a, b)| a * b).collect();
            Optics { panel, index: index.value, front: front.value, weights }
        };
        index.iter().flat_map(|index| front.iter().map(move |front| (index, front))).map(one).collect()
    }

    /// What a view sees of mirror-like pixels in the light of a source, by direction.
    pub(super) fn mirrored_spread(
        &self,
        panel: &Panel,
        view: &Cone,
        source: &Source,
        level: usize,
    ) -> Result<PanelSpread, DisplayError> {
        let mut panel = Cow::Borrowed(panel);
        if !matches!(panel.top, Top::Fresnel(_)) && panel.front.reflectance_below.max() == 0.0 {
            // Light that passes the filter twice: its shift is that of a crossing of this length.
            panel.to_mut().gaps_mm = vec![2.0 * self.filter.height_mm];
        }
        let [first, more] = MIRRORED_DIGITS;
        let mut accuracy = self.accuracy(first + more * level as f64);
        if !self.is_diffused() {
            // Light of a wide view changes at kinks, where an image of a window leaves another one.
            accuracy.most_per_mm *= f64::from(1_u32 << level);
        }
        PanelSpread::by_direction(&panel, view, source, accuracy).map_err(not_computed)
    }

    fn accuracy(&self, digits: f64) -> Accuracy {
        let finest = self.matrix.pitch_mm[0].min(self.matrix.pitch_mm[1]);
        Accuracy { digits, most_per_mm: 4.0 / finest }
    }

    /// Directions of the light of a source below the face or diffuser; below a diffuser those of a sum.
    pub(super) fn arriving(
        &self,
        optics: &Optics,
        source: &Source,
        (level, sum): (usize, Option<usize>),
    ) -> Result<Vec<Direction>, DisplayError> {
        let Top::Diffuser(diffuser) = &optics.panel.top else {
            let diffuse = || diffuse_directions(level as u32, |beta| optics.passes(beta));
            let of_field = |field: &Field| {
                let own = |one: Direction| Direction { weight: one.weight * field.radiance(one.beta), ..one };
                diffuse().into_iter().map(own).collect()
            };
            return match source {
                Source::Diffuse => Ok(diffuse()),
                Source::Beam(beta) => Ok(vec![Direction { beta: *beta, weight: 1.0 }]),
                Source::Disc(cone) => self.mirrored(optics, cone, (level, sum)),
                Source::Field(field) => Ok(of_field(field)),
            };
        };
        let number = sum.unwrap_or_default();
        match source {
            Source::Diffuse => Ok(diffused_directions(diffuser, optics.index, level as u32, number)),
            Source::Beam(beta) => {
                let towards = -*beta;
                let theta_deg = towards.length().min(1.0).asin().to_degrees();
                let phi_deg = towards.y.atan2(towards.x).to_degrees();
                self.mirrored(optics, &Cone::new(theta_deg, phi_deg, 0.0, 1.0), (level, sum))
            }
            Source::Disc(cone) => self.mirrored(optics, cone, (level, sum)),
            Source::Field(field) => {
                Ok(diffused_directions_of_field(diffuser, field, optics.index, level as u32, number))
            }
        }
    }

    /// Directions of light from a cone: those of a view into it, reversed.
    fn mirrored(
        &self,
        optics: &Optics,
        cone: &Cone,
        (level, sum): (usize, Option<usize>),
    ) -> Result<Vec<Direction>, DisplayError> {
        let seen = self.leaving(optics, cone, (level, sum))?;
        Ok(seen.into_iter().map(|one| Direction { beta: -one.beta, ..one }).collect())
    }

    /// Directions in the medium that a view sees through the top, all or those of a sum.
    pub(super) fn leaving(
        &self,
        optics: &Optics,
        view: &Cone,
        (level, sum): (usize, Option<usize>),
    ) -> Result<Vec<Direction>, DisplayError> {
        let accuracy = self.accuracy(DIGITS[level.min(2)]);
        let panel = Panel { gaps_mm: vec![self.filter.height_mm], ..optics.panel.clone() };
        let spread = PanelSpread::by_direction(&panel, view, &Source::Diffuse, accuracy);
        let spread = spread.map_err(not_computed)?;
        let of_part = |part: &Part| {
            let through = part.through.iter().copied().fold(0.0, f64::max);
            let mut all = Vec::new();
            part.each_sample_of(sum, |one| {
                all.push(Direction { beta: one.beta, weight: one.weight * through })
            });
            all
        };
        Ok(spread.parts().iter().flat_map(of_part).collect())
    }
}

impl Optics {
    /// Reflectances of the face for light of s and of p from below, below the critical angle; twice the mean if they are not
    /// kept apart.
    pub(super) fn faces(&self, beta: f64) -> [f64; 2] {
        match self.panel.top {
            Top::Fresnel(_) if self.panel.keeps_s_and_p => {
                [fresnel_reflectance_s, fresnel_reflectance_p].map(|of| of(self.index, 1.0, beta))
            }
            Top::Fresnel(_) => [fresnel_reflectance(self.index, 1.0, beta); 2],
            Top::IdealAr | Top::Diffuser(_) => [0.0; 2],
        }
    }

    /// Their mean.
    pub(super) fn face(&self, beta: f64) -> f64 {
        let [s, p] = self.faces(beta);
        0.5 * (s + p)
    }

    /// Fraction of diffuse light that passes face and front, relative to that of the front alone.
    fn passes(&self, beta: f64) -> f64 {
        let [s, p] = self.faces(beta).map(|face| (1.0 - face) / (1.0 - face * self.front));
        0.5 * (s + p)
    }
}

/// Pixels of this reflectance.
pub(super) fn white(bins: usize, reflectance: f64) -> Base {
    Base {
        reflector: Reflector::lambertian(vec![reflectance; bins], bins),
        inactive_absorptance: vec![0.0; bins].into(),
    }
}

pub(super) fn not_computed(error: SpreadError) -> DisplayError {
    DisplayError::PlacesNotComputed { what: error.to_string(), key: "display".to_owned() }
}

/// A value of a spectrum and its weight at each wavelength.
struct Value {
    value: f64,
    weights: Vec<f64>,
}

/// Values between which all of a spectrum lie, with the weights of polynomials of Lagrange.
fn values(spectrum: &Spectrum, level: usize) -> Vec<Value> {
    let least = spectrum.iter().copied().fold(f64::INFINITY, f64::min);
    let nodes = match (spectrum.is_constant(), level) {
        (true, _) => vec![least],
        (false, 0) => vec![least, spectrum.max()],
        (false, _) => vec![least, 0.5 * (least + spectrum.max()), spectrum.max()],
    };
    let weight = |k: usize, value: f64| -> f64 {
        let others = nodes.iter().enumerate().filter(|(other, _)| *other != k);
        others.map(|(_, other)| (value - other) / (nodes[k] - other)).product()
    };
    let of = |k: usize| Value {
        value: nodes[k],
        weights: spectrum.iter().map(|value| weight(k, *value)).collect(),
    };
    (0..nodes.len()).map(of).collect()
}
