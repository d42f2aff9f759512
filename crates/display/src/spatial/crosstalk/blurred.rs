//! Figures below a lobe: light that meets the pixels once, by direction and place, and what a front returns to
//! them before (`orders.rs`).

use papilio_transport::spatial::{Accuracy, PanelSpread};
use papilio_transport::{Panel, Source};

use super::super::irradiance::Above;
use super::super::patterns::Text;
use super::super::response::Lit;
use super::super::returned::Returned;
use super::super::{PatternKind, lobe};
use super::frame::{Frame, returns};
use super::measure::Figures;
use super::orders::{Back, Orders};
use super::places::{Gathered, NEIGHBOURS, Wanted, cell, gather};
use super::{Colour, Figure};
use crate::DisplayError;

impl Frame<'_> {
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
        let spread = PanelSpread::new(&panel, &view.field, source, accuracy).map_err(|error| {
            DisplayError::PlacesNotComputed { what: error.to_string(), key: "display".to_owned() }
        })?;
        let wanted = Wanted { parts: &self.parts, page: &self.surfaces.states[self.page] };
        let bases = [&panel.base, &whole.base];
        Ok(gather(&spread, (bases, &panel.medium), weights, &self.windows, &wanted))
    }

    /// Light that meets the pixels once and, if a front returns some of it, the same of diffuse light.
    pub(super) fn orders(
        &self,
        lit: Lit<'_>,
        source: &Source,
        weights: &[Vec<f64>; 3],
    ) -> Result<Orders, DisplayError> {
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
    pub(super) fn own_light(
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
    pub(super) fn blurred(
        &self,
        figure: Figure,
        pages: &[Colour],
        (orders, by_wavelength): (&Orders, &[Vec<f64>; 3]),
        above: Above<'_>,
    ) -> Result<Figures, DisplayError> {
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
        Ok(self.figures(figure, pages, on))
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
}
