//! From the state of each pixel to the bytes of a frame.

/// A number of bits for each pixel that does not hold a code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TooFewBits {
    /// The bits.
    pub bits: u8,
    /// The state with the largest code.
    pub state: String,
    /// Its code.
    pub code: u8,
}

impl TooFewBits {
    /// Largest code that the bits hold.
    pub fn largest(&self) -> u8 {
        u8::MAX >> (8 - self.bits.clamp(1, 8))
    }

    /// Bits that the code needs, and the fewest for a pixel.
    pub fn needed(&self) -> [u8; 2] {
        [bits_of(self.code), Packing::fewest(self.code).bits()]
    }
}

/// What is requested instead of the usual packing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RequestedPacking {
    /// This number of bits for each pixel, 1, 2, 4 or 8.
    Bits(u8),
    /// Planes of 1 bit for each pixel, as many as the codes need or the controller takes.
    Planes,
}

/// How the codes of a row become bytes. Rows begin with a byte of their own: the bits that remain in their
/// last byte are 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Packing {
    /// This number of bits for each pixel, 1, 2, 4 or 8; the first pixel has the highest bits of a byte.
    Bits(u8),
    /// This number of planes of 1 bit for each pixel, packed as above: the first plane has bit 0 of the codes,
    /// the next one bit 1, and so on.
    Planes(u8),
}

impl Packing {
    /// The fewest bits that hold all codes up to `largest`.
    pub fn fewest(largest: u8) -> Self {
        Self::Bits(bits_of(largest).next_power_of_two())
    }

    /// The packing that was requested, that of a controller, or the one of fewest bits.
    ///
    /// # Errors
    /// If the requested bits do not hold the largest of the `codes`.
    pub fn chosen(
        requested: Option<RequestedPacking>,
        usual: Option<Self>,
        codes: &[(String, u8)],
    ) -> Result<Self, TooFewBits> {
        let largest = codes.iter().max_by_key(|(_, code)| *code);
        let (state, code) = largest.map_or(("", 0), |(state, code)| (state, *code));
        let needed = bits_of(code);
        match (requested, usual) {
            (Some(RequestedPacking::Bits(bits)), _) if bits < needed => {
                Err(TooFewBits { bits, state: state.to_owned(), code })
            }
            (Some(RequestedPacking::Bits(bits)), _) => Ok(Self::Bits(bits)),
            (Some(RequestedPacking::Planes), Some(Self::Planes(planes))) => Ok(Self::Planes(planes)),
            (Some(RequestedPacking::Planes), _) => Ok(Self::Planes(needed)),
            (None, Some(usual)) => Ok(usual),
            (None, None) => Ok(Self::fewest(code)),
        }
    }

    /// Bits of a code that it holds.
    pub fn bits(self) -> u8 {
        match self {
            Self::Bits(bits) | Self::Planes(bits) => bits,
        }
    }

    /// Bits of a pixel in a row of bytes.
    pub fn bits_in_row(self) -> u8 {
        match self {
            Self::Bits(bits) => bits,
            Self::Planes(_) => 1,
        }
    }
}

/// Number of bits that a code needs, 1 to 8.
pub fn bits_of(code: u8) -> u8 {
    (8 - code.leading_zeros() as u8).max(1)
}

/// Number of bytes of a row of pixels.
pub fn row_bytes(columns: usize, bits: u8) -> usize {
    (columns * usize::from(bits)).div_ceil(8)
}

/// How the rows and columns of a panel are turned against the picture on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Mounting {
    /// Quarter turns of the frame, clockwise.
    pub quarter_turns: u8,
    /// Whether the turned frame is then mirrored left to right.
    pub is_mirrored: bool,
}

impl Mounting {
    /// Number of columns and rows after the turn.
    pub fn size(self, [columns, rows]: [usize; 2]) -> [usize; 2] {
        if self.quarter_turns % 2 == 1 { [rows, columns] } else { [columns, rows] }
    }

    /// The pixels of a picture of `size` in the rows and columns of the panel. Rows begin at the top.
    pub fn turned<T: Copy>(self, size: [usize; 2], pixels: &[T]) -> Vec<T> {
        let [columns, rows] = size;
        let [across, down] = self.size(size);
        let from = |x: usize, y: usize| {
            let x = if self.is_mirrored { across - 1 - x } else { x };
            let (column, row) = match self.quarter_turns % 4 {
                0 => (x, y),
                1 => (y, rows - 1 - x),
                2 => (columns - 1 - x, rows - 1 - y),
                _ => (columns - 1 - y, x),
            };
            row * columns + column
        };
        (0..down).flat_map(|y| (0..across).map(move |x| from(x, y))).map(|at| pixels[at]).collect()
    }
}

/// A picture as the code of each pixel, in the rows and columns of the panel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PanelFrame {
    /// Number of columns and rows.
    pub size: [usize; 2],
    /// Code of each pixel; rows begin at the top.
    pub codes: Vec<u8>,
}

impl PanelFrame {
    /// The frame of a picture: `states` has the state of each pixel, `codes` the code of each state. A state
    /// without a code gets 0.
    pub fn new(size: [usize; 2], states: &[u8], codes: &[u8], mounting: Mounting) -> Self {
        let code = |state: &u8| codes.get(usize::from(*state)).copied().unwrap_or(0);
        let codes: Vec<u8> = states.iter().map(code).collect();
        Self { size: mounting.size(size), codes: mounting.turned(size, &codes) }
    }

    /// The bytes of the frame. Bits of a code that do not fit are lost: ask [`Packing::bits`] before.
    pub fn packed(&self, packing: Packing) -> Vec<u8> {
        match packing {
            Packing::Bits(bits) => self.rows_of(bits, |code| code),
            Packing::Planes(planes) => {
                (0..planes).flat_map(|plane| self.rows_of(1, |code| code >> plane)).collect()
            }
        }
    }

    /// All rows, with this number of bits of a value for each pixel.
    fn rows_of(&self, bits: u8, value: impl Fn(u8) -> u8) -> Vec<u8> {
        let width = row_bytes(self.size[0], bits);
        let mut bytes = Vec::with_capacity(width * self.size[1]);
        for row in self.codes.chunks(self.size[0].max(1)) {
            let pixels_in_byte = usize::from(8 / bits);
            bytes.extend(row.chunks(pixels_in_byte).map(|pixels| {
                let largest = u8::MAX >> (8 - bits);
                let place = |at: usize| 8 - bits * (at as u8 + 1);
                let pixels = pixels.iter().enumerate();
                pixels.fold(0, |byte, (at, code)| byte | (value(*code) & largest) << place(at))
            }));
        }
        bytes
    }
}
