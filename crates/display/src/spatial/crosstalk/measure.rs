//! What a view sees of the pixels and of figures on them at a level.
//!
//! Below a lobe light is followed by direction (`blurred.rs`). Elsewhere figures have the irradiance that flat
//! faces or general layers give them (`flat.rs`).

use papilio_transport::ReflectanceFactor;

use super::super::below_layers::Layers;
use super::super::irradiance::{Above, PlacedImage, along_field};
use super::super::response::{Lit, name_of_light};
use super::super::{Level, Refused};
use super::blurred::Blurred;
use super::flat::{self, Irradiance, Pixels};
use super::found::Measured;
use super::frame::{Frame, is_flat};
use super::through_lobe::ThroughLobe;
use super::{BLACK, Colour, Figure, PAGE, add, state};
use crate::DisplayError;
use crate::meter::Meter;
use crate::setup::{SeenPart, ViewPoint, all_of};

/// Colours of a figure in each state, and of what is beside it; none without such a figure.
pub(super) type Figures = (Vec<Colour>, Option<Colour>);

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
    pub(super) fn measure(&self, view: &ViewPoint, level: Level) -> Result<Measured, DisplayError> {
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
        // Below flat faces, light of s and of p is kept apart. Below a lobe, all of it counts as unpolarised.
        if !self.panel.is_some_and(is_flat) {
            return self.part(view, above, &all_of(parts));
        }
        let each = parts.iter().map(|SeenPart { stack, factors }| {
            let own = stack.panel().map_or(above, |panel| Above::Panel(self.lit(panel, view, level)));
            self.part(view, own, factors)
        });
        let all = each.collect::<Result<Vec<_>, _>>()?;
        Ok(all.into_iter().reduce(|sum, more| sum.plus(&more)).unwrap_or_default())
    }

    /// The same of a part of the light, given what is above the pixels, and what is seen, for this light.
    fn part(
        &self,
        view: &ViewPoint,
        above: Above<'_>,
        factors: &[ReflectanceFactor],
    ) -> Result<Measured, DisplayError> {
        let (setup, meter) = (self.setup, Meter::new(self.setup));
        let (states, bins) = (setup.states.len(), setup.scene.grid.len());
        let mut measured = Measured::default();
        let (mut pages, mut below) = (vec![[0.0; 3]; states], None::<Blurred>);
        // Below a lobe light is followed by direction.
        let below_lobe = match above {
            Above::Panel(lit) if !is_flat(lit.panel) => Some(lit),
            Above::Panel(_) | Above::Layers(_) => None,
        };
        let is_mirror = |lit: Lit<'_>| lit.panel.base.is_specular();
        let directions =
            if below_lobe.is_some_and(is_mirror) { Vec::new() } else { directions(view, above)? };
        let images = directions.iter().map(|(along, share)| Ok((along.above(above).images()?, *share)));
        let images = images.collect::<Result<Vec<_>, DisplayError>>()?;
        // Light of each state and wavelength in X, Y and Z.
        let mut by_wavelength = [0, 1, 2].map(|_| vec![0.0; states * bins]);
        measured.from_faces = meter.without_pixel(factors);
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
                measured.page.push(self.shares_of_images(&images, page, &weights[1]));
                continue;
            };
            let source = &setup.sources[light.source];
            let more = self.below_lobe(lit, source, weights, &factor.via_pixel)?;
            measured.page.push(more.once.page.clone());
            match &mut below {
                Some(sum) => sum.add(&more),
                None => below = Some(more),
            }
        }
        // Lambertian pixels below a lobe have the irradiance of flat ones.
        let is_lit_again = below_lobe.is_some_and(|lit| lit.returns() && !is_mirror(lit));
        for figure in Figure::ALL {
            let (colours, beside) = match (&below, figure) {
                (Some(below), _) if !is_lit_again => self.blurred(figure, &pages, below),
                (_, Figure::Patch) => (pages.clone(), Some(pages[self.page])),
                _ => {
                    let own = below.as_ref().and_then(|below| self.own_share(figure, below));
                    self.on_flat(figure, &pages, &by_wavelength, (above, &directions, own))?
                }
            };
            measured.figures[figure as usize] = colours;
            measured.beside[figure as usize] = beside.filter(|_| state(self.setup, PAGE).is_some());
        }
        Ok(measured)
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
    /// figure; `None` without such a figure. `own`: the fraction of the light of the figure that is its own, below a lobe.
    fn irradiance(
        &self,
        figure: Figure,
        above: Above<'_>,
        own: Option<f64>,
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
        let lobe = match (above, own) {
            (Above::Panel(lit), Some(own)) => Some(ThroughLobe::new(lit, own)?),
            _ => None,
        };
        let irradiance = Irradiance::new(above, &pixels, (figure, lobe), most)?;
        Ok((rho, irradiance))
    }

    /// Colours of figures under flat faces or general layers, through all orders: the mean of the directions of
    /// the field of view.
    fn on_flat(
        &self,
        figure: Figure,
        pages: &[Colour],
        by_wavelength: &[Vec<f64>; 3],
        (above, directions, own): (Above<'_>, &[(Along, f64)], Option<f64>),
    ) -> Result<Figures, DisplayError> {
        let mut all = Vec::with_capacity(directions.len());
        for (along, share) in directions {
            self.control.check()?;
            let (rho, irradiance) = self.irradiance(figure, along.above(above), own)?;
            let Some(irradiance) = irradiance else { return Ok((Vec::new(), None)) };
            all.push((rho, irradiance, *share));
        }
        let bins = self.setup.scene.grid.len();
        let light = |state: usize| by_wavelength.each_ref().map(|light| &light[state * bins..][..bins]);
        let on = |own: usize, page: usize| {
            let mut sum = [0.0; 3];
            for (rho, irradiance, share) in &all {
                let rho = [own, page].map(|state| &rho[state * bins..][..bins]);
                let colour = irradiance.colour(&[light(own), light(page)], rho);
                add(&mut sum, colour.map(|value| share * value));
            }
            sum
        };
        Ok(self.figures(figure, pages, on))
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
