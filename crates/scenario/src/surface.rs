//! Files of `[microgeometry]`: a surface, and how the virtual goniometer measures it.

mod coating;
mod density;
mod heights;
mod solids;

use std::collections::BTreeMap;
use std::path::Path;

use papilio_diagnostics::Diagnostic;
use papilio_formats::{DataFile, LARGEST_FILE};
use papilio_microgeometry::{
    Caps, Goniometer, Lattice, Measurement, MicrogeometryError, REPLICATES, RandomHeights, Spectrum, Surface,
};
use serde_json::{Value, json};

use crate::describe::microgeometry::{CapLattice, FaceCoating, MapPeriod, Microgeometry, Road, SurfaceFile};
use crate::describe::numbers::{AzimuthStep, Inclination, Wavelength};
use crate::error::{EXAMPLE_SURFACE, Errors, ScenarioError, ScenarioErrors};
use crate::library::{Library, MemoryFile, Missing, sha256};
use crate::mistake;
use crate::origin::Origin;
use crate::read::{Read as _, Spanned};
use crate::scenario::{CompleteTree, assemble, parse, sorted};
use crate::source::Sources;
use crate::tree::Node;

/// A described surface. Its files are not read yet.
#[derive(Debug)]
pub struct SurfaceScenario {
    file: SurfaceFile,
    root: Node,
    sources: Sources,
    library: Library,
    notes: Vec<String>,
}

/// A surface that can be measured.
#[derive(Debug, Clone)]
pub struct ResolvedSurface {
    /// The surface, and how it is measured.
    pub measurement: Measurement,
    /// Whether it is a height map with its mirror images.
    pub is_mirrored: bool,
    /// Title of the file.
    pub title: Option<String>,
    /// Notes: consequences that are worth knowing, and not wrong.
    pub notes: Vec<String>,
    /// The file with every default filled in and sorted keys, and under `inputs` the SHA-256 of each file
    /// that it names.
    pub canonical: Value,
    /// SHA-256 of `canonical` as compact JSON, in hexadecimal digits.
    pub hash: String,
}

impl ResolvedSurface {
    /// The same with a ninth of the rays, and three times the error.
    pub fn preview(mut self) -> Self {
        let rays = &mut self.measurement.goniometer.rays;
        *rays = rays.div_ceil(9);
        self
    }
}

/// What a kind of surface has in common with all others.
struct Common<'a> {
    index: [f64; 2],
    incidence_deg: &'a Spanned<Vec<Spanned<Inclination>>>,
    azimuth_deg: &'a Spanned<Option<AzimuthStep>>,
    coating: Option<(&'a FaceCoating, Origin)>,
    road: Road,
    /// Place of the key `road`.
    road_at: Origin,
    wavelength_nm: Option<&'a Spanned<Vec<Spanned<Wavelength>>>>,
    rays: u64,
    seed: u64,
}

/// The keys that all kinds have.
macro_rules! common {
    ($kind:expr) => {
        Common {
            index: [$kind.index_above.0, $kind.index_below.0],
            incidence_deg: &$kind.incidence_deg,
            azimuth_deg: &$kind.azimuth_deg,
            coating: $kind.coating.as_ref().map(|coating| (coating, $kind.coating.origin)),
            road: $kind.road.value,
            road_at: $kind.road.origin,
            wavelength_nm: Some(&$kind.wavelength_nm),
            rays: $kind.rays.0,
            seed: $kind.seed.0,
        }
    };
}

impl SurfaceScenario {
    /// Reads a file with a surface. `overrides` are texts `PATH=VALUE`, as in `--set`.
    ///
    /// # Errors
    /// A file that cannot be read, and all mistakes of the text, each with its place.
    pub fn load(path: &Path, overrides: &[String]) -> Result<Self, ScenarioErrors> {
        let name = path.display().to_string();
        let unread = |error| ScenarioError::unread(path, error, EXAMPLE_SURFACE);
        let file = DataFile::open(path, &name).map_err(unread)?;
        let text = file.text().map_err(ScenarioError::from)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let sources = parse(text, &name, overrides)?.in_folder(folder);
        Self::read(sources, folder.into())
    }

