//! Azimuths that cover one side of the plane of incidence, or both, however they are counted.
//!
//! Instruments measure half a circle on either side of the plane of incidence (0 to 180 deg, or -180 to 0
//! deg, which is 180 to 360 deg, from the light), or a whole circle. The two sides of an isotropic sample are
//! mirror images, so that a half circle becomes 0 to 180 deg.

use super::{Geometry, SpecularGrid, SphericalGrid, Symmetry};
use crate::MeasuredPart;

/// Azimuths that differ by less are the same, degrees: the rounding of radians with three decimals.
pub(super) const SAME_DEG: f64 = 0.03;

/// Azimuths of the scattered light that cover too little: neither half a circle nor a whole one, or, for
/// light from azimuths outside one plane, no whole one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartOfCircle {
    /// The first azimuth from that of the light, degrees.
    pub from_deg: f64,
    /// The last azimuth from that of the light, degrees.
    pub to_deg: f64,
    /// Whether the azimuths of the light lie in one plane of incidence.
    pub in_one_plane: bool,
}

/// Azimuths that were measured on both sides of the plane of incidence, where a file covers more than one of
/// them and not both. Their values are averaged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// The first of them on one side, degrees.
    pub from_deg: f64,
    /// The last of them, degrees.
    pub to_deg: f64,
    /// Mean difference between both sides, over the mean of their values.
    pub difference: f64,
}

/// Ascending azimuths, each with the places on the axis of the file over which it is averaged.
type Azimuths = Vec<(f64, Vec<usize>)>;

/// What an axis of azimuths covers.
#[derive(Debug, Clone, PartialEq)]
enum Cover {
    /// The whole circle, or a single azimuth, which stands for all.
    Whole,
    /// 0 to 180 deg.
    Half,
    /// 0 to 180 deg once the other side is mirrored.
    Mirrored(Azimuths),
    /// Less.
    Part,
}

impl MeasuredPart {
    /// Returns the azimuths at which [`on_one_side`](Self::on_one_side) averages both sides of the plane of
    /// incidence; `None` if there are none.
    pub fn overlap(&self) -> Option<Overlap> {
        let (axis, cover, per_azimuth) = match &self.geometry {
            Geometry::Spherical(grid) if grid.phi_i_deg.len() == 1 => {
                let axis: Vec<f64> = grid.phi_o_deg.iter().map(|phi| phi - grid.phi_i_deg[0]).collect();
                (axis.clone(), cover(&axis), 1)
            }
            Geometry::Specular(grid) if grid.symmetry != Symmetry::Plane && grid.rotations_deg.len() < 2 => {
                (grid.azimuths_deg.clone(), cover(&grid.azimuths_deg), grid.radials_deg.len())
            }
            _ => return None,
        };
        let Cover::Mirrored(azimuths) = cover else { return None };
        let is_beyond = |k: &&usize| axis[**k].rem_euclid(360.0) > 180.0;
        let (mut found, mut apart, mut sum) = (None::<[f64; 2]>, 0.0, 0.0);
        for (azimuth, at) in azimuths.iter().filter(|(azimuth, _)| *azimuth > 0.0 && *azimuth < 180.0) {
            let (there, here): (Vec<&usize>, Vec<&usize>) = at.iter().partition(is_beyond);
            if here.is_empty() || there.is_empty() {
                continue;
            }
            found = Some([found.map_or(*azimuth, |[from, _]| from), *azimuth]);
            for cells in self.values.chunks_exact(axis.len() * per_azimuth) {
                for cell in 0..per_azimuth {
                    let side = |side: &[&usize]| mean(side.iter().map(|k| cells[**k * per_azimuth + cell]));
                    let [a, b] = [side(&here), side(&there)];
                    if a.is_finite() && b.is_finite() {
                        apart += (a - b).abs();
                        sum += 0.5 * (a + b).abs();
                    }
                }
            }
        }
        let difference = if apart > 0.0 { apart / sum } else { 0.0 };
        found.map(|[from_deg, to_deg]| Overlap { from_deg, to_deg, difference })
    }

