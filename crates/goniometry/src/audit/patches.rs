//! Quality of a matrix of patches: sums over the patches, without interpolation.
//!
//! The hemispherical value for light from one patch is the sum of value x projected solid angle over the
//! outgoing patches. That of a ring is the mean over its patches. Details finer than a patch, such as
//! half-widths and haze, are unknown.

use super::{Audit, FAINT, Incidence};
use crate::geometry::patch_centre;
use crate::{Ring, patch_count, projected_solid_angle};

/// Audits the values `[in][out]` of one channel.
pub(super) fn audit([incoming, outgoing]: [&[Ring]; 2], values: &[f64]) -> Audit {
    let omega = projected_solid_angle(outgoing);
    let columns: Vec<&[f64]> = values.chunks_exact(omega.len().max(1)).collect();
    let peak = values.iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max);
    let count = |is: fn(&f64) -> bool| values.iter().filter(|value| is(value)).count();
    let lit = |value: &&f64| **value > 0.0;
    let thetas: Vec<f64> =
        (0..omega.len()).map(|patch| patch_centre(outgoing, patch).map_or(0.0, |to| to.theta_deg)).collect();
    let with_theta = || columns.iter().flat_map(|column| column.iter().zip(&thetas));
    let dark_beyond_deg =
        with_theta().filter(|(value, _)| **value > 0.0).map(|(_, theta)| *theta).fold(0.0, f64::max);
    // Haze and clarity stay unknown: the patch about the direct beam is wider than the cone that haze
    // excludes.
    Audit {
        cells: values.len(),
        lit: values.iter().filter(lit).count(),
        unmeasured: count(|value| value.is_nan()),
        negative: count(|value| *value < 0.0),
        dark_beyond_deg,
        holes: with_theta()
            .filter(|(value, theta)| positive(**value) == 0.0 && **theta < dark_beyond_deg)
            .count(),
        range: [values.iter().filter(lit).copied().fold(f64::INFINITY, f64::min), peak],
        asymmetry: asymmetry([incoming, outgoing], &columns),
        reciprocity: (incoming == outgoing).then(|| reciprocity(incoming, &columns, &omega, peak)).flatten(),
        incidences: incidences([incoming, outgoing], &columns, &omega),
        ..Audit::empty()
    }
}

/// Returns the value, or 0 if it is NaN or negative.
fn positive(value: f64) -> f64 {
    value.max(0.0)
}

/// Returns one incidence for each ring: the mean over its patches.
fn incidences([incoming, outgoing]: [&[Ring]; 2], columns: &[&[f64]], omega: &[f64]) -> Vec<Incidence> {
    let mut first = 0;
    let ring = |ring: &Ring| {
        let patches = first..first + ring.patches;
        first = patches.end;
        let mean = |of: &dyn Fn(usize) -> f64| patches.clone().map(of).sum::<f64>() / ring.patches as f64;
        let sum = |patch: usize| {
            columns[patch].iter().zip(omega).map(|(f, omega)| positive(*f) * omega).sum::<f64>()
        };
        let specular = |patch: usize| {
            let to = patch_centre(incoming, patch).and_then(|to| crate::patch_of(outgoing, to));
            to.map_or(0.0, |to| positive(columns[patch][to]))
        };
        let integral = mean(&sum);
        let theta_deg = patch_centre(incoming, patches.start).map_or(0.0, |from| from.theta_deg);
        Incidence::of_cells(theta_deg, integral, mean(&specular))
    };
    incoming.iter().map(ring).collect()
}

/// Relative root mean square difference of values that should be equal in an isotropic sample: pairs of
/// patches of the same rings with the same azimuth difference, in either sense.
fn asymmetry([incoming, outgoing]: [&[Ring]; 2], columns: &[&[f64]]) -> f64 {
    let (mut differences, mut squares, mut first_in) = (0.0, 0.0, 0);
    for from in incoming {
        let mut first_out = 0;
        for to in outgoing {
            // Azimuth differences are counted in a common fraction of 360 deg of both rings.
            let steps = from.patches * to.patches;
            let mut classes = vec![(0.0, 0.0, 0.0); steps / 2 + 1];
            for (i, column) in columns[first_in..first_in + from.patches].iter().enumerate() {
                for (o, value) in column[first_out..first_out + to.patches].iter().enumerate() {
                    let turn = (o * from.patches + steps - i * to.patches) % steps;
                    let (count, sum, square) = &mut classes[turn.min(steps - turn)];
                    let value = positive(*value);
                    (*count, *sum, *square) = (*count + 1.0, *sum + value, *square + value * value);
                }
            }
            for (count, sum, square) in classes.into_iter().filter(|(count, ..)| *count > 0.0) {
                differences += (square - sum * sum / count).max(0.0);
                squares += sum * sum / count;
            }
            first_out += to.patches;
        }
        first_in += from.patches;
    }
    if squares > 0.0 { f64::sqrt(differences / squares) } else { 0.0 }
}

/// Difference of f(i, o) and f(o, i) of one basis: root mean square, weighted by the light, and maximum.
fn reciprocity(rings: &[Ring], columns: &[&[f64]], omega: &[f64], peak: f64) -> Option<[f64; 2]> {
    // Incident patch of the light that retraces its path to a patch; incident patches are rotated by 180 deg.
    let turned = |patch: usize| {
        let back = patch_centre(rings, patch)?.specular();
        crate::patch_of(rings, back)
    };
    let turned: Vec<usize> = (0..patch_count(rings)).map(turned).collect::<Option<_>>()?;
    let (mut squares, mut sizes, mut worst) = (0.0, 0.0, 0.0_f64);
    for (i, column) in columns.iter().enumerate() {
        for (o, a) in column.iter().enumerate() {
            let (a, b) = (positive(*a), positive(columns[turned[o]][turned[i]]));
            if a.min(b) > FAINT * peak {
                let (weight, mean) = (omega[i] * omega[o], 0.5 * (a + b));
                squares += weight * (a - b).powi(2);
                sizes += weight * mean * mean;
                worst = worst.max((a - b).abs() / mean);
            }
        }
    }
    (sizes > 0.0).then(|| [f64::sqrt(squares / sizes), worst])
}
