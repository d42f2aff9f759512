//! What all views of crosstalk by adding have in common, and the levels of each.

use papilio_imaging::text::Bitmap;
use papilio_transport::{Panel, Reflector, Top};

use super::super::response::Lit;
use super::super::{Level, Refused, below_layers, layered, patterns};
use super::blurred::Strokes;
use super::places::Windows;
use super::surfaces::{Part, Surfaces};
use super::{CrosstalkView, matrix, page, refined};
use crate::DisplayError;
use crate::run::{self, Control};
use crate::scene::Matrix;
use crate::setup::{Setup, ViewPoint};

/// Natural digits of the first level and how many more each further one has, the highest order of the
/// sub-pixels' pattern that the first level resolves (each further one twice as many), and the finest level.
const DIGITS: f64 = 8.0;
const MORE_DIGITS: f64 = 3.0;
const ORDERS: f64 = 2.0;
const MOST_LEVEL: usize = 3;

/// What all views have in common.
pub(super) struct Frame<'a> {
    pub(super) setup: &'a Setup,
    pub(super) control: &'a Control<'a>,
    pub(super) matrix: &'a Matrix,
    /// `None` below general layers.
    pub(super) panel: Option<&'a Panel>,
    pub(super) surfaces: Surfaces,
    pub(super) windows: Windows,
    /// Parts of all states.
    pub(super) parts: Vec<Part>,
    /// State of the page.
    pub(super) page: usize,
    pub(super) text: Option<Bitmap>,
    pub(super) strokes: Option<Strokes>,
}

impl<'a> Frame<'a> {
    pub(super) fn new(setup: &'a Setup, text: &str, control: &'a Control<'a>) -> Result<Self, DisplayError> {
        let scene = &setup.scene;
        let matrix = matrix(setup)?;
        setup.refracts()?;
        setup.spreads_over_few_pixels()?;
        let panel = setup.stack.panel();
        if panel.is_none() && !below_layers::covers(setup) {
            return Err(Refused::Layers.into());
        }
        let surfaces = Surfaces::new(setup, matrix)?;
        if let Some(panel) = panel {
            if scene.display.pixel_spread().is_some() && matches!(panel.top, Top::Diffuser(_)) {
                return Err(Refused::SpreadBelowLobe.into());
            }
            let is_flat = !matches!(panel.top, Top::Diffuser(_)) && panel.base.is_specular();
            let returns = panel.front.reflectance_below.max() > 0.0 || matches!(panel.top, Top::Fresnel(_));
            if is_flat && returns && surfaces.states.iter().any(|parts| parts.len() > 1) {
                return Err(Refused::SubPixelsBelowFaces.into());
            }
        }
        let mut parts: Vec<Part> = Vec::new();
        for part in surfaces.states.iter().flatten() {
            if !parts.iter().any(|known| known.at() == part.at()) {
                parts.push(*part);
            }
        }
        let text = patterns::bitmap(scene, text, matrix.pitch_mm);
        Ok(Self {
            strokes: text
                .as_ref()
                .filter(|_| panel.is_some_and(|panel| !is_flat(panel)))
                .and_then(Strokes::new),
            text,
            windows: Windows::new(matrix),
            setup,
            control,
            matrix,
            panel,
            surfaces,
            parts,
            page: page(setup),
        })
    }

    pub(super) fn view(
        &self,
        view: &ViewPoint,
        control: &Control<'_>,
    ) -> Result<CrosstalkView, DisplayError> {
        let narrowest = self.matrix.pitch_mm[0].min(self.matrix.pitch_mm[1]);
        type Digits = fn(usize) -> f64;
        let of_panel: Digits = |level| DIGITS + MORE_DIGITS * level as f64;
        let (digits, finest, factor) = match self.panel {
            Some(_) => (of_panel, MOST_LEVEL, 1.0),
            None => {
                let factor = layered::error_over_difference(self.setup);
                let finest = run::finest(self.setup)?.min(MOST_LEVEL);
                (Level::digits_of_layers as Digits, finest, factor)
            }
        };
        let level = |level: usize| {
            let most_per_mm = ORDERS * f64::from(1_u32 << level) / narrowest;
            let finer = level.saturating_sub(1) as u32;
            Level { digits: digits(level), most_per_mm, is_fine: level > 0, is_other: false, finer }
        };
        let at = |number: usize| self.measure(view, level(number));
        refined(self.setup, view, (finest, factor), at, control)
    }

    pub(super) fn lit<'l>(&'l self, panel: &'l Panel, view: &'l ViewPoint, level: Level) -> Lit<'l> {
        let spread = self.setup.scene.display.pixel_spread();
        Lit { panel, view, level, spread }
    }
}

/// True if a front returns light to the pixel.
fn returns(panel: &Panel) -> bool {
    !panel.single_pass && panel.front.reflectance_below.max() > 0.0
}

/// True for pixels under a flat face that are Lambertian, or to which it or a front returns light.
pub(super) fn is_flat(panel: &Panel) -> bool {
    let is_paper = matches!(panel.base.reflector, Reflector::Lambertian(_));
    let returns = returns(panel) || matches!(panel.top, Top::Fresnel(_));
    !matches!(panel.top, Top::Diffuser(_)) && (is_paper || returns)
}
