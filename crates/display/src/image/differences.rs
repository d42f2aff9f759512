//! How much two pictures in the same light differ: CIEDE2000 of each pixel, and for a reader at a distance S-CIELAB and FLIP.

use papilio_colour::pictures::{
    Comparison, FlipPicture, LEAST_PER_DEGREE, MappedPicture, NO_CONTRAST, Picture, Reader, compared, scielab,
};
use papilio_colour::{Adaptation, ColourError, D65_WHITE, Xyz};
use papilio_imaging::window_means;
use schemars::JsonSchema;
use serde::Serialize;

use super::colour;
use super::tone_shift::{ToneShift, tone_shifts};
use crate::threads::each;

/// Differences of two pictures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct PictureDifferences {
    /// CIEDE2000 of the pixels, without the eye's blur: the mean.
    pub delta_e_2000_mean: f64,
    /// Median.
    pub delta_e_2000_p50: f64,
    /// 95th percentile.
    pub delta_e_2000_p95: f64,
    /// S-CIELAB (CIEDE2000 after the eye's blur): the mean; null without a size of pixels.
    pub scielab_mean: Option<f64>,
    /// 95th percentile.
    pub scielab_p95: Option<f64>,
    /// FLIP, 0 to 1: the mean.
    pub flip_mean: Option<f64>,
    /// Mean difference of the hue in CIELAB after the eye's blur, deg, weighted with the other picture's chroma,
    /// where that is above 8; null where there is none.
    pub hue_error_deg: Option<f64>,
    /// Mean chroma in CIELAB after the eye's blur over that of the other picture, where that is above 8.
    pub chroma_ratio: Option<f64>,
    /// Mean standard deviation of L* after the eye's blur in windows of 0.15 degrees over that of the other
    /// picture.
    pub local_contrast_ratio: Option<f64>,
    /// Root mean square difference of the mean Y of blocks of 64 x 64 pixels, per cent of the root mean square of the other
    /// picture's: the tone, without the pattern of a halftone.
    pub tone_shift_percent: f64,
    /// Root mean square CIEDE2000 of the mean colours of these blocks.
    pub tone_shift_delta_e_2000: f64,
}

/// Chroma of the other picture from which hue and chroma are compared, and of what is seen, below which it has no
/// hue.
const COLOURED: f64 = 8.0;
const WITH_HUE: f64 = 2.0;

/// Side of the windows of local contrast, degrees.
const WINDOW_DEG: f64 = 0.15;

fn window_radius(per_degree: f64) -> usize {
    ((0.5 * WINDOW_DEG * per_degree).round() as usize).max(1)
}

/// Pixels from which differences are computed stripe by stripe.
const MANY: usize = 200_000;

/// Full width at half maximum of the narrowest Gaussian of S-CIELAB, degrees: what a reader sees is smooth over half of it.
const NARROWEST_DEG: f64 = 0.05;

/// Samples of a picture at least: a mean is then known within a hundredth of the difference of neighbouring pixels or better.
const LEAST_SAMPLES: usize = 90_000;

/// Columns and rows between the pixels that are compared.
fn step(per_degree: f64, pixels: usize) -> usize {
    let smooth = (0.94 * NARROWEST_DEG * per_degree) as usize;
    smooth.min((pixels / LEAST_SAMPLES).isqrt()).max(1)
}

impl From<Comparison> for PictureDifferences {
    fn from(one: Comparison) -> Self {
        let ratio = |part: f64, whole: f64| (whole > 0.0).then(|| part / whole);
        let [wanted, shown, hued, turned] = one.chromas;
        Self {
            delta_e_2000_mean: one.plain.mean,
            delta_e_2000_p50: one.plain.p50,
            delta_e_2000_p95: one.plain.p95,
            scielab_mean: Some(one.scielab.mean),
            scielab_p95: Some(one.scielab.p95),
            flip_mean: Some(one.flip_mean),
            hue_error_deg: ratio(turned, hued),
            chroma_ratio: ratio(shown, wanted),
            local_contrast_ratio: ratio(one.contrasts[0], one.contrasts[1]),
            tone_shift_percent: 0.0,
            tone_shift_delta_e_2000: 0.0,
        }
    }
}

