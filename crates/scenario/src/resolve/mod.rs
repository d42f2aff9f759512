//! Resolving: materials, files and lights are evaluated on the wavelength grid, and all keys are checked
//! together.

mod cache;
mod codes;
mod crystal;
mod data;
mod diffuser;
mod environment;
mod film;
mod fringes;
mod image;
mod layers;
mod light;
mod lighting;
mod maps;
mod matrix;
mod measure;
mod measured;
mod microgeometry;
mod palette;
mod panel;
mod pattern;
mod picture;
mod pixel;
mod reflection;
mod regions;
mod relief;
mod rough;
mod sampling;
mod sparkle;
mod stack;
mod through;
mod unbounded;
mod viewer;
mod windows;

pub use measure::VirtualMeasurement;
pub(crate) use measure::measurement;

use std::collections::BTreeMap;
use std::sync::Arc;

use papilio_diagnostics::{Diagnostic, Remedy, short_numbers};
use papilio_display::image::SourceImage;
use papilio_display::scene::{self, Scene, Strategy, WithinStep};
use papilio_display::spatial::{Antiglare, Patterns};
use papilio_spectra::{Grid, Tabulated};

use self::relief::SurfaceRelief;
use self::sampling::Judge;
use crate::describe::solver::{self, Solver};
use crate::describe::{File, metrics};
use crate::error::{Errors, ScenarioErrors};
use crate::library::Library;
use crate::mistake::{self, Mistake};
use crate::origin::Origin;
use crate::read::Spanned;
use crate::source::Sources;

/// Visible range of the standard observer, nm.
const VISIBLE_NM: (f64, f64) = (380.0, 780.0);
/// Range with 99.9 % of V(lambda), nm.
const LUMINOUS_NM: (f64, f64) = (400.0, 700.0);

/// Most memory of a run, bytes.
const MOST_BYTES: f64 = 1e9;

/// Largest number of distinct film gaps x wavelengths: each film is tabulated at up to 1088 angles.
const MOST_FILMS: usize = 100_000;

pub use codes::PanelCodes;
pub use image::ImageRequest;
pub use microgeometry::LayerSurface;
pub use picture::picture_size;

/// Smallest number of paths of a view: 32 replicates with at least one path each.
const FEWEST_PATHS: u64 = 32;

/// A scene, with its warnings, notes and input files.
pub(crate) struct Found {
    pub(crate) scene: Scene,
    pub(crate) patterns: Patterns,
    /// The antiglare face, if it is described.
    pub(crate) sparkle: Option<Antiglare>,
    /// The picture, if it was requested.
    pub(crate) image: Option<ImageRequest>,
    /// Surfaces that are layers of the display.
    pub(crate) surfaces: Vec<LayerSurface>,
    pub(crate) warnings: Vec<String>,
    pub(crate) notes: Vec<String>,
    /// SHA-256 of each file that was read, by its name.
    pub(crate) inputs: BTreeMap<String, String>,
}

/// State of the resolution: the grid, and the results so far.
struct Resolver<'a> {
    grid: Grid,
    /// Place of the first and last wavelength.
    range: Origin,
    library: &'a Library,
    sources: &'a Sources,
    errors: Errors,
    warnings: Vec<String>,
    notes: Vec<String>,
    inputs: BTreeMap<String, String>,
    /// Whether the spectra of lights are used: otherwise they need not cover the grid.
    needs_light: bool,
    /// Light of the maps on the display.
    maps: Vec<maps::MapLight>,
    /// Tables of reflectances and transmittances with points between the wavelengths of the grid, by the names of their files.
    tables: Vec<(String, Tabulated)>,
    /// Whether a spectrum of the display is a table.
    is_tabulated: bool,
    /// Lobes that may scatter more light than they receive.
    unbounded: Vec<unbounded::UnboundedLobe>,
    /// Whether a diffuser that loses light has no described reflection.
    reflects_nothing: bool,
    /// Surfaces that are layers of the display.
    surfaces: Vec<LayerSurface>,
    /// Surfaces by their geometry that have heights, by the key of their layer.
    known_faces: Vec<(String, KnownFace)>,
    /// Whether lengths have a purpose besides absorption: below a matrix, and at the port of a sphere.
    needs_lengths: bool,
}

