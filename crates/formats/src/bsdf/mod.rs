//! Readers and writers of measured scattering. `docs/bsdf-files.md` describes the formats.
//!
//! The format is detected from the content of a file, never from its name. The memory of a reader is
//! proportional to the size of the file, and a file with more than [`MOST_CELLS`] values is refused.

mod angles;
mod astm;
mod between;
mod display;
mod display_csv;
mod display_klems;
mod display_radiant;
mod display_read;
mod formats;
mod fred;
mod klems_write;
mod merl;
mod papilio;
mod papilio_write;
mod problem;
mod radiant_read;
mod radiant_write;
mod rgl;
mod rgl_write;
mod scan;
mod scene_script;
mod table_read;
mod table_rows;
mod table_write;
mod text;
mod tree;
mod tristimulus;
mod window;
mod write;
mod xml;

pub use between::{BetweenError, Exported, FAINT, between_error};
pub use display::{BsdfSource, write_bsdf};
pub use display_csv::{MirrorFile, write_bsdf_csv, write_mirror_csv};
pub use display_klems::{klems_numbers, klems_rings, write_bsdf_klems};
pub use display_radiant::write_bsdf_radiant;
pub use formats::{bsdf_format_table, bsdf_formats};
pub use problem::BsdfProblem;
pub use rgl_write::write_rgl;
pub use scene_script::scene_script;
pub use write::{BsdfFormat, WriteError, write_measurement};

use std::borrow::Cow;

use papilio_diagnostics::{Place, Warned};
use papilio_goniometry::{Channel, MeasuredPart, Measurement, PartOfCircle, ScatterMode};

use crate::error::FormatError;
use crate::file::DataFile;

/// Shortest wavelength of a channel, nm; wavelengths in um are far below it.
const SHORTEST_NM: f64 = 30.0;

/// Returns the channel of a wavelength in nm, or `None` if the number cannot be one.
fn wavelength(nm: f64) -> Option<Channel> {
    (nm.is_finite() && nm >= SHORTEST_NM).then_some(Channel::Wavelength(nm))
}

/// Largest size of a file of measured scattering, bytes: the limit for [`DataFile::open_within`].
pub const LARGEST_BSDF_FILE: u64 = 256 << 20;

/// Largest number of values of a part, all channels together.
pub const MOST_CELLS: usize = 50_000_000;

/// Largest value of a BSDF, 1/sr; a mirror measured through an aperture of one microradian has 1e12. Sums and
/// products of values, and of their integrals, remain finite.
pub(crate) const LARGEST_VALUE: f64 = 1e15;

/// Range of a value, in words.
const VALUE_RANGE: &str = "a number from 0 to 1e15 per sr";

/// Longest line of a text file, bytes.
const LONGEST_LINE: usize = 1 << 20;

/// Reads a BSDF file in any of the supported formats.
///
/// # Errors
/// If the format is unknown, or the file is malformed or cut off, or values are out of order, negative or too
/// large; with line and column for text files.
///
/// ```
/// use papilio_formats::{DataFile, read_bsdf};
/// let text = b"theta_i,phi_i,theta_o,phi_o,value\n0,0,0,0,0.3\n0,0,30,0,0.2\n";
/// let read = read_bsdf(&DataFile { name: "a.csv".into(), bytes: text.to_vec() })?;
/// assert_eq!(read.value.parts[0].values, [0.3, 0.2]);
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_bsdf(file: &DataFile) -> Result<Warned<Measurement>, FormatError> {
    let BsdfFile { measurement, warnings, .. } = read_bsdf_file(file, None)?;
    Ok(Warned { value: measurement, warnings })
}

/// A measurement as read from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct BsdfFile {
    /// The measurement.
    pub measurement: Measurement,
    /// What may be wrong with the file.
    pub warnings: Vec<String>,
    /// How the file was interpreted.
    pub notes: Vec<String>,
    /// Whether the file states which part (reflection or transmission, from the front or from the back) its
    /// values are. If not, it is read as front reflection.
    pub states_part: bool,
    /// Whether the file states the side from which its light comes, and not only whether its values are a
    /// reflection or a transmission.
    pub states_side: bool,
}

impl From<Warned<Measurement>> for BsdfFile {
    /// A file in a format that states the part.
    fn from(read: Warned<Measurement>) -> Self {
        let Warned { value: measurement, warnings } = read;
        Self { measurement, warnings, notes: Vec::new(), states_part: true, states_side: true }
    }
}

impl BsdfFile {
    /// The same in a format that states a reflection or a transmission, but not the side of the light.
    fn of_either_side(self) -> Self {
        Self { states_side: false, ..self }
    }
}

/// Reads a BSDF file as [`read_bsdf`]. If the file does not state which part its values are, it is `part`, or
/// else front reflection. The same holds for the side of the light: a file with a BTDF that does not state
/// the side is a transmission from the front, unless `part` is back transmission. With a part, a table of two
/// columns without names is accepted as a scan at normal incidence.
///
/// # Errors
/// As [`read_bsdf`].
///
/// ```
/// use papilio_formats::{DataFile, read_bsdf_file};
/// use papilio_goniometry::ScatterMode;
/// let scan = DataFile { name: "scan.csv".into(), bytes: b"0,9.5\n2,5.1\n4,2.4\n90,0\n".to_vec() };
/// let read = read_bsdf_file(&scan, Some(ScatterMode::FrontTransmission))?;
/// assert_eq!(read.measurement.parts[0].way, ScatterMode::FrontTransmission);
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_bsdf_file(file: &DataFile, part: Option<ScatterMode>) -> Result<BsdfFile, FormatError> {
    crate::guard::read(file, |file| of_any_format(file, part))
}

