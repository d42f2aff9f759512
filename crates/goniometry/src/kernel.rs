//! From a part of a measurement to the kernel that light meets in a display.
//!
//! Nothing is changed that is not asked for, and [`Changes`] says what was: dark cells stay dark unless tails are to go on
//! through them, totals are the values' own unless they are to be the instrument's TIS, light from
//! beyond the largest incidence is not let through unless the last lobe is to hold there, and none is sent beyond the last
//! measured distance from the specular direction unless tails are to go on there.

use papilio_optics::interface::fresnel_reflectance;
use papilio_optics::scatter::{Scatter, Table};

use crate::shape::on_specular_grid;
use crate::{Fill, Geometry, GoniometryError, Part, Shape, SpecularGrid, incidence_scale};

/// Distances of the table: `w sinh(t)` in such steps of t, w a half-width. Interpolation by cubics is good to
/// 1e-4 then.
const STEP: f64 = 0.125;
/// Azimuths of the table.
const AZIMUTHS: usize = 19;
/// A lobe this wide (direction cosines) needs no finer distances.
const WIDEST: f64 = 0.5;
/// Distances are no farther apart: next to the horizon transmission falls fast.
const COARSEST: f64 = 0.025;

/// What may be done to a measurement on its way into a display.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Preparation {
    /// Dark cells.
    pub fill: Fill,
    /// Totals become the instrument's TIS.
    pub to_tis: bool,
    /// Beyond the largest incidence its lobe holds, shifted with the light; tails go on beyond the last measured distance
    /// from the specular direction; and of a transmission beyond the horizon of the air, into a medium of this index (1:
    /// air).
    pub extrapolate: Option<f64>,
    /// The lobe of a measurement that has one incidence holds at all others, as if `extrapolate` were 1.
    pub hold_single: bool,
    /// Of a transmission: its back face in air is removed.
    pub lamination: Option<Lamination>,
}

/// A film that was measured in air, and in the display touches the glass: the Fresnel loss of its back face is
/// taken out of what it transmits, `f / T(beta_out)` with T of a face of this index.
///
/// To first order: light that the back face sent into the film again is not followed. Next to grazing, where T falls
/// below .1, the tail of the divided lobe goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamination {
    /// Index of film and glass.
    pub index: f64,
}

/// Where the face passes less than this, tails go on.
const LEAST_PASSED: f64 = 0.1;

/// What was done, and what is left open.
#[derive(Debug, Clone, PartialEq)]
pub struct Changes {
    /// Share of the cells in the hemisphere that were dark and filled.
    pub filled: f64,
    /// Totals in air before and after, by incidence.
    pub totals: Vec<[f64; 2]>,
    /// The largest total, with what goes into the glass beyond the horizon of the air.
    pub most: f64,
    /// True if totals became the instrument's.
    pub to_tis: bool,
    /// True if the loss of a back face was taken out.
    pub laminated: bool,
    /// The least distance from the specular direction, degrees, at which measured cells end before the horizon does.
    pub measured_to_deg: Option<f64>,
    /// By incidence: its degrees, and the share of the light that lies beyond the last measured distance if tails go on.
    pub beyond: Vec<[f64; 2]>,
    /// True if tails go on there; else that light is lost.
    pub tails: bool,
    /// First and last azimuth, degrees from the plane of incidence, where they are not 0 and 180: beyond them the nearest holds.
    pub held_azimuths_deg: Option<[f64; 2]>,
    /// True if the lobe of the only incidence holds at all others because the measurement has no other.
    pub held_single: bool,
    /// The largest incidence, degrees.
    pub last_deg: f64,
    /// Share of diffuse light that comes from beyond it, and is lost.
    pub lost: f64,
    /// Relative error of the totals that the grid leaves, the largest.
    pub grid_error: f64,
    /// The largest that its azimuths leave; part of `grid_error`.
    pub azimuth_error: f64,
    /// Mirrored and turned cells differed by so much (root mean square, relative).
    pub asymmetry: f64,
}

