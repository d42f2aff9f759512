//! Resampling of any geometry on a grid about the specular direction.

use std::borrow::Cow;

use super::horizon::without_dark_horizon;
use super::spherical::Smooth;
use crate::{Direction, Fill, Geometry, MeasuredPart, PairInterpolation, Shape, SpecularGrid, Symmetry};

/// Number of incidences for geometries without incidences of their own: 0 to 85 deg in steps of 5.
const INCIDENCES: u32 = 18;

/// Returns channels of a part, given by their indices, on a specular-centred grid: its own grid, or azimuths
/// every 10 deg and radial distances every 0.5 to 2 deg, for light from its first azimuth. Grids of
/// inclinations are interpolated smoothly at their own incidences, and listed pairs that form no such grid with
/// [`PairInterpolation`]; other geometries are read with [`MeasuredPart::evaluate`]. Unknown values are NaN, also zeros near the
/// horizon that were not measured. Values have the shape `[channel][cell]`.
///
/// `None` for fewer than 12 different listed pairs, and if there is no light.
pub fn on_specular_grid(part: &MeasuredPart, channels: &[usize]) -> Option<(SpecularGrid, Vec<f64>)> {
    resampled(part, channels, usize::MAX)
}

/// The same for the smallest incidence alone, or for all.
fn resampled(part: &MeasuredPart, channels: &[usize], incidences: usize) -> Option<(SpecularGrid, Vec<f64>)> {
    let part = on_rings(part);
    let part = &*without_dark_horizon(&part);
    let known = || channels.iter().map(|channel| part.channel(*channel));
    let (incidences_deg, light_deg) = match &part.geometry {
        Geometry::Specular(grid) => return Some((grid.clone(), known().flatten().copied().collect())),
        Geometry::Pairs(pairs) => {
            return scattered(pairs, &known().collect::<Vec<&[f64]>>(), incidences);
        }
        Geometry::Spherical(grid) => {
            let below = grid.theta_i_deg.iter().copied().filter(|theta| *theta < 90.0);
            (below.collect(), *grid.phi_i_deg.first()?)
        }
        _ => ((0..INCIDENCES).map(|k| 5.0 * f64::from(k)).collect::<Vec<_>>(), 180.0),
    };
    let mut grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: incidences_deg.into_iter().take(incidences).collect(),
        azimuths_deg: (0..36).map(|k| 10.0 * f64::from(k)).collect(),
        radials_deg: radials(),
        symmetry: Symmetry::None,
    };
    let lobes = lobes(part, channels, &grid, light_deg);
    // Incidences without any light were not measured.
    let lit = |k: &usize| lobes.iter().any(|lobes| lobes[*k].iter().any(|value| *value > 0.0));
    let retained: Vec<usize> = (0..grid.incidences_deg.len()).filter(lit).collect();
    let values = lobes.iter().flat_map(|lobes| retained.iter().flat_map(|k| &lobes[*k])).copied().collect();
    grid.incidences_deg = retained.iter().map(|k| grid.incidences_deg[*k]).collect();
    (!retained.is_empty()).then_some((grid, values))
}

/// Returns the part on a grid about the specular direction if its listed pairs form one; otherwise as it is.
pub(super) fn on_rings(part: &MeasuredPart) -> Cow<'_, MeasuredPart> {
    let Geometry::Pairs(pairs) = &part.geometry else { return Cow::Borrowed(part) };
    let channels: Vec<&[f64]> = (0..part.channels.len()).map(|channel| part.channel(channel)).collect();
    let Some((grid, values)) = rings(pairs, &channels) else { return Cow::Borrowed(part) };
    let (channels, geometry) = (part.channels.clone(), Geometry::Specular(grid));
    Cow::Owned(MeasuredPart { way: part.way, channels, geometry, values, tis: Vec::new() })
}

