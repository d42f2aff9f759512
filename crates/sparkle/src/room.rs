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
    /// Direction cosines of propagation of the light from its middle, `|beta| < 1`.
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

    /// True if light with these direction cosines comes from the source.
    #[inline]
    fn contains(&self, beta: Beta) -> bool {
        let b = self.beta.length();
        let [x, y] = if b > 0.0 { [self.beta.x / b, self.beta.y / b] } else { [1.0, 0.0] };
        let away = beta - self.beta;
        // Foreshortened along the plane of incidence.
        let along = (away.x * x + away.y * y) / self.cosine();
        let across = away.y * x - away.x * y;
        along * along + across * across < self.radius().powi(2)
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
