//! Light that a flat face returns to a Lambertian plane below it.
//!
//! **What.** Light that leaves the plane at an inclination theta in a medium of thickness d comes back at a
//! distance of `2 d tan(theta)`, weakened by the reflectance F of the face (1 beyond the critical angle):
//! `A(f) = 2 integral of F(theta) J_0(4 pi f d tan(theta)) sin(theta) cos(theta) dtheta`.
//!
//! If all light came back, the integral would be `a K_1(a)`, a = 4 pi f d. What the face lets through is
//! subtracted: an integral up to the critical angle, in which the transmittance ends as a square root.
//!
//! **Intuition.** A(0) of bare glass is 0.596. Most of it is totally reflected, beyond a circle of radius
//! `2 d tan(critical angle)`: A(f) is negative where that circle is half a period.
//!
//! **Source.** Clapper, Yule, J. Opt. Soc. Am. 43, 600 (1953) for f = 0 and infinity.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::numerics::bessel::{j0, x_k1};
use crate::numerics::quadrature::{Node, gauss};

/// Width of a panel of the rule in radians of the phase `4 pi f d tan(theta)`: 16 points then integrate to
/// 1e-14.
const PHASE_OF_PANEL: f64 = 8.0;
const POINTS: usize = 16;

/// Width of a panel of the table of what leaves, in radians of the phase at the critical angle, and the
/// points on each.
const PHASE_OF_TABLE: f64 = 4.0;
pub(super) const POINTS_OF_TABLE: usize = 16;

/// Highest frequency times the thickness. Beyond, about 1e-6 of the light comes back from a bare face of
/// glass, 1e-5 from one that reflects nothing within the critical angle.
const HIGHEST: f64 = 100.0;

/// Highest phase `4 pi f d tan(theta)` at the critical angle: at low indices it is far away, and little comes
/// back of high frequencies.
const MOST_PHASE: f64 = 2000.0;

/// Largest phase of a panel, and its largest width over its distance to the place where the transmittance and
/// the tangent are not analytic.
const MOST_PHASE_OF_PANEL: f64 = 16.0;
const WIDEST_PANEL: f64 = 2.0;

/// Step of the index below which a face reflects nothing.
const NO_INDEX_STEP: f64 = 1e-6;

/// Light that the face above a Lambertian plane returns to it, by spatial frequency.
#[derive(Debug, Clone)]
pub struct FaceReturn {
    thickness_mm: f64,
    /// The highest value of `a = 4 pi f d`.
    most: f64,
    /// tan(theta) at the critical angle.
    edge: f64,
    /// tan(theta) and the weight of what leaves.
    leaving: Vec<[f64; 2]>,
    table: Option<Table>,
    /// True above a medium like air, from which all light leaves.
    is_open: bool,
}

/// A over `a`, as Chebyshev polynomials.
#[derive(Debug, Clone)]
struct Table {
    /// Width of a panel.
    panel: f64,
    /// Coefficients on each panel: of what leaves on the first, where `a K_1(a)` is not analytic, of A on all
    /// others. What leaves is limited to the band of the critical angle, so that 16 points on a panel
    /// determine it to 1e-13.
    coefficients: Vec<[f64; POINTS_OF_TABLE]>,
}

