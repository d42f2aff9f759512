//! `[image]`: settings, and the picture in linear light.

use std::f64::consts::PI;

use papilio_colour::mapping::{Intent, MapSpace};
use papilio_colour::{Surround, Viewing};
use papilio_diagnostics::Diagnostic;
use papilio_display::image::{Halftone, ImageSettings, PictureSurround, SourceImage};
use papilio_display::scene::Scene;
use papilio_imaging::halftone::{DiffusionKernel, Scan};

use super::Resolver;
use crate::describe::File;
use crate::describe::image::{
    ErrorKernel, ErrorScan, Image, ImageHalftone, ImageIntent, ImageMapSpace, ImageSurround,
};
use crate::mistake;
use crate::read::Read as _;
use crate::tree::Node;

/// A picture, and how it is brought to the display.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageRequest {
    /// The picture.
    pub source: SourceImage,
    /// Settings.
    pub settings: ImageSettings,
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
        if image.halftone.value == ImageHalftone::DirectBinarySearch && scene.display.matrix.is_none() {
            let wrong = Diagnostic::new(
                "direct-binary-search needs the angle at which the reader sees a pixel, and [display.matrix] is missing",
            );
            let hint =
                "add [display.matrix] with ppi or pitch_um; `viewer.distance_mm` is the distance of the eye";
            self.err(&image.halftone, wrong.hint(hint));
        }
        let source = self.picture(image, file, scene, given)?;
        Some(ImageRequest { source, settings: settings(image, scene.lighting.illuminance_lx) })
    }
}

/// Luminance of the grey to which the eye adapts, and of the background, relative to a perfect white.
const GREY: f64 = 0.2;

fn settings(image: &Image, illuminance_lx: f64) -> ImageSettings {
    ImageSettings {
        intent: match image.intent.value {
            ImageIntent::Relative => Intent::Relative,
            ImageIntent::Perceptual => Intent::Perceptual,
            ImageIntent::Absolute => Intent::Absolute,
            ImageIntent::Clip => Intent::Clip,
        },
        space: match image.map_space.value {
            ImageMapSpace::Oklab => MapSpace::Oklab,
            ImageMapSpace::Cam16Ucs => MapSpace::Cam16Ucs(Viewing {
                adapting_luminance_cd_m2: GREY * illuminance_lx / PI,
                background: GREY,
                surround: Surround::Average,
            }),
        },
        halftone: match image.halftone.value {
            ImageHalftone::None => Halftone::None,
            ImageHalftone::Ordered => Halftone::Ordered,
            ImageHalftone::VoidAndCluster => Halftone::VoidAndCluster,
            ImageHalftone::ErrorDiffusion => Halftone::ErrorDiffusion,
            ImageHalftone::DirectBinarySearch => Halftone::DirectBinarySearch,
        },
        kernel: match image.kernel.value {
            ErrorKernel::FloydSteinberg => DiffusionKernel::FloydSteinberg,
            ErrorKernel::Jarvis => DiffusionKernel::Jarvis,
            ErrorKernel::Stucki => DiffusionKernel::Stucki,
            ErrorKernel::Sierra => DiffusionKernel::Sierra,
            ErrorKernel::SierraLite => DiffusionKernel::SierraLite,
            ErrorKernel::Burkes => DiffusionKernel::Burkes,
        },
        scan: match image.scan.value {
            ErrorScan::Serpentine => Scan::Serpentine,
            ErrorScan::Raster => Scan::Raster,
        },
        seed: image.seed.0,
        states: image.states.iter().map(|state| state.0.clone()).collect(),
        surround: match image.surround.value {
            ImageSurround::Repeat => PictureSurround::Repeat,
            ImageSurround::BlackMask => PictureSurround::BlackMask,
        },
        perspective: image.perspective.value,
        samples_per_pixel: image.samples_per_pixel.0 as usize,
        given: None,
        prepared_for: None,
    }
}
