//! Displays with a colour filter at a height above their pixels: what is seen of a period, through all orders.
//!
//! The places at which light passes the filter are those of [`TwoPlanes`]. Above mirror-like pixels, light keeps
//! its direction, and each direction of view has its own amount of light. Above Lambertian ones, how much light
//! there is comes from the same panel without filter.
//!
//! **Wavelengths.** Places depend on the index of the glass and on what the front reflects. Above Lambertian
//! pixels, where these depend on the wavelength, they are computed at two or three values of each, in all
//! pairs, between which light is a polynomial; the coarse level has two.

mod light;

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use papilio_optics::Beta;
use papilio_spectra::{Spectrum, StateSpectra};
use papilio_transport::adding::Kernel;
use papilio_transport::spatial::{
    Asked, Direction, Division, FilteredPixels, PanelSpread, Part, Passed, Rectangle, Shown, TwoPlanes,
    Window, air_below_front_mm,
};
use papilio_transport::{Cone, Estimate, Ledger, Panel, ReflectanceFactor, Reflector, Source, Stack, Top};

use self::light::{Optics, not_computed, white};
use crate::DisplayError;
use crate::polarisation::check_unpolarised;
use crate::run::Control;
use crate::scene::{Approximation, Filter, Matrix};
use crate::setup::Setup;
use crate::spatial::Refused;

/// A display with a filter.
pub(crate) struct Filtered<'a> {
    setup: &'a Setup,
    control: &'a Control<'a>,
    /// Layers above clear glass, over a white page.
    stack: Stack,
    panel: Panel,
    /// Mirror-like pixels for light of s and of p, if they are kept apart, or of all light.
    mirrors: Vec<Mirrors>,
    /// Internal transmittance of the glass.
    glass: Spectrum,
    matrix: &'a Matrix,
    filter: &'a Filter,
    /// Air below the front, mm.
    gap_mm: f64,
}

/// Mirror-like pixels, and the light that they reflect.
struct Mirrors {
    panel: Panel,
    sources: Vec<Source>,
}

/// A period of pixels at a level, in the light of all sources.
pub(crate) struct Period {
    level: usize,
    planes: TwoPlanes,
    /// Number of pixels along x.
    columns: usize,
    /// Light of a page without filter, of this reflectance, as a multiple of its light in the first order, by
    /// wavelength.
    page: f64,
    orders: Vec<f64>,
    kernel: Kernel,
    /// Light that enters, by sum and source.
    entering: Known<(Sum, usize), Passed>,
    /// Radiosity of each cell, by sum, source and states of the pixels.
    radiosity: Known<(Sum, usize, Vec<usize>), [f64]>,
}

/// Number of a sum over other directions below a diffuser, of several whose mean is the light; `None` for all directions, of light that
/// is not scattered.
pub(crate) type Sum = Option<usize>;

/// What has been computed, by what it depends on.
type Known<K, V> = RefCell<HashMap<K, Rc<V>>>;

/// What a view sees, by source.
pub(crate) struct Seen {
    /// Light of the requested states, as reflectance factors.
    pub(crate) shown: Vec<Shown>,
    /// Without filter: light of the first order for a Lambertian page of 1, and that of faces.
    pub(crate) unfiltered: Vec<ReflectanceFactor>,
}

/// Distance of lines in thicknesses, and the least and largest number of pixels between lines, at the first
/// level; twice as many at each further one.
const LINE_REACH: f64 = 6.0;
const LINE_PIXELS: [usize; 2] = [4, 12];
/// Graded cells of each window at the first level.
const CELLS: usize = 8;
/// How far beside a line cells are graded, in pixels: the windows next to it.
const BESIDE: f64 = 0.4;
/// Reflectance of the page that tells how much light there is; above mirrors that light is of the first order.
const PAGE: f64 = 0.5;
const DARK_PAGE: f64 = 1e-9;

/// Estimate of reflectance factors, the first of which is that in diffuse light: by reciprocity, it is what
/// returns of a beam from the view. What is absorbed where is not known.
pub(crate) fn by_reciprocity(rho: Vec<ReflectanceFactor>) -> Estimate {
    let returned = rho[0].total();
    let mut ledger = Ledger::zeros(returned.states(), rho[0].front.len());
    ledger.unaccounted = returned.map(|returned| 1.0 - returned);
    ledger.returned = returned;
    Estimate { rho, ledger }
}

/// True if all sub-pixels have the full height of the pixel.
fn is_of_stripes(matrix: &Matrix) -> bool {
    let spans = |one: &Rectangle| one.y == [0.0, 1.0];
    matrix.sub_pixels.iter().all(|one| one.window.rectangles.iter().all(spans))
}

