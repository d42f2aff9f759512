//! A surface as heights over a periodic rectangle.

use crate::MicrogeometryError;

/// Largest difference of heights, in distances between them. A ray that comes in at 85 deg crosses eleven
/// times as many cells before it can meet the lowest height.
const MOST_RELIEF: f64 = 10_000.0;

/// A step where periods meet is that of a tilt if it is so many times as large as its scatter along the seam, and as
/// the steps between neighbours elsewhere.
const CLEAR: f64 = 4.0;

/// Rounding errors of heights, relative to the largest one: those of a file of 32 bits.
const ROUNDING: f64 = 1e-6;

/// Heights over a rectangle that repeats in x and y.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap {
    columns: usize,
    pitch_um: [f64; 2],
    heights_um: Vec<f64>,
}

impl HeightMap {
    /// Heights by rows; the first row is at y = 0, the first column at x = 0. `pitch_um`: distance between
    /// heights along x and y.
    ///
    /// # Errors
    /// A number of heights that is not a positive multiple of the columns, a height that is not finite, a
    /// distance that is not positive.
    pub fn new(columns: usize, pitch_um: [f64; 2], heights_um: Vec<f64>) -> Result<Self, MicrogeometryError> {
        let rows = heights_um.len().checked_div(columns).unwrap_or(0);
        if rows == 0 || rows * columns != heights_um.len() {
            return Err(MicrogeometryError::NumberOfHeights { columns, rows, heights: heights_um.len() });
        }
        if let Some(value) = pitch_um.into_iter().find(|pitch| !(pitch.is_finite() && *pitch > 0.0)) {
            return Err(MicrogeometryError::NotANumber {
                of: "a height map",
                what: "pitch (um)",
                value,
                wanted: "positive",
            });
        }
        if let Some(value) = heights_um.iter().copied().find(|height| !height.is_finite()) {
            return Err(MicrogeometryError::NotANumber {
                of: "a height map",
                what: "height (um)",
                value,
                wanted: "finite",
            });
        }
        Ok(Self { columns, pitch_um, heights_um })
    }

