//! CGATS.17 and ISO 28178, and the files of Argyll, which have the same syntax: keywords, names of fields,
//! rows of data.

use papilio_colour::Standard;

use super::{Kind, Sample, Source, SpectralFile, illuminant, observer};
use crate::error::FormatError;

const FORMAT: &str = "CGATS";

/// Beginnings of the names of fields that hold a value of a spectrum; the rest of the name is the wavelength.
const SPECTRAL: [&str; 10] =
    ["SPECTRAL_NM_", "SPECTRAL_NM", "SPECTRAL_", "SPECTRAL", "SPEC_", "SPEC", "NM_", "NM", "R_", "WL_"];

/// Returns whether the text has the names of fields of CGATS.
pub(super) fn is_cgats(text: &str) -> bool {
    text.lines().any(|line| line.trim() == "BEGIN_DATA_FORMAT")
}

/// A word of the file, with its line.
struct Word<'a> {
    text: &'a str,
    line: usize,
}

/// Returns the words of a text. A text in double quotes is one word; `#` begins a comment.
fn words(text: &str) -> Vec<Word<'_>> {
    let mut words = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let mut rest = line.trim();
        while !rest.is_empty() && !rest.starts_with('#') {
            let (word, after) = match rest.strip_prefix('"') {
                Some(inner) => inner.split_once('"').unwrap_or((inner, "")),
                None => rest.split_once(char::is_whitespace).unwrap_or((rest, "")),
            };
            words.push(Word { text: word, line: k + 1 });
            rest = after.trim_start();
        }
    }
    words
}

/// The parts of the first table of a file.
struct Parts<'a> {
    head: &'a [Word<'a>],
    fields: &'a [Word<'a>],
    data: &'a [Word<'a>],
    has_more: bool,
}

impl<'a> Parts<'a> {
    fn of(source: Source<'_>, words: &'a [Word<'a>]) -> Result<Self, FormatError> {
        let find = |mark: &str, from: usize| {
            let at = words[from..].iter().position(|word| word.text == mark).map(|at| from + at);
            let after = source.range(words[from].text);
            let what = || format!("there is no {mark} after `{}`", words[from].text);
            at.ok_or_else(|| source.at(after, what()))
        };
        let begin = find("BEGIN_DATA_FORMAT", 0)?;
        let end = find("END_DATA_FORMAT", begin)?;
        let data = find("BEGIN_DATA", end)?;
        let last = find("END_DATA", data)?;
        Ok(Self {
            head: &words[..begin],
            fields: &words[begin + 1..end],
            data: &words[data + 1..last],
            has_more: words[last + 1..].iter().any(|word| word.text == "BEGIN_DATA"),
        })
    }

    /// Returns the value of a keyword.
    fn value(&self, keyword: &str) -> Option<&'a str> {
        let pairs = self.head.windows(2);
        // `KEYWORD "X"` declares a keyword; its value follows on another line.
        let mut found = pairs.filter(|pair| pair[0].text == keyword && pair[0].line == pair[1].line);
        found.next().map(|pair| pair[1].text)
    }

    fn number(&self, keyword: &str) -> Option<f64> {
        self.value(keyword)?.parse().ok().filter(|value: &f64| value.is_finite())
    }

    fn field(&self, names: &[&str]) -> Option<usize> {
        let is = |field: &Word<'_>, name: &str| field.text.eq_ignore_ascii_case(name);
        names.iter().find_map(|name| self.fields.iter().position(|field| is(field, name)))
    }

    /// Returns the three fields of a colour.
    fn colour(&self, names: [&str; 3]) -> Option<[usize; 3]> {
        let [a, b, c] = names.map(|name| self.field(&[name]));
        Some([a?, b?, c?])
    }

