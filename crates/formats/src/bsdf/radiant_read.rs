//! Reads the tabular BSDF of Radiant Imaging and Zemax.
//!
//! A header of keywords and axes; then, for each channel, its name and between `DataBegin` and
//! `DataEnd` for each rotation and incidence a line `TIS` and a row for each azimuth.

use std::ops::Range;

use papilio_goniometry::{Channel, Geometry, Measurement, Part, Provenance, SpecularGrid, Symmetry, Way};

use super::text::{Lines, Text};
use super::{BsdfProblem, LARGEST_VALUE, MOST_CELLS, Warned};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// How the format is called.
pub(super) const NAME: &str = "Radiant/Zemax tabular BSDF";
/// What a remark that names the sample begins with.
pub(super) const SAMPLE: &str = "sample: ";

/// The axes' keywords, in the file's order, with the range of their angles.
pub(super) const AXES: [(&str, f64, f64); 4] = [
    ("SampleRotation", -360.0, 360.0),
    ("AngleOfIncidence", 0.0, 90.0),
    ("ScatterAzimuth", -360.0, 360.0),
    ("ScatterRadial", 0.0, 180.0),
];

/// Whether a file begins as this format does: with one of its keywords.
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
        let line = if k == 0 { first.clone() } else { lines.expect("all channels are read")? };
        expect_word(lines.text, line, block_name(channel))?;
        data.block(&mut lines, &grid)?;
    }
    if let Some(line) = lines.next()? {
        return Err(unexpected(lines.text, line, "the end of the file"));
    }
    let warnings = header.warnings(way, symmetry, &data, &grid);
    grid.symmetry = symmetry;
    let part = Part { way, channels, geometry: Geometry::Specular(grid), values: data.values, tis: data.tis };
    let source = header.source.unwrap_or_default();
    // The writer's own remark.
    let (samples, remarks): (Vec<_>, Vec<_>) =
        lines.comments.into_iter().partition(|remark| remark.starts_with(SAMPLE));
    let sample =
        samples.first().and_then(|remark| remark.strip_prefix(SAMPLE)).unwrap_or_default().to_owned();
    let provenance = Provenance { format: NAME.to_owned(), sample, source, remarks };
    Ok(Warned { value: Measurement { provenance, media: [1.0, 1.0], parts: vec![part] }, warnings })
}

/// What a channel's block begins with.
pub(super) fn block_name(channel: Channel) -> &'static str {
    match channel {
        Channel::X => "TristimulusX",
        Channel::Y => "TristimulusY",
        Channel::Z => "TristimulusZ",
        _ => "Monochrome",
    }
}

/// The keywords, as far as they have been met: where their word stands.
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
    /// Reads to the first line that is no keyword, the name of the first block.
    fn read(&mut self, lines: &mut Lines<'_>) -> Result<Range<usize>, FormatError> {
        loop {
            let line = lines.expect("its data begin")?;
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
                return Err(unexpected(text, line, "a keyword, as `ScatterType`, or `Monochrome`"));
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
                let expected = "an angle in degrees";
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

    fn kinds(&self, lines: &Lines<'_>) -> Result<(Way, Symmetry, Vec<Channel>), FormatError> {
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
            [Way::FrontReflection, Way::FrontTransmission][scatter],
            if symmetry == 0 { Symmetry::Plane } else { Symmetry::None },
            if content == 0 { vec![Channel::Monochrome] } else { vec![Channel::X, Channel::Y, Channel::Z] },
        ))
    }

    fn grid(&mut self, lines: &Lines<'_>, symmetry: Symmetry) -> Result<SpecularGrid, FormatError> {
        let missing = |what| lines.text.whole(BsdfProblem::Missing { what });
        let [rotations, incidences, azimuths, radials] = &mut self.axes;
        let grid = SpecularGrid {
            // Some writers leave out what they do not turn.
            rotations_deg: rotations.take().unwrap_or_else(|| vec![0.0]),
            incidences_deg: incidences.take().ok_or_else(|| missing("line `AngleOfIncidence`"))?,
            azimuths_deg: azimuths.take().ok_or_else(|| missing("line `ScatterAzimuth`"))?,
            radials_deg: radials.take().ok_or_else(|| missing("line `ScatterRadial`"))?,
            symmetry,
        };
        let outside = grid.azimuths_deg.iter().find(|a| !(0.0..=180.0).contains(*a));
        if let (Symmetry::Plane, Some(&value)) = (symmetry, outside) {
            let expected = "0 to 180 deg, as the table is PlaneSymmetrical";
            return Err(lines.text.whole(Problem::OutOfRange { what: "ScatterAzimuth", value, expected }));
        }
        Ok(grid)
    }

    fn warnings(&self, way: Way, symmetry: Symmetry, data: &Data, grid: &SpecularGrid) -> Vec<String> {
        let mut warnings: Vec<String> = self
            .skipped
            .iter()
            .map(|line| format!("the line `{line}` was not understood and left out"))
            .collect();
        if way.is_transmission() && symmetry == Symmetry::None {
            warnings.push(
                "which way ScatterAzimuth turns in an asymmetrical BTDF is not settled: it is read as in reflection, \
                 seen from the side of the light; check it against the sample"
                    .to_owned(),
            );
        }
        if grid.rotations_deg.len() > 1 {
            warnings.push(
                "which way SampleRotation turns is not settled: the sample is taken to turn counter-clockwise seen from the front"
                    .to_owned(),
            );
        }
        if data.tis.iter().any(|tis| *tis > 1.0) {
            warnings.push("a TIS is above 1: more light than came in, or percent".to_owned());
        }
        warnings
    }
}