/// The kernel of one channel of a part, times k of each incidence (see
/// [`incidence_scale`]); `spectrum` is what it will be multiplied with, at evenly spaced
/// wavelengths (empty: 1).
///
/// # Errors
/// If the part has no lobe of its own (patches), lacks the TIS that is asked for, or a table cannot hold it.
pub fn kernel(
    part: &Part,
    channel: usize,
    preparation: &Preparation,
    spectrum: &[f64],
) -> Result<(Scatter, Changes), GoniometryError> {
    // Patches of ten degrees hide what a display shows.
    let coarse = matches!(part.geometry, Geometry::Patches { .. });
    let (grid, cells) =
        on_specular_grid(part, &[channel]).filter(|_| !coarse).ok_or(GoniometryError::NoGrid)?;
    let held_single =
        preparation.hold_single && preparation.extrapolate.is_none() && grid.incidences_deg.len() == 1;
    let extrapolate = preparation.extrapolate.or(held_single.then_some(1.0));
    let fill = match preparation.fill {
        Fill::None if extrapolate.is_some() => Fill::Beyond,
        fill => fill,
    };
    let shape = Shape::of_grid(&grid, &cells, fill);
    let incidences: Vec<f64> = shape.incidences_deg().collect();
    // The lobe is the mean over rotations, and so is its total.
    let tis: Option<Vec<f64>> = (0..incidences.len()).map(|k| part.mean_tis(channel, k)).collect();
    let tis = match (preparation.to_tis, tis) {
        (true, None) => return Err(GoniometryError::NoTis),
        (true, tis) => tis,
        (false, _) => None,
    };
    let scale = incidence_scale(&shape, tis.as_deref(), spectrum);
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
        most: incidence.iter().map(|beta| mean * scatter.albedo_at(*beta)).fold(0.0, f64::max),
        to_tis: preparation.to_tis,
        laminated: preparation.lamination.is_some(),
        measured_to_deg: least_measured_deg(&shape),
        beyond: beyond(&shape, &grid, &cells, fill),
        tails: fill != Fill::None,
        held_azimuths_deg: shape.held_azimuths_deg(),
        held_single,
        last_deg: incidences[incidences.len() - 1],
        lost: if extrapolate.is_some() { 0.0 } else { 1.0 - last * last },
        grid_error: largest(|[by_distance, by_azimuth]| by_distance + by_azimuth),
        azimuth_error: largest(|[_, by_azimuth]| *by_azimuth),
        asymmetry: shape.asymmetry(),
    };
    Ok((scatter, changes))
}

/// The numbers of a shape, those of each incidence times its scale.
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
    // No node lies on the edge of a lobe that ends: its light is right, its edge is as wide as the nodes are apart.
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

/// By incidence: its degrees, and the share of the light that lies beyond the last measured distance if tails go on; empty
/// where the measured cells reach the horizon all around.
fn beyond(shape: &Shape, grid: &SpecularGrid, cells: &[f64], fill: Fill) -> Vec<[f64; 2]> {
    if least_measured_deg(shape).is_none() {
        return Vec::new();
    }
    // Where tails go on through dark cells too, what they hold there is counted with it.
    let [known, with_tails] = [Fill::None, if fill == Fill::Tail { fill } else { Fill::Beyond }]
        .map(|fill| Shape::of_grid(grid, cells, fill));
    let share = |k: usize| match with_tails.total(k) {
        all if all > 0.0 => (1.0 - known.total(k) / all).max(0.0),
        _ => 0.0,
    };
    with_tails.incidences_deg().enumerate().map(|(k, theta)| [theta, share(k)]).collect()
}

/// The least distance at which the measured cells of any incidence end before the horizon.
fn least_measured_deg(shape: &Shape) -> Option<f64> {
    let ends = (0..shape.incidences_deg().count()).filter_map(|k| shape.measured_to_deg(k));
    ends.min_by(f64::total_cmp)
}

impl Lamination {
    /// The lobe of a grid's cells without the face. Cells are divided before they become a smooth lobe, which the face's
    /// loss next to grazing would not let it be.
    fn removed(&self, grid: &SpecularGrid, cells: &[f64], fill: Fill) -> Shape {
        let passed = |beta: f64| 1.0 - fresnel_reflectance(1.0, self.index, beta);
        let horizon = (0..=900).map(|k| (0.1 * f64::from(k)).to_radians().sin());
        let horizon = horizon.take_while(|beta| passed(*beta) >= LEAST_PASSED).last().unwrap_or(0.0);
        let of = |cell: usize| {
            grid.directions(cell).map_or(1.0, |[_, to]| passed(to.leaving().length()).max(LEAST_PASSED))
        };
        let divided: Vec<f64> = cells.iter().enumerate().map(|(cell, value)| value / of(cell)).collect();
        Shape::of_grid_within(grid, &divided, fill, horizon)
    }
}

