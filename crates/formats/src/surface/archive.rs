//! Maps of heights in zip archives: X3P, NumPy's `.npz`, Sensofar's `.plux`, and Keyence's `.vk6` and `.vk7`.
//! Their contents tell them apart.

use std::io::{Cursor, Read};

use papilio_diagnostics::Diagnostic;
use zip::read::ZipArchive;

use super::{HeightFile, MOST_HEIGHTS, array, damaged, keyence, not_a_map, plux, unsupported, x3p};

/// Largest number of files in an archive.
const MOST_FILES: usize = 1000;

/// Largest size of an array: heights of 8 bytes and a header.
const LARGEST_ARRAY: u64 = 8 * MOST_HEIGHTS as u64 + (1 << 16);

/// Reads XML of an archive, with a limit: a packed file could unpack to more nodes than memory has room for.
pub(super) fn document(xml: &str) -> Result<roxmltree::Document<'_>, roxmltree::Error> {
    let options =
        roxmltree::ParsingOptions { allow_dtd: false, nodes_limit: 4_000_000, entity_resolver: None };
    roxmltree::Document::parse_with_options(xml, options)
}

/// An archive and what errors call it.
pub(super) struct Archive<'a> {
    pub(super) zip: ZipArchive<Cursor<&'a [u8]>>,
    pub(super) format: &'static str,
}

/// First bytes of zip archives, and of those of Keyence.
pub(super) const MAGICS: [&[u8]; 3] = [b"PK\x03\x04", keyence::PACKED[0], keyence::PACKED[1]];

/// Reads a map.
pub(super) fn read(bytes: &[u8]) -> Result<HeightFile, Diagnostic> {
    let zip =
        ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged("zip archive", error.to_string()))?;
    if zip.len() > MOST_FILES {
        return Err(damaged("zip archive", format!("it has {} files", zip.len())));
    }
    let mut archive = Archive { zip, format: "zip archive" };
    if archive.has("main.xml") {
        archive.format = "X3P";
        return x3p::read(&mut archive);
    }
    if archive.has(plux::HEIGHTS) {
        archive.format = "PLUX";
        return plux::read(&mut archive);
    }
    if archive.has(keyence::PACKED_NAME) {
        archive.format = "Keyence VK";
        return keyence::read(&archive.content(keyence::PACKED_NAME, LARGEST_ARRAY)?);
    }
    let names: Vec<String> =
        archive.zip.file_names().filter_map(|name| name.ok().map(|name| name.into_owned())).collect();
    if names.iter().any(|name| name == "[Content_Types].xml") {
        let format = "an Office document, such as an Excel workbook";
        return Err(unsupported(format, "save the heights as CSV"));
    }
    if !names.is_empty() && names.iter().all(|name| name.ends_with(".npy")) {
        archive.format = ".npz";
        return match &names[..] {
            [only] => array::read(&archive.content(only, LARGEST_ARRAY)?, ".npz"),
            _ => Err(damaged(
                ".npz",
                format!("it has {} arrays (expected one): save the map with numpy.save", names.len()),
            )),
        };
    }
    Err(not_a_map())
}

impl Archive<'_> {
    pub(super) fn has(&self, name: &str) -> bool {
        self.zip.index_for_name(name).is_some()
    }

    /// Content of a file of the archive, of at most this size.
    pub(super) fn content(&mut self, name: &str, most: u64) -> Result<Vec<u8>, Diagnostic> {
        let format = self.format;
        let wrong = |what: String| damaged(format, format!("{}: {what}", name.escape_debug()));
        let file = self.zip.by_name(name).map_err(|error| wrong(error.to_string()))?;
        let mut bytes = Vec::new();
        file.take(most + 1).read_to_end(&mut bytes).map_err(|error| wrong(error.to_string()))?;
        if bytes.len() as u64 > most {
            return Err(damaged(
                format,
                format!("{} is larger than the dimensions of the map say", name.escape_debug()),
            ));
        }
        Ok(bytes)
    }
}
