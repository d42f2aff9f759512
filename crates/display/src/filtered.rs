//! Displays with a colour filter at a height above Lambertian pixels: what is seen of a period, through all
//! orders.
//!
//! The places at which light passes the filter are those of [`TwoPlanes`]; how much light there is comes from
//! the same panel without filter.
//!
//! **Wavelengths.** Places depend on the index of the glass and on what the front reflects. Where these depend
//! on the wavelength, they are computed at two or three values of each, in all pairs, between which light is
//! a polynomial; the coarse level has two.

use std::ops::Range;

use papilio_optics::interface::fresnel_reflectance;
use papilio_spectra::{Spectrum, StateSpectra};
use papilio_transport::adding::Kernel;
use papilio_transport::spatial::{
    Accuracy, Direction, Division, FilteredPixels, PanelSpread, Part, Passed, Rectangle, TwoPlanes, Window,
    air_below_front_mm, diffuse_directions, diffused_directions, diffused_directions_of_field,
};
use papilio_transport::{
    Base, Cone, Estimate, Field, Ledger, Medium, Panel, ReflectanceFactor, Reflector, Source, Top,
};

use crate::DisplayError;
use crate::run::Control;
use crate::scene::{Approximation, Filter, Matrix};
use crate::setup::{Setup, ViewPoint};
use crate::spatial::Refused;

/// A display with a filter.
pub(crate) struct Filtered<'a> {
    setup: &'a Setup,
    control: &'a Control<'a>,
    panel: &'a Panel,
    matrix: &'a Matrix,
    filter: &'a Filter,
    thickness_mm: f64,
    /// Air below the front, mm.
    gap_mm: f64,
    /// Reflectance of the pixel's states.
    rho: &'a StateSpectra,
}

/// The layers above the pixels at some of the wavelengths.
struct Optics {
    panel: Panel,
    index: f64,
    /// Reflectance of the front for light from below.
    front: f64,
    /// How much they count at each wavelength.
    weights: Vec<f64>,
}

/// Light of all sources at a level.
pub(crate) struct Lit {
    pub(crate) planes: TwoPlanes,
    /// Light that enters, by source.
    pub(crate) entering: Vec<Passed>,
    /// Number of pixels along x in a period.
    columns: usize,
    /// Light of a page of 1/2 without filter as a multiple of its light in the first order, by wavelength.
    orders: Vec<f64>,
    kernel: Kernel,
}

/// Digits and fineness of levels.
const DIGITS: [f64; 3] = [7.0, 9.0, 11.0];
/// Distance of lines in thicknesses, and the least and largest number of pixels between lines, at the first
/// level; twice as many at each further one.
const LINE_REACH: f64 = 6.0;
const LINE_PIXELS: [usize; 2] = [4, 12];
/// Graded cells of each window at the first level.
pub(crate) const CELLS: usize = 8;
/// Reflectance of the page that tells how much light there is.
const PAGE: f64 = 0.5;

/// Estimate of reflectance factors, the first of which is that in diffuse light: by reciprocity, it is what
/// returns of a beam from the view. What is absorbed where is not known.
pub(crate) fn by_reciprocity(rho: Vec<ReflectanceFactor>) -> Estimate {
    let returned = rho[0].total();
    let mut ledger = Ledger::zeros(returned.states(), rho[0].front.len());
    ledger.unaccounted = returned.map(|returned| 1.0 - returned);
    ledger.returned = returned;
    Estimate { rho, ledger }
}

impl Lit {
    /// Number of nodes: directions, for how much light there is, and cells of a period, for where it passes
    /// the filter.
    pub(crate) fn nodes(&self) -> u64 {
        (self.kernel.nodes() + self.planes.cells().count()) as u64
    }
}

