//! How a slope of the face moves the place that is seen through it.

use papilio_optics::Beta;
use papilio_transport::spatial::{Gap, displacement};

/// Change of the place on the pixel plane with the slope of the face, for one direction of the light, to
/// first order.
///
/// A slope m changes the direction cosines in the medium below the face by `-Γ m`,
/// `Γ = sqrt(n² - b²) - sqrt(1 - b²)`, b = `|beta|`. The place changes by `K m`, with `K = Γ d/sqrt(n² - b²)`
/// across the plane of incidence and `n²/(n² - b²)` times that along it; the normal direction has
/// `K = d (n - 1)/n`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deflection {
    /// Direction cosines of the light in the air.
    pub beta: Beta,
    /// Γ: change of the direction cosines with the slope.
    pub bend: f64,
    /// D: place at the face of an undeflected ray, relative to the place on the pixel plane, mm.
    pub displacement_mm: [f64; 2],
    /// dD/dbeta, mm: xx, xy, yy.
    pub place_per_beta_mm: [f64; 3],
}

impl Deflection {
    /// Returns the deflection for the media between face and pixel plane, that of the face first.
    /// `|beta| < 1`; indices are above 1.
    ///
    /// ```
    /// use papilio_optics::Beta;
    /// use papilio_sparkle::Deflection;
    /// use papilio_transport::spatial::Gap;
    /// let glass = Gap { index: 1.5, thickness_mm: 0.7 };
    /// let along_normal = Deflection::new(&[glass], Beta::default());
    /// assert!((along_normal.per_slope_mm()[0] - 0.7 / 3.0).abs() < 1e-15);
    /// ```
    pub fn new(media: &[Gap], beta: Beta) -> Self {
        let squared = beta.squared();
        let bend = media.first().map_or(0.0, |face| normal(face.index, squared) - normal(1.0, squared));
        let mut all = Self { beta, bend, displacement_mm: [0.0; 2], place_per_beta_mm: [0.0; 3] };
        for medium in media {
            let q = normal(medium.index, squared);
            let across = medium.thickness_mm / q;
            let along = across / (q * q);
            let moved = displacement(beta, medium.thickness_mm, medium.index);
            (0..2).for_each(|k| all.displacement_mm[k] += moved[k]);
            let of =
                [across + along * beta.x * beta.x, along * beta.x * beta.y, across + along * beta.y * beta.y];
            (0..3).for_each(|k| all.place_per_beta_mm[k] += of[k]);
        }
        all
    }

    /// K: change of the place on the pixel plane with the slope, mm: xx, xy, yy.
    pub fn per_slope_mm(&self) -> [f64; 3] {
        self.place_per_beta_mm.map(|place| self.bend * place)
    }

    /// Root mean square along x and along y of the places on the pixel plane that a pupil sees, mm: its image is a disc, whose mean
    /// square along an axis is a quarter of the square of its radius, foreshortened along the plane of incidence.
    pub fn blur_mm(&self, pupil: &Pupil) -> [f64; 2] {
        let axes =
            [[1.0, 0.0], [0.0, 1.0]].map(|point| foreshortened(self.beta, 0.5 * pupil.radius(), point));
        let [along, across] = axes.map(|beta| self.shift(beta));
        [0, 1].map(|axis| along[axis].hypot(across[axis]))
    }

    /// Change of the place on the pixel plane for a change of the direction cosines in the air.
    pub(crate) fn shift(&self, beta: Beta) -> [f64; 2] {
        applied(self.place_per_beta_mm, [beta.x, beta.y])
    }
}

/// Component along the normal of a wave vector over k0.
fn normal(index: f64, beta_squared: f64) -> f64 {
    (index * index - beta_squared).max(0.0).sqrt()
}

/// Product of a symmetric matrix (xx, xy, yy) and a vector.
pub(crate) fn applied([xx, xy, yy]: [f64; 3], [x, y]: [f64; 2]) -> [f64; 2] {
    [xx * x + xy * y, xy * x + yy * y]
}

/// The viewer's pupil, which faces the panel, or the entrance pupil of a camera that is focused on the panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pupil {
    /// Diameter, mm; 0 is a pinhole.
    pub diameter_mm: f64,
    /// Distance from the panel along the view, mm, above 0.
    pub distance_mm: f64,
}

impl Pupil {
    /// A viewer who receives one ray from each point.
    pub const PINHOLE: Self = Self { diameter_mm: 0.0, distance_mm: 1.0 };

    /// Sine of the angular radius, as seen from the panel.
    pub fn radius(&self) -> f64 {
        let radius = 0.5 * self.diameter_mm;
        radius / radius.hypot(self.distance_mm)
    }
}

/// Directions that fill a disc around one, foreshortened along its plane of incidence, with equal weights.
/// `rings` 0 is the centre alone.
pub(crate) fn directions(around: Beta, radius: f64, rings: usize) -> Vec<Beta> {
    let points = disc(if radius > 0.0 { rings } else { 0 });
    points.into_iter().map(|point| foreshortened(around, radius, point)).collect()
}

