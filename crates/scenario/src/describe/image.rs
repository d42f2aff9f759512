//! `[image]`: a picture, and how it is brought to the panel, for `papilio image`.

use papilio_colour::mapping::Intent;
use papilio_display::image::{Halftone, Neutrals, PictureSurround};
use papilio_imaging::halftone::{DiffusionKernel, Scan};
use papilio_imaging::{Fit, TestPattern};

use super::Title;
use super::numbers::{ColourTemperature, Count, Factor, Millimetres, Points, Seed, Stops};
use crate::grammar::{choice, forms, table};
use crate::read::Spanned;
use crate::word::Word;

table! {
    /// A picture on the display, for `papilio image` only.
    Image {
        /// The picture: PNG, JPEG, SVG, OpenEXR or Radiance; also an argument of `papilio image`.
        file: Option<String>,
        /// Text in lines of the panel's width, black on white, with the bundled font; with a `file` both are
        /// a page. It needs `display.matrix.pixels`.
        text: Option<String>,
        /// Size of the text in points of 1/72 inch. Default: that at which the lower-case x is
        /// `viewer.text_height_mm` high, or 1.6 mm.
        text_size_pt as "Size of the text": Option<Points>,
        /// A test pattern of black and white, for `display.matrix.pixels`.
        pattern: Option<Word<TestPattern>>,
        /// Period of stripes and squares, and of the star at its rim. Default: 8 pixels; 36 spokes of the
        /// star.
        period_mm as "Period of the test pattern": Option<Millimetres>,
        /// How the picture is fitted to `display.matrix.pixels`, without which the panel has its size.
        fit: Word<Fit> = Word(Fit::Contain),
        /// Colour space of a picture that states none.
        source_space: SourceSpace = SourceSpace::Srgb,
        /// White, black and colours that the display cannot show.
        intent: Word<Intent> = Word(Intent::Natural),
        /// Exposure, stops: 1 doubles the light of the picture.
        exposure: Exposure = Exposure::Auto(Auto::Auto),
        /// Factor on the contrast of detail, for natural and vivid pictures.
        contrast as "Contrast of detail": Adjusted = Adjusted::Auto(Auto::Auto),
        /// Factor on chroma, for natural and vivid pictures.
        saturation: Adjusted = Adjusted::Auto(Auto::Auto),
        /// Light of the photograph that becomes white, by its correlated colour temperature.
        white_balance: WhiteBalance = WhiteBalance::Word(BalanceWord::Auto),
        /// Space in which mapped colours keep their hue.
        map_space: ImageMapSpace = ImageMapSpace::Oklab,
        /// Which parts are drawings: `"auto"` finds them in natural and vivid pictures, `"photograph"` and
        /// `"drawing"` are for all of it, and a file is a mask: black for drawings, white for photographs, of
        /// the size of the panel or with the proportions of the picture.
        regions as "Drawings": String = "auto".to_owned(),
        /// Which states show neutral colours.
        neutrals as "Neutral colours": Word<Neutrals> = Word(Neutrals::All),
        /// How pixels with few states show many colours.
        halftone: Word<Halftone> = Word(Halftone::RefinedErrorDiffusion),
    /// Weights of error diffusion.
        kernel: Word<DiffusionKernel> = Word(DiffusionKernel::FloydSteinberg),
    /// Order of the pixels in error diffusion.
        scan: Word<Scan> = Word(Scan::Serpentine),
        /// Seed of the void-and-cluster mask.
        seed: Seed = Count(0),
        /// States that are used, in the order of the palette of states.png. Default: all.
        states: Vec<Spanned<Title>> = Vec::new(),
        /// The light for which the states are decided: `"this"`, a preset, or a CIE illuminant as the
        /// spectrum of this light; a list is a compromise for all of them.
        prepared_for: DecidedFor = DecidedFor::One("this".to_owned()),
        /// Whether the eye at `viewer.distance_mm` sees each part of the panel in its own direction (with
        /// `display.matrix`).
        perspective: bool = true,
        /// Samples along each side of a pixel in seen.png and seen.exr; above 1, sub-pixels are seen at their
        /// places.
        samples_per_pixel as "Samples along a pixel": Count<1, 32> = Count(1),
        /// What lies beyond the borders of the picture.
        surround: Word<PictureSurround> = Word(PictureSurround::BlackMask),
    }
}

choice! {
    for PictureSurround {
        /// The picture again: its borders see the opposite ones.
        Repeat = "repeat",
        /// A mask that reflects no light.
        BlackMask = "black mask",
    }
}

choice! {
    for TestPattern {
        /// Black on the left of an edge 5 deg from the columns.
        SlantedEdge = "slanted-edge",
        /// Along y, half of a period each.
        Stripes = "stripes",
        /// Squares of half a period.
        Checker = "checker",
        /// A star of black spokes.
        Siemens = "siemens",
    }
}

