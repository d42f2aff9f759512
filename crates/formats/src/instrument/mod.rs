//! Spectra as instruments and their programs write them.
//!
//! | format | recognised by | read |
//! |---|---|---|
//! | CGATS.17, ISO 28178, Argyll's `.ti3`, `.sp`, `.ccss` | a line `BEGIN_DATA_FORMAT` | spectra or L\*, a\*, b\* or X, Y, Z of each sample |
//! | CxF3 (ISO 17972) | the XML element `CxF` | the same |
//! | IES TM-27 (`.spdx`) | the XML element `IESTM2714` or `IESTM2720` | the spectrum |
//! | ASD, ViewSpec Pro | a line `Text conversion of header file`, or names of columns such as `leaf.asd` | the spectrum of each column |
//! | Ocean Optics, OceanView, SpectraSuite | a line `>>>>>Begin ... Spectral Data<<<<<` | the spectrum |
//! | Sekonic, UPRtek and others | rows such as `Spectral Data 380[nm],0.01` | the spectrum of each column |
//! | spectrophotometers' tables | a header with a column for each wavelength | the spectrum of each row |

mod asd;
mod cgats;
mod cxf;
mod listed;
mod ocean;
mod tm27;
mod wide;

use std::ops::Range;

use papilio_colour::Standard;
use papilio_diagnostics::{Diagnostic, Place};

use crate::error::FormatError;
use crate::file::DataFile;
use crate::table::TableText;

/// Quantity of the spectra of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Reflectance,
    Transmittance,
    Absorptance,
    Light,
    /// The file does not state it.
    Unstated,
}

/// What a file of an instrument holds.
#[derive(Debug)]
pub(crate) struct SpectralFile {
    pub(crate) format: &'static str,
    pub(crate) kind: Kind,
    pub(crate) samples: Vec<Sample>,
    /// Observer of the colours, if the file states it.
    pub(crate) observer: Option<Standard>,
    /// Illuminant of the colours, such as `D50`, if the file states it.
    pub(crate) illuminant: Option<String>,
    /// Whether the spectra have their scale: the file states it, or they have been divided by 100.
    pub(crate) has_scale: bool,
    /// How the file was interpreted.
    pub(crate) notes: Vec<String>,
}

/// A measured sample: its spectrum or, without one, its colour.
#[derive(Debug, Default)]
pub(crate) struct Sample {
    pub(crate) name: String,
    /// Its place in the text, bytes.
    pub(crate) at: Range<usize>,
    /// Wavelengths, nm, and values, each with its place.
    pub(crate) spectrum: Vec<(f64, f64, Range<usize>)>,
    pub(crate) lab: Option<[f64; 3]>,
    pub(crate) xyz: Option<[f64; 3]>,
    /// Standard deviations of X, Y, Z or, without them, of L\*, a\*, b\*.
    pub(crate) deviation: Option<[f64; 3]>,
    /// Direction of the viewer, degrees.
    pub(crate) theta_deg: Option<f64>,
    pub(crate) phi_deg: Option<f64>,
}

/// A larger value of a reflectance, without a unit, is in per cent: instruments with a sphere or at 45 deg
/// measure at most 1 and noise.
pub(crate) const LARGEST_FRACTION: f64 = 1.5;

/// Reads a file in one of the formats of instruments; `None` if it has none of them.
pub(crate) fn read(file: &DataFile) -> Result<Option<SpectralFile>, FormatError> {
    let Ok(text) = TableText::new(file) else { return Ok(None) };
    let table = text.table();
    let begins = table.text.trim_start();
    let read = if begins.starts_with('<') {
        xml(&file.name, table.text)?
    } else if cgats::is_cgats(table.text) {
        Some(cgats::read(&file.name, table.text)?)
    } else if ocean::is_ocean(table.text) {
        Some(ocean::read(table)?)
    } else if let Some(head) = asd::head(table) {
        Some(asd::read(table, &head)?)
    } else if let Some(listed) = listed::read(table)? {
        Some(listed)
    } else {
        wide::read(table)?
    };
    if let Some(read) = &read
        && read.samples.is_empty()
    {
        let source = Source { name: &file.name, text: table.text, format: read.format };
        return Err(source.whole("it has no samples"));
    }
    Ok(read)
}

/// Reads an XML file; `None` if its outermost element is unknown.
fn xml(name: &str, text: &str) -> Result<Option<SpectralFile>, FormatError> {
    // The declaration of an encoding refers to the bytes, which are decoded.
    let document = roxmltree::Document::parse(text).map_err(|error| {
        let place = line_start(text, error.pos().row as usize);
        Source { name, text, format: "XML" }.at(place, format!("it ends early or is damaged ({error})"))
    })?;
    let root = document.root_element();
    match root.tag_name().name() {
        "CxF" => cxf::read(name, text, root).map(Some),
        tag if tag.to_ascii_uppercase().starts_with("IESTM27") => tm27::read(name, text, root).map(Some),
        tag => {
            let what = format!("its element is `{tag}`; CxF and IES TM-27 are read");
            Err(Source { name, text, format: "XML" }.at(line_start(text, 1), what))
        }
    }
}

