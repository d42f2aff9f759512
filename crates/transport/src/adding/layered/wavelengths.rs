//! The wavelengths at which a first answer is computed, and the light between them.
//!
//! Over a film, each wavelength of each state is a column of its own, and where the layers differ by
//! wavelength, so do their operators. A first answer takes some of the wavelengths, from the first to the
//! last at equal steps. Between them, what is interpolated (a cubic through the four nearest) is not the
//! light itself, but what remains of it without a multiple of the light that the film and the media alone
//! return along the normal, which is known at all wavelengths: so the narrow features of both are in the
//! result. The multiple is that which leaves the smallest remainder. Where the film alone could not be
//! interpolated, because of narrow fringes, all wavelengths are computed. The coarser level of a first answer
//! has half as many wavelengths: the difference contains this error.

use papilio_spectra::StateSpectra;

use super::prepare::optics;
use crate::{Estimate, Reflector, Stack};

/// Largest error of the film alone, relative to its mean, with which wavelengths are left out.
const FRINGES: f64 = 0.05;

/// Returns the wavelengths to compute, ascending: at most `most`, unless fewer would save nothing or would
/// miss fringes of the film.
pub(super) fn computed(stack: &Stack, most: usize) -> Vec<usize> {
    let bins = stack.base().bins();
    let all = || (0..bins).collect();
    if bins <= most {
        return all();
    }
    if let Reflector::Lambertian(_) = stack.base().reflector {
        let first = optics(stack, 0);
        if (1..bins).all(|bin| optics(stack, bin) == first) {
            return all();
        }
    }
    let known: Vec<usize> = (0..most).map(|k| (k * (bins - 1) + (most - 1) / 2) / (most - 1)).collect();
    if misses(&film_alone(stack), bins, &known) > FRINGES { all() } else { known }
}

/// Returns the largest mean error of interpolated rows, relative to the mean of the row.
fn misses(rows: &[f64], bins: usize, known: &[usize]) -> f64 {
    let between = Between { known, bins };
    let error = |row: &[f64]| {
        let mut interpolated = row.to_vec();
        between.fill(&mut interpolated, &vec![0.0; bins]);
        let missed: f64 = interpolated.iter().zip(row).map(|(a, b)| (a - b).abs()).sum();
        missed / row.iter().sum::<f64>().max(f64::MIN_POSITIVE)
    };
    rows.chunks(bins).map(error).fold(0.0, f64::max)
}

/// Interpolates an estimate to the wavelengths that are not among `known`.
pub(super) fn interpolate(stack: &Stack, known: &[usize], estimate: &mut Estimate) {
    let bins = stack.base().bins();
    if known.len() == bins {
        return;
    }
    let control = film_alone(stack);
    let between = Between { known, bins };
    let states = |values: &mut StateSpectra| {
        for (values, control) in values.rows_mut().zip(control.rows()) {
            between.fill(values, control);
        }
    };
    for rho in &mut estimate.rho {
        states(&mut rho.via_pixel);
        between.fill(&mut rho.front, &vec![0.0; bins]);
    }
    let ledger = &mut estimate.ledger;
    for values in [
        &mut ledger.returned,
        &mut ledger.front,
        &mut ledger.diffuser,
        &mut ledger.glass,
        &mut ledger.pixel,
        &mut ledger.inactive,
    ] {
        states(values);
    }
}

/// Returns the light that the base returns along the normal through absorbing media alone.
fn film_alone(stack: &Stack) -> StateSpectra {
    let mut all = StateSpectra::zeros(stack.base().states(), stack.base().bins());
    if let Some(last) = stack.layers.last() {
        stack.base().reflectance(0.0, &last.medium, &mut all);
    }
    let media = stack.layers.iter().filter_map(|layer| layer.medium.transmittance());
    for transmittance in media {
        for row in all.rows_mut() {
            row.iter_mut().zip(transmittance.iter()).for_each(|(value, t)| *value *= t * t);
        }
    }
    all
}

/// Interpolation between some of the wavelengths.
struct Between<'a> {
    known: &'a [usize],
    bins: usize,
}

impl Between<'_> {
    /// Fills the gaps of `values` with a control variate: similar values that are known at all wavelengths.
    fn fill(&self, values: &mut [f64], control: &[f64]) {
        let products = |a: &[f64], b: &[f64]| self.known.iter().map(|&bin| a[bin] * b[bin]).sum::<f64>();
        let (square, product) = (products(control, control), products(control, values));
        let multiple = if square > 0.0 { product / square } else { 0.0 };
        let rest: Vec<f64> = self.known.iter().map(|&bin| values[bin] - multiple * control[bin]).collect();
        let mut first = 0;
        for bin in 0..self.bins {
            // The known wavelength at or below this one.
            while self.known.get(first + 1).is_some_and(|next| *next <= bin) {
                first += 1;
            }
            if self.known[first] != bin {
                values[bin] = multiple * control[bin] + self.cubic(&rest, first, bin);
            }
        }
    }

    /// Returns the cubic through the four known wavelengths nearest to a gap, or a polynomial through all of
    /// fewer.
    fn cubic(&self, rest: &[f64], first: usize, bin: usize) -> f64 {
        let few = self.known.len().min(4);
        let begin = first.saturating_sub(1).min(self.known.len() - few);
        let nodes = begin..begin + few;
        let x = bin as f64;
        let term = |i: usize| {
            let others = nodes.clone().filter(|&j| j != i);
            let at = |k: usize| self.known[k] as f64;
            rest[i] * others.map(|j| (x - at(j)) / (at(i) - at(j))).product::<f64>()
        };
        nodes.clone().map(term).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_of_the_control_variate_and_cubics_are_filled_exactly() {
        let bins = 81;
        let known: Vec<usize> = (0..28).map(|k| (k * 80 + 13) / 27).collect();
        assert_eq!((known[0], known[27]), (0, 80));
        let notch = |bin: usize| if bin == 31 { 0.1 } else { 0.9 };
        let control: Vec<f64> = (0..bins).map(notch).collect();
        let wanted: Vec<f64> = control.iter().map(|x| 0.3 * x).collect();
        let mut values = vec![0.0; bins];
        known.iter().for_each(|&bin| values[bin] = wanted[bin]);
        let between = Between { known: &known, bins };
        between.fill(&mut values, &control);
        assert!(values.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{values:?}");
        let cubic = |bin: usize| 1.0 + (bin as f64 / 80.0 - 0.3).powi(3);
        let mut values = vec![0.0; bins];
        known.iter().for_each(|&bin| values[bin] = cubic(bin));
        between.fill(&mut values, &vec![0.0; bins]);
        assert!((0..bins).all(|bin| (values[bin] - cubic(bin)).abs() < 1e-12), "{values:?}");
        let fringes: Vec<f64> = (0..bins).map(|bin| 0.5 + 0.4 * (1.7 * bin as f64).sin()).collect();
        assert!(misses(&wanted, bins, &known) < FRINGES && misses(&fringes, bins, &known) > FRINGES);
    }
}