choice! {
    for Fit {
        /// All of it, with white margins.
        Contain = "contain",
        /// The whole panel; the picture is cut.
        Cover = "cover",
        /// All of it on the whole panel, distorted.
        Stretch = "stretch",
        /// Pixel by pixel.
        None = "none",
    }
}

forms! {
    /// Lights for which states are decided.
    DecidedFor, "the name of a light, or a list of such"; {
        /// One light.
        One(String) if Value::Text(_),
        /// A compromise for several lights.
        List(Vec<Spanned<String>>) if Value::Array(_),
    }
}

choice! {
    /// Colour space of a picture.
    SourceSpace {
        /// IEC 61966-2-1.
        Srgb = "srgb",
        /// Display P3.
        DisplayP3 = "display-p3",
        /// ITU-R BT.2020.
        Rec2020 = "rec2020",
    }
}

choice! {
    /// A value that is chosen for the picture.
    Auto {
        /// Chosen for the picture.
        Auto = "auto",
    }
}

choice! {
    /// A white balance in a word.
    BalanceWord {
        /// As the picture states.
        Auto = "auto",
        /// As the picture states.
        None = "none",
    }
}

forms! {
    /// An exposure: stops, or "auto".
    Exposure, format!("{}, or \"auto\": up to one stop more for a photograph without light tones", Stops::in_words()); {
        /// Chosen for the picture.
        Auto(Auto) if Value::Text(_),
        /// Stops.
        Stops(Stops) if Value::Integer(_) | Value::Float(_),
    }
}

forms! {
    /// A factor, or "auto".
    Adjusted, format!("{}, or \"auto\": chosen for the picture", Factor::in_words()); {
        /// Chosen for the picture.
        Auto(Auto) if Value::Text(_),
        /// A factor.
        Factor(Factor) if Value::Integer(_) | Value::Float(_),
    }
}

forms! {
    /// A white balance: a colour temperature, or "auto" or "none".
    WhiteBalance, format!("{}, or \"auto\" or \"none\": as the picture states", ColourTemperature::in_words()); {
        /// As the picture states.
        Word(BalanceWord) if Value::Text(_),
        /// A correlated colour temperature.
        Kelvin(ColourTemperature) if Value::Integer(_) | Value::Float(_),
    }
}

choice! {
    for Intent {
        /// For photographs: light tones stay, dark ones bend towards the display's black; colours outside its
        /// gamut become the closest inside.
        Natural = "natural",
        /// As natural, darker and with more chroma and contrast.
        Vivid = "vivid",
        /// White and black become those of the display in linear light; colours outside its gamut lose
        /// chroma.
        Relative = "relative",
        /// As relative, but white is a perfect white in the light.
        Absolute = "absolute",
        /// As relative, but colours outside become the nearest inside.
        Clip = "clip",
    }
}

choice! {
    /// Space with constant hue.
    ImageMapSpace {
        /// Relative to the white of the display.
        Oklab = "oklab",
        /// Relative to the white of the display, in the luminance of the scene.
        Cam16Ucs = "cam16-ucs",
    }
}

choice! {
    for Neutrals {
        /// All states: finest.
        All = "all",
        /// Black, white and greys: no coloured dots.
        BlackAndWhite = "black-and-white",
    }
}

choice! {
    for Halftone {
        /// Every pixel shows the colour itself, a reference.
        None = "none",
        /// Each pixel has the state closest to its colour: no pattern.
        Nearest = "nearest",
        /// By Bayer's mask of 16 x 16 pixels.
        Ordered = "ordered",
        /// By a void-and-cluster mask of 64 x 64 pixels.
        VoidAndCluster = "void-and-cluster",
        /// The error of each pixel is passed on to its neighbours, in X, Y, Z.
        ErrorDiffusion = "error-diffusion",
        /// Error diffusion, then three passes of the search of `direct-binary-search`. Without `[display.matrix]`,
        /// and with `kernel` or `scan` but without `halftone`, it is error diffusion alone.
        RefinedErrorDiffusion = "refined-error-diffusion",
        /// The least that a reader at `viewer.distance_mm` sees of the pattern.
        DirectBinarySearch = "direct-binary-search",
    }
}

choice! {
    for DiffusionKernel {
        /// That of Floyd and Steinberg (1976).
        FloydSteinberg = "floyd-steinberg",
        /// That of Jarvis, Judice and Ninke (1976).
        Jarvis = "jarvis",
        /// That of Stucki (1981).
        Stucki = "stucki",
        /// That of Sierra (1989).
        Sierra = "sierra",
        /// That of Sierra's Filter Lite (1990), the quickest.
        SierraLite = "sierra-lite",
        /// That of Burkes (1988).
        Burkes = "burkes",
        /// That of Atkinson (1987), which loses a quarter of the error.
        Atkinson = "atkinson",
    }
}

choice! {
    for Scan {
        /// Every second row from right to left.
        Serpentine = "serpentine",
        /// Every row from left to right.
        Raster = "raster",
    }
}