    /// Returns the part with azimuths from 0 to 180 deg from the light if those of a grid cover half a circle
    /// on any side of the plane of incidence. Whole circles, and grids with a single azimuth, are returned as
    /// they are, and so are all other geometries.
    ///
    /// # Errors
    /// If the azimuths of a grid of inclinations cover neither half a circle nor a whole one.
    pub fn on_one_side(mut self) -> Result<Self, PartOfCircle> {
        match &mut self.geometry {
            Geometry::Spherical(grid) => {
                if let Some(azimuths) = of_spherical(grid)? {
                    let light = grid.phi_i_deg.first().copied().unwrap_or(0.0);
                    let rows = self.values.chunks_exact(grid.phi_o_deg.len());
                    let of_row = |row: &[f64]| -> Vec<f64> {
                        azimuths.iter().map(|(_, at)| mean(at.iter().map(|k| row[*k]))).collect()
                    };
                    self.values = rows.flat_map(of_row).collect();
                    grid.phi_o_deg = azimuths.iter().map(|(azimuth, _)| light + azimuth).collect();
                }
            }
            Geometry::Specular(grid) => of_specular(grid, &mut self.values),
            _ => {}
        }
        Ok(self)
    }
}

/// Returns the azimuths of a grid from its first light, if they are not those of its axis.
fn of_spherical(grid: &SphericalGrid) -> Result<Option<Azimuths>, PartOfCircle> {
    let Some(light) = grid.phi_i_deg.first() else { return Ok(None) };
    let relative: Vec<f64> = grid.phi_o_deg.iter().map(|phi| phi - light).collect();
    let mirrored = match cover(&relative) {
        Cover::Whole => return Ok(None),
        Cover::Half if grid.phi_i_deg.len() == 1 => return Ok(None),
        Cover::Mirrored(azimuths) if grid.phi_i_deg.len() == 1 => return Ok(Some(azimuths)),
        Cover::Half | Cover::Mirrored(_) => folded(&relative),
        Cover::Part => Vec::new(),
    };
    // Lights on both sides of the normal share the plane of incidence: both sides of it are written out,
    // because each has its own half.
    let in_one_plane = grid.phi_i_deg.iter().all(|phi| within_half(2.0 * (phi - light)) < 2.0 * SAME_DEG);
    if mirrored.is_empty() || !in_one_plane {
        let ends = [relative.first(), relative.last()].map(|end| end.copied().unwrap_or(0.0));
        return Err(PartOfCircle { from_deg: ends[0], to_deg: ends[1], in_one_plane });
    }
    let on_the_axis = |azimuth: f64| -> Vec<usize> {
        let is_here = |phi: f64| within_half(phi - azimuth) < SAME_DEG;
        (0..relative.len()).filter(|k| is_here(relative[*k])).collect()
    };
    let side = |azimuth: f64, others: &[usize]| match on_the_axis(azimuth) {
        own if own.is_empty() => (azimuth, others.to_vec()),
        own => (azimuth, own),
    };
    let other = mirrored.iter().rev().filter(|(azimuth, _)| *azimuth > 0.0 && *azimuth < 180.0);
    let other = other.map(|(azimuth, at)| side(360.0 - azimuth, at));
    Ok(Some(mirrored.iter().map(|(azimuth, at)| side(*azimuth, at)).chain(other).collect()))
}

