//! Maps of heights in X3P files of ISO 25178-72: a zip archive with `main.xml` and, usually, the heights as a
//! binary file.
//!
//! Both revisions, of ISO 5436-2 and ISO 25178-72, are read in the same way. Lengths are in metres. Heights
//! are numbers times the increment of the z axis, plus its offset, by rows from the lowest y. Missing ones
//! have a 0 in the mask, and are the smallest value of an integer type, NaN of a floating type, or an empty
//! element.

use papilio_diagnostics::Diagnostic;

use super::archive::{Archive, document};
use super::bytes::{Bytes, Kind};
use super::{HeightFile, UM, damaged, sized};

/// Largest size of `main.xml`, which may contain the heights, bytes.
const LARGEST_XML: u64 = 64 << 20;

fn wrong(what: impl Into<String>) -> Diagnostic {
    damaged("X3P", what)
}

/// Reads a map.
pub(super) fn read(archive: &mut Archive<'_>) -> Result<HeightFile, Diagnostic> {
    let xml = archive.content("main.xml", LARGEST_XML)?;
    let xml = String::from_utf8(xml).map_err(|_| wrong("main.xml is not UTF-8"))?;
    let document = document(&xml).map_err(|error| wrong(format!("main.xml: {error}")))?;
    let main = Main { document: &document };
    main.check_kind()?;
    let (columns, rows) = (main.count("SizeX")?, main.count("SizeY")?);
    let total = sized(columns, rows)?;
    if main.count("SizeZ")? != 1 {
        return Err(wrong("it has several layers (expected SizeZ 1)"));
    }
    let pitch_um = [UM * main.increment("CX")?, UM * main.increment("CY")?];
    // Axes of absolute numbers need no increment.
    let scale_m = main.increment("CZ").unwrap_or(1.0);
    let offset_m = main.number(&["Record1", "Axes", "CZ", "Offset"]).unwrap_or(0.0);
    let kind = main.text(&["Record1", "Axes", "CZ", "DataType"]).unwrap_or_default();
    let numbers = match main.text(&["Record3", "DataLink", "PointDataLink"]) {
        Some(name) => {
            let kind = kind_of(&kind)?;
            let data = archive.content(&name, (kind.size() * total) as u64)?;
            let numbers = Bytes { all: &data, format: "X3P" }.numbers(0, data.len() / kind.size(), kind)?;
            // The smallest integer marks a missing height.
            let missing = Some(kind.ends()[0]).filter(|_| matches!(kind, Kind::I16 | Kind::I32));
            numbers
                .into_iter()
                .map(|number| if Some(number) == missing { f64::NAN } else { number })
                .collect()
        }
        None => of_texts(&document)?,
    };
    if numbers.len() != total {
        return Err(wrong(format!("it has {} heights, and its dimensions {total}", numbers.len())));
    }
    let mut map = HeightFile::plain(columns, numbers);
    if let Some(name) = main.text(&["Record3", "DataLink", "ValidPointsLink"]) {
        let mask = archive.content(&name, total.div_ceil(8) as u64)?;
        mask_out(&mut map.numbers, &mask)?;
    }
    if main.is_rotated() {
        map.warnings.push(
            "the rotation of the axes in this X3P file is not used: heights are taken along z of the file"
                .to_owned(),
        );
    }
    (map.pitch_um, map.unit_um) = (Some(pitch_um), Some(UM * scale_m));
    // Markers of missing heights stand for themselves before the offset.
    if offset_m != 0.0 {
        map.numbers.iter_mut().for_each(|number| *number += offset_m / scale_m);
    }
    Ok(map)
}

/// `main.xml`.
struct Main<'a, 'b> {
    document: &'a roxmltree::Document<'b>,
}

impl Main<'_, '_> {
    fn text(&self, path: &[&str]) -> Option<String> {
        let node = path.iter().try_fold(self.document.root_element(), |node, name| child(node, name))?;
        Some(node.text().unwrap_or_default().trim().to_owned())
    }

