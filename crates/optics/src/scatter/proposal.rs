//! Sampling of directions from a kernel on a working grid, with exactly the stated density.
//!
//! Between nodes the density times the distance from the specular direction is bilinear. The distance is
//! sampled by its marginal, then the azimuth given the distance, both by inverting cumulative sums. Between
//! two incidences one of the two is selected. A small fraction of the directions is sampled uniformly from
//! the disc, so that weights are bounded.

use papilio_sampling::warp;

use super::albedos::turned;
use super::axis::Axis;
use crate::Beta;

/// Fraction of the directions that is sampled uniformly.
const EVEN: f64 = 1.0 / 64.0;

/// Density of directions for each incidence.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Proposal {
    incidence: Axis,
    radial: Axis,
    azimuth: Axis,
    /// The kernel times the distance, `[incidence][radial][azimuth]`.
    density: Vec<f64>,
    /// Integral over azimuth up to each node.
    around: Vec<f64>,
    /// Integral of the total over distance up to each node, `[incidence][radial]`.
    outward: Vec<f64>,
    /// Radius of the disc of scattered light: 1 in air.
    disc: f64,
}

impl Proposal {
    /// Tabulates a kernel on working nodes; light that it scatters well beyond a disc is left out.
    pub(super) fn new(axes: [&[f64]; 3], disc: f64, value: impl Fn(Beta, Beta) -> f64) -> Self {
        let [incidence, radial, azimuth] = axes.map(|nodes| Axis::mirrored(nodes.to_vec()));
        let mut density = Vec::with_capacity(axes.iter().map(|axis| axis.len()).product());
        let reach = |nodes: &[f64], i: usize| {
            let last = nodes.len() - 1;
            [i.max(1) - 1, i, (i + 1).min(last)].map(|i| nodes[i])
        };
        for (i, &length) in axes[0].iter().enumerate() {
            for (k, &r) in axes[1].iter().enumerate() {
                for (j, &angle) in axes[2].iter().enumerate() {
                    // A node counts if one of its cells has a corner on the disc.
                    let near = reach(axes[0], i).into_iter().any(|length| {
                        reach(axes[1], k).into_iter().any(|r| {
                            let on_disc = |a| turned(length, r, a)[1].squared() <= disc * disc;
                            reach(axes[2], j).into_iter().any(on_disc)
                        })
                    });
                    let [from, to] = turned(length, r, angle);
                    density.push(if near { r * value(from, to) } else { 0.0 });
                }
            }
        }
        let mut all =
            Self { incidence, radial, azimuth, density, around: Vec::new(), outward: Vec::new(), disc };
        all.integrate();
        all
    }

    fn integrate(&mut self) {
        let azimuths = self.azimuth.nodes();
        for row in self.density.chunks_exact(azimuths.len()) {
            self.around.extend(cumulative(azimuths, row.iter().copied()));
        }
        let distances = self.radial.nodes();
        for plane in self.around.chunks_exact(azimuths.len() * distances.len()) {
            let rows = plane.chunks_exact(azimuths.len()).map(|row| row[row.len() - 1]);
            self.outward.extend(cumulative(distances, rows));
        }
    }

    /// Samples a direction for light from `from`; it may lie beyond the disc.
    ///
    /// The last number makes all choices, one after the other.
    pub(super) fn sample(&self, from: Beta, [u, v, choice]: [f64; 3]) -> Beta {
        let even = || {
            let (x, y) = warp::uniform_disc(self.disc, [u, v]);
            Beta { x, y }
        };
        if choice < EVEN {
            return even();
        }
        let choice = (choice - EVEN) / (1.0 - EVEN);
        let length = from.length();
        let place = self.incidence.place(length);
        let (incidence, mut side) = if choice < place.t {
            (place.cell + 1, choice / place.t)
        } else {
            (place.cell, (choice - place.t) / (1.0 - place.t))
        };
        if self.whole(incidence) <= 0.0 {
            return even();
        }
        side -= 0.5;
        let (distance, azimuth) = self.draw(incidence, [u, v]);
        let (sin, cos) = azimuth.sin_cos();
        let (along, across) = (distance * cos, distance * sin.copysign(side));
        // Frame of the incidence; any frame along the normal.
        let (x, y) = if length > 0.0 { (from.x / length, from.y / length) } else { (1.0, 0.0) };
        from + Beta { x: along * x - across * y, y: along * y + across * x }
    }

