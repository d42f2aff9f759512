//! Error diffusion of colours and of single numbers.
//!
//! Each pixel gets the state nearest to its wanted colour plus what its neighbours passed on; the difference
//! is passed on to pixels that have no state yet. In linear light the mean over an area is then kept: what a
//! display shows is additive.
//!
//! **Sources.** R. W. Floyd and L. Steinberg, Proc. SID 17(2), 75 (1976); J. F. Jarvis, C. N. Judice and W.
//! H. Ninke, Computer Graphics and Image Processing 5, 13 (1976); P. Stucki, IBM Research Report RZ1060
//! (1981); F. Sierra (1989, 1990); D. Burkes (1988); B. Atkinson (1987, MacPaint and HyperScan).
//!
//! **Arithmetic.** Errors are whole numbers of a unit (about 6e-8 of the palette's largest coordinate), and
//! the parts of an error add up to it exactly. Therefore the ledger is exact: wanted = shown + lost, to the
//! last unit. The result is the same on every processor.

use super::units::{MOST_UNITS, Palette};
use super::{check_rows, check_states};
use crate::ImagingError;

/// To which neighbours an error is passed on, and in which parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DiffusionKernel {
    /// Floyd and Steinberg: 7 3 5 1 of 16 to four neighbours. The finest detail.
    #[default]
    FloydSteinberg,
    /// Jarvis, Judice and Ninke: 48 parts to twelve neighbours. Sharper edges, coarser grain.
    Jarvis,
    /// Stucki: 42 parts to twelve neighbours.
    Stucki,
    /// Sierra: 32 parts to ten neighbours.
    Sierra,
    /// Sierra's Filter Lite: 4 parts to three neighbours. The quickest.
    SierraLite,
    /// Burkes: Stucki's first two rows, 32 parts to seven neighbours.
    Burkes,
    /// Atkinson: an eighth to each of six neighbours. A quarter of the error is lost: light and dark tones lose
    /// their detail, and the mean colour is not kept.
    Atkinson,
}

impl DiffusionKernel {
    /// All kernels.
    pub const ALL: [Self; 7] = [
        Self::FloydSteinberg,
        Self::Jarvis,
        Self::Stucki,
        Self::Sierra,
        Self::SierraLite,
        Self::Burkes,
        Self::Atkinson,
    ];

    /// Whether all of an error is passed on.
    pub fn keeps_the_mean(self) -> bool {
        self != Self::Atkinson
    }
}

/// Order of the pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scan {
    /// Every second row from right to left, with the mirrored kernel: no direction is preferred.
    #[default]
    Serpentine,
    /// Every row from left to right.
    Raster,
}

impl Scan {
    /// All orders.
    pub const ALL: [Self; 2] = [Self::Serpentine, Self::Raster];
}

/// Settings of error diffusion.
///
/// ```
/// use papilio_imaging::halftone::ErrorDiffusion;
///
/// // A quarter of white on a black and white display.
/// let grey = ErrorDiffusion::default().levels(&[0.25; 64 * 64], 64, &[0.0, 1.0])?;
/// let white = grey.states.iter().filter(|state| **state == 1).count() as f64;
/// assert_eq!(white + grey.lost[0], 0.25 * 64.0 * 64.0);
/// # Ok::<(), papilio_imaging::ImagingError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorDiffusion {
    /// Parts of the error by neighbour.
    pub kernel: DiffusionKernel,
    /// Order of the pixels.
    pub scan: Scan,
    /// Largest component of the error that is passed on, as a fraction of the palette's largest extent along
    /// a coordinate; 0 to 4. A larger error is scaled down to it, and what is cut off is lost. Without a
    /// limit the error would grow without bound in areas of a colour outside the hull of the palette, and
    /// smear over what follows them.
    pub limit: f64,
    /// Coordinates in which the nearest state is searched: linear combinations of X, Y, Z, one in each row.
    /// Errors are passed on in X, Y, Z in any case. Ignored by [`levels`](Self::levels).
    ///
    /// With a double weight of Y, six inks have 10 % less visible noise of luminance, and nothing is cut.
    /// With four times the weight, or with opponent colours of less weight than luminance, the errors of what
    /// weighs less grow until the limit cuts them, and the mean colour is wrong: check [`Diffused::cut`].
    pub metric: [[f64; 3]; 3],
}

