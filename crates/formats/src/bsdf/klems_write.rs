//! Writer of Klems matrices as XML. Patches are copied; the lobes of other files are averaged over the patches of the
//! full basis.

use std::io::Write;

use papilio_goniometry::{
    Changes, Channel, Direction, Geometry, KLEMS_FULL, MeasuredPart, Measurement, Ring, lobe_patch_means,
    patch_count, patch_means,
};

use super::LARGEST_VALUE;
use super::window::{BASES, CHANNELS, KLEMS, WAYS};
use super::write::{Number, WriteError, lost_media, not_written, one_line};

pub(super) fn write(out: &mut dyn Write, measurement: &Measurement) -> Result<Vec<String>, WriteError> {
    let mut lost = Vec::new();
    lost_media(measurement, &mut lost);
    if !measurement.provenance.remarks.is_empty() {
        lost.push("the remarks were not written".to_owned());
    }
    let parts: Vec<PatchMeans<'_>> =
        measurement.parts.iter().map(|part| PatchMeans::of(part, &mut lost)).collect::<Result<_, _>>()?;
    head(out, measurement, &parts)?;
    for (name, channel) in CHANNELS {
        let blocks: Vec<_> = parts.iter().filter_map(|part| Some((part, part.values(channel)?))).collect();
        if !blocks.is_empty() {
            writeln!(out, "<WavelengthData>\n<LayerNumber>System</LayerNumber>")?;
            writeln!(out, "<Wavelength unit=\"Integral\">{name}</Wavelength>")?;
            blocks.iter().try_for_each(|(part, values)| block(out, part, values))?;
            writeln!(out, "</WavelengthData>")?;
        }
    }
    writeln!(out, "</Layer>\n</Optical>\n</WindowElement>")?;
    Ok(lost)
}

/// A part as the file will hold it: `[channel][in][out]`.
struct PatchMeans<'a> {
    part: &'a MeasuredPart,
    /// Channels in the file.
    channels: Vec<Channel>,
    incoming: &'a [Ring],
    outgoing: &'a [Ring],
    values: Vec<Vec<f64>>,
}

impl<'a> PatchMeans<'a> {
    fn of(part: &'a MeasuredPart, lost: &mut Vec<String>) -> Result<Self, WriteError> {
        let (channels, numbers) = choose_channels(part, lost)?;
        if !part.tis.is_empty() {
            lost.push(format!("the TIS of the {} was not written", part.way.name()));
        }
        if let Geometry::Patches { incoming, outgoing } = &part.geometry {
            let copy =
                |number: &usize| part.channel(*number).iter().map(|f| if f.is_nan() { 0.0 } else { *f });
            let values = numbers.iter().map(|number| copy(number).collect()).collect();
            if part.values.iter().any(|value| value.is_nan()) {
                lost.push(UNMEASURED.to_owned());
            }
            return Ok(Self { part, channels, incoming, outgoing, values });
        }
        lost.push(format!("the {} was averaged over the patches of the full Klems basis", part.way.name()));
        let mut values = Vec::new();
        for number in numbers {
            let averages = averages(part, number, lost)?;
            if let Some(&value) = averages.iter().find(|value| !(0.0..=LARGEST_VALUE).contains(*value)) {
                let what = "the mean over a pair of patches".to_owned();
                return Err(WriteError::Number { what, way: part.way.name(), value });
            }
            values.push(averages);
        }
        Ok(Self { part, channels, incoming: &KLEMS_FULL, outgoing: &KLEMS_FULL, values })
    }

    fn values(&self, channel: Channel) -> Option<&[f64]> {
        let same = |own: &Channel| *own == channel || (*own == Channel::Y && channel == Channel::Monochrome);
        Some(&self.values[self.channels.iter().position(same)?])
    }
}

const UNMEASURED: &str = "patches without any value were written as 0";

/// Selects the channels that the file can hold, and their indices in the part.
fn choose_channels(
    part: &MeasuredPart,
    lost: &mut Vec<String>,
) -> Result<(Vec<Channel>, Vec<usize>), WriteError> {
    let fits =
        |channel: &Channel| CHANNELS.iter().any(|(_, known)| known == channel) || *channel == Channel::Y;
    let mut chosen: Vec<(Channel, usize)> =
        part.channels.iter().enumerate().filter(|(_, c)| fits(c)).map(|(k, c)| (*c, k)).collect();
    // Both would be written as the visible spectrum.
    if part.channels.contains(&Channel::Y) {
        chosen.retain(|(channel, _)| *channel != Channel::Monochrome);
    }
    if chosen.is_empty() {
        if part.channels.is_empty() {
            return Err(WriteError::CannotHold { format: KLEMS, what: "a part without channels" });
        }
        let only = part.luminous();
        lost.push(format!("the channel {} was written as the visible spectrum", part.channels[only]));
        chosen.push((Channel::Monochrome, only));
    }
    let is_chosen = |k: usize| chosen.iter().any(|(_, number)| *number == k);
    let others = part.channels.iter().enumerate().filter(|(k, _)| !is_chosen(*k));
    lost.extend(not_written(&others.map(|(_, channel)| *channel).collect::<Vec<_>>()));
    Ok(chosen.into_iter().unzip())
}

