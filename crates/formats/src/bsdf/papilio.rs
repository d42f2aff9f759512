//! Reader of Papilio's own format of a measurement, "papilio-measurement 1": NumPy arrays in a zip archive,
//! without any loss.
//!
//! `docs/bsdf-files.md` describes the format.

use std::collections::HashSet;

use papilio_goniometry::{
    Channel, Direction, Geometry, HalfAngleGrid, MeasuredPart, Measurement, Provenance, Ring, ScatterMode,
    SpecularGrid, SphericalGrid, Symmetry, TensorTree, TreeNode, WarpFields, WarpedGrid,
};
use serde::{Deserialize, Serialize};

use super::table_read::{channel_named, way_named};
use super::{BsdfProblem, LARGEST_VALUE, MOST_CELLS, VALUE_RANGE, Warned};
use crate::error::{FormatError, Problem};
use crate::npz::{Array, Npz};

/// Name of the format in `about`.
pub(super) const FORMAT: &str = "papilio-measurement";

/// Content of the array `about`, as JSON.
#[derive(Serialize, Deserialize)]
pub(super) struct About {
    pub(super) format: String,
    pub(super) version: u32,
    #[serde(default, skip_deserializing)]
    pub(super) conventions: &'static str,
    pub(super) media: [f64; 2],
    pub(super) provenance: Origin,
    pub(super) parts: Vec<AboutPart>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct Origin {
    pub(super) format: String,
    pub(super) sample: String,
    pub(super) source: String,
    pub(super) remarks: Vec<String>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct AboutPart {
    pub(super) way: String,
    pub(super) channels: Vec<String>,
    #[serde(flatten)]
    pub(super) geometry: Kind,
}

/// The geometry, except its arrays.
#[derive(Serialize, Deserialize, Clone, Copy)]
#[serde(tag = "geometry", rename_all = "snake_case")]
pub(super) enum Kind {
    Specular { plane_symmetrical: bool },
    Spherical,
    Pairs,
    Patches,
    HalfAngle,
    Tree { rank: usize },
    Warped { jacobian: bool },
}

/// Conventions of values and directions in `about`.
pub(super) const CONVENTIONS: &str = "f in 1/sr without the cosine, NaN where nothing was measured; directions point \
away from the sample, theta from the normal of their side, phi the same on both sides, degrees; values [channel][cell ...]";

/// Returns the prefix of the names of a part's arrays.
pub(super) fn prefix(way: ScatterMode) -> String {
    way.name().replace(' ', "_")
}

/// Names of the parts, in words.
const WAYS: &str = "`front reflection`, `front transmission`, `back transmission` or `back reflection`";

pub(super) fn read(mut arrays: Npz<'_>, about: &str) -> Result<Warned<Measurement>, FormatError> {
    let about: About = serde_json::from_str(about).map_err(|e| arrays.unsound("about", &e.to_string()))?;
    if about.version != 1 {
        let what = format!("version {} of {FORMAT}", about.version);
        return Err(arrays.error(BsdfProblem::Unsupported { what, expected: "version 1" }));
    }
    if let Some(&value) = about.media.iter().find(|n| !(n.is_finite() && **n >= 1.0)) {
        let expected = "a finite index of 1 or more";
        return Err(arrays.error(Problem::OutOfRange { what: "the index of a medium", value, expected }));
    }
    let mut parts: Vec<MeasuredPart> = Vec::new();
    for part in &about.parts {
        let read = read_part(&mut arrays, part)?;
        if parts.iter().any(|other| other.way == read.way) {
            return Err(arrays.error(BsdfProblem::Twice { what: read.way.name().to_owned() }));
        }
        parts.push(read);
    }
    if parts.is_empty() {
        return Err(arrays.error(BsdfProblem::Missing { what: "part" }));
    }
    let Origin { format, sample, source, remarks } = about.provenance;
    let provenance = Provenance { format, sample, source, remarks };
    Ok(Warned { value: Measurement { provenance, media: about.media, parts }, warnings: Vec::new() })
}

fn read_part(arrays: &mut Npz<'_>, about: &AboutPart) -> Result<MeasuredPart, FormatError> {
    let way = way_named(&about.way).ok_or_else(|| {
        arrays.unsound("about", &format!("`{}` is not the name of a part; expected {WAYS}", about.way))
    })?;
    let channels: Option<Vec<Channel>> = about.channels.iter().map(|name| channel_named(name)).collect();
    let channels = channels.filter(|channels| {
        let mut seen = HashSet::new();
        !channels.is_empty() && channels.iter().all(|channel| seen.insert(channel.to_string()))
    });
    let channels = channels.ok_or_else(|| {
        arrays.unsound("about", "the list of channels is empty, has an unknown name or has a name twice")
    })?;
    let prefix = prefix(way);
    let values_name = format!("{prefix}_values");
    let Array { shape, values } = arrays.numbers(&values_name)?;
    let geometry = Reader { arrays, prefix: &prefix, shape: &shape }.geometry(about.geometry)?;
    if channels.len().checked_mul(geometry.cells()) != Some(values.len()) {
        return Err(arrays.unsound(&values_name, "it does not have one value for each channel and cell"));
    }
    if let Some(&value) = values.iter().find(|value| **value < 0.0 || **value > LARGEST_VALUE) {
        let problem = Problem::OutOfRange { what: "a value of the BSDF", value, expected: VALUE_RANGE };
        return Err(arrays.error(problem));
    }
    let tis_name = format!("{prefix}_tis");
    let tis = if arrays.has(&tis_name) { arrays.numbers(&tis_name)?.values } else { Vec::new() };
    if !tis.iter().all(|tis| (0.0..=LARGEST_VALUE).contains(tis))
        || !fits_tis(&geometry, channels.len(), tis.len())
    {
        return Err(arrays
            .unsound(&tis_name, "expected a number of 0 or more for each channel, rotation and incidence"));
    }
    Ok(MeasuredPart { way, channels, geometry, values, tis })
}

fn fits_tis(geometry: &Geometry, channels: usize, count: usize) -> bool {
    match geometry {
        Geometry::Specular(grid) => {
            count == 0 || count == channels * grid.rotations_deg.len() * grid.incidences_deg.len()
        }
        _ => count == 0 || count.is_multiple_of(channels),
    }
}

/// Reader of the arrays of a part's geometry.
struct Reader<'a, 'b> {
    arrays: &'a mut Npz<'b>,
    prefix: &'a str,
    /// Shape of the array of values.
    shape: &'a [usize],
}

impl Reader<'_, '_> {
    fn geometry(&mut self, kind: Kind) -> Result<Geometry, FormatError> {
        Ok(match kind {
            Kind::Specular { plane_symmetrical } => {
                let azimuths = if plane_symmetrical { 0.0..=180.0 } else { -360.0..=360.0 };
                let grid = SpecularGrid {
                    rotations_deg: self.axis("rotations_deg", -360.0..=360.0)?,
                    incidences_deg: self.axis("incidences_deg", 0.0..=90.0)?,
                    azimuths_deg: self.axis("azimuths_deg", azimuths)?,
                    radials_deg: self.axis("radials_deg", 0.0..=180.0)?,
                    symmetry: if plane_symmetrical { Symmetry::Plane } else { Symmetry::None },
                };
                let lengths =
                    [&grid.rotations_deg, &grid.incidences_deg, &grid.azimuths_deg, &grid.radials_deg];
                self.check(&lengths.map(Vec::len))?;
                Geometry::Specular(grid)
            }
            Kind::Spherical => {
                let grid = SphericalGrid {
                    theta_i_deg: self.axis("theta_i_deg", 0.0..=90.0)?,
                    phi_i_deg: self.axis("phi_i_deg", -360.0..=720.0)?,
                    theta_o_deg: self.axis("theta_o_deg", 0.0..=90.0)?,
                    phi_o_deg: self.axis("phi_o_deg", -360.0..=720.0)?,
                };
                let lengths = [&grid.theta_i_deg, &grid.phi_i_deg, &grid.theta_o_deg, &grid.phi_o_deg];
                self.check(&lengths.map(Vec::len))?;
                Geometry::Spherical(grid)
            }
            Kind::Pairs => Geometry::Pairs(self.pairs()?),
            Kind::Patches => {
                Geometry::Patches { incoming: self.rings("incoming")?, outgoing: self.rings("outgoing")? }
            }
            Kind::HalfAngle => Geometry::HalfAngle(HalfAngleGrid),
            Kind::Tree { rank } => self.tree(rank)?,
            Kind::Warped { jacobian } => self.warped(jacobian)?,
        })
    }

    fn array(&mut self, name: &str) -> Result<Array, FormatError> {
        self.arrays.numbers(&format!("{}_{name}", self.prefix))
    }

    fn unsound(&self, name: &str, what: &str) -> FormatError {
        self.arrays.unsound(&format!("{}_{name}", self.prefix), what)
    }

    fn axis(&mut self, name: &str, range: std::ops::RangeInclusive<f64>) -> Result<Vec<f64>, FormatError> {
        let values = self.array(name)?.values;
        let ascends = values.windows(2).all(|pair| pair[0] < pair[1]);
        if values.is_empty() || !ascends || !values.iter().all(|value| range.contains(value)) {
            let (least, most) = range.into_inner();
            return Err(self.unsound(name, &format!("expected ascending angles from {least} to {most} deg")));
        }
        Ok(values)
    }

    /// Fails unless the lengths of the axes match the array of values.
    fn check(&self, lengths: &[usize]) -> Result<(), FormatError> {
        if self.shape.get(1..) == Some(lengths) {
            return Ok(());
        }
        Err(self.unsound("values", "its shape does not match the axes"))
    }

    fn pairs(&mut self) -> Result<Vec<[Direction; 2]>, FormatError> {
        let Array { shape, values } = self.array("pairs_deg")?;
        let rows = values.as_chunks::<4>().0;
        let is_pair = |row: &[f64; 4]| {
            let thetas = [row[0], row[2]].iter().all(|theta| (0.0..=90.0).contains(theta));
            thetas && row.iter().all(|angle| angle.abs() <= 1000.0)
        };
        if shape.len() != 2 || shape[1] != 4 || !rows.iter().all(is_pair) {
            return Err(self.unsound("pairs_deg", "expected rows of theta_i, phi_i, theta_o, phi_o"));
        }
        let pair = |row: &[f64; 4]| [Direction::new(row[0], row[1]), Direction::new(row[2], row[3])];
        Ok(rows.iter().map(pair).collect())
    }

    fn rings(&mut self, name: &str) -> Result<Vec<Ring>, FormatError> {
        let values = self.array(name)?.values;
        let rows = values.as_chunks::<2>().0;
        let whole = |n: f64| (1.0..=5000.0).contains(&n) && n.fract() == 0.0;
        let ascends = rows.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        let begins = rows.first().is_some_and(|row| row[0] == 0.0) && rows.iter().all(|row| row[0] < 90.0);
        let count: f64 = rows.iter().map(|row| row[1]).sum();
        if count > 5000.0
            || !begins
            || !ascends
            || !values.len().is_multiple_of(2)
            || !rows.iter().all(|row| whole(row[1]))
        {
            return Err(self.unsound(name, "expected rows of the lower angle of a ring, ascending from 0 to below 90 deg, and its number of patches"));
        }
        Ok(rows.iter().map(|row| Ring { from_deg: row[0], patches: row[1] as usize }).collect())
    }

    fn tree(&mut self, rank: usize) -> Result<Geometry, FormatError> {
        let values = self.array("nodes")?.values;
        let node = |row: &[f64; 2]| {
            let [child, cell] = *row;
            let whole =
                |n: f64| (n.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&n)).then_some(n as u32);
            let cell = whole(cell)?;
            match child {
                child if child >= 0.0 => Some(TreeNode::Branch { children: whole(child)?, cell }),
                child => Some(TreeNode::Grid { log2: u8::try_from(whole(-1.0 - child)?).ok()?, cell }),
            }
        };
        let nodes: Option<Vec<TreeNode>> = values.as_chunks().0.iter().map(node).collect();
        let tree = nodes.and_then(|nodes| TensorTree::new(rank, nodes));
        tree.map(Geometry::Tree).ok_or_else(|| self.unsound("nodes", "the nodes do not form a tree"))
    }

    fn warped(&mut self, jacobian: bool) -> Result<Geometry, FormatError> {
        let mut grid = |name: &str| {
            let Array { shape, values } = self.array(name)?;
            match shape[..] {
                [.., rows, columns] => Ok((values, [rows, columns])),
                _ => Err(self.unsound(name, "expected rows and columns")),
            }
        };
        let (ndf, sigma, vndf) = (grid("ndf")?, grid("sigma")?, grid("vndf")?);
        let &[_, _, _, rows, columns] = self.shape else {
            return Err(self.unsound("values", "expected five dimensions"));
        };
        let (phi_i, theta_i) = (self.array("phi_i_rad")?.values, self.array("theta_i_rad")?.values);
        let lights = phi_i.len().saturating_mul(theta_i.len());
        if lights.saturating_mul(rows.saturating_mul(columns)) > MOST_CELLS {
            return Err(self.unsound("values", "it has too many values"));
        }
        let fields = WarpFields { phi_i, theta_i, ndf, sigma, vndf, shape: [rows, columns], jacobian };
        let grid = WarpedGrid::new(fields);
        grid.map(|grid| Geometry::Warped(Box::new(grid)))
            .ok_or_else(|| self.unsound("vndf", "the arrays of this grid are inconsistent"))
    }
}
