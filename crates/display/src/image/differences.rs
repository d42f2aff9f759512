//! How much two pictures in the same light differ: CIEDE2000 of each pixel, and for a reader at a distance S-CIELAB and FLIP.

use papilio_colour::pictures::{FlipPicture, Picture, scielab};
use papilio_colour::{Adaptation, ColourError, D65_WHITE, Xyz};
use schemars::JsonSchema;
use serde::Serialize;

use super::colour;

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
        others: [&[[f32; 3]]; N],
        columns: usize,
        white: Xyz,
        pixels_per_degree: Option<f64>,
        threads: usize,
    ) -> Result<[Self; N], ColourError> {
        let to_screen = Adaptation::between(white, D65_WHITE).ok_or(ColourError::NoWhite)?;
        let picture = |pixels: &[[f32; 3]], of: &(dyn Fn(Xyz) -> [f64; 3] + Sync)| {
            let mut planes = [0; 3].map(|_| Vec::with_capacity(pixels.len()));
            for pixel in pixels {
                planes.iter_mut().zip(of(colour(*pixel))).for_each(|(plane, value)| plane.push(value));
            }
            Picture::new(columns, planes)
        };
        let xyz = |pixels| picture(pixels, &Xyz::to_array);
        let own = xyz(seen)?.into_lab(white)?;
        let mut differences: [Self; N] = each(threads, |k| {
            let plain = Difference::of(own.delta_e_2000(&xyz(others[k])?.into_lab(white)?)?);
            Ok(Self {
                delta_e_2000_mean: plain.mean,
                delta_e_2000_p50: plain.p50,
                delta_e_2000_p95: plain.p95,
                scielab_mean: None,
                scielab_p95: None,
                flip_mean: None,
            })
        })?;
        drop(own);
        let Some(per_degree) = pixels_per_degree else { return Ok(differences) };
        let [own] = scielab([xyz(seen)?], white, per_degree)?;
        let blurred: [Difference; N] = each(threads, |k| {
            let [other] = scielab([xyz(others[k])?], white, per_degree)?;
            Ok(Difference::of(own.delta_e_2000(&other)?))
        })?;
        for (differences, blurred) in differences.iter_mut().zip(blurred) {
            (differences.scielab_mean, differences.scielab_p95) = (Some(blurred.mean), Some(blurred.p95));
        }
        drop(own);
        let flip = |pixels| {
            let rgb = picture(pixels, &|pixel| to_screen.apply(pixel).linear_srgb())?;
            Ok::<_, ColourError>(FlipPicture::new(&rgb, per_degree))
        };
        let own = flip(seen)?;
        let flips: [f64; N] = each(threads, |k| {
            let values = own.differences(&flip(others[k])?)?;
            Ok(values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64)
        })?;
        for (differences, flip) in differences.iter_mut().zip(flips) {
            differences.flip_mean = Some(flip);
        }
        Ok(differences)
    }
}

/// The results of `of` for 0 to N - 1, at the same time if there are two threads.
fn each<const N: usize, T: Send>(
    threads: usize,
    of: impl Fn(usize) -> Result<T, ColourError> + Sync,
) -> Result<[T; N], ColourError> {
    let numbers: [usize; N] = std::array::from_fn(|k| k);
    let results = match threads {
        0 | 1 => numbers.map(&of),
        _ => std::thread::scope(|scope| {
            let of = &of;
            let running = numbers.map(|k| scope.spawn(move || of(k)));
            running.map(|one| one.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        }),
    };
    let all: Vec<T> = results.into_iter().collect::<Result<_, _>>()?;
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
            let others = [&darker[..], &grey, &darker];
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
}
