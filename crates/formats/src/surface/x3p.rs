//! Maps of heights in X3P files of ISO 25178-72: a zip archive with `main.xml` and, usually, the heights as a binary file.
//!
//! Lengths are in metres. Heights are numbers times the increment of the z axis, plus its offset; those of an integer type that are missing are
//! its smallest value, of a floating type NaN.

use std::io::{Cursor, Read};

use zip::read::ZipArchive;

use super::{HeightFile, SurfaceProblem, UM, damaged, sized};

/// Largest size of `main.xml`, which may contain the heights, bytes.
const LARGEST_XML: u64 = 64 << 20;

/// Largest number of files in the archive.
const MOST_FILES: usize = 1000;

fn wrong(what: impl Into<String>) -> SurfaceProblem {
    damaged("X3P", what)
}

/// Reads a map.
pub(super) fn read(bytes: &[u8]) -> Result<HeightFile, SurfaceProblem> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| wrong(error.to_string()))?;
    if archive.len() > MOST_FILES {
        return Err(wrong(format!("its archive has {} files", archive.len())));
    }
    let xml = content(&mut archive, "main.xml", LARGEST_XML)?;
    let xml = String::from_utf8(xml).map_err(|_| wrong("main.xml is not UTF-8"))?;
    let document = roxmltree::Document::parse(&xml).map_err(|error| wrong(format!("main.xml: {error}")))?;
    let text = |path: &[&str]| -> Option<String> {
        let node = path.iter().try_fold(document.root_element(), |node, name| child(node, name))?;
        Some(node.text().unwrap_or_default().trim().to_owned())
    };
    let number = |path: &[&str]| -> Result<f64, SurfaceProblem> {
        let found = text(path).and_then(|text| text.parse::<f64>().ok()).filter(|number| number.is_finite());
        found.ok_or_else(|| wrong(format!("main.xml has no number {}", path.join("/"))))
    };
    let count = |name: &str| -> Result<usize, SurfaceProblem> {
        let number = number(&["Record3", "MatrixDimension", name])?;
        let is_count = number.fract() == 0.0 && (0.0..=1e9).contains(&number);
        if is_count { Ok(number as usize) } else { Err(wrong(format!("{name} is {number}"))) }
    };
    let (columns, rows) = (count("SizeX")?, count("SizeY")?);
    let total = sized(columns, rows)?;
    if count("SizeZ")? != 1 {
        return Err(wrong("it has several layers (expected SizeZ 1)"));
    }
    if text(&["Record1", "Axes", "CX", "AxisType"]).as_deref() != Some("I") {
        return Err(wrong("its places are not those of a grid (expected axes of type I)"));
    }
    let increment = |axis: &str| -> Result<f64, SurfaceProblem> {
        let number = number(&["Record1", "Axes", axis, "Increment"])?;
        if number > 0.0 { Ok(number) } else { Err(wrong(format!("the increment of {axis} is {number} m"))) }
    };
    let pitch_um = [UM * increment("CX")?, UM * increment("CY")?];
    // Axes of absolute numbers need no increment.
    let scale = increment("CZ").unwrap_or(1.0);
    let offset = number(&["Record1", "Axes", "CZ", "Offset"]).unwrap_or(0.0);
    let kind = text(&["Record1", "Axes", "CZ", "DataType"]).unwrap_or_default();
    let numbers = match text(&["Record3", "DataLink", "PointDataLink"]) {
        Some(name) => {
            let size = size_of(&kind)?;
            let data = content(&mut archive, &name, (size * total) as u64)?;
            of_bytes(&kind, &data)
        }
        None => of_texts(&document)?,
    };
    if numbers.len() != total {
        return Err(wrong(format!("it has {} heights, and its dimensions {total}", numbers.len())));
    }
    let numbers = numbers.into_iter().map(|number| UM * (offset + scale * number)).collect();
    // Rows begin at y = 0, and here at the top.
    let mut map =
        HeightFile { columns, pitch_um: Some(pitch_um), unit_um: Some(1.0), is_picture: false, numbers };
    map.numbers = map.numbers.chunks_exact(columns).rev().flatten().copied().collect();
    Ok(map)
}

/// The first child of this name, in any name space.
fn child<'a, 'b>(node: roxmltree::Node<'a, 'b>, name: &str) -> Option<roxmltree::Node<'a, 'b>> {
    node.children().find(|child| child.tag_name().name() == name)
}

/// Content of a file of the archive, of at most this size.
fn content(
    archive: &mut ZipArchive<Cursor<&[u8]>>,
    name: &str,
    most: u64,
) -> Result<Vec<u8>, SurfaceProblem> {
    let file = archive.by_name(name).map_err(|error| wrong(format!("{}: {error}", name.escape_debug())))?;
    let mut bytes = Vec::new();
    file.take(most + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| wrong(format!("{}: {error}", name.escape_debug())))?;
    if bytes.len() as u64 > most {
        return Err(wrong(format!("{} is larger than the dimensions of the map say", name.escape_debug())));
    }
    Ok(bytes)
}

/// Bytes of a number of a type.
fn size_of(kind: &str) -> Result<usize, SurfaceProblem> {
    match kind {
        "I" => Ok(2),
        "L" | "F" => Ok(4),
        "D" => Ok(8),
        other => Err(wrong(format!(
            "the type of its heights is `{}` (expected I, L, F or D)",
            other.escape_debug()
        ))),
    }
}

/// Numbers of a binary file, little-endian.
fn of_bytes(kind: &str, data: &[u8]) -> Vec<f64> {
    match kind {
        "I" => {
            let value = |b: &[u8; 2]| match i16::from_le_bytes(*b) {
                i16::MIN => f64::NAN,
                value => f64::from(value),
            };
            data.as_chunks().0.iter().map(value).collect()
        }
        "L" => {
            let value = |b: &[u8; 4]| match i32::from_le_bytes(*b) {
                i32::MIN => f64::NAN,
                value => f64::from(value),
            };
            data.as_chunks().0.iter().map(value).collect()
        }
        "F" => data.as_chunks().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).collect(),
        _ => data.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect(),
    }
}

/// Heights in `main.xml`: an element `Datum` for each, `x;y;z` or `z`, empty where it is missing.
fn of_texts(document: &roxmltree::Document<'_>) -> Result<Vec<f64>, SurfaceProblem> {
    let data = document.descendants().filter(|node| node.tag_name().name() == "Datum");
    let number = |node: roxmltree::Node<'_, '_>| {
        let text = node.text().unwrap_or_default();
        let last = text.rsplit(';').next().unwrap_or_default().trim();
        if last.is_empty() { Ok(f64::NAN) } else { last.parse::<f64>() }
    };
    data.map(number).collect::<Result<_, _>>().map_err(|_| wrong("a Datum of main.xml is not a number"))
}
