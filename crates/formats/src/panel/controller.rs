//! The codes of states of the usual controllers, from published drivers.

use super::Packing;

/// How a controller numbers the states of its panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Controller {
    /// Name in scenario files.
    pub name: &'static str,
    /// Kind of the panel.
    pub panel: &'static str,
    /// Code of each state that it has.
    pub codes: &'static [(&'static str, u8)],
    /// How its codes become bytes.
    pub packing: Packing,
    /// The published drivers that have these codes: repository, file.
    pub source: &'static str,
}

/// All controllers; a further one is a further item.
#[rustfmt::skip]
pub const CONTROLLERS: &[Controller] = &[
    Controller {
        name: "black-white",
        panel: "black and white",
        codes: &[("black", 0), ("white", 1)],
        packing: Packing::Bits(1),
        source: "waveshareteam/e-Paper, epd4in2_V2.py (getbuffer)",
    },
    Controller {
        name: "black-white-red",
        panel: "black, white and red or yellow",
        codes: &[("black", 0), ("white", 1), ("red", 3), ("yellow", 3)],
        packing: Packing::Planes(2),
        source: "pimoroni/inky, inky_ssd1683.py (show)",
    },
    Controller {
        name: "four-grey",
        panel: "four greys of a black and white panel",
        codes: &[("black", 0), ("dark_grey", 1), ("light_grey", 2), ("white", 3)],
        packing: Packing::Bits(2),
        source: "waveshareteam/e-Paper, epd4in2_V2.py (getbuffer_4Gray)",
    },
    Controller {
        name: "it8951",
        panel: "four of the 16 greys of an IT8951",
        codes: &[("black", 0), ("dark_grey", 5), ("light_grey", 10), ("white", 15)],
        packing: Packing::Bits(4),
        source: "m5stack/M5EPD, M5EPD_Driver.cpp (WritePartGram4bpp)",
    },
    Controller {
        name: "four-colour",
        panel: "black, white, yellow and red",
        codes: &[("black", 0), ("white", 1), ("yellow", 2), ("red", 3)],
        packing: Packing::Bits(2),
        source: "waveshareteam/e-Paper, epd7in3g.py (getbuffer)",
    },
    Controller {
        name: "spectra-6",
        panel: "six colours (E Ink Spectra 6)",
        codes: &[("black", 0), ("white", 1), ("yellow", 2), ("red", 3), ("blue", 5), ("green", 6)],
        packing: Packing::Bits(4),
        source: "waveshareteam/e-Paper, epd7in3e.py; pimoroni/inky, inky_e673.py",
    },
    Controller {
        name: "acep-7",
        panel: "seven colours (E Ink Gallery, ACeP; UC8159)",
        codes: &[
            ("black", 0), ("white", 1), ("green", 2), ("blue", 3), ("red", 4), ("yellow", 5), ("orange", 6),
        ],
        packing: Packing::Bits(4),
        source: "waveshareteam/e-Paper, EPD_5in65f.h; pimoroni/inky, inky_uc8159.py",
    },
];

impl Controller {
    /// Returns the code of a state; `None` if the controller does not have it.
    pub fn code(&self, state: &str) -> Option<u8> {
        self.codes.iter().find(|(name, _)| *name == state).map(|(_, code)| *code)
    }
}
