//! Lines of a text before its heights: sizes, units, the number for missing heights, names of columns.
//!
//! A line states a quantity as `Name: value unit`, `Name = value unit`, or by cells `Name, value, unit`; it
//! may begin with `#`. Known are the lines of Gwyddion (in its languages), SPIP, Nova, the ESRI grid, and
//! their like. A line with a size, a scale or a unit that is not known is an error; other lines are listed in
//! a warning, except comments.

use super::units::um_of;

/// What the lines state. Lengths are in their own units until these are known.
#[derive(Debug, Default)]
pub(super) struct Header {
    /// Width and height of the map.
    pub(super) size: [Option<Length>; 2],
    /// Distances of heights.
    pub(super) pitch: [Option<Length>; 2],
    /// Number of heights along x and y.
    pub(super) count: [Option<usize>; 2],
    /// Units along x, y and z, um.
    pub(super) unit_um: [Option<f64>; 3],
    /// Factor of the heights.
    pub(super) factor: Option<f64>,
    /// The number for missing heights.
    pub(super) missing: Option<f64>,
    /// Names of columns: the last line of words only.
    pub(super) names: Option<Names>,
    /// Lines that are not used.
    pub(super) unused: Vec<String>,
}

/// The words of a line that may be the names of columns.
#[derive(Debug)]
pub(super) struct Names {
    pub(super) cells: Vec<String>,
    /// A comment need not name columns.
    pub(super) is_comment: bool,
    line: String,
}

/// A length and its unit in um, if it is stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Length {
    value: f64,
    unit_um: Option<f64>,
}

/// Quantities of a header.
#[derive(Clone, Copy)]
enum Key {
    Size(usize),
    Pitch(usize),
    BothPitches,
    Count(usize),
    Unit(usize),
    LateralUnit,
    AllUnits,
    Factor,
    Missing,
    /// Words about the measurement, without an effect on heights.
    Description,
}

/// Names of quantities: small letters and digits, other characters as blanks.
const KEYS: [(Key, &[&str]); 16] = [
    (
        Key::Size(0),
        &[
            "width",
            "x length",
            "xlength",
            "length x",
            "xreal",
            "x real",
            "x range",
            "size x",
            "physical width",
            "field width",
            "fov x",
            "šířka",
            "breite",
            "anchura",
            "largeur",
            "larghezza",
            "幅",
            "폭",
            "largura",
            "ширина",
        ],
    ),
    (
        Key::Size(1),
        &[
            "height",
            "y length",
            "ylength",
            "length y",
            "yreal",
            "y real",
            "y range",
            "size y",
            "physical height",
            "field height",
            "fov y",
            "výška",
            "höhe",
            "altura",
            "hauteur",
            "altezza",
            "高さ",
            "높이",
            "высота",
        ],
    ),
    (
        Key::Pitch(0),
        &[
            "x pitch",
            "dx",
            "x step",
            "x increment",
            "x spacing",
            "pixel size x",
            "x pixel size",
            "scale x",
            "x scale",
            "sampling x",
            "spacing x",
            "step x",
            "increment x",
            "pixel width",
        ],
    ),
    (
        Key::Pitch(1),
        &[
            "y pitch",
            "dy",
            "y step",
            "y increment",
            "y spacing",
            "pixel size y",
            "y pixel size",
            "scale y",
            "y scale",
            "sampling y",
            "spacing y",
            "step y",
            "increment y",
            "pixel height",
        ],
    ),
    (
        Key::BothPitches,
        &[
            "pixel size",
            "pitch",
            "pixel pitch",
            "lateral resolution",
            "cellsize",
            "cell size",
            "sampling",
            "spacing",
            "step",
            "xy step",
        ],
    ),
    (
        Key::Count(0),
        &[
            "columns",
            "ncols",
            "x pixels",
            "xpixels",
            "pixels x",
            "nx",
            "xres",
            "x res",
            "x points",
            "points x",
            "number of columns",
            "points per line",
            "numpoints",
            "w",
            "cols",
            "num columns",
        ],
    ),
    (
        Key::Count(1),
        &[
            "rows",
            "nrows",
            "lines",
            "y pixels",
            "ypixels",
            "pixels y",
            "ny",
            "yres",
            "y res",
            "y points",
            "points y",
            "number of rows",
            "number of lines",
            "numprofiles",
            "h",
            "num rows",
        ],
    ),
    (Key::Unit(0), &["x unit", "xunit", "unit x", "x units"]),
    (Key::Unit(1), &["y unit", "yunit", "unit y", "y units"]),
    (
        Key::Unit(2),
        &[
            "z unit",
            "zunit",
            "unit z",
            "z units",
            "zunits",
            "value units",
            "value unit",
            "unit data",
            "data unit",
            "height unit",
            "height units",
            "jednotky hodnot",
            "einheiten",
            "einheit",
            "unités",
            "unità valore",
            "値の単位",
            "값 단위",
            "unidades de valor",
            "единицы измерения",
        ],
    ),
    (Key::LateralUnit, &["lateral units", "lateral unit", "xy unit", "xy units", "xyunits"]),
    (Key::AllUnits, &["unit", "units", "length unit"]),
    (
        Key::Factor,
        &["z scale", "scale z", "scale data", "z factor", "height factor", "height scale", "z increment"],
    ),
    (
        Key::Missing,
        &[
            "nodata value",
            "no data",
            "no data value",
            "nodata",
            "missing",
            "missing value",
            "bad value",
            "invalid value",
            "undefined value",
        ],
    ),
    (
        Key::Description,
        &[
            "channel",
            "title",
            "date",
            "time",
            "operator",
            "instrument",
            "comment",
            "comments",
            "name",
            "sample",
            "kanál",
            "kanal",
            "canal",
            "canale",
            "チャネル",
            "채널",
            "канал",
            "file",
            "fileformat",
            "file format",
            "version",
            "creator",
            "objective",
            "manufacid",
            "created",
            "start of data",
        ],
    ),
    (
        Key::Description,
        &[
            "xllcorner",
            "yllcorner",
            "xllcenter",
            "yllcenter",
            "x offset",
            "y offset",
            "origin x",
            "origin y",
            "x0",
            "y0",
        ],
    ),
];