    /// Returns a note on the fields of standard deviations that are not used, if there are any.
    fn unused_deviations(&self, used: Option<[usize; 3]>, is_xyz: bool, has_spectra: bool) -> Option<String> {
        let is_used = |field: &usize| used.is_some_and(|used| used.contains(field));
        let is_one = |field: &usize| self.fields[*field].text.to_ascii_uppercase().starts_with("STDEV_");
        let fields = (0..self.fields.len()).filter(|field| is_one(field) && !is_used(field));
        let names: Vec<&str> = fields.map(|field| self.fields[field].text).collect();
        let needed = match (has_spectra, is_xyz) {
            (true, _) => "the spectra are read, and CGATS has standard deviations of colours only",
            (false, true) => "those of X, Y, Z are STDEV_X, STDEV_Y and STDEV_Z, all three",
            (false, false) => "those of L*, a*, b* are STDEV_L, STDEV_A and STDEV_B, all three",
        };
        let are = if names.len() == 1 { "is" } else { "are" };
        (!names.is_empty()).then(|| format!("{} {are} not used: {needed}", names.join(", ")))
    }

    /// Returns the observer of the colours: of `WEIGHTING_FUNCTION "OBSERVER, 10 degree"`, or `OBSERVER "10"`.
    fn observer(&self) -> Option<Standard> {
        let pairs = self.head.windows(2).filter(|pair| pair[0].line == pair[1].line);
        let mut stated = pairs.filter_map(|pair| match pair[0].text {
            "OBSERVER" | "OBSERVER_ANGLE" => observer(pair[1].text),
            "WEIGHTING_FUNCTION" => {
                let text = pair[1].text.to_ascii_uppercase();
                observer(text.strip_prefix("OBSERVER")?)
            }
            _ => None,
        });
        stated.next()
    }

    /// Returns the illuminant of the colours: of `WEIGHTING_FUNCTION "ILLUMINANT, D50"`, or else of `ILLUMINATION_NAME "D50"`. What
    /// `MEASUREMENT_SOURCE` states comes last: it may be the lamp of the instrument.
    fn illuminant(&self) -> Option<String> {
        let stated = |keywords: &[&str], begin: &str| {
            let pairs = self.head.windows(2).filter(|pair| pair[0].line == pair[1].line);
            let texts = pairs.filter(|pair| keywords.contains(&pair[0].text)).map(|pair| pair[1].text);
            texts.filter(|text| text.to_ascii_uppercase().starts_with(begin)).find_map(illuminant)
        };
        stated(&["WEIGHTING_FUNCTION"], "ILLUMINANT")
            .or_else(|| stated(&["ILLUMINATION_NAME", "ILLUMINANT", "ILLUMINANT_NAME"], ""))
            .or_else(|| stated(&["MEASUREMENT_SOURCE"], ""))
    }

    /// Checks what keywords state of the spectra against their fields.
    fn check_spectral(&self, spectral: &[(usize, f64)], source: Source<'_>) -> Result<(), FormatError> {
        let wrong = |keyword: &str, what: String| {
            Err(source.at(source.range(self.value(keyword).unwrap_or_default()), what))
        };
        let (bands, count) = (self.number("SPECTRAL_BANDS"), spectral.len());
        if let Some(bands) = bands.filter(|bands| count > 0 && *bands != count as f64) {
            return wrong(
                "SPECTRAL_BANDS",
                format!("SPECTRAL_BANDS is {bands}, and {count} fields are of spectra"),
            );
        }
        let ends = [("SPECTRAL_START_NM", spectral.first()), ("SPECTRAL_END_NM", spectral.last())];
        for (keyword, field) in ends {
            // Names of fields are rounded to nm.
            let stated = self.number(keyword).zip(field);
            if let Some((stated, (field, nm))) = stated.filter(|(stated, (_, nm))| (stated - nm).abs() > 0.51)
            {
                let name = self.fields[*field].text;
                return wrong(keyword, format!("{keyword} is {stated}, and the field {name} is of {nm} nm"));
            }
        }
        match self.number("SPECTRAL_NORM").filter(|norm| *norm <= 0.0) {
            Some(norm) => {
                wrong("SPECTRAL_NORM", format!("SPECTRAL_NORM is {norm}; expected a number above 0"))
            }
            None => Ok(()),
        }
    }

