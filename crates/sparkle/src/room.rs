//! The light of the room, and how the pixel sends it back.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_fourier::Plane;
use papilio_optics::Beta;

use crate::Plan;
use crate::deflection::{Deflection, applied};
use crate::grid::Grid;

/// Light on the panel. Only ratios matter.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Room {
    /// Illuminance of the same radiance from all directions.
    pub diffuse: f64,
    /// Directed sources.
    pub sources: Vec<Source>,
}

impl Room {
    /// Diffuse light alone.
    pub fn uniform() -> Self {
        Self { diffuse: 1.0, sources: Vec::new() }
    }
}

/// A round source of uniform radiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Direction cosines of propagation of the light from the middle of its disc, `|beta| < 1`.
    pub beta: Beta,
    /// Angular radius, degrees, above 0 and up to 90.
    pub radius_deg: f64,
    /// Illuminance on the panel.
    pub illuminance: f64,
}

impl Source {
    /// Sine of the angular radius.
    pub(crate) fn radius(&self) -> f64 {
        self.radius_deg.to_radians().sin()
    }

    /// Cosine of the inclination.
    fn cosine(&self) -> f64 {
        (1.0 - self.beta.squared()).max(0.0).sqrt()
    }

    /// Radiance times pi.
    fn radiance(&self) -> f64 {
        self.illuminance / (self.radius().powi(2) * self.cosine())
    }

    /// Mean direction cosines of its light: the cosines of directions in a cone fill an ellipse about
    /// `cos(r)` times those of its axis.
    pub(crate) fn middle(&self) -> Beta {
        let cosine = self.radius_deg.to_radians().cos();
        Beta { x: cosine * self.beta.x, y: cosine * self.beta.y }
    }

    /// True if light with these direction cosines comes from the source.
    #[inline]
    fn contains(&self, beta: Beta) -> bool {
        if beta.squared() >= 1.0 {
            return false;
        }
        let (away, rise) = (beta - self.beta, (1.0 - beta.squared()).sqrt() - self.cosine());
        let chord = 2.0 * (0.5 * self.radius_deg.to_radians()).sin();
        away.squared() + rise * rise < chord * chord
    }
}

/// How the pixel plane reflects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pixel {
    /// As a mirror: films.
    Mirror,
    /// Equally to all directions: paper.
    Lambertian,
}

/// Light that view rays find at places of the pixel plane.
pub(crate) enum Light {
    /// The same along all rays.
    Uniform(f64),
    /// Irradiance of the pixel plane, in cells.
    Irradiance(Grid<f64>),
}

impl Room {
    /// Light that comes from the direction of propagation `beta`: the radiance times pi.
    #[inline]
    pub(crate) fn light(&self, beta: Beta) -> f64 {
        let of = |source: &Source| if source.contains(beta) { source.radiance() } else { 0.0 };
        self.diffuse + self.sources.iter().map(of).sum::<f64>()
    }
}

impl Light {
    /// Light on Lambertian pixels, and that of a room without sources.
    pub(crate) fn of(plan: &Plan, faces: &[Grid<Complex64>]) -> Self {
        let room = &plan.panel.room;
        if room.sources.is_empty() {
            return Self::Uniform(room.diffuse);
        }
        let mut irradiance = vec![room.diffuse; plan.cells.len()];
        for (number, (source, beam)) in room.sources.iter().zip(&plan.entering).enumerate() {
            let face = &faces[plan.meetings.entered(number)];
            let received = Received { source, beam, view: &plan.view }.on_cells(face, &plan.plane);
            irradiance.iter_mut().zip(received).for_each(|(sum, light)| *sum += light);
        }
        Self::Irradiance(Grid::new(plan.cells, irradiance))
    }

    /// Light at a place of the pixel plane.
    #[inline]
    pub(crate) fn at(&self, place: [f64; 2]) -> f64 {
        match self {
            Self::Uniform(value) => *value,
            Self::Irradiance(grid) => grid.at(place),
        }
    }
}

/// Light of a source on its way to the pixel plane.
struct Received<'a> {
    source: &'a Source,
    beam: &'a Deflection,
    view: &'a Deflection,
}