/// Hue error in degrees, ratio of chroma and ratio of local contrast of a picture in CIELAB to another.
fn likeness(seen: &Picture, other: &Picture, per_degree: f64) -> [Option<f64>; 3] {
    let [mut chromas, mut shown, mut hued, mut turned] = [0.0; 4];
    for ([_, a, b], [_, other_a, other_b]) in seen.pixels().zip(other.pixels()) {
        let (chroma, wanted) = (a.hypot(b), other_a.hypot(other_b));
        if wanted > COLOURED {
            chromas += wanted;
            shown += chroma;
            if chroma > WITH_HUE {
                let (across, along) = (other_a * b - other_b * a, other_a * a + other_b * b);
                hued += wanted;
                turned += wanted * across.atan2(along).abs().to_degrees();
            }
        }
    }
    let radius = window_radius(per_degree);
    let contrast = |picture: &Picture| {
        let lightness = &picture.planes()[0];
        let mean = window_means(lightness.clone(), picture.columns(), radius);
        let square = window_means(lightness.iter().map(|one| one * one).collect(), picture.columns(), radius);
        let variances = mean.iter().zip(square).map(|(mean, square)| square - mean * mean);
        variances.filter(|variance| *variance > NO_CONTRAST).map(f64::sqrt).sum::<f64>()
    };
    let ratio = |part: f64, whole: f64| (whole > 0.0).then(|| part / whole);
    [ratio(turned, hued), ratio(shown, chromas), ratio(contrast(seen), contrast(other))]
}

/// Mean, median and 95th percentile.
struct Difference {
    mean: f64,
    p50: f64,
    p95: f64,
}

impl Difference {
    fn of(mut values: Vec<f64>) -> Self {
        let count = values.len().max(1);
        let mean = values.iter().sum::<f64>() / count as f64;
        let mut quantile = |fraction: f64| {
            let at = ((count as f64 - 1.0) * fraction).round() as usize;
            if at >= values.len() {
                return 0.0;
            };
            *values.select_nth_unstable_by(at, f64::total_cmp).1
        };
        Self { mean, p50: quantile(0.5), p95: quantile(0.95) }
    }
}