/// Mean difference of the two sides of the plane of incidence, over their mean, up to which it is taken as
/// noise: then their means are used.
const LARGEST_DIFFERENCE: f64 = 0.2;

fn of_any_format(file: &DataFile, part: Option<ScatterMode>) -> Result<BsdfFile, FormatError> {
    let mut read: BsdfFile = if crate::npz::is_npz(file) {
        read_archive(file)?.into()
    } else if rgl::is_rgl(file) {
        BsdfFile::from(rgl::read(file)?).of_either_side()
    } else if merl::is_merl(file) {
        BsdfFile::from(merl::read(file)?).of_either_side()
    } else {
        read_text(&decoded(file), part)?
    };
    if let (Some(way), [only]) = (part, &mut read.measurement.parts[..])
        && way != only.way
        && (!read.states_part || (way.is_transmission() == only.way.is_transmission() && !read.states_side))
    {
        let (old, new) = (only.way.name(), way.name());
        read.notes.iter_mut().for_each(|note| *note = note.replace(old, new));
        only.way = way;
    }
    read.states_part |= part.is_some();
    for overlap in read.measurement.parts.iter().filter_map(MeasuredPart::overlap) {
        if overlap.difference > LARGEST_DIFFERENCE {
            let place = Place::whole(&file.name);
            return Err(FormatError { place, problem: BsdfProblem::SidesDisagree(overlap).into() });
        }
        read.notes.push(format!(
            "the azimuths from {} to {} deg were measured on both sides of the plane of incidence: their means are taken (a mean difference of {:.1} %)",
            overlap.from_deg,
            overlap.to_deg,
            100.0 * overlap.difference
        ));
    }
    let parts = std::mem::take(&mut read.measurement.parts).into_iter().map(MeasuredPart::on_one_side);
    let uncovered = |PartOfCircle { from_deg, to_deg, in_one_plane }| FormatError {
        place: Place::whole(&file.name),
        problem: BsdfProblem::PartOfCircle { from_deg, to_deg, in_one_plane }.into(),
    };
    read.measurement.parts = parts.collect::<Result<_, _>>().map_err(uncovered)?;
    let mut values = read.measurement.parts.iter().flat_map(|part| &part.values).peekable();
    if values.peek().is_some() && values.all(|value| *value <= 0.0 || value.is_nan()) {
        read.warnings.push(
            "no value of the file is above 0: it scatters no light; was the lamp off, or were the values rounded when they were written?"
                .to_owned(),
        );
    }
    Ok(read)
}

/// Reads a file in one of the formats of text.
fn read_text(file: &DataFile, part: Option<ScatterMode>) -> Result<BsdfFile, FormatError> {
    Ok(if window::is_window(file) {
        window::read(file)?.into()
    } else if radiant_read::is_radiant(file) {
        BsdfFile::from(radiant_read::read(file)?).of_either_side()
    } else if fred::is_fred(file) {
        fred::read(file)?
    } else if astm::is_astm(file) {
        astm::read(file)?
    } else if table_read::is_table(file) {
        table_read::read(file)?
    } else if scan::is_scan(file, part.is_some()) {
        scan::read(file, part.is_some())?
    } else {
        let is_comment = |line: &[u8]| matches!(line.trim_ascii().first(), None | Some(b'#'));
        let is_empty = file.bytes.split(|byte| *byte == b'\n').all(is_comment);
        let problem = if is_empty { BsdfProblem::Empty } else { BsdfProblem::Unknown };
        let unknown = || FormatError { place: Place::whole(&file.name), problem: problem.into() };
        return Err(table_read::refusal(file).unwrap_or_else(unknown));
    })
}

/// Returns a file as UTF-8, if it is a text in another encoding.
fn decoded(file: &DataFile) -> Cow<'_, DataFile> {
    match crate::table::decode(&file.bytes) {
        Some(Cow::Owned(text)) => Cow::Owned(DataFile { name: file.name.clone(), bytes: text.into_bytes() }),
        _ => Cow::Borrowed(file),
    }
}

impl BsdfFile {
    /// Returns the file with one part only; `name` is the name of the file.
    ///
    /// # Errors
    /// If the file has no such part.
    pub fn only(mut self, part: ScatterMode, name: &str) -> Result<Self, FormatError> {
        let parts = &mut self.measurement.parts;
        if parts.iter().any(|one| one.way == part) {
            parts.retain(|one| one.way == part);
            return Ok(self);
        }
        let found = parts.iter().map(|one| one.way).collect();
        let problem = BsdfProblem::NoPart { wanted: part, found };
        Err(FormatError { place: Place::whole(name), problem: problem.into() })
    }
}

/// Reads one of Papilio's own archives.
fn read_archive(file: &DataFile) -> Result<Warned<Measurement>, FormatError> {
    let mut arrays = crate::npz::Npz::new(file)?;
    if !arrays.has("about") {
        return Err(arrays.error(BsdfProblem::Unknown));
    }
    let about = arrays.texts("about")?.concat();
    let named: Named = serde_json::from_str(&about).map_err(|e| arrays.unsound("about", &e.to_string()))?;
    match named.format.as_str() {
        papilio::FORMAT => papilio::read(arrays, &about),
        display_read::FORMAT => display_read::read(arrays, &about),
        _ => Err(arrays.error(BsdfProblem::Unknown)),
    }
}

/// Format name in an archive.
#[derive(serde::Deserialize)]
struct Named {
    format: String,
}
