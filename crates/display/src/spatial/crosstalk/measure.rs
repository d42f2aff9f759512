//! What a view sees of the pixels and of figures on them at a level.
//!
//! Below a lobe light is followed by direction (`blurred.rs`). Elsewhere figures have the irradiance that flat
//! faces or general layers give them (`flat.rs`).

use papilio_spectra::StateSpectra;
use papilio_transport::ReflectanceFactor;

use super::super::below_layers::Layers;
use super::super::irradiance::{Above, PlacedImage, along_field};
use super::super::response::{Lit, name_of_light};
use super::super::{Level, Refused};
use super::blurred::Blurred;
use super::flat::{self, Irradiance, Pixels};
use super::found::{Levelled, Measured};
use super::frame::{Frame, is_flat};
use super::through_lobe::ThroughLobe;
use super::{BLACK, Colour, Figure, PAGE, add, state};
use crate::DisplayError;
use crate::meter::Meter;
use crate::setup::{SeenPart, Setup, ViewPoint, all_of};

/// Colours of a figure in each state, and of what is beside it; none without such a figure.
pub(super) type Figures = (Vec<Colour>, Option<Colour>);

/// Uniform pages through all orders, in all light.
struct Pages {
    /// `[state]`
    colours: Vec<Colour>,
    /// In X, Y and Z, `[state][wavelength]`.
    by_wavelength: [Vec<f64>; 3],
}

impl Pages {
    fn new(setup: &Setup) -> Self {
        let (states, bins) = (setup.states.len(), setup.scene.grid.len());
        Self { colours: vec![[0.0; 3]; states], by_wavelength: [0, 1, 2].map(|_| vec![0.0; states * bins]) }
    }

    /// Adds light of these weights in X, Y and Z.
    fn add(&mut self, weights: &[Vec<f64>; 3], seen: &StateSpectra) {
        for (state, page) in self.colours.iter_mut().enumerate() {
            add(page, flat::colour(weights, seen.state(state)));
        }
        for (sum, weights) in self.by_wavelength.iter_mut().zip(weights) {
            let light = seen.iter().enumerate().map(|(at, light)| weights[at % weights.len()] * light);
            sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light);
        }
    }
}

/// A direction of the field of view, or the view itself.
enum Along {
    All,
    One(ViewPoint),
}

impl Along {
    /// What lies above the pixels, seen along this direction.
    fn above<'a>(&'a self, above: Above<'a>) -> Above<'a> {
        match (above, self) {
            (Above::Panel(lit), Self::One(view)) => Above::Panel(Lit { view, ..lit }),
            (above, _) => above,
        }
    }
}

/// Directions of a field of view along which mirror-like pixels below flat faces show other places, and their
/// fractions of the field.
fn directions(view: &ViewPoint, above: Above<'_>) -> Result<Vec<(Along, f64)>, DisplayError> {
    let found = match above {
        Above::Panel(lit) if lit.panel.base.is_specular() => along_field(Lit { view, ..lit })?,
        Above::Panel(_) | Above::Layers(_) => Vec::new(),
    };
    if found.len() < 2 {
        return Ok(vec![(Along::All, 1.0)]);
    }
    Ok(found.into_iter().map(|(view, share)| (Along::One(view), share)).collect())
}

