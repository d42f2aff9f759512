//! Output files of `papilio gonio`: `totals.csv`, `audit.json` and `face.npz`.

use std::io::{self, Write};

use papilio_microgeometry::{Audit, Kernel, Side, Total};
use schemars::JsonSchema;
use serde::Serialize;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::npy::{Items, write_npy};

/// Content of `audit.json`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct SurfaceAuditFile<'a> {
    /// Version of the program.
    pub papilio: &'a str,
    /// Title of the surface.
    pub title: &'a str,
    /// SHA-256 of the file and the bytes of its maps.
    pub hash: &'a str,
    /// Refractive index above.
    pub index_above: f64,
    /// Refractive index below.
    pub index_below: f64,
    /// Seed of rays and random surfaces.
    pub seed: u64,
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
}

impl<'a> SurfaceAuditFile<'a> {
    /// The file of an audit.
    pub fn new(
        [papilio, title, hash]: [&'a str; 3],
        [index_above, index_below]: [f64; 2],
        seed: u64,
        audit: &'a Audit,
    ) -> Self {
        Self {
            papilio,
            title,
            hash,
            index_above,
            index_below,
            seed,
            rays: audit.rays,
            dropped_rays: audit.dropped_rays,
            energy_z: &audit.energy_z,
            reciprocity_z: audit.reciprocity_z_rms,
            reciprocity_z_largest: audit.reciprocity_z_largest,
            reciprocity_tests: audit.reciprocity_tests,
            moved_by_symmetry: audit.moved_by_symmetry,
            moved_by_balance: audit.moved_by_balance,
            relative_error: audit.relative_error,
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

/// Writes `totals.csv`: a line for each side and inclination of the light.
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
    ];
    let mut head = vec!["from".to_owned(), "theta_deg".to_owned()];
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
            Default::default(),
            total.mean_facets,
        ];
        let mut line = vec![name(total.from).to_owned(), total.theta_deg.to_string()];
        line.extend(values.iter().map(|one| one.value.to_string()));
        line.extend(values.iter().map(|one| one.error.to_string()));
        csv.write_record(line).map_err(io::Error::other)?;
    }
    csv.flush()
}

/// Writes `face.npz`: the kernel of a surface as NumPy arrays.
///
/// # Errors
/// Those of `out`.
pub fn write_face(out: impl Write, hash: &str, index: [f64; 2], kernel: &Kernel) -> io::Result<()> {
    let mut archive = ZipWriter::new_stream(out);
    let mut array = |name: &str, shape: &[usize], items: Items<'_>| {
        // Not compressed and without a date: equal kernels give equal bytes.
        archive.start_file(format!("{name}.npy"), SimpleFileOptions::default())?;
        write_npy(&mut archive, shape, items)
    };
    let bands = &kernel.bands;
    let count = bands.count();
    array("format", &[1], Items::Text(&["papilio-face 1"]))?;
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
    archive.finish()?.flush()
}
