//! Differences of large pictures, stripe by stripe: little memory, and all threads.
//!
//! **What.** The same numbers as of [`Picture::delta_e_2000`](super::Picture::delta_e_2000),
//! [`scielab`](super::scielab()) and [`FlipPicture`](super::FlipPicture), in single precision:
//!
//! - narrow Gaussians of S-CIELAB are sampled kernels that have their transfer functions; wide ones, of 0.6 degrees
//!   and more, filter means of blocks of pixels, between which is interpolated, with a correction for both;
//! - quantiles are those of a histogram with steps of 1/256, interpolated.
//!
//! **Range.** 24 pixels per degree or more. Means agree with the plain method within 1e-3 of their value.

use std::f64::consts::{LN_2, PI};
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use papilio_fourier::{Separable, filtered};
use pulp::NullaryFnOnce;

use super::difference::{Hues, delta_e_2000};
use super::flip::FlipPicture;
use super::histogram::Histogram;
use super::mapped::{MappedPicture, SingleMap};
use super::planes::{along_rows, chromas, local_contrast, planes, times, to_lab};
use super::scielab::{FILTERS, OPPONENT, gaussian};
use crate::matrix::{Matrix, inverse};
use crate::{Adaptation, ColourError, D65_WHITE, Xyz};

/// Pixels per degree from which narrow Gaussians have small kernels.
pub const LEAST_PER_DEGREE: f64 = 24.0;

/// Rows of a stripe.
const ROWS: usize = 64;

/// Full width at half maximum, degrees, from which a Gaussian is a wide one.
const WIDE_DEG: f64 = 0.5;

/// Mean, median and 95th percentile of a difference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Median.
    pub p50: f64,
    /// 95th percentile.
    pub p95: f64,
}

/// Differences of a picture from another, and sums for the ratios of their chroma and contrast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// CIEDE2000 of the pixels.
    pub plain: Spread,
    /// S-CIELAB with CIEDE2000.
    pub scielab: Spread,
    /// Mean of FLIP.
    pub flip_mean: f64,
    /// After the eye's blur: sums of the chroma of the other picture and of this one, where the former is above the
    /// limit; of the former where this one has a hue; and of that times the difference of the hues in degrees.
    pub chromas: [f64; 4],
    /// Mean standard deviation of L* after the eye's blur in windows, of this picture and of the other.
    pub contrasts: [f64; 2],
}

/// A reader, and what counts for him.
#[derive(Debug, Clone, Copy)]
pub struct Reader {
    /// The white to which he is adapted, on the scale of the pictures.
    pub white: Xyz,
    /// Pixels per degree of the visual angle.
    pub per_degree: f64,
    /// Chroma of the other picture from which chroma and hue are compared, and of this one, from which it has a hue.
    pub coloured: [f32; 2],
    /// Radius of the windows of local contrast, pixels.
    pub window: usize,
}

/// Compares a picture, X, Y and Z with rows of `columns`, with others of its size.
///
/// # Errors
/// If a picture has another size than the first, or none; [`ColourError::NoWhite`] unless all values of the white
/// are positive.
pub fn compared<const N: usize>(
    seen: &[[f32; 3]],
    others: [MappedPicture<'_>; N],
    columns: usize,
    reader: Reader,
    threads: usize,
) -> Result<[Comparison; N], ColourError> {
    let white = reader.white;
    white.lab(white).ok_or(ColourError::NoWhite)?;
    let to_screen = Adaptation::between(white, D65_WHITE).ok_or(ColourError::NoWhite)?;
    let whole =
        |pixels: &[[f32; 3]]| columns > 0 && !pixels.is_empty() && pixels.len().is_multiple_of(columns);
    if !whole(seen) {
        return Err(ColourError::PictureShape { columns, values: [seen.len(); 3] });
    }
    let size = |pixels: &[[f32; 3]]| [columns, pixels.len() / columns];
    if let Some(other) = others.iter().find(|other| other.pixels.len() != seen.len()) {
        return Err(ColourError::PictureSizes { one: size(seen), other: size(other.pixels) });
    }
    let eye = Eye::new(reader, to_screen, size(seen));
    let all: Vec<MappedPicture<'_>> = [seen.into()].into_iter().chain(others).collect();
    let coarse = in_turn(threads, all.len(), &|| (), &|(), number| eye.coarse(&all[number]));
    let pictures: Vec<Source<'_>> =
        all.iter().zip(&coarse).map(|(picture, coarse)| eye.source(picture, coarse)).collect();
    let rows = seen.len() / columns;
    let stripes = rows.div_ceil(ROWS);
    let histograms = std::sync::Mutex::new(vec![[Histogram::default(), Histogram::default()]; N]);
    let fresh = || Own { into: &histograms, own: vec![[Histogram::default(), Histogram::default()]; N] };
    let sums = in_turn(threads, stripes, &fresh, &|own: &mut Own<'_>, number| {
        let inner = number * ROWS..((number + 1) * ROWS).min(rows);
        pulp::Arch::new().dispatch(Stripe { eye: &eye, pictures: &pictures, inner, histograms: &mut own.own })
    });
    let histograms = histograms.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    let count = seen.len() as f64;
    Ok(std::array::from_fn(|k| {
        let mut total = Sums::default();
        sums.iter().for_each(|stripe| total.add(&stripe[k]));
        let spread = |histogram: &Histogram, sum: f64| Spread {
            mean: sum / count,
            p50: histogram.quantile(0.5),
            p95: histogram.quantile(0.95),
        };
        Comparison {
            plain: spread(&histograms[k][0], total.plain),
            scielab: spread(&histograms[k][1], total.blurred),
            flip_mean: total.flip / count,
            chromas: total.chromas,
            contrasts: total.contrasts.map(|sum| sum / count),
        }
    }))
}

