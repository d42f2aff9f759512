//! Integrals over directions in glass by the place that they show, for tests: smooth between places where areas have kinks.

use papilio_optics::Beta;
use papilio_optics::quadrature::gauss;

/// Index of the glass.
const INDEX: f64 = 1.5;
/// Tangent of the inclination along x beyond which light is summed as one.
const FARTHEST: f64 = 30.0;

/// Tangent in the glass of light with these direction cosines along x.
pub(crate) fn tangent(beta_x: f64) -> f64 {
    beta_x / (INDEX * INDEX - beta_x * beta_x).sqrt()
}

/// Tangents along x, divided where light or an area changes quickly.
pub(crate) struct Tangents {
    /// Direction cosine along x of a peak of the light in the plane of x, and its width; `None` of light from everywhere.
    pub(crate) peak: Option<(f64, f64)>,
    /// Width of the change of light where direction cosines are 1.
    pub(crate) rim: f64,
    /// The first place with a kink, and their distance.
    pub(crate) first: f64,
    pub(crate) step: f64,
}

impl Tangents {
    /// Calls `each` with tangents along x and their part of `light`, a density over direction cosines that is the same on both sides of
    /// the plane of x; returns the light beyond them. Gauss's rule is between the divisions; across, the trapezoidal rule in `q` of
    /// `y = c sinh q` converges exponentially.
    pub(crate) fn each(&self, light: &dyn Fn(Beta) -> f64, each: &mut dyn FnMut(f64, f64)) -> f64 {
        let across = |x: f64| -> f64 {
            let (scale, steps) = match self.peak {
                Some((at, width)) => ((width / INDEX).hypot(x - tangent(at)), 120),
                None => (0.3, (40.0 / self.rim) as i32),
            };
            let step = (1e4 / scale).asinh() / f64::from(steps);
            let one = |k: i32| {
                let q = step * f64::from(k);
                let (sinh, cosh) = (q.sinh(), q.cosh());
                let slant = 1.0 + x * x + (scale * sinh).powi(2);
                let beta = Beta { x: INDEX * x / slant.sqrt(), y: INDEX * scale * sinh / slant.sqrt() };
                let sides = if k == 0 { 1.0 } else { 2.0 };
                sides * step * scale * cosh * light(beta) * (INDEX / slant).powi(2)
            };
            (0..=steps).map(one).sum()
        };
        let edges = self.edges();
        for pair in edges.windows(2).filter(|pair| pair[1] - pair[0] > 1e-12) {
            gauss(pair[0], pair[1], 10).for_each(|(x, weight)| each(x, weight * across(x)));
        }
        let beyond = |end: &f64| -> f64 {
            gauss(0.0, 1.0, 10).map(|(s, weight)| weight * across(end / s) * end.abs() / (s * s)).sum()
        };
        edges.first().map_or(0.0, beyond) + edges.last().map_or(0.0, beyond)
    }

    fn edges(&self) -> Vec<f64> {
        let twice = |first: f64, most: f64| {
            std::iter::successors(Some(first), |x| Some(2.0 * x)).take_while(move |x| *x < most)
        };
        let mut edges = Vec::new();
        for side in [-1.0, 1.0] {
            let kinks = (0..).map(|k| self.step * f64::from(k)).take_while(|x| *x < FARTHEST);
            edges.extend(kinks.map(|x| self.first + side * x));
            let (middle, width) = self.peak.unwrap_or((0.0, 0.1));
            edges.extend(twice(0.2 * width, FARTHEST).map(|x| tangent(middle) + side * x));
            let rim = side * tangent(1.0);
            edges.extend(twice(0.2 * self.rim, 0.5).flat_map(|x| [rim - x, rim + x]));
        }
        edges.sort_by(f64::total_cmp);
        edges
    }
}
