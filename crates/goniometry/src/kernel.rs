//! Conversion of a part of a measurement to the scattering kernel of a display.
//!
//! By default, dark cells stay dark, totals are those of the values, light from beyond the largest incidence
//! is blocked, and no light is sent beyond the last measured distance from the specular direction. Options
//! fill dark cells, set the level of the totals, and extrapolate beyond the largest incidence
//! and the last distance. [`Changes`] reports every change.

use papilio_optics::interface::fresnel_reflectance;
use papilio_optics::scatter::{Scatter, Table};

use crate::shape::{inclined_to_deg, on_specular_grid};
use crate::tree::{RING_DEG, ring_kernel};
use crate::{
    Fill, Geometry, GoniometryError, MeasuredPart, Shape, SpecularGrid, TensorTree, incidence_scale,
};

/// Step in t of the table's distances `w sinh(t)`, with w a half-width. The error of cubic interpolation
/// is then 1e-4.
const STEP: f64 = 0.125;
/// Number of azimuths of the table.
const AZIMUTHS: usize = 19;
/// Largest half-width w (direction cosines) of the table's distances.
const WIDEST: f64 = 0.5;
/// Largest step of the distances: near the horizon, the transmittance falls steeply.
const COARSEST: f64 = 0.025;

/// Options of the conversion of a measurement to a kernel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Preparation {
    /// Treatment of dark cells.
    pub fill: Fill,
    /// Normalise totals to the instrument's TIS.
    pub to_tis: bool,
    /// Total at the smallest incidence: all values are multiplied by one factor. For values in relative units.
    pub level: Option<f64>,
    /// Extrapolate into a medium of this index (1: air). Beyond the largest incidence, the last lobe is used,
    /// shifted with the light. Tails are extrapolated beyond the last measured distance from the specular
    /// direction and, in a transmission, beyond the horizon of the air.
    pub extrapolate: Option<f64>,
    /// Remove the back surface to air from a transmission.
    pub lamination: Option<Lamination>,
}

/// Lamination of a foil that was measured in air and is in optical contact with the glass of the display. The
/// Fresnel loss of its back surface is removed from the transmission, `f / T(beta_out)`, with T of an
/// interface of this index.
///
/// This is a first-order correction: light that the back surface reflects into the foil is not followed. Near
/// grazing, where T is below 0.1, the tail of the divided lobe is extrapolated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamination {
    /// Index of foil and glass.
    pub index: f64,
}

/// Transmittance of the interface below which tails are extrapolated.
const MIN_TRANSMITTANCE: f64 = 0.1;

/// Changes made by the conversion to a kernel, and remaining uncertainties.
#[derive(Debug, Clone, PartialEq)]
pub struct Changes {
    /// Fraction of the cells in the hemisphere that were dark and filled.
    pub filled: f64,
    /// Totals in air before and after, by incidence.
    pub totals: Vec<[f64; 2]>,
    /// Largest value of the file, 1/sr.
    pub largest: f64,
    /// Largest total, including light in the glass beyond the horizon of the air.
    pub most: f64,
    /// True if totals were normalised to the instrument's TIS.
    pub to_tis: bool,
    /// Total at the smallest incidence to which the level was set.
    pub level: Option<f64>,
    /// True if the loss of a back surface was removed.
    pub laminated: bool,
    /// Smallest distance from the specular direction, degrees, at which measured cells end before the
    /// horizon.
    pub measured_to_deg: Option<f64>,
    /// Incidence, degrees, and fraction of the light beyond the last measured distance if tails are
    /// extrapolated.
    pub beyond: Vec<[f64; 2]>,
    /// True if tails are extrapolated there; otherwise that light is lost.
    pub tails: bool,
    /// First and last azimuth, degrees from the plane of incidence, if not 0 and 180; beyond them the nearest
    /// value is used.
    pub held_azimuths_deg: Option<[f64; 2]>,
    /// True if the measurement has a single incidence, whose lobe is used at all others.
    pub held_single: bool,
    /// Largest inclination to which light was measured, degrees, if a grid of inclinations ends before the horizon.
    pub inclined_to_deg: Option<f64>,
    /// Width of the rings over which light is spread, degrees, if the values are constant over cells (trees).
    pub rings_deg: Option<f64>,
    /// Largest incidence, degrees.
    pub last_deg: f64,
    /// Fraction of diffuse light that comes from beyond the largest incidence, for which the last lobe is used.
    pub held: f64,
    /// Fraction of diffuse light that comes from beyond the largest incidence, and is lost.
    pub lost: f64,
    /// Largest relative uncertainty of the totals from the grid.
    pub grid_error: f64,
    /// The same from the grid's azimuths alone; included in `grid_error`.
    pub azimuth_error: f64,
    /// Relative difference of mirrored and rotated cells (root mean square).
    pub asymmetry: f64,
}

