//! Means between patches of what a sample that depends on azimuth scatters, on rings about the mirror direction.
//!
//! They are those of [`ring_patch_means`](crate::ring_patch_means), with the light of each rotation of the sample by itself: a patch of the
//! light is divided into arcs, and what each scatters is interpolated between the rotations.

use std::f64::consts::PI;

use crate::geometry::projected_solid_angle;
use crate::patch_rings::{AZIMUTHS, GAUSS, collect, overlap};
use crate::{Ring, SpecularGrid};

/// Longest arc of a patch of the light, degrees.
const LONGEST_ARC_DEG: f64 = 5.0;

/// Azimuths of a whole turn at which scattered light is collected.
const ROUND: usize = 2 * (AZIMUTHS - 1);

/// Light that arrives in each ring, by azimuth from the mirror direction, and the fraction that is scattered, of one rotation and ring of
/// the light.
#[derive(Clone)]
struct Lit {
    arrived: Vec<[f64; ROUND]>,
    scattered: f64,
}

/// Returns the means of f between patches, `[in][out]`, and the fraction of the light that each patch scatters, of each channel: its values
/// on `grid`, and the fraction that each rotation and incidence scatters; `None` if the lengths do not match.
pub(crate) fn turned_means(
    grid: &SpecularGrid,
    channels: &[(&[f64], &[f64])],
    rings: &[Ring],
) -> Option<Vec<(Vec<f64>, Vec<f64>)>> {
    let (lights, turns) = (GAUSS.len() * rings.len(), grid.rotations_deg.len());
    let fits =
        |(values, totals): &(&[f64], &[f64])| totals.len() == turns * lights && values.len() == grid.cells();
    if grid.incidences_deg.len() != lights || turns == 0 || !channels.iter().all(fits) {
        return None;
    }
    // A perfect diffuser, of which all means are known.
    let (one, all) = (vec![1.0; grid.cells()], vec![1.0; turns * lights]);
    let channels: Vec<(&[f64], &[f64])> = channels.iter().copied().chain([(&one[..], &all[..])]).collect();
    let none = Lit { arrived: vec![[0.0; ROUND]; rings.len()], scattered: 0.0 };
    let mut lit = vec![vec![none; turns * rings.len()]; channels.len()];
    let closed = SpecularGrid {
        rotations_deg: vec![0.0],
        azimuths_deg: grid.azimuths_deg.iter().copied().chain([grid.azimuths_deg.first()? + 360.0]).collect(),
        ..grid.clone()
    };
    for turn in 0..turns {
        let values: Vec<Vec<f64>> = channels.iter().map(|(values, _)| of_turn(grid, values, turn)).collect();
        let values: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
        for light in 0..lights {
            let (ring, weight) = (light / GAUSS.len(), GAUSS[light % GAUSS.len()][1]);
            let mut found = vec![vec![[0.0; ROUND]; rings.len()]; channels.len()];
            collect(&closed, light, &values, rings, |(to, node, beyond), other, light| {
                let place = |node: usize| if other { (ROUND - node) % ROUND } else { node };
                let [near, far] = [place(node), place(node + 1)];
                for (found, light) in found.iter_mut().zip(light) {
                    found[to][near] += light * (1.0 - beyond);
                    found[to][far] += light * beyond;
                }
            });
            for (channel, found) in found.iter().enumerate() {
                let total = channels[channel].1[turn * lights + light];
                let sum: f64 = found.iter().flatten().sum();
                let scale = if sum > 0.0 { weight * total / sum } else { 0.0 };
                let mean = &mut lit[channel][turn * rings.len() + ring];
                mean.scattered += weight * total;
                let pairs = mean.arrived.iter_mut().flatten().zip(found.iter().flatten());
                pairs.for_each(|(mean, found)| *mean += scale * found);
            }
        }
    }
    let white = between(grid, &lit.pop()?, rings).0;
    let of_channel = |lit: &Vec<Lit>| {
        let (means, totals) = between(grid, lit, rings);
        (means.iter().zip(&white).map(|(f, white)| f / white / PI).collect(), totals)
    };
    Some(lit.iter().map(of_channel).collect())
}

/// Returns the values of one rotation, with those of the first azimuth again at the end.
fn of_turn(grid: &SpecularGrid, values: &[f64], turn: usize) -> Vec<f64> {
    let radials = grid.radials_deg.len();
    let of_incidence = grid.azimuths_deg.len() * radials;
    let own = &values[turn * grid.incidences_deg.len() * of_incidence..];
    let rows = own.chunks_exact(of_incidence).take(grid.incidences_deg.len());
    rows.flat_map(|row| row.iter().chain(&row[..radials]).copied()).collect()
}

/// Returns the means of f between patches, `[in][out]`, and the fraction of the light that each patch scatters.
fn between(grid: &SpecularGrid, lit: &[Lit], rings: &[Ring]) -> (Vec<f64>, Vec<f64>) {
    let omega = projected_solid_angle(rings);
    let (mut means, mut totals) = (Vec::with_capacity(omega.len().pow(2)), Vec::with_capacity(omega.len()));
    for (ring, incoming) in rings.iter().enumerate() {
        let width = 360.0 / incoming.patches as f64;
        let arcs = (width / LONGEST_ARC_DEG).ceil().max(1.0);
        for number in 0..incoming.patches {
            let (mut row, mut total) = (vec![0.0; omega.len()], 0.0);
            for arc in 0..arcs as usize {
                let towards = width * (number as f64 - 0.5 + (arc as f64 + 0.5) / arcs);
                // Light that travels towards this azimuth has the mirror direction there.
                for (turn, weight) in turns(&grid.rotations_deg, -towards) {
                    let lit = &lit[turn * rings.len() + ring];
                    total += weight / arcs * lit.scattered;
                    let mut patch = 0;
                    for (outgoing, arrived) in rings.iter().zip(&lit.arrived) {
                        let widths = [width / arcs, 360.0 / outgoing.patches as f64];
                        for k in 0..outgoing.patches {
                            row[patch] +=
                                weight / arcs * within(arrived, widths[1] * k as f64 - towards, widths);
                            patch += 1;
                        }
                    }
                }
            }
            means.extend(row.iter().zip(&omega).map(|(light, omega)| light / omega));
            totals.push(total);
        }
    }
    (means, totals)
}

