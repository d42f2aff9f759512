//! Metrics of what is seen: numbers of one state, and of the states together.
//!
//! Colorimetry is CIE 15:2018 through `papilio_colour`. X, Y, Z are over the Y of the
//! perfect white in the same light. Contrast is Feng 2012, eq. 5-10, gamut eq. 5-9.

use papilio_colour::{
    CORNERS, Corners, GamutReference, Lab, UvPrime, Viewing, Xyz, coverage_percent, gamut_percent,
};

use crate::readability::Text;
use crate::result::{Cam16, StateMetrics, ViewMetrics};
use crate::scene::{Appearance, Metrics, Standard};

/// The scalar numbers of one state; `None` where one is not defined.
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

/// The numbers of a view: those of its states, and of the states together.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ViewScalars {
    pub(crate) states: Vec<Scalars>,
    pub(crate) together: ViewMetrics,
}

/// The states that span a gamut in the diagram.
pub(crate) const PRIMARIES: [&str; 3] = ["red", "green", "blue"];

/// What metrics are measured against.
pub(crate) struct Reference<'a> {
    pub(crate) names: &'a [String],
    /// The white, relative as X, Y and Z are, and its luminance in cd/m2; `None` where there is none.
    pub(crate) white: Option<(Xyz, f64)>,
    pub(crate) asked: &'a Metrics,
}

/// What is seen of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StateObservation {
    /// Relative.
    pub(crate) xyz: Xyz,
    pub(crate) luminance_cd_m2: f64,
    pub(crate) peak_nm: Option<f64>,
    /// Where the pixel alone peaks.
    pub(crate) bare_peak_nm: Option<f64>,
}

/// What the states of a view are compared with.
struct ColourReferences {
    black: Option<f64>,
    white: Colour,
    state: Option<Colour>,
    viewing: Option<Viewing>,
}

/// A colour as it is compared with others; `None` where the light has no white or nothing is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Colour {
    pub(crate) uv: Option<UvPrime>,
    pub(crate) lab: Option<Lab>,
}

impl Colour {
    fn new(xyz: Xyz, white: Option<Xyz>) -> Self {
        Self { uv: xyz.uv_prime(), lab: white.and_then(|white| xyz.lab(white)) }
    }

    pub(crate) fn of(state: &Scalars) -> Self {
        let ([u, v], [l, a, b]) = (state.uv_prime, state.lab);
        let lab = l.zip(a).zip(b).map(|((l, a), b)| Lab { l, a, b });
        Self { uv: u.zip(v).map(|(u, v)| UvPrime { u, v }), lab }
    }

    /// u'v' distance and CIEDE2000 difference.
    pub(crate) fn differences(&self, other: &Self) -> [Option<f64>; 2] {
        let uv = self.uv.zip(other.uv).map(|(one, other)| one.distance(other));
        let lab = self.lab.zip(other.lab).map(|(one, other)| one.delta_e_2000(other));
        [uv, lab]
    }
}