impl<'a> Filtered<'a> {
    /// Prepares a display with a filter; `None` without filter.
    pub(crate) fn new(setup: &'a Setup, control: &'a Control<'a>) -> Result<Option<Self>, DisplayError> {
        let scene = &setup.scene;
        let Some(matrix) = &scene.display.matrix else { return Ok(None) };
        let Some(filter) = &matrix.filter else { return Ok(None) };
        setup.refracts()?;
        let Some(panel) = setup.stack.panel() else { return Err(Refused::FilterBelowLayers.into()) };
        let Reflector::Lambertian(rho) = &panel.base.reflector else {
            return Err(Refused::FilterAboveMirrors.into());
        };
        let (front, is_diffused) = (&panel.front.reflectance_below, matches!(panel.top, Top::Diffuser(_)));
        let refused = [
            (scene.display.pixel_spread().is_some(), Refused::SpreadBelowFilter),
            (front.max() > 0.0 && is_diffused, Refused::FilterBelowLobeAndFront),
            (scene.solver.approximation != Approximation::None, Refused::FilterInSinglePass),
        ];
        if let Some((_, refused)) = refused.into_iter().find(|(is_refused, _)| *is_refused) {
            return Err(refused.into());
        }
        setup.spreads_over_few_pixels()?;
        let thickness_mm = panel.gaps_mm.last().copied().unwrap_or_default();
        let gap_mm = air_below_front_mm(panel).map_err(Refused::Fronts)?;
        Ok(Some(Self { gap_mm, setup, control, panel, matrix, filter, thickness_mm, rho }))
    }

    /// The layers above the pixels at a level: one for each pair of values of index and front.
    fn optics(&self, level: usize) -> Vec<Optics> {
        let index = values(self.panel.medium.index(), level);
        let front = values(&self.panel.front.reflectance_below, level);
        let one = |(index, front): (&Value, &Value)| {
            let mut panel = self.panel.clone();
            let constant = panel.medium.index().map(|_| index.value);
            panel.front.reflectance_below = constant.map(|_| front.value);
            if let Top::Fresnel(face) = &mut panel.top {
                *face = constant.clone();
            }
            panel.medium = Medium::new(constant);
            let weights = index.weights.iter().zip(&front.weights).map(|(a, b)| a * b).collect();
            Optics { panel, index: index.value, front: front.value, weights }
        };
        index.iter().flat_map(|index| front.iter().map(move |front| (index, front))).map(one).collect()
    }

    /// Finest level: of patterns in two directions, fewer are affordable.
    pub(crate) fn finest(&self) -> usize {
        if self.is_of_stripes() { 2 } else { 1 }
    }

    /// True if a diffuser is above the filter.
    pub(crate) fn is_diffused(&self) -> bool {
        matches!(self.panel.top, Top::Diffuser(_))
    }

    /// True if all sub-pixels have the full height of the pixel.
    pub(crate) fn is_of_stripes(&self) -> bool {
        let spans = |one: &Rectangle| one.y == [0.0, 1.0];
        self.matrix.sub_pixels.iter().all(|one| one.window.rectangles.iter().all(spans))
    }

    /// Number of pixels in a period of which one is a line: light of the line returns to its own column,
    /// hardly to the next line.
    pub(crate) fn pixels_of_line(&self, level: usize) -> usize {
        let reach = LINE_REACH * f64::from(1_u32 << level) * self.thickness_mm / self.matrix.pitch_mm[0];
        (reach.ceil() as usize).clamp(LINE_PIXELS[0] << level, LINE_PIXELS[1] << level)
    }

    /// Computes the light at a level for a period of this number of pixels along x.
    pub(crate) fn lit(&self, level: usize, columns: usize) -> Result<Lit, DisplayError> {
        self.lit_with_cells(level, columns, &Division::everywhere(10 << level, CELLS << level))
    }

