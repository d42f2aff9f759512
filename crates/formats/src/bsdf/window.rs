//! Reader of the XML files of WINDOW and Radiance: matrices of Klems patches, and tensor trees.
//!
//! Each block of values belongs to a spectrum and a part. Its values are a matrix over two angle bases,
//! or nested braces.

use std::ops::Range;

use papilio_goniometry::{
    Channel, Geometry, KLEMS_FULL, KLEMS_HALF, KLEMS_QUARTER, MeasuredPart, Measurement, Provenance, Ring,
    ScatterMode, patch_count,
};

use super::text::Text;
use super::xml::{Document, Node, is_xml, line_before};
use super::{BsdfProblem, MOST_CELLS, Warned, tree};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// Names of the formats.
pub(super) const KLEMS: &str = "Klems matrix XML";
const TREE: &str = "tensor-tree XML";

/// Largest number of patches of a basis; a matrix of more would exceed all limits.
const MOST_PATCHES: usize = 5000;

/// Largest numbers of blocks, and of bases that the file defines.
const MOST_BLOCKS: usize = 4096;
const MOST_BASES: usize = 64;

/// The bases with a standard name.
pub(super) const BASES: [(&str, &[Ring]); 3] = [
    ("LBNL/Klems Full", &KLEMS_FULL),
    ("LBNL/Klems Half", &KLEMS_HALF),
    ("LBNL/Klems Quarter", &KLEMS_QUARTER),
];

/// Names of the directions of blocks.
pub(super) const WAYS: [(&str, ScatterMode); 4] = [
    ("Transmission Front", ScatterMode::FrontTransmission),
    ("Transmission Back", ScatterMode::BackTransmission),
    ("Reflection Front", ScatterMode::FrontReflection),
    ("Reflection Back", ScatterMode::BackReflection),
];

/// Returns whether a file is XML with scattering data.
pub(super) fn is_window(file: &DataFile) -> bool {
    let text = Text::new(file);
    is_xml(text) && text.bytes.windows(13).take(1 << 20).any(|window| window == b"WindowElement")
}

/// Order of the values of a block.
#[derive(Clone, Copy, PartialEq)]
enum Structure {
    /// `value[outgoing][incident]`.
    Columns,
    /// `value[incident][outgoing]`.
    Rows,
    /// Nested braces of this rank.
    Tree(usize),
}

/// A block of values.
struct Block {
    way: ScatterMode,
    channel: Channel,
    place: Range<usize>,
    data: Data,
}

enum Data {
    Matrix { bases: [Vec<Ring>; 2], values: Vec<f64> },
    Tree(tree::Values),
}

pub(super) fn read(file: &DataFile) -> Result<Warned<Measurement>, FormatError> {
    let text = Text::new(file);
    let document = Document::new(text)?;
    let layer = document.root().expect("Layer")?;
    let structure = structure(text, layer)?;
    let bases =
        layer.all("AngleBasis").filter(|node| node.first("AngleBasisName").is_some()).take(MOST_BASES);
    let bases: Vec<(String, Vec<Ring>)> = bases.map(|node| basis(text, node)).collect::<Result<_, _>>()?;
    let mut reading = Reading { text, structure, bases, blocks: Vec::new(), cells: 0, warnings: Vec::new() };
    let stray = line_before(text);
    if !stray.is_empty() {
        let line = text.quote(stray);
        reading
            .warnings
            .push(format!("the first line, `{line}`, is before the beginning of the XML; it was ignored"));
    }
    for data in layer.all("WavelengthData") {
        reading.spectrum(data)?;
    }
    if reading.blocks.is_empty() {
        return Err(text.error(layer.place(), BsdfProblem::Missing { what: "block of values" }));
    }
    let parts = reading.parts()?;
    let format = if matches!(structure, Structure::Tree(_)) { TREE } else { KLEMS };
    let provenance = provenance(layer, format);
    Ok(Warned { value: Measurement { provenance, media: [1.0, 1.0], parts }, warnings: reading.warnings })
}

fn provenance(layer: Node<'_>, format: &str) -> Provenance {
    let text_of = |name| layer.first("Material").and_then(|material| material.first(name)).map(Node::text);
    Provenance {
        format: format.to_owned(),
        sample: text_of("Name").unwrap_or_default(),
        source: text_of("Manufacturer").unwrap_or_default(),
        remarks: Vec::new(),
    }
}

fn structure(text: Text<'_>, layer: Node<'_>) -> Result<Structure, FormatError> {
    let node = layer.expect("IncidentDataStructure")?;
    Ok(match node.text().as_str() {
        "Columns" => Structure::Columns,
        "Rows" => Structure::Rows,
        "TensorTree3" => Structure::Tree(3),
        "TensorTree4" => Structure::Tree(4),
        found => {
            let expected = "Columns, Rows, TensorTree3 or TensorTree4";
            let problem = BsdfProblem::Unexpected { found: found.to_owned(), expected };
            return Err(text.error(node.word(), problem));
        }
    })
}

