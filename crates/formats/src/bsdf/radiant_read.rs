//! Reader of the tabular BSDF of Radiant Imaging and Zemax.
//!
//! The file has a header of keywords and axes. For each channel follow its name and, between `DataBegin` and
//! `DataEnd`, for each rotation and incidence a line `TIS` and one row per azimuth.

use std::ops::Range;

use papilio_goniometry::{
    Channel, Geometry, MeasuredPart, Measurement, Provenance, ScatterMode, SpecularGrid, Symmetry,
};

use super::text::{Lines, Text};
use super::{BsdfProblem, LARGEST_VALUE, MOST_CELLS, Warned};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// Name of the format.
pub(super) const NAME: &str = "Radiant/Zemax tabular BSDF";
/// Beginning of a remark that holds the name of the sample.
pub(super) const SAMPLE: &str = "sample: ";

/// Keywords of the axes, in the order of the file, with the ranges of their angles, degrees.
pub(super) const AXES: [(&str, f64, f64); 4] = [
    ("SampleRotation", -360.0, 360.0),
    ("AngleOfIncidence", 0.0, 90.0),
    ("ScatterAzimuth", -360.0, 360.0),
    ("ScatterRadial", 0.0, 180.0),
];

/// Returns whether a file begins with one of the keywords of this format.
pub(super) fn is_radiant(file: &DataFile) -> bool {
    let text = Text::new(file);
    let mut lines = Lines::new(text);
    let Ok(Some(line)) = lines.next() else { return false };
    let Some(word) = text.words(line).next() else { return false };
    ["Source", "Symmetry", "SpectralContent", "ScatterType"].iter().any(|key| text.is(&word, key))
        || AXES.iter().any(|(key, ..)| text.is(&word, key))
}

pub(super) fn read(file: &DataFile) -> Result<Warned<Measurement>, FormatError> {
    let mut lines = Lines::new(Text::new(file));
    let mut header = Header::default();
    let first = header.read(&mut lines)?;
    let (way, symmetry, channels) = header.kinds(&lines)?;
    let mut grid = header.grid(&lines, symmetry)?;
    let mut data = Data::new(&lines, &grid, channels.len())?;
    for (k, &channel) in channels.iter().enumerate() {
        let line = if k == 0 { first.clone() } else { lines.expect("the last channel")? };
        expect_word(lines.text, line, block_name(channel))?;
        data.block(&mut lines, &grid)?;
    }
    if let Some(line) = lines.next()? {
        return Err(unexpected(lines.text, line, "the end of the file"));
    }
    grid.symmetry = symmetry;
    let part = MeasuredPart {
        way,
        channels,
        geometry: Geometry::Specular(grid),
        values: data.values,
        tis: data.tis,
    };
    let warnings = header.warnings(way, symmetry, &part);
    let source = header.source.unwrap_or_default();
    // Papilio's writer stores the name of the sample in a remark.
    let (samples, remarks): (Vec<_>, Vec<_>) =
        lines.comments.into_iter().partition(|remark| remark.starts_with(SAMPLE));
    let sample =
        samples.first().and_then(|remark| remark.strip_prefix(SAMPLE)).unwrap_or_default().to_owned();
    let provenance = Provenance { format: NAME.to_owned(), sample, source, remarks };
    Ok(Warned { value: Measurement { provenance, media: [1.0, 1.0], parts: vec![part] }, warnings })
}

/// Returns the keyword at the beginning of a channel's block.
pub(super) fn block_name(channel: Channel) -> &'static str {
    match channel {
        Channel::X => "TristimulusX",
        Channel::Y => "TristimulusY",
        Channel::Z => "TristimulusZ",
        _ => "Monochrome",
    }
}

/// The keywords read so far, with the places of their values.
#[derive(Default)]
struct Header {
    source: Option<String>,
    symmetry: Option<Range<usize>>,
    content: Option<Range<usize>>,
    scatter: Option<Range<usize>>,
    axes: [Option<Vec<f64>>; 4],
    skipped: Vec<String>,
}

impl Header {
    /// Reads up to the first line that is not a keyword of the header, and returns it: the name of the first
    /// block.
    fn read(&mut self, lines: &mut Lines<'_>) -> Result<Range<usize>, FormatError> {
        loop {
            let line = lines.expect("the first block of data")?;
            let text = lines.text;
            let mut words = text.words(line.clone());
            let Some(key) = words.next() else { continue };
            if [Channel::Monochrome, Channel::X].iter().any(|&channel| text.is(&key, block_name(channel))) {
                return Ok(line);
            }
            let rest = words.next();
            if let Some(axis) = AXES.iter().position(|(name, ..)| text.is(&key, name)) {
                self.axis(lines, axis, key, rest)?;
            } else if text.is(&key, "Source") {
                self.source = Some(text.quote(key.end..line.end));
            } else if let Some(slot) = self.slot(text, &key) {
                if slot.is_some() {
                    return Err(text.error(key.clone(), BsdfProblem::Twice { what: text.quote(key) }));
                }
                *slot = Some(rest.unwrap_or(line));
            } else if text.bytes[key.start].is_ascii_alphabetic() && !text.is(&key, "DataBegin") {
                self.skipped.push(text.quote(line));
            } else {
                return Err(unexpected(
                    text,
                    line,
                    "a keyword such as `ScatterType`, or `Monochrome` or `TristimulusX`",
                ));
            }
        }
    }

