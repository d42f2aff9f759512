//! `model = "microgeometry"`: a face by its geometry: its kernel in a file, or a surface that is measured
//! when the scene is prepared.

use std::f64::consts::{PI, SQRT_2};
use std::sync::Arc;

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{Interface, SurfaceFace, SurfaceModel, face_by_rays};
use papilio_formats::read_face;
use papilio_microgeometry::{
    Coating, Correlation, FaceKernels, MOST_PHASE, Measurement, REPLICATES, Spectrum as Heights, Surface,
};
use papilio_spectra::Spectrum;

use super::relief::SurfaceRelief;
use super::{FaceHeights, KnownFace, Resolver};
use crate::describe::diffuser::FaceOfSurface;
use crate::edit::{Edit, edit};
use crate::library::Library;
use crate::origin::Origin;
use crate::read::Spanned;
use crate::surface::{ResolvedSurface, SurfaceScenario};

/// Difference of refractive indices that counts as none.
const SAME_INDEX: f64 = 1e-6;

/// Most rays of a band of a surface that is a layer: 2 minutes on a processor. And for scenarios in memory:
/// those that a server is given by anyone.
const MOST_RAYS: u64 = 1_000_000;
const MOST_RAYS_IN_MEMORY: u64 = 50_000;

/// A surface that is a layer of a display.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerSurface {
    /// Path of the layer: `display.layers.0`.
    pub path: String,
    /// Name of the file of the surface.
    pub file: String,
    /// Names of the files of the surface, relative to the folder of its own.
    pub inputs: Vec<String>,
    /// Text of the file with the keys of the layer and the indices of its neighbours.
    pub text: String,
}

