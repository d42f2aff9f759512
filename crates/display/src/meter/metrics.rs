//! Scalar metrics of a view: those of one state, and those that combine the states.
//!
//! Colorimetry follows CIE 15:2018 by `papilio_colour`. X, Y, Z are relative to Y of the
//! perfect white in the same light. Contrast is Feng 2012, eq. 5-10, gamut eq. 5-9.

use papilio_colour::{
    CORNERS, Corners, GamutReference, Lab, UvPrime, Viewing, Xyz, coverage_percent, gamut_percent,
};

use crate::readability::{Reader, Text};
use crate::result::{Cam16, StateMetrics, ViewMetrics};
use crate::scene::{Appearance, Metrics, Standard};

/// Scalar metrics of one state; `None` if one is not defined.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Scalars {
    pub(crate) xyz: [Option<f64>; 3],
    pub(crate) chromaticity: [Option<f64>; 3],
    pub(crate) uv_prime: [Option<f64>; 2],
    pub(crate) lab: [Option<f64>; 3],
    pub(crate) luminance: Option<f64>,
    pub(crate) contrast: Option<f64>,
    pub(crate) peak_nm: Option<f64>,
    pub(crate) from_white: Option<f64>,
    pub(crate) from_d65: Option<f64>,
    pub(crate) hue_rgb: [Option<f64>; 3],
    pub(crate) metrics: StateMetrics,
    pub(crate) cam16: Option<Cam16>,
}

/// Scalar metrics of a view: those of each state, and those that combine the states.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ViewScalars {
    pub(crate) states: Vec<Scalars>,
    pub(crate) together: ViewMetrics,
}

/// Names of the states that span the gamut in the chromaticity diagram.
pub(crate) const PRIMARIES: [&str; 3] = ["red", "green", "blue"];

/// References of the metrics: the white, and the names of the states.
pub(crate) struct Reference<'a> {
    pub(crate) names: &'a [String],
    /// White of the light, relative like X, Y and Z, and its luminance, cd/m2: that of a perfect white, or of
    /// the display's white state if the front light is the only light; `None` if it is not defined.
    pub(crate) white: Option<(Xyz, f64)>,
    /// White of L*, a*, b*, u*, v*, the colour differences and the gamut volume: that of the light, or the
    /// display's white state (`metrics.white = "display"`); `None` if it is not defined.
    pub(crate) lab_white: Option<Xyz>,
    pub(crate) settings: &'a Metrics,
    pub(crate) reader: Reader,
}

/// Observed colour quantities of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StateObservation {
    /// Relative tristimulus values.
    pub(crate) xyz: Xyz,
    pub(crate) luminance_cd_m2: f64,
    pub(crate) peak_nm: Option<f64>,
    /// Peak wavelength of the pixel alone, nm.
    pub(crate) bare_peak_nm: Option<f64>,
}

/// Colours with which the states of a view are compared.
struct ColourReferences {
    black: Option<f64>,
    /// The white of the light, for u'v' distances.
    light: Option<UvPrime>,
    white: Colour,
    state: Option<Colour>,
    viewing: Option<Viewing>,
}

/// Colour coordinates for comparisons; `None` if the light has no white or the state reflects no light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Colour {
    pub(crate) uv: Option<UvPrime>,
    pub(crate) lab: Option<Lab>,
}

impl Colour {
    pub(crate) fn new(xyz: Xyz, white: Option<Xyz>) -> Self {
        Self { uv: xyz.uv_prime(), lab: white.and_then(|white| xyz.lab(white)) }
    }

    pub(crate) fn of(state: &Scalars) -> Self {
        let ([u, v], [l, a, b]) = (state.uv_prime, state.lab);
        let lab = l.zip(a).zip(b).map(|((l, a), b)| Lab { l, a, b });
        Self { uv: u.zip(v).map(|(u, v)| UvPrime { u, v }), lab }
    }