/// Returns the kernel of one channel of a part, times k of each incidence (see [`incidence_scale`]).
/// `spectrum` is the factor by wavelength that the caller applies later, at uniformly spaced wavelengths
/// (empty: 1).
///
/// # Errors
/// If the part is too coarse (patches), lacks a requested TIS, or a table cannot represent it.
pub fn kernel(
    part: &MeasuredPart,
    channel: usize,
    preparation: &Preparation,
    spectrum: &[f64],
) -> Result<(Scatter, Changes), GoniometryError> {
    if let Geometry::Tree(tree) = &part.geometry {
        return of_tree(part, tree, channel, preparation, spectrum);
    }
    // Patches of 10 deg are too coarse for a display.
    let coarse = matches!(part.geometry, Geometry::Patches { .. });
    let (grid, cells) =
        on_specular_grid(part, &[channel]).filter(|_| !coarse).ok_or(GoniometryError::NoGrid)?;
    let extrapolate = preparation.extrapolate;
    let held_single = extrapolate.is_some() && grid.incidences_deg.len() == 1;
    let fill = match preparation.fill {
        Fill::None if extrapolate.is_some() => Fill::Beyond,
        fill => fill,
    };
    let shape = Shape::of_grid(&grid, &cells, fill);
    let incidences: Vec<f64> = shape.incidences_deg().collect();
    // Lobe and total are means over rotations.
    let tis: Option<Vec<f64>> = (0..incidences.len()).map(|k| part.mean_tis(channel, k)).collect();
    let tis = match (preparation.to_tis, tis) {
        (true, _) if part.tis_in_percent() => return Err(GoniometryError::TisInPercent),
        (true, None) => return Err(GoniometryError::NoTis),
        (true, tis) => tis,
        (false, _) => None,
    };
    let mut scale = incidence_scale(&shape, tis.as_deref(), spectrum);
    if let Some(level) = preparation.level {
        let factor = level / shape.total(0);
        if !factor.is_finite() {
            return Err(GoniometryError::NoLight);
        }
        scale.iter_mut().for_each(|scale| *scale *= factor);
    }
    let mean = if spectrum.is_empty() { 1.0 } else { spectrum.iter().sum::<f64>() / spectrum.len() as f64 };
    let mounted = preparation.lamination.map(|face| face.removed(&grid, &cells, fill));
    let table =
        table(mounted.as_ref().unwrap_or(&shape), &scale, distances(&shape, extrapolate.unwrap_or(1.0)))?;
    let table = if extrapolate.is_some() { table } else { table.dark_beyond() };
    let incidence: Vec<f64> = incidences.iter().map(|theta| theta.to_radians().sin()).collect();
    let last = incidence[incidence.len() - 1];
    let in_air = Scatter::from(table.clone());
    let totals =
        (0..incidences.len()).map(|k| [shape.total(k), mean * in_air.albedo_at(incidence[k])]).collect();
    let scatter = match extrapolate {
        Some(index) if index > 1.0 => Scatter::from(table.reaching(index)),
        _ => in_air,
    };
    let grid_errors: Vec<[f64; 2]> = (0..incidences.len()).map(|k| shape.grid_errors(k)).collect();
    let largest = |of: fn(&[f64; 2]) -> f64| grid_errors.iter().map(of).fold(0.0, f64::max);
    let changes = Changes {
        filled: shape.filled(),
        totals,
        largest: cells.iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max),
        most: incidence.iter().map(|beta| mean * scatter.albedo_at(*beta)).fold(0.0, f64::max),
        to_tis: preparation.to_tis,
        level: preparation.level,
        laminated: preparation.lamination.is_some(),
        measured_to_deg: least_measured_deg(&shape),
        beyond: beyond(&shape, &grid, &cells, fill),
        tails: fill != Fill::None,
        held_azimuths_deg: shape.held_azimuths_deg(),
        held_single,
        inclined_to_deg: inclined_to_deg(part, channel),
        rings_deg: None,
        last_deg: incidences[incidences.len() - 1],
        held: if extrapolate.is_some() { 1.0 - last * last } else { 0.0 },
        lost: if extrapolate.is_some() { 0.0 } else { 1.0 - last * last },
        grid_error: largest(|[by_distance, by_azimuth]| by_distance + by_azimuth),
        azimuth_error: largest(|[_, by_azimuth]| *by_azimuth),
        asymmetry: shape.asymmetry(),
    };
    Ok((scatter, changes))
}

