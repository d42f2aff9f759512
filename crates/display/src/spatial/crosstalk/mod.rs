//! `papilio crosstalk`: which sub-pixel lights which, and the colours and contrast of fine figures.
//!
//! By adding every number is computed at two levels of discretisation; the finer one is the result, the
//! difference its error. By Monte Carlo (`paths`) errors are standard errors.

mod filter;
mod flat;
mod found;
mod orders;
mod paths;
mod places;
mod result;
mod shares;
mod surfaces;

use papilio_imaging::text::Bitmap;
use papilio_transport::spatial::{Accuracy, PanelSpread};
use papilio_transport::{Panel, Reflector, Source, Top, adding};

use self::flat::{Irradiance, Pixels};
use self::found::{Measured, assembled};
use self::orders::{Back, Orders};
use self::places::{Gathered, NEIGHBOURS, Wanted, Windows, cell, gather};
pub use self::result::{CrosstalkResult, CrosstalkView, Figure, PatternColours, PatternValues, Shares};
use self::surfaces::{Part, Surfaces};
use super::below_layers::{self, Layers};
use super::irradiance::Above;
use super::patterns::Text;
use super::response::{Lit, name_of_light};
use super::returned::Returned;
use super::target::{self, missed_target};
use super::{Level, PatternKind, Refused, lobe, patterns};
use crate::DisplayError;
use crate::filtered::Filtered;
use crate::meter::Meter;
use crate::run::{self, Control, each_view};
use crate::scene::{Matrix, Method, SPREAD_KEY, Scene};
use crate::setup::{Setup, ViewPoint};

/// X, Y and Z relative to a perfect white.
type Colour = [f64; 3];

/// Natural digits of the first level and how many more each further one has, the highest order of the
/// sub-pixels' pattern that the first level resolves (each further one twice as many), and the finest level.
const DIGITS: f64 = 8.0;
const MORE_DIGITS: f64 = 3.0;
const ORDERS: f64 = 2.0;
const MOST_LEVEL: usize = 3;

/// Numbers whose errors are not relative.
const SHARES: &str = "shares";

/// State of pages, and that of figures whose contrast is measured.
const PAGE: &str = "white";
const BLACK: &str = "black";

/// Computes who lights whom in each view, and the colours of figures on a page. Text is `text`.
///
/// # Errors
/// If the scene is invalid, has no matrix, a length is missing, its kind of display or light is not covered,
/// or the computation was stopped.
pub fn crosstalk(scene: &Scene, text: &str, control: &Control<'_>) -> Result<CrosstalkResult, DisplayError> {
    let setup = Setup::with_filter(scene, control)?;
    if scene.display.filter().is_some() && scene.display.pixel_spread().is_some() {
        return Err(DisplayError::PlacesNotComputed {
            what: "which part of a colour filter lights which, above pixels inside which light spreads"
                .to_owned(),
            key: SPREAD_KEY.to_owned(),
        });
    }
    if scene.solver.method == Method::MonteCarlo {
        let matrix = matrix(&setup)?;
        return result(&setup, matrix, paths::views(&setup, matrix, text, control)?);
    }
    if let Some(filtered) = Filtered::new(&setup, control)? {
        let matrix = matrix(&setup)?;
        return result(&setup, matrix, filter::views(&filtered, &setup, control)?);
    }
    let frame = Frame::new(&setup, text, control)?;
    let views =
        each_view(&setup, false, control, |number, control| frame.view(&setup.views[number], control))?;
    result(&setup, frame.matrix, views)
}

fn matrix(setup: &Setup) -> Result<&Matrix, DisplayError> {
    let missing = DisplayError::NoMatrix { command: "crosstalk" };
    setup.scene.display.matrix.as_ref().ok_or(missing)
}

/// State of the page: white, or the first one.
fn page(setup: &Setup) -> usize {
    state(setup, PAGE).unwrap_or(0)
}

fn state(setup: &Setup, name: &str) -> Option<usize> {
    setup.states.iter().position(|state| state == name)
}

