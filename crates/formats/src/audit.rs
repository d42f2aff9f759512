//! JSON output of `papilio diffuser inspect` and `papilio diffuser fit` (`--json`).

use papilio_goniometry::{
    Audit, ListedPairs, MeasuredPart, Measurement, PairError, RankedFit, WavelengthLevels,
};
use serde::Serialize;

use crate::audit_text::warnings;

/// A measurement and its audit: angles in degrees, values in 1/sr, fractions from 0 to 1.
#[derive(Debug, Serialize)]
pub struct AuditFile<'a> {
    format: &'a str,
    sample: &'a str,
    source: &'a str,
    media: [f64; 2],
    remarks: &'a [String],
    /// What was noted, and warned of, when the file was read.
    notes: &'a [String],
    warnings: &'a [String],
    parts: Vec<PartFile>,
}

#[derive(Debug, Serialize)]
struct PartFile {
    way: &'static str,
    cells: usize,
    /// The channel whose lobe displays use.
    used_channel: Option<String>,
    /// Level of each wavelength in displays, relative to the used one; of a part with several wavelengths.
    #[serde(skip_serializing_if = "Option::is_none")]
    levels: Option<Vec<f64>>,
    channels: Vec<ChannelFile>,
}

#[derive(Debug, Serialize)]
struct ChannelFile {
    channel: String,
    /// What the audit warns of, as the text of the report.
    warnings: Vec<String>,
    cells_in_hemisphere: usize,
    lit: usize,
    holes: usize,
    beam_holes: usize,
    unmeasured: usize,
    negative: usize,
    dark_beyond_deg: f64,
    noise: f64,
    smallest: f64,
    largest: f64,
    asymmetry: f64,
    reciprocity_rms: Option<f64>,
    reciprocity_worst: Option<f64>,
    haze: Option<f64>,
    clarity: Option<f64>,
    grid_error: Option<f64>,
    held_azimuths_deg: Option<[f64; 2]>,
    measured_to_theta_deg: Option<f64>,
    /// Of listed pairs of directions that form no grid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pairs: Option<PairsFile>,
    incidences: Vec<IncidenceFile>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    rotations: Vec<RotationFile>,
}

/// Listed pairs and the errors of the interpolation between them, relative to the values.
#[derive(Debug, Serialize)]
struct PairsFile {
    points: usize,
    largest_theta_i_deg: f64,
    largest_theta_o_deg: f64,
    /// Each point predicted from all others.
    one_left_out: PairErrorFile,
    /// The points of an incidence predicted from the other incidences.
    incidence_left_out: Option<PairErrorFile>,
}

#[derive(Debug, Serialize)]
struct PairErrorFile {
    rms: f64,
    mean: f64,
    within_95: f64,
    points: usize,
}

impl PairErrorFile {
    fn new(error: PairError) -> Self {
        Self { rms: error.rms, mean: error.mean, within_95: error.within_95, points: error.points }
    }
}

impl PairsFile {
    fn new(pairs: ListedPairs) -> Self {
        Self {
            points: pairs.points,
            largest_theta_i_deg: pairs.largest_deg[0],
            largest_theta_o_deg: pairs.largest_deg[1],
            one_left_out: PairErrorFile::new(pairs.errors.one_left_out),
            incidence_left_out: pairs.errors.incidence_left_out.map(PairErrorFile::new),
        }
    }
}

#[derive(Debug, Serialize)]
struct RotationFile {
    rotation_deg: f64,
    theta_deg: f64,
    tis: Option<f64>,
    integral: f64,
}

#[derive(Debug, Serialize)]
struct IncidenceFile {
    theta_deg: f64,
    tis: Option<f64>,
    integral: f64,
    /// Angle from the specular direction at which the measured cells end, if they end before the horizon: the
    /// smallest one, degrees.
    measured_to_deg: Option<f64>,
    /// Integral including tails extrapolated beyond that angle.
    integral_beyond: f64,
    /// Fraction of `integral_beyond` that the extrapolated tails contribute.
    beyond_share: f64,
    integral_filled: f64,
    /// None for listed pairs: it is not known.
    grid_error: Option<f64>,
    azimuth_error: Option<f64>,
    peak: Option<f64>,
    half_widths_deg: [Option<f64>; 3],
}

