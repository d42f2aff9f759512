//! What a view sees of each light, by frequency and by place.

use num_complex::Complex64;
use papilio_optics::Beta;
use papilio_transport::spatial::{
    Accuracy, FrontWays, LambertianReturn, Peak, PixelSpread, SpreadError, air_below_front_mm,
};
use papilio_transport::{Panel, Source, Top};

use super::patterns::{Pattern, Text};
use super::{Refused, below_layers, ghosts, lobe, paper, returned};
use crate::DisplayError;
use crate::meter::{Meter, PixelLight};
use crate::run::Control;
use crate::setup::{SeenPart, Setup, ViewPoint, all_of};

/// Natural digits of level 0 of general layers, and how many more each further one has.
const DIGITS_OF_LAYERS: f64 = 9.0;
const MORE_DIGITS_OF_LAYERS: f64 = 4.0;

/// Accuracy of a response. The difference of two levels is the error of the coarser one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Level {
    /// Natural digits.
    pub(crate) digits: f64,
    /// Highest spatial frequency that will be asked, cycles per mm.
    pub(crate) most_per_mm: f64,
    /// True for the finer level of a result. A coarse one also takes simpler estimates, so that the
    /// difference bounds theirs, however many digits both have.
    pub(crate) is_fine: bool,
    /// True if light that a front returns is to be a sum over other points, and fewer.
    pub(crate) is_other: bool,
    /// Number of times that cells of figures are halved beyond those of the finer of two levels.
    pub(crate) finer: u32,
}

impl Level {
    /// Natural digits of a level of general layers.
    pub(super) fn digits_of_layers(level: usize) -> f64 {
        DIGITS_OF_LAYERS + MORE_DIGITS_OF_LAYERS * level as f64
    }

    /// Level of adding of the light of pages.
    pub(super) fn of_pages(self) -> u32 {
        if self.is_fine { 4 } else { 3 }
    }

    /// Level of adding of general layers, of light with and without regard to places.
    pub(super) fn of_layers(self) -> u32 {
        let digits = (self.digits - DIGITS_OF_LAYERS) / MORE_DIGITS_OF_LAYERS;
        digits.round().max(0.0) as u32
    }
}

/// Light that a view sees via the pixel in each state, from one source. All values are parts of Y.
pub(crate) trait Response: Sync {
    /// True if a part of the light is a sum over few points, of which there are others.
    fn has_other_points(&self) -> bool {
        false
    }

    /// Light at a spatial frequency along an axis (0: x), cycles per mm, `[state]`. At 0 it is Y.
    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64>;

    /// Light of strips along an axis (0: x) between ascending places, mm, `[state][bin]`; the first bin is
    /// everything below the first place, the last everything above the last.
    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>>;

    /// Light of rings between ascending radii above 0, mm, `[state][bin]`; the last bin is everything
    /// outside.
    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>>;

    /// Light of cells between ascending borders, mm, rows from the bottom, `[state][cell]`.
    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>>;

    /// Light of the middle of a line of the first state on the second, across an axis, through all orders;
    /// `None` if the spread describes it.
    fn line(&self, _states: [usize; 2], _axis: usize, _width_mm: f64, _level: Level) -> Option<f64> {
        None
    }

    /// Mean of a pattern through all orders; `None` if it is that of the states.
    fn pattern_mean(&self, _pattern: Pattern, _level: Level) -> Option<f64> {
        None
    }

    /// Light of the middle of each stroke of black on white text, through all orders; `None` if the spread
    /// describes it.
    fn text(&self, _text: &Text<'_>, _black_and_white: [usize; 2], _level: Level) -> Option<Vec<f64>> {
        None
    }

    /// Places of sharp images.
    fn images(&self) -> Vec<[f64; 2]>;

    /// Places near which the light changes quickly.
    fn peaks(&self) -> Vec<Peak>;
}

