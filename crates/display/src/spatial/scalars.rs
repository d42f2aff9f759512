//! Numbers of a state that describe its sharpness.

use papilio_colour::reader::{contrast_sensitivity, square_root_integral};

use super::measured::Measured;
use super::mtf::Frame;
use super::profile::{between, crossing, cumulative, interpolated};
use super::{Sharpness, SpatialScalars};

/// Field of view of the square-root integral, degrees.
const FIELD_DEG: f64 = 10.0;

/// Part of the difference that every second border makes that is an error of what is read between all borders: cubic
/// pieces of half the length have a sixteenth of the error, or a fourth where the slope jumps.
const OF_HALF: f64 = 0.25;

/// Widths of edges up to this part of the extent of a table are those of sharp images: the distance of the
/// places beside them.
const SHARPEST: f64 = 1e-6;

impl Frame<'_> {
    /// Computes the metrics of a state; none for one without light.
    pub(super) fn scalars(&self, state: usize, measured: &Measured) -> SpatialScalars {
        let all = measured.lights[state].last().filter(|_| measured.y(state) > 0.0);
        let Some(all) = all else { return SpatialScalars::default() };
        let modulus = [0, 1].map(|axis| -> Vec<f64> {
            let zero = all.transfer[axis][0].norm();
            all.transfer[axis].iter().map(|value| value.norm() / zero).collect()
        });
        let f50 = |axis: usize| {
            let lost: Vec<f64> = modulus[axis].iter().map(|m| 1.0 - m).collect();
            crossing(&measured.frequencies, &lost, 0.5)
        };
        let nyquist = |axis: usize| {
            self.nyquist_per_mm
                .map(|nyquist| interpolated(&measured.frequencies, &modulus[axis], nyquist[axis]))
        };
        let edge = |axis: usize| {
            let edge = cumulative(&all.strips[axis]);
            let places = &measured.places[axis];
            let at = |share: f64| crossing(places, &edge, share);
            let (width, extent) = (at(0.9)? - at(0.1)?, places.last()? - places.first()?);
            Some(if width > SHARPEST * extent { 1e3 * width } else { 0.0 })
        };
        let rings = cumulative(&all.rings);
        let radius = |share: f64| {
            if rings.first().is_some_and(|sharp| *sharp >= share) {
                return Some(0.0);
            }
            crossing(&measured.radii, &rings, share).map(|radius| 1e3 * radius)
        };
        let sqri = |axis: usize| {
            self.square_root_integral(measured.y(state), axis, |u| {
                interpolated(&measured.frequencies, &modulus[axis], u / self.mm_per_degree)
            })
        };
        SpatialScalars {
            f50_x_per_mm: f50(0),
            f50_y_per_mm: f50(1),
            mtf_nyquist_x: nyquist(0),
            mtf_nyquist_y: nyquist(1),
            edge_10_90_x_um: edge(0),
            edge_10_90_y_um: edge(1),
            r50_um: radius(0.5),
            r90_um: radius(0.9),
            sqri_jnd_x: sqri(0),
            sqri_jnd_y: sqri(1),
        }
    }

    /// Errors of the radii that have 50 and 90 % of the light by what lies between the borders of rings, um.
    pub(super) fn radius_errors(&self, state: usize, measured: &Measured) -> [Option<f64>; 2] {
        let Some(all) = measured.lights[state].last() else { return [None; 2] };
        let rings = cumulative(&all.rings);
        let every_second = |values: &[f64]| values.iter().step_by(2).copied().collect::<Vec<f64>>();
        let [few_radii, few_rings] = [&measured.radii, &rings].map(|values| every_second(values));
        [0.5, 0.9].map(|share| {
            // A sharp image.
            if rings.first().is_some_and(|sharp| *sharp >= share) {
                return Some(0.0);
            }
            let radius = crossing(&measured.radii, &rings, share)?;
            Some(1e3 * OF_HALF * (radius - crossing(&few_radii, &few_rings, share)?).abs())
        })
    }

    /// Adds the errors by the distance of places to those of radii and widths of edges that are known.
    pub(super) fn add_between(&self, errors: &mut SpatialScalars, state: usize, measured: &Measured) {
        let Some(all) = measured.lights[state].last() else { return };
        let add = |error: &mut Option<f64>, (places, bins): (&[f64], &[f64]), shares: &[f64]| {
            let cumulative = cumulative(bins);
            let all: Option<f64> = shares.iter().map(|share| between(places, &cumulative, *share)).sum();
            *error = error.zip(all).map(|(error, all)| error + 1e3 * all);
        };
        let SpatialScalars { edge_10_90_x_um, edge_10_90_y_um, r50_um, r90_um, .. } = errors;
        for (axis, error) in [edge_10_90_x_um, edge_10_90_y_um].into_iter().enumerate() {
            add(error, (&measured.places[axis], &all.strips[axis]), &[0.1, 0.9]);
        }
        for (error, share) in [(r50_um, 0.5), (r90_um, 0.9)] {
            add(error, (&measured.radii, &all.rings), &[share]);
        }
    }

    /// Square-root integral of a page of this Y along an axis, whose transfer is given for cycles per degree.
    fn square_root_integral(&self, y: f64, axis: usize, transfer: impl Fn(f64) -> f64) -> Option<f64> {
        let most = self.nyquist_per_mm.map(|nyquist| nyquist[axis]).or(self.eye_limit_per_mm)?;
        square_root_integral(transfer, y * self.luminance_of_white, FIELD_DEG, most * self.mm_per_degree)
    }

    /// Sharpness of the brightest state, from a measurement of all.
    pub(super) fn sharpness(&self, measured: &Measured) -> Option<Sharpness> {
        let states = 0..self.setup.states.len();
        let brightest = states.max_by(|a, b| measured.y(*a).total_cmp(&measured.y(*b)))?;
        let scalars = self.scalars(brightest, measured);
        let perfect = |axis: usize| self.square_root_integral(measured.y(brightest), axis, |_| 1.0);
        Some(Sharpness {
            sqri_jnd: [scalars.sqri_jnd_x?, scalars.sqri_jnd_y?],
            sqri_ideal_jnd: [perfect(0)?, perfect(1)?],
        })
    }
}

/// Highest frequency at which the eye sees full contrast, cycles per degree.
pub(super) fn eye_limit(luminance_cd_m2: f64) -> Option<f64> {
    let (mut low, mut high) = (5.0, 200.0);
    let sees = |u: f64| contrast_sensitivity(u, luminance_cd_m2, FIELD_DEG).map(|s| s >= 1.0);
    if !sees(low)? {
        return None;
    }
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if sees(middle)? { low = middle } else { high = middle }
    }
    Some(low)
}
