//! Resampling of any geometry on a grid about the specular direction.

use std::borrow::Cow;

use super::GAUSSIAN;
use super::horizon::without_dark_horizon;
use super::rotated::{MeanOverLights, asymmetry, lights_deg, of_light};
use super::spherical::Smooth;
use crate::{
    Direction, Fill, Geometry, HalfAngleGrid, MeasuredPart, PairInterpolation, Shape, SpecularGrid,
    SphericalGrid, Symmetry,
};

/// Number of incidences for geometries without incidences of their own: 0 to 85 deg in steps of 5.
const INCIDENCES: u32 = 18;

/// Returns channels of a part, given by their indices, on a specular-centred grid: its own grid, or azimuths
/// every 10 deg and radial distances every 0.5 to 2 deg, with the means over azimuths of the light. Grids of
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
    let mean = MeanOverLights::new(part, channels);
    let own: Vec<usize> = (0..channels.len()).collect();
    let (part, channels) = mean.as_ref().map_or((part, channels), |mean| (&mean.part, &own));
    let known = || channels.iter().map(|channel| part.channel(*channel));
    let (incidences_deg, lights) = match &part.geometry {
        Geometry::Specular(grid) => return Some((grid.clone(), known().flatten().copied().collect())),
        Geometry::Pairs(pairs) => {
            return scattered(pairs, &known().collect::<Vec<&[f64]>>(), incidences);
        }
        Geometry::Spherical(grid) => {
            let below = grid.theta_i_deg.iter().copied().filter(|theta| *theta < 90.0);
            (below.collect(), vec![(*grid.phi_i_deg.first()?, 1.0)])
        }
        other => ((0..INCIDENCES).map(|k| 5.0 * f64::from(k)).collect::<Vec<_>>(), lights_deg(other)),
    };
    let mut grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: incidences_deg.into_iter().take(incidences).collect(),
        azimuths_deg: (0..36).map(|k| 10.0 * f64::from(k)).collect(),
        radials_deg: radials(),
        symmetry: Symmetry::None,
    };
    let all = mean_lobes(part, channels, &grid, &lights);
    let count = grid.incidences_deg.len();
    let lobes: Vec<&[f64]> = all.chunks_exact(grid.azimuths_deg.len() * grid.radials_deg.len()).collect();
    // Incidences without any light were not measured.
    let lit =
        |k: &usize| lobes.iter().skip(*k).step_by(count).any(|lobe| lobe.iter().any(|value| *value > 0.0));
    let retained: Vec<usize> = (0..count).filter(lit).collect();
    let values = (0..channels.len())
        .flat_map(|channel| {
            retained.iter().flat_map(|k| lobes[channel * count + k]).copied().collect::<Vec<_>>()
        })
        .collect();
    grid.incidences_deg = retained.iter().map(|k| grid.incidences_deg[*k]).collect();
    (!retained.is_empty()).then_some((grid, values))
}

/// What is known of a channel that was resampled.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Resampling {
    /// Relative uncertainties of the totals of the incidences, from the distances and from the azimuths of the file's own
    /// cells; empty for geometries that are not interpolated.
    pub(crate) errors: Vec<[f64; 2]>,
    /// Relative root mean square difference of azimuths of the light, over which the values were averaged.
    pub(crate) asymmetry: f64,
}

impl Resampling {
    /// Of a channel, and of the grid on which it was resampled.
    pub(crate) fn new(part: &MeasuredPart, channel: usize, grid: &SpecularGrid) -> Self {
        let part = on_rings(part);
        let part = &*without_dark_horizon(&part);
        if let Some(mean) = MeanOverLights::new(part, &[channel]) {
            let mut errors = resampling_errors(&mean.part, 0, grid);
            add_between(&mut errors, (part, channel), &mean.between, grid);
            return Self { errors, asymmetry: mean.asymmetry };
        }
        let asymmetry = match &part.geometry {
            Geometry::Specular(_) | Geometry::Pairs(_) => 0.0,
            _ => asymmetry(part, channel),
        };
        Self { errors: resampling_errors(part, channel, grid), asymmetry }
    }
}

/// Largest number of azimuths of the light from which the error of interpolated ones follows: each takes as long as the mean.
const MOST_LIGHTS: usize = 4;