impl Default for ErrorDiffusion {
    fn default() -> Self {
        Self {
            kernel: DiffusionKernel::default(),
            scan: Scan::default(),
            limit: 1.0,
            metric: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        }
    }
}

/// A picture after error diffusion.
#[derive(Debug, Clone, PartialEq)]
pub struct Diffused<const N: usize> {
    /// The state of each pixel.
    pub states: Vec<u8>,
    /// Sum over all pixels of what was wanted and is not shown: passed beyond the borders of the picture, above
    /// the limit, or not passed on by the kernel.
    pub lost: [f64; N],
    /// The part of `lost` above the limit: of colours outside the hull of the palette, or because of the
    /// metric.
    pub cut: [f64; N],
    /// Number of pixels whose error was above the limit.
    pub cut_pixels: usize,
}

impl ErrorDiffusion {
    /// Error diffusion of colours: `wanted` X, Y, Z of each pixel, by rows from the top, to states of these
    /// X, Y, Z.
    ///
    /// All coordinates have the same unit; a not finite one is 0. Of two equally near states the later one is
    /// taken.
    ///
    /// # Errors
    /// If the number of pixels is not a multiple of `columns`, the palette is empty, has more than 256 states
    /// or a coordinate that is not finite.
    pub fn colours(
        &self,
        wanted: &[[f32; 3]],
        columns: usize,
        palette: &[[f64; 3]],
    ) -> Result<Diffused<3>, ImagingError> {
        check_rows(wanted.len(), columns)?;
        let row = |y: usize, row: &mut [[f32; 3]]| row.copy_from_slice(&wanted[y * columns..][..columns]);
        self.diffuse((&row, None, None), [columns, wanted.len() / columns], palette, self.metric)
    }

    /// [`colours`](Self::colours) of a picture of this many columns and rows, whose rows a function writes.
    ///
    /// # Errors
    /// As [`colours`](Self::colours).
    pub fn colours_by_rows(
        &self,
        row: &dyn Fn(usize, &mut [[f32; 3]]),
        [columns, rows]: [usize; 2],
        palette: &[[f64; 3]],
    ) -> Result<Diffused<3>, ImagingError> {
        self.colours_beside(row, (None, None), [columns, rows], palette)
    }

    /// [`colours_by_rows`](Self::colours_by_rows) beside pixels that have a state already, which `fixed` writes
    /// for each row. They pass nothing on, and what is passed to them is lost, as beyond a border. The pixels that `few`
    /// marks take some of the states only, whose colours lie about a line; of what is passed to them, they keep the part
    /// along it, with the same first coordinate of the metric, and the rest is lost.
    ///
    /// # Errors
    /// As [`colours`](Self::colours).
    pub fn colours_beside(
        &self,
        row: &dyn Fn(usize, &mut [[f32; 3]]),
        (fixed, few): (Option<&FixedRow<'_>>, Option<FewStates<'_>>),
        [columns, rows]: [usize; 2],
        palette: &[[f64; 3]],
    ) -> Result<Diffused<3>, ImagingError> {
        check_rows(columns * rows, columns)?;
        self.diffuse((row, fixed, few), [columns, rows], palette, self.metric)
    }

    /// Error diffusion of single numbers, such as the coverage of one sub-pixel, to these levels.
    ///
    /// # Errors
    /// As [`colours`](Self::colours).
    pub fn levels(
        &self,
        wanted: &[f32],
        columns: usize,
        levels: &[f64],
    ) -> Result<Diffused<1>, ImagingError> {
        let palette: Vec<[f64; 1]> = levels.iter().map(|level| [*level]).collect();
        check_rows(wanted.len(), columns)?;
        let wanted = wanted.as_chunks().0;
        let row = |y: usize, row: &mut [[f32; 1]]| row.copy_from_slice(&wanted[y * columns..][..columns]);
        self.diffuse((&row, None, None), [columns, wanted.len() / columns], &palette, [[1.0]])
    }