impl Header {
    /// Reads a line without its `#`. `is_comment`: whether it had one.
    ///
    /// # Errors
    /// A known quantity without a number or with an unknown unit, and an unknown size, scale or unit.
    pub(super) fn read(&mut self, line: &str, is_comment: bool) -> Result<(), String> {
        let line = line.trim();
        if let Some((key, value)) = quantity(line) {
            let (name, own_unit) = name_and_unit(key);
            return match key_of(&name) {
                Some(Key::Description) => Ok(()),
                Some(key) => {
                    self.take(key, value, own_unit).map_err(|what| format!("`{}`: {what}", shown(line)))
                }
                None if states_a_scale(&name, value) => Err(format!(
                    "`{}` is not understood, and seems to state a size, a scale or a unit",
                    shown(line)
                )),
                None => {
                    self.note(line, is_comment);
                    Ok(())
                }
            };
        }
        let cells: Vec<String> = line
            .split([',', ';', '\t'])
            .flat_map(|cell| {
                if line.contains([',', ';', '\t']) { vec![cell] } else { cell.split_whitespace().collect() }
            })
            .map(|cell| cell.trim().trim_matches('"').to_owned())
            .filter(|cell| !cell.is_empty())
            .collect();
        // A row of units below the names.
        let bare = |cell: &String| cell.trim_matches(['(', ')', '[', ']']).to_owned();
        let units: Vec<String> = cells.iter().map(bare).collect();
        if let Some(names) = &mut self.names
            && names.cells.len() == units.len()
            && units.iter().all(|unit| um_of(unit).is_some())
        {
            for (name, unit) in names.cells.iter_mut().zip(&units) {
                *name = format!("{name} ({unit})");
            }
            return Ok(());
        }
        // They are used if there are as many columns.
        self.note(line, is_comment);
        if cells.len() >= 2 {
            self.names = Some(Names { cells, is_comment, line: shown(line) });
        }
        Ok(())
    }

    /// The names of this number of columns. Their line counts as used.
    pub(super) fn take_names(&mut self, columns: usize) {
        self.names = self.names.take().filter(|names| names.cells.len() == columns);
        if let Some(names) = &self.names {
            self.unused.retain(|line| *line != names.line);
        }
    }

    fn note(&mut self, line: &str, is_comment: bool) {
        if !is_comment && !line.is_empty() {
            self.unused.push(shown(line));
        }
    }

    fn take(&mut self, key: Key, value: &str, own_unit: Option<f64>) -> Result<(), String> {
        let (number, rest) = leading_number(value);
        let positive =
            || number.filter(|number| *number > 0.0).ok_or("a number above 0 is expected".to_owned());
        let unit =
            |text: &str| um_of(text).ok_or_else(|| format!("`{}` is not a unit of length", shown(text)));
        let length = || -> Result<Option<Length>, String> {
            let value = positive()?;
            let stated = if rest.is_empty() { own_unit } else { Some(unit(rest)?) };
            Ok(Some(Length { value, unit_um: stated }))
        };
        match key {
            Key::Size(axis) => self.size[axis] = length()?,
            Key::Pitch(axis) => self.pitch[axis] = length()?,
            Key::BothPitches => self.pitch = [length()?; 2],
            Key::Count(axis) => {
                let count = number.filter(|number| number.fract() == 0.0 && (1.0..1e9).contains(number));
                self.count[axis] = Some(count.ok_or("a whole number is expected")? as usize);
            }
            Key::Unit(axis) => self.unit_um[axis] = Some(unit(value)?),
            Key::LateralUnit => (self.unit_um[0], self.unit_um[1]) = (Some(unit(value)?), Some(unit(value)?)),
            Key::AllUnits => self.unit_um = [Some(unit(value)?); 3],
            Key::Factor => {
                self.factor = Some(positive()?);
                self.unit_um[2] =
                    if rest.is_empty() { own_unit.or(self.unit_um[2]) } else { Some(unit(rest)?) };
            }
            Key::Missing => self.missing = Some(number.ok_or("a number is expected")?),
            Key::Description => {}
        }
        Ok(())
    }

