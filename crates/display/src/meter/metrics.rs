//! Metrics of what is seen: numbers of one state, and of the states together.
//!
//! Colorimetry is CIE 15:2018 through `papilio_colour`. X, Y, Z are over the Y of the
//! perfect white in the same light. Contrast is Feng 2012, eq. 5-10, gamut eq. 5-9.

use papilio_colour::{D65_UV, GamutReference, UvPrime, Xyz, gamut_percent, peak_nm};
use papilio_spectra::Grid;

/// The scalar numbers of one state; `None` where one is not defined.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Scalars<T = Option<f64>> {
    pub(crate) xyz: [T; 3],
    pub(crate) chromaticity: [T; 3],
    pub(crate) uv_prime: [T; 2],
    pub(crate) lab: [T; 3],
    pub(crate) luminance: T,
    pub(crate) contrast: T,
    pub(crate) peak_nm: T,
    pub(crate) from_white: T,
    pub(crate) from_d65: T,
    pub(crate) hue_rgb: [T; 3],
}

/// The numbers of a view: those of its states, and of the states together.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ViewScalars {
    pub(crate) states: Vec<Scalars>,
    pub(crate) together: Together,
}

/// The numbers of the states together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Together {
    pub(crate) contrast_ratio: Option<f64>,
    pub(crate) gamut_srgb: Option<f64>,
    pub(crate) gamut_ebu: Option<f64>,
}

/// What metrics are measured against.
pub(crate) struct Reference<'a> {
    pub(crate) names: &'a [String],
    pub(crate) grid: &'a Grid,
    /// The perfect white: relative (Y = 1), and its luminance in cd/m2.
    pub(crate) white: Xyz,
    pub(crate) white_luminance: f64,
}

impl Reference<'_> {
    /// All metrics, from each state's relative X, Y, Z and its reflectance factor.
    pub(crate) fn view(&self, xyz: &[Xyz], reflectance_factor: &[&[f64]]) -> ViewScalars {
        let white = self.white.uv_prime();
        let black = self.seen("black", xyz).map(|black| black.y);
        let states = xyz.iter().zip(reflectance_factor);
        let states = states.map(|(xyz, factor)| self.state(*xyz, factor, black, white)).collect();
        ViewScalars { states, together: self.together(xyz) }
    }

    /// The metrics of the states together.
    pub(crate) fn together(&self, xyz: &[Xyz]) -> Together {
        let seen = |name| self.seen(name, xyz);
        let uv = |name| seen(name).and_then(Xyz::uv_prime);
        let black = seen("black").map(|black| black.y);
        let primaries = uv("red").zip(uv("green")).zip(uv("blue")).map(|((r, g), b)| [r, g, b]);
        let gamut = |reference| primaries.map(|primaries| gamut_percent(primaries, reference));
        Together {
            contrast_ratio: seen("white").and_then(|white| ratio(white.y, black)),
            gamut_srgb: gamut(GamutReference::Srgb),
            gamut_ebu: gamut(GamutReference::Ebu),
        }
    }

    fn seen(&self, name: &str, xyz: &[Xyz]) -> Option<Xyz> {
        self.names.iter().position(|n| n == name).map(|state| xyz[state])
    }

    fn state(&self, xyz: Xyz, factor: &[f64], black: Option<f64>, white: Option<UvPrime>) -> Scalars {
        let (xy, uv, lab) = (xyz.chromaticity(), xyz.uv_prime(), xyz.lab(self.white));
        Scalars {
            xyz: xyz.to_array().map(Some),
            chromaticity: [xy.map(|c| c.x), xy.map(|c| c.y), xy.map(|c| 1.0 - c.x - c.y)],
            uv_prime: [uv.map(|c| c.u), uv.map(|c| c.v)],
            lab: [lab.map(|c| c.l), lab.map(|c| c.a), lab.map(|c| c.b)],
            luminance: Some(xyz.y * self.white_luminance),
            contrast: ratio(xyz.y, black),
            peak_nm: peak_nm(self.grid, factor),
            from_white: uv.zip(white).map(|(uv, white)| uv.distance(white)),
            from_d65: uv.map(|uv| uv.distance(D65_UV)),
            hue_rgb: std::array::from_fn(|k| xyz.hue_rgb().map(|rgb| rgb[k])),
        }
    }
}

/// Y over that of black, where black reflects anything.
fn ratio(y: f64, black: Option<f64>) -> Option<f64> {
    black.filter(|black| *black > 0.0).map(|black| y / black)
}

