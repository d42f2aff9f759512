//! Rings of patches about the normal (Klems 1994, ASHRAE Trans. 100(1)), as used by WINDOW and Radiance.
//!
//! Patch k of a ring of n is centred on azimuth 360 k/n. The incident patches are rotated
//! by 180 deg: regularly transmitted and specularly reflected light has the same patch number on both sides.

use std::f64::consts::PI;

use crate::Direction;

/// Ring of patches; it ends where the next begins, the last at 90 deg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    /// Inner edge, degrees from the normal.
    pub from_deg: f64,
    /// Number of patches; the first is centred on azimuth 0.
    pub patches: usize,
}

const fn ring(from_deg: f64, patches: usize) -> Ring {
    Ring { from_deg, patches }
}

/// Full Klems basis, 145 patches.
pub const KLEMS_FULL: [Ring; 9] = [
    ring(0.0, 1),
    ring(5.0, 8),
    ring(15.0, 16),
    ring(25.0, 20),
    ring(35.0, 24),
    ring(45.0, 24),
    ring(55.0, 24),
    ring(65.0, 16),
    ring(75.0, 12),
];

/// Half Klems basis, 73 patches.
pub const KLEMS_HALF: [Ring; 7] = [
    ring(0.0, 1),
    ring(6.5, 8),
    ring(19.5, 12),
    ring(32.5, 16),
    ring(46.5, 20),
    ring(61.5, 12),
    ring(76.5, 4),
];

/// Quarter Klems basis, 41 patches.
pub const KLEMS_QUARTER: [Ring; 5] =
    [ring(0.0, 1), ring(9.0, 8), ring(27.0, 12), ring(46.0, 12), ring(66.0, 8)];

/// Number of patches.
pub fn patch_count(rings: &[Ring]) -> usize {
    rings.iter().map(|ring| ring.patches).sum()
}

/// Index of the patch that contains an outgoing direction. For an incident direction, pass its
/// [`Direction::specular`].
pub fn patch_of(rings: &[Ring], direction: Direction) -> Option<usize> {
    let number = rings.partition_point(|ring| ring.from_deg <= direction.theta_deg).checked_sub(1)?;
    let n = rings[number].patches;
    if n == 0 || direction.theta_deg > 90.0 {
        return None;
    }
    let around = (direction.phi_deg.rem_euclid(360.0) / 360.0 * n as f64).round() as usize % n;
    Some(patch_count(&rings[..number]) + around)
}

/// Projected solid angle of each patch, sr: pi (cos^2 t0 - cos^2 t1)/n, in the patches' order; the sum is pi.
pub fn projected_solid_angle(rings: &[Ring]) -> Vec<f64> {
    let of_ring = |(k, ring): (usize, &Ring)| {
        let to_deg = rings.get(k + 1).map_or(90.0, |next| next.from_deg);
        let [c0, c1] = [ring.from_deg, to_deg].map(|theta| theta.to_radians().cos().powi(2));
        std::iter::repeat_n(PI * (c0 - c1) / ring.patches as f64, ring.patches)
    };
    rings.iter().enumerate().flat_map(of_ring).collect()
}

/// Centre of a patch; for the patch about the normal, the normal.
pub(crate) fn patch_centre(rings: &[Ring], mut patch: usize) -> Option<Direction> {
    for (k, ring) in rings.iter().enumerate() {
        if patch < ring.patches {
            let to_deg = rings.get(k + 1).map_or(90.0, |next| next.from_deg);
            let theta_deg = if ring.patches == 1 { ring.from_deg } else { (ring.from_deg + to_deg) / 2.0 };
            return Some(Direction::new(theta_deg, 360.0 * patch as f64 / ring.patches as f64));
        }
        patch -= ring.patches;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Projected solid angles of the full basis as published.
    #[test]
    fn klems_bases_have_published_counts_and_solid_angles() {
        for (rings, count) in [(&KLEMS_FULL[..], 145), (&KLEMS_HALF[..], 73), (&KLEMS_QUARTER[..], 41)] {
            assert_eq!(patch_count(rings), count);
            assert!((projected_solid_angle(rings).iter().sum::<f64>() - PI).abs() < 1e-12);
            for patch in 0..count {
                assert_eq!(patch_of(rings, patch_centre(rings, patch).unwrap()), Some(patch));
            }
        }
        let omega = projected_solid_angle(&KLEMS_FULL);
        assert!((omega[0] - 0.0238639).abs() < 1e-7 && (omega[1] - 0.0233229).abs() < 1e-7, "{omega:?}");
    }
}