/// Number of integration points of each patch, in theta and in azimuth, the same for light and viewer: the
/// means of reciprocal values are reciprocal.
const POINTS: [usize; 2] = [4, 4];

/// Smallest number of listed pairs.
const FEWEST_PAIRS: usize = 12;

/// Returns the mean of f for each pair of patches, weighted with both cosines: of the smooth lobe of an isotropic
/// sample, otherwise over points of both patches.
fn averages(part: &MeasuredPart, channel: usize, lost: &mut Vec<String>) -> Result<Vec<f64>, WriteError> {
    if let Geometry::Tree(tree) = &part.geometry {
        return Ok(patch_means(tree, part.channel(channel), &KLEMS_FULL));
    }
    let pairs = match &part.geometry {
        Geometry::Pairs(pairs) => Some(pairs.len()),
        _ => None,
    };
    let has_lobe = pairs.map_or(part.geometry.is_isotropic(), |pairs| pairs >= FEWEST_PAIRS);
    if has_lobe {
        match lobe_patch_means(part, channel, &KLEMS_FULL) {
            Ok((means, changes)) => {
                extrapolated(&changes, part, lost);
                return Ok(means);
            }
            // A dark part needs no lobe.
            Err(_) if pairs.is_none() && part.channel(channel).iter().any(|value| *value > 0.0) => {
                let line = format!(
                    "the {} has no smooth lobe: its means are those of its values at {} points of each patch",
                    part.way.name(),
                    POINTS[0] * POINTS[1]
                );
                if !lost.contains(&line) {
                    lost.push(line);
                }
            }
            Err(_) => {}
        }
    }
    if pairs.is_some() {
        let what = "fewer than 12 different pairs of directions, or no light";
        return Err(WriteError::CannotHold { format: KLEMS, what });
    }
    let patches = patches(&KLEMS_FULL, POINTS);
    let mut empty = false;
    let mut values = Vec::with_capacity(patches.len() * patches.len());
    for light in &patches {
        for viewer in &patches {
            let pairs = light.iter().flat_map(|i| viewer.iter().map(move |o| (i.specular(), *o)));
            let (sum, count) = pairs
                .filter_map(|(i, o)| part.evaluate(channel, i, o))
                .fold((0.0, 0.0), |(sum, count), f| (sum + f, count + 1.0));
            empty |= count == 0.0;
            values.push(if count > 0.0 { sum / count } else { 0.0 });
        }
    }
    if empty && !lost.iter().any(|line| line == UNMEASURED) {
        lost.push(UNMEASURED.to_owned());
    }
    Ok(values)
}

/// Adds what of a lobe was not measured.
fn extrapolated(changes: &Changes, part: &MeasuredPart, lost: &mut Vec<String>) {
    let way = part.way.name();
    let mut add = |line: String| {
        if !lost.contains(&line) {
            lost.push(line);
        }
    };
    let most = changes.beyond.iter().copied().max_by(|[_, one], [_, other]| one.total_cmp(other));
    if let Some([theta, fraction]) = most.filter(|[_, fraction]| *fraction > SMALL) {
        let percent = 100.0 * fraction;
        add(format!(
            "the tails of the {way} beyond the measured directions were extrapolated: {percent:.1} % of the light at {theta} deg of incidence"
        ));
    }
    // The outermost patches begin there.
    if changes.last_deg < KLEMS_FULL[KLEMS_FULL.len() - 1].from_deg {
        let beyond = match changes.held_beyond {
            Some([theta, fraction]) if fraction > SMALL => format!(
                ": at {theta} deg, {:.1} % of the light is farther from the specular direction than anything that was measured",
                100.0 * fraction
            ),
            _ => String::new(),
        };
        add(format!(
            "beyond {} deg of incidence, the lobe of the {way} at this incidence was used, shifted with the light{beyond}",
            changes.last_deg
        ));
    }
}

/// Part of the light that may be extrapolated without a note.
const SMALL: f64 = 1e-3;

