//! `[image]`: settings, and the picture in linear light.

use papilio_display::image::{Halftone, ImageSettings, Intent, SourceImage};
use papilio_formats::{LARGEST_PICTURE_FILE, RgbSpace, read_picture};
use papilio_imaging::Fit;
use papilio_imaging::halftone::{DiffusionKernel, Scan};

use super::Resolver;
use crate::describe::File;
use crate::describe::image::{
    ErrorKernel, ErrorScan, Image, ImageFit, ImageHalftone, ImageIntent, SourceSpace,
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
    pub(super) fn image(&mut self, file: &File, known: &[String]) -> Option<ImageRequest> {
        let defaults;
        let image = match &file.image.value {
            Some(image) => image,
            None => {
                defaults = Image::read(&Node::empty_table(), &mut self.errors)?;
                &defaults
            }
        };
        for state in image.states.iter() {
            if !known.contains(&state.0) {
                self.err(state, mistake::no_such_state(&state.0, known));
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
        let mut pixels = Vec::with_capacity(picture.columns() * picture.rows());
        (0..picture.rows()).for_each(|row| pixels.extend(picture.row(row)));
        let source = SourceImage { columns: picture.columns(), pixels };
        Some(ImageRequest { source, settings: settings(image) })
    }
}

fn settings(image: &Image) -> ImageSettings {
    ImageSettings {
        fit: match image.fit.value {
            ImageFit::Contain => Fit::Contain,
            ImageFit::Cover => Fit::Cover,
            ImageFit::Stretch => Fit::Stretch,
            ImageFit::None => Fit::None,
        },
        intent: match image.intent.value {
            ImageIntent::Relative => Intent::Relative,
            ImageIntent::Absolute => Intent::Absolute,
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
    }
}
