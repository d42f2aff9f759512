//! Surfaces given by their geometry, as interfaces between media: measured when a scene is prepared, not
//! before.
//!
//! **By rays.** A virtual goniometer follows the rays of all bands of directions. The kernel that it finds is
//! the same at all wavelengths. **By waves.** A random face of small heights scatters into lobes that are
//! known in closed form, and depend on the wavelength; they are balanced so that no light is lost.
//!
//! Both take up to minutes, and depend on nothing but the surface. What was found is therefore kept for the
//! process: all preparations of a command, designs of a sweep that have the surface, and requests to a server
//! use it. Several threads that need one surface wait for the first.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

pub use papilio_microgeometry::{Correlation, Goniometer, Surface};
use papilio_microgeometry::{FaceKernels, FaceTable, MicrogeometryError, REPLICATES, WaveLobe, wave_lobes};
use papilio_optics::lobe::{BalancedLobe, FaceLight, FaceLobe};
use papilio_spectra::{Grid, Spectrum};
use papilio_transport::{Interface, RegularRings, ScatterFace, WaveFace, WaveLight};

use crate::DisplayError;
use crate::run::{Control, Progress};

/// A surface given by its geometry, between two media of constant index.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceFace {
    /// How it scatters.
    pub model: SurfaceModel,
    /// Key of the surface in the scenario, such as `display.layers.1.surface`, for error messages.
    pub key: String,
}

/// How a surface scatters.
#[derive(Debug, Clone, PartialEq)]
pub enum SurfaceModel {
    /// As the rays of a goniometer do, whose media are those of the layers and whose facets have no coating.
    Rays {
        /// The surface.
        surface: Surface,
        /// The instrument; its inclinations and azimuths are not used.
        goniometer: Goniometer,
    },
    /// As waves do on random heights.
    Waves {
        /// Correlation of the heights.
        correlation: Correlation,
        /// Root mean square height, um.
        rms_um: f64,
        /// Correlation length, um.
        correlation_um: f64,
        /// Refractive index above and below.
        index: [f64; 2],
    },
}

/// Number of surfaces and of balanced lobes that are kept: those that were found last.
const MOST_SURFACES: usize = 8;
const MOST_LOBES: usize = 200;

/// Fraction of a computation that the measurement of its surface is reported as.
const PART: [f64; 2] = [0.0, 0.1];

static SURFACES: Mutex<Vec<Arc<Measurement>>> = Mutex::new(Vec::new());
static LOBES: Mutex<Vec<BalancedLobe>> = Mutex::new(Vec::new());

/// A surface by rays, and what was measured.
struct Measurement {
    of: Arc<SurfaceFace>,
    kernels: Mutex<Option<FaceKernels>>,
}

impl SurfaceFace {
    /// Returns the interface on a grid of wavelengths; measures it unless that is known.
    ///
    /// # Errors
    /// A surface that cannot be measured; if the measurement was stopped.
    pub(crate) fn interface(
        self: &Arc<Self>,
        grid: &Grid,
        control: &Control<'_>,
    ) -> Result<Interface, DisplayError> {
        match &self.model {
            SurfaceModel::Rays { surface, goniometer } => {
                let kernels = self.measured((surface, goniometer), control)?;
                Ok(face_by_rays(kernels, grid.len()))
            }
            SurfaceModel::Waves { .. } => self.by_waves(grid, |lobe, light, done| {
                control.check()?;
                (control.progress)(Progress { unit: "lobes", ..done }.within(PART));
                Ok(balanced(lobe, light))
            }),
        }
    }

    /// Returns an interface that scatters no light, but takes as many directions as this surface: its work
    /// can be estimated before it is measured.
    pub(crate) fn estimated(&self, grid: &Grid) -> Result<Interface, DisplayError> {
        let SurfaceModel::Rays { goniometer, .. } = &self.model else {
            return self.by_waves(grid, |lobe, light, _| Ok(BalancedLobe::unbalanced(lobe, light)));
        };
        let index = [goniometer.index_above, goniometer.index_below];
        let mirror = FaceTable::mirror(index);
        Ok(face_by_rays(mirror.kernels().map_err(|error| self.wrong(error))?, grid.len()))
    }

