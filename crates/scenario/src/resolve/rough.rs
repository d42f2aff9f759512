//! Rough layers: their roughness, and the distribution of their slopes.

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::Distribution;

use crate::describe::layers::{Rough, Slopes};
use crate::mistake::{self, Mistake};
use crate::origin::Origin;

/// A mistake and its place.
type Wrong = Box<(Origin, Mistake)>;

/// Range of the roughness alpha.
const ALPHA: std::ops::RangeInclusive<f64> = 0.001..=1.0;

/// Returns the roughness of a layer and the distribution of its slopes, or what is wrong and where; `at` is the
/// place of the layer.
pub(super) fn slopes(rough: &Rough, at: Origin) -> Result<(f64, Distribution), Wrong> {
    let distribution = distribution(rough, at)?;
    let (alpha, from) = match (&rough.alpha.value, &rough.slope_mean.value, &rough.slope_rms.value) {
        (Some(alpha), None, None) => return Ok((alpha.0, distribution)),
        (None, Some(mean), None) => (mean.0 / distribution.mean_slope(1.0), rough.slope_mean.origin),
        (None, None, Some(rms)) => {
            let Some(of_one) = distribution.slope_rms(1.0) else {
                let wrong = Diagnostic::new("these slopes have no root mean square")
                    .expected("`slope_mean` or `alpha`, a `tail` above 2, or distribution = \"beckmann\"")
                    .hint("the tail of this distribution makes the mean square infinite; a profilometer gives one because it smooths");
                return Err(Box::new((rough.slope_rms.origin, wrong.into())));
            };
            (rms.0 / of_one, rough.slope_rms.origin)
        }
        (None, None, None) => {
            let expected = "a roughness from 0.001 to 1, or instead of it `slope_mean` or `slope_rms`";
            return Err(Box::new((at, mistake::missing_key("alpha", expected))));
        }
        _ => {
            let at = at.or_override([rough.slope_mean.origin, rough.slope_rms.origin]);
            return Err(Box::new((
                at,
                mistake::exactly_one("`alpha`, `slope_mean` and `slope_rms`", 2).into(),
            )));
        }
    };
    if !ALPHA.contains(&alpha) {
        let wrong = Diagnostic::new(format!("this slope is a roughness alpha of {alpha:.2e}"));
        return Err(Box::new((from, wrong.expected("a slope for which alpha is from 0.001 to 1").into())));
    }
    Ok((alpha, distribution))
}

fn distribution(rough: &Rough, at: Origin) -> Result<Distribution, Wrong> {
    let (tail, kurtosis) = (&rough.tail, &rough.slope_kurtosis);
    match (rough.distribution.value, &tail.value, &kurtosis.value) {
        (Slopes::StudentT, Some(tail), None) => Ok(Distribution::StudentT { tail: tail.0 }),
        (Slopes::StudentT, None, Some(kurtosis)) => {
            Ok(Distribution::StudentT { tail: Distribution::tail_from_kurtosis(kurtosis.0) })
        }
        (Slopes::StudentT, None, None) => {
            let expected = "the weight of the tail, from 2 (as \"ggx\") to 100 (almost \"beckmann\"), or `slope_kurtosis`";
            Err(Box::new((at, mistake::missing_key("tail", expected))))
        }
        (Slopes::StudentT, Some(_), Some(_)) => {
            let at = at.or_override([tail.origin, kurtosis.origin]);
            Err(Box::new((at, mistake::exactly_one("`tail` and `slope_kurtosis`", 2).into())))
        }
        (Slopes::Ggx | Slopes::Beckmann, Some(_), _) => Err(Box::new((tail.origin, needs_student("tail")))),
        (Slopes::Ggx | Slopes::Beckmann, None, Some(_)) => {
            Err(Box::new((kurtosis.origin, needs_student("slope_kurtosis"))))
        }
        (Slopes::Ggx, None, None) => Ok(Distribution::Ggx),
        (Slopes::Beckmann, None, None) => Ok(Distribution::Beckmann),
    }
}

/// A key of a distribution that the layer does not have.
fn needs_student(key: &str) -> Mistake {
    let wrong = Diagnostic::new(format!("`{key}` describes slopes by Student's t-distribution"));
    wrong.expected("distribution = \"student-t\"").hint(format!("add it, or remove `{key}`")).into()
}
