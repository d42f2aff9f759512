//! Where on the face the light of one pixel meets it, and the period that a drawn face needs for that.
//!
//! **Why.** A drawn face repeats. Light leaves through one place of the face and has entered through another,
//! `2D` away from it over a mirror-like pixel. If this way is about a period, both are the same place of the
//! drawn face, with the same slope, which light in a real face finds only where it returns to where it was.
//!
//! **How.** The rays of a pixel meet the face in a few regions: above the pixel, and where their light
//! entered. Regions that are far from each other have faces of their own, drawn independently. Those that
//! touch share a face, whose period contains both and the distance at which slopes are independent, so that
//! no two rays of a pixel meet the same place unless they do in a face without end.

use crate::deflection::Deflection;
use crate::{Extent, Panel, Pixel};

/// Standard deviations of a deflection beyond which few rays are.
const FEW: f64 = 4.0;

/// A region of the face, relative to the pixel, for both axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Region {
    /// Where an undeflected ray meets the face, relative to where the view's ray does, mm.
    middle_mm: [f64; 2],
    /// Half of the width by which the directions of the light enlarge the pixel, mm.
    reach_mm: [f64; 2],
    /// Root mean square displacement by the slopes, mm.
    scatter_mm: [f64; 2],
}

/// The faces of a plan.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Meetings {
    /// Number of the face of each region, from 0: of the view's rays, then of the light that entered.
    faces: Vec<usize>,
    /// Period of a face along x and y, mm, at least.
    pub(crate) least_mm: [f64; 2],
    /// The same for all directions of extended sources and pupils.
    pub(crate) best_mm: [f64; 2],
}

impl Meetings {
    /// The regions of a panel for the deflection of the view and of each source.
    pub(crate) fn new(panel: &Panel, view: &Deflection, sources: &[Deflection]) -> Self {
        let regions = regions(panel, view, sources);
        if panel.face.extent() == Extent::Periodic {
            return Self { faces: vec![0; regions.len()], least_mm: [0.0; 2], best_mm: [0.0; 2] };
        }
        let pitch = panel.matrix.pitch_mm;
        let apart = panel.face.independent_mm();
        // Largest distance along an axis at which rays of two regions may meet the face at places that are
        // not independent.
        let touches = |a: &Region, b: &Region, axis: usize| {
            pitch[axis] + apart + FEW * a.scatter_mm[axis].hypot(b.scatter_mm[axis])
        };
        let reach = |a: &Region, b: &Region, axis: usize| a.reach_mm[axis] + b.reach_mm[axis];
        let way = |a: &Region, b: &Region, axis: usize| (a.middle_mm[axis] - b.middle_mm[axis]).abs();
        let are_near = |a: &Region, b: &Region| {
            (0..2).all(|axis| way(a, b, axis) < touches(a, b, axis) + reach(a, b, axis))
        };
        let mut faces: Vec<usize> = (0..regions.len()).collect();
        for (at, region) in regions.iter().enumerate() {
            for before in 0..at {
                if are_near(region, &regions[before]) {
                    let (from, to) = (faces[at].max(faces[before]), faces[at].min(faces[before]));
                    faces.iter_mut().filter(|face| **face == from).for_each(|face| *face = to);
                }
            }
        }
        let (mut least_mm, mut best_mm) = ([0.0_f64; 2], [0.0_f64; 2]);
        for (at, one) in regions.iter().enumerate() {
            for (other, _) in regions[..=at].iter().zip(&faces).filter(|(_, face)| **face == faces[at]) {
                for axis in 0..2 {
                    let period = way(one, other, axis) + touches(one, other, axis);
                    least_mm[axis] = least_mm[axis].max(period);
                    best_mm[axis] = best_mm[axis].max(period + reach(one, other, axis));
                }
            }
        }
        Self { faces: numbered(&faces), least_mm, best_mm }
    }

    /// Number of faces of a replicate.
    pub(crate) fn count(&self) -> usize {
        self.faces.iter().max().map_or(1, |most| most + 1)
    }

    /// Number of the face that light met on its way in: for mirror-like pixels at `entrance` 0, for others at
    /// that of its source.
    pub(crate) fn entered(&self, entrance: usize) -> usize {
        self.faces[entrance + 1]
    }
}

/// The same partition with numbers from 0 without gaps.
fn numbered(faces: &[usize]) -> Vec<usize> {
    let mut known: Vec<usize> = Vec::new();
    let mut number = |face: &usize| {
        known.iter().position(|one| one == face).unwrap_or_else(|| {
            known.push(*face);
            known.len() - 1
        })
    };
    faces.iter().map(&mut number).collect()
}

/// The region of the view's rays, and those where their light entered.
fn regions(panel: &Panel, view: &Deflection, sources: &[Deflection]) -> Vec<Region> {
    let slope = panel.face.slope_rms();
    let scatter = |beam: &Deflection| lengths(beam.per_slope_mm()).map(|per_slope| slope * per_slope);
    let reach = |beam: &Deflection, radius: f64| lengths(beam.place_per_beta_mm).map(|place| radius * place);
    let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
    let pupil = reach(view, panel.pupil.radius());
    let entered = |beam: &Deflection, reach_mm: [f64; 2]| Region {
        middle_mm: sum(view.displacement_mm, beam.displacement_mm).map(|d| -d),
        reach_mm,
        scatter_mm: sum(scatter(view), scatter(beam)),
    };
    let mut all = vec![Region::default()];
    match panel.pixel {
        Pixel::Mirror if sources.is_empty() => {}
        // The same directions go both ways.
        Pixel::Mirror => all.push(entered(view, sum(pupil, pupil))),
        Pixel::Lambertian => all.extend(
            sources
                .iter()
                .zip(&panel.room.sources)
                .map(|(beam, source)| entered(beam, sum(reach(beam, source.radius()), pupil))),
        ),
    }
    all
}

/// Lengths of the rows of a symmetric matrix (xx, xy, yy).
fn lengths([xx, xy, yy]: [f64; 3]) -> [f64; 2] {
    [xx.hypot(xy), xy.hypot(yy)]
}