/// Adds to the errors from azimuths those of the lights that were interpolated, given by their indices: the mean of some of them,
/// times their fraction of all.
fn add_between(
    errors: &mut [[f64; 2]],
    (part, channel): (&MeasuredPart, usize),
    between: &[usize],
    grid: &SpecularGrid,
) {
    let Geometry::Spherical(own) = &part.geometry else { return };
    let count = between.len().min(MOST_LIGHTS);
    let fraction = between.len() as f64 / own.phi_i_deg.len() as f64;
    for k in 0..count {
        let (one, values) = of_light(own, part.channel(channel), between[k * between.len() / count]);
        let (channels, geometry) = (vec![part.channels[channel]], Geometry::Spherical(one));
        let one = MeasuredPart { way: part.way, channels, geometry, values, tis: Vec::new() };
        for (error, [_, by_azimuth]) in errors.iter_mut().zip(resampling_errors(&one, 0, grid)) {
            error[1] = (error[1] + fraction * by_azimuth / count as f64).min(1.0);
        }
    }
}

/// Relative uncertainties of the totals of a channel from the inclinations and from the azimuths of a grid about the
/// normal with one azimuth of the light, or from half angles and the azimuths about them, for the incidences of the grid on which it was
/// resampled; empty for other geometries.
///
/// On a grid about the normal, they are the changes of the total when every other inclination or azimuth is omitted, once those next to the specular
/// direction and once the others; the larger one counts. The specular direction itself is retained. For inclinations, a third
/// of the change with a Gaussian lobe between the values is added if the first step halves f. For azimuths, the change with another stretch of azimuths
/// counts if it is larger: lobes that are not round depend on it where their azimuths are too far apart.
fn resampling_errors(part: &MeasuredPart, channel: usize, grid: &SpecularGrid) -> Vec<[f64; 2]> {
    let values = part.channel(channel);
    let half = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: Vec::new(),
        azimuths_deg: (0..=9).map(|k| 20.0 * f64::from(k)).collect(),
        radials_deg: grid.radials_deg.clone(),
        symmetry: Symmetry::Plane,
    };
    let own = match &part.geometry {
        Geometry::Spherical(own) => own,
        Geometry::HalfAngle(own) => {
            return grid
                .incidences_deg
                .iter()
                .map(|theta| errors_of_half_angles(*own, values, *theta, &half))
                .collect();
        }
        _ => return Vec::new(),
    };
    let Some(light_deg) = own.phi_i_deg.first().copied() else { return Vec::new() };
    let of_incidence = |theta: &f64| {
        let Some(place) = own.theta_i_deg.iter().position(|own| own == theta) else { return [0.0; 2] };
        errors_of_incidence(own, values, (place, light_deg), &half)
    };
    grid.incidences_deg.iter().map(of_incidence).collect()
}

/// Uncertainties of one incidence from cells of half angles: a third of the change of the total when every other theta_h and
/// theta_d, or every other phi_d is omitted. Linear interpolation is of second order: half as many cells have four times the error.
fn errors_of_half_angles(
    own: HalfAngleGrid,
    values: &[f64],
    theta_deg: f64,
    grid: &SpecularGrid,
) -> [f64; 2] {
    let light = Direction::new(theta_deg, 180.0);
    let total = |every: [usize; 3]| {
        rough_total(grid, theta_deg, |to| own.evaluate(values, [light, to], every).unwrap_or(0.0))
    };
    let whole = total([1; 3]);
    let change = |every: [usize; 3]| ((total(every) - whole).abs() / (3.0 * whole)).min(1.0);
    if whole > 0.0 { [change([2, 2, 1]), change([1, 1, 2])] } else { [0.0; 2] }
}