impl<'a> AuditFile<'a> {
    /// Creates the output for a measurement, given the audits of the channels of each part, and the notes and warnings on the file.
    pub fn new(
        measurement: &'a Measurement,
        audits: &[(&MeasuredPart, Vec<Audit>)],
        [notes, warnings]: [&'a [String]; 2],
    ) -> Self {
        let provenance = &measurement.provenance;
        let part = |(part, audits): &(&MeasuredPart, Vec<Audit>)| PartFile {
            way: part.way.name(),
            cells: part.geometry.cells(),
            used_channel: part.channels.get(part.luminous()).map(ToString::to_string),
            levels: WavelengthLevels::of(part).map(|levels| levels.ratios),
            channels: part
                .channels
                .iter()
                .zip(audits)
                .map(|(name, audit)| channel(name.to_string(), part, audit))
                .collect(),
        };
        Self {
            format: &provenance.format,
            sample: &provenance.sample,
            source: &provenance.source,
            media: measurement.media,
            remarks: &provenance.remarks,
            notes,
            warnings,
            parts: audits.iter().map(part).collect(),
        }
    }
}

fn channel(channel: String, part: &MeasuredPart, audit: &Audit) -> ChannelFile {
    let incidence = |found: &papilio_goniometry::Incidence| IncidenceFile {
        theta_deg: found.theta_deg,
        tis: found.tis,
        integral: found.integral,
        measured_to_deg: found.measured_to_deg,
        integral_beyond: found.integral_beyond,
        beyond_share: found.beyond_share(),
        integral_filled: found.integral_filled,
        grid_error: found.grid_error,
        azimuth_error: found.azimuth_error,
        peak: found.peak,
        half_widths_deg: found.half_widths_deg,
    };
    let rotation = |found: &papilio_goniometry::Rotation| RotationFile {
        rotation_deg: found.rotation_deg,
        theta_deg: found.theta_deg,
        tis: found.tis,
        integral: found.integral,
    };
    ChannelFile {
        channel,
        warnings: warnings(part, audit),
        cells_in_hemisphere: audit.cells,
        lit: audit.lit,
        holes: audit.holes,
        beam_holes: audit.beam_holes,
        unmeasured: audit.unmeasured,
        negative: audit.negative,
        dark_beyond_deg: audit.dark_beyond_deg,
        noise: audit.noise,
        smallest: audit.range[0],
        largest: audit.range[1],
        asymmetry: audit.asymmetry,
        reciprocity_rms: audit.reciprocity.map(|[rms, _]| rms),
        reciprocity_worst: audit.reciprocity.map(|[_, worst]| worst),
        haze: audit.haze,
        clarity: audit.clarity.filter(|clarity| *clarity >= 0.0),
        grid_error: audit.grid_error(),
        held_azimuths_deg: audit.held_azimuths_deg,
        measured_to_theta_deg: audit.inclined_to_deg,
        pairs: audit.pairs.map(PairsFile::new),
        incidences: audit.incidences.iter().map(incidence).collect(),
        rotations: audit.rotations.iter().map(rotation).collect(),
    }
}

/// Fitted lobes, best first.
#[derive(Debug, Serialize)]
pub struct FitFile<'a> {
    way: &'static str,
    channel: String,
    /// What was noted, and warned of, when the file was read.
    notes: &'a [String],
    warnings: &'a [String],
    fits: Vec<OneFit>,
}

#[derive(Debug, Serialize)]
struct OneFit {
    model: &'static str,
    parameters: Vec<OneParameter>,
    covariance: Vec<f64>,
    display_error: Option<f64>,
    rms: f64,
    relative_rms: f64,
    total_error: f64,
    cells: usize,
    starts: usize,
    agreeing_starts: usize,
    iterations: usize,
    converged: bool,
}

#[derive(Debug, Serialize)]
struct OneParameter {
    name: &'static str,
    unit: &'static str,
    value: f64,
    interval_95: [f64; 2],
    at_bound: bool,
}

impl<'a> FitFile<'a> {
    /// Creates the output for the fits of one channel of a part, with the notes and warnings on the file.
    pub fn new(
        part: &MeasuredPart,
        channel: usize,
        fits: &[RankedFit],
        [notes, warnings]: [&'a [String]; 2],
    ) -> Self {
        let one = |RankedFit { fit, score }: &RankedFit| OneFit {
            model: fit.model.kind.name(),
            parameters: fit
                .parameters
                .iter()
                .map(|found| OneParameter {
                    name: found.name,
                    unit: found.unit,
                    value: found.value,
                    interval_95: found.interval,
                    at_bound: found.at_bound,
                })
                .collect(),
            covariance: fit.covariance.clone(),
            display_error: *score,
            rms: fit.rms,
            relative_rms: fit.relative_rms,
            total_error: fit.total_error,
            cells: fit.cells,
            starts: fit.starts,
            agreeing_starts: fit.agreeing,
            iterations: fit.iterations,
            converged: fit.converged,
        };
        let channel = part.channels.get(channel).map(ToString::to_string).unwrap_or_default();
        Self { way: part.way.name(), channel, notes, warnings, fits: fits.iter().map(one).collect() }
    }
}
