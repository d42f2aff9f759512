//! Rows of pictures that are filtered one after the other: each stays for as long as others need it.
//!
//! All functions are inlined into the caller, which chooses the instructions of the processor.

/// Columns that are computed at once; rows end with some that count for nothing.
pub(super) const LANES: usize = 32;

/// A row of this many columns, with those that count for nothing.
pub(super) fn stride(columns: usize) -> usize {
    columns.next_multiple_of(LANES)
}

/// The last rows of a plane.
pub(super) struct Ring<T> {
    stride: usize,
    count: usize,
    values: Vec<T>,
}

impl<T: Copy + Default> Ring<T> {
    /// For `count` rows.
    pub(super) fn new(stride: usize, count: usize) -> Self {
        Self { stride, count, values: vec![T::default(); stride * count] }
    }

    /// The place of a row in the values.
    #[inline(always)]
    pub(super) fn place(&self, row: usize) -> usize {
        row % self.count * self.stride
    }

    /// A row.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> &[T] {
        &self.values[self.place(row)..][..self.stride]
    }

    /// The same, to be written.
    #[inline(always)]
    pub(super) fn row_mut(&mut self, row: usize) -> &mut [T] {
        let place = self.place(row);
        &mut self.values[place..][..self.stride]
    }

    /// The values of all rows, by their [places](Self::place).
    #[inline(always)]
    pub(super) fn values(&self) -> &[T] {
        &self.values
    }
}

/// Weights about a middle, which are the same on both sides, or the opposite.
pub(super) trait Taps {
    /// Pixels on each side.
    fn reach(&self) -> usize;

    /// Adds the filtered values to sums; `near` returns those below and above the middle at a distance.
    fn add<'a>(
        &self,
        sums: &mut [f32; LANES],
        middle: &[f32; LANES],
        near: impl Fn(usize) -> [&'a [f32; LANES]; 2],
    );
}

/// Weights from the middle to one side, the same on the other.
impl Taps for Vec<f32> {
    #[inline(always)]
    fn reach(&self) -> usize {
        self.len() - 1
    }

    #[inline(always)]
    fn add<'a>(
        &self,
        sums: &mut [f32; LANES],
        middle: &[f32; LANES],
        near: impl Fn(usize) -> [&'a [f32; LANES]; 2],
    ) {
        for lane in 0..LANES {
            sums[lane] += self[0] * middle[lane];
        }
        for (distance, weight) in self.iter().enumerate().skip(1) {
            let [below, above] = near(distance);
            for lane in 0..LANES {
                sums[lane] += weight * (below[lane] + above[lane]);
            }
        }
    }
}

/// The values from a place on.
#[inline(always)]
pub(super) fn lanes(values: &[f32], at: usize) -> &[f32; LANES] {
    values[at..].first_chunk().unwrap_or(&[0.0; LANES])
}

/// A row between margins, of which every `step`th column is filtered.
pub(super) struct Padded {
    margin: usize,
    step: usize,
    columns: usize,
    whole: Vec<f32>,
    /// The columns by their remainder, so that those of one are next to each other; none with a step of 1.
    sorted: Vec<f32>,
    /// The place of each column among them.
    places: Vec<usize>,
}

impl Padded {
    pub(super) fn new(columns: usize, margin: usize, step: usize) -> Self {
        // The last block of samples may begin at any column.
        let length = (stride(columns) + LANES * step + 2 * margin).next_multiple_of(step) + step;
        let sorted = if step == 1 { Vec::new() } else { vec![0.0; length] };
        let places = (0..length).map(|column| column % step * (length / step) + column / step).collect();
        Self { margin, step, columns, whole: vec![0.0; length], sorted, places }
    }

    /// The columns, and those that count for nothing.
    #[inline(always)]
    pub(super) fn inner(&mut self) -> &mut [f32] {
        &mut self.whole[self.margin..][..stride(self.columns)]
    }

    /// Continues the row as its mirror image.
    #[inline(always)]
    pub(super) fn mirror(&mut self) {
        mirrored(&mut self.whole, self.margin, self.columns);
        self.sort();
    }

    /// Continues the row with the values at its ends.
    #[inline(always)]
    pub(super) fn hold(&mut self) {
        held(&mut self.whole, self.margin, self.columns);
        self.sort();
    }

    #[inline(always)]
    fn sort(&mut self) {
        let count = self.whole.len() / self.step;
        if self.step == 2 {
            let (even, odd) = self.sorted.split_at_mut(count);
            for ((even, odd), both) in even.iter_mut().zip(odd).zip(self.whole.as_chunks::<2>().0) {
                [*even, *odd] = *both;
            }
            return;
        }
        for (first, phase) in self.sorted.chunks_exact_mut(count).enumerate() {
            phase
                .iter_mut()
                .zip(self.whole[first..].iter().step_by(self.step))
                .for_each(|(to, one)| *to = *one);
        }
    }

    /// The samples from a place between the margins on, of which the margins are the first.
    #[inline(always)]
    fn lanes(&self, at: usize, block: usize) -> &[f32; LANES] {
        let values = if self.step == 1 { &self.whole } else { &self.sorted };
        lanes(values, self.places[at] + block * LANES)
    }
}

