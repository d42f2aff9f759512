//! Means between patches of what an isotropic sample scatters on rings about the mirror direction.
//!
//! Both sides are averaged: light over the inclinations and azimuths of its patch, and viewers over theirs. A
//! lobe may be much narrower than a patch, because the rings follow it. Light of a patch comes evenly from
//! its projected solid angle, so that the means of a reciprocal sample are symmetric. Factors close to 1 give each
//! column the sum of the light that the sample scatters. Cells of the rings cross the edges of patches: a mean is the light that arrives, over
//! the solid angle of the same cells, so that a perfect diffuser is the same between all patches.

use std::f64::consts::PI;

use papilio_optics::{Beta, Scatterer};

use crate::geometry::projected_solid_angle;
use crate::patch_turned::turned_means;
use crate::{
    Changes, GoniometryError, MeasuredPart, Preparation, Ring, SpecularGrid, Symmetry, kernel, patch_count,
};

/// Nodes and weights of Gauss and Legendre's rule on 0 to 1.
pub(crate) const GAUSS: [[f64; 2]; 4] = [
    [0.069_431_844_202_973_71, 0.173_927_422_568_726_93],
    [0.330_009_478_207_571_87, 0.326_072_577_431_273_07],
    [0.669_990_521_792_428_1, 0.326_072_577_431_273_07],
    [0.930_568_155_797_026_3, 0.173_927_422_568_726_93],
];

/// Parts of a cell of the rings along each of its axes.
const PARTS: usize = 3;

/// Inclinations about each one of [`ring_patch_lights`], between which a lobe keeps its shape in direction
/// cosines: a narrow lobe at the edge of a patch scatters into the next one.
const SHIFTS: usize = 10;

/// Azimuths from 0 to 180 deg at which scattered light is collected.
pub(crate) const AZIMUTHS: usize = 361;

/// Cosine of an inclination up to which a direction is on the horizon.
const HORIZON: f64 = 1e-9;

/// Light that arrives in each ring, by azimuth from the mirror direction.
type Arrived = Vec<[f64; AZIMUTHS]>;

/// Returns the inclinations of the light that [`ring_patch_means`] needs, degrees, ascending: four for each
/// ring of patches.
pub fn ring_patch_lights(rings: &[Ring]) -> Vec<f64> {
    let of_ring = |k: usize| {
        let [low, high] = squared_sines(rings, k);
        GAUSS.map(|[x, _]| (low + (high - low) * x).sqrt().asin().to_degrees())
    };
    (0..rings.len()).flat_map(of_ring).collect()
}

/// Squared sines of the edges of a ring.
fn squared_sines(rings: &[Ring], k: usize) -> [f64; 2] {
    let edges = [rings[k].from_deg, rings.get(k + 1).map_or(90.0, |next| next.from_deg)];
    edges.map(|theta| theta.to_radians().sin().powi(2))
}

/// Returns the mean of f between patches, `[in][out]`, 1/sr, of a display for each channel: its values on `grid`,
/// whose incidences are [`ring_patch_lights`], and the fraction of the light that each incidence scatters. A display
/// is reciprocal: what the rule of the rings leaves of an asymmetry is averaged. Of a display that depends on azimuth, the grid has
/// rotations and no symmetry; light that is scattered is then that of each rotation and incidence.
///
/// `None` if the lengths do not match.
pub fn ring_patch_means(
    grid: &SpecularGrid,
    channels: &[(&[f64], &[f64])],
    rings: &[Ring],
) -> Option<Vec<Vec<f64>>> {
    if grid.symmetry == Symmetry::None {
        let means = turned_means(grid, channels, rings)?;
        return Some(means.iter().map(|(means, totals)| symmetric(means, totals, rings)).collect());
    }
    let means = arrived(grid, channels, rings)?;
    let of_patches = |totals: &[f64]| of_patches(totals, rings).collect::<Vec<f64>>();
    Some(means.iter().map(|(means, totals)| symmetric(means, &of_patches(totals), rings)).collect())
}

