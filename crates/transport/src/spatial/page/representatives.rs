//! Wavelengths that represent all others in functions of the reflectances of the states.

use super::PageLight;

/// Representative wavelengths, and how the others follow from them.
#[derive(Debug, Clone)]
pub(super) struct Representatives {
    /// Their numbers.
    pub(super) bins: Vec<usize>,
    /// A function of the reflectances at a wavelength is the sum of its values at the representatives times
    /// these, `[wavelength][representative]`.
    shares: Vec<Vec<f64>>,
}

/// Mixtures of all states whose functions are interpolated, besides the states themselves.
const MIXTURES: usize = 16;

/// Most states that are functions of their own.
const MOST_STATES: usize = 16;

/// Chooses wavelengths until the rest of all others, weighted by their light, is at most `missed` of the
/// whole. `returned` is the part of the light of a uniform page that the face returns.
pub(super) fn representatives(
    light: PageLight<'_>,
    returned: f64,
    missed: f64,
    spreads: bool,
) -> Representatives {
    let bins = light.reflectance.first().map_or(0, Vec::len);
    let weights: Vec<f64> = (0..bins).map(|bin| weight(light, bin)).collect();
    let whole: f64 = weights.iter().sum();
    let rows: Vec<Vec<f64>> = (0..bins)
        .map(|bin| {
            features(light, bin, returned, spreads).into_iter().map(|value| weights[bin] * value).collect()
        })
        .collect();
    let square = |row: &[f64]| row.iter().map(|value| value * value).sum::<f64>();
    let size = rows.first().map_or(1.0, |row| (row.len() as f64).sqrt());
    let mut rest = rows;
    let mut chosen: Vec<usize> = Vec::new();
    // Coordinates of each row along the axes.
    let mut along: Vec<Vec<f64>> = vec![Vec::new(); bins];
    while chosen.len() < bins {
        let sizes: Vec<f64> = rest.iter().map(|row| square(row).sqrt()).collect();
        let left: f64 = sizes.iter().sum::<f64>() / size;
        let Some(next) = (0..bins).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b])) else { break };
        if (!chosen.is_empty() && left <= missed * whole) || sizes[next] <= f64::MIN_POSITIVE {
            break;
        }
        let axis: Vec<f64> = rest[next].iter().map(|value| value / sizes[next]).collect();
        for (row, along) in rest.iter_mut().zip(&mut along) {
            let part: f64 = row.iter().zip(&axis).map(|(a, b)| a * b).sum();
            row.iter_mut().zip(&axis).for_each(|(value, axis)| *value -= part * axis);
            along.push(part);
        }
        rest[next].fill(0.0);
        chosen.push(next);
    }
    if chosen.is_empty() {
        chosen.extend((bins > 0).then_some(0));
    }
    let shares = (0..bins).map(|bin| {
        let own = |k: usize| if weights[bin] > 0.0 { weights[chosen[k]] / weights[bin] } else { 0.0 };
        solved(&along[bin], &chosen, &along).iter().enumerate().map(|(k, share)| share * own(k)).collect()
    });
    Representatives { shares: shares.collect(), bins: chosen }
}

/// Coefficients of the chosen rows that sum to a row, all by their coordinates: those of chosen row k end at
/// axis k.
fn solved(row: &[f64], chosen: &[usize], along: &[Vec<f64>]) -> Vec<f64> {
    let count = row.len();
    let mut rest = row.to_vec();
    let mut coefficients = vec![0.0; chosen.len()];
    for k in (0..count).rev() {
        let own = &along[chosen[k]];
        coefficients[k] = rest[k] / own[k];
        (0..=k).for_each(|axis| rest[axis] -= coefficients[k] * own[axis]);
    }
    coefficients
}

/// Light of a wavelength: the largest of all states.
fn weight(light: PageLight<'_>, bin: usize) -> f64 {
    let of_state = |seen: &[Vec<f64>; 3]| seen.iter().map(|values| values[bin].abs()).sum::<f64>();
    light.seen.iter().map(of_state).fold(0.0, f64::max)
}

/// Functions of the reflectances at a wavelength like those of which the irradiance is composed: reflectances
/// of mixtures, their light through all orders, and products of both; for light that spreads inside the
/// pixels, also their products with the roots of reflectances.
fn features(light: PageLight<'_>, bin: usize, returned: f64, spreads: bool) -> Vec<f64> {
    let states = light.reflectance.len();
    let rho = |state: usize| returned * light.reflectance[state][bin];
    // Fractions that depend on states and mixtures as if at random.
    let share = |mixture: usize, state: usize| {
        let wave = 0.618_034 * (1 + mixture) as f64 * (1.0 + 1.324_718 * state as f64);
        (wave - wave.floor()).powi(3)
    };
    let mixed = |mixture: usize| {
        let total: f64 = (0..states).map(|state| share(mixture, state)).sum();
        (0..states).map(|state| share(mixture, state) * rho(state)).sum::<f64>() / total.max(1e-9)
    };
    let parts: Vec<f64> = (0..states.min(MOST_STATES)).map(rho).chain((0..MIXTURES).map(mixed)).collect();
    let mut all = vec![1.0];
    for (number, own) in parts.iter().enumerate() {
        let other = parts[(number + 1 + number / 3) % parts.len()];
        let orders = 1.0 / (1.0 - own);
        all.extend([*own, orders, own * other, orders * other, own * other * other]);
    }
    for (state, reflectance) in light.reflectance.iter().enumerate().filter(|_| spreads).take(MOST_STATES) {
        let root = reflectance[bin].max(0.0).sqrt();
        let (own, other) = (parts[state], parts[(7 * state + 3) % parts.len()]);
        all.extend([root, root * own, root * other, root / (1.0 - other), root * other * other]);
    }
    all
}

impl Representatives {
    /// Weights of the representatives in a sum over wavelengths, `[state][X, Y, Z][representative]`.
    pub(super) fn weights(&self, seen: &[[Vec<f64>; 3]]) -> Vec<[Vec<f32>; 3]> {
        let of = |values: &Vec<f64>| {
            let mut sums = vec![0.0; self.bins.len()];
            for (value, shares) in values.iter().zip(&self.shares) {
                sums.iter_mut().zip(shares).for_each(|(sum, share)| *sum += value * share);
            }
            sums.into_iter().map(|sum| sum as f32).collect()
        };
        seen.iter().map(|colours| colours.each_ref().map(of)).collect()
    }
}
