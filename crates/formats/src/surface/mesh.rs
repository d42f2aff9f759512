//! Meshes of triangles: Wavefront OBJ, and STL in text or binary.
//!
//! The format is detected from the content. Numbers keep the unit of the file, which none of these formats
//! states. Of an OBJ file, vertices and faces are read; a face with more than three corners becomes triangles
//! around its first one. Normals of STL files are not read: the order of the corners states the side.

use papilio_diagnostics::{Diagnostic, Place};

use super::damaged;

use crate::DataFile;
use crate::error::FormatError;

/// Bytes of the head of a binary STL file, with its number of triangles; and of a triangle.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

/// A triangle: three corners, counterclockwise seen from outside.
type Triangle = [[f64; 3]; 3];

/// A mesh, in the unit of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFile {
    /// The triangles, each with three corners, counterclockwise seen from outside.
    pub triangles: Vec<[[f64; 3]; 3]>,
}

/// Reads a mesh.
///
/// # Errors
/// A file that is none of the formats; numbers that are not finite; faces of vertices that do not exist.
/// Errors of texts state the line, and those of binary files the byte.
pub fn read_mesh(file: &DataFile) -> Result<MeshFile, FormatError> {
    crate::guard::read(file, of_any_format)
}

fn not_a_mesh(what: &str) -> Diagnostic {
    Diagnostic::new(format!("this is not a mesh in a supported format: {what}"))
        .expected("a Wavefront OBJ file, or an STL file in text or binary")
}

fn of_any_format(file: &DataFile) -> Result<MeshFile, FormatError> {
    let bytes = file.bytes.as_slice();
    let whole = |problem: Diagnostic| FormatError::whole(&file.name, problem);
    // A text may begin with 80 bytes and a number as well, but its length is then another one.
    let count =
        bytes.get(80..HEAD).map(|four| four.iter().rev().fold(0, |sum, byte| sum << 8 | u64::from(*byte)));
    let is_binary = count.is_some_and(|count| bytes.len() as u64 == HEAD as u64 + TRIANGLE as u64 * count);
    let triangles = if is_binary {
        of_binary_stl(&bytes[HEAD..]).map_err(whole)?
    } else {
        let Ok(text) = file.text() else {
            let what = match count {
                Some(count) => format!(
                    "a binary file of {count} triangles has {} bytes, and this one has {}",
                    HEAD as u64 + TRIANGLE as u64 * count,
                    bytes.len()
                ),
                None => format!("it has {} bytes, and is no text", bytes.len()),
            };
            return Err(whole(not_a_mesh(&what)));
        };
        let lines = Lines { name: &file.name, text };
        if text.trim_start().starts_with("solid") { of_text_stl(lines)? } else { of_obj(lines)? }
    };
    if triangles.is_empty() {
        return Err(whole(not_a_mesh("it has no triangles")));
    }
    Ok(MeshFile { triangles })
}

/// A text and its name.
#[derive(Clone, Copy)]
struct Lines<'a> {
    name: &'a str,
    text: &'a str,
}

impl<'a> Lines<'a> {
    /// Lines that are not blank, each with the byte of its first word.
    fn all(self) -> impl Iterator<Item = (usize, &'a str)> {
        let lines = self.text.split_inclusive('\n').scan(0, |next, line| {
            let start = *next;
            *next += line.len();
            Some((start + line.len() - line.trim_start().len(), line.trim()))
        });
        lines.filter(|(_, line)| !line.is_empty())
    }

    /// An error about the line that begins at this byte.
    fn wrong(&self, format: &'static str, at: usize, what: impl Into<String>) -> FormatError {
        let end = self.text[at..].find(['\r', '\n']).map_or(self.text.len(), |end| at + end);
        let problem = damaged(format, what);
        FormatError { place: Place::in_text(self.name, self.text, at..end), problem: problem.into() }
    }
}

/// Three finite numbers; further ones, such as a weight or a colour, are not used.
fn place<'a>(words: impl Iterator<Item = &'a str>) -> Result<[f64; 3], String> {
    let mut found = [f64::NAN; 3];
    let mut words = words;
    for number in &mut found {
        let word = words.next().ok_or("three coordinates are expected here")?;
        *number = word.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| {
            let shown: String = word.chars().take(40).collect();
            format!("`{}` is not a finite number", shown.escape_debug())
        })?;
    }
    Ok(found)
}