/// Fineness of the totals of a lobe.
const FINENESS: usize = 5;
/// Azimuths about the mirror direction at which [`lobe_patch_means`] reads a lobe, degrees from 0 to 180.
const LOBE_AZIMUTHS: u32 = 37;
/// Steps of its distances from the mirror direction: part of the lobe's width near the peak, part of the distance
/// beyond, and degrees at most.
const LOBE_STEPS: (f64, f64) = (0.05, 2.0);

/// Returns the mean of f between patches, `[in][out]`, 1/sr, of one channel of an isotropic sample: of the smooth
/// lobe that a display has of it ([`kernel`]). Tails are extrapolated, and the last lobe is used beyond the largest
/// incidence.
///
/// # Errors
/// Those of [`kernel`].
pub fn lobe_patch_means(
    part: &MeasuredPart,
    channel: usize,
    rings: &[Ring],
) -> Result<(Vec<f64>, Changes), GoniometryError> {
    let preparation = Preparation { extrapolate: Some(1.0), ..Preparation::default() };
    let (lobe, changes) = kernel(part, channel, &preparation, &[])?;
    let (step, most) = LOBE_STEPS;
    let mut radials_deg = vec![0.0];
    while let Some(last) = radials_deg.last().copied().filter(|last| *last < 180.0) {
        let wide: f64 = lobe.width().to_degrees();
        radials_deg.push((last + (step * wide.max(last)).min(most)).min(180.0));
    }
    let azimuths_deg =
        (0..LOBE_AZIMUTHS).map(|k| 180.0 * f64::from(k) / f64::from(LOBE_AZIMUTHS - 1)).collect();
    let grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: ring_patch_lights(rings),
        azimuths_deg,
        radials_deg,
        symmetry: Symmetry::Plane,
    };
    let from = |theta_deg: f64| Beta { x: theta_deg.to_radians().sin(), y: 0.0 };
    let mut values = Vec::with_capacity(grid.cells());
    for theta_deg in &grid.incidences_deg {
        for azimuth_deg in &grid.azimuths_deg {
            values.extend(grid.radials_deg.iter().map(|radial_deg| {
                let to = SpecularGrid::direction(*theta_deg, *azimuth_deg, *radial_deg);
                to.map_or(0.0, |to| lobe.evaluate(from(*theta_deg), to.leaving()))
            }));
        }
    }
    let totals: Vec<f64> =
        grid.incidences_deg.iter().map(|theta_deg| lobe.albedo_by(from(*theta_deg).x, FINENESS)).collect();
    let mut means = arrived(&grid, &[(&values, &totals)], rings).unwrap_or_default();
    let (mut means, totals) = means.pop().ok_or(GoniometryError::NoGrid)?;
    let omega = projected_solid_angle(rings);
    for (column, total) in means.chunks_exact_mut(omega.len()).zip(of_patches(&totals, rings)) {
        let sum: f64 = column.iter().zip(&omega).map(|(f, omega)| f * omega).sum();
        if sum > 0.0 {
            column.iter_mut().for_each(|f| *f *= total / sum);
        }
    }
    Ok((means, changes))
}

/// Means of f between patches, `[in][out]`, 1/sr, and the fraction of the light that each ring scatters.
type Means = (Vec<f64>, Vec<f64>);

/// Returns [`Means`] of each channel: its values on `grid`, and the fraction of the light that each incidence
/// scatters; `None` if the lengths do not match.
fn arrived(grid: &SpecularGrid, channels: &[(&[f64], &[f64])], rings: &[Ring]) -> Option<Vec<Means>> {
    let lights = GAUSS.len() * rings.len();
    let fits = |(values, totals): &(&[f64], &[f64])| totals.len() == lights && values.len() == grid.cells();
    if grid.incidences_deg.len() != lights || !channels.iter().all(fits) {
        return None;
    }
    // A perfect diffuser, of which all means are known.
    let (one, all) = (vec![1.0; grid.cells()], vec![1.0; lights]);
    let channels: Vec<(&[f64], &[f64])> = channels.iter().copied().chain([(&one[..], &all[..])]).collect();
    let none = || vec![vec![[0.0; AZIMUTHS]; rings.len()]; rings.len()];
    let mut arrived: Vec<Vec<Arrived>> = channels.iter().map(|_| none()).collect();
    let mut scattered = vec![vec![0.0; rings.len()]; channels.len()];
    for light in 0..lights {
        let (ring, weight) = (light / GAUSS.len(), GAUSS[light % GAUSS.len()][1]);
        for (channel, found) in collected(grid, light, &channels, rings).iter().enumerate() {
            let total = channels[channel].1[light];
            let sum: f64 = found.iter().flatten().sum();
            let scale = if sum > 0.0 { weight * total / sum } else { 0.0 };
            scattered[channel][ring] += weight * total;
            for (mean, found) in arrived[channel][ring].iter_mut().zip(found) {
                mean.iter_mut().zip(found).for_each(|(mean, found)| *mean += scale * found);
            }
        }
    }
    let white = between(&arrived.pop()?, rings);
    let of_channel = |(arrived, scattered): (&Vec<Arrived>, Vec<f64>)| {
        (between(arrived, rings).iter().zip(&white).map(|(f, white)| f / white / PI).collect(), scattered)
    };
    Some(arrived.iter().zip(scattered).map(of_channel).collect())
}