    /// Computes the u'v' distance and the CIEDE2000 difference.
    pub(crate) fn differences(&self, other: &Self) -> [Option<f64>; 2] {
        let uv = self.uv.zip(other.uv).map(|(one, other)| one.distance(other));
        let lab = self.lab.zip(other.lab).map(|(one, other)| one.delta_e_2000(other));
        [uv, lab]
    }
}

impl Reference<'_> {
    /// Computes all metrics except those that compare views.
    pub(crate) fn view(&self, observations: &[StateObservation]) -> ViewScalars {
        let xyz: Vec<Xyz> = observations.iter().map(|observation| observation.xyz).collect();
        let white = self.lab_white;
        let colours: Vec<Colour> = xyz.iter().map(|xyz| Colour::new(*xyz, white)).collect();
        let references = ColourReferences {
            black: self.at("black").map(|black| xyz[black].y),
            light: self.white.and_then(|(white, _)| white.uv_prime()),
            white: white.map_or(Colour { uv: None, lab: None }, |xyz| Colour::new(xyz, white)),
            state: self.at(&self.settings.reference_state).map(|state| colours[state]),
            viewing: self.viewing(),
        };
        let states = observations
            .iter()
            .zip(&colours)
            .map(|(observation, colour)| self.state(observation, colour, &references));
        let states: Vec<Scalars> = states.collect();
        let mut together = self.together(&xyz);
        let shift = |name| states[self.at(name)?].metrics.peak_shift_nm;
        together.average_peak_shift_nm = three(PRIMARIES.map(shift)).map(|[r, g, b]| (r + g + b) / 3.0);
        let luminance = |name| Some(observations[self.at(name)?].luminance_cd_m2);
        if let Some((white, black)) = luminance("white").zip(luminance("black")) {
            self.readability(white, black, &mut together);
        }
        if self.settings.gamut_volume {
            together.gamut_volume_cielab = self.volume(&xyz);
        }
        ViewScalars { states, together }
    }

    /// Computes the readability of black text on white from the luminances, cd/m2.
    fn readability(&self, white: f64, black: f64, together: &mut ViewMetrics) {
        let Some(text) = Text::new(white, black) else { return };
        together.text_luminance_cd_m2 = Some(text.luminance_cd_m2);
        together.text_contrast = Some(text.contrast);
        together.reading_surrogate_age_20 = text.reading_surrogate(20.0);
        together.reading_surrogate_age_50 = text.reading_surrogate(50.0);
        together.reading_surrogate_age_75 = text.reading_surrogate(75.0);
        together.reading_surrogate =
            self.settings.reader_age_years.and_then(|age_years| text.reading_surrogate(age_years));
        together.visibility_level = self.reader.visibility_level(white, black);
        together.contrast_margin = self.reader.contrast_margin(white, black);
    }

    /// Computes contrast and gamut, which combine the states.
    pub(crate) fn together(&self, xyz: &[Xyz]) -> ViewMetrics {
        let colour = |name| self.at(name).map(|state| xyz[state]);
        let black = colour("black").map(|black| black.y);
        // The primaries of the standards are defined for the observer of 1931.
        let diagram = self.settings.observer == Standard::Cie1931;
        let primary = |name| colour(name).filter(|_| diagram);
        let uv = three(PRIMARIES.map(|name| primary(name).and_then(Xyz::uv_prime)));
        let xy = three(PRIMARIES.map(|name| primary(name).and_then(Xyz::chromaticity)));
        let gamut = |reference| uv.map(|uv| gamut_percent(uv, reference));
        let coverage = |reference| uv.map(|uv| coverage_percent(uv, reference));
        let gamut_xy = |reference| xy.map(|xy| gamut_percent(xy, reference));
        let coverage_xy = |reference| xy.map(|xy| coverage_percent(xy, reference));
        ViewMetrics {
            contrast_ratio: colour("white").and_then(|white| ratio(white.y, black)),
            gamut_percent_srgb: gamut(GamutReference::Srgb),
            gamut_percent_ebu: gamut(GamutReference::Ebu),
            gamut_percent_ntsc: gamut(GamutReference::Ntsc),
            gamut_percent_dci_p3: gamut(GamutReference::DciP3),
            coverage_percent_srgb: coverage(GamutReference::Srgb),
            coverage_percent_ebu: coverage(GamutReference::Ebu),
            coverage_percent_ntsc: coverage(GamutReference::Ntsc),
            coverage_percent_dci_p3: coverage(GamutReference::DciP3),
            gamut_percent_srgb_xy: gamut_xy(GamutReference::Srgb),
            gamut_percent_ebu_xy: gamut_xy(GamutReference::Ebu),
            gamut_percent_ntsc_xy: gamut_xy(GamutReference::Ntsc),
            gamut_percent_dci_p3_xy: gamut_xy(GamutReference::DciP3),
            coverage_percent_srgb_xy: coverage_xy(GamutReference::Srgb),
            coverage_percent_ebu_xy: coverage_xy(GamutReference::Ebu),
            coverage_percent_ntsc_xy: coverage_xy(GamutReference::Ntsc),
            coverage_percent_dci_p3_xy: coverage_xy(GamutReference::DciP3),
            ..ViewMetrics::default()
        }
    }

    /// Computes the gamut volume; `None` unless all eight corners are states.
    fn volume(&self, xyz: &[Xyz]) -> Option<f64> {
        let white = self.lab_white?;
        let mut corners = [white; 8];
        for (corner, name) in corners.iter_mut().zip(CORNERS) {
            *corner = xyz[self.at(name)?];
        }
        Some(Corners { xyz: corners }.solid(white)?.volume())
    }

    /// Returns the index of a state.
    fn at(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    fn viewing(&self) -> Option<Viewing> {
        let Appearance { adapting_luminance_cd_m2, background, surround } = self.settings.appearance?;
        let background_luminance = background * self.white?.1;
        let adapting_luminance_cd_m2 = adapting_luminance_cd_m2.unwrap_or(background_luminance);
        Some(Viewing { adapting_luminance_cd_m2, background, surround })
    }

    fn state(
        &self,
        observation: &StateObservation,
        colour: &Colour,
        references: &ColourReferences,
    ) -> Scalars {
        let (xyz, Colour { uv, lab }) = (observation.xyz, *colour);
        let xy = xyz.chromaticity();
        let hue = xyz.hue_rgb().filter(|_| self.settings.observer == Standard::Cie1931);
        let from_white = uv.zip(references.light).map(|(uv, light)| uv.distance(light));
        let [_, delta_e] = colour.differences(&references.white);
        let luv = lab.zip(uv.zip(references.white.uv)).map(|(lab, (uv, white))| lab.luv(uv, white));
        let [from_reference, delta_e_reference] =
            references.state.map_or([None; 2], |state| colour.differences(&state));
        Scalars {
            xyz: xyz.to_array().map(Some),
            chromaticity: [xy.map(|c| c.x), xy.map(|c| c.y), xy.map(|c| 1.0 - c.x - c.y)],
            uv_prime: [uv.map(|c| c.u), uv.map(|c| c.v)],
            lab: [lab.map(|c| c.l), lab.map(|c| c.a), lab.map(|c| c.b)],
            luminance: Some(observation.luminance_cd_m2),
            contrast: ratio(xyz.y, references.black),
            peak_nm: observation.peak_nm,
            from_white,
            from_d65: uv.map(|uv| uv.distance(self.settings.observer.d65_uv())),
            hue_rgb: std::array::from_fn(|k| hue.map(|rgb| rgb[k])),
            metrics: StateMetrics {
                u_star: luv.map(|c| c.u),
                v_star: luv.map(|c| c.v),
                delta_E_2000_from_white: delta_e,
                delta_E_2000_from_reference: delta_e_reference,
                distance_from_reference_uv: from_reference,
                peak_shift_nm: observation
                    .peak_nm
                    .zip(observation.bare_peak_nm)
                    .map(|(peak, bare)| peak - bare),
                ..StateMetrics::default()
            },
            cam16: references
                .viewing
                .zip(self.white)
                .map(|(viewing, (white, _))| cam16(xyz.appearance(white, &viewing))),
        }
    }
}

