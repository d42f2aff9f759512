//! `[display.matrix]`: the sub-pixels in the plane of the panel, and a colour filter above them.

use super::display::ShareSpectrum;
use super::numbers::{Count, Fraction, Micrometres, Pitch, PixelsPerInch};
use crate::grammar::{choice, forms, table};
use crate::read::{Named, Spanned};

table! {
    /// The sub-pixels in the plane of the panel: one pixel, which repeats.
    Matrix {
        /// Period of a whole pixel along x and y; or `ppi`.
        pitch_um as "Pixel pitch": Option<Period>,
        /// Pixels per inch: the pitch is 25400/ppi um; or `pitch_um`.
        ppi as "Pixels per inch": Option<PixelsPerInch>,
        /// Columns and rows of the display; only pictures need them. Default: that of the picture.
        pixels: Option<Vec<Spanned<PixelCount>>>,
        /// Arrangement of the sub-pixels. Default: `"stripe"`, unless rectangles are given.
        layout: Option<Layout>,
        /// Rectangles of each sub-pixel instead of a layout: `[x0, y0, x1, y1]` from the lower left corner of
        /// the pixel. The rest is inactive. Default: the layout.
        subpixel as "Sub-pixel rectangles": Option<Named<Vec<Spanned<Vec<Spanned<Fraction>>>>>>,
        /// The rectangles from a CSV file with the columns name, x0, y0, x1, y1. Default: the layout.
        subpixel_file: Option<String>,
        /// A colour filter above the pixels, with the same rectangles. Default: none.
        filter: Option<Filter>,
        /// With a filter, the states of the display: the state of the pixel below each part of the filter.
        /// Default: the eight usual states, if the filter has red, green and blue, and the pixel has white
        /// and black.
        states: Option<Named<Named<String>>>,
    }
}

/// Number of columns or rows.
pub(crate) type PixelCount = Count<1, 65536>;

forms! {
    /// The period of the pixels: a number, or `[x, y]`.
    Period, format!("{}, or a list of two, along x and y", <Pitch as crate::read::Read>::in_words()); {
        /// The same along x and y.
        Square(Pitch) if Value::Integer(_) | Value::Float(_),
        /// Along x and y.
        Oblong(Vec<Spanned<Pitch>>) if Value::Array(_),
    }
}

choice! {
    /// Arrangement of the sub-pixels of a pixel. Each has its area times the fill factor.
    Layout {
        /// Stripes of full height, left to right, in the order of the areas.
        Stripe = "stripe",
        /// Two rows of two; of three sub-pixels the third fills the lower row.
        Quad = "quad",
        /// Red and half of green above the other half of green and blue.
        PenTile = "pentile",
        /// Red and green above blue and white.
        Rgbw = "rgbw",
        /// A single sub-pixel.
        Single = "single",
    }
}

table! {
    /// A colour filter above the pixels, such as one printed on electronic paper.
    Filter {
        /// Height of the filter above the pixels, in the medium above them.
        height_um as "Height of the colour filter": Micrometres,
        /// Transmittance of each part of the filter, by the names of the sub-pixels, for one pass along the
        /// normal.
        transmittance: Named<ShareSpectrum>,
    }
}