    /// Fails for heights that differ so much that rays would cross cells without an end before they meet the
    /// surface.
    ///
    /// # Errors
    /// A difference of more than 10,000 distances between heights.
    pub fn check_relief(&self) -> Result<(), MicrogeometryError> {
        let [low, high] =
            self.heights_um.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| {
                [low.min(*height), high.max(*height)]
            });
        let pitch_um = self.pitch_um[0].min(self.pitch_um[1]);
        if high - low > MOST_RELIEF * pitch_um {
            return Err(MicrogeometryError::Relief {
                low_um: low,
                high_um: high,
                pitch_um,
                most: MOST_RELIEF,
            });
        }
        Ok(())
    }

    /// Root mean square slopes along x and y between neighbours within the map; 0 along an axis of a single
    /// height.
    pub fn inner_slopes(&self) -> [f64; 2] {
        let squares = |axis: usize| {
            let next = [1, self.columns][axis];
            let is_inner = |at: &usize| match axis {
                0 => at % self.columns + 1 < self.columns,
                _ => at + next < self.heights_um.len(),
            };
            let slopes = (0..self.heights_um.len())
                .filter(is_inner)
                .map(|at| ((self.heights_um[at + next] - self.heights_um[at]) / self.pitch_um[axis]).powi(2));
            let (count, sum) = slopes.fold((0.0, 0.0), |(count, sum), square| (count + 1.0, sum + square));
            if count > 0.0 { (sum / count).sqrt() } else { 0.0 }
        };
        [squares(0), squares(1)]
    }

    /// A flat face.
    pub fn flat() -> Self {
        Self { columns: 1, pitch_um: [1.0; 2], heights_um: vec![0.0] }
    }

    /// The same places with other heights, as many as before.
    pub(crate) fn with_heights(&self, heights_um: Vec<f64>) -> Self {
        Self { columns: self.columns, pitch_um: self.pitch_um, heights_um }
    }

    /// Heights along x.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Heights along y.
    pub fn rows(&self) -> usize {
        self.heights_um.len() / self.columns
    }

    /// Distances between heights along x and y, um.
    pub fn pitch_um(&self) -> [f64; 2] {
        self.pitch_um
    }

    /// Width and height of the rectangle, um.
    pub fn period_um(&self) -> [f64; 2] {
        [self.pitch_um[0] * self.columns as f64, self.pitch_um[1] * self.rows() as f64]
    }

    /// All heights by rows, um.
    pub fn heights_um(&self) -> &[f64] {
        &self.heights_um
    }

    /// The map without its mean plane: that of the least squares of the differences. It is for a part of a
    /// surface; a whole period has none but its mean height: [`levelled_period`](Self::levelled_period).
    #[must_use]
    pub fn levelled(&self) -> Self {
        let (columns, rows) = (self.columns as f64, self.rows() as f64);
        let mut along = [0.0; 2];
        for (at, height) in self.heights_um.iter().enumerate() {
            let [x, y] = self.about_middle(at);
            along[0] += x * height;
            along[1] += y * height;
        }
        // On a grid about its middle, the three terms are orthogonal.
        let squares = |count: f64| count * (count * count - 1.0) / 12.0;
        self.without_plane([
            if columns > 1.0 { along[0] / (squares(columns) * rows) } else { 0.0 },
            if rows > 1.0 { along[1] / (squares(rows) * columns) } else { 0.0 },
        ])
    }

    /// The map without its mean height, as a period that repeats, and how much it rises along x and y, um, from one
    /// end of the period to the other by a tilt that is subtracted, too.
    ///
    /// A period has no mean slope. The plane of the least squares has one, also of a sine, and would leave a step
    /// where periods meet. Only where heights have such a step, nearly the same all along the seam and larger than
    /// any between neighbours elsewhere, they are those of a tilted surface.
    #[must_use]
    pub fn levelled_period(&self) -> (Self, [f64; 2]) {
        let rises = [self.rise_at_seam(0), self.rise_at_seam(1)];
        let counts = [self.columns, self.rows()];
        (self.without_plane([0, 1].map(|axis| rises[axis] / counts[axis] as f64)), rises)
    }

    /// The rise along an axis of the plane that explains the step where periods meet; 0 if none does.
    fn rise_at_seam(&self, axis: usize) -> f64 {
        let (counts, strides) = ([self.columns, self.rows()], [1, self.columns]);
        let [count, lines] = [counts[axis], counts[1 - axis]];
        // A single line of few heights has nothing with which the step could be compared.
        if count < 3 || count < 5 && lines == 1 {
            return 0.0;
        }
        let rise = |place: usize, line: usize| {
            let at = |place: usize| self.heights_um[place % count * strides[axis] + line * strides[1 - axis]];
            at(place + 1) - at(place)
        };
        // How much more a line rises between two places than beside them.
        let step = |place: usize, line: usize| {
            rise(place, line) - 0.5 * (rise(place + count - 1, line) + rise(place + 1, line))
        };
        let mean = |place: usize| (0..lines).map(|line| step(place, line)).sum::<f64>() / lines as f64;
        let at_seam = mean(count - 1);
        let squares: f64 = (0..lines).map(|line| (step(count - 1, line) - at_seam).powi(2)).sum();
        let elsewhere = (1..count - 2).map(|place| mean(place).abs());
        let most = elsewhere.fold((squares / lines as f64).sqrt(), f64::max);
        let highest = self.heights_um.iter().fold(0.0_f64, |highest, height| highest.max(height.abs()));
        if at_seam.abs() > CLEAR * most.max(ROUNDING * highest) { -at_seam } else { 0.0 }
    }

    /// Column and row of a height about the middle of the map.
    fn about_middle(&self, at: usize) -> [f64; 2] {
        let middle = [self.columns, self.rows()].map(|count| 0.5 * (count as f64 - 1.0));
        [(at % self.columns) as f64 - middle[0], (at / self.columns) as f64 - middle[1]]
    }

    /// The map without its mean height and a plane with these slopes, um per column and row.
    fn without_plane(&self, slopes: [f64; 2]) -> Self {
        let mean = self.heights_um.iter().sum::<f64>() / self.heights_um.len() as f64;
        let level = |(at, height): (usize, &f64)| {
            let [x, y] = self.about_middle(at);
            height - mean - slopes[0] * x - slopes[1] * y
        };
        Self { heights_um: self.heights_um.iter().enumerate().map(level).collect(), ..self.clone() }
    }

    /// The map with its mirror images beside and above it: a period without steps.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let rows = self.heights_um.chunks_exact(self.columns);
        let doubled = rows.map(|row| row.iter().chain(row.iter().rev()).copied().collect::<Vec<f64>>());
        let below: Vec<Vec<f64>> = doubled.collect();
        let heights_um = below.iter().chain(below.iter().rev()).flatten().copied().collect();
        Self { columns: 2 * self.columns, pitch_um: self.pitch_um, heights_um }
    }

    /// A part of this many columns and rows, from a column and row on; beyond its edges the map repeats. None
    /// of the numbers may be 0.
    #[must_use]
    pub fn part(&self, first: [usize; 2], count: [usize; 2]) -> Self {
        let row = |row: usize| {
            let start = (first[1] + row) % self.rows() * self.columns;
            (0..count[0]).map(move |column| self.heights_um[start + (first[0] + column) % self.columns])
        };
        Self { columns: count[0], pitch_um: self.pitch_um, heights_um: (0..count[1]).flat_map(row).collect() }
    }

    /// Statistics of the heights and of the slopes between neighbours.
    pub fn statistics(&self) -> HeightStatistics {
        let count = self.heights_um.len() as f64;
        let mean = self.heights_um.iter().sum::<f64>() / count;
        let square = |sum: f64| (sum / count).sqrt();
        let slope = |axis: usize| {
            let of = |at: usize| {
                let (row, column) = (at / self.columns, at % self.columns);
                let next = match axis {
                    0 => row * self.columns + (column + 1) % self.columns,
                    _ => (row + 1) % self.rows() * self.columns + column,
                };
                ((self.heights_um[next] - self.heights_um[at]) / self.pitch_um[axis]).powi(2)
            };
            square((0..self.heights_um.len()).map(of).sum())
        };
        HeightStatistics {
            rms_um: square(self.heights_um.iter().map(|height| (height - mean).powi(2)).sum()),
            slope_rms: [slope(0), slope(1)],
        }
    }
}

