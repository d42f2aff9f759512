//! Figures on pages of Lambertian pixels, to which a flat face, or a front above a diffuser, returns light.
//!
//! A figure of reflectance rho on a page of another has the irradiance E(rho, page) of [`Recycling`]; 1/E is almost linear in
//! both, so that a few pairs serve all states and wavelengths.

use papilio_imaging::text::Bitmap;
use papilio_transport::Panel;
use papilio_transport::spatial::{Accuracy, Cells, LambertianReturn, Recycling};

use super::super::Level;
use super::super::response::several_fronts;
use super::{Colour, Figure};
use crate::DisplayError;

/// Tolerance of the irradiance.
const TOLERANCE: f64 = 1e-7;
/// Period of a line in thicknesses.
const LINE_PERIOD: f64 = 64.0;

/// Pixels of a figure: its pitch, and text.
pub(super) struct Pixels<'a> {
    pub(super) pitch_mm: [f64; 2],
    pub(super) lengths_mm: &'a [f64],
    pub(super) text: Option<&'a Bitmap>,
}

/// Irradiance of figures over that of their own page, by the two reflectances.
pub(super) struct Irradiance {
    /// Wavelengths of a face, and 1/E at the nodes.
    faces: Vec<(Vec<usize>, Table)>,
}

/// 1/E at pairs of nodes `[figure][page]`, from 0 to `most`.
struct Table {
    most: f64,
    nodes: usize,
    values: Vec<f64>,
    /// Return of uniform light.
    zero: f64,
}

impl Irradiance {
    /// Computes a figure for all reflectances up to `most`; `None` if there is no such figure.
    pub(super) fn new(
        panel: &Panel,
        pixels: &Pixels<'_>,
        figure: Figure,
        most: f64,
        level: Level,
    ) -> Result<Option<Self>, DisplayError> {
        let Some((cells, is_figure, seen)) = drawn(pixels, figure, level) else { return Ok(None) };
        let accuracy = Accuracy { digits: level.digits, most_per_mm: cells.most_per_mm() };
        let faces = LambertianReturn::all(panel, pixels.lengths_mm, accuracy).map_err(several_fronts)?;
        let nodes = if level.is_fine { 3 + level.finer as usize } else { 2 };
        let face = |face: LambertianReturn| {
            let recycling = Recycling::new(cells, |f| face.at(f));
            let at = |k: usize| most * k as f64 / (nodes - 1) as f64;
            let one = |number: usize| {
                let (own, page) = (at(number / nodes), at(number % nodes));
                let rho: Vec<f64> = is_figure.iter().map(|own_is| if *own_is { own } else { page }).collect();
                let irradiance = recycling.irradiance(&rho, TOLERANCE);
                let sum: f64 = seen.iter().map(|cell| irradiance[*cell]).sum();
                seen.len() as f64 / sum
            };
            let values = (0..nodes * nodes).map(one).collect();
            let zero = face.at(0.0);
            (face.bins, Table { most, nodes, values, zero })
        };
        Ok(Some(Self { faces: faces.into_iter().map(face).collect() }))
    }

    /// Irradiance of a figure on a page over that of a page of a state, for each wavelength, from their reflectances.
    pub(super) fn over_page(&self, [figure, page]: [&[f64]; 2], of: &[f64]) -> Vec<f64> {
        let mut factors = vec![1.0; figure.len()];
        for (bins, table) in &self.faces {
            for &bin in bins {
                factors[bin] = (1.0 - of[bin] * table.zero) / table.at([figure[bin], page[bin]]);
            }
        }
        factors
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

/// Cells of a figure, which of them belong to it, and those that are seen.
fn drawn(pixels: &Pixels<'_>, figure: Figure, level: Level) -> Option<(Cells, Vec<bool>, Vec<usize>)> {
    let pitch_mm = pixels.pitch_mm;
    let thickness_mm = pixels.lengths_mm.last().copied().unwrap_or_default();
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
                let most = (LINE_PERIOD * thickness_mm / pitch_mm[0]).ceil().max(16.0) as usize * parts;
                most.next_power_of_two()
            };
            let period_mm = [count as f64 / parts as f64 * pitch_mm[0], 1.0];
            let is_figure = (0..count).map(|cell| cell < parts).collect();
            Some((Cells { count: [count, 1], period_mm }, is_figure, (0..parts).collect()))
        }
        Figure::Text => {
            let bitmap = pixels.text?;
            let widest = if fine { 0.17 } else { 0.4 } * finer * thickness_mm;
            let parts = pitch_mm.map(|pitch| (pitch / widest).ceil() as usize);
            let [columns, rows] = [0, 1].map(|axis| bitmap.count[axis] * parts[axis]);
            let pixel = |cell: usize| {
                let (column, row) = (cell % columns / parts[0], cell / columns / parts[1]);
                row * bitmap.count[0] + column
            };
            let strokes = bitmap.middles().strokes;
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