    /// Reads a surface from a text. Errors call it `name`; its files are in `library`.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn from_text(
        text: &str,
        name: &str,
        library: impl Into<Library>,
        overrides: &[String],
    ) -> Result<Self, ScenarioErrors> {
        Self::read(parse(text, name, overrides)?, library.into())
    }

    fn read(sources: Sources, library: Library) -> Result<Self, ScenarioErrors> {
        let CompleteTree { root, notes, .. } = assemble(&sources, &[])?;
        let mut errors = Errors::default();
        if root.get("microgeometry").is_none() && root.get("display").is_some() {
            let wrong = Diagnostic::new("this is the scenario of a display, not a surface")
                .expected("a file with the table [microgeometry]")
                .hint("surfaces/ has examples; `papilio run` computes displays");
            errors.push(Origin::FILE, wrong);
            errors.check(&sources)?;
        }
        let file = SurfaceFile::read(&root, &mut errors);
        let file = errors.finish(file, &sources)?;
        Ok(Self { file, root, sources, library, notes })
    }

    /// Whether it describes particles, and not a face between two media.
    pub(crate) fn is_volume(&self) -> bool {
        matches!(self.file.microgeometry.value, Microgeometry::Volume(_))
    }

    /// Reads the files of the surface, and checks it.
    ///
    /// # Errors
    /// All keys that do not fit together, each with its place, and mistakes in files.
    pub fn resolve(&self) -> Result<ResolvedSurface, ScenarioErrors> {
        let mut errors = Errors::default();
        let mut inputs = BTreeMap::new();
        let mut notes = self.notes.clone();
        let found = self.surface(&mut errors, &mut inputs, &mut notes);
        let (surface, common) = errors.finish(found, &self.sources)?;
        let mut errors = Errors::default();
        let coating = self.coating(&common, &mut errors, &mut inputs);
        if let Err(wrong) = surface.check() {
            errors.push(self.place_of(&wrong), Diagnostic::new(wrong.to_string()));
        }
        let is_written =
            |key: &str| self.root.get("microgeometry").is_some_and(|table| table.get(key).is_some());
        let incidence_deg = incidences(common.incidence_deg, is_written("incidence_deg"), &mut errors);
        if let Some(list) = common.wavelength_nm {
            check_wavelengths(list, is_written("wavelength_nm"), &mut errors);
        }
        let azimuths = azimuths(common.azimuth_deg, common.road, &mut errors);
        let coating = errors.finish(coating, &self.sources)?;
        let goniometer = Goniometer {
            index_above: common.index[0],
            index_below: common.index[1],
            coating,
            incidence_deg,
            azimuths,
            rays: common.rays.div_ceil(REPLICATES),
            seed: common.seed,
        };
        if let Err(wrong) = goniometer.patches() {
            let mut errors = Errors::default();
            errors.push(common.azimuth_deg.origin, Diagnostic::new(wrong.to_string()));
            errors.check(&self.sources)?;
        }
        let listed = common.wavelength_nm.filter(|list| !list.is_empty());
        let waves_nm = match (common.road, listed) {
            (Road::Rays, _) => Vec::new(),
            (_, None) => (8..15).map(|step| 50.0 * f64::from(step)).collect(),
            (_, Some(list)) => list.iter().map(|item| item.0).collect(),
        };
        let mut canonical = serde_json::to_value(&self.file).unwrap_or_default();
        if let Value::Object(keys) = &mut canonical {
            keys.insert("inputs".to_owned(), json!(inputs));
        }
        let canonical = sorted(canonical);
        if let Surface::Mesh(mesh) = &surface {
            notes.extend(mesh.notes());
        }
        let described = &self.file.microgeometry.value;
        let is_mirrored =
            matches!(described, Microgeometry::HeightMap(map) if map.value.period.value == MapPeriod::Mirror);
        Ok(ResolvedSurface {
            is_mirrored,
            measurement: Measurement { surface, goniometer, by_rays: common.road != Road::Waves, waves_nm },
            title: self.file.title.as_ref().map(|title| title.0.clone()),
            notes,
            hash: sha256(canonical.to_string().as_bytes()),
            canonical,
        })
    }

    fn surface(
        &self,
        errors: &mut Errors,
        inputs: &mut BTreeMap<String, String>,
        notes: &mut Vec<String>,
    ) -> Option<(Surface, Common<'_>)> {
        Some(match &self.file.microgeometry.value {
            Microgeometry::Flat(flat) => (Surface::Flat, common!(flat.value)),
            Microgeometry::Caps(caps) => {
                let lattice = match caps.lattice.value {
                    CapLattice::Square => Lattice::Square,
                    CapLattice::Hexagonal => Lattice::Hexagonal,
                    CapLattice::Random => Lattice::Random { seed: caps.seed.0 },
                };
                let surface = Surface::Caps(Caps {
                    pitch_um: caps.pitch_um.0,
                    radius_um: caps.radius_um.0,
                    aperture_um: caps.aperture_radius_um.0,
                    lattice,
                });
                (surface, common!(caps.value))
            }
            Microgeometry::HeightMap(map) => {
                (self.heights(&map.value, errors, inputs, notes)?, common!(map.value))
            }
            Microgeometry::Gaussian(face) => {
                let spectrum = Spectrum::Gaussian {
                    rms_um: 1e-3 * face.rms_nm.0,
                    correlation_um: face.correlation_um.0,
                };
                (self.random(spectrum, face.seed.0, errors)?, common!(face.value))
            }
            Microgeometry::Exponential(face) => {
                let spectrum = Spectrum::Exponential {
                    rms_um: 1e-3 * face.rms_nm.0,
                    correlation_um: face.correlation_um.0,
                    cutoff_um: face.cutoff_um.0,
                };
                (self.random(spectrum, face.seed.0, errors)?, common!(face.value))
            }
            Microgeometry::Psd(face) => {
                let spectrum = self.spectrum(face, errors, inputs)?;
                (self.random(spectrum, face.seed.0, errors)?, common!(face.value))
            }
            Microgeometry::Mesh(mesh) => {
                let common = common!(mesh.value);
                (self.mesh(&mesh.value, &common, errors, inputs)?, common)
            }
            Microgeometry::Volume(volume) => {
                let index = volume.matrix_index.0;
                let common = Common {
                    index: [index; 2],
                    incidence_deg: &volume.incidence_deg,
                    azimuth_deg: &volume.azimuth_deg,
                    coating: None,
                    road: Road::Rays,
                    road_at: volume.origin,
                    wavelength_nm: None,
                    rays: volume.rays.0,
                    seed: volume.seed.0,
                };
                (Self::volume(volume, errors)?, common)
            }
        })
    }

    /// Opens a file that the surface names, and records its SHA-256.
    fn open(
        &self,
        file: &Spanned<String>,
        errors: &mut Errors,
        inputs: &mut BTreeMap<String, String>,
    ) -> Option<MemoryFile> {
        match self.library.open(&file.value, LARGEST_FILE) {
            Ok(kept) => {
                inputs.insert(file.value.clone(), kept.sha256().to_owned());
                return Some(kept);
            }
            Err(Missing::Unread(error)) => {
                errors.push_unread(file.origin, error, self.library.tried(&file.value, false));
            }
            Err(Missing::Unknown(wrong)) => errors.push(file.origin, wrong),
        }
        None
    }

    /// A random face.
    fn random(&self, spectrum: Spectrum, seed: u64, errors: &mut Errors) -> Option<Surface> {
        match RandomHeights::new(spectrum, seed) {
            Ok(face) => Some(Surface::Random(face)),
            Err(wrong) => {
                errors.push(self.place_of(&wrong), Diagnostic::new(wrong.to_string()));
                None
            }
        }
    }

    /// Place of the key that an error of a surface is about.
    fn place_of(&self, wrong: &MicrogeometryError) -> Origin {
        let key = match wrong {
            MicrogeometryError::ApertureBeyondRadius { .. } => "microgeometry.aperture_radius_um",
            MicrogeometryError::CapsOverlap { .. } => "microgeometry.pitch_um",
            MicrogeometryError::RandomFace { .. } => "microgeometry.cutoff_um",
            MicrogeometryError::Volume { .. } => "microgeometry.volume_fraction",
            _ => "microgeometry",
        };
        self.root.place_of(key)
    }
}