/// Returns the light of an arc of the first width that arrives in an arc of the second width, whose middles are `apart` degrees apart.
fn within(arrived: &[f64; ROUND], apart: f64, widths: [f64; 2]) -> f64 {
    let step = 360.0 / ROUND as f64;
    let reach = 0.5 * (widths[0] + widths[1]);
    let of = |node: i64| {
        let light = arrived[node.rem_euclid(ROUND as i64) as usize];
        if light > 0.0 { light * overlap(apart - step * node as f64, widths) } else { 0.0 }
    };
    if reach >= 180.0 {
        return (0..ROUND as i64).map(of).sum();
    }
    let [first, last] = [(apart - reach) / step, (apart + reach) / step];
    (first.floor() as i64..=last.ceil() as i64).map(of).sum()
}

/// Returns the two rotations next to one, degrees, with their weights.
fn turns(rotations_deg: &[f64], wanted_deg: f64) -> [(usize, f64); 2] {
    let count = rotations_deg.len();
    let first = rotations_deg.first().copied().unwrap_or(0.0);
    let wanted = first + (wanted_deg - first).rem_euclid(360.0);
    let after = rotations_deg.partition_point(|rotation| *rotation <= wanted);
    let (before, next) = ((after + count - 1) % count, after % count);
    let gap = (rotations_deg[next] - rotations_deg[before]).rem_euclid(360.0);
    let beyond = if gap > 0.0 { (wanted - rotations_deg[before]) / gap } else { 0.0 };
    [(before, 1.0 - beyond), (next, beyond)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{KLEMS_FULL, Symmetry, ring_patch_lights, ring_patch_means};

    /// A lobe that is the same at all azimuths has the means of its half, and of one that is stronger in the light from azimuth 45 deg than from
    /// 135 deg, the means of the patches around these azimuths are.
    #[test]
    fn means_are_those_of_one_side_and_follow_the_azimuth() {
        let lobe = |theta: f64, to: Option<crate::Direction>| {
            to.map(|to| to.vector()).filter(|to| to[2] > 1e-12).map_or(0.0, |[x, y, _]| {
                let square = (x - theta.to_radians().sin()).powi(2) + y * y;
                (1.0 + square / 0.09).powf(-1.5)
            })
        };
        let lights = ring_patch_lights(&KLEMS_FULL);
        let radials_deg: Vec<f64> =
            (0..10).map(|k| 3.0 * f64::from(k)).chain((6..=36).map(|k| 5.0 * f64::from(k))).collect();
        let half = SpecularGrid {
            rotations_deg: vec![0.0],
            incidences_deg: lights.clone(),
            azimuths_deg: (0..=18).map(|k| 10.0 * f64::from(k)).collect(),
            radials_deg,
            symmetry: Symmetry::Plane,
        };
        let whole = SpecularGrid {
            azimuths_deg: (0..36).map(|k| 10.0 * f64::from(k)).collect(),
            symmetry: Symmetry::None,
            ..half.clone()
        };
        let values = |grid: &SpecularGrid| -> Vec<f64> {
            let mut values = Vec::new();
            for _ in &grid.rotations_deg {
                for theta in &lights {
                    for azimuth in &grid.azimuths_deg {
                        let of =
                            |radial: &f64| lobe(*theta, SpecularGrid::direction(*theta, *azimuth, *radial));
                        values.extend(grid.radials_deg.iter().map(of));
                    }
                }
            }
            values
        };
        let total = vec![0.3; 36];
        let expected = ring_patch_means(&half, &[(&values(&half), &total)], &KLEMS_FULL).unwrap().remove(0);
        let found = ring_patch_means(&whole, &[(&values(&whole), &total)], &KLEMS_FULL).unwrap().remove(0);
        for (pair, (a, b)) in found.iter().zip(&expected).enumerate() {
            assert!((a - b).abs() < 5e-3 * b + 1e-9, "{pair}: {a} {b}");
        }
        // Light from 135 deg, which travels towards 315 deg, and from 45 deg, towards 225 deg. Patches of 45 deg are 8 % of the way to the
        // other, with totals of 0.392 and 0.308; a symmetric matrix has up to the square of their ratio, 1.62, between equal patches, and
        // 1.21 if the display were turned the other way.
        let whole = SpecularGrid { rotations_deg: vec![45.0, 135.0], ..whole };
        let totals = [vec![0.3; 36], vec![0.4; 36]].concat();
        let found = ring_patch_means(&whole, &[(&values(&whole), &totals)], &KLEMS_FULL).unwrap().remove(0);
        let ratio = found[6 * 145 + 6] / found[8 * 145 + 8];
        assert!((1.4..1.62).contains(&ratio), "{ratio}");
    }
}
