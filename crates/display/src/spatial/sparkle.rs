//! Sparkle of a display: random brightness of equal pixels below an antiglare face.
//!
//! The face is the rough layer whose correlation length is known, or the uppermost interface of the display. Rays through random
//! faces give the estimate and its standard error; the matrix term is also known in closed form
//! ([`papilio_sparkle`] has the model, its validity and sources).
//!
//! **From the scene.** The windows of the matrix have the luminous reflectance of their sub-pixels in the state `white`, along the
//! view. Films, mirrors and tables are mirror-like pixels, all others Lambertian. Skies, maps and front lights count as
//! diffuse light. Indices are those at 555 nm.

use std::sync::atomic::{AtomicUsize, Ordering};

use papilio_colour::Observer;
use papilio_colour::reader::contrast_sensitivity;
use papilio_optics::Beta;
use papilio_sparkle::{
    Deflection, Effort, Extent, Face, Matrix, Panel, Pixel, PixelLight, Plan, Pupil, Room, Source, Window,
    band_contrast, closed,
};
use papilio_spectra::Spectrum;
use papilio_transport::spatial::Gap;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

use super::target::target;
use crate::metrics::SparkleMetrics;
use crate::run::Workers;
use crate::scene::{self, Drive, FilmPixel, FilmState, Interface, Method, Ready, Scene, Stop, UniformKind};
use crate::setup::{Setup, ViewPoint};
use crate::{Control, DisplayError, Prepared, Progress, pixel};

/// State whose pixels are compared.
const STATE: &str = "white";

/// Wavelength of the indices, nm.
const INDEX_NM: f64 = 555.0;

/// Field of the contrast sensitivity, degrees.
const FIELD_DEG: f64 = 10.0;

/// Octaves of spatial frequency at which sparkle is compared with the threshold of the eye, cycles per degree.
const OCTAVES: [f64; 7] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];

/// Target of the run that computes the luminance of white.
const LUMINANCE_TARGET: f64 = 0.01;

/// Least number of pixels over all replicates: the relative standard error of a PPD is about 2 %.
const PIXELS: usize = 1024;

/// The same for a first answer, and its largest number of replicates: the relative standard error of a PPD is about 10 %.
const FIRST_PIXELS: usize = 48;
const FIRST_REPLICATES: usize = 4;

/// Fewer replicates give standard errors that are uncertain by more than 18 %.
const FEW: usize = 16;

/// An antiglare face, and how its sparkle is estimated.
#[derive(Debug, Clone, PartialEq)]
pub struct Antiglare {
    /// Its heights; one face or more, to compare.
    pub faces: Vec<Face>,
    /// Distances of face and pixels, mm, in the medium above the pixels; empty: the media of the display below the face.
    pub gap_mm: Vec<f64>,
    /// Number of the layer whose interface is the face.
    pub layer: usize,
    /// Diameter of the viewer's pupil, mm; 0 is a pinhole.
    pub pupil_mm: f64,
    /// Number of independent faces, 2 or more.
    pub replicates: usize,
    /// Whether the target of the scene is the user's own: a note says that it is none of sparkle.
    pub has_target: bool,
}

/// Sparkle of a display.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SparkleResult {
    /// State whose pixels are compared: `white`.
    pub state: &'static str,
    /// Period of the pixels along x and y, um.
    pub pitch_um: [f64; 2],
    /// Diameter of the pupil, mm.
    pub pupil_mm: f64,
    /// Distance of the eye, mm.
    pub distance_mm: f64,
    /// One row for each view, gap and face; the last varies fastest.
    pub rows: Vec<SparkleRow>,
    /// Pixels below the faces of each row, for figures.
    #[serde(skip)]
    pub maps: Vec<SparkleMap>,
    /// Warnings and notes for the user.
    pub warnings: Vec<String>,
}

