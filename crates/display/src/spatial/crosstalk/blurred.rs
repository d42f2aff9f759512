//! Figures below a lobe: light that meets the pixels once, by direction and place, and what a front returns to
//! them before (`returned.rs`; of Lambertian pixels, `flat.rs`).

use papilio_transport::spatial::{Accuracy, PanelSpread};
use papilio_transport::{Panel, Source};

use super::super::response::{Lit, not_computed};
use super::flat::colour;
use super::frame::Frame;
use super::measure::Figures;
use super::places::{Gathered, NEIGHBOURS, Wanted, cell, gather};
use super::returned::Returned;
use super::{Colour, Figure};
use crate::DisplayError;

/// What a view sees of the pixels below a lobe, in one light or all.
pub(super) struct Blurred {
    /// Light that meets the pixels once; its page is that of all orders.
    pub(super) once: Gathered,
    /// Uniform pages in light that meets them once, `[state]`.
    pages: Vec<Colour>,
    /// What a front returns to mirror-like pixels.
    returned: Option<Returned>,
}

impl Blurred {
    /// Adds light of another source.
    pub(super) fn add(&mut self, other: &Self) {
        self.once.add(&other.once);
        self.pages.iter_mut().zip(&other.pages).for_each(|(sum, more)| super::add(sum, *more));
        if let (Some(sum), Some(more)) = (&mut self.returned, &other.returned) {
            sum.add(more);
        }
    }
}

impl Frame<'_> {
    /// What is seen in the light of a source; `all` is the light of pages through all orders, `[state][wavelength]`.
    pub(super) fn below_lobe(
        &self,
        lit: Lit<'_>,
        source: &Source,
        weights: &[Vec<f64>; 3],
        all: &[f64],
    ) -> Result<Blurred, DisplayError> {
        let Lit { panel: whole, view, level, .. } = lit;
        let accuracy = Accuracy { digits: level.digits, most_per_mm: level.most_per_mm };
        let mut panel = Panel { base: self.surfaces.base.clone(), ..whole.clone() };
        // What the front returns is added below.
        panel.front.reflectance_below = vec![0.0; panel.base.bins()].into();
        let spread = PanelSpread::new(&panel, &view.field, source, accuracy).map_err(not_computed)?;
        let wanted = Wanted { parts: &self.parts, page: &self.surfaces.states[self.page] };
        let bases = [&panel.base, &whole.base];
        let sums = (&spread, level.is_other);
        let (mut once, pages) = gather(sums, (bases, &panel.medium), weights, &self.windows, &wanted);
        let mut returned = None;
        if lit.returns() && whole.base.is_specular() {
            let through = |part: &papilio_transport::spatial::Part| -> f64 {
                weights[1].iter().zip(&*part.through).map(|(weight, through)| weight * through).sum()
            };
            let brightest = spread.parts().iter().max_by(|a, b| through(a).total_cmp(&through(b)));
            let index = brightest.map_or_else(|| panel.medium.largest_index(), |part| part.index());
            let found = self.returned(lit, (source, index), weights, (all, &pages))?;
            let rows = once.page.iter_mut().flatten().zip(found.page.iter().flatten());
            rows.for_each(|(sum, more)| *sum += more);
            returned = Some(found);
        } else if lit.returns() {
            let bins = self.setup.scene.grid.len();
            let all = colour(weights, &all[self.page * bins..][..bins])[1];
            let factor = if pages[self.page][1] > 0.0 { all / pages[self.page][1] } else { 0.0 };
            once.page.iter_mut().flatten().for_each(|light| *light *= factor);
        }
        Ok(Blurred { once, pages, returned })
    }

    /// Colours of figures that are blurred: the page, less its light from the places of the figure and more
    /// of that of the figure. `pages` are those of all orders.
    pub(super) fn blurred(&self, figure: Figure, pages: &[Colour], below: &Blurred) -> Figures {
        let Blurred { once, pages: of_once, returned } = below;
        let pages = if returned.is_some() { of_once } else { pages };
        let mut found = match (figure, self.light_of(figure, once)) {
            (Figure::Patch, _) => (pages.to_vec(), Some(pages[self.page])),
            (_, None) => return (Vec::new(), None),
            (_, Some(light)) => {
                let on = |own: usize, page: usize| {
                    let [more, less] = [own, page].map(|state| self.within(&light, state));
                    [0, 1, 2].map(|k| pages[page][k] + more[k] - less[k])
                };
                self.figures(figure, pages, on)
            }
        };
        if let Some(returned) = returned {
            returned.add_to(figure, &mut found, self.page);
        }
        found
    }

    /// Fraction of the light of a figure that is its own, on a page of the same state; `None` without such a figure.
    pub(super) fn own_share(&self, figure: Figure, below: &Blurred) -> Option<f64> {
        let light = self.light_of(figure, &below.once)?;
        let brightest =
            (0..below.pages.len()).max_by(|a, b| below.pages[*a][1].total_cmp(&below.pages[*b][1]))?;
        let all = below.pages[brightest][1];
        Some(if all > 0.0 { (self.within(&light, brightest)[1] / all).min(1.0) } else { 1.0 })
    }

    /// Light of each part from the places of a figure; `None` without such a figure.
    fn light_of(&self, figure: Figure, once: &Gathered) -> Option<Vec<Colour>> {
        match figure {
            Figure::Stripe => Some(once.stripes.clone()),
            Figure::Line => Some(once.line.clone()),
            Figure::Text => self.strokes(once),
            Figure::Patch => None,
        }
    }

    /// Light of a state, given that of each part.
    fn within(&self, light: &[Colour], state: usize) -> Colour {
        let mut sum = [0.0; 3];
        for part in &self.surfaces.states[state] {
            let known = self.parts.iter().position(|known| known.at() == part.at());
            let more = known.map_or([0.0; 3], |number| light[number]);
            (0..3).for_each(|k| sum[k] += part.fraction * more[k]);
        }
        sum
    }

    /// Light of each part from the places of text, the mean over the middles of its strokes; `None` without
    /// text.
    fn strokes(&self, gathered: &Gathered) -> Option<Vec<Colour>> {
        let bitmap = self.text.as_ref()?;
        let middles = bitmap.middles().strokes;
        let [columns, rows] = bitmap.count.map(|count| count as i64);
        let mut light = vec![[0.0; 3]; self.parts.len()];
        let parts = self.parts.len();
        let around = (-NEIGHBOURS..=NEIGHBOURS).flat_map(|y| (-NEIGHBOURS..=NEIGHBOURS).map(move |x| [x, y]));
        let near = around.map(|pixel| (pixel, &gathered.near[cell(pixel) * parts..][..parts]));
        let far = gathered.far.iter().map(|(pixel, light)| (*pixel, &light[..]));
        for ([x, y], lights) in near.chain(far) {
            let is_black = |pixel: &&usize| {
                let (at_x, at_y) = (**pixel as i64 % columns + x, **pixel as i64 / columns + y);
                let inside = (0..columns).contains(&at_x) && (0..rows).contains(&at_y);
                inside && bitmap.black[(at_y * columns + at_x) as usize]
            };
            let fraction = middles.iter().filter(is_black).count() as f64 / middles.len() as f64;
            if fraction == 0.0 {
                continue;
            }
            for (sum, more) in light.iter_mut().zip(lights) {
                (0..3).for_each(|k| sum[k] += fraction * more[k]);
            }
        }
        (!middles.is_empty()).then_some(light)
    }
}