/// Response to one light of a scene.
pub(crate) struct Seen {
    /// Name of the light: `diffuse`, `directed.0`, ...
    pub(crate) light: String,
    pub(crate) response: Box<dyn Response>,
}

/// Responses of a view to all lights with an illuminance, and Y of the images of the lights in flat faces.
pub(crate) fn responses(
    setup: &Setup,
    view: &ViewPoint,
    level: Level,
    control: &Control<'_>,
) -> Result<(Vec<Seen>, f64), DisplayError> {
    setup.refracts()?;
    let Some(panel) = setup.placed()?.panel() else {
        return below_layers::responses(setup, view, level, control);
    };
    let meter = Meter::new(setup);
    let parts = setup.seen_in_parts(view, level.of_pages(), control)?;
    let spread = setup.scene.display.pixel_spread();
    if spread.is_some() && matches!(panel.top, Top::Diffuser(_)) {
        return Err(Refused::SpreadBelowLobe.into());
    }
    let lit = Lit { panel, view, level, spread };
    if !matches!(panel.top, Top::Diffuser(_)) && panel.base.is_specular() {
        return mirrors(setup, lit, &parts);
    }
    let factors = all_of(parts);
    let (mut all, mut faces) = (Vec::new(), None);
    for light in meter.pixel_lights().into_iter().filter(PixelLight::is_seen) {
        let [_, weights, _] = &light.weights;
        let (source, via_pixel) = (&setup.sources[light.source], &factors[light.source].via_pixel[..]);
        let response: Box<dyn Response> = match (&panel.top, panel.base.is_specular()) {
            (Top::Diffuser(_), true) => returned::response(lit, source, weights, via_pixel)?,
            (Top::Diffuser(_), false) if !lit.returns() => Box::new(lobe::response(lit, source, weights)?),
            _ => Box::new(paper::response(lit, source, (weights, via_pixel), &mut faces)?),
        };
        all.push(Seen { light: name_of_light(setup, &light), response });
    }
    Ok((all, meter.without_pixel(&factors)[1]))
}

/// The same of mirror-like pixels below a flat face: light of s and of p, if they are kept apart.
fn mirrors<'p>(
    setup: &Setup,
    lit: Lit<'p>,
    parts: &'p [SeenPart<'p>],
) -> Result<(Vec<Seen>, f64), DisplayError> {
    let meter = Meter::new(setup);
    let of_light = |light: PixelLight| {
        let of_part = |part: &'p SeenPart<'p>| {
            let own = part.stack.panel().map_or(lit, |panel| Lit { panel, ..lit });
            (own, &part.factors[light.source].via_pixel[..])
        };
        let response = ghosts::response(lit, parts.iter().map(of_part), &light.weights[1])?;
        Ok(Seen { light: name_of_light(setup, &light), response: Box::new(response) })
    };
    let lights = meter.pixel_lights().into_iter().filter(PixelLight::is_seen);
    let from_faces = parts.iter().map(|part| meter.without_pixel(&part.factors)[1]).sum();
    Ok((lights.map(of_light).collect::<Result<_, DisplayError>>()?, from_faces))
}

/// What a view sees of an ordinary panel.
#[derive(Clone, Copy)]
pub(super) struct Lit<'a> {
    pub(super) panel: &'a Panel,
    pub(super) view: &'a ViewPoint,
    pub(super) level: Level,
    /// Spread of light inside the pixels.
    pub(super) spread: Option<PixelSpread>,
}

