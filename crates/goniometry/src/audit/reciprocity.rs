//! Reciprocity: differences of f(i, o) and f(o, i) where both were measured.
//!
//! A grid of inclinations is compared at its own directions where those of the light are among those of the
//! viewer; with several azimuths of the light, rotations of a pair are different pairs. A grid about the specular direction is compared where all neighbouring cells have light, no more
//! than [`WIDEST_DEG`] apart in azimuth. Listed pairs are compared with those of the list in the opposite direction. Other
//! geometries have a value for each pair, or none. What is extrapolated or was not measured is never compared.

use papilio_optics::Beta;

use super::FAINT;
use crate::scattered::opposite_values;
use crate::shape::pair_interpolation;
use crate::{Direction, Geometry, MeasuredPart, Shape, SpecularGrid, SphericalGrid};

/// Largest distance of azimuths between which values count as measured, degrees.
const WIDEST_DEG: f64 = 45.0;
/// Angles that differ by less are equal, degrees.
const SAME_DEG: f64 = 1e-6;

/// Returns the root mean square and the maximum of the differences, relative to the mean of both; `None` if
/// no pair was measured.
pub(super) fn reciprocity(
    part: &MeasuredPart,
    channel: usize,
    (grid, values, shape): (&SpecularGrid, &[f64], &Shape),
    peak: f64,
) -> Option<[f64; 2]> {
    let mut sums = Sums { faint: FAINT * peak, ..Sums::default() };
    let listed = match &part.geometry {
        Geometry::Pairs(pairs) => opposite_values(pairs, part.channel(channel)),
        _ => Vec::new(),
    };
    match &part.geometry {
        Geometry::Pairs(_) if !listed.is_empty() || pair_interpolation(part, channel).is_some() => {
            listed.into_iter().for_each(|[there, back]| sums.add(Some(there), Some(back)));
        }
        Geometry::Spherical(own) => at_own_directions(own, part, channel, &mut sums),
        Geometry::Specular(_) | Geometry::Pairs(_) => {
            let f = |k: usize, to: Direction| {
                let from = Beta { x: grid.incidences_deg[k].to_radians().sin(), y: 0.0 };
                grid.is_surrounded(values, k, to, WIDEST_DEG).then(|| shape.value(k, to.leaving() - from))
            };
            for (i, from) in grid.incidences_deg.iter().enumerate() {
                for (j, to) in grid.incidences_deg.iter().enumerate().skip(i + 1) {
                    for azimuth in (0..=180).step_by(10).map(f64::from) {
                        sums.add(f(i, Direction::new(*to, azimuth)), f(j, Direction::new(*from, azimuth)));
                    }
                }
            }
        }
        _ => return of_pairs(part, channel, peak),
    }
    sums.relative()
}

/// Returns the same for a part with a value for each pair of directions, such as a tree.
pub(super) fn of_pairs(part: &MeasuredPart, channel: usize, peak: f64) -> Option<[f64; 2]> {
    let mut sums = Sums { faint: FAINT * peak, ..Sums::default() };
    // Off the symmetry planes of trees, whose cells have edges there.
    let lights: &[f64] =
        if part.geometry.is_isotropic() { &[180.0] } else { &[7.0, 79.0, 151.0, 223.0, 295.0] };
    for light in lights {
        for (from, to) in
            (0..17).flat_map(|i| (i + 1..18).map(move |j| (5.0 * f64::from(i), 5.0 * f64::from(j))))
        {
            for azimuth in (0..360).step_by(15).map(f64::from) {
                let [i, o] = [Direction::new(from, *light), Direction::new(to, light + azimuth)];
                sums.add(part.evaluate(channel, i, o), part.evaluate(channel, o, i));
            }
        }
    }
    sums.relative()
}

/// Compares values of a grid of inclinations. With one azimuth of the light, only differences of azimuths matter.
fn at_own_directions(grid: &SphericalGrid, part: &MeasuredPart, channel: usize, sums: &mut Sums) {
    let [light] = &grid.phi_i_deg[..] else { return at_all_azimuths(grid, part, channel, sums) };
    let place = |theta: f64| grid.theta_o_deg.iter().position(|own| (own - theta).abs() < SAME_DEG);
    let values = part.channel(channel);
    let value = |from: usize, to: f64, azimuth: usize| {
        let row = from * grid.theta_o_deg.len() + place(to)?;
        values.get(row * grid.phi_o_deg.len() + azimuth).copied().filter(|f| f.is_finite())
    };
    let is_on_both = grid.theta_i_deg.iter().filter(|theta| place(**theta).is_some()).count() > 1;
    for (i, from) in grid.theta_i_deg.iter().enumerate() {
        for (j, to) in grid.theta_i_deg.iter().enumerate().skip(i + 1) {
            for (k, azimuth) in grid.phi_o_deg.iter().enumerate() {
                if is_on_both {
                    sums.add(value(i, *to, k), value(j, *from, k));
                } else {
                    let between = |from: f64, to: f64| {
                        part.evaluate(channel, Direction::new(from, *light), Direction::new(to, *azimuth))
                    };
                    sums.add(between(*from, *to), between(*to, *from));
                }
            }
        }
    }
}

/// Compares values of a grid of inclinations with several azimuths of the light.
fn at_all_azimuths(grid: &SphericalGrid, part: &MeasuredPart, channel: usize, sums: &mut Sums) {
    for (k, from) in grid.theta_i_deg.iter().enumerate() {
        for to in &grid.theta_i_deg[k + 1..] {
            for (light, viewer) in grid
                .phi_i_deg
                .iter()
                .flat_map(|light| grid.phi_o_deg.iter().map(move |viewer| (*light, *viewer)))
            {
                let [i, o] = [Direction::new(*from, light), Direction::new(*to, viewer)];
                sums.add(part.evaluate(channel, i, o), part.evaluate(channel, o, i));
            }
        }
    }
}

/// Sums over pairs.
#[derive(Default)]
struct Sums {
    faint: f64,
    squares: f64,
    sizes: f64,
    worst: f64,
}

impl Sums {
    /// Adds a pair if both values were measured and are not faint.
    fn add(&mut self, there: Option<f64>, back: Option<f64>) {
        let Some((a, b)) = there.zip(back) else { return };
        if a.min(b) > self.faint {
            let mean = 0.5 * (a + b);
            self.squares += (a - b).powi(2);
            self.sizes += mean * mean;
            self.worst = self.worst.max((a - b).abs() / mean);
        }
    }

    fn relative(&self) -> Option<[f64; 2]> {
        (self.sizes > 0.0).then(|| [(self.squares / self.sizes).sqrt(), self.worst])
    }
}