/// Differences of the sine of inclination between light about an incidence, given by its index, and this
/// incidence.
fn shifts(rings: &[Ring], light: usize) -> [f64; SHIFTS] {
    let (ring, node) = (light / GAUSS.len(), light % GAUSS.len());
    let [low, high] = squared_sines(rings, ring);
    let before: f64 = GAUSS[..node].iter().map(|[_, weight]| weight).sum();
    let [x, weight] = GAUSS[node];
    let sine = |x: f64| (low + (high - low) * x).sqrt();
    std::array::from_fn(|k| sine(before + weight * (k as f64 + 0.5) / SHIFTS as f64) - sine(x))
}

/// Returns the light about one incidence, given by its index, that arrives in each ring, for each channel. It
/// is not normalised.
fn collected(
    grid: &SpecularGrid,
    light: usize,
    channels: &[(&[f64], &[f64])],
    rings: &[Ring],
) -> Vec<Arrived> {
    let mut found = vec![vec![[0.0; AZIMUTHS]; rings.len()]; channels.len()];
    let values: Vec<&[f64]> = channels.iter().map(|(values, _)| *values).collect();
    collect(grid, light, &values, rings, |(ring, node, beyond), _, light| {
        for (found, light) in found.iter_mut().zip(light) {
            found[ring][node] += light * (1.0 - beyond);
            found[ring][node + 1] += light * beyond;
        }
    });
    found
}

/// Calls `add` with the light about one incidence, given by its index, that arrives at a place ([`place`]): whether it is on the other side of
/// the plane of incidence, at negative azimuths, and the light of each channel.
pub(crate) fn collect(
    grid: &SpecularGrid,
    light: usize,
    channels: &[&[f64]],
    rings: &[Ring],
    mut add: impl FnMut((usize, usize, f64), bool, &[f64]),
) {
    let (azimuths, radials) = (&grid.azimuths_deg, &grid.radials_deg);
    let incidence_deg = grid.incidences_deg[light];
    let shifts = shifts(rings, light);
    // On the horizon, where light has no value, rounding decides whether a direction is above it.
    let is_above = |a: usize, r: usize| {
        SpecularGrid::direction(incidence_deg, azimuths[a], radials[r])
            .is_some_and(|to| to.vector()[2] > HORIZON)
    };
    let row = light * azimuths.len();
    for a in 1..azimuths.len() {
        for r in 1..radials.len() {
            let corners = [(a - 1, r - 1), (a - 1, r), (a, r - 1), (a, r)];
            let above = corners.map(|(a, r)| f64::from(u8::from(is_above(a, r))));
            if above == [0.0; 4] {
                continue;
            }
            let [width, length] = [azimuths[a] - azimuths[a - 1], radials[r] - radials[r - 1]];
            for part in 0..PARTS * PARTS {
                let [x, y] = [part % PARTS, part / PARTS].map(|k| (k as f64 + 0.5) / PARTS as f64);
                let radial = radials[r - 1] + x * length;
                let Some(to) = SpecularGrid::direction(incidence_deg, azimuths[a - 1] + y * width, radial)
                else {
                    continue;
                };
                let mut weights = [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y];
                weights.iter_mut().zip(above).for_each(|(weight, above)| *weight *= above);
                let [along, across, up] = to.vector();
                let size = radial.to_radians().sin() * length * width * up / weights.iter().sum::<f64>();
                let light: Vec<f64> = channels
                    .iter()
                    .map(|values| {
                        let value = |(a, r): (usize, usize)| values[(row + a) * radials.len() + r].max(0.0);
                        size * corners
                            .iter()
                            .zip(weights)
                            .map(|(corner, weight)| weight * value(*corner))
                            .sum::<f64>()
                    })
                    .collect();
                for shift in shifts {
                    add(place([along + shift, across], rings), across < 0.0, &light);
                }
            }
        }
    }
}

