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

/// Filters a row between margins of this width.
#[inline(always)]
pub(super) fn along(taps: &impl Taps, padded: &[f32], margin: usize, into: &mut [f32]) {
    for (block, into) in into.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
        let at = margin + block * LANES;
        let mut sums = [0.0; LANES];
        taps.add(&mut sums, lanes(padded, at), |distance| {
            [lanes(padded, at - distance), lanes(padded, at + distance)]
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
pub(super) fn mirrored(padded: &mut [f32], margin: usize, columns: usize) {
    for k in 0..margin {
        padded[margin - 1 - k] = padded[margin + k.min(columns - 1)];
        padded[margin + columns + k] = padded[margin + columns - 1 - k.min(columns - 1)];
    }
}

/// Writes a row between margins, where it continues with the values at its ends.
#[inline(always)]
pub(super) fn held(padded: &mut [f32], margin: usize, columns: usize) {
    let (first, last) = (padded[margin], padded[margin + columns - 1]);
    padded[..margin].fill(first);
    padded[margin + columns..].fill(last);
}

#[cfg(test)]
mod tests {
    use super::super::filter::Kernel;
    use super::*;

    /// One row after the other, with few rows at hand, a filter does what it does to a whole plane.
    #[test]
    fn rows_are_filtered_as_whole_planes_are() {
        let (columns, rows) = (45, 12);
        let plane: Vec<f32> = (0..columns * rows).map(|k| (0.618_034 * k as f64).fract() as f32).collect();
        let kernel = Kernel::even(&[0.5, 0.2, 0.05]);
        let whole = kernel.along_columns(&kernel.along_rows(&plane, columns), columns);
        let (stride, reach) = (stride(columns), kernel.reach());
        let mut ring = Ring::new(stride, 2 * reach + 1);
        let mut next = 0;
        for y in 0..rows {
            while next < (y + reach + 1).min(rows) {
                let mut padded = vec![0.0; stride + 2 * reach];
                padded[reach..][..columns].copy_from_slice(&plane[next * columns..][..columns]);
                held(&mut padded, reach, columns);
                along(&kernel, &padded, reach, ring.row_mut(next));
                next += 1;
            }
            let at = |k: usize| ring.place((y + k).saturating_sub(reach).min(rows - 1));
            let places: Vec<usize> = (0..=2 * reach).map(at).collect();
            let mut row = vec![0.0; stride];
            across(&kernel, ring.values(), &places, &mut row);
            assert_eq!(row[..columns], whole[y * columns..][..columns], "{y}");
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
}