fn cam16(looks: Option<papilio_colour::Appearance>) -> Cam16 {
    let uniform = |k: usize| looks.map(|looks| looks.uniform[k]);
    Cam16 {
        J: looks.map(|looks| looks.lightness),
        C: looks.map(|looks| looks.chroma),
        J_prime: uniform(0),
        a_prime: uniform(1),
        b_prime: uniform(2),
    }
}

/// Returns all three values, or `None` if one is missing.
pub(crate) fn three<T>([a, b, c]: [Option<T>; 3]) -> Option<[T; 3]> {
    Some([a?, b?, c?])
}

/// Ratio of Y to that of black; `None` unless black reflects light.
fn ratio(y: f64, black: Option<f64>) -> Option<f64> {
    black.filter(|black| *black > 0.0).map(|black| y / black)
}

impl Scalars {
    fn all_mut(&mut self) -> impl Iterator<Item = &mut Option<f64>> {
        let Self { xyz, chromaticity, uv_prime, lab, luminance, contrast, peak_nm, .. } = self;
        let Self { from_white, from_d65, hue_rgb, metrics, cam16, .. } = self;
        let arrays = [&mut xyz[..], chromaticity, uv_prime, lab, hue_rgb].into_iter().flatten();
        let numbers = [luminance, contrast, peak_nm, from_white, from_d65].into_iter();
        arrays.chain(numbers).chain(metrics.all_mut()).chain(cam16.iter_mut().flat_map(Cam16::all_mut))
    }
}