    /// The same with other cells of a period.
    pub(crate) fn lit_with_cells(
        &self,
        level: usize,
        columns: usize,
        division: &Division,
    ) -> Result<Lit, DisplayError> {
        let transmittance: Vec<Vec<f64>> = self.filter.transmittance.iter().map(|one| one.to_vec()).collect();
        let windows: Vec<Window> = (0..columns).flat_map(|column| self.windows(column, columns)).collect();
        let transmittance: Vec<Vec<f64>> = (0..columns).flat_map(|_| transmittance.clone()).collect();
        let optics = self.optics(level);
        let of_optics = |optics: &Optics| {
            let pixels = FilteredPixels {
                pitch_mm: [self.matrix.pitch_mm[0] * columns as f64, self.matrix.pitch_mm[1]],
                windows: &windows,
                transmittance: &transmittance,
                height_mm: self.filter.height_mm,
                thickness_mm: self.thickness_mm,
                index: optics.index,
            };
            let face = |beta: f64| optics.face(beta);
            let returns = !matches!(optics.panel.top, Top::Diffuser(_));
            let mut planes = TwoPlanes::with_cells(&pixels, returns.then_some(&face), level as u32, division);
            if optics.front > 0.0 {
                planes.add_front((self.thickness_mm, self.gap_mm), optics.front, &face, level as u32);
            }
            planes
        };
        let all: Vec<(TwoPlanes, &[f64])> =
            optics.iter().map(|optics| (of_optics(optics), &optics.weights[..])).collect();
        let entering = self.setup.sources.iter().map(|source| {
            let mut parts = Vec::with_capacity(optics.len());
            for (optics, (planes, weights)) in optics.iter().zip(&all) {
                parts.push((planes.entering(&self.arriving(optics, source, level)?), *weights));
            }
            Passed::sum_of(&parts).ok_or(DisplayError::NotFinite)
        });
        let entering = entering.collect::<Result<Vec<Passed>, DisplayError>>()?;
        let planes = TwoPlanes::sum_of(&all).ok_or(DisplayError::NotFinite)?;
        let bins = self.setup.scene.grid.len();
        let base = Base {
            reflector: Reflector::lambertian(vec![PAGE; bins], bins),
            inactive_absorptance: vec![0.0; bins].into(),
        };
        let stack = self.setup.stack.with_base(base);
        let mut kernel = Kernel::new(level as u32 + 2);
        let views: Vec<Cone> = self.setup.views.iter().map(|view| view.field).collect();
        if !kernel.prepare_unless(&stack, &views, &self.setup.sources, self.control.stop) {
            return Err(DisplayError::Interrupted);
        }
        let orders = planes.returned_uniform().iter().map(|returned| 1.0 / (1.0 - PAGE * returned)).collect();
        Ok(Lit { planes, entering, columns, orders, kernel })
    }

    /// Windows of a pixel in a period of several along x.
    fn windows(&self, column: usize, columns: usize) -> Vec<Window> {
        let wide =
            |one: &Rectangle| Rectangle { x: one.x.map(|x| (x + column as f64) / columns as f64), y: one.y };
        let window = |window: &Window| Window { rectangles: window.rectangles.iter().map(wide).collect() };
        self.matrix.sub_pixels.iter().map(|one| window(&one.window)).collect()
    }

    /// Number of sub-pixels of a pixel.
    pub(crate) fn sub_pixels(&self) -> usize {
        self.matrix.sub_pixels.len()
    }