/// Interpolates listed pairs in any order: at their own incidences, if there are few, and in steps of 5 deg between them up to
/// the last.
fn scattered(
    pairs: &[[Direction; 2]],
    channels: &[&[f64]],
    incidences: usize,
) -> Option<(SpecularGrid, Vec<f64>)> {
    let interpolations: Vec<PairInterpolation> =
        channels.iter().map(|values| PairInterpolation::new(pairs, values)).collect::<Option<_>>()?;
    let [last_deg, _] = interpolations.first()?.largest_deg();
    let mut incidences_deg = interpolations[0].incidences_deg().unwrap_or_else(|| vec![last_deg]);
    let own = incidences_deg.clone();
    let between = (0..INCIDENCES).map(|k| 5.0 * f64::from(k)).filter(|theta| *theta < last_deg);
    incidences_deg.extend(between.filter(|theta| own.iter().all(|own| (own - theta).abs() >= 2.0)));
    incidences_deg.sort_by(f64::total_cmp);
    let grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: incidences_deg.into_iter().filter(|theta| *theta < 90.0).take(incidences).collect(),
        azimuths_deg: (0..=18).map(|k| 10.0 * f64::from(k)).collect(),
        radials_deg: radials(),
        symmetry: Symmetry::Plane,
    };
    let value = |of: &PairInterpolation, cell: usize| {
        let [light, to] = grid.directions(cell)?;
        of.value(light, to)
    };
    let values = interpolations
        .iter()
        .flat_map(|of| (0..grid.cells()).map(move |cell| (of, cell)))
        .map(|(of, cell)| value(of, cell).unwrap_or(f64::NAN))
        .collect::<Vec<f64>>();
    values.iter().any(|value| *value > 0.0).then_some((grid, values))
}

/// Returns the interpolation of a channel of listed pairs that form no grid about the specular direction.
pub(crate) fn pair_interpolation(part: &MeasuredPart, channel: usize) -> Option<PairInterpolation> {
    let Geometry::Pairs(pairs) = &part.geometry else { return None };
    let values = part.channel(channel);
    if rings(pairs, &[]).is_some() { None } else { PairInterpolation::new(pairs, values) }
}

/// Lobes of the channels of a part, given by their indices, at its smallest incidence.
pub(crate) fn first_lobes(part: &MeasuredPart, channels: &[usize]) -> Option<Vec<Shape>> {
    let (grid, values) = resampled(part, channels, 1)?;
    let one = SpecularGrid {
        incidences_deg: grid.incidences_deg.first().copied().into_iter().collect(),
        ..grid.clone()
    };
    let lobe = grid.azimuths_deg.len() * grid.radials_deg.len();
    let of_channel = |values: &[f64]| {
        let turns = values.chunks_exact(grid.incidences_deg.len() * lobe);
        let first: Vec<f64> = turns.flat_map(|turn| &turn[..lobe]).copied().collect();
        Shape::of_grid(&one, &first, Fill::Beyond)
    };
    Some(values.chunks_exact(grid.cells()).map(of_channel).collect())
}

/// Largest inclination, degrees, at which a warped grid is evaluated here: its f is f cos over the cosine,
/// which is unknown at the horizon.
const WARPED_LAST_DEG: f64 = 89.0;

/// Values of each channel at each incidence of the grid: `[channel][incidence]`, each `[azimuth][radial]`.
fn lobes(part: &MeasuredPart, channels: &[usize], grid: &SpecularGrid, light_deg: f64) -> Vec<Vec<Vec<f64>>> {
    let last_deg = if let Geometry::Warped(_) = part.geometry { WARPED_LAST_DEG } else { 90.0 };
    // On the grid, light comes from azimuth 180 deg.
    let directions = |theta: f64| {
        let to = move |azimuth: f64, radial: f64| {
            let to = SpecularGrid::direction(theta, azimuth, radial)?;
            Some(Direction::new(to.theta_deg.min(last_deg), to.phi_deg + light_deg - 180.0))
        };
        grid.azimuths_deg.iter().flat_map(move |a| grid.radials_deg.iter().map(move |r| to(*a, *r)))
    };
    if let Geometry::Warped(warped) = &part.geometry {
        // The map of directions to cells takes most of the time, and all channels share it.
        let mut all = vec![Vec::with_capacity(grid.incidences_deg.len()); channels.len()];
        for theta in &grid.incidences_deg {
            let light = Direction::new(*theta, light_deg);
            let weights: Vec<_> = directions(*theta).map(|to| warped.weights(light, to?)).collect();
            for (lobes, channel) in all.iter_mut().zip(channels) {
                let values = part.channel(*channel);
                let f =
                    |cells: &[(usize, f64); 16]| cells.iter().map(|(k, weight)| weight * values[*k]).sum();
                lobes.push(weights.iter().map(|cells| cells.as_ref().map_or(f64::NAN, f)).collect());
            }
        }
        return all;
    }
    let of_channel = |channel: &usize| {
        let smooth = match &part.geometry {
            Geometry::Spherical(own) => Some(Smooth::new(own, part.channel(*channel))),
            _ => None,
        };
        let lobe = |(k, theta): (usize, &f64)| {
            let light = Direction::new(*theta, light_deg);
            let value = |to: Option<Direction>| {
                let plain = part.evaluate(*channel, light, to?)?;
                Some(smooth.as_ref().map_or(plain, |smooth| smooth.value(k, to.unwrap_or_default())))
            };
            directions(*theta).map(|to| value(to).unwrap_or(f64::NAN)).collect()
        };
        grid.incidences_deg.iter().enumerate().map(lobe).collect()
    };
    channels.iter().map(of_channel).collect()
}

