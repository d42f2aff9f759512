//! Files of one surface in each format, written byte by byte from its document: heights 1 to 12 nm in three
//! rows of four from the top, 0.5 um apart, unless said.

use std::io::{Cursor, Write};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// Heights from the top row on.
const FROM_TOP: [i16; 12] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];

/// The rows in the other order.
fn from_below() -> Vec<i16> {
    FROM_TOP.chunks(4).rev().flatten().copied().collect()
}

fn little(heights: &[i16]) -> Vec<u8> {
    heights.iter().flat_map(|height| height.to_le_bytes()).collect()
}

fn floats(heights: &[i16], unit: f32) -> Vec<u8> {
    heights.iter().flat_map(|height| (f32::from(*height) * unit).to_le_bytes()).collect()
}

/// A binary SDF file with this first word.
pub(super) fn sdf_binary(word: &[u8]) -> Vec<u8> {
    let mut bytes = word.to_vec();
    bytes.extend(b"sdf-test  251120260322251120260322");
    for count in [4_u16, 3] {
        match word.ends_with(b"ISO-2.0") {
            true => bytes.extend(u32::from(count).to_le_bytes()),
            false => bytes.extend(count.to_le_bytes()),
        }
    }
    bytes.extend([5e-7_f64, 5e-7, 1e-9, -1.0].into_iter().flat_map(f64::to_le_bytes));
    bytes.extend([0, 5, 0]);
    // BCR begins with the highest y, ISO with the lowest.
    bytes.extend(if word.ends_with(b"BCR-1.0") { little(&FROM_TOP) } else { little(&from_below()) });
    bytes
}

/// A text SDF file with this first word.
pub(super) fn sdf_text(word: &str) -> String {
    let rows = if word.ends_with("BCR-1.0") { FROM_TOP.to_vec() } else { from_below() };
    let rows: Vec<String> = rows.iter().map(ToString::to_string).collect();
    format!(
        "{word}\r\nManufacID = sdf-test\r\nCreateDate = 251120260322\r\nModDate = 251120260322\r\nNumPoints = 4\r\nNumProfiles = 3\r\n\
         Xscale = 5.0e-7\r\nYscale = 5.0e-7\r\nZscale = 1.0e-9\r\nZresolution = -1\r\nCompression = 0\r\nDataType = 5\r\nCheckType = 0\r\n*\r\n\
         {}\r\n*\r\nno * trailer\r\n*\r\n",
        rows.join(" ")
    )
}

/// A Gwyddion Simple Field with these lines.
pub(super) fn gsf(head: &str) -> Vec<u8> {
    let mut bytes = format!("Gwyddion Simple Field 1.0\n{head}").into_bytes();
    bytes.extend(vec![0; 4 - bytes.len() % 4]);
    bytes.extend(floats(&FROM_TOP, 1e-9));
    bytes
}

/// A file of Digital Surf, compressed or not.
pub(super) fn sur(is_compressed: bool) -> Vec<u8> {
    let mut bytes = vec![0; 512];
    let mut put = |at: usize, part: &[u8]| bytes[at..at + part.len()].copy_from_slice(part);
    put(0, if is_compressed { b"DSCOMPRESSED" } else { b"DIGITAL SURF" });
    put(14, &1_i16.to_le_bytes());
    put(16, &1_i16.to_le_bytes());
    put(18, &2_i16.to_le_bytes());
    put(98, &16_i16.to_le_bytes());
    // The second height is this less 2, the mark of missing ones in files that have any.
    put(100, &4_i32.to_le_bytes());
    put(104, &12_i32.to_le_bytes());
    for (at, count) in [(108, 4_i32), (112, 3), (116, 12)] {
        put(at, &count.to_le_bytes());
    }
    for (at, spacing, unit) in [(0, 0.5_f32, "um"), (1, 0.5, "um"), (2, 1.0, "nm")] {
        put(120 + 4 * at, &spacing.to_le_bytes());
        put(180 + 16 * at, unit.as_bytes());
    }
    let heights = little(&FROM_TOP);
    if is_compressed {
        let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        packed.write_all(&heights).unwrap();
        let packed = packed.finish().unwrap();
        for number in [1, heights.len() as u32, packed.len() as u32] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(packed);
    } else {
        bytes.extend(heights);
    }
    bytes
}