/// Reads a basis that the file defines.
fn basis(text: Text<'_>, node: Node<'_>) -> Result<(String, Vec<Ring>), FormatError> {
    let name = node.expect("AngleBasisName")?.text();
    let (mut rings, mut end, mut count): (Vec<Ring>, f64, usize) = (Vec::new(), 0.0, 0);
    for block in node.all("AngleBasisBlock") {
        let [lower, upper] = [block.expect("LowerTheta")?, block.expect("UpperTheta")?];
        let from_deg = text.number(lower.word())?;
        let to_deg = text.number(upper.word())?;
        if (from_deg - end).abs() > 1e-6 || to_deg <= from_deg || to_deg > 90.0 + 1e-6 {
            let problem = BsdfProblem::Order { what: "the ring's bound", value: to_deg, before: end };
            return Err(text.error(upper.word(), problem));
        }
        let at = block.expect("nPhis")?.word();
        let patches = text.number(at.clone())?;
        if !(patches >= 1.0 && patches <= MOST_PATCHES as f64 && patches.fract() == 0.0) {
            let expected = "an integer from 1 to 5000";
            return Err(text.error(at, Problem::OutOfRange { what: "nPhis", value: patches, expected }));
        }
        rings.push(Ring { from_deg: end, patches: patches as usize });
        end = to_deg;
        count += patches as usize;
        if count > MOST_PATCHES {
            return Err(text.error(at, BsdfProblem::TooManyCells { limit: MOST_CELLS }));
        }
    }
    if (end - 90.0).abs() > 1e-6 {
        let problem = Problem::OutOfRange { what: "the last ring's bound", value: end, expected: "90 deg" };
        return Err(text.error(node.place(), problem));
    }
    Ok((name, rings))
}

struct Reading<'a> {
    text: Text<'a>,
    structure: Structure,
    bases: Vec<(String, Vec<Ring>)>,
    blocks: Vec<Block>,
    cells: usize,
    warnings: Vec<String>,
}