/// A count that is written in a text: a whole number of 1 or more.
pub(super) fn count_of(text: Text<'_>, word: Range<usize>) -> Result<usize, FormatError> {
    let value = text.number(word.clone())?;
    if value >= 1.0 && value <= MOST_CELLS as f64 && value.fract() == 0.0 {
        return Ok(value as usize);
    }
    let expected = "a whole number, 1 or more";
    Err(text.error(word, Problem::OutOfRange { what: "the number of angles", value, expected }))
}

/// What the blocks hold.
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
        // A value takes two bytes at least: never more memory than the file warrants.
        Ok(Self { values: Vec::with_capacity(cells.min(lines.text.bytes.len() / 2)), tis: Vec::new() })
    }

    fn block(&mut self, lines: &mut Lines<'_>, grid: &SpecularGrid) -> Result<(), FormatError> {
        let text = lines.text;
        expect_word(text, lines.expect("`DataBegin`")?, "DataBegin")?;
        for _ in 0..grid.rotations_deg.len() * grid.incidences_deg.len() {
            self.tis(lines)?;
            for _ in 0..grid.azimuths_deg.len() {
                let line = lines.expect("all its rows are read")?;
                self.row(text, line, grid.radials_deg.len())?;
            }
        }
        expect_word(text, lines.expect("`DataEnd`")?, "DataEnd")
    }

    fn tis(&mut self, lines: &mut Lines<'_>) -> Result<(), FormatError> {
        let line = lines.expect("all its rows are read")?;
        let text = lines.text;
        let mut words = text.words(line.clone());
        let is_tis = words.next().is_some_and(|word| text.is(&word, "TIS"));
        let (true, Some(word)) = (is_tis, words.next()) else {
            return Err(unexpected(text, line, "`TIS` and its value: each incidence begins so"));
        };
        let value = text.number(word.clone())?;
        // Some writers give percent, and some totals are above 1.
        if !(0.0..=LARGEST_VALUE).contains(&value) {
            let problem = Problem::OutOfRange { what: "TIS", value, expected: "a share, 0 to 1" };
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
        "DataEnd" => "`DataEnd`: the data have more rows than the axes say",
        "TristimulusX" => "`TristimulusX`, as SpectralContent says",
        "TristimulusY" => "`TristimulusY`",
        "TristimulusZ" => "`TristimulusZ`",
        _ => "`Monochrome`, as SpectralContent says",
    };
    Err(unexpected(text, line, expected))
}

fn unexpected(text: Text<'_>, range: Range<usize>, expected: &'static str) -> FormatError {
    let found = text.words(range.clone()).next().map_or_else(String::new, |word| text.quote(word));
    text.error(range, BsdfProblem::Unexpected { found, expected })
}