impl FaceReturn {
    /// Prepares a face over a medium.
    ///
    /// - `transmittance`: of the face for light from below, 0 to 1, as a function of `|beta|` from 0 to 1.
    /// - `most_per_mm`: the highest frequency at which light comes back, cycles per mm: none does at higher
    ///   ones, nor above 100/thickness.
    pub fn new(index: f64, thickness_mm: f64, most_per_mm: f64, transmittance: impl Fn(f64) -> f64) -> Self {
        if index <= 1.0 + NO_INDEX_STEP {
            let nothing = Vec::new();
            return Self { thickness_mm, most: 0.0, edge: 0.0, leaving: nothing, table: None, is_open: true };
        }
        let edge = 1.0 / (index * index - 1.0).sqrt();
        let most = (4.0 * PI * (most_per_mm * thickness_mm).min(HIGHEST)).min(MOST_PHASE / edge);
        let panels = (most * edge / PHASE_OF_PANEL).ceil().max(1.0);
        // |beta| = 1 - (1 - v)^2: the square root at the critical angle becomes a straight line.
        let beta_at = |v: f64| 1.0 - (1.0 - v).powi(2);
        let tangent = |beta: f64| beta / (index * index - beta * beta).sqrt();
        // Near an index of 1 the tangent rises steeply at the critical angle: panels are divided.
        let mut divided: Vec<[f64; 2]> = Vec::new();
        let mut open: Vec<[f64; 2]> = (0..panels as usize)
            .rev()
            .map(|panel| [panel, panel + 1].map(|end| end as f64 / panels))
            .collect();
        while let Some([from, to]) = open.pop() {
            let phase = most * (tangent(beta_at(to)) - tangent(beta_at(from)));
            let is_wide = to - from > WIDEST_PANEL * ((index - 1.0).sqrt() + 1.0 - to);
            if phase > MOST_PHASE_OF_PANEL || is_wide {
                let middle = 0.5 * (from + to);
                open.extend([[middle, to], [from, middle]]);
            } else {
                divided.push([from, to]);
            }
        }
        // tan(theta) and the weight of what leaves.
        let node = |node: Node| {
            let beta = beta_at(node.x);
            let slope = 2.0 * (1.0 - node.x);
            // 2 sin cos dtheta = 2 beta dbeta / n^2
            [tangent(beta), 2.0 * beta * slope * node.weight / (index * index) * transmittance(beta)]
        };
        let leaving = divided.into_iter().flat_map(|[from, to]| gauss(from, to, POINTS)).map(node).collect();
        Self { thickness_mm, most, edge, leaving, table: None, is_open: false }
    }

    /// Tabulates the return up to the highest frequency, for callers that ask many frequencies: a value then
    /// takes 16 terms instead of an integral.
    #[must_use]
    pub fn tabulated(mut self) -> Self {
        if self.is_open {
            return self;
        }
        let count = (self.most * self.edge / PHASE_OF_TABLE).ceil().max(1.0);
        let panel = if self.most > 0.0 { self.most / count } else { 1.0 };
        let of_panel = |k: usize| {
            let ends = [k, k + 1].map(|end| end as f64 * panel);
            if k == 0 {
                chebyshev(ends, |a| self.leaving_at(a))
            } else {
                chebyshev(ends, |a| x_k1(a) - self.leaving_at(a))
            }
        };
        let coefficients = (0..count as usize).map(of_panel).collect();
        self.table = Some(Table { panel, coefficients });
        self
    }

    /// Fraction of the light from the plane, modulated at this frequency (cycles per mm), that comes back,
    /// with its sign.
    pub fn at(&self, frequency_per_mm: f64) -> f64 {
        if self.is_open {
            return 0.0;
        }
        let a = 4.0 * PI * frequency_per_mm.abs() * self.thickness_mm;
        if a > self.most * (1.0 + 1e-9) {
            return 0.0;
        }
        let known = self.table.as_ref().and_then(|table| table.at(a));
        known.unwrap_or_else(|| x_k1(a) - self.leaving_at(a))
    }

    fn leaving_at(&self, a: f64) -> f64 {
        self.leaving.iter().map(|[tangent, weight]| weight * j0(a * tangent)).sum()
    }
}

impl Table {
    fn at(&self, a: f64) -> Option<f64> {
        let place = a / self.panel;
        let panel = place as usize;
        let t = 2.0 * (place - panel as f64) - 1.0;
        let value = clenshaw(self.coefficients.get(panel)?, t);
        Some(if panel == 0 { x_k1(a) - value } else { value })
    }
}

/// Sum of Chebyshev polynomials at t, -1 to 1 (Clenshaw's recurrence).
pub(super) fn clenshaw([first, others @ ..]: &[f64; POINTS_OF_TABLE], t: f64) -> f64 {
    let [mut here, mut next] = [0.0; 2];
    for coefficient in others.iter().rev() {
        (here, next) = (2.0 * t * here - next + coefficient, here);
    }
    t * here - next + first
}

/// Chebyshev coefficients of the polynomial through the values of a function on an interval.
pub(super) fn chebyshev(ends: [f64; 2], of: impl Fn(f64) -> f64) -> [f64; POINTS_OF_TABLE] {
    chebyshev_of(&chebyshev_points(ends).map(of))
}