fn of_obj(lines: Lines<'_>) -> Result<Vec<Triangle>, FormatError> {
    const FORMAT: &str = "OBJ";
    /// What else the format has: normals, textures, names, groups, materials, lines, points.
    const NOT_USED: [&str; 14] =
        ["vn", "vt", "vp", "o", "g", "s", "mg", "usemtl", "mtllib", "l", "p", "usemap", "maplib", "lod"];
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    let mut triangles = Vec::new();
    for (at, line) in lines.all().filter(|(_, line)| !line.starts_with('#')) {
        let wrong = |what: String| lines.wrong(FORMAT, at, what);
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => vertices.push(place(words).map_err(wrong)?),
            Some("f") => {
                let corners: Vec<[f64; 3]> =
                    words.map(|word| corner(word, &vertices)).collect::<Result<_, _>>().map_err(wrong)?;
                if corners.len() < 3 {
                    return Err(wrong(format!(
                        "a face has {} corners (expected three or more)",
                        corners.len()
                    )));
                }
                triangles.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
            }
            Some(word) if NOT_USED.contains(&word) => {}
            _ => {
                return Err(wrong(
                    "a line of an OBJ or STL file is expected here: v, f, vn, vt, o, g, s".to_owned(),
                ));
            }
        }
    }
    Ok(triangles)
}

/// A corner of an OBJ face: the number of its vertex, from 1, or from the last one if it is negative.
fn corner(word: &str, vertices: &[[f64; 3]]) -> Result<[f64; 3], String> {
    let number = word.split('/').next().and_then(|number| number.parse::<i64>().ok());
    let at = match number {
        Some(number) if number > 0 => Some(number - 1),
        Some(number) if number < 0 => (vertices.len() as i64).checked_add(number),
        _ => None,
    };
    let vertex = at.and_then(|at| usize::try_from(at).ok()).and_then(|at| vertices.get(at)).copied();
    vertex.ok_or_else(|| {
        let shown: String = word.chars().take(40).collect();
        format!("there is no vertex `{}` among the {} before this line", shown.escape_debug(), vertices.len())
    })
}

fn of_text_stl(lines: Lines<'_>) -> Result<Vec<Triangle>, FormatError> {
    const FORMAT: &str = "STL";
    let mut triangles = Vec::new();
    let mut corners: Vec<[f64; 3]> = Vec::new();
    let mut is_in_loop = false;
    let mut last = 0;
    for (at, line) in lines.all() {
        last = at;
        let wrong = |what: String| lines.wrong(FORMAT, at, what);
        let mut words = line.split_whitespace();
        match words.next().unwrap_or_default() {
            "vertex" if is_in_loop => corners.push(place(words).map_err(wrong)?),
            "outer" if !is_in_loop => is_in_loop = true,
            "endloop" if is_in_loop => {
                let Ok(triangle) = Triangle::try_from(std::mem::take(&mut corners)) else {
                    return Err(wrong("the loop that ends here does not have three vertices".to_owned()));
                };
                triangles.push(triangle);
                is_in_loop = false;
            }
            "solid" | "facet" | "endfacet" | "endsolid" if !is_in_loop => {}
            _ => {
                let expected =
                    if is_in_loop { "vertex or endloop" } else { "facet, outer loop, endfacet or endsolid" };
                return Err(wrong(format!("a line with {expected} is expected here")));
            }
        }
    }
    match is_in_loop {
        true => Err(lines.wrong(FORMAT, last, "the file ends within a loop")),
        false => Ok(triangles),
    }
}

fn of_binary_stl(bytes: &[u8]) -> Result<Vec<Triangle>, Diagnostic> {
    let mut triangles = Vec::with_capacity(bytes.len() / TRIANGLE);
    for (number, record) in bytes.chunks_exact(TRIANGLE).enumerate() {
        // Behind the normal.
        let (values, _) = record[12..48].as_chunks::<4>();
        let mut triangle = [[0.0; 3]; 3];
        for (k, value) in values.iter().enumerate() {
            let value = f32::from_le_bytes(*value);
            if !value.is_finite() {
                let at = HEAD + TRIANGLE * number + 12 + 4 * k;
                let what = format!("the coordinate at byte {at} is {value} (expected a finite number)");
                return Err(damaged("STL", what));
            }
            triangle[k / 3][k % 3] = f64::from(value);
        }
        triangles.push(triangle);
    }
    Ok(triangles)
}
