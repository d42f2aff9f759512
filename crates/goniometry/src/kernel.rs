//! Conversion of a part of a measurement to the scattering kernel of a display.
//!
//! By default, dark cells stay dark, totals are those of the values, light from beyond the largest incidence
//! is blocked, and no light is sent beyond the last measured distance from the specular direction. Options
//! fill dark cells, set the level of the totals, and extrapolate beyond the largest incidence
//! and the last distance. [`Changes`] reports every change.
//!
//! Light that left a sample in air through a smooth face is interpolated below that face, where it does not fall
//! towards the horizon ([`face_of`]).

use papilio_optics::interface::fresnel_reflectance;
use papilio_optics::scatter::{Scatter, Table};
use papilio_optics::{Beta, Scatterer};

use crate::face::face_of;
use crate::shape::{Extent, Resampling, inclined_to_deg, on_specular_grid, pair_interpolation};
use crate::tree::{RING_DEG, moved_by_rings, ring_kernel};
use crate::{
    Direction, Fill, Geometry, GoniometryError, MeasuredPart, PairErrors, Shape, SpecularGrid, TensorTree,
    incidence_scale,
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
    /// Total at the smallest incidence: all values are multiplied by one factor. For values in relative
    /// units.
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
pub(crate) const MIN_TRANSMITTANCE: f64 = 0.1;

/// Last cells of a row of a warped grid, degrees of the viewer's inclination over the number of columns: nodes below
/// the horizon hold 0, and f cos is no straight line to them.
const WARPED_CELL_DEG: f64 = 256.0;
/// The most that they may be, degrees.
const WARPED_MOST_DEG: f64 = 5.0;

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
    /// Index below a smooth face, if light falls towards the horizon as through one: the lobe is interpolated below it.
    pub face: Option<f64>,
    /// Smallest distance from the specular direction, degrees, at which measured cells end before the
    /// horizon.
    pub measured_to_deg: Option<f64>,
    /// Incidence, degrees, and fraction of the light beyond the last measured distance if tails are
    /// extrapolated.
    pub beyond: Vec<[f64; 2]>,
    /// Incidence, degrees, beyond the largest one, and fraction of its light that is farther from the specular direction
    /// than anything that was measured.
    pub held_beyond: Option<[f64; 2]>,
    /// True if tails are extrapolated there; otherwise that light is lost.
    pub tails: bool,
    /// First and last azimuth, degrees from the plane of incidence, if not 0 and 180; beyond them the nearest
    /// value is used.
    pub held_azimuths_deg: Option<[f64; 2]>,
    /// True if the measurement has a single incidence, whose lobe is used at all others.
    pub held_single: bool,
    /// Largest inclination to which light was measured, degrees, if a grid of inclinations ends before the
    /// horizon.
    pub inclined_to_deg: Option<f64>,
    /// Errors of the interpolation, if the values are those of listed pairs of directions that form no grid.
    pub pairs: Option<PairErrors>,
    /// Width of the rings over which light is spread, degrees, if the values are constant over cells (trees).
    pub rings_deg: Option<f64>,
    /// Largest incidence, degrees.
    pub last_deg: f64,
    /// Fraction of diffuse light that comes from beyond the largest incidence, for which the last lobe is
    /// used.
    pub held: f64,
    /// Fraction of diffuse light that comes from beyond the largest incidence, and is lost.
    pub lost: f64,
    /// Largest relative uncertainty of the totals from the grid; `None` for listed pairs, for which it is not
    /// known.
    pub grid_error: Option<f64>,
    /// The same from the grid's azimuths alone; included in `grid_error`.
    pub azimuth_error: Option<f64>,
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
    let extent = Extent {
        inclined_to_deg: inclined_to_deg(part, channel),
        horizon: horizon(part),
        ..Extent::default()
    };
    let shape =
        Shape::of_extent(&grid, &cells, fill, extent).resampled(&Resampling::new(part, channel, &grid));
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
    let is_in_air = preparation.lamination.is_none() && extrapolate.is_none_or(|index| index <= 1.0);
    let face = if is_in_air { face_of(&grid, &cells, extent.horizon) } else { None };
    let removed = preparation.lamination.or(face).map(|face| face.removed(&grid, &cells, fill, extent));
    let below = face.map_or_else(
        || scale.clone(),
        |face| scale.iter().zip(&incidences).map(|(scale, theta)| scale / face.passed_at(*theta)).collect(),
    );
    let table =
        table(removed.as_ref().unwrap_or(&shape), &below, distances(&shape, extrapolate.unwrap_or(1.0)))?;
    let table = match face {
        Some(face) => table.behind_face(face.index),
        None => table,
    };
    let table = match (extrapolate, extent.inclined_to_deg.filter(|_| fill == Fill::None)) {
        (Some(_), _) => table,
        (None, None) => table.dark_beyond(),
        (None, Some(theta)) => table.dark_beyond().ending(theta.to_radians().sin()),
    };
    let incidence: Vec<f64> = incidences.iter().map(|theta| theta.to_radians().sin()).collect();
    let last = incidence[incidence.len() - 1];
    let in_air = Scatter::from(table.clone());
    let totals =
        (0..incidences.len()).map(|k| [shape.total(k), mean * in_air.albedo_at(incidence[k])]).collect();
    let scatter = match extrapolate {
        Some(index) if index > 1.0 => Scatter::from(table.reaching(index)),
        _ => in_air,
    };
    let pairs = pair_interpolation(part, channel);
    let grid_errors: Vec<[f64; 2]> = (0..incidences.len()).map(|k| shape.grid_errors(k)).collect();
    let is_grid = pairs.is_none();
    let largest = |of: fn(&[f64; 2]) -> f64| is_grid.then(|| grid_errors.iter().map(of).fold(0.0, f64::max));
    let changes = Changes {
        filled: shape.filled(),
        totals,
        largest: cells.iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max),
        most: incidence.iter().map(|beta| mean * scatter.albedo_at(*beta)).fold(0.0, f64::max),
        to_tis: preparation.to_tis,
        level: preparation.level,
        laminated: preparation.lamination.is_some(),
        face: face.map(|face| face.index),
        measured_to_deg: least_measured_deg(&shape),
        beyond: beyond(&shape, &grid, &cells, (fill, extent)),
        held_beyond: extrapolate.and_then(|_| held_beyond(&scatter, &shape)),
        tails: fill != Fill::None,
        held_azimuths_deg: shape.held_azimuths_deg(),
        held_single,
        inclined_to_deg: extent.inclined_to_deg,
        pairs: pairs.as_ref().map(|pairs| pairs.errors()),
        rings_deg: None,
        last_deg: incidences[incidences.len() - 1],
        held: if extrapolate.is_some() { 1.0 - last * last } else { 0.0 },
        lost: if extrapolate.is_some() { 0.0 } else { 1.0 - last * last },
        grid_error: largest(|[by_distance, by_azimuth]| by_distance + by_azimuth),
        azimuth_error: largest(|[_, by_azimuth]| *by_azimuth),
        asymmetry: pairs.map_or(shape.asymmetry(), |pairs| pairs.asymmetry()),
    };
    Ok((scatter, changes))
}