impl Period {
    /// Number of nodes: directions, for how much light there is, and cells of a period, for where it passes
    /// the filter.
    pub(crate) fn nodes(&self) -> u64 {
        (self.kernel.nodes() + self.planes.cells().count()) as u64
    }

    /// Number of pixels along x.
    pub(crate) fn columns(&self) -> usize {
        self.columns
    }
}

impl<'a> Filtered<'a> {
    /// Prepares a display with a filter; `None` without filter.
    pub(crate) fn new(setup: &'a Setup, control: &'a Control<'a>) -> Result<Option<Self>, DisplayError> {
        let scene = &setup.scene;
        let Some(matrix) = &scene.display.matrix else { return Ok(None) };
        let Some(filter) = &matrix.filter else { return Ok(None) };
        setup.refracts()?;
        let cleared = |stack: &Stack| match stack.above_clear_glass() {
            Some((stack, transmittance)) => (stack, transmittance.clone()),
            None => (stack.clone(), Spectrum::constant(&scene.grid, 1.0)),
        };
        let (stack, glass) = cleared(&setup.stack);
        let Some(mut panel) = stack.panel_by_direction() else {
            return Err(Refused::FilterBelowLayers.into());
        };
        let of_each = |(number, one): (usize, &Stack)| {
            let sources = setup.stack.sources_of(number, &setup.sources).into_owned();
            Some(Mirrors { panel: cleared(one).0.panel_by_direction()?, sources })
        };
        let both = setup.stack.polarised().into_iter().flatten();
        let mut mirrors: Vec<Mirrors> = both.enumerate().filter_map(of_each).collect();
        if !mirrors.is_empty() {
            panel.keeps_s_and_p = matches!(panel.top, Top::Fresnel(_));
        }
        if setup.stack.follows_changes() {
            // Above glass that absorbs, too.
            panel.mueller = setup.stack.mueller().cloned();
            panel.keeps_s_and_p = matches!(panel.top, Top::Fresnel(_));
        }
        // What is known of its layers over a white page, above a pixel that depends on azimuth, too.
        let page = white(scene.grid.len(), 1.0);
        let stack = match panel.base.is_specular() {
            true if panel.keeps_s_and_p => Stack::new(stack.layers().to_vec(), page).keeping_s_and_p(),
            true => Stack::new(stack.layers().to_vec(), page),
            false => stack.with_base(page),
        };
        let (front, is_diffused) = (&panel.front.reflectance_below, matches!(panel.top, Top::Diffuser(_)));
        let refused = [
            (scene.display.pixel_spread().is_some() && !is_of_stripes(matrix), Refused::SpreadBelowFilter),
            (front.max() > 0.0 && is_diffused, Refused::FilterBelowLobeAndFront),
            (scene.solver.approximation == Approximation::SinglePass, Refused::FilterInSinglePass),
        ];
        if let Some((_, refused)) = refused.into_iter().find(|(is_refused, _)| *is_refused) {
            return Err(refused.into());
        }
        setup.placed_by_direction()?;
        setup.is_over_few_pixels()?;
        let gap_mm = air_below_front_mm(&panel).map_err(Refused::Fronts)?;
        if mirrors.is_empty() {
            mirrors.push(Mirrors { panel: panel.clone(), sources: setup.sources.clone() });
        }
        Ok(Some(Self { setup, control, stack, panel, mirrors, glass, matrix, filter, gap_mm }))
    }

    /// Finest level of pages: of Lambertian pixels in patterns in two directions, fewer are affordable.
    pub(crate) fn finest(&self) -> usize {
        match is_of_stripes(self.matrix) || self.is_mirror() {
            true => 2,
            false => 1,
        }
    }

    fn is_mirror(&self) -> bool {
        self.panel.base.is_specular()
    }

    /// True if a diffuser is above the filter.
    pub(crate) fn is_diffused(&self) -> bool {
        matches!(self.panel.top, Top::Diffuser(_))
    }

    /// Sums whose mean the light is. Areas of windows have kinks at the places that directions show: below a diffuser, the scatter of
    /// sums over other directions tells the error that they cause.
    pub(crate) fn sums(&self) -> Vec<Sum> {
        if self.is_diffused() { (0..Part::SUMS).map(Some).collect() } else { vec![None] }
    }

    /// True if lines are computed: above Lambertian pixels, in patterns in two directions, they have too many
    /// cells.
    pub(crate) fn has_lines(&self) -> bool {
        is_of_stripes(self.matrix) || self.is_mirror()
    }