impl ViewScalars {
    fn all_mut(&mut self) -> impl Iterator<Item = &mut Option<f64>> {
        self.states.iter_mut().flat_map(Scalars::all_mut).chain(self.together.all_mut())
    }

    /// Returns the colours of the states.
    pub(crate) fn colours(&self) -> Vec<Colour> {
        self.states.iter().map(Colour::of).collect()
    }

    /// Combines the metrics of two views; `None` if one of the two is not defined.
    pub(crate) fn combine(one: &Self, other: &Self, with: impl Fn(f64, f64) -> f64) -> Self {
        let (mut combined, mut other) = (one.clone(), other.clone());
        for (slot, other) in combined.all_mut().zip(other.all_mut()) {
            *slot = slot.zip(*other).map(|(a, b)| with(a, b));
        }
        combined
    }

    /// Returns the sum of the magnitudes of these changes of each metric, times a factor.
    pub(crate) fn sum_of_changes(&self, changed: &[Self], factor: f64) -> Self {
        let mut sum = self.zeros();
        for changed in changed {
            let change = Self::combine(self, changed, |own, changed| factor * (changed - own).abs());
            sum = Self::combine(&sum, &change, |sum, change| sum + change);
        }
        sum
    }

    /// Raises each metric to that of another view, if both are defined.
    pub(crate) fn raise_to(&mut self, least: &Self) {
        let mut least = least.clone();
        for (slot, least) in self.all_mut().zip(least.all_mut()) {
            *slot = slot.map(|value| least.map_or(value, |least| value.max(least)));
        }
    }

    /// Returns 0 for each defined metric.
    pub(crate) fn zeros(&self) -> Self {
        Self::combine(self, self, |_, _| 0.0)
    }

