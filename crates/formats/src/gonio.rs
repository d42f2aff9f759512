//! Output files of `papilio gonio`: `totals.csv`, `totals_by_azimuth.csv`, `waves.csv`, `audit.json` and `face.npz`; head of its journal.

use std::io::{self, Write};

use papilio_microgeometry::{
    Audit, AzimuthKernel, ByAzimuth, ByRays, ByWaves, Findings, Goniometer, LEAST_G, MOST_SLOPE, Side,
    Statistics, Total, WaveShares, WayShares,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use zip::ZipWriter;

use crate::face_read::{AZIMUTHS, COATED, FORMAT};
use crate::npy::{Items, stored, write_npy};

/// First line of the journal of a measurement, `gonio.jsonl`: identifies the measurement to which the parts belong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GonioHead {
    /// Version of the program.
    pub papilio: String,
    /// SHA-256 of the file and the bytes of its maps.
    pub hash: String,
    /// Rays of each replicate, which are fewer in a preview.
    pub rays: u64,
}

/// Content of `audit.json`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct SurfaceAuditFile<'a> {
    /// Version of the program.
    pub papilio: &'a str,
    /// Title of the surface.
    pub title: &'a str,
    /// SHA-256 of the file and the bytes of its maps.
    pub hash: &'a str,
    /// Notes on how the file was interpreted.
    pub notes: &'a [String],
    /// Refractive index above.
    pub index_above: f64,
    /// Refractive index below.
    pub index_below: f64,
    /// Seed of rays and random surfaces.
    pub seed: u64,
    /// How well rays obey the laws; absent where only waves were asked for.
    #[serde(flatten)]
    pub rays: Option<RaysAudit<'a>>,
    /// Haze of light along the normal by rays: of the transmitted light with |beta| up to 1, the fraction beyond sin 2.5 deg. Null without it.
    pub haze_by_rays: Option<f64>,
    /// Its standard error.
    pub haze_by_rays_error: Option<f64>,
    /// Root mean square slope along x or y, the larger one; null without waves.
    pub slope_rms: Option<f64>,
    /// What waves do, by inclination and wavelength: along the normal from above first.
    pub waves: Vec<WaveRow>,
    /// Statistics of the heights; null for a flat face.
    pub heights: Option<HeightsRow>,
}

/// Statistics of heights: of the first realisation, if the surface is random.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct HeightsRow {
    /// Root mean square height about the mean, um.
    pub rms_um: f64,
    /// Root mean square slope along x.
    pub slope_rms_x: f64,
    /// Root mean square slope along y.
    pub slope_rms_y: f64,
    /// Distance at which the autocorrelation is 1/e, um; null if it does not fall so far within half of the map.
    pub correlation_um: Option<f64>,
    /// Skewness; 0 for Gaussian heights.
    pub skewness: f64,
    /// Kurtosis; 3 for Gaussian heights.
    pub kurtosis: f64,
}

impl From<&Statistics> for HeightsRow {
    fn from(statistics: &Statistics) -> Self {
        Self {
            rms_um: statistics.rms_um,
            slope_rms_x: statistics.slope_rms[0],
            slope_rms_y: statistics.slope_rms[1],
            correlation_um: statistics.correlation_um,
            skewness: statistics.skewness,
            kurtosis: statistics.kurtosis,
        }
    }
}

/// How well rays obey reciprocity and the conservation of energy.
#[derive(Debug, Serialize, JsonSchema)]
pub struct RaysAudit<'a> {
    /// Rays that were followed.
    pub rays: u64,
    /// Rays that were lost in the surface; more than one in a million is refused.
    pub dropped_rays: f64,
    /// Of uniform light, which leaves every band of directions as it came: differences over their standard errors, for each band.
    pub energy_z: &'a [f64],
    /// Root mean square of the differences of the light of both ways between two bands over their standard errors; about 1, above 3 is refused.
    pub reciprocity_z: f64,
    /// The largest of these differences.
    pub reciprocity_z_largest: f64,
    /// Number of pairs of patches that were compared.
    pub reciprocity_tests: usize,
    /// Fraction of the light that was moved by taking the mean of both ways.
    pub moved_by_symmetry: f64,
    /// Fraction of the light that was moved by balancing.
    pub moved_by_balance: f64,
    /// Mean relative standard error of the patches with 99 % of the light.
    pub relative_error: f64,
    /// The same by azimuth; absent where the surface is turned about its normal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_azimuth: Option<AzimuthAudit>,
}

