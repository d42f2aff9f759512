//! CxF3, the Color Exchange Format of X-Rite and ISO 17972-1: XML with an element `Object` for each sample.

use std::ops::Range;

use papilio_colour::Standard;
use roxmltree::Node;

use super::{Kind, Sample, Source, SpectralFile, illuminant, observer};
use crate::error::FormatError;

const FORMAT: &str = "CxF";

fn named<'a>(node: Node<'a, 'a>, name: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.descendants().filter(move |node| node.tag_name().name() == name)
}

fn number(text: &str) -> Option<f64> {
    text.trim().replace(',', ".").parse().ok().filter(|value: &f64| value.is_finite())
}

/// Returns the specification of a spectrum or a colour.
fn specification<'a>(root: Node<'a, 'a>, of: Node<'a, 'a>) -> Option<Node<'a, 'a>> {
    let id = of.attribute("ColorSpecification");
    let all = || root.descendants().filter(|node| node.tag_name().name() == "ColorSpecification");
    let of_id = all().find(|node| id.is_some() && node.attribute("Id") == id);
    // A file with a single specification may not name it.
    of_id.or_else(|| all().next().filter(|_| id.is_none() && all().count() == 1))
}

/// Returns the observer of a colour, such as `10_Degree`.
fn observer_of<'a>(root: Node<'a, 'a>, colour: Node<'a, 'a>) -> Option<Standard> {
    let specification = specification(root, colour)?;
    observer(named(specification, "Observer").next()?.text()?)
}

/// Returns the illuminant of a colour, such as `D50`.
fn illuminant_of<'a>(root: Node<'a, 'a>, colour: Node<'a, 'a>) -> Option<String> {
    let specification = specification(root, colour)?;
    illuminant(named(specification, "Illuminant").next()?.text()?)
}

/// Returns the first wavelength and the step of a spectrum, nm: its own, or those of its specification.
fn wavelengths<'a>(root: Node<'a, 'a>, spectrum: Node<'a, 'a>) -> Option<(f64, f64)> {
    let range = specification(root, spectrum)
        .and_then(|node| node.descendants().find(|node| node.tag_name().name() == "WavelengthRange"));
    let of = |key: &str| {
        let own = spectrum.attribute(key);
        own.or_else(|| range?.attribute(key)).and_then(number)
    };
    Some((of("StartWL")?, of("Increment")?))
}

/// Returns the place of an element's first tag.
fn start_tag(text: &str, node: Node<'_, '_>) -> Range<usize> {
    let whole = node.range();
    let length = text[whole.clone()].find('>').map_or(whole.len(), |end| end + 1);
    whole.start..whole.start + length
}

pub(super) fn read<'a>(name: &str, text: &str, root: Node<'a, 'a>) -> Result<SpectralFile, FormatError> {
    const SPECTRA: [(&str, Kind); 3] = [
        ("ReflectanceSpectrum", Kind::Reflectance),
        ("TransmittanceSpectrum", Kind::Transmittance),
        ("EmissiveSpectrum", Kind::Light),
    ];
    let source = Source { name, text, format: FORMAT };
    let wrong = |node: Node<'_, '_>, what: String| source.at(node.range(), what);
    let (samples, notes) = (Vec::new(), Vec::new());
    let mut file = SpectralFile::new(FORMAT, Kind::Unstated, samples, notes);
    let mut further = 0;
    for object in named(root, "Object") {
        let Some(values) = object.children().find(|node| node.tag_name().name() == "ColorValues") else {
            continue;
        };
        let mut sample = Sample {
            name: object.attribute("Name").unwrap_or_default().trim().to_owned(),
            at: start_tag(text, object),
            ..Sample::default()
        };
        for spectrum in values.children() {
            let tag = spectrum.tag_name().name();
            let Some((_, kind)) = SPECTRA.iter().find(|(name, _)| *name == tag) else { continue };
            if !sample.spectrum.is_empty() {
                further += 1;
                continue;
            }
            if file.kind != Kind::Unstated && file.kind != *kind {
                return Err(wrong(spectrum, "it has spectra of several quantities".to_owned()));
            }
            file.kind = *kind;
            let (start, step) = wavelengths(root, spectrum)
                .filter(|(start, step)| *start > 0.0 && *step > 0.0)
                .ok_or_else(|| wrong(spectrum, format!("a {tag} has no StartWL and Increment")))?;
            for (k, word) in spectrum.text().unwrap_or_default().split_whitespace().enumerate() {
                // The text of an element without references to entities is that of the file.
                let at =
                    Some(source.range(word)).filter(|at| !at.is_empty()).unwrap_or_else(|| spectrum.range());
                let value = number(word);
                let value =
                    value.ok_or_else(|| source.at(at.clone(), format!("`{word}` is not a number")))?;
                sample.spectrum.push((start + k as f64 * step, value, at));
            }
        }
        let mut colour = |tag: &str, parts: [&str; 3]| {
            let colour = values.children().find(|node| node.tag_name().name() == tag)?;
            file.observer = file.observer.or_else(|| observer_of(root, colour));
            file.illuminant = file.illuminant.take().or_else(|| illuminant_of(root, colour));
            let part =
                |part: &str| number(colour.children().find(|node| node.tag_name().name() == part)?.text()?);
            let [a, b, c] = parts.map(part);
            Some([a?, b?, c?])
        };
        sample.lab = colour("ColorCIELab", ["L", "A", "B"]);
        sample.xyz = colour("ColorCIEXYZ", ["X", "Y", "Z"]);
        if !sample.spectrum.is_empty() || sample.lab.is_some() || sample.xyz.is_some() {
            file.samples.push(sample);
        }
    }
    if further > 0 {
        file.notes.push(format!(
            "{further} further spectra of the same samples (other conditions of measurement) are not read"
        ));
    }
    file.scale_xyz();
    file.divide_per_cent();
    Ok(file)
}