/// Returns points of each patch of a basis, with equal fractions of the patch's projected solid angle: the given
/// numbers of them in theta and in azimuth.
fn patches(rings: &[Ring], [along, around]: [usize; 2]) -> Vec<Vec<Direction>> {
    let mut patches = Vec::with_capacity(patch_count(rings));
    for (k, ring) in rings.iter().enumerate() {
        let to_deg = rings.get(k + 1).map_or(90.0, |next| next.from_deg);
        let [low, high] = [ring.from_deg, to_deg].map(|theta| theta.to_radians().sin().powi(2));
        for number in 0..ring.patches {
            let point = |index: usize| {
                let step = (index / around) as f64 + 0.5;
                let sin2 = low + (high - low) * step / along as f64;
                let turn = number as f64 - 0.5 + ((index % around) as f64 + 0.5) / around as f64;
                Direction::new(sin2.sqrt().asin().to_degrees(), 360.0 * turn / ring.patches as f64)
            };
            patches.push((0..along * around).map(point).collect());
        }
    }
    patches
}

/// Returns the name of a basis in the file: a standard name, or one for a basis that the file defines.
fn basis_name(rings: &[Ring], is_incoming: bool) -> &'static str {
    let known = BASES.iter().find(|(_, known)| *known == rings);
    known.map_or(if is_incoming { "Incoming" } else { "Outgoing" }, |(name, _)| name)
}

fn head(out: &mut dyn Write, measurement: &Measurement, parts: &[PatchMeans<'_>]) -> Result<(), WriteError> {
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    writeln!(out, "<WindowElement>\n<WindowElementType>System</WindowElementType>\n<Optical>\n<Layer>")?;
    let provenance = &measurement.provenance;
    let (name, source) = (escaped(&provenance.sample), escaped(&provenance.source));
    writeln!(out, "<Material>\n<Name>{name}</Name>\n<Manufacturer>{source}</Manufacturer>\n</Material>")?;
    writeln!(out, "<DataDefinition>\n<IncidentDataStructure>Columns</IncidentDataStructure>")?;
    let mut written: Vec<(&str, &[Ring])> = Vec::new();
    for part in parts {
        for (rings, is_incoming) in [(part.incoming, true), (part.outgoing, false)] {
            let name = basis_name(rings, is_incoming);
            match written.iter().find(|(other, _)| *other == name) {
                None => {
                    basis(out, name, rings)?;
                    written.push((name, rings));
                }
                Some((_, other)) if *other == rings => {}
                Some(_) => {
                    let what = "parts that define different angle bases";
                    return Err(WriteError::CannotHold { format: KLEMS, what });
                }
            }
        }
    }
    Ok(writeln!(out, "</DataDefinition>")?)
}

fn basis(out: &mut dyn Write, name: &str, rings: &[Ring]) -> Result<(), WriteError> {
    writeln!(out, "<AngleBasis>\n<AngleBasisName>{name}</AngleBasisName>")?;
    for (k, ring) in rings.iter().enumerate() {
        let to_deg = rings.get(k + 1).map_or(90.0, |next| next.from_deg);
        let theta = if ring.patches == 1 { ring.from_deg } else { (ring.from_deg + to_deg) / 2.0 };
        writeln!(
            out,
            "<AngleBasisBlock><Theta>{theta}</Theta><nPhis>{}</nPhis><ThetaBounds><LowerTheta>{}</LowerTheta>\
             <UpperTheta>{to_deg}</UpperTheta></ThetaBounds></AngleBasisBlock>",
            ring.patches, ring.from_deg
        )?;
    }
    Ok(writeln!(out, "</AngleBasis>")?)
}

fn block(out: &mut dyn Write, part: &PatchMeans<'_>, values: &[f64]) -> Result<(), WriteError> {
    let direction = WAYS.iter().find(|(_, way)| *way == part.part.way).map_or("", |(name, _)| name);
    let kind = if part.part.way.is_transmission() { "BTDF" } else { "BRDF" };
    writeln!(out, "<WavelengthDataBlock>\n<WavelengthDataDirection>{direction}</WavelengthDataDirection>")?;
    writeln!(out, "<ColumnAngleBasis>{}</ColumnAngleBasis>", basis_name(part.incoming, true))?;
    writeln!(out, "<RowAngleBasis>{}</RowAngleBasis>", basis_name(part.outgoing, false))?;
    writeln!(out, "<ScatteringDataType>{kind}</ScatteringDataType>\n<ScatteringData>")?;
    let (incoming, outgoing) = (patch_count(part.incoming), patch_count(part.outgoing));
    for o in 0..outgoing {
        for i in 0..incoming {
            write!(out, "{},", Number(values[i * outgoing + o]))?;
        }
        writeln!(out)?;
    }
    Ok(writeln!(out, "</ScatteringData>\n</WavelengthDataBlock>")?)
}

/// Returns a text in which blanks replace the characters that have a meaning in XML.
fn escaped(text: &str) -> String {
    one_line(text).replace(['<', '>', '&'], " ")
}