/// Angles that differ by less than this are equal, degrees, because files round them.
const SAME_DEG: f64 = 2e-3;

/// Converts listed pairs that lie on rings about the specular direction to a grid, with a rotation for each
/// azimuth of the light; cells that are not listed are NaN.
fn rings(pairs: &[[Direction; 2]], channels: &[&[f64]]) -> Option<(SpecularGrid, Vec<f64>)> {
    let coordinates = |[from, to]: &[Direction; 2]| {
        let turned = Direction::new(to.theta_deg, to.phi_deg - from.phi_deg + 180.0).vector();
        let (sin, cos) = from.theta_deg.to_radians().sin_cos();
        let [along, across, towards] =
            [turned[0] * sin + turned[2] * cos, -turned[1], -turned[0] * cos + turned[2] * sin];
        let radial = across.hypot(towards).atan2(along).to_degrees();
        // At the centre all azimuths coincide.
        let azimuth =
            if radial < SAME_DEG { 0.0 } else { across.atan2(towards).to_degrees().rem_euclid(360.0) };
        let wrapped = |angle: f64| if angle > 360.0 - SAME_DEG { 0.0 } else { angle };
        // For a sample rotated by w, light comes from azimuth 180 - w.
        let rotation = wrapped((180.0 - from.phi_deg).rem_euclid(360.0));
        [rotation, from.theta_deg, wrapped(azimuth), radial]
    };
    let mut points: Vec<[f64; 4]> = pairs.iter().map(coordinates).collect();
    // Half a circle on the other side of the plane of incidence is the mirror image of the one from 0 to 180
    // deg.
    if points.iter().all(|point| point[2] == 0.0 || point[2] > 180.0 - SAME_DEG) {
        points.iter_mut().for_each(|point| point[2] = (360.0 - point[2]) % 360.0);
    }
    let [mut rotations_deg, incidences_deg, azimuths_deg, radials_deg] = [0, 1, 2, 3].map(|axis| {
        let mut angles: Vec<f64> = points.iter().map(|place| place[axis]).collect();
        angles.sort_by(f64::total_cmp);
        angles.dedup_by(|b, a| *b - *a < SAME_DEG);
        angles
    });
    let (incidences, azimuths, radials) = (incidences_deg.len(), azimuths_deg.len(), radials_deg.len());
    let cells =
        [rotations_deg.len(), incidences, azimuths, radials].into_iter().fold(1_usize, usize::saturating_mul);
    // Cells beyond the horizon, about half of a grid, are not listed.
    if radials < 3 || pairs.len() < cells / 4 {
        return None;
    }
    let mut found = vec![f64::NAN; cells * channels.len()];
    for (number, [rotation, incidence, azimuth, radial]) in points.iter().enumerate() {
        let [t, i, a, r] = [
            (&rotations_deg, rotation),
            (&incidences_deg, incidence),
            (&azimuths_deg, azimuth),
            (&radials_deg, radial),
        ]
        .map(|(angles, angle)| angles.partition_point(|known| *known < angle - SAME_DEG));
        let centre = r == 0 && *radial < SAME_DEG;
        for (channel, values) in channels.iter().enumerate() {
            let row = channel * cells + ((t * incidences + i) * azimuths + a) * radials;
            found[row + r] = values[number];
            if centre {
                (1..azimuths).for_each(|k| found[row + k * radials] = values[number]);
            }
        }
    }
    let half = azimuths_deg.last().is_some_and(|last| *last <= 180.0 + SAME_DEG);
    let symmetry = if half { Symmetry::Plane } else { Symmetry::None };
    // A single azimuth of the light represents all.
    if let [only] = &mut rotations_deg[..] {
        *only = 0.0;
    }
    Some((SpecularGrid { rotations_deg, incidences_deg, azimuths_deg, radials_deg, symmetry }, found))
}