/// Sparkle for one view, gap and face.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SparkleRow {
    /// Inclination of the view, degrees.
    pub theta_deg: f64,
    /// Azimuth of the view, degrees.
    pub phi_deg: f64,
    /// Distance of face and pixels along the normal, mm.
    pub gap_mm: f64,
    /// Correlation length, um.
    pub correlation_um: f64,
    /// Root mean square slope along one axis.
    pub slope_rms: f64,
    /// Pixel power deviation: standard deviation over mean of the light of equal pixels.
    pub ppd: f64,
    /// Matrix term: in uniform light.
    pub ppd_matrix: f64,
    /// Source term: of a uniform pixel plane in the light of the room.
    pub ppd_lamp: f64,
    /// Standard error of `ppd`.
    pub standard_error: f64,
    /// Standard error of `ppd_matrix`.
    pub ppd_matrix_error: f64,
    /// Standard error of `ppd_lamp`.
    pub ppd_lamp_error: f64,
    /// Mean of the light of the pixels in uniform light over that of the matrix: 1 within its error.
    pub mean_over_duty: f64,
    /// Standard error of `mean_over_duty`.
    pub mean_over_duty_error: f64,
    /// Matrix term in closed form; null for heights that are not Gaussian, and for a plane of view that is neither along x nor along y.
    pub ppd_closed_form: Option<f64>,
    /// Largest product of the contrast of sparkle within an octave and of the eye's contrast sensitivity: above 1, sparkle is
    /// above threshold. Null without light.
    pub contrast_times_sensitivity: Option<f64>,
    /// Size of structures from which rays are within 2 % of waves, sqrt(λ d/(2 n)) at 555 nm, um; below it `ppd` is no reference.
    pub rays_valid_from_um: f64,
    /// Size of the structures that bend light, um: sqrt(2) times the rms height over the rms slope; the correlation length of a Gaussian
    /// face.
    pub detail_um: f64,
}

impl SparkleRow {
    /// Returns true if the face is so fine that waves differ from the rays of the result.
    pub fn is_beyond_rays(&self) -> bool {
        self.detail_um < self.rays_valid_from_um
    }

    /// Returns the metrics of the row, for sweeps and searches.
    pub fn metrics(&self) -> SparkleMetrics {
        SparkleMetrics {
            ppd: Some(self.ppd),
            ppd_matrix: Some(self.ppd_matrix),
            ppd_lamp: Some(self.ppd_lamp),
        }
    }

    /// Returns the standard errors of the metrics.
    pub fn errors(&self) -> SparkleMetrics {
        SparkleMetrics {
            ppd: Some(self.standard_error),
            ppd_matrix: Some(self.ppd_matrix_error),
            ppd_lamp: Some(self.ppd_lamp_error),
        }
    }
}

/// Light of the pixels below several faces, side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct SparkleMap {
    /// Number of columns.
    pub columns: usize,
    /// Light of each pixel over the mean, from the lower left, rows upwards.
    pub values: Vec<f64>,
}

/// Computes the sparkle of the pixels of a display in the state `white`, for each view, gap and face.
///
/// # Errors
/// If the scene is invalid; without a matrix, without a state `white`; if a length between face and pixels is missing; if another layer
/// scatters between face and pixels; for collimated sources; for faces and sources that are too fine
/// ([`papilio_sparkle::SparkleError`]); if the computation was stopped.
pub fn sparkle(
    scene: &Scene,
    face: &Antiglare,
    control: &Control<'_>,
) -> Result<SparkleResult, DisplayError> {
    let mut result = estimate(scene, face, PIXELS, control)?;
    if face.replicates < FEW && face.faces.iter().any(|face| matches!(face.extent(), Extent::Drawn)) {
        result.warnings.push(format!(
            "the standard errors are from the scatter of sparkle.replicates = {} random faces, and are themselves uncertain by {:.0} %: \
             {FEW} or more give those of a normal distribution",
            face.replicates,
            100.0 / (2.0 * (face.replicates - 1) as f64).sqrt()
        ));
    }
    Ok(result)
}

/// Computes a first answer: the first view, gap and face, with few pixels. Its standard errors are large.
///
/// # Errors
/// As [`sparkle`].
pub fn first_sparkle(
    scene: &Scene,
    face: &Antiglare,
    control: &Control<'_>,
) -> Result<SparkleResult, DisplayError> {
    let (mut scene, mut face) = (scene.clone(), face.clone());
    scene.viewer.theta_deg.truncate(1);
    scene.viewer.phi_deg.truncate(1);
    face.faces.truncate(1);
    face.gap_mm.truncate(1);
    face.replicates = face.replicates.min(FIRST_REPLICATES);
    face.has_target = false;
    estimate(&scene, &face, FIRST_PIXELS, control)
}