    fn kind(&self) -> Kind {
        let stated = |key: &str| self.value(key).unwrap_or_default().to_ascii_uppercase();
        let words = ["MEAS_TYPE", "DEVICE_CLASS", "MEASUREMENT_TYPE"].map(stated);
        let is = |text: &str| words.iter().any(|word| word.starts_with(text));
        let is_light = self.head.first().is_some_and(|word| word.text == "CCSS")
            || self.head.iter().any(|word| word.text == "Emission");
        if is("REFLECT") {
            Kind::Reflectance
        } else if is("TRANSM") {
            Kind::Transmittance
        } else if is_light || is("EMISSION") || is("EMISSIVE") || is("AMBIENT") || is("DISPLAY") {
            Kind::Light
        } else {
            Kind::Unstated
        }
    }

    /// Returns the fields with values of a spectrum, and their wavelengths in nm. The names of Argyll's
    /// fields are rounded to nm: its keywords give the exact wavelengths.
    fn spectral(&self) -> Vec<(usize, f64)> {
        let nm = |field: &str| {
            let field = field.to_ascii_uppercase();
            let rest = SPECTRAL.iter().find_map(|prefix| field.strip_prefix(prefix))?;
            rest.trim_end_matches("NM").parse().ok().filter(|nm: &f64| (100.0..1e5).contains(nm))
        };
        let mut found: Vec<(usize, f64)> =
            self.fields.iter().enumerate().filter_map(|(k, field)| Some((k, nm(field.text)?))).collect();
        let exact = ["SPECTRAL_START_NM", "SPECTRAL_END_NM"].map(|key| self.number(key));
        if let [Some(start), Some(end)] = exact
            && found.len() > 1
        {
            let step = (end - start) / (found.len() - 1) as f64;
            let at = |k: usize| start + k as f64 * step;
            if found.iter().enumerate().all(|(k, (_, nm))| (at(k) - nm).abs() <= 0.51) {
                found.iter_mut().enumerate().for_each(|(k, (_, nm))| *nm = at(k));
            }
        }
        found
    }
}