impl Reference<'_> {
    /// All metrics but those that compare views.
    pub(crate) fn view(&self, observations: &[StateObservation]) -> ViewScalars {
        let xyz: Vec<Xyz> = observations.iter().map(|observation| observation.xyz).collect();
        let white = self.white.map(|(xyz, _)| xyz);
        let colours: Vec<Colour> = xyz.iter().map(|xyz| Colour::new(*xyz, white)).collect();
        let references = ColourReferences {
            black: self.at("black").map(|black| xyz[black].y),
            white: white.map_or(Colour { uv: None, lab: None }, |xyz| Colour::new(xyz, white)),
            state: self.at(&self.asked.reference_state).map(|state| colours[state]),
            viewing: self.viewing(),
        };
        let states = observations.iter().zip(&colours).map(|(observation, seen)| self.state(observation, seen, &references));
        let states: Vec<Scalars> = states.collect();
        let mut together = self.together(&xyz);
        let shift = |name| states[self.at(name)?].metrics.peak_shift_nm;
        together.average_peak_shift_nm = three(PRIMARIES.map(shift)).map(|[r, g, b]| (r + g + b) / 3.0);
        let luminance = |name| Some(observations[self.at(name)?].luminance_cd_m2);
        let text = luminance("white").zip(luminance("black")).and_then(|(w, k)| Text::new(w, k));
        if let Some(text) = text {
            together.text_luminance_cd_m2 = Some(text.luminance_cd_m2);
            together.text_contrast = Some(text.contrast);
            together.reading_surrogate_age_20 = text.reading_surrogate(20.0);
            together.reading_surrogate_age_50 = text.reading_surrogate(50.0);
            together.reading_surrogate_age_75 = text.reading_surrogate(75.0);
            together.reading_surrogate =
                self.asked.reader_age_years.and_then(|age_years| text.reading_surrogate(age_years));
        }
        if self.asked.gamut_volume {
            together.gamut_volume_cielab = self.volume(&xyz);
        }
        ViewScalars { states, together }
    }

    /// Contrast and gamut of the states together.
    pub(crate) fn together(&self, xyz: &[Xyz]) -> ViewMetrics {
        let seen = |name| self.at(name).map(|state| xyz[state]);
        let black = seen("black").map(|black| black.y);
        // The standards' primaries are those of the observer of 1931.
        let diagram = self.asked.observer == Standard::Cie1931;
        let uv = |name| seen(name).filter(|_| diagram).and_then(Xyz::uv_prime);
        let primaries = three(PRIMARIES.map(uv));
        let gamut = |reference| primaries.map(|primaries| gamut_percent(primaries, reference));
        let coverage = |reference| primaries.map(|primaries| coverage_percent(primaries, reference));
        ViewMetrics {
            contrast_ratio: seen("white").and_then(|white| ratio(white.y, black)),
            gamut_percent_srgb: gamut(GamutReference::Srgb),
            gamut_percent_ebu: gamut(GamutReference::Ebu),
            gamut_percent_ntsc: gamut(GamutReference::Ntsc),
            gamut_percent_dci_p3: gamut(GamutReference::DciP3),
            coverage_percent_srgb: coverage(GamutReference::Srgb),
            coverage_percent_ebu: coverage(GamutReference::Ebu),
            coverage_percent_ntsc: coverage(GamutReference::Ntsc),
            coverage_percent_dci_p3: coverage(GamutReference::DciP3),
            ..ViewMetrics::default()
        }
    }

    /// Volume of the gamut, if all its corners are there.
    fn volume(&self, xyz: &[Xyz]) -> Option<f64> {
        let (white, _) = self.white?;
        let mut corners = [white; 8];
        for (corner, name) in corners.iter_mut().zip(CORNERS) {
            *corner = xyz[self.at(name)?];
        }
        Some(Corners { xyz: corners }.solid(white)?.volume())
    }

    /// Where a state stands.
    fn at(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    fn viewing(&self) -> Option<Viewing> {
        let Appearance { adapting_luminance_cd_m2, background, surround } = self.asked.appearance?;
        let of_background = background * self.white?.1;
        let adapting_luminance_cd_m2 = adapting_luminance_cd_m2.unwrap_or(of_background);
        Some(Viewing { adapting_luminance_cd_m2, background, surround })
    }

    fn state(&self, observation: &StateObservation, seen: &Colour, references: &ColourReferences) -> Scalars {
        let (xyz, Colour { uv, lab }) = (observation.xyz, *seen);
        let xy = xyz.chromaticity();
        let hue = xyz.hue_rgb().filter(|_| self.asked.observer == Standard::Cie1931);
        let [from_white, delta_e] = seen.differences(&references.white);
        let luv = lab.zip(uv.zip(references.white.uv)).map(|(lab, (uv, white))| lab.luv(uv, white));
        let [from_reference, delta_e_reference] =
            references.state.map_or([None; 2], |state| seen.differences(&state));
        Scalars {
            xyz: xyz.to_array().map(Some),
            chromaticity: [xy.map(|c| c.x), xy.map(|c| c.y), xy.map(|c| 1.0 - c.x - c.y)],
            uv_prime: [uv.map(|c| c.u), uv.map(|c| c.v)],
            lab: [lab.map(|c| c.l), lab.map(|c| c.a), lab.map(|c| c.b)],
            luminance: Some(observation.luminance_cd_m2),
            contrast: ratio(xyz.y, references.black),
            peak_nm: observation.peak_nm,
            from_white,
            from_d65: uv.map(|uv| uv.distance(self.asked.observer.d65_uv())),
            hue_rgb: std::array::from_fn(|k| hue.map(|rgb| rgb[k])),
            metrics: StateMetrics {
                u_star: luv.map(|c| c.u),
                v_star: luv.map(|c| c.v),
                delta_E_2000_from_white: delta_e,
                delta_E_2000_from_reference: delta_e_reference,
                distance_from_reference_uv: from_reference,
                peak_shift_nm: observation.peak_nm.zip(observation.bare_peak_nm).map(|(peak, bare)| peak - bare),
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

/// All three, or none.
pub(crate) fn three<T>([a, b, c]: [Option<T>; 3]) -> Option<[T; 3]> {
    Some([a?, b?, c?])
}

/// Y over that of black, where black reflects anything.
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

    /// The colours of the states.
    pub(crate) fn colours(&self) -> Vec<Colour> {
        self.states.iter().map(Colour::of).collect()
    }

    /// Each number with the other's; `None` where one of the two is missing.
    pub(crate) fn combine(one: &Self, other: &Self, with: impl Fn(f64, f64) -> f64) -> Self {
        let (mut combined, mut other) = (one.clone(), other.clone());
        for (slot, other) in combined.all_mut().zip(other.all_mut()) {
            *slot = slot.zip(*other).map(|(a, b)| with(a, b));
        }
        combined
    }

    /// 0 wherever there is a number.
    pub(crate) fn zeros(&self) -> Self {
        Self::combine(self, self, |_, _| 0.0)
    }

    /// Jackknife standard errors from the metrics with each replicate left out in turn.
    pub(crate) fn jackknife(left_out: &[Self]) -> Self {
        let mut errors = left_out[0].clone();
        let mut all = left_out.to_vec();
        let mut rows: Vec<_> = all.iter_mut().map(Self::all_mut).collect();
        for error in errors.all_mut() {
            // Every row goes on by one, whatever is found in it.
            let column: Vec<Option<f64>> = rows.iter_mut().map(|row| *row.next()?).collect();
            *error = jackknife(&mut column.into_iter());
        }
        errors
    }
}

/// `sqrt((n-1)/n sum (x_i - mean)^2)` of leave-one-out values; `None` if any is missing.
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

    /// A number that one replicate lacks has no error, and the numbers after it have theirs.
    #[test]
    fn a_missing_number_moves_no_other() {
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
    fn metrics_of_missing_states_are_missing() {
        let white = Xyz { x: 0.95, y: 1.0, z: 1.09 };
        let names = ["white".to_owned(), "orange".to_owned()];
        let asked = Metrics { gamut_volume: true, ..Metrics::default() };
        let reference = Reference { names: &names, white: Some((white, 100.0)), asked: &asked };
        let seen = |xyz: Xyz| StateObservation {
            xyz,
            luminance_cd_m2: 100.0 * xyz.y,
            peak_nm: Some(600.0),
            bare_peak_nm: None,
        };
        let view = reference.view(&[white, Xyz { x: 0.2, y: 0.1, z: 0.05 }].map(seen));
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