fn result(
    setup: &Setup,
    matrix: &Matrix,
    views: Vec<CrosstalkView>,
) -> Result<CrosstalkResult, DisplayError> {
    let error_reached = views.iter().map(|view| view.shares.error).fold(0.0, f64::max);
    if !error_reached.is_finite() {
        return Err(DisplayError::NotFinite);
    }
    Ok(CrosstalkResult {
        subpixels: matrix.sub_pixels.iter().map(|one| one.name.clone()).collect(),
        pitch_um: matrix.pitch_mm.map(|pitch| 1e3 * pitch),
        page: setup.states.get(page(setup)).cloned().unwrap_or_default(),
        error_reached,
        warnings: missed(setup, &views).into_iter().collect(),
        views,
    })
}

/// Refines a view. `factor`: error of a level over its difference from the one before.
fn refined(
    setup: &Setup,
    view: &ViewPoint,
    (finest, factor): (usize, f64),
    at: impl FnMut(usize) -> Result<Measured, DisplayError>,
    control: &Control<'_>,
) -> Result<CrosstalkView, DisplayError> {
    let of = |[fine, coarse]: [&Measured; 2]| match factor {
        1.0 => assembled(setup, view, fine, &[coarse]),
        factor => assembled(setup, view, fine, &[&coarse.away(fine, factor)]),
    };
    let found = target::refined(setup, finest, at, |levels| largest_error(&of(levels)).1, control)?;
    Ok(of([&found.finer, &found.coarser]))
}

/// Returns the number with the largest error, and this error: of the shares, or a relative one of a contrast
/// ratio.
fn largest_error(view: &CrosstalkView) -> (&'static str, f64) {
    let of_pattern = |pattern: &PatternColours| {
        Some((pattern.name.name(), pattern.error.contrast_ratio? / pattern.values.contrast_ratio?))
    };
    let all = view.patterns.iter().filter_map(of_pattern);
    all.fold((SHARES, view.shares.error), |most, one| if one.1 > most.1 { one } else { most })
}

/// Warning of errors above the target of the scene.
fn missed(setup: &Setup, views: &[CrosstalkView]) -> Option<String> {
    let (what, most) = views.iter().map(largest_error).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let what = if what == SHARES { "the shares".to_owned() } else { format!("the contrast ratio of {what}") };
    missed_target(&setup.scene, most, &what)
}

/// What all views have in common.
struct Frame<'a> {
    setup: &'a Setup,
    control: &'a Control<'a>,
    matrix: &'a Matrix,
    /// `None` below general layers.
    panel: Option<&'a Panel>,
    lengths_mm: Vec<f64>,
    surfaces: Surfaces,
    windows: Windows,
    /// Parts of all states.
    parts: Vec<Part>,
    /// State of the page.
    page: usize,
    text: Option<Bitmap>,
}

impl<'a> Frame<'a> {
    fn new(setup: &'a Setup, text: &str, control: &'a Control<'a>) -> Result<Self, DisplayError> {
        let scene = &setup.scene;
        let matrix = matrix(setup)?;
        setup.refracts()?;
        let lengths_mm = scene.display.lengths_mm()?;
        scene.display.spreads_over_few_pixels(&lengths_mm)?;
        let panel = setup.stack.panel();
        if panel.is_none() && !below_layers::covers(setup) {
            return Err(Refused::Layers.into());
        }
        let surfaces = Surfaces::new(setup, matrix)?;
        if let Some(panel) = panel {
            if scene.display.pixel_spread().is_some() && matches!(panel.top, Top::Diffuser(_)) {
                return Err(Refused::SpreadBelowLobe.into());
            }
            let is_flat = !matches!(panel.top, Top::Diffuser(_)) && panel.base.is_specular();
            let returns = panel.front.reflectance_below.max() > 0.0 || matches!(panel.top, Top::Fresnel(_));
            if is_flat && returns && surfaces.states.iter().any(|parts| parts.len() > 1) {
                return Err(Refused::SubPixelsBelowFaces.into());
            }
        }
        let mut parts: Vec<Part> = Vec::new();
        for part in surfaces.states.iter().flatten() {
            if !parts.iter().any(|known| known.at() == part.at()) {
                parts.push(*part);
            }
        }
        Ok(Self {
            text: patterns::bitmap(scene, text, matrix.pitch_mm),
            windows: Windows::new(matrix),
            setup,
            control,
            matrix,
            panel,
            lengths_mm,
            surfaces,
            parts,
            page: page(setup),
        })
    }

