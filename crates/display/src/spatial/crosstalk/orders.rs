//! Light that meets the pixels once, and light that a front above a diffuser returned to them before.
//!
//! **What.** Of light that a front returns to mirror-like pixels, the last meeting with the pixels is seen as
//! in diffuse light: it comes from all directions of the lobe, whatever the source. Of the meetings before, a
//! figure has the part that its sharpness says (`returned.rs`); all others have the reflectance of the page,
//! or the mean of two columns of stripes. How much returns is known from pages. Lambertian pixels have the
//! irradiance of the figure itself (`flat.rs`), which hardly changes over the width of a lobe.
//!
//! **Error.** For mirror-like pixels the coarse level takes all meetings to be at the places that are seen
//! directly. The difference is stated as the error.

use super::places::Gathered;
use super::{Colour, Figure};

/// What a view sees of the pixels, in one light or all.
pub(super) struct Orders {
    /// Light that meets the pixels once.
    pub(super) once: Gathered,
    /// Uniform pages in this light, `[state]`.
    pub(super) pages: Vec<Colour>,
    /// Both for diffuse light of this spectrum, where light of the source is seen from other places and a
    /// front returns some.
    pub(super) diffuse: Option<(Gathered, Vec<Colour>)>,
    /// Y of light that returns to a figure on its own page, and what of it comes from the figure,
    /// `[figure][state]`.
    pub(super) own: [Vec<[f64; 2]>; 4],
}

/// How a front returns light to a figure.
pub(super) enum Back<'a> {
    /// At the coarse level: from the places that are seen directly.
    Directly,
    /// To mirror-like pixels: as [`Orders::own`] says.
    Mirrored,
    /// To Lambertian pixels: factors of light that meets them once.
    Diffuse(&'a Colour),
}

impl Orders {
    /// Adds light of another source.
    pub(super) fn add(&mut self, other: &Self) {
        self.once.add(&other.once);
        self.pages.iter_mut().zip(&other.pages).for_each(|(sum, more)| super::add(sum, *more));
        if let (Some((sums, pages)), Some((more, of_more))) = (&mut self.diffuse, &other.diffuse) {
            sums.add(more);
            pages.iter_mut().zip(of_more).for_each(|(sum, more)| super::add(sum, *more));
        }
        let own = self.own.iter_mut().flatten().zip(other.own.iter().flatten());
        own.for_each(|(sum, more)| (0..2).for_each(|k| sum[k] += more[k]));
    }

    /// Adds what is returned to the light of the page by window and sub-pixel; `all` is Y of the page through
    /// all orders.
    pub(super) fn add_returned(&mut self, page: usize, all: f64, is_fine: bool) {
        let over = |part: f64, whole: f64| if whole > 0.0 { (part / whole).max(0.0) } else { 0.0 };
        let once = self.pages[page][1];
        match &self.diffuse {
            Some((diffuse, pages)) if is_fine => {
                let scale = over(all - once, pages[page][1]);
                let rows = self.once.page.iter_mut().flatten().zip(diffuse.page.iter().flatten());
                rows.for_each(|(sum, more)| *sum += scale * more);
            }
            _ => self.once.page.iter_mut().flatten().for_each(|light| *light *= over(all, once)),
        }
    }

    /// Colour of a figure on a page. `pages` are uniform pages through all orders; `within` is the light that
    /// comes from the places of a figure in a state, if true in diffuse light.
    pub(super) fn figure(
        &self,
        figure: Figure,
        [own, page]: [usize; 2],
        (pages, back): (&[Colour], Back<'_>),
        within: impl Fn(bool, usize) -> Colour,
    ) -> Colour {
        let blurred = |diffuse: bool, pages: &[Colour], k: usize| {
            pages[page][k] + within(diffuse, own)[k] - within(diffuse, page)[k]
        };
        let of_later = self.diffuse.as_ref().map_or(&self.pages[..], |(_, pages)| pages);
        let from_itself = self.own[figure as usize]
            .get(own)
            .map_or(0.0, |[all, own]| if *all > 0.0 { own / all } else { 0.0 });
        [0, 1, 2].map(|k| {
            let once = &self.pages[..];
            // Light of all further orders over that of a page once.
            let returned = |state: usize, of: &[Colour]| {
                if of[state][k] > 0.0 { (pages[state][k] - once[state][k]) / of[state][k] } else { 0.0 }
            };
            let first = blurred(false, once, k);
            match back {
                Back::Directly => {
                    let part = if once[own][k] > 0.0 { within(false, own)[k] / once[own][k] } else { 0.0 };
                    let [own, page] = [own, page].map(|state| returned(state, once));
                    first * (1.0 + page + part * (own - page))
                }
                Back::Diffuse(factors) => first * factors[k],
                Back::Mirrored => {
                    let [own, page] = [own, page].map(|state| returned(state, of_later));
                    let elsewhere = match figure {
                        Figure::Stripe => 1.0 / (0.5 / (1.0 + own) + 0.5 / (1.0 + page)) - 1.0,
                        Figure::Patch | Figure::Line | Figure::Text => page,
                    };
                    first + blurred(true, of_later, k) * (elsewhere + from_itself * (own - elsewhere))
                }
            }
        })
    }
}
