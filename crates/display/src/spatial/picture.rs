//! Colours of a picture on Lambertian pixels under a flat face, which returns light to them.

use std::sync::atomic::AtomicBool;

use papilio_transport::adding::Kernel;
use papilio_transport::spatial::{FaceReturn, LitPage, Page, PageLight, Precision};
use papilio_transport::{Panel, Reflector, Stack, Top};

use super::response::face_reflectance;
use crate::DisplayError;
use crate::meter::Meter;
use crate::run::Control;
use crate::scene::Scene;
use crate::setup::{Setup, ViewPoint};

/// A picture: the state of each pixel, by its number in the scene; rows from the bottom, columns from the left. It repeats beyond its
/// borders.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Number of columns and rows.
    pub count: [usize; 2],
    /// State of each pixel.
    pub states: Vec<u8>,
}

/// Colours of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureColours {
    /// X, Y and Z of each pixel relative to a perfect white in the scene's light, for each view.
    pub views: Vec<Vec<[f32; 3]>>,
    /// Largest error: the difference from cells of half the size in a part of the picture.
    pub error: f64,
}

/// Columns and rows of the part of which the error is computed.
const PART: usize = 128;

/// Level of the colours of pages.
const LEVEL: u32 = 4;

/// Computes what each view sees of each pixel of a picture, through all orders.
///
/// # Errors
/// If the scene is invalid, has no matrix, a length is missing, its kind of display or light is not covered, a state does not exist, or
/// the computation was stopped.
pub fn picture(
    scene: &Scene,
    picture: &Picture,
    precision: Precision,
    control: &Control<'_>,
) -> Result<PictureColours, DisplayError> {
    let setup = Setup::new(scene)?;
    let missing = DisplayError::NoMatrix { command: "picture" };
    let pitch_mm = scene.display.matrix.as_ref().ok_or(missing)?.pitch_mm;
    let thickness_mm = scene.display.lengths_mm()?.last().copied().unwrap_or_default();
    let (panel, rho) = covered(&setup)?;
    let highest = picture.states.iter().copied().map(usize::from).max().unwrap_or(0);
    if highest >= setup.states.len() || picture.states.len() != picture.count[0] * picture.count[1] {
        return Err(DisplayError::NoSuchQuantity { what: format!("state {highest}"), quantity: "picture" });
    }
    let part = picture.part();
    let finer = Precision {
        cell: 0.5 * precision.cell,
        change: 0.1 * precision.change,
        missed: 0.1 * precision.missed,
    };
    let mut colours = vec![Vec::new(); setup.views.len()];
    let mut error = 0.0_f64;
    let lights: Vec<ViewLight> = setup.views.iter().map(|view| ViewLight::new(&setup, view)).collect();
    for bins in by_index(panel) {
        if control.stopped() {
            return Err(DisplayError::Interrupted);
        }
        let passes = |beta: f64| 1.0 - face_reflectance(panel, bins[0], beta);
        let index = panel.medium.index()[bins[0]];
        // Cells of half the size, and their diagonal.
        let most_per_mm = 2.0 / (finer.cell * thickness_mm);
        let face = FaceReturn::new(index, thickness_mm, most_per_mm, passes).tabulated();
        let count = setup.scene.grid.len();
        let reflectance: Vec<Vec<f64>> = (0..setup.states.len())
            .map(|state| bins.iter().map(|bin| rho[state * count + bin]).collect())
            .collect();
        let seen: Vec<_> = lights.iter().map(|light| light.of(&bins, &reflectance, face.at(0.0))).collect();
        let Some(first) = seen.first() else { continue };
        let solved = |picture: &Picture, precision: Precision| {
            let page = Page { count: picture.count, pitch_mm, states: &picture.states };
            let light = PageLight { reflectance: &reflectance, seen: first };
            let lit = LitPage::new(&page, &face, light, precision, thickness_mm);
            let views = seen.iter().map(|seen| lit.seen(&page, PageLight { seen, ..light }));
            views.collect::<Vec<Vec<[f32; 3]>>>()
        };
        for (sum, more) in colours.iter_mut().zip(solved(picture, precision)) {
            match sum.is_empty() {
                true => *sum = more,
                false => {
                    sum.iter_mut().zip(more).for_each(|(sum, more)| (0..3).for_each(|k| sum[k] += more[k]))
                }
            }
        }
        let [coarse, fine] = [precision, finer].map(|precision| solved(&part, precision));
        let pairs = coarse.iter().flatten().flatten().zip(fine.iter().flatten().flatten());
        error += pairs.map(|(coarse, fine)| f64::from((coarse - fine).abs())).fold(0.0, f64::max);
    }
    for (colours, light) in colours.iter_mut().zip(&lights) {
        colours.iter_mut().for_each(|colour| (0..3).for_each(|k| colour[k] += light.front[k] as f32));
    }
    Ok(PictureColours { views: colours, error })
}