/// Number of azimuths in a turn.
fn azimuths(step: &Spanned<Option<AzimuthStep>>, road: Road, errors: &mut Errors) -> Option<usize> {
    let deg = step.value?.0;
    let half = 180.0 / deg;
    let wrong = if road == Road::Waves {
        Diagnostic::new("waves do not tell azimuths").expected("`road = \"rays\"` or `\"both\"`")
    } else if (half - half.round()).abs() > 1e-9 {
        Diagnostic::new(format!("180 deg is not a whole number of steps of {deg} deg"))
            .expected("steps such as 15, 20 or 30 deg")
            .hint("light that goes back has the azimuth + 180 deg, which must be one of the others")
    } else {
        return Some(2 * half.round() as usize);
    };
    errors.push(step.origin, wrong);
    None
}

/// Shortest wavelength, nm: below it, the heights of any surface are too many wavelengths.
const SHORTEST_NM: f64 = 1.0;

/// Fails for a list that is written and empty, and for wavelengths that are none of light.
fn check_wavelengths(list: &Spanned<Vec<Spanned<Wavelength>>>, is_written: bool, errors: &mut Errors) {
    if list.is_empty() && is_written {
        errors.push(list.origin, mistake::empty_list());
    }
    for item in list.iter().filter(|item| item.0 < SHORTEST_NM) {
        errors.push(item.origin, mistake::out_of_range(item.0, format!("wavelengths from {SHORTEST_NM} nm")));
    }
}

/// Inclinations, each once and within the hemisphere.
fn incidences(list: &Spanned<Vec<Spanned<Inclination>>>, is_written: bool, errors: &mut Errors) -> Vec<f64> {
    if list.is_empty() && is_written {
        errors.push(list.origin, mistake::empty_list());
    }
    if list.is_empty() {
        return (0..18).map(|step| 5.0 * f64::from(step)).collect();
    }
    for item in list.iter().filter(|item| item.0 < 0.0) {
        let wrong = Diagnostic::new(format!("{} deg is a negative inclination", item.0))
            .expected("inclinations from 0 to below 90 deg")
            .hint("the light has all azimuths: its inclination has no sign");
        errors.push(item.origin, wrong);
    }
    list.iter().map(|item| item.0).collect()
}
