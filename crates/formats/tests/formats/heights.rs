//! Maps of heights in all formats, right and damaged ones.

mod fields;
mod files;
mod formats;
mod texts;

pub(crate) use formats::all as all_formats;

use std::io::{Cursor, Write};

use exr::prelude::{Encoding, Image, Layer, LayerAttributes, SpecificChannels, WritableImage};
use papilio_formats::{DataFile, HeightFile, read_heights};
use papilio_testing::Dice;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

fn read(bytes: Vec<u8>) -> Result<HeightFile, String> {
    read_heights(&DataFile { name: "map".to_owned(), bytes }).map_err(|error| error.to_string())
}

/// What a reader does with a field of a format's document.
#[derive(Debug, Clone, Copy)]
enum Done {
    /// The map changes.
    Used,
    /// A value that cannot be used is an error with these words.
    Refused(&'static str),
    /// The heights stay, and a warning has these words.
    Warned(&'static str),
    /// It is about the measurement, or about what no result depends on: nothing changes.
    Described,
}

/// A field, a change of it, and what is done with it.
type Field = (&'static str, fn(&mut Vec<u8>), Done);

fn set(bytes: &mut [u8], at: usize, part: &[u8]) {
    bytes[at..at + part.len()].copy_from_slice(part);
}

/// Replaces a part of a text.
fn replaced(bytes: &mut Vec<u8>, old: &str, new: &str) {
    let text = String::from_utf8(std::mem::take(bytes)).unwrap();
    assert!(text.contains(old), "{old}");
    *bytes = text.replacen(old, new, 1).into_bytes();
}

/// Checks what is done with each field of a file.
fn audit(base: &[u8], fields: &[Field]) {
    for (name, change, done) in fields {
        let mut changed = base.to_vec();
        change(&mut changed);
        check(name, base, &changed, *done);
    }
}

/// Checks what is done with a field that differs between two files.
fn check(field: &str, base: &[u8], changed: &[u8], done: Done) {
    let base = read(base.to_vec()).unwrap();
    let found = read(changed.to_vec());
    match (done, found) {
        (Done::Refused(words), Err(error)) => assert!(error.contains(words), "{field}: {error}"),
        (Done::Used, Ok(found)) => assert_ne!(found, base, "{field}"),
        (Done::Described, Ok(found)) => assert_eq!(found, base, "{field}"),
        (Done::Warned(words), Ok(found)) => {
            assert_eq!(found.numbers, base.numbers, "{field}");
            assert!(
                found.warnings.iter().any(|warning| warning.contains(words)),
                "{field}: {:?}",
                found.warnings
            );
        }
        (done, found) => panic!("{field}: {done:?}, and found {found:?}"),
    }
}

fn main_xml(kind: &str, size: [usize; 3], data: &str) -> String {
    let [x, y, z] = size;
    let axis = |name: &str, kind: &str, data: &str, step: &str| {
        format!(
            "<{name}><AxisType>{kind}</AxisType><DataType>{data}</DataType><Increment>{step}</Increment><Offset>0</Offset></{name}>"
        )
    };
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?><p:ISO5436_2 xmlns:p=\"http://www.opengps.eu/2008/ISO5436_2\"><Record1><Revision>ISO5436 - \
         2000</Revision><FeatureType>SUR</FeatureType><Axes>{}{}{}</Axes></Record1><Record3><MatrixDimension><SizeX>{x}</SizeX><SizeY>{y}</SizeY>\
         <SizeZ>{z}</SizeZ></MatrixDimension>{data}</Record3></p:ISO5436_2>",
        axis("CX", "I", "D", "1e-6"),
        axis("CY", "I", "D", "2e-6"),
        axis("CZ", "A", kind, "1e-9"),
    )
}

const LINK: &str = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>";

fn archive(xml: &str, data: &[u8]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in [("main.xml", xml.as_bytes()), ("bindata/data.bin", data)] {
        archive.start_file(name, SimpleFileOptions::default()).unwrap();
        archive.write_all(content).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// All types of heights, in a binary file or in the XML, are read in um, from the row of the lowest y on.
#[test]
fn x3p_files_are_read() {
    let nm = [100.0, 200.0, 300.0, 400.0, 500.0, 600.0];
    let um: Vec<f64> = nm.iter().map(|nm| 1e-3 * nm).collect();
    let shorts: Vec<u8> = nm.iter().flat_map(|nm| (*nm as i16).to_le_bytes()).collect();
    let longs: Vec<u8> = nm.iter().flat_map(|nm| (*nm as i32).to_le_bytes()).collect();
    let floats: Vec<u8> = nm.iter().flat_map(|nm| (*nm as f32).to_le_bytes()).collect();
    let list: String = nm.iter().map(|nm| format!("<Datum>0;0;{nm}</Datum>")).collect();
    let list = format!("<DataList>{list}</DataList>");
    for (kind, link, data) in [
        ("D", LINK, doubles(&nm)),
        ("I", LINK, shorts),
        ("L", LINK, longs),
        ("F", LINK, floats),
        ("D", &list, vec![]),
    ] {
        let map = read(archive(&main_xml(kind, [3, 2, 1], link), &data)).unwrap();
        assert_eq!((map.columns, map.numbers.len()), (3, 6));
        let pitch = map.pitch_um.unwrap();
        assert!((pitch[0] - 1.0).abs() < 1e-12 && (pitch[1] - 2.0).abs() < 1e-12);
        let found = map.numbers.iter().map(|number| number * map.unit_um.unwrap());
        assert!(found.zip(&um).all(|(a, b)| (a - b).abs() < 1e-9), "{kind}: {:?}", map.numbers);
    }
}

#[test]
fn wrong_x3p_files_are_refused() {
    let right = doubles(&[1.0; 6]);
    for (xml, data, expected) in [
        (main_xml("D", [3, 2, 1], LINK), right[..40].to_vec(), "5 heights, and its dimensions 6"),
        (main_xml("D", [3, 2, 1], LINK), doubles(&[1.0; 7]), "larger than the dimensions"),
        (main_xml("D", [90_000, 90_000, 1], LINK), right.clone(), "90000 x 90000 heights"),
        (main_xml("D", [3, 1, 2], LINK), right.clone(), "3 x 1 heights"),
        (main_xml("D", [3, 2, 4], LINK), right.clone(), "several layers"),
        (main_xml("Q", [3, 2, 1], LINK), right.clone(), "the type of its heights is `Q`"),
        (main_xml("D", [3, 2, 1], LINK).replace("1e-6", "0"), right.clone(), "the increment of CX is 0 m"),
        (main_xml("D", [3, 2, 1], LINK).replace("<Axes>", "<Axis>"), right.clone(), "main.xml"),
        (
            main_xml("D", [3, 2, 1], LINK),
            doubles(&[1.0, f64::NAN, 1.0, 1.0, 1.0, 1.0]),
            "1 of 6 heights are missing",
        ),
        ("<a/>".to_owned(), right.clone(), "no number Record3/MatrixDimension/SizeX"),
    ] {
        let found = read(archive(&xml, &data)).unwrap_err();
        assert!(found.contains(expected), "{expected}\n{found}");
    }
    let whole = archive(&main_xml("D", [3, 2, 1], LINK), &right);
    let mut dice = Dice::new(0x3b, 0);
    for _ in 0..1500 {
        let mut bytes = whole.clone();
        bytes.truncate(if dice.below(4) == 0 { dice.below(whole.len()) } else { whole.len() });
        for _ in 0..dice.below(5) {
            let at = dice.below(bytes.len().max(1));
            if let Some(byte) = bytes.get_mut(at) {
                *byte = dice.bits() as u8;
            }
        }
        match read(bytes) {
            Ok(map) => assert!(map.numbers.iter().all(|number| number.is_finite())),
            // Messages are sentences, without structures of the decoder.
            Err(error) => assert!(!error.contains(['{', '}', '[']), "{error}"),
        }
    }
}

#[test]
fn openexr_maps_are_read() {
    let pixel = |at: exr::math::Vec2<usize>| ((at.y() * 3 + at.x()) as f32,);
    let written = |name: &str| {
        let channels = SpecificChannels::build().with_channel(name).with_pixel_fn(pixel);
        let layer = Layer::new((3, 2), LayerAttributes::default(), Encoding::FAST_LOSSLESS, channels);
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    };
    for name in ["Z", "height"] {
        let map = read(written(name)).unwrap();
        // The lowest row comes first.
        assert_eq!((map.columns, map.numbers), (3, vec![3.0, 4.0, 5.0, 0.0, 1.0, 2.0]));
    }
    let whole = written("Z");
    assert!(read(whole[..whole.len() / 2].to_vec()).unwrap_err().contains("OpenEXR"));
}

/// A grey TIFF of 16 bits, in both byte orders; other pictures and damaged ones are refused without a panic.
#[test]
fn tiff_maps_are_read() {
    // A head, the heights, and a table of entries: tag, type, count, value.
    let written = |is_big: bool, bits: u16| {
        let short = |value: u16| if is_big { value.to_be_bytes() } else { value.to_le_bytes() };
        let long = |value: u32| if is_big { value.to_be_bytes() } else { value.to_le_bytes() };
        let mut bytes = if is_big { b"MM\0*".to_vec() } else { b"II*\0".to_vec() };
        bytes.extend(long(8 + 12));
        bytes.extend([0, 100, 20_000, 300, 400, 65_535].into_iter().flat_map(short));
        let entries: [(u16, u32); 9] = [
            (256, 3),
            (257, 2),
            (258, u32::from(bits)),
            (259, 1),
            (262, 1),
            (273, 8),
            (277, 1),
            (278, 2),
            (279, 12),
        ];
        bytes.extend(short(entries.len() as u16));
        for (tag, value) in entries {
            bytes.extend(short(tag).into_iter().chain(short(4)).chain(long(1)).chain(long(value)));
        }
        bytes.extend(long(0));
        bytes
    };
    for is_big in [false, true] {
        let map = read(written(is_big, 16)).unwrap();
        // The lowest row comes first.
        assert_eq!((map.columns, map.numbers), (3, vec![300.0, 400.0, 65_535.0, 0.0, 100.0, 20_000.0]));
        assert!(map.is_picture && map.unit_um.is_none());
        // The largest number of 16 bits is a height: nothing in the file says otherwise.
        assert!(
            map.warnings.len() == 1 && map.warnings[0].contains("1 of 6 heights are 65535"),
            "{:?}",
            map.warnings
        );
    }
    let wrong = read(written(false, 8)).unwrap_err();
    assert!(
        wrong.contains("it is a grey picture of 8 bits (expected a grey picture of 16 or 32 bits"),
        "{wrong}"
    );
    let whole = written(false, 16);
    let mut dice = Dice::new(0x71f, 0);
    for _ in 0..2000 {
        let mut bytes = whole.clone();
        bytes.truncate(if dice.below(4) == 0 { dice.below(whole.len()) } else { whole.len() });
        for _ in 0..dice.below(4) {
            let at = dice.below(bytes.len().max(1));
            if let Some(byte) = bytes.get_mut(at) {
                *byte = dice.bits() as u8;
            }
        }
        if let Ok(map) = read(bytes) {
            assert!(map.numbers.iter().all(|number| number.is_finite()));
        }
    }
}