    fn thickness_mm(&self) -> f64 {
        self.panel.gaps_mm.last().copied().unwrap_or_default()
    }

    /// A period of this number of pixels along x.
    pub(crate) fn period(&self, level: usize, columns: usize) -> Result<Period, DisplayError> {
        self.period_with_cells(level, columns, &Division::everywhere(10 << level, CELLS << level))
    }

    /// A period of so many pixels that one of them is a line: its light returns to its own column, hardly to the
    /// next line.
    pub(crate) fn line(&self, level: usize) -> Result<Period, DisplayError> {
        let reach = LINE_REACH * f64::from(1_u32 << level) * self.thickness_mm() / self.matrix.pitch_mm[0];
        let pixels = (reach.ceil() as usize).clamp(LINE_PIXELS[0] << level, LINE_PIXELS[1] << level);
        // The line is seen through its own windows: light changes most near the edges of the line.
        let width = 1.0 / pixels as f64;
        let division = Division {
            per_period: (self.sub_pixels() * pixels) << level,
            per_window: CELLS << level,
            near: [-BESIDE * width, (1.0 + BESIDE) * width],
        };
        self.period_with_cells(level, pixels, &division)
    }

    fn period_with_cells(
        &self,
        level: usize,
        columns: usize,
        division: &Division,
    ) -> Result<Period, DisplayError> {
        // Light crosses all of the glass with each pass of the filter.
        let with_glass = |part: &Spectrum| part.zip_map(&self.glass, |part, glass| part * glass).to_vec();
        let transmittance: Vec<Vec<f64>> = self.filter.transmittance.iter().map(with_glass).collect();
        let windows: Vec<Window> = (0..columns).flat_map(|column| self.windows(column, columns)).collect();
        let transmittance: Vec<Vec<f64>> = (0..columns).flat_map(|_| transmittance.clone()).collect();
        // Below mirrors light is constant within windows.
        let whole = Division::everywhere(1, 0);
        let division = if self.is_mirror() { &whole } else { division };
        let returns = !self.is_mirror() && !self.is_diffused();
        let of_optics = |optics: &Optics| {
            let pixels = FilteredPixels {
                pitch_mm: [self.matrix.pitch_mm[0] * columns as f64, self.matrix.pitch_mm[1]],
                columns,
                windows: &windows,
                transmittance: &transmittance,
                between: &self.glass,
                height_mm: self.filter.height_mm,
                thickness_mm: self.thickness_mm(),
                index: optics.index,
                spread: self.setup.scene.display.pixel_spread(),
            };
            let face = |beta: f64| optics.face(beta);
            let mut planes = TwoPlanes::with_cells(&pixels, returns.then_some(&face), level as u32, division);
            if returns && optics.front > 0.0 {
                let faces = |beta: f64| optics.faces(beta);
                planes.add_front((self.thickness_mm(), self.gap_mm), optics.front, &faces, level as u32);
            }
            planes
        };
        let optics = self.optics(level);
        let all: Vec<(TwoPlanes, &[f64])> =
            optics.iter().map(|optics| (of_optics(optics), &optics.weights[..])).collect();
        let planes = TwoPlanes::sum_of(&all).ok_or(DisplayError::NotFinite)?;
        let page = if self.is_mirror() { DARK_PAGE } else { PAGE };
        let stack = self.stack.with_base(white(self.setup.scene.grid.len(), page));
        let mut kernel = Kernel::new(level as u32 + 2);
        let views: Vec<Cone> = self.setup.views.iter().map(|view| view.field).collect();
        if !kernel.prepare_unless(&stack, &views, &self.setup.sources, self.control.stop) {
            return Err(DisplayError::Interrupted);
        }
        let orders = planes.returned_uniform().iter().map(|returned| 1.0 / (1.0 - page * returned)).collect();
        let (entering, radiosity) = Default::default();
        Ok(Period { level, planes, columns, page, orders, kernel, entering, radiosity })
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

    /// States of the pixel below each window of a period whose pixels are in these states of the display.
    fn below(&self, states: &[usize]) -> Vec<usize> {
        states.iter().flat_map(|state| &self.filter.states[*state].pixel_states).copied().collect()
    }

    /// Windows of the first pixel of a period, and the area between them.
    pub(crate) fn of_first_pixel(&self, period: &Period) -> Vec<usize> {
        let count = self.sub_pixels();
        (0..count).chain([count * period.columns]).collect()
    }

    /// What a view sees in a sum of a period whose pixels are in these states of the display, `[period][pixel]`, through
    /// some of the windows; those after the last one are the areas between them.
    pub(crate) fn seen(
        &self,
        (period, sum): (&Period, Sum),
        number: usize,
        states: &[Vec<usize>],
        windows: Vec<usize>,
    ) -> Result<Seen, DisplayError> {
        let states: Vec<Vec<usize>> = states.iter().map(|states| self.below(states)).collect();
        let asked = Asked { states: &states, windows };
        let unfiltered = self.unfiltered(period, number)?;
        let sources = 0..self.setup.sources.len();
        let shown = match &self.panel.base.reflector {
            Reflector::Lambertian(rho) => {
                let leaving = self.leaving_period((period, sum), number)?;
                let of_source = |source: usize| {
                    self.control.check()?;
                    let radiosity =
                        states.iter().map(|states| self.radiosity((period, sum), source, states, rho));
                    let radiosity = radiosity.collect::<Result<Vec<_>, _>>()?;
                    let shown = period.planes.shown(&leaving, &radiosity, &asked);
                    Ok(shown.times(&unfiltered[source].via_pixel))
                };
                sources.map(of_source).collect::<Result<_, DisplayError>>()?
            }
            _ => {
                let of_source = |source: usize| {
                    self.control.check()?;
                    let view = &self.setup.views[number].field;
                    self.of_mirrors((period, sum), &asked, (source, Some(view)), |panel, source| {
                        self.mirrored_spread(panel, view, source, period.level)
                    })
                };
                sources.map(of_source).collect::<Result<_, DisplayError>>()?
            }
        };
        Ok(Seen { shown, unfiltered })
    }

    /// Estimate of a view for all states in a sum, in a period of one pixel.
    pub(crate) fn estimate(
        &self,
        (period, sum): (&Period, Sum),
        number: usize,
    ) -> Result<Estimate, DisplayError> {
        let states: Vec<Vec<usize>> =
            (0..self.setup.states.len()).map(|state| vec![state; period.columns]).collect();
        let windows = self.of_first_pixel(period);
        let Seen { shown, unfiltered } = self.seen((period, sum), number, &states, windows)?;
        let factor = |(shown, unfiltered): (Shown, ReflectanceFactor)| {
            let via_pixel = (0..states.len()).flat_map(|state| shown.all(state)).collect();
            ReflectanceFactor {
                via_pixel: StateSpectra::new(via_pixel, unfiltered.front.len()),
                ..unfiltered
            }
        };
        Ok(by_reciprocity(shown.into_iter().zip(unfiltered).map(factor).collect()))
    }

    /// Mirror image of the beam of a source in the pixels, its light along `beta`, by state of the display; 0 of Lambertian
    /// ones.
    pub(crate) fn image(&self, source: usize, beta: Beta) -> Result<StateSpectra, DisplayError> {
        let (states, bins) = (self.setup.states.len(), self.setup.scene.grid.len());
        if !self.is_mirror() {
            return Ok(StateSpectra::zeros(states, bins));
        }
        let level = self.finest();
        let period = self.period(level, 1)?;
        let below: Vec<Vec<usize>> = (0..states).map(|state| self.below(&[state])).collect();
        let asked = Asked { states: &below, windows: self.of_first_pixel(&period) };
        let shown = self.of_mirrors((&period, None), &asked, (source, None), |panel, _| {
            PanelSpread::image(panel, beta).map_err(not_computed)
        })?;
        Ok(StateSpectra::new((0..states).flat_map(|state| shown.all(state)).collect(), bins))
    }

    /// What a view sees of mirror-like pixels in the light of a source in a sum, or its mirror image there, given this light by direction.
    fn of_mirrors(
        &self,
        (period, sum): (&Period, Sum),
        asked: &Asked<'_>,
        (source, view): (usize, Option<&Cone>),
        spread: impl Fn(&Panel, &Source) -> Result<PanelSpread, DisplayError>,
    ) -> Result<Shown, DisplayError> {
        let (stack, all) = (&self.setup.stack, &self.setup.sources);
        let weights = match self.mirrors.len() {
            1 => [1.0; 2],
            _ => stack.weights_by_source(view, all)[source],
        };
        let of_panel = |(number, (Mirrors { panel, sources }, weight)): (usize, (&Mirrors, f64))| {
            let of_ray = |beta| stack.weights_of_ray(view, (source, &all[source]), beta);
            let weight_of_ray = |beta| of_ray(beta).map_or(1.0, |weights| weights[number]);
            let spread = spread(panel, &sources[source])?.times(weight_of_ray);
            let shown = period.planes.mirrored(panel, (&spread, sum), asked, period.level as u32);
            Ok((shown.map_err(not_computed)?, weight))
        };
        let parts = self
            .mirrors
            .iter()
            .zip(weights)
            .enumerate()
            .map(of_panel)
            .collect::<Result<Vec<_>, DisplayError>>()?;
        Shown::sum_of(parts).ok_or(DisplayError::NotFinite)
    }

    /// Radiosity of each cell in the light of a source, given the states of the pixel below each window.
    fn radiosity(
        &self,
        (period, sum): (&Period, Sum),
        source: usize,
        states: &[usize],
        rho: &StateSpectra,
    ) -> Result<Rc<[f64]>, DisplayError> {
        let key = (sum, source, states.to_vec());
        if let Some(known) = period.radiosity.borrow().get(&key) {
            return Ok(known.clone());
        }
        let rho: Vec<&[f64]> = states.iter().map(|state| rho.state(*state)).collect();
        let irradiance = period.planes.irradiance(&*self.entering((period, sum), source)?, &rho);
        let found: Rc<[f64]> = period.planes.radiosity(&irradiance, &rho).into();
        period.radiosity.borrow_mut().insert(key, found.clone());
        Ok(found)
    }

    /// Light of a source that enters.
    fn entering(&self, (period, sum): (&Period, Sum), source: usize) -> Result<Rc<Passed>, DisplayError> {
        if let Some(known) = period.entering.borrow().get(&(sum, source)) {
            return Ok(known.clone());
        }
        let from = &self.setup.sources[source];
        let directions = |optics: &Optics| self.arriving(optics, from, (period.level, sum));
        let found = Rc::new(self.passed(period, directions, TwoPlanes::entering)?);
        period.entering.borrow_mut().insert((sum, source), found.clone());
        Ok(found)
    }

    /// Light that leaves each cell towards a view.
    fn leaving_period(&self, (period, sum): (&Period, Sum), number: usize) -> Result<Passed, DisplayError> {
        let view = &self.setup.views[number].field;
        let directions = |optics: &Optics| self.leaving(optics, view, (period.level, sum));
        self.passed(period, directions, TwoPlanes::leaving)
    }

    fn passed(
        &self,
        period: &Period,
        directions: impl Fn(&Optics) -> Result<Vec<Direction>, DisplayError>,
        pass: impl Fn(&TwoPlanes, &[Direction]) -> Passed,
    ) -> Result<Passed, DisplayError> {
        let optics = self.optics(period.level);
        let of_optics = |one: &Optics| Ok(pass(&period.planes.in_medium(one.index), &directions(one)?));
        let parts = optics.iter().map(of_optics).collect::<Result<Vec<Passed>, DisplayError>>()?;
        let parts: Vec<(Passed, &[f64])> =
            parts.into_iter().zip(&optics).map(|(part, optics)| (part, &optics.weights[..])).collect();
        Passed::sum_of(&parts).ok_or(DisplayError::NotFinite)
    }

    /// What a view sees of all sources without the filter: light of the first order for a reflectance of 1,
    /// and that of faces.
    fn unfiltered(&self, period: &Period, view: usize) -> Result<Vec<ReflectanceFactor>, DisplayError> {
        let stack = self.stack.with_base(white(self.setup.scene.grid.len(), period.page));
        let mut all = period.kernel.seen(&stack, view);
        for factor in &mut all {
            let by_wavelength = factor.via_pixel.iter_mut().zip(&period.orders);
            by_wavelength.for_each(|(light, orders)| *light /= period.page * orders);
        }
        if check_unpolarised(&self.setup.scene).is_err() {
            let seen = self.setup.seen(&self.setup.views[view], period.level as u32 + 2, self.control)?;
            all.iter_mut().zip(seen).for_each(|(one, seen)| one.front = seen.front);
        }
        Ok(all)
    }

    /// Light of a source that reaches each sub-pixel for the first time through each window, for each
    /// wavelength, `[window][sub-pixel]`.
    pub(crate) fn arriving_parts(
        &self,
        (period, sum): (&Period, Sum),
        source: usize,
    ) -> Result<Vec<Vec<Vec<f64>>>, DisplayError> {
        let (cells, entering) = (period.planes.cells(), self.entering((period, sum), source)?);
        let count = self.sub_pixels() * period.columns;
        let mut sums = vec![vec![vec![0.0; self.setup.scene.grid.len()]; count]; count + period.columns];
        for cell in 0..cells.count() {
            let Some(own) = cells.window_of(cell) else { continue };
            for (window, sums) in sums.iter_mut().enumerate() {
                let light = entering.by_window(cell, window);
                sums[own].iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
            }
        }
        Ok(sums)
    }
}
