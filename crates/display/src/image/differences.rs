//! How much two pictures in the same light differ: CIEDE2000 of each pixel, and for a reader at a distance S-CIELAB and FLIP.

use papilio_colour::pictures::{FlipPicture, Picture, scielab};
use papilio_colour::{Adaptation, ColourError, Xyz};
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
    /// Compares what is seen, with rows of `columns` in a light of this white, with other pictures, on two threads if there are so many; `to_screen`
    /// adapts it to D65.
    ///
    /// # Errors
    /// If the white has no X, Y or Z.
    pub(super) fn against(
        seen: &[[f32; 3]],
        others: [&[[f32; 3]]; 2],
        columns: usize,
        white: Xyz,
        to_screen: &Adaptation,
        pixels_per_degree: Option<f64>,
        threads: usize,
    ) -> Result<[Self; 2], ColourError> {
        let picture = |pixels: &[[f32; 3]], of: &(dyn Fn(Xyz) -> [f64; 3] + Sync)| {
            let mut planes = [0; 3].map(|_| Vec::with_capacity(pixels.len()));
            for pixel in pixels {
                planes.iter_mut().zip(of(colour(*pixel))).for_each(|(plane, value)| plane.push(value));
            }
            Picture::new(columns, planes)
        };
        let xyz = |pixels| picture(pixels, &Xyz::to_array);
        let own = xyz(seen)?.into_lab(white)?;
        let mut differences = both(threads, |k| {
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
        let [own, one, other] = scielab([xyz(seen)?, xyz(others[0])?, xyz(others[1])?], white, per_degree)?;
        let blurred = both(threads, |k| Ok(Difference::of(own.delta_e_2000([&one, &other][k])?)))?;
        for (differences, blurred) in differences.iter_mut().zip(blurred) {
            (differences.scielab_mean, differences.scielab_p95) = (Some(blurred.mean), Some(blurred.p95));
        }
        drop((own, one, other));
        let flip = |pixels| {
            let rgb = picture(pixels, &|pixel| to_screen.apply(pixel).linear_srgb())?;
            Ok::<_, ColourError>(FlipPicture::new(&rgb, per_degree))
        };
        let own = flip(seen)?;
        let flips = both(threads, |k| {
            let values = own.differences(&flip(others[k])?)?;
            Ok(values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64)
        })?;
        for (differences, flip) in differences.iter_mut().zip(flips) {
            differences.flip_mean = Some(flip);
        }
        Ok(differences)
    }
}

/// The results of `of` for 0 and 1, at the same time if there are two threads.
fn both<T: Send>(
    threads: usize,
    of: impl Fn(usize) -> Result<T, ColourError> + Sync,
) -> Result<[T; 2], ColourError> {
    if threads < 2 {
        return Ok([of(0)?, of(1)?]);
    }
    let [one, other] = std::thread::scope(|scope| {
        let other = scope.spawn(|| of(1));
        [of(0), other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))]
    });
    Ok([one?, other?])
}

#[cfg(test)]
mod tests {
    use papilio_colour::D65_WHITE;

    use super::*;

    #[test]
    fn equal_pictures_do_not_differ_and_quantiles_are_ordered() {
        let same = Adaptation::between(D65_WHITE, D65_WHITE).unwrap();
        let grey: Vec<[f32; 3]> =
            (0..64).map(|k| [0.3, 0.32, 0.35].map(|one: f32| one * (1.0 + k as f32 / 64.0))).collect();
        let darker: Vec<[f32; 3]> = grey
            .iter()
            .enumerate()
            .map(|(k, pixel)| pixel.map(|one| one * (1.0 - k as f32 / 200.0)))
            .collect();
        let against = |other: &[[f32; 3]]| {
            let pair = [other, &grey[..]];
            let with = |threads| {
                PictureDifferences::against(&grey, pair, 8, D65_WHITE, &same, Some(40.0), threads).unwrap()
            };
            let [one, none] = with(1);
            assert_eq!(with(2), [one, none]);
            assert_eq!((none.delta_e_2000_p95, none.flip_mean), (0.0, Some(0.0)));
            // One plane is the real part of a transform, its equal the imaginary part of another: rounding differs.
            assert!(none.scielab_mean.unwrap() < 1e-12, "{none:?}");
            one
        };
        let some = against(&darker);
        assert!(0.0 < some.delta_e_2000_p50 && some.delta_e_2000_p50 < some.delta_e_2000_p95);
        assert!(some.flip_mean.unwrap() > 0.0 && some.scielab_mean.unwrap() > 0.0);
    }
}