impl Received<'_> {
    /// Irradiance of each cell of the pixel plane below a face: the light of each cell of the face falls on a
    /// cell elsewhere.
    ///
    /// Places are those at which the undeflected view rays pass the face. All directions of the source make
    /// the same pattern, each at another place.
    fn on_cells(&self, face: &Grid<Complex64>, plane: &Plane) -> Vec<f64> {
        let shift = [0, 1].map(|k| self.beam.displacement_mm[k] + self.view.displacement_mm[k]);
        let mut pattern = vec![Complex64::ZERO; face.cells.len()];
        for (cell, slope) in face.values.iter().enumerate() {
            let [x, y] = face.cells.middle(cell);
            let [u, v] = applied(self.beam.per_slope_mm(), [slope.re, slope.im]);
            for (there, weight) in face.around([x + u + shift[0], y + v + shift[1]]) {
                pattern[there].re += self.source.illuminance * weight;
            }
        }
        let [columns, rows] = face.cells.count;
        let mut spectrum = plane.forward(pattern);
        let scale = 1.0 / spectrum.len() as f64;
        let frequency = |bin: usize, count: usize, period_mm: f64| {
            (if 2 * bin > count { bin as f64 - count as f64 } else { bin as f64 }) / period_mm
        };
        for (bin, value) in spectrum.iter_mut().enumerate() {
            let x = frequency(bin / rows, columns, face.cells.period_mm[0]);
            let y = frequency(bin % rows, rows, face.cells.period_mm[1]);
            *value *= scale * self.transfer([x, y]);
        }
        plane.inverse(spectrum).into_iter().map(|value| value.re).collect()
    }

    /// Modulation transfer of the disc of the source at a spatial frequency, cycles per mm: `2 J1(z)/z`.
    fn transfer(&self, frequency_per_mm: [f64; 2]) -> f64 {
        let [x, y] = applied(self.beam.place_per_beta_mm, frequency_per_mm);
        let beta = self.source.beta;
        let b = beta.length();
        let [along, across] =
            if b > 0.0 { [(x * beta.x + y * beta.y) / b, (y * beta.x - x * beta.y) / b] } else { [x, y] };
        let z = 2.0 * PI * self.source.radius() * across.hypot(self.source.cosine() * along);
        if z < 1e-6 { 1.0 } else { 2.0 * libm::j1(z) / z }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the law of cosines of spherical triangles; the edge in the plane of incidence is at the sum and the
    /// difference of inclination and radius.
    #[test]
    fn discs_are_cones_about_their_axes() {
        let of = |theta: f64, radius_deg: f64| Source {
            beta: Beta::towards(theta, 0.0, 1.0),
            radius_deg,
            illuminance: 1.0,
        };
        for (theta, radius) in [(45.0, 30.0), (20.0, 10.0), (60.0, 10.0), (70.0, 0.265)] {
            let source = of(theta, radius);
            for (at, is_inside) in [(-1.01, false), (-0.99, true), (0.99, true), (1.01, false)] {
                let light = Beta::towards(theta + at * radius, 0.0, 1.0);
                assert_eq!(source.contains(light), is_inside, "{theta} {radius} {at}");
            }
            let mut met = 0;
            for k in 0..400 {
                let (inclination, azimuth) = (f64::from(k % 20) * 4.5, f64::from(k / 20) * 9.0);
                let [t, i, a] = [theta, inclination, azimuth].map(f64::to_radians);
                let apart = (t.cos() * i.cos() + t.sin() * i.sin() * a.cos()).acos().to_degrees();
                assert_eq!(source.contains(Beta::towards(inclination, azimuth, 1.0)), apart < radius);
                met += usize::from(apart < radius);
            }
            assert!(met > 0 || radius < 1.0, "{theta} {radius}");
        }
    }

    /// The illuminance, and the mean direction, by a sum over direction cosines.
    #[test]
    fn discs_have_their_illuminance_and_middle() {
        let source = Source { beta: Beta::towards(40.0, 30.0, 1.0), radius_deg: 25.0, illuminance: 3.0 };
        let steps = 1000;
        let at = |k: i32| (f64::from(k) + 0.5) / f64::from(steps);
        let (mut sum, mut mean) = (0.0, [0.0; 2]);
        for (row, column) in (-steps..steps).flat_map(|row| (-steps..steps).map(move |column| (row, column)))
        {
            let beta = Beta { x: at(column), y: at(row) };
            if source.contains(beta) {
                sum += 1.0;
                mean = [mean[0] + beta.x, mean[1] + beta.y];
            }
        }
        let illuminance = source.radiance() / PI * sum / f64::from(steps * steps);
        assert!((illuminance - 3.0).abs() < 3e-3, "{illuminance}");
        let middle = source.middle();
        let away = (mean[0] / sum - middle.x).hypot(mean[1] / sum - middle.y);
        assert!(away < 1e-4, "{away}");
    }
}