impl<'a> RaysAudit<'a> {
    fn new(audit: &'a Audit, by_azimuth: Option<&ByAzimuth>) -> Self {
        Self {
            rays: audit.rays,
            dropped_rays: audit.dropped_rays,
            energy_z: &audit.energy_z,
            reciprocity_z: audit.reciprocity_z_rms,
            reciprocity_z_largest: audit.reciprocity_z_largest,
            reciprocity_tests: audit.reciprocity_tests,
            moved_by_symmetry: audit.moved_by_symmetry,
            moved_by_balance: audit.moved_by_balance,
            relative_error: audit.relative_error,
            by_azimuth: by_azimuth.map(|found| AzimuthAudit::from(&found.kernel)),
        }
    }
}

/// How well rays obey the laws by azimuth.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct AzimuthAudit {
    /// Step of azimuth, degrees.
    pub azimuth_deg: f64,
    /// Patches of directions, on both sides.
    pub patches: usize,
    /// Of uniform light, which leaves every patch of directions as it came: root mean square of the differences over their standard errors; about
    /// 1, above 3 is refused.
    pub energy_z: f64,
    /// Number of patches whose light is known well enough for this.
    pub energy_tests: usize,
    /// Root mean square of the differences of the light of both ways between two patches over their standard errors; about 1, above 3 is refused.
    pub reciprocity_z: f64,
    /// The largest of these differences.
    pub reciprocity_z_largest: f64,
    /// Number of pairs of patches that were compared.
    pub reciprocity_tests: usize,
    /// Fraction of the light that was moved by taking the mean of both ways.
    pub moved_by_symmetry: f64,
    /// Fraction of the light that was moved by balancing.
    pub moved_by_balance: f64,
    /// Mean relative standard error of the pairs of patches with 99 % of the light.
    pub relative_error: f64,
}

impl From<&AzimuthKernel> for AzimuthAudit {
    fn from(AzimuthKernel { patches, audit, .. }: &AzimuthKernel) -> Self {
        Self {
            azimuth_deg: 360.0 / patches.azimuths() as f64,
            patches: patches.count(),
            energy_z: audit.energy_z_rms(),
            energy_tests: audit.energy_z.len(),
            reciprocity_z: audit.reciprocity_z_rms,
            reciprocity_z_largest: audit.reciprocity_z_largest,
            reciprocity_tests: audit.reciprocity_tests,
            moved_by_symmetry: audit.moved_by_symmetry,
            moved_by_balance: audit.moved_by_balance,
            relative_error: audit.relative_error,
        }
    }
}

/// What waves of an inclination and a wavelength do: a line of `waves.csv`. Errors are standard errors over realisations. Values of transmitted light are
/// null beyond the critical angle.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct WaveRow {
    /// Wavelength in air, nm.
    pub wavelength_nm: f64,
    /// Square of the rms phase of transmitted light. Rays hold above about 10.
    pub g: Option<f64>,
    /// Fraction of the transmitted light that passes straight through.
    pub straight: Option<f64>,
    /// Fraction of the reflected light that is reflected as by a mirror.
    pub mirror: f64,
    /// Haze in air: of the transmitted light with |beta| up to 1, the fraction beyond |beta| = sin 2.5 deg from the direction straight through.
    pub haze: Option<f64>,
    /// Haze in closed form, for random faces with Gaussian or exponential correlation.
    pub haze_closed_form: Option<f64>,
    /// Standard error of `straight`.
    pub straight_error: Option<f64>,
    /// Standard error of `mirror`.
    pub mirror_error: f64,
    /// Standard error of `haze`.
    pub haze_error: Option<f64>,
    /// Side of the light.
    pub from: WaveSide,
    /// Inclination of the light in its own medium, degrees; it comes from all azimuths.
    pub theta_deg: f64,
    /// Fraction of the light that is transmitted: Fresnel's, at the mean face.
    pub transmitted: f64,
    /// Fraction of the light that is reflected.
    pub reflected: f64,
    /// Haze by the generalised Harvey-Shack form, with the phases of both directions.
    pub haze_two_angles: Option<f64>,
    /// Factor by which that form is renormalised.
    pub renormalisation: Option<f64>,
    /// Fraction of the orders of transmitted light in directions that do not exist, before renormalisation.
    pub evanescent: Option<f64>,
    /// Haze by rays, in the same directions.
    pub haze_rays: Option<f64>,
    /// What describes transmitted light.
    pub holds: Option<Holds>,
    /// Square of the rms phase of reflected light.
    pub g_reflected: f64,
    /// Of the reflected light, the fraction beyond |beta| = sin 2.5 deg from the mirror direction.
    pub haze_reflected: f64,
    /// Standard error of `haze_reflected`.
    pub haze_reflected_error: f64,
    /// `haze_reflected` in closed form.
    pub haze_reflected_closed_form: Option<f64>,
    /// `haze_reflected` by the generalised Harvey-Shack form.
    pub haze_reflected_two_angles: Option<f64>,
    /// Factor by which that form is renormalised.
    pub renormalisation_reflected: Option<f64>,
    /// Fraction of the orders of reflected light in directions that do not exist, before renormalisation.
    pub evanescent_reflected: f64,
    /// `haze_reflected` by rays.
    pub haze_reflected_rays: Option<f64>,
    /// What describes reflected light.
    pub holds_reflected: Holds,
}

