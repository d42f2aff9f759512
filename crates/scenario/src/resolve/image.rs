//! `[image]`: settings, and the picture in linear light.

use std::f64::consts::PI;

use papilio_colour::mapping::{Intent, MapSpace};
use papilio_colour::{Surround, Viewing};
use papilio_diagnostics::Diagnostic;
use papilio_display::image::{Adjustments, Halftone, ImageSettings, Regions, SourceImage};
use papilio_display::scene::Scene;

use super::{PanelCodes, Resolver};
use crate::describe::File;
use crate::describe::image::{Adjusted, Exposure, Image, ImageMapSpace, WhiteBalance};
use crate::mistake;
use crate::origin::Origin;
use crate::read::Read as _;
use crate::tree::Node;

/// A picture, and how it is brought to the display.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageRequest {
    /// The picture.
    pub source: SourceImage,
    /// Settings.
    pub settings: ImageSettings,
    /// Codes of its states for the panel.
    pub codes: Option<PanelCodes>,
}

impl Resolver<'_> {
    /// Reads the picture of `[image]`, or uses a given one; its states must be those of the display.
    pub(super) fn image(
        &mut self,
        file: &File,
        scene: &Scene,
        given: Option<&SourceImage>,
    ) -> Option<ImageRequest> {
        let known = scene.display.state_names();
        let defaults;
        let image = match &file.image.value {
            Some(image) => image,
            None => {
                defaults = Image::read(&Node::empty_table(), &mut self.errors)?;
                &defaults
            }
        };
        for (at, state) in image.states.iter().enumerate() {
            if !known.contains(&state.0) {
                self.err(state, mistake::no_such_state(&state.0, &known));
            } else if image.states[..at].iter().any(|before| before.0 == state.0) {
                let twice = Diagnostic::new(format!("the state `{}` is listed twice", state.0));
                self.err(state, twice.hint("remove one of the two"));
            }
        }
        if let [only] = &image.states[..]
            && known.contains(&only.0)
        {
            let wrong = Diagnostic::new(format!("the state `{}` alone shows no picture", only.0));
            self.err(only, wrong.expected("two or more states").hint("remove `states` to use all"));
        }
        let is_natural = matches!(image.intent.0, Intent::Natural | Intent::Vivid);
        for (key, adjusted) in [("contrast", &image.contrast), ("saturation", &image.saturation)] {
            if !is_natural && matches!(adjusted.value, Adjusted::Factor(_)) {
                let only = Diagnostic::new(format!("{key} is a factor on natural and vivid pictures"));
                self.err(
                    adjusted,
                    only.hint(format!("remove `{key}`, or write intent = \"natural\" or \"vivid\"")),
                );
            }
        }
        if image.halftone.0 == Halftone::DirectBinarySearch && scene.display.matrix.is_none() {
            let wrong = Diagnostic::new(
                "direct-binary-search needs the angle at which the reader sees a pixel, and [display.matrix] is missing",
            );
            let hint =
                "add [display.matrix] with ppi or pitch_um; `viewer.distance_mm` is the distance of the eye";
            self.err(&image.halftone, wrong.hint(hint));
        }
        let used = match &image.states[..] {
            [] => known.clone(),
            states => {
                let mut used: Vec<String> = Vec::new();
                for state in states.iter().map(|state| &state.0).filter(|state| known.contains(state)) {
                    if !used.contains(state) {
                        used.push(state.clone());
                    }
                }
                used
            }
        };
        let codes = self.codes(file.display.pixel.codes(), &used, &known);
        let source = self.picture(image, file, scene, given)?;
        let mut settings = settings(image, scene.lighting.illuminance_lx);
        settings.regions = self.regions(image, given, &source)?;
        // Defaults have the place of the table.
        let is_given = |origin: Origin| origin != file.image.origin;
        if !is_given(image.halftone.origin) && (is_given(image.kernel.origin) || is_given(image.scan.origin))
        {
            // Who chooses how errors are passed on gets the pattern of just that.
            settings.halftone = Halftone::ErrorDiffusion;
        }
        let passes_nothing_on = matches!(
            image.halftone.0,
            Halftone::None | Halftone::Nearest | Halftone::Ordered | Halftone::VoidAndCluster
        );
        let of_diffusion = |origin| is_given(image.halftone.origin) && passes_nothing_on && is_given(origin);
        for (key, is_idle, why) in [
            ("kernel", of_diffusion(image.kernel.origin), "this halftone passes on no errors"),
            ("scan", of_diffusion(image.scan.origin), "this halftone passes on no errors"),
            ("text_size_pt", image.text_size_pt.is_some() && image.text.is_none(), "there is no `text`"),
            ("period_mm", image.period_mm.is_some() && image.pattern.is_none(), "there is no `pattern`"),
        ] {
            if is_idle {
                self.warnings.push(format!("image.{key} has no effect: {why}"));
            }
        }
        Some(ImageRequest { source, settings, codes })
    }
}

/// Luminance of the grey to which the eye adapts, and of the background, relative to a perfect white.
const GREY: f64 = 0.2;

fn settings(image: &Image, illuminance_lx: f64) -> ImageSettings {
    ImageSettings {
        intent: image.intent.0,
        space: match image.map_space.value {
            ImageMapSpace::Oklab => MapSpace::Oklab,
            ImageMapSpace::Cam16Ucs => MapSpace::Cam16Ucs(Viewing {
                adapting_luminance_cd_m2: GREY * illuminance_lx / PI,
                background: GREY,
                surround: Surround::Average,
            }),
        },
        adjustments: adjustments(image),
        regions: Regions::Auto,
        neutrals: image.neutrals.0,
        halftone: image.halftone.0,
        kernel: image.kernel.0,
        scan: image.scan.0,
        seed: image.seed.0,
        states: image.states.iter().map(|state| state.0.clone()).collect(),
        surround: image.surround.0,
        perspective: image.perspective.value,
        samples_per_pixel: image.samples_per_pixel.0 as usize,
        given: None,
        prepared_for: Vec::new(),
        losses: false,
    }
}

fn adjustments(image: &Image) -> Adjustments {
    let factor = |adjusted: &Adjusted| match adjusted {
        Adjusted::Auto(_) => None,
        Adjusted::Factor(factor) => Some(factor.0),
    };
    Adjustments {
        exposure: match &image.exposure.value {
            Exposure::Auto(_) => None,
            Exposure::Stops(stops) => Some(stops.0),
        },
        contrast: factor(&image.contrast.value),
        saturation: factor(&image.saturation.value),
        white_balance_k: match &image.white_balance.value {
            WhiteBalance::Word(_) => None,
            WhiteBalance::Kelvin(kelvin) => Some(kelvin.0),
        },
    }
}