    fn number(&self, path: &[&str]) -> Result<f64, Diagnostic> {
        let found =
            self.text(path).and_then(|text| text.parse::<f64>().ok()).filter(|number| number.is_finite());
        found.ok_or_else(|| wrong(format!("main.xml has no number {}", path.join("/"))))
    }

    fn count(&self, name: &str) -> Result<usize, Diagnostic> {
        let number = self.number(&["Record3", "MatrixDimension", name])?;
        let is_count = number.fract() == 0.0 && (0.0..=1e9).contains(&number);
        if is_count { Ok(number as usize) } else { Err(wrong(format!("{name} is {number}"))) }
    }

    fn increment(&self, axis: &str) -> Result<f64, Diagnostic> {
        let number = self.number(&["Record1", "Axes", axis, "Increment"])?;
        if number > 0.0 { Ok(number) } else { Err(wrong(format!("the increment of {axis} is {number} m"))) }
    }

    /// Fails for profiles, clouds of points, and places that are no grid.
    fn check_kind(&self) -> Result<(), Diagnostic> {
        match self.text(&["Record1", "FeatureType"]).as_deref() {
            Some("PRF") => {
                return Err(wrong("it holds a profile (FeatureType PRF; expected a surface, SUR)"));
            }
            Some("PCL") => {
                return Err(wrong("it holds a cloud of points (FeatureType PCL; expected a surface, SUR)"));
            }
            _ => {}
        }
        // Dimensions are missing in files that are no map, which says more than an axis.
        self.count("SizeX")?;
        for axis in ["CX", "CY"] {
            if self.text(&["Record1", "Axes", axis, "AxisType"]).as_deref() != Some("I") {
                return Err(wrong(format!(
                    "its places along {axis} are not those of a grid (expected axes of type I)"
                )));
            }
        }
        Ok(())
    }

    /// Whether the axes are rotated.
    fn is_rotated(&self) -> bool {
        ["r11", "r22", "r33"].iter().any(|name| {
            let entry = self.number(&["Record1", "Axes", "Rotation", name]);
            entry.is_ok_and(|entry| (entry - 1.0).abs() > 1e-9)
        })
    }
}

/// Removes heights whose bit is 0: a bit for each height, the lowest bit of a byte first.
fn mask_out(numbers: &mut [f64], mask: &[u8]) -> Result<(), Diagnostic> {
    if mask.len() != numbers.len().div_ceil(8) {
        return Err(wrong(format!("its mask has {} bytes for {} heights", mask.len(), numbers.len())));
    }
    for (at, number) in numbers.iter_mut().enumerate() {
        if mask[at / 8] >> (at % 8) & 1 == 0 {
            *number = f64::NAN;
        }
    }
    Ok(())
}

/// The first child of this name, in any name space.
fn child<'a, 'b>(node: roxmltree::Node<'a, 'b>, name: &str) -> Option<roxmltree::Node<'a, 'b>> {
    node.children().find(|child| child.tag_name().name() == name)
}

/// The type of numbers by its letter.
fn kind_of(kind: &str) -> Result<Kind, Diagnostic> {
    match kind {
        "I" => Ok(Kind::I16),
        "L" => Ok(Kind::I32),
        "F" => Ok(Kind::F32),
        "D" => Ok(Kind::F64),
        other => Err(wrong(format!(
            "the type of its heights is `{}` (expected I, L, F or D)",
            other.escape_debug()
        ))),
    }
}

/// Heights in `main.xml`: an element `Datum` for each, `x;y;z` or `z`, empty where it is missing.
fn of_texts(document: &roxmltree::Document<'_>) -> Result<Vec<f64>, Diagnostic> {
    let data = document.descendants().filter(|node| node.tag_name().name() == "Datum");
    let number = |node: roxmltree::Node<'_, '_>| {
        let text = node.text().unwrap_or_default();
        let last = text.rsplit(';').next().unwrap_or_default().trim();
        if last.is_empty() { Ok(f64::NAN) } else { last.parse::<f64>() }
    };
    data.map(number).collect::<Result<_, _>>().map_err(|_| wrong("a Datum of main.xml is not a number"))
}