    /// The kernels of a surface by rays.
    fn measured(
        self: &Arc<Self>,
        (surface, goniometer): (&Surface, &Goniometer),
        control: &Control<'_>,
    ) -> Result<FaceKernels, DisplayError> {
        let entry = {
            let mut kept = locked(&SURFACES);
            let known = kept.iter().find(|one| Arc::ptr_eq(&one.of, self) || one.of.model == self.model);
            match known.cloned() {
                Some(known) => known,
                None => {
                    let new = Measurement { of: Arc::clone(self), kernels: Mutex::new(None) };
                    kept.push(Arc::new(new));
                    let surplus = kept.len().saturating_sub(MOST_SURFACES);
                    kept.drain(..surplus);
                    Arc::clone(&kept[kept.len() - 1])
                }
            }
        };
        let mut kernels = locked(&entry.kernels);
        if let Some(known) = &*kernels {
            return Ok(known.clone());
        }
        let done = AtomicUsize::new(0);
        let finished = || {
            let done = 1 + done.fetch_add(1, Ordering::Relaxed);
            let now = Progress::of_views(done, REPLICATES as usize);
            (control.progress)(Progress { unit: "replicates of a surface", ..now }.within(PART));
        };
        // On all processors, whatever the number of threads of this computation: it is often one of many
        // workers, which wait for the surface. Totals at single inclinations are not needed.
        let goniometer = Goniometer { incidence_deg: Vec::new(), azimuths: None, ..goniometer.clone() };
        let found = goniometer
            .replicates(surface, &|| control.stopped(), &finished)
            .and_then(|replicates| goniometer.kernel(&replicates))
            .and_then(|kernel| {
                FaceTable::new([goniometer.index_above, goniometer.index_below], &kernel).kernels()
            })
            .map_err(|error| self.wrong(error))?;
        Ok(kernels.insert(found).clone())
    }

    /// Returns a face by waves. Its lobes differ by wavelength: `balance` computes each of them, and is given the
    /// progress over all lobes.
    fn by_waves(
        &self,
        grid: &Grid,
        mut balance: impl FnMut(FaceLobe, FaceLight, Progress<'_>) -> Result<BalancedLobe, DisplayError>,
    ) -> Result<Interface, DisplayError> {
        let SurfaceModel::Waves { correlation, rms_um, correlation_um, index } = self.model else {
            return Ok(Interface::Fresnel);
        };
        let [above, below] = index;
        let kinds = [
            (FaceLight::Transmitted(index), below - above),
            (FaceLight::Reflected([above, below]), 2.0 * above),
            (FaceLight::Reflected([below, above]), 2.0 * below),
        ];
        let wavelengths_nm = grid.wavelengths_nm();
        let lobes = kinds.map(|(_, path)| {
            wave_lobes(correlation, 2.0 * PI * path.abs() * rms_um, correlation_um, &wavelengths_nm)
        });
        let (mut done, all) = (0, lobes.iter().map(Vec::len).sum());
        let mut made = kinds.map(|_| Vec::new());
        for ((light, _), (lobes, made)) in kinds.into_iter().zip(lobes.into_iter().zip(&mut made)) {
            for WaveLobe { lobe, fractions } in lobes {
                let balanced = balance(lobe, light, Progress::of_views(done, all))?;
                made.push((balanced, Spectrum::from_values(fractions)));
                done += 1;
            }
        }
        let lights = made.map(|lobes| WaveLight::new(lobes, grid.len()));
        Ok(Interface::Wave(Box::new(WaveFace::new(lights))))
    }

    fn wrong(&self, error: MicrogeometryError) -> DisplayError {
        match error {
            MicrogeometryError::Interrupted => DisplayError::Interrupted,
            error => DisplayError::Surface { key: self.key.clone(), error },
        }
    }
}

/// The face that these kernels describe, the same at all `bins` wavelengths.
pub fn face_by_rays(kernels: FaceKernels, bins: usize) -> Interface {
    let FaceKernels { through, reflection, rings, reflected, transmitted } = kernels;
    let regular = RegularRings { rings, reflected, transmitted };
    Interface::Scatter(Box::new(ScatterFace::of_surface(through, reflection, regular, bins)))
}

/// A balanced lobe; computes it unless it is known.
fn balanced(lobe: FaceLobe, light: FaceLight) -> BalancedLobe {
    let known = |other: &&BalancedLobe| other.lobe() == lobe && other.light() == light;
    if let Some(lobe) = locked(&LOBES).iter().find(known) {
        return lobe.clone();
    }
    let lobe = BalancedLobe::new(lobe, light);
    let mut kept = locked(&LOBES);
    kept.push(lobe.clone());
    let surplus = kept.len().saturating_sub(MOST_LOBES);
    kept.drain(..surplus);
    lobe
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