/// A file of Wyko: the given blocks before those that it needs, of which the reader takes the first of a
/// name.
pub(super) fn opd(given: &[(&str, (i16, Vec<u8>))]) -> Vec<u8> {
    // Along y first, from the lowest y.
    let heights = (0..4).flat_map(|x| (0..3).rev().map(move |y| FROM_TOP[4 * y + x])).collect::<Vec<i16>>();
    let raw = [&[4, 0, 3, 0, 2, 0][..], &little(&heights)].concat();
    let own = [
        ("Wavelength", (7, 1_f32.to_le_bytes().to_vec())),
        ("Pixel_size", (7, 0.0005_f32.to_le_bytes().to_vec())),
        ("RAW_DATA", (3, raw)),
    ];
    let blocks: Vec<_> = given.iter().chain(&own).collect();
    let entry = |name: &str, kind: i16, length: usize| {
        let mut entry = name.as_bytes().to_vec();
        entry.resize(16, 0);
        entry.extend(kind.to_le_bytes());
        entry.extend((length as i32).to_le_bytes());
        entry.extend([0, 0]);
        entry
    };
    let mut bytes = vec![1, 0];
    bytes.extend(entry("Directory", 1, 24 * (blocks.len() + 1)));
    bytes.extend(blocks.iter().flat_map(|(name, (kind, block))| entry(name, *kind, block.len())));
    bytes.extend(blocks.iter().flat_map(|(_, (_, block))| block.iter().copied()));
    bytes
}

/// A file of Keyence: its conditions at byte 84, its heights at 400.
pub(super) fn keyence() -> Vec<u8> {
    let mut bytes = vec![0; 400 + 28 + 768];
    let mut put = |at: usize, number: u32| bytes[at..at + 4].copy_from_slice(&number.to_le_bytes());
    put(12, 84);
    put(36, 400);
    for (number, pm) in [(42, 500_000), (43, 500_000), (44, 1000)] {
        put(84 + 4 * number, pm);
    }
    for (at, number) in [(400, 4), (404, 3), (408, 32), (416, 48)] {
        put(at, number);
    }
    bytes[..4].copy_from_slice(b"VK4_");
    bytes.extend(FROM_TOP.iter().flat_map(|height| u32::from(height.unsigned_abs()).to_le_bytes()));
    bytes
}

/// A TIFF file of 4 x 3 heights: bits and format of its samples, its heights, and further entries: tag, type,
/// number and value.
pub(super) fn tiff(bits: u32, format: u32, heights: &[u8], more: &[(u16, u16, u32, u32)]) -> Vec<u8> {
    let mut bytes = b"II*\0".to_vec();
    let table = 8 + heights.len() as u32;
    bytes.extend(table.to_le_bytes());
    bytes.extend(heights);
    let own = [
        (256, 4),
        (257, 3),
        (258, bits),
        (259, 1),
        (262, 1),
        (273, 8),
        (277, 1),
        (278, 3),
        (279, heights.len() as u32),
        (339, format),
    ];
    let mut entries: Vec<_> = own.into_iter().map(|(tag, value)| (tag, 4_u16, 1_u32, value)).collect();
    entries.retain(|(tag, ..)| more.iter().all(|(other, ..)| other != tag));
    entries.extend(more);
    entries.sort_unstable();
    bytes.extend((entries.len() as u16).to_le_bytes());
    for (tag, kind, count, value) in entries {
        bytes.extend(tag.to_le_bytes().into_iter().chain(kind.to_le_bytes()));
        bytes.extend(count.to_le_bytes().into_iter().chain(value.to_le_bytes()));
    }
    bytes.extend([0; 4]);
    bytes
}

/// Heights of 1 to 12 as single-precision numbers.
pub(super) fn singles() -> Vec<u8> {
    floats(&FROM_TOP, 1.0)
}

/// A zip archive.
pub(super) fn zip(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        archive.start_file(*name, SimpleFileOptions::default()).unwrap();
        archive.write_all(content).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// A file of Sensofar with this index.
pub(super) fn plux(xml: &str) -> Vec<u8> {
    zip(&[("index.xml", xml.as_bytes()), ("LAYER_0.raw", &floats(&FROM_TOP, 1e-3))])
}

/// X3P files: heights of 100 to 600 nm in two rows of three.
pub(super) mod x3p {
    pub(in crate::heights) fn main_xml() -> String {
        crate::heights::main_xml("D", [3, 2, 1], crate::heights::LINK)
    }

    pub(in crate::heights) fn archive(xml: &str, more: &[(&str, &[u8])]) -> Vec<u8> {
        let heights: Vec<u8> = (1..=6).flat_map(|k| (100.0 * f64::from(k)).to_le_bytes()).collect();
        let own: [(&str, &[u8]); 2] = [("main.xml", xml.as_bytes()), ("bindata/data.bin", &heights)];
        super::zip(&[&own[..], more].concat())
    }
}
