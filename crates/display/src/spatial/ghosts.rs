//! Mirror-like pixels under a flat face: a sharp image, and fainter ones that the face and the pixel reflect between each other.
//!
//! Direction is conserved, so that image k is shifted by k times 2 D. For a small signal about a state of reflectance rho under a
//! face of reflectance F, image k has (F rho)^k of the light of the first.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_transport::Panel;
use papilio_transport::spatial::{Peak, displacement};

use super::Response;
use super::response::face_reflectance;
use crate::setup::ViewPoint;

/// Images that are weaker than this fraction of all light are left out.
const FAINTEST: f64 = 1e-9;

/// Width of an image, as a fraction of the thickness, for positions of tables: images are sharp.
const SHARP: f64 = 1e-3;

struct Ghosts {
    /// Place of each image, mm, and its light by state.
    images: Vec<([f64; 2], Vec<f64>)>,
    states: usize,
    thickness_mm: f64,
}

/// Response of a bare panel; `via_pixel` is the light that the pixel returns, `[state][wavelength]`.
pub(super) fn response(
    panel: &Panel,
    thickness_mm: f64,
    view: &ViewPoint,
    weights: &[f64],
    via_pixel: &[f64],
) -> Box<dyn Response> {
    let (states, bins) = (panel.base.states(), weights.len());
    let beta = view.field.axis_towards();
    let mut reflectance = vec![0.0; states * bins];
    panel.base.reflectance(beta.squared(), &panel.medium, &mut reflectance);
    let index = panel.medium.index();
    let mut images: Vec<([f64; 2], Vec<f64>)> = Vec::new();
    // Wavelengths of the same index have the same places.
    let mut bin = 0;
    while bin < bins {
        let same = (bin..bins).take_while(|other| index[*other] == index[bin]).count();
        let step = displacement(beta, thickness_mm, index[bin]).map(|shift| 2.0 * shift);
        for order in 0.. {
            let of_state = |state: usize| -> f64 {
                let one = |bin: usize| {
                    let at = state * bins + bin;
                    let round = face_reflectance(panel, bin, beta.length()) * reflectance[at];
                    weights[bin] * via_pixel[at] * (1.0 - round) * round.powi(order)
                };
                (bin..bin + same).map(one).sum()
            };
            let light: Vec<f64> = (0..states).map(of_state).collect();
            if order > 0 && light.iter().all(|light| light.abs() <= FAINTEST) {
                break;
            }
            images.push((step.map(|step| f64::from(order) * step), light));
        }
        bin += same;
    }
    Box::new(Ghosts { images, states, thickness_mm })
}

impl Ghosts {
    /// Adds the light of each image to the bins that `place` selects, half to each.
    fn binned(&self, bins: usize, place: impl Fn([f64; 2]) -> [usize; 2]) -> Vec<Vec<f64>> {
        let mut sums = vec![vec![0.0; bins]; self.states];
        for (at, light) in &self.images {
            for bin in place(*at).into_iter().filter(|bin| *bin < bins) {
                sums.iter_mut().zip(light).for_each(|(sums, light)| sums[bin] += 0.5 * light);
            }
        }
        sums
    }
}

/// The bins below and above a place, which differ where it is a border.
fn around(edges: &[f64], at: f64) -> [usize; 2] {
    [edges.partition_point(|edge| *edge < at), edges.partition_point(|edge| *edge <= at)]
}

impl Response for Ghosts {
    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        let mut sums = vec![Complex64::ZERO; self.states];
        for (at, light) in &self.images {
            let phase = Complex64::cis(-2.0 * PI * frequency_per_mm * at[axis]);
            sums.iter_mut().zip(light).for_each(|(sum, light)| *sum += phase * light);
        }
        sums
    }

    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        self.binned(edges_mm.len() + 1, |at| around(edges_mm, at[axis]))
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        self.binned(radii_mm.len() + 1, |at| around(radii_mm, at[0].hypot(at[1])))
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        let columns = x_mm.len() - 1;
        let bins = columns * (y_mm.len() - 1);
        self.binned(bins, |at| {
            let [column, row] = [around(x_mm, at[0])[1], around(y_mm, at[1])[1]];
            let inside = column > 0 && column <= columns && row > 0 && row < y_mm.len();
            [if inside { (row - 1) * columns + column - 1 } else { usize::MAX }; 2]
        })
    }

    fn images(&self) -> Vec<[f64; 2]> {
        self.images.iter().map(|(at, _)| *at).collect()
    }

    fn peaks(&self) -> Vec<Peak> {
        self.images.iter().map(|(at, _)| Peak { at_mm: *at, width_mm: SHARP * self.thickness_mm }).collect()
    }
}