/// Returns the kernel of a part on a tree: light between rings. Nothing is extrapolated, because a tree has
/// values for all directions.
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
    let as_measured = match preparation.lamination {
        Some(_) => Scatter::from(ring_kernel(part, tree, channel, |_| 1.0)),
        None => scatter.clone(),
    };
    let moved = |theta: f64| moved_by_rings(part, tree, channel, &as_measured, theta);
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
        face: None,
        measured_to_deg: None,
        beyond: Vec::new(),
        held_beyond: None,
        tails: false,
        held_azimuths_deg: None,
        held_single: false,
        inclined_to_deg: None,
        pairs: None,
        rings_deg: Some(f64::from(RING_DEG)),
        last_deg: 90.0,
        held: 0.0,
        lost: 0.0,
        grid_error: Some([0.0, 30.0, 60.0].map(moved).into_iter().fold(0.0, f64::max)),
        azimuth_error: Some(0.0),
        asymmetry: tree.asymmetry(values),
    };
    Ok((scatter, changes))
}

/// Largest `|beta|` of scattered light up to which f is known.
fn horizon(part: &MeasuredPart) -> f64 {
    let Geometry::Warped(grid) = &part.geometry else { return 1.0 };
    let cells_deg = WARPED_CELL_DEG / grid.fields().shape[1] as f64;
    (90.0 - cells_deg.min(WARPED_MOST_DEG)).to_radians().sin()
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
fn beyond(
    shape: &Shape,
    grid: &SpecularGrid,
    cells: &[f64],
    (fill, extent): (Fill, Extent),
) -> Vec<[f64; 2]> {
    if least_measured_deg(shape).is_none() {
        return Vec::new();
    }
    // If dark cells are filled too, the light in them is included.
    let [known, with_tails] = [Fill::None, if fill == Fill::Tail { fill } else { Fill::Beyond }]
        .map(|fill| Shape::of_extent(grid, cells, fill, extent));
    let fraction = |k: usize| match with_tails.total(k) {
        all if all > 0.0 => (1.0 - known.total(k) / all).max(0.0),
        _ => 0.0,
    };
    with_tails.incidences_deg().enumerate().map(|(k, theta)| [theta, fraction(k)]).collect()
}

/// Incidence at which the light of a held lobe is examined, degrees.
const HELD_DEG: f64 = 60.0;
/// Points of its hemisphere, in the square of the inclination's sine and in azimuth.
const HELD_POINTS: [usize; 2] = [100, 180];

/// Incidence, degrees, for which the lobe of the largest measured one is used, and the fraction of its light that is
/// farther from the specular direction than anything of that lobe that was measured; `None` if this incidence was
/// measured.
fn held_beyond(lobe: &Scatter, shape: &Shape) -> Option<[f64; 2]> {
    let (last, last_deg) =
        shape.incidences_deg().enumerate().last().filter(|(_, theta)| *theta < HELD_DEG)?;
    let [from, of_last] = [HELD_DEG, last_deg].map(|theta| Beta { x: theta.to_radians().sin(), y: 0.0 });
    let limit = shape.measured_to_deg(last).map_or(-1.0, |to_deg| to_deg.to_radians().cos());
    let specular = Direction::new(last_deg, 0.0).vector();
    let is_measured = |to: Beta| {
        let [x, y] = [of_last.x + to.x - from.x, of_last.y + to.y - from.y];
        let square = x * x + y * y;
        square <= 1.0 && x * specular[0] + (1.0 - square).sqrt() * specular[2] >= limit
    };
    let [along, around] = HELD_POINTS;
    let mut sum = 0.0;
    for k in 0..along * around {
        let [r, turn] =
            [((k / around) as f64 + 0.5) / along as f64, ((k % around) as f64 + 0.5) / around as f64];
        let (y, x) = (std::f64::consts::TAU * turn).sin_cos();
        let to = Beta { x: r.sqrt() * x, y: r.sqrt() * y };
        if !is_measured(to) {
            sum += lobe.evaluate(from, to);
        }
    }
    let beyond = std::f64::consts::PI * sum / (along * around) as f64;
    let total = lobe.albedo_at(from.x);
    (total > 0.0).then_some([HELD_DEG, beyond / total])
}

/// Smallest distance at which the measured cells of any incidence end before the horizon.
fn least_measured_deg(shape: &Shape) -> Option<f64> {
    let ends = (0..shape.incidences_deg().count()).filter_map(|k| shape.measured_to_deg(k));
    ends.min_by(f64::total_cmp)
}

impl Lamination {
    /// Transmittance of the interface at a `|beta|`.
    pub(crate) fn passed(&self, beta: f64) -> f64 {
        1.0 - fresnel_reflectance(1.0, self.index, beta)
    }

    /// The same at an inclination in air, at least as much as cells are divided by.
    pub(crate) fn passed_at(&self, theta_deg: f64) -> f64 {
        self.passed(theta_deg.to_radians().sin()).max(MIN_TRANSMITTANCE)
    }

    /// Lobe of a grid's cells without the interface. Cells are divided before the smooth lobe is formed,
    /// because the loss of the interface near grazing is not smooth.
    fn removed(&self, grid: &SpecularGrid, cells: &[f64], fill: Fill, extent: Extent) -> Shape {
        let passed = |beta: f64| self.passed(beta);
        let horizon = (0..=900).map(|k| (0.1 * f64::from(k)).to_radians().sin());
        let horizon = horizon.take_while(|beta| passed(*beta) >= MIN_TRANSMITTANCE).last().unwrap_or(0.0);
        let horizon = horizon.min(extent.horizon);
        let transmittance = |cell: usize| {
            grid.directions(cell).map_or(1.0, |[_, to]| passed(to.leaving().length()).max(MIN_TRANSMITTANCE))
        };
        let divided: Vec<f64> =
            cells.iter().enumerate().map(|(cell, value)| value / transmittance(cell)).collect();
        Shape::of_extent(grid, &divided, fill, Extent { horizon, ..extent })
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
mod tests;
