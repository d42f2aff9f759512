//! Figures below a lobe: light that meets the pixels once, by direction and place, and what a front returns to
//! them before (`returned.rs`; of Lambertian pixels, `flat.rs`).

use papilio_imaging::text::Bitmap;
use papilio_transport::spatial::{Accuracy, PanelSpread};
use papilio_transport::{Panel, Source};

use super::super::Level;
use super::super::response::{Lit, not_computed};
use super::flat::colour;
use super::frame::Frame;
use super::measure::Figures;
use super::places::{Gathered, NEIGHBOURS, Wanted, gather};
use super::returned::Returned;
use super::{Colour, Figure};
use crate::DisplayError;

/// What a view sees of the pixels below a lobe, in one light or all.
pub(super) struct Blurred {
    /// Light that meets the pixels once, in each sum over directions.
    pub(super) sums: Vec<Once>,
    /// What a front returns to mirror-like pixels, and the same of other chains.
    pub(super) returned: Option<[Returned; 2]>,
}

/// Light that meets the pixels once; its page is that of all orders, but for what a front returns to mirror-like pixels.
pub(super) struct Once {
    pub(super) gathered: Gathered,
    /// Uniform pages in light that meets them once, `[state]`.
    pages: Vec<Colour>,
}

impl Blurred {
    /// Adds light of another source.
    pub(super) fn add(&mut self, other: &Self) {
        for (sum, more) in self.sums.iter_mut().zip(&other.sums) {
            sum.gathered.add(&more.gathered);
            sum.pages.iter_mut().zip(&more.pages).for_each(|(sum, more)| super::add(sum, *more));
        }
        if let (Some(sums), Some(more)) = (&mut self.returned, &other.returned) {
            sums.iter_mut().zip(more).for_each(|(sum, more)| sum.add(more));
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
        let sums = gather(&spread, (bases, &panel.medium), weights, &self.windows, &wanted);
        let mut sums: Vec<Once> =
            sums.into_iter().map(|(gathered, pages)| Once { gathered, pages }).collect();
        let mut returned = None;
        if lit.returns() && whole.base.is_specular() {
            let through = |part: &papilio_transport::spatial::Part| -> f64 {
                weights[1].iter().zip(&*part.through).map(|(weight, through)| weight * through).sum()
            };
            let brightest = spread.parts().iter().max_by(|a, b| through(a).total_cmp(&through(b)));
            let index = brightest.map_or_else(|| panel.medium.largest_index(), |part| part.index());
            let light = (all, &mean_pages(&sums)[..]);
            let [own, other] = [level.is_other, true].map(|is_other| {
                let level = Level { is_other, ..level };
                self.returned(Lit { level, ..lit }, (source, index), weights, light)
            });
            returned = Some([own?, other?]);
        } else if lit.returns() {
            let bins = self.setup.scene.grid.len();
            let all = colour(weights, &all[self.page * bins..][..bins])[1];
            for Once { gathered, pages } in &mut sums {
                let factor = if pages[self.page][1] > 0.0 { all / pages[self.page][1] } else { 0.0 };
                gathered.page.iter_mut().flatten().for_each(|light| *light *= factor);
            }
        }
        Ok(Blurred { sums, returned })
    }

    /// Colours of figures that are blurred: the page, less its light from the places of the figure and more
    /// of that of the figure. `pages` are those of all orders; light that a front returns to mirror-like pixels is not there.
    pub(super) fn blurred(&self, figure: Figure, pages: Option<&[Colour]>, once: &Once) -> Figures {
        let pages = pages.unwrap_or(&once.pages);
        match (figure, self.light_of(figure, &once.gathered)) {
            (Figure::Patch, _) => (pages.to_vec(), Some(pages[self.page])),
            (_, None) => (Vec::new(), None),
            (_, Some(light)) => {
                let on = |own: usize, page: usize| {
                    let [more, less] = [own, page].map(|state| self.within(&light, state));
                    [0, 1, 2].map(|k| pages[page][k] + more[k] - less[k])
                };
                self.figures(figure, pages, on)
            }
        }
    }

    /// Fraction of the light of a figure that is its own, on a page of the same state; `None` without such a figure.
    pub(super) fn own_share(&self, figure: Figure, once: &Once) -> Option<f64> {
        let light = self.light_of(figure, &once.gathered)?;
        let pages = &once.pages;
        let brightest = (0..pages.len()).max_by(|a, b| pages[*a][1].total_cmp(&pages[*b][1]))?;
        let all = pages[brightest][1];
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
        let strokes = self.strokes.as_ref()?;
        let mut light = vec![[0.0; 3]; self.parts.len()];
        let near = strokes.near.iter().copied().zip(gathered.near.chunks_exact(self.parts.len()));
        let far = gathered.far.iter().map(|(pixel, light)| (strokes.fraction(*pixel), &light[..]));
        for (fraction, lights) in near.chain(far).filter(|(fraction, _)| *fraction > 0.0) {
            for (sum, more) in light.iter_mut().zip(lights) {
                (0..3).for_each(|k| sum[k] += fraction * more[k]);
            }
        }
        Some(light)
    }
}

/// Text about the middles of its strokes.
pub(super) struct Strokes {
    bitmap: Bitmap,
    middles: Vec<usize>,
    /// Fraction of the middles that have a black pixel at each pixel around, in the order of light that is kept apart.
    near: Vec<f64>,
}

impl Strokes {
    /// Those of a text; `None` without strokes.
    pub(super) fn new(bitmap: &Bitmap) -> Option<Self> {
        let middles = bitmap.middles().strokes;
        if middles.is_empty() {
            return None;
        }
        let mut strokes = Self { bitmap: bitmap.clone(), middles, near: Vec::new() };
        let around = (-NEIGHBOURS..=NEIGHBOURS).flat_map(|y| (-NEIGHBOURS..=NEIGHBOURS).map(move |x| [x, y]));
        strokes.near = around.map(|pixel| strokes.fraction(pixel)).collect();
        Some(strokes)
    }

    /// Fraction of the middles that have a black pixel so many columns and rows away.
    fn fraction(&self, [x, y]: [i64; 2]) -> f64 {
        let [columns, rows] = self.bitmap.count.map(|count| count as i64);
        let is_black = |middle: &&usize| {
            let (at_x, at_y) = (**middle as i64 % columns + x, **middle as i64 / columns + y);
            let inside = (0..columns).contains(&at_x) && (0..rows).contains(&at_y);
            inside && self.bitmap.black[(at_y * columns + at_x) as usize]
        };
        self.middles.iter().filter(is_black).count() as f64 / self.middles.len() as f64
    }
}

/// Pages in light that meets them once: the mean of the sums.
fn mean_pages(sums: &[Once]) -> Vec<Colour> {
    let states = sums.first().map_or(0, |sum| sum.pages.len());
    let mean = |state: usize| {
        [0, 1, 2].map(|k| sums.iter().map(|sum| sum.pages[state][k]).sum::<f64>() / sums.len() as f64)
    };
    (0..states).map(mean).collect()
}