impl Lit<'_> {
    /// Thickness of the glass.
    pub(super) fn thickness_mm(&self) -> f64 {
        self.panel.gaps_mm.last().copied().unwrap_or_default()
    }

    /// Air between the front and what is below it, of a front above a diffuser all of it; 0 if the front returns no light.
    pub(super) fn air_mm(&self) -> Result<f64, DisplayError> {
        air_below_front_mm(self.panel).map_err(|error| Refused::Fronts(error).into())
    }

    /// How far light spreads that is returned: the thickness, or a part of a large distance to the front.
    pub(super) fn reach_mm(&self) -> Result<f64, DisplayError> {
        let (thickness_mm, air_mm) = (self.thickness_mm(), self.air_mm()?);
        Ok(thickness_mm.max(0.25 * (thickness_mm + air_mm)))
    }

    /// Ways of light through a front above a diffuser, but for a fraction of it of `digits` natural digits.
    pub(super) fn front_ways(&self, digits: f64) -> Result<FrontWays, DisplayError> {
        FrontWays::new(self.panel, (-digits).exp()).map_err(not_computed)
    }

    /// What returns to Lambertian pixels, for frequencies up to `most_per_mm`.
    pub(super) fn lambertian_return(&self, most_per_mm: f64) -> Result<Vec<LambertianReturn>, DisplayError> {
        let accuracy = Accuracy { digits: self.level.digits, most_per_mm };
        LambertianReturn::all(self.panel, accuracy).map_err(not_computed)
    }

    /// True if a front returns light to the pixel.
    pub(super) fn returns(&self) -> bool {
        !self.panel.single_pass && self.panel.front.reflectance_below.max() > 0.0
    }

    /// Reflectances of the face above the pixel, and of the front, for light from below along a direction, at
    /// a wavelength.
    pub(super) fn faces(&self, bin: usize, beta: Beta) -> [f64; 2] {
        let front = if self.panel.single_pass { 0.0 } else { self.panel.front.reflectance_below[bin] };
        [face_reflectance(self.panel, bin, beta.length()), front]
    }

    /// Fraction of light between face and front that is reflected by both, for s and p, and the share of each in what
    /// leaves towards a view, at a wavelength; halves of the mean if they are not kept apart.
    pub(super) fn between(&self, bin: usize, beta: Beta) -> [(f64, f64); 2] {
        let [face, front] = self.faces(bin, beta);
        if !self.panel.keeps_s_and_p {
            return [(face * front, 0.5); 2];
        }
        let faces = self.panel.face_reflectances(self.panel.medium.index()[bin], beta.length());
        let leaves = faces.map(|face| (1.0 - face) / (1.0 - face * front));
        let all = leaves[0] + leaves[1];
        [0, 1].map(|k| (faces[k] * front, if all > 0.0 { leaves[k] / all } else { 0.5 }))
    }
}

/// Why places are not computed: by adding, if paths follow the light.
pub(super) fn not_computed(error: SpreadError) -> DisplayError {
    match error {
        SpreadError::SeveralFronts | SpreadError::ManyWays => Refused::Fronts(error).into(),
        SpreadError::ScatteringPixel | SpreadError::Unrefracted => {
            DisplayError::PlacesNotComputed { what: error.to_string(), key: "display".to_owned() }
        }
    }
}

/// Reflectance of the face above the pixel for light from below, at a wavelength.
pub(super) fn face_reflectance(panel: &Panel, bin: usize, beta: f64) -> f64 {
    match &panel.top {
        _ if beta > 1.0 => 1.0,
        Top::Fresnel(index) => {
            let [s, p] = panel.face_reflectances(index[bin], beta);
            0.5 * (s + p)
        }
        Top::IdealAr | Top::Diffuser(_) => 0.0,
    }
}

/// Name of a light in results: by the kind of its source and its number in the scenario.
pub(super) fn name_of_light(setup: &Setup, light: &PixelLight) -> String {
    let lighting = &setup.scene.lighting;
    let term = setup.lights[light.light].term;
    let directed = lighting.directed.len();
    match (&setup.sources[light.light], term) {
        (_, 0) => "diffuse".to_owned(),
        (Source::Beam(_) | Source::Disc(_), term) => format!("directed.{}", term - 1),
        (_, term) if term <= directed + lighting.environment.len() => {
            format!("environment.{}", term - 1 - directed)
        }
        _ if light.source != light.light => "front_light.leak".to_owned(),
        _ => "front_light".to_owned(),
    }
}