impl Scalars {
    /// Combines the same number of several sets, each by itself.
    fn reduce(all: &[Self], combine: &impl Fn(&mut dyn Iterator<Item = Option<f64>>) -> Option<f64>) -> Self {
        let one = |get: &dyn Fn(&Self) -> Option<f64>| combine(&mut all.iter().map(get));
        let triple = |get: &dyn Fn(&Self) -> [Option<f64>; 3]| std::array::from_fn(|k| one(&|s| get(s)[k]));
        let pair = |get: &dyn Fn(&Self) -> [Option<f64>; 2]| std::array::from_fn(|k| one(&|s| get(s)[k]));
        Self {
            xyz: triple(&|s| s.xyz),
            chromaticity: triple(&|s| s.chromaticity),
            uv_prime: pair(&|s| s.uv_prime),
            lab: triple(&|s| s.lab),
            luminance: one(&|s| s.luminance),
            contrast: one(&|s| s.contrast),
            peak_nm: one(&|s| s.peak_nm),
            from_white: one(&|s| s.from_white),
            from_d65: one(&|s| s.from_d65),
            hue_rgb: triple(&|s| s.hue_rgb),
        }
    }
}

impl ViewScalars {
    /// Each number with the other's; `None` where one of the two is missing.
    pub(crate) fn combine(one: &Self, other: &Self, with: impl Fn(f64, f64) -> f64) -> Self {
        let both = [one.clone(), other.clone()];
        Self::reduce(&both, &|values| match [values.next(), values.next()] {
            [Some(Some(a)), Some(Some(b))] => Some(with(a, b)),
            _ => None,
        })
    }

    /// 0 wherever there is a number.
    pub(crate) fn zeros(&self) -> Self {
        Self::reduce(std::slice::from_ref(self), &|values| values.next().flatten().map(|_| 0.0))
    }

    /// Jackknife standard errors from the metrics with each replicate left out in turn.
    pub(crate) fn jackknife(left_out: &[Self]) -> Self {
        Self::reduce(left_out, &|values| jackknife(values))
    }

    /// Combines the same number of several views, each by itself.
    fn reduce(all: &[Self], combine: &impl Fn(&mut dyn Iterator<Item = Option<f64>>) -> Option<f64>) -> Self {
        let states = (0..all[0].states.len()).map(|state| {
            let states: Vec<Scalars> = all.iter().map(|view| view.states[state]).collect();
            Scalars::reduce(&states, combine)
        });
        let together = Together {
            contrast_ratio: combine(&mut all.iter().map(|view| view.together.contrast_ratio)),
            gamut_srgb: combine(&mut all.iter().map(|view| view.together.gamut_srgb)),
            gamut_ebu: combine(&mut all.iter().map(|view| view.together.gamut_ebu)),
        };
        Self { states: states.collect(), together }
    }
}

/// `sqrt((n-1)/n sum (x_i - mean)^2)` of leave-one-out values; `None` if any is missing.
fn jackknife(values: &mut dyn Iterator<Item = Option<f64>>) -> Option<f64> {
    let values: Vec<f64> = values.collect::<Option<_>>()?;
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Some(((n - 1.0) / n * squares).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For a mean, the jackknife is the textbook standard error.
    #[test]
    fn jackknife_of_a_mean() {
        let x = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];
        let total: f64 = x.iter().sum();
        let error = jackknife(&mut x.iter().map(|one| Some((total - one) / 7.0))).unwrap();
        let (_, textbook) = crate::meter::sample::spread(x.into_iter());
        assert!((error - textbook).abs() < 1e-14);
        assert_eq!(jackknife(&mut [Some(1.0), None].into_iter()), None);
    }

    #[test]
    fn metrics_of_missing_states_are_missing() {
        let grid = Grid::new(400.0, 700.0, 100.0).unwrap();
        let white = Xyz { x: 0.95, y: 1.0, z: 1.09 };
        let names = ["white".to_owned(), "orange".to_owned()];
        let reference = Reference { names: &names, grid: &grid, white, white_luminance: 100.0 };
        let view =
            reference.view(&[white, Xyz { x: 0.2, y: 0.1, z: 0.05 }], &[&[0.5; 4], &[0.1, 0.2, 0.3, 0.1]]);
        assert_eq!((view.together.contrast_ratio, view.together.gamut_srgb), (None, None));
        assert_eq!(view.states[1].contrast, None);
        assert!(view.states[0].from_white.unwrap() < 1e-15);
        assert!(view.states[1].from_white.unwrap() > 0.05);
        assert_eq!(view.states[1].luminance, Some(10.0));
    }
}