/// Returns the kernel of a part on a tree: light between rings. Nothing is extrapolated, because a tree has values for all directions.
fn of_tree(
    part: &MeasuredPart,
    tree: &TensorTree,
    channel: usize,
    preparation: &Preparation,
    spectrum: &[f64],
) -> Result<(Scatter, Changes), GoniometryError> {
    if preparation.to_tis {
        return Err(GoniometryError::NoTis);
    }
    let values = part.channel(channel);
    let total = |theta: f64| tree.mean_total(values, theta);
    let level = preparation.level.map_or(1.0, |level| level / total(0.0));
    if !level.is_finite() {
        return Err(GoniometryError::NoLight);
    }
    let mean = if spectrum.is_empty() { 1.0 } else { spectrum.iter().sum::<f64>() / spectrum.len() as f64 };
    let without_back = |beta: f64| match preparation.lamination {
        Some(face) => 1.0 / face.passed(beta).max(MIN_TRANSMITTANCE),
        None => 1.0,
    };
    let scatter = Scatter::from(ring_kernel(part, tree, channel, |beta| level / mean * without_back(beta)));
    let after = |theta: f64| match preparation.lamination {
        Some(_) => mean * scatter.albedo_at(theta.to_radians().sin()),
        None => level * total(theta),
    };
    let incidences = (0..18).map(|k| 5.0 * f64::from(k));
    let totals: Vec<[f64; 2]> = incidences.map(|theta| [total(theta), after(theta)]).collect();
    let changes = Changes {
        filled: 0.0,
        largest: values.iter().copied().fold(0.0, f64::max),
        most: totals.iter().map(|[_, after]| *after).fold(0.0, f64::max),
        totals,
        to_tis: false,
        level: preparation.level,
        laminated: preparation.lamination.is_some(),
        measured_to_deg: None,
        beyond: Vec::new(),
        tails: false,
        held_azimuths_deg: None,
        held_single: false,
        inclined_to_deg: None,
        rings_deg: Some(f64::from(RING_DEG)),
        last_deg: 90.0,
        held: 0.0,
        lost: 0.0,
        grid_error: 0.0,
        azimuth_error: 0.0,
        asymmetry: 0.0,
    };
    Ok((scatter, changes))
}