impl Picture {
    /// The middle of the picture.
    fn part(&self) -> Self {
        let count = self.count.map(|count| count.min(PART));
        let from = [0, 1].map(|k| (self.count[k] - count[k]) / 2);
        let row = |row: usize| &self.states[(from[1] + row) * self.count[0] + from[0]..][..count[0]];
        Self { count, states: (0..count[1]).flat_map(row).copied().collect() }
    }
}

/// What a view sees of pages in all light.
struct ViewLight {
    /// Light via the pixel in X, Y and Z, `[X, Y, Z][state and wavelength]`.
    pages: [Vec<f64>; 3],
    /// Light of faces.
    front: [f64; 3],
    bins: usize,
}

impl ViewLight {
    fn new(setup: &Setup, view: &ViewPoint) -> Self {
        let (meter, bins) = (Meter::new(setup), setup.scene.grid.len());
        let mut kernel = Kernel::new(LEVEL);
        let _ready =
            kernel.prepare_unless(&setup.stack, &[view.field], &setup.sources, &AtomicBool::new(false));
        let mut light =
            Self { pages: [0, 1, 2].map(|_| vec![0.0; setup.states.len() * bins]), front: [0.0; 3], bins };
        let factors = kernel.seen(&setup.stack, 0);
        light.front = meter.without_pixel(&factors);
        for one in meter.pixel_lights() {
            let via_pixel = &factors[one.source].via_pixel;
            for (pages, weights) in light.pages.iter_mut().zip(&one.weights) {
                let values = via_pixel.iter().enumerate().map(|(at, light)| weights[at % bins] * light);
                pages.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            }
        }
        light
    }

    /// Light of each state for an irradiance of 1, `[state][X, Y, Z][wavelength]`: that of a page has 1/(1 - rho A(0)).
    fn of(&self, bins: &[usize], reflectance: &[Vec<f64>], returned: f64) -> Vec<[Vec<f64>; 3]> {
        let of_state = |(state, rho): (usize, &Vec<f64>)| {
            self.pages.each_ref().map(|pages| {
                let values = bins.iter().zip(rho);
                values.map(|(bin, rho)| pages[state * self.bins + bin] * (1.0 - rho * returned)).collect()
            })
        };
        reflectance.iter().enumerate().map(of_state).collect()
    }
}

/// Wavelengths with the same index of the medium.
fn by_index(panel: &Panel) -> Vec<Vec<usize>> {
    let index = panel.medium.index();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for bin in 0..index.len() {
        match groups.iter_mut().find(|group| index[group[0]] == index[bin]) {
            Some(group) => group.push(bin),
            None => groups.push(vec![bin]),
        }
    }
    groups
}

/// Returns panel and reflectances if pictures on them are computed.
fn covered(setup: &Setup) -> Result<(&Panel, &[f64]), DisplayError> {
    let not_yet = |what: &str, key: &str| {
        Err(DisplayError::PlacesNotComputed { what: what.to_owned(), key: key.to_owned() })
    };
    let Stack::Panel(panel) = &setup.stack else {
        return not_yet("pictures below general layers ([[display.layers]])", "display.layers");
    };
    let Reflector::Lambertian(rho) = &panel.base.reflector else {
        return not_yet("pictures on mirror-like pixels", "display.pixel");
    };
    if matches!(panel.top, Top::Diffuser(_)) {
        return not_yet("pictures below a diffuser", "display.diffuser");
    }
    if panel.front.reflectance_below.max() > 0.0 {
        return not_yet("pictures below front components that reflect light", "display.front");
    }
    if setup.scene.lighting.front_light.is_some() {
        return not_yet("pictures in a front light", "lighting.front_light");
    }
    Ok((panel, rho))
}