/// Histograms of a thread, which are added to those of all when it ends.
struct Own<'a> {
    into: &'a std::sync::Mutex<Vec<[Histogram; 2]>>,
    own: Vec<[Histogram; 2]>,
}

impl Drop for Own<'_> {
    fn drop(&mut self) {
        let mut all = self.into.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        for (all, own) in all.as_flattened_mut().iter_mut().zip(self.own.as_flattened()) {
            all.add(own);
        }
    }
}

/// What is summed over the pixels of a stripe.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    plain: f64,
    blurred: f64,
    flip: f64,
    chromas: [f64; 4],
    contrasts: [f64; 2],
}

impl Sums {
    fn add(&mut self, other: &Self) {
        self.plain += other.plain;
        self.blurred += other.blurred;
        self.flip += other.flip;
        self.chromas.iter_mut().zip(other.chromas).for_each(|(sum, one)| *sum += one);
        self.contrasts.iter_mut().zip(other.contrasts).for_each(|(sum, one)| *sum += one);
    }
}

/// A picture, and its wide blur by opponent colours and blocks.
struct Source<'a> {
    pixels: &'a [[f32; 3]],
    coarse: &'a [Vec<f32>; 3],
    /// From the pixels to opponent colours.
    opponent: SingleMap,
    /// To X, Y, Z relative to the white.
    relative: SingleMap,
    /// To linear sRGB on a screen.
    screen: SingleMap,
}

/// The filters of a reader.
struct Eye {
    reader: Reader,
    columns: usize,
    rows: usize,
    /// From X, Y, Z to opponent colours.
    opponent: [[f32; 3]; 3],
    /// From opponent colours to X, Y, Z relative to the white.
    back: [[f32; 3]; 3],
    /// From X, Y, Z relative to the white to linear sRGB on a screen.
    screen: [[f32; 3]; 3],
    /// Narrow kernels of each opponent colour, from the middle to one side.
    narrow: [Vec<Vec<f32>>; 3],
    /// Side of the blocks of wide filters, pixels.
    block: usize,
    /// Rows beyond a stripe that a narrow kernel reaches.
    reach: usize,
    hues: Hues,
}

