//! Differences of large pictures, stripe by stripe: little memory, and all threads.
//!
//! **What.** The same numbers as of [`Picture::delta_e_2000`](super::Picture::delta_e_2000),
//! [`scielab`](super::scielab()) and [`FlipPicture`](super::FlipPicture), in single precision:
//!
//! - narrow Gaussians of S-CIELAB are sampled kernels that have their transfer functions; wide ones, of 0.6 degrees
//!   and more, filter means of blocks of pixels, between which is interpolated, with a correction for both;
//! - quantiles are those of a histogram with steps of 1/256, interpolated;
//! - what is compared are samples: one pixel of each square of `step` pixels, at changing places in it. Rows and columns without samples
//!   are needed for the blurs only.
//!
//! **Range.** 24 pixels per degree or more. Means agree with the plain method within 1e-3 of their value with a step of 1; with samples,
//! the mean of a difference d is uncertain by the standard deviation of d inside a square over the root of their number.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use pulp::NullaryFnOnce;

use super::difference::delta_e_2000;
use super::eye::{Eye, Source};
use super::histogram::Histogram;
use super::mapped::MappedPicture;
use super::planes::chromas;
use super::rows::{MOST_STEPS, stride};
use super::view::View;
use crate::{Adaptation, ColourError, D65_WHITE, Xyz};

/// Pixels per degree from which narrow Gaussians have small kernels.
pub const LEAST_PER_DEGREE: f64 = 24.0;

/// Rows with samples over which is summed before all sums are added, in their order.
const ROWS: usize = 64;

/// Rows of each picture that are computed before those of the next one: what they need stays in the cache.
pub(super) const BATCH: usize = 8;

/// Stripes for each thread, at least, of a large picture: longer ones compute fewer rows twice.
const STRIPES: usize = 4;

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
    /// Columns and rows between samples, up to 8: 1 compares all pixels.
    pub step: usize,
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
    let [wide, high] = size(seen);
    let reader = Reader { step: reader.step.min(MOST_STEPS).clamp(1, wide.min(high)), ..reader };
    let eye = Eye::new(reader, to_screen, size(seen));
    let all: Vec<MappedPicture<'_>> = [seen.into()].into_iter().chain(others).collect();
    let coarse = in_turn(threads, all.len(), &|| (), &|(), number| eye.coarse(all[number]));
    let pictures: Vec<Source<'_>> = all
        .iter()
        .zip(&coarse)
        .map(|(picture, coarse)| eye.source(picture, coarse.each_ref().map(Vec::as_slice)))
        .collect();
    let rows = eye.down;
    let parts = rows.div_ceil(ROWS).div_ceil(STRIPES * threads.max(1)) * ROWS;
    let histograms = std::sync::Mutex::new(vec![[Histogram::default(), Histogram::default()]; N]);
    let fresh = || Own {
        into: &histograms,
        histograms: vec![[Histogram::default(), Histogram::default()]; N],
        views: pictures.iter().map(|_| View::new(&eye)).collect(),
    };
    let sums = in_turn(threads, rows.div_ceil(parts), &fresh, &|own: &mut Own<'_>, number| {
        let rows = number * parts..((number + 1) * parts).min(rows);
        pulp::Arch::new().dispatch(Stripe { eye: &eye, pictures: &pictures, rows, own })
    });
    let histograms = histograms.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    let count = (eye.across * eye.down) as f64;
    Ok(std::array::from_fn(|k| {
        let mut total = Sums::default();
        sums.iter().flatten().for_each(|sums| total.add(&sums[k]));
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

/// What a thread needs: rows of the pictures, and histograms, which are added to those of all when it ends.
struct Own<'a> {
    into: &'a std::sync::Mutex<Vec<[Histogram; 2]>>,
    histograms: Vec<[Histogram; 2]>,
    views: Vec<View>,
}

impl Drop for Own<'_> {
    fn drop(&mut self) {
        let mut all = self.into.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        for (all, own) in all.as_flattened_mut().iter_mut().zip(self.histograms.as_flattened()) {
            all.add(own);
        }
    }
}

/// What is summed over the pixels of some rows.
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

/// Some rows of pictures, the first compared with the others.
struct Stripe<'a, 'b> {
    eye: &'a Eye,
    pictures: &'a [Source<'a>],
    rows: Range<usize>,
    own: &'a mut Own<'b>,
}

impl NullaryFnOnce for Stripe<'_, '_> {
    type Output = Vec<Vec<Sums>>;

    /// The sums of each [`ROWS`] rows, for each other picture.
    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { eye, pictures, rows, own: Own { histograms, views, .. } } = self;
        views.iter_mut().for_each(|view| view.begin(eye, rows.start));
        let mut all = Vec::new();
        let mut differences = vec![0.0; stride(eye.across)];
        for first in rows.clone().step_by(ROWS) {
            let end = (first + ROWS).min(rows.end);
            let mut sums = vec![Sums::default(); pictures.len() - 1];
            let mut flips = vec![Vec::with_capacity(2 * eye.across); pictures.len() - 1];
            let mut contrasts = vec![0.0; pictures.len()];
            for batch in (first..end).step_by(BATCH) {
                let batch = batch..(batch + BATCH).min(end);
                for ((view, picture), contrast) in views.iter_mut().zip(pictures).zip(&mut contrasts) {
                    view.see(eye, picture, batch.clone(), contrast);
                }
                let (seen, others) = views.split_at(1);
                for (k, other) in others.iter().enumerate() {
                    let [plain, blurred] = &mut histograms[k];
                    for row in batch.clone() {
                        let (own, other) = (seen[0].row(row), other.row(row));
                        delta_e_2000(own.plain, other.plain, &eye.hues, &mut differences);
                        plain.count(&differences[..eye.across], &mut sums[k].plain);
                        delta_e_2000(own.blurred, other.blurred, &eye.hues, &mut differences);
                        blurred.count(&differences[..eye.across], &mut sums[k].blurred);
                        chromas(
                            own.blurred,
                            other.blurred,
                            eye.across,
                            eye.reader.coloured,
                            &mut sums[k].chromas,
                        );
                        eye.flip.differences(own.flip, other.flip, &mut differences);
                        add_blocks(&mut flips[k], &differences[..eye.across], &mut sums[k].flip);
                    }
                }
            }
            for (k, (sums, rest)) in sums.iter_mut().zip(flips).enumerate() {
                sums.flip += f64::from(rest.iter().sum::<f32>());
                sums.contrasts = [contrasts[0], contrasts[k + 1]];
            }
            all.push(sums);
        }
        all
    }
}

/// Adds values in blocks, whose sums have single precision; `rest` are those of a block that is not complete.
#[inline(always)]
fn add_blocks(rest: &mut Vec<f32>, values: &[f32], sum: &mut f64) {
    const BLOCK: usize = 64;
    rest.extend_from_slice(values);
    let (blocks, _) = rest.as_chunks::<BLOCK>();
    let done = blocks.len() * BLOCK;
    blocks.iter().for_each(|block| *sum += f64::from(block.iter().sum::<f32>()));
    rest.copy_within(done.., 0);
    rest.truncate(rest.len() - done);
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
