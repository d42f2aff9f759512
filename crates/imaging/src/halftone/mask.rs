//! Threshold masks: the order in which the pixels of a periodic cell are switched on.

use papilio_sampling::{SampleStream, Sampler};

use crate::ImagingError;

/// Largest number of columns and of rows of a mask.
const MOST_SIDE: usize = 256;

/// Threshold mask: a periodic cell whose pixels have ranks from 0 to one less than their number.
///
/// A pixel of rank r is on for a coverage above (r + 1/2)/n, n = number of pixels, so that a uniform coverage
/// c switches the nearest number of pixels to c n on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mask {
    columns: usize,
    ranks: Vec<u32>,
}

impl Mask {
    /// Bayer's mask of `side` x `side` pixels, `side` = 2, 4, 8 or 16 (B. E. Bayer, IEEE ICC 1973, 26-11).
    /// The first row of four is 0 8 2 10.
    ///
    /// Its pattern is regular: hardly visible on flat areas at fine pitches, with visible structure at coarse
    /// ones.
    ///
    /// # Errors
    /// For other sides.
    pub fn bayer(side: usize) -> Result<Self, ImagingError> {
        if !matches!(side, 2 | 4 | 8 | 16) {
            return Err(ImagingError::MaskSide { side, expected: "2, 4, 8 or 16" });
        }
        let mut mask = vec![0];
        let mut columns = 1;
        while columns < side {
            let wide = 2 * columns;
            let rank = |at: usize| {
                let (x, y) = (at % wide, at / wide);
                let within = mask[y % columns * columns + x % columns];
                let quadrant = [[0, 2], [3, 1]][y / columns][x / columns];
                4 * within + quadrant
            };
            mask = (0..wide * wide).map(rank).collect();
            columns = wide;
        }
        Ok(Self { columns, ranks: mask })
    }

    /// Void-and-cluster mask of `side` x `side` pixels, 4 to 256 (R. A. Ulichney, Proc. SPIE 1913, 332,
    /// 1993), with his Gaussian of sigma 1.5 pixels. Another `seed` gives another mask of the same quality.
    ///
    /// Its noise has hardly any low frequencies and no direction. A mask of 64 x 64 pixels takes about 20 ms.
    ///
    /// # Errors
    /// For other sides.
    pub fn void_and_cluster(side: usize, seed: u64) -> Result<Self, ImagingError> {
        if !(4..=MOST_SIDE).contains(&side) {
            return Err(ImagingError::MaskSide { side, expected: "4 to 256" });
        }
        Ok(Self { columns: side, ranks: Crowding::new(side).ranks(seed) })
    }

    /// Number of columns of the cell.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows of the cell.
    pub fn rows(&self) -> usize {
        self.ranks.len() / self.columns
    }

    /// Ranks by rows, the first row at the top.
    pub fn ranks(&self) -> &[u32] {
        &self.ranks
    }

    /// This mask, moved to the right and down with its opposite sides joined.
    pub fn shifted(&self, right: usize, down: usize) -> Self {
        let (columns, rows) = (self.columns, self.rows());
        let from = |at: usize| {
            let x = (at % columns + columns - right % columns) % columns;
            let y = (at / columns + rows - down % rows) % rows;
            self.ranks[y * columns + x]
        };
        Self { columns, ranks: (0..self.ranks.len()).map(from).collect() }
    }

    /// Thresholds by rows: (rank + 1/2)/number of pixels.
    pub fn thresholds(&self) -> Vec<f32> {
        let count = self.ranks.len() as f64;
        self.ranks.iter().map(|rank| ((f64::from(*rank) + 0.5) / count) as f32).collect()
    }
}

/// Standard deviation of Ulichney's Gaussian, pixels.
const SIGMA: f64 = 1.5;

/// The Gaussian is below 2e-10 beyond this distance.
const REACH: usize = 10;

/// A periodic pattern of pixels, and how crowded it is around each of them.
///
/// The Gaussian is kept in whole units of 2^-40: sums are exact, so that they do not depend on the order of
/// the steps.
#[derive(Clone)]
struct Crowding {
    side: usize,
    /// Gaussian of the distance along the cell to the right and down, by rows.
    gaussian: Vec<i64>,
    on: Vec<bool>,
    sums: Vec<i64>,
}

impl Crowding {
    fn new(side: usize) -> Self {
        let reach = REACH.min((side - 1) / 2) as isize;
        let width = (2 * reach + 1) as usize;
        let value = |at: usize| {
            let (x, y) = ((at % width) as isize - reach, (at / width) as isize - reach);
            let squared = (x * x + y * y) as f64;
            ((-squared / (2.0 * SIGMA * SIGMA)).exp() * 2.0_f64.powi(40)) as i64
        };
        let gaussian = (0..width * width).map(value).collect();
        Self { side, gaussian, on: vec![false; side * side], sums: vec![0; side * side] }
    }

    /// Switches a pixel.
    fn switch(&mut self, at: usize) {
        let side = self.side;
        let sign = if self.on[at] { -1 } else { 1 };
        self.on[at] = !self.on[at];
        let width = self.gaussian.len().isqrt();
        let (x, y) = (at % side + side - width / 2, at / side + side - width / 2);
        for (row, values) in self.gaussian.chunks_exact(width).enumerate() {
            let start = (y + row) % side * side;
            for (column, value) in values.iter().enumerate() {
                self.sums[start + (x + column) % side] += sign * value;
            }
        }
    }

    /// The most crowded pixel that is on; among several, the first.
    fn tightest_cluster(&self) -> usize {
        let on = (0..self.on.len()).filter(|at| self.on[*at]);
        on.min_by_key(|at| -self.sums[*at]).unwrap_or(0)
    }

    /// The least crowded pixel that is off; among several, the first.
    fn largest_void(&self) -> usize {
        let off = (0..self.on.len()).filter(|at| !self.on[*at]);
        off.min_by_key(|at| self.sums[*at]).unwrap_or(0)
    }

    /// Ranks all pixels.
    fn ranks(mut self, seed: u64) -> Vec<u32> {
        let count = self.on.len();
        let first = self.spread_out(seed);
        let mut ranks = vec![0; count];
        // Pixels of the first pattern, the most crowded last.
        let mut thinner = self.clone();
        for rank in (0..first).rev() {
            let at = thinner.tightest_cluster();
            thinner.switch(at);
            ranks[at] = rank as u32;
        }
        // Beyond half, Ulichney looks for the most crowded pixel that is off among those that are off. The
        // two Gaussian sums add up to the same number everywhere, so that it is the largest void again.
        for rank in first..count {
            let at = self.largest_void();
            self.switch(at);
            ranks[at] = rank as u32;
        }
        ranks
    }

    /// Switches a tenth of the pixels on at random, and moves them apart until no move helps. Returns their
    /// number.
    fn spread_out(&mut self, seed: u64) -> usize {
        let count = self.on.len();
        let numbers = SampleStream::new(Sampler::Random, seed, 0);
        let (mut wanted, mut path) = ((count / 10).max(1), 0);
        let first = wanted;
        while wanted > 0 {
            for number in numbers.block(path, 0) {
                let at = (number * count as f64) as usize;
                if wanted > 0 && !self.on[at] {
                    self.switch(at);
                    wanted -= 1;
                }
            }
            path += 1;
        }
        // Each move lowers the crowding, or the two are the same pixel; the bound only guards against a tie
        // that moves in a circle.
        for _ in 0..100 * count {
            let cluster = self.tightest_cluster();
            self.switch(cluster);
            let void = self.largest_void();
            self.switch(void);
            if void == cluster {
                break;
            }
        }
        first
    }
}
