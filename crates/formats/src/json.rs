//! JSON output with indented objects, and arrays of numbers on one line.

use std::io::{self, BufWriter, Write};

use serde::Serialize;
use serde_json::ser::Formatter;

/// Writes `value` as readable, deterministic JSON: objects are indented, and
/// arrays of plain values are on one line. Numbers that are not finite become null.
///
/// # Errors
/// Those of `out`, and for values that JSON cannot represent.
pub fn write_json(out: impl Write, value: &impl Serialize) -> io::Result<()> {
    // The serializer writes each number and each comma by itself.
    let mut out = BufWriter::with_capacity(PIECE, out);
    value.serialize(&mut serde_json::Serializer::with_formatter(&mut out, Lines::default()))?;
    out.write_all(b"\n")?;
    out.flush()
}

/// Number of bytes that are written together.
const PIECE: usize = 1 << 16;

#[derive(Default)]
struct Lines {
    depth: usize,
    /// Whether the current object has a member.
    filled: bool,
}

impl Lines {
    fn new_line<W: ?Sized + Write>(&self, out: &mut W) -> io::Result<()> {
        out.write_all(b"\n")?;
        (0..self.depth).try_for_each(|_| out.write_all(b"  "))
    }
}

impl Formatter for Lines {
    fn begin_array_value<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        if first { Ok(()) } else { out.write_all(b", ") }
    }

    fn begin_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth += 1;
        self.filled = false;
        out.write_all(b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.depth -= 1;
        if self.filled {
            self.new_line(out)?;
        }
        out.write_all(b"}")
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        if !first {
            out.write_all(b",")?;
        }
        self.new_line(out)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(b": ")
    }

    fn end_object_value<W: ?Sized + Write>(&mut self, _out: &mut W) -> io::Result<()> {
        self.filled = true;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_with_nested_values_has_arrays_on_one_line_and_reads_back() {
        let value =
            serde_json::json!({"a": [1, 2.5, null], "b": {"c": [{"d": {}}, {"e": [1e-300]}]}, "f": []});
        let mut text = Vec::new();
        write_json(&mut text, &value).unwrap();
        assert_eq!(serde_json::from_slice::<serde_json::Value>(&text).unwrap(), value);
        let text = String::from_utf8(text).unwrap();
        assert!(text.contains("\n  \"a\": [1, 2.5, null],\n  \"b\": {\n    \"c\": [{"), "{text}");
    }
}
