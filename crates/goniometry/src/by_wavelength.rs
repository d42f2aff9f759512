//! Levels of a measurement at several wavelengths.

use papilio_optics::Beta;

use crate::shape::first_lobes;
use crate::{Channel, MeasuredPart, Shape};

/// Levels of the wavelengths of a part: displays use the lobe of one wavelength with the level of each.
#[derive(Debug, Clone, PartialEq)]
pub struct WavelengthLevels {
    /// Wavelengths, nm, ascending.
    pub wavelengths_nm: Vec<f64>,
    /// Totals at the smallest incidence, relative to that of the luminous channel.
    pub ratios: Vec<f64>,
    /// Largest difference of the normalised lobes from the luminous one within its half-width, relative to
    /// its peak.
    pub shape_difference: f64,
}

impl WavelengthLevels {
    /// Levels of a part with two or more wavelengths; `None` for others, and without light.
    pub fn of(part: &MeasuredPart) -> Option<Self> {
        let mut waves: Vec<(f64, usize)> = part
            .channels
            .iter()
            .enumerate()
            .filter_map(|(k, channel)| match channel {
                Channel::Wavelength(nm) => Some((*nm, k)),
                _ => None,
            })
            .collect();
        waves.sort_by(|a, b| a.0.total_cmp(&b.0));
        if waves.len() < 2 {
            return None;
        }
        let luminous = part.luminous();
        let channels: Vec<usize> = waves.iter().map(|(_, k)| *k).collect();
        let lobes = first_lobes(part, &channels)?;
        let of_luminous = &lobes[channels.iter().position(|k| *k == luminous)?];
        let totals: Vec<f64> = lobes.iter().map(|lobe| lobe.total(0)).collect();
        let level = of_luminous.total(0);
        if level <= 0.0 || !totals.iter().all(|total| total.is_finite()) {
            return None;
        }
        let lit = lobes.iter().zip(&totals).filter(|(_, total)| **total > 0.0);
        let shape_difference =
            lit.map(|(lobe, total)| difference(lobe, of_luminous, level / total)).fold(0.0, f64::max);
        Some(Self {
            wavelengths_nm: waves.iter().map(|(nm, _)| *nm).collect(),
            ratios: totals.iter().map(|total| total / level).collect(),
            shape_difference,
        })
    }

    /// Ratio at a wavelength: linear between those of the file, the nearest one beyond.
    pub fn at(&self, nm: f64) -> f64 {
        let upper = self.wavelengths_nm.partition_point(|known| *known < nm);
        if upper == 0 || upper == self.wavelengths_nm.len() {
            return self.ratios[upper.min(self.ratios.len() - 1)];
        }
        let [a, b] = [self.wavelengths_nm[upper - 1], self.wavelengths_nm[upper]];
        let t = (nm - a) / (b - a);
        (1.0 - t) * self.ratios[upper - 1] + t * self.ratios[upper]
    }
}

/// Difference of two lobes, the first one times `scale`, relative to the peak of the second.
fn difference(lobe: &Shape, other: &Shape, scale: f64) -> f64 {
    let at = |shape: &Shape, delta: f64| shape.value(0, Beta { x: -delta, y: 0.0 });
    let peak = at(other, 0.0);
    let end = other.half_width_deg(0, 180.0).map_or(0.5, |deg| deg.to_radians().sin());
    let steps = (0..=8).map(|k| end * f64::from(k) / 8.0);
    steps.map(|delta| (scale * at(lobe, delta) - at(other, delta)).abs() / peak).fold(0.0, f64::max)
}
