//! `[image]`: settings, and the picture in linear light.

use std::f64::consts::PI;

use papilio_colour::mapping::{Intent, MapSpace};
use papilio_colour::{D65_WHITE, Surround, Viewing};
use papilio_diagnostics::Diagnostic;
use papilio_display::image::{Halftone, ImageSettings, PictureSurround, SourceImage};
use papilio_display::scene::Scene;
use papilio_formats::{LARGEST_PICTURE_FILE, MOST_PICTURE_PIXELS, RgbSpace, read_picture};
use papilio_imaging::halftone::{DiffusionKernel, Scan};
use papilio_imaging::{Fit, fitted};

use super::Resolver;
use crate::describe::File;
use crate::describe::image::{
    ErrorKernel, ErrorScan, Image, ImageFit, ImageHalftone, ImageIntent, ImageMapSpace, ImageSurround,
    SourceSpace,
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
    /// Reads the picture of `[image]`; its states must be those of the display.
    pub(super) fn image(&mut self, file: &File, scene: &Scene) -> Option<ImageRequest> {
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
        let Some(name) = &image.file.value else {
            let mut wrong = mistake::missing_key("file", "a picture, PNG or JPEG");
            wrong.diagnostic =
                wrong.diagnostic.hint("papilio image SCENARIO PICTURE, or file = \"picture.png\" in [image]");
            self.errors.push(file.image.origin, wrong);
            return None;
        };
        let space = match image.source_space.value {
            SourceSpace::Srgb => RgbSpace::srgb(),
            SourceSpace::DisplayP3 => RgbSpace::display_p3(),
            SourceSpace::Rec2020 => RgbSpace::rec_2020(),
        };
        let origin = image.file.origin;
        let opened = self.open_within(name, origin, LARGEST_PICTURE_FILE)?;
        let picture = match read_picture(opened.file(), &space) {
            Ok(picture) => picture,
            Err(error) => {
                self.errors.push_data(origin, error);
                return None;
            }
        };
        self.notes.extend(picture.warnings.iter().map(|warning| format!("{name}: {warning}")));
        let picture = picture.value;
        let from = [picture.columns(), picture.rows()];
        let matrix = scene.display.matrix.as_ref();
        let to = matrix.and_then(|matrix| matrix.pixels).unwrap_or(from);
        let count = to[0].saturating_mul(to[1]);
        let key = file.display.matrix.value.as_ref().map_or(origin, |matrix| matrix.pixels.origin);
        if count > MOST_PICTURE_PIXELS {
            self.errors
                .push(key, mistake::too_many("pixels of a picture", count as f64, MOST_PICTURE_PIXELS));
            return None;
        }
        let margin = D65_WHITE.to_array().map(|value| value as f32);
        let pixels = fitted(from, |row| picture.row(row), to, fit(image.fit.value), margin);
        let source = SourceImage { columns: to[0], pixels };
        Some(ImageRequest { source, settings: settings(image, scene.lighting.illuminance_lx) })
    }
}

fn fit(fit: ImageFit) -> Fit {
    match fit {
        ImageFit::Contain => Fit::Contain,
        ImageFit::Cover => Fit::Cover,
        ImageFit::Stretch => Fit::Stretch,
        ImageFit::None => Fit::None,
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
            ImageHalftone::ErrorDiffusion => Halftone::ErrorDiffusion,
        },
        kernel: match image.kernel.value {
            ErrorKernel::FloydSteinberg => DiffusionKernel::FloydSteinberg,
            ErrorKernel::Jarvis => DiffusionKernel::Jarvis,
            ErrorKernel::Stucki => DiffusionKernel::Stucki,
            ErrorKernel::Sierra => DiffusionKernel::Sierra,
        },
        scan: match image.scan.value {
            ErrorScan::Serpentine => Scan::Serpentine,
            ErrorScan::Raster => Scan::Raster,
        },
        states: image.states.iter().map(|state| state.0.clone()).collect(),
        surround: match image.surround.value {
            ImageSurround::Repeat => PictureSurround::Repeat,
            ImageSurround::BlackMask => PictureSurround::BlackMask,
        },
    }
}