fn estimate(
    scene: &Scene,
    face: &Antiglare,
    pixels: usize,
    control: &Control<'_>,
) -> Result<SparkleResult, DisplayError> {
    let matrix = scene.display.matrix.as_ref().ok_or(DisplayError::NoMatrix { command: "sparkle" })?;
    scene.display.has_sharp_pixels()?;
    let setup = Setup::new(scene, control)?;
    let room = room(scene, &setup)?;
    let luminances = luminances(&setup, control)?;
    let mut workers = None;
    let pool = Workers::wanted(&mut workers, control.threads.unwrap_or(0))?;
    let media = gaps(scene, face)?;
    let rows = media.len() * face.faces.len();
    let mut result = SparkleResult {
        state: STATE,
        pitch_um: matrix.pitch_mm.map(|pitch| 1e3 * pitch),
        pupil_mm: face.pupil_mm,
        distance_mm: scene.viewer.distance_mm,
        rows: Vec::with_capacity(setup.views.len() * rows),
        maps: Vec::with_capacity(setup.views.len() * rows),
        warnings: Vec::new(),
    };
    for (view, luminance) in setup.views.iter().zip(luminances) {
        let beta = view.field.axis_towards();
        let windows = windows(scene, matrix, view.theta_deg)?;
        for media in &media {
            for heights in &face.faces {
                let (views_done, done) = (result.rows.len() / rows, result.rows.len() % rows);
                let report = |of_row: f64| {
                    (control.progress)(Progress {
                        share_of_view: Some((done as f64 + of_row) / rows as f64),
                        ..Progress::of_views(views_done, setup.views.len())
                    });
                };
                report(0.0);
                let panel = Panel {
                    face: heights.clone(),
                    media: media.clone(),
                    matrix: windows.clone(),
                    pixel: kind(&scene.display.pixel),
                    view: beta,
                    pupil: Pupil { diameter_mm: face.pupil_mm, distance_mm: scene.viewer.distance_mm },
                    room: room.clone(),
                };
                let effort = Effort {
                    replicates: face.replicates,
                    pixels,
                    seed: scene.solver.seed,
                    ..Effort::default()
                };
                let (mut row, map) = pool.install(|| row((&panel, view), effort, control, &report))?;
                row.contrast_times_sensitivity =
                    above_threshold(row.ppd, &panel, scene.viewer.distance_mm, luminance);
                result.rows.push(row);
                result.maps.push(map);
            }
        }
    }
    let relative = result.rows.iter().filter(|row| row.ppd > 0.0).map(|row| row.standard_error / row.ppd);
    let largest = relative.fold(0.0, f64::max);
    result.warnings.extend(target(&scene.solver.stop).filter(|target| face.has_target && largest > *target).map(|target| {
        format!(
            "solver.relative_error = {target} is not the target of sparkle, whose error is that of sparkle.replicates = {} random faces: at \
             most {:.1} % of a pixel power deviation; it falls with the root of their number",
            face.replicates,
            100.0 * largest
        )
    }));
    Ok(result)
}

