//! Numbers at places of a binary file, little-endian.

use papilio_diagnostics::Diagnostic;

use super::damaged;

/// A binary file of a format.
#[derive(Clone, Copy)]
pub(super) struct Bytes<'a> {
    pub(super) all: &'a [u8],
    pub(super) format: &'static str,
}

impl<'a> Bytes<'a> {
    /// Bytes from a place on.
    ///
    /// # Errors
    /// If the file ends before.
    pub(super) fn part(&self, at: usize, length: usize) -> Result<&'a [u8], Diagnostic> {
        let part = at.checked_add(length).and_then(|end| self.all.get(at..end));
        part.ok_or_else(|| {
            self.wrong(format!(
                "it ends within its contents: {length} bytes are expected at byte {at}, and it has {}",
                self.all.len()
            ))
        })
    }

    fn array<const N: usize>(&self, at: usize) -> Result<[u8; N], Diagnostic> {
        let mut array = [0; N];
        array.copy_from_slice(self.part(at, N)?);
        Ok(array)
    }

    pub(super) fn i16(&self, at: usize) -> Result<i16, Diagnostic> {
        Ok(i16::from_le_bytes(self.array(at)?))
    }

    pub(super) fn u16(&self, at: usize) -> Result<usize, Diagnostic> {
        Ok(usize::from(u16::from_le_bytes(self.array(at)?)))
    }

    pub(super) fn i32(&self, at: usize) -> Result<i32, Diagnostic> {
        Ok(i32::from_le_bytes(self.array(at)?))
    }

    pub(super) fn u32(&self, at: usize) -> Result<usize, Diagnostic> {
        Ok(u32::from_le_bytes(self.array(at)?) as usize)
    }

    pub(super) fn f32(&self, at: usize) -> Result<f64, Diagnostic> {
        Ok(f64::from(f32::from_le_bytes(self.array(at)?)))
    }

    pub(super) fn f64(&self, at: usize) -> Result<f64, Diagnostic> {
        Ok(f64::from_le_bytes(self.array(at)?))
    }

    /// A text of a fixed length in Latin-1, up to its first zero, without blanks around it.
    pub(super) fn text(&self, at: usize, length: usize) -> Result<String, Diagnostic> {
        let part = self.part(at, length)?;
        let text: String = part.iter().take_while(|byte| **byte != 0).map(|byte| char::from(*byte)).collect();
        Ok(text.trim().to_owned())
    }

    /// Numbers of a type from a place on.
    pub(super) fn numbers(&self, at: usize, count: usize, kind: Kind) -> Result<Vec<f64>, Diagnostic> {
        let size = kind.size();
        let part = self.part(at, count.saturating_mul(size))?;
        Ok(part.chunks_exact(size).map(|bytes| kind.number(bytes)).collect())
    }

    pub(super) fn wrong(&self, what: impl Into<String>) -> Diagnostic {
        damaged(self.format, what)
    }
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    U8,
    U16,
    U32,
    I8,
    I16,
    I32,
    F32,
    F64,
}

impl Kind {
    pub(super) fn size(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Smallest and largest number.
    pub(super) fn ends(self) -> [f64; 2] {
        match self {
            Self::U8 => [0.0, f64::from(u8::MAX)],
            Self::U16 => [0.0, f64::from(u16::MAX)],
            Self::U32 => [0.0, f64::from(u32::MAX)],
            Self::I8 => [i8::MIN, i8::MAX].map(f64::from),
            Self::I16 => [i16::MIN, i16::MAX].map(f64::from),
            Self::I32 => [i32::MIN, i32::MAX].map(f64::from),
            Self::F32 => [f32::MIN, f32::MAX].map(f64::from),
            Self::F64 => [f64::MIN, f64::MAX],
        }
    }

    /// The number in as many bytes as the type has.
    fn number(self, bytes: &[u8]) -> f64 {
        let mut all = [0; 8];
        for (to, from) in all.iter_mut().zip(bytes) {
            *to = *from;
        }
        let [a, b, c, d, ..] = all;
        match self {
            Self::U8 => f64::from(a),
            Self::I8 => f64::from(a.cast_signed()),
            Self::U16 => f64::from(u16::from_le_bytes([a, b])),
            Self::I16 => f64::from(i16::from_le_bytes([a, b])),
            Self::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            Self::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            Self::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            Self::F64 => f64::from_le_bytes(all),
        }
    }
}