/// What describes light at a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Holds {
    /// Rays and waves.
    Both,
    /// Rays: g is above 10.
    Rays,
    /// Waves: slopes are below 0.3, and hide nothing.
    Waves,
    /// Neither.
    Neither,
}

/// Side of a surface in files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum WaveSide {
    /// The medium above.
    Above,
    /// The medium below.
    Below,
}

impl WaveSide {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Above => "above",
            Self::Below => "below",
        }
    }
}

impl Holds {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Both => "both",
            Self::Rays => "rays",
            Self::Waves => "waves",
            Self::Neither => "neither",
        }
    }

    /// What describes light of a way on a surface of this rms slope.
    pub fn of(shares: &WayShares, slope_rms: f64) -> Self {
        match (shares.rays_hold(), shares.waves_hold(slope_rms)) {
            (true, true) => Self::Both,
            (true, false) => Self::Rays,
            (false, true) => Self::Waves,
            (false, false) => Self::Neither,
        }
    }
}

impl WaveRow {
    /// All lines: light along the normal from above first.
    pub fn all(waves: &ByWaves, rays: Option<&ByRays>) -> Vec<Self> {
        waves.shares.iter().map(|one| Self::of(one, waves.slope_rms, rays)).collect()
    }

    fn of(shares: &WaveShares, slope_rms: f64, rays: Option<&ByRays>) -> Self {
        let WaveShares { from, theta_deg, wavelength_nm, reflected, transmitted } = shares;
        let transmitted = transmitted.as_ref();
        let is_same = |total: &&Total| total.from == *from && total.theta_deg == *theta_deg;
        let total = rays.and_then(|rays| rays.totals.iter().find(is_same));
        let closed_form = transmitted.and_then(|one| one.closed_form);
        Self {
            wavelength_nm: *wavelength_nm,
            g: transmitted.map(|one| one.g),
            straight: transmitted.map(|one| one.regular.value),
            mirror: reflected.regular.value,
            haze: transmitted.map(|one| one.haze.value),
            haze_closed_form: closed_form.map(|one| one.one_angle_haze),
            straight_error: transmitted.map(|one| one.regular.error),
            mirror_error: reflected.regular.error,
            haze_error: transmitted.map(|one| one.haze.error),
            from: if *from == Side::Above { WaveSide::Above } else { WaveSide::Below },
            theta_deg: *theta_deg,
            transmitted: transmitted.map_or(0.0, |one| one.fresnel),
            reflected: reflected.fresnel,
            haze_two_angles: closed_form.map(|one| one.haze),
            renormalisation: closed_form.map(|one| one.renormalisation),
            evanescent: transmitted.map(|one| one.evanescent.value),
            haze_rays: transmitted.and(total).map(|total| total.straight_haze.value),
            holds: transmitted.map(|one| Holds::of(one, slope_rms)),
            g_reflected: reflected.g,
            haze_reflected: reflected.haze.value,
            haze_reflected_error: reflected.haze.error,
            haze_reflected_closed_form: reflected.closed_form.map(|one| one.one_angle_haze),
            haze_reflected_two_angles: reflected.closed_form.map(|one| one.haze),
            renormalisation_reflected: reflected.closed_form.map(|one| one.renormalisation),
            evanescent_reflected: reflected.evanescent.value,
            haze_reflected_rays: total.map(|total| total.mirror_haze.value),
            holds_reflected: Holds::of(reflected, slope_rms),
        }
    }
}