    fn diffuse<const N: usize>(
        &self,
        (row, fixed, few): (&WantedRow<'_, N>, Option<&FixedRow<'_>>, Option<FewStates<'_, N>>),
        [columns, rows]: [usize; 2],
        palette: &[[f64; N]],
        metric: [[f64; N]; N],
    ) -> Result<Diffused<N>, ImagingError> {
        check_states(palette.len())?;
        if let Some(state) = palette.iter().position(|colour| !colour.iter().all(|value| value.is_finite())) {
            return Err(ImagingError::Palette { state });
        }
        let few = few.map(|few| Few::new(few, metric[0]));
        let picture = Picture { row, fixed, few, columns, rows, scan: self.scan };
        let palette = Palette::new(palette, metric, self.limit);
        Ok(match self.kernel {
            DiffusionKernel::FloydSteinberg => picture.diffused(&palette, &FLOYD_STEINBERG),
            DiffusionKernel::Jarvis => picture.diffused(&palette, &JARVIS),
            DiffusionKernel::Stucki => picture.diffused(&palette, &STUCKI),
            DiffusionKernel::Sierra => picture.diffused(&palette, &SIERRA),
            DiffusionKernel::SierraLite => picture.diffused(&palette, &SIERRA_LITE),
            DiffusionKernel::Burkes => picture.diffused(&palette, &BURKES),
            DiffusionKernel::Atkinson => picture.diffused(&palette, &ATKINSON),
        })
    }
}

/// Writes the colours of a row that are wanted.
type WantedRow<'a, const N: usize> = dyn Fn(usize, &mut [[f32; N]]) + 'a;

/// Writes the states of the pixels of a row that have one already.
pub type FixedRow<'a> = dyn Fn(usize, &mut [Option<u8>]) + 'a;

/// Pixels that take some of the states only.
#[derive(Clone, Copy)]
pub struct FewStates<'a, const N: usize = 3> {
    /// Writes whether each pixel of a row is one.
    pub row: &'a dyn Fn(usize, &mut [bool]),
    /// Whether each state may be taken.
    pub allowed: &'a [bool],
    /// The line along which they lie, from one to another.
    pub line: [f64; N],
}

/// The same, prepared.
struct Few<'a, const N: usize> {
    row: &'a dyn Fn(usize, &mut [bool]),
    allowed: &'a [bool],
    /// The error along the line, by the error.
    along: [[f64; N]; N],
}

impl<'a, const N: usize> Few<'a, N> {
    fn new(few: FewStates<'a, N>, first: [f64; N]) -> Self {
        let FewStates { row, allowed, line } = few;
        let size: f64 = line.iter().zip(first).map(|(one, first)| one * first).sum();
        let size = if size == 0.0 { 1.0 } else { size };
        Self { row, allowed, along: line.map(|one| first.map(|first| one * first / size)) }
    }

    /// Keeps the part of an error along the line; returns the rest.
    fn keep(&self, error: &mut [i32; N]) -> [i32; N] {
        let before = *error;
        *error = self.along.map(|row| {
            row.iter().zip(before).map(|(part, value)| part * f64::from(value)).sum::<f64>().round() as i32
        });
        std::array::from_fn(|k| before[k] - error[k])
    }
}

/// One neighbour: columns along the scan, rows down, and its part of the error in units of 2^-32.
type Part = (isize, usize, i64);

/// Neighbours with their parts, from whole parts of `of`.
const fn parts<const W: usize>(neighbours: [(isize, usize, i64); W], of: i64) -> [Part; W] {
    let mut parts = neighbours;
    let mut k = 0;
    while k < W {
        parts[k].2 = ((neighbours[k].2 << 32) + of / 2) / of;
        k += 1;
    }
    parts
}

const FLOYD_STEINBERG: [Part; 4] = parts([(1, 0, 7), (-1, 1, 3), (0, 1, 5), (1, 1, 1)], 16);
const JARVIS: [Part; 12] = parts(
    [
        (1, 0, 7),
        (2, 0, 5),
        (-2, 1, 3),
        (-1, 1, 5),
        (0, 1, 7),
        (1, 1, 5),
        (2, 1, 3),
        (-2, 2, 1),
        (-1, 2, 3),
        (0, 2, 5),
        (1, 2, 3),
        (2, 2, 1),
    ],
    48,
);
const SIERRA_LITE: [Part; 3] = parts([(1, 0, 2), (-1, 1, 1), (0, 1, 1)], 4);
const BURKES: [Part; 7] =
    parts([(1, 0, 8), (2, 0, 4), (-2, 1, 2), (-1, 1, 4), (0, 1, 8), (1, 1, 4), (2, 1, 2)], 32);