/// Returns the fields of wavelengths and of values of CGATS.17's pairs `SPECTRAL_NM SPECTRAL_PCT`, and the
/// scale of the values.
fn pairs(fields: &[Word<'_>]) -> Vec<(usize, usize, f64)> {
    let is_nm = |k: &usize| fields[*k].text == "SPECTRAL_NM";
    let pair = |k: usize| match fields.get(k + 1)?.text {
        "SPECTRAL_PCT" => Some((k, k + 1, 100.0)),
        "SPECTRAL_DEC" => Some((k, k + 1, 1.0)),
        _ => None,
    };
    (0..fields.len()).filter(is_nm).filter_map(pair).collect()
}

/// Returns the first value of the line at which rows stop having this many fields; lines may hold any number of
/// whole rows.
fn uneven<'a>(data: &'a [Word<'a>], count: usize) -> Option<&'a Word<'a>> {
    let lines = || data.chunk_by(|a, b| a.line == b.line);
    let wrong = lines().find(|line| count == 0 || !line.len().is_multiple_of(count));
    wrong.and_then(|line| line.first()).or(data.last())
}

pub(super) fn read(name: &str, text: &str) -> Result<SpectralFile, FormatError> {
    let source = Source { name, text, format: FORMAT };
    let words = words(text);
    if words.is_empty() {
        return Err(source.whole("it has no words"));
    }
    let parts = Parts::of(source, &words)?;
    let wrong = |word: Option<&Word<'_>>, what: String| {
        source.at(word.map_or(0..0, |word| source.range(word.text)), what)
    };
    let count = parts.fields.len();
    if count == 0 || !parts.data.len().is_multiple_of(count) {
        let what = format!("the {} values are not rows of {count} fields", parts.data.len());
        return Err(wrong(uneven(parts.data, count), what));
    }
    let sets = parts.data.len() / count;
    for (key, found) in [("NUMBER_OF_FIELDS", count), ("NUMBER_OF_SETS", sets)] {
        // Keywords of the data stand between the names of the fields and the data.
        let stated = words.windows(2).find(|pair| pair[0].text == key).map(|pair| &pair[1]);
        if let Some(stated) = stated.filter(|stated| stated.text.parse() != Ok(found)) {
            return Err(wrong(Some(stated), format!("{key} is {}, and {found} were found", stated.text)));
        }
    }
    let names =
        parts.field(&["SAMPLE_NAME", "SampleName", "NAME", "SAMPLE_ID", "SampleID", "SAMPLE_LOC", "STRING"]);
    let (spectral, pairs) = (parts.spectral(), pairs(parts.fields));
    let (lab, xyz) = (parts.colour(["LAB_L", "LAB_A", "LAB_B"]), parts.colour(["XYZ_X", "XYZ_Y", "XYZ_Z"]));
    parts.check_spectral(&spectral, source)?;
    if spectral.is_empty() && pairs.is_empty() && lab.is_none() && xyz.is_none() {
        let what =
            "it has no spectra (fields SPEC_380, ...), no LAB_L, LAB_A, LAB_B and no XYZ_X, XYZ_Y, XYZ_Z"
                .to_owned();
        return Err(wrong(parts.fields.first(), what));
    }
    // CGATS.17 has standard deviations of colours only; those of X, Y, Z have their scale.
    let of_xyz = xyz.and_then(|_| parts.colour(["STDEV_X", "STDEV_Y", "STDEV_Z"]));
    let of_lab = lab.and_then(|_| parts.colour(["STDEV_L", "STDEV_A", "STDEV_B"]));
    // The colour whose standard deviation is stated is read.
    let xyz = xyz.filter(|_| of_xyz.is_some() || of_lab.is_none());
    let deviation = of_xyz.or(of_lab);
    let has_spectra = !(spectral.is_empty() && pairs.is_empty());
    let unused = parts.unused_deviations(deviation.filter(|_| !has_spectra), xyz.is_some(), has_spectra);
    let norm = parts.number("SPECTRAL_NORM");
    let mut samples = Vec::with_capacity(sets);
    for (k, row) in parts.data.chunks(count).enumerate() {
        let number = |field: usize| {
            let word = &row[field];
            let value = word.text.replace(',', ".").parse().ok().filter(|value: &f64| value.is_finite());
            let what = || format!("`{}` of {} is not a number", word.text, parts.fields[field].text);
            value.ok_or_else(|| wrong(Some(word), what()))
        };
        let at = |field: usize| source.range(row[field].text);
        let mut spectrum = Vec::with_capacity(spectral.len());
        for (field, nm) in &spectral {
            spectrum.push((*nm, number(*field)? / norm.unwrap_or(1.0), at(*field)));
        }
        for (nm, value, scale) in &pairs {
            spectrum.push((number(*nm)?, number(*value)? / scale, at(*value)));
        }
        let three = |fields: [usize; 3]| {
            Ok::<_, FormatError>([number(fields[0])?, number(fields[1])?, number(fields[2])?])
        };
        let spread = |fields: [usize; 3]| {
            let found = three(fields)?;
            match found.iter().zip(fields).find(|(value, _)| **value <= 0.0) {
                None => Ok(found),
                Some((_, field)) => {
                    let (word, name) = (&row[field], parts.fields[field].text);
                    Err(wrong(Some(word), format!("{name} is {}; expected a number above 0", word.text)))
                }
            }
        };
        samples.push(Sample {
            // A single sample without a name is called as its file.
            name: match names {
                Some(field) => row[field].text.trim().to_owned(),
                None if sets == 1 => String::new(),
                None => (k + 1).to_string(),
            },
            at: at(names.unwrap_or(0)),
            spectrum,
            lab: lab.map(three).transpose()?,
            xyz: xyz.map(three).transpose()?,
            deviation: deviation.map(spread).transpose()?,
            ..Sample::default()
        });
    }
    let (observer, illuminant) = (parts.observer(), parts.illuminant());
    let new = SpectralFile::new(FORMAT, parts.kind(), samples, unused.into_iter().collect());
    let has_scale = norm.is_some() || !pairs.is_empty();
    let mut file = SpectralFile { observer, illuminant, has_scale, ..new };
    file.scale_xyz();
    if parts.has_more {
        file.notes.push("only the first table of the file is read".to_owned());
    }
    file.divide_per_cent();
    Ok(file)
}