impl PictureDifferences {
    /// Compares what is seen, with rows of `columns` by a reader who is adapted to this white, with other pictures, on two threads if there are
    /// so many.
    ///
    /// # Errors
    /// If the white has no X, Y or Z.
    pub(super) fn against<const N: usize>(
        seen: &[[f32; 3]],
        others: [MappedPicture<'_>; N],
        columns: usize,
        white: Xyz,
        pixels_per_degree: Option<f64>,
        threads: usize,
    ) -> Result<[Self; N], ColourError> {
        let mut differences = if let Some(per_degree) = pixels_per_degree
            && per_degree >= LEAST_PER_DEGREE
            && seen.len() >= MANY
        {
            let (coloured, window) = ([COLOURED as f32, WITH_HUE as f32], window_radius(per_degree));
            let step = step(per_degree, seen.len());
            let reader = Reader { white, per_degree, coloured, window, step };
            compared(seen, others, columns, reader, threads)?.map(Self::from)
        } else {
            Self::one_by_one(seen, others, columns, white, pixels_per_degree, threads)?
        };
        let shifts = tone_shifts(seen, others, columns, white, threads)?;
        for (differences, ToneShift { percent, delta_e_2000 }) in differences.iter_mut().zip(shifts) {
            (differences.tone_shift_percent, differences.tone_shift_delta_e_2000) = (percent, delta_e_2000);
        }
        Ok(differences)
    }

    /// The same but for the tone shift, of whole pictures one by one, in double precision.
    fn one_by_one<const N: usize>(
        seen: &[[f32; 3]],
        others: [MappedPicture<'_>; N],
        columns: usize,
        white: Xyz,
        pixels_per_degree: Option<f64>,
        threads: usize,
    ) -> Result<[Self; N], ColourError> {
        let to_screen = Adaptation::between(white, D65_WHITE).ok_or(ColourError::NoWhite)?;
        let picture = |MappedPicture { pixels, map }: MappedPicture<'_>,
                       of: &(dyn Fn(Xyz) -> [f64; 3] + Sync)| {
            let mut planes = [0; 3].map(|_| Vec::with_capacity(pixels.len()));
            for pixel in pixels {
                let values = of(map.apply(colour(*pixel)));
                planes.iter_mut().zip(values).for_each(|(plane, value)| plane.push(value));
            }
            Picture::new(columns, planes)
        };
        let xyz = |picture_of: MappedPicture<'_>| picture(picture_of, &Xyz::to_array);
        let seen = MappedPicture::from(seen);
        let own = xyz(seen)?.into_lab(white)?;
        let mut differences: [Self; N] = all_of(threads, |k| {
            let plain = Difference::of(own.delta_e_2000(&xyz(others[k])?.into_lab(white)?)?);
            Ok(Self {
                delta_e_2000_mean: plain.mean,
                delta_e_2000_p50: plain.p50,
                delta_e_2000_p95: plain.p95,
                scielab_mean: None,
                scielab_p95: None,
                flip_mean: None,
                hue_error_deg: None,
                chroma_ratio: None,
                local_contrast_ratio: None,
                tone_shift_percent: 0.0,
                tone_shift_delta_e_2000: 0.0,
            })
        })?;
        drop(own);
        let Some(per_degree) = pixels_per_degree else { return Ok(differences) };
        let [own] = scielab([xyz(seen)?], white, per_degree)?;
        let blurred: [(Difference, [Option<f64>; 3]); N] = all_of(threads, |k| {
            let [other] = scielab([xyz(others[k])?], white, per_degree)?;
            Ok((Difference::of(own.delta_e_2000(&other)?), likeness(&own, &other, per_degree)))
        })?;
        for (differences, (blurred, likeness)) in differences.iter_mut().zip(blurred) {
            (differences.scielab_mean, differences.scielab_p95) = (Some(blurred.mean), Some(blurred.p95));
            let [hue, chroma, contrast] = likeness;
            (differences.hue_error_deg, differences.chroma_ratio) = (hue, chroma);
            differences.local_contrast_ratio = contrast;
        }
        drop(own);
        let flip = |picture_of: MappedPicture<'_>| {
            let rgb = picture(picture_of, &|pixel| to_screen.apply(pixel).linear_srgb())?;
            Ok::<_, ColourError>(FlipPicture::new(&rgb, per_degree))
        };
        let own = flip(seen)?;
        let flips: [f64; N] = all_of(threads, |k| {
            let values = own.differences(&flip(others[k])?)?;
            Ok(values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64)
        })?;
        for (differences, flip) in differences.iter_mut().zip(flips) {
            differences.flip_mean = Some(flip);
        }
        Ok(differences)
    }
}

/// The results of `of` for 0 to N - 1, at the same time if there are several threads.
fn all_of<const N: usize, T: Send>(
    threads: usize,
    of: impl Fn(usize) -> Result<T, ColourError> + Sync,
) -> Result<[T; N], ColourError> {
    let numbers: [usize; N] = std::array::from_fn(|k| k);
    let all: Vec<T> = each(&numbers, threads, |k| of(*k)).into_iter().collect::<Result<_, _>>()?;
    Ok(all.try_into().unwrap_or_else(|_| unreachable!("one result for each number")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_pictures_do_not_differ_and_quantiles_are_ordered() {
        let grey: Vec<[f32; 3]> =
            (0..64).map(|k| [0.3, 0.32, 0.35].map(|one: f32| one * (1.0 + k as f32 / 64.0))).collect();
        let darker: Vec<[f32; 3]> = grey
            .iter()
            .enumerate()
            .map(|(k, pixel)| pixel.map(|one| one * (1.0 - k as f32 / 200.0)))
            .collect();
        let with = |threads| {
            let others = [&darker[..], &grey, &darker].map(MappedPicture::from);
            PictureDifferences::against(&grey, others, 8, D65_WHITE, Some(40.0), threads).unwrap()
        };
        let [one, none, again] = with(1);
        assert_eq!(with(2), [one, none, again]);
        assert_eq!((none.delta_e_2000_p95, none.flip_mean), (0.0, Some(0.0)));
        assert_eq!((again.delta_e_2000_mean, again.flip_mean), (one.delta_e_2000_mean, one.flip_mean));
        // One plane is the real part of a transform, its equal the imaginary part of another: rounding differs.
        assert!(none.scielab_mean.unwrap() < 1e-12, "{none:?}");
        assert!(0.0 < one.delta_e_2000_p50 && one.delta_e_2000_p50 < one.delta_e_2000_p95);
        assert!(one.flip_mean.unwrap() > 0.0 && one.scielab_mean.unwrap() > 0.0);
    }

    /// Stripe by stripe, with any number of threads, numbers are those of whole pictures; with samples within what
    /// their number permits. One of the pictures has a mask's regular pattern, which samples at equal distances would meet at
    /// the same places.
    #[test]
    fn differences_of_large_pictures_are_those_of_whole_ones() {
        let white = Xyz { x: 0.9, y: 0.8, z: 0.3 };
        let mut dice = papilio_testing::Dice::new(8, 0);
        let states =
            [[0.05, 0.05, 0.02], [0.8, 0.75, 0.28], [0.6, 0.62, 0.05], [0.35, 0.2, 0.03], [0.08, 0.1, 0.2]];
        for (columns, rows, per_degree, step, is_masked) in [
            (201, 150, 25.0, 1, false),
            (201, 150, 44.0, 1, false),
            (201, 150, 90.0, 1, false),
            (640, 600, 44.0, 2, false),
            (640, 600, 44.0, 2, true),
            (640, 600, 90.0, 3, false),
        ] {
            let smooth: Vec<[f32; 3]> = (0..columns * rows)
                .map(|at| {
                    let (x, y) =
                        ((at % columns) as f32 / columns as f32, (at / columns) as f32 / rows as f32);
                    [0.2 + 0.4 * x, 0.2 + 0.3 * x + 0.1 * (9.0 * y).sin(), 0.05 + 0.2 * y]
                })
                .collect();
            let masked =
                |at: usize| states[usize::from(at.is_multiple_of(2) && (at / columns).is_multiple_of(2))];
            let seen: Vec<[f32; 3]> = smooth
                .iter()
                .enumerate()
                .map(|(at, pixel)| match is_masked {
                    true => masked(at),
                    false if dice.throw() < 0.4 => *pixel,
                    false => states[dice.below(5)],
                })
                .collect();
            let darker: Vec<[f32; 3]> = smooth.iter().map(|pixel| pixel.map(|one| 0.8 * one)).collect();
            let others = [&smooth[..], &darker].map(MappedPicture::from);
            let plain =
                PictureDifferences::one_by_one(&seen, others, columns, white, Some(per_degree), 2).unwrap();
            let (coloured, window) = ([COLOURED as f32, WITH_HUE as f32], window_radius(per_degree));
            let reader = Reader { white, per_degree, coloured, window, step };
            let of = |threads| compared(&seen, others, columns, reader, threads).unwrap();
            assert_eq!(of(1), of(3));
            for (plain, found) in plain.into_iter().zip(of(2).map(PictureDifferences::from)) {
                let numbers = |one: PictureDifferences| {
                    [
                        Some(one.delta_e_2000_mean),
                        Some(one.delta_e_2000_p50),
                        Some(one.delta_e_2000_p95),
                        one.scielab_mean,
                        one.scielab_p95,
                        one.flip_mean,
                        one.hue_error_deg,
                        one.chroma_ratio,
                        one.local_contrast_ratio,
                    ]
                };
                for (number, (plain, found)) in numbers(plain).into_iter().zip(numbers(found)).enumerate() {
                    let (plain, found) = (plain.unwrap(), found.unwrap());
                    // The last blocks overhang these small pictures, and few pixels are near a quantile. Without blur, differences
                    // scatter by 25: of 43 000 samples, the mean by 0.12 of 21, the median by 0.24 of 9. In a window of 3.3 samples
                    // across, contrast that is all noise is up to 3.2 % smaller, and that of a slope or a mask, whose places change
                    // by half a pixel, up to 3.1 % larger.
                    let relative = match (step, number, is_masked) {
                        (1, _, _) => 4e-3,
                        (_, 8, _) => 0.04,
                        (_, 1, false) => 0.03,
                        (_, 0 | 2, false) => 0.01,
                        _ => 5e-3,
                    };
                    let tolerance = relative * plain + 2e-3;
                    assert!(
                        (plain - found).abs() < tolerance,
                        "{per_degree} {step} {is_masked} {number}: {plain} {found}"
                    );
                }
            }
        }
    }

    /// A uniform colour with half of its chroma and its hue turned by 10 degrees; stripes with a third of their
    /// contrast, and none of colour.
    #[test]
    fn hue_chroma_and_local_contrast_are_those_of_the_change() {
        let white = D65_WHITE;
        let of = |lab: [f64; 3]| {
            let [l, a, b] = lab;
            let root = |t: f64| if t > 6.0 / 29.0 { t.powi(3) } else { 108.0 / 841.0 * (t - 4.0 / 29.0) };
            let y = (l + 16.0) / 116.0;
            let xyz = [white.x * root(y + a / 500.0), white.y * root(y), white.z * root(y - b / 200.0)];
            xyz.map(|one| one as f32)
        };
        let uniform = |chroma: f64, hue_deg: f64| {
            let hue = hue_deg.to_radians();
            vec![of([60.0, chroma * hue.cos(), chroma * hue.sin()]); 48 * 48]
        };
        let against = |seen: &[[f32; 3]], other: &[[f32; 3]]| {
            PictureDifferences::against(seen, [other.into()], 48, white, Some(20.0), 1).unwrap()[0]
        };
        let turned = against(&uniform(20.0, 70.0), &uniform(40.0, 60.0));
        assert!((turned.hue_error_deg.unwrap() - 10.0).abs() < 1e-3, "{turned:?}");
        assert!((turned.chroma_ratio.unwrap() - 0.5).abs() < 1e-4, "{turned:?}");
        // A flat picture has no contrast to compare with, whatever is seen of it; rounding is none.
        assert_eq!(turned.local_contrast_ratio, None);
        let stripes = |contrast: f64| {
            let tone = |at: usize| [0.0, 1.0][at % 48 / 6 % 2] - 0.5;
            (0..48 * 48).map(|at| of([50.0 + contrast * tone(at), 0.0, 0.0])).collect::<Vec<_>>()
        };
        let flat = against(&stripes(4.0), &stripes(12.0));
        assert_eq!((flat.hue_error_deg, flat.chroma_ratio), (None, None));
        // The blur is linear in light, not in L*.
        assert!((flat.local_contrast_ratio.unwrap() - 1.0 / 3.0).abs() < 0.01, "{flat:?}");
    }
}