/// Returns the ring of a direction, given by direction cosines, and its azimuth: the collecting azimuth below
/// it, and the fraction of the distance to the next one. What is shifted out of the hemisphere is in the last
/// ring.
fn place([x, y]: [f64; 2], rings: &[Ring]) -> (usize, usize, f64) {
    let theta_deg = x.hypot(y).min(1.0).asin().to_degrees();
    let ring = rings.partition_point(|ring| ring.from_deg <= theta_deg).saturating_sub(1);
    let place = y.abs().atan2(x).to_degrees() / 180.0 * (AZIMUTHS - 1) as f64;
    let node = (place as usize).min(AZIMUTHS - 2);
    (ring, node, place - node as f64)
}

/// Returns the means of f between patches, `[in][out]`, from the light that arrives in each ring.
fn between(arrived: &[Arrived], rings: &[Ring]) -> Vec<f64> {
    let omega = projected_solid_angle(rings);
    let mut means = Vec::with_capacity(omega.len() * omega.len());
    for (incoming, of_ring) in rings.iter().zip(arrived) {
        for number in 0..incoming.patches {
            let from = 360.0 * number as f64 / incoming.patches as f64;
            let mut patch = 0;
            for (outgoing, light) in rings.iter().zip(of_ring) {
                let widths = [incoming, outgoing].map(|ring| 360.0 / ring.patches as f64);
                for k in 0..outgoing.patches {
                    let apart = 360.0 * k as f64 / outgoing.patches as f64 - from;
                    let both = |(node, light): (usize, &f64)| {
                        let turn = 180.0 * node as f64 / (AZIMUTHS - 1) as f64;
                        0.5 * light * (overlap(apart - turn, widths) + overlap(apart + turn, widths))
                    };
                    means.push(light.iter().enumerate().map(both).sum::<f64>() / omega[patch]);
                    patch += 1;
                }
            }
        }
    }
    means
}

/// Returns the fraction of an arc of the first width that lies in an arc of the second width, whose middles
/// are `apart` degrees apart.
pub(crate) fn overlap(apart: f64, [width, other]: [f64; 2]) -> f64 {
    let off = (apart + 180.0).rem_euclid(360.0) - 180.0;
    let both = |off: f64| (0.5 * (width + other) - off.abs()).clamp(0.0, width.min(other));
    // The arcs may meet on either side of the circle.
    ((both(off) + both(360.0 - off.abs())) / width).min(1.0)
}

/// The number of each ring, for each of its patches.
fn of_patches(of_rings: &[f64], rings: &[Ring]) -> impl Iterator<Item = f64> {
    rings.iter().zip(of_rings).flat_map(|(ring, of_ring)| std::iter::repeat_n(*of_ring, ring.patches))
}

/// Number of steps towards the totals, each of which halves what is missing, at least.
const STEPS: usize = 60;

