//! What a view sees of each light, by frequency and by place.

use num_complex::Complex64;
use papilio_imaging::text::Bitmap;
use papilio_transport::adding::Kernel;
use papilio_transport::spatial::Peak;
use papilio_transport::{Panel, Source, Stack, Top};

use super::patterns::Pattern;
use super::{ghosts, lobe, paper};
use crate::DisplayError;
use crate::meter::Meter;
use crate::scene::Layers;
use crate::setup::{Setup, ViewPoint};

/// Accuracy of a response. The difference of two levels is the error of the coarser one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Level {
    /// Natural digits.
    pub(crate) digits: f64,
    /// Highest spatial frequency that will be asked, cycles per mm.
    pub(crate) most_per_mm: f64,
}

impl Level {
    /// True for the finer level of a result.
    pub(crate) fn is_fine(self) -> bool {
        self.digits > 10.0
    }
}

/// Light that a view sees via the pixel in each state, from one source. All values are parts of Y.
pub(crate) trait Response: Sync {
    /// Light at a spatial frequency along an axis (0: x), cycles per mm, `[state]`. At 0 it is Y.
    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64>;

    /// Light of strips along an axis (0: x) between ascending places, mm, `[state][bin]`; the first bin is everything below the
    /// first place, the last everything above the last.
    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>>;

    /// Light of rings between ascending radii above 0, mm, `[state][bin]`; the last bin is everything outside.
    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>>;

    /// Light of cells between ascending borders, mm, rows from the bottom, `[state][cell]`.
    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>>;

    /// Light of the middle of a line of the first state on the second, through all orders; `None` if the spread describes it.
    fn line(&self, _states: [usize; 2], _width_mm: f64, _level: Level) -> Option<f64> {
        None
    }

    /// Mean of a pattern through all orders; `None` if it is that of the states.
    fn pattern_mean(&self, _pattern: Pattern, _level: Level) -> Option<f64> {
        None
    }

    /// Light of the middle of each pixel of black on white text, through all orders; `None` if the spread describes it.
    fn text(
        &self,
        _bitmap: &Bitmap,
        _pitch_mm: [f64; 2],
        _black_and_white: [usize; 2],
        _level: Level,
    ) -> Option<Vec<f64>> {
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
) -> Result<(Vec<Seen>, f64), DisplayError> {
    let lengths = setup.scene.display.lengths_mm()?;
    let meter = Meter::new(setup);
    let (Stack::Panel(panel), Layers::Panel(_)) = (&setup.stack, &setup.scene.display.layers) else {
        return Err(not_yet("general layers ([[display.layers]])", "display.layers"));
    };
    if panel.front.reflectance_below.max() > 0.0 {
        return Err(not_yet("front components that reflect light", "display.front"));
    }
    let thickness_mm = lengths.last().copied().unwrap_or_default();
    let stop = std::sync::atomic::AtomicBool::new(false);
    let mut kernel = Kernel::new(if level.is_fine() { 4 } else { 3 });
    let fields = [view.field];
    let _ready = kernel.prepare_unless(&setup.stack, &fields, &setup.sources, &stop);
    let factors = kernel.seen(&setup.stack, 0);
    let mut all = Vec::new();
    let mut from_faces = 0.0;
    for (number, (source, factor)) in setup.sources.iter().zip(&factors).enumerate() {
        let weights = meter.luminous_weights(number);
        if weights.iter().all(|weight| *weight == 0.0) {
            continue;
        }
        from_faces += weights.iter().zip(&factor.front).map(|(weight, front)| weight * front).sum::<f64>();
        let light = name_of_light(setup, number);
        let response: Box<dyn Response> = match (&panel.top, panel.base.is_specular()) {
            (Top::Diffuser(_), _) => lobe::response(panel, &lengths, (view, source), weights, level)?,
            (_, true) => ghosts::response(panel, thickness_mm, view, weights, &factor.via_pixel),
            (_, false) => paper::response(panel, thickness_mm, weights, &factor.via_pixel, level),
        };
        all.push(Seen { light, response });
    }
    Ok((all, from_faces))
}

/// Reflectance of the face above the pixel for light from below, at a wavelength.
pub(super) fn face_reflectance(panel: &Panel, bin: usize, beta: f64) -> f64 {
    match &panel.top {
        _ if beta > 1.0 => 1.0,
        Top::Fresnel(index) => papilio_optics::interface::fresnel_reflectance(1.0, index[bin], beta),
        Top::IdealAr | Top::Diffuser(_) => 0.0,
    }
}

fn not_yet(what: &str, key: &str) -> DisplayError {
    DisplayError::PlacesNotComputed { what: what.to_owned(), key: key.to_owned() }
}

/// Name of a source in results: by its kind and its number in the scenario.
pub(super) fn name_of_light(setup: &Setup, number: usize) -> String {
    let lighting = &setup.scene.lighting;
    let term = setup.lights[number].term;
    let directed = lighting.directed.len();
    match (&setup.sources[number], term) {
        (_, 0) => "diffuse".to_owned(),
        (Source::Beam(_) | Source::Disc(_), term) => format!("directed.{}", term - 1),
        (_, term) if term <= directed + lighting.environment.len() => {
            format!("environment.{}", term - 1 - directed)
        }
        _ => "front_light".to_owned(),
    }
}
