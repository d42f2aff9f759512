//! From a part of a measurement to the kernel that light meets in a display.
//!
//! Nothing is changed that is not asked for, and [`Changes`] says what was: dark cells stay dark unless tails are to go on
//! through them, totals are the values' own unless they are to be the instrument's TIS, and light from
//! beyond the largest incidence is not let through unless the last lobe is to hold there.

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
    /// Beyond the largest incidence its lobe holds, shifted with the light; and of a transmission tails go on beyond the
    /// horizon of the air, into a medium of this index (1: air).
    pub extrapolate: Option<f64>,
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
    /// The largest incidence, degrees.
    pub last_deg: f64,
    /// Share of diffuse light that comes from beyond it, and is lost.
    pub lost: f64,
    /// Relative error of the totals that the grid leaves, the largest.
    pub grid_error: f64,
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
    let shape = Shape::of_grid(&grid, &cells, preparation.fill);
    let incidences: Vec<f64> = shape.incidences_deg().collect();
    let tis: Option<Vec<f64>> = (0..incidences.len()).map(|k| part.tis(channel, 0, k)).collect();
    let tis = match (preparation.to_tis, tis) {
        (true, None) => return Err(GoniometryError::NoTis),
        (true, tis) => tis,
        (false, _) => None,
    };
    let scale = incidence_scale(&shape, tis.as_deref(), spectrum);
    let mean = if spectrum.is_empty() { 1.0 } else { spectrum.iter().sum::<f64>() / spectrum.len() as f64 };
    let radial = distances(&shape, preparation.extrapolate.unwrap_or(1.0));
    let azimuth: Vec<f64> =
        (0..AZIMUTHS).map(|k| std::f64::consts::PI * k as f64 / (AZIMUTHS - 1) as f64).collect();
    let mounted = preparation.lamination.map(|face| face.removed(&grid, &cells, preparation.fill));
    let mut values = mounted.as_ref().unwrap_or(&shape).tabulate(&radial, &azimuth);
    for (lobe, scale) in values.chunks_exact_mut(radial.len() * azimuth.len()).zip(&scale) {
        lobe.iter_mut().for_each(|value| *value *= scale);
    }
    let incidence: Vec<f64> = incidences.iter().map(|theta| theta.to_radians().sin()).collect();
    let last = incidence[incidence.len() - 1];
    let table = Table::new(&incidence, &radial, &azimuth, &values)?;
    let table = if preparation.extrapolate.is_some() { table } else { table.dark_beyond() };
    let in_air = Scatter::from(table.clone());
    let totals = (0..incidences.len()).map(|k| [shape.total(k), mean * in_air.total(incidence[k])]).collect();
    let scatter = match preparation.extrapolate {
        Some(index) if index > 1.0 => Scatter::from(table.reaching(index)),
        _ => in_air,
    };
    let changes = Changes {
        filled: shape.filled(),
        totals,
        most: incidence.iter().map(|beta| mean * scatter.total(*beta)).fold(0.0, f64::max),
        to_tis: preparation.to_tis,
        laminated: preparation.lamination.is_some(),
        last_deg: incidences[incidences.len() - 1],
        lost: if preparation.extrapolate.is_some() { 0.0 } else { 1.0 - last * last },
        grid_error: (0..incidences.len()).map(|k| shape.grid_error(k)).fold(0.0, f64::max),
        asymmetry: shape.asymmetry(),
    };
    Ok((scatter, changes))
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
    use papilio_optics::Beta;
    use papilio_optics::lobe::Lobe;

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
                let ratio = film.value(from, to) / lobe(from, to);
                assert!((ratio - 1.0).abs() < 1e-3, "{from:?} {to:?}: {ratio}");
                // As it was seen it has the face's loss, 4 % and more.
                assert!(seen.value(from, to) < 0.965 * lobe(from, to), "{from:?} {to:?}");
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
            let averaged = mean * scatter.total(ray(20.0 * k as f64).x);
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
        assert_eq!(none.value(from, to), 0.0);
        assert!((hold.value(from, to) / lobe(from, to) - 1.0).abs() < 3e-3, "{}", hold.value(from, to));
    }

    /// Into the glass tails go on, and what they hold is the lobe's there.
    #[test]
    fn tails_go_on_into_the_glass() {
        let preparation = Preparation { extrapolate: Some(1.5), ..Preparation::default() };
        let (scatter, changes) = kernel(&part(lobe), 0, &preparation, &[]).unwrap();
        let back = scatter.reversed();
        for (from, to) in [(0.0, 1.2), (0.5, 1.1), (0.86, 1.45), (0.3, -1.4)] {
            let [from, to] = [from, to].map(|x| Beta { x, y: 0.0 });
            for value in [scatter.value(from, to), back.value(to, from)] {
                assert!((value / lobe(from, to) - 1.0).abs() < 1e-2, "{from:?} {to:?}: {value}");
            }
            assert_eq!(scatter.value(to, from), 0.0);
        }
        let closed = Lobe::KCorrelation { width: WIDTH };
        for (k, length) in [0.0, 20.0, 40.0, 60.0].map(|theta| ray(theta).length()).into_iter().enumerate() {
            let (air, glass) =
                (0.8 * closed.share_in_disc(length, 1.0), 0.8 * closed.share_in_disc(length, 1.5));
            assert!((changes.totals[k][1] - air).abs() < 1e-4, "{k}: {air} {:?}", changes.totals[k]);
            assert!((scatter.total(length) - glass).abs() < 3e-4, "{k}: {glass} {}", scatter.total(length));
        }
        for length in [0.2, 0.97, 1.0, 1.003, 1.05, 1.2, 1.45] {
            let share = 0.8 * closed.share_in_disc(length, 1.0);
            assert!((back.total(length) - share).abs() < 5e-4, "{length}: {share} {}", back.total(length));
        }
    }
}