/// A face between two layers whose heights are known.
#[derive(Debug, Clone)]
struct KnownFace {
    /// Place in the file.
    origin: Origin,
    heights: FaceHeights,
}

#[derive(Debug, Clone)]
enum FaceHeights {
    /// Gaussian heights of the correlation exp(-r²/l²).
    Gaussian {
        /// Root mean square slope along one axis.
        slope_rms: f64,
        /// The length l, um.
        correlation_um: f64,
    },
    /// Those of any other surface.
    Surface(Arc<SurfaceRelief>),
}

/// Which picture is requested.
#[derive(Clone, Copy)]
pub(crate) enum PictureChoice<'a> {
    /// None.
    No,
    /// That of `[image]`.
    Described,
    /// One in memory, instead of `image.file`.
    Given(&'a SourceImage),
}

/// Resolves a described scenario whose files are in `library`; the picture of `[image]` only if it is
/// requested. Without `needs_light`, lights need not cover the wavelengths.
pub(crate) fn resolve(
    file: &File,
    library: &Library,
    sources: &Sources,
    (pictured, needs_light): (PictureChoice<'_>, bool),
) -> Result<Found, ScenarioErrors> {
    let mut resolver = Resolver { needs_light, ..Resolver::new(file, library, sources)? };
    let scene = resolver.scene(file);
    let patterns = scene.as_ref().map(|scene| resolver.patterns(file, scene)).unwrap_or_default();
    let sparkle = scene.as_ref().and_then(|scene| resolver.sparkle(file, scene));
    let image = scene.as_ref().and_then(|scene| match pictured {
        PictureChoice::No => None,
        PictureChoice::Described => resolver.image(file, scene, None),
        PictureChoice::Given(source) => resolver.image(file, scene, Some(source)),
    });
    let Resolver { errors, surfaces, warnings, notes, inputs, .. } = resolver;
    let scene = errors.finish(scene, sources)?;
    let short = |all: Vec<String>| all.iter().map(|one| short_numbers(one).into_owned()).collect();
    let (warnings, notes) = (short(warnings), short(notes));
    Ok(Found { scene, patterns, sparkle, image, surfaces, warnings, notes, inputs })
}

impl<'a> Resolver<'a> {
    fn new(file: &File, library: &'a Library, sources: &'a Sources) -> Result<Self, ScenarioErrors> {
        let mut errors = Errors::default();
        let grid = grid(file, &mut errors);
        Ok(Self {
            grid: errors.finish(grid, sources)?,
            range: file
                .spectrum
                .range_nm
                .origin
                .or_override(file.spectrum.range_nm.iter().map(|end| end.origin)),
            library,
            sources,
            errors: Errors::default(),
            warnings: Vec::new(),
            notes: Vec::new(),
            inputs: BTreeMap::new(),
            needs_light: true,
            maps: Vec::new(),
            tables: Vec::new(),
            is_tabulated: false,
            unbounded: Vec::new(),
            surfaces: Vec::new(),
            known_faces: Vec::new(),
            reflects_nothing: false,
            needs_lengths: false,
        })
    }
}

fn grid(file: &File, errors: &mut Errors) -> Option<Grid> {
    let range = &file.spectrum.range_nm;
    let [first, last] = range.as_slice() else {
        errors.push(range.origin, mistake::another_length("a list of two wavelengths, first and last"));
        return None;
    };
    match Grid::new(first.0, last.0, file.spectrum.step_nm.0) {
        Ok(grid) if grid.stop_nm() > VISIBLE_NM.0 && grid.start_nm() < VISIBLE_NM.1 => Some(grid),
        Ok(grid) => {
            errors.push(range.origin, mistake::invisible((grid.start_nm(), grid.stop_nm())));
            None
        }
        Err(error) => {
            let step = file.spectrum.step_nm.origin;
            let at = if first.0 < last.0 { step.or_override([range.origin]) } else { range.origin };
            errors.push(at, error);
            None
        }
    }
}

/// Leaves the choice of the solver to the program where a liquid crystal, or a table with azimuths, is below a scatterer, and the file has not chosen:
/// of those that depend on azimuth, adding computes some.
fn choose_method(file: &File, scene: &mut Scene) {
    let solver = &file.solver;
    let is_chosen = ![solver.origin, Origin::FILE].contains(&solver.method.origin);
    let pixel = &scene.display.pixel;
    let may_turn = matches!(pixel, scene::Pixel::Crystal(_)) || pixel.is_azimuthal_table();
    if !is_chosen && may_turn && !scene.display.is_flat() {
        scene.solver.method = scene::Method::Auto;
    }
}

impl Resolver<'_> {
    fn scene(&mut self, file: &File) -> Option<Scene> {
        if self.grid.start_nm() > LUMINOUS_NM.0 || self.grid.stop_nm() < LUMINOUS_NM.1 {
            let (start, stop) = (self.grid.start_nm(), self.grid.stop_nm());
            self.warnings.push(format!(
                "colours are computed from {start} to {stop} nm only, not over the visible range"
            ));
        }
        // All parts are resolved before the first error ends the resolution, so that all errors are reported.
        let solver = self.solver(&file.solver);
        let display = self.display(file);
        let lighting = self.lighting(&file.lighting);
        let viewer = self.viewer(&file.viewer);
        self.check_slab_thickness(file);
        let (display, lighting, viewer, solver) = (display?, lighting?, viewer?, solver?);
        let metrics = self.metrics(file, &display);
        if lighting.port.is_some() && viewer.theta_deg.len() * viewer.phi_deg.len() != 1 {
            let wrong = Diagnostic::new("a meter at a sphere sees the sample from one direction");
            self.err(
                &file.lighting.port_mm,
                wrong
                    .expected("one view")
                    .hint("choose one")
                    .remedy(Remedy::key("viewer.theta_deg", "8"))
                    .remedy(Remedy::key("viewer.phi_deg", "0")),
            );
            return None;
        }
        let (grid, unresolved, within_step) = (self.grid, Vec::new(), None);
        let mut scene = Scene { grid, display, lighting, viewer, metrics, solver, unresolved, within_step };
        choose_method(file, &mut scene);
        self.check_panel(file, &scene);
        self.check_reach(file, &scene);
        self.note_unpolarised(&scene);
        self.check_medium(file, &scene);
        self.check_surface(file);
        self.check_size(file, &scene);
        self.note_no_reflection();
        self.note_scattering(&scene);
        if let Some(judge) = Judge::new(&scene) {
            let is_known = self.warn_of_tables(&judge);
            scene.within_step = self.within_step(file, &scene, is_known);
            scene.unresolved = self.warn_of_fringes(&scene, &judge);
        }
        self.warn_of_unbounded(&scene);
        self.check_target(file, &scene);
        Some(scene)
    }

    /// Resolves `[metrics]`. A specified reference state must be one of the display's.
    fn metrics(&mut self, file: &File, display: &scene::Display) -> scene::Metrics {
        let asked = &file.metrics;
        let mut metrics = scene::Metrics {
            observer: asked.observer.0,
            white: asked.white.0,
            spectra_by_light: asked.spectra_by_light.value,
            gamut_volume: asked.gamut_volume.value,
            reader_age_years: file.viewer.age_years.value.map(|years| years.0),
            text_height_mm: file.viewer.text_height_mm.value.map(|height| height.0),
            appearance: asked.appearance.value.as_ref().map(appearance),
            ..scene::Metrics::default()
        };
        if metrics.observer == scene::Standard::Cie1964 {
            self.notes.push(
                "metrics.observer = \"1964\": gamut areas against sRGB, EBU, NTSC and P3, and hue_rgb, are null, because the primaries of \
                 those standards are chromaticities of the 2 deg observer; the volume in CIELAB (metrics.gamut_volume) is available"
                    .to_owned(),
            );
        }
        let known = display.state_names();
        if metrics.white == scene::ReferenceWhite::Display && !known.iter().any(|name| name == "white") {
            let wrong = Diagnostic::new("metrics.white = \"display\", but this display has no state `white`");
            let wrong = wrong.expected("a display with a state `white`, to which L*, a* and b* are relative");
            let hint =
                format!("its states are {}; remove `white`, or name one of them `white`", known.join(", "));
            self.err(&asked.white, wrong.hint(hint));
        }
        let state = &asked.reference_state;
        if let Some(name) = &state.value {
            metrics.reference_state.clone_from(name);
            if !known.contains(name) {
                self.err(state, mistake::no_such_state(name, &known));
            }
        }
        metrics
    }

    /// Compares the spectra of the display with those at every nanometre, if any is a table. `is_known`: it has a warning.
    fn within_step(&self, file: &File, scene: &Scene, is_known: bool) -> Option<Arc<WithinStep>> {
        let every_nm =
            self.grid.integers().ok().filter(|_| self.is_tabulated && self.grid.step_nm() > 1.0)?;
        let mut finer = Resolver { grid: every_nm, ..Resolver::new(file, self.library, self.sources).ok()? };
        let display = finer.display(file).filter(|_| finer.errors.is_empty())?;
        WithinStep::new(scene, &display, is_known).map(Arc::new)
    }

    /// Checks that the state of a target is one of the display's.
    fn check_target(&mut self, file: &File, scene: &Scene) {
        let Some(state) = file.solver.target.value.as_ref().map(|target| &target.state) else { return };
        let known = scene.display.state_names();
        if let Some(name) = state.value.as_ref().filter(|name| !known.contains(name)) {
            self.err(state, mistake::no_such_state(name, &known));
        }
    }

    /// Notes a `scattering` without effect.
    fn note_scattering(&mut self, scene: &Scene) {
        let chosen =
            scene.solver.method != scene::Method::Adding && scene.solver.scattering != Strategy::Kernel;
        let lobe = scene.display.panel().is_some_and(|panel| panel.diffuser().is_some());
        if chosen && !lobe {
            self.notes.push(
                "solver.scattering has no effect: it is for a panel's diffuser given by its lobe; all scattering layers of \
                 this display sample directions from their own kernels"
                    .to_owned(),
            );
        }
    }

    /// Reports more items than are allowed.
    fn limit<T>(&mut self, at: &Spanned<T>, what: &'static str, count: usize, limit: usize) -> Option<()> {
        if count <= limit {
            return Some(());
        }
        self.err(at, mistake::too_many(what, count as f64, limit));
        None
    }

    /// Checks that the computation and its result fit into memory.
    fn check_size(&mut self, file: &File, scene: &Scene) {
        let bins = scene.grid.len();
        let (step, views_at) = (file.spectrum.step_nm.origin, file.viewer.theta_deg.origin);
        let (step, views_at) =
            (step.or_override([self.range]), views_at.or_override([file.viewer.phi_deg.origin]));
        let mut limit = |at, what, factors: &[usize], limit| {
            let count = factors.iter().fold(1, |product: usize, factor| product.saturating_mul(*factor));
            if count > limit {
                self.errors.push(at, mistake::too_many(what, count as f64, limit));
            }
        };
        if let scene::Pixel::Film(film) = &scene.display.pixel {
            limit(step, "film gaps x wavelengths", &[film::distinct_gaps(film).len(), bins], MOST_FILMS);
        }
        let films = scene.display.layers.iter().map(|layer| match &layer.interface {
            scene::Interface::Coating(coating) => coating.films.len(),
            _ => 0,
        });
        limit(step, "coating films x wavelengths", &[films.sum(), bins], MOST_FILMS);
        let bytes = papilio_display::expected_bytes(scene);
        if bytes > MOST_BYTES {
            let states = scene.display.state_names().len();
            let views = scene.viewer.theta_deg.len() * scene.viewer.phi_deg.len();
            let wrong = Diagnostic::new(format!(
                "{states} states x {bins} wavelengths in {views} views and the light of {} sources take about {:.1} GB of memory",
                scene.lighting.source_count(),
                1e-9 * bytes
            ));
            let hint = "use a larger spectrum.step_nm, or fewer views, states or sources; Monte Carlo takes more than adding";
            let most = format!("at most {:.0} GB", 1e-9 * MOST_BYTES);
            self.errors.push(views_at.or_override([step]), wrong.expected(most).hint(hint));
        }
    }

    fn err<T>(&mut self, at: &Spanned<T>, mistake: impl Into<Mistake>) {
        self.errors.push(at.origin, mistake);
    }

    /// Warns of a key that does not matter beside the others of its table.
    fn without_effect(&mut self, origin: Origin, key: &str, why: &str) {
        let path = self.sources.path(origin).filter(|path| path.ends_with(key));
        self.warnings.push(format!("{} has no effect: {why}", path.as_deref().unwrap_or(key)));
    }

    fn solver(&mut self, solver: &Solver) -> Option<scene::Solver> {
        let stop = self.stop(solver)?;
        let unrefracted = solver.approximation.value == solver::Approximation::Unrefracted;
        if unrefracted && solver.angle_medium.0 == scene::AngleMedium::Glass {
            let wrong = mistake::not_with("approximation = \"unrefracted\"", "angle_medium = \"glass\"");
            let at = solver.approximation.origin.or_override([solver.angle_medium.origin]);
            self.errors.push(
                at,
                wrong.hint("without refraction, the angles in glass are those in air: remove one of the two"),
            );
        }
        Some(scene::Solver {
            method: solver.method.0,
            stop,
            sampler: solver.sampler.0,
            scattering: solver.scattering.0,
            approximation: match solver.approximation.value {
                solver::Approximation::None | solver::Approximation::Unrefracted => {
                    scene::Approximation::None
                }
                solver::Approximation::SinglePass => scene::Approximation::SinglePass,
                solver::Approximation::Unpolarised => scene::Approximation::Unpolarised,
            },
            angle_medium: if unrefracted { scene::AngleMedium::Unrefracted } else { solver.angle_medium.0 },
            seed: solver.seed.0,
        })
    }

    fn target(&mut self, solver: &Solver, target: &solver::Target) -> Option<scene::Stop> {
        let at = solver.target.origin;
        for (key, given) in [
            ("relative_error", solver.relative_error.value.is_some()),
            ("paths", solver.paths.value.is_some()),
        ] {
            if given {
                self.notes.push(format!(
                    "solver.{key} has no effect together with solver.target, which defines when the Monte Carlo solver stops"
                ));
            }
        }
        let tolerance = match (target.error.value, target.relative_error.value) {
            (Some(error), None) => scene::Tolerance::Absolute(error.0),
            (None, Some(error)) => scene::Tolerance::Relative(error.0),
            (error, _) => {
                let given = if error.is_some() { 2 } else { 0 };
                self.errors.push(at, mistake::exactly_one("`error` and `relative_error`", given));
                return None;
            }
        };
        let metric = target.metric.0;
        if metric.is_of_view() && target.state.value.is_some() {
            let wrong = mistake::not_with("state", "a metric of all states together");
            self.errors.push(target.state.origin, wrong);
            return None;
        }
        Some(scene::Stop::Target(scene::Target { metric, state: target.state.value.clone(), tolerance }))
    }

    fn stop(&mut self, solver: &Solver) -> Option<scene::Stop> {
        if let Some(target) = &solver.target.value {
            if solver.method.0 != scene::Method::Adding {
                return self.target(solver, target);
            }
            self.notes.push(
                "solver.target has no effect: it is for the Monte Carlo solver, adding has no standard errors".to_owned(),
            );
        }
        match (solver.relative_error.value, solver.paths.value) {
            (Some(_), Some(_)) => {
                let at = solver.paths.origin.or_override([solver.relative_error.origin]);
                self.errors.push(at, mistake::exactly_one("`relative_error` and `paths`", 2));
                None
            }
            (None, Some(_)) if solver.method.0 == scene::Method::Adding => {
                let at = solver.paths.origin.or_override([solver.method.origin]);
                let wrong = mistake::not_with("paths", "method = \"adding\"");
                self.errors.push(at, wrong.hint("give `relative_error`, or method = \"monte-carlo\""));
                None
            }
            (None, Some(paths)) => {
                if solver.per_wavelength.value {
                    self.warnings.push(
                        "solver.per_wavelength has no effect together with solver.paths: it applies to solver.relative_error"
                            .to_owned(),
                    );
                }
                if paths.0 < FEWEST_PATHS {
                    self.notes.push(format!(
                        "solver.paths = {} is rounded up to {FEWEST_PATHS}, the minimum for standard errors",
                        paths.0
                    ));
                }
                Some(scene::Stop::Paths(paths.0))
            }
            (target, None) => Some(scene::Stop::RelativeError {
                target: target.map_or(0.001, |target| target.0),
                per_wavelength: solver.per_wavelength.value,
            }),
        }
    }
}

fn appearance(viewing: &metrics::Appearance) -> scene::Appearance {
    scene::Appearance {
        adapting_luminance_cd_m2: viewing.adapting_luminance_cd_m2.as_ref().map(|luminance| luminance.0),
        background: viewing.background.0,
        surround: viewing.surround.0,
    }
}
