//! Halftones by threshold masks, from the coverages of the states that mix each colour.
//!
//! Where the eight states of red, green and blue sub-pixels add, the coverages of the sub-pixels are unique
//! ([`SubPixels`]), and each sub-pixel has a mask of its own, so that dark ones lie beside light ones.
//! Otherwise the states are those with the least variance of luminance ([`LeastVariance`]), in their order
//! from light to dark.

use papilio_colour::states::{LeastVariance, StateHull, SubPixels};
use papilio_colour::{CORNERS, Corners, Xyz};
use papilio_imaging::halftone::{Mask, light_to_dark, ordered, ordered_planes};

use super::colour;
use super::halftone::Panel;
use super::neutrals::Neutral;
use crate::DisplayError;
use crate::run::Control;

/// Largest difference of a state from the sum of its sub-pixels, relative to Y of white, for which they are
/// taken to add.
const ADDS: f64 = 1e-3;

/// How colours become states.
enum Mixer<'a> {
    /// Independent sub-pixels: the state of each combination of red (1), green (2) and blue (4), and a mask
    /// for each.
    SubPixels { sub_pixels: SubPixels, states: [u8; 8], masks: [Mask; 3] },
    /// Some states, with their numbers, from light to dark.
    States { solver: LeastVariance, hull: StateHull, order: Vec<u8>, numbers: Vec<u8>, mask: &'a Mask },
}

/// The target of a pixel by its number, and whether it takes the few states of neutral colours; `None`: the mask does not decide its state.
type Target<'a> = dyn Fn(usize) -> Option<([f32; 3], bool)> + 'a;

/// The states of so many pixels by a mask.
pub(super) fn masked(
    mask: &Mask,
    (pixels, target): (usize, &Target<'_>),
    panel: &Panel<'_>,
    control: &Control<'_>,
) -> Result<Vec<Option<u8>>, DisplayError> {
    let mixer = Mixer::new(mask, panel)?;
    let of_greys = |neutral: &Neutral| Mixer::of_some(mask, panel, &neutral.allowed);
    let of_greys = panel.neutral.as_ref().map(of_greys).transpose()?;
    let nothing = panel.rendering.states.first().map_or([0.0; 3], |state| state.map(|value| value as f32));
    let mut states = vec![None; pixels];
    // Bands of as many rows as the mask has: each begins with its first row.
    let band = (panel.columns * mask.rows()).max(1);
    for (number, states) in states.chunks_mut(band).enumerate() {
        control.check()?;
        let targets: Vec<_> = (0..states.len()).map(|at| target(number * band + at)).collect();
        let has = |few: bool| targets.iter().flatten().any(|(_, is_few)| *is_few == few);
        let colours = || targets.iter().map(|one| one.map_or(nothing, |(colour, _)| colour));
        for (mixer, few) in [(Some(&mixer), false), (of_greys.as_ref(), true)] {
            if let Some(mixer) = mixer.filter(|_| has(few)) {
                let found = mixer.states(&colours().collect::<Vec<_>>(), panel)?;
                for ((state, found), target) in states.iter_mut().zip(found).zip(&targets) {
                    if target.is_some_and(|(_, is_few)| is_few == few) {
                        *state = Some(found);
                    }
                }
            }
        }
    }
    Ok(states)
}

impl<'a> Mixer<'a> {
    fn new(mask: &'a Mask, panel: &Panel<'_>) -> Result<Self, DisplayError> {
        let rendering = panel.rendering;
        if let Some((sub_pixels, states)) = sub_pixels(panel) {
            // Half a cell and one pixel: far apart where few are on, side by side where a quarter is.
            let [right, down] = [mask.columns() / 2 + 1, mask.rows() / 2 + 1];
            let masks = [mask.shifted(right, down), mask.clone(), mask.shifted(right, 0)];
            return Ok(Self::SubPixels { sub_pixels, states, masks });
        }
        Self::of_some(mask, panel, &vec![true; rendering.states.len()])
    }

    /// The mixer of some of the states.
    fn of_some(mask: &'a Mask, panel: &Panel<'_>, allowed: &[bool]) -> Result<Self, DisplayError> {
        let numbers: Vec<u8> = (0..=u8::MAX)
            .zip(allowed)
            .filter(|(_, is_allowed)| **is_allowed)
            .map(|(number, _)| number)
            .collect();
        let some: Vec<[f64; 3]> =
            numbers.iter().map(|number| panel.rendering.states[usize::from(*number)]).collect();
        let points: Vec<Xyz> = some.iter().map(|[x, y, z]| Xyz { x: *x, y: *y, z: *z }).collect();
        let solver = LeastVariance::new(&points)?;
        Ok(Self::States {
            solver,
            hull: StateHull::new(&points)?,
            order: light_to_dark(&some),
            numbers,
            mask,
        })
    }

    fn states(&self, band: &[[f32; 3]], panel: &Panel<'_>) -> Result<Vec<u8>, DisplayError> {
        match self {
            Self::SubPixels { sub_pixels, states, masks } => {
                let all: Vec<_> = band.iter().map(|pixel| sub_pixels.coverages(colour(*pixel))).collect();
                let plane = |k: usize| all.iter().map(|one| one[k] as f32).collect::<Vec<_>>();
                let planes = [plane(0), plane(1), plane(2)];
                let planes: Vec<(&[f32], &Mask)> = planes.iter().map(Vec::as_slice).zip(masks).collect();
                let on = ordered_planes(&planes, panel.columns)?;
                Ok(on.into_iter().map(|on| states[usize::from(on)]).collect())
            }
            Self::States { solver, hull, order, numbers, mask } => {
                let count = order.len();
                let mut coverages = vec![0.0; band.len() * count];
                for (pixel, coverages) in band.iter().zip(coverages.chunks_exact_mut(count)) {
                    let pixel = colour(*pixel);
                    // Rounding may leave a colour beside a thin hull.
                    let nearest = || solver.coverages(hull.nearest(pixel, panel.rendering.white));
                    match solver.coverages(pixel).or_else(nearest) {
                        Some(found) => {
                            found.iter().for_each(|(state, coverage)| coverages[state] = coverage as f32);
                        }
                        None => {
                            let distance = |at: &usize| {
                                let [x, y, z] = panel.rendering.states[usize::from(numbers[*at])];
                                pixel.distance(Xyz { x, y, z })
                            };
                            let nearest = (0..count).min_by(|a, b| distance(a).total_cmp(&distance(b)));
                            coverages[nearest.unwrap_or(0)] = 1.0;
                        }
                    }
                }
                let found = ordered(&coverages, panel.columns, order, mask)?;
                Ok(found.into_iter().map(|number| numbers[usize::from(number)]).collect())
            }
        }
    }
}

/// The sub-pixels of a display whose states are the eight of red, green and blue sub-pixels, if their light
/// adds, and the number of the state of each combination.
fn sub_pixels(panel: &Panel<'_>) -> Option<(SubPixels, [u8; 8])> {
    let colours = &panel.palette.colours;
    if colours.len() != CORNERS.len() {
        return None;
    }
    let mut states = [0; 8];
    for (state, name) in states.iter_mut().zip(CORNERS) {
        *state = colours.iter().position(|one| one.state == name)? as u8;
    }
    let xyz = states.map(|state| {
        let [x, y, z] = panel.rendering.states[usize::from(state)];
        Xyz { x, y, z }
    });
    let sub_pixels = SubPixels::new(&Corners { xyz }).ok()?;
    (sub_pixels.misfit() < ADDS).then_some((sub_pixels, states))
}