    /// Reflectance below each window of a period whose pixels are in these states of the display.
    pub(crate) fn reflectance(&self, states: &[usize]) -> Vec<&'a [f64]> {
        let below = states.iter().flat_map(|state| &self.filter.states[*state].pixel_states);
        below.map(|state| self.rho.state(*state)).collect()
    }

    /// Irradiance of each cell in the light of a source, for a period whose pixels are in these states.
    pub(crate) fn irradiance(&self, lit: &Lit, source: usize, states: &[usize]) -> Vec<f64> {
        lit.planes.irradiance(&lit.entering[source], &self.reflectance(states))
    }

    /// Light that leaves each cell towards a view.
    pub(crate) fn leaving(&self, lit: &Lit, view: &ViewPoint, level: usize) -> Result<Passed, DisplayError> {
        let optics = self.optics(level);
        let mut parts = Vec::with_capacity(optics.len());
        for one in &optics {
            let leaving = self.seen(one, &view.field, level)?;
            parts.push((lit.planes.in_medium(one.index).leaving(&leaving), &one.weights[..]));
        }
        Passed::sum_of(&parts).ok_or(DisplayError::NotFinite)
    }

    /// What a view sees of all sources without the filter: light of the first order for a reflectance of 1,
    /// and that of faces.
    pub(crate) fn unfiltered(&self, lit: &Lit, view: usize) -> Vec<ReflectanceFactor> {
        let bins = self.setup.scene.grid.len();
        let base = Base {
            reflector: Reflector::lambertian(vec![PAGE; bins], bins),
            inactive_absorptance: vec![0.0; bins].into(),
        };
        let stack = self.setup.stack.with_base(base);
        let mut all = lit.kernel.seen(&stack, view);
        for factor in &mut all {
            let by_wavelength = factor.via_pixel.iter_mut().zip(&lit.orders);
            by_wavelength.for_each(|(light, orders)| *light /= PAGE * orders);
        }
        all
    }

    /// Estimate of a view for all states, from the irradiance of each source and state, `[source][state]`.
    pub(crate) fn estimate(
        &self,
        lit: &Lit,
        (number, leaving): (usize, &Passed),
        irradiance: &[Vec<Vec<f64>>],
    ) -> Estimate {
        let mut rho = self.unfiltered(lit, number);
        for (factor, irradiance) in rho.iter_mut().zip(irradiance) {
            let bins = self.setup.scene.grid.len();
            let first = std::mem::replace(&mut factor.via_pixel, StateSpectra::zeros(0, bins));
            for (state, irradiance) in irradiance.iter().enumerate() {
                let seen = self.mean(lit, leaving, irradiance, &self.reflectance(&vec![state; lit.columns]));
                factor.via_pixel.extend(seen.iter().zip(&first).map(|(seen, first)| seen * first));
            }
        }
        by_reciprocity(rho)
    }

    /// Mean over a period of what is seen, relative to a page of 1 without filter and further orders, for
    /// each wavelength.
    pub(crate) fn mean(
        &self,
        lit: &Lit,
        leaving: &Passed,
        irradiance: &[f64],
        reflectance: &[&[f64]],
    ) -> Vec<f64> {
        let windows = self.sub_pixels() * lit.columns;
        self.through(lit, leaving, irradiance, reflectance, 0..windows + 1)
    }

    /// The part of it that passes some of the windows of the filter; that after the last one is the area
    /// between them.
    pub(crate) fn through(
        &self,
        lit: &Lit,
        leaving: &Passed,
        irradiance: &[f64],
        reflectance: &[&[f64]],
        windows: Range<usize>,
    ) -> Vec<f64> {
        let all = 0..reflectance.len();
        let parts = windows.flat_map(|window| all.clone().map(move |sub_pixel| (window, sub_pixel)));
        let mut sum = vec![0.0; self.setup.scene.grid.len()];
        for part in parts {
            let light = self.part(lit, leaving, irradiance, reflectance, part);
            sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
        }
        sum
    }

    /// The part of it that left one sub-pixel and passes one window.
    pub(crate) fn part(
        &self,
        lit: &Lit,
        leaving: &Passed,
        irradiance: &[f64],
        reflectance: &[&[f64]],
        (window, sub_pixel): (usize, usize),
    ) -> Vec<f64> {
        let (cells, bins) = (lit.planes.cells(), self.setup.scene.grid.len());
        let mut sum = vec![0.0; bins];
        for cell in (0..cells.count()).filter(|cell| cells.window_of(*cell) == Some(sub_pixel)) {
            let light = leaving.by_window(cell, window).iter().zip(&irradiance[cell * bins..][..bins]);
            let rows = light.zip(reflectance[sub_pixel]);
            sum.iter_mut().zip(rows).for_each(|(sum, ((t, e), rho))| *sum += t * e * rho);
        }
        sum
    }

    /// Light of a source that reaches a sub-pixel for the first time through one window, for each wavelength.
    pub(crate) fn arriving_part(
        &self,
        lit: &Lit,
        source: usize,
        (window, sub_pixel): (usize, usize),
    ) -> Vec<f64> {
        let cells = lit.planes.cells();
        let mut sum = vec![0.0; self.setup.scene.grid.len()];
        for cell in (0..cells.count()).filter(|cell| cells.window_of(*cell) == Some(sub_pixel)) {
            let light = lit.entering[source].by_window(cell, window);
            sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
        }
        sum
    }

    /// Directions of the light of a source below the face or diffuser.
    fn arriving(
        &self,
        optics: &Optics,
        source: &Source,
        level: usize,
    ) -> Result<Vec<Direction>, DisplayError> {
        let Top::Diffuser(diffuser) = &optics.panel.top else {
            let diffuse = || diffuse_directions(level as u32, |beta| optics.passes(beta));
            let of_field = |field: &Field| {
                let own = |one: Direction| Direction { weight: one.weight * field.radiance(one.beta), ..one };
                diffuse().into_iter().map(own).collect()
            };
            return match source {
                Source::Diffuse => Ok(diffuse()),
                Source::Beam(beta) => Ok(vec![Direction { beta: *beta, weight: 1.0 }]),
                Source::Disc(cone) => self.mirrored(optics, cone, level),
                Source::Field(field) => Ok(of_field(field)),
            };
        };
        match source {
            Source::Diffuse => Ok(diffused_directions(diffuser, optics.index, level as u32)),
            Source::Beam(beta) => {
                let towards = -*beta;
                let theta_deg = towards.length().min(1.0).asin().to_degrees();
                let phi_deg = towards.y.atan2(towards.x).to_degrees();
                self.mirrored(optics, &Cone::new(theta_deg, phi_deg, 0.0, 1.0), level)
            }
            Source::Disc(cone) => self.mirrored(optics, cone, level),
            Source::Field(field) => {
                Ok(diffused_directions_of_field(diffuser, field, optics.index, level as u32))
            }
        }
    }

    /// Directions of light from a cone: those of a view into it, reversed.
    fn mirrored(&self, optics: &Optics, cone: &Cone, level: usize) -> Result<Vec<Direction>, DisplayError> {
        let seen = self.seen(optics, cone, level)?;
        Ok(seen.into_iter().map(|one| Direction { beta: -one.beta, ..one }).collect())
    }

    /// Directions in the medium that a view sees through the top.
    fn seen(&self, optics: &Optics, view: &Cone, level: usize) -> Result<Vec<Direction>, DisplayError> {
        let finest = self.matrix.pitch_mm[0].min(self.matrix.pitch_mm[1]);
        let accuracy = Accuracy { digits: DIGITS[level.min(2)], most_per_mm: 4.0 / finest };
        let panel = Panel { gaps_mm: vec![self.filter.height_mm], ..optics.panel.clone() };
        let spread = PanelSpread::by_direction(&panel, view, &Source::Diffuse, accuracy);
        let spread = spread.map_err(|error| DisplayError::PlacesNotComputed {
            what: error.to_string(),
            key: "display".to_owned(),
        })?;
        let of_part = |part: &Part| {
            let through = part.through.iter().copied().fold(0.0, f64::max);
            let mut all = Vec::new();
            part.each_sample(|one| all.push(Direction { beta: one.beta, weight: one.weight * through }));
            all
        };
        Ok(spread.parts().iter().flat_map(of_part).collect())
    }
}