/// Tabulates a shape; values of each incidence are multiplied by its scale.
fn table(shape: &Shape, scale: &[f64], radial: Vec<f64>) -> Result<Table, GoniometryError> {
    let azimuth: Vec<f64> =
        (0..AZIMUTHS).map(|k| std::f64::consts::PI * k as f64 / (AZIMUTHS - 1) as f64).collect();
    let incidence: Vec<f64> = shape.incidences_deg().map(|theta| theta.to_radians().sin()).collect();
    let mut values = shape.tabulate(&radial, &azimuth);
    let cells = radial.len() * azimuth.len();
    let scaled = |values: &mut [f64], scale: &[f64]| {
        for (lobe, scale) in values.chunks_exact_mut(cells).zip(scale) {
            lobe.iter_mut().for_each(|value| *value *= scale);
        }
    };
    scaled(&mut values, scale);
    let table = Table::new(&incidence, &radial, &azimuth, &values)?;
    if !shape.has_ends() {
        return Ok(table);
    }
    // No node lies on the edge of a truncated lobe. Rescaling corrects its total; the edge is blurred over
    // one step.
    let made = Scatter::from(table);
    let off: Vec<f64> = (0..incidence.len())
        .map(|k| match made.albedo_at(incidence[k]) {
            total if total > 0.0 => scale[k] * shape.total(k) / total,
            _ => 1.0,
        })
        .collect();
    scaled(&mut values, &off);
    Ok(Table::new(&incidence, &radial, &azimuth, &values)?)
}

/// Incidence, degrees, and fraction of the light beyond the last measured distance if tails are extrapolated;
/// empty if the measured cells reach the horizon at all azimuths.
fn beyond(shape: &Shape, grid: &SpecularGrid, cells: &[f64], fill: Fill) -> Vec<[f64; 2]> {
    if least_measured_deg(shape).is_none() {
        return Vec::new();
    }
    // If dark cells are filled too, the light in them is included.
    let [known, with_tails] = [Fill::None, if fill == Fill::Tail { fill } else { Fill::Beyond }]
        .map(|fill| Shape::of_grid(grid, cells, fill));
    let fraction = |k: usize| match with_tails.total(k) {
        all if all > 0.0 => (1.0 - known.total(k) / all).max(0.0),
        _ => 0.0,
    };
    with_tails.incidences_deg().enumerate().map(|(k, theta)| [theta, fraction(k)]).collect()
}

/// Smallest distance at which the measured cells of any incidence end before the horizon.
fn least_measured_deg(shape: &Shape) -> Option<f64> {
    let ends = (0..shape.incidences_deg().count()).filter_map(|k| shape.measured_to_deg(k));
    ends.min_by(f64::total_cmp)
}

impl Lamination {
    /// Transmittance of the interface at a `|beta|`.
    fn passed(&self, beta: f64) -> f64 {
        1.0 - fresnel_reflectance(1.0, self.index, beta)
    }

    /// Lobe of a grid's cells without the interface. Cells are divided before the smooth lobe is formed,
    /// because the loss of the interface near grazing is not smooth.
    fn removed(&self, grid: &SpecularGrid, cells: &[f64], fill: Fill) -> Shape {
        let passed = |beta: f64| self.passed(beta);
        let horizon = (0..=900).map(|k| (0.1 * f64::from(k)).to_radians().sin());
        let horizon = horizon.take_while(|beta| passed(*beta) >= MIN_TRANSMITTANCE).last().unwrap_or(0.0);
        let transmittance = |cell: usize| {
            grid.directions(cell).map_or(1.0, |[_, to]| passed(to.leaving().length()).max(MIN_TRANSMITTANCE))
        };
        let divided: Vec<f64> =
            cells.iter().enumerate().map(|(cell, value)| value / transmittance(cell)).collect();
        Shape::of_grid_within(grid, &divided, fill, horizon)
    }
}