/// Returns the points between two ends at which a function is needed.
pub(super) fn chebyshev_points([from, to]: [f64; 2]) -> [f64; POINTS_OF_TABLE] {
    let angle = |k: usize| PI * (k as f64 + 0.5) / POINTS_OF_TABLE as f64;
    std::array::from_fn(|k| 0.5 * (from + to) + 0.5 * (to - from) * angle(k).cos())
}

/// Returns the coefficients of the polynomial through values at these points.
pub(super) fn chebyshev_of(values: &[f64; POINTS_OF_TABLE]) -> [f64; POINTS_OF_TABLE] {
    let angle = |k: usize| PI * (k as f64 + 0.5) / POINTS_OF_TABLE as f64;
    std::array::from_fn(|order| {
        let sum: f64 =
            values.iter().enumerate().map(|(k, value)| value * (order as f64 * angle(k)).cos()).sum();
        if order == 0 { sum / POINTS_OF_TABLE as f64 } else { 2.0 * sum / POINTS_OF_TABLE as f64 }
    })
}

/// Light that passes the face, is returned to it by a front of screen above an air gap, and passes it again,
/// by spatial frequency; of a front that reflects everything.
#[derive(Debug, Clone)]
pub(super) struct FrontReturn {
    /// Way in the plane of the panel, mm, and weight.
    ways: Vec<[f64; 2]>,
}

/// Light beyond this way, in units of the thickness and the gap, is taken as not modulated at any frequency
/// but 0.
const LONGEST_WAY: f64 = 30.0;

impl FrontReturn {
    /// Prepares the front over glass of this index.
    ///
    /// - `lengths_mm`: the glass, and the way through the air in all passes of the gap together, over 2.
    /// - `weight`: fraction of the light at `|beta|` that comes back.
    pub(super) fn new(
        index: f64,
        [glass_mm, air_mm]: [f64; 2],
        most_per_mm: f64,
        weight: impl Fn(f64) -> f64,
    ) -> Self {
        let way = |beta: f64| {
            let air = beta / (1.0 - beta * beta).max(1e-30).sqrt();
            2.0 * (glass_mm * beta / (index * index - beta * beta).sqrt() + air_mm * air)
        };
        // |beta| = sin x: panels of equal phase up to grazing light, which goes far and has little weight.
        let longest = LONGEST_WAY * (glass_mm + air_mm);
        let mut edges = vec![0.0];
        let step = (PHASE_OF_PANEL / (2.0 * PI * most_per_mm)).min(0.25 * longest.max(1e-9));
        let mut next = step;
        while let Some(&from) = edges.last().filter(|_| next < longest) {
            let (mut low, mut high) = (from, FRAC_PI_2);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                *(if way(middle.sin()) < next { &mut low } else { &mut high }) = middle;
            }
            edges.push(0.5 * (low + high));
            next += step;
        }
        edges.push(FRAC_PI_2);
        let panels = edges.windows(2).flat_map(|pair| gauss(pair[0], pair[1], POINTS));
        let node = |node: Node| {
            let (beta, cos) = node.x.sin_cos();
            [way(beta), 2.0 * beta * cos * node.weight / (index * index) * weight(beta)]
        };
        Self { ways: panels.map(node).collect() }
    }

    /// Fraction of the light from the plane, modulated at this frequency (cycles per mm), that comes back,
    /// with its sign.
    pub(super) fn at(&self, frequency_per_mm: f64) -> f64 {
        let f = 2.0 * PI * frequency_per_mm.abs();
        self.ways.iter().map(|[way, weight]| weight * j0(f * way)).sum()
    }
}

#[cfg(test)]
mod tests {
    use papilio_optics::interface::fresnel_reflectance;

    use super::*;

    fn bare(most: f64) -> FaceReturn {
        FaceReturn::new(1.5, 1.0, most, |beta| 1.0 - fresnel_reflectance(1.5, 1.0, beta))
    }

