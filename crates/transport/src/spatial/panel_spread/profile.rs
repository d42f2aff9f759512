//! Line and edge spread: the light of stripes.
//!
//! In the coordinates `x = d tan(alpha)`, `y = sqrt(d^2 + x^2) tan(gamma)` of a place, directions are
//! `beta = n (sin(alpha) cos(gamma), sin(gamma))`, and `d^2 beta = n^2 cos(alpha) cos^2(gamma) dalpha dgamma`: a stripe is an interval
//! of alpha, and everything is finite.

use std::f64::consts::{FRAC_PI_2, PI};

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::Gap;
use super::super::spread::Pair;
use super::{PanelSpread, Part, Scattered};
use crate::adding::first_pass::Weights;
use crate::adding::quadrature::{Pole, graded};
use crate::{Nodes, Panel, Reflector};

/// Axis in the plane of the panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// Azimuth 0.
    X,
    /// Azimuth 90 deg.
    Y,
}

/// Light from places below each edge.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Reflectance factor of the light, in the first order, of all places whose coordinate is below that of each edge,
    /// `[edge][state][wavelength]`.
    pub below: Vec<f64>,
    /// Of all light, `[state][wavelength]`.
    pub all: Vec<f64>,
}

impl PanelSpread {
    /// Returns the edge spread along an axis at these ascending positions (mm, relative to the view's own ray): the
    /// light that meets the pixel once, below each. The line spread, averaged between two positions, is their
    /// difference over their distance. Half of a sharp image at an edge is below it.
    pub fn profile(&self, panel: &Panel, axis: Axis, edges_mm: &[f64]) -> Profile {
        let len = panel.base.states() * panel.base.bins();
        let mut profile = Profile { below: vec![0.0; edges_mm.len() * len], all: vec![0.0; len] };
        for part in &self.parts {
            let rows = match &self.scattered {
                Some(scattered) if part.is_scattered => {
                    self.stripes(scattered, part, panel, (axis, edges_mm))
                }
                _ => self.images_in_stripes(part, panel, (axis, edges_mm)),
            };
            let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
            let sums = match &panel.base.reflector {
                Reflector::Specular(table) => table.weighted_sums(&rows),
                Reflector::Lambertian(rho) => {
                    rows.iter().flat_map(|row| rho.iter().map(|rho| rho * row[0])).collect()
                }
                Reflector::Scattering(_) => Vec::new(),
            };
            let through = part.through.iter().cycle();
            let light: Vec<f64> = sums.iter().zip(through).map(|(sum, through)| sum * through).collect();
            let mut sum = vec![0.0; len];
            let stripes = light.chunks_exact(len.max(1));
            for (number, stripe) in stripes.enumerate() {
                sum.iter_mut().zip(stripe).for_each(|(sum, light)| *sum += light);
                let out = match profile.below.chunks_exact_mut(len.max(1)).nth(number) {
                    Some(below) => below,
                    None => &mut profile.all,
                };
                out.iter_mut().zip(&sum).for_each(|(out, sum)| *out += sum);
            }
        }
        profile
    }