/// Distances from the peak, dense where the lobe falls, up to the sum of the radii of the air's disc and of
/// this one.
fn distances(shape: &Shape, radius: f64) -> Vec<f64> {
    let half_widths = (0..shape.incidences_deg().count())
        .flat_map(|k| [0.0, 90.0, 180.0].map(|azimuth| shape.half_width_deg(k, azimuth)))
        .flatten()
        .map(|degrees| degrees.to_radians().sin());
    let width = half_widths.fold(WIDEST, f64::min);
    let mut distances = vec![0.0];
    let (mut t, mut distance) = (0.0, 0.0);
    while distance < 1.0 + radius {
        t += STEP;
        distance = (width * f64::sinh(t)).min(distance + COARSEST).min(1.0 + radius);
        distances.push(distance);
    }
    distances
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::{Channel, ScatterMode, SpecularGrid, Symmetry};
    use papilio_optics::lobe::Lobe;
    use papilio_optics::{Beta, Scatterer};

    const WIDTH: f64 = 0.1;
    const TIS: [f64; 4] = [0.9, 0.88, 0.8, 0.7];

    fn lobe(from: Beta, to: Beta) -> f64 {
        0.8 * WIDTH / (2.0 * PI * (WIDTH * WIDTH + (to - from).squared()).powf(1.5))
    }

    /// Part of a foil on a grid of 1 deg with the values of `f`.
    fn part(f: impl Fn(Beta, Beta) -> f64) -> MeasuredPart {
        let steps = |to: u32, step: u32| (0..=to / step).map(|k| f64::from(k * step)).collect::<Vec<_>>();
        let grid = SpecularGrid {
            rotations_deg: vec![0.0],
            incidences_deg: steps(60, 20),
            azimuths_deg: steps(180, 10),
            radials_deg: steps(180, 1),
            symmetry: Symmetry::Plane,
        };
        let mut values = Vec::new();
        for theta in &grid.incidences_deg {
            for azimuth in &grid.azimuths_deg {
                values.extend(grid.radials_deg.iter().map(|radial| {
                    let to = SpecularGrid::direction(*theta, *azimuth, *radial);
                    to.map_or(0.0, |to| f(ray(*theta), to.leaving()))
                }));
            }
        }
        MeasuredPart {
            way: ScatterMode::FrontTransmission,
            channels: vec![Channel::Monochrome],
            geometry: Geometry::Specular(grid),
            values,
            tis: TIS.to_vec(),
        }
    }

    fn ray(theta_deg: f64) -> Beta {
        Beta::towards(theta_deg, 0.0, 1.0)
    }

    /// The light of a lobe leaves through a bare interface of index 1.5, without reflection back through the
    /// lobe. Lamination recovers the lobe. Near grazing, where the interface transmits little, the division
    /// is limited.
    #[test]
    fn lamination_removes_back_surface_loss() {
        let behind = part(|from, to| lobe(from, to) * (1.0 - fresnel_reflectance(1.0, 1.5, to.length())));
        let preparation =
            Preparation { lamination: Some(Lamination { index: 1.5 }), ..Preparation::default() };
        let (laminated, changes) = kernel(&behind, 0, &preparation, &[]).unwrap();
        let (seen, _) = kernel(&behind, 0, &Preparation::default(), &[]).unwrap();
        assert!(changes.laminated && changes.totals.iter().all(|[before, after]| after > before));
        for from in [0.0, 20.0, 40.0, 60.0].map(ray) {
            for (theta, phi) in [(0.0, 0.0), (15.0, 70.0), (35.0, 10.0), (60.0, 0.0), (70.0, 120.0)] {
                let to = Beta::towards(theta, phi, 1.0);
                let ratio = laminated.evaluate(from, to) / lobe(from, to);
                assert!((ratio - 1.0).abs() < 1e-3, "{from:?} {to:?}: {ratio}");
                // Without lamination the values include the loss of the interface, at least 4 %.
                assert!(seen.evaluate(from, to) < 0.965 * lobe(from, to), "{from:?} {to:?}");
            }
        }
    }

    /// Feng 2012, eq. 3-10: the integral of k f S, averaged over the spectrum, equals the instrument's TIS.
    #[test]
    fn totals_are_normalised_to_instrument_tis() {
        let spectrum = [0.2, 0.9, 0.95, 0.91];
        let mean = spectrum.iter().sum::<f64>() / 4.0;
        let preparation = Preparation { to_tis: true, ..Preparation::default() };
        let (scatter, changes) = kernel(&part(lobe), 0, &preparation, &spectrum).unwrap();
        for (k, tis) in TIS.into_iter().enumerate() {
            let averaged = mean * scatter.albedo_at(ray(20.0 * k as f64).x);
            assert!((averaged / tis - 1.0).abs() < 1e-3, "{k}: {averaged} {tis}");
            assert!((changes.totals[k][1] / tis - 1.0).abs() < 1e-3);
        }
        let without = MeasuredPart { tis: vec![0.0; 4], ..part(lobe) };
        assert_eq!(kernel(&without, 0, &preparation, &[]).unwrap_err(), GoniometryError::NoTis);
    }

    /// Beyond the last incidence, light is lost and the loss is reported; with extrapolation, the lobe is
    /// used about its own specular direction.
    #[test]
    fn light_beyond_last_incidence_is_lost_unless_extrapolated() {
        let [(none, lost), (hold, extended)] = [None, Some(1.0)].map(|extrapolate| {
            kernel(&part(lobe), 0, &Preparation { extrapolate, ..Preparation::default() }, &[]).unwrap()
        });
        assert!(
            (lost.lost - 0.25).abs() < 1e-12 && lost.last_deg == 60.0 && extended.lost == 0.0,
            "{lost:?}"
        );
        let (from, to) = (ray(75.0), ray(70.0));
        assert_eq!(none.evaluate(from, to), 0.0);
        assert!((hold.evaluate(from, to) / lobe(from, to) - 1.0).abs() < 3e-3, "{}", hold.evaluate(from, to));
    }

    /// With a single incidence, along the normal, the lobe is used at all incidences on request; otherwise
    /// others are dark.
    #[test]
    fn single_incidence_is_held_on_request() {
        let mut part = part(lobe);
        let Geometry::Specular(grid) = &mut part.geometry else { panic!("{:?}", part.geometry) };
        grid.incidences_deg.truncate(1);
        part.values.truncate(grid.cells());
        part.tis.truncate(1);
        let made = |extrapolate| {
            kernel(&part, 0, &Preparation { extrapolate, ..Preparation::default() }, &[]).unwrap()
        };
        let (none, lost) = made(None);
        let (hold, held) = made(Some(1.0));
        for (from, to) in [(0.0, 10.0), (20.0, 15.0), (70.0, 60.0)].map(|(from, to)| (ray(from), ray(to))) {
            let value = hold.evaluate(from, to);
            assert!((value / lobe(from, to) - 1.0).abs() < 3e-3, "{from:?}: {value}");
            assert_eq!(none.evaluate(from, to), if from.x == 0.0 { value } else { 0.0 });
        }
        assert_eq!((none.albedo_at(0.1), none.reversed().evaluate(ray(10.0), ray(20.0))), (0.0, 0.0));
        assert_eq!((lost.lost, lost.held_single, held.lost, held.held_single), (1.0, false, 0.0, true));
    }

    /// A dense measurement of a lobe that is no k-correlation (exponential) up to 80 deg: in the glass it holds the light of the true
    /// lobe at every incidence, by a sum over the disc of the glass. At 80 deg the line away from the normal ends 0.015 from the peak,
    /// and its slope there extrapolated to 1.4 times the light that arrives.
    #[test]
    fn tails_in_the_glass_conserve_light_at_oblique_incidence() {
        let exponential = |from: Beta, to: Beta| {
            let width = 0.15;
            0.9 * (-(to - from).length() / width).exp() / (2.0 * PI * width * width)
        };
        let mut part = part(exponential);
        let Geometry::Specular(grid) = &mut part.geometry else { panic!("{:?}", part.geometry) };
        grid.incidences_deg = (0..=16).map(|k| 5.0 * f64::from(k)).collect();
        part.values.clear();
        for theta in &grid.incidences_deg {
            for azimuth in &grid.azimuths_deg {
                part.values.extend(grid.radials_deg.iter().map(|radial| {
                    let to = SpecularGrid::direction(*theta, *azimuth, *radial);
                    to.map_or(0.0, |to| exponential(ray(*theta), to.leaving()))
                }));
            }
        }
        let preparation = Preparation { extrapolate: Some(1.5), ..Preparation::default() };
        let (scatter, changes) = kernel(&part, 0, &preparation, &[]).unwrap();
        let steps = 600;
        let middle = |k: i32| 1.5 * (f64::from(2 * k + 1) / f64::from(steps) - 1.0);
        for theta in [0.0, 40.0, 60.0, 75.0, 80.0] {
            let from = ray(theta);
            let squares =
                (0..steps).flat_map(|i| (0..steps).map(move |j| Beta { x: middle(i), y: middle(j) }));
            let sum: f64 = squares.filter(|to| to.squared() < 2.25).map(|to| exponential(from, to)).sum();
            let total = sum * (3.0 / f64::from(steps)).powi(2);
            let found = scatter.albedo_at(from.x);
            assert!((found / total - 1.0).abs() < 0.01, "{theta}: {found} instead of {total}");
        }
        assert!((changes.held - 0.0302).abs() < 1e-4 && changes.lost == 0.0, "{changes:?}");
    }

    /// Values in relative units take the level that is stated for the smallest incidence; the ratios of incidences remain.
    #[test]
    fn stated_level_scales_all_incidences() {
        let relative = part(|from, to| 17.0 * lobe(from, to));
        let level = |level| Preparation { level, ..Preparation::default() };
        let (scaled, changes) = kernel(&relative, 0, &level(Some(0.7)), &[]).unwrap();
        let (plain, _) = kernel(&part(lobe), 0, &level(None), &[]).unwrap();
        assert!((scaled.albedo_at(0.0) - 0.7).abs() < 1e-4 && changes.level == Some(0.7));
        let ratio = |theta: f64| scaled.albedo_at(ray(theta).x) / plain.albedo_at(ray(theta).x);
        assert!((ratio(60.0) / ratio(0.0) - 1.0).abs() < 1e-6);
    }

    /// Extrapolated tails in the glass equal the true lobe there.
    #[test]
    fn tails_are_extrapolated_into_the_glass() {
        let preparation = Preparation { extrapolate: Some(1.5), ..Preparation::default() };
        let (scatter, changes) = kernel(&part(lobe), 0, &preparation, &[]).unwrap();
        let back = scatter.reversed();
        for (from, to) in [(0.0, 1.2), (0.5, 1.1), (0.86, 1.45), (0.3, -1.4)] {
            let [from, to] = [from, to].map(|x| Beta { x, y: 0.0 });
            for value in [scatter.evaluate(from, to), back.evaluate(to, from)] {
                assert!((value / lobe(from, to) - 1.0).abs() < 1e-2, "{from:?} {to:?}: {value}");
            }
            assert_eq!(scatter.evaluate(to, from), 0.0);
        }
        let closed = Lobe::KCorrelation { width: WIDTH };
        for (k, length) in [0.0, 20.0, 40.0, 60.0].map(|theta| ray(theta).length()).into_iter().enumerate() {
            let (air, glass) =
                (0.8 * closed.fraction_in_disc(length, 1.0), 0.8 * closed.fraction_in_disc(length, 1.5));
            assert!((changes.totals[k][1] - air).abs() < 1e-4, "{k}: {air} {:?}", changes.totals[k]);
            assert!(
                (scatter.albedo_at(length) - glass).abs() < 3e-4,
                "{k}: {glass} {}",
                scatter.albedo_at(length)
            );
        }
        for length in [0.2, 0.97, 1.0, 1.003, 1.05, 1.2, 1.45] {
            let fraction = 0.8 * closed.fraction_in_disc(length, 1.0);
            assert!(
                (back.albedo_at(length) - fraction).abs() < 5e-4,
                "{length}: {fraction} {}",
                back.albedo_at(length)
            );
        }
    }
}