    fn draw(&self, incidence: usize, u: [f64; 2]) -> (f64, f64) {
        let (distances, azimuths) = (self.radial.nodes(), self.azimuth.nodes());
        let outward = &self.outward[incidence * distances.len()..][..distances.len()];
        let row = |k: usize| (incidence * distances.len() + k) * azimuths.len();
        let around = |k: usize, j: usize| self.around[row(k) + j];
        let last = azimuths.len() - 1;
        let (k, share) = find(|k| outward[k], distances.len(), u[0]);
        let t = linear(around(k, last), around(k + 1, last), share);
        let distance = distances[k] + t * (distances[k + 1] - distances[k]);
        let at = |values: &[f64], j: usize| {
            let [near, far] = [values[row(k) + j], values[row(k + 1) + j]];
            near + t * (far - near)
        };
        let (j, share) = find(|j| at(&self.around, j), azimuths.len(), u[1]);
        let t = linear(at(&self.density, j), at(&self.density, j + 1), share);
        (distance, azimuths[j] + t * (azimuths[j + 1] - azimuths[j]))
    }

    /// Returns the integral over half the plane at an incidence.
    fn whole(&self, incidence: usize) -> f64 {
        let distances = self.radial.nodes().len();
        self.outward[incidence * distances + distances - 1]
    }

    /// Returns the density of [`Self::sample`] at a distance and azimuth, on the disc.
    #[inline]
    pub(super) fn density(&self, length: f64, distance: f64, azimuth: f64) -> f64 {
        let i = self.incidence.place(length);
        let even = warp::uniform_disc_density(self.disc);
        // The density is finite at the peak: it is the limit.
        let distance = distance.max(1e-9);
        let (k, j) = (self.radial.place(distance), self.azimuth.place(azimuth));
        let (distances, azimuths) = (self.radial.nodes().len(), self.azimuth.nodes().len());
        let of = |incidence: usize| {
            let whole = self.whole(incidence);
            if whole <= 0.0 {
                return even;
            }
            if distance > self.radial.last() {
                return 0.0;
            }
            let at = (incidence * distances + k.cell) * azimuths + j.cell;
            let along = |at: usize| self.density[at] + j.t * (self.density[at + 1] - self.density[at]);
            let [near, far] = [along(at), along(at + azimuths)];
            (near + k.t * (far - near)) / (2.0 * whole * distance)
        };
        let drawn = (1.0 - i.t) * of(i.cell) + i.t * of(i.cell + 1);
        EVEN * even + (1.0 - EVEN) * drawn
    }
}

/// Returns integrals up to each node of a function that is linear between them.
fn cumulative(nodes: &[f64], values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sum = 0.0;
    let mut before = None;
    let one = |(node, value): (&f64, f64)| {
        if let Some((start, first)) = before.replace((*node, value)) {
            sum += 0.5 * (first + value) * (node - start);
        }
        sum
    };
    nodes.iter().zip(values).map(one).collect()
}

/// Returns the cell of ascending sums in which a fraction `u` of the last is reached, and the position in
/// it.
fn find(sums: impl Fn(usize) -> f64, count: usize, u: f64) -> (usize, f64) {
    let wanted = u * sums(count - 1);
    let (mut low, mut high) = (0, count - 1);
    while high - low > 1 {
        let middle = (low + high) / 2;
        if sums(middle) <= wanted { low = middle } else { high = middle }
    }
    let (start, end) = (sums(low), sums(low + 1));
    let share = if end > start { (wanted - start) / (end - start) } else { 0.5 };
    (low, share.clamp(0.0, 1.0))
}

/// Returns the position at which the cumulative distribution of a density that is linear from a to b over 0
/// to 1 is this fraction.
fn linear(a: f64, b: f64, share: f64) -> f64 {
    let below = a + (a * a + share * (b * b - a * a)).max(0.0).sqrt();
    if below > 0.0 { (share * (a + b) / below).min(1.0) } else { share }
}