impl Frame<'_> {
    pub(super) fn measure(&self, view: &ViewPoint, level: Level) -> Result<Levelled, DisplayError> {
        let setup = self.setup;
        let layers = match self.panel {
            Some(_) => None,
            None => Some(Layers::new(setup, view, level, self.control)?),
        };
        let above = match (self.panel, &layers) {
            (Some(panel), _) => Above::Panel(self.lit(panel, view, level)),
            (None, Some(layers)) => Above::Layers(layers),
            (None, None) => return Err(Refused::Layers.into()),
        };
        let parts = setup.seen_in_parts(view, above.level_of_pages(), self.control)?;
        match above {
            // Below a lobe light is followed by direction, and all of it counts as unpolarised.
            Above::Panel(lit) if !is_flat(lit.panel) => self.part_below_lobe(view, lit, &all_of(parts)),
            // Below flat faces, light of s and of p is kept apart.
            Above::Panel(_) => {
                let each = parts.iter().map(|SeenPart { stack, factors }| {
                    let own = stack.panel().map_or(above, |panel| Above::Panel(self.lit(panel, view, level)));
                    self.part(view, own, factors)
                });
                let all = each.collect::<Result<Vec<_>, _>>()?;
                Ok(all.into_iter().reduce(|sum, more| sum.plus(&more)).unwrap_or_default().into())
            }
            Above::Layers(_) => Ok(self.part(view, above, &all_of(parts))?.into()),
        }
    }

    /// What is seen of a part of the light where images of the pixels are sharp, given what is above them, and what is seen, for this
    /// light.
    fn part(
        &self,
        view: &ViewPoint,
        above: Above<'_>,
        factors: &[ReflectanceFactor],
    ) -> Result<Measured, DisplayError> {
        let (setup, meter) = (self.setup, Meter::new(self.setup));
        let mut measured = Measured { from_faces: meter.without_pixel(factors), ..Measured::default() };
        let directions = directions(view, above)?;
        let images = directions.iter().map(|(along, share)| Ok((along.above(above).images()?, *share)));
        let images = images.collect::<Result<Vec<_>, DisplayError>>()?;
        let mut pages = Pages::new(setup);
        for light in meter.pixel_lights().iter().filter(|light| light.is_seen()) {
            let factor = &factors[light.source];
            measured.names.push(name_of_light(setup, light));
            pages.add(&light.weights, &factor.via_pixel);
            let page = factor.via_pixel.state(self.page);
            measured.page.push(self.shares_of_images(&images, page, &light.weights[1]));
        }
        for figure in Figure::ALL {
            let found = match figure {
                Figure::Patch => (pages.colours.clone(), Some(pages.colours[self.page])),
                _ => self.on_flat(figure, &pages, (above, &directions), &[None])?.swap_remove(0),
            };
            self.set(&mut measured, figure, found);
        }
        Ok(measured)
    }

    /// What is seen below a lobe, and what is seen, for all light.
    fn part_below_lobe(
        &self,
        view: &ViewPoint,
        lit: Lit<'_>,
        factors: &[ReflectanceFactor],
    ) -> Result<Levelled, DisplayError> {
        let (setup, meter) = (self.setup, Meter::new(self.setup));
        let mut names = Vec::new();
        let mut pages = Pages::new(setup);
        let mut below = None::<Blurred>;
        // Light of the page, `[sum][light]`, and that of it which a front returns.
        let mut of_sums: Vec<Vec<_>> = Vec::new();
        let mut of_returned = [Vec::new(), Vec::new()];
        for light in meter.pixel_lights().iter().filter(|light| light.is_seen()) {
            let (weights, factor) = (&light.weights, &factors[light.source]);
            names.push(name_of_light(setup, light));
            pages.add(weights, &factor.via_pixel);
            let more = self.below_lobe(lit, &setup.sources[light.source], weights, &factor.via_pixel)?;
            of_sums.resize(more.sums.len(), Vec::new());
            for (of_sum, sum) in of_sums.iter_mut().zip(&more.sums) {
                of_sum.push(sum.gathered.page.clone());
            }
            for (of_returned, returned) in of_returned.iter_mut().zip(more.returned.iter().flatten()) {
                of_returned.push(returned.page.clone());
            }
            match &mut below {
                Some(sum) => sum.add(&more),
                None => below = Some(more),
            }
        }
        let Some(Blurred { sums, returned }) = &below else { return Ok(Levelled::default()) };
        let from_faces = meter.without_pixel(factors);
        let measured = |page| Measured { names: names.clone(), page, from_faces, ..Measured::default() };
        let mut all: Vec<Measured> = of_sums.into_iter().map(measured).collect();
        // Lambertian pixels below a lobe have the irradiance of flat ones.
        let is_lit_again = lit.returns() && !lit.panel.base.is_specular();
        let of_all_orders = returned.is_none().then_some(&pages.colours[..]);
        for figure in Figure::ALL {
            let found: Vec<Figures> = if is_lit_again && figure != Figure::Patch {
                let own: Vec<_> = sums.iter().map(|once| self.own_share(figure, once)).collect();
                let directions = directions(view, Above::Panel(lit))?;
                self.on_flat(figure, &pages, (Above::Panel(lit), &directions), &own)?
            } else {
                sums.iter().map(|once| self.blurred(figure, of_all_orders, once)).collect()
            };
            for (measured, found) in all.iter_mut().zip(found) {
                self.set(measured, figure, found);
            }
        }
        let all = Levelled::of_sums(&all);
        let Some(returned) = returned else { return Ok(all) };
        let of_returned = [0, 1].map(|k| {
            let mut more = Measured { page: std::mem::take(&mut of_returned[k]), ..Measured::default() };
            for figure in Figure::ALL {
                let mut found = all.found.dark(figure);
                returned[k].add_to(figure, &mut found, self.page);
                self.set(&mut more, figure, found);
            }
            more
        });
        Ok(all.with_returned(of_returned.each_ref()))
    }

    /// Sets the colours of a figure.
    fn set(&self, measured: &mut Measured, figure: Figure, (colours, beside): Figures) {
        measured.figures[figure as usize] = colours;
        measured.beside[figure as usize] = beside.filter(|_| state(self.setup, PAGE).is_some());
    }

    /// Light of the page by window and sub-pixel, where images of the pixels are sharp. Pixels that no image
    /// shows are not divided: they show their own kind.
    fn shares_of_images(
        &self,
        images: &[(Vec<PlacedImage>, f64)],
        page: &[f64],
        weights: &[f64],
    ) -> Vec<Vec<f64>> {
        let count = self.matrix.sub_pixels.len();
        let mut rows = vec![vec![0.0; count + 1]; count];
        for (images, share) in images {
            for (at_mm, fraction) in images {
                let light = page.iter().zip(fraction).zip(weights).map(|((light, f), w)| light * f * w);
                self.add_image(*at_mm, share * light.sum::<f64>(), &mut rows);
            }
            if images.is_empty() {
                let light = weights.iter().zip(page).map(|(weight, light)| weight * light);
                self.add_image([0.0; 2], share * light.sum::<f64>(), &mut rows);
            }
        }
        rows
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

    /// Reflectance of the states in the direction of the view, `[state][wavelength]`, and the irradiance of a
    /// figure; `None` without such a figure. Of a figure below a lobe, `is_blurred`, other light than its own is seen, too.
    fn irradiance(
        &self,
        figure: Figure,
        above: Above<'_>,
        is_blurred: bool,
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
        let lobe = match above {
            Above::Panel(lit) if is_blurred => Some(ThroughLobe::new(lit)?),
            _ => None,
        };
        let irradiance = Irradiance::new(above, &pixels, (figure, lobe), most)?;
        Ok((rho, irradiance))
    }

    /// Colours of figures under flat faces or general layers, through all orders: the mean of the directions of
    /// the field of view. One for each of `own`: the fraction of the light of the figure that is its own, below a lobe.
    fn on_flat(
        &self,
        figure: Figure,
        pages: &Pages,
        (above, directions): (Above<'_>, &[(Along, f64)]),
        own: &[Option<f64>],
    ) -> Result<Vec<Figures>, DisplayError> {
        let mut all = Vec::with_capacity(directions.len());
        let is_blurred = own.iter().any(Option::is_some);
        for (along, share) in directions {
            self.control.check()?;
            let (rho, irradiance) = self.irradiance(figure, along.above(above), is_blurred)?;
            let Some(irradiance) = irradiance else { return Ok(vec![(Vec::new(), None); own.len()]) };
            all.push((rho, irradiance, *share));
        }
        let bins = self.setup.scene.grid.len();
        let light = |state: usize| pages.by_wavelength.each_ref().map(|light| &light[state * bins..][..bins]);
        let figures = |own_share: &Option<f64>| {
            let on = |own: usize, page: usize| {
                let mut sum = [0.0; 3];
                for (rho, irradiance, share) in &all {
                    let rho = [own, page].map(|state| &rho[state * bins..][..bins]);
                    let colour = irradiance.colour(&[light(own), light(page)], rho, own_share.unwrap_or(1.0));
                    add(&mut sum, colour.map(|value| share * value));
                }
                sum
            };
            self.figures(figure, &pages.colours, on)
        };
        Ok(own.iter().map(figures).collect())
    }

    /// Colours of a figure in each state on the page, and of what is beside it, given those of one state on
    /// another.
    pub(super) fn figures(
        &self,
        figure: Figure,
        pages: &[Colour],
        on: impl Fn(usize, usize) -> Colour,
    ) -> Figures {
        let colours = (0..pages.len()).map(|state| on(state, self.page)).collect();
        let beside = match (figure, state(self.setup, BLACK)) {
            (Figure::Stripe, Some(black)) => on(self.page, black),
            _ => pages[self.page],
        };
        (colours, Some(beside))
    }
}