impl<'a> SurfaceAuditFile<'a> {
    /// The file of a measurement by an instrument.
    pub fn new(
        [papilio, title, hash]: [&'a str; 3],
        notes: &'a [String],
        goniometer: &Goniometer,
        Findings { rays, waves, statistics }: &'a Findings,
    ) -> Self {
        let along = rays.as_ref().and_then(|rays| rays.totals.iter().find(|total| total.theta_deg == 0.0));
        let haze = along.map(|one| one.haze);
        Self {
            papilio,
            title,
            hash,
            notes,
            index_above: goniometer.index_above,
            index_below: goniometer.index_below,
            seed: goniometer.seed,
            rays: rays.as_ref().map(|rays| RaysAudit::new(&rays.kernel.audit, rays.by_azimuth.as_ref())),
            haze_by_rays: haze.map(|haze| haze.value),
            haze_by_rays_error: haze.map(|haze| haze.error),
            slope_rms: waves.as_ref().map(|waves| waves.slope_rms),
            waves: waves.as_ref().map_or(Vec::new(), |waves| WaveRow::all(waves, rays.as_ref())),
            heights: statistics.as_ref().map(HeightsRow::from),
        }
    }
}

/// Writes `psd.csv`: the power spectral density of the heights, a line for each frequency.
///
/// # Errors
/// Those of `out`.
pub fn write_psd(out: impl Write, statistics: &Statistics) -> io::Result<()> {
    write_numbers(out, &["frequency_per_um", "psd_um4"], &statistics.density)
}

/// Writes `cutoff.csv`: what Gaussian filters leave of rms height and slope, a line for each cut-off.
///
/// # Errors
/// Those of `out`.
pub fn write_cutoffs(out: impl Write, statistics: &Statistics) -> io::Result<()> {
    write_numbers(out, &["cutoff_um", "rms_um", "slope_rms"], &statistics.by_cutoff)
}

fn write_numbers<const N: usize>(out: impl Write, head: &[&str; N], rows: &[[f64; N]]) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(head).map_err(io::Error::other)?;
    for row in rows {
        csv.write_record(row.map(|value| value.to_string())).map_err(io::Error::other)?;
    }
    csv.flush()
}

/// Writes `waves.csv`: a line for each inclination and wavelength, the normal from above first.
///
/// # Errors
/// Those of `out`.
pub fn write_waves(out: impl Write, waves: &ByWaves, rays: Option<&ByRays>) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    for row in WaveRow::all(waves, rays) {
        csv.serialize(row).map_err(io::Error::other)?;
    }
    csv.flush()
}

/// Whether rays or waves describe a surface, in words.
pub fn roads_that_hold(waves: &ByWaves) -> &'static str {
    let rays_hold = waves.along_normal().all(|(_, through)| through.g > LEAST_G);
    let waves_hold = waves.slope_rms < MOST_SLOPE;
    match (rays_hold, waves_hold) {
        (true, true) => "rays and waves both hold: g is above 10, and slopes are below 0.3",
        (true, false) => "rays hold, waves do not: slopes are above 0.3",
        (false, true) => "waves hold, rays do not at all wavelengths: g is below 10",
        (false, false) => {
            "neither rays (g is below 10) nor thin phase screens (slopes are above 0.3) hold at all wavelengths"
        }
    }
}

/// Returns the JSON Schema of `audit.json`.
pub fn surface_audit_schema() -> serde_json::Value {
    schemars::schema_for!(SurfaceAuditFile<'_>).to_value()
}

/// Name of a side in files.
fn name(side: Side) -> &'static str {
    match side {
        Side::Above => "above",
        Side::Below => "below",
    }
}

