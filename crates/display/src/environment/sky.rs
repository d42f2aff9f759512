//! CIE standard general sky: relative luminance of a sky as a function of direction.
//!
//! # Model
//! `L/L_zenith = f(chi) phi(Z) / (f(Z_sun) phi(0))`: the gradation `phi(Z) = 1 + a exp(b/cos Z)` from zenith
//! to horizon, and the indicatrix `f(chi) = 1 + c (exp(d chi) - exp(d pi/2)) + e cos^2 chi` around the sun,
//! at an angle chi from it. Fifteen sets of a to e make the skies 1 (steep overcast) to 15 (white-blue,
//! turbid, broad corona); 5 is uniform, 12 the CIE standard clear sky. Number 16 is the traditional overcast
//! sky of Moon and Spencer, `(1 + 2 sin elevation)/3`.
//!
//! The sun itself is not included. The ground below the horizon has the luminance of a Lambertian plane
//! under the sky, of the given reflectance.
//!
//! Lookups evaluate the formula itself. It is not smooth at the sun and at the horizon, near which the
//! gradation approaches its limit as `exp(b/cos Z)`: integrals are refined there.
//!
//! # Source
//! ISO 15469:2004 / CIE S 011/E:2003, *Spatial distribution of daylight: CIE standard general sky*, eqs. 1-7
//! and table 1; R. Kittler, R. Perez, S. Darula, *A new generation of sky standards*, Lux Europa 1997; the
//! numbers are those of S. Darula, R. Kittler, *CIE general sky standard defining luminance distributions*,
//! eSim 2002.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use papilio_transport::{Edge, Field, Radiance};

use super::pose::{Pose, by_elevation, by_inclination};

/// Parameters a, b, c, d, e of the types 1 to 15.
const TYPES: [[f64; 5]; 15] = [
    [4.0, -0.70, 0.0, -1.0, 0.00],
    [4.0, -0.70, 2.0, -1.5, 0.15],
    [1.1, -0.80, 0.0, -1.0, 0.00],
    [1.1, -0.80, 2.0, -1.5, 0.15],
    [0.0, -1.00, 0.0, -1.0, 0.00],
    [0.0, -1.00, 2.0, -1.5, 0.15],
    [0.0, -1.00, 5.0, -2.5, 0.30],
    [0.0, -1.00, 10.0, -3.0, 0.45],
    [-1.0, -0.55, 2.0, -1.5, 0.15],
    [-1.0, -0.55, 5.0, -2.5, 0.30],
    [-1.0, -0.55, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 10.0, -3.0, 0.45],
    [-1.0, -0.32, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 16.0, -3.0, 0.30],
    [-1.0, -0.15, 24.0, -2.8, 0.15],
];

/// Number of the traditional overcast sky.
const TRADITIONAL: u8 = 16;

/// Number of rows and columns of the cells from which the Monte Carlo solver draws directions.
const ROWS: usize = 90;
const COLUMNS: usize = 180;

/// CIE standard general sky above a ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sky {
    /// CIE type, 1 to 15, or 16 for the traditional overcast sky.
    pub number: u8,
    /// Elevation of the sun above the horizon and its azimuth, degrees; not needed for types without an
    /// indicatrix.
    pub sun: Option<[f64; 2]>,
    /// Reflectance of the ground, 0 to 1.
    pub ground: f64,
}

impl Sky {
    /// Returns true if the sky of this number depends on the position of the sun.
    pub fn has_sun(number: u8) -> bool {
        usize::from(number).checked_sub(1).and_then(|i| TYPES.get(i)).is_some_and(|sky| sky[2] != 0.0)
    }

    /// Computes the relative luminance in a direction, a unit vector with z up; 1 at the zenith.
    pub fn luminance(&self, direction: [f64; 3]) -> f64 {
        Formula::new(self).luminance(direction)
    }