    fn slot(&mut self, text: Text<'_>, key: &Range<usize>) -> Option<&mut Option<Range<usize>>> {
        [
            ("Symmetry", &mut self.symmetry),
            ("SpectralContent", &mut self.content),
            ("ScatterType", &mut self.scatter),
        ]
        .into_iter()
        .find_map(|(name, slot)| text.is(key, name).then_some(slot))
    }

    fn axis(
        &mut self,
        lines: &mut Lines<'_>,
        axis: usize,
        key: Range<usize>,
        count: Option<Range<usize>>,
    ) -> Result<(), FormatError> {
        let text = lines.text;
        let (what, least, most) = AXES[axis];
        if self.axes[axis].is_some() {
            return Err(text.error(key, BsdfProblem::Twice { what: what.to_owned() }));
        }
        let count_at = count.unwrap_or(key.end..key.end);
        let count = count_of(text, count_at)?;
        let line = lines.expect("the angles of an axis")?;
        let mut values: Vec<f64> = Vec::new();
        for word in text.words(line.clone()) {
            let value = text.number(word.clone())?;
            if !(least..=most).contains(&value) {
                let expected = match axis {
                    1 => "an angle from 0 to 90 deg",
                    3 => "an angle from 0 to 180 deg",
                    _ => "an angle from -360 to 360 deg",
                };
                return Err(text.error(word, Problem::OutOfRange { what, value, expected }));
            }
            if let Some(&before) = values.last().filter(|before| **before >= value) {
                return Err(text.error(word, BsdfProblem::Order { what, value, before }));
            }
            values.push(value);
        }
        if values.len() != count {
            let problem = BsdfProblem::Count { what: "angles", found: values.len(), count };
            return Err(text.error(line, problem));
        }
        self.axes[axis] = Some(values);
        Ok(())
    }

    fn kinds(&self, lines: &Lines<'_>) -> Result<(ScatterMode, Symmetry, Vec<Channel>), FormatError> {
        let text = lines.text;
        let one_of = |slot: &Option<Range<usize>>, what, known: &[&str], expected| {
            let word = slot.clone().ok_or_else(|| text.whole(BsdfProblem::Missing { what }))?;
            let found = known.iter().position(|known| text.is(&word, known));
            found.ok_or_else(|| unexpected(text, word, expected))
        };
        let scatter = one_of(&self.scatter, "line `ScatterType`", &["BRDF", "BTDF"], "BRDF or BTDF")?;
        let symmetry = one_of(
            &self.symmetry,
            "line `Symmetry`",
            &["PlaneSymmetrical", "Asymmetrical", "Asymmetrical4D"],
            "PlaneSymmetrical, Asymmetrical or Asymmetrical4D",
        )?;
        let content =
            one_of(&self.content, "line `SpectralContent`", &["Monochrome", "XYZ"], "Monochrome or XYZ")?;
        Ok((
            [ScatterMode::FrontReflection, ScatterMode::FrontTransmission][scatter],
            if symmetry == 0 { Symmetry::Plane } else { Symmetry::None },
            if content == 0 { vec![Channel::Monochrome] } else { vec![Channel::X, Channel::Y, Channel::Z] },
        ))
    }

    fn grid(&mut self, lines: &Lines<'_>, symmetry: Symmetry) -> Result<SpecularGrid, FormatError> {
        let missing = |what| lines.text.whole(BsdfProblem::Missing { what });
        let [rotations, incidences, azimuths, radials] = &mut self.axes;
        let grid = SpecularGrid {
            // Some programs omit the rotations if the sample was not rotated.
            rotations_deg: rotations.take().unwrap_or_else(|| vec![0.0]),
            incidences_deg: incidences.take().ok_or_else(|| missing("line `AngleOfIncidence`"))?,
            azimuths_deg: azimuths.take().ok_or_else(|| missing("line `ScatterAzimuth`"))?,
            radials_deg: radials.take().ok_or_else(|| missing("line `ScatterRadial`"))?,
            symmetry,
        };
        let outside = grid.azimuths_deg.iter().find(|a| !(0.0..=180.0).contains(*a));
        if let (Symmetry::Plane, Some(&value)) = (symmetry, outside) {
            let expected = "0 to 180 deg, because the table is PlaneSymmetrical";
            return Err(lines.text.whole(Problem::OutOfRange { what: "ScatterAzimuth", value, expected }));
        }
        Ok(grid)
    }