    fn view(&self, view: &ViewPoint, control: &Control<'_>) -> Result<CrosstalkView, DisplayError> {
        let pitch = self.matrix.pitch_mm;
        let finest = pitch[0].min(pitch[1]);
        let at = |level: usize| {
            let digits = match self.panel {
                Some(_) => DIGITS + MORE_DIGITS * level as f64,
                None => Level::digits_of_layers(level),
            };
            let most_per_mm = ORDERS * f64::from(1_u32 << level) / finest;
            let finer = level.saturating_sub(1) as u32;
            self.measure(view, Level { digits, most_per_mm, is_fine: level > 0, finer })
        };
        let (finest, factor) = match self.panel {
            // The estimate for mirror-like pixels is bounded by the coarse level only: no further level is
            // computed.
            Some(panel) if returns(panel) && !is_flat(panel) && panel.base.is_specular() => (1, 1.0),
            Some(_) => (MOST_LEVEL, 1.0),
            None => {
                let factor = adding::error_over_difference(&self.setup.stack, &self.setup.sources);
                (run::finest(self.setup)?.min(MOST_LEVEL), factor)
            }
        };
        refined(self.setup, view, (finest, factor), at, control)
    }

    fn measure(&self, view: &ViewPoint, level: Level) -> Result<Measured, DisplayError> {
        let (setup, meter) = (self.setup, Meter::new(self.setup));
        let layers = match self.panel {
            Some(_) => None,
            None => Some(Layers::new(setup, view, level, self.control)?),
        };
        let above = match (self.panel, &layers) {
            (Some(panel), _) => Above::Panel(self.lit(panel, view, level)),
            (None, Some(layers)) => Above::Layers(layers),
            (None, None) => return Err(Refused::Layers.into()),
        };
        let of_pages = if self.panel.is_some() { level.of_pages() } else { level.of_layers() };
        let factors = setup.seen(view, of_pages, self.control)?;
        let (states, bins) = (setup.states.len(), setup.scene.grid.len());
        let mut measured = Measured::default();
        let (mut pages, mut orders) = (vec![[0.0; 3]; states], None::<Orders>);
        // Below a lobe light is followed by direction.
        let below_lobe = match above {
            Above::Panel(lit) if !is_flat(lit.panel) => Some(lit),
            Above::Panel(_) | Above::Layers(_) => None,
        };
        let images = if below_lobe.is_none() { above.images()? } else { Vec::new() };
        // Light of each state and wavelength in X, Y and Z.
        let mut by_wavelength = [0, 1, 2].map(|_| vec![0.0; states * bins]);
        measured.from_faces = meter.without_pixel(&factors);
        for light in meter.pixel_lights().iter().filter(|light| light.is_seen()) {
            let (weights, factor) = (&light.weights, &factors[light.source]);
            measured.names.push(name_of_light(setup, light));
            for (state, page) in pages.iter_mut().enumerate() {
                add(page, flat::colour(weights, factor.via_pixel.state(state)));
            }
            for (sum, weights) in by_wavelength.iter_mut().zip(weights) {
                let light = factor.via_pixel.iter().enumerate().map(|(at, light)| weights[at % bins] * light);
                sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
            }
            let Some(lit) = below_lobe else {
                let page = factor.via_pixel.state(self.page);
                let mut rows =
                    vec![vec![0.0; self.matrix.sub_pixels.len() + 1]; self.matrix.sub_pixels.len()];
                for (at_mm, fraction) in &images {
                    let light =
                        page.iter().zip(fraction).zip(&weights[1]).map(|((light, f), w)| light * f * w);
                    self.add_image(*at_mm, light.sum(), &mut rows);
                }
                if images.is_empty() {
                    // Pixels that are not divided show their own kind.
                    self.add_image([0.0; 2], flat::colour(weights, page)[1], &mut rows);
                }
                measured.page.push(rows);
                continue;
            };
            let source = &setup.sources[light.source];
            let mut more = self.orders(lit, source, weights)?;
            if lit.returns() {
                if level.is_fine && lit.panel.base.is_specular() {
                    more.own = self.own_light(lit, source, &weights[1], &factor.via_pixel)?;
                }
                let all = flat::colour(weights, factor.via_pixel.state(self.page))[1];
                more.add_returned(self.page, all, level.is_fine);
            }
            measured.page.push(more.once.page.clone());
            match &mut orders {
                Some(sum) => sum.add(&more),
                None => orders = Some(more),
            }
        }
        for figure in Figure::ALL {
            let (colours, beside) = match (&orders, figure) {
                (_, Figure::Patch) => (pages.clone(), Some(pages[self.page])),
                (Some(orders), _) => self.blurred(figure, &pages, (orders, &by_wavelength), above)?,
                (None, _) => self.on_flat(figure, &pages, &by_wavelength, above)?,
            };
            measured.figures[figure as usize] = colours;
            measured.beside[figure as usize] = beside.filter(|_| state(self.setup, PAGE).is_some());
        }
        Ok(measured)
    }

