//! Light about a point, the same in all directions, by place from its transform.
//!
//! The transform is sampled at multiples of a step. Strips and rings follow by Fourier and Hankel series with
//! the period 1/step.

use std::f64::consts::PI;

use papilio_transport::spatial::PixelSpread;

use super::bessel;

/// Number of rings with which cells are filled.
const RINGS: usize = 300;

/// Light of several states about a point.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub(super) step_per_mm: f64,
    /// Sharp image of each state.
    pub(super) sharp: Vec<f64>,
    /// Other light at each frequency of the series, `[state][frequency]`.
    pub(super) rest: Vec<Vec<f64>>,
    /// Place of the point, mm.
    pub(super) at_mm: [f64; 2],
    /// Light of each state that spreads inside the pixel and is not returned to it.
    pub(super) inside: Option<(PixelSpread, Vec<f64>)>,
}

impl Series {
    fn states(&self) -> usize {
        self.sharp.len()
    }

    /// Number of frequencies.
    fn count(&self) -> usize {
        self.rest.first().map_or(0, Vec::len)
    }

    /// Adds a part of the light that spreads inside the pixel.
    fn with_inside(&self, mut sums: Vec<f64>, part: impl FnOnce(&PixelSpread) -> f64) -> Vec<f64> {
        if let Some((spread, light)) = &self.inside {
            let part = part(spread);
            sums.iter_mut().zip(light).for_each(|(sum, light)| *sum += light * part);
        }
        sums
    }

    /// Light of each state on the lower side of a place along an axis.
    fn below(&self, axis: usize, at_mm: f64) -> Vec<f64> {
        let at_mm = at_mm - self.at_mm[axis];
        let step = if at_mm == 0.0 { 0.5 } else { f64::from(at_mm > 0.0) };
        let (sin, cos) = (2.0 * PI * at_mm * self.step_per_mm).sin_cos();
        // The mean of the period has been spread uniformly over it.
        let even = 0.5 + at_mm * self.step_per_mm;
        let states = self.sharp.iter().zip(&self.rest);
        let mut sums: Vec<f64> = states.map(|(sharp, rest)| sharp * step + rest[0] * even).collect();
        let (mut s, mut c) = (0.0_f64, 1.0_f64);
        for k in 1..self.count() {
            (s, c) = (s * cos + c * sin, c * cos - s * sin);
            let factor = s / (PI * k as f64);
            sums.iter_mut().zip(&self.rest).for_each(|(sum, rest)| *sum += rest[k] * factor);
        }
        self.with_inside(sums, |spread| spread.below(at_mm))
    }

    /// `J_0` at the frequencies of the series above 0, for a distance; none for the distance 0, where it is 1.
    fn waves(&self, distance_mm: f64) -> Option<Vec<f64>> {
        let turn = 2.0 * PI * self.step_per_mm * distance_mm;
        (distance_mm > 0.0).then(|| bessel::multiples(0, turn, self.count().saturating_sub(1)))
    }

    /// Light of each state within a radius above 0 about the view's own ray. `distance_mm`: of the point from
    /// there, with its waves.
    fn within(&self, radius_mm: f64, distance_mm: f64, waves: Option<&[f64]>) -> Vec<f64> {
        let step = self.step_per_mm;
        let turn = 2.0 * PI * step;
        let mut factors = bessel::multiples(1, turn * radius_mm, self.count().saturating_sub(1));
        if let Some(waves) = waves {
            factors.iter_mut().zip(waves).for_each(|(factor, wave)| *factor *= wave);
        }
        // The trapezoidal rule, with the slope of the integrand at 0.
        let slope = step * step / 12.0 * PI * radius_mm;
        let of_state = |(rest, sharp): (&Vec<f64>, &f64)| {
            let mut sum = slope * rest[0];
            rest[1..].iter().zip(&factors).for_each(|(rest, factor)| sum += rest * (step * factor));
            let own = if distance_mm < radius_mm { *sharp } else { 0.0 };
            own + 2.0 * PI * radius_mm * sum
        };
        let sums = self.rest.iter().zip(&self.sharp).map(of_state).collect();
        self.with_inside(sums, |spread| spread.within(radius_mm, distance_mm))
    }

    /// Light between ascending borders, from what is below each, `[state][bin]`.
    fn bins(&self, below: impl Fn(f64) -> Vec<f64>, edges: &[f64]) -> Vec<Vec<f64>> {
        let mut bins: Vec<Vec<f64>> =
            (0..self.states()).map(|_| Vec::with_capacity(edges.len() + 1)).collect();
        let mut last = vec![0.0; self.states()];
        let total = (0..self.states()).map(|state| self.sharp[state] + self.rest[state][0]).collect();
        let total = self.with_inside(total, |_| 1.0);
        for now in edges.iter().map(|edge| below(*edge)).chain([total]) {
            for (state, bins) in bins.iter_mut().enumerate() {
                bins.push(now[state] - last[state]);
            }
            last = now;
        }
        bins
    }

    /// Light of strips, as in [`Response`](super::Response).
    pub(super) fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        self.bins(|at| self.below(axis, at), edges_mm)
    }

    /// Light of rings about the view's own ray.
    pub(super) fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        let distance = self.at_mm[0].hypot(self.at_mm[1]);
        let waves = self.waves(distance);
        self.bins(|at| self.within(at, distance, waves.as_deref()), radii_mm)
    }

    /// Light of cells.
    pub(super) fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        let about = |edges: &[f64], axis: usize| -> Vec<f64> {
            edges.iter().map(|edge| edge - self.at_mm[axis]).collect()
        };
        let (x_mm, y_mm) = (about(x_mm, 0), about(y_mm, 1));
        let most = [&x_mm, &y_mm].map(|edges| edges.iter().fold(0.0_f64, |most, x| most.max(x.abs())));
        let step = most[0].hypot(most[1]) / RINGS as f64;
        let radii: Vec<f64> = (1..=RINGS).map(|k| k as f64 * step).collect();
        let rings = self.bins(|at| self.within(at, 0.0, None), &radii);
        let columns = x_mm.len() - 1;
        let of_state = |state: usize| {
            let mut cells = vec![0.0; columns * (y_mm.len() - 1)];
            for (row, y) in y_mm.windows(2).enumerate() {
                for (column, x) in x_mm.windows(2).enumerate() {
                    let cell = &mut cells[row * columns + column];
                    let [width, height] = [x, y].map(|ends| ends[1] - ends[0]);
                    for (i, j) in (0..9).map(|k| (k % 3, k / 3)) {
                        let at =
                            [x[0] + width * (i as f64 + 0.5) / 3.0, y[0] + height * (j as f64 + 0.5) / 3.0];
                        let ring = ((at[0].hypot(at[1]) / step) as usize).min(RINGS - 1);
                        let sharp = if ring == 0 { self.sharp[state] } else { 0.0 };
                        let area = PI * step * step * (2 * ring + 1) as f64;
                        *cell += (rings[state][ring] - sharp) / area * width * height / 9.0;
                    }
                    if (x[0]..x[1]).contains(&0.0) && (y[0]..y[1]).contains(&0.0) {
                        *cell += self.sharp[state];
                    }
                }
            }
            cells
        };
        (0..self.states()).map(of_state).collect()
    }
}

/// Adds light by state and bin.
pub(super) fn add(sums: &mut Vec<Vec<f64>>, more: Vec<Vec<f64>>) {
    if sums.is_empty() {
        *sums = more;
        return;
    }
    for (sums, more) in sums.iter_mut().zip(more) {
        sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
    }
}