/// Mirrors half a circle of azimuths about the specular direction.
fn of_specular(grid: &mut SpecularGrid, values: &mut Vec<f64>) {
    if grid.symmetry == Symmetry::Plane || grid.rotations_deg.len() > 1 {
        return;
    }
    match cover(&grid.azimuths_deg) {
        Cover::Whole | Cover::Part => {}
        Cover::Half => grid.symmetry = Symmetry::Plane,
        Cover::Mirrored(azimuths) => {
            let radials = grid.radials_deg.len();
            let of_incidence = |cells: &[f64]| -> Vec<f64> {
                let at_radial = |at: &[usize], r: usize| mean(at.iter().map(|k| cells[k * radials + r]));
                azimuths.iter().flat_map(|(_, at)| (0..radials).map(move |r| at_radial(at, r))).collect()
            };
            *values = values.chunks_exact(grid.azimuths_deg.len() * radials).flat_map(of_incidence).collect();
            grid.azimuths_deg = azimuths.iter().map(|(azimuth, _)| *azimuth).collect();
            grid.symmetry = Symmetry::Plane;
        }
    }
}

/// Mean of the measured ones of some values; NaN if there is none.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let known = values.filter(|value| value.is_finite());
    let (sum, count) = known.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count)
}

/// Azimuth from the plane of incidence on any side, 0 to 180 deg.
pub(super) fn within_half(azimuth: f64) -> f64 {
    let turned = azimuth.rem_euclid(360.0);
    turned.min(360.0 - turned)
}