    fn lit<'l>(&'l self, panel: &'l Panel, view: &'l ViewPoint, level: Level) -> Lit<'l> {
        let spread = self.setup.scene.display.pixel_spread();
        Lit { panel, lengths_mm: &self.lengths_mm, view, level, spread }
    }

    /// Adds the light of a shifted image of the page to each window, by sub-pixel.
    fn add_image(&self, at_mm: [f64; 2], light: f64, rows: &mut [Vec<f64>]) {
        let shift = [0, 1].map(|axis| -at_mm[axis] / self.matrix.pitch_mm[axis]);
        let windows = self.matrix.sub_pixels.iter().map(|one| &one.window);
        for (number, (row, window)) in rows.iter_mut().zip(windows.clone()).enumerate() {
            if shift == [0.0; 2] || window.area() == 0.0 {
                row[number] += light;
                continue;
            }
            let mut rest = 1.0;
            for (part, source) in row.iter_mut().zip(windows.clone()) {
                let fraction = window.overlap(source, shift) / window.area();
                *part += light * fraction;
                rest -= fraction;
            }
            if let Some(last) = row.last_mut() {
                *last += light * rest.max(0.0);
            }
        }
    }

    fn gathered(
        &self,
        Lit { panel: whole, view, level, .. }: Lit<'_>,
        source: &Source,
        weights: &[Vec<f64>; 3],
    ) -> Result<(Gathered, Vec<Colour>), DisplayError> {
        let accuracy = Accuracy { digits: level.digits, most_per_mm: level.most_per_mm };
        let mut panel = Panel { base: self.surfaces.base.clone(), ..whole.clone() };
        // What the front returns is added below.
        panel.front.reflectance_below = vec![0.0; panel.base.bins()].into();
        let lengths = [self.lengths_mm.last().copied().unwrap_or_default()];
        let spread = PanelSpread::new(&panel, &lengths, &view.field, source, accuracy).map_err(|error| {
            DisplayError::PlacesNotComputed { what: error.to_string(), key: "display".to_owned() }
        })?;
        let wanted = Wanted { parts: &self.parts, page: &self.surfaces.states[self.page] };
        let bases = [&panel.base, &whole.base];
        Ok(gather(&spread, (bases, &panel.medium), weights, &self.windows, &wanted))
    }

    /// Light that meets the pixels once and, if a front returns some of it, the same of diffuse light.
    fn orders(&self, lit: Lit<'_>, source: &Source, weights: &[Vec<f64>; 3]) -> Result<Orders, DisplayError> {
        let (once, pages) = self.gathered(lit, source, weights)?;
        // Paper is seen from the same places in any light.
        let diffuse = match source {
            _ if !lit.returns() || !lit.panel.base.is_specular() => None,
            Source::Diffuse => Some((once.clone(), pages.clone())),
            _ => Some(self.gathered(lit, &Source::Diffuse, weights)?),
        };
        Ok(Orders { once, pages, diffuse, own: Default::default() })
    }

    /// Y of light that returns to mirror-like figures, and what of it comes from the figure itself,
    /// `[figure][state]`.
    fn own_light(
        &self,
        lit: Lit<'_>,
        source: &Source,
        weights: &[f64],
        via_pixel: &[f64],
    ) -> Result<[Vec<[f64; 2]>; 4], DisplayError> {
        let first = lobe::response(lit, source, weights)?;
        let returned = Returned::new(lit, (source, first), weights, via_pixel)?;
        let pitch_mm = self.matrix.pitch_mm[0];
        let strokes = self.text.as_ref().map(|bitmap| bitmap.middles().strokes).unwrap_or_default();
        let text = self.text.as_ref().filter(|_| !strokes.is_empty());
        let text = text.map(|bitmap| Text { bitmap, pitch_mm: self.matrix.pitch_mm, middles: &strokes });
        let fraction = |figure: Figure, state: usize| match figure {
            Figure::Patch => 1.0,
            Figure::Stripe => returned.own_of_pattern(state, PatternKind::Stripes, 2.0 * pitch_mm),
            // The mean over a pixel, by Gauss's rule.
            Figure::Line => [-1.0, 0.0, 1.0]
                .map(|at: f64| {
                    let weight = if at == 0.0 { 4.0 / 9.0 } else { 5.0 / 18.0 };
                    weight * returned.own_of_line(state, (0, pitch_mm), 0.5 * at * 0.6_f64.sqrt() * pitch_mm)
                })
                .iter()
                .sum(),
            Figure::Text => text.as_ref().map_or(0.0, |text| {
                returned.own_of_text(state, text).iter().sum::<f64>() / strokes.len() as f64
            }),
        };
        Ok(Figure::ALL.map(|figure| {
            let of_state = |state: usize| {
                let light = returned.returned(state);
                [light, light * fraction(figure, state)]
            };
            (0..self.setup.states.len()).map(of_state).collect()
        }))
    }

    /// Colours of figures that are blurred: the page, less its light from the places of the figure and more
    /// of that of the figure.
    fn blurred(
        &self,
        figure: Figure,
        pages: &[Colour],
        (orders, by_wavelength): (&Orders, &[Vec<f64>; 3]),
        above: Above<'_>,
    ) -> Result<(Vec<Colour>, Option<Colour>), DisplayError> {
        let returns = self.panel.is_some_and(returns);
        let light_of = |gathered: &Gathered| match figure {
            Figure::Stripe => Some(gathered.stripes.clone()),
            Figure::Line => Some(gathered.line.clone()),
            Figure::Text | Figure::Patch => self.strokes(gathered),
        };
        let Some(once) = light_of(&orders.once) else { return Ok((Vec::new(), None)) };
        let later = orders.diffuse.as_ref().and_then(|(later, _)| light_of(later));
        let within = |diffuse: bool, state: usize| {
            let light = later.as_ref().filter(|_| diffuse).unwrap_or(&once);
            let mut sum = [0.0; 3];
            for part in &self.surfaces.states[state] {
                let known = self.parts.iter().position(|known| known.at() == part.at());
                let more = known.map_or([0.0; 3], |number| light[number]);
                (0..3).for_each(|k| sum[k] += part.fraction * more[k]);
            }
            sum
        };
        let is_paper = returns && !self.setup.stack.base().is_specular();
        let (rho, irradiance) = if is_paper { self.irradiance(figure, above)? } else { (Vec::new(), None) };
        let bins = self.setup.scene.grid.len();
        let on = |own: usize, page: usize| {
            if let Some(irradiance) = &irradiance {
                let row = |state: usize| &rho[state * bins..][..bins];
                // The brighter of both tells how much each wavelength counts.
                let of = if pages[own][1] > pages[page][1] { own } else { page };
                let over = irradiance.over_page([row(own), row(page)], row(of));
                let factors = [0, 1, 2].map(|k| {
                    let light = by_wavelength[k][of * bins..][..bins].iter().zip(&over);
                    light.map(|(light, over)| light * over).sum::<f64>() / orders.pages[of][k]
                });
                let back = Back::Diffuse(&factors);
                return orders.figure(figure, [own, page], (pages, back), within);
            }
            if returns {
                let back = if above.level().is_fine { Back::Mirrored } else { Back::Directly };
                return orders.figure(figure, [own, page], (pages, back), within);
            }
            let (more, less) = (within(false, own), within(false, page));
            [0, 1, 2].map(|k| pages[page][k] + more[k] - less[k])
        };
        let colours = (0..pages.len()).map(|state| on(state, self.page)).collect();
        let beside = match (figure, state(self.setup, BLACK)) {
            (Figure::Stripe, Some(black)) => on(self.page, black),
            _ => pages[self.page],
        };
        Ok((colours, Some(beside)))
    }

    /// Light of each part from the places of text, the mean over the middles of its strokes; `None` without
    /// text.
    fn strokes(&self, gathered: &Gathered) -> Option<Vec<Colour>> {
        let bitmap = self.text.as_ref()?;
        let middles = bitmap.middles().strokes;
        let [columns, rows] = bitmap.count.map(|count| count as i64);
        let mut light = vec![[0.0; 3]; self.parts.len()];
        for (x, y) in (-NEIGHBOURS..=NEIGHBOURS).flat_map(|y| (-NEIGHBOURS..=NEIGHBOURS).map(move |x| (x, y)))
        {
            let is_black = |pixel: &&usize| {
                let (at_x, at_y) = (**pixel as i64 % columns + x, **pixel as i64 / columns + y);
                let inside = (0..columns).contains(&at_x) && (0..rows).contains(&at_y);
                inside && bitmap.black[(at_y * columns + at_x) as usize]
            };
            let fraction = middles.iter().filter(is_black).count() as f64 / middles.len() as f64;
            let cell = cell([x, y]) * self.parts.len();
            for (sum, near) in light.iter_mut().zip(&gathered.near[cell..]) {
                (0..3).for_each(|k| sum[k] += fraction * near[k]);
            }
        }
        (!middles.is_empty()).then_some(light)
    }

    /// Reflectance of the states in the direction of the view, `[state][wavelength]`, and the irradiance of a
    /// figure; `None` without such a figure.
    fn irradiance(
        &self,
        figure: Figure,
        above: Above<'_>,
    ) -> Result<(Vec<f64>, Option<Irradiance>), DisplayError> {
        let mut rho = vec![0.0; self.setup.states.len() * self.setup.scene.grid.len()];
        let base = self.setup.stack.base();
        match (above, self.setup.stack.layers().last()) {
            (Above::Panel(Lit { panel, view, .. }), _) => {
                panel.base.reflectance(view.field.axis_towards().squared(), &panel.medium, &mut rho);
            }
            (Above::Layers(_), Some(layer)) => base.reflectance(0.0, &layer.medium, &mut rho),
            (Above::Layers(_), None) => {}
        }
        let pixels = Pixels { pitch_mm: self.matrix.pitch_mm, text: self.text.as_ref() };
        let most = rho.iter().copied().fold(0.0, f64::max);
        let irradiance = Irradiance::new(above, &pixels, figure, most)?;
        Ok((rho, irradiance))
    }

    /// Colours of figures under flat faces or general layers, through all orders.
    fn on_flat(
        &self,
        figure: Figure,
        pages: &[Colour],
        by_wavelength: &[Vec<f64>; 3],
        above: Above<'_>,
    ) -> Result<(Vec<Colour>, Option<Colour>), DisplayError> {
        let (rho, irradiance) = self.irradiance(figure, above)?;
        let Some(irradiance) = irradiance else { return Ok((Vec::new(), None)) };
        let bins = self.setup.scene.grid.len();
        let light = |state: usize| by_wavelength.each_ref().map(|light| &light[state * bins..][..bins]);
        let on = |own: usize, page: usize| {
            let rho = [own, page].map(|state| &rho[state * bins..][..bins]);
            irradiance.colour(&[light(own), light(page)], rho)
        };
        let colours = (0..pages.len()).map(|state| on(state, self.page)).collect();
        let beside = match (figure, state(self.setup, BLACK)) {
            (Figure::Stripe, Some(black)) => on(self.page, black),
            _ => pages[self.page],
        };
        Ok((colours, Some(beside)))
    }
}

/// True if a front returns light to the pixel.
fn returns(panel: &Panel) -> bool {
    !panel.single_pass && panel.front.reflectance_below.max() > 0.0
}

/// True for pixels under a flat face that are Lambertian, or to which it or a front returns light.
fn is_flat(panel: &Panel) -> bool {
    let is_paper = matches!(panel.base.reflector, Reflector::Lambertian(_));
    let returns = returns(panel) || matches!(panel.top, Top::Fresnel(_));
    !matches!(panel.top, Top::Diffuser(_)) && (is_paper || returns)
}

fn add(sum: &mut Colour, more: Colour) {
    (0..3).for_each(|k| sum[k] += more[k]);
}