    /// Computes the illuminance of the horizontal ground for a luminance of 1 at the zenith.
    pub fn horizontal_illuminance(&self) -> f64 {
        Sky { ground: 0.0, ..*self }.over(Pose::default()).map_or(0.0, |(_, illuminance)| illuminance)
    }

    /// Returns the light of sky and ground over a display; `None` if there is none.
    pub fn field(&self, pose: Pose) -> Option<Field> {
        Some(self.over(pose)?.0)
    }

    /// Returns the light and the illuminance on the display for a luminance of 1 at the zenith.
    fn over(&self, pose: Pose) -> Option<(Field, f64)> {
        let is_round = pose.tilt_deg == 0.0 && !Self::has_sun(self.number);
        let columns = if is_round { 1 } else { COLUMNS };
        let ground = if self.ground > 0.0 { self.ground * self.horizontal_illuminance() / PI } else { 0.0 };
        let over = Over { sky: Formula::new(self), pose, ground };
        let edges: Vec<f64> = (0..=ROWS).map(|row| row as f64).collect();
        let mut about = Vec::with_capacity(ROWS * columns);
        for row in 0..ROWS {
            for column in 0..columns {
                // The mean of four points of each cell.
                let points = [(0.25, 0.25), (0.25, 0.75), (0.75, 0.25), (0.75, 0.75)];
                let mean = points.iter().map(|(along, turn)| {
                    let theta = (row as f64 + along).to_radians();
                    over.at(by_inclination(theta, 2.0 * PI * (column as f64 + turn) / columns as f64))
                });
                about.push(mean.sum::<f64>() / 4.0);
            }
        }
        Field::of(Arc::new(over), &edges, columns, about)
    }
}

/// Sky with the precomputed parameters of its formula.
#[derive(Debug)]
struct Formula {
    number: u8,
    sky: Option<[f64; 5]>,
    /// `exp(d pi/2)`.
    across: f64,
    sun: [f64; 3],
    zenith: f64,
}

impl Formula {
    fn new(sky: &Sky) -> Self {
        let of_type = usize::from(sky.number).checked_sub(1).and_then(|i| TYPES.get(i)).copied();
        let [elevation, azimuth] = sky.sun.unwrap_or([90.0, 0.0]);
        let across = of_type.map_or(0.0, |[_, _, _, d, _]| (d * FRAC_PI_2).exp());
        let sun = by_elevation(elevation, azimuth);
        let formula = Self { number: sky.number, sky: of_type, across, sun, zenith: 1.0 };
        Self { zenith: formula.luminance([0.0, 0.0, 1.0]), ..formula }
    }

    fn luminance(&self, direction: [f64; 3]) -> f64 {
        let sin = direction[2].clamp(0.0, 1.0);
        let Some([a, b, c, d, e]) = self.sky else {
            return if self.number == TRADITIONAL { (1.0 + 2.0 * sin) / 3.0 } else { 1.0 };
        };
        // b < 0: the exponential tends to 0 at the horizon.
        let gradation = if a == 0.0 { 1.0 } else { 1.0 + a * (b / sin).exp() };
        if c == 0.0 {
            return gradation / self.zenith;
        }
        let apart = direction.iter().zip(self.sun).map(|(x, y)| (x - y).powi(2));
        // Half of the chord is used because an arc cosine loses half of the digits near the sun.
        let half_chord = (0.5 * apart.sum::<f64>().sqrt()).min(1.0);
        let (chi, cosine) = (2.0 * half_chord.asin(), 1.0 - 2.0 * half_chord * half_chord);
        gradation * (1.0 + c * ((d * chi).exp() - self.across) + e * cosine * cosine) / self.zenith
    }
}

/// Light of a sky and the ground below it over a display.
#[derive(Debug)]
struct Over {
    sky: Formula,
    pose: Pose,
    ground: f64,
}

/// Scale over which the gradation changes near the horizon, its essential singularity, relative to `b`.
const OF_GRADATION: f64 = 0.1;