impl Resolver<'_> {
    /// Resolves a face between media of these indices.
    pub(super) fn microgeometry(
        &mut self,
        path: &str,
        face: &Spanned<FaceOfSurface>,
        media: [&Spectrum; 2],
    ) -> Option<Interface> {
        let index = self.constant_indices(face.origin, media)?;
        match (&face.file.value, &face.surface.value) {
            (Some(name), None) => {
                let kernels = self.face_of_file(face, name, index)?;
                Some(face_by_rays(kernels, self.grid.len()).into())
            }
            (None, Some(name)) => {
                let surface = self.surface(path, face, name, index)?;
                let model = match surface.measurement.by_rays {
                    true => {
                        self.note_azimuths(&format!("`{name}`"), surface.measurement.goniometer.azimuths);
                        self.by_rays(face, &surface)?
                    }
                    false => self.by_waves(face, &surface, index)?,
                };
                let found = SurfaceFace { model, key: format!("{path}.surface") };
                if let Some(heights) = heights_of(surface) {
                    self.known_faces.push((path.to_owned(), KnownFace { origin: face.origin, heights }));
                }
                Some(Interface::OfSurface(Arc::new(found)))
            }
            (file, _) => {
                let wrong = match file {
                    Some(_) => "both `file` and `surface` are given",
                    None => "neither `file` nor `surface` is given",
                };
                let wrong = Diagnostic::new(wrong)
                    .expected("`file`, a kernel that `papilio gonio` has written, or `surface`, a file with a table [microgeometry]");
                self.errors.push(face.origin, wrong);
                None
            }
        }
    }

    /// Indices of both media, which must not depend on wavelength and differ.
    fn constant_indices(&mut self, at: Origin, media: [&Spectrum; 2]) -> Option<[f64; 2]> {
        let wrong = if media.iter().any(|index| !index.is_constant()) {
            Diagnostic::new("the index of a medium next to this face depends on wavelength")
                .expected(
                    "the same index at all wavelengths, with which the rays of its kernel are refracted",
                )
                .hint("a number as index, for example that at 550 nm")
        } else if (media[0][0] - media[1][0]).abs() < SAME_INDEX {
            Diagnostic::new("the media on both sides of this face have the same index")
                .expected("two media of different index")
                .hint("add a { kind = \"medium\" } with another index below the face")
        } else {
            return Some(media.map(|index| index[0]));
        };
        self.errors.push(at, wrong);
        None
    }

    fn face_of_file(&mut self, face: &FaceOfSurface, name: &str, index: [f64; 2]) -> Option<FaceKernels> {
        let at = face.file.origin;
        let own = [
            ("pitch_um", face.pitch_um.is_some(), face.pitch_um.origin),
            ("radius_um", face.radius_um.is_some(), face.radius_um.origin),
            ("aperture_radius_um", face.aperture_radius_um.is_some(), face.aperture_radius_um.origin),
            ("rms_nm", face.rms_nm.is_some(), face.rms_nm.origin),
            ("correlation_um", face.correlation_um.is_some(), face.correlation_um.origin),
            ("rays", face.rays.is_some(), face.rays.origin),
        ];
        if let Some((key, _, at)) = own.into_iter().find(|(_, given, _)| *given) {
            let wrong = Diagnostic::new(format!("`{key}` cannot change a kernel that was measured before"))
                .hint("use `surface`, the file that describes the geometry, instead of `file`");
            self.errors.push(at, wrong);
            return None;
        }
        let kept = self.open(name, at)?;
        let (table, azimuths) = match read_face(kept.file()) {
            Ok(found) => found,
            Err(error) => {
                self.errors.push_data(at, error);
                return None;
            }
        };
        if (0..2).any(|side| (table.index[side] - index[side]).abs() > SAME_INDEX) {
            let [above, below] = table.index;
            let wrong = Diagnostic::new(format!(
                "this kernel is that of a face between the indices {above} and {below}, but here it lies between {} and {}",
                index[0], index[1]
            ))
            .hint("measure it again with `papilio gonio` and these index_above and index_below, or use `surface` instead of `file`");
            self.errors.push(at, wrong);
            return None;
        }
        self.note_azimuths(&format!("`{name}`"), azimuths);
        // The reader has checked it.
        table.kernels().ok()
    }

    /// Notes that a layer does not have the azimuths of its surface.
    fn note_azimuths(&mut self, name: &str, azimuths: Option<usize>) {
        if let Some(azimuths) = azimuths {
            self.notes.push(format!(
                "{name} has its kernel by azimuth, in steps of {} deg; a layer of a display uses its mean over all azimuths, that of the surface \
                 turned about its normal",
                360.0 / azimuths as f64
            ));
        }
    }

    /// A face by waves, if its lobes are known.
    fn by_waves(
        &mut self,
        face: &FaceOfSurface,
        surface: &ResolvedSurface,
        index: [f64; 2],
    ) -> Option<SurfaceModel> {
        let random = match &surface.measurement.surface {
            Surface::Random(random) => Some(random.spectrum()),
            _ => None,
        };
        let (correlation, rms_um, correlation_um) = match random {
            Some(&Heights::Exponential { rms_um, correlation_um, .. }) => {
                (Correlation::Exponential, rms_um, correlation_um)
            }
            Some(&Heights::Gaussian { rms_um, correlation_um }) => {
                (Correlation::Gaussian, rms_um, correlation_um)
            }
            _ => {
                let wrong = Diagnostic::new(
                    "this surface cannot be a layer of a display with `road = \"waves\"`",
                )
                .expected(
                    "`surface = \"exponential\"` or `\"gaussian\"`, whose lobes are known in closed form",
                )
                .hint("road = \"rays\" follows rays through any surface, without wavelengths");
                self.errors.push(face.surface.origin, wrong);
                return None;
            }
        };
        let [above, below] = index;
        let wavelengths_nm = self.grid.wavelengths_nm();
        let shortest_um = 1e-3 * wavelengths_nm.iter().copied().fold(f64::INFINITY, f64::min);
        // Of transmitted light, and of light reflected above and below.
        let paths = [below - above, 2.0 * above, 2.0 * below];
        let per_um = paths.map(|path| 2.0 * PI * path.abs() / shortest_um).into_iter().fold(0.0, f64::max);
        if per_um * rms_um > MOST_PHASE {
            let wrong = Diagnostic::new(format!(
                "heights of {:e} nm rms are too many wavelengths for waves",
                1e3 * rms_um
            ))
            .expected(format!("a `rms_nm` of at most {:.0} here", 1e3 * MOST_PHASE / per_um))
            .hint("`road = \"rays\"` describes such a surface");
            let at = if face.rms_nm.value.is_some() { face.rms_nm.origin } else { face.surface.origin };
            self.errors.push(at, wrong);
            return None;
        }
        Some(SurfaceModel::Waves { correlation, rms_um, correlation_um, index })
    }

    /// Reads the surface of a file with the keys of the layer.
    fn surface(
        &mut self,
        path: &str,
        face: &FaceOfSurface,
        name: &str,
        index: [f64; 2],
    ) -> Option<ResolvedSurface> {
        let at = face.surface.origin;
        let kept = self.open(name, at)?;
        let text = match kept.file().text() {
            Ok(text) => text.to_owned(),
            Err(error) => {
                self.errors.push_data(at, error);
                return None;
            }
        };
        let lengths = [
            ("pitch_um", face.pitch_um.value.map(|length| length.0)),
            ("radius_um", face.radius_um.value.map(|length| length.0)),
            ("aperture_radius_um", face.aperture_radius_um.value.map(|length| length.0)),
            ("rms_nm", face.rms_nm.value.map(|height| height.0)),
            ("correlation_um", face.correlation_um.value.map(|length| length.0)),
            ("rays", face.rays.value.map(|rays| rays.0 as f64)),
            ("index_above", Some(index[0])),
            ("index_below", Some(index[1])),
        ];
        let given = lengths.into_iter().filter_map(|(key, value)| value.map(|value| (key, value)));
        let given: Vec<(&str, f64)> = given.collect();
        let overrides: Vec<String> =
            given.iter().map(|(key, value)| format!("microgeometry.{key}={value}")).collect();
        let library = self.library.beside(name);
        if let Ok(own) = SurfaceScenario::from_text(&text, name, library.clone(), &[])
            && own.is_volume()
        {
            let wrong = Diagnostic::new("a volume is no face: it has the same medium above and below")
                .expected("a surface between two media")
                .hint("`kind = \"slab\"` is a layer with scattering in its volume; see docs/scattering.md");
            self.errors.push(at, wrong);
            return None;
        }
        let surface = SurfaceScenario::from_text(&text, name, library, &overrides)
            .and_then(|surface| surface.resolve());
        match surface {
            Ok(surface) if surface.measurement.goniometer.coating != Coating::None => {
                let wrong = Diagnostic::new("the facets of this surface are coated")
                    .expected("a surface without `coating`")
                    .hint("its kernel is that of one wavelength, and a layer has the same kernel at all wavelengths; `papilio gonio` measures it");
                self.errors.push(at, wrong);
                None
            }
            Ok(surface) => {
                self.inputs.insert(format!("{path}.surface"), surface.hash.clone());
                self.notes.extend(surface.notes.iter().map(|note| format!("{name}: {note}")));
                let text = with_keys(&text, &given);
                let inputs = surface.canonical["inputs"].as_object();
                let inputs = inputs.into_iter().flat_map(|files| files.keys().cloned()).collect();
                self.surfaces.push(LayerSurface {
                    path: path.to_owned(),
                    file: name.to_owned(),
                    inputs,
                    text,
                });
                Some(surface)
            }
            Err(errors) => {
                self.errors.push(at, Diagnostic::new(format!("the surface cannot be read\n{errors}")));
                None
            }
        }
    }

    /// A face by rays, if these are not too many.
    fn by_rays(&mut self, face: &FaceOfSurface, surface: &ResolvedSurface) -> Option<SurfaceModel> {
        let Measurement { surface, goniometer, .. } = &surface.measurement;
        let rays = goniometer.rays * REPLICATES;
        let most = match self.library {
            Library::Memory { .. } => MOST_RAYS_IN_MEMORY,
            _ => MOST_RAYS,
        };
        if rays > most {
            let wrong = Diagnostic::new(format!("this surface asks for {rays} rays of each band"))
                .expected(format!("at most {most} here"))
                .hint("add rays = 20000 to the layer, or measure it with `papilio gonio` and give its face.npz as `file`");
            self.errors.push(face.surface.origin, wrong);
            return None;
        }
        Some(SurfaceModel::Rays { surface: surface.clone(), goniometer: goniometer.clone() })
    }
}

/// The heights of a surface, for sparkle.
fn heights_of(surface: ResolvedSurface) -> Option<FaceHeights> {
    if let Surface::Random(random) = &surface.measurement.surface
        && let &Heights::Gaussian { rms_um, correlation_um } = random.spectrum()
    {
        let slope_rms = SQRT_2 * rms_um / correlation_um;
        return Some(FaceHeights::Gaussian { slope_rms, correlation_um });
    }
    let relief = SurfaceRelief::new(surface.measurement.surface, surface.is_mirrored)?;
    Some(FaceHeights::Surface(Arc::new(relief)))
}

/// The text of a surface with other values of keys; how many rays are followed is no property of the surface.
fn with_keys(text: &str, given: &[(&str, f64)]) -> String {
    let of_surface = given.iter().filter(|(key, _)| *key != "rays");
    let set = |(key, value): &(&str, f64)| Edit::Set {
        path: format!("microgeometry.{key}"),
        value: (*value).into(),
    };
    // The same keys were accepted as overrides.
    edit(text, &of_surface.map(set).collect::<Vec<_>>()).unwrap_or_else(|_| text.to_owned())
}