impl Eye {
    fn new(reader: Reader, to_screen: Adaptation, [columns, rows]: [usize; 2]) -> Self {
        let Reader { white, per_degree, .. } = reader;
        let scale = [D65_WHITE.x / white.x, D65_WHITE.y / white.y, D65_WHITE.z / white.z];
        let opponent: Matrix = OPPONENT.map(|row| [0, 1, 2].map(|k| row[k] * scale[k]));
        let whites = white.to_array();
        let inverse = inverse(&opponent);
        let back = [0, 1, 2].map(|i| inverse[i].map(|one| one / whites[i]));
        let unit = |k: usize| {
            let mut xyz = [0.0; 3];
            xyz[k] = whites[k];
            let [x, y, z] = xyz;
            to_screen.apply(Xyz { x, y, z }).linear_srgb()
        };
        let units = [unit(0), unit(1), unit(2)];
        let screen = [0, 1, 2].map(|i| [0, 1, 2].map(|k| units[k][i] as f32));
        let single = |matrix: Matrix| matrix.map(|row| row.map(|one| one as f32));
        let is_wide = |width: f64| width >= WIDE_DEG;
        let narrow = FILTERS.map(|filter| {
            let total: f64 = filter.iter().map(|(_, weight)| weight).sum();
            let kernels = filter.iter().filter(|(width, _)| !is_wide(*width));
            kernels.map(|(width, weight)| kernel(*width, weight / total, per_degree)).collect::<Vec<_>>()
        });
        let widest = FILTERS.iter().copied().flatten().map(|(width, _)| *width).filter(|one| is_wide(*one));
        let sigma = widest.fold(f64::INFINITY, f64::min) * per_degree / (8.0 * LN_2).sqrt();
        let block = 1 << ((sigma / 3.0).max(1.0).log2() as u32).min(5);
        let reach = narrow.iter().flatten().map(|kernel| kernel.len() - 1).max().unwrap_or(0);
        let (opponent, back) = (single(opponent), single(back));
        let hues = Hues::new();
        Self { reader, columns, rows, opponent, back, screen, narrow, block, reach, hues }
    }

    fn source<'a>(&self, picture: &MappedPicture<'a>, coarse: &'a [Vec<f32>; 3]) -> Source<'a> {
        let MappedPicture { pixels, map } = picture;
        let [x, y, z] = self.reader.white.to_array().map(|one| (1.0 / one) as f32);
        let relative = [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
        let screen = self.screen.map(|[a, b, c]| [a * x, b * y, c * z]);
        let [opponent, relative, screen] =
            [&self.opponent, &relative, &screen].map(|matrix| map.then(matrix));
        Source { pixels, coarse, opponent, relative, screen }
    }

    /// Means of blocks of the opponent colours, after the wide filters.
    fn coarse(&self, MappedPicture { pixels, map }: &MappedPicture<'_>) -> [Vec<f32>; 3] {
        let opponent = map.then(&self.opponent);
        let block = self.block;
        let [across, down] = [self.columns, self.rows].map(|count| count.div_ceil(block));
        let mut planes = [0; 3].map(|_| vec![0.0_f64; across * down]);
        let mirrored =
            |at: usize, count: usize| if at < count { at } else { (2 * count - 1 - at).min(count - 1) };
        let scale = 1.0 / (block * block) as f64;
        let mut sums = vec![[0.0_f32; 3]; across * block];
        for row in 0..down {
            sums.fill([0.0; 3]);
            for y in row * block..(row + 1) * block {
                let line = &pixels[mirrored(y, self.rows) * self.columns..][..self.columns];
                for (sum, pixel) in sums.iter_mut().zip(line) {
                    (0..3).for_each(|k| sum[k] += pixel[k]);
                }
            }
            for x in self.columns..across * block {
                sums[x] = sums[mirrored(x, self.columns)];
            }
            for (column, sums) in sums.chunks_exact(block).enumerate() {
                let sum = [0, 1, 2].map(|k| sums.iter().map(|one| f64::from(one[k])).sum::<f64>() * scale);
                for ((plane, row_of), offset) in planes.iter_mut().zip(&opponent.matrix).zip(opponent.offset)
                {
                    let mean: f64 = (0..3).map(|k| f64::from(row_of[k]) * sum[k]).sum();
                    plane[row * across + column] = mean + f64::from(offset);
                }
            }
        }
        let [transfer_one, transfer_two, transfer_three] =
            FILTERS.map(|filter| self.wide(filter, [across, down]));
        let [one, two, three] = &mut planes;
        filtered([one, two], across, [&transfer_one, &transfer_two]);
        filtered([three, &mut []], across, [&transfer_three, &[]]);
        planes.map(|plane| plane.into_iter().map(|value| value as f32).collect())
    }

    /// The wide Gaussians of a filter at the frequencies of the blocks.
    fn wide(&self, filter: &[(f64, f64)], size: [usize; 2]) -> Vec<Separable> {
        let total: f64 = filter.iter().map(|(_, weight)| weight).sum();
        let per_degree = self.reader.per_degree / self.block as f64;
        let values = |count: usize, scale: f64, width: f64| -> Vec<f64> {
            let value = |k: usize| {
                let frequency = k as f64 / (2 * count) as f64;
                // The mean of a block, and the triangle of the interpolation.
                let sinc = if k == 0 { 1.0 } else { (PI * frequency).sin() / (PI * frequency) };
                let correction = if self.block > 1 { sinc.powi(3) } else { 1.0 };
                scale * gaussian(frequency * per_degree, width) / correction
            };
            (0..count).map(value).collect()
        };
        let wide = filter.iter().filter(|(width, _)| *width >= WIDE_DEG);
        wide.map(|(width, weight)| Separable {
            along_x: values(size[0], weight / total, *width),
            along_y: values(size[1], 1.0, *width),
        })
        .collect()
    }
}

/// Samples of a narrow Gaussian with a weight, from its middle to one side: those that have its transfer function
/// up to half a cycle per pixel. Both axes have the root of the weight.
fn kernel(width_deg: f64, weight: f64, per_degree: f64) -> Vec<f32> {
    const STEPS: usize = 512;
    let sigma = width_deg * per_degree / (8.0 * LN_2).sqrt();
    let reach = ((4.5 * sigma).ceil() as usize).max(8);
    let value = |at: usize| {
        let part = |step: usize| {
            let frequency = (step as f64 + 0.5) / (2 * STEPS) as f64;
            gaussian(frequency * per_degree, width_deg) * (2.0 * PI * frequency * at as f64).cos()
        };
        (0..STEPS).map(part).sum::<f64>() / STEPS as f64
    };
    let values: Vec<f64> = (0..=reach).map(value).collect();
    let sum = values[0] + 2.0 * values[1..].iter().sum::<f64>();
    values.into_iter().map(|value| (value * weight.sqrt() / sum) as f32).collect()
}

/// Some rows of pictures, the first compared with the others.
struct Stripe<'a> {
    eye: &'a Eye,
    pictures: &'a [Source<'a>],
    inner: Range<usize>,
    histograms: &'a mut [[Histogram; 2]],
}