    /// Computes jackknife standard errors from the metrics with each replicate left out in turn.
    pub(crate) fn jackknife(left_out: &[Self]) -> Self {
        let mut errors = left_out[0].clone();
        let mut all = left_out.to_vec();
        let mut rows: Vec<_> = all.iter_mut().map(Self::all_mut).collect();
        for error in errors.all_mut() {
            // Every row must advance by one, even if a value is not defined.
            let column: Vec<Option<f64>> = rows.iter_mut().map(|row| *row.next()?).collect();
            *error = jackknife(&mut column.into_iter());
        }
        errors
    }
}

/// Computes the jackknife standard error `sqrt((n-1)/n sum (x_i - mean)^2)` of leave-one-out values; `None`
/// if one is not defined.
pub(crate) fn jackknife(values: &mut dyn Iterator<Item = Option<f64>>) -> Option<f64> {
    let values: Vec<f64> = values.collect::<Option<_>>()?;
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Some(((n - 1.0) / n * squares).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jackknife_of_a_mean_equals_the_usual_standard_error() {
        let x = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];
        let total: f64 = x.iter().sum();
        let error = jackknife(&mut x.iter().map(|one| Some((total - one) / 7.0))).unwrap();
        let (_, textbook) = crate::meter::sample::spread(x.into_iter());
        assert!((error - textbook).abs() < 1e-14);
        assert_eq!(jackknife(&mut [Some(1.0), None].into_iter()), None);
    }

    /// A metric that is not defined in one replicate has no error, and the errors of the metrics after it are
    /// correct.
    #[test]
    fn undefined_metric_does_not_affect_the_errors_of_others() {
        let view = |contrast: Option<f64>, gamut: f64| ViewScalars {
            states: vec![Scalars { peak_nm: contrast, luminance: Some(gamut), ..Scalars::default() }],
            together: ViewMetrics {
                contrast_ratio: contrast,
                gamut_percent_ebu: Some(gamut),
                ..ViewMetrics::default()
            },
        };
        let errors = ViewScalars::jackknife(&[view(None, 1.0), view(Some(2.0), 2.0), view(Some(3.0), 3.0)]);
        let expected = jackknife(&mut [1.0, 2.0, 3.0].into_iter().map(Some));
        assert_eq!((errors.together.contrast_ratio, errors.together.gamut_percent_ebu), (None, expected));
        assert_eq!((errors.states[0].peak_nm, errors.states[0].luminance), (None, expected));
    }

    #[test]
    fn metrics_of_missing_states_are_undefined() {
        let white = Xyz { x: 0.95, y: 1.0, z: 1.09 };
        let names = ["white".to_owned(), "orange".to_owned()];
        let settings = Metrics { gamut_volume: true, ..Metrics::default() };
        let reader = Reader { age_years: 25.0, text_height_mm: 1.6, distance_mm: 500.0 };
        let reference = Reference {
            names: &names,
            white: Some((white, 100.0)),
            lab_white: Some(white),
            settings: &settings,
            reader,
        };
        let observed = |xyz: Xyz| StateObservation {
            xyz,
            luminance_cd_m2: 100.0 * xyz.y,
            peak_nm: Some(600.0),
            bare_peak_nm: None,
        };
        let view = reference.view(&[white, Xyz { x: 0.2, y: 0.1, z: 0.05 }].map(observed));
        assert_eq!((view.together.contrast_ratio, view.together.gamut_percent_srgb), (None, None));
        assert_eq!(view.states[1].contrast, None);
        assert!(view.states[0].from_white.unwrap() < 1e-15);
        assert!(view.states[1].from_white.unwrap() > 0.05);
        assert_eq!(view.states[1].luminance, Some(10.0));
        assert_eq!((view.together.text_contrast, view.together.gamut_volume_cielab), (None, None));
        assert_eq!(view.states[1].metrics.peak_shift_nm, None);
        assert_eq!(view.states[0].metrics.delta_E_2000_from_reference, Some(0.0));
        assert!(view.states[1].metrics.delta_E_2000_from_white.unwrap() > 50.0);
    }
}
