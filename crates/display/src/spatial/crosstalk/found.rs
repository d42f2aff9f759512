//! From the light of windows and figures to shares, gamut and contrast, with their errors.

use papilio_colour::{GamutReference, UvPrime, Xyz, gamut_percent};

use super::measure::Figures;
use super::shares::{shares, with_error};
use super::{BLACK, Colour, CrosstalkView, Figure, PatternColours, PatternValues, state};
use crate::meter::{PRIMARIES, STANDARD_ERRORS, jackknife};
use crate::result::Named;
use crate::setup::{Setup, ViewPoint};

/// Light of one level, or of some replicates.
#[derive(Default)]
pub(super) struct Measured {
    pub(super) names: Vec<String>,
    /// Y of the page through each window from each sub-pixel and the inactive area,
    /// `[light][window][sub-pixel]`.
    pub(super) page: Vec<Vec<Vec<f64>>>,
    /// Y that arrives at each sub-pixel through each window of a filter and, last, between them,
    /// `[light][window][sub-pixel]`; empty without filter.
    pub(super) entered: Vec<Vec<Vec<f64>>>,
    /// Colour of each state as a figure on the page, `[figure][state]`; empty without such a figure.
    pub(super) figures: [Vec<Colour>; 4],
    /// Colour of the page beside a black figure.
    pub(super) beside: [Option<Colour>; 4],
    pub(super) from_faces: Colour,
}

/// Light of a level of adding, and the same with other errors.
#[derive(Default)]
pub(super) struct Levelled {
    pub(super) found: Measured,
    /// Of the sums over directions whose mean this light is; their jackknife is [`STANDARD_ERRORS`] of it.
    pub(super) by_sum: Vec<Measured>,
    /// With other chains of light that a front returns.
    pub(super) by_other_chains: Option<Measured>,
}

impl Levelled {
    /// The mean of sums that are the same but for their errors.
    pub(super) fn of_sums(sums: &[Measured]) -> Self {
        let Some((first, more)) = sums.split_first() else { return Self::default() };
        let count = sums.len() as f64;
        let mean = more.iter().enumerate().fold(first.with(first, |own, _| own), |mean, (before, one)| {
            let part = 1.0 / (before + 2) as f64;
            mean.with(one, |mean, one| mean + part * (one - mean))
        });
        // Without one of n, a mean is (mean - one)/(n - 1) away.
        let away = STANDARD_ERRORS / (count - 1.0).max(1.0);
        let of_sum = |one| mean.with(one, |mean, one| mean + away * (mean - one));
        let by_sum = if more.is_empty() { Vec::new() } else { sums.iter().map(of_sum).collect() };
        Self { found: mean, by_sum, by_other_chains: None }
    }

    /// Adds light that a front returns, of chains and of others.
    pub(super) fn with_returned(self, [returned, other]: [&Measured; 2]) -> Self {
        Self {
            by_other_chains: Some(self.found.plus(other)),
            by_sum: self.by_sum.iter().map(|one| one.plus(returned)).collect(),
            found: self.found.plus(returned),
        }
    }
}

impl From<Measured> for Levelled {
    fn from(found: Measured) -> Self {
        Self { found, ..Self::default() }
    }
}

impl Measured {
    /// The same, so many times as far from another level.
    pub(super) fn away(&self, from: &Self, factor: f64) -> Self {
        self.with(from, |own, from| from + factor * (own - from))
    }

    /// A figure of the same states without light.
    pub(super) fn dark(&self, figure: Figure) -> Figures {
        let figure = figure as usize;
        (vec![[0.0; 3]; self.figures[figure].len()], self.beside[figure].map(|_| [0.0; 3]))
    }

    /// The sum with other light.
    pub(super) fn plus(&self, other: &Self) -> Self {
        self.with(other, |own, more| own + more)
    }

    /// A number instead of each pair of its own and of another light's.
    fn with(&self, from: &Self, both: impl Fn(f64, f64) -> f64) -> Self {
        let rows = |own: &[Vec<Vec<f64>>], from: &[Vec<Vec<f64>>]| -> Vec<Vec<Vec<f64>>> {
            let row = |(own, from): (&Vec<f64>, &Vec<f64>)| {
                own.iter().zip(from).map(|(own, from)| both(*own, *from)).collect()
            };
            let rows =
                |(own, from): (&Vec<Vec<f64>>, &Vec<Vec<f64>>)| own.iter().zip(from).map(row).collect();
            own.iter().zip(from).map(rows).collect()
        };
        let colour = |own: Colour, from: Colour| [0, 1, 2].map(|k| both(own[k], from[k]));
        let figure = |k: usize| {
            self.figures[k].iter().zip(&from.figures[k]).map(|(own, from)| colour(*own, *from)).collect()
        };
        Self {
            names: self.names.clone(),
            page: rows(&self.page, &from.page),
            entered: rows(&self.entered, &from.entered),
            figures: [0, 1, 2, 3].map(figure),
            beside: [0, 1, 2, 3].map(|k| Some(colour(self.beside[k]?, from.beside[k]?))),
            from_faces: colour(self.from_faces, from.from_faces),
        }
    }
}