/// Distances from the peak, fine where the lobe falls, up to across the discs of air and of this radius.
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
    use crate::{Channel, SpecularGrid, Symmetry, Way};
    use papilio_optics::lobe::Lobe;
    use papilio_optics::{Beta, Scatterer};

    const WIDTH: f64 = 0.1;
    const TIS: [f64; 4] = [0.9, 0.88, 0.8, 0.7];

    fn lobe(from: Beta, to: Beta) -> f64 {
        0.8 * WIDTH / (2.0 * PI * (WIDTH * WIDTH + (to - from).squared()).powf(1.5))
    }

    /// A film on a grid of one degree, seen as `f`.
    fn part(f: impl Fn(Beta, Beta) -> f64) -> Part {
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
        Part {
            way: Way::FrontTransmission,
            channels: vec![Channel::Monochrome],
            geometry: Geometry::Specular(grid),
            values,
            tis: TIS.to_vec(),
        }
    }

    fn ray(theta_deg: f64) -> Beta {
        Beta::towards(theta_deg, 0.0, 1.0)
    }

    /// A lobe whose light goes out through a bare face of 1.5, which sends nothing back through the lobe: laminated, it is
    /// the lobe alone. Next to grazing the face passes little, and the division ends.
    #[test]
    fn laminated_films_are_rid_of_their_back_face() {
        let behind = part(|from, to| lobe(from, to) * (1.0 - fresnel_reflectance(1.0, 1.5, to.length())));
        let preparation =
            Preparation { lamination: Some(Lamination { index: 1.5 }), ..Preparation::default() };
        let (film, changes) = kernel(&behind, 0, &preparation, &[]).unwrap();
        let (seen, _) = kernel(&behind, 0, &Preparation::default(), &[]).unwrap();
        assert!(changes.laminated && changes.totals.iter().all(|[before, after]| after > before));
        for from in [0.0, 20.0, 40.0, 60.0].map(ray) {
            for (theta, phi) in [(0.0, 0.0), (15.0, 70.0), (35.0, 10.0), (60.0, 0.0), (70.0, 120.0)] {
                let to = Beta::towards(theta, phi, 1.0);
                let ratio = film.evaluate(from, to) / lobe(from, to);
                assert!((ratio - 1.0).abs() < 1e-3, "{from:?} {to:?}: {ratio}");
                // As it was seen it has the face's loss, 4 % and more.
                assert!(seen.evaluate(from, to) < 0.965 * lobe(from, to), "{from:?} {to:?}");
            }
        }
    }

    /// Feng 2012, eq. 3-10: the integral of k f S, averaged over the spectrum, is the instrument's TIS.
    #[test]
    fn totals_become_the_instruments() {
        let spectrum = [0.2, 0.9, 0.95, 0.91];
        let mean = spectrum.iter().sum::<f64>() / 4.0;
        let preparation = Preparation { to_tis: true, ..Preparation::default() };
        let (scatter, changes) = kernel(&part(lobe), 0, &preparation, &spectrum).unwrap();
        for (k, tis) in TIS.into_iter().enumerate() {
            let averaged = mean * scatter.albedo_at(ray(20.0 * k as f64).x);
            assert!((averaged / tis - 1.0).abs() < 1e-3, "{k}: {averaged} {tis}");
            assert!((changes.totals[k][1] / tis - 1.0).abs() < 1e-3);
        }
        let without = Part { tis: vec![0.0; 4], ..part(lobe) };
        assert_eq!(kernel(&without, 0, &preparation, &[]).unwrap_err(), GoniometryError::NoTis);
    }

    /// Beyond the last incidence light is lost, and it is said how much; or the lobe holds about its own direction.
    #[test]
    fn beyond_the_last_incidence() {
        let [(none, lost), (hold, kept)] = [None, Some(1.0)].map(|extrapolate| {
            kernel(&part(lobe), 0, &Preparation { extrapolate, ..Preparation::default() }, &[]).unwrap()
        });
        assert!((lost.lost - 0.25).abs() < 1e-12 && lost.last_deg == 60.0 && kept.lost == 0.0, "{lost:?}");
        let (from, to) = (ray(75.0), ray(70.0));
        assert_eq!(none.evaluate(from, to), 0.0);
        assert!((hold.evaluate(from, to) / lobe(from, to) - 1.0).abs() < 3e-3, "{}", hold.evaluate(from, to));
    }

    /// With a single incidence, along the normal, the lobe holds if it is to, or nothing else is sent.
    #[test]
    fn a_single_incidence() {
        let mut part = part(lobe);
        let Geometry::Specular(grid) = &mut part.geometry else { panic!("{:?}", part.geometry) };
        grid.incidences_deg.truncate(1);
        part.values.truncate(grid.cells());
        part.tis.truncate(1);
        let made = |extrapolate, hold_single| {
            let preparation = Preparation { extrapolate, hold_single, ..Preparation::default() };
            kernel(&part, 0, &preparation, &[]).unwrap()
        };
        let (none, lost) = made(None, false);
        let (default, held) = made(None, true);
        let (hold, _) = made(Some(1.0), true);
        for (from, to) in [(0.0, 10.0), (20.0, 15.0), (70.0, 60.0)].map(|(from, to)| (ray(from), ray(to))) {
            let value = hold.evaluate(from, to);
            assert!((value / lobe(from, to) - 1.0).abs() < 3e-3, "{from:?}: {value}");
            assert_eq!(default.evaluate(from, to), value);
            assert_eq!(none.evaluate(from, to), if from.x == 0.0 { value } else { 0.0 });
        }
        assert_eq!((none.albedo_at(0.1), none.reversed().evaluate(ray(10.0), ray(20.0))), (0.0, 0.0));
        assert_eq!((lost.lost, lost.held_single, held.lost, held.held_single), (1.0, false, 0.0, true));
    }

    /// Into the glass tails go on, and what they hold is the lobe's there.
    #[test]
    fn tails_go_on_into_the_glass() {
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
            let share = 0.8 * closed.fraction_in_disc(length, 1.0);
            assert!(
                (back.albedo_at(length) - share).abs() < 5e-4,
                "{length}: {share} {}",
                back.albedo_at(length)
            );
        }
    }
}