impl Radiance for Over {
    fn at(&self, direction: [f64; 3]) -> f64 {
        let world = self.pose.to_world(direction);
        if world[2] > 0.0 { self.sky.luminance(world) } else { self.ground }
    }

    fn edges(&self) -> Vec<Edge> {
        let [a, b, c, ..] = self.sky.sky.unwrap_or_default();
        let scale = if a == 0.0 { f64::INFINITY } else { OF_GRADATION * b.abs() };
        let horizon = Edge { centre: self.pose.to_display([0.0, 0.0, 1.0]), radius: FRAC_PI_2, scale };
        let sun = Edge { centre: self.pose.to_display(self.sky.sun), radius: 0.0, scale: 0.0 };
        if c == 0.0 { vec![horizon] } else { vec![horizon, sun] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::Beta;

    fn sky(number: u8) -> Sky {
        Sky { number, sun: Some([40.0, 30.0]), ground: 0.0 }
    }

    /// Closed forms: Moon and Spencer's illuminance of 7 pi/9 and a ratio of 1:3 from horizon to zenith.
    #[test]
    fn overcast_and_uniform_skies_equal_their_closed_forms() {
        let overcast = sky(16);
        assert!((overcast.horizontal_illuminance() / PI - 7.0 / 9.0).abs() < 1e-5);
        assert!((overcast.luminance([1.0, 0.0, 0.0]) - 1.0 / 3.0).abs() < 1e-12);
        assert!((sky(5).horizontal_illuminance() - PI).abs() < 1e-12);
        // Type 1 at the horizon: 1/(1 + 4 exp(-0.7)) = 0.3349, about a third as in the standard's footnote.
        assert!((sky(1).luminance([1.0, 0.0, 0.0]) - 0.334_857_9).abs() < 1e-6);
    }

    /// f(chi) of the clear sky: 1 + 10 (exp(-3 chi) - exp(-3 pi/2)) + 0.45 cos^2 chi.
    #[test]
    fn clear_sky_has_its_indicatrix_around_the_sun() {
        let clear = sky(12);
        let at_sun = clear.luminance(by_elevation(40.0, 30.0));
        let across = clear.luminance(by_elevation(40.0, 210.0));
        let f = |chi: f64| 1.0 + 10.0 * ((-3.0 * chi).exp() - (-1.5 * PI).exp()) + 0.45 * chi.cos().powi(2);
        assert!((at_sun / across - f(0.0) / f(100.0_f64.to_radians())).abs() < 1e-9);
        assert!((clear.luminance([0.0, 0.0, 1.0]) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn luminance_of_every_type_is_positive_in_all_directions() {
        for number in 1..=16 {
            for elevation in [0.0, 0.1, 10.0, 45.0, 90.0] {
                for azimuth in [30.0, 120.0, 210.0] {
                    let luminance = sky(number).luminance(by_elevation(elevation, azimuth));
                    assert!(luminance.is_finite() && luminance > 0.0, "{number} {elevation} {azimuth}");
                }
            }
        }
    }

    /// The sky over a horizontal display is brightest at the sun; an upright display faces half sky and half
    /// ground.
    #[test]
    fn sky_over_a_display_follows_its_tilt() {
        let flat = sky(12).field(Pose::default()).unwrap();
        let at = |field: &Field, theta, phi| field.radiance(Beta::from_source(theta, phi, 1.0));
        assert!(at(&flat, 50.0, 30.0) > 5.0 * at(&flat, 50.0, 210.0));
        let over_snow = Sky { number: 5, sun: None, ground: 0.8 };
        let upright = over_snow.field(Pose { tilt_deg: 90.0 }).unwrap();
        assert!((at(&upright, 40.0, 270.0) / at(&upright, 40.0, 90.0) - 0.8).abs() < 1e-9);
        assert!(over_snow.field(Pose::default()).unwrap().is_ring());
        // The radiance beyond the horizon of the air is zero.
        assert_eq!(upright.radiance(Beta { x: 0.8, y: 0.8 }), 0.0);
    }
}