    /// Returns the weights of the stripes before, between and after the edges.
    fn stripes(
        &self,
        scattered: &Scattered,
        part: &Part,
        panel: &Panel,
        (axis, edges_mm): (Axis, &[f64]),
    ) -> Vec<Vec<f64>> {
        let nodes = nodes(panel);
        let Scattered { diffuser, view, light } = scattered;
        let gap = Gap { index: part.index, thickness_mm: self.glass_mm };
        let pair = Pair { diffuser, gap, view, light, accuracy: self.accuracy };
        let digits = self.accuracy.digits;
        let turn = |beta: Beta| if axis == Axis::X { beta } else { Beta { x: beta.y, y: beta.x } };
        let own = self.own_mm[usize::from(axis == Axis::Y)];
        let angles = edges_mm.iter().map(|edge| ((edge + own) / self.glass_mm).atan());
        let mut ends = vec![-FRAC_PI_2];
        ends.extend(angles);
        ends.push(FRAC_PI_2);
        let peaks: Vec<Peak> =
            pair.centres().into_iter().map(|(centre, _)| Peak::new(&pair, turn(centre))).collect();
        let rim = pair.has_rim().then(|| (1.0 / part.index).asin());
        let mut across: Vec<Pole> = peaks.iter().map(Peak::across).collect();
        across.extend(
            rim.into_iter().flat_map(|rim| [rim, -rim].map(|at| Pole { at, off: 0.5 * width(&pair) })),
        );
        let stripe = |ends: &[f64]| {
            let mut weights = Weights::new(nodes);
            for alpha in graded(ends[0], ends[1], &[], &across, digits) {
                let (sin, cos) = alpha.x.sin_cos();
                let mut along: Vec<Pole> = peaks.iter().map(|peak| peak.along(alpha.x)).collect();
                let squared = (1.0 / (part.index * part.index) - sin * sin) / (cos * cos).max(1e-12);
                if rim.is_some() && squared > 0.0 {
                    let at = squared.sqrt().min(1.0).asin();
                    along.extend([at, -at].map(|at| Pole { at, off: 0.5 * width(&pair) }));
                }
                for gamma in graded(-FRAC_PI_2, FRAC_PI_2, &[], &along, digits) {
                    let (up, level) = gamma.x.sin_cos();
                    let beta = turn(Beta { x: part.index * sin * level, y: part.index * up });
                    let area = part.index * part.index * cos * level * level;
                    let weight = alpha.weight * gamma.weight * area * pair.density(beta);
                    weights.add(&nodes.stencil(beta.squared(), part.index), weight);
                }
            }
            weights.finish(nodes).0
        };
        ends.windows(2).map(stripe).collect()
    }

    /// Returns the weights of sharp images in the same stripes.
    fn images_in_stripes(
        &self,
        part: &Part,
        panel: &Panel,
        (axis, edges_mm): (Axis, &[f64]),
    ) -> Vec<Vec<f64>> {
        let nodes = nodes(panel);
        let k = usize::from(axis == Axis::Y);
        let mut rows = vec![Weights::new(nodes); edges_mm.len() + 1];
        for sample in &part.samples {
            let at = sample.shift_mm[k] - self.own_mm[k];
            let stencil = nodes.stencil(sample.beta.squared(), part.index);
            let near = 1e-9 * (1.0 + self.glass_mm);
            let first = edges_mm.partition_point(|edge| *edge < at - near);
            let last = edges_mm.partition_point(|edge| *edge < at + near);
            rows[first].add(&stencil, 0.5 * sample.weight);
            rows[last].add(&stencil, 0.5 * sample.weight);
        }
        rows.into_iter().map(|row| row.finish(nodes).0).collect()
    }
}

fn nodes(panel: &Panel) -> &Nodes {
    match &panel.base.reflector {
        Reflector::Specular(table) => &table.nodes,
        Reflector::Lambertian(_) | Reflector::Scattering(_) => &Nodes::Constant,
    }
}

/// Width of the lobe as an angle in the glass.
fn width(pair: &Pair<'_>) -> f64 {
    match pair.diffuser.lobe {
        Lobe::KCorrelation { width } => width / pair.gap.index,
        Lobe::Lambertian => 1.0,
    }
}

/// A peak by its angles, and its width there.
struct Peak {
    alpha: f64,
    gamma: f64,
    width: f64,
}

impl Peak {
    fn new(pair: &Pair<'_>, centre: Beta) -> Self {
        let [x, y] = [centre.x, centre.y].map(|beta| beta / pair.gap.index);
        let gamma = y.asin();
        Self { alpha: (x / gamma.cos()).asin(), gamma, width: width(pair) }
    }

    /// Summed along the stripe.
    fn across(&self) -> Pole {
        Pole { at: self.alpha, off: self.width }
    }

    /// Along a stripe at this angle.
    fn along(&self, alpha: f64) -> Pole {
        let aside = (alpha - self.alpha).abs().min(0.5 * PI) * 0.6;
        Pole { at: self.gamma, off: self.width.hypot(aside) }
    }
}