/// A direction within a disc around one, uniformly distributed for uniform numbers.
pub(crate) fn direction(around: Beta, radius: f64, [s, t]: [f64; 2]) -> Beta {
    let (sin, cos) = (std::f64::consts::TAU * t).sin_cos();
    foreshortened(around, radius, [s.sqrt() * cos, s.sqrt() * sin])
}

/// The change of a direction to a point of the unit disc around it, foreshortened along its plane of
/// incidence.
fn foreshortened(around: Beta, radius: f64, [u, v]: [f64; 2]) -> Beta {
    let b = around.length();
    let along = if b > 0.0 { [around.x / b, around.y / b] } else { [1.0, 0.0] };
    let (u, v) = (radius * normal(1.0, b * b) * u, radius * v);
    Beta { x: u * along[0] - v * along[1], y: u * along[1] + v * along[0] }
}

/// Points of the unit disc with equal weights: the centre and `rings` rings of 6, 12, ... points.
fn disc(rings: usize) -> Vec<[f64; 2]> {
    let pairs = (rings * (rings + 1)) as f64;
    let scale = 3.0 * pairs * pairs / (3.0 * pairs + 1.0);
    let mut points = vec![[0.0; 2]];
    for ring in 1..=rings {
        // With a mean square radius of exactly 1/2.
        let square = (ring * ring) as f64 / scale;
        let turns =
            (0..6 * ring).map(|k| std::f64::consts::TAU * (k as f64 + 0.5 * ring as f64) / (6 * ring) as f64);
        points.extend(turns.map(|turn| [square.sqrt() * turn.cos(), square.sqrt() * turn.sin()]));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    const GLASS: Gap = Gap { index: 1.5, thickness_mm: 0.7 };

    /// Traces a ray through a tilted face exactly and compares it with the linear formula.
    #[test]
    fn deflection_is_derivative_of_snells_law() {
        for beta in [Beta::default(), Beta::towards(40.0, 0.0, 1.0), Beta::towards(60.0, 130.0, 1.0)] {
            let deflection = Deflection::new(&[GLASS], beta);
            for slope in [[1e-5, 0.0], [0.0, 1e-5], [1e-5, -2e-5]] {
                let place = place_on_plane(beta, slope);
                let straight = place_on_plane(beta, [0.0; 2]);
                let linear = applied(deflection.per_slope_mm(), slope);
                for k in 0..2 {
                    assert!((place[k] - straight[k] - linear[k]).abs() < 1e-9, "{beta:?} {slope:?}");
                    assert!((straight[k] + deflection.displacement_mm[k]).abs() < 1e-14);
                }
            }
        }
    }

    /// Vector form of Snell's law for a ray that enters the glass at the origin against the direction `beta`.
    fn place_on_plane(beta: Beta, [mx, my]: [f64; 2]) -> [f64; 2] {
        let length = (1.0 + mx * mx + my * my).sqrt();
        let normal = [-mx / length, -my / length, 1.0 / length];
        let wave = [-beta.x, -beta.y, -(1.0 - beta.squared()).sqrt()];
        let along: f64 = (0..3).map(|k| wave[k] * normal[k]).sum();
        let inside = -(1.5 * 1.5 - 1.0 + along * along).sqrt();
        let refracted: Vec<f64> = (0..3).map(|k| wave[k] + (inside - along) * normal[k]).collect();
        [0, 1].map(|k| 0.7 * refracted[k] / -refracted[2])
    }

    #[test]
    fn divided_medium_deflects_as_one() {
        let beta = Beta { x: 0.3, y: -0.4 };
        let halves = [GLASS, GLASS].map(|half| Gap { thickness_mm: 0.5 * half.thickness_mm, ..half });
        let (one, two) = (Deflection::new(&[GLASS], beta), Deflection::new(&halves, beta));
        for k in 0..3 {
            assert!((one.per_slope_mm()[k] - two.per_slope_mm()[k]).abs() < 1e-15);
        }
    }

    /// The mean square of the places of directions that fill the pupil.
    #[test]
    fn blur_of_a_pupil_is_that_of_its_directions() {
        let pupil = Pupil { diameter_mm: 8.0, distance_mm: 300.0 };
        for beta in [Beta::default(), Beta::towards(60.0, 0.0, 1.0), Beta::towards(50.0, 130.0, 1.0)] {
            let view = Deflection::new(&[GLASS], beta);
            let places: Vec<[f64; 2]> =
                directions(beta, pupil.radius(), 4).into_iter().map(|one| view.shift(one)).collect();
            for (axis, blur) in view.blur_mm(&pupil).into_iter().enumerate() {
                let square =
                    places.iter().map(|place| place[axis].powi(2)).sum::<f64>() / places.len() as f64;
                assert!((square.sqrt() / blur - 1.0).abs() < 1e-9, "{beta:?} {axis}: {square} {blur}");
            }
        }
    }

    #[test]
    fn discs_have_mean_square_radius_of_one_half() {
        for rings in 1..6 {
            let points = disc(rings);
            let sum =
                |of: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
            assert!((sum(&|p| p[0] * p[0] + p[1] * p[1]) - 0.5).abs() < 1e-12);
            assert!(sum(&|p| p[0]).abs() < 1e-12 && sum(&|p| p[1]).abs() < 1e-12);
        }
    }
}