/// Uncertainties of one incidence, given by its index and the azimuth of the light; see [`resampling_errors`].
fn errors_of_incidence(
    own: &SphericalGrid,
    values: &[f64],
    (place, light_deg): (usize, f64),
    grid: &SpecularGrid,
) -> [f64; 2] {
    let theta = own.theta_i_deg[place];
    let (rows, columns) = (own.theta_o_deg.len(), own.phi_o_deg.len());
    let cells = &values[place * own.phi_i_deg.len() * rows * columns..][..rows * columns];
    let total = |rows: &[usize], columns_kept: &[usize], (power, width): (f64, Option<f64>)| -> f64 {
        let fewer = SphericalGrid {
            theta_i_deg: vec![theta],
            phi_i_deg: vec![light_deg],
            theta_o_deg: rows.iter().map(|k| own.theta_o_deg[*k]).collect(),
            phi_o_deg: columns_kept.iter().map(|k| own.phi_o_deg[*k]).collect(),
        };
        let retained: Vec<f64> =
            rows.iter().flat_map(|row| columns_kept.iter().map(move |k| cells[row * columns + k])).collect();
        let smooth = Smooth::new(&fewer, &retained, power, width);
        rough_total(grid, theta, |to| {
            smooth.value(0, Direction::new(to.theta_deg, to.phi_deg + light_deg - 180.0))
        })
    };
    let plain = (STRETCH, None);
    let all_rows: Vec<usize> = (0..rows).collect();
    let all_columns: Vec<usize> = (0..columns).collect();
    let whole = total(&all_rows, &all_columns, plain);
    if whole.is_nan() || whole <= 0.0 {
        return [0.0; 2];
    }
    let from_specular = |k: usize| {
        let turned = (own.phi_o_deg[k] - light_deg - 180.0).rem_euclid(360.0);
        turned.min(360.0 - turned)
    };
    let nearest_row = nearest(rows, |k| (own.theta_o_deg[k] - theta).abs());
    let nearest_column = nearest(columns, from_specular);
    let change = |total: f64| (total - whole).abs() / whole;
    let by_row = [0, 1].map(|parity| {
        let mut kept = every_other(rows, nearest_row, parity);
        // Nothing is extrapolated.
        kept.extend([0, rows - 1]);
        kept.sort_unstable();
        kept.dedup();
        change(total(&kept, &all_columns, plain))
    });
    let by_column = match columns {
        0..=2 => [0.0; 2],
        _ => [0, 1]
            .map(|parity| change(total(&all_rows, &every_other(columns, nearest_column, parity), plain))),
    };
    let alone = SphericalGrid { theta_i_deg: vec![theta], phi_i_deg: vec![light_deg], ..own.clone() };
    let by_shape = match Smooth::new(&alone, cells, STRETCH, None).halves_at_once(0) {
        true => change(total(&all_rows, &all_columns, (STRETCH, Some(GAUSSIAN)))) / 3.0,
        false => 0.0,
    };
    let by_stretch = change(total(&all_rows, &all_columns, (OTHER_STRETCH, None)));
    let [by_row, by_column] = [by_row, by_column].map(|[a, b]| a.max(b));
    [by_row + by_shape, by_column.max(by_stretch)].map(|error| error.min(1.0))
}

/// Exponents of the stretch of azimuths ([`Smooth`]): that of the interpolation, and one for its error.
pub(super) const STRETCH: f64 = 0.25;
const OTHER_STRETCH: f64 = 0.5;

/// Index of the smallest value, and whether that is 0 up to rounding.
fn nearest(count: usize, distance: impl Fn(usize) -> f64) -> (usize, bool) {
    let least = (0..count).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0);
    (least, distance(least) < 0.1)
}

/// Every other index, with that of the specular direction, if it is on the grid.
fn every_other(count: usize, (nearest, is_specular): (usize, bool), parity: usize) -> Vec<usize> {
    let is_retained = |k: &usize| k.abs_diff(nearest) % 2 == parity || is_specular && *k == nearest;
    (0..count).filter(is_retained).collect()
}

/// Integral of f cos over the hemisphere by the trapezoidal rule; unknown values are 0.
fn rough_total(grid: &SpecularGrid, theta_deg: f64, value: impl Fn(Direction) -> f64) -> f64 {
    let (radials, azimuths) = (&grid.radials_deg, &grid.azimuths_deg);
    let mut sum = 0.0;
    for (a, azimuth) in azimuths.iter().enumerate() {
        let ends = if a == 0 || a + 1 == azimuths.len() { 0.5 } else { 1.0 };
        for (r, radial) in radials.iter().enumerate() {
            let Some(to) = SpecularGrid::direction(theta_deg, *azimuth, *radial) else { break };
            let width = radials[(r + 1).min(radials.len() - 1)] - radials[r.saturating_sub(1)];
            let f = Some(value(to)).filter(|f| f.is_finite()).unwrap_or(0.0);
            sum += ends * width * radial.to_radians().sin() * to.theta_deg.to_radians().cos() * f;
        }
    }
    sum
}

