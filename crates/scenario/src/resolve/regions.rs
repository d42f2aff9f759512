//! `image.regions`: which parts of a picture are drawings, in a word or by a mask.

use papilio_diagnostics::Diagnostic;
use papilio_display::image::{Regions, SourceImage};
use papilio_formats::{LARGEST_PICTURE_FILE, RgbSpace, Warned, read_picture};
use papilio_imaging::fitted;

use super::Resolver;
use crate::describe::image::Image;

/// Light of a mask below which it means a drawing.
const GREY: f32 = 0.5;

impl Resolver<'_> {
    /// The regions of the picture `source`, which is on the pixels of the panel.
    pub(super) fn regions(
        &mut self,
        image: &Image,
        given: Option<&SourceImage>,
        source: &SourceImage,
    ) -> Option<Regions> {
        match image.regions.value.as_str() {
            "auto" => Some(Regions::Auto),
            "photograph" => Some(Regions::Photograph),
            "drawing" => Some(Regions::Drawing),
            name => self.mask(name, image, given, source),
        }
    }

    /// A mask in a file, of the size of the panel or with the proportions of the picture.
    fn mask(
        &mut self,
        name: &str,
        image: &Image,
        given: Option<&SourceImage>,
        source: &SourceImage,
    ) -> Option<Regions> {
        let origin = image.regions.origin;
        let opened = self.open_within(name, origin, LARGEST_PICTURE_FILE)?;
        let mask = match read_picture(opened.file(), &RgbSpace::srgb()) {
            Ok(Warned { value: mask, .. }) => mask,
            Err(error) => {
                self.errors.push_data(origin, error);
                return None;
            }
        };
        let size = [mask.columns(), mask.rows()];
        let panel = [source.columns, source.pixels.len() / source.columns.max(1)];
        let picture = self.size_of_picture(image, given).unwrap_or(panel);
        // Sides that are whole numbers of pixels have proportions to half a pixel.
        let crossed = (size[0] * picture[1]).abs_diff(size[1] * picture[0]);
        if size != panel && 2 * crossed > size[0].max(picture[0]).max(size[1]).max(picture[1]) {
            let wrong = Diagnostic::new(format!(
                "the mask `{name}` has {} x {} pixels, and other proportions than the picture",
                size[0], size[1]
            ));
            let [columns, rows] = picture;
            let expected = format!(
                "the {} x {} pixels of the panel, or the proportions of the picture, {columns} x {rows}",
                panel[0], panel[1]
            );
            let hint =
                "draw it over the picture: black where it is a drawing, white where it is a photograph";
            self.err(&image.regions, wrong.expected(expected).hint(hint));
            return None;
        }
        // Margins are drawings: their white is the ink alone.
        let pixels = fitted(size, |row| mask.row(row), panel, image.fit.0, [0.0; 3]);
        Some(Regions::Given(pixels.iter().map(|pixel| pixel[1] < GREY).collect()))
    }
}