/// Statistics of a height map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightStatistics {
    /// Root mean square height about the mean, um.
    pub rms_um: f64,
    /// Root mean square slope between neighbours along x and y.
    pub slope_rms: [f64; 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inner_slopes_leave_out_the_edges_of_the_period() {
        // A plane of slopes 1/2 and -1/4: its period has steps.
        let height = |at: usize| 0.5 * (at % 4) as f64 * 2.0 - 0.25 * (at / 4) as f64 * 3.0;
        let map = HeightMap::new(4, [2.0, 3.0], (0..20).map(height).collect()).unwrap();
        let [x, y] = map.inner_slopes();
        assert!((x - 0.5).abs() < 1e-12 && (y - 0.25).abs() < 1e-12, "{x} {y}");
        assert!(map.statistics().slope_rms[0] > 0.8);
        assert_eq!(HeightMap::flat().inner_slopes(), [0.0; 2]);
    }

    /// Waves of whole periods along x and y, and what is level of them: whatever the phase, they have no tilt.
    #[test]
    fn periods_keep_their_waves_and_lose_their_tilt() {
        let (columns, rows, turn) = (48, 20, std::f64::consts::TAU);
        let wave = |at: usize| {
            let [x, y] = [(at % columns) as f64 / columns as f64, (at / columns) as f64 / rows as f64];
            0.2 * (turn * x).sin()
                + 0.1 * (turn * (2.0 * y + 0.1)).cos()
                + 0.05 * (turn * (3.0 * x + y)).sin()
        };
        let map = |height: &dyn Fn(usize) -> f64| {
            HeightMap::new(columns, [1.0; 2], (0..columns * rows).map(height).collect()).unwrap()
        };
        let differs = |map: &HeightMap| {
            let heights = map.heights_um().iter().enumerate();
            heights.map(|(at, height)| (height - wave(at)).abs()).fold(0.0, f64::max)
        };
        let (level, rises) = map(&|at| wave(at) + 7.0).levelled_period();
        assert!(rises == [0.0; 2] && differs(&level) < 1e-12, "{rises:?}");
        // The plane of the least squares is no part of the period.
        assert!(differs(&map(&wave).levelled()) > 0.05);
        let tilted = |at: usize| wave(at) + 4.0 * (at % columns) as f64 / columns as f64;
        let (level, [x, y]) = map(&tilted).levelled_period();
        // Beside the seam, the waves are not quite straight.
        assert!((x - 4.0).abs() < 2e-3 && y == 0.0 && differs(&level) < 2e-3, "{x} {y}");
        // Steps that the period has elsewhere, too, are its own; so are those that differ along the seam.
        let comb = |at: usize| ((at % columns) % 12) as f64 / 12.0;
        assert_eq!(map(&comb).levelled_period().1, [0.0; 2]);
        let torn = |at: usize| 0.1 * (at % columns) as f64 * (0.7 * (at / columns) as f64).sin();
        assert_eq!(map(&torn).levelled_period().1, [0.0; 2]);
    }

    #[test]
    fn heights_that_rays_would_not_reach_are_refused() {
        let map = |height: f64| HeightMap::new(2, [1.0, 2.0], vec![0.0, 0.0, 0.0, height]).unwrap();
        assert_eq!(map(-10_000.0).check_relief(), Ok(()));
        assert!(matches!(map(10_001.0).check_relief(), Err(MicrogeometryError::Relief { .. })));
    }
}
