//! Numbers of a state that describe its sharpness.

use papilio_colour::reader::{contrast_sensitivity, square_root_integral};

use super::measured::Measured;
use super::mtf::Frame;
use super::profile::{between, crossing, crossing_error, cumulative, error_between, interpolated};
use super::{Sharpness, SpatialScalars};

/// Field of view of the square-root integral, degrees.
const FIELD_DEG: f64 = 10.0;

/// Widths of edges up to this part of the extent of a table are those of sharp images: the distance of the
/// places beside them.
const SHARPEST: f64 = 1e-6;

impl Frame<'_> {
    /// Computes the metrics of a state; none for one without light.
    pub(super) fn scalars(&self, state: usize, measured: &Measured) -> SpatialScalars {
        let y = measured.y(state);
        let all = measured.lights[state].last().filter(|_| y > 0.0);
        let Some(all) = all else { return SpatialScalars::default() };
        let frequencies = &measured.frequencies[..];
        let modulus = [0, 1].map(|axis| all.modulus(axis));
        let nyquist = |axis: usize| {
            self.nyquist_per_mm.map(|nyquist| interpolated(frequencies, &modulus[axis], nyquist[axis]))
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
        SpatialScalars {
            f50_x_per_mm: half(frequencies, &modulus[0]),
            f50_y_per_mm: half(frequencies, &modulus[1]),
            mtf_nyquist_x: nyquist(0),
            mtf_nyquist_y: nyquist(1),
            edge_10_90_x_um: edge(0),
            edge_10_90_y_um: edge(1),
            r50_um: radius(0.5),
            r90_um: radius(0.9),
            sqri_jnd_x: self.sqri(y, 0, frequencies, &modulus[0]),
            sqri_jnd_y: self.sqri(y, 1, frequencies, &modulus[1]),
        }
    }

    /// Square-root integral of a page of this Y along an axis, with a table of the modulation transfer.
    fn sqri(&self, y: f64, axis: usize, frequencies: &[f64], modulus: &[f64]) -> Option<f64> {
        self.square_root_integral(y, axis, |u| interpolated(frequencies, modulus, u / self.mm_per_degree))
    }

    /// Adds the errors by the distance of places and frequencies to those of what is read between them.
    pub(super) fn add_between(&self, errors: &mut SpatialScalars, state: usize, measured: &Measured) {
        let Some(all) = measured.lights[state].last().filter(|_| measured.y(state) > 0.0) else { return };
        let read = |places: &[f64], bins: &[f64], shares: &[f64]| -> Option<f64> {
            let cumulative = cumulative(bins);
            let error = |share: &f64| crossing_error(places, &cumulative, *share);
            shares.iter().map(error).sum::<Option<f64>>().map(|error| 1e3 * error)
        };
        let SpatialScalars { edge_10_90_x_um, edge_10_90_y_um, r50_um, r90_um, .. } = errors;
        for (axis, error) in [edge_10_90_x_um, edge_10_90_y_um].into_iter().enumerate() {
            add(error, read(&measured.places[axis], &all.strips[axis], &[0.1, 0.9]));
        }
        for (error, share) in [(r50_um, 0.5), (r90_um, 0.9)] {
            let is_sharp = cumulative(&all.rings).first().is_some_and(|sharp| *sharp >= share);
            add(error, if is_sharp { None } else { read(&measured.radii, &all.rings, &[share]) });
        }
        self.add_between_frequencies(errors, state, measured);
    }

    /// Adds the errors by the distance of frequencies.
    pub(super) fn add_between_frequencies(
        &self,
        errors: &mut SpatialScalars,
        state: usize,
        measured: &Measured,
    ) {
        let y = measured.y(state);
        let Some(all) = measured.lights[state].last().filter(|_| y > 0.0) else { return };
        let SpatialScalars { f50_x_per_mm, f50_y_per_mm, sqri_jnd_x, sqri_jnd_y, .. } = errors;
        for (axis, (f50, sqri)) in
            [(f50_x_per_mm, sqri_jnd_x), (f50_y_per_mm, sqri_jnd_y)].into_iter().enumerate()
        {
            let modulus = all.modulus(axis);
            let lost: Vec<f64> = modulus.iter().map(|modulus| 1.0 - modulus).collect();
            add(f50, crossing_error(&measured.frequencies, &lost, 0.5));
            let integral = |frequencies: &[f64], modulus: &[f64]| self.sqri(y, axis, frequencies, modulus);
            add(sqri, error_between(&measured.frequencies, &modulus, integral));
        }
    }

    /// Adds the errors by the distance of places, in tables by paths, and of frequencies.
    pub(super) fn add_between_of_paths(
        &self,
        errors: &mut SpatialScalars,
        state: usize,
        measured: &Measured,
    ) {
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
        self.add_between_frequencies(errors, state, measured);
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

/// Lowest frequency at which half of the modulation is left.
fn half(frequencies: &[f64], modulus: &[f64]) -> Option<f64> {
    let lost: Vec<f64> = modulus.iter().map(|modulus| 1.0 - modulus).collect();
    crossing(frequencies, &lost, 0.5)
}

/// Adds to an error that is known.
fn add(error: &mut Option<f64>, more: Option<f64>) {
    *error = error.map(|error| error + more.unwrap_or(0.0));
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