const ATKINSON: [Part; 6] = parts([(1, 0, 1), (2, 0, 1), (-1, 1, 1), (0, 1, 1), (1, 1, 1), (0, 2, 1)], 8);
const STUCKI: [Part; 12] = parts(
    [
        (1, 0, 8),
        (2, 0, 4),
        (-2, 1, 2),
        (-1, 1, 4),
        (0, 1, 8),
        (1, 1, 4),
        (2, 1, 2),
        (-2, 2, 1),
        (-1, 2, 2),
        (0, 2, 4),
        (1, 2, 2),
        (2, 2, 1),
    ],
    42,
);
const SIERRA: [Part; 10] = parts(
    [
        (1, 0, 5),
        (2, 0, 3),
        (-2, 1, 2),
        (-1, 1, 4),
        (0, 1, 5),
        (1, 1, 4),
        (2, 1, 2),
        (-1, 2, 2),
        (0, 2, 3),
        (1, 2, 2),
    ],
    32,
);

/// Columns beyond each border to which a kernel passes errors.
const BORDER: usize = 2;

struct Picture<'a, const N: usize> {
    /// Writes the wanted values of a row.
    row: &'a dyn Fn(usize, &mut [[f32; N]]),
    fixed: Option<&'a FixedRow<'a>>,
    few: Option<Few<'a, N>>,
    columns: usize,
    rows: usize,
    scan: Scan,
}

/// One row: what is wanted, states that are given, and which pixels take few states.
struct Row<'a, const N: usize> {
    wanted: &'a [[f32; N]],
    fixed: &'a [Option<u8>],
    few: Option<(&'a Few<'a, N>, &'a [bool])>,
}

impl<const N: usize> Picture<'_, N> {
    fn diffused<const W: usize>(&self, palette: &Palette<N>, kernel: &[Part; W]) -> Diffused<N> {
        let width = self.columns + 2 * BORDER;
        // Errors passed to the present row and the two below it.
        let mut rows = [0; 3].map(|_| vec![[0_i32; N]; width]);
        let mut states = vec![0; self.columns * self.rows];
        let mut wanted = vec![[0.0; N]; self.columns];
        let mut fixed = vec![None; self.columns];
        let mut marked = vec![false; self.columns];
        let mut ledger = Ledger { lost: [0; N], cut: [0; N], cut_pixels: 0 };
        for (y, states) in states.chunks_exact_mut(self.columns).enumerate() {
            (self.row)(y, &mut wanted);
            if let Some(write) = self.fixed {
                write(y, &mut fixed);
            }
            if let Some(few) = &self.few {
                (few.row)(y, &mut marked);
            }
            let few = self.few.as_ref().map(|few| (few, &marked[..]));
            let row = Row { wanted: &wanted, fixed: &fixed, few };
            if self.scan == Scan::Serpentine && y % 2 == 1 {
                one_row::<N, W, -1>(palette, kernel, &mut rows, row, states, &mut ledger);
            } else {
                one_row::<N, W, 1>(palette, kernel, &mut rows, row, states, &mut ledger);
            }
            ledger.lose(&rows[0][..BORDER]);
            ledger.lose(&rows[0][width - BORDER..]);
            rows.rotate_left(1);
            rows[2].fill([0; N]);
        }
        rows.iter().for_each(|row| ledger.lose(row));
        let in_light = |units: [i64; N]| units.map(|units| units as f64 / f64::from(palette.scale));
        Diffused {
            states,
            lost: in_light(ledger.lost),
            cut: in_light(ledger.cut),
            cut_pixels: ledger.cut_pixels,
        }
    }
}

/// What is lost, in units.
struct Ledger<const N: usize> {
    lost: [i64; N],
    cut: [i64; N],
    cut_pixels: usize,
}

impl<const N: usize> Ledger<N> {
    fn lose(&mut self, errors: &[[i32; N]]) {
        for error in errors {
            self.lost.iter_mut().zip(error).for_each(|(lost, error)| *lost += i64::from(*error));
        }
    }