/// What is seen of some rows of a picture.
struct Seen {
    plain: [Vec<f32>; 3],
    blurred: [Vec<f32>; 3],
    contrast: f64,
    flip: FlipPicture,
}

impl NullaryFnOnce for Stripe<'_> {
    type Output = Vec<Sums>;

    #[inline(always)]
    fn call(self) -> Vec<Sums> {
        let Self { eye, pictures, inner, histograms } = self;
        let own = eye.seen(&pictures[0], inner.clone());
        let mut all = Vec::new();
        for (picture, [plain, blurred]) in pictures[1..].iter().zip(histograms) {
            let other = eye.seen(picture, inner.clone());
            let mut sums = Sums { contrasts: [own.contrast, other.contrast], ..Sums::default() };
            let mut differences = vec![0.0; own.plain[0].len()];
            delta_e_2000(&own.plain, &other.plain, &eye.hues, &mut differences);
            sums.plain = plain.count(&differences);
            delta_e_2000(&own.blurred, &other.blurred, &eye.hues, &mut differences);
            sums.blurred = blurred.count(&differences);
            sums.chromas = chromas(&own.blurred, &other.blurred, eye.reader.coloured);
            sums.flip = own.flip.sum_of_differences(&other.flip);
            all.push(sums);
        }
        all
    }
}

impl Eye {
    #[inline(always)]
    fn seen(&self, picture: &Source<'_>, inner: Range<usize>) -> Seen {
        let columns = self.columns;
        let pixels = |rows: Range<usize>| &picture.pixels[rows.start * columns..rows.end * columns];
        let around = |reach: usize| inner.start.saturating_sub(reach)..(inner.end + reach).min(self.rows);
        let mut plain = planes(pixels(inner.clone()), &picture.relative);
        to_lab(&mut plain);
        let windowed = around(self.reader.window);
        let mut blurred = self.blurred(picture, windowed.clone());
        to_lab(&mut blurred);
        let skipped = (inner.start - windowed.start) * columns;
        let contrast = local_contrast(
            &blurred[0],
            columns,
            self.reader.window,
            inner.start - windowed.start..inner.end - windowed.start,
        );
        let blurred = blurred.map(|plane| plane[skipped..][..inner.len() * columns].to_vec());
        let reach = FlipPicture::reach(self.reader.per_degree);
        let more = around(reach);
        let rgb = planes(pixels(more.clone()), &picture.screen);
        let flip = FlipPicture::of_rows(
            rgb,
            columns,
            self.reader.per_degree,
            inner.start - more.start..inner.end - more.start,
        );
        Seen { plain, blurred, contrast, flip }
    }