impl Optics {
    /// Reflectance of the face for light from below, below the critical angle.
    fn face(&self, beta: f64) -> f64 {
        match self.panel.top {
            Top::Fresnel(_) => fresnel_reflectance(self.index, 1.0, beta),
            Top::IdealAr | Top::Diffuser(_) => 0.0,
        }
    }

    /// Fraction of diffuse light that passes face and front, relative to that of the front alone.
    fn passes(&self, beta: f64) -> f64 {
        let face = self.face(beta);
        (1.0 - face) / (1.0 - face * self.front)
    }
}

/// A value of a spectrum and its weight at each wavelength.
struct Value {
    value: f64,
    weights: Vec<f64>,
}

/// Values between which all of a spectrum lie, with the weights of polynomials of Lagrange.
fn values(spectrum: &Spectrum, level: usize) -> Vec<Value> {
    let least = spectrum.iter().copied().fold(f64::INFINITY, f64::min);
    let nodes = match (spectrum.is_constant(), level) {
        (true, _) => vec![least],
        (false, 0) => vec![least, spectrum.max()],
        (false, _) => vec![least, 0.5 * (least + spectrum.max()), spectrum.max()],
    };
    let weight = |k: usize, value: f64| -> f64 {
        let others = nodes.iter().enumerate().filter(|(other, _)| *other != k);
        others.map(|(_, other)| (value - other) / (nodes[k] - other)).product()
    };
    let of = |k: usize| Value {
        value: nodes[k],
        weights: spectrum.iter().map(|value| weight(k, *value)).collect(),
    };
    (0..nodes.len()).map(of).collect()
}
