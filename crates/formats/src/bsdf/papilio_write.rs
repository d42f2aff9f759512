//! Writer of Papilio's own format of a measurement.

use std::io::{self, Write};

use papilio_goniometry::{
    Geometry, MeasuredPart, Measurement, Ring, SpecularGrid, Symmetry, TensorTree, TreeNode,
};
use zip::write::{StreamWriter, ZipWriter};

use super::papilio::{About, AboutPart, CONVENTIONS, FORMAT, Kind, Origin, prefix};
use super::write::WriteError;
use crate::npy::{Items, stored, write_npy};

pub(super) fn write(out: &mut dyn Write, measurement: &Measurement) -> Result<Vec<String>, WriteError> {
    let mut archive = Archive { zip: ZipWriter::new_stream(out) };
    for part in &measurement.parts {
        archive.part(part)?;
    }
    let provenance = measurement.provenance.clone();
    let about = About {
        format: FORMAT.to_owned(),
        version: 1,
        conventions: CONVENTIONS,
        media: measurement.media,
        provenance: Origin {
            format: provenance.format,
            sample: provenance.sample,
            source: provenance.source,
            remarks: provenance.remarks,
        },
        parts: measurement.parts.iter().map(about_part).collect(),
    };
    let text = serde_json::to_string(&about).map_err(io::Error::from)?;
    archive.array("about", &[], Items::Text(&[&text]))?;
    archive.zip.finish().map_err(io::Error::from)?.into_inner().flush()?;
    Ok(Vec::new())
}

fn about_part(part: &MeasuredPart) -> AboutPart {
    let geometry = match &part.geometry {
        Geometry::Specular(grid) => Kind::Specular { plane_symmetrical: grid.symmetry == Symmetry::Plane },
        Geometry::Spherical(_) => Kind::Spherical,
        Geometry::Pairs(_) => Kind::Pairs,
        Geometry::Patches { .. } => Kind::Patches,
        Geometry::HalfAngle(_) => Kind::HalfAngle,
        Geometry::Tree(tree) => Kind::Tree { rank: tree.rank() },
        Geometry::Warped(grid) => Kind::Warped { jacobian: grid.fields().jacobian },
    };
    let channels = part.channels.iter().map(ToString::to_string).collect();
    AboutPart { way: part.way.name().to_owned(), channels, geometry }
}

struct Archive<'a> {
    zip: ZipWriter<StreamWriter<&'a mut dyn Write>>,
}

impl Archive<'_> {
    fn array(&mut self, name: &str, shape: &[usize], items: Items<'_>) -> io::Result<()> {
        // Not compressed and without a date: equal measurements give equal bytes.
        self.zip.start_file(format!("{name}.npy"), stored().large_file(true))?;
        write_npy(&mut self.zip, shape, items)
    }

    fn axes(&mut self, prefix: &str, axes: &[(&str, &[f64])]) -> io::Result<()> {
        axes.iter().try_for_each(|(name, values)| {
            self.array(&format!("{prefix}_{name}"), &[values.len()], Items::Double(values))
        })
    }

    fn part(&mut self, part: &MeasuredPart) -> io::Result<()> {
        let prefix = prefix(part.way);
        let mut shape = vec![part.channels.len()];
        shape.extend(self.geometry(&prefix, &part.geometry)?);
        self.array(&format!("{prefix}_values"), &shape, Items::Double(&part.values))?;
        if part.tis.is_empty() {
            return Ok(());
        }
        self.axes(&prefix, &[("tis", &part.tis)])
    }

    /// Writes the arrays of a geometry, and returns the shape of a channel's values.
    fn geometry(&mut self, prefix: &str, geometry: &Geometry) -> io::Result<Vec<usize>> {
        match geometry {
            Geometry::Specular(grid) => self.specular(prefix, grid),
            Geometry::Spherical(grid) => {
                let axes: [(&str, &[f64]); 4] = [
                    ("theta_i_deg", &grid.theta_i_deg),
                    ("phi_i_deg", &grid.phi_i_deg),
                    ("theta_o_deg", &grid.theta_o_deg),
                    ("phi_o_deg", &grid.phi_o_deg),
                ];
                self.axes(prefix, &axes)?;
                Ok(axes.iter().map(|(_, axis)| axis.len()).collect())
            }
            Geometry::Pairs(pairs) => {
                let rows = pairs.iter().flat_map(|[i, o]| [i.theta_deg, i.phi_deg, o.theta_deg, o.phi_deg]);
                let rows: Vec<f64> = rows.collect();
                self.array(&format!("{prefix}_pairs_deg"), &[pairs.len(), 4], Items::Double(&rows))?;
                Ok(vec![pairs.len()])
            }
            Geometry::Patches { incoming, outgoing } => {
                let counts = [("incoming", incoming), ("outgoing", outgoing)].map(|(name, rings)| {
                    self.rings(&format!("{prefix}_{name}"), rings)
                        .map(|()| papilio_goniometry::patch_count(rings))
                });
                counts.into_iter().collect()
            }
            Geometry::HalfAngle(_) => Ok(papilio_goniometry::HalfAngleGrid::SHAPE.to_vec()),
            Geometry::Tree(tree) => self.tree(prefix, tree),
            Geometry::Warped(grid) => self.warped(prefix, grid.fields()),
        }
    }

    fn specular(&mut self, prefix: &str, grid: &SpecularGrid) -> io::Result<Vec<usize>> {
        let axes: [(&str, &[f64]); 4] = [
            ("rotations_deg", &grid.rotations_deg),
            ("incidences_deg", &grid.incidences_deg),
            ("azimuths_deg", &grid.azimuths_deg),
            ("radials_deg", &grid.radials_deg),
        ];
        self.axes(prefix, &axes)?;
        Ok(axes.iter().map(|(_, axis)| axis.len()).collect())
    }

    fn rings(&mut self, name: &str, rings: &[Ring]) -> io::Result<()> {
        let rows: Vec<f64> = rings.iter().flat_map(|ring| [ring.from_deg, ring.patches as f64]).collect();
        self.array(name, &[rings.len(), 2], Items::Double(&rows))
    }

    fn tree(&mut self, prefix: &str, tree: &TensorTree) -> io::Result<Vec<usize>> {
        let row = |node: &TreeNode| match *node {
            TreeNode::Branch { children, cell } => [f64::from(children), f64::from(cell)],
            TreeNode::Grid { log2, cell } => [-1.0 - f64::from(log2), f64::from(cell)],
        };
        let rows: Vec<f64> = tree.nodes().iter().flat_map(row).collect();
        self.array(&format!("{prefix}_nodes"), &[tree.nodes().len(), 2], Items::Double(&rows))?;
        Ok(vec![tree.cells()])
    }

    fn warped(&mut self, prefix: &str, fields: &papilio_goniometry::WarpFields) -> io::Result<Vec<usize>> {
        self.axes(prefix, &[("phi_i_rad", &fields.phi_i), ("theta_i_rad", &fields.theta_i)])?;
        let lights = [fields.phi_i.len(), fields.theta_i.len()];
        let grids = [("ndf", &fields.ndf), ("sigma", &fields.sigma)];
        for (name, (values, shape)) in grids {
            self.array(&format!("{prefix}_{name}"), shape, Items::Double(values))?;
        }
        let (values, shape) = &fields.vndf;
        self.array(&format!("{prefix}_vndf"), &[lights, *shape].concat(), Items::Double(values))?;
        Ok([lights, fields.shape].concat())
    }
}