fn radials() -> Vec<f64> {
    let fine = (0..20).map(|k| 0.5 * f64::from(k));
    let medium = (10..30).map(f64::from);
    fine.chain(medium).chain((15..=90).map(|k| 2.0 * f64::from(k))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, ScatterMode, SphericalGrid};

    /// Pairs listed from rings are recognised as rings.
    #[test]
    fn listed_pairs_on_rings_become_a_grid() {
        let grid = SpecularGrid {
            rotations_deg: vec![0.0],
            incidences_deg: vec![0.0, 20.0, 70.0],
            azimuths_deg: (0..=18).map(|k| 10.0 * f64::from(k)).collect(),
            radials_deg: (0..=90).map(|k| 2.0 * f64::from(k)).collect(),
            symmetry: Symmetry::Plane,
        };
        let (mut pairs, mut values) = (Vec::new(), Vec::new());
        for incidence in &grid.incidences_deg {
            for azimuth in &grid.azimuths_deg {
                for radial in &grid.radials_deg {
                    if let Some(to) = SpecularGrid::direction(*incidence, *azimuth, *radial) {
                        // Rounded as in a file, with the light at azimuth 30 deg.
                        let round = |angle: f64| (angle * 1e6).round() / 1e6;
                        pairs.push([
                            Direction::new(*incidence, 30.0),
                            Direction::new(round(to.theta_deg), round(to.phi_deg - 150.0)),
                        ]);
                        values.push(incidence + azimuth.min(10.0 * radial) + radial);
                    }
                }
            }
        }
        let (found, known) = rings(&pairs, &[&values]).unwrap();
        assert_eq!([found.incidences_deg.len(), found.azimuths_deg.len()], [3, 19]);
        let lit = known.iter().filter(|value| value.is_finite()).count();
        assert!(lit >= values.len(), "{lit} {}", values.len());
        let at = |i: usize, a: usize, r: usize| known[(i * 19 + a) * found.radials_deg.len() + r];
        assert_eq!([at(0, 3, 5), at(1, 18, 4), at(2, 9, 0)], [40.0, 20.0 + 80.0 + 8.0, 70.0]);
    }

    /// The total of a lobe on a grid of inclinations equals its closed form; linear interpolation has an
    /// error of 1 %.
    #[test]
    fn resampled_spherical_grid_conserves_the_total() {
        let steps =
            |to: f64, step: f64| (0..=(to / step) as usize).map(|k| k as f64 * step).collect::<Vec<_>>();
        let grid = SphericalGrid {
            theta_i_deg: steps(60.0, 15.0),
            phi_i_deg: vec![0.0],
            theta_o_deg: steps(90.0, 2.0),
            phi_o_deg: steps(356.0, 4.0),
        };
        let b: f64 = 0.1;
        let mut values = Vec::new();
        for theta_i in &grid.theta_i_deg {
            for theta_o in &grid.theta_o_deg {
                values.extend(grid.phi_o_deg.iter().map(|phi_o| {
                    let (from, to) = (Direction::new(*theta_i, 0.0), Direction::new(*theta_o, *phi_o));
                    let squared = (to.leaving() - from.arriving()).squared();
                    b / (2.0 * std::f64::consts::PI * (b * b + squared).powf(1.5))
                }));
            }
        }
        let part = MeasuredPart {
            way: ScatterMode::FrontTransmission,
            channels: vec![Channel::Monochrome],
            geometry: Geometry::Spherical(grid),
            values,
            tis: Vec::new(),
        };
        let shape = Shape::of_part(&part, 0, Fill::None).unwrap();
        for (k, fraction) in [0.9005, 0.8953, 0.8768, 0.8331, 0.7291].into_iter().enumerate() {
            assert!((shape.total(k) - fraction).abs() < 2e-3, "{k}: {} {fraction}", shape.total(k));
        }
    }
}