    /// The same integral by mpmath, 25 digits.
    #[test]
    fn bare_glass_returns_known_fractions() {
        let face = bare(4.0);
        for (f, expected) in [
            (0.0, 0.596_345_759_7),
            (0.02, 0.534_521_369_4),
            (0.05, 0.376_797_250_2),
            (0.7 * 0.25, -0.036_948_007_21),
            (0.7 * 0.5, -0.022_824_849),
            (0.7, -0.004_842_359_222),
            (2.0, -0.001_742_633_089),
            (0.7 * 3.0, 0.000_773_073_973_4),
            (4.0, 0.000_232_979_901),
        ] {
            assert!((face.at(f) - expected).abs() < 1e-10, "{f}: {}", face.at(f));
        }
        let table = face.clone().tabulated();
        for step in 0..=400 {
            let f = 0.01 * f64::from(step);
            assert!((face.at(f) - table.at(f)).abs() < 1e-12, "{f}: {} {}", face.at(f), table.at(f));
        }
    }

    /// Air, nearly: the critical angle is at up to 89.7 deg, and the transmittance ends steeply there. The
    /// same integral by mpmath.
    #[test]
    fn low_indices_return_known_fractions() {
        for (index, known) in [
            (1.02, [0.044_648_460_32, 0.014_355_167_189, 3.045_186_618e-3, 5.200_716_56e-4, 2.080_179_79e-4]),
            (1.0006, [1.397_507_093_6e-3, 4.461_185_998e-5, 1.507_482_5e-6, -3.461_682e-7, 1.834_321e-7]),
            (1.00001, [2.333_243_554e-5, 3.702_415e-8, -1.392_5e-10, 9.7e-11, -5.7e-11]),
        ] {
            let new = |most: f64| {
                FaceReturn::new(index, 1.0, most, |beta| 1.0 - fresnel_reflectance(index, 1.0, beta))
            };
            for face in [new(0.5), new(0.5).tabulated(), new(100.0)] {
                for (f, expected) in [0.0, 0.02, 0.1, 0.3, 0.5].into_iter().zip(known) {
                    assert!((face.at(f) - expected).abs() < 1e-10, "{index} {f}: {} {expected}", face.at(f));
                }
                assert!(face.at(99.0).abs() < 1e-7, "{index}");
            }
        }
    }

    /// Only the product of frequency and thickness matters: halation under 0.7 mm of glass.
    #[test]
    fn thickness_scales_the_place_of_the_return() {
        let face = FaceReturn::new(1.5, 0.7, 3.0, |beta| 1.0 - fresnel_reflectance(1.5, 1.0, beta));
        for (f, expected) in [(0.05, 0.458_053_101), (0.1, 0.273_358_730_8), (1.0, -0.004_842_359_222)] {
            assert!((face.at(f) - expected).abs() < 1e-10, "{f}: {}", face.at(f));
        }
    }

    /// Without transmittance everything comes back, as between two plates; with an ideal antireflection face,
    /// only what is totally reflected.
    #[test]
    fn limits_of_the_face_have_closed_forms() {
        let mirror = FaceReturn::new(1.5, 1.0, 2.0, |_| 0.0);
        for (fd, expected) in [(0.05, 0.768_495), (0.1, 0.500_191), (0.2, 0.182_669)] {
            assert!((mirror.at(fd) - expected).abs() < 6e-7);
        }
        let ideal = FaceReturn::new(1.5, 1.0, 2.0, |_| 1.0);
        assert!((ideal.at(0.0) - (1.0 - 1.0 / 2.25)).abs() < 1e-14, "{}", ideal.at(0.0));
        // One pass of the escape cone alone, a = 2 pi f d: half the frequency of the return.
        for (fd, expected) in [(0.1, 0.968_544), (0.25, 0.815_237), (0.5, 0.406_787), (1.0, -0.050_498)] {
            let escape = (mirror.at(0.5 * fd) - ideal.at(0.5 * fd)) * 2.25;
            assert!((escape - expected).abs() < 6e-7, "{fd}: {escape} {expected}");
        }
    }

    #[test]
    fn rule_is_fine_enough_for_its_highest_frequency() {
        let (one, other) = (bare(6.0), bare(40.0));
        for f in [0.0, 0.3, 1.7, 6.0] {
            assert!((one.at(f) - other.at(f)).abs() < 1e-13, "{f}: {} {}", one.at(f), other.at(f));
        }
    }
}