/// Averages each pair of patches and its reverse, and multiplies them by factors of both patches so that each
/// column has its total.
fn symmetric(means: &[f64], totals: &[f64], rings: &[Ring]) -> Vec<f64> {
    let (count, omega) = (patch_count(rings), projected_solid_angle(rings));
    let reverse = |pair: usize| pair % count * count + pair / count;
    let found: Vec<f64> = (0..count * count).map(|pair| 0.5 * (means[pair] + means[reverse(pair)])).collect();
    let mut factors = vec![1.0; count];
    for _ in 0..STEPS {
        let next = |patch: usize| {
            let column = found[patch * count..][..count].iter().zip(&omega).zip(&factors);
            let sum: f64 = column.map(|((f, omega), factor)| f * omega * factor).sum();
            if sum > 0.0 { (factors[patch] * totals[patch].max(0.0) / sum).sqrt() } else { 0.0 }
        };
        factors = (0..count).map(next).collect();
    }
    (0..count * count).map(|pair| found[pair] * (factors[pair / count] * factors[pair % count])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, Geometry, KLEMS_FULL, ScatterMode, SphericalGrid};

    /// Means of a lobe f of the distance between viewer and mirror direction in direction cosines; `total` is
    /// what it scatters.
    fn means(f: impl Fn(f64) -> f64, total: impl Fn(f64) -> f64) -> Vec<f64> {
        let radials_deg = (0..60).map(|k| 0.1 * f64::from(k)).chain((6..=180).map(f64::from)).collect();
        let grid = SpecularGrid {
            rotations_deg: vec![0.0],
            incidences_deg: ring_patch_lights(&KLEMS_FULL),
            azimuths_deg: (0..=36).map(|k| 5.0 * f64::from(k)).collect(),
            radials_deg,
            symmetry: Symmetry::Plane,
        };
        let mut values = Vec::new();
        for incidence in &grid.incidences_deg {
            for azimuth in &grid.azimuths_deg {
                for radial in &grid.radials_deg {
                    let viewer = SpecularGrid::direction(*incidence, *azimuth, *radial);
                    let distance = viewer.map(|viewer| {
                        let [x, y, _] = viewer.vector();
                        (x - incidence.to_radians().sin()).hypot(y)
                    });
                    // As a display's table, which has no light on the horizon.
                    let is_above = viewer.is_some_and(|viewer| viewer.vector()[2] > 1e-12);
                    values.push(distance.filter(|_| is_above).map_or(0.0, &f));
                }
            }
        }
        let totals: Vec<f64> = grid.incidences_deg.iter().map(|theta| total(*theta)).collect();
        ring_patch_means(&grid, &[(&values, &totals)], &KLEMS_FULL).unwrap().remove(0)
    }

    /// Fraction of exp(-(r / width)^2) about a point at the distance sin theta from the centre that lies in
    /// the unit disc.
    fn in_disc(theta_deg: f64, width: f64) -> f64 {
        let (n, sin) = (100, theta_deg.to_radians().sin());
        let is_inside = |k: &i32| {
            let [q, turn] = [k / n, k % n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
            let r = width * (-(-q).ln_1p()).sqrt();
            let (y, x) = (2.0 * PI * turn).sin_cos();
            (sin + r * x).hypot(r * y) < 1.0
        };
        (0..n * n).filter(is_inside).count() as f64 / f64::from(n * n)
    }

    /// Mean of [`in_disc`] over the projected solid angle of each patch.
    fn mean_totals(width: f64) -> Vec<f64> {
        let of_ring = |k: usize| {
            let [low, high] = squared_sines(&KLEMS_FULL, k);
            let lights = &ring_patch_lights(&KLEMS_FULL)[4 * k..][..4];
            let inside = |theta: &f64| (low..=high).contains(&theta.to_radians().sin().powi(2));
            assert!(lights.iter().all(inside));
            let mean =
                lights.iter().zip(GAUSS).map(|(theta, [_, weight])| weight * in_disc(*theta, width)).sum();
            std::iter::repeat_n(mean, KLEMS_FULL[k].patches)
        };
        (0..9).flat_map(|k| of_ring(k).collect::<Vec<f64>>()).collect()
    }

    #[test]
    fn perfect_white_is_the_same_between_all_patches() {
        let found = means(|_| 1.0 / PI, |_| 1.0);
        for (pair, f) in found.iter().enumerate() {
            assert!((f * PI - 1.0).abs() < 1e-9, "{} to {}: {}", pair / 145, pair % 145, f * PI);
        }
    }

    /// A lobe of the same shape about the mirror direction in direction cosines, wide and narrow: columns
    /// have their totals, the matrix is symmetric, and the patch about the normal is the same to all patches
    /// of a ring. The mean between the patch about the normal and those of the next ring against a sum over
    /// pairs of points.
    #[test]
    fn lobe_has_its_totals_and_is_symmetric() {
        for width in [0.15, 0.03] {
            let lobe = |r: f64| (-(r / width).powi(2)).exp() / (PI * width * width);
            let found = means(lobe, |theta| in_disc(theta, width));
            let omega = projected_solid_angle(&KLEMS_FULL);
            let means_of_totals = mean_totals(width);
            for column in 0..145 {
                let of = &found[column * 145..][..145];
                let sum: f64 = of.iter().zip(&omega).map(|(f, omega)| f * omega).sum();
                let expected = means_of_totals[column];
                assert!((sum / expected - 1.0).abs() < 1e-9, "{column}: {sum} {expected}");
                for row in 0..145 {
                    assert_eq!(of[row], found[row * 145 + column]);
                    assert!(of[row] >= 0.0);
                }
            }
            let next = found[1];
            // Rings of other numbers of patches beside it have factors of their own.
            assert!(found[1..9].iter().all(|f| (f / next - 1.0).abs() < 1e-6));
            // Direction cosines of the patch and of the ring, at equal areas.
            let [near, far] = [5.0_f64, 15.0].map(|theta| theta.to_radians().sin().powi(2));
            let (mut sum, n) = (0.0, 100);
            for k in 0..n * n * n {
                let [a, b, c] = [k % n, k / n % n, k / n / n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
                let (r, s) = ((near * a).sqrt(), (near + (far - near) * b).sqrt());
                let (sin, cos) = (PI * c).sin_cos();
                sum += lobe((r - s * cos).hypot(s * sin)) / f64::from(n * n * n);
            }
            assert!((next / sum - 1.0).abs() < 0.002, "{width}: {next} {sum}");
        }
    }

    /// A lobe of 10 deg half width on a constant, on a grid about the normal in steps of 5, 2.5 and 5 deg, against Gauss
    /// sums between the patch about the normal and each ring, from both sides.
    #[test]
    fn lobe_on_a_coarse_grid_is_averaged_between_its_values() {
        let lobe = |square: f64| 2.0 / (1.0 + square / 0.0625).powi(2) + 0.1;
        let grid = SphericalGrid {
            theta_i_deg: (0..18).map(|k| 5.0 * f64::from(k)).collect(),
            phi_i_deg: vec![0.0],
            theta_o_deg: (0..=36).map(|k| 2.5 * f64::from(k)).collect(),
            phi_o_deg: (0..=36).map(|k| 5.0 * f64::from(k)).collect(),
        };
        let mut values = Vec::new();
        for from in &grid.theta_i_deg {
            for to in &grid.theta_o_deg {
                for turn in &grid.phi_o_deg {
                    let [from, to] = [from, to].map(|theta| theta.to_radians().sin());
                    values.push(lobe(from * from + to * to + 2.0 * from * to * turn.to_radians().cos()));
                }
            }
        }
        let part = MeasuredPart {
            way: ScatterMode::FrontReflection,
            channels: vec![Channel::Monochrome],
            geometry: Geometry::Spherical(grid),
            values,
            tis: Vec::new(),
        };
        let means = lobe_patch_means(&part, 0, &KLEMS_FULL).unwrap().0;
        let mut first = 0;
        for (k, ring) in KLEMS_FULL.iter().enumerate() {
            let [near, far] = [0, k].map(|k| squared_sines(&KLEMS_FULL, k));
            let mut mean = 0.0;
            for [x, one] in GAUSS {
                for [y, other] in GAUSS {
                    let [a, b] = [(near, x), (far, y)].map(|([low, high], x)| low + (high - low) * x);
                    let around =
                        |turn: i32| a + b - 2.0 * (a * b).sqrt() * (PI * f64::from(turn) / 90.0).cos();
                    mean += one * other * (0..180).map(|turn| lobe(around(turn))).sum::<f64>() / 180.0;
                }
            }
            for (there, back) in (first..first + ring.patches).map(|k| (means[k], means[145 * k])) {
                assert!((there / mean - 1.0).abs() < 1.5e-3, "{k}: {there} {mean}");
                assert!((back / mean - 1.0).abs() < 1.5e-3, "{k}: {back} {mean}");
            }
            first += ring.patches;
        }
    }
}