/// What a view sees. The errors are the differences from the other level, if `others` is one, or else those
/// of a jackknife: `others` are then all replicates but one.
pub(super) fn assembled(
    setup: &Setup,
    view: &ViewPoint,
    found: &Measured,
    others: &[&Measured],
) -> CrosstalkView {
    let all = |level: &Measured| shares(&level.page, &level.entered);
    let one = |level: &Measured, light: usize| {
        let entered = level.entered.get(light).map_or(&[][..], std::slice::from_ref);
        shares(&level.page[light..=light], entered)
    };
    let of_light = |(light, name): (usize, &String)| {
        let others: Vec<_> = others.iter().map(|other| one(other, light)).collect();
        (name.clone(), with_error(one(found, light), &others))
    };
    let pattern = |figure: Figure| {
        let values = values(setup, found, figure);
        let others: Vec<Vec<Option<f64>>> =
            others.iter().map(|other| self::values(setup, other, figure).all().to_vec()).collect();
        let errors = errors(&values.all(), &others);
        let why_null = match values.all() {
            _ if found.figures[figure as usize].is_empty() => why_null(figure),
            [None, None, None] => Some(NO_STATES),
            _ => None,
        };
        PatternColours { name: figure, values, error: PatternValues::of(&errors), why_null }
    };
    let of_all: Vec<_> = others.iter().map(|other| all(other)).collect();
    CrosstalkView {
        theta_deg: view.theta_deg,
        phi_deg: view.phi_deg,
        by_light: Named(found.names.iter().enumerate().map(of_light).collect()),
        shares: with_error(all(found), &of_all),
        patterns: Figure::ALL.map(pattern).to_vec(),
    }
}

/// Errors of numbers: differences from the only other, or else those of a jackknife.
pub(super) fn errors(found: &[Option<f64>], others: &[Vec<Option<f64>>]) -> Vec<Option<f64>> {
    let of = |(k, found): (usize, &Option<f64>)| match others {
        [other] => Some(((*found)? - other[k]?).abs()),
        _ => jackknife(&mut others.iter().map(|other| other[k])),
    };
    found.iter().enumerate().map(of).collect()
}

/// Why there are neither contrasts nor a gamut.
const NO_STATES: &str = "contrast is that of the states `white` and `black`, gamut that of `red`, `green` and `blue`: no state has these names \
    (display.pixel.states, or the names in display.pixel.reflectance; with a colour filter display.matrix.states)";

/// Why there is no such figure.
fn why_null(figure: Figure) -> Option<&'static str> {
    let no_strokes = "no pixel is in the middle of a stroke: the text is too small for these pixels, or it has more than a million (viewer.text_height_mm)";
    (figure == Figure::Text).then_some(no_strokes)
}

fn values(setup: &Setup, measured: &Measured, figure: Figure) -> PatternValues {
    let colours = &measured.figures[figure as usize];
    if colours.is_empty() {
        return PatternValues::default();
    }
    let colour = |name: &str, faces: f64| {
        let colour = colours[state(setup, name)?];
        Some([0, 1, 2].map(|k| colour[k] + faces * measured.from_faces[k]))
    };
    let uv = |name| {
        let [x, y, z] = colour(name, 1.0)?;
        Xyz { x, y, z }.uv_prime()
    };
    let triangle: Option<Vec<UvPrime>> = PRIMARIES.into_iter().map(uv).collect();
    let triangle = triangle.and_then(|uv| <[UvPrime; 3]>::try_from(uv).ok());
    let contrast = |faces: f64| {
        let (page, black) = (measured.beside[figure as usize]?, colour(BLACK, faces)?);
        let page = page[1] + faces * measured.from_faces[1];
        (black[1] > 0.0).then(|| page / black[1])
    };
    PatternValues {
        gamut_percent_srgb: triangle.map(|uv| gamut_percent(uv, GamutReference::Srgb)),
        contrast_ratio: contrast(1.0),
        contrast_ratio_via_pixel: contrast(0.0),
    }
}

impl PatternValues {
    fn all(&self) -> [Option<f64>; 3] {
        [self.gamut_percent_srgb, self.contrast_ratio, self.contrast_ratio_via_pixel]
    }

    /// Those of a list in the same order.
    fn of(all: &[Option<f64>]) -> Self {
        let at = |k: usize| all.get(k).copied().flatten();
        Self { gamut_percent_srgb: at(0), contrast_ratio: at(1), contrast_ratio_via_pixel: at(2) }
    }
}