/// Computes one row, without its threshold, and the pixels below its faces; reports the fraction of its faces that are
/// done.
fn row(
    (panel, view): (&Panel, &ViewPoint),
    effort: Effort,
    control: &Control<'_>,
    report: &(dyn Fn(f64) + Sync),
) -> Result<(SparkleRow, SparkleMap), DisplayError> {
    let plan = Plan::new(panel.clone(), effort)?;
    let done = AtomicUsize::new(0);
    let one = |replicate: u64| {
        control.check()?;
        let light = plan.light_of_pixels(replicate);
        report((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / effort.replicates as f64);
        Ok(light)
    };
    let faces: Vec<_> =
        (0..effort.replicates as u64).into_par_iter().map(one).collect::<Result<_, DisplayError>>()?;
    let found = plan.sparkle(&faces.iter().map(|light| Plan::moments(light)).collect::<Vec<_>>());
    let deflection = Deflection::new(&panel.media, panel.view);
    let blur = deflection.blur_mm(&panel.pupil);
    let duty = panel.matrix.mean();
    let ppd_closed_form = match panel.face {
        Face::Gaussian(face) => {
            closed::pixel_power_deviation(face, deflection.per_slope_mm(), &panel.matrix, blur)
        }
        Face::Relief(_) => None,
    };
    let row = SparkleRow {
        theta_deg: view.theta_deg,
        phi_deg: view.phi_deg,
        gap_mm: panel.media.iter().map(|medium| medium.thickness_mm).sum(),
        correlation_um: 1e3 * panel.face.correlation_mm(),
        slope_rms: panel.face.slope_rms(),
        ppd: found.all.ppd,
        ppd_matrix: found.matrix.ppd,
        ppd_lamp: found.source.ppd,
        standard_error: found.all.standard_error,
        ppd_matrix_error: found.matrix.standard_error,
        ppd_lamp_error: found.source.standard_error,
        mean_over_duty: found.matrix.mean / duty,
        mean_over_duty_error: found.matrix.mean_error / duty,
        ppd_closed_form,
        contrast_times_sensitivity: None,
        rays_valid_from_um: 1e3 * rays_valid_from_mm(&panel.media),
        detail_um: 1e3 * panel.face.detail_mm(),
    };
    Ok((row, SparkleMap::new(&faces, plan.columns_and_rows(), found.all.mean)))
}

/// Correlation length from which rays are within 2 % of waves: sqrt(λ d/(2 n)) through all media.
fn rays_valid_from_mm(media: &[Gap]) -> f64 {
    let reduced_mm: f64 = media.iter().map(|medium| medium.thickness_mm / medium.index).sum();
    (0.5 * 1e-6 * INDEX_NM * reduced_mm).sqrt()
}

impl SparkleMap {
    /// Largest number of columns.
    const COLUMNS: usize = 24;

    /// Places faces side by side, in rows of as many as fit.
    fn new(faces: &[Vec<[PixelLight; 3]>], [columns, rows]: [usize; 2], mean: f64) -> Self {
        let across = (Self::COLUMNS / columns).clamp(1, faces.len());
        let mut values = Vec::new();
        for abreast in faces.chunks_exact(across) {
            for row in 0..rows {
                let of = |face: &'_ Vec<[PixelLight; 3]>| face[row * columns..(row + 1) * columns].to_vec();
                let light = |[[one, other], ..]: [PixelLight; 3]| 0.5 * (one + other) / mean;
                values.extend(abreast.iter().flat_map(of).map(light));
            }
        }
        Self { columns: across * columns, values }
    }
}

/// Luminance of the state `white` in each view, cd/m2.
fn luminances(setup: &Setup, control: &Control<'_>) -> Result<Vec<f64>, DisplayError> {
    let mut coarse = setup.scene.clone();
    coarse.solver.method = Method::Auto;
    let target = target(&coarse.solver.stop).unwrap_or(LUMINANCE_TARGET).max(LUMINANCE_TARGET);
    coarse.solver.stop = Stop::RelativeError { target, per_wavelength: false };
    let quiet = Control { progress: &|_| {}, ..*control };
    let result = Prepared::of(setup.clone()).run(&coarse, &quiet)?;
    let white = result.views.iter().map(|view| view.states.get(STATE));
    let luminances = white.map(|state| state.map(|state| state.value.luminance_cd_m2));
    let missing = || DisplayError::NoSuchQuantity { what: format!("state `{STATE}`"), quantity: "sparkle" };
    luminances.collect::<Option<Vec<f64>>>().ok_or_else(missing)
}

/// Largest product of contrast and contrast sensitivity.
fn above_threshold(ppd: f64, panel: &Panel, distance_mm: f64, luminance_cd_m2: f64) -> Option<f64> {
    let mm_per_degree = distance_mm * 1_f64.to_radians().tan();
    let at = |per_degree: f64| {
        let contrast = band_contrast(ppd, panel.matrix.pitch_mm, per_degree / mm_per_degree);
        contrast_sensitivity(per_degree, luminance_cd_m2, FIELD_DEG).map(|sensitivity| contrast * sensitivity)
    };
    OCTAVES.into_iter().map(at).try_fold(0.0, |most: f64, one| Some(most.max(one?)))
}

/// Media between face and pixels for each gap, that of the face first.
fn gaps(scene: &Scene, face: &Antiglare) -> Result<Vec<Vec<Gap>>, DisplayError> {
    let at = |index: &Spectrum| index[nearest(scene)];
    if !face.gap_mm.is_empty() {
        let index = at(scene.display.index_above_pixel());
        return Ok(face.gap_mm.iter().map(|gap| vec![Gap { index, thickness_mm: *gap }]).collect());
    }
    let layers = &scene.display.layers;
    let below = face.layer..layers.len();
    let scatters = |number: &usize| {
        let layer = &layers[*number];
        layer.medium.scattering.is_some() || *number > face.layer && scatters_light(&layer.interface)
    };
    if let Some(other) = below.clone().find(scatters) {
        return Err(DisplayError::SparkleAboveScatterer { number: other + 1 });
    }
    let gap = |number: usize| {
        let thickness_mm = scene.display.length_mm(number)?;
        Ok(Gap { index: at(&layers[number].medium.index), thickness_mm })
    };
    Ok(vec![below.map(gap).collect::<Result<_, DisplayError>>()?])
}

/// True if an interface scatters light.
fn scatters_light(interface: &Interface) -> bool {
    match interface {
        Interface::Rough { .. } | Interface::OfSurface(_) => true,
        Interface::Coating(_) => false,
        Interface::Ready(ready) => {
            matches!(
                ready,
                Ready::Diffuser(_)
                    | Ready::Reflecting(_)
                    | Ready::Rough(_)
                    | Ready::Scatter(_)
                    | Ready::Wave(_)
            )
        }
    }
}

/// Number of the wavelength nearest to 555 nm.
fn nearest(scene: &Scene) -> usize {
    let nm = scene.grid.wavelengths_nm();
    let distance = |k: &usize| (nm[*k] - INDEX_NM).abs();
    (0..nm.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

/// How the pixels reflect.
fn kind(pixel: &scene::Pixel) -> Pixel {
    match pixel {
        scene::Pixel::Film(_) | scene::Pixel::Table(_) | scene::Pixel::Crystal(_) => Pixel::Mirror,
        scene::Pixel::Uniform(uniform) if uniform.kind == UniformKind::Mirror => Pixel::Mirror,
        scene::Pixel::Uniform(_) | scene::Pixel::Scattering(_) => Pixel::Lambertian,
    }
}

/// Light on the display: what has no direction of its own counts as diffuse.
fn room(scene: &Scene, setup: &Setup) -> Result<Room, DisplayError> {
    let mut room = Room::default();
    let directed = 1..=scene.lighting.directed.len();
    for (number, light) in setup.lights.iter().enumerate() {
        if !directed.contains(&number) {
            room.diffuse += light.illuminance_lx;
            continue;
        }
        let source = &scene.lighting.directed[number - 1];
        let radius_deg = source.radius_deg.ok_or(DisplayError::SparkleOfPoint { number: number - 1 })?;
        let index = crate::setup::angle_index(scene)?;
        let beta = Beta::from_source(source.theta_deg, source.phi_deg, index);
        room.sources.push(Source { beta, radius_deg, illuminance: light.illuminance_lx });
    }
    Ok(room)
}

/// Windows of the matrix, with the luminous reflectance of each sub-pixel in the state `white`.
fn windows(scene: &Scene, matrix: &scene::Matrix, theta_deg: f64) -> Result<Matrix, DisplayError> {
    let reflectances = match &scene.display.pixel {
        scene::Pixel::Film(film) => of_sub_pixels(scene, film, theta_deg)?,
        // Other pixels have one sub-pixel, whose states contain the inactive area.
        _ => vec![1.0; matrix.sub_pixels.len()],
    };
    let background = match &scene.display.pixel {
        scene::Pixel::Film(film) => luminous(scene, &film.inactive_reflectance)?,
        _ => 0.0,
    };
    let [width, height] = matrix.pitch_mm;
    let windows = matrix.sub_pixels.iter().zip(reflectances).flat_map(|(sub_pixel, reflectance)| {
        sub_pixel.window.rectangles.iter().map(move |rectangle| Window {
            rectangle_mm: [
                rectangle.x[0] * width,
                rectangle.y[0] * height,
                rectangle.x[1] * width,
                rectangle.y[1] * height,
            ],
            weight: reflectance - background,
        })
    });
    Ok(Matrix { pitch_mm: matrix.pitch_mm, windows: windows.collect(), background })
}

/// Luminous reflectance of each sub-pixel of a film in the state `white`, for the scene's diffuse light.
fn of_sub_pixels(scene: &Scene, film: &FilmPixel, theta_deg: f64) -> Result<Vec<f64>, DisplayError> {
    let missing = || DisplayError::NoSuchQuantity { what: format!("state `{STATE}`"), quantity: "sparkle" };
    let white = film.states.iter().find(|state| state.name == STATE).ok_or_else(missing)?;
    let of = |(number, drive): (usize, &Drive)| {
        let mut alone = scene.clone();
        alone.display.pixel = scene::Pixel::Film(FilmPixel {
            sub_pixels: vec![scene::SubPixel { area: 1.0, ..film.sub_pixels[number].clone() }],
            fill_factor: 1.0,
            states: vec![FilmState { name: STATE.to_owned(), drives: vec![*drive], areas: None }],
            ..film.clone()
        });
        let scan = pixel::scan(&alone, &[theta_deg.abs()])?;
        luminous(scene, &scan.states[0].1)
    };
    white.drives.iter().enumerate().map(of).collect()
}

/// Luminous reflectance of a spectrum in the scene's diffuse light.
fn luminous(scene: &Scene, reflectance: &[f64]) -> Result<f64, DisplayError> {
    let observer = Observer::new(&scene.grid)?;
    let light = &scene.lighting.diffuse_spectrum;
    let seen: Vec<f64> =
        light.iter().zip(reflectance).map(|(light, reflectance)| light * reflectance).collect();
    Ok(observer.luminance(&seen) / observer.luminance(light))
}
