//! Figures on pages of pixels to which flat faces, a front above a diffuser, or general layers return light.
//!
//! A figure of reflectance rho on a page of another has the irradiance E(rho, page) of [`Recycling`]; 1/E is
//! almost linear in both, so that a few pairs serve all states and wavelengths. Where light spreads inside
//! the pixels, `sqrt(rho) E` is a smooth function of both roots instead.

use papilio_imaging::text::Bitmap;
use papilio_transport::spatial::Cells;

use super::super::Level;
use super::super::bounds::{cells_along, parts_of_pixels};
use super::super::irradiance::{Above, Return, moved};
use super::super::patterns::Text;
use super::through_lobe::ThroughLobe;
use super::{Colour, Figure};
use crate::DisplayError;

/// Tolerance of the irradiance.
const TOLERANCE: f64 = 1e-7;
/// Period of a line, in reaches of the light that comes back.
const LINE_PERIOD: f64 = 64.0;

/// Pixels of a figure: its pitch, and text.
pub(super) struct Pixels<'a> {
    pub(super) pitch_mm: [f64; 2],
    pub(super) text: Option<&'a Bitmap>,
}

/// Irradiance of figures over that of their own page, by the two reflectances.
pub(super) struct Irradiance {
    returns: Vec<Known>,
}

/// A figure, at wavelengths with the same returned light.
struct Known {
    bins: Vec<usize>,
    /// Return of uniform light.
    of_page: f64,
    /// Whether light spreads inside the pixels: nodes are then roots of reflectances.
    spreads: bool,
    /// 1/E of the figure; `sqrt(rho) E` where light spreads inside the pixels.
    own: Table,
    /// Fraction of the light at the wavelengths of the grid that shows the figure itself; `None` if all does.
    itself: Option<Vec<f64>>,
    /// All other light: the fraction of each part, and the light of the cells in it over that of a page of the
    /// mean reflectance; below a lobe the same of the figure and of all else, which count as its own share says.
    others: Vec<(Vec<f64>, Vec<Table>)>,
    /// Part of the cells that belong to the figure.
    share: f64,
}

/// How light shows other cells than those that are seen.
enum Shown {
    /// Those from which it is moved.
    At([f64; 2]),
    /// All, each with its weight: in one mean or, of the figure and of all else, in two.
    By(Vec<Vec<f64>>),
}

/// Values at pairs of nodes `[figure][page]`, from 0 to `most`.
struct Table {
    most: f64,
    nodes: usize,
    values: Vec<f64>,
}