/// Adds to the samples of a row, from a column on, what a filter makes of the columns about them.
#[inline(always)]
pub(super) fn along(taps: &impl Taps, padded: &Padded, first: usize, into: &mut [f32]) {
    let at = padded.margin + first;
    for (block, into) in into.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
        let mut sums = *into;
        taps.add(&mut sums, padded.lanes(at, block), |distance| {
            [padded.lanes(at - distance, block), padded.lanes(at + distance, block)]
        });
        *into = sums;
    }
}

/// Adds to a row what a filter makes of the rows about it, whose places are those from the first to the last in
/// its reach.
#[inline(always)]
pub(super) fn across(taps: &impl Taps, values: &[f32], places: &[usize], into: &mut [f32]) {
    let middle = taps.reach();
    for (block, into) in into.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
        let row = |number: usize| lanes(values, places[number] + block * LANES);
        let mut sums = *into;
        taps.add(&mut sums, row(middle), |distance| [row(middle - distance), row(middle + distance)]);
        *into = sums;
    }
}

/// Writes a row between margins, where it continues as its mirror image.
#[inline(always)]
fn mirrored(padded: &mut [f32], margin: usize, columns: usize) {
    for k in 0..margin {
        padded[margin - 1 - k] = padded[margin + k.min(columns - 1)];
        padded[margin + columns + k] = padded[margin + columns - 1 - k.min(columns - 1)];
    }
}

/// Writes a row between margins, where it continues with the values at its ends.
#[inline(always)]
fn held(padded: &mut [f32], margin: usize, columns: usize) {
    let (first, last) = (padded[margin], padded[margin + columns - 1]);
    padded[..margin].fill(first);
    padded[margin + columns..].fill(last);
}

/// Largest distance of samples.
pub(super) const MOST_STEPS: usize = 8;

/// Row, from 0 to `step` - 1, in which the samples of each `step` rows are, and the first column with one: in each `step` squared numbers, all
/// places in changing order, so that no regular pattern is met at the same places only.
pub(super) fn samples(number: usize, step: usize) -> [usize; 2] {
    let count = step * step;
    let mut order: [usize; MOST_STEPS * MOST_STEPS] = std::array::from_fn(|k| k);
    let mut bits = (number / count) as u64;
    for last in (1..count).rev() {
        // SplitMix64.
        bits = bits.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = (bits ^ bits >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        order.swap(last, (mixed >> 40) as usize % (last + 1));
    }
    let place = order[number % count];
    [place / step, place % step]
}

#[cfg(test)]
mod tests {
    use super::super::filter::Kernel;
    use super::*;

    /// With few rows at hand, a filter does what it does to a whole plane, at each sample.
    #[test]
    fn rows_are_filtered_as_whole_planes_are() {
        let (columns, rows) = (45, 12);
        let plane: Vec<f32> = (0..columns * rows).map(|k| (0.618_034 * k as f64).fract() as f32).collect();
        let kernel = Kernel::even(&[0.5, 0.2, 0.05]);
        let whole = kernel.along_columns(&kernel.along_rows(&plane, columns), columns);
        let reach = kernel.reach();
        for step in [1, 2, 3] {
            let mut ring = Ring::new(stride(columns), 2 * reach + 1);
            let mut padded = Padded::new(columns, reach, step);
            let mut next = 0;
            for y in 0..rows {
                while next < (y + reach + 1).min(rows) {
                    ring.row_mut(next)[..columns].copy_from_slice(&plane[next * columns..][..columns]);
                    next += 1;
                }
                let at = |k: usize| ring.place((y + k).saturating_sub(reach).min(rows - 1));
                let places: Vec<usize> = (0..=2 * reach).map(at).collect();
                padded.inner().fill(0.0);
                across(&kernel, ring.values(), &places, padded.inner());
                padded.hold();
                for first in 0..step {
                    let mut row = vec![0.0; stride(columns / step)];
                    along(&kernel, &padded, first, &mut row);
                    for (at, found) in row[..columns / step].iter().enumerate() {
                        let expected = whole[y * columns + first + at * step];
                        assert!((found - expected).abs() < 1e-6, "{y} {at}: {found} {expected}");
                    }
                }
            }
        }
    }

    #[test]
    fn margins_continue_rows() {
        let mut padded = vec![0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0];
        mirrored(&mut padded, 3, 2);
        assert_eq!(padded, [2.0, 2.0, 1.0, 1.0, 2.0, 2.0, 1.0, 1.0]);
        held(&mut padded, 3, 2);
        assert_eq!(padded, [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0]);
    }

    #[test]
    fn samples_are_equally_often_at_each_place() {
        for step in [1, 2, 3, 5] {
            let mut counts = vec![0_usize; step * step];
            (0..100 * step * step).for_each(|number| {
                let [row, column] = samples(number, step);
                counts[row * step + column] += 1;
            });
            assert!(counts.iter().all(|count| *count == 100), "{counts:?}");
        }
        let order = |group: usize| [0, 1, 2, 3].map(|k| samples(4 * group + k, 2));
        assert!((0..20).any(|group| order(group) != order(group + 1)));
    }
}
