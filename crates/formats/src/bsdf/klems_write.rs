//! Writer of Klems matrices as XML. Patches are copied; grids are averaged over the patches of the full
//! basis.

use std::borrow::Cow;
use std::collections::HashMap;
use std::io::Write;

use papilio_goniometry::{
    Channel, Direction, Fill, Geometry, KLEMS_FULL, MeasuredPart, Measurement, Ring, Shape, Symmetry,
    on_specular_grid, patch_count, patch_means, projected_solid_angle,
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
        let gridded = between_pairs(part)?;
        lost.push(format!("the {} was averaged over the patches of the full Klems basis", part.way.name()));
        let mut values = Vec::new();
        for number in numbers {
            let averages = averages(&gridded, number, lost);
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
/// Number of azimuths of a patch of an isotropic sample, of which only the difference of light and viewer
/// counts.
const AZIMUTHS: usize = 6;

/// Returns the mean of f for each pair of patches, weighted with both cosines.
fn averages(part: &MeasuredPart, channel: usize, lost: &mut Vec<String>) -> Vec<f64> {
    if let Geometry::Tree(tree) = &part.geometry {
        return patch_means(tree, part.channel(channel), &KLEMS_FULL);
    }
    let from = patches(&KLEMS_FULL, POINTS);
    let to = &from;
    let mean = |light: &Patch, viewer: &Patch| {
        let pairs = light.points_to(viewer, part.geometry.is_isotropic());
        let (sum, count) = pairs
            .into_iter()
            .filter_map(|[i, o]| part.evaluate(channel, i.specular(), o))
            .fold((0.0, 0.0), |(sum, count), f| (sum + f, count + 1.0));
        (count > 0.0).then(|| sum / count)
    };
    let mut known = HashMap::new();
    let mut empty = false;
    let mut values = Vec::with_capacity(from.len() * to.len());
    for light in &from {
        for viewer in to {
            let class = light.equivalence_class(viewer, &part.geometry);
            let f: &mut Option<f64> = known.entry(class).or_insert_with(|| mean(light, viewer));
            empty |= f.is_none();
            values.push(f.unwrap_or(0.0));
        }
    }
    if part.geometry.is_isotropic() {
        conserve(part, channel, &from, &mut values);
    }
    if empty && !lost.iter().any(|line| line == UNMEASURED) {
        lost.push(UNMEASURED.to_owned());
    }
    values
}

/// Smallest number of listed pairs.
const FEWEST_PAIRS: usize = 12;

/// Returns a part with listed pairs on a grid about the specular direction, interpolated; other parts as they are.
fn between_pairs(part: &MeasuredPart) -> Result<Cow<'_, MeasuredPart>, WriteError> {
    let Geometry::Pairs(pairs) = &part.geometry else { return Ok(Cow::Borrowed(part)) };
    let all: Vec<usize> = (0..part.channels.len()).collect();
    let what = "fewer than 12 different pairs of directions, or no light";
    let found = on_specular_grid(part, &all).filter(|_| pairs.len() >= FEWEST_PAIRS);
    let (grid, values) = found.ok_or(WriteError::CannotHold { format: KLEMS, what })?;
    let (channels, geometry) = (part.channels.clone(), Geometry::Specular(grid));
    Ok(Cow::Owned(MeasuredPart { way: part.way, channels, geometry, values, tis: Vec::new() }))
}

/// Largest relative uncertainty of a total from the grid with which columns are scaled to it.
const COARSE: f64 = 0.02;

/// Scales the columns so that their sums are the totals of the smooth lobe, which linear interpolation misses
/// by a few per cent. Light of patches is the mean over the measured directions in them; the total thus
/// includes extrapolated tails.
fn conserve(part: &MeasuredPart, channel: usize, from: &[Patch], values: &mut [f64]) {
    let Some(shape) = Shape::of_part(part, channel, Fill::Beyond) else { return };
    // A coarse grid leaves the total uncertain: then the plain means remain.
    if (0..shape.incidences_deg().count()).any(|k| shape.grid_error(k) > COARSE) {
        return;
    }
    let totals: Vec<[f64; 2]> =
        shape.incidences_deg().enumerate().map(|(k, theta)| [theta, shape.total(k)]).collect();
    let total = |theta: f64| {
        let upper = totals.iter().position(|[known, _]| *known >= theta)?;
        let ([a, low], [b, high]) = (totals[upper.saturating_sub(1)], totals[upper]);
        let t = if b > a { (theta - a) / (b - a) } else { 0.0 };
        Some((1.0 - t) * low + t * high)
    };
    let omega = projected_solid_angle(&KLEMS_FULL);
    for (column, light) in values.chunks_exact_mut(omega.len()).zip(from) {
        let measured: Vec<f64> = light.points.iter().filter_map(|from| total(from.theta_deg)).collect();
        let sum: f64 = column.iter().zip(&omega).map(|(f, omega)| f * omega).sum();
        if sum > 0.0 && !measured.is_empty() {
            let scale = measured.iter().sum::<f64>() / measured.len() as f64 / sum;
            // The total has an error of its own; closer than this, the sum is as accurate.
            if (scale - 1.0).abs() > 1e-4 {
                column.iter_mut().for_each(|f| *f *= scale);
            }
        }
    }
}

/// A patch of a basis.
struct Patch {
    /// Ring, index within the ring, and number of patches of the ring.
    ring: usize,
    number: usize,
    count: usize,
    /// Points with equal fractions of the patch's projected solid angle.
    points: Vec<Direction>,
}

impl Patch {
    /// Returns pairs of directions, through this patch and to `viewer`, with equal weights. Those of an
    /// isotropic sample have the inclinations of the points, and differences of azimuth.
    fn points_to(&self, viewer: &Self, isotropic: bool) -> Vec<[Direction; 2]> {
        let pairs = |from: &[Direction], to: &[Direction]| -> Vec<[Direction; 2]> {
            from.iter().flat_map(|i| to.iter().map(move |o| [*i, *o])).collect()
        };
        if !isotropic {
            return pairs(&self.points, &viewer.points);
        }
        // Points with the same inclination follow each other.
        let [along, around] = POINTS;
        let inclinations = |patch: &Self| -> Vec<f64> {
            patch.points.iter().step_by(around).take(along).map(|point| point.theta_deg).collect()
        };
        let turns = self.turns_to(viewer);
        let of_thetas = |from: f64, to: f64| {
            turns
                .iter()
                .map(move |turn| [Direction::new(from, 0.0), Direction::new(to, *turn)])
                .collect::<Vec<_>>()
        };
        let (from, to) = (inclinations(self), inclinations(viewer));
        from.iter().flat_map(|i| to.iter().flat_map(|o| of_thetas(*i, *o)).collect::<Vec<_>>()).collect()
    }

    /// Differences of azimuth between points of this patch and of `viewer`, degrees, with equal weights.
    fn turns_to(&self, viewer: &Self) -> Vec<f64> {
        let middle = |k: usize, count: usize| (k as f64 + 0.5) / count as f64 - 0.5;
        let [own, other] = [self, viewer].map(|patch| 360.0 / patch.count as f64);
        let apart = other * viewer.number as f64 - own * self.number as f64;
        if self.count == 1 || viewer.count == 1 {
            return (0..AZIMUTHS * AZIMUTHS).map(|k| 360.0 * middle(k, AZIMUTHS * AZIMUTHS)).collect();
        }
        let turn =
            |k: usize| apart + other * middle(k % AZIMUTHS, AZIMUTHS) - own * middle(k / AZIMUTHS, AZIMUTHS);
        (0..AZIMUTHS * AZIMUTHS).map(turn).collect()
    }

    /// Returns the equivalence class of a pair of patches; equivalent pairs have the same mean. For an
    /// isotropic sample, pairs are equivalent if their rings and the azimuth between them are equal. The
    /// azimuth is counted in multiples of a fraction of 360 deg that divides the patches of both rings.
    fn equivalence_class(&self, viewer: &Self, geometry: &Geometry) -> [usize; 4] {
        if !geometry.is_isotropic() {
            return [self.ring, self.number, viewer.ring, viewer.number];
        }
        let parts = self.count * viewer.count;
        if self.count == 1 || viewer.count == 1 {
            // The patch about the normal has all azimuths.
            return [self.ring, viewer.ring, 0, 0];
        }
        let turn = (viewer.number * self.count + parts - self.number * viewer.count) % parts;
        let mirrored = matches!(geometry, Geometry::Specular(grid) if grid.symmetry == Symmetry::Plane);
        [self.ring, viewer.ring, if mirrored { turn.min(parts - turn) } else { turn }, 0]
    }
}

/// Returns the patches of a basis, with the given numbers of points in theta and in azimuth.
fn patches(rings: &[Ring], [along, around]: [usize; 2]) -> Vec<Patch> {
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
            let points = (0..along * around).map(point).collect();
            patches.push(Patch { ring: k, number, count: ring.patches, points });
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