impl Irradiance {
    /// Computes a figure for all reflectances up to `most`; `None` if there is no such figure.
    pub(super) fn new(
        above: Above<'_>,
        pixels: &Pixels<'_>,
        (figure, lobe): (Figure, Option<ThroughLobe>),
        most: f64,
    ) -> Result<Option<Self>, DisplayError> {
        let (level, thickness_mm, spreads) = (above.level(), above.thickness_mm(), above.spreads());
        let sizes_mm = [thickness_mm, above.reach_mm()?];
        let Some((cells, is_figure, seen)) = drawn(pixels, sizes_mm, figure, level) else {
            return Ok(None);
        };
        let nodes = if level.is_fine { 3 + level.finer as usize } else { 2 };
        let (nodes, most) =
            if spreads { (nodes + if level.is_fine { 3 } else { 2 }, most.sqrt()) } else { (nodes, most) };
        let images = above.images()?;
        let through_lobe =
            lobe.map(|lobe| lobe.weights(pixels.pitch_mm[0], cells, &is_figure, &seen).to_vec());
        let share = is_figure.iter().filter(|own| **own).count() as f64 / cells.len() as f64;
        let known = |(number, returned): (usize, Return)| {
            let shown = match &through_lobe {
                Some(weights) => images.first().map(|(_, fraction)| (weights.clone(), fraction.clone())),
                None => above.seen_from(number, cells, &seen).map(|(weights, part)| (vec![weights], part)),
            };
            let itself = match (&shown, images.first()) {
                (None, Some((_, fraction))) if images.len() > 1 || spreads => Some(fraction.clone()),
                (Some((_, fraction)), _) => Some(vec![0.0; fraction.len()]),
                _ => None,
            };
            let moved_images = images.iter().skip(1).map(|(at, part)| (part.clone(), Shown::At(*at)));
            let others = shown.map(|(weights, part)| (part, Shown::By(weights)));
            let others: Vec<(Vec<f64>, Shown)> = moved_images.chain(others).collect();
            let (solve, of_page) = (returned.solver(cells), returned.of_page());
            let at = |k: usize| most * k as f64 / (nodes - 1) as f64;
            let mut own = Vec::with_capacity(nodes * nodes);
            let means = |shown: &Shown| if let Shown::By(weights) = shown { weights.len() } else { 1 };
            let mut values_of_others: Vec<Vec<Vec<f64>>> =
                others.iter().map(|(_, shown)| vec![Vec::new(); means(shown)]).collect();
            for number in 0..nodes * nodes {
                let (figure, page) = (at(number / nodes), at(number % nodes));
                // There is light inside a black figure, too: that of one that is almost black.
                let root = figure.max(1e-6);
                let (figure, page) = if spreads { (root * root, page * page) } else { (figure, page) };
                let rho: Vec<f64> = is_figure.iter().map(|own| if *own { figure } else { page }).collect();
                let irradiance = solve(&rho, TOLERANCE);
                let mean =
                    |values: &[f64]| seen.iter().map(|cell| values[*cell]).sum::<f64>() / seen.len() as f64;
                own.push(if spreads { root * mean(&irradiance) } else { 1.0 / mean(&irradiance) });
                let of_mean = of_mean(share, of_page, [figure, page]);
                let light: Vec<f64> = rho.iter().zip(&irradiance).map(|(rho, e)| of_mean * rho * e).collect();
                for ((_, shown), values) in others.iter().zip(&mut values_of_others) {
                    match shown {
                        Shown::At(at_mm) => values[0].push(mean(&moved(&light, cells, *at_mm))),
                        Shown::By(weights) => {
                            for (weights, values) in weights.iter().zip(values) {
                                let pairs = weights.iter().zip(&light);
                                values.push(pairs.map(|(weight, light)| weight * light).sum());
                            }
                        }
                    }
                }
            }
            let table = |values| Table { most, nodes, values };
            Known {
                bins: returned.bins().to_vec(),
                of_page,
                spreads,
                own: table(own),
                itself,
                others: others
                    .into_iter()
                    .map(|(part, _)| part)
                    .zip(values_of_others.into_iter().map(|means| means.into_iter().map(table).collect()))
                    .collect(),
                share,
            }
        };
        let returns = above.returns(cells.most_per_mm())?.into_iter().enumerate().map(known).collect();
        Ok(Some(Self { returns }))
    }

    /// Colour of a figure on a page, from the light of pages and the reflectance of two states,
    /// `[state][wavelength]`; `own_share` is that of the figure below a lobe.
    pub(super) fn colour(&self, light: &[[&[f64]; 3]; 2], rho: [&[f64]; 2], own_share: f64) -> Colour {
        let mut sum = [0.0; 3];
        for Known { bins, of_page, spreads, own, itself, others, share } in &self.returns {
            for &bin in bins {
                let pair = rho.map(|rho| rho[bin]);
                let Some(itself) = itself else {
                    let factor = (1.0 - pair[0] * of_page) / own.at(pair);
                    (0..3).for_each(|k| sum[k] += light[0][k][bin] * factor);
                    continue;
                };
                // Where other places are seen, too, the brighter of both pages tells how much light there is.
                let of = usize::from(pair[1] > pair[0]);
                if pair[of] <= 0.0 {
                    continue;
                }
                let at = if *spreads { pair.map(f64::sqrt) } else { pair };
                let mixed = |means: &[Table]| match means {
                    [figure, rest] => own_share * figure.at(at) + (1.0 - own_share) * rest.at(at),
                    means => means.iter().map(|light| light.at(at)).sum(),
                };
                let others: f64 = others.iter().map(|(fraction, light)| fraction[bin] * mixed(light)).sum();
                let own = match spreads {
                    false => itself[bin] * pair[0] / own.at(at),
                    true => itself[bin] * at[0] * own.at(at),
                };
                let seen = own + others / of_mean(*share, *of_page, pair);
                let factor = seen * (1.0 - pair[of] * of_page) / pair[of];
                (0..3).for_each(|k| sum[k] += light[of][k][bin] * factor);
            }
        }
        sum
    }
}