/// Writes `totals.csv`: a line for each side and inclination of the light; or `totals_by_azimuth.csv`, with an azimuth each.
///
/// # Errors
/// Those of `out`.
pub fn write_totals(out: impl Write, totals: &[Total]) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    let quantities = [
        "reflected",
        "reflected_beyond",
        "transmitted",
        "transmitted_beyond",
        "regular_reflected",
        "regular_transmitted",
        "absorbed",
        "mean_facets",
        "transmitted_near",
        "straight_near",
        "mirror_near",
    ];
    let mut head = vec!["from".to_owned(), "theta_deg".to_owned()];
    head.extend(totals.iter().find_map(|total| total.phi_deg).map(|_| "phi_deg".to_owned()));
    head.extend(quantities.map(str::to_owned));
    head.extend(quantities.map(|name| format!("{name}_error")));
    csv.write_record(head).map_err(io::Error::other)?;
    for total in totals {
        let values = [
            total.reflected,
            total.reflected_beyond,
            total.transmitted,
            total.transmitted_beyond,
            total.regular_reflected,
            total.regular_transmitted,
            total.absorbed,
            total.mean_facets,
            total.transmitted_near,
            total.straight_near,
            total.mirror_near,
        ];
        let mut line = vec![name(total.from).to_owned(), total.theta_deg.to_string()];
        line.extend(total.phi_deg.map(|deg| deg.to_string()));
        line.extend(values.iter().map(|one| digits(one.value)));
        line.extend(values.iter().map(|one| digits(one.error)));
        csv.write_record(line).map_err(io::Error::other)?;
    }
    csv.flush()
}

/// Writes all digits of a number: small ones, such as errors of rounding, with an exponent.
fn digits(number: f64) -> String {
    if number != 0.0 && number.abs() < 1e-4 { format!("{number:e}") } else { number.to_string() }
}

/// Writes `face.npz`: the kernel of a surface as NumPy arrays, also by azimuth if it was measured. That of a coated one contains what its facets
/// absorb.
///
/// # Errors
/// Those of `out`.
pub fn write_face(
    out: impl Write,
    hash: &str,
    index: [f64; 2],
    ByRays { kernel, by_azimuth, .. }: &ByRays,
    coated: bool,
) -> io::Result<()> {
    let mut archive = ZipWriter::new_stream(out);
    let mut array = |name: &str, shape: &[usize], items: Items<'_>| {
        // Not compressed and without a date: equal kernels give equal bytes.
        archive.start_file(format!("{name}.npy"), stored())?;
        write_npy(&mut archive, shape, items)
    };
    let bands = &kernel.bands;
    let count = bands.count();
    array("format", &[1], Items::Text(&[FORMAT]))?;
    array("hash", &[1], Items::Text(&[hash]))?;
    array("index", &[2], Items::Double(&index))?;
    for side in Side::ALL {
        let edges = bands.edges(side);
        array(&format!("beta_{}", name(side)), &[edges.len()], Items::Double(edges))?;
    }
    let azimuths: Vec<f64> =
        (0..=kernel.azimuths()).map(|k| 180.0 * k as f64 / kernel.azimuths() as f64).collect();
    array("dphi_deg", &[azimuths.len()], Items::Double(&azimuths))?;
    let shape = [count, count, kernel.azimuths()];
    array("scattered", &shape, Items::Double(&kernel.scattered))?;
    array("error", &shape, Items::Double(&kernel.errors))?;
    array("regular_reflected", &[count], Items::Double(&kernel.regular_reflected))?;
    array("regular_transmitted", &[count], Items::Double(&kernel.regular_transmitted))?;
    if coated {
        array(COATED, &[count], Items::Double(&kernel.absorbed))?;
    }
    if let Some(ByAzimuth { kernel, .. }) = by_azimuth {
        let phi_deg = kernel.patches.phi_deg();
        array(AZIMUTHS, &[phi_deg.len()], Items::Double(&phi_deg))?;
        let patches = [count, phi_deg.len()];
        let shape = [patches, patches].concat();
        array("scattered_by_azimuth", &shape, Items::Single(&[&kernel.scattered]))?;
        array("error_by_azimuth", &shape, Items::Single(&[&kernel.errors]))?;
        array("regular_reflected_by_azimuth", &patches, Items::Double(&kernel.regular_reflected))?;
        array("regular_transmitted_by_azimuth", &patches, Items::Double(&kernel.regular_transmitted))?;
        if coated {
            array("absorbed_by_azimuth", &patches, Items::Double(&kernel.absorbed))?;
        }
    }
    archive.finish()?.flush()
}