    /// X, Y, Z relative to the white after the eye's blur, of some rows.
    #[inline(always)]
    fn blurred(&self, picture: &Source<'_>, rows: Range<usize>) -> [Vec<f32>; 3] {
        let columns = self.columns;
        let source = rows.start.saturating_sub(self.reach)..(rows.end + self.reach).min(self.rows);
        let opponent =
            planes(&picture.pixels[source.start * columns..source.end * columns], &picture.opponent);
        let mut sums = [0; 3].map(|_| Vec::new());
        let mut lines = Vec::new();
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = self.interpolated(&picture.coarse[k], rows.clone());
            for kernel in &self.narrow[k] {
                along_rows(&opponent[k], columns, kernel, &mut lines);
                for (row, into) in rows.clone().zip(sum.chunks_exact_mut(columns)) {
                    let line = |at: isize| {
                        let all = self.rows as isize;
                        let at = if at < 0 { -1 - at } else { at };
                        let at = if at >= all { 2 * all - 1 - at } else { at };
                        let at = (at.clamp(source.start as isize, source.end as isize - 1)) as usize;
                        &lines[(at - source.start) * columns..][..columns]
                    };
                    let row = row as isize;
                    into.iter_mut().zip(line(row)).for_each(|(sum, value)| *sum += kernel[0] * value);
                    for (distance, weight) in kernel.iter().enumerate().skip(1) {
                        let (above, below) = (line(row - distance as isize), line(row + distance as isize));
                        for ((sum, above), below) in into.iter_mut().zip(above).zip(below) {
                            *sum += weight * (above + below);
                        }
                    }
                }
            }
        }
        let [one, two, three] = &mut sums;
        for ((one, two), three) in one.iter_mut().zip(two).zip(three) {
            [*one, *two, *three] = times(&self.back, [*one, *two, *three]);
        }
        sums
    }

    /// Values between the middles of blocks, of some rows.
    #[inline(always)]
    fn interpolated(&self, coarse: &[f32], rows: Range<usize>) -> Vec<f32> {
        let (block, across) = (self.block, self.columns.div_ceil(self.block));
        let down = coarse.len() / across;
        let place = |at: usize, count: usize| {
            let at = (((at as f32 + 0.5) / block as f32) - 0.5).clamp(0.0, count as f32 - 1.0);
            let first = (at as usize).min(count.saturating_sub(2));
            (first, at - first as f32)
        };
        let along: Vec<(usize, f32)> = (0..self.columns).map(|x| place(x, across)).collect();
        let mut line = vec![0.0; across + 1];
        let mut all = Vec::with_capacity(rows.len() * self.columns);
        for row in rows {
            let (first, part) = place(row, down);
            let next = (first + 1).min(down - 1);
            let both = coarse[first * across..][..across].iter().zip(&coarse[next * across..][..across]);
            line.iter_mut().zip(both).for_each(|(to, (one, other))| *to = one + part * (other - one));
            line[across] = line[across - 1];
            all.extend(along.iter().map(|(first, part)| {
                let (one, other) = (line[*first], line[*first + 1]);
                one + part * (other - one)
            }));
        }
        all
    }
}

/// The results of `of` for 0 to `count` - 1 in their order, by several threads, each with something of its own.
fn in_turn<S, R: Send>(
    threads: usize,
    count: usize,
    fresh: &(dyn Fn() -> S + Sync),
    of: &(dyn Fn(&mut S, usize) -> R + Sync),
) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let work = || {
        let (mut own, mut done) = (fresh(), Vec::new());
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= count {
                return done;
            }
            done.push((number, of(&mut own, number)));
        }
    };
    let threads = threads.clamp(1, count.max(1));
    let mut results = if threads == 1 {
        work()
    } else {
        std::thread::scope(|scope| {
            let work = &work;
            let running: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
            let join = |one: std::thread::ScopedJoinHandle<'_, _>| {
                one.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            };
            running.into_iter().flat_map(join).collect()
        })
    };
    results.sort_by_key(|(number, _)| *number);
    results.into_iter().map(|(_, result)| result).collect()
}