    /// Distance of heights along an axis, um, from the distance itself or the width over the number of
    /// heights. The unit of an axis that states none is that of the other, or um.
    pub(super) fn pitch_um(&self, axis: usize, count: usize) -> Option<f64> {
        let axis_um = self.unit_um[axis].or(self.unit_um[1 - axis]).unwrap_or(1.0);
        let um = |length: Length| length.value * length.unit_um.unwrap_or(axis_um);
        self.pitch[axis].map(um).or_else(|| Some(um(self.size[axis]?) / count as f64))
    }

    /// Whether a length is stated without a unit.
    pub(super) fn lacks_a_unit(&self) -> bool {
        let lengths = self.size.iter().chain(&self.pitch).flatten();
        let is_stated = self.unit_um[0].or(self.unit_um[1]).is_some();
        lengths.into_iter().any(|length| length.unit_um.is_none() && !is_stated)
    }
}

/// The name and the value of a line.
fn quantity(line: &str) -> Option<(&str, &str)> {
    if let Some((key, value)) = line.split_once([':', '=', '：']) {
        return Some((key, value.trim()));
    }
    // `X Size<tab>640`, `Pixel Size,0.5,um`, `X Pixels 512`: the value begins at the first number.
    let at = line.find(['\t', ';', ',']).or_else(|| {
        let mut words = line.match_indices(char::is_whitespace).map(|(at, _)| at);
        words.find(|at| {
            line[*at..].trim_start().starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '+' | '.'))
        })
    })?;
    let value = line[at..].trim_matches(|c: char| c.is_whitespace() || c == ',' || c == ';');
    // A word such as a unit, if it is the only one; several are names of columns.
    let is_word = || !value.contains(['\t', ';', ',']) && key_of(&name_and_unit(&line[..at]).0).is_some();
    let is_quantity = leading_number(value).0.is_some() || is_word();
    (is_quantity && line[..at].parse::<f64>().is_err()).then(|| (&line[..at], value))
}

/// The quantity of a name.
fn key_of(name: &str) -> Option<Key> {
    KEYS.iter().find(|(_, names)| names.contains(&name)).map(|(key, _)| *key)
}

/// A name in small letters and digits, and the unit in brackets behind it.
fn name_and_unit(key: &str) -> (String, Option<f64>) {
    let (name, unit) = match key.trim().split_once(['(', '[']) {
        Some((name, unit)) => (name, um_of(unit)),
        None => (key, None),
    };
    let plain: String =
        name.to_lowercase().chars().map(|c| if c.is_alphanumeric() { c } else { ' ' }).collect();
    (plain.split_whitespace().collect::<Vec<_>>().join(" "), unit)
}

/// Whether a line with an unknown name may change what the numbers mean.
fn states_a_scale(name: &str, value: &str) -> bool {
    const WORDS: [&str; 15] = [
        "unit",
        "units",
        "scale",
        "size",
        "length",
        "factor",
        "pitch",
        "spacing",
        "step",
        "increment",
        "width",
        "height",
        "resolution",
        "multiplier",
        "bit2nm",
    ];
    let is_quantity = leading_number(value).0.is_some() || um_of(value).is_some();
    is_quantity && name.split(' ').any(|word| WORDS.contains(&word))
}

/// The number at the start of a value, with a point or a comma, and the rest.
fn leading_number(value: &str) -> (Option<f64>, &str) {
    let value = value.trim();
    let end = value.find(|c: char| c.is_whitespace() || c == ';' || c == '\t').unwrap_or(value.len());
    // A number may touch its unit: `10um`.
    let digits = value[..end].trim_end_matches(|c: char| !c.is_ascii_digit() && c != '.');
    match digits.replace(',', ".").parse::<f64>() {
        Ok(number) if number.is_finite() => {
            (Some(number), value[digits.len()..].trim_matches([',', ';', ' ', '\t']))
        }
        _ => (None, value),
    }
}

/// A line for a message, shortened.
pub(super) fn shown(line: &str) -> String {
    let short: String = line.chars().take(40).collect();
    let end = if short.len() < line.len() { "..." } else { "" };
    format!("{}{end}", short.escape_debug())
}