/// Azimuths on any side as those from 0 to 180 deg.
fn folded(azimuths: &[f64]) -> Azimuths {
    let ends = |azimuth: f64| match within_half(azimuth) {
        near if near < SAME_DEG => 0.0,
        far if far > 180.0 - SAME_DEG => 180.0,
        between => between,
    };
    let mut all: Vec<(f64, usize)> =
        azimuths.iter().enumerate().map(|(k, azimuth)| (ends(*azimuth), k)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let same = all.chunk_by(|a, b| b.0 - a.0 < SAME_DEG);
    same.map(|same| (same[0].0, same.iter().map(|(_, k)| *k).collect())).collect()
}

/// Finds out what ascending azimuths from that of the light cover.
fn cover(azimuths: &[f64]) -> Cover {
    let folded = folded(azimuths);
    if azimuths.len() < 2 || is_circle(azimuths) {
        return Cover::Whole;
    }
    let is_complete = match folded[..] {
        [_] => true,
        [(first, _), (second, _), ..] => {
            let [.., (before, _), (last, _)] = folded[..] else { return Cover::Part };
            // Azimuths may be those of the centres of cells.
            first <= 0.5 * (second - first) + SAME_DEG && 180.0 - last <= 0.5 * (last - before) + SAME_DEG
        }
        [] => false,
    };
    match () {
        () if !is_complete => Cover::Part,
        () if azimuths.iter().all(|azimuth| (0.0..=180.0).contains(azimuth)) => Cover::Half,
        () => Cover::Mirrored(folded),
    }
}

/// Returns whether azimuths cover a circle without a hole: the widest gap is not much wider than the next
/// one, and no half circle.
fn is_circle(azimuths: &[f64]) -> bool {
    let mut turned: Vec<f64> = azimuths.iter().map(|azimuth| azimuth.rem_euclid(360.0)).collect();
    turned.sort_by(f64::total_cmp);
    let next = turned.iter().skip(1).copied().chain(turned.first().map(|first| first + 360.0));
    let mut gaps: Vec<f64> =
        next.zip(&turned).map(|(next, this)| next - this).filter(|gap| *gap > SAME_DEG).collect();
    gaps.sort_by(|a, b| b.total_cmp(a));
    matches!(gaps[..], [widest, second, ..] if widest < 180.0 - SAME_DEG && widest <= 2.0 * second + SAME_DEG)
}

/// Weights of azimuths in a mean over a full turn: the arcs about them if they cover a circle. Otherwise they are equal, but a
/// first and a last one that are the same count half each.
pub(crate) fn turn_weights(azimuths: &[f64]) -> Vec<f64> {
    let count = azimuths.len();
    if !is_circle(azimuths) {
        let is_full_turn = matches!(azimuths[..], [first, .., last] if last - first > 360.0 - SAME_DEG);
        let is_half = |k: usize| is_full_turn && (k == 0 || k + 1 == count);
        return (0..count).map(|k| if is_half(k) { 0.5 } else { 1.0 }).collect();
    }
    let turned = |k: usize| azimuths[k].rem_euclid(360.0);
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| turned(*a).total_cmp(&turned(*b)));
    let mut weights = vec![0.0; count];
    for (place, this) in order.iter().enumerate() {
        let (next, turn) = if place + 1 < count { (order[place + 1], 0.0) } else { (order[0], 360.0) };
        let gap = turned(next) + turn - turned(*this);
        weights[*this] += gap;
        weights[next] += gap;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_a_turn_are_its_arcs() {
        assert_eq!(turn_weights(&[0.0, 90.0, 180.0, 270.0]), [180.0; 4]);
        assert_eq!(turn_weights(&[0.0, 90.0, 180.0, 270.0, 360.0]), [90.0, 180.0, 180.0, 180.0, 90.0]);
        assert_eq!(turn_weights(&[-60.0, 0.0, 60.0, 180.0]), [180.0, 120.0, 180.0, 240.0]);
        assert_eq!(turn_weights(&[0.0, 45.0, 90.0]), [1.0; 3], "no circle");
        assert_eq!(turn_weights(&[0.0, 180.0, 360.0]), [0.5, 1.0, 0.5]);
        assert_eq!(turn_weights(&[30.0]), [1.0]);
    }

    fn steps(from: i32, to: i32, step: usize) -> Vec<f64> {
        (from..=to).step_by(step).map(f64::from).collect()
    }

    #[test]
    fn half_and_whole_circles_are_told_apart() {
        for half in
            [steps(0, 180, 15), vec![0.0, 180.0], vec![7.5, 22.5, 157.5, 172.5], vec![0.0, 90.0, 180.0]]
        {
            assert_eq!(cover(&half), Cover::Half, "{half:?}");
        }
        let others = [
            steps(-180, 0, 15),
            steps(180, 360, 15),
            steps(360, 540, 15),
            steps(0, 210, 15),
            vec![-180.0000015, -90.0, 0.0],
        ];
        for other in others {
            let Cover::Mirrored(azimuths) = cover(&other) else { panic!("{other:?}") };
            assert_eq!((azimuths[0].0, azimuths[azimuths.len() - 1].0), (0.0, 180.0), "{other:?}");
        }
        for whole in
            [steps(0, 345, 15), steps(0, 360, 15), steps(-180, 180, 90), vec![30.0], vec![0.0, 100.0, 200.0]]
        {
            assert_eq!(cover(&whole), Cover::Whole, "{whole:?}");
        }
        for part in
            [steps(-90, 90, 15), steps(0, 90, 15), steps(90, 180, 15), steps(150, 210, 15), vec![0.0, 30.0]]
        {
            assert_eq!(cover(&part), Cover::Part, "{part:?}");
        }
    }

    /// With lights on both sides of the normal, half a circle is the whole one of each.
    #[test]
    fn lights_of_one_plane_share_half_a_circle() {
        let grid = |phi_i_deg| SphericalGrid {
            theta_i_deg: vec![30.0],
            phi_i_deg,
            theta_o_deg: vec![20.0],
            phi_o_deg: vec![0.0, 90.0, 180.0],
        };
        let part = |grid, values| MeasuredPart {
            way: crate::ScatterMode::FrontReflection,
            channels: vec![crate::Channel::Monochrome],
            geometry: Geometry::Spherical(grid),
            values,
            tis: Vec::new(),
        };
        let both = part(grid(vec![0.0, 180.0]), vec![1.0, 2.0, 3.0, 3.0, 5.0, 1.0]).on_one_side().unwrap();
        assert_eq!(both.values, [1.0, 2.0, 3.0, 2.0, 3.0, 5.0, 1.0, 5.0]);
        let refused = part(grid(vec![0.0, 45.0]), vec![0.0; 6]).on_one_side().unwrap_err();
        assert_eq!((refused.from_deg, refused.to_deg), (0.0, 180.0));
    }
}
