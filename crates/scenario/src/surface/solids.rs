//! Surfaces that are no maps of heights: meshes of files, and particles in a slab.

use std::collections::BTreeMap;

use papilio_diagnostics::Diagnostic;
use papilio_formats::read_mesh;
use papilio_microgeometry::{Mesh, Surface, Volume};

use super::{Common, SurfaceScenario};
use crate::describe::microgeometry::{self as described, Road};
use crate::describe::numbers::SurfaceLength;
use crate::error::Errors;
use crate::read::Spanned;

/// Size parameter below which particles diffract rather than refract; rays are then wrong.
const LEAST_SIZE: f64 = 50.0;

/// Wavelength at which the size parameter is compared, nm.
const GREEN_NM: f64 = 550.0;

impl SurfaceScenario {
    /// Reads a mesh.
    pub(super) fn mesh(
        &self,
        mesh: &described::Mesh,
        common: &Common<'_>,
        errors: &mut Errors,
        inputs: &mut BTreeMap<String, String>,
    ) -> Option<Surface> {
        if common.road != Road::Rays {
            let wrong = Diagnostic::new("waves need heights, and a mesh may overhang")
                .expected("`road = \"rays\"` with a mesh");
            errors.push(common.road_at, wrong);
            return None;
        }
        let kept = self.open(&mesh.file, errors, inputs)?;
        let found = match read_mesh(kept.file()) {
            Ok(found) => found,
            Err(error) => {
                errors.push_data(mesh.file.origin, error);
                return None;
            }
        };
        let period_um = match &mesh.period_um.value {
            None => None,
            Some(list) => {
                match list.iter().map(|length: &Spanned<SurfaceLength>| length.0).collect::<Vec<_>>()[..] {
                    [x, y] => Some([x, y]),
                    _ => {
                        let wrong = Diagnostic::new(format!("this list has {} numbers", list.len()))
                            .expected("two lengths, along x and y");
                        errors.push(mesh.period_um.origin, wrong);
                        return None;
                    }
                }
            }
        };
        let unit = mesh.um_per_unit.0;
        let triangles: Vec<[[f64; 3]; 3]> = found
            .triangles
            .iter()
            .map(|corners| corners.map(|corner| corner.map(|value| unit * value)))
            .collect();
        match Mesh::new(&triangles, period_um) {
            Ok(mesh) => Some(Surface::Mesh(mesh)),
            Err(wrong) => {
                let hint = "the mesh must repeat without a gap: check `period_um` and `um_per_unit`, and join its corners in the program that \
                            wrote it";
                errors.push(mesh.file.origin, Diagnostic::new(wrong.to_string()).hint(hint));
                None
            }
        }
    }

    /// Particles in a slab.
    pub(super) fn volume(volume: &Spanned<described::Volume>, errors: &mut Errors) -> Option<Surface> {
        let matrix = volume.matrix_index.0;
        let found = Volume {
            radius_um: volume.radius_um.0,
            length_um: volume.length_um.as_ref().map_or(0.0, |length| length.0),
            index: volume.index.0,
            volume_fraction: volume.volume_fraction.0,
            thickness_um: volume.thickness_um.0,
            seed: volume.seed.0,
        };
        let size = found.size_parameter(matrix, GREEN_NM);
        if size < LEAST_SIZE {
            let least = LEAST_SIZE * 1e-3 * GREEN_NM / (std::f64::consts::TAU * matrix);
            let wrong = Diagnostic::new(format!(
                "particles with a radius of {} um have the size parameter 2 pi r n/lambda = {size:.1} at {GREEN_NM} nm: they diffract light, and \
                 rays do not",
                found.radius_um
            ))
            .expected(format!("a radius of at least {least:.2} um, for a size parameter of {LEAST_SIZE}"))
            .hint("layers `kind = \"slab\"` scatter light by a phase function that is stated; see docs/scattering.md");
            errors.push(volume.radius_um.origin, wrong);
            return None;
        }
        if (found.index - matrix).abs() < 1e-6 {
            let wrong = Diagnostic::new("the particles have the index of the matrix, and scatter nothing")
                .expected("an `index` that is not `matrix_index`");
            errors.push(volume.index.origin, wrong);
            return None;
        }
        Some(Surface::Volume(found))
    }
}