impl Table {
    fn at(&self, [own, page]: [f64; 2]) -> f64 {
        let weights = |rho: f64| -> Vec<f64> {
            let place = if self.most > 0.0 { rho / self.most * (self.nodes - 1) as f64 } else { 0.0 };
            let lagrange = |k: usize| {
                let others = (0..self.nodes).filter(|other| *other != k);
                others.map(|other| (place - other as f64) / (k as f64 - other as f64)).product()
            };
            (0..self.nodes).map(lagrange).collect()
        };
        let (own, page) = (weights(own), weights(page));
        let rows = self.values.chunks_exact(self.nodes).zip(own);
        rows.map(|(row, own)| own * row.iter().zip(&page).map(|(v, page)| v * page).sum::<f64>()).sum()
    }
}

/// 1 over the irradiance of a page that has the mean reflectance of a figure and its page.
fn of_mean(share: f64, of_page: f64, [figure, page]: [f64; 2]) -> f64 {
    1.0 - of_page * (share * figure + (1.0 - share) * page)
}

/// Cells of a figure, which of them belong to it, and those that are seen. `sizes_mm`: how finely light varies
/// that comes back, and how far it spreads.
fn drawn(
    pixels: &Pixels<'_>,
    [thickness_mm, reach_mm]: [f64; 2],
    figure: Figure,
    level: Level,
) -> Option<(Cells, Vec<bool>, Vec<usize>)> {
    let pitch_mm = pixels.pitch_mm;
    let (fine, finer) = (level.is_fine, 0.5_f64.powi(level.finer as i32));
    match figure {
        Figure::Patch => None,
        Figure::Stripe | Figure::Line => {
            let widest = if fine { 0.05 } else { 0.1 } * finer * thickness_mm;
            let least = if fine { 5 << level.finer } else { 3 };
            let parts = ((pitch_mm[0] / widest).ceil() as usize).clamp(least, 512);
            let count = if figure == Figure::Stripe {
                2 * parts
            } else {
                let most = (LINE_PERIOD * reach_mm / pitch_mm[0]).ceil().max(16.0) * parts as f64;
                cells_along(most, level)
            };
            let period_mm = [count as f64 / parts as f64 * pitch_mm[0], 1.0];
            let is_figure = (0..count).map(|cell| cell < parts).collect();
            Some((Cells { count: [count, 1], period_mm }, is_figure, (0..parts).collect()))
        }
        Figure::Text => {
            let strokes = pixels.text?.middles().strokes;
            let text = Text { bitmap: pixels.text?, pitch_mm, middles: &strokes };
            let (bitmap, strokes) = &text.on_page(reach_mm, level);
            let widest_mm = if fine { 0.17 } else { 0.4 } * finer * thickness_mm;
            let parts = parts_of_pixels(bitmap, pitch_mm, widest_mm, level);
            let [columns, rows] = [0, 1].map(|axis| bitmap.count[axis] * parts[axis]);
            let pixel = |cell: usize| {
                let (column, row) = (cell % columns / parts[0], cell / columns / parts[1]);
                row * bitmap.count[0] + column
            };
            let mut is_stroke = vec![false; bitmap.black.len()];
            strokes.iter().for_each(|pixel| is_stroke[*pixel] = true);
            let all = 0..columns * rows;
            let period_mm = [0, 1].map(|axis| bitmap.count[axis] as f64 * pitch_mm[axis]);
            let is_figure = all.clone().map(|cell| bitmap.black[pixel(cell)]).collect();
            let seen: Vec<usize> = all.filter(|cell| is_stroke[pixel(*cell)]).collect();
            if seen.is_empty() {
                return None;
            }
            Some((Cells { count: [columns, rows], period_mm }, is_figure, seen))
        }
    }
}

/// Colour of light with these weights.
pub(super) fn colour(weights: &[Vec<f64>; 3], light: &[f64]) -> Colour {
    weights.each_ref().map(|weights| weights.iter().zip(light).map(|(weight, light)| weight * light).sum())
}
