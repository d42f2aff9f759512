//! Tables of one's own with azimuths: harmonics of the azimuth at each inclination.
//!
//! Values at N azimuths in equal steps over half a turn determine the harmonics 1, cos 2 phi, sin 2 phi, ... up to N/2 (of the last one of an
//! even number, only the wave that is not 0 at the azimuths): their sum returns the values, and is the smoothest function that does. Between
//! inclinations, harmonics are interpolated as the values are. Where the sum leaves 0 to 1 between the azimuths, the harmonics are reduced until it
//! does not.

use papilio_transport::{AngularTable, Nodes};

use crate::scene::TablePixel;

/// Largest harmonic that is left out at the end of the series, as a reflectance: files are rounded.
const LEFT_OUT: f64 = 1e-5;

/// Returns the harmonics of a table with azimuths.
pub(super) fn table(pixel: &TablePixel, nodes: Nodes, bins: usize) -> AngularTable {
    let (thetas, states) = (pixel.theta_deg.len(), pixel.states.len());
    let waves = waves(&pixel.phi_deg);
    let mut all = vec![vec![0.0; thetas * states * bins]; waves.len()];
    for (harmonic, weights) in all.iter_mut().zip(&waves) {
        for (row, out) in harmonic.chunks_exact_mut(bins).enumerate() {
            let (theta, state) = (row / states, &pixel.states[row % states]);
            let first = theta * pixel.phi_deg.len();
            for (spectrum, weight) in state.reflectance[first..].iter().zip(weights) {
                out.iter_mut().zip(spectrum.iter()).for_each(|(sum, value)| *sum += weight * value);
            }
        }
    }
    let is_small = |harmonic: &[f64]| harmonic.iter().all(|value| value.abs() < LEFT_OUT);
    while let [_, _, _, .., cos, sin] = &all[..]
        && is_small(cos)
        && is_small(sin)
    {
        all.truncate(all.len() - 2);
    }
    let count = all.len();
    limit(&mut all);
    // As [theta][state][harmonic][wavelength].
    let rows = (0..thetas * states).flat_map(|row| all.iter().map(move |harmonic| (row, harmonic)));
    let basis: Vec<f64> =
        rows.flat_map(|(row, harmonic)| harmonic[row * bins..][..bins].iter().copied()).collect();
    let own = |k: usize| if k % (states * count) == k / (states * count) * count { 1.0 } else { 0.0 };
    AngularTable {
        nodes: Nodes::Azimuthal(Box::new(nodes), count),
        basis: basis.into(),
        mixture: (0..states * states * count).map(own).collect(),
        common: vec![0.0; bins],
    }
}

/// Returns the weight of each azimuth in each harmonic: `[harmonic][azimuth]`, in the order 1, cos 2 phi, sin 2 phi, ...
fn waves(phi_deg: &[f64]) -> Vec<Vec<f64>> {
    let count = phi_deg.len();
    let weight = |harmonic: usize, phi_deg: f64| {
        let order = harmonic.div_ceil(2);
        let (sin, cos) = (2.0 * order as f64 * phi_deg.to_radians()).sin_cos();
        let wave = if harmonic.is_multiple_of(2) && harmonic > 0 { sin } else { cos };
        // The mean, and the last of an even number, have their values in one wave instead of two.
        let is_alone = order == 0 || 2 * order == count;
        if is_alone { wave / count as f64 } else { 2.0 * wave / count as f64 }
    };
    let of = |harmonic: usize| phi_deg.iter().map(|phi| weight(harmonic, *phi)).collect();
    (0..=2 * (count / 2)).map(of).collect()
}

/// Reduces the harmonics of each reflectance so that it lies between 0 and 1 at all azimuths; `[harmonic][reflectance]`.
fn limit(all: &mut [Vec<f64>]) {
    /// Azimuths at which it is evaluated, for each harmonic.
    const FINE: usize = 8;
    let Some((means, harmonics)) = all.split_first_mut() else { return };
    let azimuths = FINE * (harmonics.len() + 1);
    let wave = |harmonic: usize, azimuth: usize| {
        let turn = std::f64::consts::TAU * azimuth as f64 / azimuths as f64;
        let (sin, cos) = ((harmonic / 2 + 1) as f64 * turn).sin_cos();
        if harmonic.is_multiple_of(2) { cos } else { sin }
    };
    let waves: Vec<Vec<f64>> =
        (0..azimuths).map(|at| (0..harmonics.len()).map(|k| wave(k, at)).collect()).collect();
    for (at, mean) in means.iter().enumerate() {
        let room = mean.min(1.0 - mean);
        if harmonics.iter().map(|harmonic| harmonic[at].abs()).sum::<f64>() <= room {
            continue;
        }
        let swing = |waves: &Vec<f64>| -> f64 {
            waves.iter().zip(harmonics.iter()).map(|(wave, harmonic)| wave * harmonic[at]).sum()
        };
        let ends = |(low, high): (f64, f64), x: f64| (low.min(x), high.max(x));
        let (low, high) = waves.iter().map(swing).fold((0.0, 0.0), ends);
        let within = |swing: f64, room: f64| if swing > room { room.max(0.0) / swing } else { 1.0 };
        let part = within(-low, *mean).min(within(high, 1.0 - mean));
        if part < 1.0 {
            harmonics.iter_mut().for_each(|harmonic| harmonic[at] *= part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mean of 0.1 with a swing of 0.2 becomes one of 0.1; what stays within 0 to 1 is not changed.
    #[test]
    fn harmonics_stay_within_0_to_1() {
        let mut all = vec![vec![0.1, 0.5, 0.9], vec![0.2, 0.3, 0.0], vec![0.0, 0.1, 0.3]];
        limit(&mut all);
        assert!((all[1][0] - 0.1).abs() < 1e-12 && all[2][0] == 0.0, "{all:?}");
        assert_eq!([all[1][1], all[2][1]], [0.3, 0.1]);
        assert!((all[2][2] - 0.1).abs() < 1e-12, "{all:?}");
    }
}