/// Returns whether the listed pairs of a part form a grid about the specular direction.
pub fn is_on_rings(part: &MeasuredPart) -> bool {
    matches!(on_rings(part), Cow::Owned(_))
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
    let of_incidences = |incidences_deg: Vec<f64>| SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg,
        azimuths_deg: (0..=18).map(|k| 10.0 * f64::from(k)).collect(),
        radials_deg: radials(),
        symmetry: Symmetry::Plane,
    };
    // Incidences below the first one of the list are not known from its pairs.
    let is_known = |theta: &f64| {
        let one = of_incidences(vec![*theta]);
        let is_value =
            |[light, to]: [Direction; 2]| interpolations.iter().any(|of| of.value(light, to).is_some());
        (0..one.cells()).any(|cell| one.directions(cell).is_some_and(is_value))
    };
    let below = incidences_deg.into_iter().filter(|theta| *theta < 90.0);
    let grid = of_incidences(below.filter(is_known).take(incidences).collect());
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

/// Means of [`lobes`] over azimuths of the light with weights.
fn mean_lobes(
    part: &MeasuredPart,
    channels: &[usize],
    grid: &SpecularGrid,
    lights: &[(f64, f64)],
) -> Vec<f64> {
    if let [(only, _)] = lights {
        return lobes(part, channels, grid, *only);
    }
    let mut means = vec![[0.0; 2]; grid.cells() * channels.len()];
    for (light_deg, weight) in lights {
        let lobes = lobes(part, channels, grid, *light_deg);
        for ([sum, weights], value) in means.iter_mut().zip(lobes).filter(|(_, value)| value.is_finite()) {
            *sum += weight * value;
            *weights += weight;
        }
    }
    means.iter().map(|[sum, weights]| sum / weights).collect()
}

/// Values of each channel at each incidence of the grid: `[channel][incidence][azimuth][radial]`, for light from an azimuth.
fn lobes(part: &MeasuredPart, channels: &[usize], grid: &SpecularGrid, light_deg: f64) -> Vec<f64> {
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
        let mut all = vec![Vec::with_capacity(grid.cells()); channels.len()];
        for theta in &grid.incidences_deg {
            let light = Direction::new(*theta, light_deg);
            let weights: Vec<_> = directions(*theta).map(|to| warped.weights(light, to?)).collect();
            for (lobes, channel) in all.iter_mut().zip(channels) {
                let values = part.channel(*channel);
                let f =
                    |cells: &[(usize, f64); 16]| cells.iter().map(|(k, weight)| weight * values[*k]).sum();
                lobes.extend(weights.iter().map(|cells| cells.as_ref().map_or(f64::NAN, f)));
            }
        }
        return all.concat();
    }
    let of_channel = |channel: &usize| {
        let smooth = match &part.geometry {
            Geometry::Spherical(own) => Some(Smooth::new(own, part.channel(*channel), STRETCH, None)),
            _ => None,
        };
        let lobe = |(k, theta): (usize, &f64)| {
            let light = Direction::new(*theta, light_deg);
            let value = |to: Option<Direction>| {
                let plain = part.evaluate(*channel, light, to?)?;
                Some(smooth.as_ref().map_or(plain, |smooth| smooth.value(k, to.unwrap_or_default())))
            };
            directions(*theta).map(|to| value(to).unwrap_or(f64::NAN)).collect::<Vec<_>>()
        };
        grid.incidences_deg.iter().enumerate().flat_map(lobe).collect::<Vec<_>>()
    };
    channels.iter().flat_map(of_channel).collect()
}

/// Angles that differ by less than this are equal, degrees, because files round them.
const SAME_DEG: f64 = 2e-3;

/// Inverse of the step to which angles of a grid are rounded, per degree: lists of pairs have fewer decimals.
const ROUNDED: f64 = 1e6;

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
        // Without the rounding errors of their coordinates.
        angles.into_iter().map(|angle| (angle * ROUNDED).round() / ROUNDED + 0.0).collect::<Vec<f64>>()
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
    use crate::{Channel, ScatterMode};

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