    /// Scales an error down to the limit; the rest is lost.
    #[cold]
    fn cut(&mut self, error: &mut [i32; N], limit: i32) {
        let largest = error.iter().fold(1, |largest, value| largest.max(value.abs()));
        self.cut_pixels += 1;
        for (k, value) in error.iter_mut().enumerate() {
            let left = (i64::from(*value) * i64::from(limit) / i64::from(largest)) as i32;
            self.cut[k] += i64::from(*value - left);
            self.lost[k] += i64::from(*value - left);
            *value = left;
        }
    }
}

/// Gives the pixels of one row their states, from left to right (`ALONG` = 1) or from right to left (-1).
fn one_row<const N: usize, const W: usize, const ALONG: isize>(
    palette: &Palette<N>,
    kernel: &[Part; W],
    rows: &mut [Vec<[i32; N]>; 3],
    Row { wanted, fixed, few }: Row<'_, N>,
    states: &mut [u8],
    ledger: &mut Ledger<N>,
) {
    let columns = wanted.len();
    for step in 0..columns {
        let x = if ALONG > 0 { step } else { columns - 1 - step };
        let mut colour = rows[0][x + BORDER];
        if let Some(state) = fixed[x] {
            states[x] = state;
            ledger.lose(&[colour]);
            continue;
        }
        let few = few.filter(|(_, marked)| marked[x]).map(|(few, _)| few);
        if let Some(few) = few {
            ledger.lose(&[few.keep(&mut colour)]);
        }
        for (value, wanted) in colour.iter_mut().zip(wanted[x]) {
            *value += (wanted * palette.scale).clamp(-MOST_UNITS, MOST_UNITS) as i32;
        }
        let state = match few {
            Some(few) => palette.nearest_of(colour, |state| few.allowed.get(state) == Some(&true)),
            None => palette.nearest(colour),
        };
        states[x] = state as u8;
        let mut error = colour;
        error.iter_mut().zip(palette.units[state]).for_each(|(error, shown)| *error -= shown);
        if error.iter().any(|value| value.abs() > palette.limit) {
            ledger.cut(&mut error, palette.limit);
        }
        let mut left = error;
        let last = if keeps_all(kernel) { W - 1 } else { W };
        for (k, (along, down, part)) in kernel.iter().enumerate() {
            let at = (x + BORDER).wrapping_add_signed(ALONG * along);
            let received = &mut rows[*down][at];
            for ((received, left), error) in received.iter_mut().zip(&mut left).zip(error) {
                // The last neighbour gets what remains, so that the parts add up to the error.
                let passed =
                    if k == last { *left } else { ((i64::from(error) * part + (1 << 31)) >> 32) as i32 };
                *left -= passed;
                *received += passed;
            }
        }
        if last == W {
            ledger.lose(&[left]);
        }
    }
}

/// Whether the parts of a kernel add up to the error.
const fn keeps_all<const W: usize>(kernel: &[Part; W]) -> bool {
    let (mut sum, mut k) = (0, 0);
    while k < W {
        sum += kernel[k].2;
        k += 1;
    }
    sum > 0xF000_0000
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published parts add up to one, and below the row they are the same on both sides.
    #[test]
    fn kernel_parts_add_up_and_are_symmetric() {
        for (kernel, symmetric) in [
            (&FLOYD_STEINBERG[..], false),
            (&JARVIS, true),
            (&STUCKI, true),
            (&SIERRA, true),
            (&SIERRA_LITE, false),
            (&BURKES, true),
        ] {
            let sum: i64 = kernel.iter().map(|(.., part)| part).sum();
            assert!((sum - (1 << 32)).abs() <= 6);
            for (along, down, part) in kernel {
                assert!(*down > 0 || *along > 0);
                let mirrored = kernel.iter().any(|(x, y, other)| (-x, y, other) == (*along, down, part));
                assert!(!symmetric || *down == 0 || mirrored);
            }
        }
        assert!(!keeps_all(&ATKINSON) && keeps_all(&STUCKI) && keeps_all(&BURKES));
        // Burkes' kernel is that of Stucki without its third row, 32 of 42 parts.
        for ((x, y, part), (of_stucki_x, of_stucki_y, of_stucki)) in BURKES.into_iter().zip(STUCKI) {
            assert_eq!((x, y), (of_stucki_x, of_stucki_y));
            assert!((32 * part - 42 * of_stucki).abs() <= 42);
        }
    }
}
