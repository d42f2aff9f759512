//! The light of the room, and how the pixel sends it back.

use num_complex::Complex64;
use papilio_optics::Beta;

use super::deflection::{Deflection, applied};
use super::grid::Grid;

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
    pub(super) fn radius(&self) -> f64 {
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

    /// Place in the disc of the source, 1 at its rim: along the plane of incidence (foreshortened) and across it.
    fn place(&self, beta: Beta) -> Complex64 {
        let b = self.beta.length();
        let axis = if b > 0.0 { Complex64::new(self.beta.x, -self.beta.y) / b } else { Complex64::ONE };
        let turned = Complex64::new(beta.x, beta.y) * axis;
        Complex64::new(turned.re / self.cosine(), turned.im) / self.radius()
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

/// Light that the view rays of one face find.
pub(super) enum Light {
    /// The same along all rays.
    Uniform(f64),
    /// Images of sources in a mirror-like pixel plane.
    Images { diffuse: f64, sources: Vec<Image> },
    /// Irradiance of the pixel plane, in cells.
    Irradiance(Grid<f64>),
}

/// A source as the rays of each cell find it.
pub(super) struct Image {
    source: Source,
    /// Where the ray of each cell meets the disc of the source, and the change to the next cell along x and y.
    places: Vec<[Complex64; 3]>,
}

impl Image {
    /// Traces the rays of each cell back through the face, to the pixel plane, and through the face again.
    fn new(source: Source, view: &Deflection, slopes: &Grid<Complex64>) -> Self {
        let back = view.displacement_mm.map(|d| -2.0 * d);
        let place = |cell: usize| {
            let slope = slopes.values[cell];
            let [x, y] = slopes.cells.middle(cell);
            let [u, v] = applied(view.per_slope_mm(), [slope.re, slope.im]);
            let other = slopes.at([x + back[0] + 2.0 * u, y + back[1] + 2.0 * v]);
            let bent = (slope + other) * view.bend;
            source.place(view.beta - Beta { x: bent.re, y: bent.im } - source.beta)
        };
        let middles = Grid::new(slopes.cells, (0..slopes.cells.len()).map(place).collect());
        let with_slope = |cell: usize| {
            let [x, y] = [[1, 0], [0, 1]].map(|step| middles.difference(cell, step));
            [middles.values[cell], x, y]
        };
        Self { source, places: (0..slopes.cells.len()).map(with_slope).collect() }
    }

    /// Fraction of a cell whose rays find the source, for a view that differs by this place in its disc.
    ///
    /// The rim is a ramp as wide as the cell, at a radius that keeps the area of the disc; a source that is smaller than the cell
    /// becomes a cone of the same integral. The mean is correct in either case.
    #[inline]
    fn coverage(&self, cell: usize, view: Complex64) -> f64 {
        let [place, x, y] = self.places[cell];
        let place = place + view;
        let square = place.norm_sqr();
        // Half of the change of the radius over the cell is not larger than this: most rays find all of the source or nothing.
        let most = 0.5 * (x.l1_norm() + y.l1_norm());
        if square > (1.0 + most).powi(2) && most < 0.5 {
            return 0.0;
        }
        if square < (0.9 - most).powi(2) && most < 0.5 {
            return 1.0;
        }
        let radius = square.sqrt().max(1e-12);
        // Half of the change of the radius over the cell.
        let half = 0.5 * [x, y].map(|step| (place.conj() * step).re.abs()).iter().sum::<f64>() / radius;
        let half = half.max(1e-12);
        let square = half * half;
        let (rim, height) =
            if square <= 0.75 { ((1.0 - square / 3.0).sqrt(), 1.0) } else { (half, 0.75 / square) };
        height * (0.5 + 0.5 * (rim - radius) / half).clamp(0.0, 1.0)
    }
}

impl Light {
    /// Computes the light of a room for one face, with the illuminance, the deflection and the directions of each source.
    pub(super) fn new(
        room: &Room,
        pixel: Pixel,
        view: &Deflection,
        slopes: &Grid<Complex64>,
        entering: &[(f64, Deflection, Vec<Beta>)],
    ) -> Self {
        if room.sources.is_empty() {
            return Self::Uniform(room.diffuse);
        }
        match pixel {
            Pixel::Mirror => {
                let sources = room.sources.iter().map(|source| Image::new(*source, view, slopes)).collect();
                Self::Images { diffuse: room.diffuse, sources }
            }
            Pixel::Lambertian => {
                let mut irradiance = Grid::new(slopes.cells, vec![room.diffuse; slopes.cells.len()]);
                for (illuminance, deflection, directions) in entering {
                    let part = illuminance / directions.len() as f64;
                    for direction in directions {
                        irradiance.receive(part, deflection, *direction, view, slopes);
                    }
                }
                Self::Irradiance(irradiance)
            }
        }
    }

    /// Light along the ray of a cell that lands at `place`, for a view that differs by `view` in its direction cosines.
    #[inline]
    pub(super) fn at(&self, cell: usize, place: [f64; 2], view: Beta) -> f64 {
        match self {
            Self::Uniform(value) => *value,
            Self::Images { diffuse, sources } => {
                let of =
                    |image: &Image| image.source.radiance() * image.coverage(cell, image.source.place(view));
                diffuse + sources.iter().map(of).sum::<f64>()
            }
            Self::Irradiance(grid) => grid.at(place),
        }
    }
}

impl Grid<f64> {
    /// Adds what the face sends to the pixel plane of a beam: the light of each cell falls on a cell elsewhere.
    ///
    /// Places are those at which the undeflected view rays pass the face.
    fn receive(
        &mut self,
        irradiance: f64,
        beam: &Deflection,
        direction: Beta,
        view: &Deflection,
        slopes: &Grid<Complex64>,
    ) {
        let inside = beam.shift(direction);
        let shift = [0, 1].map(|k| beam.displacement_mm[k] + inside[k] + view.displacement_mm[k]);
        for (cell, slope) in slopes.values.iter().enumerate() {
            let [x, y] = self.cells.middle(cell);
            let [u, v] = applied(beam.per_slope_mm(), [slope.re, slope.im]);
            for (there, weight) in self.around([x + u + shift[0], y + v + shift[1]]) {
                self.values[there] += irradiance * weight;
            }
        }
    }
}