impl Reading<'_> {
    fn spectrum(&mut self, data: Node<'_>) -> Result<(), FormatError> {
        let wavelength = data.expect("Wavelength")?;
        let Some(channel) = channel_of(&wavelength.text()) else {
            self.warn(format!("the values of the unknown spectrum `{}` were ignored", wavelength.text()));
            return Ok(());
        };
        for block in data.all("WavelengthDataBlock") {
            let direction = block.expect("WavelengthDataDirection")?;
            let name = direction.text();
            let Some((_, way)) = WAYS.iter().find(|(known, _)| known.eq_ignore_ascii_case(&name)) else {
                let expected =
                    "`Transmission Front`, `Transmission Back`, `Reflection Front` or `Reflection Back`";
                let problem = BsdfProblem::Unexpected { found: name, expected };
                return Err(self.text.error(direction.word(), problem));
            };
            if self.blocks.iter().any(|other| other.way == *way && other.channel == channel) {
                let problem = BsdfProblem::Twice { what: format!("the block {name}, {}", wavelength.text()) };
                return Err(self.text.error(direction.word(), problem));
            }
            let kind = block.first("ScatteringDataType").map(Node::text).unwrap_or_default();
            if kind.eq_ignore_ascii_case("BTDF") && !way.is_transmission() {
                self.warn(
                    "blocks of reflection have the type BTDF, as WINDOW writes it: they were read as reflection"
                        .into(),
                );
            }
            if self.blocks.len() >= MOST_BLOCKS {
                return Err(self.text.error(block.place(), BsdfProblem::TooManyCells { limit: MOST_CELLS }));
            }
            let data = self.data(block)?;
            self.blocks.push(Block { way: *way, channel, place: block.place(), data });
        }
        Ok(())
    }

    fn warn(&mut self, warning: String) {
        if self.warnings.len() < 20 && !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    fn data(&mut self, block: Node<'_>) -> Result<Data, FormatError> {
        let values = block.expect("ScatteringData")?;
        if let Structure::Tree(rank) = self.structure {
            let basis = block.expect("AngleBasis")?;
            if !basis.text().eq_ignore_ascii_case("LBNL/Shirley-Chiu") {
                let problem = BsdfProblem::Unexpected { found: basis.text(), expected: "LBNL/Shirley-Chiu" };
                return Err(self.text.error(basis.word(), problem));
            }
            let read = tree::read(self.text, values, rank, MOST_CELLS - self.cells)?;
            self.cells += read.cells();
            return Ok(Data::Tree(read));
        }
        let bases =
            [self.basis(block.expect("ColumnAngleBasis")?)?, self.basis(block.expect("RowAngleBasis")?)?];
        let read = self.matrix(values, patch_count(&bases[0]), patch_count(&bases[1]))?;
        Ok(Data::Matrix { bases, values: read })
    }

    fn basis(&self, node: Node<'_>) -> Result<Vec<Ring>, FormatError> {
        let name = node.text();
        let known = BASES.iter().map(|(name, rings)| (*name, *rings));
        let own = self.bases.iter().map(|(name, rings)| (name.as_str(), rings.as_slice()));
        // A definition in the file takes precedence over the standard meaning of the name.
        let found = own.chain(known).find(|(other, _)| other.eq_ignore_ascii_case(&name));
        found.map(|(_, rings)| rings.to_vec()).ok_or_else(|| {
            let expected = "`LBNL/Klems Full`, `LBNL/Klems Half`, `LBNL/Klems Quarter` or the name of an AngleBasis of this file";
            self.text.error(node.word(), BsdfProblem::Unexpected { found: name, expected })
        })
    }

    /// Reads the values of a matrix as `[in][out]`.
    fn matrix(&mut self, node: Node<'_>, incoming: usize, outgoing: usize) -> Result<Vec<f64>, FormatError> {
        let count = incoming * outgoing;
        self.cells += count;
        if self.cells > MOST_CELLS {
            return Err(self.text.error(node.place(), BsdfProblem::TooManyCells { limit: MOST_CELLS }));
        }
        let mut read = Vec::new();
        let mut last = node.place();
        for word in node.text_ranges().iter().flat_map(|range| self.text.words(range.clone())) {
            last = word.clone();
            if read.len() == count {
                let problem = BsdfProblem::Count { what: "values up to here", found: count + 1, count };
                return Err(self.text.error(word, problem));
            }
            read.push(self.text.value(word)?);
        }
        if read.len() < count {
            return Err(self
                .text
                .error(last, BsdfProblem::Count { what: "values", found: read.len(), count }));
        }
        if self.structure == Structure::Rows {
            return Ok(read);
        }
        Ok((0..count).map(|k| read[k % outgoing * incoming + k / outgoing]).collect())
    }

    /// Combines the blocks of each part as its channels.
    fn parts(&mut self) -> Result<Vec<MeasuredPart>, FormatError> {
        let mut parts = Vec::new();
        for way in [
            ScatterMode::FrontReflection,
            ScatterMode::FrontTransmission,
            ScatterMode::BackTransmission,
            ScatterMode::BackReflection,
        ] {
            let (of_way, others) = std::mem::take(&mut self.blocks).into_iter().partition(|b| b.way == way);
            self.blocks = others;
            let mut of_way: Vec<Block> = of_way;
            if of_way.is_empty() {
                continue;
            }
            of_way.sort_by_key(|block| CHANNELS.iter().position(|(_, channel)| *channel == block.channel));
            let has = |channel| of_way.iter().any(|block| block.channel == channel);
            let tristimulus = has(Channel::X) || has(Channel::Z);
            // With X or Z, the visible spectrum is Y.
            let name =
                |channel| if tristimulus && channel == Channel::Monochrome { Channel::Y } else { channel };
            let channels = of_way.iter().map(|block| name(block.channel)).collect();
            let (geometry, values) = self.join(of_way)?;
            parts.push(MeasuredPart { way, channels, geometry, values, tis: Vec::new() });
        }
        Ok(parts)
    }

    fn join(&self, blocks: Vec<Block>) -> Result<(Geometry, Vec<f64>), FormatError> {
        let (mut trees, mut all, mut shared) = (Vec::new(), Vec::new(), None);
        for block in blocks {
            match block.data {
                Data::Tree(values) => trees.push(values),
                Data::Matrix { bases, values } => {
                    if *shared.get_or_insert_with(|| bases.clone()) != bases {
                        let expected = "the same bases as the other spectra of this direction";
                        let problem = BsdfProblem::Unexpected { found: "this basis".to_owned(), expected };
                        return Err(self.text.error(block.place, problem));
                    }
                    all.extend(values);
                }
            }
        }
        if let Some([incoming, outgoing]) = shared {
            return Ok((Geometry::Patches { incoming, outgoing }, all));
        }
        let limit = || self.text.whole(BsdfProblem::TooManyCells { limit: MOST_CELLS });
        let (tree, values) = tree::join(&trees, MOST_CELLS).ok_or_else(limit)?;
        Ok((Geometry::Tree(tree), values))
    }
}

/// Names of the spectra, in the order of the channels of a part.
pub(super) const CHANNELS: [(&str, Channel); 4] = [
    ("CIE-X", Channel::X),
    ("Visible", Channel::Monochrome),
    ("CIE-Z", Channel::Z),
    ("Solar", Channel::Solar),
];

fn channel_of(name: &str) -> Option<Channel> {
    if let Some((_, channel)) = CHANNELS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
        return Some(*channel);
    }
    // A single wavelength, in nm or in um.
    let number: f64 = name.parse().ok()?;
    super::wavelength(number).or_else(|| super::wavelength(1000.0 * number))
}