    fn warnings(&self, way: ScatterMode, symmetry: Symmetry, part: &MeasuredPart) -> Vec<String> {
        let mut warnings: Vec<String> = self
            .skipped
            .iter()
            .map(|line| format!("the line `{line}` has an unknown keyword and was ignored"))
            .collect();
        if way.is_transmission() && symmetry == Symmetry::None {
            warnings.push(
                "the sense of ScatterAzimuth in an asymmetrical BTDF is not documented: it was read as in reflection, \
                 seen from the side of the light; check it with the sample"
                    .to_owned(),
            );
        }
        if matches!(&part.geometry, Geometry::Specular(grid) if grid.rotations_deg.len() > 1) {
            warnings.push(
                "the sense of SampleRotation is not documented: a counter-clockwise rotation of the sample, seen from the \
                 front, is assumed"
                    .to_owned(),
            );
        }
        let largest = part.tis.iter().copied().fold(0.0, f64::max);
        if part.tis_in_percent() {
            warnings.push(format!(
                "the TIS, up to {largest}, is in per cent, but the format has fractions from 0 to 1: divide the lines `TIS` by 100 before \
                 `normalise = \"tis\"`"
            ));
        } else if largest > 1.0 + 1e-9 {
            warnings.push("a TIS is above 1: more light leaves than arrives".to_owned());
        }
        warnings
    }
}

/// Reads a count: an integer of 1 or more.
pub(super) fn count_of(text: Text<'_>, word: Range<usize>) -> Result<usize, FormatError> {
    let value = text.number(word.clone())?;
    if value >= 1.0 && value <= MOST_CELLS as f64 && value.fract() == 0.0 {
        return Ok(value as usize);
    }
    let expected = "an integer of 1 or more";
    Err(text.error(word, Problem::OutOfRange { what: "the number of angles", value, expected }))
}

/// Content of the blocks.
struct Data {
    values: Vec<f64>,
    tis: Vec<f64>,
}

impl Data {
    fn new(lines: &Lines<'_>, grid: &SpecularGrid, channels: usize) -> Result<Self, FormatError> {
        let axes = [&grid.rotations_deg, &grid.incidences_deg, &grid.azimuths_deg, &grid.radials_deg];
        let cells = axes.iter().try_fold(channels, |cells, axis| cells.checked_mul(axis.len()));
        let cells = cells.filter(|cells| *cells <= MOST_CELLS);
        let cells = cells.ok_or_else(|| lines.text.whole(BsdfProblem::TooManyCells { limit: MOST_CELLS }))?;
        // A value takes at least two bytes of the file, which limits the memory.
        Ok(Self { values: Vec::with_capacity(cells.min(lines.text.bytes.len() / 2)), tis: Vec::new() })
    }

    fn block(&mut self, lines: &mut Lines<'_>, grid: &SpecularGrid) -> Result<(), FormatError> {
        let text = lines.text;
        expect_word(text, lines.expect("`DataBegin`")?, "DataBegin")?;
        for _ in 0..grid.rotations_deg.len() * grid.incidences_deg.len() {
            self.tis(lines)?;
            for _ in 0..grid.azimuths_deg.len() {
                let line = lines.expect("the last row of data")?;
                self.row(text, line, grid.radials_deg.len())?;
            }
        }
        expect_word(text, lines.expect("`DataEnd`")?, "DataEnd")
    }

    fn tis(&mut self, lines: &mut Lines<'_>) -> Result<(), FormatError> {
        let line = lines.expect("the last row of data")?;
        let text = lines.text;
        let mut words = text.words(line.clone());
        let is_tis = words.next().is_some_and(|word| text.is(&word, "TIS"));
        let (true, Some(word)) = (is_tis, words.next()) else {
            return Err(unexpected(
                text,
                line,
                "a line `TIS` with its value, at the beginning of each incidence",
            ));
        };
        let value = text.number(word.clone())?;
        // Some programs write percent, and some measured TIS are above 1.
        if !(0.0..=LARGEST_VALUE).contains(&value) {
            let problem = Problem::OutOfRange { what: "TIS", value, expected: "a fraction from 0 to 1" };
            return Err(text.error(word, problem));
        }
        self.tis.push(value);
        Ok(())
    }

    fn row(&mut self, text: Text<'_>, line: Range<usize>, count: usize) -> Result<(), FormatError> {
        let before = self.values.len();
        for word in text.words(line.clone()) {
            self.values.push(text.value(word)?);
        }
        match self.values.len() - before {
            found if found == count => Ok(()),
            found => Err(text.error(line, BsdfProblem::Count { what: "values in this row", found, count })),
        }
    }
}

fn expect_word(text: Text<'_>, line: Range<usize>, word: &'static str) -> Result<(), FormatError> {
    if text.words(line.clone()).next().is_some_and(|found| text.is(&found, word)) {
        return Ok(());
    }
    let expected = match word {
        "DataBegin" => "`DataBegin`",
        "DataEnd" => "`DataEnd`, because the axes define no further rows",
        "TristimulusX" => "`TristimulusX`, because SpectralContent is XYZ",
        "TristimulusY" => "`TristimulusY`",
        "TristimulusZ" => "`TristimulusZ`",
        _ => "`Monochrome`, because SpectralContent is Monochrome",
    };
    Err(unexpected(text, line, expected))
}

fn unexpected(text: Text<'_>, range: Range<usize>, expected: &'static str) -> FormatError {
    let found = text.words(range.clone()).next().map_or_else(String::new, |word| text.quote(word));
    text.error(range, BsdfProblem::Unexpected { found, expected })
}