/// The first word of a line, counted from 1, bytes; empty after the last line.
fn line_start(text: &str, line: usize) -> Range<usize> {
    let lines = text.split_inclusive('\n');
    let start: usize = lines.take(line.saturating_sub(1)).map(str::len).sum();
    let word = text.get(start..).and_then(|rest| rest.split_whitespace().next()).unwrap_or_default();
    let at = text.get(start..).and_then(|rest| rest.find(word)).map_or(start, |skipped| start + skipped);
    at..at + word.len().min(40)
}

/// The text of a file in one of these formats, for errors with their place.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub(crate) name: &'a str,
    pub(crate) text: &'a str,
    pub(crate) format: &'static str,
}

impl Source<'_> {
    /// Returns an error about the whole file.
    pub(crate) fn whole(&self, what: impl std::fmt::Display) -> FormatError {
        FormatError::whole(self.name, self.diagnostic(what))
    }

    /// Returns an error about a range of bytes; about the whole file if this is empty.
    pub(crate) fn at(&self, at: Range<usize>, what: impl std::fmt::Display) -> FormatError {
        if at.is_empty() {
            return self.whole(what);
        }
        let place = Place::in_text(self.name, self.text, at);
        FormatError { place, problem: self.diagnostic(what).into() }
    }

    fn diagnostic(&self, what: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::new(format!("this {} file cannot be used: {what}", self.format))
    }

    /// Returns the place of a part of the text, bytes; an empty range if it is another text.
    pub(crate) fn range(&self, part: &str) -> Range<usize> {
        let [part_at, text_at] = [part, self.text].map(|text| text.as_ptr() as usize);
        let start = part_at.wrapping_sub(text_at);
        if start > self.text.len() || start + part.len() > self.text.len() {
            0..0
        } else {
            start..start + part.len()
        }
    }
}

/// Returns the name in the spelling of the CIE of the illuminant that a text such as `D50` or `ILLUMINANT, F11` states; `None` if it is not tabulated.
pub(crate) fn illuminant(text: &str) -> Option<String> {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
    // A word that names a light by its use is none in such a text.
    let is_code = |word: &&str| word.len() == 1 || word.bytes().any(|byte| byte.is_ascii_digit());
    words.filter(is_code).find_map(papilio_spectra::illuminant_name).map(str::to_owned)
}

/// Returns the observer that a text such as `2 degree` or `10_Degree` names.
pub(crate) fn observer(text: &str) -> Option<Standard> {
    match text.trim_matches(|c: char| !c.is_ascii_digit()) {
        "2" | "1931" => Some(Standard::Cie1931),
        "10" | "1964" => Some(Standard::Cie1964),
        _ => None,
    }
}

impl SpectralFile {
    /// A file that states neither the observer nor the illuminant of colours.
    pub(crate) fn new(format: &'static str, kind: Kind, samples: Vec<Sample>, notes: Vec<String>) -> Self {
        Self { format, kind, samples, observer: None, illuminant: None, has_scale: false, notes }
    }

    /// Divides reflectances in per cent by 100, once; without a stated scale, values above 1.5 show that they are.
    pub(crate) fn divide_per_cent(&mut self) {
        let values = || self.samples.iter().flat_map(|sample| &sample.spectrum);
        let largest = values().map(|(_, value, _)| *value).fold(0.0, f64::max);
        if self.has_scale || self.kind == Kind::Light || largest <= LARGEST_FRACTION {
            return;
        }
        self.has_scale = true;
        for (_, value, _) in self.samples.iter_mut().flat_map(|sample| &mut sample.spectrum) {
            *value /= 100.0;
        }
        self.notes.push(percent_note(largest));
    }
}

impl SpectralFile {
    /// Divides X, Y, Z and their standard deviations by 100, the white of CGATS and CxF. Values up to 1.5 show that they are
    /// relative to Y = 1 already, which is noted.
    pub(crate) fn scale_xyz(&mut self) {
        let largest = self.samples.iter().flat_map(|one| one.xyz).flatten().fold(0.0, f64::max);
        if largest > LARGEST_FRACTION {
            for sample in &mut self.samples {
                let deviation = sample.xyz.and(sample.deviation.as_mut());
                let all = sample.xyz.iter_mut().chain(deviation).flatten();
                all.for_each(|value| *value /= 100.0);
            }
        } else if self.samples.iter().any(|one| one.xyz.is_some() && one.spectrum.is_empty()) {
            self.notes.push(format!(
                "X, Y, Z reach {largest}, and are read relative to a perfect white of Y = 1; if they are relative to Y = 100, as {} \
                 has them, write them as a table with the column `Y (%)`",
                self.format
            ));
        }
    }
}

/// Returns the note on values that are read as per cent.
pub(crate) fn percent_note(largest: f64) -> String {
    format!("the file states no scale; its values reach {largest}, and are read as per cent")
}
